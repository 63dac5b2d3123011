/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Curve textures by optimisation: time by level and by step, neighbourhoods, and energy,
 * for the paper's count of samples (1,300 at the finest level) in neighbourhoods as large as
 * the paper's, and, at the scale that is chosen for the drawing, for 1,300 to 20,000 samples:
 * whether time is linear in samples, and what a second thread brings.
 *
 *   bench_curve_synthesis DRAWING.svg...   the first as large as the paper's example, the
 *                                          others growing; a single one both
 *
 * @source [Tu20] App. C: 160 s for 750, 1,000, 1,300 samples at three levels of about 7
 *   iterations, neighbourhoods of 30, 30, 20 samples, on 16 cores */
#include "tests/bench/bench.h"

#include <math.h>

#include "curves/curve_io.h"
#include "curves/synthesis.h"

enum { RUNS = 3, TRIES = 4 };
#define PAPER_SAMPLES    1300.0
#define PAPER_SECONDS    160.0
#define PAPER_NEIGHBOURS 26.0 /* 30, 30, 20 */

typedef struct level {
    double search, assign, energy, neighbours;
    int32_t samples;
} level;

typedef struct watch {
    level level[TZ_SAMPLE_LEVELS];
    double all, cpu;
    int32_t samples; /* of the result: inside the domain */
} watch;

static void trace(void *user, const tz_curve_energy *e, const tz_sample_graph *g)
{
    level *l = &((watch *)user)->level[e->level];
    (void)g;
    l->search += e->search;
    l->assign += e->assign;
    l->energy = e->mean;
    l->neighbours = e->neighbours;
    l->samples = e->samples;
}

/* In a domain of `times` exemplars a side, with spacings and radii of `scale`. */
static watch synthesise(const tz_curve_set *set, double times, double scale, int threads)
{
    tz_curve_synthesis_params p;
    tz_ctx *ctx = bench_ctx(threads);
    const tz_domain d = {
        .size = {times * set->domain.size.x, times * set->domain.size.y, 0}};
    watch w = {.samples = 0};
    tz_sample_graph out;
    tz_params_default(&tz_curve_synthesis_param_table, &p);
    p.scale = scale;
    const tz_curve_synthesis_job job = {.exemplar = set,
                                        .domain = &d,
                                        .params = &p,
                                        .seed = 1,
                                        .trace = trace,
                                        .user = &w};
    const double begun = bench_now(), cpu = bench_cpu();
    bench_check(ctx, tz_curve_synthesis(ctx, &job, &out, NULL, NULL));
    w.all = bench_now() - begun;
    w.cpu = bench_cpu() - cpu;
    w.samples = out.sample.n;
    tz_sample_graph_deinit(&out);
    tz_ctx_free(ctx);
    return w;
}

/* How large samples and domains are. */
typedef struct setting {
    double times; /* the domain's side, in exemplars */
    double scale; /* of spacings and radii against those chosen for the exemplar */
} setting;

static double mean_neighbours(const watch *w)
{
    double sum = 0;
    for (int i = 0; i < TZ_SAMPLE_LEVELS; i++)
        sum += w->level[i].neighbours;
    return sum / TZ_SAMPLE_LEVELS;
}

/* The setting that gives about so many samples at the finest level, the margin's among
 * them, in neighbourhoods of about so many, on average over levels; 0 = of the usual size.
 * Neighbours grow with the scale, samples with the domain over the scale. */
static setting setting_for(const tz_curve_set *set, double samples, double neighbours)
{
    setting s = {.times = 1, .scale = 1};
    for (int i = 0; i < TRIES; i++) {
        const watch w = synthesise(set, s.times, s.scale, 2);
        const double n = fmax(w.level[TZ_SAMPLE_LEVELS - 1].samples, 1),
                     more =
                         neighbours > 0 ? neighbours / fmax(mean_neighbours(&w), 1) : 1,
                     scale = fmin(fmax(s.scale * more, 0.1), 10);
        s.times = fmin(fmax(s.times * sqrt(samples / n * scale / s.scale), 0.2), 100);
        s.scale = scale;
    }
    return s;
}

