/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Images in memory: float32, interleaved, any number of named channels. */
#ifndef TZ_BASE_IMAGE_H
#define TZ_BASE_IMAGE_H

#include "base/array.h"
#include "base/geom.h"

#define TZ_IMAGE_MAX_SIDE     1000000
#define TZ_IMAGE_MAX_CHANNELS 64

/** What the numbers mean. Colour: linear light or sRGB-encoded (the curve is continued
 * beyond 1 and oddly below 0, so that HDR survives); data: never converted. */
typedef enum tz_encoding {
    TZ_ENCODING_LINEAR,
    TZ_ENCODING_SRGB,
    TZ_ENCODING_DATA
} tz_encoding;

/** Key and value, both owned by the image. */
typedef struct tz_meta {
    char *key, *value;
} tz_meta;

typedef struct tz_image {
    float *px; /**< px[y * stride + x * channels + c] */
    int32_t width, height, channels;
    int64_t stride; /**< floats from row to row */
    int32_t alpha;  /**< index of the alpha channel (straight, linear), or -1 */
    tz_encoding encoding;
    int32_t depth;     /**< bits a channel of the file it came from: 8, 16 (integer), 17
                            (half), 32 (float); a hint for writers */
    char (*names)[32]; /**< channels names, "R","G","B","A","Y","Z",...; NULL in a view */
    TZ_ARRAY(tz_meta)
    meta;        /**< text metadata, kept from input to output */
    bool owns;   /**< false for a view */
    tz_ctx *ctx; /**< allocator of px */
} tz_image;

/** Zeroed image. Channel names default to Y, YA, RGB, RGBA, else "c0", "c1", ...; alpha
 * is set for 2 and 4 channels.
 * @return TZ_OK; TZ_INVALID (sizes); TZ_NOMEM; on error *im is empty */
TZ_API tz_status tz_image_init(tz_ctx *ctx, tz_image *im, int32_t width, int32_t height,
                               int32_t channels);
TZ_API void tz_image_deinit(tz_image *im); /**< takes zeroed images and views */
/** View on a part of `im`, valid while `im` is; r must lie inside. No allocation. */
TZ_API tz_image tz_image_view(const tz_image *im, tz_rect r);
/** Deep copy, dense rows, names and metadata too. */
TZ_API tz_status tz_image_copy(tz_ctx *ctx, const tz_image *im, tz_image *out);
static inline float *tz_image_at(const tz_image *im, int32_t x, int32_t y)
{
    return im->px + (int64_t)y * im->stride + (int64_t)x * im->channels;
}

TZ_API float tz_srgb_encode(float linear); /**< odd, continued beyond 1 */
TZ_API float tz_srgb_decode(float srgb);
/** Converts colour channels (not alpha) in place, in parallel; data images: no change. */
TZ_API tz_status tz_image_convert(tz_ctx *ctx, tz_image *im, tz_encoding to);
/** Sets or replaces a metadata entry. */
TZ_API tz_status tz_image_set_meta(tz_image *im, const char *key, const char *value);
/** Value or NULL. */
TZ_API const char *tz_image_meta(const tz_image *im, const char *key);

#endif
