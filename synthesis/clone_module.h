/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Contract between libterrazzo and its cloning module (see base/module.h), which wraps
 * OpenCV's photo library. Plain C; the module does not link to libterrazzo. */
#ifndef TZ_SYNTHESIS_CLONE_MODULE_H
#define TZ_SYNTHESIS_CLONE_MODULE_H

#include <stddef.h>
#include <stdint.h>

#define TZ_CLONE_SYMBOL "tz_clone_api_1"

/** Three channels of 8 bits, dense rows. */
typedef struct tz_clone_picture {
    uint8_t *px;
    int32_t width, height;
} tz_clone_picture;

/** A piece of a photo and where it goes. */
typedef struct tz_clone_patch {
    tz_clone_picture photo;
    double map[6];        /**< photo px -> canvas px, order of SVG's matrix() */
    const double *border; /**< polygon in canvas px, x and y interleaved */
    int32_t points;
} tz_clone_patch;

typedef struct tz_clone_api {
    /** Clones the patch into the canvas, which must hold its border with 2 px to spare on
     * all sides (what lies beyond is cut off). A patch that shows less than 3 x 3 px is
     * left out.
     * @param[in,out] canvas  changed under the border only
     * @param why  n bytes, receives one line on error
     * @return 0; 1 OpenCV refused; 2 out of memory */
    int (*paste)(const tz_clone_patch *patch, const tz_clone_picture *canvas, char *why,
                 size_t n);
} tz_clone_api;

#endif
