/* SPDX-License-Identifier: Apache-2.0 */
/* Scenes are drawn and forgotten one by one; what stays is a byte a feature. The borders
 * of the 256 steps are quantiles of the first scenes' values, rounded to few digits, which
 * keeps the model's file small. */
#include "analysis/forest_patches.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/rng.h"
#include "scenes/scene.h"

#define INNER       TZ_FOREST_INNER
#define CELLS       TZ_PATCH_CELLS
#define EDGES       (TZ_PATCH_STEPS - 1)
#define MOST_CELLS  4096 /* values that a feature's quantiles come from */
#define TREE_SCENES 1000000

enum { STREAM_FEATURES = 1, STREAM_PATCHES };

typedef struct cutter {
    tz_forest_patches *p;
    const tz_forest_train_params *params;
    int32_t tree, scenes;
    int32_t per;  /* patches a scene */
    float *value; /* while edges are sought: features * (per * scenes) */
    int32_t values;
} cutter;

void tz_forest_patches_deinit(tz_forest_patches *p)
{
    tz_free(p->ctx, p->feature);
    tz_free(p->ctx, p->edge);
    tz_free(p->ctx, p->step);
    tz_free(p->ctx, p->label);
    *p = (tz_forest_patches){0};
}

/* ---- what is true ------------------------------------------------------------------- */

/* Parts of the inner patch at (x, y) of the scene between boundary pixels. */
static void label_patch(const tz_scene *scene, int32_t x, int32_t y, uint8_t *label)
{
    uint8_t stack[CELLS];
    int32_t next = 1;
    memset(label, 0, CELLS);
    for (int32_t i = 0; i < CELLS; i++) {
        int32_t n = 0;
        const uint8_t *at = scene->boundary +
                            (size_t)(y + i / INNER) * scene->photo.width + x + i % INNER;
        if (label[i] || *at)
            continue;
        label[i] = (uint8_t)next;
        stack[n++] = (uint8_t)i;
        while (n > 0) {
            const int32_t c = stack[--n], cx = c % INNER, cy = c / INNER;
            static const int8_t sx[4] = {1, -1, 0, 0}, sy[4] = {0, 0, 1, -1};
            for (int k = 0; k < 4; k++) {
                const int32_t px = cx + sx[k], py = cy + sy[k], q = py * INNER + px;
                if (px < 0 || py < 0 || px >= INNER || py >= INNER || label[q] ||
                    scene->boundary[(size_t)(y + py) * scene->photo.width + x + px])
                    continue;
                label[q] = (uint8_t)next;
                stack[n++] = (uint8_t)q;
            }
        }
        next = next < 255 ? next + 1 : 255;
    }
}

/* ---- places -------------------------------------------------------------------------- */

/* Sums of boundary pixels over all rectangles from the origin. */
static tz_status sum_boundary(tz_ctx *ctx, const tz_scene *s, int32_t **out)
{
    const int32_t w = s->photo.width + 1;
    int32_t *sum = NULL;
    const tz_status status =
        tz_alloc_zero(ctx, &sum, (size_t)w * (size_t)(s->photo.height + 1), sizeof *sum);
    if (status != TZ_OK)
        return status;
    for (int32_t y = 0; y < s->photo.height; y++)
        for (int32_t x = 0, row = 0; x < s->photo.width; x++) {
            row += s->boundary[(size_t)y * s->photo.width + x];
            sum[(size_t)(y + 1) * w + x + 1] = sum[(size_t)y * w + x + 1] + row;
        }
    *out = sum;
    return TZ_OK;
}

static bool has_boundary(const int32_t *sum, int32_t w, int32_t x, int32_t y)
{
    const int32_t *a = sum + (size_t)y * (w + 1) + x, *b = a + (size_t)INNER * (w + 1);
    return b[INNER] - b[0] - a[INNER] + a[0] > 0;
}

/* Corners of inner patches on even pixels: half with a boundary, half without, drawn
 * without replacement as far as there are enough; then of the other kind; then again. */
