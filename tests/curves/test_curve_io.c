/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Curves out of SVG and back, and their joining. */
#include "tests/base/check.h"

#include <math.h>

#include "base/file.h"
#include "base/rng.h"
#include "curves/curve_io.h"
#include "curves/curve_join.h"
#include "tests/support/elements.h"

#define HEAD                                     \
    "<svg xmlns=\"http://www.w3.org/2000/svg\" " \
    "viewBox=\"0 0 100 100\"><g fill=\"none\" stroke=\"#204060\" stroke-width=\"1\">"
#define TAIL "</g></svg>"

static tz_ctx *ctx;
static tz_curve_set set;

static int begin(void **state)
{
    (void)state;
    ctx = new_ctx(1);
    return 0;
}

static int end(void **state)
{
    (void)state;
    tz_curve_set_deinit(&set);
    memset(&set, 0, sizeof set);
    end_ctx(ctx);
    return 0;
}

static tz_status parse(const char *text, const tz_curve_read_options *o)
{
    tz_curve_set_deinit(&set);
    return tz_curve_parse_svg(ctx, "t.svg", text, strlen(text), o, &set);
}

static void read_as(const char *text, const tz_curve_read_options *o, int32_t paths,
                    int32_t pieces, int32_t nodes)
{
    ok(ctx, parse(text, o));
    ok(ctx, tz_curve_set_check(ctx, &set, "t.svg"));
    if (set.path.n != paths || set.piece.n != pieces || set.node.n != nodes)
        fail_msg("%d paths, %d pieces, %d nodes in place of %d, %d, %d in %s", set.path.n,
                 set.piece.n, set.node.n, paths, pieces, nodes, text);
}

#define READ(body, paths, pieces, nodes) \
    read_as(HEAD body TAIL, NULL, paths, pieces, nodes)

static double total_length(const tz_curve_set *s)
{
    double sum = 0;
    for (int32_t i = 0; i < s->piece.n; i++) {
        const tz_bezier b = tz_curve_bezier(s, &s->piece.v[i]);
        sum += tz_bezier_length(&b);
    }
    return sum;
}

static void near(double a, double b, double tolerance)
{
    if (!(fabs(a - b) <= tolerance))
        fail_msg("%.17g is not %.17g", a, b);
}

/* ---- reading ----------------------------------------------------------------------- */

static void test_shapes(void **state)
{
    (void)state;
    READ("<path d='M10 10L20 10L20 30'/>", 1, 2, 3);
    READ("<path d='M10 10L20 10L20 30Z'/>", 1, 3, 3);
    assert_true(set.path.v[0].closed);
    READ("<circle cx='50' cy='50' r='20'/>", 1, 4, 4);
    assert_true(set.path.v[0].closed);
    near(total_length(&set), 40 * TZ_PI, 0.1);
    READ("<rect x='10' y='10' width='30' height='20'/>", 1, 4, 4);
    READ("<line x1='10' y1='10' x2='20' y2='30'/>", 1, 1, 2);
    READ("<path transform='translate(10 0) scale(2)' d='M0 0L5 0'/>", 1, 1, 2);
    near(set.node.v[1].x, 20, 1e-12);
    near(set.pen.v[0].width, 2, 1e-12);
    /* no length, nothing before a move, a point drawn twice */
    READ("<path d='M1 1L1 1L5 1L5 1'/><path d='M3 3z'/>", 1, 1, 2);
    /* a cubic that is a line is one */
    READ("<path d='M0 50C10 50 20 50 30 50'/>", 1, 1, 2);
    assert_true(set.piece.v[0].straight);
    READ("<path d='M0 0Q10 0 10 10'/>", 1, 1, 2);
    assert_false(set.piece.v[0].straight);
}

