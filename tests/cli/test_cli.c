/* SPDX-License-Identifier: Apache-2.0 */
/* The command end to end: what it makes, its conventions, recipes. */
#include "tests/cli/shell.h"

#include <jansson.h>

/* ---- what it makes --------------------------------------------------------------------
 */

static void expand_grows_four_times(void **state)
{
    (void)state;
    assert_exit(0, "$T expand stones.png -o four.png --json");
    json_t *v = json_loads(out_text, 0, NULL);
    assert_non_null(v);
    json_t *o = json_array_get(json_object_get(v, "outputs"), 0);
    assert_int_equal(json_integer_value(json_object_get(o, "width")), 1024);
    assert_int_equal(json_integer_value(json_object_get(o, "height")), 1024);
    assert_true(json_integer_value(json_object_get(v, "placements")) > 10);
    assert_true(json_integer_value(json_object_get(v, "memory_peak")) > 0);
    json_t *seconds = json_object_get(v, "seconds");
    static const char *const stages[] = {"read", "analyze", "arrange", "render", "write"};
    for (size_t i = 0; i < 5; i++)
        assert_true(json_is_real(json_object_get(seconds, stages[i])));
    json_decref(v);
    assert_string_equal(err_text, "");
}

static void same_bytes_at_any_threads_and_memory(void **state)
{
    (void)state;
    static const char *const ext[] = {"png", "exr", "jpg", "tif"};
    for (size_t i = 0; i < 4; i++) {
        assert_exit(0, "$T expand mud.png -o a.%s --size 500x300 --seed 3 -q", ext[i]);
        assert_exit(0,
                    "$T expand mud.png -o b.%s --size 500x300 --seed 3 -q -j1 "
                    "--memory 96M",
                    ext[i]);
        assert_exit(0, "cmp a.%s b.%s", ext[i], ext[i]);
    }
    assert_exit(0, "$T expand mud.png -o b.png --size 500x300 --seed 4 -q");
    assert_exit(1, "cmp -s a.png b.png");
}

static void steps_equal_the_whole(void **state)
{
    (void)state;
    assert_exit(0, "$T expand stones.png -o whole.tif --size 400x300 --seed 5 "
                   "--save-layout l.svg --save-exemplar e.svg --depth 16");
    assert_exit(0, "$T analyze stones.png -o stones.svg && cmp stones.svg e.svg");
    assert_exit(0, "$T arrange stones.svg -o l2.svg --size 400x300 --seed 5");
    assert_exit(0, "$T render l.svg -o r.png && $T render l2.svg -o r2.png");
    assert_exit(0, "$T expand stones.png -o w.png --size 400x300 --seed 5");
    tz_image a = {0}, b = {0}, c = {0};
    assert_int_equal(tz_image_read(NULL, "w.png", NULL, &a), TZ_OK);
    assert_int_equal(tz_image_read(NULL, "r.png", NULL, &b), TZ_OK);
    assert_int_equal(tz_image_read(NULL, "r2.png", NULL, &c), TZ_OK);
    size_t n = (size_t)a.width * (size_t)a.height * (size_t)a.channels * sizeof(float);
    assert_memory_equal(a.px, b.px, n);
    assert_memory_equal(a.px, c.px, n);
    tz_image_deinit(&b);
    tz_image_deinit(&c);
    assert_exit(0, "$T render l.svg -o c.png --crop 37,120,101,99");
    assert_int_equal(tz_image_read(NULL, "c.png", NULL, &c), TZ_OK);
    assert_int_equal(c.width, 101);
    for (int32_t y = 0; y < 99; y++)
        assert_memory_equal(tz_image_at(&c, 0, y), tz_image_at(&a, 37, 120 + y),
                            101 * (size_t)a.channels * sizeof(float));
    tz_image_deinit(&a);
    tz_image_deinit(&c);
}

static void elements_of_a_drawing(void **state)
{
    (void)state;
    FILE *f = fopen("drawing.svg", "w");
    assert_non_null(f);
    fputs("<svg viewBox='0 0 90 60'><circle cx='20' cy='30' r='5'/>"
          "<circle cx='88' cy='30' r='5'/><circle cx='-2' cy='30' r='5'/></svg>",
          f);
    fclose(f);
    assert_exit(
        0, "$T analyze drawing.svg --as elements -o e.csv -q && grep -c class e.csv");
    assert_string_equal(out_text, "2\n"); /* a tile: two of the three are one */
    assert_exit(0, "$T analyze drawing.svg --as elements --no-wrap -o e.csv -q && "
                   "grep -c class e.csv");
    assert_string_equal(out_text, "3\n");
    assert_exit(0, "$T analyze drawing.svg --as elements --wrap --classes 1 -o e.json");
    json_t *v = json_load_file("e.json", 0, NULL);
    assert_non_null(v);
    assert_int_equal(json_array_size(json_object_get(v, "elements")), 2);
    json_decref(v);
    assert_exit(0, "$T analyze drawing.svg --as elements -o e.svg && "
                   "$T analyze e.svg --as elements -o - | cmp - e.svg");
    assert_exit(1, "$T analyze drawing.svg --as elements -o e.png");
    assert_exit(1, "$T analyze drawing.svg --as elements -o drawing.svg");
    assert_exit(1, "$T analyze drawing.svg --as stones -o e.svg");
}

