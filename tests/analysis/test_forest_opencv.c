/* SPDX-License-Identifier: Apache-2.0 */
/* Our channels, decisions and edges are OpenCV's to the last bit. OpenCV uses fused
 * multiply-add where the processor has it; elsewhere its own sums differ, and these tests
 * are skipped. */
#include "tests/analysis/draw.h"

#include "analysis/forest.h"
#include "analysis/forest_rows.h"
#include "scenes/scene.h"
#include "tests/analysis/opencv_forest.h"

static char dir[64];

static bool comparable(void)
{
#if defined(__x86_64__)
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
    return false;
#endif
}

static void image_row(const void *source, int32_t y, float *rgb)
{
    const tz_image *im = source;
    memcpy(rgb, tz_image_at(im, 0, y), 3 * sizeof *rgb * (size_t)im->width);
}

static tz_image scene_photo(tz_ctx *ctx, tz_scene_kind kind, int32_t w, int32_t h)
{
    tz_scene scene;
    tz_image im;
    ok(ctx, tz_scene_render(ctx, kind, TZ_SCENE_WILD, w, h, 77, &scene));
    ok(ctx, tz_image_copy(ctx, &scene.photo, &im));
    tz_scene_deinit(&scene);
    return im;
}

/* 8 trees of 255 nodes, splits drawn at random from values that occur in the picture. */
static tz_forest random_forest(tz_ctx *ctx, const tz_image *im)
{
    enum { NODES = 255, TREES = 8 };
    const int32_t w = im->width, h = im->height;
    tz_rng r = tz_rng_make(5, 1);
    tz_forest_features v;
    tz_forest f = {.ctx = ctx, .trees = TREES, .evaluated = 4, .nodes = NODES};
    ok(ctx, tz_forest_features_init(ctx, image_row, im, w, h, 0, (h + 16) / 2, &v));
    ok(ctx, tz_alloc_zero(ctx, &f.child, TREES * NODES, sizeof *f.child));
    ok(ctx, tz_alloc_zero(ctx, &f.feature, TREES * NODES, sizeof *f.feature));
    ok(ctx, tz_alloc_zero(ctx, &f.threshold, TREES * NODES, sizeof *f.threshold));
    ok(ctx, tz_alloc_zero(ctx, &f.bound, TREES * NODES + 1, sizeof *f.bound));
    ok(ctx, tz_alloc(ctx, &f.bin, TREES * NODES * 8, 1));
    for (int32_t i = 0, bins = 0; i < TREES * NODES; i++) {
        const int32_t at = i % NODES;
        f.feature[i] = tz_rng_below(&r, TZ_FOREST_FEATURES);
        if (at < NODES / 2) {
            int32_t a, b;
            const float *p = tz_forest_features_at(&v, tz_rng_below(&r, w / 2 - 8),
                                                   tz_rng_below(&r, h / 2 - 8));
            tz_forest_feature_place(f.feature[i], v.width, &a, &b);
            f.child[i] = 2 * at + 2;
            f.threshold[i] = p[a] - p[b]; /* equal values must go the same way too */
        }
        for (int32_t k = 0; at >= NODES / 2 && k < 8; k++)
            f.bin[bins++] = (uint8_t)tz_rng_below(&r, 256);
        f.bound[i + 1] = bins;
    }
    tz_forest_features_deinit(&v);
    return f;
}

static void channels_are_equal(void **state)
{
    static const int32_t size[][2] = {
        {16, 16}, {64, 48}, {98, 66}, {100, 34}, {250, 130}};
    (void)state;
    if (!comparable())
        skip();
    for (int k = 0; k < 5; k++) {
        tz_ctx *ctx = new_ctx(2);
        const int32_t w = size[k][0], h = size[k][1], n = (w + 16) / 2 * ((h + 16) / 2);
        tz_image im = scene_photo(ctx, (tz_scene_kind)k, w, h);
        float *regular = malloc((size_t)n * 13 * sizeof(float));
        float *coarse = malloc((size_t)n * 13 * sizeof(float));
        tz_forest_features f;
        opencv_channels(im.px, w, h, regular, coarse);
        ok(ctx, tz_forest_features_init(ctx, image_row, &im, w, h, 0, (h + 16) / 2, &f));
        for (int32_t i = 0; i < n; i++) {
            const float *ours = f.value + (size_t)i * TZ_FOREST_STEP;
            assert_memory_equal(ours, regular + (size_t)i * 13, 13 * sizeof(float));
            assert_memory_equal(ours + TZ_FOREST_LANES, coarse + (size_t)i * 13,
                                13 * sizeof(float));
        }
        free(regular);
        free(coarse);
        tz_forest_features_deinit(&f);
        tz_image_deinit(&im);
        end_ctx(ctx);
    }
}

/* Value of a feature in OpenCV's channels, from its definition. */
static float feature_value(int32_t id, const float *regular, const float *coarse,
                           int32_t width, int32_t x, int32_t y)
{
    static const int32_t middle[5] = {1, 4, 8, 11, 14};
    if (id < 3328) {
        const int32_t z = id / 256, column = id % 256 / 16, row = id % 16;
        /* ids run down a column: the first index of the two is the row's */
        return regular[((size_t)(y + row) * (size_t)width + (size_t)(x + column)) * 13 +
                       (size_t)z];
    }
    const int32_t z = (id - 3328) / 300;
    int32_t pair = (id - 3328) % 300;
    for (int32_t i = 0; i < 25; i++)
        for (int32_t j = i + 1; j < 25; j++)
            if (pair-- == 0) {
                const int32_t ax = x + middle[i / 5], ay = y + middle[i % 5];
                const int32_t bx = x + middle[j / 5], by = y + middle[j % 5];
                return coarse[((size_t)ay * (size_t)width + (size_t)ax) * 13 +
                              (size_t)z] -
                       coarse[((size_t)by * (size_t)width + (size_t)bx) * 13 + (size_t)z];
            }
    return 0;
}

