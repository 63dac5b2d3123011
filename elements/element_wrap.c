/* SPDX-License-Identifier: Apache-2.0 */
/* The border of the view: what it cuts, and on a tile what belongs together across it.
 *
 *        0                    W
 *     ┌──┼────────────────────┼──┐      Two ways in which tiles are drawn:
 *     │ (●)      ●           (●) │      twins, whole on both sides, or
 *     │  ◗)         ●        (◖  │      pieces, cut along the border.
 *     └──┼────────────────────┼──┘
 *
 * Twins reach over the border, share their symbol and lie one period apart: one of them
 * goes. Pieces have a straight edge on the border which the opposite border has too: they
 * become one thing. A shape that merely ends on the border (the tile of a floor) is known
 * by its like inside the view. */
#include <stdlib.h>
#include <string.h>

#include "base/grid.h"
#include "elements/element_svg_internal.h"

/* An edge on the border. Sides: x = 0, x = W, y = 0, y = H. */
typedef struct flush {
    int32_t element, side;
    double lo, hi;
    int32_t pair; /* index of its other half, or -1 */
} flush;

typedef struct border {
    tz_element_reader *r;
    double eps;
    TZ_ARRAY(flush)
    flush;
    TZ_ARRAY(int32_t)
    over;                              /* elements that reach over the border */
    bool *is_over, *is_flush, *inside; /* a flag an element; inside: a flag a symbol */
    int32_t *twin;                     /* an element's twin, or -1 */
    int32_t pairs, twins;              /* elements that have found each other */
    int32_t alone;
} border;

static void border_free(border *b)
{
    tz_ctx *ctx = b->r->ctx;
    tz_array_free(ctx, &b->flush);
    tz_array_free(ctx, &b->over);
    tz_free(ctx, b->is_over);
    tz_free(ctx, b->is_flush);
    tz_free(ctx, b->inside);
    tz_free(ctx, b->twin);
}

/* ---- what lies at the border ------------------------------------------------------- */

static tz_status add_flush(border *b, int32_t element, int side, double lo, double hi)
{
    for (int32_t i = b->flush.n - 1; i >= 0 && b->flush.v[i].element == element; i--) {
        flush *f = &b->flush.v[i];
        if (f->side == side && lo <= f->hi + b->eps && hi >= f->lo - b->eps) {
            f->lo = fmin(f->lo, lo);
            f->hi = fmax(f->hi, hi);
            return TZ_OK;
        }
    }
    return tz_array_push(b->r->ctx, &b->flush,
                         ((flush){element, side, fmin(lo, hi), fmax(lo, hi), -1}));
}

static tz_status scan_edges(border *b, int32_t element, const tz_polys *p)
{
    const tz_vec2 view = b->r->view;
    tz_status s = TZ_OK;
    for (int32_t k = 0; k < p->part.n; k++) {
        int32_t n;
        const tz_vec2 *v = tz_polys_part(p, k, &n);
        for (int32_t i = 0; i < n && s == TZ_OK; i++) {
            const tz_vec2 a = v[i], c = v[(i + 1) % n];
            for (int side = 0; side < 4 && s == TZ_OK; side++) {
                const double at = side == 1 ? view.x : side == 3 ? view.y : 0;
                const bool x = side < 2;
                const double p0 = x ? a.x : a.y, p1 = x ? c.x : c.y;
                const double lo = x ? a.y : a.x, hi = x ? c.y : c.x;
                if (fabs(p0 - at) <= b->eps && fabs(p1 - at) <= b->eps &&
                    fabs(hi - lo) > 4 * b->eps)
                    s = add_flush(b, element, side, fmin(lo, hi), fmax(lo, hi));
            }
        }
    }
    return s;
}

