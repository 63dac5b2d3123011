/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Boundary tensor over a pyramid: how strongly, and across which direction, the picture
 * changes at each pixel, on scales an octave apart. Private to analysis/. */
#ifndef TZ_ANALYSIS_TENSOR_H
#define TZ_ANALYSIS_TENSOR_H

#include "base/image.h"

#define TZ_TENSOR_LEVELS 8
/** Gaussian of a level, in its own pixels; level k stands for sigma 2^k times as large.
 */
#define TZ_TENSOR_SIGMA  1.4

/** Level k: pixel i lies on pixel 2^k i of the photo. */
typedef struct tz_tensor_level {
    int32_t width, height;
    float *lab;    /**< smoothed planes, channels * width * height */
    float *tensor; /**< planes s = T11 + T22, d = T11 - T22, c = 2 T12 */
    double energy; /**< mean of sqrt(lambda_1) */
} tz_tensor_level;

typedef struct tz_tensor {
    int32_t channels; /**< 1 (grey: L) or 3 (L, a, b) */
    int32_t n;        /**< levels, at least 1 */
    tz_tensor_level level[TZ_TENSOR_LEVELS];
    tz_ctx *ctx;
} tz_tensor;

/** @param photo  any size and encoding; NaN counts as black, alpha mixes with mid-grey
 *  @param[out] t  replaced; empty on error  @cost O(pixels) */
tz_status tz_tensor_init(tz_ctx *ctx, const tz_image *photo, tz_tensor *t);
void tz_tensor_deinit(tz_tensor *t);

/** Weighted sum of the levels' tensors at the photo's resolution, as response and, if
 * asked, the direction across the boundary.
 * @param weight      TZ_TENSOR_LEVELS weights; levels that do not exist are skipped
 * @param[out] r      width * height: sqrt of the larger eigenvalue, Lab units
 * @param[out] normal NULL or 2 * width * height: d and c planes (cos, sin of twice the
 *                    angle, not normalised) */
tz_status tz_tensor_response(const tz_tensor *t, const double *weight, float *r,
                             float *normal);

#endif
