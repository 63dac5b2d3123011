/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Curves rebuilt with the exemplar's own lines, and all of it on a torus. */
#include "tests/support/curve_fixture.h"

#include <math.h>

#include "base/rng.h"
#include "curves/curve_io.h"
#include "curves/curve_join.h"
#include "curves/reconstruct.h"

static void near(double a, double b, double tolerance)
{
    if (!(fabs(a - b) <= tolerance))
        fail_msg("%.17g is not %.17g within %g", a, b, tolerance);
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

static void blank(tz_ctx *c, double w, double h, bool torus, tz_curve_set *s)
{
    int32_t pen;
    *s = (tz_curve_set){
        .ctx = c, .domain = {.size = {w, h, 0}, .torus = torus}, .element = {.ctx = c}};
    ok(c, tz_curve_add_pen(s, (tz_curve_pen){.width = 1, .color = 255}, &pen));
}

/* Waves of that length along y = 50, a cubic each half of one: no corners to be found. */
static void sine(tz_ctx *c, double wave, double height, double w, bool torus,
                 tz_curve_set *s)
{
    const int32_t n = (int32_t)(2 * w / wave + 0.5);
    const double step = w / n, h = step * 4 / (3 * TZ_PI), up = height * 4 / 3;
    int32_t at, to, first;
    blank(c, w, 100, torus, s);
    ok(c, tz_curve_add_node(s, (tz_vec2){0, 50}, &at));
    ok(c, tz_curve_begin(s, 0));
    first = at;
    for (int32_t i = 0; i < n; i++) {
        const double x = i * step, y = 50 + (i % 2 ? -up : up);
        if (torus && i + 1 == n)
            to = first;
        else
            ok(c, tz_curve_add_node(s, (tz_vec2){x + step, 50}, &to));
        ok(c, tz_curve_cubic(s, at, to, (tz_vec2){x + h, y}, (tz_vec2){x + step - h, y}));
        at = to;
    }
    tz_curve_end(s, torus);
    ok(c, tz_curve_set_check(c, s, "sine"));
}

/* Each edge is like itself. */
static void self_like(tz_sample_graph *g, bool back)
{
    for (int32_t i = 0; i < g->edge.n; i++) {
        tz_curve_edge *e = &g->edge.v[i];
        e->like = i;
        if (back && i % 2) {
            const int32_t from = e->from;
            e->from = e->to;
            e->to = from;
            e->back = true;
        }
    }
}

/* The graph with each edge like itself gives the drawing back. */
static void returns(const tz_curve_set *set, double spacing, double most)
{
    tz_sample_graph x = {0}, g = {0};
    tz_curve_set out;
    double mean, far[2];
    ok(ctx, tz_sample_graph_make(ctx, set, spacing, 2 * spacing, &x));
    ok(ctx, tz_sample_graph_make(ctx, set, spacing, 2 * spacing, &g));
    ok(ctx, tz_sample_graph_check(ctx, &x, "graph"));
    assert_int_equal(x.taper.n, set->taper.n > 0 ? x.shape.n : 0);
    for (int back = 0; back < 2; back++) {
        self_like(&g, back);
        ok(ctx, tz_sample_graph_link(&g));
        ok(ctx, tz_curve_reconstruct_detail(ctx, &g, &x, set, &out));
        ok(ctx, tz_curve_set_check(ctx, &out, "out"));
        assert_int_equal(out.origin.n, out.piece.n);
        assert_int_equal(out.taper.n, set->taper.n > 0 ? out.piece.n : 0);
        ok(ctx, tz_curve_distance(ctx, set, &out, spacing / 40, &mean, &far[0]));
        ok(ctx, tz_curve_distance(ctx, &out, set, spacing / 40, &mean, &far[1]));
        near(fmax(far[0], far[1]), 0, most * spacing);
        near(total_length(&out), total_length(set), 2e-3 * total_length(set));
        /* the origin of a line that has not moved is the line itself */
        for (int32_t i = 0; i < out.piece.n; i++) {
            const tz_bezier c = tz_curve_bezier(&out, &out.piece.v[i]);
            for (int k = 0; k < 4 && !set->domain.torus; k++) {
                near(out.origin.v[i].p[k].x, c.p[k].x, 0.02 * spacing);
                near(out.origin.v[i].p[k].y, c.p[k].y, 0.02 * spacing);
            }
        }
        tz_curve_set_deinit(&out);
    }
    tz_sample_graph_deinit(&x);
    tz_sample_graph_deinit(&g);
}

static void test_identity(void **state)
{
    (void)state;
    tz_curve_set s;
    static const char *const list[] = {
        "<path d='M20 100C120 0 220 200 350 80'/>",
        "<path d='M50 50L150 60L120 150Z'/>",
        "<circle cx='100' cy='100' r='60'/>",
        "<circle cx='100' cy='100' r='3'/>",
        "<path d='M50 50L250 90M90 250L200 20M300 90L40 160'/>",
        "<path d='M20 100C120 50 220 50 350 100'/><path d='M185 62.5L185 300'/>",
        "<path d='M187 187C20 20 20 354 187 187C354 20 354 354 187 187Z'/>",
    };
    for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
        char text[600];
        snprintf(text, sizeof text,
                 "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 375 375'>"
                 "<g fill='none' stroke='#204060' stroke-width='2'>%s</g></svg>",
                 list[i]);
        ok(ctx, tz_curve_parse_svg(ctx, "t.svg", text, strlen(text), NULL, &s));
        returns(&s, 25, 0.02);
        returns(&s, 7, 0.03);
        tz_curve_set_deinit(&s);
    }
}

