/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Pictures that tests draw and how they compare them. Everything is a function of the
 * pixel and a seed, so that the same test sees the same picture on every machine. */
#ifndef TZ_TESTS_SUPPORT_PICTURES_H
#define TZ_TESTS_SUPPORT_PICTURES_H

#include "base/image.h"

/** What to draw; values lie in 0.05 .. 0.95. */
typedef enum picture_kind {
    PICTURE_NOISE,    /**< every value independent */
    PICTURE_SMOOTH,   /**< a few long waves, another phase a channel */
    PICTURE_GRADIENT, /**< rises to the right and down */
    PICTURE_STONES,   /**< Voronoi cells of one tone each, dark joints */
    PICTURE_BRICKS,   /**< running bond with light joints: has directions */
    PICTURE_GREY      /**< 0.5 everywhere */
} picture_kind;

/** A picture of any size and channel count, sRGB-encoded. Ends the test if there is no
 * memory. Free with tz_image_deinit. */
tz_image picture(tz_ctx *ctx, picture_kind kind, int32_t width, int32_t height,
                 int32_t channels, uint64_t seed);

/** Normal map of a plane whose normal is (x, y, z) (unit), y up the picture. */
tz_image picture_plane(tz_ctx *ctx, int32_t width, int32_t height, double x, double y,
                       double z);

/** Empty image to render into. */
tz_image blank(tz_ctx *ctx, int32_t width, int32_t height, int32_t channels);

/** Largest absolute difference of two images of one size; NaN counts as infinite. */
double largest_difference(const tz_image *a, const tz_image *b);
/** Mean absolute difference. */
double mean_difference(const tz_image *a, const tz_image *b);
/** Pixels whose bytes differ. */
int64_t pixels_that_differ(const tz_image *a, const tz_image *b);
/** No NaN, no infinity. */
bool all_finite(const tz_image *im);

#endif
