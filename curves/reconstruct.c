/* SPDX-License-Identifier: Apache-2.0 */
/* Reconstruction in the three steps of the paper: opposite orientations of each sample
 * are paired; orientations are matched with edges; edges whose orientations are a pair
 * run on into each other. Where there are more than two orientations the straightest pair
 * goes first.
 *
 * The cubic between two samples leaves along their orientations. For a chord c and angles
 * a, b of the tangents with it, which turn by f = |a| + |b| in all, handles are
 *
 *     c / (3 cos(f / 4)^2),
 *
 * the length that a circle's arc has at a = b, and c / 3 on straight lines. */
#include "curves/reconstruct.h"

#include <stdlib.h>
#include <string.h>

#include "base/grid.h"
#include "curves/matching.h"
#include "curves/reconstruct_internal.h"

#define STRAIGHT (TZ_PI / 720) /* off the chord by no more */
#define SHARPEST (0.9 * TZ_PI) /* turn of a piece that a handle can follow */

typedef tz_rebuild rebuild;

/* ---- at a sample ------------------------------------------------------------------- */

static int32_t end_of(const tz_sample_graph *g, int32_t sample, int32_t edge)
{
    return 2 * edge + (g->edge.v[edge].to == sample);
}

static double edge_angle(const tz_sample_graph *g, int32_t sample, int32_t to)
{
    const tz_vec2 p = g->sample.v[sample].at, q = g->sample.v[to].at;
    const tz_vec3 v =
        tz_domain_vector(&g->domain, (tz_vec3){p.x, p.y, 0}, (tz_vec3){q.x, q.y, 0});
    return tz_curve_angle(atan2(v.y, v.x));
}

/* Orientations matched with edges; an edge without one leaves straight. */
static void set_tangents(rebuild *k, int32_t sample, int32_t *turn_of)
{
    const tz_sample_graph *g = k->g;
    const tz_curve_sample *p = &g->sample.v[sample];
    const int32_t n = p->links < TZ_ASSIGN_MOST ? p->links : TZ_ASSIGN_MOST;
    const int32_t m = p->turns < TZ_ASSIGN_MOST ? p->turns : TZ_ASSIGN_MOST;
    double angle[TZ_ASSIGN_MOST];
    for (int32_t i = 0; i < p->links; i++) {
        const tz_curve_link *l = &g->link.v[p->link + i];
        const double a = edge_angle(g, sample, l->to);
        k->tangent[end_of(g, sample, l->edge)] = a;
        if (i < n)
            angle[i] = a;
    }
    for (int32_t i = 0; i < n; i++)
        turn_of[i] = -1;
    if (n > 0 && m > 0)
        tz_match_turns(angle, n, g->turn.v + p->turn, m, turn_of);
    for (int32_t i = 0; i < n; i++)
        if (turn_of[i] >= 0)
            k->tangent[end_of(g, sample, g->link.v[p->link + i].edge)] =
                g->turn.v[p->turn + turn_of[i]];
}

/* The straightest pair of edges that are free to run on; false if there is none. */
static bool best_pair(const rebuild *k, int32_t sample, const int32_t *turn_of,
                      int32_t out[2])
{
    const tz_sample_graph *g = k->g;
    const tz_curve_sample *p = &g->sample.v[sample];
    const int32_t n = p->links < TZ_ASSIGN_MOST ? p->links : TZ_ASSIGN_MOST;
    double best = TZ_REBUILD_OPPOSITE;
    bool found = false;
    for (int32_t i = 0; i < n; i++)
        for (int32_t j = i + 1; j < n; j++) {
            const int32_t a = g->link.v[p->link + i].edge,
                          b = g->link.v[p->link + j].edge;
            const int32_t x = end_of(g, sample, a), y = end_of(g, sample, b);
            if (turn_of[i] < 0 || turn_of[j] < 0 || k->next[x] >= 0 || k->next[y] >= 0 ||
                g->edge.v[a].pen != g->edge.v[b].pen)
                continue;
            const double off =
                TZ_PI - tz_curve_angle_between(k->tangent[x], k->tangent[y]);
            if (off < best) {
                best = off;
                out[0] = x, out[1] = y;
                found = true;
            }
        }
    return found;
}

