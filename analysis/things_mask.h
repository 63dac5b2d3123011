/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Which pixels belong to which thing. Private to analysis/. */
#ifndef TZ_ANALYSIS_THINGS_MASK_H
#define TZ_ANALYSIS_THINGS_MASK_H

#include "analysis/things_choose.h"

/** Labels the pixels of the chosen nodes, 0 .. chosen->n - 1, others -1; then takes
 * joints, which the superpixels have shared out, away from the things at their sides and
 * thin tails from each thing, and leaves it its largest 4-connected part. Things smaller than `least` px after
 * that are gone: labels are numbered anew, *count of them are left.
 * @param[out] label  width * height
 * @cost O(pixels) */
tz_status tz_things_mask(tz_ctx *ctx, const tz_things_picture *in,
                         const tz_things_tree *t, const tz_things_nodes *chosen,
                         double least, int32_t *label, int32_t *count);

/** Distance of each pixel to the nearest of another label, 3 a px (chamfer), up to
 * 30,000; the picture's border is none. */
tz_status tz_things_depth_map(tz_ctx *ctx, const int32_t *label, int32_t width,
                              int32_t height, int16_t **out);

#endif
