/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Raster over a domain: cells that fields (distances, directions, zones) are kept on. */
#ifndef TZ_ELEMENTS_RASTER_H
#define TZ_ELEMENTS_RASTER_H

#include "base/geom.h"

/** width x height cells over [0, size.x) x [0, size.y); values belong to cells' centres. */
typedef struct tz_raster {
    int32_t width, height; /**< >= 1 */
    tz_vec3 size;          /**< user units */
    bool torus;
} tz_raster;

/** Column (or row) of a raster: wrapped on a torus, else the nearest one. */
static inline int32_t tz_raster_index(int32_t i, int32_t n, bool torus)
{
    if (torus) {
        i %= n;
        return i < 0 ? i + n : i;
    }
    return i < 0 ? 0 : i < n ? i : n - 1;
}

/** A coordinate in cells, within bounds that an index can hold. */
static inline double tz_raster_cell(double x, double size, int32_t n)
{
    const double c = x / size * n, most = 4.0 * n;
    return c < -most ? -most : c > most ? most : c == c ? c : 0;
}

/** Bilinear value at a place. */
static inline double tz_raster_sample(const tz_raster *r, const float *v, tz_vec3 at)
{
    const double x = tz_raster_cell(at.x, r->size.x, r->width) - 0.5,
                 y = tz_raster_cell(at.y, r->size.y, r->height) - 0.5;
    const int32_t i = (int32_t)floor(x), j = (int32_t)floor(y);
    const double s = x - i, t = y - j;
    const int32_t i0 = tz_raster_index(i, r->width, r->torus),
                  i1 = tz_raster_index(i + 1, r->width, r->torus);
    const float *const p =
        v + (int64_t)tz_raster_index(j, r->height, r->torus) * r->width;
    const float *const q =
        v + (int64_t)tz_raster_index(j + 1, r->height, r->torus) * r->width;
    return (p[i0] * (1 - s) + p[i1] * s) * (1 - t) + (q[i0] * (1 - s) + q[i1] * s) * t;
}

/** Cell that a place lies in (the nearest one beyond the domain). */
static inline int64_t tz_raster_at(const tz_raster *r, tz_vec3 at)
{
    const int32_t i = tz_raster_index(
        (int32_t)floor(tz_raster_cell(at.x, r->size.x, r->width)), r->width, r->torus);
    const int32_t j = tz_raster_index(
        (int32_t)floor(tz_raster_cell(at.y, r->size.y, r->height)), r->height, r->torus);
    return (int64_t)j * r->width + i;
}

/** How far a place lies beyond a plain domain, 0 inside and on a torus. */
static inline double tz_raster_beyond(const tz_raster *r, tz_vec3 at)
{
    if (r->torus)
        return 0;
    const double x = at.x < 0 ? -at.x : at.x > r->size.x ? at.x - r->size.x : 0;
    const double y = at.y < 0 ? -at.y : at.y > r->size.y ? at.y - r->size.y : 0;
    return hypot(x, y);
}

#endif
