/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Ramps: elements of a layout coloured by a number of each.
 *
 * An element gets a symbol of its own colour: that of the palette with its main colour (the
 * first that it paints) replaced by the ramp's, and its other colours as much lighter or
 * darker than that as they were before. So a layout stays a plain SVG, and renders as any
 * other. */
#ifndef TZ_FIELDS_RAMP_H
#define TZ_FIELDS_RAMP_H

#include "elements/element.h"

enum { TZ_RAMP_STOPS = 64, TZ_RAMP_STEPS = 24 /**< colours a symbol gets, at most */ };

typedef struct tz_ramp {
    int32_t n; /**< stops, evenly spaced */
    uint8_t stop[TZ_RAMP_STOPS][3];
    bool closed; /**< its last stop is followed by the first: for angles */
} tz_ramp;

/** @param text  viridis, magma, grey, hue (closed), or colours: "#123,#abcdef,gold"
 * @return TZ_OK; TZ_INVALID (names the colour) */
TZ_API tz_status tz_ramp_parse(tz_ctx *ctx, const char *text, tz_ramp *ramp);
/** @param t  0 .. 1; beyond, the ends' (closed: repeats) */
TZ_API void tz_ramp_at(const tz_ramp *ramp, double t, uint8_t rgb[3]);
/** Whether a ramp can colour a palette's things.
 * @return TZ_OK; TZ_UNSUPPORTED (they were cut out of a photo) */
TZ_API tz_status tz_ramp_check(const tz_element_set *palette);
/** Colours all elements.
 * @param value  of each element, 0 .. 1; NaN keeps the palette's colours
 * @return TZ_OK; TZ_UNSUPPORTED (things that were cut out of a photo); TZ_NOMEM
 * @cost O(elements + symbols * TZ_RAMP_STEPS) */
TZ_API tz_status tz_ramp_paint(const tz_ramp *ramp, tz_element_set *layout,
                               const double *value);
/** Gives elements back the palette's symbols, so that a coloured layout can be worked on.
 * @return whether all symbols are the palette's, coloured or not; if not, nothing changes */
TZ_API bool tz_ramp_strip(tz_element_set *layout, const tz_element_set *palette);

#endif
