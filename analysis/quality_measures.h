/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The single measures. Each fills its own fields of the result; none gives NaN but where
 * the field's contract says so. Private to analysis/quality*.c. */
#ifndef TZ_ANALYSIS_QUALITY_MEASURES_H
#define TZ_ANALYSIS_QUALITY_MEASURES_H

#include "analysis/quality.h"
#include "analysis/quality_planes.h"

/** Side of the patches that may occur again, px. */
#define TZ_QUALITY_REPEAT 48

/** What a measure works on. `heat`, where not NULL, has the output's size (no crops then)
 * and collects 0..1 a pixel; each measure has its own plane. */
typedef struct tz_quality_work {
    const tz_quality_picture *exemplar, *output;
    const tz_quality_params *params;
    float *heat_repeat, *heat_seam; /* NULL or out.w * out.h, zeroed */
} tz_quality_work;

/** patch, patch_level. */
tz_status tz_quality_patch(tz_ctx *ctx, const tz_quality_work *w, tz_quality *q);
/** orientation. */
tz_status tz_quality_orientation(tz_ctx *ctx, const tz_quality_work *w, tz_quality *q);
/** correlation, periodicity. */
tz_status tz_quality_correlation(tz_ctx *ctx, const tz_quality_work *w, tz_quality *q);
/** sharpness, sharpness_range. */
tz_status tz_quality_sharpness(tz_ctx *ctx, const tz_quality_work *w, tz_quality *q);
/** repetition, repetition_near. */
tz_status tz_quality_repetition(tz_ctx *ctx, const tz_quality_work *w, tz_quality *q);
/** seam. */
tz_status tz_quality_seam(tz_ctx *ctx, const tz_quality_work *w, tz_quality *q);
/** broken. */
tz_status tz_quality_lines(tz_ctx *ctx, const tz_quality_work *w, tz_quality *q);
/** wrap of the whole output image. */
tz_status tz_quality_wrap(tz_ctx *ctx, const tz_image *output, tz_quality *q);

/** The combined heat map: 1 channel, 0..1, of the output's size. */
tz_status tz_quality_heat(tz_ctx *ctx, const tz_quality_work *w, tz_image *map);

/** Costs and score from all other fields. */
void tz_quality_score(tz_quality *q);

/** (a + floor) / (b + floor), 1 for 0 / 0. */
static inline double tz_quality_ratio(double a, double b, double floor)
{
    return floor > 0 ? (a + floor) / (b + floor) : a > 0 && b > 0 ? a / b : 1;
}

#endif
