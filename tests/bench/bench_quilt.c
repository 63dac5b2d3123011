/* SPDX-License-Identifier: Apache-2.0 */
/* Quilting of curves: bench_quilt [-s SCALE] [-o FOLDER] [-t] [-f] [-p NAME VALUE] DRAWING... prints for each
 * drawing, over SCALE x SCALE times its area, the time, patches, share of crossings joined
 * and the length of lines per area against the exemplar's; -o writes the results, -t makes
 * them tiles, -f finishes them, too, -n takes no exemplar for a tile. */
#include "tests/bench/bench.h"

#include "curves/curve_compare.h"
#include "curves/curve_io.h"
#include "curves/finish.h"
#include "curves/quilt.h"
#include "curves/tile.h"

static double length_per_area(const tz_curve_set *s)
{
    double sum = 0;
    for (int32_t i = 0; i < s->piece.n; i++) {
        const tz_bezier b = tz_curve_bezier(s, &s->piece.v[i]);
        sum += tz_bezier_length(&b);
    }
    return sum / tz_domain_area(&s->domain);
}

static void likeness(tz_ctx *ctx, const char *name, const char *what,
                     const tz_curve_set *e, const tz_curve_set *s)
{
    tz_curve_likeness l;
    if (tz_curve_compare(ctx, e, s, &l) != TZ_OK) {
        printf("curves like   %-26s %-8s %s\n", name, what, tz_ctx_message(ctx));
        tz_ctx_clear(ctx);
        return;
    }
    printf(
        "curves like   %-26s %-8s mean %.2f  length %.3f  ends %.3f  degrees off %.3f  "
        "repeats %.2f  (degrees %.2f ends %.2f edges %.2f turning %.2f orientation %.2f "
        "density %.2f cells %.2f patches %.2f)\n",
        name, what, l.mean, l.length[1] / l.length[0],
        l.dangling[0] > 0 ? l.dangling[1] / l.dangling[0] : l.dangling[1], l.degree_off,
        l.repeats, l.degrees, l.ends, l.edges, l.turning, l.orientation, l.density,
        l.cells, l.patches);
    fflush(stdout);
}

static void quilt(tz_ctx *ctx, const char *path, double scale, bool torus, bool finish,
                  bool wrap, const char *folder, const tz_curve_quilt_params *p)
{
    const char *name = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    tz_curve_set set, out;
    tz_curve_quilt_report r;
    bool tile = false;
    bench_check(ctx, tz_curve_read_svg(ctx, path, NULL, &set));
    if (wrap)
        bench_check(ctx, tz_curve_tile_find(ctx, &set, &tile));
    if (tile) {
        tz_curve_set joined;
        bench_check(ctx, tz_curve_tile_join(ctx, &set, &joined));
        tz_curve_set_deinit(&set);
        set = joined;
    }
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
           "joined %5.1f %%  length %.3f  paths %d to %d%s\n",
           name, scale, t1 - t0, c1 - c0, r.patches, r.crossings,
           r.crossings ? 100.0 * r.joined / r.crossings : 100.0,
           length_per_area(&out) / length_per_area(&set), set.path.n, out.path.n,
           tile ? "  tile" : "");
    likeness(ctx, name, "quilted", &set, &out);
    if (finish) {
        const double t2 = bench_now();
        tz_curve_finish_report f;
        bench_check(ctx, tz_curve_finish(ctx, &set, NULL, &out, &f));
        printf("curves finish %-26s %.2f s  ends %d to %d\n", name, bench_now() - t2,
               f.ends[0], f.ends[1]);
        likeness(ctx, name, "finished", &set, &out);
    }
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
    bool torus = false, finish = false, wrap = true;
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
        else if (strcmp(argv[i], "-n") == 0)
            wrap = false;
        else if (strcmp(argv[i], "-f") == 0)
            finish = true;
        else
            quilt(ctx, argv[i], scale, torus, finish, wrap, folder, &p);
    }
    tz_ctx_free(ctx);
    return 0;
}
