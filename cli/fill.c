/* SPDX-License-Identifier: Apache-2.0 */
#include "fields/fill.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/svg.h"
#include "cli/element_exemplar.h"
#include "cli/exemplars.h"
#include "cli/figures.h"
#include "cli/fill_show.h"
#include "cli/material.h"
#include "elements/element_io.h"
#include "fields/fill_paint.h"
#include "fields/mix.h"
#include "synthesis/element_ground.h"
#include "synthesis/expand.h"

typedef struct own_params {
    char domain[TZ_PARAM_STRING_SIZE], field[TZ_PARAM_STRING_SIZE],
        directions[TZ_PARAM_STRING_SIZE], sizes[TZ_PARAM_STRING_SIZE],
        densities[TZ_PARAM_STRING_SIZE], mix[TZ_PARAM_STRING_SIZE],
        keep[TZ_PARAM_STRING_SIZE], brush[TZ_PARAM_STRING_SIZE];
    double brush_radius;
    int32_t size[2];
    bool tile, preview;
    int32_t count;
    uint64_t seed;
} own_params;

typedef struct trace_params {
    char trace[TZ_PARAM_STRING_SIZE], frames[TZ_PARAM_STRING_SIZE];
} trace_params;

typedef struct values {
    tz_common_params common;
    tz_output_params output;
    own_params own;
    tz_show_params show;
    trace_params trace;
    tz_fill_params fill;
    tz_medium_params medium;
    tz_things_params things;
    tz_ebpt_params analyze;
} values;

#define AT(m) offsetof(own_params, m)
static const tz_param own_rows[] = {
    {"domain", TZ_PARAM_STRING, AT(domain), 0, 0, "", "FILE", NULL,
     "Shape to fill, an image (light = inside) or an SVG of closed paths, stretched over "
     "the layout."},
    {"field", TZ_PARAM_STRING, AT(field), 0, 0, "", "FILE", NULL,
     "Strokes that things turn, grow and gather along: an SVG whose paths point along "
     "themselves and speak under their width; size=, density= and weight= stand in their "
     "tz:class. Or an image of directions."},
    {"directions", TZ_PARAM_STRING, AT(directions), 0, 0, "", "FILE", NULL,
     "Image of directions beneath the strokes: red and green are the vector (green "
     "points "
     "down; 0.5 = 0, in files of floating point numbers, as EXR, 0 = 0), a grey value "
     "the "
     "angle."},
    {"sizes", TZ_PARAM_STRING, AT(sizes), 0, 0, "", "FILE", NULL,
     "Image of sizes beneath the strokes: mid grey is the palette's own."},
    {"densities", TZ_PARAM_STRING, AT(densities), 0, 0, "", "FILE", NULL,
     "Image of densities beneath the strokes: black is sparse."},
    {"mix", TZ_PARAM_STRING, AT(mix), 0, 0, "", "TABLE", NULL,
     "Things by class, with shares of the count and what they are like: \"leaf:3 "
     "rigidity=20 size=0.5..2, stone:1 turn=90 jitter=10\"; else tz:mix of the palette's "
     "<svg>, else all in equal shares."},
    {"keep", TZ_PARAM_STRING, AT(keep), 0, 0, "", "FILE", NULL,
     "Layout whose elements that were moved by hand stay and are filled around; with "
     "--brush all that it holds stays. It sets the size."},
    {"brush", TZ_PARAM_STRING, AT(brush), 0, 0, "", "FILE", NULL,
     "SVG of strokes that are painted instead of filling the domain: black adds, red "
     "erases, magenta replaces, blue relaxes; op=, entry= and size= stand in their "
     "tz:class. What lies beside settles, the rest is held."},
    {"brush-radius", TZ_PARAM_DOUBLE, AT(brush_radius), 0, 1e9, "0", "", NULL,
     "Radius of all strokes of --brush, user units; 0 = half of each stroke's width."},
    {"size", TZ_PARAM_SIZE, AT(size), 0, 1 << 24, "0x0", "", NULL,
     "Of the layout, units of the palette; 0x0 = that of --domain, else 1024x1024."},
    {"tile", TZ_PARAM_BOOL, AT(tile), 0, 1, "false", "", NULL,
     "The layout repeats seamlessly."},
    {"count", TZ_PARAM_INT, AT(count), 0, 2000000, "0", "", NULL,
     "Elements; 0 = by their areas and --fill."},
    {"preview", TZ_PARAM_BOOL, AT(preview), 0, 1, "false", "", NULL,
     "Quick: few iterations, no repair."},
    {"seed", TZ_PARAM_UINT64, AT(seed), 0, 1.8e19, "1", "", NULL,
     "Names the variant: the same seed gives the same layout."},
};
#undef AT
static const tz_param_table own_table = {"domain", "What is filled, and what guides it.",
                                         own_rows, sizeof own_rows / sizeof own_rows[0],
                                         sizeof(own_params)};

