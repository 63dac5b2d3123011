/* SPDX-License-Identifier: Apache-2.0 */
/* Light of a scene: a sun and a sky over the relief.
 *
 *   light = sky * open + sun * max(0, n . l) * lit + gloss
 *
 * open: how much of the sky a place sees, from the relief against its blur at two
 * scales. lit: cast shadows, by one sweep along the light that carries the height of the
 * shadow's ceiling from row to row; and shadows of things outside of the picture, whose
 * borders are no boundaries. */
#include "scenes/stage.h"

#include <string.h>

typedef struct lamp {
    double x, y;  /* towards the sun, unit, in the plane */
    double climb; /* tangent of its height */
    double height, penumbra;
    float sun[3], sky[3];
    float tilt_x, tilt_y; /* the sky's brighter side */
    double gloss, shine;
    double dark_fine, dark_broad; /* strength of occlusion */
    double slide_x, slide_y;      /* gradient over the picture */
    bool foreign;
    uint64_t seed;
    double cloud, cloud_level, cloud_soft, cloud_stretch;
    double bar_x, bar_y, bar_wide, bar_at; /* a pole's shadow; bar_wide 0 = none */
} lamp;

static void draw_foreign(tz_rng *r, const tz_canvas *c, lamp *l)
{
    const double side = c->width < c->height ? c->width : c->height;
    l->foreign = true;
    l->cloud = tz_scene_spread(r, 0.15, 1.5) * side;
    l->cloud_level = tz_rng_range(r, -0.35, 0.35);
    l->cloud_soft = tz_scene_spread(r, 0.008, 0.4);
    l->cloud_stretch = tz_scene_spread(r, 1, 4);
    const double angle = tz_rng_range(r, 0, TZ_PI);
    l->bar_x = cos(angle);
    l->bar_y = sin(angle);
    l->bar_wide = tz_scene_chance(r, 0.4) ? tz_scene_spread(r, 0.015, 0.15) * side : 0;
    l->bar_at = tz_rng_range(r, -0.4, 0.4) * side + l->bar_x * c->width / 2 +
                l->bar_y * c->height / 2;
}

static lamp draw_lamp(const tz_canvas *c, tz_scene_camera camera)
{
    tz_rng r = tz_rng_make(c->seed, tz_rng_stream(0x119, 0, 0));
    const bool clean = camera == TZ_SCENE_CLEAN;
    lamp l = {.seed = tz_rng_u64(&r)};
    const double angle = tz_rng_range(&r, 0, 2 * TZ_PI);
    const double up = clean ? tz_rng_range(&r, 0.9, 1.1) : tz_rng_range(&r, 0.4, 1.35);
    l.x = cos(angle), l.y = sin(angle), l.climb = tan(up);
    l.height = clean ? 0.7 : tz_scene_spread(&r, 0.45, 1.5);
    l.penumbra = clean ? 6 : tz_scene_spread(&r, 0.5, 6);
    double share = clean ? 0.35 : tz_rng_range(&r, 0.05, 0.85);
    if (!clean && tz_scene_chance(&r, 0.22)) {
        draw_foreign(&r, c, &l);
        share = tz_rng_range(&r, 0.45, 0.9);
    }
    const double warm = clean ? 0.05 : tz_rng_range(&r, -0.05, 0.25);
    for (int k = 0; k < 3; k++) {
        l.sun[k] = (float)(share * (1 + warm * (1 - k)) / sin(up));
        l.sky[k] = (float)((1 - share) * (1 - 0.7 * warm * (1 - k)));
    }
    const double lean = tz_rng_range(&r, 0, 0.5), side = angle + tz_rng_normal(&r);
    l.tilt_x = (float)(lean * cos(side)), l.tilt_y = (float)(lean * sin(side));
    if (!clean && tz_scene_chance(&r, 0.3))
        l.gloss = tz_scene_spread(&r, 0.02, 0.35);
    l.shine = tz_scene_spread(&r, 6, 60);
    l.dark_fine = tz_rng_range(&r, 0.15, clean ? 0.4 : 0.9);
    l.dark_broad = tz_rng_range(&r, 0.15, clean ? 0.4 : 1.1);
    const double slide = clean ? 0 : 0.35 * tz_rng_normal(&r);
    const double way = tz_rng_range(&r, 0, 2 * TZ_PI);
    l.slide_x = slide * cos(way), l.slide_y = slide * sin(way);
    return l;
}

