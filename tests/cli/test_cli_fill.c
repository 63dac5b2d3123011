/* SPDX-License-Identifier: Apache-2.0 */
/* terrazzo fill: shapes, strokes, mixes, what is kept, and what is written on the way. */
#include <math.h>

#include "tests/cli/shell.h"

#include <jansson.h>

static int setup(void **state)
{
    return enter_scratch(state) == 0
               ? sh("cp '%s/data/exemplars/garden.svg' .", TZ_SOURCE_DIR)
               : -1;
}

static void text(const char *path, const char *content)
{
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    fputs(content, f);
    assert_int_equal(fclose(f), 0);
}

static void draw_inputs(void)
{
    text("ring.svg",
         "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 400 400'><path "
         "fill-rule='evenodd' d='M200 20A180 180 0 1 1 199.9 20ZM200 120A80 80 0 "
         "1 1 199.9 120Z'/></svg>");
    text("down.svg", "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 100 100' "
                     "fill='none' stroke='red' stroke-width='60'><path "
                     "d='M50 0V100'/></svg>");
}

/* A layout as a table. */
static json_t *elements(const char *path)
{
    json_t *v = json_load_file(path, 0, NULL);
    if (!v)
        fail_msg("%s is no JSON", path);
    json_t *list = json_incref(json_object_get(v, "elements"));
    json_decref(v);
    assert_non_null(list);
    return list;
}

static double number(const json_t *o, const char *name)
{
    const json_t *v = json_object_get(o, name);
    if (!json_is_number(v))
        fail_msg("no number %s", name);
    return json_number_value(v);
}

static const char *type_of(const json_t *list, size_t i)
{
    return json_string_value(json_object_get(json_array_get(list, i), "type"));
}

static void a_shape_is_filled_and_no_more(void **state)
{
    (void)state;
    draw_inputs();
    assert_exit(0, "$T fill garden.svg -o l.json --domain ring.svg --seed 3 -q");
    json_t *list = elements("l.json");
    const size_t n = json_array_size(list);
    assert_true(n > 100);
    for (size_t i = 0; i < n; i++) {
        const json_t *e = json_array_get(list, i);
        const double r = hypot(number(e, "x") - 200, number(e, "y") - 200);
        assert_true(r > 80 && r < 180); /* the layout is as large as the shape */
    }
    json_decref(list);
}

static void things_follow_strokes(void **state)
{
    (void)state;
    draw_inputs();
    assert_exit(0,
                "$T fill garden.svg -o l.json --size 500x500 --field down.svg --mix leaf "
                "--seed 3 -q");
    json_t *list = elements("l.json");
    const size_t n = json_array_size(list);
    double off = 0;
    int under = 0;
    for (size_t i = 0; i < n; i++) {
        const json_t *e = json_array_get(list, i);
        if (fabs(number(e, "x") - 250) > 120)
            continue;
        off += fabs(remainder(number(e, "angle") - acos(0), 4 * acos(0)));
        under++;
    }
    assert_true(under > 20);
    assert_true(off / under < 0.3);
    json_decref(list);
}

static void a_mix_says_what_and_how_many(void **state)
{
    (void)state;
    assert_exit(0, "$T fill garden.svg -o l.json --size 600x600 --mix 'leaf:3, bead' "
                   "--count 100 --no-repair --seed 3 -q");
    json_t *list = elements("l.json");
    const size_t n = json_array_size(list);
    size_t leaves = 0, beads = 0;
    for (size_t i = 0; i < n; i++) {
        leaves += strcmp(type_of(list, i), "leaf") == 0;
        beads += strcmp(type_of(list, i), "bead") == 0;
    }
    json_decref(list);
    assert_int_equal(leaves + beads, n);
    assert_true(leaves > 2 * beads && leaves < 4 * beads);
    static const char *const wrong[] = {"cactus",      "leaf:-1",        "leaf size=0",
                                        "leaf size=",  "leaf colour=3",  "leaf:x",
                                        "leaf turn=q", "leaf size=2..1", ","};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        assert_exit(1, "$T fill garden.svg -o no.svg --mix '%s' -q", wrong[i]);
        assert_one_line();
        assert_false(exists("no.svg"));
    }
}

