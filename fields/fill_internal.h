/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Element fields, inside. Not installed.
 *
 * A thing of the palette is a model: discs with a graph. An element is a body: a model's
 * discs in the world, as samples. Variables, a sample each:
 *
 *   p  place          o  orientation matrix           c  scale         rho  1 - density
 *
 * Bodies of rigidity 100 and more have one o and one c: their samples share a node, the
 * limit of Eq. (9). In the plane a matrix that begins as a rotation stays (a, -b; b, a):
 * all terms treat both columns alike, so the first column is kept, and half of each
 * energy. In space all nine numbers are kept.
 *
 *   fill.c           driver            fill_model.c   palette, bodies
 *   fill_lists.c     what is awake, the diagram
 *   fill_solve.c     conjugate gradients over nodes
 *   fill_links.c     neighbours of samples, what the field says to them
 *   fill_peers.c     neighbours of rigid things
 *   fill_terms.c     Eq. (5) to (12): scale, density and orientation step
 *   fill_place.c     Eq. (1) to (4): distribution and graph step
 *   fill_guide.c     sizes between strokes, before there are things
 *   fill_start.c     initialisation, insertion, teleportation
 *   fill_repair.c    true outlines are kept apart: fill_outline_internal.h
 *   fill_edit.c      brushes, local work
 *   fill_paint.c     brushes led by a drawing
 *   fill_measure.c   figures of a layout
 * @source [Hsu20] Sec. Formulation, Solver */
#ifndef TZ_FIELDS_FILL_INTERNAL_H
#define TZ_FIELDS_FILL_INTERNAL_H

#include "fields/disc_cover.h"
#include "fields/fill.h"
#include "fields/power.h"

enum {
    TZ_FILL_BLOCK = 256,    /**< nodes or bodies that one task does; sums run block by
                                 block, so that threads do not matter */
    TZ_FILL_SERIAL = 2048,  /**< below that many the caller does all itself */
    TZ_FILL_HEAVY = 128,    /**< contacts, the same; serial below eight such blocks */
    TZ_FILL_MOST = 2000000, /**< bodies */
    TZ_FILL_PEERS = 6,      /**< things that a thing is compared with */
    TZ_FILL_BORDER = 64     /**< outline points of a model that contacts are found at */
};
#define TZ_FILL_GRAPH 100.0 /**< w_g of Eq. (4) */
#define TZ_FILL_RIGID 100.0 /**< rigidity from which samples are tied */

/** A thing of the palette, as drawn there, about its reference point. */
typedef struct tz_fill_model {
    int32_t symbol, kind;
    int32_t element;     /**< of the palette; -1 = an obstacle's */
    double angle, scale; /**< of the palette's element */
    double rigidity, share, size[2], turn, jitter;
    double area, reach; /**< of its shape; farthest that it gets from its centre */
    bool round;         /**< has no direction that is seen */
    double rim;         /**< farthest that its outline lies beyond the discs */
    int32_t n;          /**< discs */
    tz_vec3 rest[TZ_COVER_DISCS];
    double radius[TZ_COVER_DISCS];
    int32_t start[TZ_COVER_DISCS + 1], near[8 * TZ_COVER_DISCS]; /**< graph, both ways */
    double inverse[TZ_COVER_DISCS * TZ_COVER_DISCS]; /**< of 1 + 2 w_g Laplacian */
    double spread[2]; /**< its radii grow by 1 + rho (spread[0] + rho spread[1]), so that
                           its area grows by (1 + rho)^2 */
    tz_disc_cover cover;
    tz_vec2 *border; /**< points of the outline, evenly spaced */
    int32_t borders, samples;
    tz_vec2 *sample; /**< the palette element's own samples */
} tz_fill_model;

typedef struct tz_fill_body {
    int32_t model, first, n;
    double size;    /**< its own, against the palette's */
    double turn;    /**< its own, against its orientation */
    double x, y;    /**< size times cosine and sine of turn */
    int32_t source; /**< tz_fill.obstacle that it is written as, while nothing has moved
                         it; -1 = as it lies */
    bool fixed, gone, awake;
} tz_fill_body;

