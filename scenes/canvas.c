/* SPDX-License-Identifier: Apache-2.0 */
/* Brushes of the scenes: colours, skins, lines. Noise is in noise.c, points
 * and cells are in cells.c. */
#include "scenes/canvas.h"

#include "scenes/noise.h"

tz_status tz_canvas_add_piece(tz_canvas *c, bool element, int32_t depth, int32_t *id)
{
    const tz_canvas_piece piece = {.element = element, .depth = depth};
    const tz_status s = tz_array_push(c->ctx, &c->piece, piece);
    if (s == TZ_OK)
        *id = c->piece.n - 1;
    return s;
}

/* ---- colours ----------------------------------------------------------------------- */

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

/* ---- skins ------------------------------------------------------------------------- */

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
    skin->grain = (float)(rough * tz_rng_range(r, 0.2, 1));
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
    skin->bump = (float)(rough * spread(r, 0.2, 2));
}

enum { STAIN, STREAK, GRAIN, SPECK };

/* Along a streak the pattern goes on seven times as long as it is wide. */
static void ask(const tz_canvas_skin *skin, uint32_t seed, double x, double y, float n[4])
{
    const double wide = 1 / skin->stain_size;
    const double fine = 1 / (skin->grain_size < 1 ? 1 : skin->grain_size);
    const double speck = fine / (0.8 + fine);
    const tz_noise_skin at = {x * wide,
                              y * wide,
                              x * skin->streak_x + y * skin->streak_y,
                              (y * skin->streak_x - x * skin->streak_y) / 7,
                              x * fine,
                              y * fine,
                              x * speck,
                              y * speck};
    tz_noise_of_skin(seed, &at, n);
}

/* Stains are blurred clouds, or patches with a border of their own. Which of them, and
 * how they are tinted, follows from the seed. */
static float stain_of(const tz_canvas_skin *skin, float n)
{
    if ((skin->seed >> 8) & 1)
        return n;
    const float t = within(n * 3.5, -1, 1);
    return 0.6f * t * (1.5f - 0.5f * t * t) + 0.4f * n;
}

static float speckle_of(const tz_canvas_skin *skin, float n)
{
    const float level = 0.75f - 1.5f * (float)skin->speckle_share;
    const float t = within((n - level) * 8, 0, 1);
    return (skin->seed >> 9) & 1 ? t : -t; /* bright ones or dark ones */
}

/* One number a pixel, 0..1: what is finer than all lattices. */
static float dust_at(uint32_t seed, int32_t x, int32_t y)
{
    uint32_t h = seed + (uint32_t)x * 0x9E3779B1u + (uint32_t)y * 0x85EBCA77u;
    h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
    h = (h ^ (h >> 12)) * 0x297A2D39u;
    return (float)(h >> 8) * 0x1p-24f;
}

void tz_canvas_skin_at(tz_canvas *c, const tz_canvas_skin *skin, int32_t x, int32_t y)
{
    const int64_t plane = (int64_t)c->width * c->height, p = (int64_t)y * c->width + x;
    const uint32_t seed = tz_noise_seed(skin->seed);
    float n[4];
    ask(skin, seed, x + 0.5, y + 0.5, n);
    const float dust = dust_at(seed, x, y) - 0.5f;
    const float tone = skin->grain * (0.8f * n[GRAIN] + 0.8f * dust) +
                       skin->streak * n[STREAK] +
                       skin->speckle * speckle_of(skin, n[SPECK]);
    const float tint = skin->stain * stain_of(skin, n[STAIN]);
    c->relief[p] += skin->bump * n[GRAIN];
    /* products of contrast: a stain may darken to a fifth, never below nothing */
    const float shade = tone < 0 ? 1 / (1 - tone) : 1 + tone;
    for (int k = 0; k < 3; k++) {
        const float bias = 0.5f + (float)((seed >> (8 * k)) & 255) / 255;
        const float t = tint * bias, stain = t < 0 ? 1 / (1 - 1.3f * t) : 1 + t;
        c->albedo[k * plane + p] = within(skin->colour[k] * shade * stain, 0.004, 0.96);
    }
}

/* ---- lines ------------------------------------------------------------------------- */

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
            const int32_t x = (int32_t)floor(a.x + t * (b.x - a.x));
            const int32_t y = (int32_t)floor(a.y + t * (b.y - a.y));
            if (x >= 0 && y >= 0 && x < c->width && y < c->height)
                c->line[(int64_t)y * c->width + x] = 1;
        }
    }
}
