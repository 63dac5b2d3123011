/* SPDX-License-Identifier: Apache-2.0 */
/* Search step: PatchMatch over the graph of nearest samples.
 *
 *   propagation  a neighbour n of s is matched with m(n), so s may be what lies beside
 *                m(n) as s lies beside n:  nearest of p(m(n)) + p(s) - p(n)
 *   random       any sample in a window about m(s), 150 wide, 75, 37, 25 (of 375)
 *
 * Samples are visited breadth-first from one to its 8 nearest, and the other way the next
 * time. To run in parallel the domain is cut into regions whose size depends on the
 * radius alone. Within a region the news spreads as it comes; of other regions a sample
 * sees what they had before the round: the result is the same at any number of threads.
 * @source [Tu20] Sec. 4.3.3; Barnes et al.: PatchMatch, SIGGRAPH 2009; Chen et al. 2012.
 *   Deviates: regions do not see each other's news within a round */
#include <stdlib.h>
#include <string.h>

#include "curves/synthesis_internal.h"

enum { NEAR = 8, MOST_TRIED = 48 };
#define REGION    4.0 /* radii: side of a region */
#define WIDEST    (150.0 / 60)
#define LACK      0.5         /* spacings that a missing sample costs */
#define NARROWEST (25.0 / 60) /* windows, in radii of the first level's */

typedef struct search {
    tz_curve_solve *t;
    int32_t *order;  /* samples, region by region */
    int32_t *first;  /* regions + 1 */
    int32_t *region; /* per sample */
    int32_t *before; /* matches before the round */
    int32_t regions, round;
    tz_assign *work; /* per worker */
} search;

/* ---- order ------------------------------------------------------------------------- */

/* Samples breadth-first over their nearest, begun anew where that ends. */
static tz_status walk(const tz_curve_solve *t, int32_t *order)
{
    const tz_match_hoods *h = &t->m.ho;
    bool *seen = NULL;
    int32_t n = 0, next = 0;
    const tz_status s = tz_alloc_zero(t->ctx, &seen, (size_t)h->n, sizeof *seen);
    for (int32_t start = 0; start < h->n && s == TZ_OK; start++) {
        if (seen[start])
            continue;
        seen[start] = true;
        order[n++] = start;
        for (; next < n; next++) {
            const int32_t a = h->first[order[next]], b = h->first[order[next] + 1];
            for (int32_t k = a; k < b && k < a + NEAR; k++)
                if (!seen[h->id[k]]) {
                    seen[h->id[k]] = true;
                    order[n++] = h->id[k];
                }
        }
    }
    tz_free(t->ctx, seen);
    return s;
}

/* Numbers of regions; how many there are. */
static int32_t find_regions(const tz_curve_solve *t, int32_t *region)
{
    const tz_sample_graph *g = &t->o;
    tz_vec2 lo = {INFINITY, INFINITY}, hi = {-INFINITY, -INFINITY};
    for (int32_t i = 0; i < g->sample.n; i++) {
        const tz_vec2 p = g->sample.v[i].at;
        lo = (tz_vec2){fmin(lo.x, p.x), fmin(lo.y, p.y)};
        hi = (tz_vec2){fmax(hi.x, p.x), fmax(hi.y, p.y)};
    }
    const double side = REGION * t->x->g.radius;
    const int32_t nx = (int32_t)fmin(fmax((hi.x - lo.x) / side, 0) + 1, 1024),
                  ny = (int32_t)fmin(fmax((hi.y - lo.y) / side, 0) + 1, 1024);
    for (int32_t i = 0; i < g->sample.n; i++) {
        const tz_vec2 p = g->sample.v[i].at;
        const int32_t x = (int32_t)fmin((p.x - lo.x) / side, nx - 1),
                      y = (int32_t)fmin((p.y - lo.y) / side, ny - 1);
        region[i] = y * nx + x;
    }
    return nx * ny;
}

