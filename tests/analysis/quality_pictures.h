/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What the tests of the quality measures share: a drawn texture that goes on for ever, and
 * the ways to spoil a picture. */
#ifndef TZ_TESTS_ANALYSIS_QUALITY_PICTURES_H
#define TZ_TESTS_ANALYSIS_QUALITY_PICTURES_H

#include "tests/analysis/draw.h"

#include "analysis/quality.h"

static inline tz_quality_params quality_params(void)
{
    tz_quality_params p;
    memset(&p, 0, sizeof p);
    tz_params_default(&tz_quality_param_table, &p);
    return p;
}

static inline tz_quality measure(tz_ctx *ctx, const tz_image *e, const tz_image *o)
{
    tz_quality_params p = quality_params();
    tz_quality q;
    ok(ctx, tz_quality_measure(ctx, e, o, &p, &q, NULL));
    return q;
}

/* One value of smooth noise in -1..1 at a grain of `size` px. */
static inline double grain(double x, double y, double size, uint64_t seed)
{
    double u = floor(x / size), v = floor(y / size), sum = 0;
    for (int k = 0; k < 4; k++) {
        double i = u + (k & 1), j = v + (k >> 1);
        tz_rng r = tz_rng_make(
            seed, tz_rng_stream(7, (uint64_t)(int64_t)i, (uint64_t)(int64_t)j));
        sum +=
            (1 - fabs(x / size - i)) * (1 - fabs(y / size - j)) * tz_rng_range(&r, -1, 1);
    }
    return sum;
}

/* The part at (x0, y0) of an endless wall of stones, 30 px, coloured, with soft joints and
 * two sizes of grain. */
static inline tz_image stones(tz_ctx *ctx, int32_t x0, int32_t y0, int32_t w, int32_t h)
{
    tz_image im = new_picture(ctx, w, h, 3);
    for (int32_t y = y0; y < y0 + h; y++)
        for (int32_t x = x0; x < x0 + w; x++) {
            double near[2] = {1e9, 1e9}, colour[3] = {0};
            for (int32_t j = y / 30 - 1; j <= y / 30 + 1; j++)
                for (int32_t i = x / 30 - 1; i <= x / 30 + 1; i++) {
                    tz_rng r = tz_rng_make(2, tz_rng_stream(0, (uint64_t)i, (uint64_t)j));
                    double dx = (i + tz_rng_unit(&r)) * 30 - x;
                    double dy = (j + tz_rng_unit(&r)) * 30 - y,
                           d = sqrt(dx * dx + dy * dy);
                    near[1] = d < near[0] ? near[0] : d < near[1] ? d : near[1];
                    if (d < near[0]) {
                        near[0] = d;
                        double grey = tz_rng_range(&r, 0.3, 0.7);
                        for (int c = 0; c < 3; c++)
                            colour[c] = grey + tz_rng_range(&r, -0.06, 0.06);
                    }
                }
            double joint = fmin(1, fmax(0, (near[1] - near[0]) / 6));
            double g = 0.08 * grain(x, y, 2, 3) + 0.08 * grain(x, y, 5, 4);
            for (int c = 0; c < 3; c++)
                tz_image_at(&im, x - x0, y - y0)[c] =
                    (float)(0.2 + g + joint * (colour[c] - 0.2));
        }
    return im;
}

static inline tz_image part(tz_ctx *ctx, const tz_image *im, int32_t x, int32_t y,
                            int32_t w, int32_t h)
{
    tz_image v = tz_image_view(im, (tz_rect){x, y, w, h}), o;
    ok(ctx, tz_image_copy(ctx, &v, &o));
    return o;
}

static inline void copy_pixel(const tz_image *s, int32_t sx, int32_t sy, tz_image *d,
                              int32_t x, int32_t y)
{
    memcpy(tz_image_at(d, x, y), tz_image_at(s, sx, sy),
           (size_t)s->channels * sizeof(float));
}

/* n x n times the picture. */
static inline tz_image tiled(tz_ctx *ctx, const tz_image *im, int32_t n)
{
    tz_image o = new_picture(ctx, im->width * n, im->height * n, im->channels);
    for (int32_t y = 0; y < o.height; y++)
        for (int32_t x = 0; x < o.width; x++)
            copy_pixel(im, x % im->width, y % im->height, &o, x, y);
    return o;
}

/* Blocks of `side` px in random order. */
static inline tz_image shuffled(tz_ctx *ctx, const tz_image *im, int32_t side)
{
    int32_t w = im->width / side, h = im->height / side, at[4096];
    tz_image o = new_picture(ctx, w * side, h * side, im->channels);
    tz_rng r = tz_rng_make(9, 0);
    for (int32_t i = 0; i < w * h; i++)
        at[i] = i;
    for (int32_t i = w * h - 1; i > 0; i--) {
        int32_t j = tz_rng_below(&r, i + 1), t = at[i];
        at[i] = at[j], at[j] = t;
    }
    for (int32_t y = 0; y < o.height; y++)
        for (int32_t x = 0; x < o.width; x++) {
            int32_t b = at[y / side * w + x / side];
            copy_pixel(im, b % w * side + x % side, b / w * side + y % side, &o, x, y);
        }
    return o;
}

