/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Rendering of curves when memory runs out, somebody cancels, or input does not fit; and
 * strips. */
#include <unistd.h>

#include "base/image_io.h"
#include "tests/synthesis/test_curve_render.h"

/* A bit of everything: strokes, tapers, an element, a torus. */
static void mixed_set(tz_ctx *ctx, tz_curve_set *s)
{
    curves_init(ctx, s, 300, 170, true);
    curves_scatter(s, 24, 6);
    for (int32_t i = 0; i < s->piece.n; i++)
        OK(tz_array_push(ctx, &s->taper, ((tz_curve_taper){1 + i % 5, 2 + i % 3})));
    tz_element_kind kind = {0};
    tz_element_symbol y = {.radius = 12};
    OK(tz_strdup(ctx, "disc", &kind.name));
    OK(tz_strdup(ctx, "d", &y.id));
    OK(tz_strdup(ctx, "<circle r=\"12\" fill=\"#ff0000\"/>", &y.markup));
    OK(tz_strdup(ctx, "<path d=\"M0 0H300V140H0Z\" fill=\"#eef\"/>",
                 &s->element.background));
    OK(tz_array_push(ctx, &s->element.kind, kind));
    OK(tz_array_push(ctx, &s->element.symbol, y));
    OK(tz_array_push(ctx, &s->element.sample, ((tz_sample){{50, 50, 0}, 0, 1})));
    OK(tz_array_push(
        ctx, &s->element.element,
        ((tz_element){
            .source = -1, .samples = 1, .at = {50, 50, 0}, .scale = 1, .radius = 12})));
}

/* The same out of a photo over a ground. */
typedef struct photo_world {
    tz_image photo, plate;
    tz_element_pixels px;
    tz_layout layout;
    tz_element_ground ground;
} photo_world;

static void photo_world_init(tz_ctx *ctx, photo_world *w, tz_curve_set *s)
{
    w->photo = picture(ctx, PICTURE_STONES, 100, 90, 3, 1);
    w->plate = picture(ctx, PICTURE_SMOOTH, 100, 90, 3, 1);
    w->px = (tz_element_pixels){&w->photo, NULL, NULL};
    scene_init(ctx, &w->layout, 300, 170, true, 100, 90);
    scene_random(&w->layout, 12, 5);
    w->ground = (tz_element_ground){&w->layout, &w->plate, 1, NULL};
    tz_rng rng = tz_rng_make(2, 2);
    for (int32_t i = 0; i < s->piece.n; i++) {
        const tz_vec2 p = {tz_rng_range(&rng, 5, 50), tz_rng_range(&rng, 5, 80)};
        OK(tz_array_push(s->ctx, &s->origin,
                         tz_bezier_line(p, (tz_vec2){p.x + 30, p.y})));
    }
}

static void photo_world_deinit(photo_world *w)
{
    tz_image_deinit(&w->photo);
    tz_image_deinit(&w->plate);
    tz_layout_deinit(&w->layout);
}

static tz_status everything(tz_ctx *ctx, const tz_curve_set *s, const photo_world *w,
                            tz_image *out)
{
    static int32_t id[300 * 170];
    const tz_rect all = {0, 0, 300, 170};
    tz_curve_composer *c = NULL;
    tz_status st = tz_curve_composer_new(ctx, w ? &w->ground : NULL, s, w ? &w->px : NULL,
                                         TZ_MAP_COLOUR, NULL, &c);
    if (st != TZ_OK)
        assert_null(c);
    if (st == TZ_OK)
        st = tz_curve_composer_image(ctx, c, 300, 170, out);
    if (st == TZ_OK)
        st = tz_curve_composer_render(ctx, c, all, out);
    if (st == TZ_OK)
        st = tz_curve_composer_map(ctx, c, all, id, NULL, NULL);
    tz_curve_composer_free(c);
    return st;
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    for (int which = 0; which < 4; which++) {
        const int threads = 1 + which % 2;
        tz_curve_set s;
        photo_world w = {0};
        mixed_set(ctx, &s);
        if (which >= 2)
            photo_world_init(ctx, &w, &s);
        tz_image want = {0};
        OK(everything(ctx, &s, which >= 2 ? &w : NULL, &want));
        bool done = false;
        int64_t n = 1;
        for (; !done && n < 5000; n++) {
            tz_ctx *poor = NULL;
            tz_image out = {0};
            if (tz_ctx_new(&(tz_ctx_options){.threads = threads, .fail_alloc = n},
                           &poor) != TZ_OK)
                continue;
            const tz_status st = everything(poor, &s, which >= 2 ? &w : NULL, &out);
            if (st == TZ_OK) {
                assert_int_equal(pixels_that_differ(&out, &want), 0);
                done = true;
            } else {
                assert_int_equal(st, TZ_NOMEM);
                assert_true(tz_ctx_message(poor)[0] != 0);
            }
            tz_image_deinit(&out);
            assert_int_equal(tz_ctx_memory_used(poor), 0); /* nothing leaks */
            tz_ctx_free(poor);
        }
        assert_true(done && n > 30);
        tz_image_deinit(&want);
        if (which >= 2)
            photo_world_deinit(&w);
        tz_curve_set_deinit(&s);
    }
    tz_ctx_free(ctx);
}

