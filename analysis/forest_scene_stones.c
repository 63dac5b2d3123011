/* SPDX-License-Identifier: Apache-2.0 */
/* Stones: cells of points, with or without weights, alone or joined to irregular bodies;
 * stretched, warped at several scales; between them contact lines, joints or fill. */
#include "analysis/forest_scene_rock.h"

#include "base/grid.h"

typedef struct plan {
    double size, stretch, angle;
    bool joined, weighted;
    double spread;            /* of weights */
    double joint, joint_vary; /* width, px */
    bool gap;                 /* the joint is a piece */
    double corner;            /* radius that corners are rounded to, px */
    double shoulder, height;  /* of the border's profile, px */
    double chip, chip_size;   /* how far the profile's depth wavers */
    double bump, bump_size, crease, tilt, level;
    double fade; /* how much of a contact line may vanish */
    tz_rock_family family;
    tz_canvas_skin filler;
    float contact[3];
    uint64_t seed;
} plan;

typedef struct work {
    tz_vec2 *point; /* of the plane of cells */
    double *weight;
    int32_t points, stones;
    int32_t *stone_of; /* points */
    tz_vec2 *middle;   /* stones: on the canvas */
    int32_t *id;       /* canvas: stone, or -1 in a joint */
    float *depth;
} work;

static void draw_shape(tz_rng *r, const tz_canvas *c, plan *m)
{
    const double side = c->width < c->height ? c->width : c->height;
    m->seed = tz_rng_u64(r);
    m->size = tz_scene_spread(r, 26, tz_scene_clamp(side * 0.6, 30, 380));
    m->stretch = tz_scene_chance(r, 0.5) ? 1 : tz_rng_range(r, 1, 2.6);
    m->angle =
        tz_scene_chance(r, 0.6) ? 0.1 * tz_rng_normal(r) : tz_rng_range(r, 0, TZ_PI);
    m->joined = tz_scene_chance(r, 0.35);
    m->weighted = !m->joined && tz_scene_chance(r, 0.6);
    m->spread = tz_rng_range(r, 0.3, 1.1);
    m->gap = tz_scene_chance(r, 0.5);
    m->joint =
        m->gap ? 8 + m->size * tz_scene_spread(r, 0.02, 0.22) : tz_scene_spread(r, 1, 7);
    m->joint_vary = tz_rng_range(r, 0, 0.9);
    m->corner = m->gap ? m->size * tz_rng_range(r, 0, 0.16) : 0;
}

static void draw_relief(tz_rng *r, plan *m)
{
    const bool round = tz_scene_chance(r, 0.5);
    m->shoulder = round ? m->size * tz_rng_range(r, 0.12, 0.5)
                        : tz_scene_spread(r, 2, fmax(m->size * 0.12, 4));
    m->height = m->shoulder * tz_rng_range(r, 0.3, 1);
    m->height = fmin(m->height, 30);
    m->chip = m->shoulder * tz_rng_range(r, 0, 0.9);
    m->chip_size = tz_scene_spread(r, 5, fmax(m->size * 0.4, 8));
    m->bump = m->size * tz_scene_spread(r, 0.002, 0.05);
    m->bump_size = m->size * tz_scene_spread(r, 0.12, 0.6);
    m->crease = tz_scene_chance(r, 0.4) ? m->bump * tz_rng_range(r, 0.5, 2) : 0;
    m->tilt = tz_rng_range(r, 0, 0.16);
    m->level = tz_rng_range(r, 0, 0.05) * m->size;
    m->fade = tz_scene_chance(r, 0.5) ? tz_rng_range(r, 0, 1) : 0;
    tz_rock_family_draw(r, m->size, &m->family);
    tz_rock_filler(r, m->size * 0.4, &m->filler);
    const float dark[3] = {0.03f, 0.027f, 0.022f};
    tz_canvas_colour(r, tz_scene_chance(r, 0.75) ? dark : m->filler.colour, 0.5, 0.2,
                     m->contact);
}

/* ---- which stone is where ----------------------------------------------------------- */

static tz_affine plane_map(const tz_canvas *c, const plan *m)
{
    const double k = sqrt(m->stretch), x = c->width / 2.0, y = c->height / 2.0;
    const tz_affine turn =
        tz_affine_place((tz_vec2){x, y}, (tz_vec2){0, 0}, -m->angle, 1, false);
    const tz_affine squeeze = {1 / k, 0, 0, k, 0, 0};
    return tz_affine_then(turn, squeeze);
}

/* Every fine point belongs to the nearest of coarse points; some stay stones of their
 * own: what is left between large bodies. */
