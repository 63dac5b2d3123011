/* SPDX-License-Identifier: Apache-2.0 */
/* PNG, compressed in parallel. The picture is cut into pieces of rows; each piece is
 * filtered and deflated apart and ends on a byte, so that the pieces joined are one
 * ordinary zlib stream which every reader takes:
 *
 *   IDAT: header, piece 0 | IDAT: piece 1 | ... | IDAT: last piece, Adler-32 of all
 *
 * Pieces depend on the picture alone, so the bytes are the same at any thread count. */
#include "base/image_sink_internal.h"

#include <libdeflate.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "base/deflate_internal.h"

enum { PIECE_BYTES = 256 << 10, FILTERS = 5 };

typedef struct piece {
    uint8_t *packed;
    size_t size, room;
    uint32_t adler;
    size_t raw; /* bytes before compression */
} piece;

typedef struct png {
    int32_t piece_rows;
    uint8_t *above; /* last row of the band before; zero at the top */
    TZ_ARRAY(piece)
    piece;
    uint8_t **scratch; /* a worker: one filtered piece, and FILTERS trial rows */
    int workers;
    uint32_t adler;
} png;

/* ---- chunks --------------------------------------------------------------------------
 */

static void put32(uint8_t *p, uint32_t v)
{
    p[0] = (uint8_t)(v >> 24);
    p[1] = (uint8_t)(v >> 16);
    p[2] = (uint8_t)(v >> 8);
    p[3] = (uint8_t)v;
}

/* A chunk whose data come in two parts. */
static tz_status put_chunk(tz_image_sink *sink, const char *type, const void *a,
                           size_t na, const void *b, size_t nb)
{
    uint8_t head[8], tail[4];
    put32(head, (uint32_t)(na + nb));
    memcpy(head + 4, type, 4);
    uint32_t crc = libdeflate_crc32(0, head + 4, 4);
    crc = na ? libdeflate_crc32(crc, a, na) : crc;
    crc = nb ? libdeflate_crc32(crc, b, nb) : crc;
    put32(tail, crc);
    tz_status s = tz_sink_put(sink, head, 8);
    if (s == TZ_OK && na)
        s = tz_sink_put(sink, a, na);
    if (s == TZ_OK && nb)
        s = tz_sink_put(sink, b, nb);
    return s == TZ_OK ? tz_sink_put(sink, tail, 4) : s;
}

/* iTXt: keyword, uncompressed, no language; keys are at most 79 bytes of Latin-1. */
static tz_status put_text(tz_image_sink *sink, const tz_meta *m)
{
    char head[96] = {0};
    size_t n = strlen(m->key), size = strlen(m->value);
    if (n < 1 || n > 79 || size > 0x7fffff00)
        return TZ_OK;
    memcpy(head, m->key, n); /* then: 0, compressed 0, method 0, language "", key "" */
    return put_chunk(sink, "iTXt", head, n + 5, m->value, size);
}

static tz_status png_open(tz_image_sink *sink)
{
    static const uint8_t colour_type[5] = {0, 0, 4, 2, 6};
    tz_ctx *ctx = sink->ctx;
    png *w;
    tz_status s = tz_alloc_zero(ctx, &w, 1, sizeof *w);
    if (s != TZ_OK)
        return s;
    sink->state = w;
    size_t row = (size_t)sink->width * (size_t)sink->channels * (size_t)sink->sample_size;
    w->piece_rows = (int32_t)(PIECE_BYTES / (row + 1)) + 1;
    sink->band_rows = w->piece_rows * (int32_t)(((size_t)8 << 20) / PIECE_BYTES);
    /* wide pictures: as many pieces as keep a crowd of workers busy, and no more */
    if ((size_t)sink->band_rows * row > (size_t)32 << 20)
        sink->band_rows = w->piece_rows * 16;
    w->workers = tz_ctx_threads(ctx);
    w->adler = 1;
    s = tz_alloc_zero(ctx, &w->above, row, 1);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &w->scratch, (size_t)w->workers, sizeof *w->scratch);
    for (int i = 0; i < w->workers && s == TZ_OK; i++)
        s = tz_alloc(ctx, &w->scratch[i], (size_t)w->piece_rows + FILTERS, row + 1);

    uint8_t ihdr[13] = {0};
    put32(ihdr, (uint32_t)sink->width);
    put32(ihdr + 4, (uint32_t)sink->height);
    ihdr[8] = (uint8_t)(8 * sink->sample_size);
    ihdr[9] = colour_type[sink->channels];
    if (s == TZ_OK)
        s = tz_sink_put(sink, "\x89PNG\r\n\x1a\n", 8);
    if (s == TZ_OK)
        s = put_chunk(sink, "IHDR", ihdr, sizeof ihdr, NULL, 0);
    if (s == TZ_OK && sink->encoding == TZ_ENCODING_SRGB)
        s = put_chunk(sink, "sRGB", "", 1, NULL, 0);
    for (int32_t i = 0; i < sink->carrier.meta.n && s == TZ_OK; i++)
        s = put_text(sink, &sink->carrier.meta.v[i]);
    return s;
}

