/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Drawn elements: exact coverage, linear light, order, crops, tori, pictures of labels. */
#include "tests/synthesis/test_element_render.h"

/* ---- coverage ------------------------------------------------------------------------ */

static double area_of(tz_ctx *ctx, const char *markup, double angle, double scale)
{
    tz_element_set s;
    set_init(ctx, &s, 300, 300, false);
    set_add(&s, set_symbol(&s, markup, 60), 150.3, 149.6, angle, 1);
    tz_image im = drawn(ctx, &s, scale);
    const double sum = sum_of(&im, 3) / (scale * scale);
    tz_image_deinit(&im);
    tz_element_set_deinit(&s);
    return sum;
}

/* The sum of alpha is the area of what is drawn, at any turn and scale. */
static void test_areas(void **state)
{
    (void)state;
    static const struct {
        const char *markup;
        double area, within;
    } shape[] = {
        {"<circle r=\"50\"/>", TZ_PI * 2500, 0.5},
        {"<path d=\"M-40 -20H40V20H-40Z\"/>", 80 * 40, 0.01},
        {"<path d=\"M-40 -20H40V20H-40Z M-10 -10H10V10H-10Z\" fill-rule=\"evenodd\"/>",
         3200 - 400, 0.01},
        {"<path d=\"M-40 -20H40V20H-40Z M-10 -10H10V10H-10Z\"/>", 3200, 0.01},
        {"<path d=\"M-40 -20H40V20H-40Z M-10 -10V10H10V-10Z\"/>", 2800, 0.01},
        {"<path d=\"M-40 0H40\" stroke=\"#000\" stroke-width=\"7\"/>", 560, 0.01},
        {"<path d=\"M-40 0H40\" stroke=\"#000\" stroke-width=\"6\" "
         "stroke-linecap=\"square\"/>",
         480 + 36, 0.01},
        {"<path d=\"M-40 0H40\" stroke=\"#000\" stroke-width=\"6\" "
         "stroke-linecap=\"round\"/>",
         480 + TZ_PI * 9, 0.3},
        {"<path d=\"M-30 -30H30V30H-30Z\" fill=\"none\" stroke=\"#000\" "
         "stroke-width=\"4\"/>",
         64 * 64 - 56 * 56, 0.6},
        {"<path d=\"M-30 -30H30V30H-30Z\" fill=\"none\" stroke=\"#000\" "
         "stroke-width=\"4\" stroke-linejoin=\"bevel\"/>",
         64 * 64 - 56 * 56 - 4 * 2, 0.6},
        {"<path d=\"M-30 -30H30V30H-30Z\" fill=\"none\" stroke=\"#000\" "
         "stroke-width=\"4\" stroke-linejoin=\"round\"/>",
         64 * 64 - 56 * 56 - 4 * (4 - TZ_PI), 0.8},
        {"<circle r=\"30\" fill=\"none\" stroke=\"#000\" stroke-width=\"3\"/>",
         TZ_PI * (31.5 * 31.5 - 28.5 * 28.5), 1.5},
        {"<path d=\"M0 0L40 0A40 40 0 0 1 0 40Z\"/>", TZ_PI * 400, 1},
    };
    tz_ctx *ctx = new_ctx(2);
    for (size_t k = 0; k < sizeof shape / sizeof *shape; k++)
        for (int turn = 0; turn < 3; turn++) {
            const double scale = turn == 2 ? 2.7 : 1,
                         got = area_of(ctx, shape[k].markup, 0.7 * turn, scale);
            if (!(fabs(got - shape[k].area) <= shape[k].within))
                fail_msg("shape %zu turn %d: area %.4f, not %.4f", k, turn, got,
                         shape[k].area);
        }
    tz_ctx_free(ctx);
}

