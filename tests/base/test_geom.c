/* SPDX-License-Identifier: Apache-2.0 */
/* Vectors, affine maps, rectangles, as properties over random input. */
#include "tests/base/check.h"

#include "base/geom.h"
#include "base/rng.h"

static tz_affine random_affine(tz_rng *r)
{
    return (tz_affine){tz_rng_range(r, -2, 2),   tz_rng_range(r, -2, 2),
                       tz_rng_range(r, -2, 2),   tz_rng_range(r, -2, 2),
                       tz_rng_range(r, -50, 50), tz_rng_range(r, -50, 50)};
}

static void near(tz_vec2 p, tz_vec2 q, double eps)
{
    assert_true(tz_vec2_length(tz_vec2_sub(p, q)) <= eps);
}

static void composition_and_inverse(void **state)
{
    (void)state;
    tz_rng r = tz_rng_make(1, 1);
    for (int i = 0; i < 1000; i++) {
        tz_affine p = random_affine(&r), q = random_affine(&r), inverse;
        tz_vec2 x = {tz_rng_range(&r, -9, 9), tz_rng_range(&r, -9, 9)};
        near(tz_affine_apply(tz_affine_then(p, q), x),
             tz_affine_apply(q, tz_affine_apply(p, x)), 1e-9);
        if (fabs(tz_affine_det(p)) < 1e-3)
            continue;
        assert_true(tz_affine_invert(p, &inverse));
        near(tz_affine_apply(inverse, tz_affine_apply(p, x)), x, 1e-7);
    }
}

static void singular_has_no_inverse(void **state)
{
    (void)state;
    tz_affine out = {1, 2, 3, 4, 5, 6}, same = out;
    assert_false(tz_affine_invert((tz_affine){1, 2, 2, 4, 0, 0}, &out));
    assert_false(tz_affine_invert((tz_affine){NAN, 0, 0, 1, 0, 0}, &out));
    assert_false(tz_affine_invert((tz_affine){1, 0, 0, 1, INFINITY, 0}, &out));
    assert_false(tz_affine_invert((tz_affine){1e300, 0, 0, 1e300, 0, 0}, &out));
    assert_memory_equal(&out, &same, sizeof out);
    assert_false(tz_affine_finite((tz_affine){1, 0, 0, 1, 0, NAN}));
}

static void placing(void **state)
{
    (void)state;
    tz_vec2 from = {3, 4}, to = {10, 20};
    tz_affine m = tz_affine_place(from, to, TZ_PI / 2, 2, false);
    near(tz_affine_apply(m, from), to, 1e-12);
    /* one to the right, twice as long, turned from +x towards +y: two down */
    near(tz_affine_apply(m, (tz_vec2){4, 4}), (tz_vec2){10, 22}, 1e-12);
    m = tz_affine_place(from, to, 0, 1, true);
    near(tz_affine_apply(m, (tz_vec2){4, 5}), (tz_vec2){9, 21}, 1e-12);
    assert_true(tz_affine_det(m) < 0);
}

static void rectangles(void **state)
{
    (void)state;
    tz_rect r = tz_rect_intersect((tz_rect){0, 0, 10, 10}, (tz_rect){5, -5, 10, 10});
    assert_int_equal(r.x, 5);
    assert_int_equal(r.y, 0);
    assert_int_equal(r.w, 5);
    assert_int_equal(r.h, 5);
    assert_true(tz_rect_empty(
        tz_rect_intersect((tz_rect){0, 0, 10, 10}, (tz_rect){10, 0, 10, 10})));
    r = tz_rect_intersect((tz_rect){2000000000, 0, 2000000000, 1},
                          (tz_rect){2000000001, 0, 2000000000, 1});
    assert_int_equal(r.w, 1999999999);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(composition_and_inverse),
        cmocka_unit_test(singular_has_no_inverse),
        cmocka_unit_test(placing),
        cmocka_unit_test(rectangles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
