/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Rendering of curves: strokes against rsvg-convert of the same document, and lines in the
 * pixels of a photo over a ground.
 *
 *   bench_curve_render [PATHS [SIDE [RUNS [THREADS [LAYOUT.svg SCALE]]]]]
 *
 * prints lines: curve_render CASE METHOD PATHS SIDE SECONDS
 *   strokes  METHOD ours: composer made and rendered, in memory; file: the same with
 *            reading the document and writing a PNG; rsvg-convert: that, as a process
 *   photo    METHOD prepare, render: a bent net of 2,000 pieces with origins
 * and: curve_render difference MEAN MAX (of coverage in black on white; with a LAYOUT also
 * of that) */
#include <math.h>
#include <unistd.h>

#include "curves/curve_io.h"
#include "scenes/scene.h"
#include "synthesis/curve_render.h"
#include "tests/bench/bench.h"

enum { RUNS_MAX = 99 };

static tz_vec2 near_to(tz_rng *rng, tz_vec2 p, double r)
{
    return (tz_vec2){p.x + tz_rng_range(rng, -r, r), p.y + tz_rng_range(rng, -r, r)};
}

static void make_strokes(tz_ctx *ctx, int32_t n, int32_t side, tz_curve_set *s)
{
    static const uint32_t color[4] = {0x1d3557ff, 0xe63946ff, 0x457b9dff, 0x2a9d8fff};
    tz_rng rng = tz_rng_make(7, (uint64_t)n);
    *s = (tz_curve_set){.domain = {.size = {side, side, 0}},
                        .element = {.domain = {.size = {side, side, 0}}, .ctx = ctx},
                        .background = 0xf7f3eaff,
                        .ctx = ctx};
    const double room = side / sqrt(n);
    for (int32_t i = 0; i < n; i++) {
        int32_t pen, a, b;
        const tz_curve_pen p = {room * 0.02 * (1 + i % 8), color[i % 4], (uint32_t)i % 3,
                                (uint32_t)(i / 3) % 3};
        bench_check(ctx, tz_curve_add_pen(s, p, &pen));
        bench_check(ctx, tz_curve_begin(s, pen));
        tz_vec2 at = {tz_rng_range(&rng, 0, side), tz_rng_range(&rng, 0, side)};
        bench_check(ctx, tz_curve_add_node(s, at, &a));
        for (int k = 0; k < 3; k++) {
            const tz_vec2 to = near_to(&rng, at, room);
            bench_check(ctx, tz_curve_add_node(s, to, &b));
            bench_check(ctx, k == 1 ? tz_curve_line(s, a, b)
                                    : tz_curve_cubic(s, a, b, near_to(&rng, at, room),
                                                     near_to(&rng, to, room)));
            at = to;
            a = b;
        }
        tz_curve_end(s, false);
    }
}

static void draw(tz_ctx *ctx, const tz_curve_set *s, double scale, double width,
                 const tz_element_ground *ground, const tz_element_pixels *photo,
                 double seconds[2], tz_image *out)
{
    tz_curve_composer *c = NULL;
    tz_curve_render_params p;
    int32_t w, h;
    tz_params_default(&tz_curve_render_param_table, &p);
    p.scale = scale;
    p.width = width;
    double start = bench_now();
    bench_check(ctx, tz_curve_composer_new(ctx, ground, s, photo, TZ_MAP_COLOUR, &p, &c));
    seconds[0] = bench_now() - start;
    tz_curve_composer_size(c, &w, &h);
    bench_check(ctx, tz_curve_composer_image(ctx, c, w, h, out));
    start = bench_now();
    bench_check(ctx, tz_curve_composer_render(ctx, c, (tz_rect){0, 0, w, h}, out));
    seconds[1] = bench_now() - start;
    tz_curve_composer_free(c);
}

static void report(const char *what, const char *method, int32_t n, int32_t side,
                   double *seconds, int runs)
{
    printf("curve_render %s %s %d %d %.4f\n", what, method, n, side,
           bench_median(seconds, runs));
}

