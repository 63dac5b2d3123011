/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What the tests of region growing share. Include after tests/base/check.h. */
#ifndef TZ_TESTS_GROWING_H
#define TZ_TESTS_GROWING_H

#include "elements/growth.h"
#include "tests/support/elements.h"

static inline tz_growth_params growing_params(void)
{
    tz_growth_params p;
    memset(&p, 0, sizeof p);
    tz_params_default(&tz_growth_param_table, &p);
    return p;
}

static inline void growing_near(double got, double wanted, double share_off)
{
    if (!(fabs(got - wanted) <= share_off * wanted))
        fail_msg("%g in place of %g", got, wanted);
}

static inline uint64_t growing_digest(const tz_element_set *s)
{
    uint64_t h = 14695981039346656037u;
    for (int32_t i = 0; i < s->element.n; i++) {
        const tz_element *e = &s->element.v[i];
        uint64_t word[5] = {(uint64_t)e->source, (uint64_t)e->kind, 0, 0, 0};
        memcpy(&word[2], &e->at.x, 8);
        memcpy(&word[3], &e->at.y, 8);
        memcpy(&word[4], &e->angle, 8);
        for (int k = 0; k < 5; k++)
            h = (h ^ word[k]) * 1099511628211u;
    }
    return h ^ (uint64_t)s->element.n;
}

/** Two exemplars side by side: kind 0, 10 apart, in [0, 100); kind 1, 5 apart, in [100,
 * 200); both 100 high. */
static inline tz_status growing_palette(tz_ctx *ctx, tz_element_set *s)
{
    tz_status st = drawn_set(ctx, 200, 100, false, 2, s);
    for (int32_t i = 0; i < 100 && st == TZ_OK; i++)
        st = drawn_add(s, 5 + 10 * (i % 10), 5 + (double)(i / 10) * 10, 4, 0, 0);
    for (int32_t i = 0; i < 400 && st == TZ_OK; i++)
        st = drawn_add(s, 102.5 + 5 * (i % 20), 2.5 + (double)(i / 20) * 5, 2, 1, 0);
    if (st != TZ_OK)
        tz_element_set_deinit(s);
    return st;
}

/** Grows to the end, in steps. */
static inline tz_status growing_run(tz_ctx *ctx, const tz_element_set *palette,
                                    const tz_growth_texture *texture, int32_t n,
                                    const tz_growth_params *p, int32_t budget,
                                    tz_element_set *out)
{
    tz_growth *g = NULL;
    bool more = true;
    tz_status s = tz_growth_begin_palette(ctx, palette, texture, n, p, out, &g);
    for (int32_t k = 0; s == TZ_OK && more; k++) {
        s = tz_growth_step(g, budget, &more);
        assert_true(k < 1000000);
    }
    tz_growth_end(g);
    return s;
}

#endif
