/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Between the sink (base/image_sink.c), which converts and gathers rows, and the formats,
 * which are rows of a table and get bands of finished samples. Not installed. */
#ifndef TZ_BASE_IMAGE_SINK_INTERNAL_H
#define TZ_BASE_IMAGE_SINK_INTERNAL_H

#include "base/file.h"
#include "base/image_internal.h"

typedef struct tz_sink_format {
    const char *name;
    const char *extensions;   /**< "tif|tiff" */
    tz_sample_type automatic; /**< what AUTO means */
    unsigned types;           /**< bits 1 << TZ_SAMPLE_... */
    bool gathered;            /**< the library wants the whole picture at once */
    bool colour;              /**< no grey: written as three equal channels */
    bool associated;          /**< colour is stored multiplied by alpha */
    /** Channel rule: sets sink->channels, map, alpha; TZ_UNSUPPORTED with a message. */
    tz_status (*channels)(tz_image_sink *sink, const tz_image *like);
    /** Starts the file; may set sink->band_rows (0 = not yet chosen). */
    tz_status (*open)(tz_image_sink *sink);
    /** Rows y..y+n-1 of samples; n = band_rows but for the last band. */
    tz_status (*band)(tz_image_sink *sink, int32_t y, int32_t n, const void *px);
    tz_status (*close)(tz_image_sink *sink);
    /** Frees sink->state, after close as well as after failures. */
    void (*release)(tz_image_sink *sink);
} tz_sink_format;

struct tz_image_sink {
    tz_ctx *ctx;
    const tz_sink_format *format;
    tz_file_out out;
    char *shown; /**< name for messages */
    int32_t width, height;
    int32_t channels, alpha;           /**< of the file */
    int32_t in_channels, in_alpha;     /**< of the rows that come */
    int8_t map[TZ_IMAGE_MAX_CHANNELS]; /**< file channel -> channel of the rows */
    char names[TZ_IMAGE_MAX_CHANNELS][32];
    tz_encoding encoding; /**< of the file */
    tz_sample_type type;
    int32_t sample_size; /**< bytes a sample */
    int32_t compression, quality, tile;
    tz_image carrier; /**< 1 x 1, carries the metadata */
    int32_t next_row; /**< first row not yet received */
    int32_t band_rows, band_fill;
    uint8_t *band; /**< band_rows * row_bytes */
    size_t row_bytes;
    uint8_t *code_of; /**< linear float -> 8-bit sRGB: code by top bits, see sink.c */
    float threshold[257];
    float *decode;    /**< sRGB -> linear for half samples, else NULL */
    tz_status status; /**< first failure sticks */
    void *state;      /**< the format's own */
};

/** fwrite on the sink's file; TZ_IO is reported with the operating system's reason. */
tz_status tz_sink_put(tz_image_sink *sink, const void *data, size_t size);

extern const tz_sink_format tz_sink_png, tz_sink_exr, tz_sink_jpeg, tz_sink_tiff,
    tz_sink_webp, tz_sink_hdr;

/** Channel rules. */
tz_status tz_sink_channels_any(tz_image_sink *sink, const tz_image *like);
/** Grey, grey + alpha, RGB, RGBA. */
tz_status tz_sink_channels_rgba(tz_image_sink *sink, const tz_image *like);
/** Alpha is dropped with a warning. */
tz_status tz_sink_channels_opaque(tz_image_sink *sink, const tz_image *like);

#endif
