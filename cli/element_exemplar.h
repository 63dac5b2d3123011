/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * An exemplar of elements with its pixels: from a drawing, an element document or a photo;
 * and the ground that its layouts stand on. Shared by analyze, arrange and expand. */
#ifndef TZ_CLI_ELEMENT_EXEMPLAR_H
#define TZ_CLI_ELEMENT_EXEMPLAR_H

#include "analysis/things.h"
#include "cli/element_photos.h"
#include "cli/elements.h"
#include "synthesis/arrange.h"

typedef struct tz_element_exemplar {
    tz_element_set set;
    tz_element_photos photos;
    tz_path_list inputs; /**< files that were read */
    bool found;          /**< in a photo just now: its plate is in no file yet */
    char *plate;         /**< file that the plate goes to, NULL = none */
} tz_element_exemplar;

/** Reads an exemplar; finds the things of a photo.
 * @param things  for photos; its classes also for drawings
 * @param model   of the edge forest, "" = Terrazzo's own */
tz_status tz_element_exemplar_read(tz_cli *cli, const char *path,
                                   const tz_medium_params *medium,
                                   const tz_things_params *things, const char *model,
                                   tz_record *record, tz_element_exemplar *e);
/** Finds the things of a photo and whether it is made of them.
 * @param[out] verdict  see tz_things_judge */
tz_status tz_element_exemplar_judge(tz_cli *cli, const char *path,
                                    const tz_things_params *things, const char *model,
                                    tz_record *record, tz_element_exemplar *e,
                                    tz_things_verdict *verdict);
/** Names the file of the plate, beside a document that will refer to it; adds it to
 * `outputs`. Does nothing where there is no plate to be written. */
tz_status tz_element_exemplar_name_plate(tz_cli *cli, const char *document,
                                         tz_path_list *outputs, tz_element_exemplar *e);
/** Writes the plate where it was named. */
tz_status tz_element_exemplar_write_plate(tz_cli *cli, tz_element_exemplar *e);
/** The plate arranged over a domain; no placements where there is no plate.
 * @param[out] ground  zeroed; filled */
tz_status tz_element_exemplar_ground(tz_cli *cli, const tz_element_exemplar *e,
                                     const tz_ebpt_params *analyze,
                                     const tz_domain *domain, uint64_t seed,
                                     tz_layout *ground);
void tz_element_exemplar_free(tz_cli *cli, tz_element_exemplar *e);

/** Domain of a layout: --size where it is given, else the exemplar's times `grow`; of
 * whole px where it is cut from a photo. */
tz_domain tz_element_domain(const tz_cli *cli, const tz_element_set *exemplar,
                            const tz_arrange_params *arrange, double grow);

#endif
