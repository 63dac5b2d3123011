/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Lines of photos: found where they are, as wide as they are, joined where they meet. */
#include "tests/base/check.h"

#include <math.h>

#include "analysis/lines.h"
#include "base/rng.h"
#include "tests/support/line_truth.h"

static tz_lines_params defaults(void)
{
    tz_lines_params p;
    tz_params_default(&tz_lines_param_table, &p);
    p.line = TZ_LINE_RIDGE;
    return p;
}

/* ---- pictures ------------------------------------------------------------------------ */

typedef struct bar {
    double x0, y0, x1, y1, width;
} bar;

static double away(const bar *b, double x, double y)
{
    const double dx = b->x1 - b->x0, dy = b->y1 - b->y0;
    const double t =
        fmin(1, fmax(0, ((x - b->x0) * dx + (y - b->y0) * dy) / (dx * dx + dy * dy)));
    return hypot(x - b->x0 - t * dx, y - b->y0 - t * dy);
}

/* Bars with round ends on grainy ground, 4 x 4 points a pixel. */
static tz_image draw(tz_ctx *ctx, int32_t w, int32_t h, const bar *b, int32_t n, float by)
{
    tz_image im;
    ok(ctx, tz_image_init(ctx, &im, w, h, 3));
    im.encoding = TZ_ENCODING_SRGB;
    for (int32_t y = 0; y < h; y++) {
        tz_rng r = tz_rng_make(3, (uint64_t)y);
        for (int32_t x = 0; x < w; x++) {
            int hits = 0;
            for (int k = 0; k < 16; k++)
                for (int32_t i = 0; i < n; i++)
                    if (away(&b[i], x + (k % 4 + 0.5) / 4, y + (k / 4 + 0.5) / 4) <
                        0.5 * b[i].width) {
                        hits++;
                        break;
                    }
            const float grain = (float)(0.01 * tz_rng_normal(&r));
            for (int c = 0; c < 3; c++)
                tz_image_at(&im, x, y)[c] = 0.5F + grain + by * (float)hits / 16;
        }
    }
    return im;
}

static tz_curve_set find(tz_ctx *ctx, const tz_image *im, const tz_lines_params *p,
                         tz_lines_verdict *v)
{
    tz_curve_set s;
    ok(ctx, tz_lines_find(ctx, im, p, &s, NULL, v));
    ok(ctx, tz_curve_set_check(ctx, &s, "lines"));
    assert_true(s.domain.size.x == im->width && s.domain.size.y == im->height);
    assert_int_equal(s.element.photo.n, 1);
    assert_int_equal(s.element.photo.v[0].width, im->width);
    assert_true(s.taper.n == s.piece.n);
    return s;
}

static int32_t ends_at(const tz_curve_set *s, int32_t node)
{
    int32_t n = 0;
    for (int32_t i = 0; i < s->piece.n; i++)
        n += (s->piece.v[i].from == node) + (s->piece.v[i].to == node);
    return n;
}

/* Nodes of a degree, not counting those within 4 px of the border. */
static int32_t nodes_of(const tz_curve_set *s, int32_t degree, tz_vec2 *at)
{
    int32_t n = 0;
    for (int32_t i = 0; i < s->node.n; i++) {
        const tz_vec2 p = s->node.v[i];
        const bool border = p.x < 4 || p.y < 4 || p.x > s->domain.size.x - 4 ||
                            p.y > s->domain.size.y - 4;
        if (border || ends_at(s, i) != degree)
            continue;
        *at = p;
        n++;
    }
    return n;
}

/* ---- where lines are ----------------------------------------------------------------- */

