/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Strokes: areas are what geometry says, a path is one shape, and no crop, thread count,
 * scale or border of a torus shows. */
#include "tests/synthesis/test_curve_render.h"

static double area_of(tz_ctx *ctx, const tz_curve_set *s, double scale)
{
    const look l = {.scale = scale, .strip = -1};
    tz_image im = curves_drawn(ctx, s, &l);
    double sum = 0;
    assert_int_equal(im.channels, 4);
    for (int32_t y = 0; y < im.height; y++)
        for (int32_t x = 0; x < im.width; x++)
            sum += (double)tz_image_at(&im, x, y)[3];
    tz_image_deinit(&im);
    return sum;
}

static void areas_are_right(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    const tz_vec2 line[2] = {{30, 40}, {230, 190}}; /* 250 long */
    const double cap[3] = {0, TZ_PI * 9, 36};
    for (uint32_t k = 0; k < 3; k++) {
        tz_curve_set s;
        curves_init(ctx, &s, 600, 300, false);
        curves_line(&s, curves_pen(&s, 6, 0x000000ff, k, 0), line, 2, false);
        assert_true(fabs(area_of(ctx, &s, 1) - (250 * 6 + cap[k])) < 1);
        assert_true(fabs(area_of(ctx, &s, 2.5) - 6.25 * (250 * 6 + cap[k])) < 3);
        tz_curve_set_deinit(&s);
    }
    /* corners: inside of a turn laps over; outside a miter, a sector or a triangle */
    const tz_vec2 corner[3] = {{50, 50}, {250, 50}, {250, 200}};
    const double join[3] = {100, 0.25 * TZ_PI * 100, 50};
    for (uint32_t k = 0; k < 3; k++) {
        tz_curve_set s;
        curves_init(ctx, &s, 300, 300, false);
        curves_line(&s, curves_pen(&s, 20, 0x000000ff, 0, k), corner, 3, false);
        assert_true(fabs(area_of(ctx, &s, 1) - (350 * 20 - 100 + join[k])) < 1);
        tz_curve_set_deinit(&s);
    }
    tz_ctx_free(ctx);
}

static void widths_change_along_tapers(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_curve_set s;
    const tz_vec2 p[3] = {{20, 50}, {220, 50}, {320, 50}};
    curves_init(ctx, &s, 340, 100, false);
    curves_line(&s, curves_pen(&s, 1, 0x000000ff, 0, 1), p, 3, false);
    OK(tz_array_push(ctx, &s.taper, ((tz_curve_taper){4, 24})));
    OK(tz_array_push(ctx, &s.taper, ((tz_curve_taper){24, 8})));
    assert_true(fabs(area_of(ctx, &s, 1) - (200 * 14 + 100 * 16)) < 2);
    tz_image im = curves_drawn(ctx, &s, &(look){.strip = -1});
    for (int32_t x = 21; x < 319; x++) { /* the width at each place */
        double sum = 0, at = x + 0.5;
        for (int32_t y = 0; y < 100; y++)
            sum += (double)tz_image_at(&im, x, y)[3];
        const double want =
            at < 220 ? 4 + 20 * (at - 20) / 200 : 24 - 16 * (at - 220) / 100;
        assert_true(fabs(sum - want) < 0.1);
    }
    tz_image_deinit(&im);
    tz_curve_set_deinit(&s);
    /* a cubic's width is linear by length, not by its parameter */
    curves_init(ctx, &s, 340, 100, false);
    curves_cubic(&s, curves_pen(&s, 1, 0x000000ff, 0, 1), (tz_vec2){20, 50},
                 (tz_vec2){20, 50}, (tz_vec2){30, 50}, (tz_vec2){320, 50});
    OK(tz_array_push(ctx, &s.taper, ((tz_curve_taper){2, 32})));
    im = curves_drawn(ctx, &s, &(look){.strip = -1});
    for (int32_t x = 30; x < 310; x += 10) {
        double sum = 0;
        for (int32_t y = 0; y < 100; y++)
            sum += (double)tz_image_at(&im, x, y)[3];
        assert_true(fabs(sum - (2 + 30 * (x + 0.5 - 20) / 300)) < 0.3);
    }
    tz_image_deinit(&im);
    tz_curve_set_deinit(&s);
    tz_ctx_free(ctx);
}

static void a_path_is_one_shape(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_curve_set s;
    const tz_vec2 star[5] = {{150, 20}, {230, 270}, {20, 110}, {280, 110}, {70, 270}};
    curves_init(ctx, &s, 300, 300, false);
    curves_line(&s, curves_pen(&s, 14, 0xff000080, 1, 1), star, 5, true);
    tz_image im = curves_drawn(ctx, &s, &(look){.strip = -1});
    int64_t inside = 0;
    for (int32_t y = 0; y < 300; y++)
        for (int32_t x = 0; x < 300; x++) {
            const float a = tz_image_at(&im, x, y)[3];
            assert_true(a <= 128.0F / 255 + 1e-5F);
            inside += a > 0.5F;
        }
    assert_true(inside > 10000);
    tz_image_deinit(&im);
    tz_curve_set_deinit(&s);
    tz_ctx_free(ctx);
}

