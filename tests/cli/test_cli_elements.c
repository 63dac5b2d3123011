/* SPDX-License-Identifier: Apache-2.0 */
/* The command on elements: drawings and photos in, layouts and pixels out. */
#include <math.h>

#include "tests/cli/shell.h"

#include <jansson.h>

static json_t *load(const char *path)
{
    json_t *v = json_load_file(path, 0, NULL);
    if (!v)
        fail_msg("%s is no JSON", path);
    return v;
}

static double number(const json_t *o, const char *name)
{
    const json_t *v = json_object_get(o, name);
    if (!json_is_number(v))
        fail_msg("no number %s", name);
    return json_number_value(v);
}

/* A figure of `compare --json`, which stands in out_text. */
static double figure(const char *name)
{
    json_t *v = json_loads(out_text, 0, NULL);
    assert_non_null(v);
    const double x = number(v, name);
    json_decref(v);
    return x;
}

static int setup(void **state)
{
    if (enter_scratch(state) != 0)
        return -1;
    return sh("cp '%s/data/exemplars/'*.svg .", TZ_SOURCE_DIR);
}

static void text(const char *path, const char *content)
{
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    fputs(content, f);
    fclose(f);
}

/* ---- layouts -------------------------------------------------------------------------- */

static void tables_hold_what_the_svg_shows(void **state)
{
    (void)state;
    const char *const out[] = {"l.svg", "l.json", "l.csv"};
    for (int i = 0; i < 3; i++)
        assert_exit(0, "$T arrange hearts.svg -o %s --size 700x500 --seed 3 -q", out[i]);
    json_t *v = load("l.json");
    const json_t *box = json_object_get(v, "domain"),
                 *list = json_object_get(v, "elements");
    assert_int_equal(json_array_size(box), 4);
    assert_true(json_number_value(json_array_get(box, 2)) == 700);
    assert_true(json_number_value(json_array_get(box, 3)) == 500);
    const size_t n = json_array_size(list);
    assert_true(n > 250 && n < 350); /* as dense as the exemplar: 292 in that area */
    for (size_t i = 0; i < n; i++) {
        const json_t *e = json_array_get(list, i);
        assert_true(number(e, "x") >= 0 && number(e, "x") < 700);
        assert_true(number(e, "y") >= 0 && number(e, "y") < 500);
        assert_true(number(e, "radius") > 0 && number(e, "scale") > 0);
        assert_true(number(e, "source") >= 0 && number(e, "source") < 192);
        assert_true(fabs(number(e, "angle")) < 100);
        assert_true(json_is_string(json_object_get(e, "type")));
    }
    assert_exit(0, "test $(tail -n +2 l.csv | wc -l) = %d", (int)n);
    assert_exit(0, "test $(grep -c '^<use.*tz:place' l.svg) = %d", (int)n);
    json_decref(v);
    assert_exit(0, "rsvg-convert l.svg -o l.png || ! command -v rsvg-convert");
}

static void same_bytes_at_any_threads(void **state)
{
    (void)state;
    assert_exit(0, "$T arrange chips.svg -o a.svg --seed 5 -q -j1 && "
                   "$T arrange chips.svg -o b.svg --seed 5 -q -j2 && "
                   "$T arrange chips.svg -o c.svg --seed 5 -q -j8");
    assert_exit(0, "cmp a.svg b.svg && cmp b.svg c.svg");
    assert_exit(0, "$T arrange chips.svg -o d.svg --seed 6 -q");
    assert_int_not_equal(sh("cmp -s a.svg d.svg"), 0);
}

