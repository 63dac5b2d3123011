/* SPDX-License-Identifier: Apache-2.0 */
/* Sampling of sources.
 *
 * Turned or scaled pieces are resampled with the interpolating cubic B-spline: the photo is
 * turned once into spline coefficients (two recursive passes), after which four taps an
 * axis interpolate exactly at pixel centres and keep the highest frequencies better than
 * any direct kernel of that width (what keeps the sharpness of the result at the photo's).
 * Pieces moved by whole pixels copy texels.
 * @source Unser, Aldroubi, Eden: B-spline signal processing, IEEE Trans. SP 41, 1993 */
#include <float.h>
#include <string.h>

#include "synthesis/compose_internal.h"

#define POLE (-0.26794919243112270647) /* sqrt(3) - 2 */

static int32_t mirror(int64_t i, int32_t n)
{
    if (n == 1)
        return 0;
    const int64_t period = 2 * (int64_t)n;
    i %= period;
    if (i < 0)
        i += period;
    return (int32_t)(i < n ? i : period - 1 - i);
}

/* In-place recursive filter of n values `stride` floats apart, for `lanes` neighbouring
 * lines at once; half-sample mirror at both ends. */
static void spline_line(float *v, int32_t n, int64_t stride, int32_t lines)
{
    const float z = (float)POLE, gain = 6.0F;
    if (n < 2)
        return;
    enum { REACH = 16 };
    for (int32_t l = 0; l < lines; l++) {
        /* sum of the mirrored signal before the first sample; |z|^16 < 1e-9 */
        float sum = v[l], zk = z;
        for (int32_t k = 0; k < REACH; k++, zk *= z)
            sum += zk * v[l + (k < n ? k : mirror(k, n)) * stride];
        v[l] = gain * sum;
    }
    for (int32_t k = 1; k < n; k++) {
        float *p = v + k * stride;
        const float *q = p - stride;
        for (int32_t l = 0; l < lines; l++)
            p[l] = gain * p[l] + z * q[l];
    }
    float *last = v + (int64_t)(n - 1) * stride;
    for (int32_t l = 0; l < lines; l++)
        last[l] = z / (z - 1) * last[l];
    for (int32_t k = n - 2; k >= 0; k--) {
        float *p = v + k * stride;
        const float *q = p + stride;
        for (int32_t l = 0; l < lines; l++)
            p[l] = z * (q[l] - p[l]);
    }
}

/* Interpolating between pixels loses some of the finest contrast (most half-way between
 * them, none on them). Over all phases the loss is made good beforehand: each line v
 * becomes v + GAIN (v - (v[-1] + 2 v + v[1]) / 4), so that a resampled photo has on average
 * the photo's own energy in its finest octaves. */
#define GAIN 0.1F

static void compensate_line(float *v, int32_t n, int64_t stride, int32_t lines)
{
    float before[256];
    for (int32_t l = 0; l < lines; l++)
        before[l] = v[l];
    for (int32_t k = 0; k < n; k++) {
        float *p = v + k * stride;
        const float *next = k + 1 < n ? p + stride : p;
        for (int32_t l = 0; l < lines; l++) {
            const float here = p[l];
            p[l] = here + GAIN * 0.25F * (2 * here - before[l] - next[l]);
            before[l] = here;
        }
    }
}

typedef struct spline_job {
    tz_source_plane *s;
    bool vertical;
} spline_job;

static tz_status spline_task(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    (void)ctx, (void)worker;
    const spline_job *job = arg;
    tz_source_plane *s = job->s;
    float *origin = s->spline + s->pad * s->stride + (int64_t)s->pad * s->step;
    if (job->vertical) {
        const int64_t floats = (int64_t)s->width * s->step;
        const int64_t from = i * 256, n = floats - from < 256 ? floats - from : 256;
        compensate_line(origin + from, s->height, s->stride, (int32_t)n);
        spline_line(origin + from, s->height, s->stride, (int32_t)n);
    } else {
        for (int64_t y = i * 16; y < i * 16 + 16 && y < s->height; y++) {
            compensate_line(origin + y * s->stride, s->width, s->step, s->step);
            spline_line(origin + y * s->stride, s->width, s->step, s->step);
        }
    }
    return TZ_OK;
}