#define AT(m) offsetof(trace_params, m)
static const tz_param trace_rows[] = {
    {"trace", TZ_PARAM_STRING, AT(trace), 0, 0, "", "FILE.csv", NULL,
     "Table of the energy of each term, by iteration."},
    {"frames", TZ_PARAM_STRING, AT(frames), 0, 0, "", "FILE.svg", NULL,
     "Layouts on the way, as FILE-000.svg and on, for a film strip."},
};
#undef AT
static const tz_param_table trace_table = {"trace", "How it came about.", trace_rows,
                                           sizeof trace_rows / sizeof trace_rows[0],
                                           sizeof(trace_params)};

typedef struct run_state {
    tz_cli *cli;
    values *v;
    tz_record record;
    tz_element_exemplar palette;
    tz_element_set layout, kept;
    tz_region *region;
    tz_element_field field;
    tz_fill_paint paint;
    tz_show show;
    tz_mix mix;
    tz_domain domain;
    char *path;
    tz_file_out trace;
    bool tracing;
    tz_status failed; /* of a frame */
} run_state;

/* ---- inputs -------------------------------------------------------------------------- */

static tz_status add_input(run_state *r, const char *path)
{
    tz_status s = tz_record_input(r->cli, &r->record, path, NULL);
    return s == TZ_OK
               ? tz_paths_add(r->cli->ctx, &r->palette.inputs, tz_cli_find(r->cli, path))
               : s;
}

static tz_status read_kept(run_state *r)
{
    const char *path = r->v->own.keep;
    if (!*path)
        return TZ_OK;
    tz_status s = tz_elements_read(r->cli, path, &r->v->medium, 0, &r->record, &r->kept);
    if (s == TZ_OK)
        s = tz_paths_add(r->cli->ctx, &r->palette.inputs, tz_cli_find(r->cli, path));
    if (s == TZ_OK && !tz_ramp_strip(&r->kept, &r->palette.set))
        s = tz_fail(r->cli->ctx, TZ_INVALID,
                    "--keep: %s was made from another palette than %s; give the one that "
                    "it was made from",
                    path, r->cli->operand[0]);
    return s;
}

/** Size of the shape's own page: units of a drawing, px of an image. */
static tz_status shape_size(run_state *r, tz_vec3 *size)
{
    const char *path = tz_cli_find(r->cli, r->v->own.domain);
    tz_ctx *ctx = r->cli->ctx;
    if (!tz_path_is_svg(path)) {
        tz_image im = {0};
        const tz_status s = tz_image_read(ctx, path, NULL, &im);
        if (s == TZ_OK)
            *size = (tz_vec3){im.width, im.height, 0};
        tz_image_deinit(&im);
        return s;
    }
    tz_svg_doc *doc = NULL;
    tz_numbers view = {0};
    tz_status s = tz_svg_read(ctx, path, &doc);
    if (s != TZ_OK)
        return s;
    const tz_svg_node root = tz_svg_root(doc);
    const char *box = tz_svg_attr(root, "viewBox");
    double w, h;
    if (box && (s = tz_svg_numbers(ctx, box, &view)) == TZ_OK && view.n == 4)
        *size = (tz_vec3){view.v[2], view.v[3], 0};
    else if (tz_svg_number(tz_svg_attr(root, "width"), &w) &&
             tz_svg_number(tz_svg_attr(root, "height"), &h))
        *size = (tz_vec3){w, h, 0};
    tz_array_free(ctx, &view);
    tz_svg_free(doc);
    return s;
}

