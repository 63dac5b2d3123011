/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Finishing: what is good stays as it is, what is torn is mended. */
#include "tests/support/curve_fixture.h"

#include <math.h>

#include "base/rng.h"
#include "curves/curve_io.h"
#include "curves/finish.h"

#define HEAD                                     \
    "<svg xmlns=\"http://www.w3.org/2000/svg\" " \
    "viewBox=\"0 0 375 375\"><g fill=\"none\" stroke=\"#204060\" stroke-width=\"2\">"
#define TAIL "</g></svg>"

static void parse(const char *text, tz_curve_set *s)
{
    ok(ctx, tz_curve_parse_svg(ctx, "t.svg", text, strlen(text), NULL, s));
}

static double total_length(const tz_curve_set *s)
{
    double sum = 0;
    for (int32_t i = 0; i < s->piece.n; i++) {
        const tz_bezier b = tz_curve_bezier(s, &s->piece.v[i]);
        sum += tz_bezier_length(&b);
    }
    return sum;
}

static void same(const tz_curve_set *a, const tz_curve_set *b)
{
    assert_int_equal(a->piece.n, b->piece.n);
    assert_int_equal(a->path.n, b->path.n);
    assert_int_equal(a->node.n, b->node.n);
    assert_memory_equal(a->node.v, b->node.v, (size_t)a->node.n * sizeof *a->node.v);
    for (int32_t i = 0; i < a->piece.n; i++)
        assert_memory_equal(&a->piece.v[i].a, &b->piece.v[i].a, 2 * sizeof(tz_vec2));
}

/* A lattice of n x n cells over a square of side `side`, without the `gone`-th of its
 * edges where gone > 0, cut open in the middle where `gap` > 0. */
static tz_status lattice(tz_ctx *c, double side, int n, double gap, int every, bool torus,
                         tz_curve_set *s)
{
    const double step = side / n, from = torus ? 0 : step / 2;
    const int m = torus ? n : n - 1;
    int32_t pen, a = 0, b = 0;
    int count = 0;
    *s = (tz_curve_set){.ctx = c,
                        .domain = {.size = {side, side, 0}, .torus = torus},
                        .element = {.ctx = c}};
    tz_status st = tz_curve_add_pen(s, (tz_curve_pen){.width = 1, .color = 255}, &pen);
    for (int i = 0; i < n * n && st == TZ_OK; i++)
        st = tz_curve_add_node(
            s, (tz_vec2){from + i % n * step, from + (double)(i / n) * step}, &a);
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < n * n && st == TZ_OK; i++) {
            const int x = i % n, y = i / n;
            if ((k == 0 ? x : y) >= m)
                continue;
            const int32_t p = i, q = k == 0 ? y * n + (x + 1) % n : (y + 1) % n * n + x;
            const tz_vec2 u = s->node.v[p],
                          d = k == 0 ? (tz_vec2){step, 0} : (tz_vec2){0, step};
            if (!(every && ++count % every == 0)) {
                st = tz_curve_begin(s, pen);
                if (st == TZ_OK)
                    st = tz_curve_line(s, p, q);
                if (st == TZ_OK)
                    tz_curve_end(s, false);
                continue;
            }
            st =
                tz_curve_add_node(s, tz_vec2_add(u, tz_vec2_scale(d, 0.5 - gap / 2)), &a);
            if (st == TZ_OK)
                st = tz_curve_add_node(s, tz_vec2_add(u, tz_vec2_scale(d, 0.5 + gap / 2)),
                                       &b);
            if (st == TZ_OK)
                st = tz_curve_begin(s, pen);
            if (st == TZ_OK)
                st = tz_curve_line(s, p, a);
            if (st == TZ_OK)
                tz_curve_end(s, false);
            if (st == TZ_OK)
                st = tz_curve_begin(s, pen);
            if (st == TZ_OK)
                st = tz_curve_line(s, b, q);
            if (st == TZ_OK)
                tz_curve_end(s, false);
        }
    tz_curve_wrap(s);
    return st;
}

