/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What documents show of photos. Not installed.
 *
 *   <image id="tz-photo-0" tz:photo="0" tz:sha256=... width height xlink:href=.../>
 *   <image id="tz-plate-0" tz:plate="0" width height xlink:href=.../>
 *   <symbol id="S" tz:radius=... tz:photo="0 scale x y">
 *     <clipPath id="S-outline"><path d="M...Z" clip-rule="evenodd"/></clipPath>
 *     <g clip-path="url(#S-outline)"><use xlink:href="#tz-photo-0" transform=.../></g>
 *   </symbol>
 *
 * The path is the outline to the bit; the transform is for viewers. The plate lies
 * beneath all; where the domain is larger it is repeated in mirror images. */
#ifndef TZ_ELEMENTS_ELEMENT_WRITE_INTERNAL_H
#define TZ_ELEMENTS_ELEMENT_WRITE_INTERNAL_H

#include "base/svg.h"
#include "elements/element.h"

/** Definitions of all photos and plates of a set. @param doc  path of the document */
tz_status tz_element_put_photos(tz_ctx *ctx, const char *doc, tz_svg_writer *w,
                                const tz_element_set *s);
/** Attributes and content of an open <symbol> whose pixels are a photo's. */
void tz_element_put_cut(tz_svg_writer *w, const tz_element_symbol *y);
/** The plate over the whole domain, marked tz:copy, where photo 0 has one. */
void tz_element_put_plate(tz_svg_writer *w, const tz_element_set *s);

/** What a document cannot hold: a set that is not sound, two symbols of one id.
 * @return TZ_OK; TZ_INVALID; TZ_NOMEM */
tz_status tz_element_put_check(tz_ctx *ctx, const char *path, const tz_element_set *s);
/** Definitions and elements of a checked set, into an open root: documents that hold other
 * things, too, call this. */
tz_status tz_element_put_set(tz_ctx *ctx, const char *path, tz_svg_writer *w,
                             const tz_element_set *s);

/** The two parts of it: definitions with what lies beneath all, and the elements. */
tz_status tz_element_put_ground(tz_ctx *ctx, const char *path, tz_svg_writer *w,
                                const tz_element_set *s);
tz_status tz_element_put_elements(tz_svg_writer *w, const tz_element_set *s);

#endif
