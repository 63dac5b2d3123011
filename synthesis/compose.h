/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Compositing: layout + source pixels -> pixels of any crop. Every pixel shows a source
 * pixel under its topmost placement's map, plus a smooth gradient-domain correction.
 * @source [Kim21] Sec. 5.2. Deviates: one screened Poisson solve on a coarse grid for all
 *   placements at once in place of one seamless clone each, because that is linear in
 *   pixels, flat in placements, and cannot drift; see compose.c */
#ifndef TZ_SYNTHESIS_COMPOSE_H
#define TZ_SYNTHESIS_COMPOSE_H

#include "base/image.h"
#include "base/image_io.h"
#include "base/param.h"
#include "synthesis/layout.h"

typedef enum tz_clone { TZ_CLONE_SCREENED, TZ_CLONE_NONE, TZ_CLONE_OPENCV } tz_clone;

/** Table: tz_compose_param_table. */
typedef struct tz_compose_params {
    tz_rect crop;  /**< layout px; w = 0: all */
    int32_t clone; /**< tz_clone */
    double decay;  /**< px over which a seam's correction fades */
} tz_compose_params;
TZ_API extern const tz_param_table tz_compose_param_table;

/** What a map's numbers are. */
typedef enum tz_map_kind {
    TZ_MAP_COLOUR, /**< sRGB or linear colour */
    TZ_MAP_NORMAL, /**< tangent-space normals, 0.5 + 0.5 n: turned with their placement,
                        renormalised */
    TZ_MAP_DATA    /**< height, roughness, ...: never colour-converted, range kept */
} tz_map_kind;

/** Prepared renderer of one map of a layout; immutable, used from any thread. */
typedef struct tz_composer tz_composer;

/** @param l       must outlive the composer
 *  @param photos  one image a layout source, of that source's size (or any size with the
 *    same aspect: it is addressed in proportion), all of one channel count; must outlive
 *  @return TZ_OK; TZ_INVALID naming the map and both sizes; TZ_NOMEM */
TZ_API tz_status tz_composer_new(tz_ctx *ctx, const tz_layout *l, const tz_image *photos,
                                 int32_t n, tz_map_kind kind,
                                 const tz_compose_params *params, tz_composer **out);
TZ_API void tz_composer_free(tz_composer *c);
/** Renders layout rectangle r into `out` (r.w x r.h, as many channels as the photos).
 * The bytes do not depend on r, threads or earlier calls: any crop equals that part of the
 * whole. Parallel inside. */
TZ_API tz_status tz_composer_render(tz_ctx *ctx, const tz_composer *c, tz_rect r,
                                    tz_image *out);
/** Farthest that a change of a placement changes pixels outside its border, px: an edited
 * rectangle grown by this much and rendered again equals a new rendering of the whole. */
TZ_API int32_t tz_composer_reach(void);
/** Which placement shows at each pixel of r (ids into layout.place). */
TZ_API tz_status tz_composer_labels(tz_ctx *ctx, const tz_composer *c, tz_rect r,
                                    int32_t *label);
/** Renders r in strips into a sink, within the context's memory budget. */
TZ_API tz_status tz_composer_stream(tz_ctx *ctx, const tz_composer *c, tz_rect r,
                                    tz_image_sink *sink);

#endif
