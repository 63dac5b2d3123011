/* SPDX-License-Identifier: Apache-2.0 */
/* Features by which pieces are matched: box means of an opponent colour space, all O(1) a
 * pixel through running sums. Several exemplars are scaled by their pooled deviations, so
 * that pieces of one can be laid against pieces of another. */
#include <string.h>

#include "synthesis/arrange_internal.h"

/* How much each channel counts against the others. */
static const double weight[TZ_FEATURES] = {1.2, 0.7, 0.7, 0.7, 1.2, 0.8, 0.8, 0.8};

typedef struct planes {
    int32_t w, h;
    float *p[TZ_FEATURES];
    float *spare;
} planes;

/* Mean over (2 r + 1)^2 px, borders replicated, in place; two running-sum passes. */
typedef struct box_job {
    float *v, *out;
    int32_t w, h, r;
    bool vertical;
} box_job;

static tz_status box_task(tz_ctx *ctx, void *arg, int64_t index, int worker)
{
    (void)ctx, (void)worker;
    const box_job *b = arg;
    const int32_t w = b->w, h = b->h, r = b->r;
    const float scale = 1.0F / (float)(2 * r + 1);
    if (!b->vertical) {
        for (int64_t y = index * 16; y < index * 16 + 16 && y < h; y++) {
            const float *in = b->v + y * w;
            float *out = b->out + y * w;
            float sum = in[0] * (float)(r + 1);
            for (int32_t k = 1; k <= r; k++)
                sum += in[k < w ? k : w - 1];
            for (int32_t x = 0; x < w; x++) {
                out[x] = sum * scale;
                sum += in[x + r + 1 < w ? x + r + 1 : w - 1] - in[x - r > 0 ? x - r : 0];
            }
        }
        return TZ_OK;
    }
    float sum[64];
    const int32_t x0 = (int32_t)index * 64, n = w - x0 < 64 ? w - x0 : 64;
    const float *in = b->v + x0;
    for (int32_t x = 0; x < n; x++)
        sum[x] = in[x] * (float)(r + 1);
    for (int32_t k = 1; k <= r; k++) {
        const float *row = in + (int64_t)(k < h ? k : h - 1) * w;
        for (int32_t x = 0; x < n; x++)
            sum[x] += row[x];
    }
    for (int32_t y = 0; y < h; y++) {
        const float *add = in + (int64_t)(y + r + 1 < h ? y + r + 1 : h - 1) * w;
        const float *sub = in + (int64_t)(y - r > 0 ? y - r : 0) * w;
        float *out = b->out + (int64_t)y * w + x0;
        for (int32_t x = 0; x < n; x++) {
            out[x] = sum[x] * scale;
            sum[x] += add[x] - sub[x];
        }
    }
    return TZ_OK;
}

static tz_status box(tz_ctx *ctx, const planes *p, const float *in, float *out, int32_t r)
{
    box_job b = {(float *)in, p->spare, p->w, p->h, r, false};
    tz_status s = tz_parallel_for(ctx, (p->h + 15) / 16, box_task, &b);
    b = (box_job){p->spare, out, p->w, p->h, r, true};
    return s == TZ_OK ? tz_parallel_for(ctx, (p->w + 63) / 64, box_task, &b) : s;
}

/* Opponent channels of sRGB-encoded colour; cheap and near enough to L*a*b*. */
static void opponent(const tz_image *im, planes *p)
{
    for (int32_t y = 0; y < p->h; y++)
        for (int32_t x = 0; x < p->w; x++) {
            const float *c = tz_image_at(im, x, y);
            const int64_t i = (int64_t)y * p->w + x;
            if (im->channels >= 3) {
                p->p[TZ_FEATURE_L][i] = 0.3F * c[0] + 0.6F * c[1] + 0.1F * c[2];
                p->p[TZ_FEATURE_A][i] = c[0] - c[1];
                p->p[TZ_FEATURE_B][i] = 0.5F * (c[0] + c[1]) - c[2];
            } else {
                p->p[TZ_FEATURE_L][i] = c[0];
                p->p[TZ_FEATURE_A][i] = p->p[TZ_FEATURE_B][i] = 0;
            }
        }
}

