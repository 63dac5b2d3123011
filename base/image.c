/* SPDX-License-Identifier: Apache-2.0 */
/* Images in memory and the sRGB curve. The curve's powers are taken by Newton steps on
 * IEEE basic operations alone, so that every machine gives the same bits (the C library's
 * pow may use fused multiply-add where the processor has it) and loops vectorise. */
#include "base/image.h"

#include <assert.h>
#include <ctype.h>
#include <float.h>
#include <stdio.h>
#include <string.h>

#include "base/image_internal.h"

/* ---- the sRGB curve -------------------------------------------------------------- */

/* x^(1/3) for finite x > 0: exponent divided by three, then three Halley steps, each of
 * which triples the number of right digits. */
static inline double root3(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    bits = bits / 3 + UINT64_C(0x2A9F7893782DA1CE);
    double y;
    memcpy(&y, &bits, sizeof y);
    for (int i = 0; i < 3; i++) {
        double y3 = y * y * y;
        y = y * (y3 + 2 * x) / (2 * y3 + x);
    }
    return y;
}

/* x^(1/5), likewise. */
static inline double root5(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    bits = bits / 5 + UINT64_C(0x3326666666666666);
    double y;
    memcpy(&y, &bits, sizeof y);
    for (int i = 0; i < 3; i++) {
        double y2 = y * y, y5 = y2 * y2 * y;
        y = y * (2 * y5 + 3 * x) / (3 * y5 + 2 * x);
    }
    return y;
}

float tz_srgb_encode(float linear)
{
    double x = fabsf(linear);
    if (!(x <= FLT_MAX))
        return linear; /* infinite or not a number */
    double y = 12.92 * x;
    if (x > 0.0031308) {
        double r = sqrt(sqrt(root3(x))), r2 = r * r; /* x^(1/12) */
        y = 1.055 * (r2 * r2 * r) - 0.055;           /* x^(5/12) */
    }
    return (float)copysign(y, (double)linear);
}

float tz_srgb_decode(float srgb)
{
    double y = fabsf(srgb);
    if (!(y <= FLT_MAX))
        return srgb;
    double x = y / 12.92;
    if (y > 0.04045) {
        double t = (y + 0.055) / 1.055, r = root5(t);
        x = t * t * (r * r); /* t^(12/5) */
    }
    return (float)copysign(x, (double)srgb);
}

/* ---- life ------------------------------------------------------------------------- */

tz_status tz_image_init(tz_ctx *ctx, tz_image *im, int32_t width, int32_t height,
                        int32_t channels)
{
    memset(im, 0, sizeof *im);
    if (width < 1 || height < 1 || width > TZ_IMAGE_MAX_SIDE ||
        height > TZ_IMAGE_MAX_SIDE)
        return tz_fail(ctx, TZ_INVALID, "image of %d x %d pixels: sides must be 1 to %d",
                       width, height, TZ_IMAGE_MAX_SIDE);
    if (channels < 1 || channels > TZ_IMAGE_MAX_CHANNELS)
        return tz_fail(ctx, TZ_INVALID, "image of %d channels: 1 to %d are possible",
                       channels, TZ_IMAGE_MAX_CHANNELS);
    tz_image t = {.width = width,
                  .height = height,
                  .channels = channels,
                  .stride = (int64_t)width * channels,
                  .alpha = channels == 2 || channels == 4 ? channels - 1 : -1,
                  .depth = 32,
                  .owns = true,
                  .ctx = ctx};
    tz_status s =
        tz_alloc_zero(ctx, &t.px, (size_t)height * (size_t)t.stride, sizeof *t.px);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &t.names, (size_t)channels, sizeof *t.names);
    if (s != TZ_OK) {
        tz_image_deinit(&t);
        return s;
    }
    static const char *const usual[4] = {"Y", "YA", "RGB", "RGBA"};
    for (int32_t c = 0; c < channels; c++) {
        if (channels <= 4)
            t.names[c][0] = usual[channels - 1][c];
        else
            snprintf(t.names[c], sizeof t.names[c], "c%d", c);
    }
    *im = t;
    return TZ_OK;
}

void tz_image_deinit(tz_image *im)
{
    if (im->owns) {
        tz_free(im->ctx, im->px);
        tz_free(im->ctx, im->names);
        for (int32_t i = 0; i < im->meta.n; i++) {
            tz_free(im->ctx, im->meta.v[i].key);
            tz_free(im->ctx, im->meta.v[i].value);
        }
        tz_array_free(im->ctx, &im->meta);
    }
    memset(im, 0, sizeof *im);
}

tz_image tz_image_view(const tz_image *im, tz_rect r)
{
    assert(r.x >= 0 && r.y >= 0 && r.w >= 0 && r.h >= 0 && r.w <= im->width - r.x &&
           r.h <= im->height - r.y);
    tz_image v = *im;
    v.px = tz_image_at(im, r.x, r.y);
    v.width = r.w;
    v.height = r.h;
    v.names = NULL;
    memset(&v.meta, 0, sizeof v.meta);
    v.owns = false;
    return v;
}

