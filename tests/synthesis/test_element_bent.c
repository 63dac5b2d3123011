/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Elements whose samples lie on a curve: drawings and cut-outs show bent, as tz_bend_apply
 * says, in colour and in maps; those that lie as in their symbol show as ever. */
#include "elements/bend.h"
#include "tests/synthesis/test_element_render.h"

enum { N = 120, SIDE = 160 };
#define HALF  40.0
#define THICK 5.0
#define RHO   45.0 /* radius of the curve */

static const char bar[] = "<path d=\"M-40 -5L40 -5L40 5L-40 5Z\" fill=\"#2f6cad\"/>"
                          "<path d=\"M-38 0L38 0\" fill=\"none\" stroke=\"#fff\" "
                          "stroke-width=\"2\"/>";

static int32_t add_bar(tz_element_set *s, const char *markup, bool cut)
{
    const int32_t k = set_symbol(s, markup, hypot(HALF, THICK));
    tz_element_symbol *y = &s->symbol.v[k];
    const tz_vec2 corner[4] = {
        {-HALF, -THICK}, {HALF, -THICK}, {HALF, THICK}, {-HALF, THICK}};
    OK(tz_array_push(s->ctx, &y->part, 0));
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 8; j++) {
            const tz_vec2 a = corner[i], b = corner[(i + 1) % 4];
            OK(tz_array_push(
                s->ctx, &y->outline,
                ((tz_vec2){a.x + (b.x - a.x) * j / 8.0, a.y + (b.y - a.y) * j / 8.0})));
        }
    if (cut) {
        y->photo_scale = 1;
        y->photo_at = (tz_vec2){N / 2.0, N / 2.0};
    }
    return k;
}

/* An element whose samples lie on an arc (curved) or as in the symbol. */
static void add_curved(tz_element_set *s, int32_t symbol, double x, double y,
                       double angle, bool curved)
{
    tz_vec2 rest[TZ_BEND_SAMPLES];
    int32_t n = TZ_BEND_SAMPLES;
    while (n > 2 && tz_bend_rest(NULL, &s->symbol.v[symbol], n, rest) != TZ_OK)
        n--;
    assert_true(n > 2);
    set_add(s, symbol, x, y, angle, 1);
    s->sample.n--;
    tz_element *e = &s->element.v[s->element.n - 1];
    e->sample = s->sample.n;
    e->samples = n;
    for (int32_t k = 0; k < n; k++) {
        tz_vec2 q = rest[k];
        if (curved)
            q = (tz_vec2){(RHO - q.y) * sin(q.x / RHO),
                          RHO - (RHO - q.y) * cos(q.x / RHO) - RHO * 0.13};
        const double c = cos(angle), d = sin(angle);
        const tz_sample p = {{x + c * q.x - d * q.y, y + d * q.x + c * q.y, 0}, k, 1};
        OK(tz_array_push(s->ctx, &s->sample, p));
    }
}

/* Smooth colours: what is shown tells where it comes from. */
static tz_image tell_tale(tz_ctx *ctx)
{
    tz_image im = blank(ctx, N, N, 3);
    im.encoding = TZ_ENCODING_LINEAR;
    for (int y = 0; y < N; y++)
        for (int x = 0; x < N; x++) {
            float *p = tz_image_at(&im, x, y);
            p[0] = 0.2F + 0.6F * (float)(x + 0.5) / N;
            p[1] = 0.2F + 0.6F * (float)(y + 0.5) / N;
            p[2] = 0.5F;
        }
    return im;
}

static tz_element_render_params params(void)
{
    tz_element_render_params p;
    tz_params_default(&tz_element_render_param_table, &p);
    p.harmonise = 0;
    p.rim = 0;
    return p;
}

static void start(tz_ctx *ctx, tz_element_set *s, bool torus)
{
    set_init(ctx, s, SIDE, SIDE, torus);
    set_photo(s, N, N);
}

