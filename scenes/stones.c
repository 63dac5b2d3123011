/* SPDX-License-Identifier: Apache-2.0 */
/* Stones: cells of points, with or without weights, alone or joined to irregular bodies;
 * stretched, warped at several scales; between them contact lines, joints or fill. */
#include "scenes/masonry.h"

#include "base/grid.h"

typedef struct plan {
    double stretch, angle;
    bool joined, weighted;
    double spread; /* of weights */
    tz_masonry masonry;
} plan;

typedef struct work {
    tz_vec2 *point; /* of the plane of cells */
    double *weight;
    int32_t points;
    int32_t *stone_of; /* points */
} work;

static void draw_plan(tz_rng *r, const tz_canvas *c, plan *m)
{
    const double side = c->width < c->height ? c->width : c->height;
    tz_masonry *k = &m->masonry;
    k->seed = tz_rng_u64(r);
    k->size = tz_scene_spread(r, 26, tz_scene_clamp(side * 0.6, 30, 380));
    m->stretch = tz_scene_chance(r, 0.5) ? 1 : tz_rng_range(r, 1, 2.6);
    m->angle =
        tz_scene_chance(r, 0.6) ? 0.1 * tz_rng_normal(r) : tz_rng_range(r, 0, TZ_PI);
    m->joined = tz_scene_chance(r, 0.3);
    m->weighted = !m->joined && tz_scene_chance(r, 0.6);
    m->spread = tz_rng_range(r, 0.3, 1.1);
    k->gap = k->size > 44 && tz_scene_chance(r, 0.55);
    k->joint = k->gap ? 8 + k->size * tz_scene_spread(r, 0.01, m->joined ? 0.06 : 0.18)
                      : tz_scene_spread(r, 1, 7);
    k->joint_vary = tz_rng_range(r, 0, k->gap ? 0.6 : 0.9);
    k->corner =
        k->gap ? fmin(k->size * tz_rng_range(r, 0, 0.16), 0.25 * k->size - k->joint / 2)
               : 0;
    k->overgrown = k->gap && tz_scene_chance(r, 0.2) ? tz_rng_range(r, 0.2, 0.9) : 0;
    tz_masonry_draw(r, k);
}

static tz_affine plane_map(const tz_canvas *c, const plan *m)
{
    const double k = sqrt(m->stretch);
    const tz_vec2 centre = {c->width / 2.0, c->height / 2.0};
    const tz_affine turn = tz_affine_place(centre, (tz_vec2){0, 0}, -m->angle, 1, false);
    return tz_affine_then(turn, (tz_affine){1 / k, 0, 0, k, 0, 0});
}

/* Every fine point belongs to the nearest of coarse points; some stay stones of their
 * own: what is left between large bodies. */
static tz_status join(tz_canvas *c, tz_rng *r, double size, work *w, tz_vec2 from,
                      tz_vec2 to, int32_t *stones)
{
    tz_vec2 *coarse = NULL;
    int32_t n = 0, found[64];
    tz_grid g = {0};
    const double small = tz_scene_chance(r, 0.5) ? tz_rng_range(r, 0, 0.4) : 0;
    tz_status s = tz_rock_points(c, r, size, from, to, &coarse, &n);
    if (s == TZ_OK)
        s = tz_grid_init(c->ctx, &g, from, tz_vec2_sub(to, from), size, false);
    for (int32_t i = 0; s == TZ_OK && i < n; i++)
        s = tz_grid_add(c->ctx, &g, coarse[i], &found[0]);
    *stones = n;
    for (int32_t i = 0; s == TZ_OK && i < w->points; i++) {
        const tz_vec2 p = w->point[i];
        int32_t k = tz_grid_query(&g, p, 1.5 * size, found, 64), best = -1;
        double least = 1e30;
        for (k = k < 64 ? k : 64; k > 0; k--) {
            const tz_vec2 d = tz_vec2_sub(p, coarse[found[k - 1]]);
            if (tz_vec2_dot(d, d) < least)
                least = tz_vec2_dot(d, d), best = found[k - 1];
        }
        w->stone_of[i] = best < 0 || tz_scene_chance(r, small) ? (*stones)++ : best;
    }
    tz_grid_deinit(c->ctx, &g);
    tz_free(c->ctx, coarse);
    return s;
}