static void layouts_are_like_their_exemplars(void **state)
{
    (void)state;
    const char *const name[] = {"chips", "current", "hearts", "noodles"};
    for (int i = 0; i < 4; i++) {
        assert_exit(0, "$T arrange %s.svg -o l.svg --grow 3 -q", name[i]);
        assert_exit(0, "$T compare %s.svg l.svg --json", name[i]);
        const double mean = figure("mean"), density = figure("density");
        if (!(mean < 1.3) || !(fabs(density - 1) < 0.1))
            fail_msg("%s: mean %g, density %g", name[i], mean, density);
    }
    /* what is unlike is told apart */
    assert_exit(0, "$T arrange hearts.svg -o l.svg --grow 3 -q --method noise "
                   "--iterations 0");
    assert_exit(0, "$T compare hearts.svg l.svg --json");
    assert_true(figure("mean") > 2);
    assert_exit(1, "$T compare hearts.svg mud.png");
    assert_one_line();
}

static void a_domain_is_filled_and_no_more(void **state)
{
    (void)state;
    text("ring.svg",
         "<svg viewBox='0 0 100 100'><path fill-rule='evenodd' "
         "d='M50 10A40 40 0 1 1 49.9 10ZM50 30A20 20 0 1 1 49.9 30Z'/></svg>");
    assert_exit(0,
                "$T arrange hearts.svg -o l.json --size 1000x1000 --domain ring.svg -q");
    json_t *v = load("l.json");
    const json_t *list = json_object_get(v, "elements");
    const size_t n = json_array_size(list);
    for (size_t i = 0; i < n; i++) {
        const json_t *e = json_array_get(list, i);
        const double r = hypot(number(e, "x") - 500, number(e, "y") - 500);
        if (r > 405 || r < 195)
            fail_msg("an element at %g of 200 .. 400", r);
    }
    /* 192 in 480 x 480; the ring holds 0.377 of the square */
    assert_true(n > 0.8 * 0.377 * 833 && n < 1.15 * 0.377 * 833);
    json_decref(v);
}

static void a_field_turns_elements(void **state)
{
    (void)state;
    double sum[2] = {0, 0};
    for (int k = 0; k < 2; k++) {
        assert_exit(0, "$T arrange current.svg -o l.json --size 900x900 -q --field '%d'",
                    k * 90);
        json_t *v = load("l.json");
        const json_t *list = json_object_get(v, "elements");
        for (size_t i = 0; i < json_array_size(list); i++)
            sum[k] += cos(2 * number(json_array_get(list, i), "angle"));
        sum[k] /= (double)json_array_size(list);
        json_decref(v);
    }
    /* mostly level leaves, then mostly upright ones */
    assert_true(sum[0] > 0.2);
    assert_true(sum[1] < -0.2);
}

static float halves(int32_t x, int32_t y, int32_t c)
{
    (void)y;
    return x < 32 ? c == 0 : c == 2;
}

static void zones_allow_classes(void **state)
{
    (void)state;
    picture("zones.png", (tz_rect){0, 0, 64, 64}, 3, TZ_ENCODING_SRGB, halves,
            TZ_SAMPLE_U8);
    assert_exit(0, "$T arrange hearts.svg -o l.json --size 600x600 -q --zones zones.png "
                   "--zone-kinds '#ff0000=heart;#0000ff=dot'");
    json_t *v = load("l.json");
    const json_t *list = json_object_get(v, "elements");
    int n[2] = {0, 0};
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *e = json_array_get(list, i);
        const bool right = number(e, "x") >= 300;
        assert_string_equal(json_string_value(json_object_get(e, "type")),
                            right ? "dot" : "heart");
        n[right]++;
    }
    assert_true(n[0] > 20 && n[1] > 20);
    json_decref(v);
    assert_exit(1, "$T arrange hearts.svg -o l.json --zones zones.png --zone-kinds "
                   "'#ff0000=leaf'");
    assert_one_line();
    assert_said("leaf");
}

