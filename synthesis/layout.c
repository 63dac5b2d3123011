/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Layout: placements in one array in drawing order, their borders in one pool. Appending
 * is amortised O(1) in placements and O(n) in border points; nothing is linked, so that a
 * layout of some hundred thousand pieces stays a few dozen megabytes in three blocks. */
#include "synthesis/layout.h"

#include <string.h>

/* Boxes are clamped to this, far outside of any layout, so that int32 sums cannot wrap.
 */
#define TZ_BOX_LIMIT 500000000.0

tz_status tz_layout_init(tz_ctx *ctx, tz_layout *l, int32_t width, int32_t height,
                         bool tile)
{
    if (width < 1 || height < 1 || width > TZ_IMAGE_MAX_SIDE ||
        height > TZ_IMAGE_MAX_SIDE)
        return tz_fail(ctx, TZ_INVALID,
                       "layout of %d x %d px: each side must be from 1 to %d px", width,
                       height, TZ_IMAGE_MAX_SIDE);
    *l = (tz_layout){.width = width, .height = height, .tile = tile, .ctx = ctx};
    return TZ_OK;
}

void tz_layout_deinit(tz_layout *l)
{
    for (int32_t i = 0; i < l->source.n; i++)
        tz_free(l->ctx, l->source.v[i].path);
    tz_array_free(l->ctx, &l->source);
    tz_array_free(l->ctx, &l->place);
    tz_array_free(l->ctx, &l->border);
    tz_free(l->ctx, l->recipe);
    *l = (tz_layout){0};
}

tz_status tz_layout_add_source(tz_layout *l, const char *path, const char *sha256,
                               int32_t width, int32_t height, int32_t *id)
{
    if (!path || !*path)
        return tz_fail(l->ctx, TZ_INVALID, "layout source without a path: name its file");
    if (width < 1 || height < 1 || width > TZ_IMAGE_MAX_SIDE ||
        height > TZ_IMAGE_MAX_SIDE)
        return tz_fail(l->ctx, TZ_INVALID,
                       "%s: source of %d x %d px: each side must be from 1 to %d px",
                       path, width, height, TZ_IMAGE_MAX_SIDE);
    tz_layout_source s = {.width = width, .height = height};
    if (sha256) {
        size_t n = strlen(sha256);
        if (n && (n != 64 || strspn(sha256, "0123456789abcdef") != 64))
            return tz_fail(l->ctx, TZ_INVALID,
                           "%s: SHA-256 must be 64 lower-case hex digits", path);
        memcpy(s.sha256, sha256, n + 1);
    }
    tz_status st = tz_array_reserve(l->ctx, &l->source, (int64_t)l->source.n + 1);
    if (!st)
        st = tz_strdup(l->ctx, path, &s.path);
    if (st)
        return st;
    if (id)
        *id = l->source.n;
    l->source.v[l->source.n++] = s;
    return TZ_OK;
}

tz_status tz_layout_add(tz_layout *l, int32_t source, int32_t group, tz_affine map,
                        const tz_point *border, int32_t n, int32_t *id)
{
    if (source < 0 || source >= l->source.n)
        return tz_fail(l->ctx, TZ_INVALID, "placement of source %d: the layout has %d",
                       source, l->source.n);
    if (n < 3)
        return tz_fail(l->ctx, TZ_INVALID,
                       "placement with %d border points: 3 are needed", n);
    tz_affine inverse;
    if (!tz_affine_invert(map, &inverse))
        return tz_fail(l->ctx, TZ_INVALID, "placement whose map cannot be inverted");
    for (int32_t i = 0; i < n; i++)
        if (!isfinite(border[i].x) || !isfinite(border[i].y))
            return tz_fail(l->ctx, TZ_INVALID,
                           "placement with a border point not finite");
    tz_status st = tz_array_reserve(l->ctx, &l->place, (int64_t)l->place.n + 1);
    if (st)
        return st;
    /* the caller's points may lie in our own pool, which moves when it grows */
    ptrdiff_t own = -1;
    if (l->border.v && border >= l->border.v && border < l->border.v + l->border.n)
        own = border - l->border.v;
    st = tz_array_reserve(l->ctx, &l->border, (int64_t)l->border.n + n);
    if (st)
        return st;
    if (own >= 0)
        border = l->border.v + own;
    tz_placement p = {.map = map,
                      .source = source,
                      .group = group,
                      .border = l->border.n,
                      .points = n,
                      .medium = TZ_MEDIUM_EDGE_GROUP};
    for (int32_t i = 0; i < n;
         i++) /* + 0 turns -0, which documents do not keep, into 0 */
        l->border.v[l->border.n++] = (tz_point){border[i].x + 0.0f, border[i].y + 0.0f};
    if (id)
        *id = l->place.n;
    l->place.v[l->place.n++] = p;
    return TZ_OK;
}

