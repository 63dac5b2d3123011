/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Trains a structured forest on scenes whose boundaries are known.
 * @source Dollar, Zitnick: Fast edge detection using structured forests, PAMI 2015, Sec. 3
 */
#ifndef TZ_ANALYSIS_FOREST_TRAIN_H
#define TZ_ANALYSIS_FOREST_TRAIN_H

#include "analysis/forest_model.h"
#include "base/param.h"

/** Scene seeds that training never uses: held out for measuring. */
#define TZ_FOREST_HELD_OUT 1000000

/** Table: tz_forest_train_param_table. */
typedef struct tz_forest_train_params {
    int32_t trees; /**< 1..64 */
    uint64_t seed;
    char budget[TZ_PARAM_STRING_SIZE]; /**< "30m": sets scenes, by what training took on
        two cores; no clock is read, so the same budget gives the same forest */
    int32_t scenes;                    /**< a tree; 0 = from the budget */
    int32_t patches; /**< a scene, half of them on boundaries where there are enough */
    int32_t side;    /**< px of a scene */
    double share;    /**< of the features that a tree may use, 0..1 */
    int32_t tried;   /**< features tried at a node; 0 = the square root of the tree's */
    int32_t least;   /**< patches in a leaf, at least; 0 = 8, more for large data */
    int32_t depth;   /**< of a tree, at most */
} tz_forest_train_params;
TZ_API extern const tz_param_table tz_forest_train_param_table;

/** Trains. Progress counts scenes drawn and patches sorted into leaves.
 * @param[out] forest  replaced; empty on error; the same parameters give the same forest at
 *                     any thread count
 * @return TZ_OK; TZ_INVALID (budget is no time); TZ_NOMEM; TZ_CANCELLED
 * @cost 0.27 s of processor time a scene of 320 x 320 px and 900 patches; memory: patches of
 *       a tree * (share * 7228 + 300) bytes */
TZ_API tz_status tz_forest_train(tz_ctx *ctx, const tz_forest_train_params *params,
                                 tz_forest *forest);

#endif
