/* SPDX-License-Identifier: Apache-2.0 */
/* Photos in, large texture out: read, analyse once, then for each seed arrange, save and
 * render. */
#include <string.h>

#include "cli/exemplars.h"
#include "cli/expand_curves.h"
#include "cli/expand_decide.h"
#include "cli/expand_elements.h"
#include "cli/expand_plan.h"
#include "cli/figures.h"

typedef struct values {
    tz_common_params common;
    tz_output_params output;
    tz_map_output_params map_output;
    tz_expand_params own;
    tz_maps_params maps;
    tz_medium_params medium;
    tz_things_params things;
    tz_guide_params guides;
    tz_element_arrange_params elements;
    tz_element_render_params look;
    tz_lines_params lines;
    tz_curve_input_params input;
    tz_curve_arrange_params curves;
    tz_curve_render_params strokes;
    tz_rules_params rules;
    tz_enlarge_params growth;
    tz_arrange_params arrange;
    tz_ebpt_params analyze;
    tz_compose_params compose;
    tz_format_params format;
} values;

/* Everything of a run that several steps need. */
typedef struct job {
    tz_cli *cli;
    values *v;
    tz_expand_plan plan;
    tz_exemplars exemplars;
    tz_map_list maps;
    tz_record record;
    tz_frames *frames;
} job;

static tz_status name_pictures(tz_cli *cli, void *user, tz_name_values v,
                               tz_picture_list *out)
{
    const job *j = user;
    return tz_pictures_plan(cli, j->v->output.output, j->v->map_output.map_output,
                            &j->maps, v, out);
}

/* Files that must not be overwritten, besides the exemplars themselves. */
static tz_status list_inputs(job *j)
{
    tz_cli *cli = j->cli;
    tz_status s = TZ_OK;
    for (int32_t i = 0; s == TZ_OK && i < j->maps.n; i++)
        for (int32_t k = 0; s == TZ_OK && k < j->maps.v[i].path.n; k++)
            s = tz_paths_add(cli->ctx, &j->exemplars.input,
                             tz_cli_find(cli, j->maps.v[i].path.v[k]));
    if (s == TZ_OK && *j->v->rules.rules)
        s = tz_paths_add(cli->ctx, &j->exemplars.input,
                         tz_cli_find(cli, j->v->rules.rules));
    if (s == TZ_OK)
        s = tz_guides_paths(cli, &j->v->guides, &j->exemplars.input);
    return s;
}

static tz_status one_seed(job *j, int32_t i)
{
    tz_cli *cli = j->cli;
    values *v = j->v;
    tz_layout l = {0};
    const char *document = j->plan.layouts.n ? j->plan.layouts.v[i] : NULL;
    double start = tz_seconds();
    v->arrange.seed = j->plan.seeds.v[i];
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
    s = tz_pictures_render(cli, &m, &j->plan.pictures, j->plan.first[i],
                           j->plan.first[i + 1]);
    tz_free(cli->ctx, photos);
done:
    tz_layout_deinit(&l);
    return s;
}

