/* SPDX-License-Identifier: Apache-2.0 */
/* Tiled EXR through OpenEXRCore, one row of tiles at a time.
 *
 * The core library writes headers, chunk table and chunks; the chunks themselves are
 * packed here, on all workers: its own ZIP goes through zlib at about 25 MB/s a core, the
 * same format through libdeflate at 150 and more. A ZIP chunk is the tile's samples (line
 * by line, channel after channel in alphabetical order), low bytes before high bytes,
 * each byte as the difference from the one before, in a zlib stream; or the plain samples
 * where that would be larger. */
#include "base/image_sink_internal.h"

#include <errno.h>
#include <libdeflate.h>
#include <openexr.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct tile {
    uint8_t *packed; /* what goes to the file */
    size_t size;
} tile;

typedef struct worker {
    uint8_t *raw, *split;
    struct libdeflate_compressor *deflate;
} worker;

typedef struct exr {
    exr_context_t ctx;
    FILE *f; /* the sink's file, or a temporary one where output is a pipe */
    bool piped;
    int error;                            /* errno of the first failed write */
    int32_t order[TZ_IMAGE_MAX_CHANNELS]; /* file order -> channel of the band */
    int32_t across;
    tile *tiles; /* one row of them */
    worker *workers;
    int n_workers;
    size_t tile_bytes;
} exr;

static int64_t on_write(exr_const_context_t ctxt, void *user, const void *data,
                        uint64_t size, uint64_t offset,
                        exr_stream_error_func_ptr_t error_cb)
{
    (void)ctxt;
    (void)error_cb;
    exr *w = user;
    const char *p = data;
    uint64_t done = 0;
    while (done < size) {
        ssize_t n = pwrite(fileno(w->f), p + done, size - done, (off_t)(offset + done));
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0) {
            if (!w->error)
                w->error = n < 0 ? errno : EIO;
            return -1;
        }
        done += (uint64_t)n;
    }
    return (int64_t)size;
}

static void on_error(exr_const_context_t ctxt, exr_result_t code, const char *text)
{
    (void)ctxt;
    (void)code;
    (void)text;
}

static tz_status fail(tz_image_sink *sink, exr_result_t rc)
{
    exr *w = sink->state;
    char text[128];
    if (rc == EXR_ERR_OUT_OF_MEMORY)
        return tz_fail(sink->ctx, TZ_NOMEM, "%s: out of memory", sink->shown);
    if (w->error)
        return tz_fail(sink->ctx, TZ_IO, "%s: cannot write: %s; %s", sink->shown,
                       strerror_r(w->error, text, sizeof text),
                       w->error == ENOSPC ? "free some space or write elsewhere"
                                          : "check the device");
    return tz_fail(sink->ctx, TZ_IO, "%s: cannot write: %s; check names and sizes",
                   sink->shown, exr_get_default_error_message(rc));
}

/* ---- opening
 * --------------------------------------------------------------------------- */

static tz_status make_buffers(tz_image_sink *sink)
{
    exr *w = sink->state;
    tz_ctx *ctx = sink->ctx;
    size_t side = (size_t)sink->tile;
    w->tile_bytes = side * side * (size_t)(sink->channels * sink->sample_size);
    w->across = (sink->width + sink->tile - 1) / sink->tile;
    w->n_workers = tz_ctx_threads(ctx);
    tz_status s = tz_alloc_zero(ctx, &w->tiles, (size_t)w->across, sizeof *w->tiles);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &w->workers, (size_t)w->n_workers, sizeof *w->workers);
    for (int32_t i = 0; i < w->across && s == TZ_OK; i++)
        s = tz_alloc(ctx, &w->tiles[i].packed, w->tile_bytes, 1);
    for (int i = 0; i < w->n_workers && s == TZ_OK; i++) {
        worker *k = &w->workers[i];
        s = tz_alloc(ctx, &k->raw, w->tile_bytes, 1);
        if (s == TZ_OK)
            s = tz_alloc(ctx, &k->split, w->tile_bytes, 1);
        if (s == TZ_OK && sink->compression > 0) {
            k->deflate = libdeflate_alloc_compressor(sink->compression);
            if (!k->deflate)
                s = tz_fail(ctx, TZ_NOMEM, "%s: out of memory", sink->shown);
        }
    }
    return s;
}

