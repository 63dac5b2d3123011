/* SPDX-License-Identifier: Apache-2.0 */
/* Writing: rows come in as floats, are converted in parallel to the file's samples, and
 * gathered into bands that the format compresses.
 *
 *   rows ──convert──▶ band (band_rows rows of samples) ──format->band──▶ temporary file
 *                                                      close: rename to the final name */
#include "base/image_sink_internal.h"

#include <assert.h>
#include <errno.h>
#include <string.h>
#include <strings.h>

static const tz_sink_format *const formats[] = {
    &tz_sink_png, &tz_sink_exr, &tz_sink_tiff, &tz_sink_jpeg, &tz_sink_webp, &tz_sink_hdr,
};

#define GATHER_LIMIT ((int64_t)1 << 28)

/* ---- choice of the format ------------------------------------------------------------
 */

static bool in_list(const char *list, const char *word)
{
    size_t n = strlen(word);
    for (; *list; list += strcspn(list, "|"), list += *list == '|')
        if (strcspn(list, "|") == n && strncasecmp(list, word, n) == 0)
            return true;
    return false;
}

static tz_status find_format(tz_image_sink *sink, const char *path, const char *name)
{
    const char *dot = strrchr(path, '.'), *slash = strrchr(path, '/');
    if (!name && dot && (!slash || dot > slash))
        name = dot + 1;
    if (!name || !name[0])
        return tz_fail(
            sink->ctx, TZ_UNSUPPORTED,
            "%s: which image format? Give a name that ends in .png, .exr, .tif, "
            ".jpg, .webp or .hdr, or name the format",
            path);
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        if (in_list(formats[i]->extensions, name)) {
            sink->format = formats[i];
            return TZ_OK;
        }
    }
    return tz_fail(
        sink->ctx, TZ_UNSUPPORTED,
        "%s: image format '%s' cannot be written; use png, exr, tif, jpg, webp "
        "or hdr",
        path, name);
}

/* ---- channel rules ------------------------------------------------------------------
 */

tz_status tz_sink_channels_any(tz_image_sink *sink, const tz_image *like)
{
    sink->channels = like->channels;
    sink->alpha = like->alpha;
    for (int32_t c = 0; c < like->channels; c++)
        sink->map[c] = (int8_t)c;
    return TZ_OK;
}

static tz_status too_many(tz_image_sink *sink, const tz_image *like)
{
    return tz_fail(sink->ctx, TZ_UNSUPPORTED,
                   "%s: %s holds grey or RGB, with or without alpha, and not these %d "
                   "channels; write exr or tif",
                   sink->shown, sink->format->name, like->channels);
}

tz_status tz_sink_channels_rgba(tz_image_sink *sink, const tz_image *like)
{
    int32_t colours = like->channels - (like->alpha >= 0);
    if (colours != 1 && colours != 3)
        return too_many(sink, like);
    tz_sink_channels_any(sink, like);
    if (like->alpha >= 0) { /* alpha comes last in the file */
        for (int32_t c = like->alpha; c < colours; c++)
            sink->map[c] = (int8_t)(c + 1);
        sink->map[colours] = (int8_t)like->alpha;
        sink->alpha = colours;
    }
    if (sink->format->colour && colours == 1) {
        int8_t grey = sink->map[0], alpha = sink->map[1];
        sink->map[0] = sink->map[1] = sink->map[2] = grey;
        sink->map[3] = alpha;
        sink->channels += 2;
        sink->alpha = like->alpha >= 0 ? 3 : -1;
    }
    return TZ_OK;
}

tz_status tz_sink_channels_opaque(tz_image_sink *sink, const tz_image *like)
{
    tz_status s = tz_sink_channels_rgba(sink, like);
    if (s == TZ_OK && sink->alpha >= 0) {
        tz_warn(sink->ctx, "%s: %s has no alpha channel; it is left out", sink->shown,
                sink->format->name);
        sink->channels--;
        sink->alpha = -1;
    }
    return s;
}

/* ---- conversion ---------------------------------------------------------------------
 */

/* Linear float -> 8-bit sRGB, exactly rounded, without a power. Codes change at 255
 * thresholds. A float's top 20 bits select one of 2^11 buckets an octave, so narrow that
 * each holds one threshold at most: the code at the bucket's start, plus one comparison.
 */
enum { BUCKET_SHIFT = 12, BUCKETS = 13 << 11 };
#define FIRST_BITS 0x39000000u /* 2^-13, below the first threshold */

