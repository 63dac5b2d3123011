/* SPDX-License-Identifier: Apache-2.0 */
/* Andrew's monotone chain on integer points. Of a label only the first and last pixel of
 * each row can lie on its hull. */
#include "analysis/things_hull.h"

#include <stdlib.h>

static int by_x(const void *p, const void *q)
{
    const tz_hull_point *a = p, *b = q;
    return a->x != b->x ? (a->x > b->x) - (a->x < b->x) : (a->y > b->y) - (a->y < b->y);
}

static int64_t turn(tz_hull_point o, tz_hull_point a, tz_hull_point b)
{
    return (int64_t)(a.x - o.x) * (b.y - o.y) - (int64_t)(a.y - o.y) * (b.x - o.x);
}

/* Hull of n points, which are sorted in place, appended to the pool as hull k. */
static tz_status add_hull(tz_ctx *ctx, tz_hulls *h, tz_hull_point *p, int32_t n,
                          int32_t k)
{
    const int32_t start = h->point.n;
    const tz_status s = tz_array_reserve(ctx, &h->point, (int64_t)start + 2 * n + 2);
    if (s != TZ_OK)
        return s;
    qsort(p, (size_t)n, sizeof *p, by_x);
    tz_hull_point *v = h->point.v + start;
    int32_t m = 0;
    for (int32_t i = 0; i < n; i++) {
        while (m >= 2 && turn(v[m - 2], v[m - 1], p[i]) <= 0)
            m--;
        v[m++] = p[i];
    }
    const int32_t lower = m + 1;
    for (int32_t i = n - 2; i >= 0; i--) {
        while (m >= lower && turn(v[m - 2], v[m - 1], p[i]) <= 0)
            m--;
        v[m++] = p[i];
    }
    h->first[k] = start;
    h->count[k] = m > 1 ? m - 1 : m;
    h->point.n = start + h->count[k];
    return TZ_OK;
}

double tz_hulls_area(const tz_hulls *h, int32_t k)
{
    const tz_hull_point *v = h->point.v + h->first[k];
    int64_t twice = 0;
    for (int32_t i = 1; i + 1 < h->count[k]; i++)
        twice += turn(v[0], v[i], v[i + 1]);
    return 0.5 * (double)twice;
}

static tz_status reserve(tz_ctx *ctx, tz_hulls *h, int32_t n)
{
    if (n <= h->room)
        return TZ_OK;
    const tz_status s = tz_realloc(ctx, &h->sorted, 2 * (size_t)n, sizeof *h->sorted);
    if (s == TZ_OK)
        h->room = 2 * n;
    return s;
}

/* Corners of each row's first and last pixel of a label: four a run of it. Counts them
 * where `out` is NULL, else puts them at at[label] on. */
static void corners_of_runs(const int32_t *label, int32_t width, int32_t height,
                            int32_t *at, tz_hull_point *out)
{
    for (int32_t y = 0; y < height; y++) {
        const int32_t *row = label + (size_t)y * (size_t)width;
        for (int32_t x = 0, end; x < width; x = end) {
            for (end = x + 1; end < width && row[end] == row[x];)
                end++;
            if (out) {
                tz_hull_point *p = out + at[row[x]];
                p[0] = (tz_hull_point){x, y};
                p[1] = (tz_hull_point){x, y + 1};
                p[2] = (tz_hull_point){end, y};
                p[3] = (tz_hull_point){end, y + 1};
            }
            at[row[x]] += 4;
        }
    }
}

static tz_status gather(tz_ctx *ctx, tz_hulls *h, const int32_t *label, int32_t width,
                        int32_t height, int32_t labels)
{
    int32_t *at = NULL, sum = 0;
    tz_hull_point *all = NULL;
    tz_status s = tz_alloc_zero(ctx, &at, (size_t)labels, sizeof *at);
    if (s != TZ_OK)
        return s;
    corners_of_runs(label, width, height, at, NULL);
    for (int32_t k = 0; k < labels; k++) {
        const int32_t n = at[k];
        at[k] = sum;
        sum += n;
    }
    s = tz_alloc(ctx, &all, (size_t)sum, sizeof *all);
    if (s == TZ_OK)
        corners_of_runs(label, width, height, at, all);
    for (int32_t k = 0; k < labels && s == TZ_OK; k++) {
        const int32_t first = k ? at[k - 1] : 0; /* at[k] has moved to the end of k */
        s = add_hull(ctx, h, all + first, at[k] - first, k);
    }
    tz_free(ctx, at);
    tz_free(ctx, all);
    return s;
}

tz_status tz_hulls_init(tz_ctx *ctx, tz_hulls *h, const int32_t *label, int32_t width,
                        int32_t height, int32_t labels, double largest)
{
    *h = (tz_hulls){.largest = largest};
    tz_status s = tz_alloc_zero(ctx, &h->first, 2 * (size_t)labels, sizeof *h->first);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &h->count, 2 * (size_t)labels, sizeof *h->count);
    if (s == TZ_OK)
        s = gather(ctx, h, label, width, height, labels);
    if (s != TZ_OK)
        tz_hulls_deinit(ctx, h);
    return s;
}

void tz_hulls_deinit(tz_ctx *ctx, tz_hulls *h)
{
    tz_array_free(ctx, &h->point);
    tz_free(ctx, h->first);
    tz_free(ctx, h->count);
    tz_free(ctx, h->sorted);
    *h = (tz_hulls){0};
}

tz_status tz_hulls_join(tz_ctx *ctx, tz_hulls *h, int32_t a, int32_t b, int32_t to,
                        double area, double *hull)
{
    const int32_t na = h->count[a], nb = h->count[b];
    *hull = 0;
    h->count[to] = 0;
    if (na == 0 || nb == 0 || area > h->largest)
        return TZ_OK;
    tz_status s = reserve(ctx, h, na + nb);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < na; i++)
        h->sorted[i] = h->point.v[h->first[a] + i];
    for (int32_t i = 0; i < nb; i++)
        h->sorted[na + i] = h->point.v[h->first[b] + i];
    s = add_hull(ctx, h, h->sorted, na + nb, to);
    if (s == TZ_OK)
        *hull = tz_hulls_area(h, to);
    return s;
}