static void scenes_are_followed(void **state)
{
    /* precision, recall, F of each kind at a depth of four times the grain; measured:
     * 0.97 0.94, 0.96 0.86, 0.96 0.98 */
    static const double least[LINE_KINDS] = {0.90, 0.82, 0.92};
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    for (int k = 0; k < LINE_KINDS; k++) {
        double f = 0;
        for (uint64_t seed = 0; seed < 2; seed++) {
            line_truth t;
            line_score c;
            line_sample *v;
            int32_t n;
            tz_lines_verdict verdict;
            const tz_lines_params p = defaults();
            ok(ctx, line_truth_draw(ctx, (line_kind)k, 384, 0.16, seed, &t));
            tz_curve_set s = find(ctx, &t.photo, &p, &verdict);
            ok(ctx, line_samples_of(ctx, &s, &v, &n));
            ok(ctx, line_truth_score(&t, v, n, &c));
            assert_true(verdict.is_lines);
            assert_int_equal(verdict.tone, k == LINE_VEINS ? 2 : 1);
            assert_true(c.place < 0.6 && c.width < 0.25);
            f += c.f / 2;
            tz_free(ctx, v);
            tz_curve_set_deinit(&s);
            line_truth_deinit(&t);
        }
        if (!(f > least[k]))
            fail_msg("%s: F %.3f", line_kind_name[k], f);
    }
    end_ctx(ctx);
}

static void a_bar_is_a_straight_line(void **state)
{
    static const double widths[] = {3, 5, 8, 12};
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    for (size_t i = 0; i < sizeof widths / sizeof *widths; i++)
        for (int tone = 1; tone <= 2; tone++) {
            const bar b = {-20, 60.3, 220, 121.7, widths[i]};
            tz_image im = draw(ctx, 200, 180, &b, 1, tone == 1 ? -0.25F : 0.25F);
            const tz_lines_params p = defaults();
            tz_lines_verdict v;
            tz_curve_set s = find(ctx, &im, &p, &v);
            line_sample *at;
            int32_t n;
            assert_int_equal(s.path.n, 1);
            assert_int_equal(v.tone, tone);
            assert_true(s.piece.n <= 4);
            assert_true(fabs(v.length - 200 * hypot(240, 61.4) / 240) < 8);
            ok(ctx, line_samples_of(ctx, &s, &at, &n));
            for (int32_t k = 0; k < n; k++) {
                if (at[k].at.x < 15 || at[k].at.x > 185)
                    continue;
                if (away(&b, at[k].at.x, at[k].at.y) > 0.6 ||
                    fabs(at[k].width - b.width) > 0.15 * b.width + 0.3)
                    fail_msg("width %g: %g px off and %g wide at %g, %g", b.width,
                             away(&b, at[k].at.x, at[k].at.y), at[k].width, at[k].at.x,
                             at[k].at.y);
            }
            tz_free(ctx, at);
            tz_curve_set_deinit(&s);
            tz_image_deinit(&im);
        }
    end_ctx(ctx);
}

static void lines_that_meet_share_a_node(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    const bar t[] = {{-10, 80, 210, 84, 6}, {90, 82, 104, 210, 5}},
              x[] = {{-10, 60, 210, 130, 6}, {60, -10, 140, 210, 6}};
    const struct {
        const bar *b;
        int32_t degree;
        tz_vec2 at;
    } all[] = {{t, 3, {90, 81.9}}, {x, 4, {98.3, 95.7}}};
    for (int k = 0; k < 2; k++) {
        tz_image im = draw(ctx, 200, 200, all[k].b, 2, -0.25F);
        const tz_lines_params p = defaults();
        tz_curve_set s = find(ctx, &im, &p, NULL);
        tz_vec2 at = {0, 0};
        assert_int_equal(nodes_of(&s, all[k].degree, &at), 1);
        if (hypot(at.x - all[k].at.x, at.y - all[k].at.y) > 2)
            fail_msg("junction %d is at %g, %g", k, at.x, at.y);
        if (nodes_of(&s, 1, &at) != 0)
            fail_msg("an end at %g, %g", at.x, at.y);
        assert_int_equal(s.path.n, 2);
        tz_curve_set_deinit(&s);
        tz_image_deinit(&im);
    }
    end_ctx(ctx);
}

