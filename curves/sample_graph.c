/* SPDX-License-Identifier: Apache-2.0 */
/* Sampling. The paths are joined, crossings too; what is left are pieces between nodes.
 * Nodes that are not the inside of a smooth path (any number of ends but two, or a
 * corner) are samples; the runs of pieces between them are sampled evenly by length:
 *
 *     junction o----.----.----o corner        n = round(length / spacing) steps
 *                              \
 *                               o end
 *
 * A corner is where the directions of the path over a window of a tenth of the spacing on
 * either side differ by more than pi / 9: the same angle by which reconstruction tells a
 * path that runs on from two that end. Of corners nearer than a quarter of the spacing
 * the sharpest stays. A run gets one more sample where it is a loop, or where its two
 * samples are joined already: the graph is simple.
 *
 * Directions are tangents of the run at the sample, measured over a short way, second
 * order, so that the noise of drawn lines does not count. */
#include "curves/sample_graph.h"

#include <stdlib.h>
#include <string.h>

#include "curves/curve_join.h"

#define MAX_SAMPLES 4000000
#define WINDOW      0.1  /* of the spacing: a corner's */
#define APART       0.25 /* of the spacing: corners */
#define TANGENT     0.2  /* of the spacing: way that a tangent is measured over */

/* Points of a path with the length up to each; on a torus not wrapped. */
typedef struct polyline {
    TZ_ARRAY(tz_vec2)
    point;
    TZ_ARRAY(double)
    along;
    TZ_ARRAY(int32_t)
    node; /* of the joined set that the point is, or -1 */
    TZ_ARRAY(tz_bezier)
    curve; /* the path's pieces, not wrapped */
    TZ_ARRAY(int32_t)
    first;         /* point that each of them begins at */
    tz_vec2 round; /* from the last point to the first: on a torus a closed path may
                           run around */
    int32_t piece; /* first of the path */
    bool closed;
} polyline;

typedef struct sampler {
    tz_ctx *ctx;
    tz_sample_graph *g;
    tz_curve_set set; /* joined */
    int32_t *degree;  /* per node */
    int32_t *sample;  /* per node: its sample, or -1 */
    polyline line;
    TZ_ARRAY(int32_t)
    stop; /* points of the line that are samples, in order */
    TZ_ARRAY(double)
    sharp; /* per stop: turn of a corner; INFINITY for other samples */
    TZ_ARRAY(uint64_t)
    joined; /* pairs of samples that have an edge: hash set, 0 = empty */
    int32_t pairs;
} sampler;

/* ---- lines ------------------------------------------------------------------------- */

static tz_status add_point(sampler *k, tz_vec2 p, int32_t node)
{
    polyline *l = &k->line;
    const double step =
        l->point.n > 0 ? tz_vec2_length(tz_vec2_sub(p, l->point.v[l->point.n - 1])) : 0;
    const double along = l->point.n > 0 ? l->along.v[l->along.n - 1] + step : 0;
    tz_status s = tz_array_push(k->ctx, &l->point, p);
    if (s == TZ_OK)
        s = tz_array_push(k->ctx, &l->along, along);
    return s == TZ_OK ? tz_array_push(k->ctx, &l->node, node) : s;
}

/* A piece that begins where the one before it has ended. */
static tz_status add_curve(sampler *k, int32_t piece, tz_vec2 *by)
{
    const tz_curve_piece *p = &k->set.piece.v[piece];
    polyline *l = &k->line;
    const tz_bezier b = tz_curve_through(&k->set, p, by);
    tz_status s = tz_array_push(k->ctx, &l->first, l->point.n - 1);
    if (s == TZ_OK)
        s = tz_array_push(k->ctx, &l->curve, b);
    const int32_t n = p->straight ? 1 : 1 + tz_bezier_steps(&b, 0.002 * k->g->spacing);
    for (int32_t j = 1; j < n && s == TZ_OK; j++)
        s = add_point(k, tz_bezier_at(&b, (double)j / n), -1);
    return s == TZ_OK ? add_point(k, b.p[3], p->to) : s;
}

