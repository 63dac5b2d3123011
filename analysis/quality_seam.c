/* SPDX-License-Identifier: Apache-2.0 */
/* Seams: long, coherent, one-pixel-wide steps that their surroundings do not explain.
 *
 * Across a hard border of two patches the step d0 between neighbours knows nothing of the
 * steps beside it; inside a photo, lens and pixels smear every edge over two px and more.
 *
 *      d-1   d0   d+1            r = d0 - (d-1 + d+1) / 4
 *    o ---- o | o ---- o         a = min(|r| / (local mean of |r| + EPS), CAP)
 *             seam
 *
 * `a` is the anomaly of one pixel border, 1 on the average whatever the texture's
 * contrast. S, the mean of `a` over a digital line of LINE px, is high only where the
 * anomaly is coherent; the best of all slopes is kept, and only maxima across the line.
 * Both axes, so that lines of every direction are met: borders of polygons too. Colour is
 * a detector of its own beside lightness, since fine texture hides a seam in lightness
 * but seldom in colour (there the anomaly is widened by a px, because the noise is low).
 *
 * Straight sharp edges exist in photos as well (bricks). So the figure compares tails:
 * with rho(t) the length per area of lines of S >= t,
 *   seam = max over t of rho_output(t) - MORE rho_exemplar(t / STRONGER),
 * over those t that are RARE in the exemplar, rho_exemplar being that of whichever half
 * of the exemplar has most: the excess in px of seam line a px of area, about 0 for another
 * crop of the exemplar. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/quality_measures.h"

#define LINE     32
#define BAND     128 /* rows of a parallel item */
#define CONTEXT  7   /* radius of the local mean */
#define CAP      4.0f
#define UNIT     16  /* steps of the quantised anomaly per 1 */
#define BINS     256 /* of S, BIN sums each */
#define BIN      (LINE * (int)CAP * UNIT / BINS)
#define MARGIN   (LINE / 2)
#define RARE     5e-3 /* lines stronger than all but so many a px are looked at */
#define STRONGER 1.04 /* tolerance of the comparison, in strength */
#define MORE     1.15 /* and in number */
#define PEAK     3    /* radius in which a line is the maximum across */

typedef struct detector {
    int first, end; /* planes */
    bool widen;
    int slopes; /* to each side of straight: dx = k LINE / (2 slopes) ... */
    float eps;
} detector;

static const detector detectors[2] = {{0, 1, false, 8, 0.3f}, {1, 3, true, 4, 0.1f}};

typedef struct seam_job {
    const tz_quality_planes *f;
    const detector *d;
    bool turned;               /* the picture is transposed */
    int64_t (*count)[4][BINS]; /* a band: left, right, top and bottom half */
    uint16_t *map;             /* NULL or S + 1 at maxima, else 0 */
} seam_job;

/* |r| of one row, over the detector's planes. */
static void step_row(const seam_job *j, int32_t y, float *m)
{
    const tz_quality_planes *f = j->f;
    memset(m, 0, (size_t)f->w * sizeof *m);
    for (int c = j->d->first; c < j->d->end; c++) {
        const float *p = f->v[c] + (size_t)y * f->w;
        for (int32_t x = 1; x < f->w - 2; x++) {
            float r = p[x + 1] - p[x] - 0.25f * (p[x] - p[x - 1] + p[x + 2] - p[x + 1]);
            m[x] += r * r;
        }
    }
    for (int32_t x = 1; x < f->w - 2; x++)
        m[x] = sqrtf(m[x]);
}

/* Quantised anomaly of row y from the |r| of rows y0..y1-1 (rows of m). */
static void anomaly_row(const seam_job *j, const float *m, int32_t y0, int32_t y1,
                        int32_t y, float *sum, uint16_t *a)
{
    int32_t w = j->f->w, n = 0;
    memset(sum, 0, (size_t)w * sizeof *sum);
    for (int32_t v = y - CONTEXT; v <= y + CONTEXT; v++)
        if (v >= y0 && v < y1) {
            const float *row = m + (size_t)(v - y0) * w;
            for (int32_t x = 0; x < w; x++)
                sum[x] += row[x];
            n++;
        }
    const float *row = m + (size_t)(y - y0) * w;
    double box = 0;
    for (int32_t x = 0; x < CONTEXT && x < w; x++)
        box += (double)sum[x];
    for (int32_t x = 0; x < w; x++) {
        if (x + CONTEXT < w)
            box += (double)sum[x + CONTEXT];
        if (x - CONTEXT - 1 >= 0)
            box -= (double)sum[x - CONTEXT - 1];
        int32_t lo = x - CONTEXT < 0 ? 0 : x - CONTEXT;
        int32_t hi = x + CONTEXT >= w ? w - 1 : x + CONTEXT;
        float mean = (float)(box / (n * (hi - lo + 1)));
        float v = row[x] / ((mean > 0 ? mean : 0) + j->d->eps);
        a[x] = (uint16_t)lrintf((v < CAP ? v : CAP) * UNIT);
    }
    if (!j->d->widen)
        return;
    uint16_t left = 0;
    for (int32_t x = 0; x < w; x++) {
        uint16_t here = a[x], right = x + 1 < w ? a[x + 1] : 0;
        uint16_t side = left > right ? left : right;
        a[x] = here > side ? here : side;
        left = here;
    }
}