/* Copies the mirrored frame around the inner texels. */
static void frame(tz_source_plane *s, float *t)
{
    const int32_t pad = s->pad, w = s->width, h = s->height, step = s->step;
    for (int32_t y = 0; y < h; y++) {
        float *row = t + (int64_t)(y + pad) * s->stride;
        for (int32_t k = 1; k <= pad; k++) {
            memcpy(row + (int64_t)(pad - k) * step,
                   row + (int64_t)(pad + mirror(-k, w)) * step,
                   (size_t)step * sizeof *row);
            memcpy(row + (int64_t)(pad + w - 1 + k) * step,
                   row + (int64_t)(pad + mirror(w - 1 + k, w)) * step,
                   (size_t)step * sizeof *row);
        }
    }
    for (int32_t k = 1; k <= pad; k++) {
        memcpy(t + (int64_t)(pad - k) * s->stride,
               t + (int64_t)(pad + mirror(-k, h)) * s->stride,
               (size_t)s->stride * sizeof *t);
        memcpy(t + (int64_t)(pad + h - 1 + k) * s->stride,
               t + (int64_t)(pad + mirror(h - 1 + k, h)) * s->stride,
               (size_t)s->stride * sizeof *t);
    }
}

/* Means over cells of `cell` layout-source px, one cell of replicated frame. */
static tz_status lowpass(tz_ctx *ctx, tz_source_plane *s, int level, int32_t cell,
                         int32_t width, int32_t height)
{
    const int32_t lw = (width + cell - 1) / cell, lh = (height + cell - 1) / cell;
    const int32_t step = s->step;
    float *low;
    tz_status st =
        tz_alloc(ctx, &low, (size_t)(lw + 2) * (size_t)(lh + 2) * step, sizeof *low);
    if (st != TZ_OK)
        return st;
    s->low[level] = low, s->lw[level] = lw, s->lh[level] = lh;
    const float *texel = s->texel + s->pad * s->stride + (int64_t)s->pad * step;
    for (int32_t j = 0; j < lh; j++)
        for (int32_t i = 0; i < lw; i++) {
            int32_t x0 = (int32_t)(i * cell * s->sx),
                    x1 = (int32_t)((i + 1) * cell * s->sx);
            int32_t y0 = (int32_t)(j * cell * s->sy),
                    y1 = (int32_t)((j + 1) * cell * s->sy);
            if (x1 > s->width)
                x1 = s->width;
            if (y1 > s->height)
                y1 = s->height;
            if (x0 >= x1)
                x0 = x1 > 0 ? x1 - 1 : 0, x1 = x0 + 1;
            if (y0 >= y1)
                y0 = y1 > 0 ? y1 - 1 : 0, y1 = y0 + 1;
            float sum[TZ_IMAGE_MAX_CHANNELS + 4] = {0};
            for (int32_t y = y0; y < y1; y++) {
                const float *row = texel + y * s->stride;
                for (int32_t x = x0; x < x1; x++)
                    for (int32_t k = 0; k < step; k++)
                        sum[k] += row[(int64_t)x * step + k];
            }
            const float scale = 1.0F / ((float)(x1 - x0) * (float)(y1 - y0));
            float *out = low + ((int64_t)(j + 1) * (lw + 2) + i + 1) * step;
            for (int32_t k = 0; k < step; k++)
                out[k] = sum[k] * scale;
        }
    const int64_t row = (int64_t)(lw + 2) * step;
    for (int32_t j = 1; j <= lh; j++) {
        memcpy(low + j * row, low + j * row + step, (size_t)step * sizeof *low);
        memcpy(low + j * row + (int64_t)(lw + 1) * step,
               low + j * row + (int64_t)lw * step, (size_t)step * sizeof *low);
    }
    memcpy(low, low + row, (size_t)row * sizeof *low);
    memcpy(low + (lh + 1) * row, low + lh * row, (size_t)row * sizeof *low);
    return TZ_OK;
}

