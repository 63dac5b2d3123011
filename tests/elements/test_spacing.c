/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Spacing: what an exemplar keeps apart, and layouts that are pushed apart. */
#include "tests/base/check.h"

#include <math.h>
#include <string.h>

#include "base/rng.h"
#include "elements/element_arrange.h"
#include "elements/spacing.h"
#include "tests/support/elements.h"

/* n elements at random, of the set's kinds in turn. */
static void scatter(tz_element_set *s, int32_t n, double radius)
{
    tz_rng g = tz_rng_make(3, 1);
    for (int32_t i = 0; i < n; i++)
        ok(s->ctx,
           drawn_add(s, tz_rng_unit(&g) * s->domain.size.x,
                     tz_rng_unit(&g) * s->domain.size.y, radius, i % s->kind.n, 0));
}

/* The least distance over the radii's sum. */
static double nearest(const tz_element_set *s)
{
    double least = HUGE_VAL;
    for (int32_t i = 0; i < s->element.n; i++)
        for (int32_t j = 0; j < i; j++) {
            const tz_element *a = &s->element.v[i], *b = &s->element.v[j];
            const tz_vec3 v = tz_domain_vector(&s->domain, a->at, b->at);
            least = fmin(least, hypot(v.x, v.y) / (a->radius + b->radius));
        }
    return least;
}

static void exemplars_are_measured(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set s;
    tz_spacing p;
    ok(ctx, drawn_squares(ctx, 12, 2, false, &s)); /* 10 apart, kinds alternate */
    ok(ctx, tz_spacing_init(ctx, &s, &p));
    const double sum = 2 * s.element.v[0].radius;
    assert_int_equal(p.kinds, 2);
    assert_true(fabs(p.least[1] - 10 / sum) < 1e-6);
    assert_true(fabs(p.least[2] - 10 / sum) < 1e-6);
    assert_true(p.least[0] >= p.least[1]); /* like ones stand across corners */
    tz_spacing_deinit(&p);
    tz_element_set_deinit(&s);
    ok(ctx, drawn_set(ctx, 10, 10, false, 3, &s)); /* nobody in it */
    ok(ctx, tz_spacing_init(ctx, &s, &p));
    for (int i = 0; i < 9; i++)
        assert_true(p.least[i] == 0);
    ok(ctx, tz_spacing_relax(&p, &s, 3));
    tz_spacing_deinit(&p);
    tz_element_set_deinit(&s);
    end_ctx(ctx);
}

static void layouts_are_pushed_apart(void **state)
{
    (void)state;
    for (int torus = 0; torus < 2; torus++) {
        tz_ctx *ctx = new_ctx(1);
        tz_element_set from, s;
        tz_spacing p;
        ok(ctx, drawn_hexagons(ctx, 10, 10, 0, false, &from));
        ok(ctx, tz_spacing_init(ctx, &from, &p));
        ok(ctx, drawn_set(ctx, 200, 200, torus == 1, 1, &s));
        scatter(&s, 150, 4.5); /* room for 460 */
        s.element.v[7].fixed = true;
        const tz_vec3 fixed = s.element.v[7].at;
        assert_true(nearest(&s) < 0.3);
        ok(ctx, tz_spacing_relax(&p, &s, 60));
        assert_true(nearest(&s) > 0.95 * p.least[0]);
        assert_memory_equal(&fixed, &s.element.v[7].at, sizeof fixed);
        for (int32_t i = 0; i < s.element.n; i++) {
            const tz_element *e = &s.element.v[i];
            assert_true(e->at.x >= 0 && e->at.x < 200 && e->at.y >= 0 && e->at.y < 200);
            assert_true(s.sample.v[e->sample].at.x == e->at.x);
        }
        tz_spacing_deinit(&p);
        tz_element_set_deinit(&from);
        tz_element_set_deinit(&s);
        end_ctx(ctx);
    }
}

static void heaps_come_apart(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set from, s;
    tz_spacing p;
    ok(ctx, drawn_hexagons(ctx, 8, 8, 0, false, &from));
    ok(ctx, tz_spacing_init(ctx, &from, &p));
    ok(ctx, drawn_set(ctx, 200, 200, false, 1, &s));
    for (int i = 0; i < 20; i++)
        ok(ctx, drawn_add(&s, 100, 100, 4.5, 0, 0));
    ok(ctx, tz_spacing_relax(&p, &s, 400));
    assert_true(nearest(&s) > 0.8 * p.least[0]);
    tz_spacing_deinit(&p);
    tz_element_set_deinit(&from);
    tz_element_set_deinit(&s);
    end_ctx(ctx);
}

