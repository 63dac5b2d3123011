/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Likeness of element sets: the same process is alike, another is not; density, overlaps
 * and holes where they are known. */
#include "tests/base/check.h"

#include <math.h>

#include "elements/element_compare.h"
#include "elements/element_statistics.h"
#include "tests/elements/patterns.h"

static const tz_domain small = {.size = {120, 120, 0}, .torus = false},
                       large = {.size = {260, 240, 0}, .torus = false},
                       torus = {.size = {120, 120, 0}, .torus = true};

static tz_element_likeness likeness(tz_ctx *ctx, pattern a, tz_domain da, pattern b,
                                    tz_domain db)
{
    tz_element_set p, q;
    tz_element_likeness v;
    ok(ctx, pattern_make(ctx, &p, a, da, 1));
    ok(ctx, pattern_make(ctx, &q, b, db, 77));
    ok(ctx, tz_element_compare(ctx, &p, &q, &v));
    tz_element_set_deinit(&p);
    tz_element_set_deinit(&q);
    return v;
}

static void test_same_process(void **state)
{
    (void)state;
    static const pattern all[] = {PATTERN_SQUARE, PATTERN_CHESS, PATTERN_JITTER,
                                  PATTERN_RANDOM, PATTERN_MIXED};
    tz_ctx *ctx = new_ctx(2);
    for (size_t k = 0; k < sizeof all / sizeof all[0]; k++)
        for (int size = 0; size < 3; size++) {
            const tz_domain d = size == 0 ? small : size == 1 ? large : torus;
            const tz_element_likeness v = likeness(ctx, all[k], small, all[k], d);
            assert_in_range(v.mean * 100, 20, 125);
            assert_true(v.nearest < 1.7 && v.correlation < 1.7 && v.classes < 2.2);
            for (int r = 0; r < 3; r++)
                assert_true(v.neighbourhood[r] < 1.2 && v.distance[r] >= 0);
            assert_true(v.orientation == 1);
            assert_float_equal(v.density, 1, 0.01);
        }
    end_ctx(ctx);
}

static void test_itself(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    for (int p = 0; p <= PATTERN_MIXED; p++) {
        tz_element_set s;
        tz_element_likeness v;
        ok(ctx, pattern_make(ctx, &s, (pattern)p, small, 1));
        ok(ctx, tz_element_compare(ctx, &s, &s, &v));
        assert_true(v.mean <= 1 + 1e-9 && v.density == 1);
        assert_true(v.hole[0] == v.hole[1] && v.overlaps[0] == v.overlaps[1]);
        for (int r = 0; r < 3; r++)
            assert_true(v.distance[r] < 1e-3);
        tz_element_set_deinit(&s);
    }
    end_ctx(ctx);
}

static void test_other_process(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    const tz_element_likeness v =
        likeness(ctx, PATTERN_SQUARE, small, PATTERN_RANDOM, large);
    assert_true(v.nearest > 5 && v.correlation > 3 && v.mean > 3);
    for (int r = 0; r < 3; r++)
        assert_true(v.neighbourhood[r] > 3);
    assert_true(v.overlaps[0] == 0 && v.overlaps[1] > 0.3);
    assert_true(v.hole[1] > v.hole[0]);
    /* a lattice is no random set either, nor is one lattice the other */
    const tz_element_likeness w =
        likeness(ctx, PATTERN_RANDOM, large, PATTERN_SQUARE, large);
    assert_true(w.nearest > 2 && w.correlation > 1.5);
    const tz_element_likeness x =
        likeness(ctx, PATTERN_SQUARE, small, PATTERN_BRICK, large);
    assert_true(x.neighbourhood[1] > 2);
    /* one class where there were two */
    const tz_element_likeness y =
        likeness(ctx, PATTERN_CHESS, small, PATTERN_SQUARE, small);
    assert_true(y.classes > 10 && y.neighbourhood[0] > 2);
    end_ctx(ctx);
}

