/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Lines found in pictures whose lines are known, against rivals at their best settings;
 * and what photos give.
 *
 *   bench_lines [PHOTO...]
 *
 * Rivals are given the same tracing, pruning of what is short and fitting of cubics, so
 * that what differs is how lines are found: Canny's edges (OpenCV), blurred by 1, 1.5 or 2
 * px, over a ladder of thresholds; and what tracers of centre lines do (autotrace
 * -centerline): a threshold, here against the mean of 31 x 31 px, and thinning. (Debian has
 * potrace alone, which traces outlines.) A set is three pictures of 512 x 512 px, their lines
 * hardly above the grain or well above it; within 2 px counts. Canny's edges lie on the borders of
 * lines, half a width off: up to 4 px wide they count as found. */
#include "tests/bench/bench.h"

#include <math.h>

#include "analysis/filter_cv.h"
#include "analysis/lines.h"
#include "analysis/lines_fit.h"
#include "analysis/lines_graph.h"
#include "tests/bench/rivals_cv.h"
#include "tests/support/line_truth.h"

enum { SIDE = 512, PICTURES = 3, RUNGS = 33 };

typedef struct result {
    line_score score; /* means */
    double pieces, seconds;
} result;

static void add(tz_ctx *ctx, const line_truth *t, const tz_curve_set *s, double seconds,
                result *to)
{
    line_sample *v;
    int32_t n;
    line_score c;
    bench_check(ctx, line_samples_of(ctx, s, &v, &n));
    bench_check(ctx, line_truth_score(t, v, n, &c));
    to->score.precision += c.precision / PICTURES;
    to->score.recall += c.recall / PICTURES;
    to->score.f += c.f / PICTURES;
    to->score.place += c.place / PICTURES;
    to->score.width += c.width / PICTURES;
    to->pieces += (double)s->piece.n / PICTURES;
    to->seconds += seconds / PICTURES;
    tz_free(ctx, v);
}

static void ours(tz_ctx *ctx, const line_truth *t, result *to)
{
    tz_lines_params p;
    tz_curve_set s;
    tz_params_default(&tz_lines_param_table, &p);
    p.line = TZ_LINE_RIDGE;
    const double start = bench_now();
    bench_check(ctx, tz_lines_find(ctx, &t->photo, &p, &s, NULL, NULL));
    add(ctx, t, &s, bench_now() - start, to);
    tz_curve_set_deinit(&s);
}

/* ---- rivals -------------------------------------------------------------------------- */

/* What is marked in `on`, thinned, traced, what is shorter than `least` px dropped, and
 * fitted; all `wide` px wide. */
static void draw(tz_ctx *ctx, const line_truth *t, const uint8_t *on, double least,
                 double wide, tz_curve_set *out)
{
    tz_line_field f = {0};
    tz_line_graph g = {.ctx = ctx};
    tz_line_picture im;
    bench_check(ctx, tz_line_field_init(ctx, &f, SIDE, SIDE));
    bench_check(ctx, tz_line_picture_init(ctx, &t->photo, 0, &im));
    for (int32_t p = 0; p < SIDE * SIDE; p++) {
        f.map.on[p] = on[p];
        f.map.response[p] = on[p];
        f.map.normal[p] = 1;
        f.wide[p] = (float)wide;
    }
    bench_check(ctx, tz_edge_map_thin(&f.map));
    bench_check(ctx, tz_line_graph_trace(&f, &g));
    for (int32_t i = 0; i < g.chain.n; i++)
        g.chain.v[i].gone |= g.chain.v[i].length < least;
    bench_check(ctx, tz_line_graph_rejoin(&g));
    bench_check(ctx, tz_line_graph_smooth(&g, 1));
    *out = (tz_curve_set){.ctx = ctx, .element.ctx = ctx};
    out->domain.size = (tz_vec3){SIDE, SIDE, 0};
    bench_check(ctx, tz_line_fit(&g, &im, 1, 0.5, out));
    tz_line_graph_deinit(&g);
    tz_line_picture_deinit(&im);
    tz_line_field_deinit(ctx, &f);
}

/* Edges of one picture at every rung; seconds of one of them. */
static double climb(tz_ctx *ctx, const line_truth *t, double sigma, float *strength)
{
    const rival_photo photo = {t->photo.px, SIDE, SIDE};
    double seconds;
    bench_check(ctx, rival_canny(ctx, &photo, sigma, false, strength, &seconds));
    return seconds;
}

static void canny(tz_ctx *ctx, const line_truth *t, const float *strength, double seconds,
                  int rung, double least, result *to)
{
    static uint8_t on[SIDE * SIDE];
    tz_curve_set s;
    for (int32_t p = 0; p < SIDE * SIDE; p++)
        on[p] = strength[p] > (float)rung / 34;
    draw(ctx, t, on, least, 2, &s);
    add(ctx, t, &s, seconds, to);
    tz_curve_set_deinit(&s);
}

