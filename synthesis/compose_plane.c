/* SPDX-License-Identifier: Apache-2.0 */
/* Preparing a photo for sampling: texels with a mirrored frame, spline coefficients, range
 * of each channel, means over cells. Bands of rows and of columns in parallel.
 * @source Unser, Aldroubi, Eden: B-spline signal processing, IEEE Trans. SP 41, 1993 */
#include <float.h>
#include <string.h>

#include "synthesis/compose_internal.h"

#define POLE (-0.26794919243112270647) /* sqrt(3) - 2 */

/* In-place recursive filter of n values `stride` floats apart, for `lines` neighbouring
 * lines at once in each of `sets` sets `gap` floats apart (a recursion waits for itself:
 * several of them side by side do not); half-sample mirror at both ends. */
static inline __attribute__((always_inline)) void spline_lines(float *v, int32_t n,
                                                               int64_t stride,
                                                               int32_t lines,
                                                               int32_t sets, int64_t gap)
{
    const float z = (float)POLE, gain = 6.0F;
    if (n < 2)
        return;
    enum { REACH = 16 };
    for (int32_t s = 0; s < sets; s++)
        for (int32_t l = 0; l < lines; l++) {
            /* sum of the mirrored signal before the first sample; |z|^16 < 1e-9 */
            float *p = v + s * gap + l, sum = *p, zk = z;
            for (int32_t k = 0; k < REACH; k++, zk *= z)
                sum += zk * p[(k < n ? k : tz_mirror(k, n)) * stride];
            *p = gain * sum;
        }
    for (int32_t k = 1; k < n; k++)
        for (int32_t s = 0; s < sets; s++) {
            float *p = v + k * stride + s * gap;
            const float *q = p - stride;
            for (int32_t l = 0; l < lines; l++)
                p[l] = gain * p[l] + z * q[l];
        }
    for (int32_t s = 0; s < sets; s++)
        for (int32_t l = 0; l < lines; l++)
            v[(int64_t)(n - 1) * stride + s * gap + l] *= z / (z - 1);
    for (int32_t k = n - 2; k >= 0; k--)
        for (int32_t s = 0; s < sets; s++) {
            float *p = v + k * stride + s * gap;
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

static inline __attribute__((always_inline)) void
compensate_line(float *v, int32_t n, int64_t stride, int32_t lines)
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

/* What the tasks of a plane's preparation share. */
typedef struct plane_job {
    tz_source_plane *s;
    const tz_image *photo;
    bool encode;
    float (*range)[2][TZ_IMAGE_MAX_CHANNELS]; /* one a worker */
    int32_t size[2];                          /* layout-source px */
} plane_job;

enum { BAND = 16, COLUMN = 256 };

static void filter_rows(const tz_source_plane *s, float *v, int32_t rows)
{
    for (int32_t y = 0; y < rows; y++) {
        if (s->step == 4)
            compensate_line(v + y * s->stride, s->width, 4, 4);
        else
            compensate_line(v + y * s->stride, s->width, s->step, s->step);
    }
    int32_t y = 0;
    if (s->step == 4)
        for (; y + 4 <= rows; y += 4)
            spline_lines(v + y * s->stride, s->width, 4, 4, 4, s->stride);
    else if (s->step == 1)
        for (; y + 4 <= rows; y += 4)
            spline_lines(v + y * s->stride, s->width, 1, 1, 4, s->stride);
    for (; y < rows; y++)
        spline_lines(v + y * s->stride, s->width, s->step, s->step, 1, 0);
}

/* A photo's row as texels; widens the range of its channels. */
static void convert_row(const plane_job *job, int32_t y, float *out,
                        float range[2][TZ_IMAGE_MAX_CHANNELS])
{
    const tz_image *photo = job->photo;
    const int32_t channels = photo->channels, step = job->s->step;
    const float *in = tz_image_at(photo, 0, y);
    if (channels == 3 && !job->encode) {
        float lo[3] = {range[0][0], range[0][1], range[0][2]};
        float hi[3] = {range[1][0], range[1][1], range[1][2]};
        for (int32_t x = 0; x < photo->width; x++)
            for (int32_t k = 0; k < 3; k++) {
                const float v = in[3 * (int64_t)x + k];
                out[4 * (int64_t)x + k] = v;
                lo[k] = v < lo[k] ? v : lo[k];
                hi[k] = v > hi[k] ? v : hi[k];
            }
        memcpy(range[0], lo, sizeof lo);
        memcpy(range[1], hi, sizeof hi);
        return;
    }
    for (int32_t k = 0; k < channels; k++) {
        float lo = range[0][k], hi = range[1][k];
        for (int32_t x = 0; x < photo->width; x++) {
            float v = in[(int64_t)x * channels + k];
            if (job->encode && k != photo->alpha)
                v = tz_srgb_encode(v);
            out[(int64_t)x * step + k] = v;
            lo = v < lo ? v : lo;
            hi = v > hi ? v : hi;
        }
        range[0][k] = lo, range[1][k] = hi;
    }
}

static tz_status rows_task(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    (void)ctx;
    const plane_job *job = arg;
    tz_source_plane *s = job->s;
    const int32_t from = (int32_t)i * BAND;
    const int32_t rows = s->height - from < BAND ? s->height - from : BAND;
    const int64_t at = (from + s->pad) * s->stride + (int64_t)s->pad * s->step;
    for (int32_t y = 0; y < rows; y++)
        convert_row(job, from + y, s->texel + at + y * s->stride, job->range[worker]);
    if (s->spline) {
        const size_t bytes = (size_t)s->width * (size_t)s->step * sizeof(float);
        for (int32_t y = 0; y < rows; y++)
            memcpy(s->spline + at + y * s->stride, s->texel + at + y * s->stride, bytes);
        filter_rows(s, s->spline + at, rows);
    }
    return TZ_OK;
}

static tz_status columns_task(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    (void)ctx, (void)worker;
    const plane_job *job = arg;
    const tz_source_plane *s = job->s;
    const int64_t floats = (int64_t)s->width * s->step, from = i * COLUMN;
    float *v = s->spline + s->pad * s->stride + (int64_t)s->pad * s->step + from;
    if (floats - from >= COLUMN) {
        compensate_line(v, s->height, s->stride, COLUMN);
        spline_lines(v, s->height, s->stride, COLUMN, 1, 0);
    } else {
        compensate_line(v, s->height, s->stride, (int32_t)(floats - from));
        spline_lines(v, s->height, s->stride, (int32_t)(floats - from), 1, 0);
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
                   row + (int64_t)(pad + tz_mirror(-k, w)) * step,
                   (size_t)step * sizeof *row);
            memcpy(row + (int64_t)(pad + w - 1 + k) * step,
                   row + (int64_t)(pad + tz_mirror(w - 1 + k, w)) * step,
                   (size_t)step * sizeof *row);
        }
    }
    for (int32_t k = 1; k <= pad; k++) {
        memcpy(t + (int64_t)(pad - k) * s->stride,
               t + (int64_t)(pad + tz_mirror(-k, h)) * s->stride,
               (size_t)s->stride * sizeof *t);
        memcpy(t + (int64_t)(pad + h - 1 + k) * s->stride,
               t + (int64_t)(pad + tz_mirror(h - 1 + k, h)) * s->stride,
               (size_t)s->stride * sizeof *t);
    }
}

