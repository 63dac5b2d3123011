/* SPDX-License-Identifier: Apache-2.0 */
/* Patch distance: sliced Wasserstein over a Laplacian pyramid.
 *
 * At each level N patches of 7 x 7 pixels and all planes are drawn from the output and as
 * many from the exemplar; both clouds are projected on random directions u, and
 *   SW = mean over u of mean over i of |sort(<a, u>)_i - sort(<b, u>)_i|
 * [Rabin et al. 2011; over a pyramid: Karras et al. 2018, Sec. 5]. Directions are Gaussian
 * numbers under a Gaussian window of random place and width: dense random directions alone
 * see nearly normal sums whatever the texture, local ones see its edges.
 *
 * The yardstick is SW between halves of the exemplar: left and right, top and bottom, and
 * the two diagonal pairs of quarters, with as many patches, so that the noise of finite
 * drawing is the same above and below the line. Patches of the exemplar are drawn a
 * quarter, so that each is projected once. */
#include <math.h>
#include <string.h>

#include "analysis/quality_measures.h"
#include "base/rng.h"

#define PATCH    7
#define DIM_MAX  (PATCH * PATCH * 3)
#define BLOCK    32 /* directions projected at once */
#define SETS     5  /* four quarters of the exemplar, the output */
#define MIN_SIDE 14 /* below, the halves hold no two separate patches */

typedef struct patch_level {
    const tz_quality_work *w;
    int32_t level, dim, directions;
    int32_t n;        /* patches a quarter; 2 n in the output */
    float *direction; /* [dim][directions] */
    float *value;     /* [directions][6 n]: TL, TR, BL, BR, output */
    double *distance; /* [directions][2]: to the output, between halves */
    double *spread;   /* [directions]: mean absolute deviation in the exemplar */
} patch_level;

/* ---- drawing and projecting ----------------------------------------------------- */

static void draw_directions(patch_level *p, uint64_t seed)
{
    int32_t planes = p->dim / (PATCH * PATCH);
    for (int32_t d = 0; d < p->directions; d++) {
        tz_rng r = tz_rng_make(seed, tz_rng_stream('d', (uint64_t)p->level, (uint64_t)d));
        double cx = tz_rng_range(&r, 1, PATCH - 2), cy = tz_rng_range(&r, 1, PATCH - 2);
        double sigma = tz_rng_range(&r, 0.7, 4), sum = 0, v[DIM_MAX] = {0};
        for (int32_t c = 0, k = 0; c < planes; c++)
            for (int32_t y = 0; y < PATCH; y++)
                for (int32_t x = 0; x < PATCH; x++, k++) {
                    double q = (x - cx) * (x - cx) + (y - cy) * (y - cy);
                    v[k] = tz_rng_normal(&r) * exp(-q / (2 * sigma * sigma));
                    sum += v[k] * v[k];
                }
        for (int32_t k = 0; k < p->dim; k++)
            p->direction[(size_t)k * p->directions + d] = (float)(v[k] / sqrt(sum));
    }
}

/* Plane and corner of patch i of a set. The level has a rectangle for each quarter. */
static const tz_quality_planes *draw_patch(const patch_level *p, int32_t set, int32_t i,
                                           int32_t *x, int32_t *y)
{
    const tz_quality_picture *pic = set < 4 ? p->w->exemplar : p->w->output;
    tz_rng r = tz_rng_make(
        p->w->params->seed,
        tz_rng_stream('p', (uint64_t)p->level * SETS + (uint64_t)set, (uint64_t)i));
    const tz_quality_planes *f = &pic->at[i % pic->n].laplace[p->level];
    int32_t x0 = 0, y0 = 0, w = f->w, h = f->h;
    if (set < 4) {
        x0 = set & 1 ? f->w / 2 : 0;
        y0 = set & 2 ? f->h / 2 : 0;
        w = f->w / 2;
        h = f->h / 2;
    }
    *x = x0 + tz_rng_below(&r, w - PATCH + 1);
    *y = y0 + tz_rng_below(&r, h - PATCH + 1);
    return f;
}

