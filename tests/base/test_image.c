/* SPDX-License-Identifier: Apache-2.0 */
/* Images in memory: life, views, the sRGB curve, metadata. */
#include "tests/base/check.h"

#include <math.h>

#include "base/image.h"

static void fresh_images(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    static const char *const names[] = {"Y", "A", "B", "A", "c4"};
    for (int c = 1; c <= 5; c++) {
        tz_image im;
        ok(ctx, tz_image_init(ctx, &im, 7, 3, c));
        assert_int_equal(im.stride, 7 * c);
        assert_int_equal(im.alpha, c == 2 ? 1 : c == 4 ? 3 : -1);
        assert_string_equal(im.names[c - 1], names[c - 1]);
        for (int i = 0; i < 21 * c; i++)
            assert_true(im.px[i] == 0);
        tz_image_deinit(&im);
        tz_image_deinit(&im);
    }
    tz_image im;
    fails(ctx, tz_image_init(ctx, &im, 0, 3, 3), TZ_INVALID, "0 x 3");
    fails(ctx, tz_image_init(ctx, &im, 3, 1000001, 3), TZ_INVALID, "sides");
    fails(ctx, tz_image_init(ctx, &im, 3, 3, 65), TZ_INVALID, "65 channels");
    assert_null(im.px);
    end_ctx(ctx);
}

static tz_status copy_with_meta(tz_ctx *ctx)
{
    tz_image im, copy = {0};
    tz_status s = tz_image_init(ctx, &im, 8, 6, 3);
    if (s != TZ_OK)
        return s;
    for (int i = 0; i < 8 * 6 * 3; i++)
        im.px[i] = (float)i;
    im.encoding = TZ_ENCODING_SRGB;
    im.depth = 16;
    s = tz_image_set_meta(&im, "Title", "one");
    if (s == TZ_OK)
        s = tz_image_set_meta(&im, "Title", "two");
    if (s == TZ_OK)
        s = tz_image_set_meta(&im, "Author", "me");
    if (s == TZ_OK) {
        assert_int_equal(im.meta.n, 2);
        s = tz_image_copy(ctx, &im, &copy);
    }
    if (s == TZ_OK) {
        assert_string_equal(tz_image_meta(&copy, "Title"), "two");
        assert_null(tz_image_meta(&copy, "title"));
        assert_memory_equal(im.px, copy.px, 8 * 6 * 3 * sizeof(float));
        assert_int_equal(copy.depth, 16);
        tz_image_deinit(&copy);
        tz_image v = tz_image_view(&im, (tz_rect){2, 1, 4, 3});
        assert_true(tz_image_at(&v, 1, 2)[2] == (float)((3 * 8 + 3) * 3 + 2));
        s = tz_image_copy(ctx, &v, &copy);
        tz_image_deinit(&v);
        if (s == TZ_OK) {
            assert_int_equal(copy.stride, 12);
            assert_true(copy.px[0] == (float)((8 + 2) * 3));
            assert_string_equal(copy.names[1], "G");
        }
    }
    tz_image_deinit(&copy);
    tz_image_deinit(&im);
    return s;
}

static void copies_and_views(void **state)
{
    (void)state;
    survive(copy_with_meta, 1);
}

static void srgb_curve(void **state)
{
    (void)state;
    /* against the C library's pow, in double */
    for (double at = 1e-6; at < 100; at *= 1.003) {
        double x = (float)at;
        double y = x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055;
        assert_true(fabs(tz_srgb_encode((float)x) - y) <= 1e-7 * (1 + y));
        double z = x <= 0.04045 ? x / 12.92 : pow((x + 0.055) / 1.055, 2.4);
        assert_true(fabs(tz_srgb_decode((float)x) - z) <= 2e-7 * (1e-3 + z));
        assert_true(tz_srgb_encode((float)-x) == -tz_srgb_encode((float)x));
        assert_true(tz_srgb_decode((float)-x) == -tz_srgb_decode((float)x));
    }
    float before = -1;
    for (int i = 0; i <= 65535; i++) {
        float e = (float)i / 65535, d = tz_srgb_decode(e);
        assert_true(d > before);
        before = d;
        assert_int_equal((int)(tz_srgb_encode(d) * 65535 + 0.5f), i);
    }
    assert_true(tz_srgb_encode(0) == 0 && tz_srgb_decode(0) == 0);
    assert_true(tz_srgb_encode(1) == 1 && tz_srgb_decode(1) == 1);
    assert_true(isinf(tz_srgb_encode(INFINITY)) && isnan(tz_srgb_decode(NAN)));
    assert_true(isfinite(tz_srgb_encode(3e38f)) && tz_srgb_encode(1e-40f) >= 0);
}

static void convert(void **state)
{
    (void)state;
    float one[4 * 37 * 50];
    for (int threads = 1; threads <= 8; threads *= 2) {
        tz_ctx *ctx = new_ctx(threads);
        tz_image im;
        ok(ctx, tz_image_init(ctx, &im, 37, 50, 4));
        for (int i = 0; i < 4 * 37 * 50; i++)
            im.px[i] = (float)(i % 1000) / 999;
        ok(ctx, tz_image_convert(ctx, &im, TZ_ENCODING_SRGB));
        assert_int_equal(im.encoding, TZ_ENCODING_SRGB);
        assert_true(im.px[7] == 7.0f / 999); /* alpha stays */
        assert_true(im.px[5] == tz_srgb_encode(5.0f / 999));
        if (threads == 1)
            memcpy(one, im.px, sizeof one);
        assert_memory_equal(one, im.px, sizeof one);
        ok(ctx, tz_image_convert(ctx, &im, TZ_ENCODING_DATA));
        assert_int_equal(im.encoding, TZ_ENCODING_SRGB);
        im.encoding = TZ_ENCODING_DATA;
        ok(ctx, tz_image_convert(ctx, &im, TZ_ENCODING_LINEAR));
        assert_memory_equal(one, im.px, sizeof one);
        tz_image_deinit(&im);
        end_ctx(ctx);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fresh_images),
        cmocka_unit_test(copies_and_views),
        cmocka_unit_test(srgb_curve),
        cmocka_unit_test(convert),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
