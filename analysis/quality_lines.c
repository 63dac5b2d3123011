/* SPDX-License-Identifier: Apache-2.0 */
/* Broken lines: edges and ridges that stop short.
 *
 * At half size, smoothed, every local maximum of strength across its own direction is a
 * point of a line: of an edge (gradient g, normal n = g / |g|, strength s = <g, n>) or a
 * ridge (Hessian H, n the eigenvector of the larger |eigenvalue|, s = n' H n). Points
 * beyond a strength that the exemplar sets are looked at along the tangent:
 *
 *      back (-REACH)        p         ahead (+REACH)
 *      s >= HOLD s(p)  -----o- - - -  s < GONE s(p) within LATERAL px: a loose end
 *
 * with s measured along p's normal and with its sign, so that a line which turns gently
 * goes on and one of the opposite sense does not. A line that fades is not loose, nor is
 * one too short to have a back. broken = loose points per point, over the exemplar's; what
 * lies between the lowest and the highest of the exemplar's halves counts as 1. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/filter_cv.h"
#include "analysis/quality_measures.h"

#define SIGMA   1.0
#define REACH   5
#define LATERAL 2
#define HOLD    0.6f
#define GONE    0.2f
#define STRONG  0.75  /* quantile of the exemplar's line strengths */
#define LEAST   0.25f /* strength of no account, of 100 a px */
#define MARGIN  (REACH + LATERAL + 2)
#define BINS    512
#define BIN     0.05f

enum { EDGE, RIDGE, KINDS };

typedef struct line_job {
    const tz_quality_planes *f; /* its lightness, smoothed */
    float *v;
    float least[KINDS];               /* strength of a point */
    int64_t (*strength)[KINDS][BINS]; /* a band; NULL: count ends */
    int64_t (*sum)[2][KINDS][2]; /* points, loose points, a band, left and right half */
} line_job;

typedef struct line_point {
    float nx, ny, s;
} line_point;

static float strength_along(const float *p, int32_t w, int kind, float nx, float ny)
{
    if (kind == EDGE)
        return 0.5f * ((p[1] - p[-1]) * nx + (p[w] - p[-w]) * ny);
    float xx = p[1] + p[-1] - 2 * p[0], yy = p[w] + p[-w] - 2 * p[0];
    float xy = 0.25f * (p[w + 1] + p[-w - 1] - p[w - 1] - p[-w + 1]);
    return xx * nx * nx + yy * ny * ny + 2 * xy * nx * ny;
}

static line_point direction(const float *p, int32_t w, int kind)
{
    if (kind == EDGE) {
        float gx = 0.5f * (p[1] - p[-1]), gy = 0.5f * (p[w] - p[-w]);
        float s = sqrtf(gx * gx + gy * gy), k = s > 0 ? 1 / s : 0;
        return (line_point){gx * k, gy * k, s};
    }
    float xx = p[1] + p[-1] - 2 * p[0], yy = p[w] + p[-w] - 2 * p[0];
    float xy = 0.25f * (p[w + 1] + p[-w - 1] - p[w - 1] - p[-w + 1]);
    float half = 0.5f * (xx - yy), root = sqrtf(half * half + xy * xy);
    float mean = 0.5f * (xx + yy), s = mean > 0 ? mean + root : mean - root;
    /* eigenvector of s: (xy, s - xx) or (s - yy, xy), whichever is longer */
    float ax = xy, ay = s - xx, bx = s - yy, by = xy;
    if (ax * ax + ay * ay < bx * bx + by * by)
        ax = bx, ay = by;
    float n = sqrtf(ax * ax + ay * ay), k = n > 0 ? 1 / n : 0;
    return (line_point){ax * k, ay * k, s};
}

/* Strongest answer to the line of d near (x, y) + along its tangent by t px. */
static float follow(const line_job *j, int kind, int32_t x, int32_t y, line_point d,
                    float t)
{
    float best = 0, sign = d.s < 0 ? -1 : 1;
    for (int k = -LATERAL; k <= LATERAL; k++) {
        int32_t u = x + (int32_t)lrintf(-d.ny * t + d.nx * (float)k);
        int32_t v = y + (int32_t)lrintf(d.nx * t + d.ny * (float)k);
        float s = sign * strength_along(j->v + (size_t)v * j->f->w + u, j->f->w, kind,
                                        d.nx, d.ny);
        best = s > best ? s : best;
    }
    return best;
}

static tz_status line_band(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    const line_job *j = arg;
    int32_t w = j->f->w, h = j->f->h;
    (void)ctx, (void)worker;
    for (int32_t y = (int32_t)i * TZ_QUALITY_BAND; y < tz_quality_band_end(i, h); y++)
        for (int32_t x = MARGIN; x < w - MARGIN && y >= MARGIN && y < h - MARGIN; x++)
            for (int kind = 0; kind < KINDS; kind++) {
                const float *p = j->v + (size_t)y * w + x;
                line_point d = direction(p, w, kind);
                float s = fabsf(d.s), sign = d.s < 0 ? -1 : 1;
                if (s < j->least[kind])
                    continue;
                int32_t dx = (int32_t)lrintf(d.nx), dy = (int32_t)lrintf(d.ny);
                const float *a = p + dy * w + dx, *b = p - dy * w - dx;
                if (sign * strength_along(a, w, kind, d.nx, d.ny) > s ||
                    sign * strength_along(b, w, kind, d.nx, d.ny) >= s)
                    continue;
                if (j->strength) {
                    int bin = (int)(s / BIN);
                    j->strength[i][kind][bin < BINS ? bin : BINS - 1]++;
                    continue;
                }
                float ahead = follow(j, kind, x, y, d, REACH);
                float back = follow(j, kind, x, y, d, -REACH);
                float most = ahead > back ? ahead : back,
                      rest = ahead > back ? back : ahead;
                int64_t *sum = j->sum[i][x >= w / 2][kind];
                sum[0]++;
                sum[1] += most >= HOLD * s && rest < GONE * s;
            }
    return TZ_OK;
}

