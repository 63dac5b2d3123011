/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Joints: long thin regions between things (mortar, gaps). Private to analysis/. */
#ifndef TZ_ANALYSIS_JOINTS_H
#define TZ_ANALYSIS_JOINTS_H

#include "base/alloc.h"

/** Regions nowhere wider than `width` and at least 2.5 times as long as wide are shared
 * out among their neighbours, which meet in the middle. If all are such, nothing changes.
 * @param[in,out] label  0 .. *count - 1, each 4-connected, before and after */
tz_status tz_joints_dissolve(tz_ctx *ctx, int32_t width_px, int32_t height_px,
                             double width, int32_t *label, int32_t *count);

#endif