static tz_status choose_places(tz_ctx *ctx, const tz_scene *s, tz_rng *r, int32_t n,
                               int32_t *place)
{
    const int32_t gw = (s->photo.width - INNER) / 2, gh = (s->photo.height - INNER) / 2;
    int32_t *sum = NULL, *grid = NULL, count[2] = {0, 0}, taken[2] = {0, 0};
    tz_status status = sum_boundary(ctx, s, &sum);
    if (status == TZ_OK)
        status = tz_alloc(ctx, &grid, (size_t)gw * (size_t)gh, sizeof *grid);
    if (status != TZ_OK)
        goto done;
    const int32_t all = gw * gh;
    for (int32_t i = 0; i < all; i++) { /* without from the front, with from the back */
        const bool with = has_boundary(sum, s->photo.width, 2 * (i % gw), 2 * (i / gw));
        grid[with ? all - 1 - count[1] : count[0]] = i;
        count[with]++;
    }
    for (int32_t i = 0; i < n; i++) {
        const int wanted = i % 2;
        const int kind = taken[wanted] < count[wanted] ? wanted : !wanted;
        int32_t *list = kind ? grid + all - count[1] : grid;
        if (taken[kind] >= count[kind])
            taken[kind] = 0;
        const int32_t k = taken[kind] + tz_rng_below(r, count[kind] - taken[kind]);
        const int32_t chosen = list[k];
        list[k] = list[taken[kind]];
        list[taken[kind]++] = chosen;
        place[2 * i] = 2 * (chosen % gw);
        place[2 * i + 1] = 2 * (chosen / gw);
    }
done:
    tz_free(ctx, sum);
    tz_free(ctx, grid);
    return status;
}

/* ---- one scene ----------------------------------------------------------------------- */

static void photo_row(const void *source, int32_t y, float *rgb)
{
    const tz_image *im = source;
    memcpy(rgb, tz_image_at(im, 0, y), 3 * sizeof *rgb * (size_t)im->width);
}

/* Number of edges that are at or below v. */
static uint8_t step_of(const float *edge, float v)
{
    int32_t k = 0;
    for (int32_t half = 128; half > 0; half /= 2)
        k += v >= edge[k + half - 1] ? half : 0;
    return (uint8_t)k;
}

static void cut(const cutter *c, const tz_scene *scene, const tz_forest_features *f,
                const int32_t *place, int64_t index)
{
    tz_forest_patches *p = c->p;
    const size_t first = (size_t)index * (size_t)c->per;
    for (int32_t k = 0; k < p->features; k++) {
        int32_t a, b;
        tz_forest_feature_place(p->feature[k], f->width, &a, &b);
        for (int32_t i = 0; i < c->per; i++) {
            /* the inner patch at x is the whole one at x of the padded picture */
            const float *at =
                tz_forest_features_at(f, place[2 * i] / 2, place[2 * i + 1] / 2);
            const float v = at[a] - at[b];
            if (c->value)
                c->value[(size_t)k * (size_t)c->values + first + (size_t)i] = v;
            else
                p->step[(size_t)k * (size_t)p->n + first + (size_t)i] =
                    step_of(p->edge + (size_t)k * EDGES, v);
        }
    }
    for (int32_t i = 0; i < c->per && !c->value; i++)
        label_patch(scene, place[2 * i], place[2 * i + 1],
                    p->label + (first + (size_t)i) * CELLS);
}

static tz_status cut_scene(tz_ctx *ctx, void *arg, int64_t index, int worker)
{
    const cutter *c = arg;
    const int32_t side = c->params->side;
    const uint64_t seed = (uint64_t)c->tree * (uint64_t)c->scenes + (uint64_t)index;
    tz_rng r = tz_rng_make(c->params->seed, tz_rng_stream(STREAM_PATCHES, seed, 0));
    const tz_scene_kind kind = (tz_scene_kind)(index % TZ_SCENE_COUNT);
    tz_scene scene = {0};
    tz_forest_features f = {0};
    int32_t *place = NULL;
    tz_status s;
    (void)worker;
    s = tz_scene_render(ctx, kind, TZ_SCENE_WILD, side, side,
                        (seed + c->params->seed * 7919) % TZ_FOREST_HELD_OUT, &scene);
    if (s != TZ_OK)
        goto done;
    s = tz_forest_features_init(ctx, photo_row, &scene.photo, side, side, 0,
                                side / 2 + TZ_FOREST_PAD, &f);
    if (s != TZ_OK)
        goto done;
    if ((s = tz_alloc(ctx, &place, (size_t)c->per, 2 * sizeof *place)) != TZ_OK)
        goto done;
    if ((s = choose_places(ctx, &scene, &r, c->per, place)) != TZ_OK)
        goto done;
    cut(c, &scene, &f, place, index);
    tz_progress_add(ctx, c->value ? 0 : 1);
done:
    tz_free(ctx, place);
    tz_forest_features_deinit(&f);
    tz_scene_deinit(&scene);
    return s;
}

