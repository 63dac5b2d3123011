/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Inputs of a run with their hashes, and the recipes of its outputs made from them. */
#ifndef TZ_CLI_RECORD_H
#define TZ_CLI_RECORD_H

#include "cli/command.h"
#include "cli/names.h"
#include "synthesis/recipe.h"

typedef struct tz_record {
    tz_path_list path;   /**< as given */
    tz_path_list sha256; /**< in the same order */
} tz_record;

void tz_record_free(tz_cli *cli, tz_record *r);
/** Adds an input. @param sha256 NULL = hash the file now */
tz_status tz_record_input(tz_cli *cli, tz_record *r, const char *path,
                          const char *sha256);
/** Adds a rule file and the images that it names ("" = none). */
tz_status tz_record_rules(tz_cli *cli, tz_record *r, const char *path);
/** Recipe of one output: this command, its operands, recorded options and inputs. Under
 * replay the recipe that is replayed.
 * @param extra    inputs of this output alone, or NULL
 * @param[out] out free with tz_free(cli->ctx, ...) */
tz_status tz_record_text(tz_cli *cli, const tz_record *r, const tz_record *extra,
                         const char *makes, char **out);

#endif
