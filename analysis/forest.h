/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Structured-forest edges. Private to analysis/.
 * @source [Kim21] Sec. 4.1; Dollar, Zitnick: Fast edge detection using structured
 * forests, PAMI 2015 */
#ifndef TZ_ANALYSIS_FOREST_H
#define TZ_ANALYSIS_FOREST_H

#include "analysis/forest_features.h"
#include "analysis/forest_model.h"
#include "base/image.h"

/** Response of rows y0 .. y1 - 1, the same as these rows of the whole picture.
 * @param width, height  even, at least 32 px
 * @param stride  px between patches: 2 is OpenCV's detector, equal within 1e-4; 4 looks at
 *                a quarter of the patches
 * @param[out] response  (y1 - y0) * width, about 0..1
 * @return TZ_OK; TZ_NOMEM; TZ_CANCELLED
 * @cost O(pixels * evaluated trees * depth / stride^2), in parallel by rows; memory about
 *       100 bytes a pixel of the rows */
tz_status tz_forest_detect(tz_ctx *ctx, const tz_forest *forest, tz_forest_row row,
                           const void *source, int32_t width, int32_t height,
                           int32_t stride, int32_t y0, int32_t y1, float *response);

/** Edges of a photo: detected at half, one and double size and averaged, slab by slab, so
 * that memory beyond photo and result is that of a slab, and a byte a pixel.
 * @param photo  any size, encoding and channels
 * @param[out] response  width * height, 0..1
 * @param[out] normal    planes: cos, sin of twice the angle across the edge */
tz_status tz_forest_response(tz_ctx *ctx, const tz_image *photo, const tz_forest *forest,
                             float *response, float *normal);

/** The model of a file, read when first asked for and kept by the context until it ends.
 * @param model  file; "" = the one that Terrazzo ships
 * @return TZ_OK; what tz_forest_read returns; TZ_IO (names where it was looked for) */
tz_status tz_forest_of(tz_ctx *ctx, const char *model, const tz_forest **out);

#endif
