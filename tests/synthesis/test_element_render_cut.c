/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Elements cut from photos: borders without a trace of what lay beside them, shadows that
 * stay, light that is evened, maps of a material. */
#include "tests/synthesis/test_element_render.h"

enum { N = 96 };
#define CX 47.3
#define CY 50.6
#define R  19.4

static const float thing[3] = {0.8F, 0.2F, 0.1F}, ground[3] = {0.1F, 0.15F, 0.6F};

/* Share of pixel (x, y) in a disc, blurred by a box as wide as `blur`. */
static double in_disc(double x, double y, double r, double blur)
{
    enum { SUB = 12 };
    int in = 0;
    for (int k = 0; k < SUB * SUB; k++) {
        const double u = x + 0.5 + ((k % SUB + 0.5) / SUB - 0.5) * blur - CX,
                     v = y + 0.5 + ((k / SUB + 0.5) / SUB - 0.5) * blur - CY;
        in += u * u + v * v <= r * r;
    }
    return (double)in / (SUB * SUB);
}

/* A disc of one colour on another: linear light, then sRGB as a camera stores it. */
static tz_image disc_photo(tz_ctx *ctx, double blur)
{
    tz_image im = blank(ctx, N, N, 3);
    im.encoding = TZ_ENCODING_SRGB;
    for (int y = 0; y < N; y++)
        for (int x = 0; x < N; x++) {
            const double a = in_disc(x, y, R, blur);
            for (int k = 0; k < 3; k++)
                tz_image_at(&im, x, y)[k] =
                    tz_srgb_encode((float)(a * thing[k] + (1 - a) * ground[k]));
        }
    return im;
}

static tz_element_render_params params(double shadow, double harmonise)
{
    tz_element_render_params p;
    tz_params_default(&tz_element_render_param_table, &p);
    p.shadow = shadow;
    p.harmonise = harmonise;
    p.rim = 0; /* see test_element_rim.c */
    return p;
}

/* ---- borders ------------------------------------------------------------------------- */

/* Whatever the copy's place, turn and size, and though the outline is a little too wide or
 * narrow: only the thing's own colour arrives on a third one. */
static void test_no_trace_of_the_old_ground(void **state)
{
    (void)state;
    static const double off[] = {-0.7, 0, 0.7}, scale[] = {1, 1.37, 0.6, 0.23};
    tz_ctx *ctx = new_ctx(2);
    for (int blur = 1; blur <= 2; blur++)
        for (int o = 0; o < 3; o++)
            for (int k = 0; k < 4; k++) {
                tz_image photo = disc_photo(ctx, blur);
                tz_element_set s;
                set_init(ctx, &s, 120, 120, false);
                set_photo(&s, N, N);
                set_disc(&s, CX, CY, R + off[o]);
                set_add(&s, 0, k ? 61.37 : CX + 13, k ? 58.9 : CY + 8, k ? 0.6 : 0,
                        scale[k]);
                const tz_element_pixels p = {&photo, NULL, NULL};
                const tz_element_render_params prm = params(8, 0);
                tz_element_renderer *r = renderer_of(ctx, &s, &p, TZ_MAP_COLOUR, &prm);
                tz_image im = over_nothing(ctx, r, (tz_rect){0, 0, 120, 120});
                double most = 0, area = 0;
                for (int i = 0; i < 120 * 120; i++) {
                    const float *v = im.px + 4 * (size_t)i;
                    assert_true(v[3] >= 0 && v[3] <= 1);
                    area += v[3];
                    for (int c = 0; c < 3 && v[3] > 1e-3F; c++)
                        most = fmax(most, fabs((double)v[c] - thing[c]) * v[3]);
                }
                /* an outline too wide has a little of a wide blur beyond its band */
                if (most > (blur == 2 && o == 2 ? 0.01 : 0.004))
                    fail_msg("blur %d off %.1f scale %.2f: colour off by %.4f", blur,
                             off[o], scale[k], most);
                /* and it is as large as the thing, not as its outline */
                const double want = TZ_PI * R * R * scale[k] * scale[k];
                if (fabs(area - want) > 0.02 * want)
                    fail_msg("blur %d off %.1f scale %.2f: area %.1f, not %.1f", blur,
                             off[o], scale[k], area, want);
                tz_image_deinit(&im);
                tz_element_renderer_free(r);
                tz_element_set_deinit(&s);
                tz_image_deinit(&photo);
            }
    tz_ctx_free(ctx);
}

