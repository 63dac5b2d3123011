/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The element half of expand: photo or drawing to pixels by way of its elements. */
#ifndef TZ_CLI_EXPAND_ELEMENTS_H
#define TZ_CLI_EXPAND_ELEMENTS_H

#include "analysis/things.h"
#include "cli/element_exemplar.h"
#include "cli/expand_plan.h"
#include "synthesis/element_compose.h"

typedef struct tz_expand_elements_job {
    const tz_expand_params *own;
    const char *output, *map_output, *maps;
    const tz_medium_params *medium;
    const tz_things_params *things;
    const tz_guide_params *guides;
    const tz_element_arrange_params *elements;
    const tz_element_render_params *look;
    const tz_compose_params *compose;
    const tz_format_params *format;
    const tz_ebpt_params *analyze;
    tz_arrange_params *arrange; /**< size, seed, tile; seed: that of what is being made */
    double grow;
} tz_expand_elements_job;

/** @param found   what tz_expand_decide has found, which is taken over; NULL = read now
 *  @param record  its inputs, taken over; NULL with `found` */
tz_status tz_expand_elements(tz_cli *cli, const tz_expand_elements_job *job,
                             tz_element_exemplar *found, tz_record *record);

#endif
