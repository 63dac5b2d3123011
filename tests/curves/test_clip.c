/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Curves cut at rectangles and regions. */
#include "tests/support/curve_fixture.h"

#include <math.h>

#include "base/rng.h"
#include "curves/clip.h"

static double total_length(const tz_curve_set *s)
{
    double sum = 0;
    for (int32_t i = 0; i < s->piece.n; i++) {
        const tz_bezier b = tz_curve_bezier(s, &s->piece.v[i]);
        sum += tz_bezier_length(&b);
    }
    return sum;
}

/* Paths at random with tapers that tell x, and origins that are the curve itself. */
static tz_status scribble(tz_ctx *c, uint64_t seed, bool torus, tz_curve_set *s)
{
    tz_rng g = tz_rng_make(seed, 1);
    int32_t pen, at = 0, to = 0;
    *s = (tz_curve_set){.ctx = c,
                        .domain = {.size = {100, 80, 0}, .torus = torus},
                        .element = {.ctx = c}};
    tz_status st = tz_curve_add_pen(s, (tz_curve_pen){.width = 1, .color = 255}, &pen);
    for (int i = 0; i < 12 && st == TZ_OK; i++) {
        const int32_t first = s->node.n, n = 1 + tz_rng_below(&g, 5);
        st = tz_curve_begin(s, pen);
        if (st == TZ_OK)
            st = tz_curve_add_node(
                s, (tz_vec2){tz_rng_range(&g, 0, 100), tz_rng_range(&g, 0, 80)}, &at);
        for (int32_t k = 0; k < n && st == TZ_OK; k++) {
            const tz_vec2 p = s->node.v[at];
            tz_vec2 q[3];
            for (int j = 0; j < 3; j++)
                q[j] = (tz_vec2){p.x + tz_rng_range(&g, -30, 30),
                                 p.y + tz_rng_range(&g, -30, 30)};
            if (k + 1 == n && n > 2 && i % 2)
                to = first, q[2] = s->node.v[first];
            else
                st = tz_curve_add_node(s, q[2], &to);
            if (st == TZ_OK)
                st = k % 2 ? tz_curve_line(s, at, to)
                           : tz_curve_cubic(s, at, to, q[0],
                                            tz_vec2_add(q[2], (tz_vec2){3, 4}));
            at = to;
        }
        if (st == TZ_OK)
            tz_curve_end(s, true);
    }
    if (st == TZ_OK)
        tz_curve_wrap(s);
    for (int32_t i = 0; i < s->piece.n && st == TZ_OK; i++) {
        const tz_bezier b = tz_curve_bezier(s, &s->piece.v[i]);
        st = tz_array_push(c, &s->origin, b);
        if (st == TZ_OK)
            st = tz_array_push(c, &s->taper, ((tz_curve_taper){1, 2}));
    }
    return st;
}

static double off(const tz_curve_window *w, tz_vec2 p)
{
    const tz_vec2 hi = tz_vec2_add(w->at, w->size);
    return fmin(fmin(p.x - w->at.x, hi.x - p.x), fmin(p.y - w->at.y, hi.y - p.y));
}

/* Inside and outside make up the whole; what is kept lies where it is to; origins are the
 * parts themselves. */
static void test_rectangle(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 16; seed++) {
        tz_curve_set s, part[2];
        ok(ctx, scribble(ctx, seed, seed & 1, &s));
        ok(ctx, tz_curve_set_check(ctx, &s, "scribble"));
        const tz_curve_window w = {.at = {20, 10}, .size = {50, 45}};
        double sum = 0;
        for (int k = 0; k < 2; k++) {
            tz_curve_window v = w;
            v.outside = k;
            ok(ctx, tz_curve_clip(ctx, &s, &v, &part[k]));
            ok(ctx, tz_curve_set_check(ctx, &part[k], "part"));
            assert_int_equal(part[k].origin.n, part[k].piece.n);
            assert_int_equal(part[k].taper.n, part[k].piece.n);
            sum += total_length(&part[k]);
            for (int32_t i = 0; i < part[k].piece.n; i++) {
                const tz_bezier b = tz_curve_bezier(&part[k], &part[k].piece.v[i]);
                for (int j = 0; j <= 10; j++) {
                    const tz_vec2 p = tz_bezier_at(&b, j / 10.0),
                                  q = tz_bezier_at(&part[k].origin.v[i], j / 10.0);
                    const tz_vec3 in = tz_domain_wrap(&s.domain, (tz_vec3){p.x, p.y, 0});
                    const double d = off(&w, (tz_vec2){in.x, in.y});
                    assert_true(k ? d <= 1e-6 : d >= -1e-6);
                    const tz_vec2 near = tz_curve_copy(&s.domain, q, p);
                    assert_true(hypot(near.x - p.x, near.y - p.y) < 1e-6);
                }
            }
        }
        if (fabs(sum - total_length(&s)) > 1e-3 * sum) /* cusps */
            fail_msg("%g of %g", sum, total_length(&s));
        tz_curve_set_deinit(&part[0]);
        tz_curve_set_deinit(&part[1]);
        tz_curve_set_deinit(&s);
    }
}

/* What lies inside as a whole is the same to the bit, and widths run on at cuts. */
static void test_whole(void **state)
{
    (void)state;
    tz_curve_set s, out;
    ok(ctx, scribble(ctx, 4, false, &s));
    const tz_curve_window all = {.at = {-1e3, -1e3}, .size = {3e3, 3e3}},
                          half = {.at = {-1e3, -1e3}, .size = {1050, 3e3}};
    ok(ctx, tz_curve_clip(ctx, &s, &all, &out));
    assert_int_equal(out.piece.n, s.piece.n);
    assert_int_equal(out.path.n, s.path.n);
    assert_true(fabs(total_length(&out) - total_length(&s)) < 1e-9);
    tz_curve_set_deinit(&out);
    ok(ctx, tz_curve_clip(ctx, &s, &half, &out));
    int cuts = 0;
    for (int32_t i = 0; i < out.piece.n; i++)
        if (fabs(out.node.v[out.piece.v[i].to].x - 50) < 1e-6) {
            assert_true(out.taper.v[i].to > 1 && out.taper.v[i].to < 2);
            cuts++;
        }
    assert_true(cuts > 2);
    tz_curve_set_deinit(&out);
    fails(ctx, tz_curve_clip(ctx, &s, &(tz_curve_window){.size = {1, 0}}, &out),
          TZ_INVALID, "window");
    fails(ctx, tz_curve_clip(ctx, &s, &(tz_curve_window){.size = {NAN, 1}}, &out),
          TZ_INVALID, "window");
    tz_curve_set_deinit(&s);
}

static tz_status clip_once(tz_ctx *c)
{
    const tz_curve_window w = {.at = {20, 10}, .size = {50, 45}};
    tz_curve_set s, out;
    tz_status st = scribble(c, 3, true, &s);
    memset(&out, 0, sizeof out);
    if (st == TZ_OK)
        st = tz_curve_clip(c, &s, &w, &out);
    tz_curve_set_deinit(&s);
    tz_curve_set_deinit(&out);
    return st;
}

static void test_memory(void **state)
{
    (void)state;
    survive(clip_once, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_rectangle, begin, end),
        cmocka_unit_test_setup_teardown(test_whole, begin, end),
        cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
