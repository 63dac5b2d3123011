/* SPDX-License-Identifier: Apache-2.0 */
/* Noise of a lattice: each lattice point holds a value and a slope; between them the four
 * planes through the corners are blended:
 *
 *   n(x) = sum_k blend_k(x) (v_k + g_k . (x - corner_k)),  |v| <= 1/2, |g| <= (1/2, 1/2)
 *
 * Slopes alone (Perlin) would vanish at every corner, at all octaves in the same places;
 * values alone look like blurred squares. Corners come from an integer hash of two
 * products. Octaves are lanes evaluated side by side, in plain loops that compilers turn
 * into vectors; the wide copies do the same operations on the same numbers. What differs
 * from lane to lane comes from tables: lanes filled one by one would have to pass through
 * memory, which takes as long as the noise. */
#include "scenes/noise.h"

#include "scenes/canvas.h"

enum { LANES = 8 };
/* Constants of the hash: how a step of the lattice or of the octave changes it. */
#define ACROSS 0x9E3779B1u
#define DOWN   0x85EBCA77u
#define STEP   0x632BE5ABu

#if defined(__x86_64__)
#define WIDE __attribute__((target("avx2")))
#define CORE static inline __attribute__((always_inline))
#else
#define CORE static inline
#endif

CORE int32_t below(double x)
{
    const int32_t i = (int32_t)x;
    return i - (x < i);
}

CORE float fade(float t) { return t * t * (3 - 2 * t); }

CORE float bounded(float n) { return n > 1 ? 1 : n < -1 ? -1 : n; }

/* Plane of the corner with this number, at (u, v) from it. */
CORE float corner(uint32_t h, float u, float v)
{
    h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
    h = (h ^ (h >> 12)) * 0x297A2D39u;
    h ^= h >> 15;
    return (float)(int32_t)(h >> 16) * (1.0f / 65536) - 0.5f +
           ((float)(int32_t)(h & 255) * (1.0f / 255) - 0.5f) * u +
           ((float)(int32_t)(h >> 8 & 255) * (1.0f / 255) - 0.5f) * v;
}

CORE float blend(float a, float b, float c, float d, float u, float v)
{
    const float top = a + fade(u) * (b - a), low = c + fade(u) * (d - c);
    return bounded(1.45f * (top + fade(v) * (low - top))); /* the blend has shrunk it */
}

CORE float single(uint32_t seed, double x, double y)
{
    const int32_t i = below(x), j = below(y);
    const float u = (float)(x - i), v = (float)(y - j);
    const uint32_t z = seed + (uint32_t)i * ACROSS + (uint32_t)j * DOWN;
    return blend(corner(z, u, v), corner(z + ACROSS, u - 1, v),
                 corner(z + DOWN, u, v - 1), corner(z + ACROSS + DOWN, u - 1, v - 1), u,
                 v);
}

CORE void eval(int lanes, const uint32_t *seed, const double *x, const double *y,
               float *out)
{
    uint32_t z[LANES];
    float u[LANES], v[LANES], n[4][LANES];
    for (int k = 0; k < lanes; k++) {
        const int32_t i = below(x[k]), j = below(y[k]);
        u[k] = (float)(x[k] - i);
        v[k] = (float)(y[k] - j);
        z[k] = seed[k] + (uint32_t)i * ACROSS + (uint32_t)j * DOWN;
    }
    for (int k = 0; k < lanes; k++)
        n[0][k] = corner(z[k], u[k], v[k]);
    for (int k = 0; k < lanes; k++)
        n[1][k] = corner(z[k] + ACROSS, u[k] - 1, v[k]);
    for (int k = 0; k < lanes; k++)
        n[2][k] = corner(z[k] + DOWN, u[k], v[k] - 1);
    for (int k = 0; k < lanes; k++)
        n[3][k] = corner(z[k] + ACROSS + DOWN, u[k] - 1, v[k] - 1);
    for (int k = 0; k < lanes; k++)
        out[k] = blend(n[0][k], n[1][k], n[2][k], n[3][k], u[k], v[k]);
}

/* ---- octaves ------------------------------------------------------------------------
 *
 * Octave k of x is taken at 2^k x + s_k, so that lattices of two octaves share no
 * corners: s_0 = 0, s_(k+1) = 2 s_k + 0.37. */

static const double times[LANES] = {1, 2, 4, 8, 16, 32, 64, 128};
static const double shift_x[LANES] = {0, 0.37, 1.11, 2.59, 5.55, 11.47, 23.31, 46.99};
static const double shift_y[LANES] = {0, 0.61, 1.83, 4.27, 9.15, 18.91, 38.43, 77.47};
static const uint32_t steps[LANES] = {0,        STEP,     2 * STEP, 3 * STEP,
                                      4 * STEP, 5 * STEP, 6 * STEP, 7 * STEP};

CORE void octaves_of(int lanes, uint32_t seed, double x, double y, float *out)
{
    double u[LANES], v[LANES];
    uint32_t s[LANES];
    for (int k = 0; k < lanes; k++)
        u[k] = x * times[k] + shift_x[k];
    for (int k = 0; k < lanes; k++)
        v[k] = y * times[k] + shift_y[k];
    for (int k = 0; k < lanes; k++)
        s[k] = seed + steps[k];
    eval(lanes, s, u, v, out);
}

