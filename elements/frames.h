/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Local frames over a domain: which way the exemplar's x axis points at each place. An
 * arrangement turns with them. Immutable once made, read from any thread.
 * @source [Ma11] Sec. 4.4 Eq. (7): local orientation */
#ifndef TZ_ELEMENTS_FRAMES_H
#define TZ_ELEMENTS_FRAMES_H

#include "base/ctx.h"
#include "elements/raster.h"

typedef struct tz_frames {
    tz_raster raster;
    float *x, *y; /**< unit vectors; bilinear between, so that they never flip */
    tz_ctx *ctx;
} tz_frames;

/** From a formula in x, y (user units), w, h (the domain's size), pi: numbers, + - * / ^,
 * parentheses, sin cos tan asin acos atan atan2 sqrt abs exp log min max floor mod. Its
 * value is an angle in degrees, positive turns clockwise on the screen (y is down).
 * @return TZ_OK; TZ_INVALID (where the formula breaks); TZ_NOMEM */
TZ_API tz_status tz_frames_from_formula(tz_ctx *ctx, const char *formula, tz_vec3 size,
                                        bool torus, tz_frames **out);
/** Reads directions: an SVG whose paths are strokes, along which frames point, carried
 * smoothly over the domain; or an image: red and green are the vector (0.5 = 0, green
 * points down), or, of a grey image, its value is the angle, 0 = 0 to 1 = 360 degrees.
 * @return TZ_OK; TZ_IO; TZ_FORMAT; TZ_INVALID (no strokes, names the file); TZ_NOMEM */
TZ_API tz_status tz_frames_read(tz_ctx *ctx, const char *path, tz_vec3 size, bool torus,
                                tz_frames **out);
TZ_API void tz_frames_free(tz_frames *f); /**< takes NULL */

/** Angle of the frame at a place, radians, positive clockwise (y down). */
static inline double tz_frames_angle(const tz_frames *f, tz_vec3 at)
{
    return atan2(tz_raster_sample(&f->raster, f->y, at),
                 tz_raster_sample(&f->raster, f->x, at));
}

#endif