static tz_status prepare(job *j)
{
    tz_cli *cli = j->cli;
    values *v = j->v;
    tz_rect crop;
    tz_expand_wish w = {.own = &v->own,
                        .output = v->output.output,
                        .format = &v->format,
                        .seed = v->arrange.seed,
                        .inputs = &j->exemplars.input,
                        .pictures = name_pictures,
                        .user = j};
    tz_status s = tz_expand_seeds(cli, &w, &j->plan);
    if (s == TZ_OK)
        s = tz_maps_parse(cli->ctx, v->maps.maps, cli->operands, &j->maps);
    if (s == TZ_OK)
        s = tz_exemplars_read(cli, &j->record, &j->exemplars);
    if (s == TZ_OK)
        s = tz_record_rules(cli, &j->record, v->rules.rules);
    if (s == TZ_OK)
        s = tz_arrange_settle(cli, &j->exemplars, v->growth.grow, &v->arrange);
    if (s == TZ_OK)
        s = list_inputs(j);
    w.width = v->arrange.size[0];
    w.height = v->arrange.size[1];
    if (s == TZ_OK)
        s = tz_expand_plan_make(cli, &w, &j->plan);
    if (s == TZ_OK)
        s = tz_guides_frames(cli, &v->guides, &j->record,
                             (tz_vec3){v->arrange.size[0], v->arrange.size[1], 0},
                             v->arrange.tile, &j->frames);
    v->arrange.frames = j->frames;
    if (s == TZ_OK && j->plan.pictures.n)
        s = tz_crop_settle(cli->ctx, v->arrange.size, &v->compose, &crop);
    return s;
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

static tz_status run_edges(tz_cli *cli)
{
    job j = {.cli = cli, .v = cli->values};
    tz_status s = prepare(&j);
    if (s == TZ_OK)
        s = check_maps(&j);
    if (s == TZ_OK)
        s = tz_exemplars_analyze(cli, &j.v->analyze, &j.exemplars);
    if (s == TZ_OK && *j.v->own.save_exemplar)
        s = tz_exemplars_write(cli, &j.exemplars, 0, j.v->own.save_exemplar);
    bool layout = j.plan.layouts.n || j.plan.pictures.n;
    for (int32_t i = 0; s == TZ_OK && layout && i < j.plan.seeds.n; i++)
        s = one_seed(&j, i);
    j.v->arrange.frames = NULL;
    tz_frames_free(j.frames);
    tz_exemplars_free(cli, &j.exemplars);
    tz_maps_free(cli->ctx, &j.maps);
    tz_record_free(cli, &j.record);
    tz_expand_plan_free(cli, &j.plan);
    return s;
}

/** --as auto: what the photo is made of decides. */
static tz_status run_decided(tz_cli *cli, const tz_expand_elements_job *things,
                             const tz_expand_curves_job *lines)
{
    tz_expand_decision d = {0};
    tz_status s =
        tz_expand_decide(cli, lines->lines, things->things, things->analyze->model, &d);
    const tz_as as = d.as;
    if (s == TZ_OK && as == TZ_AS_CURVES)
        s = tz_expand_curves(cli, lines, &d.lines, &d.line_record);
    else if (s == TZ_OK && as == TZ_AS_ELEMENTS)
        s = tz_expand_elements(cli, things, &d.things, &d.thing_record);
    tz_expand_decision_free(cli, &d);
    return s == TZ_OK && as == TZ_AS_EDGES ? run_edges(cli) : s;
}

static tz_status run(tz_cli *cli)
{
    values *v = cli->values;
    v->strokes.scale = v->look.scale;
    const tz_expand_elements_job job = {
        &v->own,      v->output.output, v->map_output.map_output,
        v->maps.maps, &v->medium,       &v->things,
        &v->guides,   &v->elements,     &v->look,
        &v->compose,  &v->format,       &v->analyze,
        &v->arrange,  v->growth.grow};
    const tz_expand_curves_job curves = {
        &v->own,      v->output.output, v->map_output.map_output,
        v->maps.maps, &v->input,        &v->lines,
        &v->guides,   &v->curves,       &v->strokes,
        &v->compose,  &v->format,       &v->analyze,
        &v->arrange,  v->growth.grow};
    tz_as as;
    tz_status s = tz_medium_settle(cli, cli->operand[0], &v->medium, &as);
    if (s != TZ_OK)
        return s;
    v->input.wrap = v->medium.wrap;
    if (as == TZ_AS_ELEMENTS)
        return tz_expand_elements(cli, &job, NULL, NULL);
    if (as == TZ_AS_CURVES)
        return tz_expand_curves(cli, &curves, NULL, NULL);
    const bool ask = v->medium.as == TZ_AS_AUTO && !tz_path_is_svg(cli->operand[0]);
    return ask ? run_decided(cli, &job, &curves) : run_edges(cli);
}

static const tz_option_group groups[] = {
    {&tz_common_param_table, offsetof(values, common), false},
    {&tz_output_param_table, offsetof(values, output), false},
    {&tz_map_output_param_table, offsetof(values, map_output), false},
    {&tz_expand_param_table, offsetof(values, own), false},
    {&tz_maps_param_table, offsetof(values, maps), true},
    {&tz_medium_param_table, offsetof(values, medium), true},
    {&tz_things_param_table, offsetof(values, things), true},
    {&tz_guide_param_table, offsetof(values, guides), true},
    {&tz_element_arrange_param_table, offsetof(values, elements), true},
    {&tz_element_render_param_table, offsetof(values, look), true},
    {&tz_lines_param_table, offsetof(values, lines), true},
    {&tz_curve_input_param_table, offsetof(values, input), true},
    {&tz_curve_arrange_param_table, offsetof(values, curves), true},
    {&tz_curve_render_param_table, offsetof(values, strokes), true},
    {&tz_rules_param_table, offsetof(values, rules), true},
    {&tz_enlarge_param_table, offsetof(values, growth), true},
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
    {"The joints of a wall arranged anew, with the bricks between them:",
     "terrazzo expand brick.png -o joints.png --as curves --seed 3"},
    {"To another program:",
     "terrazzo expand grass.png -o - --format png --quiet | display -"},
};
const tz_command tz_expand_command = {
    .name = "expand",
    .operands = "PHOTO...|DRAWING -o OUTPUT",
    .summary = "Makes a large texture from a small photo.",
    .about =
        "Finds out what the photos are made of, arranges copies of those pieces over the "
        "texture, and renders them without seams: analyze, arrange and render in one go. "
        "Without --size the texture has four times the sides of the first photo (see "
        "--grow).\n\n"
        "With --as elements the things of a photo (pebbles, setts, leaves) are arranged "
        "and "
        "drawn over the ground beneath them; --as auto looks at the photo and says what "
        "it "
        "takes it as, and why. Drawings are elements where nothing else is said.\n\n"
        "With --as curves the lines of a photo (cracks, veins, joints) or the strokes of "
        "a "
        "drawing are arranged; the lines of a photo take along what lies beside them.\n\n"
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
