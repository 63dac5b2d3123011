/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Which regions of the tree are things: the best choice of disjoint ones. Private to
 * analysis/. */
#ifndef TZ_ANALYSIS_THINGS_CHOOSE_H
#define TZ_ANALYSIS_THINGS_CHOOSE_H

#include "analysis/things_score.h"

typedef struct tz_things_choice {
    double least, most;        /**< px: areas outside of this are no things */
    double certainty;          /**< see tz_things_params */
    const tz_things_net *nets; /**< two; NULL = tz_things_nets */
} tz_things_choice;

/** @param[out] chosen   nodes, rising; appended to an empty array
 *  @param[out] sure     NULL, or t->n: how surely each node is a thing
 *  @param[out] sizes    of the things chosen before the last round */
typedef TZ_ARRAY(int32_t)
tz_things_nodes;
tz_status tz_things_choose(tz_ctx *ctx, const tz_things_tree *t,
                           const tz_things_choice *how, tz_things_nodes *chosen,
                           float *sure, tz_things_sizes *sizes);

/** Sizes of some nodes: median and spread of log2 area; unknown for fewer than 4. */
tz_status tz_things_measure_sizes(tz_ctx *ctx, const tz_things_tree *t,
                                  const tz_things_nodes *of, tz_things_sizes *out);

#endif