/* An exemplar, finished after itself, is what it was; so are drawings of all kinds. */
static void test_untouched(void **state)
{
    (void)state;
    static const char *const text[] = {
        HEAD "<path d='M20 100C120 0 220 200 350 80'/>" TAIL,
        HEAD "<circle cx='100' cy='100' r='60'/>" TAIL,
        HEAD "<path d='M50 50L250 90M90 250L200 20M300 90L40 160M60 52L70 80'/>" TAIL,
        HEAD "<path d='M50 50L51 50M50 51L51 51M200 200L300 200M201 203L299 203'/>" TAIL};
    for (size_t i = 0; i < sizeof text / sizeof *text; i++) {
        tz_curve_set x, s;
        tz_curve_finish_report r;
        parse(text[i], &x);
        parse(text[i], &s);
        ok(ctx, tz_curve_finish(ctx, &x, NULL, &s, &r));
        if (r.closed || r.removed)
            fail_msg("closed %d, removed %d in %s", r.closed, r.removed, text[i]);
        same(&x, &s);
        tz_curve_set_deinit(&x);
        tz_curve_set_deinit(&s);
    }
    static const char *const list[] = {"lattice_stained_glass",
                                       "network_streets_chicago",
                                       "network_circuit_board",
                                       "contours_topography",
                                       "wood_grain",
                                       "memphis_mixed"};
    for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
        char path[200];
        tz_curve_set x, s;
        snprintf(path, sizeof path, "../shared/exemplars/svg/%s.svg", list[i]);
        if (access(path, R_OK) != 0)
            continue;
        ok(ctx, tz_curve_read_svg(ctx, path, NULL, &x));
        ok(ctx, tz_curve_read_svg(ctx, path, NULL, &s));
        ok(ctx, tz_curve_finish(ctx, &x, NULL, &s, NULL));
        same(&x, &s);
        tz_curve_set_deinit(&x);
        tz_curve_set_deinit(&s);
    }
}

/* A lattice with gaps gets the lattice's own length and ends back, on a torus, too; then
 * there is nothing left to do. */
static void test_gaps(void **state)
{
    (void)state;
    for (int torus = 0; torus < 2; torus++)
        for (int every = 3; every < 12; every += 4) {
            tz_curve_set x, s, whole;
            tz_curve_finish_report r;
            ok(ctx, lattice(ctx, 300, 10, 0, 0, false, &x));
            ok(ctx, lattice(ctx, 600, 20, 0, 0, torus, &whole));
            ok(ctx, lattice(ctx, 600, 20, 0.3, every, torus, &s));
            ok(ctx, tz_curve_finish(ctx, &x, NULL, &s, &r));
            ok(ctx, tz_curve_set_check(ctx, &s, "finished"));
            assert_true(r.ends[0] > 100 && r.ends[1] == 0 && r.removed == 0);
            assert_int_equal(r.closed, r.ends[0] / 2);
            assert_true(fabs(total_length(&s) - total_length(&whole)) <
                        1e-6 * total_length(&whole));
            ok(ctx, tz_curve_finish(ctx, &x, NULL, &s, &r));
            assert_true(r.closed == 0 && r.removed == 0);
            tz_curve_set_deinit(&x);
            tz_curve_set_deinit(&s);
            tz_curve_set_deinit(&whole);
        }
}

/* Stubs and crumbs of which the exemplar has none go; a line that ends short of another
 * is drawn on to it; of two lines side by side one stays. */
static void test_mending(void **state)
{
    (void)state;
    static const char exemplar[] = HEAD "<path d='M0 100L375 100M0 200L375 200M100 0L100 "
                                        "100M200 100L200 200'/>" TAIL;
    static const struct {
        const char *text;
        int32_t closed, removed;
        double length;
    } list[] = {
        /* a stub */
        {HEAD "<path d='M0 100L375 100M200 100L200 106'/>" TAIL, 0, 1, 375},
        /* a crumb */
        {HEAD "<path d='M0 100L375 100M200 150L204 150'/>" TAIL, 0, 1, 375},
        /* short of a line */
        {HEAD "<path d='M0 100L375 100M200 0L200 88'/>" TAIL, 1, 0, 475},
        /* a gap */
        {HEAD "<path d='M0 100L150 100M165 100L375 100'/>" TAIL, 1, 0, 375},
        /* short of the border */
        {HEAD "<path d='M0 100L360 100'/>" TAIL, 1, 0, 375},
        /* side by side */
        {HEAD "<path d='M0 100L375 100M0 102L375 102'/>" TAIL, 0, 1, 375},
        /* all is well */
        {HEAD "<path d='M0 100L375 100M200 100L200 0'/>" TAIL, 0, 0, 475},
    };
    for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
        tz_curve_set x, s;
        tz_curve_finish_report r;
        parse(exemplar, &x);
        parse(list[i].text, &s);
        ok(ctx, tz_curve_finish(ctx, &x, NULL, &s, &r));
        ok(ctx, tz_curve_set_check(ctx, &s, "finished"));
        if (r.closed != list[i].closed || r.removed != list[i].removed ||
            fabs(total_length(&s) - list[i].length) > 0.01)
            fail_msg("closed %d, removed %d, length %g: %s", r.closed, r.removed,
                     total_length(&s), list[i].text);
        assert_int_equal(r.ends[1], 0);
        tz_curve_set_deinit(&x);
        tz_curve_set_deinit(&s);
    }
}

