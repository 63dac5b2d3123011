/* SPDX-License-Identifier: Apache-2.0 */
/* Strength along the line. Grain answers in short pieces that point anywhere, a line for
 * a long way in one direction:
 *
 *     out(p) = sum_t g(t) r(p + t u) max(0, cos 2 (a(p + t u) - a(p))),  u along the line
 *
 * with Gaussian weights g of deviation 5 px that add up to 1; a straight line keeps its
 * strength, grain loses about half. Elongated second derivatives (Freeman, Adelson 1991)
 * do the same in one step, at many times the cost. */
#include <math.h>
#include <string.h>

#include "analysis/lines_field.h"

#define REACH  10
#define SIGMA  5.0
#define ONE    4096 /* parts of a px that a step is counted in */
#define MARGIN 16   /* at least REACH: what is divided stays positive */

typedef struct job {
    tz_line_field *f;
    const float *old;
    float weight[2 * REACH + 1];
} job;

static float along(const job *j, int32_t x, int32_t y)
{
    const tz_edge_map *m = &j->f->map;
    const ptrdiff_t n = (ptrdiff_t)m->width * m->height, p = (ptrdiff_t)y * m->width + x;
    const float c = m->normal[p], s = m->normal[p + n];
    const float ux = -sqrtf(fmaxf(0, 0.5F * (1 - c))) * (s < 0 ? -1.0F : 1.0F),
                uy = sqrtf(fmaxf(0, 0.5F * (1 + c)));
    const int32_t du = (int32_t)(ux * ONE), dv = (int32_t)(uy * ONE);
    float sum = 0;
    for (int t = -REACH; t <= REACH; t++) {
        const int32_t u = x + (MARGIN * ONE + ONE / 2 + t * du) / ONE - MARGIN,
                      v = y + (MARGIN * ONE + ONE / 2 + t * dv) / ONE - MARGIN;
        if (u < 0 || v < 0 || u >= m->width || v >= m->height)
            continue;
        const ptrdiff_t q = (ptrdiff_t)v * m->width + u;
        const float agree = c * m->normal[q] + s * m->normal[q + n];
        if (agree > 0)
            sum += j->weight[t + REACH] * agree * j->old[q];
    }
    return sum;
}

static tz_status row(tz_ctx *ctx, void *arg, int64_t y, int worker)
{
    const job *j = arg;
    const tz_edge_map *m = &j->f->map;
    (void)ctx, (void)worker;
    for (int32_t x = 0; x < m->width; x++) {
        const ptrdiff_t p = (ptrdiff_t)y * m->width + x;
        if (j->old[p] > 1)
            m->response[p] = along(j, x, (int32_t)y);
    }
    return TZ_OK;
}

tz_status tz_line_along(tz_ctx *ctx, tz_line_field *f)
{
    job j = {.f = f};
    const size_t n = (size_t)f->map.width * (size_t)f->map.height;
    float *old = NULL;
    double sum = 0;
    tz_status s = tz_alloc(ctx, &old, n, sizeof *old);
    if (s != TZ_OK)
        return s;
    memcpy(old, f->map.response, n * sizeof *old);
    j.old = old;
    for (int t = -REACH; t <= REACH; t++)
        sum += exp(-0.5 * t * t / (SIGMA * SIGMA));
    for (int t = -REACH; t <= REACH; t++)
        j.weight[t + REACH] = (float)(exp(-0.5 * t * t / (SIGMA * SIGMA)) / sum);
    s = tz_parallel_for(ctx, f->map.height, row, &j);
    tz_free(ctx, old);
    return s;
}
