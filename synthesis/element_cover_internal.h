/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Exact area coverage of polygons on a block of pixels, and pens that turn lines into
 * polygons. Private to the element renderer.
 * @source Levien: font-rs, signed-area accumulation, 2016; FreeType's smooth rasteriser
 *   (the same areas by cells) */
#ifndef TZ_SYNTHESIS_ELEMENT_COVER_INTERNAL_H
#define TZ_SYNTHESIS_ELEMENT_COVER_INTERNAL_H

#include "base/alloc.h"
#include "base/geom.h"

/** Winding numbers, averaged over pixels: kept as differences along each row. Edges may be
 * added in any order; each polygon must be closed by its caller. */
typedef struct tz_cover {
    int32_t width, height;
    float *sum;     /**< (width + 2) a row, zero when nothing is in it */
    int32_t *first; /**< per row: first and last column that was written; first > last */
    int32_t *last;  /**< where the row is empty */
    int32_t top, bottom; /**< rows that were written: top .. bottom */
} tz_cover;

tz_status tz_cover_init(tz_ctx *ctx, tz_cover *c, int32_t width, int32_t height);
void tz_cover_deinit(tz_ctx *ctx, tz_cover *c); /**< takes zeroed */
/** Adds an edge, in pixels of the block; what lies outside is clipped. Not finite: left
 * out. */
void tz_cover_edge(tz_cover *c, tz_vec2 p, tz_vec2 q);
/** Adds all edges of a closed polygon of n points. */
void tz_cover_polygon(tz_cover *c, const tz_vec2 *p, int32_t n);
/** Takes out row y: coverage 0..1 of columns *from .. *to - 1 into out[*from ...]; the row
 * is empty after that.
 * @param out  width floats  @return false where the row shows nothing */
bool tz_cover_take(tz_cover *c, int32_t y, bool even_odd, float *out, int32_t *from,
                   int32_t *to);
/** Makes the block ready for the next shape after its rows were taken. */
void tz_cover_reset(tz_cover *c);

/** How a line is drawn. */
typedef struct tz_pen {
    double width; /**< > 0, px */
    int cap;      /**< 0 butt, 1 round, 2 square */
    int join;     /**< 0 miter, 1 round, 2 bevel */
    double miter; /**< limit, >= 1 */
} tz_pen;

/** Adds a stroked line: to be taken with the nonzero rule.
 * @param smooth  one a point: lies within a curve, joined round; NULL = none does */
void tz_cover_stroke(tz_cover *c, const tz_vec2 *p, const bool *smooth, int32_t n,
                     bool closed, const tz_pen *pen);
/** The same of a line whose width changes. @param half  half the width at each point, px,
 * > 0; NULL = that of the pen */
void tz_cover_taper(tz_cover *c, const tz_vec2 *p, const bool *smooth, const float *half,
                    int32_t n, bool closed, const tz_pen *pen);
/** The cap alone at the end *p of a line, whose other points are p[step], p[2 step], ... */
void tz_cover_cap(tz_cover *c, const tz_vec2 *p, int32_t n, int step, double half,
                  const tz_pen *pen);

#endif
