/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Painting from a drawing: each path is a stroke of a tool of elements/brush.h, in drawing
 * order.
 *
 *   tz:class or colour   tool
 *   erase   red          removes elements under the stroke
 *   relax   blue         moves elements under it into better places
 *   fill    green        fills the empty room at the stroke's first point
 *   grow    any other    grows elements under it
 * @source [Dav19] Sec. 5.4 */
#ifndef TZ_ELEMENTS_PAINT_H
#define TZ_ELEMENTS_PAINT_H

#include "elements/brush.h"

typedef enum tz_paint_tool {
    TZ_PAINT_GROW,
    TZ_PAINT_ERASE,
    TZ_PAINT_RELAX,
    TZ_PAINT_FILL
} tz_paint_tool;

typedef struct tz_paint_stroke {
    tz_paint_tool tool;
    int32_t point,
        points;    /**< tz_paint.point: places along it, at most half a radius apart
                            */
    double radius; /**< user units of the domain */
} tz_paint_stroke;

typedef struct tz_paint {
    TZ_ARRAY(tz_paint_stroke)
    stroke;
    TZ_ARRAY(tz_vec2)
    point;
    tz_ctx *ctx;
} tz_paint;

/** Reads strokes; the drawing's view is stretched over the domain.
 * @param radius   of all strokes, user units of the domain; 0 = half of each one's width,
 *                 at least `least`
 * @param[out] p   overwritten; zeroed on error
 * @return TZ_OK; TZ_IO; TZ_FORMAT; TZ_INVALID (no strokes in it, names the file);
 *   TZ_LIMIT (over a million places); TZ_NOMEM */
TZ_API tz_status tz_paint_read(tz_ctx *ctx, const char *path, tz_vec3 size, double radius,
                               double least, tz_paint *p);
TZ_API void tz_paint_deinit(tz_paint *p); /**< takes zeroed */
/** Paints all strokes, growing what each asks for before the next. Places outside the
 * domain do nothing.
 * @param texture  that the strokes grow
 * @return TZ_OK; TZ_INVALID; TZ_NOMEM; TZ_CANCELLED (the output is whole) */
TZ_API tz_status tz_paint_apply(const tz_paint *p, tz_growth *g, const tz_domain *domain,
                                int32_t texture);

#endif
