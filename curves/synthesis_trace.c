/* SPDX-License-Identifier: Apache-2.0 */
/* Curves whose origins are known, as a graph in the exemplar's own rhythm: samples lie
 * where the exemplar's lie, so that what was copied matches without any difference and
 * stays as it is, and only what was changed has work to do.
 *
 *     exemplar   o----.----.----o          o junction   . sample   x cut
 *     start      o----.----.-x-.----o      those that origins pass, not an even division
 *
 * Junctions, ends and corners of the start are samples anyhow; where no sample of the
 * exemplar is passed for long, the way is divided evenly as in any sampling. */
#include <stdlib.h>
#include <string.h>

#include "base/grid.h"
#include "curves/curve_join.h"
#include "curves/synthesis_internal.h"

#define ON     0.02 /* of the spacing: a sample this near to an origin lies on it */
#define NEAR   0.2  /* of the spacing: a passed sample this near to a node is none */
#define LONG   1.6  /* of the spacing: a way this long is divided */
#define CORNER (TZ_PI / 9) /* turn that makes a node a sample */

/* A place of a path that is a sample. */
typedef struct stop {
    double along; /* from the beginning of the path */
    double t;     /* on its piece */
    int32_t piece;
    int32_t node; /* of the set, -1 = inside a piece */
    int32_t like; /* the exemplar's sample, -1 = none */
    int32_t made; /* its sample, -1 = none yet */
} stop;

typedef struct tracer {
    tz_curve_solve *t;
    tz_curve_set set; /* joined, crossings too */
    tz_grid grid;     /* samples of the exemplar's curves */
    TZ_ARRAY(int32_t)
    who;             /* sample of each item of the grid */
    int32_t *degree; /* per node */
    int32_t *sample; /* per node: its sample, -1 = none yet */
    double *length;  /* per piece */
    TZ_ARRAY(stop)
    stop; /* of one path */
} tracer;

/* ---- stops -------------------------------------------------------------------------- */

static tz_vec2 direction(const tracer *k, int32_t piece, double t)
{
    const tz_bezier c = tz_curve_bezier(&k->set, &k->set.piece.v[piece]);
    tz_vec2 v = tz_bezier_slope(&c, t);
    if (!(tz_vec2_length(v) > 0))
        v = tz_vec2_sub(c.p[3], c.p[0]);
    return v;
}

static double turn_between(tz_vec2 u, tz_vec2 v)
{
    return fabs(atan2(u.x * v.y - u.y * v.x, tz_vec2_dot(u, v)));
}

/* Parameter of the place of a curve that is nearest to p: the nearest of some, then by
 * ternary search between its neighbours. */
static double project(const tz_bezier *c, tz_vec2 p, double *far)
{
    enum { STEPS = 24 };
    double best = INFINITY;
    int at = 0;
    for (int i = 0; i <= STEPS; i++) {
        const double d =
            tz_vec2_length(tz_vec2_sub(tz_bezier_at(c, (double)i / STEPS), p));
        if (d < best) {
            best = d;
            at = i;
        }
    }
    double lo = fmax(at - 1, 0) / STEPS, hi = fmin(at + 1, STEPS) / STEPS;
    for (int i = 0; i < 40; i++) {
        const double a = lo + (hi - lo) / 3, b = hi - (hi - lo) / 3;
        const double u = tz_vec2_length(tz_vec2_sub(tz_bezier_at(c, a), p));
        const double v = tz_vec2_length(tz_vec2_sub(tz_bezier_at(c, b), p));
        *(u < v ? &hi : &lo) = u < v ? b : a;
    }
    *far = tz_vec2_length(tz_vec2_sub(tz_bezier_at(c, (lo + hi) / 2), p));
    return (lo + hi) / 2;
}

/* Samples of the exemplar that the origin of a piece passes. */
static tz_status find_passed(tracer *k, int32_t piece, double along)
{
    enum { MOST = 256 };
    const tz_curve_model *x = k->t->x;
    int32_t found[MOST];
    tz_status s = TZ_OK;
    if (k->set.origin.n != k->set.piece.n || !isfinite(k->set.origin.v[piece].p[0].x))
        return s;
    const tz_bezier *o = &k->set.origin.v[piece];
    const tz_bezier c = tz_curve_bezier(&k->set, &k->set.piece.v[piece]);
    const double reach = ON * x->g.spacing, half = tz_bezier_length(o) / 2;
    const int32_t n =
        tz_grid_query(&k->grid, tz_bezier_at(o, 0.5), 1.5 * half + reach, found, MOST);
    for (int32_t i = 0; i < (n < MOST ? n : MOST) && s == TZ_OK; i++) {
        const int32_t like = k->who.v[found[i]];
        double far;
        const double t = project(o, x->g.sample.v[like].at, &far);
        if (far > reach)
            continue;
        const tz_bezier part = tz_bezier_part(&c, 0, t);
        s = tz_array_push(
            k->t->ctx, &k->stop,
            ((stop){along + tz_bezier_length(&part), t, piece, -1, like, -1}));
    }
    return s;
}

