/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Lines as a graph: chains of points between ends and junctions. Private to analysis/. */
#ifndef TZ_ANALYSIS_LINES_GRAPH_H
#define TZ_ANALYSIS_LINES_GRAPH_H

#include "analysis/lines_field.h"
#include "base/geom.h"

typedef struct tz_line_point {
    tz_vec2 at;     /**< pixel (i, j) has its centre at i + 0.5, j + 0.5 */
    float strength; /**< contrast there */
    float width;    /**< px */
} tz_line_point;

/** Points run from node[0] to node[1]; the first and the last lie on them. */
typedef struct tz_line_chain {
    int32_t node[2]; /**< both -1: a loop, its last point is its first */
    int32_t first, n;
    double length;
    double strength, width; /**< means along it */
    bool light, edge;
    bool gone;
} tz_line_chain;

typedef struct tz_line_graph {
    int32_t width, height; /**< of the picture */
    TZ_ARRAY(tz_vec2)
    node;
    TZ_ARRAY(tz_line_chain)
    chain;
    TZ_ARRAY(tz_line_point)
    point;
    tz_ctx *ctx;
} tz_line_graph;

void tz_line_graph_deinit(tz_line_graph *g); /**< takes zeroed */

/** Appends the chains of a thinned map. */
tz_status tz_line_graph_trace(const tz_line_field *f, tz_line_graph *g);

/** Length and means anew. */
void tz_line_chain_measure(const tz_line_graph *g, tz_line_chain *c);

/** Point i of a chain as seen from its end 0 or 1. */
static inline tz_line_point *
tz_line_chain_point(const tz_line_graph *g, const tz_line_chain *c, int end, int32_t i)
{
    return &g->point.v[c->first + (end ? c->n - 1 - i : i)];
}

/** Which chains meet at each node: end[first[k] .. first[k + 1] - 1], 2 c + (0 or 1) for
 * an end of chain c. Chains that are gone are left out. */
typedef struct tz_line_ends {
    int32_t *first, *end;
} tz_line_ends;
tz_status tz_line_ends_init(const tz_line_graph *g, tz_line_ends *e);
void tz_line_ends_deinit(const tz_line_graph *g, tz_line_ends *e);
static inline int32_t tz_line_degree(const tz_line_ends *e, int32_t node)
{
    return e->first[node + 1] - e->first[node];
}

/** Chains that meet two at a node become one; what is gone, and nodes without chains, are
 * dropped. Chains of different kinds (light, edge) stay apart. */
tz_status tz_line_graph_rejoin(tz_line_graph *g);

/** Adds the chains of another graph of the same picture. */
tz_status tz_line_graph_append(tz_line_graph *to, const tz_line_graph *from);

/** How a graph is tidied; lengths in px. */
typedef struct tz_line_tidy {
    double low; /**< strength that lines exceed on the whole */
    double
        proof; /**< excess over `low`, summed along it, that a chain needs, px * unit */
    double length; /**< shortest spur and component */
    double gap;    /**< widest that is bridged; 0 = none */
} tz_line_tidy;

/** Strength that lines exceed, of a field whose ridges are marked. */
double tz_line_part(const tz_line_field *f);
/** Proof that a chain is a line (lines_select.c). */
double tz_line_chain_proof(const tz_line_graph *g, const tz_line_chain *c, double low);

/** Drops chains that are no lines: their excess over `low` is under `proof`, unless they
 * join two that are; then spurs and small components. */
tz_status tz_line_graph_select(tz_line_graph *g, const tz_line_tidy *t);

/** Junctions nearer to each other than the lines are wide become one, and lines run
 * straight up to them. */
tz_status tz_line_graph_mend(tz_line_graph *g);

/** Joins ends that point at each other or at a line, and ends near the picture's border
 * with that. */
tz_status tz_line_graph_bridge(tz_line_graph *g, const tz_line_field *f,
                               const tz_line_tidy *t);

/** Measures widths and contrasts (`strength`) on the picture, across the lines, and moves
 * points to the middle between both borders; ends of chains stay.
 * @param grey  plane that the lines were found in */
tz_status tz_line_graph_measure(tz_line_graph *g, const float *grey);

/** Marks the pixels that lines cover, and `more` px to either side.
 * @param[out] mask  w * h of a picture `side` times as large as that of the graph */
void tz_line_graph_cover(const tz_line_graph *g, double side, double more, int32_t w,
                         int32_t h, uint8_t *mask);

/** Smooths places and widths along chains; nodes stay. */
tz_status tz_line_graph_smooth(tz_line_graph *g, double sigma);

#endif
