/* SPDX-License-Identifier: Apache-2.0 */
/* Quilting of curves: bench_quilt [-s SCALE] [-o FOLDER] [-t] [-p NAME VALUE] DRAWING... prints for each
 * drawing, over SCALE x SCALE times its area, the time, patches, share of crossings joined
 * and the length of lines per area against the exemplar's; -o writes the results, -t makes
 * them tiles. */
#include "tests/bench/bench.h"

#include "curves/curve_io.h"
#include "curves/quilt.h"

static double length_per_area(const tz_curve_set *s)
{
    double sum = 0;
    for (int32_t i = 0; i < s->piece.n; i++) {
        const tz_bezier b = tz_curve_bezier(s, &s->piece.v[i]);
        sum += tz_bezier_length(&b);
    }
    return sum / tz_domain_area(&s->domain);
}

static void quilt(tz_ctx *ctx, const char *path, double scale, bool torus,
                  const char *folder, const tz_curve_quilt_params *p)
{
    const char *name = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    tz_curve_set set, out;
    tz_curve_quilt_report r;
    bench_check(ctx, tz_curve_read_svg(ctx, path, NULL, &set));
    const tz_domain d = {
        .size = {scale * set.domain.size.x, scale * set.domain.size.y, 0},
        .torus = torus};
    const tz_curve_quilt_job job = {
        .exemplar = &set, .domain = &d, .params = p, .seed = 1};
    const double t0 = bench_now(), c0 = bench_cpu();
    bench_check(ctx, tz_curve_quilt(ctx, &job, &out, &r));
    const double t1 = bench_now(), c1 = bench_cpu();
    bench_check(ctx, tz_curve_set_check(ctx, &out, "out"));
    printf("curves quilt %-26s %g x  %6.2f s  cpu %6.2f s  %4d patches  %6d crossings  "
           "joined %5.1f %%  length %.3f  paths %d to %d\n",
           name, scale, t1 - t0, c1 - c0, r.patches, r.crossings,
           r.crossings ? 100.0 * r.joined / r.crossings : 100.0,
           length_per_area(&out) / length_per_area(&set), set.path.n, out.path.n);
    fflush(stdout);
    if (folder) {
        char to[4096];
        snprintf(to, sizeof to, "%s/%s", folder, name);
        bench_check(ctx, tz_curve_write_svg(ctx, to, &out));
    }
    tz_curve_set_deinit(&out);
    tz_curve_set_deinit(&set);
}

int main(int argc, char **argv)
{
    tz_ctx *ctx = bench_ctx(0);
    double scale = 3;
    bool torus = false;
    const char *folder = NULL;
    tz_curve_quilt_params p;
    tz_params_default(&tz_curve_quilt_param_table, &p);
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "-s") == 0 && i + 1 < argc)
            scale = strtod(argv[++i], NULL);
        else if (strcmp(argv[i], "-o") == 0 && i + 1 < argc)
            folder = argv[++i];
        else if (strcmp(argv[i], "-p") == 0 && i + 2 < argc) {
            bench_check(ctx, tz_params_set(ctx, &tz_curve_quilt_param_table, &p,
                                           argv[i + 1], argv[i + 2]));
            i += 2;
        } else if (strcmp(argv[i], "-t") == 0)
            torus = true;
        else
            quilt(ctx, argv[i], scale, torus, folder, &p);
    }
    tz_ctx_free(ctx);
    return 0;
}