static void gaps_are_bridged_where_wanted(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    const bar b[] = {{-10, 50, 84, 52, 4}, {101, 52.4, 210, 54.8, 4}};
    tz_image im = draw(ctx, 200, 100, b, 2, -0.25F);
    tz_lines_params p = defaults();
    for (int k = 0; k < 2; k++) {
        p.gap = k ? 24 : -1;
        tz_curve_set s = find(ctx, &im, &p, NULL);
        assert_int_equal(s.path.n, k ? 1 : 2);
        tz_curve_set_deinit(&s);
    }
    tz_image_deinit(&im);
    end_ctx(ctx);
}

static void a_ring_is_closed(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    bar b[48];
    for (int i = 0; i < 48; i++) {
        const double a = 2 * TZ_PI * i / 48, c = 2 * TZ_PI * (i + 1) / 48;
        b[i] = (bar){100 + 60 * cos(a), 100 + 60 * sin(a), 100 + 60 * cos(c),
                     100 + 60 * sin(c), 5};
    }
    tz_image im = draw(ctx, 200, 200, b, 48, -0.25F);
    const tz_lines_params p = defaults();
    tz_lines_verdict v;
    tz_curve_set s = find(ctx, &im, &p, &v);
    assert_int_equal(s.path.n, 1);
    assert_true(s.path.v[0].closed);
    assert_true(fabs(v.length - 2 * TZ_PI * 60) < 8);
    assert_true(v.closed > 0.999);
    tz_curve_set_deinit(&s);
    tz_image_deinit(&im);
    end_ctx(ctx);
}

/* From border to border, and a branch of a third of that which ends in the open. */
static void what_ends_in_the_open_is_not_closed(void **state)
{
    static const bar b[] = {{-20, 60, 220, 60, 5}, {100, 60, 100, 126.7, 5}};
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    for (int bars = 1; bars <= 2; bars++) {
        tz_image im = draw(ctx, 200, 180, b, bars, -0.25F);
        const tz_lines_params p = defaults();
        tz_lines_verdict v;
        tz_curve_set s = find(ctx, &im, &p, &v);
        assert_true(bars == 1 ? v.closed > 0.999 : v.closed < 0.85);
        assert_true(fabs(v.closed * v.length - 200) < 3);
        assert_true(fabs(v.run * v.width * s.path.n / v.length - 1) < 1e-6);
        tz_curve_set_deinit(&s);
        tz_image_deinit(&im);
    }
    end_ctx(ctx);
}

static void grain_is_no_picture_of_lines(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    for (uint64_t seed = 0; seed < 3; seed++) {
        line_truth t;
        tz_lines_verdict v;
        const tz_lines_params p = defaults();
        ok(ctx, line_truth_draw(ctx, LINE_CELLS, 256, 0, seed, &t));
        tz_curve_set s = find(ctx, &t.photo, &p, &v);
        assert_false(v.is_lines);
        assert_true(v.why[0]);
        tz_curve_set_deinit(&s);
        line_truth_deinit(&t);
    }
    end_ctx(ctx);
}

/* ---- the rest of what is promised ---------------------------------------------------- */

static void the_plate_has_no_lines(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    const bar b[] = {{-10, 80, 210, 84, 6}, {90, 82, 104, 210, 5}};
    tz_image im = draw(ctx, 200, 200, b, 2, -0.25F), plate;
    const tz_lines_params p = defaults();
    tz_curve_set s;
    double worst = 0, sum = 0;
    int32_t n = 0;
    ok(ctx, tz_lines_find(ctx, &im, &p, &s, &plate, NULL));
    assert_true(plate.width == 200 && plate.height == 200 && plate.channels == 3 &&
                plate.encoding == im.encoding);
    for (int32_t y = 0; y < 200; y++)
        for (int32_t x = 0; x < 200; x++) {
            const double far = fmin(away(&b[0], x + 0.5, y + 0.5) - 3,
                                    away(&b[1], x + 0.5, y + 0.5) - 2.5);
            const double here = tz_image_at(&plate, x, y)[1];
            if (far > 5)
                worst = fmax(worst, fabs(here - tz_image_at(&im, x, y)[1]));
            if (far < -1) {
                sum += here;
                n++;
            }
        }
    assert_true(worst == 0);
    assert_true(n > 500 && fabs(sum / n - 0.5) < 0.02);
    tz_curve_set_deinit(&s);
    tz_image_deinit(&plate);
    tz_image_deinit(&im);
    end_ctx(ctx);
}

