/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Power diagrams: cells part the domain, each place lies in the cell of least power, what
 * is worked out locally is what is worked out anew. */
#include "tests/base/check.h"

#include <math.h>
#include <string.h>

#include "base/rng.h"
#include "fields/power.h"

enum { SITES = 400 };

static void scatter(int32_t n, tz_vec3 size, double large, tz_vec3 *at, double *w)
{
    for (int32_t i = 0; i < n; i++) {
        tz_rng g = tz_rng_make(11, (uint64_t)i);
        at[i] = (tz_vec3){tz_rng_unit(&g) * size.x, tz_rng_unit(&g) * size.y,
                          tz_rng_unit(&g) * size.z};
        const double r = large * pow(tz_rng_unit(&g), 3); /* few large ones */
        w[i] = r * r;
    }
}

static int32_t least_power(const tz_domain *d, int32_t n, const tz_vec3 *at,
                           const double *w, tz_vec3 p, double *gap)
{
    int32_t best = -1;
    double least = HUGE_VAL, second = HUGE_VAL;
    for (int32_t i = 0; i < n; i++) {
        const tz_vec3 v = tz_domain_vector(d, at[i], p);
        const double power = v.x * v.x + v.y * v.y - w[i];
        if (w[i] < 0)
            continue;
        if (power < least)
            second = least, least = power, best = i;
        else
            second = fmin(second, power);
    }
    *gap = second - least;
    return best;
}

static bool holds(const tz_power_corner *v, int32_t n, double x, double y)
{
    for (int32_t k = 0; k < n; k++) {
        const tz_power_corner *a = &v[k], *b = &v[(k + 1) % n];
        if ((b->x - a->x) * (y - a->y) - (b->y - a->y) * (x - a->x) < -1e-9)
            return false;
    }
    return n > 2;
}

/* Against the definition: each of many places lies in the cell of least power, and in no
 * other. */
static void cells_are_what_they_should(void **state)
{
    (void)state;
    for (int k = 0; k < 4; k++) {
        tz_ctx *ctx = new_ctx(2);
        tz_power *p;
        tz_vec3 at[SITES];
        double w[SITES], area = 0;
        const tz_domain d = {.size = {100, 70, 0}, .torus = k % 2 == 1};
        scatter(SITES, d.size, k < 2 ? 3 : 18, at, w);
        ok(ctx, tz_power_new(ctx, &d, &p));
        ok(ctx, tz_power_update(p, SITES, at, w));
        ok(ctx, tz_power_update(p, SITES, at, w)); /* now from known neighbours */
        const tz_power_cells c = tz_power_get(p);
        for (int32_t i = 0; i < SITES; i++)
            area += c.area[i];
        assert_true(fabs(area - 7000) < 1e-6);
        for (int32_t t = 0; t < 300; t++) {
            tz_rng g = tz_rng_make(5, (uint64_t)t);
            const tz_vec3 q = {tz_rng_unit(&g) * 100, tz_rng_unit(&g) * 70, 0};
            double gap;
            const int32_t best = least_power(&d, SITES, at, w, q, &gap);
            if (gap < 1e-6)
                continue;
            for (int32_t i = 0; i < SITES; i += i == best ? 1 : 7) {
                tz_power_corner v[128];
                const int32_t n = tz_power_cell(p, i, v, 128);
                const tz_vec3 e = tz_domain_vector(&d, at[i], q);
                assert_true(n <= 128);
                if (i != best || n == 0)
                    assert_true(!holds(v, n, e.x, e.y) || i == best);
            }
            tz_power_corner v[128];
            const int32_t n = tz_power_cell(p, best, v, 128);
            const tz_vec3 e = tz_domain_vector(&d, at[best], q);
            assert_true(holds(v, n, e.x, e.y));
        }
        tz_power_free(p);
        end_ctx(ctx);
    }
}

static void neighbours_are_mutual(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_power *p;
    tz_vec3 at[SITES];
    double w[SITES];
    const tz_domain d = {.size = {100, 100, 0}, .torus = true};
    int32_t pairs = 0, missing = 0;
    scatter(SITES, d.size, 6, at, w);
    ok(ctx, tz_power_new(ctx, &d, &p));
    ok(ctx, tz_power_update(p, SITES, at, w));
    const tz_power_cells c = tz_power_get(p);
    for (int32_t i = 0; i < SITES; i++)
        for (int32_t k = 0; k < c.count[i]; k++) {
            const int32_t q = c.neighbour[c.start[i] + k];
            bool back = false;
            for (int32_t e = 0; e < c.count[q]; e++)
                back = back || c.neighbour[c.start[q] + e] == i;
            pairs++, missing += !back;
            assert_true(q != i);
        }
    assert_true(missing == 0);
    assert_true(pairs > 3 * SITES);
    tz_power_free(p);
    end_ctx(ctx);
}

