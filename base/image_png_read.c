/* SPDX-License-Identifier: Apache-2.0 */
/* PNG through libpng: palette and low depths are expanded, 16 bits kept. libpng reports
 * errors by longjmp, so everything that must survive one stands in `reader`. */
#include "base/image_internal.h"

#include <png.h>
#include <setjmp.h>
#include <string.h>

typedef struct reader {
    const tz_image_source *src;
    size_t at;
    png_structp png;
    png_infop info;
    uint8_t *rows; /* whole picture if interlaced, else one row */
    char why[200];
    bool no_memory;
} reader;

static void on_error(png_structp png, png_const_charp text)
{
    reader *r = png_get_error_ptr(png);
    strncpy(r->why, text, sizeof r->why - 1);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp text)
{
    (void)png;
    (void)text;
}

static void on_read(png_structp png, png_bytep to, size_t n)
{
    reader *r = png_get_io_ptr(png);
    if (n > r->src->size - r->at)
        png_error(png, "it ends too soon (truncated)");
    memcpy(to, r->src->data + r->at, n);
    r->at += n;
}

static png_voidp on_malloc(png_structp png, png_alloc_size_t n)
{
    reader *r = png_get_mem_ptr(png);
    void *p;
    if (tz_alloc(r->src->ctx, &p, n, 1) != TZ_OK)
        r->no_memory = true;
    return p;
}

static void on_free(png_structp png, png_voidp p)
{
    reader *r = png_get_mem_ptr(png);
    tz_free(r->src->ctx, p);
}

static tz_status keep_text(reader *r, tz_image *im)
{
    png_textp text;
    int n = 0;
    png_get_text(r->png, r->info, &text, &n);
    for (int i = 0; i < n; i++) {
        if (!text[i].key || !text[i].text)
            continue;
        tz_status s = tz_image_set_meta(im, text[i].key, text[i].text);
        if (s != TZ_OK)
            return s;
    }
    return TZ_OK;
}

static void find_encoding(reader *r, tz_image_found *found)
{
    double gamma;
    int intent;
    if (png_get_sRGB(r->png, r->info, &intent) || !png_get_gAMA(r->png, r->info, &gamma))
        return;
    if (gamma > 0.99 && gamma < 1.01)
        found->encoding = TZ_ENCODING_LINEAR;
    else if ((gamma < 0.44 || gamma > 0.47) && gamma > 0.05 && gamma < 20)
        found->gamma = gamma; /* 1/2.2 is what programs write that mean sRGB */
}

static void convert_row(const uint8_t *from, bool wide, float *to, int64_t n)
{
    if (wide)
        for (int64_t i = 0; i < n; i++)
            to[i] = (float)(from[2 * i] << 8 | from[2 * i + 1]) / 65535.0f;
    else
        for (int64_t i = 0; i < n; i++)
            to[i] = (float)from[i] / 255.0f;
}

static tz_status read_all(reader *r, tz_image *im, tz_image_found *found)
{
    tz_status s;
    if (setjmp(png_jmpbuf(r->png))) {
        return r->no_memory
                   ? tz_fail(r->src->ctx, TZ_NOMEM, "%s: out of memory", r->src->path)
                   : tz_image_source_bad(r->src, "PNG file", r->why);
    }
    png_set_read_fn(r->png, r, on_read);
    /* the checks of sizes are ours: tz_image_source_init */
    png_set_user_limits(r->png, 0x7fffffff, 0x7fffffff);
    png_read_info(r->png, r->info);
    png_uint_32 width = png_get_image_width(r->png, r->info);
    png_uint_32 height = png_get_image_height(r->png, r->info);
    bool wide = png_get_bit_depth(r->png, r->info) == 16;
    png_set_expand(r->png); /* palette, 1 to 4 bits, tRNS */
    int passes = png_set_interlace_handling(r->png);
    png_read_update_info(r->png, r->info);
    s = tz_image_source_init(r->src, width, height, png_get_channels(r->png, r->info),
                             im);
    if (s != TZ_OK)
        return s;
    im->depth = wide ? 16 : 8;
    size_t bytes = png_get_rowbytes(r->png, r->info);
    s = tz_alloc(r->src->ctx, &r->rows, passes > 1 ? (size_t)height : 1, bytes);
    if (s != TZ_OK)
        return s;
    for (int pass = 0; pass < passes; pass++) {
        for (png_uint_32 y = 0; y < height; y++) {
            if (y % 64 == 0 && tz_ctx_cancelled(r->src->ctx))
                return tz_fail(r->src->ctx, TZ_CANCELLED, "cancelled");
            uint8_t *row = r->rows + (passes > 1 ? y * bytes : 0);
            png_read_row(r->png, row, NULL);
            if (pass == passes - 1)
                convert_row(row, wide, tz_image_at(im, 0, (int32_t)y), im->stride);
        }
    }
    png_read_end(r->png, r->info);
    find_encoding(r, found);
    png_bytep exif;
    png_uint_32 exif_size;
    if (png_get_eXIf_1(r->png, r->info, &exif_size, &exif))
        found->orientation = tz_exif_orientation(exif, exif_size);
    return keep_text(r, im);
}

tz_status tz_png_read(const tz_image_source *src, tz_image *im, tz_image_found *found)
{
    reader r = {.src = src};
    tz_status s = TZ_NOMEM;
    r.png = png_create_read_struct_2(PNG_LIBPNG_VER_STRING, &r, on_error, on_warning, &r,
                                     on_malloc, on_free);
    if (r.png)
        r.info = png_create_info_struct(r.png);
    if (r.info)
        s = read_all(&r, im, found);
    else
        tz_fail(src->ctx, s, "%s: out of memory", src->path);
    png_destroy_read_struct(&r.png, &r.info, NULL);
    tz_free(src->ctx, r.rows);
    if (s != TZ_OK)
        tz_image_deinit(im);
    return s;
}