static tz_status project(tz_ctx *ctx, void *arg, int64_t item, int worker)
{
    patch_level *p = arg;
    int32_t set = item < 4 * p->n ? (int32_t)(item / p->n) : 4;
    int32_t i = (int32_t)(item - (int64_t)set * p->n), x, y;
    const tz_quality_planes *f = draw_patch(p, set, i, &x, &y);
    float v[DIM_MAX] = {0};
    (void)ctx, (void)worker;
    for (int32_t c = 0, k = 0; c < f->n; c++)
        for (int32_t r = 0; r < PATCH; r++, k += PATCH)
            memcpy(v + k, f->v[c] + (size_t)(y + r) * f->w + x, PATCH * sizeof *v);
    for (int32_t d = 0; d < p->directions; d += BLOCK) {
        float sum[BLOCK] = {0};
        int32_t m = p->directions - d < BLOCK ? p->directions - d : BLOCK;
        const float *u = p->direction + d;
        if (m == BLOCK)
            for (int32_t k = 0; k < p->dim; k++, u += p->directions)
                for (int32_t e = 0; e < BLOCK; e++)
                    sum[e] += v[k] * u[e];
        else
            for (int32_t k = 0; k < p->dim; k++, u += p->directions)
                for (int32_t e = 0; e < m; e++)
                    sum[e] += v[k] * u[e];
        for (int32_t e = 0; e < m; e++)
            p->value[(size_t)(d + e) * 6 * p->n + item] = sum[e];
    }
    return TZ_OK;
}

#define PROJECT_CHUNK 256
static tz_status project_chunk(tz_ctx *ctx, void *arg, int64_t chunk, int worker)
{
    patch_level *p = arg;
    int64_t end = (chunk + 1) * PROJECT_CHUNK, n = 6 * (int64_t)p->n;
    tz_status s = TZ_OK;
    for (int64_t i = chunk * PROJECT_CHUNK; i < (end < n ? end : n) && s == TZ_OK; i++)
        s = project(ctx, arg, i, worker);
    return s;
}

/* ---- one direction -------------------------------------------------------------- */

/* Sorts floats by their bits, 11 at a time: order-preserving keys in two buffers. */
static void sort_floats(float *v, int32_t n, uint32_t *a, uint32_t *b)
{
    uint32_t count[3][2048] = {{0}};
    for (int32_t i = 0; i < n; i++) {
        uint32_t u;
        memcpy(&u, &v[i], sizeof u);
        u ^= u >> 31 ? 0xffffffffu : 0x80000000u;
        a[i] = u;
        count[0][u & 2047]++, count[1][u >> 11 & 2047]++, count[2][u >> 22]++;
    }
    for (int pass = 0; pass < 3; pass++) {
        uint32_t at = 0, *c = count[pass];
        for (int k = 0; k < 2048; k++) {
            uint32_t m = c[k];
            c[k] = at;
            at += m;
        }
        for (int32_t i = 0; i < n; i++)
            b[c[a[i] >> (11 * pass) & 2047]++] = a[i];
        uint32_t *t = a;
        a = b, b = t;
    }
    for (int32_t i = 0; i < n; i++) {
        uint32_t u = a[i] ^ (a[i] >> 31 ? 0x80000000u : 0xffffffffu);
        memcpy(&v[i], &u, sizeof u);
    }
}

static double mean_gap(const float *a, const float *b, int32_t n)
{
    double sum = 0;
    for (int32_t i = 0; i < n; i++)
        sum += fabs((double)a[i] - b[i]);
    return sum / n;
}

