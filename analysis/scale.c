/* SPDX-License-Identifier: Apache-2.0 */
/* Two witnesses:
 *
 * 1. Autocorrelation of the boundary response, averaged over directions: things that lie
 *    side by side at a typical distance D raise a bump at lag D after a dip at D/2
 *
 *        1 |\
 *          | \         __
 *          |  \       /  \__      D: the highest rise over the dip before it
 *        0 |___\__   /______________
 *                 \_/  D
 *
 * 2. If there is no bump: the level of the pyramid where the boundary response is
 * strongest (its derivatives are normalised, so that levels compare). Things are about
 * six times as wide as its Gaussian (measured over photos of walls, pebbles and gravel).
 *
 * Both are held between 1/24 and 1/6 of the side. */
#include "analysis/scale.h"

#include <math.h>

#include "analysis/filter_cv.h"

#define BAND       16
#define LEAST_RISE 0.015
#define LARGEST    300 /* side of the level that is correlated, px */

/* ---- witnesses ------------------------------------------------------------------- */

static double tensor_at(const tz_tensor_level *l, size_t i)
{
    const size_t n = (size_t)l->width * l->height;
    const double s = l->tensor[i], d = l->tensor[n + i], c = l->tensor[2 * n + i];
    return sqrt(0.5 * (s + sqrt(d * d + c * c)));
}

/* Mean of the correlation over all lags of length about q, q = 0 .. reach, in shares of
 * lag 0; corrected for the shrinking overlap. */
static void radial_mean(const float *ac, const tz_tensor_level *l, int32_t mx, int32_t my,
                        int32_t reach, double *mean, double *count)
{
    for (int32_t q = 0; q <= reach; q++)
        mean[q] = count[q] = 0;
    for (int32_t y = -my; y <= my; y++) {
        for (int32_t x = 0; x <= mx; x++) {
            const int32_t q = (int32_t)(sqrt((double)x * x + (double)y * y) + 0.5);
            if (q > reach)
                continue;
            const double overlap =
                (double)(l->width - x) * (l->height - (y < 0 ? -y : y));
            mean[q] += ac[(size_t)(y + my) * (mx + 1) + x] / overlap;
            count[q]++;
        }
    }
    for (int32_t q = 0; q <= reach; q++)
        mean[q] /= count[q];
    const double zero = mean[0];
    for (int32_t q = 0; q <= reach; q++)
        mean[q] /= zero;
}

/* Lag of the bump, or 0. */
static int32_t find_bump(const double *mean, int32_t reach)
{
    int32_t dip = 0, bump = 0;
    double best = LEAST_RISE, low = 1;
    for (int32_t q = 1; q < reach; q++) {
        const double v = 0.25 * (mean[q - 1] + 2 * mean[q] + mean[q + 1]);
        if (v < low)
            low = v, dip = q;
        else if (v > 0.01 && v - low > (bump ? 1.3 : 1.0) * best)
            best = v - low, bump = q;
    }
    (void)dip;
    return bump;
}

static tz_status correlation_scale(const tz_tensor *t, double *scale)
{
    int32_t k = 0;
    while (k + 1 < t->n && (t->level[k].width > LARGEST || t->level[k].height > LARGEST))
        k++;
    const tz_tensor_level *l = &t->level[k];
    const int32_t side = l->width < l->height ? l->width : l->height;
    const int32_t longer = l->width > l->height ? l->width : l->height;
    const int32_t reach = longer / 5 < side / 2 ? longer / 5 : side / 2;
    const size_t n = (size_t)l->width * l->height;
    float *r = NULL, *ac = NULL;
    double *mean = NULL, sum = 0, power = 0;
    tz_status s = TZ_OK;

    *scale = 0;
    if (side < 32 || longer > 4 * LARGEST)
        goto done;
    if ((s = tz_alloc(t->ctx, &r, n, sizeof *r)) != TZ_OK)
        goto done;
    if ((s = tz_alloc(t->ctx, &ac, (size_t)(2 * reach + 1) * (reach + 1), sizeof *ac)) !=
        TZ_OK)
        goto done;
    if ((s = tz_alloc(t->ctx, &mean, (size_t)reach + 1, 2 * sizeof *mean)) != TZ_OK)
        goto done;
    for (size_t i = 0; i < n; i++)
        sum += r[i] = (float)tensor_at(l, i);
    for (size_t i = 0; i < n; i++) {
        r[i] -= (float)(sum / (double)n);
        power += (double)r[i] * r[i];
    }
    if (power < 1e-3 * (double)n)
        goto done;
    s = tz_cv_autocorrelation(t->ctx, r, l->width, l->height, reach, reach, ac);
    if (s != TZ_OK)
        goto done;
    radial_mean(ac, l, reach, reach, reach, mean, mean + reach + 1);
    *scale = (double)find_bump(mean, reach) * (1 << k);
done:
    tz_free(t->ctx, r);
    tz_free(t->ctx, ac);
    tz_free(t->ctx, mean);
    return s;
}