/* ---- occlusion and shadow ---------------------------------------------------------- */

/* Multiplies `open` by what a relief below its surroundings still sees of the sky. */
static tz_status occlude(tz_canvas *c, double sigma, double strength, float *open,
                         float *scratch)
{
    const int64_t n = (int64_t)c->width * c->height;
    const float k = (float)(strength / sigma);
    memcpy(scratch, c->relief, (size_t)n * sizeof *scratch);
    const tz_status s = tz_scene_blur(c->ctx, scratch, c->width, c->height, sigma);
    for (int64_t p = 0; s == TZ_OK && p < n; p++) {
        const float deep = scratch[p] - c->relief[p];
        open[p] *=
            deep > 0 ? 1 / (1 + k * deep) : 1 + 0.15f * k * -deep / (1 + k * -deep);
    }
    return s;
}

/* Shadow of the relief on itself: lit[p] 0..1. `front` is 2 rows of scratch. Lines run
 * across the light's main direction, from the side of the sun. */
static void sweep(const tz_canvas *c, const lamp *l, float *lit, float *front)
{
    const bool along_x = fabs(l->x) >= fabs(l->y);
    const double main = along_x ? l->x : l->y, cross = along_x ? l->y : l->x;
    const int32_t lines = along_x ? c->width : c->height;
    const int32_t items = along_x ? c->height : c->width;
    const int64_t step = along_x ? 1 : c->width, next = along_x ? c->width : 1;
    const double shift = cross / fabs(main);
    const float drop = (float)(sqrt(1 + shift * shift) * l->climb);
    const float soft = (float)(1 / l->penumbra), part = (float)(shift - floor(shift));
    const int32_t whole = (int32_t)floor(shift);
    float *old = front, *now = front + items;
    for (int32_t i = 0; i < items; i++)
        old[i] = -1e6f;
    for (int32_t j = 0; j < lines; j++) {
        const int64_t line = (main > 0 ? lines - 1 - j : j) * step;
        for (int32_t i = 0; i < items; i++) {
            int32_t a = i + whole, b = a + 1;
            a = a < 0 ? 0 : a >= items ? items - 1 : a;
            b = b < 0 ? 0 : b >= items ? items - 1 : b;
            const float roof = old[a] + part * (old[b] - old[a]) - drop;
            const float h = c->relief[line + i * next], dark = (roof - h) * soft;
            lit[line + i * next] = dark <= 0 ? 1 : dark >= 1 ? 0 : 1 - dark;
            now[i] = roof > h ? roof : h;
        }
        float *t = old;
        old = now, now = t;
    }
}

/* Things outside of the picture: foliage, a wall, a pole. */
static float foreign_at(const lamp *l, double x, double y)
{
    const double u = (x * l->bar_x + y * l->bar_y) / l->cloud;
    const double v = (y * l->bar_x - x * l->bar_y) / l->cloud / l->cloud_stretch;
    const float n = tz_canvas_fbm(l->seed, u, v, 3, 0.5);
    double lit = tz_scene_ramp(n - l->cloud_level, -l->cloud_soft, l->cloud_soft);
    if (l->bar_wide > 0) {
        const double bend = 0.5 * l->bar_wide * tz_canvas_noise(l->seed + 1, 3 * v, 0);
        const double d = fabs(x * l->bar_x + y * l->bar_y + bend - l->bar_at);
        const double blur = l->bar_wide * (0.1 + l->cloud_soft);
        lit *= tz_scene_ramp(d, l->bar_wide / 2 - blur, l->bar_wide / 2 + blur);
    }
    return (float)lit;
}

