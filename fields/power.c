/* SPDX-License-Identifier: Apache-2.0 */
/* Power cells by clipping. A cell starts as the domain's rectangle (on a torus as the
 * rectangle about its site) and is cut, in coordinates from its site p, by
 *
 *   2 x . d <= |d|^2 + w - v        d = q - p of a site q of weight v
 *
 * first by the neighbours it had, then by all sites that can still cut it: with R the
 * distance of its farthest corner, q must be nearer than R + sqrt(R^2 - w + v). Sites are
 * kept in grids, one for each octave of radii, so that v is nearly the greatest of a grid
 * and small cells do not search far because there is a large site somewhere. What is found
 * is exact; the neighbours of before only make R small at once.
 *
 * With a region a cell that its border may run through is split into triangles down to
 * about a cell of the region's raster, and these are cut where the signed distance, linear
 * over each, is 0. */
#include "fields/power.h"

#include <assert.h>
#include <string.h>

#include "base/array.h"

enum { LEVELS = 12, BLOCK = 256, FIRST = 96 };

/* A site in the grid, by cells. */
typedef struct item {
    double x, y, w;
    int32_t site;
} item;

/* Sites of radii below `radius`. */
typedef struct level {
    double cell_x, cell_y, most; /* greatest weight in it */
    int32_t nx, ny, n;
    int32_t *start; /* nx * ny + 1 */
    item *item;
} level;

typedef struct list {
    TZ_ARRAY(int32_t)
    v;
} list;

typedef struct scratch {
    TZ_ARRAY(tz_power_corner)
    a;
    TZ_ARRAY(tz_power_corner)
    b;
    TZ_ARRAY(int32_t)
    near;
    TZ_ARRAY(uint32_t)
    seen; /* a site: the cell, counted by `cells`, that it has cut as a known neighbour */
    uint32_t cells;
} scratch;

struct tz_power {
    tz_ctx *ctx;
    tz_domain domain;
    int32_t n, cap;
    const tz_vec3 *at; /* of the running update */
    const double *weight;
    double *area, *gap;
    tz_vec2 *centre, *gap_at;
    int32_t *start, *count, *mark;
    list neighbour; /* what start points into */
    level lv[LEVELS];
    double unit; /* of the grid of level 0 */
    list *blocks;
    int32_t block_cap;
    scratch *work;
    int workers;
    list dirty;
    int32_t stamp;
};

/* ---- making ------------------------------------------------------------------------- */

tz_status tz_power_new(tz_ctx *ctx, const tz_domain *domain, tz_power **out)
{
    tz_power *p = NULL;
    if (!(domain->size.x > 0) || !(domain->size.y > 0) || !isfinite(domain->size.x) ||
        !isfinite(domain->size.y))
        return tz_fail(ctx, TZ_INVALID, "power diagram: a domain of %g x %g has no area",
                       domain->size.x, domain->size.y);
    tz_status s = tz_alloc_zero(ctx, &p, 1, sizeof *p);
    if (s != TZ_OK)
        return s;
    p->ctx = ctx;
    p->domain = *domain;
    p->workers = tz_ctx_threads(ctx);
    s = tz_alloc_zero(ctx, &p->work, (size_t)p->workers, sizeof *p->work);
    if (s != TZ_OK)
        tz_power_free(p);
    else
        *out = p;
    return s;
}

static void free_levels(tz_power *p)
{
    for (int l = 0; l < LEVELS; l++) {
        tz_free(p->ctx, p->lv[l].start);
        tz_free(p->ctx, p->lv[l].item);
        p->lv[l] = (level){0};
    }
}

void tz_power_free(tz_power *p)
{
    if (!p)
        return;
    tz_ctx *ctx = p->ctx;
    free_levels(p);
    for (int k = 0; p->work && k < p->workers; k++) {
        tz_array_free(ctx, &p->work[k].a);
        tz_array_free(ctx, &p->work[k].b);
        tz_array_free(ctx, &p->work[k].near);
        tz_array_free(ctx, &p->work[k].seen);
    }
    for (int32_t k = 0; k < p->block_cap; k++)
        tz_array_free(ctx, &p->blocks[k].v);
    tz_free(ctx, p->work), tz_free(ctx, p->blocks);
    tz_free(ctx, p->area), tz_free(ctx, p->gap), tz_free(ctx, p->centre);
    tz_free(ctx, p->gap_at), tz_free(ctx, p->start), tz_free(ctx, p->count);
    tz_free(ctx, p->mark);
    tz_array_free(ctx, &p->neighbour.v);
    tz_array_free(ctx, &p->dirty.v);
    tz_free(ctx, p);
}

