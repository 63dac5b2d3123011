/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Curves for plotters and cutters: DXF (AutoCAD R12, ASCII), polylines on a layer a pen,
 * in the order in which a pen travels least. */
#ifndef TZ_CURVES_CURVE_DXF_H
#define TZ_CURVES_CURVE_DXF_H

#include "curves/curve.h"

/** Order and direction of paths for a plotter that begins at 0, 0 and changes pens as
 * seldom as can be: pen after pen, within each greedy by nearest end, then improved (2-opt
 * and moves of single paths within a window).
 * @param[out] order  path numbers, path.n of them; reversed[k]: path order[k] is drawn from
 *   its end. Caller allocates
 * @param[out] way    ways with the pen up, user units: as drawn, and in this order
 * @return TZ_OK; TZ_NOMEM; TZ_CANCELLED; outputs undefined on error
 * @cost O(n log n), and O(n) windows of 32 to 1024 */
TZ_API tz_status tz_curve_travel(tz_ctx *ctx, const tz_curve_set *s, int32_t *order,
                                 bool *reversed, double way[2]);
/** Writes R12 DXF in mm; y is turned up, 0, 0 is the lower left corner. Curves become
 * polylines within `tolerance`; elements, their outlines on a layer of their own; paths
 * of a torus are drawn through beyond its border. Layers are PEN_1, ..., coloured by the
 * nearest of AutoCAD's colours; comments tell width and colour of each.
 * @param unit       length of a user unit, mm; > 0
 * @param tolerance  user units; 0 = 1/20 of the thinnest pen
 * @param[out] way   NULL, or as for tz_curve_travel (elements included)
 * @return TZ_OK; TZ_INVALID (unit, tolerance; an unsound set; over 10 km a side); TZ_IO
 *   (nothing is left); TZ_LIMIT; TZ_NOMEM; TZ_CANCELLED */
TZ_API tz_status tz_curve_write_dxf(tz_ctx *ctx, const char *path, const tz_curve_set *s,
                                    double unit, double tolerance, double way[2]);

#endif
