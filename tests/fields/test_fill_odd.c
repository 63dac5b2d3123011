/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Element fields by hand, and bad input: strokes, layouts and brushes that make no sense.
 * Each ends in time, with one clear line or a sound layout. */
#include "tests/base/check.h"

#include "base/rng.h"
#include "tests/fields/filling.h"

/* ---- strokes ------------------------------------------------------------------------ */

static void strokes_that_say_nothing(void **state)
{
    (void)state;
    bed b;
    bed_lay(&b, 1, 120, 1, 5);
    const tz_element_field_stroke pen = {.radius = 4, .weight = 1, .directed = true};
    const tz_element_field_point out[2] = {{{-500, 7}, 2, 1}, {{-400, 7}, 2, 1}},
                                 still[3] = {{{50, 50}, 0, -1},
                                             {{50, 50}, 0, -1},
                                             {{50, 50}, 0, -1}},
                                 one[1] = {{{60, 60}, 1.1, 0.9}},
                                 far[2] = {{{-1e300, 5}, 0, -1}, {{1e300, 6}, 0, -1}};
    tz_element_field_deinit(&b.field);
    ok(b.ctx, tz_element_field_init(b.ctx, b.domain.size, false, 64, &b.field));
    ok(b.ctx, tz_element_field_add(&b.field, pen, 2, out));
    ok(b.ctx, tz_element_field_add(&b.field, pen, 3, still));
    ok(b.ctx, tz_element_field_settle(&b.field));
    for (int k = 0; k < 3; k++) /* as if there were no strokes */
        assert_int_equal(b.field.nearest[k][0], -1);
    ok(b.ctx, tz_element_field_add(&b.field, pen, 1, one));
    ok(b.ctx, tz_element_field_add(&b.field, pen, 2, far));
    ok(b.ctx, tz_element_field_settle(&b.field));
    ok(b.ctx, tz_fill_run(b.ctx, &b.job, &b.layout, NULL));
    filling_sound(b.ctx, &b.layout);
    bed_clear(&b);
}

static void strokes_out_of_range(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_field f;
    const tz_vec3 size = {100, 100, 0};
    ok(ctx, tz_element_field_init(ctx, size, false, 32, &f));
    const double not [] = {NAN, INFINITY, -INFINITY};
    for (int k = 0; k < 3; k++) {
        tz_element_field_point p[2] = {{{1, 1}, 1, 1}, {{2, 2}, 1, 1}};
        tz_element_field_stroke s = {.radius = 1, .weight = 1, .directed = true};
        p[1].at.y = not [k];
        fails(ctx, tz_element_field_add(&f, s, 2, p), TZ_INVALID, "point 1");
        p[1].at.y = 2, p[1].size = not [k];
        fails(ctx, tz_element_field_add(&f, s, 2, p), TZ_INVALID, "size");
        p[1].size = -1;
        fails(ctx, tz_element_field_add(&f, s, 2, p), TZ_INVALID, "size");
        p[1].size = 1, s.radius = not [k];
        fails(ctx, tz_element_field_add(&f, s, 2, p), TZ_INVALID, "radius");
        s.radius = 1, s.weight = not [k];
        fails(ctx, tz_element_field_add(&f, s, 2, p), TZ_INVALID, "weight");
        s.weight = 1, p[0].density = k ? 1.001 : NAN;
        fails(ctx, tz_element_field_add(&f, s, 2, p), TZ_INVALID, "density");
    }
    fails(ctx, tz_element_field_add(&f, (tz_element_field_stroke){.weight = 1}, 0, NULL),
          TZ_INVALID, "no point");
    assert_int_equal(f.stroke.n, 0);
    assert_int_equal(f.point.n, 0);
    tz_element_field_deinit(&f);
    for (int k = 0; k < 2; k++)
        fails(ctx,
              tz_element_field_init(ctx, (tz_vec3){k ? NAN : 0, 100, 0}, false, 32, &f),
              TZ_INVALID, "");
    end_ctx(ctx);
}

/* Strokes beyond counting, of a width. */
static void many_strokes(const char *what, int32_t strokes, int32_t points, double radius,
                         double spread)
{
    tz_ctx *ctx = new_ctx(2);
    tz_element_field f;
    tz_element_field_point *p = malloc((size_t)points * sizeof *p);
    const double since = filling_seconds();
    assert_non_null(p);
    ok(ctx, tz_element_field_init(ctx, (tz_vec3){1000, 1000, 0}, false, 0, &f));
    for (int32_t k = 0; k < strokes; k++) {
        tz_rng g = tz_rng_make(7, (uint64_t)k);
        const double x = tz_rng_unit(&g) * 1000, y = tz_rng_unit(&g) * 1000;
        for (int32_t i = 0; i < points; i++)
            p[i] = (tz_element_field_point){{x + spread * (tz_rng_unit(&g) - 0.5),
                                             y + spread * (tz_rng_unit(&g) - 0.5)},
                                            1,
                                            1};
        ok(ctx, tz_element_field_add(&f,
                                     (tz_element_field_stroke){
                                         .radius = radius, .weight = 1, .directed = true},
                                     points, p));
    }
    const tz_status s = tz_element_field_settle(&f);
    filling_in_time(what, since);
    if (s != TZ_OK)
        fails(ctx, s, TZ_LIMIT, "strokes");
    tz_element_field_deinit(&f);
    free(p);
    end_ctx(ctx);
}

