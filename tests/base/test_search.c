/* SPDX-License-Identifier: Apache-2.0 */
/* Grid, k-d tree and descriptor search against brute force; least squares. */
#include "tests/base/check.h"

#include <math.h>

#include "base/grid.h"
#include "base/kdtree.h"
#include "base/knn.h"
#include "base/lsq.h"
#include "base/rng.h"

enum { N = 700 };

static void grid_against_brute_force(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    for (int wrap = 0; wrap < 2; wrap++) {
        tz_rng r = tz_rng_make(3, (uint64_t)wrap);
        tz_vec2 size = {100, 60}, origin = {-20, 7}, p[N];
        bool gone[N] = {false};
        tz_grid g;
        ok(ctx, tz_grid_init(ctx, &g, origin, size, 7.3, wrap));
        for (int i = 0; i < N; i++) {
            int32_t id;
            p[i] = (tz_vec2){tz_rng_range(&r, -60, 120), tz_rng_range(&r, -40, 100)};
            ok(ctx, tz_grid_add(ctx, &g, p[i], &id));
            assert_int_equal(id, i);
        }
        for (int i = 0; i < N; i += 3) {
            tz_grid_remove(&g, i);
            tz_grid_remove(&g, i); /* twice is harmless */
            gone[i] = true;
        }
        for (int k = 0; k < 300; k++) {
            tz_vec2 q = {tz_rng_range(&r, -80, 150), tz_rng_range(&r, -60, 120)};
            double radius = tz_rng_range(&r, 0, k % 20 == 0 ? 200 : 20);
            int32_t out[N], few[5], expected[N], n = 0;
            for (int i = 0; i < N; i++) {
                double dx = p[i].x - q.x, dy = p[i].y - q.y;
                if (wrap) {
                    dx -= size.x * nearbyint(dx / size.x);
                    dy -= size.y * nearbyint(dy / size.y);
                }
                if (!gone[i] && dx * dx + dy * dy <= radius * radius)
                    expected[n++] = i;
            }
            assert_int_equal(tz_grid_query(&g, q, radius, out, N), n);
            for (int i = 0; i < n; i++)
                assert_int_equal(out[i], expected[i]);
            assert_int_equal(tz_grid_query(&g, q, radius, few, 5), n);
            for (int i = 0; i < n && i < 5; i++)
                assert_int_equal(few[i], expected[i]);
        }
        fails(ctx, tz_grid_add(ctx, &g, (tz_vec2){NAN, 0}, NULL), TZ_INVALID, "point");
        tz_grid_deinit(ctx, &g);
    }
    tz_grid g;
    fails(ctx, tz_grid_init(ctx, &g, (tz_vec2){0, 0}, (tz_vec2){1, 1}, 0, false),
          TZ_INVALID, "grid");
    ok(ctx, tz_grid_init(ctx, &g, (tz_vec2){0, 0}, (tz_vec2){1e9, 1e9}, 1e-3, false));
    assert_true((int64_t)g.nx * g.ny <= 1 << 24);
    tz_grid_deinit(ctx, &g);
    end_ctx(ctx);
}

static void fill(tz_rng *r, float *p, int n, bool coarse)
{
    for (int i = 0; i < n; i++) /* coarse: many ties */
        p[i] = coarse ? (float)tz_rng_below(r, 4) : (float)tz_rng_unit(r);
}

static int32_t brute(const float *p, int32_t n, int32_t dim, const float *q, int32_t k,
                     int32_t *id, float *d2)
{
    int32_t found = 0;
    for (int32_t i = 0; i < n; i++) {
        float d = 0;
        for (int32_t c = 0; c < dim; c++)
            d += (p[i * dim + c] - q[c]) * (p[i * dim + c] - q[c]);
        if (found == k && d >= d2[k - 1])
            continue;
        int32_t at = found < k ? found++ : k - 1;
        for (; at > 0 && d < d2[at - 1]; at--) {
            d2[at] = d2[at - 1];
            id[at] = id[at - 1];
        }
        d2[at] = d;
        id[at] = i;
    }
    return found;
}

static void kdtree_against_brute_force(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_rng r = tz_rng_make(4, 0);
    static float p[N * 16], q[16];
    for (int round = 0; round < 60; round++) {
        int32_t dim = 1 + round % 16, n = round % 5 == 0 ? round : N, k = 1 + round % 11;
        bool coarse = round % 2;
        tz_kdtree t;
        fill(&r, p, n * dim, coarse);
        ok(ctx, tz_kdtree_init(ctx, &t, p, n, dim));
        for (int i = 0; i < 50; i++) {
            int32_t a[16], b[16];
            float da[16], db[16];
            fill(&r, q, dim, coarse);
            int32_t found = tz_kdtree_nearest(&t, q, k, a, da);
            assert_int_equal(found, k < n ? k : n);
            assert_int_equal(found, brute(p, n, dim, q, k, b, db));
            for (int j = 0; j < found; j++) {
                assert_int_equal(a[j], b[j]);
                assert_true(da[j] == db[j]);
            }
        }
        tz_kdtree_deinit(&t);
    }
    tz_kdtree t;
    p[5] = NAN;
    fails(ctx, tz_kdtree_init(ctx, &t, p, 10, 2), TZ_INVALID, "not finite");
    fails(ctx, tz_kdtree_init(ctx, &t, p, 10, 17), TZ_INVALID, "dimensions");
    end_ctx(ctx);
}

