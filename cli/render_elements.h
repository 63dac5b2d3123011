/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The element half of render: a layout (or any drawing) of elements to pixels. */
#ifndef TZ_CLI_RENDER_ELEMENTS_H
#define TZ_CLI_RENDER_ELEMENTS_H

#include "cli/material.h"
#include "synthesis/element_render.h"

typedef struct tz_render_elements_job {
    const char *output, *map_output, *maps;
    const tz_compose_params *compose;
    const tz_element_render_params *look;
    const tz_format_params *format;
} tz_render_elements_job;

tz_status tz_render_elements(tz_cli *cli, const tz_render_elements_job *job);

#endif
