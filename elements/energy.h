/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Energy solver for element textures: search for the exemplar's neighbourhoods, then one
 * least-squares assignment of all positions, in turns.
 * @source [Ma11] Sec. 3 to 5: metric Eq. (1), energy Eq. (2), assignment Eq. (3), (4),
 * attributes Eq. (5), domain shape Eq. (6), local orientation Eq. (7) */
#ifndef TZ_ELEMENTS_ENERGY_H
#define TZ_ELEMENTS_ENERGY_H

#include "base/param.h"
#include "elements/bend.h"

typedef enum tz_energy_start {
    TZ_ENERGY_PATCHES, /**< random patches of the exemplar side by side */
    TZ_ENERGY_NOISE,   /**< random elements at random places */
    TZ_ENERGY_GIVEN    /**< what the output holds */
} tz_energy_start;

/** Table: tz_energy_param_table. */
typedef struct tz_energy_params {
    uint64_t seed;
    int32_t start; /**< tz_energy_start */
    int32_t iterations;
    double radius; /**< of neighbourhoods, user units; 0 = from the exemplar's spacing */
    double patch;  /**< side of the patches, user units; 0 = two radii */
    int32_t tries; /**< patches tried for each place; 1 = any, as in the paper */
    int32_t coherent; /**< k of the k-coherence search */
    double attribute; /**< weight of orientation and size against position, Eq. (1) */
    double border; /**< how much exemplar neighbourhoods near its border are favoured near
                           the domain's, 0..1 */
    int32_t shape; /**< tz_shape: what becomes of elements of several samples */
    bool existence; /**< adds what matches miss and removes what none of them sees, until
                         half of the iterations are done; false, as in the paper: never */
} tz_energy_params;
TZ_API extern const tz_param_table tz_energy_param_table;

/** What the caller may add; NULL members do nothing. `inside` and `frame` are called from
 * several threads at once. */
typedef struct tz_energy_hook {
    /** Called after each iteration; may move elements that are not fixed (physics) and
     * their samples, but not add or remove any. */
    tz_status (*after)(void *user, tz_element_set *output, int32_t iteration,
                       double energy);
    /** Share of the place that lies inside the wanted shape, 0..1, Eq. (6). NULL = the
     * domain's rectangle and region. */
    double (*inside)(void *user, tz_vec3 at);
    /** Angle of the local frame, radians, Eq. (7). NULL = the domain's frames. */
    double (*frame)(void *user, tz_vec3 at);
    void *user;
} tz_energy_hook;

/** Synthesises. Depth (z) is carried along; matching is in the plane.
 * @param output  its domain is filled: fixed elements stay, others are replaced
 *                (TZ_ENERGY_GIVEN: are moved; a layout that region growing made is a good
 *                start). Classes are the exemplar's; an output without any takes them
 *                over. Elements of one sample may change symbol, source, angle and size
 *                within their class; those of several follow their samples, see
 *                elements/bend.h. Where the domain has a region, elements are kept in it;
 *                where it has frames, arrangements turn with them; where it has zones,
 *                elements whose kind may not lie there are replaced by ones that may, and
 *                none moves out of its zone
 * @param hook    NULL = none
 * @param[out] energy  NULL, or iterations + 1 values of Eq. (2) with the term of Eq. (6),
 *                before and after each
 * @return TZ_OK; TZ_INVALID; TZ_NOMEM; TZ_CANCELLED; on all but TZ_INVALID the output is
 *   whole, as the last finished step left it
 * @cost an iteration O(elements * neighbours^2) */
TZ_API tz_status tz_energy_solve(tz_ctx *ctx, const tz_element_set *exemplar,
                                 const tz_energy_params *params, tz_element_set *output,
                                 const tz_energy_hook *hook, double *energy);

#endif
