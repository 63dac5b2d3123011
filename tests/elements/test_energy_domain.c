/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The energy solver in domains with regions, frames and zones; elements that come and go;
 * shapes. */
#include "tests/base/check.h"

#include <math.h>

#include "elements/energy.h"
#include "tests/elements/patterns.h"

static tz_energy_params defaults(void)
{
    tz_energy_params p;
    tz_params_default(&tz_energy_param_table, &p);
    return p;
}

static tz_domain plain(double w, double h)
{
    return (tz_domain){.size = {w, h, 0}, .torus = false};
}

/* Standard deviation of nearest distances over their mean. */
static double spread_of(const tz_element_set *s, double *mean)
{
    double sum = 0, square = 0;
    for (int32_t i = 0; i < s->element.n; i++) {
        double least = INFINITY;
        for (int32_t k = 0; k < s->element.n; k++) {
            const tz_vec3 v =
                tz_domain_vector(&s->domain, s->element.v[i].at, s->element.v[k].at);
            if (k != i)
                least = fmin(least, hypot(v.x, v.y));
        }
        sum += least, square += least * least;
    }
    *mean = sum / s->element.n;
    return sqrt(fmax(0, square / s->element.n - *mean * *mean)) / *mean;
}

/* ---- regions --------------------------------------------------------------------- */

/* A ring of radii 50 and 130 in the middle of 300 x 300. */
static tz_region *ring(tz_ctx *ctx, bool torus)
{
    enum { N = 150 };
    float *m = calloc(N * N, sizeof *m);
    tz_region *r;
    for (int32_t i = 0; i < N * N; i++) {
        const double d = 2 * hypot(i % N + 0.5 - 75, i / N + 0.5 - 75);
        m[i] = (float)fmin(fmax(fmin(130 - d, d - 50) / 2 + 0.5, 0), 1);
    }
    ok(ctx, tz_region_from_mask(ctx, m, N, N, (tz_vec3){300, 300, 0}, torus, &r));
    free(m);
    return r;
}

static void test_region(void **state)
{
    (void)state;
    static const pattern all[] = {PATTERN_SQUARE, PATTERN_HEX, PATTERN_JITTER,
                                  PATTERN_MIXED};
    for (size_t k = 0; k < sizeof all / sizeof all[0]; k++)
        for (int start = 0; start < 2; start++) {
            tz_ctx *ctx = new_ctx(2);
            tz_region *r = ring(ctx, k % 2 == 1);
            tz_element_set from, out = {.domain = plain(300, 300)};
            tz_energy_params p = defaults();
            double energy[16], mean;
            p.start = start;
            p.iterations = 15;
            p.existence = true;
            out.domain.torus = k % 2 == 1;
            out.domain.region = r;
            ok(ctx, pattern_make(ctx, &from, all[k],
                                 plain(100, all[k] == PATTERN_HEX ? 103.93 : 100), 1));
            ok(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, energy));
            /* all inside, as many as the area holds, none in heaps */
            const double want = r->area * from.element.n / tz_domain_area(&from.domain);
            assert_float_equal(out.element.n, want, 0.06 * want);
            for (int32_t i = 0; i < out.element.n; i++)
                assert_true(tz_domain_contains(&out.domain, out.element.v[i].at));
            (void)spread_of(&out, &mean);
            assert_true(mean > (all[k] >= PATTERN_JITTER ? 5 : 8.5));
            assert_true(energy[15] < energy[0] * (start ? 0.5 : 0.9));
            ok(ctx, tz_element_set_check(ctx, &out, "out"));
            tz_element_set_deinit(&from);
            tz_element_set_deinit(&out);
            tz_region_free(r);
            end_ctx(ctx);
        }
}

