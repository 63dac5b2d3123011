/* SPDX-License-Identifier: Apache-2.0 */
/* Nearest neighbours among descriptors: FLANN behind a C function. */
#include <flann/flann.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

extern "C" {
#include "base/knn.h"
}
#include "base/guard.hpp"

namespace
{

template <class Index>
void search(const Index &index, const flann::Matrix<float> &queries, int32_t k,
            int32_t *id, float *dist2, float eps)
{
    flann::SearchParams params(flann::FLANN_CHECKS_UNLIMITED, eps);
    params.cores = 1; /* our threads are ours */
    params.sorted = true;
    /* FLANN fills all columns it is given, found or not */
    size_t found = std::min(index.size(), size_t(k));
    flann::Matrix<int> ids(id, queries.rows, found, size_t(k) * sizeof *id);
    flann::Matrix<float> distances(dist2, queries.rows, found, size_t(k) * sizeof *dist2);
    index.knnSearch(queries, ids, distances, found, params);
}

} // namespace

extern "C" tz_status tz_knn(tz_ctx *ctx, const float *points, int32_t n, int32_t dim,
                            const float *queries, int32_t nq, int32_t k, bool exact,
                            int32_t *id, float *dist2)
{
    if (n < 0 || nq < 0 || dim < 1 || k < 1)
        return tz_fail(ctx, TZ_INVALID,
                       "neighbours: %d points, %d queries, %d dimensions, "
                       "%d neighbours",
                       n, nq, dim, k);
    for (int64_t i = 0; i < int64_t(nq) * k; i++) {
        id[i] = -1;
        dist2[i] = INFINITY;
    }
    if (n == 0 || nq == 0)
        return TZ_OK;
    return tz_guard(ctx, "neighbours", [&]() -> tz_status {
        using Distance = flann::L2<float>;
        flann::Matrix<float> p(const_cast<float *>(points), size_t(n), size_t(dim));
        flann::Matrix<float> q(const_cast<float *>(queries), size_t(nq), size_t(dim));
        if (exact || n < 32) {
            flann::LinearIndex<Distance> index(p);
            index.buildIndex();
            search(index, q, k, id, dist2, 0.0f);
        } else {
            /* Not the randomised forest: Debian's FLANN shuffles its points by
             * std::random_device, and no seed makes two runs alike. One tree, and a
             * bounded error in place of a bounded number of checks. */
            flann::KDTreeSingleIndex<Distance> index(p,
                                                     flann::KDTreeSingleIndexParams(16));
            index.buildIndex();
            search(index, q, k, id, dist2, 0.5f);
        }
        return TZ_OK;
    });
}
