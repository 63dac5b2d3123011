/* SPDX-License-Identifier: Apache-2.0 */
/* Bent elements: those whose samples do not lie where a rigid pose puts them. Drawings are
 * read anew from their bent markup, as documents show them (elements/element_write.c).
 * Cut-outs are sampled through the inverse of the warp, which is found at the nodes of a
 * grid of the canvas and lies on straight lines along the rows between them. */
#include "synthesis/element_render_internal.h"

enum { GRID = 4, NODES = TZ_ELEMENT_TILE / GRID + 1 };

/* As documents show them: from this share of the radius on one sees it. */
#define SEEN 0.05

static bool may_bend(const tz_element_renderer *r, const tz_element *e)
{
    const tz_element_symbol *y = &r->set->symbol.v[e->symbol];
    if (e->samples < 3 || e->cut || r->set->kind.v[e->kind].is_void)
        return false;
    return tz_symbol_cut(y) || (r->kind == TZ_MAP_COLOUR && y->markup && *y->markup);
}

/* Rests of symbols, which take long, in parallel: each has a place of its own. */
typedef struct rest_job {
    const tz_element_renderer *r;
    tz_bend_rests *rests;
    int32_t *first; /* an element of each symbol that may bend, -1 = none */
} rest_job;

static tz_status find_rest(tz_ctx *ctx, void *arg, int64_t k, int worker)
{
    const rest_job *job = arg;
    tz_bend b;
    (void)ctx, (void)worker;
    if (job->first[k] < 0)
        return TZ_OK;
    const tz_status s = tz_bend_rests_warp(job->rests, job->first[k], &b);
    tz_bend_deinit(&b);
    return s;
}

static tz_status find_rests(tz_ctx *ctx, const tz_element_renderer *r,
                            tz_bend_rests *rests)
{
    const tz_element_set *set = r->set;
    rest_job job = {r, rests, NULL};
    tz_status s = tz_bend_rests_init(ctx, set, rests);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &job.first, (size_t)set->symbol.n, sizeof *job.first);
    for (int32_t k = 0; k < set->symbol.n && s == TZ_OK; k++)
        job.first[k] = -1;
    for (int32_t i = 0; i < set->element.n && s == TZ_OK; i++)
        if (may_bend(r, &set->element.v[i]))
            job.first[set->element.v[i].symbol] = i;
    if (s == TZ_OK)
        s = tz_parallel_for(ctx, set->symbol.n, find_rest, &job);
    tz_free(ctx, job.first);
    return s;
}

static tz_status find_bends(tz_ctx *ctx, tz_element_renderer *r)
{
    const tz_element_set *set = r->set;
    tz_bend_rests rests = {0};
    tz_status s = tz_alloc(ctx, &r->bent_of, (size_t)set->element.n, sizeof *r->bent_of);
    if (s == TZ_OK)
        s = find_rests(ctx, r, &rests);
    for (int32_t i = 0; i < set->element.n && s == TZ_OK; i++) {
        tz_bent one = {.element = i};
        r->bent_of[i] = -1;
        if (!may_bend(r, &set->element.v[i]))
            continue;
        s = tz_bend_rests_warp(&rests, i, &one.bend);
        if (s != TZ_OK || !(one.bend.strain > SEEN * one.bend.radius * one.bend.scale)) {
            tz_bend_deinit(&one.bend);
            continue;
        }
        r->bent_of[i] = r->bent.n;
        s = tz_array_push(ctx, &r->bent, one);
        if (s != TZ_OK)
            tz_bend_deinit(&one.bend);
    }
    tz_bend_rests_deinit(&rests);
    return s;
}

static tz_status read_bent(tz_ctx *ctx, void *arg, int64_t k, int worker)
{
    tz_element_renderer *r = arg;
    tz_bent *b = &r->bent.v[k];
    const tz_element *e = &r->set->element.v[b->element];
    const tz_element_symbol *y = &r->set->symbol.v[e->symbol];
    char *markup = NULL;
    (void)worker;
    if (tz_symbol_cut(y))
        return TZ_OK;
    tz_bend bend = b->bend;
    bend.ctx = ctx;
    tz_status s = tz_bend_markup(&bend, y->markup, (tz_vec2){e->at.x, e->at.y}, &markup);
    if (s == TZ_UNSUPPORTED || s == TZ_FORMAT) { /* is drawn as its symbol is */
        r->bent_of[b->element] = -1;
        return TZ_OK;
    }
    if (s == TZ_OK)
        s = tz_drawing_init(ctx, &b->drawing, y->id ? y->id : "symbol", markup,
                            y->radius * e->scale);
    if (s == TZ_OK)
        tz_drawing_widen(&b->drawing, e->scale);
    tz_free(ctx, markup);
    return s;
}