/* Row j of the means over cells of `cell` layout-source px. */
static void lowpass_row(const tz_source_plane *s, int level, int32_t j)
{
    const int32_t cell = level ? TZ_FINE : TZ_COARSE, step = s->step, lw = s->lw[level];
    const float *texel = s->texel + s->pad * s->stride + (int64_t)s->pad * step;
    float *out = s->low[level] + ((int64_t)(j + 1) * (lw + 2) + 1) * step;
    int32_t y0 = (int32_t)(j * cell * s->sy), y1 = (int32_t)((j + 1) * cell * s->sy);
    if (y1 > s->height)
        y1 = s->height;
    if (y0 >= y1)
        y0 = y1 > 0 ? y1 - 1 : 0, y1 = y0 + 1;
    for (int32_t i = 0; i < lw; i++, out += step) {
        int32_t x0 = (int32_t)(i * cell * s->sx), x1 = (int32_t)((i + 1) * cell * s->sx);
        if (x1 > s->width)
            x1 = s->width;
        if (x0 >= x1)
            x0 = x1 > 0 ? x1 - 1 : 0, x1 = x0 + 1;
        const float scale = 1.0F / ((float)(x1 - x0) * (float)(y1 - y0));
        if (step == 4) {
            tz_f4 sum = {0};
            for (int32_t y = y0; y < y1; y++)
                for (int32_t x = x0; x < x1; x++)
                    sum += tz_load4(texel + y * s->stride + 4 * (int64_t)x);
            sum *= scale;
            memcpy(out, &sum, sizeof sum);
            continue;
        }
        float sum[TZ_IMAGE_MAX_CHANNELS + 4] = {0};
        for (int32_t y = y0; y < y1; y++) {
            const float *row = texel + y * s->stride;
            for (int32_t x = x0; x < x1; x++)
                for (int32_t k = 0; k < step; k++)
                    sum[k] += row[(int64_t)x * step + k];
        }
        for (int32_t k = 0; k < step; k++)
            out[k] = sum[k] * scale;
    }
    out = s->low[level] + (int64_t)(j + 1) * (lw + 2) * step; /* the frame's columns */
    memcpy(out, out + step, (size_t)step * sizeof *out);
    memcpy(out + (int64_t)(lw + 1) * step, out + (int64_t)lw * step,
           (size_t)step * sizeof *out);
}

