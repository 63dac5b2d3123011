/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Curve textures by optimisation: what holds for any exemplar, and what must not break it.
 */
#include "tests/support/curve_fixture.h"

#include <math.h>

#include "curves/curve_io.h"
#include "curves/synthesis.h"

#define SVG(body)                                                                \
    "<svg xmlns='http://www.w3.org/2000/svg' width='100' height='100' "          \
    "viewBox='0 0 100 100'><g fill='none' stroke='black' stroke-width='1'>" body \
    "</g></svg>"

/* ---- exemplars ---------------------------------------------------------------------- */

static tz_curve_set parse(tz_ctx *c, const char *text)
{
    tz_curve_set s;
    ok(c, tz_curve_parse_svg(c, "test", text, strlen(text), NULL, &s));
    return s;
}

/* Lines every `step`, across if `cross`, else only level ones. */
static tz_curve_set lines(tz_ctx *c, double step, bool cross)
{
    tz_curve_set s = {.domain = {.size = {100, 100, 0}}, .ctx = c};
    const tz_curve_pen pen = {.width = 1, .color = 0xff};
    int32_t p, a, b;
    ok(c, tz_curve_add_pen(&s, pen, &p));
    for (int k = 0; k < 1 + cross; k++)
        for (double at = step / 2; at < 100; at += step) {
            ok(c, tz_curve_add_node(&s, k ? (tz_vec2){at, 0} : (tz_vec2){0, at}, &a));
            ok(c, tz_curve_add_node(&s, k ? (tz_vec2){at, 100} : (tz_vec2){100, at}, &b));
            ok(c, tz_curve_begin(&s, p));
            ok(c, tz_curve_line(&s, a, b));
            tz_curve_end(&s, false);
        }
    return s;
}

static tz_curve_synthesis_params params(void)
{
    tz_curve_synthesis_params p;
    tz_params_default(&tz_curve_synthesis_param_table, &p);
    return p;
}

static tz_status run(tz_ctx *c, const tz_curve_set *exemplar, const tz_domain *d,
                     const tz_curve_synthesis_params *p, tz_sample_graph *out,
                     tz_sample_graph *graph)
{
    const tz_curve_synthesis_job job = {
        .exemplar = exemplar, .domain = d, .params = p, .seed = 7};
    return tz_curve_synthesis(c, &job, out, graph, NULL);
}

/* Sound, and of the exemplar: edges tell what they are like. */
static void check_output(const tz_sample_graph *g, const tz_sample_graph *x)
{
    ok(ctx, tz_sample_graph_check(ctx, g, "out"));
    for (int32_t i = 0; i < g->edge.n; i++) {
        const tz_curve_edge *e = &g->edge.v[i];
        assert_true(e->like >= -1 && e->like < x->edge.n);
        assert_true(e->existence > 0 && e->existence <= 1);
        assert_true(e->from != e->to);
    }
    for (int32_t i = 0; i < g->sample.n; i++)
        assert_true(g->sample.v[i].links > 0 || g->sample.v[i].element >= 0);
}

/* Share of the length of all edges that runs within 0.2 of a direction. */
static double share_along(const tz_sample_graph *g, double angle)
{
    double along = 0, all = 0;
    for (int32_t i = 0; i < g->edge.n; i++) {
        const tz_vec2 p = g->sample.v[g->edge.v[i].from].at,
                      q = g->sample.v[g->edge.v[i].to].at;
        const tz_vec3 v =
            tz_domain_vector(&g->domain, (tz_vec3){p.x, p.y, 0}, (tz_vec3){q.x, q.y, 0});
        const double l = hypot(v.x, v.y);
        all += l;
        along += fabs(sin(atan2(v.y, v.x) - angle)) < 0.2 ? l : 0;
    }
    return all > 0 ? along / all : 0;
}

