/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Arranges the elements of an exemplar over a domain: region growing, then a few
 * iterations of the energy solver over everything; or the solver from another start.
 * @source [Dav19] for growing, [Ma11] for the energy */
#ifndef TZ_ELEMENTS_ELEMENT_ARRANGE_H
#define TZ_ELEMENTS_ELEMENT_ARRANGE_H

#include "base/param.h"
#include "elements/growth.h"
#include "elements/paint.h"

typedef enum tz_element_method {
    TZ_ELEMENTS_GROWTH,  /**< growth, then the solver */
    TZ_ELEMENTS_PATCHES, /**< the solver alone, from patches of the exemplar */
    TZ_ELEMENTS_NOISE    /**< the solver alone, from elements at random places */
} tz_element_method;

/** Table: tz_element_arrange_param_table. */
typedef struct tz_element_arrange_params {
    int32_t method;                 /**< tz_element_method */
    int32_t rings;                  /**< of neighbours, 1..3 */
    int32_t optimise;               /**< tz_growth_optimise */
    int32_t candidates;             /**< alike neighbourhoods tried, 1..8 */
    double ratio, overlap, balance; /**< as in tz_growth_params */
    int32_t
        iterations; /**< of the solver; -1 = 3 after growth where they help, 20 else */
    int32_t most;   /**< elements at most, 0 = as many as fit */
    int32_t shape;  /**< tz_shape: what becomes of elements of several samples */
    bool existence; /**< the solver also adds what is missing and removes what is amiss */
    double inside;  /**< as in tz_growth_params */
} tz_element_arrange_params;
TZ_API extern const tz_param_table tz_element_arrange_param_table;

typedef struct tz_element_arrange_report {
    int32_t elements; /**< in the layout */
    double filled;    /**< elements, over what the exemplar's density asks for */
    double covered; /**< share of the domain in which growth has decided; 1 without it */
    double grow, solve; /**< s */
} tz_element_arrange_report;

/** What is arranged. */
typedef struct tz_element_arrange_job {
    const tz_element_set *exemplar; /**< not changed */
    const char *name;               /**< of it, in messages */
    const tz_element_arrange_params *params;
    uint64_t seed;
    const tz_growth_texture
        *texture; /**< exemplars of a palette; NULL = all of it is one */
    int32_t textures;
    const tz_paint *paint; /**< strokes that grow; NULL = the whole domain fills */
} tz_element_arrange_job;

/** Fills the layout's domain, or paints in it. Several textures, and strokes, are grown
 * only: the solver knows one exemplar for the whole of a layout.
 * @param layout    made by tz_element_set_like(exemplar): without elements, or with
 *                  some that are kept and arranged around
 * @param[out] report  NULL, or what was done
 * @return TZ_OK; TZ_INVALID (an exemplar or a domain that nothing can be made of);
 *   TZ_LIMIT; TZ_NOMEM; TZ_CANCELLED (the layout is whole then too)
 * @cost linear in the elements of the layout */
TZ_API tz_status tz_element_arrange(tz_ctx *ctx, const tz_element_arrange_job *job,
                                    tz_element_set *layout,
                                    tz_element_arrange_report *report);

#endif