/* A cut-out shows each place of the photo where the warp takes it, and maps tell so. */
static void test_cutouts_follow_the_warp(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_image photo = tell_tale(ctx);
    const tz_element_pixels p = {&photo, NULL, NULL};
    const tz_element_render_params prm = params();
    const tz_rect all = {0, 0, SIDE, SIDE};
    tz_element_set s;
    start(ctx, &s, false);
    add_curved(&s, add_bar(&s, "", true), 80, 70, 0.5, true);
    tz_bend bend;
    OK(tz_bend_init(ctx, &s, 0, NULL, &bend));
    assert_false(tz_bend_is_plain(&bend));
    tz_element_renderer *r = renderer_of(ctx, &s, &p, TZ_MAP_COLOUR, &prm);
    tz_image im = over_nothing(ctx, r, all), uv = blank(ctx, SIDE, SIDE, 3),
             id = blank(ctx, SIDE, SIDE, 1), angle = blank(ctx, SIDE, SIDE, 1);
    OK(tz_element_renderer_map(ctx, r, TZ_ELEMENT_MAP_UV, all, &uv));
    OK(tz_element_renderer_map(ctx, r, TZ_ELEMENT_MAP_ID, all, &id));
    OK(tz_element_renderer_map(ctx, r, TZ_ELEMENT_MAP_ANGLE, all, &angle));
    double lo = 1, hi = 0;
    for (double x = -HALF + 4; x <= HALF - 4; x += 1.7)
        for (double y = -THICK + 3; y <= THICK - 3; y += 1) {
            const tz_vec2 q = tz_bend_apply(&bend, (tz_vec2){x, y}),
                          to = tz_bend_apply(&bend, (tz_vec2){x + 0.1, y});
            const int32_t u = (int32_t)q.x, v = (int32_t)q.y;
            const tz_vec2 back = tz_bend_invert(&bend, (tz_vec2){u + 0.5, v + 0.5});
            const float *c = tz_image_at(&im, u, v), *w = tz_image_at(&uv, u, v);
            const double dx = ((double)c[0] - 0.2) / 0.6 * N - (back.x + N / 2.0),
                         dy = ((double)c[1] - 0.2) / 0.6 * N - (back.y + N / 2.0);
            if (hypot(dx, dy) > 0.6)
                fail_msg("at %.1f, %.1f: %.2f px off", x, y, hypot(dx, dy));
            if (!(c[3] > 0.9F && *tz_image_at(&id, u, v) == 1))
                fail_msg("at %.1f, %.1f: alpha %.3f", x, y, (double)c[3]);
            assert_true(fabs((double)w[0] * N - (back.x + N / 2.0)) < 0.02);
            const double turn = atan2(to.y - q.y, to.x - q.x) / (2 * TZ_PI),
                         off = *tz_image_at(&angle, u, v) - turn;
            assert_true(fabs(off - rint(off)) < 0.03);
            lo = fmin(lo, turn), hi = fmax(hi, turn);
        }
    assert_true(hi - lo > 0.1); /* it does bend */
    /* as much shows as the bar has area, ids and colour alike */
    double area = 0, named = 0;
    for (int i = 0; i < SIDE * SIDE; i++)
        area += (double)im.px[4 * i + 3], named += id.px[i] > 0;
    assert_true(fabs(named - 4 * HALF * THICK) < 0.06 * 4 * HALF * THICK);
    assert_true(fabs(area - 4 * HALF * THICK) < 0.06 * 4 * HALF * THICK);
    tz_image_deinit(&im);
    tz_image_deinit(&uv);
    tz_image_deinit(&id);
    tz_image_deinit(&angle);
    tz_element_renderer_free(r);
    tz_bend_deinit(&bend);
    tz_element_set_deinit(&s);
    tz_image_deinit(&photo);
    tz_ctx_free(ctx);
}

/* A drawing covers what its bent outline holds. */
static void test_drawings_follow_the_warp(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set s;
    start(ctx, &s, false);
    add_curved(&s, add_bar(&s, bar, false), 80, 70, 0.5, true);
    tz_bend bend;
    OK(tz_bend_init(ctx, &s, 0, NULL, &bend));
    tz_image im = drawn(ctx, &s, 2);
    for (double x = -HALF + 1; x <= HALF - 1; x += 1.3)
        for (double y = -THICK - 1; y <= THICK + 1; y += 1) {
            const tz_vec2 q = tz_bend_apply(&bend, (tz_vec2){x, y});
            const float *c = tz_image_at(&im, (int32_t)(2 * q.x), (int32_t)(2 * q.y));
            if (fabs(y) < THICK - 0.6)
                assert_true(c[3] == 1);
            if (fabs(y) > THICK + 0.6)
                assert_true(c[3] < 0.1F);
            if (fabs(x) < 37 && fabs(y) < 0.1)
                assert_true(c[0] > 0.9F); /* the white line */
        }
    assert_true(fabs(sum_of(&im, 3) - 16 * HALF * THICK) < 0.05 * 16 * HALF * THICK);
    tz_image_deinit(&im);
    tz_bend_deinit(&bend);
    tz_element_set_deinit(&s);
    tz_ctx_free(ctx);
}

