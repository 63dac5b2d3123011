/* SPDX-License-Identifier: Apache-2.0 */
/* Writing by OpenImageIO: TIFF tile row by tile row, WebP and HDR in one piece. The
 * module writes to a file of its own name, so pipes get a copy of a temporary file. */
#include "base/image_oiio_module.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/image_sink_internal.h"
#include "base/module.h"

typedef struct oiio {
    const tz_oiio_api *api;
    tz_oiio_out *out;
    const char **meta;
    char spool[64]; /* name of the temporary file where output is a pipe */
} oiio;

static tz_status fail(tz_image_sink *sink, int rc, const char *why)
{
    tz_status s = rc == 3 ? TZ_NOMEM : rc == 2 ? TZ_UNSUPPORTED : TZ_IO;
    return tz_fail(sink->ctx, s, "%s: cannot write: %s; check space and folder",
                   sink->shown, why[0] ? why : "no reason given");
}

static tz_status spool(tz_image_sink *sink)
{
    oiio *w = sink->state;
    const char *dir = getenv("TMPDIR");
    if (!dir || strlen(dir) > 40)
        dir = "/tmp";
    snprintf(w->spool, sizeof w->spool, "%s/terrazzo.XXXXXX", dir);
    int fd = mkstemp(w->spool);
    if (fd < 0) {
        w->spool[0] = 0;
        return tz_fail(sink->ctx, TZ_IO, "%s: no temporary file in %s; set TMPDIR",
                       sink->shown, dir);
    }
    close(fd);
    return TZ_OK;
}

static tz_status oiio_open(tz_image_sink *sink)
{
    oiio *w;
    char why[300] = "";
    tz_status s = tz_alloc_zero(sink->ctx, &w, 1, sizeof *w);
    if (s != TZ_OK)
        return s;
    sink->state = w;
    s = tz_module_symbol(sink->ctx, "oiio", TZ_OIIO_SYMBOL, (void *)&w->api);
    if (s == TZ_OK && !sink->out.temp)
        s = spool(sink);
    int32_t n = sink->carrier.meta.n;
    if (s == TZ_OK)
        s = tz_alloc_zero(sink->ctx, &w->meta, 2 * (size_t)n + 1, sizeof *w->meta);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < n; i++) {
        w->meta[2 * i] = sink->carrier.meta.v[i].key;
        w->meta[2 * i + 1] = sink->carrier.meta.v[i].value;
    }
    static const int32_t depth[] = {0, 8, 16, 17, 32};
    bool tiled = !sink->format->gathered;
    tz_oiio_spec spec = {.path = w->spool[0] ? w->spool : sink->out.temp,
                         .format = sink->format->name,
                         .width = sink->width,
                         .height = sink->height,
                         .channels = sink->channels,
                         .alpha = sink->alpha,
                         .depth = depth[sink->type],
                         .tile = tiled ? sink->tile : 0,
                         .quality = sink->quality,
                         .compression = sink->compression,
                         .linear = sink->encoding != TZ_ENCODING_SRGB,
                         .names = (const char(*)[32])sink->names,
                         .meta = w->meta};
    if (tiled)
        sink->band_rows = sink->tile;
    int rc = w->api->open(&spec, &w->out, why, sizeof why);
    return rc == 0 ? TZ_OK : fail(sink, rc, why);
}

static tz_status oiio_band(tz_image_sink *sink, int32_t y, int32_t n, const void *px)
{
    oiio *w = sink->state;
    char why[300] = "";
    int rc = w->api->rows(w->out, y, y + n, px, why, sizeof why);
    return rc == 0 ? TZ_OK : fail(sink, rc, why);
}

static tz_status copy_spool(tz_image_sink *sink)
{
    oiio *w = sink->state;
    char block[16384];
    size_t n;
    tz_status s = TZ_OK;
    FILE *f = fopen(w->spool, "rb");
    if (!f)
        return tz_fail(sink->ctx, TZ_IO, "%s: temporary file %s is gone; try again",
                       sink->shown, w->spool);
    while (s == TZ_OK && (n = fread(block, 1, sizeof block, f)) > 0)
        s = tz_sink_put(sink, block, n);
    fclose(f);
    return s;
}

static tz_status oiio_close(tz_image_sink *sink)
{
    oiio *w = sink->state;
    char why[300] = "";
    int rc = w->api->close(w->out, why, sizeof why);
    w->out = NULL;
    if (rc != 0)
        return fail(sink, rc, why);
    return w->spool[0] ? copy_spool(sink) : TZ_OK;
}

static void oiio_release(tz_image_sink *sink)
{
    oiio *w = sink->state;
    char why[300];
    if (!w)
        return;
    if (w->out)
        w->api->close(w->out, why, sizeof why);
    if (w->spool[0])
        unlink(w->spool);
    tz_free(sink->ctx, w->meta);
    tz_free(sink->ctx, w);
    sink->state = NULL;
}

const tz_sink_format tz_sink_tiff = {
    .name = "tiff",
    .extensions = "tif|tiff",
    .automatic = TZ_SAMPLE_U8,
    /* no half: OpenImageIO would make it float */
    .types = 1u << TZ_SAMPLE_U8 | 1u << TZ_SAMPLE_U16 | 1u << TZ_SAMPLE_FLOAT,
    .channels = tz_sink_channels_any,
    .open = oiio_open,
    .band = oiio_band,
    .close = oiio_close,
    .release = oiio_release,
};

const tz_sink_format tz_sink_webp = {
    .name = "webp",
    .extensions = "webp",
    .automatic = TZ_SAMPLE_U8,
    .types = 1u << TZ_SAMPLE_U8,
    .gathered = true,
    .colour = true,
    .channels = tz_sink_channels_rgba,
    .open = oiio_open,
    .band = oiio_band,
    .close = oiio_close,
    .release = oiio_release,
};

const tz_sink_format tz_sink_hdr = {
    .name = "hdr",
    .extensions = "hdr|rgbe|pic",
    .automatic = TZ_SAMPLE_FLOAT,
    .types = 1u << TZ_SAMPLE_FLOAT,
    .gathered = true,
    .colour = true,
    .channels = tz_sink_channels_opaque,
    .open = oiio_open,
    .band = oiio_band,
    .close = oiio_close,
    .release = oiio_release,
};
