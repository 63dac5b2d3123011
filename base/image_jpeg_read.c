/* SPDX-License-Identifier: Apache-2.0 */
/* JPEG through libjpeg-turbo: grey, RGB, CMYK and YCCK (Adobe's are stored inverted).
 * Data that ends too soon is an error, where libjpeg would fill up with grey. */
#include "base/image_internal.h"

#include <stdio.h>
/* jpeglib.h needs FILE */
#include <jpeglib.h>
/* after jpeglib.h */
#include <jerror.h>
#include <setjmp.h>
#include <string.h>

typedef struct reader {
    struct jpeg_error_mgr err; /* first: libjpeg hands back a pointer to it */
    jmp_buf jump;
    const tz_image_source *src;
    struct jpeg_decompress_struct jpeg;
    uint8_t *row;
    char why[JMSG_LENGTH_MAX];
    bool no_memory;
} reader;

static void on_error(j_common_ptr c)
{
    reader *r = (reader *)c->err;
    r->no_memory = c->err->msg_code == JERR_OUT_OF_MEMORY;
    c->err->format_message(c, r->why);
    longjmp(r->jump, 1);
}

static void on_message(j_common_ptr c, int level)
{
    reader *r = (reader *)c->err;
    if (level >= 0)
        return; /* trace */
    int code = c->err->msg_code;
    if (code == JWRN_JPEG_EOF || code == JWRN_HIT_MARKER) {
        strcpy(r->why, "it ends too soon (truncated)");
        longjmp(r->jump, 1);
    }
    if (c->err->num_warnings++ == 0) {
        char text[JMSG_LENGTH_MAX];
        c->err->format_message(c, text);
        tz_warn(r->src->ctx, "%s: %s", r->src->path, text);
    }
}

static tz_status keep_markers(reader *r, tz_image *im, tz_image_found *found)
{
    for (jpeg_saved_marker_ptr m = r->jpeg.marker_list; m; m = m->next) {
        if (m->marker == JPEG_APP0 + 1 && m->data_length > 6 &&
            memcmp(m->data, "Exif\0\0", 6) == 0) {
            found->orientation = tz_exif_orientation(m->data + 6, m->data_length - 6);
        } else if (m->marker == JPEG_COM) {
            tz_status s =
                tz_image_set_meta_line(im, (const char *)m->data, m->data_length);
            if (s != TZ_OK)
                return s;
        }
    }
    return TZ_OK;
}

static void convert_row(const reader *r, float *to, int32_t width)
{
    const uint8_t *p = r->row;
    if (r->jpeg.out_color_space != JCS_CMYK) {
        int32_t n = width * r->jpeg.output_components;
        for (int32_t i = 0; i < n; i++)
            to[i] = (float)p[i] / 255.0f;
        return;
    }
    int flip = r->jpeg.saw_Adobe_marker ? 0 : 255;
    for (int32_t x = 0; x < width; x++, p += 4, to += 3)
        for (int c = 0; c < 3; c++)
            to[c] = (float)((p[c] ^ flip) * (p[3] ^ flip)) / (255.0f * 255.0f);
}

static tz_status read_all(reader *r, tz_image *im, tz_image_found *found)
{
    const tz_image_source *src = r->src;
    if (setjmp(r->jump))
        return r->no_memory ? tz_fail(src->ctx, TZ_NOMEM, "%s: out of memory", src->path)
                            : tz_image_source_bad(src, "JPEG file", r->why);
    jpeg_create_decompress(&r->jpeg);
    jpeg_mem_src(&r->jpeg, src->data, src->size);
    jpeg_save_markers(&r->jpeg, JPEG_COM, 0xffff);
    jpeg_save_markers(&r->jpeg, JPEG_APP0 + 1, 0xffff);
    jpeg_read_header(&r->jpeg, TRUE);
    bool cmyk = r->jpeg.num_components == 4;
    r->jpeg.out_color_space = cmyk                          ? JCS_CMYK
                              : r->jpeg.num_components == 1 ? JCS_GRAYSCALE
                                                            : JCS_RGB;
    r->jpeg.dct_method = JDCT_ISLOW;
    tz_status s = tz_image_source_init(src, r->jpeg.image_width, r->jpeg.image_height,
                                       r->jpeg.num_components == 1 ? 1 : 3, im);
    if (s == TZ_OK)
        s = tz_alloc(src->ctx, &r->row, (size_t)r->jpeg.image_width, 4);
    if (s != TZ_OK)
        return s;
    im->depth = 8;
    jpeg_start_decompress(&r->jpeg);
    while (r->jpeg.output_scanline < r->jpeg.output_height) {
        int32_t y = (int32_t)r->jpeg.output_scanline;
        if (y % 64 == 0 && tz_ctx_cancelled(src->ctx))
            return tz_fail(src->ctx, TZ_CANCELLED, "cancelled");
        jpeg_read_scanlines(&r->jpeg, &r->row, 1);
        convert_row(r, tz_image_at(im, 0, y), im->width);
    }
    s = keep_markers(r, im, found);
    jpeg_finish_decompress(&r->jpeg);
    return s;
}

tz_status tz_jpeg_read(const tz_image_source *src, tz_image *im, tz_image_found *found)
{
    reader r = {.src = src};
    r.jpeg.err = jpeg_std_error(&r.err);
    r.err.error_exit = on_error;
    r.err.emit_message = on_message;
    tz_status s = read_all(&r, im, found);
    jpeg_destroy_decompress(&r.jpeg);
    tz_free(src->ctx, r.row);
    if (s != TZ_OK)
        tz_image_deinit(im);
    return s;
}
