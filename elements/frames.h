/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Local frames over a domain: which way the exemplar's x axis points at each place, how
 * large its things are there and how far apart. An arrangement turns and grows with them.
 * Immutable once made, read from any thread.
 * @source [Ma11] Sec. 4.4 Eq. (7): local orientation; [Hsu20] Sec. Distribution
 *   manipulation: sizes and densities */
#ifndef TZ_ELEMENTS_FRAMES_H
#define TZ_ELEMENTS_FRAMES_H

#include "base/ctx.h"
#include "elements/raster.h"

struct tz_element_field;

/** Sizes that arrangements follow; densities below are as sparse as that. */
#define TZ_FRAMES_LEAST_SIZE    (1.0 / 16)
#define TZ_FRAMES_MOST_SIZE     16.0
#define TZ_FRAMES_LEAST_DENSITY (1.0 / 16)

typedef struct tz_frames {
    tz_raster raster;
    float *x, *y; /**< unit vectors; bilinear between, so that they never flip */
    float *size;  /**< of things, 1 = the exemplar's; NULL = 1 everywhere */
    float *apart; /**< factor of distances between things: size / sqrt(density); NULL = 1
                       everywhere */
    double apart_least, apart_most; /**< over the domain; 1, 1 where nothing is said, 0, 0
                                         where the struct was made by hand */
    bool turned;                    /**< directions were said */
    bool thinned;                   /**< densities were said */
    tz_ctx *ctx;
} tz_frames;

/** From a formula in x, y (user units), w, h (the domain's size), pi: numbers, + - * / ^,
 * parentheses, sin cos tan asin acos atan atan2 sqrt abs exp log min max floor mod. Its
 * value is an angle in degrees, positive turns clockwise on the screen (y is down).
 * @return TZ_OK; TZ_INVALID (where the formula breaks); TZ_NOMEM */
TZ_API tz_status tz_frames_from_formula(tz_ctx *ctx, const char *formula, tz_vec3 size,
                                        bool torus, tz_frames **out);
/** From what strokes and images say, carried over the domain: harmonic between, strokes of
 * less than the largest weight give way to heavier ones about them.
 * @param field  settled, of the same context
 * @return TZ_OK; TZ_INVALID (it says nothing in view; a stroke's size that arrangements do
 *   not follow); TZ_NOMEM
 * @cost three sparse systems of at most 65,536 unknowns */
TZ_API tz_status tz_frames_from_field(const struct tz_element_field *field,
                                      tz_frames **out);
/** Takes over sizes and densities alone; where the field says none, nothing changes.
 * @return TZ_OK; TZ_INVALID; TZ_NOMEM; frames are unchanged on error */
TZ_API tz_status tz_frames_add_sizes(tz_frames *f, const struct tz_element_field *field);
/** Back to directions alone. */
TZ_API void tz_frames_drop_sizes(tz_frames *f);
/** Reads what elements/field.h reads: an SVG of strokes, or an image of directions.
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

/** How large things are at a place, > 0. */
static inline double tz_frames_size(const tz_frames *f, tz_vec3 at)
{
    return f->size ? tz_raster_sample(&f->raster, f->size, at) : 1;
}

/** By which factor they lie farther apart than in the exemplar, > 0. */
static inline double tz_frames_apart(const tz_frames *f, tz_vec3 at)
{
    return f->apart ? tz_raster_sample(&f->raster, f->apart, at) : 1;
}

#endif
