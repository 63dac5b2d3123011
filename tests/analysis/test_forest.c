/* SPDX-License-Identifier: Apache-2.0 */
/* The structured-forest module: a tiny model that runs, and models that must be refused. */
#include "tests/analysis/draw.h"

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
        {"[ 2, 0, 0 ]", "[ 9, 0, 0 ]", "child"},
        {"[ 2, 0, 0 ]", "[ 1, 0, 0 ]", "child"},
        {"[ 2, 0, 0 ]", "[ -4, 0, 0 ]", "child"},
        {"[ 2, 0, 0 ]", "[ 2, 0 ]", "lengths"},
        {"[ 3200, 0, 0 ]", "[ 7228, 0, 0 ]", "feature"},
        {"[ 3200, 0, 0 ]", "[ -1, 0, 0 ]", "feature"},
        {"numberOfTrees: 8", "numberOfTrees: 100000", "numberOfTrees"},
        {"numberOfTrees: 8", "numberOfTrees: 7", "trees"},
        {"stride: 2", "stride: 0", "stride"},
        {"stride: 2", "pace: 2", "stride"},
        {"patchSize: 32", "patchSize: 33", "divide"},
        {"edgeBoundaries: [ 0", "edgeBoundaries: [ 99", "rise"},
        {"edgeBoundaries: [ 0,", "edgeBoundaries: [", "length"},
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
    fails(ctx, detect(ctx, 80, 80, dir), TZ_IO, "regular");
    fails(ctx, detect(ctx, 80, 80, "/nonexistent.yml"), TZ_IO, "nonexistent");
    end_ctx(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sound_models_run),
        cmocka_unit_test(bad_models_are_refused),
    };
    begin_dir(dir);
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    end_dir(dir);
    return failed;
}
