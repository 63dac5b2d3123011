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
 * a brush over one element in a hundred of a settled layout: replace, settle.
 *
 *   bench_fill drawing PALETTE.svg STROKES.svg SIDE OUT.svg
 *
 * a palette and strokes that are given: figures and a layout.
 *
 *   bench_fill cases OUT [NAME]
 *
 * ten cases, four ways: ours; as published (all at random places, no repair); and the
 * two-step alternative of [Hsu20] Fig. 21, a full field by Laplacian interpolation
 * (tz_frames) that elements are forced to follow, as published and with our start and
 * repair. Drawings go to the folder OUT. One line each: covered, overlap, hole (over the
 * side), turn between neighbours, angle to strokes (degrees). */
#include <math.h>

#include "elements/element_io.h"
#include "elements/frames.h"
#include "fields/fill_internal.h"
#include "tests/bench/bench.h"

static const char leaf[] = "<path d=\"M-10,0 C-5,-5 4,-5 10,0 C4,5 -5,5 -10,0Z\" "
                           "fill=\"#4a8f3c\"/>";
static const char round_[] = "<circle r=\"4\" fill=\"#c8553d\"/>";
static const char bar[] =
    "<path d=\"M-20,-3 L18,-3 L20,0 L18,3 L-20,3Z\" fill=\"#588b8b\"/>";
static const char drop[] = "<path d=\"M-7,0 C-3,-1 0,-5 4,-5 C10,-5 10,5 4,5 C0,5 -3,1 "
                           "-7,0Z\" fill=\"#f28f3b\"/>";

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
    const char *shape[] = {leaf, round_, drop};
    tz_element_set palette, layout;
    tz_fill *f;
    tz_fill_params p = defaults();
    make_palette(ctx, shape, 3, &palette);
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
    printf("edit %d elements, %.2f %% under the brush: median %.4f s, processor %.4f s\n",
           count, 100 * (TZ_PI * 0.05 * 0.05 + 0.1 * 0.0429), bench_median(wall, 9),
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

/* ---- cases -------------------------------------------------------------------------- */

typedef enum shape { RECTANGLE, RING, LETTER, ANIMAL } shape;

typedef struct test_case {
    const char *name;
    shape domain;
    const char *strokes; /* path data in a square of 600 */
    const char *thing[4];
    double rigidity, size[2];
    bool torus;
} test_case;

static const test_case cases[] = {
    {"sparse-leaves",
     RECTANGLE,
     "M60,420 C200,150 380,520 540,180",
     {leaf},
     100,
     {1, 1},
     0},
    {"dense-mix",
     RECTANGLE,
     "M40,80 C200,20 380,140 560,80 M40,220 C200,160 380,280 560,220 M40,360 C200,300 "
     "380,420 560,360 M40,500 C200,440 380,560 560,500",
     {leaf, round_, drop},
     100,
     {1, 1},
     0},
    {"crossing-leaves",
     RECTANGLE,
     "M60,60 L540,540 M60,540 L540,60",
     {leaf, drop},
     100,
     {1, 1},
     0},
    {"circular-bars",
     RECTANGLE,
     "M300,110 C405,110 490,195 490,300 C490,405 405,490 300,490 C195,490 110,405 "
     "110,300 C110,195 195,110 300,110Z",
     {bar},
     100,
     {1, 1},
     0},
    {"singular-leaves",
     RECTANGLE,
     "M300,300 L560,300 M300,300 L300,560 M300,300 L40,300 M300,300 L300,40",
     {leaf},
     100,
     {1, 1},
     0},
    {"ring-drops",
     RING,
     "M300,40 C440,40 560,160 560,300",
     {drop, round_},
     100,
     {1, 1},
     0},
    {"letter-soft", LETTER, "M150,90 L450,90 M300,150 L300,550", {bar}, 0, {1, 1}, 0},
    {"animal-leaves",
     ANIMAL,
     "M110,250 C250,200 380,200 520,180",
     {leaf, round_},
     100,
     {1, 1},
     0},
    {"mixed-sizes",
     RECTANGLE,
     "M60,300 C200,100 400,500 540,300",
     {leaf, round_},
     100,
     {0.4, 3.2},
     0},
    {"soft-bars",
     RECTANGLE,
     "M60,480 C200,100 400,100 540,480",
     {bar, round_},
     0,
     {1, 1},
     0},
};

static double capsule(double x, double y, double ax, double ay, double bx, double by,
                      double r)
{
    const double dx = bx - ax, dy = by - ay;
    double t = ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy);
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    return r - hypot(x - ax - t * dx, y - ay - t * dy);
}

static bool inside(shape s, double x, double y)
{
    switch (s) {
    case RING: return fabs(hypot(x - 300, y - 300) - 200) < 90;
    case LETTER:
        return (x > 60 && x < 540 && y > 30 && y < 150) ||
               (x > 230 && x < 370 && y > 30 && y < 570);
    case ANIMAL:
        return capsule(x, y, 150, 280, 430, 280, 90) > 0 ||
               capsule(x, y, 430, 260, 520, 160, 55) > 0 ||
               capsule(x, y, 120, 300, 100, 540, 35) > 0 ||
               capsule(x, y, 200, 330, 210, 550, 35) > 0 ||
               capsule(x, y, 370, 330, 360, 550, 35) > 0 ||
               capsule(x, y, 460, 310, 490, 540, 35) > 0 ||
               capsule(x, y, 80, 260, 30, 130, 20) > 0;
    default: return true;
    }
}