/* Length of edges inside the domain over its area; edges over the border count half. */
static double density(const tz_sample_graph *g)
{
    double sum = 0;
    for (int32_t i = 0; i < g->edge.n; i++) {
        const tz_vec2 p = g->sample.v[g->edge.v[i].from].at,
                      q = g->sample.v[g->edge.v[i].to].at;
        const tz_vec3 a = {p.x, p.y, 0}, b = {q.x, q.y, 0};
        const tz_vec3 v = tz_domain_vector(&g->domain, a, b);
        sum += hypot(v.x, v.y) * 0.5 *
               (tz_domain_contains(&g->domain, a) + tz_domain_contains(&g->domain, b));
    }
    return sum / (g->domain.size.x * g->domain.size.y);
}

/* ---- what holds ---------------------------------------------------------------------- */

/* Grids come back as grids, from any start, on a plane and on a torus. */
static void test_grid(void **state)
{
    (void)state;
    tz_curve_set s = lines(ctx, 20, true);
    for (int k = 0; k < 4; k++) {
        const tz_domain d = {.size = {200, 160, 0}, .torus = k & 1};
        tz_curve_synthesis_params p = params();
        tz_sample_graph g, x;
        p.start = k & 2 ? TZ_CURVE_NOISE : TZ_CURVE_PATCHES;
        ok(ctx, run(ctx, &s, &d, &p, &g, &x));
        check_output(&g, &x);
        const double likes = density(&g) / 0.1;
        const double square = share_along(&g, 0) + share_along(&g, TZ_PI / 2);
        if (p.start == TZ_CURVE_PATCHES) {
            assert_true(likes > 0.85 && likes < 1.15);
            assert_true(square > 0.7);
        } else {
            assert_true(likes > 0.6 && likes < 1.4);
        }
        tz_sample_graph_deinit(&g);
        tz_sample_graph_deinit(&x);
    }
    tz_curve_set_deinit(&s);
}

/* The exemplar's own curves, with origins, are as they should be: nothing of them moves
 * away from the border. */
static void test_given_stays(void **state)
{
    (void)state;
    tz_curve_set s = lines(ctx, 20, true), start = lines(ctx, 20, true);
    for (int32_t i = 0; i < start.piece.n; i++)
        ok(ctx,
           tz_array_push(ctx, &start.origin, tz_curve_bezier(&start, &start.piece.v[i])));
    tz_curve_synthesis_params p = params();
    tz_sample_graph g, x;
    p.start = TZ_CURVE_GIVEN;
    p.levels = 1;
    const tz_curve_synthesis_job job = {
        .exemplar = &s, .domain = &s.domain, .start = &start, .params = &p};
    ok(ctx, tz_curve_synthesis(ctx, &job, &g, &x, NULL));
    check_output(&g, &x);
    int32_t found = 0, all = 0;
    for (int32_t i = 0; i < x.sample.n; i++) {
        const tz_vec2 at = x.sample.v[i].at;
        if (fmin(fmin(at.x, at.y), fmin(100 - at.x, 100 - at.y)) < 25)
            continue;
        all++;
        for (int32_t j = 0; j < g.sample.n; j++)
            if (tz_vec2_length(tz_vec2_sub(g.sample.v[j].at, at)) < 1e-3 &&
                g.sample.v[j].links == x.sample.v[i].links) {
                found++;
                break;
            }
    }
    assert_true(all > 4);
    assert_int_equal(found, all);
    tz_sample_graph_deinit(&g);
    tz_sample_graph_deinit(&x);
    tz_curve_set_deinit(&s);
    tz_curve_set_deinit(&start);
}

/* What is drawn already stays to the bit, with its edges. */
static void test_fixed(void **state)
{
    (void)state;
    tz_curve_set s = lines(ctx, 20, true),
                 given = parse(ctx, SVG("<path d='M50 90H150'/>"));
    const tz_domain d = {.size = {200, 160, 0}};
    tz_sample_graph g;
    const tz_curve_synthesis_job job = {.exemplar = &s, .domain = &d, .given = &given};
    ok(ctx, tz_curve_synthesis(ctx, &job, &g, NULL, NULL));
    ok(ctx, tz_sample_graph_check(ctx, &g, "out"));
    double length = 0;
    for (int32_t i = 0; i < g.sample.n; i++)
        if (g.sample.v[i].fixed)
            assert_true(fabs(g.sample.v[i].at.y - 90) < 1e-9);
    for (int32_t i = 0; i < g.edge.n; i++) {
        const tz_curve_sample *a = &g.sample.v[g.edge.v[i].from],
                              *b = &g.sample.v[g.edge.v[i].to];
        length += a->fixed && b->fixed ? fabs(a->at.x - b->at.x) : 0;
    }
    assert_true(fabs(length - 100) < 1e-6);
    tz_sample_graph_deinit(&g);
    tz_curve_set_deinit(&s);
    tz_curve_set_deinit(&given);
}

