/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Ground: loud textures without pieces. Private to scenes/. */
#ifndef TZ_SCENES_GROUND_H
#define TZ_SCENES_GROUND_H

#include "scenes/rock.h"

/** Paints relief and albedo with moss, sand, grass, grit, concrete, leather or fibres.
 * @param size   of the coarsest grain, px
 * @param where  width * height, painted where it is `value`; NULL = everywhere */
tz_status tz_ground_paint(tz_canvas *c, tz_rng *r, double size, const uint8_t *where,
                          uint8_t value);

#endif
