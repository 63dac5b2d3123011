/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The energy solver: one iteration at 1,000, 10,000 and 100,000 elements of one sample,
 * memory, and the least squares alone beside CHOLMOD's on the same equations; with a
 * region, frames and existence.
 * @source [Ma11] Sec. 6.2: 5 s an iteration at 1,000 elements */
#include "base/lsq.h"
#include "elements/energy_internal.h"
#include "tests/bench/bench.h"
#include "tests/elements/patterns.h"

typedef struct clock_hook {
    double at[64];
    int n;
} clock_hook;

static tz_status note(void *user, tz_element_set *set, int32_t iteration, double energy)
{
    (void)set, (void)iteration, (void)energy;
    clock_hook *c = user;
    c->at[c->n++] = bench_now();
    return TZ_OK;
}

/* Both ways to solve the first assignment of a state. */
static void solvers(tz_ctx *ctx, const tz_element_set *from, tz_element_set *out)
{
    tz_energy_params p;
    tz_params_default(&tz_energy_param_table, &p);
    tz_energy_exemplar x;
    tz_energy_state t;
    tz_lsq *l;
    double e, *y, worst = 0;
    tz_vec2 *u;
    bench_check(ctx, tz_energy_exemplar_init(ctx, &x, from, &p));
    bench_check(ctx, tz_energy_state_init(ctx, &t, &x, out, &p));
    bench_check(ctx, tz_energy_search(&t, 0, &e));
    bench_check(ctx, tz_alloc(ctx, &u, (size_t)t.n, sizeof *u));
    bench_check(ctx, tz_alloc(ctx, &y, (size_t)t.n * 2, sizeof *y));
    const double t0 = bench_now();
    bench_check(ctx, tz_energy_fit(&t, 1e-8, u));
    const double t1 = bench_now();
    bench_check(ctx, tz_lsq_new(ctx, t.n, 2, &l));
    for (int32_t o = 0; o < t.n; o++) {
        const double none[2] = {0, 0}, one = 1;
        bench_check(ctx, tz_lsq_add(l, 1, &o, &one, none, sqrt(TZ_ENERGY_ANCHOR)));
        for (int32_t j = 0; j < t.count[o]; j++) {
            const int32_t at = o * TZ_ENERGY_NEAR + j, index[2] = {t.near[at], o};
            const double c[2] = {1, -1};
            const double b[2] = {(double)t.pull[at].x, (double)t.pull[at].y};
            if (t.pair[at] >= 0)
                bench_check(ctx, tz_lsq_add(l, 2, index, c, b, 1));
        }
    }
    bench_check(ctx, tz_lsq_solve(l, y));
    const double t2 = bench_now();
    for (int32_t o = 0; o < t.n; o++)
        worst = fmax(worst, hypot(y[o] - u[o].x, y[t.n + o] - u[o].y));
    printf("fit %6d unknowns: %8.2f ms, CHOLMOD %8.2f ms, apart by %.1e of a spacing\n",
           t.n, (t1 - t0) * 1e3, (t2 - t1) * 1e3, worst / x.spacing);
    tz_lsq_free(l);
    tz_free(ctx, u);
    tz_free(ctx, y);
    tz_energy_state_deinit(&t);
    tz_energy_exemplar_deinit(&x);
}