static void strokes_beyond_counting(void **state)
{
    (void)state;
    many_strokes("a million strokes", 1000000, 2, 1, 20);
    many_strokes("a broad scribble of 1e5 points", 1, 100000, 100, 1000);
}

/* ---- layouts ------------------------------------------------------------------------ */

static void heaps_come_apart(void **state)
{
    (void)state;
    static const int32_t height[] = {60, 600, 3000};
    for (int k = 0; k < 3; k++) {
        bed b;
        tz_fill_report r;
        const double side = 24 * sqrt(height[k]);
        bed_lay(&b, 2, side, 1, 40);
        for (int32_t i = 0; i < height[k]; i++)
            ok(b.ctx, tz_element_set_place(&b.layout, &b.palette, i % 3,
                                           (tz_vec3){side / 2, side / 2, 0}, 0, 1));
        b.job.count = -1;
        const double since = filling_seconds();
        ok(b.ctx, tz_fill_run(b.ctx, &b.job, &b.layout, &r));
        filling_in_time("a heap", since);
        filling_sound(b.ctx, &b.layout);
        filling_inside(&b.domain, &b.layout);
        assert_true(r.overlap < 0.01);
        assert_true(b.layout.element.n > 0.95 * height[k]);
        bed_clear(&b);
    }
}

/* A small thing in the middle of a large one has no cell in the diagram. */
static void what_lies_within_comes_out(void **state)
{
    (void)state;
    enum { ROWS = 4, PAIRS = ROWS * ROWS };
    bed b;
    tz_fill_report r;
    const double side = 120 * ROWS;
    bed_lay(&b, 2, side, 1, 1);
    for (int32_t i = 0; i < 2 * PAIRS; i++) { /* leaves, then discs in them */
        const int32_t k = i % PAIRS;
        const tz_vec3 at = {120 * (k % ROWS) + 60.0, 120 * (k / ROWS) + 60.0, 0};
        ok(b.ctx, tz_element_set_place(&b.layout, &b.palette, i / PAIRS, at, 0,
                                       i < PAIRS ? 3 : 0.5));
    }
    b.job.count = -1;
    ok(b.ctx, tz_fill_run(b.ctx, &b.job, &b.layout, &r));
    filling_sound(b.ctx, &b.layout);
    filling_inside(&b.domain, &b.layout);
    assert_int_equal(b.layout.element.n, 2 * PAIRS);
    assert_true(r.overlap < 1e-4);
    bed_clear(&b);
}

static void layouts_that_are_none(void **state)
{
    (void)state;
    bed b;
    tz_fill *f = NULL;
    bed_lay(&b, 1, 100, 1, 3);
    ok(b.ctx, tz_element_set_place(&b.layout, &b.palette, 0, (tz_vec3){50, 50, 0}, 0, 1));
    tz_element *e = &b.layout.element.v[0];
    const tz_element good = *e;
    e->at.x = NAN;
    fails(b.ctx, tz_fill_begin(b.ctx, &b.job, &b.layout, &f), TZ_INVALID, "layout");
    assert_null(f);
    *e = good, e->scale = 0;
    fails(b.ctx, tz_fill_begin(b.ctx, &b.job, &b.layout, &f), TZ_INVALID, "layout");
    *e = good, e->symbol = 77;
    fails(b.ctx, tz_fill_begin(b.ctx, &b.job, &b.layout, &f), TZ_INVALID, "layout");
    /* far out of the domain, and huge: it stays, and all others lie about it */
    *e = good, e->at = (tz_vec3){-1e6, 1e6, 0}, e->fixed = true;
    ok(b.ctx,
       tz_element_set_place(&b.layout, &b.palette, 1, (tz_vec3){50, 50, 0}, 0, 10));
    b.layout.element.v[1].fixed = true;
    ok(b.ctx, tz_fill_run(b.ctx, &b.job, &b.layout, NULL));
    filling_sound(b.ctx, &b.layout);
    assert_true(b.layout.element.n > 5);
    bed_clear(&b);
}

/* ---- brushes ------------------------------------------------------------------------ */

