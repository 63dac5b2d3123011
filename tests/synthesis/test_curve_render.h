/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Sets of curves made by hand, and short ways to render them. Whatever fails ends the
 * running cmocka test. */
#ifndef TZ_TESTS_CURVE_RENDER_H
#define TZ_TESTS_CURVE_RENDER_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/rng.h"
#include "synthesis/curve_render.h"
#include "tests/support/pictures.h"
#include "tests/support/scenes.h"

#define OK(call) assert_int_equal((call), TZ_OK)

static inline void curves_init(tz_ctx *ctx, tz_curve_set *s, double w, double h,
                               bool torus)
{
    *s = (tz_curve_set){
        .domain = {.size = {w, h, 0}, .torus = torus},
        .ctx = ctx,
        .element = {.domain = {.size = {w, h, 0}, .torus = torus}, .ctx = ctx}};
}

static inline int32_t curves_pen(tz_curve_set *s, double width, uint32_t color,
                                 uint32_t cap, uint32_t join)
{
    int32_t id = 0;
    OK(tz_curve_add_pen(s, (tz_curve_pen){width, color, cap, join}, &id));
    return id;
}

/** A path of straight pieces through n points. */
static inline void curves_line(tz_curve_set *s, int32_t pen, const tz_vec2 *p, int32_t n,
                               bool closed)
{
    int32_t first = 0, last = 0, next = 0;
    OK(tz_curve_begin(s, pen));
    OK(tz_curve_add_node(s, p[0], &first));
    last = first;
    for (int32_t i = 1; i < n; i++) {
        OK(tz_curve_add_node(s, p[i], &next));
        OK(tz_curve_line(s, last, next));
        last = next;
    }
    if (closed)
        OK(tz_curve_line(s, last, first));
    tz_curve_end(s, closed);
}

/** A path of one cubic. */
static inline void curves_cubic(tz_curve_set *s, int32_t pen, tz_vec2 p, tz_vec2 a,
                                tz_vec2 b, tz_vec2 q)
{
    int32_t from = 0, to = 0;
    OK(tz_curve_begin(s, pen));
    OK(tz_curve_add_node(s, p, &from));
    OK(tz_curve_add_node(s, q, &to));
    OK(tz_curve_cubic(s, from, to, a, b));
    tz_curve_end(s, false);
}

/** n wild paths of up to four pieces, straight and cubic, some closed, in four pens of
 * which two let shine through; some lie partly outside. */
static inline void curves_scatter(tz_curve_set *s, int32_t n, uint64_t seed)
{
    static const uint32_t color[4] = {0x203040ff, 0xc0402080, 0x2080c0ff, 0x40a04060};
    tz_rng rng = tz_rng_make(seed, 5);
    const double w = s->domain.size.x, h = s->domain.size.y;
    for (int32_t i = 0; i < n; i++) {
        const int32_t pen = curves_pen(s, 0.6 + 1.7 * (i % 4), color[i % 4],
                                       (uint32_t)i % 3, (uint32_t)(i / 3) % 3);
        const double x = tz_rng_range(&rng, -8, w + 8), y = tz_rng_range(&rng, -8, h + 8);
        tz_vec2 p[5];
        for (int k = 0; k < 5; k++)
            p[k] = (tz_vec2){x + tz_rng_range(&rng, -30, 30),
                             y + tz_rng_range(&rng, -30, 30)};
        if (i % 3)
            curves_cubic(s, pen, p[0], p[1], p[2], p[3]);
        else
            curves_line(s, pen, p, 2 + tz_rng_below(&rng, 4), i % 2 == 1 && i % 4);
    }
    if (s->domain.torus)
        tz_curve_wrap(s);
}

/** A net of `n` x `n` meshes over the whole domain, a path each line, joined at nodes, bent
 * by `amount`. */
