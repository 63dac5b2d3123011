/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What may be copied, what lies beneath, and whether a photo is made of things. */
#include "tests/base/check.h"

#include <math.h>

#include "analysis/things.h"
#include "analysis/things_even.h"
#include "analysis/things_ground.h"
#include "base/rng.h"
#include "scenes/scene.h"

enum { SIDE = 320 };

typedef struct result {
    tz_image photo, plate;
    tz_element_set set;
    tz_things_verdict verdict;
} result;

static const float ground[3] = {0.62F, 0.6F, 0.55F};

/* Discs in rows on grainy ground; of every third a bite is taken, which another disc of
 * another colour fills; two specks are of nearly the ground's colour. */
static tz_image draw(tz_ctx *ctx)
{
    tz_image im;
    ok(ctx, tz_image_init(ctx, &im, SIDE, SIDE, 3));
    im.encoding = TZ_ENCODING_SRGB;
    for (int32_t y = 0; y < SIDE; y++) {
        tz_rng g = tz_rng_make(3, (uint64_t)y);
        for (int32_t x = 0; x < SIDE; x++) {
            const int32_t cx = x / 53, cy = y / 53, i = cy * 6 + cx;
            const double dx = x - 53 * cx - 26.5, dy = y - 53 * cy - 26.5;
            const bool bitten = i % 3 == 0;
            float rgb[3] = {ground[0], ground[1], ground[2]};
            if (hypot(dx, dy) < 19 && cx < 6 && cy < 6) {
                rgb[0] = 0.3F, rgb[1] = 0.2F, rgb[2] = 0.15F;
            }
            if (bitten && hypot(dx - 14, dy - 6) < 13 && cx < 6 && cy < 6) {
                rgb[0] = 0.2F, rgb[1] = 0.4F, rgb[2] = 0.25F;
            }
            for (int c = 0; c < 3; c++)
                tz_image_at(&im, x, y)[c] = rgb[c] + (float)(0.012 * tz_rng_normal(&g));
        }
    }
    return im;
}

static result find(tz_ctx *ctx, tz_image photo, int32_t plate)
{
    result r = {.photo = photo};
    tz_things_params p;
    tz_params_default(&tz_things_param_table, &p);
    p.plate = plate;
    ok(ctx, tz_things_judge(ctx, &r.photo, &p, &r.set, &r.plate, NULL, &r.verdict));
    return r;
}

static void drop(result *r)
{
    tz_element_set_deinit(&r->set);
    tz_image_deinit(&r->photo);
    tz_image_deinit(&r->plate);
}

static const tz_element *at(const tz_element_set *s, double x, double y)
{
    const tz_element *best = NULL;
    for (int32_t i = 0; i < s->element.n; i++) {
        const tz_element *e = &s->element.v[i];
        if (!best ||
            hypot(e->at.x - x, e->at.y - y) < hypot(best->at.x - x, best->at.y - y))
            best = e;
    }
    return best;
}

/* Of bitten discs hardly any may be copied, whole ones must be. */
static void covered_things_are_not_copied(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    result r = find(ctx, draw(ctx), TZ_THINGS_PLATE_AUTO);
    int32_t whole = 0, bitten = 0, copied = 0;
    for (int32_t i = 0; i < r.set.element.n; i++)
        copied += tz_element_may_copy(&r.set.element.v[i]);
    assert_int_equal(copied, r.verdict.copied);
    for (int32_t i = 0; i < 36; i++) {
        const double x = 53 * (i % 6) + 26.5, y = 53 * (i / 6) + 26.5;
        const tz_element *e = i % 3 ? at(&r.set, x, y) : at(&r.set, x - 5, y - 2);
        assert_non_null(e);
        if (i % 3)
            whole += tz_element_may_copy(e);
        else
            bitten += tz_element_may_copy(e);
    }
    if (whole < 22 || bitten > 2)
        fail_msg("%d of 24 whole ones and %d of 12 covered ones are copied", whole,
                 bitten);
    drop(&r);
    end_ctx(ctx);
}