/* Closeness to an edge: 1 on it, falling to 0 over 8 px, by blurring drawn chains. */
static void draw_edges(const tz_ebpt *e, float *out)
{
    static const int8_t dx[8] = {1, 1, 0, -1, -1, -1, 0, 1};
    static const int8_t dy[8] = {0, -1, -1, -1, 0, 1, 1, 1};
    for (int32_t k = 0; k < e->edge.n; k++) {
        const tz_edge *d = &e->edge.v[k];
        int32_t x = d->x, y = d->y;
        for (int32_t i = 0;; i++) {
            if (x >= 0 && y >= 0 && x < e->width && y < e->height)
                out[(int64_t)y * e->width + x] = (float)(0.3 + 0.7 * d->strength);
            if (i >= d->length)
                break;
            const int code = e->code.v[d->code + i] & 7;
            x += dx[code], y += dy[code];
        }
    }
}

static tz_status compute(tz_ctx *ctx, const tz_exemplar *ex, planes *p)
{
    const int64_t n = (int64_t)p->w * p->h;
    float *const *q = p->p;
    tz_status s = TZ_OK;
    opponent(ex->photo, p);
    memset(q[TZ_FEATURE_EDGE], 0, (size_t)n * sizeof(float));
    draw_edges(ex->ebpt, q[TZ_FEATURE_EDGE]);
    for (int32_t y = 0; y < p->h; y++)
        for (int32_t x = 0; x < p->w; x++) {
            const int64_t i = (int64_t)y * p->w + x;
            const float *f = q[TZ_FEATURE_L] + i;
            const float gx = x + 1 < p->w ? f[1] - f[0] : 0;
            const float gy = y + 1 < p->h ? f[p->w] - f[0] : 0;
            q[TZ_FEATURE_BUSY][i] = sqrtf(gx * gx + gy * gy);
            q[TZ_FEATURE_ALONG][i] = gx * gx - gy * gy;
            q[TZ_FEATURE_SLANT][i] = 2 * gx * gy;
        }
    static const struct {
        int in, out, radius;
    } pass[] = {
        {TZ_FEATURE_L, TZ_FEATURE_L, 1},         {TZ_FEATURE_A, TZ_FEATURE_A, 2},
        {TZ_FEATURE_B, TZ_FEATURE_B, 2},         {TZ_FEATURE_BUSY, TZ_FEATURE_BUSY, 4},
        {TZ_FEATURE_L, TZ_FEATURE_LINE, 8},      {TZ_FEATURE_EDGE, TZ_FEATURE_EDGE, 2},
        {TZ_FEATURE_ALONG, TZ_FEATURE_ALONG, 5}, {TZ_FEATURE_SLANT, TZ_FEATURE_SLANT, 5},
    };
    for (size_t k = 0; k < sizeof pass / sizeof pass[0] && s == TZ_OK; k++)
        s = box(ctx, p, q[pass[k].in], q[pass[k].out], pass[k].radius);
    for (int64_t i = 0; i < n; i++) {
        q[TZ_FEATURE_LINE][i] = q[TZ_FEATURE_L][i] - q[TZ_FEATURE_LINE][i];
        const float e = 5 * q[TZ_FEATURE_EDGE][i];
        q[TZ_FEATURE_EDGE][i] = e > 1 ? 1 : e;
        /* by strength: near 0 where gradients are weak or go all ways */
        const float c = q[TZ_FEATURE_ALONG][i], d = q[TZ_FEATURE_SLANT][i];
        const float m = q[TZ_FEATURE_BUSY][i];
        const float scale = 1 / (sqrtf(c * c + d * d) + m * m + 1e-4F);
        q[TZ_FEATURE_ALONG][i] = c * scale;
        q[TZ_FEATURE_SLANT][i] = d * scale;
    }
    return s;
}

