/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The best pairing of two neighbourhoods: least sum of squared distances, each neighbour
 * used once, unlike ones never paired, distant ones left alone.
 * @source [Ma11] Eq. (1). Deviates: the paper pairs greedily; this is the exact optimum,
 *   which costs no more where nearest neighbours do not compete (the common case). */
#ifndef TZ_ELEMENTS_PAIRING_H
#define TZ_ELEMENTS_PAIRING_H

#include <stdbool.h>
#include <stdint.h>

#include "base/export.h"

#define TZ_PAIRING_MOST 48 /**< neighbours of a neighbourhood */

/** Neighbourhood as columns: all coordinates are lengths and count alike. */
typedef struct tz_pairing_side {
    int32_t n;
    float x[TZ_PAIRING_MOST], y[TZ_PAIRING_MOST]; /**< offsets from the centre */
    float a[TZ_PAIRING_MOST], b[TZ_PAIRING_MOST]; /**< attributes: size as a vector that
                                                       points along the axis */
    float l[TZ_PAIRING_MOST]; /**< label: unlike ones are very far apart */
} tz_pairing_side;

/** Scratch memory of a worker. */
typedef struct tz_pairing {
    bool attributes;             /**< a and b matter */
    bool labels;                 /**< there is more than one label */
    float limit;                 /**< squared distance that an unpaired neighbour costs */
    const float *weight;         /**< of the wanted side's neighbours; NULL = all 1 */
    int32_t to[TZ_PAIRING_MOST]; /**< result: partner in the other side, or -1 */
    float cost[TZ_PAIRING_MOST][TZ_PAIRING_MOST];
} tz_pairing;

/** Distance between labels: their square is beyond any limit. `spacing` is the scale. */
#define TZ_PAIRING_LABEL(spacing) (1000 * (spacing))

/** Pairs each of p's neighbours with one of q's or with none.
 * @param enough  gives up as soon as the cost is known to reach this
 * @return the least cost, with w->to filled; INFINITY if it is `enough` or more, with
 *   w->to undefined
 * @cost O(n m) where nearest neighbours do not compete, else up to O(n^2 m) */
TZ_API float tz_pairing_best(tz_pairing *w, const tz_pairing_side *p,
                             const tz_pairing_side *q, float enough);

#endif