static void layouts_replay(void **state)
{
    (void)state;
    assert_exit(0,
                "$T arrange current.svg -o l.svg --size 800x600 --seed 9 --rings 1 -q");
    assert_exit(0, "$T replay l.svg -o m.svg && cmp l.svg m.svg");
    /* what was not given is found as it was then: size, copies around the border */
    assert_exit(0, "$T arrange current.svg -o l.svg --grow 1.3 -q && "
                   "$T replay l.svg -o m.svg -q && cmp l.svg m.svg");
    assert_exit(0, "$T arrange current.svg -o n.svg --keep l.svg -q && "
                   "$T replay n.svg -o m.svg -q && cmp n.svg m.svg");
    /* each of some variants its own seed */
    assert_exit(0, "$T expand current.svg -o v_{seed}.png --grow 1.2 --seeds 3,8 -q "
                   "--save-layout v_{seed}.svg");
    assert_exit(0, "$T replay v_8.png -o w.png -q && cmp v_8.png w.png");
    assert_exit(0, "$T replay v_3.svg -o w.svg -q && cmp v_3.svg w.svg");
    assert_exit(1, "cmp -s v_3.png v_8.png");
}

/* ---- pixels --------------------------------------------------------------------------- */

static void drawings_become_pixels(void **state)
{
    (void)state;
    tz_image a = {0}, b = {0};
    assert_exit(0, "$T expand current.svg -o a.png --size 600x400 --seed 4 -q "
                   "--save-layout l.svg");
    assert_exit(0, "$T render l.svg -o b.png -q && cmp a.png b.png || "
                   "$T compare a.png b.png >/dev/null");
    assert_exit(0, "$T render l.svg -o c.png --crop 200,100,150,90 -q");
    assert_int_equal(tz_image_read(NULL, "b.png", NULL, &a), TZ_OK);
    assert_int_equal(tz_image_read(NULL, "c.png", NULL, &b), TZ_OK);
    assert_int_equal(a.width, 600);
    assert_int_equal(a.height, 400);
    for (int32_t y = 0; y < 90; y++)
        assert_memory_equal(tz_image_at(&b, 0, y), tz_image_at(&a, 200, 100 + y),
                            150 * (size_t)a.channels * sizeof(float));
    tz_image_deinit(&a);
    tz_image_deinit(&b);
    assert_exit(0,
                "$T render l.svg -o d.png -q -j1 && $T render l.svg -o e.png -q -j8 && "
                "cmp d.png e.png");
    assert_exit(0, "$T replay d.png -o f.png && cmp d.png f.png");
}

static void maps_tell_what_lies_where(void **state)
{
    (void)state;
    tz_image id = {0}, uv = {0};
    assert_exit(0,
                "$T arrange hearts.svg -o l.svg --size 400x300 -q && $T render l.svg -o "
                "a.png --maps id=ids.exr,uv=uv.exr,class=c.exr,angle=g.exr -q");
    const tz_image_read_options opt = {.data = true};
    assert_int_equal(tz_image_read(NULL, "ids.exr", &opt, &id), TZ_OK);
    assert_int_equal(tz_image_read(NULL, "uv.exr", &opt, &uv), TZ_OK);
    assert_int_equal(id.channels, 1);
    assert_int_equal(uv.channels, 3);
    int64_t ground = 0, covered = 0;
    for (int32_t y = 0; y < 300; y++)
        for (int32_t x = 0; x < 400; x++) {
            const float i = tz_image_at(&id, x, y)[0], *p = tz_image_at(&uv, x, y);
            assert_true(i >= 0 && i == floorf(i));
            assert_true((i > 0) == (p[2] == 1));
            assert_true(p[0] >= 0 && p[0] <= 1 && p[1] >= 0 && p[1] <= 1);
            ground += i == 0;
            covered += i > 0;
        }
    assert_true(ground > covered && covered > 5000);
    tz_image_deinit(&id);
    tz_image_deinit(&uv);
    assert_exit(1, "$T render l.svg -o a.png --maps height=mud.png");
    assert_one_line();
}

/* ---- photos --------------------------------------------------------------------------- */

