/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Command line to values, driven by the parameter tables. */
#ifndef TZ_CLI_OPTIONS_H
#define TZ_CLI_OPTIONS_H

#include "cli/command.h"

typedef enum tz_parse_result {
    TZ_PARSE_OK,
    TZ_PARSE_USAGE, /**< the command line is not understood; message in the context */
    TZ_PARSE_VALUE, /**< an option's value is not usable; message in the context */
} tz_parse_result;

/** Index in argv of the command's name, or 0 if there is none: the first argument that is
 * neither an option nor an option's value. */
int tz_options_command(int argc, char **argv);

/** Parses argv[1..argc-1] without argv[command] into cli->values, operands and given.
 * `--name value`, `--name=value`, `--switch`, `--no-switch`, `-o value`, `-ovalue`; "--"
 * ends the options; "-" is an operand; later values win. argv is reordered: the operands
 * come to stand at its start.
 * @param command  index of the command's name in argv */
tz_parse_result tz_options_parse(tz_cli *cli, int argc, char **argv, int command);

/** Word of `list` nearest to `word` (few edits, or begun alike), or NULL.
 * @param list  n words */
const char *tz_options_nearest(const char *word, const char *const *list, int32_t n);

#endif