static tz_status place_stones(tz_canvas *c, tz_rng *r, const plan *m, tz_affine map,
                              work *w, int32_t *stones)
{
    tz_vec2 from, to;
    const double size = m->masonry.size;
    tz_rock_box(c, map, 2 * size, &from, &to);
    const double gap = m->joined ? size * tz_scene_spread(r, 0.16, 0.5) : size * 0.8;
    tz_status s = tz_rock_points(c, r, gap, from, to, &w->point, &w->points);
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &w->stone_of, (size_t)w->points, sizeof *w->stone_of);
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &w->weight, (size_t)w->points, sizeof *w->weight);
    for (int32_t i = 0; s == TZ_OK && i < w->points; i++) {
        const double u = tz_rng_unit(r);
        w->stone_of[i] = i;
        w->weight[i] = size * m->spread * u * u * u;
    }
    *stones = w->points;
    return s == TZ_OK && m->joined ? join(c, r, size, w, from, to, stones) : s;
}

static tz_status find_middles(tz_canvas *c, tz_affine map, const work *w,
                              tz_masonry_map *out)
{
    tz_affine back = tz_affine_identity();
    tz_affine_invert(map, &back);
    const tz_status s =
        tz_alloc_zero(c->ctx, &out->middle, (size_t)out->n, sizeof *out->middle);
    for (int32_t i = w->points - 1; s == TZ_OK && i >= 0; i--)
        out->middle[w->stone_of[i]] = tz_affine_apply(back, w->point[i]);
    return s;
}

static tz_status find_cells(tz_canvas *c, const plan *m, tz_affine map, const work *w,
                            tz_masonry_map *out)
{
    const double size = m->masonry.size;
    tz_rng r = tz_rng_make(m->masonry.seed, 1);
    const tz_rock_plane plane = {.map = map,
                                 .warp = size * tz_rng_range(&r, 0.03, 0.25),
                                 .warp_size = size * tz_rng_range(&r, 0.4, 1.2),
                                 .octaves = 4,
                                 .gain = tz_rng_range(&r, 0.35, 0.6),
                                 .seed = m->masonry.seed};
    const int64_t n = (int64_t)c->width * c->height;
    const tz_status s = tz_rock_cells(c, &plane, w->point, m->weighted ? w->weight : NULL,
                                      w->points, out->id, NULL);
    for (int64_t p = 0; s == TZ_OK && p < n; p++)
        out->id[p] = w->stone_of[out->id[p]];
    return s;
}

tz_status tz_scene_STONES(tz_canvas *c)
{
    plan m = {0};
    work w = {0};
    tz_masonry_map map = {0};
    draw_plan(&c->rng, c, &m);
    const tz_affine plane = plane_map(c, &m);
    tz_status s = tz_masonry_map_init(c, &map);
    if (s == TZ_OK)
        s = place_stones(c, &c->rng, &m, plane, &w, &map.n);
    if (s == TZ_OK)
        s = find_middles(c, plane, &w, &map);
    if (s == TZ_OK)
        s = find_cells(c, &m, plane, &w, &map);
    if (s == TZ_OK && m.masonry.gap)
        s = tz_masonry_cut(c, &m.masonry, &map);
    if (s == TZ_OK)
        s = tz_masonry_paint(c, &c->rng, &m.masonry, &map);
    tz_masonry_map_deinit(c, &map);
    tz_free(c->ctx, w.point);
    tz_free(c->ctx, w.weight);
    tz_free(c->ctx, w.stone_of);
    return s;
}
