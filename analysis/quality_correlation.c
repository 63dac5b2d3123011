/* SPDX-License-Identifier: Apache-2.0 */
/* Autocorrelation: distance, and periods that the exemplar does not have.
 *
 * The lightness at half size, less its own blur (shading), has the autocorrelation
 *   rho(l) = (sum of v(x) v(x + l) / pairs) / (sum of v(x)^2 / pixels).
 * The distance of two pictures is the rms difference of rho over lags up to NEAR px,
 * taken over that of halves of the exemplar.
 *
 * A picture that repeats itself at one offset has a peak there: 1 if all of it does. Noise
 * of rho at far lags is about (grain area / overlap)^(1/2); lags of little overlap are
 * left out. periodicity = (peak - base) / (1 - base) with the output's highest rho beyond
 * the grain and base = BEYOND times the exemplar's own highest, at least BASE. */
#include <math.h>
#include <string.h>

#include "analysis/filter_cv.h"
#include "analysis/quality_measures.h"

#define NEAR       48
#define SHADING    12.0 /* sigma of the blur taken off */
#define GRAIN      24   /* lags of less are the texture's own grain */
#define BASE       0.25
#define BEYOND     1.25
#define LEAST_SIDE 24

typedef struct plane {
    int32_t w, h;
    float *v;
} plane;

typedef struct flat_job {
    const tz_quality_planes *f;
    float *out;
} flat_job;

static tz_status flatten_band(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    const flat_job *j = arg;
    int32_t w = j->f->w, h = j->f->h;
    int32_t y0 = (int32_t)i * TZ_QUALITY_BAND, y1 = tz_quality_band_end(i, h);
    (void)worker;
    tz_status s = tz_cv_blur(ctx, j->f->v[0], j->out, w, h, y0, y1, SHADING);
    for (size_t k = (size_t)y0 * w; s == TZ_OK && k < (size_t)y1 * w; k++)
        j->out[k] = j->f->v[0][k] - j->out[k];
    return s;
}

/* Half-size lightness less shading. */
static tz_status flatten(tz_ctx *ctx, const tz_quality_pyramid *p, plane *o)
{
    flat_job j = {.f = &p->gauss[p->n > 1]};
    *o = (plane){.w = j.f->w, .h = j.f->h};
    tz_status s = tz_alloc(ctx, &o->v, (size_t)o->w * o->h, sizeof(float));
    j.out = o->v;
    if (s == TZ_OK)
        s = tz_parallel_for(ctx, tz_quality_bands(o->h), flatten_band, &j);
    return s;
}

/* rho of the rectangle r of a plane; rho[(y + my) * (mx + 1) + x], x = 0..mx,
 * y = -my..my. All 0 where the plane is flat. */
static tz_status correlate(tz_ctx *ctx, const plane *p, tz_rect r, int32_t mx, int32_t my,
                           double *rho)
{
    float *v = NULL, *sum = NULL;
    size_t n = (size_t)(mx + 1) * (2 * (size_t)my + 1);
    tz_status s = tz_alloc(ctx, &v, (size_t)r.w * r.h, sizeof *v);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &sum, n, sizeof *sum);
    if (s != TZ_OK)
        goto done;
    double mean = 0;
    for (int32_t y = 0; y < r.h; y++)
        for (int32_t x = 0; x < r.w; x++)
            mean += (double)p->v[(size_t)(r.y + y) * p->w + r.x + x];
    mean /= (double)r.w * r.h;
    for (int32_t y = 0; y < r.h; y++)
        for (int32_t x = 0; x < r.w; x++)
            v[(size_t)y * r.w + x] =
                p->v[(size_t)(r.y + y) * p->w + r.x + x] - (float)mean;
    s = tz_cv_autocorrelation(ctx, v, r.w, r.h, mx, my, sum);
    if (s != TZ_OK)
        goto done;
    double power = (double)sum[(size_t)my * (mx + 1)] / ((double)r.w * r.h);
    for (int32_t y = -my; y <= my; y++)
        for (int32_t x = 0; x <= mx; x++) {
            size_t k = (size_t)(y + my) * (mx + 1) + x;
            double pairs = (double)(r.w - x) * (r.h - (y < 0 ? -y : y));
            rho[k] = power > 1e-4 ? (double)sum[k] / pairs / power : 0;
        }
done:
    tz_free(ctx, v);
    tz_free(ctx, sum);
    return s;
}

