/* SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "cli/exemplars.h"
#include "cli/material.h"
#include "elements/element_io.h"

enum { AS_EDGES, AS_ELEMENTS };

typedef struct medium_params {
    int32_t as;
    bool wrap;
    int32_t classes;
} medium_params;

static const tz_param medium_rows[] = {
    {"as", TZ_PARAM_ENUM, offsetof(medium_params, as), 0, 0, "edges", "",
     "edges|elements",
     "What to find: the edge groups of a photo, or the elements of an SVG drawing."},
    {"wrap", TZ_PARAM_BOOL, offsetof(medium_params, wrap), 0, 0, "false", "", NULL,
     "Elements: the drawing is a tile that repeats (--no-wrap: it is none); found out "
     "where neither is given."},
    {"classes", TZ_PARAM_INT, offsetof(medium_params, classes), 0, 64, "0", "", NULL,
     "Elements: how many classes to sort those into that the drawing does not name; 0 = "
     "as many as look different."},
};
static const tz_param_table medium_table = {"medium", "What is looked for.", medium_rows,
                                            sizeof medium_rows / sizeof *medium_rows,
                                            sizeof(medium_params)};

typedef struct values {
    tz_common_params common;
    tz_output_params output;
    medium_params medium;
    tz_ebpt_params analyze;
} values;

/** Elements of a drawing, as SVG, JSON or CSV. */
static tz_status run_elements(tz_cli *cli, const values *v)
{
    const char *input = cli->operand[0], *output = v->output.output;
    const bool known = tz_cli_given(cli, "wrap");
    const tz_element_read_options options = {.wrap = known && v->medium.wrap,
                                             .wrap_auto = !known,
                                             .classes = v->medium.classes};
    tz_element_set set = {0};
    tz_path_list inputs = {0}, outputs = {0};
    if (!tz_path_is_svg(input))
        return tz_fail(cli->ctx, TZ_UNSUPPORTED,
                       "%s: elements are found in SVG drawings, not yet in photos; draw "
                       "it as SVG or leave out --as elements",
                       input);
    cli->piped = strcmp(output, "-") == 0;
    if (cli->piped && cli->common->json)
        return tz_cli_usage(cli, "--json and the elements both want standard output");
    tz_status s = tz_paths_add(cli->ctx, &inputs, input);
    if (s == TZ_OK)
        s = tz_paths_add(cli->ctx, &outputs, output);
    if (s == TZ_OK)
        s = tz_outputs_check(cli->ctx, &inputs, &outputs);
    if (s == TZ_OK)
        s = tz_element_read_svg(cli->ctx, input, &options, &set);
    if (s == TZ_OK) {
        s = tz_element_write(cli->ctx, output, &set);
        tz_element_set_deinit(&set);
    }
    tz_paths_free(cli->ctx, &inputs);
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
    if (v->medium.as == AS_ELEMENTS)
        return run_elements(cli, v);
    if (tz_path_is_svg(cli->operand[0]))
        return tz_fail(
            cli->ctx, TZ_INVALID,
            "%s: is an exemplar already; give a photo, or --as elements for a drawing",
            cli->operand[0]);
    tz_status s = tz_exemplars_read(cli, &record, &e);
    if (s != TZ_OK)
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
    {&medium_table, offsetof(values, medium), false},
    {&tz_ebpt_param_table, offsetof(values, analyze), true},
};
static const tz_example examples[] = {
    {"See what a photo is made of (open the SVG in a browser):",
     "terrazzo analyze rocks.jpg -o rocks.svg"},
    {"More and smaller groups:",
     "terrazzo analyze gravel.png -o gravel.svg --groups 600"},
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
        "With --as elements, finds the elements of an SVG drawing (stones, leaves, "
        "tiles, "
        "icons: each <use>, each group of touching shapes, each other shape) with class, "
        "position, angle, scale and radius, and writes them as .svg, .json or .csv.",
    .min_operands = 1,
    .max_operands = 1,
    .group = groups,
    .groups = sizeof groups / sizeof groups[0],
    .example = examples,
    .examples = sizeof examples / sizeof examples[0],
    .size = sizeof(values),
    .run = run,
};
