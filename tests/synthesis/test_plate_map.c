/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Plates of other maps: the height of a plate is the plate of the height. */
#include "synthesis/plate_map.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "analysis/things.h"
#include "base/rng.h"
#include "scenes/scene.h"
#include "tests/support/pictures.h"
#include "tests/support/scenes.h"

#define OK(call) assert_int_equal((call), TZ_OK)

enum { W = 180, H = 150 };

/* Grain of one's own at every pixel, in colours that tell pixels apart. */
static tz_image grain(tz_ctx *ctx, int w, int h, uint64_t seed)
{
    tz_image im = blank(ctx, w, h, 3);
    tz_rng rng = tz_rng_make(seed, 0);
    im.encoding = TZ_ENCODING_SRGB;
    for (int i = 0; i < 3 * w * h; i++)
        im.px[i] = (float)tz_rng_range(&rng, 0.2, 0.6);
    return im;
}

static bool in_thing(int x, int y)
{
    const double d = fmin(hypot(x - 60, y - 70), hypot(x - 135, y - 60));
    return d < 24 || y > 138;
}

/* Things on grain, and a plate whose holes show the ground from elsewhere, a little
 * brighter on the right as if its light had been evened. */
static void scene(tz_ctx *ctx, tz_image *photo, tz_image *plate, int32_t from[W * H])
{
    tz_image ground = grain(ctx, W, H, 1);
    OK(tz_image_copy(ctx, &ground, photo));
    OK(tz_image_copy(ctx, &ground, plate));
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) {
            int u = x, v = y;
            if (in_thing(x, y)) {
                for (int k = 0; k < 3; k++)
                    tz_image_at(photo, x, y)[k] = k == 0 ? 0.9F : 0.1F;
                u = x < 98 ? x + 37 : x - 40, v = y > 100 ? y - 30 : y + 2;
                if (in_thing(u, v))
                    v = y > 75 ? v - 55 : v + 60, u = in_thing(u, v) ? 5 + x % 20 : u;
            }
            from[y * W + x] = in_thing(u, v) ? -1 : v * W + u;
            memcpy(tz_image_at(plate, x, y), tz_image_at(&ground, u, v),
                   3 * sizeof *plate->px);
        }
    tz_image_deinit(&ground);
}

static tz_image luminance(tz_ctx *ctx, const tz_image *im)
{
    tz_image out = blank(ctx, im->width, im->height, 1);
    out.encoding = TZ_ENCODING_DATA;
    for (int y = 0; y < im->height; y++)
        for (int x = 0; x < im->width; x++) {
            const float *p = tz_image_at(im, x, y);
            *tz_image_at(&out, x, y) =
                im->channels < 3 ? *p : 0.3F * p[0] + 0.6F * p[1] + 0.1F * p[2];
        }
    return out;
}

static void test_the_way_back_is_found(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    int32_t *from = malloc(W * H * sizeof *from);
    tz_image photo, plate, out;
    scene(ctx, &photo, &plate, from);
    tz_image place = blank(ctx, W, H, 2), light = luminance(ctx, &photo),
             want = luminance(ctx, &plate);
    place.encoding = TZ_ENCODING_DATA;
    for (int i = 0; i < W * H; i++)
        place.px[2 * i] = (float)(i % W), place.px[2 * i + 1] = (float)(i / W);
    OK(tz_plate_map(ctx, &photo, &plate, &place, &out));
    int holes = 0, right = 0;
    for (int i = 0; i < W * H; i++) {
        const int u = (int)out.px[2 * i], v = (int)out.px[2 * i + 1];
        assert_false(in_thing(u, v)); /* of sure ground only */
        if (!in_thing(i % W, i / W) || from[i] < 0)
            continue;
        holes++;
        right += v * W + u == from[i];
    }
    if (right < 0.78 * holes)
        fail_msg("%d of %d found", right, holes);
    tz_image_deinit(&out);
    OK(tz_plate_map(ctx, &photo, &plate, &light, &out));
    assert_int_equal(out.encoding, TZ_ENCODING_DATA);
    double error = 0;
    for (int i = 0; i < W * H; i++)
        error += fabs((double)out.px[i] - want.px[i]) / (W * H);
    if (error > 0.004)
        fail_msg("off by %.4f", error);
    tz_image_deinit(&out);
    tz_image_deinit(&place);
    tz_image_deinit(&light);
    tz_image_deinit(&want);
    tz_image_deinit(&photo);
    tz_image_deinit(&plate);
    free(from);
    tz_ctx_free(ctx);
}

