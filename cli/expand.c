/* SPDX-License-Identifier: Apache-2.0 */
/* Photos in, large texture out: read, analyse once, then for each seed arrange, save and
 * render. */
#include <string.h>

#include "cli/exemplars.h"
#include "cli/figures.h"
#include "cli/material.h"

typedef struct expand_params {
    char seeds[TZ_PARAM_STRING_SIZE];
    char save_exemplar[TZ_PARAM_STRING_SIZE];
    char save_layout[TZ_PARAM_STRING_SIZE];
} expand_params;

typedef struct values {
    tz_common_params common;
    tz_output_params output;
    tz_map_output_params map_output;
    expand_params own;
    tz_maps_params maps;
    tz_rules_params rules;
    tz_enlarge_params growth;
    tz_arrange_params arrange;
    tz_ebpt_params analyze;
    tz_compose_params compose;
    tz_format_params format;
} values;

static const tz_param own_rows[] = {
    {"seeds", TZ_PARAM_STRING, offsetof(expand_params, seeds), 0, 0, "", "SEEDS", NULL,
     "Makes one variant a seed: 1..8, or 1,4,10..12. The names need {seed}."},
    {"save-exemplar", TZ_PARAM_STRING, offsetof(expand_params, save_exemplar), 0, 0, "",
     "FILE", NULL, "Also writes the (first) exemplar as SVG."},
    {"save-layout", TZ_PARAM_STRING, offsetof(expand_params, save_layout), 0, 0, "",
     "FILE", NULL, "Also writes the layout as SVG; edit it and render it again."},
};
static const tz_param_table own_table = {"expand", "What to make.", own_rows,
                                         sizeof own_rows / sizeof own_rows[0],
                                         sizeof(expand_params)};

/* Everything of a run that several steps need. */
typedef struct job {
    tz_cli *cli;
    values *v;
    tz_seed_list seeds;
    tz_exemplars exemplars;
    tz_map_list maps;
    tz_record record;
    tz_path_list layouts;     /* one a seed, or none */
    tz_picture_list pictures; /* all seeds */
    int32_t *first;           /* seeds.n + 1 offsets into pictures */
} job;

static tz_status plan_seed(job *j, int32_t i, tz_path_list *outputs)
{
    char stem[TZ_PARAM_STRING_SIZE];
    tz_cli *cli = j->cli;
    const char *photo = cli->operand[0], *ext = tz_path_extension(photo);
    tz_path_stem(photo, stem, sizeof stem);
    const tz_name_values v = {stem,
                              *ext && !tz_path_is_svg(photo) ? ext : "png",
                              "layout",
                              j->seeds.v[i],
                              j->v->arrange.size[0],
                              j->v->arrange.size[1]};
    tz_status s = TZ_OK;
    if (*j->v->own.save_layout && tz_cli_makes(cli, "layout")) {
        char *path = NULL;
        s = tz_name_expand(cli->ctx, j->v->own.save_layout, &v, &path);
        if (s == TZ_OK)
            s = tz_paths_add(cli->ctx, &j->layouts, path);
        if (s == TZ_OK)
            s = tz_paths_add(cli->ctx, outputs, path);
        cli->piped = cli->piped || (path && strcmp(path, "-") == 0);
        tz_free(cli->ctx, path);
    }
    j->first[i] = j->pictures.n;
    if (s == TZ_OK && *j->v->output.output)
        s = tz_pictures_plan(cli, j->v->output.output, j->v->map_output.map_output,
                             &j->maps, v, &j->pictures);
    j->first[i + 1] = j->pictures.n;
    for (int32_t k = j->first[i]; s == TZ_OK && k < j->pictures.n; k++)
        s = tz_paths_add(cli->ctx, outputs, j->pictures.v[k].path);
    return s;
}