static bool is_stop(const tracer *k, const tz_curve_path *p, int32_t i)
{
    const int32_t last = p->piece + p->pieces - 1;
    const int32_t before = i > p->piece ? i - 1 : p->closed ? last : -1;
    if (before < 0 || k->degree[k->set.piece.v[i].from] != 2)
        return true;
    return turn_between(direction(k, before, 1), direction(k, i, 0)) > CORNER;
}

static int by_place(const void *a, const void *b)
{
    const stop *p = a, *q = b;
    if (p->along != q->along)
        return p->along < q->along ? -1 : 1;
    return (p->node < q->node) - (p->node > q->node);
}

/* Passed samples beside nodes, or beside each other, are none: nodes take over what they
 * are like. */
static void thin_stops(tracer *k)
{
    const double near = NEAR * k->t->x->apart;
    int32_t n = 0;
    for (int32_t i = 0; i < k->stop.n; i++) {
        const stop *p = &k->stop.v[i];
        stop *q = n > 0 ? &k->stop.v[n - 1] : NULL;
        if (q && p->along - q->along < near && (p->node < 0 || q->node < 0)) {
            const int32_t like = q->like >= 0 ? q->like : p->like;
            if (q->node < 0)
                *q = *p;
            q->like = like;
            continue;
        }
        k->stop.v[n++] = *p;
    }
    k->stop.n = n;
}

static tz_status find_stops(tracer *k, const tz_curve_path *p, double *length)
{
    const int32_t end = p->piece + p->pieces;
    double along = 0;
    tz_status s = TZ_OK;
    k->stop.n = 0;
    for (int32_t i = p->piece; i < end && s == TZ_OK; i++) {
        if (is_stop(k, p, i))
            s = tz_array_push(k->t->ctx, &k->stop,
                              ((stop){along, 0, i, k->set.piece.v[i].from, -1, -1}));
        if (s == TZ_OK)
            s = find_passed(k, i, along);
        along += k->length[i];
    }
    if (s == TZ_OK && !p->closed)
        s = tz_array_push(
            k->t->ctx, &k->stop,
            ((stop){along, 1, end - 1, k->set.piece.v[end - 1].to, -1, -1}));
    if (s == TZ_OK && k->stop.n == 0)
        s = tz_array_push(
            k->t->ctx, &k->stop,
            ((stop){0, 0, p->piece, k->set.piece.v[p->piece].from, -1, -1}));
    if (s == TZ_OK && k->stop.n > 1)
        qsort(k->stop.v, (size_t)k->stop.n, sizeof *k->stop.v, by_place);
    thin_stops(k);
    *length = along;
    return s;
}

/* ---- samples and edges -------------------------------------------------------------- */

static tz_status sample_at(tracer *k, stop *p, int32_t *id)
{
    tz_curve_solve *t = k->t;
    if (p->node >= 0 && k->sample[p->node] >= 0)
        p->made = k->sample[p->node];
    if (p->made >= 0) {
        *id = p->made;
        return TZ_OK;
    }
    const tz_bezier c = tz_curve_bezier(&k->set, &k->set.piece.v[p->piece]);
    const tz_vec2 at = tz_curve_wrapped(t->job->domain, tz_bezier_at(&c, p->t));
    *id = p->made = t->o.sample.n;
    if (p->node >= 0)
        k->sample[p->node] = *id;
    return tz_curve_solve_add(
        t,
        &(tz_curve_sample){.at = at, .q = TZ_SAMPLE_CURVE, .element = -1, .existence = 1},
        p->like);
}

/* The place so far along the path. */
static stop place(const tracer *k, const tz_curve_path *p, double along, double length)
{
    double from = 0;
    int32_t i = p->piece;
    along -= along > length ? length : 0;
    while (i + 1 < p->piece + p->pieces && from + k->length[i] < along)
        from += k->length[i++];
    const double t = k->length[i] > 0 ? (along - from) / k->length[i] : 0;
    return (stop){along, fmin(fmax(t, 0), 1), i, -1, -1, -1};
}

/* From one stop to the next, divided where that is far. */
static tz_status add_way(tracer *k, const tz_curve_path *p, stop *a, stop *b,
                         double length, bool alone)
{
    tz_curve_solve *t = k->t;
    const double way = b->along - a->along + (b->along > a->along ? 0 : length);
    const double unit = t->x->g.spacing;
    int32_t n = way > LONG * unit ? (int32_t)fmin(floor(way / unit + 0.5), 1e6) : 1;
    int32_t id[2];
    if (alone && n < 3)
        n = 3;
    tz_status s = sample_at(k, a, &id[0]);
    for (int32_t i = 1; i <= n && s == TZ_OK; i++) {
        stop mid = place(k, p, a->along + way * i / n, length);
        s = sample_at(k, i == n ? b : &mid, &id[1]);
        if (s == TZ_OK && id[0] != id[1])
            s = tz_array_push(t->ctx, &t->o.edge,
                              ((tz_curve_edge){.from = id[0],
                                               .to = id[1],
                                               .pen = p->pen,
                                               .existence = 1,
                                               .like = -1}));
        id[0] = id[1];
    }
    return s;
}

