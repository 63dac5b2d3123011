/* SPDX-License-Identifier: Apache-2.0 */
/* Finish of stones and bricks: joints, profile, bumps, skins, contact lines, weather. */
#include "scenes/masonry.h"

void tz_masonry_draw(tz_rng *r, tz_masonry *m)
{
    const bool round = tz_scene_chance(r, 0.45);
    m->shoulder = round ? m->size * tz_rng_range(r, 0.12, 0.5)
                        : tz_scene_spread(r, 2, fmax(m->size * 0.12, 4));
    m->height = fmin(m->shoulder * tz_rng_range(r, 0.3, 1), 30);
    m->chip = m->shoulder * tz_rng_range(r, 0, 0.9);
    m->chip_size = tz_scene_spread(r, 5, fmax(m->size * 0.4, 8));
    m->bump = m->size * tz_scene_spread(r, 0.003, 0.06);
    m->bump_size = m->size * tz_scene_spread(r, 0.12, 0.6);
    m->crease = tz_scene_chance(r, 0.4) ? m->bump * tz_rng_range(r, 0.5, 2) : 0;
    m->tilt = tz_rng_range(r, 0, 0.16);
    m->level = tz_rng_range(r, 0, 0.05) * m->size;
    m->fade = tz_scene_chance(r, 0.5) ? tz_rng_unit(r) : 0;
    m->deep = tz_scene_chance(r, 0.3) ? -m->height * 0.6 /* flush */
                                      : m->height * 0.25 + m->joint * 0.3;
    tz_rock_family_draw(r, m->size, &m->family);
    tz_rock_filler(r, m->size * 0.4, &m->filler);
    const float dark[3] = {0.03f, 0.027f, 0.022f};
    tz_canvas_colour(r, tz_scene_chance(r, 0.75) ? dark : m->filler.colour, 0.5, 0.2,
                     m->contact);
}

tz_status tz_masonry_map_init(tz_canvas *c, tz_masonry_map *w)
{
    const size_t n = (size_t)c->width * (size_t)c->height;
    const tz_status s = tz_alloc(c->ctx, &w->id, n, sizeof *w->id);
    return s == TZ_OK ? tz_alloc(c->ctx, &w->depth, n, sizeof *w->depth) : s;
}

void tz_masonry_map_deinit(tz_canvas *c, tz_masonry_map *w)
{
    tz_free(c->ctx, w->id);
    tz_free(c->ctx, w->depth);
    tz_free(c->ctx, w->middle);
    *w = (tz_masonry_map){0};
}

/* Half the joint's width here, which wavers; where fill creeps over the pieces, more. */
static double cut_at(const tz_masonry *m, double x, double y)
{
    const double long_wave = m->size * 0.8, short_wave = fmax(m->size * 0.12, 5);
    const double wide =
        tz_canvas_noise(m->seed + 5, x / long_wave, y / long_wave) * m->joint_vary;
    const double rough =
        tz_canvas_fbm(m->seed + 6, x / short_wave, y / short_wave, 3, 0.6);
    double cut = m->joint / 2 * (1 + wide + 0.25 * rough);
    if (m->overgrown > 0) {
        const double wave = m->size * 2.2;
        const double creep = tz_canvas_fbm(m->seed + 8, x / wave, y / wave, 3, 0.5);
        const double reach = m->overgrown * m->size * tz_scene_ramp(creep, -0.1, 0.7);
        cut += reach * fmax(0, 0.5 + 0.3 * rough);
    }
    return cut;
}

/* What is nearer to the border than that goes; then what lies within the corner's radius
 * of the rest comes back. */
tz_status tz_masonry_cut(tz_canvas *c, const tz_masonry *m, tz_masonry_map *w)
{
    const int64_t n = (int64_t)c->width * c->height;
    const double most = 1.2 * m->joint + m->corner + m->overgrown * m->size;
    tz_status s = tz_rock_depth(c, w->id, w->depth);
    for (int64_t p = 0; s == TZ_OK && p < n; p++) {
        if (w->depth[p] > most)
            continue;
        const double x = (double)(p % c->width), y = (double)(p / c->width);
        if (w->depth[p] < cut_at(m, x, y) + m->corner)
            w->id[p] = ~w->id[p]; /* remembers whose it was */
    }
    if (s == TZ_OK && m->corner > 1) {
        for (int64_t p = 0; p < n; p++) /* joints of two owners are one thing here */
            c->segment[p] = w->id[p] < 0 ? -1 : w->id[p];
        s = tz_rock_depth(c, c->segment, w->depth);
        for (int64_t p = 0; s == TZ_OK && p < n; p++)
            if (w->id[p] < 0 && w->depth[p] < m->corner)
                w->id[p] = ~w->id[p];
    }
    return s;
}

