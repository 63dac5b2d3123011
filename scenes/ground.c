/* SPDX-License-Identifier: Apache-2.0 */
/* Ground: moss, sand, concrete (noise), grit and leather (fine cells), grass and fibres
 * (strokes). None of what is in them is a boundary: whoever learns from these pictures
 * learns where to keep quiet. At most two grounds meet, or a few stones lie about. */
#include "scenes/ground.h"

#include "scenes/pebbles.h"

enum stuff { NOISE, CELLS, STROKES, STUFFS };

typedef struct soil {
    uint64_t seed;
    tz_canvas_skin skin;
    double heap, heap_size; /* of coarse bumps, px */
    double gain;
    float second[3]; /* colour of other patches, cells, strokes */
    double patch_size, patch_level, patch_soft;
} soil;

static void draw_soil(tz_rng *r, double size, soil *g)
{
    float base[3];
    g->seed = tz_rng_u64(r);
    tz_canvas_base_colour(r, base);
    tz_canvas_skin_draw(r, base, size * 4, tz_rng_range(r, 0.4, 1.2), &g->skin);
    g->skin.grain_size = tz_scene_spread(r, 2, fmax(size * 0.5, 3));
    g->skin.bump = (float)(g->skin.grain_size * tz_scene_spread(r, 0.05, 0.5));
    g->heap = size * tz_scene_spread(r, 0.02, 0.35);
    g->heap_size = size * tz_scene_spread(r, 0.4, 2);
    g->gain = tz_rng_range(r, 0.4, 0.75);
    tz_canvas_colour(r, base, 0.5, 0.6, g->second);
    if (tz_scene_chance(r, 0.4))
        tz_canvas_base_colour(r, g->second);
    g->patch_size = size * tz_scene_spread(r, 0.6, 6);
    g->patch_level = tz_rng_range(r, -0.2, 0.7);
    g->patch_soft = tz_scene_spread(r, 0.05, 0.8);
}

static void paint_noise(tz_canvas *c, const soil *g, const uint8_t *where, uint8_t value)
{
    for (int32_t y = 0; y < c->height; y++)
        for (int32_t x = 0; x < c->width; x++) {
            const int64_t p = (int64_t)y * c->width + x;
            if (where && where[p] != value)
                continue;
            const double u = x / g->heap_size, v = y / g->heap_size;
            c->relief[p] = (float)g->heap * tz_canvas_fbm(g->seed, u, v, 4, g->gain);
            tz_canvas_skin_at(c, &g->skin, x, y);
            const float n =
                tz_canvas_fbm(g->seed + 1, x / g->patch_size, y / g->patch_size, 3, 0.6);
            const double t =
                tz_scene_ramp(n, g->patch_level, g->patch_level + g->patch_soft);
            tz_rock_mix(c, p, g->second, 0.75f * (float)t);
        }
}

/* Grains with a tone of their own, or the net of creases of leather. */
static tz_status add_cells(tz_canvas *c, tz_rng *r, double size, const soil *g,
                           const uint8_t *where, uint8_t value)
{
    const int64_t n = (int64_t)c->width * c->height;
    tz_vec2 *at = NULL;
    int32_t count = 0, *id = NULL;
    float *edge = NULL;
    const double gap = tz_scene_clamp(size, 5, 15);
    const float tone = tz_scene_chance(r, 0.6) ? (float)tz_rng_range(r, 0.2, 1.2) : 0;
    const float dome = (float)(gap * tz_rng_range(r, 0.1, 0.6));
    tz_status s = tz_canvas_points(c, r, gap, gap, &at, &count);
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &id, (size_t)n, sizeof *id);
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &edge, (size_t)n, sizeof *edge);
    if (s == TZ_OK)
        s = tz_canvas_cells(c, at, NULL, count, gap * 0.3, gap, id, edge);
    for (int64_t p = 0; s == TZ_OK && p < n; p++) {
        if (where && where[p] != value)
            continue;
        const uint64_t own = tz_rng_stream(g->seed, (uint64_t)id[p], 3);
        const float t = 1 - (float)tz_scene_clamp(edge[p] / (0.4 * gap), 0, 1);
        c->relief[p] += dome * sqrtf(1 - t * t);
        if (tone > 0) {
            const float light = expf(tone * ((float)(own & 1023) / 512 - 1));
            for (int k = 0; k < 3; k++)
                c->albedo[k * n + p] = fminf(c->albedo[k * n + p] * light, 0.95f);
            tz_rock_mix(c, p, g->second, (float)(own >> 10 & 1023) / 2048);
        }
    }
    tz_free(c->ctx, at);
    tz_free(c->ctx, id);
    tz_free(c->ctx, edge);
    return s;
}