static void run(int32_t wanted, pattern pattern, const char *name, int threads, bool both)
{
    tz_ctx *ctx = bench_ctx(threads);
    const double side = 10 * sqrt((double)wanted);
    tz_element_set from, out = {.domain = {.size = {side, side, 0}, .torus = true}};
    tz_energy_params p;
    clock_hook c = {.n = 0};
    double step[64], energy[32];
    tz_params_default(&tz_energy_param_table, &p);
    bench_check(ctx, pattern_make(ctx, &from, pattern,
                                  (tz_domain){.size = {160, 160, 0}, .torus = false}, 5));
    p.iterations = 0;
    bench_check(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, NULL)); /* the start */
    if (both)
        solvers(ctx, &from, &out);
    p.iterations = 10;
    p.start = TZ_ENERGY_GIVEN;
    const tz_energy_hook hook = {.after = note, .user = &c};
    const double t0 = bench_now(), cpu = bench_cpu();
    bench_check(ctx, tz_energy_solve(ctx, &from, &p, &out, &hook, energy));
    const double all = bench_now() - t0, used = bench_cpu() - cpu;
    for (int i = 1; i < c.n; i++)
        step[i - 1] = (c.at[i] - c.at[i - 1]) * 1e3;
    printf("energy %s %6d elements, %d threads: %8.2f ms an iteration, all %8.2f ms, "
           "processor %8.2f ms an iteration, memory %.0f MiB (resident %.0f)\n",
           name, out.element.n, tz_ctx_threads(ctx), bench_median(step, c.n - 1),
           all * 1e3, used * 1e3 / 11, (double)tz_ctx_memory_peak(ctx) / 1048576,
           bench_peak());
    tz_element_set_deinit(&from);
    tz_element_set_deinit(&out);
    tz_ctx_free(ctx);
}

/* A disc, frames that turn about its middle, elements that come and go. */
static void run_guided(int32_t wanted, int threads)
{
    tz_ctx *ctx = bench_ctx(threads);
    enum { N = 256 };
    const double side = 10 * sqrt(wanted / 0.7);
    const tz_domain d = {.size = {side, side, 0}, .torus = false};
    tz_element_set from, out = {.domain = d};
    tz_energy_params p;
    clock_hook c = {.n = 0};
    double step[64];
    float *mask;
    tz_region *region;
    tz_frames *frames;
    tz_params_default(&tz_energy_param_table, &p);
    p.existence = true;
    bench_check(ctx, tz_alloc(ctx, &mask, N * N, sizeof *mask));
    for (int32_t i = 0; i < N * N; i++)
        mask[i] = hypot(i % N + 0.5 - N / 2, i / N + 0.5 - N / 2) < 0.472 * N;
    const double t0 = bench_now();
    bench_check(ctx, tz_region_from_mask(ctx, mask, N, N, d.size, false, &region));
    const double t1 = bench_now();
    bench_check(ctx, tz_frames_from_formula(ctx, "atan2(y-h/2, x-w/2)*180/pi", d.size,
                                            false, &frames));
    const double t2 = bench_now();
    out.domain.region = region, out.domain.frames = frames;
    bench_check(ctx, pattern_make(ctx, &from, PATTERN_JITTER,
                                  (tz_domain){.size = {160, 160, 0}, .torus = false}, 5));
    const tz_energy_hook hook = {.after = note, .user = &c};
    const double cpu = bench_cpu();
    bench_check(ctx, tz_energy_solve(ctx, &from, &p, &out, &hook, NULL));
    const double used = bench_cpu() - cpu, all = bench_now() - t2;
    for (int i = 1; i < c.n; i++)
        step[i - 1] = (c.at[i] - c.at[i - 1]) * 1e3;
    printf("energy guided %6d elements, %d threads: %8.2f ms an iteration, all %8.2f ms, "
           "processor %8.2f ms an iteration; region of %d x %d %.2f ms, frames %.2f ms\n",
           out.element.n, tz_ctx_threads(ctx), bench_median(step, c.n - 1), all * 1e3,
           used * 1e3 / 11, N, N, (t1 - t0) * 1e3, (t2 - t1) * 1e3);
    tz_element_set_deinit(&from);
    tz_element_set_deinit(&out);
    tz_region_free(region);
    tz_frames_free(frames);
    tz_free(ctx, mask);
    tz_ctx_free(ctx);
}

int main(int argc, char **argv)
{
    const int threads = argc > 1 ? atoi(argv[1]) : 0;
    static const int32_t sizes[] = {1000, 10000, 100000};
    for (int k = 0; k < 3; k++) {
        run(sizes[k], PATTERN_SQUARE, "lattice", threads, true);
        run(sizes[k], PATTERN_JITTER, "stochastic", threads, false);
        run(sizes[k], PATTERN_MIXED, "two-class", threads, false);
        run_guided(sizes[k], threads);
    }
    return 0;
}
