/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Which things are whole and sure enough to be copied. Private to analysis/. */
#ifndef TZ_ANALYSIS_THINGS_DOUBT_H
#define TZ_ANALYSIS_THINGS_DOUBT_H

#include "analysis/things_ground.h"
#include "analysis/things_set.h"

/** Sets colour, area, frame, solid, like_ground and cut of each thing from its outline, sure and hidden.
 * @param label  width * height
 * @cost O(pixels + points log points) */
tz_status tz_things_doubt(tz_ctx *ctx, const tz_image *photo, const int32_t *label,
                          const tz_things_ground *ground, tz_things_found *found,
                          int32_t count);

#endif
