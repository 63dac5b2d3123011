/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Region growing of element textures.
 *
 * Radii of neighbourhoods and voids (empty room that is grown like an element and then
 * left out) are found automatically. An exemplar of fewer than five elements, or of
 * elements in one row, is read as a tile that repeats with its domain.
 * @source [Dav19] Sec. 4 and 5 but 5.7 and 5.8. Deviates: an element of several samples
 * is compared by its centre, axis and size; other deviations stand where they are made */
#ifndef TZ_ELEMENTS_GROWTH_H
#define TZ_ELEMENTS_GROWTH_H

#include "base/param.h"
#include "elements/element.h"

typedef enum tz_growth_optimise {
    TZ_GROWTH_NONE,
    TZ_GROWTH_LOCAL, /**< around what a round has placed */
    TZ_GROWTH_GLOBAL /**< everything, each round */
} tz_growth_optimise;

/** Table: tz_growth_param_table. */
typedef struct tz_growth_params {
    uint64_t seed;
    int32_t rings;    /**< neighbourhood: 1..3 rings of neighbours */
    int32_t coherent; /**< k of the k-coherent caches */
    int32_t optimise; /**< tz_growth_optimise */
    double overlap;   /**< two elements collide when nearer than this share of the sum of
                           their radii; only for classes (kind and size) that the exemplar
                           never shows side by side, else its own nearest pairs decide */
    double ratio;     /**< c, candidate ratio test, [Dav19] Sec. 5 */
    double balance;   /**< 0..1: how hard class frequencies follow the exemplar's */
    int32_t most;     /**< elements placed at most, 0 = as many as fit */
} tz_growth_params;
TZ_API extern const tz_param_table tz_growth_param_table;

typedef struct tz_growth tz_growth;

/** Prepares an exemplar: neighbourhoods, radii, k-coherent caches, free-space points.
 * @param exemplar  kept by reference, unchanged while the growth lives
 * @param output    empty, or with elements to grow from or around (fixed ones stay); its
 *                  domain is what gets filled; kept by reference
 * @return TZ_OK; TZ_INVALID (an exemplar of no elements, a domain of no area); TZ_LIMIT
 *   (over 65,536 elements in the exemplar); TZ_NOMEM
 * @cost O(n log n) in the exemplar */
TZ_API tz_status tz_growth_begin(tz_ctx *ctx, const tz_element_set *exemplar,
                                 const tz_growth_params *params, tz_element_set *output,
                                 tz_growth **growth);
/** Grows by about `budget` elements. The output is whole and may be read between steps.
 * How the work is cut into steps does not change the output. Serial.
 * @param budget     at least 1
 * @param[out] more  false when all is done
 * @return TZ_OK; TZ_NOMEM; TZ_CANCELLED (the output is whole then too)
 * @cost O(budget), whatever the exemplar's size */
TZ_API tz_status tz_growth_step(tz_growth *g, int32_t budget, bool *more);
TZ_API void tz_growth_end(tz_growth *g); /**< takes NULL */

#endif
