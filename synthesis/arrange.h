/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Arrangement of edge groups: EBPT -> layout, by growing.
 * @source [Kim21] Sec. 5.1; growth and neighbourhood choice after [Dav19] Sec. 4 */
#ifndef TZ_SYNTHESIS_ARRANGE_H
#define TZ_SYNTHESIS_ARRANGE_H

#include "analysis/ebpt.h"
#include "base/param.h"
#include "elements/frames.h"
#include "synthesis/layout.h"
#include "synthesis/rules.h"

/** Table: tz_arrange_param_table. */
typedef struct tz_arrange_params {
    int32_t size[2]; /**< layout px */
    uint64_t seed;
    bool tile;          /**< torus */
    double piece;       /**< wanted diameter of a placed piece, px; 0 = from the scale */
    bool rotate_auto;   /**< rotation range from the exemplar's own isotropy */
    double rotation[2]; /**< deg, used when rotate_auto is off */
    double scale[2];    /**< factor range */
    int32_t mirror;     /**< 0 auto, 1 never, 2 always allowed */
    double coherence;   /**< 0..1: how much running on with the exemplar is liked */
    int32_t effort;     /**< 1..9: candidates tried per placement */
    const tz_frames *frames; /**< borrowed; turn, size and distances of pieces at each
                                  layout px; NULL = as the exemplar's. Not in the table */
} tz_arrange_params;
TZ_API extern const tz_param_table tz_arrange_param_table;

/** One exemplar as the arrangement sees it. */
typedef struct tz_exemplar {
    const tz_image *photo; /**< colour, sRGB-encoded */
    const tz_ebpt *ebpt;   /**< same size */
    const char *path;      /**< for the layout document */
    const char *sha256;
} tz_exemplar;

/** Fills the layout with placements that cover it.
 * @param exemplars  n >= 1; rules choose between them
 * @param rules      NULL = default
 * @param params     frames turn pieces and scale them by 0.25 to 4; where densities are said
 *   pieces are cut larger, so that fewer lie there
 * @param[in,out] l  zeroed, or an existing layout of the same size, tile and sources whose
 *   fixed placements are kept and grown around
 * @return TZ_OK; TZ_INVALID; TZ_NOMEM; TZ_CANCELLED; untouched on error
 * @cost linear in placements; each costs a constant number of candidate evaluations */
TZ_API tz_status tz_arrange(tz_ctx *ctx, const tz_exemplar *exemplars, int32_t n,
                            const tz_rules *rules, const tz_arrange_params *params,
                            tz_layout *l);

#endif
