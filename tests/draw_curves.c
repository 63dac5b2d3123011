/* SPDX-License-Identifier: Apache-2.0 */
/* Figures of curve textures, as SVG.
 *
 *   draw_curves sheet     -o OUT.svg EXEMPLAR.svg LAYOUT.svg [EXEMPLAR.svg LAYOUT.svg ...]
 *   draw_curves levels    -o OUT.svg EXEMPLAR.svg   samples of the exemplar, of the result
 *   draw_curves starts    -o OUT.svg EXEMPLAR.svg   from noise, and from patches ([Tu20] 14)
 *   draw_curves ablations -o OUT.svg EXEMPLAR.svg   without each of the terms ([Tu20] 16)
 *   draw_curves energy    -o OUT.svg EXEMPLAR.svg   mean energy by iteration of all these
 *   draw_curves hole      -o OUT.svg EXEMPLAR.svg SHAPE.svg   what lies outside a shape
 *
 * Options: --grow N (sides of the result, of the exemplar's; 2), --seed N, --iterations N.
 * Results run smoothly through their samples, as published: what the optimiser does is
 * what shows. */
#include "base/svg.h"
#include "curves/clip.h"
#include "curves/curve_compare.h"
#include "curves/curve_io.h"
#include "curves/reconstruct.h"
#include "curves/synthesis.h"
#include "elements/region.h"
#include "tests/bench/bench.h"

enum { PANEL = 480, GAP = 16, TEXT = 22, MOST_STEPS = 512 };

typedef struct options {
    const char *out;
    double grow;
    uint64_t seed;
    int32_t iterations, first;
} options;

/* A run of the optimiser with all that is drawn of it. */
typedef struct result {
    const char *name;
    tz_curve_synthesis_params params;
    tz_sample_graph graph, exemplar, level[TZ_SAMPLE_LEVELS];
    tz_curve_energy energy[MOST_STEPS];
    int32_t steps;
    tz_curve_set curves;
    tz_curve_likeness likeness;
    tz_domain domain;
    tz_ctx *ctx;
} result;

/* ---- the optimiser, watched ---------------------------------------------------------- */

/* Places and edges of a graph. */
static void copy_graph(tz_ctx *ctx, const tz_sample_graph *g, tz_sample_graph *to)
{
    tz_sample_graph_deinit(to);
    *to = (tz_sample_graph){
        .ctx = ctx, .domain = g->domain, .spacing = g->spacing, .radius = g->radius};
    for (int32_t i = 0; i < g->sample.n; i++)
        bench_check(ctx, tz_array_push(ctx, &to->sample, g->sample.v[i]));
    for (int32_t i = 0; i < g->edge.n; i++)
        bench_check(ctx, tz_array_push(ctx, &to->edge, g->edge.v[i]));
}

static void watch(void *user, const tz_curve_energy *e, const tz_sample_graph *g)
{
    result *r = user;
    if (r->steps < MOST_STEPS)
        r->energy[r->steps++] = *e;
    if (e->level >= 0 && e->level < TZ_SAMPLE_LEVELS)
        copy_graph(r->ctx, g, &r->level[e->level]);
}

static void solve(tz_ctx *ctx, const options *o, const tz_curve_set *exemplar, result *r)
{
    r->domain = exemplar->domain;
    r->domain.size.x *= o->grow;
    r->domain.size.y *= o->grow;
    r->ctx = ctx;
    const tz_curve_synthesis_job job = {.exemplar = exemplar,
                                        .domain = &r->domain,
                                        .params = &r->params,
                                        .seed = o->seed,
                                        .trace = watch,
                                        .user = r};
    const double start = bench_now();
    bench_check(ctx, tz_curve_synthesis(ctx, &job, &r->graph, &r->exemplar, NULL));
    const double seconds = bench_now() - start;
    bench_check(ctx, tz_curve_reconstruct(ctx, &r->graph, exemplar, &r->curves));
    bench_check(ctx, tz_curve_compare(ctx, exemplar, &r->curves, &r->likeness));
    printf("%-22s %6d samples  energy %8.4f  mean ratio %5.2f  %6.2f s\n", r->name,
           r->graph.sample.n, r->steps > 0 ? r->energy[r->steps - 1].mean : 0,
           r->likeness.mean, seconds);
}

