/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Images of a layout of elements: colour, other maps of its photo, and pictures of what
 * lies where. Shared by expand and render. */
#ifndef TZ_CLI_ELEMENT_MATERIAL_H
#define TZ_CLI_ELEMENT_MATERIAL_H

#include "cli/element_photos.h"
#include "cli/material.h"
#include "synthesis/element_compose.h"

/** A layout and the pixels that it is made from. */
typedef struct tz_element_material {
    tz_element_set
        *layout; /**< borrowed; its background is drawn unless it is a ground */
    tz_element_photos photos;
    tz_layout ground;       /**< beneath; no placements = none */
    tz_image *ground_photo; /**< ground.source.n of them */
    tz_path_list inputs;    /**< files that were read */
} tz_element_material;

/** Reads what a layout from `document` refers to: its ground, photos and plates. The
 * layout keeps no background where that is a ground. */
tz_status tz_element_material_read(tz_cli *cli, const char *document,
                                   tz_element_set *layout, tz_record *record,
                                   tz_element_material *m);
void tz_element_material_free(tz_cli *cli, tz_element_material *m);
/** What lies beneath in another map: the ground's source i is the plate of photo i.
 * @param maps      one a photo
 * @param[out] out  ground.source.n images, the caller's to free */
tz_status tz_element_material_plates(tz_cli *cli, const tz_element_material *m,
                                     const tz_image *maps, tz_image **out);

/** Maps to render and pictures to make of a layout. In --maps, id, class, angle and uv name
 * the file that such a picture is written to; others are maps of the photo. */
typedef struct tz_element_maps {
    tz_map_list map;
    TZ_ARRAY(int32_t)
    what; /**< per map: tz_element_map, or -1 = of the photo */
} tz_element_maps;

/** @param photos  of the layout */
tz_status tz_element_maps_parse(tz_cli *cli, const char *text, int32_t photos,
                                tz_element_maps *out);
void tz_element_maps_free(tz_ctx *ctx, tz_element_maps *m);
/** As tz_pictures_plan; pictures of what lies where go where --maps says. */
tz_status tz_element_pictures_plan(tz_cli *cli, const char *output,
                                   const char *map_output, const tz_element_maps *maps,
                                   tz_name_values v, tz_picture_list *pictures);

typedef struct tz_element_job {
    const tz_element_material *material;
    const tz_element_maps *maps;
    const tz_compose_params *compose;
    const tz_element_render_params *render;
    const tz_format_params *format;
    const tz_record *record;
} tz_element_job;

/** Renders the pictures first .. end-1. */
tz_status tz_element_pictures_render(tz_cli *cli, const tz_element_job *job,
                                     const tz_picture_list *pictures, int32_t first,
                                     int32_t end);

#endif
