/* SPDX-License-Identifier: Apache-2.0 */
/* Quality measures on drawn pictures: each fault costs under its own name, bad input is
 * refused or measured without NaN, and threads do not change a bit. */
#include "tests/analysis/quality_pictures.h"

static void all_finite(const tz_quality *q)
{
    const double v[] = {q->patch,           q->orientation,
                        q->correlation,     q->sharpness,
                        q->sharpness_range, q->repetition,
                        q->periodicity,     q->seam,
                        q->broken,          q->score,
                        q->cost_patch,      q->cost_structure,
                        q->cost_seam,       q->cost_broken,
                        q->cost_sharpness,  q->cost_wrap,
                        q->cost_repetition, q->cost_periodicity,
                        q->repetition_near};
    for (size_t i = 0; i < sizeof v / sizeof *v; i++)
        assert_true(isfinite(v[i]));
    assert_true(q->score >= 0 && q->score <= 100);
}

static void another_crop_is_good(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(0);
    tz_image e = stones(ctx, 0, 0, 384, 384), o = stones(ctx, 3000, 700, 768, 640);
    tz_quality q = measure(ctx, &e, &o);
    all_finite(&q);
    assert_true(q.score >= 92);
    assert_true(q.patch < 1.3 && q.repetition < 0.01 && q.seam < 1e-3);
    assert_true(isnan(q.wrap));
    tz_image_deinit(&e);
    tz_image_deinit(&o);
    end_ctx(ctx);
}

static void faults_cost_under_their_names(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(0);
    tz_image e = stones(ctx, 0, 0, 448, 448), big = stones(ctx, 5000, 100, 448, 448);
    tz_image tile = tiled(ctx, &e, 2), block = shuffled(ctx, &big, 64);
    tz_image patch = polygons(ctx, &big, 110), noise = phase_noise(ctx, &big);
    tz_quality q = measure(ctx, &e, &tile);
    assert_true(q.repetition > 0.95 && q.periodicity > 0.8 && q.score < 60);
    q = measure(ctx, &e, &block);
    assert_true(q.cost_seam > 5 && q.score < 92);
    q = measure(ctx, &e, &patch);
    assert_true(q.cost_seam > 3);
    q = measure(ctx, &e, &noise);
    assert_true(q.cost_patch + q.cost_structure > 5 && q.score < 92);
    tz_image_deinit(&e);
    tz_image_deinit(&big);
    tz_image_deinit(&tile);
    tz_image_deinit(&block);
    tz_image_deinit(&patch);
    tz_image_deinit(&noise);
    end_ctx(ctx);
}

static void more_blur_scores_less(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(0);
    tz_image e = stones(ctx, 0, 0, 320, 320), o = stones(ctx, 4000, 0, 320, 320);
    double last = measure(ctx, &e, &o).score;
    for (double sigma = 0.5; sigma <= 4; sigma *= 2) {
        tz_image b = blurred(ctx, &o, sigma);
        tz_quality q = measure(ctx, &e, &b);
        assert_true(q.score < last);
        assert_true(sigma < 1 || q.cost_sharpness > 10);
        last = q.score;
        tz_image_deinit(&b);
    }
    tz_image_deinit(&e);
    tz_image_deinit(&o);
    end_ctx(ctx);
}