static float tilt(int32_t x, int32_t y, int32_t c)
{
    return c == 2 ? 0.9f : 0.5f + 0.001f * (float)((x * 7 + y * 3 + c) % 100);
}

static void maps_follow_the_colour(void **state)
{
    (void)state;
    picture("n.exr", (tz_rect){0, 0, 256, 256}, 3, TZ_ENCODING_DATA, tilt,
            TZ_SAMPLE_FLOAT);
    picture("h.exr", (tz_rect){0, 0, 256, 256}, 1, TZ_ENCODING_DATA, tilt,
            TZ_SAMPLE_FLOAT);
    assert_exit(0, "mkdir -p m && $T expand stones.png -o m/big.exr --size 300x200 "
                   "--maps normal=n.exr,height=h.exr,albedo=bricks.png");
    tz_image im = {0};
    const tz_image_read_options data = {.data = true};
    assert_int_equal(tz_image_read(NULL, "m/big_normal.exr", &data, &im), TZ_OK);
    assert_int_equal(im.width, 300);
    for (int32_t x = 0; x < 300; x++) {
        const float *p = tz_image_at(&im, x, 77);
        float a = 2 * p[0] - 1, b = 2 * p[1] - 1, c = 2 * p[2] - 1;
        assert_true(fabsf(sqrtf(a * a + b * b + c * c) - 1) < 1e-3f);
    }
    tz_image_deinit(&im);
    assert_int_equal(tz_image_read(NULL, "m/big_height.exr", &data, &im), TZ_OK);
    assert_int_equal(im.channels, 1);
    tz_image_deinit(&im);
    assert_true(exists("m/big_albedo.exr"));
    assert_exit(0, "$T replay m/big_height.exr && cmp m/big_height.exr "
                   "m/big_height_replay.exr");
}

static void variants_have_names_of_their_own(void **state)
{
    (void)state;
    assert_exit(0, "$T expand mud.png -o '{name}_{seed}_{width}x{height}.{ext}' "
                   "--seeds 1..2,9 --size 200x100");
    assert_true(exists("mud_1_200x100.png") && exists("mud_2_200x100.png") &&
                exists("mud_9_200x100.png"));
    assert_exit(0, "$T expand mud.png -o nine.png --seed 9 --size 200x100 -q && "
                   "cmp nine.png mud_9_200x100.png");
    assert_exit(1, "$T expand mud.png -o one.png --seeds 1..2 --size 200x100");
    assert_said("one.png: would be written twice");
    assert_false(exists("one.png"));
    assert_exit(1, "$T expand mud.png -o 'x_{sed}.png' --seeds 1..2");
    assert_said("{sed}");
    assert_exit(1, "$T expand mud.png -o 'x_{seed}.png' --seeds 2..1");
    assert_exit(1, "$T expand mud.png -o 'x_{seed}.png' --seeds 1..");
    assert_said("1..8");
}

static void several_photos_mix(void **state)
{
    (void)state;
    picture("grey.png", (tz_rect){0, 0, 96, 96}, 1, TZ_ENCODING_SRGB, random_shade,
            TZ_SAMPLE_U8);
    assert_exit(0, "$T expand stones.png grey.png mud.png -o mix.png --size 300x300");
    tz_image im = {0};
    assert_int_equal(tz_image_read(NULL, "mix.png", NULL, &im), TZ_OK);
    assert_int_equal(im.channels, 3);
    tz_image_deinit(&im);
}

static void standard_output_carries_the_image(void **state)
{
    (void)state;
    assert_exit(0, "$T expand mud.png -o - --format png --size 200x100 >piped.png");
    assert_exit(0, "$T expand mud.png -o file.png --format png "
                   "--size 200x100 -q && cmp piped.png file.png");
    assert_exit(0, "$T replay file.png -o - | cmp - file.png");
    assert_exit(1, "$T expand mud.png -o - --size 200x100");
    assert_said("--format");
    assert_exit(2, "$T expand mud.png -o - --format png --json");
}