/* Alpha falls from the middle outward, never rises. */
static void test_alpha_is_monotone(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_image photo = disc_photo(ctx, 1.5);
    tz_element_set s;
    set_init(ctx, &s, N, N, false);
    set_photo(&s, N, N);
    set_disc(&s, CX, CY, R);
    set_add(&s, 0, CX, CY, 0, 1);
    const tz_element_pixels p = {&photo, NULL, NULL};
    tz_element_renderer *r = renderer_of(ctx, &s, &p, TZ_MAP_COLOUR, NULL);
    tz_image im = over_nothing(ctx, r, (tz_rect){0, 0, N, N});
    for (int x = (int)CX; x + 1 < N; x++)
        assert_true(tz_image_at(&im, x + 1, 50)[3] <= tz_image_at(&im, x, 50)[3] + 1e-5F);
    for (int x = (int)CX; x > 0; x--)
        assert_true(tz_image_at(&im, x - 1, 50)[3] <= tz_image_at(&im, x, 50)[3] + 1e-5F);
    assert_true(tz_image_at(&im, (int)CX, 50)[3] == 1);
    assert_true(tz_image_at(&im, 10, 50)[3] == 0);
    tz_image_deinit(&im);
    tz_element_renderer_free(r);
    tz_element_set_deinit(&s);
    tz_image_deinit(&photo);
    tz_ctx_free(ctx);
}

/* ---- shadows ------------------------------------------------------------------------- */

/* Light left of the ground under a shadow 6 px wide, darkest at the disc. */
static float shadow_at(int x, int y)
{
    const double d = hypot(x + 0.5 - CX, y + 0.5 - CY) - R;
    return d > 6 ? 1 : d < 0 ? 0.4F : (float)(0.4 + 0.1 * d);
}

