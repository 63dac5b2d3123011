/* SPDX-License-Identifier: Apache-2.0 */
/* The exemplar's own lines between the samples of a graph.
 *
 * An edge p q that is like the exemplar's edge P Q takes its curve C through the
 * similarity S that maps P to p and Q to q. It then leaves p in the direction a and
 * arrives at q in the direction b, while it is to do so in a*, b*: with u the share of the
 * length L,
 *
 *     C*(u) = S C(u) + D(u),   D(0) = D(1) = 0,  D'(0) = L (a* - a),  D'(1) = L (b* - b),
 *
 * D the cubic with these values. On each cubic of C, where u is taken to be linear in t,
 * D is a cubic, too: its control points are added. What small kinks that leaves inside are
 * turned out.
 *
 * Where two edges run on into each other, the mean of their directions is taken, less the
 * kink that the exemplar has there itself if they follow each other in it, too: so a graph
 * that is its own exemplar gives the drawing back. A curve that would have to be stretched
 * too far, or to fold, is interpolated. */
#include "curves/reconstruct_internal.h"

#include <string.h>

#define STRETCH 2.0  /* of a shape, either way */
#define FOLD    0.25 /* cosine of the angle by which a tangent may turn */
#define SMOOTH  0.02 /* rad: a joint of the exemplar's line that has no kink */
#define ON_LINE 1e-7 /* of the length: off the thirds of a straight line */

static double angle_of(tz_vec2 v) { return tz_curve_angle(atan2(v.y, v.x)); }

/* Direction in which a curve leaves its first point; 0, 0 for a point. */
static tz_vec2 leaving(const tz_bezier *c)
{
    for (int k = 1; k < 4; k++) {
        const tz_vec2 d = tz_vec2_sub(c->p[k], c->p[0]);
        const double n = tz_vec2_length(d);
        if (n > 0)
            return tz_vec2_scale(d, 1 / n);
    }
    return (tz_vec2){0, 0};
}

static tz_bezier reversed(const tz_bezier *c)
{
    return (tz_bezier){{c->p[3], c->p[2], c->p[1], c->p[0]}};
}

static tz_vec2 arriving(const tz_bezier *c)
{
    const tz_bezier r = reversed(c);
    return tz_vec2_scale(leaving(&r), -1);
}

static bool on_thirds(const tz_bezier *c, double tolerance)
{
    const tz_bezier l = tz_bezier_line(c->p[0], c->p[3]);
    const double n = tz_vec2_length(tz_vec2_sub(c->p[3], c->p[0]));
    return n > 0 && tz_vec2_length(tz_vec2_sub(c->p[1], l.p[1])) <= tolerance * n &&
           tz_vec2_length(tz_vec2_sub(c->p[2], l.p[2])) <= tolerance * n;
}

/* ---- the exemplar's curve of an edge ------------------------------------------------ */

/* Its i-th curve in the direction of the output's edge, and the number of that in the
 * exemplar's arrays. */
static tz_bezier shape_at(const tz_rebuild *k, const tz_curve_edge *e, int32_t i,
                          int32_t *number)
{
    const tz_curve_edge *l = &k->exemplar->edge.v[e->like];
    *number = e->back ? l->shape + l->shapes - 1 - i : l->shape + i;
    const tz_bezier *c = &k->exemplar->shape.v[*number];
    return e->back ? reversed(c) : *c;
}

/* The similarity that takes the exemplar's curve to the edge; false if it is too far from
 * a motion. */
static bool edge_map(const tz_rebuild *k, const tz_curve_edge *e, tz_affine *map)
{
    int32_t id;
    const int32_t n = k->exemplar->edge.v[e->like].shapes;
    const tz_bezier head = shape_at(k, e, 0, &id), tail = shape_at(k, e, n - 1, &id);
    const tz_vec2 p = k->g->sample.v[e->from].at,
                  q = tz_curve_copy(&k->g->domain, k->g->sample.v[e->to].at, p);
    const tz_vec2 u = tz_vec2_sub(tail.p[3], head.p[0]), v = tz_vec2_sub(q, p);
    const double n2 = tz_vec2_dot(u, u), scale = tz_vec2_length(v) / sqrt(n2);
    if (!(n2 > 0) || !(scale < STRETCH) || !(scale > 1 / STRETCH))
        return false;
    const double a = tz_vec2_dot(u, v) / n2, b = (u.x * v.y - u.y * v.x) / n2;
    *map = (tz_affine){a,
                       b,
                       -b,
                       a,
                       p.x - a * head.p[0].x + b * head.p[0].y,
                       p.y - b * head.p[0].x - a * head.p[0].y};
    return true;
}

static tz_bezier mapped(tz_affine m, const tz_bezier *c)
{
    tz_bezier out;
    for (int i = 0; i < 4; i++)
        out.p[i] = tz_affine_apply(m, c->p[i]);
    return out;
}

