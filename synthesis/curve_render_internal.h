/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Parts of the curve renderer. Not installed.
 *
 *   set ──lines──▶ paths as polylines on the canvas, by squares        curve_lines.c
 *       ──stroke─▶ coverage and colour of a tile                       curve_stroke.c
 *       ──near───▶ nearest piece, place along it, and its frame        curve_near.c
 *       ──strip──▶ where each pixel comes from: line's strip or ground curve_strip.c
 *       ──blend──▶ gradient-domain correction, pixels                  curve_blend.c
 *   rect ◀─render── backdrop, lines, elements                          curve_render.c */
#ifndef TZ_SYNTHESIS_CURVE_RENDER_INTERNAL_H
#define TZ_SYNTHESIS_CURVE_RENDER_INTERNAL_H

#include "synthesis/curve_render.h"
#include "synthesis/element_render_internal.h"

enum { TZ_CURVE_TILE = TZ_ELEMENT_TILE, TZ_CURVE_RUN = 16 };

/* ---- polylines ------------------------------------------------------------------------ */

/** Chords of one path, one behind another, that are looked up together. */
typedef struct tz_curve_run {
    int32_t path;
    int32_t first, chords; /**< within the path */
    tz_bounds box;         /**< canvas px of all that they paint */
} tz_curve_run;

/** A path as it is stroked, canvas px. Chord i runs from point i to i + 1; a closed path's
 * last point is its first one, on a torus perhaps that of another turn. */
typedef struct tz_curve_stroke {
    int64_t point; /**< tz_curve_lines.at */
    int32_t chords;
    bool closed;
    tz_vec2 turn; /**< of a closed path: from its first point to its last */
    tz_pen pen;
    tz_f4 colour; /**< premultiplied, linear */
} tz_curve_stroke;

/** A run where it shows. */
typedef struct tz_curve_item {
    int32_t run;
    int16_t kx, ky; /**< of a torus: moved by so many canvases */
} tz_curve_item;

typedef struct tz_curve_lines {
    TZ_ARRAY(tz_vec2)
    at;
    TZ_ARRAY(float)
    half; /**< half the width there */
    TZ_ARRAY(bool)
    smooth;
    TZ_ARRAY(tz_curve_stroke)
    line; /**< one a path */
    TZ_ARRAY(tz_curve_run)
    run;
    int32_t nx, ny; /**< squares of TZ_CURVE_TILE px times cell */
    int32_t cell;
    int64_t *first; /**< nx * ny + 1 */
    tz_curve_item *item;
} tz_curve_lines;

/** Canvas of a set. */
typedef struct tz_curve_canvas {
    int32_t width, height;
    double sx, sy; /**< px a unit */
    bool torus;
} tz_curve_canvas;

/** @param width  factor of widths */
tz_status tz_curve_lines_init(tz_ctx *ctx, const tz_curve_set *set,
                              const tz_curve_canvas *canvas, double width,
                              tz_curve_lines *l);
void tz_curve_lines_deinit(tz_ctx *ctx, tz_curve_lines *l); /**< takes zeroed */

/** Scratch of a worker. */
typedef struct tz_curve_stroke_work {
    tz_layer layer;
    tz_cover cover;
    float *row;
    TZ_ARRAY(tz_vec2)
    at;
    TZ_ARRAY(float)
    half;
    TZ_ARRAY(bool)
    smooth;
} tz_curve_stroke_work;

tz_status tz_curve_stroke_work_init(tz_ctx *ctx, tz_curve_stroke_work *w);
void tz_curve_stroke_work_deinit(tz_ctx *ctx, tz_curve_stroke_work *w);
/** Strokes all lines of a tile onto w->layer, which it clears first.
 * @param[out] any  false: nothing shows, the layer is not cleared */
tz_status tz_curve_stroke_tile(tz_ctx *ctx, const tz_curve_lines *l,
                               const tz_curve_canvas *canvas, tz_rect tile,
                               tz_curve_stroke_work *w, bool *any);

#endif