/* ---- strokes ----------------------------------------------------------------------- */

typedef struct stroke {
    tz_vec2 at;
    double angle, bend, length, wide;
    float lift, colour[3];
} stroke;

static void paint_stroke(tz_canvas *c, const stroke *q, const uint8_t *where,
                         uint8_t value)
{
    const int32_t steps = (int32_t)q->length + 1;
    tz_vec2 at = q->at;
    for (int32_t k = 0; k < steps; k++) {
        const double t = (double)k / steps, a = q->angle + q->bend * t;
        const double half = q->wide / 2 * (1 - 0.7 * t);
        const int32_t reach = (int32_t)ceil(half);
        at = (tz_vec2){at.x + cos(a), at.y + sin(a)};
        for (int32_t d = -reach; d <= reach; d++) {
            const int32_t x = (int32_t)floor(at.x - d * sin(a));
            const int32_t y = (int32_t)floor(at.y + d * cos(a));
            if (d > half || d < -half || x < 0 || y < 0 || x >= c->width ||
                y >= c->height)
                continue;
            const int64_t p = (int64_t)y * c->width + x;
            if (where && where[p] != value)
                continue;
            const float round = (float)(q->wide * (1 - d * d / (half * half + 1)));
            c->relief[p] = q->lift * (float)sin(TZ_PI * fmin(t + 0.2, 1)) + 0.5f * round;
            tz_rock_mix(c, p, q->colour, 0.9f);
        }
    }
}

static tz_status add_strokes(tz_canvas *c, tz_rng *r, double size, const soil *g,
                             const uint8_t *where, uint8_t value)
{
    const double length = tz_scene_clamp(size, 8, 60) * tz_scene_spread(r, 1, 3);
    const double wide = tz_scene_spread(r, 1.4, 5), comb = tz_rng_range(r, 0, TZ_PI);
    const double order = tz_scene_chance(r, 0.5) ? tz_rng_range(r, 0.1, 0.8) : 10;
    const double bend = tz_rng_range(r, 0, 1.5), light = tz_rng_range(r, 0.2, 1);
    const double cover = tz_scene_spread(r, 0.4, 2.5);
    const int64_t n =
        (int64_t)(cover * c->width * (double)c->height / (length * wide)) + 1;
    for (int64_t i = 0; i < n; i++) {
        if (i % 1024 == 0 && tz_ctx_cancelled(c->ctx))
            return TZ_CANCELLED;
        stroke q = {.at = {tz_rng_range(r, -length, c->width + length),
                           tz_rng_range(r, -length, c->height + length)}};
        q.angle =
            order > 5 ? tz_rng_range(r, 0, 2 * TZ_PI) : comb + order * tz_rng_normal(r);
        q.bend = bend * tz_rng_normal(r);
        q.length = length * tz_rng_range(r, 0.4, 1);
        q.wide = wide * tz_rng_range(r, 0.6, 1.3);
        q.lift = (float)(size * 0.2 * tz_rng_unit(r) * (double)i / (double)n + 1);
        tz_canvas_colour(r, tz_scene_chance(r, 0.25) ? g->second : g->skin.colour, light,
                         0.3, q.colour);
        paint_stroke(c, &q, where, value);
    }
    return TZ_OK;
}