/* Shapes of all edges through their maps. */
static tz_status map_edge(tz_rebuild *k, int32_t edge)
{
    const tz_curve_edge *e = &k->g->edge.v[edge];
    const tz_sample_graph *x = k->exemplar;
    tz_affine map;
    tz_status s = TZ_OK;
    if (e->like < 0 || x->edge.v[e->like].shapes == 0 || !edge_map(k, e, &map))
        return TZ_OK;
    for (int32_t i = 0; i < x->edge.v[e->like].shapes && s == TZ_OK; i++) {
        int32_t id;
        const tz_bezier c = shape_at(k, e, i, &id);
        tz_rebuild_shape r = {.curve = mapped(map, &c),
                              .straight = on_thirds(&c, ON_LINE)};
        r.carry = (tz_curve_carry){
            .origin = c, .has_taper = x->taper.n > 0, .has_origin = true};
        if (r.carry.has_taper) {
            const tz_curve_taper t = x->taper.v[id];
            r.carry.taper = e->back ? (tz_curve_taper){t.to, t.from} : t;
        }
        s = tz_array_push(k->ctx, &k->shape, r);
    }
    return s;
}

/* ---- directions ---------------------------------------------------------------------- */

static bool has_shape(const tz_rebuild *k, int32_t end)
{
    return k->first[(end >> 1) + 1] > k->first[end >> 1];
}

/* Direction in which the mapped curve leaves an end. */
static double shape_tangent(const tz_rebuild *k, int32_t end)
{
    const int32_t e = end >> 1;
    if (!(end & 1))
        return angle_of(leaving(&k->shape.v[k->first[e]].curve));
    return angle_of(tz_vec2_scale(arriving(&k->shape.v[k->first[e + 1] - 1].curve), -1));
}

/* End of the exemplar's edge that an end is like: 2 e or 2 e + 1 as here. */
static int32_t like_end(const tz_rebuild *k, int32_t end)
{
    const tz_curve_edge *e = &k->g->edge.v[end >> 1];
    return 2 * e->like + ((end & 1) ^ (int32_t)e->back);
}

static double like_tangent(const tz_rebuild *k, int32_t end)
{
    const tz_sample_graph *x = k->exemplar;
    const tz_curve_edge *e = &x->edge.v[end >> 1];
    if (!(end & 1))
        return angle_of(leaving(&x->shape.v[e->shape]));
    return angle_of(tz_vec2_scale(arriving(&x->shape.v[e->shape + e->shapes - 1]), -1));
}

static int32_t like_sample(const tz_rebuild *k, int32_t end)
{
    const tz_curve_edge *e = &k->exemplar->edge.v[end >> 1];
    return end & 1 ? e->to : e->from;
}

/* The kink that the exemplar has where x runs on into y. */
static double kink(const tz_rebuild *k, int32_t x, int32_t y)
{
    const int32_t a = like_end(k, x), b = like_end(k, y);
    if (like_sample(k, a) != like_sample(k, b) || a >> 1 == b >> 1)
        return 0;
    return tz_rebuild_turn(like_tangent(k, a), like_tangent(k, b) + TZ_PI);
}

/* Directions that edges with shapes are to have; interpolated ones follow them. */
static void agree(tz_rebuild *k)
{
    const int32_t ends = 2 * k->g->edge.n;
    for (int32_t x = 0; x < ends; x++)
        if (has_shape(k, x))
            k->tangent[x] = shape_tangent(k, x);
    for (int32_t x = 0; x < ends; x++) {
        const int32_t y = k->next[x];
        if (y < x) /* none, or seen from there */
            continue;
        const bool a = has_shape(k, x), b = has_shape(k, y);
        if (a && b) {
            const double off =
                tz_rebuild_turn(k->tangent[x], k->tangent[y] + TZ_PI + kink(k, x, y));
            k->tangent[x] = tz_curve_angle(k->tangent[x] - off / 2);
            k->tangent[y] = tz_curve_angle(k->tangent[y] + off / 2);
        } else if (a) {
            k->tangent[y] = tz_curve_angle(k->tangent[x] + TZ_PI);
        } else if (b) {
            k->tangent[x] = tz_curve_angle(k->tangent[y] + TZ_PI);
        }
    }
}

/* ---- bending ------------------------------------------------------------------------- */

static tz_vec2 unit(double a) { return (tz_vec2){cos(a), sin(a)}; }

/* A handle of that length in that direction. */
static tz_vec2 handle(tz_vec2 at, tz_vec2 to, double angle)
{
    const double n = tz_vec2_length(tz_vec2_sub(to, at));
    return tz_vec2_add(at, tz_vec2_scale(unit(angle), n));
}

/* Joints that had no kink get none; the ends leave as they are to. */
static void align(tz_rebuild_shape *v, int32_t n, const bool *smooth, double a, double b)
{
    v[0].curve.p[1] = handle(v[0].curve.p[0], v[0].curve.p[1], a);
    v[n - 1].curve.p[2] = handle(v[n - 1].curve.p[3], v[n - 1].curve.p[2], b);
    for (int32_t i = 0; i + 1 < n; i++) {
        if (!smooth[i])
            continue;
        const double in = angle_of(arriving(&v[i].curve)),
                     on = angle_of(leaving(&v[i + 1].curve));
        const double mean = in + tz_rebuild_turn(on, in) / 2;
        v[i].curve.p[2] = handle(v[i].curve.p[3], v[i].curve.p[2], mean + TZ_PI);
        v[i + 1].curve.p[1] = handle(v[i + 1].curve.p[0], v[i + 1].curve.p[1], mean);
    }
}

