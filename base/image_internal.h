/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What the image readers and writers share. Not installed. */
#ifndef TZ_BASE_IMAGE_INTERNAL_H
#define TZ_BASE_IMAGE_INTERNAL_H

#include "base/image_io.h"

/** Appends the metadata of one image to another. */
tz_status tz_image_copy_meta(const tz_image *from, tz_image *to);

/** Metadata out of one line "key: value", as formats carry it that have comments but no
 * keys; text without such a key goes under "Comment". Need not end with a zero. */
tz_status tz_image_set_meta_line(tz_image *im, const char *text, size_t size);

/** Replaces NaN and infinity by 0. @return how many there were */
int64_t tz_image_make_finite(tz_image *im);

/* ---- readers ------------------------------------------------------------------------
 */

/** One file to be read, as the codecs see it. */
typedef struct tz_image_source {
    tz_ctx *ctx;
    const char *path; /**< for messages and for codecs that open files themselves */
    bool piped;       /**< standard input: `path` names no file */
    const uint8_t *data;
    size_t size;
    const tz_image_read_options *opt;
    int64_t max_pixels;
} tz_image_source;

/** What a codec found out beyond the pixels. Pixels come as the file has them: integers
 * divided by their largest value, still in the file's own encoding. */
typedef struct tz_image_found {
    tz_encoding encoding; /**< of the file: LINEAR or SRGB */
    double gamma;       /**< file gamma (value = light^gamma) where it is neither, or 0 */
    int orientation;    /**< Exif, 1..8; 0 = none */
    int64_t not_finite; /**< numbers replaced by 0 */
} tz_image_found;

/** Checks sizes against the limits, then tz_image_init. Every codec starts with it. */
tz_status tz_image_source_init(const tz_image_source *src, int64_t width, int64_t height,
                               int32_t channels, tz_image *im);
/** "<path>: not a readable PNG file: <why>; ..." with TZ_FORMAT. */
tz_status tz_image_source_bad(const tz_image_source *src, const char *kind,
                              const char *why);

tz_status tz_png_read(const tz_image_source *src, tz_image *im, tz_image_found *found);
tz_status tz_jpeg_read(const tz_image_source *src, tz_image *im, tz_image_found *found);
/** TZ_UNSUPPORTED without a message where another reader should try. */
tz_status tz_exr_read(const tz_image_source *src, tz_image *im, tz_image_found *found);
tz_status tz_oiio_read(const tz_image_source *src, tz_image *im, tz_image_found *found);

/** Orientation tag of an Exif block ("II*\0" or "MM\0*" first), 0 if none. */
int tz_exif_orientation(const uint8_t *data, size_t size);
/** Turns and mirrors pixels as an Exif orientation asks for. */
tz_status tz_image_orient(tz_ctx *ctx, tz_image *im, int orientation);

#endif
