/* SPDX-License-Identifier: Apache-2.0 */
/* Brushes: they open places to growth, or close them, and wake what stands around.
 *
 * [Dav19] drops brush points with a radius and lets growth happen near them. Here a stroke
 * is painted into the cover (growth_cover.c): the union of its discs, so that the length
 * of a stroke costs nothing later. */
#include "elements/brush.h"

#include <math.h>
#include <string.h>

#include "elements/growth_internal.h"

/* Spacings: how near elements must stand to be grown on from; how wide room must be to be
 * filled through; the margin of it that is filled too. */
static const double close_by = 1.2, passage = 0.5, margin = 0.6;

tz_status tz_brush_begin(tz_ctx *ctx, const tz_element_set *palette,
                         const tz_growth_texture *texture, int32_t n,
                         const tz_growth_params *params, tz_element_set *output,
                         tz_growth **growth)
{
    return tz_growth_open(ctx, palette, texture, n, params, output, true, growth);
}

static tz_status check(const tz_growth *g, tz_vec2 at, double radius, int32_t texture)
{
    if (!isfinite(at.x) || !isfinite(at.y) || !(radius > 0) || !isfinite(radius))
        return tz_fail(g->ctx, TZ_INVALID,
                       "brush: a radius of %g at %g, %g: give one "
                       "above 0",
                       radius, at.x, at.y);
    if (texture < 0 || texture >= g->textures)
        return tz_fail(g->ctx, TZ_INVALID, "brush: texture %d of %d", (int)texture,
                       (int)g->textures);
    return TZ_OK;
}

/* Spots whose centres lie within a radius. */
typedef TZ_ARRAY(int32_t)
spots;

static tz_status list_cell(const tz_growth *g, int32_t cell, tz_vec2 at, double radius,
                           spots *list)
{
    tz_status s = TZ_OK;
    for (int32_t i = g->head[cell]; i >= 0 && s == TZ_OK; i = g->spot.v[i].next) {
        const tz_vec3 v = tz_domain_vector(&g->out->domain, (tz_vec3){at.x, at.y, 0},
                                           (tz_vec3){g->spot.v[i].x, g->spot.v[i].y, 0});
        if (v.x * v.x + v.y * v.y <= radius * radius)
            s = tz_array_push(g->ctx, list, i);
    }
    return s;
}

/* Cells from..to along an axis, each once, wrapped or cut off. */
static int32_t clip(double from, double to, int32_t n, bool torus, int32_t *first)
{
    if (torus && to - from + 1 >= n) {
        *first = 0;
        return n;
    }
    if (!torus) /* what lies beyond the domain is in the cells at its border */
        from = fmin(fmax(from, 0), n - 1), to = fmin(fmax(to, 0), n - 1);
    *first = (int32_t)from;
    return (int32_t)(to - from) + 1;
}

static tz_status list_near(const tz_growth *g, tz_vec2 at, double radius, spots *list)
{
    const bool torus = g->out->domain.torus;
    int32_t i0, j0;
    const int32_t nx = clip(floor((at.x - radius) / g->cell_x),
                            floor((at.x + radius) / g->cell_x), g->nx, torus, &i0);
    const int32_t ny = clip(floor((at.y - radius) / g->cell_y),
                            floor((at.y + radius) / g->cell_y), g->ny, torus, &j0);
    tz_status s = TZ_OK;
    memset(list, 0, sizeof *list);
    for (int32_t k = 0; k < nx * ny && s == TZ_OK; k++) {
        const int32_t i = tz_raster_index(i0 + k % nx, g->nx, torus);
        const int32_t j = tz_raster_index(j0 + k / nx, g->ny, torus);
        s = list_cell(g, j * g->nx + i, at, radius, list);
    }
    return s;
}

/* Calls `act` for each of them. */
static tz_status visit(tz_growth *g, tz_vec2 at, double radius,
                       void (*act)(tz_growth *g, int32_t spot, void *user), void *user)
{
    spots list;
    const tz_status s = list_near(g, at, radius, &list);
    for (int32_t k = 0; k < list.n && s == TZ_OK; k++)
        act(g, list.v[k], user);
    tz_array_free(g->ctx, &list);
    return s;
}

static void wake(tz_growth *g, int32_t spot, void *user)
{
    (void)user;
    g->spot.v[spot].visits = 0;
    tz_growth_enqueue(g, spot);
}

