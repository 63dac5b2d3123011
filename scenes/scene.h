/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Scenes: pictures like photos of textures, drawn from nothing, whose true segmentation
 * is known. The edge forest is trained on them; tests take them as ground truth.
 *
 *   generator (<kind>.c) -> canvas, 2 x 2 of its pixels a pixel of the scene
 *     -> light: shading, shadows, occlusion                      light.c
 *     -> camera: box filter to the scene, blur, cast, contrast,
 *        sensor noise, JPEG                                      camera.c
 *     -> truth: segments, instances, boundaries                  truth.c
 *
 * The same kind, size and seed give the same bytes on every machine and thread count. */
#ifndef TZ_SCENES_SCENE_H
#define TZ_SCENES_SCENE_H

#include "base/image.h"

/* name, what it draws */
#define TZ_SCENE_KINDS(X)                                                                \
    X(STONES, "stones")   /* Voronoi and power-diagram stones, with or without joints */ \
    X(BRICKS, "bricks")   /* bricks and setts in bonds */                                \
    X(CRACKS, "cracks")   /* mud and rock, cracks grown as branching fractures */        \
    X(PEBBLES, "pebbles") /* rounded things that overlap, shaded, with shadows */        \
    X(LEAVES, "leaves")   /* outlines with lobes and midribs, in layers */               \
    X(BARK, "bark")       /* plates and furrows */                                       \
    X(VEINS, "veins")     /* bright or dark bands through rock, onyx, marble */          \
    X(SCALES, "scales")   /* overlapping rows: fish, roof, pine cone */                  \
    X(MOSAIC, "mosaic")   /* tiles and shards with grout */                              \
    X(WEAVE, "weave")     /* threads over and under; wicker */                           \
    X(WOOD, "wood")       /* planks, grain, knots */                                     \
    X(STRATA, "strata")   /* layers of rock, broken, slabs */                            \
    X(GROUND, "ground")   /* moss, sand, gravel too fine to be pieces: few boundaries */

typedef enum tz_scene_kind {
#define TZ_SCENE_ENUM(id, name) TZ_SCENE_##id,
    TZ_SCENE_KINDS(TZ_SCENE_ENUM)
#undef TZ_SCENE_ENUM
        TZ_SCENE_COUNT
} tz_scene_kind;

TZ_API const char *tz_scene_kind_name(tz_scene_kind kind);

/** A piece of the scene: stone, brick, leaf, gap, background. */
typedef struct tz_scene_piece {
    bool element;  /**< a thing (stone, leaf); false: joint, ground, gap, background */
    int32_t depth; /**< stacking order: higher lies above lower */
    int32_t area;  /**< visible px of the scene */
    int32_t whole; /**< px if nothing covered it; >= area (frame border not counted) */
    tz_rect box;   /**< of the visible pixels */
} tz_scene_piece;

typedef struct tz_scene {
    tz_scene_kind kind;
    tz_image photo; /**< width x height, 3 channels, sRGB, multiples of 1 / 255 */
    int32_t
        *segment; /**< width * height, ids 0..pieces-1; a piece may be seen in parts */
    uint8_t *boundary; /**< width * height, 1 on a true boundary: curves one pixel wide,
                           8-connected. Between two pieces they run on the pixel whose right or
                           lower neighbour belongs to the other piece; a line (crack, joint,
                           vein) narrower than 4 px has one curve, along its middle */
    tz_scene_piece *piece;
    int32_t pieces;
    tz_ctx *ctx;
} tz_scene;

/** How hard the camera makes it. */
typedef enum tz_scene_camera {
    TZ_SCENE_WILD, /**< drawn from the whole range: blur, noise, JPEG, casts, low contrast */
    TZ_SCENE_CLEAN /**< soft light, sharp, no noise or JPEG: for data/ and element tests */
} tz_scene_camera;

/** @param width, height  16..4096 px
 *  @param[out] scene  replaced; empty on error
 *  @return TZ_OK; TZ_INVALID (size); TZ_NOMEM; TZ_CANCELLED
 *  @cost about 2 us a pixel; runs in the calling thread */
TZ_API tz_status tz_scene_render(tz_ctx *ctx, tz_scene_kind kind, tz_scene_camera camera,
                                 int32_t width, int32_t height, uint64_t seed,
                                 tz_scene *scene);
TZ_API void tz_scene_deinit(tz_scene *scene); /**< takes zeroed */

#endif