static void test_joining(void **state)
{
    (void)state;
    const tz_curve_read_options cross = {.crossings = true};
    /* ends that meet run on to one path, also over a small gap */
    READ("<path d='M10 10L20 10'/><path d='M40 20L20 10'/>", 1, 2, 3);
    READ("<path d='M10 10L20 10'/><path d='M20.3 10L40 20'/>", 1, 2, 3);
    READ("<path d='M10 10L20 10'/><path d='M22 10L40 20'/>", 2, 2, 4);
    /* but not of other pens */
    READ("<path d='M10 10L20 10'/><path stroke='red' d='M20 10L40 20'/>", 2, 2, 3);
    /* the same twice, also backwards and in parts */
    READ("<path d='M10 10L20 10'/><path d='M20 10L10 10'/>", 1, 1, 2);
    READ("<path d='M10 10L40 10'/><path d='M20 10L30 10'/>", 1, 3, 4);
    READ("<path d='M10 10C20 0 30 0 40 10'/><path d='M40 10C30 0 20 0 10 10'/>", 1, 1, 2);
    /* a T, met exactly and short of */
    READ("<path d='M10 10L40 10'/><path d='M20 10L20 30'/>", 2, 3, 4);
    READ("<path d='M10 10L40 10'/><path d='M20 10.4L20 30'/>", 2, 3, 4);
    READ("<path d='M10 10L40 10'/><path d='M20 11L20 30'/>", 2, 2, 4);
    /* crossings are joined where wanted, and paths run straight on */
    READ("<path d='M10 10L40 40'/><path d='M40 10L10 40'/>", 2, 2, 4);
    read_as(HEAD "<path d='M10 10L40 40'/><path d='M40 10L10 40'/>" TAIL, &cross, 2, 4,
            5);
    near(set.node.v[1].x, 25, 1e-9);
    /* three through one point */
    read_as(HEAD "<path d='M10 10L40 40'/><path d='M40 10L10 40'/>"
                 "<path d='M10 25L40 25'/>" TAIL,
            &cross, 3, 6, 7);
    /* four quarters of a cross are two lines */
    READ("<path d='M25 25L10 10'/><path d='M25 25L40 40'/><path d='M25 25L40 10'/>"
         "<path d='M25 25L10 40'/>",
         2, 4, 5);
    /* a loop of a cubic crosses itself */
    read_as(HEAD "<path d='M20 80C120 0 -20 0 80 80'/>" TAIL, &cross, 1, 3, 3);
}

static void test_curved_crossings(void **state)
{
    (void)state;
    const tz_curve_read_options cross = {.crossings = true};
    /* a circle and a line: the nodes lie on both */
    read_as(HEAD "<circle cx='50' cy='50' r='20'/><path d='M10 57L90 57'/>" TAIL, &cross,
            2, 9, 8);
    int found = 0;
    for (int32_t i = 0; i < set.node.n; i++)
        if (fabs(set.node.v[i].y - 57) < 1e-6 && fabs(set.node.v[i].x - 50) < 30) {
            near(hypot(set.node.v[i].x - 50, set.node.v[i].y - 50), 20, 0.02);
            found++;
        }
    assert_int_equal(found, 2);
    near(total_length(&set), 40 * TZ_PI + 80, 0.2);
}

static void test_bad(void **state)
{
    (void)state;
    fails(ctx, parse(HEAD TAIL, NULL), TZ_INVALID, "no curves");
    fails(ctx, parse(HEAD "<path d='M1 1'/>" TAIL, NULL), TZ_INVALID, "no curves");
    fails(ctx, parse(HEAD "<path d='M1 1LNaN 3'/>" TAIL, NULL), TZ_FORMAT, "t.svg");
    fails(ctx, parse(HEAD "<path d='M1 1L1e300 3'/>" TAIL, NULL), TZ_FORMAT, "t.svg");
    fails(ctx, parse("<svg", NULL), TZ_FORMAT, "t.svg");
    fails(ctx, parse("<svg xmlns='http://www.w3.org/2000/svg'/>", NULL), TZ_FORMAT,
          "size");
    fails(ctx,
          parse("<svg xmlns='http://www.w3.org/2000/svg' "
                "xmlns:tz='https://terrazzo.example/ns/1' tz:document='elements' "
                "viewBox='0 0 1 1'/>",
                NULL),
          TZ_FORMAT, "not curves");
    fails(ctx, tz_curve_read_svg(ctx, "/nowhere/x.svg", NULL, &set), TZ_IO, "nowhere");
    assert_null(set.node.v);
}

