/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Things found in scenes whose things are known. The floors stand well above what
 * OpenCV's tutorial watershed reaches on the same scenes (F of 0.1, and of at most 0.5
 * with the best threshold told for each scene: bench_things), and below what is reached,
 * so that a change that breaks the search fails. */
#include "tests/base/check.h"

#include "analysis/things.h"
#include "tests/support/things_truth.h"

enum { SIDE = 256 };

static double f_of(tz_ctx *ctx, tz_scene_kind kind, tz_scene_camera camera, uint64_t seed)
{
    tz_scene scene;
    tz_things_params p;
    tz_element_set s;
    truth_counts c;
    int32_t *label;
    ok(ctx, tz_scene_render(ctx, kind, camera, SIDE, SIDE, seed, &scene));
    tz_params_default(&tz_things_param_table, &p);
    ok(ctx, tz_alloc(ctx, &label, SIDE * SIDE, sizeof *label));
    ok(ctx, tz_things_find(ctx, &scene.photo, &p, &s, NULL, label));
    ok(ctx, truth_count(ctx, &scene, label, s.element.n, &c));
    assert_true(c.things > 0);
    tz_element_set_deinit(&s);
    tz_free(ctx, label);
    tz_scene_deinit(&scene);
    return 2.0 * c.pairs / (c.found + c.things);
}

static void things_are_found(void **state)
{
    (void)state;
    static const struct {
        tz_scene_kind kind;
        double floor;
    } kinds[] = {{TZ_SCENE_BRICKS, 0.6},
                 {TZ_SCENE_STONES, 0.4},
                 {TZ_SCENE_SCALES, 0.6},
                 {TZ_SCENE_MOSAIC, 0.6}};
    tz_ctx *ctx = new_ctx(0);
    double all = 0;
    for (int k = 0; k < 4; k++) {
        double f = 0;
        for (uint64_t seed = 0; seed < 3; seed++)
            f += f_of(ctx, kinds[k].kind, TZ_SCENE_CLEAN, 1000000 + seed) / 3;
        if (f < kinds[k].floor)
            fail_msg("%s: F of %.3f", tz_scene_kind_name(kinds[k].kind), f);
        all += f / 4;
    }
    assert_true(all > 0.8);
    end_ctx(ctx);
}

/* What a scene has, counted against itself: all is found; shifted labels find less. */
static void counts_are_right(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(0);
    tz_scene scene;
    truth_counts c;
    int32_t *label;
    ok(ctx, tz_scene_render(ctx, TZ_SCENE_BRICKS, TZ_SCENE_CLEAN, SIDE, SIDE, 1000000,
                            &scene));
    ok(ctx, tz_alloc(ctx, &label, SIDE * SIDE, sizeof *label));
    for (int32_t p = 0; p < SIDE * SIDE; p++)
        label[p] = scene.piece[scene.segment[p]].element ? scene.segment[p] : -1;
    ok(ctx, truth_count(ctx, &scene, label, scene.pieces, &c));
    assert_true(c.things > 0 && c.pairs == c.things && c.found == c.things);
    assert_true(c.iou > c.pairs - 1e-9);
    for (int32_t p = 0; p < SIDE * SIDE; p++)
        label[p] = 0;
    ok(ctx, truth_count(ctx, &scene, label, 1, &c));
    assert_true(c.pairs == 0 && c.found == 1);
    for (int32_t p = 0; p < SIDE * SIDE; p++)
        label[p] = -1;
    ok(ctx, truth_count(ctx, &scene, label, 0, &c));
    assert_true(c.pairs == 0 && c.found == 0 && c.things > 0);
    tz_free(ctx, label);
    tz_scene_deinit(&scene);
    end_ctx(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(counts_are_right),
        cmocka_unit_test(things_are_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
