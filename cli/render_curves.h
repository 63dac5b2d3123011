/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The curve half of render: a layout (or an exemplar) of curves to pixels. */
#ifndef TZ_CLI_RENDER_CURVES_H
#define TZ_CLI_RENDER_CURVES_H

#include "cli/curve_material.h"

typedef struct tz_render_curves_job {
    const char *output, *map_output, *maps;
    const tz_compose_params *compose;
    const tz_curve_render_params *look;
    const tz_format_params *format;
} tz_render_curves_job;

tz_status tz_render_curves(tz_cli *cli, const tz_render_curves_job *job);

#endif
