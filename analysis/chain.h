/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Edge maps to Freeman chains. Private to analysis/. */
#ifndef TZ_ANALYSIS_CHAIN_H
#define TZ_ANALYSIS_CHAIN_H

#include "analysis/ebpt.h"
#include "analysis/edges.h"

/** Freeman direction k: 0 = +x, then counter-clockwise as seen. */
extern const int8_t tz_chain_dx[8], tz_chain_dy[8];

/** Links the map's pixels into chains that are split at branchings, and appends them to
 * e->edge and e->code, in raster order of their start; features are left zero. A
 * branching pixel ends all the chains that meet there; a closed curve starts and ends in
 * its first pixel. Twigs (a loose end closer than min_length to a branching) are cut off
 * `m` first, so that they do not break the long chain that they hang on; chains shorter
 * than min_length are dropped.
 * @param m  thinned; twigs are removed from it
 * @return TZ_OK; TZ_NOMEM; on error e->edge and e->code hold any part */
tz_status tz_chain_link(tz_edge_map *m, double min_length, tz_ebpt *e);

/** Eq. (1) for e->edge[i]: extent, centre, angle, width, strength, ends.
 * @param m  response in units of `full` (= strength 1) */
void tz_chain_measure(const tz_edge_map *m, double full, tz_ebpt *e, int32_t i);

#endif