/* Whether the bent curve folds against the one it was. */
static bool folds(const tz_bezier *was, const tz_bezier *is)
{
    for (int i = 0; i <= 4; i++) {
        const tz_vec2 u = tz_bezier_slope(was, i / 4.0), v = tz_bezier_slope(is, i / 4.0);
        const double m = tz_vec2_length(u), n = tz_vec2_length(v);
        if (m > 0 && !(tz_vec2_dot(u, v) >= FOLD * fmax(m * n, m * m)))
            return true;
    }
    return false;
}

/* Adds D to the shapes of an edge. False: they cannot be bent so. */
static bool bend(tz_rebuild_shape *v, int32_t n, double a, double b, double *along,
                 bool *smooth)
{
    double length = 0;
    for (int32_t i = 0; i < n; i++) {
        along[i] = length;
        length += tz_bezier_length(&v[i].curve);
        if (i + 1 < n)
            smooth[i] = fabs(tz_rebuild_turn(angle_of(leaving(&v[i + 1].curve)),
                                             angle_of(arriving(&v[i].curve)))) < SMOOTH;
    }
    along[n] = length;
    const tz_vec2 d0 = tz_vec2_sub(unit(a), leaving(&v[0].curve)),
                  d1 = tz_vec2_sub(unit(b + TZ_PI), arriving(&v[n - 1].curve));
    if (!(length > 0) || tz_vec2_length(d0) + tz_vec2_length(d1) < 1e-9)
        return length > 0;
    const tz_bezier d = {
        {{0, 0}, tz_vec2_scale(d0, length / 3), tz_vec2_scale(d1, -length / 3), {0, 0}}};
    for (int32_t i = 0; i < n; i++) {
        const tz_bezier by = tz_bezier_part(&d, along[i] / length, along[i + 1] / length),
                        was = v[i].curve;
        for (int j = 0; j < 4; j++)
            v[i].curve.p[j] = tz_vec2_add(v[i].curve.p[j], by.p[j]);
        if (folds(&was, &v[i].curve))
            return false;
    }
    align(v, n, smooth, a, b);
    return true;
}

/* Ends to the bit at the samples; what has come out straight is. */
static void settle(tz_rebuild *k, int32_t edge)
{
    const tz_curve_edge *e = &k->g->edge.v[edge];
    tz_rebuild_shape *v = k->shape.v + k->first[edge];
    const int32_t n = k->first[edge + 1] - k->first[edge];
    const tz_vec2 p = k->g->sample.v[e->from].at;
    v[0].curve.p[0] = p;
    v[n - 1].curve.p[3] = tz_curve_copy(&k->g->domain, k->g->sample.v[e->to].at, p);
    for (int32_t i = 0; i < n; i++) {
        if (i > 0)
            v[i].curve.p[0] = v[i - 1].curve.p[3];
        v[i].straight = v[i].straight && on_thirds(&v[i].curve, 10 * ON_LINE);
    }
}

static tz_status bend_all(tz_rebuild *k)
{
    int32_t most = 0, at = 0;
    double *along = NULL;
    bool *smooth = NULL;
    for (int32_t e = 0; e < k->g->edge.n; e++) {
        const int32_t n = k->first[e + 1] - k->first[e];
        most = n > most ? n : most;
    }
    tz_status s = tz_alloc(k->ctx, &along, (size_t)most + 1, sizeof *along);
    if (s == TZ_OK)
        s = tz_alloc(k->ctx, &smooth, (size_t)most + 1, sizeof *smooth);
    for (int32_t e = 0; e < k->g->edge.n && s == TZ_OK; e++) {
        const int32_t first = k->first[e], n = k->first[e + 1] - first;
        const bool good = n > 0 && bend(k->shape.v + first, n, k->tangent[2 * e],
                                        k->tangent[2 * e + 1], along, smooth);
        if (good)
            settle(k, e);
        k->first[e] = at;
        if (good && at < first)
            memmove(k->shape.v + at, k->shape.v + first, (size_t)n * sizeof *k->shape.v);
        at += good ? n : 0;
    }
    k->first[k->g->edge.n] = at;
    tz_free(k->ctx, along);
    tz_free(k->ctx, smooth);
    return s;
}

tz_status tz_rebuild_detail(tz_rebuild *k)
{
    const int32_t n = k->g->edge.n;
    tz_status s = tz_alloc(k->ctx, &k->first, (size_t)n + 1, sizeof *k->first);
    for (int32_t e = 0; e < n && s == TZ_OK; e++) {
        k->first[e] = k->shape.n;
        s = map_edge(k, e);
    }
    if (s != TZ_OK)
        return s;
    k->first[n] = k->shape.n;
    agree(k);
    return bend_all(k);
}
