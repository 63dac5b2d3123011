/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Curves for plotters: the way of the pen, and DXF. */
#include "tests/base/check.h"

#include <math.h>

#include "base/file.h"
#include "base/rng.h"
#include "curves/curve_dxf.h"
#include "curves/curve_io.h"

static tz_ctx *ctx;
static tz_curve_set set;
static char dir[64];

static int begin(void **state)
{
    (void)state;
    ctx = new_ctx(1);
    begin_dir(dir);
    return 0;
}

static int end(void **state)
{
    (void)state;
    tz_curve_set_deinit(&set);
    memset(&set, 0, sizeof set);
    end_ctx(ctx);
    end_dir(dir);
    return 0;
}

static void parse(const char *text)
{
    tz_curve_set_deinit(&set);
    ok(ctx, tz_curve_parse_svg(ctx, "t.svg", text, strlen(text), NULL, &set));
}

static void start_set(tz_curve_set *s, tz_ctx *c, double size)
{
    memset(s, 0, sizeof *s);
    s->ctx = c;
    s->domain.size = (tz_vec3){size, size, 0};
    s->element.ctx = c;
    s->element.domain = s->domain;
}

/* n short strokes at random places, with `pens` pens by turns. */
static tz_status scatter(tz_curve_set *s, tz_ctx *c, int32_t n, int32_t pens)
{
    int32_t id[2], pen;
    tz_status st = TZ_OK;
    start_set(s, c, 1000);
    for (int32_t i = 0; i < n && st == TZ_OK; i++) {
        tz_rng r = tz_rng_make(7, (uint64_t)i);
        const double x = 20 + 960 * tz_rng_unit(&r), y = 20 + 960 * tz_rng_unit(&r),
                     a = 6.28 * tz_rng_unit(&r);
        st = tz_curve_add_pen(s, (tz_curve_pen){1 + i % pens, 0x204060ff, 0, 0}, &pen);
        if (st == TZ_OK)
            st = tz_curve_add_node(s, (tz_vec2){x, y}, &id[0]);
        if (st == TZ_OK)
            st =
                tz_curve_add_node(s, (tz_vec2){x + 15 * cos(a), y + 15 * sin(a)}, &id[1]);
        if (st == TZ_OK)
            st = tz_curve_begin(s, pen);
        if (st == TZ_OK)
            st = tz_curve_line(s, id[0], id[1]);
        if (st == TZ_OK)
            tz_curve_end(s, false);
    }
    return st;
}

/* ---- travel ------------------------------------------------------------------------ */

static double way_of(const tz_curve_set *s, const int32_t *order, const bool *reversed)
{
    double sum = 0;
    tz_vec2 at = {0, 0};
    for (int32_t k = 0; k < s->path.n; k++) {
        const tz_curve_path *p = &s->path.v[order[k]];
        const tz_vec2 a = s->node.v[s->piece.v[p->piece].from],
                      b = s->node.v[s->piece.v[p->piece + p->pieces - 1].to];
        sum += hypot(at.x - (reversed[k] ? b : a).x, at.y - (reversed[k] ? b : a).y);
        at = reversed[k] ? a : b;
    }
    return sum;
}

static void travel(int32_t n, int32_t pens, double way[2])
{
    int32_t *order = malloc((size_t)n * sizeof *order);
    bool *reversed = malloc((size_t)n), *seen = calloc((size_t)n, 1);
    tz_curve_set_deinit(&set);
    ok(ctx, scatter(&set, ctx, n, pens));
    ok(ctx, tz_curve_travel(ctx, &set, order, reversed, way));
    assert_true(fabs(way_of(&set, order, reversed) - way[1]) < 1e-9 * way[1]);
    int32_t changes = 0;
    for (int32_t k = 0; k < n; k++) {
        assert_in_range(order[k], 0, n - 1);
        assert_false(seen[order[k]]);
        seen[order[k]] = true;
        changes += k > 0 && set.path.v[order[k]].pen != set.path.v[order[k - 1]].pen;
    }
    assert_int_equal(changes, pens - 1); /* each pen is taken once */
    for (int32_t k = 0; k < n; k++)
        order[k] = k;
    assert_true(fabs(way_of(&set, order, (memset(reversed, 0, (size_t)n), reversed)) -
                     way[0]) < 1e-9 * way[0]);
    free(order);
    free(reversed);
    free(seen);
}

static void test_travel(void **state)
{
    (void)state;
    double way[2];
    travel(1, 1, way);
    assert_true(way[0] >= way[1]);
    travel(1000, 1, way);
    /* The best tour of n random points is 0.7124 sqrt(n area); strokes that are entered
     * from the better end need less. */
    assert_true(way[1] < 0.85 * 0.7124 * sqrt(1000.0 * 960 * 960));
    travel(1000, 3, way);
    assert_true(way[1] < 0.25 * way[0]);
}

