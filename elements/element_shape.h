/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Plane geometry of outlines: flattening, smallest circle, moments, containment and
 * touching, and the medial axis. Not installed. */
#ifndef TZ_ELEMENTS_ELEMENT_SHAPE_H
#define TZ_ELEMENTS_ELEMENT_SHAPE_H

#include "base/svg.h"

typedef struct tz_box {
    double x0, y0, x1, y1;
} tz_box;

static inline tz_box tz_box_empty(void)
{
    return (tz_box){INFINITY, INFINITY, -INFINITY, -INFINITY};
}
static inline void tz_box_add(tz_box *b, tz_vec2 p)
{
    b->x0 = fmin(b->x0, p.x);
    b->y0 = fmin(b->y0, p.y);
    b->x1 = fmax(b->x1, p.x);
    b->y1 = fmax(b->y1, p.y);
}
static inline void tz_box_join(tz_box *b, tz_box o)
{
    tz_box_add(b, (tz_vec2){o.x0, o.y0});
    tz_box_add(b, (tz_vec2){o.x1, o.y1});
}
static inline double tz_box_diagonal(tz_box b) { return hypot(b.x1 - b.x0, b.y1 - b.y0); }

/** Polylines one behind another; part[k] is the first point of the k-th. */
typedef struct tz_polys {
    TZ_ARRAY(tz_vec2)
    point;
    TZ_ARRAY(int32_t)
    part;
    TZ_ARRAY(bool)
    closed; /**< by a Z, one a part */
} tz_polys;

void tz_polys_clear(tz_polys *p);
void tz_polys_deinit(tz_ctx *ctx, tz_polys *p);
/** Points of part k. */
const tz_vec2 *tz_polys_part(const tz_polys *p, int32_t k, int32_t *n);
/** Appends a path's subpaths, mapped, flattened to `tolerance` (in mapped units).
 * A subpath of a single point is left out. */
tz_status tz_polys_add_path(tz_ctx *ctx, tz_polys *p, const uint8_t *verb, int32_t verbs,
                            const tz_vec2 *point, tz_affine map, double tolerance);
/** Appends the outlines of `line`'s parts drawn with a pen of that width: one polygon for
 * an open line, two for a closed one.
 * @param capped  open ends reach half a width beyond their points */
tz_status tz_polys_add_stroke(tz_ctx *ctx, tz_polys *p, const tz_polys *line,
                              double width, bool capped);

/** Smallest circle about n > 0 points. @cost O(n) expected */
double tz_smallest_circle(tz_ctx *ctx, const tz_vec2 *p, int32_t n, tz_vec2 *centre);

typedef struct tz_moments {
    double area, perimeter;
    tz_vec2 centre;
    double angle;  /**< of the long axis, in (-pi, pi]; its heavier end points there */
    double aspect; /**< length over width by second moments, >= 1 */
} tz_moments;
/** Of all polygons together, each counted positive. */
tz_moments tz_polys_moments(const tz_polys *p);

/** Whether q lies inside the polygons, even-odd. */
bool tz_polys_contain(const tz_polys *p, tz_vec2 q);
bool tz_polygon_contains(const tz_vec2 *p, int32_t n, tz_vec2 q);
/** Whether two sets of polygons overlap, or touch along more than a corner. */
bool tz_polys_touch(const tz_polys *a, const tz_polys *b, double tolerance);

/** Middle line of a long or bent shape.
 * @param most  room in out
 * @param[out] out  points evenly spaced along the line, from its left end
 * @return how many; 1 (and the centre) where length over width is at most 2.2 */
tz_status tz_polys_axis(tz_ctx *ctx, const tz_polys *p, int32_t most, tz_vec2 *out,
                        int32_t *n);

#endif
