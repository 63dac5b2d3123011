/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "analysis/lines_field.h"

typedef struct look {
    const tz_image *photo;
    int32_t shift;
    tz_line_picture *out;
} look;

static float clamp_unit(float v) { return v > 0 ? (v < 1 ? v : 1) : 0; }

/* Sum of a block of the photo, encoded. */
static void add_block(const look *l, int32_t x, int32_t y, float sum[3], int32_t *n)
{
    const tz_image *im = l->photo;
    const int32_t side = 1 << l->shift, channels = l->out->channels;
    const bool linear = im->encoding == TZ_ENCODING_LINEAR;
    for (int32_t v = y * side; v < (y + 1) * side && v < im->height; v++)
        for (int32_t u = x * side; u < (x + 1) * side && u < im->width; u++, (*n)++) {
            const float *p = tz_image_at(im, u, v);
            const float alpha = im->alpha >= 0 ? clamp_unit(p[im->alpha]) : 1;
            for (int32_t c = 0; c < channels; c++) {
                const float e =
                    linear ? tz_srgb_encode(clamp_unit(p[c])) : clamp_unit(p[c]);
                sum[c] += 100 * (alpha * e + (1 - alpha) * 0.5F);
            }
        }
}

static tz_status row(tz_ctx *ctx, void *arg, int64_t y, int worker)
{
    const look *l = arg;
    tz_line_picture *o = l->out;
    const ptrdiff_t all = (ptrdiff_t)o->width * o->height;
    (void)ctx, (void)worker;
    for (int32_t x = 0; x < o->width; x++) {
        float sum[3] = {0};
        int32_t n = 0;
        add_block(l, x, (int32_t)y, sum, &n);
        for (int32_t c = 0; c < o->channels; c++)
            o->v[c * all + (ptrdiff_t)y * o->width + x] = sum[c] / (float)n;
    }
    return TZ_OK;
}

tz_status tz_line_picture_init(tz_ctx *ctx, const tz_image *photo, int32_t shift,
                               tz_line_picture *out)
{
    const int32_t side = 1 << shift;
    look l = {photo, shift, out};
    *out = (tz_line_picture){.width = (photo->width + side - 1) / side,
                             .height = (photo->height + side - 1) / side,
                             .channels = photo->channels >= 3 ? 3 : 1,
                             .ctx = ctx};
    tz_status s = tz_alloc(
        ctx, &out->v, (size_t)out->width * (size_t)out->height * (size_t)out->channels,
        sizeof *out->v);
    if (s == TZ_OK)
        s = tz_parallel_for(ctx, out->height, row, &l);
    if (s != TZ_OK)
        tz_line_picture_deinit(out);
    return s;
}

void tz_line_picture_deinit(tz_line_picture *p)
{
    tz_free(p->ctx, p->v);
    *p = (tz_line_picture){0};
}