static void halved_photos_keep_their_measure(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    const bar b = {-20, 100, 420, 180, 10};
    tz_image im = draw(ctx, 400, 300, &b, 1, 0.25F);
    tz_lines_params p = defaults();
    tz_lines_verdict v;
    p.most = 40000;
    tz_curve_set s = find(ctx, &im, &p, &v);
    assert_int_equal(s.path.n, 1);
    assert_true(fabs(v.width - 10) < 1.5 && fabs(v.length - 406.6) < 12);
    for (int32_t i = 0; i < s.node.n; i++)
        assert_true(away(&b, s.node.v[i].x, s.node.v[i].y) < 1.2);
    tz_curve_set_deinit(&s);
    tz_image_deinit(&im);
    end_ctx(ctx);
}

static void same_bytes_at_any_thread_count(void **state)
{
    static const int threads[] = {1, 2, 8};
    (void)state;
    tz_curve_set first = {0};
    tz_image first_plate = {0};
    tz_ctx *keep = new_ctx(1);
    for (int k = 0; k < 3; k++) {
        tz_ctx *ctx = k ? new_ctx(threads[k]) : keep;
        line_truth t;
        tz_curve_set s;
        tz_image plate;
        const tz_lines_params p = defaults();
        ok(ctx, line_truth_draw(ctx, LINE_CRACKS, 256, 0.16, 5, &t));
        ok(ctx, tz_lines_find(ctx, &t.photo, &p, &s, &plate, NULL));
        line_truth_deinit(&t);
        if (k == 0) {
            first = s;
            first_plate = plate;
            assert_true(s.piece.n > 10);
            continue;
        }
        assert_int_equal(s.node.n, first.node.n);
        assert_int_equal(s.piece.n, first.piece.n);
        assert_int_equal(s.path.n, first.path.n);
        assert_memory_equal(s.node.v, first.node.v, (size_t)s.node.n * sizeof *s.node.v);
        assert_memory_equal(s.taper.v, first.taper.v,
                            (size_t)s.taper.n * sizeof *s.taper.v);
        for (int32_t i = 0; i < s.piece.n; i++)
            assert_true(s.piece.v[i].a.x == first.piece.v[i].a.x &&
                        s.piece.v[i].b.y == first.piece.v[i].b.y);
        assert_memory_equal(plate.px, first_plate.px,
                            (size_t)plate.stride * 256 * sizeof(float));
        tz_curve_set_deinit(&s);
        tz_image_deinit(&plate);
        end_ctx(ctx);
    }
    tz_curve_set_deinit(&first);
    tz_image_deinit(&first_plate);
    end_ctx(keep);
}

static tz_status run_small(tz_ctx *ctx)
{
    const bar b[] = {{-10, 20, 60, 24, 4}, {24, 20, 28, 60, 4}};
    tz_image im, plate;
    tz_curve_set s;
    const tz_lines_params p = defaults();
    tz_status st = tz_image_init(ctx, &im, 48, 48, 3);
    if (st != TZ_OK)
        return st;
    im.encoding = TZ_ENCODING_SRGB;
    for (int32_t y = 0; y < 48; y++)
        for (int32_t x = 0; x < 48; x++)
            for (int c = 0; c < 3; c++)
                tz_image_at(&im, x, y)[c] =
                    fmin(away(&b[0], x, y), away(&b[1], x, y)) < 2 ? 0.2F : 0.6F;
    st = tz_lines_find(ctx, &im, &p, &s, &plate, NULL);
    tz_image_deinit(&im);
    tz_curve_set_deinit(&s);
    tz_image_deinit(&plate);
    return st;
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    survive(run_small, 1);
}

