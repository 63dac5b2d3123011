/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Rendering of elements when memory runs out, somebody cancels, or input does not fit; and
 * strips, and ground and things together. */
#include <unistd.h>

#include "tests/synthesis/test_element_render.h"

/* A bit of everything. */
static void mixed_set(tz_ctx *ctx, tz_element_set *s, bool rich)
{
    set_init(ctx, s, 300, 140, true);
    set_photo(s, 100, 90);
    set_symbol(s, leaf, 11);
    set_symbol(s, bow, 11);
    if (rich)
        set_symbol(s, glow, 10);
    set_disc(s, 30, 40, 12);
    set_disc(s, 70, 30, 9);
    OK(tz_strdup(ctx, "<path d=\"M0 0H300V140H0Z\" fill=\"#eef\"/>", &s->background));
    set_scatter(s, 24, 6, 0.4, 2);
}

typedef struct pictures {
    tz_image photo, plate;
    tz_element_pixels p;
} pictures;

static void pictures_init(tz_ctx *ctx, pictures *p)
{
    p->photo = picture(ctx, PICTURE_STONES, 100, 90, 3, 1);
    p->plate = picture(ctx, PICTURE_SMOOTH, 100, 90, 3, 1);
    p->p = (tz_element_pixels){&p->photo, &p->plate, NULL};
}

static void pictures_deinit(pictures *p)
{
    tz_image_deinit(&p->photo);
    tz_image_deinit(&p->plate);
}

/* ---- memory -------------------------------------------------------------------------- */

static void test_every_allocation_may_fail(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    pictures pic;
    pictures_init(ctx, &pic);
    for (int threads = 1; threads <= 2; threads++) {
        bool done = false;
        int64_t n = 1;
        tz_image want = {0};
        for (; !done && n < 5000; n++) {
            tz_ctx *poor = NULL;
            tz_element_renderer *r = NULL;
            tz_element_set s;
            mixed_set(ctx, &s, true);
            if (tz_ctx_new(&(tz_ctx_options){.threads = threads, .fail_alloc = n},
                           &poor) != TZ_OK) {
                tz_element_set_deinit(&s);
                continue;
            }
            tz_image out = blank(ctx, 300, 140, 4), id = blank(ctx, 300, 140, 1);
            const tz_rect all = {0, 0, 300, 140};
            tz_status st =
                tz_element_renderer_new(poor, &s, &pic.p, TZ_MAP_COLOUR, NULL, &r);
            if (st == TZ_OK)
                st = tz_element_renderer_render(poor, r, all, &out);
            else
                assert_null(r);
            if (st == TZ_OK)
                st = tz_element_renderer_map(poor, r, TZ_ELEMENT_MAP_ID, all, &id);
            if (st == TZ_OK) { /* the failing one was not reached */
                tz_element_renderer *again =
                    renderer_of(ctx, &s, &pic.p, TZ_MAP_COLOUR, NULL);
                want = blank(ctx, 300, 140, 4);
                want.encoding = out.encoding;
                OK(tz_element_renderer_render(ctx, again, all, &want));
                assert_int_equal(pixels_that_differ(&out, &want), 0);
                tz_element_renderer_free(again);
                tz_image_deinit(&want);
                done = true;
            } else {
                assert_int_equal(st, TZ_NOMEM);
                assert_true(tz_ctx_message(poor)[0] != 0);
            }
            tz_element_renderer_free(r);
            assert_int_equal(tz_ctx_memory_used(poor), 0); /* nothing leaks */
            tz_image_deinit(&out);
            tz_image_deinit(&id);
            tz_element_set_deinit(&s);
            tz_ctx_free(poor);
        }
        assert_true(done && n > 40);
    }
    pictures_deinit(&pic);
    tz_ctx_free(ctx);
}

/* ---- cancelling ---------------------------------------------------------------------- */

static void on_progress(void *user, const tz_progress *p)
{
    (void)p;
    tz_ctx_cancel(*(tz_ctx **)user);
}

