/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Images on disk. Reading: PNG, JPEG, TIFF, WebP, HDR, EXR (and what else OpenImageIO
 * knows), 8/16 bit, half, float. Writing is streamed, goes to a temporary file beside the
 * target and is renamed when complete: no partial file ever stands under the final name.
 */
#ifndef TZ_BASE_IMAGE_IO_H
#define TZ_BASE_IMAGE_IO_H

#include "base/image.h"

typedef struct tz_image_read_options {
    bool data;        /**< a non-colour map (normal, height, ...): no colour conversion */
    tz_encoding want; /**< for colour: TZ_ENCODING_LINEAR or TZ_ENCODING_SRGB */
    int64_t max_pixels; /**< 0 = 2^30; larger files give TZ_LIMIT */
} tz_image_read_options;

/** Reads a whole image. "-" reads standard input. Palette and CMYK become RGB, grey stays
 * one channel; the orientation tag is applied; NaN and infinity are replaced by 0 with a
 * warning. Colour encoding is taken from the file (float formats: linear; integer: sRGB
 * unless the file says otherwise).
 * @return TZ_OK; TZ_IO (missing, directory, unreadable); TZ_FORMAT (empty, truncated, not
 *   an image); TZ_LIMIT; TZ_NOMEM. On error *im is empty. */
TZ_API tz_status tz_image_read(tz_ctx *ctx, const char *path,
                               const tz_image_read_options *opt, tz_image *im);

typedef enum tz_sample_type {
    TZ_SAMPLE_AUTO, /**< exr: half; hdr: float; png, tiff, webp, jpeg: 8 bit */
    TZ_SAMPLE_U8,
    TZ_SAMPLE_U16,
    TZ_SAMPLE_HALF,
    TZ_SAMPLE_FLOAT
} tz_sample_type;

typedef struct tz_image_write_options {
    tz_sample_type type;
    int32_t compression; /**< 0 none .. 9 smallest, -1 = default (1: fast) */
    int32_t quality;     /**< jpeg, webp: 1..100, 0 = 95 */
    int32_t tile;        /**< exr, tiff: tile side in px, 0 = 256 */
    const char *format;  /**< "png", "exr", ...; NULL = from the name; needed for "-" */
} tz_image_write_options;

/** Writer of rows of any height, top to bottom; memory use does not grow with the height.
 * EXR (tiled, OpenEXRCore) and TIFF are streamed tile row by tile row; PNG is compressed
 * in parallel (row bands deflated apart, one zlib stream); others are gathered in memory
 * up to 2^28 px, beyond that TZ_LIMIT at opening. */
typedef struct tz_image_sink tz_image_sink;

/** @param like  channels, names, alpha, encoding and metadata of what will come (its size
 *   and pixels are not looked at)
 *  @return TZ_OK; TZ_INVALID, TZ_IO, TZ_UNSUPPORTED (extension, channel count), TZ_NOMEM
 */
TZ_API tz_status tz_image_sink_open(tz_ctx *ctx, const char *path, int32_t width,
                                    int32_t height, const tz_image *like,
                                    const tz_image_write_options *opt,
                                    tz_image_sink **out);
/** Next rows.height rows; rows.width = the sink's width. Rows are converted from their
 * own encoding to the file's (integer formats sRGB for colour, EXR/HDR linear). */
TZ_API tz_status tz_image_sink_rows(tz_image_sink *sink, const tz_image *rows);
/** Flushes, closes and renames; on failure the temporary file is removed. Frees the sink.
 */
TZ_API tz_status tz_image_sink_close(tz_image_sink *sink);
/** Removes the temporary file and frees; takes NULL. */
TZ_API void tz_image_sink_abort(tz_image_sink *sink);

/** Whole image in one go, through a sink. */
TZ_API tz_status tz_image_write(tz_ctx *ctx, const char *path, const tz_image *im,
                                const tz_image_write_options *opt);

#endif
