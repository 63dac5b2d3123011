/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Parts of tz_element_propagate.
 *
 *   before, after ──pairs──▶ who is who ──changes──▶ examples
 *            ──likeness──▶ how like each element is to each example, and how turned */
#ifndef TZ_ELEMENTS_PROPAGATE_INTERNAL_H
#define TZ_ELEMENTS_PROPAGATE_INTERNAL_H

#include "elements/cells.h"
#include "elements/pairing.h"
#include "elements/propagate.h"

/** One thing that the artist did. */
typedef struct tz_example {
    int32_t before; /**< element; of an added one that which it belongs to */
    int32_t after;  /**< element, or -1: removed */
    bool added;
    double alike; /**< limit of likeness */
} tz_example;

/** How an element sees an example. */
typedef struct tz_likeness {
    float distance; /**< INFINITY = not at all alike */
    float turn;     /**< of the element's neighbourhood against the example's */
} tz_likeness;

typedef struct tz_propagation {
    tz_ctx *ctx;
    const tz_element_set *before, *after;
    tz_propagate_params p;
    double spacing, radius;
    int32_t *kind;    /**< of each of after's kinds: that in before, or -1 */
    int32_t *partner; /**< of each element before: the one after, or -1 */
    int32_t *origin;  /**< the reverse */
    uint8_t *changed; /**< of each element before: by the artist */
    TZ_ARRAY(tz_example)
    example;
    tz_likeness *likeness; /**< elements before, each with all examples */
} tz_propagation;

/** Fills partner, origin, changed and example (propagate_pairs.c). */
tz_status tz_propagate_pairs(tz_propagation *g);
/** Fills likeness and the examples' limits (propagate_likeness.c). */
tz_status tz_propagate_likeness(tz_propagation *g);

#endif