/* Mean of rho over crops, lags up to NEAR or half the picture's sides. */
static tz_status near_rho(tz_ctx *ctx, const plane *p, int32_t n, const tz_rect *r,
                          int32_t m, double *rho, double *scratch)
{
    size_t count = (size_t)(m + 1) * (2 * (size_t)m + 1);
    tz_status s = TZ_OK;
    memset(rho, 0, count * sizeof *rho);
    for (int32_t i = 0; i < n && s == TZ_OK; i++) {
        s = correlate(ctx, &p[i], r ? *r : (tz_rect){0, 0, p[i].w, p[i].h}, m, m,
                      scratch);
        for (size_t k = 0; k < count && s == TZ_OK; k++)
            rho[k] += scratch[k] / n;
    }
    return s;
}

static double rms(const double *a, const double *b, size_t n)
{
    double sum = 0;
    for (size_t k = 0; k < n; k++)
        sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sqrt(sum / (double)n);
}

static int32_t least(int32_t a, int32_t b) { return a < b ? a : b; }

static tz_status measure_distance(tz_ctx *ctx, const plane *e, const plane *o, int32_t no,
                                  double *ratio)
{
    int32_t w = e->w, h = e->h, m = least(least(w, h) / 4, NEAR);
    m = least(m, least(o->w, o->h) / 2);
    const tz_rect half[4] = {{0, 0, w / 2, h},
                             {w - w / 2, 0, w / 2, h},
                             {0, 0, w, h / 2},
                             {0, h - h / 2, w, h / 2}};
    size_t n = (size_t)(m + 1) * (2 * (size_t)m + 1);
    double *rho;
    tz_status s = tz_alloc(ctx, &rho, n * 6, sizeof *rho);
    for (int k = 0; k < 4 && s == TZ_OK; k++)
        s = near_rho(ctx, e, 1, &half[k], m, rho + n * (size_t)k, rho + 5 * n);
    double within =
        s == TZ_OK ? 0.5 * (rms(rho, rho + n, n) + rms(rho + 2 * n, rho + 3 * n, n)) : 0;
    if (s == TZ_OK)
        s = near_rho(ctx, e, 1, NULL, m, rho, rho + 5 * n);
    if (s == TZ_OK)
        s = near_rho(ctx, o, no, NULL, m, rho + n, rho + 5 * n);
    if (s == TZ_OK)
        *ratio = tz_quality_ratio(rms(rho, rho + n, n), within, 0.005);
    tz_free(ctx, rho);
    return s;
}

/* Highest rho beyond the grain, of lags with half the picture in common along each side
 * at least, so that an exemplar's size is met even in twice the size. */
static tz_status highest_peak(tz_ctx *ctx, const plane *p, double *peak)
{
    int32_t mx = p->w * 5 / 8, my = p->h * 5 / 8;
    double *rho, best = 0;
    tz_status s =
        tz_alloc(ctx, &rho, (size_t)(mx + 1) * (2 * (size_t)my + 1), sizeof *rho);
    if (s == TZ_OK)
        s = correlate(ctx, p, (tz_rect){0, 0, p->w, p->h}, mx, my, rho);
    for (int32_t y = -my; y <= my && s == TZ_OK; y++)
        for (int32_t x = 0; x <= mx; x++) {
            double v = rho[(size_t)(y + my) * (mx + 1) + x];
            if (x * x + y * y >= GRAIN * GRAIN && v > best)
                best = v;
        }
    *peak = best;
    tz_free(ctx, rho);
    return s;
}

tz_status tz_quality_correlation(tz_ctx *ctx, const tz_quality_work *w, tz_quality *q)
{
    plane e = {0}, o[TZ_QUALITY_CROPS] = {{0}};
    int32_t n = w->output->n;
    double base = 0, peak = 0;
    q->correlation = 1;
    q->periodicity = 0;
    tz_status s = flatten(ctx, &w->exemplar->at[0], &e);
    for (int32_t i = 0; i < n && s == TZ_OK; i++)
        s = flatten(ctx, &w->output->at[i], &o[i]);
    if (s != TZ_OK || least(least(e.w, e.h), least(o[0].w, o[0].h)) < LEAST_SIDE)
        goto done;
    s = measure_distance(ctx, &e, o, n, &q->correlation);
    if (s == TZ_OK)
        s = highest_peak(ctx, &e, &base);
    for (int32_t i = 0; i < n && s == TZ_OK; i++) {
        double v;
        s = highest_peak(ctx, &o[i], &v);
        peak += v / n;
    }
    base = base * BEYOND > BASE ? fmin(base * BEYOND, 0.9) : BASE;
    q->periodicity = peak > base ? (peak - base) / (1 - base) : 0;
    q->periodicity = q->periodicity < 1 ? q->periodicity : 1;
done:
    tz_free(ctx, e.v);
    for (int32_t i = 0; i < n; i++)
        tz_free(ctx, o[i].v);
    return s;
}
