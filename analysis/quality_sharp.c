/* SPDX-License-Identifier: Apache-2.0 */
/* Sharpness: energy of the two finest levels of the lightness' Laplacian pyramid, output
 * over exemplar, geometric mean of both levels. */
#include <math.h>

#include "analysis/quality_measures.h"

typedef struct energy_job {
    const tz_quality_planes *p;
    double *band; /* sum of squares a band of rows */
} energy_job;

static tz_status energy_band(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    const energy_job *j = arg;
    double sum = 0;
    (void)ctx, (void)worker;
    for (int32_t y = (int32_t)i * TZ_QUALITY_BAND; y < tz_quality_band_end(i, j->p->h);
         y++) {
        const float *v = j->p->v[0] + (size_t)y * j->p->w;
        float part[8] = {0};
        int32_t x = 0;
        for (; x + 8 <= j->p->w; x += 8)
            for (int k = 0; k < 8; k++)
                part[k] += v[x + k] * v[x + k];
        for (; x < j->p->w; x++)
            part[0] += v[x] * v[x];
        for (int k = 0; k < 8; k++)
            sum += part[k];
    }
    j->band[i] = sum;
    return TZ_OK;
}

/* Mean square of a level over all crops. */
static tz_status level_energy(tz_ctx *ctx, const tz_quality_picture *p, int32_t level,
                              double *mean)
{
    tz_status s = TZ_OK;
    double sum = 0, area = 0;
    for (int32_t i = 0; i < p->n && s == TZ_OK; i++) {
        energy_job j = {.p = &p->at[i].laplace[level]};
        int64_t n = tz_quality_bands(j.p->h);
        s = tz_alloc(ctx, &j.band, (size_t)n, sizeof(double));
        if (s == TZ_OK)
            s = tz_parallel_for(ctx, n, energy_band, &j);
        for (int64_t k = 0; k < n && s == TZ_OK; k++)
            sum += j.band[k];
        area += (double)j.p->w * j.p->h;
        tz_free(ctx, j.band);
    }
    *mean = sum / area;
    return s;
}

tz_status tz_quality_sharpness(tz_ctx *ctx, const tz_quality_work *w, tz_quality *q)
{
    double log_sum = 0;
    int32_t n = 0;
    for (int32_t level = 0; level < 2; level++) {
        if (w->exemplar->at[0].laplace[level].w == 0 || w->output->at[0].laplace[level].w == 0)
            continue;
        double e, o;
        tz_status s = level_energy(ctx, w->exemplar, level, &e);
        if (s == TZ_OK)
            s = level_energy(ctx, w->output, level, &o);
        if (s != TZ_OK)
            return s;
        log_sum += log(tz_quality_ratio(o, e, 1e-3));
        n++;
    }
    q->sharpness = n ? exp(log_sum / n) : 1;
    return TZ_OK;
}
