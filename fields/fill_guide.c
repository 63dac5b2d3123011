/* SPDX-License-Identifier: Apache-2.0 */
/* Directions, sizes and densities between strokes, before there is anything that has them:
 * harmonic between what is said, on a coarse grid. That is what the scale step settles to, so that
 * counts, and where things are thrown, suit the sizes that they will have. (The nearest
 * stroke's size, everywhere, would put far too many where sizes change.) */
#include <string.h>

#include "fields/fill_internal.h"

enum { SIDE = 64, SWEEPS = 160 };
#define OVER 1.9 /* successive over-relaxation */

static const tz_element_field_cell *cell_at(const tz_fill *f, tz_vec3 at, int what,
                                            bool far)
{
    const int64_t i = tz_raster_at(&f->field->raster, tz_domain_wrap(&f->domain, at));
    const int32_t n = f->field->nearest[what][i];
    return n < 0 || (!far && n != i) ? NULL : &f->field->cell[n];
}

/* What a map holds, and which of the field's three says it. */
enum { COSINE, SINE, SIZE, RHO };
static const int said_by[] = {0, 0, 1, 2};

static double value_of(const tz_element_field_cell *c, int map)
{
    const double v[] = {(double)c->x, (double)c->y, (double)c->size,
                        1 - (double)c->density};
    return v[map];
}

/* Mean of what is said in a cell of the grid; HUGE_VAL = nothing. */
static double said_in(const tz_fill *f, int32_t x, int32_t y, int what)
{
    enum { FEW = 4 };
    const tz_fill_guide *g = &f->guide;
    double sum = 0, n = 0;
    for (int k = 0; k < FEW * FEW; k++) {
        const tz_vec3 at = {(x + (k % FEW + 0.5) / FEW) * f->domain.size.x / g->width,
                            (y + (k / FEW + 0.5) / FEW) * f->domain.size.y / g->height,
                            0};
        const tz_element_field_cell *c = cell_at(f, at, said_by[what], false);
        if (c)
            sum += value_of(c, what), n++;
    }
    return n > 0 ? sum / n : HUGE_VAL;
}

static tz_vec3 middle_of(const tz_fill *f, int32_t x, int32_t y)
{
    return (tz_vec3){(x + 0.5) * f->domain.size.x / f->guide.width,
                     (y + 0.5) * f->domain.size.y / f->guide.height, 0};
}

/* Index of a cell beside another, -1 beyond the border. */
static int32_t beside(const tz_fill *f, int32_t x, int32_t y, int way)
{
    const tz_fill_guide *g = &f->guide;
    x += (way == 0) - (way == 1), y += (way == 2) - (way == 3);
    if (f->domain.torus)
        x = (x + g->width) % g->width, y = (y + g->height) % g->height;
    return x < 0 || y < 0 || x >= g->width || y >= g->height ? -1 : y * g->width + x;
}

/* A free cell, and those beside it that are not outside. */
typedef struct free_cell {
    int32_t at, n, near[4];
} free_cell;

/* state: 0 = outside, 1 = free, 2 = said */
static tz_status relax(const tz_fill *f, const uint8_t *state, double *v)
{
    const tz_fill_guide *g = &f->guide;
    free_cell *cell = NULL;
    int32_t cells = 0;
    const int32_t all = g->width * g->height;
    const tz_status s = tz_alloc(f->ctx, &cell, (size_t)all, sizeof *cell);
    for (int32_t i = 0; i < all && s == TZ_OK; i++) {
        free_cell *c = &cell[cells];
        *c = (free_cell){.at = i};
        for (int way = 0; way < 4 && state[i] == 1; way++) {
            const int32_t q = beside(f, i % g->width, i / g->width, way);
            if (q >= 0 && state[q] > 0)
                c->near[c->n++] = q;
        }
        cells += c->n > 0;
    }
    for (int32_t k = 0; k < SWEEPS && s == TZ_OK; k++)
        for (const free_cell *c = cell; c < cell + cells; c++) {
            double sum = 0;
            for (int32_t e = 0; e < c->n; e++)
                sum += v[c->near[e]];
            sum = c->n == 4 ? 0.25 * sum : sum / c->n;
            v[c->at] += (k < SWEEPS - 8 ? OVER : 1) * (sum - v[c->at]);
        }
    tz_free(f->ctx, cell);
    return s;
}