static void test_cancel(void **state)
{
    (void)state;
    for (int before = 0; before < 2; before++) {
        tz_ctx *ctx = NULL, *user = NULL;
        OK(tz_ctx_new(&(tz_ctx_options){.threads = 2,
                                        .on_progress = on_progress,
                                        .user = (void *)&user},
                      &ctx));
        user = ctx;
        tz_element_set s;
        set_init(ctx, &s, 3000, 3000, false);
        set_symbol(&s, leaf, 11);
        set_scatter(&s, 20000, 4, 0.5, 4);
        tz_element_renderer *r = renderer_of(ctx, &s, NULL, TZ_MAP_COLOUR, NULL);
        tz_image out = blank(ctx, 3000, 3000, 4), part = blank(ctx, 20, 20, 4);
        if (before)
            tz_ctx_cancel(ctx);
        tz_progress_begin(ctx, "render", "px", 9000000);
        const tz_status st =
            tz_element_renderer_render(ctx, r, (tz_rect){0, 0, 3000, 3000}, &out);
        tz_progress_end(ctx);
        assert_true(st == TZ_CANCELLED || (!before && st == TZ_OK));
        tz_ctx_clear(ctx); /* and afterwards it works again */
        OK(tz_element_renderer_render(ctx, r, (tz_rect){9, 9, 20, 20}, &part));
        tz_image_deinit(&part);
        tz_image_deinit(&out);
        tz_element_renderer_free(r);
        tz_element_set_deinit(&s);
        tz_ctx_free(ctx);
    }
}

/* ---- bad input ----------------------------------------------------------------------- */

static void refused(tz_ctx *ctx, tz_status got, tz_status want, const char *word)
{
    const char *message = tz_ctx_message(ctx);
    if (got != want || !strstr(message, word) || strchr(message, '\n'))
        fail_msg("status %d for %d: \"%s\" should speak of %s", got, want, message, word);
    tz_ctx_clear(ctx);
}

static void test_bad_photos(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    pictures pic;
    tz_element_set s;
    tz_element_renderer *r = NULL;
    pictures_init(ctx, &pic);
    mixed_set(ctx, &s, false);
    tz_image small = picture(ctx, PICTURE_GREY, 50, 50, 3, 1),
             grey = picture(ctx, PICTURE_GREY, 100, 90, 1, 1),
             many = picture(ctx, PICTURE_GREY, 100, 90, 5, 1);
    const struct {
        tz_element_pixels p;
        const char *word;
        tz_map_kind kind;
    } bad[] = {{{NULL, NULL, NULL}, "photo.png", TZ_MAP_COLOUR},
               {{&small, NULL, NULL}, "50 x 50", TZ_MAP_COLOUR},
               {{&pic.photo, &small, NULL}, "plate", TZ_MAP_COLOUR},
               {{&pic.photo, NULL, &small}, "map", TZ_MAP_DATA},
               {{&many, NULL, NULL}, "5 channels", TZ_MAP_COLOUR},
               {{&pic.photo, NULL, &grey}, "three channels", TZ_MAP_NORMAL},
               {{&grey, NULL, NULL}, "colours", TZ_MAP_COLOUR}};
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        refused(ctx, tz_element_renderer_new(ctx, &s, &bad[k].p, bad[k].kind, NULL, &r),
                TZ_INVALID, bad[k].word);
        assert_null(r);
    }
    refused(ctx, tz_element_renderer_new(ctx, &s, NULL, TZ_MAP_COLOUR, NULL, &r),
            TZ_INVALID, "photo");
    s.symbol.v[2].photo = 1;
    refused(ctx, tz_element_renderer_new(ctx, &s, &pic.p, TZ_MAP_COLOUR, NULL, &r),
            TZ_INVALID, "symbol");
    tz_image_deinit(&small);
    tz_image_deinit(&grey);
    tz_image_deinit(&many);
    tz_element_set_deinit(&s);
    pictures_deinit(&pic);
    tz_ctx_free(ctx);
}

