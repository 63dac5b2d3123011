/* SPDX-License-Identifier: Apache-2.0 */
/* Brushes of the scenes: noise, colours, skins, lines. Points and cells are in
 * forest_scene_cells.c. */
#include "analysis/forest_scene_canvas.h"

tz_status tz_canvas_add_piece(tz_canvas *c, bool element, int32_t depth, int32_t *id)
{
    const tz_canvas_piece piece = {.element = element, .depth = depth};
    const tz_status s = tz_array_push(c->ctx, &c->piece, piece);
    if (s == TZ_OK)
        *id = c->piece.n - 1;
    return s;
}

/* ---- noise --------------------------------------------------------------------------
 *
 * Each lattice point holds a value and a slope; between them the four straight lines that
 * leave the corners are blended:
 *
 *   n(x) = sum_k blend_k(x) (v_k + g_k . (x - corner_k)),  |v| <= 1/2, |g_k . d| <= 1/2
 *
 * Slopes alone (Perlin) would vanish at every corner, at all octaves in the same places;
 * values alone look like blurred squares. Scenes ask for some ten of these a pixel: the
 * corners come from an integer hash of two products. */

/* 32 slopes: eight directions of four steepnesses, longest 0.7071 / 1.4143. */
#define SLOPES(s)                                                                     \
    {s, 0}, {0.7071f * s, 0.7071f * s}, {0, s}, {-0.7071f * s, 0.7071f * s}, {-s, 0}, \
        {-0.7071f * s, -0.7071f * s}, {0, -s},                                        \
    {                                                                                 \
        0.7071f * s, -0.7071f * s                                                     \
    }
static const float slope[32][2] = {SLOPES(0.5f), SLOPES(0.44f), SLOPES(0.36f),
                                   SLOPES(0.25f)};

static inline uint32_t lattice(uint32_t seed, int32_t i, int32_t j)
{
    uint32_t h = seed + (uint32_t)i * 0x9E3779B1u + (uint32_t)j * 0x85EBCA77u;
    h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
    h = (h ^ (h >> 12)) * 0x297A2D39u;
    return h ^ (h >> 15);
}

static inline float corner(uint32_t seed, int32_t i, int32_t j, float u, float v)
{
    const uint32_t h = lattice(seed, i, j);
    const float *g = slope[h & 31];
    return (float)(int32_t)(h & 0xFFFF00u) * (1.0f / 16777216) - 0.5f + g[0] * u +
           g[1] * v;
}

static inline float fade(float t) { return t * t * (3 - 2 * t); }

static inline int32_t below(double x)
{
    const int32_t i = (int32_t)x;
    return i - (x < i);
}

static inline float noise(uint32_t seed, double x, double y)
{
    const int32_t i = below(x), j = below(y);
    const float u = (float)(x - i), v = (float)(y - j), fu = fade(u), fv = fade(v);
    const float a = corner(seed, i, j, u, v), b = corner(seed, i + 1, j, u - 1, v);
    const float c = corner(seed, i, j + 1, u, v - 1);
    const float d = corner(seed, i + 1, j + 1, u - 1, v - 1);
    const float top = a + fu * (b - a), low = c + fu * (d - c);
    const float n = 1.45f * (top + fv * (low - top)); /* the blend has shrunk it */
    return n > 1 ? 1 : n < -1 ? -1 : n;
}

static inline uint32_t fold(uint64_t seed)
{
    const uint64_t z = (seed ^ (seed >> 29)) * 0xBF58476D1CE4E5B9u;
    return (uint32_t)(z >> 32);
}

/* Coordinates beyond the integers of a lattice only come from broken sizes. */
static inline double sane(double x) { return x > -1e9 && x < 1e9 ? x : 0; }

float tz_canvas_noise(uint64_t seed, double x, double y)
{
    return noise(fold(seed), sane(x), sane(y));
}

static inline float fbm(uint32_t seed, double x, double y, int octaves, float gain)
{
    float sum = 0, weight = 1, total = 0;
    for (int o = 0; o < octaves; o++) {
        sum += weight * noise(seed + (uint32_t)o * 0x632BE5ABu, x, y);
        total += weight;
        weight *= gain;
        x = 2 * x + 0.37; /* lattices of two octaves share no corners */
        y = 2 * y + 0.61;
    }
    return sum / total * (1 + 0.25f * (float)(octaves > 1)); /* sums seldom reach 1 */
}

