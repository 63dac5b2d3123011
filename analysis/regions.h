/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Hierarchical regions: superpixels merged into whole things. Private to analysis/.
 * @source the future work that [Kim21] Sec. 7 names, for edges that cross superpixels */
#ifndef TZ_ANALYSIS_REGIONS_H
#define TZ_ANALYSIS_REGIONS_H

#include "base/alloc.h"

typedef struct tz_region_picture {
    int32_t width, height, channels;
    const float *response; /**< width * height, >= 0: where borders are */
    const float *lab;      /**< channels planes, lightness first */
} tz_region_picture;

typedef struct tz_region_options {
    double full;     /**< response that counts as a full border */
    double scale;    /**< diameter of a thing, px */
    double merge;    /**< 0..1, see tz_ebpt_params.merge */
    int32_t wanted;  /**< number of regions to stop at, 0 = where the borders say so */
    int32_t longest; /**< merging makes no region whose box is longer than this, px */
    double least;    /**< regions of smaller area join a neighbour in any case, px */
} tz_region_options;

/** Merges neighbouring labels where the response along their common border is weak and
 * their colours agree, the weakest first; joints between things are shared out.
 * @param[in,out] label  0 .. *count - 1, each 4-connected, before and after; new ids in
 *                  raster order of the regions' first pixels
 * @return TZ_OK; TZ_NOMEM; TZ_CANCELLED; on error label is unspecified
 * @cost O(pixels + superpixels log superpixels) */
tz_status tz_regions_merge(tz_ctx *ctx, const tz_region_picture *in,
                           const tz_region_options *opt, int32_t *label, int32_t *count);

#endif
