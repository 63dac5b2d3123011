/* SPDX-License-Identifier: Apache-2.0 */
/* EXR through OpenEXRCore: part 0 where it is flat, in tiles or scanlines, decoded on all
 * workers. Deep data, sub-sampled and integer channels are left to
 * OpenImageIO (TZ_UNSUPPORTED without a message). */
#include "base/image_internal.h"

#include <openexr.h>
#include <stdio.h>
#include <string.h>

typedef struct reader {
    const tz_image_source *src;
    exr_context_t ctx;
    tz_image *im;
    exr_attr_box2i_t window;
    int32_t place[TZ_IMAGE_MAX_CHANNELS]; /* file order -> channel of the image */
    bool tiled;
    int32_t across, tile_w, tile_h; /* tiles; or one column of scanline chunks */
} reader;

static void on_error(exr_const_context_t ctxt, exr_result_t code, const char *text)
{
    (void)ctxt;
    (void)code;
    (void)text;
}

static int64_t on_read(exr_const_context_t ctxt, void *user, void *to, uint64_t size,
                       uint64_t offset, exr_stream_error_func_ptr_t error_cb)
{
    (void)ctxt;
    (void)error_cb;
    const tz_image_source *src = user;
    if (offset >= src->size)
        return 0;
    if (size > src->size - offset)
        size = src->size - offset;
    memcpy(to, src->data + offset, size);
    return (int64_t)size;
}

static int64_t on_size(exr_const_context_t ctxt, void *user)
{
    (void)ctxt;
    const tz_image_source *src = user;
    return (int64_t)src->size;
}

static tz_status fail(const reader *r, exr_result_t rc)
{
    if (rc == EXR_ERR_OUT_OF_MEMORY)
        return tz_fail(r->src->ctx, TZ_NOMEM, "%s: out of memory", r->src->path);
    char why[200];
    snprintf(why, sizeof why, "%s (truncated or damaged)",
             exr_get_default_error_message(rc));
    return tz_image_source_bad(r->src, "EXR file", why);
}

/* ---- header --------------------------------------------------------------------------
 */

/* Files list channels by the alphabet; an image has R, G, B, A or Y, A first. "Y" is grey
 * unless it stands beside an X. */
static int rank(const exr_attr_chlist_t *list, int32_t c)
{
    static const char *const first[] = {"R", "G", "B", "Y", "A"};
    bool vector = false;
    for (int32_t i = 0; i < list->num_channels; i++)
        vector |= strcmp(list->entries[i].name.str, "X") == 0;
    for (int i = 0; i < 5; i++)
        if (strcmp(list->entries[c].name.str, first[i]) == 0 && !(vector && i == 3))
            return i;
    return 5;
}

static tz_status take_header(reader *r)
{
    exr_storage_t storage;
    const exr_attr_chlist_t *list;
    exr_result_t rc = exr_get_storage(r->ctx, 0, &storage);
    if (rc == EXR_ERR_SUCCESS && storage != EXR_STORAGE_SCANLINE &&
        storage != EXR_STORAGE_TILED)
        return TZ_UNSUPPORTED;
    if (rc == EXR_ERR_SUCCESS)
        rc = exr_get_channels(r->ctx, 0, &list);
    if (rc == EXR_ERR_SUCCESS)
        rc = exr_get_data_window(r->ctx, 0, &r->window);
    if (rc != EXR_ERR_SUCCESS)
        return fail(r, rc);
    for (int32_t c = 0; c < list->num_channels; c++)
        if (list->entries[c].x_sampling != 1 || list->entries[c].y_sampling != 1 ||
            list->entries[c].pixel_type == EXR_PIXEL_UINT)
            return TZ_UNSUPPORTED;
    int64_t w = (int64_t)r->window.max.x - r->window.min.x + 1;
    int64_t h = (int64_t)r->window.max.y - r->window.min.y + 1;
    tz_status s = tz_image_source_init(r->src, w, h, list->num_channels, r->im);
    if (s != TZ_OK)
        return s;
    r->im->depth = 17;
    r->im->alpha = -1;
    for (int32_t c = 0; c < list->num_channels; c++) {
        int32_t at = 0; /* how many come before */
        for (int32_t i = 0; i < list->num_channels; i++)
            at += rank(list, i) < rank(list, c) ||
                  (rank(list, i) == rank(list, c) && i < c);
        r->place[c] = at;
        memset(r->im->names[at], 0, sizeof *r->im->names);
        strncpy(r->im->names[at], list->entries[c].name.str, sizeof *r->im->names - 1);
        if (strcmp(list->entries[c].name.str, "A") == 0)
            r->im->alpha = at;
        if (list->entries[c].pixel_type == EXR_PIXEL_FLOAT)
            r->im->depth = 32;
    }
    r->tiled = storage == EXR_STORAGE_TILED;
    if (r->tiled)
        rc = exr_get_tile_sizes(r->ctx, 0, 0, 0, &r->tile_w, &r->tile_h);
    else
        rc = exr_get_scanlines_per_chunk(r->ctx, 0, &r->tile_h);
    if (rc != EXR_ERR_SUCCESS || r->tile_h < 1 || (r->tiled && r->tile_w < 1))
        return fail(r, rc);
    r->across = r->tiled ? (int32_t)((w + r->tile_w - 1) / r->tile_w) : 1;
    return TZ_OK;
}