static tz_status make_order(search *k)
{
    const tz_curve_solve *t = k->t;
    const size_t n = (size_t)t->o.sample.n;
    int32_t *all = NULL;
    tz_status s = tz_alloc(t->ctx, &k->order, n, sizeof *k->order);
    if (s == TZ_OK)
        s = tz_alloc(t->ctx, &k->region, n, sizeof *k->region);
    if (s == TZ_OK)
        s = tz_alloc(t->ctx, &k->before, n, sizeof *k->before);
    if (s == TZ_OK)
        s = tz_alloc(t->ctx, &all, n, sizeof *all);
    if (s == TZ_OK)
        s = walk(t, all);
    if (s == TZ_OK) {
        k->regions = find_regions(t, k->region);
        s = tz_alloc_zero(t->ctx, &k->first, (size_t)k->regions + 2, sizeof *k->first);
    }
    if (s == TZ_OK) {
        for (size_t i = 0; i < n; i++)
            k->first[k->region[i] + 2]++;
        for (int32_t r = 0; r < k->regions; r++)
            k->first[r + 2] += k->first[r + 1];
        for (size_t i = 0; i < n; i++)
            k->order[k->first[k->region[all[i]] + 1]++] = all[i];
    }
    tz_free(t->ctx, all);
    return s;
}

/* ---- candidates -------------------------------------------------------------------- */

typedef struct tried {
    int32_t id[MOST_TRIED], n;
} tried;

/* True the first time. */
static bool is_new(tried *c, int32_t si)
{
    for (int32_t k = 0; k < c->n; k++)
        if (c->id[k] == si)
            return false;
    if (c->n < MOST_TRIED)
        c->id[c->n++] = si;
    return true;
}

/* Takes the match over if it is better. */
static void attempt(search *k, int32_t so, int32_t si, tz_assign *w, tried *c)
{
    tz_curve_solve *t = k->t;
    if (si < 0 || !is_new(c, si))
        return;
    const float cost = tz_match(&t->m, so, si, w, false, t->cost[so]);
    if (!(cost < t->cost[so]))
        return;
    const int32_t first = t->m.ho.first[so], from = t->m.hi.first[si];
    t->cost[so] = cost;
    t->match.v[so] = si;
    for (int32_t j = 0; j < w->rows; j++)
        t->pair[first + j] = w->to[j] < 0 ? TZ_SEEN_NOT : t->m.hi.id[from + w->to[j]];
}

static void propagate(search *k, int32_t so, tz_assign *w, tried *c)
{
    const tz_curve_solve *t = k->t;
    const tz_match_hoods *h = &t->m.ho;
    const int32_t a = h->first[so], b = h->first[so + 1];
    for (int32_t j = a; j < b && j < a + NEAR; j++) {
        const int32_t n = h->id[j];
        const int32_t si = k->region[n] == k->region[so] ? t->match.v[n] : k->before[n];
        if (si < 0)
            continue;
        const tz_vec2 p = t->x->g.sample.v[si].at;
        const tz_vec2 at = {p.x - (double)h->x[j], p.y - (double)h->y[j]};
        attempt(k, so, tz_curve_model_nearest(t->x, at, t->o.sample.v[so].q), w, c);
    }
}

static void draw(search *k, int32_t so, tz_assign *w, tried *c)
{
    const tz_curve_solve *t = k->t;
    const double unit = t->levels.radius[0];
    const uint64_t round =
        ((uint64_t)t->level * 1024 + (uint64_t)t->iteration) * 16 + (uint64_t)k->round;
    tz_rng r = tz_rng_make(t->job->seed, tz_rng_stream(0x5ea2c4, round, (uint64_t)so));
    const int32_t q = t->o.sample.v[so].q;
    for (double side = WIDEST; side >= NARROWEST; side /= 2) {
        const int32_t si = t->match.v[so];
        if (si < 0)
            return;
        const tz_vec2 p = t->x->g.sample.v[si].at;
        const double x = p.x + unit * side * tz_rng_range(&r, -0.5, 0.5);
        const double y = p.y + unit * side * tz_rng_range(&r, -0.5, 0.5);
        attempt(k, so, tz_curve_model_nearest(t->x, (tz_vec2){x, y}, q), w, c);
    }
    if (k->round == 0) /* and one from anywhere */
        attempt(k, so, tz_curve_model_any(t->x, q, &r), w, c);
}

/* What the last step ended with, or anything. */
static void begin(search *k, int32_t so, tz_assign *w, tried *c)
{
    tz_curve_solve *t = k->t;
    const int32_t q = t->o.sample.v[so].q;
    int32_t si = t->match.v[so];
    tz_rng r = tz_rng_make(
        t->job->seed,
        tz_rng_stream(0x5ea2c3, (uint64_t)t->level * 1024 + (uint64_t)t->iteration,
                      (uint64_t)so));
    t->match.v[so] = -1;
    attempt(k, so, si, w, c);
    for (int i = 0; i < 8 && t->match.v[so] < 0; i++)
        attempt(k, so, tz_curve_model_any(t->x, q, &r), w, c);
}