/** Looks closely at one element whose circle meets the border. */
static tz_status scan_element(border *b, int32_t i, tz_polys *polys)
{
    tz_element_reader *r = b->r;
    const tz_thing *t = &r->thing.v[i];
    const double scale = sqrt(fabs(tz_affine_det(t->map))), e = b->eps;
    const double tolerance = fmax(r->set.element.v[i].radius / 200, 1e-12);
    const int32_t before = b->flush.n;
    tz_box box = tz_box_empty();
    double pen = 0;
    tz_status s = TZ_OK;
    tz_polys_clear(polys);
    for (int32_t k = 0; k < t->items && s == TZ_OK; k++) {
        const tz_part *p = &r->part.v[r->item.v[t->item + k]];
        s = tz_part_polys(r, p, t->map, tolerance, polys);
        pen = fmax(pen, tz_part_pen(p) * scale);
    }
    if (s != TZ_OK)
        return s;
    for (int32_t k = 0; k < polys->point.n; k++)
        tz_box_add(&box, polys->point.v[k]);
    b->is_over[i] = box.x0 - pen < -e || box.y0 - pen < -e ||
                    box.x1 + pen > r->view.x + e || box.y1 + pen > r->view.y + e;
    if (b->is_over[i] && (s = tz_array_push(r->ctx, &b->over, i)) != TZ_OK)
        return s;
    /* a curve that reaches over is not cut, whatever edge it has on the border */
    if (!b->is_over[i] || pen > 0)
        s = scan_edges(b, i, polys);
    b->is_flush[i] = b->flush.n > before;
    return s;
}

static tz_status scan(border *b)
{
    tz_element_reader *r = b->r;
    const int32_t n = r->set.element.n;
    tz_polys polys = {0};
    double mean = 0;
    for (int32_t i = 0; i < n; i++)
        mean += r->set.element.v[i].radius / n;
    b->eps = fmin(1e-4 * fmin(r->view.x, r->view.y), 0.01 * mean);
    tz_status s = tz_alloc_zero(r->ctx, &b->is_over, (size_t)n, 1);
    if (s == TZ_OK)
        s = tz_alloc_zero(r->ctx, &b->is_flush, (size_t)n, 1);
    if (s == TZ_OK)
        s = tz_alloc_zero(r->ctx, &b->inside, (size_t)r->set.symbol.n, 1);
    if (s == TZ_OK)
        s = tz_alloc(r->ctx, &b->twin, (size_t)n, sizeof *b->twin);
    for (int32_t i = 0; i < n && s == TZ_OK; i++) {
        const tz_element *e = &r->set.element.v[i];
        const double m = e->radius + 2 * b->eps;
        b->twin[i] = -1;
        if (e->at.x < m || e->at.y < m || e->at.x > r->view.x - m ||
            e->at.y > r->view.y - m)
            s = scan_element(b, i, &polys);
        if (s == TZ_OK && !b->is_over[i] && !b->is_flush[i])
            b->inside[e->symbol] = true;
    }
    tz_polys_deinit(r->ctx, &polys);
    return s;
}

/** Whether the element was cut along the border. */
static bool is_piece(const border *b, int32_t i)
{
    return b->is_flush[i] && !b->inside[b->r->set.element.v[i].symbol];
}

/* ---- pieces ------------------------------------------------------------------------ */

static int by_side(const void *p, const void *q)
{
    const flush *a = p, *b = q;
    if (a->side != b->side)
        return a->side - b->side;
    return a->lo < b->lo ? -1 : a->lo > b->lo ? 1 : a->element - b->element;
}

static bool same_paint(const border *b, int32_t i, int32_t j)
{
    const tz_element_reader *r = b->r;
    const tz_look *p = &r->part.v[r->item.v[r->thing.v[i].item]].look,
                  *q = &r->part.v[r->item.v[r->thing.v[j].item]].look;
    return p->fill == q->fill && p->stroke == q->stroke;
}

static void match_pieces(border *b)
{
    const double tolerance = 20 * b->eps;
    if (b->flush.n > 0)
        qsort(b->flush.v, (size_t)b->flush.n, sizeof *b->flush.v, by_side);
    for (int32_t i = 0; i < b->flush.n; i++) {
        flush *f = &b->flush.v[i];
        if (f->side % 2 != 0 || !is_piece(b, f->element))
            continue;
        for (int32_t j = 0; j < b->flush.n && f->pair < 0; j++) {
            flush *g = &b->flush.v[j];
            if (g->side == f->side + 1 && g->pair < 0 && is_piece(b, g->element) &&
                fabs(g->lo - f->lo) < tolerance && fabs(g->hi - f->hi) < tolerance &&
                same_paint(b, f->element, g->element)) {
                f->pair = j;
                g->pair = i;
            }
        }
    }
}

