/* SPDX-License-Identifier: Apache-2.0 */
/* Sampling of sources.
 *
 * Turned or scaled pieces are resampled with the interpolating cubic B-spline: the photo is
 * turned once into spline coefficients (compose_plane.c), after which four taps an axis
 * interpolate exactly at pixel centres and keep the highest frequencies better than any
 * direct kernel of that width (what keeps the sharpness of the result at the photo's).
 * Pieces moved by whole pixels copy texels.
 * @source Unser, Aldroubi, Eden: B-spline signal processing, IEEE Trans. SP 41, 1993 */
#include <string.h>

#include "synthesis/compose_internal.h"

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
    if (step == 4) {
        const tz_f4 a = tz_load4(p) + fu * (tz_load4(p + 4) - tz_load4(p));
        const tz_f4 b = tz_load4(q) + fu * (tz_load4(q + 4) - tz_load4(q));
        const tz_f4 v = a + fv * (b - a);
        memcpy(out, &v, sizeof v);
        return;
    }
    for (int32_t k = 0; k < step; k++) {
        const float a = p[k] + fu * (p[k + step] - p[k]);
        const float b = q[k] + fu * (q[k + step] - q[k]);
        out[k] = a + fv * (b - a);
    }
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

/* Weights of four taps at a fraction of a texel. */
static inline __attribute__((always_inline)) void weigh(float f, float *w)
{
    const float g = 1 - f, sixth = 1.0F / 6, f2 = f * f, g2 = g * g;
    w[0] = sixth * g2 * g;
    w[1] = 2.0F / 3 - 0.5F * f2 * (2 - f);
    w[2] = 2.0F / 3 - 0.5F * g2 * (2 - g);
    w[3] = sixth * f2 * f;
}

/* Taps of a run of pixels. */
enum { RUN = 32 };

typedef struct taps {
    int32_t i[2][RUN];  /* first texel across and down */
    float w[2][RUN][4]; /* cubic B-spline weights */
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
        for (int32_t k = 0; k < n; k++)
            weigh(f[k], t->w[axis][k]);
    }
}

/* Sums run down the four rows, then across: (tap 0 + tap 2) + (tap 1 + tap 3). The same
 * text is compiled for plain and for 256-bit registers; one order of sums gives both the
 * same bits. (512-bit ones are slower: what counts is how soon texels arrive.) */
typedef float tz_f8 __attribute__((vector_size(32)));
typedef float tz_f16 __attribute__((vector_size(64)));

static inline __attribute__((always_inline)) void
grey_run(const tz_source_plane *s, const row_map *m, const taps *t, int32_t n, float *out)
{
    for (int32_t i = 0; i < n; i++) {
        const float *p = m->origin + t->i[1][i] * s->stride + t->i[0][i];
        const float *w = t->w[1][i];
        tz_f4 sum = w[0] * tz_load4(p);
        sum += w[1] * tz_load4(p + s->stride);
        sum += w[2] * tz_load4(p + 2 * s->stride);
        sum += w[3] * tz_load4(p + 3 * s->stride);
        sum *= tz_load4(t->w[0][i]);
        out[i] = (sum[0] + sum[2]) + (sum[1] + sum[3]);
    }
}

/* Up to four channels: four texels of a row in one vector. */
static inline __attribute__((always_inline)) void colour_run(const tz_source_plane *s,
                                                             const row_map *m,
                                                             const taps *t, int32_t n,
                                                             float *out)
{
    for (int32_t i = 0; i < n; i++, out += 4) {
        const float *p = m->origin + t->i[1][i] * s->stride + 4 * (int64_t)t->i[0][i];
        const float *w = t->w[1][i];
        const tz_f4 across = tz_load4(t->w[0][i]);
        tz_f16 q, sum;
        memcpy(&q, p, sizeof q);
        sum = w[0] * q;
        memcpy(&q, p + s->stride, sizeof q);
        sum += w[1] * q;
        memcpy(&q, p + 2 * s->stride, sizeof q);
        sum += w[2] * q;
        memcpy(&q, p + 3 * s->stride, sizeof q);
        sum += w[3] * q;
        sum *= __builtin_shufflevector(across, across, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2,
                                       3, 3, 3, 3);
        const tz_f8 half =
            __builtin_shufflevector(sum, sum, 0, 1, 2, 3, 4, 5, 6, 7) +
            __builtin_shufflevector(sum, sum, 8, 9, 10, 11, 12, 13, 14, 15);
        const tz_f4 all = __builtin_shufflevector(half, half, 0, 1, 2, 3) +
                          __builtin_shufflevector(half, half, 4, 5, 6, 7);
        memcpy(out, &all, sizeof all);
    }
}

