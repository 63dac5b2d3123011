/* SPDX-License-Identifier: Apache-2.0 */
/* The trainer: the same forest at any thread count, nothing left behind when it stops, and
 * a tiny forest that already beats the gradient detector on scenes that it has not seen. */
#include "tests/analysis/draw.h"

#include "analysis/boundary_score.h"
#include "analysis/forest.h"
#include "analysis/forest_train.h"
#include "analysis/tensor.h"
#include "base/file.h"
#include "scenes/scene.h"

static char dir[64];

static tz_forest_train_params params(int32_t trees, int32_t scenes, int32_t patches,
                                     int32_t side)
{
    tz_forest_train_params p;
    memset(&p, 0, sizeof p);
    tz_params_default(&tz_forest_train_param_table, &p);
    p.trees = trees;
    p.scenes = scenes;
    p.patches = patches;
    p.side = side;
    return p;
}

static void same_at_any_thread_count(void **state)
{
    (void)state;
    const tz_forest_train_params p = params(2, TZ_SCENE_COUNT, 60, 96);
    char path[160], hex[3][65], other[65];
    snprintf(path, sizeof path, "%s/model.yml.gz", dir);
    for (int i = 0; i < 3; i++) {
        tz_ctx *ctx = new_ctx(i == 0 ? 1 : i == 1 ? 2 : 8);
        tz_forest f;
        ok(ctx, tz_forest_train(ctx, &p, &f));
        ok(ctx, tz_forest_write(ctx, path, &f));
        ok(ctx, tz_file_sha256(ctx, path, hex[i]));
        tz_forest_deinit(&f);
        if (i == 0) {
            tz_forest_train_params q = p;
            q.seed++;
            ok(ctx, tz_forest_train(ctx, &q, &f));
            ok(ctx, tz_forest_write(ctx, path, &f));
            ok(ctx, tz_file_sha256(ctx, path, other));
            tz_forest_deinit(&f);
        }
        end_ctx(ctx);
    }
    assert_string_equal(hex[0], hex[1]);
    assert_string_equal(hex[0], hex[2]);
    assert_string_not_equal(hex[0], other);
}

static tz_status tiny(tz_ctx *ctx)
{
    const tz_forest_train_params p = params(1, 1, 40, 64);
    tz_forest f;
    const tz_status s = tz_forest_train(ctx, &p, &f);
    tz_forest_deinit(&f);
    return s;
}

static void memory_may_fail(void **state)
{
    (void)state;
    survive(tiny, 1);
    survive(tiny, 2);
}

static void can_be_cancelled(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_ctx_cancel(ctx);
    assert_int_equal(tiny(ctx), TZ_CANCELLED);
    end_ctx(ctx);
}

static void budget_is_a_time(void **state)
{
    static const char *const bad[] = {"", "m", "-3m", "0", "3x", "3 m", "3mm", "1e9h"};
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_forest f;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        tz_forest_train_params p = params(1, 0, 16, 64);
        snprintf(p.budget, sizeof p.budget, "%s", bad[i]);
        fails(ctx, tz_forest_train(ctx, &p, &f), TZ_INVALID, "--budget");
        assert_null(f.child);
    }
    end_ctx(ctx);
}

/* Every child stands behind its parent, every leaf has its bins. */
static void trees_are_sound(void **state)
{
    (void)state;
    const tz_forest_train_params p = params(3, TZ_SCENE_COUNT, 100, 96);
    tz_ctx *ctx = new_ctx(2);
    tz_forest f;
    int32_t marked = 0;
    ok(ctx, tz_forest_train(ctx, &p, &f));
    for (int32_t i = 0; i < f.trees * f.nodes; i++) {
        const int32_t at = i % f.nodes, bins = f.bound[i + 1] - f.bound[i];
        assert_in_range(f.feature[i], 0, TZ_FOREST_FEATURES - 1);
        assert_true(bins >= 0 && bins < 256);
        if (f.child[i]) {
            assert_true(f.child[i] - 1 > at && f.child[i] < f.nodes && bins == 0);
            assert_true(isfinite(f.threshold[i]));
        }
        marked += bins > 0;
    }
    assert_true(f.nodes > 20 && marked > 20);
    tz_forest_deinit(&f);
    end_ctx(ctx);
}

/* ---- held-out scenes --------------------------------------------------------------- */

enum { SIDE = 192 };

static void forest_strength(tz_ctx *ctx, const tz_image *photo, const tz_forest *f,
                            float *strength)
{
    static float r[SIDE * SIDE], normal[2 * SIDE * SIDE];
    ok(ctx, tz_forest_response(ctx, photo, f, r, normal));
    ok(ctx, tz_boundary_thin(ctx, r, SIDE, SIDE, strength));
}

static void gradient_strength(tz_ctx *ctx, const tz_image *photo, float *strength)
{
    static const double fine[TZ_TENSOR_LEVELS] = {0.35, 0.5, 0.35};
    static float r[SIDE * SIDE];
    tz_tensor t;
    ok(ctx, tz_tensor_init(ctx, photo, &t));
    ok(ctx, tz_tensor_response(&t, fine, r, NULL));
    tz_tensor_deinit(&t);
    for (int32_t i = 0; i < SIDE * SIDE; i++)
        r[i] = fminf(r[i] / 40, 1);
    ok(ctx, tz_boundary_thin(ctx, r, SIDE, SIDE, strength));
}

static void tiny_forest_beats_the_gradient(void **state)
{
    (void)state;
    tz_forest_train_params p = params(4, 2 * TZ_SCENE_COUNT, 600, SIDE);
    static float strength[SIDE * SIDE];
    static tz_boundary_counts counts[2][TZ_SCENE_COUNT];
    tz_ctx *ctx = new_ctx(0);
    tz_forest f;
    ok(ctx, tz_forest_train(ctx, &p, &f));
    for (int32_t k = 0; k < TZ_SCENE_COUNT; k++) {
        tz_scene scene;
        ok(ctx, tz_scene_render(ctx, (tz_scene_kind)k, TZ_SCENE_WILD, SIDE, SIDE,
                                (uint64_t)(TZ_FOREST_HELD_OUT + k), &scene));
        forest_strength(ctx, &scene.photo, &f, strength);
        ok(ctx, tz_boundary_match(ctx, strength, scene.boundary, SIDE, SIDE, 0.0075,
                                  &counts[0][k]));
        gradient_strength(ctx, &scene.photo, strength);
        ok(ctx, tz_boundary_match(ctx, strength, scene.boundary, SIDE, SIDE, 0.0075,
                                  &counts[1][k]));
        tz_scene_deinit(&scene);
    }
    const tz_boundary_score forest = tz_boundary_score_of(counts[0], TZ_SCENE_COUNT);
    const tz_boundary_score gradient = tz_boundary_score_of(counts[1], TZ_SCENE_COUNT);
    print_message("ODS: tiny forest %.3f, gradient %.3f\n", forest.ods, gradient.ods);
    assert_true(forest.ods > gradient.ods + 0.03);
    assert_true(forest.ap > gradient.ap);
    tz_forest_deinit(&f);
    end_ctx(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(same_at_any_thread_count),
        cmocka_unit_test(memory_may_fail),
        cmocka_unit_test(can_be_cancelled),
        cmocka_unit_test(budget_is_a_time),
        cmocka_unit_test(trees_are_sound),
        cmocka_unit_test(tiny_forest_beats_the_gradient),
    };
    begin_dir(dir);
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    end_dir(dir);
    return failed;
}