/* ---- twins ------------------------------------------------------------------------- */

/** How far apart twins may lie. */
static double tolerance_of(const border *b, const tz_element *e)
{
    return fmin(fmax(0.05 * e->radius, 20 * b->eps), 0.25 * e->radius);
}

static double turn_between(double a, double b)
{
    const double d = fabs(a - b);
    return fmin(d, fabs(d - 2 * TZ_PI));
}

static tz_status match_twins(border *b)
{
    enum { NEAR = 64 };
    tz_element_reader *r = b->r;
    const tz_element *e = r->set.element.v;
    tz_grid grid;
    int32_t near[NEAR];
    if (b->over.n == 0)
        return TZ_OK;
    const double cell = sqrt(r->view.x * r->view.y / (b->over.n + 1));
    tz_status s = tz_grid_init(r->ctx, &grid, (tz_vec2){0, 0}, r->view, cell, true);
    if (s != TZ_OK)
        return s;
    for (int32_t k = 0; k < b->over.n && s == TZ_OK; k++) {
        const int32_t i = b->over.v[k];
        const tz_vec2 p = {tz_domain_wrap_axis(e[i].at.x, r->view.x),
                           tz_domain_wrap_axis(e[i].at.y, r->view.y)};
        const double reach = tolerance_of(b, &e[i]);
        int32_t n = tz_grid_query(&grid, p, reach, near, NEAR), id;
        for (int32_t m = 0; m < n && m < NEAR; m++) {
            const int32_t j = b->over.v[near[m]];
            if (b->twin[i] < 0 && e[j].symbol == e[i].symbol &&
                turn_between(e[i].angle, e[j].angle) < 0.05 &&
                fabs(e[i].scale - e[j].scale) < 0.02 * e[i].scale &&
                hypot(e[i].at.x - e[j].at.x, e[i].at.y - e[j].at.y) >
                    fmin(r->view.x, r->view.y) / 2)
                b->twin[i] = b->twin[j] < 0 ? j : b->twin[j];
        }
        if (b->twin[i] >= 0 && b->twin[b->twin[i]] < 0)
            b->twin[b->twin[i]] = b->twin[i]; /* marked as found: its own twin */
        s = tz_grid_add(r->ctx, &grid, p, &id);
    }
    tz_grid_deinit(r->ctx, &grid);
    return s;
}

/* ---- is it a tile? ----------------------------------------------------------------- */

/** Share of elements that have their like a step further on the torus. */
static double share_repeated(border *b, const tz_grid *grid, tz_vec2 step)
{
    enum { NEAR = 64 };
    const tz_element_reader *r = b->r;
    int32_t near[NEAR], found = 0;
    for (int32_t i = 0; i < r->set.element.n; i++) {
        const tz_element *e = &r->set.element.v[i];
        const tz_vec2 p = {tz_domain_wrap_axis(e->at.x + step.x, r->view.x),
                           tz_domain_wrap_axis(e->at.y + step.y, r->view.y)};
        const int32_t n = tz_grid_query(grid, p, tolerance_of(b, e), near, NEAR);
        for (int32_t k = 0; k < n && k < NEAR; k++) {
            const tz_element *o = &r->set.element.v[near[k]];
            if (o->symbol == e->symbol && turn_between(o->angle, e->angle) < 0.05) {
                found++;
                break;
            }
        }
    }
    return (double)found / fmax(r->set.element.n, 1);
}

