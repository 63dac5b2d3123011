/* SPDX-License-Identifier: Apache-2.0 */
/* Lines on pixels: cells are what is connected by edges of pixels between lines drawn one
 * pixel wide and connected by corners; the distance to the next line is that to its
 * pixels' centres.
 * @source Felzenszwalb, Huttenlocher: Distance transforms of sampled functions, 2012 */
#include <string.h>

#include "curves/curve_statistics.h"

enum { FREE = -1, LINE = -2, OUTSIDE = -3, COLUMNS = 64 };

typedef struct painter {
    const tz_linework_field *f;
    tz_linework_raster *r;
    int32_t *label;
} painter;

/* ---- lines -------------------------------------------------------------------------- */

static void put(const painter *k, double x, double y)
{
    const tz_linework_raster *r = k->r;
    const double i = floor(x), j = floor(y);
    if (i >= 0 && j >= 0 && i < r->width && j < r->height)
        k->label[(int64_t)j * r->width + (int64_t)i] = LINE;
}

/* One pixel for each column or row that the chord runs through, whichever it has more. */
static void draw(const painter *k, const tz_linework_chord *c)
{
    const tz_linework_raster *r = k->r;
    double x = (c->p.x - r->origin.x) / r->pixel, y = (c->p.y - r->origin.y) / r->pixel;
    const double u = (c->q.x - r->origin.x) / r->pixel,
                 v = (c->q.y - r->origin.y) / r->pixel;
    const double most = fmax(fabs(u - x), fabs(v - y));
    if (!(most < 1e6))
        return;
    put(k, x, y);
    put(k, u, v);
    const bool flat = fabs(u - x) >= fabs(v - y);
    const double p = flat ? x : y, q = flat ? u : v;
    const double slope = p == q ? 0 : flat ? (v - y) / (u - x) : (u - x) / (v - y);
    const double lo = fmax(0, floor(fmin(p, q)) + 0.5),
                 hi = fmin(fmax(p, q), flat ? r->width : r->height);
    for (double m = lo; m < hi; m++) {
        if (m < fmin(p, q))
            continue;
        if (flat)
            put(k, m, y + slope * (m - x));
        else
            put(k, x + slope * (m - y), m);
    }
}

static void draw_all(const painter *k)
{
    const tz_linework_raster *r = k->r;
    const int64_t n = (int64_t)r->width * r->height;
    const tz_region *region = k->f->domain.region;
    for (int64_t i = 0; i < n; i++) {
        const tz_vec3 at = {r->origin.x + ((double)(i % r->width) + 0.5) * r->pixel,
                            r->origin.y + ((double)(i / r->width) + 0.5) * r->pixel, 0};
        k->label[i] = region && tz_region_distance(region, at) <= 0 ? OUTSIDE : FREE;
    }
    for (int32_t i = 0; i < k->f->chord.n; i++)
        if (k->f->chord.v[i].inside)
            draw(k, &k->f->chord.v[i]);
}

/* ---- cells -------------------------------------------------------------------------- */

/* A cell by flooding. */
static void flood(const painter *k, int32_t *stack, int32_t seed, int32_t id,
                  tz_linework_cell *out)
{
    const tz_linework_raster *r = k->r;
    const int32_t w = r->width, h = r->height;
    int32_t n = 0, x0 = w, y0 = h, x1 = 0, y1 = 0;
    double area = 0;
    bool cut = false;
    stack[n++] = seed;
    k->label[seed] = id;
    while (n > 0) {
        const int32_t at = stack[--n], x = at % w, y = at / w;
        area++;
        x0 = x < x0 ? x : x0, x1 = x > x1 ? x : x1;
        y0 = y < y0 ? y : y0, y1 = y > y1 ? y : y1;
        const int32_t next[4] = {x > 0 ? at - 1 : -1, x + 1 < w ? at + 1 : -1,
                                 y > 0 ? at - w : -1, y + 1 < h ? at + w : -1};
        for (int i = 0; i < 4; i++) {
            if (next[i] < 0 || k->label[next[i]] == OUTSIDE) {
                cut = true;
            } else if (k->label[next[i]] == FREE) {
                k->label[next[i]] = id;
                stack[n++] = next[i];
            }
        }
    }
    const double px = r->pixel;
    *out = (tz_linework_cell){
        .area = area * px * px,
        .lo = {r->origin.x + x0 * px, r->origin.y + y0 * px},
        .hi = {r->origin.x + (x1 + 1) * px, r->origin.y + (y1 + 1) * px},
        .cut = cut};
}

