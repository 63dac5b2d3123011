/* SPDX-License-Identifier: Apache-2.0 */
/* Edges. Two samples that are near each other may have an edge; each neighbourhood that
 * holds both, and takes them for two samples of the exemplar, votes for it if those have
 * one. So each possible edge has a confidence, and each sample a number of edges that is
 * wanted, the mean of what the exemplar's have. Edges are then taken greedily, surest
 * first, as long as each lowers
 *
 *     |i(e) - confidence| + sum over its samples of | edges - wanted |.       Eq. (19)
 *
 * An edge takes its pen, and the exemplar's edge that it is like, from most of those who
 * voted for it.
 * @source [Tu20] Sec. 4.3.4, Eq. (16) to (21). Deviates: ends that the exemplar's border
 *   has cut do not vote on the number of edges; outliers do not vote on edges */
#include <stdlib.h>

#include "curves/synthesis_internal.h"

enum { BLOCK = 256, MOST_LIKES = 16 };
#define LONGEST 2.2 /* spacings */

typedef TZ_ARRAY(tz_curve_edge)
edge_list;

typedef struct ballot {
    tz_curve_solve *t;
    edge_list *block; /* candidates of each block of samples */
    double longest;
} ballot;

/* Edges of the exemplar that two samples are taken for. */
typedef struct likes {
    int32_t edge[MOST_LIKES], n;
    double count[MOST_LIKES];
    bool back[MOST_LIKES];
} likes;

static void count_like(likes *l, int32_t edge, bool back, double weight)
{
    for (int32_t k = 0; k < l->n; k++)
        if (l->edge[k] == edge && l->back[k] == back) {
            l->count[k] += weight;
            return;
        }
    if (l->n < MOST_LIKES) {
        l->edge[l->n] = edge;
        l->back[l->n] = back;
        l->count[l->n++] = weight;
    }
}

/* Edge of the exemplar between two samples, or -1. */
static int32_t edge_between(const tz_sample_graph *g, int32_t a, int32_t b)
{
    const tz_curve_sample *p = &g->sample.v[a];
    for (int32_t k = p->link; k < p->link + p->links; k++)
        if (g->link.v[k].to == b)
            return g->link.v[k].edge;
    return -1;
}

/* The candidate between a and b; existence 0 if nobody wants it. */
static tz_curve_edge vote(const tz_curve_solve *t, int32_t a, int32_t b)
{
    const tz_curve_votes *v = &t->votes;
    const tz_sample_graph *g = &t->x->g;
    tz_curve_edge e = {.from = a, .to = b, .like = -1};
    likes l = {.n = 0};
    int32_t i = v->first[a], j = v->first[b];
    double both = 0, yes = 0;
    while (i < v->first[a + 1] && j < v->first[b + 1]) {
        if (v->centre[i] != v->centre[j]) {
            *(v->centre[i] < v->centre[j] ? &i : &j) += 1;
            continue;
        }
        const double w = (double)v->weight[v->centre[i]];
        const int32_t x = v->seen[i++], y = v->seen[j++];
        if (x < 0 || y < 0)
            continue;
        const int32_t edge = edge_between(g, x, y);
        both += w;
        if (edge < 0)
            continue;
        yes += w;
        count_like(&l, edge, g->edge.v[edge].from != x, w);
    }
    if (!(yes > 0))
        return e;
    int32_t most = 0;
    for (int32_t k = 1; k < l.n; k++)
        if (l.count[k] > l.count[most])
            most = k;
    e.existence = yes / both;
    e.like = l.edge[most];
    e.back = l.back[most];
    e.pen = g->edge.v[e.like].pen;
    return e;
}

static tz_status vote_block(tz_ctx *ctx, void *arg, int64_t block, int worker)
{
    ballot *k = arg;
    const tz_curve_solve *t = k->t;
    const tz_match_hoods *h = &t->m.ho;
    const int32_t end = (int32_t)fmin((block + 1.0) * BLOCK, h->n);
    tz_status s = TZ_OK;
    (void)worker;
    for (int32_t a = (int32_t)block * BLOCK; a < end; a++) {
        if (t->drop[a] || t->o.sample.v[a].q != TZ_SAMPLE_CURVE)
            continue;
        for (int32_t i = h->first[a]; i < h->first[a + 1] && s == TZ_OK; i++) {
            const int32_t b = h->id[i];
            if (b < a || t->drop[b] || t->o.sample.v[b].q != TZ_SAMPLE_CURVE ||
                hypot((double)h->x[i], (double)h->y[i]) > k->longest ||
                (t->o.sample.v[a].fixed && t->o.sample.v[b].fixed))
                continue;
            const tz_curve_edge e = vote(t, a, b);
            if (e.existence > 0)
                s = tz_array_push(ctx, &k->block[block], e);
        }
    }
    return s;
}

