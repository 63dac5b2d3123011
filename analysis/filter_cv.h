/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Filters of OpenCV (core and imgproc only) behind C. Private to analysis/. */
#ifndef TZ_ANALYSIS_FILTER_CV_H
#define TZ_ANALYSIS_FILTER_CV_H

#ifdef __cplusplus
extern "C" {
#endif

#include "base/ctx.h"

/** Gaussian blur of rows y0 .. y1 - 1 of one dense plane; rows outside the band are read,
 * so that bands join without a trace. Borders are mirrored.
 * @param[out] dst  plane of the same size, rows y0 .. y1 - 1 written */
tz_status tz_cv_blur(tz_ctx *ctx, float *src, float *dst, int32_t width, int32_t height,
                     int32_t y0, int32_t y1, double sigma);

/** Autocorrelation of a plane without wrap (zero-padded): out[y * (mx + 1) + x] is the
 * lag (x, y) for x = 0..mx and, in rows y + my, y = -my..my.
 * @param[out] out  (2 my + 1) * (mx + 1) sums of products */
tz_status tz_cv_autocorrelation(tz_ctx *ctx, const float *src, int32_t width,
                                int32_t height, int32_t mx, int32_t my, float *out);

#ifdef __cplusplus
}
#endif
#endif
