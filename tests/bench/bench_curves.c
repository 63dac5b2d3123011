/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Curve textures: reading, sampling, reconstruction, and neighbourhood matches a second.
 * The output that is matched is the exemplar moved about a little, with one sample in
 * twenty gone, as it is between two steps of synthesis.
 *
 *   bench_curves DRAWING.svg...
 *
 * @source [Tu20] App. C: matching is what takes the time; 20 to 30 neighbours */
#include "tests/bench/bench.h"

#include "curves/curve_io.h"
#include "curves/matching.h"
#include "curves/reconstruct.h"

/* The graph shaken: samples moved, some without their edges. */
static tz_sample_graph shake(tz_ctx *ctx, const tz_curve_set *set, double spacing,
                             double radius)
{
    tz_sample_graph g;
    tz_rng r = tz_rng_make(1, 1);
    bench_check(ctx, tz_sample_graph_make(ctx, set, spacing, radius, &g));
    for (int32_t i = 0; i < g.sample.n; i++) {
        g.sample.v[i].at.x += 0.15 * spacing * tz_rng_normal(&r);
        g.sample.v[i].at.y += 0.15 * spacing * tz_rng_normal(&r);
    }
    int32_t n = 0;
    for (int32_t i = 0; i < g.edge.n; i++)
        if (tz_rng_below(&r, 20) > 0)
            g.edge.v[n++] = g.edge.v[i];
    g.edge.n = n;
    bench_check(ctx, tz_sample_graph_link(&g));
    return g;
}

/* Candidates of a sample: itself, and any; how many matches a second. */
static void matches(tz_ctx *ctx, const char *name, const tz_sample_graph *o,
                    const tz_sample_graph *g, bool prune, bool warm)
{
    static tz_assign w;
    tz_matcher m;
    tz_rng r = tz_rng_make(2, 1);
    double sum = 0, rows = 0;
    const double t0 = bench_now();
    bench_check(ctx, tz_matcher_init(ctx, o, g, NULL, &m));
    const double t1 = bench_now();
    int64_t n = 0;
    double at = t1;
    for (int round = 0; at - t1 < 0.5; round++) {
        for (int32_t so = 0; so < o->sample.n; so++) {
            float best = INFINITY;
            for (int k = 0; k < 10; k++, n++) {
                const int32_t si = warm || k == 0 ? so : tz_rng_below(&r, g->sample.n);
                const float c =
                    tz_match(&m, so, si, &w, warm && k > 0, prune ? best : INFINITY);
                best = c < best && !warm ? c : best;
                sum += best < INFINITY ? (double)best : 0;
                rows += w.rows;
            }
        }
        at = bench_now();
    }
    printf("curves match %-26s %-14s %4d x %4d samples %4.1f neighbours  table %6.2f ms  "
           "%9.0f matches/s\n",
           name,
           warm    ? "same,warm"
           : prune ? "pruned"
                   : "unpruned",
           o->sample.n, g->sample.n, rows / (double)n, 1e3 * (t1 - t0),
           (double)n / (at - t1));
    tz_matcher_deinit(&m);
    if (sum < 0)
        printf("%g\n", sum);
}

static void drawing(tz_ctx *ctx, const char *path)
{
    const char *name = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    tz_curve_set set, back;
    tz_sample_graph g;
    const double t0 = bench_now();
    bench_check(ctx, tz_curve_read_svg(ctx, path, NULL, &set));
    printf("curves read  %-26s %d paths %d pieces %d nodes  %.2f ms\n", name, set.path.n,
           set.piece.n, set.node.n, 1e3 * (bench_now() - t0));
    const tz_sample_levels l = tz_sample_levels_default(&set);
    for (int i = 0; i < l.levels; i++) {
        double mean[2], most[2];
        const double t1 = bench_now();
        bench_check(ctx, tz_sample_graph_make(ctx, &set, l.spacing[i], l.radius[i], &g));
        const double t2 = bench_now();
        bench_check(ctx, tz_curve_reconstruct(ctx, &g, &set, &back));
        const double t3 = bench_now();
        bench_check(ctx, tz_curve_distance(ctx, &set, &back, l.spacing[i] / 20, &mean[0],
                                           &most[0]));
        bench_check(ctx, tz_curve_distance(ctx, &back, &set, l.spacing[i] / 20, &mean[1],
                                           &most[1]));
        printf("curves back  %-26s delta %6.2f  %d samples %d edges  sample %.2f ms  "
               "reconstruct %.2f ms  mean %.4f %.4f  most %.3f %.3f of delta\n",
               name, l.spacing[i], g.sample.n, g.edge.n, 1e3 * (t2 - t1), 1e3 * (t3 - t2),
               mean[0] / l.spacing[i], mean[1] / l.spacing[i], most[0] / l.spacing[i],
               most[1] / l.spacing[i]);
        if (i == l.levels - 1) {
            tz_sample_graph o = shake(ctx, &set, l.spacing[i], l.radius[i]);
            matches(ctx, name, &o, &g, false, false);
            matches(ctx, name, &o, &g, true, false);
            matches(ctx, name, &o, &g, false, true);
            tz_sample_graph_deinit(&o);
        }
        tz_curve_set_deinit(&back);
        tz_sample_graph_deinit(&g);
    }
    tz_curve_set_deinit(&set);
}

/* The solver alone, rows to cols of random costs in the plane. */
static void solver(int32_t rows, int32_t cols)
{
    static tz_assign a;
    tz_rng r = tz_rng_make(3, 1);
    float x[2][TZ_ASSIGN_MOST], y[2][TZ_ASSIGN_MOST];
    double busy[2] = {0, 0};
    const int32_t n = 20000;
    a.rows = rows;
    a.cols = cols;
    for (int32_t k = 0; k < n; k++) {
        for (int32_t j = 0; j < cols; j++) {
            x[1][j] = (float)tz_rng_unit(&r);
            y[1][j] = (float)tz_rng_unit(&r);
        }
        for (int32_t i = 0; i < rows; i++) {
            x[0][i] = x[1][i % cols] + 0.05f * (float)tz_rng_normal(&r);
            y[0][i] = y[1][i % cols] + 0.05f * (float)tz_rng_normal(&r);
            a.exit[i] = 0.5f;
        }
        for (int warm = 0; warm < 2; warm++) {
            for (int32_t i = 0; i < rows; i++)
                for (int32_t j = 0; j < cols; j++)
                    a.cost[i][j] = hypotf(x[0][i] - x[1][j], y[0][i] - y[1][j]) +
                                   (warm ? 0.002f * (float)((i * 7 + j * 3) % 10) : 0);
            const double t = bench_now();
            (void)tz_assign_solve(&a, warm, INFINITY);
            busy[warm] += bench_now() - t;
        }
    }
    printf("curves solve %2d x %2d  cold %.2f us  warm %.2f us\n", rows, cols,
           1e6 * busy[0] / n, 1e6 * busy[1] / n);
}

int main(int argc, char **argv)
{
    tz_ctx *ctx = bench_ctx(0);
    solver(10, 12);
    solver(20, 24);
    solver(30, 36);
    solver(40, 48);
    for (int i = 1; i < argc; i++)
        drawing(ctx, argv[i]);
    tz_ctx_free(ctx);
    return 0;
}
