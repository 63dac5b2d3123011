/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Shared by the files of base/svg*.c. Not installed. */
#ifndef TZ_BASE_SVG_INTERNAL_H
#define TZ_BASE_SVG_INTERNAL_H

const char *tz_svg_skip_blank(const char *p);
/** Blanks with at most one comma among them. */
const char *tz_svg_skip_comma(const char *p);

#endif