/* ---- filters -------------------------------------------------------------------------
 */

/* Predictors of PNG: none, left, above, mean of both, Paeth. `bpp`: bytes a pixel. */
static void filter_row(int type, const uint8_t *restrict p, const uint8_t *restrict up,
                       uint8_t *restrict to, size_t n, size_t bpp)
{
    size_t i = 0;
    *to++ = (uint8_t)type;
    switch (type) {
    case 0: memcpy(to, p, n); break;
    case 1:
        for (; i < bpp && i < n; i++)
            to[i] = p[i];
        for (; i < n; i++)
            to[i] = (uint8_t)(p[i] - p[i - bpp]);
        break;
    case 2:
        for (; i < n; i++)
            to[i] = (uint8_t)(p[i] - up[i]);
        break;
    case 3:
        for (; i < bpp && i < n; i++)
            to[i] = (uint8_t)(p[i] - up[i] / 2);
        for (; i < n; i++)
            to[i] = (uint8_t)(p[i] - (p[i - bpp] + up[i]) / 2);
        break;
    default:
        for (; i < bpp && i < n; i++)
            to[i] = (uint8_t)(p[i] - up[i]);
        for (; i < n; i++) {
            int16_t a = p[i - bpp], b = up[i], c = up[i - bpp];
            int16_t pa = (int16_t)abs(b - c), pb = (int16_t)abs(a - c);
            int16_t pc = (int16_t)abs(a + b - 2 * c);
            int16_t q = pb <= pc ? b : c, r = pa <= pb && pa <= pc ? a : q;
            to[i] = (uint8_t)(p[i] - r);
        }
    }
}

/* Sum of absolute residues: the usual guess at what will deflate best. */
static uint64_t cost(const uint8_t *p, size_t n)
{
    uint64_t sum = 0;
    while (n > 0) {
        size_t part = n < 4096 ? n : 4096;
        uint32_t s = 0;
        for (size_t i = 0; i < part; i++)
            s += (uint32_t)abs((int8_t)p[i]);
        sum += s;
        p += part;
        n -= part;
    }
    return sum;
}

/* ---- pieces --------------------------------------------------------------------------
 */

typedef struct band_job {
    tz_image_sink *sink;
    png *w;
    const uint8_t *px;
    int32_t y, n;
} band_job;

/* 16-bit samples are stored high byte first. */
static const uint8_t *big_endian(const tz_image_sink *sink, const uint8_t *row,
                                 uint8_t *to)
{
    if (sink->sample_size == 1)
        return row;
    for (size_t i = 0; i < sink->row_bytes; i += 2) {
        uint16_t v;
        memcpy(&v, row + i, 2);
        to[i] = (uint8_t)(v >> 8);
        to[i + 1] = (uint8_t)v;
    }
    return to;
}

/* zlib, for the higher levels; ends on a byte by a full flush. */
static tz_status deflate_zlib(tz_ctx *ctx, piece *out, const uint8_t *data, size_t n,
                              int level, bool last)
{
    z_stream z = {.next_in = (Bytef *)(uintptr_t)data,
                  .avail_in = (uInt)n,
                  .next_out = out->packed,
                  .avail_out = (uInt)out->room};
    if (deflateInit2(&z, level, Z_DEFLATED, -15, 9, Z_FILTERED) != Z_OK)
        return tz_fail(ctx, TZ_NOMEM, "out of memory for compression");
    int rc = deflate(&z, last ? Z_FINISH : Z_FULL_FLUSH);
    out->size = z.total_out;
    deflateEnd(&z);
    return rc == Z_OK || rc == Z_STREAM_END
               ? TZ_OK
               : tz_fail(ctx, TZ_INVALID, "zlib could not compress (%d)", rc);
}

