/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/support/elements.h"

#include <string.h>

#include "base/rng.h"

tz_status drawn_set(tz_ctx *ctx, double width, double height, bool torus, int32_t kinds,
                    tz_element_set *s)
{
    tz_element_symbol y = {.radius = 1};
    memset(s, 0, sizeof *s);
    s->ctx = ctx;
    s->domain = (tz_domain){.size = {width, height, 0}, .torus = torus};
    tz_status st = tz_array_reserve(ctx, &s->symbol, 1);
    if (st == TZ_OK) /* owned by the set from here, whole or not */
        s->symbol.v[s->symbol.n++] = y;
    if (st == TZ_OK)
        st = tz_strdup(ctx, "disc", &s->symbol.v[0].id);
    if (st == TZ_OK)
        st = tz_strdup(ctx, "", &s->symbol.v[0].markup);
    for (int32_t k = 0; k < kinds && st == TZ_OK; k++) {
        st = tz_array_push(ctx, &s->kind, (tz_element_kind){0});
        if (st == TZ_OK)
            st = tz_strdup(ctx, "kind", &s->kind.v[k].name);
    }
    if (st != TZ_OK)
        tz_element_set_deinit(s);
    return st;
}

tz_status drawn_add(tz_element_set *s, double x, double y, double radius, int32_t kind,
                    double angle)
{
    const tz_element e = {.kind = kind,
                          .source = -1,
                          .sample = s->sample.n,
                          .samples = 1,
                          .at = {x, y, 0},
                          .angle = angle,
                          .scale = radius,
                          .radius = radius};
    const tz_sample p = {{x, y, 0}, 0, 1};
    tz_status st = tz_array_reserve(s->ctx, &s->element, (int64_t)s->element.n + 1);
    if (st == TZ_OK)
        st = tz_array_push(s->ctx, &s->sample, p);
    if (st == TZ_OK)
        s->element.v[s->element.n++] = e;
    return st;
}

static tz_status done(tz_status st, tz_element_set *s)
{
    if (st != TZ_OK)
        tz_element_set_deinit(s);
    return st;
}

tz_status drawn_hexagons(tz_ctx *ctx, int32_t nx, int32_t ny, double jitter, bool torus,
                         tz_element_set *s)
{
    const double row = 5 * sqrt(3);
    tz_rng r = tz_rng_make(9, 1);
    tz_status st = drawn_set(ctx, 10 * nx, row * ny, torus, 1, s);
    for (int32_t i = 0; i < nx * ny && st == TZ_OK; i++) {
        const double x = 2.5 + i % nx * 10 + (i / nx % 2) * 5;
        const double dx = jitter * tz_rng_normal(&r), dy = jitter * tz_rng_normal(&r);
        st = drawn_add(s, x + dx, row * (i / nx + 0.5) + dy, 4.5, 0, 0);
    }
    return done(st, s);
}

tz_status drawn_squares(tz_ctx *ctx, int32_t n, int32_t kinds, bool torus,
                        tz_element_set *s)
{
    tz_status st = drawn_set(ctx, 10 * n, 10 * n, torus, kinds, s);
    for (int32_t i = 0; i < n * n && st == TZ_OK; i++)
        st = drawn_add(s, 5 + i % n * 10, 5 + i / n * 10, 4, (i % n + i / n) % kinds, 0);
    return done(st, s);
}

static bool is_free(const tz_element_set *s, double x, double y, double apart, bool touch)
{
    for (int32_t i = 0; i < s->element.n; i++) {
        const tz_vec3 v =
            tz_domain_vector(&s->domain, s->element.v[i].at, (tz_vec3){x, y, 0});
        if (hypot(v.x, v.y) < apart + (touch ? s->element.v[i].radius : 0))
            return false;
    }
    return true;
}

tz_status drawn_darts(tz_ctx *ctx, double side, double apart, int32_t n, int32_t kinds,
                      bool torus, tz_element_set *s)
{
    tz_rng r = tz_rng_make(5, 0);
    tz_status st = drawn_set(ctx, side, side, torus, kinds, s);
    for (int32_t i = 0; i < 100000 && s->element.n < n && st == TZ_OK; i++) {
        const double x = tz_rng_range(&r, 0, side), y = tz_rng_range(&r, 0, side);
        if (is_free(s, x, y, apart, false))
            st = drawn_add(s, x, y, 0.45 * apart, tz_rng_below(&r, kinds), 0);
    }
    return done(st, s);
}

tz_status drawn_mixed(tz_ctx *ctx, double side, bool torus, tz_element_set *s)
{
    tz_rng r = tz_rng_make(3, 3);
    tz_status st = drawn_set(ctx, side, side, torus, 2, s);
    for (int32_t i = 0; i < 30000 && st == TZ_OK; i++) {
        const bool large = i < 3000;
        const double radius = large ? 12 : 3;
        const double x = tz_rng_range(&r, 0, side), y = tz_rng_range(&r, 0, side);
        if (large && s->element.n * 1800 > side * side)
            continue;
        if (is_free(s, x, y, radius + (large ? 4 : 0.3), true))
            st = drawn_add(s, x, y, radius, large, 0);
    }
    return done(st, s);
}

tz_status drawn_mosaic(tz_ctx *ctx, int32_t n, tz_element_set *s)
{
    const double side = 10 * sqrt(n);
    tz_status st = drawn_set(ctx, side, side, false, 4, s);
    for (int32_t c = 0; c < 2; c++)
        for (int32_t k = 1; k < 200 && st == TZ_OK; k++) {
            const int32_t tiles = (int32_t)(TZ_PI * 2 * k);
            for (int32_t i = 0; i < tiles && st == TZ_OK; i++) {
                const double a = 2 * TZ_PI * i / tiles;
                const double x = side * (c ? 0.8 : 0.2) + 10 * k * cos(a);
                const double y = side * 0.5 + 10 * k * sin(a);
                /* each centre owns the half that is nearer to it */
                if (x > 4 && y > 4 && x < side - 4 && y < side - 4 &&
                    (c ? x > 0.5 * side : x <= 0.5 * side) && is_free(s, x, y, 9, false))
                    st = drawn_add(s, x, y, 4, k / 2 % 4, a);
            }
        }
    return done(st, s);
}
