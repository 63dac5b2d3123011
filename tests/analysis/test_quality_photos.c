/* SPDX-License-Identifier: Apache-2.0 */
/* Calibration of the quality measures on real photos: one half against the other scores
 * high and has no seam, no repeat and no broken lines to speak of; each way to spoil it
 * costs under its own name. */
#include "tests/analysis/quality_pictures.h"

#include "base/image_io.h"

typedef struct photo {
    const char *name;
    double least; /* score of the right half, the left being the exemplar */
} photo;

/* Lower where the two halves show different things (light, knots, depth of field). */
static const photo photos[] = {
    {"bark_brown.jpg", 85},           {"bark_lichen.jpg", 90},
    {"brick_gray.png", 80},           {"cliff_strata.jpg", 85},
    {"cobblestone_pavement.jpg", 90}, {"cracked_rock.jpg", 90},
    {"gravel_gray.png", 85},          {"leaf_litter.jpg", 90},
    {"moss_ground.jpg", 90},          {"mossy_rock_slabs.jpg", 85},
    {"onyx_swirl.jpg", 70},           {"pebbles_large.jpg", 85},
    {"stone_wall.jpg", 85},           {"veined_slate.jpg", 90},
    {"volcanic_stone_cells.jpg", 90},
};
enum { PHOTOS = sizeof photos / sizeof *photos };

static tz_image load(tz_ctx *ctx, const char *name)
{
    char path[512];
    tz_image im;
    const tz_image_read_options opt = {.want = TZ_ENCODING_SRGB};
    snprintf(path, sizeof path, "%s%s", PHOTO(""), name);
    ok(ctx, tz_image_read(ctx, path, &opt, &im));
    return im;
}

static void the_other_half_scores_high(void **state)
{
    (void)state;
    need_photos();
    for (int i = 0; i < PHOTOS; i++) {
        tz_ctx *ctx = new_ctx(0);
        tz_image im = load(ctx, photos[i].name);
        int32_t w = im.width / 2, h = im.height;
        tz_image e = part(ctx, &im, 0, 0, w, h), o = part(ctx, &im, w, 0, w, h);
        tz_quality q = measure(ctx, &e, &o);
        print_message("         %-26s %5.1f\n", photos[i].name, q.score);
        assert_true(q.score >= photos[i].least);
        assert_true(q.seam < 1e-3);
        assert_true(q.repetition < 0.04); /* some photos have been retouched by copying */
        assert_true(q.periodicity < 0.05);
        assert_true(q.broken < 1.5);
        tz_image_deinit(&im);
        tz_image_deinit(&e);
        tz_image_deinit(&o);
        end_ctx(ctx);
    }
}

static void spoilt_photos_score_low(void **state)
{
    (void)state;
    need_photos();
    for (int i = 0; i < PHOTOS; i += 2) {
        tz_ctx *ctx = new_ctx(0);
        tz_image all = load(ctx, photos[i].name);
        int32_t w = all.width < 512 ? all.width : 512;
        int32_t h = all.height < 512 ? all.height : 512;
        tz_image im = part(ctx, &all, 0, 0, w, h);
        tz_image tile = tiled(ctx, &im, 2), block = shuffled(ctx, &im, 64);
        tz_image noise = phase_noise(ctx, &im);
        tz_quality t = measure(ctx, &im, &tile), b = measure(ctx, &im, &block);
        tz_quality n = measure(ctx, &im, &noise);
        double last = measure(ctx, &im, &im).score;
        print_message("         %-26s tile %.1f, blocks %.1f, noise %.1f, itself %.1f\n",
                      photos[i].name, t.score, b.score, n.score, last);
        assert_true(t.repetition > 0.9 && t.periodicity > 0.5 && t.score < 60);
        assert_true(b.cost_seam + b.cost_broken > 5 && b.score < 95);
        assert_true(n.score < 97);
        for (double sigma = 0.5; sigma <= 2; sigma *= 2) {
            tz_image blur = blurred(ctx, &im, sigma);
            tz_quality q = measure(ctx, &im, &blur);
            assert_true(q.score < last);
            assert_true(sigma < 1 || (q.cost_sharpness > 8 && q.score < 90));
            last = q.score;
            tz_image_deinit(&blur);
        }
        tz_image_deinit(&all);
        tz_image_deinit(&im);
        tz_image_deinit(&tile);
        tz_image_deinit(&block);
        tz_image_deinit(&noise);
        end_ctx(ctx);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_other_half_scores_high),
        cmocka_unit_test(spoilt_photos_score_low),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