tz_status tz_bent_init(tz_ctx *ctx, tz_element_renderer *r)
{
    bool any = false;
    for (int32_t i = 0; i < r->set->element.n && !any; i++)
        any = may_bend(r, &r->set->element.v[i]);
    if (!any)
        return TZ_OK;
    const tz_status s = find_bends(ctx, r);
    return s == TZ_OK ? tz_parallel_for(ctx, r->bent.n, read_bent, r) : s;
}

void tz_bent_deinit(tz_ctx *ctx, tz_element_renderer *r)
{
    for (int32_t k = 0; k < r->bent.n; k++) {
        tz_bend_deinit(&r->bent.v[k].bend);
        tz_drawing_deinit(ctx, &r->bent.v[k].drawing);
    }
    tz_array_free(ctx, &r->bent);
    tz_free(ctx, r->bent_of);
}

/* ---- places -------------------------------------------------------------------------- */

/* Canvas px of a place of the world, and back. `map` is that of the plain pose. */
static tz_vec2 to_canvas(const tz_element_renderer *r, const tz_element *e, tz_affine map,
                         tz_vec2 p)
{
    return (tz_vec2){map.e + (p.x - e->at.x) * r->sx, map.f + (p.y - e->at.y) * r->sy};
}

static tz_vec2 to_world(const tz_element_renderer *r, const tz_element *e, tz_affine map,
                        double x, double y)
{
    return (tz_vec2){e->at.x + (x - map.e) / r->sx, e->at.y + (y - map.f) / r->sy};
}

tz_bounds tz_bent_bounds(const tz_element_renderer *r, const tz_bent *b, tz_affine map)
{
    enum { STEPS = 12 };
    const tz_element *e = &r->set->element.v[b->element];
    if (!tz_symbol_cut(&r->set->symbol.v[e->symbol])) {
        const tz_affine about = {r->sx, 0, 0, r->sy, map.e, map.f};
        return tz_bounds_map(b->drawing.box, about);
    }
    const tz_bounds in = r->cutout[e->symbol].local;
    tz_bounds out = {INFINITY, INFINITY, -INFINITY, -INFINITY};
    for (int j = 0; j <= STEPS; j++)
        for (int i = 0; i <= STEPS; i++) {
            const tz_vec2 q = {in.x0 + (in.x1 - in.x0) * i / STEPS,
                               in.y0 + (in.y1 - in.y0) * j / STEPS};
            const tz_vec2 p = to_canvas(r, e, map, tz_bend_apply(&b->bend, q));
            out.x0 = fmin(out.x0, p.x), out.x1 = fmax(out.x1, p.x);
            out.y0 = fmin(out.y0, p.y), out.y1 = fmax(out.y1, p.y);
        }
    const double more = 0.05 * fmax(out.x1 - out.x0, out.y1 - out.y0);
    return (tz_bounds){out.x0 - more, out.y0 - more, out.x1 + more, out.y1 + more};
}

tz_vec2 tz_bent_source(const tz_element_renderer *r, const tz_bent *b, tz_affine map,
                       double x, double y)
{
    const tz_element *e = &r->set->element.v[b->element];
    return tz_bend_invert(&b->bend, to_world(r, e, map, x, y));
}

double tz_bent_angle(const tz_element_renderer *r, const tz_bent *b, tz_affine map,
                     double x, double y)
{
    const tz_vec2 q = tz_bent_source(r, b, map, x, y);
    const double h = 0.01 * b->bend.radius;
    const tz_vec2 p0 = tz_bend_apply(&b->bend, (tz_vec2){q.x - h, q.y}),
                  p1 = tz_bend_apply(&b->bend, (tz_vec2){q.x + h, q.y});
    return atan2(p1.y - p0.y, p1.x - p0.x);
}

/* ---- cut-outs ------------------------------------------------------------------------ */

/* Places in a plane that nodes of the grid show; NAN where the warp has no inverse. */
typedef struct grid {
    const tz_element_renderer *r;
    const tz_bent *b;
    const tz_showing *p;
    double kx, ky;  /* px of the plane a unit of the symbol */
    int32_t x0, y0; /* of the tile */
    tz_vec2 v[NODES][NODES];
} grid;

static tz_vec2 place_of(const grid *g, double px, double py)
{
    const tz_element *e = &g->r->set->element.v[g->b->element];
    const tz_bend *bend = &g->b->bend;
    const tz_bounds *local = &g->r->cutout[e->symbol].local;
    const tz_vec2 at = to_world(g->r, e, g->p->map, px, py), q = tz_bend_invert(bend, at),
                  back = tz_bend_apply(bend, q);
    if (hypot(back.x - at.x, back.y - at.y) > 0.005 * bend->radius * bend->scale)
        return (tz_vec2){NAN, NAN};
    return (tz_vec2){(q.x - local->x0) * g->kx, (q.y - local->y0) * g->ky};
}

static bool near_box(const tz_bounds *b, double x, double y)
{
    return x >= b->x0 - GRID && x <= b->x1 + GRID && y >= b->y0 - GRID &&
           y <= b->y1 + GRID;
}