static void equal_points_in_a_kdtree(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    static float p[2 * 20000];
    tz_kdtree t;
    ok(ctx, tz_kdtree_init(ctx, &t, p, 20000, 2)); /* must not take quadratic time */
    int32_t id[3];
    float d[3], q[2] = {1, 0};
    assert_int_equal(tz_kdtree_nearest(&t, q, 3, id, d), 3);
    for (int i = 0; i < 3; i++)
        assert_int_equal(id[i], i);
    tz_kdtree_deinit(&t);
    end_ctx(ctx);
}

static void descriptors(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    enum { DIM = 40, Q = 60, K = 4 };
    tz_rng r = tz_rng_make(5, 0);
    static float p[N * DIM], q[Q * DIM], d[2][Q * K];
    static int32_t id[2][Q * K];
    fill(&r, p, N * DIM, false);
    for (int i = 0; i < Q * DIM; i++)
        q[i] = p[i] + 0.01f * (float)tz_rng_unit(&r);
    ok(ctx, tz_knn(ctx, p, N, DIM, q, Q, K, true, id[0], d[0]));
    for (int i = 0; i < Q; i++) {
        int32_t b[K];
        float db[K];
        brute(p, N, DIM, q + i * DIM, K, b, db);
        for (int j = 0; j < K; j++)
            assert_int_equal(id[0][i * K + j], b[j]);
    }
    for (int round = 0; round < 2; round++)
        ok(ctx, tz_knn(ctx, p, N, DIM, q, Q, K, false, id[round], d[round]));
    assert_memory_equal(id[0], id[1], sizeof id[0]);
    int right = 0;
    for (int i = 0; i < Q; i++)
        right += id[0][i * K] == i;
    assert_true(right > Q * 9 / 10);
    ok(ctx, tz_knn(ctx, p, 2, DIM, q, 1, K, true, id[0], d[0]));
    assert_int_equal(id[0][2], -1);
    end_ctx(ctx);
}

static tz_status grow_search(tz_ctx *ctx)
{
    static const float p[40] = {1, 2, 3};
    tz_kdtree t;
    tz_grid g;
    tz_status s = tz_kdtree_init(ctx, &t, p, 20, 2);
    if (s != TZ_OK)
        return s;
    s = tz_grid_init(ctx, &g, (tz_vec2){0, 0}, (tz_vec2){9, 9}, 1, false);
    for (int i = 0; i < 30 && s == TZ_OK; i++)
        s = tz_grid_add(ctx, &g, (tz_vec2){i, i}, NULL);
    tz_grid_deinit(ctx, &g);
    tz_kdtree_deinit(&t);
    return s;
}

static void failures_leave_nothing(void **state)
{
    (void)state;
    survive(grow_search, 1);
}

/* Fits a line to points on it, twice with the same pattern, two right-hand sides. */
static void line_fit(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_lsq *s;
    ok(ctx, tz_lsq_new(ctx, 2, 2, &s));
    for (int round = 0; round < 3; round++) {
        for (int i = 0; i < 50; i++) {
            double x = i * 0.5 + round, coeff[2] = {x, 1}, b[2] = {3 * x + 4, -x + round};
            int32_t index[2] = {0, 1};
            ok(ctx, tz_lsq_add(s, 2, index, coeff, b, 1 + i % 3));
        }
        double x[4];
        ok(ctx, tz_lsq_solve(s, x));
        const double expected[4] = {3, 4, -1, round};
        for (int i = 0; i < 4; i++)
            assert_true(fabs(x[i] - expected[i]) < 1e-9);
        tz_lsq_clear(s);
    }
    tz_lsq_free(s);
    tz_lsq_free(NULL);
    end_ctx(ctx);
}

static void weights_and_repeats(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_lsq *s;
    double x, one = 1, b0 = 0, b1 = 10;
    int32_t index[2] = {0, 0};
    double half[2] = {0.5, 0.5};
    ok(ctx, tz_lsq_new(ctx, 1, 1, &s));
    ok(ctx, tz_lsq_add(s, 1, index, &one, &b0, 1));
    ok(ctx, tz_lsq_add(s, 2, index, half, &b1, 3)); /* the same unknown twice adds up */
    ok(ctx, tz_lsq_solve(s, &x));
    assert_true(fabs(x - 9) < 1e-12); /* (0 * 1 + 10 * 9) / (1 + 9) */
    tz_lsq_free(s);
    end_ctx(ctx);
}

static void singular_systems(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_lsq *s;
    double x[3] = {7, 7, 7}, coeff[2] = {1, -1}, b = 0;
    int32_t index[2] = {0, 1}, wrong = 3;
    ok(ctx, tz_lsq_new(ctx, 3, 1, &s));
    fails(ctx, tz_lsq_solve(s, x), TZ_INVALID, "do not determine");
    ok(ctx, tz_lsq_add(s, 2, index, coeff, &b, 1));
    fails(ctx, tz_lsq_solve(s, x), TZ_INVALID, "do not determine");
    assert_true(x[0] == 7);
    fails(ctx, tz_lsq_add(s, 1, &wrong, coeff, &b, 1), TZ_INVALID, "unknown");
    b = NAN;
    fails(ctx, tz_lsq_add(s, 2, index, coeff, &b, 1), TZ_INVALID, "right-hand");
    tz_lsq_free(s);
    fails(ctx, tz_lsq_new(ctx, 0, 1, &s), TZ_INVALID, "unknowns");
    end_ctx(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(grid_against_brute_force),
        cmocka_unit_test(kdtree_against_brute_force),
        cmocka_unit_test(equal_points_in_a_kdtree),
        cmocka_unit_test(descriptors),
        cmocka_unit_test(failures_leave_nothing),
        cmocka_unit_test(line_fit),
        cmocka_unit_test(weights_and_repeats),
        cmocka_unit_test(singular_systems),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
