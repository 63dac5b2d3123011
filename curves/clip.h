/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Curves cut at the border of a rectangle or of a region: what is inside stays. */
#ifndef TZ_CURVES_CLIP_H
#define TZ_CURVES_CLIP_H

#include "curves/curve.h"

/** What is kept: all that holds of it. All zero keeps everything. */
typedef struct tz_curve_window {
    tz_vec2 at, size;        /**< rectangle; size 0, 0 = none */
    const tz_region *region; /**< in the set's coordinates; NULL = none */
    bool outside;            /**< keep what lies outside instead */
} tz_curve_window;

/** The parts of all paths that lie inside, with what they carry; cuts are exact to 1e-6 of
 * the window, and become nodes; what runs along the rectangle's border is inside. Elements stay as a whole where their centres are inside.
 * Domain, pens, photos and background are those of `from`. On a torus copies count where
 * they lie: a path that runs into the window over the border is kept there.
 * @param[out] to  overwritten, not freed; zeroed on error; may have no paths
 * @return TZ_OK; TZ_INVALID (a window without area); TZ_NOMEM; TZ_CANCELLED
 * @cost O(n) by pieces, and by length over the region's finest feature, 1 / 64 of its
 *   shorter side: a line that leaves a region for less may be taken to stay inside */
TZ_API tz_status tz_curve_clip(tz_ctx *ctx, const tz_curve_set *from,
                               const tz_curve_window *window, tz_curve_set *to);

#endif
