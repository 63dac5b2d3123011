/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Cubics through many points. Not installed. */
#ifndef TZ_CURVES_CURVE_FIT_INTERNAL_H
#define TZ_CURVES_CURVE_FIT_INTERNAL_H

#include "curves/curve.h"

/** Appends points to the open path of `to` as lines and cubics, corners kept.
 * @param p  n >= 2 points
 * @param tolerance  farthest that a point may lie off
 * @param window     way over which a corner is one
 * @param node       first and last, which lie at p[0] and p[n - 1]
 * @return TZ_OK; TZ_NOMEM  @cost O(n log n) */
tz_status tz_curve_fit(tz_curve_set *to, const tz_vec2 *p, int32_t n, double tolerance,
                       double window, const int32_t node[2]);

#endif