/* ---- round trips ------------------------------------------------------------------- */

static void same(const tz_curve_set *a, const tz_curve_set *b)
{
    assert_int_equal(a->node.n, b->node.n);
    assert_int_equal(a->piece.n, b->piece.n);
    assert_int_equal(a->path.n, b->path.n);
    assert_int_equal(a->pen.n, b->pen.n);
    assert_int_equal(a->background, b->background);
    assert_memory_equal(&a->domain.size, &b->domain.size, sizeof a->domain.size);
    assert_int_equal(a->domain.torus, b->domain.torus);
    assert_memory_equal(a->node.v, b->node.v, (size_t)a->node.n * sizeof *a->node.v);
    for (int32_t i = 0; i < a->pen.n; i++) {
        const tz_curve_pen *p = &a->pen.v[i], *q = &b->pen.v[i];
        assert_true(p->width == q->width && p->color == q->color && p->cap == q->cap &&
                    p->join == q->join);
    }
    for (int32_t i = 0; i < a->piece.n; i++) {
        const tz_curve_piece *p = &a->piece.v[i], *q = &b->piece.v[i];
        assert_int_equal(p->from, q->from);
        assert_int_equal(p->to, q->to);
        assert_int_equal(p->straight, q->straight);
        assert_memory_equal(&p->a, &q->a, sizeof p->a);
        assert_memory_equal(&p->b, &q->b, sizeof p->b);
    }
    for (int32_t i = 0; i < a->path.n; i++) {
        const tz_curve_path *p = &a->path.v[i], *q = &b->path.v[i];
        assert_true(p->piece == q->piece && p->pieces == q->pieces && p->pen == q->pen &&
                    p->closed == q->closed);
    }
    assert_true(a->unit_mm == b->unit_mm);
    assert_int_equal(a->taper.n, b->taper.n);
    assert_int_equal(a->origin.n, b->origin.n);
    for (int32_t i = 0; i < a->taper.n; i++)
        assert_memory_equal(&a->taper.v[i], &b->taper.v[i], sizeof a->taper.v[i]);
    for (int32_t i = 0; i < a->origin.n; i++)
        if (isnan(a->origin.v[i].p[0].x))
            assert_true(isnan(b->origin.v[i].p[0].x));
        else
            assert_memory_equal(&a->origin.v[i], &b->origin.v[i], sizeof a->origin.v[i]);
    assert_int_equal(!a->recipe, !b->recipe);
    if (a->recipe)
        assert_string_equal(a->recipe, b->recipe);
}