static double energy_scale(const tz_tensor *t)
{
    int32_t k = 0;
    for (int32_t i = 1; i < t->n; i++)
        if (t->level[i].energy > t->level[k].energy)
            k = i;
    double shift = 0;
    if (k > 0 && k + 1 < t->n && t->level[k - 1].energy > 0 &&
        t->level[k + 1].energy > 0) {
        const double a = log(t->level[k - 1].energy), b = log(t->level[k].energy);
        const double c = log(t->level[k + 1].energy);
        if (a - 2 * b + c < 0)
            shift = 0.5 * (a - c) / (a - 2 * b + c);
    }
    return 6 * TZ_TENSOR_SIGMA * exp2(k + shift);
}

tz_status tz_scale_find(const tz_tensor *t, const tz_ebpt_params *p, double *scale)
{
    const double w = t->level[0].width, h = t->level[0].height;
    const double side = fmin(fmax(w, h), 4 * fmin(w, h));
    tz_status s = TZ_OK;
    if (p->groups > 0) {
        *scale = sqrt(w * h / p->groups);
    } else if (t->level[0].energy < 0.1) { /* nothing to see */
        *scale = side / 12;
    } else {
        if ((s = correlation_scale(t, scale)) != TZ_OK)
            return s;
        if (*scale <= 0)
            *scale = energy_scale(t);
        *scale = fmax(side / 24, fmin(side / 6, *scale));
    }
    *scale = fmax(*scale, p->groups > 0 ? 2 : 16);
    return s;
}

/* ---- response for borders -------------------------------------------------------- */

typedef struct balance_job {
    float *response;
    int32_t width, height, block, bw, bh;
    float *mean; /* a block's mean, bw * bh */
    double overall;
} balance_job;

static tz_status block_row(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    balance_job *j = arg;
    const int32_t y0 = (int32_t)i * j->block;
    const int32_t y1 = y0 + j->block < j->height ? y0 + j->block : j->height;
    float *m = j->mean + i * j->bw;
    (void)ctx, (void)worker;
    for (int32_t b = 0; b < j->bw; b++) {
        const int32_t x0 = b * j->block;
        const int32_t x1 = x0 + j->block < j->width ? x0 + j->block : j->width;
        float sum = 0;
        for (int32_t y = y0; y < y1; y++)
            for (int32_t x = x0; x < x1; x++)
                sum += j->response[(int64_t)y * j->width + x];
        m[b] = sum / (float)((x1 - x0) * (y1 - y0));
    }
    return TZ_OK;
}