static void test_drawings(void **state)
{
    (void)state;
    static const char *const list[] = {"lattice_stained_glass", "network_streets_chicago",
                                       "network_circuit_board", "contours_topography",
                                       "wood_grain"};
    for (size_t k = 0; k < sizeof list / sizeof *list; k++) {
        char path[200];
        tz_curve_set s;
        snprintf(path, sizeof path, "../shared/exemplars/svg/%s.svg", list[k]);
        if (access(path, R_OK) != 0)
            continue;
        ok(ctx, tz_curve_read_svg(ctx, path, NULL, &s));
        const tz_sample_levels l = tz_sample_levels_default(&s);
        returns(&s, l.spacing[2], 0.1);
        tz_curve_set_deinit(&s);
    }
}

/* Widths run along. */
static void test_tapers(void **state)
{
    (void)state;
    tz_curve_set s;
    sine(ctx, 80, 10, 320, false, &s);
    double along = 0;
    const double total = total_length(&s);
    for (int32_t i = 0; i < s.piece.n; i++) {
        const tz_bezier b = tz_curve_bezier(&s, &s.piece.v[i]);
        const double next = along + tz_bezier_length(&b);
        ok(ctx, tz_array_push(ctx, &s.taper,
                              ((tz_curve_taper){1 + along / total, 1 + next / total})));
        along = next;
    }
    returns(&s, 25, 0.02);
    tz_sample_graph g;
    ok(ctx, tz_sample_graph_make(ctx, &s, 25, 50, &g));
    double way = 0;
    for (int32_t i = 0; i < g.shape.n; i++) { /* of one path: in its order */
        near(g.taper.v[i].from, 1 + way / total, 1e-3);
        way += tz_bezier_length(&g.shape.v[i]);
        near(g.taper.v[i].to, 1 + way / total, 1e-3);
    }
    tz_sample_graph_deinit(&g);
    tz_curve_set_deinit(&s);
}

/* Height of a line above and below y = 50. */
static double height_of(const tz_curve_set *s)
{
    double most = 0;
    for (int32_t i = 0; i < s->piece.n; i++)
        for (int k = 0; k <= 8; k++) {
            const tz_bezier c = tz_curve_bezier(s, &s->piece.v[i]);
            most = fmax(most, fabs(tz_bezier_at(&c, k / 8.0).y - 50));
        }
    return most;
}

/* No kink where a path runs through a node. */
static void is_smooth(const tz_curve_set *s, double most)
{
    for (int32_t i = 0; i < s->path.n; i++) {
        const tz_curve_path *p = &s->path.v[i];
        for (int32_t k = p->piece; k + 1 < p->piece + p->pieces; k++) {
            const tz_bezier a = tz_curve_bezier(s, &s->piece.v[k]),
                            b = tz_curve_bezier(s, &s->piece.v[k + 1]);
            const tz_vec2 u = tz_bezier_slope(&a, 1), v = tz_bezier_slope(&b, 0);
            const double turn = tz_curve_angle_between(tz_curve_angle(atan2(u.y, u.x)),
                                                       tz_curve_angle(atan2(v.y, v.x)));
            if (turn > most)
                fail_msg("a kink of %g rad at piece %d", turn, k);
        }
    }
}

