/* SPDX-License-Identifier: Apache-2.0 */
/* One pebble or chip.
 *
 * Rounded: outline r(a) = superellipse * (1 + lumps), kept as a table over the
 * pseudo-angle a = y / (|x| + |y|), which needs no arc tangent; height
 * H (1 - (|p| / r)^k)^(1/2). Broken: a heap of half-planes, height the lowest of their
 * slopes and a flat top: facets whose ridges are no boundaries. */
#include "scenes/pebbles.h"

enum { ANGLES = 256, FACETS = 11 };

typedef struct stone {
    tz_vec2 at;
    double cx, cy; /* direction of the long axis */
    double reach, height, power;
    float radius[ANGLES + 1];                                 /* rounded */
    float nx[FACETS], ny[FACETS], off[FACETS], slope[FACETS]; /* broken */
    int32_t facets;
    float top, top_x, top_y;
} stone;

void tz_pebble_bed_draw(tz_rng *r, double size, tz_pebble_bed *bed)
{
    *bed = (tz_pebble_bed){.seed = tz_rng_u64(r), .size = size};
    bed->broken = tz_scene_chance(r, 0.35);
    bed->pressed = tz_scene_chance(r, 0.3);
    bed->spread = tz_rng_range(r, 0.05, 0.55);
    bed->flat = tz_scene_spread(r, 0.25, 0.8);
    bed->flat_vary = tz_rng_range(r, 0, 0.3);
    bed->longish = tz_rng_range(r, 1.05, 2.2);
    bed->lumps = tz_rng_range(r, 0, 0.16);
    bed->bump = tz_scene_spread(r, 0.002, 0.03);
    bed->rise = size * tz_scene_spread(r, 0.02, 0.12);
    tz_rock_family_draw(r, size, &bed->family);
}

/* ---- shape ------------------------------------------------------------------------- */

/* 0..4 once around; rises with the angle. */
static inline float pseudo_angle(float x, float y)
{
    const float s = fabsf(x) + fabsf(y), t = s > 0 ? y / s : 0;
    return x >= 0 ? (t >= 0 ? t : 4 + t) : 2 - t;
}

static void draw_round(tz_rng *r, const tz_pebble_bed *bed, double a, double b, stone *q)
{
    const double n = tz_rng_range(r, 1.9, 3.2);
    double phase[6], size[6];
    for (int k = 0; k < 6; k++) {
        phase[k] = tz_rng_range(r, 0, 2 * TZ_PI);
        size[k] = bed->lumps * tz_rng_normal(r) / (1 + 0.8 * k);
    }
    q->reach = 0;
    for (int32_t i = 0; i <= ANGLES; i++) {
        const double t = 4.0 * i / ANGLES, f = t - floor(t), quarter = floor(t);
        const double x0 = 1 - f, y0 = f; /* on the diamond, then a quarter turn each */
        const double x = quarter == 0 || quarter == 4 ? x0
                         : quarter == 1               ? -y0
                         : quarter == 2               ? -x0
                                                      : y0;
        const double y = quarter == 0 || quarter == 4 ? y0
                         : quarter == 1               ? x0
                         : quarter == 2               ? -y0
                                                      : -x0;
        const double length = sqrt(x * x + y * y), angle = atan2(y, x);
        double lump = 1;
        for (int k = 0; k < 6; k++)
            lump += size[k] * cos((k + 2) * angle + phase[k]);
        const double ex = fabs(x) / length / a, ey = fabs(y) / length / b;
        const double radius = pow(pow(ex, n) + pow(ey, n), -1 / n) * fmax(lump, 0.4);
        q->radius[i] = (float)radius;
        q->reach = fmax(q->reach, radius);
    }
    q->power = tz_rng_range(r, 1.7, 3.2);
}

static void draw_broken(tz_rng *r, double a, double b, stone *q)
{
    q->facets = 5 + tz_rng_below(r, FACETS - 4);
    const double turn = tz_rng_range(r, 0, 2 * TZ_PI);
    for (int32_t k = 0; k < q->facets; k++) {
        const double angle =
            turn + (k + tz_rng_range(r, -0.35, 0.35)) * 2 * TZ_PI / q->facets;
        const double x = cos(angle), y = sin(angle);
        q->nx[k] = (float)x, q->ny[k] = (float)y;
        q->off[k] =
            (float)(sqrt(a * a * x * x + b * b * y * y) * tz_rng_range(r, 0.68, 1));
        q->slope[k] = (float)tz_scene_spread(r, 0.35, 3);
    }
    q->top = (float)q->height;
    q->top_x = (float)(0.25 * tz_rng_normal(r));
    q->top_y = (float)(0.25 * tz_rng_normal(r));
    q->reach = 1.6 * fmax(a, b);
}