/* Names and checks every output before the work begins. */
static tz_status plan(job *j)
{
    tz_path_list outputs = {0};
    tz_cli *cli = j->cli;
    const char *exemplar = j->v->own.save_exemplar;
    if (!*j->v->output.output && !*j->v->own.save_layout && !*exemplar)
        return tz_cli_usage(cli, "no output; give one with -o FILE");
    tz_status s =
        tz_alloc_zero(cli->ctx, &j->first, (size_t)j->seeds.n + 1, sizeof *j->first);
    for (int32_t i = 0; s == TZ_OK && i < j->seeds.n; i++)
        s = plan_seed(j, i, &outputs);
    if (s == TZ_OK && *exemplar) {
        cli->piped = cli->piped || strcmp(exemplar, "-") == 0;
        s = tz_paths_add(cli->ctx, &outputs, exemplar);
    }
    for (int32_t i = 0; s == TZ_OK && i < j->maps.n; i++)
        for (int32_t k = 0; s == TZ_OK && k < j->maps.v[i].path.n; k++)
            s = tz_paths_add(cli->ctx, &j->exemplars.input,
                             tz_cli_find(cli, j->maps.v[i].path.v[k]));
    if (s == TZ_OK && *j->v->rules.rules)
        s = tz_paths_add(cli->ctx, &j->exemplars.input,
                         tz_cli_find(cli, j->v->rules.rules));
    if (s == TZ_OK && cli->piped && cli->common->json)
        s = tz_cli_usage(cli, "--json and an output both want standard output");
    if (s == TZ_OK)
        s = tz_outputs_check(cli->ctx, &j->exemplars.input, &outputs);
    if (s == TZ_OK)
        s = tz_pictures_check(cli, &j->pictures, &j->v->format);
    tz_rect crop;
    if (s == TZ_OK && j->pictures.n)
        s = tz_crop_settle(cli->ctx, j->v->arrange.size, &j->v->compose, &crop);
    tz_paths_free(cli->ctx, &outputs);
    return s;
}

static tz_status one_seed(job *j, int32_t i)
{
    tz_cli *cli = j->cli;
    values *v = j->v;
    tz_layout l = {0};
    const char *document = j->layouts.n ? j->layouts.v[i] : NULL;
    double start = tz_seconds();
    v->arrange.seed = j->seeds.v[i];
    tz_status s = tz_expand_arrange(cli->ctx, j->exemplars.v, j->exemplars.n,
                                    tz_cli_find(cli, v->rules.rules), &v->arrange, &l);
    if (s != TZ_OK)
        goto done;
    tz_figures_seconds(cli, "arrange", tz_seconds() - start);
    tz_figures_count(cli, "placements", l.place.n);
    if (document) {
        s = tz_record_text(cli, &j->record, NULL, "layout", &l.recipe);
        if (s == TZ_OK)
            s = tz_layout_write(cli->ctx, document, &l);
        if (s != TZ_OK)
            goto done;
        tz_figures_output(cli, document, "layout", l.width, l.height);
    }
    tz_image *photos = NULL;
    s = tz_alloc(cli->ctx, &photos, (size_t)j->exemplars.n, sizeof *photos);
    if (s != TZ_OK)
        goto done;
    for (int32_t k = 0; k < j->exemplars.n; k++)
        photos[k] = j->exemplars.v[k].photo;
    const tz_material m = {&l,          photos,     j->exemplars.n, &j->maps,
                           &v->compose, &v->format, &j->record};
    s = tz_pictures_render(cli, &m, &j->pictures, j->first[i], j->first[i + 1]);
    tz_free(cli->ctx, photos);
done:
    tz_layout_deinit(&l);
    return s;
}

static tz_status prepare(job *j)
{
    tz_cli *cli = j->cli;
    values *v = j->v;
    tz_status s = TZ_OK;
    if (*v->own.seeds)
        s = tz_seeds_parse(cli->ctx, v->own.seeds, &j->seeds);
    else
        s = tz_array_push(cli->ctx, &j->seeds, v->arrange.seed);
    if (s == TZ_OK)
        s = tz_maps_parse(cli->ctx, v->maps.maps, cli->operands, &j->maps);
    if (s == TZ_OK)
        s = tz_exemplars_read(cli, &j->record, &j->exemplars);
    if (s == TZ_OK)
        s = tz_record_rules(cli, &j->record, v->rules.rules);
    if (s == TZ_OK)
        s = tz_arrange_settle(cli, &j->exemplars, v->growth.grow, &v->arrange);
    return s == TZ_OK ? plan(j) : s;
}

