/* SPDX-License-Identifier: Apache-2.0 */
/* Which elements may show where: showings in drawing order, and lists of them by squares of
 * the canvas, of whole tiles. Squares are doubled until the lists are not much longer than
 * there are showings, so that a few huge elements on a huge canvas cost no more than many
 * small ones. */
#include <stdlib.h>
#include <string.h>

#include "synthesis/element_render_internal.h"

enum { COPIES_MAX = 4000000 };

static int by_depth(const void *a, const void *b, void *elements)
{
    const tz_element *e = elements;
    const int32_t i = *(const int32_t *)a, j = *(const int32_t *)b;
    if (e[i].depth != e[j].depth)
        return e[i].depth < e[j].depth ? -1 : 1;
    return (i > j) - (i < j);
}

static tz_status drawing_order(tz_ctx *ctx, const tz_element_set *set, int32_t **out)
{
    const int32_t n = set->element.n;
    int32_t *order = NULL;
    bool ordered = true;
    tz_status s = tz_alloc(ctx, &order, (size_t)n, sizeof *order);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < n; i++) {
        order[i] = i;
        ordered =
            ordered && (i == 0 || set->element.v[i - 1].depth <= set->element.v[i].depth);
    }
    if (!ordered)
        qsort_r(order, (size_t)n, sizeof *order, by_depth, set->element.v);
    *out = order;
    return TZ_OK;
}

/* ---- showings ------------------------------------------------------------------------ */

static tz_affine map_of(const tz_element_renderer *r, const tz_element *e)
{
    const double c = cos(e->angle) * e->scale, d = sin(e->angle) * e->scale;
    return (tz_affine){c * r->sx, d * r->sy,       -d * r->sx,
                       c * r->sy, e->at.x * r->sx, e->at.y * r->sy};
}

/* Where the level that a copy samples is noted. */
static void note_level(tz_element_renderer *r, int32_t symbol, tz_affine map, bool bent)
{
    tz_cutout *c = &r->cutout[symbol];
    const tz_cutout_view v = tz_cutout_look(c, &r->set->symbol.v[symbol], map);
    c->levels |= 1U << v.level;
    c->spline = c->spline || bent || !v.exact;
}

static tz_status add_showing(tz_ctx *ctx, tz_element_renderer *r, int32_t element,
                             tz_affine map, tz_bounds b)
{
    const tz_showing one = {element, map, b};
    if (r->index.showing.n >= COPIES_MAX)
        return tz_fail(ctx, TZ_LIMIT,
                       "layout: elements show at more than %d places of its canvas; "
                       "render a smaller one",
                       (int)COPIES_MAX);
    return tz_array_push(ctx, &r->index.showing, one);
}

/* Adds an element, on a torus wherever it shows. */
static tz_status add_element(tz_ctx *ctx, tz_element_renderer *r, int32_t i)
{
    const tz_element *e = &r->set->element.v[i];
    const tz_element_symbol *y = &r->set->symbol.v[e->symbol];
    const bool cut = tz_symbol_cut(y), torus = r->set->domain.torus;
    if (r->set->kind.v[e->kind].is_void || (!cut && r->kind != TZ_MAP_COLOUR))
        return TZ_OK;
    const tz_bounds local = cut ? r->cutout[e->symbol].local : r->drawing[e->symbol].box;
    tz_affine map = map_of(r, e);
    const double w = r->width, h = r->height;
    const tz_bent *bent = tz_bent_find(r, i);
    tz_bounds b = bent ? tz_bent_bounds(r, bent, map) : tz_bounds_map(local, map);
    if ((cut && r->cutout[e->symbol].empty) || !(b.x0 <= b.x1 && b.y0 <= b.y1))
        return TZ_OK;
    if (!(fabs(b.x0) < 1e9 && fabs(b.x1) < 1e9 && fabs(b.y0) < 1e9 && fabs(b.y1) < 1e9))
        return tz_fail(ctx, TZ_INVALID,
                       "layout: element %d reaches out of all bounds; scale it down or "
                       "move it",
                       (int)i);
    b.x0 -= 1, b.y0 -= 1, b.x1 += 1, b.y1 += 1;
    /* shifts k with b + k w over 0 .. w */
    const double i0 = torus ? ceil(-b.x1 / w) : 0, i1 = torus ? floor((w - b.x0) / w) : 0;
    const double j0 = torus ? ceil(-b.y1 / h) : 0, j1 = torus ? floor((h - b.y0) / h) : 0;
    if ((i1 - i0 + 1) * (j1 - j0 + 1) > 10000)
        return tz_fail(ctx, TZ_INVALID,
                       "layout: element %d is many times as large as the tile that it "
                       "wraps around; scale it down",
                       (int)i);
    tz_status s = TZ_OK;
    for (double j = j0; j <= j1 && s == TZ_OK; j++)
        for (double k = i0; k <= i1 && s == TZ_OK; k++) {
            const tz_bounds at = {b.x0 + k * w, b.y0 + j * h, b.x1 + k * w, b.y1 + j * h};
            tz_affine m = map;
            if (at.x1 <= 0 || at.y1 <= 0 || at.x0 >= w || at.y0 >= h)
                continue;
            m.e += k * w;
            m.f += j * h;
            s = add_showing(ctx, r, i, m, at);
            if (s == TZ_OK && cut)
                note_level(r, e->symbol, m, bent != NULL);
        }
    return s;
}

