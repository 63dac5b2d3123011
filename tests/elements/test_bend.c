/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Poses and warps: what is fitted is found again, samples are passed through, the inverse
 * is one, paths and markup follow. */
#include "tests/base/check.h"

#include <math.h>

#include "base/svg.h"
#include "elements/bend.h"
#include "elements/element_io.h"
#include "tests/elements/patterns.h"

static void test_pose(void **state)
{
    (void)state;
    tz_rng r = tz_rng_make(1, 0);
    for (int round = 0; round < 500; round++) {
        tz_vec2 a[12], b[12];
        double w[12];
        const int32_t n = 2 + tz_rng_below(&r, 11);
        const bool scaled = round % 2 == 1;
        const double angle = tz_rng_range(&r, -3, 3),
                     scale = scaled ? tz_rng_range(&r, 0.5, 2) : 1;
        const tz_pose p = {{tz_rng_normal(&r), 4}, {tz_rng_normal(&r), -9}, angle, scale};
        for (int32_t i = 0; i < n; i++) {
            a[i] = (tz_vec2){tz_rng_normal(&r), tz_rng_normal(&r)};
            b[i] = tz_pose_apply(p, a[i]);
            w[i] = tz_rng_range(&r, 0.2, 3);
        }
        const tz_pose q = tz_pose_fit(n, a, b, round % 3 ? w : NULL, scaled);
        assert_float_equal(remainder(q.angle - angle, 2 * TZ_PI), 0, 1e-9);
        assert_float_equal(q.scale, scale, 1e-9);
        for (int32_t i = 0; i < n; i++) {
            const tz_vec2 c = tz_pose_apply(q, a[i]);
            assert_float_equal(hypot(c.x - b[i].x, c.y - b[i].y), 0, 1e-9);
        }
    }
    const tz_vec2 one = {3, 4}, same[2] = {{1, 1}, {1, 1}};
    assert_true(tz_pose_fit(1, &one, same, NULL, true).angle == 0);
    assert_true(tz_pose_fit(2, same, same, NULL, true).scale == 1);
}

/* No turn by a little, and no shift, fits better. */
static void test_pose_is_least_squares(void **state)
{
    (void)state;
    tz_rng r = tz_rng_make(2, 0);
    for (int round = 0; round < 200; round++) {
        tz_vec2 a[7], b[7];
        for (int i = 0; i < 7; i++) {
            a[i] = (tz_vec2){tz_rng_normal(&r), tz_rng_normal(&r)};
            b[i] = (tz_vec2){tz_rng_normal(&r), tz_rng_normal(&r)};
        }
        const tz_pose p = tz_pose_fit(7, a, b, NULL, true);
        double cost[7] = {0};
        for (int k = 0; k < 7; k++) {
            tz_pose q = p;
            q.angle += k == 1 ? 1e-3 : k == 2 ? -1e-3 : 0;
            q.scale *= k == 3 ? 1.001 : k == 4 ? 0.999 : 1;
            q.to.x += k == 5 ? 1e-3 : k == 6 ? -1e-3 : 0;
            for (int i = 0; i < 7; i++) {
                const tz_vec2 c = tz_pose_apply(q, a[i]);
                cost[k] +=
                    (c.x - b[i].x) * (c.x - b[i].x) + (c.y - b[i].y) * (c.y - b[i].y);
            }
            assert_true(cost[k] >= cost[0] - 1e-12);
        }
    }
}

/* ---- a bar ----------------------------------------------------------------------- */

enum { SAMPLES = 9 };

/* 80 long and 8 wide, samples along it every 10; bent to a circle's arc. */
static void make_bar(tz_ctx *ctx, tz_element_set *s, double arc)
{
    ok(ctx, pattern_begin(ctx, s, (tz_domain){.size = {300, 300, 0}}, 1, 41));
    const tz_vec2 box[4] = {{-40, -4}, {40, -4}, {40, 4}, {-40, 4}};
    for (int k = 0; k < 4; k++)
        ok(ctx, tz_array_push(ctx, &s->symbol.v[0].outline, box[k]));
    ok(ctx, tz_array_push(ctx, &s->symbol.v[0].part, 0));
    ok(ctx, pattern_add(s, 0, 150, 150));
    tz_element *e = &s->element.v[0];
    e->samples = SAMPLES;
    e->angle = 0.3, e->scale = 1.5;
    s->sample.n = 0;
    for (int k = 0; k < SAMPLES; k++) {
        const double t = (k - 4) * 10.0 * 1.5;
        const double a = arc * t / 120; /* length is kept */
        const double x = arc != 0 ? 120 / arc * sin(a) : t;
        const double y = arc != 0 ? 120 / arc * (1 - cos(a)) : 0;
        const double c = cos(0.3), d = sin(0.3);
        const tz_sample p = {
            .at = {150 + c * x - d * y, 150 + d * x + c * y, 0}, .id = k, .weight = 1};
        ok(ctx, tz_array_push(ctx, &s->sample, p));
    }
}

