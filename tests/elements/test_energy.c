/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The energy solver: lattices heal, the energy falls, what is fixed stays, odd inputs are
 * survived, threads do not matter. Its parts: test_energy_parts.c; domains that are not
 * plain: test_energy_domain.c. */
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

/* ---- whole runs ------------------------------------------------------------------ */

typedef struct spread {
    double all, seam; /* standard deviation of nearest distances, over their mean */
} spread;

static spread nearest_spread(const tz_element_set *s)
{
    double sum[2] = {0}, square[2] = {0}, n[2] = {0};
    for (int32_t i = 0; i < s->element.n; i++) {
        const tz_vec3 p = s->element.v[i].at;
        double least = INFINITY;
        for (int32_t k = 0; k < s->element.n; k++) {
            const tz_vec3 v = tz_domain_vector(&s->domain, p, s->element.v[k].at);
            if (k != i)
                least = fmin(least, hypot(v.x, v.y));
        }
        const bool seam = p.x < 15 || p.y < 15 || p.x > s->domain.size.x - 15 ||
                          p.y > s->domain.size.y - 15;
        for (int k = 0; k <= seam; k++)
            sum[k] += least, square[k] += least * least, n[k]++;
    }
    double out[2];
    for (int k = 0; k < 2; k++) {
        const double mean = sum[k] / n[k];
        out[k] = sqrt(fmax(0, square[k] / n[k] - mean * mean)) / mean;
    }
    return (spread){out[0], out[1]};
}

static tz_domain cut_of(pattern p)
{
    return (tz_domain){.size = {80, p == PATTERN_HEX ? 86.61 : 80, 0}, .torus = false};
}

static void test_lattices_heal(void **state)
{
    (void)state;
    static const pattern all[] = {PATTERN_SQUARE, PATTERN_HEX, PATTERN_CHESS};
    tz_ctx *ctx = new_ctx(2);
    for (size_t k = 0; k < sizeof all / sizeof all[0]; k++) {
        tz_element_set from, start = {.domain = {.size = {300, 300, 0}, .torus = true}},
                             out = start;
        tz_energy_params p = defaults();
        double energy[11];
        ok(ctx, pattern_make(ctx, &from, all[k], cut_of(all[k]), 1));
        p.tries = 1; /* the paper's start, the worst */
        p.iterations = 0;
        ok(ctx, tz_energy_solve(ctx, &from, &p, &start, NULL, NULL));
        p.iterations = 10;
        ok(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, energy));
        const spread before = nearest_spread(&start), after = nearest_spread(&out);
        /* two classes that meet out of step cannot pass each other */
        assert_true(after.all < (all[k] == PATTERN_CHESS ? 0.6 : 0.5) * before.all);
        /* few elements lie at the seam, so a single fault there weighs more */
        assert_true(after.seam < before.all);
        for (int i = 0; i < 10; i++) /* new neighbours come in: no strict law */
            assert_true(energy[i + 1] < energy[i] * 1.01);
        assert_true(energy[10] < 0.3 * energy[0]);
        tz_element_set_deinit(&from);
        tz_element_set_deinit(&start);
        tz_element_set_deinit(&out);
    }
    end_ctx(ctx);
}

/* Patches that are laid to fit leave nothing to heal; and angles are laid to fit too. */
static void test_fitting_patches(void **state)
{
    (void)state;
    static const pattern all[] = {PATTERN_SQUARE, PATTERN_HEX, PATTERN_CHESS,
                                  PATTERN_BRICK};
    tz_ctx *ctx = new_ctx(2);
    for (size_t k = 0; k < sizeof all / sizeof all[0]; k++) {
        tz_element_set from, out = {.domain = {.size = {300, 300, 0}, .torus = false}};
        tz_energy_params p = defaults();
        double energy[11];
        p.border = 0; /* which costs something even where all fits */
        ok(ctx, pattern_make(ctx, &from, all[k], cut_of(all[k]), 1));
        from.kind.v[0].oriented = true;
        for (int32_t i = 0; i < from.element.n; i++) /* every other column stands */
            from.element.v[i].angle = k == 0 ? (int)(from.element.v[i].at.x / 10) % 2 : 0;
        ok(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, energy));
        assert_true(nearest_spread(&out).all < 0.01);
        assert_true(energy[10] < 1);
        tz_element_set_deinit(&from);
        tz_element_set_deinit(&out);
    }
    end_ctx(ctx);
}