/** Sum over nodes of diag |x|^2 + x' block x, and over edges of w |x - x'|^2. */
typedef struct tz_fill_system {
    tz_ctx *ctx;
    int32_t nodes;       /**< that are unknown; others are held */
    const int32_t *node; /**< their indices */
    int m, columns;      /**< unknowns a node; weights an edge (m / columns share one) */
    const int32_t *start, *count,
        *to;             /**< edges of a node, each in both its ends' lists */
    const double *w;     /**< columns an edge */
    const double *diag;  /**< a node */
    const double *u;     /**< NULL, or m a node: adds rank (u u') */
    const double *rank;  /**< factor of it, a node */
    const double *block; /**< NULL, or m * m a node, added */
    double *work;        /**< 3 * m * size doubles, zero where nothing is unknown */
    int32_t size;        /**< indices are below it */
} tz_fill_system;

/** Solves for the step x with right side b by preconditioned conjugate gradients from 0.
 * @param b       m a node; the residual afterwards
 * @param small   a step of that size does not matter
 * @param[out] x  m a node, of unknown nodes; others untouched
 * @return TZ_OK; TZ_NOMEM; TZ_CANCELLED @cost O(rounds * edges) */
tz_status tz_fill_solve(const tz_fill_system *s, double *b, double small, int32_t rounds,
                        double *x);

/** Runs a body over blocks of items 0 .. n-1; sums[0..3] get its partial sums in a fixed
 * order. `sums` may be NULL. */
typedef void (*tz_fill_work)(void *arg, int32_t from, int32_t to, double sums[4]);
tz_status tz_fill_blocks(tz_ctx *ctx, int32_t n, tz_fill_work work, void *arg,
                         double sums[4]);
/** The same for work that costs half a microsecond an item: waking threads costs 100. */
tz_status tz_fill_heavy(tz_ctx *ctx, int32_t n, tz_fill_work work, void *arg,
                        double sums[4]);

typedef struct tz_fill_link {
    int32_t to;    /**< node */
    double wc, wr; /**< continuity, times how often; rigidity */
    double wt;     /**< continuity of directions */
} tz_fill_link;

/** Directions, sizes and densities between strokes, on a coarse grid; NULL = nothing is said. */
typedef struct tz_fill_guide {
    int32_t width, height;
    double *size, *rho, *x, *y;
    double least; /**< of size * (1 + rho) */
} tz_fill_guide;

struct tz_fill {
    tz_ctx *ctx;
    int dim, columns, m; /**< 2, 1, 2 in the plane; 3, 3, 9 in space */
    tz_domain domain;
    const tz_element_field *field;
    tz_fill_params par;
    uint64_t seed;
    tz_fill_job job;
    TZ_ARRAY(tz_fill_model)
    model;
    int32_t entries; /**< models of the palette come first */
    TZ_ARRAY(tz_fill_body)
    body;
    TZ_ARRAY(tz_element)
    obstacle; /**< as they came in the layout, with their samples */
    TZ_ARRAY(tz_sample)
    obstacle_sample;
    int32_t n, cap; /**< samples */
    int32_t made;   /**< bodies ever made: names random streams */
    tz_vec3 *at;
    double *radius; /**< at scale 1, its body's size in it */
    double *c, *rho, *o;
    double *wide; /**< factor of radii that rho asks for; see tz_fill_set_rho */
    int32_t *owner, *node;
    double unit; /**< mean radius of discs: lengths in energies */
    bool any_density, any_size, any_direction;
    bool any_soft, any_pointed; /**< of the models that have come so far */
    tz_fill_guide guide;
    tz_power *power;
    bool fresh; /**< the diagram is that of the places */
    bool known; /**< it is so at least of what is held */
    double *weight;
    /* what is awake, in rising order */
    TZ_ARRAY(int32_t)
    live;
    TZ_ARRAY(int32_t)
    live_sample;
    TZ_ARRAY(int32_t)
    live_node;
    bool all_live, stale; /**< lists need to be made */
    bool local;           /**< only what brushes touched is awake */
    TZ_ARRAY(int32_t)
    left, changed; /**< samples gone since the last diagram; that it changes */
    /* of one iteration, a sample each */
    double *target; /**< m: direction said; size, density said */
    double *target_c, *target_rho, *confident, *said_c, *said_rho;
    int32_t
        *peer; /**< TZ_FILL_PEERS a body, nearest first, -1 = no more; of what is awake */
    int32_t *named; /**< a body: links to peers */
    int32_t peer_cap;
    double *prior; /**< confidence of directions between strokes */
    int32_t *link_start, *link_count;
    TZ_ARRAY(tz_fill_link)
    link;
    int32_t *edge_to; /**< as many as links; in the distribution step, of conflicts */
    double *edge_w;
    int32_t edge_cap;
    double *diag, *rank, *gradient, *step, *kept, *block;
    double *work;
    double *pressure; /**< a sample: sum of what it lacks */
    double lambda;
    double guided; /**< factor of what is said between strokes */
    double calm;   /**< factor of Eq. (1); 1 as published */
    int32_t iteration;
    int32_t moved, shrunk, dropped, inserted;
};