/* Wiggles finer than the spacing: gone when interpolated, there with detail, also when
 * samples lie elsewhere and the line is smooth there. */
static void test_wiggles(void **state)
{
    (void)state;
    tz_curve_set s, plain, detail;
    tz_sample_graph x, g;
    sine(ctx, 10, 2, 400, false, &s);
    ok(ctx, tz_sample_graph_make(ctx, &s, 25, 50, &x));
    ok(ctx, tz_sample_graph_make(ctx, &s, 25, 50, &g));
    tz_rng rng = tz_rng_make(7, 1);
    for (int32_t i = 0; i < g.sample.n; i++) {
        tz_vec2 *p = &g.sample.v[i].at;
        *p = (tz_vec2){p->x * 1.1 + tz_rng_range(&rng, -1, 1),
                       50 + tz_rng_range(&rng, -1, 1)};
    }
    self_like(&g, false);
    for (int32_t i = 0; i < g.edge.n; i++)
        g.edge.v[i].like = (i * 7 + 3) % x.edge.n;
    ok(ctx, tz_curve_reconstruct(ctx, &g, &s, &plain));
    ok(ctx, tz_curve_reconstruct_detail(ctx, &g, &x, &s, &detail));
    const double was = total_length(&s) / 400, is = total_length(&detail) / 440;
    near(is, was, 0.12 * was);
    assert_true(total_length(&plain) / 440 < 1 + 0.6 * (was - 1));
    /* from trough to crest, and the samples' own */
    assert_true(height_of(&detail) > 2 && height_of(&detail) < 5.5);

    is_smooth(&detail, 1e-6);
    assert_int_equal(detail.path.n, 1);
    tz_curve_set_deinit(&s);
    tz_curve_set_deinit(&plain);
    tz_curve_set_deinit(&detail);
    tz_sample_graph_deinit(&x);
    tz_sample_graph_deinit(&g);
}

/* Maps that are far from a motion: no loops, nothing far away. */
static void test_extremes(void **state)
{
    (void)state;
    tz_curve_set s, out;
    tz_sample_graph x, g;
    sine(ctx, 40, 12, 400, false, &s);
    ok(ctx, tz_sample_graph_make(ctx, &s, 12, 24, &x));
    for (uint64_t seed = 0; seed < 20; seed++) {
        tz_rng rng = tz_rng_make(seed, 2);
        ok(ctx, tz_sample_graph_make(ctx, &s, 12, 24, &g));
        self_like(&g, seed & 1);
        double chords = 0;
        for (int32_t i = 0; i < g.sample.n; i++)
            g.sample.v[i].at = (tz_vec2){tz_rng_range(&rng, 0, 400),
                                         tz_rng_range(&rng, 0, seed < 3 ? 1e-9 : 100)};
        for (int32_t i = 0; i < g.edge.n; i++) {
            const tz_vec2 p = g.sample.v[g.edge.v[i].from].at,
                          q = g.sample.v[g.edge.v[i].to].at;
            g.edge.v[i].like = (int32_t)tz_rng_below(&rng, x.edge.n + 1) - 1;
            chords += tz_vec2_length(tz_vec2_sub(p, q));
        }
        for (int32_t i = 0; i < g.turn.n; i++)
            g.turn.v[i] = tz_rng_range(&rng, 0, 6.28);
        ok(ctx, tz_sample_graph_link(&g));
        ok(ctx, tz_curve_reconstruct_detail(ctx, &g, &x, &s, &out));
        ok(ctx, tz_curve_set_check(ctx, &out, "out"));
        assert_true(total_length(&out) < 4 * chords + 1);
        tz_curve_set_deinit(&out);
        tz_sample_graph_deinit(&g);
    }
    ok(ctx, tz_sample_graph_make(ctx, &s, 12, 24, &g));
    g.edge.v[1].like = x.edge.n;
    fails(ctx, tz_curve_reconstruct_detail(ctx, &g, &x, &s, &out), TZ_INVALID, "edge 1");
    tz_sample_graph_deinit(&g);
    tz_sample_graph_deinit(&x);
    tz_curve_set_deinit(&s);
}

