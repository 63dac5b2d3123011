/* SPDX-License-Identifier: Apache-2.0 */
/* The exemplar, prepared for growing: voids, spacing, neighbourhoods and their maps.
 *
 * [Dav19] lets the artist set the radius of neighbourhood of each element and paint
 * invisible elements into empty room (Sec. 5.6). Here both are found: the spacing of an
 * element is its mean distance to the six nearest, its neighbourhood reaches
 * rings + 0.3 spacings (18 neighbours in a hexagonal lattice at two rings, 20 in a square
 * one), and a place farther than 0.85 spacings from everything holds a void. A void is
 * grown like an element, so that empty room gets its share of the output, and then left
 * out. One spacing, the median, serves all elements of about the usual size; much larger
 * and much smaller ones keep their own. */
#include <stdlib.h>
#include <string.h>

#include "base/grid.h"
#include "base/kdtree.h"
#include "elements/growth_internal.h"

enum { NEIGHBOURS = 8, FIRST = 6, NEAREST = 96, TURNS = 8 };
static const double void_gap = 0.85, void_radius = 0.4, ring = 1.5, beyond_rings = 0.3,
                    narrowest = 0.3;

/** Units and, on a torus, their copies around it. */
typedef struct cloud {
    TZ_ARRAY(tz_vec2)
    at;
    TZ_ARRAY(int32_t)
    unit;
    tz_kdtree tree;
    tz_vec2 origin;
} cloud;

static void cloud_deinit(tz_ctx *ctx, cloud *c)
{
    tz_array_free(ctx, &c->at);
    tz_array_free(ctx, &c->unit);
    if (c->tree.point)
        tz_kdtree_deinit(&c->tree);
    memset(c, 0, sizeof *c);
}

static tz_status push(tz_ctx *ctx, cloud *c, tz_vec2 p, int32_t unit)
{
    tz_status s = tz_array_push(ctx, &c->at, p);
    if (s == TZ_OK)
        s = tz_array_push(ctx, &c->unit, unit);
    return s;
}

static tz_status push_copies(tz_ctx *ctx, const tz_growth_exemplar *ex, double margin,
                             cloud *c)
{
    const int32_t tx = (int32_t)fmin(TURNS, ceil(margin / ex->size.x));
    const int32_t ty = (int32_t)fmin(TURNS, ceil(margin / ex->size.y));
    tz_status s = TZ_OK;
    for (int32_t j = -ty; j <= ty; j++)
        for (int32_t i = -tx; i <= tx; i++)
            for (int32_t k = 0; k < ex->n && s == TZ_OK && (i || j); k++) {
                const tz_vec2 p = {ex->unit[k].x + i * ex->size.x,
                                   ex->unit[k].y + j * ex->size.y};
                if (p.x > -margin && p.y > -margin && p.x < ex->size.x + margin &&
                    p.y < ex->size.y + margin)
                    s = push(ctx, c, p, k);
            }
    return s;
}

/* The first n points are the units themselves. */
static tz_status cloud_init(tz_ctx *ctx, const tz_growth_exemplar *ex, double margin,
                            cloud *c)
{
    float *p = NULL;
    tz_status s = TZ_OK;
    memset(c, 0, sizeof *c);
    c->origin = ex->lo;
    for (int32_t k = 0; k < ex->n && s == TZ_OK; k++)
        s = push(ctx, c, (tz_vec2){ex->unit[k].x, ex->unit[k].y}, k);
    if (s == TZ_OK && ex->torus)
        s = push_copies(ctx, ex, margin, c);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &p, (size_t)c->at.n, 2 * sizeof *p);
    if (s == TZ_OK) {
        for (int32_t k = 0; k < c->at.n; k++) {
            p[2 * k] = (float)(c->at.v[k].x - c->origin.x);
            p[2 * k + 1] = (float)(c->at.v[k].y - c->origin.y);
        }
        s = tz_kdtree_init(ctx, &c->tree, p, c->at.n, 2);
    }
    tz_free(ctx, p);
    if (s != TZ_OK)
        cloud_deinit(ctx, c);
    return s;
}

static int32_t nearest(const cloud *c, double x, double y, int32_t k, int32_t *id,
                       float *d2)
{
    const float q[2] = {(float)(x - c->origin.x), (float)(y - c->origin.y)};
    return tz_kdtree_nearest(&c->tree, q, k, id, d2);
}

/* ---- spacing --------------------------------------------------------------------- */

