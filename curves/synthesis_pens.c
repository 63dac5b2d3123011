/* SPDX-License-Identifier: Apache-2.0 */
/* Pens. Each edge has voted for its own; a line that is drawn through keeps one: the one
 * that most of its length asks for. A line goes on at samples of two edges.
 * The paper has no pens. */
#include <string.h>

#include "curves/synthesis_internal.h"

enum { MOST_PENS = 32 /* of one line; more vote for nothing */ };

typedef struct pens {
    tz_curve_solve *t;
    int32_t (*edge)[2]; /* per sample: its first two edges */
    int32_t *edges;     /* per sample: how many */
    bool *done;         /* per edge */
    TZ_ARRAY(int32_t)
    line; /* edges of one line */
} pens;

/* Edges of the line that edge `start` is of. */
static tz_status collect(pens *k, int32_t start)
{
    const tz_curve_edge *e = k->t->edge.v;
    tz_status s = tz_array_push(k->t->ctx, &k->line, start);
    k->done[start] = true;
    for (int end = 0; end < 2 && s == TZ_OK; end++) {
        int32_t at = end ? e[start].to : e[start].from, now = start;
        while (k->edges[at] == 2 && s == TZ_OK) {
            now = k->edge[at][k->edge[at][0] == now];
            if (k->done[now])
                break;
            k->done[now] = true;
            s = tz_array_push(k->t->ctx, &k->line, now);
            at = e[now].from + e[now].to - at;
        }
    }
    return s;
}

static void elect(pens *k)
{
    int32_t pen[MOST_PENS], n = 0, most = 0;
    double sum[MOST_PENS];
    for (int32_t i = 0; i < k->line.n; i++) {
        const tz_curve_edge *e = &k->t->edge.v[k->line.v[i]];
        const double l = tz_vec2_length(tz_curve_vector(
            k->t->job->domain, k->t->o.sample.v[e->from].at, k->t->o.sample.v[e->to].at));
        int32_t j = 0;
        while (j < n && pen[j] != e->pen)
            j++;
        if (j == MOST_PENS)
            continue;
        if (j == n) {
            pen[n] = e->pen;
            sum[n++] = 0;
        }
        sum[j] += l * e->existence;
    }
    for (int32_t j = 1; j < n; j++)
        most = sum[j] > sum[most] ? j : most;
    for (int32_t i = 0; i < k->line.n; i++) {
        tz_curve_edge *e = &k->t->edge.v[k->line.v[i]];
        const bool fixed =
            k->t->o.sample.v[e->from].fixed && k->t->o.sample.v[e->to].fixed;
        e->pen = fixed ? e->pen : pen[most];
    }
}

tz_status tz_curve_solve_pens(tz_curve_solve *t)
{
    pens k;
    const size_t n = (size_t)t->o.sample.n;
    memset(&k, 0, sizeof k);
    k.t = t;
    tz_status s = tz_alloc_zero(t->ctx, &k.edges, n, sizeof *k.edges);
    if (s == TZ_OK)
        s = tz_alloc_zero(t->ctx, &k.edge, n, sizeof *k.edge);
    if (s == TZ_OK)
        s = tz_alloc_zero(t->ctx, &k.done, (size_t)t->edge.n, sizeof *k.done);
    for (int32_t i = 0; i < t->edge.n && s == TZ_OK; i++)
        for (int end = 0; end < 2; end++) {
            const int32_t at = end ? t->edge.v[i].to : t->edge.v[i].from;
            if (k.edges[at] < 2)
                k.edge[at][k.edges[at]] = i;
            k.edges[at]++;
        }
    for (int32_t i = 0; i < t->edge.n && s == TZ_OK; i++) {
        if (k.done[i])
            continue;
        k.line.n = 0;
        s = collect(&k, i);
        if (s == TZ_OK)
            elect(&k);
    }
    tz_free(t->ctx, k.edges);
    tz_free(t->ctx, k.edge);
    tz_free(t->ctx, k.done);
    tz_array_free(t->ctx, &k.line);
    return s;
}