static void brushes_out_of_range(void **state)
{
    (void)state;
    bed b;
    tz_fill *f;
    bed_lay(&b, 1, 150, 1, 3);
    ok(b.ctx, tz_fill_begin(b.ctx, &b.job, &b.layout, &f));
    ok(b.ctx, tz_fill_settle(f, 3));
    const tz_vec2 good[2] = {{50, 50}, {80, 60}}, bad[2] = {{50, 50}, {NAN, 60}};
    const double wrong[] = {0, -1, INFINITY, -INFINITY, NAN};
    for (int i = 0; i < 5; i++) {
        fails(b.ctx, tz_fill_add(f, 2, good, wrong[i], -1, 1), TZ_INVALID, "radius");
        fails(b.ctx, tz_fill_erase(f, 2, good, wrong[i]), TZ_INVALID, "radius");
        fails(b.ctx, tz_fill_add(f, 2, good, 5, -1, wrong[i]), TZ_INVALID, "size");
    }
    fails(b.ctx, tz_fill_add(f, 2, bad, 5, -1, 1), TZ_INVALID, "point 1");
    fails(b.ctx, tz_fill_wake(f, bad[1], 5), TZ_INVALID, "point 0");
    fails(b.ctx, tz_fill_erase(f, 0, good, 5), TZ_INVALID, "0 points");
    fails(b.ctx, tz_fill_replace(f, -7, good, 5, 0, 1), TZ_INVALID, "-7 points");
    fails(b.ctx, tz_fill_add(f, 2, good, 5, -2, 1), TZ_INVALID, "entry -2");
    ok(b.ctx, tz_fill_write(f, &b.layout));
    filling_sound(b.ctx, &b.layout);
    tz_fill_end(f);
    bed_clear(&b);
}

/* Where there is nothing, where everything is, smaller than any thing, longer than any
 * hand can draw. */
static void brushes_of_odd_kinds(void **state)
{
    (void)state;
    enum { LONG = 100000 };
    bed b;
    tz_fill *f;
    bed_lay(&b, 2, 400, 1, 3);
    ok(b.ctx, tz_fill_begin(b.ctx, &b.job, &b.layout, &f));
    ok(b.ctx, tz_fill_settle(f, 10));
    tz_vec2 *v = malloc(LONG * sizeof *v);
    assert_non_null(v);
    for (int i = 0; i < LONG; i++)
        v[i] = (tz_vec2){400 * fmod(i * 0.618033988749895, 1),
                         400 * fmod(i * 0.754877666246693, 1)};
    const tz_vec2 out[2] = {{-5000, 50}, {-4000, 50}}, in = {200, 200}, far = {1e300, 0};
    const double since = filling_seconds();
    ok(b.ctx, tz_fill_add(f, 2, out, 30, -1, 1));
    ok(b.ctx, tz_fill_settle(f, 3));
    ok(b.ctx, tz_fill_replace(f, 1, &far, 30, -1, 1));
    ok(b.ctx, tz_fill_settle(f, 3));
    ok(b.ctx, tz_fill_add(f, 1, &in, 1e-6, -1, 1));
    ok(b.ctx, tz_fill_settle(f, 3));
    fails(b.ctx, tz_fill_replace(f, 1, &in, 40, -1, 1e-4), TZ_LIMIT, "smaller brush");
    ok(b.ctx, tz_fill_settle(f, 3));
    filling_in_time("odd brushes", since);
    ok(b.ctx, tz_fill_write(f, &b.layout));
    filling_sound(b.ctx, &b.layout);
    const double then = filling_seconds();
    ok(b.ctx, tz_fill_replace(f, LONG, v, 3, -1, 1));
    ok(b.ctx, tz_fill_settle(f, 3));
    filling_in_time("a long brush", then);
    ok(b.ctx, tz_fill_erase(f, 1, &in, 1e9));
    ok(b.ctx, tz_fill_settle(f, 3));
    ok(b.ctx, tz_fill_write(f, &b.layout));
    assert_int_equal(b.layout.element.n, 0);
    ok(b.ctx, tz_fill_add(f, 1, &in, 60, -1, 1)); /* onto an empty bed */
    ok(b.ctx, tz_fill_settle(f, 5));
    ok(b.ctx, tz_fill_write(f, &b.layout));
    filling_sound(b.ctx, &b.layout);
    assert_true(b.layout.element.n > 10);
    free(v);
    tz_fill_end(f);
    bed_clear(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(strokes_that_say_nothing),
        cmocka_unit_test(strokes_out_of_range),
        cmocka_unit_test(strokes_beyond_counting),
        cmocka_unit_test(heaps_come_apart),
        cmocka_unit_test(what_lies_within_comes_out),
        cmocka_unit_test(layouts_that_are_none),
        cmocka_unit_test(brushes_out_of_range),
        cmocka_unit_test(brushes_of_odd_kinds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
