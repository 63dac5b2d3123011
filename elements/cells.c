/* SPDX-License-Identifier: Apache-2.0 */
/* Counting sort of points into cells no smaller than the reach, so that a query sees at
 * most 3 x 3 of them. */
#include "elements/cells.h"

enum { MOST_SEEN = 256 };

void tz_cells_free(tz_ctx *ctx, tz_cells *c)
{
    tz_array_free(ctx, &c->first);
    tz_array_free(ctx, &c->item);
    tz_array_free(ctx, &c->cell);
    *c = (tz_cells){0};
}

/* Extent of the points; on a torus the domain itself. */
static void extent(tz_cells *c, const tz_vec3 *p, int32_t n, tz_vec2 *size)
{
    if (c->domain.torus) {
        c->origin = (tz_vec2){0, 0};
        *size = (tz_vec2){c->domain.size.x, c->domain.size.y};
        return;
    }
    tz_vec2 lo = {INFINITY, INFINITY}, hi = {-INFINITY, -INFINITY};
    for (int32_t i = 0; i < n; i++) {
        lo.x = fmin(lo.x, p[i].x), hi.x = fmax(hi.x, p[i].x);
        lo.y = fmin(lo.y, p[i].y), hi.y = fmax(hi.y, p[i].y);
    }
    c->origin = n > 0 ? lo : (tz_vec2){0, 0};
    *size = n > 0 ? (tz_vec2){hi.x - lo.x, hi.y - lo.y} : (tz_vec2){0, 0};
}

static int32_t clamp(double v, int32_t n)
{
    return v > 0 ? v < n ? (int32_t)v : n - 1 : 0;
}

static int32_t cell_of(const tz_cells *c, tz_vec3 p)
{
    p = tz_domain_wrap(&c->domain, p);
    const int32_t x = clamp((p.x - c->origin.x) / c->side.x, c->nx);
    const int32_t y = clamp((p.y - c->origin.y) / c->side.y, c->ny);
    return y * c->nx + x;
}

/* Cells as small as the reach allows, but no more than a few for each point. */
static void layout(tz_cells *c, tz_vec2 size, int32_t n, double reach)
{
    const double most = 4.0 * n + 16;
    double nx = fmax(1, floor(size.x / reach)), ny = fmax(1, floor(size.y / reach));
    while (nx * ny > most) {
        nx = fmax(1, floor(nx * 0.7));
        ny = fmax(1, floor(ny * 0.7));
    }
    c->nx = (int32_t)nx, c->ny = (int32_t)ny;
    c->side = (tz_vec2){fmax(size.x / nx, reach * 1e-3), fmax(size.y / ny, reach * 1e-3)};
}

tz_status tz_cells_fill(tz_ctx *ctx, tz_cells *c, const tz_domain *domain,
                        const tz_vec3 *point, int32_t n, double reach)
{
    tz_vec2 size;
    c->domain = *domain;
    extent(c, point, n, &size);
    layout(c, size, n, reach);
    const int32_t cells = c->nx * c->ny;
    tz_status s = tz_array_reserve(ctx, &c->first, (int64_t)cells + 2);
    if (s == TZ_OK)
        s = tz_array_reserve(ctx, &c->item, n);
    if (s == TZ_OK)
        s = tz_array_reserve(ctx, &c->cell, n);
    if (s != TZ_OK)
        return s;
    int32_t *next = c->first.v + 1; /* becomes `first` as the items are dealt out */
    c->first.v[0] = 0;
    for (int32_t k = 0; k <= cells; k++)
        next[k] = 0;
    for (int32_t i = 0; i < n; i++)
        next[(c->cell.v[i] = cell_of(c, point[i])) + 1]++;
    for (int32_t k = 0; k < cells; k++)
        next[k + 1] += next[k];
    for (int32_t i = 0; i < n; i++)
        c->item.v[next[c->cell.v[i]]++] = i;
    c->first.n = cells + 1;
    c->item.n = c->cell.n = n;
    return TZ_OK;
}

static bool before(const tz_nearby *a, const tz_nearby *b)
{
    return a->dist2 < b->dist2 || (a->dist2 == b->dist2 && a->id < b->id);
}

/* Insertion into the sorted list of the nearest. */
static int32_t keep(tz_nearby *out, int32_t n, int32_t most, tz_nearby v)
{
    if (n == most && !before(&v, &out[n - 1]))
        return n;
    int32_t i = n < most ? n : n - 1;
    for (; i > 0 && before(&v, &out[i - 1]); i--)
        out[i] = out[i - 1];
    out[i] = v;
    return n < most ? n + 1 : n;
}

/* Cells from `at` - 1 to `at` + 1 along one axis, each once. */
static int32_t span(int32_t at, int32_t n, bool wrap, int32_t cell[3])
{
    int32_t count = 0;
    if (wrap && n <= 3) {
        for (int32_t k = 0; k < n; k++)
            cell[count++] = k;
        return count;
    }
    for (int32_t k = at - 1; k <= at + 1; k++) {
        if (wrap)
            cell[count++] = k < 0 ? n - 1 : k >= n ? 0 : k;
        else if (k >= 0 && k < n)
            cell[count++] = k;
    }
    return count;
}

int32_t tz_cells_near(const tz_cells *c, const tz_vec3 *point, tz_vec3 at, double radius,
                      int32_t skip, tz_nearby *out, int32_t most)
{
    int32_t xs[3], ys[3], n = 0;
    const int32_t home = cell_of(c, at);
    const int32_t nx = span(home % c->nx, c->nx, c->domain.torus, xs);
    const int32_t ny = span(home / c->nx, c->ny, c->domain.torus, ys);
    const double limit = radius * radius;
    if (most <= 0)
        return 0;
    for (int32_t k = 0; k < nx * ny; k++) {
        const int32_t cell = ys[k / nx] * c->nx + xs[k % nx];
        const int32_t begin = c->first.v[cell];
        int32_t end = c->first.v[cell + 1];
        end = end - begin > MOST_SEEN ? begin + MOST_SEEN : end;
        for (int32_t i = begin; i < end; i++) {
            const int32_t id = c->item.v[i];
            const tz_vec3 v = tz_domain_vector(&c->domain, at, point[id]);
            const double d = v.x * v.x + v.y * v.y;
            if (d <= limit && id != skip)
                n = keep(out, n, most, (tz_nearby){(float)v.x, (float)v.y, (float)d, id});
        }
    }
    return n;
}
