/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Drawings that are tiles: what leaves at one side comes in at the other. As a torus such
 * an exemplar has no border at all: nothing is cut, and pieces may be taken across it.
 *
 *   lines cut at the border -> ports (ends there: place, direction, pen)
 *   -> ports of opposite sides paired -> enough of them -> sides sewn together */
#ifndef TZ_CURVES_TILE_H
#define TZ_CURVES_TILE_H

#include "curves/curve.h"

/** Whether a drawing is a tile: at least 85 % of the lines that end at its sides go on at
 * the opposite one (within a line's width or 1/200 of the side, 25 degrees, the same
 * colour, widths within a factor of 1.6), and that is no accident (by the number of ends
 * it would be rarer than 1 in 10,000). Tori are tiles. Exemplars with a region or a photo,
 * and drawings that nothing leaves, are none.
 * @param[out] is  untouched on error
 * @return TZ_OK; TZ_NOMEM; TZ_CANCELLED  @cost O(n log n) */
TZ_API tz_status tz_curve_tile_find(tz_ctx *ctx, const tz_curve_set *set, bool *is);

/** The drawing as a torus, tile or not: what lies beyond the border goes, ends that face
 * each other over it meet half-way, and what the border has split in two is one. Lines
 * half of which lies at either side are there once. Elements stay as they are.
 * @param[out] out  overwritten, not freed; zeroed on error
 * @return as tz_curve_join; TZ_INVALID (a domain with a region) */
TZ_API tz_status tz_curve_tile_join(tz_ctx *ctx, const tz_curve_set *set,
                                    tz_curve_set *out);

#endif
