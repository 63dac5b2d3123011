/* SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <string.h>

#include "analysis/forest_train.h"
#include "cli/command.h"
#include "cli/figures.h"
#include "cli/material.h"
#include "cli/names.h"

typedef struct values {
    tz_common_params common;
    tz_output_params output;
    tz_forest_train_params train;
} values;

static bool ends_in(const char *text, const char *end)
{
    const size_t n = strlen(text), k = strlen(end);
    return n >= k && strcmp(text + n - k, end) == 0;
}

static void count_nodes(tz_cli *cli, const tz_forest *f)
{
    int64_t leaves = 0, all = 0;
    for (int32_t t = 0; t < f->trees; t++)
        for (int32_t i = 0; i < f->nodes; i++) {
            const int64_t at = (int64_t)t * f->nodes + i;
            all += f->child[at] != 0;
            leaves += f->child[at] == 0 && f->bound[at] < f->bound[at + 1];
        }
    tz_figures_count(cli, "trees", f->trees);
    tz_figures_count(cli, "splits", all);
    tz_figures_count(cli, "leaves with edges", leaves);
}

static tz_status run(tz_cli *cli)
{
    const values *v = cli->values;
    const char *path = v->output.output;
    tz_path_list inputs = {0}, outputs = {0};
    tz_forest f = {0};
    tz_status s;
    if (!*path)
        return tz_cli_usage(cli, "no output; give one with -o FILE.yml.gz");
    cli->piped = strcmp(path, "-") == 0;
    if (!cli->piped && !ends_in(path, ".yml") && !ends_in(path, ".yml.gz"))
        return tz_fail(cli->ctx, TZ_INVALID, "%s: a model is named .yml or .yml.gz",
                       path);
    if ((s = tz_paths_add(cli->ctx, &outputs, path)) != TZ_OK)
        goto done;
    if ((s = tz_outputs_check(cli->ctx, &inputs, &outputs)) != TZ_OK)
        goto done;
    if ((s = tz_forest_train(cli->ctx, &v->train, &f)) != TZ_OK)
        goto done;
    count_nodes(cli, &f);
    if ((s = tz_forest_write(cli->ctx, path, &f)) == TZ_OK)
        tz_figures_output(cli, path, "model", f.trees, f.nodes);
done:
    tz_forest_deinit(&f);
    tz_paths_free(cli->ctx, &outputs);
    return s;
}

static const tz_option_group groups[] = {
    {&tz_common_param_table, offsetof(values, common), false},
    {&tz_output_param_table, offsetof(values, output), false},
    {&tz_forest_train_param_table, offsetof(values, train), true},
};
static const tz_example examples[] = {
    {"A small model, to try:", "terrazzo train-edges -o small.yml.gz --budget 1m"},
    {"Find edges with it:",
     "terrazzo analyze rocks.jpg -o rocks.svg --model small.yml.gz"},
};
const tz_command tz_train_edges_command = {
    .name = "train-edges",
    .operands = "-o MODEL.yml.gz",
    .summary = "Trains the model that finds edges, on scenes that Terrazzo draws.",
    .about =
        "Draws scenes of stones, bricks, cracks, leaves, bark and more, whose boundaries "
        "are known, and trains a structured random forest on them. No photo is needed. "
        "The file is in the format of OpenCV's structured edge detector and serves "
        "analyze and expand through --model. Memory: up to 8 GB unless --memory says "
        "otherwise, and what it takes grows with the budget.",
    .min_operands = 0,
    .max_operands = 0,
    .group = groups,
    .groups = sizeof groups / sizeof groups[0],
    .example = examples,
    .examples = sizeof examples / sizeof examples[0],
    .size = sizeof(values),
    .memory = (uint64_t)8 << 30,
    .run = run,
};
