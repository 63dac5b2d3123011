/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What stones, bricks, pebbles, cracks and ground share beyond the brushes: families of
 * skins, depth inside of a piece, weather, mapped cells. Private to scenes/. */
#ifndef TZ_SCENES_ROCK_H
#define TZ_SCENES_ROCK_H

#include "scenes/stage.h"

/** Looks of pieces of one kind: a few base colours, how far pieces stray from them, and a
 * pattern that all share or that each draws anew. */
typedef struct tz_rock_family {
    uint64_t seed;
    float base[3][3];
    int32_t bases;
    double lightness, hue, size, rough;
    bool alike;
    tz_canvas_skin skin; /**< of pieces which are alike */
} tz_rock_family;
void tz_rock_family_draw(tz_rng *r, double size, tz_rock_family *f);
tz_canvas_skin tz_rock_skin(const tz_rock_family *f, int32_t id);

/** Dark or light stuff between pieces: earth, sand, mortar, moss, shadow. */
void tz_rock_filler(tz_rng *r, double size, tz_canvas_skin *skin);

/** Distance of each pixel to the border of its piece, px; 0.5 beside it.
 * @param id  width * height  @param[out] depth  width * height */
tz_status tz_rock_depth(tz_canvas *c, const int32_t *id, float *depth);

/** Stains, dirt, lichen that lie over everything and end nowhere in particular; changes
 * albedo only. `depth` NULL, or dirt gathers where it is small. */
void tz_rock_weather(tz_canvas *c, tz_rng *r, double size, const float *depth);

/** How canvas pixels look up cells: warped, then mapped to the plane of the points. */
typedef struct tz_rock_plane {
    tz_affine map;
    double warp, warp_size;
    int octaves; /**< 4 at most */
    double gain;
    uint64_t seed;
} tz_rock_plane;
/** tz_canvas_points over any rectangle. */
tz_status tz_rock_points(tz_canvas *c, tz_rng *r, double gap, tz_vec2 from, tz_vec2 to,
                         tz_vec2 **out, int32_t *n);
/** tz_canvas_cells on any plane; `edge` is in units of that plane, or NULL. */
tz_status tz_rock_cells(tz_canvas *c, const tz_rock_plane *plane, const tz_vec2 *p,
                        const double *weight, int32_t n, int32_t *nearest, float *edge);
/** The box of the canvas seen through a map, `margin` px larger on all sides. */
void tz_rock_box(const tz_canvas *c, tz_affine map, double margin, tz_vec2 *from,
                 tz_vec2 *to);

/** Albedo toward `tint` by share 0..1. */
static inline void tz_rock_mix(tz_canvas *c, int64_t p, const float tint[3], float share)
{
    const int64_t plane = (int64_t)c->width * c->height;
    for (int k = 0; k < 3; k++)
        c->albedo[k * plane + p] += share * (tint[k] - c->albedo[k * plane + p]);
}

#endif