static tz_status travel_again(tz_ctx *c)
{
    tz_curve_set s;
    int32_t order[40];
    bool reversed[40];
    double way[2];
    tz_status st = scatter(&s, c, 40, 2);
    if (st == TZ_OK)
        st = tz_curve_travel(c, &s, order, reversed, way);
    tz_curve_set_deinit(&s);
    return st;
}

static void test_travel_memory(void **state)
{
    (void)state;
    survive(travel_again, 1);
}

/* Strokes that all lie in one spot, or on one line, come to an end soon. */
static void test_travel_alike(void **state)
{
    (void)state;
    enum { N = 20000 };
    int32_t id[2], *order = malloc(N * sizeof *order);
    bool *reversed = malloc(N);
    double way[2];
    for (int kind = 0; kind < 2; kind++) {
        tz_curve_set_deinit(&set);
        start_set(&set, ctx, 100);
        int32_t pen;
        ok(ctx, tz_curve_add_pen(&set, (tz_curve_pen){1, 255, 0, 0}, &pen));
        for (int i = 0; i < N; i++) {
            const double x = kind ? i * 50.0 / N : 50;
            ok(ctx, tz_curve_add_node(&set, (tz_vec2){x, 50}, &id[0]));
            ok(ctx, tz_curve_add_node(&set, (tz_vec2){x + 1, 50}, &id[1]));
            ok(ctx, tz_curve_begin(&set, pen));
            ok(ctx, tz_curve_line(&set, id[0], id[1]));
            tz_curve_end(&set, false);
        }
        ok(ctx, tz_curve_travel(ctx, &set, order, reversed, way));
        assert_true(way[1] <= way[0]);
    }
    free(order);
    free(reversed);
}

/* ---- dxf --------------------------------------------------------------------------- */

/* What a reader sees: pairs of a code and a value. */
typedef struct seen {
    int polylines, vertices, closed, ends, layers;
    double least[2], most[2], length;
    double at[2], from[2];
    bool has, shut;
} seen;

static void see(const char *path, seen *v)
{
    char code[64], value[512], kind[64] = "";
    FILE *f = fopen(path, "r");
    assert_non_null(f);
    *v = (seen){.least = {1e9, 1e9}, .most = {-1e9, -1e9}};
    while (fgets(code, sizeof code, f)) {
        assert_non_null(fgets(value, sizeof value, f));
        value[strcspn(value, "\n")] = 0;
        const int c = atoi(code);
        const double x = atof(value);
        if (c == 0) {
            strcpy(kind, value);
            v->polylines += strcmp(kind, "POLYLINE") == 0;
            v->layers += strcmp(kind, "LAYER") == 0;
            v->vertices += strcmp(kind, "VERTEX") == 0;
            if (strcmp(kind, "POLYLINE") == 0)
                v->has = false;
            if (strcmp(kind, "SEQEND") == 0 && v->shut)
                v->length += hypot(v->at[0] - v->from[0], v->at[1] - v->from[1]);
            v->ends += strcmp(kind, "EOF") == 0;
        }
        if (strcmp(kind, "POLYLINE") == 0 && c == 70) {
            v->shut = atoi(value) & 1;
            v->closed += v->shut;
        }
        if (strcmp(kind, "VERTEX") == 0 && (c == 10 || c == 20)) {
            const int i = c == 20;
            static double was[2];
            was[i] = v->at[i];
            v->at[i] = x;
            v->least[i] = fmin(v->least[i], x);
            v->most[i] = fmax(v->most[i], x);
            if (i == 1) {
                if (v->has)
                    v->length += hypot(v->at[0] - was[0], v->at[1] - was[1]);
                else
                    memcpy(v->from, v->at, sizeof v->from);
                v->has = true;
            }
        }
    }
    fclose(f);
    assert_int_equal(v->ends, 1);
}

static void test_dxf(void **state)
{
    (void)state;
    char path[128];
    double way[2];
    seen v;
    snprintf(path, sizeof path, "%s/a.dxf", dir);
    parse("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 100 60'><g fill='none' "
          "stroke='#f00'><path d='M10 10L30 10'/><path stroke='#00f' d='M10 20H40V50'/>"
          "<circle cx='70' cy='30' r='10'/></g></svg>");
    ok(ctx, tz_curve_write_dxf(ctx, path, &set, 2, 0, way));
    see(path, &v);
    assert_int_equal(v.polylines, 3);
    assert_int_equal(v.closed, 1);
    assert_int_equal(v.layers, 2);
    assert_true(fabs(v.length - 2 * (20 + 60 + 20 * TZ_PI)) < 0.5);
    /* 2 mm a unit, y up: the line at y = 10 of 60 lies at 100 mm */
    assert_true(fabs(v.least[0] - 20) < 1e-9 && fabs(v.most[0] - 160) < 1e-6);
    assert_true(fabs(v.least[1] - 20) < 1e-9 && fabs(v.most[1] - 100) < 1e-9);
    assert_true(way[0] > 0 && way[1] > 0);
    /* red is 1, blue 5 */
    char *text;
    size_t size;
    ok(ctx, tz_file_read(ctx, path, 1 << 20, &text, &size));
    assert_non_null(strstr(text, "PEN_1\n 70\n     0\n 62\n     1\n"));
    assert_non_null(strstr(text, "PEN_2\n 70\n     0\n 62\n     5\n"));
    assert_non_null(strstr(text, "AC1009"));
    tz_free(ctx, text);
}

