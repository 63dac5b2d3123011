/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Reading what curve_write.c has written. Not installed. */
#ifndef TZ_CURVES_CURVE_OWN_INTERNAL_H
#define TZ_CURVES_CURVE_OWN_INTERNAL_H

#include "curves/curve.h"
#include "elements/element_svg_internal.h"

/** @param text  of the document
 * @param[out] out  the set, to the bit, where nobody has changed the document
 * @param[out] own  false: it has been changed, read it as a drawing; *out is then empty
 * @return TZ_OK; TZ_FORMAT; TZ_NOMEM */
tz_status tz_curve_read_own(tz_element_reader *r, const char *text, tz_curve_set *out,
                            bool *own);

#endif