tz_power_cells tz_power_get(const tz_power *p)
{
    return (tz_power_cells){p->n,      p->area,  p->centre,        p->gap,
                            p->gap_at, p->start, p->neighbour.v.v, p->count};
}

/* Room for n sites; those that come have no neighbours yet. */
static tz_status reserve(tz_power *p, int32_t n)
{
    tz_status s = TZ_OK;
    if (n > p->cap) {
        const size_t cap = (size_t)n + (size_t)n / 4 + 16;
        s = tz_realloc(p->ctx, &p->area, cap, sizeof *p->area);
        if (s == TZ_OK)
            s = tz_realloc(p->ctx, &p->gap, cap, sizeof *p->gap);
        if (s == TZ_OK)
            s = tz_realloc(p->ctx, &p->centre, cap, sizeof *p->centre);
        if (s == TZ_OK)
            s = tz_realloc(p->ctx, &p->gap_at, cap, sizeof *p->gap_at);
        if (s == TZ_OK)
            s = tz_realloc(p->ctx, &p->start, cap, sizeof *p->start);
        if (s == TZ_OK)
            s = tz_realloc(p->ctx, &p->count, cap, sizeof *p->count);
        if (s == TZ_OK)
            s = tz_realloc(p->ctx, &p->mark, cap, sizeof *p->mark);
        if (s != TZ_OK)
            return s;
        p->cap = (int32_t)cap;
    }
    for (int k = 0; k < p->workers && s == TZ_OK; k++) {
        scratch *w = &p->work[k];
        s = tz_array_reserve(p->ctx, &w->seen, n);
        for (; s == TZ_OK && w->seen.n < n; w->seen.n++)
            w->seen.v[w->seen.n] = 0;
    }
    if (s != TZ_OK)
        return s;
    for (int32_t i = p->n; i < n; i++) {
        p->start[i] = p->count[i] = p->mark[i] = 0;
        p->area[i] = p->gap[i] = 0;
        p->centre[i] = p->gap_at[i] = (tz_vec2){0, 0};
    }
    p->n = n;
    return s;
}

/* ---- grids -------------------------------------------------------------------------- */

static int level_of(const tz_power *p, double w)
{
    int l = 0;
    for (double r = p->unit * p->unit; w > r && l < LEVELS - 1; r *= 4)
        l++;
    return l;
}

static int32_t clamp(double x, int32_t n)
{
    return x < 0 ? 0 : x < n ? (int32_t)x : n - 1;
}

static int32_t cell_of(const level *v, double x, double y)
{
    return clamp(y / v->cell_y, v->ny) * v->nx + clamp(x / v->cell_x, v->nx);
}

static tz_status make_level(tz_power *p, int l, const int32_t *level_at)
{
    level *v = &p->lv[l];
    const tz_vec3 size = p->domain.size;
    const double side = fmax(p->unit * (1 << l) * 1.5, /* about two sites a cell */
                             sqrt(2 * size.x * size.y / v->n));
    v->nx = (int32_t)fmin(fmax(floor(size.x / side), 1), 8192);
    v->ny = (int32_t)fmin(fmax(floor(size.y / side), 1), 8192);
    v->cell_x = size.x / v->nx, v->cell_y = size.y / v->ny;
    const size_t cells = (size_t)v->nx * (size_t)v->ny;
    tz_status s = tz_alloc_zero(p->ctx, &v->start, cells + 1, sizeof *v->start);
    if (s == TZ_OK)
        s = tz_alloc(p->ctx, &v->item, (size_t)v->n, sizeof *v->item);
    if (s != TZ_OK)
        return s;
    for (int pass = 0; pass < 2; pass++) {
        for (int32_t i = 0; i < p->n; i++) {
            if (level_at[i] != l)
                continue;
            const tz_vec3 q = tz_domain_wrap(&p->domain, p->at[i]);
            int32_t *to = &v->start[cell_of(v, q.x, q.y)];
            if (pass == 1)
                v->item[*to] = (item){q.x, q.y, p->weight[i], i};
            ++*to;
        }
        int32_t sum = 0;
        for (size_t c = 0; pass == 0 && c <= cells; c++) {
            const int32_t k = v->start[c];
            v->start[c] = sum, sum += k;
        }
    }
    memmove(v->start + 1, v->start, cells * sizeof *v->start);
    v->start[0] = 0;
    return s;
}