/* Waves side by side over a square, without ends; where `broken`, every line lacks a piece
 * somewhere, more than any reach long and next to whole lines, or ends there for good. */
static tz_status waves(tz_ctx *c, double side, bool broken, bool torus, tz_curve_set *s)
{
    enum { STEPS = 48 };
    tz_rng g = tz_rng_make(11, 4);
    int32_t pen, node = 0, first = 0;
    *s = (tz_curve_set){.ctx = c,
                        .domain = {.size = {side, side, 0}, .torus = torus},
                        .element = {.ctx = c}};
    tz_status st = tz_curve_add_pen(s, (tz_curve_pen){.width = 1, .color = 255}, &pen);
    for (int i = 0; i < (int)(side / 15) && st == TZ_OK; i++) {
        const int hole = (int)tz_rng_range(&g, 8, 20),
                  last = hole + (int)tz_rng_range(&g, 2, 12);
        bool open = false;
        for (int k = 0; k <= STEPS && st == TZ_OK; k++) {
            if (broken && i % 3 && k > hole && k < last) {
                if (open)
                    tz_curve_end(s, false);
                open = false;
                continue;
            }
            const double x = side * k / STEPS,
                         y = 7.5 + 15 * i + 5 * sin(2 * TZ_PI * 2 * x / side);
            const int32_t before = node;
            if (torus && k == STEPS && open)
                node = first;
            else
                st = tz_curve_add_node(s, (tz_vec2){fmin(x, side), y}, &node);
            if (st != TZ_OK)
                break;
            first = k == 0 ? node : first;
            const tz_vec2 p = s->node.v[before];
            const double h = side / STEPS / 3, slope = 5 * 2 * TZ_PI * 2 / side,
                         from = slope * cos(2 * TZ_PI * 2 * (x - 3 * h) / side),
                         to = slope * cos(2 * TZ_PI * 2 * x / side);
            if (!open)
                st = st == TZ_OK ? tz_curve_begin(s, pen) : st;
            else if (st == TZ_OK)
                st = tz_curve_cubic(s, before, node, (tz_vec2){p.x + h, p.y + h * from},
                                    (tz_vec2){x - h, y - h * to});
            open = true;
        }
        if (open && st == TZ_OK)
            tz_curve_end(s, torus && !(broken && i % 3));
    }
    if (st == TZ_OK)
        tz_curve_wrap(s);
    return st;
}

static int32_t junctions(const tz_curve_set *s)
{
    int32_t *degree = calloc((size_t)s->node.n, sizeof *degree), n = 0;
    for (int32_t i = 0; i < s->piece.n; i++) {
        degree[s->piece.v[i].from]++;
        degree[s->piece.v[i].to]++;
    }
    for (int32_t i = 0; i < s->node.n; i++)
        n += degree[i] > 2;
    free(degree);
    return n;
}

/* Lines without ends get hardly any: they are paired over wide gaps, nothing meets, and hardly
 * any length is lost. */
