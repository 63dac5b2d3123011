/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The photo with the things taken out. Private to analysis/. */
#ifndef TZ_ANALYSIS_THINGS_PLATE_H
#define TZ_ANALYSIS_THINGS_PLATE_H

#include "base/image.h"

/** @param label       width * height, below 0 = ground
 *  @param[out] plate  overwritten; empty on error; as the photo, 1 or 3 channels */
tz_status tz_things_plate(tz_ctx *ctx, const tz_image *photo, const int32_t *label,
                          tz_image *plate);

#endif
