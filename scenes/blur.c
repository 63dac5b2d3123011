/* SPDX-License-Identifier: Apache-2.0 */
/* Blur: a sampled Gaussian for small deviations, three box filters for large ones. */
#include "scenes/stage.h"

#include <string.h>

enum { TAPS = 10 }; /* the kernel reaches so far on each side */

static int32_t inside(int32_t i, int32_t n) { return i < 0 ? 0 : i >= n ? n - 1 : i; }

static int32_t kernel(double sigma, float tap[TAPS + 1])
{
    const int32_t reach = (int32_t)ceil(3 * sigma), r = reach > TAPS ? TAPS : reach;
    double sum = 0;
    for (int32_t k = 0; k <= r; k++)
        sum += (k ? 2 : 1) * exp(-0.5 * k * k / (sigma * sigma));
    for (int32_t k = 0; k <= r; k++)
        tap[k] = (float)(exp(-0.5 * k * k / (sigma * sigma)) / sum);
    return r;
}

static void gauss_rows(float *v, int32_t w, int32_t h, const float *tap, int32_t r,
                       float *row)
{
    for (int32_t y = 0; y < h; y++) {
        float *to = v + (int64_t)y * w;
        for (int32_t x = -r; x < w + r; x++)
            row[x + r] = to[inside(x, w)];
        for (int32_t x = 0; x < w; x++)
            to[x] = tap[0] * row[x + r];
        for (int32_t k = 1; k <= r; k++)
            for (int32_t x = 0; x < w; x++)
                to[x] += tap[k] * (row[x + r - k] + row[x + r + k]);
    }
}

static void gauss_columns(float *v, int32_t w, int32_t h, const float *tap, int32_t r,
                          float *copy)
{
    memcpy(copy, v, (size_t)w * (size_t)h * sizeof *v);
    for (int32_t y = 0; y < h; y++) {
        float *to = v + (int64_t)y * w;
        for (int32_t x = 0; x < w; x++)
            to[x] *= tap[0];
        for (int32_t k = 1; k <= r; k++) {
            const float *up = copy + (int64_t)inside(y - k, h) * w;
            const float *down = copy + (int64_t)inside(y + k, h) * w;
            for (int32_t x = 0; x < w; x++)
                to[x] += tap[k] * (up[x] + down[x]);
        }
    }
}

static void box_rows(float *v, int32_t w, int32_t h, int32_t r, float *row)
{
    const double part = 1.0 / (2 * r + 1);
    for (int32_t y = 0; y < h; y++) {
        float *to = v + (int64_t)y * w;
        double sum = 0;
        memcpy(row, to, (size_t)w * sizeof *row);
        for (int32_t k = -r; k <= r; k++)
            sum += row[inside(k, w)];
        for (int32_t x = 0; x < w; x++) {
            to[x] = (float)(sum * part);
            sum += row[inside(x + r + 1, w)] - row[inside(x - r, w)];
        }
    }
}

static void box_columns(float *v, int32_t w, int32_t h, int32_t r, float *copy,
                        double *sum)
{
    const double part = 1.0 / (2 * r + 1);
    memcpy(copy, v, (size_t)w * (size_t)h * sizeof *v);
    memset(sum, 0, (size_t)w * sizeof *sum);
    for (int32_t k = -r; k <= r; k++)
        for (int32_t x = 0; x < w; x++)
            sum[x] += copy[(int64_t)inside(k, h) * w + x];
    for (int32_t y = 0; y < h; y++) {
        const float *in = copy + (int64_t)inside(y + r + 1, h) * w;
        const float *out = copy + (int64_t)inside(y - r, h) * w;
        for (int32_t x = 0; x < w; x++) {
            v[(int64_t)y * w + x] = (float)(sum[x] * part);
            sum[x] += in[x] - out[x];
        }
    }
}

tz_status tz_scene_blur(tz_ctx *ctx, float *plane, int32_t width, int32_t height,
                        double sigma)
{
    float *copy = NULL, *row = NULL;
    double *sum = NULL;
    if (!(sigma > 0.15))
        return TZ_OK;
    tz_status s = tz_alloc(ctx, &copy, (size_t)width * (size_t)height, sizeof *copy);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &row, (size_t)width + 2 * TAPS, sizeof *row);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &sum, (size_t)width, sizeof *sum);
    if (s == TZ_OK && sigma < 3) {
        float tap[TAPS + 1] = {0};
        const int32_t r = kernel(sigma, tap);
        gauss_rows(plane, width, height, tap, r, row);
        gauss_columns(plane, width, height, tap, r, copy);
    } else if (s == TZ_OK) { /* three boxes of side 2 r + 1 have variance r (r + 1) */
        const int32_t r = (int32_t)(sqrt(sigma * sigma + 0.25) - 0.5 + 0.5);
        for (int32_t k = 0; k < 3; k++) {
            box_rows(plane, width, height, r, row);
            box_columns(plane, width, height, r, copy, sum);
        }
    }
    tz_free(ctx, copy);
    tz_free(ctx, row);
    tz_free(ctx, sum);
    return s;
}
