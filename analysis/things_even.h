/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Evens out how ground changes over a picture. Private to analysis/. */
#ifndef TZ_ANALYSIS_THINGS_EVEN_H
#define TZ_ANALYSIS_THINGS_EVEN_H

#include "base/alloc.h"

enum { TZ_THINGS_EVEN_CHANNELS = 3 };

/** Takes away, where `known` is set, most of what is larger than a cell and far from the
 * middle; ground that is even as it is stays to the bit.
 * @param[in,out] v  width * height * TZ_THINGS_EVEN_CHANNELS
 * @param cell       px, at least 4
 * @cost O(pixels) */
tz_status tz_things_even(tz_ctx *ctx, float *v, const uint8_t *known, int32_t width,
                         int32_t height, int32_t cell);

#endif
