/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Painting element fields from a drawing: each path is a stroke of a brush of
 * fields/fill.h, in drawing order, so that edits can be written down and done again.
 *
 *   tz:class or colour   tool
 *   erase    red         takes things away whose centres lie under the stroke
 *   relax    blue        settles what lies about it, and takes nothing away
 *   replace  magenta     erases, then adds
 *   add      any other   puts new things between those that are there, along the stroke
 *
 * A stroke may say more, in its tz:class, its label in Inkscape or the tz:class of its
 * group: op=add (the tool), entry=leaf (a class or symbol of the palette that is added, not
 * the whole mix), size=1.5 (of what is added, against the palette).
 * @source [Hsu20] Sec. Brush operations */
#ifndef TZ_FIELDS_FILL_PAINT_H
#define TZ_FIELDS_FILL_PAINT_H

#include "fields/fill.h"

typedef enum tz_fill_tool {
    TZ_FILL_ADD,
    TZ_FILL_ERASE,
    TZ_FILL_REPLACE,
    TZ_FILL_RELAX
} tz_fill_tool;

enum { TZ_FILL_NAME = 64 };

typedef struct tz_fill_stroke {
    tz_fill_tool tool;
    int32_t point, points;    /**< tz_fill_paint.point */
    double radius;            /**< user units, > 0 */
    double size;              /**< 0 = not said: 1, or that of the field */
    char entry[TZ_FILL_NAME]; /**< class or symbol; "" = the mix */
    int32_t line;             /**< of the drawing */
} tz_fill_stroke;

typedef struct tz_fill_paint {
    TZ_ARRAY(tz_fill_stroke)
    stroke;
    TZ_ARRAY(tz_vec2)
    point;
    tz_ctx *ctx;
} tz_fill_paint;

/** Reads strokes; the drawing's view is stretched over the domain.
 * @param radius   of all strokes, user units; 0 = half of each one's width
 * @param[out] p   overwritten; zeroed on error
 * @return TZ_OK; TZ_IO; TZ_FORMAT; TZ_INVALID (no strokes in view; a word that is unknown
 *   or out of range, names file and line); TZ_LIMIT (over 100,000 points); TZ_NOMEM */
TZ_API tz_status tz_fill_paint_read(tz_ctx *ctx, const char *path, tz_vec3 size,
                                    double radius, tz_fill_paint *p);
TZ_API void tz_fill_paint_deinit(tz_fill_paint *p); /**< takes zeroed */
/** What is painted points along its stroke, and has its size: they are added to a field,
 * which is to be settled again afterwards.
 * @return TZ_OK; TZ_INVALID; TZ_LIMIT; TZ_NOMEM */
TZ_API tz_status tz_fill_paint_say(const tz_fill_paint *p, tz_element_field *field);
/** Paints all strokes; what each touched settles before the next, the rest is held. What
 * is erased stays empty.
 * @param iterations  of settling, a stroke
 * @return TZ_OK; TZ_INVALID (the mix has none of that name); TZ_NOMEM; TZ_CANCELLED (the
 *   fill stays whole)
 * @cost O(things about the stroke) iterations each, and a look at all things */
TZ_API tz_status tz_fill_paint_apply(const tz_fill_paint *p, tz_fill *f,
                                     int32_t iterations);

#endif