static tz_status flatten(sampler *k, const tz_curve_path *p)
{
    const tz_curve_set *set = &k->set;
    polyline *l = &k->line;
    tz_vec2 by = {0, 0};
    l->point.n = l->along.n = l->node.n = l->curve.n = l->first.n = 0;
    l->closed = p->closed;
    l->piece = p->piece;
    const int32_t first = set->piece.v[p->piece].from;
    tz_status s = add_point(k, set->node.v[first], first);
    for (int32_t i = p->piece; i < p->piece + p->pieces && s == TZ_OK; i++)
        s = add_curve(k, i, &by);
    if (s == TZ_OK)
        l->round = by;
    return s;
}

static double length_of(const polyline *l) { return l->along.v[l->along.n - 1]; }

/* Brings a way into the line: around it where it is closed. How often it was around. */
static double bring_in(const polyline *l, double *along)
{
    const double length = length_of(l);
    double turns = 0;
    if (l->closed && length > 0 && !(*along >= 0 && *along <= length)) {
        turns = floor(*along / length);
        *along -= turns * length;
    }
    *along = fmin(fmax(*along, 0), length);
    return turns;
}

/* The chord of the line, by its later point, that a way lies on; t runs along it. */
static int32_t chord_at(const polyline *l, double along, double *t)
{
    int32_t lo = 0, hi = l->along.n - 1;
    while (hi - lo > 1) {
        const int32_t mid = lo + (hi - lo) / 2;
        *(l->along.v[mid] <= along ? &lo : &hi) = mid;
    }
    const double way = l->along.v[hi] - l->along.v[lo];
    *t = way > 0 ? (along - l->along.v[lo]) / way : 0;
    return hi;
}

/* The place so far along a line; beyond its ends it wraps around or stops. */
static tz_vec2 place(const polyline *l, double along)
{
    double t;
    const double turns = bring_in(l, &along);
    const int32_t hi = chord_at(l, along, &t);
    const tz_vec2 p = l->point.v[hi - 1], q = l->point.v[hi];
    return (tz_vec2){p.x + t * (q.x - p.x) + turns * l->round.x,
                     p.y + t * (q.y - p.y) + turns * l->round.y};
}

/* Piece of the path, counted from 0, and the t on it, so far along. */
static int32_t piece_at(const polyline *l, double along, double *t)
{
    double u;
    const int32_t at = chord_at(l, along, &u) - 1;
    int32_t lo = 0, hi = l->first.n;
    while (hi - lo > 1) {
        const int32_t mid = lo + (hi - lo) / 2;
        *(l->first.v[mid] <= at ? &lo : &hi) = mid;
    }
    const int32_t end = lo + 1 < l->first.n ? l->first.v[lo + 1] : l->point.n - 1;
    *t = (at - l->first.v[lo] + u) / (end - l->first.v[lo]);
    return lo;
}

/* The point of the curve itself so far along. */
static tz_vec2 on_curve(const polyline *l, double along)
{
    double t;
    const double turns = bring_in(l, &along);
    const int32_t i = piece_at(l, along, &t);
    const tz_vec2 p = tz_bezier_at(&l->curve.v[i], t);
    return (tz_vec2){p.x + turns * l->round.x, p.y + turns * l->round.y};
}

/* ---- what is a sample -------------------------------------------------------------- */

/* Turn of the path at a place, 0 = straight on. */
static double turn_at(const polyline *l, double along, double window)
{
    const tz_vec2 p = place(l, along), a = place(l, along - window),
                  b = place(l, along + window);
    const tz_vec2 u = tz_vec2_sub(p, a), v = tz_vec2_sub(b, p);
    const double m = tz_vec2_length(u), n = tz_vec2_length(v);
    if (!(m > 0) || !(n > 0))
        return 0;
    return fabs(atan2(u.x * v.y - u.y * v.x, tz_vec2_dot(u, v)));
}

static tz_status add_stop(sampler *k, int32_t point, double sharp)
{
    const tz_status s = tz_array_push(k->ctx, &k->stop, point);
    return s == TZ_OK ? tz_array_push(k->ctx, &k->sharp, sharp) : s;
}

