/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Edge groups along fields: pieces turn, grow and thin out as frames say at their places. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "elements/field.h"
#include "tests/support/arranged.h"

static tz_ctx *ctx;
static arranged_source bricks;
enum { W = 720, H = 560 };

static int set_up(void **state)
{
    (void)state;
    ctx = new_ctx(2);
    source_init(ctx, &bricks, PICTURE_BRICKS, 260, 200, 1);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    source_deinit(&bricks);
    tz_ctx_free(ctx);
    return 0;
}

static tz_arrange_params params(const tz_frames *frames)
{
    tz_arrange_params p = arrange_params(W, H, 6, false);
    p.effort = 2;
    p.mirror = 1;
    p.frames = frames;
    return p;
}

/* Strokes from the top to the bottom at a tenth and nine tenths of the width. */
static tz_frames *frames_of(tz_ctx *c, const double size[2], const double density[2],
                            bool directed)
{
    const tz_vec3 domain = {W, H, 0};
    tz_element_field f;
    tz_frames *out = NULL;
    assert_int_equal(tz_element_field_init(c, domain, false, 256, &f), TZ_OK);
    for (int k = 0; k < 2; k++) {
        const tz_element_field_stroke pen = {
            .radius = 6, .weight = 1, .directed = directed};
        const double x = (0.1 + 0.8 * k) * W;
        const tz_element_field_point v[2] = {{{x, 0}, size[k], density[k]},
                                             {{x, H}, size[k], density[k]}};
        assert_int_equal(tz_element_field_add(&f, pen, 2, v), TZ_OK);
    }
    assert_int_equal(tz_element_field_settle(&f), TZ_OK);
    assert_int_equal(tz_frames_from_field(&f, &out), TZ_OK);
    tz_element_field_deinit(&f);
    return out;
}

static const double none[2] = {-1, -1}, unsaid[2] = {0, 0};

/* Least share of a turn between two angles. */
static double off(double a, double b) { return fabs(remainder(a - b, 2 * TZ_PI)); }

static void test_pieces_turn(void **state)
{
    (void)state;
    tz_frames *f;
    tz_layout l;
    assert_int_equal(
        tz_frames_from_formula(ctx, "120*x/w", (tz_vec3){W, H, 0}, false, &f), TZ_OK);
    const tz_arrange_params p = params(f);
    arrange_one(ctx, &bricks, NULL, &p, &l);
    assert_sound(&l, &bricks.exemplar, 1, 2);
    double sum = 0, worst = 0;
    for (int32_t i = 0; i < l.place.n; i++) {
        const tz_vec2 at = middle_of(&l, i);
        double angle, scale;
        bool mirror;
        map_parts(l.place.v[i].map, &angle, &scale, &mirror);
        const double o = off(angle, tz_frames_angle(f, (tz_vec3){at.x, at.y, 0}));
        worst = fmax(worst, o);
        sum += o / l.place.n;
    }
    /* bricks may bend by a few degrees, pieces are moved until they fit, and what runs on
     * keeps its neighbour's turn for as long as that is within a tenth */
    if (sum > 0.12 || worst > 0.45)
        fail_msg("pieces are off by %g, one by %g", sum, worst);
    tz_layout_deinit(&l);
    tz_frames_free(f);
}

/* Pieces have the size that is said where they lie, cover all, and keep their turn where
 * no direction is said. */
static void test_pieces_grow(void **state)
{
    (void)state;
    static const double size[2] = {0.5, 2};
    tz_frames *f = frames_of(ctx, size, none, false);
    tz_layout l;
    assert_false(f->turned);
    const tz_arrange_params p = params(f);
    arrange_one(ctx, &bricks, NULL, &p, &l);
    assert_sound(&l, &bricks.exemplar, 1, 2);
    int32_t few = 0, many = 0;
    for (int32_t i = 0; i < l.place.n; i++) {
        const tz_vec2 at = middle_of(&l, i);
        double angle, scale;
        bool mirror;
        map_parts(l.place.v[i].map, &angle, &scale, &mirror);
        const double want = tz_frames_size(f, (tz_vec3){at.x, at.y, 0});
        if (fabs(log(scale / want)) > 0.3)
            fail_msg("a piece of scale %g in place of %g", scale, want);
        assert_true(off(angle, 0) < 0.2);
        many += at.x<0.2 * W, few += at.x> 0.8 * W;
    }
    assert_true(many > 6 * few); /* sixteen, but for what the borders cut */
    double farthest;
    const int64_t bare = bare_pixels(&l, &farthest);
    if (bare > W * H / 200 || farthest > 3)
        fail_msg("%d bare pixels, up to %g away", (int)bare, farthest);
    tz_layout_deinit(&l);
    tz_frames_free(f);
}

/* Where it is sparser fewer pieces lie, as large as before. */
static void test_pieces_thin_out(void **state)
{
    (void)state;
    static const double density[2] = {1, 0.25};
    tz_frames *f = frames_of(ctx, unsaid, density, false);
    tz_layout l;
    tz_arrange_params p = params(f);
    p.piece = 48;
    arrange_one(ctx, &bricks, NULL, &p, &l);
    assert_sound(&l, &bricks.exemplar, 1, 2);
    int32_t few = 0, many = 0;
    for (int32_t i = 0; i < l.place.n; i++) {
        double angle, scale;
        bool mirror;
        map_parts(l.place.v[i].map, &angle, &scale, &mirror);
        assert_true(scale > 0.8 && scale < 1.25);
        many += middle_of(&l, i).x<0.2 * W, few += middle_of(&l, i).x> 0.8 * W;
    }
    if (!(many > 2 * few && few > 0))
        fail_msg("%d pieces and %d", (int)many, (int)few);
    tz_layout_deinit(&l);
    tz_frames_free(f);
}

static void test_threads(void **state)
{
    (void)state;
    static const double size[2] = {0.4, 2.5}, density[2] = {1, 0.3};
    static const int threads[3] = {1, 2, 8};
    for (int tile = 0; tile < 2; tile++) {
        uint64_t first = 0;
        for (int k = 0; k < 3; k++) {
            tz_ctx *c = new_ctx(threads[k]);
            tz_frames *f = frames_of(c, size, density, true);
            tz_layout l;
            tz_arrange_params p = params(f);
            p.tile = tile;
            arrange_one(c, &bricks, NULL, &p, &l);
            first = k ? first : layout_hash(&l);
            assert_true(layout_hash(&l) == first);
            tz_layout_deinit(&l);
            tz_frames_free(f);
            tz_ctx_free(c);
        }
    }
}

static void test_sizes_out_of_range(void **state)
{
    (void)state;
    static const double size[2] = {0.1, 1};
    tz_frames *f = frames_of(ctx, size, none, true);
    const tz_arrange_params p = params(f);
    tz_layout l = {0};
    assert_int_equal(tz_arrange(ctx, &bricks.exemplar, 1, NULL, &p, &l), TZ_INVALID);
    assert_non_null(strstr(tz_ctx_message(ctx), "sizes from 0.1"));
    assert_int_equal(l.place.n, 0);
    tz_ctx_clear(ctx);
    tz_frames_free(f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pieces_turn),        cmocka_unit_test(test_pieces_grow),
        cmocka_unit_test(test_pieces_thin_out),    cmocka_unit_test(test_threads),
        cmocka_unit_test(test_sizes_out_of_range),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
