/* SPDX-License-Identifier: Apache-2.0 */
/* Allocation and growing arrays. */
#include "tests/base/check.h"

#include "base/array.h"

static void blocks_are_aligned_and_zeroed(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    for (size_t n = 0; n < 5000; n = n * 2 + 1) {
        unsigned char *p;
        ok(ctx, tz_alloc_zero(ctx, &p, n, 3));
        assert_int_equal((uintptr_t)p % 64, 0);
        for (size_t i = 0; i < 3 * n; i++)
            assert_int_equal(p[i], 0);
        memset(p, 0xab, 3 * n);
        tz_free(ctx, p);
    }
    tz_free(ctx, NULL);
    end_ctx(ctx);
}

static void overflow_is_refused(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    void *p = &p;
    fails(ctx, tz_alloc(ctx, &p, SIZE_MAX / 2, 3), TZ_NOMEM, "out of memory");
    assert_null(p);
    fails(ctx, tz_alloc(ctx, &p, SIZE_MAX, 1), TZ_NOMEM, "out of memory");
    fails(ctx, tz_alloc_zero(ctx, &p, (size_t)1 << 62, 1), TZ_NOMEM, "out of memory");
    ok(ctx, tz_alloc(ctx, &p, 10, 1));
    void *before = p;
    fails(ctx, tz_realloc(ctx, &p, (size_t)1 << 62, 1), TZ_NOMEM, "out of memory");
    assert_ptr_equal(p, before);
    tz_free(ctx, p);
    end_ctx(ctx);
}

static void realloc_keeps_contents(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    unsigned char *p = NULL;
    size_t size = 0, sizes[] = {1, 100, 1000, 10, 200000, 3000000, 40000, 5};
    for (int k = 0; k < 8; k++) {
        ok(ctx, tz_realloc(ctx, &p, sizes[k], 1));
        assert_int_equal((uintptr_t)p % 64, 0);
        for (size_t i = 0; i < size && i < sizes[k]; i++)
            assert_int_equal(p[i], (i * 7) & 255);
        size = sizes[k];
        for (size_t i = 0; i < size; i++)
            p[i] = (i * 7) & 255;
    }
    tz_free(ctx, p);
    end_ctx(ctx);
}

static void arrays_grow(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    TZ_ARRAY(int)
    a = {0};
    for (int i = 0; i < 100000; i++)
        ok(ctx, tz_array_push(ctx, &a, i));
    assert_int_equal(a.n, 100000);
    for (int i = 0; i < a.n; i++)
        assert_int_equal(a.v[i], i);
    fails(ctx, tz_array_reserve(ctx, &a, (int64_t)INT32_MAX + 1), TZ_LIMIT, "limit");
    assert_int_equal(a.n, 100000);
    tz_array_free(ctx, &a);
    assert_null(a.v);
    end_ctx(ctx);
}

static tz_status grow_one(tz_ctx *ctx)
{
    TZ_ARRAY(double)
    a = {0};
    char *copy = NULL;
    tz_status s = TZ_OK;
    for (int i = 0; i < 50 && s == TZ_OK; i++)
        s = tz_array_push(ctx, &a, i);
    if (s == TZ_OK)
        s = tz_strdup(ctx, "copy", &copy);
    if (s == TZ_OK)
        assert_string_equal(copy, "copy");
    tz_free(ctx, copy);
    tz_array_free(ctx, &a);
    return s;
}

static void failures_leave_nothing(void **state)
{
    (void)state;
    survive(grow_one, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blocks_are_aligned_and_zeroed),
        cmocka_unit_test(overflow_is_refused),
        cmocka_unit_test(realloc_keeps_contents),
        cmocka_unit_test(arrays_grow),
        cmocka_unit_test(failures_leave_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