/* A corner too near to sharper stops goes. */
static void thin_stops(sampler *k)
{
    const double apart = APART * k->g->spacing;
    const double *along = k->line.along.v;
    int32_t n = 0;
    for (int32_t i = 0; i < k->stop.n; i++) {
        bool keep = true;
        /* those kept so far that are near and blunter give way */
        while (n > 0 && k->sharp.v[i] > k->sharp.v[n - 1] &&
               along[k->stop.v[i]] - along[k->stop.v[n - 1]] < apart)
            n--;
        if (isfinite(k->sharp.v[i]) && n > 0)
            keep = along[k->stop.v[i]] - along[k->stop.v[n - 1]] >= apart;
        if (!keep)
            continue;
        k->stop.v[n] = k->stop.v[i];
        k->sharp.v[n++] = k->sharp.v[i];
    }
    k->stop.n = k->sharp.n = n;
}

/* Points of the line that must be samples: its ends, junctions, corners. */
static tz_status find_stops(sampler *k)
{
    const polyline *l = &k->line;
    const int32_t last = l->point.n - 1;
    tz_status s = TZ_OK;
    k->stop.n = k->sharp.n = 0;
    for (int32_t i = 0; i <= last && s == TZ_OK; i++) {
        const int32_t node = l->node.v[i];
        if (node < 0 || (l->closed && i == last))
            continue;
        const bool end = !l->closed && (i == 0 || i == last);
        if (end || k->degree[node] != 2) {
            s = add_stop(k, i, INFINITY);
            continue;
        }
        const double window = fmin(WINDOW * k->g->spacing, 0.25 * length_of(l));
        const double turn = turn_at(l, l->along.v[i], window);
        if (turn > TZ_PI / 9)
            s = add_stop(k, i, turn);
    }
    if (s == TZ_OK)
        thin_stops(k);
    return s;
}

/* ---- the graph --------------------------------------------------------------------- */

static tz_status too_many(const sampler *k)
{
    return tz_fail(k->ctx, TZ_LIMIT,
                   "over %d samples at a spacing of %g; choose a larger one, or keep the "
                   "lines within the drawing",
                   MAX_SAMPLES, k->g->spacing);
}

static tz_status add_sample(sampler *k, tz_vec2 at, int32_t *id)
{
    tz_sample_graph *g = k->g;
    const tz_vec3 in = tz_domain_wrap(&g->domain, (tz_vec3){at.x, at.y, 0});
    const tz_curve_sample p = {
        .at = {in.x, in.y}, .q = TZ_SAMPLE_CURVE, .element = -1, .existence = 1};
    if (g->sample.n >= MAX_SAMPLES)
        return too_many(k);
    *id = g->sample.n;
    return tz_array_push(k->ctx, &g->sample, p);
}

static tz_status sample_of(sampler *k, int32_t point, int32_t *id)
{
    const int32_t node = k->line.node.v[point];
    *id = k->sample[node];
    if (*id >= 0)
        return TZ_OK;
    const tz_status s = add_sample(k, k->set.node.v[node], id);
    if (s == TZ_OK)
        k->sample[node] = *id;
    return s;
}

static uint64_t pair_key(int32_t a, int32_t b)
{
    const uint64_t lo = (uint64_t)(a < b ? a : b), hi = (uint64_t)(a < b ? b : a);
    return (hi + 1) << 32 | lo;
}

/* Slot of a pair in the hash set: its own or an empty one. */
static int32_t pair_slot(const sampler *k, uint64_t key)
{
    const uint32_t mask = (uint32_t)k->joined.n - 1;
    uint32_t at = (uint32_t)((key * 0x9e3779b97f4a7c15u) >> 33) & mask;
    while (k->joined.v[at] && k->joined.v[at] != key)
        at = (at + 1) & mask;
    return (int32_t)at;
}

static bool is_joined(const sampler *k, int32_t a, int32_t b)
{
    return k->joined.n > 0 && k->joined.v[pair_slot(k, pair_key(a, b))] != 0;
}

static tz_status grow_pairs(sampler *k)
{
    const int32_t n = k->joined.n > 0 ? 2 * k->joined.n : 1024;
    uint64_t *old = k->joined.v;
    const int32_t before = k->joined.n;
    uint64_t *v = NULL;
    const tz_status s = tz_alloc_zero(k->ctx, &v, (size_t)n, sizeof *v);
    if (s != TZ_OK)
        return s;
    k->joined.v = v;
    k->joined.n = k->joined.cap = n;
    for (int32_t i = 0; i < before; i++)
        if (old[i])
            v[pair_slot(k, old[i])] = old[i];
    tz_free(k->ctx, old);
    return TZ_OK;
}