static tz_status lowpass_task(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    (void)ctx, (void)worker;
    const plane_job *job = arg;
    const tz_source_plane *s = job->s;
    for (int level = 0; level < 2; level++) { /* the same stretch of the photo in both */
        const int32_t rows = level ? BAND * TZ_COARSE / TZ_FINE : BAND;
        const int64_t from = i * rows;
        for (int64_t j = from; j < from + rows && j < s->lh[level]; j++)
            lowpass_row(s, level, (int32_t)j);
    }
    return TZ_OK;
}

/* Means over cells of both sizes, one cell of replicated frame. */
static tz_status lowpass(tz_ctx *ctx, plane_job *job)
{
    tz_source_plane *s = job->s;
    tz_status st = TZ_OK;
    for (int level = 0; level < 2 && st == TZ_OK; level++) {
        const int32_t cell = level ? TZ_FINE : TZ_COARSE;
        s->lw[level] = (job->size[0] + cell - 1) / cell;
        s->lh[level] = (job->size[1] + cell - 1) / cell;
        st = tz_alloc(ctx, &s->low[level],
                      (size_t)(s->lw[level] + 2) * (size_t)(s->lh[level] + 2) *
                          (size_t)s->step,
                      sizeof(float));
    }
    if (st == TZ_OK)
        st = tz_parallel_for(ctx, (s->lh[0] + BAND - 1) / BAND, lowpass_task, job);
    for (int level = 0; level < 2 && st == TZ_OK; level++) {
        const int64_t row = (int64_t)(s->lw[level] + 2) * s->step, lh = s->lh[level];
        float *low = s->low[level];
        memcpy(low, low + row, (size_t)row * sizeof *low);
        memcpy(low + (lh + 1) * row, low + lh * row, (size_t)row * sizeof *low);
    }
    return st;
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
    const int workers = tz_ctx_threads(ctx);
    plane_job job = {
        s, photo, !data && photo->encoding == TZ_ENCODING_LINEAR, NULL, {width, height}};
    tz_status st = tz_alloc_zero(ctx, &s->texel, floats, sizeof *s->texel);
    if (st == TZ_OK && spline)
        st = tz_alloc(ctx, &s->spline, floats, sizeof *s->spline);
    if (st == TZ_OK)
        st = tz_alloc(ctx, &job.range, (size_t)workers, sizeof *job.range);
    if (st != TZ_OK)
        goto done;
    for (int w = 0; w < workers; w++)
        for (int32_t k = 0; k < TZ_IMAGE_MAX_CHANNELS; k++)
            job.range[w][0][k] = FLT_MAX, job.range[w][1][k] = -FLT_MAX;
    st = tz_parallel_for(ctx, (s->height + BAND - 1) / BAND, rows_task, &job);
    memcpy(s->lo, job.range[0][0], sizeof s->lo);
    memcpy(s->hi, job.range[0][1], sizeof s->hi);
    for (int w = 1; w < workers; w++)
        for (int32_t k = 0; k < s->channels; k++) {
            s->lo[k] = fminf(s->lo[k], job.range[w][0][k]);
            s->hi[k] = fmaxf(s->hi[k], job.range[w][1][k]);
        }
    if (st == TZ_OK) {
        frame(s, s->texel);
        st = lowpass(ctx, &job);
    }
    if (st == TZ_OK && spline) {
        st = tz_parallel_for(ctx, ((int64_t)s->width * s->step + COLUMN - 1) / COLUMN,
                             columns_task, &job);
        if (st == TZ_OK)
            frame(s, s->spline);
    }
done:
    tz_free(ctx, job.range);
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
