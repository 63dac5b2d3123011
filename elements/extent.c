/* SPDX-License-Identifier: Apache-2.0 */
#include "elements/extent.h"

#include <math.h>

/* Shortest ray, of the radius. */
static const float least = 0.1F;

/** Raises the rays that an edge of an outline crosses. */
static void cross(tz_extent *x, tz_vec2 p, tz_vec2 q)
{
    const double turn = 2 * TZ_PI / TZ_EXTENT_DIRECTIONS;
    const double from = atan2(p.y, p.x);
    double span = atan2(q.y, q.x) - from; /* the shorter way round */
    span -= 2 * TZ_PI * floor(span / (2 * TZ_PI) + 0.5);
    const double lo = span < 0 ? from + span : from, hi = span < 0 ? from : from + span;
    const tz_vec2 d = tz_vec2_sub(q, p);
    for (double k = ceil(lo / turn - 1e-9); k <= hi / turn + 1e-9; k++) {
        const double c = cos(k * turn), s = sin(k * turn);
        const double det = d.x * s - d.y * c; /* of p + t d = r (c, s) */
        double r;
        if (fabs(det) > 1e-12 * (fabs(d.x) + fabs(d.y)))
            r = (p.y * d.x - p.x * d.y) / det;
        else
            r = fmax(tz_vec2_length(p), tz_vec2_length(q));
        r = fmin(r, fmax(tz_vec2_length(p), tz_vec2_length(q)));
        const int32_t i = (int32_t)llrint(k) & (TZ_EXTENT_DIRECTIONS - 1);
        x->r[i] = fmaxf(x->r[i], (float)r);
    }
}

static tz_extent extent_of(const tz_element_symbol *y)
{
    tz_extent x = {{0}};
    for (int32_t k = 0; k < y->part.n; k++) {
        const int32_t from = y->part.v[k],
                      to = k + 1 < y->part.n ? y->part.v[k + 1] : y->outline.n;
        for (int32_t i = from; i < to; i++)
            cross(&x, y->outline.v[i], y->outline.v[i + 1 < to ? i + 1 : from]);
    }
    const bool disc = y->outline.n < 2 || y->part.n == 0;
    for (int32_t i = 0; i < TZ_EXTENT_DIRECTIONS; i++)
        x.r[i] = disc ? 1 : fmaxf(x.r[i] / (float)y->radius, least);
    return x;
}

tz_status tz_extents_init(tz_ctx *ctx, const tz_element_set *set, tz_extents *x)
{
    *x = (tz_extents){.n = set->symbol.n, .ctx = ctx};
    tz_status s = tz_alloc(ctx, &x->v, (size_t)x->n, sizeof *x->v);
    for (int32_t i = 0; s == TZ_OK && i < x->n; i++)
        x->v[i] = extent_of(&set->symbol.v[i]);
    if (s != TZ_OK)
        *x = (tz_extents){0};
    return s;
}

void tz_extents_deinit(tz_extents *x)
{
    tz_free(x->ctx, x->v);
    *x = (tz_extents){0};
}
