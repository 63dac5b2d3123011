/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Cost of one neighbourhood in place of another. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

#include "base/rng.h"
#include "elements/neighbourhood.h"

static const tz_neighbour_weights weights = {0.5, 1.0, 0.5, 30};

static tz_neighbour draw(tz_rng *r, double spread)
{
    tz_neighbour q = {{spread * tz_rng_normal(r), spread * tz_rng_normal(r), 0},
                      tz_rng_range(r, 0, TZ_PI),
                      tz_rng_range(r, 2, 9),
                      tz_rng_below(r, 2)};
    if (tz_rng_below(r, 4) == 0)
        q.angle = NAN;
    return q;
}

static void draw_all(tz_rng *r, double spread, tz_neighbour *v, int32_t n)
{
    for (int32_t i = 0; i < n; i++)
        v[i] = draw(r, spread);
}

static void shuffle(tz_rng *r, tz_neighbour *v, int32_t n)
{
    for (int32_t i = n - 1; i > 0; i--) {
        const int32_t j = tz_rng_below(r, i + 1);
        const tz_neighbour t = v[i];
        v[i] = v[j], v[j] = t;
    }
}

static double cost(const tz_neighbour *a, int32_t na, const tz_neighbour *b, int32_t nb)
{
    return tz_neighbourhood_cost(a, na, b, nb, &weights);
}

/* Cost of a pair, written down from the header's words. */
static double pair(const tz_neighbour *p, const tz_neighbour *q)
{
    const double dx = p->offset.x - q->offset.x, dy = p->offset.y - q->offset.y,
                 dz = p->offset.z - q->offset.z;
    double c = dx * dx + dy * dy + dz * dz +
               weights.size * (p->size - q->size) * (p->size - q->size);
    if (!isnan(p->angle) && !isnan(q->angle)) {
        const double s = sin(p->angle - q->angle);
        c += weights.angle * s * s * p->size * q->size;
    }
    return c;
}

static void test_equal_costs_nothing(void **state)
{
    (void)state;
    tz_rng r = tz_rng_make(1, 0);
    tz_neighbour a[TZ_NEIGHBOURS_MAX], b[TZ_NEIGHBOURS_MAX];
    for (int32_t n = 0; n <= TZ_NEIGHBOURS_MAX; n++) {
        draw_all(&r, 40, a, n);
        for (int32_t i = 0; i < n; i++)
            b[i] = a[i];
        assert_float_equal(cost(a, n, b, n), 0, 1e-12);
        shuffle(&r, b, n);
        assert_float_equal(cost(a, n, b, n), 0, 1e-12);
    }
    assert_true(cost(a, 0, b, 5) == 0);
    assert_true(cost(a, 0, b, 0) == 0);
}

/* More than is wanted may be there. */
static void test_surplus_is_free(void **state)
{
    (void)state;
    tz_rng r = tz_rng_make(2, 0);
    tz_neighbour b[20];
    draw_all(&r, 40, b, 20);
    assert_float_equal(cost(b, 12, b, 20), 0, 1e-12);
    assert_float_equal(cost(b, 20, b, 12), 8 * weights.missing * 900 / 20.0, 400);
    assert_true(cost(b, 20, b, 12) > 0);
}

static void test_order_does_not_matter(void **state)
{
    (void)state;
    tz_rng r = tz_rng_make(3, 0);
    for (int k = 0; k < 300; k++) {
        tz_neighbour a[14], b[14];
        const int32_t na = 1 + tz_rng_below(&r, 14), nb = tz_rng_below(&r, 15);
        draw_all(&r, 25, a, na);
        draw_all(&r, 25, b, nb);
        const double before = cost(a, na, b, nb);
        shuffle(&r, a, na);
        shuffle(&r, b, nb);
        assert_float_equal(cost(a, na, b, nb), before, 1e-9 * (1 + before));
        /* as many on both sides: each sees the other as it is seen */
        if (na <= 14 && nb == na)
            assert_float_equal(cost(b, nb, a, na), before, 1e-9 * (1 + before));
    }
    for (int k = 0; k < 100; k++) {
        tz_neighbour a[9], b[9];
        draw_all(&r, 25, a, 9);
        draw_all(&r, 25, b, 9);
        const double there = cost(a, 9, b, 9), back = cost(b, 9, a, 9);
        assert_float_equal(there, back, 1e-9 * (1 + there));
    }
}

static void test_one_pair(void **state)
{
    (void)state;
    const tz_neighbour a = {{3, 4, 0}, 0.2, 5, 0};
    tz_neighbour b = a;
    b.offset = (tz_vec3){6, 8, 0};
    assert_float_equal(cost(&a, 1, &b, 1), 25, 1e-12);
    b = a, b.offset.z = 2;
    assert_float_equal(cost(&a, 1, &b, 1), 4, 1e-12);
    b = a, b.size = 7;
    assert_float_equal(cost(&a, 1, &b, 1), 4 * weights.size, 1e-12);
    b = a, b.angle = 0.2 + TZ_PI / 2;
    assert_float_equal(cost(&a, 1, &b, 1), weights.angle * 25, 1e-9);
    b = a, b.angle = 0.2 + TZ_PI; /* an axis has no direction */
    assert_float_equal(cost(&a, 1, &b, 1), 0, 1e-9);
    b.angle = NAN;
    assert_float_equal(cost(&a, 1, &b, 1), 0, 1e-12);
}

