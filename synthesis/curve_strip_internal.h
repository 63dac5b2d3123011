/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Where each place of the canvas comes from: the strip of photo about the nearest line, or
 * the ground; and the blend of both. Not installed. */
#ifndef TZ_SYNTHESIS_CURVE_STRIP_INTERNAL_H
#define TZ_SYNTHESIS_CURVE_STRIP_INTERNAL_H

#include "synthesis/curve_near_internal.h"

/** Source of a place, and how it changes round about. */
typedef struct tz_strip_map {
    double u, v; /**< px of the source */
    float f[4];  /**< du/dx, du/dy, dv/dx, dv/dy; canvas px */
    int32_t
        plane; /**< 0 = the photo of the lines, 1 + k = source k of the ground, -1 = no
                        source */
} tz_strip_map;

typedef struct tz_strips {
    tz_near near;
    tz_bezier *from; /**< per piece: its line in the photo, px */
    struct tz_strip_end {
        tz_vec2 at, from;  /**< unit tangents, on the canvas and in the photo */
    } * end;               /**< per piece: at its beginning and its end */
    tz_curve_taper *half;  /**< per piece: half its width, photo px */
    double shrink;         /**< photo px a canvas px */
    double strip;          /**< photo px to either side, over half the width; < 0 = all */
    double guard;          /**< photo px about another line that are not carried along */
    int32_t width, height; /**< of the photo as the lines know it */
    float *apart;          /**< distance of each photo px to the nearest of all lines */
    tz_source_plane photo;
    const tz_composer *ground; /**< NULL = none */
    tz_map_kind kind;
    int32_t channels; /**< of the sources */
    double decay;
} tz_strips;

/** @param map     what is shown: the photo, or another map of it
 *  @param ground  NULL = none */
tz_status tz_strips_init(tz_ctx *ctx, const tz_curve_set *set,
                         const tz_curve_canvas *canvas, const tz_image *photo,
                         const tz_image *map, const tz_composer *ground, tz_map_kind kind,
                         double strip, tz_strips *s);
void tz_strips_deinit(tz_ctx *ctx, tz_strips *s); /**< takes zeroed */

/** Scratch of a worker. */
typedef struct tz_strip_work {
    tz_near_scratch near;
    tz_label_scratch labels;
    tz_near_place *place;
    int32_t *label;
    size_t room;          /**< of place and label */
    tz_strip_map *map[3]; /**< of the coarse grid, the fine one, and pixels */
    size_t maps[3];       /**< room */
    tz_correction grid[2];
    double *u, *v;
    tz_f4 *row, *low; /**< samples of a row */
    float *texel;
    uint8_t *seam; /**< per pixel: a seam is near */
} tz_strip_work;

void tz_strip_work_deinit(tz_ctx *ctx, tz_strip_work *w); /**< takes zeroed */

/** Sources at places x0 + (i + 0.5) spacing, y0 + (j + 0.5) spacing. */
tz_status tz_strip_maps(tz_ctx *ctx, const tz_strips *s, int64_t x0, int64_t y0,
                        int32_t spacing, int32_t nx, int32_t ny, tz_strip_map *out,
                        tz_strip_work *w);
static inline const tz_source_plane *tz_strip_plane(const tz_strips *s, int32_t plane)
{
    return plane == 0 ? &s->photo : &s->ground->source[plane - 1];
}
/** Solves the coarse grid for all tiles inside r. */
tz_status tz_strip_coarse(tz_ctx *ctx, const tz_strips *s, tz_rect r, tz_strip_work *w);
/** Pixels of a tile of up to TZ_CURVE_TILE px into `out`, the picture of rect. */
tz_status tz_strip_tile(tz_ctx *ctx, const tz_strips *s, tz_rect tile, tz_rect rect,
                        tz_image *out, tz_strip_work *w);

#endif
