/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Layouts of elements -> pixels: drawings at any resolution, things cut from photos with
 * soft borders and the shadows that they stand in, and pictures of what shows where.
 *
 *   set, photos ──new──▶ renderer ──render──▶ colour or a map of a material, over a backdrop
 *                                 ──map─────▶ which element, class, angle, source place
 *
 * The domain is shown on a canvas of width x height px: size times params.scale, rounded.
 * Pictures are made in canvas tiles of TZ_ELEMENT_TILE px, always whole, so that any crop
 * equals that part of the whole, bit for bit, at any thread count. Elements lie above each
 * other by depth, those of one depth by index. Void kinds are not drawn. Elements of three
 * samples and more show bent where these do not lie as in their symbol by 1/20 of its
 * radius and more (elements/bend.h); what cannot be bent (see tz_bend_markup) shows plain. On a torus what
 * reaches over a border comes in again on the other side.
 * @source Porter, Duff: Compositing digital images, SIGGRAPH 1984; [Dav19] Sec. 4 */
#ifndef TZ_SYNTHESIS_ELEMENT_RENDER_H
#define TZ_SYNTHESIS_ELEMENT_RENDER_H

#include "base/image_io.h"
#include "base/param.h"
#include "elements/element.h"
#include "synthesis/compose.h"

#define TZ_ELEMENT_TILE 256

/** Table: tz_element_render_param_table. */
typedef struct tz_element_render_params {
    double scale;  /**< px of the canvas a user unit, > 0 */
    double shadow; /**< photo px about a cut-out in which its shadow is kept, 0 = none */
    double matte;  /**< photo px to either side of an outline where its border is sought
                           in the photo; 0 = the outline itself */
    double harmonise; /**< 0..1: how far the photo's uneven light is evened */
    double
        rim; /**< photo px about a cut-out that it carries along of the ground about it,
                     0 = none; < 0 = automatic: half the usual gap between the photo's
                     things, 1.5 to 8 px, of small things less */
} tz_element_render_params;
TZ_API extern const tz_param_table tz_element_render_param_table;

/** Pixels of one photo of a set. All images must outlive the renderer. */
typedef struct tz_element_pixels {
    const tz_image *photo; /**< colour, of the size in the set: mattes are made from it */
    const tz_image *plate; /**< the same with the things taken out: what is darker in
                                `photo` near a thing is its shadow; NULL = no shadows */
    const tz_image *map;   /**< picture of another map of the material, of the same
                                proportions, shown in place of `photo`; NULL = `photo` */
} tz_element_pixels;

/** Prepared renderer of one map of a layout; immutable, used from any thread. */
typedef struct tz_element_renderer tz_element_renderer;

/** @param set     must outlive the renderer
 *  @param photos  one a photo of the set (set->photo.n; NULL if that is 0 or no visible
 *    element is cut out). What is shown has 1 or 3 colours, with or without alpha
 *  @param kind    colour: blended in linear light, with shadows and evened light; normals:
 *    turned with their element, renormalised; data: numbers as they are. Drawn elements
 *    and the background have colour only: other maps leave them out
 *  @param params  NULL = defaults
 *  @return TZ_OK; TZ_INVALID (names what does not fit); TZ_FORMAT (markup that is no SVG);
 *    TZ_UNSUPPORTED (a symbol needs librsvg, which is not there); TZ_LIMIT; TZ_NOMEM
 *  @cost linear in elements and in the photos' pixels under symbols that are used */
TZ_API tz_status tz_element_renderer_new(tz_ctx *ctx, const tz_element_set *set,
                                         const tz_element_pixels *photos,
                                         tz_map_kind kind,
                                         const tz_element_render_params *params,
                                         tz_element_renderer **out);
TZ_API void tz_element_renderer_free(tz_element_renderer *r); /**< takes NULL */

/** Size of the canvas, px. */
TZ_API void tz_element_renderer_size(const tz_element_renderer *r, int32_t *width,
                                     int32_t *height);
/** Colours of what is shown, without alpha: 1 or 3. */
TZ_API int32_t tz_element_renderer_colours(const tz_element_renderer *r);

/** Draws background and elements over what stands in `pixels`: canvas rectangle `rect`.
 * @param[in,out] pixels  rect.w x rect.h, tz_element_renderer_colours channels or one more
 *   for alpha (the last, straight); colour in linear light or sRGB as its encoding says,
 *   other maps as they are. Zeros with alpha are an empty backdrop. Where nothing is
 *   drawn its bytes stay. On error it is drawn in part.
 * @return TZ_OK; TZ_INVALID (rect not inside the canvas, another size or channel count);
 *   TZ_CANCELLED; TZ_NOMEM; TZ_FORMAT
 * @cost O(tiles of TZ_ELEMENT_TILE px + pixels of visible elements); parallel inside;
 *   about 2 MiB a worker. Adds rect's pixels to the running stage of progress. */
TZ_API tz_status tz_element_renderer_render(tz_ctx *ctx, const tz_element_renderer *r,
                                            tz_rect rect, tz_image *pixels);
/** Renders rect in strips over an empty backdrop (transparent, with alpha) into a sink,
 * within the context's memory budget. */
TZ_API tz_status tz_element_renderer_stream(tz_ctx *ctx, const tz_element_renderer *r,
                                            tz_rect rect, tz_image_sink *sink);
/** Empty image that says what tz_element_renderer_stream writes: channels, names, alpha,
 * encoding. */
TZ_API tz_status tz_element_renderer_like(tz_ctx *ctx, const tz_element_renderer *r,
                                          tz_image *like);

/** What a picture of an arrangement tells at each pixel: of the topmost element that
 * covers it by half or more, 0 where there is none. */
typedef enum tz_element_map {
    TZ_ELEMENT_MAP_ID,    /**< 1 channel: element + 1 (exact up to 2^24) */
    TZ_ELEMENT_MAP_CLASS, /**< 1 channel: kind + 1 */
    TZ_ELEMENT_MAP_ANGLE, /**< 1 channel: angle / 2 pi in [0, 1) of oriented kinds (bent
                               ones: there), else 0 */
    TZ_ELEMENT_MAP_UV     /**< 3 channels: u, v, 1. Cut-outs: place in the photo over its
                               size; drawings: place in the symbol, -radius..radius as 0..1 */
} tz_element_map;
TZ_API int32_t tz_element_map_channels(tz_element_map what);

/** Fills `out` (rect.w x rect.h, tz_element_map_channels channels, all overwritten; its
 * encoding becomes data). The renderer must be one for colour.
 * @return as tz_element_renderer_render */
TZ_API tz_status tz_element_renderer_map(tz_ctx *ctx, const tz_element_renderer *r,
                                         tz_element_map what, tz_rect rect,
                                         tz_image *out);

#endif