/* r *= overall / (mean of overall and the mean around), in bands of blocks. */
static tz_status balance_row(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    balance_job *j = arg;
    const int32_t y0 = (int32_t)i * j->block;
    const int32_t y1 = y0 + j->block < j->height ? y0 + j->block : j->height;
    (void)ctx, (void)worker;
    for (int32_t y = y0; y < y1; y++) {
        const float v = fmaxf(0, ((float)y + 0.5f) / (float)j->block - 0.5f);
        const int32_t r0 = (int32_t)v, r1 = r0 + 1 < j->bh ? r0 + 1 : r0;
        const float fy = v - (float)r0, *a = j->mean + (int64_t)r0 * j->bw;
        const float *b = j->mean + (int64_t)r1 * j->bw;
        float *r = j->response + (int64_t)y * j->width;
        for (int32_t x = 0; x < j->width; x++) {
            const float u = fmaxf(0, ((float)x + 0.5f) / (float)j->block - 0.5f);
            const int32_t c0 = (int32_t)u, c1 = c0 + 1 < j->bw ? c0 + 1 : c0;
            const float fx = u - (float)c0;
            const float top = a[c0] + fx * (a[c1] - a[c0]);
            const float bottom = b[c0] + fx * (b[c1] - b[c0]);
            const float around = top + fy * (bottom - top);
            r[x] *= (float)j->overall / (0.5f * (around + (float)j->overall));
        }
    }
    return TZ_OK;
}

/* Two box means of radius r along rows, then along columns: close to a Gaussian. */
static void smooth_blocks(const balance_job *j, int32_t r, float *line)
{
    for (int32_t pass = 0; pass < 4; pass++) {
        const bool rows = pass < 2;
        const int32_t n = rows ? j->bw : j->bh, lines = rows ? j->bh : j->bw;
        const int64_t step = rows ? 1 : j->bw, next = rows ? j->bw : 1;
        for (int32_t k = 0; k < lines; k++) {
            float *m = j->mean + k * next;
            for (int32_t i = 0; i < n; i++) {
                const int32_t i0 = i > r ? i - r : 0, i1 = i + r < n ? i + r : n - 1;
                float sum = 0;
                for (int32_t q = i0; q <= i1; q++)
                    sum += m[q * step];
                line[i] = sum / (float)(i1 - i0 + 1);
            }
            for (int32_t i = 0; i < n; i++)
                m[i * step] = line[i];
        }
    }
}

tz_status tz_scale_balance(tz_ctx *ctx, float *response, int32_t width, int32_t height,
                           double scale)
{
    balance_job j = {.response = response, .width = width, .height = height};
    float *line = NULL;
    tz_status s;

    j.block = (int32_t)fmax(4, scale / 8);
    j.bw = (width + j.block - 1) / j.block;
    j.bh = (height + j.block - 1) / j.block;
    const size_t n = (size_t)j.bw * j.bh;
    if ((s = tz_alloc(ctx, &j.mean, n, sizeof *j.mean)) != TZ_OK)
        goto done;
    if ((s = tz_alloc(ctx, &line, (size_t)(j.bw > j.bh ? j.bw : j.bh), sizeof *line)) !=
        TZ_OK)
        goto done;
    if ((s = tz_parallel_for(ctx, j.bh, block_row, &j)) != TZ_OK)
        goto done;
    for (size_t i = 0; i < n; i++)
        j.overall += j.mean[i];
    j.overall /= (double)n;
    if (j.overall <= 0)
        goto done;
    smooth_blocks(&j, 6, line);
    s = tz_parallel_for(ctx, j.bh, balance_row, &j);
done:
    tz_free(ctx, j.mean);
    tz_free(ctx, line);
    return s;
}

void tz_scale_weights(double scale, double weight[])
{
    const double centre = log2(fmax(scale / 18 / TZ_TENSOR_SIGMA, 1));
    for (int32_t k = 0; k < TZ_TENSOR_LEVELS; k++) {
        const double d = k - centre;
        weight[k] = exp(-0.5 * d * d);
    }
}

double tz_scale_full(const float *response, int64_t n)
{
    int64_t count[1024] = {0}, below = 0;
    float top = 0;
    for (int64_t i = 0; i < n; i++)
        top = response[i] > top ? response[i] : top;
    if (!(top > 0))
        return 0;
    const float scale = 1023 / top;
    for (int64_t i = 0; i < n; i++)
        count[(int32_t)(response[i] * scale)]++;
    for (int32_t k = 0; k < 1024; k++) {
        below += count[k];
        if (below >= n - n / 10)
            return (k + 1) * (double)top / 1023;
    }
    return top;
}
