/* SPDX-License-Identifier: Apache-2.0 */
/* SVG: what is written is read back; hostile and broken documents; values and paths. */
#include "tests/base/check.h"

#include "base/rng.h"
#include "base/svg.h"

#define HEAD "<svg xmlns='http://www.w3.org/2000/svg' "

static tz_status parse(tz_ctx *ctx, const char *text, tz_svg_doc **doc)
{
    return tz_svg_parse(ctx, "x.svg", text, strlen(text), doc);
}

static tz_status write_and_read(tz_ctx *ctx)
{
    char path[80];
    snprintf(path, sizeof path, "/tmp/terrazzo-svg-%ld.svg", (long)getpid());
    tz_svg_writer w;
    tz_svg_doc *doc = NULL;
    tz_affine m = {1.0 / 3, -2e-17, 1e20, 4, 0.1, -0.0}, back;
    tz_status s = tz_svg_writer_open(ctx, path, 640, 480.5, &w);
    if (s != TZ_OK)
        return s;
    tz_svg_begin(&w, "g");
    tz_svg_set(&w, "id", "a<b>&\"'\n\tz");
    tz_svg_set_affine(&w, "transform", m);
    tz_svg_setf(&w, "tz:group", "%d-%0300d", 7, 1);
    tz_svg_begin(&w, "use");
    tz_svg_set(&w, "xlink:href", "#x");
    tz_svg_end(&w);
    tz_svg_begin(&w, "metadata");
    tz_svg_put_text(&w, "{\"a\": \"<&>\"}\n\x01");
    s = tz_svg_writer_close(&w);
    if (s != TZ_OK)
        return s;
    s = tz_svg_read(ctx, path, &doc);
    remove(path);
    if (s != TZ_OK)
        return s;
    tz_svg_node root = tz_svg_root(doc), g = tz_svg_child(root), use = tz_svg_child(g);
    assert_true(tz_svg_is(root, "svg") && tz_svg_is(g, "g") && tz_svg_is(use, "use"));
    assert_string_equal(tz_svg_attr(root, "viewBox"), "0 0 640 480.5");
    assert_string_equal(tz_svg_attr(g, "id"), "a<b>&\"'\n\tz");
    assert_ptr_equal(tz_svg_by_id(doc, "a<b>&\"'\n\tz"), g);
    assert_null(tz_svg_by_id(doc, "nobody"));
    assert_int_equal(strlen(tz_svg_attr(g, "tz:group")), 302);
    assert_string_equal(tz_svg_attr(use, "xlink:href"), "#x");
    s = tz_svg_transform(ctx, tz_svg_attr(g, "transform"), &back);
    if (s == TZ_OK) {
        assert_memory_equal(&back, &m, sizeof m);
        const char *text = tz_svg_text(doc, tz_svg_next(use));
        if (*text)
            assert_string_equal(text, "{\"a\": \"<&>\"}\n?");
        else
            s = TZ_NOMEM; /* as the header has it: "" */
    }
    tz_svg_free(doc);
    return s;
}

static void round_trip(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    ok(ctx, write_and_read(ctx));
    end_ctx(ctx);
}

static void failures_leave_nothing(void **state)
{
    (void)state;
    survive(write_and_read, 1);
}

static void hand_written(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_svg_doc *doc;
    ok(ctx, parse(ctx,
                  "<?xml version='1.0'?><!DOCTYPE svg PUBLIC '-//W3C//DTD SVG 1.1//EN' "
                  "'http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd'>\n<svg>\n"
                  "<!-- c --><use href='#p'/><p id='p'>a<![CDATA[<b>]]>c</p></svg>",
                  &doc));
    tz_svg_node use = tz_svg_child(tz_svg_root(doc)), p = tz_svg_next(use);
    assert_string_equal(tz_svg_attr(use, "xlink:href"), "#p");
    assert_null(tz_svg_attr(use, "id"));
    assert_string_equal(tz_svg_text(doc, p), "a<b>c");
    assert_int_equal(tz_svg_line(use), 3);
    assert_null(tz_svg_next(p));
    assert_null(tz_svg_child(NULL));
    tz_svg_free(doc);
    end_ctx(ctx);
}