/* The pixels of lines belong to the cells beside them. */
static void share_lines(const painter *k)
{
    tz_linework_raster *r = k->r;
    const int32_t w = r->width, h = r->height;
    for (int32_t at = 0; at < w * h; at++) {
        const int32_t x = at % w, y = at / w;
        const int32_t next[4] = {x > 0 ? at - 1 : at, x + 1 < w ? at + 1 : at,
                                 y > 0 ? at - w : at, y + 1 < h ? at + w : at};
        int beside = 0;
        if (k->label[at] != LINE)
            continue;
        for (int i = 0; i < 4; i++)
            beside += k->label[next[i]] >= 0;
        for (int i = 0; i < 4; i++)
            if (k->label[next[i]] >= 0)
                r->cell.v[k->label[next[i]]].area += r->pixel * r->pixel / beside;
    }
}

static tz_status find_cells(const painter *k, int32_t *stack)
{
    tz_linework_raster *r = k->r;
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < r->width * r->height && s == TZ_OK; i++) {
        tz_linework_cell c;
        if (k->label[i] != FREE)
            continue;
        flood(k, stack, i, r->cell.n, &c);
        s = tz_array_push(r->ctx, &r->cell, c);
    }
    if (s == TZ_OK)
        share_lines(k);
    return s;
}

/* How much of a cell's box lies in the window. */
static double overlap(const tz_linework_cell *c, const tz_linework_window *w)
{
    const double x = fmin(c->hi.x, w->hi.x) - fmax(c->lo.x, w->lo.x),
                 y = fmin(c->hi.y, w->hi.y) - fmax(c->lo.y, w->lo.y);
    return x > 0 && y > 0 ? x * y / ((c->hi.x - c->lo.x) * (c->hi.y - c->lo.y)) : 0;
}

static void add_cell(double *share, double at, double weight)
{
    const double low = floor(fmin(fmax(at, 0), TZ_LINEWORK_AREAS - 1));
    const double t = fmin(fmax(at - low, 0), 1);
    share[(int32_t)low] += weight * (1 - t);
    if (low + 1 < TZ_LINEWORK_AREAS)
        share[(int32_t)low + 1] += weight * t;
}

void tz_linework_cells_of(const tz_linework_field *f, const tz_linework_raster *r,
                          tz_linework_window w, tz_vec2 widest,
                          double share[TZ_LINEWORK_AREAS])
{
    const double unit = f->scale.unit;
    double all = 0;
    w.lo = (tz_vec2){fmax(w.lo.x, r->origin.x), fmax(w.lo.y, r->origin.y)};
    w.hi = (tz_vec2){fmin(w.hi.x, r->origin.x + r->width * r->pixel),
                     fmin(w.hi.y, r->origin.y + r->height * r->pixel)};
    const double x = w.hi.x - w.lo.x, y = w.hi.y - w.lo.y;
    memset(share, 0, TZ_LINEWORK_AREAS * sizeof *share);
    for (int32_t i = 0; i < r->cell.n; i++) {
        const tz_linework_cell *c = &r->cell.v[i];
        const double cx = c->hi.x - c->lo.x, cy = c->hi.y - c->lo.y;
        if (cx > 0.7 * widest.x || cy > 0.7 * widest.y) {
            all += c->area * overlap(c, &w);
            continue;
        }
        if (c->cut || c->lo.x < w.lo.x || c->lo.y < w.lo.y || c->hi.x > w.hi.x ||
            c->hi.y > w.hi.y)
            continue;
        const double weight = c->area * x * y / ((x - cx) * (y - cy));
        add_cell(share, 2 * log2(c->area / (unit * unit)) + 0.5 * TZ_LINEWORK_AREAS,
                 weight);
        all += weight;
    }
    for (int k = 0; k < TZ_LINEWORK_AREAS; k++)
        share[k] = (all > 0 ? share[k] / all : 0) + (k > 0 ? share[k - 1] : 0);
}

/* ---- distances ---------------------------------------------------------------------- */

typedef struct transform {
    tz_linework_raster *r;
    float *to; /* px */
    float most;
} transform;