tz_status tz_feature_maps_init(tz_ctx *ctx, const tz_exemplar *ex, int32_t n,
                               tz_feature_map *out)
{
    tz_status s = TZ_OK;
    planes *p = NULL;
    double sum[TZ_FEATURES] = {0}, square[TZ_FEATURES] = {0}, count = 0;
    memset(out, 0, (size_t)n * sizeof *out);
    s = tz_alloc_zero(ctx, &p, (size_t)n, sizeof *p);
    for (int32_t k = 0; k < n && s == TZ_OK; k++) {
        p[k].w = ex[k].photo->width, p[k].h = ex[k].photo->height;
        const size_t px = (size_t)p[k].w * (size_t)p[k].h;
        for (int f = 0; f < TZ_FEATURES && s == TZ_OK; f++)
            s = tz_alloc(ctx, &p[k].p[f], px, sizeof(float));
        if (s == TZ_OK)
            s = tz_alloc(ctx, &p[k].spare, px, sizeof(float));
        if (s == TZ_OK)
            s = tz_alloc(ctx, &out[k].v, px, sizeof *out[k].v);
        if (s == TZ_OK)
            s = tz_alloc(ctx, &out[k].half,
                         (size_t)((p[k].w + 1) / 2) * (size_t)((p[k].h + 1) / 2),
                         sizeof *out[k].half);
        if (s == TZ_OK)
            s = compute(ctx, &ex[k], &p[k]);
        if (s != TZ_OK)
            break;
        out[k].width = p[k].w, out[k].height = p[k].h;
        for (int f = 0; f < TZ_FEATURES; f++)
            for (size_t i = 0; i < px; i += 3) {
                const double v = p[k].p[f][i];
                sum[f] += v;
                square[f] += v * v;
            }
        count += (double)((px + 2) / 3);
    }
    if (s != TZ_OK)
        goto done;
    tz_feature_scale scale;
    for (int f = 0; f < TZ_FEATURES; f++) {
        scale.mean[f] = sum[f] / count;
        const double var = square[f] / count - scale.mean[f] * scale.mean[f];
        double deviation = var > 0 ? sqrt(var) : 0;
        if (deviation < 0.01) /* 2.5 steps of 8 bits: noise is not amplified */
            deviation = 0.01;
        scale.gain[f] = 40 * weight[f] / deviation;
    }
    /* turns rotate this pair about the middle of the bytes */
    scale.mean[TZ_FEATURE_ALONG] = scale.mean[TZ_FEATURE_SLANT] = 0;
    const double pair = fmin(scale.gain[TZ_FEATURE_ALONG], scale.gain[TZ_FEATURE_SLANT]);
    scale.gain[TZ_FEATURE_ALONG] = scale.gain[TZ_FEATURE_SLANT] = fmin(pair, 120);
    /* faint colour must not count as much as strong lightness */
    for (int f = TZ_FEATURE_A; f <= TZ_FEATURE_B; f++)
        if (scale.gain[f] > 2.5 * scale.gain[TZ_FEATURE_L])
            scale.gain[f] = 2.5 * scale.gain[TZ_FEATURE_L];
    for (int32_t k = 0; k < n; k++)
        for (int64_t i = 0; i < (int64_t)p[k].w * p[k].h; i++)
            for (int f = 0; f < TZ_FEATURES; f++) {
                const float v =
                    (p[k].p[f][i] - (float)scale.mean[f]) * (float)scale.gain[f] + 128.0F;
                out[k].v[i].v[f] = (uint8_t)(v < 0 ? 0 : v > 255 ? 255 : v);
            }
    for (int32_t k = 0; k < n; k++) {
        const int32_t w = (p[k].w + 1) / 2, h = (p[k].h + 1) / 2;
        out[k].half_width = w, out[k].half_height = h;
        for (int32_t y = 0; y < h; y++)
            for (int32_t x = 0; x < w; x++)
                out[k].half[(int64_t)y * w + x] =
                    tz_feature_at(&out[k], 2 * x + 1, 2 * y + 1);
    }
done:
    for (int32_t k = 0; p && k < n; k++) {
        for (int f = 0; f < TZ_FEATURES; f++)
            tz_free(ctx, p[k].p[f]);
        tz_free(ctx, p[k].spare);
    }
    tz_free(ctx, p);
    if (s != TZ_OK)
        tz_feature_maps_deinit(ctx, out, n);
    return s;
}

void tz_feature_maps_deinit(tz_ctx *ctx, tz_feature_map *map, int32_t n)
{
    for (int32_t k = 0; k < n; k++) {
        tz_free(ctx, map[k].v);
        tz_free(ctx, map[k].half);
    }
    memset(map, 0, (size_t)n * sizeof *map);
}