/* Pebbles as they are found, and the plate that is made of them. */
static void test_a_plate_of_things(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_scene scene;
    tz_element_set s;
    tz_image plate, out;
    tz_things_params prm;
    tz_params_default(&tz_things_param_table, &prm);
    prm.detail = TZ_THINGS_NORMAL;
    OK(tz_scene_render(ctx, TZ_SCENE_LEAVES, TZ_SCENE_CLEAN, 256, 256, 3, &scene));
    OK(tz_things_find(ctx, &scene.photo, &prm, &s, &plate, NULL));
    tz_image light = luminance(ctx, &scene.photo), want = luminance(ctx, &plate);
    OK(tz_plate_map(ctx, &scene.photo, &plate, &light, &out));
    double error = 0, before = 0;
    for (int i = 0; i < 256 * 256; i++) {
        const double d = (double)out.px[i] - want.px[i],
                     e = (double)light.px[i] - want.px[i];
        error += d * d, before += e * e;
    }
    error = sqrt(error / (256 * 256)), before = sqrt(before / (256 * 256));
    if (error > 0.3 * before || error > 0.05)
        fail_msg("off by %.4f, the map itself by %.4f", error, before);
    tz_image_deinit(&light);
    tz_image_deinit(&want);
    tz_image_deinit(&out);
    tz_image_deinit(&plate);
    tz_element_set_deinit(&s);
    tz_scene_deinit(&scene);
    tz_ctx_free(ctx);
}

/* Maps of other sizes keep theirs; grey photos do; the same bytes at any thread count. */
static void test_sizes_and_threads(void **state)
{
    (void)state;
    int32_t *from = malloc(W * H * sizeof *from);
    tz_image first = {0};
    for (int threads = 1; threads <= 8; threads = threads == 1 ? 2 : threads * 4) {
        tz_ctx *ctx = new_ctx(threads);
        tz_image photo, plate, out;
        scene(ctx, &photo, &plate, from);
        tz_image grey = luminance(ctx, &photo), bare = luminance(ctx, &plate),
                 map = grain(ctx, 2 * W, 2 * H, 4), small = grain(ctx, W / 2, H / 2, 5);
        OK(tz_plate_map(ctx, &photo, &plate, &map, &out));
        assert_true(out.width == 2 * W && out.height == 2 * H && out.channels == 3);
        if (threads == 1)
            OK(tz_image_copy(NULL, &out, &first));
        assert_int_equal(pixels_that_differ(&first, &out), 0);
        for (int y = 0; y < 20; y++) /* ground is kept */
            for (int x = 0; x < 40; x++)
                assert_true(*tz_image_at(&out, x, y) == *tz_image_at(&map, x, y));
        tz_image_deinit(&out);
        OK(tz_plate_map(ctx, &grey, &bare, &small, &out));
        assert_true(out.width == W / 2 && out.height == H / 2);
        tz_image_deinit(&out);
        tz_image_deinit(&grey);
        tz_image_deinit(&bare);
        tz_image_deinit(&map);
        tz_image_deinit(&small);
        tz_image_deinit(&photo);
        tz_image_deinit(&plate);
        tz_ctx_free(ctx);
    }
    tz_image_deinit(&first);
    free(from);
}

/* No ground at all, other sizes, no memory. */
static void test_faults(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_image a = grain(ctx, 70, 60, 1), b = grain(ctx, 70, 60, 2),
             other = grain(ctx, 60, 70, 3), out;
    OK(tz_plate_map(ctx, &a, &b, &a, &out)); /* nothing in common */
    assert_int_equal(pixels_that_differ(&out, &a), 0);
    tz_image_deinit(&out);
    assert_int_equal(tz_plate_map(ctx, &a, &other, &a, &out), TZ_INVALID);
    assert_null(out.px);
    assert_int_equal(tz_plate_map(ctx, &a, &b, &other, &out), TZ_INVALID);
    assert_null(out.px);
    for (int y = 0; y < 60; y++)
        for (int x = 0; x < 35; x++)
            memcpy(tz_image_at(&b, x, y), tz_image_at(&a, x, y), 3 * sizeof *b.px);
    int64_t n = 1;
    for (bool failed = true; failed; n++) {
        tz_ctx *bad = NULL;
        OK(tz_ctx_new(&(tz_ctx_options){.threads = 1, .fail_alloc = n}, &bad));
        const tz_status st = tz_plate_map(bad, &a, &b, &a, &out);
        failed = st != TZ_OK;
        if (failed)
            assert_true(st == TZ_NOMEM && !out.px);
        tz_image_deinit(&out);
        assert_int_equal(tz_ctx_memory_used(bad), 0);
        tz_ctx_free(bad);
    }
    assert_true(n > 8);
    tz_image_deinit(&a);
    tz_image_deinit(&b);
    tz_image_deinit(&other);
    tz_ctx_free(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_the_way_back_is_found),
        cmocka_unit_test(test_a_plate_of_things),
        cmocka_unit_test(test_sizes_and_threads),
        cmocka_unit_test(test_faults),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