static void compare_tells_real_from_worse(void **state)
{
    (void)state;
    assert_exit(0, "$T expand stones.png -o st.png --grow 2 && "
                   "$T compare stones.png st.png --json --heat heat.png");
    json_t *v = json_loads(out_text + strcspn(out_text, "{"), 0, NULL);
    assert_non_null(v);
    double score = json_number_value(json_object_get(v, "score"));
    json_decref(v);
    assert_true(score > 0 && score <= 100);
    assert_true(exists("heat.png"));
    assert_exit(0, "$T compare stones.png mud.png --json");
    v = json_loads(out_text, 0, NULL);
    assert_true(json_number_value(json_object_get(v, "score")) < score);
    json_decref(v);
    assert_exit(0, "$T compare stones.png st.png");
    assert_non_null(strstr(out_text, "score"));
}

static void sheet_holds_all(void **state)
{
    (void)state;
    assert_exit(0, "$T sheet stones.png bricks.png mud.png -o sheet.png --cell 128x128");
    tz_image im = {0};
    assert_int_equal(tz_image_read(NULL, "sheet.png", NULL, &im), TZ_OK);
    assert_true(im.width > 256 && im.height > 256);
    tz_image_deinit(&im);
}

/* ---- recipes --------------------------------------------------------------------------
 */

static void replay_makes_the_same_bytes(void **state)
{
    (void)state;
    static const char *const ext[] = {"png", "exr", "jpg", "tif"};
    for (size_t i = 0; i < 4; i++) {
        assert_exit(0,
                    "$T expand bricks.png -o p.%s --size 300x200 --seed 11 --tile "
                    "--rotation -5,5 -q",
                    ext[i]);
        assert_exit(0, "$T replay p.%s -o again.%s && cmp p.%s again.%s", ext[i], ext[i],
                    ext[i], ext[i]);
    }
    assert_exit(0, "$T arrange bricks.png -o pl.svg --size 300x200 && $T replay pl.svg "
                   "-o pl2.svg && cmp pl.svg pl2.svg");
    assert_exit(0, "$T analyze bricks.png -o pe.svg --groups 40 && $T replay pe.svg "
                   "-o pe2.svg && cmp pe.svg pe2.svg");
    assert_exit(0, "$T render pl.svg -o pr.png --crop 10,10,50,50 && $T replay pr.png && "
                   "cmp pr.png pr_replay.png");
    /* photos that have moved are found by their hashes */
    assert_exit(0, "mkdir -p else && mv bricks.png else/");
    assert_exit(1, "$T replay p.png -o again.png");
    assert_said("bricks.png: input of p.png is missing");
    assert_exit(0, "$T replay p.png -o again.png --inputs else && cmp p.png again.png");
    assert_exit(0, "cp stones.png bricks.png");
    assert_exit(1, "$T replay p.png -o again.png");
    assert_said("bricks.png: has changed");
    assert_exit(0, "mv else/bricks.png .");
}

static void replay_refuses_what_has_no_recipe(void **state)
{
    (void)state;
    assert_exit(1, "$T replay stones.png");
    assert_said("carries no recipe");
    static const char *const broken[] = {
        "{",
        "{}",
        "[1]",
        "{\"terrazzo\":\"0\",\"command\":\"expand\",\"makes\":\"colour\",\"operands\":[7]"
        ","
        "\"parameters\":{},\"inputs\":[]}",
        "{\"terrazzo\":\"0\",\"command\":\"replay\",\"makes\":\"colour\",\"operands\":["
        "\"a\"],"
        "\"parameters\":{},\"inputs\":[]}",
        "{\"terrazzo\":\"0\",\"command\":\"expand\",\"makes\":\"colour\",\"operands\":["
        "\"a\"],"
        "\"parameters\":{\"siez\":\"1x1\"},\"inputs\":[]}",
        "{\"terrazzo\":\"0\",\"command\":\"expand\",\"makes\":\"colour\",\"operands\":["
        "\"a\"],"
        "\"parameters\":{\"size\":\"0x1\"},\"inputs\":[]}",
    };
    for (size_t i = 0; i < sizeof broken / sizeof broken[0]; i++) {
        assert_exit(1, "printf '%%s' '%s' >bad.json; $T replay bad.json -o x.png",
                    broken[i]);
        assert_non_null(strstr(err_text, "terrazzo: "));
    }
    assert_exit(1, "$T replay missing.png");
    assert_said("missing.png");
}

/* ---- conventions ----------------------------------------------------------------------
 */

static void options_stand_anywhere(void **state)
{
    (void)state;
    assert_exit(0, "$T expand mud.png -o o1.png --size 100x80 --seed 2 -q");
    assert_exit(
        0, "$T --size=100x80 expand --seed=2 -oo2.png -q mud.png && cmp o1.png o2.png");
    assert_exit(
        0, "$T -j 2 expand -q --seed 7 --seed 2 --no-tile --size 100x80 -o o3.png -- "
           "mud.png && cmp o1.png o3.png");
    assert_exit(0,
                "cp mud.png ./--odd.png && $T expand --size 100x80 --seed 2 -o o4.png -q "
                "-- --odd.png");
    assert_true(exists("o4.png"));
}