static void regions_clip(void **state)
{
    (void)state;
    enum { SIDE = 200 };
    static float mask[SIDE * SIDE];
    tz_ctx *ctx = new_ctx(2);
    tz_region *ring;
    tz_power *p;
    tz_vec3 at[SITES];
    double w[SITES], area = 0;
    const double pi = TZ_PI;
    for (int i = 0; i < SIDE * SIDE; i++) {
        const double x = i % SIDE + 0.5 - 100, y = i / SIDE + 0.5 - 100;
        mask[i] = (float)fmin(fmax(40.5 - fabs(hypot(x, y) - 55), 0), 1);
    }
    ok(ctx,
       tz_region_from_mask(ctx, mask, SIDE, SIDE, (tz_vec3){100, 100, 0}, false, &ring));
    const tz_domain d = {.size = {100, 100, 0}, .region = ring};
    scatter(SITES, d.size, 2, at, w);
    ok(ctx, tz_power_new(ctx, &d, &p));
    ok(ctx, tz_power_update(p, SITES, at, w));
    const tz_power_cells c = tz_power_get(p);
    for (int32_t i = 0; i < SITES; i++)
        area += c.area[i];
    const double exact = pi * (47.5 * 47.5 - 7.5 * 7.5);
    assert_true(fabs(area / exact - 1) < 0.005);
    tz_power_free(p);
    tz_region_free(ring);
    end_ctx(ctx);
}

/* Some sites move, some come, some go. */
static void changes_are_local(void **state)
{
    (void)state;
    for (int torus = 0; torus < 2; torus++) {
        tz_ctx *ctx = new_ctx(1);
        tz_power *p, *q;
        tz_vec3 at[SITES + 10];
        double w[SITES + 10];
        int32_t which[40], n = SITES;
        const tz_domain d = {.size = {80, 80, 0}, .torus = torus == 1};
        scatter(SITES + 10, d.size, 3, at, w);
        ok(ctx, tz_power_new(ctx, &d, &p));
        ok(ctx, tz_power_new(ctx, &d, &q));
        ok(ctx, tz_power_update(p, n, at, w));
        for (int round = 0; round < 6; round++) {
            int32_t k = 0;
            for (int32_t i = round; i < n && k < 20; i += 23) {
                tz_rng g = tz_rng_make(9, (uint64_t)(i + 1000 * round));
                at[i].x = fmin(fmax(at[i].x + tz_rng_range(&g, -4, 4), 0), 79.9);
                at[i].y = fmin(fmax(at[i].y + tz_rng_range(&g, -4, 4), 0), 79.9);
                if (round == 3)
                    w[i] = -1;
                which[k++] = i;
            }
            for (int32_t i = 0; i < 2 && n < SITES + 10; i++)
                which[k++] = n++;
            ok(ctx, tz_power_change(p, n, at, w, k, which));
            ok(ctx, tz_power_update(q, n, at, w));
            const tz_power_cells a = tz_power_get(p), b = tz_power_get(q);
            for (int32_t i = 0; i < n; i++) {
                assert_true(fabs(a.area[i] - b.area[i]) < 1e-9);
                assert_true(fabs(a.centre[i].x - b.centre[i].x) < 1e-9);
                assert_int_equal(a.count[i], b.count[i]);
            }
        }
        tz_power_free(p);
        tz_power_free(q);
        end_ctx(ctx);
    }
}

static void threads_do_not_matter(void **state)
{
    (void)state;
    static const int threads[] = {1, 2, 8};
    static tz_vec3 at[3000];
    static double w[3000], area[3][3000];
    const tz_domain d = {.size = {300, 200, 0}};
    scatter(3000, d.size, 4, at, w);
    for (int t = 0; t < 3; t++) {
        tz_ctx *ctx = new_ctx(threads[t]);
        tz_power *p;
        ok(ctx, tz_power_new(ctx, &d, &p));
        ok(ctx, tz_power_update(p, 3000, at, w));
        ok(ctx, tz_power_update(p, 3000, at, w));
        memcpy(area[t], tz_power_get(p).area, sizeof area[t]);
        tz_power_free(p);
        end_ctx(ctx);
    }
    assert_memory_equal(area[0], area[1], sizeof area[0]);
    assert_memory_equal(area[0], area[2], sizeof area[0]);
}

