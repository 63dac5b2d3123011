/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Likeness of samples and neighbourhoods. */
#include "tests/support/curve_fixture.h"

#include <math.h>

#include "base/rng.h"
#include "curves/matching.h"

static void near(double a, double b, double tolerance)
{
    if (!(fabs(a - b) <= tolerance))
        fail_msg("%.17g is not %.17g", a, b);
}

static tz_sample_graph empty(double side)
{
    return (tz_sample_graph){
        .ctx = ctx, .domain = {.size = {side, side, 0}}, .spacing = 10, .radius = 25};
}

static int32_t add(tz_sample_graph *g, double x, double y)
{
    ok(ctx, tz_array_push(
                ctx, &g->sample,
                ((tz_curve_sample){
                    .at = {x, y}, .q = TZ_SAMPLE_CURVE, .element = -1, .existence = 1})));
    return g->sample.n - 1;
}

static void join(tz_sample_graph *g, int32_t a, int32_t b)
{
    ok(ctx,
       tz_array_push(ctx, &g->edge,
                     ((tz_curve_edge){.from = a, .to = b, .existence = 1, .like = -1})));
}

/* A star: sample 0 with n edges of any lengths. */
static tz_sample_graph star(tz_rng *r, int32_t n)
{
    tz_sample_graph g = empty(100);
    add(&g, tz_rng_range(r, 40, 60), tz_rng_range(r, 40, 60));
    for (int32_t i = 0; i < n; i++) {
        add(&g, tz_rng_range(r, 20, 80), tz_rng_range(r, 20, 80));
        join(&g, 0, i + 1);
    }
    ok(ctx, tz_sample_graph_link(&g));
    return g;
}

/* Points at random with edges between near ones. */
static tz_sample_graph web(uint64_t seed, int32_t n, double side)
{
    tz_rng r = tz_rng_make(seed, 3);
    tz_sample_graph g = empty(side);
    for (int32_t i = 0; i < n; i++)
        add(&g, tz_rng_range(&r, 0, side), tz_rng_range(&r, 0, side));
    for (int32_t i = 0; i < n; i++)
        for (int32_t j = i + 1; j < n; j++)
            if (tz_vec2_length(tz_vec2_sub(g.sample.v[i].at, g.sample.v[j].at)) < 12)
                join(&g, i, j);
    ok(ctx, tz_sample_graph_link(&g));
    return g;
}

/* ---- edges and orientations -------------------------------------------------------- */

static double brute_edges(const tz_sample_graph *a, const tz_sample_graph *b, int32_t i,
                          uint32_t used, int32_t skips)
{
    const tz_curve_sample *p = &a->sample.v[0], *q = &b->sample.v[0];
    if (i == p->links)
        return 0;
    double best = INFINITY;
    if (skips > 0)
        best = brute_edges(a, b, i + 1, used, skips - 1);
    const tz_vec2 e = tz_vec2_sub(a->sample.v[a->link.v[p->link + i].to].at, p->at);
    for (int32_t j = 0; j < q->links; j++) {
        if (used >> j & 1)
            continue;
        const tz_vec2 f = tz_vec2_sub(b->sample.v[b->link.v[q->link + j].to].at, q->at);
        best = fmin(best, tz_vec2_length(tz_vec2_sub(e, f)) +
                              brute_edges(a, b, i + 1, used | 1u << j, skips));
    }
    return best;
}

static void test_edges(void **state)
{
    (void)state;
    tz_rng r = tz_rng_make(1, 1);
    for (int n = 0; n < 800; n++) {
        tz_sample_graph a = star(&r, tz_rng_below(&r, 7)),
                        b = star(&r, tz_rng_below(&r, 7));
        const int32_t na = a.sample.v[0].links, nb = b.sample.v[0].links;
        int32_t to[TZ_ASSIGN_MOST];
        const double d = tz_match_edges(&a, 0, &b, 0, 10, to);
        const double best = na == 0 ? 0
                                    : brute_edges(&a, &b, 0, 0, na > nb ? na - nb : 0) +
                                          10 * abs(na - nb);
        near(d, best, 1e-4 * (1 + best));
        int32_t pairs = 0;
        for (int32_t i = 0; i < na; i++) {
            assert_true(to[i] >= -1 && to[i] < nb);
            pairs += to[i] >= 0;
        }
        assert_int_equal(pairs, na < nb ? na : nb);
        if (na > 0 && nb > 0) /* the same from the other side */
            near(tz_match_edges(&b, 0, &a, 0, 10, NULL), d, 1e-4 * (1 + d));
        near(tz_match_edges(&a, 0, &a, 0, 10, NULL), 0, 1e-9);
        tz_sample_graph_deinit(&a);
        tz_sample_graph_deinit(&b);
    }
}

