/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What a placement shows: copies by whole pixels are exact, turned ones are right, any
 * map is survived. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

#include "base/rng.h"
#include "tests/support/pictures.h"
#include "tests/support/scenes.h"

static const tz_rect all = {0, 0, 0, 0};

/* ---- exact copies ------------------------------------------------------------------ */

static void test_identity(void **state)
{
    (void)state;
    static const int32_t sizes[][2] = {{1, 1}, {3, 5}, {129, 67}, {600, 530}};
    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++)
        for (int32_t channels = 1; channels <= 5; channels++)
            for (int tile = 0; tile < 2; tile++) {
                const int32_t w = sizes[k][0], h = sizes[k][1];
                tz_ctx *ctx = new_ctx(2);
                tz_image photo = picture(ctx, PICTURE_NOISE, w, h, channels, 3);
                tz_layout l;
                scene_init(ctx, &l, w, h, tile, w, h);
                scene_box(&l, 0, tz_affine_identity(), 0, 0, w, h);
                tz_image out = render_colour(ctx, &l, &photo, all);
                assert_int_equal(pixels_that_differ(&out, &photo), 0);
                assert_int_equal(out.encoding, TZ_ENCODING_SRGB);
                tz_image_deinit(&out);
                tz_image_deinit(&photo);
                tz_layout_deinit(&l);
                tz_ctx_free(ctx);
            }
}

static void test_whole_pixels(void **state)
{
    (void)state;
    for (int clone = 0; clone < 2; clone++) {
        tz_ctx *ctx = new_ctx(2);
        tz_image photo = picture(ctx, PICTURE_NOISE, 70, 60, 3, 3);
        tz_layout l;
        scene_init(ctx, &l, 300, 200, false, 70, 60);
        /* two pieces with the void between them far from either */
        scene_box(&l, 0, move_by(13, 31), 5, 7, 40, 44);
        scene_box(&l, 0, move_by(150, 90), 0, 0, 70, 60);
        const tz_compose_params p = cloned(clone ? TZ_CLONE_NONE : TZ_CLONE_SCREENED);
        tz_image out = render(ctx, &l, &photo, 1, TZ_MAP_COLOUR, &p, all);
        if (clone) { /* nothing is corrected: every texel is the photo's */
            for (int32_t y = 0; y < 37; y++)
                assert_memory_equal(tz_image_at(&out, 18, 38 + y),
                                    tz_image_at(&photo, 5, 7 + y),
                                    35 * 3 * sizeof(float));
            for (int32_t y = 0; y < 60; y++)
                assert_memory_equal(tz_image_at(&out, 150, 90 + y),
                                    tz_image_at(&photo, 0, y), 70 * 3 * sizeof(float));
        }
        assert_true(all_finite(&out));
        tz_image_deinit(&out);
        tz_image_deinit(&photo);
        tz_layout_deinit(&l);
        tz_ctx_free(ctx);
    }
}

/* Pieces that agree where they meet are left alone, whatever their borders. */
static void test_pieces_that_agree(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_image photo = picture(ctx, PICTURE_STONES, 260, 240, 3, 3);
    tz_layout l;
    scene_init(ctx, &l, 260, 240, false, 260, 240);
    scene_box(&l, 0, tz_affine_identity(), 0, 0, 260, 240);
    tz_rng r = tz_rng_make(1, 1);
    for (int k = 0; k < 30; k++) {
        const double x = tz_rng_range(&r, 0, 200), y = tz_rng_range(&r, 0, 200);
        scene_box(&l, 0, tz_affine_identity(), x, y, x + tz_rng_range(&r, 1, 60),
                  y + tz_rng_range(&r, 1, 60));
    }
    tz_image out = render_colour(ctx, &l, &photo, all);
    assert_int_equal(pixels_that_differ(&out, &photo), 0);
    tz_image_deinit(&out);
    tz_image_deinit(&photo);
    tz_layout_deinit(&l);
    tz_ctx_free(ctx);
}

/* ---- resampled copies -------------------------------------------------------------- */

/* Photo turned by quarters, on long waves. Resampling sharpens a little to make good what
 * it loses, hence the tolerance: 0.004 of a contrast of 0.8. */