static result begin_result(const options *o, const char *name)
{
    result r;
    memset(&r, 0, sizeof r);
    tz_params_default(&tz_curve_synthesis_param_table, &r.params);
    if (o->iterations >= 0)
        r.params.iterations = o->iterations;
    r.name = name;
    return r;
}

static void end_result(result *r)
{
    tz_sample_graph_deinit(&r->graph);
    tz_sample_graph_deinit(&r->exemplar);
    for (int i = 0; i < TZ_SAMPLE_LEVELS; i++)
        tz_sample_graph_deinit(&r->level[i]);
    tz_curve_set_deinit(&r->curves);
}

/* ---- panels -------------------------------------------------------------------------- */

static void put_label(tz_svg_writer *w, double x, double y, const char *text)
{
    tz_svg_begin(w, "text");
    tz_svg_set_number(w, "x", x);
    tz_svg_set_number(w, "y", y + 15);
    tz_svg_set(w, "font-family", "sans-serif");
    tz_svg_set(w, "font-size", "14");
    tz_svg_put_text(w, text);
    tz_svg_end(w);
}

/* A window of a domain; what is put next is clipped to it. */
static void begin_panel(tz_svg_writer *w, double x, double y, double width, double height,
                        tz_vec3 size)
{
    tz_svg_begin(w, "svg");
    tz_svg_set_number(w, "x", x);
    tz_svg_set_number(w, "y", y);
    tz_svg_set_number(w, "width", width);
    tz_svg_set_number(w, "height", height);
    tz_svg_setf(w, "viewBox", "0 0 %.9g %.9g", size.x, size.y);
    tz_svg_begin(w, "rect");
    tz_svg_set_number(w, "width", size.x);
    tz_svg_set_number(w, "height", size.y);
    tz_svg_set(w, "fill", "#fbfaf7");
    tz_svg_end(w);
}

static void put_set(tz_svg_writer *w, const tz_curve_set *s, const char *colour)
{
    for (int32_t i = 0; i < s->path.n; i++) {
        const tz_curve_path *p = &s->path.v[i];
        const size_t room = (size_t)p->pieces * 160 + 64;
        char *d = NULL, *end;
        bench_check(s->ctx, tz_alloc(s->ctx, &d, room, 1));
        end = d;
        for (int32_t k = p->piece; k < p->piece + p->pieces; k++) {
            const tz_bezier c = tz_curve_bezier(s, &s->piece.v[k]);
            if (k == p->piece || s->domain.torus)
                end += snprintf(end, room - (size_t)(end - d), "M%.7g %.7g", c.p[0].x,
                                c.p[0].y);
            end +=
                snprintf(end, room - (size_t)(end - d), "C%.7g %.7g %.7g %.7g %.7g %.7g",
                         c.p[1].x, c.p[1].y, c.p[2].x, c.p[2].y, c.p[3].x, c.p[3].y);
        }
        tz_svg_begin(w, "path");
        tz_svg_set(w, "d", d);
        tz_svg_set(w, "fill", "none");
        tz_svg_set(w, "stroke", colour);
        tz_svg_set_number(w, "stroke-width", s->pen.v[p->pen].width);
        tz_svg_end(w);
        tz_free(s->ctx, d);
    }
}

static void put_graph(tz_svg_writer *w, const tz_sample_graph *g)
{
    for (int32_t i = 0; i < g->edge.n; i++) {
        const tz_vec2 p = g->sample.v[g->edge.v[i].from].at,
                      q = tz_curve_copy(&g->domain, g->sample.v[g->edge.v[i].to].at, p);
        tz_svg_begin(w, "line");
        tz_svg_set_number(w, "x1", p.x);
        tz_svg_set_number(w, "y1", p.y);
        tz_svg_set_number(w, "x2", q.x);
        tz_svg_set_number(w, "y2", q.y);
        tz_svg_set(w, "stroke", "#8899aa");
        tz_svg_set_number(w, "stroke-width", g->spacing / 14);
        tz_svg_end(w);
    }
    for (int32_t i = 0; i < g->sample.n; i++) {
        tz_svg_begin(w, "circle");
        tz_svg_set_number(w, "cx", g->sample.v[i].at.x);
        tz_svg_set_number(w, "cy", g->sample.v[i].at.y);
        tz_svg_set_number(w, "r", g->spacing / 7);
        tz_svg_set(w, "fill", "#c03020");
        tz_svg_end(w);
    }
}

