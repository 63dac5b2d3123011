/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Which thing lies above which, and how far the hidden part of a thing reaches. Private to
 * analysis/.
 * @source Guzman, AFIPS 1968 (T-junctions); Jiang et al., Statistical ranking and
 *   combinatorial Hodge theory, 2011 (an order out of pairs) */
#ifndef TZ_ANALYSIS_THINGS_DEPTH_H
#define TZ_ANALYSIS_THINGS_DEPTH_H

#include "analysis/things_set.h"

/** Sets depth, at, radius and hidden of each thing from the outlines.
 * @param label  width * height, as tz_things_outlines leaves it */
tz_status tz_things_order(tz_ctx *ctx, const int32_t *label, int32_t width,
                          int32_t height, tz_things_found *found, int32_t count);

#endif
