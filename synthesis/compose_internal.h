/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Parts of the compositor: label rasteriser, source sampler, seam correction. Private. */
#ifndef TZ_SYNTHESIS_COMPOSE_INTERNAL_H
#define TZ_SYNTHESIS_COMPOSE_INTERNAL_H

#include <string.h>

#include "synthesis/compose.h"

/** Four channels of a texel; images hold `lanes` of them per pixel. */
typedef float tz_f4 __attribute__((vector_size(16)));

static inline tz_f4 tz_load4(const float *p)
{
    tz_f4 v;
    memcpy(&v, p, sizeof v);
    return v;
}

/** Index 0 .. n - 1 that i means in a row of n continued by mirror images. */
static inline int32_t tz_mirror(int64_t i, int32_t n)
{
    if (n == 1)
        return 0;
    const int64_t period = 2 * (int64_t)n;
    i %= period;
    if (i < 0)
        i += period;
    return (int32_t)(i < n ? i : period - 1 - i);
}

/* ---- sources -------------------------------------------------------------------- */

/** A photo made ready for sampling. Single-channel photos are stored plainly (lanes = 0),
 * others padded to whole lanes. `texel` has a mirrored frame of TZ_SOURCE_PAD px. */
typedef struct tz_source_plane {
    float *texel;  /**< original values, with frame */
    float *spline; /**< cubic B-spline coefficients of texel, with frame; or NULL */
    int32_t width, height, pad;
    int32_t channels, lanes, step; /**< floats a texel */
    int64_t stride;
    bool wide;     /**< 256-bit registers may be used; same bits either way */
    double sx, sy; /**< photo px per layout-source px (maps of another resolution) */
    float *low[2]; /**< means of LOW_CELL[k]^2 cells, dense lanes, (lw+2) x (lh+2) */
    int32_t lw[2], lh[2];
    float lo[TZ_IMAGE_MAX_CHANNELS],
        hi[TZ_IMAGE_MAX_CHANNELS]; /**< range of each channel */
} tz_source_plane;

#define TZ_SOURCE_PAD   4
/** Grid spacings of the seam solve, px, coarse first. */
#define TZ_COARSE       16
#define TZ_FINE         4
/** Jacobi steps on each. */
#define TZ_COARSE_STEPS 24
#define TZ_FINE_STEPS   6

tz_status tz_source_plane_init(tz_ctx *ctx, tz_source_plane *s, const tz_image *photo,
                               int32_t width, int32_t height, bool data, bool spline);
void tz_source_plane_deinit(tz_ctx *ctx, tz_source_plane *s);
/** Value of the low-passed source (level 0: TZ_COARSE, 1: TZ_FINE cells) at source px p,
 * bilinear, clamped; `step` floats. */
void tz_source_low(const tz_source_plane *s, int level, double px, double py, float *out);
/** Row of n samples: layout pixels (x + 0.5 + i, y + 0.5) through `inv` (layout -> source
 * px). `exact` = inv is a translation by whole pixels. */
void tz_source_row(const tz_source_plane *s, tz_affine inv, bool exact, int64_t x,
                   int64_t y, int32_t n, float *out);

/** Samples at n source points (photo px of the layout's size), by the spline. */
void tz_source_points(const tz_source_plane *s, const double *u, const double *v,
                      int32_t n, float *out);

/* ---- labels --------------------------------------------------------------------- */

/** Placement made ready for rasterising. */
typedef struct tz_piece {
    tz_affine inv;         /**< layout px -> source px */
    double x0, y0, x1, y1; /**< bounds of the border in layout px */
    int32_t source;
    bool exact;               /**< translation by whole pixels */
    bool turned;              /**< normals must be turned */
    float n00, n01, n10, n11; /**< linear part of a normal's x, y */
} tz_piece;

/** Buckets of pieces by squares of the layout, ids rising (drawing order). */
typedef struct tz_piece_index {
    int32_t cell, nx, ny;
    int32_t *first; /**< nx * ny + 1 */
    int32_t *id;
} tz_piece_index;