/* ---- painting ---------------------------------------------------------------------- */

static tz_status name_pieces(tz_canvas *c, const tz_masonry *m, const tz_masonry_map *w,
                             int32_t *joint)
{
    int32_t id;
    tz_status s = tz_array_reserve(c->ctx, &c->piece, (int64_t)w->n + 1);
    for (int32_t i = 0; s == TZ_OK && i < w->n; i++)
        s = tz_canvas_add_piece(c, true, 1, &id);
    *joint = -1;
    if (s == TZ_OK && m->gap)
        s = tz_canvas_add_piece(c, false, 0, joint);
    return s;
}

/* -1..1 out of ten bits of a piece's own number. */
static double part(uint64_t own, int k)
{
    return (double)(own >> (10 * k) & 1023) / 512 - 1;
}

static float height_at(const tz_masonry *m, const tz_masonry_map *w, double x, double y,
                       int64_t p)
{
    const int32_t id = w->id[p];
    const uint64_t own = tz_rng_stream(m->seed, (uint64_t)id, 7);
    const double lean = part(own, 0) * m->tilt * (x - w->middle[id].x) +
                        part(own, 1) * m->tilt * (y - w->middle[id].y);
    double d = w->depth[p];
    if (m->chip > 0 && d < 2 * m->shoulder)
        d += m->chip * tz_canvas_fbm(own, x / m->chip_size, y / m->chip_size, 2, 0.6);
    const double t = 1 - tz_scene_clamp(d / m->shoulder, 0, 1);
    const double bump =
        tz_canvas_fbm(own + 1, x / m->bump_size, y / m->bump_size, 4, 0.6);
    double h = m->height * sqrt(1 - t * t) + part(own, 2) * m->level + m->bump * bump +
               tz_scene_clamp(lean, -m->size * 0.1, m->size * 0.1);
    if (m->crease > 0) {
        const double size = m->bump_size * 1.3;
        h -= m->crease *
             (1 - fabs((double)tz_canvas_noise(own + 2, x / size, y / size)) * 3);
    }
    return (float)h;
}

/* The dark of a contact line, at its middle 1; it vanishes in places. */
static float contact_at(const tz_masonry *m, double x, double y, float depth)
{
    const double n = tz_canvas_noise(m->seed + 9, x / m->size * 1.5, y / m->size * 1.5);
    const double there = 1 - m->fade * tz_scene_ramp(n, -0.3, 0.5);
    const double wide = m->joint / 2 * (1 + 0.5 * m->joint_vary * n) + 0.5;
    return (float)(there * tz_scene_ramp(-depth, -wide - 0.8, -wide + 0.8));
}

static void paint_pixel(tz_canvas *c, const tz_masonry *m, const tz_masonry_map *w,
                        const tz_canvas_skin *skin, int32_t x, int32_t y)
{
    const int64_t p = (int64_t)y * c->width + x;
    const bool inside = w->id[p] >= 0;
    c->relief[p] = inside ? height_at(m, w, x, y, p) : (float)-m->deep;
    tz_canvas_skin_at(c, inside ? &skin[w->id[p]] : &m->filler, x, y);
    if (inside && !m->gap && w->depth[p] < m->joint + 2) {
        const float t = contact_at(m, x, y, w->depth[p]);
        tz_rock_mix(c, p, m->contact, 0.9f * t);
        c->relief[p] -= t * (float)m->joint * 0.8f;
    }
}

tz_status tz_masonry_paint(tz_canvas *c, tz_rng *r, const tz_masonry *m,
                           tz_masonry_map *w)
{
    tz_canvas_skin *skin = NULL;
    int32_t joint;
    tz_status s = tz_rock_depth(c, w->id, w->depth);
    if (s == TZ_OK)
        s = name_pieces(c, m, w, &joint);
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &skin, (size_t)w->n, sizeof *skin);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < w->n; i++)
        skin[i] = tz_rock_skin(&m->family, i);
    for (int32_t y = 0; y < c->height; y++)
        for (int32_t x = 0; x < c->width; x++) {
            const int64_t p = (int64_t)y * c->width + x;
            c->segment[p] = w->id[p] >= 0 ? w->id[p] : m->gap ? joint : ~w->id[p];
            paint_pixel(c, m, w, skin, x, y);
        }
    tz_rock_weather(c, r, m->size, w->depth);
    tz_free(c->ctx, skin);
    return TZ_OK;
}
