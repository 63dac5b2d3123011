/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Contract between libterrazzo and its vector module (see base/module.h), which wraps
 * librsvg and cairo. Plain C; the module does not link to libterrazzo. */
#ifndef TZ_SYNTHESIS_ELEMENT_VECTOR_MODULE_H
#define TZ_SYNTHESIS_ELEMENT_VECTOR_MODULE_H

#include <stddef.h>
#include <stdint.h>

#define TZ_VECTOR_SYMBOL "tz_vector_api_1"
#define TZ_VECTOR_GROUP  "tz-all"

/** A block of pixels: 0xAARRGGBB, premultiplied, dense rows, zero where nothing is. */
typedef struct tz_vector_block {
    uint32_t *px;
    int32_t width, height;
} tz_vector_block;

/** All calls return 0; 1 the drawing is at fault; 2 out of memory; `why` receives one
 * line (n bytes). A document serves one thread at a time; several may be open. */
typedef struct tz_vector_api {
    /** @param svg  a whole document without a viewBox, all of it in a group of id
     *   TZ_VECTOR_GROUP that has no transform */
    int (*open)(const char *svg, size_t size, void **doc, char *why, size_t n);
    void (*close)(void *doc); /**< takes NULL */
    /** Box of what is drawn, within `reach` of the origin by guess: x0 y0 x1 y1 in the document's units; x0 > x1 if nothing is. */
    int (*extents)(void *doc, double reach, double box[4], char *why, size_t n);
    /** Draws it over the block.
     * @param map  document's units -> px of the block, order of SVG's matrix() */
    int (*draw)(void *doc, const double map[6], const tz_vector_block *block, char *why,
                size_t n);
} tz_vector_api;

#endif