/* Direction at a place of the line, forwards or backwards, over a short way that stays
 * within `way`: 2 p'(0) h = 4 p(h) - 3 p(0) - p(2 h). */
static double direction(const polyline *l, double along, double way, bool inside)
{
    const double h = inside ? way : way / 2;
    tz_vec2 d;
    if (inside) {
        d = tz_vec2_sub(place(l, along + h), place(l, along - h));
    } else {
        const tz_vec2 p = place(l, along), q = place(l, along + h),
                      r = place(l, along + 2 * h);
        d = (tz_vec2){4 * q.x - 3 * p.x - r.x, 4 * q.y - 3 * p.y - r.y};
    }
    return tz_curve_angle(atan2(d.y, d.x));
}

/* An edge with the directions in which the curve leaves its samples; they are kept beside
 * the edge until all links are there. */
static tz_status add_edge(sampler *k, int32_t from, int32_t to, int32_t pen,
                          const double turn[2])
{
    tz_sample_graph *g = k->g;
    tz_status s = TZ_OK;
    if (2 * k->pairs >= k->joined.n)
        s = grow_pairs(k);
    if (s != TZ_OK)
        return s;
    const uint64_t key = pair_key(from, to);
    k->joined.v[pair_slot(k, key)] = key;
    k->pairs++;
    s = tz_array_push(
        k->ctx, &g->edge,
        ((tz_curve_edge){
            .from = from, .to = to, .pen = pen, .existence = 1, .like = -1}));
    for (int i = 0; i < 2 && s == TZ_OK; i++)
        s = tz_array_push(k->ctx, &g->turn, turn[i]);
    return s;
}

/* One curve of an edge, moved by `by`. */
static tz_status add_shape(sampler *k, int32_t piece, const double t[2], tz_vec2 by)
{
    tz_sample_graph *g = k->g;
    const tz_bezier *whole = &k->line.curve.v[piece];
    tz_bezier c = tz_bezier_part(whole, t[0], t[1]);
    tz_curve_carry carry = tz_curve_carried(&k->set, k->line.piece + piece);
    double size = 0;
    for (int i = 0; i < 4; i++) {
        size = fmax(size, tz_vec2_length(tz_vec2_sub(c.p[i], c.p[0])));
        c.p[i] = tz_vec2_add(c.p[i], by);
    }
    if (!(size > 1e-9 * g->spacing))
        return TZ_OK; /* rounding has left a point */
    tz_status s = tz_array_push(k->ctx, &g->shape, c);
    if (s == TZ_OK && carry.has_taper) {
        carry = tz_curve_carry_part(&carry, whole, t[0], t[1]);
        s = tz_array_push(k->ctx, &g->taper, carry.taper);
    }
    if (s == TZ_OK)
        g->edge.v[g->edge.n - 1].shapes++;
    return s;
}

/* What the last edge runs along: the line from a0 to a1, from its first sample on. */
static tz_status add_shapes(sampler *k, double a0, double a1)
{
    enum { AROUND = 3 };
    const polyline *l = &k->line;
    tz_curve_edge *e = &k->g->edge.v[k->g->edge.n - 1];
    double from = a0, to = a1, t0, t1;
    const double turns = bring_in(l, &from), last = bring_in(l, &to);
    int32_t i = piece_at(l, from, &t0);
    const int32_t end = piece_at(l, to, &t1);
    const tz_vec2 p = tz_bezier_at(&l->curve.v[i], t0), at = k->g->sample.v[e->from].at;
    tz_vec2 by = tz_vec2_sub(tz_curve_copy(&k->g->domain, p, at), p);
    double round = turns;
    e->shape = k->g->shape.n;
    tz_status s = TZ_OK;
    for (int32_t n = 0; n <= AROUND * l->curve.n && s == TZ_OK; n++) {
        const bool done = i == end && round >= last;
        const double t[2] = {t0, done ? t1 : 1};
        if (t[1] > t[0])
            s = add_shape(k, i, t, by);
        if (done)
            break;
        t0 = 0;
        if (++i == l->curve.n) {
            i = 0;
            round++;
            by = tz_vec2_add(by, l->round);
        }
    }
    return s;
}