/* Paths at random on few nodes in no order. */
static void scribble(tz_curve_set *s, uint64_t seed, int32_t paths)
{
    tz_rng g = tz_rng_make(seed, 1);
    int32_t id, pen[3];
    *s = (tz_curve_set){.ctx = ctx,
                        .domain = {.size = {100, 80, 0}, .torus = seed & 1},
                        .background = seed & 2 ? 0x102030ff : 0,
                        .element = {.ctx = ctx}};
    for (uint32_t k = 0; k < 3; k++) {
        const tz_curve_pen p = {.width = 0.1 + tz_rng_unit(&g),
                                .color = tz_rng_u32(&g) | 1,
                                .cap = k,
                                .join = 2 - k};
        ok(ctx, tz_curve_add_pen(s, p, &pen[k]));
    }
    for (int i = 0; i < 20; i++)
        ok(ctx,
           tz_curve_add_node(
               s, (tz_vec2){tz_rng_range(&g, -5, 100), tz_rng_range(&g, 0, 80)}, &id));
    for (int32_t i = 0; i < paths; i++) {
        int32_t at = i < 10 ? 19 - 2 * i : tz_rng_below(&g, 20);
        const int32_t first = at, n = 1 + tz_rng_below(&g, 5);
        ok(ctx, tz_curve_begin(s, pen[tz_rng_below(&g, 3)]));
        for (int32_t k = 0; k <= n; k++) {
            int32_t to = i < 10 && k == 0  ? 18 - 2 * i
                         : k == n && i % 2 ? first
                                           : tz_rng_below(&g, 20);
            if (tz_rng_below(&g, 2))
                ok(ctx, tz_curve_line(s, at, to));
            else
                ok(ctx, tz_curve_cubic(s, at, to, (tz_vec2){tz_rng_normal(&g), 3.0 / 7},
                                       (tz_vec2){1e-7, 40 * tz_rng_unit(&g)}));
            at = to;
        }
        tz_curve_end(s, i % 2);
    }
    tz_curve_wrap(s);
    for (int32_t i = 0; i < s->piece.n && seed % 5 == 1; i++)
        ok(ctx, tz_array_push(ctx, &s->taper,
                              ((tz_curve_taper){tz_rng_unit(&g) + 0.1, 1.0 / 3})));
    for (int32_t i = 0; i < s->piece.n && seed % 3 == 2; i++) {
        tz_bezier b = tz_curve_no_origin();
        for (int k = 0; k < 4 && i % 4; k++)
            b.p[k] = (tz_vec2){tz_rng_normal(&g), 100 * tz_rng_normal(&g)};
        ok(ctx, tz_array_push(ctx, &s->origin, b));
    }
    s->unit_mm = seed % 4 == 3 ? 0.1 / 3 : 0;
    ok(ctx, tz_curve_set_check(ctx, s, "scribble"));
}

static void test_round_trip(void **state)
{
    (void)state;
    char dir[64], path[100];
    begin_dir(dir);
    snprintf(path, sizeof path, "%s/a.svg", dir);
    for (uint64_t seed = 0; seed < 12; seed++) {
        tz_curve_set a, b;
        scribble(&a, seed, 10 + (int32_t)seed);
        if (seed % 3 == 0)
            ok(ctx, tz_strdup(ctx, "{\"a\": \"<&>\"}", &a.recipe));
        ok(ctx, tz_curve_write_svg(ctx, path, &a));
        ok(ctx, tz_curve_read_svg(ctx, path, NULL, &b));
        same(&a, &b);
        tz_curve_set_deinit(&a);
        tz_curve_set_deinit(&b);
    }
    end_dir(dir);
}

/* Discrete elements among the curves come back, too. */
static void test_with_elements(void **state)
{
    (void)state;
    char dir[64], path[100];
    tz_curve_set a, b;
    begin_dir(dir);
    snprintf(path, sizeof path, "%s/a.svg", dir);
    scribble(&a, 4, 12);
    tz_element_set_deinit(&a.element);
    ok(ctx, drawn_hexagons(ctx, 5, 4, 0.3, false, &a.element));
    a.element.domain = a.domain;
    ok(ctx, tz_curve_write_svg(ctx, path, &a));
    ok(ctx, tz_curve_read_svg(ctx, path, NULL, &b));
    same(&a, &b);
    assert_int_equal(b.element.element.n, a.element.element.n);
    for (int32_t i = 0; i < a.element.element.n; i++) {
        const tz_element *p = &a.element.element.v[i], *q = &b.element.element.v[i];
        assert_true(p->at.x == q->at.x && p->at.y == q->at.y && p->angle == q->angle &&
                    p->kind == q->kind && p->radius == q->radius);
    }
    tz_curve_set_deinit(&a);
    tz_curve_set_deinit(&b);
    end_dir(dir);
}

/* Filled shapes among curves become elements where that is wanted: equal ones share a
 * symbol, lines drawn as outlines stay lines, and all of it comes back. */