/* Runs rsvg-convert; false where there is none. */
static bool convert(const char *svg, const char *png, const tz_image *size)
{
    char command[1024];
    snprintf(command, sizeof command, "rsvg-convert -w %d -h %d %s -o %s 2>/dev/null",
             size->width, size->height, svg, png);
    return system(command) == 0;
}

/* Coverage of black lines on white, ours and theirs. */
static void compare(tz_ctx *ctx, const char *name, tz_curve_set *s, double scale,
                    const char *svg, const char *png)
{
    double seconds[2], sum = 0, most = 0;
    tz_image ours = {0}, theirs = {0};
    for (int32_t i = 0; i < s->pen.n; i++)
        s->pen.v[i].color = 0x000000ff;
    s->background = 0xffffffff;
    s->element.element.n = 0;
    s->taper.n = 0; /* foreign viewers show lines of one width */
    draw(ctx, s, scale, 1, NULL, NULL, seconds, &ours);
    bench_check(ctx, tz_curve_write_svg(ctx, svg, s));
    if (convert(svg, png, &ours)) {
        bench_check(ctx, tz_image_read(ctx, png, NULL, &theirs));
        bench_check(ctx, tz_image_convert(ctx, &theirs, TZ_ENCODING_SRGB));
        for (int32_t y = 0; y < ours.height; y++)
            for (int32_t x = 0; x < ours.width; x++) {
                /* ours is blended in linear light, theirs in sRGB */
                const double a = 1 - (double)tz_srgb_decode(*tz_image_at(&ours, x, y)),
                             b = 1 - (double)*tz_image_at(&theirs, x, y);
                sum += fabs(a - b);
                most = fmax(most, fabs(a - b));
            }
        printf("curve_render difference %s %.6f %.3f\n", name,
               sum / ((double)ours.width * ours.height), most);
    }
    tz_image_deinit(&ours);
    tz_image_deinit(&theirs);
}

static void bench_strokes(tz_ctx *ctx, int32_t n, int32_t side, int runs,
                          const char *folder)
{
    double ours[RUNS_MAX], file[RUNS_MAX], rsvg[RUNS_MAX], t[2];
    char svg[300], png[300];
    tz_curve_set s;
    tz_image im = {0};
    bool theirs = true;
    snprintf(svg, sizeof svg, "%s/strokes.svg", folder);
    snprintf(png, sizeof png, "%s/strokes.png", folder);
    make_strokes(ctx, n, side, &s);
    bench_check(ctx, tz_curve_write_svg(ctx, svg, &s));
    for (int k = 0; k < runs; k++) {
        draw(ctx, &s, 1, 1, NULL, NULL, t, &im);
        ours[k] = t[0] + t[1];
        tz_image_deinit(&im);
        tz_curve_set again;
        double start = bench_now();
        bench_check(ctx, tz_curve_read_svg(ctx, svg,
                                           &(tz_curve_read_options){.as_drawn = true},
                                           &again));
        draw(ctx, &again, 1, 1, NULL, NULL, t, &im);
        bench_check(ctx, tz_image_write(ctx, png, &im, NULL));
        file[k] = bench_now() - start;
        tz_curve_set_deinit(&again);
        start = bench_now();
        theirs = theirs && convert(svg, png, &im);
        rsvg[k] = bench_now() - start;
        tz_image_deinit(&im);
    }
    report("strokes", "ours", n, side, ours, runs);
    report("strokes", "file", n, side, file, runs);
    if (theirs)
        report("strokes", "rsvg-convert", n, side, rsvg, runs);
    compare(ctx, "strokes", &s, 1, svg, png);
    tz_curve_set_deinit(&s);
    unlink(svg);
    unlink(png);
}