/* How many steps a run of that length takes. */
static int32_t count_steps(const sampler *k, double length, int32_t from, int32_t to)
{
    const double n = floor(length / k->g->spacing + 0.5);
    const int32_t least = from == to ? 3 : is_joined(k, from, to) ? 2 : 1;
    return n < least ? least : n > MAX_SAMPLES ? MAX_SAMPLES : (int32_t)n;
}

/* Samples and edges from a0 to a1 along the line. On a closed line without stops the
 * first sample is inside, too. */
static tz_status add_run(sampler *k, double a0, double a1, const int32_t end[2],
                         int32_t pen, bool smooth)
{
    const polyline *l = &k->line;
    const int32_t n = count_steps(k, a1 - a0, end[0], end[1]);
    const double step = (a1 - a0) / n;
    if (n > MAX_SAMPLES - k->g->sample.n)
        return too_many(k);
    const double way = fmin(TANGENT * k->g->spacing, 0.25 * step);
    int32_t at = end[0], next = -1;
    double ahead = direction(l, a0, way, smooth);
    tz_status s = TZ_OK;
    for (int32_t i = 1; i <= n && s == TZ_OK; i++) {
        const double along = i == n ? a1 : a0 + i * step;
        const bool inside = i < n || smooth;
        next = end[1];
        if (i < n)
            s = add_sample(k, on_curve(l, along), &next);
        const double on = inside ? direction(l, along, way, true) : 0;
        const double back =
            inside ? tz_curve_angle(on + TZ_PI) : direction(l, along, -way, false);
        const double turn[2] = {ahead, back};
        if (s == TZ_OK)
            s = add_edge(k, at, next, pen, turn);
        if (s == TZ_OK)
            s = add_shapes(k, i == 1 ? a0 : a0 + (i - 1) * step, along);
        at = next;
        ahead = on;
    }
    return s;
}

static tz_status sample_path(sampler *k, const tz_curve_path *p)
{
    const polyline *l = &k->line;
    int32_t end[2];
    tz_status s = flatten(k, p);
    if (s == TZ_OK)
        s = find_stops(k);
    if (s != TZ_OK || !(length_of(l) > 0))
        return s;
    if (k->stop.n == 0) { /* a smooth loop */
        s = sample_of(k, 0, &end[0]);
        end[1] = end[0];
        return s == TZ_OK ? add_run(k, 0, length_of(l), end, p->pen, true) : s;
    }
    const int32_t runs = l->closed ? k->stop.n : k->stop.n - 1;
    for (int32_t i = 0; i < runs && s == TZ_OK; i++) {
        const int32_t j = (i + 1) % k->stop.n;
        const double a0 = l->along.v[k->stop.v[i]];
        double a1 = l->along.v[k->stop.v[j]];
        if (j <= i)
            a1 += length_of(l);
        s = sample_of(k, k->stop.v[i], &end[0]);
        if (s == TZ_OK)
            s = sample_of(k, k->stop.v[j], &end[1]);
        if (s == TZ_OK)
            s = add_run(k, a0, a1, end, p->pen, false);
    }
    return s;
}

static tz_status sample_paths(sampler *k)
{
    const tz_curve_set *set = &k->set;
    const size_t n = (size_t)set->node.n;
    tz_status s = tz_alloc_zero(k->ctx, &k->degree, n, sizeof *k->degree);
    if (s == TZ_OK)
        s = tz_alloc(k->ctx, &k->sample, n, sizeof *k->sample);
    if (s != TZ_OK)
        return s;
    memset(k->sample, 255, n * sizeof *k->sample);
    for (int32_t i = 0; i < set->piece.n; i++) {
        k->degree[set->piece.v[i].from]++;
        k->degree[set->piece.v[i].to]++;
    }
    for (int32_t i = 0; i < set->path.n && s == TZ_OK; i++) {
        s = sample_path(k, &set->path.v[i]);
        if (s == TZ_OK && !(i & 255) && tz_ctx_cancelled(k->ctx))
            s = TZ_CANCELLED;
    }
    return s;
}