static void test_pairs(void **state)
{
    (void)state;
    for (int torus = 0; torus < 2; torus++) {
        tz_curve_set x, s;
        tz_curve_finish_report r;
        ok(ctx, waves(ctx, 300, false, false, &x));
        ok(ctx, waves(ctx, 600, true, torus, &s));
        const double before = total_length(&s);
        ok(ctx, tz_curve_finish(ctx, &x, NULL, &s, &r));
        ok(ctx, tz_curve_set_check(ctx, &s, "finished"));
        if (r.ends[0] < 50 || 20 * r.ends[1] > r.ends[0])
            fail_msg("torus %d: ends %d to %d, closed %d", torus, r.ends[0], r.ends[1],
                     r.closed);
        assert_int_equal(junctions(&s), 0);
        assert_true(total_length(&s) > 0.95 * before);
        tz_curve_set_deinit(&x);
        tz_curve_set_deinit(&s);
    }
}

/* Lines that cross merely cross when one of them has been mended, and are the curves that
 * they were; nodes that they shared they still share. */
static tz_status crossed(tz_ctx *c, double side, double gap, bool torus, tz_curve_set *s)
{
    enum { LINES = 12 };
    int32_t pen, a, b;
    *s = (tz_curve_set){.ctx = c,
                        .domain = {.size = {side, side, 0}, .torus = torus},
                        .element = {.ctx = c}};
    tz_status st = tz_curve_add_pen(s, (tz_curve_pen){.width = 1, .color = 255}, &pen);
    for (int i = 0; i < 2 * LINES && st == TZ_OK; i++) {
        const bool down = i >= LINES, straight = i % 3 == 0;
        const double at = 0.45 * (i % LINES + 0.5) * side / LINES,
                     h = straight ? 0 : side / 20;
        tz_bezier line = {
            {{0, at}, {side / 3, at + h}, {2 * side / 3, at - h}, {side, at}}};
        for (int k = 0; k < 4; k++) {
            if (down)
                line.p[k] = (tz_vec2){line.p[k].y, line.p[k].x};
        }
        const double cut[2][2] = {{0, 0.7 - gap / 2}, {0.7 + gap / 2, 1}};
        for (int k = 0; k < (i == 3 && gap > 0 ? 2 : 1) && st == TZ_OK; k++) {
            const bool whole = i != 3 || !(gap > 0);
            const tz_bezier v =
                tz_bezier_part(&line, whole ? 0 : cut[k][0], whole ? 1 : cut[k][1]);
            st = tz_curve_add_node(s, v.p[0], &a);
            b = a;
            if (st == TZ_OK && !(torus && whole))
                st = tz_curve_add_node(s, v.p[3], &b);
            if (st == TZ_OK)
                st = tz_curve_begin(s, pen);
            if (st == TZ_OK && straight &&
                !torus) /* over half of a torus it would be around */
                st = tz_curve_line(s, a, b);
            else if (st == TZ_OK)
                st = tz_curve_cubic(s, a, b, v.p[1], v.p[2]);
            if (st == TZ_OK)
                tz_curve_end(s, a == b);
        }
    }
    tz_curve_wrap(s);
    return st;
}

static bool holds(const tz_curve_set *s, const tz_bezier *c)
{
    for (int32_t i = 0; i < s->piece.n; i++) {
        const tz_bezier b = tz_curve_bezier(s, &s->piece.v[i]);
        double way[2] = {0, 0};
        for (int k = 0; k < 4; k++) {
            way[0] = fmax(way[0], tz_vec2_length(tz_vec2_sub(b.p[k], c->p[k])));
            way[1] = fmax(way[1], tz_vec2_length(tz_vec2_sub(b.p[3 - k], c->p[k])));
        }
        if (fmin(way[0], way[1]) < 1e-3)
            return true;
    }
    return false;
}

