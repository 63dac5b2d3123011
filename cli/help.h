/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Words about the commands, all made from their descriptions and parameter tables: help,
 * manual page, JSON schema and completions for bash and zsh. */
#ifndef TZ_CLI_HELP_H
#define TZ_CLI_HELP_H

#include <stdio.h>

#include "cli/command.h"

void tz_help_overview(FILE *f);
void tz_help_command(const tz_command *c, FILE *f);
/** Manual page of the whole program, roff. */
void tz_help_man(FILE *f);
/** JSON schemas of a command's tables. */
void tz_help_schema(const tz_command *c, FILE *f);
void tz_help_bash(FILE *f);
void tz_help_zsh(FILE *f);

#endif