tz_status tz_brush_paint(tz_growth *g, tz_vec2 at, double radius, int32_t texture)
{
    tz_status s = check(g, at, radius, texture);
    if (s != TZ_OK)
        return s;
    const tz_growth_exemplar *ex = &g->ex[texture];
    const tz_vec3 p = tz_domain_wrap(&g->out->domain, (tz_vec3){at.x, at.y, 0});
    s = visit(g, (tz_vec2){p.x, p.y}, radius + g->most * ex->wide, wake, NULL);
    if (s != TZ_OK)
        return s;
    tz_growth_open_place(g, texture, p.x, p.y, radius, true);
    tz_growth_resume(g, (tz_vec2){p.x, p.y}, radius);
    if (tz_growth_is_of(g, texture, p.x, p.y) && !tz_growth_is_decided(g, p.x, p.y))
        s = tz_growth_seed(g, texture, p.x, p.y, close_by * ex->spacing);
    return s;
}

/* ---- eraser ---------------------------------------------------------------------- */

static void mark(tz_growth *g, int32_t spot, void *user)
{
    int32_t *n = user;
    tz_growth_spot *q = &g->spot.v[spot];
    if (q->fixed)
        return;
    q->gone = true;
    n[0]++;
    n[1] += q->out >= 0;
}

/* Neighbours lose neighbours. */
static void recount(tz_growth *g, int32_t spot, void *user)
{
    (void)user;
    tz_growth_spot *q = &g->spot.v[spot];
    tz_growth_view view;
    if (q->match < 0)
        return;
    const tz_growth_unit *u = &g->ex[q->texture].unit[q->match];
    tz_growth_look(g, q->x, q->y, u->wide, spot, &view);
    q->first = 0;
    for (int32_t i = 0; i < view.n; i++)
        q->first += tz_growth_far(u, view.v[i].x, view.v[i].y, view.v[i].r) <= u->wide;
}

tz_status tz_brush_erase(tz_growth *g, tz_vec2 at, double radius, int32_t *removed)
{
    int32_t n[2] = {0, 0};
    tz_status s = check(g, at, radius, 0);
    if (s != TZ_OK)
        return s;
    const tz_vec3 p = tz_domain_wrap(&g->out->domain, (tz_vec3){at.x, at.y, 0});
    const tz_vec2 c = {p.x, p.y};
    s = visit(g, c, radius, mark, n);
    if (s == TZ_OK && n[0] > 0)
        s = tz_growth_remove(g);
    if (s != TZ_OK)
        return s;
    for (int32_t t = 0; t < g->textures; t++)
        tz_growth_forget_place(g, t, p.x, p.y, radius);
    tz_growth_open_place(g, 0, p.x, p.y, radius, false);
    if (removed)
        *removed = n[1];
    return n[0] > 0 ? visit(g, c, radius + g->most * g->wide, recount, NULL) : TZ_OK;
}

/* ---- relaxing brush -------------------------------------------------------------- */

static void relax(tz_growth *g, int32_t spot, void *user)
{
    (void)user;
    g->round[g->rounds++] = spot;
    if (g->rounds == TZ_GROWTH_NODES / 2) {
        tz_growth_relax(g);
        g->rounds = 0;
    }
}

tz_status tz_brush_relax(tz_growth *g, tz_vec2 at, double radius)
{
    tz_status s = check(g, at, radius, 0);
    if (s != TZ_OK)
        return s;
    const tz_vec3 p = tz_domain_wrap(&g->out->domain, (tz_vec3){at.x, at.y, 0});
    g->rounds = 0;
    s = visit(g, (tz_vec2){p.x, p.y}, radius, relax, NULL);
    if (s == TZ_OK)
        tz_growth_relax(g);
    g->rounds = 0;
    return s;
}

/* ---- filler ---------------------------------------------------------------------- */

/* Cells of the room, as far as they have been walked through. */
typedef struct room {
    int32_t nx, ny;
    double step_x, step_y, gap;
    uint8_t *seen;
    TZ_ARRAY(int32_t)
    cell; /* all of it; also the queue of the walk */
} room;

