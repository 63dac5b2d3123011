/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Things found in a scene against those that are in it. */
#ifndef TZ_TESTS_SUPPORT_THINGS_TRUTH_H
#define TZ_TESTS_SUPPORT_THINGS_TRUTH_H

#include <stdbool.h>

#include "analysis/things_tree.h"
#include "scenes/scene.h"

/** Best intersection over union with a true thing, for each node of a tree. */
tz_status truth_of_nodes(tz_ctx *ctx, const tz_things_tree *t, const tz_scene *scene,
                         float *iou);

typedef struct truth_counts {
    int32_t found;  /**< labels that count */
    int32_t things; /**< true things that count */
    int32_t pairs;  /**< of one each, at an intersection over union of 0.5 or more */
    double iou;     /**< sum over the pairs */
} truth_counts;

/** Pairs found and true things, the best first (greedy). True things of fewer than 30
 * visible px, or whose border lies for more than a third on the picture's, count neither
 * as missed nor, with what pairs with them, as found; nor do labels count that lie for
 * more than half in such things, or are smaller than 30 px themselves.
 * @param label   width * height: 0 .. labels - 1, below 0 = ground */
tz_status truth_count(tz_ctx *ctx, const tz_scene *scene, const int32_t *label,
                      int32_t labels, truth_counts *out);

#endif
