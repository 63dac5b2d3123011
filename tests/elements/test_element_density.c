/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Density of sets whose border spoils it: pieces, margins, periods; and what each element
 * stands for. */
#include "tests/base/check.h"

#include <math.h>

#include "base/rng.h"
#include "elements/element_density.h"
#include "tests/support/elements.h"

static void near(double got, double wanted, double share_off)
{
    if (!(fabs(got - wanted) <= share_off * wanted))
        fail_msg("%g in place of %g", got, wanted);
}

/* Discs of density 0.004 by chance, in a frame of 200 x 200 cut out of more: whole, as
 * pieces, or only those that are whole. */
typedef enum border { DRAWN_ON, PIECES, LEFT_OUT } border;

static void draw(tz_ctx *ctx, border b, uint64_t seed, tz_element_set *s)
{
    tz_rng r = tz_rng_make(seed, 1);
    const double radius = 9;
    ok(ctx, drawn_set(ctx, 200, 200, false, 1, s));
    for (int32_t i = 0; i < 256; i++) {
        const double x0 = tz_rng_range(&r, -28, 228), y0 = tz_rng_range(&r, -28, 228);
        const double lo_x = fmax(0, x0 - radius), hi_x = fmin(200, x0 + radius),
                     lo_y = fmax(0, y0 - radius), hi_y = fmin(200, y0 + radius);
        const bool cut = hi_x - lo_x < 2 * radius || hi_y - lo_y < 2 * radius;
        if (hi_x <= lo_x || hi_y <= lo_y || (cut && b == LEFT_OUT))
            continue;
        if (cut && b == PIECES) {
            const double small = 0.5 * fmin(hi_x - lo_x, hi_y - lo_y);
            ok(ctx, drawn_add(s, 0.5 * (lo_x + hi_x), 0.5 * (lo_y + hi_y), small, 0, 0));
        } else {
            ok(ctx, drawn_add(s, x0, y0, radius, 0, 0));
        }
        s->element.v[s->element.n - 1].cut = cut;
    }
}

static void test_borders(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    for (int b = DRAWN_ON; b <= LEFT_OUT; b++) {
        double sum = 0, naive = 0;
        for (uint64_t seed = 0; seed < 12; seed++) {
            tz_element_set s;
            draw(ctx, (border)b, seed, &s);
            sum += tz_element_density(&s, true) / 12;
            naive += s.element.n / 40000.0 / 12;
            tz_element_set_deinit(&s);
        }
        near(sum, 256 / 65536.0, 0.06);
        if (b != DRAWN_ON) /* what is corrected is no trifle */
            assert_true(fabs(naive - 256 / 65536.0) > 0.1 * 256 / 65536.0);
    }
    end_ctx(ctx);
}

static void test_period(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set s;
    double weight[32], sum = 0;
    bool period = false;
    ok(ctx, drawn_set(ctx, 40, 40, false, 1, &s)); /* 4 * 4, and the seam once more */
    for (int32_t j = 0; j <= 4; j++)
        for (int32_t i = 0; i <= 4; i++) {
            ok(ctx, drawn_add(&s, 10 * i, 10 * j, 4, 0, 0));
            s.element.v[s.element.n - 1].cut = i % 4 == 0 || j % 4 == 0;
        }
    near(tz_element_density(&s, true), 0.01, 1e-9);
    tz_element_weights(&s, weight, &period);
    assert_true(period);
    for (int32_t i = 0; i < s.element.n; i++)
        sum += weight[i];
    near(sum, 0.01, 1e-9);
    assert_true(weight[0] > 0 && weight[4] == 0); /* one of two twins */
    tz_element_set_deinit(&s);
    end_ctx(ctx);
}

/* Large things are cut more often: the few that are whole stand for more. */
static void test_weights(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set s;
    double weight[16];
    ok(ctx, drawn_set(ctx, 100, 100, false, 1, &s));
    for (int32_t i = 0; i < 9; i++)
        ok(ctx, drawn_add(&s, 20 + 10 * i, 50, i == 4 ? 25 : 5, 0, 0));
    ok(ctx, drawn_add(&s, 3, 20, 3, 0, 0)); /* a piece */
    s.element.v[9].cut = true;
    tz_element_weights(&s, weight, NULL);
    assert_float_equal(weight[9], 0, 0);
    assert_float_equal(weight[0], 1.0 / (90 * 90), 1e-12);
    assert_float_equal(weight[4], 1.0 / (50 * 50), 1e-12);
    tz_element_set_deinit(&s);
    end_ctx(ctx);
}

static void test_voids_and_tori(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set s;
    ok(ctx, drawn_set(ctx, 50, 20, true, 2, &s));
    s.kind.v[1].is_void = true;
    for (int32_t i = 0; i < 10; i++)
        ok(ctx, drawn_add(&s, 5 * i, 10, 2, i % 2, 0));
    assert_float_equal(tz_element_density(&s, true), 0.01, 1e-12);
    assert_float_equal(tz_element_density(&s, false), 0.005, 1e-12);
    s.element.n = 0;
    assert_float_equal(tz_element_density(&s, true), 0, 0);
    tz_element_set_deinit(&s);
    end_ctx(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_borders),
        cmocka_unit_test(test_period),
        cmocka_unit_test(test_weights),
        cmocka_unit_test(test_voids_and_tori),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
