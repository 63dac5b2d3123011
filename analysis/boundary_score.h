/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * How well found boundaries agree with true ones: precision and recall over thresholds
 * after one-to-one matching within a tolerance, and the usual figures of them: ODS, OIS
 * and AP.
 * @source Martin, Fowlkes, Malik: Learning to detect natural image boundaries using local
 * brightness, color, and texture cues, PAMI 2004; Arbelaez, Maire, Fowlkes, Malik, PAMI
 * 2011. Deviates: the matching is the largest one (Hopcroft-Karp) instead of the
 * cheapest; with the published cost of an outlier both match the same number of pixels.
 * The truth is thinned as well, so that what equals it scores 1. */
#ifndef TZ_ANALYSIS_BOUNDARY_SCORE_H
#define TZ_ANALYSIS_BOUNDARY_SCORE_H

#include "base/alloc.h"

#define TZ_BOUNDARY_LEVELS 33

/** Counts of one picture, or of many added up, at thresholds k / 34, k = 1..33. */
typedef struct tz_boundary_counts {
    int64_t found[TZ_BOUNDARY_LEVELS];       /**< pixels of the detector */
    int64_t found_true[TZ_BOUNDARY_LEVELS];  /**< of them matched */
    int64_t truth;                           /**< true boundary pixels */
    int64_t truth_found[TZ_BOUNDARY_LEVELS]; /**< of them matched */
} tz_boundary_counts;

typedef struct tz_boundary_score {
    double ods; /**< best F over thresholds, interpolated, of the summed counts */
    double ods_threshold, ods_precision, ods_recall;
    double ois; /**< F of the sums where each picture takes its own best threshold */
    double ap;  /**< area under precision over recall, 0..1; below the lowest recall
                     reached the precision is the one there */
} tz_boundary_score;

/** Matches one picture at every threshold. At each threshold the detector's pixels are
 * those of `strength` at or above it, thinned to curves one pixel wide.
 * @param strength   width * height, 0..1: ridges after non-maximum suppression, else 0
 * @param truth      width * height, not 0 on true boundaries
 * @param tolerance  of the diagonal; 0.0075 is usual
 * @return TZ_OK; TZ_NOMEM; TZ_CANCELLED  @cost levels * pixels * log */
TZ_API tz_status tz_boundary_match(tz_ctx *ctx, const float *strength,
                                   const uint8_t *truth, int32_t width, int32_t height,
                                   double tolerance, tz_boundary_counts *counts);

/** Figures of n pictures. */
TZ_API tz_boundary_score tz_boundary_score_of(const tz_boundary_counts *counts,
                                              int32_t n);

/** Non-maximum suppression for scoring, the same for every detector: keeps the response
 * where it is a ridge across the direction estimated from the response itself (smoothed
 * second derivatives), 0 elsewhere.
 * @param[in] response  width * height, any range  @param[out] strength  width * height */
TZ_API tz_status tz_boundary_thin(tz_ctx *ctx, const float *response, int32_t width,
                                  int32_t height, float *strength);

/** Direction across the ridges of a response, as tz_boundary_thin takes it.
 * @param[out] normal  planes of width * height: cos, sin of twice the angle; 1, 0 where
 *                     the response is flat */
TZ_API tz_status tz_boundary_normals(tz_ctx *ctx, const float *response, int32_t width,
                                     int32_t height, float *normal);

#endif
