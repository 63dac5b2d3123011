/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Contract between libterrazzo and its vector module (see base/module.h), which wraps
 * librsvg and cairo. Plain C; the module does not link to libterrazzo. */
#ifndef TZ_SYNTHESIS_ELEMENT_VECTOR_MODULE_H
#define TZ_SYNTHESIS_ELEMENT_VECTOR_MODULE_H

#include <stddef.h>
#include <stdint.h>

#define TZ_VECTOR_SYMBOL "tz_vector_api_1"

/** A block of pixels: 0xAARRGGBB, premultiplied, dense rows, zero where nothing is. */
typedef struct tz_vector_block {
    uint32_t *px;
    int32_t width, height;
} tz_vector_block;

/** All calls return 0; 1 the drawing is at fault; 2 out of memory; `why` receives one
 * line (n bytes). A document serves one thread at a time; several may be open. */
typedef struct tz_vector_api {
    /** @param svg  a whole document whose viewBox is -reach -reach 2 reach 2 reach */
    int (*open)(const char *svg, size_t size, double reach, void **doc, char *why,
                size_t n);
    void (*close)(void *doc); /**< takes NULL */
    /** Box of what is drawn: x0 y0 x1 y1 in the document's units; x0 > x1 if nothing is. */
    int (*extents)(void *doc, double box[4], char *why, size_t n);
    /** Draws it over the block.
     * @param map  document's units -> px of the block, order of SVG's matrix() */
    int (*draw)(void *doc, const double map[6], const tz_vector_block *block, char *why,
                size_t n);
} tz_vector_api;

#endif