struct tz_composer {
    const tz_layout *layout;
    tz_compose_params params;
    tz_map_kind kind;
    tz_encoding encoding;
    int32_t channels, lanes, step, alpha;
    tz_source_plane *source;
    int32_t sources;
    tz_piece *piece;  /**< one a layout placement */
    tz_point *border; /**< layout.border mapped to layout px, doubles rounded to float */
    double *edge;     /**< border points in layout px, x and y interleaved */
    tz_piece_index index;
    tz_image like; /**< empty image: names, encoding and metadata of the photos */
    tz_ctx *ctx;
};

tz_status tz_piece_index_init(tz_ctx *ctx, const tz_composer *c, tz_piece_index *ix);

/** Labels at points (x0 + (i + 0.5) * spacing, y0 + (j + 0.5) * spacing), i < nx, j < ny.
 * Points outside a plain layout take the label of the nearest inside point's column/row.
 * `scratch` grows as needed. */
typedef struct tz_label_scratch {
    TZ_ARRAY(int32_t)
    id;
    TZ_ARRAY(double)
    cross;
    TZ_ARRAY(int32_t)
    near; /**< pieces that may be the nearest in cell near_cell */
    TZ_ARRAY(int32_t)
    few; /**< and in the small square few_x, few_y of it */
    TZ_ARRAY(double)
    far; /**< distances of `near` while few is made */
    TZ_ARRAY(int32_t)
    turn; /**< one turn of a small torus */
    int32_t near_cell, few_x, few_y;
} tz_label_scratch;
tz_status tz_label_grid(tz_ctx *ctx, const tz_composer *c, int64_t x0, int64_t y0,
                        int32_t spacing, int32_t nx, int32_t ny, int32_t *label,
                        tz_label_scratch *scratch);
void tz_label_scratch_deinit(tz_ctx *ctx, tz_label_scratch *s);

/** On a torus: the shift that brings piece `id`'s copy over layout point p. */
tz_vec2 tz_piece_shift(const tz_composer *c, int32_t id, double px, double py);

/* ---- seam correction ------------------------------------------------------------- */

/** Low-passed source of piece `id` at a layout point, turned if it holds normals. */
void tz_piece_low(const tz_composer *c, int32_t id, int level, double px, double py,
                  float *out);

/** Correction on a grid of nodes around a rectangle. */
typedef struct tz_correction {
    int64_t x0, y0; /**< first node is at (x0 + 0.5 spacing, ...) */
    int32_t spacing, nx, ny;
    int level;           /**< of the low-passed sources */
    int32_t *label;      /**< nx * ny */
    float *c;            /**< nx * ny * step */
    float *spare, *jump; /**< scratch: next iterate, jumps right and down */
    size_t cap;          /**< nodes allocated */
} tz_correction;

/** Solves the coarse grid for all rectangles inside r. */
tz_status tz_correction_coarse(tz_ctx *ctx, const tz_composer *c, tz_rect r,
                               tz_correction *coarse, tz_label_scratch *scratch);
/** Solves the fine grid about r, which lies inside the rectangle of the coarse one. */
tz_status tz_correction_fine(tz_ctx *ctx, const tz_composer *c, tz_rect r,
                             const tz_correction *coarse, tz_correction *fine,
                             tz_label_scratch *scratch);
void tz_correction_deinit(tz_ctx *ctx, tz_correction *g);
/** Grid that holds r with `margin` whole nodes around it. */
void tz_correction_span(tz_correction *g, tz_rect r, int32_t spacing, int32_t margin);
/** Room for its nodes, of `step` floats each. */
tz_status tz_correction_reserve(tz_ctx *ctx, tz_correction *g, int32_t step);
/** Jacobi steps of g->c under g->jump: see compose_blend.c. */
void tz_correction_iterate(tz_correction *g, int32_t step, double decay, int32_t steps);
/** Correction of label `id` at node (i, j): the node's own if the labels agree, else
 * continued through the smooth target image. */
void tz_correction_node(const tz_composer *c, const tz_correction *g, int32_t i,
                        int32_t j, int32_t id, float *out);

#endif
