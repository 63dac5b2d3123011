/* SPDX-License-Identifier: Apache-2.0 */
/* Ridges. At scale s, r the picture blurred by s, the Hessian's eigenvalue l across the
 * line answers with
 *
 *     s^2 |l| = 0.484 h     for a bar of contrast h and half-width s,
 *
 * the most over all s, so that h and width are read off. A step answers as well, beside
 * itself; hence a line must also stand out against both of its sides, two s away, where a
 * bar gives 0.525 h and a step less than nothing. The smaller of the two is the strength.
 * The line runs at t = - (r' n) / l from the pixel's centre, n across (Steger eq. 17). */
#include "analysis/lines_field.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/filter_cv.h"

#define BAND    64
#define SCALES  12
#define PEAK    0.484F /* s^2 |l| of a bar of contrast 1 */
#define SIDE    0.525F /* its rise two s to the side */
#define SAMPLES 20000  /* px that tell what grain answers */
#define MARGIN  1.5    /* of sigma: as near to the border the blur mirrors lines */
#define LEAST   0.5F   /* contrasts below are nothing */

typedef struct ridges {
    float *plane, *blurred;
    int32_t w, h;
    double sigma;
    float gain; /* of this scale */
    float *sample;
    int tones;
    tz_line_field *out;
} ridges;

void tz_line_field_deinit(tz_ctx *ctx, tz_line_field *f)
{
    tz_edge_map_deinit(&f->map);
    tz_free(ctx, f->offset);
    tz_free(ctx, f->wide);
    *f = (tz_line_field){0};
}

tz_status tz_line_field_init(tz_ctx *ctx, tz_line_field *f, int32_t w, int32_t h)
{
    const size_t n = (size_t)w * (size_t)h;
    tz_status s = tz_edge_map_init(ctx, &f->map, w, h);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &f->offset, n, sizeof *f->offset);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &f->wide, n, sizeof *f->wide);
    if (s == TZ_OK) {
        memset(f->map.response, 0, n * sizeof *f->map.response);
        memset(f->map.normal, 0, 2 * n * sizeof *f->map.normal);
    }
    return s;
}

static tz_status blur_band(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    ridges *j = arg;
    const int32_t y0 = (int32_t)i * BAND, y1 = y0 + BAND < j->h ? y0 + BAND : j->h;
    (void)worker;
    return tz_cv_blur(ctx, j->plane, j->blurred, j->w, j->h, y0, y1, j->sigma);
}

/* Blurred picture at a place inside of the picture, its border continued. */
static float at(const ridges *j, float x, float y)
{
    x = x > 0 ? (x < (float)(j->w - 1) ? x : (float)(j->w - 1)) : 0;
    y = y > 0 ? (y < (float)(j->h - 1) ? y : (float)(j->h - 1)) : 0;
    const int32_t u = (int32_t)x < j->w - 1 ? (int32_t)x : j->w - 2,
                  v = (int32_t)y < j->h - 1 ? (int32_t)y : j->h - 2;
    const float fx = x - (float)u, fy = y - (float)v;
    const float *p = j->blurred + (ptrdiff_t)v * j->w + u;
    const float a = p[0] + fx * (p[1] - p[0]), b = p[j->w] + fx * (p[j->w + 1] - p[j->w]);
    return a + fy * (b - a);
}

/* Second derivatives xx, yy, xy and first ones at a pixel. */
typedef struct shape {
    float xx, yy, xy, x, y;
} shape;

/* The larger eigenvalue of the Hessian, and the other one. */
static float bend(const float *a, const float *b, const float *c, shape *d, float *minor)
{
    d->xx = b[-1] - 2 * b[0] + b[1];
    d->yy = a[0] - 2 * b[0] + c[0];
    d->xy = 0.25F * (c[1] - c[-1] - a[1] + a[-1]);
    const float mean = 0.5F * (d->xx + d->yy), half = 0.5F * (d->xx - d->yy);
    const float root = sqrtf(half * half + d->xy * d->xy);
    *minor = mean >= 0 ? mean - root : mean + root;
    return mean >= 0 ? mean + root : mean - root;
}

static int by_size(const void *a, const void *b)
{
    const float p = *(const float *)a, q = *(const float *)b;
    return (p > q) - (p < q);
}

/* What the picture's grain answers at this scale: the middle answer on a lattice. */
static double grain(const ridges *j)
{
    const int32_t step = 1 + (int32_t)sqrt((double)j->w * j->h / SAMPLES);
    int32_t n = 0;
    for (int32_t y = 1 + step / 2; y < j->h - 1; y += step)
        for (int32_t x = 1 + step / 2; x < j->w - 1 && n < SAMPLES; x += step) {
            const float *b = j->blurred + (ptrdiff_t)y * j->w + x;
            shape d;
            float minor;
            j->sample[n++] = fabsf(bend(b - j->w, b, b + j->w, &d, &minor));
        }
    qsort(j->sample, (size_t)n, sizeof *j->sample, by_size);
    return n ? j->sigma * j->sigma * j->sample[n / 2] : 0;
}