static tz_status trace_path(tracer *k, const tz_curve_path *p)
{
    double length;
    tz_status s = find_stops(k, p, &length);
    const int32_t n = p->closed ? k->stop.n : k->stop.n - 1;
    for (int32_t i = 0; i < n && s == TZ_OK && length > 0; i++)
        s = add_way(k, p, &k->stop.v[i], &k->stop.v[(i + 1) % k->stop.n], length,
                    k->stop.n == 1);
    return s;
}

static int by_ends(const void *a, const void *b)
{
    const tz_curve_edge *p = a, *q = b;
    const int32_t u = p->from < p->to ? p->from : p->to,
                  v = q->from < q->to ? q->from : q->to;
    if (u != v)
        return u < v ? -1 : 1;
    const int32_t x = p->from + p->to - u, y = q->from + q->to - v;
    return (x > y) - (x < y);
}

/* Orientations as edges leave; the search and the votes see to the rest. Of edges between
 * the same two samples one stays. */
static tz_status finish(tz_curve_solve *t, int32_t first_sample, int32_t first_edge)
{
    tz_sample_graph *g = &t->o;
    tz_curve_edge *e = g->edge.v + first_edge;
    const int32_t all = g->edge.n - first_edge;
    int32_t n = 0;
    if (all > 1)
        qsort(e, (size_t)all, sizeof *e, by_ends);
    for (int32_t i = 0; i < all; i++)
        if (n == 0 || by_ends(&e[n - 1], &e[i]) != 0)
            e[n++] = e[i];
    g->edge.n = first_edge + n;
    tz_status s = tz_sample_graph_link(g);
    for (int32_t i = first_sample; i < g->sample.n && s == TZ_OK; i++) {
        tz_curve_sample *p = &g->sample.v[i];
        const int32_t like = t->match.v[i];
        const double frame = tz_curve_solve_frame(t, p->at);
        p->turn = g->turn.n;
        p->turns = like >= 0 ? t->x->g.sample.v[like].turns : p->links;
        for (int32_t j = 0; j < p->turns && s == TZ_OK; j++) {
            double a;
            if (like >= 0) {
                a = t->x->g.turn.v[t->x->g.sample.v[like].turn + j] + frame;
            } else {
                const tz_vec2 v = tz_curve_vector(
                    t->job->domain, p->at, g->sample.v[g->link.v[p->link + j].to].at);
                a = atan2(v.y, v.x);
            }
            s = tz_array_push(t->ctx, &g->turn, tz_curve_angle(a));
        }
    }
    return s;
}

/* ---- all ---------------------------------------------------------------------------- */

static tz_status prepare(tracer *k, const tz_curve_set *from)
{
    const tz_curve_join_params join = {.crossings = true};
    const tz_sample_graph *g = &k->t->x->g;
    const tz_vec2 size = {g->domain.size.x, g->domain.size.y};
    tz_ctx *ctx = k->t->ctx;
    int32_t id;
    tz_status s = tz_curve_join(ctx, from, &join, &k->set);
    if (s == TZ_OK)
        s = tz_grid_init(ctx, &k->grid, (tz_vec2){0, 0}, size, g->spacing, false);
    for (int32_t i = 0; i < g->sample.n && s == TZ_OK; i++) {
        if (g->sample.v[i].q != TZ_SAMPLE_CURVE || k->t->x->cut[i])
            continue;
        s = tz_grid_add(ctx, &k->grid, g->sample.v[i].at, &id);
        if (s == TZ_OK)
            s = tz_array_push(ctx, &k->who, i);
    }
    const size_t nodes = s == TZ_OK ? (size_t)k->set.node.n : 0;
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &k->degree, nodes, sizeof *k->degree);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &k->sample, nodes, sizeof *k->sample);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &k->length, (size_t)k->set.piece.n, sizeof *k->length);
    if (s != TZ_OK)
        return s;
    memset(k->sample, 255, nodes * sizeof *k->sample);
    for (int32_t i = 0; i < k->set.piece.n; i++) {
        const tz_bezier c = tz_curve_bezier(&k->set, &k->set.piece.v[i]);
        k->length[i] = tz_bezier_length(&c);
        k->degree[k->set.piece.v[i].from]++;
        k->degree[k->set.piece.v[i].to]++;
    }
    return TZ_OK;
}

tz_status tz_curve_solve_trace(tz_curve_solve *t, const tz_curve_set *from)
{
    tracer k;
    const int32_t first = t->o.sample.n, edges = t->o.edge.n;
    memset(&k, 0, sizeof k);
    k.t = t;
    tz_status s = prepare(&k, from);
    for (int32_t i = 0; i < k.set.path.n && s == TZ_OK; i++)
        s = trace_path(&k, &k.set.path.v[i]);
    if (s == TZ_OK)
        s = finish(t, first, edges);
    tz_curve_set_deinit(&k.set);
    tz_grid_deinit(t->ctx, &k.grid);
    tz_array_free(t->ctx, &k.who);
    tz_array_free(t->ctx, &k.stop);
    tz_free(t->ctx, k.degree);
    tz_free(t->ctx, k.sample);
    tz_free(t->ctx, k.length);
    return s;
}