static void bad_inputs_are_told_in_one_line(void **state)
{
    (void)state;
    draw_inputs();
    text("empty.svg", "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 9'/>");
    text("word.svg", "<svg xmlns='http://www.w3.org/2000/svg' "
                     "xmlns:tz='https://terrazzo.example/ns/1' viewBox='0 0 9 9'><path "
                     "stroke='red' tz:class='speed=3' d='M0 0L9 9'/></svg>");
    static const char *const line[] = {
        "$T fill empty.svg -o no.svg",
        "$T fill garden.svg -o no.svg --domain empty.svg",
        "$T fill garden.svg -o no.svg --field empty.svg",
        "$T fill garden.svg -o no.svg --field word.svg",
        "$T fill garden.svg -o no.svg --field gone.svg",
        "$T fill garden.svg -o no.svg --directions garden.svg",
        "$T fill garden.svg -o no.svg --keep ring.svg --size 100x100",
        "$T fill garden.svg -o no.svg --size 2x2",
        "$T fill garden.svg -o garden.svg",
        "$T fill garden.svg -o no.txt"};
    for (size_t i = 0; i < sizeof line / sizeof *line; i++) {
        const int code = sh("%s -q", line[i]);
        if (code != 1 && code != 2)
            fail_msg("exit %d: %s", code, line[i]);
        if (error_lines() != 1)
            fail_msg("%s: %s", line[i], err_text);
        assert_false(exists("no.svg") || exists("no.txt"));
    }
    assert_exit(0, "cmp garden.svg '%s/data/exemplars/garden.svg'", TZ_SOURCE_DIR);
}

static void same_bytes_at_any_threads_and_again(void **state)
{
    (void)state;
    draw_inputs();
    const char *const how = "--size 500x500 --field down.svg --seed 5 -q";
    for (int j = 1; j <= 8; j *= 2)
        assert_exit(0, "$T fill garden.svg -o j%d.svg %s -j%d", j, how, j);
    assert_exit(0, "cmp j1.svg j2.svg && cmp j2.svg j4.svg && cmp j4.svg j8.svg");
    assert_exit(0, "$T replay j1.svg -o again.svg -q && cmp j1.svg again.svg");
    assert_exit(
        0, "$T fill garden.svg -o other.svg --size 500x500 --field down.svg --seed 6 "
           "-q");
    assert_int_not_equal(sh("cmp -s j1.svg other.svg"), 0);
    assert_exit(0, "$T render j1.svg -o j1.png -q && test -s j1.png");
}

static void tiles_repeat(void **state)
{
    (void)state;
    assert_exit(0, "$T fill garden.svg -o t.svg --size 400x400 --tile --seed 2 -q");
    assert_exit(0, "grep -q 'tz:torus=\"1' t.svg");
    assert_exit(0, "$T fill garden.svg -o t.json --size 400x400 --tile --seed 2 -q");
    json_t *list = elements("t.json");
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *e = json_array_get(list, i);
        assert_true(number(e, "x") >= 0 && number(e, "x") < 400);
        assert_true(number(e, "y") >= 0 && number(e, "y") < 400);
    }
    json_decref(list);
}

static void what_was_placed_by_hand_stays(void **state)
{
    (void)state;
    assert_exit(0, "$T fill garden.svg -o l.svg --size 500x500 --seed 2 -q");
    /* the first thing is moved as an editor does it */
    assert_exit(
        0, "sed '0,/^<use.*tz:place/s/^\\(<use.*\\)transform=\"[^\"]*\"\\(.*tz:place\\)/"
           "\\1transform=\"translate(250 250)\"\\2/' l.svg >moved.svg");
    assert_int_not_equal(sh("cmp -s l.svg moved.svg"), 0);
    assert_exit(0, "$T fill garden.svg -o kept.json --keep moved.svg --seed 9 -q");
    json_t *list = elements("kept.json");
    int there = 0;
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *e = json_array_get(list, i);
        there += hypot(number(e, "x") - 250, number(e, "y") - 250) < 1e-6;
    }
    assert_int_equal(there, 1);
    assert_true(json_array_size(list) > 20);
    json_decref(list);
    assert_exit(1, "$T fill garden.svg -o no.svg --keep moved.svg --size 300x300 -q");
    assert_one_line();
}

