/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Compositing when memory runs out or somebody cancels, and streaming within a budget. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "tests/support/pictures.h"
#include "tests/support/scenes.h"

/* ---- memory ------------------------------------------------------------------------ */

/* The n-th allocation fails, n = 1, 2, ... until nothing fails any more. */
static void test_every_allocation_may_fail(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_image photo = picture(ctx, PICTURE_NOISE, 60, 60, 3, 1);
    tz_layout l;
    scene_init(ctx, &l, 600, 130, true, 60, 60);
    for (int k = 0; k < 12; k++) /* with void between them */
        scene_box(&l, 0,
                  turned((tz_vec2){30, 30}, (tz_vec2){50 * k, 60}, 30 * k, 1, false), 8,
                  8, 52, 52);
    tz_image want = render_colour(ctx, &l, &photo, (tz_rect){0});
    for (int threads = 1; threads <= 2; threads++) {
        bool done = false;
        int64_t n = 1;
        for (; !done && n < 5000; n++) {
            tz_ctx *poor = NULL;
            if (tz_ctx_new(&(tz_ctx_options){.threads = threads, .fail_alloc = n},
                           &poor) != TZ_OK)
                continue;
            tz_composer *c = NULL;
            tz_image out = blank(ctx, 600, 130, 3);
            tz_status s = tz_composer_new(poor, &l, &photo, 1, TZ_MAP_COLOUR, NULL, &c);
            if (s == TZ_OK)
                s = tz_composer_render(poor, c, (tz_rect){0, 0, 600, 130}, &out);
            else
                assert_null(c);
            if (s == TZ_OK) { /* the failing one was not reached */
                assert_int_equal(pixels_that_differ(&out, &want), 0);
                done = true;
            } else {
                assert_int_equal(s, TZ_NOMEM);
                assert_true(tz_ctx_message(poor)[0] != 0);
            }
            tz_composer_free(c);
            assert_int_equal(tz_ctx_memory_used(poor), 0); /* nothing leaks */
            tz_image_deinit(&out);
            tz_ctx_free(poor);
        }
        assert_true(done && n > 15);
    }
    tz_image_deinit(&want);
    tz_image_deinit(&photo);
    tz_layout_deinit(&l);
    tz_ctx_free(ctx);
}

/* ---- cancelling -------------------------------------------------------------------- */

typedef struct canceller {
    tz_ctx *ctx;
    int calls;
} canceller;

static void on_progress(void *user, const tz_progress *p)
{
    canceller *c = user;
    (void)p;
    c->calls++;
    tz_ctx_cancel(c->ctx);
}

static void test_cancel(void **state)
{
    (void)state;
    for (int before = 0; before < 2; before++) {
        canceller user = {0};
        tz_ctx *ctx = NULL;
        assert_int_equal(tz_ctx_new(&(tz_ctx_options){.threads = 2,
                                                      .on_progress = on_progress,
                                                      .user = &user},
                                    &ctx),
                         TZ_OK);
        user.ctx = ctx;
        tz_image photo = picture(ctx, PICTURE_STONES, 100, 100, 3, 1);
        tz_layout l;
        scene_init(ctx, &l, 3000, 3000, false, 100, 100);
        scene_random(&l, 400, 1);
        tz_composer *c = NULL;
        assert_int_equal(tz_composer_new(ctx, &l, &photo, 1, TZ_MAP_COLOUR, NULL, &c),
                         TZ_OK);
        tz_image out = blank(ctx, 3000, 3000, 3);
        if (before)
            tz_ctx_cancel(ctx);
        tz_progress_begin(ctx, "render", "px", 9000000);
        const tz_status s = tz_composer_render(ctx, c, (tz_rect){0, 0, 3000, 3000}, &out);
        tz_progress_end(ctx);
        if (before || user.calls)
            assert_true(s == TZ_CANCELLED || (!before && s == TZ_OK));
        /* and afterwards it works again */
        tz_ctx_clear(ctx);
        tz_image part = blank(ctx, 20, 20, 3);
        assert_int_equal(tz_composer_render(ctx, c, (tz_rect){9, 9, 20, 20}, &part),
                         TZ_OK);
        tz_image_deinit(&part);
        tz_image_deinit(&out);
        tz_composer_free(c);
        tz_image_deinit(&photo);
        tz_layout_deinit(&l);
        tz_ctx_free(ctx);
    }
}

/* ---- streaming --------------------------------------------------------------------- */

static void temporary(char *path, size_t size, const char *name)
{
    const char *folder = getenv("TMPDIR");
    snprintf(path, size, "%s/terrazzo-test-%d-%s", folder ? folder : "/tmp",
             (int)getpid(), name);
}

/* A stream in strips has the pixels of a picture in one piece, and stays in its
 * budget. */
