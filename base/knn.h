/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * k nearest neighbours among long descriptors, by FLANN with a fixed seed: the same input
 * gives the same answer. */
#ifndef TZ_BASE_KNN_H
#define TZ_BASE_KNN_H

#include "base/ctx.h"

/** For each of nq queries the k nearest of n points (all rows of dim floats).
 * @param exact  true: linear search; false: randomised kd-forest
 * @param[out] id, dist2  nq * k, nearest first; id -1 where fewer than k exist */
TZ_API tz_status tz_knn(tz_ctx *ctx, const float *points, int32_t n, int32_t dim,
                        const float *queries, int32_t nq, int32_t k, bool exact,
                        int32_t *id, float *dist2);

#endif