/* Each pixel's coverage against 32 x 32 samples in it, of a polygon that is cut by tiles. */
static void test_coverage_of_pixels(void **state)
{
    (void)state;
    enum { N = 300, SUB = 32 };
    const tz_vec2 p[5] = {
        {20.3, 10.7}, {290.2, 61.4}, {250.9, 290.8}, {140, 180.5}, {5.5, 260.1}};
    tz_ctx *ctx = new_ctx(2);
    tz_element_set s;
    char markup[256];
    snprintf(markup, sizeof markup,
             "<path d=\"M%.9g %.9gL%.9g %.9gL%.9g %.9gL%.9g %.9gL%.9g %.9gZ\"/>", p[0].x,
             p[0].y, p[1].x, p[1].y, p[2].x, p[2].y, p[3].x, p[3].y, p[4].x, p[4].y);
    set_init(ctx, &s, N, N, false);
    set_add(&s, set_symbol(&s, markup, 400), 0, 0, 0, 1);
    tz_image im = drawn(ctx, &s, 1);
    double sum = 0;
    for (int y = 0; y < N; y++)
        for (int x = 0; x < N; x++) {
            int in = 0;
            for (int k = 0; k < SUB * SUB; k++) {
                const double qx = x + (k % SUB + 0.5) / SUB,
                             qy = y + (k / SUB + 0.5) / SUB;
                bool odd = false;
                for (int i = 0, j = 4; i < 5; j = i++)
                    if ((p[i].y > qy) != (p[j].y > qy) &&
                        qx < (p[j].x - p[i].x) * (qy - p[i].y) / (p[j].y - p[i].y) +
                                 p[i].x)
                        odd = !odd;
                in += odd;
            }
            const double a = tz_image_at(&im, x, y)[3];
            const double off = fabs(a - (double)in / (SUB * SUB));
            assert_true(off < 0.5 / SUB + 0.005); /* what samples can miss along a row */
            sum += off;
        }
    assert_true(sum / (N * N) < 2e-4);
    tz_image_deinit(&im);
    tz_element_set_deinit(&s);
    tz_ctx_free(ctx);
}

/* Half a white pixel over black is half the light. */
static void test_linear_light(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set s;
    set_init(ctx, &s, 8, 8, false);
    set_add(&s, set_symbol(&s, "<path d=\"M0 0H2.5V4H0Z\" fill=\"#fff\"/>", 5), 0, 0, 0,
            1);
    tz_element_renderer *r = renderer_of(ctx, &s, NULL, TZ_MAP_COLOUR, NULL);
    tz_image im = blank(ctx, 8, 8, 3);
    im.encoding = TZ_ENCODING_SRGB;
    tz_image_at(&im, 5, 5)[1] = 0.123456F;
    OK(tz_element_renderer_render(ctx, r, (tz_rect){0, 0, 8, 8}, &im));
    assert_true(fabsf(tz_image_at(&im, 2, 1)[0] - tz_srgb_encode(0.5F)) < 1e-6F);
    assert_true(tz_image_at(&im, 1, 1)[2] == 1);
    assert_true(tz_image_at(&im, 5, 5)[1] == 0.123456F); /* not touched */
    tz_image_deinit(&im);
    tz_element_renderer_free(r);
    tz_element_set_deinit(&s);
    tz_ctx_free(ctx);
}

/* librsvg and our own coverage draw the same thing. */
static void test_flat_equals_librsvg(void **state)
{
    (void)state;
    static const char *const markup[] = {leaf, bow, "<circle r=\"8\" cx=\"1\"/>"};
    tz_ctx *ctx = new_ctx(1);
    for (int k = 0; k < 3; k++) {
        tz_element_set a, b;
        char group[1024];
        snprintf(group, sizeof group, "<g>%s</g>", markup[k]);
        set_init(ctx, &a, 300, 280, false);
        set_init(ctx, &b, 300, 280, false);
        set_symbol(&a, markup[k], 12);
        set_symbol(&b, group, 12);
        set_scatter(&a, 40, 3, 0.5, 4);
        set_scatter(&b, 40, 3, 0.5, 4);
        tz_image p = drawn(ctx, &a, 1), q = drawn(ctx, &b, 1);
        double most = 0;
        for (int32_t y = 0; y < 280; y++)
            for (int32_t x = 0; x < 300; x++)
                most = fmax(most, fabs((double)tz_image_at(&p, x, y)[3] -
                                       tz_image_at(&q, x, y)[3]));
        if (most > 0.12)
            fail_msg("drawing %d: alpha differs by %.3f", k, most);
        assert_true(fabs(sum_of(&p, 3) - sum_of(&q, 3)) < 0.004 * sum_of(&p, 3));
        tz_image_deinit(&p);
        tz_image_deinit(&q);
        tz_element_set_deinit(&a);
        tz_element_set_deinit(&b);
    }
    tz_ctx_free(ctx);
}

