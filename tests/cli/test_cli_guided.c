/* SPDX-License-Identifier: Apache-2.0 */
/* One field for all media: the same strokes and images steer edge groups, elements, curves
 * and fills. */
#include <math.h>

#include "tests/cli/shell.h"

#include <jansson.h>

#define HEAD                                                                      \
    "<svg xmlns='http://www.w3.org/2000/svg' "                                    \
    "xmlns:tz='https://terrazzo.example/ns/1' viewBox='0 0 300 300' fill='none' " \
    "stroke='red' stroke-width='8'>"

static void text(const char *path, const char *content)
{
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    fputs(content, f);
    fclose(f);
}

/* A grey ramp of the given values from left to right. */
static void ramp(const char *path, double from, double to)
{
    const tz_image_write_options opt = {.type = TZ_SAMPLE_U8, .compression = -1};
    tz_ctx *ctx = NULL;
    tz_image im;
    assert_int_equal(tz_ctx_new(NULL, &ctx), TZ_OK);
    assert_int_equal(tz_image_init(ctx, &im, 64, 64, 1), TZ_OK);
    im.encoding = TZ_ENCODING_SRGB;
    for (int32_t y = 0; y < 64; y++)
        for (int32_t x = 0; x < 64; x++)
            tz_image_at(&im, x, y)[0] = (float)(from + (to - from) * x / 63);
    assert_int_equal(tz_image_write(ctx, path, &im, &opt), TZ_OK);
    tz_image_deinit(&im);
    tz_ctx_free(ctx);
}

static int setup(void **state)
{
    if (enter_scratch(state) != 0)
        return -1;
    text("strokes.svg",
         HEAD "<path d='M30 290V10' tz:class='size=0.7 density=1'/>"
              "<path d='M270 290V10' tz:class='size=1.6 density=0.5'/></svg>");
    text("plain.svg", HEAD "<path d='M30 290V10'/><path d='M270 290V10'/></svg>");
    text("sizes.svg", HEAD "<path d='M30 290V10' tz:class='size=2 direction=no'/></svg>");
    text("dense.svg", HEAD "<g><path id='p7' d='M30 290V10' tz:class='density=1.5'/></g>"
                           "</svg>");
    text("away.svg", HEAD "<path d='M500 500h90'/></svg>");
    ramp("small-large.png", 0.3, 0.9);
    ramp("sparse.png", 1, 0.1);
    ramp("turns.png", 0, 0.25);
    return sh("cp '%s/data/exemplars/'*.svg .", TZ_SOURCE_DIR);
}

/* How a medium is arranged; the layout goes to l.svg. */
static const struct {
    const char *name, *command;
} medium[] = {
    {"edges", "$T arrange mud.png -o %s --size 300x300 -q"},
    {"elements", "$T arrange current.svg -o %s --size 300x300 -q"},
    {"curves", "$T arrange grain.svg --as curves -o %s --size 300x300 -q"},
    {"fill", "$T fill garden.svg -o %s --size 300x300 --iterations 12 -q"},
};
enum { MEDIA = 4 };

/* @return exit code of the medium's command with more options */
static int arrange(int k, const char *out, const char *more)
{
    char line[1024];
    snprintf(line, sizeof line, medium[k].command, out);
    return sh("%s %s", line, more);
}

static void strokes_steer_all_media(void **state)
{
    (void)state;
    for (int k = 0; k < MEDIA; k++) {
        if (arrange(k, "none.svg", "") != 0 ||
            arrange(k, "plain.svg.svg", "--field plain.svg") != 0 ||
            arrange(k, "l.svg", "--field strokes.svg -j1") != 0 ||
            arrange(k, "l8.svg", "--field strokes.svg -j8") != 0)
            fail_msg("%s: %s", medium[k].name, err_text);
        assert_exit(0, "cmp l.svg l8.svg");
        assert_int_not_equal(sh("cmp -s l.svg none.svg"), 0);
        assert_int_not_equal(sh("cmp -s plain.svg.svg none.svg"), 0);
        /* curves have directions alone */
        if (k != 2)
            assert_int_not_equal(sh("cmp -s l.svg plain.svg.svg"), 0);
        assert_exit(0, "$T replay l.svg -o again.svg -q && cmp l.svg again.svg");
    }
}