float tz_canvas_fbm(uint64_t seed, double x, double y, int octaves, double gain)
{
    const int most = octaves < 1 ? 1 : octaves > 12 ? 12 : octaves;
    return fbm(fold(seed), sane(x), sane(y), most, (float)gain);
}

/* ---- colours ------------------------------------------------------------------------ */

static float within(double x, double lo, double hi)
{
    return (float)(x < lo ? lo : x > hi ? hi : x);
}

void tz_canvas_colour(tz_rng *r, const float base[3], double lightness, double hue,
                      float out[3])
{
    const double light = exp(0.6 * lightness * tz_rng_normal(r));
    const double warm = 0.35 * hue * tz_rng_normal(r);  /* red against blue */
    const double green = 0.15 * hue * tz_rng_normal(r); /* green against purple */
    out[0] = within(base[0] * light * (1 + warm), 0.006, 0.92);
    out[1] = within(base[1] * light * (1 + green), 0.006, 0.92);
    out[2] = within(base[2] * light * (1 - warm), 0.006, 0.92);
}

void tz_canvas_base_colour(tz_rng *r, float out[3])
{
    static const float family[][3] = {
        {0.22f, 0.21f, 0.20f}, /* grey stone */
        {0.35f, 0.34f, 0.31f}, /* light grey */
        {0.06f, 0.06f, 0.06f}, /* basalt */
        {0.42f, 0.33f, 0.20f}, /* ochre */
        {0.30f, 0.20f, 0.10f}, /* earth */
        {0.12f, 0.07f, 0.04f}, /* humus */
        {0.32f, 0.11f, 0.06f}, /* brick */
        {0.38f, 0.21f, 0.14f}, /* terracotta */
        {0.55f, 0.49f, 0.38f}, /* limestone */
        {0.62f, 0.60f, 0.56f}, /* chalk */
        {0.16f, 0.19f, 0.07f}, /* moss */
        {0.24f, 0.24f, 0.14f}, /* olive */
        {0.10f, 0.13f, 0.18f}, /* slate */
        {0.23f, 0.20f, 0.26f}, /* porphyry */
    };
    enum { FAMILIES = sizeof family / sizeof *family };
    tz_canvas_colour(r, family[tz_rng_below(r, FAMILIES)], 0.4, 0.35, out);
}

/* ---- skins -------------------------------------------------------------------------- */

static double spread(tz_rng *r, double lo, double hi) /* evenly in the logarithm */
{
    return lo * exp(log(hi / lo) * tz_rng_unit(r));
}

void tz_canvas_skin_draw(tz_rng *r, const float base[3], double size, double rough,
                         tz_canvas_skin *skin)
{
    const double room = size < 12 ? 12 : size;
    *skin = (tz_canvas_skin){.seed = tz_rng_u64(r), .speckle_share = 0.05};
    for (int k = 0; k < 3; k++)
        skin->colour[k] = base[k];
    skin->stain = (float)(rough * tz_rng_range(r, 0.1, 0.8));
    skin->stain_size = room * tz_rng_range(r, 0.15, 0.7);
    skin->grain = (float)(rough * tz_rng_range(r, 0.1, 0.7));
    skin->grain_size = spread(r, 2, room / 4 < 3 ? 3 : room / 4 > 14 ? 14 : room / 4);
    if (tz_rng_unit(r) < 0.5) {
        skin->speckle = (float)(rough * tz_rng_range(r, 0.2, 1));
        skin->speckle_share = spread(r, 0.02, 0.3);
    }
    const double angle = tz_rng_range(r, 0, TZ_PI), wave = spread(r, 3, room / 2);
    if (tz_rng_unit(r) < 0.35)
        skin->streak = (float)(rough * tz_rng_range(r, 0.1, 0.6));
    skin->streak_x = cos(angle) / wave;
    skin->streak_y = sin(angle) / wave;
    skin->bump = (float)(rough * spread(r, 0.15, 1.6));
}

/* Two halves of a stain: blurred clouds, or patches with a border of their own. Which of
 * them, and how the stain is tinted, follows from the seed. */
static float stain_at(const tz_canvas_skin *skin, uint32_t seed, double x, double y)
{
    const float n = fbm(seed + 11, x / skin->stain_size, y / skin->stain_size, 3, 0.55f);
    if ((skin->seed >> 8) & 1)
        return n;
    const float t = within(n * 3.5, -1, 1);
    return 0.6f * t * (1.5f - 0.5f * t * t) + 0.4f * n;
}

