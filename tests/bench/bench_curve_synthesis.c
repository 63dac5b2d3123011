/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Curve textures by optimisation: time and energy by level, for domains of 2 x 2 exemplars
 * and of as many as give about 20,000 samples, on one thread and on all.
 *
 *   bench_curve_synthesis DRAWING.svg...
 *
 * @source [Tu20] App. C: 160 s for 750, 1,000, 1,300 samples at three levels of about 7
 *   iterations, neighbourhoods of 30, 30, 20 samples, on 16 cores */
#include "tests/bench/bench.h"

#include <math.h>

#include "curves/curve_io.h"
#include "curves/synthesis.h"

typedef struct watch {
    double begun, level[TZ_SAMPLE_LEVELS];
    double energy[TZ_SAMPLE_LEVELS];
    int32_t samples[TZ_SAMPLE_LEVELS];
} watch;

static void trace(void *user, const tz_curve_energy *e, const tz_sample_graph *g)
{
    watch *w = user;
    (void)g;
    w->level[e->level] = bench_now() - w->begun;
    w->energy[e->level] = e->mean;
    w->samples[e->level] = e->samples;
}

/* @return samples of the finest level */
static int32_t synthesise(const char *name, const tz_curve_set *set, double times,
                          int threads)
{
    tz_ctx *ctx = bench_ctx(threads);
    const tz_domain d = {
        .size = {times * set->domain.size.x, times * set->domain.size.y, 0}};
    watch w = {.begun = bench_now()};
    const double cpu = bench_cpu();
    tz_sample_graph out;
    const tz_curve_synthesis_job job = {
        .exemplar = set, .domain = &d, .seed = 1, .trace = trace, .user = &w};
    bench_check(ctx, tz_curve_synthesis(ctx, &job, &out, NULL, NULL));
    const double all = bench_now() - w.begun;
    printf(
        "curves synthesis %-26s x%.1f threads %d  samples %d %d %d  energy %.2f %.2f %.2f"
        "  levels %.3f %.3f %.3f s  all %.3f s  cpu %.3f s  %.0f samples/s\n",
        name, times, threads, w.samples[0], w.samples[1], w.samples[2], w.energy[0],
        w.energy[1], w.energy[2], w.level[0], w.level[1] - w.level[0],
        w.level[2] - w.level[1], all, bench_cpu() - cpu, w.samples[2] / all);
    tz_sample_graph_deinit(&out);
    tz_ctx_free(ctx);
    return w.samples[2];
}

int main(int argc, char **argv)
{
    for (int i = 1; i < argc; i++) {
        const char *name = strrchr(argv[i], '/') ? strrchr(argv[i], '/') + 1 : argv[i];
        tz_ctx *ctx = bench_ctx(1);
        tz_curve_set set;
        bench_check(ctx, tz_curve_read_svg(ctx, argv[i], NULL, &set));
        const int32_t n = synthesise(name, &set, 2, 1);
        synthesise(name, &set, 2, 2);
        synthesise(name, &set, 2 * sqrt(20000.0 / (n > 0 ? n : 1)), 2);
        tz_curve_set_deinit(&set);
        tz_ctx_free(ctx);
    }
    return 0;
}
