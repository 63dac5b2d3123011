/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Parts of the energy solver and what passes between them.
 *
 *   start ──▶ search ──▶ assign ──▶ search ──▶ assign ──▶ ...
 *             who is my match,      where all
 *             who pairs with whom   votes put me
 */
#ifndef TZ_ELEMENTS_ENERGY_INTERNAL_H
#define TZ_ELEMENTS_ENERGY_INTERNAL_H

#include "base/rng.h"
#include "elements/cells.h"
#include "elements/energy.h"
#include "elements/pairing.h"

#define TZ_ENERGY_NEAR 32 /**< neighbours of an output sample at most */

/* ---- exemplar (energy_exemplar.c) ------------------------------------------------ */

typedef struct tz_energy_exemplar {
    tz_ctx *ctx;
    const tz_element_set *set;
    double spacing; /**< side of the square that one element has to itself */
    double radius;  /**< of wanted neighbourhoods */
    double limit;   /**< pairs farther apart than this stay unpaired */
    double attribute;
    int32_t n;         /**< samples */
    int32_t *owner;    /**< element of each sample */
    int32_t *label;    /**< class and sample id in one number, 0..labels-1 */
    float *a, *b;      /**< attributes, see tz_pairing_side */
    uint64_t *inner;   /**< which of a sample's neighbours lie within the radius: bits */
    int32_t *member;   /**< TZ_PAIRING_MOST a sample: who its neighbours are */
    int32_t *similar;  /**< `coherent` a sample: others of alike neighbourhood, or -1 */
    int32_t *by_label; /**< samples sorted by label */
    int32_t *label_first; /**< labels + 1 offsets into by_label */
    uint64_t *key;        /**< of each label: class and sample id, rising */
    tz_pairing_side *side;
    int32_t labels, coherent;
    bool attributes; /**< do they differ anywhere */
} tz_energy_exemplar;

tz_status tz_energy_exemplar_init(tz_ctx *ctx, tz_energy_exemplar *x,
                                  const tz_element_set *set, const tz_energy_params *p);
void tz_energy_exemplar_deinit(tz_energy_exemplar *x);
/** Does neighbour j of sample k lie within the radius? */
static inline bool tz_energy_within(const tz_energy_exemplar *x, int32_t k, int32_t j)
{
    return x->inner[k] >> j & 1;
}
/** Fills x->similar (energy_similar.c). @cost O(n) pairings, n^2 short vectors up to 2,048
 * samples of a label, then O(n) */
tz_status tz_energy_find_similar(tz_energy_exemplar *x);
/** Label of a class and sample id, -1 where the exemplar has none such. */
int32_t tz_energy_label(const tz_energy_exemplar *x, int32_t kind, int32_t id);
/** Attributes of an element as a vector, in the frame of the given angle. */
tz_vec2 tz_energy_attribute(const tz_energy_exemplar *x, const tz_element *e,
                            double frame);
/** Side of the square that an element has on average. */
double tz_energy_spacing(const tz_element_set *set);

/* ---- start (energy_start.c) ------------------------------------------------------ */

/** Fills the output's domain (all starts but TZ_ENERGY_GIVEN). */
tz_status tz_energy_fill(tz_ctx *ctx, const tz_element_set *exemplar,
                         const tz_energy_params *p, double patch, tz_element_set *output);

/* ---- zones (energy_zones.c) ------------------------------------------------------ */

/** Element i of the exemplar if it is whole and may lie at a place; else one of its kind,
 * or, where that may not lie there, of one that may; -1 if there is none. */
int32_t tz_energy_choose(const tz_element_set *from, const tz_domain *d, int32_t i,
                         tz_vec3 at, tz_rng *r);
typedef struct tz_energy_forbidden {
    tz_vec3 at;
    int32_t source; /**< element of the exemplar that may not lie there */
} tz_energy_forbidden;
/** Puts others in the place of forbidden ones, where there is room for them. */
tz_status tz_energy_substitute(tz_element_set *to, const tz_element_set *from,
                               const tz_energy_forbidden *list, int32_t n, uint64_t seed);
/** The same for elements that lie where zones forbid it. */
tz_status tz_energy_constrain(tz_element_set *s, const tz_element_set *from,
                              uint64_t seed);

