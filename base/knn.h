/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * k nearest neighbours among long descriptors, by FLANN: the same input gives the same
 * answer. */
#ifndef TZ_BASE_KNN_H
#define TZ_BASE_KNN_H

#include "base/ctx.h"

/** For each of nq queries the k nearest of n points (all rows of dim floats).
 * @param exact  true: linear search; false: a k-d tree whose neighbours are at most 1.5
 *   times as far as the nearest (FLANN's randomised forest gives no two runs alike)
 * @param[out] id, dist2  nq * k, nearest first; id -1 where fewer than k exist */
TZ_API tz_status tz_knn(tz_ctx *ctx, const float *points, int32_t n, int32_t dim,
                        const float *queries, int32_t nq, int32_t k, bool exact,
                        int32_t *id, float *dist2);

#endif
