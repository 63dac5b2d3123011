/* SPDX-License-Identifier: Apache-2.0 */
/* A photo at three sizes: half (means of 2 x 2), one, double (interpolated). Rows of each
 * are made when a slab of rows is detected, so the double-size photo never exists. The
 * three responses are averaged where the photo's pixels lie, weighted: what is found in the
 * double size counts most: on held-out scenes F rises by 0.05 to 0.07 with it, and half the
 * size neither adds nor costs. */
#include <string.h>

#include "analysis/boundary_score.h"
#include "analysis/forest.h"
#include "base/module.h"
#include "base/param.h"

#define LEAST_SIDE  32
#define SLAB_PIXELS ((int64_t)1 << 21)
#define CONTEXT     8 /* rows around a slab that its directions depend on */
#define STRIDE      4 /* px between patches: 16 patches see a pixel */

static const float weights[3] = {1 / 11.0F, 2 / 11.0F, 8 / 11.0F};

typedef struct size {
    const tz_image *photo;
    int32_t shift;         /* -1 half, 0 one, 1 double */
    int32_t width, height; /* of this size; even, at least 32 */
} size;

/* ---- rows ---------------------------------------------------------------------------- */

/* ... b a | a b ... */
static int32_t mirror(int32_t i, int32_t n)
{
    while (i < 0 || i >= n)
        i = i < 0 ? -1 - i : 2 * n - 1 - i;
    return i;
}

/* NaN and what lies below 0 are 0. */
static float clamp_unit(float v) { return v > 0 ? (v < 1 ? v : 1) : 0; }

/* What cannot be seen is mid-grey. */
static void pixel(const tz_image *photo, int32_t x, int32_t y, float rgb[3])
{
    const bool linear = photo->encoding == TZ_ENCODING_LINEAR;
    const float *p =
        tz_image_at(photo, mirror(x, photo->width), mirror(y, photo->height));
    const float alpha = photo->alpha >= 0 ? clamp_unit(p[photo->alpha]) : 1;
    for (int c = 0; c < 3; c++) {
        const float v = clamp_unit(p[photo->channels >= 3 ? c : 0]);
        rgb[c] = linear ? tz_srgb_encode(v) : v;
        if (alpha < 1)
            rgb[c] = alpha * rgb[c] + (1 - alpha) * 0.5F;
    }
}

static void row_of_one(const tz_image *photo, int32_t y, int32_t n, float *rgb)
{
    for (int32_t x = 0; x < n; x++)
        pixel(photo, x, y, rgb + (ptrdiff_t)3 * x);
}

static void row_of_half(const tz_image *photo, int32_t y, int32_t n, float *rgb)
{
    for (int32_t x = 0; x < n; x++, rgb += 3) {
        float p[4][3];
        for (int k = 0; k < 4; k++)
            pixel(photo, 2 * x + k % 2, 2 * y + k / 2, p[k]);
        for (int c = 0; c < 3; c++)
            rgb[c] = 0.25F * ((p[0][c] + p[1][c]) + (p[2][c] + p[3][c]));
    }
}

/* Column x of the photo between two of its rows, 3 parts of the nearer one. */
static void between_rows(const tz_image *photo, int32_t x, int32_t near_y, int32_t far_y,
                         float rgb[3])
{
    float a[3], b[3];
    pixel(photo, x, near_y, a);
    pixel(photo, x, far_y, b);
    for (int c = 0; c < 3; c++)
        rgb[c] = 0.75F * a[c] + 0.25F * b[c];
}

/* Pixel i of the double size lies at (i - 1/2) / 2 of the photo: 3/4 of the nearer one. */
static void row_of_double(const tz_image *photo, int32_t y, int32_t n, float *rgb)
{
    const int32_t near_y = y / 2, far_y = y % 2 ? near_y + 1 : near_y - 1;
    float before[3], here[3], after[3];
    between_rows(photo, -1, near_y, far_y, before);
    between_rows(photo, 0, near_y, far_y, here);
    for (int32_t x = 0; 2 * x < n; x++, rgb += 6) { /* n is even */
        between_rows(photo, x + 1, near_y, far_y, after);
        for (int c = 0; c < 3; c++) {
            rgb[c] = 0.75F * here[c] + 0.25F * before[c];
            rgb[3 + c] = 0.75F * here[c] + 0.25F * after[c];
        }
        memcpy(before, here, sizeof here);
        memcpy(here, after, sizeof after);
    }
}

