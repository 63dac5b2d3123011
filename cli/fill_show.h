/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * How `fill` shows a field by its things: colours of a ramp, sizes by length of vectors. */
#ifndef TZ_CLI_FILL_SHOW_H
#define TZ_CLI_FILL_SHOW_H

#include "cli/command.h"
#include "elements/field.h"
#include "fields/ramp.h"
#include "fields/vectors.h"

typedef enum tz_show_by {
    TZ_SHOW_DIRECTION,
    TZ_SHOW_SIZE,
    TZ_SHOW_DENSITY,
    TZ_SHOW_LENGTH
} tz_show_by;

typedef struct tz_show_params {
    char ramp[TZ_PARAM_STRING_SIZE];
    int32_t by; /**< tz_show_by */
    double lengths[2];
} tz_show_params;
extern const tz_param_table tz_show_param_table;

typedef struct tz_show {
    tz_ramp ramp;       /**< n = 0: none */
    tz_vectors vectors; /**< length = NULL: none */
} tz_show;

/** Reads the ramp, and what it or sizes need of vectors; says these sizes in the field.
 * @param vectors  image of vectors as it was named; "" = there is none
 * @param[out] show  zeroed before
 * @return TZ_OK; TZ_INVALID; or of tz_vectors_read */
tz_status tz_show_read(tz_cli *cli, const tz_show_params *p, const char *vectors,
                       tz_element_field *field, tz_show *show);
/** Colours a layout. @return as tz_ramp_paint */
tz_status tz_show_paint(tz_cli *cli, const tz_show_params *p, const tz_show *show,
                        const tz_element_field *field, const tz_element_set *palette,
                        tz_element_set *layout);
void tz_show_deinit(tz_show *show); /**< takes zeroed */

#endif
