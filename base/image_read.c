/* SPDX-License-Identifier: Apache-2.0 */
/* Reading: look at the first bytes, let the codec fill an image in the file's own
 * encoding, then what all formats share: orientation, gamma, encoding. */
#include "base/image_internal.h"

#include <string.h>
#include <sys/stat.h>

#include "base/file.h"

/* PNG, JPEG and small files are decoded from memory; a bigger file is not a picture that
 * a person made. EXR is read from the disk by its library, piece by piece. */
static const size_t max_file = (size_t)1 << 33;

tz_status tz_image_source_init(const tz_image_source *src, int64_t width, int64_t height,
                               int32_t channels, tz_image *im)
{
    if (width < 1 || height < 1)
        return tz_image_source_bad(src, "image", "it has no pixels");
    if (width > TZ_IMAGE_MAX_SIDE || height > TZ_IMAGE_MAX_SIDE ||
        width > src->max_pixels / height)
        return tz_fail(
            src->ctx, TZ_LIMIT,
            "%s: %lld x %lld pixels is more than the limit of %lld pixels and %d "
            "a side; scale or crop it first",
            src->path, (long long)width, (long long)height, (long long)src->max_pixels,
            TZ_IMAGE_MAX_SIDE);
    if (channels > TZ_IMAGE_MAX_CHANNELS)
        return tz_fail(src->ctx, TZ_LIMIT, "%s: %d channels is more than the limit of %d",
                       src->path, channels, TZ_IMAGE_MAX_CHANNELS);
    return tz_image_init(src->ctx, im, (int32_t)width, (int32_t)height, channels);
}

tz_status tz_image_source_bad(const tz_image_source *src, const char *kind,
                              const char *why)
{
    return tz_fail(src->ctx, TZ_FORMAT,
                   "%s: not a readable %s: %s; check the file or export it again",
                   src->path, kind, why);
}

/* ---- orientation ------------------------------------------------------------------ */

int tz_exif_orientation(const uint8_t *data, size_t size)
{
    if (size < 14 || (memcmp(data, "II*\0", 4) != 0 && memcmp(data, "MM\0*", 4) != 0))
        return 0;
    bool big = data[0] == 'M';
#define U16(p) (uint32_t)(big ? (p)[0] << 8 | (p)[1] : (p)[1] << 8 | (p)[0])
    uint32_t high = U16(data + (big ? 4 : 6)), low = U16(data + (big ? 6 : 4));
    size_t at = (size_t)high << 16 | low; /* first directory */
    if (at > size - 2)
        return 0;
    uint32_t entries = U16(data + at);
    for (at += 2; entries > 0 && at <= size - 12; entries--, at += 12) {
        if (U16(data + at) == 0x0112) {
            uint32_t value = U16(data + at + 8);
            return value >= 1 && value <= 8 ? (int)value : 0;
        }
    }
#undef U16
    return 0;
}

tz_status tz_image_orient(tz_ctx *ctx, tz_image *im, int orientation)
{
    if (orientation <= 1 || orientation > 8)
        return TZ_OK;
    /* Exif: 2 mirror x, 3 turn 180, 4 mirror y, 5 transpose, 6 turn right, 7 transverse,
     * 8 turn left. As source x, y of output (x, y): transpose first, then mirror. */
    bool transpose = orientation >= 5;
    bool flip_x =
        orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8;
    bool flip_y =
        orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7;
    int32_t w = transpose ? im->height : im->width,
            h = transpose ? im->width : im->height;
    float *px;
    tz_status s =
        tz_alloc(ctx, &px, (size_t)w * (size_t)h * (size_t)im->channels, sizeof *px);
    if (s != TZ_OK)
        return s;
    float *to = px;
    for (int32_t y = 0; y < h; y++) {
        for (int32_t x = 0; x < w; x++, to += im->channels) {
            int32_t sx = transpose ? y : x, sy = transpose ? x : y;
            sx = flip_x ? im->width - 1 - sx : sx;
            sy = flip_y ? im->height - 1 - sy : sy;
            memcpy(to, tz_image_at(im, sx, sy), (size_t)im->channels * sizeof *to);
        }
    }
    tz_free(ctx, im->px);
    im->px = px;
    im->width = w;
    im->height = h;
    im->stride = (int64_t)w * im->channels;
    return TZ_OK;
}

/* ---- colour ----------------------------------------------------------------------- */

static void apply_gamma(tz_image *im, double gamma)
{
    double power = 1.0 / gamma;
    for (int32_t y = 0; y < im->height; y++) {
        float *p = tz_image_at(im, 0, y);
        for (int32_t x = 0; x < im->width; x++, p += im->channels)
            for (int32_t c = 0; c < im->channels; c++)
                if (c != im->alpha)
                    p[c] = (float)pow((double)p[c], power);
    }
}

/* Integer samples take few values: a table in place of a power each. */
typedef struct table_job {
    tz_image *im;
    const float *table;
    float scale;
} table_job;

