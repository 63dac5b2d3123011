/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Arranging alone, at one thread and at two.
 *
 *   bench_arrange PHOTO [SIDE [RUNS]]
 *
 * prints lines: arrange NAME SIDE THREADS PLACEMENTS SECONDS CPU PEAK_MIB */
#include "synthesis/arrange.h"
#include "tests/bench/bench.h"

enum { RUNS_MAX = 99 };

static void measure(const char *path, int32_t side, int threads, int runs)
{
    double wall[RUNS_MAX], cpu[RUNS_MAX];
    int32_t placed = 0;
    tz_ctx *ctx = bench_ctx(threads);
    tz_image photo = bench_photo(ctx, path, 0);
    tz_ebpt_params ep;
    tz_arrange_params ap;
    tz_ebpt e = {0};
    memset(&ep, 0, sizeof ep);
    memset(&ap, 0, sizeof ap);
    tz_params_default(&tz_ebpt_param_table, &ep);
    tz_params_default(&tz_arrange_param_table, &ap);
    ap.size[0] = ap.size[1] = side;
    bench_check(ctx, tz_ebpt_analyze(ctx, &photo, &ep, &e));
    const tz_exemplar ex = {&photo, &e, path, ""};
    for (int k = 0; k < runs; k++) {
        tz_layout l = {0};
        const double start = bench_now(), used = bench_cpu();
        bench_check(ctx, tz_arrange(ctx, &ex, 1, NULL, &ap, &l));
        wall[k] = bench_now() - start;
        cpu[k] = bench_cpu() - used;
        placed = l.place.n;
        tz_layout_deinit(&l);
    }
    const char *name = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    printf("arrange %s %d %d %d %.4f %.4f %.0f\n", name, (int)side, threads, (int)placed,
           bench_median(wall, runs), bench_median(cpu, runs), bench_peak());
    tz_ebpt_deinit(&e);
    tz_image_deinit(&photo);
    tz_ctx_free(ctx);
}

int main(int argc, char **argv)
{
    if (argc < 2) {
        fprintf(stderr, "use: bench_arrange PHOTO [SIDE [RUNS]]\n");
        return 2;
    }
    const int32_t side = argc > 2 ? atoi(argv[2]) : 2048;
    int runs = argc > 3 ? atoi(argv[3]) : 5;
    runs = runs < 1 ? 1 : runs > RUNS_MAX ? RUNS_MAX : runs;
    for (int threads = 1; threads <= 2; threads++)
        measure(argv[1], side, threads, runs);
    return 0;
}
