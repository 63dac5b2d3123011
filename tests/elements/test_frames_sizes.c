/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Frames with sizes and densities: how they are carried, and that growth and the energy
 * solver follow them. */
#include "tests/base/check.h"

#include <math.h>

#include "elements/energy.h"
#include "elements/field.h"
#include "tests/elements/growing.h"

static const tz_vec3 square = {300, 300, 0};

/* A field of upright strokes, each from the top to the bottom. */
typedef struct upright {
    double x, size, density, weight;
    bool level; /* says that things lie level, not along it */
} upright;

static void add_upright(tz_ctx *ctx, tz_element_field *f, const upright *v, int32_t n)
{
    for (int32_t i = 0; i < n; i++) {
        const double d = v[i].density, h = f->raster.size.y;
        const tz_element_field_stroke pen = {
            .radius = 1, .weight = v[i].weight, .directed = true};
        const tz_element_field_point down[2] = {{{v[i].x, 0}, v[i].size, d},
                                                {{v[i].x, h}, v[i].size, d}};
        if (!v[i].level) {
            ok(ctx, tz_element_field_add(f, pen, 2, down));
            continue;
        }
        for (double y = 0; y <= h; y += 1) {
            const tz_element_field_point across[2] = {{{v[i].x - 1, y}, v[i].size, d},
                                                      {{v[i].x + 1, y}, v[i].size, d}};
            ok(ctx, tz_element_field_add(f, pen, 2, across));
        }
    }
}

static tz_frames *frames_of(tz_ctx *ctx, bool torus, const upright *v, int32_t n)
{
    tz_element_field f;
    tz_frames *out;
    ok(ctx, tz_element_field_init(ctx, square, torus, 256, &f));
    add_upright(ctx, &f, v, n);
    ok(ctx, tz_element_field_settle(&f));
    ok(ctx, tz_frames_from_field(&f, &out));
    tz_element_field_deinit(&f);
    return out;
}

static tz_vec3 at(double x, double y) { return (tz_vec3){x, y, 0}; }

/* ---- frames -------------------------------------------------------------------------- */

/* Sizes change by equal factors, densities evenly. */
static void sizes_are_harmonic(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    const upright v[2] = {{.x = 30, .size = 1, .density = 1, .weight = 1},
                          {.x = 270, .size = 4, .density = 0, .weight = 1}};
    tz_frames *f = frames_of(ctx, false, v, 2);
    assert_true(f->turned && f->thinned);
    for (double x = 40; x < 265; x += 15) {
        const double t = (x - 30) / 240, size = pow(4, t);
        growing_near(tz_frames_size(f, at(x, 150)), size, 0.02);
        growing_near(tz_frames_apart(f, at(x, 150)),
                     size / sqrt(fmax(1 - t, TZ_FRAMES_LEAST_DENSITY)), 0.05);
        assert_true(fabs(tz_frames_angle(f, at(x, 150)) - TZ_PI / 2) < 1e-3);
    }
    growing_near(tz_frames_size(f, at(2, 150)), 1, 0.01);
    growing_near(tz_frames_apart(f, at(298, 150)), 16, 0.01);
    growing_near(f->apart_least, 1, 0.01);
    growing_near(f->apart_most, 16, 0.01);
    tz_frames_drop_sizes(f);
    assert_true(tz_frames_size(f, at(298, 9)) == 1 && tz_frames_apart(f, at(9, 9)) == 1);
    tz_frames_free(f);
    /* on a torus the way round is as good */
    const upright w[2] = {{.x = 20, .size = 1, .density = -1, .weight = 1},
                          {.x = 280, .size = 4, .density = -1, .weight = 1}};
    f = frames_of(ctx, true, w, 2);
    growing_near(tz_frames_size(f, at(0.5, 150)), 2, 0.05);
    growing_near(tz_frames_size(f, at(150, 150)), 2, 0.02);
    assert_false(f->thinned);
    tz_frames_free(f);
    end_ctx(ctx);
}

