/* SPDX-License-Identifier: Apache-2.0 */
/* Boundary tensor of Koethe (Integrated edge and junction detection with the boundary
 * tensor, ICCV 2003) with Gaussian derivatives in place of his polar separable filters:
 *
 *     T = sum over channels of  s^2 g g' + s^4 H H,    g = gradient, H = Hessian at scale
 * s
 *
 * g answers to steps and H to lines; they are in quadrature, so that a step, a dark crack
 * and a light joint of mortar each give one ridge, in their middle. A plain gradient
 * gives two ridges along a crack and puts a stone's border beside the joint. Directions
 * add over channels and scales as tensors, without the cancelling of signs.
 *
 * Levels: blur (s = 1.4 px), take every second pixel, blur the remaining 1.2 px, ... */
#include "analysis/tensor.h"

#include <string.h>

#include "analysis/filter_cv.h"

#define BAND     16 /* rows of an item of parallel work */
#define MIN_SIDE 12

typedef struct tz_tensor_job {
    const tz_image *photo;
    tz_tensor *t;
    float *raw; /* planes before the blur */
    int32_t level;
    float white;   /* largest finite colour value, at least 1 */
    float *decode; /* sRGB to linear over 0..1, STEPS + 2 entries; NULL if linear */
    float *root;   /* CIE f over 0..1, likewise */
    double *sum;   /* a band's sum of responses */
    const double *weight;
    float *r, *normal;
} tz_tensor_job;

static int32_t bands(int32_t height) { return (height + BAND - 1) / BAND; }

/* ---- photo to Lab ---------------------------------------------------------------- */

/* HDR values are compressed by Reinhard's curve, which leaves 0 and `white` in place. */
static float clean(float v, float white)
{
    if (!(v > 0))
        return 0; /* NaN too */
    if (v > white)
        v = white;
    return white > 1 ? v * (1 + v / (white * white)) / (1 + v) : v;
}

static float largest(const tz_image *im)
{
    float m = 1;
    for (int32_t y = 0; y < im->height; y++) {
        const float *p = tz_image_at(im, 0, y);
        int64_t n = (int64_t)im->width * im->channels;
        float row = 1;
        for (int64_t i = 0; i < n; i++)
            row = p[i] > row ? p[i] : row;
        if (row > m)
            m = row < 1e30f ? row : 1e30f;
    }
    return m;
}

#define STEPS 4096

static float look_up(const float *table, float v)
{
    const float t = v * STEPS;
    const int32_t i = (int32_t)t;
    return table[i] + (t - (float)i) * (table[i + 1] - table[i]);
}

/* Tables in place of powers: OpenCV's own conversion spends 25 ms on its tables first. */
static tz_status make_tables(tz_ctx *ctx, tz_tensor_job *j, bool linear)
{
    tz_status s;
    if ((s = tz_alloc(ctx, &j->root, STEPS + 2, sizeof(float))) != TZ_OK)
        return s;
    if (!linear && (s = tz_alloc(ctx, &j->decode, STEPS + 2, sizeof(float))) != TZ_OK)
        return s;
    for (int32_t i = 0; i < STEPS + 2; i++) {
        const double t = i / (double)STEPS;
        j->root[i] = (float)(t > 216.0 / 24389 ? cbrt(t) : (24389.0 / 27 * t + 16) / 116);
        if (!linear)
            j->decode[i] = tz_srgb_decode((float)t);
    }
    return TZ_OK;
}

/* CIE Lab, D65, of clean values. */
static void to_lab(const tz_tensor_job *j, const float *rgb, float *lab)
{
    float v[3];
    for (int32_t c = 0; c < 3; c++)
        v[c] = j->decode ? look_up(j->decode, rgb[c]) : rgb[c];
    const float x = 0.433953f * v[0] + 0.376219f * v[1] + 0.189828f * v[2];
    const float y = 0.212671f * v[0] + 0.715160f * v[1] + 0.072169f * v[2];
    const float z = 0.017758f * v[0] + 0.109477f * v[1] + 0.872765f * v[2];
    const float fx = look_up(j->root, x), fy = look_up(j->root, y),
                fz = look_up(j->root, z);
    lab[0] = 116 * fy - 16;
    lab[1] = 500 * (fx - fy);
    lab[2] = 200 * (fy - fz);
}