/* Things at the exemplar's border are of another class: so they are at the region's. */
static void test_border_of_region(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_region *r = ring(ctx, false);
    double near[2] = {0};
    for (int k = 0; k < 2; k++) {
        tz_element_set from, out = {.domain = plain(300, 300)};
        tz_energy_params p = defaults();
        out.domain.region = r;
        p.border = k;
        p.iterations = 20;
        ok(ctx, pattern_begin(ctx, &from, plain(100, 100), 2, 4));
        from.kind.v[0].oriented = true;
        for (int i = 0; i < 100; i++) { /* an attribute tells: kinds never change */
            const int x = i % 10, y = i / 10;
            ok(ctx, pattern_add(&from, 0, 5 + 10 * x, 5 + 10 * y));
            const bool rim = x == 0 || y == 0 || x == 9 || y == 9;
            from.element.v[i].radius = rim ? 2 : 5;
        }
        ok(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, NULL));
        double n = 0;
        for (int32_t i = 0; i < out.element.n; i++) {
            const tz_element *e = &out.element.v[i];
            if (tz_domain_depth(&out.domain, e->at) < 7)
                near[k] += e->radius < 3, n++;
        }
        near[k] /= n;
        tz_element_set_deinit(&from);
        tz_element_set_deinit(&out);
    }
    assert_true(near[1] > near[0] + 0.1);
    tz_region_free(r);
    end_ctx(ctx);
}

/* ---- frames ---------------------------------------------------------------------- */

/* Rows of sticks that lie along x, turned by the frames: angles follow, and each has
 * neighbours where a turned exemplar has them. */
static void test_frames(void **state)
{
    (void)state;
    static const char *const formula[] = {"30", "x*0.3",
                                          "atan2(y-h/2, x-w/2)*180/pi + 90"};
    for (int k = 0; k < 3; k++)
        for (int start = 0; start < 2; start++) {
            tz_ctx *ctx = new_ctx(2);
            tz_frames *f;
            tz_element_set from, out = {.domain = plain(200, 200)};
            tz_energy_params p = defaults();
            ok(ctx, tz_frames_from_formula(ctx, formula[k], out.domain.size, false, &f));
            out.domain.frames = f;
            p.start = start;
            p.iterations = 20;
            p.existence = true;
            ok(ctx, pattern_make(ctx, &from, PATTERN_BRICK, plain(160, 160), 1));
            from.kind.v[0].oriented = true;
            ok(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, NULL));
            assert_float_equal(out.element.n, 250, 20);
            double sum = 0;
            for (int32_t i = 0; i < out.element.n; i++) {
                const tz_element *e = &out.element.v[i];
                const double off = e->angle - tz_domain_frame(&out.domain, e->at);
                sum += fabs(sin(off)) / out.element.n;
            }
            assert_true(sum < 0.1);
            tz_element_set_deinit(&from);
            tz_element_set_deinit(&out);
            tz_frames_free(f);
            end_ctx(ctx);
        }
}

/* With a constant frame the lattice is the exemplar's, turned: nearest neighbours lie
 * along its axes. */
static void test_turned_lattice(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_frames *f;
    tz_element_set from, out = {.domain = plain(200, 200)};
    tz_energy_params p = defaults();
    ok(ctx, tz_frames_from_formula(ctx, "30", out.domain.size, false, &f));
    out.domain.frames = f;
    p.iterations = 20;
    ok(ctx, pattern_make(ctx, &from, PATTERN_SQUARE, plain(120, 120), 1));
    ok(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, NULL));
    int32_t good = 0, all = 0;
    for (int32_t i = 0; i < out.element.n; i++)
        for (int32_t k = 0; k < out.element.n; k++) {
            const tz_vec3 v =
                tz_domain_vector(&out.domain, out.element.v[i].at, out.element.v[k].at);
            if (i == k || hypot(v.x, v.y) > 12.5)
                continue;
            const double off = remainder(atan2(v.y, v.x) - TZ_PI / 6, TZ_PI / 2);
            all++, good += fabs(off) < 0.15;
        }
    assert_true(all > 1000);
    assert_true(good > 0.9 * all);
    tz_element_set_deinit(&from);
    tz_element_set_deinit(&out);
    tz_frames_free(f);
    end_ctx(ctx);
}

/* ---- zones ----------------------------------------------------------------------- */

/* Left: kind 0 alone; right: kind 1 alone; between: both. */
static void thirds(tz_zones *z, uint8_t zone[3], uint64_t allow[3])
{
    for (int i = 0; i < 3; i++)
        zone[i] = (uint8_t)i;
    allow[0] = 1, allow[1] = 3, allow[2] = 2;
    *z = (tz_zones){
        .raster = {3, 1, {240, 150, 0}, false}, .zone = zone, .allow = allow, .zones = 3};
}