static void test_crossings(void **state)
{
    (void)state;
    for (int torus = 0; torus < 2; torus++) {
        tz_curve_set x, before, s;
        tz_curve_finish_report r;
        ok(ctx, crossed(ctx, 360, 0, torus, &x));
        ok(ctx, crossed(ctx, 360, 0.02, torus, &before));
        ok(ctx, crossed(ctx, 360, 0.02, torus, &s));
        ok(ctx, tz_curve_finish(ctx, &x, NULL, &s, &r));
        ok(ctx, tz_curve_set_check(ctx, &s, "finished"));
        assert_true(r.closed == 1 && r.ends[1] == 0 && r.removed == 0);
        assert_true(fabs(total_length(&s) - total_length(&x)) < 0.01);
        int32_t kept = 0;
        for (int32_t i = 0; i < before.piece.n; i++) {
            const tz_bezier c = tz_curve_bezier(&before, &before.piece.v[i]);
            kept += holds(&s, &c);
        }
        /* all but the line with the gap, at the most; and its bridge */
        if (kept < before.piece.n - 2 || s.piece.n > before.piece.n + 1)
            fail_msg("torus %d: %d of %d pieces are what they were; %d now", torus, kept,
                     before.piece.n, s.piece.n);
        assert_int_equal(junctions(&s), torus ? 0 : junctions(&before));
        tz_curve_set_deinit(&x);
        tz_curve_set_deinit(&before);
        tz_curve_set_deinit(&s);
    }
    tz_curve_set x, s;
    ok(ctx, lattice(ctx, 600, 20, 0, 0, true, &x));
    ok(ctx, lattice(ctx, 600, 20, 0.3, 7, true, &s));
    ok(ctx, tz_curve_finish(ctx, &x, NULL, &s, NULL));
    assert_int_equal(junctions(&s), 400);
    tz_curve_set_deinit(&x);
    tz_curve_set_deinit(&s);
}

static tz_status pair_once(tz_ctx *c, tz_curve_set *s)
{
    tz_curve_set x = {0};
    memset(s, 0, sizeof *s);
    tz_status st = waves(c, 90, false, false, &x);
    if (st == TZ_OK)
        st = waves(c, 90, true, false, s);
    if (st == TZ_OK)
        st = tz_curve_finish(c, &x, NULL, s, NULL);
    tz_curve_set_deinit(&x);
    return st;
}

static tz_status pair_memory(tz_ctx *c)
{
    tz_curve_set s;
    const tz_status st = pair_once(c, &s);
    tz_curve_set_deinit(&s);
    return st;
}

static void test_pair_memory(void **state)
{
    (void)state;
    survive(pair_memory, 1);
}

/* What is given stays and is none of the result, but lines are drawn to it. */
static void test_given(void **state)
{
    (void)state;
    tz_curve_set x, s, given;
    tz_curve_finish_report r;
    ok(ctx, lattice(ctx, 375, 10, 0, 0, false, &x));
    parse(HEAD "<path d='M0 100L150 100'/>" TAIL, &given);
    parse(HEAD "<path d='M160 100L375 100'/>" TAIL, &s);
    const double before = total_length(&given);
    ok(ctx, tz_curve_finish(ctx, &x, &given, &s, &r));
    ok(ctx, tz_curve_set_check(ctx, &s, "finished"));
    assert_int_equal(s.pen.n, 1);
    assert_true(fabs(total_length(&given) - before) < 1e-12);
    assert_int_equal(r.closed, 1);
    assert_true(fabs(total_length(&s) - 225) < 1e-6);
    tz_curve_set_deinit(&x);
    tz_curve_set_deinit(&s);
    tz_curve_set_deinit(&given);
}

/* Origins and widths stay beside their pieces; what is added has none, and some. */
static void test_carry(void **state)
{
    (void)state;
    tz_curve_set x, s;
    tz_curve_finish_report r;
    ok(ctx, lattice(ctx, 300, 10, 0, 0, false, &x));
    ok(ctx, lattice(ctx, 300, 10, 0.3, 5, false, &s));
    for (int32_t i = 0; i < s.piece.n; i++) {
        const tz_bezier b = tz_curve_bezier(&s, &s.piece.v[i]);
        ok(ctx, tz_array_push(ctx, &s.origin, b));
        ok(ctx, tz_array_push(ctx, &s.taper, ((tz_curve_taper){1, 3})));
    }
    ok(ctx, tz_curve_finish(ctx, &x, NULL, &s, &r));
    ok(ctx, tz_curve_set_check(ctx, &s, "finished"));
    assert_true(r.closed > 5);
    int32_t none = 0;
    for (int32_t i = 0; i < s.piece.n; i++) {
        const tz_bezier b = tz_curve_bezier(&s, &s.piece.v[i]), *o = &s.origin.v[i];
        none += isnan(o->p[0].x);
        for (int k = 0; k < 4 && !isnan(o->p[0].x); k++)
            assert_true(hypot(o->p[k].x - b.p[k].x, o->p[k].y - b.p[k].y) < 1e-9);
    }
    assert_int_equal(none, r.closed);
    tz_curve_set_deinit(&x);
    tz_curve_set_deinit(&s);
}