/* Nothing said of sizes: frames are as they were before there were any. */
static void plain_strokes_only_turn(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    const upright v = {.x = 50, .density = -1, .weight = 3};
    tz_frames *f = frames_of(ctx, false, &v, 1);
    assert_true(f->turned && !f->thinned && !f->size && !f->apart);
    const tz_domain d = {.size = square, .frames = f}, none = {.size = square};
    assert_true(tz_domain_scale(&d, at(9, 9)) == 1 && tz_domain_apart(&d, at(9, 9)) == 1);
    assert_true(tz_domain_scale(&none, at(9, 9)) == 1 &&
                tz_domain_apart(&none, at(9, 9)) == 1);
    tz_frames_free(f);
    end_ctx(ctx);
}

/* Between two strokes that say level, one that says upright: the lighter it is the less
 * it has its way, down to its share. */
static void lighter_strokes_give_way(void **state)
{
    (void)state;
    static const double weight[] = {1, 0.9, 0.5, 0.25, 0.05, 1e-6};
    tz_ctx *ctx = new_ctx(1);
    double before = 1.6;
    for (size_t k = 0; k < sizeof weight / sizeof *weight; k++) {
        const upright v[3] = {{.x = 75, .density = -1, .weight = 1, .level = true},
                              {.x = 225, .density = -1, .weight = 1, .level = true},
                              {.x = 150, .density = -1, .weight = weight[k]}};
        tz_frames *f = frames_of(ctx, false, v, 3);
        const double a = tz_frames_angle(f, at(150, 150));
        assert_true(a <= before + 1e-6);
        if (k == 0)
            assert_true(fabs(a - TZ_PI / 2) < 0.01);
        if (weight[k] == 0.5) /* cells under a pen two wide: somewhat more than half */
            assert_true(a > 0.6 && a < 1.2);
        if (k == 5)
            assert_true(a < 1e-3);
        assert_true(fabs(tz_frames_angle(f, at(75, 150))) < 0.02);
        before = a;
        tz_frames_free(f);
    }
    end_ctx(ctx);
}

static void formulas_take_sizes(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_field field;
    tz_frames *f, *none;
    const upright v = {.x = 150, .size = 2, .density = -1, .weight = 1};
    ok(ctx, tz_element_field_init(ctx, square, false, 100, &field));
    ok(ctx, tz_frames_from_formula(ctx, "x", square, false, &f));
    ok(ctx, tz_element_field_settle(&field));
    ok(ctx, tz_frames_add_sizes(f, &field)); /* says none */
    assert_null(f->size);
    fails(ctx, tz_frames_from_field(&field, &none), TZ_INVALID, "nothing in view");
    assert_null(none);
    add_upright(ctx, &field, &v, 1);
    ok(ctx, tz_element_field_settle(&field));
    ok(ctx, tz_frames_add_sizes(f, &field));
    growing_near(tz_frames_size(f, at(9, 9)), 2, 1e-3);
    assert_true(fabs(tz_frames_angle(f, at(30, 9)) - TZ_PI / 6) < 1e-3);
    const upright vast = {.x = 50, .size = 90, .density = -1, .weight = 1};
    add_upright(ctx, &field, &vast, 1);
    ok(ctx, tz_element_field_settle(&field));
    fails(ctx, tz_frames_add_sizes(f, &field), TZ_INVALID, "size 90");
    growing_near(tz_frames_size(f, at(9, 9)), 2, 1e-3); /* unchanged */
    tz_frames_free(f);
    tz_element_field_deinit(&field);
    end_ctx(ctx);
}

/* ---- arrangements -------------------------------------------------------------------- */

static double nearest(const tz_element_set *s, int32_t i)
{
    double least = INFINITY;
    for (int32_t j = 0; j < s->element.n; j++) {
        const tz_vec3 v =
            tz_domain_vector(&s->domain, s->element.v[i].at, s->element.v[j].at);
        if (j != i)
            least = fmin(least, hypot(v.x, v.y));
    }
    return least;
}

/* Elements 10 apart in squares, grown or solved for. @return radius in the exemplar */
typedef enum how { GROWN, PATCHES, NOISE } how;

