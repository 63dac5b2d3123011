/* SPDX-License-Identifier: Apache-2.0 */
/* The measure of boundaries: cases counted by hand, matchings against the largest one
 * found by plain search, and curves thinned as they should be. */
#include "tests/base/check.h"

#include <math.h>

#include "analysis/boundary_parts.h"
#include "analysis/boundary_score.h"
#include "base/rng.h"

#define SIDE 16

/* '#' in a drawing of rows apart by '/' is 1, digits are tenths. */
static void draw(const char *rows, float *strength, uint8_t *truth)
{
    int32_t x = 0, y = 0;
    for (int32_t p = 0; p < SIDE * SIDE; p++) {
        if (strength)
            strength[p] = 0;
        if (truth)
            truth[p] = 0;
    }
    for (; *rows; rows++, x++) {
        if (*rows == '/') {
            y++, x = -1;
            continue;
        }
        assert_true(x < SIDE && y < SIDE);
        if (strength)
            strength[y * SIDE + x] = *rows == '#' ? 1
                                     : *rows >= '1' && *rows <= '9'
                                         ? (float)(*rows - '0') / 10
                                         : 0;
        if (truth)
            truth[y * SIDE + x] = *rows == '#';
    }
}

/* Tolerance of that many pixels. */
static double reach(double px) { return px / (SIDE * sqrt(2)); }

static tz_boundary_counts match(const char *found, const char *truth, double px)
{
    float strength[SIDE * SIDE];
    uint8_t line[SIDE * SIDE];
    tz_boundary_counts c;
    tz_ctx *ctx = new_ctx(1);
    draw(found, strength, NULL);
    draw(truth, NULL, line);
    ok(ctx, tz_boundary_match(ctx, strength, line, SIDE, SIDE, reach(px), &c));
    end_ctx(ctx);
    return c;
}

static void counts_by_hand(void **state)
{
    (void)state;
    /* five true pixels; three found on them, one a row off, one far away */
    const char *truth = "///..#####", *found = "///..999/.....5//////..........2";
    tz_boundary_counts c = match(found, truth, 1.1);
    assert_int_equal(c.truth, 5);
    assert_int_equal(c.found[0], 5); /* 1/34: all */
    assert_int_equal(c.found_true[0], 4);
    assert_int_equal(c.truth_found[0], 4);
    assert_int_equal(c.found[5], 5);  /* 6/34 = 0.176 */
    assert_int_equal(c.found[6], 4);  /* 7/34 = 0.206: the far one is gone */
    assert_int_equal(c.found[16], 4); /* 17/34 = 0.5 is reached by 0.5 */
    assert_int_equal(c.found[17], 3);
    assert_int_equal(c.found_true[17], 3);
    assert_int_equal(c.found[29], 3); /* 30/34 = 0.88 */
    assert_int_equal(c.found[30], 0);
    assert_int_equal(c.found_true[30], 0);
    const tz_boundary_score s = tz_boundary_score_of(&c, 1);
    /* 4 of 4 found are true, 4 of 5 true are found, from 7/34 on */
    assert_true(fabs(s.ods - 8.0 / 9) < 1e-12 && s.ois == s.ods);
    assert_true(s.ods_precision == 1 && fabs(s.ods_recall - 0.8) < 1e-12);
    assert_true(s.ods_threshold > 6.0 / 34 && s.ods_threshold < 7.001 / 34);
    assert_true(fabs(s.ap - 0.8) < 1e-12);
    /* without the row off */
    c = match(found, truth, 0.5);
    assert_int_equal(c.found_true[0], 3);
}

static void one_pixel_pairs_once(void **state)
{
    (void)state;
    /* three found pixels about one true one, and the reverse */
    tz_boundary_counts c = match("/..#.#//...#", "//...#", 2.5);
    assert_int_equal(c.found[0], 3);
    assert_int_equal(c.found_true[0], 1);
    c = match("//...#", "/..#.#//...#", 2.5);
    assert_int_equal(c.truth, 3);
    assert_int_equal(c.truth_found[0], 1);
    /* nearest first would leave one over: the exchange pairs both */
    c = match("/..#..#", "/....#..#", 2.1);
    assert_int_equal(c.found_true[0], 2);
}