static stone draw_stone(const tz_pebble_bed *bed, tz_vec2 at, uint64_t number)
{
    tz_rng r = tz_rng_make(bed->seed, tz_rng_stream(0x9EB, number, 0));
    const double wide = tz_scene_clamp(exp(bed->spread * tz_rng_normal(&r)), 0.35, 2.4);
    const double ratio = sqrt(tz_rng_range(&r, 1, bed->longish));
    const double a = bed->size / 2 * wide * ratio, b = bed->size / 2 * wide / ratio;
    const double angle = tz_rng_range(&r, 0, 2 * TZ_PI);
    stone q = {.at = at, .cx = cos(angle), .cy = sin(angle)};
    q.height = b * bed->flat * (1 + bed->flat_vary * tz_rng_range(&r, -1, 1));
    if (bed->broken)
        draw_broken(&r, a, b, &q);
    else
        draw_round(&r, bed, a, b, &q);
    return q;
}

/* Height above its base at a place of its own axes; negative outside. */
static float height_at(const stone *q, float x, float y)
{
    if (q->facets > 0) {
        float h = q->top + q->top_x * x + q->top_y * y;
        for (int32_t k = 0; k < q->facets; k++) {
            const float in = q->off[k] - q->nx[k] * x - q->ny[k] * y;
            const float wall = in <= 0 ? -1 : 0.15f * q->top + in * q->slope[k];
            h = wall < h ? wall : h;
        }
        return h;
    }
    const float t = pseudo_angle(x, y) * (ANGLES / 4);
    const int32_t i = (int32_t)t, k = i < ANGLES ? i : ANGLES - 1;
    const float r = q->radius[k] + (t - (float)k) * (q->radius[k + 1] - q->radius[k]);
    const float d2 = (x * x + y * y) / (r * r);
    if (d2 >= 1)
        return -1;
    const float fall = powf(d2, (float)q->power / 2);
    return (float)q->height * sqrtf(1 - fall);
}

/* ---- laying ------------------------------------------------------------------------ */

tz_status tz_pebble_lay(tz_canvas *c, const tz_pebble_bed *bed, tz_vec2 at, double base,
                        int32_t depth, uint64_t number)
{
    const stone q = draw_stone(bed, at, number);
    int32_t id;
    const tz_status s = tz_canvas_add_piece(c, true, depth, &id);
    if (s != TZ_OK)
        return s;
    const int32_t x0 = (int32_t)tz_scene_clamp(at.x - q.reach, 0, c->width);
    const int32_t x1 = (int32_t)tz_scene_clamp(at.x + q.reach + 1, 0, c->width);
    const int32_t y0 = (int32_t)tz_scene_clamp(at.y - q.reach, 0, c->height);
    const int32_t y1 = (int32_t)tz_scene_clamp(at.y + q.reach + 1, 0, c->height);
    int64_t whole = 0;
    for (int32_t y = y0; y < y1; y++)
        for (int32_t x = x0; x < x1; x++) {
            const double dx = x + 0.5 - at.x, dy = y + 0.5 - at.y;
            const float own = height_at(&q, (float)(dx * q.cx + dy * q.cy),
                                        (float)(dy * q.cx - dx * q.cy));
            if (own < 0)
                continue;
            const int64_t p = (int64_t)y * c->width + x;
            const float h = (float)base + own;
            whole++;
            if (bed->pressed && h < c->relief[p])
                continue;
            c->segment[p] = id;
            c->relief[p] = h;
        }
    c->piece.v[id].whole = whole;
    return TZ_OK;
}

tz_status tz_pebble_paint(tz_canvas *c, const tz_pebble_bed *bed, int32_t first)
{
    const double wave = bed->size * 0.3;
    const float bump = (float)(bed->bump * bed->size);
    tz_canvas_skin *skin = NULL;
    const int32_t n = c->piece.n - first;
    const tz_status s = tz_alloc(c->ctx, &skin, (size_t)n, sizeof *skin);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < n; i++)
        skin[i] = tz_rock_skin(&bed->family, i);
    for (int32_t y = 0; y < c->height; y++)
        for (int32_t x = 0; x < c->width; x++) {
            const int32_t id = c->segment[(int64_t)y * c->width + x];
            if (id < first)
                continue;
            const uint64_t own = skin[id - first].seed + 5;
            c->relief[(int64_t)y * c->width + x] +=
                bump * tz_canvas_fbm(own, x / wave, y / wave, 4, 0.6);
            tz_canvas_skin_at(c, &skin[id - first], x, y);
        }
    tz_free(c->ctx, skin);
    return TZ_OK;
}
