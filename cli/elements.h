/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Element textures in commands: which medium an input is of, its elements, and what
 * guides an arrangement. Shared by analyze, arrange, render, expand and compare. */
#ifndef TZ_CLI_ELEMENTS_H
#define TZ_CLI_ELEMENTS_H

#include "cli/names.h"
#include "cli/record.h"
#include "elements/element_arrange.h"
#include "elements/palette.h"

/** What a picture is taken as. Usual: curves of curve documents, elements of other
 * drawings, edges of photos; auto: by what is in the photo, where a command can tell, else
 * as usual. */
typedef enum tz_as {
    TZ_AS_USUAL,
    TZ_AS_AUTO,
    TZ_AS_EDGES,
    TZ_AS_ELEMENTS,
    TZ_AS_CURVES
} tz_as;

/** Table: tz_medium_param_table. */
typedef struct tz_medium_params {
    int32_t as; /**< tz_as */
    bool wrap;
} tz_medium_params;
extern const tz_param_table tz_medium_param_table;

/** Table: tz_guide_param_table. */
typedef struct tz_guide_params {
    char domain[TZ_PARAM_STRING_SIZE], field[TZ_PARAM_STRING_SIZE],
        directions[TZ_PARAM_STRING_SIZE], sizes[TZ_PARAM_STRING_SIZE],
        densities[TZ_PARAM_STRING_SIZE], zones[TZ_PARAM_STRING_SIZE],
        zone_kinds[TZ_PARAM_STRING_SIZE], textures[TZ_PARAM_STRING_SIZE],
        brush[TZ_PARAM_STRING_SIZE];
    double brush_radius;
} tz_guide_params;
extern const tz_param_table tz_guide_param_table;

/** What an SVG document is by its root's tz:document: "elements", "edge-groups",
 * "layout", "curves"; "" = somebody's drawing. The first 16 KiB are looked at. */
tz_status tz_document_kind(tz_cli *cli, const char *path, char kind[32]);
/** What a command takes its first operand as. Photos are edges where nothing is said.
 * @return TZ_OK; TZ_INVALID where `as` contradicts the document */
tz_status tz_medium_settle(tz_cli *cli, const char *path, const tz_medium_params *p,
                           tz_as *as);

/** Reads elements out of a drawing or an element document, and records it.
 * @param classes         wanted ones where the document names none; 0 = automatic
 * @param[in,out] record  NULL, or what inputs are added to */
tz_status tz_elements_read(tz_cli *cli, const char *path, const tz_medium_params *p,
                           int32_t classes, tz_record *record, tz_element_set *set);

/** Guides of one domain. */
typedef struct tz_guides {
    tz_region *region;
    tz_frames *frames;
    tz_zones *zones;
    tz_palette palette;
    tz_paint paint;
    tz_ctx *ctx;
} tz_guides;

/** Reads the guides that are given into `guides` and sets them in `d`, whose size and
 * torus are known. @param kinds  set whose kinds zones name */
tz_status tz_guides_read(tz_cli *cli, const tz_guide_params *p,
                         const tz_element_set *kinds, tz_record *record, tz_domain *d,
                         tz_guides *guides);
/** Frames of --field, --directions, --sizes and --densities; NULL where none is given. */
tz_status tz_guides_frames(tz_cli *cli, const tz_guide_params *p, tz_record *record,
                           tz_vec3 size, bool torus, tz_frames **out);
/** For curves, whose patches turn but keep their size: warns where frames say more than
 * directions, and leaves that out.
 * @return TZ_OK; TZ_INVALID where they say no directions */
tz_status tz_guides_only_turn(tz_cli *cli, tz_guides *g);
/** Every guide that is a file, as inputs that must not be overwritten. */
tz_status tz_guides_paths(tz_cli *cli, const tz_guide_params *p, tz_path_list *inputs);
void tz_guides_free(tz_guides *g);
/** Sets the job's textures and strokes. */
void tz_guides_apply(const tz_guides *g, tz_element_arrange_job *job);

#endif
