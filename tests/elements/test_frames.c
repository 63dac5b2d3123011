/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Frames: from formulas, strokes and pictures. */
#include "tests/base/check.h"

#include "elements/domain.h"
#include "tests/elements/guides.h"

static const tz_vec3 size = {200, 100, 0};

/* Difference of two angles, 0..pi. */
static double apart(double a, double b)
{
    const double d = fmod(fabs(a - b), 2 * TZ_PI);
    return d > TZ_PI ? 2 * TZ_PI - d : d;
}

static void assert_units(const tz_frames *f)
{
    for (int32_t i = 0; i < f->raster.width * f->raster.height; i++)
        assert_float_equal(hypot((double)f->x[i], (double)f->y[i]), 1, 1e-5);
}

static void test_formula(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_frames *f;
    ok(ctx, tz_frames_from_formula(ctx, "90*x/w - y", size, false, &f));
    assert_units(f);
    for (double x = 5; x < 200; x += 13)
        for (double y = 5; y < 100; y += 9)
            assert_true(apart(tz_frames_angle(f, (tz_vec3){x, y, 0}),
                              (90 * x / 200 - y) * TZ_PI / 180) < 1e-3);
    const tz_domain d = {.size = size, .frames = f};
    assert_true(tz_domain_frame(&d, (tz_vec3){5, 5, 0}) ==
                tz_frames_angle(f, (tz_vec3){5, 5, 0}));
    tz_frames_free(f);
    tz_frames_free(NULL);
    f = (void *)&ctx;
    fails(ctx, tz_frames_from_formula(ctx, "90*z", size, false, &f), TZ_INVALID, "z");
    assert_null(f);
    fails(ctx, tz_frames_from_formula(ctx, "sqrt(x-50)", size, false, &f), TZ_INVALID,
          "no value at x");
    fails(ctx, tz_frames_from_formula(ctx, "0", (tz_vec3){1, -1, 0}, false, &f),
          TZ_INVALID, "no area");
    end_ctx(ctx);
}

/* One stroke says its direction everywhere; the view is stretched with the domain. */
static void test_one_stroke(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    for (int torus = 0; torus < 2; torus++) {
        tz_frames *f;
        ok(ctx, tz_frames_read(ctx,
                               guide_svg("<line x1='40' y1='30' x2='60' y2='70' "
                                         "stroke='red'/>"),
                               size, torus == 1, &f));
        assert_units(f);
        for (double x = 5; x < 200; x += 13)
            assert_true(apart(tz_frames_angle(f, (tz_vec3){x, 20, 0}), TZ_PI / 4) < 1e-2);
        tz_frames_free(f);
    }
    end_ctx(ctx);
}

/* Between two strokes the direction turns evenly; a stroke drawn the other way points the
 * other way. */
static void test_between_strokes(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_frames *f;
    ok(ctx, tz_frames_read(ctx,
                           guide_svg("<path d='M10 99V1' stroke='red'/>"
                                     "<path d='M90 50H98' stroke='red'/>"
                                     "<path d='M90 90H98' stroke='red'/>"
                                     "<path d='M90 10H98' stroke='red'/>"),
                           size, false, &f));
    assert_true(apart(tz_frames_angle(f, (tz_vec3){4, 50, 0}), -TZ_PI / 2) < 0.02);
    assert_true(apart(tz_frames_angle(f, (tz_vec3){192, 50, 0}), 0) < 0.02);
    double before = -TZ_PI / 2;
    for (double x = 20; x < 178; x += 10) {
        const double a = tz_frames_angle(f, (tz_vec3){x, 50, 0});
        assert_true(a > before - 1e-3 && a < 1e-3);
        before = a;
    }
    assert_float_equal(tz_frames_angle(f, (tz_vec3){100, 50, 0}), -TZ_PI / 4, 0.25);
    tz_frames_free(f);
    end_ctx(ctx);
}

/* Along a circle, inside and outside of it alike: a whirl. */
static void test_circle(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_frames *f;
    const tz_vec3 square = {100, 100, 0};
    ok(ctx, tz_frames_read(ctx,
                           guide_svg("<circle cx='50' cy='50' r='35' fill='none' "
                                     "stroke='red'/>"),
                           square, false, &f));
    assert_units(f);
    for (int k = 0; k < 40; k++)
        for (double r = 10; r <= 45; r += 5) {
            const double a = k * TZ_PI / 20;
            const tz_vec3 p = {50 + r * cos(a), 50 + r * sin(a), 0};
            assert_true(apart(tz_frames_angle(f, p), a + TZ_PI / 2) < 0.1);
        }
    tz_frames_free(f);
    end_ctx(ctx);
}