static tz_status settle_domain(run_state *r)
{
    const own_params *own = &r->v->own;
    tz_vec3 size = {1024, 1024, 0};
    tz_status s = *own->domain ? add_input(r, own->domain) : TZ_OK;
    if (s == TZ_OK && own->size[0] > 0 && own->size[1] > 0)
        size = (tz_vec3){own->size[0], own->size[1], 0};
    else if (s == TZ_OK && *own->keep)
        size = r->kept.domain.size;
    else if (s == TZ_OK && *own->domain)
        s = shape_size(r, &size);
    r->domain = (tz_domain){.size = size, .torus = own->tile};
    if (s == TZ_OK && *own->keep &&
        (size.x != r->kept.domain.size.x || size.y != r->kept.domain.size.y))
        return tz_fail(
            r->cli->ctx, TZ_INVALID,
            "--size %gx%g: the layout to keep, %s, is %g x %g; leave --size out", size.x,
            size.y, own->keep, r->kept.domain.size.x, r->kept.domain.size.y);
    if (s == TZ_OK && *own->domain) {
        s = tz_region_read(r->cli->ctx, tz_cli_find(r->cli, own->domain), size, own->tile,
                           &r->region);
        r->domain.region = r->region;
    }
    return s;
}

static const char *vector_image(const own_params *own)
{
    return *own->directions                             ? own->directions
           : *own->field && !tz_path_is_svg(own->field) ? own->field
                                                        : "";
}

static tz_status read_field(run_state *r)
{
    const own_params *own = &r->v->own;
    const struct {
        const char *path;
        tz_element_field_map map;
    } image[3] = {{own->directions, TZ_ELEMENT_FIELD_DIRECTION},
                  {own->sizes, TZ_ELEMENT_FIELD_SIZE},
                  {own->densities, TZ_ELEMENT_FIELD_DENSITY}};
    tz_status s =
        tz_element_field_init(r->cli->ctx, r->domain.size, r->domain.torus, 0, &r->field);
    for (int i = 0; i < 3 && s == TZ_OK; i++)
        if (*image[i].path && (s = add_input(r, image[i].path)) == TZ_OK)
            s = tz_element_field_read_image(&r->field, tz_cli_find(r->cli, image[i].path),
                                            image[i].map);
    if (s == TZ_OK)
        s = tz_show_read(r->cli, &r->v->show, vector_image(own), &r->field, &r->show);
    if (s == TZ_OK && r->show.ramp.n > 0)
        s = tz_ramp_check(&r->palette.set);
    if (s == TZ_OK && *own->field && (s = add_input(r, own->field)) == TZ_OK) {
        const char *path = tz_cli_find(r->cli, own->field);
        s = tz_path_is_svg(path) ? tz_element_field_read_strokes(&r->field, path)
                                 : tz_element_field_read_image(
                                       &r->field, path, TZ_ELEMENT_FIELD_DIRECTION);
    }
    if (s == TZ_OK && *own->brush && (s = add_input(r, own->brush)) == TZ_OK)
        s = tz_fill_paint_read(r->cli->ctx, tz_cli_find(r->cli, own->brush),
                               r->domain.size, own->brush_radius, &r->paint);
    if (s == TZ_OK)
        s = tz_fill_paint_say(&r->paint, &r->field);
    return s == TZ_OK ? tz_element_field_settle(&r->field) : s;
}

static tz_status read_mix(run_state *r)
{
    tz_ctx *ctx = r->cli->ctx;
    const char *path = tz_cli_find(r->cli, r->cli->operand[0]);
    char *own = NULL;
    tz_status s = TZ_OK;
    if (!*r->v->own.mix && tz_path_is_svg(path))
        s = tz_mix_of_document(ctx, path, &own);
    const char *text = *r->v->own.mix ? r->v->own.mix : own && *own ? own : "*";
    if (s == TZ_OK)
        s = tz_mix_parse(ctx, text, &r->palette.set, r->v->fill.rigidity, &r->mix);
    tz_free(ctx, own);
    return s;
}

/* ---- outputs ------------------------------------------------------------------------- */