/* Level lines stand upright where the frame says so. */
static void test_frames(void **state)
{
    (void)state;
    tz_curve_set s = lines(ctx, 10, false);
    const tz_vec3 size = {150, 150, 0};
    for (int k = 0; k < 2; k++) {
        tz_frames *f = NULL;
        tz_sample_graph g, x;
        ok(ctx, tz_frames_from_formula(ctx, k ? "90" : "0", size, false, &f));
        const tz_domain d = {.size = size, .frames = f};
        ok(ctx, run(ctx, &s, &d, NULL, &g, &x));
        check_output(&g, &x);
        assert_true(share_along(&g, k * TZ_PI / 2) > 0.9);
        tz_frames_free(f);
        tz_sample_graph_deinit(&g);
        tz_sample_graph_deinit(&x);
    }
    tz_curve_set_deinit(&s);
}

/* Lines run over a region's border, but no farther than an edge. */
static void test_region(void **state)
{
    (void)state;
    enum { N = 64 };
    static float mask[N * N];
    for (int i = 0; i < N * N; i++)
        mask[i] = hypot(i % N - 31.5, i / N - 31.5) < 24 ? 1 : 0;
    tz_curve_set s = lines(ctx, 20, true);
    tz_region *r = NULL;
    tz_sample_graph g, x;
    const tz_vec3 size = {240, 240, 0};
    ok(ctx, tz_region_from_mask(ctx, mask, N, N, size, false, &r));
    const tz_domain d = {.size = size, .region = r};
    ok(ctx, run(ctx, &s, &d, NULL, &g, &x));
    check_output(&g, &x);
    int32_t inside = 0;
    for (int32_t i = 0; i < g.sample.n; i++) {
        const double depth =
            tz_domain_depth(&d, (tz_vec3){g.sample.v[i].at.x, g.sample.v[i].at.y, 0});
        inside += depth > 0;
        assert_true(depth > -2.2 * g.spacing);
    }
    assert_true(inside > 50);
    tz_region_free(r);
    tz_sample_graph_deinit(&g);
    tz_sample_graph_deinit(&x);
    tz_curve_set_deinit(&s);
}

/* ---- the steps ----------------------------------------------------------------------- */

typedef struct seen {
    double first[TZ_SAMPLE_LEVELS], last[TZ_SAMPLE_LEVELS];
    int32_t least, most, calls;
} seen;

static void watch(void *user, const tz_curve_energy *e, const tz_sample_graph *g)
{
    seen *k = user;
    if (e->iteration == 0)
        k->first[e->level] = e->mean;
    k->last[e->level] = e->mean;
    k->least = k->calls == 0 || e->samples < k->least ? e->samples : k->least;
    k->most = e->samples > k->most ? e->samples : k->most;
    k->calls++;
    assert_true(e->match >= 0 && e->domain >= 0 && g->sample.n >= 0);
}

/* From noise the energy comes down; without existence the number of samples on a
 * torus stays as it was. */
static void test_energy(void **state)
{
    (void)state;
    tz_curve_set s = lines(ctx, 20, true);
    const tz_domain d = {.size = {200, 160, 0}, .torus = true};
    for (int k = 0; k < 2; k++) {
        seen e = {{0}, {0}, 0, 0, 0};
        tz_curve_synthesis_params p = params();
        tz_sample_graph g;
        p.start = TZ_CURVE_NOISE;
        p.existence = k == 0;
        p.levels = 1 + 2 * (k == 0);
        const tz_curve_synthesis_job job = {.exemplar = &s,
                                            .domain = &d,
                                            .params = &p,
                                            .seed = 3,
                                            .trace = watch,
                                            .user = &e};
        ok(ctx, tz_curve_synthesis(ctx, &job, &g, NULL, NULL));
        assert_int_equal(e.calls, p.levels * p.iterations);
        if (k == 0)
            assert_true(e.last[2] < 0.5 * e.first[0] && e.last[2] < e.first[2]);
        if (k == 1)
            assert_int_equal(e.least, e.most);
        tz_sample_graph_deinit(&g);
    }
    tz_curve_set_deinit(&s);
}

