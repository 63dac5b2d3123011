/* SPDX-License-Identifier: Apache-2.0 */
/* One scale: channels -> every tree walked down for every patch -> boundary pixels of the
 * leaves counted -> counts smoothed. A pixel is looked at by (16 / stride)^2 patches with
 * `evaluated` trees each; neighbouring patches ask different trees. Counts are whole and
 * the smoothing is a sum of quarters of them, so nothing depends on the order of work.
 *
 * A step of a walk is one comparison, value < threshold, that chooses between neighbouring
 * nodes; a leaf is its own child. Eight walks down one tree go on at once: each waits for
 * memory most of the time. */
#include "analysis/forest.h"

#include <math.h>
#include <string.h>

#define INNER      TZ_FOREST_INNER
#define BLOCK      16 /* rows of patches, or of pixels, a task */
#define WALKS      8
#define MOST_WALKS 256

typedef struct walk_node {
    float threshold;
    int32_t next; /* at or above the threshold; the node before it below */
    int32_t a, b; /* places of the two values, floats from the patch's first position */
} walk_node;

typedef struct detection {
    const tz_forest *forest;
    const walk_node *node;
    tz_forest_features f;
    int32_t width, height, stride;
    int32_t first, rows; /* rows of patches */
    int32_t columns;     /* patches a row */
    int32_t *leaf;       /* rows * columns * evaluated */
    uint16_t *count;     /* rows y0 - 1 .. y1 of pixels, count_rows of them */
    int32_t count_first, count_rows;
    int32_t y0, y1;
    float *response;
} detection;

/* ---- walks --------------------------------------------------------------------------- */

/* Trees one after another, each from an odd place on, so that the two children of a node
 * share a cache line. */
static int32_t tree_stride(const tz_forest *f) { return f->nodes / 2 * 2 + 2; }
static int32_t tree_root(const tz_forest *f, int32_t tree)
{
    return tree * tree_stride(f) + 1;
}

static tz_status prepare_nodes(tz_ctx *ctx, const tz_forest *f, int32_t width,
                               walk_node **out)
{
    int32_t place[TZ_FOREST_FEATURES][2];
    walk_node *node = NULL;
    const tz_status s =
        tz_alloc(ctx, &node, (size_t)tree_root(f, f->trees), sizeof *node);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < TZ_FOREST_FEATURES; i++)
        tz_forest_feature_place(i, width, &place[i][0], &place[i][1]);
    for (int32_t t = 0; t < f->trees; t++) {
        const size_t from = (size_t)t * (size_t)f->nodes;
        const int32_t root = tree_root(f, t);
        for (int32_t i = 0; i < f->nodes; i++) {
            const int32_t c = f->child[from + (size_t)i];
            const int32_t *p = place[c ? f->feature[from + (size_t)i] : 0];
            node[root + i] =
                c ? (walk_node){f->threshold[from + (size_t)i], root + c, p[0], p[1]}
                  : (walk_node){-INFINITY, root + i, p[0], p[1]};
        }
    }
    *out = node;
    return TZ_OK;
}

static inline int32_t step(const walk_node *node, int32_t at, const float *v)
{
    const walk_node *n = node + at;
    return n->next - (v[n->a] - v[n->b] < n->threshold);
}

/* Walks down one tree that are gathered until there are MOST_WALKS of them. */
typedef struct walk_list {
    const float *v[MOST_WALKS];
    int32_t *leaf[MOST_WALKS]; /* where the results go */
    int32_t n;
} walk_list;

