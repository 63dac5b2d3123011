/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Points of a domain sorted into square cells, made anew for each set of positions: the
 * nearest points about a place, with their shortest offsets. (base/grid.h is for points
 * that come and go.) */
#ifndef TZ_ELEMENTS_CELLS_H
#define TZ_ELEMENTS_CELLS_H

#include "base/array.h"
#include "elements/domain.h"

typedef struct tz_cells {
    tz_domain domain;
    tz_vec2 origin, side; /**< corner of cell 0, extent of one cell */
    int32_t nx, ny;
    TZ_ARRAY(int32_t)
    first; /**< first[c]..first[c+1]-1: items of cell c */
    TZ_ARRAY(int32_t)
    item; /**< point numbers, rising in each cell */
    TZ_ARRAY(int32_t)
    cell; /**< of each point */
} tz_cells;

/** A point found. */
typedef struct tz_nearby {
    float x, y;  /**< from the place that was asked about */
    float dist2; /**< squared length of it */
    int32_t id;
} tz_nearby;

/** Sorts points; buffers of an earlier call are reused.
 * @param c      zeroed before the first call
 * @param reach  largest radius that will be asked for, > 0
 * @cost O(n) */
TZ_API tz_status tz_cells_fill(tz_ctx *ctx, tz_cells *c, const tz_domain *domain,
                               const tz_vec3 *point, int32_t n, double reach);
TZ_API void tz_cells_free(tz_ctx *ctx, tz_cells *c);
/** The nearest points within a radius (at most the reach), nearest first, ties by lower
 * number. Of a cell with more than 256 points only so many are looked at, so that heaps
 * of coincident points cost no more than others.
 * @param skip  point that is left out, or -1
 * @return how many, at most `most` */
TZ_API int32_t tz_cells_near(const tz_cells *c, const tz_vec3 *point, tz_vec3 at,
                             double radius, int32_t skip, tz_nearby *out, int32_t most);

#endif
