/* SPDX-License-Identifier: Apache-2.0 */
/* Photo to EBPT: what holds for any picture, bins, determinism, cancel, failing memory.
 */
#include "tests/analysis/draw.h"

#include "base/image_io.h"

static void analyze(tz_ctx *ctx, const tz_image *im, const tz_ebpt_params *p, tz_ebpt *e)
{
    ok(ctx, tz_ebpt_analyze(ctx, im, p, e));
    check_ebpt(e);
}

static void any_size_and_content(void **state)
{
    (void)state;
    static const int32_t size[][2] = {{1, 1},     {3, 5},   {1, 40},   {40, 1},
                                      {2, 2},     {7, 7},   {12, 300}, {50000, 1},
                                      {50000, 3}, {130, 65}};
    const tz_ebpt_params p = default_params();
    tz_ctx *ctx = new_ctx(2);
    for (size_t i = 0; i < sizeof size / sizeof *size; i++) {
        for (int32_t channels = 1; channels <= 5; channels++) {
            tz_image im = new_picture(ctx, size[i][0], size[i][1], channels);
            tz_ebpt e;
            analyze(ctx, &im, &p, &e); /* uniform */
            assert_int_equal(e.edge.n, 0);
            tz_ebpt_deinit(&e);
            draw_noise(&im, i);
            analyze(ctx, &im, &p, &e);
            tz_ebpt_deinit(&e);
            tz_image_deinit(&im);
        }
    }
    end_ctx(ctx);
}

static void strange_values(void **state)
{
    (void)state;
    const float odd[] = {NAN, INFINITY, -INFINITY, 1e30f, -5, 0, 100, 1e-30f};
    const tz_ebpt_params p = default_params();
    tz_ctx *ctx = new_ctx(2);
    tz_image im = new_picture(ctx, 90, 70, 4);
    tz_ebpt e;
    for (int64_t i = 0; i < 90 * 70 * 4; i++)
        im.px[i] = odd[(i * 2654435761u >> 7) % 8];
    for (int32_t k = 0; k < 2; k++) {
        im.encoding = k ? TZ_ENCODING_LINEAR : TZ_ENCODING_SRGB;
        analyze(ctx, &im, &p, &e);
        tz_ebpt_deinit(&e);
    }
    for (int64_t i = 0; i < 90 * 70 * 4; i++)
        im.px[i] = i % 4 == 3 ? 0 : (float)(i % 7) / 7; /* nothing shows */
    analyze(ctx, &im, &p, &e);
    assert_int_equal(e.edge.n, 0);
    tz_ebpt_deinit(&e);
    tz_image_deinit(&im);
    end_ctx(ctx);
}

/* Contrast does not matter: the same edges at a part of it. */
static void check_contrast(int32_t edges, float part)
{
    tz_ebpt_params p = default_params();
    tz_ctx *ctx = new_ctx(2);
    tz_image im = new_picture(ctx, 200, 200, 1);
    tz_ebpt e, f;
    p.edges = edges;
    draw_pebbles(&im, 40, 3);
    analyze(ctx, &im, &p, &e);
    for (int32_t i = 0; i < 200 * 200; i++)
        im.px[i] = 0.5f + part * (im.px[i] - 0.5f);
    analyze(ctx, &im, &p, &f);
    assert_true(e.edge.n >= 25);
    assert_true(abs(e.edge.n - f.edge.n) <= e.edge.n / 5);
    assert_true(abs(e.group.n - f.group.n) <= e.group.n / 4);
    tz_ebpt_deinit(&e);
    tz_ebpt_deinit(&f);
    tz_image_deinit(&im);
    end_ctx(ctx);
}

static void low_contrast(void **state)
{
    (void)state;
    check_contrast(TZ_EDGES_GRADIENT, 0.1f);
    check_contrast(TZ_EDGES_FOREST, 0.35f);
}

/* A pebble is one group: its middle and most of its pixels have one label of their own.
 */
