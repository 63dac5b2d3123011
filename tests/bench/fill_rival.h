/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What element fields are measured against: strokes to a full field of directions. */
#ifndef TZ_TESTS_FILL_RIVAL_H
#define TZ_TESTS_FILL_RIVAL_H

#include "elements/field.h"
#include "elements/region.h"
#include "tests/bench/bench.h"

/** Laplacian interpolation inside a region: vectors as strokes say them, exactly, under
 * them; elsewhere each component is harmonic, with no flow over the border; then of
 * length 1.
 * @param region  NULL = all of the domain
 * @param weight  that the field speaks with, everywhere
 * @param[out] full  initialised here, settled; the caller frees it
 * @source [Hsu20] Fig. 2 (d): preprocessing via Laplacian interpolation */
void fill_rival(tz_ctx *ctx, const tz_element_field *strokes, const tz_region *region,
                double weight, tz_element_field *full);

#endif