/* Samples that lie as in the symbol change no byte. */
static void test_plain_ones_stay(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_image photo = tell_tale(ctx);
    const tz_element_pixels p = {&photo, NULL, NULL};
    tz_element_set s;
    start(ctx, &s, false);
    const int32_t cut = add_bar(&s, "", true), flat = add_bar(&s, bar, false);
    add_curved(&s, cut, 70, 60, 0.3, false);
    add_curved(&s, flat, 70, 100, -0.6, false);
    tz_image im[2];
    for (int k = 0; k < 2; k++) {
        tz_element_renderer *r = renderer_of(ctx, &s, &p, TZ_MAP_COLOUR, NULL);
        im[k] = over_nothing(ctx, r, (tz_rect){0, 0, SIDE, SIDE});
        tz_element_renderer_free(r);
        for (int32_t i = 0; i < s.element.n; i++)
            s.element.v[i].samples = 1;
    }
    assert_int_equal(pixels_that_differ(&im[0], &im[1]), 0);
    tz_image_deinit(&im[0]);
    tz_image_deinit(&im[1]);
    tz_element_set_deinit(&s);
    tz_image_deinit(&photo);
    tz_ctx_free(ctx);
}

static void fill(tz_element_set *s)
{
    const int32_t cut = add_bar(s, "", true), flat = add_bar(s, bar, false),
                  rich = add_bar(s, glow, false);
    tz_rng rng = tz_rng_make(5, 5);
    for (int k = 0; k < 24; k++)
        add_curved(s,
                   k % 8 == 7 ? rich
                   : k % 2    ? flat
                              : cut,
                   tz_rng_range(&rng, 0, SIDE), tz_rng_range(&rng, 0, SIDE),
                   tz_rng_range(&rng, -3, 3), k % 3 > 0);
}

/* Crops, threads, and the other side of a torus. */
static void test_crops_threads_torus(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_image photo = tell_tale(ctx), whole = {0};
    const tz_element_pixels p = {&photo, &photo, NULL};
    tz_element_render_params prm = params();
    tz_element_set s;
    prm.scale = 3;
    start(ctx, &s, true);
    fill(&s);
    for (int threads = 1; threads <= 8; threads = threads == 1 ? 2 : threads * 4) {
        tz_ctx *many = new_ctx(threads);
        tz_element_renderer *r = renderer_of(many, &s, &p, TZ_MAP_COLOUR, &prm);
        if (threads == 1)
            whole = over_nothing(ctx, r, (tz_rect){0, 0, 3 * SIDE, 3 * SIDE});
        const tz_rect part[] = {
            {0, 0, 3 * SIDE, 3 * SIDE}, {250, 3, 9, 400}, {1, 255, 478, 2}};
        for (size_t k = 0; k < sizeof part / sizeof *part; k++) {
            tz_image im = over_nothing(many, r, part[k]);
            tz_image view = tz_image_view(&whole, part[k]);
            assert_int_equal(pixels_that_differ(&im, &view), 0);
            tz_image_deinit(&im);
        }
        tz_element_renderer_free(r);
        tz_ctx_free(many);
    }
    assert_true(all_finite(&whole));
    for (int32_t i = 0; i < s.element.n; i++) { /* rolled by half a torus */
        tz_element *e = &s.element.v[i];
        const tz_vec3 from = e->at;
        e->at = tz_domain_wrap(&s.domain,
                               (tz_vec3){from.x + SIDE / 2.0, from.y + SIDE / 2.0, 0});
        for (int32_t k = 0; k < e->samples; k++) {
            s.sample.v[e->sample + k].at.x += e->at.x - from.x;
            s.sample.v[e->sample + k].at.y += e->at.y - from.y;
        }
    }
    tz_element_renderer *r = renderer_of(ctx, &s, &p, TZ_MAP_COLOUR, &prm);
    tz_image rolled = over_nothing(ctx, r, (tz_rect){0, 0, 3 * SIDE, 3 * SIDE});
    double sum = 0;
    for (int y = 0; y < 3 * SIDE; y++)
        for (int x = 0; x < 3 * SIDE; x++)
            for (int k = 0; k < 4; k++)
                sum += fabs((double)tz_image_at(&whole, x, y)[k] -
                            tz_image_at(&rolled, (x + 3 * SIDE / 2) % (3 * SIDE),
                                        (y + 3 * SIDE / 2) % (3 * SIDE))[k]);
    assert_true(sum / (9.0 * SIDE * SIDE * 4) < 1e-3);
    tz_element_renderer_free(r);
    tz_image_deinit(&rolled);
    tz_image_deinit(&whole);
    tz_element_set_deinit(&s);
    tz_image_deinit(&photo);
    tz_ctx_free(ctx);
}