static tz_status table_row(tz_ctx *ctx, void *arg, int64_t y, int worker)
{
    (void)ctx;
    (void)worker;
    const table_job *job = arg;
    tz_image *im = job->im;
    float *p = tz_image_at(im, 0, (int32_t)y);
    for (int32_t x = 0; x < im->width; x++, p += im->channels)
        for (int32_t c = 0; c < im->channels; c++)
            if (c != im->alpha)
                p[c] = job->table[(int32_t)(p[c] * job->scale + 0.5f)];
    return TZ_OK;
}

static tz_status decode_integers(tz_ctx *ctx, tz_image *im)
{
    int32_t n = im->depth == 8 ? 256 : 65536;
    if ((int64_t)im->width * im->height < n) /* the table would cost more than it saves */
        return tz_image_convert(ctx, im, TZ_ENCODING_LINEAR);
    float *table;
    tz_status s = tz_alloc(ctx, &table, (size_t)n, sizeof *table);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < n; i++)
        table[i] = tz_srgb_decode((float)i / (float)(n - 1));
    table_job job = {im, table, (float)(n - 1)};
    s = tz_parallel_for(ctx, im->height, table_row, &job);
    tz_free(ctx, table);
    if (s == TZ_OK)
        im->encoding = TZ_ENCODING_LINEAR;
    return s;
}

/* ---- driver ------------------------------------------------------------------------ */

static bool starts(const tz_image_source *src, const char *magic, size_t n)
{
    return src->size >= n && memcmp(src->data, magic, n) == 0;
}

static tz_status decode(const tz_image_source *src, tz_image *im, tz_image_found *found)
{
    if (src->size == 0)
        return tz_fail(src->ctx, TZ_FORMAT, "%s: the file is empty; export it again",
                       src->path);
    if (starts(src, "\x89PNG\r\n\x1a\n", 8))
        return tz_png_read(src, im, found);
    if (starts(src, "\xff\xd8\xff", 3))
        return tz_jpeg_read(src, im, found);
    if (starts(src, "\x76\x2f\x31\x01", 4)) {
        tz_status s = tz_exr_read(src, im, found);
        if (s != TZ_UNSUPPORTED)
            return s;
    }
    return tz_oiio_read(src, im, found);
}

/* Head of the file, or all of it where the codec wants it in memory. */
static tz_status load(tz_image_source *src, char **data)
{
    char *whole = NULL;
    tz_status s;
    struct stat st;
    uint8_t head[4] = {0};
    FILE *f = src->piped ? NULL : fopen(src->path, "rb");
    if (f && fstat(fileno(f), &st) == 0 && S_ISREG(st.st_mode) &&
        fread(head, 1, sizeof head, f) == sizeof head &&
        memcmp(head, "\x76\x2f\x31\x01", 4) == 0) {
        /* EXR from disk: the header's first bytes are enough here */
        s = tz_alloc(src->ctx, &whole, sizeof head, 1);
        if (s == TZ_OK) {
            memcpy(whole, head, sizeof head);
            src->size = sizeof head;
        }
    } else {
        s = tz_file_read(src->ctx, src->path, max_file, &whole, &src->size);
    }
    if (f)
        fclose(f);
    if (s == TZ_OK && src->piped)
        src->path = "standard input";
    src->data = (const uint8_t *)whole;
    *data = whole;
    return s;
}

tz_status tz_image_read(tz_ctx *ctx, const char *path, const tz_image_read_options *opt,
                        tz_image *im)
{
    const tz_image_read_options none = {0};
    memset(im, 0, sizeof *im);
    if (!opt)
        opt = &none;
    tz_image_source src = {.ctx = ctx,
                           .path = path,
                           .piped = strcmp(path, "-") == 0,
                           .opt = opt,
                           .max_pixels =
                               opt->max_pixels > 0 ? opt->max_pixels : (int64_t)1 << 30};
    char *data = NULL;
    tz_image t = {0};
    tz_image_found found = {.encoding = TZ_ENCODING_SRGB};
    tz_status s = load(&src, &data);
    if (s != TZ_OK)
        goto done;
    s = decode(&src, &t, &found);
    if (s != TZ_OK)
        goto done;
    s = tz_image_orient(ctx, &t, found.orientation);
    if (s != TZ_OK)
        goto done;
    if (found.not_finite > 0)
        tz_warn(ctx, "%s: %lld numbers are infinite or not a number; 0 stands for them",
                src.path, (long long)found.not_finite);

    if (opt->data) {
        t.encoding = TZ_ENCODING_DATA;
    } else {
        t.encoding = found.encoding;
        if (found.gamma > 0) {
            apply_gamma(&t, found.gamma);
            t.encoding = TZ_ENCODING_LINEAR;
        }
        if (t.encoding == TZ_ENCODING_SRGB && opt->want == TZ_ENCODING_LINEAR &&
            t.depth <= 16)
            s = decode_integers(ctx, &t);
        else
            s = tz_image_convert(ctx, &t, opt->want);
    }
done:
    tz_free(ctx, data);
    if (s == TZ_OK)
        *im = t;
    else
        tz_image_deinit(&t);
    return s;
}