static double brute_turns(const double *a, int32_t n, const double *b, int32_t m,
                          int32_t i, uint32_t used, int32_t skips)
{
    double best = INFINITY;
    if (i == n)
        return 0;
    if (skips > 0)
        best = brute_turns(a, n, b, m, i + 1, used, skips - 1);
    for (int32_t j = 0; j < m; j++)
        if (!(used >> j & 1)) {
            const double d = fabs(a[i] - b[j]);
            best = fmin(best, fmin(d, 2 * TZ_PI - d) +
                                  brute_turns(a, n, b, m, i + 1, used | 1u << j, skips));
        }
    return best;
}

static void test_turns(void **state)
{
    (void)state;
    tz_rng r = tz_rng_make(2, 1);
    for (int k = 0; k < 1500; k++) {
        const int32_t n = tz_rng_below(&r, 7), m = tz_rng_below(&r, 7);
        double a[8], b[8];
        int32_t to[TZ_ASSIGN_MOST];
        for (int i = 0; i < 7; i++) {
            a[i] = tz_rng_range(&r, 0, 2 * TZ_PI);
            b[i] = tz_rng_range(&r, 0, 2 * TZ_PI);
        }
        const double best = brute_turns(a, n, b, m, 0, 0, n > m ? n - m : 0);
        near(tz_match_turns(a, n, b, m, to), best, 1e-5 * (1 + best));
    }
}

/* ---- neighbourhoods ---------------------------------------------------------------- */

static void test_hoods(void **state)
{
    (void)state;
    for (int torus = 0; torus < 2; torus++) {
        tz_sample_graph g = web(4, 300, 100);
        tz_match_hoods h;
        g.domain.torus = torus;
        ok(ctx, tz_match_hoods_make(ctx, &g, 12, &h));
        for (int32_t i = 0; i < g.sample.n; i++) {
            int32_t n = 0;
            for (int32_t j = 0; j < g.sample.n; j++) {
                const tz_vec2 p = g.sample.v[i].at, q = g.sample.v[j].at;
                const tz_vec3 v = tz_domain_vector(&g.domain, (tz_vec3){p.x, p.y, 0},
                                                   (tz_vec3){q.x, q.y, 0});
                n += j != i && v.x * v.x + v.y * v.y <= 144;
            }
            assert_int_equal(h.first[i + 1] - h.first[i], n < 64 ? n : 64);
            for (int32_t k = h.first[i] + 1; k < h.first[i + 1]; k++)
                assert_true(hypot((double)h.x[k - 1], (double)h.y[k - 1]) <=
                            hypot((double)h.x[k], (double)h.y[k]) + 1e-5);
        }
        tz_match_hoods_deinit(&h);
        tz_sample_graph_deinit(&g);
    }
}

/* What lies at a place of the graph itself matches it without any cost; what is moved
 * about costs no more than it was moved. */
static void test_self(void **state)
{
    (void)state;
    static tz_assign w;
    tz_sample_graph g = web(5, 200, 120), o = web(5, 200, 120);
    tz_rng r = tz_rng_make(6, 1);
    tz_matcher m;
    ok(ctx, tz_matcher_init(ctx, &g, &g, NULL, &m));
    for (int32_t i = 0; i < g.sample.n; i++) {
        assert_true(tz_match(&m, i, i, &w, false, INFINITY) <= 1e-4f);
        for (int32_t k = 0; k < w.rows; k++)
            assert_int_equal(w.to[k], k);
    }
    tz_matcher_deinit(&m);
    for (int32_t i = 0; i < o.sample.n; i++) {
        o.sample.v[i].at.x += tz_rng_range(&r, -0.1, 0.1);
        o.sample.v[i].at.y += tz_rng_range(&r, -0.1, 0.1);
    }
    const int32_t stranger = add(&o, 60.5, 59.5);
    ok(ctx, tz_sample_graph_link(&o));
    ok(ctx, tz_matcher_init(ctx, &o, &g, NULL, &m));
    for (int32_t i = 0; i < g.sample.n; i++) {
        const float cost = tz_match(&m, i, i, &w, false, INFINITY);
        double edges = 0;
        float exits = 0;
        for (int32_t k = 0; k < w.rows; k++) {
            const int32_t s = m.ho.id[m.ho.first[i] + k];
            edges += s == stranger ? 0 : o.sample.v[s].links;
            exits += w.to[k] < 0 ? w.exit[k] : 0;
        }
        edges += o.sample.v[i].links;
        /* 0.2 sqrt(2) each and half of that for each end of an edge */
        assert_true((double)cost <= 0.283 * (w.rows + 0.5 * edges) + 12 + (double)exits);
    }
    tz_matcher_deinit(&m);
    tz_sample_graph_deinit(&g);
    tz_sample_graph_deinit(&o);
}