/* Steps into a cell if it is inside, not seen and empty. */
static tz_status enter(const tz_growth *g, room *r, int32_t i, int32_t j)
{
    const bool torus = g->out->domain.torus;
    if (!torus && (i < 0 || j < 0 || i >= r->nx || j >= r->ny))
        return TZ_OK;
    i = tz_raster_index(i, r->nx, torus), j = tz_raster_index(j, r->ny, torus);
    const int32_t at = j * r->nx + i;
    const tz_vec3 p = {(i + 0.5) * r->step_x, (j + 0.5) * r->step_y, 0};
    if (r->seen[at])
        return TZ_OK;
    r->seen[at] = 1;
    if (!tz_domain_contains(&g->out->domain, p) ||
        tz_growth_gap(g, p.x, p.y, r->gap) < r->gap)
        return TZ_OK;
    return tz_array_push(g->ctx, &r->cell, at);
}

static tz_status walk(const tz_growth *g, room *r, tz_vec3 from)
{
    tz_status s = enter(g, r, (int32_t)floor(from.x / r->step_x),
                        (int32_t)floor(from.y / r->step_y));
    for (int32_t k = 0; k < r->cell.n && s == TZ_OK; k++) {
        const int32_t i = r->cell.v[k] % r->nx, j = r->cell.v[k] / r->nx;
        s = enter(g, r, i - 1, j);
        if (s == TZ_OK)
            s = enter(g, r, i + 1, j);
        if (s == TZ_OK)
            s = enter(g, r, i, j - 1);
        if (s == TZ_OK)
            s = enter(g, r, i, j + 1);
    }
    return s;
}

static void open_room(tz_growth *g, const room *r, int32_t texture)
{
    const double wide = r->gap + margin * g->ex[texture].spacing;
    for (int32_t k = 0; k < r->cell.n; k++) {
        const double x = (r->cell.v[k] % r->nx + 0.5) * r->step_x;
        const double y = ((double)(r->cell.v[k] / r->nx) + 0.5) * r->step_y;
        for (int32_t t = 0; t < g->textures; t++)
            tz_growth_forget_place(g, t, x, y, wide);
        tz_growth_open_place(g, texture, x, y, wide, true);
    }
    for (int32_t i = 0; i < g->spot.n; i++)
        if (g->spot.v[i].match >= 0 && tz_growth_undecided(g, &g->spot.v[i]) > 0)
            wake(g, i, NULL);
    const tz_vec3 size = g->out->domain.size;
    tz_growth_resume(g, (tz_vec2){0.5 * size.x, 0.5 * size.y}, size.x + size.y);
}

tz_status tz_brush_fill(tz_growth *g, tz_vec2 at, int32_t texture, double *area)
{
    room r = {0};
    tz_status s = check(g, at, 1, texture);
    if (s != TZ_OK)
        return s;
    const tz_domain *d = &g->out->domain;
    const tz_vec3 p = tz_domain_wrap(d, (tz_vec3){at.x, at.y, 0});
    const double spacing = g->ex[texture].spacing;
    double step = 0.3 * spacing;
    while (d->size.x / step * (d->size.y / step) > 1 << 24)
        step *= 1.25;
    r.gap = passage * spacing;
    r.nx = (int32_t)fmax(1, ceil(d->size.x / step));
    r.ny = (int32_t)fmax(1, ceil(d->size.y / step));
    r.step_x = d->size.x / r.nx, r.step_y = d->size.y / r.ny;
    if (tz_domain_contains(d, p)) {
        s = tz_alloc_zero(g->ctx, &r.seen, (size_t)r.nx * (size_t)r.ny, 1);
        if (s == TZ_OK)
            s = walk(g, &r, p);
    }
    if (s == TZ_OK && r.cell.n > 0) {
        open_room(g, &r, texture);
        if (tz_growth_is_of(g, texture, p.x, p.y))
            s = tz_growth_seed(g, texture, p.x, p.y, 4 * spacing);
    }
    if (s == TZ_OK && area)
        *area = r.cell.n * r.step_x * r.step_y;
    tz_free(g->ctx, r.seen);
    tz_array_free(g->ctx, &r.cell);
    return s;
}

void tz_brush_stop(tz_growth *g)
{
    tz_growth_cover *c = &g->cover;
    for (int32_t i = 0; i < g->queue_n; i++)
        g->spot.v[g->queue[(g->queue_head + i) % g->queue_cap]].queued = false;
    g->queue_n = 0;
    for (size_t w = 0; w < c->cells; w++)
        c->open[w] &= c->done[w];
    c->opened = c->covered;
    tz_growth_rest(g);
}