tz_status tz_ground_paint(tz_canvas *c, tz_rng *r, double size, const uint8_t *where,
                          uint8_t value)
{
    soil g;
    const double grain = tz_scene_clamp(size, 4, 120);
    const enum stuff kind = (enum stuff)tz_rng_below(r, STUFFS);
    draw_soil(r, grain, &g);
    paint_noise(c, &g, where, value);
    if (kind == CELLS)
        return add_cells(c, r, grain * 0.4, &g, where, value);
    return kind == STROKES ? add_strokes(c, r, grain, &g, where, value) : TZ_OK;
}

/* ---- the scene --------------------------------------------------------------------- */

/* Another ground where noise is high, or beyond a wavy line. */
static void part_ground(tz_canvas *c, tz_rng *r, uint8_t *beyond)
{
    const double side = c->width > c->height ? c->width : c->height;
    const double size = side * tz_scene_spread(r, 0.15, 1);
    const double level = tz_rng_range(r, -0.2, 0.3), gain = tz_rng_range(r, 0.3, 0.55);
    const double angle = tz_rng_range(r, 0, 2 * TZ_PI), cx = cos(angle), cy = sin(angle);
    const double slope = tz_scene_chance(r, 0.5) ? tz_scene_spread(r, 1, 6) : 0;
    const uint64_t seed = tz_rng_u64(r);
    for (int32_t y = 0; y < c->height; y++)
        for (int32_t x = 0; x < c->width; x++) {
            const int64_t p = (int64_t)y * c->width + x;
            const double far =
                ((x - c->width / 2.0) * cx + (y - c->height / 2.0) * cy) * slope / side;
            beyond[p] = tz_canvas_fbm(seed, x / size, y / size, 6, gain) + far > level;
        }
}

static tz_status second_ground(tz_canvas *c, tz_rng *r, double size)
{
    const int64_t n = (int64_t)c->width * c->height;
    uint8_t *side = NULL;
    int32_t id;
    tz_status s = tz_alloc(c->ctx, &side, (size_t)n, 1);
    if (s == TZ_OK)
        s = tz_canvas_add_piece(c, false, 0, &id);
    if (s == TZ_OK) {
        part_ground(c, r, side);
        s = tz_ground_paint(c, r, size, side, 1);
    }
    const float lift = (float)tz_rng_range(r, -6, 6);
    for (int64_t p = 0; s == TZ_OK && p < n; p++)
        if (side[p]) {
            c->segment[p] = id;
            c->relief[p] += lift;
        }
    tz_free(c->ctx, side);
    return s;
}

static tz_status few_stones(tz_canvas *c, tz_rng *r)
{
    tz_pebble_bed bed;
    const double side = c->width < c->height ? c->width : c->height;
    const int32_t first = c->piece.n, n = 1 + tz_rng_below(r, 24);
    tz_pebble_bed_draw(r, tz_scene_spread(r, 24, fmax(side * 0.25, 30)), &bed);
    tz_status s = TZ_OK;
    for (int32_t i = 0; s == TZ_OK && i < n; i++) {
        const tz_vec2 at = {tz_rng_range(r, 0, c->width), tz_rng_range(r, 0, c->height)};
        s = tz_pebble_lay(c, &bed, at, tz_rng_range(r, 0, 4), i + 1, (uint64_t)i);
    }
    return s == TZ_OK ? tz_pebble_paint(c, &bed, first) : s;
}

tz_status tz_scene_GROUND(tz_canvas *c)
{
    tz_rng *r = &c->rng;
    const double size = tz_scene_spread(r, 6, 90);
    int32_t id;
    tz_status s = tz_canvas_add_piece(c, false, 0, &id);
    if (s == TZ_OK)
        s = tz_ground_paint(c, r, size, NULL, 0);
    if (s == TZ_OK && tz_scene_chance(r, 0.35))
        s = second_ground(c, r, size * tz_scene_spread(r, 0.5, 2));
    if (s == TZ_OK && tz_scene_chance(r, 0.35))
        s = few_stones(c, r);
    if (s == TZ_OK)
        tz_rock_weather(c, r, size * 4, NULL);
    return s;
}
