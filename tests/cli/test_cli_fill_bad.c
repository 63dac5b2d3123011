/* SPDX-License-Identifier: Apache-2.0 */
/* terrazzo fill in bad company: full disks, outputs over inputs, interrupts; and what a
 * layout of it must look like as pixels: crops, tiles, photos, again. */
#include <math.h>

#include "tests/cli/shell.h"

static int setup(void **state)
{
    return enter_scratch(state) == 0
               ? sh("cp '%s/data/exemplars/garden.svg' .", TZ_SOURCE_DIR)
               : -1;
}

/* No output "o.*", whole or in part, nor anybody's temporary file. */
static void assert_nothing_written(void)
{
    assert_exit(1, "ls -A | grep -E '^\\.?o\\.|tmp|\\.part'");
}

static void full_disks(void **state)
{
    (void)state;
    static const char *const line[] = {
        "$T fill garden.svg -o - --size 200x200 --iterations 3 -q >/dev/full",
        "$T fill garden.svg -o o.svg --size 200x200 --iterations 3 --trace /dev/full -q"};
    for (size_t i = 0; i < 2; i++) {
        assert_exit(1, "%s", line[i]);
        assert_one_line();
        assert_said("No space left");
        assert_nothing_written();
    }
    if (sh("mkdir -p small && mount -t tmpfs -o size=16k tmpfs small") != 0)
        return; /* not for everyone */
    const int svg = sh("$T fill garden.svg -o small/o.svg --size 300x300 -q");
    const int lines = error_lines();
    const int left = sh("ls -A small | grep .");
    const int frames = sh("$T fill garden.svg -o o.svg --size 300x300 --frames "
                          "small/f.svg -q");
    assert_exit(0, "umount small");
    assert_int_equal(svg, 1);
    assert_int_equal(lines, 1);
    assert_int_equal(left, 1);
    assert_int_equal(frames, 1);
    assert_nothing_written();
}

static void outputs_over_inputs(void **state)
{
    (void)state;
    assert_exit(0,
                "cp garden.svg f-002.svg && ln -s garden.svg link.svg && ln garden.svg "
                "hard.svg");
    static const char *const line[] = {
        "$T fill garden.svg -o garden.svg",
        "$T fill garden.svg -o link.svg",
        "$T fill garden.svg -o hard.svg",
        "$T fill garden.svg -o o.svg --trace garden.svg",
        "$T fill garden.svg -o o.svg --trace o.svg",
        "$T fill f-002.svg -o o.svg --size 200x200 --iterations 3 --frames f.svg",
        "$T fill garden.svg -o f-002.svg --size 200x200 --iterations 3 --frames f.svg"};
    for (size_t i = 0; i < sizeof line / sizeof *line; i++) {
        const int code = sh("%s -q", line[i]);
        if (code != 1 || error_lines() != 1)
            fail_msg("exit %d: %s: %s", code, line[i], err_text);
        assert_nothing_written();
    }
    assert_exit(0,
                "cmp garden.svg '%s/data/exemplars/garden.svg' && cmp garden.svg "
                "f-002.svg",
                TZ_SOURCE_DIR);
}

static void what_is_said_twice(void **state)
{
    (void)state;
    assert_exit(1,
                "$T fill garden.svg -o o.svg --size 200x200 --mix 'leaf, bead, leaf' -q");
    assert_one_line();
    assert_said("\"leaf\" is named twice");
    assert_exit(1, "$T fill garden.svg -o o.svg --size 200x200 --count 5000 -q");
    assert_one_line();
    assert_said("take fewer");
    assert_nothing_written();
}

/* Wherever it is stopped, what stood there before stands there still. */
static void interrupts_leave_what_was(void **state)
{
    (void)state;
    static const struct {
        const char *name, *after;
        int code;
    } stop[] = {{"INT", "0.2", 130}, {"TERM", "0.7", 130}, {"KILL", "0.4", 137}};
    for (size_t i = 0; i < 3; i++) {
        assert_exit(0, "echo before >kept.svg");
        const int code = sh("timeout --preserve-status -s %s %s $T fill garden.svg -o "
                            "kept.svg --size 8000x8000 -q",
                            stop[i].name, stop[i].after);
        if (code != stop[i].code && code != 1000)
            fail_msg("exit %d: %s", code, err_text);
        assert_exit(0, "test \"$(cat kept.svg)\" = before");
        if (i < 2)
            assert_nothing_written();
    }
}

