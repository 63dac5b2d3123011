/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Assignment against all assignments there are. */
#include "tests/base/check.h"

#include <math.h>

#include "base/rng.h"
#include "curves/assign.h"

static double brute(const tz_assign *a, int32_t i, uint32_t used)
{
    if (i == a->rows)
        return 0;
    double best = (double)a->exit[i] + brute(a, i + 1, used);
    for (int32_t j = 0; j < a->cols; j++)
        if (!(used >> j & 1))
            best = fmin(best, (double)a->cost[i][j] + brute(a, i + 1, used | 1u << j));
    return best;
}

/* Costs as they come: even, with ties, with some that never may be. */
static void draw(tz_assign *a, tz_rng *g, int32_t rows, int32_t cols, int kind)
{
    a->rows = rows;
    a->cols = cols;
    for (int32_t i = 0; i < rows; i++) {
        a->exit[i] = kind == 2 && i % 2 ? INFINITY : (float)tz_rng_range(g, 0.2, 1.5);
        for (int32_t j = 0; j < cols; j++) {
            a->cost[i][j] = (float)tz_rng_unit(g);
            if (kind == 1)
                a->cost[i][j] = (float)tz_rng_below(g, 4);
            if (kind == 2 && tz_rng_below(g, 4) == 0)
                a->cost[i][j] = INFINITY;
        }
    }
}

static void is_assignment(const tz_assign *a, double cost)
{
    uint64_t used = 0;
    double sum = 0;
    for (int32_t i = 0; i < a->rows; i++) {
        const int32_t j = a->to[i];
        assert_true(j >= -1 && j < a->cols);
        if (j >= 0) {
            assert_false(used >> j & 1);
            used |= (uint64_t)1 << j;
        }
        sum += (double)(j < 0 ? a->exit[i] : a->cost[i][j]);
    }
    assert_true(fabs(sum - cost) <= 1e-5 * (1 + cost));
}

/* Feasible and complementary duals prove that there is no better one. */
static void is_optimal(const tz_assign *a)
{
    const double e = 2e-5;
    for (int32_t i = 0; i < a->rows; i++) {
        assert_true((double)a->exit[i] >= (double)a->u[i] - e);
        for (int32_t j = 0; j < a->cols; j++)
            assert_true((double)a->cost[i][j] >= (double)a->u[i] + (double)a->v[j] - e);
        const int32_t j = a->to[i];
        const double has =
            j < 0 ? (double)a->exit[i] : (double)a->cost[i][j] - (double)a->v[j];
        assert_true(fabs(has - (double)a->u[i]) <= e);
    }
    for (int32_t j = 0; j < a->cols; j++) {
        assert_true((double)a->v[j] <= e);
        if (a->row[j] < 0)
            assert_true((double)a->v[j] >= -e);
    }
}

static void test_brute(void **state)
{
    (void)state;
    static tz_assign a;
    tz_rng g = tz_rng_make(7, 1);
    for (int n = 0; n < 3000; n++) {
        draw(&a, &g, tz_rng_below(&g, 6), tz_rng_below(&g, 7), n % 3);
        const double best = brute(&a, 0, 0),
                     found = (double)tz_assign_solve(&a, 0, INFINITY);
        if (isinf(best)) {
            assert_true(isinf(found));
            continue;
        }
        assert_true(fabs(found - best) <= 1e-5 * (1 + best));
        is_assignment(&a, found);
        is_optimal(&a);
    }
}

/* Large ones cannot be tried out, but their duals prove them. */
static void test_large(void **state)
{
    (void)state;
    static tz_assign a;
    tz_rng g = tz_rng_make(8, 1);
    for (int n = 0; n < 600; n++) {
        draw(&a, &g, 1 + tz_rng_below(&g, 64), 1 + tz_rng_below(&g, 64), n % 2);
        is_assignment(&a, (double)tz_assign_solve(&a, false, INFINITY));
        is_optimal(&a);
    }
}

/* A warm start finds the same cost, whatever problem the duals come from. */
static void test_warm(void **state)
{
    (void)state;
    static tz_assign a, b;
    tz_rng g = tz_rng_make(9, 1);
    for (int n = 0; n < 2000; n++) {
        draw(&a, &g, 1 + tz_rng_below(&g, 30), 1 + tz_rng_below(&g, 30), n % 3);
        (void)tz_assign_solve(&a, false, INFINITY);
        if (n % 2) /* a little other */
            for (int32_t i = 0; i < a.rows; i++)
                for (int32_t j = 0; j < a.cols; j++)
                    a.cost[i][j] += (float)tz_rng_range(&g, 0, 0.1);
        else /* another */
            draw(&a, &g, 1 + tz_rng_below(&g, 30), a.cols, n % 3);
        b = a;
        const double cold = (double)tz_assign_solve(&b, false, INFINITY),
                     warm = (double)tz_assign_solve(&a, true, INFINITY);
        if (isinf(cold)) {
            assert_true(isinf(warm));
            continue;
        }
        assert_true(fabs(cold - warm) <= 1e-4 * (1 + cold));
        is_assignment(&a, warm);
        is_optimal(&a);
    }
}

/* What is given up was too much, and nothing else is. */
static void test_enough(void **state)
{
    (void)state;
    static tz_assign a;
    tz_rng g = tz_rng_make(10, 1);
    for (int n = 0; n < 2000; n++) {
        draw(&a, &g, 1 + tz_rng_below(&g, 20), 1 + tz_rng_below(&g, 20), n % 3);
        const float cost = tz_assign_solve(&a, false, INFINITY);
        if (isinf(cost))
            continue;
        assert_true(tz_assign_bound(&a, false) <= cost * 1.0001f);
        const float at = cost * (float)tz_rng_range(&g, 0.5, 1.5);
        const float again = tz_assign_solve(&a, false, at);
        assert_true(cost < at ? again == cost : isinf(again));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_brute),
        cmocka_unit_test(test_large),
        cmocka_unit_test(test_warm),
        cmocka_unit_test(test_enough),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
