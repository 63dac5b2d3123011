/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Region: the shape of a domain that is not a plain rectangle, as signed distances to its
 * border on a grid. Immutable once made, read from any thread.
 * @source [Ma11] Sec. 4.3 Eq. (6): the domain's shape enters as a field */
#ifndef TZ_ELEMENTS_REGION_H
#define TZ_ELEMENTS_REGION_H

#include "base/ctx.h"
#include "elements/raster.h"

typedef struct tz_region {
    tz_raster raster;
    float *distance; /**< raster.width * raster.height, user units, > 0 inside */
    double area;     /**< inside, user units squared */
    tz_ctx *ctx;
} tz_region;

/** @param mask    width * height, row by row, 0 outside .. 1 inside; the border runs where
 *                 it is 1/2, to a part of a cell
 * @param size     of the domain that the mask is stretched over, user units
 * @param torus    distances run over the domain's borders; else what lies beyond them is
 *                 outside
 * @param[out] out replaced; NULL on error
 * @return TZ_OK; TZ_INVALID (nothing inside; sizes below 1 or over 8192); TZ_NOMEM
 * @cost O(width * height) */
TZ_API tz_status tz_region_from_mask(tz_ctx *ctx, const float *mask, int32_t width,
                                     int32_t height, tz_vec3 size, bool torus,
                                     tz_region **out);
/** Reads a mask: an image (inside = light, or opaque where it has an alpha channel that
 * is not all one), or an SVG whose filled shapes and closed paths are the inside; its
 * viewBox (or its size) is stretched over the domain.
 * @return as tz_region_from_mask (names the file); TZ_IO; TZ_FORMAT */
TZ_API tz_status tz_region_read(tz_ctx *ctx, const char *path, tz_vec3 size, bool torus,
                                tz_region **out);
TZ_API void tz_region_free(tz_region *r); /**< takes NULL */

/** Signed distance to the border at a place, user units, > 0 inside; bilinear. Beyond the
 * domain that of its nearest place, less the way there. */
static inline double tz_region_distance(const tz_region *r, tz_vec3 at)
{
    return tz_raster_sample(&r->raster, r->distance, at) -
           tz_raster_beyond(&r->raster, at);
}

#endif
