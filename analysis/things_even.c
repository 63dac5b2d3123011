/* SPDX-License-Identifier: Apache-2.0 */
/* Means of cells, blurred by a binomial of 3 x 3, with the median of all cells mixed in
 * where little of a cell is known; between cells bilinear. A mean that lies FROM away
 * from the median begins to be moved there, from TO on it is by MOST of the way. */
#include "analysis/things_even.h"

#include <math.h>
#include <stdlib.h>

enum { C = TZ_THINGS_EVEN_CHANNELS, BLURS = 2 };

#define FROM  0.005
#define TO    0.02
#define MOST  0.92
#define PRIOR 0.01 /* of a cell's area */

typedef struct grid {
    int32_t w, h, cell;
    double *v; /* w * h * (C + 1): sums and count, then means and 1 */
} grid;

static int by_value(const void *p, const void *q)
{
    const double a = *(const double *)p, b = *(const double *)q;
    return (a > b) - (a < b);
}

/* Medians of the means of cells. @param s  scratch, w * h */
static void find_middle(const grid *g, double *s, double middle[C])
{
    for (int c = 0; c < C; c++) {
        int32_t n = 0;
        for (int32_t i = 0; i < g->w * g->h; i++)
            if (g->v[i * (C + 1) + C] > 0)
                s[n++] = g->v[i * (C + 1) + c] / g->v[i * (C + 1) + C];
        if (n > 0)
            qsort(s, (size_t)n, sizeof *s, by_value);
        middle[c] = n > 0 ? s[n / 2] : 0;
    }
}

/* Along x (step 1) or y (step w), the ends doubled. */
static void blur_lines(grid *g, int32_t lines, int32_t line, int32_t n, int32_t step)
{
    for (int32_t k = 0; k < lines; k++)
        for (int c = 0; c <= C; c++) {
            double *v = g->v + (ptrdiff_t)k * line * (C + 1) + c, before = v[0];
            for (int32_t i = 0; i < n; i++) {
                double *p = v + (ptrdiff_t)i * step * (C + 1), own = *p;
                const double after = i + 1 < n ? p[(ptrdiff_t)step * (C + 1)] : own;
                *p = 0.25 * before + 0.5 * own + 0.25 * after;
                before = own;
            }
        }
}

static void settle(grid *g, const double middle[C])
{
    const double prior = PRIOR * g->cell * g->cell;
    for (int i = 0; i < BLURS; i++) {
        blur_lines(g, g->h, g->w, g->w, 1);
        blur_lines(g, g->w, 1, g->h, g->w);
    }
    for (int32_t i = 0; i < g->w * g->h; i++) {
        double *p = g->v + (ptrdiff_t)i * (C + 1);
        for (int c = 0; c < C; c++) {
            const double far = (p[c] + prior * middle[c]) / (p[C] + prior) - middle[c];
            const double t = fmax(0, fmin(1, (fabs(far) - FROM) / (TO - FROM)));
            p[c] = -MOST * far * t * t * (3 - 2 * t); /* what to add */
        }
    }
}

static void add(const grid *g, float *v, const uint8_t *known, int32_t w, int32_t h)
{
    for (int32_t y = 0; y < h; y++)
        for (int32_t x = 0; x < w; x++) {
            const ptrdiff_t p = (ptrdiff_t)y * w + x;
            if (!known[p])
                continue;
            const double cx = fmax(0, fmin(g->w - 1, (x + 0.5) / g->cell - 0.5)),
                         cy = fmax(0, fmin(g->h - 1, (y + 0.5) / g->cell - 0.5));
            const int32_t ix = (int32_t)cx < g->w - 1 ? (int32_t)cx
                                                      : (int32_t)cx - (cx > 0),
                          iy = (int32_t)cy < g->h - 1 ? (int32_t)cy
                                                      : (int32_t)cy - (cy > 0);
            const double fx = cx - ix, fy = cy - iy;
            const int32_t right = g->w > 1 ? C + 1 : 0,
                          down = g->h > 1 ? g->w * (C + 1) : 0;
            const double *a = g->v + ((ptrdiff_t)iy * g->w + ix) * (C + 1);
            for (int c = 0; c < C; c++) {
                const double d = (1 - fy) * ((1 - fx) * a[c] + fx * a[c + right]) +
                                 fy * ((1 - fx) * a[c + down] + fx * a[c + down + right]);
                if (d < 0 || d > 0)
                    v[p * C + c] = fmaxf(0, v[p * C + c] + (float)d);
            }
        }
}

tz_status tz_things_even(tz_ctx *ctx, float *v, const uint8_t *known, int32_t width,
                         int32_t height, int32_t cell)
{
    grid g = {(width + cell - 1) / cell, (height + cell - 1) / cell, cell, NULL};
    double *scratch = NULL, middle[C];
    const size_t n = (size_t)g.w * (size_t)g.h;
    tz_status s = tz_alloc_zero(ctx, &g.v, n * (C + 1), sizeof *g.v);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &scratch, n, sizeof *scratch);
    if (s == TZ_OK) {
        for (int32_t y = 0; y < height; y++)
            for (int32_t x = 0; x < width; x++) {
                const ptrdiff_t p = (ptrdiff_t)y * width + x;
                double *to = g.v + ((ptrdiff_t)(y / cell) * g.w + x / cell) * (C + 1);
                for (int c = 0; c < C && known[p]; c++)
                    to[c] += v[p * C + c];
                to[C] += known[p] != 0;
            }
        find_middle(&g, scratch, middle);
        settle(&g, middle);
        add(&g, v, known, width, height);
    }
    tz_free(ctx, g.v);
    tz_free(ctx, scratch);
    return s;
}
