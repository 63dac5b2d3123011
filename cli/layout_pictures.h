/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Steps that are the same for layouts of elements and of curves: which maps and pictures are
 * wanted, where they go, and the document of a layout. Shared by expand and render. */
#ifndef TZ_CLI_LAYOUT_PICTURES_H
#define TZ_CLI_LAYOUT_PICTURES_H

#include "cli/element_material.h"

/** Reads --maps: some names are of pictures of what lies where, each given once; others are
 * maps of the layout's photos, given once a photo.
 * @param names     of such pictures, n of them; out->what holds which
 * @param[out] out  zeroed; free it also after an error */
tz_status tz_layout_maps_parse(tz_cli *cli, const char *text, int32_t photos,
                               const char *const *names, int32_t n, tz_element_maps *out);
/** The files that maps are read from. */
tz_status tz_layout_maps_paths(tz_cli *cli, const tz_element_maps *maps,
                               tz_path_list *inputs);
/** Sides of the image of a domain, px. */
void tz_layout_pixels(const tz_domain *d, double scale, int32_t size[2]);

/** What render makes of a layout. */
typedef struct tz_layout_wish {
    const char *output, *map_output;
    const tz_compose_params *compose;
    const tz_format_params *format;
    const tz_domain *domain;
    double scale; /**< px a user unit */
} tz_layout_wish;
/** Names and checks every output of render before the work begins.
 * @param[in,out] inputs  of the layout; files of maps are added */
tz_status tz_layout_pictures_plan(tz_cli *cli, const tz_layout_wish *w,
                                  const tz_element_maps *maps, tz_path_list *inputs,
                                  tz_picture_list *pictures);

/** A layout's document.
 * @param ground    what lies beneath; without placements the set's own background does
 * @param elements  the set, or that of the curves; as it was, when done
 * @param recipe    of the set that is written
 * @param write     writes `set` to `path` */
tz_status tz_layout_document(tz_cli *cli, const char *path, const tz_record *record,
                             const tz_layout *ground, tz_element_set *elements,
                             char **recipe, const void *set,
                             tz_status (*write)(tz_ctx *ctx, const char *path,
                                                const void *set));
/** Tells that a document of that size has been written. */
void tz_layout_tell(tz_cli *cli, const char *path, const char *what, const tz_domain *d);

#endif
