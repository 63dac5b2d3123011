/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Layouts of curves -> pixels: strokes of their pens, and lines in the pixels of the photo
 * that they were found in.
 *
 * The domain is shown on a canvas of width x height px: size times params.scale, rounded.
 * Any crop equals that part of the whole, bit for bit, at any thread count; on a torus what
 * reaches over a border comes in again on the other side.
 *
 * From a photo: each piece of a layout carries its origin, a curve of the photo (a set
 * without origins is an exemplar: its pieces are their own). What lies about that curve is
 * carried along to the layout's piece: place along and distance across stay what they were.
 * Each pixel belongs to the nearest line; where that would show another line of the photo,
 * or nothing of it, the ground (the plate arranged, synthesis/element_ground.h) shows, or
 * without a ground the line's strip all the same. Seams are blended in the gradient domain,
 * as the compositor does. Of an exemplar drawn where it is the result is the photo, but for
 * its finest contrast where the scale is not 1.
 *
 * Strokes: one path is one shape, of its pen's colour; lines that come later lie above.
 * Blended in linear light, as elements are.
 * @source Hertzmann et al.: Curve analogies, 2002; Fang, Hart: Textureshop's distance
 *   parametrisation, 2004; synthesis/compose.h for the blend */
#ifndef TZ_SYNTHESIS_CURVE_RENDER_H
#define TZ_SYNTHESIS_CURVE_RENDER_H

#include "curves/curve.h"
#include "synthesis/element_compose.h"

/** Table: tz_curve_render_param_table. */
typedef struct tz_curve_render_params {
    double scale;   /**< px of the canvas a user unit; 0 = 1. Not in the table: commands
                         have one resolution for all that they draw */
    int32_t source; /**< 0 automatic: the photo where there is one; 1 strokes; 2 photo */
    double strip; /**< photo px to either side of a line that it carries along, over half
                          its width; < 0 = automatic: up to half a cell */
    double width; /**< widths of strokes are multiplied by this */
} tz_curve_render_params;
TZ_API extern const tz_param_table tz_curve_render_param_table;

/** Immutable, used from any thread. */
typedef struct tz_curve_composer tz_curve_composer;

/** @param ground  NULL = nothing lies beneath: strokes on the set's background, or
 *    transparent. With it, the set's own background does not show
 *    Strokes without a ground have 3 channels on an opaque background, else 4; the photo
 *    has its own channels, with alpha where nothing lies beneath
 *  @param set     must outlive the composer; its discrete elements are drawn above
 *  @param photo   NULL, or the pixels of photo 0 of set->element
 *  @param kind    colour, normals (turned with the line), or data
 *  @return TZ_OK; TZ_INVALID (names what does not fit); TZ_LIMIT; TZ_NOMEM
 *  @cost linear in the set's pieces; of a photo also in its pixels */
TZ_API tz_status tz_curve_composer_new(tz_ctx *ctx, const tz_element_ground *ground,
                                       const tz_curve_set *set,
                                       const tz_element_pixels *photo, tz_map_kind kind,
                                       const tz_curve_render_params *params,
                                       tz_curve_composer **out);
TZ_API void tz_curve_composer_free(tz_curve_composer *c); /**< takes NULL */
TZ_API void tz_curve_composer_size(const tz_curve_composer *c, int32_t *width,
                                   int32_t *height);
/** Image of a size that tz_curve_composer_render takes: zeros, with channels, names, alpha
 * and encoding. Free with tz_image_deinit. */
TZ_API tz_status tz_curve_composer_image(tz_ctx *ctx, const tz_curve_composer *c,
                                         int32_t width, int32_t height, tz_image *im);
/** Renders rect into `out`, all of it overwritten. */
TZ_API tz_status tz_curve_composer_render(tz_ctx *ctx, const tz_curve_composer *c,
                                          tz_rect rect, tz_image *out);
/** Renders rect in strips into a sink, within the context's memory budget. */
TZ_API tz_status tz_curve_composer_stream(tz_ctx *ctx, const tz_curve_composer *c,
                                          tz_rect rect, tz_image_sink *sink);
/** Where pixels lie: which path is nearest, the distance to its middle, and the length of
 * it up to there, both px of the canvas. Discrete elements do not count.
 * @param[out] id, distance, along  rect.w * rect.h each, NULL = not wanted; id -1, distance
 *   infinite, along 0 where no path is within 100,000 px
 * @cost linear in pieces and pixels */
TZ_API tz_status tz_curve_composer_map(tz_ctx *ctx, const tz_curve_composer *c,
                                       tz_rect rect, int32_t *id, float *distance,
                                       float *along);

#endif
