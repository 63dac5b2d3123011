/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The curve half of arrange: the curves of a drawing or a photo over a domain, around what is drawn
 * already, or into a part of the drawing itself. */
#ifndef TZ_CLI_ARRANGE_CURVES_H
#define TZ_CLI_ARRANGE_CURVES_H

#include "analysis/lines.h"
#include "cli/curves.h"
#include "cli/elements.h"
#include "curves/curve_arrange.h"
#include "synthesis/arrange.h"

/** What is there already, and what is foretold. Table: tz_curve_draw_param_table. */
typedef struct tz_curve_draw_params {
    char given[TZ_PARAM_STRING_SIZE], complete[TZ_PARAM_STRING_SIZE],
        clone[TZ_PARAM_STRING_SIZE], to[TZ_PARAM_STRING_SIZE];
} tz_curve_draw_params;
extern const tz_param_table tz_curve_draw_param_table;

/** How the work can be watched; no part of recipes. Table: tz_curve_watch_param_table. */
typedef struct tz_curve_watch_params {
    char trace[TZ_PARAM_STRING_SIZE], samples[TZ_PARAM_STRING_SIZE];
} tz_curve_watch_params;
extern const tz_param_table tz_curve_watch_param_table;

typedef struct tz_curves_job {
    const char *output, *keep;
    const tz_curve_input_params *input;
    const tz_lines_params *lines; /**< of a photo */
    const tz_curve_output_params *format;
    const tz_curve_draw_params *draw;
    const tz_curve_watch_params *watch;
    const tz_curve_arrange_params *curves;
    const tz_guide_params *guides;
    tz_arrange_params *arrange; /**< size, seed, tile; the size is settled here */
    double grow;
} tz_curves_job;

/** Reads, arranges or foretells, writes .svg or .dxf. */
tz_status tz_arrange_curves(tz_cli *cli, const tz_curves_job *job);

#endif
