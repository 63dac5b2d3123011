/* SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <string.h>

#include "cli/figures.h"
#include "cli/help.h"

typedef enum params_format {
    PARAMS_TEXT,
    PARAMS_SCHEMA,
    PARAMS_MAN,
    PARAMS_BASH,
    PARAMS_ZSH
} params_format;

typedef struct params_params {
    int32_t format;
} params_params;

typedef struct values {
    tz_common_params common;
    params_params own;
} values;

static const tz_param own_rows[] = {
    {"format", TZ_PARAM_ENUM, offsetof(params_params, format), 0, 0, "text", "",
     "text|json-schema|man|bash|zsh",
     "Plain text, JSON schema, manual page (of all commands), or a completion script."},
};
static const tz_param_table own_table = {"params", "What to print.", own_rows, 1,
                                         sizeof(params_params)};

static void print_text(const tz_command *c)
{
    printf("terrazzo %s\n", c->name);
    for (int32_t g = 0; g < c->groups; g++) {
        printf("\n");
        tz_params_print_text(c->group[g].table, stdout);
    }
}

static tz_status run(tz_cli *cli)
{
    const values *v = cli->values;
    cli->piped = true;
    const tz_command *one = NULL;
    if (cli->operands && !(one = tz_command_find(cli->operand[0])))
        return tz_cli_usage(cli, "there is no command '%s'", cli->operand[0]);
    switch ((params_format)v->own.format) {
    case PARAMS_MAN: tz_help_man(stdout); return TZ_OK;
    case PARAMS_BASH: tz_help_bash(stdout); return TZ_OK;
    case PARAMS_ZSH: tz_help_zsh(stdout); return TZ_OK;
    default: break;
    }
    bool schema = v->own.format == PARAMS_SCHEMA;
    if (schema && !one)
        printf("[\n");
    for (int32_t i = 0; i < tz_command_count; i++) {
        const tz_command *c = tz_command_list[i];
        if (one && c != one)
            continue;
        if (schema)
            tz_help_schema(c, stdout);
        else
            print_text(c);
        if (!one && i + 1 < tz_command_count)
            printf(schema ? ",\n" : "\n");
    }
    if (schema && !one)
        printf("]\n");
    return TZ_OK;
}

static const tz_option_group groups[] = {
    {&tz_common_param_table, offsetof(values, common), false},
    {&own_table, offsetof(values, own), false},
};
static const tz_example examples[] = {
    {"All parameters of expand, with ranges and defaults:", "terrazzo params expand"},
    {"For another program:", "terrazzo params expand --format json-schema"},
};
const tz_command tz_params_command = {
    .name = "params",
    .operands = "[COMMAND]",
    .summary = "Prints the parameter tables.",
    .about = "Prints every parameter of one command or of all: name, type, range, unit, "
             "default and meaning.",
    .min_operands = 0,
    .max_operands = 1,
    .group = groups,
    .groups = sizeof groups / sizeof groups[0],
    .example = examples,
    .examples = sizeof examples / sizeof examples[0],
    .size = sizeof(values),
    .run = run,
};
