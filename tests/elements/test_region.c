/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Regions: distances against slower ways and known shapes, drawings, pictures, bad input. */
#include "tests/base/check.h"

#include "base/rng.h"
#include "elements/domain.h"
#include "tests/elements/guides.h"

static const tz_vec3 size = {200, 200, 0};

/* ---- distances ------------------------------------------------------------------- */

/* 1 inside a disc, falling to 0 over one cell at its border. */
static void draw_disc(float *m, int32_t w, int32_t h, double cx, double cy, double r)
{
    for (int32_t j = 0; j < h; j++)
        for (int32_t i = 0; i < w; i++) {
            const double d = r - hypot(i + 0.5 - cx, j + 0.5 - cy);
            m[j * w + i] = (float)fmin(fmax(d + 0.5, 0), 1);
        }
}

static void test_disc(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    float *m = calloc(128 * 128, sizeof *m);
    tz_region *r;
    draw_disc(m, 128, 128, 60.3, 66.9, 40.2);
    ok(ctx, tz_region_from_mask(ctx, m, 128, 128, (tz_vec3){128, 128, 0}, false, &r));
    tz_rng g = tz_rng_make(1, 0);
    for (int k = 0; k < 2000; k++) {
        const tz_vec3 p = {tz_rng_range(&g, 1, 127), tz_rng_range(&g, 1, 127), 0};
        double d = 40.2 - hypot(p.x - 60.3, p.y - 66.9);
        if (d > 0)
            d = fmin(d, fmin(fmin(p.x, 128 - p.x), fmin(p.y, 128 - p.y)));
        if (fabs(40.2 - d) > 5) /* bilinear cuts the tip of the cone off */
            assert_float_equal(tz_region_distance(r, p), d, 0.1);
    }
    assert_float_equal(r->area, TZ_PI * 40.2 * 40.2, 0.002 * r->area);
    assert_true(tz_region_distance(r, (tz_vec3){-30, 64, 0}) < -50 + 1);
    tz_region_free(r);
    tz_region_free(NULL);
    free(m);
    end_ctx(ctx);
}

/* The nearest crossing of 1/2 by trying all, on rows and columns of cells' centres. */
static double brute(const float *m, int32_t w, int32_t h, bool torus, tz_vec2 cell,
                    int32_t x, int32_t y)
{
    double least = HUGE_VAL;
    for (int32_t j = 0; j < h; j++)
        for (int32_t i = 0; i < w; i++)
            for (int k = 0; k < 2; k++) {
                const int32_t u = i + !k, v = j + k;
                if (!torus && (u >= w || v >= h))
                    continue;
                const double a = (double)m[j * w + i], b = (double)m[v % h * w + u % w];
                if ((a >= 0.5) == (b >= 0.5))
                    continue;
                const double t = (0.5 - a) / (b - a);
                double dx = i + (k ? 0 : t) - x, dy = j + (k ? t : 0) - y;
                if (torus)
                    dx -= floor(dx / w + 0.5) * w, dy -= floor(dy / h + 0.5) * h;
                least = fmin(least, hypot(dx * cell.x, dy * cell.y));
            }
    return least;
}

/* Random masks: never farther than the nearest crossing, nearer by what a piece between
 * two crossings can be nearer, signs as in the mask. */
static void test_against_brute(void **state)
{
    (void)state;
    for (int round = 0; round < 12; round++) {
        tz_ctx *ctx = new_ctx(1 + round % 3);
        enum { W = 37, H = 29 };
        float m[W * H];
        const bool torus = round % 2 == 1;
        const double most = round % 3 ? 1 : 0.51; /* dense and sparse */
        const tz_vec3 at = {74, 87, 0};
        const tz_vec2 cell = {74.0 / W, 87.0 / H};
        tz_rng g = tz_rng_make(3, (uint64_t)round);
        tz_region *r;
        for (int i = 0; i < W * H; i++)
            m[i] = (float)(tz_rng_unit(&g) * most);
        ok(ctx, tz_region_from_mask(ctx, m, W, H, at, torus, &r));
        for (int32_t y = 0; y < H; y++)
            for (int32_t x = 0; x < W; x++) {
                const double d = (double)r->distance[y * W + x];
                const double px = (x + 0.5) * cell.x, py = (y + 0.5) * cell.y;
                double b = brute(m, W, H, torus, cell, x, y);
                assert_true((m[y * W + x] >= 0.5f) == (d > 0));
                /* a piece is no longer than a cell's diagonal */
                const double half = hypot(cell.x, cell.y) / 2;
                double low = sqrt(fmax(0, b * b - half * half));
                if (d > 0 && !torus) {
                    const double wall = fmin(fmin(px, 74 - px), fmin(py, 87 - py));
                    b = fmin(b, wall);
                    low = fmin(low, wall);
                }
                assert_true(fabs(d) <= b + 1e-4 && fabs(d) >= low - 1e-4);
            }
        tz_region_free(r);
        end_ctx(ctx);
    }
}

