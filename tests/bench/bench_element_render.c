/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Rendering of element layouts: drawings (flat paths, and such as librsvg draws) against
 * rsvg-convert of the same document, and cut-outs of a drawn photo.
 *
 *   bench_element_render [ELEMENTS [SIDE [RUNS [THREADS]]]]
 *
 * prints lines: element_render CASE METHOD ELEMENTS SIDE SECONDS
 *   flat, rich   METHOD ours: renderer made and rendered, in memory; file: the same with
 *                reading the document and writing a PNG, rsvg-convert: that, as a process
 *   cut          METHOD prepare, render: moved, turned and scaled copies of 40 pebbles */
#include "elements/element_io.h"
#include "scenes/scene.h"
#include "synthesis/element_compose.h"
#include "tests/bench/bench.h"

#include <unistd.h>

enum { RUNS_MAX = 99 };

static const char *const flat[] = {
    "<path d=\"M-10 0C-6 -7 5 -7 10 0C5 7 -6 7 -10 0Z\" fill=\"#3c7a3a\"/>"
    "<path d=\"M-10 0L9 0\" fill=\"none\" stroke=\"#1d4a20\" stroke-width=\"0.6\"/>",
    "<circle r=\"9\" fill=\"#c9522f\"/>",
    "<path d=\"M-9 -3L9 -5L7 6L-8 4Z\" fill=\"#e0c060\" stroke=\"#806020\" "
    "stroke-width=\"1\" stroke-linejoin=\"round\"/>",
    "<path d=\"M-9 0C-4 -9 4 9 9 0\" fill=\"none\" stroke=\"#2f6cad\" "
    "stroke-width=\"2\" stroke-linecap=\"round\"/>"};

static const char *const rich[] = {
    "<linearGradient id=\"a\"><stop stop-color=\"#fff\"/><stop offset=\"1\" "
    "stop-color=\"#257\"/></linearGradient><circle r=\"9\" fill=\"url(#a)\"/>",
    "<g opacity=\"0.6\"><circle r=\"6\" cx=\"-3\" fill=\"#c33\"/><circle r=\"6\" "
    "cx=\"3\" fill=\"#33c\"/></g>",
    "<rect x=\"-8\" y=\"-5\" width=\"16\" height=\"10\" rx=\"3\" style=\"fill:#484\"/>"};

static void add_element(tz_element_set *s, tz_ctx *ctx, int32_t symbol, tz_rng *rng,
                        double side, double scale)
{
    tz_element e = {.symbol = symbol,
                    .source = -1,
                    .sample = s->sample.n,
                    .samples = 1,
                    .at = {tz_rng_range(rng, 0, side), tz_rng_range(rng, 0, side), 0},
                    .angle = tz_rng_range(rng, 0, 2 * TZ_PI),
                    .scale = scale * tz_rng_range(rng, 0.8, 1.2),
                    .depth = s->element.n};
    e.radius = s->symbol.v[symbol].radius * e.scale;
    bench_check(ctx, tz_array_push(ctx, &s->sample, ((tz_sample){e.at, 0, 1})));
    bench_check(ctx, tz_array_push(ctx, &s->element, e));
}

static void start_set(tz_ctx *ctx, double side, tz_element_set *s)
{
    *s = (tz_element_set){.domain = {.size = {side, side, 0}}, .ctx = ctx};
    tz_element_kind k = {0};
    bench_check(ctx, tz_strdup(ctx, "thing", &k.name));
    bench_check(ctx, tz_array_push(ctx, &s->kind, k));
}

static void make_drawing(tz_ctx *ctx, const char *const *markup, int32_t symbols,
                         int32_t n, int32_t side, tz_element_set *s)
{
    tz_rng rng = tz_rng_make(7, (uint64_t)n);
    char back[200];
    start_set(ctx, side, s);
    snprintf(back, sizeof back, "<path d=\"M0 0L%d 0L%d %dL0 %dZ\" fill=\"#f7f3ea\"/>",
             side, side, side, side);
    bench_check(ctx, tz_strdup(ctx, back, &s->background));
    for (int32_t i = 0; i < symbols; i++) {
        tz_element_symbol y = {.radius = 10};
        char id[32];
        snprintf(id, sizeof id, "s%d", i);
        bench_check(ctx, tz_strdup(ctx, id, &y.id));
        bench_check(ctx, tz_strdup(ctx, markup[i], &y.markup));
        bench_check(ctx, tz_array_push(ctx, &s->symbol, y));
    }
    for (int32_t i = 0; i < n; i++) /* elements cover about the canvas */
        add_element(s, ctx, i % symbols, &rng, side, 0.06 * side / sqrt(n));
}