/* Channels in a file stand in alphabetical order. */
static void sort_channels(tz_image_sink *sink)
{
    exr *w = sink->state;
    for (int32_t c = 0; c < sink->channels; c++) {
        int32_t at = c;
        for (; at > 0 && strcmp(sink->names[w->order[at - 1]], sink->names[c]) > 0; at--)
            w->order[at] = w->order[at - 1];
        w->order[at] = c;
    }
}

static exr_result_t write_header(tz_image_sink *sink)
{
    exr *w = sink->state;
    int part;
    exr_result_t rc = exr_set_longname_support(w->ctx, 1);
    if (rc == EXR_ERR_SUCCESS)
        rc = exr_add_part(w->ctx, "image", EXR_STORAGE_TILED, &part);
    if (rc == EXR_ERR_SUCCESS)
        rc = exr_initialize_required_attr_simple(
            w->ctx, 0, sink->width, sink->height,
            sink->compression > 0 ? EXR_COMPRESSION_ZIP : EXR_COMPRESSION_NONE);
    if (rc == EXR_ERR_SUCCESS)
        rc =
            exr_set_tile_descriptor(w->ctx, 0, (uint32_t)sink->tile, (uint32_t)sink->tile,
                                    EXR_TILE_ONE_LEVEL, EXR_TILE_ROUND_DOWN);
    for (int32_t c = 0; c < sink->channels && rc == EXR_ERR_SUCCESS; c++)
        rc = exr_add_channel(w->ctx, 0, sink->names[w->order[c]],
                             sink->type == TZ_SAMPLE_HALF ? EXR_PIXEL_HALF
                                                          : EXR_PIXEL_FLOAT,
                             EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    /* a name that the format reserves for an attribute of another type is left out */
    for (int32_t i = 0; i < sink->carrier.meta.n && rc == EXR_ERR_SUCCESS; i++) {
        const tz_meta *m = &sink->carrier.meta.v[i];
        if (m->key[0] && strlen(m->key) < 256 &&
            exr_attr_set_string(w->ctx, 0, m->key, m->value) == EXR_ERR_OUT_OF_MEMORY)
            rc = EXR_ERR_OUT_OF_MEMORY;
    }
    if (rc == EXR_ERR_SUCCESS)
        rc = exr_write_header(w->ctx);
    return rc;
}

static tz_status exr_open(tz_image_sink *sink)
{
    exr *w;
    tz_status s = tz_alloc_zero(sink->ctx, &w, 1, sizeof *w);
    if (s != TZ_OK)
        return s;
    sink->state = w;
    sink->band_rows = sink->tile;
    w->f = sink->out.f;
    w->piped = !sink->out.temp; /* pipes cannot go back to fill in the chunk table */
    if (w->piped && !(w->f = tmpfile())) {
        w->piped = false;
        return tz_fail(sink->ctx, TZ_IO, "%s: no temporary file; set TMPDIR",
                       sink->shown);
    }
    sort_channels(sink);
    s = make_buffers(sink);
    if (s != TZ_OK)
        return s;
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    init.error_handler_fn = on_error;
    init.user_data = w;
    init.write_fn = on_write;
    exr_result_t rc =
        exr_start_write(&w->ctx, sink->shown, EXR_WRITE_FILE_DIRECTLY, &init);
    if (rc == EXR_ERR_SUCCESS)
        rc = write_header(sink);
    return rc == EXR_ERR_SUCCESS ? TZ_OK : fail(sink, rc);
}

/* ---- tiles
 * --------------------------------------------------------------------------------- */

typedef struct band_job {
    tz_image_sink *sink;
    const uint8_t *px;
    int32_t n;
} band_job;

static void gather16(const uint16_t *from, int32_t n, int32_t step, uint16_t *to)
{
    for (int32_t i = 0; i < n; i++)
        to[i] = from[(ptrdiff_t)i * step];
}

static void gather32(const uint32_t *from, int32_t n, int32_t step, uint32_t *to)
{
    for (int32_t i = 0; i < n; i++)
        to[i] = from[(ptrdiff_t)i * step];
}

/* Samples of one tile in file order; returns their size. */
static size_t gather(const band_job *job, int32_t x0, int32_t w, uint8_t *to)
{
    const tz_image_sink *sink = job->sink;
    const exr *e = sink->state;
    uint8_t *begin = to;
    for (int32_t y = 0; y < job->n; y++) {
        for (int32_t c = 0; c < sink->channels; c++) {
            size_t sample = (size_t)x0 * (size_t)sink->channels + (size_t)e->order[c];
            const uint8_t *from = job->px + (size_t)y * sink->row_bytes +
                                  sample * (size_t)sink->sample_size;
            if (sink->sample_size == 2)
                gather16((const void *)from, w, sink->channels, (void *)to);
            else
                gather32((const void *)from, w, sink->channels, (void *)to);
            to += (size_t)w * (size_t)sink->sample_size;
        }
    }
    return (size_t)(to - begin);
}

/* Bytes 0, 2, 4, ... then 1, 3, 5, ..., each as difference + 128. */
static void predict(const uint8_t *restrict raw, size_t n, uint8_t *restrict split,
                    uint8_t *restrict out)
{
    size_t half = (n + 1) / 2;
    for (size_t i = 0; i < n / 2; i++) {
        split[i] = raw[2 * i];
        split[half + i] = raw[2 * i + 1];
    }
    out[0] = split[0];
    for (size_t i = 1; i < n; i++)
        out[i] = (uint8_t)(split[i] - split[i - 1] + 128);
}

static tz_status pack_tile(tz_ctx *ctx, void *arg, int64_t index, int worker_index)
{
    (void)ctx;
    const band_job *job = arg;
    const tz_image_sink *sink = job->sink;
    exr *e = sink->state;
    worker *k = &e->workers[worker_index];
    tile *t = &e->tiles[index];
    int32_t x0 = (int32_t)index * sink->tile, w = sink->width - x0;
    if (w > sink->tile)
        w = sink->tile;
    size_t n = gather(job, x0, w, k->raw);
    t->size = 0;
    if (k->deflate) {
        /* t->packed is free until the result is in: it serves as scratch, then */
        predict(k->raw, n, t->packed, k->split);
        t->size = libdeflate_zlib_compress(k->deflate, k->split, n, t->packed, n - 1);
    }
    if (t->size == 0) { /* not smaller */
        memcpy(t->packed, k->raw, n);
        t->size = n;
    }
    return TZ_OK;
}

static tz_status exr_band(tz_image_sink *sink, int32_t y, int32_t n, const void *px)
{
    exr *e = sink->state;
    band_job job = {sink, px, n};
    tz_status s = tz_parallel_for(sink->ctx, e->across, pack_tile, &job);
    for (int32_t i = 0; i < e->across && s == TZ_OK; i++) {
        exr_result_t rc = exr_write_tile_chunk(e->ctx, 0, i, y / sink->tile, 0, 0,
                                               e->tiles[i].packed, e->tiles[i].size);
        if (rc != EXR_ERR_SUCCESS)
            s = fail(sink, rc);
    }
    return s;
}

static tz_status exr_close(tz_image_sink *sink)
{
    exr *e = sink->state;
    exr_result_t rc = exr_finish(&e->ctx);
    e->ctx = NULL;
    if (rc != EXR_ERR_SUCCESS || e->error)
        return fail(sink, rc);
    if (!e->piped)
        return TZ_OK;
    size_t n;
    tz_status s = TZ_OK;
    rewind(e->f);
    while (s == TZ_OK && (n = fread(e->workers[0].raw, 1, e->tile_bytes, e->f)) > 0)
        s = tz_sink_put(sink, e->workers[0].raw, n);
    return s;
}

static void exr_release(tz_image_sink *sink)
{
    exr *e = sink->state;
    if (!e)
        return;
    if (e->ctx)
        exr_finish(&e->ctx);
    if (e->piped)
        fclose(e->f);
    for (int32_t i = 0; e->tiles && i < e->across; i++)
        tz_free(sink->ctx, e->tiles[i].packed);
    for (int i = 0; e->workers && i < e->n_workers; i++) {
        tz_free(sink->ctx, e->workers[i].raw);
        tz_free(sink->ctx, e->workers[i].split);
        libdeflate_free_compressor(e->workers[i].deflate);
    }
    tz_free(sink->ctx, e->tiles);
    tz_free(sink->ctx, e->workers);
    tz_free(sink->ctx, e);
    sink->state = NULL;
}

const tz_sink_format tz_sink_exr = {
    .name = "exr",
    .extensions = "exr",
    .automatic = TZ_SAMPLE_HALF,
    .types = 1u << TZ_SAMPLE_HALF | 1u << TZ_SAMPLE_FLOAT,
    .associated = true,
    .channels = tz_sink_channels_any,
    .open = exr_open,
    .band = exr_band,
    .close = exr_close,
    .release = exr_release,
};