/** Whether the pattern is itself made of equal tiles both ways. */
static tz_status repeats(border *b, bool *out)
{
    tz_element_reader *r = b->r;
    tz_grid grid;
    bool found[2] = {false, false};
    *out = false;
    if (r->set.element.n < 8 || r->set.element.n > 200000)
        return TZ_OK;
    const double cell = sqrt(r->view.x * r->view.y / r->set.element.n);
    tz_status s = tz_grid_init(r->ctx, &grid, (tz_vec2){0, 0}, r->view, cell, true);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < r->set.element.n && s == TZ_OK; i++) {
        const tz_vec3 at = r->set.element.v[i].at;
        int32_t id;
        s = tz_grid_add(r->ctx, &grid,
                        (tz_vec2){tz_domain_wrap_axis(at.x, r->view.x),
                                  tz_domain_wrap_axis(at.y, r->view.y)},
                        &id);
    }
    for (int k = 2; k <= 6 && s == TZ_OK; k++) {
        found[0] =
            found[0] || share_repeated(b, &grid, (tz_vec2){r->view.x / k, 0}) > 0.85;
        found[1] =
            found[1] || share_repeated(b, &grid, (tz_vec2){0, r->view.y / k}) > 0.85;
    }
    tz_grid_deinit(r->ctx, &grid);
    *out = found[0] && found[1];
    return s;
}

static tz_status decide(border *b, bool *torus)
{
    const tz_element_reader *r = b->r;
    int32_t matched = 0, all = 0;
    *torus = r->opt.wrap || (r->opt.wrap_auto && r->tile);
    if (*torus || !r->opt.wrap_auto)
        return TZ_OK;
    for (int32_t i = 0; i < b->over.n; i++) {
        all++;
        matched += b->twin[b->over.v[i]] >= 0;
    }
    for (int32_t i = 0; i < b->flush.n; i++)
        if (is_piece(b, b->flush.v[i].element)) {
            all++;
            matched += b->flush.v[i].pair >= 0;
        }
    if (all >= 2 && matched >= 0.8 * all) {
        *torus = true;
        return TZ_OK;
    }
    return repeats(b, torus);
}

/* ---- joining ----------------------------------------------------------------------- */

/** Parts of element i moved by a shift, as items of a thing under way. */
static tz_status move_parts(tz_element_reader *r, int32_t i, tz_vec2 by)
{
    const tz_thing t = r->thing.v[i];
    const tz_affine map = tz_affine_then(t.map, (tz_affine){1, 0, 0, 1, by.x, by.y});
    const double scale = sqrt(fabs(tz_affine_det(t.map)));
    tz_status s = TZ_OK;
    for (int32_t k = 0; k < t.items && s == TZ_OK; k++) {
        tz_part p = r->part.v[r->item.v[t.item + k]];
        const int32_t first = p.point;
        p.point = r->point.n;
        p.box = tz_box_empty();
        p.look.width *= scale;
        for (int32_t q = 0; q < p.points && s == TZ_OK; q++) {
            const tz_vec2 at = tz_affine_apply(map, r->point.v[first + q]);
            s = tz_array_push(r->ctx, &r->point, at);
            tz_box_add(&p.box, at);
        }
        if (s == TZ_OK)
            s = tz_array_push(r->ctx, &r->part, p);
        if (s == TZ_OK)
            s = tz_array_push(r->ctx, &r->item, r->part.n - 1);
    }
    return s;
}

/** One thing of piece i and all that hangs on it. seen[] holds what has been taken. */
static tz_status join_from(border *b, int32_t i, bool *seen, tz_vec2 *shift,
                           int32_t *stack)
{
    tz_element_reader *r = b->r;
    tz_thing t = r->thing.v[i];
    int32_t n = 1;
    tz_status s = TZ_OK;
    t.item = r->item.n;
    t.map = tz_affine_identity();
    t.use = false;
    stack[0] = i;
    shift[i] = (tz_vec2){0, 0};
    seen[i] = true;
    while (n > 0 && s == TZ_OK) {
        const int32_t at = stack[--n];
        s = move_parts(r, at, shift[at]);
        for (int32_t k = 0; k < b->flush.n; k++) {
            const flush *f = &b->flush.v[k];
            if (f->element != at || f->pair < 0 || seen[b->flush.v[f->pair].element])
                continue;
            const int32_t to = b->flush.v[f->pair].element;
            const double w = f->side % 2 ? 1 : -1; /* onto which side it moves */
            shift[to] = shift[at];
            if (f->side < 2)
                shift[to].x += w * r->view.x;
            else
                shift[to].y += w * r->view.y;
            seen[to] = true;
            stack[n++] = to;
        }
    }
    t.items = r->item.n - t.item;
    return s == TZ_OK ? tz_array_push(r->ctx, &r->thing, t) : s;
}