static double time_memory(tz_ctx *ctx, const tz_element_set *s, int runs)
{
    double t[RUNS_MAX];
    for (int k = 0; k < runs; k++) {
        tz_element_composer *c = NULL;
        tz_image im;
        int32_t w, h;
        const double from = bench_now();
        bench_check(ctx,
                    tz_element_composer_new(ctx, NULL, s, NULL, TZ_MAP_COLOUR, NULL, &c));
        tz_element_composer_size(c, &w, &h);
        bench_check(ctx, tz_element_composer_image(ctx, c, w, h, &im));
        bench_check(ctx, tz_element_composer_render(ctx, c, (tz_rect){0, 0, w, h}, &im));
        t[k] = bench_now() - from;
        tz_image_deinit(&im);
        tz_element_composer_free(c);
    }
    return bench_median(t, runs);
}

static double time_file(tz_ctx *ctx, const char *svg, const char *png, int runs)
{
    double t[RUNS_MAX];
    for (int k = 0; k < runs; k++) {
        tz_element_set s;
        tz_element_composer *c = NULL;
        tz_image im;
        int32_t w, h;
        const double from = bench_now();
        bench_check(ctx, tz_element_read_svg(ctx, svg, NULL, &s));
        bench_check(
            ctx, tz_element_composer_new(ctx, NULL, &s, NULL, TZ_MAP_COLOUR, NULL, &c));
        tz_element_composer_size(c, &w, &h);
        bench_check(ctx, tz_element_composer_image(ctx, c, w, h, &im));
        bench_check(ctx, tz_element_composer_render(ctx, c, (tz_rect){0, 0, w, h}, &im));
        bench_check(ctx, tz_image_write(ctx, png, &im, NULL));
        t[k] = bench_now() - from;
        tz_image_deinit(&im);
        tz_element_composer_free(c);
        tz_element_set_deinit(&s);
    }
    return bench_median(t, runs);
}

/* Seconds of a process, < 0 if it cannot be run. */
static double time_rival(const char *svg, const char *png, int runs)
{
    char command[1200];
    double t[RUNS_MAX];
    snprintf(command, sizeof command, "rsvg-convert --unlimited -o '%s' '%s'", png, svg);
    for (int k = 0; k < runs; k++) {
        const double from = bench_now();
        if (system(command) != 0)
            return -1;
        t[k] = bench_now() - from;
    }
    return bench_median(t, runs);
}

static void bench_drawing(tz_ctx *ctx, const char *name, const char *const *markup,
                          int32_t symbols, int32_t n, int32_t side, int runs)
{
    const char *folder = getenv("TMPDIR");
    char svg[512], png[512];
    tz_element_set s;
    snprintf(svg, sizeof svg, "%s/bench-%d.svg", folder ? folder : "/tmp", (int)getpid());
    snprintf(png, sizeof png, "%s/bench-%d.png", folder ? folder : "/tmp", (int)getpid());
    make_drawing(ctx, markup, symbols, n, side, &s);
    printf("element_render %s ours %d %d %.4f\n", name, n, side,
           time_memory(ctx, &s, runs));
    fflush(stdout);
    bench_check(ctx, tz_element_write_svg(ctx, svg, &s));
    printf("element_render %s file %d %d %.4f\n", name, n, side,
           time_file(ctx, svg, png, runs));
    fflush(stdout);
    const double rival = time_rival(svg, png, runs);
    if (rival > 0)
        printf("element_render %s rsvg-convert %d %d %.4f\n", name, n, side, rival);
    fflush(stdout);
    remove(svg);
    remove(png);
    tz_element_set_deinit(&s);
}