/* One disc of 160 px, copied at an odd offset, brightened and rounded to 8 bit. */
static void a_copy_is_found_at_any_offset(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(0);
    tz_image e = stones(ctx, 0, 0, 256, 256), o = stones(ctx, 6000, 0, 640, 640);
    double before = measure(ctx, &e, &o).repetition;
    for (int32_t y = -80; y < 80; y++)
        for (int32_t x = -80; x < 80; x++)
            if (x * x + y * y < 80 * 80)
                for (int c = 0; c < 3; c++) {
                    float v = tz_image_at(&o, 150 + x, 130 + y)[c] + 0.05f;
                    tz_image_at(&o, 437 + x, 463 + y)[c] = rintf(255 * v) / 255;
                }
    tz_quality_params p = quality_params();
    tz_quality q;
    tz_image heat;
    ok(ctx, tz_quality_measure(ctx, &e, &o, &p, &q, &heat));
    /* patches wholly inside: places of their corners, a disc of about 80 - 34 px, twice */
    double expected = 2 * TZ_PI * 46 * 46 / (592.0 * 592.0);
    assert_true(q.repetition - before > 0.8 * expected);
    assert_true(q.repetition - before < 2.5 * expected);
    assert_int_equal(heat.width, 640);
    assert_true(*tz_image_at(&heat, 437, 463) >= 0.75f);
    assert_true(*tz_image_at(&heat, 150, 130) >= 0.75f);
    assert_true(*tz_image_at(&heat, 500, 100) < 0.75f);
    tz_image_deinit(&heat);
    tz_image_deinit(&e);
    tz_image_deinit(&o);
    end_ctx(ctx);
}

static void a_tile_is_measured_across_its_wrap(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(0);
    tz_quality_params p = quality_params();
    p.tile = true;
    tz_image cut = stones(ctx, 0, 0, 256, 256), wrapped = tiled(ctx, &cut, 1);
    /* mirrored halves meet across the border without a step */
    for (int32_t y = 0; y < 256; y++)
        for (int32_t x = 0; x < 256; x++)
            copy_pixel(&cut, x < 128 ? x : 255 - x, y < 128 ? y : 255 - y, &wrapped, x,
                       y);
    tz_quality bad, good;
    ok(ctx, tz_quality_measure(ctx, &cut, &cut, &p, &bad, NULL));
    ok(ctx, tz_quality_measure(ctx, &cut, &wrapped, &p, &good, NULL));
    assert_true(bad.wrap > 1.8 && bad.cost_wrap > 5);
    assert_true(good.wrap < 1.3 && good.cost_wrap < 2);
    tz_image_deinit(&cut);
    tz_image_deinit(&wrapped);
    end_ctx(ctx);
}

static void uniform_pictures_are_equal(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(0);
    tz_image a = new_picture(ctx, 128, 96, 3), b = new_picture(ctx, 200, 128, 3);
    tz_image n = new_picture(ctx, 128, 128, 3);
    draw_noise(&n, 1);
    tz_quality q = measure(ctx, &a, &b);
    all_finite(&q);
    assert_true(q.patch == 1 && q.orientation == 1 && q.correlation == 1);
    assert_true(q.score == 100 && q.repetition == 0 && q.seam == 0 && q.broken == 1);
    q = measure(ctx, &a, &n);
    all_finite(&q);
    assert_true(q.score < 50);
    q = measure(ctx, &n, &a);
    all_finite(&q);
    assert_true(q.score < 70 && q.repetition == 0);
    tz_image_deinit(&a);
    tz_image_deinit(&b);
    tz_image_deinit(&n);
    end_ctx(ctx);
}

static void odd_input_is_measured_or_refused(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(0);
    tz_quality_params p = quality_params();
    tz_quality q;
    tz_image small = new_picture(ctx, 15, 40, 3), five = new_picture(ctx, 40, 40, 5);
    tz_image e = stones(ctx, 0, 0, 96, 96), grey = new_picture(ctx, 64, 64, 1);
    fails(ctx, tz_quality_measure(ctx, &small, &e, &p, &q, NULL), TZ_INVALID, "15 x 40");
    fails(ctx, tz_quality_measure(ctx, &e, &small, &p, &q, NULL), TZ_INVALID, "output");
    fails(ctx, tz_quality_measure(ctx, &e, &five, &p, &q, NULL), TZ_INVALID,
          "5 channels");
    q = measure(ctx, &e, &grey);
    all_finite(&q);
    q = measure(ctx, &grey, &e);
    all_finite(&q);
    for (int32_t side = 16; side <= 64; side += 7) {
        tz_image a = part(ctx, &e, 0, 0, side, 96 - side),
                 b = part(ctx, &e, 0, 0, 16, side);
        q = measure(ctx, &a, &b);
        all_finite(&q);
        q = measure(ctx, &b, &e);
        all_finite(&q);
        tz_image_deinit(&a);
        tz_image_deinit(&b);
    }
    tz_image_at(&e, 5, 5)[0] = NAN;
    tz_image_at(&e, 50, 50)[1] = INFINITY;
    tz_image_at(&e, 60, 50)[2] = -1e30f;
    e.encoding = TZ_ENCODING_LINEAR;
    q = measure(ctx, &e, &e);
    all_finite(&q);
    tz_image_deinit(&small);
    tz_image_deinit(&five);
    tz_image_deinit(&e);
    tz_image_deinit(&grey);
    end_ctx(ctx);
}

