/* SPDX-License-Identifier: Apache-2.0 */
/* Watershed from a grid of seeds on the response plus a penalty that rises with the
 * distance from the seed: where there is nothing to see the superpixels are cells of the
 * grid, else they end on edges. Pixels wait in FIFO buckets by level; a pixel joins the
 * region that reached it first, through a 4-neighbour, so that regions are connected by
 * construction. */
#include "analysis/superpixel.h"

#include <math.h>

#define LEVELS  1024
#define COMPACT 0.12 /* a distance of one step weighs as this share of a full border */

typedef struct flood {
    const float *response;
    int32_t width, height, *label;
    int64_t *next, head[LEVELS], tail[LEVELS];
    float *seed_x, *seed_y;
    float scale, compact;
} flood;

static void push(flood *f, int64_t p, int32_t label, int32_t level)
{
    f->label[p] = label;
    f->next[p] = -1;
    if (f->tail[level] >= 0)
        f->next[f->tail[level]] = p;
    else
        f->head[level] = p;
    f->tail[level] = p;
}

static int32_t level_of(const flood *f, int64_t p, int32_t x, int32_t y, int32_t k)
{
    const float dx = (float)x - f->seed_x[k], dy = (float)y - f->seed_y[k];
    const float cost = f->response[p] * f->scale + f->compact * sqrtf(dx * dx + dy * dy);
    return cost < LEVELS - 1 ? (int32_t)cost : LEVELS - 1;
}

static void reach(flood *f, int64_t p, int32_t x, int32_t y, int32_t label, int32_t level)
{
    if (f->label[p] >= 0)
        return;
    const int32_t own = level_of(f, p, x, y, label);
    push(f, p, label, own > level ? own : level);
}

/* Lowest response in the middle half of a grid cell. */
static int64_t place_seed(const flood *f, int32_t i, int32_t j, int32_t nx, int32_t ny)
{
    const double cw = (double)f->width / nx, ch = (double)f->height / ny;
    int32_t x0 = (int32_t)((i + 0.25) * cw), x1 = (int32_t)((i + 0.75) * cw);
    int32_t y0 = (int32_t)((j + 0.25) * ch), y1 = (int32_t)((j + 0.75) * ch);
    if (x0 < (int32_t)ceil(i * cw))
        x0 = (int32_t)ceil(i * cw);
    if (y0 < (int32_t)ceil(j * ch))
        y0 = (int32_t)ceil(j * ch);
    /* from the middle outwards would be as good; the middle wins ties */
    int32_t bx = (x0 + x1) / 2, by = (y0 + y1) / 2;
    if (bx >= f->width)
        bx = f->width - 1;
    if (by >= f->height)
        by = f->height - 1;
    float best = f->response[(int64_t)by * f->width + bx];
    for (int32_t y = y0; y < y1; y++) {
        for (int32_t x = x0; x < x1; x++) {
            const float r = f->response[(int64_t)y * f->width + x];
            if (r < best)
                best = r, bx = x, by = y;
        }
    }
    return (int64_t)by * f->width + bx;
}

static void run(flood *f)
{
    const int32_t w = f->width, h = f->height;
    for (int32_t level = 0; level < LEVELS; level++) {
        while (f->head[level] >= 0) {
            const int64_t p = f->head[level];
            f->head[level] = f->next[p];
            if (f->head[level] < 0)
                f->tail[level] = -1;
            const int32_t x = (int32_t)(p % w), y = (int32_t)(p / w), k = f->label[p];
            if (x > 0)
                reach(f, p - 1, x - 1, y, k, level);
            if (x < w - 1)
                reach(f, p + 1, x + 1, y, k, level);
            if (y > 0)
                reach(f, p - w, x, y - 1, k, level);
            if (y < h - 1)
                reach(f, p + w, x, y + 1, k, level);
        }
    }
}

tz_status tz_superpixels(tz_ctx *ctx, const float *response, int32_t width,
                         int32_t height, double full, double step, int32_t *label,
                         int32_t *count)
{
    const int64_t n = (int64_t)width * height;
    const int32_t nx = (int32_t)fmax(1, floor(width / step + 0.5));
    const int32_t ny = (int32_t)fmax(1, floor(height / step + 0.5));
    flood f = {.response = response, .width = width, .height = height, .label = label};
    tz_status s;

    f.scale = full > 0 ? (float)(0.5 * LEVELS / full) : 0;
    f.compact = (float)(0.5 * LEVELS * COMPACT / step);
    if ((s = tz_alloc(ctx, &f.next, (size_t)n, sizeof *f.next)) != TZ_OK)
        goto done;
    if ((s = tz_alloc(ctx, &f.seed_x, (size_t)nx * ny, sizeof(float))) != TZ_OK)
        goto done;
    if ((s = tz_alloc(ctx, &f.seed_y, (size_t)nx * ny, sizeof(float))) != TZ_OK)
        goto done;
    for (int32_t i = 0; i < LEVELS; i++)
        f.head[i] = f.tail[i] = -1;
    for (int64_t p = 0; p < n; p++)
        label[p] = -1;
    *count = 0;
    for (int32_t j = 0; j < ny; j++) {
        for (int32_t i = 0; i < nx; i++) {
            const int64_t p = place_seed(&f, i, j, nx, ny);
            if (label[p] >= 0)
                continue;
            f.seed_x[*count] = (float)(p % width);
            f.seed_y[*count] = (float)(p / width);
            push(&f, p, *count, 0);
            ++*count;
        }
    }
    run(&f);
    if (tz_ctx_cancelled(ctx))
        s = TZ_CANCELLED;
done:
    tz_free(ctx, f.next);
    tz_free(ctx, f.seed_x);
    tz_free(ctx, f.seed_y);
    return s;
}
