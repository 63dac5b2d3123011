/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Arrangement of photos and sizes that nobody takes on purpose: a pixel, a strip, grey,
 * noise; layouts of a pixel or of a great length; and what is refused. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

#include "tests/support/arranged.h"

static double seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Arranges, renders, and looks at what came out. @return placements */
static int32_t check(tz_image photo, int32_t w, int32_t h, bool tile)
{
    tz_ctx *ctx = photo.ctx;
    arranged_source s;
    tz_layout l;
    source_from(ctx, &s, photo, "odd.png");
    tz_arrange_params p = arrange_params(w, h, 1, tile);
    p.effort = 1;
    arrange_one(ctx, &s, NULL, &p, &l);
    /* a piece may stick out of a photo that is smaller than any piece */
    const int32_t shorter =
        s.photo.width < s.photo.height ? s.photo.width : s.photo.height;
    assert_sound(&l, &s.exemplar, 1, shorter < 16 ? 20 : 2);
    tz_image out = render_colour(ctx, &l, &s.photo, (tz_rect){0});
    assert_true(all_finite(&out));
    float lo = INFINITY, hi = -INFINITY;
    for (int64_t i = 0; i < (int64_t)s.photo.width * s.photo.height * s.photo.channels;
         i++)
        lo = fminf(lo, s.photo.px[i]), hi = fmaxf(hi, s.photo.px[i]);
    for (int64_t i = 0; i < (int64_t)w * h * out.channels; i++)
        assert_true(out.px[i] >= lo && out.px[i] <= hi); /* no void, nothing made up */
    const int32_t n = l.place.n;
    tz_image_deinit(&out);
    tz_layout_deinit(&l);
    source_deinit(&s);
    return n;
}

static void test_tiny_photos(void **state)
{
    (void)state;
    static const int32_t sizes[][2] = {{1, 1}, {3, 5}, {2, 40}, {16, 16}, {20, 300}};
    tz_ctx *ctx = new_ctx(2);
    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++)
        for (int tile = 0; tile < 2; tile++)
            for (int channels = 1; channels <= 4; channels++) {
                const tz_image photo =
                    picture(ctx, PICTURE_NOISE, sizes[k][0], sizes[k][1], channels, 1);
                check(photo, 130, 90, tile);
            }
    tz_ctx_free(ctx);
}

static void test_photos_without_structure(void **state)
{
    (void)state;
    static const picture_kind kinds[] = {PICTURE_GREY, PICTURE_NOISE, PICTURE_GRADIENT};
    tz_ctx *ctx = new_ctx(2);
    for (int k = 0; k < 3; k++)
        for (int tile = 0; tile < 2; tile++)
            check(picture(ctx, kinds[k], 150, 130, 3, 1), 400, 300, tile);
    /* black, and black but for one pixel */
    for (int k = 0; k < 2; k++) {
        tz_image black = blank(ctx, 100, 100, 3);
        black.encoding = TZ_ENCODING_SRGB;
        black.px[3 * 5050] = k ? 1 : 0;
        check(black, 300, 200, false);
    }
    /* nothing to be seen at all */
    tz_image clear = picture(ctx, PICTURE_STONES, 100, 100, 4, 1);
    for (int32_t i = 0; i < 100 * 100; i++)
        clear.px[4 * i + 3] = 0;
    check(clear, 300, 200, false);
    tz_ctx_free(ctx);
}

static void test_strip_photo(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    check(picture(ctx, PICTURE_NOISE, 50000, 1, 3, 1), 300, 200, false);
    check(picture(ctx, PICTURE_NOISE, 3, 20000, 1, 1), 200, 100, true);
    tz_ctx_free(ctx);
}