/* Best line through each pixel border of a row: rows y - LINE / 2 .. + LINE / 2 - 1 of a. */
static void line_row(const seam_job *j, const uint16_t *a, uint16_t *t, uint16_t *best)
{
    int32_t w = j->f->w, slopes = j->d->slopes;
    memset(best, 0, (size_t)w * sizeof *best);
    for (int32_t k = -slopes; k <= slopes; k++) {
        memset(t, 0, (size_t)w * sizeof *t);
        for (int32_t i = 0; i < LINE; i++) {
            int32_t dx = (int32_t)lround((double)(i - LINE / 2) * k / slopes);
            const uint16_t *row = a + (size_t)i * w;
            for (int32_t x = MARGIN; x < w - MARGIN; x++)
                t[x] = (uint16_t)(t[x] + row[x + dx]);
        }
        for (int32_t x = MARGIN; x < w - MARGIN; x++)
            best[x] = t[x] > best[x] ? t[x] : best[x];
    }
}

static void count_row(const seam_job *j, int32_t y, const uint16_t *best,
                      int64_t count[4][BINS])
{
    int across = j->turned ? 2 : 0, along = (j->turned ? 0 : 2) + (2 * y >= j->f->h);
    for (int32_t x = MARGIN; x < j->f->w - MARGIN; x++) {
        bool peak = best[x] > 0;
        for (int32_t k = 1; k <= PEAK && peak; k++)
            peak = best[x + k] <= best[x] && best[x - k] < best[x];
        if (!peak)
            continue;
        int32_t bin = best[x] / BIN;
        bin = bin < BINS ? bin : BINS - 1;
        count[across + (2 * x >= j->f->w)][bin]++;
        count[along][bin]++;
        if (j->map)
            j->map[(size_t)y * j->f->w + x] = (uint16_t)(best[x] + 1);
    }
}

static tz_status seam_band(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    const seam_job *j = arg;
    int32_t w = j->f->w, h = j->f->h, b0 = (int32_t)i * BAND + MARGIN;
    int32_t b1 = b0 + BAND < h - MARGIN ? b0 + BAND : h - MARGIN;
    int32_t a0 = b0 - LINE / 2, a1 = b1 + LINE / 2;
    int32_t m0 = a0 - CONTEXT < 0 ? 0 : a0 - CONTEXT;
    int32_t m1 = a1 + CONTEXT > h ? h : a1 + CONTEXT;
    float *m = NULL, *sum = NULL;
    uint16_t *a = NULL, *t = NULL;
    tz_status s;
    (void)worker;
    if ((s = tz_alloc(ctx, &m, (size_t)(m1 - m0) * w, sizeof *m)) != TZ_OK ||
        (s = tz_alloc(ctx, &sum, (size_t)w, sizeof *sum)) != TZ_OK ||
        (s = tz_alloc(ctx, &a, (size_t)(a1 - a0) * w, sizeof *a)) != TZ_OK ||
        (s = tz_alloc(ctx, &t, (size_t)w * 2, sizeof *t)) != TZ_OK)
        goto done;
    for (int32_t y = m0; y < m1; y++)
        step_row(j, y, m + (size_t)(y - m0) * w);
    for (int32_t y = a0; y < a1; y++)
        anomaly_row(j, m, m0, m1, y, sum, a + (size_t)(y - a0) * w);
    for (int32_t y = b0; y < b1; y++) {
        line_row(j, a + (size_t)(y - b0) * w, t, t + w);
        count_row(j, y, t + w, j->count[i]);
    }
done:
    tz_free(ctx, m);
    tz_free(ctx, sum);
    tz_free(ctx, a);
    tz_free(ctx, t);
    return s;
}

/* ---- pictures ------------------------------------------------------------------- */

static tz_status transpose(tz_ctx *ctx, const tz_quality_planes *f, tz_quality_planes *o)
{
    tz_status s = tz_quality_planes_init(ctx, o, f->h, f->w, f->n);
    for (int32_t c = 0; c < f->n && s == TZ_OK; c++)
        for (int32_t y0 = 0; y0 < f->h; y0 += 16)
            for (int32_t x = 0; x < f->w; x++)
                for (int32_t y = y0; y < y0 + 16 && y < f->h; y++)
                    o->v[c][(size_t)x * f->h + y] = f->v[c][(size_t)y * f->w + x];
    return s;
}

