/* SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "cli/elements.h"
#include "cli/exemplars.h"
#include "cli/figures.h"
#include "cli/material.h"
#include "cli/render_curves.h"
#include "cli/render_elements.h"

typedef struct values {
    tz_common_params common;
    tz_output_params output;
    tz_map_output_params map_output;
    tz_maps_params maps;
    tz_compose_params compose;
    tz_element_render_params look;
    tz_curve_render_params lines;
    tz_format_params format;
} values;

typedef struct job {
    tz_cli *cli;
    values *v;
    tz_layout layout;
    tz_source *sources;
    tz_image *photos; /* views on the sources' photos */
    int32_t n;
    tz_map_list maps;
    tz_record record;
    tz_path_list inputs;
    tz_picture_list pictures;
} job;

static tz_status read_source(job *j, int32_t i)
{
    tz_ctx *ctx = j->cli->ctx;
    const tz_layout_source *l = &j->layout.source.v[i];
    tz_source *src = &j->sources[i];
    tz_status s = tz_source_read(ctx, tz_cli_find(j->cli, l->path), src);
    if (s != TZ_OK)
        return s;
    const tz_image *im = &src->photo;
    if ((int64_t)im->width * l->height != (int64_t)im->height * l->width)
        return tz_fail(ctx, TZ_INVALID,
                       "%s: is %d x %d, the layout was made for %d x %d; give "
                       "a photo of that size or in proportion to it",
                       l->path, im->width, im->height, l->width, l->height);
    if (l->sha256[0] && src->sha256[0] && strcmp(l->sha256, src->sha256) != 0)
        tz_warn(ctx, "%s: has changed since the layout was made", l->path);
    s = tz_record_input(j->cli, &j->record, l->path, src->sha256);
    return s == TZ_OK ? tz_paths_add(ctx, &j->inputs, src->path) : s;
}

static tz_status read_all(job *j)
{
    tz_cli *cli = j->cli;
    const char *at = tz_cli_find(cli, cli->operand[0]);
    double start = tz_seconds();
    tz_status s = tz_layout_read(cli->ctx, at, &j->layout);
    if (s == TZ_OK)
        s = tz_record_input(cli, &j->record, cli->operand[0], NULL);
    if (s == TZ_OK)
        s = tz_paths_add(cli->ctx, &j->inputs, at);
    if (s != TZ_OK)
        return s;
    int32_t n = j->layout.source.n;
    if (n == 0)
        return tz_fail(cli->ctx, TZ_INVALID,
                       "%s: refers to no photo, so there is nothing to "
                       "render; is it a layout?",
                       cli->operand[0]);
    tz_image **matched = NULL;
    if ((s = tz_alloc_zero(cli->ctx, &j->sources, (size_t)n, sizeof *j->sources)) !=
            TZ_OK ||
        (s = tz_alloc_zero(cli->ctx, &j->photos, (size_t)n, sizeof *j->photos)) !=
            TZ_OK ||
        (s = tz_alloc_zero(cli->ctx, &matched, (size_t)n, sizeof *matched)) != TZ_OK)
        goto done;
    for (j->n = 0; s == TZ_OK && j->n < n; j->n++) {
        matched[j->n] = &j->sources[j->n].photo;
        s = read_source(j, j->n);
    }
    if (s == TZ_OK)
        s = tz_images_match(cli->ctx, matched, n);
    for (int32_t i = 0; i < j->n; i++)
        j->photos[i] = j->sources[i].photo;
done:
    tz_free(cli->ctx, matched);
    tz_figures_seconds(cli, "read", tz_seconds() - start);
    tz_figures_count(cli, "placements", j->layout.place.n);
    return s;
}

static tz_status plan(job *j)
{
    tz_cli *cli = j->cli;
    values *v = j->v;
    tz_path_list outputs = {0};
    char stem[TZ_PARAM_STRING_SIZE];
    tz_path_stem(cli->operand[0], stem, sizeof stem);
    const tz_name_values names = {stem, "png",           "colour",
                                  0,    j->layout.width, j->layout.height};
    tz_status s = tz_maps_parse(cli->ctx, v->maps.maps, j->n, &j->maps);
    if (s == TZ_OK)
        s = tz_pictures_plan(cli, v->output.output, v->map_output.map_output, &j->maps,
                             names, &j->pictures);
    for (int32_t i = 0; s == TZ_OK && i < j->pictures.n; i++)
        s = tz_paths_add(cli->ctx, &outputs, j->pictures.v[i].path);
    for (int32_t i = 0; s == TZ_OK && i < j->maps.n; i++)
        for (int32_t k = 0; s == TZ_OK && k < j->n; k++)
            s = tz_paths_add(cli->ctx, &j->inputs,
                             tz_cli_find(cli, j->maps.v[i].path.v[k]));
    if (s == TZ_OK && cli->piped && cli->common->json)
        s = tz_cli_usage(cli, "--json and the image both want standard output");
    if (s == TZ_OK)
        s = tz_outputs_check(cli->ctx, &j->inputs, &outputs);
    if (s == TZ_OK)
        s = tz_pictures_check(cli, &j->pictures, &v->format);
    tz_paths_free(cli->ctx, &outputs);
    for (int32_t k = 0; s == TZ_OK && j->maps.n && k < j->n; k++)
        s = tz_maps_check(cli, &j->maps, k, j->sources[k].path, &j->photos[k]);
    return s;
}

