/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Region growing: what grows is like its exemplar, whatever the exemplar is. */
#include "tests/base/check.h"

#include "base/rng.h"
#include "elements/growth.h"
#include "tests/support/elements.h"

static tz_growth_params params(void)
{
    tz_growth_params p;
    memset(&p, 0, sizeof p);
    tz_params_default(&tz_growth_param_table, &p);
    return p;
}

static tz_status run(tz_ctx *ctx, const tz_element_set *ex, const tz_growth_params *p,
                     int32_t budget, tz_element_set *out)
{
    tz_growth *g = NULL;
    bool more = true;
    tz_status s = tz_growth_begin(ctx, ex, p, out, &g);
    for (int32_t k = 0; s == TZ_OK && more; k++) {
        s = tz_growth_step(g, budget, &more);
        if (s == TZ_OK)
            ok(ctx, tz_element_set_check(ctx, out, "output"));
        assert_true(k < 1000000);
    }
    if (s == TZ_OK) { /* the end stays the end */
        ok(ctx, tz_growth_step(g, budget, &more));
        assert_false(more);
    }
    tz_growth_end(g);
    return s;
}

static void grow(tz_ctx *ctx, const tz_element_set *ex, const tz_growth_params *p,
                 double width, double height, bool torus, tz_element_set *out)
{
    const tz_domain d = {.size = {width, height, 0}, .torus = torus};
    ok(ctx, tz_element_set_like(ctx, ex, &d, out));
    ok(ctx, run(ctx, ex, p, 100000, out));
}

/* ---- statistics ------------------------------------------------------------------ */

/* Distances to the nearest, away from the border by `rim`: mean, deviation, least. */
typedef struct spread {
    double mean, deviation, least, density;
    int32_t n;
} spread;

static spread measure(const tz_element_set *s, double rim)
{
    const tz_vec3 size = s->domain.size;
    spread m = {.least = INFINITY};
    double sum = 0, squares = 0;
    for (int32_t i = 0; i < s->element.n; i++) {
        const tz_vec3 p = s->element.v[i].at;
        double d = INFINITY;
        if (p.x < rim || p.y < rim || p.x >= size.x - rim || p.y >= size.y - rim)
            continue;
        for (int32_t j = 0; j < s->element.n; j++) {
            const tz_vec3 v = tz_domain_vector(&s->domain, p, s->element.v[j].at);
            if (j != i)
                d = fmin(d, v.x * v.x + v.y * v.y);
        }
        d = sqrt(d);
        sum += d, squares += d * d;
        m.least = fmin(m.least, d);
        m.n++;
    }
    m.mean = sum / m.n;
    m.deviation = sqrt(fmax(0, squares / m.n - m.mean * m.mean));
    m.density = m.n / ((size.x - 2 * rim) * (size.y - 2 * rim));
    return m;
}

static double share(const tz_element_set *s, int32_t kind)
{
    int32_t n = 0;
    for (int32_t i = 0; i < s->element.n; i++)
        n += s->element.v[i].kind == kind;
    return (double)n / s->element.n;
}

/* Least share of the sum of radii that lies between two elements. */
static double closest(const tz_element_set *s)
{
    double least = INFINITY;
    for (int32_t i = 0; i < s->element.n; i++)
        for (int32_t j = 0; j < i; j++) {
            const tz_element *a = &s->element.v[i], *b = &s->element.v[j];
            const tz_vec3 v = tz_domain_vector(&s->domain, a->at, b->at);
            least = fmin(least, hypot(v.x, v.y) / (a->radius + b->radius));
        }
    return least;
}

static uint64_t digest(const tz_element_set *s)
{
    uint64_t h = 14695981039346656037u;
    for (int32_t i = 0; i < s->element.n; i++) {
        const tz_element *e = &s->element.v[i];
        uint64_t word[4] = {(uint64_t)e->source, (uint64_t)e->kind, 0, 0};
        memcpy(&word[2], &e->at.x, 8);
        memcpy(&word[3], &e->at.y, 8);
        for (int k = 0; k < 4; k++)
            h = (h ^ word[k]) * 1099511628211u;
    }
    return h ^ (uint64_t)s->element.n;
}

