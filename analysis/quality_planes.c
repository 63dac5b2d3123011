/* SPDX-License-Identifier: Apache-2.0 */
/* Perceptual planes and pyramids.
 *
 * Opponent channels of the sRGB-encoded colours, L = 0.299 R + 0.587 G + 0.114 B,
 * A = (R - G) / 2, B = (R + G) / 4 - B / 2, all times 100: like L*a*b* in scale and in
 * what they separate, at a tenth of its cost. The pyramid's kernel is the binomial
 * (1 4 6 4 1) / 16 of [Burt and Adelson 1983]. */
#include "analysis/quality_planes.h"

#include <string.h>

#include "base/rng.h"

#define MIN_LEVEL 8

tz_status tz_quality_planes_init(tz_ctx *ctx, tz_quality_planes *p, int32_t w, int32_t h,
                                 int32_t n)
{
    *p = (tz_quality_planes){.w = w, .h = h, .n = n, .ctx = ctx};
    tz_status s = TZ_OK;
    for (int32_t c = 0; c < n && s == TZ_OK; c++)
        s = tz_alloc(ctx, &p->v[c], (size_t)w * (size_t)h, sizeof(float));
    if (s != TZ_OK)
        tz_quality_planes_deinit(p);
    return s;
}

void tz_quality_planes_deinit(tz_quality_planes *p)
{
    for (int c = 0; c < 3; c++)
        tz_free(p->ctx, p->v[c]);
    *p = (tz_quality_planes){0};
}

int32_t tz_quality_colours(const tz_image *im)
{
    int32_t n = im->channels - (im->alpha >= 0);
    return n == 1 ? 1 : n == 3 ? 3 : 0;
}

/* ---- image -> planes ------------------------------------------------------------ */

typedef struct convert_job {
    const tz_image *im;
    tz_rect r;
    int32_t channel[3]; /* of red, green, blue */
    tz_quality_planes *p;
} convert_job;

static float encode(const tz_image *im, float v)
{
    if (!isfinite(v))
        return 0;
    v = v < -0.5f ? -0.5f : v > 16 ? 16 : v;
    if (im->encoding == TZ_ENCODING_LINEAR)
        v = tz_srgb_encode(v);
    return v > 4 ? 4 : v;
}

static tz_status convert_band(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    const convert_job *j = arg;
    tz_quality_planes *p = j->p;
    (void)ctx, (void)worker;
    for (int32_t y = (int32_t)i * TZ_QUALITY_BAND; y < tz_quality_band_end(i, p->h);
         y++) {
        const float *src = tz_image_at(j->im, j->r.x, j->r.y + y);
        float *l = p->v[0] + (size_t)y * p->w;
        for (int32_t x = 0; x < p->w; x++, src += j->im->channels) {
            float r = encode(j->im, src[j->channel[0]]);
            float g = r, b = r;
            if (j->channel[1] != j->channel[0]) {
                g = encode(j->im, src[j->channel[1]]);
                b = encode(j->im, src[j->channel[2]]);
            }
            l[x] = 29.9f * r + 58.7f * g + 11.4f * b;
            if (p->n == 3) {
                p->v[1][(size_t)y * p->w + x] = 50 * (r - g);
                p->v[2][(size_t)y * p->w + x] = 25 * (r + g) - 50 * b;
            }
        }
    }
    return TZ_OK;
}

tz_status tz_quality_planes_from_image(tz_ctx *ctx, tz_quality_planes *p,
                                       const tz_image *im, tz_rect r, int32_t n)
{
    tz_status s = tz_quality_planes_init(ctx, p, r.w, r.h, n);
    if (s != TZ_OK)
        return s;
    convert_job j = {.im = im, .r = r, .p = p};
    int32_t k = 0, colours = tz_quality_colours(im);
    for (int32_t c = 0; c < im->channels && k < colours; c++)
        if (c != im->alpha)
            j.channel[k++] = c;
    for (; k < 3; k++)
        j.channel[k] = j.channel[0];
    return tz_parallel_for(ctx, tz_quality_bands(p->h), convert_band, &j);
}

