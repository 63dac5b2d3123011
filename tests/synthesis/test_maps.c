/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * All maps of a material along one layout: normals, heights, other resolutions, any count
 * of channels, encodings. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/pictures.h"
#include "tests/support/scenes.h"

static const tz_rect all = {0, 0, 0, 0};

/* ---- normals ----------------------------------------------------------------------- */

static void assert_normal(const float *px, double x, double y, double z, double tolerance)
{
    if (fabs(2 * px[0] - 1 - x) > tolerance || fabs(2 * px[1] - 1 - y) > tolerance ||
        fabs(2 * px[2] - 1 - z) > tolerance)
        fail_msg("normal %g, %g, %g where %g, %g, %g is due", 2 * px[0] - 1,
                 2 * px[1] - 1, 2 * px[2] - 1, x, y, z);
}

/* A tilted plane, turned: its normal turns with it. The y of a normal points up the
 * picture, so that a turn from +x to +y of the pixels turns the normal clockwise. */
static void test_normals_turn(void **state)
{
    (void)state;
    static const double normals[][3] = {{0.6, 0, 0.8}, {0, 0.6, 0.8}, {0.48, -0.36, 0.8}};
    for (size_t n = 0; n < 3; n++)
        for (int degrees = -180; degrees <= 180; degrees += 45)
            for (int mirror = 0; mirror < 2; mirror++)
                for (int large = 0; large < 2; large++) {
                    const double *v = normals[n];
                    tz_ctx *ctx = new_ctx(1);
                    tz_image map = picture_plane(ctx, 40, 30, v[0], v[1], v[2]);
                    tz_layout l;
                    scene_init(ctx, &l, 60, 60, false, 40, 30);
                    scene_window(&l, 0,
                                 turned((tz_vec2){20, 15}, (tz_vec2){30, 30}, degrees,
                                        large ? 2.5 : 1, mirror),
                                 (tz_rect){0, 0, 60, 60});
                    tz_image out = render(ctx, &l, &map, 1, TZ_MAP_NORMAL, NULL, all);
                    const double a = degrees * TZ_PI / 180, x = mirror ? -v[0] : v[0];
                    for (int32_t i = 0; i < 60 * 60; i += 37)
                        assert_normal(out.px + 3 * i, cos(a) * x + sin(a) * v[1],
                                      -sin(a) * x + cos(a) * v[1], v[2], 2e-4);
                    tz_image_deinit(&out);
                    tz_image_deinit(&map);
                    tz_layout_deinit(&l);
                    tz_ctx_free(ctx);
                }
}

/* Whatever is overlaid and corrected: every normal has unit length and looks up. */
static void test_normals_stay_unit(void **state)
{
    (void)state;
    for (int channels = 3; channels <= 4; channels++) {
        tz_ctx *ctx = new_ctx(2);
        tz_image map = picture(ctx, PICTURE_SMOOTH, 90, 90, channels, 1);
        map.encoding = TZ_ENCODING_DATA;
        for (int32_t i = 0; i < 90 * 90; i++) {
            float *p = map.px + (int64_t)channels * i;
            double x = 1.4 * (p[0] - 0.5), y = 1.4 * (p[1] - 0.5),
                   z = sqrt(1 - x * x - y * y);
            p[0] = (float)(0.5 + 0.5 * x), p[1] = (float)(0.5 + 0.5 * y);
            p[2] = (float)(0.5 + 0.5 * z);
        }
        tz_layout l;
        scene_init(ctx, &l, 320, 310, true, 90, 90);
        scene_random(&l, 60, 5);
        tz_image out = render(ctx, &l, &map, 1, TZ_MAP_NORMAL, NULL, all);
        for (int32_t i = 0; i < 320 * 310; i++) {
            const float *p = out.px + (int64_t)channels * i;
            const double x = 2 * p[0] - 1, y = 2 * p[1] - 1, z = 2 * p[2] - 1;
            assert_float_equal(sqrt(x * x + y * y + z * z), 1, 1e-5);
            assert_true(z > 0);
            if (channels == 4)
                assert_true(p[3] >= 0.05F && p[3] <= 0.95F);
        }
        assert_int_equal(out.encoding, TZ_ENCODING_DATA);
        tz_image_deinit(&out);
        tz_image_deinit(&map);
        tz_layout_deinit(&l);
        tz_ctx_free(ctx);
    }
}

/* ---- data -------------------------------------------------------------------------- */

