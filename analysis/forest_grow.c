/* SPDX-License-Identifier: Apache-2.0 */
/* Level by level: the nodes of a level are split in parallel, each with random draws named
 * by tree and node; their children are numbered in order afterwards. */
#include "analysis/forest_grow.h"

#include <math.h>
#include <string.h>

#include "base/rng.h"

#define PAIRS      256
#define SUBSET     512 /* patches that the principal component is found from */
#define ROUNDS     12  /* of power iteration */
#define MOST_TRIED 1024

enum { STREAM_NODE = 3 };

/* A node that waits: its patches are order[from .. to - 1]. */
typedef struct open_node {
    int32_t id, from, to;
    /* result of the split */
    int32_t feature; /* index among the tree's, or -1 = leaf */
    int32_t step;    /* patches of steps below it go left */
    int32_t middle;  /* first of the right child */
    int32_t medoid;
} open_node;

/* Work space of one worker. */
typedef struct space {
    uint8_t first[PAIRS], second[PAIRS];
    float mean[PAIRS], axis[PAIRS];
    float *z;       /* SUBSET * PAIRS */
    uint8_t *class; /* of every patch of the node, by place in order */
} space;

typedef struct grower {
    const tz_forest_train_params *params;
    const tz_forest_patches *p;
    int32_t tree, depth, tried;
    int32_t *order, *spare; /* patches by node */
    uint8_t *class;         /* as order */
    open_node *open;
    space *space;
} grower;

/* ---- structured labels to two classes ------------------------------------------------ */

static void draw_pairs(tz_rng *r, space *s)
{
    for (int k = 0; k < PAIRS; k++) {
        s->first[k] = (uint8_t)tz_rng_below(r, TZ_PATCH_CELLS);
        do {
            s->second[k] = (uint8_t)tz_rng_below(r, TZ_PATCH_CELLS);
        } while (s->second[k] == s->first[k]);
    }
}

/* z = 1 where both pixels of a pair lie in the same part, less `mean`. */
static void map_label(const space *s, const uint8_t *label, float *z)
{
    for (int k = 0; k < PAIRS; k++)
        z[k] = label[s->first[k]] == label[s->second[k]] ? 1.0F : 0.0F;
}

/* The subset's k-th patch of a node's n. */
static int32_t subset(const grower *g, const open_node *o, int32_t k, int32_t m)
{
    return g->order[o->from + (int32_t)((int64_t)k * (o->to - o->from) / m)];
}

/* Fills z (centred) and mean of a subset; returns its size. */
static int32_t map_subset(const grower *g, const open_node *o, space *s)
{
    const int32_t n = o->to - o->from, m = n < SUBSET ? n : SUBSET;
    memset(s->mean, 0, sizeof s->mean);
    for (int32_t i = 0; i < m; i++) {
        float *z = s->z + (size_t)i * PAIRS;
        map_label(s, g->p->label + (size_t)subset(g, o, i, m) * TZ_PATCH_CELLS, z);
        for (int k = 0; k < PAIRS; k++)
            s->mean[k] += z[k];
    }
    for (int k = 0; k < PAIRS; k++)
        s->mean[k] /= (float)m;
    for (int32_t i = 0; i < m; i++)
        for (int k = 0; k < PAIRS; k++)
            s->z[(size_t)i * PAIRS + (size_t)k] -= s->mean[k];
    return m;
}

/* Dot product with eight sums side by side: a fixed order that registers can follow. */
static float dot(const float *a, const float *b)
{
    float sum[8] = {0};
    for (int k = 0; k < PAIRS; k += 8)
        for (int j = 0; j < 8; j++)
            sum[j] += a[k + j] * b[k + j];
    return ((sum[0] + sum[4]) + (sum[1] + sum[5])) +
           ((sum[2] + sum[6]) + (sum[3] + sum[7]));
}

/* First principal axis of the centred z by power iteration, from the patch farthest from
 * the mean; false if all labels are alike. */
static bool find_axis(space *s, int32_t m)
{
    float next[PAIRS], most = 0;
    int32_t far = 0;
    for (int32_t i = 0; i < m; i++) {
        const float *z = s->z + (size_t)i * PAIRS, d = dot(z, z);
        far = d > most ? i : far;
        most = d > most ? d : most;
    }
    if (most < 1e-3F)
        return false;
    memcpy(s->axis, s->z + (size_t)far * PAIRS, sizeof s->axis);
    for (int round = 0; round < ROUNDS; round++) {
        memset(next, 0, sizeof next);
        for (int32_t i = 0; i < m; i++) {
            const float *z = s->z + (size_t)i * PAIRS, d = dot(z, s->axis);
            for (int k = 0; k < PAIRS; k++)
                next[k] += d * z[k];
        }
        const float norm = sqrtf(dot(next, next));
        if (norm <= 0)
            return false;
        for (int k = 0; k < PAIRS; k++)
            s->axis[k] = next[k] / norm;
    }
    return true;
}

