/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Sample graphs: curves (and discrete elements) as points with edges, which is what
 * synthesis works on.
 * @source [Tu20] Sec. 4.1. Deviates: corners of paths are samples, too, so that they come
 *   back as corners; samples and edges carry what the paper says nothing of (pens) */
#ifndef TZ_CURVES_SAMPLE_GRAPH_H
#define TZ_CURVES_SAMPLE_GRAPH_H

#include "curves/curve.h"

enum {
    TZ_SAMPLE_CURVE = -1, /**< id q of all samples of curves */
    TZ_SAMPLE_LEVELS = 3
};

/** A sample. Its edges are graph.link[link .. link + links - 1], its orientations
 * graph.turn[turn .. turn + turns - 1]; in exemplars links = turns and they go together.
 * */
typedef struct tz_curve_sample {
    tz_vec2 at;
    int32_t q; /**< TZ_SAMPLE_CURVE, or kind << 10 | id of an element's sample */
    int32_t link, links; /**< its edges */
    int32_t turn, turns; /**< its orientations */
    int32_t element;     /**< that it is part of; -1 = of a curve */
    double existence;    /**< confidence 0 .. 1; 1 in exemplars */
    bool fixed;          /**< of what is drawn already: it stays, and must be matched */
} tz_curve_sample;

/** An edge as seen from one of its samples. */
typedef struct tz_curve_link {
    int32_t to;   /**< sample at the other end */
    int32_t edge; /**< tz_sample_graph.edge */
} tz_curve_link;

typedef struct tz_curve_edge {
    int32_t from, to; /**< samples, not the same one; no two edges join the same two */
    int32_t pen;      /**< tz_curve_set.pen of the exemplar */
    double existence; /**< confidence 0 .. 1; 1 in exemplars */
    int32_t shape,
        shapes;   /**< exemplars: graph.shape[shape .. shape + shapes - 1], what it
                                runs along, in its direction; 0 shapes: a straight line */
    int32_t like; /**< output: edge of the exemplar's graph that it is matched with, -1 =
                       none; in exemplars -1 */
    bool back;    /**< output: `like` runs the other way */
} tz_curve_edge;

typedef struct tz_sample_graph {
    tz_domain domain;
    double spacing; /**< delta: between samples along a path, user units */
    double radius;  /**< r: of neighbourhoods at this level */
    TZ_ARRAY(tz_curve_sample)
    sample;
    TZ_ARRAY(tz_curve_edge)
    edge;
    TZ_ARRAY(tz_curve_link)
    link; /**< by sample; order of the edges' angles is not defined */
    TZ_ARRAY(double)
    turn; /**< by sample: directions in which curves leave, [0, 2 pi), y down */
    TZ_ARRAY(tz_bezier)
    shape; /**< exemplars: the curves along edges, from edge to edge one behind another;
                those of an edge begin at its sample `from`, on a torus not wrapped */
    TZ_ARRAY(tz_curve_taper)
    taper; /**< none, or one a shape: widths at its ends */
    tz_ctx *ctx;
} tz_sample_graph;

/** Spacing and radius of the levels, coarse to fine. */
typedef struct tz_sample_levels {
    int32_t levels; /**< 1 .. TZ_SAMPLE_LEVELS */
    double spacing[TZ_SAMPLE_LEVELS], radius[TZ_SAMPLE_LEVELS];
} tz_sample_levels;

TZ_API void tz_sample_graph_deinit(tz_sample_graph *g); /**< takes zeroed */

/** The paper's defaults (spacing 40, 30, 25 and radius 60, 50, 40 for exemplars 250 to
 * 500 long), scaled so that the exemplar's longer side counts as 375.
 * @source [Tu20] Sec. 5.1, App. B, Table 2 */
TZ_API tz_sample_levels tz_sample_levels_default(const tz_curve_set *s);

/** Samples of one level, with what edges run along (shape, and taper where the curves have
 * some): at junctions, crossings, ends and corners, and between these
 * evenly, about `spacing` apart. Crossings join the paths that cross there.
 * @param spacing, radius  user units, > 0
 * @param[out] g  overwritten, not freed; zeroed on error
 * @return TZ_OK; TZ_INVALID (no curves and no elements; spacing); TZ_LIMIT (over 4
 *   million samples); TZ_NOMEM
 * @cost O(n log n) by pieces and samples */
TZ_API tz_status tz_sample_graph_make(tz_ctx *ctx, const tz_curve_set *s, double spacing,
                                      double radius, tz_sample_graph *g);

/** Links of all samples anew from g->edge; turns stay.
 * @return TZ_OK; TZ_INVALID (an edge names a sample that does not exist); TZ_NOMEM */
TZ_API tz_status tz_sample_graph_link(tz_sample_graph *g);

/** What algorithms rely on. @return TZ_OK; TZ_INVALID; TZ_NOMEM */
TZ_API tz_status tz_sample_graph_check(tz_ctx *ctx, const tz_sample_graph *g,
                                       const char *name);

/** An angle brought into [0, 2 pi). */
static inline double tz_curve_angle(double a)
{
    a -= floor(a / (2 * TZ_PI)) * (2 * TZ_PI);
    return a >= 0 && a < 2 * TZ_PI ? a : 0;
}
/** Smallest difference of two such angles, 0 .. pi. @source [Tu20] Eq. (6) */
static inline double tz_curve_angle_between(double a, double b)
{
    const double d = fabs(a - b);
    return d < TZ_PI ? d : 2 * TZ_PI - d;
}

#endif
