/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Loops over rows that the channels of a structured forest are made of. Sums have a fixed
 * order, products are exact or fused with the sum, so that plain and AVX2 versions, and
 * OpenCV's, agree to the last bit. Private to analysis/. */
#ifndef TZ_ANALYSIS_FOREST_ROWS_H
#define TZ_ANALYSIS_FOREST_ROWS_H

#include <stdbool.h>
#include <stdint.h>

#define TZ_FOREST_BLUR 4 /**< radius of the wide triangle blur */
#define TZ_FOREST_BINS 4 /**< directions of gradients */

typedef struct tz_forest_rows {
    /** n px of RGB to L, u, v. */
    void (*luv)(const float *table, const float *rgb, int32_t n, float *const p[3]);
    /** Largest gradient of three planes and its direction's bin 0..3, from the rows above,
     * at, and below; both ends of a row are doubled. */
    void (*gradient)(const float *const up[3], const float *const at[3],
                     const float *const down[3], int32_t n, float *m, float *bin);
    /** Triangle blur across n floats whose neighbours stand `step` floats apart; `padded`
     * points TZ_FOREST_BLUR steps before the first. */
    void (*blur_across)(const float *padded, int32_t n, int32_t step, float *out);
    /** The same down columns: row[TZ_FOREST_BLUR] is the middle. */
    void (*blur_down)(const float *const row[2 * TZ_FOREST_BLUR + 1], int32_t n,
                      float *out);
    /** 1/4 1/2 1/4 of three rows. */
    void (*blur_three)(const float *const row[3], int32_t n, float *out);
    /** The last two for n groups of 16 floats, to every other group of `out`. */
    void (*blur_down_lanes)(const float *const row[2 * TZ_FOREST_BLUR + 1], int32_t n,
                            float *out);
    void (*blur_three_lanes)(const float *const row[3], int32_t n, float *out);
    /** m / (blurred + 0.01), in place of what is blurred. */
    void (*divide)(const float *m, int32_t n, float *blurred);
    /** Means of 2 x 2. */
    void (*halve)(const float *above, const float *below, int32_t n, float *out);
} tz_forest_rows;

/** The fastest versions that this processor runs. */
const tz_forest_rows *tz_forest_rows_get(void);
/** The versions that every processor runs; for tests. */
const tz_forest_rows *tz_forest_rows_plain(void);

/** Y in 1/1024 to L, for luv: 1064 floats. */
void tz_forest_luminance_table(float *t);

#endif
