/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What --as auto takes a photo for. */
#ifndef TZ_CLI_EXPAND_DECIDE_H
#define TZ_CLI_EXPAND_DECIDE_H

#include "cli/curve_photos.h"
#include "cli/element_exemplar.h"

/** What was found on the way is kept, each with the record of its inputs. */
typedef struct tz_expand_decision {
    tz_as as; /**< edges, elements or curves */
    tz_curve_exemplar lines;
    tz_element_exemplar things;
    tz_record line_record, thing_record;
} tz_expand_decision;

/** Decides by what is in the only photo (several photos mix as edges), and says why among
 * the figures.
 * @param model   of edges
 * @param[out] d  zeroed before; free it also after an error
 * @cost of tz_lines_find and tz_things_judge: O(pixels) */
tz_status tz_expand_decide(tz_cli *cli, const tz_lines_params *lines,
                           const tz_things_params *things, const char *model,
                           tz_expand_decision *d);
void tz_expand_decision_free(tz_cli *cli, tz_expand_decision *d); /**< takes zeroed */

#endif