static void test_shadows_stay(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_image photo = disc_photo(ctx, 1), plate = blank(ctx, N, N, 3);
    plate.encoding = TZ_ENCODING_SRGB;
    for (int y = 0; y < N; y++)
        for (int x = 0; x < N; x++) {
            const double a = in_disc(x, y, R, 1);
            for (int k = 0; k < 3; k++) {
                const double g = ground[k] * shadow_at(x, y);
                tz_image_at(&photo, x, y)[k] =
                    tz_srgb_encode((float)(a * thing[k] + (1 - a) * g));
                tz_image_at(&plate, x, y)[k] = tz_srgb_encode(ground[k]);
            }
        }
    tz_element_set s;
    set_init(ctx, &s, 200, 120, false);
    set_photo(&s, N, N);
    set_disc(&s, CX, CY, R);
    set_add(&s, 0, 60, 60, 0, 1);
    set_add(&s, 0, 60 + 2 * R + 2, 60, 0.7, 1)->depth = -1; /* beneath: in the shadow */
    const tz_element_pixels with = {&photo, &plate, NULL}, without = {&photo, NULL, NULL};
    tz_image im[2];
    for (int k = 0; k < 2; k++) {
        const tz_element_render_params prm = params(8, 0);
        tz_element_renderer *r =
            renderer_of(ctx, &s, k ? &without : &with, TZ_MAP_COLOUR, &prm);
        im[k] = blank(ctx, 200, 120, 3);
        for (size_t i = 0; i < 200 * 120 * 3; i++)
            im[k].px[i] = 0.5F; /* grey light */
        im[k].encoding = TZ_ENCODING_LINEAR;
        OK(tz_element_renderer_render(ctx, r, (tz_rect){0, 0, 200, 120}, &im[k]));
        tz_element_renderer_free(r);
    }
    for (int y = 0; y < 120; y++) /* shadows darken only, and all colours alike */
        for (int x = 0; x < 200; x++) {
            const float *a = tz_image_at(&im[0], x, y), *b = tz_image_at(&im[1], x, y);
            for (int k = 0; k < 3; k++)
                assert_true(a[k] <= b[k] + 1e-5F);
        }
    /* near the disc it is dark, farther away less, far away not at all */
    const int left = (int)(60 - R);
    assert_true(tz_image_at(&im[0], left - 2, 60)[1] < 0.75F * 0.5F);
    assert_true(tz_image_at(&im[0], left - 4, 60)[1] < 0.95F * 0.5F);
    assert_true(tz_image_at(&im[0], left - 4, 60)[1] >
                tz_image_at(&im[0], left - 2, 60)[1]);
    assert_true(fabsf(tz_image_at(&im[0], left - 10, 60)[1] - 0.5F) < 1e-3F);
    /* it falls on the disc beneath, and not on its own */
    assert_true(tz_image_at(&im[0], 60 + (int)R + 3, 60)[0] < 0.8F * thing[0]);
    assert_true(fabsf(tz_image_at(&im[0], 60, 60)[0] - thing[0]) < 1e-3F);
    assert_true(fabsf(tz_image_at(&im[0], 60 - (int)R + 3, 60)[0] - thing[0]) < 0.01F);
    tz_image_deinit(&im[0]);
    tz_image_deinit(&im[1]);
    tz_element_set_deinit(&s);
    tz_image_deinit(&photo);
    tz_image_deinit(&plate);
    tz_ctx_free(ctx);
}

/* ---- the photo again ----------------------------------------------------------------- */

/* Elements at their own places over their plate give the photo. */
static void test_identity(void **state)
{
    (void)state;
    enum { S = 300, DISCS = 20 };
    tz_ctx *ctx = new_ctx(2);
    tz_image plate = picture(ctx, PICTURE_SMOOTH, S, S, 3, 4),
             stuff = picture(ctx, PICTURE_NOISE, S, S, 3, 6), photo = blank(ctx, S, S, 3);
    tz_element_set s;
    tz_rng rng = tz_rng_make(3, 3);
    photo.encoding = TZ_ENCODING_SRGB;
    memcpy(photo.px, plate.px, (size_t)S * S * 3 * sizeof *photo.px);
    set_init(ctx, &s, S, S, false);
    set_photo(&s, S, S);
    for (int k = 0; k < DISCS; k++) {
        const double x = 40 + 55 * (k % 5) + tz_rng_range(&rng, -8, 8),
                     y = 40 + 65 * (k / 5) + tz_rng_range(&rng, -8, 8),
                     r = tz_rng_range(&rng, 8, 16);
        float c[3];
        for (int i = 0; i < 3; i++)
            c[i] = (float)tz_rng_range(&rng, 0.2, 0.8);
        for (int v = 0; v < S; v++)
            for (int u = 0; u < S; u++) {
                const double a =
                    fmin(fmax(r + 0.5 - hypot(u + 0.5 - x, v + 0.5 - y), 0), 1);
                for (int i = 0; i < 3 && a > 0; i++) {
                    float *p = &tz_image_at(&photo, u, v)[i];
                    const float f = c[i] + 0.1F * (tz_image_at(&stuff, u, v)[i] - 0.5F);
                    *p = tz_srgb_encode(
                        (float)(a * tz_srgb_decode(f) + (1 - a) * tz_srgb_decode(*p)));
                }
            }
        set_add(&s, set_disc(&s, x, y, r), x, y, 0, 1);
    }
    const tz_element_pixels p = {&photo, &plate, NULL};
    for (int k = 0; k < 4; k++) {
        /* by whole pixels, and sampled anew; without and with a rim */
        const int shift = k / 2;
        tz_element_render_params prm = params(6, 0);
        prm.rim = k % 2 ? -1 : 0;
        tz_element_renderer *r = renderer_of(ctx, &s, &p, TZ_MAP_COLOUR, &prm);
        tz_image im;
        OK(tz_image_copy(ctx, &plate, &im));
        OK(tz_element_renderer_render(ctx, r, (tz_rect){0, 0, S, S}, &im));
        double error = 0;
        for (size_t i = 0; i < (size_t)S * S * 3; i++) {
            const double d = (double)im.px[i] - photo.px[i];
            error += d * d / (S * S * 3.0);
        }
        const double psnr = -10 * log10(error);
        if (psnr < 46)
            fail_msg("shift %d rim %g: PSNR %.2f dB", shift, prm.rim, psnr);
        tz_image_deinit(&im);
        tz_element_renderer_free(r);
        for (int32_t i = 0; k == 1 && i < s.element.n; i++) /* a turn too small to see */
            s.element.v[i].angle = 1e-3;
    }
    tz_element_set_deinit(&s);
    tz_image_deinit(&photo);
    tz_image_deinit(&stuff);
    tz_image_deinit(&plate);
    tz_ctx_free(ctx);
}

