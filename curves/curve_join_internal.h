/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Shared by curve_join.c, curve_cross.c and curve_chain.c. Not installed. */
#ifndef TZ_CURVES_CURVE_JOIN_INTERNAL_H
#define TZ_CURVES_CURVE_JOIN_INTERNAL_H

#include "base/grid.h"
#include "curves/curve_join.h"

/** A piece is to be cut at t, and the cut is that node. */
typedef struct tz_curve_cut {
    int32_t piece, node;
    double t;
} tz_curve_cut;

/** A set being joined. */
typedef struct tz_curve_work {
    tz_ctx *ctx;
    double reach, same;
    bool crossings;
    tz_curve_set set; /**< nodes merged; pieces in order of their paths */
    bool *end;        /**< per node (those there are at first): end of an open path */
    double *along;    /**< per piece: length of its path before it */
    int32_t *path;    /**< per piece */
    TZ_ARRAY(tz_curve_cut)
    cut;
} tz_curve_work;

/** Finds where nodes lie on pieces and, if wanted, where pieces cross: w->cut, and nodes
 * of crossings appended to w->set.node. */
tz_status tz_curve_find_cuts(tz_curve_work *w);

/** The pieces of `s` that are not gone as paths of `to`, which has its nodes; nodes are
 * then in order of first use. */
tz_status tz_curve_chain(tz_ctx *ctx, const tz_curve_set *s, const bool *gone,
                         bool keep_ends, tz_curve_set *to);

/** Distance of two places, on a torus of their nearest copies. */
static inline double tz_curve_apart(const tz_curve_set *s, tz_vec2 p, tz_vec2 q)
{
    return tz_vec2_length(tz_vec2_sub(tz_curve_copy(&s->domain, q, p), p));
}
/** The curve c between two nodes near its ends: each half of it goes along with its end.
 * p->straight stays, and its control points are at the thirds then. */
void tz_curve_put(const tz_curve_set *s, const tz_bezier *c, const int32_t node[2],
                  tz_curve_piece *p);
/** Piece i and what it carries take the place of piece j <= i. */
void tz_curve_move_piece(tz_curve_set *s, int32_t i, int32_t j);

#endif
