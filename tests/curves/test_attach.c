/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Elements that sit on lines. */
#include "tests/support/curve_fixture.h"

#include <math.h>

#include "base/rng.h"
#include "curves/attach.h"
#include "tests/support/elements.h"

static void near(double a, double b, double tolerance)
{
    if (!(fabs(a - b) <= tolerance))
        fail_msg("%.17g is not %.17g", a, b);
}

/* A vine: an arc about 0, -200, and leaves beside it on both sides, one at its end and one
 * far off. */
static tz_status vine(tz_ctx *c, double radius, tz_curve_set *s)
{
    int32_t pen, a = 0, b = 0;
    *s = (tz_curve_set){
        .ctx = c, .domain = {.size = {300, 300, 0}}, .element = {.ctx = c}};
    tz_status st = tz_curve_add_pen(s, (tz_curve_pen){.width = 2, .color = 255}, &pen);
    if (st == TZ_OK)
        st = tz_curve_begin(s, pen);
    for (int i = 0; i <= 8 && st == TZ_OK; i++) {
        const double t = 0.1 * i, k = radius * 4 / 3 * tan(0.1 / 4);
        const tz_vec2 p = {20 + radius * sin(t), 20 + radius - radius * cos(t)};
        st = tz_curve_add_node(s, p, &b);
        if (i > 0 && st == TZ_OK) {
            const tz_vec2 q = s->node.v[a];
            st = tz_curve_cubic(s, a, b,
                                (tz_vec2){q.x + k * cos(t - 0.1), q.y + k * sin(t - 0.1)},
                                (tz_vec2){p.x - k * cos(t), p.y - k * sin(t)});
        }
        a = b;
    }
    if (st == TZ_OK)
        tz_curve_end(s, false);
    return st;
}

/* A leaf at t of the arc, so far outside of it. */
static tz_status add_leaf(tz_curve_set *s, double radius, double t, double off,
                          double angle, int32_t source)
{
    tz_element_set *e = &s->element;
    const double r = radius - off;
    const tz_vec3 at = {20 + r * sin(t), 20 + radius - r * cos(t), 0};
    tz_status st = tz_array_push(e->ctx, &e->sample, ((tz_sample){at, 0, 1}));
    if (st == TZ_OK)
        st = tz_array_push(e->ctx, &e->element,
                           ((tz_element){.source = source,
                                         .sample = e->sample.n - 1,
                                         .samples = 1,
                                         .at = at,
                                         .angle = angle + t,
                                         .scale = 1,
                                         .radius = 6}));
    return st;
}

static tz_status leaves(tz_curve_set *s, double radius, double jitter, uint64_t seed,
                        bool copies)
{
    tz_rng g = tz_rng_make(seed, 4);
    tz_status st = TZ_OK;
    s->element.domain = s->domain;
    for (int i = 0; i < 10 && st == TZ_OK; i++)
        st = add_leaf(s, radius, 0.05 + 0.07 * i + jitter * tz_rng_range(&g, -0.01, 0.01),
                      (i % 2 ? 5 : -5) + jitter * tz_rng_range(&g, -3, 3),
                      0.5 + jitter * tz_rng_range(&g, -0.3, 0.3), copies ? i : -1);
    if (st == TZ_OK)
        st = add_leaf(s, radius, 0.4, 60, 0.5, copies ? 10 : -1); /* far off */
    return st;
}

static void test_seats(void **state)
{
    (void)state;
    tz_curve_set s;
    tz_curve_seat *seat;
    ok(ctx, vine(ctx, 250, &s));
    ok(ctx, leaves(&s, 250, 0, 1, false));
    ok(ctx, tz_curve_seats(ctx, &s, &seat));
    for (int i = 0; i < 10; i++) {
        assert_true(seat[i].sits);
        assert_false(seat[i].at_end);
        near(seat[i].along, 0, 1e-3);
        near(seat[i].across, i % 2 ? 5 : -5, 1e-3);
        near(seat[i].angle, 0.05 + 0.07 * i, 1e-3);
    }
    assert_false(seat[10].sits);
    tz_free(ctx, seat);
    tz_curve_set_deinit(&s);
}

/* Leaves that have lost their place by a little come back to it on another vine; those
 * which are in it stay; what sits on no line is left alone. */
