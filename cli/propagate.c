/* SPDX-License-Identifier: Apache-2.0 */
#include "elements/propagate.h"

#include <math.h>
#include <string.h>

#include "cli/elements.h"
#include "cli/figures.h"
#include "cli/material.h"
#include "elements/element_io.h"

typedef struct values {
    tz_common_params common;
    tz_output_params output;
    tz_propagate_params propagate;
} values;

static tz_status check(tz_cli *cli, const char *output)
{
    tz_path_list in = {0}, out = {0};
    cli->piped = strcmp(output, "-") == 0;
    if (cli->piped && cli->common->json)
        return tz_cli_usage(cli, "--json and the layout both want standard output");
    tz_status s = tz_element_write_check(cli->ctx, output);
    if (s == TZ_OK)
        s = tz_paths_add(cli->ctx, &out, output);
    for (int i = 0; s == TZ_OK && i < 2; i++)
        s = tz_paths_add(cli->ctx, &in, tz_cli_find(cli, cli->operand[i]));
    if (s == TZ_OK)
        s = tz_outputs_check(cli->ctx, &in, &out);
    tz_paths_free(cli->ctx, &in);
    tz_paths_free(cli->ctx, &out);
    return s;
}

static tz_status carry(tz_cli *cli, const tz_element_set set[2], tz_record *record)
{
    const values *v = cli->values;
    tz_element_set out = {0};
    tz_propagate_report report;
    const double start = tz_seconds();
    tz_status s =
        tz_element_propagate(cli->ctx, &set[0], &set[1], &v->propagate, &out, &report);
    if (s != TZ_OK)
        return s;
    tz_figures_seconds(cli, "propagate", tz_seconds() - start);
    tz_figures_count(cli, "examples", report.examples);
    tz_figures_count(cli, "followed", report.followed);
    if (report.examples == 0)
        tz_warn(cli->ctx, "%s, %s: nothing differs between them, so nothing is changed",
                cli->operand[0], cli->operand[1]);
    s = tz_record_text(cli, record, NULL, "layout", &out.recipe);
    if (s == TZ_OK)
        s = tz_element_write(cli->ctx, v->output.output, &out);
    if (s == TZ_OK)
        tz_figures_output(cli, v->output.output, "layout",
                          (int32_t)fmin(2e9, rint(out.domain.size.x)),
                          (int32_t)fmin(2e9, rint(out.domain.size.y)));
    tz_element_set_deinit(&out);
    return s;
}

static tz_status run(tz_cli *cli)
{
    const values *v = cli->values;
    tz_medium_params medium;
    tz_record record = {0};
    tz_element_set set[2];
    memset(set, 0, sizeof set);
    tz_params_default(&tz_medium_param_table, &medium);
    if (!*v->output.output)
        return tz_cli_usage(cli, "no output; give one with -o FILE.svg");
    tz_status s = check(cli, v->output.output);
    for (int i = 0; s == TZ_OK && i < 2; i++)
        s = tz_elements_read(cli, cli->operand[i], &medium, 0, &record, &set[i]);
    if (s == TZ_OK)
        s = carry(cli, set, &record);
    tz_element_set_deinit(&set[0]);
    tz_element_set_deinit(&set[1]);
    tz_record_free(cli, &record);
    return s;
}

static const tz_option_group groups[] = {
    {&tz_common_param_table, offsetof(values, common), false},
    {&tz_output_param_table, offsetof(values, output), false},
    {&tz_propagate_param_table, offsetof(values, propagate), true},
};
static const tz_example examples[] = {
    {"Turn one leaf in an editor, save under another name, and let all alike ones "
     "follow:",
     "terrazzo propagate leaves_big.svg leaves_edited.svg -o leaves_all.svg"},
};
const tz_command tz_propagate_command = {
    .name = "propagate",
    .operands = "BEFORE.svg AFTER.svg -o LAYOUT.svg",
    .summary = "Carries a change of a few elements over to all that are like them.",
    .about = "Compares a layout of elements before and after somebody edited it: "
             "elements that "
             "were moved, turned, scaled, replaced, added or removed are examples. All "
             "elements "
             "whose neighbourhoods are like an example's are changed in the same way.",
    .min_operands = 2,
    .max_operands = 2,
    .group = groups,
    .groups = sizeof groups / sizeof groups[0],
    .example = examples,
    .examples = sizeof examples / sizeof examples[0],
    .size = sizeof(values),
    .run = run,
};