static void test_bad_drawings(void **state)
{
    (void)state;
    static const char *const broken[] = {"<path d=\"M0 0", "<g>", "</g>",
                                         "<path d=\"M0 0L5 5\"/></svg><svg>",
                                         "&nothing;"};
    tz_ctx *ctx = new_ctx(1);
    for (size_t k = 0; k < sizeof broken / sizeof *broken; k++) {
        tz_element_set s;
        tz_element_renderer *r = NULL;
        set_init(ctx, &s, 50, 50, false);
        set_add(&s, set_symbol(&s, broken[k], 5), 20, 20, 0, 1);
        refused(ctx, tz_element_renderer_new(ctx, &s, NULL, TZ_MAP_COLOUR, NULL, &r),
                TZ_FORMAT, "s0");
        assert_null(r);
        tz_element_set_deinit(&s);
    }
    tz_element_set far;
    tz_element_renderer *none = NULL;
    set_init(ctx, &far, 50, 50, false);
    set_add(&far, set_symbol(&far, "<path d=\"M0 0L1e300 1e300L0 5Z\"/>", 5), 20, 20, 0,
            1);
    refused(ctx, tz_element_renderer_new(ctx, &far, NULL, TZ_MAP_COLOUR, NULL, &none),
            TZ_INVALID, "bounds");
    tz_element_set_deinit(&far);
    /* odd, but no faults */
    static const char *const odd[] = {
        "<path d=\"M0 0L5 5 what\" stroke=\"#000\"/>",
        "<path/>",
        "<circle/>",
        "<path d=\"M0 0\" stroke=\"#000\" stroke-linecap=\"round\"/>",
        "<path d=\"M1 1L1 1Z\" stroke=\"#000\"/>",
        "<circle r=\"-3\"/>",
        " text <!-- -->",
        "<use xlink:href=\"#none\"/>",
        "<path d=\"M0 0L9 0L0 0L9 0\" stroke=\"#000\" fill=\"none\"/>",
        "<circle r=\"4\" fill=\"url(#none)\"/>",
        "<image xlink:href=\"/etc/passwd\"/>"};
    for (size_t k = 0; k < sizeof odd / sizeof *odd; k++) {
        tz_element_set s;
        set_init(ctx, &s, 50, 50, false);
        set_add(&s, set_symbol(&s, odd[k], 5), 20, 20, 0, 1);
        tz_image im = drawn(ctx, &s, 1);
        assert_true(all_finite(&im));
        tz_image_deinit(&im);
        tz_element_set_deinit(&s);
    }
    tz_ctx_free(ctx);
}

static void test_bad_rectangles_and_pictures(void **state)
{
    (void)state;
    static const tz_rect bad[] = {
        {0, 0, 0, 0}, {0, 0, 51, 50}, {-1, 0, 5, 5}, {0, 49, 10, 2}, {0, 0, 10, -5}};
    tz_ctx *ctx = new_ctx(1);
    tz_element_set s;
    tz_element_renderer *r = NULL;
    set_init(ctx, &s, 50, 50, false);
    set_add(&s, set_symbol(&s, leaf, 11), 20, 20, 0, 1);
    tz_element_render_params p;
    tz_params_default(&tz_element_render_param_table, &p);
    p.scale = 1e6;
    refused(ctx, tz_element_renderer_new(ctx, &s, NULL, TZ_MAP_COLOUR, &p, &r),
            TZ_INVALID, "scale");
    r = renderer_of(ctx, &s, NULL, TZ_MAP_COLOUR, NULL);
    tz_image im = blank(ctx, 50, 50, 3), grey = blank(ctx, 50, 50, 1),
             many = blank(ctx, 50, 50, 5);
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++)
        refused(ctx, tz_element_renderer_render(ctx, r, bad[k], &im), TZ_INVALID, "crop");
    const tz_rect all = {0, 0, 50, 50};
    refused(ctx, tz_element_renderer_render(ctx, r, (tz_rect){0, 0, 9, 9}, &im),
            TZ_INVALID, "size");
    refused(ctx, tz_element_renderer_render(ctx, r, all, &grey), TZ_INVALID, "channels");
    refused(ctx, tz_element_renderer_render(ctx, r, all, &many), TZ_INVALID, "channels");
    refused(ctx, tz_element_renderer_map(ctx, r, TZ_ELEMENT_MAP_UV, all, &grey),
            TZ_INVALID, "3 channels");
    OK(tz_element_renderer_render(ctx, r, all, &im));
    tz_image_deinit(&im);
    tz_image_deinit(&grey);
    tz_image_deinit(&many);
    tz_element_renderer_free(r);
    s.element.v[0].at.x = NAN;
    refused(ctx, tz_element_renderer_new(ctx, &s, NULL, TZ_MAP_COLOUR, NULL, &r),
            TZ_INVALID, "element");
    tz_element_set_deinit(&s);
    tz_ctx_free(ctx);
}

