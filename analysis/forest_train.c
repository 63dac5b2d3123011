/* SPDX-License-Identifier: Apache-2.0 */
/* Tree by tree: scenes -> patches -> tree -> its leaves' boundary pixels; then all trees
 * side by side in one forest. Each tree sees scenes and features of its own. */
#include "analysis/forest_train.h"

#include <stdlib.h>
#include <string.h>

#include "analysis/forest_grow.h"
#include "base/number.h"

#define INNER           TZ_FOREST_INNER
/* Scenes that two cores draw, cut and sort a second: 7.3 measured, less some reserve. */
#define SCENES_A_SECOND 6.2
/* Leaves of a tree, about: eight such trees are a file of some 3 MB. */
#define MOST_LEAVES     25000

static const tz_param rows[] = {
    {"trees", TZ_PARAM_INT, offsetof(tz_forest_train_params, trees), 1, 64, "8", "", NULL,
     "trees of the forest; at most four look at one place"},
    {"seed", TZ_PARAM_UINT64, offsetof(tz_forest_train_params, seed), 0, 1.8e19, "1", "",
     NULL, "the same seed and options give the same file"},
    {"budget", TZ_PARAM_STRING, offsetof(tz_forest_train_params, budget), 0, 0, "30m", "",
     NULL,
     "about how long two cores shall work, e.g. 90s, 30m, 1.5h; decides the number of "
     "scenes"},
    {"scenes", TZ_PARAM_INT, offsetof(tz_forest_train_params, scenes), 0, 100000, "0", "",
     NULL, "scenes drawn for each tree; 0 takes the number from the budget"},
    {"patches", TZ_PARAM_INT, offsetof(tz_forest_train_params, patches), 16, 10000, "900",
     "", NULL, "patches cut out of a scene"},
    {"side", TZ_PARAM_INT, offsetof(tz_forest_train_params, side), 64, 2048, "320", "px",
     NULL, "width and height of a scene"},
    {"share", TZ_PARAM_DOUBLE, offsetof(tz_forest_train_params, share), 0.001, 1, "0.5",
     "", NULL, "share of the features that one tree may use"},
    {"tried", TZ_PARAM_INT, offsetof(tz_forest_train_params, tried), 0, 10000, "0", "",
     NULL, "features tried at a node; 0 is the square root of the tree's"},
    {"least", TZ_PARAM_INT, offsetof(tz_forest_train_params, least), 0, 100000, "0", "",
     NULL, "fewest patches in a leaf; 0 is 8, or more where trees would grow too large"},
    {"depth", TZ_PARAM_INT, offsetof(tz_forest_train_params, depth), 1, 64, "64", "",
     NULL, "deepest leaf"},
};

const tz_param_table tz_forest_train_param_table = {
    "train-edges", "Trains a structured forest that finds edges", rows,
    (int32_t)(sizeof rows / sizeof *rows), sizeof(tz_forest_train_params)};

/* ---- budget -------------------------------------------------------------------------- */

static tz_status seconds_of(tz_ctx *ctx, const char *text, double *out)
{
    static const char unit[] = "smh";
    static const double size[] = {1, 60, 3600};
    const char *end;
    double v;
    if (tz_number_parse(text, &end, &v) && v > 0 && v < 1e6) {
        const char *u = *end ? strchr(unit, *end) : unit;
        if (u && (*end == 0 || end[1] == 0)) {
            *out = v * size[u - unit];
            return TZ_OK;
        }
    }
    return tz_fail(ctx, TZ_INVALID,
                   "--budget %s: not a time; write for example 90s, 30m "
                   "or 1.5h",
                   text);
}

static tz_status scenes_of(tz_ctx *ctx, const tz_forest_train_params *p, int32_t *out)
{
    double seconds = 0;
    const tz_status s = seconds_of(ctx, p->budget, &seconds);
    if (s != TZ_OK)
        return s;
    const double n = p->scenes ? p->scenes : seconds * SCENES_A_SECOND / p->trees;
    const double most = INT32_MAX / (double)p->patches;
    *out = (int32_t)(n < 1 ? 1 : n < most ? n : most);
    return TZ_OK;
}

/* ---- leaves -------------------------------------------------------------------------- */

/* Boundaries of a patch, two pixels wide: on both sides of the curve between two pieces. */
static int32_t leaf_bins(const uint8_t *label, uint8_t *bin)
{
    int32_t n = 0;
    for (int32_t x = 0; x < INNER; x++)
        for (int32_t y = 0; y < INNER; y++) {
            const uint8_t *at = label + y * INNER + x;
            const bool on =
                at[0] == 0 || (x > 0 && at[-1] == 0) || (y > 0 && at[-INNER] == 0);
            if (on)
                bin[n++] = (uint8_t)(x * INNER + y);
        }
    return n < TZ_PATCH_CELLS ? n : 0;
}

/* One tree with its leaves, apart from the patches that it was grown from. */
typedef struct grown {
    tz_forest_tree tree;
    TZ_ARRAY(int32_t)
    bound; /* nodes + 1 */
    TZ_ARRAY(uint8_t)
    bin;
} grown;

