/* SPDX-License-Identifier: Apache-2.0 */
/* Uniform grid: each cell heads a linked list of point ids. */
#include "base/grid.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

enum { REMOVED = -2, MAX_CELLS = 1 << 24 };

tz_status tz_grid_init(tz_ctx *ctx, tz_grid *g, tz_vec2 origin, tz_vec2 size, double cell,
                       bool wrap)
{
    memset(g, 0, sizeof *g);
    if (!(cell > 0) || !(size.x > 0) || !(size.y > 0) || !isfinite(cell) ||
        !isfinite(size.x) || !isfinite(size.y) || !isfinite(origin.x) ||
        !isfinite(origin.y))
        return tz_fail(ctx, TZ_INVALID, "grid of %g x %g with cells of %g", size.x,
                       size.y, cell);
    /* rounded down: cells are never smaller than asked, so a query of radius `cell` sees
     * at most 3 x 3 of them */
    double nx = fmax(1, floor(size.x / cell)), ny = fmax(1, floor(size.y / cell));
    while (nx * ny > MAX_CELLS) {
        cell *= 1.5;
        nx = fmax(1, floor(size.x / cell));
        ny = fmax(1, floor(size.y / cell));
    }
    tz_grid t = {.origin = origin,
                 .size = size,
                 .cell = cell,
                 .nx = (int32_t)nx,
                 .ny = (int32_t)ny,
                 .wrap = wrap};
    size_t cells = (size_t)t.nx * (size_t)t.ny;
    tz_status s = tz_alloc(ctx, &t.head, cells, sizeof *t.head);
    if (s != TZ_OK)
        return s;
    memset(t.head, 0xff, cells * sizeof *t.head);
    *g = t;
    return TZ_OK;
}

void tz_grid_deinit(tz_ctx *ctx, tz_grid *g)
{
    tz_free(ctx, g->head);
    tz_array_free(ctx, &g->next);
    tz_array_free(ctx, &g->point);
    memset(g, 0, sizeof *g);
}

/* Index of the cell along one axis before wrapping or clamping. */
static double cell_at(double p, double origin, double size, int32_t n)
{
    return floor((p - origin) / size * n);
}

static int32_t fold(double c, int32_t n, bool wrap)
{
    if (wrap) {
        double r = c - floor(c / n) * n;
        return r < 0 || r >= n ? 0 : (int32_t)r;
    }
    return c < 0 ? 0 : c >= n ? n - 1 : (int32_t)c;
}

static int32_t *cell_of(const tz_grid *g, tz_vec2 p)
{
    int32_t x = fold(cell_at(p.x, g->origin.x, g->size.x, g->nx), g->nx, g->wrap);
    int32_t y = fold(cell_at(p.y, g->origin.y, g->size.y, g->ny), g->ny, g->wrap);
    return &g->head[(ptrdiff_t)y * g->nx + x];
}

tz_status tz_grid_add(tz_ctx *ctx, tz_grid *g, tz_vec2 p, int32_t *id)
{
    if (!isfinite(p.x) || !isfinite(p.y))
        return tz_fail(ctx, TZ_INVALID, "grid: point (%g, %g)", p.x, p.y);
    tz_status s = tz_array_reserve(ctx, &g->point, (int64_t)g->point.n + 1);
    if (s == TZ_OK)
        s = tz_array_reserve(ctx, &g->next, (int64_t)g->next.n + 1);
    if (s != TZ_OK)
        return s;
    int32_t *head = cell_of(g, p), i = g->point.n++;
    g->next.n++;
    g->point.v[i] = p;
    g->next.v[i] = *head;
    *head = i;
    if (id)
        *id = i;
    return TZ_OK;
}

void tz_grid_remove(tz_grid *g, int32_t id)
{
    assert(id >= 0 && id < g->point.n);
    if (g->next.v[id] == REMOVED)
        return;
    int32_t *link = cell_of(g, g->point.v[id]);
    while (*link != id)
        link = &g->next.v[*link];
    *link = g->next.v[id];
    g->next.v[id] = REMOVED;
}

static int by_value(const void *a, const void *b)
{
    int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}

/* Puts a new id into the `kept` lowest of max, a heap with the highest on top. */
static void keep_lowest(int32_t *out, int32_t kept, int32_t max, int32_t id)
{
    if (kept < max) { /* sift up */
        int32_t i = kept;
        for (; i > 0 && out[(i - 1) / 2] < id; i = (i - 1) / 2)
            out[i] = out[(i - 1) / 2];
        out[i] = id;
    } else if (max > 0 && id < out[0]) { /* replace the top, sift down */
        int32_t i = 0;
        for (int32_t c; (c = 2 * i + 1) < max; i = c) {
            if (c + 1 < max && out[c + 1] > out[c])
                c++;
            if (out[c] <= id)
                break;
            out[i] = out[c];
        }
        out[i] = id;
    }
}

int32_t tz_grid_query(const tz_grid *g, tz_vec2 p, double radius, int32_t *out,
                      int32_t max)
{
    double x0 = cell_at(p.x - radius, g->origin.x, g->size.x, g->nx);
    double x1 = cell_at(p.x + radius, g->origin.x, g->size.x, g->nx);
    double y0 = cell_at(p.y - radius, g->origin.y, g->size.y, g->ny);
    double y1 = cell_at(p.y + radius, g->origin.y, g->size.y, g->ny);
    if (!(x1 >= x0) || !(y1 >= y0))
        return 0;
    if (g->wrap) { /* once round at most */
        x1 = fmin(x1, x0 + g->nx - 1);
        y1 = fmin(y1, y0 + g->ny - 1);
    } else { /* points outside live in the border cells */
        x0 = fold(x0, g->nx, false);
        x1 = fold(x1, g->nx, false);
        y0 = fold(y0, g->ny, false);
        y1 = fold(y1, g->ny, false);
    }
    int32_t count = 0;
    for (double y = y0; y <= y1; y++) {
        const int32_t *row = g->head + (ptrdiff_t)fold(y, g->ny, g->wrap) * g->nx;
        for (double x = x0; x <= x1; x++) {
            for (int32_t i = row[fold(x, g->nx, g->wrap)]; i >= 0; i = g->next.v[i]) {
                tz_vec2 d = tz_vec2_sub(g->point.v[i], p);
                if (g->wrap) {
                    d.x -= g->size.x * nearbyint(d.x / g->size.x);
                    d.y -= g->size.y * nearbyint(d.y / g->size.y);
                }
                if (tz_vec2_dot(d, d) > radius * radius)
                    continue;
                keep_lowest(out, count, max, i);
                count++;
            }
        }
    }
    qsort(out, (size_t)(count < max ? count : max), sizeof *out, by_value);
    return count;
}
