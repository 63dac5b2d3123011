/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * How like an exemplar a layout of curves is: statistics of both, each difference over the
 * one that two halves of the exemplar have between them (1 = as like as its own halves).
 */
#ifndef TZ_CURVES_CURVE_COMPARE_H
#define TZ_CURVES_CURVE_COMPARE_H

#include "curves/curve.h"

enum {
    TZ_CURVE_DEGREES = 8, /**< node degrees 1 .. 7 and more */
    TZ_CURVE_WORST = 10   /**< no ratio is larger */
};

/** Ratios run from 0 (the same) by 1 (as the exemplar's own halves) to TZ_CURVE_WORST. One
 * that does not apply, as neither of the two has such things, is NAN and not part of the
 * mean. */
typedef struct tz_curve_likeness {
    double degrees; /**< nodes of each degree, per length: ratio */
    double ends;    /**< dangling ends per length: ratio */
    double edges;   /**< ways along lines to the next junction or end: ratio */
    double
        turning; /**< angles by which lines turn within a short way, of several lengths: ratio */
    double orientation; /**< directions of lines, weighted by length: ratio */
    double density;     /**< length per area: ratio */
    double cells;       /**< areas of the cells that lines enclose: ratio */
    double
        patches; /**< patches of the distance transform: nearest of the exemplar: ratio */
    double mean; /**< of all ratios that apply */
    double length[2];   /**< length per area, exemplar, layout, 1 / user unit */
    double dangling[2]; /**< dangling ends per length, exemplar, layout, 1 / user unit */
    double degree[2]
                 [TZ_CURVE_DEGREES]; /**< share of nodes of degree 1, 2 (corners), 3, ..
                                             of exemplar, layout; sums to 1, or all 0 */
    double degree_off;  /**< half the sum of differences of the two: 0 .. 1 */
    double repeats;     /**< share of the layout's length that occurs in it a second time,
                            verbatim, in a run of over a quarter of the exemplar's shorter
                            side; straight runs do not count */
    double repeats_own; /**< the same of the exemplar */
} tz_curve_likeness;

/** Paths are joined first (curves/curve_join.h), crossings count as nodes. What the border
 * cuts counts with regard to that: ends within half a line's width of the border (1/20 to
 * 1/4 of the exemplar's line distance, area over length) are none, nodes there
 * are mirrored if lines run along it, edges and cells that it cuts are corrected for.
 * Guided layouts (region, frames) are measured inside their region; orientation and patches
 * against the frames. Discrete elements do not count, see elements/element_compare.h.
 * @param[out] out  untouched on error
 * @return TZ_OK; TZ_INVALID (too little to have statistics); TZ_LIMIT (crossings without
 *   end); TZ_NOMEM; TZ_CANCELLED
 * @cost O(n log n) by pieces, and O(pixels) of rasters of at most 2048 a side */
TZ_API tz_status tz_curve_compare(tz_ctx *ctx, const tz_curve_set *exemplar,
                                  const tz_curve_set *layout, tz_curve_likeness *out);

/** The exemplar's side of a comparison, made once for many layouts. */
typedef struct tz_curve_standard tz_curve_standard;
/** @param exemplar  must outlive it @param[out] out  NULL on error
 * @return as tz_curve_compare */
TZ_API tz_status tz_curve_standard_new(tz_ctx *ctx, const tz_curve_set *exemplar,
                                       tz_curve_standard **out);
TZ_API void tz_curve_standard_free(tz_curve_standard *s); /**< takes NULL */
/** @param[out] out  untouched on error  @return as tz_curve_compare */
TZ_API tz_status tz_curve_standard_compare(const tz_curve_standard *s,
                                           const tz_curve_set *layout,
                                           tz_curve_likeness *out);

#endif