static tz_svg_writer open_sheet(tz_ctx *ctx, const options *o, double width,
                                double height)
{
    tz_svg_writer w;
    bench_check(ctx, tz_svg_writer_open(ctx, o->out, width, height, &w));
    tz_svg_begin(&w, "rect");
    tz_svg_set_number(&w, "width", width);
    tz_svg_set_number(&w, "height", height);
    tz_svg_set(&w, "fill", "#ffffff");
    tz_svg_end(&w);
    return w;
}

/* Results side by side behind the exemplar, all at one scale. */
/* The exemplar and the results, three a row, at one scale. */
static void draw_results(tz_ctx *ctx, const options *o, const tz_curve_set *exemplar,
                         const result *r, int n)
{
    const double scale = PANEL / r[0].domain.size.x, tall = r[0].domain.size.y * scale,
                 w0 = exemplar->domain.size.x * scale,
                 h0 = exemplar->domain.size.y * scale, row = TEXT + fmax(tall, h0) + GAP;
    tz_svg_writer w =
        open_sheet(ctx, o, 3 * (PANEL + GAP) - GAP, (n / 3 + 1) * row - GAP);
    char label[128];
    put_label(&w, 0, 0, "exemplar");
    begin_panel(&w, 0, TEXT, w0, h0, exemplar->domain.size);
    put_set(&w, exemplar, "#203a5a");
    tz_svg_end(&w);
    for (int i = 0; i < n; i++) {
        const double x = (i + 1) % 3 * (PANEL + GAP), y = (i + 1) / 3 * row;
        snprintf(label, sizeof label, "%s: ratio %.2f", r[i].name, r[i].likeness.mean);
        put_label(&w, x, y, label);
        begin_panel(&w, x, y + TEXT, PANEL, tall, r[i].domain.size);
        put_set(&w, &r[i].curves, "#203a5a");
        tz_svg_end(&w);
    }
    bench_check(ctx, tz_svg_writer_close(&w));
}

static void draw_levels(tz_ctx *ctx, const options *o, const tz_curve_set *exemplar,
                        const result *r)
{
    const tz_sample_levels l = tz_sample_levels_default(exemplar);
    const double scale = PANEL / r->domain.size.x, tall = r->domain.size.y * scale,
                 w0 = exemplar->domain.size.x * scale,
                 h0 = exemplar->domain.size.y * scale;
    tz_svg_writer w =
        open_sheet(ctx, o, l.levels * (PANEL + GAP) - GAP, 2 * TEXT + h0 + GAP + tall);
    char label[128];
    for (int i = 0; i < l.levels; i++) {
        const double x = i * (PANEL + GAP);
        tz_sample_graph g;
        bench_check(ctx,
                    tz_sample_graph_make(ctx, exemplar, l.spacing[i], l.radius[i], &g));
        snprintf(label, sizeof label, "level %d: exemplar, %d samples", i + 1,
                 g.sample.n);
        put_label(&w, x, 0, label);
        begin_panel(&w, x, TEXT, w0, h0, exemplar->domain.size);
        put_graph(&w, &g);
        tz_svg_end(&w);
        snprintf(label, sizeof label, "result, %d samples", r->level[i].sample.n);
        put_label(&w, x, TEXT + h0 + GAP, label);
        begin_panel(&w, x, 2 * TEXT + h0 + GAP, PANEL, tall, r->domain.size);
        put_graph(&w, &r->level[i]);
        tz_svg_end(&w);
        tz_sample_graph_deinit(&g);
    }
    bench_check(ctx, tz_svg_writer_close(&w));
}