static void test_zones(void **state)
{
    (void)state;
    static const pattern all[] = {PATTERN_CHESS, PATTERN_MIXED};
    for (int k = 0; k < 2; k++)
        for (int start = 0; start < 3; start++) {
            tz_ctx *ctx = new_ctx(2);
            tz_zones z;
            uint8_t zone[3];
            uint64_t allow[3];
            tz_element_set from, out = {0};
            tz_energy_params p = defaults();
            tz_domain d = plain(240, 150);
            thirds(&z, zone, allow);
            d.zones = &z;
            p.start = start;
            p.existence = k == 1;
            ok(ctx, pattern_make(ctx, &from, all[k], plain(100, 100), 1));
            ok(ctx, tz_element_set_like(ctx, &from, &d, &out));
            for (int i = 0; i < 360; i++) { /* what is given does not respect them */
                const tz_vec3 at = {5 + i % 24 * 10, 5 + i / 24 * 10, 0};
                ok(ctx, tz_element_set_place(&out, &from, i % 100, at, 0, 1));
                out.element.v[i].fixed = i == 5;
            }
            const tz_element fixed = out.element.v[5];
            ok(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, NULL));
            int32_t n[3] = {0}, stayed = 0;
            for (int32_t i = 0; i < out.element.n; i++) {
                const tz_element *e = &out.element.v[i];
                stayed += e->fixed && e->at.x == fixed.at.x && e->kind == fixed.kind;
                assert_true(e->fixed || tz_domain_allows(&d, e->at, e->kind));
                n[(int)fmin(fmax(e->at.x / 80, 0), 2)]++;
            }
            assert_int_equal(stayed, 1);
            assert_true(n[0] > 40 && n[1] > 85 && n[2] > 5);
            assert_true(out.element.n < 400);
            tz_element_set_deinit(&from);
            tz_element_set_deinit(&out);
            end_ctx(ctx);
        }
}

/* ---- existence ------------------------------------------------------------------- */

/* A lattice with holes and doubles comes to what it should be, in number and in place. */
static void test_existence(void **state)
{
    (void)state;
    static const pattern all[] = {PATTERN_SQUARE, PATTERN_HEX, PATTERN_CHESS};
    for (int k = 0; k < 3; k++)
        for (int fault = 0; fault < 3; fault++) {
            tz_ctx *ctx = new_ctx(2);
            const double h = all[k] == PATTERN_HEX ? 207.846 : 200;
            const tz_domain d = {.size = {200, h, 0}, .torus = true};
            tz_element_set from, whole, out;
            tz_energy_params p = defaults();
            double energy[17], mean;
            p.start = TZ_ENERGY_GIVEN;
            p.iterations = 16;
            p.existence = true;
            ok(ctx, pattern_make(ctx, &from, all[k],
                                 plain(100, all[k] == PATTERN_HEX ? 103.93 : 100), 1));
            ok(ctx, pattern_make(ctx, &whole, all[k], d, 1));
            ok(ctx, tz_element_set_like(ctx, &from, &d, &out));
            for (int32_t i = 0; i < whole.element.n; i++) {
                tz_rng r = tz_rng_make(7, (uint64_t)i);
                const tz_element *e = &whole.element.v[i];
                const int32_t source = e->kind == from.element.v[0].kind ? 0 : 1;
                const tz_vec3 beside = {e->at.x + 3, e->at.y + 3, 0};
                if (fault != 1 && tz_rng_unit(&r) < 0.07)
                    continue; /* missing */
                ok(ctx, tz_element_set_place(&out, &from, source, e->at, 0, 1));
                if (fault != 0 && tz_rng_unit(&r) < 0.07) /* one too many */
                    ok(ctx, tz_element_set_place(&out, &from, source, beside, 0, 1));
            }
            ok(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, energy));
            assert_float_equal(out.element.n, whole.element.n, 0.012 * whole.element.n);
            assert_true(energy[16] <
                        0.05 * 100 * out.element.n); /* of a spacing's square */
            assert_true(spread_of(&out, &mean) < 0.05);
            assert_float_equal(mean, 10, 0.25);
            for (int32_t i = 0; i < out.element.n; i++)
                assert_int_equal(from.element.v[out.element.v[i].source].kind,
                                 out.element.v[i].kind);
            ok(ctx, tz_element_set_check(ctx, &out, "out"));
            tz_element_set_deinit(&from);
            tz_element_set_deinit(&whole);
            tz_element_set_deinit(&out);
            end_ctx(ctx);
        }
}

/* Two classes that meet out of step at the seams of random patches cannot pass each
 * other, but they can end and begin. */