static void near(double got, double wanted, double share_off)
{
    if (!(fabs(got - wanted) <= share_off * wanted))
        fail_msg("%g in place of %g", got, wanted);
}

/* ---- textures -------------------------------------------------------------------- */

static void test_hexagons(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    for (int32_t k = 0; k < 12; k++) {
        tz_element_set ex, out;
        tz_growth_params p = params();
        p.seed = (uint64_t)k;
        p.rings = 1 + k % 3;
        p.optimise = k / 3 % 3;
        const double jitter = k < 6 ? 0 : 0.35;
        ok(ctx, drawn_hexagons(ctx, 9, 8, jitter, k % 2, &ex));
        grow(ctx, &ex, &p, 300, 280, false, &out);
        const spread m = measure(&out, 20);
        near(m.density, 1 / (10 * 5 * sqrt(3)), 0.05);
        assert_true(m.deviation < (jitter > 0 ? 0.1 : 0.001) * m.mean);
        assert_true(closest(&out) >= 0.97 * closest(&ex) - 1e-6);
        tz_element_set_deinit(&ex);
        tz_element_set_deinit(&out);
    }
    end_ctx(ctx);
}

static void test_squares(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    const tz_growth_params p = params();
    for (int32_t kinds = 1; kinds <= 2; kinds++) {
        tz_element_set ex, out;
        ok(ctx, drawn_squares(ctx, 8, kinds, false, &ex));
        grow(ctx, &ex, &p, 300, 250, false, &out);
        const spread m = measure(&out, 20);
        near(m.density, 0.01, 0.05);
        assert_true(m.deviation < 0.001 * m.mean);
        near(share(&out, 0), kinds == 1 ? 1 : 0.5, 0.05);
        /* a checkerboard: no two of a kind side by side */
        for (int32_t i = 0; i < out.element.n; i++)
            for (int32_t j = 0; j < i && kinds == 2; j++) {
                const tz_element *a = &out.element.v[i], *b = &out.element.v[j];
                if (hypot(a->at.x - b->at.x, a->at.y - b->at.y) < 12)
                    assert_int_not_equal(a->kind, b->kind);
            }
        tz_element_set_deinit(&ex);
        tz_element_set_deinit(&out);
    }
    end_ctx(ctx);
}

static void test_darts(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    for (int32_t k = 0; k < 4; k++) {
        tz_element_set ex, out;
        tz_growth_params p = params();
        p.seed = (uint64_t)(k + 1);
        ok(ctx, drawn_darts(ctx, 150, 8, 300, 3, k % 2, &ex));
        grow(ctx, &ex, &p, 450, 400, k / 2, &out);
        const spread a = measure(&ex, k % 2 ? 0 : 15), b = measure(&out, 15);
        near(b.density, ex.element.n / 22500.0, 0.05);
        near(b.mean, a.mean, 0.05);
        assert_true(closest(&out) >= 0.96 * closest(&ex));
        for (int32_t kind = 0; kind < 3; kind++)
            near(share(&out, kind), share(&ex, kind), 0.05);
        tz_element_set_deinit(&ex);
        tz_element_set_deinit(&out);
    }
    end_ctx(ctx);
}

/* An exemplar that wraps is not laid side by side as it is. */
static void test_no_tiles(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set ex, out;
    const tz_growth_params p = params();
    int32_t repeated = 0, of = 0;
    ok(ctx, drawn_darts(ctx, 150, 8, 300, 1, true, &ex));
    grow(ctx, &ex, &p, 600, 450, false, &out);
    for (int32_t i = 0; i < out.element.n; i++) {
        const tz_element *e = &out.element.v[i];
        of += e->at.x < 450;
        for (int32_t j = 0; j < out.element.n && e->at.x < 450; j++) {
            const tz_element *o = &out.element.v[j];
            repeated += o->source == e->source &&
                        hypot(o->at.x - e->at.x - 150, o->at.y - e->at.y) < 1;
        }
    }
    assert_true(repeated < 0.1 * of);
    tz_element_set_deinit(&ex);
    tz_element_set_deinit(&out);
    end_ctx(ctx);
}

