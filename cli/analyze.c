/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <string.h>

#include "cli/curve_photos.h"
#include "cli/element_exemplar.h"
#include "cli/exemplars.h"
#include "cli/figures.h"
#include "cli/material.h"
#include "elements/element_io.h"

typedef struct values {
    tz_common_params common;
    tz_output_params output;
    tz_medium_params medium;
    tz_things_params things;
    tz_lines_params lines;
    tz_ebpt_params analyze;
} values;

/** Elements of a drawing or a photo, as SVG, JSON or CSV. */
static tz_status run_elements(tz_cli *cli, const values *v)
{
    const char *input = cli->operand[0], *output = v->output.output;
    tz_element_exemplar e = {0};
    tz_path_list outputs = {0};
    cli->piped = strcmp(output, "-") == 0;
    if (cli->piped && cli->common->json)
        return tz_cli_usage(cli, "--json and the elements both want standard output");
    tz_status s = tz_element_write_check(cli->ctx, output);
    if (s == TZ_OK)
        s = tz_element_exemplar_read(cli, input, &v->medium, &v->things, v->analyze.model,
                                     NULL, &e);
    if (s == TZ_OK)
        s = tz_paths_add(cli->ctx, &outputs, output);
    if (s == TZ_OK)
        s = tz_element_exemplar_name_plate(cli, output, &outputs, &e);
    if (s == TZ_OK)
        s = tz_outputs_check(cli->ctx, &e.inputs, &outputs);
    if (s == TZ_OK)
        s = tz_element_exemplar_write_plate(cli, &e);
    if (s == TZ_OK)
        s = tz_element_write(cli->ctx, output, &e.set);
    if (s == TZ_OK)
        tz_figures_output(cli, output, "elements",
                          (int32_t)fmin(2e9, rint(e.set.domain.size.x)),
                          (int32_t)fmin(2e9, rint(e.set.domain.size.y)));
    tz_element_exemplar_free(cli, &e);
    tz_paths_free(cli->ctx, &outputs);
    return s;
}

static tz_status run(tz_cli *cli)
{
    const values *v = cli->values;
    tz_record record = {0};
    tz_exemplars e = {0};
    tz_path_list outputs = {0};
    char stem[TZ_PARAM_STRING_SIZE], *path = NULL;
    if (!*v->output.output)
        return tz_cli_usage(cli, "no output; give one with -o FILE.svg");
    tz_as as;
    tz_status s = tz_medium_settle(cli, cli->operand[0], &v->medium, &as);
    if (s != TZ_OK)
        return s;
    if (as == TZ_AS_ELEMENTS)
        return run_elements(cli, v);
    if (as == TZ_AS_CURVES)
        return tz_analyze_curves(cli, cli->operand[0], v->output.output, &v->lines);
    if (tz_path_is_svg(cli->operand[0]))
        return tz_fail(cli->ctx, TZ_INVALID,
                       "%s: is an exemplar already; give a photo or a drawing",
                       cli->operand[0]);
    if ((s = tz_exemplars_read(cli, &record, &e)) != TZ_OK)
        goto done;
    const tz_image *photo = &e.v[0].photo;
    tz_path_stem(cli->operand[0], stem, sizeof stem);
    const tz_name_values names = {stem, "svg",        "exemplar",
                                  0,    photo->width, photo->height};
    if ((s = tz_name_expand(cli->ctx, v->output.output, &names, &path)) != TZ_OK)
        goto done;
    cli->piped = strcmp(path, "-") == 0;
    if (cli->piped && cli->common->json)
        s = tz_cli_usage(cli, "--json and the exemplar both want standard output");
    else if (!cli->piped && !tz_path_is_svg(path))
        s = tz_fail(cli->ctx, TZ_INVALID,
                    "%s: an exemplar is an SVG document; name it .svg", path);
    if (s != TZ_OK || (s = tz_paths_add(cli->ctx, &outputs, path)) != TZ_OK ||
        (s = tz_outputs_check(cli->ctx, &e.input, &outputs)) != TZ_OK ||
        (s = tz_exemplars_analyze(cli, &v->analyze, &e)) != TZ_OK)
        goto done;
    s = tz_exemplars_write(cli, &e, 0, path);
done:
    tz_free(cli->ctx, path);
    tz_paths_free(cli->ctx, &outputs);
    tz_exemplars_free(cli, &e);
    tz_record_free(cli, &record);
    return s;
}

static const tz_option_group groups[] = {
    {&tz_common_param_table, offsetof(values, common), false},
    {&tz_output_param_table, offsetof(values, output), false},
    {&tz_medium_param_table, offsetof(values, medium), false},
    {&tz_things_param_table, offsetof(values, things), false},
    {&tz_lines_param_table, offsetof(values, lines), false},
    {&tz_ebpt_param_table, offsetof(values, analyze), true},
};
static const tz_example examples[] = {
    {"See what a photo is made of (open the SVG in a browser):",
     "terrazzo analyze rocks.jpg -o rocks.svg"},
    {"More and smaller groups:",
     "terrazzo analyze gravel.png -o gravel.svg --groups 600"},
    {"The stones of a photo, cut out along their outlines:",
     "terrazzo analyze rocks.jpg --as elements -o stones.svg"},
    {"The joints or cracks of a photo, as curves:",
     "terrazzo analyze rocks.jpg --as curves -o joints.svg"},
    {"The elements of a drawing, as a table:",
     "terrazzo analyze leaves.svg --as elements -o leaves.csv"},
};
const tz_command tz_analyze_command = {
    .name = "analyze",
    .operands = "PHOTO|DRAWING -o EXEMPLAR.svg",
    .summary = "Finds out what a photo or a drawing is made of, as an SVG exemplar.",
    .about =
        "Writes the photo's regions, its edges and its edge groups as one SVG document "
        "that arrange and expand take in place of the photo. The document refers to the "
        "photo, so keep both together.\n\n"
        "Of an SVG drawing it finds the elements (stones, leaves, tiles, icons: each "
        "<use>, "
        "each group of touching shapes, each other shape) with class, position, angle, "
        "scale and radius, and writes them as .svg, .json or .csv. With --as elements it "
        "cuts the things (pebbles, setts, leaves, tiles) out of a photo; what lies "
        "beneath "
        "them goes to NAME.plate.png beside the SVG. With --as curves it follows the "
        "photo's lines (cracks, veins, joints) and writes them as strokes with their "
        "widths, the photo without them as the plate.",
    .min_operands = 1,
    .max_operands = 1,
    .group = groups,
    .groups = sizeof groups / sizeof groups[0],
    .example = examples,
    .examples = sizeof examples / sizeof examples[0],
    .size = sizeof(values),
    .run = run,
};
