/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Spacing: how near to each other an exemplar lets its elements come, by pair of classes,
 * and a step that pushes the elements of a layout as far apart. The energy of [Ma11] has
 * no term against overlaps; as a solver step after each of its iterations this one keeps
 * them out.
 * @source the step: Mueller et al., Position based dynamics, 2007, with distance
 *   constraints as inequalities; [Ma11] Sec. 5 (extra solver steps) */
#ifndef TZ_ELEMENTS_SPACING_H
#define TZ_ELEMENTS_SPACING_H

#include "elements/extent.h"

typedef struct tz_spacing {
    int32_t kinds; /**< told apart: those of the exemplar, 1 where there are over 128 */
    float *least;  /**< kinds * kinds: share of the distance at which two touch that keeps
                        them apart, see elements/extent.h */
    float most;    /**< the largest of them */
    tz_extents extents; /**< of the exemplar's symbols, which layouts share */
    tz_ctx *ctx;
} tz_spacing;

/** Measures an exemplar: of each pair of classes the distance, over the one at which two
 * touch, that one in fifty nearest pairs undercuts; a class pair that is never side by side takes the
 * value over all pairs. Voids keep no distance. Of a layout's elements those that have
 * symbols of the exemplar are known; the others are discs.
 * @return TZ_OK; TZ_NOMEM @cost O(n) */
TZ_API tz_status tz_spacing_init(tz_ctx *ctx, const tz_element_set *exemplar,
                                 tz_spacing *s);
TZ_API void tz_spacing_deinit(tz_spacing *s); /**< takes zeroed */
/** Pushes apart what is too near: in each round every element moves by half of what it
 * lacks to each neighbour, all at once; fixed ones stay. Elements stay in the domain.
 * @return TZ_OK; TZ_NOMEM (some rounds may have been done); TZ_CANCELLED
 * @cost O(rounds * n) */
TZ_API tz_status tz_spacing_relax(const tz_spacing *s, tz_element_set *layout,
                                  int32_t rounds);

#endif