CORE void pair_of(uint32_t seed, uint32_t other, double x, double y, float *out)
{
    static const double by[LANES] = {1, 2, 4, 8, 1, 2, 4, 8};
    static const double plus_x[LANES] = {0, 0.37, 1.11, 2.59, 0, 0.37, 1.11, 2.59};
    static const double plus_y[LANES] = {0, 0.61, 1.83, 4.27, 0, 0.61, 1.83, 4.27};
    static const uint32_t add[LANES] = {0, STEP, 2 * STEP, 3 * STEP,
                                        0, STEP, 2 * STEP, 3 * STEP};
    static const uint32_t second[LANES] = {0, 0, 0, 0, 1, 1, 1, 1};
    double u[LANES], v[LANES];
    uint32_t s[LANES];
    for (int k = 0; k < LANES; k++)
        u[k] = x * by[k] + plus_x[k];
    for (int k = 0; k < LANES; k++)
        v[k] = y * by[k] + plus_y[k];
    for (int k = 0; k < LANES; k++)
        s[k] = seed + add[k] + second[k] * (other - seed);
    eval(LANES, s, u, v, out);
}

CORE void skin_of(uint32_t seed, const tz_noise_skin *at, float *out)
{
    const double u[LANES] = {at->stain_x,
                             3 * at->stain_x + 0.37,
                             9 * at->stain_x + 1.11,
                             at->streak_x,
                             2 * at->streak_x + 0.37,
                             at->grain_x,
                             2 * at->grain_x + 0.37,
                             at->speck_x};
    const double v[LANES] = {at->stain_y,
                             3 * at->stain_y + 0.61,
                             9 * at->stain_y + 1.83,
                             at->streak_y,
                             2 * at->streak_y + 0.61,
                             at->grain_y,
                             2 * at->grain_y + 0.61,
                             at->speck_y};
    static const uint32_t add[LANES] = {11,        11 + STEP, 11 + 2 * STEP, 37,
                                        37 + STEP, 71,        71 + STEP,     53};
    uint32_t s[LANES];
    for (int k = 0; k < LANES; k++)
        s[k] = seed + add[k];
    eval(LANES, s, u, v, out);
}

/* ---- copies for wide vectors ------------------------------------------------------- */

#if defined(__x86_64__)
WIDE static void four_wide(uint32_t seed, double x, double y, float *out)
{
    octaves_of(4, seed, x, y, out);
}
WIDE static void eight_wide(uint32_t seed, double x, double y, float *out)
{
    octaves_of(8, seed, x, y, out);
}
WIDE static void pair_wide(uint32_t seed, uint32_t other, double x, double y, float *out)
{
    pair_of(seed, other, x, y, out);
}
WIDE static void skin_wide(uint32_t seed, const tz_noise_skin *at, float *out)
{
    skin_of(seed, at, out);
}
static bool wide(void) { return __builtin_cpu_supports("avx2"); }
#else
#define four_wide  octaves_four
#define eight_wide octaves_eight
#define pair_wide  pair_plain
#define skin_wide  skin_plain
static bool wide(void) { return false; }
#endif

static void octaves_four(uint32_t seed, double x, double y, float *out)
{
    octaves_of(4, seed, x, y, out);
}
static void octaves_eight(uint32_t seed, double x, double y, float *out)
{
    octaves_of(8, seed, x, y, out);
}
static void pair_plain(uint32_t seed, uint32_t other, double x, double y, float *out)
{
    pair_of(seed, other, x, y, out);
}
static void skin_plain(uint32_t seed, const tz_noise_skin *at, float *out)
{
    skin_of(seed, at, out);
}

/* ---- what others call -------------------------------------------------------------- */

uint32_t tz_noise_seed(uint64_t seed)
{
    const uint64_t z = (seed ^ (seed >> 29)) * 0xBF58476D1CE4E5B9u;
    return (uint32_t)(z >> 32);
}

static float sum_of(const float *n, int octaves, float gain)
{
    float sum = 0, weight = 1, total = 0;
    for (int k = 0; k < octaves; k++) {
        sum += weight * n[k];
        total += weight;
        weight *= gain;
    }
    return sum / total * (octaves > 1 ? 1.25f : 1); /* sums seldom reach 1 */
}

void tz_noise_pair(uint32_t seed, uint32_t other, double x, double y, int octaves,
                   float gain, float out[2])
{
    float n[LANES];
    (wide() ? pair_wide : pair_plain)(seed, other, x, y, n);
    out[0] = sum_of(n, octaves, gain);
    out[1] = sum_of(n + 4, octaves, gain);
}

void tz_noise_of_skin(uint32_t seed, const tz_noise_skin *at, float out[4])
{
    float n[LANES];
    (wide() ? skin_wide : skin_plain)(seed, at, n);
    out[0] = (n[0] + 0.7f * n[1] + 0.5f * n[2]) * (1.25f / 2.2f);
    out[1] = (n[3] + 0.6f * n[4]) * (1.25f / 1.6f);
    out[2] = (n[5] + 0.7f * n[6]) * (1.25f / 1.7f);
    out[3] = n[7];
}

/* Coordinates beyond the integers of a lattice only come from broken sizes. */
static double sane(double x) { return x > -1e6 && x < 1e6 ? x : 0; }

float tz_canvas_noise(uint64_t seed, double x, double y)
{
    return single(tz_noise_seed(seed), sane(x), sane(y));
}

float tz_canvas_fbm(uint64_t seed, double x, double y, int octaves, double gain)
{
    const int count = octaves < 1 ? 1 : octaves > LANES ? LANES : octaves;
    const uint32_t own = tz_noise_seed(seed);
    const double u = sane(x), v = sane(y);
    float n[LANES];
    if (count <= 2) {
        n[0] = single(own, u, v);
        n[1] =
            count == 2 ? single(own + STEP, 2 * u + shift_x[1], 2 * v + shift_y[1]) : 0;
    } else if (count <= 4) {
        (wide() ? four_wide : octaves_four)(own, u, v, n);
    } else {
        (wide() ? eight_wide : octaves_eight)(own, u, v, n);
    }
    return sum_of(n, count, (float)gain);
}
