/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What a generator of scenes paints on, and the brushes that generators share. Lengths
 * are canvas pixels: 2 make a pixel of the scene. Private to scenes/. */
#ifndef TZ_SCENES_CANVAS_H
#define TZ_SCENES_CANVAS_H

#include "base/array.h"
#include "base/geom.h"
#include "base/rng.h"
#include "scenes/scene.h"

typedef struct tz_canvas_piece {
    bool element;
    int32_t depth;
    int64_t whole; /* canvas px if nothing covered it; 0 = what is visible */
} tz_canvas_piece;

/** All planes width * height. A generator fills every pixel of segment, relief and albedo;
 * light, gloss and camera are not its business. */
typedef struct tz_canvas {
    int32_t width, height;
    int32_t *segment; /**< piece ids, 0..piece.n-1 */
    float *relief;    /**< height above the ground, canvas px: steps cast shadows */
    float *albedo;    /**< planes R, G, B, linear, 0..1 */
    uint8_t *line;    /**< 1 along the middle of lines narrower than 8 canvas px (cracks,
                         joints, veins) that are boundaries; such lines have no segment of
                         their own. Zero at the start */
    TZ_ARRAY(tz_canvas_piece)
    piece;
    tz_ctx *ctx;
    uint64_t seed;
    tz_rng rng; /**< the generator's draws of the whole scene */
} tz_canvas;

typedef tz_status (*tz_scene_generator)(tz_canvas *c);

/* one a kind, in <kind>.c or with its relatives */
#define TZ_SCENE_DECLARE(id, name) tz_status tz_scene_##id(tz_canvas *c);
TZ_SCENE_KINDS(TZ_SCENE_DECLARE)
#undef TZ_SCENE_DECLARE

/* ---- brushes ------------------------------------------------------------------------ */

tz_status tz_canvas_add_piece(tz_canvas *c, bool element, int32_t depth, int32_t *id);

/** Smooth noise of unit lattice, -1..1, mean 0, the same on every machine. */
float tz_canvas_noise(uint64_t seed, double x, double y);
/** Sum of octaves, each twice as fine and `gain` as strong; about -1..1. */
float tz_canvas_fbm(uint64_t seed, double x, double y, int octaves, double gain);

/** A mineral or organic colour, linear RGB: drawn around `base` with spread in lightness
 * and in hue, 0..1 each. */
void tz_canvas_colour(tz_rng *r, const float base[3], double lightness, double hue,
                      float out[3]);
/** Base colour from families seen in nature: greys, ochres, reds, greens, blues. */
void tz_canvas_base_colour(tz_rng *r, float out[3]);

/** Marks of the inside of a piece that are no boundaries: stains, grains, speckles,
 * streaks, at scales from 2 px to the piece's size. Drawn once a piece. */
typedef struct tz_canvas_skin {
    uint64_t seed;
    float colour[3];
    float stain, grain, speckle, streak; /**< contrast of each, 0..1 */
    double stain_size, grain_size, speckle_share;
    double streak_x, streak_y; /**< direction across streaks, 1 / wavelength */
    float bump;                /**< px of relief that goes with the grain */
} tz_canvas_skin;
/** @param size    of the piece, px; rough 0..1: how loud its inside is */
void tz_canvas_skin_draw(tz_rng *r, const float base[3], double size, double rough,
                         tz_canvas_skin *skin);
/** Writes albedo, and adds bump to the relief, at one pixel. */
void tz_canvas_skin_at(tz_canvas *c, const tz_canvas_skin *skin, int32_t x, int32_t y);

/** Points of a disc no two of which are nearer than `gap` (dart throwing on a grid), over
 * the canvas and `margin` px around it.
 * @param[out] out  replaced, count in *n; free with tz_free */
tz_status tz_canvas_points(tz_canvas *c, tz_rng *r, double gap, double margin,
                           tz_vec2 **out, int32_t *n);
/** Nearest and second nearest of weighted points (power diagram: d^2 - w^2), after a warp
 * of the plane by noise of `warp` px amplitude and `warp_size` px wavelength.
 * @param weight       NULL = Voronoi
 * @param[out] nearest width * height ids of points
 * @param[out] edge    width * height: distance to the border of the cell, px */
tz_status tz_canvas_cells(tz_canvas *c, const tz_vec2 *p, const double *weight, int32_t n,
                          double warp, double warp_size, int32_t *nearest, float *edge);

/** Sets `line` along a polyline (8-connected). */
void tz_canvas_line(tz_canvas *c, const tz_vec2 *p, int32_t n);

#endif