static double arrange(tz_ctx *ctx, how k, const tz_domain *d, tz_element_set *out)
{
    tz_element_set ex;
    const tz_growth_texture all = {.scale = 1};
    const tz_growth_params p = growing_params();
    ok(ctx, drawn_squares(ctx, 12, 1, false, &ex));
    ok(ctx, tz_element_set_like(ctx, &ex, d, out));
    if (k == GROWN) {
        ok(ctx, growing_run(ctx, &ex, &all, 1, &p, 777, out));
    } else {
        tz_energy_params e;
        tz_params_default(&tz_energy_param_table, &e);
        e.start = k == PATCHES ? TZ_ENERGY_PATCHES : TZ_ENERGY_NOISE;
        e.iterations = 20;
        e.existence = true;
        ok(ctx, tz_energy_solve(ctx, &ex, &e, out, NULL, NULL));
    }
    ok(ctx, tz_element_set_check(ctx, out, "output"));
    const double radius = ex.element.v[0].radius;
    for (int32_t i = 0; i < out->element.n; i++) /* drawn as large as it counts */
        growing_near(out->element.v[i].radius,
                     out->element.v[i].scale * out->symbol.v[0].radius, 1e-6);
    tz_element_set_deinit(&ex);
    return radius;
}

/* Twice as large: a quarter as many. A quarter as dense: as large, and a quarter as many.
 * Half as large: four times as many. */
static void everywhere_the_same(void **state)
{
    (void)state;
    static const struct {
        double size, density, count, apart;
    } want[] = {{2, -1, 0.25, 2}, {1, 0.25, 0.25, 2}, {0.5, -1, 4, 0.5}};
    for (int k = 0; k < 9; k++) {
        tz_ctx *ctx = new_ctx(2);
        const int i = k % 3;
        const upright v[2] = {{.x = 100,
                               .size = want[i].size,
                               .density = want[i].density,
                               .weight = 1,
                               .level = true}};
        tz_frames *f = frames_of(ctx, true, v, 1);
        const tz_domain d = {.size = square, .torus = true, .frames = f};
        tz_element_set out;
        const double radius = arrange(ctx, (how)(k / 3), &d, &out);
        growing_near(out.element.n, 900 * want[i].count, 0.12);
        double mean = 0;
        for (int32_t n = 0; n < out.element.n; n++) {
            const tz_element *e = &out.element.v[n];
            growing_near(e->radius, radius * want[i].size, 0.01);
            mean += nearest(&out, n) / out.element.n;
        }
        growing_near(mean, 10 * want[i].apart, 0.2);
        tz_element_set_deinit(&out);
        tz_frames_free(f);
        end_ctx(ctx);
    }
}

/* Sizes that change from place to place: elements have those of where they lie, samples
 * are scaled along, and counts follow the integral of density. */
static void sizes_change_from_place_to_place(void **state)
{
    (void)state;
    for (how k = GROWN; k <= NOISE; k++) {
        tz_ctx *ctx = new_ctx(2);
        const upright v[2] = {
            {.x = 40, .size = 0.7, .density = 1, .weight = 1, .level = true},
            {.x = 260, .size = 1.6, .density = 0.4, .weight = 1, .level = true}};
        tz_frames *f = frames_of(ctx, false, v, 2);
        const tz_domain d = {.size = square, .frames = f};
        double due = 0;
        for (int i = 0; i < 90000; i++) {
            const double a =
                tz_frames_apart(f, at(i % 300 + 0.5, (double)(i / 300) + 0.5));
            due += 0.01 / (a * a);
        }
        tz_element_set out;
        const double radius = arrange(ctx, k, &d, &out);
        growing_near(out.element.n, due, 0.12);
        for (int32_t n = 0; n < out.element.n; n++) {
            const tz_element *e = &out.element.v[n];
            growing_near(e->radius, radius * tz_domain_scale(&d, e->at), 0.02);
        }
        tz_element_set_deinit(&out);
        tz_frames_free(f);
        end_ctx(ctx);
    }
}

/* Bars of two samples each, which may grow: thinning out moves them apart, but makes them
 * no longer. */