/* ---- how many ---------------------------------------------------------------------- */

static void find_wanted(tz_curve_solve *t)
{
    const tz_curve_votes *v = &t->votes;
    for (int32_t s = 0; s < t->o.sample.n; s++) {
        double sum = 0, n = 0, all = 0, any = 0;
        for (int32_t k = v->first[s]; k < v->first[s + 1]; k++) {
            if (v->seen[k] < 0)
                continue;
            const int32_t links = t->x->g.sample.v[v->seen[k]].links;
            const double w = (double)v->weight[v->centre[k]];
            all += w * links;
            any += w;
            if (!t->x->cut[v->seen[k]]) {
                sum += w * links;
                n += w;
            }
        }
        t->want[s] = n > 0 ? sum / n : any > 0 ? all / any : 0;
    }
}

/* ---- greedy ------------------------------------------------------------------------ */

static int surest(const void *a, const void *b)
{
    const tz_curve_edge *p = a, *q = b;
    if (p->existence != q->existence)
        return p->existence > q->existence ? -1 : 1;
    if (p->from != q->from)
        return p->from < q->from ? -1 : 1;
    return (p->to > q->to) - (p->to < q->to);
}

/* What Eq. (19) falls by when the edge is taken. */
static double gain(const tz_curve_solve *t, const tz_curve_edge *e, const int32_t *has)
{
    const double c = e->existence;
    double g = c - (1 - c);
    const int32_t end[2] = {e->from, e->to};
    for (int k = 0; k < 2; k++)
        g +=
            fabs(has[end[k]] - t->want[end[k]]) - fabs(has[end[k]] + 1 - t->want[end[k]]);
    return g;
}

/* Fixed edges stay. */
static tz_status keep_fixed(tz_curve_solve *t, int32_t *has)
{
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < t->o.edge.n && s == TZ_OK; i++) {
        const tz_curve_edge *e = &t->o.edge.v[i];
        if (!t->o.sample.v[e->from].fixed || !t->o.sample.v[e->to].fixed)
            continue;
        has[e->from]++;
        has[e->to]++;
        s = tz_array_push(t->ctx, &t->edge, *e);
    }
    return s;
}

static tz_status choose(tz_curve_solve *t, const edge_list *all)
{
    int32_t *has = NULL;
    tz_status s = tz_alloc_zero(t->ctx, &has, (size_t)t->o.sample.n, sizeof *has);
    if (s == TZ_OK)
        s = keep_fixed(t, has);
    for (int32_t i = 0; i < all->n && s == TZ_OK; i++) {
        const tz_curve_edge *e = &all->v[i];
        if (!(gain(t, e, has) > 0))
            continue;
        has[e->from]++;
        has[e->to]++;
        s = tz_array_push(t->ctx, &t->edge, *e);
    }
    tz_free(t->ctx, has);
    return s;
}

tz_status tz_curve_solve_edges(tz_curve_solve *t)
{
    const int32_t blocks = (t->o.sample.n + BLOCK - 1) / BLOCK;
    ballot k = {.t = t, .longest = LONGEST * t->o.spacing};
    edge_list all = {0};
    t->edge.n = 0;
    tz_status s = tz_alloc(t->ctx, &t->want, (size_t)t->o.sample.n, sizeof *t->want);
    if (s == TZ_OK)
        s = tz_alloc_zero(t->ctx, &k.block, (size_t)blocks, sizeof *k.block);
    if (s == TZ_OK) {
        find_wanted(t);
        s = tz_parallel_for(t->ctx, blocks, vote_block, &k);
    }
    for (int32_t b = 0; b < blocks && s == TZ_OK; b++)
        for (int32_t i = 0; i < k.block[b].n && s == TZ_OK; i++)
            s = tz_array_push(t->ctx, &all, k.block[b].v[i]);
    if (s == TZ_OK && all.n > 1)
        qsort(all.v, (size_t)all.n, sizeof *all.v, surest);
    if (s == TZ_OK)
        s = choose(t, &all);
    for (int32_t b = 0; b < blocks && k.block; b++)
        tz_array_free(t->ctx, &k.block[b]);
    tz_free(t->ctx, k.block);
    tz_array_free(t->ctx, &all);
    return s;
}