/** Bounds of a placement's border in layout coordinates, not rounded. */
static void bounds(const tz_layout *l, const tz_placement *p, double lo[2], double hi[2])
{
    lo[0] = lo[1] = INFINITY;
    hi[0] = hi[1] = -INFINITY;
    const tz_point *b = l->border.v + p->border;
    for (int32_t i = 0; i < p->points; i++) {
        tz_vec2 q = tz_affine_apply(p->map, (tz_vec2){b[i].x, b[i].y});
        lo[0] = fmin(lo[0], q.x);
        lo[1] = fmin(lo[1], q.y);
        hi[0] = fmax(hi[0], q.x);
        hi[1] = fmax(hi[1], q.y);
    }
}

/** NaN gives lo. */
static double clamp(double v, double lo, double hi)
{
    return v > lo ? (v < hi ? v : hi) : lo;
}

tz_rect tz_layout_box(const tz_layout *l, int32_t id)
{
    double lo[2], hi[2];
    bounds(l, &l->place.v[id], lo, hi);
    for (int k = 0; k < 2; k++) {
        lo[k] = clamp(floor(lo[k]), -TZ_BOX_LIMIT, TZ_BOX_LIMIT);
        hi[k] = clamp(ceil(hi[k]), -TZ_BOX_LIMIT, TZ_BOX_LIMIT);
    }
    return (tz_rect){(int32_t)lo[0], (int32_t)lo[1], (int32_t)(hi[0] - lo[0]),
                     (int32_t)(hi[1] - lo[1])};
}

/** Even-odd rule, half open, on the mapped border: needs no inverse map. */
static bool covers(const tz_layout *l, const tz_placement *p, double x, double y)
{
    const tz_point *b = l->border.v + p->border;
    bool in = false;
    tz_vec2 u =
        tz_affine_apply(p->map, (tz_vec2){b[p->points - 1].x, b[p->points - 1].y});
    for (int32_t i = 0; i < p->points; i++) {
        tz_vec2 v = tz_affine_apply(p->map, (tz_vec2){b[i].x, b[i].y});
        if ((u.y > y) != (v.y > y) && x < (v.x - u.x) * (y - u.y) / (v.y - u.y) + u.x)
            in = !in;
        u = v;
    }
    return in;
}

int32_t tz_layout_at(const tz_layout *l, tz_vec2 p)
{
    double w = l->width, h = l->height;
    if (!isfinite(p.x) || !isfinite(p.y))
        return -1;
    if (l->tile) {
        p.x -= floor(p.x / w) * w;
        p.y -= floor(p.y / h) * h;
    } else if (p.x < 0 || p.y < 0 || p.x >= w || p.y >= h) {
        return -1;
    }
    for (int32_t id = l->place.n - 1; id >= 0; id--) {
        const tz_placement *q = &l->place.v[id];
        if (q->removed)
            continue;
        double lo[2], hi[2];
        bounds(l, q, lo, hi);
        if (!l->tile) {
            if (p.x >= lo[0] && p.x <= hi[0] && p.y >= lo[1] && p.y <= hi[1] &&
                covers(l, q, p.x, p.y))
                return id;
            continue;
        }
        /* every copy p + (i w, j h) of the point that falls into the box */
        double i0 = ceil((lo[0] - p.x) / w), i1 = floor((hi[0] - p.x) / w);
        double j0 = ceil((lo[1] - p.y) / h), j1 = floor((hi[1] - p.y) / h);
        if (!((i1 - i0 + 1) * (j1 - j0 + 1) <= 4096))
            continue; /* absurdly large */
        for (double j = j0; j <= j1; j++)
            for (double i = i0; i <= i1; i++)
                if (covers(l, q, p.x + i * w, p.y + j * h))
                    return id;
    }
    return -1;
}

tz_status tz_layout_compact(tz_layout *l)
{
    int64_t points = 0;
    for (int32_t i = 0; i < l->place.n; i++)
        if (!l->place.v[i].removed)
            points += l->place.v[i].points;
    /* placements may share border points; then the pool may be smaller than the sum, and
     * is left as it is unless that saves anything */
    if (points < l->border.n) {
        tz_point *pool = NULL;
        tz_status st = tz_alloc(l->ctx, &pool, (size_t)points, sizeof *pool);
        if (st)
            return st;
        int32_t n = 0;
        for (int32_t i = 0; i < l->place.n; i++) {
            tz_placement *p = &l->place.v[i];
            if (p->removed)
                continue;
            memcpy(pool + n, l->border.v + p->border, (size_t)p->points * sizeof *pool);
            p->border = n;
            n += p->points;
        }
        tz_free(l->ctx, l->border.v);
        l->border.v = pool;
        l->border.n = l->border.cap = n;
    }
    int32_t n = 0;
    for (int32_t i = 0; i < l->place.n; i++)
        if (!l->place.v[i].removed)
            l->place.v[n++] = l->place.v[i];
    l->place.n = n;
    return TZ_OK;
}

/* FNV-1a over the six numbers' bytes; -0 counts as 0. */
uint32_t tz_layout_stamp(tz_affine m)
{
    const double v[6] = {m.a + 0.0, m.b + 0.0, m.c + 0.0,
                         m.d + 0.0, m.e + 0.0, m.f + 0.0};
    uint8_t byte[sizeof v];
    uint32_t h = 2166136261U;
    memcpy(byte, v, sizeof v);
    for (size_t k = 0; k < sizeof v; k++)
        h = (h ^ byte[k]) * 16777619U;
    return h;
}