static void photo_row(const void *source, int32_t y, float *rgb)
{
    const size *s = source;
    if (s->shift < 0)
        row_of_half(s->photo, y, s->width, rgb);
    else if (s->shift > 0)
        row_of_double(s->photo, y, s->width, rgb);
    else
        row_of_one(s->photo, y, s->width, rgb);
}

/* ---- sizes --------------------------------------------------------------------------- */

static int32_t even(int32_t n)
{
    n += n % 2;
    return n > LEAST_SIDE ? n : LEAST_SIDE;
}

static size size_of(const tz_image *photo, int32_t shift)
{
    const int32_t w = photo->width, h = photo->height;
    return shift < 0   ? (size){photo, shift, even((w + 1) / 2), even((h + 1) / 2)}
           : shift > 0 ? (size){photo, shift, even(2 * w), even(2 * h)}
                       : (size){photo, shift, even(w), even(h)};
}

/* Adds rows y0 .. y1 - 1 of `in`, of double the photo's size, to the response. */
static void add_double(const tz_image *photo, const float *in, int32_t width, int32_t y0,
                       int32_t y1, float *response)
{
    for (int32_t y = y0 / 2; y < y1 / 2 && y < photo->height; y++) {
        const float *a = in + (size_t)(2 * y - y0) * (size_t)width, *b = a + width;
        float *out = response + (size_t)y * (size_t)photo->width;
        for (int32_t x = 0; x < photo->width; x++)
            out[x] += 0.25F * weights[2] *
                      ((a[2 * x] + a[2 * x + 1]) + (b[2 * x] + b[2 * x + 1]));
    }
}

static void add_one(const tz_image *photo, const float *in, int32_t width, int32_t y0,
                    int32_t y1, float *response)
{
    for (int32_t y = y0; y < y1 && y < photo->height; y++)
        for (int32_t x = 0; x < photo->width; x++)
            response[(size_t)y * (size_t)photo->width + x] +=
                weights[1] * in[(size_t)(y - y0) * (size_t)width + x];
}

/* `in` holds all rows of half the photo's size. */
static void add_half(const tz_image *photo, const float *in, const size *s,
                     float *response)
{
    for (int32_t y = 0; y < photo->height; y++) {
        const int32_t far_y = y % 2 ? y / 2 + 1 : y / 2 - 1;
        const float *a = in + (size_t)(y / 2) * (size_t)s->width;
        const float *b = in + (size_t)mirror(far_y, s->height) * (size_t)s->width;
        float *out = response + (size_t)y * (size_t)photo->width;
        for (int32_t x = 0; x < photo->width; x++) {
            const int32_t i = x / 2, j = mirror(x % 2 ? i + 1 : i - 1, s->width);
            out[x] += weights[0] * (0.75F * (0.75F * a[i] + 0.25F * b[i]) +
                                    0.25F * (0.75F * a[j] + 0.25F * b[j]));
        }
    }
}

static tz_status detect_size(tz_ctx *ctx, const tz_forest *forest, const tz_image *photo,
                             int32_t shift, float *response)
{
    const size z = size_of(photo, shift);
    int64_t rows = SLAB_PIXELS / z.width / 2 * 2;
    float *part = NULL;
    rows = rows < 64 ? 64 : rows;
    rows = rows < z.height ? rows : z.height;
    const int32_t kept = shift < 0 ? z.height : (int32_t)rows;
    tz_forest few = *forest; /* what counts little is asked of half the trees */
    if (shift < 1)
        few.evaluated = (few.evaluated + 1) / 2;
    tz_status s = tz_alloc(ctx, &part, (size_t)kept * (size_t)z.width, sizeof *part);
    for (int32_t y = 0; y < z.height && s == TZ_OK; y += (int32_t)rows) {
        const int32_t y1 = y + (int32_t)rows < z.height ? y + (int32_t)rows : z.height;
        float *out = shift < 0 ? part + (size_t)y * (size_t)z.width : part;
        s = tz_forest_detect(ctx, &few, photo_row, &z, z.width, z.height, STRIDE, y, y1,
                             out);
        if (s == TZ_OK && shift > 0)
            add_double(photo, part, z.width, y, y1, response);
        else if (s == TZ_OK && shift == 0)
            add_one(photo, part, z.width, y, y1, response);
    }
    if (s == TZ_OK && shift < 0)
        add_half(photo, part, &z, response);
    tz_free(ctx, part);
    return s;
}

