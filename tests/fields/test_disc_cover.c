/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Discs that cover an outline, their graph, and its distances. */
#include "tests/base/check.h"

#include <math.h>

#include "fields/disc_cover.h"

static const int32_t one_part[1] = {0};

static void rectangle(double w, double h, double angle, tz_vec2 v[4])
{
    static const int x[4] = {-1, 1, 1, -1}, y[4] = {-1, -1, 1, 1};
    for (int k = 0; k < 4; k++) {
        const double u = x[k] * w / 2, q = y[k] * h / 2;
        v[k] =
            (tz_vec2){cos(angle) * u - sin(angle) * q, sin(angle) * u + cos(angle) * q};
    }
}

static bool connected(const tz_disc_cover *c)
{
    int up[TZ_COVER_DISCS], left = c->n;
    for (int i = 0; i < c->n; i++)
        up[i] = i;
    for (int32_t e = 0; e < c->edges; e++) {
        const int a = up[c->edge[e][0]], b = up[c->edge[e][1]];
        if (a == b)
            continue;
        for (int i = 0; i < c->n; i++)
            up[i] = up[i] == b ? a : up[i];
        left--;
    }
    return left == 1;
}

static void a_disc_is_one_disc(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_disc_cover c;
    ok(ctx, tz_disc_cover_init(ctx, NULL, 0, NULL, 0, 5, 9, 0.97, &c));
    assert_int_equal(c.n, 1);
    assert_true(fabs(c.disc[0].radius - 5) < 0.15);
    assert_true(fabs(c.area / (TZ_PI * 25) - 1) < 0.03);
    assert_true(fabs(tz_shape_distance_at(&c.distance, (tz_vec2){3, 0}, NULL) - 2) < 0.1);
    assert_true(fabs(tz_shape_distance_at(&c.distance, (tz_vec2){9, 0}, NULL) + 4) < 0.3);
    tz_disc_cover_deinit(&c);
    end_ctx(ctx);
}

/* A strip gets a chain of discs of half its width, evenly spaced, at any angle. */
static void strips_are_chains(void **state)
{
    (void)state;
    for (int k = 0; k < 3; k++) {
        tz_ctx *ctx = new_ctx(1);
        tz_disc_cover c;
        tz_vec2 v[4];
        const double angle = 0.7 * k;
        rectangle(60, 10, angle, v);
        ok(ctx, tz_disc_cover_init(ctx, v, 4, one_part, 1, 31, 12, 0.97, &c));
        assert_true(c.n >= 4 && c.n <= 10);
        assert_true(connected(&c));
        assert_true(c.covered > 0.7);
        assert_true(c.beyond < 0.03);
        assert_true(fabs(c.area / 600 - 1) < 0.06);
        double lo = HUGE_VAL, hi = -HUGE_VAL;
        for (int i = 0; i < c.n; i++) {
            const tz_vec2 p = c.disc[i].at;
            const double along = cos(angle) * p.x + sin(angle) * p.y;
            assert_true(fabs(cos(angle) * p.y - sin(angle) * p.x) < 2.5);
            assert_true(c.disc[i].radius <= 5.3);
            lo = fmin(lo, along), hi = fmax(hi, along);
        }
        assert_true(lo < -20 && hi > 20);
        tz_disc_cover_deinit(&c);
        end_ctx(ctx);
    }
}

static void discs_lie_inside_and_hang_together(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_disc_cover c;
    tz_vec2 star[20], two[8];
    static const int32_t parts[2] = {0, 4};
    for (int k = 0; k < 20; k++) {
        const double r = k % 2 ? 4 : 10;
        star[k] = (tz_vec2){r * cos(TZ_PI * k / 10), r * sin(TZ_PI * k / 10)};
    }
    ok(ctx, tz_disc_cover_init(ctx, star, 20, one_part, 1, 10, TZ_COVER_DISCS, 0.97, &c));
    assert_true(c.n > 1 && connected(&c));
    for (int i = 0; i < c.n; i++)
        assert_true(tz_shape_distance_at(&c.distance, c.disc[i].at, NULL) >
                    c.disc[i].radius - 0.2);
    tz_disc_cover_deinit(&c);
    rectangle(4, 4, 0, two), rectangle(4, 4, 0, two + 4); /* in two pieces */
    for (int k = 0; k < 4; k++)
        two[k].x -= 6, two[k + 4].x += 6;
    ok(ctx, tz_disc_cover_init(ctx, two, 8, parts, 2, 9, 9, 0.97, &c));
    assert_true(c.n >= 2 && connected(&c));
    assert_true(fabs(c.area - 32) < 4);
    tz_disc_cover_deinit(&c);
    end_ctx(ctx);
}

