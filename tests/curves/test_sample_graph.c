/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Curves to samples and back. */
#include "tests/base/check.h"

#include <math.h>

#include "curves/curve_io.h"
#include "curves/reconstruct.h"

#define HEAD                                     \
    "<svg xmlns=\"http://www.w3.org/2000/svg\" " \
    "viewBox=\"0 0 375 375\"><g fill=\"none\" stroke=\"#204060\" stroke-width=\"2\">"
#define TAIL "</g></svg>"

static tz_ctx *ctx;
static tz_curve_set set;
static tz_sample_graph graph;

static int begin(void **state)
{
    (void)state;
    ctx = new_ctx(2);
    return 0;
}

static int end(void **state)
{
    (void)state;
    tz_sample_graph_deinit(&graph);
    tz_curve_set_deinit(&set);
    memset(&graph, 0, sizeof graph);
    memset(&set, 0, sizeof set);
    end_ctx(ctx);
    return 0;
}

static void sample(const char *text, double spacing, int32_t samples, int32_t edges)
{
    tz_sample_graph_deinit(&graph);
    tz_curve_set_deinit(&set);
    ok(ctx, tz_curve_parse_svg(ctx, "t.svg", text, strlen(text), NULL, &set));
    ok(ctx, tz_sample_graph_make(ctx, &set, spacing, 1.6 * spacing, &graph));
    ok(ctx, tz_sample_graph_check(ctx, &graph, "graph"));
    if (graph.sample.n != samples || graph.edge.n != edges)
        fail_msg("%d samples, %d edges in place of %d, %d in %s", graph.sample.n,
                 graph.edge.n, samples, edges, text);
    for (int32_t i = 0; i < graph.sample.n; i++) {
        const tz_curve_sample *p = &graph.sample.v[i];
        assert_int_equal(p->links, p->turns);
        assert_true(p->q == TZ_SAMPLE_CURVE && p->existence == 1);
    }
}

#define SAMPLE(body, samples, edges) sample(HEAD body TAIL, 25, samples, edges)

static double between(int32_t i, int32_t j)
{
    return tz_curve_angle_between(graph.turn.v[i], graph.turn.v[j]);
}

static void near(double a, double b, double tolerance)
{
    if (!(fabs(a - b) <= tolerance))
        fail_msg("%.17g is not %.17g", a, b);
}

static void test_samples(void **state)
{
    (void)state;
    SAMPLE("<path d='M50 50L150 50'/>", 5, 4); /* every 25 */
    near(graph.sample.v[0].at.x + graph.sample.v[1].at.x, 200, 1e-9);
    SAMPLE("<path d='M50 50L60 50'/>", 2, 1);          /* however short */
    SAMPLE("<path d='M50 50L150 50L150 150'/>", 9, 8); /* a corner is one */
    SAMPLE("<path d='M50 50L140 50'/><path d='M100 20L100 80'/>", 7, 6); /* a crossing */
    SAMPLE("<path d='M50 50L150 50'/><path d='M100 50L100 80'/>", 6, 5); /* a junction */
    /* a loop by itself: at least a triangle */
    SAMPLE("<circle cx='100' cy='100' r='40'/>", 10, 10);
    SAMPLE("<circle cx='100' cy='100' r='3'/>", 3, 3);
    /* two ways between the same junctions are told apart */
    SAMPLE("<path d='M50 50L60 50'/><path d='M50 50C52 54 58 54 60 50'/>", 3, 3);
    /* three at once */
    SAMPLE("<path d='M50 50L60 50M50 50C52 54 58 54 60 50M50 50C52 40 58 40 60 50'/>", 4,
           5);
}

static void test_turns(void **state)
{
    (void)state;
    SAMPLE("<circle cx='100' cy='100' r='40'/>", 10, 10);
    for (int32_t i = 0; i < graph.sample.n; i++) {
        const tz_curve_sample *p = &graph.sample.v[i];
        assert_int_equal(p->turns, 2);
        near(between(p->turn, p->turn + 1), TZ_PI, 1e-9);
        /* at right angles to the radius */
        const double a = tz_curve_angle(atan2(p->at.y - 100, p->at.x - 100));
        near(tz_curve_angle_between(a, graph.turn.v[p->turn]), TZ_PI / 2, 0.01);
        /* and on the side of its edge */
        for (int32_t k = 0; k < 2; k++) {
            const tz_vec2 q = graph.sample.v[graph.link.v[p->link + k].to].at;
            const double to = tz_curve_angle(atan2(q.y - p->at.y, q.x - p->at.x));
            assert_true(tz_curve_angle_between(to, graph.turn.v[p->turn + k]) < 0.4);
        }
    }
    SAMPLE("<path d='M100 50L100 100L150 100'/>", 5, 4);
    int32_t corners = 0;
    for (int32_t i = 0; i < graph.sample.n; i++) {
        const tz_curve_sample *p = &graph.sample.v[i];
        if (p->turns == 2 && between(p->turn, p->turn + 1) < 3) {
            near(between(p->turn, p->turn + 1), TZ_PI / 2, 1e-9);
            near(p->at.x, 100, 1e-9);
            near(p->at.y, 100, 1e-9);
            corners++;
        }
    }
    assert_int_equal(corners, 1);
}

