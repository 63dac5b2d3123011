/* SPDX-License-Identifier: Apache-2.0 */
/* Power cells in a box: a convex polyhedron as its faces, each a loop of corners, cut by
 * one half-space after the other. A cut shortens the faces that it meets; the new face is
 * the convex polygon of the cut's own corners, put in order by their angle. Sites come by
 * rising distance, until none can reach the cell. */
#include <stdlib.h>

#include "base/array.h"
#include "fields/power.h"

typedef struct face {
    TZ_ARRAY(tz_vec3)
    v;
    int32_t site;
} face;

typedef struct solid {
    tz_ctx *ctx;
    TZ_ARRAY(face)
    face; /* `used` of them are in use; the others keep their room */
    int32_t used;
    TZ_ARRAY(tz_vec3)
    rim, kept;
    double far2;
} solid;

typedef struct other {
    double d2;
    int32_t site;
} other;

static double dot(tz_vec3 a, tz_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static tz_vec3 sub(tz_vec3 a, tz_vec3 b)
{
    return (tz_vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}
static tz_vec3 cross(tz_vec3 a, tz_vec3 b)
{
    return (tz_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static tz_status new_face(solid *s, int32_t site, face **out)
{
    tz_status st = TZ_OK;
    if (s->used == s->face.n)
        st = tz_array_push(s->ctx, &s->face, ((face){{0}, 0}));
    if (st == TZ_OK) {
        *out = &s->face.v[s->used++];
        (*out)->v.n = 0, (*out)->site = site;
    }
    return st;
}

static void measure_far(solid *s)
{
    s->far2 = 0;
    for (int32_t f = 0; f < s->used; f++)
        for (int32_t k = 0; k < s->face.v[f].v.n; k++)
            s->far2 = fmax(s->far2, dot(s->face.v[f].v.v[k], s->face.v[f].v.v[k]));
}

static tz_status begin(solid *s, tz_vec3 lo, tz_vec3 hi)
{
    static const int corner[6][4] = {{0, 2, 6, 4}, {1, 5, 7, 3}, {0, 4, 5, 1},
                                     {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 6, 7, 5}};
    tz_status st = TZ_OK;
    s->used = 0;
    for (int f = 0; f < 6 && st == TZ_OK; f++) {
        face *g = NULL;
        st = new_face(s, -1, &g);
        for (int k = 0; k < 4 && st == TZ_OK; k++) {
            const int c = corner[f][3 - k]; /* seen from outside, counter-clockwise */
            st = tz_array_push(s->ctx, &g->v,
                               ((tz_vec3){c & 1 ? hi.x : lo.x, c & 2 ? hi.y : lo.y,
                                          c & 4 ? hi.z : lo.z}));
        }
    }
    measure_far(s);
    return st;
}

/* What a face keeps; corners on the plane go to the rim. */
static tz_status cut_face(solid *s, face *f, tz_vec3 d, double limit)
{
    tz_status st = TZ_OK;
    s->kept.n = 0;
    for (int32_t i = 0; i < f->v.n && st == TZ_OK; i++) {
        const tz_vec3 a = f->v.v[i], b = f->v.v[(i + 1) % f->v.n];
        const double g = dot(a, d) - limit, h = dot(b, d) - limit;
        if (g <= 0)
            st = tz_array_push(s->ctx, &s->kept, a);
        if (st == TZ_OK && (g <= 0) != (h <= 0)) {
            const double t = g / (g - h);
            const tz_vec3 v = {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y),
                               a.z + t * (b.z - a.z)};
            st = tz_array_push(s->ctx, &s->kept, v);
            if (st == TZ_OK)
                st = tz_array_push(s->ctx, &s->rim, v);
        }
    }
    if (st == TZ_OK)
        st = tz_array_reserve(s->ctx, &f->v, s->kept.n);
    f->v.n = 0;
    for (int32_t i = 0; i < s->kept.n && st == TZ_OK; i++)
        f->v.v[f->v.n++] = s->kept.v[i];
    return st;
}

/* The rim in turn about d: corners come twice, from both faces that meet there. */
static tz_status close_rim(solid *s, tz_vec3 d, int32_t site)
{
    tz_vec3 c = {0, 0, 0};
    const int32_t n = s->rim.n;
    for (int32_t i = 0; i < n; i++)
        c.x += s->rim.v[i].x / n, c.y += s->rim.v[i].y / n, c.z += s->rim.v[i].z / n;
    const tz_vec3 u =
        cross(d, fabs(d.x) < fabs(d.y) ? (tz_vec3){1, 0, 0} : (tz_vec3){0, 1, 0});
    const tz_vec3 w = cross(d, u);
    const double lw = sqrt(dot(d, d));
    face *f = NULL;
    tz_status st = new_face(s, site, &f);
    if (st == TZ_OK)
        st = tz_array_reserve(s->ctx, &f->v, n);
    for (int32_t i = 0; i < n && st == TZ_OK; i++) {
        const tz_vec3 v = sub(s->rim.v[i], c);
        const double a = atan2(dot(v, w) / lw, dot(v, u));
        int32_t k = f->v.n++;
        for (; k > 0; k--) { /* insertion by angle */
            const tz_vec3 o = sub(f->v.v[k - 1], c);
            if (atan2(dot(o, w) / lw, dot(o, u)) <= a)
                break;
            f->v.v[k] = f->v.v[k - 1];
        }
        f->v.v[k] = s->rim.v[i];
    }
    return st;
}

static tz_status cut(solid *s, tz_vec3 d, double limit, int32_t site)
{
    bool any = false;
    for (int32_t f = 0; f < s->used && !any; f++)
        for (int32_t k = 0; k < s->face.v[f].v.n && !any; k++)
            any = dot(s->face.v[f].v.v[k], d) > limit + 1e-12 * (dot(d, d) + s->far2);
    if (!any)
        return TZ_OK;
    tz_status st = TZ_OK;
    s->rim.n = 0;
    for (int32_t f = 0; f < s->used && st == TZ_OK; f++)
        st = cut_face(s, &s->face.v[f], d, limit);
    int32_t kept = 0;
    for (int32_t f = 0; f < s->used; f++)
        if (s->face.v[f].v.n >= 3) {
            const face swap = s->face.v[kept];
            s->face.v[kept++] = s->face.v[f];
            s->face.v[f] = swap;
        }
    s->used = kept;
    if (st == TZ_OK && s->rim.n >= 3)
        st = close_rim(s, d, site);
    measure_far(s);
    return st;
}

/* Signed tetrahedra from the site to the fans of all faces. */
static double volume_of(const solid *s, tz_vec3 *centre)
{
    double sum = 0;
    tz_vec3 m = {0, 0, 0};
    for (int32_t f = 0; f < s->used; f++) {
        const face *g = &s->face.v[f];
        for (int32_t k = 2; k < g->v.n; k++) {
            const tz_vec3 a = g->v.v[0], b = g->v.v[k - 1], c = g->v.v[k];
            const double v = dot(a, cross(b, c)) / 6;
            sum += v;
            m.x += v * (a.x + b.x + c.x) / 4, m.y += v * (a.y + b.y + c.y) / 4;
            m.z += v * (a.z + b.z + c.z) / 4;
        }
    }
    *centre =
        fabs(sum) > 0 ? (tz_vec3){m.x / sum, m.y / sum, m.z / sum} : (tz_vec3){0, 0, 0};
    return fabs(sum);
}

static int by_distance(const void *a, const void *b)
{
    const other *p = a, *q = b;
    return p->d2 != q->d2 ? (p->d2 > q->d2) - (p->d2 < q->d2)
                          : (p->site > q->site) - (p->site < q->site);
}

static tz_status solid_cell(solid *s, tz_vec3 size, int32_t n, const tz_vec3 *at,
                            const double *weight, int32_t i, other *o)
{
    double most = 0;
    for (int32_t j = 0; j < n; j++) {
        const tz_vec3 d = sub(at[j], at[i]);
        o[j] = (other){dot(d, d), j};
        most = fmax(most, weight[j]);
    }
    qsort(o, (size_t)n, sizeof *o, by_distance);
    tz_status st = begin(s, sub((tz_vec3){0, 0, 0}, at[i]), sub(size, at[i]));
    for (int32_t k = 0; k < n && st == TZ_OK && s->used > 0; k++) {
        const int32_t j = o[k].site;
        const double reach = sqrt(s->far2) + sqrt(fmax(0, s->far2 - weight[i] + most));
        if (o[k].d2 > reach * reach)
            break;
        if (j == i)
            continue;
        if (o[k].d2 == 0) {
            if (weight[j] > weight[i] || (weight[j] == weight[i] && j < i))
                s->used = 0;
            continue;
        }
        st = cut(s, sub(at[j], at[i]), (o[k].d2 + weight[i] - weight[j]) / 2, j);
    }
    return st;
}

tz_status tz_power_solid(tz_ctx *ctx, tz_vec3 size, int32_t n, const tz_vec3 *at,
                         const double *weight, double *volume, tz_vec3 *centre,
                         int32_t *neighbour, int32_t most)
{
    solid s = {.ctx = ctx};
    other *o = NULL;
    tz_status st = TZ_OK;
    if (!(size.x > 0) || !(size.y > 0) || !(size.z > 0))
        return tz_fail(ctx, TZ_INVALID, "power diagram: a box of %g x %g x %g is empty",
                       size.x, size.y, size.z);
    for (int32_t i = 0; i < n; i++)
        if (!isfinite(at[i].x + at[i].y + at[i].z + weight[i]))
            return tz_fail(ctx, TZ_INVALID,
                           "power diagram: place or weight of site %d is not a number",
                           i);
    st = tz_alloc(ctx, &o, (size_t)n, sizeof *o);
    for (int32_t i = 0; i < n && st == TZ_OK; i++) {
        int32_t *near = neighbour + (ptrdiff_t)i * most, k = 0;
        st = solid_cell(&s, size, n, at, weight, i, o);
        volume[i] = st == TZ_OK ? volume_of(&s, &centre[i]) : 0;
        for (int32_t f = 0; f < s.used && st == TZ_OK; f++) {
            if (s.face.v[f].site < 0)
                continue;
            if (k == most)
                st = tz_fail(ctx, TZ_LIMIT,
                             "power diagram: site %d has over %d neighbours", i, most);
            else
                near[k++] = s.face.v[f].site;
        }
        for (; k < most; k++)
            near[k] = -1;
    }
    for (int32_t f = 0; f < s.face.n; f++)
        tz_array_free(ctx, &s.face.v[f].v);
    tz_array_free(ctx, &s.face);
    tz_array_free(ctx, &s.rim);
    tz_array_free(ctx, &s.kept);
    tz_free(ctx, o);
    return st;
}
