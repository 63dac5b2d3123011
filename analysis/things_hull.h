/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Convex hulls of regions that are joined two by two. Private to analysis/. */
#ifndef TZ_ANALYSIS_THINGS_HULL_H
#define TZ_ANALYSIS_THINGS_HULL_H

#include "base/array.h"

typedef struct tz_hull_point {
    int32_t x, y; /**< a corner of pixels */
} tz_hull_point;

/** Hull k: point[first[k]] .. point[first[k] + count[k] - 1]; count 0 = not known. */
typedef struct tz_hulls {
    TZ_ARRAY(tz_hull_point)
    point;
    int32_t *first, *count; /**< 2 * labels */
    double largest;
    tz_hull_point *sorted; /**< scratch */
    int32_t room;
} tz_hulls;

/** Hulls of the pixels of labels 0 .. labels - 1.
 * @param largest  area beyond which hulls are dropped */
tz_status tz_hulls_init(tz_ctx *ctx, tz_hulls *h, const int32_t *label, int32_t width,
                        int32_t height, int32_t labels, double largest);
void tz_hulls_deinit(tz_ctx *ctx, tz_hulls *h); /**< takes zeroed */
/** Hull `to` of hulls a and b together; their points are kept. @cost O(points log points)
 * @param area       of the region
 * @param[out] hull  area of the hull; 0 where it is dropped */
tz_status tz_hulls_join(tz_ctx *ctx, tz_hulls *h, int32_t a, int32_t b, int32_t to,
                        double area, double *hull);
double tz_hulls_area(const tz_hulls *h, int32_t k);

#endif