static tz_status name_output(run_state *r)
{
    tz_cli *cli = r->cli;
    char stem[TZ_PARAM_STRING_SIZE];
    tz_path_list outputs = {0};
    tz_path_stem(cli->operand[0], stem, sizeof stem);
    const tz_name_values names = {stem,
                                  "svg",
                                  "layout",
                                  r->v->own.seed,
                                  (int32_t)fmin(1e9, rint(r->domain.size.x)),
                                  (int32_t)fmin(1e9, rint(r->domain.size.y))};
    tz_status s = tz_name_expand(cli->ctx, r->v->output.output, &names, &r->path);
    if (s != TZ_OK)
        return s;
    cli->piped = strcmp(r->path, "-") == 0;
    if (cli->piped && cli->common->json)
        s = tz_cli_usage(cli, "--json and the layout both want standard output");
    if (s == TZ_OK)
        s = tz_element_write_check(cli->ctx, r->path);
    if (s == TZ_OK)
        s = tz_paths_add(cli->ctx, &outputs, r->path);
    if (s == TZ_OK && *r->v->trace.trace)
        s = tz_paths_add(cli->ctx, &outputs, r->v->trace.trace);
    if (s == TZ_OK)
        s = tz_element_exemplar_name_plate(cli, r->path, &outputs, &r->palette);
    if (s == TZ_OK)
        s = tz_outputs_check(cli->ctx, &r->palette.inputs, &outputs);
    tz_paths_free(cli->ctx, &outputs);
    return s;
}

/* A frame, whose number is part of its name, goes over no input and no other output. */
static tz_status check_frame(run_state *r, const char *path)
{
    tz_ctx *ctx = r->cli->ctx;
    tz_path_list outputs = {0};
    tz_status s = tz_paths_add(ctx, &outputs, r->path);
    if (s == TZ_OK)
        s = tz_paths_add(ctx, &outputs, path);
    if (s == TZ_OK && *r->v->trace.trace)
        s = tz_paths_add(ctx, &outputs, r->v->trace.trace);
    if (s == TZ_OK)
        s = tz_outputs_check(ctx, &r->palette.inputs, &outputs);
    tz_paths_free(ctx, &outputs);
    return s;
}

static tz_status write_frame(run_state *r, const tz_fill *fill, int32_t number)
{
    char stem[TZ_PARAM_STRING_SIZE], folder[TZ_PARAM_STRING_SIZE],
        path[2 * TZ_PARAM_STRING_SIZE + 16];
    tz_element_set frame = {0};
    tz_path_stem(r->v->trace.frames, stem, sizeof stem);
    tz_path_folder(r->v->trace.frames, folder, sizeof folder);
    snprintf(path, sizeof path, "%s%s-%03" PRId32 ".svg", folder, stem, number);
    tz_status s = check_frame(r, path);
    if (s == TZ_OK)
        s = tz_element_set_like(r->cli->ctx, &r->palette.set, &r->domain, &frame);
    if (s == TZ_OK)
        s = tz_fill_write(fill, &frame);
    if (s == TZ_OK)
        s = tz_show_paint(r->cli, &r->v->show, &r->show, &r->field, &r->palette.set,
                          &frame);
    if (s == TZ_OK)
        s = tz_element_write_svg(r->cli->ctx, path, &frame);
    tz_element_set_deinit(&frame);
    return s;
}

static bool on_iteration(void *user, const tz_fill *fill, int32_t iteration,
                         const tz_fill_energy *e)
{
    run_state *r = user;
    if (r->tracing)
        fprintf(r->trace.f,
                "%" PRId32 ",%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n",
                iteration, e->distribution, e->conflict, e->border, e->graph, e->align,
                e->continuity, e->rigidity, e->rotation, e->size_align,
                e->size_continuity, e->size_rigid);
    if (r->failed == TZ_OK && *r->v->trace.frames)
        r->failed = write_frame(r, fill, iteration);
    return r->failed == TZ_OK;
}

static tz_status open_trace(run_state *r)
{
    if (!*r->v->trace.trace)
        return TZ_OK;
    tz_status s = tz_file_out_open(r->cli->ctx, r->v->trace.trace, &r->trace);
    if (s != TZ_OK)
        return s;
    r->tracing = true;
    fprintf(r->trace.f, "iteration,distribution,conflict,border,graph,align,"
                        "continuity,rigidity,rotation,size_align,size_continuity,"
                        "size_rigid\n");
    return TZ_OK; /* commit tells of write errors */
}

/* ---- the work ------------------------------------------------------------------------ */

/** Brushes work on all that the kept layout holds; else what was placed by hand stays and
 * the rest is filled anew. */
