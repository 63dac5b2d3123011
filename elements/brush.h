/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Brushes: growth led by hand. A tool names what shall happen under it; tz_growth_step
 * then does the work, as much at a time as its budget allows, and the output may be read,
 * and drawn, between any two calls.
 *
 *   tz_brush_begin(ctx, palette, textures, n, &params, &layout, &g);
 *   on each movement of the hand:  tz_brush_paint(g, at, radius, texture);
 *   on each picture:               tz_growth_step(g, 200, &more);
 *   at the end:                    tz_growth_end(g);
 *
 * All tools work on any growth, also on one that has filled its domain. Elements that are
 * fixed are left alone. Calls are serial; the same calls give the same output.
 * @source [Dav19] Sec. 5.4: generative brush, filler tool, eraser */
#ifndef TZ_ELEMENTS_BRUSH_H
#define TZ_ELEMENTS_BRUSH_H

#include "elements/growth.h"

/** As tz_growth_begin_palette, but nothing is grown until a tool asks for it. What the
 * output holds is kept, and what is painted grows on from it. */
TZ_API tz_status tz_brush_begin(tz_ctx *ctx, const tz_element_set *palette,
                                const tz_growth_texture *texture, int32_t n,
                                const tz_growth_params *params, tz_element_set *output,
                                tz_growth **growth);
/** Generative brush: a texture may grow within `radius` of a place, around what is there;
 * where nothing is near it starts at the place.
 * @param at  user units; on a torus wrapped
 * @return TZ_OK; TZ_INVALID (no such texture, a radius that is not positive); TZ_NOMEM
 * @cost O(elements within radius) */
TZ_API tz_status tz_brush_paint(tz_growth *g, tz_vec2 at, double radius, int32_t texture);
/** Filler: the empty room around a place, as far as it reaches between the elements that
 * enclose it, grows full from them.
 * @param[out] area  NULL, or area of that room, user units squared; 0 = no room there
 * @return as tz_brush_paint
 * @cost O(room + elements) */
TZ_API tz_status tz_brush_fill(tz_growth *g, tz_vec2 at, int32_t texture, double *area);
/** Eraser: removes elements whose centres lie within `radius`. Nothing grows there again
 * until a tool asks for it. Elements of the output get other indices.
 * @param[out] removed  NULL, or how many
 * @cost O(elements) where any is removed */
TZ_API tz_status tz_brush_erase(tz_growth *g, tz_vec2 at, double radius,
                                int32_t *removed);
/** Relaxing brush: one round of optimisation of the elements within `radius`, at once.
 * @cost O(elements within radius) */
TZ_API tz_status tz_brush_relax(tz_growth *g, tz_vec2 at, double radius);
/** Gives up what has been asked for and is not done; the output stays as it is. */
TZ_API void tz_brush_stop(tz_growth *g);

#endif