static void test_leaves(void **state)
{
    (void)state;
    static const char text[] =
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 100 100'>"
        "<defs><path id='leaf' fill='green' d='M0 0C4 -4 8 -4 12 0C8 4 4 4 0 0Z'/></defs>"
        "<path fill='none' stroke='black' d='M0 50C30 20 60 80 100 50'/>"
        "<use href='#leaf' transform='translate(20 40)'/>"
        "<use href='#leaf' transform='translate(50 50) rotate(40)'/>"
        "<circle fill='red' cx='80' cy='20' r='6'/>"
        "<path fill='blue' d='M5 90L95 90L95 91L5 91Z'/></svg>";
    const tz_curve_read_options o = {.elements = true};
    char dir[64], path[100];
    tz_curve_set b;
    ok(ctx, parse(text, &o));
    assert_int_equal(set.path.n, 2);
    assert_int_equal(set.element.element.n, 3);
    assert_int_equal(set.element.symbol.n, 2);
    assert_int_equal(set.element.element.v[0].symbol, set.element.element.v[1].symbol);
    begin_dir(dir);
    snprintf(path, sizeof path, "%s/a.svg", dir);
    ok(ctx, tz_curve_write_svg(ctx, path, &set));
    ok(ctx, tz_curve_read_svg(ctx, path, NULL, &b));
    same(&set, &b);
    assert_int_equal(b.element.element.n, 3);
    tz_curve_set_deinit(&b);
    end_dir(dir);
    ok(ctx, parse(text, NULL));
    assert_int_equal(set.element.element.n, 0);
}

/* A photo and a ground without any elements stay. */
static void test_photo(void **state)
{
    (void)state;
    char dir[64], path[100], photo[100], plate[100];
    tz_curve_set a, b;
    begin_dir(dir);
    snprintf(path, sizeof path, "%s/a.svg", dir);
    snprintf(photo, sizeof photo, "%s/p.png", dir);
    snprintf(plate, sizeof plate, "%s/q.png", dir);
    scribble(&a, 8, 12);
    a.element.domain = a.domain;
    tz_element_photo p = {.width = 30, .height = 20};
    ok(ctx, tz_strdup(ctx, photo, &p.path));
    ok(ctx, tz_strdup(ctx, plate, &p.plate));
    memset(p.sha256, 'a', 64);
    ok(ctx, tz_array_push(ctx, &a.element.photo, p));
    ok(ctx, tz_strdup(ctx, "<path d=\"M0 0L9 9Z\"/>", &a.element.background));
    for (int k = 0; k < 2; k++) {
        ok(ctx, tz_curve_write_svg(ctx, path, &a));
        if (k == 1) { /* an editor has been at it */
            char *text;
            size_t size;
            ok(ctx, tz_file_read(ctx, path, 1 << 20, &text, &size));
            char *at = strstr(text, "tz:nodes=\"");
            memcpy(at, "aa:nodes", 8);
            FILE *f = fopen(path, "w");
            fwrite(text, 1, size, f);
            fclose(f);
            tz_free(ctx, text);
        }
        ok(ctx, tz_curve_read_svg(ctx, path, NULL, &b));
        if (k == 0)
            same(&a, &b);
        assert_int_equal(b.element.element.n, 0);
        assert_int_equal(b.element.photo.n, 1);
        assert_string_equal(b.element.photo.v[0].path, photo);
        assert_string_equal(b.element.photo.v[0].plate, plate);
        assert_memory_equal(b.element.photo.v[0].sha256, p.sha256, 65);
        assert_int_equal(b.element.photo.v[0].width, 30);
        if (k == 0)
            assert_string_equal(b.element.background, a.element.background);
        tz_curve_set_deinit(&b);
    }
    tz_curve_set_deinit(&a);
    end_dir(dir);
}