static void threads_do_not_matter(void **state)
{
    (void)state;
    static const int threads[] = {1, 2, 8};
    tz_vec3 at[3][400];
    for (int t = 0; t < 3; t++) {
        tz_ctx *ctx = new_ctx(threads[t]);
        tz_element_set from, s;
        tz_spacing p;
        ok(ctx, drawn_hexagons(ctx, 10, 10, 0.4, false, &from));
        ok(ctx, tz_spacing_init(ctx, &from, &p));
        ok(ctx, drawn_set(ctx, 300, 300, true, 1, &s));
        scatter(&s, 400, 4.5);
        ok(ctx, tz_spacing_relax(&p, &s, 10));
        for (int i = 0; i < 400; i++)
            at[t][i] = s.element.v[i].at;
        tz_spacing_deinit(&p);
        tz_element_set_deinit(&from);
        tz_element_set_deinit(&s);
        end_ctx(ctx);
    }
    assert_memory_equal(at[0], at[1], sizeof at[0]);
    assert_memory_equal(at[0], at[2], sizeof at[0]);
}

/* The whole arrangement, growth and solver, at any thread count. */
static void arrangements_are_the_same_at_any_threads(void **state)
{
    (void)state;
    static const int threads[] = {1, 2, 8};
    tz_element *first = NULL;
    int32_t n = 0;
    for (int t = 0; t < 3; t++) {
        tz_ctx *ctx = new_ctx(threads[t]);
        tz_element_set from, s;
        tz_element_arrange_params p;
        tz_element_arrange_report report;
        const tz_domain d = {.size = {250, 180, 0}, .torus = true};
        tz_params_default(&tz_element_arrange_param_table, &p);
        ok(ctx, drawn_mixed(ctx, 150, false, &from));
        ok(ctx, tz_element_set_like(ctx, &from, &d, &s));
        const tz_element_arrange_job job = {
            .exemplar = &from, .name = "mixed", .params = &p, .seed = 5};
        ok(ctx, tz_element_arrange(ctx, &job, &s, &report));
        assert_int_equal(report.elements, s.element.n);
        assert_true(report.filled > 0.85 && report.filled < 1.15);
        if (t == 0) {
            n = s.element.n;
            first = malloc((size_t)n * sizeof *first);
            assert_non_null(first);
            memcpy(first, s.element.v, (size_t)n * sizeof *first);
        }
        assert_int_equal(n, s.element.n);
        for (int32_t i = 0; i < n; i++) {
            assert_memory_equal(&first[i].at, &s.element.v[i].at, sizeof first->at);
            assert_int_equal(first[i].source, s.element.v[i].source);
            assert_true(first[i].angle == s.element.v[i].angle);
        }
        tz_element_set_deinit(&from);
        tz_element_set_deinit(&s);
        end_ctx(ctx);
    }
    free(first);
}

static tz_status arrange_in(tz_ctx *ctx)
{
    tz_element_set from = {0}, s = {0};
    tz_element_arrange_params p;
    const tz_domain d = {.size = {120, 90, 0}};
    tz_params_default(&tz_element_arrange_param_table, &p);
    const tz_element_arrange_job job = {
        .exemplar = &from, .name = "hexagons", .params = &p, .seed = 5};
    tz_status st = drawn_hexagons(ctx, 6, 6, 0.5, false, &from);
    if (st == TZ_OK)
        st = tz_element_set_like(ctx, &from, &d, &s);
    if (st == TZ_OK)
        st = tz_element_arrange(ctx, &job, &s, NULL);
    tz_element_set_deinit(&from);
    tz_element_set_deinit(&s);
    return st;
}

static void survives_want_of_memory(void **state)
{
    (void)state;
    survive(arrange_in, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exemplars_are_measured),
        cmocka_unit_test(layouts_are_pushed_apart),
        cmocka_unit_test(heaps_come_apart),
        cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(arrangements_are_the_same_at_any_threads),
        cmocka_unit_test(survives_want_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