/* A bent plane of normals turns with the warp, and stays one of unit length. */
static void test_normals_turn(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_image photo = tell_tale(ctx), normal = picture_plane(ctx, N, N, 0.6, 0, 0.8);
    const tz_element_pixels p = {&photo, NULL, &normal};
    const tz_element_render_params prm = params();
    tz_element_set s;
    start(ctx, &s, false);
    add_curved(&s, add_bar(&s, "", true), 80, 70, 0, true);
    tz_bend bend;
    OK(tz_bend_init(ctx, &s, 0, NULL, &bend));
    tz_element_renderer *r = renderer_of(ctx, &s, &p, TZ_MAP_NORMAL, &prm);
    tz_image im = over_nothing(ctx, r, (tz_rect){0, 0, SIDE, SIDE});
    for (double x = -30; x <= 30; x += 6) {
        const tz_vec2 q = tz_bend_apply(&bend, (tz_vec2){x, 0}),
                      to = tz_bend_apply(&bend, (tz_vec2){x + 4, 0}),
                      back = tz_bend_apply(&bend, (tz_vec2){x - 4, 0});
        const double a = atan2(to.y - back.y, to.x - back.x);
        const float *v = tz_image_at(&im, (int32_t)q.x, (int32_t)q.y);
        assert_true(fabs(2 * v[0] - 1 - 0.6 * cos(a)) < 0.06);
        assert_true(fabs(2 * v[1] - 1 + 0.6 * sin(a)) < 0.06); /* normals' y is up */
        assert_true(fabs(2 * v[2] - 1 - 0.8) < 0.01);
    }
    tz_image_deinit(&im);
    tz_element_renderer_free(r);
    tz_bend_deinit(&bend);
    tz_element_set_deinit(&s);
    tz_image_deinit(&normal);
    tz_image_deinit(&photo);
    tz_ctx_free(ctx);
}

static void test_no_memory(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_image photo = tell_tale(ctx);
    const tz_element_pixels p = {&photo, NULL, NULL};
    tz_element_set s;
    start(ctx, &s, true);
    const int32_t cut = add_bar(&s, "", true), flat = add_bar(&s, bar, false);
    add_curved(&s, cut, 70, 60, 0.3, true);
    add_curved(&s, flat, 70, 100, -0.6, true);
    int64_t n = 1;
    for (bool failed = true; failed; n++) {
        tz_ctx *bad = NULL;
        tz_element_renderer *r = NULL;
        OK(tz_ctx_new(&(tz_ctx_options){.threads = 1, .fail_alloc = n}, &bad));
        const tz_status st =
            tz_element_renderer_new(bad, &s, &p, TZ_MAP_COLOUR, NULL, &r);
        failed = st != TZ_OK;
        if (failed)
            assert_true(st == TZ_NOMEM && !r);
        tz_element_renderer_free(r);
        assert_int_equal(tz_ctx_memory_used(bad), 0);
        tz_ctx_free(bad);
    }
    assert_true(n > 30);
    tz_element_set_deinit(&s);
    tz_image_deinit(&photo);
    tz_ctx_free(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cutouts_follow_the_warp),
        cmocka_unit_test(test_drawings_follow_the_warp),
        cmocka_unit_test(test_plain_ones_stay),
        cmocka_unit_test(test_crops_threads_torus),
        cmocka_unit_test(test_normals_turn),
        cmocka_unit_test(test_no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