static tz_status make_map(tz_fill *f, int what, double **map)
{
    const tz_fill_guide *g = &f->guide;
    const size_t n = (size_t)g->width * (size_t)g->height;
    uint8_t *state = NULL;
    double lo = HUGE_VAL, hi = -HUGE_VAL;
    tz_status s = tz_alloc(f->ctx, map, n, sizeof **map);
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &state, n, 1);
    for (int32_t i = 0; i < (int32_t)n && s == TZ_OK; i++) {
        const int32_t x = i % g->width, y = i / g->width;
        const double said = said_in(f, x, y, what);
        const tz_vec3 at = middle_of(f, x, y);
        state[i] = said < HUGE_VAL ? 2 : tz_domain_contains(&f->domain, at);
        (*map)[i] =
            said < HUGE_VAL ? said : value_of(cell_at(f, at, said_by[what], true), what);
        lo = fmin(lo, (*map)[i]), hi = fmax(hi, (*map)[i]);
    }
    if (s == TZ_OK)
        s = relax(f, state, *map);
    for (size_t i = 0; i < n && s == TZ_OK; i++)
        (*map)[i] = fmin(fmax((*map)[i], lo), hi);
    tz_free(f->ctx, state);
    return s;
}

void tz_fill_guide_deinit(tz_fill *f)
{
    tz_free(f->ctx, f->guide.size);
    tz_free(f->ctx, f->guide.rho);
    tz_free(f->ctx, f->guide.x), tz_free(f->ctx, f->guide.y);
    f->guide = (tz_fill_guide){0};
}

tz_status tz_fill_guide_init(tz_fill *f)
{
    tz_fill_guide *g = &f->guide;
    const tz_vec3 size = f->domain.size;
    const double cell = fmax(size.x, size.y) / SIDE;
    tz_status s = TZ_OK;
    g->width = (int32_t)fmax(1, ceil(size.x / cell - 1e-9));
    g->height = (int32_t)fmax(1, ceil(size.y / cell - 1e-9));
    g->least = 1;
    if (f->any_direction)
        s = make_map(f, COSINE, &g->x);
    if (s == TZ_OK && f->any_direction)
        s = make_map(f, SINE, &g->y);
    if (s == TZ_OK && f->any_size)
        s = make_map(f, SIZE, &g->size);
    if (s == TZ_OK && f->any_density)
        s = make_map(f, RHO, &g->rho);
    for (int32_t i = 0; i < g->width * g->height && s == TZ_OK; i++) {
        const double v = (g->size ? g->size[i] : 1) * (1 + (g->rho ? g->rho[i] : 0));
        g->least = i == 0 ? v : fmin(g->least, v);
    }
    if (s != TZ_OK)
        tz_fill_guide_deinit(f);
    return s;
}

/* Where a place lies between four cells. */
typedef struct between {
    ptrdiff_t at[4];
    double u, v;
} between;

static double clamp(double x, double most) { return x > most ? most : x > 0 ? x : 0; }

static between look(const tz_fill *f, tz_vec3 at)
{
    const tz_fill_guide *g = &f->guide;
    const double x = clamp(at.x / f->domain.size.x * g->width - 0.5, g->width - 1),
                 y = clamp(at.y / f->domain.size.y * g->height - 0.5, g->height - 1);
    const int32_t i = (int32_t)x, j = (int32_t)y;
    const int32_t i1 = i + 1 < g->width ? i + 1 : i, j1 = j + 1 < g->height ? j + 1 : j;
    const ptrdiff_t p = (ptrdiff_t)j * g->width, q = (ptrdiff_t)j1 * g->width;
    return (between){{p + i, p + i1, q + i, q + i1}, x - i, y - j};
}

static double mix(const between *b, const double *map)
{
    return (map[b->at[0]] * (1 - b->u) + map[b->at[1]] * b->u) * (1 - b->v) +
           (map[b->at[2]] * (1 - b->u) + map[b->at[3]] * b->u) * b->v;
}

/* Bilinear; what is said at the place itself goes first. */
static double look_up(const tz_fill *f, const double *map, tz_vec3 at, int what)
{
    at = tz_domain_wrap(&f->domain, at);
    const tz_element_field_cell *c = cell_at(f, at, said_by[what], false);
    const between b = look(f, at);
    return c ? value_of(c, what) : mix(&b, map);
}

double tz_fill_direction(const tz_fill *f, tz_vec3 at, tz_vec2 *v)
{
    *v = (tz_vec2){1, 0};
    if (!f->guide.x || !f->guide.y)
        return 0;
    at = tz_domain_wrap(&f->domain, at);
    const tz_element_field_cell *c = cell_at(f, at, said_by[COSINE], false);
    const between b = look(f, at);
    const double x = c ? value_of(c, COSINE) : mix(&b, f->guide.x),
                 y = c ? value_of(c, SINE) : mix(&b, f->guide.y), l = sqrt(x * x + y * y);
    if (l > 0)
        *v = (tz_vec2){x / l, y / l};
    return l < 1 ? l : 1;
}

double tz_fill_angle(const tz_fill *f, tz_vec3 at)
{
    tz_vec2 v;
    tz_fill_direction(f, at, &v);
    return atan2(v.y, v.x);
}

double tz_fill_size(const tz_fill *f, tz_vec3 at)
{
    return f->guide.size ? look_up(f, f->guide.size, at, SIZE) : 1;
}

double tz_fill_rho(const tz_fill *f, tz_vec3 at)
{
    return f->guide.rho ? look_up(f, f->guide.rho, at, RHO) : 0;
}