static void test_paper(void **state)
{
    (void)state;
    static const struct {
        const char *width;
        double mm;
    } list[] = {{"210mm", 2.1}, {"21cm", 2.1}, {"10in", 2.54}, {"100", 0}, {"100px", 0}};
    for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
        char text[300];
        snprintf(text, sizeof text,
                 "<svg xmlns='http://www.w3.org/2000/svg' width='%s' height='%s' "
                 "viewBox='0 0 100 100'><path stroke='red' fill='none' d='M1 1L9 "
                 "9'/></svg>",
                 list[i].width, list[i].width);
        ok(ctx, parse(text, NULL));
        near(set.unit_mm, list[i].mm, 1e-12);
    }
}

/* A path over the border of a torus: shown run through, and at the other side; the torus
 * stays where an editor has changed the document. */
static void test_torus(void **state)
{
    (void)state;
    char dir[64], path[100], *text;
    size_t size;
    tz_curve_set a, b;
    int32_t pen, n[3];
    begin_dir(dir);
    snprintf(path, sizeof path, "%s/a.svg", dir);
    a = (tz_curve_set){.ctx = ctx,
                       .domain = {.size = {100, 80, 0}, .torus = true},
                       .element = {.ctx = ctx}};
    ok(ctx, tz_curve_add_pen(&a, (tz_curve_pen){.width = 1, .color = 255}, &pen));
    ok(ctx, tz_curve_add_node(&a, (tz_vec2){90, 10}, &n[0]));
    ok(ctx, tz_curve_add_node(&a, (tz_vec2){115, 1.0 / 3}, &n[1]));
    ok(ctx, tz_curve_add_node(&a, (tz_vec2){170, -30}, &n[2]));
    ok(ctx, tz_curve_begin(&a, pen));
    ok(ctx, tz_curve_line(&a, n[0], n[1]));
    ok(ctx, tz_curve_cubic(&a, n[1], n[2], (tz_vec2){130, -10}, (tz_vec2){150, -30}));
    ok(ctx, tz_curve_line(&a, n[2], n[0])); /* around */
    tz_curve_end(&a, true);
    tz_curve_wrap(&a);
    const double length = total_length(&a);
    ok(ctx, tz_curve_write_svg(ctx, path, &a));
    ok(ctx, tz_curve_read_svg(ctx, path, NULL, &b));
    same(&a, &b);
    tz_curve_set_deinit(&b);
    ok(ctx, tz_file_read(ctx, path, 1 << 20, &text, &size));
    assert_non_null(strstr(text, "tz:copy"));
    assert_non_null(strstr(text, "tz:exact"));
    memcpy(strstr(text, "tz:nodes"), "aa", 2);
    FILE *f = fopen(path, "w");
    fwrite(text, 1, size, f);
    fclose(f);
    tz_free(ctx, text);
    ok(ctx, tz_curve_read_svg(ctx, path, NULL, &b));
    assert_true(b.domain.torus);
    assert_int_equal(b.path.n, 1);
    assert_true(b.path.v[0].closed);
    near(total_length(&b), length, 1e-6 * length);
    tz_curve_set_deinit(&b);
    tz_curve_set_deinit(&a);
    end_dir(dir);
}

