/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Neighbourhoods of samples and how well two of them fit. An edge group is an element with
 * one sample at its centre and one at each place where an edge leaves its border. */
#ifndef TZ_ELEMENTS_NEIGHBOURHOOD_H
#define TZ_ELEMENTS_NEIGHBOURHOOD_H

#include "base/geom.h"

/** Neighbour as seen from a centre. */
typedef struct tz_neighbour {
    tz_vec3 offset; /**< from the centre, units of the exemplar */
    double angle;   /**< axis of the thing, [0, pi); NAN = has none */
    double size;    /**< radius of the thing */
    int32_t kind; /**< things of unlike kind do not pair (centres, edge ends, classes) */
} tz_neighbour;

/** What a mismatch costs. */
typedef struct tz_neighbour_weights {
    double angle;   /**< per squared sine of the angle between axes, times size^2 */
    double size;    /**< per squared difference of sizes */
    double missing; /**< an unpaired neighbour, times the squared distance limit */
    double limit;   /**< pairs farther apart than this stay unpaired */
} tz_neighbour_weights;

/** Cost of seeing neighbourhood b where a is wanted: each of a's neighbours is paired with
 * a free one of b's, nearest pairs first; mean over a.
 * @param a, b  na, nb <= TZ_NEIGHBOURS_MAX neighbours
 * @return 0 for equal neighbourhoods; 0 if na = 0
 * @cost O(na nb) @source [Ma11] Eq. (1) with greedy pairing; [Dav19]: distant pairs are
 *   partial */
#define TZ_NEIGHBOURS_MAX 32
TZ_API double tz_neighbourhood_cost(const tz_neighbour *a, int32_t na,
                                    const tz_neighbour *b, int32_t nb,
                                    const tz_neighbour_weights *w);

#endif
