/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Element fields.
 *
 *   bench_fill speed [RUNS]     iterations by count of samples; edits
 *   bench_fill cases [OUT]      ten cases, against a full field by Laplacian interpolation
 *                               and placement after it; drawings go to the folder OUT */
#include <math.h>

#include "elements/element_io.h"
#include "elements/fill.h"
#include "elements/frames.h"
#include "tests/bench/bench.h"

static const char leaf[] = "<path d=\"M-10,0 C-5,-5 4,-5 10,0 C4,5 -5,5 -10,0Z\" "
                           "fill=\"#4a8f3c\"/>";
static const char round_[] = "<circle r=\"4\" fill=\"#c8553d\"/>";
static const char bar[] =
    "<path d=\"M-20,-3 L18,-3 L20,0 L18,3 L-20,3Z\" fill=\"#588b8b\"/>";
static const char large[] = "<circle r=\"12\" fill=\"#28536b\"/>";
static const char drop[] = "<path d=\"M-7,0 C-3,-1 0,-5 4,-5 C10,-5 10,5 4,5 C0,5 -3,1 "
                           "-7,0Z\" fill=\"#f28f3b\"/>";

typedef struct thing {
    const char *shape;
    double x;
} thing;

static void make_palette(tz_ctx *ctx, const char *const *shape, int n, tz_element_set *s)
{
    char text[8192];
    int at = snprintf(text, sizeof text,
                      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d 60\">",
                      60 * n);
    for (int k = 0; k < n; k++)
        at += snprintf(text + at, sizeof text - (size_t)at,
                       "<g transform=\"translate(%d 30)\">%s</g>", 60 * k + 30, shape[k]);
    snprintf(text + at, sizeof text - (size_t)at, "</svg>");
    bench_check(ctx, tz_element_parse_svg(ctx, "palette", text, strlen(text), NULL, s));
}

static tz_fill_params defaults(void)
{
    tz_fill_params p;
    memset(&p, 0, sizeof p);
    tz_params_default(&tz_fill_param_table, &p);
    return p;
}

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
    const char *shape[] = {leaf, round_, drop};
    tz_element_set palette, layout;
    tz_element_field field;
    tz_fill *f;
    tz_fill_params p = defaults();
    tz_fill_report r;
    make_palette(ctx, shape, 3, &palette);
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
    bench_check(ctx, tz_fill_measure(ctx, &layout, &field, 0, &r));
    printf("fill %d begin %.4f cpu %.4f iterate %.4f cpu %.4f each %.5f repair %.4f "
           "covered %.3f overlap %.4f peak %.0f\n",
           count, t1 - t0, c1 - c0, t2 - t1, c2 - c1, (t2 - t1) / iterations, t3 - t2,
           r.covered, r.overlap, bench_peak());
    if (getenv("FILL_OUT"))
        bench_check(ctx, tz_element_write_svg(ctx, getenv("FILL_OUT"), &layout));
    tz_fill_end(f);
    tz_element_field_deinit(&field);
    tz_element_set_deinit(&layout);
    tz_element_set_deinit(&palette);
}

int main(int argc, char **argv)
{
    tz_ctx *ctx;
    if (tz_ctx_new(NULL, &ctx) != TZ_OK)
        return 1;
    (void)bar, (void)large;
    const int32_t n = argc > 1 ? atoi(argv[1]) : 689;
    speed(ctx, n, argc > 2 ? atoi(argv[2]) : 100);
    tz_ctx_free(ctx);
    return 0;
}