static void odd_pictures(void **state)
{
    static const int32_t size[][2] = {{1, 1}, {2, 2}, {1, 40}, {40, 1}, {3, 3}, {64, 48}};
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    for (size_t k = 0; k < sizeof size / sizeof *size; k++)
        for (int32_t channels = 1; channels <= 4; channels++)
            for (int fill = 0; fill < 3; fill++) {
                tz_image im, plate;
                tz_lines_verdict v;
                tz_curve_set s;
                const tz_lines_params p = defaults();
                tz_rng r = tz_rng_make(1, k);
                ok(ctx, tz_image_init(ctx, &im, size[k][0], size[k][1], channels));
                for (int64_t i = 0; i < im.stride * im.height; i++)
                    im.px[i] = fill == 0   ? 0.5F
                               : fill == 1 ? (i % 7 ? NAN : INFINITY)
                                           : (float)(1e30 * tz_rng_normal(&r));
                ok(ctx, tz_lines_find(ctx, &im, &p, &s, &plate, &v));
                ok(ctx, tz_curve_set_check(ctx, &s, "odd"));
                assert_true(fill > 0 || s.path.n == 0);
                assert_false(fill == 0 && v.is_lines);
                assert_int_equal(plate.channels, channels >= 3 ? 3 : 1);
                tz_curve_set_deinit(&s);
                tz_image_deinit(&plate);
                tz_image_deinit(&im);
            }
    tz_image im;
    tz_curve_set s;
    const tz_lines_params p = defaults();
    ok(ctx, tz_image_init(ctx, &im, 8, 8, 5));
    fails(ctx, tz_lines_find(ctx, &im, &p, &s, NULL, NULL), TZ_INVALID,
          "1 to 4 channels");
    assert_null(s.path.v);
    tz_image_deinit(&im);
    ok(ctx, tz_image_init(ctx, &im, 8, 8, 3));
    im.encoding = TZ_ENCODING_DATA;
    fails(ctx, tz_lines_find(ctx, &im, &p, &s, NULL, NULL), TZ_INVALID, "show colours");
    tz_image_deinit(&im);
    end_ctx(ctx);
}

static void cancelled(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    line_truth t;
    tz_curve_set s;
    tz_image plate;
    const tz_lines_params p = defaults();
    ok(ctx, line_truth_draw(ctx, LINE_CELLS, 64, 0.2, 1, &t));
    tz_ctx_cancel(ctx);
    assert_int_equal(tz_lines_find(ctx, &t.photo, &p, &s, &plate, NULL), TZ_CANCELLED);
    assert_true(!s.path.v && !plate.px);
    tz_ctx_clear(ctx);
    line_truth_deinit(&t);
    end_ctx(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scenes_are_followed),
        cmocka_unit_test(a_bar_is_a_straight_line),
        cmocka_unit_test(lines_that_meet_share_a_node),
        cmocka_unit_test(gaps_are_bridged_where_wanted),
        cmocka_unit_test(a_ring_is_closed),
        cmocka_unit_test(what_ends_in_the_open_is_not_closed),
        cmocka_unit_test(grain_is_no_picture_of_lines),
        cmocka_unit_test(the_plate_has_no_lines),
        cmocka_unit_test(halved_photos_keep_their_measure),
        cmocka_unit_test(same_bytes_at_any_thread_count),
        cmocka_unit_test(every_allocation_may_fail),
        cmocka_unit_test(odd_pictures),
        cmocka_unit_test(cancelled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
