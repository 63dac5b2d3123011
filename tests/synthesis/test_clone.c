/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Rendering with stock seamlessClone, the reference: seams go, copies stay, patches may
 * leave the picture, crops are cut out, cancel is heard. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/module.h"
#include "synthesis/clone_module.h"
#include "tests/support/pictures.h"
#include "tests/support/scenes.h"

static const tz_rect all = {0, 0, 0, 0};
/* Half a step of 8 bits is lost on the way in, another on the way out. */
#define BYTE (1.01 / 255)

static void need_module(void)
{
    const tz_clone_api *api = NULL;
    tz_ctx *ctx = new_ctx(1);
    const tz_status s = tz_module_symbol(ctx, "clone", TZ_CLONE_SYMBOL, &api);
    if (s != TZ_OK)
        printf("skipped: %s\n", tz_ctx_message(ctx));
    tz_ctx_free(ctx);
    if (s != TZ_OK)
        skip();
}

static tz_image clone(tz_ctx *ctx, const tz_layout *l, const tz_image *photo,
                      tz_map_kind kind, tz_rect r)
{
    const tz_compose_params p = cloned(TZ_CLONE_OPENCV);
    return render(ctx, l, photo, 1, kind, &p, r);
}

/* A patch of the photo on the photo, where it came from: nothing changes. Which pixel the
 * patch lands on shows here. */
static void test_patch_in_its_own_place(void **state)
{
    (void)state;
    need_module();
    for (int32_t channels = 1; channels <= 4; channels++) {
        tz_ctx *ctx = new_ctx(2);
        tz_image photo = picture(ctx, PICTURE_STONES, 160, 120, channels, 3);
        tz_layout l;
        scene_init(ctx, &l, 160, 120, false, 160, 120);
        scene_box(&l, 0, tz_affine_identity(), 0, 0, 160, 120);
        scene_box(&l, 0, tz_affine_identity(), 31, 20, 96, 77);
        tz_image out = clone(ctx, &l, &photo, TZ_MAP_COLOUR, all);
        /* the solver cuts to whole numbers: a patch grows darker by 1 */
        assert_true(mean_difference(&out, &photo) < 2 * BYTE);
        assert_true(largest_difference(&out, &photo) < 5 * BYTE);
        tz_image_deinit(&out);
        tz_image_deinit(&photo);
        tz_layout_deinit(&l);
        tz_ctx_free(ctx);
    }
}

/* A flat patch on a flat floor of another tone takes the floor's tone: no step is left. */
static void test_step_goes(void **state)
{
    (void)state;
    need_module();
    tz_ctx *ctx = new_ctx(2);
    tz_image photo = picture(ctx, PICTURE_GREY, 200, 100, 3, 0);
    for (int32_t y = 0; y < 100; y++)
        for (int32_t x = 100; x < 200; x++)
            for (int k = 0; k < 3; k++)
                tz_image_at(&photo, x, y)[k] = 0.7F;
    tz_layout l;
    scene_init(ctx, &l, 90, 90, false, 200, 100);
    scene_box(&l, 0, tz_affine_identity(), 0, 0, 95, 95);
    scene_box(&l, 0, move_by(-100, 0), 120, 20, 170, 70);
    const tz_compose_params none = cloned(TZ_CLONE_NONE);
    tz_image plain = render(ctx, &l, &photo, 1, TZ_MAP_COLOUR, &none, all);
    assert_float_equal(tz_image_at(&plain, 45, 45)[0], 0.7, 1e-5);
    tz_image out = clone(ctx, &l, &photo, TZ_MAP_COLOUR, all);
    /* the canvas starts as the plain composite, so that the rim keeps what it meets there;
     * what matters: no step */
    for (int32_t y = 0; y < 90; y++)
        for (int32_t x = 1; x < 90; x++)
            assert_true(
                fabs(tz_image_at(&out, x, y)[0] - tz_image_at(&out, x - 1, y)[0]) < 0.1);
    tz_image_deinit(&plain);
    tz_image_deinit(&out);
    tz_image_deinit(&photo);
    tz_layout_deinit(&l);
    tz_ctx_free(ctx);
}

/* Turned, mirrored blobs, many of which leave the picture or lie outside it. */
static void test_patches_at_the_border(void **state)
{
    (void)state;
    need_module();
    for (int tile = 0; tile < 2; tile++) {
        tz_ctx *ctx = new_ctx(2);
        tz_image photo = picture(ctx, PICTURE_SMOOTH, 90, 70, 3, 3);
        tz_layout l;
        scene_init(ctx, &l, 131, 117, tile, 90, 70);
        scene_random(&l, 60, 5);
        scene_box(&l, 0, move_by(-500, 40), 0, 0, 90, 70);   /* outside */
        scene_box(&l, 0, move_by(130.5, 3), 0, 0, 2, 2);     /* smaller than the least */
        scene_box(&l, 0, move_by(-30, -30), 0, 0, 300, 300); /* larger than all */
        tz_image out = clone(ctx, &l, &photo, TZ_MAP_COLOUR, all);
        assert_true(all_finite(&out));
        tz_image_deinit(&out);
        tz_image_deinit(&photo);
        tz_layout_deinit(&l);
        tz_ctx_free(ctx);
    }
}