/* Walks down every tree with OpenCV's values and with ours, side by side. */
static void decisions_are_equal(void **state)
{
    enum { W = 120, H = 90, FW = (W + 16) / 2, FH = (H + 16) / 2 };
    static float regular[FW * FH * 13], coarse[FW * FH * 13];
    (void)state;
    if (!comparable())
        skip();
    tz_ctx *ctx = new_ctx(2);
    tz_image im = scene_photo(ctx, TZ_SCENE_PEBBLES, W, H);
    tz_forest forest = random_forest(ctx, &im);
    tz_forest_features f;
    int64_t decisions = 0, left = 0;
    opencv_channels(im.px, W, H, regular, coarse);
    ok(ctx, tz_forest_features_init(ctx, image_row, &im, W, H, 0, FH, &f));
    for (int32_t t = 0; t < forest.trees; t++)
        for (int32_t y = 0; y + 16 <= FH; y += 3)
            for (int32_t x = 0; x + 16 <= FW; x++)
                for (int32_t node = 0; forest.child[t * forest.nodes + node] != 0;) {
                    const int32_t i = t * forest.nodes + node, id = forest.feature[i];
                    const float theirs = feature_value(id, regular, coarse, FW, x, y);
                    int32_t a, b;
                    tz_forest_feature_place(id, f.width, &a, &b);
                    const float *p = tz_forest_features_at(&f, x, y);
                    const float ours = p[a] - p[b];
                    assert_memory_equal(&ours, &theirs, sizeof ours);
                    decisions++;
                    left += theirs < forest.threshold[i];
                    node = forest.child[i] - (theirs < forest.threshold[i]);
                }
    assert_true(decisions > 20000 && left > decisions / 10 && left < decisions * 9 / 10);
    tz_forest_features_deinit(&f);
    tz_forest_deinit(&forest);
    tz_image_deinit(&im);
    end_ctx(ctx);
}

static void edges_are_equal(void **state)
{
    static const int32_t size[][2] = {{32, 32}, {66, 130}, {200, 150}};
    char path[160];
    (void)state;
    if (!comparable())
        skip();
    snprintf(path, sizeof path, "%s/random.yml.gz", dir);
    for (int k = 0; k < 3; k++) {
        tz_ctx *ctx = new_ctx(2);
        const int32_t w = size[k][0], h = size[k][1];
        tz_image im = scene_photo(ctx, (tz_scene_kind)(3 + k), w, h);
        tz_forest forest = random_forest(ctx, &im), read;
        float *ours = malloc((size_t)w * (size_t)h * sizeof(float));
        float *theirs = malloc((size_t)w * (size_t)h * sizeof(float));
        ok(ctx, tz_forest_write(ctx, path, &forest));
        ok(ctx, tz_forest_read(ctx, path, &read));
        opencv_edges(path, im.px, w, h, theirs);
        ok(ctx, tz_forest_detect(ctx, &read, image_row, &im, w, h, 2, 0, h, ours));
        float most = 0;
        for (int32_t i = 0; i < w * h; i++) {
            assert_true(fabsf(ours[i] - theirs[i]) <= 1e-6F);
            most = theirs[i] > most ? theirs[i] : most;
        }
        assert_true(most > 0.01F);
        free(ours);
        free(theirs);
        tz_forest_deinit(&forest);
        tz_forest_deinit(&read);
        tz_image_deinit(&im);
        end_ctx(ctx);
    }
}

/* Both compilations of the loops give the same bits. */
static void plain_rows_are_equal(void **state)
{
    enum { N = 77, TAPS = 2 * TZ_FOREST_BLUR + 1 };
    const tz_forest_rows *a = tz_forest_rows_get(), *b = tz_forest_rows_plain();
    static float in[TAPS][2 * N + 40 * 16], out[2][4 * N * 16], bin[2][2 * N];
    const float *row[TAPS], *up[3] = {in[0], in[1], in[2]};
    const float *at[3] = {in[3], in[4], in[5]}, *down[3] = {in[6], in[7], in[8]};
    tz_rng r = tz_rng_make(3, 1);
    (void)state;
    for (int k = 0; k < TAPS; k++) {
        row[k] = in[k];
        for (size_t i = 0; i < sizeof in[k] / sizeof in[k][0]; i++)
            in[k][i] = (float)tz_rng_unit(&r);
    }
    for (int k = 0; k < 2; k++) {
        const tz_forest_rows *l = k ? b : a;
        l->gradient(up, at, down, N, out[k], bin[k]);
        l->blur_across(in[0], N, 1, out[k] + 2 * N);
        l->blur_down(row, N, out[k] + 3 * N);
        l->blur_three(row, N, out[k] + 4 * N);
        l->blur_down_lanes(row, 5, out[k] + 6 * N);
        l->blur_three_lanes(row, 5, out[k] + 9 * N);
        l->halve(in[0], in[1], N, out[k] + 13 * N);
        l->divide(in[0], N, out[k]);
    }
    assert_memory_equal(out[0], out[1], sizeof out[0]);
    assert_memory_equal(bin[0], bin[1], sizeof bin[0]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(channels_are_equal),
        cmocka_unit_test(decisions_are_equal),
        cmocka_unit_test(edges_are_equal),
        cmocka_unit_test(plain_rows_are_equal),
    };
    begin_dir(dir);
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    end_dir(dir);
    return failed;
}
