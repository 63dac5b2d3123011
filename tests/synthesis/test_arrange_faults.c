/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Arrangement when memory runs out or somebody cancels: nothing leaks, nothing is
 * left. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/arranged.h"

/* The n-th allocation fails; n goes up one by one at first, then faster. */
static void test_every_allocation_may_fail(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    arranged_source s;
    source_init(ctx, &s, PICTURE_STONES, 90, 80, 1);
    tz_arrange_params p = arrange_params(150, 130, 1, false);
    p.effort = 1;
    tz_layout want;
    arrange_one(ctx, &s, NULL, &p, &want);
    const uint64_t hash = layout_hash(&want);
    tz_layout_deinit(&want);
    for (int threads = 1; threads <= 2; threads++) {
        bool done = false;
        for (int64_t n = 1; !done; n += n < 200 ? 1 : n / 16) {
            tz_ctx *poor = NULL;
            if (tz_ctx_new(&(tz_ctx_options){.threads = threads, .fail_alloc = n},
                           &poor) != TZ_OK)
                continue;
            tz_layout l = {0};
            const tz_status st = tz_arrange(poor, &s.exemplar, 1, NULL, &p, &l);
            if (st == TZ_OK) {
                assert_true(layout_hash(&l) == hash);
                done = true;
            } else {
                assert_int_equal(st, TZ_NOMEM);
                assert_true(tz_ctx_message(poor)[0] != 0);
                assert_null(l.place.v); /* untouched */
            }
            tz_layout_deinit(&l);
            assert_int_equal(tz_ctx_memory_used(poor), 0);
            tz_ctx_free(poor);
        }
    }
    source_deinit(&s);
    tz_ctx_free(ctx);
}

/* The same with a layout that holds fixed placements: on failure it is as it was. */
static void test_failure_keeps_the_layout(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    arranged_source s;
    source_init(ctx, &s, PICTURE_STONES, 90, 80, 1);
    tz_arrange_params p = arrange_params(150, 130, 1, true);
    p.effort = 1;
    for (int64_t n = 5; n < 4000; n += n / 3) {
        tz_ctx *poor = NULL;
        assert_int_equal(tz_ctx_new(&(tz_ctx_options){.threads = 1}, &poor), TZ_OK);
        tz_layout l;
        arrange_one(poor, &s, NULL, &p, &l);
        l.place.v[0].fixed = 1;
        const uint64_t before = layout_hash(&l);
        tz_ctx *other = NULL;
        assert_int_equal(
            tz_ctx_new(&(tz_ctx_options){.threads = 1, .fail_alloc = n}, &other), TZ_OK);
        tz_arrange_params q = p;
        q.seed = 99;
        const tz_status st = tz_arrange(other, &s.exemplar, 1, NULL, &q, &l);
        if (st == TZ_OK) {
            assert_true(layout_hash(&l) != before);
        } else {
            assert_int_equal(st, TZ_NOMEM);
            assert_true(layout_hash(&l) == before);
        }
        tz_layout_deinit(&l);
        assert_int_equal(tz_ctx_memory_used(poor), 0);
        assert_int_equal(tz_ctx_memory_used(other), 0);
        tz_ctx_free(other);
        tz_ctx_free(poor);
    }
    source_deinit(&s);
    tz_ctx_free(ctx);
}

static void on_progress(void *user, const tz_progress *p)
{
    tz_ctx **ctx = user;
    if (p->done > 0)
        tz_ctx_cancel(*ctx);
}

static void test_cancel(void **state)
{
    (void)state;
    for (int threads = 1; threads <= 8; threads *= 2)
        for (int before = 0; before < 2; before++) {
            tz_ctx *ctx = NULL;
            assert_int_equal(tz_ctx_new(&(tz_ctx_options){.threads = threads,
                                                          .on_progress = on_progress,
                                                          .user = &ctx},
                                        &ctx),
                             TZ_OK);
            tz_ctx *quiet = new_ctx(1);
            arranged_source s;
            source_init(quiet, &s, PICTURE_STONES, 120, 110, 1);
            tz_arrange_params p = arrange_params(2500, 2500, 1, false);
            tz_layout l = {0};
            if (before)
                tz_ctx_cancel(ctx);
            assert_int_equal(tz_arrange(ctx, &s.exemplar, 1, NULL, &p, &l), TZ_CANCELLED);
            assert_null(l.place.v);
            assert_int_equal(tz_ctx_memory_used(ctx), 0);
            source_deinit(&s);
            tz_ctx_free(quiet);
            tz_ctx_free(ctx);
        }
}

/* A budget too small is an error that says so. */
static void test_budget(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    arranged_source s;
    source_init(ctx, &s, PICTURE_STONES, 120, 110, 1);
    tz_arrange_params p = arrange_params(400, 300, 1, false);
    p.effort = 1;
    int failed = 0;
    for (size_t budget = 1 << 12; budget <= 64 << 20; budget *= 4) {
        tz_ctx *poor = NULL;
        assert_int_equal(
            tz_ctx_new(&(tz_ctx_options){.threads = 2, .memory = budget}, &poor), TZ_OK);
        tz_layout l = {0};
        const tz_status st = tz_arrange(poor, &s.exemplar, 1, NULL, &p, &l);
        assert_true(st == TZ_OK || st == TZ_NOMEM);
        failed += st != TZ_OK;
        assert_true(tz_ctx_memory_peak(poor) <= budget);
        tz_layout_deinit(&l);
        assert_int_equal(tz_ctx_memory_used(poor), 0);
        tz_ctx_free(poor);
    }
    assert_in_range(failed, 1, 6);
    source_deinit(&s);
    tz_ctx_free(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_allocation_may_fail),
        cmocka_unit_test(test_failure_keeps_the_layout),
        cmocka_unit_test(test_cancel),
        cmocka_unit_test(test_budget),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
