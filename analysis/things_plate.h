/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The photo with the things taken out. Private to analysis/. */
#ifndef TZ_ANALYSIS_THINGS_PLATE_H
#define TZ_ANALYSIS_THINGS_PLATE_H

#include "analysis/things_ground.h"

/** @param[out] plate  overwritten; empty on error; as the photo, 1 or 3 channels: what is
 *                     surely ground, evened out, and the same stuff everywhere else */
tz_status tz_things_plate(tz_ctx *ctx, const tz_image *photo,
                          const tz_things_ground *ground, tz_image *plate);

#endif
