/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What the module "forest" exports. It stands alone: no call into libterrazzo. */
#ifndef TZ_ANALYSIS_FOREST_MODULE_H
#define TZ_ANALYSIS_FOREST_MODULE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum tz_forest_result {
    TZ_FOREST_OK,
    TZ_FOREST_NOMEM,
    TZ_FOREST_BAD_MODEL,
    TZ_FOREST_FAILED
} tz_forest_result;

/** @param rgb   3 * width * height interleaved, sRGB-encoded, 0..1
 *  @param[out] response     width * height
 *  @param[out] orientation  width * height, radians across the edge
 *  @param[out] why          one line if the result is not TZ_FOREST_OK */
typedef tz_forest_result (*tz_forest_detect_fn)(const char *model, float *rgb,
                                                int32_t width, int32_t height,
                                                float *response, float *orientation,
                                                char *why, size_t size);
__attribute__((visibility("default"))) tz_forest_result
tz_forest_detect(const char *model, float *rgb, int32_t width, int32_t height,
                 float *response, float *orientation, char *why, size_t size);

#ifdef __cplusplus
}
#endif
#endif