/* Energy a sample, logarithmic, over all iterations; a line for each result. */
static void draw_energy(tz_ctx *ctx, const options *o, const result *r, int n)
{
    static const char *const colour[] = {"#203a5a", "#c03020", "#2a8a4a", "#b07a10",
                                         "#7a3a9a"};
    const double wide = 720, tall = 400, left = 60;
    double lo = INFINITY, hi = 0;
    int32_t steps = 1;
    for (int i = 0; i < n; i++)
        for (int32_t k = 0; k < r[i].steps; k++) {
            lo = r[i].energy[k].mean > 0 ? fmin(lo, r[i].energy[k].mean) : lo;
            hi = fmax(hi, r[i].energy[k].mean);
            steps = r[i].steps > steps ? r[i].steps : steps;
        }
    if (!(lo < hi))
        lo = hi / 2 + 1e-9, hi = 2 * lo;
    tz_svg_writer w = open_sheet(ctx, o, left + wide + 240, tall + 60);
    char label[160];
    for (double v = pow(10, floor(log10(lo))); v <= hi; v *= 10) {
        const double y = 20 + tall * (1 - log(v / lo) / log(hi / lo));
        if (v < lo)
            continue;
        snprintf(label, sizeof label, "%g", v);
        put_label(&w, 8, y - 10, label);
        tz_svg_begin(&w, "line");
        tz_svg_set_number(&w, "x1", left);
        tz_svg_set_number(&w, "x2", left + wide);
        tz_svg_set_number(&w, "y1", y);
        tz_svg_set_number(&w, "y2", y);
        tz_svg_set(&w, "stroke", "#cccccc");
        tz_svg_end(&w);
    }
    for (int i = 0; i < n; i++) {
        char points[MOST_STEPS * 24] = "", *end = points;
        for (int32_t k = 0; k < r[i].steps; k++)
            end += snprintf(
                end, sizeof points - (size_t)(end - points), "%.2f,%.2f ",
                left + wide * (k + 0.5) / steps,
                20 + tall * (1 - log(fmax(r[i].energy[k].mean, lo) / lo) / log(hi / lo)));
        tz_svg_begin(&w, "polyline");
        tz_svg_set(&w, "points", points);
        tz_svg_set(&w, "fill", "none");
        tz_svg_set(&w, "stroke", colour[i % 5]);
        tz_svg_set(&w, "stroke-width", "2");
        tz_svg_end(&w);
        tz_svg_begin(&w, "rect");
        tz_svg_set_number(&w, "x", left + wide + 16);
        tz_svg_set_number(&w, "y", 26 + 24 * i);
        tz_svg_set(&w, "width", "16");
        tz_svg_set(&w, "height", "4");
        tz_svg_set(&w, "fill", colour[i % 5]);
        tz_svg_end(&w);
        put_label(&w, left + wide + 40, 18 + 24 * i, r[i].name);
    }
    put_label(&w, left, tall + 30,
              "iterations of all levels; mean match energy of a sample, in spacings");
    bench_check(ctx, tz_svg_writer_close(&w));
}

/* ---- commands ------------------------------------------------------------------------ */

static void draw_sheet(tz_ctx *ctx, const options *o, int argc, char **argv)
{
    const int pairs = (argc - o->first) / 2;
    tz_curve_set *s;
    double y = 0, wide = 0;
    bench_check(ctx, tz_alloc_zero(ctx, &s, 2 * (size_t)pairs, sizeof *s));
    for (int i = 0; i < 2 * pairs; i++) {
        bench_check(ctx, tz_curve_read_svg(ctx, argv[o->first + i], NULL, &s[i]));
        const double scale = PANEL / s[i & ~1].domain.size.x;
        wide = fmax(wide, PANEL + GAP + scale * s[i].domain.size.x);
        if (i & 1)
            y += TEXT + GAP + scale * fmax(s[i - 1].domain.size.y, s[i].domain.size.y);
    }
    tz_svg_writer w = open_sheet(ctx, o, wide, y);
    y = 0;
    for (int i = 0; i < pairs; i++) {
        const tz_curve_set *a = &s[2 * i], *b = a + 1;
        const double scale = PANEL / a->domain.size.x;
        const char *name = strrchr(argv[o->first + 2 * i], '/');
        tz_curve_likeness q;
        char label[160];
        bench_check(ctx, tz_curve_compare(ctx, a, b, &q));
        snprintf(label, sizeof label, "%.60s", name ? name + 1 : argv[o->first + 2 * i]);
        put_label(&w, 0, y, label);
        snprintf(label, sizeof label, "ratio %.2f, length %.3f, ends %.3f, degrees %.3f",
                 q.mean, q.length[1] / q.length[0],
                 q.dangling[0] > 0 ? q.dangling[1] / q.dangling[0] : 1, q.degree_off);
        put_label(&w, PANEL + GAP, y, label);
        for (int k = 0; k < 2; k++) {
            const tz_curve_set *c = k ? b : a;
            begin_panel(&w, k * (PANEL + GAP), y + TEXT, scale * c->domain.size.x,
                        scale * c->domain.size.y, c->domain.size);
            put_set(&w, c, "#203a5a");
            tz_svg_end(&w);
        }
        y += TEXT + GAP + scale * fmax(a->domain.size.y, b->domain.size.y);
    }
    bench_check(ctx, tz_svg_writer_close(&w));
    for (int i = 0; i < 2 * pairs; i++)
        tz_curve_set_deinit(&s[i]);
    tz_free(ctx, s);
}