static void long_things_keep_together(void **state)
{
    (void)state;
    for (int shape = TZ_SHAPE_RIGID; shape <= TZ_SHAPE_SIMILARITY; shape++) {
        tz_ctx *ctx = new_ctx(2);
        const upright v = {
            .x = 40, .size = 1.2, .density = 0.4, .weight = 1, .level = true};
        tz_frames *f = frames_of(ctx, true, &v, 1);
        const tz_domain d = {.size = square, .torus = true, .frames = f};
        tz_element_set ex, out;
        tz_energy_params e;
        ok(ctx, drawn_squares(ctx, 12, 1, false, &ex));
        ex.sample.n = 0;
        for (int32_t i = 0; i < ex.element.n; i++) {
            tz_element *q = &ex.element.v[i];
            q->sample = ex.sample.n, q->samples = 2;
            for (int32_t k = 0; k < 2; k++) {
                const tz_sample p = {at(q->at.x + 6 * k - 3, q->at.y), k, 1};
                ok(ctx, tz_array_push(ctx, &ex.sample, p));
            }
        }
        tz_params_default(&tz_energy_param_table, &e);
        e.shape = shape;
        ok(ctx, tz_element_set_like(ctx, &ex, &d, &out));
        ok(ctx, tz_energy_solve(ctx, &ex, &e, &out, NULL, NULL));
        double mean = 0, worst = 0;
        for (int32_t i = 0; i < out.element.n; i++) {
            const tz_sample *q = &out.sample.v[out.element.v[i].sample];
            const double l = hypot(q[1].at.x - q[0].at.x, q[1].at.y - q[0].at.y) / 7.2;
            mean += l / out.element.n;
            worst = fmax(worst, fabs(l - 1));
        }
        growing_near(out.element.n, 900 * 0.4 / 1.44, 0.15);
        growing_near(mean, 1, 0.05);
        if (shape == TZ_SHAPE_RIGID)
            assert_true(worst < 0.01);
        tz_element_set_deinit(&ex);
        tz_element_set_deinit(&out);
        tz_frames_free(f);
        end_ctx(ctx);
    }
}

static uint64_t digest(int threads, how k)
{
    tz_ctx *ctx = new_ctx(threads);
    const upright v[2] = {{.x = 40, .size = 0.8, .density = 1, .weight = 1},
                          {.x = 260, .size = 1.5, .density = 0.4, .weight = 2}};
    tz_frames *f = frames_of(ctx, false, v, 2);
    const tz_domain d = {.size = square, .frames = f};
    tz_element_set out;
    arrange(ctx, k, &d, &out);
    const uint64_t h = growing_digest(&out);
    tz_element_set_deinit(&out);
    tz_frames_free(f);
    end_ctx(ctx);
    return h;
}

static void threads_make_no_difference(void **state)
{
    (void)state;
    for (how k = GROWN; k <= NOISE; k++) {
        const uint64_t one = digest(1, k);
        assert_true(digest(2, k) == one && digest(8, k) == one);
    }
}

static tz_status make(tz_ctx *ctx)
{
    tz_element_field f;
    tz_frames *out = NULL;
    const tz_element_field_stroke pen = {.radius = 1, .weight = 1, .directed = true};
    const tz_element_field_point v[2] = {{{2, 2}, 1, 1}, {{8, 8}, 2, 0.5}};
    tz_status s = tz_element_field_init(ctx, (tz_vec3){10, 10, 0}, true, 12, &f);
    if (s == TZ_OK)
        s = tz_element_field_add(&f, pen, 2, v);
    if (s == TZ_OK)
        s = tz_element_field_settle(&f);
    if (s == TZ_OK)
        s = tz_frames_from_field(&f, &out);
    assert_true((s == TZ_OK) == (out != NULL));
    tz_frames_free(out);
    tz_element_field_deinit(&f);
    return s;
}

static void survives_want_of_memory(void **state)
{
    (void)state;
    survive(make, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sizes_are_harmonic),
        cmocka_unit_test(plain_strokes_only_turn),
        cmocka_unit_test(lighter_strokes_give_way),
        cmocka_unit_test(formulas_take_sizes),
        cmocka_unit_test(everywhere_the_same),
        cmocka_unit_test(sizes_change_from_place_to_place),
        cmocka_unit_test(long_things_keep_together),
        cmocka_unit_test(threads_make_no_difference),
        cmocka_unit_test(survives_want_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