/* Part of the picture is the picture's part, at any count of threads. */
static void crop_equals(const char *layout, const char *crop, int x, int y, int w, int h)
{
    tz_image a = {0}, b = {0};
    assert_exit(0, "$T render %s -o a.png -q && $T render %s -o b.png -q -j1 --crop %s",
                layout, layout, crop);
    assert_int_equal(tz_image_read(NULL, "a.png", NULL, &a), TZ_OK);
    assert_int_equal(tz_image_read(NULL, "b.png", NULL, &b), TZ_OK);
    assert_int_equal(b.width, w);
    assert_int_equal(b.height, h);
    assert_int_equal(a.channels, b.channels);
    for (int32_t r = 0; r < h; r++)
        assert_memory_equal(tz_image_at(&b, 0, r), tz_image_at(&a, x, y + r),
                            (size_t)w * (size_t)a.channels * sizeof(float));
    tz_image_deinit(&a);
    tz_image_deinit(&b);
}

/* Mean difference of pixels side by side: columns x - 1 (or the last) and x, or rows. */
static double step_at(const tz_image *im, int32_t k, bool rows)
{
    const int32_t n = rows ? im->width : im->height, m = rows ? im->height : im->width;
    double sum = 0;
    for (int32_t i = 0; i < n; i++) {
        const int32_t before = (k + m - 1) % m;
        const float *p = rows ? tz_image_at(im, i, before) : tz_image_at(im, before, i);
        const float *q = rows ? tz_image_at(im, i, k) : tz_image_at(im, k, i);
        for (int32_t c = 0; c < im->channels; c++)
            sum += fabs((double)p[c] - (double)q[c]);
    }
    return sum / n;
}

/* Over its borders a tile changes no more than within. */
static void assert_seamless(const char *path)
{
    tz_image im = {0};
    assert_int_equal(tz_image_read(NULL, path, NULL, &im), TZ_OK);
    for (int rows = 0; rows < 2; rows++) {
        const int32_t m = rows ? im.height : im.width;
        double most = 0;
        for (int32_t k = 1; k < m; k++)
            most = fmax(most, step_at(&im, k, rows));
        assert_true(most > 0);
        assert_true(step_at(&im, 0, rows) <= most);
    }
    tz_image_deinit(&im);
}

static void drawings_as_pixels(void **state)
{
    (void)state;
    assert_exit(0, "$T fill garden.svg -o l.svg --size 360x240 --seed 3 -q");
    crop_equals("l.svg", "111,57,150,123", 111, 57, 150, 123);
    assert_exit(0, "$T fill garden.svg -o t.svg --size 240x200 --tile --seed 3 -q");
    crop_equals("t.svg", "0,0,90,110", 0, 0, 90, 110);
    crop_equals("t.svg", "150,101,90,99", 150, 101, 90, 99);
    assert_exit(0,
                "$T render t.svg -o t.png -q && $T replay t.png -o again.png -q && cmp "
                "t.png again.png");
    assert_seamless("t.png");
    assert_exit(0, "$T replay t.svg -o again.svg -q && cmp t.svg again.svg");
}

static void photos_as_pixels(void **state)
{
    (void)state;
    assert_exit(0, "$T fill pebbles.png -o p.svg --size 360x240 --tile --seed 3 -q");
    crop_equals("p.svg", "200,101,160,139", 200, 101, 160, 139);
    assert_exit(0, "$T render p.svg -o p.png -q");
    assert_seamless("p.png");
    assert_exit(0, "$T replay p.png -o again.png -q && cmp p.png again.png");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(full_disks),         cmocka_unit_test(outputs_over_inputs),
        cmocka_unit_test(what_is_said_twice), cmocka_unit_test(interrupts_leave_what_was),
        cmocka_unit_test(drawings_as_pixels), cmocka_unit_test(photos_as_pixels),
    };
    return cmocka_run_group_tests(tests, setup, leave_scratch);
}
