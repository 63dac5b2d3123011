/* SPDX-License-Identifier: Apache-2.0 */
/* Families of skins, depth inside of pieces, weather. */
#include "scenes/rock.h"

#include <string.h>

/* ---- looks ------------------------------------------------------------------------- */

void tz_rock_family_draw(tz_rng *r, double size, tz_rock_family *f)
{
    *f = (tz_rock_family){.seed = tz_rng_u64(r), .size = size};
    f->bases = tz_scene_chance(r, 0.55) ? 1 : 1 + tz_rng_below(r, 3);
    tz_canvas_base_colour(r, f->base[0]);
    for (int32_t k = 1; k < 3; k++) {
        float other[3];
        tz_canvas_base_colour(r, other);
        const float share = (float)tz_rng_range(r, 0.2, 1);
        for (int i = 0; i < 3; i++)
            f->base[k][i] = f->base[0][i] + share * (other[i] - f->base[0][i]);
    }
    f->lightness = tz_scene_chance(r, 0.25) ? 0.03 : tz_rng_range(r, 0.05, 0.5);
    f->hue = tz_rng_range(r, 0, 0.5);
    f->rough = tz_rng_range(r, 0.3, 1.25);
    f->alike = tz_scene_chance(r, 0.6);
    tz_canvas_skin_draw(r, f->base[0], size, f->rough, &f->skin);
}

tz_canvas_skin tz_rock_skin(const tz_rock_family *f, int32_t id)
{
    tz_rng r = tz_rng_make(f->seed, tz_rng_stream(0xFA, (uint64_t)id, 0));
    tz_canvas_skin skin = f->skin;
    float colour[3];
    tz_canvas_colour(&r, f->base[tz_rng_below(&r, f->bases)], f->lightness, f->hue,
                     colour);
    if (!f->alike)
        tz_canvas_skin_draw(&r, colour, f->size, f->rough, &skin);
    memcpy(skin.colour, colour, sizeof colour);
    skin.seed = tz_rng_u64(&r);
    skin.stain *= (float)tz_rng_range(&r, 0.4, 1.4);
    return skin;
}

void tz_rock_filler(tz_rng *r, double size, tz_canvas_skin *skin)
{
    static const float stuff[][3] = {
        {0.020f, 0.018f, 0.015f}, /* shadow */
        {0.10f, 0.07f, 0.05f},    /* earth */
        {0.30f, 0.25f, 0.17f},    /* sand */
        {0.42f, 0.40f, 0.36f},    /* mortar */
        {0.58f, 0.56f, 0.52f},    /* fresh mortar */
        {0.09f, 0.12f, 0.03f},    /* moss */
        {0.22f, 0.21f, 0.20f},    /* grit */
    };
    enum { STUFF = sizeof stuff / sizeof *stuff };
    float colour[3];
    tz_canvas_colour(r, stuff[tz_rng_below(r, STUFF)], 0.5, 0.3, colour);
    tz_canvas_skin_draw(r, colour, size, tz_rng_range(r, 0.3, 1), skin);
    skin->grain_size = tz_scene_spread(r, 2, 7);
    skin->bump = (float)tz_scene_spread(r, 0.2, 1.6);
}

/* ---- depth --------------------------------------------------------------------------
 *
 * Distance to the nearest pixel beside a border: columns first, then rows by the lower
 * envelope of the parabolas (x - i)^2 + g_i^2 (Felzenszwalb & Huttenlocher's method). */

enum { FAR = 30000 };

static bool at_border(const tz_canvas *c, const int32_t *id, int32_t x, int32_t y)
{
    const int64_t p = (int64_t)y * c->width + x;
    return (x > 0 && id[p - 1] != id[p]) || (x + 1 < c->width && id[p + 1] != id[p]) ||
           (y > 0 && id[p - c->width] != id[p]) ||
           (y + 1 < c->height && id[p + c->width] != id[p]);
}

static void columns(const tz_canvas *c, const int32_t *id, float *depth)
{
    const int64_t w = c->width;
    for (int32_t y = 0; y < c->height; y++)
        for (int32_t x = 0; x < c->width; x++) {
            const int64_t p = y * w + x;
            depth[p] = at_border(c, id, x, y) ? 0 : y > 0 ? depth[p - w] + 1 : FAR;
        }
    for (int32_t y = c->height - 2; y >= 0; y--)
        for (int64_t p = y * w; p < (y + 1) * w; p++)
            depth[p] = depth[p + w] + 1 < depth[p] ? depth[p + w] + 1 : depth[p];
}