/* ---- pyramid -------------------------------------------------------------------- */

typedef struct level_job {
    const tz_quality_planes *fine;
    tz_quality_planes *coarse; /* reduce: written; expand: read */
    tz_quality_planes *band;   /* fine - expand(coarse) */
} level_job;

static tz_status reduce_band(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    const level_job *j = arg;
    const tz_quality_planes *f = j->fine, *o = j->coarse;
    float *row;
    (void)worker;
    tz_status s = tz_alloc(ctx, &row, (size_t)f->w + 4, sizeof *row);
    if (s != TZ_OK)
        return s;
    for (int32_t c = 0; c < f->n; c++)
        for (int32_t y = (int32_t)i * TZ_QUALITY_BAND; y < tz_quality_band_end(i, o->h);
             y++) {
            const float *r[5];
            for (int k = 0; k < 5; k++)
                r[k] = f->v[c] + (size_t)tz_quality_clamp(2 * y + k - 2, f->h) * f->w;
            float *t = row + 2;
            for (int32_t x = 0; x < f->w; x++)
                t[x] = r[0][x] + r[4][x] + 4 * (r[1][x] + r[3][x]) + 6 * r[2][x];
            t[-1] = t[-2] = t[0];
            t[f->w] = t[f->w + 1] = t[f->w - 1];
            float *d = o->v[c] + (size_t)y * o->w;
            for (int32_t x = 0; x < o->w; x++, t += 2)
                d[x] = (t[-2] + t[2] + 4 * (t[-1] + t[1]) + 6 * t[0]) * (1.0f / 256);
        }
    tz_free(ctx, row);
    return TZ_OK;
}

static tz_status laplace_band(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    const level_job *j = arg;
    const tz_quality_planes *f = j->fine, *g = j->coarse;
    float *row;
    (void)worker;
    tz_status s = tz_alloc(ctx, &row, (size_t)g->w + 2, sizeof *row);
    if (s != TZ_OK)
        return s;
    for (int32_t c = 0; c < f->n; c++)
        for (int32_t y = (int32_t)i * TZ_QUALITY_BAND; y < tz_quality_band_end(i, f->h);
             y++) {
            const float *a = g->v[c] + (size_t)tz_quality_clamp(y / 2 - 1, g->h) * g->w;
            const float *b = g->v[c] + (size_t)tz_quality_clamp(y / 2, g->h) * g->w;
            const float *d = g->v[c] + (size_t)tz_quality_clamp(y / 2 + 1, g->h) * g->w;
            float *t = row + 1;
            for (int32_t x = 0; x < g->w; x++)
                t[x] = y & 1 ? 0.5f * (b[x] + d[x]) : 0.125f * (a[x] + d[x] + 6 * b[x]);
            t[-1] = t[0];
            t[g->w] = t[g->w - 1];
            const float *src = f->v[c] + (size_t)y * f->w;
            float *out = j->band->v[c] + (size_t)y * f->w;
            for (int32_t x = 0; x < f->w; x++) {
                int32_t h = x / 2;
                out[x] = src[x] - (x & 1 ? 0.5f * (t[h] + t[h + 1])
                                         : 0.125f * (t[h - 1] + t[h + 1] + 6 * t[h]));
            }
        }
    tz_free(ctx, row);
    return TZ_OK;
}