static void perfect_and_shifted(void **state)
{
    (void)state;
    /* a staircase, thick where a label map makes it so */
    const char *line = "/.##/..##/...##/....##/.....##/......#/......#/......#";
    tz_boundary_counts c = match(line, line, 1.1);
    tz_boundary_score s = tz_boundary_score_of(&c, 1);
    assert_true(c.truth > 5 && c.truth < 13);
    assert_true(s.ods == 1 && s.ois == 1 && s.ap == 1);
    const char *wall = "///.##########", *below = "/////.##########";
    c = match(below, wall, 2.1);
    assert_true(tz_boundary_score_of(&c, 1).ods == 1);
    c = match(below, wall, 1.9);
    assert_true(tz_boundary_score_of(&c, 1).ods == 0);
}

static void nothing_found_or_true(void **state)
{
    (void)state;
    tz_boundary_counts c[2] = {match("", "///..####", 2), match("/.45", "", 2)};
    assert_int_equal(c[0].truth, 4);
    assert_int_equal(c[0].found[0], 0);
    assert_int_equal(c[1].truth, 0);
    assert_int_equal(c[1].found[0], 2);
    assert_int_equal(c[1].found_true[0], 0);
    tz_boundary_score s = tz_boundary_score_of(c, 2);
    assert_true(s.ods == 0 && s.ois == 0 && s.ap == 0 && s.ods_threshold == 0);
    s = tz_boundary_score_of(c, 0);
    assert_true(s.ods == 0 && s.ois == 0 && s.ap == 0);
    /* its own best threshold of an empty picture is one that finds nothing */
    c[0] = match("///..####", "///..####", 2);
    s = tz_boundary_score_of(c, 2);
    assert_true(s.ois == 1);
    assert_true(s.ods == 1 && s.ods_threshold > 0.5);
}

static void figures_by_hand(void **state)
{
    (void)state;
    /* two pictures, three steps: thresholds below 1/3 find all, below 2/3 half */
    tz_boundary_counts c[2] = {{.truth = 100}, {.truth = 100}};
    for (int32_t k = 0; k < TZ_BOUNDARY_LEVELS; k++) {
        const int32_t step = k / 11;
        c[0].found[k] = step == 0 ? 200 : step == 1 ? 50 : 20;
        c[0].found_true[k] = c[0].truth_found[k] = step == 0 ? 80 : step == 1 ? 50 : 20;
        c[1].found[k] = step == 0 ? 100 : step == 1 ? 50 : 0;
        c[1].found_true[k] = c[1].truth_found[k] = step == 0 ? 90 : step == 1 ? 25 : 0;
    }
    const tz_boundary_score s = tz_boundary_score_of(c, 2);
    /* sums: (170/300, 170/200), (75/100, 75/200), (20/20, 20/200) */
    const double p0 = 170.0 / 300, r0 = 0.85;
    assert_true(fabs(s.ods - 2 * p0 * r0 / (p0 + r0)) < 1e-3);
    /* own best: 50 of 50 (F 0.667) against 80 of 200 (0.533); 90 of 100 */
    const double p = 140.0 / 150, r = 140.0 / 200;
    assert_true(fabs(s.ois - 2 * p * r / (p + r)) < 1e-12);
    const double area = 0.1 * 1 + 0.275 * 0.5 * (1 + 0.75) + 0.475 * 0.5 * (0.75 + p0);
    assert_true(fabs(s.ap - area) < 1e-12);
}

/* ---- against plain search ---------------------------------------------------------- */

typedef struct trial {
    int32_t found[SIDE * SIDE], truth[SIDE * SIDE]; /* pixels */
    int32_t founds, truths;
    int32_t owner[SIDE * SIDE];
    bool seen[SIDE * SIDE];
    double radius;
} trial;

/* Kuhn's augmenting search. */
static bool can_pair(trial *t, int32_t f)
{
    for (int32_t i = 0; i < t->truths; i++) {
        const int32_t dx = t->found[f] % SIDE - t->truth[i] % SIDE;
        const int32_t dy = t->found[f] / SIDE - t->truth[i] / SIDE;
        if (dx * dx + dy * dy > t->radius * t->radius || t->seen[i])
            continue;
        t->seen[i] = true;
        if (t->owner[i] < 0 || can_pair(t, t->owner[i])) {
            t->owner[i] = f;
            return true;
        }
    }
    return false;
}

static int32_t largest(trial *t)
{
    int32_t pairs = 0;
    for (int32_t i = 0; i < t->truths; i++)
        t->owner[i] = -1;
    for (int32_t f = 0; f < t->founds; f++) {
        memset(t->seen, 0, sizeof t->seen);
        pairs += can_pair(t, f);
    }
    return pairs;
}