static int by_value(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static tz_status median(tz_ctx *ctx, const tz_growth_exemplar *ex, bool radii,
                        float *middle)
{
    float *v = NULL;
    const tz_status s = tz_alloc(ctx, &v, (size_t)ex->n, sizeof *v);
    if (s != TZ_OK)
        return s;
    for (int32_t k = 0; k < ex->n; k++)
        v[k] = radii ? ex->unit[k].r : ex->unit[k].spacing;
    qsort(v, (size_t)ex->n, sizeof *v, by_value);
    *middle = v[ex->n / 2];
    tz_free(ctx, v);
    return TZ_OK;
}

static bool well_inside(const tz_growth_exemplar *ex, const tz_growth_unit *e, double r)
{
    return ex->torus || (e->x - r > ex->lo.x && e->y - r > ex->lo.y &&
                         e->x + r < ex->hi.x && e->y + r < ex->hi.y);
}

/* Spacing of each unit, and the median of them. */
static tz_status measure(tz_ctx *ctx, tz_growth_exemplar *ex, const cloud *c)
{
    const double mean = sqrt(ex->size.x * ex->size.y / ex->n);
    float middle, radius;
    for (int32_t k = 0; k < ex->n; k++) {
        int32_t id[4 * FIRST], n = 0;
        float d2[4 * FIRST], sum = 0;
        const int32_t found = nearest(c, ex->unit[k].x, ex->unit[k].y, 4 * FIRST, id, d2);
        for (int32_t i = 0; i < found && n < FIRST; i++)
            if (sqrtf(d2[i]) > 1e-3 * mean)
                sum += sqrtf(d2[i]), n++;
        ex->unit[k].spacing = n ? sum / (float)n : (float)mean;
    }
    tz_status s = median(ctx, ex, false, &middle);
    if (s == TZ_OK)
        s = median(ctx, ex, true, &radius);
    if (s != TZ_OK)
        return s;
    ex->spacing = middle;
    for (int32_t k = 0; k < ex->n; k++) {
        tz_growth_unit *e = &ex->unit[k];
        const bool usual = e->r < 1.5F * radius && 1.5F * e->r > radius;
        if (usual || !well_inside(ex, e, e->spacing))
            e->spacing = middle; /* a border shows half of the first ring only */
        e->spacing = fminf(fmaxf(e->spacing, 0.5F * middle), 2.5F * middle);
    }
    return TZ_OK;
}

/* ---- voids ----------------------------------------------------------------------- */

typedef struct gap {
    float width;
    int32_t place;
} gap;

static int by_width(const void *a, const void *b)
{
    const gap *p = a, *q = b;
    return p->width != q->width ? (p->width < q->width) - (p->width > q->width)
                                : (p->place > q->place) - (p->place < q->place);
}

static bool has_voids(const tz_element_set *set)
{
    for (int32_t k = 0; k < set->kind.n; k++)
        if (set->kind.v[k].is_void)
            return true;
    return false;
}

/* Whether elements stand around a place: what lies outside of all is not known to be
 * empty. */
static bool is_enclosed(const tz_growth_exemplar *ex, const cloud *c, tz_vec2 p)
{
    enum { AROUND = 32 };
    int32_t id[AROUND];
    float d2[AROUND], turn[AROUND + 1], gap = 0;
    const int32_t n = nearest(c, p.x, p.y, AROUND, id, d2);
    for (int32_t k = 0; k < n; k++)
        turn[k] = (float)atan2(c->at.v[id[k]].y - p.y, c->at.v[id[k]].x - p.x);
    qsort(turn, (size_t)n, sizeof *turn, by_value);
    turn[n] = turn[0] + (float)(2 * TZ_PI);
    for (int32_t k = 0; k < n; k++)
        gap = fmaxf(gap, turn[k + 1] - turn[k]);
    return ex->torus || gap < (float)(0.8 * TZ_PI);
}

typedef struct raster {
    tz_vec2 lo, step;
    int32_t nx, ny;
} raster;

static tz_vec2 raster_at(const raster *r, int32_t place)
{
    return (tz_vec2){r->lo.x + (place % r->nx + 0.5) * r->step.x,
                     r->lo.y + ((double)(place / r->nx) + 0.5) * r->step.y};
}

/* Places wider than the gap, widest first. */
static tz_status list_gaps(tz_ctx *ctx, const tz_growth_exemplar *ex, const cloud *c,
                           const raster *r, gap **list, int32_t *n)
{
    const tz_status s = tz_alloc(ctx, list, (size_t)r->nx * (size_t)r->ny, sizeof **list);
    *n = 0;
    for (int32_t i = 0; s == TZ_OK && i < r->nx * r->ny; i++) {
        const tz_vec2 p = raster_at(r, i);
        int32_t id[NEIGHBOURS];
        float d2[NEIGHBOURS], width = INFINITY;
        const int32_t found = nearest(c, p.x, p.y, NEIGHBOURS, id, d2);
        for (int32_t k = 0; k < found; k++) {
            const float radius = ex->unit[c->unit.v[id[k]]].r;
            const float thick = radius - 0.5F * (float)ex->spacing;
            width = fminf(width, sqrtf(d2[k]) - fmaxf(0, thick));
        }
        if (width > void_gap * ex->spacing)
            (*list)[(*n)++] = (gap){width, i};
    }
    if (s == TZ_OK)
        qsort(*list, (size_t)*n, sizeof **list, by_width);
    return s;
}

static tz_status add_voids(tz_ctx *ctx, tz_growth_exemplar *ex, const cloud *c,
                           int32_t most)
{
    const bool fill = !has_voids(ex->set); /* else the artist has seen to it */
    raster r = {.lo = ex->torus ? (tz_vec2){0, 0} : ex->lo};
    const tz_vec2 hi = ex->torus ? ex->size : ex->hi;
    const double fine =
        fmax(ex->spacing / 5, sqrt((hi.x - r.lo.x) * (hi.y - r.lo.y) / (1 << 21)));
    gap *list = NULL;
    tz_grid grid = {0};
    int32_t n = 0;
    r.nx = (int32_t)fmin(4096, ceil((hi.x - r.lo.x) / fine));
    r.ny = (int32_t)fmin(4096, ceil((hi.y - r.lo.y) / fine));
    r.nx = r.nx < 1 ? 1 : r.nx, r.ny = r.ny < 1 ? 1 : r.ny;
    r.step = (tz_vec2){(hi.x - r.lo.x) / r.nx, (hi.y - r.lo.y) / r.ny};
    tz_status s = list_gaps(ctx, ex, c, &r, &list, &n);
    if (s == TZ_OK)
        s = tz_grid_init(ctx, &grid, r.lo, tz_vec2_sub(hi, r.lo), ex->spacing, ex->torus);
    for (int32_t i = 0; i < n && s == TZ_OK && fill && ex->n < most; i++) {
        const tz_vec2 p = raster_at(&r, list[i].place);
        int32_t id;
        if (tz_grid_query(&grid, p, void_gap * ex->spacing, &id, 1) > 0 ||
            !is_enclosed(ex, c, p))
            continue;
        s = tz_grid_add(ctx, &grid, p, NULL);
        ex->unit[ex->n++] = (tz_growth_unit){.x = p.x,
                                             .y = p.y,
                                             .r = (float)(void_radius * ex->spacing),
                                             .kind = ex->set->kind.n,
                                             .symbol = -1,
                                             .source = -1,
                                             .spacing = (float)ex->spacing,
                                             .copied = true};
    }
    ex->hole = fmax(ex->hole, narrowest * ex->spacing);
    tz_grid_deinit(ctx, &grid);
    tz_free(ctx, list);
    return s;
}

/* ---- neighbourhoods -------------------------------------------------------------- */

static int by_distance(const void *a, const void *b)
{
    const tz_growth_near *p = a, *q = b;
    return (p->d > q->d) - (p->d < q->d);
}

/* Neighbours of unit k, nearest first. Where there are too many, the neighbourhood ends
 * before the first that has no room in it. */
static int32_t list_near(const tz_growth_exemplar *ex, const cloud *c, int32_t k,
                         tz_growth_near *v)
{
    tz_growth_unit *e = &ex->unit[k];
    int32_t id[NEAREST], n = 0;
    float d2[NEAREST];
    const int32_t found = nearest(c, e->x, e->y, NEAREST, id, d2);
    if (found == NEAREST)
        e->reach = fminf(e->reach, sqrtf(d2[NEAREST - 1]) - 1e-3F * e->spacing);
    for (int32_t i = 0; i < found; i++) {
        const tz_growth_unit *o = &ex->unit[c->unit.v[id[i]]];
        const float x = (float)(c->at.v[id[i]].x - e->x);
        const float y = (float)(c->at.v[id[i]].y - e->y);
        const float d = tz_growth_far(e, x, y, o->r);
        if (id[i] != k && d <= e->reach)
            v[n++] = (tz_growth_near){
                x, y, d, o->r, o->c2, o->s2, o->kind, o->symbol, c->unit.v[id[i]]};
    }
    qsort(v, (size_t)n, sizeof *v, by_distance);
    if (n > TZ_GROWTH_NEAR) {
        e->reach = fminf(e->reach, v[TZ_GROWTH_NEAR].d * 0.999F);
        n = TZ_GROWTH_NEAR;
    }
    return n;
}

static tz_status set_near(tz_ctx *ctx, tz_growth_exemplar *ex, const cloud *c, int32_t k)
{
    tz_growth_unit *e = &ex->unit[k];
    tz_growth_near v[NEAREST];
    float half = e->spacing;
    tz_status s = TZ_OK;
    e->near = ex->near.n;
    e->nears = list_near(ex, c, k, v);
    e->wide = fminf((float)ring * e->spacing, e->reach);
    for (int32_t i = 0; i < e->nears && s == TZ_OK; i++) {
        half = fmaxf(half, fmaxf(fabsf(v[i].x), fabsf(v[i].y)));
        s = tz_array_push(ctx, &ex->near, v[i]);
        e->ring += v[i].d <= e->wide;
        e->larger = e->larger || tz_growth_is_larger(&v[i], e);
    }
    e->half = half + 0.5F * e->spacing;
    e->whole = well_inside(ex, e, 0.9 * e->reach);
    e->known = well_inside(ex, e, e->wide - 0.1 * (double)e->spacing);
    return s;
}

static tz_status draw_map(tz_ctx *ctx, void *arg, int64_t k, int worker)
{
    (void)ctx, (void)worker;
    enum { N = TZ_GROWTH_LUT };
    tz_growth_exemplar *ex = arg;
    const tz_growth_unit *e = &ex->unit[k];
    const tz_growth_near *near = ex->near.v + e->near;
    uint8_t *cell = ex->lut + (size_t)k * N * N;
    for (int32_t i = 0; i < N * N; i++) {
        const float x = ((float)(i % N) + 0.5F) * 2 * e->half / N - e->half;
        const float y = ((float)(i / N) + 0.5F) * 2 * e->half / N - e->half;
        float least = e->spacing * e->spacing;
        cell[i] = 255;
        for (int32_t j = 0; j < e->nears; j++) {
            const float dx = near[j].x - x, dy = near[j].y - y, d = dx * dx + dy * dy;
            if (d < least)
                least = d, cell[i] = (uint8_t)j;
        }
    }
    return TZ_OK;
}

/* How many neighbours a copy should have: as many as the unit, or, where the exemplar's
 * border cuts the unit's, as many as others have on average. */
static void set_due(tz_growth_exemplar *ex)
{
    int64_t nears = 0, rings = 0, whole = 0;
    for (int32_t k = 0; k < ex->n; k++)
        if (ex->unit[k].whole) {
            nears += ex->unit[k].nears;
            rings += ex->unit[k].ring;
            whole++;
        }
    ex->ring_mean = whole ? (float)rings / (float)whole : TZ_GROWTH_NEAR;
    for (int32_t k = 0; k < ex->n; k++) {
        tz_growth_unit *e = &ex->unit[k];
        const bool free = whole == 0; /* nothing to go by */
        e->due = e->whole ? e->nears : free ? TZ_GROWTH_NEAR : (int32_t)(nears / whole);
        e->ring_due = e->whole ? e->ring
                      : free   ? TZ_GROWTH_NEAR
                               : (int32_t)(rings / whole);
    }
}

static tz_status set_neighbourhoods(tz_ctx *ctx, tz_growth_exemplar *ex, const cloud *c,
                                    int32_t rings)
{
    tz_status s = TZ_OK;
    for (int32_t k = 0; k < ex->n && s == TZ_OK; k++) {
        const tz_growth_radius *given = ex->texture.radius;
        const int32_t kind = ex->unit[k].kind;
        ex->unit[k].reach = (float)((rings + beyond_rings) * ex->unit[k].spacing);
        if (given && ex->unit[k].source >= 0 && given[kind].neighbourhood > 0)
            ex->unit[k].reach = (float)(given[kind].neighbourhood * ex->texture.scale);
        ex->reach = fmax(ex->reach, ex->unit[k].reach);
        s = set_near(ctx, ex, c, k);
        ex->wide = fmax(ex->wide, ex->unit[k].wide);
    }
    set_due(ex);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &ex->lut, (size_t)ex->n, TZ_GROWTH_LUT * TZ_GROWTH_LUT);
    if (s == TZ_OK)
        s = tz_parallel_for(ctx, ex->n, draw_map, ex);
    return s;
}

