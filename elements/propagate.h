/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Editing by example: what an artist changed at a few elements is done to all that stand
 * in a like neighbourhood.
 * @source [Ma11] Sec. 6.3, Fig. 16: the metric of Eq. (1) tells who is alike */
#ifndef TZ_ELEMENTS_PROPAGATE_H
#define TZ_ELEMENTS_PROPAGATE_H

#include "base/param.h"
#include "elements/element.h"

/** Table: tz_propagate_param_table. */
typedef struct tz_propagate_params {
    double alike; /**< largest difference of neighbourhoods, in spacings (root mean square
                        over neighbours); 0 = where the differences have their widest gap,
                        else 0.2: below one neighbour in twelve missing */
    double radius; /**< of neighbourhoods, user units; 0 = about two rings */
    bool turned;   /**< neighbourhoods that are alike when turned count too; the change is
                        turned along */
} tz_propagate_params;
TZ_API extern const tz_param_table tz_propagate_param_table;

/** What happened. */
typedef struct tz_propagate_report {
    int32_t examples; /**< elements that the artist changed, added or removed */
    int32_t followed; /**< elements that were changed, added or removed after them */
    double alike;     /**< the limit that was used, largest of all examples */
} tz_propagate_report;

/** Carries the changes from `before` to `after` over to all alike elements.
 *
 * Elements that stand in both with the same class, symbol, place, angle and scale are
 * unchanged. Of the others, those of the same number pair if they are near, then the
 * nearest: these are moved, turned, scaled, or another symbol now; what has no partner is
 * removed or added. An added element belongs to its nearest unchanged one. Changes are
 * seen from the element's neighbourhood: where that is turned, they are turned. If an
 * element is like several examples, moves, turns and scales are means, nearer ones more,
 * and the rest is as the most alike one has it. Fixed elements stay.
 * @param before, after  over the same domain; classes and symbols pair by name and id
 * @param params    NULL = defaults
 * @param[out] out  overwritten, not freed; zeroed on error; as `after` with all changes
 * @param report    NULL, or what happened
 * @return TZ_OK; TZ_INVALID (domains differ, or sets that are not whole); TZ_NOMEM;
 *   TZ_CANCELLED
 * @cost O(examples * elements * neighbours^2) */
TZ_API tz_status tz_element_propagate(tz_ctx *ctx, const tz_element_set *before,
                                      const tz_element_set *after,
                                      const tz_propagate_params *params,
                                      tz_element_set *out, tz_propagate_report *report);

#endif
