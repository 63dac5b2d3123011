/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Region growing of element textures.
 *
 * Radii of neighbourhoods and voids (empty room that is grown like an element and then
 * left out) are found automatically. An exemplar of fewer than five elements, or of
 * elements in one row, is read as a tile that repeats with its domain.
 *
 * Shapes keep apart by where they touch (elements/extent.h), as near as the exemplar's do.
 * Where each element has a symbol of its own, as in photos, alike ones take turns, and
 * copies of one keep far apart. Discs between the shapes get no wider than the exemplar's
 * widest, as far as anything fits or can be moved there.
 *
 * The output's domain is followed: elements stand inside its region, neighbourhoods and
 * elements turn with its frames, zones admit kinds.
 * @source [Dav19] Sec. 4 and 5 but 5.7 and 5.8; local frames [Ma11] Eq. (7). Deviations
 *   stand where they are made */
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
    double inside;    /**< share of an element's radius that must lie within the domain:
                           0 = its centre, 1 = all of its disc */
    int32_t most;     /**< elements placed at most, 0 = as many as fit */
} tz_growth_params;
TZ_API extern const tz_param_table tz_growth_param_table;

/** Radii of the elements of a kind, user units of the palette.
 * @source [Dav19] Sec. 4.1 */
typedef struct tz_growth_radius {
    double bounding;      /**< of its circles, mean */
    double neighbourhood; /**< of what it is compared by, mean */
} tz_growth_radius;

/** One texture of a palette: a palette is a set that may hold many exemplars side by side.
 * All zero = all of the palette, everywhere, as large as it is. */
typedef struct tz_growth_texture {
    tz_vec2 from, to; /**< its frame: elements with centres in [from, to); equal = all */
    uint64_t kinds;   /**< selection: bit of each kind that is taken, 0 = all; kinds from
                           64 on are always taken */
    double scale;     /**< of copies and their distances against the palette; 0 = 1 */
    int32_t zone;     /**< 1 + the zone of the output's domain that it grows in; 0 =
                           everywhere */
    const tz_growth_radius *radius; /**< NULL, or for each kind of the palette; members of
                                         0 are found, others taken */
} tz_growth_texture;

typedef struct tz_growth tz_growth;

/** How far a growth has come. */
typedef struct tz_growth_report {
    double area;     /**< that may be grown in, user units squared */
    double covered;  /**< share of it in which elements and empty room are decided */
    int32_t placed;  /**< elements of the output */
    double expected; /**< elements that the whole area holds at the exemplars' density */
} tz_growth_report;

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
/** The same of several textures of one palette, which share the output: elements of all
 * keep apart, neighbourhoods are compared within a texture.
 * @param texture  n of them, 1..64; copied
 * @return as tz_growth_begin; TZ_INVALID also for a texture that selects no elements, a
 *   scale that is not positive, a zone that the output's domain has not (names it) */
TZ_API tz_status tz_growth_begin_palette(tz_ctx *ctx, const tz_element_set *palette,
                                         const tz_growth_texture *texture, int32_t n,
                                         const tz_growth_params *params,
                                         tz_element_set *output, tz_growth **growth);
/** Grows by about `budget` elements. The output is whole and may be read between steps.
 * How the work is cut into steps does not change the output. Serial.
 * @param budget     at least 1
 * @param[out] more  false when all is done
 * @return TZ_OK; TZ_NOMEM; TZ_CANCELLED (the output is whole then too)
 * @cost O(budget), whatever the exemplar's size */
TZ_API tz_status tz_growth_step(tz_growth *g, int32_t budget, bool *more);
/** @cost O(1) */
TZ_API void tz_growth_tell(const tz_growth *g, tz_growth_report *report);
/** Radii in use. @param[out] radius  kinds of the palette of them; 0 = the texture has no
 * such elements */
TZ_API void tz_growth_radii(const tz_growth *g, int32_t texture,
                            tz_growth_radius *radius);
TZ_API void tz_growth_end(tz_growth *g); /**< takes NULL */

#endif
