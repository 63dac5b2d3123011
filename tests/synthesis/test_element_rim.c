/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Rims: what a cut-out carries along of the gap about it, and what it does not. */
#include "tests/synthesis/test_element_render.h"

enum { N = 160, SIDE = 3, PITCH = 46, R = 20 };

static const float gap[3] = {0.03F, 0.02F, 0.025F};

static tz_vec2 centre_of(int k)
{
    return (tz_vec2){34 + (k % SIDE) * PITCH, 34 + (k / SIDE) * PITCH};
}

/* Discs of as many colours on a dark ground. */
static tz_image discs_photo(tz_ctx *ctx, double r)
{
    tz_image im = blank(ctx, N, N, 3);
    im.encoding = TZ_ENCODING_LINEAR;
    for (int y = 0; y < N; y++)
        for (int x = 0; x < N; x++) {
            float *p = tz_image_at(&im, x, y);
            memcpy(p, gap, sizeof gap);
            for (int k = 0; k < SIDE * SIDE; k++) {
                const tz_vec2 c = centre_of(k);
                const double d = hypot(x + 0.5 - c.x, y + 0.5 - c.y);
                const float a = (float)fmin(fmax(r + 0.5 - d, 0), 1);
                const float v[3] = {0.3F + 0.05F * (float)k, 0.5F,
                                    0.8F - 0.05F * (float)k};
                for (int i = 0; i < 3; i++)
                    p[i] += a * (v[i] - p[i]);
            }
        }
    return im;
}

static void discs_set(tz_ctx *ctx, tz_element_set *s, double r)
{
    set_init(ctx, s, 120, 120, false);
    set_photo(s, N, N);
    for (int k = 0; k < SIDE * SIDE; k++)
        set_disc(s, centre_of(k).x, centre_of(k).y, r);
}

static tz_element_render_params params(double rim)
{
    tz_element_render_params p;
    tz_params_default(&tz_element_render_param_table, &p);
    p.rim = rim;
    p.harmonise = 0;
    return p;
}

static tz_image shown(tz_ctx *ctx, const tz_element_set *s, const tz_element_pixels *p,
                      tz_map_kind kind, double rim)
{
    const tz_element_render_params prm = params(rim);
    tz_element_renderer *r = renderer_of(ctx, s, p, kind, &prm);
    tz_image im = over_nothing(ctx, r, (tz_rect){0, 0, 120, 120});
    tz_element_renderer_free(r);
    return im;
}

/* Where two overlap, a piece of the upper one's gap lies between them, in whatever pose;
 * beyond it the lower one shows as it is. */
static void test_a_gap_between_overlapping_things(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_image photo = discs_photo(ctx, R);
    const tz_element_pixels p = {&photo, NULL, NULL};
    for (int turned = 0; turned < 2; turned++) {
        tz_element_set s;
        discs_set(ctx, &s, R);
        set_add(&s, 3, 40, 60, turned ? 0.7 : 0, 1);
        set_add(&s, 4, 70, 60, turned ? -0.4 : 0, 1)->depth = 1;
        tz_image with = shown(ctx, &s, &p, TZ_MAP_COLOUR, -1),
                 without = shown(ctx, &s, &p, TZ_MAP_COLOUR, 0);
        const float *at = tz_image_at(&with, 48, 60),
                    *bare = tz_image_at(&without, 48, 60);
        for (int k = 0; k < 3; k++) {
            assert_true(at[k] < 0.1F && bare[k] > 0.3F); /* 1.5 px outside */
            assert_true(fabsf(tz_image_at(&with, 40, 60)[k] -
                              tz_image_at(&without, 40, 60)[k]) < 1e-4F);
            assert_true(fabsf(tz_image_at(&with, 60, 60)[k] -
                              tz_image_at(&without, 60, 60)[k]) < 1e-3F);
        }
        /* it darkens only, and reaches a sixth of the thing's size and no farther, but
         * for splines' swing */
        for (int y = 30; y < 90; y++)
            for (int x = 15; x < 100; x++) {
                const float *a = tz_image_at(&with, x, y),
                            *b = tz_image_at(&without, x, y);
                const double d = fmin(hypot(x + 0.5 - 40, y + 0.5 - 60),
                                      hypot(x + 0.5 - 70, y + 0.5 - 60));
                if (!(a[3] >= b[3] - 5e-3F))
                    fail_msg("at %d,%d (%.2f px out): alpha %.3f, %.3f without", x, y,
                             d - R, (double)a[3], (double)b[3]);
                if (d > R + 6)
                    assert_true(a[3] < 1e-2F);
                for (int k = 0; k < 3 && b[3] > 0.999F; k++)
                    assert_true(a[k] <= b[k] + 0.03F); /* splines swing */
            }
        tz_image_deinit(&with);
        tz_image_deinit(&without);
        tz_element_set_deinit(&s);
    }
    tz_image_deinit(&photo);
    tz_ctx_free(ctx);
}