static void the_plate_is_as_asked(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    result r = find(ctx, draw(ctx), TZ_THINGS_PLATE_PHOTO);
    assert_memory_equal(r.plate.px, r.photo.px, SIDE * SIDE * 3 * sizeof(float));
    drop(&r);
    static const int32_t other[] = {TZ_THINGS_PLATE_GROUND, TZ_THINGS_PLATE_AUTO};
    for (int k = 0; k < 2; k++) {
        r = find(ctx, draw(ctx), other[k]);
        for (int64_t p = 0; p < SIDE * SIDE * 3; p++)
            if (fabsf(r.plate.px[p] - ground[p % 3]) > 0.08F)
                fail_msg("channel %d of pixel %d is %.3f", (int)(p % 3), (int)(p / 3),
                         r.plate.px[p]);
        drop(&r);
    }
    end_ctx(ctx);
}

/* ---- kinds ---------------------------------------------------------------------------- */

/* Discs of one colour: of two sizes they are two kinds, of sizes between them one. */
static void heaps_of_sizes_are_kinds(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    for (int heaps = 0; heaps < 2; heaps++) {
        tz_image im;
        ok(ctx, tz_image_init(ctx, &im, SIDE, SIDE, 1));
        im.encoding = TZ_ENCODING_SRGB;
        for (int32_t y = 0; y < SIDE; y++) {
            tz_rng g = tz_rng_make(4, (uint64_t)y);
            for (int32_t x = 0; x < SIDE; x++) {
                const int32_t cx = x / 53, cy = y / 53, i = cy * 6 + cx;
                const double far = hypot(x - 53 * cx - 26.5, y - 53 * cy - 26.5);
                const double r = heaps ? (i % 2 ? 20 : 13) : 13 + 7 * (i * 7 % 36) / 35.0;
                *tz_image_at(&im, x, y) = (cx < 6 && cy < 6 && far < r ? 0.75F : 0.25F) +
                                          (float)(0.012 * tz_rng_normal(&g));
            }
        }
        result r = find(ctx, im, TZ_THINGS_PLATE_PHOTO);
        const tz_element *small = at(&r.set, 26.5, 26.5), *large = at(&r.set, 79.5, 26.5);
        if (heaps) {
            assert_true(r.set.kind.n >= 2 && r.set.kind.n <= 4);
            assert_true(small->kind != large->kind);
        } else {
            for (int32_t i = 0; i < 36; i++)
                assert_int_equal(
                    at(&r.set, 53 * (i % 6) + 26.5, 53 * (i / 6) + 26.5)->kind,
                    small->kind);
        }
        drop(&r);
    }
    end_ctx(ctx);
}

/* ---- ground -------------------------------------------------------------------------- */

/* Narrow joints of one colour, and a wide patch of another that no label covers. */
static void missed_things_are_no_ground(void **state)
{
    (void)state;
    enum { W = 120, H = 90 };
    tz_ctx *ctx = new_ctx(1);
    tz_image im;
    static int32_t label[W * H];
    static uint8_t doubtful[W * H];
    tz_things_ground g;
    int32_t sure = 0;
    ok(ctx, tz_image_init(ctx, &im, W, H, 3));
    im.encoding = TZ_ENCODING_SRGB;
    for (int32_t p = 0; p < W * H; p++) {
        const int32_t x = p % W, y = p / W, i = y / 30 * 4 + x / 30;
        const bool joint = x % 30 >= 22 || y % 30 >= 22, missed = !joint && i == 5;
        label[p] = joint || missed ? -1 : i;
        im.px[3 * p] = joint ? 0.7F : 0.4F;
        im.px[3 * p + 1] = joint ? 0.7F : 0.25F;
        im.px[3 * p + 2] = joint ? 0.65F : 0.2F;
    }
    ok(ctx, tz_things_ground_find(ctx, &im, label, 12, doubtful, &g));
    for (int32_t p = 0; p < W * H; p++) {
        sure += g.sure[p];
        assert_true(!g.sure[p] || im.px[3 * p] > 0.5F);
    }
    assert_true(sure > W * H / 10);
    assert_true(fabs(g.middle[0] - 2.05 / 3) < 0.01 && g.clear > 0.9);
    tz_things_ground_deinit(ctx, &g);
    tz_image_deinit(&im);
    end_ctx(ctx);
}