static tz_status make_levels(tz_power *p)
{
    const tz_vec3 size = p->domain.size;
    int32_t *level_at = NULL;
    free_levels(p);
    p->unit = sqrt(size.x * size.y / fmax(p->n, 1));
    tz_status s = tz_alloc(p->ctx, &level_at, (size_t)p->n, sizeof *level_at);
    for (int32_t i = 0; i < p->n && s == TZ_OK; i++) {
        const tz_vec3 q = p->at[i];
        const double w = p->weight[i];
        level_at[i] = -1;
        if (!isfinite(q.x) || !isfinite(q.y) || !isfinite(w))
            s = tz_fail(p->ctx, TZ_INVALID,
                        "power diagram: place or weight of site %d is not a number", i);
        else if (w >= 0) {
            level *v = &p->lv[level_at[i] = level_of(p, w)];
            v->n++;
            v->most = fmax(v->most, w);
        }
    }
    for (int l = 0; l < LEVELS && s == TZ_OK; l++)
        if (p->lv[l].n > 0)
            s = make_level(p, l, level_at);
    tz_free(p->ctx, level_at);
    if (s != TZ_OK)
        free_levels(p);
    return s;
}

/* ---- clipping ----------------------------------------------------------------------- */

/* The running cell. */
typedef struct cell {
    tz_power *p;
    scratch *k;
    tz_vec2 at;
    double w;
    double far2, reach; /* squared distance of the farthest corner */
    int32_t site;
    bool gone;
} cell;

static void measure_reach(cell *c)
{
    double far = 0;
    for (int32_t i = 0; i < c->k->a.n; i++) {
        const tz_power_corner *v = &c->k->a.v[i];
        const double d = v->x * v->x + v->y * v->y;
        far = d > far ? d : far;
    }
    c->far2 = far;
    c->reach = sqrt(far);
}

/* Cuts by the site q at d; sites at one place: the heavier, then the first, has it all. */
static tz_status cut(cell *c, double dx, double dy, double w, int32_t q)
{
    scratch *k = c->k;
    const double d2 = dx * dx + dy * dy, limit = d2 + c->w - w;
    if (d2 == 0) {
        if (w > c->w || (w == c->w && q < c->site))
            k->a.n = 0, c->gone = true;
        return TZ_OK;
    }
    if (limit > 0 && limit * limit >= 4 * c->far2 * d2)
        return TZ_OK;
    const int32_t n = k->a.n;
    const double slack = 1e-12 * (d2 + c->far2);
    const tz_power_corner *a = k->a.v;
    int32_t first = -1;
    for (int32_t i = 0; i < n; i++)
        if (2 * (a[i].x * dx + a[i].y * dy) > limit + slack) {
            first = i;
            break;
        }
    if (first < 0)
        return TZ_OK;
    tz_status s = tz_array_reserve(c->p->ctx, &k->b, (int64_t)n + 2);
    if (s != TZ_OK)
        return s;
    tz_power_corner *b = k->b.v;
    int32_t m = 0;
    double h = 2 * (a[0].x * dx + a[0].y * dy) - limit;
    const double h0 = h;
    for (int32_t i = 0; i < n; i++) {
        const int32_t j = i + 1 < n ? i + 1 : 0;
        const double g = j ? 2 * (a[j].x * dx + a[j].y * dy) - limit : h0;
        if (h <= 0)
            b[m++] = a[i];
        if ((h <= 0) != (g <= 0)) {
            const double t = h / (h - g);
            b[m++] =
                (tz_power_corner){a[i].x + t * (a[j].x - a[i].x),
                                  a[i].y + t * (a[j].y - a[i].y), h <= 0 ? q : a[i].site};
        }
        h = g;
    }
    k->b.n = m;
    const scratch swap = *k;
    memcpy(&k->a, &swap.b, sizeof k->a);
    memcpy(&k->b, &swap.a, sizeof k->b);
    if (m < 3)
        k->a.n = 0, c->gone = true;
    measure_reach(c);
    return TZ_OK;
}

