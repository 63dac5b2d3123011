/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Documents of elements: there and back, and what an artist does to them between. */
#include "tests/elements/svg_reading.h"

#include "base/file.h"

/* ---- there and back --------------------------------------------------------------------- */

static void assert_same(const tz_element_set *a, const tz_element_set *b)
{
    assert_memory_equal(&a->domain.size, &b->domain.size, sizeof a->domain.size);
    assert_int_equal(a->domain.torus, b->domain.torus);
    assert_int_equal(a->element.n, b->element.n);
    assert_int_equal(a->sample.n, b->sample.n);
    assert_int_equal(a->kind.n, b->kind.n);
    assert_int_equal(a->symbol.n, b->symbol.n);
    for (int32_t i = 0; i < a->kind.n; i++) {
        assert_string_equal(a->kind.v[i].name, b->kind.v[i].name);
        assert_int_equal(a->kind.v[i].oriented, b->kind.v[i].oriented);
        assert_int_equal(a->kind.v[i].is_void, b->kind.v[i].is_void);
    }
    for (int32_t i = 0; i < a->symbol.n; i++) {
        assert_string_equal(a->symbol.v[i].id, b->symbol.v[i].id);
        assert_string_equal(a->symbol.v[i].markup, b->symbol.v[i].markup);
        assert_true(a->symbol.v[i].radius == b->symbol.v[i].radius);
        assert_int_equal(a->symbol.v[i].part.n, b->symbol.v[i].part.n);
    }
    for (int32_t i = 0; i < a->element.n; i++) {
        const tz_element *p = &a->element.v[i], *q = &b->element.v[i];
        assert_memory_equal(&p->at, &q->at, sizeof p->at);
        assert_memory_equal(&p->angle, &q->angle, 3 * sizeof(double));
        assert_true(p->kind == q->kind && p->symbol == q->symbol &&
                    p->source == q->source && p->samples == q->samples &&
                    p->depth == q->depth && p->cut == q->cut && p->fixed == q->fixed);
        for (int32_t k = 0; k < p->samples; k++) {
            const tz_sample *u = &a->sample.v[p->sample + k],
                            *v = &b->sample.v[q->sample + k];
            assert_memory_equal(&u->at, &v->at, sizeof u->at);
            assert_true(u->id == v->id && u->weight == v->weight);
        }
    }
    assert_int_equal(!a->background, !b->background);
    if (a->background)
        assert_string_equal(a->background, b->background);
}

static void bit_for_bit(void **state)
{
    (void)state;
    char dir[64], path[96];
    tz_element_set back;
    begin_dir(dir);
    snprintf(path, sizeof path, "%s/a.svg", dir);
    read_as(HEAD
            "<rect width='100' height='100' fill='#fed'/>"
            "<symbol id='leaf &lt;1&gt;'><path d='M0 0L10 0L10 4L0 4Z'/></symbol>"
            "<use xlink:href='#leaf &lt;1&gt;' transform='rotate(17 3 4) scale(.7)'/>"
            "<path d='M60 60q5 9 20 0z' stroke='red' stroke-linejoin='round'/>"
            "<circle cx='99' cy='98.7' r='3.3'/>" TAIL,
            &(tz_element_read_options){.wrap = true}, 3);
    /* what no drawing has, but a set may */
    tz_element *e = set.element.v;
    e[0].depth = 7;
    e[0].source = 3;
    e[1].fixed = true;
    e[1].at.z = -0.0;
    e[2].at.z = 0.1;
    e[2].angle = 1e-300;
    set.kind.v[e[1].kind].is_void = true;
    tz_free(ctx, set.symbol.v[e[2].symbol].markup);
    ok(ctx, tz_strdup(ctx, "", &set.symbol.v[e[2].symbol].markup));
    ok(ctx, tz_element_write(ctx, path, &set));
    ok(ctx, tz_element_read_svg(ctx, path, NULL, &back));
    assert_same(&set, &back);
    tz_element_set_deinit(&back);
    tz_free(ctx, set.symbol.v[1].id); /* two of a name */
    ok(ctx, tz_strdup(ctx, set.symbol.v[0].id, &set.symbol.v[1].id));
    fails(ctx, tz_element_write(ctx, path, &set), TZ_INVALID, "two symbols");
    fails(ctx, tz_element_write(ctx, "x.txt", &set), TZ_INVALID, ".csv");
    end_dir(dir);
}

