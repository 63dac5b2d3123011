/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Shared by the files that finish curves: curves as a net of edges between nodes, with
 * points along them to be looked up. Not installed. */
#ifndef TZ_CURVES_FINISH_INTERNAL_H
#define TZ_CURVES_FINISH_INTERNAL_H

#include "base/grid.h"
#include "curves/curve_join_internal.h"
#include "curves/finish.h"
#include "curves/sample_graph.h"

/** A run of pieces through nodes that join just two, from a node that does not to the
 * next. A loop without any begins and ends at one of its nodes. */
typedef struct tz_net_edge {
    int32_t step, steps; /**< tz_net.step */
    int32_t from, to;    /**< nodes */
    double length;
    int32_t part; /**< of the net: what hangs together */
} tz_net_edge;

/** A point of an edge. */
typedef struct tz_net_point {
    tz_vec2 at, tangent; /**< tangent: of the piece, of length 1 */
    int32_t piece;
    double t;     /**< on the piece */
    double along; /**< on the edge */
} tz_net_point;

/** A joined set. Ends of pieces: 2 i is where piece i begins, 2 i + 1 where it ends. */
typedef struct tz_net {
    tz_ctx *ctx;
    tz_curve_set set;
    int32_t fixed; /**< pens from this on are of what must stay */
    int32_t *first,
        *end; /**< ends of pieces at node n: end[first[n] .. first[n + 1] - 1] */
    TZ_ARRAY(int32_t)
    step; /**< ends by which the edges' pieces are entered, in order */
    TZ_ARRAY(tz_net_edge)
    edge;
    int32_t *edge_of; /**< per piece */
    int32_t *pen;     /**< per piece */
    double *size;     /**< per piece: its length */
    int32_t parts;
    double spacing; /**< of points, no more */
    TZ_ARRAY(tz_net_point)
    point;       /**< by piece: point[at[i] .. at[i + 1] - 1], both its ends among them */
    int32_t *at; /**< per piece */
    tz_grid grid;  /**< of the points */
    double length; /**< of what is not fixed, off the border by the margin */
} tz_net;

/** Takes the set over, also on error. Its paths are joined where they cross.
 * @return TZ_OK; TZ_NOMEM; TZ_LIMIT; TZ_CANCELLED */
tz_status tz_net_init(tz_ctx *ctx, tz_curve_set *joined, int32_t fixed, double spacing,
                      double margin, tz_net *n);
void tz_net_deinit(tz_net *n);

static inline int32_t tz_net_degree(const tz_net *n, int32_t node)
{
    return n->first[node + 1] - n->first[node];
}
static inline bool tz_net_fixed(const tz_net *n, int32_t piece)
{
    return n->pen[piece] >= n->fixed;
}
/** Whether a node is an end in the midst of the domain, of something that is not fixed. */
bool tz_net_dangles(const tz_net *n, int32_t node, double margin);
/** How many there are. */
int32_t tz_net_ends(const tz_net *n, double margin);
/** Direction in which the line runs out of its end, of length 1. */
tz_vec2 tz_net_outwards(const tz_net *n, int32_t node);
/** The vector from p to q, on a torus to its nearest copy. */
static inline tz_vec2 tz_net_vector(const tz_net *n, tz_vec2 p, tz_vec2 q)
{
    return tz_vec2_sub(tz_curve_copy(&n->set.domain, q, p), p);
}

/** What the exemplar tells. Lengths in user units. */
typedef struct tz_finish_limits {
    double delta;    /**< about which all is measured: the finest spacing */
    double margin;   /**< an end this near to the border is none */
    double ends;     /**< per length */
    double branch;   /**< free branches are longer, but for the shortest tenth */
    double least;    /**< no free branch is shorter than twice this */
    double crumb;    /**< nothing that stands alone is shorter than twice this */
    double twin;     /**< edges run beside another no nearer than twice this */
    double junction; /**< junctions are no nearer to each other than twice this */
    int32_t degrees; /**< the most lines that meet */
    bool straight;   /**< most lines are straight: gaps are closed by straight ones */
    double bend;     /**< rad a unit of length: lines hardly turn faster */
    double reach;    /**< that gaps are closed over */
    double *gap;     /**< what would close the exemplar's own gaps, one an end, in order;
                          NULL: it has too few ends to tell */
    int32_t gaps;
    double length;  /**< of the exemplar, user units */
    int32_t pieces; /**< of the exemplar, cut where they cross */
} tz_finish_limits;
void tz_finish_limits_deinit(tz_ctx *ctx, tz_finish_limits *l); /**< takes zeroed */

