/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The photo with its lines taken out. Private to analysis/. */
#ifndef TZ_ANALYSIS_LINES_PLATE_H
#define TZ_ANALYSIS_LINES_PLATE_H

#include "analysis/lines_graph.h"

/** @param side  px of the photo a px of the graph's picture
 *  @param[out] plate  overwritten; 3 channels (1 of a grey photo), empty on error
 *  @cost O(pixels) */
tz_status tz_line_plate(tz_ctx *ctx, const tz_image *photo, const tz_line_graph *g,
                        double side, tz_image *plate);

#endif