/* Walks them all, WALKS at once; whoever arrives makes room for the next. */
static void walk_all(const detection *d, int32_t tree, walk_list *l)
{
    const int32_t root = tree_root(d->forest, tree), from = tree * d->forest->nodes;
    const int32_t lanes = l->n < WALKS ? l->n : WALKS;
    int32_t here[WALKS], walk[WALKS], next = lanes, left = l->n;
    const float *v[WALKS];
    for (int32_t k = 0; k < lanes; k++)
        here[k] = root, walk[k] = k, v[k] = l->v[k];
    while (left > 0)
        for (int32_t k = 0; k < lanes; k++) {
            const int32_t to = step(d->node, here[k], v[k]);
            if (to != here[k]) {
                here[k] = to;
                continue;
            }
            if (walk[k] < 0) /* waits for the others */
                continue;
            *l->leaf[walk[k]] = to - root + from;
            left--;
            walk[k] = next < l->n ? next++ : -1;
            if (walk[k] >= 0)
                here[k] = root, v[k] = l->v[walk[k]];
        }
    l->n = 0;
}

/* A block of rows of patches, tree by tree: one tree stays in the cache, all do not. Patch
 * (i, j) asks trees (i + j) mod 2e, and the e - 1 after it. */
static tz_status walk_rows(tz_ctx *ctx, void *arg, int64_t task, int worker)
{
    const detection *d = arg;
    const tz_forest *f = d->forest;
    const int32_t e = f->evaluated, from = (int32_t)task * BLOCK;
    const int32_t to = from + BLOCK < d->rows ? from + BLOCK : d->rows;
    walk_list l = {.n = 0};
    (void)worker;
    for (int32_t tree = 0; tree < f->trees; tree++) {
        for (int32_t r = from; r < to; r++) {
            const int32_t i = d->first + r;
            int32_t *leaf = d->leaf + (size_t)r * (size_t)d->columns * (size_t)e;
            const float *row = tz_forest_features_at(&d->f, 0, i * d->stride / 2);
            for (int32_t j = 0; j < d->columns; j++) {
                const int32_t k =
                    (tree + f->trees - (i + j) % (2 * e) % f->trees) % f->trees;
                if (k >= e)
                    continue;
                l.v[l.n] = row + (size_t)(j * d->stride / 2) * TZ_FOREST_STEP;
                l.leaf[l.n] = leaf + j * e + k;
                if (++l.n == MOST_WALKS)
                    walk_all(d, tree, &l);
            }
        }
        walk_all(d, tree, &l);
    }
    return tz_ctx_cancelled(ctx) ? TZ_CANCELLED : TZ_OK;
}

/* ---- counts -------------------------------------------------------------------------- */

/* Rows of pixels that this task counts; it reads every patch that reaches them. */
static tz_status count_rows(tz_ctx *ctx, void *arg, int64_t task, int worker)
{
    const detection *d = arg;
    const tz_forest *f = d->forest;
    const int32_t rows = 4 * BLOCK, from = d->count_first + (int32_t)task * rows;
    const int32_t end = d->count_first + d->count_rows;
    const int32_t to = from + rows < end ? from + rows : end, e = f->evaluated;
    uint16_t *count = d->count + (size_t)(from - d->count_first) * d->width;
    (void)ctx, (void)worker;
    memset(count, 0, (size_t)(to - from) * d->width * sizeof *count);
    for (int32_t r = 0; r < d->rows; r++) {
        const int32_t top = (d->first + r) * d->stride;
        if (top + INNER <= from || top >= to)
            continue;
        const int32_t *leaf = d->leaf + (size_t)r * (size_t)d->columns * (size_t)e;
        const bool inside = top >= from && top + INNER <= to;
        for (int32_t j = 0; j < d->columns; j++)
            for (int32_t k = 0; k < e; k++, leaf++)
                for (int32_t p = f->bound[*leaf]; p < f->bound[*leaf + 1]; p++) {
                    const int32_t y = top + (f->bin[p] & 15), x = f->bin[p] >> 4;
                    if (inside || (y >= from && y < to))
                        count[(size_t)(y - from) * d->width + j * d->stride + x]++;
                }
    }
    return TZ_OK;
}

static int32_t mirror_101(int32_t i, int32_t n)
{
    return i < 0 ? -i : i >= n ? 2 * n - 2 - i : i;
}

