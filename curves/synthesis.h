/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Curve textures by optimisation: a graph of samples that is everywhere like the
 * exemplar's, coarse to fine; search and assignment by turns.
 *
 *   exemplar -> graph of each level      (curves/sample_graph.h)
 *   start: patches, noise, or a given graph
 *   level: { search (PatchMatch); assign positions, existence, edges, orientations } x 7
 *   between levels: samples of the next spacing along what the last level has drawn
 *
 * On a plain domain, and along a region's border, more is synthesised than is asked for
 * (three fifths of the first level's radius) and then cut away but for the edges that run
 * over the border: clip what is reconstructed.
 *
 * @source [Tu20] Sec. 4.3, Eq. (12) to (21), App. A. Deviates, as broken ends and crowded
 *   lines remain else:
 *   - spacings shrink to the room that a line of the exemplar has, the finest level's most;
 *   - a match pays for samples that it lacks, too, and matches that are good have more say;
 *   - ends that the exemplar's border cuts, and places beyond it, have no say;
 *   - edges hold the length and direction of the exemplar's edge that they are like;
 *   - candidates and crowding go by the exemplar's own least distances, not by delta;
 *   - patches bring edges and matches along, levels hand matches down, the last iteration
 *     of a level adds nothing, a line keeps one pen;
 *   - given curves with origins are sampled where the exemplar is, and what of them is just
 *     as there stays to the bit. */
#ifndef TZ_CURVES_SYNTHESIS_H
#define TZ_CURVES_SYNTHESIS_H

#include "base/param.h"
#include "curves/sample_graph.h"

typedef enum tz_curve_start {
    TZ_CURVE_PATCHES, /**< patches whose borders fit best */
    TZ_CURVE_NOISE, /**< samples at random places, as many as the exemplar's density asks
                           for ([Tu20] Fig. 14) */
    TZ_CURVE_GIVEN  /**< job.start: curves, sampled at the first level */
} tz_curve_start;

/** Table: tz_curve_synthesis_param_table. */
typedef struct tz_curve_synthesis_params {
    int32_t start;      /**< tz_curve_start */
    int32_t levels;     /**< 1 .. TZ_SAMPLE_LEVELS; with GIVEN the last ones of them */
    int32_t iterations; /**< a level; 7 */
    double scale;       /**< of spacings and radii against those that are chosen for the
                             exemplar (from tz_sample_levels_default downwards); 1 */
    bool edges;         /**< edges count in matching; off: Fig. 16, no edge term */
    bool robust;    /**< samples may stay unmatched; off: Fig. 16, no robust matching */
    bool existence; /**< samples come and go; off: Fig. 16, no existence step */
} tz_curve_synthesis_params;
TZ_API extern const tz_param_table tz_curve_synthesis_param_table;

/** State after an iteration. */
typedef struct tz_curve_energy {
    int32_t level, iteration;
    int32_t samples, edges;
    double match;          /**< Eq. (12), first term: sum over samples of Eq. (7) */
    double domain;         /**< Eq. (12), second term */
    double mean;           /**< match over samples, in units of the level's spacing */
    double neighbours;     /**< samples of a neighbourhood, on average */
    double search, assign; /**< what both steps took, seconds */
} tz_curve_energy;

typedef struct tz_curve_synthesis_job {
    const tz_curve_set *exemplar; /**< planar; its elements are part of the pattern */
    const tz_domain *domain;      /**< size, torus, region, frames */
    const tz_curve_set *given; /**< NULL, or what is drawn there already, in the domain's
                                       coordinates: stays as it is, and what is made fits it */
    const tz_curve_set *start; /**< for TZ_CURVE_GIVEN; best with origins */
    const tz_curve_synthesis_params *params; /**< NULL = defaults */
    uint64_t seed;
    /** NULL, or called after each iteration with the graph as it is; `user` is handed on.
     */
    void (*trace)(void *user, const tz_curve_energy *e, const tz_sample_graph *g);
    void *user;
} tz_curve_synthesis_job;

/** @param[out] out  the finest level's graph over job->domain; samples of `given` are
 *   fixed. Each edge tells which edge of `exemplar_graph` it is like (tz_curve_edge.like).
 *   Overwritten, not freed; zeroed on error
 * @param[out] exemplar_graph  the exemplar's finest graph, or NULL
 * @param[out] elements  NULL, or the exemplar's elements where the samples put them
 *   (by similarity, Sec. 4.4.1): a set made by tz_element_set_like
 * @return TZ_OK; TZ_INVALID (nothing to go by: no samples, a domain without area, ...);
 *   TZ_LIMIT; TZ_NOMEM; TZ_CANCELLED
 * @cost linear in the output's samples */
TZ_API tz_status tz_curve_synthesis(tz_ctx *ctx, const tz_curve_synthesis_job *job,
                                    tz_sample_graph *out, tz_sample_graph *exemplar_graph,
                                    tz_element_set *elements);

#endif