static tz_status begin_cell(cell *c)
{
    const tz_vec3 s = c->p->domain.size;
    const bool torus = c->p->domain.torus;
    const tz_status st = tz_array_reserve(c->p->ctx, &c->k->a, FIRST);
    if (st != TZ_OK)
        return st;
    const double x0 = torus ? -s.x / 2 : -c->at.x, x1 = x0 + s.x;
    const double y0 = torus ? -s.y / 2 : -c->at.y, y1 = y0 + s.y;
    const int32_t by = torus ? c->site : -1;
    tz_power_corner *v = c->k->a.v;
    v[0] = (tz_power_corner){x0, y0, by}, v[1] = (tz_power_corner){x1, y0, by};
    v[2] = (tz_power_corner){x1, y1, by}, v[3] = (tz_power_corner){x0, y1, by};
    c->k->a.n = 4;
    c->gone = false;
    measure_reach(c);
    return TZ_OK;
}

/* Which index lies at i of a ring, and how far it is shifted. */
static int32_t around(int32_t i, int32_t n, double size, double *shift)
{
    const int32_t turns = i >= 0 ? i / n : -((n - 1 - i) / n);
    *shift = turns * size;
    return i - turns * n;
}

/* All items of a row of cells. */
static tz_status cut_row(cell *c, const level *v, int32_t x0, int32_t x1, int32_t j)
{
    const tz_domain *d = &c->p->domain;
    tz_status s = TZ_OK;
    double sy = 0;
    if (d->torus)
        j = around(j, v->ny, d->size.y, &sy);
    for (int32_t i = x0; i <= x1 && s == TZ_OK && !c->gone; i++) {
        double sx = 0;
        const int32_t x = d->torus ? around(i, v->nx, d->size.x, &sx) : i;
        const int32_t at = j * v->nx + x, end = v->start[at + 1];
        for (int32_t k = v->start[at]; k < end && s == TZ_OK; k++) {
            const item *q = &v->item[k];
            if (q->site == c->site || (!d->torus && c->k->seen.v[q->site] == c->k->cells))
                continue;
            const double dx = q->x + sx - c->at.x, dy = q->y + sy - c->at.y;
            const double d2 = dx * dx + dy * dy, limit = d2 + c->w - q->w;
            if (limit <= 0 || limit * limit < 4 * c->far2 * d2)
                s = cut(c, dx, dy, q->w, q->site);
        }
    }
    return s;
}

/* How far from the site one of weight `most` can still cut. Of a site's copies on a torus
 * only those within a period and a half of the cell's rectangle do. */
static double search_reach(const cell *c, double most)
{
    const tz_vec3 size = c->p->domain.size;
    const double r = c->reach + sqrt(fmax(0, c->far2 - c->w + most));
    return c->p->domain.torus ? fmin(r, 2 * fmax(size.x, size.y)) : r;
}