static void test_mixed_sizes(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set ex, out;
    const tz_growth_params p = params();
    ok(ctx, drawn_mixed(ctx, 200, true, &ex));
    grow(ctx, &ex, &p, 500, 500, true, &out);
    near(out.element.n / 250000.0, ex.element.n / 40000.0, 0.05);
    near(share(&out, 1), share(&ex, 1), 0.05);
    assert_true(closest(&out) >= 0.96 * closest(&ex));
    tz_element_set_deinit(&ex);
    tz_element_set_deinit(&out);
    end_ctx(ctx);
}

/* Logs lie in both directions; the paper's choice lets one win. */
static void test_orientations(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set ex, out;
    const tz_growth_params p = params();
    tz_rng r = tz_rng_make(4, 4);
    ok(ctx, drawn_darts(ctx, 200, 14, 150, 1, true, &ex));
    ex.kind.v[0].oriented = true;
    int32_t across[2] = {0, 0};
    for (int32_t i = 0; i < ex.element.n; i++) {
        const bool a = tz_rng_below(&r, 3) == 0;
        ex.element.v[i].angle = a ? TZ_PI / 2 : 0;
        across[0] += a;
    }
    grow(ctx, &ex, &p, 600, 600, true, &out);
    for (int32_t i = 0; i < out.element.n; i++)
        across[1] += out.element.v[i].angle > 1;
    near((double)across[1] / out.element.n, (double)across[0] / ex.element.n, 0.05);
    tz_element_set_deinit(&ex);
    tz_element_set_deinit(&out);
    end_ctx(ctx);
}

/* ---- odd exemplars and domains --------------------------------------------------- */

static void test_few(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    const tz_growth_params p = params();
    for (int32_t n = 1; n <= 6; n++)
        for (int32_t same = 0; same < 2; same++) {
            tz_element_set ex, out;
            ok(ctx, drawn_set(ctx, 30, 20, false, 1, &ex));
            for (int32_t i = 0; i < n; i++)
                ok(ctx, drawn_add(&ex, same ? 7 : 4 + 5 * (i % 3),
                                  same ? 8 : 5 + 6 * (i / 3), 2, 0, 0));
            grow(ctx, &ex, &p, 200, 200, false, &out);
            assert_true(out.element.n > 10 * (same ? 1 : n));
            if (n == 1)
                near(out.element.n, 200 * 200 / 600.0, 0.2);
            tz_element_set_deinit(&ex);
            tz_element_set_deinit(&out);
        }
    end_ctx(ctx);
}

static void test_bad(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set ex, none;
    tz_growth *g = NULL;
    const tz_growth_params p = params();
    ok(ctx, drawn_squares(ctx, 4, 1, false, &ex));
    ok(ctx, drawn_set(ctx, 10, 10, false, 1, &none));
    fails(ctx, tz_growth_begin(ctx, &none, &p, &ex, &g), TZ_INVALID, "no elements");
    none.domain.size.x = 0;
    fails(ctx, tz_growth_begin(ctx, &ex, &p, &none, &g), TZ_INVALID, "no area");
    none.domain.size.x = NAN;
    fails(ctx, tz_growth_begin(ctx, &ex, &p, &none, &g), TZ_INVALID, "no area");
    assert_null(g);
    tz_growth_end(NULL);
    tz_element_set_deinit(&ex);
    tz_element_set_deinit(&none);
    end_ctx(ctx);
}

static void test_tiny_domain(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set ex, out;
    const tz_growth_params p = params();
    ok(ctx, drawn_hexagons(ctx, 9, 8, 0, false, &ex));
    for (int32_t k = 0; k < 16; k++) {
        const double size = pow(2, k / 2 - 3);
        grow(ctx, &ex, &p, size, size * 2, k % 2, &out);
        assert_true(out.element.n >= 1 && out.element.n <= 2 + size * size / 20);
        tz_element_set_deinit(&out);
    }
    tz_element_set_deinit(&ex);
    end_ctx(ctx);
}