/* The run of median time. */
static watch median(const tz_curve_set *set, setting s, int threads)
{
    watch w[RUNS];
    for (int i = 0; i < RUNS; i++)
        w[i] = synthesise(set, s.times, s.scale, threads);
    for (int i = 0; i < RUNS; i++)
        for (int k = i + 1; k < RUNS; k++)
            if (w[k].all < w[i].all) {
                const watch v = w[i];
                w[i] = w[k];
                w[k] = v;
            }
    return w[RUNS / 2];
}

static void print(const char *name, setting s, int threads, const watch *w)
{
    const level *l = w->level;
    double search = 0, assign = 0;
    for (int i = 0; i < TZ_SAMPLE_LEVELS; i++) {
        search += l[i].search;
        assign += l[i].assign;
    }
    printf(
        "curves synthesis %-26s x%.2f threads %d  scale %.2f  samples %5d %5d %5d  "
        "neighbours %4.1f "
        "%4.1f %4.1f  energy %5.2f %5.2f %5.2f  levels %.3f %.3f %.3f s  search %.3f s  "
        "assign %.3f s  all %.3f s  cpu %.3f s  %.3f ms cpu a sample\n",
        name, s.times, threads, s.scale, l[0].samples, l[1].samples, l[2].samples,
        l[0].neighbours, l[1].neighbours, l[2].neighbours, l[0].energy, l[1].energy,
        l[2].energy, l[0].search + l[0].assign, l[1].search + l[1].assign,
        l[2].search + l[2].assign, search, assign, w->all, w->cpu,
        1000 * w->cpu / (l[2].samples > 0 ? l[2].samples : 1));
}

/* As large as the paper's example, on one thread and on two. */
static void bench_paper(const char *name, const tz_curve_set *set)
{
    const setting s = setting_for(set, PAPER_SAMPLES, PAPER_NEIGHBOURS);
    watch w = {.samples = 0};
    for (int threads = 1; threads <= 2; threads++) {
        w = median(set, s, threads);
        print(name, s, threads, &w);
    }
    printf("curves synthesis %-26s goal 1 s on 2 cores for %d, %d, %d samples with %.1f "
           "neighbours on average: %.2f s (%.2f s of processors), %s; paper %.0f s on 16 "
           "cores, %.0f times as long\n",
           name, w.level[0].samples, w.level[1].samples, w.level[2].samples,
           mean_neighbours(&w), w.all, w.cpu, w.all <= 1 ? "met" : "MISSED",
           PAPER_SECONDS, PAPER_SECONDS / w.all);
}

/* 5,000 to 20,000 samples of the usual scale. */
static void grow(const char *name, const tz_curve_set *set, setting s, double one)
{
    double n = PAPER_SAMPLES;
    for (double wanted = 5000; wanted <= 20000; wanted *= 2) {
        s.times *= sqrt(wanted / n);
        const watch w = synthesise(set, s.times, s.scale, 2);
        print(name, s, 2, &w);
        n = fmax(w.level[TZ_SAMPLE_LEVELS - 1].samples, 1);
        if (wanted < 20000)
            continue;
        printf("curves synthesis %-26s goal 30 s for 20,000 samples: %s; %.2f times the "
               "processor time a sample of the smallest\n",
               name, w.all <= 30 ? "met" : "MISSED", w.cpu / n / (one > 0 ? one : 1));
    }
}

/* Time against samples, at the scale that is chosen for the drawing. */
static void bench_growth(const char *name, const tz_curve_set *set)
{
    const setting usual = setting_for(set, PAPER_SAMPLES, 0);
    const watch w = median(set, usual, 2);
    print(name, usual, 2, &w);
    grow(name, set, usual, w.cpu / fmax(w.level[TZ_SAMPLE_LEVELS - 1].samples, 1));
}

int main(int argc, char **argv)
{
    if (argc < 2) {
        fprintf(stderr, "use: bench_curve_synthesis DRAWING.svg...\n");
        return 2;
    }
    for (int i = 1; i < argc; i++) {
        const char *name = strrchr(argv[i], '/') ? strrchr(argv[i], '/') + 1 : argv[i];
        tz_ctx *ctx = bench_ctx(1);
        tz_curve_set set;
        bench_check(ctx, tz_curve_read_svg(ctx, argv[i], NULL, &set));
        if (i == 1)
            bench_paper(name, &set);
        if (i > 1 || argc == 2)
            bench_growth(name, &set);
        fflush(stdout);
        tz_curve_set_deinit(&set);
        tz_ctx_free(ctx);
    }
    return 0;
}