/* Class of every patch of the node; returns how many are of class 1. */
static int32_t classify(const grower *g, const open_node *o, const space *s)
{
    float z[PAIRS];
    const float middle = dot(s->mean, s->axis);
    int32_t ones = 0;
    for (int32_t i = o->from; i < o->to; i++) {
        map_label(s, g->p->label + (size_t)g->order[i] * TZ_PATCH_CELLS, z);
        g->class[i] = dot(z, s->axis) > middle;
        ones += g->class[i];
    }
    return ones;
}

/* The patch of the subset nearest to the mean. */
static int32_t find_medoid(const grower *g, const open_node *o, const space *s, int32_t m)
{
    float least = INFINITY;
    int32_t best = 0;
    for (int32_t i = 0; i < m; i++) {
        const float *z = s->z + (size_t)i * PAIRS, d = dot(z, z);
        best = d < least ? i : best;
        least = d < least ? d : least;
    }
    return subset(g, o, best, m);
}

/* ---- splits -------------------------------------------------------------------------- */

/* Best step of one feature by Gini impurity; returns the weighted purity of both sides,
 * sum over sides of (n0^2 + n1^2) / n, larger is better. */
static double best_step(const grower *g, const open_node *o, int32_t feature,
                        int32_t ones, int32_t *step)
{
    int32_t count[TZ_PATCH_STEPS][2] = {{0}};
    const uint8_t *v = g->p->step + (size_t)feature * (size_t)g->p->n;
    const int32_t n = o->to - o->from, least = g->params->least;
    double best = -1, left[2] = {0, 0};
    for (int32_t i = o->from; i < o->to; i++)
        count[v[g->order[i]]][g->class[i]]++;
    for (int32_t k = 1; k < TZ_PATCH_STEPS; k++) {
        left[0] += count[k - 1][0];
        left[1] += count[k - 1][1];
        const double nl = left[0] + left[1], nr = n - nl;
        if (nl < least)
            continue;
        if (nr < least)
            break;
        const double r1 = ones - left[1], r0 = nr - r1;
        const double purity =
            (left[0] * left[0] + left[1] * left[1]) / nl + (r0 * r0 + r1 * r1) / nr;
        if (purity > best) {
            best = purity;
            *step = k;
        }
    }
    return best;
}

static void choose_split(const grower *g, open_node *o, tz_rng *r, int32_t ones)
{
    const double n = o->to - o->from, zeros = n - ones;
    double best = (zeros * zeros + (double)ones * ones) / n + 1e-9 * n;
    for (int32_t i = 0; i < g->tried; i++) {
        const int32_t feature = tz_rng_below(r, g->p->features);
        int32_t step = 0;
        const double purity = best_step(g, o, feature, ones, &step);
        if (purity > best) {
            best = purity;
            o->feature = feature;
            o->step = step;
        }
    }
}

/* Moves the patches below the step to the front, both sides in their old order. */
static void part(const grower *g, open_node *o)
{
    const uint8_t *v = g->p->step + (size_t)o->feature * (size_t)g->p->n;
    int32_t left = o->from, right = 0;
    for (int32_t i = o->from; i < o->to; i++) {
        const int32_t patch = g->order[i];
        if (v[patch] < o->step)
            g->order[left++] = patch;
        else
            g->spare[o->from + right++] = patch;
    }
    memcpy(g->order + left, g->spare + o->from, (size_t)right * sizeof *g->order);
    o->middle = left;
}

static tz_status split(tz_ctx *ctx, void *arg, int64_t index, int worker)
{
    const grower *g = arg;
    open_node *o = &g->open[index];
    space *s = &g->space[worker];
    const int32_t n = o->to - o->from;
    const uint64_t name = ((uint64_t)g->tree << 32) | (uint32_t)o->id;
    tz_rng r = tz_rng_make(g->params->seed, tz_rng_stream(STREAM_NODE, name, 0));
    o->feature = -1;
    draw_pairs(&r, s);
    const int32_t m = map_subset(g, o, s);
    if (n >= 2 * g->params->least && g->depth < g->params->depth && find_axis(s, m)) {
        const int32_t ones = classify(g, o, s);
        if (ones > 0 && ones < n)
            choose_split(g, o, &r, ones);
    }
    if (o->feature >= 0) {
        part(g, o);
    } else {
        o->medoid = find_medoid(g, o, s, m);
        tz_progress_add(ctx, n);
    }
    return tz_ctx_cancelled(ctx) ? TZ_CANCELLED : TZ_OK;
}

/* ---- the tree ------------------------------------------------------------------------ */

void tz_forest_tree_deinit(tz_ctx *ctx, tz_forest_tree *t)
{
    tz_array_free(ctx, &t->child);
    tz_array_free(ctx, &t->feature);
    tz_array_free(ctx, &t->threshold);
    tz_array_free(ctx, &t->medoid);
}

