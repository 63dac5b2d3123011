/* SPDX-License-Identifier: Apache-2.0 */
/* The loops are compiled twice from one text: for plain registers, and for AVX2 with fused
 * multiply-add. */
#include "analysis/forest_rows.h"

#include <float.h>
#include <math.h>
#include <stddef.h>

#define BINS   TZ_FOREST_BINS
#define COARSE TZ_FOREST_BLUR
#define TAPS   (2 * COARSE + 1)
#define LANES  16

/* ---- colour -------------------------------------------------------------------------- */

#define LEAST_U (88.0F * (1.0F / 270))
#define LEAST_V (134.0F * (1.0F / 270))

void tz_forest_luminance_table(float *t)
{
    const float a = (29.0F * 29.0F * 29.0F) / 27, y0 = 8.0F / a, most = 1.0F / 270;
    for (int i = 0; i < 1024; i++) {
        const float y = (float)i / 1024.0F;
        const float l = y > y0 ? 116 * powf(y, 1.0F / 3.0F) - 16 : y * a;
        t[i] = l * most;
    }
    for (int i = 1024; i < 1024 + 40; i++)
        t[i] = t[1023];
}

static inline __attribute__((always_inline)) void
luv_body(const float *table, const float *rgb, int32_t n, float *const p[3])
{
    float *l = p[0], *u = p[1], *v = p[2];
    const float un = 13 * 0.197833F, vn = 13 * 0.468331F;
    for (int32_t x = 0; x < n; x++) {
        const float r = rgb[3 * x], g = rgb[3 * x + 1], b = rgb[3 * x + 2];
        const float cx = 0.430574F * r + 0.341550F * g + 0.178325F * b;
        const float cy = 0.222015F * r + 0.706655F * g + 0.071330F * b;
        const float cz = 0.020183F * r + 0.129553F * g + 0.939180F * b;
        const float sum = cx + 15 * cy + 3 * cz;
        const float nz = 1.0F / (sum > 0 ? sum : 1e-35F);
        const float light = table[(int32_t)(1024 * cy)];
        l[x] = light;
        u[x] = light * (52 * cx * nz - un) + LEAST_U;
        v[x] = light * (117 * cy * nz - vn) + LEAST_V;
    }
}

/* Means of 2 x 2. */
static inline __attribute__((always_inline)) void
halve_body(const float *above, const float *below, int32_t n, float *out)
{
    for (int32_t x = 0; x < n; x++)
        out[x] =
            (above[2 * x] + above[2 * x + 1] + below[2 * x] + below[2 * x + 1]) * 0.25F;
}

/* ---- gradients ----------------------------------------------------------------------- */

/* Bin of a direction, 0..3 (as float): the angle by a polynomial in the smaller ratio. */
static inline __attribute__((always_inline)) float direction(float x, float y)
{
    const float unit = (float)(180.0 / 3.14159265358979323846);
    const float p1 = 0.9997878412794807F * unit, p3 = -0.3258083974640975F * unit;
    const float p5 = 0.1555786518463281F * unit, p7 = -0.04432655554792128F * unit;
    const float ax = fabsf(x), ay = fabsf(y);
    const float less = ax >= ay ? ay : ax, more = ax >= ay ? ax : ay;
    const float c = less / (more + (float)DBL_EPSILON), c2 = c * c;
    float a = (((p7 * c2 + p5) * c2 + p3) * c2 + p1) * c;
    a = ax >= ay ? a : 90 - a;
    a = x < 0 ? 180 - a : a;
    a = y < 0 ? 360 - a : a;
    a = a / 180 - (y < 0 ? 1.0F : 0.0F);
    a = ax + ay < 1e-5F ? 0.5F : a;
    const float round = 12582912.0F; /* to the nearest whole, halves to even */
    const float bin = (a * BINS + round) - round;
    return bin >= BINS ? 0 : bin;
}

#define RUN 64 /* px whose gradients are kept between two loops */

/* up, at, down: the rows of L, u, v around this one. Two loops, so that both become
 * vectors: the largest gradient of the three, then its size and direction. */
static inline __attribute__((always_inline)) void
gradient_run(const float *const up[3], const float *const at[3],
             const float *const down[3], int32_t from, int32_t n, int32_t left,
             int32_t right, float *restrict magnitude, float *restrict bin)
{
    float gx[RUN], gy[RUN], most[RUN];
    for (int32_t i = 0; i < n; i++)
        gx[i] = gy[i] = 0, most[i] = -1e-5F;
    for (int c = 0; c < 3; c++) {
        const float *row = at[c] + from, *above = up[c] + from, *below = down[c] + from;
        for (int32_t i = 0; i < n; i++) {
            const float dx = row[i + right] - row[i - left], dy = below[i] - above[i];
            const float m = dx * dx + dy * dy;
            const bool larger = m > most[i];
            gx[i] = larger ? dx : gx[i];
            gy[i] = larger ? dy : gy[i];
            most[i] = larger ? m : most[i];
        }
    }
    for (int32_t i = 0; i < n; i++) {
        magnitude[from + i] = sqrtf(most[i]);
        bin[from + i] = direction(gx[i], gy[i]);
    }
}