static void odd_input(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_power *p;
    tz_vec3 at[50];
    double w[50];
    const tz_domain none = {.size = {0, 5, 0}}, d = {.size = {10, 10, 0}, .torus = true};
    assert_int_equal(tz_power_new(ctx, &none, &p), TZ_INVALID);
    tz_ctx_clear(ctx);
    ok(ctx, tz_power_new(ctx, &d, &p));
    ok(ctx, tz_power_update(p, 0, at, w));
    for (int i = 0; i < 50; i++) /* all at one place: the first has it all */
        at[i] = (tz_vec3){3, 3, 0}, w[i] = 1;
    ok(ctx, tz_power_update(p, 50, at, w));
    assert_true(fabs(tz_power_get(p).area[0] - 100) < 1e-9);
    assert_true(tz_power_get(p).area[49] == 0);
    w[7] = 1e12; /* a giant hides all */
    ok(ctx, tz_power_update(p, 50, at, w));
    assert_true(fabs(tz_power_get(p).area[7] - 100) < 1e-6);
    at[3].x = NAN;
    assert_int_equal(tz_power_update(p, 50, at, w), TZ_INVALID);
    assert_int_equal(tz_power_get(p).n, 0);
    tz_power_free(p);
    end_ctx(ctx);
}

/* The solid's cells fill the box, neighbours are mutual, and Lloyd's steps even them. */
static void solids(void **state)
{
    (void)state;
    enum { N = 60, MOST = 48 };
    tz_ctx *ctx = new_ctx(1);
    tz_vec3 at[N], centre[N];
    double w[N], volume[N], before = 0, after = 0;
    static int32_t near[N * MOST];
    const tz_vec3 size = {10, 8, 6};
    scatter(N, size, 0.8, at, w);
    for (int round = 0; round < 12; round++) {
        double sum = 0, off = 0;
        ok(ctx, tz_power_solid(ctx, size, N, at, w, volume, centre, near, MOST));
        for (int i = 0; i < N; i++) {
            sum += volume[i];
            off += centre[i].x * centre[i].x + centre[i].y * centre[i].y +
                   centre[i].z * centre[i].z;
            for (int k = 0; k < MOST && near[i * MOST + k] >= 0; k++) {
                const int q = near[i * MOST + k];
                bool back = false;
                for (int e = 0; e < MOST && near[q * MOST + e] >= 0; e++)
                    back = back || near[q * MOST + e] == i;
                assert_true(back);
            }
        }
        assert_true(fabs(sum - 480) < 1e-6);
        *(round == 0 ? &before : &after) = off;
        for (int i = 0; i < N; i++)
            at[i] = (tz_vec3){at[i].x + centre[i].x, at[i].y + centre[i].y,
                              at[i].z + centre[i].z};
    }
    assert_true(after < 0.1 * before);
    assert_int_equal(tz_power_solid(ctx, size, N, at, w, volume, centre, near, 2),
                     TZ_LIMIT);
    end_ctx(ctx);
}

static tz_status diagrams(tz_ctx *ctx)
{
    tz_power *p = NULL;
    tz_vec3 at[60], centre[60];
    double w[60], volume[60];
    static int32_t near[60 * 48];
    int32_t which[3] = {1, 2, 3};
    const tz_domain d = {.size = {20, 20, 0}};
    scatter(60, (tz_vec3){20, 20, 20}, 1, at, w);
    tz_status s = tz_power_new(ctx, &d, &p);
    if (s == TZ_OK)
        s = tz_power_update(p, 50, at, w);
    at[2].x = 4;
    if (s == TZ_OK)
        s = tz_power_change(p, 60, at, w, 3, which);
    if (s == TZ_OK)
        s = tz_power_solid(ctx, (tz_vec3){20, 20, 20}, 60, at, w, volume, centre, near,
                           48);
    tz_power_free(p);
    return s;
}

static void survives_want_of_memory(void **state)
{
    (void)state;
    survive(diagrams, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cells_are_what_they_should),
        cmocka_unit_test(neighbours_are_mutual),
        cmocka_unit_test(regions_clip),
        cmocka_unit_test(changes_are_local),
        cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(odd_input),
        cmocka_unit_test(solids),
        cmocka_unit_test(survives_want_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