static void test_quarter_turns(void **state)
{
    (void)state;
    enum { W = 61, H = 48 };
    for (int quarter = 0; quarter < 4; quarter++)
        for (int mirror = 0; mirror < 2; mirror++) {
            const bool odd = quarter & 1;
            const int32_t w = odd ? H : W, h = odd ? W : H;
            tz_ctx *ctx = new_ctx(1);
            tz_image photo = picture(ctx, PICTURE_SMOOTH, W, H, 3, 5);
            tz_layout l;
            scene_init(ctx, &l, w, h, false, W, H);
            const tz_affine m =
                turned((tz_vec2){W / 2.0, H / 2.0}, (tz_vec2){w / 2.0, h / 2.0},
                       90 * quarter, 1, mirror);
            scene_window(&l, 0, m, (tz_rect){0, 0, w, h});
            tz_image out = render_colour(ctx, &l, &photo, all);
            double worst = 0;
            for (int32_t y = 0; y < h; y++)
                for (int32_t x = 0; x < w; x++) {
                    int32_t u = x, v = y; /* +90 degrees take +x to +y */
                    if (quarter == 1)
                        u = y, v = H - 1 - x;
                    if (quarter == 2)
                        u = W - 1 - x, v = H - 1 - y;
                    if (quarter == 3)
                        u = W - 1 - y, v = x;
                    if (mirror)
                        u = W - 1 - u;
                    for (int k = 0; k < 3; k++)
                        worst = fmax(worst, fabs(tz_image_at(&out, x, y)[k] -
                                                 tz_image_at(&photo, u, v)[k]));
                }
            assert_float_equal(worst, 0, 4e-3);
            tz_image_deinit(&out);
            tz_image_deinit(&photo);
            tz_layout_deinit(&l);
            tz_ctx_free(ctx);
        }
}

/* A photo continues mirrored beyond its borders: one of a few pixels is resampled like
 * the middle of a large one that shows its mirror images. */
static void test_small_photos(void **state)
{
    (void)state;
    static const int32_t sizes[][2] = {{1, 1}, {1, 4},   {2, 2},  {3, 5},
                                       {7, 9}, {15, 16}, {40, 33}};
    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
        const int32_t w = sizes[k][0], h = sizes[k][1],
                      turns = 2 * (40 / (w < h ? w : h) / 2) + 2;
        tz_ctx *ctx = new_ctx(1);
        tz_image photo = picture(ctx, PICTURE_NOISE, w, h, 1, 5);
        tz_image large = blank(ctx, (2 * turns + 1) * w, (2 * turns + 1) * h, 1);
        large.encoding = TZ_ENCODING_SRGB;
        for (int32_t y = 0; y < large.height; y++)
            for (int32_t x = 0; x < large.width; x++) {
                const int32_t u = x / w % 2 ? w - 1 - x % w : x % w;
                const int32_t v = y / h % 2 ? h - 1 - y % h : y % h;
                tz_image_at(&large, x, y)[0] = tz_image_at(&photo, u, v)[0];
            }
        tz_image out[2];
        for (int n = 0; n < 2; n++) {
            const tz_image *from = n ? &large : &photo;
            const double x = 0.3 - (n ? turns * w : 0), y = 0.4 - (n ? turns * h : 0);
            tz_layout l;
            scene_init(ctx, &l, w, h, false, from->width, from->height);
            scene_box(&l, 0, move_by(x, y), -1, -1, from->width + 1, from->height + 1);
            out[n] = render_colour(ctx, &l, from, all);
            tz_layout_deinit(&l);
        }
        if (largest_difference(&out[0], &out[1]) > 2e-5)
            fail_msg("%d x %d: off by %g", w, h, largest_difference(&out[0], &out[1]));
        for (int n = 0; n < 2; n++)
            tz_image_deinit(&out[n]);
        tz_image_deinit(&photo);
        tz_image_deinit(&large);
        tz_ctx_free(ctx);
    }
}

