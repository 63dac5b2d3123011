/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A crop rendered alone has the bytes of that crop of the whole, at any count of threads,
 * plain and on a torus; labels agree with the layout. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/rng.h"
#include "tests/support/pictures.h"
#include "tests/support/scenes.h"

static const int thread_counts[] = {1, 2, 8};

static void assert_crop(tz_ctx *ctx, const tz_composer *c, const tz_image *whole,
                        tz_rect r)
{
    tz_image out = blank(ctx, r.w, r.h, whole->channels);
    assert_int_equal(tz_composer_render(ctx, c, r, &out), TZ_OK);
    const tz_image part = tz_image_view(whole, r);
    const int64_t wrong = pixels_that_differ(&out, &part);
    if (wrong)
        fail_msg("%d of %d px of crop %d,%d,%d,%d differ from the whole, by up to %g",
                 (int)wrong, r.w * r.h, r.x, r.y, r.w, r.h,
                 largest_difference(&out, &part));
    tz_image_deinit(&out);
}

static void check_crops(int32_t w, int32_t h, bool tile, int32_t channels, int32_t pieces,
                        tz_map_kind kind)
{
    tz_ctx *ctx = new_ctx(2);
    tz_image photo = picture(ctx, PICTURE_STONES, 150, 110, channels, 7);
    tz_layout l;
    scene_init(ctx, &l, w, h, tile, 150, 110);
    scene_random(&l, pieces, (uint64_t)w * 31 + (uint64_t)h);
    tz_composer *c = NULL;
    assert_int_equal(tz_composer_new(ctx, &l, &photo, 1, kind, NULL, &c), TZ_OK);
    tz_image whole = blank(ctx, w, h, channels);
    assert_int_equal(tz_composer_render(ctx, c, (tz_rect){0, 0, w, h}, &whole), TZ_OK);
    assert_true(all_finite(&whole));
    tz_rng r = tz_rng_make(9, (uint64_t)w);
    for (size_t t = 0; t < sizeof thread_counts / sizeof thread_counts[0]; t++) {
        tz_ctx *other = new_ctx(thread_counts[t]);
        assert_crop(other, c, &whole, (tz_rect){0, 0, w, h});
        for (int k = 0; k < 12; k++) {
            tz_rect q = {tz_rng_below(&r, w), tz_rng_below(&r, h), 1, 1};
            if (k >= 4) { /* the first are of one pixel */
                q.w = 1 + tz_rng_below(&r, w - q.x);
                q.h = 1 + tz_rng_below(&r, h - q.y);
            }
            assert_crop(other, c, &whole, q);
        }
        assert_crop(other, c, &whole, (tz_rect){0, h / 2, w, 1});
        assert_crop(other, c, &whole, (tz_rect){w / 2, 0, 1, h});
        assert_crop(other, c, &whole, (tz_rect){w - 1, h - 1, 1, 1});
        tz_ctx_free(other);
    }
    tz_composer_free(c);
    /* a composer made anew, too */
    tz_composer *again = NULL;
    assert_int_equal(tz_composer_new(ctx, &l, &photo, 1, kind, NULL, &again), TZ_OK);
    assert_crop(ctx, again, &whole, (tz_rect){0, 0, w, h});
    tz_composer_free(again);
    tz_image_deinit(&whole);
    tz_image_deinit(&photo);
    tz_layout_deinit(&l);
    tz_ctx_free(ctx);
}

static void test_crops(void **state)
{
    (void)state;
    check_crops(701, 643, false, 3, 60, TZ_MAP_COLOUR);
    check_crops(1025, 517, false, 1, 40, TZ_MAP_DATA);
    check_crops(300, 300, false, 3, 30, TZ_MAP_NORMAL);
}

static void test_crops_on_a_torus(void **state)
{
    (void)state;
    check_crops(640, 528, true, 3, 60, TZ_MAP_COLOUR);
    check_crops(613, 541, true, 3, 60, TZ_MAP_COLOUR); /* not a multiple of anything */
    check_crops(1030, 90, true, 2, 30, TZ_MAP_DATA);
    check_crops(70, 1040, true, 4, 30, TZ_MAP_COLOUR);
}

static void test_thin_and_tiny(void **state)
{
    (void)state;
    static const int32_t sizes[][2] = {{1, 1},    {3, 5},   {5000, 1},
                                       {1, 2000}, {16, 16}, {17, 513}};
    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++)
        for (int tile = 0; tile < 2; tile++)
            check_crops(sizes[k][0], sizes[k][1], tile, 3, 12, TZ_MAP_COLOUR);
}

