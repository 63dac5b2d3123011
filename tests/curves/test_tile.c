/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Tiles: found where they are, not where they are none; sewn without a trace. */
#include "tests/support/curve_fixture.h"

#include <math.h>

#include "curves/curve_io.h"
#include "curves/quilt.h"
#include "curves/tile.h"

#define HEAD                                     \
    "<svg xmlns=\"http://www.w3.org/2000/svg\" " \
    "viewBox=\"0 0 120 120\"><g fill=\"none\" stroke=\"#204060\" stroke-width=\"1\">"
#define TAIL "</g></svg>"

/* Slanted waves that leave at one side where they come in at the other, and a ring over a
 * corner. @param off  by which the right ends lie lower */
static char *waves(char *text, size_t size, double off)
{
    size_t n = (size_t)snprintf(text, size, "%s", HEAD);
    for (int i = 0; i < 8; i++) {
        const double y = 4 + 14.0 * i + i % 3;
        n += (size_t)snprintf(text + n, size - n,
                              "<path d='M0 %gC30 %g 40 %g 60 %gS100 %g 120 %g'/>", y,
                              y + 3, y + 8, y + 4, y + off - 2, y + off);
    }
    for (int i = 0; i < 8; i++) {
        const double x = 7 + 14.0 * i + i % 4;
        n += (size_t)snprintf(text + n, size - n,
                              "<path d='M%g 0C%g 20 %g 40 %g 50M%g 70L%g 120'/>", x,
                              x + 2, x, x + 3, x - 2 + off, x + off);
    }
    snprintf(text + n, size - n, "%s", TAIL);
    return text;
}

static void parse(tz_ctx *c, const char *text, tz_curve_set *set)
{
    ok(c, tz_curve_parse_svg(c, "t.svg", text, strlen(text), NULL, set));
}

static int32_t ends_at_border(const tz_curve_set *s)
{
    int32_t n = 0;
    int32_t *degree = calloc((size_t)s->node.n + 1, sizeof *degree);
    assert_non_null(degree);
    for (int32_t i = 0; i < s->piece.n; i++) {
        degree[s->piece.v[i].from]++;
        degree[s->piece.v[i].to]++;
    }
    for (int32_t i = 0; i < s->node.n; i++) {
        const tz_vec2 p = s->node.v[i];
        n += degree[i] == 1 && (fmin(p.x, 120 - p.x) < 1 || fmin(p.y, 120 - p.y) < 1);
    }
    free(degree);
    return n;
}

static double length_of(const tz_curve_set *s)
{
    double sum = 0;
    for (int32_t i = 0; i < s->piece.n; i++) {
        const tz_bezier b = tz_curve_bezier(s, &s->piece.v[i]);
        sum += tz_bezier_length(&b);
    }
    return sum;
}

static void test_found(void **state)
{
    (void)state;
    char text[8192];
    for (int k = 0; k < 3; k++) { /* exact, a little off, far off */
        tz_curve_set s, t;
        bool is = k == 2;
        parse(ctx, waves(text, sizeof text, k == 0 ? 0 : k == 1 ? 0.3 : 5), &s);
        ok(ctx, tz_curve_tile_find(ctx, &s, &is));
        assert_int_equal(is, k < 2);
        assert_true(ends_at_border(&s) == 32);
        ok(ctx, tz_curve_tile_join(ctx, &s, &t));
        ok(ctx, tz_curve_set_check(ctx, &t, "tile"));
        assert_true(t.domain.torus);
        if (k < 2) {
            assert_int_equal(ends_at_border(&t), 0);
            assert_true(fabs(length_of(&t) / length_of(&s) - 1) < 0.005);
            ok(ctx, tz_curve_tile_find(ctx, &t, &is)); /* a torus is one */
            assert_true(is);
        }
        tz_curve_set_deinit(&t);
        tz_curve_set_deinit(&s);
    }
}

/* Nothing that leaves, or too little to tell: no tile, but a torus if it is to be one. */
static void test_none(void **state)
{
    (void)state;
    static const char *const body[] = {
        HEAD "<path d='M10 60L110 60'/>" TAIL,
        HEAD "<path d='M0 60L120 60'/>" TAIL,
        HEAD "<circle cx='60' cy='60' r='80'/>" TAIL,
        HEAD "<circle cx='0' cy='0' r='30'/>" TAIL,
        HEAD "<path d='M0 0L120 0L120 120L0 120Z'/>" TAIL,
        HEAD "<path d='M0 0L0 120M60 60L60.0001 60M-500 -500L700 700'/>" TAIL,
    };
    for (size_t i = 0; i < sizeof body / sizeof *body; i++) {
        tz_curve_set s, t;
        bool is = true;
        parse(ctx, body[i], &s);
        ok(ctx, tz_curve_tile_find(ctx, &s, &is));
        assert_false(is);
        ok(ctx, tz_curve_tile_join(ctx, &s, &t));
        ok(ctx, tz_curve_set_check(ctx, &t, "tile"));
        for (int32_t k = 0; k < t.node.n; k++)
            assert_true(t.node.v[k].x >= 0 && t.node.v[k].x < 120 && t.node.v[k].y >= 0 &&
                        t.node.v[k].y < 120);
        tz_curve_set_deinit(&t);
        tz_curve_set_deinit(&s);
    }
}