/* ---- crops, threads, tori ------------------------------------------------------------ */

static void all_symbols(tz_element_set *s)
{
    set_symbol(s, leaf, 11);
    set_symbol(s, bow, 11);
    set_symbol(s, ring, 12);
    set_symbol(s, "", 5);
    set_symbol(s, glow, 10);
    OK(tz_strdup(s->ctx, "<path d=\"M0 0H9999V300H0Z\" fill=\"#eef\"/>", &s->background));
}

static void test_crops_and_threads(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    for (int torus = 0; torus < 2; torus++) {
        tz_element_set s;
        set_init(ctx, &s, 311, 402, torus);
        all_symbols(&s);
        set_scatter(&s, 300, 5, 0.3, 5);
        tz_element_render_params p;
        tz_params_default(&tz_element_render_param_table, &p);
        p.scale = 1.93;
        tz_element_renderer *r = renderer_of(ctx, &s, NULL, TZ_MAP_COLOUR, &p);
        int32_t w, h;
        tz_element_renderer_size(r, &w, &h);
        assert_int_equal(w, 600);
        assert_int_equal(h, 776);
        tz_image whole = over_nothing(ctx, r, (tz_rect){0, 0, w, h});
        assert_true(all_finite(&whole));
        const tz_rect part[] = {
            {0, 0, 1, 1},     {599, 775, 1, 1},    {255, 255, 2, 2},    {100, 0, 1, 776},
            {0, 300, 600, 1}, {37, 211, 400, 333}, {256, 256, 256, 256}};
        for (int threads = 1; threads <= 8; threads *= threads + 1) {
            tz_ctx *many = new_ctx(threads == 6 ? 8 : threads);
            tz_element_renderer *m = renderer_of(many, &s, NULL, TZ_MAP_COLOUR, &p);
            for (size_t k = 0; k < sizeof part / sizeof *part; k++) {
                tz_image im = over_nothing(many, m, part[k]);
                tz_image view = tz_image_view(&whole, part[k]);
                assert_int_equal(pixels_that_differ(&im, &view), 0);
                tz_image_deinit(&im);
            }
            tz_element_renderer_free(m);
            tz_ctx_free(many);
        }
        tz_image_deinit(&whole);
        tz_element_renderer_free(r);
        tz_element_set_deinit(&s);
    }
    tz_ctx_free(ctx);
}

/* All shifted by half the torus is the picture rolled by half. */
static void test_torus_rolls(void **state)
{
    (void)state;
    enum { W = 320, H = 256 };
    tz_ctx *ctx = new_ctx(2);
    tz_element_set s;
    set_init(ctx, &s, W, H, true);
    set_symbol(&s, leaf, 11);
    set_symbol(&s, ring, 12);
    set_scatter(&s, 60, 8, 0.5, 6);
    set_add(&s, 0, 20, 20, 0.3, 25); /* larger than the torus */
    tz_image a = drawn(ctx, &s, 1);
    for (int32_t i = 0; i < s.element.n; i++) {
        tz_element *e = &s.element.v[i];
        e->at.x += W / 2, e->at.y += H / 2;
        e->at = tz_domain_wrap(&s.domain, e->at);
    }
    tz_image b = drawn(ctx, &s, 1);
    double most = 0;
    for (int32_t y = 0; y < H; y++)
        for (int32_t x = 0; x < W; x++)
            for (int k = 0; k < 4; k++)
                most = fmax(most,
                            fabs((double)tz_image_at(&a, x, y)[k] -
                                 tz_image_at(&b, (x + W / 2) % W, (y + H / 2) % H)[k]));
    assert_true(most < 1e-3);
    tz_image_deinit(&a);
    tz_image_deinit(&b);
    tz_element_set_deinit(&s);
    tz_ctx_free(ctx);
}