/* ---- state ----------------------------------------------------------------------- */

/** What an output sample is pulled to by one neighbourhood: edge from its centre. */
typedef struct tz_energy_pull {
    float x, y; /**< predicted offset less the present one */
} tz_energy_pull;

typedef struct tz_energy_state {
    tz_ctx *ctx;
    const tz_energy_exemplar *x;
    const tz_energy_hook *hook;
    tz_element_set *set; /**< the output */
    uint64_t seed;
    double border;
    int32_t shape;      /**< tz_shape */
    int32_t n;          /**< samples; here they are numbered along the domain's cells */
    int32_t *sample;    /**< number in the set of each */
    int32_t *place;     /**< the reverse */
    int32_t *owner;     /**< element */
    int32_t *label;     /**< in the exemplar, or -1 */
    tz_vec3 *at;        /**< positions while solving, same as the set's */
    tz_vec2 *attribute; /**< of search: of each, in a frame of angle 0 */
    float *weight;
    bool weighted;  /**< some weight is not 1 */
    int32_t *match; /**< exemplar sample, or -1 */
    double *cost;   /**< Eq. (1) and (6) of each match */
    int32_t *count; /**< neighbours of each */
    int32_t *near;  /**< TZ_ENERGY_NEAR a sample, rising numbers */
    int32_t *pair;  /**< exemplar sample that pairs with this neighbour, or -1 */
    tz_energy_pull *pull;
    int32_t *vote_first; /**< n + 1: edges that lead to a sample */
    TZ_ARRAY(int32_t)
    vote; /**< exemplar sample by which the sample is seen in the other's match */
    TZ_ARRAY(int32_t)
    edge; /**< number of that edge: centre * TZ_ENERGY_NEAR + place in its list */
    tz_cells cells;
    void *worker; /**< scratch of search */
} tz_energy_state;

tz_status tz_energy_state_init(tz_ctx *ctx, tz_energy_state *t,
                               const tz_energy_exemplar *x, tz_element_set *output,
                               const tz_energy_params *p);
void tz_energy_state_deinit(tz_energy_state *t);
double tz_energy_frame(const tz_energy_state *t, tz_vec3 at);
/** Share of a place that lies inside, Eq. (6): 1 inside, falling to 0 half a spacing
 * beyond the border of a region. */
double tz_energy_inside(const tz_energy_state *t, tz_vec3 at);
/** The way from a place outside the domain back to its border; 0, 0 inside. */
tz_vec2 tz_energy_back(const tz_domain *d, tz_vec3 at);

/* ---- steps ----------------------------------------------------------------------- */

/** Finds neighbours, matches and pairs (energy_search.c). @param[out] energy  Eq. (2) */
tz_status tz_energy_search(tz_energy_state *t, int32_t round, double *energy);
/** Adds and removes elements as the present matches want it (energy_existence.c); matches
 * of those that stay are kept, a search must follow. */
tz_status tz_energy_existence(tz_energy_state *t, int32_t round, bool *changed);
/** Takes elements out of a set. @param carry  NULL, or a number for each sample, which go
 * along with them */
tz_status tz_energy_drop(tz_element_set *s, const uint8_t *drop, int32_t *carry);
/** Gathers for each sample the edges that lead to it. */
tz_status tz_energy_votes(tz_energy_state *t);
/** Moves samples and elements, takes over attributes (energy_assign.c). */
tz_status tz_energy_assign(tz_energy_state *t);
/** Moves an element with its samples, which keep its shape (energy_move.c). */
void tz_energy_move(tz_energy_state *t, tz_element *e, const tz_vec2 *move);
/** Attributes that its neighbours vote for, Eq. (5). */
void tz_energy_elect(tz_energy_state *t, tz_element *e);
/** Eq. (4): sum over all pairs of squared error of position. */
double tz_energy_of_positions(const tz_energy_state *t);
/** The least squares of energy_assign.c alone. @param[out] move  t->n vectors */
tz_status tz_energy_fit(tz_energy_state *t, double tolerance, tz_vec2 *move);
/** How much an element's own position counts in it. */
#define TZ_ENERGY_ANCHOR 0.5

#endif
