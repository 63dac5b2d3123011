/* SPDX-License-Identifier: Apache-2.0 */
/* Figures of a layout, by outlines as they are drawn, on a raster: what is covered, what
 * two things share, the largest empty disc; and by angles: to strokes, between
 * neighbours. */
#include <math.h>
#include <stdlib.h>

#include "base/kdtree.h"
#include "elements/bend.h"
#include "elements/extent.h"
#include "elements/guide.h"
#include "fields/fill.h"

enum { SIDE = 1024, NEAR = 6 };

typedef struct cover {
    tz_raster raster;
    uint8_t *count;
    int32_t *last; /* element that a cell has counted last: each counts once, whatever it
                      paints there */
    int32_t element;
} cover;

static void add_span(void *user, int32_t row, int32_t x0, int32_t x1)
{
    cover *c = user;
    const ptrdiff_t line = (ptrdiff_t)row * c->raster.width;
    for (ptrdiff_t i = line + x0; i < line + x1; i++) {
        if (c->last[i] != c->element)
            c->count[i] = (uint8_t)(c->count[i] + (c->count[i] < 255));
        c->last[i] = c->element;
    }
}

/* Outline of an element in the world. */
static tz_status outline_of(tz_ctx *ctx, const tz_element_set *set, tz_bend_rests *rests,
                            int32_t i, tz_polys *polys)
{
    enum { ROUND = 64 };
    const tz_element_symbol *y = &set->symbol.v[set->element.v[i].symbol];
    tz_bend b;
    tz_status s = tz_bend_rests_warp(rests, i, &b);
    if (s != TZ_OK)
        return s;
    tz_polys_clear(polys);
    const bool disc = y->outline.n < 3 || y->part.n < 1;
    for (int32_t k = 0; k < (disc ? ROUND : y->outline.n) && s == TZ_OK; k++) {
        const double a = 2 * TZ_PI * k / ROUND;
        const tz_vec2 p =
            disc ? (tz_vec2){y->radius * cos(a), y->radius * sin(a)} : y->outline.v[k];
        s = tz_array_push(ctx, &polys->point, tz_bend_apply(&b, p));
    }
    for (int32_t k = 0; k < (disc ? 1 : y->part.n) && s == TZ_OK; k++)
        s = tz_array_push(ctx, &polys->part, disc ? 0 : y->part.v[k]);
    tz_bend_deinit(&b);
    return s;
}

/* The silhouette: the union of all polygons. */
static tz_status add_polygons(tz_ctx *ctx, cover *c, const tz_polys *polys, double x,
                              double y)
{
    tz_polys one = {0};
    const int32_t zero = 0;
    tz_status s = tz_array_push(ctx, &one.part, zero);
    for (int32_t k = 0; k < polys->part.n && s == TZ_OK; k++) {
        const int32_t to = k + 1 < polys->part.n ? polys->part.v[k + 1] : polys->point.n;
        one.point.n = 0;
        for (int32_t i = polys->part.v[k]; i < to && s == TZ_OK; i++)
            s = tz_array_push(
                ctx, &one.point,
                ((tz_vec2){polys->point.v[i].x + x, polys->point.v[i].y + y}));
        if (s == TZ_OK)
            s = tz_guide_fill(ctx, &c->raster, &one, true, add_span, c);
    }
    tz_polys_deinit(ctx, &one);
    return s;
}

static tz_status add_element(tz_ctx *ctx, const tz_element_set *set, cover *c,
                             tz_polys *polys)
{
    const tz_vec3 size = set->domain.size;
    tz_box box = tz_box_empty();
    tz_status s = TZ_OK;
    for (int32_t k = 0; k < polys->point.n; k++)
        tz_box_add(&box, polys->point.v[k]);
    const int32_t few = set->domain.torus;
    for (int32_t v = -few; v <= few && s == TZ_OK; v++)
        for (int32_t u = -few; u <= few && s == TZ_OK; u++) {
            const double x = u * size.x, y = v * size.y;
            if (box.x1 + x < 0 || box.y1 + y < 0 || box.x0 + x > size.x ||
                box.y0 + y > size.y)
                continue;
            s = add_polygons(ctx, c, polys, x, y);
        }
    return s;
}

static tz_status count_cells(tz_ctx *ctx, const tz_element_set *set, cover *c,
                             tz_fill_report *r)
{
    const tz_raster *g = &c->raster;
    const size_t n = (size_t)g->width * (size_t)g->height;
    float *empty = NULL;
    tz_region *region = NULL;
    double inside = 0, covered = 0, all = 0, twice = 0, out = 0, hole = 0;
    bool any = false;
    tz_status s = tz_alloc(ctx, &empty, n, sizeof *empty);
    for (size_t i = 0; i < n && s == TZ_OK; i++) {
        const tz_vec3 at = {
            ((double)(i % (size_t)g->width) + 0.5) * g->size.x / g->width,
            ((double)(i / (size_t)g->width) + 0.5) * g->size.y / g->height, 0};
        const bool in = tz_domain_contains(&set->domain, at);
        inside += in, covered += in && c->count[i];
        out += in ? 0 : c->count[i];
        all += c->count[i], twice += c->count[i] > 1 ? c->count[i] - 1 : 0;
        empty[i] = in && !c->count[i];
        any = any || empty[i] > 0;
    }
    if (s == TZ_OK && any)
        s = tz_region_from_mask(ctx, empty, g->width, g->height, g->size,
                                set->domain.torus, &region);
    for (size_t i = 0; i < n && region; i++)
        hole = fmax(hole, (double)region->distance[i]);
    tz_region_free(region);
    tz_free(ctx, empty);
    r->covered = inside > 0 ? covered / inside : 0;
    r->overlap = all > 0 ? twice / all : 0;
    r->outside = all > 0 ? out / all : 0;
    r->hole = hole;
    return s;
}