static tz_status check_maps(job *j)
{
    tz_status s = TZ_OK;
    if (j->maps.n == 0)
        return s;
    for (int32_t i = 0; s == TZ_OK && i < j->exemplars.n; i++)
        s = tz_maps_check(j->cli, &j->maps, i, j->exemplars.v[i].path,
                          &j->exemplars.v[i].photo);
    return s;
}

static tz_status run(tz_cli *cli)
{
    job j = {.cli = cli, .v = cli->values};
    tz_status s = prepare(&j);
    if (s == TZ_OK)
        s = check_maps(&j);
    if (s == TZ_OK)
        s = tz_exemplars_analyze(cli, &j.v->analyze, &j.exemplars);
    if (s == TZ_OK && *j.v->own.save_exemplar)
        s = tz_exemplars_write(cli, &j.exemplars, 0, j.v->own.save_exemplar);
    bool layout = j.layouts.n || j.pictures.n;
    for (int32_t i = 0; s == TZ_OK && layout && i < j.seeds.n; i++)
        s = one_seed(&j, i);
    tz_array_free(cli->ctx, &j.seeds);
    tz_exemplars_free(cli, &j.exemplars);
    tz_maps_free(cli->ctx, &j.maps);
    tz_record_free(cli, &j.record);
    tz_paths_free(cli->ctx, &j.layouts);
    tz_pictures_free(cli->ctx, &j.pictures);
    tz_free(cli->ctx, j.first);
    return s;
}

static const tz_option_group groups[] = {
    {&tz_common_param_table, offsetof(values, common), false},
    {&tz_output_param_table, offsetof(values, output), false},
    {&tz_map_output_param_table, offsetof(values, map_output), false},
    {&own_table, offsetof(values, own), false},
    {&tz_maps_param_table, offsetof(values, maps), true},
    {&tz_rules_param_table, offsetof(values, rules), true},
    {&tz_enlarge_param_table, offsetof(values, growth), false},
    {&tz_arrange_param_table, offsetof(values, arrange), true},
    {&tz_ebpt_param_table, offsetof(values, analyze), true},
    {&tz_compose_param_table, offsetof(values, compose), true},
    {&tz_format_param_table, offsetof(values, format), true},
};
static const tz_example examples[] = {
    {"A photo to a texture of 2048 x 2048 pixels:",
     "terrazzo expand rocks.jpg -o rocks_big.png --size 2048x2048 --seed 7"},
    {"Eight variants, as EXR files:",
     "terrazzo expand gravel.png -o {name}_{seed}.exr --seeds 1..8"},
    {"A texture that tiles, with a height map (here the photo itself):",
     "terrazzo expand brick.png -o wall.exr --tile --maps height=brick.png"},
    {"Keep the layout, edit it in Inkscape, and render it again:",
     "terrazzo expand mossy_bark.jpg -o bark.png --save-layout bark.svg && "
     "terrazzo render bark.svg -o bark_edited.png"},
    {"To another program:",
     "terrazzo expand grass.png -o - --format png --quiet | display -"},
};
const tz_command tz_expand_command = {
    .name = "expand",
    .operands = "PHOTO... -o OUTPUT",
    .summary = "Makes a large texture from a small photo.",
    .about =
        "Finds out what the photos are made of, arranges copies of those pieces over the "
        "texture, and renders them without seams: analyze, arrange and render in one go. "
        "Without --size the texture has four times the sides of the first photo (see "
        "--grow).\n\n"
        "A photo may also be an exemplar that analyze has written (its name ends in "
        ".svg). "
        "Several photos mix in one texture; --rules says where each of them goes.",
    .min_operands = 1,
    .max_operands = -1,
    .group = groups,
    .groups = sizeof groups / sizeof groups[0],
    .example = examples,
    .examples = sizeof examples / sizeof examples[0],
    .size = sizeof(values),
    .run = run,
};