tz_status tz_source_plane_init(tz_ctx *ctx, tz_source_plane *s, const tz_image *photo,
                               int32_t width, int32_t height, bool data, bool spline)
{
    memset(s, 0, sizeof *s);
    s->width = photo->width, s->height = photo->height, s->pad = TZ_SOURCE_PAD;
    s->channels = photo->channels;
    s->lanes = s->channels == 1 ? 0 : (s->channels + 3) / 4;
    s->step = s->lanes ? 4 * s->lanes : 1;
#if defined(__x86_64__)
    s->wide = __builtin_cpu_supports("avx2");
#endif
    s->stride = (int64_t)(s->width + 2 * s->pad) * s->step;
    s->sx = (double)s->width / width, s->sy = (double)s->height / height;
    const size_t floats = (size_t)s->stride * (size_t)(s->height + 2 * s->pad);
    tz_status st = tz_alloc_zero(ctx, &s->texel, floats, sizeof *s->texel);
    if (st != TZ_OK)
        goto done;
    tz_image copy = {0}; /* encoded rows, one at a time */
    (void)copy;
    const bool encode = !data && photo->encoding == TZ_ENCODING_LINEAR;
    for (int32_t k = 0; k < s->channels; k++)
        s->lo[k] = FLT_MAX, s->hi[k] = -FLT_MAX;
    for (int32_t y = 0; y < s->height; y++) {
        const float *in = tz_image_at(photo, 0, y);
        float *out =
            s->texel + (int64_t)(y + s->pad) * s->stride + (int64_t)s->pad * s->step;
        for (int32_t x = 0; x < s->width; x++)
            for (int32_t k = 0; k < s->channels; k++) {
                float v = in[(int64_t)x * s->channels + k];
                if (encode && k != photo->alpha)
                    v = tz_srgb_encode(v);
                out[(int64_t)x * s->step + k] = v;
                s->lo[k] = v < s->lo[k] ? v : s->lo[k];
                s->hi[k] = v > s->hi[k] ? v : s->hi[k];
            }
    }
    frame(s, s->texel);
    st = lowpass(ctx, s, 0, TZ_COARSE, width, height);
    if (st == TZ_OK)
        st = lowpass(ctx, s, 1, TZ_FINE, width, height);
    if (st == TZ_OK && spline) {
        st = tz_alloc(ctx, &s->spline, floats, sizeof *s->spline);
        if (st != TZ_OK)
            goto done;
        memcpy(s->spline, s->texel, floats * sizeof *s->spline);
        spline_job job = {s, false};
        st = tz_parallel_for(ctx, (s->height + 15) / 16, spline_task, &job);
        job.vertical = true;
        if (st == TZ_OK)
            st = tz_parallel_for(ctx, ((int64_t)s->width * s->step + 255) / 256,
                                 spline_task, &job);
        if (st == TZ_OK)
            frame(s, s->spline);
    }
done:
    if (st != TZ_OK)
        tz_source_plane_deinit(ctx, s);
    return st;
}

void tz_source_plane_deinit(tz_ctx *ctx, tz_source_plane *s)
{
    tz_free(ctx, s->texel);
    tz_free(ctx, s->spline);
    tz_free(ctx, s->low[0]);
    tz_free(ctx, s->low[1]);
    memset(s, 0, sizeof *s);
}

