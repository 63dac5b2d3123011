/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Ten cases of element fields, each filled in several ways and measured. Strokes: sparse,
 * dense, crossing, circular, singular. Domains: a rectangle, a ring, a letter, a
 * four-footed animal, all read from drawings. Things: round, long and rigid, long and
 * soft, sizes 1 : 8.
 *
 *   ours           as tz_fill_run does it
 *   published      [Hsu20]: all at random places, no repair
 *   two-step       the alternative of [Hsu20] Fig. 2: a full field first (fill_rival.h),
 *                  which things are forced to follow; else as published
 *   two-step-ours  the same field, with our start and repair */
#ifndef TZ_TESTS_FILL_CASES_H
#define TZ_TESTS_FILL_CASES_H

#include "fields/fill.h"
#include "tests/bench/bench.h"

enum { FILL_SEEDS = 3 };

/** Shapes that point along +x, as SVG markup about the origin. */
extern const char fill_leaf[], fill_round[], fill_bar[], fill_drop[];
/** A palette of n shapes of theirs. */
void fill_palette(tz_ctx *ctx, const char *const *shape, int n, tz_element_set *s);
tz_fill_params fill_defaults(void);

/** Fills the cases whose names hold `only` and prints a line for each way, means of the
 * seeds 7, 8, ... (published and two-step-ours: of 7 alone), then for each measure in how
 * many cases ours is better, equal (within what the rasters resolve) and worse.
 * Angles are in degrees; bend is degrees a unit of distance between neighbours, so that
 * fewer things do not count as rougher; hole is the radius of the largest empty disc over
 * the side; first is what is covered at initialisation.
 * @param out  folder that drawings go to: NAME-strokes.svg, and of the first seed
 *             NAME-WAY.svg and NAME-first.svg (our initialisation),
 *             NAME-random.svg (the published one) */
void fill_cases(tz_ctx *ctx, const char *out, const char *only, int seeds);
/** The two-step alternative by how much its things may differ from its field: alpha
 * against a field of weight 1. Prints lines as above. */
void fill_weights(tz_ctx *ctx, const char *out, const char *only, int seeds);

#endif