/* The same bar at rest, as the exemplar that it copies. */
static void make_source(tz_ctx *ctx, tz_element_set *from)
{
    make_bar(ctx, from, 0);
    from->element.v[0].source = -1;
}

static void test_warp(void **state)
{
    (void)state;
    static const double arcs[] = {0, 0.5, 2, 4};
    for (int k = 0; k < 4; k++) {
        tz_ctx *ctx = new_ctx(1);
        tz_element_set s, from;
        tz_bend b;
        make_bar(ctx, &s, arcs[k]);
        make_source(ctx, &from);
        s.element.v[0].source = 0;
        ok(ctx, tz_bend_init(ctx, &s, 0, &from, &b));
        assert_int_equal(b.n, SAMPLES);
        assert_true(tz_bend_is_plain(&b) == (k == 0));
        for (int i = 0; i < SAMPLES; i++) { /* samples are passed through */
            const tz_vec2 p = tz_bend_apply(&b, b.rest[i]);
            assert_float_equal(b.rest[i].x, (i - 4) * 10, 1e-9);
            assert_float_equal(hypot(p.x - b.at[i].x, p.y - b.at[i].y), 0, 1e-6);
        }
        tz_vec2 before = {0, 0};
        for (double x = -40; x <= 40; x += 0.5) {
            const tz_vec2 p = tz_bend_apply(&b, (tz_vec2){x, -4});
            const tz_vec2 q = tz_bend_apply(&b, (tz_vec2){x, 4});
            const tz_vec2 m = tz_bend_apply(&b, (tz_vec2){x, 0});
            /* the width is kept, the length of the middle line too, no step anywhere */
            assert_float_equal(hypot(p.x - q.x, p.y - q.y), 12, k == 3 ? 1.2 : 0.4);
            if (x > -40)
                assert_float_equal(hypot(m.x - before.x, m.y - before.y), 0.75, 0.1);
            before = m;
            for (double y = -4; y <= 4; y += 2) {
                const tz_vec2 v = {x, y}, w = tz_bend_invert(&b, tz_bend_apply(&b, v));
                assert_float_equal(hypot(w.x - v.x, w.y - v.y), 0, 41e-4);
            }
        }
        tz_bend_deinit(&b);
        tz_element_set_deinit(&s);
        tz_element_set_deinit(&from);
        end_ctx(ctx);
    }
}

/* Without bending the warp is the element's own pose, whatever its samples. */
static void test_plain(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set s;
    tz_bend b;
    make_bar(ctx, &s, 0);
    for (int few = 0; few < 2; few++) { /* 9, found again along the outline; 3: unknown */
        s.element.v[0].samples = few ? 3 : SAMPLES;
        ok(ctx, tz_bend_init(ctx, &s, 0, NULL, &b));
        const tz_vec2 v = {13, -2}, p = tz_bend_apply(&b, v), q = tz_bend_invert(&b, p);
        const double c = cos(0.3) * 1.5, d = sin(0.3) * 1.5;
        if (few) {
            assert_true(b.n == 0 && tz_bend_is_plain(&b));
            assert_float_equal(p.x, 150 + c * v.x - d * v.y, 1e-9);
            assert_float_equal(p.y, 150 + d * v.x + c * v.y, 1e-9);
        }
        assert_float_equal(q.x, v.x, 1e-3);
        assert_float_equal(q.y, v.y, 1e-3);
        tz_bend_deinit(&b);
    }
    tz_element_set_deinit(&s);
    end_ctx(ctx);
}

