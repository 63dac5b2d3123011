/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Element exemplars out of any SVG, and layouts in and out: SVG, JSON, CSV.
 *
 * What is an element: every <use>; every group with tz:element="1" or of shapes that
 * overlap each other and stand alone; every other shape. Transforms, viewBox, units,
 * style attributes and CSS classes are followed. */
#ifndef TZ_ELEMENTS_ELEMENT_IO_H
#define TZ_ELEMENTS_ELEMENT_IO_H

#include "elements/element.h"

/** All zero: plain domain, automatic classes. */
typedef struct tz_element_read_options {
    bool wrap;       /**< the document is a tile that repeats: read it as a torus */
    bool wrap_auto;  /**< find out */
    int32_t classes; /**< wanted classes where the document names none; 0 = automatic */
} tz_element_read_options;

/** @param options  NULL = all zero
 * @param[out] s  overwritten, not freed; zeroed on error; the domain is the viewBox moved
 *   to 0, 0 (one tile, wrapped, where the drawing is a pattern over the whole view)
 * @return TZ_OK; TZ_IO; TZ_FORMAT (line and fault); TZ_INVALID (no elements in it);
 *   TZ_LIMIT (over 2 million elements); TZ_NOMEM
 * @cost O(n log n) */
TZ_API tz_status tz_element_read_svg(tz_ctx *ctx, const char *path,
                                     const tz_element_read_options *options,
                                     tz_element_set *s);

/** The same of a text in memory; `name` stands for it in messages. A zero byte follows
 * text[size - 1]. */
TZ_API tz_status tz_element_parse_svg(tz_ctx *ctx, const char *name, const char *text,
                                      size_t size, const tz_element_read_options *options,
                                      tz_element_set *s);

/** Writes the recipe, symbols and one <use> an element; reading gives the same set, bit for bit, but
 * for outlines, which are made anew. A foreign viewer shows it as it is. */
TZ_API tz_status tz_element_write_svg(tz_ctx *ctx, const char *path,
                                      const tz_element_set *s);
/** {"domain":[x0,y0,x1,y1],"elements":[{"x","y","z","type","angle","scale","radius",
 * "source"}]}: a table for scatter tools. Void elements are left out. */
TZ_API tz_status tz_element_write_json(tz_ctx *ctx, const char *path,
                                       const tz_element_set *s);
/** The same as rows, with a line of names first. */
TZ_API tz_status tz_element_write_csv(tz_ctx *ctx, const char *path,
                                      const tz_element_set *s);
/** Whether tz_element_write can write a file of that name.
 * @return TZ_OK; TZ_INVALID */
TZ_API tz_status tz_element_write_check(tz_ctx *ctx, const char *path);
/** By the name's suffix: .svg, .json or .csv; "-" is standard output, as SVG. */
TZ_API tz_status tz_element_write(tz_ctx *ctx, const char *path, const tz_element_set *s);

#endif
