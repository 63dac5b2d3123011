/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Brings paths into order: what touches is joined, what lies twice is there once, and
 * what runs on is one path. Foreign drawings go through it; so do results of synthesis.
 * */
#ifndef TZ_CURVES_CURVE_JOIN_H
#define TZ_CURVES_CURVE_JOIN_H

#include "curves/curve.h"

/** All zero: by itself, crossings stay crossings. */
typedef struct tz_curve_join_params {
    double reach;    /**< an end this near to another end or path joins it, user units;
                         0 = half of the median width of the pens, at most 1 % of the
                         diagonal */
    double same;     /**< points this near are one; 0 = 1e-6 of the diagonal */
    bool crossings;  /**< where paths cross they are joined by a node, too */
    bool keep_ends;  /**< paths are not chained to longer ones */
    bool only_chain; /**< nothing is moved, cut or dropped: paths are only chained */
} tz_curve_join_params;

/** The paths of `from`, joined. Straight pieces stay straight; no point moves farther
 * than `reach`. Paths are chained at a node of two ends of one pen, and at others where
 * two run on within pi / 9 of straight.
 * @param p        NULL = all zero
 * @param[out] to  overwritten, not freed (pens, domain and background as in `from`, no
 *   elements); zeroed on error
 * @return TZ_OK; TZ_LIMIT (over 8 million crossings, or too much in one spot); TZ_NOMEM;
 *   TZ_CANCELLED
 * @cost O(n + crossings) for pieces that are spread over the domain */
TZ_API tz_status tz_curve_join(tz_ctx *ctx, const tz_curve_set *from,
                               const tz_curve_join_params *p, tz_curve_set *to);

/** Half of the median width of what is drawn: the default of `reach`. */
TZ_API double tz_curve_reach(const tz_curve_set *s);

#endif
