/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Element exemplars drawn by rule: what tests and timings of growth grow from. */
#ifndef TZ_TESTS_ELEMENTS_H
#define TZ_TESTS_ELEMENTS_H

#include "elements/element.h"

/** Empty set of `kinds` kinds, one symbol. */
tz_status drawn_set(tz_ctx *ctx, double width, double height, bool torus, int32_t kinds,
                    tz_element_set *s);
/** Adds an element of one sample. */
tz_status drawn_add(tz_element_set *s, double x, double y, double radius, int32_t kind,
                    double angle);
/** nx * ny elements, 10 apart, radius 4.5, moved at random by `jitter` (deviation). */
tz_status drawn_hexagons(tz_ctx *ctx, int32_t nx, int32_t ny, double jitter, bool torus,
                         tz_element_set *s);
/** n * n elements, 10 apart; kinds alternate if there are two. */
tz_status drawn_squares(tz_ctx *ctx, int32_t n, int32_t kinds, bool torus,
                        tz_element_set *s);
/** Darts: as many as fit `apart`, at most n; kinds by lot. */
tz_status drawn_darts(tz_ctx *ctx, double side, double apart, int32_t n, int32_t kinds,
                      bool torus, tz_element_set *s);
/** Large discs (kind 1) with small ones (kind 0) between. */
tz_status drawn_mixed(tz_ctx *ctx, double side, bool torus, tz_element_set *s);
/** About n tiles in arcs about two centres, 4 kinds in bands. */
tz_status drawn_mosaic(tz_ctx *ctx, int32_t n, tz_element_set *s);

#endif