/* Any count of channels; range kept; channels that are equal stay equal, so that lanes do
 * not mix. */
static void test_channels(void **state)
{
    (void)state;
    static const int32_t counts[] = {1, 2, 3, 4, 5, 7, 8, 16, 64};
    tz_ctx *ctx = new_ctx(2);
    tz_layout l;
    scene_init(ctx, &l, 150, 140, false, 60, 50);
    scene_random(&l, 25, 6);
    tz_image one = picture(ctx, PICTURE_STONES, 60, 50, 1, 2);
    one.encoding = TZ_ENCODING_DATA;
    const tz_compose_params none = cloned(TZ_CLONE_NONE);
    tz_image want = render(ctx, &l, &one, 1, TZ_MAP_DATA, &none, all);
    for (size_t n = 0; n < sizeof counts / sizeof counts[0]; n++) {
        const int32_t channels = counts[n];
        tz_image map = blank(ctx, 60, 50, channels);
        map.encoding = TZ_ENCODING_DATA;
        for (int32_t i = 0; i < 60 * 50; i++)
            for (int32_t k = 0; k < channels; k++)
                map.px[(int64_t)i * channels + k] = one.px[i] + (float)k;
        for (int clone = 0; clone < 2; clone++) {
            const tz_compose_params p = cloned(clone ? TZ_CLONE_NONE : TZ_CLONE_SCREENED);
            tz_image out = render(ctx, &l, &map, 1, TZ_MAP_DATA, &p, all);
            assert_true(all_finite(&out));
            for (int32_t i = 0; i < 150 * 140; i++)
                for (int32_t k = 0; k < channels; k++) {
                    const double v = out.px[(int64_t)i * channels + k] - k;
                    assert_true(v >= -0.001 && v <= 1.001);
                    if (clone)
                        assert_float_equal(v, want.px[i], 2e-4);
                    else /* every channel has the same steps and so the same correction */
                        assert_float_equal(v, out.px[(int64_t)i * channels], 3e-4);
                }
            tz_image_deinit(&out);
        }
        tz_image_deinit(&map);
    }
    tz_image_deinit(&want);
    tz_image_deinit(&one);
    tz_layout_deinit(&l);
    tz_ctx_free(ctx);
}

static void test_height_keeps_range(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_image map = picture(ctx, PICTURE_STONES, 80, 80, 1, 2);
    map.encoding = TZ_ENCODING_DATA;
    float lo = INFINITY, hi = -INFINITY;
    for (int32_t i = 0; i < 80 * 80; i++) { /* heights in mm, below and above zero */
        map.px[i] = 250 * map.px[i] - 100;
        lo = fminf(lo, map.px[i]), hi = fmaxf(hi, map.px[i]);
    }
    tz_layout l;
    scene_init(ctx, &l, 300, 300, false, 80, 80);
    scene_random(&l, 60, 6);
    tz_image out = render(ctx, &l, &map, 1, TZ_MAP_DATA, NULL, all);
    float low = INFINITY, high = -INFINITY;
    for (int32_t i = 0; i < 300 * 300; i++)
        low = fminf(low, out.px[i]), high = fmaxf(high, out.px[i]);
    assert_true(low >= lo && high <= hi);
    assert_true(high - low > 0.9F * (hi - lo)); /* nor is it flattened */
    tz_image_deinit(&out);
    tz_image_deinit(&map);
    tz_layout_deinit(&l);
    tz_ctx_free(ctx);
}

/* Numbers of a data map come out as they went in, even if the file called them linear;
 * linear colour comes out sRGB-encoded; alpha is not encoded. */
