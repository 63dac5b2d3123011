/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Curves for plotters and cutters: DXF (AutoCAD R12, ASCII), polylines on a layer a pen,
 * in the order in which a pen travels least. */
#ifndef TZ_CURVES_CURVE_DXF_H
#define TZ_CURVES_CURVE_DXF_H

#include "curves/curve.h"

/** Order and direction of paths for a pen that begins at 0, 0: greedy by nearest end, then
 * improved (2-opt within a window).
 * @param[out] order  path numbers, path.n of them; reversed[k]: path order[k] is drawn from
 *   its end. Caller allocates
 * @return way with the pen up, user units; < 0 on error
 * @cost O(n log n) */
TZ_API tz_status tz_curve_travel(tz_ctx *ctx, const tz_curve_set *s, int32_t *order,
                                 bool *reversed, double *way);
/** Writes R12 DXF; y is turned up. Curves become polylines within `tolerance`.
 * @param unit       length of a user unit, mm; > 0
 * @param tolerance  user units; 0 = 1/20 of the thinnest pen
 * @return TZ_OK; TZ_INVALID; TZ_IO (nothing is left); TZ_NOMEM */
TZ_API tz_status tz_curve_write_dxf(tz_ctx *ctx, const char *path, const tz_curve_set *s,
                                    double unit, double tolerance);

#endif
