/* SPDX-License-Identifier: Apache-2.0 */
/* Sharpness: energy of the two finest levels of the lightness' Laplacian pyramid, output
 * over exemplar, geometric mean of both levels.
 *
 * A photo is seldom equally sharp or rough all over, and an output may hold more of the
 * one part than of the other. sharpness_range is how far the exemplar's own halves go from
 * its whole (a factor, 1.1 at least, MOST at most): the score forgives that much. */
#include <math.h>

#include "analysis/quality_measures.h"

#define LEAST 1.1
#define MOST  1.35
#define FLOOR 1e-3 /* energy of no account */

typedef struct energy_job {
    const tz_quality_planes *p;
    double (*band)[2]; /* sum of squares a band of rows: left and right half */
} energy_job;

static double row_energy(const float *v, int32_t n)
{
    float part[8] = {0};
    double sum = 0;
    int32_t x = 0;
    for (; x + 8 <= n; x += 8)
        for (int k = 0; k < 8; k++)
            part[k] += v[x + k] * v[x + k];
    for (; x < n; x++)
        part[0] += v[x] * v[x];
    for (int k = 0; k < 8; k++)
        sum += (double)part[k];
    return sum;
}

static tz_status energy_band(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    const energy_job *j = arg;
    int32_t w = j->p->w, half = w / 2;
    (void)ctx, (void)worker;
    for (int32_t y = (int32_t)i * TZ_QUALITY_BAND; y < tz_quality_band_end(i, j->p->h);
         y++) {
        const float *v = j->p->v[0] + (size_t)y * w;
        j->band[i][0] += row_energy(v, half);
        j->band[i][1] += row_energy(v + half, w - half);
    }
    return TZ_OK;
}

/* Mean square of a level over all crops: whole, left, right, top, bottom. */
static tz_status level_energy(tz_ctx *ctx, const tz_quality_picture *p, int32_t level,
                              double mean[5])
{
    tz_status s = TZ_OK;
    double sum[5] = {0}, area[5] = {0};
    for (int32_t i = 0; i < p->n && s == TZ_OK; i++) {
        energy_job j = {.p = &p->at[i].laplace[level]};
        int64_t n = tz_quality_bands(j.p->h);
        s = tz_alloc_zero(ctx, &j.band, (size_t)n, sizeof *j.band);
        if (s == TZ_OK)
            s = tz_parallel_for(ctx, n, energy_band, &j);
        for (int64_t k = 0; k < n && s == TZ_OK; k++) {
            double rows = tz_quality_band_end(k, j.p->h) - (double)k * TZ_QUALITY_BAND;
            int side = 2 * k < n ? 3 : 4;
            for (int h = 0; h < 2; h++) {
                double v = j.band[k][h],
                       a = rows * (h ? j.p->w - j.p->w / 2 : j.p->w / 2);
                sum[0] += v, sum[1 + h] += v, sum[side] += v;
                area[0] += a, area[1 + h] += a, area[side] += a;
            }
        }
        tz_free(ctx, j.band);
    }
    for (int k = 0; k < 5; k++)
        mean[k] = area[k] > 0 ? sum[k] / area[k] : sum[0] / area[0];
    return s;
}

tz_status tz_quality_sharpness(tz_ctx *ctx, const tz_quality_work *w, tz_quality *q)
{
    double log_sum = 0, log_half[4] = {0}, range = log(LEAST);
    int32_t n = 0;
    for (int32_t level = 0; level < 2; level++) {
        double e[5], o[5];
        if (!w->exemplar->at[0].laplace[level].w || !w->output->at[0].laplace[level].w)
            continue;
        tz_status s = level_energy(ctx, w->exemplar, level, e);
        if (s == TZ_OK)
            s = level_energy(ctx, w->output, level, o);
        if (s != TZ_OK)
            return s;
        log_sum += log(tz_quality_ratio(o[0], e[0], FLOOR));
        for (int k = 0; k < 4; k++)
            log_half[k] += log(tz_quality_ratio(e[k + 1], e[0], FLOOR));
        n++;
    }
    for (int k = 0; k < 4 && n; k++)
        range = fabs(log_half[k] / n) > range ? fabs(log_half[k] / n) : range;
    q->sharpness = n ? exp(log_sum / n) : 1;
    q->sharpness_range = exp(range < log(MOST) ? range : log(MOST));
    return TZ_OK;
}