static tz_status pack_piece(tz_ctx *ctx, void *arg, int64_t index, int worker)
{
    const band_job *job = arg;
    tz_image_sink *sink = job->sink;
    png *w = job->w;
    piece *out = &w->piece.v[index];
    size_t row = sink->row_bytes,
           bpp = (size_t)sink->channels * (size_t)sink->sample_size;
    int32_t y0 = (int32_t)index * w->piece_rows, y1 = y0 + w->piece_rows;
    if (y1 > job->n)
        y1 = job->n;
    uint8_t *filtered = w->scratch[worker], *to = filtered;
    uint8_t *trial = filtered + (size_t)w->piece_rows * (row + 1);
    /* swapped rows, two in turn, stand behind the trial rows' first three */
    uint8_t *swap[2] = {trial + 3 * (row + 1), trial + 4 * (row + 1)};
    /* Of the five, 'above' and 'Paeth' win nearly always on photos; a flat picture is
     * small either way. */
    static const int candidates[] = {2, 4, 1};
    const uint8_t *up = y0 > 0 ? job->px + (size_t)(y0 - 1) * row : w->above;
    up = big_endian(sink, up, swap[~y0 & 1]);
    int best = 4;
    for (int32_t y = y0; y < y1; y++, to += row + 1) {
        const uint8_t *p = big_endian(sink, job->px + (size_t)y * row, swap[y & 1]);
        if (sink->compression == 0) {
            filter_row(0, p, up, to, row, bpp);
        } else if ((y - y0) % 4 == 0) { /* rows alike: choose for four at a time */
            uint64_t least = UINT64_MAX;
            int pick = 0;
            for (int k = 0; k < 3; k++) {
                filter_row(candidates[k], p, up, trial + (size_t)k * (row + 1), row, bpp);
                uint64_t sum = cost(trial + (size_t)k * (row + 1) + 1, row);
                if (sum < least) {
                    least = sum;
                    pick = k;
                }
            }
            memcpy(to, trial + (size_t)pick * (row + 1), row + 1);
            best = candidates[pick];
        } else {
            filter_row(best, p, up, to, row, bpp);
        }
        up = p;
    }
    out->raw = (size_t)(to - filtered);
    out->adler = libdeflate_adler32(1, filtered, out->raw);
    bool last = job->y + y1 == sink->height;
    if (sink->compression == 1) {
        out->size = tz_deflate_fast(filtered, out->raw, out->packed, last);
        return TZ_OK;
    }
    return deflate_zlib(ctx, out, filtered, out->raw, sink->compression, last);
}

static tz_status png_band(tz_image_sink *sink, int32_t y, int32_t n, const void *px)
{
    png *w = sink->state;
    tz_ctx *ctx = sink->ctx;
    int32_t pieces = (n + w->piece_rows - 1) / w->piece_rows;
    tz_status s = tz_array_reserve(ctx, &w->piece, pieces);
    size_t raw = (size_t)w->piece_rows * (sink->row_bytes + 1),
           room = tz_deflate_bound(raw);
    while (w->piece.n < pieces && s == TZ_OK) {
        piece fresh = {.room = room};
        s = tz_alloc(ctx, &fresh.packed, room, 1);
        if (s == TZ_OK)
            s = tz_array_push(ctx, &w->piece, fresh);
    }
    if (s != TZ_OK)
        return s;
    band_job job = {sink, w, px, y, n};
    s = tz_parallel_for(ctx, pieces, pack_piece, &job);
    for (int32_t i = 0; i < pieces && s == TZ_OK; i++) {
        piece *p = &w->piece.v[i];
        w->adler = (uint32_t)adler32_combine(w->adler, p->adler, (z_off_t)p->raw);
        bool first = y == 0 && i == 0, last = y + n == sink->height && i == pieces - 1;
        if (last) {
            put32(p->packed + p->size, w->adler);
            p->size += 4;
        }
        s = put_chunk(sink, "IDAT", "\x78\x01", first ? 2 : 0, p->packed, p->size);
    }
    memcpy(w->above, (const uint8_t *)px + (size_t)(n - 1) * sink->row_bytes,
           sink->row_bytes);
    return s;
}

static tz_status png_close(tz_image_sink *sink)
{
    return put_chunk(sink, "IEND", NULL, 0, NULL, 0);
}

static void png_release(tz_image_sink *sink)
{
    png *w = sink->state;
    if (!w)
        return;
    for (int32_t i = 0; i < w->piece.n; i++)
        tz_free(sink->ctx, w->piece.v[i].packed);
    tz_array_free(sink->ctx, &w->piece);
    for (int i = 0; w->scratch && i < w->workers; i++)
        tz_free(sink->ctx, w->scratch[i]);
    tz_free(sink->ctx, w->scratch);
    tz_free(sink->ctx, w->above);
    tz_free(sink->ctx, w);
    sink->state = NULL;
}

const tz_sink_format tz_sink_png = {
    .name = "png",
    .extensions = "png",
    .automatic = TZ_SAMPLE_U8,
    .types = 1u << TZ_SAMPLE_U8 | 1u << TZ_SAMPLE_U16,
    .channels = tz_sink_channels_rgba,
    .open = png_open,
    .band = png_band,
    .close = png_close,
    .release = png_release,
};