/** Makes things of the pieces that fit together; seen[i] is set for each of them. */
static tz_status join_pieces(border *b, bool *seen)
{
    tz_element_reader *r = b->r;
    const int32_t n = r->set.element.n;
    tz_vec2 *shift = NULL;
    int32_t *stack = NULL;
    tz_status s = tz_alloc(r->ctx, &shift, (size_t)n, sizeof *shift);
    if (s == TZ_OK)
        s = tz_alloc(r->ctx, &stack, (size_t)n, sizeof *stack);
    for (int32_t i = 0; i < b->flush.n && s == TZ_OK; i++)
        if (b->flush.v[i].pair >= 0 && !seen[b->flush.v[i].element])
            s = join_from(b, b->flush.v[i].element, seen, shift, stack);
    tz_free(r->ctx, shift);
    tz_free(r->ctx, stack);
    return s;
}

/** Takes out the elements that are marked. */
static void drop(tz_element_reader *r, const bool *gone, int32_t n)
{
    int32_t kept = 0;
    for (int32_t i = 0; i < r->set.element.n; i++) {
        if (i < n && gone[i])
            continue;
        r->set.element.v[kept] = r->set.element.v[i];
        r->thing.v[kept++] = r->thing.v[i];
    }
    r->set.element.n = r->thing.n = kept;
}

static bool in_view(const tz_element_reader *r, int32_t i)
{
    const tz_vec3 p = r->set.element.v[i].at;
    return p.x >= 0 && p.y >= 0 && p.x < r->view.x && p.y < r->view.y;
}

/** Of twins the one stays whose centre lies in the view, else the first. */
static void mark_twins(border *b, bool *gone, int32_t *best)
{
    for (int32_t k = 0; k < b->over.n; k++)
        best[b->over.v[k]] = -1;
    for (int32_t k = 0; k < b->over.n; k++) {
        const int32_t i = b->over.v[k], t = b->twin[i];
        if (t < 0)
            continue;
        if (best[t] < 0 || (!in_view(b->r, best[t]) && in_view(b->r, i))) {
            if (best[t] >= 0)
                gone[best[t]] = true;
            best[t] = i;
        } else {
            gone[i] = true;
        }
    }
}

static tz_status make_torus(border *b)
{
    tz_element_reader *r = b->r;
    const int32_t n = r->set.element.n;
    bool *gone = NULL;
    int32_t *best = NULL;
    r->set.domain.torus = true;
    for (int32_t i = 0; i < b->flush.n; i++)
        if (b->flush.v[i].pair < 0 && is_piece(b, b->flush.v[i].element))
            r->set.element.v[b->flush.v[i].element].cut = true;
    tz_status s = tz_alloc_zero(r->ctx, &gone, (size_t)n, sizeof *gone);
    if (s == TZ_OK)
        s = tz_alloc(r->ctx, &best, (size_t)n, sizeof *best);
    if (s == TZ_OK)
        s = join_pieces(b, gone);
    if (s == TZ_OK)
        s = tz_element_symbols(r, n);
    if (s == TZ_OK) {
        mark_twins(b, gone, best);
        drop(r, gone, n);
    }
    for (int32_t i = 0; i < r->set.element.n && s == TZ_OK; i++)
        r->set.element.v[i].at = tz_domain_wrap(&r->set.domain, r->set.element.v[i].at);
    tz_free(r->ctx, gone);
    tz_free(r->ctx, best);
    return s;
}

tz_status tz_element_wrap(tz_element_reader *r)
{
    border b = {.r = r};
    bool torus = false;
    if (r->set.element.n == 0)
        return TZ_OK;
    tz_status s = scan(&b);
    if (s == TZ_OK)
        match_pieces(&b);
    if (s == TZ_OK)
        s = match_twins(&b);
    if (s == TZ_OK)
        s = decide(&b, &torus);
    if (s == TZ_OK && torus)
        s = make_torus(&b);
    else if (s == TZ_OK)
        for (int32_t i = 0; i < r->set.element.n; i++)
            r->set.element.v[i].cut = b.is_over[i] || is_piece(&b, i);
    border_free(&b);
    return s;
}