/* ---- steps --------------------------------------------------------------------------- */

static int by_value(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* To four digits: differences below are noise, and digits cost room in the file. */
static float rounded(float v)
{
    if (v == 0 || !isfinite(v))
        return 0;
    const double unit = pow(10, floor(log10(fabs((double)v))) - 3);
    return (float)(round(v / unit) * unit);
}

static tz_status find_edges(tz_ctx *ctx, void *arg, int64_t k, int worker)
{
    const cutter *c = arg;
    float *v = c->value + (size_t)k * (size_t)c->values;
    float *edge = c->p->edge + (size_t)k * EDGES;
    int32_t n = 0;
    (void)ctx, (void)worker;
    qsort(v, (size_t)c->values, sizeof *v, by_value);
    for (int32_t i = 1; i <= EDGES; i++) {
        const float e = rounded(v[(size_t)i * (size_t)c->values / TZ_PATCH_STEPS]);
        if (e > v[0] && (n == 0 || e > edge[n - 1]))
            edge[n++] = e;
    }
    while (n < EDGES)
        edge[n++] = INFINITY;
    return TZ_OK;
}

/* Quantiles of the features over the first scenes of every kind. */
static tz_status find_steps(tz_ctx *ctx, cutter *c)
{
    const int32_t wanted = 2 * TZ_SCENE_COUNT;
    const int32_t scenes = c->scenes < wanted ? c->scenes : wanted, per = c->per;
    tz_status s;
    if (c->per > MOST_CELLS / 8)
        c->per = MOST_CELLS / 8;
    c->values = scenes * c->per;
    s = tz_alloc(ctx, &c->value, (size_t)c->p->features,
                 (size_t)c->values * sizeof *c->value);
    if (s == TZ_OK)
        s = tz_parallel_for(ctx, scenes, cut_scene, c);
    if (s == TZ_OK)
        s = tz_parallel_for(ctx, c->p->features, find_edges, c);
    tz_free(ctx, c->value);
    c->value = NULL;
    c->per = per;
    return s;
}

static tz_status choose_features(tz_ctx *ctx, const cutter *c)
{
    tz_forest_patches *p = c->p;
    tz_rng r = tz_rng_make(c->params->seed,
                           tz_rng_stream(STREAM_FEATURES, (uint64_t)c->tree, 0));
    int32_t left = p->features, n = 0;
    const tz_status s = tz_alloc(ctx, &p->feature, (size_t)left, sizeof *p->feature);
    for (int32_t id = 0; id < TZ_FOREST_FEATURES && s == TZ_OK; id++)
        if (tz_rng_below(&r, TZ_FOREST_FEATURES - id) < left) {
            p->feature[n++] = id;
            left--;
        }
    return s;
}

tz_status tz_forest_patches_init(tz_ctx *ctx, const tz_forest_train_params *params,
                                 int32_t scenes, int32_t tree, tz_forest_patches *p)
{
    cutter c = {
        .p = p, .params = params, .tree = tree, .scenes = scenes, .per = params->patches};
    tz_status s;
    *p = (tz_forest_patches){.ctx = ctx, .n = scenes * params->patches};
    p->features = (int32_t)(params->share * TZ_FOREST_FEATURES);
    p->features = p->features > 1 ? p->features : 1;
    if ((s = choose_features(ctx, &c)) != TZ_OK)
        goto done;
    s = tz_alloc(ctx, &p->edge, (size_t)p->features, EDGES * sizeof *p->edge);
    if (s != TZ_OK)
        goto done;
    if ((s = find_steps(ctx, &c)) != TZ_OK)
        goto done;
    if ((s = tz_alloc(ctx, &p->step, (size_t)p->features, (size_t)p->n)) != TZ_OK)
        goto done;
    if ((s = tz_alloc(ctx, &p->label, (size_t)p->n, CELLS)) != TZ_OK)
        goto done;
    s = tz_parallel_for(ctx, scenes, cut_scene, &c);
done:
    if (s != TZ_OK)
        tz_forest_patches_deinit(p);
    return s;
}
