/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Which piece of a layout of curves is nearest to a place of the canvas, exactly, for many
 * places at once. Not installed. */
#ifndef TZ_SYNTHESIS_CURVE_NEAR_INTERNAL_H
#define TZ_SYNTHESIS_CURVE_NEAR_INTERNAL_H

#include "synthesis/curve_render_internal.h"

/** A piece as it lies on the canvas, px; on a torus where its first node is in it. */
typedef struct tz_near_piece {
    tz_bezier at;
    int32_t node[2];
    int32_t path;
    double before; /**< length of the path's pieces before it, px */
} tz_near_piece;

/** Short part of a piece, which lies within TZ_NEAR_FLAT of it. */
typedef struct tz_near_chord {
    tz_vec2 p, q;
    int32_t piece;
    float t0, t1;
} tz_near_chord;

#define TZ_NEAR_FLAT 0.1

typedef struct tz_near {
    tz_curve_canvas canvas;
    double reach; /**< px: nothing is found farther off */
    TZ_ARRAY(tz_near_piece)
    piece; /**< one a piece of the set */
    TZ_ARRAY(tz_near_chord)
    chord;
    int32_t *ends; /**< per node: first of its entries in `end`; nodes + 1 */
    int32_t *end;  /**< 2 piece + (1 = its end, 0 = its beginning) */
    double x0, y0; /**< of the grid */
    double cx, cy; /**< size of its cells */
    int32_t nx, ny;
    int64_t *first; /**< nx * ny + 1 */
    int32_t *item;  /**< chords */
} tz_near;

/** @param reach  px, > 0 */
tz_status tz_near_init(tz_ctx *ctx, const tz_curve_set *set,
                       const tz_curve_canvas *canvas, double reach, tz_near *n);
void tz_near_deinit(tz_ctx *ctx, tz_near *n); /**< takes zeroed */

/** What is nearest. */
typedef struct tz_near_place {
    int32_t piece;  /**< -1 = nothing within reach */
    double t, d;    /**< place on it; distance, px */
    tz_vec2 offset; /**< from there to the place asked for */
} tz_near_place;

typedef struct tz_near_few {
    int32_t chord;
} tz_near_few;

typedef struct tz_near_scratch {
    TZ_ARRAY(tz_near_few)
    few;
} tz_near_scratch;

void tz_near_scratch_deinit(tz_ctx *ctx, tz_near_scratch *s);

/** Places x0 + (i + 0.5) spacing, y0 + (j + 0.5) spacing; what it says of one depends on
 * that one alone. On a torus places outside are those inside that they repeat.
 * @param[out] out  nx * ny */
tz_status tz_near_grid(tz_ctx *ctx, const tz_near *n, int64_t x0, int64_t y0,
                       int32_t spacing, int32_t nx, int32_t ny, tz_near_place *out,
                       tz_near_scratch *scratch);

/** For each pixel of rect the nearest path (-1: none within reach), px to it (infinite), and
 * px along it from its beginning (0). NULL = not wanted. */
tz_status tz_near_map(tz_ctx *ctx, const tz_near *near, tz_rect rect, int32_t *id,
                      float *distance, float *along);

#endif