static tz_status lab_band(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    tz_tensor_job *j = arg;
    const tz_image *im = j->photo;
    const size_t plane = (size_t)im->width * im->height;
    const int32_t y1 =
        (int32_t)(i + 1) * BAND < im->height ? (int32_t)(i + 1) * BAND : im->height;
    const int32_t colours = im->channels >= 3 ? 3 : 1;
    (void)ctx, (void)worker;
    for (int32_t y = (int32_t)i * BAND; y < y1; y++) {
        const float *p = tz_image_at(im, 0, y);
        float *d = j->raw + (size_t)y * im->width;
        for (int32_t x = 0; x < im->width; x++, p += im->channels, d++) {
            float rgb[3], lab[3] = {0}, a = im->alpha < 0 ? 1 : p[im->alpha];
            a = a > 0 ? (a < 1 ? a : 1) : 0;
            for (int32_t c = 0; c < 3; c++) {
                const float v = clean(p[colours == 3 ? c : 0], j->white);
                rgb[c] = a * v + (1 - a) * 0.5f;
            }
            to_lab(j, rgb, lab);
            for (int32_t c = 0; c < j->t->channels; c++)
                d[c * plane] = lab[c];
        }
    }
    return TZ_OK;
}

/* ---- one level ------------------------------------------------------------------- */

static tz_status blur_band(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    tz_tensor_job *j = arg;
    tz_tensor_level *l = &j->t->level[j->level];
    const int32_t nb = bands(l->height), c = (int32_t)(i / nb),
                  y0 = (int32_t)(i % nb) * BAND;
    const int32_t y1 = y0 + BAND < l->height ? y0 + BAND : l->height;
    const size_t off = (size_t)c * l->width * l->height;
    (void)worker;
    return tz_cv_blur(ctx, j->raw + off, l->lab + off, l->width, l->height, y0, y1,
                      j->level ? 1.2 : TZ_TENSOR_SIGMA);
}

/* One row of T += s^2 g g' + s^4 H H; a, b, c are the rows above, here and below. */
static void tensor_row(const float *restrict a, const float *restrict b,
                       const float *restrict c, int32_t w, float *restrict s,
                       float *restrict d, float *restrict k)
{
    const float s2 = (float)(TZ_TENSOR_SIGMA * TZ_TENSOR_SIGMA), s4 = s2 * s2;
    for (int32_t x = 1; x < w - 1; x++) {
        float gx = 0.5f * (b[x + 1] - b[x - 1]), gy = 0.5f * (c[x] - a[x]);
        float xx = b[x + 1] - 2 * b[x] + b[x - 1], yy = c[x] - 2 * b[x] + a[x];
        float xy = 0.25f * (c[x + 1] - c[x - 1] - a[x + 1] + a[x - 1]);
        s[x] += s2 * (gx * gx + gy * gy) + s4 * (xx * xx + 2 * xy * xy + yy * yy);
        d[x] += s2 * (gx * gx - gy * gy) + s4 * (xx * xx - yy * yy);
        k[x] += 2 * (s2 * gx * gy + s4 * xy * (xx + yy));
    }
}

