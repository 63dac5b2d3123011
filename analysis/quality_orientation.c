/* SPDX-License-Identifier: Apache-2.0 */
/* Orientation: what stands in small windows, counted.
 *
 * The structure tensor of a 9 x 9 window, J = sum of g g', tells the window's orientation
 * (half the angle of J's deviator), its coherence (l1 - l2) / (l1 + l2) and its energy
 * l1 + l2. Windows are counted in bins of orientation (12, shared linearly with the next)
 * x coherence (4) x energy (4, at the exemplar's quartiles), on the three finest levels.
 * Orientation alone depends on the power spectrum only; coherence and energy tell lines
 * in calm surroundings from noise of the same spectrum.
 *
 * The distance of two such histograms is their L1 distance; the figure is the distance of
 * exemplar and output over that of halves of the exemplar, mean of the levels. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/quality_measures.h"

#define RADIUS  4
#define ANGLES  12
#define GRADES  4 /* of coherence and of energy */
#define CELLS   (ANGLES * GRADES * GRADES)
#define LEVELS  3
#define COARSE  64 /* energy is first counted on a logarithmic scale of 1 / 8 octave .. */
#define NOTHING 1e-3f /* energy of no structure */

typedef struct window_job {
    const tz_quality_planes *f;
    int32_t step;
    float quartile[GRADES - 1];
    double (*cell)[4][CELLS];  /* a row of windows: by quarter of the picture */
    int32_t (*energy)[COARSE]; /* a row; not NULL: only count energies */
} window_job;

static int energy_bin(float e)
{
    int k = (int)floorf(3 * log2f(e / NOTHING));
    return k < 0 ? 0 : k >= COARSE ? COARSE - 1 : k;
}

static void tensor(const tz_quality_planes *f, int32_t x, int32_t y, float j[3])
{
    float a = 0, b = 0, c = 0;
    for (int32_t v = y - RADIUS; v <= y + RADIUS; v++) {
        const float *p = f->v[0] + (size_t)v * f->w + x - RADIUS;
        for (int32_t u = 0; u <= 2 * RADIUS; u++, p++) {
            float gx = p[1] - p[-1] +
                       0.5f * (p[1 - f->w] - p[-1 - f->w] + p[1 + f->w] - p[-1 + f->w]);
            float gy = p[f->w] - p[-f->w] +
                       0.5f * (p[f->w - 1] - p[-f->w - 1] + p[f->w + 1] - p[-f->w + 1]);
            a += gx * gx, b += gx * gy, c += gy * gy;
        }
    }
    j[0] = a, j[1] = b, j[2] = c;
}

static tz_status window_row(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    const window_job *j = arg;
    const tz_quality_planes *f = j->f;
    int32_t y = RADIUS + 1 + (int32_t)i * j->step;
    (void)ctx, (void)worker;
    for (int32_t x = RADIUS + 1; x < f->w - RADIUS - 1; x += j->step) {
        float t[3];
        tensor(f, x, y, t);
        float energy = t[0] + t[2], n = (2 * RADIUS + 1) * (2 * RADIUS + 1) * 16.0f;
        energy /= n;
        if (!(energy > NOTHING))
            continue;
        if (j->energy) {
            j->energy[i][energy_bin(energy)]++;
            continue;
        }
        float dev = sqrtf((t[0] - t[2]) * (t[0] - t[2]) + 4 * t[1] * t[1]);
        int coherence = (int)(GRADES * dev / (t[0] + t[2])), grade = 0;
        coherence = coherence < GRADES ? coherence : GRADES - 1;
        while (grade < GRADES - 1 && energy > j->quartile[grade])
            grade++;
        double angle =
            atan2(2 * (double)t[1], (double)t[0] - t[2]) / (2 * TZ_PI) * ANGLES;
        angle = angle < 0 ? angle + ANGLES : angle;
        int k = (int)angle % ANGLES;
        double part = angle - floor(angle);
        int quarter = (x >= f->w / 2) + 2 * (y >= f->h / 2);
        double *cell = j->cell[i][quarter] + (coherence * GRADES + grade) * ANGLES;
        cell[k] += 1 - part;
        cell[(k + 1) % ANGLES] += part;
    }
    return TZ_OK;
}

static int64_t window_rows(const window_job *j)
{
    int32_t free = j->f->h - 2 * RADIUS - 2;
    return free > 0 ? (free + j->step - 1) / j->step : 0;
}