static void test_bad(void **state)
{
    (void)state;
    tz_curve_set none = {.ctx = ctx, .domain = {.size = {10, 10, 0}}};
    tz_sample_graph g;
    fails(ctx, tz_sample_graph_make(ctx, &none, 1, 1, &g), TZ_INVALID, "nothing");
    fails(ctx, tz_sample_graph_make(ctx, &none, 0, 1, &g), TZ_INVALID, "spacing");
    fails(ctx, tz_sample_graph_make(ctx, &none, NAN, 1, &g), TZ_INVALID, "spacing");
    SAMPLE("<path d='M50 50L150 50'/>", 5, 4);
    fails(ctx, tz_sample_graph_make(ctx, &set, 1e-7, 1, &g), TZ_LIMIT, "4000000");
    assert_null(g.sample.v);
    graph.edge.v[1].pen = 7;
    tz_curve_set out;
    fails(ctx, tz_curve_reconstruct(ctx, &graph, &set, &out), TZ_INVALID, "pen");
    graph.edge.v[1].to = 99;
    fails(ctx, tz_sample_graph_link(&graph), TZ_INVALID, "edge 1");
}

/* ---- reconstruction ---------------------------------------------------------------- */

/* Distance of what comes back, both ways, as a share of the spacing. */
static void returns(const char *text, double spacing, double mean, double most,
                    int32_t paths)
{
    tz_curve_set out;
    double m[2], f[2];
    tz_sample_graph_deinit(&graph);
    tz_curve_set_deinit(&set);
    ok(ctx, tz_curve_parse_svg(ctx, "t.svg", text, strlen(text), NULL, &set));
    ok(ctx, tz_sample_graph_make(ctx, &set, spacing, 2 * spacing, &graph));
    ok(ctx, tz_curve_reconstruct(ctx, &graph, &set, &out));
    ok(ctx, tz_curve_set_check(ctx, &out, "out"));
    ok(ctx, tz_curve_distance(ctx, &set, &out, spacing / 40, &m[0], &f[0]));
    ok(ctx, tz_curve_distance(ctx, &out, &set, spacing / 40, &m[1], &f[1]));
    if (fmax(m[0], m[1]) > mean * spacing || fmax(f[0], f[1]) > most * spacing)
        fail_msg("%g mean, %g most of the spacing apart: %s", fmax(m[0], m[1]) / spacing,
                 fmax(f[0], f[1]) / spacing, text);
    if (paths > 0)
        assert_int_equal(out.path.n, paths);
    tz_curve_set_deinit(&out);
}

/* What is measured is a set of points an eightieth of the spacing apart: 0.007 at best.
 * */
static void test_returns(void **state)
{
    (void)state;
    returns(HEAD "<path d='M50 50L150 50L150 150'/>" TAIL, 25, 0.007, 0.01, 1);
    returns(HEAD "<path d='M50 50L150 60L120 150Z'/>" TAIL, 25, 0.007, 0.01, 1);
    returns(HEAD "<circle cx='100' cy='100' r='60'/>" TAIL, 25, 0.007, 0.01, 1);
    returns(HEAD "<circle cx='100' cy='100' r='15'/>" TAIL, 25, 0.008, 0.02, 1);
    returns(HEAD "<path d='M50 50L250 90M90 250L200 20M300 90L40 160'/>" TAIL, 25, 0.007,
            0.01, 3);
    returns(HEAD "<path d='M20 100C120 0 220 200 350 80'/>" TAIL, 25, 0.007, 0.02, 1);
    /* a smooth path through a junction is one, what joins it another */
    returns(HEAD
            "<path d='M20 100C120 50 220 50 350 100'/><path d='M185 62.5L185 300'/>" TAIL,
            25, 0.007, 0.02, 2);
    /* an eight */
    returns(HEAD "<path d='M187 187C20 20 20 354 187 187C354 20 354 354 187 187Z'/>" TAIL,
            25, 0.01, 0.04, 1);
}

static void test_drawings(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double mean;
    } list[] = {{"lattice_stained_glass", 0.01},
                {"network_streets_chicago", 0.01},
                {"network_circuit_board", 0.05},
                {"contours_topography", 0.05},
                {"wood_grain", 0.02}};
    for (size_t k = 0; k < sizeof list / sizeof *list; k++) {
        char path[200];
        tz_curve_set out;
        double mean, most;
        snprintf(path, sizeof path, "../shared/exemplars/svg/%s.svg", list[k].name);
        if (access(path, R_OK) != 0)
            continue;
        ok(ctx, tz_curve_read_svg(ctx, path, NULL, &set));
        const tz_sample_levels l = tz_sample_levels_default(&set);
        assert_int_equal(l.levels, 3);
        for (int i = 0; i < l.levels; i++) {
            ok(ctx, tz_sample_graph_make(ctx, &set, l.spacing[i], l.radius[i], &graph));
            ok(ctx, tz_sample_graph_check(ctx, &graph, path));
            ok(ctx, tz_curve_reconstruct(ctx, &graph, &set, &out));
            ok(ctx, tz_curve_distance(ctx, &set, &out, l.spacing[i] / 20, &mean, &most));
            if (mean > list[k].mean * l.spacing[i])
                fail_msg("%s: %g of the spacing apart", list[k].name,
                         mean / l.spacing[i]);
            tz_curve_set_deinit(&out);
            tz_sample_graph_deinit(&graph);
        }
        tz_curve_set_deinit(&set);
        memset(&set, 0, sizeof set);
        memset(&graph, 0, sizeof graph);
    }
}

