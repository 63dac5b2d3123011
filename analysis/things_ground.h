/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What between the things is surely ground: joints, mortar, soil; not things that were
 * missed. Private to analysis/. */
#ifndef TZ_ANALYSIS_THINGS_GROUND_H
#define TZ_ANALYSIS_THINGS_GROUND_H

#include "base/image.h"

/** Colours are grey, red against green, yellow against blue, of the encoded values. */
typedef struct tz_things_ground {
    uint8_t *sure;    /**< width * height, 1 = surely ground */
    double middle[3]; /**< median colour of the ground */
    double spread[3]; /**< 1.48 median distance from it, at least 0.01 */
    double size;      /**< px: middle diameter of the things */
    double share;     /**< of the picture that is surely ground */
    double clear;     /**< 0..1: how far the ground's colour is from the things' own */
} tz_things_ground;

/** @param label     width * height, below 0 = no thing; count things
 *  @param doubtful  width * height, 1 = may be a thing that was missed
 *  @param[out] out  replaced; empty on error
 *  @cost O(pixels) */
tz_status tz_things_ground_find(tz_ctx *ctx, const tz_image *photo, const int32_t *label,
                                int32_t count, const uint8_t *doubtful,
                                tz_things_ground *out);
void tz_things_ground_deinit(tz_ctx *ctx, tz_things_ground *g); /**< takes zeroed */

/** Colour of a pixel of 1 to 4 channels; what is no number is 0. */
void tz_things_colour(const float *px, int32_t channels, float colour[3]);

#endif
