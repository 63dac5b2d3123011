/* SPDX-License-Identifier: Apache-2.0 */
/* The list of commands and look-ups in it. A new command is one file, one line here and
 * one in command.h. */
#include "cli/command.h"

#include <stdarg.h>
#include <string.h>

const tz_command *const tz_command_list[] = {
    &tz_expand_command, &tz_analyze_command,     &tz_arrange_command, &tz_render_command,
    &tz_fill_command,   &tz_propagate_command,   &tz_compare_command, &tz_replay_command,
    &tz_sheet_command,  &tz_train_edges_command, &tz_params_command,
};
const int32_t tz_command_count = sizeof tz_command_list / sizeof tz_command_list[0];

const tz_option_letter tz_letter_list[] = {
    {'o', "output"}, {'q', "quiet"}, {'j', "threads"}, {'h', "help"}};
const int32_t tz_letter_count = sizeof tz_letter_list / sizeof tz_letter_list[0];

#define AT(m) offsetof(tz_common_params, m)
static const tz_param common_rows[] = {
    {"threads", TZ_PARAM_INT, AT(threads), 0, 1024, "0", "", NULL,
     "Worker threads; 0 = one a processor. The output's bytes do not depend on it."},
    {"memory", TZ_PARAM_BYTES, AT(memory), 16777216, 9e15, "1G", "bytes", NULL,
     "Memory budget for pixels and working data, such as 512M or 4G."},
    {"quiet", TZ_PARAM_BOOL, AT(quiet), 0, 1, "false", "", NULL,
     "No progress bar and no summary; warnings and errors still show."},
    {"json", TZ_PARAM_BOOL, AT(json), 0, 1, "false", "", NULL,
     "Prints the final figures as JSON on standard output."},
    {"help", TZ_PARAM_BOOL, AT(help), 0, 1, "false", "", NULL, "Shows this help."},
};
#undef AT
const tz_param_table tz_common_param_table = {
    "common", "Options of every command.", common_rows,
    sizeof common_rows / sizeof common_rows[0], sizeof(tz_common_params)};

const tz_command *tz_command_find(const char *name)
{
    for (int32_t i = 0; i < tz_command_count; i++)
        if (strcmp(tz_command_list[i]->name, name) == 0)
            return tz_command_list[i];
    return NULL;
}

const char *tz_letter_name(char letter)
{
    for (int32_t i = 0; i < tz_letter_count; i++)
        if (tz_letter_list[i].letter == letter)
            return tz_letter_list[i].name;
    return NULL;
}

char tz_name_letter(const char *name)
{
    for (int32_t i = 0; i < tz_letter_count; i++)
        if (strcmp(tz_letter_list[i].name, name) == 0)
            return tz_letter_list[i].letter;
    return 0;
}

const tz_param *tz_command_option(const tz_command *c, const char *name,
                                  const tz_option_group **group)
{
    for (int32_t g = 0; g < c->groups; g++) {
        const tz_param *p = tz_params_find(c->group[g].table, name);
        if (p) {
            if (group)
                *group = &c->group[g];
            return p;
        }
    }
    return NULL;
}

void tz_option_metavar(const tz_param *p, char *text, size_t size)
{
    const char *v = "";
    switch (p->type) {
    case TZ_PARAM_BOOL: break;
    case TZ_PARAM_INT:
    case TZ_PARAM_UINT64: v = "N"; break;
    case TZ_PARAM_DOUBLE: v = "X"; break;
    case TZ_PARAM_ENUM: v = p->choices; break;
    case TZ_PARAM_STRING: v = p->unit && *p->unit ? p->unit : "TEXT"; break;
    case TZ_PARAM_SIZE: v = "WxH"; break;
    case TZ_PARAM_RANGE: v = "LO,HI"; break;
    case TZ_PARAM_RECT: v = "X,Y,W,H"; break;
    case TZ_PARAM_BYTES: v = "BYTES"; break;
    }
    snprintf(text, size, "%s", v);
}

tz_status tz_cli_usage(tz_cli *cli, const char *fmt, ...)
{
    char text[512];
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    cli->usage = true;
    return tz_fail(cli->ctx, TZ_INVALID, "%s: %s", cli->command->name, text);
}

const char *tz_cli_find(const tz_cli *cli, const char *path)
{
    for (int32_t i = 0; cli->replay && i < cli->replay->inputs; i++)
        if (strcmp(cli->replay->path[i], path) == 0)
            return cli->replay->found[i];
    return path;
}

bool tz_cli_makes(const tz_cli *cli, const char *makes)
{
    return !cli->replay || strcmp(cli->replay->makes, makes) == 0;
}

bool tz_cli_given(const tz_cli *cli, const char *name)
{
    for (int32_t i = 0; i < cli->givens; i++)
        if (strcmp(cli->given[i]->name, name) == 0)
            return true;
    return false;
}

tz_status tz_cli_give(tz_cli *cli, const tz_param *row)
{
    if (tz_cli_given(cli, row->name))
        return TZ_OK;
    int32_t all = 0;
    for (int32_t g = 0; g < cli->command->groups; g++)
        all += cli->command->group[g].table->n;
    if (!cli->given) {
        tz_status s = tz_alloc_zero(NULL, &cli->given, (size_t)all, sizeof *cli->given);
        if (s != TZ_OK)
            return s;
    }
    cli->given[cli->givens++] = row;
    return TZ_OK;
}

tz_status tz_cli_init(tz_cli *cli, tz_ctx *ctx, const tz_command *c)
{
    *cli = (tz_cli){.ctx = ctx, .command = c};
    tz_status s = tz_alloc_zero(NULL, &cli->values, 1, c->size);
    if (s != TZ_OK)
        return s;
    for (int32_t g = 0; g < c->groups; g++)
        tz_params_default(c->group[g].table, (char *)cli->values + c->group[g].offset);
    cli->common = cli->values;
    return TZ_OK;
}

void tz_cli_deinit(tz_cli *cli)
{
    tz_free(NULL, cli->values);
    tz_free(NULL, cli->given);
    *cli = (tz_cli){0};
}
