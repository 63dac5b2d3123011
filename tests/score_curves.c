/* SPDX-License-Identifier: Apache-2.0 */
/* Likeness of curves on one line for each pair.
 *
 *   score_curves [--crossings] EXEMPLAR.svg LAYOUT.svg [EXEMPLAR.svg LAYOUT.svg ...]
 *
 * Exemplars are trimmed as by the commands. Prints mean ratio, ratio of length per area, dangling ends per length of both, by how
 * much degrees are off, each ratio, the share of verbatim repeats of both, and seconds. */
#include "curves/curve_compare.h"
#include "curves/curve_io.h"
#include "curves/trim.h"
#include "tests/bench/bench.h"

static const char *name_of(const char *path)
{
    return strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
}

int main(int argc, char **argv)
{
    const int first = argc > 1 && strcmp(argv[1], "--crossings") == 0 ? 2 : 1;
    const tz_curve_read_options read = {.crossings = first == 2};
    tz_ctx *ctx = bench_ctx(0);
    if (argc < first + 2 || (argc - first) % 2) {
        fprintf(stderr, "use: score_curves EXEMPLAR.svg LAYOUT.svg ...\n");
        return 2;
    }
    for (int i = first; i + 1 < argc; i += 2) {
        tz_curve_set whole, a, b;
        tz_curve_likeness q;
        bench_check(ctx, tz_curve_read_svg(ctx, argv[i], &read, &whole));
        bench_check(ctx, tz_curve_trim(ctx, &whole, &a, NULL));
        bench_check(ctx, tz_curve_read_svg(ctx, argv[i + 1], &read, &b));
        const double start = bench_now();
        bench_check(ctx, tz_curve_compare(ctx, &a, &b, &q));
        printf("%-28s mean %5.2f  length %5.3f  dangling %7.5f %7.5f  degree_off %5.3f  "
               "| degrees %5.2f ends %5.2f edges %5.2f turning %5.2f orientation %5.2f "
               "density %5.2f cells %5.2f patches %5.2f | repeats %5.3f %5.3f  %5.2f s\n",
               name_of(argv[i + 1]), q.mean, q.length[1] / q.length[0], q.dangling[0],
               q.dangling[1], q.degree_off, q.degrees, q.ends, q.edges, q.turning,
               q.orientation, q.density, q.cells, q.patches, q.repeats_own, q.repeats,
               bench_now() - start);
        tz_curve_set_deinit(&whole);
        tz_curve_set_deinit(&a);
        tz_curve_set_deinit(&b);
    }
    tz_ctx_free(ctx);
    return 0;
}
