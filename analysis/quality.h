/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Quality measures: how well an output continues its exemplar, without neural networks. */
#ifndef TZ_ANALYSIS_QUALITY_H
#define TZ_ANALYSIS_QUALITY_H

#include "base/image.h"
#include "base/param.h"

/** Table: tz_quality_param_table. */
typedef struct tz_quality_params {
    uint64_t seed;
    bool tile;           /**< also measure the wrap seam */
    int32_t projections; /**< sliced Wasserstein directions a level */
    int32_t patches;     /**< patches drawn a level */
} tz_quality_params;
TZ_API extern const tz_param_table tz_quality_param_table;

/** All ratios: distance (exemplar, output) / distance (halves of the exemplar); 1 = the
 * output differs from the exemplar as two of its halves differ. */
typedef struct tz_quality {
    double patch;          /**< sliced Wasserstein of 7 x 7 patches, mean of the levels */
    double patch_level[5]; /**< finest first; NAN where the exemplar is too small */
    double orientation;    /**< orientation histogram distance ratio */
    double correlation;    /**< autocorrelation distance ratio */
    double sharpness;      /**< Laplacian energy, output / exemplar, two finest levels */
    double sharpness_range; /**< factor by which the exemplar's own halves differ from it,
                               1.1..1.35: what the score forgives of sharpness */
    double repetition;      /**< share 0..1 of 48 px patches that occur again elsewhere */
    double repetition_near; /**< the same, where a slight stretch or turn (2 px, 8 %, 5
                               degrees) does not hide a copy; at least repetition */
    double periodicity; /**< 0..1: strongest off-centre autocorrelation peak beyond the
                               exemplar's own */
    double seam;   /**< strong straight discontinuities per px beyond the exemplar's */
    double broken; /**< loose ends of edges and ridges per length, / exemplar's; 1
                               within the spread of the exemplar's own halves */
    double wrap;   /**< discontinuity across the wrap / inside; NAN if not asked */
    double score;  /**< 0..100, see the method note */
    double cost_patch, cost_structure, cost_sharpness, cost_repetition, cost_periodicity,
        cost_seam, cost_broken, cost_wrap; /**< points that each took off the score */
} tz_quality;

/** @param heat  NULL or receives a map of output size, 1 channel 0..1: where it is worse
 *  @return TZ_OK; TZ_INVALID (smaller than 16 x 16, channel counts differ); TZ_NOMEM */
TZ_API tz_status tz_quality_measure(tz_ctx *ctx, const tz_image *exemplar,
                                    const tz_image *output,
                                    const tz_quality_params *params, tz_quality *q,
                                    tz_image *heat);

#endif