/* 1 2 1 both ways, and the weight of one count. */
static tz_status smooth_rows(tz_ctx *ctx, void *arg, int64_t task, int worker)
{
    const detection *d = arg;
    const int32_t w = d->width, to = d->y0 + ((int32_t)task + 1) * BLOCK;
    const float weight = 2.0F * (float)(d->stride * d->stride) / (INNER * INNER) /
                         (float)d->forest->evaluated / 16;
    (void)ctx, (void)worker;
    for (int32_t y = to - BLOCK; y < to && y < d->y1; y++) {
        const uint16_t *row[3];
        float *out = d->response + (size_t)(y - d->y0) * w;
        for (int k = 0; k < 3; k++)
            row[k] = d->count +
                     (size_t)(mirror_101(y + k - 1, d->height) - d->count_first) * w;
        int32_t before = 0, here = row[0][0] + 2 * row[1][0] + row[2][0], after;
        before = row[0][1] + 2 * row[1][1] + row[2][1];
        for (int32_t x = 0; x < w; x++, before = here, here = after) {
            const int32_t next = x + 1 < w ? x + 1 : w - 2;
            after = row[0][next] + 2 * row[1][next] + row[2][next];
            out[x] = (float)(before + 2 * here + after) * weight;
        }
    }
    return TZ_OK;
}

/* ---- one scale ----------------------------------------------------------------------- */

static tz_status detection_run(tz_ctx *ctx, detection *d)
{
    tz_status s;
    s = tz_parallel_for(ctx, (d->rows + BLOCK - 1) / BLOCK, walk_rows, d);
    if (s == TZ_OK)
        s = tz_parallel_for(ctx, (d->count_rows + 4 * BLOCK - 1) / (4 * BLOCK),
                            count_rows, d);
    if (s == TZ_OK)
        s = tz_parallel_for(ctx, (d->y1 - d->y0 + BLOCK - 1) / BLOCK, smooth_rows, d);
    return s;
}

tz_status tz_forest_detect(tz_ctx *ctx, const tz_forest *forest, tz_forest_row row,
                           const void *source, int32_t width, int32_t height,
                           int32_t stride, int32_t y0, int32_t y1, float *response)
{
    detection d = {.forest = forest,
                   .width = width,
                   .height = height,
                   .stride = stride,
                   .y0 = y0,
                   .y1 = y1,
                   .response = response};
    walk_node *node = NULL;
    tz_status s;
    d.count_first = y0 > 0 ? y0 - 1 : 0;
    d.count_rows = (y1 + 1 < height ? y1 + 1 : height) - d.count_first;
    d.columns = (width - INNER + stride - 1) / stride;
    const int32_t patches = (height - INNER + stride - 1) / stride;
    const int32_t reach = d.count_first - (INNER - 1);
    d.first = reach > 0 ? (reach + stride - 1) / stride : 0;
    if (d.first > patches - 1)
        d.first = patches - 1;
    d.rows = (d.count_first + d.count_rows - 1) / stride + 1;
    d.rows = (d.rows < patches ? d.rows : patches) - d.first;
    const int32_t top = d.first * stride / 2;
    const int32_t bottom = (d.first + d.rows - 1) * stride / 2 + TZ_FOREST_SIDE;

    s = tz_forest_features_init(ctx, row, source, width, height, top, bottom - top, &d.f);
    if (s != TZ_OK)
        return s;
    if ((s = prepare_nodes(ctx, forest, d.f.width, &node)) != TZ_OK)
        goto done;
    s = tz_alloc(ctx, &d.leaf, (size_t)d.rows * (size_t)d.columns,
                 (size_t)forest->evaluated * sizeof *d.leaf);
    if (s != TZ_OK)
        goto done;
    s = tz_alloc(ctx, &d.count, (size_t)d.count_rows * (size_t)width, sizeof *d.count);
    if (s != TZ_OK)
        goto done;
    d.node = node;
    s = detection_run(ctx, &d);
done:
    tz_free(ctx, node);
    tz_free(ctx, d.leaf);
    tz_free(ctx, d.count);
    tz_forest_features_deinit(&d.f);
    return s;
}