static void test_noise_improves(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_element_set from, out = {.domain = {.size = {200, 150, 0}, .torus = false}};
    tz_energy_params p = defaults();
    double energy[21];
    p.start = TZ_ENERGY_NOISE;
    p.iterations = 20;
    ok(ctx, pattern_make(ctx, &from, PATTERN_SQUARE, cut_of(PATTERN_SQUARE), 1));
    ok(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, energy));
    assert_int_equal(out.element.n, 300);
    assert_true(energy[20] < 0.5 * energy[0]);
    ok(ctx, tz_element_set_check(ctx, &out, "out"));
    tz_element_set_deinit(&from);
    tz_element_set_deinit(&out);
    end_ctx(ctx);
}

static void test_fixed_stay(void **state)
{
    (void)state;
    for (int start = 0; start < 3; start++) {
        tz_ctx *ctx = new_ctx(2);
        tz_element_set from, out = {0};
        tz_energy_params p = defaults();
        p.start = start;
        const tz_domain d = {.size = {150, 120, 0}, .torus = start == 1};
        ok(ctx, pattern_make(ctx, &from, PATTERN_CHESS, cut_of(PATTERN_CHESS), 1));
        ok(ctx, tz_element_set_like(ctx, &from, &d, &out));
        for (int i = 0; i < 40; i++) { /* a third of them fixed */
            tz_rng r = tz_rng_make(9, (uint64_t)i);
            const tz_vec3 at = {tz_rng_unit(&r) * 150, tz_rng_unit(&r) * 120, i};
            ok(ctx, tz_element_set_place(&out, &from, i, at, 0, 1));
            out.element.v[i].fixed = i % 3 == 0;
        }
        tz_element old[40];
        memcpy(old, out.element.v, sizeof old);
        ok(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, NULL));
        assert_true(start == TZ_ENERGY_GIVEN ? out.element.n == 40 : out.element.n > 100);
        int32_t kept = 0;
        for (int32_t i = 0; i < out.element.n; i++) {
            const tz_element *e = &out.element.v[i];
            if (!e->fixed)
                continue;
            const tz_element *o = &old[start == TZ_ENERGY_GIVEN ? i : 3 * kept];
            const tz_vec3 at = out.sample.v[e->sample].at;
            assert_memory_equal(&e->at, &o->at, sizeof e->at);
            assert_memory_equal(&at, &o->at, sizeof at);
            assert_true(e->angle == o->angle && e->kind == o->kind);
            kept++;
        }
        assert_int_equal(kept, 14);
        tz_element_set_deinit(&from);
        tz_element_set_deinit(&out);
        end_ctx(ctx);
    }
}

static void test_classes_keep_their_shares(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_element_set from, out = {.domain = {.size = {600, 600, 0}, .torus = false}};
    const tz_energy_params p = defaults();
    ok(ctx, pattern_make(ctx, &from, PATTERN_MIXED,
                         (tz_domain){.size = {160, 160, 0}, .torus = false}, 1));
    ok(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, NULL));
    double share[2] = {0};
    for (int32_t i = 0; i < from.element.n; i++)
        share[0] += (double)from.element.v[i].kind / from.element.n;
    for (int32_t i = 0; i < out.element.n; i++) {
        const tz_element *e = &out.element.v[i];
        share[1] += (double)e->kind / out.element.n;
        assert_int_equal(from.element.v[e->source].kind, e->kind);
    }
    assert_float_equal(share[1], share[0], 0.03);
    assert_float_equal(out.element.n, 3600, 180);
    tz_element_set_deinit(&from);
    tz_element_set_deinit(&out);
    end_ctx(ctx);
}