/* ---- squares ------------------------------------------------------------------------- */

static tz_rect squares_of(const tz_showing_index *ix, const tz_showing *p)
{
    const int32_t x0 = (int32_t)fmax(floor(p->box.x0 / ix->cell), 0),
                  y0 = (int32_t)fmax(floor(p->box.y0 / ix->cell), 0);
    const int32_t x1 = (int32_t)fmin(floor(p->box.x1 / ix->cell), ix->nx - 1),
                  y1 = (int32_t)fmin(floor(p->box.y1 / ix->cell), ix->ny - 1);
    return (tz_rect){x0, y0, x1 - x0 + 1, y1 - y0 + 1};
}

static void choose_cell(tz_showing_index *ix, int32_t width, int32_t height)
{
    for (ix->cell = TZ_ELEMENT_TILE;; ix->cell *= 2) {
        ix->nx = (width + ix->cell - 1) / ix->cell;
        ix->ny = (height + ix->cell - 1) / ix->cell;
        int64_t items = 0;
        for (int32_t i = 0; i < ix->showing.n; i++) {
            const tz_rect q = squares_of(ix, &ix->showing.v[i]);
            items += (int64_t)q.w * q.h;
        }
        if (ix->nx * ix->ny == 1 || (items <= 6 * (int64_t)ix->showing.n + 65536 &&
                                     (int64_t)ix->nx * ix->ny <= 1 << 20))
            return;
    }
}

static tz_status sort_into_squares(tz_ctx *ctx, tz_showing_index *ix)
{
    const int64_t cells = (int64_t)ix->nx * ix->ny;
    tz_status s = tz_alloc_zero(ctx, &ix->first, (size_t)cells + 2, sizeof *ix->first);
    for (int pass = 0; pass < 2 && s == TZ_OK; pass++) {
        int64_t *count = ix->first + 2 - pass; /* pass 1: counts up to the next one's */
        for (int32_t i = 0; i < ix->showing.n; i++) {
            const tz_rect q = squares_of(ix, &ix->showing.v[i]);
            for (int32_t y = q.y; y < q.y + q.h; y++)
                for (int32_t x = q.x; x < q.x + q.w; x++) {
                    int64_t *c = &count[(int64_t)y * ix->nx + x];
                    if (pass)
                        ix->item[*c] = i;
                    (*c)++;
                }
        }
        if (pass)
            break;
        for (int64_t k = 2; k < cells + 2; k++)
            ix->first[k] += ix->first[k - 1];
        s = tz_alloc(ctx, &ix->item, (size_t)ix->first[cells + 1], sizeof *ix->item);
    }
    return s;
}

tz_status tz_showing_index_init(tz_ctx *ctx, tz_element_renderer *r)
{
    tz_showing_index *ix = &r->index;
    int32_t *order = NULL;
    tz_status s = drawing_order(ctx, r->set, &order);
    if (s == TZ_OK && r->set->background && r->kind == TZ_MAP_COLOUR) {
        const tz_affine map = {r->sx, 0, 0, r->sy, 0, 0};
        s = add_showing(ctx, r, -1, map, (tz_bounds){0, 0, r->width, r->height});
    }
    for (int32_t i = 0; i < r->set->element.n && s == TZ_OK; i++)
        s = add_element(ctx, r, order[i]);
    if (s == TZ_OK) {
        choose_cell(ix, r->width, r->height);
        s = sort_into_squares(ctx, ix);
    }
    tz_free(ctx, order);
    return s;
}

void tz_showing_index_deinit(tz_ctx *ctx, tz_showing_index *ix)
{
    tz_array_free(ctx, &ix->showing);
    tz_free(ctx, ix->first);
    tz_free(ctx, ix->item);
    *ix = (tz_showing_index){0};
}
