/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Contract between libterrazzo and its OpenImageIO module (see base/module.h): plain C,
 * call-backs only, since the module does not link to the library. */
#ifndef TZ_BASE_IMAGE_OIIO_MODULE_H
#define TZ_BASE_IMAGE_OIIO_MODULE_H

#include <stddef.h>
#include <stdint.h>

#define TZ_OIIO_SYMBOL "tz_oiio_api_1"

typedef struct tz_oiio_head {
    int64_t width, height;
    int32_t channels, alpha; /* alpha -1 = none */
    int32_t depth;           /* 8, 16, 17 (half), 32 */
    int32_t linear;          /* 0: sRGB-encoded */
    int32_t orientation;
    int32_t is_float; /* may hold numbers that are not finite */
} tz_oiio_head;

/** Receiver of what is read. */
typedef struct tz_oiio_reader {
    void *user;
    /** Gets sizes, gives the place for height * width * channels floats, NULL = stop. */
    float *(*begin)(void *user, const tz_oiio_head *head);
    void (*name)(void *user, int32_t channel, const char *name);
    void (*meta)(void *user, const char *key, const char *value);
    int (*cancelled)(void *user);
} tz_oiio_reader;

typedef struct tz_oiio_out tz_oiio_out;

typedef struct tz_oiio_spec {
    const char *path;   /* file that is written, any name */
    const char *format; /* "tiff", "webp", "hdr" */
    int32_t width, height, channels, alpha, depth, tile, quality, compression, linear;
    const char (*names)[32];
    const char *const *meta; /* key, value, key, value, ..., NULL */
} tz_oiio_spec;

/** Functions return 0, or an errno-like code with one line in `why`: 1 the file, 2 not
 * supported, 3 memory, 4 stopped by a call-back. */
typedef struct tz_oiio_api {
    int (*read)(const char *path, const tz_oiio_reader *r, char *why, size_t n);
    int (*open)(const tz_oiio_spec *spec, tz_oiio_out **out, char *why, size_t n);
    /** Rows y0..y1-1, dense, of the file's own sample type; a multiple of the tile height
     * but for the last. */
    int (*rows)(tz_oiio_out *out, int32_t y0, int32_t y1, const void *px, char *why,
                size_t n);
    int (*close)(tz_oiio_out *out, char *why, size_t n); /* frees */
} tz_oiio_api;

#endif
