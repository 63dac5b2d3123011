/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Pieces that lie side by side, with joints or bare contact between them: how stones and
 * bricks are finished once it is known which pixel is whose. Private to
 * scenes/. */
#ifndef TZ_SCENES_MASONRY_H
#define TZ_SCENES_MASONRY_H

#include "scenes/rock.h"

typedef struct tz_masonry {
    uint64_t seed;
    double size;
    bool gap;                 /**< joints are a piece; else pieces touch */
    double joint, joint_vary; /**< width, px, and the share of it that wavers */
    double overgrown;         /**< how far the fill creeps over pieces here and there */
    double corner;            /**< radius to which joints round corners, px */
    double shoulder, height;  /**< of the profile along the border, px */
    double chip, chip_size;   /**< how far the profile's start wavers */
    double bump, bump_size, crease, tilt, level;
    double deep; /**< how far joints lie below the border, px */
    double fade; /**< how much of a contact line may vanish, 0..1 */
    tz_rock_family family;
    tz_canvas_skin filler;
    float contact[3];
} tz_masonry;

/** What is whose: pieces 0..n-1, ~piece in a joint. */
typedef struct tz_masonry_map {
    int32_t n;
    int32_t *id;     /**< width * height */
    float *depth;    /**< width * height, scratch at first */
    tz_vec2 *middle; /**< n, about which pieces tilt */
} tz_masonry_map;

/** Draws profile, relief and colours for pieces of m->size with m->joint set. */
void tz_masonry_draw(tz_rng *r, tz_masonry *m);
tz_status tz_masonry_map_init(tz_canvas *c, tz_masonry_map *w);
void tz_masonry_map_deinit(tz_canvas *c, tz_masonry_map *w);
/** Cuts joints of m->joint along the borders of w->id, rounding corners. */
tz_status tz_masonry_cut(tz_canvas *c, const tz_masonry *m, tz_masonry_map *w);
/** Names the pieces and paints all planes. */
tz_status tz_masonry_paint(tz_canvas *c, tz_rng *r, const tz_masonry *m,
                           tz_masonry_map *w);

#endif