/* Rows from the site outwards, until they are beyond reach, which shrinks meanwhile. */
static tz_status cut_level(cell *c, const level *v)
{
    const bool torus = c->p->domain.torus;
    const double y = c->at.y / v->cell_y;
    const int32_t j0 = torus ? (int32_t)floor(y) : clamp(y, v->ny);
    tz_status s = TZ_OK;
    for (int32_t step = 0; s == TZ_OK && !c->gone; step++) {
        bool any = false;
        for (int side = step == 0; side < 2 && s == TZ_OK && !c->gone; side++) {
            const int32_t j = side ? j0 + step : j0 - step;
            const double r = search_reach(c, v->most) * (1 + 1e-9);
            const double off = step == 0 ? 0
                               : side    ? j * v->cell_y - c->at.y
                                         : c->at.y - (j + 1) * v->cell_y;
            if (off > r || (!torus && (j < 0 || j >= v->ny)))
                continue;
            any = true;
            const double lo = (c->at.x - r) / v->cell_x, hi = (c->at.x + r) / v->cell_x;
            const int32_t x0 = torus ? (int32_t)floor(lo) : clamp(lo, v->nx);
            const int32_t x1 = torus ? (int32_t)floor(hi) : clamp(hi, v->nx);
            s = cut_row(c, v, x0, x1, j);
        }
        if (!any)
            break;
    }
    return s;
}

static tz_status cut_known(cell *c)
{
    tz_power *p = c->p;
    const int32_t *near = p->neighbour.v.v + p->start[c->site];
    tz_status s = TZ_OK;
    for (int32_t k = 0; k < p->count[c->site] && s == TZ_OK; k++) {
        const int32_t q = near[k];
        if (q >= p->n || p->weight[q] < 0 || q == c->site)
            continue;
        const tz_vec3 v = tz_domain_vector(&p->domain, (tz_vec3){c->at.x, c->at.y, 0},
                                           (tz_vec3){p->at[q].x, p->at[q].y, 0});
        s = cut(c, v.x, v.y, p->weight[q], q);
        c->k->seen.v[q] = c->k->cells;
    }
    return s;
}

/* Nearest cells first where nothing is known, else a first row would cut by far sites. */
static tz_status cut_near(cell *c)
{
    tz_power *p = c->p;
    tz_status s = TZ_OK;
    for (int l = 0; l < LEVELS && s == TZ_OK && !c->gone; l++) {
        const level *v = &p->lv[l];
        if (v->n == 0)
            continue;
        const int32_t i = clamp(c->at.x / v->cell_x, v->nx),
                      j = clamp(c->at.y / v->cell_y, v->ny);
        const bool torus = p->domain.torus;
        for (int32_t y = j - 1; y <= j + 1 && s == TZ_OK; y++)
            if (torus || (y >= 0 && y < v->ny))
                s = cut_row(c, v, torus || i > 0 ? i - 1 : 0,
                            torus || i + 1 < v->nx ? i + 1 : i, y);
    }
    return s;
}

static tz_status clip_cell(cell *c)
{
    tz_power *p = c->p;
    tz_status s = begin_cell(c);
    if (++c->k->cells == 0) { /* after 2^32 cells */
        memset(c->k->seen.v, 0, (size_t)c->k->seen.n * sizeof *c->k->seen.v);
        c->k->cells = 1;
    }
    if (s == TZ_OK && p->count[c->site] > 2)
        s = cut_known(c);
    else if (s == TZ_OK)
        s = cut_near(c);
    for (int l = 0; l < LEVELS && s == TZ_OK && !c->gone; l++)
        if (p->lv[l].n > 0)
            s = cut_level(c, &p->lv[l]);
    return s;
}

/* ---- areas -------------------------------------------------------------------------- */

typedef struct moment {
    double area, x, y;
} moment;

static void add_triangle(moment *m, tz_vec2 a, tz_vec2 b, tz_vec2 c)
{
    const double t = 0.5 * ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
    m->area += t;
    m->x += t * (a.x + b.x + c.x) / 3;
    m->y += t * (a.y + b.y + c.y) / 3;
}