static void test_switches(void **state)
{
    (void)state;
    tz_curve_set s = lines(ctx, 20, true);
    const tz_domain d = {.size = {150, 150, 0}};
    for (int k = 0; k < 8; k++) {
        tz_curve_synthesis_params p = params();
        tz_sample_graph g, x;
        p.edges = !(k & 1);
        p.robust = !(k & 2);
        p.existence = !(k & 4);
        ok(ctx, run(ctx, &s, &d, &p, &g, &x));
        check_output(&g, &x);
        tz_sample_graph_deinit(&g);
        tz_sample_graph_deinit(&x);
    }
    tz_curve_set_deinit(&s);
}

/* ---- elements ------------------------------------------------------------------------ */

/* Elements come as wholes, each once where its samples are. */
static void test_elements(void **state)
{
    (void)state;
    tz_curve_set s = lines(ctx, 20, true);
    tz_element_set *e = &s.element;
    e->ctx = ctx;
    e->domain = s.domain;
    char *name = NULL, *id = NULL, *markup = NULL;
    ok(ctx, tz_strdup(ctx, "dot", &name));
    ok(ctx, tz_strdup(ctx, "dot", &id));
    ok(ctx, tz_strdup(ctx, "", &markup));
    ok(ctx, tz_array_push(ctx, &e->kind, ((tz_element_kind){.name = name})));
    ok(ctx, tz_array_push(ctx, &e->symbol,
                          ((tz_element_symbol){
                              .id = id, .markup = markup, .radius = 3, .photo = -1})));
    for (int i = 0; i < 16; i++) {
        const tz_vec3 at = {20 + 20 * (i % 4), 20 + 20 * (i / 4), 0};
        ok(ctx, tz_array_push(ctx, &e->sample, ((tz_sample){.at = at, .weight = 1})));
        ok(ctx, tz_array_push(ctx, &e->element,
                              ((tz_element){.source = -1,
                                            .sample = i,
                                            .samples = 1,
                                            .at = at,
                                            .scale = 1,
                                            .radius = 3})));
    }
    const tz_domain d = {.size = {200, 200, 0}, .torus = true};
    tz_sample_graph g;
    tz_element_set out;
    const tz_curve_synthesis_job job = {.exemplar = &s, .domain = &d, .seed = 5};
    ok(ctx, tz_curve_synthesis(ctx, &job, &g, NULL, &out));
    ok(ctx, tz_element_set_check(ctx, &out, "elements"));
    assert_true(out.element.n > 30 && out.element.n < 140);
    int32_t samples = 0;
    for (int32_t i = 0; i < g.sample.n; i++)
        samples += g.sample.v[i].element >= 0;
    assert_int_equal(samples, out.element.n);
    tz_element_set_deinit(&out);
    tz_sample_graph_deinit(&g);
    tz_curve_set_deinit(&s);
}

/* ---- any number of threads ------------------------------------------------------------ */

