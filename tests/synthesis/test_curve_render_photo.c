/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Lines shown in their photo: an exemplar gives back the photo, what is moved and turned as
 * a whole shows the photo moved and turned, seams have no steps, and no crop, thread count
 * or border of a torus shows. */
#include "tests/synthesis/test_curve_render.h"

enum { W = 160, H = 120 };

static void net_init(tz_ctx *ctx, tz_curve_set *s, double w, double h, bool torus)
{
    curves_init(ctx, s, w, h, torus);
    curves_net(s, curves_pen(s, 3, 0x202020ff, 1, 1), 4);
}

static void an_exemplar_gives_back_its_photo(void **state)
{
    (void)state;
    for (int32_t channels = 1; channels <= 4; channels++) {
        tz_ctx *ctx = new_ctx(2);
        tz_image photo = picture(ctx, PICTURE_STONES, W, H, channels, 4);
        const tz_element_pixels px = {&photo, NULL, NULL};
        for (int own = 0; own < 2; own++) {
            tz_curve_set s;
            net_init(ctx, &s, W, H, false);
            if (own)
                curves_keep(&s);
            tz_image im = curves_drawn(ctx, &s, &(look){.photo = &px, .strip = -1});
            const int32_t colours = channels - (photo.alpha >= 0);
            assert_int_equal(im.channels, colours + 1);
            for (int32_t y = 0; y < H; y++)
                for (int32_t x = 0; x < W; x++) {
                    for (int32_t c = 0; c < colours; c++)
                        assert_true(fabsf(tz_image_at(&im, x, y)[c] -
                                          tz_image_at(&photo, x, y)[c]) < 1e-5F);
                    if (photo.alpha < 0)
                        assert_true(tz_image_at(&im, x, y)[colours] == 1);
                }
            tz_image_deinit(&im);
            tz_curve_set_deinit(&s);
        }
        tz_image_deinit(&photo);
        tz_ctx_free(ctx);
    }
}

/* Moved by whole pixels, and by quarter turns: the same pixels at other places. */
static void rigid_copies_show_the_photo_itself(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_image photo = picture(ctx, PICTURE_NOISE, W, W, 3, 4);
    const tz_element_pixels px = {&photo, NULL, NULL};
    /* layout = map of the photo; its inverse is looked up below */
    const tz_affine map[4] = {{1, 0, 0, 1, 13, -8},
                              {0, 1, -1, 0, W, 0},
                              {-1, 0, 0, -1, W, W},
                              {0, -1, 1, 0, 0, W}};
    for (int k = 0; k < 4; k++) {
        tz_curve_set s;
        tz_affine inv;
        int64_t same = 0, all = 0;
        net_init(ctx, &s, W, W, false);
        curves_keep(&s);
        curves_map(&s, map[k]);
        assert_true(tz_affine_invert(map[k], &inv));
        tz_image im = curves_drawn(ctx, &s, &(look){.photo = &px, .strip = -1});
        for (int32_t y = 0; y < W; y++)
            for (int32_t x = 0; x < W; x++) {
                const tz_vec2 p = tz_affine_apply(inv, (tz_vec2){x + 0.5, y + 0.5});
                if (!(p.x > 0 && p.y > 0 && p.x < W && p.y < W))
                    continue;
                const float *want = tz_image_at(&photo, (int32_t)p.x, (int32_t)p.y),
                            *is = tz_image_at(&im, x, y);
                all++;
                same += fabsf(is[0] - want[0]) < 1e-5F && fabsf(is[2] - want[2]) < 1e-5F;
            }
        assert_int_equal(same, all);
        tz_image_deinit(&im);
        tz_curve_set_deinit(&s);
    }
    tz_image_deinit(&photo);
    tz_ctx_free(ctx);
}

