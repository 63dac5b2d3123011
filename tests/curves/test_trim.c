/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Trimming: the picture's own edge goes, patterns stay as they are. */
#include "tests/support/curve_fixture.h"

#include <math.h>

#include "base/rng.h"
#include "curves/curve_io.h"
#include "curves/trim.h"

static tz_status add(tz_curve_set *s, tz_vec2 p, tz_vec2 q)
{
    int32_t a, b;
    tz_status st = tz_curve_add_node(s, p, &a);
    if (st == TZ_OK)
        st = tz_curve_add_node(s, q, &b);
    if (st == TZ_OK)
        st = tz_curve_begin(s, 0);
    if (st == TZ_OK)
        st = tz_curve_line(s, a, b);
    if (st == TZ_OK)
        tz_curve_end(s, false);
    return st;
}

static tz_status empty_set(tz_ctx *c, double w, double h, tz_curve_set *s)
{
    int32_t pen;
    *s = (tz_curve_set){.ctx = c, .domain = {.size = {w, h, 0}}, .element = {.ctx = c}};
    return tz_curve_add_pen(s, (tz_curve_pen){.width = 1, .color = 255}, &pen);
}

/* Upright lines that end about `inset` inside of the top and the bottom. */
static tz_status strokes(tz_ctx *c, double inset, double ragged, tz_curve_set *s)
{
    tz_rng g = tz_rng_make(7, 1);
    tz_status st = empty_set(c, 300, 400, s);
    for (int i = 0; i < 30 && st == TZ_OK; i++) {
        const double x = 5 + 10 * i;
        st = add(s, (tz_vec2){x, inset + tz_rng_range(&g, 0, ragged)},
                 (tz_vec2){x, 400 - inset - tz_rng_range(&g, 0, ragged)});
    }
    return st;
}

static int32_t ends_inside(const tz_curve_set *s)
{
    int32_t n = 0;
    for (int32_t i = 0; i < s->node.n; i++) {
        const tz_vec2 p = s->node.v[i];
        n += p.x > 1e-6 && p.y > 1e-6 && p.x < s->domain.size.x - 1e-6 &&
             p.y < s->domain.size.y - 1e-6;
    }
    return n;
}

static void test_strokes(void **state)
{
    (void)state;
    for (double inset = 2; inset < 40; inset += 10) {
        tz_curve_set s, t;
        tz_curve_trim_report r;
        ok(ctx, strokes(ctx, inset, 6, &s));
        ok(ctx, tz_curve_trim(ctx, &s, &t, &r));
        ok(ctx, tz_curve_set_check(ctx, &t, "trimmed"));
        assert_true(r.trimmed && !r.filled);
        assert_int_equal(r.ends[TZ_CURVE_TOP], 30);
        assert_int_equal(r.ends[TZ_CURVE_BOTTOM], 30);
        assert_true(r.ends[TZ_CURVE_LEFT] == 0 && r.ends[TZ_CURVE_RIGHT] == 0);
        assert_true(t.domain.size.x == 300 && t.domain.size.y >= 400 * 0.76 - 1e-9);
        assert_int_equal(t.path.n, 30);
        assert_int_equal(ends_inside(&t), 0);
        /* once more changes nothing */
        tz_curve_set again;
        ok(ctx, tz_curve_trim(ctx, &t, &again, &r));
        assert_false(r.trimmed);
        tz_curve_set_deinit(&again);
        tz_curve_set_deinit(&s);
        tz_curve_set_deinit(&t);
    }
}

/* Strokes that end anywhere, lines that run over the border, ends too deep inside, few
 * lines, a torus: as they are, to the bit. */
