/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The mixture of red, green and blue in which lines stand out most. Private to
 * analysis/. */
#ifndef TZ_ANALYSIS_LINES_AXIS_H
#define TZ_ANALYSIS_LINES_AXIS_H

#include "analysis/lines_graph.h"

/** Learnt from lines that were found in `grey`.
 * @param[in,out] grey  plane of the picture; becomes the mixture, lines as much lighter or
 *                      darker than their sides as they were, where they stand out clearly
 *                      more in it
 * @param[out] changed  whether it did */
tz_status tz_line_axis(const tz_line_graph *g, const tz_line_picture *picture,
                       float *grey, bool *changed);

#endif