static inline double tz_fill_radius(const tz_fill *f, int32_t s)
{
    return f->c[s] * f->wide[s] * f->radius[s];
}
/** The room that a sample takes: [Hsu20] has w_s' = (1 + rho) w_s, by which things of one
 * disc have (1 + rho)^2 times the area each, but rows of overlapping discs hardly more
 * than 1 + rho times. Here all of them have the same. */
static inline double tz_fill_spread(const tz_fill_model *m, double rho)
{
    return 1 + rho * (m->spread[0] + rho * m->spread[1]);
}
static inline void tz_fill_set_rho(tz_fill *f, int32_t s, double rho)
{
    f->rho[s] = rho;
    f->wide[s] = tz_fill_spread(&f->model.v[f->body.v[f->owner[s]].model], rho);
}
/** Vector from a place to another, over the nearest copy. */
static inline tz_vec3 tz_fill_vector(const tz_fill *f, tz_vec3 p, tz_vec3 q)
{
    return tz_domain_vector(&f->domain, p, q);
}
/** Cosine and sine of a sample, in the plane. */
static inline tz_vec2 tz_fill_turn(const tz_fill *f, int32_t s)
{
    const double *u = &f->o[(ptrdiff_t)f->node[s] * f->m];
    const double l = sqrt(u[0] * u[0] + u[1] * u[1]);
    return l > 0 ? (tz_vec2){u[0] / l, u[1] / l} : (tz_vec2){1, 0};
}
static inline double tz_fill_scale(const tz_fill *f, int32_t s)
{
    return f->c[f->node[s]];
}

/** A system over all awake nodes, of the weights that stand in the fill. */
static inline tz_fill_system tz_fill_system_of(const tz_fill *f, int m, int columns)
{
    return (tz_fill_system){.ctx = f->ctx,
                            .nodes = f->live_node.n,
                            .node = f->live_node.v,
                            .m = m,
                            .columns = columns,
                            .start = f->link_start,
                            .count = f->link_count,
                            .to = f->edge_to,
                            .w = f->edge_w,
                            .diag = f->diag,
                            .work = f->work,
                            .size = f->n};
}

/** What is awake is about to move. */
static inline void tz_fill_release(tz_fill *f)
{
    for (int32_t k = 0; k < f->live.n; k++)
        f->body.v[f->live.v[k]].source = -1;
}

/* fill_model.c */
tz_status tz_fill_models(tz_fill *f);
void tz_fill_model_deinit(tz_ctx *ctx, tz_fill_model *m);
tz_status tz_fill_model_of_symbol(tz_fill *f, const tz_element_set *set, int32_t symbol,
                                  int32_t *model);
/** Appends a body with its samples where a pose puts them. */
tz_status tz_fill_add_body(tz_fill *f, int32_t model, tz_vec3 at, double angle, double c,
                           double size, double turn, int32_t *out);
/** Puts a body anew. */
void tz_fill_put(tz_fill *f, int32_t body, tz_vec3 at, double angle, double c);
tz_status tz_fill_reserve(tz_fill *f, int32_t samples);
tz_vec3 tz_fill_centre(const tz_fill *f, int32_t body);
/** Pose that fits a body's discs: where its reference point is, its angle and scale. */
void tz_fill_pose(const tz_fill *f, int32_t body, tz_vec2 *at, double *angle,
                  double *scale);