tz_status tz_finish_measure(tz_ctx *ctx, const tz_curve_set *exemplar,
                            tz_finish_limits *out);

/** For an edge: how near it runs beside others, that a share of 0.8 of its points is no
 * farther; INFINITY where that is not under `under`.
 * @param gone     per piece: counts no more; NULL = all count
 * @param scratch  room for the points of the edge */
double tz_net_twin(const tz_net *n, int32_t edge, double under, const bool *gone,
                   double *scratch);
/** The most points that an edge has. */
int32_t tz_net_most_points(const tz_net *n);

/** A piece that is added between two nodes. */
typedef struct tz_net_bridge {
    int32_t node[2];
    tz_bezier curve;
    tz_curve_taper taper;
    int32_t pen;
} tz_net_bridge;

/** What is kept of a piece. */
typedef struct tz_net_kept {
    double t[2];
    int32_t node[2]; /**< of the ends that are cut off: new ones */
} tz_net_kept;

/** What is to become of a net: pieces that go, new ones, cuts and nodes that move. */
typedef struct tz_net_edit {
    tz_net *net;
    bool *gone;        /**< per piece */
    bool *used;        /**< per piece: cut once */
    tz_net_kept *kept; /**< NULL, or per piece; these are not cut */
    int32_t *merged;   /**< per node: the node that it falls together with, or itself */
    TZ_ARRAY(tz_curve_cut)
    cut; /**< nodes of cuts are new, or those of the set; ~node: what lies between this
              cut and the next on the piece goes */
    TZ_ARRAY(tz_vec2)
    node; /**< new: their numbers follow those of the set */
    TZ_ARRAY(tz_net_bridge)
    bridge;
    int32_t closed, removed;
} tz_net_edit;

tz_status tz_net_edit_init(tz_net *n, tz_net_edit *e);
void tz_net_edit_deinit(tz_net_edit *e);
/** The net's set with all that done; it has been changed at all if closed, removed > 0. */
tz_status tz_net_edit_apply(tz_net_edit *e, tz_curve_set *out);

/** Length of each part, which the caller frees; INFINITY for those which reach the border or
 * hold what is fixed. */
tz_status tz_finish_parts(const tz_net *n, double margin, double **length);
/** Crumbs, twins and junctions that lie in one spot. */
tz_status tz_finish_clean(tz_net_edit *e, const tz_finish_limits *l);
/** Least cost, per end of a net, of what would take it away; appended to `cost`. */
typedef TZ_ARRAY(double)
tz_finish_costs;
tz_status tz_finish_end_costs(const tz_net *n, const tz_finish_limits *l,
                              tz_finish_costs *cost);
/** Ends: gaps closed and stubs removed, the worst first, until there are no more than
 * `most`. */
tz_status tz_finish_ends(tz_net_edit *e, const tz_finish_limits *l, double most);

/** Ends that are left, where hardly any are right: pairs of them within `reach`, by smooth
 * curves that cross no line, or up to `through` of them, with which they change sides; as
 * many pairs as there are, the shortest first. */
tz_status tz_finish_pairs(tz_net_edit *e, const tz_finish_limits *l, double reach,
                          int32_t through, double most);
/** Lines that end go up to the next junction, the shortest first, until that is `share` of
 * all length. */
tz_status tz_finish_drop(tz_net_edit *e, const tz_finish_limits *l, double share,
                         double most);

/** Crossings of lines that finishing has made nodes of merely cross again: nodes of `s`
 * that are farther than `reach` from any of `before`, where no path ends and all run
 * straight on, go, and what they cut is one piece. No point of a line moves by more than
 * `same`.
 * @param[in,out] s  undefined, but freed as usual, on error
 * @return TZ_OK; TZ_NOMEM
 * @cost O(n) */
tz_status tz_finish_release(const tz_curve_set *before, double reach, double same,
                            tz_curve_set *s);

/* ---- shared by what closes gaps ------------------------------------------------------- */

/** Whether a bridge crosses a line, but for pieces a and b, which it may only touch where
 * it begins and ends. */
bool tz_net_blocked(const tz_net *n, const tz_bezier *c, int32_t a, int32_t b);
/** Width of the line at its end. */
double tz_net_width_at(const tz_net *n, int32_t node);
/** The end of a piece that node is. */
static inline int32_t tz_net_end_at(const tz_net *n, int32_t node)
{
    return n->end[n->first[node]];
}
/** A node more. */
tz_status tz_net_edit_node(tz_net_edit *e, tz_vec2 at, int32_t *node);

#endif
