/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Element fields.
 *
 *   bench_fill speed [ELEMENTS [ITERATIONS]]
 *
 * prints: fill ELEMENTS begin SECONDS cpu SECONDS iterate SECONDS cpu SECONDS each
 * SECONDS repair SECONDS covered SHARE overlap SHARE peak MIB samples N
 *
 *   bench_fill strokes [COUNT]
 *
 * a field of that many short strokes, settled.
 *
 *   bench_fill edit [ELEMENTS]
 *
 * a brush over one element in a hundred of a settled layout: replace, settle; prints the
 * share of the domain under it and the medians of nine strokes.
 *
 *   bench_fill drawing PALETTE.svg STROKES.svg SIDE OUT.svg
 *
 * a palette and strokes that are given: figures and a layout.
 *
 *   bench_fill cases OUT [NAME [SEEDS]]
 *   bench_fill weights OUT [NAME [SEEDS]]
 *
 * ten cases, ours against others, and the other one's weights: tests/bench/fill_cases.h. */
#include <math.h>

#include "elements/element_io.h"
#include "fields/fill_internal.h"
#include "tests/bench/fill_cases.h"

static void curve(tz_element_field *f, tz_ctx *ctx, tz_vec3 size, int kind)
{
    tz_element_field_point p[64];
    const tz_element_field_stroke s = {
        .radius = 0.01 * size.x, .weight = 1, .directed = true};
    for (int k = 0; k < 64; k++) {
        const double t = k / 63.0;
        p[k] = (tz_element_field_point){{0, 0}, 0, -1};
        if (kind == 0)
            p[k].at =
                (tz_vec2){(0.1 + 0.8 * t) * size.x, (0.5 + 0.3 * sin(6.28 * t)) * size.y};
        else
            p[k].at = (tz_vec2){(0.5 + 0.35 * cos(6.28 * t)) * size.x,
                                (0.5 + 0.35 * sin(6.28 * t)) * size.y};
    }
    bench_check(ctx, tz_element_field_add(f, s, 64, p));
}

static void speed(tz_ctx *ctx, int32_t count, int32_t iterations)
{
    const char *shape[] = {fill_leaf, fill_round, fill_drop};
    tz_element_set palette, layout;
    tz_element_field field;
    tz_fill *f;
    tz_fill_params p = fill_defaults();
    tz_fill_report r;
    fill_palette(ctx, shape, 3, &palette);
    const double side = sqrt(count * 95.0 / p.fill);
    const tz_domain d = {.size = {side, side, 0}};
    bench_check(ctx, tz_element_field_init(ctx, d.size, false, 0, &field));
    curve(&field, ctx, d.size, 0);
    bench_check(ctx, tz_element_field_settle(&field));
    bench_check(ctx, tz_element_set_like(ctx, &palette, &d, &layout));
    const tz_fill_job job = {.palette = &palette,
                             .domain = d,
                             .field = &field,
                             .params = &p,
                             .seed = 1,
                             .count = count};
    const double t0 = bench_now(), c0 = bench_cpu();
    bench_check(ctx, tz_fill_begin(ctx, &job, &layout, &f));
    const double t1 = bench_now(), c1 = bench_cpu();
    bench_check(ctx, tz_fill_iterate(f, iterations, NULL));
    const double t2 = bench_now(), c2 = bench_cpu();
    bench_check(ctx, tz_fill_repair(f));
    const double t3 = bench_now();
    bench_check(ctx, tz_fill_write(f, &layout));
    bench_check(ctx, tz_fill_measure(ctx, &layout, &palette, &field, 0, &r));
    printf("fill %d begin %.4f cpu %.4f iterate %.4f cpu %.4f each %.5f repair %.4f "
           "covered %.3f overlap %.4f peak %.0f samples %d\n",
           count, t1 - t0, c1 - c0, t2 - t1, c2 - c1, (t2 - t1) / iterations, t3 - t2,
           r.covered, r.overlap, bench_peak(), f->n);
    if (getenv("FILL_OUT"))
        bench_check(ctx, tz_element_write_svg(ctx, getenv("FILL_OUT"), &layout));
    tz_fill_end(f);
    tz_element_field_deinit(&field);
    tz_element_set_deinit(&layout);
    tz_element_set_deinit(&palette);
}

/* ---- strokes ------------------------------------------------------------------------ */

static void strokes(tz_ctx *ctx, int32_t count)
{
    tz_element_field f;
    const tz_element_field_stroke pen = {.radius = 1, .weight = 1, .directed = true};
    const double t = bench_now(), c = bench_cpu();
    bench_check(ctx,
                tz_element_field_init(ctx, (tz_vec3){1000, 1000, 0}, false, 1024, &f));
    for (int32_t k = 0; k < count; k++) { /* spread by two irrational steps */
        const double x = fmod(k * 0.7548776662466927, 1) * 1000,
                     y = fmod(k * 0.5698402909980532, 1) * 1000, a = 0.01 * x;
        const tz_element_field_point v[2] = {{{x, y}, 0, -1},
                                             {{x + 6 * cos(a), y + 6 * sin(a)}, 0, -1}};
        bench_check(ctx, tz_element_field_add(&f, pen, 2, v));
    }
    bench_check(ctx, tz_element_field_settle(&f));
    printf("strokes %d seconds %.3f cpu %.3f peak %.0f\n", count, bench_now() - t,
           bench_cpu() - c, bench_peak());
    tz_element_field_deinit(&f);
}