/* Angles that turn with the place, of elements of one sample: neighbours vote. */
static void test_attributes(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_element_set from, out = {.domain = {.size = {200, 200, 0}, .torus = true}};
    tz_energy_params p = defaults();
    ok(ctx, pattern_make(ctx, &from, PATTERN_SQUARE, cut_of(PATTERN_SQUARE), 1));
    from.kind.v[0].oriented = true;
    for (int32_t i = 0; i < from.element.n; i++) /* rows by turns lie and stand */
        from.element.v[i].angle = i / 8 % 2 ? 0 : TZ_PI / 2;
    ok(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, NULL));
    for (int32_t i = 0; i < out.element.n; i++) { /* wrong ones here and there */
        out.element.v[i].angle += i % 9 == 0 ? 1 : 0;
        out.element.v[i].radius = 4;
    }
    p.start = TZ_ENERGY_GIVEN;
    ok(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, NULL));
    for (int32_t i = 0; i < out.element.n; i++) {
        const double a = out.element.v[i].angle;
        assert_true(a == 0 || a == TZ_PI / 2);
    }
    tz_element_set_deinit(&from);
    tz_element_set_deinit(&out);
    end_ctx(ctx);
}

/* ---- elements of several samples ------------------------------------------------- */

static tz_status add_bar(tz_element_set *s, double x, double y, double angle)
{
    tz_status st = pattern_add(s, 0, x, y);
    tz_element *e = &s->element.v[s->element.n - 1];
    e->samples = 3;
    e->angle = angle;
    for (int k = 0; k < 3 && st == TZ_OK; k++) {
        const tz_vec3 at = {x + (k - 1) * 6 * cos(angle), y + (k - 1) * 6 * sin(angle),
                            0};
        const tz_sample p = {.at = at, .id = k, .weight = k == 1 ? 2 : 1};
        if (k == 0)
            s->sample.v[e->sample] = p;
        else
            st = tz_array_push(s->ctx, &s->sample, p);
    }
    return st;
}

static void test_several_samples(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_element_set from, out = {0};
    tz_energy_params p = defaults();
    double energy[31];
    const tz_domain d = {.size = {120, 120, 0}, .torus = true};
    p.start = TZ_ENERGY_GIVEN;
    p.iterations = 30;
    ok(ctx, pattern_begin(ctx, &from, d, 1, 7));
    for (int i = 0; i < 36; i++)
        ok(ctx,
           add_bar(&from, 10 + i % 6 * 20, 10 + i / 6 * 20, (i + i / 6) % 2 ? 0 : 1.5));
    ok(ctx, tz_element_set_like(ctx, &from, &d, &out));
    for (int i = 0; i < 36; i++) {
        tz_rng r = tz_rng_make(2, (uint64_t)i);
        const tz_vec3 q = from.element.v[i].at;
        const tz_vec3 at = {q.x + tz_rng_range(&r, -3, 3) + 7,
                            q.y + tz_rng_range(&r, -3, 3), 0};
        ok(ctx, tz_element_set_place(&out, &from, i, at, tz_rng_range(&r, -0.4, 0.4), 1));
    }
    ok(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, energy));
    assert_true(energy[30] < 0.02 * energy[0]);
    for (int i = 0; i < 36; i++) {
        const tz_element *e = &out.element.v[i];
        assert_float_equal(e->angle, from.element.v[i].angle, 0.05);
        for (int k = 0; k < 3; k++) { /* samples where a rigid copy has them */
            const tz_vec3 s = out.sample.v[e->sample + k].at;
            assert_float_equal(s.x - e->at.x, (k - 1) * 6 * cos(e->angle), 0.5);
            assert_float_equal(s.y - e->at.y, (k - 1) * 6 * sin(e->angle), 0.5);
        }
    }
    tz_element_set_deinit(&from);
    tz_element_set_deinit(&out);
    end_ctx(ctx);
}

