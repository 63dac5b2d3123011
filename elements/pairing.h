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

#define TZ_PAIRING_MOST 48                    /**< neighbours of a neighbourhood */
#define TZ_PAIRING_ROOM (TZ_PAIRING_MOST + 8) /**< columns of storage */

/** Neighbourhood as columns: all coordinates are lengths and count alike. Fill the first
 * n of each, then call tz_pairing_sort. */
typedef struct tz_pairing_side {
    int32_t n;
    int32_t runs; /**< how many labels there are; set by tz_pairing_sort */
    float x[TZ_PAIRING_ROOM], y[TZ_PAIRING_ROOM]; /**< offsets from the centre */
    float a[TZ_PAIRING_ROOM], b[TZ_PAIRING_ROOM]; /**< attributes: size as a vector that
                                                       points along the axis */
    float l[TZ_PAIRING_ROOM];                     /**< label: any number */
    uint8_t first[TZ_PAIRING_MOST + 1]; /**< runs + 1: where each label begins; set by
                                             tz_pairing_sort */
} tz_pairing_side;

/** Scratch memory of a worker. */
typedef struct tz_pairing {
    bool attributes;             /**< a and b matter */
    float limit;                 /**< squared distance that an unpaired neighbour costs */
    const float *weight;         /**< of the wanted side's neighbours; NULL = all 1 */
    int32_t to[TZ_PAIRING_MOST]; /**< result: partner in the other side, or -1 */
    float cost[TZ_PAIRING_MOST][TZ_PAIRING_ROOM];
} tz_pairing;

/** Brings columns into the order of their labels, those of one label stay in theirs.
 * @param[out] order  NULL, or n: where each column was before  @cost O(n) if they are in
 *   order, else O(n^2) at worst */
TZ_API void tz_pairing_sort(tz_pairing_side *s, int32_t *order);

/** Pairs each of p's neighbours with one of q's of its label or with none. Both are
 * sorted.
 * @param enough  gives up as soon as the cost is known to reach this
 * @return the least cost, with w->to filled; INFINITY if it is `enough` or more, with
 *   w->to undefined
 * @cost for each label O(n m) where nearest neighbours do not compete, else up to
 *   O(n^2 m) */
TZ_API float tz_pairing_best(tz_pairing *w, const tz_pairing_side *p,
                             const tz_pairing_side *q, float enough);

#endif
