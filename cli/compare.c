/* SPDX-License-Identifier: Apache-2.0 */
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/quality.h"
#include "cli/compare_curves.h"
#include "cli/compare_elements.h"
#include "cli/elements.h"
#include "cli/exemplars.h"
#include "cli/figures.h"
#include "cli/names.h"
#include "synthesis/expand.h"

/* What two drawings are compared as. */
enum { AS_AUTO, AS_ELEMENTS, AS_CURVES };

typedef struct compare_params {
    int32_t as;
    char heat[TZ_PARAM_STRING_SIZE];
} compare_params;

typedef struct values {
    tz_common_params common;
    compare_params own;
    tz_quality_params quality;
    tz_curve_input_params curves;
} values;

static const tz_param own_rows[] = {
    {"as", TZ_PARAM_ENUM, offsetof(compare_params, as), 0, 0, "auto", "",
     "auto|elements|curves",
     "What two drawings are compared as; auto = curves if one is a document of curves, "
     "else elements."},
    {"heat", TZ_PARAM_STRING, offsetof(compare_params, heat), 0, 0, "", "FILE", NULL,
     "Also writes a map of where the output is worse: white = worst."},
};
static const tz_param_table own_table = {"heat", "What else to write.", own_rows, 2,
                                         sizeof(compare_params)};

/* One figure: name, value, cost in points or NAN, what it means. */
typedef struct row {
    const char *name;
    double value, cost;
    const char *text;
} row;

enum { ROWS = 10 };

static void list_rows(const tz_quality *q, row r[ROWS])
{
    const row rows[ROWS] = {
        {"patch", q->patch, q->cost_patch,
         "patch distance / that of the exemplar's halves"},
        {"orientation", q->orientation, q->cost_structure, "edge directions, likewise"},
        {"correlation", q->correlation, NAN, "autocorrelation, likewise"},
        {"sharpness", q->sharpness, q->cost_sharpness,
         "fine detail, 1 = as the exemplar"},
        {"repetition", q->repetition, q->cost_repetition,
         "share that occurs again elsewhere"},
        {"near-repeat", q->repetition_near, NAN,
         "likewise, slightly stretched or turned too"},
        {"periodicity", q->periodicity, q->cost_periodicity,
         "strength of a regular repeat"},
        {"seam", q->seam, q->cost_seam, "straight breaks beyond the exemplar's"},
        {"broken", q->broken, q->cost_broken, "loose ends of lines / the exemplar's"},
        {"wrap", q->wrap, q->cost_wrap, "break across the wrap / inside"},
    };
    memcpy(r, rows, sizeof rows);
}

static void print_text(const tz_quality *q)
{
    row r[ROWS];
    list_rows(q, r);
    printf("score %16.1f  of 100\n", q->score);
    for (int i = 0; i < ROWS; i++) {
        if (isnan(r[i].value))
            continue;
        printf("%-12s %9.4f  ", r[i].name, r[i].value);
        if (!isnan(r[i].cost))
            printf("costs %5.1f  ", r[i].cost);
        else
            printf("%13s", "");
        printf("%s\n", r[i].text);
    }
}

static void put(json_t *o, const char *name, double v)
{
    json_object_set_new(o, name, isfinite(v) ? json_real(v) : json_null());
}

static void fill_json(json_t *o, const tz_quality *q)
{
    row r[ROWS];
    list_rows(q, r);
    put(o, "score", q->score);
    for (int i = 0; i < ROWS; i++)
        put(o, r[i].name, r[i].value);
    json_t *levels = json_array(), *costs = json_object();
    for (int i = 0; i < 5; i++)
        json_array_append_new(levels, isfinite(q->patch_level[i])
                                          ? json_real(q->patch_level[i])
                                          : json_null());
    json_object_set_new(o, "patch_level", levels);
    put(costs, "patch", q->cost_patch);
    put(costs, "structure", q->cost_structure);
    put(costs, "sharpness", q->cost_sharpness);
    put(costs, "repetition", q->cost_repetition);
    put(costs, "periodicity", q->cost_periodicity);
    put(costs, "seam", q->cost_seam);
    put(costs, "broken", q->cost_broken);
    put(costs, "wrap", q->cost_wrap);
    json_object_set_new(o, "costs", costs);
}

static tz_status write_heat(tz_cli *cli, const char *path, const tz_image *heat)
{
    tz_format_params format;
    tz_image_write_options opt;
    tz_params_default(&tz_format_param_table, &format);
    tz_status s = tz_format_settle(cli->ctx, path, &format, heat, &opt);
    return s == TZ_OK ? tz_image_write(cli->ctx, path, heat, &opt) : s;
}

static tz_status check_heat(tz_cli *cli, const char *path)
{
    tz_path_list in = {0}, out = {0};
    tz_status s = tz_paths_add(cli->ctx, &out, path);
    for (int i = 0; s == TZ_OK && i < 2; i++)
        s = tz_paths_add(cli->ctx, &in, cli->operand[i]);
    if (s == TZ_OK)
        s = tz_outputs_check(cli->ctx, &in, &out);
    tz_paths_free(cli->ctx, &in);
    tz_paths_free(cli->ctx, &out);
    return s;
}