/* Half a pixel and any angle on long waves: against the waves themselves. */
static void test_smooth_resampling(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_image photo = picture(ctx, PICTURE_SMOOTH, 200, 200, 1, 0);
    double lo = INFINITY, hi = -INFINITY;
    for (int32_t i = 0; i < 200 * 200; i++)
        lo = fmin(lo, photo.px[i]), hi = fmax(hi, photo.px[i]);
    for (int k = 0; k < 8; k++) {
        tz_layout l;
        scene_init(ctx, &l, 90, 90, false, 200, 200);
        const tz_affine m = turned((tz_vec2){100.25, 99.5}, (tz_vec2){45, 45}, 37 * k,
                                   0.8 + 0.1 * k, k & 1);
        tz_affine inverse;
        assert_true(tz_affine_invert(m, &inverse));
        scene_window(&l, 0, m, (tz_rect){-1, -1, 92, 92});
        tz_image out = render_colour(ctx, &l, &photo, all);
        for (int32_t y = 0; y < 90; y++)
            for (int32_t x = 0; x < 90; x++) {
                const tz_vec2 p = tz_affine_apply(inverse, (tz_vec2){x + 0.5, y + 0.5});
                const double u = p.x - 0.5, v = p.y - 0.5;
                double want =
                    0.5 + 0.2 * sin(0.11 * u) * cos(0.07 * v) + 0.2 * sin(0.05 * (u + v));
                want = fmin(fmax(want, lo), hi); /* the photo's range is kept */
                assert_float_equal(tz_image_at(&out, x, y)[0], want, 2e-3);
            }
        tz_image_deinit(&out);
        tz_layout_deinit(&l);
    }
    tz_image_deinit(&photo);
    tz_ctx_free(ctx);
}

/* ---- order and void ---------------------------------------------------------------- */

static void test_order(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_image photo = picture(ctx, PICTURE_GRADIENT, 30, 30, 1, 0);
    tz_layout l;
    scene_init(ctx, &l, 60, 60, false, 30, 30);
    scene_box(&l, 0, move_by(0, 0), 0, 0, 30, 30);
    scene_box(&l, 0, move_by(10, 10), 0, 0, 30, 30);
    scene_box(&l, 0, move_by(20, 20), 0, 0, 30, 30);
    tz_composer *c = NULL;
    int32_t label[60 * 60];
    for (int round = 0; round < 2; round++) {
        assert_int_equal(tz_composer_new(ctx, &l, &photo, 1, TZ_MAP_COLOUR, NULL, &c),
                         TZ_OK);
        assert_int_equal(tz_composer_labels(ctx, c, (tz_rect){0, 0, 60, 60}, label),
                         TZ_OK);
        assert_int_equal(label[0], 0);
        assert_int_equal(label[9 * 60 + 9], 0);
        assert_int_equal(label[10 * 60 + 10], round ? 0 : 1);
        assert_int_equal(label[20 * 60 + 20], 2);
        assert_int_equal(label[29 * 60 + 29], 2);
        assert_int_equal(label[49 * 60 + 49], 2);
        tz_composer_free(c);
        l.place.v[1].removed = 1; /* what was below comes up again */
    }
    tz_image_deinit(&photo);
    tz_layout_deinit(&l);
    tz_ctx_free(ctx);
}

/* Bare pixels take the piece whose box is nearest. */
static void test_void(void **state)
{
    (void)state;
    for (int tile = 0; tile < 2; tile++) {
        enum { W = 331, H = 250, N = 7 };
        tz_ctx *ctx = new_ctx(2);
        tz_image photo = picture(ctx, PICTURE_GRADIENT, 60, 60, 1, 0);
        tz_layout l;
        scene_init(ctx, &l, W, H, tile, 60, 60);
        tz_rng r = tz_rng_make(3, 3);
        for (int k = 0; k < N; k++)
            scene_box(&l, 0, move_by(tz_rng_below(&r, W - 30), tz_rng_below(&r, H - 30)),
                      0, 0, 10 + tz_rng_below(&r, 20), 10 + tz_rng_below(&r, 20));
        tz_composer *c = NULL;
        static int32_t label[W * H];
        assert_int_equal(tz_composer_new(ctx, &l, &photo, 1, TZ_MAP_COLOUR, NULL, &c),
                         TZ_OK);
        assert_int_equal(tz_composer_labels(ctx, c, (tz_rect){0, 0, W, H}, label), TZ_OK);
        for (int32_t y = 0; y < H; y += 3)
            for (int32_t x = 0; x < W; x += 3) {
                const int32_t got = label[y * W + x];
                assert_in_range(got, 0, N - 1);
                double distance[N], least = INFINITY;
                for (int k = 0; k < N; k++) {
                    const tz_rect b = tz_layout_box(&l, k);
                    distance[k] = INFINITY;
                    for (int t = 0; t < 9; t++) {
                        if (!tile && t != 4)
                            continue;
                        const double px = x + 0.5 + (t % 3 - 1) * W,
                                     py = y + 0.5 + (t / 3 - 1) * H;
                        const double dx = fmax(fmax(b.x - px, px - b.x - b.w), 0);
                        const double dy = fmax(fmax(b.y - py, py - b.y - b.h), 0);
                        distance[k] = fmin(distance[k], hypot(dx, dy));
                    }
                    least = fmin(least, distance[k]);
                }
                /* on a torus a copy is told by its centre: a hair's breadth may differ */
                if (distance[got] > least + 1e-9)
                    fail_msg(
                        "tile %d: %d,%d shows piece %d at %g px, another is at %g px",
                        tile, x, y, got, distance[got], least);
            }
        tz_composer_free(c);
        tz_image_deinit(&photo);
        tz_layout_deinit(&l);
        tz_ctx_free(ctx);
    }
}