static void test_snap(void **state)
{
    (void)state;
    for (int shape = 0; shape < 3; shape++) {
        tz_ctx *ctx = new_ctx(1);
        tz_element_set s;
        tz_vec2 rest[SAMPLES];
        make_bar(ctx, &s, 0);
        for (int k = 0; k < SAMPLES; k++)
            rest[k] = (tz_vec2){(k - 4) * 10, 0};
        tz_element *e = &s.element.v[0];
        for (int k = 0; k < SAMPLES; k++) { /* moved, turned by 0.5, drawn out by 1.2 */
            tz_sample *p = &s.sample.v[e->sample + k];
            const double t = (k - 4) * 18, bump = k % 2 ? 1 : -1;
            p->at.x = 170 + t * cos(0.8) - bump * sin(0.8);
            p->at.y = 140 + t * sin(0.8) + bump * cos(0.8);
        }
        const tz_vec3 end = s.sample.v[e->sample].at;
        tz_element_snap(&s, 0, rest, (tz_shape)shape);
        assert_float_equal(e->angle, 0.8, 1e-6);
        assert_float_equal(e->at.x, 170, 1);
        assert_float_equal(e->scale, shape == TZ_SHAPE_SIMILARITY ? 1.8 : 1.5, 1e-6);
        assert_float_equal(e->radius, 41 * e->scale / 1.5, 1e-6);
        for (int k = 0; k < SAMPLES; k++) {
            const tz_vec3 p = s.sample.v[e->sample + k].at;
            const double l = (k - 4) * 10 * e->scale;
            if (shape != TZ_SHAPE_BEND) {
                assert_float_equal(p.x, e->at.x + l * cos(0.8), 1e-6);
                assert_float_equal(p.y, e->at.y + l * sin(0.8), 1e-6);
            } else if (k == 0) {
                assert_true(p.x == end.x && p.y == end.y);
            }
        }
        tz_element_set_deinit(&s);
        end_ctx(ctx);
    }
}

/* ---- paths ----------------------------------------------------------------------- */

/* Path data of a bent bar: each of its points is the warp of one on the bar. */
static void test_path(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set s, from;
    tz_bend b;
    char *d = NULL;
    tz_svg_path path = {0};
    make_bar(ctx, &s, 2);
    make_source(ctx, &from);
    s.element.v[0].source = 0;
    ok(ctx, tz_bend_init(ctx, &s, 0, &from, &b));
    ok(ctx, tz_bend_path(&b, "M-40 -4H40V4H-40Z", (tz_vec2){100, 100}, &d));
    ok(ctx, tz_svg_path_parse(ctx, d, &path));
    const tz_vec2 *p = path.point.v;
    int32_t curves = 0;
    for (int32_t i = 0; i < path.verb.n; i++) {
        const uint8_t verb = path.verb.v[i];
        if (verb == TZ_PATH_CLOSE)
            continue;
        p += verb == TZ_PATH_CUBIC ? 3 : 1;
        curves += verb == TZ_PATH_CUBIC;
        const tz_vec2 v = tz_bend_invert(&b, (tz_vec2){p[-1].x + 100, p[-1].y + 100});
        assert_true(fabs(fabs(v.x) - 40) < 0.02 || fabs(fabs(v.y) - 4) < 0.02);
        assert_true(fabs(v.x) < 40.02 && fabs(v.y) < 4.02);
    }
    assert_true(curves >= 32 && path.verb.v[path.verb.n - 1] == TZ_PATH_CLOSE);
    tz_svg_path_deinit(ctx, &path);
    tz_free(ctx, d);
    assert_int_equal(tz_bend_path(&b, "M0 0L", (tz_vec2){0, 0}, &d), TZ_FORMAT);
    tz_bend_deinit(&b);
    tz_element_set_deinit(&s);
    tz_element_set_deinit(&from);
    tz_ctx_clear(ctx);
    end_ctx(ctx);
}

static void test_markup(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set s;
    tz_bend b;
    char *out = NULL;
    make_bar(ctx, &s, 2);
    ok(ctx, tz_bend_init(ctx, &s, 0, NULL, &b));
    ok(ctx,
       tz_bend_markup(&b,
                      "<g fill='red'><path id=\"a\" d=\"M-40 0H40\" stroke=\"#123\"/>"
                      "<circle cx=\"30\" cy=\"0\" r=\"4\" fill=\"blue\"/></g>",
                      (tz_vec2){0, 0}, &out));
    assert_true(strstr(out, "<g fill='red'><path id=\"a\" d=\"M") == out);
    assert_non_null(strstr(out, "\" stroke=\"#123\"/>"));
    assert_non_null(strstr(out, "Z\" fill=\"blue\"/></g>"));
    assert_null(strstr(out, "cx="));
    /* it is still XML */
    char *doc = malloc(strlen(out) + 200);
    sprintf(doc, "<svg xmlns='http://www.w3.org/2000/svg'>%s</svg>", out);
    tz_svg_doc *svg = NULL;
    ok(ctx, tz_svg_parse(ctx, "bent", doc, strlen(doc), &svg));
    tz_svg_free(svg);
    free(doc);
    tz_free(ctx, out);
    out = NULL;
    assert_int_equal(tz_bend_markup(&b, "<rect width='3'/>", (tz_vec2){0, 0}, &out),
                     TZ_UNSUPPORTED);
    assert_int_equal(tz_bend_markup(&b, "<path transform='scale(2)' d='M0 0'/>",
                                    (tz_vec2){0, 0}, &out),
                     TZ_UNSUPPORTED);
    ok(ctx, tz_bend_markup(&b, "", (tz_vec2){0, 0}, &out));
    assert_string_equal(out, "");
    tz_free(ctx, out);
    static const char *const torn[] = {"<",
                                       "<path d=\"M0 0",
                                       "<circle cx",
                                       "<circle r='3'",
                                       "<path d='M0 0L1 1'",
                                       "text",
                                       "<g",
                                       "<circle =>"};
    for (size_t i = 0; i < sizeof torn / sizeof torn[0]; i++) {
        out = NULL;
        (void)tz_bend_markup(&b, torn[i], (tz_vec2){0, 0}, &out);
        tz_free(ctx, out);
        tz_ctx_clear(ctx);
    }
    tz_bend_deinit(&b);
    tz_element_set_deinit(&s);
    end_ctx(ctx);
}