/* Directions, slab by slab: a row depends on no more than 6 rows on either side. */
static tz_status find_normals(tz_ctx *ctx, const float *response, int32_t width,
                              int32_t height, float *normal)
{
    const size_t w = (size_t)width, all = w * (size_t)height;
    const int32_t rows = SLAB_PIXELS / width > 64 ? (int32_t)(SLAB_PIXELS / width) : 64;
    float *part = NULL;
    tz_status s =
        tz_alloc(ctx, &part, ((size_t)rows + 2 * CONTEXT) * w, 2 * sizeof *part);
    for (int32_t y0 = 0; y0 < height && s == TZ_OK; y0 += rows) {
        const int32_t y1 = y0 + rows < height ? y0 + rows : height;
        const int32_t top = y0 > CONTEXT ? y0 - CONTEXT : 0;
        const int32_t bottom = y1 + CONTEXT < height ? y1 + CONTEXT : height;
        const size_t n = (size_t)(bottom - top) * w, skip = (size_t)(y0 - top) * w;
        const size_t to = (size_t)y0 * w, kept = (size_t)(y1 - y0) * w * sizeof *normal;
        s = tz_boundary_normals(ctx, response + (size_t)top * w, width, bottom - top,
                                part);
        if (s != TZ_OK)
            break;
        memcpy(normal + to, part + skip, kept);
        memcpy(normal + all + to, part + n + skip, kept);
    }
    tz_free(ctx, part);
    return s;
}

tz_status tz_forest_response(tz_ctx *ctx, const tz_image *photo, const tz_forest *forest,
                             float *response, float *normal)
{
    const size_t n = (size_t)photo->width * (size_t)photo->height;
    tz_status s = TZ_OK;
    memset(response, 0, n * sizeof *response);
    for (int32_t shift = -1; shift <= 1 && s == TZ_OK; shift++)
        s = detect_size(ctx, forest, photo, shift, response);
    return s == TZ_OK ? find_normals(ctx, response, photo->width, photo->height, normal)
                      : s;
}

/* ---- models -------------------------------------------------------------------------- */

#define SHIPPED "edge-forest.yml.gz"

static void drop(void *thing)
{
    tz_forest *f = thing;
    tz_ctx *ctx = f->ctx;
    tz_forest_deinit(f);
    tz_free(ctx, f);
}

static tz_status make(tz_ctx *ctx, const char *name, void **out)
{
    const char *model = strchr(name, ':') + 1;
    char *path = NULL;
    tz_forest *f = NULL;
    tz_status s =
        *model ? tz_strdup(ctx, model, &path) : tz_module_data(ctx, SHIPPED, &path);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &f, 1, sizeof *f);
    if (s == TZ_OK)
        s = tz_forest_read(ctx, path, f);
    tz_free(ctx, path);
    if (s == TZ_OK)
        *out = f;
    else
        tz_free(ctx, f);
    return s;
}

tz_status tz_forest_of(tz_ctx *ctx, const char *model, const tz_forest **out)
{
    char name[sizeof "edge forest:" + TZ_PARAM_STRING_SIZE];
    void *thing = NULL;
    snprintf(name, sizeof name, "edge forest:%s", model);
    const tz_status s = tz_ctx_keep(ctx, name, make, drop, &thing);
    if (s == TZ_OK)
        *out = thing;
    return s;
}
