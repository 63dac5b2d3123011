/* SPDX-License-Identifier: Apache-2.0 */
/* Pebbles and gravel: layers of single stones from the ground up, each over the last. */
#include "scenes/pebbles.h"

#include "scenes/ground.h"

typedef struct plan {
    tz_pebble_bed bed;
    int32_t layers;
    double crowd; /* gap between stones of a layer, in sizes */
    double last;  /* share of the top layer that is laid */
} plan;

static tz_status lay_layer(tz_canvas *c, tz_rng *r, const plan *m, int32_t layer)
{
    tz_vec2 *at = NULL;
    int32_t n = 0;
    const double share = layer + 1 == m->layers ? m->last : 1;
    tz_status s =
        tz_canvas_points(c, r, m->crowd * m->bed.size, 1.2 * m->bed.size, &at, &n);
    for (int32_t i = 0; s == TZ_OK && i < n; i++) {
        const double base = m->bed.rise * (layer + 0.8 * tz_rng_unit(r));
        if (i % 64 == 0 && tz_ctx_cancelled(c->ctx))
            s = TZ_CANCELLED;
        else if (tz_scene_chance(r, share))
            s = tz_pebble_lay(c, &m->bed, at[i], base, layer * 10000 + i + 1,
                              (uint64_t)c->piece.n);
    }
    tz_free(c->ctx, at);
    return s;
}

tz_status tz_scene_PEBBLES(tz_canvas *c)
{
    plan m = {0};
    tz_rng *r = &c->rng;
    const double side = c->width < c->height ? c->width : c->height;
    const bool gravel = tz_scene_chance(r, 0.3);
    const double size = gravel
                            ? tz_scene_spread(r, 18, 50)
                            : tz_scene_spread(r, 30, tz_scene_clamp(side / 2, 32, 340));
    tz_pebble_bed_draw(r, size, &m.bed);
    m.layers = tz_scene_chance(r, 0.2) ? 1 : 2 + tz_rng_below(r, 3);
    m.crowd = tz_rng_range(r, 0.6, 1.0);
    m.last = tz_rng_range(r, 0.25, 1);
    int32_t ground;
    tz_status s = tz_canvas_add_piece(c, false, 0, &ground);
    if (s == TZ_OK)
        s = tz_ground_paint(c, r, size * 0.3, NULL, 0);
    const int32_t first = c->piece.n;
    for (int32_t k = 0; s == TZ_OK && k < m.layers; k++)
        s = lay_layer(c, r, &m, k);
    if (s == TZ_OK)
        s = tz_pebble_paint(c, &m.bed, first);
    if (s == TZ_OK && tz_scene_chance(r, 0.3))
        tz_rock_weather(c, r, size, NULL);
    return s;
}