static void test_untouched(void **state)
{
    (void)state;
    tz_rng g = tz_rng_make(3, 2);
    for (int k = 0; k < 6; k++) {
        tz_curve_set s, t;
        tz_curve_trim_report r;
        if (k == 0)
            ok(ctx, strokes(ctx, 0, 0, &s));
        else if (k == 1)
            ok(ctx, strokes(ctx, 60, 10, &s));
        else if (k == 2)
            ok(ctx, strokes(ctx, 10, 5, &s));
        else
            ok(ctx, empty_set(ctx, 300, 300, &s));
        s.domain.torus = k == 2;
        for (int i = 0; i < (k == 3 ? 300 : k == 4 ? 3 : 0); i++) {
            const tz_vec2 p = {tz_rng_range(&g, 0, 300), tz_rng_range(&g, 0, 280)};
            ok(ctx, add(&s, p, (tz_vec2){p.x, p.y + 20}));
        }
        ok(ctx, tz_curve_trim(ctx, &s, &t, &r));
        if (r.trimmed)
            fail_msg("kind %d: at %g %g, %g x %g", k, r.at.x, r.at.y, r.size.x, r.size.y);
        assert_int_equal(t.path.n, s.path.n);
        assert_memory_equal(&t.domain, &s.domain, sizeof t.domain);
        if (s.node.n > 0)
            assert_memory_equal(t.node.v, s.node.v, (size_t)s.node.n * sizeof *s.node.v);
        tz_curve_set_deinit(&s);
        tz_curve_set_deinit(&t);
    }
}

/* A grid with a corner of nothing loses that. */
static tz_status grid(tz_ctx *c, bool holed, tz_curve_set *s)
{
    tz_status st = empty_set(c, 300, 300, s);
    for (int i = 0; i < 20 && st == TZ_OK; i++) {
        const double x = 7.5 + 15 * i, far = holed && i >= 14 ? 217.5 : 300;
        st = add(s, (tz_vec2){x, 0}, (tz_vec2){x, far});
        if (st == TZ_OK)
            st = add(s, (tz_vec2){0, x}, (tz_vec2){far, x});
    }
    return st;
}

static void test_filled(void **state)
{
    (void)state;
    for (int holed = 0; holed < 2; holed++) {
        tz_curve_set s, t;
        tz_curve_trim_report r;
        ok(ctx, grid(ctx, holed, &s));
        ok(ctx, tz_curve_trim(ctx, &s, &t, &r));
        ok(ctx, tz_curve_set_check(ctx, &t, "trimmed"));
        assert_int_equal(r.filled, holed);
        assert_true(holed ? r.empty > 0.04 && r.size.x * r.size.y > 0.6 * 9e4 &&
                                (r.size.x < 235 || r.size.y < 235)
                          : !r.trimmed && r.empty < 0.01);
        tz_curve_set_deinit(&s);
        tz_curve_set_deinit(&t);
    }
}

/* Neither NAN-free rubbish nor points do harm. */
static void test_rough(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 12; seed++) {
        tz_rng g = tz_rng_make(seed, 9);
        const double way = pow(10, tz_rng_range(&g, -9, 6));
        tz_curve_set s, t;
        ok(ctx, empty_set(ctx, seed & 1 ? 1e-3 : 500, seed & 2 ? 1e5 : 20, &s));
        for (int i = 0; i < 400; i++) {
            const tz_vec2 p = {tz_rng_range(&g, -5, 500), tz_rng_range(&g, -5, 30)};
            ok(ctx, add(&s, p,
                        (tz_vec2){p.x + tz_rng_range(&g, -way, way),
                                  p.y + tz_rng_range(&g, -way, way)}));
        }
        ok(ctx, tz_curve_trim(ctx, &s, &t, NULL));
        ok(ctx, tz_curve_set_check(ctx, &t, "trimmed"));
        tz_curve_set_deinit(&s);
        tz_curve_set_deinit(&t);
    }
}

static tz_status run_once(tz_ctx *c)
{
    tz_curve_set s, t = {0};
    tz_status st = grid(c, true, &s);
    if (st == TZ_OK)
        st = tz_curve_trim(c, &s, &t, NULL);
    tz_curve_set_deinit(&s);
    tz_curve_set_deinit(&t);
    return st;
}

static void test_memory(void **state)
{
    (void)state;
    survive(run_once, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_strokes, begin, end),
        cmocka_unit_test_setup_teardown(test_untouched, begin, end),
        cmocka_unit_test_setup_teardown(test_filled, begin, end),
        cmocka_unit_test_setup_teardown(test_rough, begin, end),
        cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
