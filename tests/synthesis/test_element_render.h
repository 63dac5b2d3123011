/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Sets of elements made by hand, and short ways to render them. Whatever fails ends the
 * running cmocka test. */
#ifndef TZ_TESTS_ELEMENT_RENDER_H
#define TZ_TESTS_ELEMENT_RENDER_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/rng.h"
#include "synthesis/element_compose.h"
#include "tests/support/pictures.h"
#include "tests/support/scenes.h"

#define OK(call) assert_int_equal((call), TZ_OK)

/** Empty set with one kind. */
static inline void set_init(tz_ctx *ctx, tz_element_set *s, double w, double h,
                            bool torus)
{
    *s = (tz_element_set){.domain = {.size = {w, h, 0}, .torus = torus}, .ctx = ctx};
    tz_element_kind k = {.oriented = true};
    OK(tz_strdup(ctx, "thing", &k.name));
    OK(tz_array_push(ctx, &s->kind, k));
}

static inline int32_t set_symbol(tz_element_set *s, const char *markup, double radius)
{
    tz_element_symbol y = {.radius = radius};
    char id[32];
    snprintf(id, sizeof id, "s%d", s->symbol.n);
    OK(tz_strdup(s->ctx, id, &y.id));
    OK(tz_strdup(s->ctx, markup, &y.markup));
    OK(tz_array_push(s->ctx, &s->symbol, y));
    return s->symbol.n - 1;
}

/** A disc cut from photo 0, in units of its px. */
static inline int32_t set_disc(tz_element_set *s, double x, double y, double radius)
{
    enum { POINTS = 256 };
    const int32_t k = set_symbol(s, "", radius);
    tz_element_symbol *sy = &s->symbol.v[k];
    sy->photo_scale = 1;
    sy->photo_at = (tz_vec2){x, y};
    for (int i = 0; i < POINTS; i++) {
        const double a = 2 * TZ_PI * i / POINTS;
        OK(tz_array_push(s->ctx, &sy->outline,
                         ((tz_vec2){radius * cos(a), radius * sin(a)})));
    }
    OK(tz_array_push(s->ctx, &sy->part, 0));
    return k;
}

static inline void set_photo(tz_element_set *s, int32_t width, int32_t height)
{
    tz_element_photo f = {.width = width, .height = height};
    OK(tz_strdup(s->ctx, "photo.png", &f.path));
    OK(tz_array_push(s->ctx, &s->photo, f));
}

static inline tz_element *set_add(tz_element_set *s, int32_t symbol, double x, double y,
                                  double angle, double scale)
{
    const tz_element e = {.symbol = symbol,
                          .source = -1,
                          .sample = s->sample.n,
                          .samples = 1,
                          .at = {x, y, 0},
                          .angle = angle,
                          .scale = scale,
                          .radius = s->symbol.v[symbol].radius * scale};
    OK(tz_array_push(s->ctx, &s->sample, ((tz_sample){e.at, 0, 1})));
    OK(tz_array_push(s->ctx, &s->element, e));
    return &s->element.v[s->element.n - 1];
}

/** n elements anywhere, of all symbols in turn. */
static inline void set_scatter(tz_element_set *s, int32_t n, uint64_t seed, double lo,
                               double hi)
{
    tz_rng rng = tz_rng_make(seed, 1);
    for (int32_t i = 0; i < n; i++) {
        const double x = tz_rng_range(&rng, -5, s->domain.size.x + 5),
                     y = tz_rng_range(&rng, -5, s->domain.size.y + 5);
        tz_element *e = set_add(s, i % s->symbol.n, x, y, tz_rng_range(&rng, -4, 4),
                                tz_rng_range(&rng, lo, hi));
        e->depth = tz_rng_below(&rng, 5);
    }
}

static const char leaf[] = "<path d=\"M-10 0C-6 -7 5 -7 10 0C5 7 -6 7 -10 0Z\" "
                           "fill=\"#3c7a3a\"/><path d=\"M-10 0L9 0\" fill=\"none\" "
                           "stroke=\"#1d4a20\" stroke-width=\"0.6\"/>";
static const char bow[] = "<path d=\"M-9 0C-4 -9 4 9 9 0\" fill=\"none\" "
                          "stroke=\"#2f6cad\" stroke-width=\"2\" "
                          "stroke-linecap=\"round\"/>";
static const char ring[] =
    "<path d=\"M-8 -8L8 -8L8 8L-8 8ZM-4 -4L-4 4L4 4L4 -4Z\" "
    "fill=\"#c9522f\" fill-opacity=\"0.7\" fill-rule=\"evenodd\"/>";
/* what only librsvg draws */
static const char glow[] =
    "<radialGradient id=\"a\"><stop stop-color=\"#fe8\"/><stop offset=\"1\" "
    "stop-color=\"#a20\"/></radialGradient><g opacity=\"0.8\"><circle r=\"9\" "
    "fill=\"url(#a)\"/><rect x=\"-4\" y=\"-2\" width=\"8\" height=\"4\"/></g>";

static inline tz_element_renderer *renderer_of(tz_ctx *ctx, const tz_element_set *s,
                                               const tz_element_pixels *p,
                                               tz_map_kind kind,
                                               const tz_element_render_params *params)
{
    tz_element_renderer *r = NULL;
    const tz_status st = tz_element_renderer_new(ctx, s, p, kind, params, &r);
    if (st != TZ_OK)
        fail_msg("%s", tz_ctx_message(ctx));
    return r;
}

/** Rectangle of it over an empty backdrop, with alpha, linear. */
static inline tz_image over_nothing(tz_ctx *ctx, const tz_element_renderer *r,
                                    tz_rect rect)
{
    tz_image im = blank(ctx, rect.w, rect.h, tz_element_renderer_colours(r) + 1);
    im.encoding = TZ_ENCODING_LINEAR;
    OK(tz_element_renderer_render(ctx, r, rect, &im));
    return im;
}

/** The whole set so. */
static inline tz_image drawn(tz_ctx *ctx, const tz_element_set *s, double scale)
{
    tz_element_render_params p;
    int32_t w, h;
    tz_params_default(&tz_element_render_param_table, &p);
    p.scale = scale;
    tz_element_renderer *r = renderer_of(ctx, s, NULL, TZ_MAP_COLOUR, &p);
    tz_element_renderer_size(r, &w, &h);
    tz_image im = over_nothing(ctx, r, (tz_rect){0, 0, w, h});
    tz_element_renderer_free(r);
    return im;
}

static inline double sum_of(const tz_image *im, int32_t channel)
{
    double sum = 0;
    for (int32_t y = 0; y < im->height; y++)
        for (int32_t x = 0; x < im->width; x++)
            sum += tz_image_at(im, x, y)[channel];
    return sum;
}

#endif