static char *read_whole(const char *path)
{
    FILE *f = fopen(path, "r");
    assert_non_null(f);
    char *text = calloc(1, 1 << 20);
    assert_true(fread(text, 1, (1 << 20) - 1, f) > 0);
    fclose(f);
    return text;
}

/* A layout of sticks that are bent: the document shows them bent, and reads back as it
 * was; those that are straight stay uses of their symbol. */
static void test_document(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    char dir[64], path[128];
    const char *drawing =
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 200 100'>"
        "<path d='M20 20H100V28H20Z'/><path d='M20 60H100V68H20Z'/></svg>";
    tz_element_set s, back;
    ok(ctx, tz_element_parse_svg(ctx, "sticks", drawing, strlen(drawing), NULL, &s));
    assert_int_equal(s.element.n, 2);
    const tz_element *e = &s.element.v[1];
    assert_true(e->samples > 2);
    for (int32_t k = 0; k < e->samples; k++) { /* a bow */
        tz_vec3 *at = &s.sample.v[e->sample + k].at;
        at->y += (at->x - 60) * (at->x - 60) / 120;
    }
    begin_dir(dir);
    snprintf(path, sizeof path, "%s/bent.svg", dir);
    ok(ctx, tz_element_write_svg(ctx, path, &s));
    char *text = read_whole(path), *hidden = strstr(text, "display=\"none\"");
    assert_non_null(hidden);
    assert_null(strstr(hidden + 1, "display=\"none\"")); /* one of two */
    const char *shown = strstr(hidden, "<g tz:copy=\"1\"");
    assert_non_null(shown);
    assert_non_null(strstr(shown, "<path d=\"M"));
    ok(ctx, tz_element_read_svg(ctx, path, NULL, &back));
    assert_true(back.element.n == 2 && back.sample.n == s.sample.n);
    for (int32_t k = 0; k < s.sample.n; k++)
        assert_memory_equal(&back.sample.v[k].at, &s.sample.v[k].at, sizeof(tz_vec3));
    free(text);
    end_dir(dir);
    tz_element_set_deinit(&s);
    tz_element_set_deinit(&back);
    end_ctx(ctx);
}

static tz_status body(tz_ctx *ctx)
{
    tz_element_set s;
    tz_bend b = {0};
    char *out = NULL;
    tz_status st = pattern_begin(ctx, &s, (tz_domain){.size = {9, 9, 0}}, 1, 4);
    if (st != TZ_OK)
        return st;
    st = pattern_add(&s, 0, 3, 3);
    if (st == TZ_OK)
        st = tz_bend_init(ctx, &s, 0, NULL, &b);
    if (st == TZ_OK)
        st = tz_bend_markup(&b, "<path d=\"M0 0C1 2 3 4 5 6Z\"/><circle r=\"2\"/>",
                            (tz_vec2){0, 0}, &out);
    assert_true((st == TZ_OK) == (out != NULL));
    tz_free(ctx, out);
    tz_bend_deinit(&b);
    tz_element_set_deinit(&s);
    return st;
}

static void test_memory_runs_out(void **state)
{
    (void)state;
    survive(body, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pose),
        cmocka_unit_test(test_pose_is_least_squares),
        cmocka_unit_test(test_warp),
        cmocka_unit_test(test_plain),
        cmocka_unit_test(test_snap),
        cmocka_unit_test(test_path),
        cmocka_unit_test(test_markup),
        cmocka_unit_test(test_document),
        cmocka_unit_test(test_memory_runs_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
