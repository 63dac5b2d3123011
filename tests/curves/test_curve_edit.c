/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Curve sets put together: chosen, added, welded. */
#include "tests/base/check.h"

#include <math.h>

#include "curves/curve_edit.h"
#include "curves/curve_io.h"

static tz_ctx *ctx;
static tz_curve_set a, b, out;

static int begin(void **state)
{
    (void)state;
    ctx = new_ctx(1);
    return 0;
}

static void clear(tz_curve_set *s)
{
    tz_curve_set_deinit(s);
    memset(s, 0, sizeof *s);
}

static int end(void **state)
{
    (void)state;
    clear(&a);
    clear(&b);
    clear(&out);
    end_ctx(ctx);
    return 0;
}

static tz_status parse(tz_ctx *c, const char *body, tz_curve_set *s)
{
    char text[4096];
    snprintf(text, sizeof text,
             "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 100 100'>"
             "<g fill='none' stroke='#000' stroke-width='1'>%s</g></svg>",
             body);
    return tz_curve_parse_svg(c, "t.svg", text, strlen(text), NULL, s);
}

static double length(const tz_curve_set *s)
{
    double sum = 0;
    for (int32_t i = 0; i < s->piece.n; i++) {
        const tz_bezier c = tz_curve_bezier(s, &s->piece.v[i]);
        sum += tz_bezier_length(&c);
    }
    return sum;
}

static int32_t uses(const tz_curve_set *s, int32_t node)
{
    int32_t n = 0;
    for (int32_t i = 0; i < s->piece.n; i++)
        n += (s->piece.v[i].from == node) + (s->piece.v[i].to == node);
    return n;
}

#define NET                                                                      \
    "<path d='M10 10H90'/><path d='M10 30C40 20 60 40 90 30'/>"                  \
    "<path d='M30 60L50 80L70 60Z' stroke='#f00'/><path d='M10 90Q50 70 90 90' " \
    "stroke-width='3'/>"

/* ---- choosing ---------------------------------------------------------------------- */

static void test_choose(void **state)
{
    (void)state;
    const uint8_t some[4] = {0, 1, 1, 0};
    ok(ctx, parse(ctx, NET, &a));
    assert_int_equal(a.path.n, 4);
    ok(ctx, tz_curve_choose(ctx, &a, NULL, NULL, NULL, (tz_vec2){0, 0}, &out));
    ok(ctx, tz_curve_set_check(ctx, &out, "out"));
    assert_int_equal(out.piece.n, a.piece.n);
    for (int32_t i = 0; i < a.piece.n; i++) {
        const tz_bezier p = tz_curve_bezier(&a, &a.piece.v[i]),
                        q = tz_curve_bezier(&out, &out.piece.v[i]);
        assert_memory_equal(&p, &q, sizeof p);
    }
    clear(&out);
    ok(ctx, tz_curve_choose(ctx, &a, some, NULL, NULL, (tz_vec2){3, -4}, &out));
    ok(ctx, tz_curve_set_check(ctx, &out, "out"));
    assert_int_equal(out.path.n, 2);
    assert_true(out.path.v[1].closed);
    assert_int_equal(out.path.v[1].pen, a.path.v[2].pen);
    const tz_vec2 p = a.node.v[a.piece.v[a.path.v[1].piece].from],
                  q = out.node.v[out.piece.v[0].from];
    assert_true(q.x == p.x + 3 && q.y == p.y - 4);
}

/* A closed path that runs around a torus stays one. */
static void test_choose_torus(void **state)
{
    (void)state;
    const tz_domain d = {.size = {100, 100, 0}, .torus = true};
    int32_t id[2], pen;
    a.ctx = a.element.ctx = ctx;
    a.domain = a.element.domain = d;
    ok(ctx, tz_curve_add_pen(&a, (tz_curve_pen){1, 255, 0, 0}, &pen));
    ok(ctx, tz_curve_add_node(&a, (tz_vec2){20, 50}, &id[0]));
    ok(ctx, tz_curve_add_node(&a, (tz_vec2){65, 50}, &id[1]));
    ok(ctx, tz_curve_begin(&a, pen));
    ok(ctx, tz_curve_cubic(&a, id[0], id[1], (tz_vec2){35, 60}, (tz_vec2){50, 40}));
    ok(ctx, tz_curve_cubic(&a, id[1], id[0], (tz_vec2){80, 60}, (tz_vec2){110, 40}));
    tz_curve_end(&a, true);
    ok(ctx, tz_curve_set_check(ctx, &a, "a"));
    ok(ctx, tz_curve_choose(ctx, &a, NULL, NULL, NULL, (tz_vec2){70, 20}, &out));
    ok(ctx, tz_curve_set_check(ctx, &out, "out"));
    assert_true(fabs(length(&a) - length(&out)) < 1e-9);
    assert_true(out.path.v[0].closed);
    for (int32_t i = 0; i < out.node.n; i++)
        assert_true(out.node.v[i].x >= 0 && out.node.v[i].x < 100);
}

/* ---- adding ------------------------------------------------------------------------ */

static void test_append(void **state)
{
    (void)state;
    ok(ctx, parse(ctx, NET, &a));
    ok(ctx, parse(ctx, "<path d='M5 5V95' stroke='#f00'/><path d='M7 5V95'/>", &b));
    const int32_t pens = a.pen.n, paths = a.path.n;
    const double sum = length(&a) + length(&b);
    ok(ctx, tz_curve_append(ctx, &a, &b));
    ok(ctx, tz_curve_set_check(ctx, &a, "a"));
    assert_int_equal(a.path.n, paths + 2);
    assert_int_equal(a.pen.n, pens); /* both are there already */
    assert_true(fabs(length(&a) - sum) < 1e-9);
    assert_int_equal(a.pen.v[a.path.v[paths].pen].color, 0xff0000ff);
    assert_int_equal(a.taper.n, 0);
}