static float from_bits(uint32_t bits)
{
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static uint32_t to_bits(float x)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static tz_status make_codes(tz_image_sink *sink)
{
    tz_status s = tz_alloc(sink->ctx, &sink->code_of, BUCKETS, 1);
    if (s != TZ_OK)
        return s;
    for (int c = 1; c < 256; c++)
        sink->threshold[c] = tz_srgb_decode(((float)c - 0.5f) / 255.0f);
    sink->threshold[256] = 2.0f;
    int code = 0;
    for (uint32_t b = 0; b < BUCKETS; b++) {
        float x = from_bits(FIRST_BITS + (b << BUCKET_SHIFT));
        while (x >= sink->threshold[code + 1])
            code++;
        sink->code_of[b] = (uint8_t)code;
    }
    return TZ_OK;
}

/* Linear light of 0..1 for half samples, by steps of 1 / DECODE_STEPS and a chord between:
 * off by 1e-8 at most, and by less than a tenth of a half's last place. */
enum { DECODE_STEPS = 8192 };

static tz_status make_decode(tz_image_sink *sink)
{
    tz_status s =
        tz_alloc(sink->ctx, &sink->decode, DECODE_STEPS + 2, sizeof *sink->decode);
    for (int k = 0; s == TZ_OK && k < DECODE_STEPS + 2; k++)
        sink->decode[k] = tz_srgb_decode((float)k / DECODE_STEPS);
    return s;
}

static inline float decode_half(const tz_image_sink *sink, float v)
{
    if (!(v >= 0 && v <= 1))
        return tz_srgb_decode(v);
    const float at = v * DECODE_STEPS;
    const int i = (int)at;
    return sink->decode[i] + (at - (float)i) * (sink->decode[i + 1] - sink->decode[i]);
}

static inline uint8_t code8(const tz_image_sink *sink, float x)
{
    if (!(x >= 0x1p-13f)) /* also not-a-number */
        return 0;
    if (x >= 1.0f)
        return 255;
    int c = sink->code_of[(to_bits(x) - FIRST_BITS) >> BUCKET_SHIFT];
    return (uint8_t)(c + (x >= sink->threshold[c + 1]));
}

static inline float unit(float x) { return x > 0.0f ? (x < 1.0f ? x : 1.0f) : 0.0f; }

/* Round to nearest even; beyond the range of a half the largest one, not a number gives
 * 0. */
static inline uint16_t to_half(float x)
{
    uint32_t bits = to_bits(x), sign = bits >> 16 & 0x8000u, u = bits & 0x7fffffffu;
    u = u > 0x7f800000u ? 0 : u > 0x477fe000u ? 0x477fe000u : u;
    /* small ones: adding 0.5 lets the adder shift and round the mantissa into place */
    uint32_t small = to_bits(from_bits(u) + 0.5f) - 0x3f000000u;
    uint32_t large = (u - (112u << 23) + 0xfffu + (u >> 13 & 1)) >> 13;
    return (uint16_t)(sign | (u < 0x38800000u ? small : large));
}

typedef struct convert_job {
    tz_image_sink *sink;
    const tz_image *rows;
    int32_t from; /* first of the rows */
    uint8_t *to;
} convert_job;

/* One row into floats in the file's encoding and channel order. */
static void encode_row(const tz_image_sink *sink, tz_encoding from, const float *p,
                       float *to)
{
    bool encode = from == TZ_ENCODING_LINEAR && sink->encoding == TZ_ENCODING_SRGB;
    bool decode = from == TZ_ENCODING_SRGB && sink->encoding == TZ_ENCODING_LINEAR;
    for (int32_t x = 0; x < sink->width; x++, p += sink->in_channels) {
        for (int32_t c = 0; c < sink->channels; c++) {
            float v = p[sink->map[c]];
            if (c != sink->alpha && encode)
                v = tz_srgb_encode(v);
            else if (c != sink->alpha && decode)
                v = sink->decode ? decode_half(sink, v) : tz_srgb_decode(v);
            *to++ = v;
        }
        if (sink->format->associated && sink->alpha >= 0 &&
            sink->encoding != TZ_ENCODING_DATA && from != TZ_ENCODING_DATA)
            for (int32_t c = 0; c < sink->channels; c++)
                to[c - sink->channels] *=
                    c == sink->alpha ? 1 : p[sink->map[sink->alpha]];
    }
}

/* The commonest case by itself: linear colour to 8 bits. */
static void encode_row8(const tz_image_sink *sink, const float *p, uint8_t *to)
{
    for (int32_t x = 0; x < sink->width; x++, p += sink->in_channels)
        for (int32_t c = 0; c < sink->channels; c++) {
            float v = p[sink->map[c]];
            *to++ =
                c == sink->alpha ? (uint8_t)(unit(v) * 255.0f + 0.5f) : code8(sink, v);
        }
}

enum { CHUNK = 4096 }; /* samples converted at a time, on the stack */

static void pack(tz_sample_type type, const float *p, int64_t n, uint8_t *to)
{
    switch (type) {
    case TZ_SAMPLE_U8:
        for (int64_t i = 0; i < n; i++)
            to[i] = (uint8_t)(unit(p[i]) * 255.0f + 0.5f);
        break;
    case TZ_SAMPLE_U16: {
        uint16_t *q = (uint16_t *)(void *)to;
        for (int64_t i = 0; i < n; i++)
            q[i] = (uint16_t)(unit(p[i]) * 65535.0f + 0.5f);
        break;
    }
    case TZ_SAMPLE_HALF: {
        uint16_t *q = (uint16_t *)(void *)to;
        for (int64_t i = 0; i < n; i++)
            q[i] = to_half(p[i]);
        break;
    }
    default: {
        float *q = (float *)(void *)to;
        for (int64_t i = 0; i < n; i++)
            q[i] = isfinite(p[i]) ? p[i] : 0.0f;
    }
    }
}

static tz_status convert_row(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    (void)ctx;
    (void)worker;
    const convert_job *job = arg;
    const tz_image_sink *sink = job->sink;
    const float *p = tz_image_at(job->rows, 0, job->from + (int32_t)i);
    uint8_t *to = job->to + (size_t)i * sink->row_bytes;
    tz_encoding from = job->rows->encoding;
    if (sink->code_of && from == TZ_ENCODING_LINEAR) {
        encode_row8(sink, p, to);
        return TZ_OK;
    }
    bool same = from == sink->encoding || from == TZ_ENCODING_DATA ||
                sink->encoding == TZ_ENCODING_DATA;
    for (int32_t c = 0; c < sink->channels; c++)
        same = same && sink->map[c] == c;
    same = same && !(sink->format->associated && sink->alpha >= 0);
    if (same && sink->channels == sink->in_channels) {
        pack(sink->type, p, (int64_t)sink->width * sink->channels, to);
        return TZ_OK;
    }
    float chunk[CHUNK] = {0};
    tz_image_sink part = *sink; /* a narrower sink: so many pixels at a time */
    int32_t step = CHUNK / sink->channels;
    for (int32_t x = 0; x < sink->width; x += step) {
        part.width = sink->width - x < step ? sink->width - x : step;
        encode_row(&part, from, p + (int64_t)x * sink->in_channels, chunk);
        pack(sink->type, chunk, (int64_t)part.width * sink->channels,
             to + (size_t)x * (size_t)sink->channels * (size_t)sink->sample_size);
    }
    return TZ_OK;
}

/* ---- life ---------------------------------------------------------------------------
 */

tz_status tz_sink_put(tz_image_sink *sink, const void *data, size_t size)
{
    if (fwrite(data, 1, size, sink->out.f) == size)
        return TZ_OK;
    char text[128];
    int error = errno;
    return tz_fail(sink->ctx, TZ_IO, "%s: cannot write: %s; %s", sink->shown,
                   strerror_r(error, text, sizeof text),
                   error == ENOSPC ? "free some space or write elsewhere"
                                   : "check the device");
}

static void sink_free(tz_image_sink *sink)
{
    if (!sink)
        return;
    tz_ctx *ctx = sink->ctx;
    if (sink->format && sink->format->release)
        sink->format->release(sink);
    tz_file_out_abort(&sink->out);
    tz_image_deinit(&sink->carrier);
    tz_free(ctx, sink->band);
    tz_free(ctx, sink->code_of);
    tz_free(ctx, sink->decode);
    tz_free(ctx, sink->shown);
    tz_free(ctx, sink);
}

static tz_status choose_type(tz_image_sink *sink, tz_sample_type type,
                             const tz_image *like)
{
    static const char *const names[] = {"auto", "8-bit", "16-bit", "half", "float"};
    static const int32_t sizes[] = {0, 1, 2, 2, 4};
    if (type == TZ_SAMPLE_AUTO)
        type = sink->format->automatic;
    if (!(sink->format->types & 1u << type))
        return tz_fail(sink->ctx, TZ_UNSUPPORTED,
                       "%s: %s holds no %s samples; choose another depth or format",
                       sink->shown, sink->format->name, names[type]);
    sink->type = type;
    sink->sample_size = sizes[type];
    bool integer = type == TZ_SAMPLE_U8 || type == TZ_SAMPLE_U16;
    sink->encoding = like->encoding == TZ_ENCODING_DATA ? TZ_ENCODING_DATA
                     : integer                          ? TZ_ENCODING_SRGB
                                                        : TZ_ENCODING_LINEAR;
    return TZ_OK;
}

static tz_status keep_names(tz_image_sink *sink, const tz_image *like)
{
    static const char *const usual[4] = {"Y", "YA", "RGB", "RGBA"};
    for (int32_t c = 0; c < sink->channels; c++) {
        char *name = sink->names[c];
        if (!sink->format->colour && like->names && like->names[sink->map[c]][0])
            memcpy(name, like->names[sink->map[c]], sizeof *sink->names);
        else if (sink->format->colour || sink->channels <= 4)
            name[0] = usual[sink->channels - 1][c];
        else
            snprintf(name, sizeof *sink->names, "c%d", c);
        name[sizeof *sink->names - 1] = 0;
        for (int32_t k = 0; k < c; k++)
            if (strcmp(sink->names[k], name) == 0)
                return tz_fail(sink->ctx, TZ_INVALID,
                               "%s: two channels are called '%s'; rename one",
                               sink->shown, name);
    }
    return TZ_OK;
}

/* Band: what the format asked for, else about 8 MiB, so that threads have enough to do.
 */
static tz_status make_band(tz_image_sink *sink)
{
    sink->row_bytes =
        (size_t)sink->width * (size_t)sink->channels * (size_t)sink->sample_size;
    if (sink->format->gathered)
        sink->band_rows = sink->height;
    else if (sink->band_rows == 0)
        sink->band_rows = (int32_t)(((size_t)8 << 20) / sink->row_bytes + 1);
    if (sink->band_rows > sink->height)
        sink->band_rows = sink->height;
    return tz_alloc(sink->ctx, &sink->band, (size_t)sink->band_rows, sink->row_bytes);
}

static tz_status check_options(tz_image_sink *sink, const tz_image_write_options *opt)
{
    sink->compression = opt->compression < 0 ? 1 : opt->compression;
    sink->quality = opt->quality == 0 ? 95 : opt->quality;
    /* very wide pictures: smaller tiles, so that a row of them stays small */
    sink->tile = opt->tile ? opt->tile : sink->width > 200000 ? 64 : 256;
    if (sink->compression > 9 || sink->quality < 1 || sink->quality > 100)
        return tz_fail(
            sink->ctx, TZ_INVALID,
            "%s: compression %d or quality %d is out of range; 0 to 9 and 1 to "
            "100 are possible",
            sink->shown, sink->compression, sink->quality);
    if (sink->tile < 16 || sink->tile > 8192 || sink->tile % 16 != 0)
        return tz_fail(sink->ctx, TZ_INVALID,
                       "%s: tiles of %d pixels; give a multiple of 16 from 16 to 8192",
                       sink->shown, sink->tile);
    return TZ_OK;
}

tz_status tz_image_sink_open(tz_ctx *ctx, const char *path, int32_t width, int32_t height,
                             const tz_image *like, const tz_image_write_options *opt,
                             tz_image_sink **out)
{
    const tz_image_write_options usual = {.compression = -1};
    tz_image_sink *sink;
    if (!opt)
        opt = &usual;
    tz_status s = tz_alloc_zero(ctx, &sink, 1, sizeof *sink);
    if (s != TZ_OK)
        return s;
    sink->ctx = ctx;
    sink->width = width;
    sink->height = height;
    sink->in_channels = like->channels;
    sink->in_alpha = like->alpha;
    s = tz_strdup(ctx, strcmp(path, "-") == 0 ? "standard output" : path, &sink->shown);
    if (s == TZ_OK && (width < 1 || height < 1 || width > TZ_IMAGE_MAX_SIDE ||
                       height > TZ_IMAGE_MAX_SIDE))
        s = tz_fail(ctx, TZ_INVALID, "%s: size %d x %d; sides must be 1 to %d",
                    sink->shown, width, height, TZ_IMAGE_MAX_SIDE);
    if (s == TZ_OK && (like->channels < 1 || like->channels > TZ_IMAGE_MAX_CHANNELS))
        s = tz_fail(ctx, TZ_INVALID, "%s: %d channels; 1 to %d are possible", sink->shown,
                    like->channels, TZ_IMAGE_MAX_CHANNELS);
    if (s == TZ_OK)
        s = find_format(sink, path, opt->format);
    if (s == TZ_OK)
        s = check_options(sink, opt);
    if (s == TZ_OK)
        s = sink->format->channels(sink, like);
    if (s == TZ_OK)
        s = choose_type(sink, opt->type, like);
    if (s == TZ_OK && sink->format->gathered && (int64_t)width * height > GATHER_LIMIT)
        s = tz_fail(ctx, TZ_LIMIT,
                    "%s: %d x %d pixels is more than %s can take; write exr, "
                    "tif or png",
                    sink->shown, width, height, sink->format->name);
    if (s == TZ_OK)
        s = keep_names(sink, like);
    if (s == TZ_OK)
        s = tz_image_init(ctx, &sink->carrier, 1, 1, 1);
    if (s == TZ_OK)
        s = tz_image_copy_meta(like, &sink->carrier);
    if (s == TZ_OK && sink->type == TZ_SAMPLE_U8 && sink->encoding == TZ_ENCODING_SRGB)
        s = make_codes(sink);
    if (s == TZ_OK && sink->type == TZ_SAMPLE_HALF &&
        sink->encoding == TZ_ENCODING_LINEAR)
        s = make_decode(sink);
    if (s == TZ_OK)
        s = tz_file_out_open(ctx, path, &sink->out);
    if (s == TZ_OK)
        s = sink->format->open(sink);
    if (s == TZ_OK)
        s = make_band(sink);
    if (s == TZ_OK)
        *out = sink;
    else
        sink_free(sink);
    return s;
}

static tz_status flush_band(tz_image_sink *sink)
{
    if (sink->band_fill == 0)
        return TZ_OK;
    if (tz_ctx_cancelled(sink->ctx))
        return tz_fail(sink->ctx, TZ_CANCELLED, "cancelled");
    tz_status s = sink->format->band(sink, sink->next_row - sink->band_fill,
                                     sink->band_fill, sink->band);
    sink->band_fill = 0;
    return s;
}

tz_status tz_image_sink_rows(tz_image_sink *sink, const tz_image *rows)
{
    if (sink->status != TZ_OK)
        return sink->status;
    if (rows->width != sink->width || rows->channels != sink->in_channels ||
        rows->height > sink->height - sink->next_row)
        return sink->status = tz_fail(
                   sink->ctx, TZ_INVALID,
                   "%s: rows of %d x %d pixels and %d channels do not fit the image of "
                   "%d x %d and %d, of which %d rows are written",
                   sink->shown, rows->width, rows->height, rows->channels, sink->width,
                   sink->height, sink->in_channels, sink->next_row);
    int32_t y = 0;
    while (y < rows->height && sink->status == TZ_OK) {
        int32_t n = sink->band_rows - sink->band_fill;
        if (n > rows->height - y)
            n = rows->height - y;
        convert_job job = {sink, rows, y,
                           sink->band + (size_t)sink->band_fill * sink->row_bytes};
        sink->status = tz_parallel_for(sink->ctx, n, convert_row, &job);
        if (sink->status != TZ_OK)
            break;
        y += n;
        sink->band_fill += n;
        sink->next_row += n;
        if (sink->band_fill == sink->band_rows || sink->next_row == sink->height)
            sink->status = flush_band(sink);
    }
    return sink->status;
}

tz_status tz_image_sink_close(tz_image_sink *sink)
{
    tz_status s = sink->status;
    if (s == TZ_OK && sink->next_row != sink->height)
        s = tz_fail(sink->ctx, TZ_INVALID, "%s: %d of %d rows were written", sink->shown,
                    sink->next_row, sink->height);
    if (s == TZ_OK)
        s = sink->format->close(sink);
    if (s == TZ_OK && tz_ctx_cancelled(sink->ctx))
        s = tz_fail(sink->ctx, TZ_CANCELLED, "cancelled");
    if (s == TZ_OK)
        s = tz_file_out_commit(&sink->out);
    sink_free(sink);
    return s;
}

void tz_image_sink_abort(tz_image_sink *sink) { sink_free(sink); }

tz_status tz_image_write(tz_ctx *ctx, const char *path, const tz_image *im,
                         const tz_image_write_options *opt)
{
    tz_image_sink *sink;
    tz_status s = tz_image_sink_open(ctx, path, im->width, im->height, im, opt, &sink);
    if (s != TZ_OK)
        return s;
    s = tz_image_sink_rows(sink, im);
    if (s != TZ_OK) {
        tz_image_sink_abort(sink);
        return s;
    }
    return tz_image_sink_close(sink);
}