/* ---- call-backs ------------------------------------------------------------------ */

static double turned_frame(void *user, tz_vec3 at)
{
    (void)at;
    return *(const double *)user;
}

/* A lattice turned by the frame is as good as one that is not. */
static void test_frame(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_element_set from, out = {0};
    tz_energy_params p = defaults();
    double energy[6], turn = 0.5, plain[6];
    const tz_domain d = {.size = {80, 80, 0}, .torus = false};
    const tz_energy_hook hook = {.frame = turned_frame, .user = &turn};
    p.start = TZ_ENERGY_GIVEN;
    p.iterations = 5;
    p.border = 0;
    ok(ctx, pattern_make(ctx, &from, PATTERN_CHESS, cut_of(PATTERN_CHESS), 1));
    ok(ctx, tz_element_set_like(ctx, &from, &d, &out));
    for (int i = 0; i < 64; i++) {
        const double x = i % 8 * 7.0, y = i / 8 * 7.0;
        const tz_vec3 at = {30 + cos(turn) * x * 10 / 7 - sin(turn) * y * 10 / 7,
                            1 + sin(turn) * x * 10 / 7 + cos(turn) * y * 10 / 7, 0};
        if (tz_domain_contains(&d, at))
            ok(ctx, tz_element_set_place(&out, &from, i, at, 0, 1));
    }
    ok(ctx, tz_energy_solve(ctx, &from, &p, &out, &hook, energy));
    assert_true(energy[0] < 1e-3 && energy[5] < 1e-3);
    ok(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, plain));
    assert_true(plain[0] > 100);
    tz_element_set_deinit(&from);
    tz_element_set_deinit(&out);
    end_ctx(ctx);
}

typedef struct calls {
    tz_ctx *ctx;
    int n, stop, cancel;
} calls;

static tz_status count_calls(void *user, tz_element_set *set, int32_t iteration,
                             double energy)
{
    calls *c = user;
    assert_int_equal(iteration, c->n);
    assert_true(isfinite(energy) && set->element.n > 0);
    c->n++;
    if (c->n == c->cancel)
        tz_ctx_cancel(c->ctx);
    return c->n == c->stop ? TZ_IO : TZ_OK;
}

static void test_after_and_cancel(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_element_set from, out = {.domain = {.size = {200, 200, 0}, .torus = true}};
    const tz_energy_params p = defaults();
    calls c = {.ctx = ctx};
    const tz_energy_hook hook = {.after = count_calls, .user = &c};
    ok(ctx, pattern_make(ctx, &from, PATTERN_JITTER, cut_of(PATTERN_JITTER), 1));
    ok(ctx, tz_energy_solve(ctx, &from, &p, &out, &hook, NULL));
    assert_int_equal(c.n, 10);
    c = (calls){.ctx = ctx, .stop = 3};
    assert_int_equal(tz_energy_solve(ctx, &from, &p, &out, &hook, NULL), TZ_IO);
    assert_int_equal(c.n, 3);
    c = (calls){.ctx = ctx, .cancel = 2};
    assert_int_equal(tz_energy_solve(ctx, &from, &p, &out, &hook, NULL), TZ_CANCELLED);
    assert_int_equal(c.n, 2);
    tz_ctx_clear(ctx);
    ok(ctx, tz_element_set_check(ctx, &out, "out"));
    tz_ctx_cancel(ctx);
    assert_int_equal(tz_energy_solve(ctx, &from, &p, &out, NULL, NULL), TZ_CANCELLED);
    tz_ctx_clear(ctx);
    ok(ctx, tz_element_set_check(ctx, &out, "out"));
    tz_element_set_deinit(&from);
    tz_element_set_deinit(&out);
    end_ctx(ctx);
}

/* ---- odd inputs ------------------------------------------------------------------ */

