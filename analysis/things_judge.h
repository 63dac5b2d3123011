/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Whether a picture is made of things. Private to analysis/. */
#ifndef TZ_ANALYSIS_THINGS_JUDGE_H
#define TZ_ANALYSIS_THINGS_JUDGE_H

#include "analysis/things.h"
#include "analysis/things_ground.h"
#include "analysis/things_set.h"

/** @param found   as tz_things_doubt leaves them
 *  @param pixels  of the picture */
tz_status tz_things_sum_up(tz_ctx *ctx, const tz_things_found *found, int32_t count,
                           const tz_things_ground *ground, int64_t pixels,
                           tz_things_verdict *out);

#endif