/* Filled outlines of a line and of a ring come back as what they were. */
static void test_centre_lines(void **state)
{
    (void)state;
    static const char line[] =
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 100 100'>"
        "<path d='M10 48L60 48L60 20L64 20L64 52L10 52Z'/>"
        "<path fill='red' fill-rule='evenodd' d='M50 70a10 10 0 0 1 20 0a10 10 0 0 1 -20 "
        "0Z"
        "M52 70a8 8 0 0 1 16 0a8 8 0 0 1 -16 0Z'/><circle cx='20' cy='20' r='8'/></svg>";
    ok(ctx, tz_curve_parse_svg(ctx, "t.svg", line, sizeof line - 1, NULL, &set));
    assert_int_equal(set.path.n, 2);
    near(set.pen.v[set.path.v[0].pen].width, 4, 0.2);
    near(set.pen.v[set.path.v[1].pen].width, 2, 0.1);
    assert_false(set.path.v[0].closed);
    assert_true(set.path.v[1].closed);
    for (int32_t i = 0; i < set.piece.n; i++) {
        const tz_bezier b = tz_curve_bezier(&set, &set.piece.v[i]);
        for (int k = 0; k <= 4; k++) {
            const tz_vec2 p = tz_bezier_at(&b, k / 4.0);
            if (i >= set.path.v[1].piece)
                near(hypot(p.x - 60, p.y - 70), 9, 0.2);
            else
                near(fmin(fabs(p.y - 50), hypot(p.x - 62, fmax(0, p.y - 50))), 0, 0.8);
        }
    }
}

static void test_same_bytes(void **state)
{
    (void)state;
    static const char text[] = HEAD
        "<circle cx='100' cy='100' r='60'/><path d='M20 100C120 0 220 200 350 80'/>" TAIL;
    tz_sample_graph g[3];
    const int threads[3] = {1, 2, 8};
    tz_ctx *c[3];
    for (int k = 0; k < 3; k++) {
        tz_curve_set s;
        c[k] = new_ctx(threads[k]);
        ok(c[k], tz_curve_parse_svg(c[k], "t.svg", text, sizeof text - 1, NULL, &s));
        ok(c[k], tz_sample_graph_make(c[k], &s, 25, 40, &g[k]));
        tz_curve_set_deinit(&s);
    }
    for (int k = 1; k < 3; k++) {
        assert_int_equal(g[k].sample.n, g[0].sample.n);
        for (int32_t i = 0; i < g[0].sample.n; i++)
            assert_memory_equal(&g[k].sample.v[i].at, &g[0].sample.v[i].at,
                                sizeof(tz_vec2));
        assert_memory_equal(g[k].turn.v, g[0].turn.v,
                            (size_t)g[0].turn.n * sizeof *g[0].turn.v);
    }
    for (int k = 0; k < 3; k++) {
        tz_sample_graph_deinit(&g[k]);
        end_ctx(c[k]);
    }
}

static tz_status there_and_back(tz_ctx *c)
{
    static const char text[] = HEAD "<circle cx='100' cy='100' r='60'/>"
                                    "<path d='M20 100L350 80'/>"
                                    "<path stroke='none' fill='#123' "
                                    "d='M50 300L200 300L200 310L50 310Z'/>" TAIL;
    tz_curve_set s = {0}, out = {0};
    tz_sample_graph g = {0};
    tz_status st = tz_curve_parse_svg(c, "t.svg", text, sizeof text - 1, NULL, &s);
    if (st == TZ_OK)
        st = tz_sample_graph_make(c, &s, 40, 60, &g);
    if (st == TZ_OK)
        st = tz_curve_reconstruct(c, &g, &s, &out);
    tz_curve_set_deinit(&s);
    tz_curve_set_deinit(&out);
    tz_sample_graph_deinit(&g);
    return st;
}

static void test_memory(void **state)
{
    (void)state;
    survive(there_and_back, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_samples, begin, end),
        cmocka_unit_test_setup_teardown(test_turns, begin, end),
        cmocka_unit_test_setup_teardown(test_bad, begin, end),
        cmocka_unit_test_setup_teardown(test_returns, begin, end),
        cmocka_unit_test_setup_teardown(test_drawings, begin, end),
        cmocka_unit_test_setup_teardown(test_centre_lines, begin, end),
        cmocka_unit_test(test_same_bytes),
        cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
