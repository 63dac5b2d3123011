/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Exact k nearest neighbours among points of few dimensions (2 to 16). For long
 * descriptors see base/knn.h (FLANN). */
#ifndef TZ_BASE_KDTREE_H
#define TZ_BASE_KDTREE_H

#include "base/array.h"

typedef struct tz_kdtree {
    int32_t n, dim;
    float *point; /* n * dim, in tree order */
    int32_t *id;  /* tree order -> caller's index */
    tz_ctx *ctx;
} tz_kdtree;

/** @param p  n * dim finite floats, copied  @cost O(n log n) */
TZ_API tz_status tz_kdtree_init(tz_ctx *ctx, tz_kdtree *t, const float *p, int32_t n,
                                int32_t dim);
TZ_API void tz_kdtree_deinit(tz_kdtree *t);
/** The k nearest by squared distance, nearest first, ties by lower index.
 * @return how many were found, min(k, n) */
TZ_API int32_t tz_kdtree_nearest(const tz_kdtree *t, const float *q, int32_t k,
                                 int32_t *id, float *dist2);

#endif