static tz_vec2 mix(tz_vec2 a, tz_vec2 b, double t)
{
    return (tz_vec2){a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
}

/* The part of a triangle where the distances, linear over it, are above 0. */
static void add_inside(moment *m, const tz_vec2 v[3], const double d[3])
{
    tz_vec2 in[4];
    int n = 0;
    for (int k = 0; k < 3; k++) {
        const int j = (k + 1) % 3;
        if (d[k] > 0)
            in[n++] = v[k];
        if ((d[k] > 0) != (d[j] > 0))
            in[n++] = mix(v[k], v[j], d[k] / (d[k] - d[j]));
    }
    for (int k = 2; k < n; k++)
        add_triangle(m, in[0], in[k - 1], in[k]);
}

static double depth_at(const cell *c, tz_vec2 v)
{
    return tz_region_distance(
        c->p->domain.region,
        tz_domain_wrap(&c->p->domain, (tz_vec3){c->at.x + v.x, c->at.y + v.y, 0}));
}

static void add_split(const cell *c, moment *m, const tz_vec2 v[3], const double d[3],
                      int left)
{
    double longest = 0, least = d[0], most = d[0];
    for (int k = 0; k < 3; k++) {
        const int j = (k + 1) % 3;
        longest = fmax(longest, hypot(v[j].x - v[k].x, v[j].y - v[k].y));
        least = fmin(least, d[k]), most = fmax(most, d[k]);
    }
    if (least >= longest) { /* distances change by no more than the way */
        add_triangle(m, v[0], v[1], v[2]);
        return;
    }
    if (most <= -longest)
        return;
    const tz_raster *r = &c->p->domain.region->raster;
    if (left == 0 || longest <= 2 * r->size.x / r->width) {
        add_inside(m, v, d);
        return;
    }
    const tz_vec2 h[3] = {mix(v[0], v[1], 0.5), mix(v[1], v[2], 0.5),
                          mix(v[2], v[0], 0.5)};
    const double e[3] = {depth_at(c, h[0]), depth_at(c, h[1]), depth_at(c, h[2])};
    add_split(c, m, (tz_vec2[]){v[0], h[0], h[2]}, (double[]){d[0], e[0], e[2]},
              left - 1);
    add_split(c, m, (tz_vec2[]){h[0], v[1], h[1]}, (double[]){e[0], d[1], e[1]},
              left - 1);
    add_split(c, m, (tz_vec2[]){h[2], h[1], v[2]}, (double[]){e[2], e[1], d[2]},
              left - 1);
    add_split(c, m, (tz_vec2[]){h[0], h[1], h[2]}, (double[]){e[0], e[1], e[2]},
              left - 1);
}

static moment moments(const cell *c)
{
    const tz_power_corner *v = c->k->a.v;
    const int32_t n = c->k->a.n;
    const bool whole = !c->p->domain.region || depth_at(c, (tz_vec2){0, 0}) >= c->reach;
    moment m = {0, 0, 0};
    for (int32_t k = 2; k < n; k++) {
        const tz_vec2 t[3] = {
            {v[0].x, v[0].y}, {v[k - 1].x, v[k - 1].y}, {v[k].x, v[k].y}};
        if (whole)
            add_triangle(&m, t[0], t[1], t[2]);
        else
            add_split(c, &m, t,
                      (double[]){depth_at(c, t[0]), depth_at(c, t[1]), depth_at(c, t[2])},
                      5);
    }
    return m;
}

/* Corners on the domain's border lie at the end of what is empty, not in its middle. */
static void measure_gap(const cell *c, double *gap, tz_vec2 *at)
{
    const int32_t n = c->k->a.n;
    *gap = 0;
    *at = (tz_vec2){0, 0};
    for (int32_t k = 0; k < n; k++) {
        const tz_power_corner *v = &c->k->a.v[k];
        const double g = v->x * v->x + v->y * v->y - c->w;
        if (g > *gap && v->site >= 0 && c->k->a.v[k ? k - 1 : n - 1].site >= 0 &&
            (!c->p->domain.region || depth_at(c, (tz_vec2){v->x, v->y}) >= 0))
            *gap = g, *at = (tz_vec2){v->x, v->y};
    }
}

/* ---- cells -------------------------------------------------------------------------- */

static tz_status find_cell(tz_power *p, int32_t i, scratch *k)
{
    const tz_vec3 q = tz_domain_wrap(&p->domain, p->at[i]);
    cell c = {.p = p, .k = k, .at = {q.x, q.y}, .w = p->weight[i], .site = i};
    k->near.n = 0;
    k->a.n = 0;
    p->area[i] = p->gap[i] = 0;
    p->centre[i] = p->gap_at[i] = (tz_vec2){0, 0};
    if (c.w < 0)
        return TZ_OK;
    tz_status s = clip_cell(&c);
    if (s != TZ_OK || c.gone)
        return s;
    const moment m = moments(&c);
    if (m.area > 0) {
        p->area[i] = m.area;
        p->centre[i] = (tz_vec2){m.x / m.area, m.y / m.area};
    }
    measure_gap(&c, &p->gap[i], &p->gap_at[i]);
    for (int32_t e = 0; e < k->a.n && s == TZ_OK; e++) {
        const int32_t q2 = k->a.v[e].site;
        bool new = q2 >= 0 && q2 != i;
        for (int32_t j = 0; j < k->near.n && new; j++)
            new = k->near.v[j] != q2;
        if (new)
            s = tz_array_push(p->ctx, &k->near, q2);
    }
    return s;
}

static tz_status keep(tz_power *p, list *to, int32_t i, const scratch *k)
{
    const tz_status s = tz_array_reserve(p->ctx, &to->v, (int64_t)to->v.n + k->near.n);
    if (s != TZ_OK)
        return s;
    p->start[i] = to->v.n;
    p->count[i] = k->near.n;
    for (int32_t j = 0; j < k->near.n; j++)
        to->v.v[to->v.n++] = k->near.v[j];
    return TZ_OK;
}

/* Starts and counts are written by the block that owns the site; others read only the
 * lists of their own sites. */
static tz_status find_block(tz_ctx *ctx, void *arg, int64_t b, int worker)
{
    tz_power *p = arg;
    list *to = &p->blocks[b];
    tz_status s = tz_array_reserve(ctx, &to->v, BLOCK * 6);
    to->v.n = 0;
    for (int32_t i = (int32_t)b * BLOCK; i < (b + 1) * BLOCK && i < p->n && s == TZ_OK;
         i++) {
        s = find_cell(p, i, &p->work[worker]);
        if (s == TZ_OK)
            s = keep(p, to, i, &p->work[worker]);
    }
    return s;
}

static tz_status reserve_blocks(tz_power *p, int32_t blocks)
{
    if (blocks <= p->block_cap)
        return TZ_OK;
    const tz_status s = tz_realloc(p->ctx, &p->blocks, (size_t)blocks, sizeof *p->blocks);
    for (; s == TZ_OK && p->block_cap < blocks; p->block_cap++)
        p->blocks[p->block_cap] = (list){{0}};
    return s;
}

static void forget(tz_power *p)
{
    p->n = 0;
    p->neighbour.v.n = 0;
}

tz_status tz_power_update(tz_power *p, int32_t n, const tz_vec3 *at, const double *weight)
{
    const int32_t blocks = (n + BLOCK - 1) / BLOCK;
    assert(n >= 0);
    p->at = at, p->weight = weight;
    tz_status s = reserve(p, n);
    if (s == TZ_OK)
        s = reserve_blocks(p, blocks);
    if (s == TZ_OK)
        s = make_levels(p);
    if (s == TZ_OK)
        s = tz_parallel_for(p->ctx, blocks, find_block, p);
    int64_t sum = 0;
    for (int32_t b = 0; b < blocks && s == TZ_OK; b++)
        sum += p->blocks[b].v.n;
    if (s == TZ_OK)
        s = tz_array_reserve(p->ctx, &p->neighbour.v, sum);
    p->neighbour.v.n = 0;
    for (int32_t b = 0; b < blocks && s == TZ_OK; b++) {
        const list *l = &p->blocks[b];
        const int32_t base = p->neighbour.v.n;
        if (l->v.n > 0)
            memcpy(p->neighbour.v.v + base, l->v.v, (size_t)l->v.n * sizeof(int32_t));
        p->neighbour.v.n += l->v.n;
        for (int32_t i = b * BLOCK; i < (b + 1) * BLOCK && i < n; i++)
            p->start[i] += base;
    }
    if (s != TZ_OK)
        forget(p);
    return s;
}

/* ---- changes ------------------------------------------------------------------------ */

static tz_status touch(tz_power *p, int32_t i)
{
    if (p->mark[i] == p->stamp)
        return TZ_OK;
    p->mark[i] = p->stamp;
    return tz_array_push(p->ctx, &p->dirty.v, i);
}

static tz_status touch_neighbours(tz_power *p, int32_t i)
{
    tz_status s = TZ_OK;
    for (int32_t k = 0; k < p->count[i] && s == TZ_OK; k++)
        s = touch(p, p->neighbour.v.v[p->start[i] + k]);
    return s;
}

/* Lists that were replaced leave room unused; closes it up. */
static tz_status compact(tz_power *p)
{
    int64_t used = 0;
    list to = {{0}};
    for (int32_t i = 0; i < p->n; i++)
        used += p->count[i];
    if (p->neighbour.v.n <= 2 * used + 4096)
        return TZ_OK;
    tz_status s = tz_array_reserve(p->ctx, &to.v, used);
    for (int32_t i = 0; i < p->n && s == TZ_OK; i++) {
        memcpy(to.v.v + to.v.n, p->neighbour.v.v + p->start[i],
               (size_t)p->count[i] * sizeof(int32_t));
        p->start[i] = to.v.n;
        to.v.n += p->count[i];
    }
    if (s == TZ_OK) {
        tz_array_free(p->ctx, &p->neighbour.v);
        p->neighbour = to;
    }
    return s;
}

/* Neighbours that a cell has lost: they may be hidden now, and nobody's neighbour. */
static tz_status touch_lost(tz_power *p, int32_t i, int32_t start, int32_t count)
{
    tz_status s = TZ_OK;
    for (int32_t k = start; k < start + count && s == TZ_OK; k++) {
        const int32_t q = p->neighbour.v.v[k];
        bool lost = p->mark[q] != p->stamp;
        for (int32_t e = 0; e < p->count[i] && lost; e++)
            lost = p->neighbour.v.v[p->start[i] + e] != q;
        if (lost)
            s = touch(p, q);
    }
    return s;
}

tz_status tz_power_change(tz_power *p, int32_t n, const tz_vec3 *at, const double *weight,
                          int32_t changed, const int32_t *which)
{
    if (p->n == 0 || n < p->n)
        return tz_power_update(p, n, at, weight);
    p->at = at, p->weight = weight;
    tz_status s = reserve(p, n);
    if (s == TZ_OK)
        s = make_levels(p);
    if (s == TZ_OK)
        s = compact(p);
    p->stamp++;
    p->dirty.v.n = 0;
    for (int32_t k = 0; k < changed && s == TZ_OK; k++)
        s = touch(p, which[k]);
    for (int32_t k = 0; k < changed && s == TZ_OK; k++)
        s = touch_neighbours(p, which[k]);
    for (int32_t i = 0; i < n && s == TZ_OK; i++) /* what was hidden may come forth */
        if (p->count[i] == 0 && weight[i] >= 0)
            s = touch(p, i);
    for (int32_t k = 0; k < p->dirty.v.n && s == TZ_OK; k++) {
        const int32_t i = p->dirty.v.v[k];
        const int32_t start = p->start[i], count = p->count[i];
        const bool hidden = count == 0;
        s = find_cell(p, i, &p->work[0]);
        if (s == TZ_OK)
            s = keep(p, &p->neighbour, i, &p->work[0]);
        if (s == TZ_OK && (k < changed || hidden))
            s = touch_neighbours(p, i);
        if (s == TZ_OK)
            s = touch_lost(p, i, start, count);
    }
    if (s != TZ_OK)
        forget(p);
    return s;
}

int32_t tz_power_cell(tz_power *p, int32_t i, tz_power_corner *out, int32_t most)
{
    scratch *k = &p->work[0];
    if (i < 0 || i >= p->n || p->weight[i] < 0)
        return 0;
    const tz_vec3 q = tz_domain_wrap(&p->domain, p->at[i]);
    cell c = {.p = p, .k = k, .at = {q.x, q.y}, .w = p->weight[i], .site = i};
    if (clip_cell(&c) != TZ_OK || c.gone)
        return 0;
    for (int32_t j = 0; j < k->a.n && j < most; j++)
        out[j] = k->a.v[j];
    return k->a.n;
}