static void test_two_classes_heal(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    for (uint64_t seed = 0; seed < 3; seed++) {
        double spread[3], mean;
        for (int k = 0; k < 3; k++) { /* the start; without; with existence */
            tz_element_set from, out = {.domain = {.size = {300, 300, 0}, .torus = true}};
            tz_energy_params p = defaults();
            p.tries = 1;
            p.seed = seed;
            p.iterations = k ? 20 : 0;
            p.existence = k == 2;
            ok(ctx, pattern_make(ctx, &from, PATTERN_CHESS, plain(80, 80), 1));
            ok(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, NULL));
            spread[k] = spread_of(&out, &mean);
            if (k == 2)
                assert_float_equal(out.element.n, 900, 28);
            tz_element_set_deinit(&from);
            tz_element_set_deinit(&out);
        }
        assert_true(spread[1] < spread[0]);
        assert_true(spread[2] < 0.3 * spread[0]);
        assert_true(spread[2] < 0.5 * spread[1]);
    }
    end_ctx(ctx);
}

/* What is whole is left alone, what is fixed always; density goes to the exemplar's. */
static void test_existence_is_careful(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_element_set from, out = {.domain = {.size = {400, 400, 0}, .torus = true}};
    tz_energy_params p = defaults();
    double energy[17];
    p.start = TZ_ENERGY_NOISE;
    p.iterations = 16;
    ok(ctx, pattern_make(ctx, &from, PATTERN_JITTER, plain(160, 160), 1));
    ok(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, NULL));
    for (int32_t i = 0; i < 300; i++) { /* a fifth too many */
        tz_rng r = tz_rng_make(1, (uint64_t)i);
        const tz_vec3 at = {tz_rng_unit(&r) * 400, tz_rng_unit(&r) * 400, 0};
        ok(ctx, tz_element_set_place(&out, &from, i % 256, at, 0, 1));
    }
    for (int32_t i = 0; i < out.element.n; i += 50)
        out.element.v[i].fixed = true;
    const int32_t fixed = (out.element.n + 49) / 50;
    p.start = TZ_ENERGY_GIVEN;
    p.existence = true;
    ok(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, energy));
    assert_float_equal(out.element.n, 1600, 60);
    int32_t kept = 0;
    for (int32_t i = 0; i < out.element.n; i++)
        kept += out.element.v[i].fixed;
    assert_int_equal(kept, fixed);
    for (int32_t i = 8; i < 16; i++) /* all have come: no strict law, but it falls */
        assert_true(energy[i + 1] < energy[i] * 1.01);
    tz_element_set_deinit(&from);
    tz_element_set_deinit(&out);
    end_ctx(ctx);
}

/* ---- shapes ---------------------------------------------------------------------- */

static tz_status add_bar(tz_element_set *s, double x, double y, double angle)
{
    tz_status st = pattern_add(s, 0, x, y);
    tz_element *e = &s->element.v[s->element.n - 1];
    e->samples = 5;
    e->angle = angle;
    for (int k = 0; k < 5 && st == TZ_OK; k++) {
        const double l = (k - 2) * 4;
        const tz_sample p = {
            .at = {x + l * cos(angle), y + l * sin(angle), 0}, .id = k, .weight = 0.2};
        if (k == 0)
            s->sample.v[e->sample] = p;
        else
            st = tz_array_push(s->ctx, &s->sample, p);
    }
    return st;
}

/* In a whirl of frames bars are turned; rigid ones stay straight and as long as they
 * were, similar ones straight, and those that may bend do. */
