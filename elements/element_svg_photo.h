/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Photos in documents of ours, read back. Not installed. What stands in the document:
 * element_write_internal.h. */
#ifndef TZ_ELEMENTS_ELEMENT_SVG_PHOTO_H
#define TZ_ELEMENTS_ELEMENT_SVG_PHOTO_H

#include "elements/element_svg_internal.h"

/** Takes an <image> that is a photo or its plate into the set; others are passed over.
 * Photos stand in the order of their numbers. */
tz_status tz_element_read_image(tz_element_reader *r, tz_svg_node n);
/** Whether a symbol is cut from a photo. */
bool tz_element_is_cut(tz_svg_node symbol);
/** Photo, place and outline of such a symbol into *y, whose id is set; its radius where
 * it is 0.
 * @return TZ_OK; TZ_FORMAT; TZ_NOMEM (y holds what has been read) */
tz_status tz_element_read_cut(tz_element_reader *r, tz_svg_node symbol,
                              tz_element_symbol *y);
/** Plates to their photos; each symbol's photo must be there. After all of the above. */
tz_status tz_element_join_photos(tz_element_reader *r);
/** Whether an editor has hidden a <use> or a group of uses. */
tz_status tz_element_is_hidden(tz_element_reader *r, tz_svg_node n, bool *hidden);

#endif
