/* SPDX-License-Identifier: Apache-2.0 */
/* Our deflate against zlib's inflate, on all kinds of data, in joined pieces. */
#include "tests/base/check.h"

#include <zlib.h>

#include "base/deflate_internal.h"
#include "base/rng.h"

enum { MOST = 300000 };

static void fill(tz_rng *r, uint8_t *p, size_t n, int kind)
{
    for (size_t i = 0; i < n; i++) {
        switch (kind) {
        case 0: p[i] = 0; break;
        case 1: p[i] = (uint8_t)tz_rng_u32(r); break;
        case 2: p[i] = (uint8_t)(int)(tz_rng_normal(r) * 6); break;
        case 3:
            p[i] = tz_rng_below(r, 50) ? (i ? p[i - 1] : 7) : (uint8_t)tz_rng_u32(r);
            break;
        case 4: p[i] = (uint8_t)(i / 300); break;
        case 5: { /* counts like Fibonacci numbers: the deepest trees */
            uint32_t x = tz_rng_u32(r);
            p[i] = (uint8_t)(x ? __builtin_ctz(x) * 7 : 255);
            break;
        }
        default: p[i] = (uint8_t)(i % 2 ? 0 : tz_rng_below(r, 3));
        }
    }
}

static void inflates_to_the_same(void **state)
{
    (void)state;
    static uint8_t data[MOST], packed[2 * MOST], back[MOST + 1];
    tz_rng r = tz_rng_make(21, 0);
    static const size_t sizes[] = {1,   2,    7,     8,     9,     257,
                                   258, 1000, 65535, 65536, 65537, MOST};
    for (int kind = 0; kind < 7; kind++) {
        for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
            size_t n = sizes[k];
            fill(&r, data, n, kind);
            for (int pieces = 1; pieces <= 3; pieces++) {
                size_t size = 0, at = 0;
                for (int i = 0; i < pieces; i++) {
                    size_t part = i == pieces - 1 ? n - at : n / (size_t)pieces;
                    size_t m =
                        tz_deflate_fast(data + at, part, packed + size, i == pieces - 1);
                    if (part == 0 && i == pieces - 1)
                        fail_msg("a last piece of nothing");
                    assert_true(m <= tz_deflate_bound(part));
                    size += m;
                    at += part;
                }
                z_stream z = {.next_in = packed,
                              .avail_in = (uInt)size,
                              .next_out = back,
                              .avail_out = (uInt)(n + 1)};
                assert_int_equal(inflateInit2(&z, -15), Z_OK);
                assert_int_equal(inflate(&z, Z_FINISH), Z_STREAM_END);
                assert_int_equal(z.total_out, n);
                assert_int_equal(z.avail_in, 0);
                inflateEnd(&z);
                assert_memory_equal(back, data, n);
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(inflates_to_the_same)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