/* ---- the torus --------------------------------------------------------------------- */

static void shift(tz_curve_set *s, double x, double y)
{
    const tz_vec2 by = {x, y};
    for (int32_t i = 0; i < s->piece.n; i++) {
        tz_curve_piece *p = &s->piece.v[i];
        p->a = tz_vec2_add(p->a, by);
        p->b = tz_vec2_add(p->b, by);
    }
    for (int32_t i = 0; i < s->node.n; i++)
        s->node.v[i] = tz_vec2_add(s->node.v[i], by);
    tz_curve_wrap(s);
    ok(s->ctx, tz_curve_set_check(s->ctx, s, "shifted"));
}

/* A line that runs around: as many samples and as long wherever it begins. */
static void test_around(void **state)
{
    (void)state;
    for (int k = 0; k < 6; k++) {
        tz_curve_set s, out;
        tz_sample_graph x, g;
        sine(ctx, 80, 10, 320, true, &s);
        const double length = total_length(&s);
        shift(&s, 37.3 * k, -61.7 * k);
        near(total_length(&s), length, 1e-9 * length);
        ok(ctx, tz_sample_graph_make(ctx, &s, 25, 50, &x));
        ok(ctx, tz_sample_graph_make(ctx, &s, 25, 50, &g));
        ok(ctx, tz_sample_graph_check(ctx, &x, "graph"));
        assert_int_equal(x.sample.n, (int32_t)(length / 25 + 0.5));
        assert_int_equal(x.edge.n, x.sample.n);
        for (int32_t i = 0; i < x.sample.n; i++) {
            assert_int_equal(x.sample.v[i].links, 2);
            assert_true(x.sample.v[i].at.x >= 0 && x.sample.v[i].at.x < 320);
            assert_true(x.sample.v[i].at.y >= 0 && x.sample.v[i].at.y < 100);
        }
        self_like(&g, k & 1);
        ok(ctx, tz_sample_graph_link(&g));
        for (int detail = 0; detail < 2; detail++) {
            ok(ctx, detail ? tz_curve_reconstruct_detail(ctx, &g, &x, &s, &out)
                           : tz_curve_reconstruct(ctx, &g, &s, &out));
            ok(ctx, tz_curve_set_check(ctx, &out, "out"));
            assert_int_equal(out.path.n, 1);
            assert_true(out.path.v[0].closed);
            near(total_length(&out), length, detail ? 1e-6 * length : 0.01 * length);
            is_smooth(&out, 1e-3);
            tz_curve_set_deinit(&out);
        }
        tz_curve_set_deinit(&s);
        tz_sample_graph_deinit(&x);
        tz_sample_graph_deinit(&g);
    }
}

/* Lines that cross on a torus cross as often wherever its border lies. */
static void test_torus_join(void **state)
{
    (void)state;
    const tz_curve_join_params p = {.crossings = true, .reach = 0.1};
    int32_t nodes = 0;
    for (int k = 0; k < 8; k++) {
        tz_curve_set s, out, again;
        int32_t a, b;
        blank(ctx, 100, 80, true, &s);
        for (int i = 0; i < 12; i++) { /* lines longer than the torus is wide */
            const tz_vec2 at = {11.7 * i + 3, 17.3 * i + 1};
            ok(ctx, tz_curve_add_node(&s, at, &a));
            ok(ctx, tz_curve_add_node(&s, (tz_vec2){at.x + 41, at.y + 9.0 * i - 33}, &b));
            ok(ctx, tz_curve_begin(&s, 0));
            if (i % 2)
                ok(ctx, tz_curve_line(&s, a, b));
            else
                ok(ctx, tz_curve_cubic(&s, a, b, (tz_vec2){at.x + 20, at.y + 20},
                                       (tz_vec2){at.x + 30, at.y + 9.0 * i - 60}));
            tz_curve_end(&s, false);
        }
        shift(&s, 13.9 * k, 29.3 * k);
        ok(ctx, tz_curve_join(ctx, &s, &p, &out));
        ok(ctx, tz_curve_set_check(ctx, &out, "joined"));
        near(total_length(&out), total_length(&s), 1e-3 * total_length(&s));
        if (k == 0)
            nodes = out.node.n;
        assert_int_equal(out.node.n, nodes);
        assert_true(nodes > 30);
        ok(ctx, tz_curve_join(ctx, &out, &p, &again));
        assert_int_equal(again.node.n, nodes);
        assert_int_equal(again.piece.n, out.piece.n);
        tz_curve_set_deinit(&again);
        tz_curve_set_deinit(&out);
        tz_curve_set_deinit(&s);
    }
}