static tz_status build_pyramid(tz_ctx *ctx, tz_quality_pyramid *p)
{
    tz_status s = TZ_OK;
    p->n = 1;
    while (p->n < TZ_QUALITY_LEVELS && s == TZ_OK) {
        const tz_quality_planes *f = &p->gauss[p->n - 1];
        int32_t w = (f->w + 1) / 2, h = (f->h + 1) / 2;
        if (w < MIN_LEVEL || h < MIN_LEVEL)
            break;
        s = tz_quality_planes_init(ctx, &p->gauss[p->n], w, h, f->n);
        level_job j = {.fine = f, .coarse = &p->gauss[p->n]};
        if (s == TZ_OK)
            s = tz_parallel_for(ctx, tz_quality_bands(h), reduce_band, &j);
        p->n++;
    }
    for (int32_t i = 0; i < p->n && s == TZ_OK; i++) {
        const tz_quality_planes *f = &p->gauss[i];
        if (i + 1 == p->n && p->n < TZ_QUALITY_LEVELS)
            break;
        s = tz_quality_planes_init(ctx, &p->laplace[i], f->w, f->h, f->n);
        if (s != TZ_OK)
            break;
        if (i + 1 == p->n) {
            for (int32_t c = 0; c < f->n; c++)
                memcpy(p->laplace[i].v[c], f->v[c], sizeof(float) * (size_t)f->w * f->h);
            break;
        }
        level_job j = {.fine = f, .coarse = &p->gauss[i + 1], .band = &p->laplace[i]};
        s = tz_parallel_for(ctx, tz_quality_bands(f->h), laplace_band, &j);
    }
    return s;
}

/* ---- picture -------------------------------------------------------------------- */

/* Crops of a huge picture lie at seeded places, one in each quarter of its longer side. */
static void choose_crops(tz_quality_picture *p, const tz_image *im, int32_t crops,
                         uint64_t seed)
{
    p->n = 1;
    p->crop[0] = (tz_rect){0, 0, im->width, im->height};
    if ((int64_t)im->width * im->height <= TZ_QUALITY_MAX_AREA)
        return;
    double area = (double)TZ_QUALITY_MAX_AREA / crops, side = floor(sqrt(area));
    int32_t w = im->width, h = im->height;
    if (w >= side && h >= side)
        w = h = (int32_t)side;
    else if (h < side)
        w = (int32_t)(area / h);
    else
        h = (int32_t)(area / w);
    w = w < im->width ? w : im->width;
    h = h < im->height ? h : im->height;
    p->n = crops;
    bool wide = im->width >= im->height;
    for (int32_t i = 0; i < crops; i++) {
        tz_rng r = tz_rng_make(seed, tz_rng_stream('c', (uint64_t)i, 0));
        double along = tz_rng_unit(&r), across = tz_rng_unit(&r);
        double part = crops > 1 ? (i + along) / crops : along;
        p->crop[i] =
            (tz_rect){(int32_t)((wide ? part : across) * (im->width - w)),
                      (int32_t)((wide ? across : part) * (im->height - h)), w, h};
    }
}

tz_status tz_quality_picture_init(tz_ctx *ctx, tz_quality_picture *p, const tz_image *im,
                                  int32_t planes, int32_t crops, uint64_t seed)
{
    tz_status s = TZ_OK;
    *p = (tz_quality_picture){0};
    choose_crops(p, im, crops, seed);
    for (int32_t i = 0; i < p->n && s == TZ_OK; i++) {
        s = tz_quality_planes_from_image(ctx, &p->at[i].gauss[0], im, p->crop[i], planes);
        if (s == TZ_OK)
            s = build_pyramid(ctx, &p->at[i]);
    }
    if (s != TZ_OK)
        tz_quality_picture_deinit(p);
    return s;
}

void tz_quality_picture_deinit(tz_quality_picture *p)
{
    for (int32_t i = 0; i < TZ_QUALITY_CROPS; i++)
        for (int32_t k = 0; k < TZ_QUALITY_LEVELS; k++) {
            tz_quality_planes_deinit(&p->at[i].gauss[k]);
            tz_quality_planes_deinit(&p->at[i].laplace[k]);
        }
    *p = (tz_quality_picture){0};
}

int64_t tz_quality_area(const tz_quality_picture *p)
{
    int64_t area = 0;
    for (int32_t i = 0; i < p->n; i++)
        area += (int64_t)p->crop[i].w * p->crop[i].h;
    return area;
}