static void test_encodings(void **state)
{
    (void)state;
    static const tz_encoding from[] = {TZ_ENCODING_LINEAR, TZ_ENCODING_SRGB,
                                       TZ_ENCODING_DATA};
    static const tz_map_kind kinds[] = {TZ_MAP_COLOUR, TZ_MAP_NORMAL, TZ_MAP_DATA};
    for (int e = 0; e < 3; e++)
        for (int n = 0; n < 3; n++)
            for (int channels = 1; channels <= 4; channels++) {
                if (kinds[n] == TZ_MAP_NORMAL && channels >= 3)
                    continue;
                tz_ctx *ctx = new_ctx(1);
                tz_image map = picture(ctx, PICTURE_NOISE, 33, 31, channels, 2);
                map.encoding = from[e];
                tz_layout l;
                scene_init(ctx, &l, 33, 31, false, 33, 31);
                scene_box(&l, 0, tz_affine_identity(), 0, 0, 33, 31);
                tz_image out = render(ctx, &l, &map, 1, kinds[n], NULL, all);
                const bool encodes =
                    kinds[n] == TZ_MAP_COLOUR && from[e] == TZ_ENCODING_LINEAR;
                for (int32_t i = 0; i < 33 * 31; i++)
                    for (int k = 0; k < channels; k++) {
                        const float v = map.px[i * channels + k];
                        const float want =
                            encodes && k != map.alpha ? tz_srgb_encode(v) : v;
                        assert_true(out.px[i * channels + k] == want);
                    }
                const bool data =
                    kinds[n] != TZ_MAP_COLOUR || from[e] == TZ_ENCODING_DATA;
                assert_int_equal(out.encoding,
                                 data ? TZ_ENCODING_DATA : TZ_ENCODING_SRGB);
                tz_image_deinit(&out);
                tz_image_deinit(&map);
                tz_layout_deinit(&l);
                tz_ctx_free(ctx);
            }
}

/* ---- resolutions ------------------------------------------------------------------- */

/* A map three times as fine: its texels at the layout's pixel centres are shown. Half as
 * fine: long waves are. */
static void test_other_resolutions(void **state)
{
    (void)state;
    static const double factors[] = {3, 2, 0.5, 0.25};
    for (int f = 0; f < 4; f++)
        for (int shifted = 0; shifted < 2; shifted++) {
            enum { W = 120, H = 80 };
            const int32_t w = (int32_t)(W * factors[f]), h = (int32_t)(H * factors[f]);
            tz_ctx *ctx = new_ctx(1);
            tz_image map = blank(ctx, w, h, 1);
            map.encoding = TZ_ENCODING_DATA;
            for (int32_t y = 0; y < h; y++)
                for (int32_t x = 0; x < w; x++)
                    map.px[y * w + x] =
                        (float)(0.5 + 0.2 * sin(0.1 * (x + 0.5) / factors[f]) +
                                0.2 * cos(0.07 * (y + 0.5) / factors[f]));
            tz_layout l;
            scene_init(ctx, &l, W, H, false, W, H);
            const double d = shifted ? 0.5 : 0;
            scene_box(&l, 0, move_by(d, d), -1, -1, W + 1, H + 1);
            tz_image out = render(ctx, &l, &map, 1, TZ_MAP_DATA, NULL, all);
            for (int32_t y = 4; y < H - 4; y++)
                for (int32_t x = 4; x < W - 4; x++)
                    assert_float_equal(out.px[y * W + x],
                                       0.5 + 0.2 * sin(0.1 * (x + 0.5 - d)) +
                                           0.2 * cos(0.07 * (y + 0.5 - d)),
                                       8e-3);
            tz_image_deinit(&out);
            tz_image_deinit(&map);
            tz_layout_deinit(&l);
            tz_ctx_free(ctx);
        }
}

/* A fine map under a piece moved by whole pixels is as sharp as under one moved by parts
 * of pixels. */
static void test_fine_map_stays_sharp(void **state)
{
    (void)state;
    double deviation[2];
    for (int shifted = 0; shifted < 2; shifted++) {
        tz_ctx *ctx = new_ctx(1);
        tz_image map = picture(ctx, PICTURE_NOISE, 180, 180, 1, 4);
        map.encoding = TZ_ENCODING_DATA;
        tz_layout l;
        scene_init(ctx, &l, 60, 60, false, 60, 60);
        scene_box(&l, 0, move_by(shifted ? 1 / 3.0 : 0, 0), -1, -1, 61, 61);
        tz_image out = render(ctx, &l, &map, 1, TZ_MAP_DATA, NULL, all);
        double sum = 0, square = 0;
        for (int32_t i = 0; i < 3600; i++)
            sum += out.px[i], square += out.px[i] * out.px[i];
        deviation[shifted] = sqrt(square / 3600 - sum * sum / 3600 / 3600);
        tz_image_deinit(&out);
        tz_image_deinit(&map);
        tz_layout_deinit(&l);
        tz_ctx_free(ctx);
    }
    assert_float_equal(deviation[0] / deviation[1], 1, 0.1);
}

