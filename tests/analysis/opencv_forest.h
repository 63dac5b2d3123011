/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * OpenCV's structured-forest detector and its channels, to compare with. */
#ifndef TZ_TESTS_ANALYSIS_OPENCV_FOREST_H
#define TZ_TESTS_ANALYSIS_OPENCV_FOREST_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Channels of the picture padded by 8 mirrored px: 13 floats a position, smoothed as the
 * detector's regular and self-similarity features are.
 * @param[out] regular, coarse  (width + 16) / 2 * (height + 16) / 2 * 13 */
void opencv_channels(float *rgb, int32_t width, int32_t height, float *regular,
                     float *coarse);
/** @param[out] response  width * height */
void opencv_edges(const char *model, float *rgb, int32_t width, int32_t height,
                  float *response);

#ifdef __cplusplus
}
#endif
#endif