static void test_nothing_to_show(void **state)
{
    (void)state;
    for (int tile = 0; tile < 2; tile++)
        for (int outside = 0; outside < 2 - tile; outside++) {
            tz_ctx *ctx = new_ctx(2);
            tz_image photo = picture(ctx, PICTURE_NOISE, 20, 20, 3, 0);
            tz_layout l;
            scene_init(ctx, &l, 2100, 1100, tile, 20, 20);
            if (outside) {
                scene_box(&l, 0, move_by(-500, 0), 0, 0, 20, 20);
                scene_box(&l, 0, move_by(9000, 9000), 0, 0, 20, 20);
            }
            const clock_t start = clock();
            tz_image out = render_colour(ctx, &l, &photo, all);
            assert_true(clock() - start < 4 * CLOCKS_PER_SEC);
            for (int32_t y = 0; y < out.height; y += 7)
                for (int32_t x = 0; x < out.width * 3; x++)
                    assert_true(tz_image_at(&out, 0, y)[x] == 0);
            tz_image_deinit(&out);
            tz_image_deinit(&photo);
            tz_layout_deinit(&l);
            tz_ctx_free(ctx);
        }
}

/* One small stone on a large sheet: bare pixels are found fast. */
static void test_much_void_is_fast(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_image photo = picture(ctx, PICTURE_NOISE, 20, 20, 3, 0);
    tz_layout l;
    scene_init(ctx, &l, 3000, 3000, false, 20, 20);
    scene_box(&l, 0, move_by(0, 0), 0, 0, 20, 20);
    const clock_t start = clock();
    tz_image out = render_colour(ctx, &l, &photo, (tz_rect){2488, 2488, 512, 512});
    assert_true(clock() - start < 4 * CLOCKS_PER_SEC);
    tz_image_deinit(&out);
    tz_image_deinit(&photo);
    tz_layout_deinit(&l);
    tz_ctx_free(ctx);
}

/* ---- maps out of the ordinary ------------------------------------------------------ */