/* Lines at random by the thousand, and things that are hardly any: no harm. */
static void test_rough(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 6; seed++) {
        tz_rng g = tz_rng_make(seed, 3);
        tz_curve_set x, s;
        tz_curve_finish_report r;
        int32_t pen, a, b;
        ok(ctx, lattice(ctx, 300, 10, 0, 0, false, &x));
        s = (tz_curve_set){.ctx = ctx,
                           .domain = {.size = {300, 300, 0}, .torus = seed & 1},
                           .element = {.ctx = ctx}};
        ok(ctx, tz_curve_add_pen(&s, (tz_curve_pen){.width = 1, .color = 255}, &pen));
        for (int i = 0; i < 1500; i++) {
            const double way = seed < 2 ? 1e-6 : seed < 4 ? 10 : 80;
            const tz_vec2 p = {tz_rng_range(&g, 0, 300), tz_rng_range(&g, 0, 300)};
            ok(ctx, tz_curve_add_node(&s, p, &a));
            b = a;
            if (i % 100) /* else a line of no length */
                ok(ctx, tz_curve_add_node(&s,
                                          (tz_vec2){p.x + tz_rng_range(&g, -way, way),
                                                    p.y + tz_rng_range(&g, -way, way)},
                                          &b));
            ok(ctx, tz_curve_begin(&s, pen));
            ok(ctx, tz_curve_line(&s, a, b));
            tz_curve_end(&s, false);
        }
        tz_curve_wrap(&s);
        ok(ctx, tz_curve_finish(ctx, &x, NULL, &s, &r));
        ok(ctx, tz_curve_set_check(ctx, &s, "finished"));
        assert_true(r.ends[1] <= r.ends[0]);
        tz_curve_set_deinit(&x);
        tz_curve_set_deinit(&s);
    }
}

static tz_status finish_once(tz_ctx *c, tz_curve_set *s)
{
    tz_curve_set x = {0};
    memset(s, 0, sizeof *s);
    tz_status st = lattice(c, 90, 4, 0, 0, false, &x);
    if (st == TZ_OK)
        st = lattice(c, 90, 4, 0.3, 3, false, s);
    if (st == TZ_OK)
        st = tz_curve_finish(c, &x, NULL, s, NULL);
    tz_curve_set_deinit(&x);
    return st;
}

static void test_same_bytes(void **state)
{
    (void)state;
    const int threads[3] = {1, 2, 8};
    tz_curve_set s[3];
    tz_ctx *c[3];
    for (int k = 0; k < 3; k++) {
        c[k] = new_ctx(threads[k]);
        ok(c[k], finish_once(c[k], &s[k]));
        same(&s[0], &s[k]);
    }
    for (int k = 0; k < 3; k++) {
        tz_curve_set_deinit(&s[k]);
        ok(c[k], pair_once(c[k], &s[k]));
        same(&s[0], &s[k]);
    }
    for (int k = 0; k < 3; k++) {
        tz_curve_set_deinit(&s[k]);
        end_ctx(c[k]);
    }
}

static tz_status run_once(tz_ctx *c)
{
    tz_curve_set s;
    const tz_status st = finish_once(c, &s);
    tz_curve_set_deinit(&s);
    return st;
}

static void test_memory(void **state)
{
    (void)state;
    survive(run_once, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_untouched, begin, end),
        cmocka_unit_test_setup_teardown(test_gaps, begin, end),
        cmocka_unit_test_setup_teardown(test_mending, begin, end),
        cmocka_unit_test_setup_teardown(test_given, begin, end),
        cmocka_unit_test_setup_teardown(test_carry, begin, end),
        cmocka_unit_test_setup_teardown(test_rough, begin, end),
        cmocka_unit_test(test_same_bytes),
        cmocka_unit_test_setup_teardown(test_pairs, begin, end),
        cmocka_unit_test_setup_teardown(test_crossings, begin, end),
        cmocka_unit_test(test_memory),
        cmocka_unit_test(test_pair_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