/* A bent line carries its cross-section along: tone depends on the distance alone. */
static void bent_lines_keep_what_lies_across(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_image photo = picture(ctx, PICTURE_GREY, W, H, 1, 1);
    for (int32_t y = 0; y < H; y++) /* a ramp about the line y = 60 */
        for (int32_t x = 0; x < W; x++)
            *tz_image_at(&photo, x, y) = 0.5F + 0.01F * (float)(y + 0.5 - 60);
    const tz_element_pixels px = {&photo, NULL, NULL};
    tz_curve_set s;
    curves_init(ctx, &s, W, H, false);
    curves_cubic(&s, curves_pen(&s, 2, 0xff, 0, 0), (tz_vec2){-20, 60}, (tz_vec2){50, 0},
                 (tz_vec2){110, 120}, (tz_vec2){180, 60});
    OK(tz_array_push(ctx, &s.origin,
                     tz_bezier_line((tz_vec2){-20, 60}, (tz_vec2){180, 60})));
    tz_curve_composer *c = composer_of(ctx, &s, &(look){.photo = &px, .strip = 12});
    tz_image im = part_of(ctx, c, (tz_rect){0, 0, W, H});
    static float distance[W * H];
    OK(tz_curve_composer_map(ctx, c, (tz_rect){0, 0, W, H}, NULL, distance, NULL));
    int64_t seen = 0;
    for (int32_t k = 0; k < W * H; k++) {
        const float *is = tz_image_at(&im, k % W, k / W);
        if (distance[k] > 17) /* the strip is 12 + 1 wide, and fades over 3 px */
            assert_true(is[1] == 0);
        if (distance[k] > 8)
            continue;
        assert_true(is[1] == 1);
        assert_true(fabsf(fabsf(is[0] - 0.5F) - 0.01F * distance[k]) < 2e-3F);
        seen++;
    }
    assert_true(seen > 2000);
    tz_image_deinit(&im);
    tz_curve_composer_free(c);
    tz_curve_set_deinit(&s);
    tz_image_deinit(&photo);
    tz_ctx_free(ctx);
}

/* Two lines from parts of the photo that differ in tone: between them it rises slowly. */
static void seams_have_no_steps(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    enum { S = 400 };
    tz_image photo = picture(ctx, PICTURE_GREY, S, S, 1, 1);
    for (int32_t y = 0; y < S; y++)
        for (int32_t x = 0; x < S; x++)
            *tz_image_at(&photo, x, y) = x < S / 2 ? 0.3F : 0.7F;
    const tz_element_pixels px = {&photo, NULL, NULL};
    tz_curve_set s;
    curves_init(ctx, &s, S, S, false);
    const int32_t pen = curves_pen(&s, 2, 0xff, 0, 0);
    for (int k = 0; k < 2; k++) {
        const double x = 100 + 200 * k, from = 60 + 280 * k;
        const tz_vec2 p[2] = {{x, -50}, {x, 450}};
        curves_line(&s, pen, p, 2, false);
        OK(tz_array_push(ctx, &s.origin,
                         tz_bezier_line((tz_vec2){from, -50}, (tz_vec2){from, 450})));
    }
    tz_image im = curves_drawn(ctx, &s, &(look){.photo = &px, .strip = -1});
    for (int32_t y = 20; y < S; y += 40) {
        float most = 0;
        for (int32_t x = 60; x < 340; x++)
            most = fmaxf(
                most, fabsf(tz_image_at(&im, x + 1, y)[0] - tz_image_at(&im, x, y)[0]));
        assert_true(most < 0.02F); /* a step would be 0.4 */
        assert_true(tz_image_at(&im, 205, y)[0] - tz_image_at(&im, 195, y)[0] < 0.1F);
    }
    tz_image_deinit(&im);
    tz_curve_set_deinit(&s);
    tz_image_deinit(&photo);
    tz_ctx_free(ctx);
}