static tz_status keep_text(reader *r)
{
    int32_t n = 0;
    exr_get_attribute_count(r->ctx, 0, &n);
    for (int32_t i = 0; i < n; i++) {
        const exr_attribute_t *a;
        if (exr_get_attribute_by_index(r->ctx, 0, EXR_ATTR_LIST_FILE_ORDER, i, &a) !=
                EXR_ERR_SUCCESS ||
            a->type != EXR_ATTR_STRING || !a->string->str ||
            strcmp(a->name, "type") == 0 || strcmp(a->name, "name") == 0)
            continue;
        tz_status s = tz_image_set_meta(r->im, a->name, a->string->str);
        if (s != TZ_OK)
            return s;
    }
    return TZ_OK;
}

/* ---- pixels ---------------------------------------------------------------------------
 */

/* Half to float: the exponent is moved by a multiplication, which gets the smallest
 * numbers right too; infinity and not-a-number stay not finite. */
static inline float from_half(uint16_t h)
{
    uint32_t bits = (uint32_t)(h & 0x7fff) << 13, sign = (uint32_t)(h & 0x8000) << 16;
    float x;
    memcpy(&x, &bits, sizeof x);
    x *= 0x1p112f;
    memcpy(&bits, &x, sizeof bits);
    bits |= sign | ((h & 0x7c00) == 0x7c00 ? 0x7f800000u : 0);
    memcpy(&x, &bits, sizeof x);
    return x;
}

static void place_row(const uint8_t *from, bool half, int32_t n, float *to, int32_t step)
{
    if (half)
        for (int32_t i = 0; i < n; i++) {
            uint16_t h;
            memcpy(&h, from + 2 * (ptrdiff_t)i, sizeof h);
            to[(ptrdiff_t)i * step] = from_half(h);
        }
    else
        for (int32_t i = 0; i < n; i++)
            memcpy(to + (ptrdiff_t)i * step, from + 4 * (ptrdiff_t)i, sizeof *to);
}

/* The library decodes into planes of the file's own type; we interleave and convert. (Its
 * own routine for four interleaved channels gives them in reverse, in version 3.1.5.) */
static tz_status unpack(const reader *r, exr_decode_pipeline_t *pipe, int32_t x,
                        int32_t y, uint8_t *planes)
{
    const tz_image *im = r->im;
    int32_t w = pipe->chunk.width, h = pipe->chunk.height;
    size_t plane = (size_t)w * (size_t)h * sizeof(float);
    for (int c = 0; c < pipe->channel_count; c++) {
        exr_coding_channel_info_t *ch = &pipe->channels[c];
        ch->decode_to_ptr = planes + plane * (size_t)c;
        ch->user_bytes_per_element = (uint8_t)ch->bytes_per_element;
        ch->user_data_type = ch->data_type;
        ch->user_pixel_stride = (uint8_t)ch->bytes_per_element;
        ch->user_line_stride = (uint8_t)ch->bytes_per_element * w;
    }
    exr_result_t rc = exr_decoding_choose_default_routines(r->ctx, 0, pipe);
    if (rc == EXR_ERR_SUCCESS)
        rc = exr_decoding_run(r->ctx, 0, pipe);
    if (rc != EXR_ERR_SUCCESS)
        return fail(r, rc);
    for (int c = 0; c < pipe->channel_count; c++) {
        const exr_coding_channel_info_t *ch = &pipe->channels[c];
        for (int32_t row = 0; row < h; row++)
            place_row(planes + plane * (size_t)c +
                          (size_t)row * (size_t)ch->user_line_stride,
                      ch->data_type == EXR_PIXEL_HALF, w,
                      tz_image_at(im, x, y + row) + r->place[c], im->channels);
    }
    return TZ_OK;
}

