/* SPDX-License-Identifier: Apache-2.0 */
/* Structured forests: a tiny model that runs, and files that must be refused. */
#include "tests/analysis/draw.h"

#include "analysis/boundary_score.h"
#include "analysis/forest.h"

static char dir[64];

/* One tree: bright above (feature 0 of channel L) is a leaf with a line, else one without.
 * Text of the file, with `from` replaced by `to`. */
static const char *model(const char *from, const char *to)
{
    static char path[128];
    char text[8192], *at;
    int n =
        sprintf(text, "%%YAML:1.0\n---\noptions:\n"
                      "   numberOfTrees: 8\n   numberOfTreesToEvaluate: 4\n"
                      "   selfsimilarityGridSize: 5\n   stride: 2\n   shrinkNumber: 2\n"
                      "   patchSize: 32\n   patchInnerSize: 16\n"
                      "   numberOfGradientOrientations: 4\n"
                      "   gradientSmoothingRadius: 0\n   regFeatureSmoothingRadius: 2\n"
                      "   ssFeatureSmoothingRadius: 8\n"
                      "   gradientNormalizationRadius: 4\n");
    static const char *const table[] = {"childs", "featureIds", "thresholds"};
    static const char *const row[] = {"[ 2, 0, 0 ]", "[ 3200, 0, 0 ]", "[ 0.5, 0., 0. ]"};
    for (int k = 0; k < 3; k++) {
        n += sprintf(text + n, "%s:\n", table[k]);
        for (int i = 0; i < 8; i++)
            n += sprintf(text + n, "   - %s\n", row[k]);
    }
    /* node 1 (below the threshold) marks the rows 8 of each column */
    n += sprintf(text + n, "edgeBoundaries: [ 0");
    for (int i = 0; i < 8; i++)
        n += sprintf(text + n, ", %d, %d, %d", 16 * i, 16 * (i + 1), 16 * (i + 1));
    n += sprintf(text + n, " ]\nedgeBins: [");
    for (int i = 0; i < 128; i++)
        n += sprintf(text + n, "%s%d", i ? ", " : " ", 16 * (i % 16) + 8);
    sprintf(text + n, " ]\n");
    FILE *f = fopen((sprintf(path, "%s/model.yml", dir), path), "w");
    assert_non_null(f);
    at = from ? strstr(text, from) : NULL;
    assert_true(!from || at);
    if (at)
        fprintf(f, "%.*s%s%s", (int)(at - text), text, to, at + strlen(from));
    else
        fputs(text, f);
    fclose(f);
    return path;
}

static tz_status detect(tz_ctx *ctx, int32_t w, int32_t h, const char *path)
{
    tz_ebpt_params p = default_params();
    tz_image im = new_picture(ctx, w, h, 3);
    tz_ebpt e;
    draw_pebbles(&im, 30, 1);
    p.edges = TZ_EDGES_AUTO;
    snprintf(p.model, sizeof p.model, "%s", path);
    const tz_status s = tz_ebpt_analyze(ctx, &im, &p, &e);
    if (s == TZ_OK)
        check_ebpt(&e);
    tz_ebpt_deinit(&e);
    tz_image_deinit(&im);
    return s;
}

static void sound_models_run(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    ok(ctx, detect(ctx, 150, 100, model(NULL, NULL)));
    ok(ctx, detect(ctx, 20, 33, model(NULL, NULL)));
    ok(ctx, detect(ctx, 1, 1, model(NULL, NULL)));
    end_ctx(ctx);
}