static tz_status put_kept(run_state *r)
{
    const bool all = *r->v->own.brush != 0;
    tz_element_set *to = &r->layout;
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < r->kept.element.n && s == TZ_OK; i++) {
        tz_element e = r->kept.element.v[i];
        const int32_t first = e.sample;
        if (!(all || e.fixed))
            continue;
        if (e.source >= r->palette.set.element.n)
            e.source = -1;
        e.sample = to->sample.n;
        for (int32_t k = 0; k < e.samples && s == TZ_OK; k++)
            s = tz_array_push(r->cli->ctx, &to->sample, r->kept.sample.v[first + k]);
        if (s == TZ_OK)
            s = tz_array_push(r->cli->ctx, &to->element, e);
    }
    return s;
}

static void put_figures(run_state *r, const tz_fill_report *f)
{
    char text[160];
    tz_figures_seconds(r->cli, "fill", f->seconds);
    tz_figures_count(r->cli, "placements", f->elements);
    tz_figures_count(r->cli, "samples", f->samples);
    tz_figures_count(r->cli, "percent_covered", (int64_t)rint(100 * f->covered));
    snprintf(text, sizeof text,
             "%.1f %% covered, overlaps %.2f %%, %.1f degrees off the strokes",
             100 * f->covered, 100 * f->overlap, f->align * 180 / TZ_PI);
    tz_figures_text(r->cli, "filled", text);
}

/** Strokes of --brush on what is kept, or on nothing. */
static tz_status paint(run_state *r, const tz_fill_job *job, tz_fill_report *report)
{
    enum { SETTLE = 24 }; /* iterations about a stroke */
    tz_ctx *ctx = r->cli->ctx;
    tz_fill *f = NULL;
    const double start = tz_seconds();
    tz_fill_job empty = *job;
    empty.count = -1;
    tz_status s = tz_fill_begin(ctx, &empty, &r->layout, &f);
    if (s == TZ_OK)
        s = tz_fill_paint_apply(&r->paint, f,
                                job->params->iterations < SETTLE ? job->params->iterations
                                                                 : SETTLE);
    if (s == TZ_OK)
        s = tz_fill_write(f, &r->layout);
    tz_fill_end(f);
    *report = (tz_fill_report){.elements = r->layout.element.n};
    if (s == TZ_OK && r->layout.element.n > 0)
        s = tz_fill_measure(ctx, &r->layout, job->palette, job->field, 0, report);
    report->samples = r->layout.sample.n;
    report->seconds = tz_seconds() - start;
    return s;
}

static tz_status fill(run_state *r)
{
    tz_cli *cli = r->cli;
    const bool traced = *r->v->trace.trace || *r->v->trace.frames;
    tz_fill_params params = r->v->fill;
    tz_fill_report report;
    if (r->v->own.preview) {
        params.iterations = params.iterations < 8 ? params.iterations : 8;
        params.repair = false;
    }
    const tz_fill_job job = {.palette = &r->palette.set,
                             .entry = r->mix.v,
                             .entries = r->mix.n,
                             .domain = r->domain,
                             .field = &r->field,
                             .params = &params,
                             .seed = r->v->own.seed,
                             .count = r->v->own.count,
                             .trace = traced ? on_iteration : NULL,
                             .user = r};
    tz_status s = open_trace(r);
    if (s == TZ_OK)
        s = *r->v->own.brush ? paint(r, &job, &report)
                             : tz_fill_run(cli->ctx, &job, &r->layout, &report);
    if (r->failed != TZ_OK)
        s = r->failed;
    if (r->tracing && s == TZ_OK)
        s = tz_file_out_commit(&r->trace);
    else if (r->tracing)
        tz_file_out_abort(&r->trace);
    if (s == TZ_OK)
        put_figures(r, &report);
    return s;
}

static tz_status write_layout(run_state *r)
{
    tz_cli *cli = r->cli;
    tz_layout ground = {0};
    const double start = tz_seconds();
    tz_status s = TZ_OK;
    if (tz_path_is_svg(r->path) || cli->piped)
        s = tz_element_exemplar_ground(cli, &r->palette, &r->v->analyze, &r->domain,
                                       r->v->own.seed, &ground);
    if (s == TZ_OK && ground.place.n > 0)
        s = tz_element_ground_embed(cli->ctx, r->path, &ground, &r->layout);
    if (s == TZ_OK)
        s = tz_record_text(cli, &r->record, NULL, "layout", &r->layout.recipe);
    if (s == TZ_OK)
        s = tz_element_write(cli->ctx, r->path, &r->layout);
    if (s == TZ_OK) {
        tz_figures_seconds(cli, "write", tz_seconds() - start);
        tz_figures_output(cli, r->path, "layout",
                          (int32_t)fmin(2e9, rint(r->domain.size.x)),
                          (int32_t)fmin(2e9, rint(r->domain.size.y)));
    }
    tz_layout_deinit(&ground);
    return s;
}

