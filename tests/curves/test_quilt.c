/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Quilts of curves: what holds for any of them. */
#include "tests/support/curve_fixture.h"

#include <math.h>

#include "curves/curve_io.h"
#include "curves/quilt.h"

#define HEAD                                     \
    "<svg xmlns=\"http://www.w3.org/2000/svg\" " \
    "viewBox=\"0 0 120 120\"><g fill=\"none\" stroke=\"#204060\" stroke-width=\"1\">"
#define TAIL "</g></svg>"

static tz_status parse(tz_ctx *c, const char *text, tz_curve_set *set)
{
    return tz_curve_parse_svg(c, "t.svg", text, strlen(text), NULL, set);
}

/* Waves from side to side, some of which branch: 12 lines. */
static char *waves(char *text, size_t size)
{
    size_t n = (size_t)snprintf(text, size, "%s", HEAD);
    for (int i = 0; i < 12; i++) {
        const int y = 5 + 10 * i;
        n += (size_t)snprintf(
            text + n, size - n,
            "<path d='M0 %dC15 %d 15 %d 30 %dC45 %d 45 %d 60 %dC75 %d 75 %d 90 %d"
            "C105 %d 105 %d 120 %d'/>",
            y, y - 4 - i % 3, y - 4, y, y + 4, y + 5, y, y - 5, y - 3 - i % 2, y, y + 5,
            y + 5, y);
        if (i % 3 == 1)
            n += (size_t)snprintf(text + n, size - n, "<path d='M60 %dL70 %d'/>", y,
                                  y + 6);
    }
    snprintf(text + n, size - n, "%s", TAIL);
    return text;
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

static void same(const tz_curve_set *a, const tz_curve_set *b)
{
    assert_int_equal(a->node.n, b->node.n);
    assert_int_equal(a->piece.n, b->piece.n);
    assert_int_equal(a->path.n, b->path.n);
    if (a->piece.n == 0)
        return;
    assert_memory_equal(a->node.v, b->node.v, (size_t)a->node.n * sizeof *a->node.v);
    for (int32_t i = 0; i < a->piece.n; i++)
        assert_true(a->piece.v[i].from == b->piece.v[i].from &&
                    a->piece.v[i].a.x == b->piece.v[i].a.x &&
                    a->piece.v[i].b.y == b->piece.v[i].b.y);
}

/* Every origin is a part of some piece of the exemplar: its ends lie on it. */
static void has_origins(const tz_curve_set *e, const tz_curve_set *out)
{
    assert_int_equal(out->origin.n, out->piece.n);
    for (int32_t i = 0; i < out->origin.n; i += 7)
        for (int k = 0; k < 4; k += 3) {
            double best = INFINITY;
            const tz_vec2 p = out->origin.v[i].p[k];
            for (int32_t j = 0; j < e->piece.n && best > 1e-3; j++) {
                const tz_bezier b = tz_curve_bezier(e, &e->piece.v[j]);
                for (int t = 0; t <= 2000; t++)
                    best = fmin(best, tz_vec2_length(
                                          tz_vec2_sub(tz_bezier_at(&b, t / 2000.0), p)));
            }
            assert_true(best < 0.05);
        }
}

static void test_any_threads(void **state)
{
    (void)state;
    char text[8192];
    tz_curve_set first = {0};
    const int threads[3] = {1, 2, 8};
    for (int i = 0; i < 3; i++) {
        tz_ctx *c = new_ctx(threads[i]);
        tz_curve_set e, out;
        tz_curve_quilt_report r;
        const tz_domain d = {.size = {400, 360, 0}};
        ok(c, parse(c, waves(text, sizeof text), &e));
        const tz_curve_quilt_job job = {.exemplar = &e, .domain = &d, .seed = 5};
        ok(c, tz_curve_quilt(c, &job, &out, &r));
        ok(c, tz_curve_set_check(c, &out, "out"));
        assert_true(r.patches > 4 && r.crossings > 20 && r.joined <= r.crossings);
        if (i == 0) {
            const double ratio = length_of(&out) / (400 * 360.0) / length_of(&e) * 14400;
            assert_true(ratio > 0.85 && ratio < 1.15);
            assert_true(r.joined > 0.9 * r.crossings);
            has_origins(&e, &out);
            tz_curve_set_deinit(&e);
            first = out;
            continue;
        }
        same(&first, &out);
        tz_curve_set_deinit(&out);
        tz_curve_set_deinit(&e);
        end_ctx(c);
    }
    tz_ctx *c = first.ctx;
    tz_curve_set_deinit(&first);
    end_ctx(c);
}

/* A grid's lines run on exactly: only straight, level or upright, in the grid's rhythm. */
static void test_regular(void **state)
{
    (void)state;
    char text[8192];
    size_t n = (size_t)snprintf(text, sizeof text, "%s", HEAD);
    for (int i = 0; i < 10; i++)
        n += (size_t)snprintf(text + n, sizeof text - n,
                              "<path d='M0 %dL120 %d'/><path d='M%d 0L%d 120'/>",
                              6 + 12 * i, 6 + 12 * i, 6 + 12 * i, 6 + 12 * i);
    snprintf(text + n, sizeof text - n, "%s", TAIL);
    tz_curve_set e, out;
    tz_curve_quilt_report r;
    const tz_domain d = {.size = {360, 300, 0}};
    ok(ctx, parse(ctx, text, &e));
    const tz_curve_quilt_job job = {.exemplar = &e, .domain = &d, .seed = 2};
    ok(ctx, tz_curve_quilt(ctx, &job, &out, &r));
    ok(ctx, tz_curve_set_check(ctx, &out, "out"));
    if (r.joined < 0.97 * r.crossings)
        fail_msg("%d of %d joined", r.joined, r.crossings);
    for (int32_t i = 0; i < out.piece.n; i++) {
        const tz_bezier b = tz_curve_bezier(&out, &out.piece.v[i]);
        const double x = fabs(b.p[3].x - b.p[0].x), y = fabs(b.p[3].y - b.p[0].y);
        assert_true(out.piece.v[i].straight);
        assert_true(fmin(x, y) < 0.05 * fmax(x, y) + 0.05);
    }
    tz_curve_set_deinit(&out);
    tz_curve_set_deinit(&e);
}

/* Small strokes are whole or not there. */
static void test_things(void **state)
{
    (void)state;
    char text[8192];
    size_t n = (size_t)snprintf(text, sizeof text, "%s", HEAD);
    for (int i = 0; i < 8; i++)
        for (int j = 0; j < 8; j++)
            n += (size_t)snprintf(text + n, sizeof text - n, "<path d='M%d %dl%d 5'/>",
                                  5 + 14 * i + j % 3, 5 + 14 * j + i % 4, 6);
    snprintf(text + n, sizeof text - n, "%s", TAIL);
    tz_curve_set e, out;
    const tz_domain d = {.size = {300, 300, 0}, .torus = true};
    ok(ctx, parse(ctx, text, &e));
    const tz_curve_quilt_job job = {.exemplar = &e, .domain = &d, .seed = 2};
    ok(ctx, tz_curve_quilt(ctx, &job, &out, NULL));
    assert_true(out.path.n > 200);
    for (int32_t i = 0; i < out.piece.n; i++) {
        const tz_bezier b = tz_curve_bezier(&out, &out.piece.v[i]);
        assert_true(fabs(tz_bezier_length(&b) - hypot(6, 5)) < 1e-6);
    }
    tz_curve_set_deinit(&out);
    tz_curve_set_deinit(&e);
}

/* On a torus no end lies where a plain domain would have cut it. */
static void test_torus(void **state)
{
    (void)state;
    char text[8192];
    tz_curve_set e, out;
    tz_curve_quilt_report r;
    const tz_domain d = {.size = {240, 240, 0}, .torus = true};
    ok(ctx, parse(ctx, waves(text, sizeof text), &e));
    const tz_curve_quilt_job job = {.exemplar = &e, .domain = &d, .seed = 3};
    ok(ctx, tz_curve_quilt(ctx, &job, &out, &r));
    ok(ctx, tz_curve_set_check(ctx, &out, "out"));
    assert_true(r.joined > 0.85 * r.crossings);
    int32_t cut = 0;
    for (int32_t i = 0; i < out.path.n; i++) {
        const tz_curve_path *p = &out.path.v[i];
        const tz_vec2 a = out.node.v[out.piece.v[p->piece].from];
        cut += !p->closed && (fabs(a.x) < 1e-6 || fabs(a.x - 240) < 1e-6);
    }
    assert_int_equal(cut, 0);
    for (int32_t i = 0; i < out.piece.n; i++) { /* no piece jumps over the domain */
        const tz_bezier b = tz_curve_bezier(&out, &out.piece.v[i]);
        assert_true(tz_bezier_length(&b) < 60);
    }
    tz_curve_set_deinit(&out);
    tz_curve_set_deinit(&e);
}

static void test_region(void **state)
{
    (void)state;
    char text[8192];
    float mask[64 * 64];
    tz_region *region = NULL;
    tz_curve_set e, out;
    const tz_vec3 size = {300, 300, 0};
    for (int i = 0; i < 64 * 64; i++)
        mask[i] = hypot(i % 64 - 31.5, i / 64 - 31.5) < 25 ? 1 : 0;
    ok(ctx, tz_region_from_mask(ctx, mask, 64, 64, size, false, &region));
    const tz_domain d = {.size = size, .region = region};
    ok(ctx, parse(ctx, waves(text, sizeof text), &e));
    const tz_curve_quilt_job job = {.exemplar = &e, .domain = &d, .seed = 3};
    ok(ctx, tz_curve_quilt(ctx, &job, &out, NULL));
    ok(ctx, tz_curve_set_check(ctx, &out, "out"));
    assert_true(out.path.n > 10);
    for (int32_t i = 0; i < out.node.n; i++)
        assert_true(tz_domain_depth(&d, (tz_vec3){out.node.v[i].x, out.node.v[i].y, 0}) >
                    -4);
    tz_curve_set_deinit(&out);
    tz_curve_set_deinit(&e);
    tz_region_free(region);
}

/* Lines turn with the frames. */
static void test_frames(void **state)
{
    (void)state;
    tz_frames *frames = NULL;
    tz_curve_set e, out;
    const tz_vec3 size = {300, 300, 0};
    char text[8192];
    size_t n = (size_t)snprintf(text, sizeof text, "%s", HEAD);
    for (int i = 0; i < 12; i++)
        n += (size_t)snprintf(text + n, sizeof text - n, "<path d='M0 %dL120 %d'/>",
                              5 + 10 * i, 5 + 10 * i);
    snprintf(text + n, sizeof text - n, "%s", TAIL);
    ok(ctx, tz_frames_from_formula(ctx, "30", size, false, &frames));
    const tz_domain d = {.size = size, .frames = frames};
    ok(ctx, parse(ctx, text, &e));
    const tz_curve_quilt_job job = {.exemplar = &e, .domain = &d, .seed = 3};
    ok(ctx, tz_curve_quilt(ctx, &job, &out, NULL));
    double good = 0, all = 0;
    for (int32_t i = 0; i < out.piece.n; i++) {
        const tz_bezier b = tz_curve_bezier(&out, &out.piece.v[i]);
        const double length = tz_bezier_length(&b),
                     a = atan2(b.p[3].y - b.p[0].y, b.p[3].x - b.p[0].x);
        all += length;
        good += fabs(sin(a - TZ_PI / 6)) < 0.1 ? length : 0;
    }
    assert_true(all > 0 && good > 0.95 * all);
    tz_curve_set_deinit(&out);
    tz_curve_set_deinit(&e);
    tz_frames_free(frames);
}

/* Where something is given nothing is laid, and its ends are met. */
static void test_given(void **state)
{
    (void)state;
    char text[8192];
    float mask[64 * 64];
    tz_region *region = NULL;
    tz_curve_set e, out;
    tz_curve_quilt_report r;
    const tz_domain d = {.size = {120, 120, 0}};
    for (int i = 0; i < 64 * 64; i++) /* the right third is open */
        mask[i] = i % 64 < 42 ? 1 : 0;
    ok(ctx, tz_region_from_mask(ctx, mask, 64, 64, d.size, false, &region));
    ok(ctx, parse(ctx, waves(text, sizeof text), &e));
    const tz_curve_quilt_job job = {
        .exemplar = &e, .domain = &d, .given = &e, .given_region = region, .seed = 3};
    ok(ctx, tz_curve_quilt(ctx, &job, &out, &r));
    ok(ctx, tz_curve_set_check(ctx, &out, "out"));
    assert_true(out.path.n > 3);
    for (int32_t i = 0; i < out.node.n; i++)
        assert_true(out.node.v[i].x > 70);
    tz_curve_set_deinit(&out);
    tz_curve_set_deinit(&e);
    tz_region_free(region);
}

static void test_odd(void **state)
{
    (void)state;
    static const char *const body[] = {
        HEAD "<path d='M10 60L110 60'/>" TAIL,
        HEAD "<circle cx='60' cy='60' r='20'/>" TAIL,
        HEAD "<circle cx='60' cy='60' r='59'/>" TAIL,
        HEAD "<path d='M10 60L110 60L10 60L110 60'/>" TAIL,
        HEAD "<path d='M60 60L60.0001 60'/><path d='M3 3L4 4'/>" TAIL,
        HEAD "<path d='M0 0L120 120M0 120L120 0M60 0L60 120M0 60L120 60'/>" TAIL,
    };
    static const tz_vec3 size[] = {{120, 120, 0}, {7, 3, 0}, {300, 20, 0}, {150, 180, 0}};
    for (size_t i = 0; i < sizeof body / sizeof *body; i++)
        for (size_t k = 0; k < 2 * sizeof size / sizeof *size; k++) {
            tz_curve_set e, out;
            tz_curve_quilt_report r;
            const tz_domain d = {.size = size[k / 2], .torus = k % 2};
            ok(ctx, parse(ctx, body[i], &e));
            const tz_curve_quilt_job job = {.exemplar = &e, .domain = &d, .seed = k};
            ok(ctx, tz_curve_quilt(ctx, &job, &out, &r));
            ok(ctx, tz_curve_set_check(ctx, &out, "out"));
            tz_curve_set_deinit(&out);
            tz_curve_set_deinit(&e);
        }
}

/* Patches are never so small that laying them has no end. */
static void test_small_patches(void **state)
{
    (void)state;
    char text[4096];
    tz_curve_set e;
    tz_curve_set out;
    tz_curve_quilt_report r;
    ok(ctx, parse(ctx, waves(text, sizeof text), &e));
    const tz_domain d = {.size = {150, 120, 0}};
    tz_curve_quilt_params p;
    tz_params_default(&tz_curve_quilt_param_table, &p);
    p.patch = 1e-12;
    const tz_curve_quilt_job job = {
        .exemplar = &e, .domain = &d, .params = &p, .seed = 1};
    ok(ctx, tz_curve_quilt(ctx, &job, &out, &r));
    assert_in_range(r.patches, 1, 4000);
    assert_true(length_of(&out) > 0.3 * length_of(&e));
    tz_curve_set_deinit(&out);
    tz_curve_set_deinit(&e);
}

static void test_bad(void **state)
{
    (void)state;
    tz_curve_set e, out;
    tz_curve_set none = {.ctx = ctx, .domain = {.size = {10, 10, 0}}};
    tz_domain d = {.size = {100, 100, 0}};
    tz_curve_quilt_job job = {.exemplar = &none, .domain = &d};
    fails(ctx, tz_curve_quilt(ctx, &job, &out, NULL), TZ_INVALID, "nothing");
    assert_null(out.node.v);
    ok(ctx, parse(ctx, HEAD "<path d='M10 60L110 60'/>" TAIL, &e));
    job.exemplar = &e;
    d.size.x = NAN;
    fails(ctx, tz_curve_quilt(ctx, &job, &out, NULL), TZ_INVALID, "area");
    d.size.x = 1e9;
    fails(ctx, tz_curve_quilt(ctx, &job, &out, NULL), TZ_LIMIT, "tiles");
    d.size.x = 100;
    e.node.v[0].x = NAN;
    fails(ctx, tz_curve_quilt(ctx, &job, &out, NULL), TZ_INVALID, "exemplar");
    assert_null(out.node.v);
    tz_curve_set_deinit(&e);
}

static tz_status quilt_small(tz_ctx *c)
{
    static const char text[] =
        HEAD "<path d='M0 20C40 0 80 40 120 20M0 60L120 60M0 90L120 95M60 60L60 90'/>"
             "<path d='M20 40l8 3'/><circle cx='90' cy='40' r='5'/>" TAIL;
    tz_curve_set e, out;
    const tz_domain d = {.size = {135, 60, 0}};
    tz_status st = parse(c, text, &e);
    if (st != TZ_OK)
        return st;
    const tz_curve_quilt_job job = {.exemplar = &e, .domain = &d, .seed = 1};
    st = tz_curve_quilt(c, &job, &out, NULL);
    if (st == TZ_OK)
        tz_curve_set_deinit(&out);
    else
        assert_null(out.node.v);
    tz_curve_set_deinit(&e);
    return st;
}

static void test_memory(void **state)
{
    (void)state;
    survive(quilt_small, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_any_threads),
        cmocka_unit_test_setup_teardown(test_regular, begin, end),
        cmocka_unit_test_setup_teardown(test_things, begin, end),
        cmocka_unit_test_setup_teardown(test_torus, begin, end),
        cmocka_unit_test_setup_teardown(test_region, begin, end),
        cmocka_unit_test_setup_teardown(test_frames, begin, end),
        cmocka_unit_test_setup_teardown(test_given, begin, end),
        cmocka_unit_test_setup_teardown(test_odd, begin, end),
        cmocka_unit_test_setup_teardown(test_small_patches, begin, end),
        cmocka_unit_test_setup_teardown(test_bad, begin, end),
        cmocka_unit_test_setup_teardown(test_memory, begin, end),
    };
    return cmocka_run_group_tests_name("quilt", tests, NULL, NULL);
}