static void photos_become_elements(void **state)
{
    (void)state;
    assert_exit(0, "$T analyze pebbles.png --as elements -o p.svg -q");
    assert_true(exists("p.plate.png"));
    assert_exit(0, "$T analyze pebbles.png --as elements -o p.json -q");
    json_t *v = load("p.json");
    assert_true(json_array_size(json_object_get(v, "elements")) > 20);
    json_decref(v);
    assert_exit(0, "$T arrange p.svg -o l.svg --size 500x400 --seed 2 -q");
    assert_exit(0, "$T render l.svg -o a.png -q");
    assert_exit(0, "$T render l.svg -o b.png -q -j1 --crop 111,57,200,123");
    tz_image a = {0}, b = {0};
    assert_int_equal(tz_image_read(NULL, "a.png", NULL, &a), TZ_OK);
    assert_int_equal(tz_image_read(NULL, "b.png", NULL, &b), TZ_OK);
    assert_int_equal(a.width, 500);
    assert_int_equal(a.channels, 3); /* ground everywhere: no alpha */
    for (int32_t y = 0; y < 123; y++)
        assert_memory_equal(tz_image_at(&b, 0, y), tz_image_at(&a, 111, 57 + y),
                            200 * (size_t)a.channels * sizeof(float));
    tz_image_deinit(&a);
    tz_image_deinit(&b);
    /* in one go, and its own layout again */
    assert_exit(0, "$T expand pebbles.png --as elements -o e.png --size 500x400 --seed 2 "
                   "-q --save-layout k.svg");
    assert_exit(0, "$T render k.svg -o f.png -q && cmp e.png f.png || "
                   "$T compare e.png f.png >/dev/null");
    assert_exit(0, "$T replay e.png -o g.png && cmp e.png g.png");
}

static void auto_says_why(void **state)
{
    (void)state;
    /* even grey noise is made of nothing */
    picture("noise.png", (tz_rect){0, 0, 200, 200}, 3, TZ_ENCODING_SRGB, random_shade,
            TZ_SAMPLE_U8);
    static const char *const photo[] = {"stones.png", "noise.png"};
    for (int i = 0; i < 2; i++) {
        assert_exit(0, "$T expand %s --as auto -o a%d.png --size 200x160 --json",
                    photo[i], i);
        json_t *v = json_loads(out_text, 0, NULL);
        assert_non_null(v);
        const char *as = json_string_value(json_object_get(v, "as"));
        const char *why = json_string_value(json_object_get(v, "why"));
        assert_non_null(as);
        assert_true(why && strlen(why) > 10);
        if (i == 1)
            assert_string_equal(as, "edges");
        /* and the same as when it is named */
        assert_exit(0, "$T expand %s --as %s -o b.png --size 200x160 -q", photo[i], as);
        assert_exit(0,
                    "$T compare a%d.png b.png >/dev/null && $T replay a%d.png -o c.png "
                    "&& cmp a%d.png c.png",
                    i, i, i);
        json_decref(v);
    }
}

/* ---- what is wrong --------------------------------------------------------------------- */

