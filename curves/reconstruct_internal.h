/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Shared by reconstruct.c and detail.c. Not installed. */
#ifndef TZ_CURVES_RECONSTRUCT_INTERNAL_H
#define TZ_CURVES_RECONSTRUCT_INTERNAL_H

#include "curves/curve_join_internal.h"
#include "curves/reconstruct.h"

#define TZ_REBUILD_OPPOSITE (TZ_PI / 9) /**< orientations: off pi by no more */

/** A curve of an edge, from its sample `from` on, on a torus not wrapped. */
typedef struct tz_rebuild_shape {
    tz_bezier curve;
    tz_curve_carry carry;
    bool straight;
} tz_rebuild_shape;

/** Ends of edges: 2 e leaves edge[e].from, 2 e + 1 leaves edge[e].to. */
typedef struct tz_rebuild {
    tz_ctx *ctx;
    const tz_sample_graph *g;
    int32_t *next;   /**< per end: the end of another edge that it runs on to, or -1 */
    double *tangent; /**< per end: direction in which the curve leaves */
    bool *done;      /**< per edge */
    tz_curve_set *to;
    int32_t *node; /**< per sample */
    /* with the exemplar's lines */
    const tz_sample_graph *exemplar; /**< NULL: edges are interpolated */
    TZ_ARRAY(tz_rebuild_shape)
    shape;
    int32_t *first; /**< per edge: its shapes, shape[first[e] .. first[e + 1] - 1] */
} tz_rebuild;

/** Fills k->shape and k->first, and has k->tangent follow: edges without shapes are to be
 * interpolated. */
tz_status tz_rebuild_detail(tz_rebuild *k);

/** Signed angle from direction b to a, -pi .. pi. */
static inline double tz_rebuild_turn(double a, double b)
{
    const double d = a - b;
    return d - floor(d / (2 * TZ_PI) + 0.5) * (2 * TZ_PI);
}

#endif