/* A torus has no borders of its own; all of it inside is all of it inside. */
static void test_whole(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    float m[64];
    tz_region *r;
    for (int i = 0; i < 64; i++)
        m[i] = 1;
    for (int torus = 0; torus < 2; torus++) {
        ok(ctx, tz_region_from_mask(ctx, m, 8, 8, size, torus == 1, &r));
        assert_float_equal(r->area, 40000, 1e-6);
        const double d = tz_region_distance(r, (tz_vec3){12.5, 100, 0});
        assert_float_equal(d, torus ? hypot(200, 200) : 12.5, 1e-3);
        tz_region_free(r);
    }
    m[9] = NAN; /* is outside */
    ok(ctx, tz_region_from_mask(ctx, m, 8, 8, size, true, &r));
    assert_true(r->distance[9] < 0);
    tz_region_free(r);
    ok(ctx, tz_region_from_mask(ctx, m, 1, 1, size, true, &r)); /* one cell */
    tz_region_free(r);
    end_ctx(ctx);
}

/* ---- files ----------------------------------------------------------------------- */

static bool inside(const tz_region *r, double x, double y)
{
    return tz_region_distance(r, (tz_vec3){x, y, 0}) > 0;
}

static void test_drawing(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_region *r;
    /* paper; a ring by even-odd; one by the direction of its hole; a closed line; an open
     * line; a <use> of a disc, moved; the view is stretched to 200 x 200 */
    const char *path = guide_svg(
        "<defs><circle id='c' r='5'/></defs><rect width='100' height='100' fill='#eee'/>"
        "<path fill-rule='evenodd' d='M5 5h20v20h-20z M10 10h10v10h-10z'/>"
        "<g transform='translate(30 0)'><path d='M5 5h20v20h-20z M10 10v10h10v-10z'/></g>"
        "<path fill='none' stroke='red' d='M65 5h20v20h-20v-20'/>"
        "<path fill='none' stroke='red' d='M5 60h20v20'/>"
        "<use xlink:href='#c' x='50' y='70'/>");
    ok(ctx, tz_region_read(ctx, path, size, false, &r));
    assert_true(inside(r, 14, 30) && !inside(r, 30, 30) && !inside(r, 54, 30));
    assert_true(inside(r, 74, 30) && !inside(r, 90, 30));
    assert_true(inside(r, 150, 30) && !inside(r, 20, 120) && !inside(r, 49, 140));
    assert_true(inside(r, 100, 140) && inside(r, 108, 140) && !inside(r, 112, 140));
    assert_float_equal(tz_region_distance(r, (tz_vec3){100, 140, 0}), 10, 0.25);
    assert_float_equal(tz_region_distance(r, (tz_vec3){30, 30, 0}), -10, 0.25);
    assert_float_equal(r->area, 4 * (300 + 300 + 400 + TZ_PI * 25), 8);
    const tz_domain d = {.size = size, .region = r};
    assert_true(tz_domain_contains(&d, (tz_vec3){100, 140, 0}));
    assert_false(tz_domain_contains(&d, (tz_vec3){30, 30, 0}));
    assert_float_equal(tz_domain_depth(&d, (tz_vec3){100, 140, 0}), 10, 0.25);
    assert_true(tz_domain_area(&d) == r->area);
    tz_region_free(r);
    /* overlapping shapes are one; nothing but the paper is the paper */
    ok(ctx, tz_region_read(ctx,
                           guide_svg("<rect x='10' y='10' width='30' height='10'/>"
                                     "<rect x='30' y='10' width='30' height='10'/>"),
                           size, false, &r));
    assert_float_equal(r->area, 4 * 500, 5);
    tz_region_free(r);
    ok(ctx, tz_region_read(ctx, guide_svg("<rect width='100' height='100'/>"), size,
                           false, &r));
    assert_float_equal(r->area, 40000, 1);
    tz_region_free(r);
    end_ctx(ctx);
}

static float half_light(int32_t x, int32_t y, int32_t c)
{
    (void)y;
    return c == 3 ? 1 : x < 25 ? 0.9f : 0.1f;
}

static float half_opaque(int32_t x, int32_t y, int32_t c)
{
    (void)y;
    return c == 3 ? x < 25 : 0;
}

static void test_picture(void **state)
{
    (void)state;
    for (int k = 0; k < 4; k++) {
        tz_ctx *ctx = new_ctx(1);
        tz_region *r;
        const int32_t channels = k == 0 ? 1 : k == 1 ? 3 : 4;
        const char *path =
            guide_image(ctx, 50, 40, channels, k == 3 ? half_opaque : half_light);
        ok(ctx, tz_region_read(ctx, path, size, false, &r));
        assert_true(inside(r, 90, 100) && !inside(r, 110, 100));
        assert_float_equal(tz_region_distance(r, (tz_vec3){60, 100, 0}), 40, 0.5);
        assert_float_equal(r->area, 20000, 400);
        tz_region_free(r);
        end_ctx(ctx);
    }
}