/* Quartiles of the energy, from the coarse counts. */
static tz_status find_quartiles(tz_ctx *ctx, const tz_quality_picture *p, int32_t level,
                                float quartile[GRADES - 1])
{
    int64_t count[COARSE] = {0}, all = 0, below = 0;
    window_job j = {.f = &p->at[0].gauss[level],
                    .step = level == 0   ? 4
                            : level == 1 ? 2
                                         : 1};
    int64_t n = window_rows(&j);
    tz_status s = tz_alloc_zero(ctx, &j.energy, (size_t)n, sizeof *j.energy);
    if (s == TZ_OK)
        s = tz_parallel_for(ctx, n, window_row, &j);
    for (int64_t i = 0; i < n && s == TZ_OK; i++)
        for (int k = 0; k < COARSE; k++)
            count[k] += j.energy[i][k], all += j.energy[i][k];
    for (int g = 0, k = 0; g < GRADES - 1; g++) {
        while (k < COARSE && below + count[k] < (g + 1) * all / GRADES)
            below += count[k++];
        quartile[g] = NOTHING * exp2f((float)(k + 1) / 3);
    }
    tz_free(ctx, j.energy);
    return s;
}

/* Histogram of each quarter, summed over crops. */
static tz_status count_windows(tz_ctx *ctx, const tz_quality_picture *p, int32_t level,
                               const float quartile[GRADES - 1], double h[4][CELLS])
{
    tz_status s = TZ_OK;
    memset(h, 0, sizeof(double) * 4 * CELLS);
    for (int32_t c = 0; c < p->n && s == TZ_OK; c++) {
        window_job j = {.f = &p->at[c].gauss[level],
                        .step = level == 0   ? 4
                                : level == 1 ? 2
                                             : 1};
        int64_t n = window_rows(&j);
        memcpy(j.quartile, quartile, sizeof j.quartile);
        s = tz_alloc_zero(ctx, &j.cell, (size_t)n, sizeof *j.cell);
        if (s == TZ_OK)
            s = tz_parallel_for(ctx, n, window_row, &j);
        for (int64_t i = 0; i < n && s == TZ_OK; i++)
            for (int k = 0; k < 4; k++)
                for (int b = 0; b < CELLS; b++)
                    h[k][b] += j.cell[i][k][b];
        tz_free(ctx, j.cell);
    }
    return s;
}

/* L1 distance of the sums of the quarters in two sets (bits 0..3). */
static double distance(double a[4][CELLS], int set_a, double b[4][CELLS], int set_b)
{
    double sa = 0, sb = 0, d = 0, va[CELLS] = {0}, vb[CELLS] = {0};
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < CELLS; i++) {
            va[i] += set_a >> k & 1 ? a[k][i] : 0;
            vb[i] += set_b >> k & 1 ? b[k][i] : 0;
        }
    for (int i = 0; i < CELLS; i++)
        sa += va[i], sb += vb[i];
    if (sa == 0 && sb == 0)
        return 0;
    if (sa == 0 || sb == 0)
        return 2;
    for (int i = 0; i < CELLS; i++)
        d += fabs(va[i] / sa - vb[i] / sb);
    return d;
}

tz_status tz_quality_orientation(tz_ctx *ctx, const tz_quality_work *w, tz_quality *q)
{
    double(*e)[CELLS], sum = 0;
    int32_t n = 0;
    tz_status s = tz_alloc(ctx, &e, 8, sizeof *e);
    if (s != TZ_OK)
        return s;
    double(*o)[CELLS] = e + 4;
    for (int32_t level = 0; level < LEVELS && s == TZ_OK; level++) {
        float quartile[GRADES - 1];
        if (level >= w->exemplar->at[0].n || level >= w->output->at[0].n)
            break;
        if ((s = find_quartiles(ctx, w->exemplar, level, quartile)) != TZ_OK ||
            (s = count_windows(ctx, w->exemplar, level, quartile, e)) != TZ_OK ||
            (s = count_windows(ctx, w->output, level, quartile, o)) != TZ_OK)
            break;
        double halves =
            (distance(e, 5, e, 10) + distance(e, 3, e, 12) + distance(e, 9, e, 6)) / 3;
        sum += tz_quality_ratio(distance(e, 15, o, 15), halves, 0.02);
        n++;
    }
    q->orientation = n ? sum / n : 1;
    tz_free(ctx, e);
    return s;
}