/* ---- all of it ------------------------------------------------------------------- */

static tz_status prepare(tz_ctx *ctx, tz_growth_exemplar *ex, const tz_growth_params *p,
                         int32_t most)
{
    cloud c = {0};
    const double mean = sqrt(ex->size.x * ex->size.y / ex->n);
    const double margin = 1.5 * (p->rings + 1.5) * mean;
    tz_status s = cloud_init(ctx, ex, margin, &c);
    if (s == TZ_OK)
        s = measure(ctx, ex, &c);
    if (s == TZ_OK)
        s = add_voids(ctx, ex, &c, most);
    if (s == TZ_OK)
        s = tz_growth_find_hole(ctx, ex);
    if (s == TZ_OK && ex->n > ex->elements) {
        cloud_deinit(ctx, &c);
        s = cloud_init(ctx, ex, margin, &c);
    }
    if (s == TZ_OK)
        s = set_neighbourhoods(ctx, ex, &c, p->rings);
    if (s == TZ_OK) {
        for (int32_t k = ex->elements; k < ex->n; k++)
            ex->unit[k].stand_in = k;
        s = tz_growth_find_classes(ctx, ex);
    }
    if (s == TZ_OK)
        s = tz_growth_find_others(ctx, ex);
    if (s == TZ_OK)
        s = tz_growth_find_coherent(ctx, ex, p);
    if (s == TZ_OK)
        tz_growth_find_free(ex);
    cloud_deinit(ctx, &c);
    return s;
}

