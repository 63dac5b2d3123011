/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Order of strokes for a pen. Not installed. */
#ifndef TZ_CURVES_CURVE_TRAVEL_INTERNAL_H
#define TZ_CURVES_CURVE_TRAVEL_INTERNAL_H

#include "curves/curve.h"

/** A stroke as a plotter sees it. */
typedef struct tz_travel_stroke {
    tz_vec2 from, to;
    int32_t pen; /**< >= 0; pens are drawn in rising order */
} tz_travel_stroke;

/** As tz_curve_travel. */
tz_status tz_travel_order(tz_ctx *ctx, const tz_travel_stroke *stroke, int32_t n,
                          int32_t *order, bool *reversed, double way[2]);

#endif
