/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A shape as a few discs: medial-axis discs of an outline that cover it, overlapping, of
 * different radii, joined to a graph; and the shape itself as signed distances.
 * @source [Hsu20] Sec. Sampling, Fig. 6 (weighted samples and graph); Wang et al.,
 *   Variational sphere set approximation, 2006 (cost of what is left out) */
#ifndef TZ_FIELDS_DISC_COVER_H
#define TZ_FIELDS_DISC_COVER_H

#include "base/array.h"
#include "base/geom.h"

#define TZ_COVER_DISCS 16 /**< at most */

typedef struct tz_disc {
    tz_vec2 at;
    double radius;
} tz_disc;

/** Distances to an outline on a grid, > 0 inside, bilinear between the points. */
typedef struct tz_shape_distance {
    tz_vec2 origin; /**< of point 0, 0 */
    double cell;
    int32_t width, height;
    float *v;
} tz_shape_distance;

typedef struct tz_disc_cover {
    int32_t n;
    tz_disc disc[TZ_COVER_DISCS]; /**< largest first */
    int32_t edges;
    int32_t edge[4 * TZ_COVER_DISCS][2]; /**< a < b; connected, also where the shape is in
                                              pieces */
    double area;                         /**< of the shape */
    double covered;                      /**< share of it that the discs cover */
    double beyond; /**< share of the discs' union that lies outside */
    tz_shape_distance distance;
    tz_ctx *ctx;
} tz_disc_cover;

/** @param point, part  closed polygons, as in tz_element_symbol, whose union is the shape;
 *                      no polygon = a disc of `radius` about the origin
 * @param radius  of the shape's circle about the origin
 * @param most    discs wanted at most, 1 .. TZ_COVER_DISCS
 * @param share   of the area that the discs, a little larger, are to cover; 0.97 is usual
 * @param[out] c  overwritten; zeroed on error
 * @return TZ_OK; TZ_INVALID (numbers that are not finite, radius not above 0); TZ_NOMEM
 * @cost O(points + 64^2 * discs) */
TZ_API tz_status tz_disc_cover_init(tz_ctx *ctx, const tz_vec2 *point, int32_t points,
                                    const int32_t *part, int32_t parts, double radius,
                                    int32_t most, double share, tz_disc_cover *c);
TZ_API void tz_disc_cover_deinit(tz_disc_cover *c); /**< takes zeroed */

/** Signed distance at a place, > 0 inside; beyond the grid less the way to it.
 * @param[out] slope  NULL, or its gradient: points inwards */
TZ_API double tz_shape_distance_at(const tz_shape_distance *d, tz_vec2 at,
                                   tz_vec2 *slope);

#endif
