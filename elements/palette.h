/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Palettes: one drawing that holds many exemplars, as text that says which of them go
 * into a layout, how large and where. */
#ifndef TZ_ELEMENTS_PALETTE_H
#define TZ_ELEMENTS_PALETTE_H

#include "elements/growth.h"

typedef TZ_ARRAY(tz_growth_texture)
tz_palette;

/** Textures from text: one for each part between semicolons, words in any order,
 *   "frame=0,0,480,480 scale=0.5 zone=1 kinds=leaf,stone; frame=480,0,960,480 zone=2"
 * frame: corners of the exemplar in the drawing (all of it where missing); scale of its
 * copies; zone: the n-th colour that the zones' table names; kinds: the selection.
 * @param set  whose kinds are named
 * @param[out] p  zeroed before; free with tz_array_free(ctx, p)
 * @return TZ_OK; TZ_INVALID (names the word); TZ_LIMIT (over 64 textures); TZ_NOMEM */
TZ_API tz_status tz_palette_parse(tz_ctx *ctx, const char *text,
                                  const tz_element_set *set, tz_palette *p);

#endif