static tz_status run(tz_cli *cli)
{
    values *v = cli->values;
    run_state r = {.cli = cli, .v = v};
    if (!*v->output.output)
        return tz_cli_usage(cli, "no output; give one with -o FILE.svg");
    tz_status s = tz_element_exemplar_read(cli, cli->operand[0], &v->medium, &v->things,
                                           v->analyze.model, &r.record, &r.palette);
    if (s == TZ_OK)
        s = read_kept(&r);
    if (s == TZ_OK)
        s = settle_domain(&r);
    if (s == TZ_OK)
        s = read_field(&r);
    if (s == TZ_OK)
        s = read_mix(&r);
    if (s == TZ_OK)
        s = name_output(&r);
    if (s == TZ_OK)
        s = tz_element_exemplar_write_plate(cli, &r.palette);
    if (s == TZ_OK)
        s = tz_element_set_like(cli->ctx, &r.palette.set, &r.domain, &r.layout);
    if (s == TZ_OK)
        s = put_kept(&r);
    if (s == TZ_OK)
        s = fill(&r);
    if (s == TZ_OK)
        s = tz_show_paint(cli, &v->show, &r.show, &r.field, &r.palette.set, &r.layout);
    if (s == TZ_OK)
        s = write_layout(&r);
    tz_element_set_deinit(&r.layout);
    tz_element_set_deinit(&r.kept);
    tz_element_field_deinit(&r.field);
    tz_fill_paint_deinit(&r.paint);
    tz_show_deinit(&r.show);
    tz_region_free(r.region);
    tz_array_free(cli->ctx, &r.mix);
    tz_element_exemplar_free(cli, &r.palette);
    tz_record_free(cli, &r.record);
    tz_free(cli->ctx, r.path);
    return s;
}

static const tz_option_group groups[] = {
    {&tz_common_param_table, offsetof(values, common), false},
    {&tz_output_param_table, offsetof(values, output), false},
    {&own_table, offsetof(values, own), true},
    {&tz_show_param_table, offsetof(values, show), true},
    {&trace_table, offsetof(values, trace), false},
    {&tz_fill_param_table, offsetof(values, fill), true},
    {&tz_medium_param_table, offsetof(values, medium), true},
    {&tz_things_param_table, offsetof(values, things), true},
    {&tz_ebpt_param_table, offsetof(values, analyze), true},
};
static const tz_example examples[] = {
    {"Leaves that follow a few strokes through a shape:",
     "terrazzo fill garden.svg -o layout.svg --domain shape.svg --field strokes.svg"},
    {"Three of one thing for each of another, over a tile:",
     "terrazzo fill garden.svg -o tile.svg --size 800x800 --tile --mix \"leaf:3 "
     "size=0.8..1.2, ribbon rigidity=5\""},
    {"A vector field as leaves, larger and lighter where it is stronger:",
     "terrazzo fill garden.svg -o wind.svg --mix leaf --directions wind.exr --lengths "
     "0.4,1.6 --ramp viridis --ramp-by length"},
    {"The stones of a photo, larger towards the light of an image:",
     "terrazzo fill rocks.jpg -o beach.svg --size 2048x1024 --sizes ramp.png"},
};
const tz_command tz_fill_command = {
    .name = "fill",
    .operands = "PALETTE.svg|PHOTO -o LAYOUT.svg",
    .summary = "Fills a shape with things that follow a few strokes.",
    .about =
        "Fills a domain evenly with the things of a palette: any drawing, an element "
        "document, or a photo whose things are cut out. Nothing has to be arranged as an "
        "example. Things turn and grow along the strokes of --field, bend if they are "
        "soft (rigidity), and elsewhere go over smoothly from one stroke to the next.\n\n"
        "The layout is an SVG document (or .json, .csv) which render makes pixels.",
    .min_operands = 1,
    .max_operands = 1,
    .group = groups,
    .groups = sizeof groups / sizeof groups[0],
    .example = examples,
    .examples = sizeof examples / sizeof examples[0],
    .size = sizeof(values),
    .run = run,
};