static void test_back(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 8; seed++) {
        tz_curve_set x, s;
        int32_t moved;
        ok(ctx, vine(ctx, 250, &x));
        ok(ctx, leaves(&x, 250, 0, 1, false));
        ok(ctx, vine(ctx, 180, &s));
        ok(ctx, leaves(&s, 180, seed > 0, seed, true));
        const tz_vec3 far = s.element.element.v[10].at;
        ok(ctx, tz_curve_attach(ctx, &x, 0, &s, &moved));
        assert_int_equal(moved, 10);
        for (int i = 0; i < 10; i++) {
            const tz_element *e = &s.element.element.v[i];
            const double t = atan2(e->at.x - 20, 20 + 180 - e->at.y);
            near(180 - hypot(e->at.x - 20, e->at.y - 200), i % 2 ? 5 : -5, 1e-3);
            near(e->angle, t + 0.5, 1e-3);
            near(s.element.sample.v[e->sample].at.x, e->at.x, 1e-9);
        }
        assert_memory_equal(&far, &s.element.element.v[10].at, sizeof far);
        s.element.element.v[3].source = 99;
        fails(ctx, tz_curve_attach(ctx, &x, 0, &s, NULL), TZ_INVALID, "element 3");
        fails(ctx, tz_curve_attach(ctx, &x, NAN, &s, NULL), TZ_INVALID, "reach");
        tz_curve_set_deinit(&x);
        tz_curve_set_deinit(&s);
    }
}

/* One at the end of a line goes to an end, and points outwards as it did. */
static void test_ends(void **state)
{
    (void)state;
    tz_curve_set x, s;
    tz_curve_seat *seat;
    ok(ctx, vine(ctx, 250, &x));
    x.element.domain = x.domain;
    const tz_vec2 tip = x.node.v[x.node.n - 1], u = {cos(0.8), sin(0.8)};
    const tz_vec3 at = {tip.x + 4 * u.x, tip.y + 4 * u.y, 0};
    ok(ctx, tz_array_push(ctx, &x.element.sample, ((tz_sample){at, 0, 1})));
    ok(ctx, tz_array_push(ctx, &x.element.element,
                          ((tz_element){.source = -1,
                                        .samples = 1,
                                        .at = at,
                                        .angle = 0.8,
                                        .scale = 1,
                                        .radius = 6})));
    ok(ctx, tz_curve_seats(ctx, &x, &seat));
    assert_true(seat[0].sits && seat[0].at_end);
    near(seat[0].along, 4, 1e-9);
    near(seat[0].across, 0, 1e-6);
    tz_free(ctx, seat);
    ok(ctx, vine(ctx, 200, &s));
    s.element.domain = s.domain;
    const tz_vec2 head = s.node.v[0]; /* leaves to the left */
    const tz_vec3 off = {head.x - 7, head.y + 3, 0};
    ok(ctx, tz_array_push(ctx, &s.element.sample, ((tz_sample){off, 0, 1})));
    ok(ctx, tz_array_push(ctx, &s.element.element,
                          ((tz_element){.source = 0,
                                        .samples = 1,
                                        .at = off,
                                        .angle = 3,
                                        .scale = 1,
                                        .radius = 6})));
    ok(ctx, tz_curve_attach(ctx, &x, 0, &s, NULL));
    const tz_element *e = &s.element.element.v[0];
    near(e->at.x, head.x - 4, 1e-4);
    near(e->at.y, head.y, 1e-3);
    near(cos(e->angle), -1, 1e-6);
    tz_curve_set_deinit(&x);
    tz_curve_set_deinit(&s);
}

static tz_status attach_once(tz_ctx *c)
{
    tz_curve_set x, s;
    memset(&s, 0, sizeof s);
    tz_status st = vine(c, 250, &x);
    if (st == TZ_OK)
        st = leaves(&x, 250, 0, 1, false);
    if (st == TZ_OK)
        st = vine(c, 180, &s);
    if (st == TZ_OK)
        st = leaves(&s, 180, 1, 2, true);
    if (st == TZ_OK)
        st = tz_curve_attach(c, &x, 0, &s, NULL);
    tz_curve_set_deinit(&x);
    tz_curve_set_deinit(&s);
    return st;
}

static void test_memory(void **state)
{
    (void)state;
    survive(attach_once, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_seats, begin, end),
        cmocka_unit_test_setup_teardown(test_back, begin, end),
        cmocka_unit_test_setup_teardown(test_ends, begin, end),
        cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
