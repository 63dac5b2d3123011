/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Curve layouts as a whole: what holds for any of them. */
#include "tests/base/check.h"

#include <math.h>

#include "curves/curve_arrange.h"
#include "curves/curve_io.h"

static tz_curve_set exemplar, set;
static tz_ctx *ctx;

/* Wavy rungs between wavy rails: junctions, crossings, no loose ends but at the border. */
static tz_status draw_net(tz_ctx *c, tz_curve_set *s)
{
    static char text[60000];
    int n = snprintf(text, sizeof text,
                     "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 200 160'><g "
                     "fill='none' stroke='#234' stroke-width='1'>");
    for (int i = 0; i < 8; i++) {
        n += snprintf(text + n, sizeof text - (size_t)n, "<path d='M0 %d", 10 + 20 * i);
        for (int x = 10; x <= 200; x += 10)
            n += snprintf(text + n, sizeof text - (size_t)n, "L%d %.3f", x,
                          10 + 20 * i + 3 * sin(x / 20.0 + i));
        n +=
            snprintf(text + n, sizeof text - (size_t)n, "'/><path d='M%d 0", 12 + 25 * i);
        for (int y = 10; y <= 160; y += 10)
            n += snprintf(text + n, sizeof text - (size_t)n, "L%.3f %d",
                          12 + 25 * i + 3 * sin(y / 15.0 + 2 * i), y);
        n += snprintf(text + n, sizeof text - (size_t)n, "'/>");
    }
    n += snprintf(text + n, sizeof text - (size_t)n, "</g></svg>");
    return tz_curve_parse_svg(c, "net.svg", text, (size_t)n, NULL, s);
}

static void clear(tz_curve_set *s)
{
    tz_curve_set_deinit(s);
    memset(s, 0, sizeof *s);
}

static int begin(void **state)
{
    (void)state;
    ctx = new_ctx(2);
    return draw_net(ctx, &exemplar) == TZ_OK ? 0 : -1;
}

