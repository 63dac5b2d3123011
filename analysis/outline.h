/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Label maps to outlines along pixel corners, and back. Private to analysis/. */
#ifndef TZ_ANALYSIS_OUTLINE_H
#define TZ_ANALYSIS_OUTLINE_H

#include "base/geom.h"
#include "base/svg.h"

typedef TZ_ARRAY(char)
tz_outline_text;

/** Appends label `id`'s outline as path data with integer coordinates ("M3 4h5v1h-5z"),
 * one subpath a loop, holes too; even-odd filling gives back its pixels. Zero-terminated.
 * @param box   holds all pixels of the label
 * @param seen  width * height, zero where no outline has passed a pixel's upper side;
 *              the same array serves all labels of a map */
tz_status tz_outline_trace(tz_ctx *ctx, const int32_t *label, int32_t width,
                           int32_t height, int32_t id, tz_rect box, uint8_t *seen,
                           tz_outline_text *out);

/** One vertical pixel side of an outline. */
typedef struct tz_outline_side {
    int32_t y, x;
} tz_outline_side;

typedef TZ_ARRAY(tz_outline_side)
tz_outline_sides;

/** Vertical sides of a path that runs along pixel corners, sorted by y, then x.
 * @param limit  more sides than this are TZ_FORMAT
 * @return TZ_OK; TZ_FORMAT with *why set (curves, slanted lines, corners off the grid or
 *   outside width x height); TZ_NOMEM; *out replaced */
tz_status tz_outline_read(tz_ctx *ctx, const tz_svg_path *path, int32_t width,
                          int32_t height, int64_t limit, tz_outline_sides *out,
                          const char **why);

/** Pixels inside by the even-odd rule. */
int64_t tz_outline_area(const tz_outline_sides *sides);

/** Gives the pixels inside the label `id`; false if one has a label (>= 0) already. */
bool tz_outline_fill(const tz_outline_sides *sides, int32_t width, int32_t id,
                     int32_t *label);

#endif