static void images_steer_all_media(void **state)
{
    (void)state;
    static const char *const how[] = {"--directions turns.png",
                                      "--sizes small-large.png --directions turns.png",
                                      "--densities sparse.png --directions turns.png",
                                      "--field strokes.svg --sizes small-large.png"};
    for (int k = 0; k < MEDIA; k++)
        for (int i = 0; i < 4; i++) {
            if (arrange(k, "l.svg", how[i]) != 0)
                fail_msg("%s %s: %s", medium[k].name, how[i], err_text);
            if (i == 0)
                assert_exit(0, "cp l.svg turned.svg");
            else if (k != 2)
                assert_int_not_equal(sh("cmp -s l.svg turned.svg"), 0);
            assert_exit(0, "$T replay l.svg -o again.svg -q && cmp l.svg again.svg");
        }
}

/* Sum and count of a member over the elements of a table, left and right. */
static void halves(const char *path, double sum[2], int n[2])
{
    json_t *v = json_load_file(path, 0, NULL), *e;
    size_t i;
    assert_non_null(v);
    sum[0] = sum[1] = n[0] = n[1] = 0;
    json_array_foreach(json_object_get(v, "elements"), i, e)
    {
        const int side = json_number_value(json_object_get(e, "x")) > 150;
        sum[side] += json_number_value(json_object_get(e, "scale"));
        n[side]++;
    }
    json_decref(v);
}

static void elements_grow_and_thin_out(void **state)
{
    (void)state;
    static const char *const method[] = {"growth", "patches", "noise"};
    for (int k = 0; k < 3; k++) {
        double sum[2];
        int n[2];
        assert_exit(0,
                    "$T arrange current.svg -o l.json --size 300x300 -q --method %s "
                    "--sizes small-large.png --field 20",
                    method[k]);
        halves("l.json", sum, n);
        assert_true(n[0] > 1.5 * n[1] && sum[1] / n[1] > 1.4 * sum[0] / n[0]);
        assert_exit(0,
                    "$T arrange current.svg -o l.json --size 300x300 -q --method %s "
                    "--densities sparse.png",
                    method[k]);
        halves("l.json", sum, n);
        assert_true(n[0] > 1.5 * n[1]);
        assert_true(fabs(sum[1] / n[1] - sum[0] / n[0]) < 0.2 * sum[0] / n[0]);
    }
}

static void curves_say_what_they_leave_out(void **state)
{
    (void)state;
    assert_exit(0, "$T arrange grain.svg --as curves -o l.svg --size 300x300 --field "
                   "strokes.svg");
    assert_said("warning: curves follow the directions of the field alone");
    assert_exit(0, "$T arrange grain.svg --as curves -o l.svg --size 300x300 --field "
                   "plain.svg");
    assert_null(strstr(err_text, "warning: curves"));
    assert_exit(1, "$T arrange grain.svg --as curves -o no.svg --size 300x300 --field "
                   "sizes.svg");
    assert_one_line();
    assert_said("curves follow directions alone");
    assert_false(exists("no.svg"));
}

static void bad_fields_are_told_in_one_line(void **state)
{
    (void)state;
    for (int k = 0; k < MEDIA; k++) {
        static const struct {
            const char *how, *said;
        } bad[] = {{"--field dense.svg", "path \"p7\" says \"density=1.5\""},
                   {"--field away.svg", "away.svg: there are no strokes in view"},
                   {"--field gone.svg", "gone.svg"},
                   {"--directions gone.png", "gone.png"},
                   {"--sizes strokes.svg", "strokes.svg"}};
        for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
            assert_int_equal(arrange(k, "no.svg", bad[i].how), 1);
            assert_one_line();
            assert_said(bad[i].said);
            assert_false(exists("no.svg"));
        }
        /* what is read is not written over */
        assert_int_not_equal(arrange(k, "strokes.svg", "--field strokes.svg"), 0);
        assert_one_line();
    }
    assert_int_not_equal(arrange(1, "no.svg", "--field 'x' --directions turns.png"), 0);
    assert_one_line();
}

/* expand takes the same. */
static void expand_is_steered(void **state)
{
    (void)state;
    assert_exit(0, "$T expand mud.png -o a.png --size 200x200 -q && $T expand mud.png -o "
                   "b.png --size 200x200 --field strokes.svg -q");
    assert_int_not_equal(sh("cmp -s a.png b.png"), 0);
    assert_exit(0, "$T replay b.png -o c.png -q && cmp b.png c.png");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(strokes_steer_all_media),
        cmocka_unit_test(images_steer_all_media),
        cmocka_unit_test(elements_grow_and_thin_out),
        cmocka_unit_test(curves_say_what_they_leave_out),
        cmocka_unit_test(bad_fields_are_told_in_one_line),
        cmocka_unit_test(expand_is_steered),
    };
    return cmocka_run_group_tests(tests, setup, leave_scratch);
}