/* Eq. (7) over all matchings there are. */
static double brute_match(const tz_matcher *m, int32_t so, int32_t si, int32_t k,
                          uint32_t used)
{
    const int32_t fo = m->ho.first[so], fi = m->hi.first[si];
    if (fo + k == m->ho.first[so + 1])
        return 0;
    const int32_t o = m->ho.id[fo + k];
    const int32_t n = m->o->sample.v[o].links;
    double best = fmin(2, 1.2 + 0.4 * n) * 10 + brute_match(m, so, si, k + 1, used);
    for (int32_t j = 0; fi + j < m->hi.first[si + 1]; j++) {
        if (used >> j & 1)
            continue;
        const int32_t i = m->hi.id[fi + j];
        const double d = hypot((double)m->ho.x[fo + k] - (double)m->hi.x[fi + j],
                               (double)m->ho.y[fo + k] - (double)m->hi.y[fi + j]);
        best = fmin(best, d + 0.5 * tz_match_edges(m->o, o, m->i, i, 10, NULL) +
                              brute_match(m, so, si, k + 1, used | 1u << j));
    }
    return best;
}

static void test_brute(void **state)
{
    (void)state;
    static tz_assign w;
    tz_sample_graph g = web(7, 40, 100), o = web(8, 40, 100);
    tz_matcher m;
    g.radius = 18;
    ok(ctx, tz_matcher_init(ctx, &o, &g, NULL, &m));
    int32_t tried = 0;
    for (int32_t so = 0; so < o.sample.n; so++)
        for (int32_t si = 0; si < g.sample.n; si++) {
            const int32_t n = m.ho.first[so + 1] - m.ho.first[so],
                          k = m.hi.first[si + 1] - m.hi.first[si];
            if (n > 5 || k > 6)
                continue;
            const double best = 0.5 * tz_match_edges(&o, so, &g, si, 10, NULL) +
                                brute_match(&m, so, si, 0, 0);
            const float cost = tz_match(&m, so, si, &w, false, INFINITY);
            near((double)cost, best, 1e-4 * (1 + best));
            assert_true(isinf(tz_match(&m, so, si, &w, false, cost * 0.99f)));
            near((double)tz_match(&m, so, si, &w, false, cost * 1.01f), best,
                 1e-4 * (1 + best));
            /* the same without the table */
            float *table = m.edges;
            m.edges = NULL;
            near((double)tz_match(&m, so, si, &w, true, INFINITY), best,
                 1e-4 * (1 + best));
            m.edges = table;
            tried++;
        }
    assert_true(tried > 200);
    tz_matcher_deinit(&m);
    tz_sample_graph_deinit(&g);
    tz_sample_graph_deinit(&o);
}

/* Samples of unlike q never match, and a fixed one must. */
static void test_kinds(void **state)
{
    (void)state;
    static tz_assign w;
    tz_sample_graph g = empty(100), o = empty(100);
    tz_matcher m;
    for (int k = 0; k < 2; k++) {
        tz_sample_graph *x = k ? &o : &g;
        add(x, 50, 50);
        add(x, 60, 50);
        ok(ctx, tz_sample_graph_link(x));
    }
    g.sample.v[1].q = 3;
    o.sample.v[1].q = 4;
    ok(ctx, tz_matcher_init(ctx, &o, &g, NULL, &m));
    near((double)tz_match(&m, 0, 0, &w, false, INFINITY), (double)m.exit[1], 1e-6);
    assert_int_equal(w.to[0], -1);
    assert_true(isinf(tz_match(&m, 1, 1, &w, false, INFINITY)));
    tz_matcher_deinit(&m);
    o.sample.v[1].fixed = true;
    ok(ctx, tz_matcher_init(ctx, &o, &g, NULL, &m));
    assert_true(isinf(tz_match(&m, 0, 0, &w, false, INFINITY)));
    tz_matcher_deinit(&m);
    o.sample.v[1].q = 3;
    ok(ctx, tz_matcher_init(ctx, &o, &g, NULL, &m));
    near((double)tz_match(&m, 0, 0, &w, false, INFINITY), 0, 1e-6);
    tz_matcher_deinit(&m);
    tz_sample_graph_deinit(&g);
    g = empty(100);
    fails(ctx, tz_matcher_init(ctx, &o, &g, NULL, &m), TZ_INVALID, "no samples");
    tz_sample_graph_deinit(&g);
    tz_sample_graph_deinit(&o);
}

static tz_status make_matcher(tz_ctx *c)
{
    tz_curve_sample sample[3] = {{.at = {1, 1}, .q = -1, .element = -1},
                                 {.at = {9, 1}, .q = -1, .element = -1},
                                 {.at = {9, 8}, .q = -1, .element = -1}};
    tz_sample_graph g = {.ctx = c,
                         .domain = {.size = {20, 20, 0}},
                         .spacing = 10,
                         .radius = 20,
                         .sample = {sample, 3, 3}};
    tz_matcher m;
    const tz_status s = tz_matcher_init(c, &g, &g, NULL, &m);
    tz_matcher_deinit(&m);
    return s;
}

static void test_memory(void **state)
{
    (void)state;
    survive(make_matcher, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_edges, begin, end),
        cmocka_unit_test_setup_teardown(test_turns, begin, end),
        cmocka_unit_test_setup_teardown(test_hoods, begin, end),
        cmocka_unit_test_setup_teardown(test_self, begin, end),
        cmocka_unit_test_setup_teardown(test_brute, begin, end),
        cmocka_unit_test_setup_teardown(test_kinds, begin, end),
        cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
