/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The energy solver: one iteration at 1,000, 10,000 and 100,000 elements of one sample,
 * memory, and the least squares alone beside CHOLMOD's on the same equations; with a
 * region, frames and existence; elements of several samples; preparing of exemplars, and
 * how near what it finds alike is to the most alike there is. Drawings given as arguments
 * after the count of threads: time, likeness and energies of these.
 * @source [Ma11] Sec. 6.2: 5 s an iteration at 1,000 elements */
#include "base/lsq.h"
#include "elements/element_io.h"
#include "elements/energy_internal.h"
#include "tests/bench/bench.h"
#include "tests/elements/patterns.h"

typedef struct clock_hook {
    double at[64], used[64]; /* wall and processor */
    int n;
} clock_hook;

static tz_status note(void *user, tz_element_set *set, int32_t iteration, double energy)
{
    (void)set, (void)iteration, (void)energy;
    clock_hook *c = user;
    c->used[c->n] = bench_cpu();
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

/* Each iteration's times, wall and processor. */
static double least(const double *v, int n)
{
    double m = INFINITY;
    for (int i = 1; i < n; i++)
        m = fmin(m, v[i] - v[i - 1]);
    return m * 1e3;
}

/* Iterations on what the start gave; the best of all counts, others work here too. */
static void iterate(tz_ctx *ctx, const tz_element_set *from, tz_element_set *out,
                    const char *name)
{
    tz_energy_params p;
    clock_hook c = {.n = 0};
    double step[64];
    tz_params_default(&tz_energy_param_table, &p);
    p.iterations = 20;
    p.start = TZ_ENERGY_GIVEN;
    const tz_energy_hook hook = {.after = note, .user = &c};
    bench_check(ctx, tz_energy_solve(ctx, from, &p, out, &hook, NULL));
    const double wall = least(c.at, c.n), processor = least(c.used, c.n);
    for (int i = 1; i < c.n; i++)
        step[i - 1] = (c.at[i] - c.at[i - 1]) * 1e3;
    printf("energy %-10s %6d elements, %6d samples, %d threads: best %8.2f ms an "
           "iteration (median %8.2f), processor %8.2f ms, memory %.0f MiB (resident "
           "%.0f)\n",
           name, out->element.n, out->sample.n, tz_ctx_threads(ctx), wall,
           bench_median(step, c.n - 1), processor,
           (double)tz_ctx_memory_peak(ctx) / 1048576, bench_peak());
}

static void run(int32_t wanted, pattern pattern, const char *name, int threads, bool both)
{
    tz_ctx *ctx = bench_ctx(threads);
    const double side = 10 * sqrt((double)wanted);
    tz_element_set from, out = {.domain = {.size = {side, side, 0}, .torus = true}};
    tz_energy_params p;
    tz_params_default(&tz_energy_param_table, &p);
    bench_check(ctx, pattern_make(ctx, &from, pattern,
                                  (tz_domain){.size = {160, 160, 0}, .torus = false}, 5));
    p.iterations = 0;
    bench_check(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, NULL)); /* the start */
    if (both)
        solvers(ctx, &from, &out);
    iterate(ctx, &from, &out, name);
    tz_element_set_deinit(&from);
    tz_element_set_deinit(&out);
    tz_ctx_free(ctx);
}

/* ---- preparing ------------------------------------------------------------------- */

/* Sticks of some samples, at random but for their spacing. */
static void make_sticks(tz_ctx *ctx, int32_t n, int32_t samples, tz_element_set *s)
{
    const int32_t side = (int32_t)sqrt((double)n);
    const tz_domain d = {.size = {10.0 * side, 10.0 * side, 0}, .torus = false};
    tz_element_set dots;
    bench_check(ctx, pattern_make(ctx, &dots, PATTERN_MIXED, d, 5));
    bench_check(ctx, tz_element_set_like(ctx, &dots, &d, s));
    for (int32_t i = 0; i < dots.element.n; i++) {
        tz_rng r = tz_rng_make(9, (uint64_t)i);
        tz_element e = dots.element.v[i];
        e.angle = samples > 1 ? tz_rng_range(&r, 0, 2 * TZ_PI) : 0;
        e.sample = s->sample.n, e.samples = samples;
        for (int32_t k = 0; k < samples; k++) {
            const double along = samples > 1 ? 6.0 * k / (samples - 1) - 3 : 0;
            const tz_sample q = {
                .at = {e.at.x + along * cos(e.angle), e.at.y + along * sin(e.angle), 0},
                .id = k,
                .weight = 1};
            bench_check(ctx, tz_array_push(ctx, &s->sample, q));
        }
        bench_check(ctx, tz_array_push(ctx, &s->element, e));
    }
    tz_element_set_deinit(&dots);
}

static float distance(const tz_energy_exemplar *x, int32_t k, int32_t other, float enough)
{
    static tz_pairing w;
    tz_pairing_side wanted = x->side[k];
    wanted.n = 0;
    for (int32_t j = 0; j < x->side[k].n; j++)
        if (tz_energy_within(x, k, j)) {
            const int32_t to = wanted.n++;
            wanted.x[to] = wanted.x[j], wanted.y[to] = wanted.y[j];
            wanted.a[to] = wanted.a[j], wanted.b[to] = wanted.b[j];
            wanted.l[to] = wanted.l[j];
        }
    tz_pairing_sort(&wanted, NULL);
    w.attributes = x->attributes, w.limit = (float)(x->limit * x->limit), w.weight = NULL;
    return tz_pairing_best(&w, &wanted, &x->side[other], enough);
}

