/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Images of a layout: the colour picture and the other maps of a material, all with the
 * same layout and seams. Shared by expand and render. */
#ifndef TZ_CLI_MATERIAL_H
#define TZ_CLI_MATERIAL_H

#include "cli/command.h"
#include "cli/names.h"
#include "cli/record.h"
#include "synthesis/expand.h"

/** Table: tz_output_param_table. */
typedef struct tz_output_params {
    char output[TZ_PARAM_STRING_SIZE];
} tz_output_params;
extern const tz_param_table tz_output_param_table;

/** Table: tz_map_output_param_table. */
typedef struct tz_map_output_params {
    char map_output[TZ_PARAM_STRING_SIZE];
} tz_map_output_params;
extern const tz_param_table tz_map_output_param_table;

/** Table: tz_maps_param_table. */
typedef struct tz_maps_params {
    char maps[TZ_PARAM_STRING_SIZE];
} tz_maps_params;
extern const tz_param_table tz_maps_param_table;

/** A map of the material: one file a photo. */
typedef struct tz_map {
    char name[64];
    tz_map_kind kind;
    tz_path_list path;
} tz_map;

typedef TZ_ARRAY(tz_map)
tz_map_list;

/** "normal=a_n.exr,height=a_h.exr"; with several photos each name comes once a photo, in
 * their order. Kinds come from the names.
 * @param photos  how often each must come; < 0 = the caller checks
 * @return TZ_OK; TZ_INVALID; TZ_NOMEM */
tz_status tz_maps_parse(tz_ctx *ctx, const char *text, int32_t photos, tz_map_list *out);
void tz_maps_free(tz_ctx *ctx, tz_map_list *l);
/** Files of one map into images, zeroed before; recorded in `extra`, brought to one
 * channel count. */
tz_status tz_map_load(tz_cli *cli, const tz_map *map, tz_image *images, tz_record *extra);
/** Reads the k-th photo's maps once, before the work: they must have the photo's size or
 * be in proportion to it.
 * @return TZ_OK; TZ_INVALID naming both sizes; what tz_image_read returns */
tz_status tz_maps_check(tz_cli *cli, const tz_map_list *l, int32_t k,
                        const char *photo_path, const tz_image *photo);

/** An image to make. */
typedef struct tz_picture {
    char *path;
    int32_t map; /**< index into the maps, -1 = colour */
} tz_picture;

typedef TZ_ARRAY(tz_picture)
tz_picture_list;

/** Names of the images of one layout, from -o and --map-output; appended to `pictures`.
 * @param v  name (of the photo), seed, width, height; ext as of the photo */
tz_status tz_pictures_plan(tz_cli *cli, const char *output, const char *map_output,
                           const tz_map_list *maps, tz_name_values v,
                           tz_picture_list *pictures);
/** Settles every picture's format once, before the work, so that a wrong name shows
 * early. */
tz_status tz_pictures_check(tz_cli *cli, const tz_picture_list *l,
                            const tz_format_params *format);
void tz_pictures_free(tz_ctx *ctx, tz_picture_list *l);

/** What all images of a layout are made from. */
typedef struct tz_material {
    const tz_layout *layout;
    const tz_image *photos; /**< one a layout source, same channel count */
    int32_t n;
    const tz_map_list *maps;
    const tz_compose_params *compose;
    const tz_format_params *format;
    const tz_record *record;
} tz_material;

/** Renders the pictures first .. end-1. */
tz_status tz_pictures_render(tz_cli *cli, const tz_material *m,
                             const tz_picture_list *pictures, int32_t first, int32_t end);

#endif