static void test_threads(void **state)
{
    (void)state;
    static const int threads[] = {1, 2, 8};
    for (int start = 0; start < 2; start++) {
        tz_sample_graph g[3];
        tz_ctx *c[3];
        for (int k = 0; k < 3; k++) {
            c[k] = new_ctx(threads[k]);
            tz_curve_set s = lines(c[k], 12, true);
            const tz_domain d = {.size = {300, 250, 0}};
            tz_curve_synthesis_params p = params();
            p.start = start;
            ok(c[k], run(c[k], &s, &d, &p, &g[k], NULL));
            tz_curve_set_deinit(&s);
        }
        for (int k = 1; k < 3; k++) {
            assert_int_equal(g[k].sample.n, g[0].sample.n);
            assert_int_equal(g[k].edge.n, g[0].edge.n);
            assert_int_equal(g[k].turn.n, g[0].turn.n);
            for (int32_t i = 0; i < g[0].sample.n; i++)
                assert_memory_equal(&g[k].sample.v[i].at, &g[0].sample.v[i].at,
                                    sizeof(tz_vec2));
            for (int32_t i = 0; i < g[0].edge.n; i++) {
                assert_int_equal(g[k].edge.v[i].from, g[0].edge.v[i].from);
                assert_int_equal(g[k].edge.v[i].to, g[0].edge.v[i].to);
                assert_int_equal(g[k].edge.v[i].like, g[0].edge.v[i].like);
            }
            assert_memory_equal(g[k].turn.v, g[0].turn.v,
                                (size_t)g[0].turn.n * sizeof *g[0].turn.v);
        }
        for (int k = 0; k < 3; k++) {
            tz_sample_graph_deinit(&g[k]);
            end_ctx(c[k]);
        }
    }
}

/* ---- what must not break it ------------------------------------------------------------ */

static void test_odd(void **state)
{
    (void)state;
    static const char *const body[] = {
        SVG("<path d='M10 50H90'/>"),                         /* one line */
        SVG("<circle cx='50' cy='50' r='20'/>"),              /* a loop alone */
        SVG("<path d='M10 10L90 90L10 90L90 10Z'/>"),         /* crosses itself */
        SVG("<path d='M10 50H90M10 50H90M10 50H90'/>"),       /* thrice the same */
        SVG("<path d='M50 50h0.001M20 20h1e-9M5 5L95 95'/>"), /* next to nothing */
        SVG("<path d='M0 0H100V100H0Z'/>"),                   /* nothing but border */
        SVG("<path d='M50 50l.1 .1 .1 -.1 .1 .1 .1 -.1 .1 .1'/>"),
    };
    static const double size[][2] = {{100, 100}, {3, 2}, {400, 1}, {250, 180}};
    for (size_t i = 0; i < sizeof body / sizeof body[0]; i++) {
        tz_curve_set s = parse(ctx, body[i]);
        for (size_t k = 0; k < 8; k++) {
            const tz_domain d = {.size = {size[k / 2][0], size[k / 2][1], 0},
                                 .torus = k & 1};
            tz_curve_synthesis_params p = params();
            tz_sample_graph g, x;
            p.start = (int32_t)(i + k) % 2;
            p.scale = k == 3 ? 0.1 : k == 5 ? 10 : 1;
            ok(ctx, run(ctx, &s, &d, &p, &g, &x));
            check_output(&g, &x);
            tz_sample_graph_deinit(&g);
            tz_sample_graph_deinit(&x);
        }
        tz_curve_set_deinit(&s);
    }
}

static void test_refused(void **state)
{
    (void)state;
    tz_curve_set s = lines(ctx, 20, true), none = {.domain = s.domain, .ctx = ctx};
    tz_domain d = {.size = {100, 100, 0}};
    tz_curve_synthesis_params p = params();
    tz_sample_graph g, x;
    fails(ctx, run(ctx, &none, &d, &p, &g, &x), TZ_INVALID, "nothing to sample");
    assert_true(g.sample.n == 0 && x.sample.n == 0);
    d.size.x = 0;
    fails(ctx, run(ctx, &s, &d, &p, &g, &x), TZ_INVALID, "no area");
    d.size.x = NAN;
    fails(ctx, run(ctx, &s, &d, &p, &g, &x), TZ_INVALID, "no area");
    d.size.x = 1e9, d.size.y = 1e9;
    fails(ctx, run(ctx, &s, &d, &p, &g, &x), TZ_LIMIT, "smaller");
    p.start = TZ_CURVE_NOISE;
    fails(ctx, run(ctx, &s, &d, &p, &g, &x), TZ_LIMIT, "smaller");
    d.size = (tz_vec3){100, 100, 0};
    p.start = TZ_CURVE_GIVEN;
    fails(ctx, run(ctx, &s, &d, &p, &g, &x), TZ_INVALID, "no curves to start from");
    p = params();
    p.scale = NAN;
    fails(ctx, run(ctx, &s, &d, &p, &g, &x), TZ_INVALID, "scale");
    tz_curve_set_deinit(&s);
}

