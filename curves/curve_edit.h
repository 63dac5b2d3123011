/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Putting curve sets together: choosing, moving and adding paths and elements, and welding
 * loose ends to what they meet. */
#ifndef TZ_CURVES_CURVE_EDIT_H
#define TZ_CURVES_CURVE_EDIT_H

#include "curves/curve.h"

/** Some paths and elements of a set.
 * @param path     from->path.n flags; NULL = all
 * @param element  from->element.element.n flags; NULL = all
 * @param domain   of the result; NULL = that of `from`
 * @param shift    added to all places
 * @param[out] to  overwritten, not freed; zeroed on error; recipe: none
 * @return TZ_OK; TZ_NOMEM  @cost O(from) */
TZ_API tz_status tz_curve_choose(tz_ctx *ctx, const tz_curve_set *from,
                                 const uint8_t *path, const uint8_t *element,
                                 const tz_domain *domain, tz_vec2 shift,
                                 tz_curve_set *to);

/** Adds paths and elements behind those of `to`; pens are found again by what they are.
 * Where only one of the two has tapers or origins the other's pieces are given those of
 * their pens, and none.
 * @param[in,out] to  unchanged on error
 * @return TZ_OK; TZ_INVALID (elements of other kinds or symbols); TZ_NOMEM
 * @cost O(to + from) */
TZ_API tz_status tz_curve_append(tz_ctx *ctx, tz_curve_set *to, const tz_curve_set *from);

/** Joins loose ends of the paths from `first` on with earlier paths: an end moves onto the
 * nearest node within reach, else onto the nearest place of a piece, which is cut there.
 * Nothing else changes.
 * @param reach    user units, >= 0; 0 = only what lies on one spot
 * @param[in,out] s  unchanged on error
 * @param[out] joined  NULL, or how many ends were joined
 * @return TZ_OK; TZ_NOMEM  @cost O(n) for what is spread over the domain */
TZ_API tz_status tz_curve_weld(tz_ctx *ctx, tz_curve_set *s, int32_t first, double reach,
                               int32_t *joined);

/** Distance of a place to the nearest one of a cubic. @param[out] t  of that */
TZ_API double tz_bezier_nearest(const tz_bezier *c, tz_vec2 p, double *t);

#endif
