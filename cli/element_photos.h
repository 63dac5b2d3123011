/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Pixels of the photos that a set of elements is cut from, and their plates. */
#ifndef TZ_CLI_ELEMENT_PHOTOS_H
#define TZ_CLI_ELEMENT_PHOTOS_H

#include "cli/record.h"
#include "elements/element.h"
#include "synthesis/expand.h"

typedef struct tz_element_photos {
    tz_image *photo, *plate; /**< n; a plate may be empty (px = NULL) */
    int32_t n;
} tz_element_photos;

/** Reads one picture that a document refers to, records it and adds it to the inputs.
 * @param sha256  that it should have, "" = unknown: another one is warned about
 * @return TZ_OK; TZ_INVALID (not in proportion to width x height) */
tz_status tz_picture_read(tz_cli *cli, const char *path, const char *sha256,
                          int32_t width, int32_t height, tz_record *record,
                          tz_path_list *inputs, tz_image *out);
/** Reads what set.photo names. @param[out] p  zeroed before; free it also after an error */
tz_status tz_element_photos_read(tz_cli *cli, const tz_element_set *set,
                                 tz_record *record, tz_path_list *inputs,
                                 tz_element_photos *p);
/** Room for n photos, all empty. */
tz_status tz_element_photos_init(tz_cli *cli, int32_t n, tz_element_photos *p);
/** Brings these and `more` images to one channel count. */
tz_status tz_element_photos_match(tz_cli *cli, tz_element_photos *p, tz_image *more,
                                  int32_t n);
void tz_element_photos_free(tz_cli *cli, tz_element_photos *p);

#endif
