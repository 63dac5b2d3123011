/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Domains: shortest vectors and wrapping, plain and on a torus. */
#include <float.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

#include "base/rng.h"
#include "elements/domain.h"

static const tz_domain plain = {.size = {120, 37, 0}, .torus = false},
                       torus = {.size = {120, 37, 0}, .torus = true};

static void test_plain(void **state)
{
    (void)state;
    const tz_vec3 p = {-5, 2, 1}, q = {130, -40, 4};
    const tz_vec3 v = tz_domain_vector(&plain, p, q);
    assert_true(v.x == 135 && v.y == -42 && v.z == 3);
    const tz_vec3 w = tz_domain_wrap(&plain, q);
    assert_true(w.x == 130 && w.y == -40 && w.z == 4);
    assert_true(tz_domain_contains(&plain, (tz_vec3){0, 0, 0}));
    assert_true(tz_domain_contains(&plain, (tz_vec3){119.9, 36.9, 0}));
    assert_false(tz_domain_contains(&plain, (tz_vec3){120, 0, 0}));
    assert_false(tz_domain_contains(&plain, (tz_vec3){0, 37, 0}));
    assert_false(tz_domain_contains(&plain, (tz_vec3){-1e-9, 0, 0}));
    assert_true(tz_domain_contains(&torus, (tz_vec3){-500, 1e6, 0}));
}

/* No copy of q is nearer to p than the vector says. */
static void test_shortest(void **state)
{
    (void)state;
    tz_rng r = tz_rng_make(1, 0);
    for (int n = 0; n < 2000; n++) {
        const tz_vec3 p = {tz_rng_range(&r, -300, 300), tz_rng_range(&r, -300, 300), 5};
        const tz_vec3 q = {tz_rng_range(&r, -300, 300), tz_rng_range(&r, -300, 300), -2};
        const tz_vec3 v = tz_domain_vector(&torus, p, q);
        double nearest = INFINITY;
        for (int i = -7; i <= 7; i++)
            for (int j = -18; j <= 18; j++)
                nearest = fmin(nearest, hypot(q.x + 120 * i - p.x, q.y + 37 * j - p.y));
        assert_float_equal(hypot(v.x, v.y), nearest, 1e-9);
        assert_true(v.z == -7); /* a torus has no wrap in depth */
        const tz_vec3 back = tz_domain_vector(&torus, q, p);
        assert_float_equal(hypot(back.x, back.y), nearest, 1e-9);
        /* it leads to a copy of q */
        const tz_vec3 end =
            tz_domain_wrap(&torus, (tz_vec3){p.x + v.x, p.y + v.y, p.z + v.z});
        const tz_vec3 off = tz_domain_vector(&torus, end, q);
        assert_float_equal(hypot(off.x, off.y), 0, 1e-9);
    }
}

static void assert_wrapped(tz_vec3 p)
{
    const tz_vec3 w = tz_domain_wrap(&torus, p);
    if (!(w.x >= 0 && w.x < 120 && w.y >= 0 && w.y < 37))
        fail_msg("%.17g, %.17g wraps to %.17g, %.17g", p.x, p.y, w.x, w.y);
    assert_true(w.z == p.z);
}

/* The wrapped point lies in [0, size), also where rounding is at its worst. */
static void test_wrap_lies_inside(void **state)
{
    (void)state;
    static const double hard[] = {0,       -0.0,
                                  DBL_MIN, -DBL_MIN,
                                  1e-18,   -1e-18,
                                  -1e-300, -1e-9,
                                  37,      -37,
                                  120,     -120,
                                  240,     36.999999999999993,
                                  1e9,     -1e9,
                                  1e15,    -1e15,
                                  59.99,   -120.00000000000001};
    const int n = sizeof hard / sizeof hard[0];
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            assert_wrapped((tz_vec3){hard[i], hard[j], 3});
    tz_rng r = tz_rng_make(2, 0);
    for (int k = 0; k < 5000; k++)
        assert_wrapped(
            (tz_vec3){tz_rng_range(&r, -1e4, 1e4), tz_rng_normal(&r) * 1e-15, 0});
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_plain),
        cmocka_unit_test(test_shortest),
        cmocka_unit_test(test_wrap_lies_inside),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
