/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Shared by curve_join.c and curve_cross.c. Not installed. */
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

#endif