static void test_crop_is_cut_out(void **state)
{
    (void)state;
    need_module();
    tz_ctx *ctx = new_ctx(2);
    tz_image photo = picture(ctx, PICTURE_STONES, 90, 70, 3, 3);
    tz_layout l;
    scene_init(ctx, &l, 150, 130, false, 90, 70);
    scene_random(&l, 40, 6);
    tz_image out = clone(ctx, &l, &photo, TZ_MAP_COLOUR, all);
    const tz_rect r = {37, 21, 64, 50};
    tz_image part = clone(ctx, &l, &photo, TZ_MAP_COLOUR, r);
    for (int32_t y = 0; y < r.h; y++)
        assert_memory_equal(tz_image_at(&part, 0, y), tz_image_at(&out, r.x, r.y + y),
                            (size_t)r.w * 3 * sizeof(float));
    /* a crop that leaves the layout is refused, and nothing is written */
    const tz_compose_params p = cloned(TZ_CLONE_OPENCV);
    tz_composer *c = NULL;
    assert_int_equal(tz_composer_new(ctx, &l, &photo, 1, TZ_MAP_COLOUR, &p, &c), TZ_OK);
    tz_image before = blank(ctx, r.w, r.h, 3);
    tz_image_deinit(&part);
    part = blank(ctx, r.w, r.h, 3);
    assert_int_equal(tz_composer_render(ctx, c, (tz_rect){100, 21, r.w, r.h}, &part),
                     TZ_INVALID);
    assert_int_equal(pixels_that_differ(&part, &before), 0);
    tz_composer_free(c);
    tz_image_deinit(&before);
    tz_image_deinit(&part);
    tz_image_deinit(&out);
    tz_image_deinit(&photo);
    tz_layout_deinit(&l);
    tz_ctx_free(ctx);
}

/* Heights keep their range; alpha is not cloned; normals and odd channels are refused. */
static void test_kinds_of_maps(void **state)
{
    (void)state;
    need_module();
    tz_ctx *ctx = new_ctx(2);
    tz_image height = picture(ctx, PICTURE_SMOOTH, 90, 70, 1, 3);
    for (int32_t y = 0; y < 70; y++)
        for (int32_t x = 0; x < 90; x++)
            *tz_image_at(&height, x, y) = 300 * *tz_image_at(&height, x, y) - 100;
    height.encoding = TZ_ENCODING_DATA;
    tz_layout l;
    scene_init(ctx, &l, 90, 70, false, 90, 70);
    scene_box(&l, 0, tz_affine_identity(), 0, 0, 90, 70);
    scene_box(&l, 0, tz_affine_identity(), 20, 20, 60, 50);
    tz_image out = clone(ctx, &l, &height, TZ_MAP_DATA, all);
    assert_int_equal(out.encoding, TZ_ENCODING_DATA);
    assert_true(mean_difference(&out, &height) < 300 * BYTE);
    tz_image_deinit(&out);

    tz_image rgba = picture(ctx, PICTURE_NOISE, 90, 70, 4, 3);
    out = clone(ctx, &l, &rgba, TZ_MAP_COLOUR, all);
    for (int32_t y = 0; y < 70; y++)
        for (int32_t x = 0; x < 90; x++)
            assert_true(tz_image_at(&out, x, y)[3] == tz_image_at(&rgba, x, y)[3]);
    tz_image_deinit(&out);
    tz_image_deinit(&rgba);

    const struct {
        tz_map_kind kind;
        int32_t channels;
    } bad[] = {{TZ_MAP_NORMAL, 3}, {TZ_MAP_DATA, 5}};
    for (int k = 0; k < 2; k++) {
        tz_image photo = picture(ctx, PICTURE_NOISE, 90, 70, bad[k].channels, 3);
        const tz_compose_params p = cloned(TZ_CLONE_OPENCV);
        tz_composer *c = NULL;
        assert_int_equal(tz_composer_new(ctx, &l, &photo, 1, bad[k].kind, &p, &c), TZ_OK);
        out = blank(ctx, 90, 70, bad[k].channels);
        assert_int_equal(tz_composer_render(ctx, c, (tz_rect){0, 0, 90, 70}, &out),
                         TZ_INVALID);
        assert_non_null(strstr(tz_ctx_message(ctx), "screened"));
        tz_ctx_clear(ctx);
        tz_composer_free(c);
        tz_image_deinit(&out);
        tz_image_deinit(&photo);
    }
    tz_image_deinit(&height);
    tz_layout_deinit(&l);
    tz_ctx_free(ctx);
}