/* An empty start is no fault: there is just nothing yet. */
static void test_empty_start(void **state)
{
    (void)state;
    tz_curve_set s = lines(ctx, 20, true), none = {.domain = s.domain, .ctx = ctx};
    tz_curve_synthesis_params p = params();
    tz_sample_graph g;
    p.start = TZ_CURVE_GIVEN;
    const tz_curve_synthesis_job job = {
        .exemplar = &s, .domain = &s.domain, .start = &none, .params = &p};
    ok(ctx, tz_curve_synthesis(ctx, &job, &g, NULL, NULL));
    assert_int_equal(g.edge.n, 0);
    tz_sample_graph_deinit(&g);
    tz_curve_set_deinit(&s);
}

static void stop_it(void *user, const tz_curve_energy *e, const tz_sample_graph *g)
{
    (void)e, (void)g;
    tz_ctx_cancel(user);
}

static void test_cancel(void **state)
{
    (void)state;
    tz_curve_set s = lines(ctx, 20, true);
    tz_sample_graph g;
    const tz_curve_synthesis_job job = {
        .exemplar = &s, .domain = &s.domain, .trace = stop_it, .user = ctx};
    assert_int_equal(tz_curve_synthesis(ctx, &job, &g, NULL, NULL), TZ_CANCELLED);
    assert_int_equal(g.sample.n, 0);
    tz_ctx_clear(ctx);
    tz_curve_set_deinit(&s);
}

static tz_status small_job(tz_ctx *c)
{
    tz_vec2 node[4] = {{0, 25}, {50, 25}, {25, 0}, {25, 50}};
    tz_curve_piece piece[2];
    tz_curve_path path[2] = {{.piece = 0, .pieces = 1}, {.piece = 1, .pieces = 1}};
    tz_curve_pen pen = {.width = 1, .color = 0xff};
    for (int i = 0; i < 2; i++) {
        const tz_bezier b = tz_bezier_line(node[2 * i], node[2 * i + 1]);
        piece[i] = (tz_curve_piece){2 * i, 2 * i + 1, b.p[1], b.p[2], true};
    }
    const tz_curve_set s = {.domain = {.size = {50, 50, 0}},
                            .node = {node, 4, 4},
                            .piece = {piece, 2, 2},
                            .path = {path, 2, 2},
                            .pen = {&pen, 1, 1},
                            .ctx = c};
    tz_curve_synthesis_params p = params();
    tz_sample_graph g, x;
    tz_element_set e;
    p.iterations = 2;
    p.levels = 2;
    const tz_curve_synthesis_job job = {
        .exemplar = &s, .domain = &s.domain, .params = &p, .seed = 1};
    const tz_status st = tz_curve_synthesis(c, &job, &g, &x, &e);
    tz_sample_graph_deinit(&g);
    tz_sample_graph_deinit(&x);
    tz_element_set_deinit(&e);
    return st;
}

static void test_memory(void **state)
{
    (void)state;
    survive(small_job, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_grid, begin, end),
        cmocka_unit_test_setup_teardown(test_given_stays, begin, end),
        cmocka_unit_test_setup_teardown(test_fixed, begin, end),
        cmocka_unit_test_setup_teardown(test_frames, begin, end),
        cmocka_unit_test_setup_teardown(test_region, begin, end),
        cmocka_unit_test_setup_teardown(test_energy, begin, end),
        cmocka_unit_test_setup_teardown(test_switches, begin, end),
        cmocka_unit_test_setup_teardown(test_elements, begin, end),
        cmocka_unit_test_setup_teardown(test_odd, begin, end),
        cmocka_unit_test_setup_teardown(test_refused, begin, end),
        cmocka_unit_test_setup_teardown(test_empty_start, begin, end),
        cmocka_unit_test_setup_teardown(test_cancel, begin, end),
        cmocka_unit_test(test_threads),
        cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