static tz_status search_region(tz_ctx *ctx, void *arg, int64_t region, int worker)
{
    search *k = arg;
    const int32_t a = k->first[region], n = k->first[region + 1] - a;
    (void)ctx;
    for (int32_t i = 0; i < n; i++) {
        const int32_t so = k->order[k->round & 1 ? a + n - 1 - i : a + i];
        tried c = {.n = 0};
        if (k->round == 0)
            begin(k, so, &k->work[worker], &c);
        else if (k->t->match.v[so] >= 0)
            is_new(&c, k->t->match.v[so]);
        propagate(k, so, &k->work[worker], &c);
        draw(k, so, &k->work[worker], &c);
    }
    return TZ_OK;
}

/* ---- the step ---------------------------------------------------------------------- */

void tz_curve_solve_forget(tz_curve_solve *t)
{
    tz_matcher_deinit(&t->m);
    tz_free(t->ctx, t->cost);
    tz_free(t->ctx, t->pair);
    tz_free(t->ctx, t->votes.first);
    tz_free(t->ctx, t->votes.centre);
    tz_free(t->ctx, t->votes.seen);
    tz_free(t->ctx, t->votes.weight);
    tz_free(t->ctx, t->want);
    tz_free(t->ctx, t->move);
    tz_free(t->ctx, t->drop);
    t->cost = NULL;
    t->pair = NULL;
    t->votes = (tz_curve_votes){0};
    t->want = NULL;
    t->move = NULL;
    t->drop = NULL;
    t->extra.n = t->edge.n = 0;
}

/* Outliers that would lie beyond the exemplar's border say nothing. */
static void mark_unknown(tz_curve_solve *t)
{
    const tz_match_hoods *h = &t->m.ho;
    for (int32_t so = 0; so < h->n; so++) {
        if (t->match.v[so] < 0)
            continue;
        const tz_vec2 p = t->x->g.sample.v[t->match.v[so]].at;
        for (int32_t j = h->first[so]; j < h->first[so + 1]; j++)
            if (t->pair[j] == TZ_SEEN_NOT &&
                !tz_curve_model_knows(
                    t->x, (tz_vec2){p.x + (double)h->x[j], p.y + (double)h->y[j]}))
                t->pair[j] = TZ_SEEN_UNKNOWN;
    }
}

static tz_status prepare(tz_curve_solve *t)
{
    tz_match_params mp = tz_match_params_default();
    mp.gamma = t->p.edges ? mp.gamma : 0;
    mp.hard = !t->p.robust;
    mp.cut = t->x->cut;
    mp.lack = LACK;
    tz_curve_solve_forget(t);
    tz_status s = tz_matcher_init(t->ctx, &t->o, &t->x->g, &mp, &t->m);
    const int32_t n = t->o.sample.n, items = s == TZ_OK ? t->m.ho.first[n] : 0;
    if (s == TZ_OK)
        s = tz_alloc(t->ctx, &t->cost, (size_t)n, sizeof *t->cost);
    if (s == TZ_OK)
        s = tz_alloc(t->ctx, &t->pair, (size_t)items, sizeof *t->pair);
    for (int32_t i = 0; i < n && s == TZ_OK; i++)
        t->cost[i] = INFINITY;
    for (int32_t i = 0; i < items && s == TZ_OK; i++)
        t->pair[i] = TZ_SEEN_UNKNOWN;
    return s;
}

tz_status tz_curve_solve_search(tz_curve_solve *t, int32_t rounds)
{
    search k = {.t = t};
    tz_status s = prepare(t);
    if (s == TZ_OK)
        s = make_order(&k);
    if (s == TZ_OK)
        s = tz_alloc(t->ctx, &k.work, (size_t)tz_ctx_threads(t->ctx), sizeof *k.work);
    for (k.round = 0; k.round < rounds && s == TZ_OK; k.round++) {
        memcpy(k.before, t->match.v, (size_t)t->o.sample.n * sizeof *k.before);
        s = tz_parallel_for(t->ctx, k.regions, search_region, &k);
    }
    if (s == TZ_OK)
        mark_unknown(t);
    tz_free(t->ctx, k.order);
    tz_free(t->ctx, k.first);
    tz_free(t->ctx, k.region);
    tz_free(t->ctx, k.before);
    tz_free(t->ctx, k.work);
    return s;
}
