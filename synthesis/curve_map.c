/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures of which line is nearest, how far off it is, and where along it. */
#include "synthesis/curve_near_internal.h"

typedef struct job {
    const tz_near *near;
    tz_rect rect;
    int32_t nx; /* tiles in a row */
    int32_t *id;
    float *distance, *along;
    struct map_work {
        tz_near_scratch near;
        tz_near_place *place;
    } * work;
} job;

enum { TILE = 64 };

/* Length of a cubic from 0 to t.
 * @source Gauss-Legendre, five points */
static double length_to(const tz_bezier *c, double t)
{
    static const double at[5] = {-0.9061798459386640, -0.5384693101056831, 0,
                                 0.5384693101056831, 0.9061798459386640};
    static const double weight[5] = {0.2369268850561891, 0.4786286704993665,
                                     0.5688888888888889, 0.4786286704993665,
                                     0.2369268850561891};
    double sum = 0;
    for (int k = 0; k < 5; k++)
        sum += weight[k] * tz_vec2_length(tz_bezier_slope(c, 0.5 * t * (1 + at[k])));
    return 0.5 * t * sum;
}

static tz_status map_task(tz_ctx *ctx, void *arg, int64_t index, int worker)
{
    const job *b = arg;
    struct map_work *w = &b->work[worker];
    const tz_rect whole = {b->rect.x + (int32_t)(index % b->nx) * TILE,
                           b->rect.y + (int32_t)(index / b->nx) * TILE, TILE, TILE};
    const tz_rect t = tz_rect_intersect(whole, b->rect);
    tz_status s = tz_ctx_cancelled(ctx) ? TZ_CANCELLED : TZ_OK;
    if (s == TZ_OK && !w->place)
        s = tz_alloc(ctx, &w->place, TILE * TILE, sizeof *w->place);
    if (s == TZ_OK)
        s = tz_near_grid(ctx, b->near, t.x, t.y, 1, t.w, t.h, w->place, &w->near);
    for (int32_t y = 0; y < t.h && s == TZ_OK; y++)
        for (int32_t x = 0; x < t.w; x++) {
            const tz_near_place *p = &w->place[y * t.w + x];
            const int64_t at =
                (int64_t)(t.y - b->rect.y + y) * b->rect.w + (t.x - b->rect.x + x);
            const tz_near_piece *q = p->piece < 0 ? NULL : &b->near->piece.v[p->piece];
            if (b->id)
                b->id[at] = q ? q->path : -1;
            if (b->distance)
                b->distance[at] = q ? (float)p->d : INFINITY;
            if (b->along)
                b->along[at] = q ? (float)(q->before + length_to(&q->at, p->t)) : 0;
        }
    return s;
}

tz_status tz_near_map(tz_ctx *ctx, const tz_near *near, tz_rect rect, int32_t *id,
                      float *distance, float *along)
{
    const int workers = tz_ctx_threads(ctx);
    job b = {near, rect, (rect.w + TILE - 1) / TILE, id, distance, along, NULL};
    tz_status s = tz_alloc_zero(ctx, &b.work, (size_t)workers, sizeof *b.work);
    if (s == TZ_OK)
        s = tz_parallel_for(ctx, (int64_t)b.nx * ((rect.h + TILE - 1) / TILE), map_task,
                            &b);
    for (int k = 0; k < workers && b.work; k++) {
        tz_near_scratch_deinit(ctx, &b.work[k].near);
        tz_free(ctx, b.work[k].place);
    }
    tz_free(ctx, b.work);
    return s;
}
