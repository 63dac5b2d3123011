/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Pictures of lines whose places and widths are known, drawn over grainy ground, and what
 * was found in them against that. */
#ifndef TZ_TESTS_SUPPORT_LINE_TRUTH_H
#define TZ_TESTS_SUPPORT_LINE_TRUTH_H

#include "base/image.h"
#include "curves/curve.h"

typedef enum line_kind {
    LINE_CELLS,  /**< dark joints of about one width that meet three by three */
    LINE_CRACKS, /**< dark cracks that branch, taper and end anywhere */
    LINE_VEINS,  /**< long light veins whose width swells */
    LINE_KINDS
} line_kind;
extern const char *const line_kind_name[LINE_KINDS];

/** A point of a line, at most 1 px from the next. */
typedef struct line_sample {
    tz_vec2 at;
    double width;
} line_sample;

typedef struct line_truth {
    tz_image photo; /**< 3 channels, sRGB */
    TZ_ARRAY(line_sample)
    sample;
    tz_ctx *ctx;
} line_truth;

/** @param depth  of the lines, 0 .. 1, against grain of 0.04 (standard deviation) */
tz_status line_truth_draw(tz_ctx *ctx, line_kind kind, int32_t side, double depth,
                          uint64_t seed, line_truth *out);
void line_truth_deinit(line_truth *t);

typedef struct line_score {
    double precision, recall, f; /**< within 2 px */
    double place;                /**< median distance of what is matched, px */
    double width;                /**< median |found / true - 1| of what is matched */
} line_score;

/** @param found  n samples, at most 1 px apart along lines */
tz_status line_truth_score(const line_truth *t, const line_sample *found, int32_t n,
                           line_score *out);

/** Samples of a set's paths, with widths. @param[out] v  an array to be freed */
tz_status line_samples_of(tz_ctx *ctx, const tz_curve_set *set, line_sample **v,
                          int32_t *n);

#endif