static void bad_models_are_refused(void **state)
{
    (void)state;
    static const char *const change[][3] = {
        {"[ 2, 0, 0 ]", "[ 9, 0, 0 ]", "children"},
        {"[ 2, 0, 0 ]", "[ 1, 0, 0 ]", "children"},
        {"[ 2, 0, 0 ]", "[ -4, 0, 0 ]", "children"},
        {"[ 2, 0, 0 ]", "[ 2, 0 ]", "lengths"},
        {"[ 3200, 0, 0 ]", "[ 7228, 0, 0 ]", "feature"},
        {"[ 3200, 0, 0 ]", "[ -1, 0, 0 ]", "feature"},
        {"numberOfTrees: 8", "numberOfTrees: 100000", "numberOfTrees"},
        {"numberOfTrees: 8", "numberOfTrees: 7", "length"},
        {"numberOfTrees: 8", "numberOfTrees: 9", "tree 9"},
        {"numberOfTreesToEvaluate: 4", "numberOfTreesToEvaluate: 9", "Evaluate"},
        {"numberOfTrees: 8", "numberOfTrees: many", "number"},
        {"stride: 2", "pace: 2", "stride"},
        {"[ 2, 0, 0 ]", "[ 2, 0, 0, ]", "lengths"},
        {"[ 2, 0, 0 ]", "[ 2 7, 0, 0 ]", "comma"},
        {"[ 2, 0, 0 ]", "[ 2, 0, 0", "childs"},
        {"[ 2, 0, 0 ]", "[ 1000000000, 0, 0 ]", "number 1"},
        {"[ 0.5, 0., 0. ]", "[ 0.5, 1e999, 0. ]", "thresholds"},
        {"[ 0.5, 0., 0. ]", "[ 0.5, 1e39, 0. ]", "thresholds"},
        {"[ 0.5, 0., 0. ]", "[ .nan, 0., 0. ]", "thresholds"},
        {"[ 0.5, 0., 0. ]", "[ ]", "lengths"},
        {"thresholds:", "threshold:", "thresholds"},
        {"edgeBoundaries: [ 0", "edgeBoundaries: [ 99", "rise"},
        {"edgeBoundaries: [ 0,", "edgeBoundaries: [", "length"},
        {"edgeBoundaries: [ 0, 0", "edgeBoundaries: [ 0, 99", "rise"},
        {"edgeBins: [ 8", "edgeBins: [ 256", "edgeBins"},
        {"edgeBins: [ 8", "edgeBins: [ -1", "edgeBins"},
        {"%YAML:1.0", "rubbish", ""},
        {"options:", "%%", ""},
    };
    tz_ctx *ctx = new_ctx(1);
    for (size_t i = 0; i < sizeof change / sizeof *change; i++) {
        const tz_status s = detect(ctx, 80, 80, model(change[i][0], change[i][1]));
        if (s != TZ_FORMAT)
            print_error("%s\n", change[i][1]);
        fails(ctx, s, TZ_FORMAT, change[i][2]);
    }
    fails(ctx, detect(ctx, 80, 80, model("patchSize: 32", "patchSize: 48")),
          TZ_UNSUPPORTED, "patchSize");
    fails(ctx, detect(ctx, 80, 80, model("stride: 2", "stride: 0")), TZ_UNSUPPORTED,
          "stride");
    fails(ctx, detect(ctx, 80, 80, dir), TZ_IO, dir);
    fails(ctx, detect(ctx, 80, 80, "/nonexistent.yml"), TZ_IO, "nonexistent");
    end_ctx(ctx);
}

/* The model as a gzip file of which `keep` bytes are there, or all of it and more. */
static const char *packed(int32_t keep)
{
    static char path[160];
    char command[400];
    sprintf(path, "%s/packed.yml.gz", dir);
    sprintf(command, "gzip -c '%s' > '%s'", model(NULL, NULL), path);
    assert_int_equal(system(command), 0);
    if (keep)
        assert_int_equal(truncate(path, keep), 0);
    return path;
}

static void gzip_files(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    ok(ctx, detect(ctx, 80, 80, packed(0)));
    tz_ctx_drop_kept(ctx);
    for (int32_t keep = 1; keep < 300; keep += 13)
        fails(ctx, detect(ctx, 80, 80, packed(keep)), TZ_FORMAT, "packed.yml.gz");
    fails(ctx, detect(ctx, 80, 80, packed(10000)), TZ_FORMAT, "gzip"); /* zeros behind */
    end_ctx(ctx);
}

/* A few kilobytes that unpack to a gigabyte, and lists that promise more than is there. */
static void bombs(void **state)
{
    (void)state;
    char path[160], command[400];
    tz_ctx *ctx = new_ctx(2);
    sprintf(path, "%s/bomb.yml.gz", dir);
    sprintf(command, "head -c 1000000000 /dev/zero | gzip -1 > '%s'", path);
    assert_int_equal(system(command), 0);
    fails(ctx, detect(ctx, 80, 80, path), TZ_FORMAT, "512 MiB");
    end_ctx(ctx);
}

static void stripes(const void *source, int32_t y, float *rgb)
{
    (void)source;
    for (int32_t x = 0; x < 3 * 70; x++)
        rgb[x] = (x / 21 + y / 9) % 2 ? 0.8F : 0.2F;
}

static tz_status read_and_detect(tz_ctx *ctx)
{
    static float response[70 * 40];
    const tz_forest *f = NULL;
    const tz_status s = tz_forest_of(ctx, model(NULL, NULL), &f);
    return s == TZ_OK
               ? tz_forest_detect(ctx, f, stripes, NULL, 70, 40, 2, 0, 40, response)
               : s;
}

static void memory_may_fail(void **state)
{
    (void)state;
    survive(read_and_detect, 2);
}