/* ---- crops, threads, tori ------------------------------------------------------------ */

static void test_crops_threads_torus(void **state)
{
    (void)state;
    enum { W = 400, H = 320 };
    tz_ctx *ctx = new_ctx(1);
    tz_image photo = picture(ctx, PICTURE_STONES, 200, 150, 3, 2),
             plate = picture(ctx, PICTURE_SMOOTH, 200, 150, 3, 3);
    tz_element_set s;
    set_init(ctx, &s, W, H, true);
    set_photo(&s, 200, 150);
    for (int k = 0; k < 6; k++)
        set_disc(&s, 20 + 30 * k, 12 + 25 * k, 14 + 3 * k); /* over the photo's border */
    set_scatter(&s, 150, 4, 0.1, 2.5);
    const tz_element_pixels p = {&photo, &plate, NULL};
    tz_image whole = {0};
    for (int threads = 1; threads <= 8; threads = threads == 1 ? 2 : threads * 4) {
        tz_ctx *many = new_ctx(threads);
        tz_element_renderer *r = renderer_of(many, &s, &p, TZ_MAP_COLOUR, NULL);
        if (threads == 1)
            whole = over_nothing(ctx, r, (tz_rect){0, 0, W, H});
        const tz_rect part[] = {{0, 0, W, H},
                                {255, 200, 3, 100},
                                {100, 0, 1, H},
                                {399, 319, 1, 1},
                                {77, 33, 300, 200}};
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
    /* rolled by half: whole pixels, so that samples agree */
    for (int32_t i = 0; i < s.element.n; i++) {
        tz_element *e = &s.element.v[i];
        e->at.x += W / 2, e->at.y += H / 2;
        e->at = tz_domain_wrap(&s.domain, e->at);
    }
    tz_element_renderer *r = renderer_of(ctx, &s, &p, TZ_MAP_COLOUR, NULL);
    tz_image rolled = over_nothing(ctx, r, (tz_rect){0, 0, W, H});
    double most = 0, sum = 0;
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++)
            for (int k = 0; k < 4; k++) {
                const double d =
                    fabs((double)tz_image_at(&whole, x, y)[k] -
                         tz_image_at(&rolled, (x + W / 2) % W, (y + H / 2) % H)[k]);
                most = fmax(most, d * (k < 3 ? tz_image_at(&whole, x, y)[3] : 1));
                sum += d;
            }
    assert_true(most < 0.01 && sum / (W * H * 4) < 1e-4);
    tz_element_renderer_free(r);
    tz_image_deinit(&rolled);
    tz_image_deinit(&whole);
    tz_element_set_deinit(&s);
    tz_image_deinit(&plate);
    tz_image_deinit(&photo);
    tz_ctx_free(ctx);
}

