/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Colours of CSS as 0xrrggbbaa. Not installed. */
#ifndef TZ_ELEMENTS_ELEMENT_COLOR_H
#define TZ_ELEMENTS_ELEMENT_COLOR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** text[0..n-1], without blanks round it; text[n] may be read. False if it is none. */
bool tz_color_parse(const char *text, size_t n, uint32_t *out);
/** "#rrggbb". */
void tz_color_format(uint32_t color, char text[8]);

#endif
