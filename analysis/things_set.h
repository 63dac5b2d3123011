/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Things as a set of elements. Private to analysis/. */
#ifndef TZ_ANALYSIS_THINGS_SET_H
#define TZ_ANALYSIS_THINGS_SET_H

#include "analysis/things_outline.h"
#include "base/image.h"
#include "elements/element.h"

/** A thing as it has been found. */
typedef struct tz_things_found {
    tz_things_outline outline; /**< dense */
    tz_vec2 at;                /**< centre of the circle that holds it, hidden part too */
    double radius;
    int32_t depth;    /**< 0, 1, 2, ...: higher lies above */
    double sure;      /**< 0..1, see things_score.h */
    double hidden;    /**< share of it that others are estimated to hide */
    double solid;     /**< its area over that of its convex hull */
    double area;      /**< px */
    bool frame;       /**< the photo's border cuts it */
    double colour[3]; /**< mean, see things_ground.h */
    bool like_ground; /**< its colour is likelier the ground's than the things' */
    bool cut;         /**< by the border, covered or doubtful: never copied */
} tz_things_found;

/** One element and symbol a thing, in the order of `found`.
 * @param label    width * height
 * @param classes  wanted; 0 = automatic
 * @param[out] s   overwritten; zeroed on error */
tz_status tz_things_make_set(tz_ctx *ctx, const tz_image *photo, const int32_t *label,
                             const tz_things_found *found, int32_t count, int32_t classes,
                             tz_element_set *s);

#endif
