/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Power diagram of weighted sites: to each site the places whose power |x - p|^2 - w to it
 * is least. Cells are clipped to the domain (rectangle, torus, region) and come with
 * their area, their centre and the sites they touch, which is the weighted Delaunay
 * triangulation. Made for sites that move a little between updates: a cell begins with
 * the neighbours it had.
 * @source Aurenhammer, Power diagrams, 1987; [Hsu20] Sec. Sample distribution, Fig. 7.
 *   Cells by clipping: Levy, Bonneel, Variational anisotropic surface meshing with Voronoi
 *   parallel linear enumeration, 2012 (security radius) */
#ifndef TZ_FIELDS_POWER_H
#define TZ_FIELDS_POWER_H

#include "elements/domain.h"

typedef struct tz_power tz_power;

/** Corner of a cell, from its site. Edge k runs from corner k to k + 1. */
typedef struct tz_power_corner {
    double x, y;
    int32_t site; /**< beyond edge k, -1 = the domain's border */
} tz_power_corner;

/** What all cells give; arrays of n, valid until the next update. */
typedef struct tz_power_cells {
    int32_t n;
    const double *area;    /**< inside the domain, user units squared, 0 = hidden */
    const tz_vec2 *centre; /**< of mass, from the site; 0, 0 where the area is 0 */
    const double *gap;     /**< greatest power of a corner that three cells share, inside
                                the domain; 0 = none */
    const tz_vec2 *gap_at; /**< that corner, from the site */
    const int32_t *start,
        *neighbour; /**< of site i: neighbour[start[i] .. start[i] + count[i] - 1],
                         each once, symmetric but for touches of no length */
    const int32_t *count;
} tz_power_cells;

/** @param domain  copied; its region is borrowed
 * @return TZ_OK; TZ_INVALID (no area); TZ_NOMEM */
TZ_API tz_status tz_power_new(tz_ctx *ctx, const tz_domain *domain, tz_power **out);
TZ_API void tz_power_free(tz_power *p); /**< takes NULL */

/** All cells anew.
 * @param at      finite, may lie anywhere (a site beyond the border has what is nearest);
 *                on a torus any copy; z is ignored
 * @param weight  squared radius, >= 0; -1 = no site: its cell is empty
 * @return TZ_OK; TZ_INVALID (a place is not a number, names the site); TZ_NOMEM;
 *   TZ_CANCELLED. After an error no cells are known
 * @cost O(n) for sites spread evenly, on all threads */
TZ_API tz_status tz_power_update(tz_power *p, int32_t n, const tz_vec3 *at,
                                 const double *weight);
/** Only what changes when some sites have moved, come (n grows), or gone (weight -1):
 * their cells, and those of their neighbours before and after. The result is that of
 * tz_power_update, but for rounding.
 * @param changed  indices below n, each once
 * @cost O(changed) cells, and a few ns a site */
TZ_API tz_status tz_power_change(tz_power *p, int32_t n, const tz_vec3 *at,
                                 const double *weight, int32_t changed,
                                 const int32_t *which);
TZ_API tz_power_cells tz_power_get(const tz_power *p);
/** One cell as a convex polygon, clipped to the rectangle or torus, not to the region.
 * @param most  room in out  @return corners; may exceed most; 0 = hidden */
TZ_API int32_t tz_power_cell(tz_power *p, int32_t i, tz_power_corner *out, int32_t most);

/** The same in a box [0, size): volumes, centres and neighbours of power cells, by
 * clipping polyhedra. For the mathematics of volumes, not for speed.
 * @param[out] volume, centre  n each; centre from the site
 * @param[out] neighbour  n * most, ended by -1 where fewer
 * @return TZ_OK; TZ_INVALID; TZ_LIMIT (over `most` neighbours); TZ_NOMEM
 * @cost O(n^2) */
TZ_API tz_status tz_power_solid(tz_ctx *ctx, tz_vec3 size, int32_t n, const tz_vec3 *at,
                                const double *weight, double *volume, tz_vec3 *centre,
                                int32_t *neighbour, int32_t most);

#endif