static void test_orientation(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set p, q;
    tz_element_likeness same, other;
    ok(ctx, pattern_make(ctx, &p, PATTERN_SQUARE, small, 1));
    ok(ctx, pattern_make(ctx, &q, PATTERN_SQUARE, small, 1));
    p.kind.v[0].oriented = q.kind.v[0].oriented = true;
    for (int32_t i = 0; i < p.element.n; i++) {
        tz_rng r = tz_rng_make(1, (uint64_t)i);
        p.element.v[i].angle = tz_rng_range(&r, -0.3, 0.3) + 20 * TZ_PI;
        q.element.v[i].angle = tz_rng_range(&r, -0.3, 0.3);
    }
    ok(ctx, tz_element_compare(ctx, &p, &q, &same));
    for (int32_t i = 0; i < q.element.n; i++)
        q.element.v[i].angle += 1.5;
    ok(ctx, tz_element_compare(ctx, &p, &q, &other));
    assert_true(same.orientation < 1.6 && other.orientation > 4);
    assert_true(other.neighbourhood[0] > 1.5 * same.neighbourhood[0]);
    tz_element_set_deinit(&p);
    tz_element_set_deinit(&q);
    end_ctx(ctx);
}

/* ---- holes, overlaps, density ---------------------------------------------------- */

static void test_holes(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set s;
    tz_element_likeness v;
    ok(ctx, pattern_make(ctx, &s, PATTERN_SQUARE, torus, 1));
    ok(ctx, tz_element_compare(ctx, &s, &s, &v));
    assert_float_equal(v.hole[0], 5 * sqrt(2.0) - 4, 0.1); /* in the middle of four */
    for (int32_t i = 0; i < s.element.n; i++)              /* one out at the seam */
        if (s.element.v[i].at.x == 2.5 && s.element.v[i].at.y == 115)
            s.element.v[i] = s.element.v[--s.element.n];
    ok(ctx, tz_element_compare(ctx, &s, &s, &v));
    assert_float_equal(v.hole[1], 10 - 4, 0.1);
    tz_element_set_deinit(&s);
    /* on a plain domain the disc stays inside it */
    ok(ctx,
       pattern_begin(ctx, &s, (tz_domain){.size = {100, 30, 0}, .torus = false}, 1, 2));
    ok(ctx, pattern_add(&s, 0, 5, 15));
    ok(ctx, pattern_add(&s, 0, 7, 20));
    ok(ctx, tz_element_compare(ctx, &s, &s, &v));
    assert_float_equal(v.hole[0], 15, 0.3);
    tz_element_set_deinit(&s);
    end_ctx(ctx);
}

/* Against a fine raster. */
static void test_hole_by_raster(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    for (int k = 0; k < 6; k++) {
        const tz_domain d = {.size = {70, 50, 0}, .torus = k % 2 == 1};
        tz_element_set s;
        tz_field f;
        double hole, best = 0;
        ok(ctx, pattern_make(ctx, &s, PATTERN_RANDOM, d, (uint64_t)k));
        for (int32_t i = 0; i < s.element.n; i++)
            s.element.v[i].radius = 0.5 + i % 4;
        ok(ctx, tz_field_init(ctx, &f, &s, (tz_vec2){0, 0}, (tz_vec2){1, 1}));
        ok(ctx, tz_field_hole(&f, &hole));
        for (double y = 0.1; y < 50; y += 0.2)
            for (double x = 0.1; x < 70; x += 0.2) {
                double room = d.torus ? 25 : fmin(fmin(x, 70 - x), fmin(y, 50 - y));
                for (int32_t i = 0; i < f.n; i++) {
                    const tz_vec3 v = tz_domain_vector(&d, (tz_vec3){x, y, 0}, f.at[i]);
                    room = fmin(room, hypot(v.x, v.y) - f.item[i].radius);
                }
                best = fmax(best, room);
            }
        assert_true(hole > best - 0.12 && hole < best + 0.15);
        tz_field_deinit(&f);
        tz_element_set_deinit(&s);
    }
    end_ctx(ctx);
}

