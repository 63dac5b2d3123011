/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Single stones laid on a canvas one after the other, each over those before: rounded
 * pebbles and broken chips. Private to scenes/. */
#ifndef TZ_SCENES_PEBBLES_H
#define TZ_SCENES_PEBBLES_H

#include "scenes/rock.h"

typedef struct tz_pebble_bed {
    uint64_t seed;
    double size, spread;    /**< diameter of the usual one, px; log deviation of others */
    double flat, flat_vary; /**< height over half-width */
    double longish;         /**< how much longer than wide they may be, >= 1 */
    double lumps;           /**< of the outline, 0..0.3 */
    double bump;            /**< of the surface, share of size */
    bool broken;            /**< chips with facets; else rounded */
    bool pressed;           /**< the higher surface wins; else the later stone */
    double rise;            /**< px by which later layers lie higher */
    tz_rock_family family;
} tz_pebble_bed;

void tz_pebble_bed_draw(tz_rng *r, double size, tz_pebble_bed *bed);
/** Lays a stone at a place: a new piece, into segment and relief; albedo is left.
 * @param base  height it rests on, px  @param number  names it for its family */
tz_status tz_pebble_lay(tz_canvas *c, const tz_pebble_bed *bed, tz_vec2 at, double base,
                        int32_t depth, uint64_t number);
/** Paints all pixels of pieces from `first` on as the bed's stones. */
tz_status tz_pebble_paint(tz_canvas *c, const tz_pebble_bed *bed, int32_t first);

#endif