static void bad_input_is_named(void **state)
{
    (void)state;
    assert_exit(0, "rm -f l.svg");
    static const struct {
        const char *file, *content;
    } bad[] = {
        {"none.svg", "<svg viewBox='0 0 9 9'/>"},
        {"nan.svg", "<svg viewBox='0 0 9 9'><circle cx='NaN' cy='1' r='1'/></svg>"},
        {"zero.svg", "<svg viewBox='0 0 9 9'><circle cx='1' cy='1' r='0'/></svg>"},
        {"view.svg", "<svg viewBox='0 0 0 0'><circle cx='1' cy='1' r='1'/></svg>"},
        {"use.svg", "<svg viewBox='0 0 9 9'><use href='#gone'/></svg>"},
        {"cut.svg", "<svg viewBox='0 0 9 9'><circle cx='1'"},
        {"text.svg", "hello"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        text(bad[i].file, bad[i].content);
        assert_exit(1, "$T arrange %s -o l.svg", bad[i].file);
        assert_one_line();
        assert_said(bad[i].file);
        assert_false(exists("l.svg"));
    }
    static const char *const wrong[] = {
        "--domain stones.jpg", "--domain none.svg", "--field 'x+'",   "--field '1/0'",
        "--zones nofile.png",  "--zone-kinds a=b",  "--size 0x5",     "--rings 9",
        "--as stones",         "--as edges",        "--method magic", "-o l.bmp",
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        assert_int_not_equal(sh("$T arrange hearts.svg -o l.svg %s", wrong[i]), 0);
        assert_one_line();
        assert_false(exists("l.svg"));
    }
    assert_exit(1, "$T render mud.png -o a.png");
    assert_one_line();
    assert_exit(1, "$T arrange mud.png pebbles.png --as elements -o l.svg || exit 1");
}

static void odd_drawings_end(void **state)
{
    (void)state;
    static const struct {
        const char *file, *content;
    } odd[] = {
        {"one.svg", "<svg viewBox='0 0 90 90'><circle cx='45' cy='45' r='9'/></svg>"},
        {"two.svg", "<svg viewBox='0 0 90 90'><circle cx='40' cy='45' r='3'/>"
                    "<circle cx='60' cy='45' r='3'/></svg>"},
        {"same.svg",
         "<svg viewBox='0 0 90 90'><circle cx='45' cy='45' r='9'/>"
         "<circle cx='45' cy='45' r='9'/><circle cx='45' cy='45' r='9'/></svg>"},
        {"open.svg", "<svg viewBox='0 0 90 90'><path d='M9 9L40 40' stroke='red'/>"
                     "<path d='M60 9L40 70L50 80'/></svg>"},
        {"giant.svg", "<svg viewBox='0 0 90 90'><path d='M9 9L20 20' stroke='red' "
                      "stroke-width='1e9'/><circle cx='4' cy='5' r='2'/></svg>"},
        {"thin.svg", "<svg viewBox='0 0 90 9'><circle cx='4' cy='.5' r='.2'/></svg>"},
    };
    for (size_t i = 0; i < sizeof odd / sizeof *odd; i++) {
        text(odd[i].file, odd[i].content);
        assert_exit(0, "timeout 20 $T arrange %s -o l.svg -q", odd[i].file);
        assert_exit(0, "timeout 20 $T arrange %s -o l.svg -q --size 3x3", odd[i].file);
        assert_exit(0, "timeout 20 $T arrange %s -o l.csv -q --tile --size 400x300",
                    odd[i].file);
    }
    assert_exit(0, "$T arrange hearts.svg -o l.svg --size 1x1 -q");
}

static void nothing_is_left_of_a_write_that_fails(void **state)
{
    (void)state;
    if (!exists("/dev/full"))
        skip();
    assert_exit(1, "$T arrange hearts.svg -o - >/dev/full");
    assert_one_line();
    assert_exit(0, "mkdir -p shut && chmod a-w shut");
    if (geteuid() != 0) {
        assert_exit(1, "$T arrange hearts.svg -o shut/l.svg");
        assert_one_line();
    }
    assert_exit(1, "$T arrange hearts.svg -o hearts.svg");
    assert_one_line();
    assert_exit(1, "$T arrange hearts.svg -o nowhere/l.svg");
    assert_one_line();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tables_hold_what_the_svg_shows),
        cmocka_unit_test(same_bytes_at_any_threads),
        cmocka_unit_test(layouts_are_like_their_exemplars),
        cmocka_unit_test(a_domain_is_filled_and_no_more),
        cmocka_unit_test(a_field_turns_elements),
        cmocka_unit_test(zones_allow_classes),
        cmocka_unit_test(layouts_replay),
        cmocka_unit_test(drawings_become_pixels),
        cmocka_unit_test(maps_tell_what_lies_where),
        cmocka_unit_test(photos_become_elements),
        cmocka_unit_test(auto_says_why),
        cmocka_unit_test(bad_input_is_named),
        cmocka_unit_test(odd_drawings_end),
        cmocka_unit_test(nothing_is_left_of_a_write_that_fails),
    };
    return cmocka_run_group_tests(tests, setup, leave_scratch);
}