static tz_status tensor_band(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    tz_tensor_job *j = arg;
    tz_tensor_level *l = &j->t->level[j->level];
    const int32_t w = l->width, h = l->height, y0 = (int32_t)i * BAND;
    const int32_t y1 = y0 + BAND < h ? y0 + BAND : h;
    const size_t plane = (size_t)w * h;
    double sum = 0;
    (void)ctx, (void)worker;
    for (int32_t y = y0; y < y1; y++) {
        float *s = l->tensor + (size_t)y * w, *d = s + plane, *k = d + plane;
        memset(s, 0, (size_t)w * sizeof *s);
        memset(d, 0, (size_t)w * sizeof *d);
        memset(k, 0, (size_t)w * sizeof *k);
        if (w < 3)
            continue;
        for (int32_t c = 0; c < j->t->channels; c++) {
            const float *b = l->lab + c * plane + (size_t)y * w;
            tensor_row(y > 0 ? b - w : b, b, y < h - 1 ? b + w : b, w, s, d, k);
        }
        s[0] = s[1], d[0] = d[1], k[0] = k[1];
        s[w - 1] = s[w - 2], d[w - 1] = d[w - 2], k[w - 1] = k[w - 2];
        float row = 0;
        for (int32_t x = 0; x < w; x++)
            row += sqrtf(0.5f * (s[x] + sqrtf(d[x] * d[x] + k[x] * k[x])));
        sum += row;
    }
    j->sum[i] = sum;
    return TZ_OK;
}

static tz_status make_level(tz_ctx *ctx, tz_tensor_job *j)
{
    tz_tensor_level *l = &j->t->level[j->level];
    const int32_t nb = bands(l->height), channels = j->t->channels;
    const size_t plane = (size_t)l->width * l->height;
    tz_status s;
    if ((s = tz_alloc(ctx, &l->lab, plane, channels * sizeof(float))) != TZ_OK)
        return s;
    if ((s = tz_alloc(ctx, &l->tensor, plane, 3 * sizeof(float))) != TZ_OK)
        return s;
    if ((s = tz_parallel_for(ctx, (int64_t)nb * channels, blur_band, j)) != TZ_OK)
        return s;
    if ((s = tz_parallel_for(ctx, nb, tensor_band, j)) != TZ_OK)
        return s;
    double sum = 0;
    for (int32_t i = 0; i < nb; i++)
        sum += j->sum[i];
    l->energy = sum / (double)plane;
    return TZ_OK;
}

/* Every second pixel of level k becomes the raw picture of level k + 1. */
static void halve(const tz_tensor_level *l, const tz_tensor_level *next, int32_t channels,
                  float *raw)
{
    for (int32_t c = 0; c < channels; c++) {
        for (int32_t y = 0; y < next->height; y++) {
            const float *p =
                l->lab + (size_t)l->width * ((size_t)c * l->height + 2 * (size_t)y);
            for (int32_t x = 0; x < next->width; x++)
                *raw++ = p[2 * x];
        }
    }
}

tz_status tz_tensor_init(tz_ctx *ctx, const tz_image *photo, tz_tensor *t)
{
    tz_tensor_job j = {.photo = photo, .t = t};
    tz_status s;

    *t = (tz_tensor){.channels = photo->channels >= 3 ? 3 : 1, .n = 1, .ctx = ctx};
    t->level[0].width = photo->width;
    t->level[0].height = photo->height;
    j.white = largest(photo);
    size_t plane = (size_t)photo->width * photo->height;
    if ((s = tz_alloc(ctx, &j.raw, plane, t->channels * sizeof(float))) != TZ_OK)
        goto done;
    if ((s = tz_alloc(ctx, &j.sum, bands(photo->height), sizeof *j.sum)) != TZ_OK)
        goto done;
    s = make_tables(ctx, &j, photo->encoding == TZ_ENCODING_LINEAR);
    if (s != TZ_OK)
        goto done;
    if ((s = tz_parallel_for(ctx, bands(photo->height), lab_band, &j)) != TZ_OK)
        goto done;
    for (;;) {
        if ((s = make_level(ctx, &j)) != TZ_OK)
            goto done;
        const tz_tensor_level *l = &t->level[j.level];
        int32_t side = l->width < l->height ? l->width : l->height;
        if (t->n == TZ_TENSOR_LEVELS || side < 2 * MIN_SIDE)
            break;
        j.level = t->n++;
        t->level[j.level].width = (l->width + 1) / 2;
        t->level[j.level].height = (l->height + 1) / 2;
        halve(l, &t->level[j.level], t->channels, j.raw);
    }
done:
    tz_free(ctx, j.raw);
    tz_free(ctx, j.sum);
    tz_free(ctx, j.decode);
    tz_free(ctx, j.root);
    if (s != TZ_OK)
        tz_tensor_deinit(t);
    return s;
}

