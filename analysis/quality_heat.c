/* SPDX-License-Identifier: Apache-2.0 */
/* Heat map: where the output is worse than the exemplar.
 *
 * heat = max(p, s, 0.75 r) with s = 1 on seams (quality_seam.c), r = 1 on patches that
 * occur again (quality_repeat.c), and p the local strangeness: the output is cut in cells
 * of CELL px, each described by the mean colour and the log energies of the three finest
 * Laplacian levels; p grows from 0 where the nearest cell of the exemplar is as near as
 * the median cell of one half of the exemplar is to the other half, to 1 at FULL times
 * that distance. Linear in between, bilinear from cell to cell. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/quality_measures.h"

#define CELL          16
#define DIM           6
#define FULL          6.0
#define MOST          4096 /* cells of the exemplar compared with */
#define WEIGHT_REPEAT 0.75f

typedef struct cells {
    int32_t w, h;
    float (*v)[DIM];
} cells;

static void describe(const tz_quality_pyramid *p, int32_t cx, int32_t cy, float v[DIM])
{
    memset(v, 0, DIM * sizeof *v);
    for (int32_t c = 0; c < p->gauss[0].n; c++) {
        double sum = 0;
        for (int32_t y = cy * CELL; y < (cy + 1) * CELL; y++)
            for (int32_t x = cx * CELL; x < (cx + 1) * CELL; x++)
                sum += (double)p->gauss[0].v[c][(size_t)y * p->gauss[0].w + x];
        v[c] = (float)(sum / (CELL * CELL)) * 0.5f;
    }
    for (int32_t k = 0; k < 3 && p->laplace[k].w; k++) {
        const tz_quality_planes *f = &p->laplace[k];
        int32_t side = CELL >> k;
        double sum = 0.02;
        for (int32_t y = cy * side; y < (cy + 1) * side && y < f->h; y++)
            for (int32_t x = cx * side; x < (cx + 1) * side && x < f->w; x++)
                sum += (double)f->v[0][(size_t)y * f->w + x] *
                       (double)f->v[0][(size_t)y * f->w + x] / (side * side);
        v[3 + k] = (float)(3 * log(sum));
    }
}

static tz_status cells_init(tz_ctx *ctx, const tz_quality_pyramid *p, cells *c)
{
    *c = (cells){.w = p->gauss[0].w / CELL, .h = p->gauss[0].h / CELL};
    tz_status s = tz_alloc(ctx, &c->v, (size_t)c->w * c->h, sizeof *c->v);
    for (int32_t y = 0; y < c->h && s == TZ_OK; y++)
        for (int32_t x = 0; x < c->w; x++)
            describe(p, x, y, c->v[(size_t)y * c->w + x]);
    return s;
}

typedef struct near_job {
    const float (*query)[DIM];
    const float (*point)[DIM];
    int32_t n;
    float *distance; /* squared */
} near_job;

static tz_status nearest(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    const near_job *j = arg;
    const float *q = j->query[i];
    float best = INFINITY;
    (void)ctx, (void)worker;
    for (int32_t k = 0; k < j->n; k++) {
        float d = 0;
        for (int e = 0; e < DIM; e++)
            d += (q[e] - j->point[k][e]) * (q[e] - j->point[k][e]);
        best = d < best ? d : best;
    }
    j->distance[i] = best;
    return TZ_OK;
}

static int by_value(const void *a, const void *b)
{
    float p = *(const float *)a, q = *(const float *)b;
    return p < q ? -1 : p > q;
}

/* Median distance of the cells of the exemplar's second half (of the list: the lower half
 * of the picture) to the nearest of the first. */
static tz_status yardstick(tz_ctx *ctx, const float (*v)[DIM], int32_t n, float *median)
{
    float *d;
    int32_t m = n / 2;
    *median = 1;
    tz_status s = tz_alloc(ctx, &d, (size_t)(n - m), sizeof *d);
    near_job j = {.query = v + m, .point = v, .n = m, .distance = d};
    if (s == TZ_OK && m > 0)
        s = tz_parallel_for(ctx, n - m, nearest, &j);
    if (s == TZ_OK && m > 0) {
        qsort(d, (size_t)(n - m), sizeof *d, by_value);
        *median = sqrtf(d[(n - m) / 2]);
    }
    tz_free(ctx, d);
    return s;
}

static void draw(const tz_quality_work *w, const cells *o, const float *p, tz_image *map)
{
    for (int32_t y = 0; y < map->height; y++)
        for (int32_t x = 0; x < map->width; x++) {
            float fx = (x + 0.5f) / CELL - 0.5f, fy = (y + 0.5f) / CELL - 0.5f;
            int32_t x0 = (int32_t)floorf(fx), y0 = (int32_t)floorf(fy);
            fx -= (float)x0, fy -= (float)y0;
            int32_t xa = tz_quality_clamp(x0, o->w), xb = tz_quality_clamp(x0 + 1, o->w);
            int32_t ya = tz_quality_clamp(y0, o->h), yb = tz_quality_clamp(y0 + 1, o->h);
            float v = (1 - fy) * ((1 - fx) * p[ya * o->w + xa] + fx * p[ya * o->w + xb]) +
                      fy * ((1 - fx) * p[yb * o->w + xa] + fx * p[yb * o->w + xb]);
            float s = w->heat_seam[(size_t)y * map->width + x];
            float r = WEIGHT_REPEAT * w->heat_repeat[(size_t)y * map->width + x];
            v = v > s ? v : s;
            *tz_image_at(map, x, y) = v > r ? v : r;
        }
}

tz_status tz_quality_heat(tz_ctx *ctx, const tz_quality_work *w, tz_image *map)
{
    cells e = {0}, o = {0};
    float *d = NULL, median;
    tz_image out = {0};
    tz_status s;
    if ((s = cells_init(ctx, &w->exemplar->at[0], &e)) != TZ_OK ||
        (s = cells_init(ctx, &w->output->at[0], &o)) != TZ_OK ||
        (s = tz_alloc(ctx, &d, (size_t)o.w * o.h, sizeof *d)) != TZ_OK ||
        (s = tz_image_init(ctx, &out, w->output->crop[0].w, w->output->crop[0].h, 1)) !=
            TZ_OK)
        goto done;
    out.encoding = TZ_ENCODING_DATA;
    int32_t all = e.w * e.h, n = all < MOST ? all : MOST;
    for (int32_t i = 0; i < n; i++) /* thinned evenly, in place: source is never before */
        memmove(e.v[i], e.v[(int64_t)i * all / n], sizeof *e.v);
    near_job j = {.query = (const float(*)[DIM])o.v,
                  .point = (const float(*)[DIM])e.v,
                  .n = n,
                  .distance = d};
    if ((s = yardstick(ctx, j.point, n, &median)) != TZ_OK ||
        (s = tz_parallel_for(ctx, (int64_t)o.w * o.h, nearest, &j)) != TZ_OK)
        goto done;
    for (int32_t i = 0; i < o.w * o.h; i++) {
        float p = (float)((sqrtf(d[i]) / (median + 0.1f) - 1) / (FULL - 1));
        d[i] = p < 0 ? 0 : p > 1 ? 1 : p;
    }
    draw(w, &o, d, &out);
    *map = out;
    out = (tz_image){0};
done:
    tz_image_deinit(&out);
    tz_free(ctx, e.v);
    tz_free(ctx, o.v);
    tz_free(ctx, d);
    return s;
}
