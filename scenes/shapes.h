/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * More brushes of scenes: bent planes, lattices of cells, cracks, and the book-keeping of
 * pieces of which some may be hidden. Private to scenes/. Lengths: canvas pixels. */
#ifndef TZ_SCENES_SHAPES_H
#define TZ_SCENES_SHAPES_H

#include "scenes/canvas.h"

/* ---- small numbers ----------------------------------------------------------------- */

/** 0..1 named by the seed and two numbers, e.g. a row and a column. */
double tz_shape_unit(uint64_t seed, int64_t a, int64_t b);

static inline double tz_shape_mix(double a, double b, double t)
{
    return a + (b - a) * t;
}
/** 0 below lo, 1 above hi, smooth between. */
static inline double tz_shape_ramp(double lo, double hi, double x)
{
    double t = (x - lo) / (hi - lo);
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    return t * t * (3 - 2 * t);
}
/** exp of a number uniform between log lo and log hi: sizes. */
static inline double tz_shape_log_range(tz_rng *r, double lo, double hi)
{
    return lo * pow(hi / lo, tz_rng_unit(r));
}
static inline bool tz_shape_chance(tz_rng *r, double p) { return tz_rng_unit(r) < p; }

/* ---- colour of one pixel ----------------------------------------------------------- */

/** Pulls the albedo at pixel i towards a colour by share 0..1. */
void tz_shape_tint(tz_canvas *c, int64_t i, const float colour[3], double share);
/** Multiplies the albedo at pixel i. */
void tz_shape_dim(tz_canvas *c, int64_t i, double factor);

/** Paints what lies in a joint of half width `half` px at `edge` px from its middle: full
 * inside, soft over a px or two at its borders. */
void tz_shape_joint(tz_canvas *c, int64_t i, double edge, double half,
                    const float colour[3], double share);

/** Makes a colour lighter or darker, whichever is nearer, until its luminance differs
 * from that of `other` by the factor exp(least): what parts two pieces must part them in
 * a grey photo too. */
void tz_shape_part(float colour[3], const float other[3], double least);
/** A crack that comes and goes: a level set of noise at q, of wavelengths `wave`. Paints
 * it at pixel i, and marks its middle as a line where it can be seen.
 * @param open  0 shut .. 1 wide, changing slowly from pixel to pixel */
void tz_shape_crack(tz_canvas *c, int64_t i, uint64_t seed, tz_vec2 q, tz_vec2 wave,
                    double open, const float colour[3]);

/* ---- things: pieces that may turn out to be hidden --------------------------------- */

typedef struct tz_shape_thing {
    bool element;
    int32_t depth;
    int64_t whole; /* as of a piece; 0 = what is visible */
    int64_t seen;  /* canvas px, set by tz_shape_things_count */
    tz_canvas_skin skin;
} tz_shape_thing;

typedef struct tz_shape_things {
    tz_shape_thing *v;
    int32_t n;
} tz_shape_things;

/** n things, elements of depth 1 until told otherwise. */
tz_status tz_shape_things_init(tz_canvas *c, int32_t n, tz_shape_things *t);
void tz_shape_things_deinit(tz_canvas *c, tz_shape_things *t);
/** Counts the pixels of each; c->segment must hold numbers of things. */
void tz_shape_things_count(const tz_canvas *c, tz_shape_things *t);
/** Makes pieces of the things that are seen and writes their ids to c->segment. */
tz_status tz_shape_things_commit(tz_canvas *c, const tz_shape_things *t);

/* ---- bent planes ------------------------------------------------------------------- */

/** From the canvas to the plane of a pattern: turned, seen aslant, bent round a far
 * centre, then warped by noise. */
typedef struct tz_shape_bend_def {
    double angle;
    double tilt;      /* share of scale lost from one side of the canvas to the other */
    double radius;    /* of rows that run in circles, 0 = straight; > the canvas's side */
    double warp;      /* amplitude, px */
    double warp_size; /* wavelength of the coarsest octave */
    int octaves;
} tz_shape_bend_def;

typedef struct tz_shape_bend {
    float *node; /* x, y of the pattern at every 4th pixel */
    int32_t cols, rows;
    tz_rect box; /* of the pattern, with a margin */
} tz_shape_bend;

/** Straight more often than not, mildly warped; angle within `spread` of 0. */
tz_shape_bend_def tz_shape_bend_draw(tz_rng *r, double spread, double size);
tz_status tz_shape_bend_init(tz_canvas *c, uint64_t seed, const tz_shape_bend_def *def,
                             tz_shape_bend *b);
void tz_shape_bend_deinit(tz_canvas *c, tz_shape_bend *b);
tz_vec2 tz_shape_bend_at(const tz_shape_bend *b, double x, double y);

/* ---- fields ------------------------------------------------------------------------ */

/** tz_canvas_fbm over the canvas, taken at every 4th pixel: for noise whose finest octave
 * is no finer than 16 px. */
typedef struct tz_shape_field {
    float *node;
    int32_t cols;
} tz_shape_field;

tz_status tz_shape_field_init(tz_canvas *c, uint64_t seed, double wave, int octaves,
                              tz_shape_field *f);
void tz_shape_field_deinit(tz_canvas *c, tz_shape_field *f);
double tz_shape_field_at(const tz_shape_field *f, int32_t x, int32_t y);

/* ---- cells ------------------------------------------------------------------------- */

/** Voronoi cells of a jittered lattice, stretched, some of them joined: outlines that are
 * not convex and sizes of 1 : 4. */
typedef struct tz_shape_cells_def {
    double pitch_x, pitch_y;
    double jitter;         /* 0 regular .. 1 */
    bool hex;              /* every second row moved by half a pitch */
    double join_x, join_y; /* chance of being one with the neighbour right, below */
    int join_most;         /* cells in one union at most */
} tz_shape_cells_def;

typedef struct tz_shape_cells {
    tz_shape_cells_def def;
    int32_t cols, rows;
    double x, y;   /* of the lattice's corner */
    float *point;  /* x, y in pitches */
    int32_t *root; /* union of each cell */
} tz_shape_cells;

typedef struct tz_shape_cell {
    int32_t cell, root, other; /* other: the union beyond the nearest border */
    double edge;               /* px to that border */
    double dx, dy;             /* unit vector across the border, outwards */
} tz_shape_cell;

tz_status tz_shape_cells_init(tz_canvas *c, uint64_t seed, tz_rect box,
                              const tz_shape_cells_def *def, tz_shape_cells *cells);
void tz_shape_cells_deinit(tz_canvas *c, tz_shape_cells *cells);
tz_shape_cell tz_shape_cells_at(const tz_shape_cells *cells, double x, double y);

#endif