void tz_source_low(const tz_source_plane *s, int level, double px, double py, float *out)
{
    const double inv = 1.0 / (level ? TZ_FINE : TZ_COARSE);
    const int32_t lw = s->lw[level], lh = s->lh[level], step = s->step;
    double u = px * inv + 0.5, v = py * inv + 0.5; /* cell centres at 1, 2, ... */
    u = u < 0 ? 0 : u > lw + 1 ? lw + 1 : u;
    v = v < 0 ? 0 : v > lh + 1 ? lh + 1 : v;
    int32_t i = (int32_t)u, j = (int32_t)v;
    i = i > lw ? lw : i;
    j = j > lh ? lh : j;
    const float fu = (float)(u - i), fv = (float)(v - j);
    const float *p = s->low[level] + ((int64_t)j * (lw + 2) + i) * step;
    const float *q = p + (int64_t)(lw + 2) * step;
    for (int32_t k = 0; k < step; k++) {
        const float a = p[k] + fu * (p[k + step] - p[k]);
        const float b = q[k] + fu * (q[k + step] - q[k]);
        out[k] = a + fv * (b - a);
    }
}

static inline tz_f4 load4(const float *p)
{
    tz_f4 v;
    memcpy(&v, p, sizeof v);
    return v;
}

/* Texel indices and fractions of a source point; far-out points are mirrored back. */
static inline void locate(double u, int32_t n, int32_t *i, float *f)
{
    const double t = u - 0.5;
    if (t < -1.5 || t > n + 0.5) { /* beyond the frame */
        double m = fmod(u, 2.0 * n);
        if (m < 0)
            m += 2.0 * n;
        if (m > n)
            m = 2.0 * n - m;
        const double back = m - 0.5;
        const double fl = floor(back);
        *i = (int32_t)fl;
        *f = (float)(back - fl);
        return;
    }
    const int32_t fl = (int32_t)(t + 8) - 8; /* floor for t > -8 */
    *i = fl;
    *f = (float)(t - fl);
}

/* Map of a row: source position of pixel k is (ax (x + k + 0.5) + bx, ...). */
typedef struct row_map {
    double ax, bx, ay, by;
    int64_t x;
    const float *origin;
} row_map;

/* Taps of a run of pixels, array by array, so that the loops over them vectorise. */
enum { RUN = 32 };

typedef struct taps {
    int32_t i[2][RUN];  /* first texel across and down */
    float w[2][4][RUN]; /* cubic B-spline weights */
} taps;

static inline __attribute__((always_inline)) void
find_taps(const tz_source_plane *s, const row_map *m, int64_t x, int32_t n, taps *t)
{
    for (int axis = 0; axis < 2; axis++) {
        const double a = axis ? m->ay : m->ax, b = axis ? m->by : m->bx;
        const int32_t side = axis ? s->height : s->width;
        const double u0 = a * ((double)x + 0.5) + b, u1 = a * ((double)(x + n) - 0.5) + b;
        float f[RUN];
        if (u0 > -1 && u1 > -1 && u0 < side + 1 && u1 < side + 1) {
            for (int32_t k = 0; k < n; k++) {
                const double p = a * ((double)x + k + 0.5) + b - 0.5;
                const int32_t fl = (int32_t)(p + 8) - 8; /* floor for p > -8 */
                t->i[axis][k] = fl - 1;
                f[k] = (float)(p - fl);
            }
        } else {
            for (int32_t k = 0; k < n; k++) {
                locate(a * ((double)x + k + 0.5) + b, side, &t->i[axis][k], &f[k]);
                t->i[axis][k]--;
            }
        }
        for (int32_t k = 0; k < n; k++) {
            const float g = 1 - f[k], sixth = 1.0F / 6, f2 = f[k] * f[k], g2 = g * g;
            t->w[axis][0][k] = sixth * g2 * g;
            t->w[axis][1][k] = 2.0F / 3 - 0.5F * f2 * (2 - f[k]);
            t->w[axis][2][k] = 2.0F / 3 - 0.5F * g2 * (2 - g);
            t->w[axis][3][k] = sixth * f2 * f[k];
        }
    }
}

/* Two texels of four channels at a time. The same text is compiled for plain and for
 * 256-bit registers; sums have one order, so that both give the same bits. */
typedef float tz_f8 __attribute__((vector_size(32)));