static tz_status keep_leaves(tz_ctx *ctx, const tz_forest_patches *p, grown *g)
{
    const int32_t n = g->tree.child.n;
    uint8_t bin[TZ_PATCH_CELLS];
    tz_status s = tz_array_reserve(ctx, &g->bound, (int64_t)n + 1);
    for (int32_t i = 0; i < n && s == TZ_OK; i++) {
        const int32_t medoid = g->tree.medoid.v[i];
        g->bound.v[i] = g->bin.n;
        if (medoid < 0)
            continue;
        const int32_t k = leaf_bins(p->label + (size_t)medoid * TZ_PATCH_CELLS, bin);
        if ((s = tz_array_reserve(ctx, &g->bin, (int64_t)g->bin.n + k)) != TZ_OK)
            break;
        memcpy(g->bin.v + g->bin.n, bin, (size_t)k);
        g->bin.n += k;
    }
    if (s == TZ_OK)
        g->bound.v[n] = g->bin.n;
    return s;
}

/* ---- forest -------------------------------------------------------------------------- */

static tz_status train_tree(tz_ctx *ctx, const tz_forest_train_params *params,
                            int32_t scenes, int32_t tree, grown *g)
{
    tz_forest_patches p = {0};
    tz_status s = tz_forest_patches_init(ctx, params, scenes, tree, &p);
    if (s == TZ_OK)
        s = tz_forest_grow(ctx, params, tree, &p, &g->tree);
    if (s == TZ_OK)
        s = keep_leaves(ctx, &p, g);
    tz_forest_patches_deinit(&p);
    return s;
}

static tz_status join(tz_ctx *ctx, const grown *g, int32_t trees, tz_forest *f)
{
    int64_t bins = 0;
    tz_status s;
    *f = (tz_forest){.ctx = ctx, .trees = trees, .evaluated = trees < 4 ? trees : 4};
    for (int32_t t = 0; t < trees; t++) {
        f->nodes = g[t].tree.child.n > f->nodes ? g[t].tree.child.n : f->nodes;
        bins += g[t].bin.n;
    }
    if (bins > INT32_MAX)
        return tz_fail(ctx, TZ_LIMIT, "the forest is too large; train fewer trees");
    const size_t n = (size_t)trees * (size_t)f->nodes;
    if ((s = tz_alloc_zero(ctx, &f->child, n, sizeof *f->child)) != TZ_OK)
        return s;
    if ((s = tz_alloc_zero(ctx, &f->feature, n, sizeof *f->feature)) != TZ_OK)
        return s;
    if ((s = tz_alloc_zero(ctx, &f->threshold, n, sizeof *f->threshold)) != TZ_OK)
        return s;
    if ((s = tz_alloc(ctx, &f->bound, n + 1, sizeof *f->bound)) != TZ_OK)
        return s;
    if ((s = tz_alloc(ctx, &f->bin, (size_t)bins, 1)) != TZ_OK)
        return s;
    int32_t base = 0;
    for (int32_t t = 0; t < trees; t++) {
        const size_t at = (size_t)t * (size_t)f->nodes, own = (size_t)g[t].tree.child.n;
        memcpy(f->child + at, g[t].tree.child.v, own * sizeof *f->child);
        memcpy(f->feature + at, g[t].tree.feature.v, own * sizeof *f->feature);
        memcpy(f->threshold + at, g[t].tree.threshold.v, own * sizeof *f->threshold);
        if (g[t].bin.n > 0)
            memcpy(f->bin + base, g[t].bin.v, (size_t)g[t].bin.n);
        for (size_t i = 0; i < (size_t)f->nodes; i++)
            f->bound[at + i] = base + g[t].bound.v[i < own ? i : own];
        base += g[t].bin.n;
    }
    f->bound[n] = base;
    return TZ_OK;
}

tz_status tz_forest_train(tz_ctx *ctx, const tz_forest_train_params *params,
                          tz_forest *forest)
{
    grown *g = NULL;
    tz_forest_train_params p = *params;
    int32_t scenes = 0;
    tz_forest f = {0};
    tz_status s;
    *forest = (tz_forest){0};
    if ((s = scenes_of(ctx, params, &scenes)) != TZ_OK)
        return s;
    const int64_t patches = (int64_t)scenes * params->patches;
    if (p.least == 0)
        p.least = patches / MOST_LEAVES > 8 ? (int32_t)(patches / MOST_LEAVES) : 8;
    tz_progress_begin(ctx, "train-edges", "scenes and patches",
                      params->trees * (scenes + patches));
    s = tz_alloc_zero(ctx, &g, (size_t)params->trees, sizeof *g);
    for (int32_t t = 0; t < params->trees && s == TZ_OK; t++)
        s = train_tree(ctx, &p, scenes, t, &g[t]);
    if (s == TZ_OK)
        s = join(ctx, g, params->trees, &f);
    for (int32_t t = 0; g && t < params->trees; t++) {
        tz_forest_tree_deinit(ctx, &g[t].tree);
        tz_array_free(ctx, &g[t].bound);
        tz_array_free(ctx, &g[t].bin);
    }
    tz_free(ctx, g);
    tz_progress_end(ctx);
    if (s == TZ_OK)
        *forest = f;
    else
        tz_forest_deinit(&f);
    return s;
}
