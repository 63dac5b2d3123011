/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Superpixels: about `step` px wide, borders on the ridges of the response, 4-connected,
 * every pixel labelled. Private to analysis/. */
#ifndef TZ_ANALYSIS_SUPERPIXEL_H
#define TZ_ANALYSIS_SUPERPIXEL_H

#include "base/alloc.h"

/** @param response  width * height, >= 0
 *  @param full      response that counts as a full border
 *  @param step      wanted diameter, px, at least 2
 *  @param[out] label  width * height, 0 .. *count - 1 in raster order of the seeds
 *  @return TZ_OK; TZ_NOMEM; TZ_CANCELLED  @cost O(pixels), one thread
 *  @source Machairas et al., Waterpixels, TIP 2015; Neubert, Protzel, Compact watershed
 *    and preemptive SLIC, ICPR 2014. Stands in for OpenCV's SLIC, of which 10 iterations
 *    take longer than the whole analysis may, and whose library takes 0.1 s to load. */
tz_status tz_superpixels(tz_ctx *ctx, const float *response, int32_t width,
                         int32_t height, double full, double step, int32_t *label,
                         int32_t *count);

#endif
