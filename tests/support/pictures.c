/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/support/pictures.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/rng.h"

/* Uniform number of a lattice point. */
static double at_point(uint64_t seed, int64_t x, int64_t y, uint64_t k)
{
    tz_rng r = tz_rng_make(
        seed, tz_rng_stream((uint64_t)(x + 100000), (uint64_t)(y + 100000), k));
    return tz_rng_unit(&r);
}

static double stones(uint64_t seed, double x, double y, int32_t k)
{
    const double cell = 26;
    const double u = x / cell, v = y / cell;
    double first = 1e9, second = 1e9, tone = 0;
    for (int64_t j = (int64_t)floor(v) - 1; j <= (int64_t)floor(v) + 1; j++)
        for (int64_t i = (int64_t)floor(u) - 1; i <= (int64_t)floor(u) + 1; i++) {
            const double px = (double)i + 0.15 + 0.7 * at_point(seed, i, j, 1);
            const double py = (double)j + 0.15 + 0.7 * at_point(seed, i, j, 2);
            const double d = hypot(px - u, py - v);
            if (d < first) {
                second = first, first = d;
                tone = 0.35 + 0.45 * at_point(seed, i, j, 3 + (uint64_t)k % 4);
            } else if (d < second) {
                second = d;
            }
        }
    const double edge = fmin((second - first) / 0.12, 1);
    return 0.1 + (tone - 0.1) * edge;
}

static double bricks(uint64_t seed, double x, double y, int32_t k)
{
    const double w = 44, h = 18;
    const int64_t row = (int64_t)floor(y / h);
    const double u = x / w + 0.5 * (double)(row & 1);
    const double fx = (u - floor(u)) * w, fy = y - (double)row * h;
    const double border = fmin(fmin(fx, w - fx), fmin(fy, h - fy));
    const double tone = 0.25 + 0.3 * at_point(seed, (int64_t)floor(u), row, 1);
    return border < 1.5 ? 0.8 : tone * (k % 3 == 0 ? 1.3 : 0.9);
}

static double value(picture_kind kind, uint64_t seed, int32_t x, int32_t y, int32_t w,
                    int32_t h, int32_t k)
{
    const double grain = at_point(seed, x, y, 50 + (uint64_t)k);
    switch (kind) {
    case PICTURE_NOISE: return 0.05 + 0.9 * grain;
    case PICTURE_SMOOTH:
        return 0.5 + 0.2 * sin(0.11 * x + k) * cos(0.07 * y - 2 * k) +
               0.2 * sin(0.05 * (x + y) + 3 * k);
    case PICTURE_GRADIENT: return 0.1 + 0.5 * (x + 0.5) / w + 0.3 * (y + 0.5) / h;
    case PICTURE_STONES: return stones(seed, x + 0.5, y + 0.5, k) + 0.04 * grain;
    case PICTURE_BRICKS: return bricks(seed, x + 0.5, y + 0.5, k) + 0.04 * grain;
    default: return 0.5;
    }
}

tz_image blank(tz_ctx *ctx, int32_t width, int32_t height, int32_t channels)
{
    tz_image im = {0};
    if (tz_image_init(ctx, &im, width, height, channels) != TZ_OK) {
        fprintf(stderr, "no memory for a picture of %d x %d\n", (int)width, (int)height);
        abort();
    }
    return im;
}

tz_image picture(tz_ctx *ctx, picture_kind kind, int32_t width, int32_t height,
                 int32_t channels, uint64_t seed)
{
    tz_image im = blank(ctx, width, height, channels);
    im.encoding = TZ_ENCODING_SRGB;
    for (int32_t y = 0; y < height; y++)
        for (int32_t x = 0; x < width; x++)
            for (int32_t k = 0; k < channels; k++)
                tz_image_at(&im, x, y)[k] =
                    (float)value(kind, seed, x, y, width, height, k);
    return im;
}

tz_image picture_plane(tz_ctx *ctx, int32_t width, int32_t height, double x, double y,
                       double z)
{
    tz_image im = blank(ctx, width, height, 3);
    im.encoding = TZ_ENCODING_DATA;
    const float n[3] = {(float)(0.5 + 0.5 * x), (float)(0.5 + 0.5 * y),
                        (float)(0.5 + 0.5 * z)};
    for (int32_t j = 0; j < height; j++)
        for (int32_t i = 0; i < width; i++)
            memcpy(tz_image_at(&im, i, j), n, sizeof n);
    return im;
}

double largest_difference(const tz_image *a, const tz_image *b)
{
    double most = 0;
    for (int32_t y = 0; y < a->height; y++)
        for (int64_t i = 0; i < (int64_t)a->width * a->channels; i++) {
            const double d =
                fabs((double)tz_image_at(a, 0, y)[i] - tz_image_at(b, 0, y)[i]);
            if (isnan(d))
                return INFINITY;
            most = d > most ? d : most;
        }
    return most;
}

double mean_difference(const tz_image *a, const tz_image *b)
{
    double sum = 0;
    for (int32_t y = 0; y < a->height; y++)
        for (int64_t i = 0; i < (int64_t)a->width * a->channels; i++)
            sum += fabs((double)tz_image_at(a, 0, y)[i] - tz_image_at(b, 0, y)[i]);
    return sum / ((double)a->width * a->height * a->channels);
}

int64_t pixels_that_differ(const tz_image *a, const tz_image *b)
{
    int64_t n = 0;
    const size_t pixel = (size_t)a->channels * sizeof(float);
    for (int32_t y = 0; y < a->height; y++)
        for (int32_t x = 0; x < a->width; x++)
            n += memcmp(tz_image_at(a, x, y), tz_image_at(b, x, y), pixel) != 0;
    return n;
}

bool all_finite(const tz_image *im)
{
    for (int32_t y = 0; y < im->height; y++)
        for (int64_t i = 0; i < (int64_t)im->width * im->channels; i++)
            if (!isfinite(tz_image_at(im, 0, y)[i]))
                return false;
    return true;
}