static void test_other_shapes(void **state)
{
    (void)state;
    static const int32_t bad[][2] = {{90, 60}, {120, 81 + 20}, {240, 80}, {80, 120}};
    tz_ctx *ctx = new_ctx(1);
    tz_layout l;
    scene_init(ctx, &l, 100, 100, false, 120, 80);
    scene_box(&l, 0, move_by(0, 0), 0, 0, 120, 80);
    tz_composer *c = NULL;
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
        tz_image map = picture(ctx, PICTURE_GREY, bad[k][0], bad[k][1], 1, 0);
        char size[40];
        const tz_status s = tz_composer_new(ctx, &l, &map, 1, TZ_MAP_DATA, NULL, &c);
        if (bad[k][0] == 90) { /* 3 : 2, like the layout's source */
            assert_int_equal(s, TZ_OK);
            tz_composer_free(c);
            c = NULL;
        } else {
            assert_int_equal(s, TZ_INVALID);
            assert_null(c);
            assert_non_null(strstr(tz_ctx_message(ctx), "photo.png"));
            assert_non_null(strstr(tz_ctx_message(ctx), "120 x 80"));
            snprintf(size, sizeof size, "%d x %d", bad[k][0], bad[k][1]);
            assert_non_null(strstr(tz_ctx_message(ctx), size));
            tz_ctx_clear(ctx);
        }
        tz_image_deinit(&map);
    }
    tz_layout_deinit(&l);
    tz_ctx_free(ctx);
}

static void test_wrong_counts(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_layout l;
    scene_init(ctx, &l, 100, 100, false, 40, 40);
    assert_int_equal(tz_layout_add_source(&l, "second.png", NULL, 50, 40, NULL), TZ_OK);
    scene_box(&l, 0, move_by(0, 0), 0, 0, 40, 40);
    scene_box(&l, 1, move_by(40, 40), 0, 0, 50, 40);
    tz_image map[2] = {picture(ctx, PICTURE_NOISE, 40, 40, 3, 0),
                       picture(ctx, PICTURE_NOISE, 50, 40, 3, 0)};
    tz_composer *c = NULL;
    assert_int_equal(tz_composer_new(ctx, &l, map, 1, TZ_MAP_COLOUR, NULL, &c),
                     TZ_INVALID);
    tz_ctx_clear(ctx);
    assert_int_equal(tz_composer_new(ctx, &l, map, 0, TZ_MAP_COLOUR, NULL, &c),
                     TZ_INVALID);
    tz_ctx_clear(ctx);
    tz_image grey = picture(ctx, PICTURE_NOISE, 50, 40, 1, 0);
    const tz_image mixed[2] = {map[0], grey};
    assert_int_equal(tz_composer_new(ctx, &l, mixed, 2, TZ_MAP_COLOUR, NULL, &c),
                     TZ_INVALID);
    assert_non_null(strstr(tz_ctx_message(ctx), "second.png"));
    assert_null(c);
    tz_ctx_clear(ctx);
    assert_int_equal(tz_composer_new(ctx, &l, map, 2, TZ_MAP_COLOUR, NULL, &c), TZ_OK);
    tz_composer_free(c);
    /* each piece shows its own source */
    const tz_compose_params none = cloned(TZ_CLONE_NONE);
    tz_image out = render(ctx, &l, map, 2, TZ_MAP_COLOUR, &none, all);
    assert_memory_equal(tz_image_at(&out, 3, 3), tz_image_at(&map[0], 3, 3), 12);
    assert_memory_equal(tz_image_at(&out, 43, 43), tz_image_at(&map[1], 3, 3), 12);
    tz_image_deinit(&out);
    tz_image_deinit(&grey);
    tz_image_deinit(&map[0]);
    tz_image_deinit(&map[1]);
    tz_layout_deinit(&l);
    tz_layout empty; /* no source at all */
    assert_int_equal(tz_layout_init(ctx, &empty, 10, 10, false), TZ_OK);
    c = NULL;
    assert_int_equal(tz_composer_new(ctx, &empty, NULL, 0, TZ_MAP_COLOUR, NULL, &c),
                     TZ_INVALID);
    assert_null(c);
    tz_layout_deinit(&empty);
    tz_ctx_free(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_normals_turn),
        cmocka_unit_test(test_normals_stay_unit),
        cmocka_unit_test(test_channels),
        cmocka_unit_test(test_height_keeps_range),
        cmocka_unit_test(test_encodings),
        cmocka_unit_test(test_other_resolutions),
        cmocka_unit_test(test_fine_map_stays_sharp),
        cmocka_unit_test(test_other_shapes),
        cmocka_unit_test(test_wrong_counts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