/* Any number of lanes. */
static inline __attribute__((always_inline)) void lanes_run(const tz_source_plane *s,
                                                            const row_map *m,
                                                            const taps *t, int32_t n,
                                                            float *out)
{
    const int32_t step = s->step;
    for (int32_t i = 0; i < n; i++, out += step) {
        const float *p = m->origin + t->i[1][i] * s->stride + (int64_t)t->i[0][i] * step;
        for (int32_t k = 0; k < step; k += 4) {
            tz_f4 tap[4];
            for (int c = 0; c < 4; c++) {
                const float *q = p + c * step + k;
                tap[c] = t->w[1][i][0] * tz_load4(q);
                for (int r = 1; r < 4; r++)
                    tap[c] += t->w[1][i][r] * tz_load4(q + r * s->stride);
                tap[c] *= t->w[0][i][c];
            }
            const tz_f4 all = (tap[0] + tap[2]) + (tap[1] + tap[3]);
            memcpy(out + k, &all, sizeof all);
        }
    }
}

static inline __attribute__((always_inline)) void
run_body(const tz_source_plane *s, const row_map *m, const taps *t, int32_t n, float *out)
{
    for (int32_t i = 0; i < n; i++) { /* a turned row meets ever new lines */
        const float *p =
            m->origin + t->i[1][i] * s->stride + (int64_t)t->i[0][i] * s->step;
        __builtin_prefetch(p);
        __builtin_prefetch(p + 3 * s->stride);
    }
    if (s->step == 4)
        colour_run(s, m, t, n, out);
    else if (s->step == 1)
        grey_run(s, m, t, n, out);
    else
        lanes_run(s, m, t, n, out);
}

static inline __attribute__((always_inline)) void
points_body(const tz_source_plane *s, const row_map *m, const double *u, const double *v,
            int32_t n, float *out)
{
    taps t;
    for (int32_t from = 0; from < n; from += RUN, out += RUN * s->step) {
        const int32_t run = n - from < RUN ? n - from : RUN;
        for (int axis = 0; axis < 2; axis++)
            for (int32_t k = 0; k < run; k++) {
                float f;
                locate(axis ? v[from + k] * s->sy : u[from + k] * s->sx,
                       axis ? s->height : s->width, &t.i[axis][k], &f);
                t.i[axis][k]--;
                weigh(f, t.w[axis][k]);
            }
        run_body(s, m, &t, run, out);
    }
}

static inline __attribute__((always_inline)) void
spline_row_body(const tz_source_plane *s, const row_map *m, int32_t n, float *out)
{
    taps t;
    for (int32_t from = 0; from < n; from += RUN, out += RUN * s->step) {
        const int32_t run = n - from < RUN ? n - from : RUN;
        find_taps(s, m, m->x + from, run, &t);
        run_body(s, m, &t, run, out);
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

static void points_plain(const tz_source_plane *s, const row_map *m, const double *u,
                         const double *v, int32_t n, float *out)
{
    points_body(s, m, u, v, n, out);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) static void points_avx2(const tz_source_plane *s,
                                                        const row_map *m, const double *u,
                                                        const double *v, int32_t n,
                                                        float *out)
{
    points_body(s, m, u, v, n, out);
}
#endif

void tz_source_points(const tz_source_plane *s, const double *u, const double *v,
                      int32_t n, float *out)
{
    const row_map m = {.origin =
                           s->spline + s->pad * s->stride + (int64_t)s->pad * s->step};
#if defined(__x86_64__)
    if (s->wide) {
        points_avx2(s, &m, u, v, n, out);
        return;
    }
#endif
    points_plain(s, &m, u, v, n, out);
}

static void spline_row(const tz_source_plane *s, const row_map *m, int32_t n, float *out)
{
#if defined(__x86_64__)
    if (s->wide) {
        spline_row_avx2(s, m, n, out);
        return;
    }
#endif
    spline_row_plain(s, m, n, out);
}

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
        const float *row = origin + tz_mirror(sy, s->height) * s->stride;
        for (int32_t i = 0; i < n; i++)
            memcpy(out + (int64_t)i * step,
                   row + (int64_t)tz_mirror(sx + i, s->width) * step,
                   (size_t)step * sizeof *out);
        return;
    }
    const row_map m = {ax, bx, ay, by, x, origin};
    spline_row(s, &m, n, out);
}
