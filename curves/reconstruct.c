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
#include "curves/curve_join.h"
#include "curves/matching.h"

#define OPPOSITE (TZ_PI / 9)   /* off pi by no more */
#define STRAIGHT (TZ_PI / 720) /* off the chord by no more */
#define SHARPEST (0.9 * TZ_PI) /* turn of a piece that a handle can follow */

/* Ends of edges: 2 e leaves edge[e].from, 2 e + 1 leaves edge[e].to. */
typedef struct rebuild {
    tz_ctx *ctx;
    const tz_sample_graph *g;
    int32_t *next;   /* per end: the end of another edge that it runs on to, or -1 */
    double *tangent; /* per end: direction in which the curve leaves */
    bool *done;      /* per edge */
    tz_curve_set *to;
    int32_t *node; /* per sample */
} rebuild;

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
    double best = OPPOSITE;
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
    double d = back - k->tangent[x];
    d -= floor(d / (2 * TZ_PI) + 0.5) * (2 * TZ_PI);
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

/* Signed angle from direction b to a, -pi .. pi. */
static double signed_turn(double a, double b)
{
    const double d = a - b;
    return d - floor(d / (2 * TZ_PI) + 0.5) * (2 * TZ_PI);
}

static tz_status node_of(rebuild *k, int32_t sample, int32_t *node)
{
    *node = k->node[sample];
    if (*node >= 0)
        return TZ_OK;
    const tz_status s = tz_curve_add_node(k->to, k->g->sample.v[sample].at, node);
    k->node[sample] = *node;
    return s;
}

/* The piece along an edge, leaving by `end`. On a torus a piece over the border ends at a
 * node of its own, beyond it. */
static tz_status add_piece(rebuild *k, int32_t end)
{
    const tz_sample_graph *g = k->g;
    const tz_curve_edge *e = &g->edge.v[end >> 1];
    const int32_t from = end & 1 ? e->to : e->from, to = end & 1 ? e->from : e->to;
    int32_t a, b;
    tz_status s = node_of(k, from, &a);
    if (s == TZ_OK)
        s = node_of(k, to, &b);
    if (s != TZ_OK)
        return s;
    const tz_vec2 p = k->to->node.v[a], q = k->to->node.v[b];
    const double chord = tz_vec2_length(tz_vec2_sub(q, p));
    const double along = atan2(q.y - p.y, q.x - p.x);
    const double u = k->tangent[end], v = k->tangent[end ^ 1];
    const double x = fabs(signed_turn(u, along)), y = fabs(signed_turn(v, along + TZ_PI));
    if (x < STRAIGHT && y < STRAIGHT)
        return tz_curve_line(k->to, a, b);
    const double half = cos(fmin(x + y, 2 * SHARPEST) / 4);
    const double handle = chord / (3 * half * half);
    return tz_curve_cubic(k->to, a, b,
                          (tz_vec2){p.x + handle * cos(u), p.y + handle * sin(u)},
                          (tz_vec2){q.x + handle * cos(v), q.y + handle * sin(v)});
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

tz_status tz_curve_reconstruct(tz_ctx *ctx, const tz_sample_graph *g,
                               const tz_curve_set *like, tz_curve_set *to)
{
    const tz_domain domain = g->domain;
    const tz_curve_join_params join = {.only_chain = true};
    tz_curve_set raw = {0};
    rebuild k = {.ctx = ctx, .g = g, .to = &raw};
    const size_t n = (size_t)g->edge.n;
    memset(to, 0, sizeof *to);
    tz_status s = check_pens(ctx, g, like);
    if (s == TZ_OK)
        s = tz_curve_set_like(ctx, like, &domain, &raw);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &k.next, 2 * n, sizeof *k.next);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &k.tangent, 2 * n, sizeof *k.tangent);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &k.done, n, sizeof *k.done);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &k.node, (size_t)g->sample.n, sizeof *k.node);
    if (s == TZ_OK) {
        memset(k.next, 255, 2 * n * sizeof *k.next);
        memset(k.node, 255, (size_t)g->sample.n * sizeof *k.node);
        pair_ends(&k);
        s = add_paths(&k);
    }
    if (s == TZ_OK)
        s = tz_curve_join(ctx, &raw, &join, to);
    tz_free(ctx, k.next);
    tz_free(ctx, k.tangent);
    tz_free(ctx, k.done);
    tz_free(ctx, k.node);
    tz_curve_set_deinit(&raw);
    return s;
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