/* Void between pieces belongs to crops as well. */
static void test_crops_with_void(void **state)
{
    (void)state;
    for (int tile = 0; tile < 2; tile++) {
        tz_ctx *ctx = new_ctx(2);
        tz_image photo = picture(ctx, PICTURE_SMOOTH, 90, 90, 3, 1);
        tz_layout l;
        scene_init(ctx, &l, 531, 402, tile, 90, 90);
        tz_rng r = tz_rng_make(4, 4);
        for (int k = 0; k < 9; k++)
            scene_box(
                &l, 0,
                turned((tz_vec2){45, 45},
                       (tz_vec2){tz_rng_range(&r, 0, 531), tz_rng_range(&r, 0, 402)},
                       tz_rng_range(&r, 0, 360), 1, false),
                20, 30, 70, 60);
        tz_composer *c = NULL;
        assert_int_equal(tz_composer_new(ctx, &l, &photo, 1, TZ_MAP_COLOUR, NULL, &c),
                         TZ_OK);
        tz_image whole = blank(ctx, 531, 402, 3);
        assert_int_equal(tz_composer_render(ctx, c, (tz_rect){0, 0, 531, 402}, &whole),
                         TZ_OK);
        for (int k = 0; k < 20; k++) {
            tz_rect q = {tz_rng_below(&r, 531), tz_rng_below(&r, 402), 1, 1};
            q.w = 1 + tz_rng_below(&r, 531 - q.x);
            q.h = 1 + tz_rng_below(&r, 402 - q.y);
            assert_crop(ctx, c, &whole, q);
        }
        tz_composer_free(c);
        tz_image_deinit(&whole);
        tz_image_deinit(&photo);
        tz_layout_deinit(&l);
        tz_ctx_free(ctx);
    }
}

/* Labels say the same as tz_layout_at, point by point and crop by crop. */
static void test_labels(void **state)
{
    (void)state;
    for (int tile = 0; tile < 2; tile++) {
        enum { W = 233, H = 187 };
        tz_ctx *ctx = new_ctx(2);
        tz_image photo = picture(ctx, PICTURE_GREY, 80, 70, 1, 1);
        tz_layout l;
        scene_init(ctx, &l, W, H, tile, 80, 70);
        scene_random(&l, 40, 12);
        tz_composer *c = NULL;
        assert_int_equal(tz_composer_new(ctx, &l, &photo, 1, TZ_MAP_COLOUR, NULL, &c),
                         TZ_OK);
        int32_t *label = malloc(sizeof *label * W * H),
                *part = malloc(sizeof *part * W * H);
        assert_int_equal(tz_composer_labels(ctx, c, (tz_rect){0, 0, W, H}, label), TZ_OK);
        for (int32_t y = 0; y < H; y++)
            for (int32_t x = 0; x < W; x++)
                if (label[y * W + x] != tz_layout_at(&l, (tz_vec2){x + 0.5, y + 0.5}))
                    fail_msg("%d,%d (tile %d): label %d, layout %d", x, y, tile,
                             label[y * W + x],
                             tz_layout_at(&l, (tz_vec2){x + 0.5, y + 0.5}));
        const tz_rect r = {31, 57, 113, 64};
        assert_int_equal(tz_composer_labels(ctx, c, r, part), TZ_OK);
        for (int32_t y = 0; y < r.h; y++)
            assert_memory_equal(part + y * r.w, label + (y + r.y) * W + r.x,
                                (size_t)r.w * sizeof *part);
        free(label);
        free(part);
        tz_composer_free(c);
        tz_image_deinit(&photo);
        tz_layout_deinit(&l);
        tz_ctx_free(ctx);
    }
}

static void test_bad_crops(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_image photo = picture(ctx, PICTURE_GREY, 20, 20, 3, 1);
    tz_layout l;
    scene_init(ctx, &l, 100, 50, false, 20, 20);
    scene_box(&l, 0, move_by(0, 0), 0, 0, 20, 20);
    tz_composer *c = NULL;
    assert_int_equal(tz_composer_new(ctx, &l, &photo, 1, TZ_MAP_COLOUR, NULL, &c), TZ_OK);
    static const tz_rect bad[] = {
        {0, 0, 0, 0},         {0, 0, 101, 1},      {-1, 0, 5, 5},  {0, -1, 5, 5},
        {96, 0, 5, 5},        {0, 46, 5, 5},       {100, 0, 1, 1}, {5, 5, -3, 4},
        {INT32_MAX, 0, 5, 5}, {0, INT32_MIN, 5, 5}};
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
        const tz_rect r = bad[k];
        tz_image out = blank(ctx, r.w > 0 ? r.w : 1, r.h > 0 ? r.h : 1, 3);
        assert_int_equal(tz_composer_render(ctx, c, r, &out), TZ_INVALID);
        assert_true(tz_ctx_message(ctx)[0] != 0);
        tz_ctx_clear(ctx);
        tz_image_deinit(&out);
    }
    tz_image out = blank(ctx, 10, 10, 4); /* another channel count, another size */
    assert_int_equal(tz_composer_render(ctx, c, (tz_rect){0, 0, 10, 10}, &out),
                     TZ_INVALID);
    assert_int_equal(tz_composer_render(ctx, c, (tz_rect){0, 0, 11, 10}, &out),
                     TZ_INVALID);
    tz_image_deinit(&out);
    tz_composer_free(c);
    tz_composer_free(NULL);
    tz_image_deinit(&photo);
    tz_layout_deinit(&l);
    tz_ctx_free(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_crops),         cmocka_unit_test(test_crops_on_a_torus),
        cmocka_unit_test(test_thin_and_tiny), cmocka_unit_test(test_crops_with_void),
        cmocka_unit_test(test_labels),        cmocka_unit_test(test_bad_crops),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
