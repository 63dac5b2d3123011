/* SPDX-License-Identifier: Apache-2.0 */
/* Hands the photo to the module and turns its orientations into double angles. Photos
 * smaller than the model's patch are mirrored out to 64 px first. */
#include "analysis/forest.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

#include "analysis/forest_module.h"
#include "base/module.h"

#define LEAST_SIDE    64
#define LARGEST_MODEL ((int64_t)1 << 30)

/* Index into 0..n-1, mirrored without doubling the border. */
static int32_t mirror(int32_t i, int32_t n)
{
    if (n == 1)
        return 0;
    const int32_t k = i % (2 * n - 2);
    return k < n ? k : 2 * n - 2 - k;
}

static void fill_rgb(const tz_image *photo, float *rgb, int32_t w, int32_t h)
{
    const bool linear = photo->encoding == TZ_ENCODING_LINEAR;
    for (int32_t y = 0; y < h; y++) {
        for (int32_t x = 0; x < w; x++) {
            const float *p =
                tz_image_at(photo, mirror(x, photo->width), mirror(y, photo->height));
            for (int32_t c = 0; c < 3; c++) {
                float v = p[photo->channels >= 3 ? c : 0];
                v = v > 0 ? (v < 1 ? v : 1) : 0; /* NaN too */
                *rgb++ = linear ? tz_srgb_encode(v) : v;
            }
        }
    }
}

static tz_status check_file(tz_ctx *ctx, const char *model)
{
    struct stat info;
    if (stat(model, &info) != 0)
        return tz_fail(ctx, TZ_IO, "%s: %s; --model wants a structured-forest model",
                       model, strerror(errno));
    if (!S_ISREG(info.st_mode))
        return tz_fail(ctx, TZ_IO, "%s: not a regular file", model);
    if (info.st_size > LARGEST_MODEL)
        return tz_fail(ctx, TZ_LIMIT, "%s: over 1 GiB, not an edge model", model);
    return TZ_OK;
}

tz_status tz_forest_response(tz_ctx *ctx, const tz_image *photo, const char *model,
                             float *response, float *normal)
{
    const int32_t w = photo->width > LEAST_SIDE ? photo->width : LEAST_SIDE;
    const int32_t h = photo->height > LEAST_SIDE ? photo->height : LEAST_SIDE;
    const size_t n = (size_t)w * h, plane = (size_t)photo->width * photo->height;
    tz_forest_detect_fn detect = NULL;
    float *rgb = NULL, *out = NULL;
    char why[200] = "";
    tz_status s;

    if ((s = check_file(ctx, model)) != TZ_OK)
        goto done;
    if ((s = tz_module_symbol(ctx, "forest", "tz_forest_detect", &detect)) != TZ_OK)
        goto done;
    if ((s = tz_alloc(ctx, &rgb, n, 3 * sizeof *rgb)) != TZ_OK)
        goto done;
    if ((s = tz_alloc(ctx, &out, n, 2 * sizeof *out)) != TZ_OK)
        goto done;
    fill_rgb(photo, rgb, w, h);
    switch (detect(model, rgb, w, h, out, out + n, why, sizeof why)) {
    case TZ_FOREST_OK: break;
    case TZ_FOREST_NOMEM: s = tz_fail(ctx, TZ_NOMEM, "%s: out of memory", model); break;
    case TZ_FOREST_BAD_MODEL:
        s = tz_fail(ctx, TZ_FORMAT, "%s: not a structured-forest model: %s", model, why);
        break;
    case TZ_FOREST_FAILED: s = tz_fail(ctx, TZ_INVALID, "%s: %s", model, why); break;
    }
    if (s != TZ_OK)
        goto done;
    for (int32_t y = 0; y < photo->height; y++) {
        for (int32_t x = 0; x < photo->width; x++) {
            const size_t p = (size_t)y * photo->width + x, q = (size_t)y * w + x;
            const float a = 2 * out[n + q];
            response[p] = out[q] > 0 ? out[q] : 0;
            normal[p] = isfinite(a) ? cosf(a) : 1;
            normal[p + plane] = isfinite(a) ? sinf(a) : 0;
        }
    }
done:
    tz_free(ctx, rgb);
    tz_free(ctx, out);
    return s;
}
