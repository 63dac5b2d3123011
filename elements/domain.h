/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Domain: the world that things are arranged in, as arranging algorithms see it. */
#ifndef TZ_ELEMENTS_DOMAIN_H
#define TZ_ELEMENTS_DOMAIN_H

#include "elements/frames.h"
#include "elements/region.h"
#include "elements/zones.h"

/** Rectangle [0, size.x) x [0, size.y), plain or wrapped to a torus; what guides an
 * arrangement in it is borrowed: whoever made it frees it, after the last use. */
typedef struct tz_domain {
    tz_vec3 size;
    bool torus;
    const tz_region *region; /**< NULL = the whole rectangle */
    const tz_frames *frames; /**< NULL = the exemplar is never turned */
    const tz_zones *zones;   /**< NULL = every kind may lie anywhere */
} tz_domain;

/** Shortest vector from p to q; on a torus over the nearest copy. */
static inline tz_vec3 tz_domain_vector(const tz_domain *d, tz_vec3 p, tz_vec3 q)
{
    tz_vec3 v = {q.x - p.x, q.y - p.y, q.z - p.z};
    if (d->torus) { /* most are near enough already */
        if (v.x >= 0.5 * d->size.x || v.x < -0.5 * d->size.x)
            v.x -= floor(v.x / d->size.x + 0.5) * d->size.x;
        if (v.y >= 0.5 * d->size.y || v.y < -0.5 * d->size.y)
            v.y -= floor(v.y / d->size.y + 0.5) * d->size.y;
    }
    return v;
}

/** x brought into [0, size). Rounding may take a point just below 0 to `size` itself. */
static inline double tz_domain_wrap_axis(double x, double size)
{
    x -= floor(x / size) * size;
    return x >= 0 && x < size ? x : 0;
}

/** Copy of p inside the rectangle on a torus; p itself on a plain domain. */
static inline tz_vec3 tz_domain_wrap(const tz_domain *d, tz_vec3 p)
{
    if (d->torus) {
        p.x = tz_domain_wrap_axis(p.x, d->size.x);
        p.y = tz_domain_wrap_axis(p.y, d->size.y);
    }
    return p;
}

static inline bool tz_domain_contains(const tz_domain *d, tz_vec3 p)
{
    return (d->torus || (p.x >= 0 && p.y >= 0 && p.x < d->size.x && p.y < d->size.y)) &&
           (!d->region || tz_region_distance(d->region, p) > 0);
}

/** Signed distance to the nearest border, > 0 inside; HUGE_VAL on a torus without any. */
static inline double tz_domain_depth(const tz_domain *d, tz_vec3 p)
{
    double depth = HUGE_VAL;
    if (!d->torus) {
        const double x = fmin(p.x, d->size.x - p.x), y = fmin(p.y, d->size.y - p.y);
        depth = x < 0 && y < 0 ? -hypot(x, y) : fmin(x, y);
    }
    return d->region ? fmin(depth, tz_region_distance(d->region, p)) : depth;
}

/** Angle of the local frame: by how much the exemplar is turned here, radians. */
static inline double tz_domain_frame(const tz_domain *d, tz_vec3 p)
{
    return d->frames ? tz_frames_angle(d->frames, p) : 0;
}

/** How large things are here against the exemplar's, > 0. */
static inline double tz_domain_scale(const tz_domain *d, tz_vec3 p)
{
    return d->frames ? tz_frames_size(d->frames, p) : 1;
}

/** By which factor they lie farther apart here than in the exemplar, > 0. */
static inline double tz_domain_apart(const tz_domain *d, tz_vec3 p)
{
    return d->frames ? tz_frames_apart(d->frames, p) : 1;
}

/** Whether the zones let a kind lie here. */
static inline bool tz_domain_allows(const tz_domain *d, tz_vec3 p, int32_t kind)
{
    return !d->zones || tz_zones_allow(d->zones, p, kind);
}

/** Area that may be filled, user units squared. */
static inline double tz_domain_area(const tz_domain *d)
{
    return d->region ? d->region->area : d->size.x * d->size.y;
}

#endif