tz_status tz_image_copy_meta(const tz_image *from, tz_image *to)
{
    for (int32_t i = 0; i < from->meta.n; i++) {
        tz_status s = tz_image_set_meta(to, from->meta.v[i].key, from->meta.v[i].value);
        if (s != TZ_OK)
            return s;
    }
    return TZ_OK;
}

tz_status tz_image_copy(tz_ctx *ctx, const tz_image *im, tz_image *out)
{
    tz_image t;
    tz_status s = tz_image_init(ctx, &t, im->width, im->height, im->channels);
    if (s != TZ_OK) {
        memset(out, 0, sizeof *out);
        return s;
    }
    for (int32_t y = 0; y < im->height; y++)
        memcpy(tz_image_at(&t, 0, y), tz_image_at(im, 0, y),
               (size_t)t.stride * sizeof *t.px);
    if (im->names)
        memcpy(t.names, im->names, (size_t)im->channels * sizeof *t.names);
    t.alpha = im->alpha;
    t.encoding = im->encoding;
    t.depth = im->depth;
    s = tz_image_copy_meta(im, &t);
    if (s != TZ_OK)
        tz_image_deinit(&t);
    *out = t;
    return s;
}

/* ---- conversion ------------------------------------------------------------------- */

typedef struct convert_job {
    tz_image *im;
    bool encode;
} convert_job;

enum { CONVERT_ROWS = 16 };

static tz_status convert_rows(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    (void)ctx;
    (void)worker;
    const convert_job *job = arg;
    tz_image *im = job->im;
    int32_t y1 = (int32_t)((i + 1) * CONVERT_ROWS);
    if (y1 > im->height)
        y1 = im->height;
    for (int32_t y = (int32_t)(i * CONVERT_ROWS); y < y1; y++) {
        float *p = tz_image_at(im, 0, y);
        for (int32_t x = 0; x < im->width; x++, p += im->channels)
            for (int32_t c = 0; c < im->channels; c++)
                if (c != im->alpha)
                    p[c] = job->encode ? tz_srgb_encode(p[c]) : tz_srgb_decode(p[c]);
    }
    return TZ_OK;
}

tz_status tz_image_convert(tz_ctx *ctx, tz_image *im, tz_encoding to)
{
    if (im->encoding == to || im->encoding == TZ_ENCODING_DATA || to == TZ_ENCODING_DATA)
        return TZ_OK;
    convert_job job = {im, to == TZ_ENCODING_SRGB};
    tz_status s = tz_parallel_for(ctx, (im->height + CONVERT_ROWS - 1) / CONVERT_ROWS,
                                  convert_rows, &job);
    if (s == TZ_OK)
        im->encoding = to;
    return s;
}

/* ---- metadata --------------------------------------------------------------------- */

tz_status tz_image_set_meta(tz_image *im, const char *key, const char *value)
{
    tz_meta m = {0};
    tz_status s = tz_strdup(im->ctx, value, &m.value);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < im->meta.n; i++) {
        if (strcmp(im->meta.v[i].key, key) == 0) {
            tz_free(im->ctx, im->meta.v[i].value);
            im->meta.v[i].value = m.value;
            return TZ_OK;
        }
    }
    s = tz_strdup(im->ctx, key, &m.key);
    if (s == TZ_OK)
        s = tz_array_push(im->ctx, &im->meta, m);
    if (s != TZ_OK) {
        tz_free(im->ctx, m.key);
        tz_free(im->ctx, m.value);
    }
    return s;
}

const char *tz_image_meta(const tz_image *im, const char *key)
{
    for (int32_t i = 0; i < im->meta.n; i++)
        if (strcmp(im->meta.v[i].key, key) == 0)
            return im->meta.v[i].value;
    return NULL;
}

tz_status tz_image_set_meta_line(tz_image *im, const char *text, size_t size)
{
    while (size > 0 && (text[size - 1] == 0 || text[size - 1] == '\n'))
        size--;
    size_t k = 0; /* length of the key */
    while (k < size && k < 64 &&
           (isalnum((unsigned char)text[k]) || strchr("_.:-", text[k])) &&
           !(text[k] == ':' && k + 1 < size && text[k + 1] == ' '))
        k++;
    bool keyed = k > 0 && k + 1 < size && text[k] == ':' && text[k + 1] == ' ';
    size_t from = keyed ? k + 2 : 0;
    char key[65] = "Comment", *value;
    if (keyed) {
        memcpy(key, text, k);
        key[k] = 0;
    }
    tz_status s = tz_alloc(im->ctx, &value, size - from + 1, 1);
    if (s != TZ_OK)
        return s;
    memcpy(value, text + from, size - from);
    value[size - from] = 0;
    s = tz_image_set_meta(im, key, value);
    tz_free(im->ctx, value);
    return s;
}
