/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Curve textures by quilting: large pieces of the exemplar's curves laid side by side, cut
 * where curves of both run alike, and drawn together there. What a piece brings keeps the
 * exemplar's own line; only what crosses a cut is bent.
 *
 *   candidates for the next place -> the seam along which most curves meet their like
 *   -> ends at the seam paired (assignment: place, direction, pen) and moved onto each other
 *
 * @source Efros, Freeman: Image quilting, SIGGRAPH 2001; Kwatra et al.: Graphcut textures,
 *   SIGGRAPH 2003; as initialisation [Tu20] Sec. 4.3.2. Deviates: cuts curves, not samples,
 *   and keeps their edges */
#ifndef TZ_CURVES_QUILT_H
#define TZ_CURVES_QUILT_H

#include "base/param.h"
#include "curves/curve.h"

/** Table: tz_curve_quilt_param_table. */
typedef struct tz_curve_quilt_params {
    double patch;   /**< side of a patch, of the exemplar's shorter one; 0 = automatic */
    double overlap; /**< of the patch, 0.05 .. 0.45 */
    int32_t candidates; /**< tried for each place */
} tz_curve_quilt_params;
TZ_API extern const tz_param_table tz_curve_quilt_param_table;

typedef struct tz_curve_quilt_job {
    const tz_curve_set
        *exemplar;           /**< planar, or a torus (then patches run over its border) */
    const tz_domain *domain; /**< size, torus, region, frames */
    const tz_curve_set
        *given; /**< NULL, or what is drawn there already: it stays, nothing
                                    is laid over it, and what is laid runs up to its ends.
                                    It is not part of the result */
    const tz_region *given_region; /**< NULL, or where `given` is complete (also where it
                                        is empty): only outside of it anything is laid */
    const tz_curve_quilt_params *params; /**< NULL = defaults */
    uint64_t seed;
} tz_curve_quilt_job;

typedef struct tz_curve_quilt_report {
    int32_t patches;
    int32_t crossings; /**< ends at seams */
    int32_t joined;    /**< of them, those that met another */
} tz_curve_quilt_report;

/** Lines that make up small things by themselves (strokes, wheels, hearts) and discrete
 * elements are laid as a whole or not at all.
 * @param[out] out  curves, and discrete elements, over job->domain, with origins;
 *   overwritten, not freed; zeroed on error. On a torus paths may run over the border
 * @param[out] report  NULL, or what was done
 * @return TZ_OK; TZ_INVALID; TZ_LIMIT; TZ_NOMEM; TZ_CANCELLED
 * @cost linear in what is laid, times candidates */
TZ_API tz_status tz_curve_quilt(tz_ctx *ctx, const tz_curve_quilt_job *job,
                                tz_curve_set *out, tz_curve_quilt_report *report);

#endif