/* ---- the same bytes, and no memory --------------------------------------------------- */

static tz_status there_and_back(tz_ctx *c, tz_curve_set *out)
{
    tz_curve_set s;
    tz_sample_graph x = {0}, g = {0};
    int32_t pen;
    memset(out, 0, sizeof *out);
    s = (tz_curve_set){
        .ctx = c, .domain = {.size = {90, 60, 0}, .torus = true}, .element = {.ctx = c}};
    tz_status st = tz_curve_add_pen(&s, (tz_curve_pen){.width = 1, .color = 255}, &pen);
    int32_t a = 0, b = 0;
    if (st == TZ_OK)
        st = tz_curve_add_node(&s, (tz_vec2){80, 50}, &a);
    if (st == TZ_OK)
        st = tz_curve_add_node(&s, (tz_vec2){20, 10}, &b);
    if (st == TZ_OK)
        st = tz_curve_begin(&s, 0);
    if (st == TZ_OK)
        st = tz_curve_cubic(&s, a, b, (tz_vec2){90, 40}, (tz_vec2){100, 80});
    if (st == TZ_OK)
        st = tz_curve_line(&s, b, a);
    if (st == TZ_OK)
        tz_curve_end(&s, true);
    if (st == TZ_OK)
        st = tz_sample_graph_make(c, &s, 8, 16, &x);
    if (st == TZ_OK)
        st = tz_sample_graph_make(c, &s, 8, 16, &g);
    if (st == TZ_OK) {
        self_like(&g, false);
        st = tz_curve_reconstruct_detail(c, &g, &x, &s, out);
    }
    tz_sample_graph_deinit(&x);
    tz_sample_graph_deinit(&g);
    tz_curve_set_deinit(&s);
    return st;
}

static void test_same_bytes(void **state)
{
    (void)state;
    const int threads[3] = {1, 2, 8};
    tz_curve_set first = {0};
    tz_ctx *c[3];
    for (int k = 0; k < 3; k++) {
        tz_curve_set out;
        c[k] = new_ctx(threads[k]);
        ok(c[k], there_and_back(c[k], k ? &out : &first));
        if (k == 0)
            continue;
        assert_int_equal(out.piece.n, first.piece.n);
        assert_memory_equal(out.node.v, first.node.v,
                            (size_t)out.node.n * sizeof *out.node.v);
        for (int32_t i = 0; i < out.piece.n; i++) {
            assert_memory_equal(&out.piece.v[i].a, &first.piece.v[i].a, sizeof(tz_vec2));
            assert_memory_equal(&out.piece.v[i].b, &first.piece.v[i].b, sizeof(tz_vec2));
        }
        tz_curve_set_deinit(&out);
        end_ctx(c[k]);
    }
    tz_curve_set_deinit(&first);
    end_ctx(c[0]);
}

static tz_status run_once(tz_ctx *c)
{
    tz_curve_set out;
    const tz_status st = there_and_back(c, &out);
    tz_curve_set_deinit(&out);
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
        cmocka_unit_test_setup_teardown(test_identity, begin, end),
        cmocka_unit_test_setup_teardown(test_drawings, begin, end),
        cmocka_unit_test_setup_teardown(test_tapers, begin, end),
        cmocka_unit_test_setup_teardown(test_wiggles, begin, end),
        cmocka_unit_test_setup_teardown(test_extremes, begin, end),
        cmocka_unit_test_setup_teardown(test_around, begin, end),
        cmocka_unit_test_setup_teardown(test_torus_join, begin, end),
        cmocka_unit_test(test_same_bytes),
        cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