/* Enters what the pixel is at this scale, if it is more than at those before. */
static void enter(const ridges *j, int32_t x, int32_t y, const shape *d, float l,
                  float minor)
{
    tz_line_field *f = &j->out[l < 0];
    const ptrdiff_t p = (ptrdiff_t)y * j->w + x, n = (ptrdiff_t)j->w * j->h;
    const float s = (float)j->sigma, sign = l < 0 ? -1.0F : 1.0F;
    const float same = minor * sign > 0 ? minor * sign : 0; /* round, not long */
    const float by_bend = j->gain * s * s * (sign * l - 0.5F * same) / PEAK;
    if (by_bend <= f->map.response[p] || by_bend < LEAST)
        return;
    float nx = d->xy, ny = l - d->xx; /* eigenvector of l */
    if (fabsf(l - d->yy) > fabsf(ny)) {
        nx = l - d->yy;
        ny = d->xy;
    }
    const float norm = sqrtf(nx * nx + ny * ny);
    if (!(norm > 0)) {
        nx = 1;
        ny = 0;
    } else {
        nx /= norm;
        ny /= norm;
    }
    const float t = -(d->x * nx + d->y * ny) / l;
    const float far = 2 * s, mid = j->blurred[p];
    const float a = sign *
                    (at(j, (float)x + (t + far) * nx, (float)y + (t + far) * ny) - mid),
                b = sign *
                    (at(j, (float)x + (t - far) * nx, (float)y + (t - far) * ny) - mid);
    const float by_sides = j->gain * (a < b ? a : b) / SIDE;
    const float strength = by_sides < by_bend ? by_sides : by_bend;
    if (strength <= f->map.response[p] || strength < LEAST)
        return;
    f->map.response[p] = strength;
    f->map.normal[p] = nx * nx - ny * ny;
    f->map.normal[p + n] = 2 * nx * ny;
    f->offset[p] = t > 1 ? 1 : t < -1 ? -1 : t;
    if (nx < 0) /* the normal that the doubled angle gives back */
        f->offset[p] = -f->offset[p];
    f->wide[p] = 2 * s;
}

static tz_status ridge_band(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    ridges *j = arg;
    const int32_t w = j->w, from = (int32_t)i * BAND, to = from + BAND;
    const int32_t margin = (int32_t)ceil(fmax(1, MARGIN * j->sigma));
    const int32_t y0 = from > margin ? from : margin,
                  y1 = to < j->h - margin ? to : j->h - margin;
    const float least = LEAST * PEAK / (float)(j->sigma * j->sigma) / j->gain;
    (void)ctx, (void)worker;
    for (int32_t y = y0; y < y1; y++) {
        const float *b = j->blurred + (ptrdiff_t)y * w, *a = b - w, *c = b + w;
        for (int32_t x = margin; x < w - margin; x++) {
            shape d;
            float minor;
            const float l = bend(a + x, b + x, c + x, &d, &minor);
            if (fabsf(l) < least || !(j->tones & (l < 0 ? 2 : 1)))
                continue;
            d.x = 0.5F * (b[x + 1] - b[x - 1]);
            d.y = 0.5F * (c[x] - a[x]);
            enter(j, x, y, &d, l, minor);
        }
    }
    return TZ_OK;
}

tz_status tz_line_ridges(tz_ctx *ctx, float *plane, int32_t w, int32_t h,
                         const double width[2], int tones, tz_line_field out[2])
{
    ridges j = {.plane = plane, .w = w, .h = h, .tones = tones, .out = out};
    const int32_t bands = (h + BAND - 1) / BAND;
    out[0] = out[1] = (tz_line_field){0};
    tz_status s = tz_alloc(ctx, &j.blurred, (size_t)w * (size_t)h, sizeof(float));
    for (int k = 0; k < 2 && s == TZ_OK; k++)
        if (tones & (k + 1))
            s = tz_line_field_init(ctx, &out[k], w, h);
    out[1].light = true;
    double first = 0;
    if (s == TZ_OK)
        s = tz_alloc(ctx, &j.sample, SAMPLES, sizeof *j.sample);
    if (s != TZ_OK || w < 3 || h < 3)
        goto done;
    j.sigma = fmax(0.5 * width[0], 0.8);
    for (int k = 0; k < SCALES && s == TZ_OK; k++) {
        s = tz_parallel_for(ctx, bands, blur_band, &j);
        const double here = s == TZ_OK ? grain(&j) : 0;
        if (k == 0)
            first = here;
        j.gain = here > 0 && first > 0 ? (float)fmin(fmax(sqrt(first / here), 1), 2) : 1;
        if (s == TZ_OK)
            s = tz_parallel_for(ctx, bands, ridge_band, &j);
        if (j.sigma >= 0.5 * width[1])
            break;
        j.sigma = fmin(j.sigma * sqrt(2), fmax(0.5 * width[1], 0.8));
    }
done:
    tz_free(ctx, j.blurred);
    tz_free(ctx, j.sample);
    for (int k = 0; k < 2 && s != TZ_OK; k++)
        tz_line_field_deinit(ctx, &out[k]);
    return s;
}
