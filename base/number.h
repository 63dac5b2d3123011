/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Numbers as text, independent of the locale (the viewer's toolkit sets one, and then
 * strtod and printf take a comma for a point) and exact in both directions. */
#ifndef TZ_BASE_NUMBER_H
#define TZ_BASE_NUMBER_H

#include <stdbool.h>

#include "base/export.h"

/** Longest decimal number at the start of `text`: optional sign, digits, point, exponent;
 * no blanks before it, no "inf", "nan" or hexadecimal.
 * @param[out] end  behind the number  @return false if there is none or it overflows */
TZ_API bool tz_number_parse(const char *text, const char **end, double *out);

/** Shortest decimal that reads back to v; text needs 32 bytes. */
TZ_API void tz_number_format(double v, char *text);

#endif