static tz_status run_pixels(tz_cli *cli)
{
    const values *v = cli->values;
    tz_image exemplar = {0}, output = {0}, heat = {0};
    const tz_image_read_options opt = {.want = TZ_ENCODING_SRGB};
    bool want_heat = *v->own.heat;
    tz_quality q;
    double start = tz_seconds();
    tz_status s = want_heat ? check_heat(cli, v->own.heat) : TZ_OK;
    if (s == TZ_OK)
        s = tz_image_read(cli->ctx, cli->operand[0], &opt, &exemplar);
    if (s == TZ_OK)
        s = tz_image_read(cli->ctx, cli->operand[1], &opt, &output);
    if (s == TZ_OK)
        s = tz_images_match(cli->ctx, (tz_image *const[]){&exemplar, &output}, 2);
    if (s != TZ_OK)
        goto done;
    tz_figures_seconds(cli, "read", tz_seconds() - start);
    start = tz_seconds();
    s = tz_quality_measure(cli->ctx, &exemplar, &output, &v->quality, &q,
                           want_heat ? &heat : NULL);
    if (s != TZ_OK)
        goto done;
    tz_figures_seconds(cli, "measure", tz_seconds() - start);
    if (want_heat && (s = write_heat(cli, v->own.heat, &heat)) != TZ_OK)
        goto done;
    if (cli->common->json) {
        fill_json(cli->figures, &q);
    } else {
        print_text(&q);
        cli->piped = true; /* that was the summary */
    }
done:
    tz_image_deinit(&exemplar);
    tz_image_deinit(&output);
    tz_image_deinit(&heat);
    return s;
}

static tz_status is_curves(tz_cli *cli, int32_t as, bool *curves)
{
    *curves = as == AS_CURVES;
    tz_status s = TZ_OK;
    for (int i = 0; i < 2 && as == AS_AUTO && s == TZ_OK; i++) {
        char kind[32] = "";
        s = tz_document_kind(cli, cli->operand[i], kind);
        *curves |= strcmp(kind, "curves") == 0;
    }
    return s;
}

static tz_status run(tz_cli *cli)
{
    const values *v = cli->values;
    bool curves = false;
    if (tz_path_is_svg(cli->operand[0]) != tz_path_is_svg(cli->operand[1]))
        return tz_fail(cli->ctx, TZ_INVALID,
                       "%s, %s: one is a drawing and one a picture; compare two SVG "
                       "documents of elements or of curves, or two pictures",
                       cli->operand[0], cli->operand[1]);
    if (!tz_path_is_svg(cli->operand[0]))
        return run_pixels(cli);
    const tz_status s = is_curves(cli, v->own.as, &curves);
    if (s != TZ_OK)
        return s;
    return curves ? tz_compare_curves(cli, &v->curves) : tz_compare_elements(cli);
}

static const tz_option_group groups[] = {
    {&tz_common_param_table, offsetof(values, common), false},
    {&own_table, offsetof(values, own), false},
    {&tz_quality_param_table, offsetof(values, quality), false},
    {&tz_curve_input_param_table, offsetof(values, curves), false},
};
static const tz_example examples[] = {
    {"How well does a texture continue its photo?",
     "terrazzo compare rocks.jpg rocks_big.png"},
    {"As JSON, with a picture of the weak places:",
     "terrazzo compare gravel.png gravel_7.exr --json --heat weak.png"},
    {"How well does a layout of elements continue its drawing?",
     "terrazzo compare leaves.svg leaves_big.svg"},
    {"How well does a layout of curves continue its drawing?",
     "terrazzo compare streets.svg streets_big.svg --as curves"},
};
const tz_command tz_compare_command = {
    .name = "compare",
    .operands = "EXEMPLAR OUTPUT",
    .summary = "Measures how well a texture continues its exemplar.",
    .about =
        "Prints one score from 0 to 100 and what it is made of. Ratios compare the "
        "texture's distance from the exemplar with the distance between two halves of "
        "the exemplar: 1 is as good as the real thing.\n\n"
        "Of two SVG documents the elements are compared: their distances, "
        "neighbourhoods, "
        "classes and directions, each over the exemplar's own halves' likewise; density, "
        "overlaps and the widest hole beside the exemplar's.\n\n"
        "Of two documents of curves the lines are compared: nodes and ends, ways between "
        "them, turning, directions, density, cells, patches, each over the differences "
        "that parts of the exemplar have from each other; length, dangling ends and node "
        "degrees beside the exemplar's, and what occurs twice.",
    .min_operands = 2,
    .max_operands = 2,
    .group = groups,
    .groups = sizeof groups / sizeof groups[0],
    .example = examples,
    .examples = sizeof examples / sizeof examples[0],
    .size = sizeof(values),
    .run = run,
};