/* Two ends that run on into each other leave in exactly opposite directions. */
static void run_on(rebuild *k, int32_t x, int32_t y)
{
    const double back = k->tangent[y] + TZ_PI;
    const double d = tz_rebuild_turn(back, k->tangent[x]);
    k->tangent[x] = tz_curve_angle(k->tangent[x] + d / 2);
    k->tangent[y] = tz_curve_angle(k->tangent[x] + TZ_PI);
    k->next[x] = y;
    k->next[y] = x;
}

static void pair_ends(rebuild *k)
{
    int32_t turn_of[TZ_ASSIGN_MOST], pair[2];
    for (int32_t i = 0; i < k->g->sample.n; i++) {
        set_tangents(k, i, turn_of);
        while (best_pair(k, i, turn_of, pair))
            run_on(k, pair[0], pair[1]);
    }
}

/* ---- paths ------------------------------------------------------------------------- */

static tz_status node_of(rebuild *k, int32_t sample, int32_t *node)
{
    *node = k->node[sample];
    if (*node >= 0)
        return TZ_OK;
    const tz_vec2 p = k->g->sample.v[sample].at;
    const tz_vec3 in = tz_domain_wrap(&k->g->domain, (tz_vec3){p.x, p.y, 0});
    const tz_status s = tz_curve_add_node(k->to, (tz_vec2){in.x, in.y}, node);
    k->node[sample] = *node;
    return s;
}

/* Widths of an interpolated piece: those of the line that it is like, or its pen's. */
static tz_curve_taper arc_taper(const rebuild *k, int32_t end)
{
    const tz_curve_edge *e = &k->g->edge.v[end >> 1];
    const double pen = k->to->pen.v[e->pen].width;
    if (!k->exemplar || k->exemplar->taper.n == 0 || e->like < 0 ||
        k->exemplar->edge.v[e->like].shapes == 0)
        return (tz_curve_taper){pen, pen};
    const tz_curve_edge *l = &k->exemplar->edge.v[e->like];
    const double head = k->exemplar->taper.v[l->shape].from,
                 tail = k->exemplar->taper.v[l->shape + l->shapes - 1].to;
    const bool back = e->back != (bool)(end & 1);
    return (tz_curve_taper){back ? tail : head, back ? head : tail};
}

/* The piece along an edge between two nodes, leaving by `end`: interpolated. */
static tz_status add_arc(rebuild *k, int32_t end, int32_t a, int32_t b)
{
    const tz_vec2 p = k->to->node.v[a],
                  q = tz_curve_copy(&k->to->domain, k->to->node.v[b], p);
    const double chord = tz_vec2_length(tz_vec2_sub(q, p));
    const double along = atan2(q.y - p.y, q.x - p.x);
    const double u = k->tangent[end], v = k->tangent[end ^ 1];
    const double x = fabs(tz_rebuild_turn(u, along)),
                 y = fabs(tz_rebuild_turn(v, along + TZ_PI));
    const double half = cos(fmin(x + y, 2 * SHARPEST) / 4);
    const double handle = chord / (3 * half * half);
    const bool straight = x < STRAIGHT && y < STRAIGHT;
    const tz_bezier line = tz_bezier_line(p, q);
    const tz_vec2 c = {p.x + handle * cos(u), p.y + handle * sin(u)},
                  d = {q.x + handle * cos(v), q.y + handle * sin(v)};
    const tz_curve_piece piece = {a, b, straight ? line.p[1] : c,
                                  straight ? line.p[2] : d, straight};
    const tz_curve_carry carry = {.taper = arc_taper(k, end),
                                  .origin = tz_curve_no_origin(),
                                  .has_taper = k->exemplar && k->exemplar->taper.n > 0,
                                  .has_origin = k->exemplar != NULL};
    return tz_curve_add_piece(k->to, &piece, &carry);
}

/* The shapes of an edge between two nodes, leaving by `end`. */
static tz_status add_shapes(rebuild *k, int32_t end, int32_t a, int32_t b)
{
    const int32_t e = end >> 1, n = k->first[e + 1] - k->first[e];
    int32_t node[2] = {a, a};
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < n && s == TZ_OK; i++) {
        tz_rebuild_shape r = k->shape.v[k->first[e] + (end & 1 ? n - 1 - i : i)];
        tz_curve_piece p = {.straight = r.straight};
        if (end & 1) {
            const tz_bezier c = r.curve;
            r.curve = (tz_bezier){{c.p[3], c.p[2], c.p[1], c.p[0]}};
            r.carry = tz_curve_carry_back(&r.carry);
        }
        const tz_vec2 to = r.curve.p[3];
        const tz_vec3 in = tz_domain_wrap(&k->to->domain, (tz_vec3){to.x, to.y, 0});
        node[1] = b;
        if (i + 1 < n)
            s = tz_curve_add_node(k->to, (tz_vec2){in.x, in.y}, &node[1]);
        if (s != TZ_OK)
            return s;
        tz_curve_put(k->to, &r.curve, node, &p);
        s = tz_curve_add_piece(k->to, &p, &r.carry);
        node[0] = node[1];
    }
    return s;
}