static void crops_and_threads_show_nothing(void **state)
{
    (void)state;
    for (int torus = 0; torus < 2; torus++) {
        tz_image whole = {0};
        tz_ctx *keep = new_ctx(1);
        for (int threads = 1; threads <= 8; threads *= 2) {
            tz_ctx *ctx = new_ctx(threads);
            tz_curve_set s;
            curves_init(ctx, &s, 611, 487, torus == 1);
            s.background = torus ? 0xf0e8d0ff : 0;
            curves_scatter(&s, 160, 3);
            tz_curve_composer *c = composer_of(ctx, &s, &(look){.strip = -1});
            tz_image im = part_of(ctx, c, (tz_rect){0, 0, 611, 487});
            assert_int_equal(im.channels, torus ? 3 : 4);
            if (threads == 1)
                OK(tz_image_copy(keep, &im, &whole));
            else
                assert_int_equal(pixels_that_differ(&im, &whole), 0);
            tz_rng rng = tz_rng_make(8, (uint64_t)threads);
            for (int k = 0; k < 12; k++) {
                const tz_rect r = {tz_rng_below(&rng, 560), tz_rng_below(&rng, 440),
                                   1 + tz_rng_below(&rng, 50),
                                   1 + tz_rng_below(&rng, 46)};
                tz_image part = part_of(ctx, c, r), view = tz_image_view(&whole, r);
                assert_int_equal(pixels_that_differ(&part, &view), 0);
                tz_image_deinit(&part);
            }
            tz_image_deinit(&im);
            tz_curve_composer_free(c);
            tz_curve_set_deinit(&s);
            tz_ctx_free(ctx);
        }
        tz_image_deinit(&whole);
        tz_ctx_free(keep);
    }
}

/* Torus moved by whole pixels: the picture is moved around. Closed paths run around it. */
static void a_torus_has_no_border(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    enum { W = 180, H = 140 };
    tz_image im[2];
    for (int k = 0; k < 2; k++) {
        tz_curve_set s;
        curves_init(ctx, &s, W, H, true);
        curves_scatter(&s, 20, 9);
        const int32_t pen = curves_pen(&s, 5, 0x10a040ff, 0, 0);
        const tz_vec2 round[3] = {{20, 30}, {80, 60}, {140, 20}};
        curves_line(&s, pen, round, 3, true); /* closes over the border */
        if (k) {
            curves_map(&s, (tz_affine){1, 0, 0, 1, 57, 91});
            tz_curve_wrap(&s);
        }
        im[k] = curves_drawn(ctx, &s, &(look){.strip = -1});
        tz_curve_set_deinit(&s);
    }
    double most = 0;
    for (int32_t y = 0; y < H; y++)
        for (int32_t x = 0; x < W; x++)
            for (int c = 0; c < 4; c++)
                most = fmax(most, fabs((double)tz_image_at(&im[0], x, y)[c] -
                                       (double)tz_image_at(&im[1], (x + 57) % W,
                                                           (y + 91) % H)[c]));
    if (most >= 2e-3)
        fail_msg("moved around a torus it differs by %g", most);
    tz_image_deinit(&im[0]);
    tz_image_deinit(&im[1]);
    tz_ctx_free(ctx);
}

static void strange_lines_are_drawn_or_left_out(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_curve_set s;
    curves_init(ctx, &s, 100, 100, false);
    tz_image im = curves_drawn(ctx, &s, &(look){.strip = -1}); /* nothing at all */
    assert_int_equal(im.channels, 4);
    for (int32_t i = 0; i < 100 * 100 * 4; i++)
        assert_true(im.px[i] == 0);
    tz_image_deinit(&im);
    const tz_vec2 dot[2] = {{30, 30}, {30, 30}}, far[2] = {{-1e6, 50}, {1e6, 50}},
                  back[3] = {{50, 70}, {90, 70}, {50, 70}};
    curves_line(&s, curves_pen(&s, 10, 0x000000ff, 1, 1), dot, 2, false);
    curves_line(&s, curves_pen(&s, 2, 0x000000ff, 0, 0), far, 2, false);
    curves_line(&s, curves_pen(&s, 4, 0x000000ff, 0, 0), back, 3, false);
    curves_cubic(&s, 0, (tz_vec2){60, 20}, (tz_vec2){90, 20}, (tz_vec2){60, 20},
                 (tz_vec2){90, 20}); /* doubles back on itself */
    im = curves_drawn(ctx, &s, &(look){.strip = -1});
    assert_true(all_finite(&im));
    assert_true(tz_image_at(&im, 30, 30)[3] == 1); /* a dot has its caps */
    assert_true(tz_image_at(&im, 5, 50)[3] > 0.99F);
    assert_true(tz_image_at(&im, 70, 70)[3] > 0.99F);
    assert_true(tz_image_at(&im, 75, 20)[3] > 0.99F);
    tz_image_deinit(&im);
    tz_curve_set_deinit(&s);
    tz_ctx_free(ctx);
}

