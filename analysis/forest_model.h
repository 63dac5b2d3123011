/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A structured forest, and its file: OpenCV's YAML (.yml, .yml.gz).
 * @source ximgproc's StructuredEdgeDetection of OpenCV 4.6 reads the same files */
#ifndef TZ_ANALYSIS_FOREST_MODEL_H
#define TZ_ANALYSIS_FOREST_MODEL_H

#include "base/alloc.h"

/** Nodes of tree t are t * nodes .. (t + 1) * nodes - 1; the root comes first. */
typedef struct tz_forest {
    int32_t trees;     /**< 1..64 */
    int32_t evaluated; /**< trees that look at one place, 1..trees */
    int32_t nodes;  /**< a tree; smaller trees are filled up with leaves nobody reaches */
    int32_t *child; /**< trees * nodes: 0 = leaf; else below the threshold go to node
                          child - 1 of the tree, at or above it to node child */
    int32_t *feature; /**< trees * nodes: 0 .. TZ_FOREST_FEATURES - 1 */
    float *threshold; /**< trees * nodes */
    int32_t *bound;   /**< trees * nodes + 1 offsets into bin, rising */
    uint8_t *bin;     /**< boundary pixels of the leaves: column * 16 + row */
    tz_ctx *ctx;
} tz_forest;

/** @param[out] f  replaced; empty on error
 * @return TZ_OK; TZ_IO (no such file); TZ_FORMAT (names the fault); TZ_LIMIT (too large);
 * TZ_UNSUPPORTED (other patch sizes or channels than Terrazzo's); TZ_NOMEM
 * @cost 0.05 to 0.1 s for 16 MB of text on two threads */
TZ_API tz_status tz_forest_read(tz_ctx *ctx, const char *path, tz_forest *f);
/** Gzip if the name ends in .gz. The same forest gives the same bytes. */
TZ_API tz_status tz_forest_write(tz_ctx *ctx, const char *path, const tz_forest *f);
TZ_API void tz_forest_deinit(tz_forest *f); /**< takes zeroed */

#endif
