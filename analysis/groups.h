/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Edges and regions to edge groups and the meta group. Private to analysis/. */
#ifndef TZ_ANALYSIS_GROUPS_H
#define TZ_ANALYSIS_GROUPS_H

#include "analysis/ebpt.h"

/** Fills group, group_edge, cell, cell_edge, neighbour, meta, and each edge's group and
 * bins, from e->label (ids 0 .. count - 1), e->edge and e->params.
 * @return TZ_OK; TZ_NOMEM; TZ_CANCELLED
 * @source [Kim21] Sec. 4.2, Eq. (2) */
tz_status tz_groups_encode(tz_ebpt *e, int32_t count);

#endif