static void solve_odd(tz_ctx *ctx, const tz_element_set *from, tz_element_set *out,
                      tz_energy_params p)
{
    double energy[11];
    ok(ctx, tz_energy_solve(ctx, from, &p, out, NULL, energy));
    ok(ctx, tz_element_set_check(ctx, out, "out"));
    for (int i = 0; i <= 10; i++)
        assert_true(isfinite(energy[i]) && energy[i] >= 0);
}

static void test_odd_sizes(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    for (int32_t n = 1; n <= 3; n++) /* exemplars of one, two, three elements */
        for (int torus = 0; torus < 4; torus++)
            for (int start = 0; start < 2; start++) {
                tz_element_set from,
                    out = {.domain = {.size = {100, 60, 0}, .torus = torus % 2 == 1}};
                tz_energy_params p = defaults();
                p.start = start;
                ok(ctx, pattern_begin(
                            ctx, &from,
                            (tz_domain){.size = {20, 20, 0}, .torus = torus / 2}, 1, 4));
                for (int32_t i = 0; i < n; i++)
                    ok(ctx, pattern_add(&from, 0, 3 + 6 * i, 9 + 4 * i));
                solve_odd(ctx, &from, &out, p);
                assert_true(out.element.n > 0);
                /* a domain smaller than an element */
                tz_element_set small = {
                    .domain = {.size = {2, 1, 0}, .torus = torus % 2 == 1}};
                solve_odd(ctx, &from, &small, p);
                tz_element_set_deinit(&small);
                tz_element_set_deinit(&out);
                tz_element_set_deinit(&from);
            }
    end_ctx(ctx);
}

static void test_heap_of_points(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    for (int torus = 0; torus < 2; torus++) {
        tz_element_set from, out = {0};
        tz_energy_params p = defaults();
        const tz_domain d = {.size = {200, 200, 0}, .torus = torus == 1};
        p.start = TZ_ENERGY_GIVEN;
        ok(ctx, pattern_make(ctx, &from, PATTERN_JITTER, cut_of(PATTERN_JITTER), 1));
        ok(ctx, tz_element_set_like(ctx, &from, &d, &out));
        for (int i = 0; i < 1000; i++)
            ok(ctx,
               tz_element_set_place(&out, &from, i % 64, (tz_vec3){70, 90, 0}, 0, 1));
        solve_odd(ctx, &from, &out, p);
        assert_true(nearest_spread(&out).all > 0); /* they have come apart */
        tz_element_set_deinit(&out);
        /* an exemplar that is a heap */
        for (int i = 0; i < 64; i++)
            from.element.v[i].at = from.sample.v[i].at = (tz_vec3){5, 5, 0};
        tz_element_set more = {.domain = d};
        p.start = TZ_ENERGY_PATCHES;
        solve_odd(ctx, &from, &more, p);
        tz_element_set_deinit(&more);
        tz_element_set_deinit(&from);
    }
    end_ctx(ctx);
}

static void test_empty_output_and_bad_input(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set from,
        none = {.domain = {.size = {10, 10, 0}, .torus = false}, .ctx = ctx};
    tz_element_set out = {.domain = {.size = {50, 50, 0}, .torus = false}}, empty = out;
    tz_energy_params p = defaults();
    double energy[11];
    ok(ctx, pattern_make(ctx, &from, PATTERN_SQUARE, cut_of(PATTERN_SQUARE), 1));
    p.start = TZ_ENERGY_GIVEN;
    ok(ctx, tz_energy_solve(ctx, &from, &p, &empty, NULL, energy));
    assert_int_equal(empty.element.n, 0);
    assert_true(energy[0] == 0 && energy[10] == 0);
    fails(ctx, tz_energy_solve(ctx, &none, &p, &out, NULL, NULL), TZ_INVALID,
          "no elements");
    out.domain.size.x = 0;
    fails(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, NULL), TZ_INVALID, "no area");
    out.domain.size.x = 50;
    p.coherent = 0;
    fails(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, NULL), TZ_INVALID, "coherent");
    p.coherent = 4;
    p.border = NAN;
    fails(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, NULL), TZ_INVALID, "border");
    p.border = 0;
    from.sample.n++; /* nobody's */
    fails(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, NULL), TZ_INVALID, "samples");
    from.sample.n--;
    for (int32_t i = 0; i < from.element.n; i++)
        from.element.v[i].cut = true; /* nothing whole to copy */
    p.start = TZ_ENERGY_PATCHES;
    ok(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, energy));
    assert_int_equal(out.element.n, 0);
    tz_element_set_deinit(&from);
    tz_element_set_deinit(&empty);
    tz_element_set_deinit(&out);
    end_ctx(ctx);
}