/* An OpenCV exception arrives as a status with a line of text: the warp takes no picture
 * of 2^15 px. */
static void test_exceptions(void **state)
{
    (void)state;
    const tz_clone_api *api = NULL;
    tz_ctx *ctx = new_ctx(1);
    need_module();
    assert_int_equal(tz_module_symbol(ctx, "clone", TZ_CLONE_SYMBOL, &api), TZ_OK);
    enum { WIDE = 40000 };
    static uint8_t wide[WIDE * 4 * 3], small[100 * 100 * 3];
    const double border[] = {10, 10, 60, 10, 60, 60, 10, 60};
    const tz_clone_patch patch = {{wide, WIDE, 4}, {1, 0, 0, 1, 0, 0}, border, 4};
    const tz_clone_picture canvas = {small, 100, 100};
    char why[40] = "";
    assert_int_equal(api->paste(&patch, &canvas, why, sizeof why), 1);
    assert_true(strlen(why) > 0 && strlen(why) < sizeof why && !strchr(why, '\n'));
    tz_ctx_free(ctx);
}

/* All pixels are counted once the plain composite stands: what is reported later comes
 * from between two placements. */
static void cancel_late(void *user, const tz_progress *p)
{
    if (p->done >= p->total)
        tz_ctx_cancel(*(tz_ctx **)user);
}

static void test_cancel(void **state)
{
    (void)state;
    need_module();
    tz_ctx *ctx = NULL;
    const tz_ctx_options o = {.threads = 2, .on_progress = cancel_late, .user = &ctx};
    assert_int_equal(tz_ctx_new(&o, &ctx), TZ_OK);
    tz_image photo = picture(ctx, PICTURE_STONES, 200, 200, 3, 3);
    tz_layout l;
    scene_init(ctx, &l, 256, 256, false, 200, 200);
    scene_random(&l, 3000, 6); /* seconds, were it not cancelled */
    const tz_compose_params p = cloned(TZ_CLONE_OPENCV);
    tz_composer *c = NULL;
    assert_int_equal(tz_composer_new(ctx, &l, &photo, 1, TZ_MAP_COLOUR, &p, &c), TZ_OK);
    tz_image out = blank(ctx, 256, 256, 3), before = blank(ctx, 256, 256, 3);
    tz_progress_begin(ctx, "render", "px", 256 * 256);
    assert_int_equal(tz_composer_render(ctx, c, (tz_rect){0, 0, 256, 256}, &out),
                     TZ_CANCELLED);
    tz_progress_end(ctx);
    assert_int_equal(pixels_that_differ(&out, &before), 0);
    tz_composer_free(c);
    tz_image_deinit(&before);
    tz_image_deinit(&out);
    tz_image_deinit(&photo);
    tz_layout_deinit(&l);
    tz_ctx_free(ctx);
}

/* No allocation is taken for granted. */
static void test_faults(void **state)
{
    (void)state;
    need_module();
    tz_ctx *ctx = new_ctx(1);
    tz_image photo = picture(ctx, PICTURE_STONES, 60, 60, 3, 3);
    tz_layout l;
    scene_init(ctx, &l, 64, 64, false, 60, 60);
    scene_random(&l, 3, 6);
    bool done = false;
    for (int64_t n = 1; !done; n++) {
        tz_ctx *failing = NULL;
        assert_int_equal(
            tz_ctx_new(&(tz_ctx_options){.threads = 1, .fail_alloc = n}, &failing),
            TZ_OK);
        const tz_compose_params p = cloned(TZ_CLONE_OPENCV);
        tz_composer *c = NULL;
        tz_image out = blank(ctx, 64, 64, 3);
        tz_status s = tz_composer_new(failing, &l, &photo, 1, TZ_MAP_COLOUR, &p, &c);
        if (s == TZ_OK)
            s = tz_composer_render(failing, c, (tz_rect){0, 0, 64, 64}, &out);
        assert_true(s == TZ_OK || s == TZ_NOMEM);
        done = s == TZ_OK;
        tz_composer_free(c);
        assert_int_equal(tz_ctx_memory_used(failing), 0);
        tz_image_deinit(&out);
        tz_ctx_free(failing);
    }
    tz_image_deinit(&photo);
    tz_layout_deinit(&l);
    tz_ctx_free(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_patch_in_its_own_place),
        cmocka_unit_test(test_step_goes),
        cmocka_unit_test(test_patches_at_the_border),
        cmocka_unit_test(test_crop_is_cut_out),
        cmocka_unit_test(test_kinds_of_maps),
        cmocka_unit_test(test_exceptions),
        cmocka_unit_test(test_cancel),
        cmocka_unit_test(test_faults),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