static void test_torus_seam(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set ex, out;
    const tz_growth_params p = params();
    ok(ctx, drawn_squares(ctx, 8, 2, true, &ex));
    grow(ctx, &ex, &p, 240, 160, true, &out); /* a whole number of periods */
    assert_int_equal(out.element.n, 24 * 16);
    const spread m = measure(&out, 0); /* over the seam */
    near(m.mean, 10, 1e-6);
    assert_true(m.deviation < 1e-6);
    for (int32_t i = 0; i < out.element.n; i++) {
        const tz_vec3 at = out.element.v[i].at;
        assert_true(at.x >= 0 && at.y >= 0 && at.x < 240 && at.y < 160);
    }
    tz_element_set_deinit(&out);
    grow(ctx, &ex, &p, 243, 167, true, &out); /* not so */
    near(out.element.n, 405, 0.1);
    assert_true(closest(&out) >= 0.96 * closest(&ex));
    tz_element_set_deinit(&ex);
    tz_element_set_deinit(&out);
    end_ctx(ctx);
}

static void test_fixed(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set ex, out;
    const tz_growth_params p = params();
    const tz_domain d = {.size = {300, 300, 0}, .torus = false};
    ok(ctx, drawn_darts(ctx, 150, 8, 300, 1, true, &ex));
    ok(ctx, tz_element_set_like(ctx, &ex, &d, &out));
    for (int32_t i = 0; i < 12; i++) {
        const tz_vec3 at = {60 + 60 * (i % 4), 60 + 60 * (i / 4), 0};
        ok(ctx, tz_element_set_place(&out, &ex, i, at, 0, 1));
        out.element.v[i].fixed = true;
        if (i % 2) /* a stranger, and large */
            out.element.v[i].source = -1, out.element.v[i].radius = 14;
    }
    ok(ctx, run(ctx, &ex, &p, 64, &out));
    near(out.element.n, ex.element.n * 4.0, 0.15);
    for (int32_t i = 0; i < 12; i++) {
        const tz_element *e = &out.element.v[i];
        assert_true(e->at.x == 60 + 60 * (i % 4) && e->at.y == 60 + 60 * (i / 4));
        assert_true(e->fixed);
        for (int32_t j = 12; j < out.element.n; j++) {
            const tz_element *o = &out.element.v[j];
            assert_false(o->fixed);
            assert_true(hypot(o->at.x - e->at.x, o->at.y - e->at.y) >=
                        0.75 * (o->radius + e->radius));
        }
    }
    tz_element_set_deinit(&ex);
    tz_element_set_deinit(&out);
    end_ctx(ctx);
}

static void test_voids(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set ex, out;
    const tz_growth_params p = params();
    ok(ctx, drawn_darts(ctx, 200, 8, 250, 2, true, &ex));
    ex.kind.v[1].is_void = true; /* the artist's own */
    grow(ctx, &ex, &p, 400, 400, true, &out);
    near(share(&out, 1), share(&ex, 1), 0.05);
    near(out.element.n, 4.0 * ex.element.n, 0.1);
    tz_element_set_deinit(&ex);
    tz_element_set_deinit(&out);
    /* found ones do not show; room stays empty */
    ok(ctx, drawn_darts(ctx, 200, 8, 130, 1, true, &ex));
    grow(ctx, &ex, &p, 400, 400, true, &out);
    near(out.element.n, 4.0 * ex.element.n, 0.2);
    tz_element_set_deinit(&ex);
    tz_element_set_deinit(&out);
    end_ctx(ctx);
}

static void test_most(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set ex, out;
    tz_growth_params p = params();
    p.most = 77;
    ok(ctx, drawn_squares(ctx, 8, 2, true, &ex));
    ex.element.v[5].cut = true; /* never copied */
    grow(ctx, &ex, &p, 400, 400, false, &out);
    assert_int_equal(out.element.n, 77);
    for (int32_t i = 0; i < out.element.n; i++)
        assert_int_not_equal(out.element.v[i].source, 5);
    tz_element_set_deinit(&ex);
    tz_element_set_deinit(&out);
    end_ctx(ctx);
}

