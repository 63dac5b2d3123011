/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Shared by the files that read curves. Not installed. */
#ifndef TZ_CURVES_CURVE_READ_INTERNAL_H
#define TZ_CURVES_CURVE_READ_INTERNAL_H

#include "curves/curve_io.h"
#include "elements/element_svg_internal.h"

/** Centre lines of a filled shape, where it is long and thin, as paths of `to`.
 * @param most  widest stroke that is taken for one, user units
 * @param[out] taken  whether it was; else nothing has been added
 * @return TZ_OK; TZ_LIMIT; TZ_NOMEM */
tz_status tz_curve_centre_lines(tz_element_reader *r, const tz_part *p, double most,
                                tz_curve_set *to, bool *taken);

/** Appends points as smooth cubics, corners kept.
 * @param p  n >= 2 points, closed where the last is the first again
 * @param tolerance  farthest that a point may lie off */
tz_status tz_curve_fit(tz_curve_set *to, const tz_vec2 *p, int32_t n, double tolerance,
                       int32_t from, int32_t end);

#endif
