/* SPDX-License-Identifier: Apache-2.0 */
/* Philox4x32-10. Key = seed, 128-bit counter = (block number, stream): streams never
 * overlap, and any block can be computed without those before it. */
#include "base/rng.h"

#include <assert.h>
#include <math.h>

#include "base/geom.h"

static void philox(uint64_t seed, uint64_t stream, uint64_t counter, uint32_t out[4])
{
    uint32_t c0 = (uint32_t)counter, c1 = (uint32_t)(counter >> 32);
    uint32_t c2 = (uint32_t)stream, c3 = (uint32_t)(stream >> 32);
    uint32_t k0 = (uint32_t)seed, k1 = (uint32_t)(seed >> 32);
    for (int round = 0; round < 10; round++) {
        uint64_t p0 = (uint64_t)0xD2511F53u * c0, p1 = (uint64_t)0xCD9E8D57u * c2;
        uint32_t n0 = (uint32_t)(p1 >> 32) ^ c1 ^ k0, n2 = (uint32_t)(p0 >> 32) ^ c3 ^ k1;
        c1 = (uint32_t)p1;
        c3 = (uint32_t)p0;
        c0 = n0;
        c2 = n2;
        k0 += 0x9E3779B9u; /* golden ratio */
        k1 += 0xBB67AE85u; /* sqrt(3) - 1 */
    }
    out[0] = c0;
    out[1] = c1;
    out[2] = c2;
    out[3] = c3;
}

tz_rng tz_rng_make(uint64_t seed, uint64_t stream)
{
    return (tz_rng){.seed = seed, .stream = stream};
}

/* Finaliser of splitmix64: a bijection in which every input bit reaches every output bit.
 */
static uint64_t mix(uint64_t z)
{
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

uint64_t tz_rng_stream(uint64_t a, uint64_t b, uint64_t c)
{
    const uint64_t golden = 0x9E3779B97F4A7C15u;
    return mix(mix(mix(a + golden) + b + golden) + c + golden);
}

uint32_t tz_rng_u32(tz_rng *r)
{
    if (r->left == 0) {
        philox(r->seed, r->stream, r->counter++, r->block);
        r->left = 4;
    }
    return r->block[4 - r->left--];
}

uint64_t tz_rng_u64(tz_rng *r)
{
    uint64_t low = tz_rng_u32(r);
    return low | (uint64_t)tz_rng_u32(r) << 32;
}

double tz_rng_unit(tz_rng *r) { return (double)(tz_rng_u64(r) >> 11) * 0x1p-53; }

double tz_rng_range(tz_rng *r, double lo, double hi)
{
    double x = lo + (hi - lo) * tz_rng_unit(r);
    return x < hi ? x : lo; /* the sum may round up to hi */
}

int32_t tz_rng_below(tz_rng *r, int32_t n)
{
    assert(n >= 1);
    /* Lemire's multiply-shift; the low words under 2^32 mod n would favour some results.
     */
    uint32_t range = (uint32_t)n, reject = (0u - range) % range;
    uint64_t m;
    do
        m = (uint64_t)tz_rng_u32(r) * range;
    while ((uint32_t)m < reject);
    return (int32_t)(m >> 32);
}

double tz_rng_normal(tz_rng *r)
{
    /* Box-Muller; its second number is dropped, as a kept one would be hidden state. */
    double u = 1.0 - tz_rng_unit(r), v = tz_rng_unit(r);
    return sqrt(-2.0 * log(u)) * cos(2.0 * TZ_PI * v);
}