static void odd_outlines(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_disc_cover c;
    const tz_vec2 bow[4] = {{-5, -5}, {5, 5}, {5, -5}, {-5, 5}}; /* crosses itself */
    const tz_vec2 line[3] = {{-5, 0}, {0, 0}, {5, 0}}, same[3] = {{1, 1}, {1, 1}, {1, 1}};
    const tz_vec2 bad[3] = {{0, 0}, {NAN, 1}, {1, 1}};
    ok(ctx, tz_disc_cover_init(ctx, bow, 4, one_part, 1, 8, 9, 0.97, &c));
    assert_true(c.n >= 2 && connected(&c));
    tz_disc_cover_deinit(&c);
    ok(ctx, tz_disc_cover_init(ctx, line, 3, one_part, 1, 5, 9, 0.97, &c));
    assert_true(c.n >= 1 && c.disc[0].radius > 0);
    tz_disc_cover_deinit(&c);
    ok(ctx, tz_disc_cover_init(ctx, same, 3, one_part, 1, 5, 9, 0.97, &c));
    assert_true(c.n == 1 && c.disc[0].radius > 0);
    tz_disc_cover_deinit(&c);
    fails(ctx, tz_disc_cover_init(ctx, bad, 3, one_part, 1, 5, 9, 0.97, &c), TZ_INVALID,
          "point 1");
    fails(ctx, tz_disc_cover_init(ctx, bow, 4, one_part, 1, 0, 9, 0.97, &c), TZ_INVALID,
          "radius 0");
    end_ctx(ctx);
}

/* A vein and a second coat of paint change nothing: the shape is the silhouette. */
static void what_is_painted_on_is_no_hole(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_disc_cover plain, painted;
    static const int32_t part[3] = {0, 4, 7};
    tz_vec2 v[11];
    rectangle(40, 16, 0.2, v);
    rectangle(20, 0, 0.2, v + 4); /* three of its points: a line along the middle */
    rectangle(10, 6, 0.2, v + 7);
    ok(ctx, tz_disc_cover_init(ctx, v, 4, one_part, 1, 22, 9, 0.97, &plain));
    ok(ctx, tz_disc_cover_init(ctx, v, 11, part, 3, 22, 9, 0.97, &painted));
    assert_true(fabs(painted.area - plain.area) < 0.01 * plain.area);
    assert_true(fabs(plain.area - 640) < 13);
    assert_int_equal(painted.n, plain.n);
    for (int k = 0; k < 9; k++) {
        const tz_vec2 p = {-16 + 4 * k, 0.5};
        assert_true(fabs(tz_shape_distance_at(&painted.distance, p, NULL) -
                         tz_shape_distance_at(&plain.distance, p, NULL)) < 0.2);
    }
    tz_disc_cover_deinit(&plain);
    tz_disc_cover_deinit(&painted);
    end_ctx(ctx);
}

static tz_status cover(tz_ctx *ctx)
{
    tz_disc_cover c;
    tz_vec2 v[4];
    rectangle(20, 6, 0.3, v);
    const tz_status s = tz_disc_cover_init(ctx, v, 4, one_part, 1, 11, 9, 0.97, &c);
    tz_disc_cover_deinit(&c);
    return s;
}

static void survives_want_of_memory(void **state)
{
    (void)state;
    survive(cover, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_disc_is_one_disc),
        cmocka_unit_test(strips_are_chains),
        cmocka_unit_test(discs_lie_inside_and_hang_together),
        cmocka_unit_test(odd_outlines),
        cmocka_unit_test(what_is_painted_on_is_no_hole),
        cmocka_unit_test(survives_want_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
