/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Grows one tree of a structured forest from patches. Private to analysis/. */
#ifndef TZ_ANALYSIS_FOREST_GROW_H
#define TZ_ANALYSIS_FOREST_GROW_H

#include "analysis/forest_patches.h"
#include "base/array.h"

/** Breadth first; children of a node stand side by side. */
typedef struct tz_forest_tree {
    TZ_ARRAY(int32_t)
    child; /**< as in tz_forest */
    TZ_ARRAY(int32_t)
    feature; /**< ids */
    TZ_ARRAY(float)
    threshold;
    TZ_ARRAY(int32_t)
    medoid; /**< of a leaf: the patch whose boundaries it keeps; else -1 */
} tz_forest_tree;

/** @param[out] t  replaced; empty on error
 *  @return TZ_OK; TZ_NOMEM; TZ_CANCELLED
 *  @cost O(patches * depth * (tried + 256)), in parallel by nodes
 *  @source Dollar, Zitnick, PAMI 2015, Sec. 3.1, 3.2: labels of a node are mapped by 256
 *  random pairs of pixels (same part or not), and split in two by the sign of their first
 *  principal component; the split of the features with the best Gini gain is taken */
tz_status tz_forest_grow(tz_ctx *ctx, const tz_forest_train_params *params, int32_t tree,
                         const tz_forest_patches *p, tz_forest_tree *t);
void tz_forest_tree_deinit(tz_ctx *ctx, tz_forest_tree *t); /**< takes zeroed */

#endif
