/* SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "cli/arrange_curves.h"
#include "cli/arrange_elements.h"
#include "cli/figures.h"
#include "cli/material.h"

typedef struct arrange_params {
    char keep[TZ_PARAM_STRING_SIZE];
} arrange_params;

typedef struct values {
    tz_common_params common;
    tz_output_params output;
    arrange_params own;
    tz_medium_params medium;
    tz_things_params things;
    tz_guide_params guides;
    tz_element_arrange_params elements;
    tz_curve_arrange_params curves;
    tz_curve_input_params input;
    tz_lines_params lines;
    tz_curve_draw_params draw;
    tz_curve_output_params format;
    tz_curve_watch_params watch;
    tz_rules_params rules;
    tz_enlarge_params growth;
    tz_arrange_params arrange;
    tz_ebpt_params analyze;
} values;

static const tz_param own_rows[] = {
    {"keep", TZ_PARAM_STRING, offsetof(arrange_params, keep), 0, 0, "", "FILE", NULL,
     "Layout whose hand-placed things stay and are grown around (all of its elements, "
     "where --brush paints); it also sets the size."},
};
static const tz_param_table own_table = {"keep", "What stays as it is.", own_rows,
                                         sizeof own_rows / sizeof own_rows[0],
                                         sizeof(arrange_params)};

/* Inputs besides the operands. */
static tz_status read_guides(tz_cli *cli, values *v, tz_record *record, tz_exemplars *e,
                             tz_layout *l)
{
    tz_status s = tz_record_rules(cli, record, v->rules.rules);
    if (s == TZ_OK && *v->rules.rules)
        s = tz_paths_add(cli->ctx, &e->input, tz_cli_find(cli, v->rules.rules));
    if (s != TZ_OK || !*v->own.keep)
        return s;
    const char *at = tz_cli_find(cli, v->own.keep);
    if ((s = tz_record_input(cli, record, v->own.keep, NULL)) != TZ_OK ||
        (s = tz_layout_read(cli->ctx, at, l)) != TZ_OK)
        return s;
    if (tz_cli_given(cli, "size") &&
        (v->arrange.size[0] != l->width || v->arrange.size[1] != l->height))
        return tz_fail(cli->ctx, TZ_INVALID,
                       "--size %dx%d: the layout to keep, %s, is %d x "
                       "%d; leave --size out",
                       v->arrange.size[0], v->arrange.size[1], v->own.keep, l->width,
                       l->height);
    v->arrange.size[0] = l->width;
    v->arrange.size[1] = l->height;
    v->arrange.tile = l->tile;
    return TZ_OK;
}

/* Sources of a kept layout are named as before; they must be the operands. */
static tz_status match_sources(tz_cli *cli, const tz_exemplars *e, tz_layout *l)
{
    if (l->source.n == 0)
        return TZ_OK;
    bool same = l->source.n == e->n;
    for (int32_t i = 0; same && i < e->n; i++)
        same = !l->source.v[i].sha256[0] ||
               strcmp(l->source.v[i].sha256, e->v[i].sha256) == 0;
    return same ? TZ_OK
                : tz_fail(cli->ctx, TZ_INVALID,
                          "--keep: the layout was made from other "
                          "photos; give the same exemplars in the same order");
}

static tz_status name_output(tz_cli *cli, const values *v, tz_exemplars *e, char **path)
{
    char stem[TZ_PARAM_STRING_SIZE];
    tz_path_list outputs = {0};
    tz_path_stem(cli->operand[0], stem, sizeof stem);
    const tz_name_values names = {
        stem, "svg", "layout", v->arrange.seed, v->arrange.size[0], v->arrange.size[1]};
    tz_status s = tz_name_expand(cli->ctx, v->output.output, &names, path);
    if (s != TZ_OK)
        return s;
    cli->piped = strcmp(*path, "-") == 0;
    if (cli->piped && cli->common->json)
        s = tz_cli_usage(cli, "--json and the layout both want standard output");
    else if (!cli->piped && !tz_path_is_svg(*path))
        s = tz_fail(cli->ctx, TZ_INVALID, "%s: a layout is an SVG document; name it .svg",
                    *path);
    if (s == TZ_OK)
        s = tz_paths_add(cli->ctx, &outputs, *path);
    if (s == TZ_OK)
        s = tz_outputs_check(cli->ctx, &e->input, &outputs);
    tz_paths_free(cli->ctx, &outputs);
    return s;
}