static void hostile(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_svg_doc *doc = NULL;
    fails(ctx, parse(ctx, "", &doc), TZ_FORMAT, "empty");
    fails(ctx, parse(ctx, "hello", &doc), TZ_FORMAT, "x.svg:1");
    fails(ctx, parse(ctx, "<html/>", &doc), TZ_FORMAT, "not svg");
    fails(ctx, parse(ctx, HEAD "><g></svg>", &doc), TZ_FORMAT, "x.svg:1");
    fails(ctx, parse(ctx, HEAD ">\n\n<g a='1' a='2'/></svg>", &doc), TZ_FORMAT,
          "x.svg:3");
    fails(ctx, parse(ctx, HEAD "a='&nope;'/>", &doc), TZ_FORMAT, "nope");
    fails(ctx,
          parse(ctx,
                "<!DOCTYPE svg [<!ENTITY a 'aaaaaaaaaa'><!ENTITY b '&a;&a;&a;'>]>" HEAD
                "t='&b;'/>",
                &doc),
          TZ_FORMAT, "entities");
    fails(ctx,
          parse(ctx,
                "<!DOCTYPE svg [<!ENTITY x SYSTEM 'file:///etc/passwd'>]>" HEAD
                ">&x;</svg>",
                &doc),
          TZ_FORMAT, "entities");
    /* depth */
    char *deep = malloc(10000), *p = deep;
    p += sprintf(p, HEAD ">");
    for (int i = 0; i < 300; i++)
        p += sprintf(p, "<g>");
    fails(ctx, parse(ctx, deep, &doc), TZ_LIMIT, "deeper");
    free(deep);
    /* count */
    size_t n = 5100000 * 4;
    char *many = malloc(n + 200);
    p = many + sprintf(many, HEAD ">");
    for (int i = 0; i < 5100000; i++, p += 4)
        memcpy(p, "<a/>", 4);
    strcpy(p, "</svg>");
    fails(ctx, parse(ctx, many, &doc), TZ_LIMIT, "5 million");
    free(many);
    fails(ctx, tz_svg_read(ctx, "/tmp", &doc), TZ_IO, "directory");
    tz_svg_free(NULL);
    assert_null(doc);
    end_ctx(ctx);
}

/** Long paths and what stands behind them: layouts of many curves hold such. */
static void long_attributes(void **state)
{
    (void)state;
    enum { LONG = 12000000 };
    tz_ctx *ctx = new_ctx(1);
    tz_svg_doc *doc = NULL;
    char *text = malloc(2 * LONG + 200), *p = text;
    p += sprintf(p, HEAD "><g d='");
    memset(p, '7', LONG);
    p += LONG;
    p += sprintf(p, "'/><g d='");
    memset(p, '8', LONG);
    p += LONG;
    sprintf(p, "' id='last'/></svg>");
    ok(ctx, parse(ctx, text, &doc));
    assert_int_equal(strlen(tz_svg_attr(tz_svg_by_id(doc, "last"), "d")), LONG);
    tz_svg_free(doc);
    free(text);
    end_ctx(ctx);
}