/* ---- running --------------------------------------------------------------------- */

static void test_same_bytes(void **state)
{
    (void)state;
    uint64_t first = 0, other = 0;
    const int threads[] = {1, 2, 8, 1};
    const int32_t budget[] = {1000000, 1, 37, 500};
    for (int k = 0; k < 5; k++) {
        tz_ctx *ctx = new_ctx(k < 4 ? threads[k] : 1);
        tz_element_set ex, out;
        tz_growth_params p = params();
        const tz_domain d = {.size = {300, 200, 0}, .torus = true};
        p.seed += k == 4;
        ok(ctx, drawn_darts(ctx, 150, 8, 300, 3, true, &ex));
        ok(ctx, tz_element_set_like(ctx, &ex, &d, &out));
        ok(ctx, run(ctx, &ex, &p, k < 4 ? budget[k] : 1000, &out));
        if (k == 0)
            first = digest(&out);
        else if (k < 4)
            assert_true(digest(&out) == first);
        else
            other = digest(&out);
        tz_element_set_deinit(&ex);
        tz_element_set_deinit(&out);
        end_ctx(ctx);
    }
    assert_true(other != first);
}

static void test_cancel(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set ex, out;
    const tz_growth_params p = params();
    const tz_domain d = {.size = {400, 400, 0}, .torus = true};
    ok(ctx, drawn_darts(ctx, 150, 8, 300, 3, true, &ex));
    for (int32_t steps = 0; steps < 8; steps++) {
        tz_growth *g = NULL;
        bool more = true;
        ok(ctx, tz_element_set_like(ctx, &ex, &d, &out));
        ok(ctx, tz_growth_begin(ctx, &ex, &p, &out, &g));
        for (int32_t i = 0; i < steps; i++)
            ok(ctx, tz_growth_step(g, 100, &more));
        const int32_t n = out.element.n;
        tz_ctx_cancel(ctx);
        assert_int_equal(tz_growth_step(g, 100, &more), TZ_CANCELLED);
        assert_int_equal(out.element.n, n);
        tz_ctx_clear(ctx);
        ok(ctx, tz_element_set_check(ctx, &out, "output"));
        ok(ctx, tz_growth_step(g, 100, &more)); /* and it may go on */
        assert_true(out.element.n > n);
        tz_growth_end(g);
        tz_element_set_deinit(&out);
    }
    tz_element_set_deinit(&ex);
    end_ctx(ctx);
}

static tz_status grow_small(tz_ctx *ctx)
{
    tz_element_set ex, out;
    tz_growth_params p = params();
    const tz_domain d = {.size = {120, 90, 0}, .torus = false};
    tz_growth *g = NULL;
    bool more = true;
    p.optimise = TZ_GROWTH_GLOBAL;
    tz_status s = drawn_squares(ctx, 6, 2, false, &ex);
    if (s != TZ_OK)
        return s;
    s = tz_element_set_like(ctx, &ex, &d, &out);
    if (s == TZ_OK)
        s = tz_growth_begin(ctx, &ex, &p, &out, &g);
    while (s == TZ_OK && more)
        s = tz_growth_step(g, 20, &more);
    tz_growth_end(g);
    tz_element_set_deinit(&ex);
    tz_element_set_deinit(&out);
    return s;
}

static void test_out_of_memory(void **state)
{
    (void)state;
    survive(grow_small, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hexagons),    cmocka_unit_test(test_squares),
        cmocka_unit_test(test_darts),       cmocka_unit_test(test_no_tiles),
        cmocka_unit_test(test_mixed_sizes), cmocka_unit_test(test_orientations),
        cmocka_unit_test(test_few),         cmocka_unit_test(test_bad),
        cmocka_unit_test(test_tiny_domain), cmocka_unit_test(test_torus_seam),
        cmocka_unit_test(test_fixed),       cmocka_unit_test(test_voids),
        cmocka_unit_test(test_most),        cmocka_unit_test(test_same_bytes),
        cmocka_unit_test(test_cancel),      cmocka_unit_test(test_out_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