/* Where one of the sets has widths, so has the whole. */
static void test_append_carry(void **state)
{
    (void)state;
    ok(ctx, parse(ctx, NET, &a));
    ok(ctx, parse(ctx, "<path d='M5 5V95' stroke-width='2'/>", &b));
    ok(ctx, tz_array_push(ctx, &b.taper, ((tz_curve_taper){1, 4})));
    ok(ctx, tz_array_push(ctx, &b.origin, tz_curve_bezier(&b, &b.piece.v[0])));
    const int32_t pieces = a.piece.n;
    ok(ctx, tz_curve_append(ctx, &a, &b));
    ok(ctx, tz_curve_set_check(ctx, &a, "a"));
    assert_int_equal(a.taper.n, pieces + 1);
    assert_int_equal(a.origin.n, pieces + 1);
    assert_true(a.taper.v[0].from == a.pen.v[a.path.v[0].pen].width);
    assert_true(a.taper.v[pieces].to == 4);
    assert_true(isnan(a.origin.v[0].p[0].x));
    assert_true(a.origin.v[pieces].p[0].x == 5);
}

/* ---- welding ----------------------------------------------------------------------- */

static void weld(const char *first, const char *then, double reach, int32_t joined)
{
    int32_t n;
    clear(&a);
    clear(&b);
    ok(ctx, parse(ctx, first, &a));
    ok(ctx, parse(ctx, then, &b));
    const int32_t paths = a.path.n;
    ok(ctx, tz_curve_append(ctx, &a, &b));
    ok(ctx, tz_curve_weld(ctx, &a, paths, reach, &n));
    ok(ctx, tz_curve_set_check(ctx, &a, "a"));
    if (n != joined)
        fail_msg("%d ends joined in place of %d: %s", n, joined, then);
}

static void test_weld(void **state)
{
    (void)state;
    /* onto an end, onto the middle of a line, onto a curve, out of reach */
    weld("<path d='M10 50H50'/>", "<path d='M50.5 50.5L90 90'/>", 1, 1);
    assert_int_equal(a.node.n, 3);
    weld("<path d='M10 50H50'/>", "<path d='M30 50.5V90'/>", 1, 1);
    assert_int_equal(a.node.n, 4);
    assert_int_equal(a.piece.n, 3);
    assert_int_equal(a.path.n, 2); /* the line is cut, but is one path */
    assert_true(fabs(length(&a) - 80) < 1e-9);
    weld("<path d='M10 50C30 20 60 80 90 50'/>", "<path d='M50 90V52.5'/>", 1, 1);
    int32_t meeting = 0;
    for (int32_t i = 0; i < a.node.n; i++)
        meeting += uses(&a, i) == 3;
    assert_int_equal(meeting, 1);
    weld("<path d='M10 50H50'/>", "<path d='M52 50H90'/>", 1, 0);
    assert_int_equal(a.node.n, 4);
    /* both ends, three cuts in one piece, and closed paths have no ends */
    weld("<path d='M10 10H90'/><path d='M10 90H90'/>",
         "<path d='M20 10.5V89.5'/><path d='M40 10.5V70'/><path d='M60 10.5V60'/>"
         "<circle cx='50' cy='15' r='4.5'/>",
         1, 4);
    assert_int_equal(a.node.n, 4 + 6 + 4);
    assert_int_equal(a.path.n, 6);
}

static tz_status weld_again(tz_ctx *c)
{
    tz_curve_set p = {0}, q = {0};
    tz_status s =
        parse(c, "<path d='M10 10H90'/><path d='M10 90C30 60 60 99 90 90'/>", &p);
    if (s == TZ_OK)
        s = parse(c, "<path d='M20 10.2V80'/><path d='M90.2 90V95'/>", &q);
    if (s == TZ_OK)
        s = tz_curve_append(c, &p, &q);
    const double before = s == TZ_OK ? length(&p) : 0;
    const int32_t n = p.node.n;
    if (s == TZ_OK && (s = tz_curve_weld(c, &p, 2, 1, NULL)) != TZ_OK) {
        assert_int_equal(p.node.n, n); /* as it was */
        assert_true(length(&p) == before);
    }
    tz_curve_set_deinit(&p);
    tz_curve_set_deinit(&q);
    return s;
}

static void test_memory(void **state)
{
    (void)state;
    survive(weld_again, 1);
}

static void test_nearest(void **state)
{
    (void)state;
    const tz_bezier c = {{{0, 0}, {30, 90}, {60, -90}, {90, 0}}};
    for (int i = 0; i <= 40; i++) {
        const tz_vec2 p = {i * 2.5 - 5, 13 - i};
        double best = INFINITY, t;
        for (int k = 0; k <= 20000; k++) {
            const tz_vec2 q = tz_bezier_at(&c, k / 20000.0);
            best = fmin(best, hypot(p.x - q.x, p.y - q.y));
        }
        const double d = tz_bezier_nearest(&c, p, &t);
        if (fabs(d - best) > 1e-3)
            fail_msg("%g in place of %g", d, best);
        const tz_vec2 q = tz_bezier_at(&c, t);
        assert_true(fabs(hypot(p.x - q.x, p.y - q.y) - d) < 1e-9);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_choose, begin, end),
        cmocka_unit_test_setup_teardown(test_choose_torus, begin, end),
        cmocka_unit_test_setup_teardown(test_append, begin, end),
        cmocka_unit_test_setup_teardown(test_append_carry, begin, end),
        cmocka_unit_test_setup_teardown(test_weld, begin, end),
        cmocka_unit_test(test_memory),
        cmocka_unit_test_setup_teardown(test_nearest, begin, end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
