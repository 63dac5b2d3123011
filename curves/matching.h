/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * How alike samples and neighbourhoods of two sample graphs are. The output graph `o` is
 * held against the exemplar's graph `i`.
 * @source [Tu20] Sec. 4.2, Eq. (2) to (11) */
#ifndef TZ_CURVES_MATCHING_H
#define TZ_CURVES_MATCHING_H

#include "curves/assign.h"
#include "curves/sample_graph.h"

enum { TZ_MATCH_MOST = TZ_ASSIGN_MOST /**< samples of a neighbourhood: the nearest */ };

/* ---- samples ---------------------------------------------------------------------- */

/** Edge set difference: the least sum of |e - m(e)| over one-to-one pairs of edges as
 * vectors, and beta for each edge that one sample has more. 0 where the output's sample
 * has no edges: a new one that wants some.
 * @param beta    the sampling distance
 * @param[out] to NULL, or for each of the output's edges the one that it is matched with
 *   (number within the other's), -1 = none; room for TZ_ASSIGN_MOST
 * @source [Tu20] Eq. (5). Deviates: of more than 64 edges the rest counts as unmatched */
TZ_API double tz_match_edges(const tz_sample_graph *o, int32_t so,
                             const tz_sample_graph *i, int32_t si, double beta,
                             int32_t *to);

/** Orientation matching: the least sum of angles over one-to-one pairs, each < 2 pi.
 * @param n, m    up to TZ_ASSIGN_MOST each
 * @param[out] to for each of a's the number within b, -1 = none (where n > m)
 * @source [Tu20] Eq. (6) */
TZ_API double tz_match_turns(const double *a, int32_t n, const double *b, int32_t m,
                             int32_t *to);

/* ---- neighbourhoods ---------------------------------------------------------------- */

/** Neighbourhoods of all samples: those of sample s are items first[s] .. first[s + 1] -
 * 1, nearest first, without s itself. */
typedef struct tz_match_hoods {
    int32_t n;
    int32_t *first;
    int32_t *id;  /**< sample */
    float *x, *y; /**< offset from the centre */
    tz_ctx *ctx;
} tz_match_hoods;

/** @param[out] h  overwritten, not freed; zeroed on error
 * @return TZ_OK; TZ_NOMEM; TZ_LIMIT  @cost O(n k log k) at k neighbours */
TZ_API tz_status tz_match_hoods_make(tz_ctx *ctx, const tz_sample_graph *g, double radius,
                                     tz_match_hoods *h);
TZ_API void tz_match_hoods_deinit(tz_match_hoods *h); /**< takes zeroed */

typedef struct tz_match_params {
    double gamma; /**< weight of attributes beside positions; 0: edges do not count */
    double more;  /**< the exemplar's neighbourhoods reach this much farther, so that what
                       lies at the rim of the output's finds its partner */
    bool hard;   /**< every sample must match as long as there are partners: staying alone
                       costs more than any match ([Tu20] Fig. 6a) */
    double lack; /**< spacings that each sample costs which the exemplar's neighbourhood
                          has well inside and the output's lacks; 0 as in Eq. (7) */
    const bool *cut; /**< NULL, or per sample of the exemplar: it has more edges than are
                          seen, as its border cuts them: a lack of edges costs nothing */
} tz_match_params;
TZ_API tz_match_params tz_match_params_default(void); /**< 0.5, 1.25, soft, 0, NULL */

/** What all matches between two graphs share. Borrowed graphs must not change under it.
 * Where the output's domain has frames, its neighbourhoods are turned back by the frame at
 * their centre, and its edges by the frame at their sample. */
typedef struct tz_matcher {
    const tz_sample_graph *o, *i;
    tz_match_params params;
    tz_match_hoods ho, hi; /**< neighbourhoods; ho's offsets as they are matched */
    int32_t *inner;        /**< per sample of the exemplar: neighbours well inside */
    float *exit;           /**< per output sample: cost of staying alone, c */
    float *edges; /**< gamma * Eq. (5) of all pairs, rows are output samples; NULL
                                where that would be over 256 MiB */
    bool mixed;   /**< there are elements: samples of unlike q never match */
    tz_ctx *ctx;
} tz_matcher;

/** @param params  NULL = default
 * @param[out] m  overwritten, not freed; zeroed on error
 * @return TZ_OK; TZ_INVALID (empty exemplar); TZ_NOMEM; TZ_CANCELLED
 * @cost O(no ni) for the table of edges, on all threads */
TZ_API tz_status tz_matcher_init(tz_ctx *ctx, const tz_sample_graph *o,
                                 const tz_sample_graph *i, const tz_match_params *params,
                                 tz_matcher *m);
TZ_API void tz_matcher_deinit(tz_matcher *m); /**< takes zeroed */

/** Difference of the neighbourhoods of so and si, the two being matched with each other.
 * @param w       scratch of a worker; row k of its result w->to is the k-th neighbour of
 *   so, its column the neighbour of si that it is matched with, -1 = an outlier
 * @param warm    w holds the last match with the same si
 * @param enough  gives up as soon as the cost is known to reach this
 * @return the cost; INFINITY if it is `enough` or more, or the two never match
 * @source [Tu20] Eq. (7) to (11) */
TZ_API float tz_match(const tz_matcher *m, int32_t so, int32_t si, tz_assign *w,
                      bool warm, float enough);

#endif
