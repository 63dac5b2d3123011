/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Element sets drawn by rule: lattices, mixtures, random ones. */
#ifndef TZ_TESTS_PATTERNS_H
#define TZ_TESTS_PATTERNS_H

#include "base/rng.h"
#include "elements/element.h"

/* An empty set of some classes, each with a disc of the given radius. */
static inline tz_status pattern_begin(tz_ctx *ctx, tz_element_set *s, tz_domain domain,
                                      int32_t kinds, double radius)
{
    static const char *names[] = {"a", "b", "c", "d"};
    tz_status st = TZ_OK;
    *s = (tz_element_set){.domain = domain, .ctx = ctx};
    for (int32_t k = 0; k < kinds && st == TZ_OK; k++) {
        tz_element_kind kind = {0};
        tz_element_symbol y = {.radius = radius};
        st = tz_strdup(ctx, names[k], &kind.name);
        if (st == TZ_OK && (st = tz_array_push(ctx, &s->kind, kind)) != TZ_OK)
            tz_free(ctx, kind.name);
        if (st == TZ_OK)
            st = tz_strdup(ctx, names[k], &y.id);
        if (st == TZ_OK)
            st = tz_strdup(ctx, "", &y.markup);
        if (st == TZ_OK)
            st = tz_array_push(ctx, &s->symbol, y);
        if (st != TZ_OK)
            tz_free(ctx, y.id), tz_free(ctx, y.markup);
    }
    if (st != TZ_OK)
        tz_element_set_deinit(s);
    return st;
}

static inline tz_status pattern_add(tz_element_set *s, int32_t kind, double x, double y)
{
    tz_sample p = {.at = {x, y, 0}, .weight = 1};
    tz_element e = {.kind = kind,
                    .symbol = kind,
                    .source = -1,
                    .sample = s->sample.n,
                    .samples = 1,
                    .at = {x, y, 0},
                    .scale = 1,
                    .radius = s->symbol.v[kind].radius};
    tz_status st = tz_array_push(s->ctx, &s->sample, p);
    return st == TZ_OK ? tz_array_push(s->ctx, &s->element, e) : st;
}

typedef enum pattern {
    PATTERN_SQUARE, /* spacing 10 */
    PATTERN_HEX,   /* columns 10 apart, rows 8.66; size.y should be a multiple of 17.32 */
    PATTERN_CHESS, /* square, two classes by turns */
    PATTERN_BRICK, /* rows 8 high, bricks 20 wide, each row shifted by half */
    PATTERN_JITTER, /* square, moved by up to 3 */
    PATTERN_RANDOM, /* one in each 100 square units on average */
    PATTERN_MIXED   /* jitter, a tenth of another class */
} pattern;

/* Fills a rectangle with a pattern. */
static inline tz_status pattern_make(tz_ctx *ctx, tz_element_set *s, pattern p,
                                     tz_domain domain, uint64_t seed)
{
    const double hex = 5 * sqrt(3.0);
    const double w = p == PATTERN_BRICK ? 20 : 10;
    const double h = p == PATTERN_HEX ? hex : p == PATTERN_BRICK ? 8 : 10;
    const int32_t nx = (int32_t)(domain.size.x / w + 0.01);
    const int32_t ny = (int32_t)(domain.size.y / h + 0.01);
    tz_status st = pattern_begin(ctx, s, domain, 2, 4);
    for (int32_t i = 0; i < nx * ny && st == TZ_OK; i++) {
        tz_rng r = tz_rng_make(seed, (uint64_t)i);
        const int32_t c = i % nx, row = i / nx;
        const bool shift = (p == PATTERN_HEX || p == PATTERN_BRICK) && row % 2 == 1;
        double x = (c + (shift ? 0.75 : 0.25)) * w, y = (row + 0.5) * h;
        int32_t kind = p == PATTERN_CHESS ? (c + row) % 2 : 0;
        if (p == PATTERN_JITTER || p == PATTERN_MIXED)
            x += tz_rng_range(&r, -3, 3), y += tz_rng_range(&r, -3, 3);
        if (p == PATTERN_RANDOM)
            x = tz_rng_unit(&r) * domain.size.x, y = tz_rng_unit(&r) * domain.size.y;
        if (p == PATTERN_MIXED)
            kind = tz_rng_unit(&r) < 0.1;
        st = pattern_add(s, kind, x, y);
    }
    if (st != TZ_OK)
        tz_element_set_deinit(s);
    return st;
}

#endif