static void elements_lie_above_and_background_beneath(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_curve_set s;
    const tz_vec2 p[2] = {{0, 50}, {100, 50}};
    curves_init(ctx, &s, 100, 100, false);
    s.background = 0x0000ffff;
    curves_line(&s, curves_pen(&s, 20, 0x00ff00ff, 0, 0), p, 2, false);
    tz_element_kind kind = {0};
    tz_element_symbol y = {.radius = 12};
    OK(tz_strdup(ctx, "disc", &kind.name));
    OK(tz_strdup(ctx, "d", &y.id));
    OK(tz_strdup(ctx, "<circle r=\"12\" fill=\"#ff0000\"/>", &y.markup));
    OK(tz_strdup(ctx, "<path d=\"M0 0L40 0L40 100L0 100Z\" fill=\"#ffffff\"/>",
                 &s.element.background));
    OK(tz_array_push(ctx, &s.element.kind, kind));
    OK(tz_array_push(ctx, &s.element.symbol, y));
    OK(tz_array_push(ctx, &s.element.sample, ((tz_sample){{50, 50, 0}, 0, 1})));
    OK(tz_array_push(
        ctx, &s.element.element,
        ((tz_element){
            .source = -1, .samples = 1, .at = {50, 50, 0}, .scale = 1, .radius = 12})));
    tz_image im = curves_drawn(ctx, &s, &(look){.strip = -1});
    const int32_t at[4][2] = {{80, 10}, {10, 10}, {10, 50}, {50, 50}};
    const float want[4][3] = {{0, 0, 1}, {1, 1, 1}, {0, 1, 0}, {1, 0, 0}};
    assert_int_equal(im.channels, 3);
    for (int k = 0; k < 4; k++)
        for (int c = 0; c < 3; c++)
            assert_true(fabsf(tz_image_at(&im, at[k][0], at[k][1])[c] - want[k][c]) <
                        1e-3F);
    tz_image_deinit(&im);
    tz_curve_set_deinit(&s);
    tz_ctx_free(ctx);
}

/* Nearest line, distance and place, against trying all points of all lines. */
static void maps_are_exact(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    for (int torus = 0; torus < 2; torus++) {
        enum { W = 150, H = 110 };
        tz_curve_set s;
        int32_t id[W * H];
        float distance[W * H], along[W * H];
        curves_init(ctx, &s, W, H, torus == 1);
        curves_scatter(&s, 14, 21);
        tz_curve_composer *c = composer_of(ctx, &s, &(look){.strip = -1});
        OK(tz_curve_composer_map(ctx, c, (tz_rect){0, 0, W, H}, id, distance, along));
        for (int32_t k = 0; k < W * H; k += 61) {
            const double x = k % W + 0.5, y = k / W + 0.5;
            double best = INFINITY;
            for (int32_t i = 0; i < s.piece.n; i++) {
                const tz_bezier b = tz_curve_bezier(&s, &s.piece.v[i]);
                for (int32_t m = 0; m <= 2000; m++) {
                    const tz_vec2 p = tz_bezier_at(&b, m / 2000.0);
                    double dx = fabs(p.x - x), dy = fabs(p.y - y);
                    if (torus) {
                        dx = fabs(dx - W * floor(dx / W + 0.5));
                        dy = fabs(dy - H * floor(dy / H + 0.5));
                    }
                    best = fmin(best, hypot(dx, dy));
                }
            }
            if (fabs(best - (double)distance[k]) >= 0.05)
                fail_msg("%d: %d,%d: %g for %g", torus, k % W, k / W, (double)distance[k],
                         best);
            assert_in_range(id[k], 0, s.path.n - 1);
            double length = 0;
            const tz_curve_path *p = &s.path.v[id[k]];
            for (int32_t i = p->piece; i < p->piece + p->pieces; i++) {
                const tz_bezier b = tz_curve_bezier(&s, &s.piece.v[i]);
                length += tz_bezier_length(&b);
            }
            assert_true(along[k] >= 0 && (double)along[k] <= length * 1.02 + 0.01);
        }
        tz_curve_composer_free(c);
        tz_curve_set_deinit(&s);
    }
    tz_ctx_free(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(areas_are_right),
        cmocka_unit_test(widths_change_along_tapers),
        cmocka_unit_test(a_path_is_one_shape),
        cmocka_unit_test(crops_and_threads_show_nothing),
        cmocka_unit_test(a_torus_has_no_border),
        cmocka_unit_test(strange_lines_are_drawn_or_left_out),
        cmocka_unit_test(elements_lie_above_and_background_beneath),
        cmocka_unit_test(maps_are_exact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