typedef struct blur_job {
    const tz_quality_planes *f;
    float *out;
} blur_job;

static tz_status blur_band(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    const blur_job *j = arg;
    (void)worker;
    return tz_cv_blur(ctx, j->f->v[0], j->out, j->f->w, j->f->h,
                      (int32_t)i * TZ_QUALITY_BAND, tz_quality_band_end(i, j->f->h),
                      SIGMA);
}

/* Points and loose points of the whole, left, right, top and bottom. */
typedef struct line_count {
    int64_t sum[5][KINDS][2];
} line_count;

static void add_band(line_count *o, int64_t sum[2][KINDS][2], bool top)
{
    for (int half = 0; half < 2; half++)
        for (int kind = 0; kind < KINDS; kind++)
            for (int k = 0; k < 2; k++) {
                /* the analyzer does not see that a band without sums is not added */
                o->sum[0][kind][k] += sum[half][kind][k]; // NOLINT
                o->sum[1 + half][kind][k] += sum[half][kind][k];
                o->sum[top ? 3 : 4][kind][k] += sum[half][kind][k];
            }
}

/* One pass over all crops: strengths if `strength`, else points and ends into o. */
static tz_status scan(tz_ctx *ctx, const tz_quality_picture *p, const float least[KINDS],
                      int64_t strength[KINDS][BINS], line_count *o)
{
    tz_status s = TZ_OK;
    for (int32_t c = 0; c < p->n && s == TZ_OK; c++) {
        const tz_quality_planes *f = &p->at[c].gauss[p->at[c].n > 1];
        int64_t n = tz_quality_bands(f->h);
        line_job j = {.f = f, .least = {least[0], least[1]}};
        s = tz_alloc(ctx, &j.v, (size_t)f->w * f->h, sizeof(float));
        blur_job b = {f, j.v};
        if (s == TZ_OK)
            s = tz_parallel_for(ctx, n, blur_band, &b);
        if (s == TZ_OK)
            s = strength ? tz_alloc_zero(ctx, &j.strength, (size_t)n, sizeof *j.strength)
                         : tz_alloc_zero(ctx, &j.sum, (size_t)n, sizeof *j.sum);
        if (s == TZ_OK)
            s = tz_parallel_for(ctx, n, line_band, &j);
        for (int64_t i = 0; i < n && s == TZ_OK; i++) {
            if (j.sum)
                add_band(o, j.sum[i], 2 * i < n);
            for (int kind = 0; kind < KINDS && strength; kind++)
                for (int k = 0; k < BINS; k++)
                    strength[kind][k] += j.strength[i][kind][k];
        }
        tz_free(ctx, j.v);
        tz_free(ctx, j.strength);
        tz_free(ctx, j.sum);
    }
    return s;
}

/* Loose points per point, mean of both kinds; 20 points and 1 end more steady small
 * numbers. */
static double looseness(const line_count *c, int part)
{
    double v = 0;
    for (int kind = 0; kind < KINDS; kind++)
        v += (double)(c->sum[part][kind][1] + 1) / (double)(c->sum[part][kind][0] + 20);
    return v / KINDS;
}

tz_status tz_quality_lines(tz_ctx *ctx, const tz_quality_work *w, tz_quality *q)
{
    float least[KINDS] = {LEAST, LEAST};
    line_count e = {0}, o = {0};
    int64_t(*strength)[BINS];
    tz_status s = tz_alloc_zero(ctx, &strength, KINDS, sizeof *strength);
    if (s == TZ_OK)
        s = scan(ctx, w->exemplar, least, strength, NULL);
    for (int kind = 0; kind < KINDS && s == TZ_OK; kind++) {
        int64_t all = 0, below = 0;
        int k = 0;
        for (int b = 0; b < BINS; b++)
            all += strength[kind][b];
        for (; k < BINS && (double)(below + strength[kind][k]) <= STRONG * (double)all;
             k++)
            below += strength[kind][k];
        least[kind] = all && (float)k * BIN > LEAST ? (float)k * BIN : LEAST;
    }
    tz_free(ctx, strength);
    if (s == TZ_OK)
        s = scan(ctx, w->exemplar, least, NULL, &e);
    if (s == TZ_OK)
        s = scan(ctx, w->output, least, NULL, &o);
    if (s != TZ_OK)
        return s;
    double lo = looseness(&e, 0), hi = lo, v = looseness(&o, 0);
    for (int part = 1; part < 5; part++) {
        double half = looseness(&e, part);
        lo = half < lo ? half : lo;
        hi = half > hi ? half : hi;
    }
    q->broken = v > hi ? v / hi : v < lo ? v / lo : 1;
    return TZ_OK;
}
