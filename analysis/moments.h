/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Principal axes. Private to analysis/. */
#ifndef TZ_ANALYSIS_MOMENTS_H
#define TZ_ANALYSIS_MOMENTS_H

#include "base/geom.h"

/** First principal axis of a covariance matrix against +x, [0, pi); 0 if it is round. */
static inline double tz_axis_angle(double xx, double xy, double yy)
{
    const double a = 0.5 * atan2(2 * xy, xx - yy), b = a < 0 ? a + TZ_PI : a;
    return b >= TZ_PI || b <= 0 ? 0 : b;
}

#endif