/* A filter's soft border runs on across tiles. */
static void test_filters_cross_tiles(void **state)
{
    (void)state;
    static const char soft[] =
        "<filter id=\"f\" x=\"-1\" y=\"-1\" width=\"3\" height=\"3\"><feGaussianBlur "
        "stdDeviation=\"2\"/></filter><circle r=\"6\" filter=\"url(#f)\"/>";
    tz_ctx *ctx = new_ctx(1);
    tz_image im[2];
    for (int k = 0; k < 2; k++) { /* on a corner of tiles, and within one */
        tz_element_set s;
        set_init(ctx, &s, 512, 512, false);
        set_symbol(&s, soft, 7);
        set_add(&s, 0, k ? 156 : 256, k ? 156 : 256, 0, 3);
        im[k] = drawn(ctx, &s, 1);
        tz_element_set_deinit(&s);
    }
    tz_image a = tz_image_view(&im[0], (tz_rect){216, 216, 80, 80}),
             b = tz_image_view(&im[1], (tz_rect){116, 116, 80, 80});
    assert_true(sum_of(&a, 3) > 500);
    assert_true(largest_difference(&a, &b) < 1e-6);
    tz_image_deinit(&im[0]);
    tz_image_deinit(&im[1]);
    tz_ctx_free(ctx);
}

/* ---- order, kinds, sizes ------------------------------------------------------------- */

static void test_order(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set s;
    set_init(ctx, &s, 40, 40, false);
    set_symbol(&s, "<circle r=\"9\" fill=\"#f00\"/>", 9);
    set_symbol(&s, "<circle r=\"9\" fill=\"#0f0\"/>", 9);
    set_symbol(&s, "<circle r=\"9\" fill=\"#00f\"/>", 9);
    set_add(&s, 0, 20, 20, 0, 1)->depth = 3;
    set_add(&s, 1, 20, 20, 0, 1)->depth = -2;
    tz_image im = drawn(ctx, &s, 1);
    assert_true(tz_image_at(&im, 20, 20)[0] == 1); /* higher depth on top */
    tz_image_deinit(&im);
    set_add(&s, 2, 20, 20, 0, 1)->depth = 3;
    im = drawn(ctx, &s, 1);
    assert_true(tz_image_at(&im, 20, 20)[2] == 1); /* of equals the later one */
    assert_true(tz_image_at(&im, 20, 20)[0] == 0);
    tz_image_deinit(&im);
    tz_element_set_deinit(&s);
    tz_ctx_free(ctx);
}

static void test_void_nothing_and_outside(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_element_set s;
    set_init(ctx, &s, 64, 32, false);
    tz_image im = drawn(ctx, &s, 1); /* no elements, no symbols */
    assert_true(sum_of(&im, 3) == 0);
    tz_image_deinit(&im);
    set_symbol(&s, "", 5);
    set_add(&s, 0, -5.5, 10, 0, 1);
    set_add(&s, 0, 1e6, 10, 0, 1);
    set_add(&s, 0, 20, 40, 0, 1);
    im = drawn(ctx, &s, 1);
    assert_true(sum_of(&im, 3) == 0);
    tz_image_deinit(&im);
    s.kind.v[0].is_void = true;
    set_add(&s, 0, 20, 20, 0, 1);
    im = drawn(ctx, &s, 1);
    assert_true(sum_of(&im, 3) == 0);
    tz_image_deinit(&im);
    s.kind.v[0].is_void = false;
    im = drawn(ctx, &s, 1);
    assert_true(fabs(sum_of(&im, 3) - TZ_PI * 25) < 0.1);
    tz_image_deinit(&im);
    im = drawn(ctx, &s, 1e-3); /* a canvas of one pixel */
    assert_int_equal(im.width, 1);
    assert_int_equal(im.height, 1);
    tz_image_deinit(&im);
    tz_element_set_deinit(&s);
    tz_ctx_free(ctx);
}

static void test_many(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(0);
    tz_element_set s;
    set_init(ctx, &s, 1000, 1000, true);
    set_symbol(&s, "<circle r=\"1\"/>", 1);
    set_scatter(&s, 100000, 2, 0.5, 1.5);
    tz_image im = drawn(ctx, &s, 1);
    /* discs thrown at random leave exp(-sum of areas / area) bare */
    double areas = 0;
    for (int32_t i = 0; i < s.element.n; i++)
        areas += TZ_PI * s.element.v[i].scale * s.element.v[i].scale;
    const double bare = 1 - sum_of(&im, 3) / 1e6;
    assert_true(fabs(bare - exp(-areas / 1e6)) < 0.01);
    tz_image_deinit(&im);
    tz_element_set_deinit(&s);
    tz_ctx_free(ctx);
}