static tz_region *region_of(tz_ctx *ctx, shape s, tz_vec3 size)
{
    enum { SIDE = 300 };
    static float mask[SIDE * SIDE];
    tz_region *r = NULL;
    for (int i = 0; i < SIDE * SIDE; i++)
        mask[i] = inside(s, (i % SIDE + 0.5) * 2, (i / SIDE + 0.5) * 2) ? 1.0f : 0;
    if (s != RECTANGLE)
        bench_check(ctx, tz_region_from_mask(ctx, mask, SIDE, SIDE, size, false, &r));
    return r;
}

static void write_strokes(const char *path, const char *data)
{
    FILE *f = fopen(path, "w");
    if (!f) {
        fprintf(stderr, "bench: cannot write %s\n", path);
        exit(1);
    }
    fprintf(f,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 600 600\"><path "
            "d=\"%s\" fill=\"none\" stroke=\"#000\" stroke-width=\"8\"/></svg>",
            data);
    fclose(f);
}

/* A full field: what the membrane through the strokes says, everywhere. */
static void full_field(tz_ctx *ctx, const char *path, tz_vec3 size, tz_element_field *f)
{
    tz_frames *frames;
    bench_check(ctx, tz_frames_read(ctx, path, size, false, &frames));
    bench_check(ctx, tz_element_field_init(ctx, size, false, 0, f));
    const int32_t w = f->raster.width, n = w * f->raster.height;
    bench_check(ctx, tz_alloc(ctx, &f->image, (size_t)n, sizeof *f->image));
    for (int32_t i = 0; i < n; i++) {
        const tz_vec3 at = {(i % w + 0.5) * size.x / w, (i / w + 0.5) * size.x / w, 0};
        const double a = tz_frames_angle(frames, at);
        f->image[i] = (tz_element_field_cell){(float)cos(a), (float)sin(a), 0, -1, {1000}};
    }
    bench_check(ctx, tz_element_field_settle(f));
    tz_frames_free(frames);
}

static void run_case(tz_ctx *ctx, const test_case *c, const char *out)
{
    static const char *const way[] = {"ours", "published", "two-step", "two-step-ours"};
    const tz_vec3 size = {600, 600, 0};
    tz_element_set palette;
    tz_element_field field, full;
    char path[1024], markup[2048];
    tz_fill_entry entry[4];
    int things = 0;
    while (things < 4 && c->thing[things])
        things++;
    make_palette(ctx, c->thing, things, &palette);
    for (int k = 0; k < things; k++)
        entry[k] = (tz_fill_entry){k, 1, c->rigidity, {c->size[0], c->size[1]}, 0, 0};
    snprintf(path, sizeof path, "%s/%s-strokes.svg", out, c->name);
    write_strokes(path, c->strokes);
    bench_check(ctx, tz_element_field_read(ctx, path, size, false, &field));
    full_field(ctx, path, size, &full);
    const tz_domain d = {.size = size, .region = region_of(ctx, c->domain, size)};
    for (int k = 0; k < 4; k++) {
        tz_element_set layout;
        tz_fill_report r;
        tz_fill_params p = defaults();
        const bool published = k == 1 || k == 2;
        p.start = published ? TZ_FILL_RANDOM : TZ_FILL_INSERT;
        p.repair = !published;
        p.alpha = k >= 2 ? 0 : 1;
        const tz_fill_job job = {.palette = &palette,
                                 .entry = entry,
                                 .entries = things,
                                 .domain = d,
                                 .field = k >= 2 ? &full : &field,
                                 .params = &p,
                                 .seed = 7};
        bench_check(ctx, tz_element_set_like(ctx, &palette, &d, &layout));
        bench_check(ctx, tz_fill_run(ctx, &job, &layout, &r));
        tz_fill_report m;
        bench_check(ctx, tz_fill_measure(ctx, &layout, &palette, &field, 0, &m));
        printf("%-16s %-14s elements %4d covered %.3f overlap %.4f hole %.4f turn %5.2f "
               "align %5.2f shrunk %d dropped %d inserted %d seconds %.2f\n",
               c->name, way[k], m.elements, m.covered, m.overlap, m.hole / size.x,
               m.turn * 180 / TZ_PI, m.align * 180 / TZ_PI, r.shrunk, r.dropped,
               r.inserted, r.seconds);
        snprintf(markup, sizeof markup,
                 "<rect width=\"600\" height=\"600\" fill=\"#fff\"/><path d=\"%s\" "
                 "fill=\"none\" stroke=\"#bbb\" stroke-width=\"8\"/>",
                 c->strokes);
        tz_free(ctx, layout.background);
        bench_check(ctx, tz_strdup(ctx, markup, &layout.background));
        snprintf(path, sizeof path, "%s/%s-%s.svg", out, c->name, way[k]);
        bench_check(ctx, tz_element_write_svg(ctx, path, &layout));
        tz_element_set_deinit(&layout);
    }
    tz_region_free((tz_region *)d.region);
    tz_element_field_deinit(&field);
    tz_element_field_deinit(&full);
    tz_element_set_deinit(&palette);
}

int main(int argc, char **argv)
{
    tz_ctx *ctx;
    const char *what = argc > 1 ? argv[1] : "speed";
    if (tz_ctx_new(NULL, &ctx) != TZ_OK)
        return 1;
    if (strcmp(what, "cases") == 0 && argc > 2) {
        for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
            if (argc < 4 || strstr(cases[k].name, argv[3]))
                run_case(ctx, &cases[k], argv[2]);
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