/* Darker (light: lighter) than the mean around it by `by`, after a blur of 1 px. */
static void threshold(tz_ctx *ctx, const line_truth *t, bool light, double by,
                      double least, result *to)
{
    static float grey[SIDE * SIDE], near[SIDE * SIDE], sum[SIDE + 1][SIDE + 1];
    static uint8_t on[SIDE * SIDE];
    tz_curve_set s;
    const double start = bench_now();
    for (int32_t p = 0; p < SIDE * SIDE; p++)
        grey[p] = t->photo.px[3 * (ptrdiff_t)p + 1];
    bench_check(ctx, tz_cv_blur(ctx, grey, near, SIDE, SIDE, 0, SIDE, 1));
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++)
            sum[y + 1][x + 1] =
                near[y * SIDE + x] + sum[y][x + 1] + sum[y + 1][x] - sum[y][x];
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) {
            const int x0 = x > 15 ? x - 15 : 0, y0 = y > 15 ? y - 15 : 0,
                      x1 = x + 16 < SIDE ? x + 16 : SIDE,
                      y1 = y + 16 < SIDE ? y + 16 : SIDE;
            const double mean =
                (double)(sum[y1][x1] - sum[y0][x1] - sum[y1][x0] + sum[y0][x0]) /
                ((x1 - x0) * (y1 - y0));
            const double off = near[y * SIDE + x] - mean;
            on[y * SIDE + x] = (light ? off : -off) > by;
        }
    draw(ctx, t, on, least, 4, &s);
    add(ctx, t, &s, bench_now() - start, to);
    tz_curve_set_deinit(&s);
}

/* ---- sets ---------------------------------------------------------------------------- */

static void print(const char *set, double depth, const char *who, const char *setting,
                  const result *r)
{
    printf("lines %s-%.2f %s %s %.3f %.3f %.3f %.2f %.3f %.0f %.4f\n", set, depth, who,
           setting, r->score.f, r->score.precision, r->score.recall, r->score.place,
           r->score.width, r->pieces, r->seconds);
}

static void keep_best(const result *r, const char *setting, result *best, char name[32])
{
    if (r->score.f > best->score.f) {
        *best = *r;
        snprintf(name, 32, "%s", setting);
    }
}

static void run_set(tz_ctx *ctx, line_kind kind, double depth)
{
    static const double sigma[] = {1, 1.5, 2}, least[] = {10, 25};
    line_truth t[PICTURES];
    result own = {0}, best = {0};
    char name[32] = "-", setting[32];
    for (int i = 0; i < PICTURES; i++) {
        bench_check(ctx,
                    line_truth_draw(ctx, kind, SIDE, depth, 100 + (uint64_t)i, &t[i]));
        ours(ctx, &t[i], &own);
    }
    print(line_kind_name[kind], depth, "ridges", "-", &own);
    for (int k = 0; k < 3; k++) {
        static float strength[PICTURES][SIDE * SIDE];
        double seconds[PICTURES];
        for (int i = 0; i < PICTURES; i++)
            seconds[i] = climb(ctx, &t[i], sigma[k], strength[i]);
        for (int rung = 2; rung < RUNGS; rung += 3)
            for (int e = 0; e < 2; e++) {
                result r = {0};
                for (int i = 0; i < PICTURES; i++)
                    canny(ctx, &t[i], strength[i], seconds[i], rung, least[e], &r);
                snprintf(setting, sizeof setting, "s%g,t%d,l%g", sigma[k], rung,
                         least[e]);
                keep_best(&r, setting, &best, name);
            }
    }
    print(line_kind_name[kind], depth, "canny", name, &best);
    best = (result){0};
    for (int k = 1; k <= 8; k++)
        for (int e = 0; e < 2; e++) {
            result r = {0};
            for (int i = 0; i < PICTURES; i++)
                threshold(ctx, &t[i], kind == LINE_VEINS, 0.012 * k, least[e], &r);
            snprintf(setting, sizeof setting, "c%g,l%g", 0.012 * k, least[e]);
            keep_best(&r, setting, &best, name);
        }
    print(line_kind_name[kind], depth, "threshold", name, &best);
    for (int i = 0; i < PICTURES; i++)
        line_truth_deinit(&t[i]);
}

static void photo(tz_ctx *ctx, const char *path)
{
    const char *name = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    tz_image im = bench_photo(ctx, path, 0), plate;
    tz_lines_params p;
    tz_curve_set s;
    tz_lines_verdict v;
    double seconds[3], cpu = 0;
    tz_params_default(&tz_lines_param_table, &p);
    for (int k = 0; k < 3; k++) {
        const double start = bench_now(), before = bench_cpu();
        bench_check(ctx, tz_lines_find(ctx, &im, &p, &s, NULL, &v));
        seconds[k] = bench_now() - start;
        cpu = bench_cpu() - before;
        tz_curve_set_deinit(&s);
    }
    bench_check(ctx, tz_lines_find(ctx, &im, &p, &s, &plate, &v));
    static const char *const line[] = {"auto", "edge", "ridge", "both"};
    static const char *const tone[] = {"-", "dark", "light", "both"};
    printf("photo %s %dx%d %s %s %s %d %d %.1f %.0f %.2f %.2f %.3f %.3f\n", name,
           im.width, im.height, v.is_lines ? "lines" : "no", line[v.line & 3],
           tone[v.tone & 3], s.path.n, s.piece.n, v.width, v.length, v.contrast, v.joined,
           bench_median(seconds, 3), cpu);
    tz_curve_set_deinit(&s);
    tz_image_deinit(&plate);
    tz_image_deinit(&im);
}

int main(int argc, char **argv)
{
    static const double depth[] = {0.06, 0.16};
    tz_ctx *ctx = bench_ctx(0);
    for (int k = 0; k < LINE_KINDS; k++)
        for (int d = 0; d < 2; d++)
            run_set(ctx, (line_kind)k, depth[d]);
    for (int i = 1; i < argc; i++)
        photo(ctx, argv[i]);
    tz_ctx_free(ctx);
    return 0;
}