static void find_grid(const tz_cutout_view *v, tz_rect t, grid *g)
{
    const tz_element *e = &g->r->set->element.v[g->b->element];
    const tz_element_symbol *y = &g->r->set->symbol.v[e->symbol];
    const tz_cutout *c = &g->r->cutout[e->symbol];
    g->kx = ldexp(c->mx * y->photo_scale, -v->level);
    g->ky = ldexp(c->my * y->photo_scale, -v->level);
    g->x0 = t.x;
    g->y0 = t.y;
    for (int32_t j = 0; j < NODES; j++)
        for (int32_t i = 0; i < NODES; i++) {
            const double px = t.x + i * GRID, py = t.y + j * GRID;
            g->v[j][i] =
                near_box(&g->p->box, px, py) ? place_of(g, px, py) : (tz_vec2){NAN, NAN};
        }
}

/* Map of one row of a square of the grid: canvas px -> px of the plane. */
static bool row_map(const grid *g, int32_t i, int32_t y, tz_affine *m)
{
    const int32_t j = (y - g->y0) / GRID;
    const tz_vec2 *a = &g->v[j][i], *b = &g->v[j + 1][i];
    const double cy = y + 0.5, t = (cy - g->y0 - j * GRID) / GRID, x0 = g->x0 + i * GRID;
    const tz_vec2 l = {a[0].x + t * (b[0].x - a[0].x), a[0].y + t * (b[0].y - a[0].y)},
                  r = {a[1].x + t * (b[1].x - a[1].x), a[1].y + t * (b[1].y - a[1].y)};
    m->a = (r.x - l.x) / GRID, m->b = (r.y - l.y) / GRID;
    m->c = (b[0].x + b[1].x - a[0].x - a[1].x) / (2 * GRID);
    m->d = (b[0].y + b[1].y - a[0].y - a[1].y) / (2 * GRID);
    m->e = l.x - m->a * x0 - m->c * cy;
    m->f = l.y - m->b * x0 - m->d * cy;
    return isfinite(m->a) && isfinite(m->b) && isfinite(m->c) && isfinite(m->d);
}

/* Draws canvas pixels x .. end - 1 of row y under v->inv. */
static void draw_run(const grid *g, tz_cutout_view *v, int32_t x, int32_t end, int32_t y,
                     tz_layer *layer, tz_layer_work *w)
{
    const tz_cutout *c = &g->r->cutout[g->r->set->element.v[g->b->element].symbol];
    const tz_affine i = v->inv;
    const double det = tz_affine_det(i);
    if (!(det > 1e-12))
        return;
    /* of the map's inverse transpose, as tz_cutout_look has it */
    const double s = 1 / sqrt(det);
    v->turn[0] = (float)(i.a * s), v->turn[1] = (float)(-i.b * s);
    v->turn[2] = (float)(-i.c * s), v->turn[3] = (float)(i.d * s);
    tz_cutout_run(c, v, g->r->kind, (tz_rect){x, y, end - x, 1}, layer, w);
}

/* The same pixel by pixel, where nodes have no inverse but pixels between them may; `plain`
 * is the view of the plain pose, for what is near alike. */
static void draw_pixels(const grid *g, const tz_cutout_view *plain, int32_t x,
                        int32_t end, int32_t y, tz_layer *layer, tz_layer_work *w)
{
    for (; x < end; x++) {
        tz_cutout_view v = *plain;
        const tz_vec2 q = place_of(g, x + 0.5, y + 0.5);
        if (!near_box(&g->p->box, x, y) || !(isfinite(q.x) && isfinite(q.y)))
            continue;
        v.inv.e = q.x - v.inv.a * (x + 0.5) - v.inv.c * (y + 0.5);
        v.inv.f = q.y - v.inv.b * (x + 0.5) - v.inv.d * (y + 0.5);
        draw_run(g, &v, x, x + 1, y, layer, w);
    }
}

void tz_bent_draw_cutout(const tz_element_renderer *r, const tz_bent *b,
                         const tz_showing *p, tz_layer *layer, tz_layer_work *w)
{
    const tz_element *e = &r->set->element.v[b->element];
    const tz_cutout *c = &r->cutout[e->symbol];
    const tz_rect t = layer->rect;
    grid g = {.r = r, .b = b, .p = p};
    if (c->empty)
        return;
    tz_cutout_view v = tz_cutout_look(c, &r->set->symbol.v[e->symbol], p->map);
    v.exact = false;
    const tz_cutout_view plain = v;
    find_grid(&v, t, &g);
    for (int32_t y = t.y; y < t.y + t.h; y++)
        for (int32_t x = t.x; x < t.x + t.w; x += GRID) {
            const int32_t end = x + GRID < t.x + t.w ? x + GRID : t.x + t.w;
            if (!near_box(&p->box, x, y))
                continue;
            if (row_map(&g, (x - t.x) / GRID, y, &v.inv))
                draw_run(&g, &v, x, end, y, layer, w);
            else
                draw_pixels(&g, &plain, x, end, y, layer, w);
        }
}