static double turn_between(double a, double b)
{
    return fabs(remainder(a - b, 2 * TZ_PI));
}

/* Which way an element points; false for round ones. */
static bool points(const tz_element_set *set, const tz_element_set *palette,
                   const tz_extents *x, int32_t i, double *angle)
{
    const tz_element *e = &set->element.v[i];
    float least = x->v[e->symbol].r[0], most = least;
    for (int k = 1; k < TZ_EXTENT_DIRECTIONS; k++) {
        least = fminf(least, x->v[e->symbol].r[k]);
        most = fmaxf(most, x->v[e->symbol].r[k]);
    }
    *angle = e->angle;
    if (palette && e->source >= 0 && e->source < palette->element.n)
        *angle -= palette->element.v[e->source].angle;
    return least < 0.95f * most;
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Angles between each thing and its nearest ones. */
static tz_status measure_neighbours(tz_ctx *ctx, const float *p, const double *angle,
                                    int32_t n, tz_fill_report *r)
{
    tz_kdtree tree = {0};
    double *turn = NULL, sum = 0, square = 0, far = 0;
    ptrdiff_t pairs = 0;
    if (n < 2)
        return TZ_OK;
    tz_status s = tz_alloc(ctx, &turn, (size_t)n * NEAR, sizeof *turn);
    if (s == TZ_OK)
        s = tz_kdtree_init(ctx, &tree, p, n, 2);
    for (int32_t i = 0; i < n && s == TZ_OK; i++) {
        int32_t id[NEAR + 1];
        float d2[NEAR + 1];
        const int32_t k =
            tz_kdtree_nearest(&tree, &p[2 * (ptrdiff_t)i], NEAR + 1, id, d2);
        for (int32_t j = 0, found = 0; j < k; j++) {
            if (id[j] == i || found == NEAR) /* places may coincide */
                continue;
            found++;
            const double t = turn_between(angle[i], angle[id[j]]);
            sum += t, square += t * t, far += sqrt((double)d2[j]);
            turn[pairs++] = t;
        }
    }
    if (s == TZ_OK) {
        qsort(turn, (size_t)pairs, sizeof *turn, compare);
        r->turn = sum / (double)pairs, r->turn_rms = sqrt(square / (double)pairs);
        r->turn_95 = turn[(ptrdiff_t)(0.95 * (double)(pairs - 1))];
        r->spacing = far / (double)pairs;
    }
    tz_kdtree_deinit(&tree);
    tz_free(ctx, turn);
    return s;
}

static tz_status measure_turns(tz_ctx *ctx, const tz_element_set *set,
                               const tz_element_set *palette,
                               const tz_element_field *field, tz_fill_report *r)
{
    int32_t n = 0;
    float *p = NULL;
    double *angle = NULL, align = 0, said = 0;
    tz_extents extents = {0};
    const size_t room = (size_t)set->element.n;
    tz_status s = tz_alloc(ctx, &p, 2 * room, sizeof *p);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &angle, room, sizeof *angle);
    if (s == TZ_OK)
        s = tz_extents_init(ctx, set, &extents);
    for (int32_t i = 0; i < set->element.n && s == TZ_OK; i++) {
        const tz_vec3 at = tz_domain_wrap(&set->domain, set->element.v[i].at);
        if (!points(set, palette, &extents, i, &angle[n]))
            continue;
        p[2 * (ptrdiff_t)n] = (float)at.x, p[2 * (ptrdiff_t)n + 1] = (float)at.y;
        const tz_element_field_cell *c =
            field ? tz_element_field_at(field, (tz_vec3){at.x, at.y, 0}) : NULL;
        if (c && (c->x != 0 || c->y != 0)) {
            const double a = turn_between(angle[n], atan2((double)c->y, (double)c->x));
            align += a, said++;
            r->align_most = fmax(r->align_most, a);
        }
        n++;
    }
    r->align = said > 0 ? align / said : 0;
    if (s == TZ_OK)
        s = measure_neighbours(ctx, p, angle, n, r);
    tz_extents_deinit(&extents);
    tz_free(ctx, p);
    tz_free(ctx, angle);
    return s;
}

tz_status tz_fill_measure(tz_ctx *ctx, const tz_element_set *layout,
                          const tz_element_set *palette, const tz_element_field *field,
                          int32_t side, tz_fill_report *r)
{
    cover c = {.count = NULL, .last = NULL};
    tz_polys polys = {0};
    tz_bend_rests rests = {0};
    *r = (tz_fill_report){.elements = layout->element.n};
    tz_status s = tz_guide_raster(ctx, layout->domain.size, layout->domain.torus,
                                  side > 0 ? side : SIDE, &c.raster);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &c.count, (size_t)c.raster.width * (size_t)c.raster.height,
                          1);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &c.last, (size_t)c.raster.width * (size_t)c.raster.height,
                          sizeof *c.last);
    if (s == TZ_OK)
        s = tz_bend_rests_init(ctx, layout, &rests);
    for (int32_t i = 0; i < layout->element.n && s == TZ_OK; i++) {
        if (layout->kind.v[layout->element.v[i].kind].is_void)
            continue;
        c.element = i + 1;
        s = outline_of(ctx, layout, &rests, i, &polys);
        if (s == TZ_OK)
            s = add_element(ctx, layout, &c, &polys);
    }
    if (s == TZ_OK)
        s = count_cells(ctx, layout, &c, r);
    if (s == TZ_OK)
        s = measure_turns(ctx, layout, palette, field, r);
    tz_polys_deinit(ctx, &polys);
    if (rests.ctx)
        tz_bend_rests_deinit(&rests);
    tz_free(ctx, c.count);
    tz_free(ctx, c.last);
    return s;
}