/* ---- turns ------------------------------------------------------------------------- */

/* Turns from the order of edges into that of links. */
static tz_status sort_turns(sampler *k)
{
    tz_sample_graph *g = k->g;
    double *turn = NULL;
    const tz_status s = tz_alloc(k->ctx, &turn, (size_t)g->turn.n, sizeof *turn);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < g->sample.n; i++) {
        tz_curve_sample *p = &g->sample.v[i];
        p->turn = p->link;
        p->turns = p->links;
        for (int32_t j = p->link; j < p->link + p->links; j++) {
            const int32_t e = g->link.v[j].edge;
            turn[j] = g->turn.v[2 * e + (g->edge.v[e].to == i)];
        }
    }
    if (g->turn.n > 0)
        memcpy(g->turn.v, turn, (size_t)g->turn.n * sizeof *turn);
    tz_free(k->ctx, turn);
    return TZ_OK;
}

/* ---- all --------------------------------------------------------------------------- */

/* Samples of discrete elements lie as they do in their set; kinds are told by their q. */
static tz_status add_elements(tz_ctx *ctx, const tz_element_set *e, tz_sample_graph *g)
{
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < e->element.n && s == TZ_OK; i++)
        for (int32_t k = 0; k < e->element.v[i].samples && s == TZ_OK; k++) {
            const tz_sample *p = &e->sample.v[e->element.v[i].sample + k];
            const int32_t id = p->id < 0 || p->id > 1023 ? 1023 : p->id;
            const int32_t q = (e->element.v[i].kind & 0xfffff) << 10 | id;
            s = tz_array_push(
                ctx, &g->sample,
                ((tz_curve_sample){
                    .at = {p->at.x, p->at.y}, .q = q, .element = i, .existence = 1}));
        }
    return s;
}

tz_sample_levels tz_sample_levels_default(const tz_curve_set *s)
{
    static const double spacing[TZ_SAMPLE_LEVELS] = {40, 30, 25}, radius[] = {60, 50, 40};
    const double scale = fmax(s->domain.size.x, s->domain.size.y) / 375;
    tz_sample_levels l = {.levels = TZ_SAMPLE_LEVELS};
    for (int i = 0; i < TZ_SAMPLE_LEVELS; i++) {
        l.spacing[i] = scale * spacing[i];
        l.radius[i] = scale * radius[i];
    }
    return l;
}

tz_status tz_sample_graph_make(tz_ctx *ctx, const tz_curve_set *s, double spacing,
                               double radius, tz_sample_graph *g)
{
    const tz_curve_join_params join = {.crossings = true};
    tz_sample_graph out = {
        .ctx = ctx, .domain = s->domain, .spacing = spacing, .radius = radius};
    sampler k = {.ctx = ctx, .g = &out};
    memset(g, 0, sizeof *g);
    if (!(spacing > 0) || !(radius > 0) || !isfinite(spacing) || !isfinite(radius))
        return tz_fail(ctx, TZ_INVALID,
                       "a spacing of %g and a radius of %g cannot be; give lengths > 0",
                       spacing, radius);
    if (s->path.n == 0 && s->element.element.n == 0)
        return tz_fail(ctx, TZ_INVALID, "there is nothing to sample; draw some curves");
    tz_status st = tz_curve_join(ctx, s, &join, &k.set);
    if (st == TZ_OK)
        st = sample_paths(&k);
    if (st == TZ_OK)
        st = tz_sample_graph_link(&out);
    if (st == TZ_OK)
        st = sort_turns(&k);
    if (st == TZ_OK)
        st = add_elements(ctx, &s->element, &out);
    tz_curve_set_deinit(&k.set);
    tz_free(ctx, k.degree);
    tz_free(ctx, k.sample);
    tz_array_free(ctx, &k.line.point);
    tz_array_free(ctx, &k.line.along);
    tz_array_free(ctx, &k.line.node);
    tz_array_free(ctx, &k.line.curve);
    tz_array_free(ctx, &k.line.first);
    tz_array_free(ctx, &k.stop);
    tz_array_free(ctx, &k.sharp);
    tz_array_free(ctx, &k.joined);
    if (st == TZ_OK)
        *g = out;
    else
        tz_sample_graph_deinit(&out);
    return st;
}
