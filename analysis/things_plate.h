/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The photo with the things taken out. Private to analysis/. */
#ifndef TZ_ANALYSIS_THINGS_PLATE_H
#define TZ_ANALYSIS_THINGS_PLATE_H

#include "base/image.h"

/** @param label       width * height, below 0 = ground
 *  @param doubtful    width * height, 1 = ground that may be a thing that was missed: it is
 *                     kept, but nothing else is filled with it
 *  @param[out] plate  overwritten; empty on error; as the photo, 1 or 3 channels */
tz_status tz_things_plate(tz_ctx *ctx, const tz_image *photo, const int32_t *label,
                          const uint8_t *doubtful, tz_image *plate);

#endif
