/* SPDX-License-Identifier: Apache-2.0 */
/* JPEG through libjpeg-turbo, streamed; metadata as comments "key: value". */
#include "base/image_sink_internal.h"

#include <errno.h>
#include <stdio.h>
/* jpeglib.h needs FILE */
#include <jpeglib.h>
/* after jpeglib.h */
#include <jerror.h>
#include <setjmp.h>
#include <string.h>

typedef struct jpeg {
    struct jpeg_error_mgr err; /* first: libjpeg hands back a pointer to it */
    jmp_buf jump;
    struct jpeg_compress_struct c;
    bool created;
    int error; /* errno where writing failed */
} jpeg;

static void on_error(j_common_ptr c)
{
    jpeg *w = (jpeg *)c->err;
    w->error = c->err->msg_code == JERR_FILE_WRITE ? (errno ? errno : EIO) : 0;
    longjmp(w->jump, 1);
}

static void on_message(j_common_ptr c, int level)
{
    (void)c;
    (void)level;
}

/* After a longjmp. */
static tz_status failed(tz_image_sink *sink)
{
    jpeg *w = sink->state;
    char text[JMSG_LENGTH_MAX];
    if (w->error)
        return tz_fail(sink->ctx, TZ_IO, "%s: cannot write: %s; %s", sink->shown,
                       strerror_r(w->error, text, sizeof text),
                       w->error == ENOSPC ? "free some space or write elsewhere"
                                          : "check the device");
    if (w->err.msg_code == JERR_OUT_OF_MEMORY)
        return tz_fail(sink->ctx, TZ_NOMEM, "%s: out of memory", sink->shown);
    w->err.format_message((j_common_ptr)&w->c, text);
    return tz_fail(sink->ctx, TZ_UNSUPPORTED, "%s: %s; write png or tif", sink->shown,
                   text);
}

static tz_status put_comments(tz_image_sink *sink)
{
    jpeg *w = sink->state;
    for (int32_t i = 0; i < sink->carrier.meta.n; i++) {
        const tz_meta *m = &sink->carrier.meta.v[i];
        size_t n = strlen(m->key) + 2 + strlen(m->value);
        char *line;
        if (n > 65500) { /* a marker's limit */
            tz_warn(sink->ctx, "%s: metadata '%s' is too long for jpeg and left out",
                    sink->shown, m->key);
            continue;
        }
        tz_status s = tz_alloc(sink->ctx, &line, n + 1, 1);
        if (s != TZ_OK)
            return s;
        snprintf(line, n + 1, "%s: %s", m->key, m->value);
        jpeg_write_marker(&w->c, JPEG_COM, (const JOCTET *)line, (unsigned)n);
        tz_free(sink->ctx, line);
    }
    return TZ_OK;
}

static tz_status jpeg_open(tz_image_sink *sink)
{
    jpeg *w;
    tz_status s = tz_alloc_zero(sink->ctx, &w, 1, sizeof *w);
    if (s != TZ_OK)
        return s;
    sink->state = w;
    w->c.err = jpeg_std_error(&w->err);
    w->err.error_exit = on_error;
    w->err.emit_message = on_message;
    if (setjmp(w->jump))
        return failed(sink);
    jpeg_create_compress(&w->c);
    w->created = true;
    jpeg_stdio_dest(&w->c, sink->out.f);
    w->c.image_width = (JDIMENSION)sink->width;
    w->c.image_height = (JDIMENSION)sink->height;
    w->c.input_components = sink->channels;
    w->c.in_color_space = sink->channels == 1 ? JCS_GRAYSCALE : JCS_RGB;
    jpeg_set_defaults(&w->c);
    jpeg_set_quality(&w->c, sink->quality, TRUE);
    if (sink->quality >= 90) /* full colour resolution */
        w->c.comp_info[0].h_samp_factor = w->c.comp_info[0].v_samp_factor = 1;
    jpeg_start_compress(&w->c, TRUE);
    return put_comments(sink);
}

static tz_status jpeg_band(tz_image_sink *sink, int32_t y, int32_t n, const void *px)
{
    (void)y;
    jpeg *w = sink->state;
    if (setjmp(w->jump))
        return failed(sink);
    for (int32_t i = 0; i < n; i++) {
        JSAMPROW row = (JSAMPROW)(uintptr_t)px + (size_t)i * sink->row_bytes;
        jpeg_write_scanlines(&w->c, &row, 1);
    }
    return TZ_OK;
}

static tz_status jpeg_close(tz_image_sink *sink)
{
    jpeg *w = sink->state;
    if (setjmp(w->jump))
        return failed(sink);
    jpeg_finish_compress(&w->c);
    return TZ_OK;
}

static void jpeg_release(tz_image_sink *sink)
{
    jpeg *w = sink->state;
    if (!w)
        return;
    if (w->created)
        jpeg_destroy_compress(&w->c);
    tz_free(sink->ctx, w);
    sink->state = NULL;
}

const tz_sink_format tz_sink_jpeg = {
    .name = "jpeg",
    .extensions = "jpg|jpeg",
    .automatic = TZ_SAMPLE_U8,
    .types = 1u << TZ_SAMPLE_U8,
    .channels = tz_sink_channels_opaque,
    .open = jpeg_open,
    .band = jpeg_band,
    .close = jpeg_close,
    .release = jpeg_release,
};