static void matching_is_largest(void **state)
{
    (void)state;
    static trial t;
    tz_ctx *ctx = new_ctx(1);
    for (uint64_t seed = 0; seed < 400; seed++) {
        tz_rng r = tz_rng_make(seed, 0);
        const int32_t margin = 5, stride = SIDE + 2 * margin;
        int32_t id[(SIDE + 10) * (SIDE + 10)], px[SIDE * SIDE], pairs = -1;
        tz_boundary_disc d;
        const double dense = tz_rng_range(&r, 0.02, 0.5),
                     even = tz_rng_range(&r, 0.02, 0.5);
        t.founds = t.truths = 0;
        t.radius = tz_rng_range(&r, 0, 5);
        for (size_t q = 0; q < sizeof id / sizeof *id; q++)
            id[q] = -1;
        for (int32_t p = 0; p < SIDE * SIDE; p++) {
            const int32_t q = (p / SIDE + margin) * stride + p % SIDE + margin;
            if (tz_rng_unit(&r) < dense) {
                px[t.founds] = q;
                t.found[t.founds++] = p;
            }
            if (tz_rng_unit(&r) < even) {
                id[q] = t.truths;
                t.truth[t.truths++] = p;
            }
        }
        ok(ctx, tz_boundary_disc_init(ctx, t.radius, stride, &d));
        ok(ctx, tz_boundary_pair(ctx, px, t.founds, id, t.truths, &d, &pairs));
        assert_int_equal(pairs, largest(&t));
        tz_boundary_disc_deinit(&d);
    }
    end_ctx(ctx);
}

/* ---- thinning ---------------------------------------------------------------------- */

static int32_t pieces(const uint8_t *on, int32_t side)
{
    uint8_t *seen = calloc((size_t)side * side, 1);
    int32_t *stack = malloc((size_t)side * side * sizeof *stack), n = 0;
    for (int32_t p = 0; p < side * side; p++) {
        if (!on[p] || seen[p])
            continue;
        int32_t depth = 0;
        n++;
        seen[stack[depth++] = p] = 1;
        while (depth > 0) {
            const int32_t q = stack[--depth];
            for (int32_t dy = -1; dy <= 1; dy++)
                for (int32_t dx = -1; dx <= 1; dx++) {
                    const int32_t u = q + dy * side + dx;
                    if (on[u] && !seen[u])
                        seen[stack[depth++] = u] = 1;
                }
        }
    }
    free(seen);
    free(stack);
    return n;
}

static void skeleton_keeps_the_curves(void **state)
{
    (void)state;
    enum { side = 60 };
    tz_ctx *ctx = new_ctx(1);
    static uint8_t on[side * side];
    static int32_t px[side * side];
    for (uint64_t seed = 0; seed < 60; seed++) {
        int32_t n = 0;
        tz_rng r = tz_rng_make(seed, 1);
        memset(on, 0, sizeof on);
        for (int32_t i = 0; i < 6; i++) { /* thick strokes */
            double x = tz_rng_range(&r, 8, 52), y = tz_rng_range(&r, 8, 52);
            const double a = tz_rng_range(&r, 0, 6.28), wide = tz_rng_range(&r, 0.5, 4);
            for (int32_t k = 0; k < 30; k++, x += cos(a), y += sin(a))
                for (int32_t v = 1; v < side - 1; v++)
                    for (int32_t u = 1; u < side - 1; u++)
                        if (hypot(u - x, v - y) <= wide)
                            on[v * side + u] = 1;
        }
        for (int32_t p = 0; p < side * side; p++)
            if (on[p])
                px[n++] = p;
        const int32_t before = pieces(on, side), many = n;
        ok(ctx, tz_boundary_skeleton(ctx, on, side, px, &n));
        assert_int_equal(pieces(on, side), before);
        assert_true(n > 0 && n < many);
        for (int32_t i = 0; i < n; i++) {
            assert_true(on[px[i]] && (i == 0 || px[i] > px[i - 1]));
            /* one pixel wide: no full square */
            assert_false(on[px[i] + 1] && on[px[i] + side] && on[px[i] + side + 1]);
        }
    }
    /* a bar five wide gives its middle */
    int32_t n = 0;
    memset(on, 0, sizeof on);
    for (int32_t y = 20; y < 25; y++)
        for (int32_t x = 10; x < 50; x++) {
            on[y * side + x] = 1;
            px[n++] = y * side + x;
        }
    ok(ctx, tz_boundary_skeleton(ctx, on, side, px, &n));
    for (int32_t x = 14; x < 46; x++)
        assert_true(on[22 * side + x]);
    end_ctx(ctx);
}

