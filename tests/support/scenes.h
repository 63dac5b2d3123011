/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Layouts that tests build by hand, and short ways to render them. Whatever fails ends
 * the running cmocka test. */
#ifndef TZ_TESTS_SUPPORT_SCENES_H
#define TZ_TESTS_SUPPORT_SCENES_H

#include "synthesis/compose.h"

/** Context with so many threads. */
tz_ctx *new_ctx(int threads);

/** Empty layout that knows one source of this size. */
void scene_init(tz_ctx *ctx, tz_layout *l, int32_t width, int32_t height, bool tile,
                int32_t source_width, int32_t source_height);
/** Adds the source's rectangle x0 .. x1, y0 .. y1 under a map. @return id */
int32_t scene_box(tz_layout *l, int32_t source, tz_affine map, double x0, double y0,
                  double x1, double y1);
/** Adds the layout's rectangle r, showing the source under a map: the border is r seen
 * through the map's inverse. @return id */
int32_t scene_window(tz_layout *l, int32_t source, tz_affine map, tz_rect r);
/** Covers the layout with `n` random blobs over one that covers all: turned, scaled,
 * mirrored, each moved by whole pixels with one chance in four. */
void scene_random(tz_layout *l, int32_t n, uint64_t seed);

tz_affine move_by(double x, double y);
/** Turned about `centre` of the source, which comes to lie at `to`. */
tz_affine turned(tz_vec2 centre, tz_vec2 to, double degrees, double scale, bool mirror);

/** Renders r (w = 0: all) of one map; params NULL = defaults. */
tz_image render(tz_ctx *ctx, const tz_layout *l, const tz_image *photos, int32_t n,
                tz_map_kind kind, const tz_compose_params *params, tz_rect r);
/** The same with colour and defaults. */
tz_image render_colour(tz_ctx *ctx, const tz_layout *l, const tz_image *photo, tz_rect r);
/** Parameters with another way of cloning. */
tz_compose_params cloned(tz_clone clone);

#endif