static tz_status run_edges(tz_cli *cli)
{
    job j = {.cli = cli, .v = cli->values};
    tz_status s = read_all(&j);
    if (s == TZ_OK)
        s = plan(&j);
    if (s == TZ_OK) {
        const tz_material m = {&j.layout,     j.photos,     j.n,      &j.maps,
                               &j.v->compose, &j.v->format, &j.record};
        s = tz_pictures_render(cli, &m, &j.pictures, 0, j.pictures.n);
    }
    for (int32_t i = 0; i < j.n; i++)
        tz_source_deinit(&j.sources[i]);
    tz_free(cli->ctx, j.sources);
    tz_free(cli->ctx, j.photos);
    tz_layout_deinit(&j.layout);
    tz_maps_free(cli->ctx, &j.maps);
    tz_record_free(cli, &j.record);
    tz_paths_free(cli->ctx, &j.inputs);
    tz_pictures_free(cli->ctx, &j.pictures);
    return s;
}

static tz_status run(tz_cli *cli)
{
    values *v = cli->values;
    v->lines.scale = v->look.scale;
    const tz_render_curves_job curves = {v->output.output, v->map_output.map_output,
                                         v->maps.maps,     &v->compose,
                                         &v->lines,        &v->format};
    const tz_render_elements_job job = {v->output.output, v->map_output.map_output,
                                        v->maps.maps,     &v->compose,
                                        &v->look,         &v->format};
    char kind[32] = "";
    if (!*v->output.output)
        return tz_cli_usage(cli, "no output; give one with -o FILE");
    tz_status s = tz_document_kind(cli, cli->operand[0], kind);
    if (s != TZ_OK)
        return s;
    if (strcmp(kind, "curves") == 0)
        return tz_render_curves(cli, &curves);
    const bool drawing = !*kind && tz_path_is_svg(cli->operand[0]);
    return drawing || strcmp(kind, "elements") == 0 ? tz_render_elements(cli, &job)
                                                    : run_edges(cli);
}

static const tz_option_group groups[] = {
    {&tz_common_param_table, offsetof(values, common), false},
    {&tz_output_param_table, offsetof(values, output), false},
    {&tz_map_output_param_table, offsetof(values, map_output), false},
    {&tz_maps_param_table, offsetof(values, maps), true},
    {&tz_compose_param_table, offsetof(values, compose), true},
    {&tz_element_render_param_table, offsetof(values, look), true},
    {&tz_curve_render_param_table, offsetof(values, lines), true},
    {&tz_format_param_table, offsetof(values, format), true},
};
static const tz_example examples[] = {
    {"All pixels of a layout:", "terrazzo render layout.svg -o texture.exr"},
    {"One piece, the same bytes as in the whole:",
     "terrazzo render layout.svg -o piece.png --crop 1024,512,256,256"},
    {"A map of the material too, with the same seams:",
     "terrazzo render layout.svg -o wall.png --maps rough=rocks.jpg"},
    {"A layout of elements, and pictures of which one lies where:",
     "terrazzo render pebbles_big.svg -o big.png --maps id=ids.exr,uv=uv.exr"},
};
const tz_command tz_render_command = {
    .name = "render",
    .operands = "LAYOUT.svg -o OUTPUT",
    .summary = "Makes a layout's pixels: all of them or any crop, any map.",
    .about =
        "Takes a layout from arrange or expand --save-layout, as it is or after it was "
        "edited by hand, and composites the photos' pixels along it. Any crop comes out "
        "exactly as in the whole.\n\n"
        "A layout of elements, or a drawing, is drawn: vectors at any --resolution, "
        "things cut from a "
        "photo with soft borders and their shadows over the synthesized ground. In "
        "--maps, "
        "id, class, angle and uv name the files that pictures of which element lies "
        "where, its class, angle and place in the photo are written to.\n\n"
        "A layout of curves is drawn with the strokes of its pens, or shows its lines in "
        "the pixels of the photo that they were found in. In --maps, id, distance and "
        "along name the files that pictures of which line is nearest, how far it is off "
        "and how far along it that is are written to.",
    .min_operands = 1,
    .max_operands = 1,
    .group = groups,
    .groups = sizeof groups / sizeof groups[0],
    .example = examples,
    .examples = sizeof examples / sizeof examples[0],
    .size = sizeof(values),
    .run = run,
};