static void draw_runs(tz_ctx *ctx, const options *o, const char *what, const char *path)
{
    const bool all = strcmp(what, "energy") == 0, starts = strcmp(what, "starts") == 0,
               levels = strcmp(what, "levels") == 0;
    result *r;
    tz_curve_set exemplar;
    int n = 0;
    bench_check(ctx, tz_alloc_zero(ctx, &r, 5, sizeof *r));
    bench_check(ctx, tz_curve_read_svg(ctx, path, NULL, &exemplar));
    r[n++] = begin_result(o, starts ? "from patches" : "all terms");
    if (!levels) {
        r[n] = begin_result(o, "from noise");
        r[n++].params.start = TZ_CURVE_NOISE;
    }
    if (!starts && !levels) {
        r[n] = begin_result(o, "without edges");
        r[n++].params.edges = false;
        r[n] = begin_result(o, "without robust matching");
        r[n++].params.robust = false;
        r[n] = begin_result(o, "without existence");
        r[n++].params.existence = false;
    }
    for (int i = 0; i < n; i++)
        solve(ctx, o, &exemplar, &r[i]);
    if (levels)
        draw_levels(ctx, o, &exemplar, r);
    else if (all)
        draw_energy(ctx, o, r, n);
    else
        draw_results(ctx, o, &exemplar, r, n);
    for (int i = 0; i < n; i++)
        end_result(&r[i]);
    tz_free(ctx, r);
    tz_curve_set_deinit(&exemplar);
}

/* What of a drawing lies outside a shape, as a document. */
static void draw_hole(tz_ctx *ctx, const options *o, const char *drawing,
                      const char *shape)
{
    tz_curve_set from, to;
    tz_region *region = NULL;
    bench_check(ctx, tz_curve_read_svg(ctx, drawing, NULL, &from));
    bench_check(ctx, tz_region_read(ctx, shape, from.domain.size, false, &region));
    const tz_curve_window window = {.region = region, .outside = true};
    bench_check(ctx, tz_curve_clip(ctx, &from, &window, &to));
    bench_check(ctx, tz_curve_write_svg(ctx, o->out, &to));
    tz_region_free(region);
    tz_curve_set_deinit(&to);
    tz_curve_set_deinit(&from);
}

int main(int argc, char **argv)
{
    options o = {.grow = 2, .seed = 1, .iterations = -1, .first = 2};
    for (; o.first + 1 < argc && argv[o.first][0] == '-'; o.first += 2) {
        const char *name = argv[o.first], *value = argv[o.first + 1];
        if (strcmp(name, "-o") == 0)
            o.out = value;
        else if (strcmp(name, "--grow") == 0)
            o.grow = strtod(value, NULL);
        else if (strcmp(name, "--seed") == 0)
            o.seed = strtoull(value, NULL, 10);
        else if (strcmp(name, "--iterations") == 0)
            o.iterations = (int32_t)strtol(value, NULL, 10);
    }
    if (!o.out || o.first >= argc || !(o.grow > 0)) {
        fprintf(stderr,
                "use: draw_curves sheet|levels|starts|ablations|energy|hole -o OUT.svg "
                "[--grow N] [--seed N] [--iterations N] DRAWING.svg ...\n");
        return 2;
    }
    tz_ctx *ctx = bench_ctx(0);
    if (strcmp(argv[1], "sheet") == 0)
        draw_sheet(ctx, &o, argc, argv);
    else if (strcmp(argv[1], "hole") == 0 && o.first + 1 < argc)
        draw_hole(ctx, &o, argv[o.first], argv[o.first + 1]);
    else
        draw_runs(ctx, &o, argv[1], argv[o.first]);
    tz_ctx_free(ctx);
    return 0;
}