static void test_stream(void **state)
{
    (void)state;
    enum { W = 700, H = 2500 };
    const size_t budget = 24 << 20; /* the picture alone is 21 MB as floats */
    char path[512];
    temporary(path, sizeof path, "stream.exr");
    tz_ctx *rich = new_ctx(2), *poor = NULL;
    assert_int_equal(tz_ctx_new(&(tz_ctx_options){.threads = 2, .memory = budget}, &poor),
                     TZ_OK);
    tz_image photo = picture(rich, PICTURE_STONES, 100, 90, 3, 1);
    tz_layout l;
    scene_init(rich, &l, W, H, false, 100, 90);
    scene_random(&l, 250, 1);
    tz_composer *c = NULL;
    tz_image_sink *sink = NULL;
    assert_int_equal(tz_composer_new(poor, &l, &photo, 1, TZ_MAP_DATA, NULL, &c), TZ_OK);
    tz_image like = picture(rich, PICTURE_GREY, 1, 1, 3, 1);
    like.encoding = TZ_ENCODING_DATA;
    const tz_image_write_options opt = {.type = TZ_SAMPLE_FLOAT, .compression = -1};
    assert_int_equal(tz_image_sink_open(poor, path, W, H, &like, &opt, &sink), TZ_OK);
    assert_int_equal(tz_composer_stream(poor, c, (tz_rect){0, 0, W, H}, sink), TZ_OK);
    assert_int_equal(tz_image_sink_close(sink), TZ_OK);
    assert_in_range(tz_ctx_memory_peak(poor), 1, budget);
    tz_composer_free(c);
    assert_int_equal(tz_ctx_memory_used(poor), 0);
    tz_image whole = render(rich, &l, &photo, 1, TZ_MAP_DATA, NULL, (tz_rect){0}), read;
    const tz_image_read_options want = {.data = true};
    assert_int_equal(tz_image_read(rich, path, &want, &read), TZ_OK);
    assert_int_equal(pixels_that_differ(&read, &whole), 0);
    unlink(path);
    tz_image_deinit(&read);
    tz_image_deinit(&whole);
    tz_image_deinit(&like);
    tz_image_deinit(&photo);
    tz_layout_deinit(&l);
    tz_ctx_free(poor);
    tz_ctx_free(rich);
}

/* A budget too small for anything is an error with a message, and leaves no file. */
static void test_stream_without_memory(void **state)
{
    (void)state;
    char path[512];
    temporary(path, sizeof path, "poor.png");
    tz_ctx *ctx = new_ctx(1);
    tz_image photo = picture(ctx, PICTURE_STONES, 100, 90, 3, 1);
    tz_layout l;
    scene_init(ctx, &l, 5000, 900, false, 100, 90);
    scene_random(&l, 50, 1);
    for (size_t budget = 100 << 10; budget <= 3200 << 10; budget *= 2) {
        tz_ctx *poor = NULL;
        tz_composer *c = NULL;
        assert_int_equal(
            tz_ctx_new(&(tz_ctx_options){.threads = 1, .memory = budget}, &poor), TZ_OK);
        tz_status s = tz_composer_new(poor, &l, &photo, 1, TZ_MAP_COLOUR, NULL, &c);
        tz_image_sink *sink = NULL;
        if (s == TZ_OK)
            s = tz_image_sink_open(poor, path, 5000, 900, &photo, NULL, &sink);
        if (s == TZ_OK)
            s = tz_composer_stream(poor, c, (tz_rect){0, 0, 5000, 900}, sink);
        tz_image_sink_abort(sink);
        assert_int_equal(s, TZ_NOMEM);
        assert_true(tz_ctx_message(poor)[0] != 0);
        assert_true(tz_ctx_memory_peak(poor) <= budget);
        tz_composer_free(c);
        assert_int_equal(tz_ctx_memory_used(poor), 0);
        assert_int_not_equal(access(path, F_OK), 0);
        tz_ctx_free(poor);
    }
    tz_image_deinit(&photo);
    tz_layout_deinit(&l);
    tz_ctx_free(ctx);
}

static void test_stream_bad_rectangles(void **state)
{
    (void)state;
    char path[512];
    temporary(path, sizeof path, "bad.png");
    static const tz_rect bad[] = {
        {0, 0, 0, 0}, {0, 0, 101, 100}, {-1, 0, 50, 50}, {0, 90, 10, 20}, {0, 0, 10, -5}};
    tz_ctx *ctx = new_ctx(1);
    tz_image photo = picture(ctx, PICTURE_STONES, 100, 90, 3, 1);
    tz_layout l;
    scene_init(ctx, &l, 100, 100, false, 100, 90);
    scene_random(&l, 3, 1);
    tz_composer *c = NULL;
    assert_int_equal(tz_composer_new(ctx, &l, &photo, 1, TZ_MAP_COLOUR, NULL, &c), TZ_OK);
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
        tz_image_sink *sink = NULL;
        assert_int_equal(tz_image_sink_open(ctx, path, 100, 100, &photo, NULL, &sink),
                         TZ_OK);
        assert_int_equal(tz_composer_stream(ctx, c, bad[k], sink), TZ_INVALID);
        assert_true(tz_ctx_message(ctx)[0] != 0);
        tz_image_sink_abort(sink);
        tz_ctx_clear(ctx);
        assert_int_not_equal(access(path, F_OK), 0);
    }
    tz_composer_free(c);
    tz_image_deinit(&photo);
    tz_layout_deinit(&l);
    tz_ctx_free(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_allocation_may_fail),
        cmocka_unit_test(test_cancel),
        cmocka_unit_test(test_stream),
        cmocka_unit_test(test_stream_without_memory),
        cmocka_unit_test(test_stream_bad_rectangles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
