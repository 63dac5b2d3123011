/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Shared by the files that join ends by bridges: pairs of loose ends, the curve that a pair
 * is joined by, and what that crosses. Not installed. */
#ifndef TZ_CURVES_FINISH_PAIRS_INTERNAL_H
#define TZ_CURVES_FINISH_PAIRS_INTERNAL_H

#include "curves/finish_internal.h"

enum {
    TZ_BRIDGE_STEPS = 12, /**< chords of a bridge */
    TZ_BRIDGE_PASSES = 6  /**< lines that a bridge crosses, at most */
};

/** Two ends, and the bridge between them. */
typedef struct tz_end_pair {
    double cost;
    int32_t a, b;   /**< loose ends, by number */
    double cut[2];  /**< lengths that their lines lose first */
    int32_t passes; /**< lines that it crosses, from a on */
    struct {
        int32_t piece;
        double t, u; /**< on the piece, on the curve */
    } pass[TZ_BRIDGE_PASSES];
    tz_bezier curve;
} tz_end_pair;

/** The chords of a bridge, and their box. */
typedef struct tz_bridge_way {
    tz_vec2 v[TZ_BRIDGE_STEPS + 1], lo, hi;
} tz_bridge_way;

/** Ends that are joined in pairs. */
typedef struct tz_pairing {
    tz_net_edit *edit;
    tz_net *n;
    const tz_finish_limits *l;
    int32_t through; /**< lines that a bridge may cross, up to TZ_BRIDGE_PASSES */
    TZ_ARRAY(int32_t)
    loose; /**< nodes */
    TZ_ARRAY(tz_end_pair)
    pair;
    int32_t *taken; /**< per loose end: its pair, or -1 */
    TZ_ARRAY(int32_t)
    done; /**< pairs taken, also those given up */
    TZ_ARRAY(tz_bridge_way)
    drawn; /**< of these */
} tz_pairing;

/* ---- one bridge ----------------------------------------------------------------------- */

/** A place on an edge, before its end at a node by some way. */
typedef struct tz_edge_place {
    int32_t before; /**< pieces that lie behind it as a whole */
    int32_t piece;  /**< -1: the end itself */
    bool back;      /**< the tail is at the piece's end */
    double t;
    tz_vec2 at, out; /**< out: towards the end, of length 1 */
} tz_edge_place;
tz_edge_place tz_edge_place_at(const tz_net *n, int32_t node, double way);

/** A line that a bridge crosses: its two halves on both sides of that, and what of the
 * bridge is cut out there. */
typedef struct tz_bridge_gap {
    tz_bezier line;
    double t[2], u[2];       /**< before and behind */
    tz_vec2 at[2];           /**< of t, beside the bridge */
    int32_t node[2], own[2]; /**< made when it is drawn */
} tz_bridge_gap;

/** The curve from p in direction u to q, where the line that ends there points to w.
 * @param turn  angle by which it turns in all, rad */
tz_bezier tz_bridge_curve(tz_vec2 p, tz_vec2 u, tz_vec2 q, tz_vec2 w, double *turn);
/** A gap for each pass; false where there is no room. */
bool tz_bridge_gaps(const tz_pairing *k, const tz_end_pair *c,
                    tz_bridge_gap g[TZ_BRIDGE_PASSES]);
/** Whether two chords cross or touch. */
bool tz_chords_cross(tz_vec2 p, tz_vec2 q, tz_vec2 r, tz_vec2 s);

/* ---- all of them ---------------------------------------------------------------------- */

/** Pairs of loose ends that may be joined within `reach`, each from both its ends, appended
 * to k->pair.
 * @return TZ_OK; TZ_NOMEM; TZ_CANCELLED */
tz_status tz_pairing_find(tz_pairing *k, double reach);
/** Draws a pair's bridge into the edit, unless a line of it has been changed by another. */
tz_status tz_pairing_draw(tz_pairing *k, int32_t pair);

#endif