/* A document that an editor has changed is read as the drawing that it is. */
static void test_edited(void **state)
{
    (void)state;
    static const char head[] =
        "<svg xmlns='http://www.w3.org/2000/svg' "
        "xmlns:tz='https://terrazzo.example/ns/1' viewBox='0 0 100 100' "
        "tz:document='curves' tz:size='100 100 0' tz:torus='0' "
        "tz:background='00000000'><defs><g id='tz-pens'><g tz:pen='1 000000ff 0 0'/></g>"
        "</defs>";
    static const char *const body[] = {
        "<path fill='none' stroke='#000' tz:pen='0' tz:nodes='0 1' d='M1 1L9 1'/></svg>",
        "<g transform='scale(2)'><path fill='none' stroke='#000' tz:pen='0' "
        "tz:nodes='0 1' d='M1 1L9 1'/></g></svg>",
        "<path fill='none' stroke='#000' tz:pen='0' tz:nodes='0 1 2' d='M1 1L9 "
        "1'/></svg>",
        "<path fill='none' stroke='#f00' tz:pen='0' tz:nodes='0 1' d='M1 1L9 1'/></svg>",
        "<path fill='none' stroke='#000' tz:pen='0' tz:nodes='0 999999999' "
        "d='M1 1L9 1'/></svg>",
        "<path fill='none' stroke='#000' tz:pen='0' tz:nodes='0 1' d='M1 1L9 1'/>"
        "<circle fill='none' stroke='#000' cx='50' cy='50' r='9'/></svg>"};
    static const double length[] = {8, 16, 8, 8, 8, 8 + 18 * TZ_PI};
    for (int i = 0; i < 6; i++) {
        char text[2000];
        snprintf(text, sizeof text, "%s%s", head, body[i]);
        ok(ctx, parse(text, NULL));
        near(total_length(&set), length[i], 0.05);
        assert_int_equal(set.pen.v[set.path.v[0].pen].color,
                         i == 3 ? 0xff0000ff : 0x000000ff);
    }
}

/* ---- properties of joining --------------------------------------------------------- */

/* Farthest that a point of `a` lies from all of `b`. */
static double farthest(const tz_curve_set *a, const tz_curve_set *b)
{
    enum { STEPS = 96 };
    double far = 0;
    for (int32_t i = 0; i < a->piece.n; i++)
        for (int k = 0; k <= 4; k++) {
            const tz_bezier c = tz_curve_bezier(a, &a->piece.v[i]);
            const tz_vec2 p = tz_bezier_at(&c, k / 4.0);
            double best = INFINITY;
            for (int32_t j = 0; j < b->piece.n; j++) {
                const tz_bezier d = tz_curve_bezier(b, &b->piece.v[j]);
                tz_vec2 q = d.p[0];
                for (int m = 1; m <= STEPS; m++) {
                    const tz_vec2 r = tz_bezier_at(&d, (double)m / STEPS),
                                  u = tz_vec2_sub(r, q), v = tz_vec2_sub(p, q);
                    const double n = tz_vec2_dot(u, u);
                    const double t = n > 0 ? fmin(1, fmax(0, tz_vec2_dot(u, v) / n)) : 0;
                    best = fmin(best, hypot(v.x - t * u.x, v.y - t * u.y));
                    q = r;
                }
            }
            far = fmax(far, best);
        }
    return far;
}

/* All that was drawn is there, nothing else is, and joining again finds little to do. */
static void test_join_again(void **state)
{
    (void)state;
    const tz_curve_join_params p = {.crossings = true, .reach = 0.05};
    for (uint64_t seed = 0; seed < 3; seed++) {
        tz_curve_set a, b, c;
        scribble(&a, 2 * seed, 12);
        ok(ctx, tz_curve_join(ctx, &a, &p, &b));
        ok(ctx, tz_curve_set_check(ctx, &b, "joined"));
        assert_true(total_length(&b) <= total_length(&a) * 1.001);
        assert_true(farthest(&a, &b) <= 2.5 * p.reach);
        assert_true(farthest(&b, &a) <= 2.5 * p.reach);
        ok(ctx, tz_curve_join(ctx, &b, &p, &c));
        near(total_length(&c), total_length(&b), 0.02 * total_length(&b));
        tz_curve_set_deinit(&a);
        tz_curve_set_deinit(&b);
        tz_curve_set_deinit(&c);
    }
}

/* n lines across n lines: n * n crossings. */
static void grid_of(tz_curve_set *s, int32_t n)
{
    int32_t pen, a, b;
    *s = (tz_curve_set){
        .ctx = ctx, .domain = {.size = {100, 100, 0}}, .element = {.ctx = ctx}};
    ok(ctx, tz_curve_add_pen(s, (tz_curve_pen){.width = 10.0 / n, .color = 255}, &pen));
    for (int32_t i = 0; i < 2 * n; i++) {
        const double x = (i / 2 + 0.5) * 100 / n;
        ok(ctx, tz_curve_add_node(s, i & 1 ? (tz_vec2){x, 0} : (tz_vec2){0, x}, &a));
        ok(ctx, tz_curve_add_node(s, i & 1 ? (tz_vec2){x, 100} : (tz_vec2){100, x}, &b));
        ok(ctx, tz_curve_begin(s, pen));
        ok(ctx, tz_curve_line(s, a, b));
        tz_curve_end(s, false);
    }
}