/* Both ends of a row are doubled. */
static inline __attribute__((always_inline)) void
gradient_body(const float *const up[3], const float *const at[3],
              const float *const down[3], int32_t n, float *magnitude, float *bin)
{
    gradient_run(up, at, down, 0, 1, 0, n > 1, magnitude, bin);
    for (int32_t x = 1; x < n - 1; x += RUN)
        gradient_run(up, at, down, x, n - 1 - x < RUN ? n - 1 - x : RUN, 1, 1, magnitude,
                     bin);
    if (n > 1)
        gradient_run(up, at, down, n - 1, 1, 1, 0, magnitude, bin);
}

/* ---- triangle blurs ------------------------------------------------------------------ */

static const float triangle[TAPS] = {1 / 25.0F, 2 / 25.0F, 3 / 25.0F,
                                     4 / 25.0F, 5 / 25.0F, 4 / 25.0F,
                                     3 / 25.0F, 2 / 25.0F, 1 / 25.0F};

/* Across a row, positions of `step` floats; `padded` has COARSE of them on either side. */
static inline __attribute__((always_inline)) void
blur_across_body(const float *padded, int32_t n, int32_t step, float *out)
{
    for (int32_t i = 0; i < n; i++) {
        float s = triangle[0] * padded[i];
        for (int k = 1; k < TAPS; k++)
            s = __builtin_fmaf(padded[i + k * step], triangle[k], s);
        out[i] = s;
    }
}

/* Down the columns: row[COARSE] is the middle one. */
static inline __attribute__((always_inline)) void
blur_down_body(const float *const row[TAPS], int32_t n, float *out)
{
    for (int32_t i = 0; i < n; i++) {
        float s = row[COARSE][i] * triangle[COARSE];
        for (int k = 1; k <= COARSE; k++)
            s = __builtin_fmaf(row[COARSE + k][i] + row[COARSE - k][i],
                               triangle[COARSE + k], s);
        out[i] = s;
    }
}

static inline __attribute__((always_inline)) void
divide_body(const float *restrict m, int32_t n, float *restrict blurred)
{
    for (int32_t x = 0; x < n; x++)
        blurred[x] = m[x] / (blurred[x] + 0.01F);
}

/* One row and its neighbours, 1/4 1/2 1/4 both ways; products are exact. */
static inline __attribute__((always_inline)) void
blur_three_body(const float *const row[3], int32_t n, float *out)
{
    for (int32_t i = 0; i < n; i++)
        out[i] = row[1][i] * 0.5F + (row[0][i] + row[2][i]) * 0.25F;
}

static inline __attribute__((always_inline)) void
blur_down_lanes_body(const float *const row[TAPS], int32_t n, float *out)
{
    for (int32_t x = 0; x < n; x++) {
        const float *line[TAPS];
        for (int k = 0; k < TAPS; k++)
            line[k] = row[k] + (ptrdiff_t)x * LANES;
        blur_down_body(line, LANES, out + (ptrdiff_t)2 * x * LANES);
    }
}

static inline __attribute__((always_inline)) void
blur_three_lanes_body(const float *const row[3], int32_t n, float *out)
{
    for (int32_t x = 0; x < n; x++) {
        const float *line[3];
        for (int k = 0; k < 3; k++)
            line[k] = row[k] + (ptrdiff_t)x * LANES;
        blur_three_body(line, LANES, out + (ptrdiff_t)2 * x * LANES);
    }
}

/* ---- two compilations ---------------------------------------------------------------- */

/* name, parameters, arguments */
#define ROW_LOOPS(X)                                                                   \
    X(luv, (const float *table, const float *rgb, int32_t n, float *const p[3]),       \
      (table, rgb, n, p))                                                              \
    X(gradient,                                                                        \
      (const float *const up[3], const float *const at[3], const float *const down[3], \
       int32_t n, float *m, float *bin),                                               \
      (up, at, down, n, m, bin))                                                       \
    X(blur_across, (const float *padded, int32_t n, int32_t step, float *out),         \
      (padded, n, step, out))                                                          \
    X(blur_down, (const float *const row[TAPS], int32_t n, float *out), (row, n, out)) \
    X(blur_three, (const float *const row[3], int32_t n, float *out), (row, n, out))   \
    X(blur_down_lanes, (const float *const row[TAPS], int32_t n, float *out),          \
      (row, n, out))                                                                   \
    X(blur_three_lanes, (const float *const row[3], int32_t n, float *out),            \
      (row, n, out))                                                                   \
    X(divide, (const float *m, int32_t n, float *blurred), (m, n, blurred))            \
    X(halve, (const float *above, const float *below, int32_t n, float *out),          \
      (above, below, n, out))

#define PLAIN(name, parameters, arguments) \
    static void name##_plain parameters { name##_body arguments; }
ROW_LOOPS(PLAIN)
#define PLAIN_ENTRY(name, parameters, arguments) .name = name##_plain,
static const tz_forest_rows plain = {ROW_LOOPS(PLAIN_ENTRY)};

#if defined(__x86_64__)
#define WIDE(name, parameters, arguments)                                  \
    __attribute__((target("avx2,fma"))) static void name##_wide parameters \
    {                                                                      \
        name##_body arguments;                                             \
    }
ROW_LOOPS(WIDE)
#define WIDE_ENTRY(name, parameters, arguments) .name = name##_wide,
static const tz_forest_rows wide = {ROW_LOOPS(WIDE_ENTRY)};
#endif

const tz_forest_rows *tz_forest_rows_get(void)
{
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
        return &wide;
#endif
    return &plain;
}

const tz_forest_rows *tz_forest_rows_plain(void) { return &plain; }
