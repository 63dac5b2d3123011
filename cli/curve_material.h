/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Images of a layout of curves: colour, other maps of its photo, and pictures of which line
 * is nearest. Shared by expand and render. */
#ifndef TZ_CLI_CURVE_MATERIAL_H
#define TZ_CLI_CURVE_MATERIAL_H

#include "cli/element_material.h"
#include "synthesis/curve_render.h"

/** Maps to render and pictures to make of a layout of curves: in --maps, id, distance and
 * along name the file that such a picture is written to; others are maps of the photo. */
tz_status tz_curve_maps_parse(tz_cli *cli, const char *text, int32_t photos,
                              tz_element_maps *out);

typedef struct tz_curve_pictures_job {
    const tz_curve_set *layout;
    const tz_element_material *material; /**< of layout->element */
    const tz_element_maps *maps;         /**< of tz_curve_maps_parse */
    const tz_compose_params *compose;
    const tz_curve_render_params *render;
    const tz_format_params *format;
    const tz_record *record;
} tz_curve_pictures_job;

/** Renders the pictures first .. end-1. */
tz_status tz_curve_pictures_render(tz_cli *cli, const tz_curve_pictures_job *job,
                                   const tz_picture_list *pictures, int32_t first,
                                   int32_t end);

#endif
