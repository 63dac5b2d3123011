/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Small letters for contact sheets: a bitmap font, 5 x 7 dots, printable ASCII. */
#ifndef TZ_CLI_FONT_H
#define TZ_CLI_FONT_H

#include "base/image.h"

#define TZ_FONT_WIDTH  6 /**< px from letter to letter at scale 1 */
#define TZ_FONT_HEIGHT 9 /**< px a line at scale 1, descenders and a gap included */

/** Draws text into all channels; what falls outside is cut. Unknown letters show as '?'.
 * @param x, y   upper left corner, px
 * @param scale  px a dot, >= 1
 * @param value  of every colour channel */
void tz_font_draw(tz_image *im, int32_t x, int32_t y, int32_t scale, float value,
                  const char *text);

#endif
