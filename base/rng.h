/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Counter-based random numbers: Philox4x32-10 keyed by (seed, stream). The stream is
 * named by the thing drawn for (group, tile, element id), never by thread or order of
 * arrival.
 * @source Salmon, Moraes, Dror, Shaw: Parallel random numbers: as easy as 1, 2, 3, SC
 * 2011 */
#ifndef TZ_BASE_RNG_H
#define TZ_BASE_RNG_H

#include <stdint.h>

#include "base/export.h"

typedef struct tz_rng {
    uint64_t seed, stream, counter;
    uint32_t block[4];
    int left; /* unused words in block */
} tz_rng;

TZ_API tz_rng tz_rng_make(uint64_t seed, uint64_t stream);
/** Stream number out of up to three names, e.g. kind, id, attempt (a 64-bit mix). */
TZ_API uint64_t tz_rng_stream(uint64_t a, uint64_t b, uint64_t c);
TZ_API uint32_t tz_rng_u32(tz_rng *r);
TZ_API uint64_t tz_rng_u64(tz_rng *r);
TZ_API double tz_rng_unit(tz_rng *r);                        /**< [0, 1), 53 bits */
TZ_API double tz_rng_range(tz_rng *r, double lo, double hi); /**< [lo, hi) */
TZ_API int32_t tz_rng_below(tz_rng *r, int32_t n); /**< 0..n-1 unbiased, n >= 1 */
TZ_API double tz_rng_normal(tz_rng *r);            /**< mean 0, variance 1 */

#endif