static void normals_turn_with_their_line(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_image photo = picture(ctx, PICTURE_STONES, W, W, 3, 4),
             map = picture_plane(ctx, W, W, 0.6, 0, 0.8);
    const tz_element_pixels px = {&photo, NULL, &map};
    /* quarter turns clockwise on the canvas: (x, y up) -> (y, -x) */
    const tz_affine turn[4] = {{1, 0, 0, 1, 0, 0},
                               {0, 1, -1, 0, W, 0},
                               {-1, 0, 0, -1, W, W},
                               {0, -1, 1, 0, 0, W}};
    const double want[4][2] = {{0.6, 0}, {0, -0.6}, {-0.6, 0}, {0, 0.6}};
    for (int k = 0; k < 4; k++) {
        tz_curve_set s;
        net_init(ctx, &s, W, W, false);
        curves_keep(&s);
        curves_map(&s, turn[k]);
        tz_image im = curves_drawn(
            ctx, &s, &(look){.photo = &px, .kind = TZ_MAP_NORMAL, .strip = -1});
        assert_int_equal(im.encoding, TZ_ENCODING_DATA);
        for (int32_t y = 10; y < W; y += 9)
            for (int32_t x = 10; x < W; x += 9) {
                const float *n = tz_image_at(&im, x, y);
                assert_true(fabs(2 * (double)n[0] - 1 - want[k][0]) < 1e-3);
                assert_true(fabs(2 * (double)n[1] - 1 - want[k][1]) < 1e-3);
                assert_true(fabs(2 * (double)n[2] - 1 - 0.8) < 1e-3);
            }
        tz_image_deinit(&im);
        tz_curve_set_deinit(&s);
    }
    tz_image_deinit(&photo);
    tz_image_deinit(&map);
    tz_ctx_free(ctx);
}

/* Bent layout over a ground, some of whose lines have no origin. */
typedef struct world {
    tz_image photo, plate;
    tz_element_pixels px;
    tz_layout layout;
    tz_element_ground ground;
    tz_curve_set set;
} world;

static void world_init(tz_ctx *ctx, world *w, bool torus)
{
    w->photo = picture(ctx, PICTURE_STONES, W, H, 3, 4);
    w->plate = picture(ctx, PICTURE_SMOOTH, W, H, 3, 7);
    w->px = (tz_element_pixels){&w->photo, NULL, NULL};
    scene_init(ctx, &w->layout, 620, 430, torus, W, H);
    scene_random(&w->layout, 30, 5);
    w->ground = (tz_element_ground){&w->layout, &w->plate, 1, NULL};
    tz_curve_set *s = &w->set;
    curves_init(ctx, s, 620, 430, torus);
    curves_net(s, curves_pen(s, 3, 0x202020ff, 1, 1), 9);
    for (int32_t i = 0; i < s->piece.n; i++) { /* each from somewhere in the photo */
        tz_rng rng = tz_rng_make(3, (uint64_t)i);
        const double x = tz_rng_range(&rng, 5, W - 60), y = tz_rng_range(&rng, 5, H - 5);
        tz_bezier b = tz_bezier_line((tz_vec2){x, y}, (tz_vec2){x + 55, y});
        b.p[1].y += 6;
        if (i % 11 == 3)
            b.p[0].x = NAN;
        OK(tz_array_push(ctx, &s->origin, b));
    }
    curves_wave(s, 4);
    if (torus) {
        curves_map(s, (tz_affine){1, 0, 0, 1, 77, -31});
        tz_curve_wrap(s);
    }
}

static void world_deinit(world *w)
{
    tz_image_deinit(&w->photo);
    tz_image_deinit(&w->plate);
    tz_layout_deinit(&w->layout);
    tz_curve_set_deinit(&w->set);
}