/** A place of a body's model in the world, by its discs; and back. */
tz_vec2 tz_fill_to_world(const tz_fill *f, int32_t body, tz_vec2 p);
tz_vec2 tz_fill_to_model(const tz_fill *f, int32_t body, tz_vec2 world, double *scale,
                         tz_vec2 *turn);
/** Drops bodies that are gone and puts the others in an order of places. */
tz_status tz_fill_pack(tz_fill *f, bool sort);

/* fill_edit.c */
/** A body leaves. */
tz_status tz_fill_remove(tz_fill *f, int32_t body);

/* fill_start.c */
tz_status tz_fill_begin_bodies(tz_fill *f, const tz_element_set *layout);
tz_status tz_fill_count(tz_fill *f, double *count);
tz_status tz_fill_start_bodies(tz_fill *f, int32_t count);
/** A body of the mix (or of one entry) at a place, as the field says. */
tz_status tz_fill_new_body(tz_fill *f, int32_t entry, tz_vec3 at, int32_t *out);
tz_status tz_fill_teleport(tz_fill *f, double share);
/** The hardest pressed leave. */
tz_status tz_fill_relieve(tz_fill *f, int32_t count);
/** Empty places, largest against what lies there first: local maxima of the diagram's corners. */
typedef struct tz_fill_gap {
    double radius, size; /**< size: radius against the things about it */
    tz_vec3 at;
    int32_t sample;
} tz_fill_gap;
tz_status tz_fill_gaps(tz_fill *f, double least, int32_t most, tz_fill_gap **out,
                       int32_t *n);

/* fill_repair.c */
/** Between iterations: true outlines go apart, the hardest pressed to empty places. */
tz_status tz_fill_loosen(tz_fill *f);

/* fill_guide.c */
tz_status tz_fill_guide_init(tz_fill *f);
void tz_fill_guide_deinit(tz_fill *f);
/** Direction, size and 1 - density, as said there or harmonic between. */
double tz_fill_angle(const tz_fill *f, tz_vec3 at);
/** The same as a unit vector; returns how much strokes about agree, 0 .. 1. */
double tz_fill_direction(const tz_fill *f, tz_vec3 at, tz_vec2 *v);
double tz_fill_size(const tz_fill *f, tz_vec3 at);
double tz_fill_rho(const tz_fill *f, tz_vec3 at);

/* fill_lists.c */
/** Lists of what is awake, unless nothing woke, came or left. */
tz_status tz_fill_lists(tz_fill *f);
/** The diagram of all samples, unless it is fresh. */
tz_status tz_fill_diagram(tz_fill *f);

/* fill_peers.c */
/** Of each thing that is awake the nearest rigid ones that point somewhere. */
tz_status tz_fill_peers(tz_fill *f);
/** How many links that makes; adds them behind those of samples. */
void tz_fill_count_peers(tz_fill *f);
void tz_fill_link_peers(tz_fill *f);
/** Round things take the mean direction of their peers. */
void tz_fill_turn_rounds(tz_fill *f);
/** Where a rigid body's reference point is. */
tz_vec3 tz_fill_middle(const tz_fill *f, const tz_fill_body *b);

/* fill_links.c */
/** After the cells are known: links, what the field says. */
tz_status tz_fill_neighbours(tz_fill *f, const tz_power_cells *cells);

/* fill_terms.c */
tz_status tz_fill_scale_step(tz_fill *f, double before_after[2]);
tz_status tz_fill_turn_step(tz_fill *f, double before_after[2]);
/** Directions anew, for the places where things lie. */
tz_status tz_fill_turn_again(tz_fill *f);
/** Half gradient and energy of the orientation terms; grad of m a node may be NULL. */
tz_status tz_fill_turn_energy(tz_fill *f, double sums[4], bool gradient);

/* fill_place.c */
/** Ends the use of links: their edges become those of conflicts. */
tz_status tz_fill_distribution_step(tz_fill *f, const tz_power_cells *cells,
                                    const tz_vec3 *centre, double before_after[2],
                                    double terms[3]);
tz_status tz_fill_graph_step(tz_fill *f, double before_after[2], double *energy);

#endif
