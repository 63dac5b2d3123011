/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Parts of the optimisation of curve textures and what passes between them.
 *
 *   start --> search --> votes --> positions, existence, edges, orientations --+
 *               ^   who is my match,   what all neighbourhoods say of me       |
 *               +--------------------------------------------------------------+
 *
 * The output graph `o` lies in the domain's coordinates, and on a plain domain `margin`
 * beyond its border, too: what is kept of that in the end runs over the border. */
#ifndef TZ_CURVES_SYNTHESIS_INTERNAL_H
#define TZ_CURVES_SYNTHESIS_INTERNAL_H

#include "base/rng.h"
#include "curves/matching.h"
#include "curves/synthesis.h"

/* ---- the exemplar of a level (synthesis_exemplar.c) ------------------------------- */

/** Nearest sample of curves of each place, on a raster. */
typedef struct tz_curve_lookup {
    tz_vec2 origin;
    double cell;
    int32_t nx, ny;
    int32_t *id;
} tz_curve_lookup;

typedef struct tz_curve_model {
    tz_sample_graph g;
    bool *cut;    /**< per sample: an end that only the exemplar's border makes */
    double apart; /**< how near to each other its samples lie, up to the spacing: nine in
                       ten are no nearer */
    tz_curve_lookup look;
    TZ_ARRAY(int32_t)
    by_q; /**< samples in rising order of q */
    tz_ctx *ctx;
} tz_curve_model;

tz_status tz_curve_model_init(tz_ctx *ctx, const tz_curve_set *exemplar, double spacing,
                              double radius, tz_curve_model *m);
void tz_curve_model_deinit(tz_curve_model *m);
/** Sample of that q which is nearest to a place of the exemplar, no end that the border
 * makes; -1 if there is none. */
int32_t tz_curve_model_nearest(const tz_curve_model *m, tz_vec2 at, int32_t q);
/** Any sample of that q, drawn evenly; -1 if there is none. */
int32_t tz_curve_model_any(const tz_curve_model *m, int32_t q, tz_rng *r);
/** Whether the exemplar tells what is at a place. */
bool tz_curve_model_knows(const tz_curve_model *m, tz_vec2 at);

/* ---- state ------------------------------------------------------------------------ */

/** What samples of the output hear of themselves: item k of sample s in first[s] ..
 * first[s + 1] - 1 is the neighbourhood of centre[k], rising, which takes s for sample
 * seen[k] of the exemplar. */
enum {
    TZ_SEEN_NOT = -1,    /**< an outlier */
    TZ_SEEN_UNKNOWN = -2 /**< an outlier where the exemplar ends: no vote */
};
typedef struct tz_curve_votes {
    int32_t *first, *centre, *seen;
    float *weight; /**< per centre: how much it says, 1 on average */
} tz_curve_votes;

typedef struct tz_curve_solve {
    tz_ctx *ctx;
    const tz_curve_synthesis_job *job;
    tz_curve_synthesis_params p;
    tz_sample_levels levels;
    double margin;
    int32_t level, iteration;
    bool last; /**< iteration of the last level: nothing is added any more */
    const tz_curve_model *x;
    tz_sample_graph o;
    TZ_ARRAY(int32_t)
    match; /**< per sample: exemplar's sample, -1 = none yet */
    TZ_ARRAY(int32_t)
    body; /**< per element of the output (tz_curve_sample.element): the exemplar's that it
               copies; -1 = given */
    /* of one iteration */
    tz_matcher m;
    float *cost;   /**< per sample: Eq. (7) of its match; INFINITY = none */
    int32_t *pair; /**< per item of m.ho: sample of the exemplar, or TZ_SEEN_... */
    tz_curve_votes votes;
    double *want;  /**< per sample: number of edges voted for, Eq. (17) */
    tz_vec2 *move; /**< per sample */
    bool *drop;    /**< per sample */
    TZ_ARRAY(tz_curve_sample)
    extra; /**< samples to add; turn = exemplar's sample that each is like */
    TZ_ARRAY(tz_curve_edge)
    edge; /**< the next edges */
} tz_curve_solve;

