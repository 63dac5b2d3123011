/* SPDX-License-Identifier: Apache-2.0 */
/* Largest matching of a bipartite graph. Pairs are first made greedily, nearest distances
 * first, which leaves few pixels over; phases of Hopcroft and Karp pair as many of these
 * as can be: a breadth-first layering from the free found pixels, then disjoint paths
 * down the layers, each of which gains one pair.
 * @source Hopcroft, Karp: An n^(5/2) algorithm for maximum matchings in bipartite graphs,
 * SIAM J. Computing 1973 */
#include <math.h>
#include <stdlib.h>

#include "analysis/boundary_parts.h"

typedef struct spot {
    int32_t x, y;
} spot;

static int by_distance(const void *a, const void *b)
{
    const spot *p = a, *q = b;
    const int64_t dp = (int64_t)p->x * p->x + (int64_t)p->y * p->y;
    const int64_t dq = (int64_t)q->x * q->x + (int64_t)q->y * q->y;
    if (dp != dq)
        return dp < dq ? -1 : 1;
    if (p->y != q->y)
        return p->y < q->y ? -1 : 1;
    return (p->x > q->x) - (p->x < q->x);
}

tz_status tz_boundary_disc_init(tz_ctx *ctx, double radius, int32_t stride,
                                tz_boundary_disc *d)
{
    const int32_t r = (int32_t)radius;
    spot *all = NULL;
    int32_t n = 0;
    tz_status s;
    *d = (tz_boundary_disc){.ctx = ctx};
    if ((s = tz_alloc(ctx, &all, (size_t)(2 * r + 1) * (2 * r + 1), sizeof *all)) !=
        TZ_OK)
        goto done;
    for (int32_t y = -r; y <= r; y++)
        for (int32_t x = -r; x <= r; x++)
            if ((double)x * x + (double)y * y <= radius * radius)
                all[n++] = (spot){x, y};
    qsort(all, (size_t)n, sizeof *all, by_distance);
    if ((s = tz_alloc(ctx, &d->offset, (size_t)n, sizeof *d->offset)) != TZ_OK)
        goto done;
    for (int32_t i = 0; i < n; i++)
        d->offset[i] = all[i].y * stride + all[i].x;
    d->n = n;
done:
    tz_free(ctx, all);
    return s;
}

void tz_boundary_disc_deinit(tz_boundary_disc *d)
{
    tz_free(d->ctx, d->offset);
    *d = (tz_boundary_disc){0};
}

/* Edges of found pixel f: near[first[f] .. first[f + 1] - 1], nearest first. */
typedef struct graph {
    int32_t found, pairs;
    int32_t *first, *near;
    int32_t *mate;  /* of a found pixel: its true one, or -1 */
    int32_t *owner; /* of a true pixel: its found one, or -1 */
    int32_t *layer; /* of a found pixel; -1 = not reached or a dead end */
    int32_t *at;    /* edge to go on with */
    int32_t *stack; /* queue of the layering, stack of the path */
} graph;

static tz_status link_pixels(tz_ctx *ctx, graph *g, const int32_t *px, const int32_t *id,
                             const tz_boundary_disc *d)
{
    int64_t edges = 0;
    for (int32_t f = 0; f < g->found; f++)
        for (int32_t i = 0; i < d->n; i++)
            edges += id[px[f] + d->offset[i]] >= 0;
    if (edges > INT32_MAX)
        return tz_fail(ctx, TZ_NOMEM, "boundaries: the tolerance is too large");
    const tz_status s = tz_alloc(ctx, &g->near, (size_t)edges, sizeof *g->near);
    if (s != TZ_OK)
        return s;
    int32_t e = 0;
    for (int32_t f = 0; f < g->found; f++) {
        g->first[f] = e;
        for (int32_t i = 0; i < d->n; i++) {
            const int32_t t = id[px[f] + d->offset[i]];
            if (t >= 0)
                g->near[e++] = t;
        }
    }
    g->first[g->found] = e;
    return TZ_OK;
}

static void pair_nearest(graph *g, const int32_t *px, const int32_t *id,
                         const tz_boundary_disc *d)
{
    for (int32_t i = 0; i < d->n; i++) {
        for (int32_t f = 0; f < g->found; f++) {
            const int32_t t = id[px[f] + d->offset[i]];
            if (t < 0 || g->mate[f] >= 0 || g->owner[t] >= 0)
                continue;
            g->mate[f] = t;
            g->owner[t] = f;
            g->pairs++;
        }
    }
}

/* Layers of found pixels; true if a free true pixel is within reach. */
static bool make_layers(graph *g)
{
    int32_t head = 0, tail = 0;
    bool free_one = false;
    for (int32_t f = 0; f < g->found; f++) {
        g->at[f] = g->first[f];
        g->layer[f] = g->mate[f] < 0 ? 0 : -1;
        if (g->mate[f] < 0)
            g->stack[tail++] = f;
    }
    while (head < tail) {
        const int32_t f = g->stack[head++];
        for (int32_t e = g->first[f]; e < g->first[f + 1]; e++) {
            const int32_t next = g->owner[g->near[e]];
            free_one |= next < 0;
            if (next < 0 || g->layer[next] >= 0)
                continue;
            g->layer[next] = g->layer[f] + 1;
            g->stack[tail++] = next;
        }
    }
    return free_one;
}

/* Path from the free pixel f down the layers to a free true pixel, and its exchange. */
static void try_path(graph *g, int32_t f)
{
    int32_t depth = 1;
    g->stack[0] = f;
    while (depth > 0) {
        const int32_t u = g->stack[depth - 1];
        if (g->at[u] == g->first[u + 1]) {
            g->layer[u] = -1;
            depth--;
            continue;
        }
        int32_t t = g->near[g->at[u]++];
        const int32_t next = g->owner[t];
        if (next >= 0) {
            if (g->layer[next] == g->layer[u] + 1)
                g->stack[depth++] = next;
            continue;
        }
        while (depth-- > 0) {
            const int32_t v = g->stack[depth], old = g->mate[v];
            g->mate[v] = t;
            g->owner[t] = v;
            t = old;
        }
        g->pairs++;
        return;
    }
}

tz_status tz_boundary_pair(tz_ctx *ctx, const int32_t *px, int32_t found,
                           const int32_t *id, int32_t truth, const tz_boundary_disc *d,
                           int32_t *pairs)
{
    graph g = {.found = found};
    const size_t n = (size_t)found;
    tz_status s;

    if ((s = tz_alloc(ctx, &g.first, n + 1, sizeof *g.first)) != TZ_OK)
        goto done;
    if ((s = tz_alloc(ctx, &g.mate, 4 * n, sizeof *g.mate)) != TZ_OK)
        goto done;
    if ((s = tz_alloc(ctx, &g.owner, (size_t)truth, sizeof *g.owner)) != TZ_OK)
        goto done;
    if ((s = link_pixels(ctx, &g, px, id, d)) != TZ_OK)
        goto done;
    g.layer = g.mate + n;
    g.at = g.layer + n;
    g.stack = g.at + n;
    for (int32_t f = 0; f < found; f++)
        g.mate[f] = -1;
    for (int32_t t = 0; t < truth; t++)
        g.owner[t] = -1;
    pair_nearest(&g, px, id, d);
    while (make_layers(&g))
        for (int32_t f = 0; f < found; f++)
            if (g.mate[f] < 0)
                try_path(&g, f);
    *pairs = g.pairs;
done:
    tz_free(ctx, g.first);
    tz_free(ctx, g.near);
    tz_free(ctx, g.mate);
    tz_free(ctx, g.owner);
    return s;
}
