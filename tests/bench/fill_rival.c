/* SPDX-License-Identifier: Apache-2.0 */
/* One unknown vector a cell that is inside and not under a stroke:
 *
 *   min  sum over neighbouring cells |u - u'|^2,   u = what is said under strokes
 *
 * The field's own cells, so that what strokes say is not lost in a coarser grid. */
#include "tests/bench/fill_rival.h"

#include <math.h>

#include "base/lsq.h"

static bool said(const tz_element_field_cell *c) { return c->x != 0 || c->y != 0; }

/* Indices of unknowns, -1 = known, -2 = outside; two cells more than inside, for things
 * that stand over the border. */
static int32_t number(const tz_element_field *f, const tz_region *region, int32_t *index)
{
    const tz_raster *r = &f->raster;
    const double cell = r->size.x / r->width;
    int32_t unknowns = 0;
    for (int32_t i = 0; i < r->width * r->height; i++) {
        const tz_vec3 at = {(i % r->width + 0.5) * cell, (i / r->width + 0.5) * cell, 0};
        const bool in = !region || tz_region_distance(region, at) > -2 * cell;
        index[i] = !in ? -2 : said(&f->cell[i]) ? -1 : unknowns++;
    }
    return unknowns;
}

static void tie(tz_ctx *ctx, tz_lsq *l, const tz_element_field *f, const int32_t *index,
                int32_t i, int32_t j)
{
    static const double both[2] = {1, -1}, none[2] = {0, 0};
    if (index[i] < -1 || index[j] < -1 || (index[i] < 0 && index[j] < 0))
        return;
    const int32_t pair[2] = {index[i], index[j]};
    if (index[i] >= 0 && index[j] >= 0) {
        bench_check(ctx, tz_lsq_add(l, 2, pair, both, none, 1));
        return;
    }
    const tz_element_field_cell *c = &f->cell[index[i] < 0 ? i : j];
    const double to[2] = {(double)c->x, (double)c->y};
    bench_check(ctx, tz_lsq_add(l, 1, &pair[index[i] < 0], both, to, 1));
}

static void set(tz_element_field_cell *c, double x, double y, double weight)
{
    const double l = hypot(x, y);
    *c = (tz_element_field_cell){.density = -1};
    if (!(l > 0))
        return;
    c->x = (float)(x / l), c->y = (float)(y / l);
    c->weight[0] = (float)weight;
}

void fill_rival(tz_ctx *ctx, const tz_element_field *strokes, const tz_region *region,
                double weight, tz_element_field *full)
{
    const tz_raster *r = &strokes->raster;
    const int32_t n = r->width * r->height;
    int32_t *index = NULL;
    double *u = NULL;
    tz_lsq *l = NULL;
    bench_check(ctx, tz_alloc(ctx, &index, (size_t)n, sizeof *index));
    const int32_t unknowns = number(strokes, region, index);
    bench_check(ctx, tz_alloc(ctx, &u, 2 * (size_t)unknowns, sizeof *u));
    bench_check(ctx, tz_lsq_new(ctx, unknowns, 2, &l));
    for (int32_t i = 0; i < n; i++) {
        if (i % r->width + 1 < r->width)
            tie(ctx, l, strokes, index, i, i + 1);
        if (i + r->width < n)
            tie(ctx, l, strokes, index, i, i + r->width);
    }
    bench_check(ctx, tz_lsq_solve(l, u));
    bench_check(ctx, tz_element_field_init(ctx, r->size, false, r->width, full));
    bench_check(ctx, tz_alloc_zero(ctx, &full->image, (size_t)n, sizeof *full->image));
    for (int32_t i = 0; i < n; i++) {
        const tz_element_field_cell *c = &strokes->cell[i];
        if (index[i] >= 0)
            set(&full->image[i], u[index[i]], u[unknowns + index[i]], weight);
        else if (index[i] == -1)
            set(&full->image[i], (double)c->x, (double)c->y, weight);
        else
            set(&full->image[i], 0, 0, weight);
    }
    bench_check(ctx, tz_element_field_settle(full));
    tz_lsq_free(l);
    tz_free(ctx, u);
    tz_free(ctx, index);
}
