/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The element half of arrange: a drawing or element exemplar over a domain. */
#ifndef TZ_CLI_ARRANGE_ELEMENTS_H
#define TZ_CLI_ARRANGE_ELEMENTS_H

#include "cli/element_exemplar.h"
#include "cli/exemplars.h"

typedef struct tz_elements_job {
    const char *output, *keep;
    const tz_medium_params *medium;
    const tz_things_params *things;
    const tz_element_arrange_params *elements;
    const tz_guide_params *guides;
    const tz_arrange_params *arrange; /**< size, seed, tile */
    const tz_ebpt_params *analyze;    /**< of the ground */
    double grow;
} tz_elements_job;

/** Reads, arranges, writes .svg, .json or .csv. */
tz_status tz_arrange_elements(tz_cli *cli, const tz_elements_job *job);

#endif