/** Depth of a place in what is synthesised: the domain and the margin about it. */
static inline double tz_curve_solve_depth(const tz_curve_solve *t, tz_vec2 p)
{
    return tz_domain_depth(t->job->domain, (tz_vec3){p.x, p.y, 0}) + t->margin;
}
static inline double tz_curve_solve_frame(const tz_curve_solve *t, tz_vec2 p)
{
    return tz_domain_frame(t->job->domain, (tz_vec3){p.x, p.y, 0});
}
static inline tz_vec2 tz_curve_rotate(tz_vec2 v, double angle)
{
    const double c = cos(angle), s = sin(angle);
    return (tz_vec2){c * v.x - s * v.y, s * v.x + c * v.y};
}
static inline tz_vec2 tz_curve_vector(const tz_domain *d, tz_vec2 p, tz_vec2 q)
{
    const tz_vec3 v = tz_domain_vector(d, (tz_vec3){p.x, p.y, 0}, (tz_vec3){q.x, q.y, 0});
    return (tz_vec2){v.x, v.y};
}
static inline tz_vec2 tz_curve_wrapped(const tz_domain *d, tz_vec2 p)
{
    const tz_vec3 v = tz_domain_wrap(d, (tz_vec3){p.x, p.y, 0});
    return (tz_vec2){v.x, v.y};
}

/** Appends a sample with its match. */
tz_status tz_curve_solve_add(tz_curve_solve *t, const tz_curve_sample *p, int32_t match);
/** Puts a whole element of the exemplar so that its sample `sample` (of the exemplar's
 * graph) lies at a place; nothing where one lies already. */
tz_status tz_curve_solve_place(tz_curve_solve *t, int32_t sample, tz_vec2 at);

/* ---- steps, in order --------------------------------------------------------------- */

/** First graph of the first level (synthesis_start.c, synthesis_patches.c). */
tz_status tz_curve_solve_start(tz_curve_solve *t);
tz_status tz_curve_solve_patches(tz_curve_solve *t);
/** Appends curves with origins, sampled where the exemplar is, with their matches
 * (synthesis_trace.c). */
tz_status tz_curve_solve_trace(tz_curve_solve *t, const tz_curve_set *from);
/** The graph of the next level from that of the last (synthesis_start.c).
 * @param coarse  the exemplar of the level that t->o belongs to; t->x is the next */
tz_status tz_curve_solve_refine(tz_curve_solve *t, const tz_curve_model *coarse);

/** Neighbourhoods, matches and pairs; frees those before (synthesis_search.c). */
tz_status tz_curve_solve_search(tz_curve_solve *t, int32_t rounds);
void tz_curve_solve_forget(tz_curve_solve *t);
/** Sorts what neighbourhoods say by whom they say it of (synthesis_votes.c). */
tz_status tz_curve_solve_votes(tz_curve_solve *t);
/** t->move by Eq. (14) (synthesis_positions.c). */
tz_status tz_curve_solve_positions(tz_curve_solve *t);
/** t->drop and t->extra by Eq. (15), Algorithm 1 (synthesis_existence.c). */
tz_status tz_curve_solve_existence(tz_curve_solve *t);
/** t->edge by Eq. (16) to (21) (synthesis_edges.c). */
tz_status tz_curve_solve_edges(tz_curve_solve *t);
/** One pen a line of t->edge (synthesis_pens.c). */
tz_status tz_curve_solve_pens(tz_curve_solve *t);
/** Orientations of the samples of `next`: those that stay, in order, then those that come
 * (synthesis_turns.c). */
tz_status tz_curve_solve_turns(tz_curve_solve *t, tz_sample_graph *next);

/** Poses of the output's elements (synthesis_elements.c): brings their samples back into
 * shape, and makes the set in the end. */
tz_status tz_curve_solve_shapes(tz_curve_solve *t);
tz_status tz_curve_solve_elements(tz_curve_solve *t, tz_element_set *to);

#endif