static void test_missing(void **state)
{
    (void)state;
    const double missing = weights.missing * weights.limit * weights.limit;
    tz_neighbour a[3] = {
        {{0, 0, 0}, NAN, 5, 0}, {{10, 0, 0}, NAN, 5, 0}, {{0, 10, 0}, NAN, 5, 0}};
    tz_neighbour b[3] = {a[0], a[1], a[2]};
    assert_float_equal(cost(a, 3, b, 0), missing, 1e-9);
    assert_float_equal(cost(a, 3, b, 2), missing / 3, 1e-9);
    for (int i = 0; i < 3; i++)
        b[i].kind = 1; /* at the same places, but other things */
    assert_float_equal(cost(a, 3, b, 3), missing, 1e-9);
    b[1].kind = 0;
    assert_float_equal(cost(a, 3, b, 3), missing * 2 / 3, 1e-9);
    for (int i = 0; i < 3; i++)
        b[i].kind = 0, b[i].offset.x += 1000; /* too far to be the same thing */
    assert_float_equal(cost(a, 3, b, 3), missing, 1e-9);
    /* just inside and just outside of the limit */
    tz_neighbour far = a[0];
    far.offset.x = weights.limit - 1e-6;
    assert_float_equal(cost(a, 1, &far, 1), weights.limit * weights.limit, 1e-3);
    far.offset.x = weights.limit + 1e-6;
    assert_float_equal(cost(a, 1, &far, 1), missing, 1e-9);
}

/* One thing is paired once: two wanted at one place where one is there. */
static void test_each_pairs_once(void **state)
{
    (void)state;
    const tz_neighbour a[2] = {{{0, 0, 0}, NAN, 5, 0}, {{1, 0, 0}, NAN, 5, 0}};
    const tz_neighbour b[2] = {{{0.4, 0, 0}, NAN, 5, 0}, {{50, 0, 0}, NAN, 5, 0}};
    const double missing = weights.missing * weights.limit * weights.limit;
    assert_float_equal(cost(a, 2, b, 2), (0.16 + missing) / 2, 1e-9);
}

/* Least sum over all pairings, unpaired ones included. */
static double optimal(const tz_neighbour *a, int32_t na, const tz_neighbour *b,
                      int32_t nb, int32_t at, uint32_t used)
{
    if (at == na)
        return 0;
    const double limit = weights.limit * weights.limit;
    double best = weights.missing * limit + optimal(a, na, b, nb, at + 1, used);
    for (int32_t j = 0; j < nb; j++) {
        if ((used >> j & 1) || a[at].kind != b[j].kind)
            continue;
        const double c = pair(&a[at], &b[j]);
        if (c < limit)
            best = fmin(best, c + optimal(a, na, b, nb, at + 1, used | 1U << j));
    }
    return best;
}

static void test_against_optimal(void **state)
{
    (void)state;
    tz_rng r = tz_rng_make(5, 0);
    double sum = 0, least = 0;
    for (int k = 0; k < 400; k++) {
        tz_neighbour a[6], b[6];
        const int32_t na = 1 + tz_rng_below(&r, 6), nb = tz_rng_below(&r, 7);
        draw_all(&r, 20, a, na);
        /* a blurred copy of what is wanted, and strangers */
        for (int32_t j = 0; j < nb; j++) {
            b[j] = draw(&r, 20);
            if (j < na && tz_rng_below(&r, 3)) {
                b[j] = a[j];
                b[j].offset.x += 4 * tz_rng_normal(&r);
                b[j].offset.y += 4 * tz_rng_normal(&r);
            }
        }
        const double best = optimal(a, na, b, nb, 0, 0) / na, got = cost(a, na, b, nb);
        assert_true(got >= best - 1e-9);
        sum += got, least += best;
    }
    assert_true(sum <= 1.25 * least); /* greedy pairs are seldom far off */
}

static void test_too_many_are_cut(void **state)
{
    (void)state;
    tz_rng r = tz_rng_make(6, 0);
    tz_neighbour a[TZ_NEIGHBOURS_MAX + 8];
    draw_all(&r, 40, a, TZ_NEIGHBOURS_MAX + 8);
    assert_float_equal(cost(a, TZ_NEIGHBOURS_MAX + 8, a, TZ_NEIGHBOURS_MAX + 8), 0,
                       1e-12);
    assert_true(cost(a, -3, a, 5) == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_equal_costs_nothing),
        cmocka_unit_test(test_surplus_is_free),
        cmocka_unit_test(test_order_does_not_matter),
        cmocka_unit_test(test_one_pair),
        cmocka_unit_test(test_missing),
        cmocka_unit_test(test_each_pairs_once),
        cmocka_unit_test(test_against_optimal),
        cmocka_unit_test(test_too_many_are_cut),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