/* Even noise stays to the bit; a slope of light is taken away but for a tenth or so. */
static void slopes_are_evened(void **state)
{
    (void)state;
    enum { W = 160, H = 120 };
    tz_ctx *ctx = new_ctx(1);
    static float v[W * H * 3], old[W * H * 3];
    static uint8_t known[W * H];
    for (int slope = 0; slope < 2; slope++) {
        double ends[2] = {0};
        for (int32_t p = 0; p < W * H; p++) {
            tz_rng g = tz_rng_make(9, (uint64_t)p);
            known[p] = (uint8_t)(p % W % 4 != 1);
            for (int c = 0; c < 3; c++)
                v[3 * p + c] = old[3 * p + c] = 0.5F + (float)(0.01 * tz_rng_normal(&g)) +
                                                (float)(slope * 0.3 * (p % W - 80) / W);
        }
        ok(ctx, tz_things_even(ctx, v, known, W, H, 16));
        for (int32_t p = 0; p < W * H; p++) {
            if (!slope || !known[p])
                assert_memory_equal(v + 3 * p, old + 3 * p, 3 * sizeof *v);
            else if (p % W < 20 || p % W >= W - 20)
                ends[p % W >= 20] += v[3 * p] / (H * 15.0);
        }
        assert_true(fabs(ends[0] - ends[1]) < 0.08); /* was 0.26 */
    }
    end_ctx(ctx);
}

/* ---- verdict ------------------------------------------------------------------------- */

static void pictures_of_things_are_told(void **state)
{
    (void)state;
    static const struct {
        tz_scene_kind kind;
        bool things;
    } kinds[] = {{TZ_SCENE_BRICKS, true}, {TZ_SCENE_MOSAIC, true},
                 {TZ_SCENE_SCALES, true}, {TZ_SCENE_GROUND, false},
                 {TZ_SCENE_WOOD, false},  {TZ_SCENE_VEINS, false}};
    enum { KINDS = sizeof kinds / sizeof *kinds, SEEDS = 4 };
    tz_ctx *ctx = new_ctx(0);
    int32_t right = 0;
    for (int k = 0; k < KINDS; k++)
        for (uint64_t seed = 0; seed < SEEDS; seed++) {
            tz_scene scene;
            ok(ctx, tz_scene_render(ctx, kinds[k].kind, TZ_SCENE_CLEAN, 256, 256,
                                    1000000 + seed, &scene));
            tz_image copy;
            ok(ctx, tz_image_copy(ctx, &scene.photo, &copy));
            result r = find(ctx, copy, TZ_THINGS_PLATE_PHOTO);
            right += r.verdict.is_things == kinds[k].things;
            if (r.verdict.is_things != kinds[k].things)
                print_message("%s %d: %s\n", tz_scene_kind_name(kinds[k].kind), (int)seed,
                              r.verdict.why);
            assert_true(r.verdict.why[0] && r.verdict.things == r.set.element.n);
            assert_true(r.verdict.covered >= 0 && r.verdict.covered <= 1);
            drop(&r);
            tz_scene_deinit(&scene);
        }
    print_message("%d of %d verdicts are right\n", right, KINDS * SEEDS);
    assert_true(4 * right >= 3 * KINDS * SEEDS);
    end_ctx(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(covered_things_are_not_copied),
        cmocka_unit_test(the_plate_is_as_asked),
        cmocka_unit_test(heaps_of_sizes_are_kinds),
        cmocka_unit_test(missed_things_are_no_ground),
        cmocka_unit_test(slopes_are_evened),
        cmocka_unit_test(pictures_of_things_are_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