static void test_overlaps_and_density(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set p, q;
    tz_element_likeness v;
    ok(ctx, pattern_make(ctx, &p, PATTERN_SQUARE, torus, 1));
    ok(ctx, pattern_make(ctx, &q, PATTERN_SQUARE, torus, 1));
    q.element.v[5].radius = 12; /* reaches its eight neighbours: 0.8 (12 + 4) = 12.8 */
    ok(ctx, pattern_add(&q, 0, 119, 60)); /* two more, across the seam of each other */
    ok(ctx, pattern_add(&q, 0, 0.5, 60.5));
    ok(ctx, tz_element_compare(ctx, &p, &q, &v));
    assert_true(v.overlaps[0] == 0);
    assert_float_equal(v.density, 146.0 / 144, 1e-12);
    assert_true(v.overlaps[1] > 6.0 / 146 && v.overlaps[1] < 13.0 / 146);
    q.kind.v[0].is_void = true; /* then nothing is there */
    ok(ctx, tz_element_compare(ctx, &p, &q, &v));
    assert_true(v.density == 0 && v.overlaps[1] == 0);
    assert_float_equal(v.hole[1], 60, 1e-9);
    tz_element_set_deinit(&p);
    tz_element_set_deinit(&q);
    end_ctx(ctx);
}

/* ---- odd inputs ------------------------------------------------------------------ */

static bool all_finite(const tz_element_likeness *v)
{
    const double *p = (const double *)(const void *)v;
    for (size_t k = 0; k < sizeof *v / sizeof *p; k++)
        if (!isfinite(p[k]) || p[k] < 0)
            return false;
    return true;
}

static void test_tiny_and_heaps(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set big;
    ok(ctx, pattern_make(ctx, &big, PATTERN_JITTER, small, 1));
    for (int32_t n = 0; n < 6; n++)
        for (int heap = 0; heap < 4; heap++) {
            const tz_domain d = {.size = {40, 25, 0}, .torus = heap / 2 == 1};
            tz_element_set s;
            tz_element_likeness v = {.mean = -5};
            ok(ctx, pattern_begin(ctx, &s, d, 2, 4));
            for (int32_t i = 0; i < n; i++)
                ok(ctx, pattern_add(&s, i % 2, heap % 2 ? 7 : 7 * i + 1,
                                    heap % 2 ? 9 : 3 * i));
            if (n < 2) {
                fails(ctx, tz_element_compare(ctx, &s, &big, &v), TZ_INVALID, "too few");
                fails(ctx, tz_element_compare(ctx, &big, &s, &v), TZ_INVALID, "too few");
                assert_true(v.mean == -5);
            } else {
                ok(ctx, tz_element_compare(ctx, &s, &big, &v));
                assert_true(all_finite(&v));
                ok(ctx, tz_element_compare(ctx, &big, &s, &v));
                assert_true(all_finite(&v));
                ok(ctx, tz_element_compare(ctx, &s, &s, &v));
                assert_true(all_finite(&v));
            }
            tz_element_set_deinit(&s);
        }
    tz_element_set_deinit(&big);
    end_ctx(ctx);
}

static tz_status compare_once(tz_ctx *ctx)
{
    tz_element_set p = {0}, q = {0};
    tz_element_likeness v;
    tz_status s = pattern_make(ctx, &p, PATTERN_MIXED,
                               (tz_domain){.size = {60, 50, 0}, .torus = true}, 1);
    if (s == TZ_OK)
        s = pattern_make(ctx, &q, PATTERN_MIXED,
                         (tz_domain){.size = {50, 60, 0}, .torus = false}, 2);
    if (s == TZ_OK)
        s = tz_element_compare(ctx, &p, &q, &v);
    tz_element_set_deinit(&p);
    tz_element_set_deinit(&q);
    return s;
}

static void test_memory_runs_out(void **state)
{
    (void)state;
    survive(compare_once, 1);
}

static void test_threads_do_not_matter(void **state)
{
    (void)state;
    static const int threads[] = {1, 2, 8};
    tz_element_likeness v[3];
    for (int k = 0; k < 3; k++) {
        tz_ctx *ctx = new_ctx(threads[k]);
        v[k] = likeness(ctx, PATTERN_MIXED, large, PATTERN_JITTER,
                        (tz_domain){.size = {800, 700, 0}, .torus = true});
        end_ctx(ctx);
        assert_memory_equal(&v[k], &v[0], sizeof v[k]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_process),
        cmocka_unit_test(test_itself),
        cmocka_unit_test(test_other_process),
        cmocka_unit_test(test_orientation),
        cmocka_unit_test(test_holes),
        cmocka_unit_test(test_hole_by_raster),
        cmocka_unit_test(test_overlaps_and_density),
        cmocka_unit_test(test_tiny_and_heaps),
        cmocka_unit_test(test_memory_runs_out),
        cmocka_unit_test(test_threads_do_not_matter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