void tz_tensor_deinit(tz_tensor *t)
{
    for (int32_t i = 0; i < TZ_TENSOR_LEVELS; i++) {
        tz_free(t->ctx, t->level[i].lab);
        tz_free(t->ctx, t->level[i].tensor);
    }
    *t = (tz_tensor){0};
}

/* ---- levels to one response ------------------------------------------------------ */

/* Adds weight * row y of a level's plane, interpolated to the photo's pixels. `mixed` is
 * scratch for one row of the level. */
static void add_row(const float *plane, const tz_tensor_level *l, int32_t level,
                    int32_t y, int32_t width, float weight, float *restrict mixed,
                    float *restrict out)
{
    const int32_t step = 1 << level, y0 = y >> level;
    const int32_t y1 = y0 + 1 < l->height ? y0 + 1 : y0;
    const float f = (float)(y & (step - 1)) / (float)step;
    const float *p = plane + (size_t)y0 * l->width, *q = plane + (size_t)y1 * l->width;
    if (level == 0) {
        for (int32_t x = 0; x < width; x++)
            out[x] += weight * p[x];
        return;
    }
    for (int32_t x = 0; x < l->width; x++)
        mixed[x] = weight * (p[x] + f * (q[x] - p[x]));
    mixed[l->width] = mixed[l->width - 1];
    for (int32_t x = 0, i = 0; x < width; x += step, i++) {
        const float a = mixed[i], slope = (mixed[i + 1] - a) / (float)step;
        const int32_t n = width - x < step ? width - x : step;
        for (int32_t k = 0; k < n; k++)
            out[x + k] += a + (float)k * slope;
    }
}

static tz_status response_band(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    tz_tensor_job *j = arg;
    const tz_tensor *t = j->t;
    const int32_t w = t->level[0].width, h = t->level[0].height, y0 = (int32_t)i * BAND;
    const int32_t y1 = y0 + BAND < h ? y0 + BAND : h;
    const size_t plane = (size_t)w * h;
    float *row = NULL;
    (void)worker;
    tz_status st = tz_alloc(ctx, &row, (size_t)w, 4 * sizeof *row);
    if (st != TZ_OK)
        return st;
    for (int32_t y = y0; y < y1; y++) {
        float *s = row, *d = row + w, *c = d + w, *mixed = c + w;
        memset(row, 0, 3 * (size_t)w * sizeof *row);
        for (int32_t k = 0; k < t->n; k++) {
            const tz_tensor_level *l = &t->level[k];
            const size_t p = (size_t)l->width * l->height;
            const float weight = (float)j->weight[k];
            if (weight == 0)
                continue;
            add_row(l->tensor, l, k, y, w, weight, mixed, s);
            add_row(l->tensor + p, l, k, y, w, weight, mixed, d);
            add_row(l->tensor + 2 * p, l, k, y, w, weight, mixed, c);
        }
        float *r = j->r + (size_t)y * w;
        for (int32_t x = 0; x < w; x++)
            r[x] = sqrtf(0.5f * (s[x] + sqrtf(d[x] * d[x] + c[x] * c[x])));
        if (j->normal) {
            memcpy(j->normal + (size_t)y * w, d, (size_t)w * sizeof *d);
            memcpy(j->normal + plane + (size_t)y * w, c, (size_t)w * sizeof *c);
        }
    }
    tz_free(ctx, row);
    return TZ_OK;
}

tz_status tz_tensor_response(const tz_tensor *t, const double *weight, float *r,
                             float *normal)
{
    tz_tensor_job j = {.t = (tz_tensor *)t, .weight = weight, .r = r, .normal = normal};
    return tz_parallel_for(t->ctx, bands(t->level[0].height), response_band, &j);
}