/** A document of ours with some text in it replaced. */
static void reread(const char *path, const char *from, const char *to, tz_element_set *s,
                   const char *fault)
{
    char *text, *changed;
    size_t size;
    ok(ctx, tz_file_read(ctx, path, 1 << 20, &text, &size));
    char *p = strstr(text, from);
    assert_non_null(p);
    ok(ctx, tz_alloc(ctx, &changed, size + strlen(to) + 1, 1));
    sprintf(changed, "%.*s%s%s", (int)(p - text), text, to, p + strlen(from));
    tz_status st =
        tz_element_parse_svg(ctx, "own.svg", changed, strlen(changed), NULL, s);
    if (fault)
        fails(ctx, st, TZ_FORMAT, fault);
    else
        ok(ctx, st);
    tz_free(ctx, text);
    tz_free(ctx, changed);
}

static void an_artist_moves_things(void **state)
{
    (void)state;
    char dir[64], path[96];
    tz_element_set b;
    begin_dir(dir);
    snprintf(path, sizeof path, "%s/a.svg", dir);
    READ("<symbol id='bar'><rect width='20' height='2'/></symbol>"
         "<use xlink:href='#bar' x='20' y='20'/>",
         1);
    ok(ctx, tz_element_write_svg(ctx, path, &set));
    const tz_element *e = set.element.v;
    reread(path, "transform=\"matrix(1 0 0 1 30 21)\"",
           "transform=\"translate(50 60) rotate(90) scale(2)\"", &b, NULL);
    const tz_element *m = b.element.v;
    near(m->at.x, 50, 1e-9);
    near(m->angle, TZ_PI / 2, 1e-9);
    near(m->radius, 2 * e->radius, 1e-9);
    assert_true(m->fixed && m->samples == e->samples && m->samples > 2);
    for (int i = 0; i < m->samples; i++) {
        near(b.sample.v[i].at.y - 60, 2 * (set.sample.v[i].at.x - 30), 1e-9);
        near(b.sample.v[i].at.x - 50, -2 * (set.sample.v[i].at.y - 21), 1e-9);
    }
    tz_element_set_deinit(&b);
    /* one more, in a layer */
    reread(path, "</svg>",
           "<g transform='translate(1 2)'><use xlink:href='#bar' x='5'/></g></svg>", &b,
           NULL);
    assert_int_equal(b.element.n, 2);
    assert_true(b.element.v[1].at.x == 6 && b.element.v[1].at.y == 2 &&
                b.element.v[1].fixed);
    assert_false(b.element.v[0].fixed);
    tz_element_set_deinit(&b);
    reread(path, "tz:place=\"0", "tz:place=\"5", &b, "own.svg:");
    reread(path, "tz:place=\"0 0", "tz:place=\"0", &b, "ten numbers");
    reread(path, "tz:samples=\"", "tz:samples=\"1 ", &b, "five numbers");
    reread(path, "href=\"#bar", "href=\"#rab", &b, "does not exist");
    reread(path, "tz:size=\"100", "tz:size=\"-1", &b, "tz:size");
    reread(path, "matrix(1 0 0 1 30 21)", "matrix(1 0 0 1 30)", &b, "transform");
    reread(path, "matrix(1 0 0 1 30 21)", "scale(0)", &b, "squeezed");
    reread(path, "tz:document=\"elements\"", "tz:document=\"layout\"", &b, "no elements");
    end_dir(dir);
}

static void tables(void **state)
{
    (void)state;
    char dir[64], path[96], *text;
    size_t size;
    begin_dir(dir);
    READ("<circle cx='20' cy='30' r='5' tz:class='a, \"b\"'/>"
         "<circle cx='40' cy='30' r='5' tz:class='gap'/>",
         2);
    set.kind.v[1].is_void = true;
    snprintf(path, sizeof path, "%s/a.json", dir);
    ok(ctx, tz_element_write(ctx, path, &set));
    ok(ctx, tz_file_read(ctx, path, 1 << 20, &text, &size));
    assert_string_equal(
        text, "{\"domain\":[0,0,100,100],\"elements\":[\n{\"x\":20,\"y\":30,\"z\":0,"
              "\"type\":\"a, \\\"b\\\"\",\"angle\":0,\"scale\":1,\"radius\":5,"
              "\"source\":-1}\n]}\n");
    tz_free(ctx, text);
    snprintf(path, sizeof path, "%s/a.csv", dir);
    ok(ctx, tz_element_write(ctx, path, &set));
    ok(ctx, tz_file_read(ctx, path, 1 << 20, &text, &size));
    assert_string_equal(text, "x,y,z,type,angle,scale,radius,source\n"
                              "20,30,0,\"a, \"\"b\"\"\",0,1,5,-1\n");
    tz_free(ctx, text);
    end_dir(dir);
}