static float red_green(int32_t x, int32_t y, int32_t c)
{
    const double a = (x + y) * 0.02;
    return c == 0   ? (float)(0.5 + 0.45 * cos(a))
           : c == 1 ? (float)(0.5 + 0.45 * sin(a))
                    : 0;
}

static float grey_angle(int32_t x, int32_t y, int32_t c)
{
    (void)y, (void)c;
    return (float)(x / 255.0);
}

/* Known on the left and right fifth only. */
static float with_hole(int32_t x, int32_t y, int32_t c)
{
    (void)y;
    return x >= 20 && x < 80 ? 0.5f : c == 0 ? 0.5f : c == 1 ? 0.9f : 0.5f;
}

static float no_vector(int32_t x, int32_t y, int32_t c)
{
    (void)x, (void)y, (void)c;
    return 0.5f;
}

static void test_pictures(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_frames *f;
    ok(ctx,
       tz_frames_read(ctx, guide_image(ctx, 100, 50, 3, red_green), size, false, &f));
    assert_units(f);
    for (double x = 5; x < 200; x += 13)
        assert_true(apart(tz_frames_angle(f, (tz_vec3){x, 41, 0}),
                          ((x - 1) / 2 + 20) * 0.02) < 0.02);
    tz_frames_free(f);
    ok(ctx,
       tz_frames_read(ctx, guide_image(ctx, 256, 4, 1, grey_angle), size, false, &f));
    for (double x = 5; x < 195; x += 13)
        assert_true(apart(tz_frames_angle(f, (tz_vec3){x, 41, 0}), x / 200 * 2 * TZ_PI) <
                    0.05);
    tz_frames_free(f);
    ok(ctx,
       tz_frames_read(ctx, guide_image(ctx, 100, 50, 3, with_hole), size, false, &f));
    for (double x = 5; x < 200; x += 13)
        assert_true(apart(tz_frames_angle(f, (tz_vec3){x, 41, 0}), TZ_PI / 2) < 0.02);
    tz_frames_free(f);
    /* larger than the raster: means of vectors, not of angles across 360 = 0 */
    ok(ctx,
       tz_frames_read(ctx, guide_image(ctx, 1500, 20, 3, red_green), size, false, &f));
    assert_true(f->raster.width <= 512);
    assert_units(f);
    tz_frames_free(f);
    fails(ctx, tz_frames_read(ctx, guide_image(ctx, 9, 9, 3, no_vector), size, false, &f),
          TZ_INVALID, "guide.png");
    end_ctx(ctx);
}

static void test_bad_input(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_frames *f = (void *)&ctx;
    fails(ctx, tz_frames_read(ctx, "/none.svg", size, false, &f), TZ_IO, "none.svg");
    assert_null(f);
    fails(ctx, tz_frames_read(ctx, guide_svg(""), size, false, &f), TZ_INVALID,
          "guide.svg: there are no strokes");
    fails(ctx,
          tz_frames_read(ctx, guide_svg("<path stroke='red' d='M200 200h50'/>"), size,
                         false, &f),
          TZ_INVALID, "in view");
    fails(ctx, tz_frames_read(ctx, guide_text("a.svg", "<a/>"), size, false, &f),
          TZ_FORMAT, "a.svg");
    fails(ctx, tz_frames_read(ctx, guide_text("a.png", ""), size, false, &f), TZ_FORMAT,
          "a.png");
    assert_null(f);
    end_ctx(ctx);
}

static tz_status read_formula(tz_ctx *ctx)
{
    tz_frames *f = NULL;
    const tz_status s =
        tz_frames_from_formula(ctx, "x+y", (tz_vec3){300, 2, 0}, true, &f);
    tz_frames_free(f);
    return s;
}

static tz_status read_strokes(tz_ctx *ctx)
{
    tz_frames *f = NULL;
    const tz_status s = tz_frames_read(ctx, guide_path, (tz_vec3){300, 2, 0}, false, &f);
    assert_true((s == TZ_OK) == (f != NULL));
    tz_frames_free(f);
    return s;
}

static void test_memory_runs_out(void **state)
{
    (void)state;
    guide_svg("<path d='M0 0L100 100' stroke='red'/>");
    survive(read_formula, 1);
    survive(read_strokes, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_formula),         cmocka_unit_test(test_one_stroke),
        cmocka_unit_test(test_between_strokes), cmocka_unit_test(test_circle),
        cmocka_unit_test(test_pictures),        cmocka_unit_test(test_bad_input),
        cmocka_unit_test(test_memory_runs_out),
    };
    return cmocka_run_group_tests(tests, guide_begin, guide_end);
}