/* A path around a torus is drawn through, and is no closed line in the plane. */
static void test_torus(void **state)
{
    (void)state;
    char path[128];
    seen v;
    int32_t id[2], pen;
    snprintf(path, sizeof path, "%s/t.dxf", dir);
    start_set(&set, ctx, 100);
    set.domain.torus = set.element.domain.torus = true;
    ok(ctx, tz_curve_add_pen(&set, (tz_curve_pen){1, 255, 0, 0}, &pen));
    ok(ctx, tz_curve_add_node(&set, (tz_vec2){20, 50}, &id[0]));
    ok(ctx, tz_curve_add_node(&set, (tz_vec2){65, 50}, &id[1]));
    ok(ctx, tz_curve_begin(&set, pen));
    ok(ctx, tz_curve_cubic(&set, id[0], id[1], (tz_vec2){35, 60}, (tz_vec2){50, 40}));
    ok(ctx, tz_curve_cubic(&set, id[1], id[0], (tz_vec2){80, 60}, (tz_vec2){110, 40}));
    tz_curve_end(&set, true);
    ok(ctx, tz_curve_write_dxf(ctx, path, &set, 1, 0, NULL));
    see(path, &v);
    assert_int_equal(v.closed, 0);
    assert_true(fabs(v.least[0] - 20) < 1e-9 && fabs(v.most[0] - 120) < 1e-9);
    assert_true(v.length > 100 && v.length < 115);
}

static void test_bad(void **state)
{
    (void)state;
    char path[128];
    snprintf(path, sizeof path, "%s/b.dxf", dir);
    ok(ctx, scatter(&set, ctx, 3, 1));
    const double none[] = {0, -1, NAN, INFINITY};
    for (int i = 0; i < 4; i++) {
        fails(ctx, tz_curve_write_dxf(ctx, path, &set, none[i], 0, NULL), TZ_INVALID,
              "b.dxf");
        if (i > 0)
            fails(ctx, tz_curve_write_dxf(ctx, path, &set, 1, none[i], NULL), TZ_INVALID,
                  "tolerance");
    }
    fails(ctx, tz_curve_write_dxf(ctx, path, &set, 1e9, 0, NULL), TZ_INVALID, "m long");
    fails(ctx, tz_curve_write_dxf(ctx, "/nowhere/b.dxf", &set, 1, 0, NULL), TZ_IO,
          "/nowhere");
    const double x = set.node.v[0].x;
    set.node.v[0].x = 1e300;
    fails(ctx, tz_curve_write_dxf(ctx, path, &set, 1, 0, NULL), TZ_INVALID, "");
    set.node.v[0].x = NAN;
    fails(ctx, tz_curve_write_dxf(ctx, path, &set, 1, 0, NULL), TZ_INVALID, "");
    set.node.v[0].x = x;
    tz_ctx_cancel(ctx);
    assert_int_equal(tz_curve_write_dxf(ctx, path, &set, 1, 0, NULL), TZ_CANCELLED);
    tz_ctx_clear(ctx);
    assert_int_equal(dir_count(dir), 0);
}

static tz_status write_once(tz_ctx *c)
{
    tz_curve_set s;
    char path[128];
    snprintf(path, sizeof path, "%s/m.dxf", dir);
    tz_status st = scatter(&s, c, 40, 2);
    if (st == TZ_OK)
        st = tz_curve_write_dxf(c, path, &s, 1, 0, NULL);
    tz_curve_set_deinit(&s);
    return st;
}

static void test_memory(void **state)
{
    (void)state;
    survive(write_once, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_travel, begin, end),
        cmocka_unit_test(test_travel_memory),
        cmocka_unit_test_setup_teardown(test_travel_alike, begin, end),
        cmocka_unit_test_setup_teardown(test_dxf, begin, end),
        cmocka_unit_test_setup_teardown(test_torus, begin, end),
        cmocka_unit_test_setup_teardown(test_bad, begin, end),
        cmocka_unit_test_setup_teardown(test_memory, begin, end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
