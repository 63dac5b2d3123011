/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Growth of things that have shapes of their own: they do not overlap, take turns, keep
 * away from their twins, and leave no holes. */
#include "tests/base/check.h"

#include <math.h>

#include "base/rng.h"
#include "elements/element_compare.h"
#include "elements/extent.h"
#include "tests/elements/growing.h"

static tz_status give_outline(tz_ctx *ctx, tz_element_symbol *y, const tz_vec2 *p,
                              int32_t n)
{
    y->radius = 0;
    y->part.n = y->outline.n = 0;
    tz_status s = tz_array_push(ctx, &y->part, 0);
    for (int32_t i = 0; i < n && s == TZ_OK; i++) {
        s = tz_array_push(ctx, &y->outline, p[i]);
        y->radius = fmax(y->radius, tz_vec2_length(p[i]));
    }
    return s;
}

static tz_status add_symbol(tz_ctx *ctx, tz_element_set *set)
{
    const tz_element_symbol none = {.radius = 1};
    tz_status s = tz_array_push(ctx, &set->symbol, none);
    if (s == TZ_OK)
        s = tz_strdup(ctx, "stone", &set->symbol.v[set->symbol.n - 1].id);
    if (s == TZ_OK)
        s = tz_strdup(ctx, "", &set->symbol.v[set->symbol.n - 1].markup);
    return s;
}

/* Bars of 18 x 4 in rows, 22 x 6 apart. */
static void draw_bars(tz_ctx *ctx, tz_element_set *s)
{
    const tz_vec2 bar[4] = {{-9, -2}, {9, -2}, {9, 2}, {-9, 2}};
    ok(ctx, drawn_set(ctx, 220, 120, false, 1, s));
    ok(ctx, give_outline(ctx, &s->symbol.v[0], bar, 4));
    for (int32_t j = 0; j < 20; j++)
        for (int32_t i = 0; i < 10; i++)
            ok(ctx, drawn_add(s, 11 * (j % 2) + 22 * i, 3 + 6 * j, s->symbol.v[0].radius,
                              0, 0));
}

/* Stones, each of its own shape, on a loose lattice; those of the border are cut. */
static tz_status draw_stones(tz_ctx *ctx, int32_t n, tz_element_set *set)
{
    tz_status s = drawn_set(ctx, 10.0 * n, 10.0 * n, false, 1, set);
    for (int32_t k = 0; k < n * n && s == TZ_OK; k++) {
        const int32_t i = k % n, j = k / n;
        tz_rng r = tz_rng_make(11, (uint64_t)k);
        tz_vec2 p[12];
        const double size = tz_rng_range(&r, 3.4, 4.4);
        const double x = 10 * i + 5 + tz_rng_range(&r, -0.4, 0.4),
                     y = 10 * j + 5 + tz_rng_range(&r, -0.4, 0.4);
        for (int32_t m = 0; m < 12; m++) {
            const double d = size * tz_rng_range(&r, 0.75, 1);
            p[m] = (tz_vec2){d * cos(m * TZ_PI / 6), d * sin(m * TZ_PI / 6)};
        }
        if (k > 0)
            s = add_symbol(ctx, set);
        if (s == TZ_OK)
            s = give_outline(ctx, &set->symbol.v[k], p, 12);
        if (s == TZ_OK)
            s = drawn_add(set, x, y, set->symbol.v[k].radius, 0, 0);
        if (s == TZ_OK) {
            set->element.v[k].symbol = k;
            set->element.v[k].cut = i == 0 || j == 0 || i == n - 1 || j == n - 1;
        }
    }
    if (s != TZ_OK)
        tz_element_set_deinit(set);
    return s;
}

/* Least distance over the one at which two touch. */
static double closest(tz_ctx *ctx, const tz_element_set *s)
{
    tz_extents x;
    double least = INFINITY;
    ok(ctx, tz_extents_init(ctx, s, &x));
    for (int32_t i = 0; i < s->element.n; i++)
        for (int32_t k = 0; k < i; k++) {
            const tz_element *a = &s->element.v[i], *b = &s->element.v[k];
            const double dx = b->at.x - a->at.x, dy = b->at.y - a->at.y;
            least = fmin(least, hypot(dx, dy) / tz_extent_touch(&x, a, b, dx, dy));
        }
    tz_extents_deinit(&x);
    return least;
}

static void grow_twice(tz_ctx *ctx, const tz_element_set *ex, int32_t budget,
                       tz_element_set *out)
{
    const tz_growth_params p = growing_params();
    const tz_growth_texture all = {.scale = 1};
    const tz_domain d = {.size = {2 * ex->domain.size.x, 2 * ex->domain.size.y, 0}};
    ok(ctx, tz_element_set_like(ctx, ex, &d, out));
    ok(ctx, growing_run(ctx, ex, &all, 1, &p, budget, out));
}