/* Circles of a pebble picture as symbols: what counts is the work, not the look. */
static void make_cut(tz_ctx *ctx, int32_t n, int32_t side, int32_t photo,
                     tz_element_set *s)
{
    enum { SYMBOLS = 40, POINTS = 64 };
    tz_rng rng = tz_rng_make(9, (uint64_t)n);
    start_set(ctx, side, s);
    tz_element_photo f = {.width = photo, .height = photo};
    bench_check(ctx, tz_strdup(ctx, "pebbles", &f.path));
    bench_check(ctx, tz_array_push(ctx, &s->photo, f));
    for (int32_t i = 0; i < SYMBOLS; i++) {
        tz_element_symbol y = {.radius = 24, .photo_scale = 1};
        char id[32];
        snprintf(id, sizeof id, "s%d", i);
        bench_check(ctx, tz_strdup(ctx, id, &y.id));
        bench_check(ctx, tz_strdup(ctx, "", &y.markup));
        y.photo_at.x = tz_rng_range(&rng, 40, photo - 40);
        y.photo_at.y = tz_rng_range(&rng, 40, photo - 40);
        for (int k = 0; k < POINTS; k++) {
            const double a = 2 * TZ_PI * k / POINTS;
            bench_check(ctx, tz_array_push(ctx, &y.outline,
                                           ((tz_vec2){24 * cos(a), 20 * sin(a)})));
        }
        bench_check(ctx, tz_array_push(ctx, &y.part, 0));
        bench_check(ctx, tz_array_push(ctx, &s->symbol, y));
    }
    for (int32_t i = 0; i < n; i++)
        add_element(s, ctx, i % SYMBOLS, &rng, side, 0.022 * side / sqrt(n));
}

static void bench_cut(tz_ctx *ctx, int32_t n, int32_t side, int runs)
{
    tz_scene scene;
    tz_element_set s;
    tz_image im;
    double made[RUNS_MAX], drawn[RUNS_MAX];
    bench_check(ctx, tz_scene_render(ctx, TZ_SCENE_PEBBLES, TZ_SCENE_CLEAN, 1024, 1024, 3,
                                     &scene));
    make_cut(ctx, n, side, 1024, &s);
    const tz_element_pixels p = {&scene.photo, &scene.photo, NULL};
    bench_check(ctx, tz_image_init(ctx, &im, side, side, 3));
    im.encoding = TZ_ENCODING_SRGB;
    for (int k = 0; k < runs; k++) {
        tz_element_renderer *r = NULL;
        const double from = bench_now();
        bench_check(ctx, tz_element_renderer_new(ctx, &s, &p, TZ_MAP_COLOUR, NULL, &r));
        const double mid = bench_now();
        bench_check(ctx,
                    tz_element_renderer_render(ctx, r, (tz_rect){0, 0, side, side}, &im));
        made[k] = mid - from;
        drawn[k] = bench_now() - mid;
        tz_element_renderer_free(r);
    }
    printf("element_render cut prepare %d %d %.4f\n", n, side, bench_median(made, runs));
    printf("element_render cut render %d %d %.4f\n", n, side, bench_median(drawn, runs));
    tz_image_deinit(&im);
    tz_element_set_deinit(&s);
    tz_scene_deinit(&scene);
}

int main(int argc, char **argv)
{
    const int32_t n = argc > 1 ? atoi(argv[1]) : 10000,
                  side = argc > 2 ? atoi(argv[2]) : 2048;
    int runs = argc > 3 ? atoi(argv[3]) : 5;
    runs = runs < 1 ? 1 : runs > RUNS_MAX ? RUNS_MAX : runs;
    if (n < 1 || side < 16) {
        fprintf(stderr, "bench_element_render [ELEMENTS [SIDE [RUNS [THREADS]]]]\n");
        return 2;
    }
    tz_ctx *ctx = bench_ctx(argc > 4 ? atoi(argv[4]) : 0);
    bench_drawing(ctx, "flat", flat, sizeof flat / sizeof *flat, n, side, runs);
    bench_drawing(ctx, "rich", rich, sizeof rich / sizeof *rich, n, side, runs);
    bench_cut(ctx, n, side, runs);
    tz_ctx_free(ctx);
    return 0;
}