static inline void curves_net(tz_curve_set *s, int32_t pen, int32_t n)
{
    const double w = s->domain.size.x, h = s->domain.size.y;
    const int32_t base = s->node.n;
    for (int32_t j = 0; j <= n; j++)
        for (int32_t i = 0; i <= n; i++) {
            int32_t id;
            const double wave = 2.5 * sin(1.7 * i + 2.9 * j);
            OK(tz_curve_add_node(s,
                                 (tz_vec2){w * (0.04 + 0.92 * i / n) + wave,
                                           h * (0.04 + 0.92 * j / n) - wave},
                                 &id));
        }
    for (int side = 0; side < 2; side++)
        for (int32_t k = 0; k <= n; k++) {
            OK(tz_curve_begin(s, pen));
            for (int32_t m = 0; m < n; m++) {
                const int32_t a = base + (side ? m * (n + 1) + k : k * (n + 1) + m),
                              b = base +
                                  (side ? (m + 1) * (n + 1) + k : k * (n + 1) + m + 1);
                const tz_vec2 p = s->node.v[a], q = s->node.v[b];
                OK(tz_curve_cubic(
                    s, a, b,
                    (tz_vec2){p.x + (q.x - p.x) / 3 + (side ? 3 : 0),
                              p.y + (q.y - p.y) / 3 - (side ? 0 : 3)},
                    (tz_vec2){p.x + (q.x - p.x) / 1.5, p.y + (q.y - p.y) / 1.5}));
            }
            tz_curve_end(s, false);
        }
}

/** Keeps the curves that the set has now as its origins. */
static inline void curves_keep(tz_curve_set *s)
{
    for (int32_t i = 0; i < s->piece.n; i++)
        OK(tz_array_push(s->ctx, &s->origin, tz_curve_bezier(s, &s->piece.v[i])));
}

/** Moves all nodes and control points by a map. */
static inline void curves_map(tz_curve_set *s, tz_affine m)
{
    for (int32_t i = 0; i < s->node.n; i++)
        s->node.v[i] = tz_affine_apply(m, s->node.v[i]);
    for (int32_t i = 0; i < s->piece.n; i++) {
        tz_curve_piece *p = &s->piece.v[i];
        p->a = tz_affine_apply(m, p->a);
        p->b = tz_affine_apply(m, p->b);
        if (p->straight) {
            const tz_bezier b =
                tz_bezier_line(s->node.v[p->from], tz_curve_piece_end(s, p));
            p->a = b.p[1];
            p->b = b.p[2];
        }
    }
}

/** Bends it by a wave. */
static inline void curves_wave(tz_curve_set *s, double amount)
{
    for (int32_t i = 0; i < s->node.n; i++) {
        s->node.v[i].x += amount * sin(s->node.v[i].y / 17);
        s->node.v[i].y += amount * cos(s->node.v[i].x / 23);
    }
    for (int32_t i = 0; i < s->piece.n; i++) {
        tz_curve_piece *p = &s->piece.v[i];
        p->a.x += amount * sin(p->a.y / 17), p->a.y += amount * cos(p->a.x / 23);
        p->b.x += amount * sin(p->b.y / 17), p->b.y += amount * cos(p->b.x / 23);
        p->straight = false;
    }
}

typedef struct look {
    const tz_element_ground *ground;
    const tz_element_pixels *photo;
    tz_map_kind kind;
    double scale, strip;
} look;

static inline tz_curve_composer *composer_of(tz_ctx *ctx, const tz_curve_set *s,
                                             const look *l)
{
    tz_curve_composer *c = NULL;
    tz_curve_render_params p;
    tz_params_default(&tz_curve_render_param_table, &p);
    p.scale = l->scale > 0 ? l->scale : 1;
    p.strip = l->strip;
    const tz_status st =
        tz_curve_composer_new(ctx, l->ground, s, l->photo, l->kind, &p, &c);
    if (st != TZ_OK)
        fail_msg("%s", tz_ctx_message(ctx));
    return c;
}

static inline tz_image part_of(tz_ctx *ctx, const tz_curve_composer *c, tz_rect r)
{
    tz_image im;
    OK(tz_curve_composer_image(ctx, c, r.w, r.h, &im));
    for (int32_t y = 0; y < r.h; y++) /* all of it is overwritten */
        for (int32_t x = 0; x < r.w * im.channels; x++)
            tz_image_at(&im, 0, y)[x] = 0.123F;
    OK(tz_curve_composer_render(ctx, c, r, &im));
    return im;
}

static inline tz_image curves_drawn(tz_ctx *ctx, const tz_curve_set *s, const look *l)
{
    int32_t w, h;
    tz_curve_composer *c = composer_of(ctx, s, l);
    tz_curve_composer_size(c, &w, &h);
    tz_image im = part_of(ctx, c, (tz_rect){0, 0, w, h});
    tz_curve_composer_free(c);
    return im;
}

#endif