/* Things that touch: nothing of a neighbour's face comes along, however wide the rim. */
static void test_no_neighbours_face(void **state)
{
    (void)state;
    static const double rim[] = {-1, 3, 12};
    const double r = 0.5 * PITCH;
    tz_ctx *ctx = new_ctx(1);
    tz_image photo = discs_photo(ctx, r);
    const tz_element_pixels p = {&photo, NULL, NULL};
    /* the middle one green, the others red */
    for (int y = 0; y < N; y++)
        for (int x = 0; x < N; x++) {
            float *v = tz_image_at(&photo, x, y);
            const tz_vec2 c = centre_of(4);
            const double d = hypot(x + 0.5 - c.x, y + 0.5 - c.y);
            const float own = (float)fmin(fmax(r + 0.5 - d, 0), 1);
            const float share = (v[1] - gap[1]) / (0.5F - gap[1]);
            v[0] = 0.6F * fmaxf(share - own, 0), v[1] = 0.6F * own, v[2] = 0;
        }
    for (size_t k = 0; k < sizeof rim / sizeof *rim; k++) {
        tz_element_set s;
        discs_set(ctx, &s, r);
        set_add(&s, 4, 60, 60, 0, 1);
        tz_image im = shown(ctx, &s, &p, TZ_MAP_COLOUR, rim[k]);
        double red = 0, reds = 0, dark = 0;
        for (int i = 0; i < 120 * 120; i++) {
            const float *v = im.px + 4 * (size_t)i;
            red = fmax(red, (double)v[0]);
            reds += (double)v[0];
            dark += v[3] > 0.5F && v[0] < 0.05F && v[1] < 0.05F;
        }
        /* no more than the soft borders of the dark corners */
        if (red > 0.3 || reds > 0.05 * 2 * TZ_PI * r)
            fail_msg("rim %g: a neighbour's face by %.3f, %.2f px", rim[k], red, reds);
        assert_true(dark > 20); /* but the dark corners between them */
        tz_image_deinit(&im);
        tz_element_set_deinit(&s);
    }
    tz_image_deinit(&photo);
    tz_ctx_free(ctx);
}

