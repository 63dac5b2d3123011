/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Shape follows samples: the pose that fits an element's samples best, and a smooth warp
 * of its symbol through all of them.
 * @source Schaefer, McPhail, Warren: Image deformation using moving least squares,
 *   SIGGRAPH 2006 (rigid); [Ma11] Sec. 3.1 (samples as control points), Fig. 13 */
#ifndef TZ_ELEMENTS_BEND_H
#define TZ_ELEMENTS_BEND_H

#include "elements/element.h"

typedef enum tz_shape {
    TZ_SHAPE_RIGID,      /**< moved and turned */
    TZ_SHAPE_SIMILARITY, /**< also scaled, to between half and double */
    TZ_SHAPE_BEND        /**< every sample goes its own way */
} tz_shape;

/** p becomes to + scale * turned by angle (p - from). */
typedef struct tz_pose {
    tz_vec2 from, to;
    double angle, scale;
} tz_pose;

/** Weighted least squares in closed form. One point, or all at one place: angle 0.
 * @param weight  NULL = all 1
 * @param scaled  fits the scale too, else it is 1 */
TZ_API tz_pose tz_pose_fit(int32_t n, const tz_vec2 *from, const tz_vec2 *to,
                           const double *weight, bool scaled);
static inline tz_vec2 tz_pose_apply(tz_pose p, tz_vec2 v)
{
    const double c = cos(p.angle) * p.scale, s = sin(p.angle) * p.scale;
    const double x = v.x - p.from.x, y = v.y - p.from.y;
    return (tz_vec2){p.to.x + c * x - s * y, p.to.y + s * x + c * y};
}

/** Moves, turns and scales element i and its samples to where the pose that fits its
 * samples puts them at rest.
 * @param rest   its samples as they are in the symbol's own coordinates, see tz_bend_rest
 * @param shape  TZ_SHAPE_BEND: samples stay, only the element's own numbers are set */
TZ_API void tz_element_snap(tz_element_set *s, int32_t i, const tz_vec2 *rest,
                            tz_shape shape);

/** Warp of a symbol: from its own coordinates to the world. */
typedef struct tz_bend {
    int32_t n;
    tz_vec2 *rest, *at;  /**< samples: in the symbol's coordinates; in the world */
    double scale, angle; /**< of the element against its symbol */
    double radius;       /**< of the symbol */
    double strain; /**< farthest that a sample lies from the fitted pose, world units */
    tz_ctx *ctx;
} tz_bend;

/** Samples of an unbent element in its symbol's coordinates, as reading an exemplar makes
 * them: evenly along the symbol's middle line.
 * @param samples   how many the element has
 * @param[out] out  room for `samples`
 * @return TZ_OK; TZ_INVALID (the symbol has another number of them); TZ_NOMEM */
TZ_API tz_status tz_bend_rest(tz_ctx *ctx, const tz_element_symbol *symbol,
                              int32_t samples, tz_vec2 *out);
/** @param from  exemplar of the layout s; NULL = the rest of samples is found by
 *               tz_bend_rest
 * @param[out] b  overwritten, zeroed on error; an element that has no warp (one sample, or
 *                another number of samples than at rest) gets one without samples, which
 *                is its plain pose
 * @return TZ_OK; TZ_NOMEM */
TZ_API tz_status tz_bend_init(tz_ctx *ctx, const tz_element_set *s, int32_t i,
                              const tz_element_set *from, tz_bend *b);
/** The same where the rest is known: e->samples points, or NULL for the plain pose. */
TZ_API tz_status tz_bend_from(tz_ctx *ctx, const tz_element_set *s, int32_t i,
                              const tz_vec2 *rest, tz_bend *b);
TZ_API void tz_bend_deinit(tz_bend *b); /**< takes zeroed */
/** Whether the element can be drawn unbent: its strain is below 1/50 of its radius. */
static inline bool tz_bend_is_plain(const tz_bend *b)
{
    return b->n < 2 || b->strain < 0.02 * b->radius * b->scale;
}
/** A place of the symbol in the world. @cost O(samples) */
TZ_API tz_vec2 tz_bend_apply(const tz_bend *b, tz_vec2 p);
/** The place of the symbol that comes to lie here, for pixels. Exact to 1e-4 of the radius
 * where the warp does not fold, within the symbol's circle. */
TZ_API tz_vec2 tz_bend_invert(const tz_bend *b, tz_vec2 p);
/** Path data of the symbol, warped: pieces of at most 1/8 of the radius, whose control
 * points are warped.
 * @param origin   taken off the results, e.g. the element's place
 * @param[out] d   owned by the caller
 * @return TZ_OK; TZ_FORMAT; TZ_NOMEM */
TZ_API tz_status tz_bend_path(const tz_bend *b, const char *data, tz_vec2 origin,
                              char **d);
/** The symbol's markup, warped: paths as above, circles as paths; paint is kept.
 * @return TZ_OK; TZ_UNSUPPORTED (other shapes, transforms: draw it unbent); TZ_NOMEM */
TZ_API tz_status tz_bend_markup(const tz_bend *b, const char *markup, tz_vec2 origin,
                                char **out);

/** Rests of a layout's symbols, each found once: for who draws all of its elements. */
typedef struct tz_bend_rests {
    const tz_element_set *set;
    int32_t *samples; /**< of each symbol: how many it has at rest, 0 = not looked yet */
    tz_vec2 *rest;    /**< TZ_BEND_SAMPLES a symbol */
    tz_ctx *ctx;
} tz_bend_rests;
#define TZ_BEND_SAMPLES 9 /**< that reading lays along a symbol, at most */
TZ_API tz_status tz_bend_rests_init(tz_ctx *ctx, const tz_element_set *s,
                                    tz_bend_rests *r);
TZ_API void tz_bend_rests_deinit(tz_bend_rests *r); /**< takes zeroed */
/** The warp of element i; its plain pose where the symbol's rest does not fit it: another
 * number of samples, another length (by a third) or angle (by 0.6). */
TZ_API tz_status tz_bend_rests_warp(tz_bend_rests *r, int32_t i, tz_bend *b);

#endif
