/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The whole road: photos -> exemplars -> layout -> files. Thin: each step calls its
 * module; what stands here is reading, checking and writing around them. */
#ifndef TZ_SYNTHESIS_EXPAND_H
#define TZ_SYNTHESIS_EXPAND_H

#include "analysis/ebpt.h"
#include "base/image_io.h"
#include "synthesis/arrange.h"
#include "synthesis/compose.h"

/* ---- files of an output -------------------------------------------------------------
 */

typedef enum tz_format {
    TZ_FORMAT_AUTO, /**< from the name's extension */
    TZ_FORMAT_PNG,
    TZ_FORMAT_JPEG,
    TZ_FORMAT_TIFF,
    TZ_FORMAT_WEBP,
    TZ_FORMAT_HDR,
    TZ_FORMAT_EXR
} tz_format;

/** Table: tz_format_param_table. */
typedef struct tz_format_params {
    int32_t format;      /**< tz_format */
    int32_t depth;       /**< tz_sample_type */
    int32_t compression; /**< -1 .. 9 */
    int32_t quality;     /**< 0 .. 100 */
    int32_t tile;        /**< side of EXR and TIFF tiles, px */
} tz_format_params;
TZ_API extern const tz_param_table tz_format_param_table;

/** Format that a name's extension stands for, or TZ_FORMAT_AUTO. */
TZ_API tz_format tz_format_of(const char *path);
/** Settles the format of one output by its name and the parameters.
 * @param like  what will be written: its depth decides TZ_SAMPLE_AUTO (16-bit photos give
 *   16-bit PNG and TIFF, float data maps float EXR)
 * @return TZ_OK; TZ_INVALID (unknown extension, or one that contradicts the format) */
TZ_API tz_status tz_format_settle(tz_ctx *ctx, const char *path,
                                  const tz_format_params *params, const tz_image *like,
                                  tz_image_write_options *out);

/* ---- exemplars ----------------------------------------------------------------------
 */

/** A photo and what it is made of. */
typedef struct tz_source {
    char *path;      /**< of the photo, openable from the working folder */
    char sha256[65]; /**< of the photo's file, "" for standard input */
    tz_image photo;  /**< sRGB-encoded, 1 to 4 channels */
    tz_ebpt ebpt;    /**< empty until analysed */
    tz_ctx *ctx;
} tz_source;

TZ_API void tz_source_deinit(tz_source *s); /**< takes zeroed */
/** Reads and hashes a photo. Warns where it is too small to hold structure.
 * @return what tz_image_read returns; TZ_INVALID (all transparent, over 4 channels) */
TZ_API tz_status tz_source_read(tz_ctx *ctx, const char *path, tz_source *s);
/** Reads an exemplar document and its photo; warns if the photo has changed since.
 * @return what tz_ebpt_read and tz_source_read return; TZ_INVALID (photo of another size)
 */
TZ_API tz_status tz_source_read_exemplar(tz_ctx *ctx, const char *path, tz_source *s);
/** Fills s->ebpt; warns where no edges were found. */
TZ_API tz_status tz_source_analyze(tz_ctx *ctx, const tz_ebpt_params *params,
                                   tz_source *s);
/** Gives all images the channel count that holds the richest of them (grey becomes RGB,
 * missing alpha 1), so that one composer can take them. */
TZ_API tz_status tz_images_match(tz_ctx *ctx, tz_image *const *images, int32_t n);

/* ---- layout and pixels ----------------------------------------------------------------
 */

/** Arranges n exemplars, see tz_arrange.
 * @param rules  rule file or NULL
 * @param[in,out] l  as for tz_arrange */
TZ_API tz_status tz_expand_arrange(tz_ctx *ctx, const tz_source *sources, int32_t n,
                                   const char *rules, const tz_arrange_params *params,
                                   tz_layout *l);

/** The part of a layout of that size to render: the crop, or all of it.
 * @return TZ_OK; TZ_INVALID (crop outside the layout) */
TZ_API tz_status tz_crop_settle(tz_ctx *ctx, const int32_t size[2],
                                const tz_compose_params *params, tz_rect *out);

/** One image to make from a layout. */
typedef struct tz_render_job {
    const tz_layout *layout;
    const tz_image *images; /**< one a layout source */
    int32_t n;
    tz_map_kind kind;
    const tz_compose_params *params;
    const char *path;
    const tz_format_params *format;
    const char *recipe; /**< embedded; NULL = none */
} tz_render_job;

/** What rendering took. */
typedef struct tz_render_figures {
    int32_t width, height;
    double render, write; /**< s; what runs at the same time is counted under render */
} tz_render_figures;

/** Something that makes pixels, to be written as one image. */
typedef struct tz_pixels_job {
    void *user;
    /** Fills `out` (r.w x r.h, like->channels). */
    tz_status (*render)(tz_ctx *ctx, void *user, tz_rect r, tz_image *out);
    /** Sends r to the sink in strips; NULL = render is called for strips. */
    tz_status (*stream)(tz_ctx *ctx, void *user, tz_rect r, tz_image_sink *sink);
    tz_rect rect;
    const tz_image *like; /**< channels, names, alpha, encoding, depth, metadata */
    const char *path;
    const tz_format_params *format;
    const char *recipe; /**< embedded; NULL = none */
} tz_pixels_job;

/** Renders and writes one image: whole where it takes a small share of the memory budget,
 * else in strips.
 * @return what settling the format, call-backs and sink say; nothing is left on error */
TZ_API tz_status tz_pixels_write(tz_ctx *ctx, const tz_pixels_job *job,
                                 tz_render_figures *figures);

/** Renders and writes one image of a layout; streams where it would not fit the memory budget well.
 * @return TZ_OK; TZ_INVALID (crop outside the layout, ...); what compositor and sink say
 */
TZ_API tz_status tz_expand_render(tz_ctx *ctx, const tz_render_job *job,
                                  tz_render_figures *figures);

/** Seconds on a clock that only goes forward. */
TZ_API double tz_seconds(void);

#endif
