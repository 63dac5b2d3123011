/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Renderings against pictures kept in tests/golden/. Tolerance: on average 0.3 of a step
 * of 8 bits, and at most 1 px in 200 farther off than 6 steps (a border that falls on a
 * pixel's centre may go either way). UPDATE_GOLDEN=1 writes them afresh. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/image_io.h"
#include "tests/support/pictures.h"
#include "tests/support/scenes.h"

static void assert_golden(tz_ctx *ctx, const tz_image *im, const char *name)
{
    char path[512];
    snprintf(path, sizeof path, TZ_SOURCE_DIR "/tests/golden/%s.png", name);
    if (getenv("UPDATE_GOLDEN")) {
        const tz_image_write_options opt = {.type = TZ_SAMPLE_U8, .compression = 9};
        assert_int_equal(tz_image_write(ctx, path, im, &opt), TZ_OK);
        return;
    }
    tz_image want;
    const tz_image_read_options opt = {.data = im->encoding == TZ_ENCODING_DATA,
                                       .want = TZ_ENCODING_SRGB};
    if (tz_image_read(ctx, path, &opt, &want) != TZ_OK)
        fail_msg("%s", tz_ctx_message(ctx));
    assert_int_equal(want.width, im->width);
    assert_int_equal(want.height, im->height);
    assert_int_equal(want.channels, im->channels);
    /* both as bytes */
    int64_t far = 0;
    double sum = 0;
    const int64_t n = (int64_t)im->width * im->height;
    for (int64_t i = 0; i < n; i++) {
        double most = 0;
        for (int32_t k = 0; k < im->channels; k++) {
            const double got = floor(255 * im->px[i * im->channels + k] + 0.5);
            const double d = fabs(got - 255 * want.px[i * im->channels + k]);
            sum += d, most = fmax(most, d);
        }
        far += most > 6;
    }
    if (sum / (double)(n * im->channels) > 0.3 || far > n / 200)
        fail_msg("%s: %d px are far off, the mean difference is %.2f of 255", name,
                 (int)far, sum / (double)(n * im->channels));
    tz_image_deinit(&want);
}

static void golden(tz_map_kind kind, bool tile, const char *name)
{
    tz_ctx *ctx = new_ctx(2);
    tz_image photo = picture(ctx, PICTURE_STONES, 120, 100, 3, 21);
    if (kind == TZ_MAP_NORMAL) {
        tz_image plane = picture_plane(ctx, 120, 100, 0.48, -0.36, 0.8);
        tz_image_deinit(&photo);
        photo = plane;
    }
    tz_layout l;
    scene_init(ctx, &l, 160, 128, tile, 120, 100);
    scene_random(&l, 24, 77);
    tz_image out = render(ctx, &l, &photo, 1, kind, NULL, (tz_rect){0});
    assert_golden(ctx, &out, name);
    tz_image_deinit(&out);
    tz_image_deinit(&photo);
    tz_layout_deinit(&l);
    tz_ctx_free(ctx);
}

static void test_colour(void **state)
{
    (void)state;
    golden(TZ_MAP_COLOUR, false, "compose-colour");
}

static void test_tile(void **state)
{
    (void)state;
    golden(TZ_MAP_COLOUR, true, "compose-tile");
}

static void test_normals(void **state)
{
    (void)state;
    golden(TZ_MAP_NORMAL, false, "compose-normals");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_colour),
        cmocka_unit_test(test_tile),
        cmocka_unit_test(test_normals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