static void values(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_numbers a = {0};
    ok(ctx, tz_svg_numbers(ctx, " 1,2 -3-4.5.5 1e3, +7\n", &a));
    static const double expected[] = {1, 2, -3, -4.5, .5, 1000, 7};
    assert_int_equal(a.n, 7);
    assert_memory_equal(a.v, expected, sizeof expected);
    static const char *const bad[] = {"1,,2",  "nan", "1 inf", "1 x",
                                      "1e400", "1,",  ",1",    "0x1"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        tz_status s = tz_svg_numbers(ctx, bad[i], &a);
        fails(ctx, s, TZ_INVALID, "");
        assert_int_equal(a.n, 7);
    }
    tz_array_free(ctx, &a);
    double v = 5;
    assert_true(tz_svg_number(" 12.5px ", &v) && v == 12.5);
    assert_false(tz_svg_number("12em", &v) || tz_svg_number("", &v) ||
                 tz_svg_number(NULL, &v));
    tz_affine m;
    ok(ctx, tz_svg_transform(ctx, NULL, &m));
    assert_true(m.a == 1 && m.e == 0);
    ok(ctx, tz_svg_transform(ctx, " translate(10,20) , rotate(90) scale(2)", &m));
    tz_vec2 q = tz_affine_apply(m, (tz_vec2){1, 0});
    assert_true(fabs(q.x - 10) < 1e-12 && fabs(q.y - 22) < 1e-12);
    ok(ctx, tz_svg_transform(ctx, "rotate(180 5 5) skewX(45)skewY(0)", &m));
    q = tz_affine_apply(m, (tz_vec2){0, 1});
    assert_true(fabs(q.x - 9) < 1e-12 && fabs(q.y - 9) < 1e-12);
    static const char *const wrong[] = {"rotate(1 2)",
                                        "matrix(1 2 3)",
                                        "scale(nan)",
                                        "scale(",
                                        "spin(3)",
                                        "scale(1) x",
                                        "scale()",
                                        "scale(1e300) scale(1e300)",
                                        "matrix(1 2 3 4 5 6 7)"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        fails(ctx, tz_svg_transform(ctx, wrong[i], &m), TZ_INVALID, "transform");
    end_ctx(ctx);
}

static void numbers_round_trip(void **state)
{
    (void)state;
    tz_rng r = tz_rng_make(11, 0);
    char text[32];
    for (int i = 0; i < 100000; i++) {
        uint64_t bits = tz_rng_u64(&r);
        double v, back;
        const char *end;
        memcpy(&v, &bits, sizeof v);
        if (!isfinite(v))
            continue;
        tz_number_format(v, text);
        assert_true(tz_number_parse(text, &end, &back) && *end == 0);
        assert_memory_equal(&v, &back, sizeof v);
    }
    tz_number_format(0.1, text);
    assert_string_equal(text, "0.1");
    double v;
    const char *end;
    assert_true(tz_number_parse("1e-9999", &end, &v) && v == 0 && *end == 0);
    assert_false(tz_number_parse("-1e9999", &end, &v));
    assert_true(tz_number_parse("5e", &end, &v) && *end == 'e');
}

static void check_path(tz_ctx *ctx, const char *d, const char *verbs, const double *p)
{
    tz_svg_path path;
    ok(ctx, tz_svg_path_parse(ctx, d, &path));
    assert_int_equal(path.verb.n, strlen(verbs));
    for (int i = 0; i < path.verb.n; i++)
        assert_int_equal("MLCZ"[path.verb.v[i]], verbs[i]);
    for (int i = 0; i < path.point.n; i++) {
        assert_true(fabs(path.point.v[i].x - p[2 * i]) < 1e-9);
        assert_true(fabs(path.point.v[i].y - p[2 * i + 1]) < 1e-9);
    }
    tz_svg_path_deinit(ctx, &path);
}

static void paths(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    check_path(ctx, "M1 2L3 4H5V6Z", "MLLLZ", (double[]){1, 2, 3, 4, 5, 4, 5, 6});
    check_path(ctx, "m1,2 3,4 5,6zl1 1", "MLLZL", (double[]){1, 2, 4, 6, 9, 12, 2, 3});
    check_path(ctx, "M0 0c1 1 2 1 3 0s2-1 3 0", "MCC",
               (double[]){0, 0, 1, 1, 2, 1, 3, 0, 4, -1, 5, -1, 6, 0});
    check_path(ctx, "M0 0q3 3 6 0t6 0", "MCC",
               (double[]){0, 0, 2, 2, 4, 2, 6, 0, 8, -2, 10, -2, 12, 0});
    check_path(ctx, "M0 0S1 1 2 2", "MC", (double[]){0, 0, 0, 0, 1, 1, 2, 2});
    check_path(ctx, "M1 0A0 1 0 0 1 3 4", "ML", (double[]){1, 0, 3, 4});
    double k = 4.0 / 3 * tan(TZ_PI / 8);
    check_path(ctx, "M1 0a1 1 0 01-1 1", "MC", (double[]){1, 0, 1, k, k, 1, 0, 1});
    check_path(ctx, "", "", NULL);
    /* a whole turn in two halves ends where it was told, and the radius grows */
    tz_svg_path path;
    ok(ctx, tz_svg_path_parse(ctx, "M0 0A1 1 0 1 1 10 0", &path));
    assert_int_equal(path.verb.n, 3);
    assert_true(path.point.v[path.point.n - 1].x == 10);
    assert_true(fabs(path.point.v[3].y + 5) <
                1e-9); /* y down: sweep 1 goes over the top */
    tz_svg_path_deinit(ctx, &path);
    static const char *const bad[] = {"L1 1",
                                      "M1",
                                      "M1 2 3",
                                      "M1 1X",
                                      "M nan 0",
                                      "M1 1A1",
                                      "M0 0a1 1 0 2 0 1 1",
                                      "M1e308 0l1e308 0",
                                      "z",
                                      "M1 2,,3 4",
                                      "M1 1 L"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        fails(ctx, tz_svg_path_parse(ctx, bad[i], &path), TZ_FORMAT, "path");
    end_ctx(ctx);
}

static tz_status parse_path(tz_ctx *ctx)
{
    tz_svg_path path;
    tz_status s = tz_svg_path_parse(
        ctx, "M0 0L1 1 2 2 3 3 4 4 5 5 6 6 7 7 8 8 9 9A1 2 3 0 1 0 0", &path);
    if (s == TZ_OK)
        tz_svg_path_deinit(ctx, &path);
    return s;
}

static void path_failures_leave_nothing(void **state)
{
    (void)state;
    survive(parse_path, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(round_trip),
        cmocka_unit_test(failures_leave_nothing),
        cmocka_unit_test(hand_written),
        cmocka_unit_test(hostile),
        cmocka_unit_test(long_attributes),
        cmocka_unit_test(values),
        cmocka_unit_test(numbers_round_trip),
        cmocka_unit_test(paths),
        cmocka_unit_test(path_failures_leave_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
