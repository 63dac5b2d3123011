/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Channels that a structured forest looks at: colour, gradient magnitude and orientation
 * at two scales, 13 a position, a position every 2 x 2 px. Bit for bit what OpenCV's
 * detector computes where it has fused multiply-add, and the same on every other machine.
 * Private to analysis/.
 * @source Dollar, Zitnick: Fast edge detection using structured forests, PAMI 2015, Sec.
 * 3.3; order of operations: OpenCV 4.6 ximgproc as measured by the test */
#ifndef TZ_ANALYSIS_FOREST_FEATURES_H
#define TZ_ANALYSIS_FOREST_FEATURES_H

#include "base/alloc.h"

#define TZ_FOREST_PATCH    32 /**< px a side that a tree looks at */
#define TZ_FOREST_INNER    16 /**< px a side that a leaf speaks of, in the middle of it */
#define TZ_FOREST_PAD      8 /**< (patch - inner) / 2: mirrored border around the photo */
#define TZ_FOREST_SIDE     16 /**< positions a side of a patch */
#define TZ_FOREST_CHANNELS 13 /**< L, u, v; magnitude, 4 orientations; the same at half */
#define TZ_FOREST_LANES    16 /**< floats a kind of value: channels, then zeros */
#define TZ_FOREST_STEP     32 /**< floats a position: regular lanes, coarse lanes */
#define TZ_FOREST_GRID     5  /**< cells a side whose differences are features too */
#define TZ_FOREST_REGULAR  (TZ_FOREST_CHANNELS * TZ_FOREST_SIDE * TZ_FOREST_SIDE)
#define TZ_FOREST_PAIRS    300 /**< pairs of 25 cells */
#define TZ_FOREST_FEATURES (TZ_FOREST_REGULAR + TZ_FOREST_CHANNELS * TZ_FOREST_PAIRS)

/** Where the picture comes from: row y as RGB, sRGB-encoded, clamped to [0, 1].
 * @param[out] rgb  3 * width floats, interleaved; called from several threads */
typedef void (*tz_forest_row)(const void *source, int32_t y, float *rgb);

/** Rows of positions, first .. first + rows - 1 of all `height` rows of the padded
 * picture; position (x, y) lies on padded px 2x, 2y. */
typedef struct tz_forest_features {
    int32_t width, height; /**< positions of the padded picture: (w + 16) / 2, ... */
    int32_t first, rows;
    float *value; /**< rows * width * TZ_FOREST_STEP: channels smoothed a little, then
                     smoothed more, for differences of cells */
    tz_ctx *ctx;
} tz_forest_features;

/** Channels of some rows.
 * @param width, height  of the picture, px, even, at least 16
 * @param first, rows    positions wanted
 * @param[out] f  replaced; empty on error
 * @return TZ_OK; TZ_NOMEM; TZ_CANCELLED  @cost O(rows * width), in parallel by rows */
tz_status tz_forest_features_init(tz_ctx *ctx, tz_forest_row row, const void *source,
                                  int32_t width, int32_t height, int32_t first,
                                  int32_t rows, tz_forest_features *f);
void tz_forest_features_deinit(tz_forest_features *f); /**< takes zeroed */

/** Where a feature is read, in floats from a patch's first position: it is always value[a]
 * - value[b]; regular features are taken off a lane that holds 0.
 * @param id     0 .. TZ_FOREST_FEATURES - 1
 * @param width  positions a row */
void tz_forest_feature_place(int32_t id, int32_t width, int32_t *a, int32_t *b);

/** Values of the patch whose first position is (x, y); y counts from the first row of the
 * padded picture. */
static inline const float *tz_forest_features_at(const tz_forest_features *f, int32_t x,
                                                 int32_t y)
{
    return f->value +
           ((size_t)(y - f->first) * (size_t)f->width + (size_t)x) * TZ_FOREST_STEP;
}

#endif