/* What a brush does not touch stays to the last bit. */
static void brushes_change_what_they_touch(void **state)
{
    (void)state;
    text("brush.svg",
         "<svg xmlns='http://www.w3.org/2000/svg' "
         "xmlns:tz='https://terrazzo.example/ns/1' viewBox='0 0 600 600' fill='none' "
         "stroke-width='80'><path stroke='red' d='M100 100H300'/><path stroke='#000' "
         "tz:class='op=replace entry=berry size=1.5' d='M150 450L450 400'/></svg>");
    const char *const mix = "--mix '*, ribbon rigidity=0' --seed 2 -q";
    assert_exit(0, "$T fill garden.svg -o l.svg --size 600x600 --field down.svg %s", mix);
    assert_exit(0, "$T fill garden.svg -o l.json --size 600x600 --field down.svg %s",
                mix);
    assert_exit(0, "$T fill garden.svg -o b.svg --keep l.svg --brush brush.svg %s", mix);
    assert_exit(0, "$T fill garden.svg -o b.json --keep l.svg --brush brush.svg %s", mix);
    json_t *list = elements("l.json"), *after = elements("b.json");
    size_t held = 0, near = 0, berries = 0;
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *e = json_array_get(list, i);
        bool found = false;
        for (size_t k = 0; k < json_array_size(after) && !found; k++)
            found = json_equal(e, json_array_get(after, k));
        const double y = number(e, "y"), x = number(e, "x");
        if (y > 220 && y < 300) { /* far from both strokes */
            assert_true(found);
            held++;
        }
        near += found && fabs(y - 100) < 30 && x > 100 && x < 300;
    }
    for (size_t i = 0; i < json_array_size(after); i++) {
        const json_t *e = json_array_get(after, i);
        const double x = number(e, "x"), y = number(e, "y");
        assert_false(fabs(y - 100) < 30 && x > 100 && x < 300);
        if (x > 180 && x < 420 && fabs(y - 450 + (x - 150) / 6) < 30)
            berries += strcmp(type_of(after, i), "berry") == 0;
    }
    assert_true(held > 10 && near == 0 && berries > 5);
    json_decref(list), json_decref(after);
    assert_exit(0, "$T replay b.svg -o again.svg -q && cmp b.svg again.svg");
    assert_exit(0,
                "$T fill garden.svg -o c.svg --keep l.svg --brush brush.svg %s -j8 && "
                "cmp b.svg c.svg",
                mix);
    static const char *const word[] = {"op=cut", "entry=cactus", "size=0", "size=x",
                                       "speed=1"};
    for (size_t i = 0; i < sizeof word / sizeof *word; i++) {
        assert_exit(0, "sed 's/op=replace entry=berry size=1.5/%s/' brush.svg >w.svg",
                    word[i]);
        assert_exit(1, "$T fill garden.svg -o no.svg --keep l.svg --brush w.svg -q");
        assert_one_line();
        assert_false(exists("no.svg"));
    }
    assert_exit(0, "sed 's/stroke-width=.80.//;s/stroke=.[^ ]*//g' brush.svg >w.svg");
    assert_exit(1, "$T fill garden.svg -o no.svg --keep l.svg --brush w.svg -q");
    assert_one_line();
}

/* Vectors that point away from the middle line and grow from it, about 0. */
static void write_vectors(void)
{
    tz_ctx *ctx = NULL;
    tz_image im;
    assert_int_equal(tz_ctx_new(NULL, &ctx), TZ_OK);
    assert_int_equal(tz_image_init(ctx, &im, 40, 40, 3), TZ_OK);
    for (int32_t i = 0; i < 1600; i++) {
        float *p = tz_image_at(&im, i % 40, i / 40);
        p[0] = 0.2f * ((float)(i % 40) - 19.5f), p[1] = p[2] = 0;
    }
    assert_int_equal(tz_image_write(ctx, "v.exr", &im, NULL), TZ_OK);
    tz_image_deinit(&im);
    tz_ctx_free(ctx);
}

