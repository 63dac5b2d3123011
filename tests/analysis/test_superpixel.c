/* SPDX-License-Identifier: Apache-2.0 */
/* Superpixels, their merging, and joints. */
#include "tests/analysis/draw.h"

#include "analysis/joints.h"
#include "analysis/regions.h"
#include "analysis/superpixel.h"

static void check_labels(const int32_t *label, int32_t w, int32_t h, int32_t count)
{
    int64_t *area = calloc((size_t)count, sizeof *area);
    for (int64_t p = 0; p < (int64_t)w * h; p++) {
        assert_in_range(label[p], 0, count - 1);
        area[label[p]]++;
    }
    for (int32_t i = 0; i < count; i++)
        assert_true(area[i] > 0);
    assert_int_equal(count_pieces(label, w, h), count);
    free(area);
}

static void every_pixel_has_one(void **state)
{
    (void)state;
    static const int32_t size[][2] = {{1, 1},   {1, 9},   {3, 5},
                                      {64, 64}, {200, 3}, {157, 91}};
    tz_ctx *ctx = new_ctx(1);
    for (int32_t k = 0; k < 6; k++) {
        const int32_t w = size[k][0], h = size[k][1], n = w * h;
        float *r = malloc((size_t)n * sizeof *r), *lab = malloc((size_t)n * sizeof *lab);
        int32_t *label = malloc((size_t)n * sizeof *label), count;
        for (int32_t kind = 0; kind < 3; kind++) {
            tz_rng rng = tz_rng_make((uint64_t)k, (uint64_t)kind);
            for (int32_t i = 0; i < n; i++) {
                r[i] = kind ? (float)tz_rng_unit(&rng) * (kind == 2 ? 1e6f : 1) : 0;
                lab[i] = (float)tz_rng_unit(&rng) * 100;
            }
            for (double step = 2; step < 40; step *= 2.3) {
                ok(ctx,
                   tz_superpixels(ctx, r, w, h, kind ? 0.5 : 0, step, label, &count));
                check_labels(label, w, h, count);
                const tz_region_picture in = {w, h, 1, r, lab};
                const tz_region_options o = {
                    .full = 0.5, .scale = 20, .merge = 0.5, .longest = 50, .least = 20};
                ok(ctx, tz_regions_merge(ctx, &in, &o, label, &count));
                check_labels(label, w, h, count);
            }
        }
        free(r), free(lab), free(label);
    }
    end_ctx(ctx);
}

/* Without anything to see: cells of the grid, of about the wanted size. */
static void uniform_gives_a_grid(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    float *r = calloc(120 * 80, sizeof *r);
    int32_t label[120 * 80], count, area[24] = {0};
    ok(ctx, tz_superpixels(ctx, r, 120, 80, 1, 20, label, &count));
    assert_int_equal(count, 24);
    for (int32_t i = 0; i < 120 * 80; i++)
        area[label[i]]++;
    for (int32_t i = 0; i < 24; i++)
        assert_in_range(area[i], 300, 500);
    free(r);
    end_ctx(ctx);
}

/* Two halves with a strong border between them stay two; each half becomes one. */
static void borders_hold(void **state)
{
    (void)state;
    enum { W = 80, H = 80 };
    static float r[W * H], lab[W * H];
    static int32_t label[W * H];
    tz_ctx *ctx = new_ctx(1);
    int32_t count;
    for (int32_t i = 0; i < W * H; i++) {
        const int32_t x = i % W, y = i / W, d = x - 30 - y / 4;
        r[i] = d == 0 || d == 1 ? 1.0f : 0.02f;
        lab[i] = d < 1 ? 30 : 60;
    }
    ok(ctx, tz_superpixels(ctx, r, W, H, 1, 10, label, &count));
    assert_true(count > 40);
    const tz_region_picture in = {W, H, 1, r, lab};
    const tz_region_options o = {
        .full = 1, .scale = 60, .merge = 0.5, .longest = 80, .least = 20};
    ok(ctx, tz_regions_merge(ctx, &in, &o, label, &count));
    assert_int_equal(count, 2);
    int32_t wrong = 0;
    for (int32_t i = 0; i < W * H; i++)
        wrong += label[i] != (i % W - 30 - i / W / 4 > 0);
    assert_true(wrong < 2 * H);
    end_ctx(ctx);
}

/* A joint between two stones is shared out; both stay whole. */
static void joints_are_shared(void **state)
{
    (void)state;
    enum { W = 60, H = 40 };
    int32_t label[W * H], count = 3;
    tz_ctx *ctx = new_ctx(1);
    for (int32_t i = 0; i < W * H; i++)
        label[i] = i % W < 26 ? 0 : i % W < 34 ? 1 : 2;
    ok(ctx, tz_joints_dissolve(ctx, W, H, 7, label, &count)); /* too wide */
    assert_int_equal(count, 3);
    ok(ctx, tz_joints_dissolve(ctx, W, H, 9, label, &count));
    assert_int_equal(count, 2);
    for (int32_t i = 0; i < W * H; i++)
        assert_int_equal(label[i], i % W >= 30);
    ok(ctx, tz_joints_dissolve(ctx, W, H, 100, label, &count));
    assert_int_equal(count, 2);
    check_labels(label, W, H, count);
    end_ctx(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_pixel_has_one),
        cmocka_unit_test(uniform_gives_a_grid),
        cmocka_unit_test(borders_hold),
        cmocka_unit_test(joints_are_shared),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