static tz_status slice(tz_ctx *ctx, void *arg, int64_t d, int worker)
{
    static const int8_t halves[3][4] = {{0, 2, 1, 3}, {0, 1, 2, 3}, {0, 3, 1, 2}};
    patch_level *p = arg;
    int32_t n = p->n, m = 2 * n;
    float *v = p->value + (size_t)d * 6 * n, *a, *b;
    uint32_t *key;
    (void)worker;
    tz_status s = tz_alloc(ctx, &key, (size_t)m * 4, sizeof *key);
    if (s != TZ_OK)
        return s;
    a = (float *)(key + 2 * m), b = a + m;
    double within = 0;
    for (int h = 0; h < 3; h++) {
        for (int k = 0; k < 2; k++) {
            memcpy(a + k * n, v + halves[h][k] * n, (size_t)n * sizeof *a);
            memcpy(b + k * n, v + halves[h][k + 2] * n, (size_t)n * sizeof *b);
        }
        sort_floats(a, m, key, key + m);
        sort_floats(b, m, key, key + m);
        within += mean_gap(a, b, m) / 3;
    }
    for (int32_t i = 0; i < m; i++)
        a[i] = v[2 * i];
    sort_floats(a, m, key, key + m);
    memcpy(b, v + 4 * n, (size_t)m * sizeof *b);
    sort_floats(b, m, key, key + m);
    p->distance[2 * d] = mean_gap(a, b, m);
    p->distance[2 * d + 1] = within;
    double spread = 0;
    for (int32_t i = 0; i < m; i++)
        spread += fabs((double)a[i] - a[n]);
    p->spread[d] = spread / m;
    tz_free(ctx, key);
    return TZ_OK;
}

/* ---- levels --------------------------------------------------------------------- */

static tz_status measure_level(tz_ctx *ctx, const tz_quality_work *w, int32_t level,
                               double *ratio)
{
    tz_status s = TZ_OK;
    patch_level p = {.w = w, .level = level, .directions = w->params->projections};
    p.dim = PATCH * PATCH * w->exemplar->at[0].gauss[0].n;
    p.n = (w->params->patches + 1) / 2;
    size_t d = (size_t)p.directions;
    if ((s = tz_alloc(ctx, &p.direction, d * (size_t)p.dim, sizeof(float))) != TZ_OK ||
        (s = tz_alloc(ctx, &p.value, d * 6 * (size_t)p.n, sizeof(float))) != TZ_OK ||
        (s = tz_alloc(ctx, &p.distance, d * 2, sizeof(double))) != TZ_OK ||
        (s = tz_alloc(ctx, &p.spread, d, sizeof(double))) != TZ_OK)
        goto done;
    draw_directions(&p, w->params->seed);
    int64_t chunks = (6 * (int64_t)p.n + PROJECT_CHUNK - 1) / PROJECT_CHUNK;
    if ((s = tz_parallel_for(ctx, chunks, project_chunk, &p)) != TZ_OK ||
        (s = tz_parallel_for(ctx, p.directions, slice, &p)) != TZ_OK)
        goto done;
    double out = 0, within = 0, spread = 0;
    for (size_t i = 0; i < d; i++) {
        out += p.distance[2 * i] / (double)d;
        within += p.distance[2 * i + 1] / (double)d;
        spread += p.spread[i] / (double)d;
    }
    *ratio = tz_quality_ratio(out, within, 0.02 * spread + 0.02);
done:
    tz_free(ctx, p.direction);
    tz_free(ctx, p.value);
    tz_free(ctx, p.distance);
    tz_free(ctx, p.spread);
    return s;
}

static bool level_exists(const tz_quality_picture *p, int32_t level)
{
    for (int32_t i = 0; i < p->n; i++) {
        const tz_quality_planes *f = &p->at[i].laplace[level];
        if (f->w < MIN_SIDE || f->h < MIN_SIDE)
            return false;
    }
    return true;
}

tz_status tz_quality_patch(tz_ctx *ctx, const tz_quality_work *w, tz_quality *q)
{
    tz_status s = TZ_OK;
    double sum = 0;
    int32_t n = 0;
    for (int32_t i = 0; i < TZ_QUALITY_LEVELS; i++) {
        q->patch_level[i] = NAN;
        if (s != TZ_OK || !level_exists(w->exemplar, i) || !level_exists(w->output, i))
            continue;
        s = measure_level(ctx, w, i, &q->patch_level[i]);
        sum += q->patch_level[i];
        n++;
    }
    q->patch = n ? sum / n : 1;
    return s;
}
