/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Training data of one tree: patches of scenes, their features in 256 steps, and what is
 * true in them. Private to analysis/. */
#ifndef TZ_ANALYSIS_FOREST_PATCHES_H
#define TZ_ANALYSIS_FOREST_PATCHES_H

#include "analysis/forest_features.h"
#include "analysis/forest_train.h"

#define TZ_PATCH_CELLS (TZ_FOREST_INNER * TZ_FOREST_INNER)
#define TZ_PATCH_STEPS 256

typedef struct tz_forest_patches {
    int32_t n;        /**< patches */
    int32_t features; /**< that this tree may use */
    int32_t *feature; /**< their ids, rising */
    float *edge;    /**< features * (TZ_PATCH_STEPS - 1): value < edge[k] has a step <= k;
                         rising; unused ones are infinite */
    uint8_t *step;  /**< features * n: value >= edge[step - 1], value < edge[step] */
    uint8_t *label; /**< n * TZ_PATCH_CELLS, row by row: connected parts of the inner
                         patch between boundaries, 1..; 0 on a boundary */
    tz_ctx *ctx;
} tz_forest_patches;

/** Draws the scenes of tree `tree` and cuts patches out of them.
 * @param[out] p  replaced; empty on error  @return TZ_OK; TZ_NOMEM; TZ_CANCELLED */
tz_status tz_forest_patches_init(tz_ctx *ctx, const tz_forest_train_params *params,
                                 int32_t scenes, int32_t tree, tz_forest_patches *p);
void tz_forest_patches_deinit(tz_forest_patches *p); /**< takes zeroed */

#endif