/* ---- strips, and ground and things --------------------------------------------------- */

static void test_ground_and_things(void **state)
{
    (void)state;
    enum { W = 300, H = 140 };
    char path[512];
    const char *folder = getenv("TMPDIR");
    snprintf(path, sizeof path, "%s/terrazzo-test-%d-strips.exr",
             folder ? folder : "/tmp", (int)getpid());
    tz_ctx *ctx = new_ctx(2), *poor = NULL;
    pictures pic;
    tz_element_set s;
    tz_layout l;
    pictures_init(ctx, &pic);
    mixed_set(ctx, &s, false);
    tz_free(ctx, s.background); /* the ground lies there */
    s.background = NULL;
    scene_init(ctx, &l, W, H, true, 100, 90);
    scene_random(&l, 30, 1);
    const tz_element_ground ground = {&l, &pic.plate, 1, NULL};
    const tz_rect all = {0, 0, W, H}, crop = {130, 20, 150, 111};
    tz_element_composer *c = NULL;
    OK(tz_element_composer_new(ctx, &ground, &s, &pic.p, TZ_MAP_COLOUR, NULL, &c));
    int32_t w, h;
    tz_element_composer_size(c, &w, &h);
    assert_true(w == W && h == H);
    tz_image whole, part, want = render_colour(ctx, &l, &pic.plate, all);
    OK(tz_element_composer_image(ctx, c, W, H, &whole));
    OK(tz_element_composer_image(ctx, c, crop.w, crop.h, &part));
    assert_int_equal(whole.channels, 3);
    OK(tz_element_composer_render(ctx, c, all, &whole));
    OK(tz_element_composer_render(ctx, c, crop, &part));
    tz_image view = tz_image_view(&whole, crop);
    assert_int_equal(pixels_that_differ(&part, &view), 0);
    /* it is the ground with the things laid over it */
    assert_true(pixels_that_differ(&whole, &want) > W * H / 20);
    OK(tz_element_renderer_render(ctx, tz_element_composer_renderer(c), all, &want));
    assert_int_equal(pixels_that_differ(&whole, &want), 0);
    /* in strips within a budget that makes them low, to a file and back */
    OK(tz_ctx_new(&(tz_ctx_options){.threads = 2, .memory = 16 << 20}, &poor));
    tz_element_composer *d = NULL;
    tz_image_sink *sink = NULL;
    tz_image read;
    const tz_image_write_options opt = {.type = TZ_SAMPLE_FLOAT, .compression = -1};
    OK(tz_element_composer_new(poor, &ground, &s, &pic.p, TZ_MAP_DATA, NULL, &d));
    tz_image data;
    OK(tz_element_composer_image(ctx, d, W, H, &data));
    OK(tz_element_composer_render(ctx, d, all, &data));
    OK(tz_image_sink_open(poor, path, W, H, &data, &opt, &sink));
    OK(tz_element_composer_stream(poor, d, all, sink));
    OK(tz_image_sink_close(sink));
    OK(tz_image_read(ctx, path, &(tz_image_read_options){.data = true}, &read));
    assert_int_equal(pixels_that_differ(&read, &data), 0);
    unlink(path);
    tz_element_composer_free(d);
    assert_int_equal(tz_ctx_memory_used(poor), 0);
    /* twice as large, the ground too: its means stay */
    tz_element_render_params twice;
    tz_params_default(&tz_element_render_param_table, &twice);
    twice.scale = 2;
    d = NULL;
    OK(tz_element_composer_new(ctx, &ground, &s, &pic.p, TZ_MAP_COLOUR, &twice, &d));
    tz_image big;
    OK(tz_element_composer_image(ctx, d, 2 * W, 2 * H, &big));
    OK(tz_element_composer_render(ctx, d, (tz_rect){0, 0, 2 * W, 2 * H}, &big));
    for (int k = 0; k < 3; k++)
        assert_true(fabs(sum_of(&big, k) / 4 - sum_of(&whole, k)) <
                    0.02 * sum_of(&whole, k));
    double off = 0;
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) {
            float mean = 0;
            for (int k = 0; k < 4; k++)
                mean += tz_image_at(&big, 2 * x + (k & 1), 2 * y + (k >> 1))[1] / 4;
            off += fabs((double)mean - tz_image_at(&whole, x, y)[1]);
        }
    assert_true(off / (W * H) < 0.03);
    tz_image_deinit(&big);
    tz_element_composer_free(d);
    /* a ground of other proportions */
    l.width += 20;
    d = NULL;
    refused(ctx,
            tz_element_composer_new(ctx, &ground, &s, &pic.p, TZ_MAP_COLOUR, NULL, &d),
            TZ_INVALID, "ground");
    assert_null(d);
    tz_image_deinit(&read);
    tz_image_deinit(&data);
    tz_image_deinit(&whole);
    tz_image_deinit(&part);
    tz_image_deinit(&want);
    tz_element_composer_free(c);
    tz_layout_deinit(&l);
    tz_element_set_deinit(&s);
    pictures_deinit(&pic);
    tz_ctx_free(poor);
    tz_ctx_free(ctx);
}