static void cancelled(void **state)
{
    (void)state;
    for (int photo = 0; photo < 2; photo++) {
        tz_ctx *ctx = new_ctx(2);
        tz_curve_set s;
        photo_world w = {0};
        mixed_set(ctx, &s);
        if (photo)
            photo_world_init(ctx, &w, &s);
        tz_curve_composer *c =
            composer_of(ctx, &s, &(look){.photo = photo ? &w.px : NULL, .strip = -1});
        tz_image im;
        OK(tz_curve_composer_image(ctx, c, 300, 170, &im));
        tz_ctx_cancel(ctx);
        assert_int_equal(tz_curve_composer_render(ctx, c, (tz_rect){0, 0, 300, 170}, &im),
                         TZ_CANCELLED);
        tz_ctx_clear(ctx); /* and afterwards it works again */
        OK(tz_curve_composer_render(ctx, c, (tz_rect){0, 0, 300, 170}, &im));
        tz_image_deinit(&im);
        tz_curve_composer_free(c);
        if (photo)
            photo_world_deinit(&w);
        tz_curve_set_deinit(&s);
        tz_ctx_free(ctx);
    }
}

static void refused(tz_curve_set *s, const look *l, int32_t source, tz_status want,
                    const char *says)
{
    tz_ctx *ctx = new_ctx(1);
    tz_curve_composer *c = NULL;
    tz_curve_render_params p;
    tz_params_default(&tz_curve_render_param_table, &p);
    p.scale = l->scale;
    p.source = source;
    assert_int_equal(tz_curve_composer_new(ctx, l->ground, s, l->photo, l->kind, &p, &c),
                     want);
    assert_null(c);
    if (!strstr(tz_ctx_message(ctx), says))
        fail_msg("\"%s\" does not say \"%s\"", tz_ctx_message(ctx), says);
    assert_int_equal(tz_ctx_memory_used(ctx), 0);
    tz_ctx_free(ctx);
}

