/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Outlines of labelled things, finer than pixels. Private to analysis/. */
#ifndef TZ_ANALYSIS_THINGS_OUTLINE_H
#define TZ_ANALYSIS_THINGS_OUTLINE_H

#include "base/array.h"
#include "base/geom.h"

/** Closed polygons of a thing: point[part[k]] .. up to the next part. Outer ones run
 * clockwise as seen (y down), holes the other way. */
typedef struct tz_things_outline {
    TZ_ARRAY(tz_vec2)
    point;
    TZ_ARRAY(int32_t)
    part;
} tz_things_outline;

/** The half-way lines of each thing's smoothed mask, in px of the photo, about a point a
 * px, not simplified; parts of under 3 px of area are left out, the largest comes first.
 * Label is set to what lies within them. A thing that smoothing would take away is
 * smoothed less.
 * @param smoothing    px, deviation of the Gaussian, 0..10
 * @param[in,out] label  0 .. count - 1, -1
 * @param[out] out     count of them, zeroed before; freed by the caller in any case
 * @cost O(pixels in the things' boxes) */
tz_status tz_things_outlines(tz_ctx *ctx, int32_t *label, int32_t width, int32_t height,
                             int32_t count, double smoothing, tz_things_outline *out);
/** Gives each pixel whose centre an outline holds its number, -1 to the others; the first
 * one counts where two hold it. */
tz_status tz_things_paint(tz_ctx *ctx, const tz_things_outline *o, int32_t count,
                          int32_t width, int32_t height, int32_t *label);
void tz_things_outline_deinit(tz_ctx *ctx, tz_things_outline *o);

/** Leaves out points that lie within `error` of the line between their neighbours that
 * stay. @source Douglas, Peucker 1973 */
tz_status tz_things_simplify(tz_ctx *ctx, const tz_things_outline *in, double error,
                             tz_things_outline *out);

#endif