static void test_shapes(void **state)
{
    (void)state;
    double bent[3] = {0};
    for (int shape = 0; shape < 3; shape++) {
        tz_ctx *ctx = new_ctx(2);
        tz_frames *f;
        tz_element_set from, out = {.domain = plain(120, 120)};
        tz_energy_params p = defaults();
        ok(ctx, tz_frames_from_formula(ctx, "atan2(y-h/2, x-w/2)*180/pi + 90",
                                       out.domain.size, false, &f));
        out.domain.frames = f;
        p.shape = shape;
        ok(ctx, pattern_begin(ctx, &from, plain(120, 120), 1, 9));
        for (int i = 0; i < 72; i++)
            ok(ctx, add_bar(&from, 10 + i % 6 * 20, 5 + i / 6 * 10, 0));
        ok(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, NULL));
        for (int32_t i = 0; i < out.element.n; i++) {
            const tz_element *e = &out.element.v[i];
            for (int k = 0; k < 5; k++) {
                const tz_vec3 q = out.sample.v[e->sample + k].at;
                const double l = (k - 2) * 4 * e->scale;
                bent[shape] = fmax(bent[shape], hypot(q.x - e->at.x - l * cos(e->angle),
                                                      q.y - e->at.y - l * sin(e->angle)));
            }
            assert_float_equal(e->radius, 9 * e->scale, 1e-9);
            assert_true(shape == TZ_SHAPE_SIMILARITY || fabs(e->scale - 1) < 1e-12);
            assert_true(e->scale > 0.49 && e->scale < 2.01);
        }
        tz_element_set_deinit(&from);
        tz_element_set_deinit(&out);
        tz_frames_free(f);
        end_ctx(ctx);
    }
    assert_true(bent[TZ_SHAPE_RIGID] < 1e-9 && bent[TZ_SHAPE_SIMILARITY] < 1e-9);
    assert_true(bent[TZ_SHAPE_BEND] > 0.3);
}

/* ---- all together ---------------------------------------------------------------- */

static tz_status solve_all(tz_ctx *ctx, tz_element_set *out)
{
    enum { N = 30 };
    float m[N * N];
    tz_region *r = NULL;
    float fx[4], fy[4];
    tz_zones z;
    uint8_t zone[3];
    uint64_t allow[3];
    tz_element_set from = {0};
    tz_energy_params p = defaults();
    *out = (tz_element_set){.domain = plain(240, 150)};
    for (int i = 0; i < N * N; i++)
        m[i] = hypot(i % N - 15, i / N - 15) < 14;
    thirds(&z, zone, allow);
    p.existence = true;
    p.iterations = 6;
    tz_status s = tz_region_from_mask(ctx, m, N, N, out->domain.size, false, &r);
    for (int i = 0; i < 4; i++)
        fx[i] = (float)cos(0.3 * i), fy[i] = (float)sin(0.3 * i);
    const tz_frames f = {
        .raster = {2, 2, out->domain.size, false}, .x = fx, .y = fy, .ctx = ctx};
    if (s == TZ_OK)
        s = pattern_make(ctx, &from, PATTERN_MIXED, plain(100, 100), 1);
    out->domain.region = r, out->domain.frames = &f, out->domain.zones = &z;
    if (s == TZ_OK)
        s = tz_energy_solve(ctx, &from, &p, out, NULL, NULL);
    out->domain.region = NULL, out->domain.frames = NULL, out->domain.zones = NULL;
    tz_element_set_deinit(&from);
    tz_region_free(r);
    return s;
}

static tz_status solve_and_drop(tz_ctx *ctx)
{
    tz_element_set out;
    const tz_status s = solve_all(ctx, &out);
    if (out.ctx)
        tz_element_set_deinit(&out);
    return s;
}

static void test_memory_runs_out(void **state)
{
    (void)state;
    survive(solve_and_drop, 1);
}

static void test_threads_do_not_matter(void **state)
{
    (void)state;
    static const int threads[] = {1, 2, 8};
    tz_element *first = NULL;
    int32_t n = 0;
    for (int k = 0; k < 3; k++) {
        tz_ctx *ctx = new_ctx(threads[k]);
        tz_element_set out;
        ok(ctx, solve_all(ctx, &out));
        if (k == 0) {
            n = out.element.n;
            const size_t size = (size_t)n * sizeof *first;
            first = memcpy(malloc(size), out.element.v, size);
            assert_true(n > 100);
        }
        assert_int_equal(out.element.n, n);
        for (int32_t i = 0; i < n; i++) {
            assert_memory_equal(&first[i].at, &out.element.v[i].at, sizeof first[i].at);
            assert_true(first[i].source == out.element.v[i].source);
        }
        tz_element_set_deinit(&out);
        end_ctx(ctx);
    }
    free(first);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_region),
        cmocka_unit_test(test_border_of_region),
        cmocka_unit_test(test_frames),
        cmocka_unit_test(test_turned_lattice),
        cmocka_unit_test(test_zones),
        cmocka_unit_test(test_existence),
        cmocka_unit_test(test_two_classes_heal),
        cmocka_unit_test(test_existence_is_careful),
        cmocka_unit_test(test_shapes),
        cmocka_unit_test(test_memory_runs_out),
        cmocka_unit_test(test_threads_do_not_matter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