/* ---- labels -------------------------------------------------------------------------- */

static void test_labels(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_element_set s;
    set_init(ctx, &s, 320, 300, false);
    tz_element_kind k = {0};
    OK(tz_strdup(ctx, "other", &k.name));
    OK(tz_array_push(ctx, &s.kind, k));
    set_symbol(&s, "<path d=\"M-10 -10H10V10H-10Z\" fill-opacity=\"0.3\"/>", 15);
    set_symbol(&s, glow, 10);
    set_add(&s, 0, 50, 40, TZ_PI / 2, 2);
    set_add(&s, 0, 256, 256, 0, 1)->kind = 1;
    set_add(&s, 1, 150, 150, -0.5, 1);
    tz_element_renderer *r = renderer_of(ctx, &s, NULL, TZ_MAP_COLOUR, NULL);
    tz_image id = blank(ctx, 320, 300, 1), class = blank(ctx, 320, 300, 1),
             angle = blank(ctx, 320, 300, 1), uv = blank(ctx, 320, 300, 3);
    const tz_rect all = {0, 0, 320, 300};
    OK(tz_element_renderer_map(ctx, r, TZ_ELEMENT_MAP_ID, all, &id));
    OK(tz_element_renderer_map(ctx, r, TZ_ELEMENT_MAP_CLASS, all, &class));
    OK(tz_element_renderer_map(ctx, r, TZ_ELEMENT_MAP_ANGLE, all, &angle));
    OK(tz_element_renderer_map(ctx, r, TZ_ELEMENT_MAP_UV, all, &uv));
    int count[4] = {0};
    for (int32_t y = 0; y < 300; y++)
        for (int32_t x = 0; x < 320; x++) {
            const int v = (int)*tz_image_at(&id, x, y);
            assert_in_range(v, 0, 3);
            count[v]++;
            assert_true(*tz_image_at(&class, x, y) == (v == 0 ? 0 : v == 2 ? 2 : 1));
            const float turn = v == 1 ? 0.25F : v == 3 ? (float)(1 - 0.25 / TZ_PI) : 0;
            assert_true(fabsf(*tz_image_at(&angle, x, y) - turn) < 1e-6F);
            assert_true(tz_image_at(&uv, x, y)[2] == (v > 0));
        }
    assert_int_equal(count[1], 40 * 40);
    assert_int_equal(count[2], 20 * 20);
    assert_true(abs(count[3] - (int)(TZ_PI * 81)) < 12);
    /* 10 units to the right in the symbol, now down, are a third of its radius of 15 */
    const float *q = tz_image_at(&uv, 50, 59);
    assert_true(fabs(q[0] - (0.5 + 0.5 * 9.75 / 15)) < 1e-3);
    assert_true(fabs(q[1] - (0.5 - 0.5 * 0.25 / 15)) < 1e-3);
    /* crops */
    tz_image part = blank(ctx, 33, 100, 1);
    OK(tz_element_renderer_map(ctx, r, TZ_ELEMENT_MAP_ID, (tz_rect){240, 200, 33, 100},
                               &part));
    tz_image view = tz_image_view(&id, (tz_rect){240, 200, 33, 100});
    assert_int_equal(pixels_that_differ(&part, &view), 0);
    tz_image_deinit(&part);
    tz_image_deinit(&id);
    tz_image_deinit(&class);
    tz_image_deinit(&angle);
    tz_image_deinit(&uv);
    tz_element_renderer_free(r);
    tz_element_set_deinit(&s);
    tz_ctx_free(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_areas),
        cmocka_unit_test(test_coverage_of_pixels),
        cmocka_unit_test(test_linear_light),
        cmocka_unit_test(test_flat_equals_librsvg),
        cmocka_unit_test(test_crops_and_threads),
        cmocka_unit_test(test_torus_rolls),
        cmocka_unit_test(test_filters_cross_tiles),
        cmocka_unit_test(test_order),
        cmocka_unit_test(test_void_nothing_and_outside),
        cmocka_unit_test(test_many),
        cmocka_unit_test(test_labels),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