/* ---- edits -------------------------------------------------------------------------- */

static void edit(tz_ctx *ctx, int32_t count)
{
    const char *shape[] = {fill_leaf, fill_round, fill_drop};
    tz_element_set palette, layout;
    tz_fill *f;
    tz_fill_params p = fill_defaults();
    fill_palette(ctx, shape, 3, &palette);
    const double side = sqrt(count * 95.0 / p.fill);
    const tz_domain d = {.size = {side, side, 0}};
    bench_check(ctx, tz_element_set_like(ctx, &palette, &d, &layout));
    const tz_fill_job job = {
        .palette = &palette, .domain = d, .params = &p, .seed = 1, .count = count};
    bench_check(ctx, tz_fill_begin(ctx, &job, &layout, &f));
    bench_check(ctx, tz_fill_settle(f, 60));
    double wall[9], cpu[9];
    for (int k = 0; k < 9; k++) {
        const double x = side * (0.1 + 0.09 * k), r = 0.05 * side;
        const tz_vec2 stroke[2] = {{x, 0.3 * side}, {x, 0.3 * side + 0.0429 * side}};
        const double t = bench_now(), c = bench_cpu();
        bench_check(ctx, tz_fill_replace(f, 2, stroke, r, -1, 1));
        bench_check(ctx, tz_fill_settle(f, 10));
        wall[k] = bench_now() - t, cpu[k] = bench_cpu() - c;
    }
    printf("edit %d share %.4f wall %.4f cpu %.4f\n", count,
           TZ_PI * 0.05 * 0.05 + 0.1 * 0.0429, bench_median(wall, 9),
           bench_median(cpu, 9));
    bench_check(ctx, tz_fill_write(f, &layout));
    if (getenv("FILL_OUT"))
        bench_check(ctx, tz_element_write_svg(ctx, getenv("FILL_OUT"), &layout));
    tz_fill_end(f);
    tz_element_set_deinit(&layout);
    tz_element_set_deinit(&palette);
}

/* ---- given drawings ----------------------------------------------------------------- */

static void drawing(tz_ctx *ctx, char **arg)
{
    const double side = atof(arg[2]);
    const tz_domain d = {.size = {side, side, 0}};
    tz_element_set palette, layout;
    tz_element_field field;
    tz_fill_report r;
    bench_check(ctx, tz_element_read_svg(ctx, arg[0], NULL, &palette));
    bench_check(ctx, tz_element_field_read(ctx, arg[1], d.size, false, &field));
    bench_check(ctx, tz_element_set_like(ctx, &palette, &d, &layout));
    const tz_fill_job job = {
        .palette = &palette, .domain = d, .field = &field, .seed = 1};
    const double c0 = bench_cpu();
    bench_check(ctx, tz_fill_run(ctx, &job, &layout, &r));
    printf("drawing %s elements %d samples %d covered %.3f overlap %.4f hole %.4f turn "
           "%.2f align %.2f moved %d shrunk %d dropped %d inserted %d seconds %.2f cpu "
           "%.2f\n",
           arg[0], r.elements, r.samples, r.covered, r.overlap, r.hole / side,
           r.turn * 180 / TZ_PI, r.align * 180 / TZ_PI, r.moved, r.shrunk, r.dropped,
           r.inserted, r.seconds, bench_cpu() - c0);
    bench_check(ctx, tz_element_write_svg(ctx, arg[3], &layout));
    tz_element_field_deinit(&field);
    tz_element_set_deinit(&layout);
    tz_element_set_deinit(&palette);
}

int main(int argc, char **argv)
{
    tz_ctx *ctx;
    const char *what = argc > 1 ? argv[1] : "speed";
    if (tz_ctx_new(NULL, &ctx) != TZ_OK)
        return 1;
    const bool weights = strcmp(what, "weights") == 0;
    if ((weights || strcmp(what, "cases") == 0) && argc > 2) {
        const char *only = argc > 3 ? argv[3] : "";
        const int seeds = argc > 4 ? atoi(argv[4]) : FILL_SEEDS;
        if (weights)
            fill_weights(ctx, argv[2], only, seeds);
        else
            fill_cases(ctx, argv[2], only, seeds);
    } else if (strcmp(what, "drawing") == 0 && argc > 5) {
        drawing(ctx, argv + 2);
    } else if (strcmp(what, "strokes") == 0) {
        strokes(ctx, argc > 2 ? atoi(argv[2]) : 1000000);
    } else if (strcmp(what, "edit") == 0) {
        edit(ctx, argc > 2 ? atoi(argv[2]) : 10000);
    } else {
        speed(ctx, argc > 2 ? atoi(argv[2]) : 689, argc > 3 ? atoi(argv[3]) : 100);
    }
    tz_ctx_free(ctx);
    return 0;
}
