/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Final figures of a run: JSON on request, else one short summary. */
#ifndef TZ_CLI_FIGURES_H
#define TZ_CLI_FIGURES_H

#include "cli/command.h"

/** Adds an output file. @param map "colour", a map's name, "layout", ... */
void tz_figures_output(tz_cli *cli, const char *path, const char *map, int32_t width,
                       int32_t height);
/** Adds seconds to a stage. */
void tz_figures_seconds(tz_cli *cli, const char *stage, double seconds);
/** Sets a text; of "as" and "why" the summary tells too. */
void tz_figures_text(tz_cli *cli, const char *name, const char *text);
/** Adds to a count. */
void tz_figures_count(tz_cli *cli, const char *name, int64_t n);
/** Prints: JSON if asked for, nothing if quiet or piped, else the summary. */
void tz_figures_print(tz_cli *cli, double seconds);

#endif