static tz_status join(tz_canvas *c, tz_rng *r, const plan *m, work *w, tz_vec2 from,
                      tz_vec2 to)
{
    tz_vec2 *coarse = NULL;
    int32_t n = 0, found[64];
    tz_grid g = {0};
    const double small = tz_scene_chance(r, 0.5) ? tz_rng_range(r, 0, 0.4) : 0;
    tz_status s = tz_rock_points(c, r, m->size, from, to, &coarse, &n);
    if (s == TZ_OK)
        s = tz_grid_init(c->ctx, &g, from, tz_vec2_sub(to, from), m->size, false);
    for (int32_t i = 0; s == TZ_OK && i < n; i++)
        s = tz_grid_add(c->ctx, &g, coarse[i], &found[0]);
    w->stones = n;
    for (int32_t i = 0; s == TZ_OK && i < w->points; i++) {
        const tz_vec2 p = w->point[i];
        int32_t k = tz_grid_query(&g, p, 1.5 * m->size, found, 64), best = -1;
        double least = 1e30;
        for (k = k < 64 ? k : 64; k > 0; k--) {
            const tz_vec2 d = tz_vec2_sub(p, coarse[found[k - 1]]);
            if (tz_vec2_dot(d, d) < least)
                least = tz_vec2_dot(d, d), best = found[k - 1];
        }
        w->stone_of[i] = best < 0 || tz_scene_chance(r, small) ? w->stones++ : best;
    }
    tz_grid_deinit(c->ctx, &g);
    tz_free(c->ctx, coarse);
    return s;
}

static tz_status place_stones(tz_canvas *c, tz_rng *r, const plan *m, tz_affine map,
                              work *w)
{
    tz_vec2 from, to;
    tz_rock_box(c, map, 2 * m->size, &from, &to);
    const double gap = m->joined ? m->size * tz_rng_range(r, 0.35, 0.6) : m->size * 0.8;
    tz_status s = tz_rock_points(c, r, gap, from, to, &w->point, &w->points);
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &w->stone_of, (size_t)w->points, sizeof *w->stone_of);
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &w->weight, (size_t)w->points, sizeof *w->weight);
    for (int32_t i = 0; s == TZ_OK && i < w->points; i++) {
        const double u = tz_rng_unit(r);
        w->stone_of[i] = i;
        w->weight[i] = m->size * m->spread * u * u * u;
    }
    w->stones = w->points;
    return s == TZ_OK && m->joined ? join(c, r, m, w, from, to) : s;
}

static tz_status find_middles(tz_canvas *c, tz_affine map, work *w)
{
    tz_affine back = tz_affine_identity();
    tz_affine_invert(map, &back);
    const tz_status s =
        tz_alloc(c->ctx, &w->middle, (size_t)w->stones, sizeof *w->middle);
    for (int32_t i = w->points - 1; s == TZ_OK && i >= 0; i--)
        w->middle[w->stone_of[i]] = tz_affine_apply(back, w->point[i]);
    return s;
}

static tz_status find_cells(tz_canvas *c, const plan *m, tz_affine map, work *w,
                            float *edge)
{
    tz_rng r = tz_rng_make(m->seed, 1);
    const tz_rock_plane plane = {.map = map,
                                 .warp = m->size * tz_rng_range(&r, 0.03, 0.25),
                                 .warp_size = m->size * tz_rng_range(&r, 0.4, 1.2),
                                 .octaves = 4,
                                 .gain = tz_rng_range(&r, 0.35, 0.6),
                                 .seed = m->seed};
    const int64_t n = (int64_t)c->width * c->height;
    const tz_status s = tz_rock_cells(c, &plane, w->point, m->weighted ? w->weight : NULL,
                                      w->points, w->id, edge);
    for (int64_t p = 0; s == TZ_OK && p < n; p++)
        w->id[p] = w->stone_of[w->id[p]];
    return s;
}

/* Cuts the joints out: what is nearer to the border than half their width, which wavers;
 * then gives back what lies within the corner's radius of the rest. */
static tz_status cut_joints(tz_canvas *c, const plan *m, work *w, float *depth)
{
    const int64_t n = (int64_t)c->width * c->height;
    const double long_wave = m->size * 0.8, short_wave = fmax(m->size * 0.12, 5);
    tz_status s = tz_rock_depth(c, w->id, depth);
    for (int64_t p = 0; s == TZ_OK && p < n; p++) {
        if (depth[p] > 2 * (m->joint + m->corner))
            continue;
        const double x = (double)(p % c->width), y = (double)(p / c->width);
        const double wide =
            tz_canvas_noise(m->seed + 5, x / long_wave, y / long_wave) * m->joint_vary;
        const double rough = tz_canvas_noise(m->seed + 6, x / short_wave, y / short_wave);
        const double cut = m->joint / 2 * (1 + wide + 0.25 * rough) + m->corner;
        if (depth[p] < cut)
            w->id[p] = ~w->id[p]; /* remembers whose it was */
    }
    if (s == TZ_OK && m->corner > 1) {
        s = tz_rock_depth(c, w->id, depth);
        for (int64_t p = 0; s == TZ_OK && p < n; p++)
            if (w->id[p] < 0 && depth[p] < m->corner)
                w->id[p] = ~w->id[p];
    }
    return s;
}

/* ---- painting ----------------------------------------------------------------------- */

static tz_status name_pieces(tz_canvas *c, const plan *m, const work *w, int32_t *joint)
{
    int32_t id;
    tz_status s = tz_array_reserve(c->ctx, &c->piece, (int64_t)w->stones + 1);
    for (int32_t i = 0; s == TZ_OK && i < w->stones; i++)
        s = tz_canvas_add_piece(c, true, 1, &id);
    *joint = -1;
    if (s == TZ_OK && m->gap)
        s = tz_canvas_add_piece(c, false, 0, joint);
    return s;
}

