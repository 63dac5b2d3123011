/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Ground and things in one: a layout of edge groups (synthesis/compose.h) under a layout
 * of elements (synthesis/element_render.h), of one map of a material. */
#ifndef TZ_SYNTHESIS_ELEMENT_COMPOSE_H
#define TZ_SYNTHESIS_ELEMENT_COMPOSE_H

#include "synthesis/element_render.h"

/** What lies beneath the elements. */
typedef struct tz_element_ground {
    const tz_layout *layout; /**< of the canvas' proportions, in which it is shown;
                                  NULL = nothing lies beneath */
    const tz_image *photos;  /**< of this map, one a source of the layout */
    int32_t n;
    const tz_compose_params *params; /**< NULL = defaults */
} tz_element_ground;

/** Immutable, used from any thread. */
typedef struct tz_element_composer tz_element_composer;

/** @param ground  NULL = nothing lies beneath; what it points to must outlive the composer
 *  @param set, photos, kind, params  as of tz_element_renderer_new
 *  @return as tz_composer_new and tz_element_renderer_new; TZ_INVALID where the ground has
 *    other proportions or channels */
TZ_API tz_status tz_element_composer_new(tz_ctx *ctx, const tz_element_ground *ground,
                                         const tz_element_set *set,
                                         const tz_element_pixels *photos,
                                         tz_map_kind kind,
                                         const tz_element_render_params *params,
                                         tz_element_composer **out);
TZ_API void tz_element_composer_free(tz_element_composer *c); /**< takes NULL */
TZ_API void tz_element_composer_size(const tz_element_composer *c, int32_t *width,
                                     int32_t *height);
/** Image of a size that tz_element_composer_render takes: zeros, with channels, names,
 * alpha and encoding. With nothing beneath it has alpha. Free with tz_image_deinit. */
TZ_API tz_status tz_element_composer_image(tz_ctx *ctx, const tz_element_composer *c,
                                           int32_t width, int32_t height, tz_image *im);
/** The part that shows elements: for tz_element_renderer_map. */
TZ_API const tz_element_renderer *
tz_element_composer_renderer(const tz_element_composer *c);
/** Renders rect into `out`, all of it overwritten. Any crop equals that part of the
 * whole. Adds 2 rect.w rect.h px to the running stage of progress with a ground, else
 * once. */
TZ_API tz_status tz_element_composer_render(tz_ctx *ctx, const tz_element_composer *c,
                                            tz_rect rect, tz_image *out);
/** Renders rect in strips into a sink, within the context's memory budget. */
TZ_API tz_status tz_element_composer_stream(tz_ctx *ctx, const tz_element_composer *c,
                                            tz_rect rect, tz_image_sink *sink);

#endif