static void a_pebble_is_one_group(void **state)
{
    (void)state;
    const tz_ebpt_params p = default_params();
    tz_ctx *ctx = new_ctx(2);
    tz_image im = new_picture(ctx, 480, 480, 3);
    tz_ebpt e;
    draw_pebbles(&im, 60, 5);
    analyze(ctx, &im, &p, &e);
    int32_t whole = 0;
    for (int32_t j = 0; j < 8; j++) {
        for (int32_t i = 0; i < 8; i++) {
            const int32_t own = e.label[(j * 60 + 30) * 480 + i * 60 + 30];
            int32_t same = 0, all = 0;
            for (int32_t y = j * 60; y < j * 60 + 60; y++) {
                for (int32_t x = i * 60; x < i * 60 + 60; x++) {
                    const double dx = x - i * 60 - 29.5, dy = y - j * 60 - 29.5;
                    if (dx * dx + dy * dy > 22 * 22)
                        continue;
                    all++;
                    same += e.label[y * 480 + x] == own;
                }
            }
            whole += same > 0.95 * all && e.group.v[own].area < 1.6 * 3600;
        }
    }
    assert_true(whole >= 60);
    assert_true(e.group.n >= 64 && e.group.n < 160);
    assert_true(e.scale > 40 && e.scale < 80);
    tz_ebpt_deinit(&e);
    tz_image_deinit(&im);
    end_ctx(ctx);
}

static void wanted_groups(void **state)
{
    (void)state;
    tz_ebpt_params p = default_params();
    tz_ctx *ctx = new_ctx(2);
    tz_image im = new_picture(ctx, 300, 200, 3);
    draw_noise(&im, 9);
    for (int32_t k = 0; k < 2; k++) {
        p.merge = k ? 0.5 : 0;
        for (int32_t n = 8; n <= 512; n *= 4) {
            tz_ebpt e;
            p.groups = n;
            analyze(ctx, &im, &p, &e);
            assert_true(e.group.n > 0.7 * n && e.group.n < 1.3 * n);
            tz_ebpt_deinit(&e);
        }
    }
    tz_image_deinit(&im);
    end_ctx(ctx);
}

static void bins(void **state)
{
    (void)state;
    tz_ebpt_params p = default_params();
    tz_ctx *ctx = new_ctx(2);
    tz_image im = new_picture(ctx, 300, 300, 3);
    tz_ebpt e;
    draw_pebbles(&im, 30, 1);
    p.length_bins = 4, p.angle_bins = 5, p.min_length = 3;
    p.binning = TZ_BINNING_UNIFORM;
    analyze(ctx, &im, &p, &e);
    double longest = 0;
    for (int32_t i = 0; i < e.edge.n; i++)
        longest = fmax(longest, e.edge.v[i].extent);
    for (int32_t i = 0; i < e.edge.n; i++) {
        const tz_edge *d = &e.edge.v[i];
        assert_true(d->extent <= longest * (d->length_bin + 1) / 4 + 1e-9);
        assert_true(d->extent >= longest * d->length_bin / 4 - 1e-9);
        assert_true(d->angle <= TZ_PI * (d->angle_bin + 1) / 5 + 1e-9);
        assert_true(d->angle >= TZ_PI * d->angle_bin / 5 - 1e-9);
    }
    tz_ebpt_deinit(&e);
    p.binning = TZ_BINNING_ADAPTIVE;
    analyze(ctx, &im, &p, &e);
    int32_t count[4][5] = {{0}}, least = e.edge.n, most = 0;
    for (int32_t i = 0; i < e.edge.n; i++)
        count[e.edge.v[i].length_bin][e.edge.v[i].angle_bin]++;
    for (int32_t i = 0; i < 20; i++) {
        const int32_t n = count[i / 5][i % 5];
        least = n < least ? n : least;
        most = n > most ? n : most;
    }
    assert_true(e.edge.n > 50 && most - least <= 2);
    tz_ebpt_deinit(&e);
    tz_image_deinit(&im);
    end_ctx(ctx);
}