static void threads_change_nothing(void **state)
{
    (void)state;
    tz_quality q[3];
    float *first = NULL;
    const int threads[3] = {1, 2, 7};
    for (int k = 0; k < 3; k++) {
        tz_ctx *ctx = new_ctx(threads[k]);
        tz_image e = stones(ctx, 0, 0, 200, 180), b = stones(ctx, 900, 0, 300, 260), heat;
        tz_image o = polygons(ctx, &b, 80);
        tz_quality_params p = quality_params();
        p.tile = true;
        memset(&q[k], 0, sizeof q[k]);
        ok(ctx, tz_quality_measure(ctx, &e, &o, &p, &q[k], &heat));
        assert_memory_equal(&q[0], &q[k], sizeof q[0]);
        size_t size = 300 * 260 * sizeof(float);
        if (!first) {
            first = malloc(size);
            memcpy(first, heat.px, size);
        }
        assert_memory_equal(first, heat.px, size);
        tz_image_deinit(&heat);
        tz_image_deinit(&e);
        tz_image_deinit(&b);
        tz_image_deinit(&o);
        end_ctx(ctx);
    }
    free(first);
}

/* A huge output is measured on crops: in the memory of a small one, the same each time. */
static void huge_outputs_are_cropped(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(0);
    tz_image e = stones(ctx, 0, 0, 128, 128), o = new_picture(ctx, 40000, 200, 1), heat;
    tz_quality_params p = quality_params();
    draw_noise(&o, 3);
    size_t before = tz_ctx_memory_used(ctx);
    tz_quality a = measure(ctx, &e, &o), b = measure(ctx, &e, &o);
    all_finite(&a);
    assert_true(a.score == b.score && a.patch == b.patch);
    assert_true(a.repetition < 0.01); /* crops that overlap are not copies */
    assert_true(tz_ctx_memory_peak(ctx) - before < (size_t)400 << 20);
    fails(ctx, tz_quality_measure(ctx, &e, &o, &p, &a, &heat), TZ_LIMIT, "heat map");
    tz_image_deinit(&e);
    tz_image_deinit(&o);
    end_ctx(ctx);
}

static tz_status measure_small(tz_ctx *ctx)
{
    tz_image e = {0}, heat = {0};
    tz_quality_params p = quality_params();
    tz_quality q;
    p.patches = 16;
    p.projections = 1;
    p.tile = true;
    tz_status s = tz_image_init(ctx, &e, 66, 64, 3);
    if (s == TZ_OK) {
        draw_noise(&e, 1);
        s = tz_quality_measure(ctx, &e, &e, &p, &q, &heat);
    }
    tz_image_deinit(&e);
    tz_image_deinit(&heat);
    return s;
}

static void survives_failing_allocations(void **state)
{
    (void)state;
    survive(measure_small, 1);
    survive(measure_small, 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(another_crop_is_good),
        cmocka_unit_test(faults_cost_under_their_names),
        cmocka_unit_test(more_blur_scores_less),
        cmocka_unit_test(a_copy_is_found_at_any_offset),
        cmocka_unit_test(a_tile_is_measured_across_its_wrap),
        cmocka_unit_test(uniform_pictures_are_equal),
        cmocka_unit_test(odd_input_is_measured_or_refused),
        cmocka_unit_test(threads_change_nothing),
        cmocka_unit_test(huge_outputs_are_cropped),
        cmocka_unit_test(survives_failing_allocations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