tz_status tz_growth_exemplar_init(tz_ctx *ctx, const tz_element_set *set,
                                  const tz_growth_texture *texture,
                                  const tz_growth_params *p, tz_growth_exemplar *ex)
{
    const int32_t n = tz_growth_count_units(set, texture), number = ex->number;
    const tz_extents *extents = ex->extents;
    const bool *disc = ex->disc;
    memset(ex, 0, sizeof *ex);
    ex->number = number;
    ex->extents = extents;
    ex->disc = disc;
    ex->texture = *texture;
    if (ex->texture.scale == 0)
        ex->texture.scale = 1;
    if (!(ex->texture.scale > 0) || !isfinite(ex->texture.scale))
        return tz_fail(ctx, TZ_INVALID,
                       "growth: texture %d has a scale of %g: give one "
                       "above 0",
                       (int)number, texture->scale);
    if (n < 1 && set->element.n > 0)
        return tz_fail(ctx, TZ_INVALID,
                       "growth: texture %d selects no elements of the palette: widen its "
                       "frame or its kinds",
                       (int)number);
    if (n < 1)
        return tz_fail(ctx, TZ_INVALID, "growth: the exemplar has no elements");
    if (n > TZ_GROWTH_UNITS)
        return tz_fail(ctx, TZ_LIMIT,
                       "growth: the exemplar has %d elements, over %d: cut a part out",
                       (int)n, (int)TZ_GROWTH_UNITS);
    if (!(set->domain.size.x > 0) || !(set->domain.size.y > 0))
        return tz_fail(ctx, TZ_INVALID, "growth: the exemplar's domain has no area");
    ex->set = set;
    ex->overlap = p->overlap;
    const int32_t most = 3 * n + 64;
    tz_status s = tz_alloc_zero(ctx, &ex->unit, (size_t)most, sizeof *ex->unit);
    if (s == TZ_OK) {
        tz_growth_set_units(ex);
        s = prepare(ctx, ex, p, most);
    }
    if (s != TZ_OK)
        tz_growth_exemplar_deinit(ctx, ex);
    return s;
}

void tz_growth_exemplar_deinit(tz_ctx *ctx, tz_growth_exemplar *ex)
{
    tz_free(ctx, ex->unit);
    tz_array_free(ctx, &ex->near);
    tz_free(ctx, ex->lut);
    tz_free(ctx, ex->limit);
    tz_free(ctx, ex->touch);
    tz_free(ctx, ex->bound);
    tz_free(ctx, ex->frequency);
    memset(ex, 0, sizeof *ex);
}
