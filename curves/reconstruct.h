/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Curves out of a sample graph.
 * @source [Tu20] Sec. 4.4.2. Deviates: tangents are the samples' orientations themselves,
 *   so that circles come back as circles; paths that meet at a corner become one */
#ifndef TZ_CURVES_RECONSTRUCT_H
#define TZ_CURVES_RECONSTRUCT_H

#include "curves/sample_graph.h"

/** Paths through the graph's edges: where two orientations of a sample are opposite
 * (between 8 and 10 ninths of pi) and both belong to edges, a path runs through;
 * elsewhere it ends. Pieces are cubics through the samples, straight where their tangents
 * are.
 * @param like     whose pens the edges name; domain and background are taken over, too
 * @param[out] to  overwritten, not freed; no discrete elements; zeroed on error
 * @return TZ_OK; TZ_INVALID (no edges; an edge's pen does not exist); TZ_NOMEM
 * @cost O(edges) */
TZ_API tz_status tz_curve_reconstruct(tz_ctx *ctx, const tz_sample_graph *g,
                                      const tz_curve_set *like, tz_curve_set *to);

/** The same with the exemplar's own lines: an edge that is like one of the exemplar's takes
 * its shape, turned, scaled and bent so that it runs from sample to sample in the directions
 * that the path has there; at shared samples the pieces go on smoothly. Pieces carry their
 * origin, and tapers where the exemplar has them.
 * @param exemplar  the graph that g's edges are like (tz_curve_edge.like); others are
 *   interpolated
 * @return as tz_curve_reconstruct; TZ_INVALID (an edge is like one that does not exist)
 * @source goes beyond [Tu20] Sec. 4.4.2, which loses the exemplar's line character */
TZ_API tz_status tz_curve_reconstruct_detail(tz_ctx *ctx, const tz_sample_graph *g,
                                             const tz_sample_graph *exemplar,
                                             const tz_curve_set *like, tz_curve_set *to);

/** How far curves lie apart.
 * @param step  way between the points that are measured, user units, > 0
 * @param[out] mean, most  distance from points of `a` to the nearest of `b`, user units
 * @return TZ_OK; TZ_INVALID (one has no paths; step); TZ_NOMEM
 * @cost O(n) for curves that lie near each other */
TZ_API tz_status tz_curve_distance(tz_ctx *ctx, const tz_curve_set *a,
                                   const tz_curve_set *b, double step, double *mean,
                                   double *most);

#endif