/* Half a line at either side is one line. */
static void test_halves(void **state)
{
    (void)state;
    tz_curve_set s, t;
    parse(ctx,
          HEAD
          "<path d='M0.5 0L0.5 120M119.5 0L119.5 120M0 40L120 40M0 80L120 80'/>" TAIL,
          &s);
    ok(ctx, tz_curve_tile_join(ctx, &s, &t));
    ok(ctx, tz_curve_set_check(ctx, &t, "tile"));
    assert_true(fabs(length_of(&t) - 3 * 120) < 1e-6);
    tz_curve_set_deinit(&t);
    tz_curve_set_deinit(&s);
}

/* A quilt of a tile at any number of threads: the same, and its origins are the tile's. */
static void test_quilt(void **state)
{
    (void)state;
    char text[8192];
    tz_curve_set first = {0};
    const int threads[3] = {1, 2, 8};
    for (int i = 0; i < 3; i++) {
        tz_ctx *c = new_ctx(threads[i]);
        tz_curve_set s, t, out;
        const tz_domain d = {.size = {300, 280, 0}};
        parse(c, waves(text, sizeof text, 0), &s);
        ok(c, tz_curve_tile_join(c, &s, &t));
        const tz_curve_quilt_job job = {.exemplar = &t, .domain = &d, .seed = 4};
        ok(c, tz_curve_quilt(c, &job, &out, NULL));
        ok(c, tz_curve_set_check(c, &out, "out"));
        const double ratio = length_of(&out) / (300 * 280.0) / length_of(&t) * 14400;
        assert_true(ratio > 0.9 && ratio < 1.1);
        assert_int_equal(out.origin.n, out.piece.n);
        for (int32_t k = 0; k < out.origin.n; k++) {
            const tz_vec2 p = out.origin.v[k].p[0];
            if (!isnan(p.x))
                assert_true(p.x > -60 && p.x < 180 && p.y > -120 && p.y < 240);
        }
        if (i == 0) {
            first = out;
        } else {
            assert_int_equal(first.node.n, out.node.n);
            assert_int_equal(first.piece.n, out.piece.n);
            assert_memory_equal(first.node.v, out.node.v,
                                (size_t)out.node.n * sizeof *out.node.v);
            tz_curve_set_deinit(&out);
        }
        tz_curve_set_deinit(&t);
        tz_curve_set_deinit(&s);
        if (i > 0)
            end_ctx(c);
    }
    tz_ctx *c = first.ctx;
    tz_curve_set_deinit(&first);
    end_ctx(c);
}

static void test_bad(void **state)
{
    (void)state;
    float mask[4] = {1, 1, 1, 1};
    tz_region *region = NULL;
    tz_curve_set s, t;
    bool is = true;
    parse(ctx, HEAD "<path d='M10 60L110 60'/>" TAIL, &s);
    ok(ctx, tz_region_from_mask(ctx, mask, 2, 2, s.domain.size, false, &region));
    s.domain.region = region;
    ok(ctx, tz_curve_tile_find(ctx, &s, &is));
    assert_false(is);
    fails(ctx, tz_curve_tile_join(ctx, &s, &t), TZ_INVALID, "region");
    assert_null(t.node.v);
    s.domain.region = NULL;
    tz_region_free(region);
    tz_curve_set_deinit(&s);
}

static tz_status tile_small(tz_ctx *c)
{
    static const char text[] =
        HEAD "<path d='M0 20C40 0 80 40 120 20M0 60L120 60M0 90L120 90.2M0 101L120 101'/>"
             "<path d='M30 0L30 120M55 0L55 120M90 0L91 120M0 110L120 110'/>" TAIL;
    tz_curve_set s, t;
    bool is;
    tz_status st = tz_curve_parse_svg(c, "t.svg", text, strlen(text), NULL, &s);
    if (st != TZ_OK)
        return st;
    st = tz_curve_tile_find(c, &s, &is);
    if (st == TZ_OK)
        st = tz_curve_tile_join(c, &s, &t);
    if (st == TZ_OK) {
        tz_curve_set out;
        const tz_domain d = {.size = {130, 70, 0}};
        const tz_curve_quilt_job job = {.exemplar = &t, .domain = &d, .seed = 1};
        st = tz_curve_quilt(c, &job, &out, NULL);
        if (st == TZ_OK)
            tz_curve_set_deinit(&out);
        tz_curve_set_deinit(&t);
    }
    tz_curve_set_deinit(&s);
    return st;
}

static void test_memory(void **state)
{
    (void)state;
    survive(tile_small, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_found, begin, end),
        cmocka_unit_test_setup_teardown(test_none, begin, end),
        cmocka_unit_test_setup_teardown(test_halves, begin, end),
        cmocka_unit_test(test_quilt),
        cmocka_unit_test_setup_teardown(test_bad, begin, end),
        cmocka_unit_test_setup_teardown(test_memory, begin, end),
    };
    return cmocka_run_group_tests_name("tile", tests, NULL, NULL);
}