/* A bent net whose meshes come from a like net in a photo of stones. */
static void make_net(tz_ctx *ctx, int32_t cells, double side, int32_t photo,
                     tz_curve_set *s)
{
    int32_t pen, id;
    const int32_t row = cells + 1;
    *s = (tz_curve_set){.domain = {.size = {side, side, 0}},
                        .element = {.domain = {.size = {side, side, 0}}, .ctx = ctx},
                        .ctx = ctx};
    bench_check(ctx, tz_curve_add_pen(s, (tz_curve_pen){4, 0x202020ff, 1, 1}, &pen));
    for (int32_t j = 0; j < row; j++)
        for (int32_t i = 0; i < row; i++) {
            const double x = side * i / cells, y = side * j / cells;
            const tz_vec2 p = {x + 12 * sin(y / 70), y + 12 * cos(x / 90)};
            bench_check(ctx, tz_curve_add_node(s, p, &id));
        }
    for (int way = 0; way < 2; way++)
        for (int32_t k = 0; k < row; k++) {
            bench_check(ctx, tz_curve_begin(s, pen));
            for (int32_t m = 0; m < cells; m++) {
                const int32_t a = way ? m * row + k : k * row + m,
                              b = way ? a + row : a + 1;
                const tz_bezier c = tz_bezier_line(s->node.v[a], s->node.v[b]);
                bench_check(ctx, tz_curve_cubic(s, a, b, c.p[1], c.p[2]));
                const double mesh = side / cells;
                const tz_vec2 from = {fmod((way ? k : m) * mesh, photo - mesh),
                                      fmod((way ? m : k) * mesh, photo - mesh)};
                const tz_vec2 to = {from.x + (way ? 0 : mesh), from.y + (way ? mesh : 0)};
                bench_check(ctx,
                            tz_array_push(ctx, &s->origin, tz_bezier_line(from, to)));
            }
            tz_curve_end(s, false);
        }
}

static void bench_strips(tz_ctx *ctx, int32_t side, int runs)
{
    double prepare[RUNS_MAX], render[RUNS_MAX], t[2];
    enum { PHOTO = 512, CELLS = 31 };
    tz_curve_set s;
    tz_image im = {0};
    tz_scene scene = {0};
    bench_check(ctx, tz_scene_render(ctx, TZ_SCENE_MOSAIC, TZ_SCENE_CLEAN, PHOTO, PHOTO,
                                     1, &scene));
    const tz_element_pixels px = {&scene.photo, NULL, NULL};
    make_net(ctx, CELLS, side, PHOTO, &s);
    for (int k = 0; k < runs; k++) {
        draw(ctx, &s, 1, 1, NULL, &px, t, &im);
        prepare[k] = t[0];
        render[k] = t[1];
        tz_image_deinit(&im);
    }
    report("photo", "prepare", s.piece.n, side, prepare, runs);
    report("photo", "render", s.piece.n, side, render, runs);
    tz_scene_deinit(&scene);
    tz_curve_set_deinit(&s);
}

int main(int argc, char **argv)
{
    const int32_t n = argc > 1 ? atoi(argv[1]) : 10000,
                  side = argc > 2 ? atoi(argv[2]) : 2048;
    const int runs = argc > 3 ? atoi(argv[3]) : 5;
    tz_ctx *ctx = NULL;
    char folder[] = "/tmp/terrazzo-bench-XXXXXX", svg[300], png[300];
    if (n < 1 || side < 16 || runs < 1 || runs > RUNS_MAX || !mkdtemp(folder) ||
        tz_ctx_new(&(tz_ctx_options){.threads = argc > 4 ? atoi(argv[4]) : 0}, &ctx) !=
            TZ_OK)
        return 2;
    bench_strokes(ctx, n, side, runs, folder);
    bench_strips(ctx, side, runs);
    if (argc > 6) {
        tz_curve_set s;
        snprintf(svg, sizeof svg, "%s/layout.svg", folder);
        snprintf(png, sizeof png, "%s/layout.png", folder);
        bench_check(ctx, tz_curve_read_svg(ctx, argv[5], NULL, &s));
        compare(ctx, "layout", &s, atof(argv[6]), svg, png);
        tz_curve_set_deinit(&s);
        unlink(svg);
        unlink(png);
    }
    rmdir(folder);
    tz_ctx_free(ctx);
    return 0;
}