/* Side by side bars are nearer than their circles would let them be, and end to end they
 * are not. */
static void test_bars(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set ex, out;
    tz_element_likeness l;
    draw_bars(ctx, &ex);
    grow_twice(ctx, &ex, 1000, &out);
    assert_true(closest(ctx, &ex) > 1);
    assert_true(closest(ctx, &out) >= 0.96 * closest(ctx, &ex));
    ok(ctx, tz_element_compare(ctx, &ex, &out, &l));
    growing_near(l.density, 1, 0.05);
    tz_element_set_deinit(&ex);
    tz_element_set_deinit(&out);
    end_ctx(ctx);
}

static void test_stones(void **state)
{
    (void)state;
    enum { N = 10, WHOLE = 8 * 8 };
    tz_ctx *ctx = new_ctx(1);
    tz_element_set ex, out;
    tz_element_likeness l;
    int32_t uses[N * N] = {0}, even = 0;
    ok(ctx, draw_stones(ctx, N, &ex));
    grow_twice(ctx, &ex, 1000, &out);
    assert_true(closest(ctx, &out) >= 0.96 * fmin(1, closest(ctx, &ex)));
    for (int32_t i = 0; i < out.element.n; i++) {
        const tz_element *e = &out.element.v[i];
        assert_false(ex.element.v[e->source].cut);
        uses[e->source]++;
        for (int32_t k = 0; k < i; k++) { /* twins are not neighbours */
            const tz_element *o = &out.element.v[k];
            if (o->source == e->source)
                assert_true(hypot(o->at.x - e->at.x, o->at.y - e->at.y) > 15);
        }
    }
    const double mean = (double)out.element.n / WHOLE;
    for (int32_t k = 0; k < N * N; k++)
        even += !ex.element.v[k].cut && uses[k] >= 0.5 * mean && uses[k] <= 1.5 * mean;
    assert_true(even >= 0.9 * WHOLE);
    ok(ctx, tz_element_compare(ctx, &ex, &out, &l));
    growing_near(l.density, 1, 0.05);
    tz_element_set_deinit(&ex);
    tz_element_set_deinit(&out);
    end_ctx(ctx);
}

/* Room in random textures is no wider than in what they are grown from. */
static void test_holes(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    for (int k = 0; k < 3; k++) {
        tz_element_set ex, out;
        tz_element_likeness l;
        if (k == 0)
            ok(ctx, drawn_darts(ctx, 200, 8, 300, 1, false, &ex));
        else if (k == 1)
            ok(ctx, drawn_darts(ctx, 150, 8, 300, 3, false, &ex));
        else
            ok(ctx, draw_stones(ctx, 10, &ex));
        grow_twice(ctx, &ex, 1000, &out);
        ok(ctx, tz_element_compare(ctx, &ex, &out, &l));
        assert_true(l.hole[1] <= 1.2 * l.hole[0]);
        tz_element_set_deinit(&ex);
        tz_element_set_deinit(&out);
    }
    end_ctx(ctx);
}

static void test_same_bytes(void **state)
{
    (void)state;
    const int threads[] = {1, 2, 8};
    const int32_t budget[] = {1000000, 1, 37};
    uint64_t first = 0;
    for (int k = 0; k < 3; k++) {
        tz_ctx *ctx = new_ctx(threads[k]);
        tz_element_set ex, out;
        ok(ctx, draw_stones(ctx, 9, &ex));
        grow_twice(ctx, &ex, budget[k], &out);
        if (k == 0)
            first = growing_digest(&out);
        assert_true(growing_digest(&out) == first);
        tz_element_set_deinit(&ex);
        tz_element_set_deinit(&out);
        end_ctx(ctx);
    }
}

static tz_status grow_stones(tz_ctx *ctx)
{
    tz_element_set ex, out;
    const tz_growth_params p = growing_params();
    const tz_growth_texture all = {.scale = 1};
    const tz_domain d = {.size = {90, 70, 0}};
    tz_status s = draw_stones(ctx, 6, &ex);
    if (s != TZ_OK)
        return s;
    s = tz_element_set_like(ctx, &ex, &d, &out);
    if (s == TZ_OK)
        s = growing_run(ctx, &ex, &all, 1, &p, 20, &out);
    tz_element_set_deinit(&ex);
    tz_element_set_deinit(&out);
    return s;
}

static void test_out_of_memory(void **state)
{
    (void)state;
    survive(grow_stones, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bars),          cmocka_unit_test(test_stones),
        cmocka_unit_test(test_holes),         cmocka_unit_test(test_same_bytes),
        cmocka_unit_test(test_out_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