static tz_status count_lines(tz_ctx *ctx, const tz_quality_planes *f, const detector *d,
                             bool turned, uint16_t *map, int64_t count[4][BINS])
{
    if (f->w < 2 * LINE || f->h < 2 * LINE)
        return TZ_OK;
    seam_job j = {.f = f, .d = d, .turned = turned, .map = map};
    int64_t n = (f->h - 2 * MARGIN + BAND - 1) / BAND;
    tz_status s = tz_alloc_zero(ctx, &j.count, (size_t)n, sizeof *j.count);
    if (s == TZ_OK)
        s = tz_parallel_for(ctx, n, seam_band, &j);
    for (int64_t i = 0; i < n && s == TZ_OK; i++)
        for (int h = 0; h < 4; h++)
            for (int k = 0; k < BINS; k++)
                count[h][k] += j.count[i][h][k];
    tz_free(ctx, j.count);
    return s;
}

typedef struct seam_count {
    int64_t line[2][4][BINS]; /* a detector and half */
    double area;              /* px */
    uint16_t *map[2][2];      /* detector, upright or transposed */
} seam_count;

static tz_status count_picture(tz_ctx *ctx, const tz_quality_picture *p, bool map,
                               seam_count *r)
{
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < p->n && s == TZ_OK; i++) {
        const tz_quality_planes *f = &p->at[i].gauss[0];
        tz_quality_planes turned = {0};
        s = transpose(ctx, f, &turned);
        for (int d = 0; d < (f->n == 3 ? 2 : 1); d++)
            for (int t = 0; t < 2 && s == TZ_OK; t++) {
                if (map)
                    s = tz_alloc_zero(ctx, &r->map[d][t], (size_t)f->w * f->h,
                                      sizeof(uint16_t));
                if (s == TZ_OK)
                    s = count_lines(ctx, t ? &turned : f, &detectors[d], t, r->map[d][t],
                                    r->line[d]);
            }
        r->area += (double)f->w * f->h;
        tz_quality_planes_deinit(&turned);
    }
    return s;
}

/* Excess of the output's tail; *at is the bin where it is largest. */
static double excess(const seam_count *e, const seam_count *o, int d, int *at)
{
    double tail_e[BINS + 1] = {0}, half[4] = {0}, tail_o = 0, best = 0;
    *at = BINS;
    for (int k = BINS - 1; k >= 0; k--)
        for (int h = 0; h < 4; h++) {
            half[h] += (double)e->line[d][h][k] / (0.5 * e->area);
            tail_e[k] = half[h] > tail_e[k] ? half[h] : tail_e[k];
        }
    for (int k = BINS - 1; k >= 0; k--) {
        tail_o += (double)(o->line[d][0][k] + o->line[d][1][k]) / o->area;
        double v = tail_o - MORE * tail_e[(int)(k / STRONGER)];
        if (tail_e[(int)(k / STRONGER)] > RARE)
            break;
        if (v > best)
            best = v, *at = k;
    }
    return best;
}

static void paint(const seam_count *o, int d, int at, int32_t w, int32_t h, float *heat)
{
    for (int32_t y = 0; y < h; y++)
        for (int32_t x = 0; x < w; x++) {
            uint16_t a = o->map[d][0][(size_t)y * w + x];
            uint16_t b = o->map[d][1][(size_t)x * h + y], v = a > b ? a : b;
            if (v && (v - 1) / BIN >= at)
                for (int32_t r = -1; r <= 1; r++)
                    for (int32_t q = -1; q <= 1; q++)
                        heat[(size_t)(y + r) * w + x + q] = 1;
        }
}

tz_status tz_quality_seam(tz_ctx *ctx, const tz_quality_work *w, tz_quality *q)
{
    seam_count *e = NULL, *o = NULL;
    tz_status s = tz_alloc_zero(ctx, &e, 1, sizeof *e);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &o, 1, sizeof *o);
    if (s == TZ_OK)
        s = count_picture(ctx, w->exemplar, false, e);
    if (s == TZ_OK)
        s = count_picture(ctx, w->output, w->heat_seam != NULL, o);
    if (s != TZ_OK)
        goto done;
    q->seam = 0;
    for (int d = 0; d < w->output->at[0].gauss[0].n && d < 2; d++) {
        int at;
        double v = excess(e, o, d, &at);
        q->seam = v > q->seam ? v : q->seam;
        if (v > 5e-4 && w->heat_seam)
            paint(o, d, at, w->output->crop[0].w, w->output->crop[0].h, w->heat_seam);
    }
done:
    for (int k = 0; k < 4 && o; k++)
        tz_free(ctx, o->map[k / 2][k % 2]);
    tz_free(ctx, e);
    tz_free(ctx, o);
    return s;
}