/* Strips of a drawing, with alpha. */
static void test_stream_of_a_drawing(void **state)
{
    (void)state;
    char path[512];
    const char *folder = getenv("TMPDIR");
    snprintf(path, sizeof path, "%s/terrazzo-test-%d-drawing.exr",
             folder ? folder : "/tmp", (int)getpid());
    tz_ctx *rich = new_ctx(2), *poor = NULL;
    const size_t budget = 12 << 20;
    OK(tz_ctx_new(&(tz_ctx_options){.threads = 2, .memory = budget}, &poor));
    tz_element_set s;
    set_init(rich, &s, 500, 3000, true);
    set_symbol(&s, leaf, 11);
    set_symbol(&s, ring, 12);
    set_scatter(&s, 900, 6, 0.5, 3);
    tz_image whole = drawn(rich, &s, 1), like, read;
    tz_element_renderer *r = renderer_of(poor, &s, NULL, TZ_MAP_COLOUR, NULL);
    tz_image_sink *sink = NULL;
    const tz_image_write_options opt = {.type = TZ_SAMPLE_FLOAT, .compression = -1};
    OK(tz_element_renderer_like(poor, r, &like));
    OK(tz_image_sink_open(poor, path, 500, 3000, &like, &opt, &sink));
    OK(tz_element_renderer_stream(poor, r, (tz_rect){0, 0, 500, 3000}, sink));
    OK(tz_image_sink_close(sink));
    assert_in_range(tz_ctx_memory_peak(poor), 1, budget);
    OK(tz_image_read(rich, path, &(tz_image_read_options){.want = TZ_ENCODING_LINEAR},
                     &read));
    assert_true(largest_difference(&read, &whole) < 1e-4);
    unlink(path);
    tz_image_deinit(&like);
    tz_image_deinit(&read);
    tz_image_deinit(&whole);
    tz_element_renderer_free(r);
    tz_element_set_deinit(&s);
    tz_ctx_free(poor);
    tz_ctx_free(rich);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_allocation_may_fail),
        cmocka_unit_test(test_cancel),
        cmocka_unit_test(test_bad_photos),
        cmocka_unit_test(test_bad_drawings),
        cmocka_unit_test(test_bad_rectangles_and_pictures),
        cmocka_unit_test(test_ground_and_things),
        cmocka_unit_test(test_stream_of_a_drawing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
