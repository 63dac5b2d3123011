/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The curve half of expand: photo or drawing to pixels by way of its lines. */
#ifndef TZ_CLI_EXPAND_CURVES_H
#define TZ_CLI_EXPAND_CURVES_H

#include "cli/curve_material.h"
#include "cli/curve_photos.h"
#include "cli/elements.h"
#include "cli/expand_plan.h"
#include "curves/curve_arrange.h"

typedef struct tz_expand_curves_job {
    const tz_expand_params *own;
    const char *output, *map_output, *maps;
    const tz_curve_input_params *input;
    const tz_lines_params *lines;
    const tz_guide_params *guides;
    const tz_curve_arrange_params *curves;
    const tz_curve_render_params *look;
    const tz_compose_params *compose;
    const tz_format_params *format;
    const tz_ebpt_params *analyze; /**< of the ground */
    tz_arrange_params *arrange; /**< size, seed, tile; seed: that of what is being made */
    double grow;
} tz_expand_curves_job;

/** @param found   what tz_expand_decide has found, which is taken over; NULL = read
 *    now
 *  @param record  its inputs, taken over; NULL with `found` */
tz_status tz_expand_curves(tz_cli *cli, const tz_expand_curves_job *job,
                           tz_curve_exemplar *found, tz_record *record);

#endif
