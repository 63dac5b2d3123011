/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Shared by the files that read curves. Not installed. */
#ifndef TZ_CURVES_CURVE_READ_INTERNAL_H
#define TZ_CURVES_CURVE_READ_INTERNAL_H

#include "curves/curve_io.h"
#include "elements/element_svg_internal.h"

/** Centre lines of a filled shape, where it is long and thin, as paths of `to`.
 * @param most  widest stroke that is taken for one, user units
 * @param[out] taken  whether any of it was; else nothing has been added
 * @return TZ_OK; TZ_LIMIT; TZ_NOMEM; TZ_CANCELLED
 * @cost O(pixels) at six pixels across the mean stroke */
tz_status tz_curve_centre_lines(tz_element_reader *r, const tz_part *p, double most,
                                tz_curve_set *to, bool *taken);

#endif
