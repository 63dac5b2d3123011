/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Extents: how far a shape reaches from its reference point in each direction. Of two
 * elements the sum of their extents along the line between them tells how far apart they
 * touch, which for long or cornered shapes is far less than the sum of their radii. */
#ifndef TZ_ELEMENTS_EXTENT_H
#define TZ_ELEMENTS_EXTENT_H

#include "elements/element.h"

#define TZ_EXTENT_DIRECTIONS 64

/** Of one symbol: farthest point of its outline on the ray of each direction, over the
 * symbol's radius. */
typedef struct tz_extent {
    float r[TZ_EXTENT_DIRECTIONS];
} tz_extent;

/** Of all symbols of a set, in their order. */
typedef struct tz_extents {
    tz_extent *v;
    int32_t n;
    tz_ctx *ctx;
} tz_extents;

/** A symbol without an outline is a disc of its radius; no ray is shorter than a tenth of
 * that. @return TZ_OK; TZ_NOMEM @cost O(points of outlines * their angular spans) */
TZ_API tz_status tz_extents_init(tz_ctx *ctx, const tz_element_set *set, tz_extents *x);
TZ_API void tz_extents_deinit(tz_extents *x); /**< takes zeroed */

/** How far an element reaches in a direction of the world, radians; linear between rays. */
static inline double tz_extent_of(const tz_extents *x, const tz_element *e, double angle)
{
    const double turns = (angle - e->angle) / (2 * TZ_PI),
                 at = (turns - floor(turns)) * TZ_EXTENT_DIRECTIONS;
    const int32_t i = (int32_t)at & (TZ_EXTENT_DIRECTIONS - 1);
    const float *r = x->v[e->symbol].r;
    const double t = at - floor(at);
    return e->radius * (r[i] * (1 - t) + r[(i + 1) & (TZ_EXTENT_DIRECTIONS - 1)] * t);
}

/** Distance at which two elements touch, b lying from a in direction (dx, dy). */
static inline double tz_extent_touch(const tz_extents *x, const tz_element *a,
                                     const tz_element *b, double dx, double dy)
{
    const double angle = atan2(dy, dx);
    return tz_extent_of(x, a, angle) + tz_extent_of(x, b, angle + TZ_PI);
}

#endif
