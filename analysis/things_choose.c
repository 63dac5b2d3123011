/* SPDX-License-Identifier: Apache-2.0 */
/* The things are the set of disjoint nodes with the largest sum of
 *
 *     gain(v) = p(v) - certainty                     p: things_score.c
 *
 * which is the best expected balance of things found against things made up: a node pays
 * if more than this share of its like are things. In a tree the best choice below v is v
 * itself, or the best choices below its children, or nothing:
 *
 *     best(v) = max(gain(v), best(c0) + best(c1), 0)
 *
 * Sizes are not known at first. What a first round chooses tells them, and the following
 * rounds take them into account. */
#include "analysis/things_choose.h"

#include <math.h>
#include <stdlib.h>

#define CUT 0.15 /* as much surer must be what the picture cuts */

enum { ROUNDS = 3, FEW = 4, NODES_A_TASK = 2048 };

typedef struct job {
    const tz_things_tree *t;
    const tz_things_choice *how;
    tz_things_overview view;
    tz_things_sizes sizes;
    const tz_things_net *nets;
    float *sure, *best;
} job;

static tz_status judge_some(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    const job *j = arg;
    const int64_t first = i * NODES_A_TASK, end = first + NODES_A_TASK;
    (void)ctx, (void)worker;
    for (int32_t v = (int32_t)first; v < end && v < j->t->n; v++) {
        float f[TZ_THINGS_FEATURES];
        const double area = j->t->node[v].area;
        j->sure[v] = 0;
        if (area < j->how->least || area > j->how->most)
            continue;
        tz_things_describe(j->t, &j->view, &j->sizes, v, f);
        j->sure[v] = (float)tz_things_score(&j->nets[j->sizes.known], f);
    }
    return TZ_OK;
}

/* Pieces of ground that the picture's border closes off look like things that it cuts. */
static float gain(const job *j, int32_t v)
{
    const double bar = j->how->certainty + (j->t->node[v].frame > 0 ? CUT : 0);
    return j->sure[v] - (float)fmin(bar, 1);
}

/* Children stand before their parents. */
static void weigh(const job *j)
{
    const tz_things_tree *t = j->t;
    for (int32_t v = 0; v < t->n; v++) {
        const tz_things_node *n = &t->node[v];
        const float own = gain(j, v);
        const float below =
            n->child[0] < 0 ? 0 : j->best[n->child[0]] + j->best[n->child[1]];
        j->best[v] = own > 0 && own >= below ? own : below;
    }
}

static tz_status collect(tz_ctx *ctx, job *j, tz_things_nodes *chosen)
{
    const tz_things_tree *t = j->t;
    tz_status s = TZ_OK;
    chosen->n = 0;
    /* best[v] < 0 marks what lies in a chosen node; parents come first from above */
    for (int32_t v = t->n - 1; v >= 0 && s == TZ_OK; v--) {
        const tz_things_node *n = &t->node[v];
        const float own = gain(j, v);
        const bool taken = j->best[v] < 0;
        const bool take = !taken && own > 0 && own == j->best[v];
        if (take)
            s = tz_array_push(ctx, chosen, v);
        if ((take || taken) && n->child[0] >= 0)
            j->best[n->child[0]] = j->best[n->child[1]] = -1;
    }
    for (int32_t a = 0, b = chosen->n - 1; a < b; a++, b--) {
        const int32_t v = chosen->v[a];
        chosen->v[a] = chosen->v[b];
        chosen->v[b] = v;
    }
    return s;
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *v, int32_t n)
{
    qsort(v, (size_t)n, sizeof *v, by_value);
    return n % 2 ? v[n / 2] : 0.5 * (v[n / 2 - 1] + v[n / 2]);
}

tz_status tz_things_measure_sizes(tz_ctx *ctx, const tz_things_tree *t,
                                  const tz_things_nodes *of, tz_things_sizes *out)
{
    double *v = NULL;
    int32_t n = 0;
    *out = (tz_things_sizes){0};
    if (of->n < FEW)
        return TZ_OK;
    const tz_status s = tz_alloc(ctx, &v, (size_t)of->n, sizeof *v);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < of->n; i++) /* whole ones, where there are enough */
        if (t->node[of->v[i]].frame == 0)
            v[n++] = log2(t->node[of->v[i]].area);
    for (int32_t i = 0; i < of->n && n < FEW; i++)
        if (t->node[of->v[i]].frame > 0)
            v[n++] = log2(t->node[of->v[i]].area);
    *out = (tz_things_sizes){.known = true, .middle = median(v, n)};
    for (int32_t i = 0; i < n; i++)
        v[i] = fabs(v[i] - out->middle);
    out->spread = 1.48 * median(v, n);
    tz_free(ctx, v);
    return TZ_OK;
}

tz_status tz_things_choose(tz_ctx *ctx, const tz_things_tree *t,
                           const tz_things_choice *how, tz_things_nodes *chosen,
                           float *sure, tz_things_sizes *sizes)
{
    job j = {.t = t, .how = how, .view = tz_things_survey(t)};
    j.nets = how->nets ? how->nets : tz_things_nets;
    float *own = NULL;
    tz_status s = tz_alloc(ctx, &j.best, (size_t)t->n, sizeof *j.best);
    if (s == TZ_OK && !sure)
        s = tz_alloc(ctx, &own, (size_t)t->n, sizeof *own);
    j.sure = sure ? sure : own;
    for (int32_t round = 0; round < ROUNDS && s == TZ_OK; round++) {
        if (round > 0)
            s = tz_things_measure_sizes(ctx, t, chosen, &j.sizes);
        if (s == TZ_OK)
            s = tz_parallel_for(ctx, (t->n + NODES_A_TASK - 1) / NODES_A_TASK, judge_some,
                                &j);
        if (s == TZ_OK) {
            weigh(&j);
            s = collect(ctx, &j, chosen);
        }
    }
    *sizes = j.sizes;
    tz_free(ctx, j.best);
    tz_free(ctx, own);
    return s;
}
