/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Whether a picture is one of lines. Private to analysis/. */
#ifndef TZ_ANALYSIS_LINES_JUDGE_H
#define TZ_ANALYSIS_LINES_JUDGE_H

#include "analysis/lines.h"
#include "analysis/lines_graph.h"

/** Share of ends of chains that meet others or the border; 0 of none. */
tz_status tz_line_joined(const tz_line_graph *g, double *joined);

/** @param side  px of the photo a px of the picture
 *  @param paths  that the graph was drawn as
 *  @param[in,out] v  line and tone as found; the rest is filled */
tz_status tz_line_judge(const tz_line_graph *g, const tz_line_picture *picture,
                        const float *grey, double side, int32_t paths,
                        tz_lines_verdict *v);

#endif
