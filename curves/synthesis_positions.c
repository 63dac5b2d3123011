/* SPDX-License-Identifier: Apache-2.0 */
/* Positions: all at once as the least squares of what all neighbourhoods say,
 *
 *   min  sum over centres c, matched neighbours s:  w(c) |u(s) - u(c) - pull(c, s)|^2
 *      + sum over edges a b:                      STIFF |u(b) - u(a) - pull(a, b)|^2
 *      + sum over samples s:                        HOME |u(s)|^2
 *      + samples s beyond the border:               w(s) |u(s) - back(s)|^2
 *
 *
 * with u the displacement of a sample and pull the offset that the match has less the
 * present one, so that a torus needs no special case. Fixed samples, and those of given
 * curves that are just as in the exemplar, have u = 0: what is right is not disturbed. The second term makes the system
 * definite and well conditioned whatever its size; conjugate gradients from u = 0 take
 * some dozen passes, each linear and the same at any number of threads: cheaper than to
 * factorise a matrix whose pattern changes each time.
 * @source [Tu20] Eq. (13), (14). Deviates: the second term ([Ma11] and [Dav19] have it);
 *   w is as large as all neighbours together, else a few outside would not move */
#include <string.h>

#include "curves/synthesis_internal.h"

enum { BLOCK = 1024, MOST_PASSES = 100 };
#define HOME      0.5
#define STIFF     4.0 /* of edges, against the vote of a neighbourhood */
#define TOLERANCE 1e-6
#define RIGHT     0.02 /* spacings: what is no difference */

/* (diagonal - weights) u = right. */
typedef struct fit {
    const tz_curve_solve *t;
    int32_t n;
    tz_vec2 *pull;   /* per item of the output's neighbourhoods */
    int32_t *back;   /* per vote: the item it is, -1 = a centre's of itself */
    double *inverse; /* of the diagonal; 0 = stays where it is */
    double *diagonal;
    tz_vec2 *u, *r, *d, *q;
    double *part; /* partial sums of blocks */
    double alpha, beta;
} fit;

/* ---- the system -------------------------------------------------------------------- */

static tz_status reserve(tz_ctx *ctx, fit *f)
{
    const size_t n = (size_t)f->n, items = (size_t)f->t->m.ho.first[f->n];
    tz_status s = tz_alloc(ctx, &f->pull, items, sizeof *f->pull);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &f->back, n + items, sizeof *f->back);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &f->inverse, n, sizeof *f->inverse);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &f->diagonal, n, sizeof *f->diagonal);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &f->r, n, sizeof *f->r);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &f->d, n, sizeof *f->d);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &f->q, n, sizeof *f->q);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &f->part, n / BLOCK + 1, sizeof *f->part);
    return s;
}

static void release(tz_ctx *ctx, fit *f)
{
    tz_free(ctx, f->pull);
    tz_free(ctx, f->back);
    tz_free(ctx, f->inverse);
    tz_free(ctx, f->diagonal);
    tz_free(ctx, f->r);
    tz_free(ctx, f->d);
    tz_free(ctx, f->q);
    tz_free(ctx, f->part);
}

/* Votes in the order in which they were sorted, so that each finds its item. */
static tz_status link_votes(tz_ctx *ctx, fit *f)
{
    const tz_curve_solve *t = f->t;
    const tz_match_hoods *h = &t->m.ho;
    int32_t *at = NULL;
    const tz_status s = tz_alloc(ctx, &at, (size_t)f->n + 1, sizeof *at);
    if (s != TZ_OK)
        return s;
    memcpy(at, t->votes.first, (size_t)f->n * sizeof *at);
    for (int32_t c = 0; c < f->n; c++) {
        if (t->match.v[c] < 0)
            continue;
        f->back[at[c]++] = -1;
        for (int32_t k = h->first[c]; k < h->first[c + 1]; k++)
            f->back[at[h->id[k]]++] = k;
    }
    tz_free(ctx, at);
    return TZ_OK;
}

/* Pulls of the neighbours of a centre. */
static void make_pulls(fit *f, int32_t c)
{
    const tz_curve_solve *t = f->t;
    const tz_match_hoods *h = &t->m.ho;
    const tz_sample_graph *g = &t->x->g;
    const double frame = tz_curve_solve_frame(t, t->o.sample.v[c].at);
    for (int32_t k = h->first[c]; k < h->first[c + 1]; k++) {
        if (t->match.v[c] < 0 || t->pair[k] < 0)
            continue;
        const tz_vec2 v = tz_curve_vector(&g->domain, g->sample.v[t->match.v[c]].at,
                                          g->sample.v[t->pair[k]].at);
        f->pull[k] = tz_curve_rotate(
            (tz_vec2){v.x - (double)h->x[k], v.y - (double)h->y[k]}, frame);
    }
}

/* Way by which the end of an edge should move against its other end, `s`, to be as the
 * exemplar's edge that it is like; false if it is like none. */
