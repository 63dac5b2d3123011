/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Domain: the world that things are arranged in, as arranging algorithms see it. */
#ifndef TZ_ELEMENTS_DOMAIN_H
#define TZ_ELEMENTS_DOMAIN_H

#include "base/geom.h"

/** Rectangle [0, size.x) x [0, size.y), plain or wrapped to a torus. */
typedef struct tz_domain {
    tz_vec3 size;
    bool torus;
} tz_domain;

/** Shortest vector from p to q; on a torus over the nearest copy. */
static inline tz_vec3 tz_domain_vector(const tz_domain *d, tz_vec3 p, tz_vec3 q)
{
    tz_vec3 v = {q.x - p.x, q.y - p.y, q.z - p.z};
    if (d->torus) {
        v.x -= floor(v.x / d->size.x + 0.5) * d->size.x;
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
    return d->torus || (p.x >= 0 && p.y >= 0 && p.x < d->size.x && p.y < d->size.y);
}

#endif
