/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The stages of a scene after its generator, and pieces that they share. Private to
 * scenes/. */
#ifndef TZ_SCENES_STAGE_H
#define TZ_SCENES_STAGE_H

#include "scenes/canvas.h"

/** Turns albedo into light that reaches the camera, in place; spoils the relief. */
tz_status tz_scene_light(tz_canvas *c, tz_scene_camera camera);
/** Takes the photo of the lit canvas: fills scene->photo. */
tz_status tz_scene_shoot(tz_canvas *c, tz_scene_camera camera, tz_scene *scene);
/** Segments, pieces and boundaries. */
tz_status tz_scene_truth(tz_canvas *c, tz_scene *scene);

/** Leaves curves one pixel wide, 8-connected, of everything that is not 0. */
tz_status tz_scene_thin(tz_ctx *ctx, uint8_t *mask, int32_t width, int32_t height);
/** Blurs a plane in place: three box filters, about a Gaussian of this deviation. */
tz_status tz_scene_blur(tz_ctx *ctx, float *plane, int32_t width, int32_t height,
                        double sigma);
/** Compresses 8-bit RGB to JPEG and back, in place.
 * @param halved  chroma at half resolution */
tz_status tz_scene_jpeg(tz_ctx *ctx, uint8_t *rgb, int32_t width, int32_t height,
                        int quality, bool halved);

/** Evenly in the logarithm. */
static inline double tz_scene_spread(tz_rng *r, double lo, double hi)
{
    return lo < hi ? lo * exp(log(hi / lo) * tz_rng_unit(r)) : lo;
}
static inline bool tz_scene_chance(tz_rng *r, double p) { return tz_rng_unit(r) < p; }
static inline double tz_scene_clamp(double x, double lo, double hi)
{
    return x < lo ? lo : x > hi ? hi : x;
}
/** 0 below lo, 1 above hi, smooth between. */
static inline double tz_scene_ramp(double x, double lo, double hi)
{
    const double t = tz_scene_clamp((x - lo) / (hi - lo), 0, 1);
    return t * t * (3 - 2 * t);
}

#endif
