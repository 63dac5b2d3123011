/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Shared by curve_centre.c and curve_mend.c. Not installed. */
#ifndef TZ_CURVES_CURVE_CENTRE_INTERNAL_H
#define TZ_CURVES_CURVE_CENTRE_INTERNAL_H

#include "base/grid.h"
#include "elements/element_shape.h"

typedef struct chain {
    int32_t first, n; /* points */
    int32_t a, b;     /* cells of its ends; -1 = a loop */
    double length, width;
    bool gone;
} chain;

typedef struct centring {
    tz_ctx *ctx;
    tz_polys polys;
    double width; /* mean */
    double cell;
    tz_vec2 origin, view;
    int32_t w, h;
    uint8_t *v;
    TZ_ARRAY(int32_t)
    ink; /* cells */
    TZ_ARRAY(tz_vec2)
    point;
    TZ_ARRAY(chain)
    chain;
    tz_grid outline;
} centring;

/* Ends of chains at cells: 2 k is where chain k begins, 2 k + 1 where it ends. */
typedef struct ended {
    int32_t cell, end;
} ended;

/** Ends of all chains that are not gone, by cell; loops have none.
 * @param out  room for two a chain  @return how many */
int32_t tz_centring_ends(const centring *c, ended *out);

/** Lines of a thinned shape bend towards each other where they meet. Their ends there are
 * cut off and drawn anew: the two that run on into each other as one curve, the others
 * straight up to it.
 * @param e  room for two a chain  @return TZ_OK; TZ_NOMEM */
tz_status tz_centring_mend(centring *c, ended *e);

#endif