/* ---- light --------------------------------------------------------------------------- */

/* A photo twice as bright at its right: copies of both sides come closer with harmonise. */
static void test_light_is_evened(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_image photo = blank(ctx, 400, 100, 3);
    photo.encoding = TZ_ENCODING_LINEAR;
    for (int y = 0; y < 100; y++)
        for (int x = 0; x < 400; x++)
            for (int k = 0; k < 3; k++)
                tz_image_at(&photo, x, y)[k] = 0.2F + 0.2F * (float)x / 400;
    tz_element_set s;
    set_init(ctx, &s, 100, 50, false);
    set_photo(&s, 400, 100);
    set_add(&s, set_disc(&s, 60, 50, 15), 25, 25, 0, 1);
    set_add(&s, set_disc(&s, 340, 50, 15), 75, 25, 0, 1);
    const tz_element_pixels p = {&photo, NULL, NULL};
    double ratio[3];
    for (int k = 0; k < 3; k++) {
        const tz_element_render_params prm = params(0, 0.5 * k);
        tz_element_renderer *r = renderer_of(ctx, &s, &p, TZ_MAP_COLOUR, &prm);
        tz_image im = over_nothing(ctx, r, (tz_rect){0, 0, 100, 50});
        ratio[k] =
            (double)tz_image_at(&im, 75, 25)[0] / (double)tz_image_at(&im, 25, 25)[0];
        tz_image_deinit(&im);
        tz_element_renderer_free(r);
    }
    assert_true(fabs(ratio[0] - 0.37 / 0.23) < 0.03);
    assert_true(ratio[1] < 0.85 * ratio[0] && ratio[2] < 1.12 && ratio[2] > 0.95);
    tz_element_set_deinit(&s);
    tz_image_deinit(&photo);
    tz_ctx_free(ctx);
}

/* ---- maps ---------------------------------------------------------------------------- */

/* A plane of normals leaning to +x turns with its element; numbers of a map of data keep
 * to their range; both lie where the colour lies, also at another size. */
static void test_maps(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_image photo = disc_photo(ctx, 1),
             normal = picture_plane(ctx, 2 * N, 2 * N, 0.6, 0, 0.8),
             height = blank(ctx, N / 2, N / 2, 1);
    height.encoding = TZ_ENCODING_DATA;
    for (int i = 0; i < N * N / 4; i++)
        height.px[i] = 7.5F;
    tz_element_set s;
    set_init(ctx, &s, 100, 100, false);
    set_photo(&s, N, N);
    set_disc(&s, CX, CY, R);
    set_symbol(&s, leaf, 10);
    set_add(&s, 0, 50.3, 49.8, TZ_PI / 2, 1.3);
    set_add(&s, 1, 10, 10, 0, 1); /* a drawing shows in the colour only */
    const tz_rect all = {0, 0, 100, 100};
    const tz_element_render_params prm = params(8, 0);
    tz_element_pixels p = {&photo, NULL, NULL};
    tz_element_renderer *r = renderer_of(ctx, &s, &p, TZ_MAP_COLOUR, &prm);
    tz_image colour = over_nothing(ctx, r, all);
    assert_true(tz_image_at(&colour, 10, 10)[3] > 0.9F);
    tz_element_renderer_free(r);

    p.map = &normal;
    r = renderer_of(ctx, &s, &p, TZ_MAP_NORMAL, &prm);
    tz_image n = over_nothing(ctx, r, all);
    tz_element_renderer_free(r);
    p.map = &height;
    r = renderer_of(ctx, &s, &p, TZ_MAP_DATA, &prm);
    assert_int_equal(tz_element_renderer_colours(r), 1);
    tz_image h = over_nothing(ctx, r, all);
    tz_element_renderer_free(r);
    assert_true(tz_image_at(&n, 10, 10)[3] == 0 && tz_image_at(&h, 10, 10)[1] == 0);
    for (int y = 25; y < 75; y++)
        for (int x = 25; x < 75; x++) {
            const float a = tz_image_at(&colour, x, y)[3];
            const float *v = tz_image_at(&n, x, y), *w = tz_image_at(&h, x, y);
            assert_true(fabsf(v[3] - a) < 0.2F && fabsf(w[1] - a) < 0.35F);
            if (v[3] > 0.01F) { /* a clockwise quarter on the screen: +x becomes down */
                assert_true(fabsf(v[0] - 0.5F) < 2e-3F);
                assert_true(fabsf(v[1] - 0.2F) < 2e-3F);
                assert_true(fabsf(v[2] - 0.9F) < 2e-3F);
            }
            if (w[1] > 0.01F)
                assert_true(fabsf(w[0] - 7.5F) < 1e-3F);
        }
    assert_true(fabs(sum_of(&n, 3) - TZ_PI * R * R * 1.69) < 0.02 * TZ_PI * R * R * 1.69);
    tz_image_deinit(&n);
    tz_image_deinit(&h);
    tz_image_deinit(&colour);
    tz_element_set_deinit(&s);
    tz_image_deinit(&height);
    tz_image_deinit(&normal);
    tz_image_deinit(&photo);
    tz_ctx_free(ctx);
}