/* `g` the row's squared column distances, `top` and `start` scratch of w and w + 1. */
static void envelope(const float *g, int32_t w, int32_t *top, float *start, float *out)
{
    int32_t k = 0;
    top[0] = 0;
    start[0] = -1e9f;
    for (int32_t i = 1; i < w; i++) {
        float cut;
        for (;; k--) { /* where parabola i passes below the last one */
            const int32_t j = top[k];
            cut = ((g[i] - g[j]) / (float)(i - j) + (float)(i + j)) / 2;
            if (k == 0 || cut > start[k])
                break;
        }
        if (k > 0 || cut > start[0])
            k++;
        top[k] = i;
        start[k] = cut;
    }
    for (int32_t x = 0, j = 0; x < w; x++) {
        while (j < k && start[j + 1] < (float)x)
            j++;
        const float d = (float)(x - top[j]);
        out[x] = sqrtf(d * d + g[top[j]]) + 0.5f;
    }
}

tz_status tz_rock_depth(tz_canvas *c, const int32_t *id, float *depth)
{
    const int32_t w = c->width;
    float *row = NULL, *start = NULL;
    int32_t *top = NULL;
    tz_status s = tz_alloc(c->ctx, &row, (size_t)w, sizeof *row);
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &start, (size_t)w + 1, sizeof *start);
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &top, (size_t)w + 1, sizeof *top);
    if (s == TZ_OK) {
        columns(c, id, depth);
        for (int32_t y = 0; y < c->height; y++) {
            float *d = depth + (int64_t)y * w;
            for (int32_t x = 0; x < w; x++)
                row[x] = d[x] * d[x];
            envelope(row, w, top, start, d);
        }
    }
    tz_free(c->ctx, row);
    tz_free(c->ctx, start);
    tz_free(c->ctx, top);
    return s;
}

/* ---- weather ----------------------------------------------------------------------- */

typedef struct coat {
    uint64_t seed;
    float tint[3];
    double size, level, soft;
    float share;
} coat;

static void draw_coat(tz_rng *r, double size, coat *w)
{
    static const float stuff[][3] = {
        {0.03f, 0.028f, 0.024f}, {0.10f, 0.13f, 0.03f}, {0.45f, 0.42f, 0.35f},
        {0.18f, 0.11f, 0.06f},   {0.33f, 0.34f, 0.12f}, {0.55f, 0.55f, 0.52f},
    };
    enum { STUFF = sizeof stuff / sizeof *stuff };
    w->seed = tz_rng_u64(r);
    tz_canvas_colour(r, stuff[tz_rng_below(r, STUFF)], 0.3, 0.2, w->tint);
    w->size = size * tz_scene_spread(r, 0.15, 3);
    w->level = tz_rng_range(r, -0.1, 0.6);
    w->soft = tz_scene_spread(r, 0.05, 0.5);
    w->share = (float)tz_rng_range(r, 0.15, 0.8);
}

void tz_rock_weather(tz_canvas *c, tz_rng *r, double size, const float *depth)
{
    coat coats[2];
    const int32_t n = tz_scene_chance(r, 0.5) ? tz_rng_below(r, 3) : 0;
    for (int32_t k = 0; k < 2; k++)
        draw_coat(r, size, &coats[k]);
    const float dirt = tz_scene_chance(r, 0.4) ? (float)tz_rng_range(r, 0.1, 0.5) : 0;
    const float reach = (float)(size * tz_rng_range(r, 0.02, 0.12) + 2);
    const float brown[3] = {0.06f, 0.05f, 0.035f};
    for (int32_t y = 0; y < c->height && (n > 0 || dirt > 0); y++)
        for (int32_t x = 0; x < c->width; x++) {
            const int64_t p = (int64_t)y * c->width + x;
            for (int32_t k = 0; k < n; k++) {
                const coat *w = &coats[k];
                const float f = tz_canvas_fbm(w->seed, x / w->size, y / w->size, 4, 0.6);
                const double t = tz_scene_ramp(f, w->level, w->level + w->soft);
                tz_rock_mix(c, p, w->tint, w->share * (float)t);
            }
            if (depth && dirt > 0 && depth[p] < 3 * reach) {
                const float t = depth[p] / reach;
                tz_rock_mix(c, p, brown, dirt / (1 + t * t));
            }
        }
}

void tz_rock_box(const tz_canvas *c, tz_affine map, double margin, tz_vec2 *from,
                 tz_vec2 *to)
{
    *from = (tz_vec2){1e30, 1e30}, *to = (tz_vec2){-1e30, -1e30};
    for (int32_t k = 0; k < 4; k++) {
        const tz_vec2 corner = {k & 1 ? c->width : 0, k & 2 ? c->height : 0};
        const tz_vec2 q = tz_affine_apply(map, corner);
        from->x = fmin(from->x, q.x - margin), to->x = fmax(to->x, q.x + margin);
        from->y = fmin(from->y, q.y - margin), to->y = fmax(to->y, q.y + margin);
    }
}