static void fields_are_shown(void **state)
{
    (void)state;
    write_vectors();
    const char *const how = "--size 500x500 --mix leaf --directions v.exr --lengths "
                            "0.5,1.5 --iterations 30 --seed 3 -q";
    assert_exit(0, "$T fill garden.svg -o v.json %s", how);
    json_t *list = elements("v.json");
    double away = 0, wide = 0, narrow = 0;
    int wides = 0, narrows = 0;
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *e = json_array_get(list, i);
        const double x = number(e, "x") - 250;
        if (fabs(x) > 60)
            away += fabs(
                remainder(number(e, "angle") - (x < 0 ? 2 * acos(0) : 0), 4 * acos(0)));
        if (fabs(x) > 190)
            wide += number(e, "scale"), wides++;
        else if (fabs(x) < 60)
            narrow += number(e, "scale"), narrows++;
    }
    assert_true(json_array_size(list) > 50 && away / json_array_size(list) < 0.2);
    assert_true(wides > 5 && narrows > 5 && wide / wides > 1.5 * narrow / narrows);
    json_decref(list);
    assert_exit(0, "$T fill garden.svg -o r.svg %s --ramp '#f00,#00f' --ramp-by length",
                how);
    assert_exit(
        0, "grep -q 'fill=.#f[0-9a-f]*.' r.svg && grep -q 'fill=.#[0-9a-f]*f.' r.svg");
    assert_exit(0, "$T render r.svg -o r.png -q && test -s r.png");
    assert_exit(0, "$T replay r.svg -o again.svg -q && cmp r.svg again.svg");
    /* colours do not change the places; a coloured layout is of the same palette */
    assert_exit(0, "$T fill garden.svg -o r.json %s --ramp hue && cmp r.json v.json",
                how);
    assert_exit(0, "$T fill garden.svg -o k.svg --keep r.svg --mix leaf -q");
    static const char *const wrong[] = {"--ramp viridian", "--ramp ''#12",
                                        "--ramp-by length --ramp grey", "--lengths 1,2",
                                        "--lengths 0,5000 --directions v.exr"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        const int code = sh("$T fill garden.svg -o no.svg %s -q", wrong[i]);
        assert_true(code == 1 || code == 2);
        assert_one_line();
        assert_false(exists("no.svg"));
    }
    assert_exit(1, "$T fill pebbles.png -o no.svg --size 300x300 --ramp hue -q");
    assert_one_line();
}

static void the_way_is_written(void **state)
{
    (void)state;
    assert_exit(0,
                "mkdir -p way && $T fill garden.svg -o l.svg --size 400x400 --iterations "
                "6 --trace e.csv --frames way/f.svg --seed 2 -q");
    assert_exit(0, "test $(head -1 e.csv | tr , '\\n' | wc -l) = 12 && "
                   "test $(tail -n +2 e.csv | wc -l) -ge 6");
    assert_exit(0, "test $(ls way | wc -l) = $(tail -n +2 e.csv | wc -l)");
    assert_exit(0, "$T render way/f-001.svg -o f.png -q && test -s f.png");
    /* what the layout becomes does not depend on who looks */
    assert_exit(0,
                "$T fill garden.svg -o l.json --size 400x400 --iterations 6 --seed 2 -q "
                "&& $T fill garden.svg -o m.json --size 400x400 --iterations 6 --seed 2 "
                "--trace e.csv -q && cmp l.json m.json");
    assert_exit(1, "$T fill garden.svg -o no.svg --frames gone/f.svg -q");
    assert_one_line();
    assert_false(exists("no.svg"));
}

static void photos_are_palettes(void **state)
{
    (void)state;
    assert_exit(0, "$T fill pebbles.png -o p.svg --size 600x400 --seed 2 -q");
    assert_exit(0, "$T render p.svg -o p.png -q && test -s p.png");
    assert_exit(0, "$T fill pebbles.png -o p.json --size 600x400 --seed 2 -q");
    json_t *list = elements("p.json");
    assert_true(json_array_size(list) > 5);
    json_decref(list);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_shape_is_filled_and_no_more),
        cmocka_unit_test(things_follow_strokes),
        cmocka_unit_test(a_mix_says_what_and_how_many),
        cmocka_unit_test(bad_inputs_are_told_in_one_line),
        cmocka_unit_test(same_bytes_at_any_threads_and_again),
        cmocka_unit_test(tiles_repeat),
        cmocka_unit_test(what_was_placed_by_hand_stays),
        cmocka_unit_test(brushes_change_what_they_touch),
        cmocka_unit_test(fields_are_shown),
        cmocka_unit_test(the_way_is_written),
        cmocka_unit_test(photos_are_palettes),
    };
    return cmocka_run_group_tests(tests, setup, leave_scratch);
}
