/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Graphs of lines as curves with pens and tapers. Private to analysis/. */
#ifndef TZ_ANALYSIS_LINES_FIT_H
#define TZ_ANALYSIS_LINES_FIT_H

#include "analysis/lines_graph.h"
#include "curves/curve.h"

/** Appends paths to a set. Chains that run on straight through a junction and have one pen
 * are one path.
 * @param side   px of the photo a px of the picture
 * @param error  of the cubics, px of the photo
 * @param to     with a domain, without paths */
tz_status tz_line_fit(const tz_line_graph *g, const tz_line_picture *picture, double side,
                      double error, tz_curve_set *to);

#endif