static void threads_do_not_matter(void **state)
{
    (void)state;
    static const int threads[] = {1, 2, 3, 8};
    const tz_ebpt_params p = default_params();
    tz_ctx *ctx[4];
    tz_ebpt e[4];
    for (int32_t k = 0; k < 4; k++) {
        ctx[k] = new_ctx(threads[k]);
        tz_image im = new_picture(ctx[k], 333, 257, 3);
        draw_pebbles(&im, 37, 2);
        tz_rng r = tz_rng_make(4, 4);
        for (int32_t i = 0; i < 333 * 257 * 3; i++)
            im.px[i] += (float)tz_rng_range(&r, -0.1, 0.1);
        analyze(ctx[k], &im, &p, &e[k]);
        tz_image_deinit(&im);
        check_same(&e[0], &e[k]);
    }
    for (int32_t k = 0; k < 4; k++) {
        tz_ebpt_deinit(&e[k]);
        end_ctx(ctx[k]);
    }
}

static void bad_input(void **state)
{
    (void)state;
    tz_ebpt_params p = default_params();
    tz_ctx *ctx = new_ctx(2);
    tz_image im = new_picture(ctx, 64, 64, 3), none = {0};
    tz_ebpt e;
    fails(ctx, tz_ebpt_analyze(ctx, &none, &p, &e), TZ_INVALID, "no pixels");
    p.edges = TZ_EDGES_FOREST;
    strcpy(p.model, "/nonexistent/model.yml");
    fails(ctx, tz_ebpt_analyze(ctx, &im, &p, &e), TZ_IO, "model.yml");
    tz_ctx_cancel(ctx);
    p.edges = TZ_EDGES_GRADIENT;
    assert_int_equal(tz_ebpt_analyze(ctx, &im, &p, &e), TZ_CANCELLED);
    assert_null(e.label);
    tz_ctx_clear(ctx);
    tz_image_deinit(&im);
    end_ctx(ctx);
}

static tz_status analyze_once(tz_ctx *ctx)
{
    const tz_ebpt_params p = default_params();
    tz_image im;
    tz_ebpt e = {0};
    tz_status s = tz_image_init(ctx, &im, 64, 48, 3);
    if (s == TZ_OK) {
        im.encoding = TZ_ENCODING_SRGB;
        draw_pebbles(&im, 16, 1);
        s = tz_ebpt_analyze(ctx, &im, &p, &e);
    }
    tz_ebpt_deinit(&e);
    tz_image_deinit(&im);
    return s;
}

static void memory_may_fail(void **state)
{
    (void)state;
    survive(analyze_once, 1);
}

static void photos(void **state)
{
    (void)state;
    static const char *const name[] = {"stone_wall.jpg", "pebbles_large.jpg",
                                       "brick_gray.png", "gravel_gray.png"};
    /* walls of stones and bricks, pebbles, gravel: groups of a sane number */
    static const int32_t least[] = {100, 25, 70, 250}, most[] = {320, 120, 180, 1200};
    const tz_ebpt_params p = default_params();
    const tz_image_read_options o = {.want = TZ_ENCODING_SRGB};
    need_photos();
    tz_ctx *ctx = new_ctx(2);
    for (int32_t i = 0; i < 4; i++) {
        char path[1024];
        tz_image im;
        tz_ebpt e;
        snprintf(path, sizeof path, PHOTO("%s"), name[i]);
        ok(ctx, tz_image_read(ctx, path, &o, &im));
        analyze(ctx, &im, &p, &e);
        assert_in_range(e.group.n, least[i], most[i]);
        assert_in_range(e.edge.n, 200, 3000);
        for (int32_t k = 0; k < e.group.n; k++) {
            assert_true(e.group.v[k].area >= 100);
            assert_true(e.group.v[k].box.w <= 0.45 * im.width);
        }
        tz_ebpt_deinit(&e);
        tz_image_deinit(&im);
    }
    end_ctx(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_size_and_content),  cmocka_unit_test(strange_values),
        cmocka_unit_test(low_contrast),          cmocka_unit_test(a_pebble_is_one_group),
        cmocka_unit_test(wanted_groups),         cmocka_unit_test(bins),
        cmocka_unit_test(threads_do_not_matter), cmocka_unit_test(bad_input),
        cmocka_unit_test(memory_may_fail),       cmocka_unit_test(photos),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