static tz_status add_piece(rebuild *k, int32_t end)
{
    const tz_curve_edge *e = &k->g->edge.v[end >> 1];
    const int32_t from = end & 1 ? e->to : e->from, to = end & 1 ? e->from : e->to;
    int32_t a, b;
    tz_status s = node_of(k, from, &a);
    if (s == TZ_OK)
        s = node_of(k, to, &b);
    if (s != TZ_OK)
        return s;
    return k->exemplar && k->first[(end >> 1) + 1] > k->first[end >> 1]
               ? add_shapes(k, end, a, b)
               : add_arc(k, end, a, b);
}

static tz_status add_path(rebuild *k, int32_t begin, bool around)
{
    tz_status s = tz_curve_begin(k->to, k->g->edge.v[begin >> 1].pen);
    if (s != TZ_OK)
        return s;
    for (int32_t end = begin; end >= 0 && !k->done[end >> 1] && s == TZ_OK;
         end = k->next[end ^ 1]) {
        k->done[end >> 1] = true;
        s = add_piece(k, end);
    }
    tz_curve_end(k->to, around);
    return s;
}

static tz_status add_paths(rebuild *k)
{
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < k->g->edge.n && s == TZ_OK; i++) {
        if (k->done[i])
            continue;
        int32_t begin = 2 * i;
        while (k->next[begin] >= 0 && k->next[begin] >> 1 != i)
            begin = k->next[begin] ^ 1;
        const bool around = k->next[begin] >= 0;
        s = add_path(k, around ? 2 * i : begin, around);
    }
    return s;
}

/* ---- all --------------------------------------------------------------------------- */

static tz_status check_pens(tz_ctx *ctx, const tz_sample_graph *g,
                            const tz_curve_set *like)
{
    if (g->edge.n == 0)
        return tz_fail(ctx, TZ_INVALID, "the graph has no edges to make curves of");
    for (int32_t i = 0; i < g->edge.n; i++)
        if (g->edge.v[i].pen < 0 || g->edge.v[i].pen >= like->pen.n)
            return tz_fail(ctx, TZ_INVALID, "edge %d of the graph has no pen", i);
    return TZ_OK;
}

static tz_status rebuild_paths(rebuild *k, const tz_curve_set *like)
{
    const tz_sample_graph *g = k->g;
    const size_t n = (size_t)g->edge.n;
    const tz_domain domain = g->domain;
    tz_status s = tz_curve_set_like(k->ctx, like, &domain, k->to);
    if (s == TZ_OK)
        s = tz_alloc(k->ctx, &k->next, 2 * n, sizeof *k->next);
    if (s == TZ_OK)
        s = tz_alloc_zero(k->ctx, &k->tangent, 2 * n, sizeof *k->tangent);
    if (s == TZ_OK)
        s = tz_alloc_zero(k->ctx, &k->done, n, sizeof *k->done);
    if (s == TZ_OK)
        s = tz_alloc(k->ctx, &k->node, (size_t)g->sample.n, sizeof *k->node);
    if (s != TZ_OK)
        return s;
    memset(k->next, 255, 2 * n * sizeof *k->next);
    memset(k->node, 255, (size_t)g->sample.n * sizeof *k->node);
    pair_ends(k);
    if (k->exemplar)
        s = tz_rebuild_detail(k);
    return s == TZ_OK ? add_paths(k) : s;
}