static void test_many_crossings(void **state)
{
    (void)state;
    const tz_curve_join_params p = {.crossings = true};
    tz_curve_set a, b;
    grid_of(&a, 100);
    ok(ctx, tz_curve_join(ctx, &a, &p, &b));
    assert_int_equal(b.path.n, 200);
    assert_int_equal(b.node.n, 400 + 10000);
    assert_int_equal(b.piece.n, 2 * 100 * 101);
    near(total_length(&b), 20000, 1e-6);
    tz_curve_set_deinit(&a);
    tz_curve_set_deinit(&b);
}

static tz_status read_and_join(tz_ctx *c)
{
    static const char text[] = HEAD "<circle cx='50' cy='50' r='20'/>"
                                    "<path d='M10 57L90 57L90 20'/>"
                                    "<path d='M3 3L3 9L5 7z'/>"
                                    "<path d='M90 20.2L4 4'/>" TAIL;
    tz_curve_set s;
    const tz_curve_read_options o = {.crossings = true};
    const tz_status st = tz_curve_parse_svg(c, "t.svg", text, sizeof text - 1, &o, &s);
    tz_curve_set_deinit(&s);
    return st;
}

/* One line a thousand times, and a thousand that meet: no more in one spot than one. */
static void test_one_spot(void **state)
{
    enum { MANY = 1000, EACH = 80 };
    (void)state;
    char *text = malloc(sizeof HEAD + sizeof TAIL + (size_t)MANY * EACH);
    for (int star = 0; star < 2; star++) {
        char *at = text + sprintf(text, "%s", HEAD);
        for (int i = 0; i < MANY; i++) {
            const double a = i * TZ_PI / MANY * 2;
            at += star ? sprintf(at, "<path d='M50 50L%.9g %.9g'/>", 50 + 49 * cos(a),
                                 50 + 49 * sin(a))
                       : sprintf(at, "<path d='M%s'/>",
                                 i % 2 ? "10 10C20 10 30 20 40 90"
                                       : "40 90C30 20 20 10 10 10");
        }
        strcpy(at, TAIL);
        const tz_curve_read_options fine = {.reach = 1e-3};
        read_as(text, &fine, star ? MANY : 1, star ? MANY : 1, star ? MANY + 1 : 2);
    }
    free(text);
}

static void test_memory(void **state)
{
    (void)state;
    survive(read_and_join, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_shapes, begin, end),
        cmocka_unit_test_setup_teardown(test_joining, begin, end),
        cmocka_unit_test_setup_teardown(test_curved_crossings, begin, end),
        cmocka_unit_test_setup_teardown(test_bad, begin, end),
        cmocka_unit_test_setup_teardown(test_round_trip, begin, end),
        cmocka_unit_test_setup_teardown(test_with_elements, begin, end),
        cmocka_unit_test_setup_teardown(test_leaves, begin, end),
        cmocka_unit_test_setup_teardown(test_photo, begin, end),
        cmocka_unit_test_setup_teardown(test_paper, begin, end),
        cmocka_unit_test_setup_teardown(test_torus, begin, end),
        cmocka_unit_test_setup_teardown(test_edited, begin, end),
        cmocka_unit_test_setup_teardown(test_join_again, begin, end),
        cmocka_unit_test_setup_teardown(test_many_crossings, begin, end),
        cmocka_unit_test_setup_teardown(test_one_spot, begin, end),
        cmocka_unit_test_setup_teardown(test_memory, begin, end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