static tz_status decode_chunk(const reader *r, const exr_chunk_info_t *info, int32_t x,
                              int32_t y)
{
    const tz_image *im = r->im;
    exr_decode_pipeline_t pipe = EXR_DECODE_PIPELINE_INITIALIZER;
    exr_result_t rc = exr_decoding_initialize(r->ctx, 0, info, &pipe);
    if (rc != EXR_ERR_SUCCESS)
        return fail(r, rc);
    uint8_t *planes = NULL;
    tz_status s = TZ_OK;
    if (pipe.channel_count != im->channels || x < 0 || y < 0 || x >= im->width ||
        y >= im->height || info->width < 1 || info->height < 1 ||
        info->width > im->width - x || info->height > im->height - y)
        s = fail(r, EXR_ERR_BAD_CHUNK_LEADER);
    if (s == TZ_OK)
        s = tz_alloc(r->src->ctx, &planes,
                     (size_t)info->width * (size_t)info->height * (size_t)im->channels,
                     sizeof(float));
    if (s == TZ_OK)
        s = unpack(r, &pipe, x, y, planes);
    exr_decoding_destroy(r->ctx, &pipe);
    tz_free(r->src->ctx, planes);
    return s;
}

static tz_status read_chunk(tz_ctx *ctx, void *arg, int64_t index, int worker)
{
    (void)ctx;
    (void)worker;
    const reader *r = arg;
    exr_chunk_info_t info;
    int32_t tx = (int32_t)(index % r->across), ty = (int32_t)(index / r->across);
    int32_t y = ty * r->tile_h;
    exr_result_t rc =
        r->tiled ? exr_read_tile_chunk_info(r->ctx, 0, tx, ty, 0, 0, &info)
                 : exr_read_scanline_chunk_info(r->ctx, 0, r->window.min.y + y, &info);
    if (rc != EXR_ERR_SUCCESS)
        return fail(r, rc);
    return decode_chunk(r, &info, r->tiled ? tx * r->tile_w : 0, y);
}

/* EXR colour is multiplied by alpha, ours is not. */
static tz_status divide_row(tz_ctx *ctx, void *arg, int64_t y, int worker)
{
    (void)ctx;
    (void)worker;
    const tz_image *im = arg;
    float *p = tz_image_at(im, 0, (int32_t)y);
    for (int32_t x = 0; x < im->width; x++, p += im->channels) {
        float a = p[im->alpha];
        if (a > 0 && a != 1)
            for (int32_t c = 0; c < im->channels; c++)
                if (c != im->alpha)
                    p[c] /= a;
    }
    return TZ_OK;
}

tz_status tz_exr_read(const tz_image_source *src, tz_image *im, tz_image_found *found)
{
    reader r = {.src = src, .im = im};
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    init.error_handler_fn = on_error;
    if (src->piped) {
        init.user_data = (void *)(uintptr_t)src;
        init.read_fn = on_read;
        init.size_fn = on_size;
    }
    exr_result_t rc = exr_start_read(&r.ctx, src->path, &init);
    tz_status s = rc == EXR_ERR_SUCCESS ? TZ_OK : fail(&r, rc);
    if (s == TZ_OK)
        s = take_header(&r);
    if (s == TZ_OK)
        s = keep_text(&r);
    if (s == TZ_OK) {
        int64_t down = ((int64_t)im->height + r.tile_h - 1) / r.tile_h;
        s = tz_parallel_for(src->ctx, down * r.across, read_chunk, &r);
    }
    if (s == TZ_OK) {
        found->encoding = TZ_ENCODING_LINEAR;
        found->not_finite = tz_image_make_finite(im);
        if (im->alpha >= 0 && !src->opt->data)
            s = tz_parallel_for(src->ctx, im->height, divide_row, im);
    }
    if (r.ctx)
        exr_finish(&r.ctx);
    if (s != TZ_OK)
        tz_image_deinit(im);
    return s;
}
