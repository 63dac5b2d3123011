/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Uniform grid over 2D points for radius queries, optionally on a torus. */
#ifndef TZ_BASE_GRID_H
#define TZ_BASE_GRID_H

#include "base/array.h"
#include "base/geom.h"

typedef struct tz_grid {
    tz_vec2 origin, size; /**< covered rectangle */
    double cell;          /**< cell side (x and y may differ a little on a torus) */
    int32_t nx, ny;
    bool wrap;
    int32_t *head; /**< nx * ny, first item of a cell or -1 */
    TZ_ARRAY(int32_t)
    next; /**< per item: next in its cell or -1; -2 = removed */
    TZ_ARRAY(tz_vec2)
    point;
} tz_grid;

/** Empty grid; cell > 0; cells are capped at 2^24. Points outside are clamped to the
 * border cells (or wrapped). */
TZ_API tz_status tz_grid_init(tz_ctx *ctx, tz_grid *g, tz_vec2 origin, tz_vec2 size,
                              double cell, bool wrap);
TZ_API void tz_grid_deinit(tz_ctx *ctx, tz_grid *g);
/** Adds a point; its id is the number of points added before. */
TZ_API tz_status tz_grid_add(tz_ctx *ctx, tz_grid *g, tz_vec2 p, int32_t *id);
TZ_API void tz_grid_remove(tz_grid *g, int32_t id);
/** Ids of points within `radius` of `p`, rising id order, into out[0..max-1].
 * @return how many there are (may exceed max) */
TZ_API int32_t tz_grid_query(const tz_grid *g, tz_vec2 p, double radius, int32_t *out,
                             int32_t max);

#endif