/* Along a streak the pattern goes on seven times as long as it is wide. */
static float streak_at(const tz_canvas_skin *skin, uint32_t seed, double x, double y)
{
    const double across = x * skin->streak_x + y * skin->streak_y;
    const double along = (y * skin->streak_x - x * skin->streak_y) / 7;
    return fbm(seed + 37, across, along, 2, 0.6f);
}

static float speckle_at(const tz_canvas_skin *skin, uint32_t seed, double x, double y)
{
    const double size = 0.8 * skin->grain_size + 1;
    const float n = noise(seed + 53, x / size, y / size);
    const float level = 0.75f - 1.5f * (float)skin->speckle_share;
    const float t = within((n - level) * 8, 0, 1);
    return (skin->seed >> 9) & 1 ? t : -t; /* bright ones or dark ones */
}

void tz_canvas_skin_at(tz_canvas *c, const tz_canvas_skin *skin, int32_t x, int32_t y)
{
    const int64_t plane = (int64_t)c->width * c->height, p = (int64_t)y * c->width + x;
    const uint32_t seed = fold(skin->seed);
    const double px = x + 0.5, py = y + 0.5;
    float tone = 0, tint = 0;
    if (skin->stain > 0)
        tint = skin->stain * stain_at(skin, seed, px, py);
    if (skin->grain > 0 || skin->bump > 0) {
        const double size = skin->grain_size < 1 ? 1 : skin->grain_size;
        const float n = fbm(seed + 71, px / size, py / size, 2, 0.7f);
        const float own = (float)(lattice(seed, x, y) >> 8) * 0x1p-24f - 0.5f;
        tone += skin->grain * (0.8f * n + 0.4f * own);
        c->relief[p] += skin->bump * n;
    }
    if (skin->streak > 0)
        tone += skin->streak * streak_at(skin, seed, px, py);
    if (skin->speckle > 0)
        tone += skin->speckle * speckle_at(skin, seed, px, py);
    /* products of contrast: a stain may darken to a fifth, never below nothing */
    const float shade = tone < 0 ? 1 / (1 - tone) : 1 + tone;
    for (int k = 0; k < 3; k++) {
        const float bias = 0.5f + (float)((seed >> (8 * k)) & 255) / 255;
        const float t = tint * bias, stain = t < 0 ? 1 / (1 - 1.3f * t) : 1 + t;
        c->albedo[k * plane + p] = within(skin->colour[k] * shade * stain, 0.004, 0.96);
    }
}

/* ---- lines -------------------------------------------------------------------------- */

/* Part of p + t (q - p) in 0..1 that lies over the canvas and 2 px around it. */
static bool clip(const tz_canvas *c, tz_vec2 p, tz_vec2 q, double *t0, double *t1)
{
    const double from[2] = {p.x, p.y}, way[2] = {q.x - p.x, q.y - p.y};
    const double most[2] = {c->width + 2.0, c->height + 2.0};
    *t0 = 0, *t1 = 1;
    for (int k = 0; k < 2; k++) {
        if (way[k] > -1e-12 && way[k] < 1e-12) {
            if (!(from[k] >= -2 && from[k] <= most[k]))
                return false;
            continue;
        }
        const double a = (-2 - from[k]) / way[k], b = (most[k] - from[k]) / way[k];
        *t0 = fmax(*t0, fmin(a, b));
        *t1 = fmin(*t1, fmax(a, b));
    }
    return *t0 <= *t1; /* false for what is not a number too */
}

void tz_canvas_line(tz_canvas *c, const tz_vec2 *p, int32_t n)
{
    for (int32_t i = 0; i + 1 < n; i++) {
        double t0, t1;
        if (!clip(c, p[i], p[i + 1], &t0, &t1))
            continue;
        const tz_vec2 way = tz_vec2_sub(p[i + 1], p[i]);
        const tz_vec2 a = tz_vec2_add(p[i], tz_vec2_scale(way, t0));
        const tz_vec2 b = tz_vec2_add(p[i], tz_vec2_scale(way, t1));
        const int32_t steps = (int32_t)ceil(fmax(fabs(b.x - a.x), fabs(b.y - a.y)));
        for (int32_t k = 0; k <= steps; k++) {
            const double t = steps ? (double)k / steps : 0;
            const int32_t x = below(a.x + t * (b.x - a.x));
            const int32_t y = below(a.y + t * (b.y - a.y));
            if (x >= 0 && y >= 0 && x < c->width && y < c->height)
                c->line[(int64_t)y * c->width + x] = 1;
        }
    }
}