static bool edge_pull(const tz_curve_solve *t, int32_t s, const tz_curve_link *l,
                      tz_vec2 *pull)
{
    const tz_curve_edge *e = &t->o.edge.v[l->edge];
    const tz_sample_graph *g = &t->x->g;
    if (e->like < 0 || e->like >= g->edge.n)
        return false;
    const tz_curve_edge *like = &g->edge.v[e->like];
    const bool ahead = (e->from == s) != e->back;
    const tz_vec2 v =
        tz_curve_vector(&g->domain, g->sample.v[ahead ? like->from : like->to].at,
                        g->sample.v[ahead ? like->to : like->from].at);
    const tz_vec2 p = t->o.sample.v[s].at, q = t->o.sample.v[l->to].at;
    /* the frame half way, the same from both ends */
    const tz_vec2 mid = {(p.x + q.x) / 2, (p.y + q.y) / 2};
    *pull = tz_vec2_sub(tz_curve_rotate(v, tz_curve_solve_frame(t, mid)),
                        tz_curve_vector(t->job->domain, p, q));
    return true;
}

/* Whether a sample of given curves, and all about it, lies just as in the exemplar. */
static bool is_right(const fit *f, int32_t s)
{
    const tz_curve_solve *t = f->t;
    const tz_match_hoods *h = &t->m.ho;
    if (t->p.start != TZ_CURVE_GIVEN || t->match.v[s] < 0 ||
        h->first[s] == h->first[s + 1])
        return false;
    for (int32_t k = h->first[s]; k < h->first[s + 1]; k++)
        if (t->pair[k] == TZ_SEEN_NOT ||
            (t->pair[k] >= 0 && tz_vec2_length(f->pull[k]) > RIGHT * t->o.spacing))
            return false;
    return true;
}

static void make_row(fit *f, int32_t s)
{
    const tz_curve_solve *t = f->t;
    const tz_match_hoods *h = &t->m.ho;
    tz_vec2 right = {0, 0};
    double sum = 0;
    for (int32_t k = t->votes.first[s]; k < t->votes.first[s + 1]; k++)
        if (f->back[k] >= 0 && t->votes.seen[k] >= 0) {
            const double w = (double)t->votes.weight[t->votes.centre[k]];
            right = tz_vec2_add(right, tz_vec2_scale(f->pull[f->back[k]], w));
            sum += w;
        }
    const double mine = (double)t->votes.weight[s];
    for (int32_t k = h->first[s]; k < h->first[s + 1]; k++)
        if (t->match.v[s] >= 0 && t->pair[k] >= 0) {
            right = tz_vec2_sub(right, tz_vec2_scale(f->pull[k], mine));
            sum += mine;
        }
    const tz_curve_sample *me = &t->o.sample.v[s];
    for (int32_t k = me->link; k < me->link + me->links; k++) {
        tz_vec2 pull;
        if (!edge_pull(t, s, &t->o.link.v[k], &pull))
            continue;
        right = tz_vec2_sub(right, tz_vec2_scale(pull, STIFF));
        sum += STIFF;
    }
    const double depth = tz_curve_solve_depth(t, me->at);
    if (depth < 0 && sum > 0) {
        const double e = 1e-3 * t->o.spacing;
        const tz_vec2 p = t->o.sample.v[s].at;
        tz_vec2 up = {tz_curve_solve_depth(t, (tz_vec2){p.x + e, p.y}) - depth,
                      tz_curve_solve_depth(t, (tz_vec2){p.x, p.y + e}) - depth};
        const double l = tz_vec2_length(up);
        up = l > 0 ? tz_vec2_scale(up, -depth / l) : (tz_vec2){0, 0};
        right = tz_vec2_add(right, tz_vec2_scale(up, sum));
        sum += sum;
    }
    f->diagonal[s] = sum + HOME;
    f->inverse[s] = 1 / f->diagonal[s];
    f->r[s] = right;
    if (me->fixed || is_right(f, s)) {
        f->inverse[s] = 0;
        f->r[s] = (tz_vec2){0, 0};
    }
}

/* ---- conjugate gradients ----------------------------------------------------------- */

static int32_t end_of(const fit *f, int64_t block)
{
    const int64_t end = (block + 1) * BLOCK;
    return end < f->n ? (int32_t)end : f->n;
}

static tz_status pull_block(tz_ctx *ctx, void *arg, int64_t block, int worker)
{
    (void)ctx, (void)worker;
    for (int32_t c = (int32_t)block * BLOCK; c < end_of(arg, block); c++)
        make_pulls(arg, c);
    return TZ_OK;
}

static tz_status row_block(tz_ctx *ctx, void *arg, int64_t block, int worker)
{
    (void)ctx, (void)worker;
    for (int32_t s = (int32_t)block * BLOCK; s < end_of(arg, block); s++)
        make_row(arg, s);
    return TZ_OK;
}