static void test_odd_maps(void **state)
{
    (void)state;
    static const tz_affine maps[] = {
        {1e-3, 0, 0, 1e-3, 50, 50},     /* a speck */
        {1e-6, 0, 0, 1e-6, 50.5, 50.5}, /* under one pixel */
        {1e4, 0, 0, 1e4, -2e5, -1e5},   /* one texel fills the layout */
        {1e9, 0, 0, 1e9, -1e10, -1e10}, /* beyond int32 */
        {1e13, 0, 0, 1e13, -1e14, -1e14},
        {1, 0, 3, 1, -40, 10},     /* sheared */
        {1, 0.999999, 1, 1, 0, 0}, /* nearly flat */
        {-1, 0, 0, 1, 60, 20},     /* mirrored */
        {1, 0, 0, -1, 20, 60},
        {0, 1, 1, 0, 10, 10},    /* mirrored about the diagonal */
        {50, 0, 0, 0.02, 0, 50}, /* a long streak */
        {1, 0, 0, 1, 1e7, -1e7}, /* far away */
        {1, 0, 0, 1, -39.5, 0},  /* half outside */
        {1, 0, 0, 1, 0.1, 0.3},
    };
    for (size_t k = 0; k < sizeof maps / sizeof maps[0]; k++)
        for (int tile = 0; tile < 2; tile++) {
            tz_ctx *ctx = new_ctx(2);
            tz_image photo = picture(ctx, PICTURE_NOISE, 40, 40, 3, 1);
            tz_layout l;
            scene_init(ctx, &l, 120, 100, tile, 40, 40);
            scene_window(&l, 0, move_by(0.5, 0.5), (tz_rect){0, 0, 120, 100});
            const int32_t id = scene_box(&l, 0, maps[k], 0, 0, 40, 40);
            const double det = fabs(tz_affine_det(maps[k]));
            if (tile && det > 1e6) { /* wraps too often to be drawn */
                tz_composer *c = NULL;
                assert_int_equal(
                    tz_composer_new(ctx, &l, &photo, 1, TZ_MAP_COLOUR, NULL, &c),
                    TZ_INVALID);
                assert_non_null(strstr(tz_ctx_message(ctx), "placement 1"));
                tz_image_deinit(&photo);
                tz_layout_deinit(&l);
                tz_ctx_free(ctx);
                continue;
            }
            const clock_t start = clock();
            tz_image out = render_colour(ctx, &l, &photo, all);
            assert_true(clock() - start < 4 * CLOCKS_PER_SEC);
            assert_true(all_finite(&out));
            for (int32_t y = 0; y < 100; y++)
                for (int32_t x = 0; x < 360; x++) {
                    const float v = tz_image_at(&out, 0, y)[x];
                    assert_true(v >= 0.05F && v <= 0.95F); /* the photo's range is kept */
                }
            /* it covers what the layout says it covers */
            tz_composer *c = NULL;
            static int32_t label[120 * 100];
            assert_int_equal(tz_composer_new(ctx, &l, &photo, 1, TZ_MAP_COLOUR, NULL, &c),
                             TZ_OK);
            assert_int_equal(tz_composer_labels(ctx, c, (tz_rect){0, 0, 120, 100}, label),
                             TZ_OK);
            if (!tile || det < 10)
                for (int32_t i = 0; i < 120 * 100; i++)
                    if (label[i] !=
                        tz_layout_at(&l, (tz_vec2){i % 120 + 0.5, i / 120 + 0.5}))
                        fail_msg(
                            "map %d, tile %d: label %d at %d, %d, layout says %d", (int)k,
                            tile, label[i], i % 120, i / 120,
                            tz_layout_at(&l, (tz_vec2){i % 120 + 0.5, i / 120 + 0.5}));
            if (det > 1e6)
                assert_int_equal(label[60], id);
            tz_composer_free(c);
            tz_image_deinit(&out);
            tz_image_deinit(&photo);
            tz_layout_deinit(&l);
            tz_ctx_free(ctx);
        }
}

static void test_absurd_maps(void **state)
{
    (void)state;
    static const tz_affine maps[] = {{1e30, 0, 0, 1e30, 1e30, -1e30},
                                     {1, 0, 0, 1, 1e300, 0},
                                     {1e308, 0, 0, 1e308, 0, 0}};
    for (size_t k = 0; k < sizeof maps / sizeof maps[0]; k++)
        for (int tile = 0; tile < 2; tile++) {
            tz_ctx *ctx = new_ctx(1);
            tz_image photo = picture(ctx, PICTURE_NOISE, 40, 40, 3, 1);
            tz_layout l;
            scene_init(ctx, &l, 50, 40, tile, 40, 40);
            const tz_point b[] = {{0, 0}, {40, 0}, {40, 40}};
            tz_status s = tz_layout_add(&l, 0, -1, maps[k], b, 3, NULL);
            tz_composer *c = NULL;
            if (s == TZ_OK) /* accepted so far: then refused here, or rendered */
                s = tz_composer_new(ctx, &l, &photo, 1, TZ_MAP_COLOUR, NULL, &c);
            if (s == TZ_OK) {
                tz_image out = blank(ctx, 50, 40, 3);
                assert_int_equal(
                    tz_composer_render(ctx, c, (tz_rect){0, 0, 50, 40}, &out), TZ_OK);
                assert_true(all_finite(&out));
                tz_image_deinit(&out);
            } else {
                assert_int_equal(s, TZ_INVALID);
            }
            tz_composer_free(c);
            tz_image_deinit(&photo);
            tz_layout_deinit(&l);
            tz_ctx_free(ctx);
        }
}

