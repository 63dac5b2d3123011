/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * How like an exemplar a layout is: statistics of both, each difference over the one that
 * two halves of the exemplar have between them (1 = as like as its own halves; less =
 * more alike than they are, as larger sets vary less). */
#ifndef TZ_ELEMENTS_ELEMENT_COMPARE_H
#define TZ_ELEMENTS_ELEMENT_COMPARE_H

#include "elements/element.h"

typedef struct tz_element_likeness {
    double nearest;          /**< distances to the nearest neighbour: ratio */
    double correlation;      /**< pair correlation, all and by class: ratio */
    double neighbourhood[3]; /**< mean neighbourhood distance at 1, 2, 3 rings: ratio */
    double classes;          /**< class frequencies: ratio */
    double orientation; /**< histogram of angles: ratio; 1 where nothing is oriented */
    double mean;        /**< of all ratios */
    double density;     /**< of the layout over the exemplar's, both with regard to
                             their borders: elements/element_density.h */
    double overlaps[2]; /**< share of elements that overlap another (nearer than 0.8 of
                             where the two touch), exemplar, layout */
    double hole[2];     /**< radius of the widest disc inside the domain that touches no
                             element's outline (elements/extent.h), exemplar, layout */
    double distance[3]; /**< mean neighbourhood distance itself, [Dav19] Eq. (5) */
} tz_element_likeness;

/** Neighbourhoods are of 6, 18 and 36 neighbours, but no more than a quarter of the
 * exemplar, and measured from 256 elements of the layout to 512 of the exemplar; pairs
 * from 4,096. Elements that stand for empty room
 * count as a class, but neither in density nor as obstacles.
 * @param[out] out  untouched on error
 * @return TZ_OK; TZ_INVALID (too few elements to have statistics); TZ_NOMEM;
 *   TZ_CANCELLED
 * @cost O(n log n) */
TZ_API tz_status tz_element_compare(tz_ctx *ctx, const tz_element_set *exemplar,
                                    const tz_element_set *layout,
                                    tz_element_likeness *out);

#endif
