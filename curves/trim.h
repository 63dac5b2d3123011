/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Exemplars cut down to what shows their pattern: lines of a drawing that end together just
 * inside its edge end there as the picture does, not as the pattern does. Cut a little
 * farther in, they run over the border as in any crop. */
#ifndef TZ_CURVES_TRIM_H
#define TZ_CURVES_TRIM_H

#include "curves/curve.h"

typedef enum tz_curve_side {
    TZ_CURVE_LEFT,
    TZ_CURVE_TOP,
    TZ_CURVE_RIGHT,
    TZ_CURVE_BOTTOM,
    TZ_CURVE_SIDES
} tz_curve_side;

typedef struct tz_curve_trim_report {
    tz_vec2 at, size; /**< what was kept, in the coordinates of `from` */
    double empty;     /**< share of the area that was empty at the border */
    bool filled;      /**< for that the largest rectangle was kept that is well filled */
    int32_t ends[TZ_CURVE_SIDES]; /**< free ends that were cut off with each side; 0: that
                                       side was not cut for ends */
    bool trimmed;                 /**< anything was cut off */
} tz_curve_trim_report;

/** Cuts off, at each side by itself, a strip of at most 12 % in which lines end that came
 * up to it: at least as many as a third of those that cross a parallel to that side
 * farther in, and more than twice as many as end in such a strip anywhere; and fewer than
 * half of them reach the side. Of nets (most of the length hangs together) where more than
 * 5 % of the area is empty and lies at the
 * border, the largest rectangle without most of that is taken first, if it holds at least
 * 40 % of the area. All else stays as it is: tori, regions, sets with a photo, drawings
 * of few lines.
 * @param[out] to  overwritten, not freed; zeroed on error; its domain begins at 0, 0. A
 *   copy of `from` where nothing was cut off
 * @param[out] report  NULL, or what was done
 * @return TZ_OK; TZ_NOMEM; TZ_LIMIT; TZ_CANCELLED
 * @cost O(n log n) by pieces, and by length over 1 / 192 of the longer side */
TZ_API tz_status tz_curve_trim(tz_ctx *ctx, const tz_curve_set *from, tz_curve_set *to,
                               tz_curve_trim_report *report);

#endif
