/* SPDX-License-Identifier: Apache-2.0 */
/* Philox against the known answers of Random123 (kat_vectors, philox4x32 10), and the
 * distributions. */
#include "tests/base/check.h"

#include <math.h>

#include "base/rng.h"

static void known_answers(void **state)
{
    (void)state;
    static const struct {
        uint64_t counter, stream, seed;
        uint32_t out[4];
    } kat[] = {
        {0, 0, 0, {0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}},
        {UINT64_MAX,
         UINT64_MAX,
         UINT64_MAX,
         {0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}},
        {0x85a308d3243f6a88,
         0x0370734413198a2e,
         0x299f31d0a4093822,
         {0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}},
    };
    for (int k = 0; k < 3; k++) {
        tz_rng r = tz_rng_make(kat[k].seed, kat[k].stream);
        r.counter = kat[k].counter;
        for (int i = 0; i < 4; i++)
            assert_int_equal(tz_rng_u32(&r), kat[k].out[i]);
    }
}

static void streams_differ(void **state)
{
    (void)state;
    tz_rng a = tz_rng_make(1, 2), b = tz_rng_make(1, 2), c = tz_rng_make(1, 3),
           d = tz_rng_make(2, 2);
    int same_c = 0, same_d = 0;
    for (int i = 0; i < 1000; i++) {
        uint32_t x = tz_rng_u32(&a);
        assert_int_equal(x, tz_rng_u32(&b));
        same_c += x == tz_rng_u32(&c);
        same_d += x == tz_rng_u32(&d);
    }
    assert_true(same_c <= 1 && same_d <= 1);
    assert_int_not_equal(tz_rng_stream(1, 2, 3), tz_rng_stream(1, 3, 2));
    assert_int_not_equal(tz_rng_stream(0, 0, 0), tz_rng_stream(0, 0, 1));
    assert_int_equal(tz_rng_stream(4, 5, 6), tz_rng_stream(4, 5, 6));
}

static void distributions(void **state)
{
    (void)state;
    tz_rng r = tz_rng_make(7, 0);
    enum { N = 200000 };
    double sum = 0, square = 0, normal = 0, normal2 = 0;
    int bins[7] = {0};
    for (int i = 0; i < N; i++) {
        double u = tz_rng_unit(&r), v = tz_rng_range(&r, -3, 5), g = tz_rng_normal(&r);
        assert_true(u >= 0 && u < 1 && v >= -3 && v < 5 && isfinite(g));
        sum += u;
        square += u * u;
        normal += g;
        normal2 += g * g;
        int32_t k = tz_rng_below(&r, 7);
        assert_true(k >= 0 && k < 7);
        bins[k]++;
    }
    assert_true(fabs(sum / N - 0.5) < 0.005);
    assert_true(fabs(square / N - 1.0 / 3) < 0.005);
    assert_true(fabs(normal / N) < 0.01);
    assert_true(fabs(normal2 / N - 1) < 0.02);
    for (int k = 0; k < 7; k++)
        assert_true(abs(bins[k] - N / 7) < 800);
    assert_int_equal(tz_rng_below(&r, 1), 0);
    assert_true(tz_rng_below(&r, INT32_MAX) >= 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_answers),
        cmocka_unit_test(streams_differ),
        cmocka_unit_test(distributions),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
