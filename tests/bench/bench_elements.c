/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Region growing of elements, on one thread.
 *
 *   bench_elements [RUNS]
 *
 * prints lines: grow EXEMPLAR SOURCES RINGS OPTIMISE ELEMENTS BEGIN_SECONDS SECONDS
 * ELEMENTS_PER_SECOND */
#include "elements/growth.h"
#include "tests/bench/bench.h"
#include "tests/support/elements.h"

enum { RUNS_MAX = 99 };

static void measure(tz_ctx *ctx, const char *name, const tz_element_set *ex,
                    int32_t rings, int32_t optimise, int runs)
{
    static const char *const how[] = {"none", "local", "global"};
    double begin[RUNS_MAX], grow[RUNS_MAX];
    int32_t n = 0;
    /* so large that some 10,000 elements fit */
    const double scale = sqrt(10000.0 / ex->element.n);
    const tz_domain d = {
        .size = {ex->domain.size.x * scale, ex->domain.size.y * scale, 0},
        .torus = false};
    tz_growth_params p;
    memset(&p, 0, sizeof p);
    tz_params_default(&tz_growth_param_table, &p);
    p.rings = rings;
    p.optimise = optimise;
    for (int k = 0; k < runs; k++) {
        tz_element_set out;
        tz_growth *g = NULL;
        bool more = true;
        bench_check(ctx, tz_element_set_like(ctx, ex, &d, &out));
        const double start = bench_cpu();
        bench_check(ctx, tz_growth_begin(ctx, ex, &p, &out, &g));
        begin[k] = bench_cpu() - start;
        while (more)
            bench_check(ctx, tz_growth_step(g, 1000, &more));
        grow[k] = bench_cpu() - start - begin[k];
        n = out.element.n;
        tz_growth_end(g);
        tz_element_set_deinit(&out);
    }
    const double seconds = bench_median(grow, runs);
    printf("grow %s %d %d %s %d %.4f %.4f %.0f\n", name, (int)ex->element.n, (int)rings,
           how[optimise], (int)n, bench_median(begin, runs), seconds, n / seconds);
}

int main(int argc, char **argv)
{
    int runs = argc > 1 ? atoi(argv[1]) : 5;
    runs = runs < 1 ? 1 : runs > RUNS_MAX ? RUNS_MAX : runs;
    tz_ctx *ctx = bench_ctx(1);
    tz_element_set ex;
    bench_check(ctx, drawn_hexagons(ctx, 9, 9, 0, false, &ex));
    measure(ctx, "hexagonal", &ex, 2, TZ_GROWTH_NONE, runs);
    measure(ctx, "hexagonal", &ex, 2, TZ_GROWTH_LOCAL, runs);
    tz_element_set_deinit(&ex);
    bench_check(ctx, drawn_darts(ctx, 163, 8, 300, 1, false, &ex));
    measure(ctx, "stochastic", &ex, 2, TZ_GROWTH_NONE, runs);
    measure(ctx, "stochastic", &ex, 2, TZ_GROWTH_LOCAL, runs);
    tz_element_set_deinit(&ex);
    bench_check(ctx, drawn_mosaic(ctx, 1000, &ex));
    measure(ctx, "mosaic", &ex, 3, TZ_GROWTH_LOCAL, runs);
    tz_element_set_deinit(&ex);
    tz_ctx_free(ctx);
    return 0;
}