static tz_status reconstruct(tz_ctx *ctx, const tz_sample_graph *g,
                             const tz_sample_graph *exemplar, const tz_curve_set *like,
                             tz_curve_set *to)
{
    const tz_curve_join_params join = {.only_chain = true};
    tz_curve_set raw = {.ctx = ctx};
    rebuild k = {.ctx = ctx, .g = g, .to = &raw, .exemplar = exemplar};
    memset(to, 0, sizeof *to);
    tz_status s = check_pens(ctx, g, like);
    if (s == TZ_OK)
        s = rebuild_paths(&k, like);
    if (s == TZ_OK)
        s = tz_curve_join(ctx, &raw, &join, to);
    tz_free(ctx, k.next);
    tz_free(ctx, k.tangent);
    tz_free(ctx, k.done);
    tz_free(ctx, k.node);
    tz_free(ctx, k.first);
    tz_array_free(ctx, &k.shape);
    tz_curve_set_deinit(&raw);
    return s;
}

tz_status tz_curve_reconstruct(tz_ctx *ctx, const tz_sample_graph *g,
                               const tz_curve_set *like, tz_curve_set *to)
{
    return reconstruct(ctx, g, NULL, like, to);
}

tz_status tz_curve_reconstruct_detail(tz_ctx *ctx, const tz_sample_graph *g,
                                      const tz_sample_graph *exemplar,
                                      const tz_curve_set *like, tz_curve_set *to)
{
    memset(to, 0, sizeof *to);
    for (int32_t i = 0; i < g->edge.n; i++)
        if (g->edge.v[i].like >= exemplar->edge.n)
            return tz_fail(ctx, TZ_INVALID,
                           "edge %d of the graph is like edge %d of the exemplar, which "
                           "does not exist",
                           i, g->edge.v[i].like);
    return reconstruct(ctx, g, exemplar, like, to);
}

/* ---- distance ---------------------------------------------------------------------- */

typedef struct points {
    TZ_ARRAY(tz_vec2)
    v;
} points;

/* Points along all pieces, no more than `step` apart. */
static tz_status put_points(tz_ctx *ctx, const tz_curve_set *s, double step, points *out)
{
    tz_status st = TZ_OK;
    for (int32_t i = 0; i < s->piece.n && st == TZ_OK; i++) {
        const tz_bezier c = tz_curve_bezier(s, &s->piece.v[i]);
        const double n = ceil(fmin(tz_bezier_length(&c) / step, 1e6)) + 1;
        for (int32_t k = 0; k <= (int32_t)n && st == TZ_OK; k++)
            st = tz_array_push(ctx, &out->v, tz_bezier_at(&c, k / n));
    }
    return st;
}

/* Distance to the nearest point of the grid; the search widens until it finds one. */
static double nearest_point(const tz_grid *grid, tz_vec2 p, double step, double farthest)
{
    enum { MOST = 256 };
    int32_t id[MOST];
    for (double r = 2 * step; r < 4 * farthest; r *= 2) {
        const int32_t n = tz_grid_query(grid, p, r, id, MOST);
        double best = INFINITY;
        for (int32_t i = 0; i < (n < MOST ? n : MOST); i++)
            best = fmin(best, tz_vec2_length(tz_vec2_sub(grid->point.v[id[i]], p)));
        if (n > 0)
            return best;
    }
    return farthest;
}

tz_status tz_curve_distance(tz_ctx *ctx, const tz_curve_set *a, const tz_curve_set *b,
                            double step, double *mean, double *most)
{
    points p = {0}, q = {0};
    tz_grid grid = {0};
    int32_t id;
    double sum = 0, far = 0;
    if (!(step > 0) || a->path.n == 0 || b->path.n == 0)
        return tz_fail(ctx, TZ_INVALID, "there is nothing to measure the distance of");
    tz_status s = put_points(ctx, a, step, &p);
    if (s == TZ_OK)
        s = put_points(ctx, b, step / 4, &q);
    const double size = hypot(a->domain.size.x, a->domain.size.y);
    if (s == TZ_OK)
        s = tz_grid_init(ctx, &grid, (tz_vec2){0, 0},
                         (tz_vec2){b->domain.size.x, b->domain.size.y},
                         fmax(step, size / 2000), false);
    for (int32_t i = 0; i < q.v.n && s == TZ_OK; i++)
        s = tz_grid_add(ctx, &grid, q.v.v[i], &id);
    for (int32_t i = 0; i < p.v.n && s == TZ_OK; i++) {
        const double d = nearest_point(&grid, p.v.v[i], step, size);
        sum += d;
        far = fmax(far, d);
    }
    tz_grid_deinit(ctx, &grid);
    if (s == TZ_OK) {
        *mean = sum / p.v.n;
        *most = far;
    }
    tz_array_free(ctx, &p.v);
    tz_array_free(ctx, &q.v);
    return s;
}