static tz_status small_run(tz_ctx *ctx)
{
    tz_element_set from = {0},
                   out = {.domain = {.size = {60, 50, 0}, .torus = true}, .ctx = ctx};
    tz_energy_params p = defaults();
    p.iterations = 2;
    tz_status s = pattern_make(ctx, &from, PATTERN_CHESS,
                               (tz_domain){.size = {40, 40, 0}, .torus = false}, 1);
    for (int32_t i = 0; i < from.element.n; i++)
        from.element.v[i].radius = 3 + i % 2;
    if (s == TZ_OK)
        s = tz_energy_solve(ctx, &from, &p, &out, NULL, NULL);
    for (int32_t i = 0; i < out.element.n; i++)
        out.element.v[i].fixed = i % 4 == 0;
    if (s == TZ_OK)
        s = tz_energy_solve(ctx, &from, &p, &out, NULL, NULL);
    tz_element_set_deinit(&out);
    tz_element_set_deinit(&from);
    return s;
}

static void test_memory_runs_out(void **state)
{
    (void)state;
    survive(small_run, 1);
    survive(small_run, 2);
}

static void test_threads_do_not_matter(void **state)
{
    (void)state;
    static const int threads[] = {1, 2, 8};
    double energy[3][6];
    tz_element *kept = NULL;
    int32_t n = 0;
    for (int k = 0; k < 3; k++) {
        tz_ctx *ctx = new_ctx(threads[k]);
        tz_element_set from, out = {.domain = {.size = {1000, 1000, 0}, .torus = true}};
        tz_energy_params p = defaults();
        p.iterations = 5;
        ok(ctx, pattern_make(ctx, &from, PATTERN_MIXED,
                             (tz_domain){.size = {190, 190, 0}, .torus = false}, 8));
        for (int32_t i = 0; i < from.element.n; i++)
            from.element.v[i].radius = 3 + i % 3;
        ok(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, energy[k]));
        if (k == 0) {
            n = out.element.n;
            assert_true(n > 9000); /* several blocks of the least squares */
            kept = calloc((size_t)n, sizeof *kept);
        }
        assert_int_equal(out.element.n, n);
        for (int32_t i = 0; i < n; i++) {
            const tz_element *e = &out.element.v[i];
            if (k == 0)
                kept[i] = *e;
            assert_memory_equal(&e->at, &kept[i].at, sizeof e->at);
            assert_true(e->source == kept[i].source && e->radius == kept[i].radius);
        }
        assert_memory_equal(energy[k], energy[0], sizeof energy[k]);
        tz_element_set_deinit(&from);
        tz_element_set_deinit(&out);
        end_ctx(ctx);
    }
    free(kept);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lattices_heal),
        cmocka_unit_test(test_fitting_patches),
        cmocka_unit_test(test_noise_improves),
        cmocka_unit_test(test_fixed_stay),
        cmocka_unit_test(test_classes_keep_their_shares),
        cmocka_unit_test(test_attributes),
        cmocka_unit_test(test_several_samples),
        cmocka_unit_test(test_frame),
        cmocka_unit_test(test_after_and_cancel),
        cmocka_unit_test(test_odd_sizes),
        cmocka_unit_test(test_heap_of_points),
        cmocka_unit_test(test_empty_output_and_bad_input),
        cmocka_unit_test(test_memory_runs_out),
        cmocka_unit_test(test_threads_do_not_matter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