static void usage_errors_exit_2(void **state)
{
    (void)state;
    static const char *const line[][2] = {
        {"expand mud.png -o x.png --sizze 7x7", "did you mean --size?"},
        {"expand mud.png -o x.png --wibble-wobble", "unknown option --wibble-wobble"},
        {"expnad mud.png", "did you mean expand"},
        {"expand", "use: terrazzo expand"},
        {"expand mud.png", "no output"},
        {"expand mud.png -o", "--output needs a value"},
        {"expand mud.png --output --seed 7", "--output needs a value"},
        {"analyze mud.png stones.png -o x.svg", "stones.png"},
        {"compare mud.png", "use: terrazzo compare"},
        {"--wibble", "no command"},
        {"params wibble", "no command 'wibble'"},
        {"help wibble", "no command 'wibble'"},
        {"", "terrazzo help"},
    };
    for (size_t i = 0; i < sizeof line / sizeof line[0]; i++) {
        assert_exit(2, "$T %s", line[i][0]);
        assert_said(line[i][1]);
    }
    assert_false(exists("x.png"));
}

static void help_comes_from_the_tables(void **state)
{
    (void)state;
    static const char *const command[] = {
        "expand", "analyze",     "arrange", "render",    "compare", "replay",
        "sheet",  "train-edges", "params",  "propagate", "fill"};
    enum { COMMANDS = sizeof command / sizeof *command };
    assert_exit(0, "$T --version");
    assert_int_equal(strncmp(out_text, "terrazzo ", 9), 0);
    assert_exit(0, "$T --help");
    for (size_t i = 0; i < COMMANDS; i++) {
        assert_exit(0, "$T help %s", command[i]);
        assert_non_null(strstr(out_text, "Examples:"));
        assert_exit(0, "$T %s --help", command[i]);
        assert_exit(0, "$T params %s", command[i]);
        assert_non_null(strstr(out_text, "--threads"));
        assert_exit(0, "$T params %s --format json-schema >schema.json", command[i]);
        json_t *v = json_load_file("schema.json", 0, NULL);
        assert_non_null(v);
        json_decref(v);
    }
    assert_exit(0, "$T params --format json-schema >schema.json");
    json_t *v = json_load_file("schema.json", 0, NULL);
    assert_int_equal(json_array_size(v), COMMANDS);
    json_decref(v);
    assert_exit(0, "$T params --format man >t.1 && grep -q '^.SH NAME' t.1 && "
                   "grep -q 'save.-layout' t.1");
}

static void completions_know_the_options(void **state)
{
    (void)state;
    if (sh("command -v bash") != 0)
        skip();
    assert_exit(
        0, "$T params --format bash >c.bash && bash -c '. ./c.bash; "
           "COMP_WORDS=(terrazzo expand --si); COMP_CWORD=2; _terrazzo; "
           "echo ${COMPREPLY[@]}; COMP_WORDS=(terrazzo re); COMP_CWORD=1; _terrazzo; "
           "echo ${COMPREPLY[@]}; COMP_WORDS=(terrazzo expand x --format t); "
           "COMP_CWORD=4; _terrazzo; echo ${COMPREPLY[@]}'");
    assert_string_equal(out_text, "--size-range --sizes --size\nrender replay\ntiff\n");
    assert_exit(0, "$T params --format zsh >c.zsh && grep -q -e --save-layout c.zsh");
    if (sh("command -v zsh") == 0)
        assert_exit(0, "zsh -n c.zsh");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(expand_grows_four_times),
        cmocka_unit_test(same_bytes_at_any_threads_and_memory),
        cmocka_unit_test(steps_equal_the_whole),
        cmocka_unit_test(elements_of_a_drawing),
        cmocka_unit_test(maps_follow_the_colour),
        cmocka_unit_test(variants_have_names_of_their_own),
        cmocka_unit_test(several_photos_mix),
        cmocka_unit_test(standard_output_carries_the_image),
        cmocka_unit_test(compare_tells_real_from_worse),
        cmocka_unit_test(sheet_holds_all),
        cmocka_unit_test(replay_makes_the_same_bytes),
        cmocka_unit_test(replay_refuses_what_has_no_recipe),
        cmocka_unit_test(options_stand_anywhere),
        cmocka_unit_test(usage_errors_exit_2),
        cmocka_unit_test(help_comes_from_the_tables),
        cmocka_unit_test(completions_know_the_options),
    };
    return cmocka_run_group_tests(tests, enter_scratch, leave_scratch);
}
