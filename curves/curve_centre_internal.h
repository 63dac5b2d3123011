/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Shared by curve_centre.c, curve_prune.c and curve_mend.c. Not installed. */
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

/** Moves a point to the middle between the outlines on both sides.
 * @return how wide the shape is there, 0 = not known */
double tz_centring_to_middle(const centring *c, tz_vec2 *p);
/** Marks chains gone that are shorter than the shape is wide where they end.
 * @param degree  room for two a chain */
void tz_centring_prune(centring *c, ended *e, int32_t *degree);
/** Joins chains at cells where just two meet, to chains of new points. */
tz_status tz_centring_splice(centring *c, ended *e);
/** Drops what is connected and not four times as long as wide. */
tz_status tz_centring_drop_stout(centring *c, ended *e);

/** Lines of a thinned shape bend towards each other where they meet. Their ends there are
 * cut off and drawn anew: the two that run on into each other as one curve, the others
 * straight up to it.
 * @param e  room for two a chain  @return TZ_OK; TZ_NOMEM */
tz_status tz_centring_mend(centring *c, ended *e);

#endif