/* Where a copy shows is where its source says. */
static void test_source_places(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_image photo = disc_photo(ctx, 1);
    tz_element_set s;
    set_init(ctx, &s, 100, 100, false);
    set_photo(&s, N, N);
    set_disc(&s, CX, CY, R);
    set_add(&s, 0, 52, 47, 0.4, 0.9);
    const tz_element_pixels p = {&photo, NULL, NULL};
    tz_element_renderer *r = renderer_of(ctx, &s, &p, TZ_MAP_COLOUR, NULL);
    tz_image uv = blank(ctx, 100, 100, 3), id = blank(ctx, 100, 100, 1);
    const tz_rect all = {0, 0, 100, 100};
    OK(tz_element_renderer_map(ctx, r, TZ_ELEMENT_MAP_UV, all, &uv));
    OK(tz_element_renderer_map(ctx, r, TZ_ELEMENT_MAP_ID, all, &id));
    int n = 0;
    for (int y = 0; y < 100; y++)
        for (int x = 0; x < 100; x++) {
            const float *q = tz_image_at(&uv, x, y);
            assert_true((q[2] == 1) == (*tz_image_at(&id, x, y) == 1));
            if (q[2] == 0)
                continue;
            const double dx = x + 0.5 - 52, dy = y + 0.5 - 47, c = cos(0.4) / 0.9,
                         d = sin(0.4) / 0.9;
            assert_true(fabs(q[0] * N - (CX + c * dx + d * dy)) < 1e-3);
            assert_true(fabs(q[1] * N - (CY - d * dx + c * dy)) < 1e-3);
            n++;
        }
    assert_true(fabs(n - TZ_PI * R * R * 0.81) < 40);
    tz_image_deinit(&uv);
    tz_image_deinit(&id);
    tz_element_renderer_free(r);
    tz_element_set_deinit(&s);
    tz_image_deinit(&photo);
    tz_ctx_free(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_no_trace_of_the_old_ground),
        cmocka_unit_test(test_alpha_is_monotone),
        cmocka_unit_test(test_shadows_stay),
        cmocka_unit_test(test_identity),
        cmocka_unit_test(test_crops_threads_torus),
        cmocka_unit_test(test_light_is_evened),
        cmocka_unit_test(test_maps),
        cmocka_unit_test(test_source_places),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