static tz_status tree_reserve(tz_ctx *ctx, tz_forest_tree *t, int64_t n)
{
    tz_status s = tz_array_reserve(ctx, &t->child, n);
    if (s == TZ_OK)
        s = tz_array_reserve(ctx, &t->feature, n);
    if (s == TZ_OK)
        s = tz_array_reserve(ctx, &t->threshold, n);
    if (s == TZ_OK)
        s = tz_array_reserve(ctx, &t->medoid, n);
    return s;
}

static void tree_add(tz_forest_tree *t)
{
    t->child.v[t->child.n++] = 0;
    t->feature.v[t->feature.n++] = 0;
    t->threshold.v[t->threshold.n++] = 0;
    t->medoid.v[t->medoid.n++] = -1;
}

typedef TZ_ARRAY(open_node)
node_list;

/* Writes the level's results into the tree and lists the children. */
static tz_status take_level(tz_ctx *ctx, const grower *g, const node_list *level,
                            tz_forest_tree *t, node_list *next)
{
    tz_status s = TZ_OK;
    next->n = 0;
    for (int32_t i = 0; i < level->n && s == TZ_OK; i++) {
        const open_node *o = &level->v[i];
        if (o->feature < 0) {
            t->medoid.v[o->id] = o->medoid;
            continue;
        }
        const int32_t left = t->child.n;
        if ((s = tree_reserve(ctx, t, (int64_t)left + 2)) != TZ_OK)
            break;
        tree_add(t);
        tree_add(t);
        t->child.v[o->id] = left + 1;
        t->feature.v[o->id] = g->p->feature[o->feature];
        t->threshold.v[o->id] =
            g->p->edge[(size_t)o->feature * (TZ_PATCH_STEPS - 1) + (size_t)o->step - 1];
        const open_node a = {.id = left, .from = o->from, .to = o->middle};
        const open_node b = {.id = left + 1, .from = o->middle, .to = o->to};
        if ((s = tz_array_push(ctx, next, a)) == TZ_OK)
            s = tz_array_push(ctx, next, b);
    }
    return s;
}

static tz_status grower_init(tz_ctx *ctx, grower *g)
{
    const size_t n = (size_t)g->p->n, workers = (size_t)tz_ctx_threads(ctx);
    tz_status s;
    if ((s = tz_alloc(ctx, &g->order, n, sizeof *g->order)) != TZ_OK)
        return s;
    if ((s = tz_alloc(ctx, &g->spare, n, sizeof *g->spare)) != TZ_OK)
        return s;
    if ((s = tz_alloc(ctx, &g->class, n, 1)) != TZ_OK)
        return s;
    if ((s = tz_alloc_zero(ctx, &g->space, workers, sizeof *g->space)) != TZ_OK)
        return s;
    for (size_t i = 0; i < workers && s == TZ_OK; i++)
        s = tz_alloc(ctx, &g->space[i].z, (size_t)SUBSET * PAIRS, sizeof(float));
    for (int32_t i = 0; i < g->p->n && s == TZ_OK; i++)
        g->order[i] = i;
    return s;
}

static void grower_deinit(tz_ctx *ctx, grower *g)
{
    for (int i = 0; g->space && i < tz_ctx_threads(ctx); i++)
        tz_free(ctx, g->space[i].z);
    tz_free(ctx, g->order);
    tz_free(ctx, g->spare);
    tz_free(ctx, g->class);
    tz_free(ctx, g->space);
}

tz_status tz_forest_grow(tz_ctx *ctx, const tz_forest_train_params *params, int32_t tree,
                         const tz_forest_patches *p, tz_forest_tree *t)
{
    grower g = {.params = params, .p = p, .tree = tree};
    node_list level = {0}, next = {0};
    tz_status s;
    *t = (tz_forest_tree){0};
    g.tried = params->tried ? params->tried : (int32_t)(sqrt(p->features) + 0.5);
    if ((s = grower_init(ctx, &g)) != TZ_OK)
        goto done;
    if ((s = tree_reserve(ctx, t, 1)) != TZ_OK)
        goto done;
    tree_add(t);
    s = tz_array_push(ctx, &level, ((open_node){.to = p->n}));
    for (; s == TZ_OK && level.n > 0; g.depth++) {
        g.open = level.v;
        s = tz_parallel_for(ctx, level.n, split, &g);
        if (s == TZ_OK)
            s = take_level(ctx, &g, &level, t, &next);
        const node_list swap = level;
        level = next;
        next = swap;
    }
done:
    grower_deinit(ctx, &g);
    tz_array_free(ctx, &level);
    tz_array_free(ctx, &next);
    if (s != TZ_OK)
        tz_forest_tree_deinit(ctx, t);
    return s;
}