/* ---- shading ----------------------------------------------------------------------- */

static inline float bounded(float x, float most)
{
    return x > most ? most : x < -most ? -most : x;
}

typedef struct glance {
    float facing, sky, shine;
} glance;

static glance look(const tz_canvas *c, const lamp *l, const float sun[3], int32_t x,
                   int32_t y)
{
    const int32_t w = c->width, h = c->height;
    const float *z = c->relief + (int64_t)y * w + x;
    const float dx = bounded(z[x + 1 < w] - z[x > 0 ? -1 : 0], 5) / 2;
    const float dy = bounded(z[y + 1 < h ? w : 0] - z[y > 0 ? -w : 0], 5) / 2;
    const float unit = 1 / sqrtf(1 + dx * dx + dy * dy), nx = -dx * unit, ny = -dy * unit;
    glance g = {.sky = 0.6f + 0.4f * unit + l->tilt_x * nx + l->tilt_y * ny};
    const float f = nx * sun[0] + ny * sun[1] + unit * sun[2];
    g.facing = f > 0 ? f : 0;
    if (l->gloss > 0) { /* half way between sun and a camera straight above */
        const float hz = sun[2] + 1;
        const float half = sqrtf(sun[0] * sun[0] + sun[1] * sun[1] + hz * hz);
        const float s = (nx * sun[0] + ny * sun[1] + unit * hz) / half;
        g.shine = s > 0 ? (float)(l->gloss * pow(s, l->shine)) : 0;
    }
    g.sky = g.sky > 0.1f ? g.sky : 0.1f;
    return g;
}

static void shade(tz_canvas *c, const lamp *l, const float *open, const float *lit)
{
    const int64_t plane = (int64_t)c->width * c->height;
    const double long_way = sqrt(1 + l->climb * l->climb);
    const float sun[3] = {(float)(l->x / long_way), (float)(l->y / long_way),
                          (float)(l->climb / long_way)};
    for (int32_t y = 0; y < c->height; y++)
        for (int32_t x = 0; x < c->width; x++) {
            const int64_t p = (int64_t)y * c->width + x;
            const glance g = look(c, l, sun, x, y);
            const float slide = (float)(1 + l->slide_x * (2.0 * x / c->width - 1) +
                                        l->slide_y * (2.0 * y / c->height - 1));
            float seen = lit[p];
            if (l->foreign)
                seen *= foreign_at(l, x, y);
            for (int k = 0; k < 3; k++) {
                float *a = &c->albedo[k * plane + p];
                const float sunny = l->sun[k] * seen, sky = l->sky[k] * open[p];
                *a = (slide > 0.2f ? slide : 0.2f) *
                     (*a * (sky * g.sky + sunny * g.facing) + sunny * g.shine);
            }
        }
}

tz_status tz_scene_light(tz_canvas *c, tz_scene_camera camera)
{
    const int64_t n = (int64_t)c->width * c->height;
    const int64_t longest = c->width > c->height ? c->width : c->height;
    const lamp l = draw_lamp(c, camera);
    float *open = NULL, *lit = NULL, *front = NULL;
    tz_status s = tz_alloc(c->ctx, &open, (size_t)n, sizeof *open);
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &lit, (size_t)n, sizeof *lit);
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &front, (size_t)(2 * longest), sizeof *front);
    if (s != TZ_OK)
        goto done;
    for (int64_t p = 0; p < n; p++) {
        c->relief[p] *= (float)l.height;
        open[p] = 1;
    }
    s = occlude(c, 3.2, l.dark_fine, open, lit);
    if (s == TZ_OK)
        s = occlude(c, 14, l.dark_broad, open, lit);
    if (s != TZ_OK)
        goto done;
    sweep(c, &l, lit, front);
    shade(c, &l, open, lit);
done:
    tz_free(c->ctx, open);
    tz_free(c->ctx, lit);
    tz_free(c->ctx, front);
    return s;
}