/* How much farther the found alike ones are than the most alike of all; and of some
 * hundred samples, in how many the very nearest was found. */
static void likeness(const tz_energy_exemplar *x, double *farther, double *hit)
{
    const int32_t step = x->n / 300 + 1;
    double found = 0, there = 0;
    int32_t hits = 0, tried = 0;
    for (int32_t k = 0; k < x->n; k += step) {
        const int32_t l = x->label[k];
        float best = INFINITY;
        for (int32_t i = x->label_first[l]; i < x->label_first[l + 1]; i++)
            if (x->by_label[i] != k)
                best = fminf(best, distance(x, k, x->by_label[i], best));
        const int32_t first = x->similar[(ptrdiff_t)k * x->coherent];
        if (first < 0 || !isfinite(best))
            continue;
        const float mine = distance(x, k, first, INFINITY);
        found += (double)mine, there += (double)best;
        hits += mine <= best * 1.0001f, tried++;
    }
    *farther = there > 0 ? found / there : 1;
    *hit = tried ? 100.0 * hits / tried : 100;
}

static void prepare(tz_ctx *ctx, const tz_element_set *set, const char *name)
{
    tz_energy_params p;
    tz_energy_exemplar x;
    double wall = INFINITY, used = INFINITY, farther, hit;
    tz_params_default(&tz_energy_param_table, &p);
    for (int k = 0; k < 3; k++) {
        const double t0 = bench_now(), c0 = bench_cpu();
        bench_check(ctx, tz_energy_exemplar_init(ctx, &x, set, &p));
        wall = fmin(wall, bench_now() - t0), used = fmin(used, bench_cpu() - c0);
        if (k < 2)
            tz_energy_exemplar_deinit(&x);
    }
    likeness(&x, &farther, &hit);
    printf("prepare %-24s %5d elements, %5d samples: best %8.2f ms, processor %8.2f ms; "
           "nearest found %3.0f %%, cost of found / nearest %.3f\n",
           name, set->element.n, x.n, wall * 1e3, used * 1e3, hit, farther);
    tz_energy_exemplar_deinit(&x);
}

static void run_drawing(const char *path, int threads)
{
    tz_ctx *ctx = bench_ctx(threads);
    const char *slash = strrchr(path, '/');
    const char *name = slash ? slash + 1 : path;
    tz_element_set from;
    tz_energy_params p;
    double energy[11], sum[2] = {0, 0};
    bench_check(ctx, tz_element_read_svg(ctx, path, NULL, &from));
    prepare(ctx, &from, name);
    tz_params_default(&tz_energy_param_table, &p);
    for (int noise = 0; noise < 2; noise++)
        for (p.seed = 1; p.seed <= 3; p.seed++) {
            const tz_vec3 size = from.domain.size;
            tz_element_set out = {
                .domain = {.size = {1.5 * size.x, 1.5 * size.y, 0}, .torus = true}};
            p.start = noise ? TZ_ENERGY_NOISE : TZ_ENERGY_PATCHES;
            bench_check(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, energy));
            const double spacing = tz_energy_spacing(&from);
            sum[noise] += energy[10] / (out.sample.n * spacing * spacing) / 3;
            tz_element_set_deinit(&out);
        }
    printf("energy  %-24s of a sample in squared spacings: from patches %.4f, from noise "
           "%.4f\n",
           name, sum[0], sum[1]);
    tz_element_set_deinit(&from);
    tz_ctx_free(ctx);
}

static void run_sticks(int32_t n, int32_t samples, int threads)
{
    tz_ctx *ctx = bench_ctx(threads);
    tz_element_set s;
    make_sticks(ctx, n, samples, &s);
    prepare(ctx, &s, samples > 1 ? "sticks" : "dots");
    tz_element_set_deinit(&s);
    tz_ctx_free(ctx);
}

/* As many samples, in elements of one or of several. */
static void run_samples(int32_t samples, int threads)
{
    tz_ctx *ctx = bench_ctx(threads);
    tz_element_set from;
    tz_energy_params p;
    make_sticks(ctx, 256, samples, &from);
    const double side = 10 * sqrt(4000.0 / samples);
    tz_element_set out = {.domain = {.size = {side, side, 0}, .torus = true}};
    tz_params_default(&tz_energy_param_table, &p);
    p.iterations = 0;
    bench_check(ctx, tz_energy_solve(ctx, &from, &p, &out, NULL, NULL));
    iterate(ctx, &from, &out, samples > 1 ? "sticks" : "dots");
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
    static const int32_t sizes[] = {1000, 10000, 100000}, some[] = {250, 1000, 4000};
    setvbuf(stdout, NULL, _IOLBF, 0);
    for (int k = 2; k < argc; k++)
        run_drawing(argv[k], threads);
    if (argc > 2)
        return 0;
    for (int k = 0; k < 3; k++) {
        run(sizes[k], PATTERN_SQUARE, "lattice", threads, k < 2); /* CHOLMOD is slow */
        run(sizes[k], PATTERN_JITTER, "stochastic", threads, false);
        run(sizes[k], PATTERN_MIXED, "two-class", threads, false);
        run_guided(sizes[k], threads);
    }
    for (int k = 0; k < 6; k++)
        run_sticks(some[k % 3], k < 3 ? 1 : 5, threads);
    for (int32_t k = 1; k <= 10; k += k == 1 ? 4 : 5)
        run_samples(k, threads);
    return 0;
}