static void what_does_not_fit_is_refused(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_curve_set s;
    photo_world w = {0};
    mixed_set(ctx, &s);
    refused(&s, &(look){.scale = 1e5}, 0, TZ_INVALID, "use a smaller scale");
    refused(&s, &(look){.scale = -1}, 0, TZ_INVALID, "use a smaller scale");
    refused(&s, &(look){0}, 2, TZ_INVALID, "which was not given");
    photo_world_init(ctx, &w, &s);
    tz_image small = picture(ctx, PICTURE_GREY, 40, 90, 3, 1),
             many = picture(ctx, PICTURE_NOISE, 100, 90, 7, 1),
             grey = picture(ctx, PICTURE_NOISE, 100, 90, 1, 1);
    refused(&s, &(look){.photo = &(tz_element_pixels){&w.photo, NULL, &small}}, 0,
            TZ_INVALID, "same proportions");
    refused(&s,
            &(look){.photo = &(tz_element_pixels){&w.photo, NULL, &grey},
                    .kind = TZ_MAP_NORMAL},
            0, TZ_INVALID, "three channels");
    refused(
        &s,
        &(look){.photo = &(tz_element_pixels){&many, NULL, NULL}, .kind = TZ_MAP_DATA}, 0,
        TZ_INVALID, "channels");
    refused(
        &s,
        &(look){.photo = &(tz_element_pixels){&grey, NULL, NULL}, .ground = &w.ground}, 0,
        TZ_INVALID, "channels");
    for (int32_t i = 0; i < s.origin.n; i++)
        s.origin.v[i].p[0].x = NAN;
    refused(&s, &(look){.photo = &w.px}, 0, TZ_INVALID, "none of its lines");
    const double x = s.node.v[3].x;
    s.node.v[3].x = INFINITY;
    refused(&s, &(look){0}, 0, TZ_INVALID, "path");
    s.node.v[3].x = x;
    tz_curve_composer *c = composer_of(ctx, &s, &(look){.strip = -1});
    tz_image im;
    OK(tz_curve_composer_image(ctx, c, 20, 20, &im));
    assert_int_equal(tz_curve_composer_render(ctx, c, (tz_rect){290, 0, 20, 20}, &im),
                     TZ_INVALID);
    tz_ctx_clear(ctx);
    assert_int_equal(tz_curve_composer_render(ctx, c, (tz_rect){0, 0, 20, 30}, &im),
                     TZ_INVALID);
    tz_ctx_clear(ctx);
    assert_int_equal(tz_curve_composer_render(ctx, c, (tz_rect){0, 0, 0, 20}, &im),
                     TZ_INVALID);
    tz_image_deinit(&im);
    tz_curve_composer_free(c);
    tz_image_deinit(&small);
    tz_image_deinit(&many);
    tz_image_deinit(&grey);
    photo_world_deinit(&w);
    tz_curve_set_deinit(&s);
    tz_ctx_free(ctx);
}

/* Streamed under a small budget, the file holds what is rendered at once. */
static void strips_make_the_same_file(void **state)
{
    (void)state;
    char path[] = "/tmp/terrazzo-curves-XXXXXX.png";
    const int fd = mkstemps(path, 4);
    assert_true(fd >= 0);
    close(fd);
    for (int photo = 0; photo < 2; photo++) {
        tz_ctx *ctx = new_ctx(2), *poor = NULL;
        tz_curve_set s;
        photo_world w = {0};
        mixed_set(ctx, &s);
        if (photo)
            photo_world_init(ctx, &w, &s);
        const look l = {.photo = photo ? &w.px : NULL,
                        .ground = photo ? &w.ground : NULL,
                        .strip = -1};
        tz_image want = curves_drawn(ctx, &s, &l), got = {0}, like;
        OK(tz_ctx_new(&(tz_ctx_options){.threads = 2, .memory = 64U << 20}, &poor));
        tz_curve_composer *c = composer_of(poor, &s, &l);
        tz_image_sink *sink = NULL;
        const tz_image_write_options opt = {.type = TZ_SAMPLE_U16, .compression = -1};
        OK(tz_curve_composer_image(poor, c, 1, 1, &like));
        OK(tz_image_sink_open(poor, path, 300, 170, &like, &opt, &sink));
        OK(tz_curve_composer_stream(poor, c, (tz_rect){0, 0, 300, 170}, sink));
        OK(tz_image_sink_close(sink));
        OK(tz_image_read(ctx, path, NULL, &got));
        OK(tz_image_convert(ctx, &got, TZ_ENCODING_SRGB));
        for (int32_t y = 0; y < 170; y++)
            for (int32_t x = 0; x < 300; x++) {
                const float *a = tz_image_at(&want, x, y), *b = tz_image_at(&got, x, y);
                for (int32_t k = 0; k < want.channels; k++)
                    assert_true(fabsf(a[k] - b[k]) < 1e-4F ||
                                (want.alpha >= 0 && a[want.alpha] < 0.01F));
            }
        tz_curve_composer_free(c);
        tz_image_deinit(&like);
        tz_image_deinit(&want);
        tz_image_deinit(&got);
        tz_ctx_free(poor);
        if (photo)
            photo_world_deinit(&w);
        tz_curve_set_deinit(&s);
        tz_ctx_free(ctx);
    }
    unlink(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_allocation_may_fail),
        cmocka_unit_test(cancelled),
        cmocka_unit_test(what_does_not_fit_is_refused),
        cmocka_unit_test(strips_make_the_same_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