static void crops_and_threads_show_nothing(void **state)
{
    (void)state;
    for (int which = 0; which < 8; which++) {
        tz_ctx *keep = new_ctx(1);
        tz_image whole = {0};
        for (int threads = 1; threads <= 8; threads *= 2) {
            tz_ctx *ctx = new_ctx(threads);
            world w;
            world_init(ctx, &w, which & 1);
            const look l = {.ground = which & 2 ? &w.ground : NULL,
                            .photo = &w.px,
                            .kind = which & 4 ? TZ_MAP_DATA : TZ_MAP_COLOUR,
                            .scale = which & 4 ? 0.45 : 1,
                            .strip = which == 5 ? 6 : -1};
            if (which & 4 && which & 2) { /* grounds have the canvas' proportions */
                tz_layout_deinit(&w.layout);
                scene_init(ctx, &w.layout, 620, 430, which & 1, W, H);
                scene_random(&w.layout, 30, 5);
            }
            int32_t cw, ch;
            tz_curve_composer *c = composer_of(ctx, &w.set, &l);
            tz_curve_composer_size(c, &cw, &ch);
            tz_image im = part_of(ctx, c, (tz_rect){0, 0, cw, ch});
            assert_true(all_finite(&im));
            if (threads == 1)
                OK(tz_image_copy(keep, &im, &whole));
            else
                assert_int_equal(pixels_that_differ(&im, &whole), 0);
            tz_rng rng = tz_rng_make(8, (uint64_t)threads);
            for (int k = 0; k < 5; k++) {
                const tz_rect r = {
                    tz_rng_below(&rng, cw - 40), tz_rng_below(&rng, ch - 40),
                    1 + tz_rng_below(&rng, 40), 1 + tz_rng_below(&rng, 40)};
                tz_image part = part_of(ctx, c, r), view = tz_image_view(&whole, r);
                if (pixels_that_differ(&part, &view))
                    fail_msg("case %d: crop %d,%d,%d,%d differs in %d px by %g", which,
                             r.x, r.y, r.w, r.h, (int)pixels_that_differ(&part, &view),
                             largest_difference(&part, &view));
                tz_image_deinit(&part);
            }
            tz_image_deinit(&im);
            tz_curve_composer_free(c);
            world_deinit(&w);
            tz_ctx_free(ctx);
        }
        tz_image_deinit(&whole);
        tz_ctx_free(keep);
    }
}

/* Moved around a torus by whole pixels the picture is moved around. */
static void a_torus_has_no_border(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    enum { TW = 192, TH = 160 }; /* multiples of 16, as the grids of the blend */
    tz_image photo = picture(ctx, PICTURE_STONES, W, H, 3, 4), im[2];
    const tz_element_pixels px = {&photo, NULL, NULL};
    for (int k = 0; k < 2; k++) {
        tz_curve_set s;
        curves_init(ctx, &s, TW, TH, true);
        curves_net(&s, curves_pen(&s, 3, 0xff, 1, 1), 3);
        for (int32_t i = 0; i < s.piece.n; i++)
            OK(tz_array_push(ctx, &s.origin,
                             tz_bezier_line((tz_vec2){20 + 3.0 * i, 30 + 2.0 * i},
                                            (tz_vec2){80 + 2.0 * i, 40 + 2.0 * i})));
        curves_map(&s, (tz_affine){1, 0, 0, 1, k ? 64 : 0, k ? 48 : 0});
        tz_curve_wrap(&s);
        im[k] = curves_drawn(ctx, &s, &(look){.photo = &px, .strip = -1});
        tz_curve_set_deinit(&s);
    }
    int64_t off = 0;
    for (int32_t y = 0; y < TH; y++)
        for (int32_t x = 0; x < TW; x++)
            for (int c = 0; c < 3; c++)
                off +=
                    fabsf(tz_image_at(&im[0], x, y)[c] -
                          tz_image_at(&im[1], (x + 64) % TW, (y + 48) % TH)[c]) > 0.01F;
    /* where two lines are equally near, rounding decides */
    assert_true(off < 3 * TW * TH / 200);
    tz_image_deinit(&im[0]);
    tz_image_deinit(&im[1]);
    tz_image_deinit(&photo);
    tz_ctx_free(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_exemplar_gives_back_its_photo),
        cmocka_unit_test(rigid_copies_show_the_photo_itself),
        cmocka_unit_test(bent_lines_keep_what_lies_across),
        cmocka_unit_test(seams_have_no_steps),
        cmocka_unit_test(normals_turn_with_their_line),
        cmocka_unit_test(crops_and_threads_show_nothing),
        cmocka_unit_test(a_torus_has_no_border),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
