/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * How surely a region is a thing. Private to analysis/. */
#ifndef TZ_ANALYSIS_THINGS_SCORE_H
#define TZ_ANALYSIS_THINGS_SCORE_H

#include "analysis/things_tree.h"

enum { TZ_THINGS_FEATURES = 28, TZ_THINGS_HIDDEN = 24 };

/** Sizes of the picture's things, as log2 of the area. */
typedef struct tz_things_sizes {
    bool known;
    double middle, spread; /**< median, and 1.48 median distance from it */
} tz_things_sizes;

/** A perceptron with one hidden layer: p = s(out . g(in (x - mean) / deviation + bias) +
 * out_bias), g(h) = h / (1 + |h|), s logistic. */
typedef struct tz_things_net {
    float mean[TZ_THINGS_FEATURES], deviation[TZ_THINGS_FEATURES];
    float in[TZ_THINGS_FEATURES][TZ_THINGS_HIDDEN], bias[TZ_THINGS_HIDDEN];
    float out[TZ_THINGS_HIDDEN], out_bias;
} tz_things_net;

/** Nets for pictures whose sizes are not known yet [0] and known [1]; made by
 * tests/train_things.c. */
extern const tz_things_net tz_things_nets[2];

/** What the tree as a whole says about a picture. */
typedef struct tz_things_overview {
    double edge;  /**< mean over the leaves' outlines */
    double light; /**< mean lightness */
} tz_things_overview;
tz_things_overview tz_things_survey(const tz_things_tree *t);

void tz_things_describe(const tz_things_tree *t, const tz_things_overview *o,
                        const tz_things_sizes *sizes, int32_t node, float *feature);
double tz_things_score(const tz_things_net *net, const float *feature);

#endif