/* Voronoi patches, hard-edged: each shows the picture at an offset of its own. */
static inline tz_image polygons(tz_ctx *ctx, const tz_image *im, int32_t size)
{
    tz_image o = new_picture(ctx, im->width, im->height, im->channels);
    for (int32_t y = 0; y < o.height; y++)
        for (int32_t x = 0; x < o.width; x++) {
            double best = 1e18, dx = 0, dy = 0;
            for (int32_t j = y / size - 1; j <= y / size + 1; j++)
                for (int32_t i = x / size - 1; i <= x / size + 1; i++) {
                    tz_rng r = tz_rng_make(5, tz_rng_stream(0, (uint64_t)i, (uint64_t)j));
                    double px = (i + tz_rng_unit(&r)) * size - x;
                    double py = (j + tz_rng_unit(&r)) * size - y;
                    if (px * px + py * py < best) {
                        best = px * px + py * py;
                        dx = tz_rng_below(&r, im->width);
                        dy = tz_rng_below(&r, im->height);
                    }
                }
            int32_t u = (x + (int32_t)dx) % (2 * im->width);
            int32_t v = (y + (int32_t)dy) % (2 * im->height);
            u = u < im->width ? u : 2 * im->width - 1 - u;
            v = v < im->height ? v : 2 * im->height - 1 - v;
            copy_pixel(im, u, v, &o, x, y);
        }
    return o;
}

static inline tz_image blurred(tz_ctx *ctx, const tz_image *im, double sigma)
{
    tz_image t = new_picture(ctx, im->width, im->height, im->channels), o;
    ok(ctx, tz_image_copy(ctx, &t, &o));
    double k[33], sum = 0;
    int32_t r = (int32_t)ceil(3 * sigma);
    for (int32_t i = -r; i <= r; i++)
        sum += k[i + r] = exp(-i * i / (2 * sigma * sigma));
    for (int pass = 0; pass < 2; pass++) {
        const tz_image *s = pass ? &t : im;
        for (int32_t y = 0; y < im->height; y++)
            for (int32_t x = 0; x < im->width; x++)
                for (int32_t c = 0; c < im->channels; c++) {
                    double v = 0;
                    for (int32_t i = -r; i <= r; i++) {
                        int32_t u = pass ? x : x + i, w = pass ? y + i : y;
                        u = u < 0 ? 0 : u >= im->width ? im->width - 1 : u;
                        w = w < 0 ? 0 : w >= im->height ? im->height - 1 : w;
                        v += k[i + r] / sum * (double)tz_image_at(s, u, w)[c];
                    }
                    tz_image_at(pass ? &o : &t, x, y)[c] = (float)v;
                }
    }
    tz_image_deinit(&t);
    return o;
}

/* Spectrum kept, phases random: sum of K copies at random cyclic shifts with random signs,
 * that is, the picture convolved with noise. */
static inline tz_image phase_noise(tz_ctx *ctx, const tz_image *im)
{
    enum { K = 100 };
    tz_image o = new_picture(ctx, im->width, im->height, im->channels);
    double mean[4] = {0}, n = (double)im->width * im->height;
    tz_rng r = tz_rng_make(6, 0);
    for (int32_t y = 0; y < im->height; y++)
        for (int32_t x = 0; x < im->width; x++)
            for (int32_t c = 0; c < im->channels; c++) {
                mean[c] += (double)tz_image_at(im, x, y)[c] / n;
                tz_image_at(&o, x, y)[c] = 0;
            }
    for (int k = 0; k < K; k++) {
        int32_t dx = tz_rng_below(&r, im->width), dy = tz_rng_below(&r, im->height);
        float sign = (tz_rng_below(&r, 2) ? 1 : -1) / sqrtf(K);
        for (int32_t y = 0; y < im->height; y++)
            for (int32_t x = 0; x < im->width; x++) {
                const float *s =
                    tz_image_at(im, (x + dx) % im->width, (y + dy) % im->height);
                for (int32_t c = 0; c < im->channels; c++)
                    tz_image_at(&o, x, y)[c] += sign * (s[c] - (float)mean[c]);
            }
    }
    for (int32_t y = 0; y < im->height; y++)
        for (int32_t x = 0; x < im->width; x++)
            for (int32_t c = 0; c < im->channels; c++)
                tz_image_at(&o, x, y)[c] += (float)mean[c];
    return o;
}

#endif