/* What is written is what was read, as text and packed. */
static void round_trip(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_forest a, b;
    char path[160];
    ok(ctx, tz_forest_read(ctx, model(NULL, NULL), &a));
    for (int i = 0; i < 2; i++) {
        sprintf(path, "%s/again.yml%s", dir, i ? ".gz" : "");
        ok(ctx, tz_forest_write(ctx, path, &a));
        ok(ctx, tz_forest_read(ctx, path, &b));
        const size_t n = (size_t)a.trees * (size_t)a.nodes;
        assert_int_equal(b.trees, 8);
        assert_int_equal(b.nodes, 3);
        assert_memory_equal(a.child, b.child, n * sizeof *a.child);
        assert_memory_equal(a.feature, b.feature, n * sizeof *a.feature);
        assert_memory_equal(a.threshold, b.threshold, n * sizeof *a.threshold);
        assert_memory_equal(a.bound, b.bound, (n + 1) * sizeof *a.bound);
        assert_memory_equal(a.bin, b.bin, (size_t)a.bound[n]);
        tz_forest_deinit(&b);
    }
    assert_int_equal(tz_forest_write(ctx, "/dev/full", &a), TZ_IO);
    tz_ctx_clear(ctx);
    tz_forest_deinit(&a);
    end_ctx(ctx);
}

/* Long lists are read in parts, which may begin in the middle of a number or behind the
 * last one. */
static void numbers_lie_anywhere(void **state)
{
    enum { PART = 1 << 16 };
    static char row[2 * PART];
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    for (int32_t gap = PART - 12; gap < PART + 3; gap++)
        for (int k = 0; k < 2; k++) {
            tz_forest f;
            snprintf(row, sizeof row, k ? "[ 2, 0, 00000%*s ]" : "[ 2, 0,%*s00000 ]", gap,
                     "");
            ok(ctx, tz_forest_read(ctx, model("[ 2, 0, 0 ]", row), &f));
            assert_int_equal(f.nodes, 3);
            assert_int_equal(f.child[0], 2);
            tz_forest_deinit(&f);
        }
    end_ctx(ctx);
}

static void one_row(const void *source, int32_t y, float *rgb)
{
    const tz_image *im = source;
    memcpy(rgb, tz_image_at(im, 0, y), 3 * sizeof *rgb * (size_t)im->width);
}

/* Rows of a slab are those of the whole, at any stride and thread count. */
static void slabs_join(void **state)
{
    (void)state;
    enum { W = 94, H = 130 };
    static float whole[W * H], part[W * H];
    for (int32_t stride = 2; stride <= 4; stride += 2)
        for (int threads = 1; threads <= 8; threads *= 2) {
            tz_ctx *ctx = new_ctx(threads);
            tz_image im = new_picture(ctx, W, H, 3);
            tz_forest f;
            draw_pebbles(&im, 30, 1);
            ok(ctx, tz_forest_read(ctx, model(NULL, NULL), &f));
            if (threads == 1)
                ok(ctx,
                   tz_forest_detect(ctx, &f, one_row, &im, W, H, stride, 0, H, whole));
            for (int32_t y = 0; y < H; y += 27)
                ok(ctx, tz_forest_detect(ctx, &f, one_row, &im, W, H, stride, y,
                                         y + 27 < H ? y + 27 : H, part + y * W));
            assert_memory_equal(whole, part, sizeof whole);
            tz_forest_deinit(&f);
            tz_image_deinit(&im);
            end_ctx(ctx);
        }
    float most = 0;
    for (int32_t i = 0; i < W * H; i++)
        most = whole[i] > most ? whole[i] : most;
    assert_true(most > 0.1F);
}

/* A photo of several slabs: directions are those of the whole response. */
static void large_photos_are_whole(void **state)
{
    (void)state;
    enum { W = 1300, H = 1700, N = W * H };
    tz_ctx *ctx = new_ctx(2);
    tz_image im = new_picture(ctx, W, H, 1);
    const tz_forest *f = NULL;
    float *r = malloc((size_t)N * sizeof *r), *normal = malloc(2 * (size_t)N * sizeof *r);
    float *whole = malloc(2 * (size_t)N * sizeof *r);
    draw_pebbles(&im, 50, 4);
    ok(ctx, tz_forest_of(ctx, model(NULL, NULL), &f));
    ok(ctx, tz_forest_response(ctx, &im, f, r, normal));
    ok(ctx, tz_boundary_normals(ctx, r, W, H, whole));
    assert_memory_equal(normal, whole, 2 * (size_t)N * sizeof *r);
    free(r);
    free(normal);
    free(whole);
    tz_image_deinit(&im);
    end_ctx(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sound_models_run),
        cmocka_unit_test(bad_models_are_refused),
        cmocka_unit_test(gzip_files),
        cmocka_unit_test(bombs),
        cmocka_unit_test(memory_may_fail),
        cmocka_unit_test(round_trip),
        cmocka_unit_test(numbers_lie_anywhere),
        cmocka_unit_test(slabs_join),
        cmocka_unit_test(large_photos_are_whole),
    };
    begin_dir(dir);
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    end_dir(dir);
    return failed;
}
