/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What a subcommand is: a name, words for the manual, parameter tables and a function.
 * Parser, help, manual page and completions all read these descriptions; no option is
 * written down anywhere else. */
#ifndef TZ_CLI_COMMAND_H
#define TZ_CLI_COMMAND_H

#include "base/alloc.h"
#include "base/param.h"

typedef struct tz_cli tz_cli;

/** One table's place in a command's values. */
typedef struct tz_option_group {
    const tz_param_table *table;
    size_t offset; /**< of the table's struct in the command's values */
    bool recorded; /**< shapes the output's bytes: goes into the recipe */
} tz_option_group;

typedef struct tz_example {
    const char *text, *command;
} tz_example;

typedef struct tz_command {
    const char *name;
    const char *operands;               /**< "PHOTO... -o OUTPUT" */
    const char *summary;                /**< one line */
    const char *about;                  /**< paragraphs parted by an empty line */
    int32_t min_operands, max_operands; /**< max -1: any number */
    const tz_option_group *group; /**< group[0] is tz_common_param_table at offset 0 */
    int32_t groups;
    const tz_example *example;
    int32_t examples;
    size_t size;     /**< of the command's values */
    uint64_t memory; /**< budget, bytes, where --memory is not given; 0 = its default */
    tz_status (*run)(tz_cli *cli);
} tz_command;

/** Options that every command takes: the first member of every command's values. */
typedef struct tz_common_params {
    int32_t threads;
    uint64_t memory;
    bool quiet, json, help;
} tz_common_params;
extern const tz_param_table tz_common_param_table;

/** One letter that stands for an option. */
typedef struct tz_option_letter {
    char letter;
    const char *name;
} tz_option_letter;

extern const tz_command *const tz_command_list[]; /**< in the manual's order */
extern const int32_t tz_command_count;
extern const tz_option_letter tz_letter_list[];
extern const int32_t tz_letter_count;

/** Command of that name, or NULL. */
const tz_command *tz_command_find(const char *name);
/** Long name for a letter, or NULL; and letter for a name, or 0. */
const char *tz_letter_name(char letter);
char tz_name_letter(const char *name);
/** Row of a command's option and the group it stands in, or NULL. */
const tz_param *tz_command_option(const tz_command *c, const char *name,
                                  const tz_option_group **group);
/** What stands for an option's value in help texts, "" for a switch. */
void tz_option_metavar(const tz_param *p, char *text, size_t size);

/** A command under way. */
struct tz_cli {
    tz_ctx *ctx;
    const tz_command *command;
    void *values; /**< command->size bytes */
    const tz_common_params *common;
    char **operand; /**< pointers into argv, or owned by whoever set them */
    int32_t operands;
    const tz_param **given; /**< rows that the command line names */
    int32_t givens;
    struct json_t *figures;         /**< object that the command fills, see figures.h */
    bool usage;                     /**< the error is the command line's: exit 2 */
    bool piped;                     /**< an output goes to standard output */
    const struct tz_replay *replay; /**< under replay, else NULL */
};

/** A command that replay runs again. */
typedef struct tz_replay {
    const char *recipe; /**< text to embed as it is */
    const char *makes;  /**< the one output to make: "colour", a map, "layout" */
    int32_t inputs;
    char **path, **found; /**< inputs as the recipe names them, and where they are */
} tz_replay;

/** Fails with exit code 2. */
tz_status tz_cli_usage(tz_cli *cli, const char *fmt, ...) TZ_PRINTF(2, 3);
/** Where an input is: the path itself, or under replay where it was found. */
const char *tz_cli_find(const tz_cli *cli, const char *path);
/** Whether the command is to make this output: always, but under replay only that one. */
bool tz_cli_makes(const tz_cli *cli, const char *makes);
/** Whether the command line (or the recipe) names the option. Recipes keep that only of options
 * that decides() in record.c lists: add yours. */
bool tz_cli_given(const tz_cli *cli, const char *name);
/** Marks an option as given. */
tz_status tz_cli_give(tz_cli *cli, const tz_param *row);
/** Fills values with the tables' defaults. */
tz_status tz_cli_init(tz_cli *cli, tz_ctx *ctx, const tz_command *c);
void tz_cli_deinit(tz_cli *cli);

extern const tz_command tz_expand_command, tz_analyze_command, tz_arrange_command,
    tz_render_command, tz_compare_command, tz_replay_command, tz_sheet_command,
    tz_params_command, tz_train_edges_command, tz_propagate_command, tz_fill_command;

#endif