/* Height of a stone at a pixel, above its joints. */
static float height_at(const plan *m, const work *w, double x, double y, int64_t p)
{
    const int32_t id = w->id[p];
    tz_rng r = tz_rng_make(m->seed, 0); /* only its mixing is used: no draws */
    const uint64_t own = tz_rng_stream(r.seed, (uint64_t)id, 7);
    const double lean_x = ((double)(own & 1023) / 512 - 1) * m->tilt;
    const double lean_y = ((double)(own >> 10 & 1023) / 512 - 1) * m->tilt;
    const double level = ((double)(own >> 20 & 1023) / 512 - 1) * m->level;
    double d = w->depth[p];
    if (m->chip > 0)
        d += m->chip * tz_canvas_fbm(own, x / m->chip_size, y / m->chip_size, 2, 0.6);
    const double t = 1 - tz_scene_clamp(d / m->shoulder, 0, 1);
    const double bump =
        tz_canvas_fbm(own + 1, x / m->bump_size, y / m->bump_size, 3, 0.5);
    const double lean = lean_x * (x - w->middle[id].x) + lean_y * (y - w->middle[id].y);
    double h = m->height * sqrt(1 - t * t) + level + m->bump * bump +
               tz_scene_clamp(lean, -m->size * 0.1, m->size * 0.1);
    if (m->crease > 0) {
        const double size = m->bump_size * 1.3;
        h -= m->crease * (1 - fabs(tz_canvas_noise(own + 2, x / size, y / size)) * 3);
    }
    return (float)h;
}

/* The dark of a contact line, at its middle 1; it vanishes in places. */
static float contact_at(const plan *m, double x, double y, float depth)
{
    const double n = tz_canvas_noise(m->seed + 9, x / m->size * 1.5, y / m->size * 1.5);
    const double there = 1 - m->fade * tz_scene_ramp(n, -0.3, 0.5);
    const double wide = m->joint / 2 * (1 + 0.5 * m->joint_vary * n) + 0.5;
    return (float)(there * tz_scene_ramp(-depth, -wide - 0.8, -wide + 0.8));
}

static void paint(tz_canvas *c, const plan *m, const work *w, const tz_canvas_skin *skin,
                  int32_t joint)
{
    const float low = (float)(-m->height * 0.25 - m->joint * 0.3);
    for (int32_t y = 0; y < c->height; y++)
        for (int32_t x = 0; x < c->width; x++) {
            const int64_t p = (int64_t)y * c->width + x;
            const bool stone = w->id[p] >= 0;
            c->segment[p] = stone ? w->id[p] : joint;
            c->relief[p] = stone ? height_at(m, w, x, y, p) : low;
            tz_canvas_skin_at(c, stone ? &skin[w->id[p]] : &m->filler, x, y);
            if (stone && !m->gap && w->depth[p] < m->joint + 2) {
                const float t = contact_at(m, x, y, w->depth[p]);
                tz_rock_mix(c, p, m->contact, 0.9f * t);
                c->relief[p] -= t * (float)m->joint * 0.8f;
            }
        }
}

static tz_status build(tz_canvas *c, tz_rng *r, const plan *m, work *w)
{
    const size_t n = (size_t)c->width * (size_t)c->height;
    const tz_affine map = plane_map(c, m);
    tz_canvas_skin *skin = NULL;
    int32_t joint;
    tz_status s = tz_alloc(c->ctx, &w->id, n, sizeof *w->id);
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &w->depth, n, sizeof *w->depth);
    if (s == TZ_OK)
        s = place_stones(c, r, m, map, w);
    if (s == TZ_OK)
        s = find_middles(c, map, w);
    if (s == TZ_OK)
        s = find_cells(c, m, map, w, w->depth);
    if (s == TZ_OK && m->gap)
        s = cut_joints(c, m, w, w->depth);
    if (s == TZ_OK)
        s = tz_rock_depth(c, w->id, w->depth);
    if (s == TZ_OK)
        s = name_pieces(c, m, w, &joint);
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &skin, (size_t)w->stones, sizeof *skin);
    if (s == TZ_OK) {
        for (int32_t i = 0; i < w->stones; i++)
            skin[i] = tz_rock_skin(&m->family, i);
        paint(c, m, w, skin, joint);
        tz_rock_weather(c, r, m->size, w->depth);
    }
    tz_free(c->ctx, skin);
    return s;
}

tz_status tz_scene_STONES(tz_canvas *c)
{
    plan m = {0};
    work w = {0};
    draw_shape(&c->rng, c, &m);
    draw_relief(&c->rng, &m);
    const tz_status s = build(c, &c->rng, &m, &w);
    tz_free(c->ctx, w.point);
    tz_free(c->ctx, w.weight);
    tz_free(c->ctx, w.stone_of);
    tz_free(c->ctx, w.middle);
    tz_free(c->ctx, w.id);
    tz_free(c->ctx, w.depth);
    return s;
}