/* d = r / diagonal + beta d */
static tz_status step_block(tz_ctx *ctx, void *arg, int64_t block, int worker)
{
    fit *f = arg;
    (void)ctx, (void)worker;
    for (int32_t s = (int32_t)block * BLOCK; s < end_of(f, block); s++)
        f->d[s] = tz_vec2_add(tz_vec2_scale(f->r[s], f->inverse[s]),
                              tz_vec2_scale(f->d[s], f->beta));
    return TZ_OK;
}

/* q = A d; part = d q */
static tz_status apply_block(tz_ctx *ctx, void *arg, int64_t block, int worker)
{
    fit *f = arg;
    const tz_curve_solve *t = f->t;
    const tz_match_hoods *h = &t->m.ho;
    double sum = 0;
    (void)ctx, (void)worker;
    for (int32_t s = (int32_t)block * BLOCK; s < end_of(f, block); s++) {
        tz_vec2 q = {0, 0};
        for (int32_t k = t->votes.first[s]; k < t->votes.first[s + 1]; k++)
            if (t->votes.seen[k] >= 0 && t->votes.centre[k] != s)
                q = tz_vec2_add(
                    q, tz_vec2_scale(f->d[t->votes.centre[k]],
                                     (double)t->votes.weight[t->votes.centre[k]]));
        const double mine = (double)t->votes.weight[s];
        for (int32_t k = h->first[s]; k < h->first[s + 1] && t->match.v[s] >= 0; k++)
            if (t->pair[k] >= 0)
                q = tz_vec2_add(q, tz_vec2_scale(f->d[h->id[k]], mine));
        const tz_curve_sample *me = &t->o.sample.v[s];
        for (int32_t k = me->link; k < me->link + me->links; k++)
            if (t->o.edge.v[t->o.link.v[k].edge].like >= 0)
                q = tz_vec2_add(q, tz_vec2_scale(f->d[t->o.link.v[k].to], STIFF));
        f->q[s] = f->inverse[s] > 0
                      ? tz_vec2_sub(tz_vec2_scale(f->d[s], f->diagonal[s]), q)
                      : (tz_vec2){0, 0};
        sum += tz_vec2_dot(f->d[s], f->q[s]);
    }
    f->part[block] = sum;
    return TZ_OK;
}

/* u += alpha d, r -= alpha q; part = r r / diagonal */
static tz_status move_block(tz_ctx *ctx, void *arg, int64_t block, int worker)
{
    fit *f = arg;
    double sum = 0;
    (void)ctx, (void)worker;
    for (int32_t s = (int32_t)block * BLOCK; s < end_of(f, block); s++) {
        f->u[s] = tz_vec2_add(f->u[s], tz_vec2_scale(f->d[s], f->alpha));
        f->r[s] = tz_vec2_sub(f->r[s], tz_vec2_scale(f->q[s], f->alpha));
        sum += f->inverse[s] * tz_vec2_dot(f->r[s], f->r[s]);
    }
    f->part[block] = sum;
    return TZ_OK;
}

static double total(const fit *f)
{
    double sum = 0;
    for (int32_t b = 0; b < f->n / BLOCK + (f->n % BLOCK > 0); b++)
        sum += f->part[b];
    return sum;
}

static tz_status solve(tz_ctx *ctx, fit *f)
{
    const int64_t blocks = f->n / BLOCK + (f->n % BLOCK > 0);
    tz_status s = tz_parallel_for(ctx, blocks, pull_block, f);
    if (s == TZ_OK)
        s = tz_parallel_for(ctx, blocks, row_block, f);
    f->alpha = 0;
    if (s == TZ_OK)
        s = tz_parallel_for(ctx, blocks, move_block, f);
    double now = s == TZ_OK ? total(f) : 0;
    const double enough = TOLERANCE * TOLERANCE * now;
    f->beta = 0;
    for (int i = 0; i < MOST_PASSES && s == TZ_OK && now > enough; i++) {
        s = tz_parallel_for(ctx, blocks, step_block, f);
        if (s == TZ_OK)
            s = tz_parallel_for(ctx, blocks, apply_block, f);
        const double curved = s == TZ_OK ? total(f) : 0;
        if (!(curved > 0))
            break;
        f->alpha = now / curved;
        s = tz_parallel_for(ctx, blocks, move_block, f);
        const double next = s == TZ_OK ? total(f) : 0;
        f->beta = next / now;
        now = next;
    }
    return s;
}

tz_status tz_curve_solve_positions(tz_curve_solve *t)
{
    fit f = {.t = t, .n = t->o.sample.n};
    tz_status s = tz_alloc_zero(t->ctx, &t->move, (size_t)f.n, sizeof *t->move);
    f.u = t->move;
    if (s == TZ_OK)
        s = reserve(t->ctx, &f);
    if (s == TZ_OK)
        s = link_votes(t->ctx, &f);
    if (s == TZ_OK)
        s = solve(t->ctx, &f);
    release(t->ctx, &f);
    return s;
}