static float dark(int32_t x, int32_t y, int32_t c)
{
    (void)x, (void)y;
    return c == 3;
}

static void test_bad_input(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_region *r = (void *)&ctx;
    const float m[4] = {0, 0.4f, 0.2f, 0};
    fails(ctx, tz_region_from_mask(ctx, m, 2, 2, size, false, &r), TZ_INVALID, "nothing");
    assert_null(r);
    fails(ctx, tz_region_from_mask(ctx, m, 0, 2, size, false, &r), TZ_INVALID, "0 x 2");
    fails(ctx, tz_region_from_mask(ctx, m, 9000, 1, size, false, &r), TZ_INVALID, "9000");
    fails(ctx, tz_region_from_mask(ctx, m, 2, 2, (tz_vec3){NAN, 1, 0}, false, &r),
          TZ_INVALID, "no area");
    fails(ctx, tz_region_read(ctx, "/none/at/all.svg", size, false, &r), TZ_IO,
          "all.svg");
    fails(ctx, tz_region_read(ctx, "/none/at/all.png", size, false, &r), TZ_IO,
          "all.png");
    fails(ctx, tz_region_read(ctx, guide_svg(""), size, false, &r), TZ_INVALID,
          "no filled or closed");
    fails(ctx, tz_region_read(ctx, guide_svg("<text>A</text>"), size, false, &r),
          TZ_INVALID, "texts");
    fails(ctx,
          tz_region_read(ctx, guide_svg("<circle cx='500' r='9'/>"), size, false, &r),
          TZ_INVALID, "nothing in it is inside");
    fails(ctx, tz_region_read(ctx, guide_svg("<path d='M0 0 L'/>"), size, false, &r),
          TZ_FORMAT, "guide.svg:1");
    fails(ctx, tz_region_read(ctx, guide_text("a.svg", "<svg"), size, false, &r),
          TZ_FORMAT, "a.svg");
    fails(ctx, tz_region_read(ctx, guide_text("a.png", "no"), size, false, &r), TZ_FORMAT,
          "a.png");
    fails(ctx, tz_region_read(ctx, guide_image(ctx, 20, 20, 3, dark), size, false, &r),
          TZ_INVALID, "guide.png");
    fails(
        ctx,
        tz_region_read(ctx, guide_svg("<circle r='9'/>"), (tz_vec3){0, 1, 0}, false, &r),
        TZ_INVALID, "no area");
    assert_null(r);
    /* coordinates far beyond the view are cut, not drawn */
    ok(ctx, tz_region_read(ctx,
                           guide_svg("<path d='M-1e9 -1e9h1.99e9v1e9z'/>"
                                     "<path d='M-1e8 40h2e8v20h-2e8z'/>"),
                           size, false, &r));
    assert_true(inside(r, 100, 100) && !inside(r, 20, 190));
    tz_region_free(r);
    end_ctx(ctx);
}

static tz_status read_all(tz_ctx *ctx)
{
    tz_region *r = NULL;
    const tz_status s = tz_region_read(ctx, guide_path, (tz_vec3){20, 1, 0}, true, &r);
    assert_true((s == TZ_OK) == (r != NULL));
    tz_region_free(r);
    return s;
}

static void test_memory_runs_out(void **state)
{
    (void)state;
    guide_svg("<circle cx='50' cy='50' r='30'/>");
    survive(read_all, 1);
}

static void test_threads_do_not_matter(void **state)
{
    (void)state;
    static const int threads[] = {1, 2, 8};
    float *first = NULL;
    guide_svg("<path d='M20 10 C 90 0 90 90 20 80 C 50 60 50 40 20 10'/>");
    for (int k = 0; k < 3; k++) {
        tz_ctx *ctx = new_ctx(threads[k]);
        tz_region *r;
        ok(ctx, tz_region_read(ctx, guide_path, size, true, &r));
        const size_t n =
            (size_t)r->raster.width * (size_t)r->raster.height * sizeof *r->distance;
        if (!first)
            first = memcpy(malloc(n), r->distance, n);
        assert_memory_equal(r->distance, first, n);
        tz_region_free(r);
        end_ctx(ctx);
    }
    free(first);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_disc),
        cmocka_unit_test(test_against_brute),
        cmocka_unit_test(test_whole),
        cmocka_unit_test(test_drawing),
        cmocka_unit_test(test_picture),
        cmocka_unit_test(test_bad_input),
        cmocka_unit_test(test_memory_runs_out),
        cmocka_unit_test(test_threads_do_not_matter),
    };
    return cmocka_run_group_tests(tests, guide_begin, guide_end);
}