/* Other maps have the same rim; ids name the thing alone. */
static void test_maps_have_rims(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_image photo = discs_photo(ctx, R), height = blank(ctx, N, N, 1);
    height.encoding = TZ_ENCODING_DATA;
    for (int i = 0; i < N * N; i++)
        height.px[i] = photo.px[3 * (size_t)i + 1] > 0.26F ? 9 : 2;
    tz_element_set s;
    discs_set(ctx, &s, R);
    set_add(&s, 3, 40, 60, 0.3, 1);
    set_add(&s, 4, 70, 60, 0.3, 1)->depth = 1;
    tz_element_pixels p = {&photo, NULL, NULL};
    tz_image colour = shown(ctx, &s, &p, TZ_MAP_COLOUR, -1);
    const tz_element_render_params with = params(-1), none = params(0);
    tz_image id[2];
    for (int k = 0; k < 2; k++) {
        tz_element_renderer *r =
            renderer_of(ctx, &s, &p, TZ_MAP_COLOUR, k ? &with : &none);
        id[k] = blank(ctx, 120, 120, 1);
        OK(tz_element_renderer_map(ctx, r, TZ_ELEMENT_MAP_ID, (tz_rect){0, 0, 120, 120},
                                   &id[k]));
        tz_element_renderer_free(r);
    }
    assert_int_equal(pixels_that_differ(&id[0], &id[1]), 0);
    p.map = &height;
    tz_image h = shown(ctx, &s, &p, TZ_MAP_DATA, -1);
    for (int i = 0; i < 120 * 120; i++)
        assert_true(fabsf(h.px[2 * (size_t)i + 1] - colour.px[4 * (size_t)i + 3]) <
                    0.02F);
    assert_true(*tz_image_at(&h, 48, 60) < 3);
    assert_true(*tz_image_at(&h, 55, 60) > 8.9F && *tz_image_at(&h, 35, 60) > 8.9F);
    tz_image_deinit(&h);
    tz_image_deinit(&colour);
    tz_image_deinit(&id[0]);
    tz_image_deinit(&id[1]);
    tz_element_set_deinit(&s);
    tz_image_deinit(&height);
    tz_image_deinit(&photo);
    tz_ctx_free(ctx);
}

/* What is no thing of the set and yet no gap stays where it was: a white blot in the gap. */
static void test_only_what_looks_like_gap(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_image photo = discs_photo(ctx, R);
    const tz_element_pixels p = {&photo, NULL, NULL};
    const tz_vec2 c = centre_of(4);
    for (int y = -2; y <= 2; y++)
        for (int x = 1; x <= 4; x++)
            for (int k = 0; k < 3; k++)
                tz_image_at(&photo, (int)c.x + R + x, (int)c.y + y)[k] = 0.95F;
    tz_element_set s;
    discs_set(ctx, &s, R);
    set_add(&s, 4, 60, 60, 0, 1);
    tz_image im = shown(ctx, &s, &p, TZ_MAP_COLOUR, 4);
    for (int x = 60 + R + 1; x < 60 + R + 6; x++)
        assert_true(tz_image_at(&im, x, 60)[3] < 0.02F);
    assert_true(tz_image_at(&im, 60 - R - 2, 60)[3] > 0.9F);
    tz_image_deinit(&im);
    tz_element_set_deinit(&s);
    tz_image_deinit(&photo);
    tz_ctx_free(ctx);
}

/* The n-th allocation fails: an error, nothing leaks; the same bytes at any thread count. */
static void test_faults_and_threads(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_image photo = discs_photo(ctx, R), one = {0};
    const tz_element_pixels p = {&photo, &photo, NULL};
    tz_element_set s;
    discs_set(ctx, &s, R);
    for (int k = 0; k < 9; k++)
        set_add(&s, k, 20 + 35 * (k % 3), 25 + 33 * (k / 3), 0.4 * k, 1.1);
    for (int threads = 1; threads <= 8; threads = threads == 1 ? 2 : threads * 4) {
        tz_ctx *many = new_ctx(threads);
        tz_image im = shown(many, &s, &p, TZ_MAP_COLOUR, -1);
        if (threads == 1)
            OK(tz_image_copy(ctx, &im, &one));
        assert_int_equal(pixels_that_differ(&one, &im), 0);
        tz_image_deinit(&im);
        tz_ctx_free(many);
    }
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
    assert_true(n > 100);
    tz_image_deinit(&one);
    tz_element_set_deinit(&s);
    tz_image_deinit(&photo);
    tz_ctx_free(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_gap_between_overlapping_things),
        cmocka_unit_test(test_no_neighbours_face),
        cmocka_unit_test(test_maps_have_rims),
        cmocka_unit_test(test_only_what_looks_like_gap),
        cmocka_unit_test(test_faults_and_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