static void test_no_inverse(void **state)
{
    (void)state;
    static const tz_affine maps[] = {
        {0, 0, 0, 0, 0, 0},        {1, 1, 1, 1, 0, 0},         {NAN, 0, 0, 1, 0, 0},
        {1, 0, 0, 1, INFINITY, 0}, {1e-13, 0, 0, 1e-13, 0, 0}, {1, 0, 0, 0, 0, 0}};
    tz_ctx *ctx = new_ctx(1);
    tz_image photo = picture(ctx, PICTURE_NOISE, 20, 20, 3, 1);
    for (size_t k = 0; k < sizeof maps / sizeof maps[0]; k++) {
        tz_layout l;
        scene_init(ctx, &l, 50, 40, false, 20, 20);
        const int32_t id = scene_box(&l, 0, move_by(0, 0), 0, 0, 20, 20);
        l.place.v[id].map = maps[k]; /* past the layout's own check */
        tz_composer *c = NULL;
        assert_int_equal(tz_composer_new(ctx, &l, &photo, 1, TZ_MAP_COLOUR, NULL, &c),
                         TZ_INVALID);
        assert_null(c);
        assert_non_null(strstr(tz_ctx_message(ctx), "placement 0"));
        tz_ctx_clear(ctx);
        l.place.v[id].removed = 1; /* what is left out may be anything */
        assert_int_equal(tz_composer_new(ctx, &l, &photo, 1, TZ_MAP_COLOUR, NULL, &c),
                         TZ_OK);
        tz_composer_free(c);
        tz_layout_deinit(&l);
    }
    tz_image_deinit(&photo);
    tz_ctx_free(ctx);
}

/* A border that crosses a row very often. */
static void test_combs(void **state)
{
    (void)state;
    enum { TEETH = 90, W = 400, H = 60 };
    tz_ctx *ctx = new_ctx(1);
    tz_image photo = picture(ctx, PICTURE_NOISE, W, H, 1, 1);
    tz_layout l;
    scene_init(ctx, &l, W, H, false, W, H);
    scene_box(&l, 0, tz_affine_identity(), 0, 0, W, H);
    tz_point b[2 * TEETH + 2];
    for (int k = 0; k < 2 * TEETH; k++)
        b[k] = (tz_point){2.13F * (float)k + 3, k & 1 ? 55 : 5};
    b[2 * TEETH] = (tz_point){399, 57};
    b[2 * TEETH + 1] = (tz_point){1, 57};
    assert_int_equal(
        tz_layout_add(&l, 0, -1, tz_affine_identity(), b, 2 * TEETH + 2, NULL), TZ_OK);
    tz_composer *c = NULL;
    static int32_t label[W * H];
    assert_int_equal(tz_composer_new(ctx, &l, &photo, 1, TZ_MAP_COLOUR, NULL, &c), TZ_OK);
    assert_int_equal(tz_composer_labels(ctx, c, (tz_rect){0, 0, W, H}, label), TZ_OK);
    for (int32_t i = 0; i < W * H; i++)
        assert_int_equal(label[i], tz_layout_at(&l, (tz_vec2){i % W + 0.5, i / W + 0.5}));
    tz_composer_free(c);
    tz_image_deinit(&photo);
    tz_layout_deinit(&l);
    tz_ctx_free(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_identity),
        cmocka_unit_test(test_whole_pixels),
        cmocka_unit_test(test_pieces_that_agree),
        cmocka_unit_test(test_quarter_turns),
        cmocka_unit_test(test_small_photos),
        cmocka_unit_test(test_smooth_resampling),
        cmocka_unit_test(test_order),
        cmocka_unit_test(test_void),
        cmocka_unit_test(test_nothing_to_show),
        cmocka_unit_test(test_much_void_is_fast),
        cmocka_unit_test(test_odd_maps),
        cmocka_unit_test(test_absurd_maps),
        cmocka_unit_test(test_no_inverse),
        cmocka_unit_test(test_combs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