static inline __attribute__((always_inline)) void
spline_row_body(const tz_source_plane *s, const row_map *m, int32_t n, float *out)
{
    const int32_t step = s->step;
    taps t;
    for (int32_t from = 0; from < n; from += RUN) {
        const int32_t run = n - from < RUN ? n - from : RUN;
        find_taps(s, m, m->x + from, run, &t);
        for (int32_t i = 0; i < run; i++) {
            const float *p =
                m->origin + t.i[1][i] * s->stride + (int64_t)t.i[0][i] * step;
            const float w0 = t.w[0][0][i], w1 = t.w[0][1][i], w2 = t.w[0][2][i],
                        w3 = t.w[0][3][i];
            if (step == 1) {
                const tz_f4 wx = {w0, w1, w2, w3};
                tz_f4 sum = {0};
                for (int r = 0; r < 4; r++)
                    sum += t.w[1][r][i] * load4(p + r * s->stride);
                sum *= wx;
                out[from + i] = (sum[0] + sum[1]) + (sum[2] + sum[3]);
                continue;
            }
            const tz_f8 near = {w0, w0, w0, w0, w1, w1, w1, w1};
            const tz_f8 far = {w2, w2, w2, w2, w3, w3, w3, w3};
            for (int32_t k = 0; k < step; k += 4) {
                tz_f8 acc = {0};
                const float *q = p + k;
                for (int r = 0; r < 4; r++, q += s->stride) {
                    tz_f8 a, b;
                    if (step == 4) {
                        memcpy(&a, q, sizeof a);
                        memcpy(&b, q + 8, sizeof b);
                    } else {
                        memcpy(&a, q, 16), memcpy((char *)&a + 16, q + step, 16);
                        memcpy(&b, q + 2 * step, 16),
                            memcpy((char *)&b + 16, q + 3 * step, 16);
                    }
                    acc += t.w[1][r][i] * (a * near + b * far);
                }
                float half[8];
                memcpy(half, &acc, sizeof half);
                for (int c = 0; c < 4; c++)
                    out[(int64_t)(from + i) * step + k + c] = half[c] + half[c + 4];
            }
        }
    }
}

static void spline_row_plain(const tz_source_plane *s, const row_map *m, int32_t n,
                             float *out)
{
    spline_row_body(s, m, n, out);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) static void
spline_row_avx2(const tz_source_plane *s, const row_map *m, int32_t n, float *out)
{
    spline_row_body(s, m, n, out);
}
#endif

void tz_source_row(const tz_source_plane *s, tz_affine inv, bool exact, int64_t x,
                   int64_t y, int32_t n, float *out)
{
    const int32_t step = s->step;
    const double cy = (double)y + 0.5;
    const double bx = (inv.c * cy + inv.e) * s->sx, ax = inv.a * s->sx;
    const double by = (inv.d * cy + inv.f) * s->sy, ay = inv.b * s->sy;
    const bool copy = exact && s->sx == 1 && s->sy == 1;
    const float *origin =
        (copy ? s->texel : s->spline) + s->pad * s->stride + (int64_t)s->pad * step;
    if (copy) {
        const int64_t sx = (int64_t)floor(((double)x + 0.5) * inv.a + bx);
        const int64_t sy = (int64_t)floor(((double)x + 0.5) * inv.b + by);
        if (sy >= 0 && sy < s->height && sx >= 0 && sx + n <= s->width) {
            memcpy(out, origin + sy * s->stride + sx * step,
                   (size_t)n * (size_t)step * sizeof *out);
            return;
        }
        const float *row = origin + mirror(sy, s->height) * s->stride;
        for (int32_t i = 0; i < n; i++)
            memcpy(out + (int64_t)i * step,
                   row + (int64_t)mirror(sx + i, s->width) * step,
                   (size_t)step * sizeof *out);
        return;
    }
    const row_map m = {ax, bx, ay, by, x, origin};
#if defined(__x86_64__)
    if (s->wide) {
        spline_row_avx2(s, &m, n, out);
        return;
    }
#endif
    spline_row_plain(s, &m, n, out);
}
