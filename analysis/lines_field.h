/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * How line-like each pixel is, and where exactly the line runs. Private to analysis/.
 *
 * Ridges come from the Hessian at scales half an octave apart, edges from the structured
 * forest; both leave the same planes, so that all later work is the same for both.
 * @source Steger: An unbiased detector of curvilinear structures, PAMI 1998; Lindeberg:
 *   Edge detection and ridge detection with automatic scale selection, IJCV 1998 */
#ifndef TZ_ANALYSIS_LINES_FIELD_H
#define TZ_ANALYSIS_LINES_FIELD_H

#include "analysis/edges.h"
#include "base/image.h"

/** All planes width * height. map.response is the contrast of a line against the nearer of
 * its sides, in the units of the picture (0 .. 100); of an edge, the forest's response
 * times 100. */
typedef struct tz_line_field {
    tz_edge_map map;
    float *offset; /**< from the pixel's centre along its normal to the line, px */
    float *wide;   /**< of the line, as its scale tells, px */
    bool light;    /**< lines lighter than their sides */
    bool edge;     /**< borders, not ridges */
} tz_line_field;

/** Nothing anywhere. */
tz_status tz_line_field_init(tz_ctx *ctx, tz_line_field *f, int32_t w, int32_t h);
void tz_line_field_deinit(tz_ctx *ctx, tz_line_field *f); /**< takes zeroed */

/** The photo as the search for lines sees it: planes R, G, B (one of a grey photo),
 * encoded, 0 .. 100; NaN is 0, and what cannot be seen mid-grey. */
typedef struct tz_line_picture {
    int32_t width, height, channels;
    float *v; /**< channels planes */
    tz_ctx *ctx;
} tz_line_picture;

/** @param shift  the photo is halved that often, by means of 2 x 2 px */
tz_status tz_line_picture_init(tz_ctx *ctx, const tz_image *photo, int32_t shift,
                               tz_line_picture *out);
void tz_line_picture_deinit(tz_line_picture *p); /**< takes zeroed */

/** Lines darker and lines lighter than their sides, of a plane.
 * @param width     least and largest, px
 * @param tones     1 dark, 2 light, 3 both
 * @param[out] out  dark, light; zeroed on error, and what was not asked for
 * @cost O(pixels * scales), in parallel by rows */
tz_status tz_line_ridges(tz_ctx *ctx, float *plane, int32_t w, int32_t h,
                         const double width[2], int tones, tz_line_field out[2]);

/** Strengths become those along the line (lines_along.c). */
tz_status tz_line_along(tz_ctx *ctx, tz_line_field *f);

/** Marks what lines run through (lines_crest.c): map.on.
 * @param least  strength  @param hole  px in one place that no line runs around */
tz_status tz_line_crest(tz_line_field *f, double least, int32_t hole);

/** Borders between what differs, by the forest. @param photo of w x h */
tz_status tz_line_edges(tz_ctx *ctx, const tz_image *photo, const char *model,
                        tz_line_field *out);

#endif