/* Distances along columns to the next line in them, for some columns at once. */
static tz_status pass_columns(tz_ctx *ctx, void *arg, int64_t block, int worker)
{
    const transform *t = arg;
    const int32_t w = t->r->width, h = t->r->height;
    const int32_t x0 = (int32_t)block * COLUMNS, x1 = x0 + COLUMNS < w ? x0 + COLUMNS : w;
    (void)ctx, (void)worker;
    for (int32_t y = 1; y < h; y++) {
        float *v = t->to + (int64_t)y * w;
        for (int32_t x = x0; x < x1; x++)
            v[x] = fminf(v[x], v[x - w] + 1);
    }
    for (int32_t y = h - 2; y >= 0; y--) {
        float *v = t->to + (int64_t)y * w;
        for (int32_t x = x0; x < x1; x++)
            v[x] = fminf(v[x], v[x + w] + 1);
    }
    return TZ_OK;
}

/* The least of squared column distance and way along the row; within `most`, which is
 * few pixels. */
static tz_status pass_row(tz_ctx *ctx, void *arg, int64_t y, int worker)
{
    const transform *t = arg;
    const int32_t w = t->r->width, most = (int32_t)t->most;
    const float *v = t->to + y * w;
    float *out = t->r->distance + y * w;
    (void)ctx, (void)worker;
    for (int32_t x = 0; x < w; x++) {
        float best = v[x] * v[x];
        for (int32_t d = 1; d <= most && (float)(d * d) < best; d++) {
            const float a = x >= d ? v[x - d] : t->most,
                        b = x + d < w ? v[x + d] : t->most;
            const float m = fminf(a, b);
            best = fminf(best, m * m + (float)(d * d));
        }
        out[x] = fminf(sqrtf(best), t->most) * (float)t->r->pixel;
    }
    return TZ_OK;
}

static tz_status find_distances(const painter *k)
{
    tz_linework_raster *r = k->r;
    transform t = {.r = r, .most = (float)ceil(k->f->scale.unit / r->pixel)};
    const size_t n = (size_t)r->width * (size_t)r->height;
    tz_status s = tz_alloc(r->ctx, &r->distance, n, sizeof *r->distance);
    if (s == TZ_OK)
        s = tz_alloc(r->ctx, &t.to, n, sizeof *t.to);
    for (size_t i = 0; s == TZ_OK && i < n; i++)
        t.to[i] = k->label[i] == LINE ? 0 : t.most;
    if (s == TZ_OK)
        s = tz_parallel_for(r->ctx, (r->width + COLUMNS - 1) / COLUMNS, pass_columns, &t);
    if (s == TZ_OK)
        s = tz_parallel_for(r->ctx, r->height, pass_row, &t);
    tz_free(r->ctx, t.to);
    return s;
}

/* ---- all ---------------------------------------------------------------------------- */

tz_status tz_linework_raster_init(const tz_linework_field *f, tz_linework_raster *r)
{
    const double px = f->scale.pixel, side = TZ_LINEWORK_SIDE;
    const double w = fmin(side, fmax(1, floor(f->domain.size.x / px))),
                 h = fmin(side, fmax(1, floor(f->domain.size.y / px)));
    *r = (tz_linework_raster){
        .ctx = f->ctx,
        .width = (int32_t)w,
        .height = (int32_t)h,
        .pixel = px,
        .origin = {(f->domain.size.x - w * px) / 2, (f->domain.size.y - h * px) / 2}};
    painter k = {.f = f, .r = r};
    int32_t *stack = NULL;
    const size_t n = (size_t)r->width * (size_t)r->height;
    tz_status s = tz_alloc(r->ctx, &k.label, n, sizeof *k.label);
    if (s == TZ_OK)
        s = tz_alloc(r->ctx, &stack, n, sizeof *stack);
    if (s == TZ_OK) {
        draw_all(&k);
        s = find_distances(&k);
    }
    if (s == TZ_OK)
        s = find_cells(&k, stack);
    tz_free(r->ctx, stack);
    tz_free(r->ctx, k.label);
    if (s != TZ_OK)
        tz_linework_raster_deinit(r);
    return s;
}

void tz_linework_raster_deinit(tz_linework_raster *r)
{
    tz_free(r->ctx, r->distance);
    tz_array_free(r->ctx, &r->cell);
    *r = (tz_linework_raster){0};
}