static int end(void **state)
{
    (void)state;
    clear(&exemplar);
    clear(&set);
    end_ctx(ctx);
    return 0;
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

/* The table's defaults are those of the parts. */
static void test_defaults(void **state)
{
    (void)state;
    tz_curve_arrange_params all;
    tz_curve_quilt_params quilt;
    tz_curve_synthesis_params synthesis;
    tz_params_default(&tz_curve_arrange_param_table, &all);
    tz_params_default(&tz_curve_quilt_param_table, &quilt);
    tz_params_default(&tz_curve_synthesis_param_table, &synthesis);
    assert_true(all.quilt.patch == quilt.patch);
    assert_true(all.quilt.overlap == 0 && all.quilt.candidates == 0); /* left to it */
    assert_int_equal(all.synthesis.start, synthesis.start);
    assert_int_equal(all.synthesis.levels, synthesis.levels);
    assert_int_equal(all.synthesis.iterations, synthesis.iterations);
    assert_true(all.synthesis.scale == synthesis.scale);
    assert_true(all.synthesis.edges && all.synthesis.robust && all.synthesis.existence);
}

static void arrange(tz_domain d, int32_t method, tz_curve_arrange_report *r)
{
    tz_curve_arrange_params p;
    tz_params_default(&tz_curve_arrange_param_table, &p);
    p.method = method;
    const tz_curve_arrange_job job = {
        .exemplar = &exemplar, .domain = &d, .params = &p, .seed = 3};
    clear(&set);
    ok(ctx, tz_curve_arrange(ctx, &job, &set, r));
    ok(ctx, tz_curve_set_check(ctx, &set, "layout"));
}

/* Every method fills the domain as densely as the exemplar, and no farther. */
static void test_methods(void **state)
{
    (void)state;
    const tz_domain d = {.size = {330, 270, 0}};
    const double dense = length(&exemplar) / (200.0 * 160);
    for (int32_t m = 0; m < 3; m++) {
        tz_curve_arrange_report r;
        arrange(d, m, &r);
        const double here = length(&set) / (330.0 * 270);
        if (fabs(here / dense - 1) > (m == TZ_CURVES_OPTIMISE ? 0.25 : 0.1))
            fail_msg("method %d: %g of the exemplar's length per area", m, here / dense);
        assert_true(set.domain.size.x == 330 && set.domain.size.y == 270);
        assert_true(r.optimised || m != TZ_CURVES_OPTIMISE);
        assert_true(!r.optimised || m != TZ_CURVES_QUILT);
        assert_true(r.mean > 0 && r.mean < 6);
    }
}

/* AUTO takes the better one: it is never worse than the quilt. */
static void test_better(void **state)
{
    (void)state;
    const tz_domain d = {.size = {260, 220, 0}};
    tz_curve_arrange_report quilt, both;
    arrange(d, TZ_CURVES_QUILT, &quilt);
    arrange(d, TZ_CURVES_AUTO, &both);
    assert_true(both.mean <= quilt.mean + 1e-12);
    assert_true(both.samples > 0);
}

static void test_torus(void **state)
{
    (void)state;
    for (int32_t m = 0; m < 3; m++) {
        arrange((tz_domain){.size = {240, 200, 0}, .torus = true}, m, NULL);
        assert_true(set.domain.torus);
        for (int32_t i = 0; i < set.node.n; i++)
            assert_true(set.node.v[i].x >= 0 && set.node.v[i].x < 240 &&
                        set.node.v[i].y >= 0 && set.node.v[i].y < 200);
    }
}

static void test_threads(void **state)
{
    (void)state;
    char dir[64], name[3][96];
    begin_dir(dir);
    for (int i = 0; i < 3; i++) {
        tz_ctx *c = new_ctx(i == 2 ? 8 : i + 1);
        tz_curve_set e = {0}, out = {0};
        const tz_domain d = {.size = {300, 200, 0}};
        ok(c, draw_net(c, &e));
        const tz_curve_arrange_job job = {.exemplar = &e, .domain = &d, .seed = 9};
        ok(c, tz_curve_arrange(c, &job, &out, NULL));
        snprintf(name[i], sizeof name[i], "%s/%d.svg", dir, i);
        ok(c, tz_curve_write_svg(c, name[i], &out));
        tz_curve_set_deinit(&e);
        tz_curve_set_deinit(&out);
        end_ctx(c);
    }
    char line[400];
    for (int i = 1; i < 3; i++) {
        snprintf(line, sizeof line, "cmp -s '%s' '%s'", name[0], name[i]);
        assert_int_equal(system(line), 0);
    }
    end_dir(dir);
}

static void test_bad(void **state)
{
    (void)state;
    static const double sizes[][2] = {
        {0, 10}, {-5, 10}, {NAN, 10}, {INFINITY, 10}, {1e9, 1e9}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        const tz_domain d = {.size = {sizes[i][0], sizes[i][1], 0}};
        const tz_curve_arrange_job job = {
            .exemplar = &exemplar, .name = "net.svg", .domain = &d};
        fails(ctx, tz_curve_arrange(ctx, &job, &set, NULL),
              i == 4 ? TZ_LIMIT : TZ_INVALID, "net.svg");
        assert_null(set.path.v);
    }
    const tz_domain d = {.size = {100, 100, 0}};
    tz_curve_set none = {.domain = d, .ctx = ctx};
    const tz_curve_arrange_job job = {.exemplar = &none, .name = "none", .domain = &d};
    fails(ctx, tz_curve_arrange(ctx, &job, &set, NULL), TZ_INVALID, "no curves");
    const tz_curve_arrange_job cancelled = {.exemplar = &exemplar, .domain = &d};
    tz_ctx_cancel(ctx);
    assert_int_equal(tz_curve_arrange(ctx, &cancelled, &set, NULL), TZ_CANCELLED);
    tz_ctx_clear(ctx);
}

/* What will not fit into memory is refused before the work: in little of it; what
 * fits is not. */
static void test_too_much(void **state)
{
    (void)state;
    tz_ctx *c = NULL;
    const tz_ctx_options opt = {.threads = 1, .memory = 64 << 20};
    tz_curve_set e = {0}, out = {0};
    assert_int_equal(tz_ctx_new(&opt, &c), TZ_OK);
    ok(c, draw_net(c, &e));
    tz_curve_arrange_params p;
    tz_params_default(&tz_curve_arrange_param_table, &p);
    const tz_domain huge = {.size = {9000, 9000, 0}}, large = {.size = {900, 700, 0}};
    tz_curve_arrange_job job = {
        .exemplar = &e, .name = "net.svg", .domain = &huge, .params = &p};
    fails(c, tz_curve_arrange(c, &job, &out, NULL), TZ_LIMIT,
          "net.svg: over 9000 x 9000");
    assert_null(out.path.v);
    assert_true(tz_ctx_memory_peak(c) < 8 << 20);
    job.domain = &large;
    p.method = TZ_CURVES_QUILT;
    ok(c, tz_curve_arrange(c, &job, &out, NULL));
    tz_curve_set_deinit(&out);
    tz_curve_set_deinit(&e);
    end_ctx(c);
}

/* Memory runs out at many places, evenly spread over the run. */
static void test_memory(void **state)
{
    (void)state;
    int64_t n = 1;
    for (int k = 0; k < 40; k++, n += 1 + n / 4) {
        tz_ctx *c = NULL;
        tz_curve_set e = {0}, out = {0};
        const tz_ctx_options opt = {.threads = 1, .fail_alloc = n};
        const tz_domain d = {.size = {120, 100, 0}};
        assert_int_equal(tz_ctx_new(&opt, &c), TZ_OK);
        tz_status s = draw_net(c, &e);
        const tz_curve_arrange_job job = {.exemplar = &e, .domain = &d};
        if (s == TZ_OK)
            s = tz_curve_arrange(c, &job, &out, NULL);
        if (s != TZ_OK) {
            assert_int_equal(s, TZ_NOMEM);
            assert_null(out.path.v);
        }
        tz_curve_set_deinit(&e);
        tz_curve_set_deinit(&out);
        end_ctx(c);
        if (s == TZ_OK)
            return;
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_defaults),
        cmocka_unit_test_setup_teardown(test_methods, begin, end),
        cmocka_unit_test_setup_teardown(test_better, begin, end),
        cmocka_unit_test_setup_teardown(test_torus, begin, end),
        cmocka_unit_test(test_threads),
        cmocka_unit_test_setup_teardown(test_bad, begin, end),
        cmocka_unit_test(test_too_much),
        cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