/* Ridge of triangular profile about a circle. */
static void draw_ring(float *r, int32_t side, double radius, double wide, double height)
{
    for (int32_t y = 0; y < side; y++)
        for (int32_t x = 0; x < side; x++) {
            const double d = fabs(hypot(x - side / 2.0, y - side / 2.0) - radius);
            r[y * side + x] = (float)(height * fmax(0, 1 - d / wide));
        }
}

static void ridges_are_kept(void **state)
{
    (void)state;
    enum { side = 100 };
    static float r[side * side], thin[side * side];
    tz_ctx *ctx = new_ctx(2);
    for (int32_t radius = 12; radius <= 40; radius += 7) {
        int32_t kept = 0;
        draw_ring(r, side, radius, 5, 300);
        r[0] = NAN, r[1] = INFINITY, r[2] = -5;
        ok(ctx, tz_boundary_thin(ctx, r, side, side, thin));
        assert_true(thin[0] == 0 && thin[1] == 0 && thin[2] == 0);
        for (int32_t p = 0; p < side * side; p++) {
            if (thin[p] < 150) /* the foot of a bent ridge may show traces */
                continue;
            kept++;
            assert_true(thin[p] == r[p]);
            assert_true(
                fabs(hypot(p % side - side / 2.0, p / side - side / 2.0) - radius) < 1);
        }
        assert_true(kept > 5.6 * radius && kept < 9 * radius);
    }
    /* flat and empty responses, and the smallest pictures */
    for (int32_t p = 0; p < side * side; p++)
        r[p] = 0;
    for (int32_t w = 1; w <= 5; w++)
        ok(ctx, tz_boundary_thin(ctx, r, w, 6 - w, thin));
    assert_true(thin[0] == 0);
    end_ctx(ctx);
}

/* ---- threads, memory --------------------------------------------------------------- */

enum { WIDE = 150, HIGH = 110 };

static void draw_noise(float *r, uint8_t *truth)
{
    tz_rng a = tz_rng_make(3, 3);
    for (int32_t p = 0; p < WIDE * HIGH; p++) {
        const int32_t x = p % WIDE, y = p / WIDE;
        truth[p] = x % 20 == 5 || y % 30 == 9;
        r[p] = (float)(0.7 * truth[p] * tz_rng_unit(&a) + 0.3 * tz_rng_unit(&a));
    }
}

static tz_status whole(tz_ctx *ctx, tz_boundary_counts *c)
{
    static float r[WIDE * HIGH], thin[WIDE * HIGH];
    static uint8_t truth[WIDE * HIGH];
    draw_noise(r, truth);
    const tz_status s = tz_boundary_thin(ctx, r, WIDE, HIGH, thin);
    return s == TZ_OK ? tz_boundary_match(ctx, thin, truth, WIDE, HIGH, 0.0075, c) : s;
}

static void same_at_any_thread_count(void **state)
{
    (void)state;
    tz_boundary_counts c[3] = {0};
    for (int32_t i = 0; i < 3; i++) {
        tz_ctx *ctx = new_ctx(i == 0 ? 1 : i == 1 ? 2 : 8);
        ok(ctx, whole(ctx, &c[i]));
        end_ctx(ctx);
    }
    assert_memory_equal(&c[0], &c[1], sizeof c[0]);
    assert_memory_equal(&c[0], &c[2], sizeof c[0]);
    assert_true(tz_boundary_score_of(c, 1).ods > 0.8);
}

static tz_status once(tz_ctx *ctx)
{
    tz_boundary_counts c = {.truth = -1};
    const tz_status s = whole(ctx, &c);
    assert_true(s == TZ_OK || c.truth == -1); /* untouched on failure */
    return s;
}

static void memory_may_fail(void **state)
{
    (void)state;
    survive(once, 1);
    survive(once, 2);
}

static void can_be_cancelled(void **state)
{
    (void)state;
    tz_boundary_counts c;
    tz_ctx *ctx = new_ctx(1);
    tz_ctx_cancel(ctx);
    assert_int_equal(whole(ctx, &c), TZ_CANCELLED);
    end_ctx(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(counts_by_hand),
        cmocka_unit_test(one_pixel_pairs_once),
        cmocka_unit_test(perfect_and_shifted),
        cmocka_unit_test(nothing_found_or_true),
        cmocka_unit_test(figures_by_hand),
        cmocka_unit_test(matching_is_largest),
        cmocka_unit_test(skeleton_keeps_the_curves),
        cmocka_unit_test(ridges_are_kept),
        cmocka_unit_test(same_at_any_thread_count),
        cmocka_unit_test(memory_may_fail),
        cmocka_unit_test(can_be_cancelled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