static tz_status there_and_back(tz_ctx *c)
{
    static const char text[] =
        HEAD "<style>.c{fill:red}</style><rect width='100' height='100' fill='#fed'/>"
             "<symbol id='s'><rect width='20' height='2'/></symbol>"
             "<use xlink:href='#s' x='40' y='30'/><g><circle cx='20' cy='20' r='3'/>"
             "<circle cx='21' cy='20' r='3' class='c'/></g>"
             "<path d='M50 50h5v5zM70 70h5v5zM71 71h1v1z'/>"
             "<path d='M0 40L0 60L10 50Z'/><path d='M100 40L100 60L90 50Z'/>"
             "<circle cx='50' cy='0' r='5'/><circle cx='50' cy='100' r='5'/>" TAIL;
    char dir[64], path[96];
    tz_element_set a, b = {0};
    begin_dir(dir);
    snprintf(path, sizeof path, "%s/a.svg", dir);
    tz_status s = tz_element_parse_svg(c, "t.svg", text, strlen(text),
                                       &(tz_element_read_options){.wrap_auto = true}, &a);
    if (s == TZ_OK) {
        a.element.v[0].depth = 9;
        s = tz_element_write_svg(c, path, &a);
    }
    if (s == TZ_OK)
        s = tz_element_read_svg(c, path, NULL, &b);
    tz_element_set_deinit(&a);
    tz_element_set_deinit(&b);
    end_dir(dir);
    return s;
}

static void survives_want_of_memory(void **state)
{
    (void)state;
    survive(there_and_back, 1);
}

/* ---- drawings of others -------------------------------------------------------------------- */

static void exemplars(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        int32_t elements, symbols; /* 0: not counted */
        bool torus;
    } file[] = {
        {"contours_topography", 0, 0, true},
        {"diamonds_regular", 16, 0, true},
        {"gears_floating_cogs", 0, 0, false},
        {"icons_multipart", 297, 0, true},
        {"lattice_stained_glass", 216, 4, true},
        {"leaves_oriented", 102, 0, false},
        {"memphis_mixed", 178, 18, true},
        {"network_circuit_board", 0, 0, true},
        {"network_streets_chicago", 452, 0, false},
        {"sprinkles", 168, 0, true},
        {"terrazzo", 657, 0, true},
        {"trees_longleaf", 584, 1, false},
        {"wood_grain", 68, 0, false},
    };
    const tz_element_read_options find = {.wrap_auto = true};
    char dir[64], path[256], out[96];
    if (access("../shared/exemplars/svg", R_OK) != 0)
        skip();
    begin_dir(dir);
    snprintf(out, sizeof out, "%s/a.svg", dir);
    for (size_t i = 0; i < sizeof file / sizeof *file; i++) {
        tz_element_set back;
        snprintf(path, sizeof path, "../shared/exemplars/svg/%s.svg", file[i].name);
        tz_element_set_deinit(&set);
        ok(ctx, tz_element_read_svg(ctx, path, &find, &set));
        if ((file[i].elements && set.element.n != file[i].elements) ||
            (file[i].symbols && set.symbol.n != file[i].symbols) ||
            set.domain.torus != file[i].torus || set.kind.n > 12)
            fail_msg("%s: %d elements, %d symbols, %d classes, torus %d", file[i].name,
                     set.element.n, set.symbol.n, set.kind.n, set.domain.torus);
        ok(ctx, tz_element_write_svg(ctx, out, &set));
        ok(ctx, tz_element_read_svg(ctx, out, NULL, &back));
        assert_same(&set, &back);
        tz_element_set_deinit(&back);
    }
    end_dir(dir);
}
int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, begin, end)
    const struct CMUnitTest tests[] = {
        TEST(bit_for_bit),
        TEST(an_artist_moves_things),
        TEST(tables),
        TEST(exemplars),
        cmocka_unit_test(survives_want_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
