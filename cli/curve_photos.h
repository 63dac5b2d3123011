/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Curves found in a photo, with the photo's pixels and its plate: an exemplar of curves.
 * Shared by analyze, arrange and expand. */
#ifndef TZ_CLI_CURVE_PHOTOS_H
#define TZ_CLI_CURVE_PHOTOS_H

#include "analysis/lines.h"
#include "cli/curves.h"
#include "synthesis/expand.h"

typedef struct tz_curve_exemplar {
    tz_curve_set set;       /**< set.element.photo[0] is the photo */
    tz_image photo, plate;  /**< plate: empty where there are no lines */
    tz_path_list inputs;    /**< files that were read */
    tz_lines_verdict found; /**< what the lines are */
    char *plate_path;       /**< file that the plate goes to, NULL = none */
} tz_curve_exemplar;

/** Finds the lines of a photo.
 * @param record   NULL, or what the photo is added to
 * @param[out] e   zeroed before; free it also after an error. No lines are no error: see
 *                 e->found.is_lines and e->set.path.n */
tz_status tz_curve_exemplar_find(tz_cli *cli, const char *path, const tz_lines_params *p,
                                 tz_record *record, tz_curve_exemplar *e);
/** Names the file of the plate, NAME.plate.png beside a document that will refer to it;
 * adds it to `outputs`. Does nothing where there is no plate, or no SVG. */
tz_status tz_curve_exemplar_name_plate(tz_cli *cli, const char *document,
                                       tz_path_list *outputs, tz_curve_exemplar *e);
/** Writes the plate where it was named, and names it in the set. */
tz_status tz_curve_exemplar_write_plate(tz_cli *cli, tz_curve_exemplar *e);
void tz_curve_exemplar_free(tz_cli *cli, tz_curve_exemplar *e);

/** `analyze PHOTO --as curves`: the whole command. */
tz_status tz_analyze_curves(tz_cli *cli, const char *path, const char *output,
                            const tz_lines_params *p);

#endif