/* A photo of a pixel must not cost a placement every few pixels. */
static void test_tiny_photo_large_layout(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    const double start = seconds();
    const int32_t n = check(picture(ctx, PICTURE_NOISE, 1, 1, 3, 1), 1000, 1000, false);
    if (n > 10000 || seconds() - start > 20)
        fail_msg("%d placements, %.1f s", n, seconds() - start);
    tz_ctx_free(ctx);
}

static void test_odd_layouts(void **state)
{
    (void)state;
    static const int32_t sizes[][2] = {{1, 1},      {2, 3}, {1, 700},
                                       {20000, 64}, {5, 5}, {64, 64}};
    tz_ctx *ctx = new_ctx(2);
    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++)
        for (int tile = 0; tile < 2; tile++)
            check(picture(ctx, PICTURE_STONES, 160, 150, 3, 1), sizes[k][0], sizes[k][1],
                  tile);
    tz_ctx_free(ctx);
}

static void test_odd_pieces(void **state)
{
    (void)state;
    static const double pieces[] = {1, 16, 20.5, 500, 4096};
    tz_ctx *ctx = new_ctx(2);
    arranged_source s;
    source_init(ctx, &s, PICTURE_STONES, 160, 150, 1);
    for (int k = 0; k < 5; k++) {
        tz_arrange_params p = arrange_params(200, 160, 1, k & 1);
        p.piece = pieces[k];
        p.effort = 1;
        tz_layout l;
        double farthest;
        arrange_one(ctx, &s, NULL, &p, &l);
        assert_sound(&l, &s.exemplar, 1, 2);
        bare_pixels(&l, &farthest);
        assert_true(farthest <= 6);
        tz_layout_deinit(&l);
    }
    source_deinit(&s);
    tz_ctx_free(ctx);
}

/* ---- what is refused --------------------------------------------------------------- */

static void test_refused(void **state)
{
    (void)state;
    static const int32_t sizes[][2] = {
        {0, 10},        {10, 0}, {-1, 10}, {10, INT32_MIN}, {TZ_IMAGE_MAX_SIDE + 1, 10},
        {10, INT32_MAX}};
    tz_ctx *ctx = new_ctx(1);
    arranged_source s;
    tz_layout l = {0};
    source_init(ctx, &s, PICTURE_STONES, 80, 70, 1);
    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
        const tz_arrange_params p = arrange_params(sizes[k][0], sizes[k][1], 1, k & 1);
        const tz_status st = tz_arrange(ctx, &s.exemplar, 1, NULL, &p, &l);
        if (st != TZ_INVALID)
            fail_msg("%d x %d: %s", sizes[k][0], sizes[k][1], tz_status_text(st));
        assert_true(tz_ctx_message(ctx)[0] != 0);
        assert_null(l.place.v);
        tz_ctx_clear(ctx);
    }
    const tz_arrange_params p = arrange_params(100, 100, 1, false);
    assert_int_equal(tz_arrange(ctx, &s.exemplar, 0, NULL, &p, &l), TZ_INVALID);
    tz_ctx_clear(ctx);
    /* a photo of another size than its exemplar document */
    tz_image other = picture(ctx, PICTURE_STONES, 81, 70, 3, 1);
    const tz_exemplar wrong = {&other, &s.ebpt, "wrong.png", NULL};
    assert_int_equal(tz_arrange(ctx, &wrong, 1, NULL, &p, &l), TZ_INVALID);
    assert_non_null(strstr(tz_ctx_message(ctx), "wrong.png"));
    assert_non_null(strstr(tz_ctx_message(ctx), "81 x 70"));
    assert_non_null(strstr(tz_ctx_message(ctx), "80 x 70"));
    tz_image_deinit(&other);
    source_deinit(&s);
    tz_ctx_free(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tiny_photos),
        cmocka_unit_test(test_photos_without_structure),
        cmocka_unit_test(test_strip_photo),
        cmocka_unit_test(test_tiny_photo_large_layout),
        cmocka_unit_test(test_odd_layouts),
        cmocka_unit_test(test_odd_pieces),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