static tz_status run_edges(tz_cli *cli)
{
    values *v = cli->values;
    tz_record record = {0};
    tz_exemplars e = {0};
    tz_layout l = {0};
    tz_frames *frames = NULL;
    char *path = NULL;
    tz_status s = tz_exemplars_read(cli, &record, &e);
    if (s == TZ_OK)
        s = tz_arrange_settle(cli, &e, v->growth.grow, &v->arrange);
    if (s == TZ_OK)
        s = read_guides(cli, v, &record, &e, &l);
    if (s == TZ_OK)
        s = match_sources(cli, &e, &l);
    if (s == TZ_OK)
        s = tz_guides_paths(cli, &v->guides, &e.input);
    if (s == TZ_OK)
        s = name_output(cli, v, &e, &path);
    if (s == TZ_OK)
        s = tz_guides_frames(cli, &v->guides, &record,
                             (tz_vec3){v->arrange.size[0], v->arrange.size[1], 0},
                             v->arrange.tile, &frames);
    v->arrange.frames = frames;
    if (s == TZ_OK)
        s = tz_exemplars_analyze(cli, &v->analyze, &e);
    double start = tz_seconds();
    if (s == TZ_OK)
        s = tz_expand_arrange(cli->ctx, e.v, e.n, tz_cli_find(cli, v->rules.rules),
                              &v->arrange, &l);
    if (s != TZ_OK)
        goto done;
    tz_figures_seconds(cli, "arrange", tz_seconds() - start);
    tz_figures_count(cli, "placements", l.place.n);
    start = tz_seconds();
    tz_free(cli->ctx, l.recipe);
    l.recipe = NULL;
    if ((s = tz_record_text(cli, &record, NULL, "layout", &l.recipe)) != TZ_OK ||
        (s = tz_layout_write(cli->ctx, path, &l)) != TZ_OK)
        goto done;
    tz_figures_seconds(cli, "write", tz_seconds() - start);
    tz_figures_output(cli, path, "layout", l.width, l.height);
done:
    v->arrange.frames = NULL;
    tz_frames_free(frames);
    tz_free(cli->ctx, path);
    tz_layout_deinit(&l);
    tz_exemplars_free(cli, &e);
    tz_record_free(cli, &record);
    return s;
}

static tz_status run(tz_cli *cli)
{
    values *v = cli->values;
    const tz_elements_job job = {v->output.output, v->own.keep,  &v->medium,
                                 &v->things,       &v->elements, &v->guides,
                                 &v->arrange,      &v->analyze,  v->growth.grow};
    const tz_curves_job curves = {.output = v->output.output,
                                  .keep = v->own.keep,
                                  .input = &v->input,
                                  .lines = &v->lines,
                                  .format = &v->format,
                                  .draw = &v->draw,
                                  .watch = &v->watch,
                                  .curves = &v->curves,
                                  .guides = &v->guides,
                                  .arrange = &v->arrange,
                                  .grow = v->growth.grow};
    tz_as as;
    if (!*v->output.output)
        return tz_cli_usage(cli, "no output; give one with -o FILE.svg");
    tz_status s = tz_medium_settle(cli, cli->operand[0], &v->medium, &as);
    if (s != TZ_OK)
        return s;
    v->input.wrap = v->medium.wrap;
    if (as == TZ_AS_CURVES)
        return tz_arrange_curves(cli, &curves);
    return as == TZ_AS_ELEMENTS ? tz_arrange_elements(cli, &job) : run_edges(cli);
}

static const tz_option_group groups[] = {
    {&tz_common_param_table, offsetof(values, common), false},
    {&tz_output_param_table, offsetof(values, output), false},
    {&own_table, offsetof(values, own), true},
    {&tz_medium_param_table, offsetof(values, medium), true},
    {&tz_things_param_table, offsetof(values, things), true},
    {&tz_guide_param_table, offsetof(values, guides), true},
    {&tz_element_arrange_param_table, offsetof(values, elements), true},
    {&tz_curve_arrange_param_table, offsetof(values, curves), true},
    {&tz_curve_draw_param_table, offsetof(values, draw), true},
    {&tz_curve_input_param_table, offsetof(values, input), true},
    {&tz_lines_param_table, offsetof(values, lines), true},
    {&tz_curve_output_param_table, offsetof(values, format), true},
    {&tz_curve_watch_param_table, offsetof(values, watch), false},
    {&tz_rules_param_table, offsetof(values, rules), true},
    {&tz_enlarge_param_table, offsetof(values, growth), true},
    {&tz_arrange_param_table, offsetof(values, arrange), true},
    {&tz_ebpt_param_table, offsetof(values, analyze), true},
};
static const tz_example examples[] = {
    {"Arrange an exemplar over a large layout:",
     "terrazzo arrange rocks.svg -o layout.svg --size 8192x8192 --seed 7"},
    {"Two photos in one layout (presets lie in data/presets):",
     "terrazzo arrange gravel.png grass.png -o path.svg --rules two-sources.json"},
    {"More of a drawing's elements (size in its units), as a table for scatter tools:",
     "terrazzo arrange leaves.svg -o leaves.csv --size 1500x1500"},
    {"More of a drawing's lines, for a plotter:",
     "terrazzo arrange streets.svg --as curves -o streets.dxf --size 1200x900"},
    {"The white spot of a drawing, filled like the rest of it:",
     "terrazzo arrange map.svg --as curves --complete spot.svg -o whole.svg"},
};
const tz_command tz_arrange_command = {
    .name = "arrange",
    .operands = "EXEMPLAR.svg|DRAWING.svg|PHOTO... -o LAYOUT.svg",
    .summary = "Arranges exemplars over a layout, without making pixels.",
    .about =
        "Writes a layout: an SVG document that opens in Inkscape and browsers, in which "
        "things can be moved, turned and deleted by hand before render makes it pixels. "
        "Photos are analysed on the way, so the options of analyze are taken too.\n\n"
        "A drawing (any SVG) or an element exemplar gives a layout of elements: each "
        "placed one is a <use> in the SVG; .json and .csv hold the same as a table. "
        "--size is in the drawing's units then.\n\n"
        "With --as curves the drawing's lines are a pattern: they go on from piece to "
        "piece, meet and branch as they do in the drawing. --complete and --clone draw "
        "into the drawing itself. The output is SVG, or DXF for plotters and cutters.",
    .min_operands = 1,
    .max_operands = -1,
    .group = groups,
    .groups = sizeof groups / sizeof groups[0],
    .example = examples,
    .examples = sizeof examples / sizeof examples[0],
    .size = sizeof(values),
    .run = run,
};
