/* SPDX-License-Identifier: Apache-2.0 */
/* Context: messages, cancel, progress, parallel loops. */
#include "tests/base/check.h"

#include <signal.h>
#include <stdatomic.h>

#include "base/alloc.h"
#include "base/module.h"

static void first_message_stays(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    assert_string_equal(tz_ctx_message(ctx), "");
    assert_int_equal(tz_fail(ctx, TZ_INVALID, "first %d", 1), TZ_INVALID);
    assert_int_equal(tz_fail(ctx, TZ_IO, "second"), TZ_IO);
    assert_string_equal(tz_ctx_message(ctx), "first 1");
    tz_ctx_clear(ctx);
    assert_string_equal(tz_ctx_message(ctx), "");
    assert_int_equal(tz_fail(NULL, TZ_IO, "nobody hears"), TZ_IO);
    tz_warn(NULL, "nor this");
    end_ctx(ctx);
}

static void every_status_has_a_word(void **state)
{
    (void)state;
    for (int s = 0; s < TZ_STATUS_COUNT; s++)
        assert_true(strlen(tz_status_text((tz_status)s)) > 1);
    assert_string_equal(tz_status_text((tz_status)999), "unknown");
}

typedef struct counts {
    atomic_int seen[5000];
    atomic_int workers;
    int threads;
} counts;

static tz_status count(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    counts *c = arg;
    assert_true(worker >= 0 && worker < tz_ctx_threads(ctx));
    atomic_fetch_add(&c->seen[i], 1);
    return TZ_OK;
}

static void each_item_once(void **state)
{
    (void)state;
    for (int threads = 1; threads <= 8; threads++) {
        tz_ctx *ctx = new_ctx(threads);
        assert_int_equal(tz_ctx_threads(ctx), threads);
        for (int n = 0; n <= 5000; n = n * 7 + 1) {
            static counts c;
            memset(&c, 0, sizeof c);
            ok(ctx, tz_parallel_for(ctx, n, count, &c));
            for (int i = 0; i < 5000; i++)
                assert_int_equal(atomic_load(&c.seen[i]), i < n);
        }
        end_ctx(ctx);
    }
}

/* Fails at 700, 300 and 500; a spin in 300 makes it the last to finish. */
static tz_status fail_some(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    (void)arg;
    (void)worker;
    if (i == 300) {
        for (volatile int k = 0; k < 100000; k++)
            ;
        return tz_fail(ctx, TZ_FORMAT, "item %d", (int)i);
    }
    if (i == 500 || i == 301)
        return tz_fail(ctx, TZ_LIMIT, "item %d", (int)i);
    return TZ_OK;
}

static void lowest_failure_wins(void **state)
{
    (void)state;
    for (int threads = 1; threads <= 8; threads *= 2) {
        tz_ctx *ctx = new_ctx(threads);
        for (int round = 0; round < 50; round++) {
            assert_int_equal(tz_parallel_for(ctx, 1000, fail_some, NULL), TZ_FORMAT);
            assert_string_equal(tz_ctx_message(ctx), "item 300");
            tz_ctx_clear(ctx);
        }
        end_ctx(ctx);
    }
}

static tz_status inner(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    (void)ctx;
    (void)worker;
    atomic_fetch_add((atomic_int *)arg, (int)i);
    return TZ_OK;
}

static tz_status outer(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    (void)i;
    (void)worker;
    return tz_parallel_for(ctx, 10, inner, arg);
}

static void nested_loops_are_serial(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(4);
    atomic_int sum = 0;
    ok(ctx, tz_parallel_for(ctx, 100, outer, &sum));
    assert_int_equal(atomic_load(&sum), 4500);
    ok(NULL, tz_parallel_for(NULL, 10, inner, &sum));
    assert_int_equal(atomic_load(&sum), 4545);
    end_ctx(ctx);
}

static tz_status cancel_at(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    (void)worker;
    atomic_fetch_add((atomic_int *)arg, 1);
    if (i == 10)
        tz_ctx_cancel(ctx);
    return TZ_OK;
}

static void cancel_stops_loops(void **state)
{
    (void)state;
    for (int threads = 1; threads <= 4; threads *= 2) {
        tz_ctx *ctx = new_ctx(threads);
        atomic_int ran = 0;
        assert_int_equal(tz_parallel_for(ctx, 1000000, cancel_at, &ran), TZ_CANCELLED);
        assert_true(atomic_load(&ran) < 1000);
        assert_true(tz_ctx_cancelled(ctx));
        assert_true(tz_ctx_message(ctx)[0] != 0);
        tz_ctx_clear(ctx);
        assert_false(tz_ctx_cancelled(ctx));
        end_ctx(ctx);
    }
}

typedef struct heard {
    int calls, inside;
    int64_t last;
    char warning[100];
} heard;

static void on_progress(void *user, const tz_progress *p)
{
    heard *h = user;
    assert_int_equal(h->inside++, 0); /* never twice at once */
    assert_true(p->done >= h->last && p->done <= p->total);
    assert_string_equal(p->stage, "work");
    h->last = p->done;
    h->calls++;
    h->inside--;
}

static void on_warning(void *user, const char *text)
{
    snprintf(((heard *)user)->warning, 100, "%s", text);
}

static tz_status step(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    (void)arg;
    (void)i;
    (void)worker;
    usleep(100);
    tz_progress_add(ctx, 2);
    return TZ_OK;
}

static void progress_is_told(void **state)
{
    (void)state;
    heard h = {0};
    tz_ctx *ctx;
    tz_ctx_options opt = {
        .threads = 4, .on_progress = on_progress, .on_warning = on_warning, .user = &h};
    assert_int_equal(tz_ctx_new(&opt, &ctx), TZ_OK);
    tz_progress_begin(ctx, "work", "px", 2000);
    ok(ctx, tz_parallel_for(ctx, 1000, step, NULL));
    tz_progress_end(ctx);
    assert_true(h.calls >= 2 && h.calls < 200);
    assert_int_equal(h.last, 2000);
    tz_warn(ctx, "mind the %s", "gap");
    assert_string_equal(h.warning, "mind the gap");
    tz_progress_add(NULL, 1);
    end_ctx(ctx);
}

static void budget_holds(void **state)
{
    (void)state;
    tz_ctx *ctx;
    tz_ctx_options opt = {.threads = 1, .memory = 1 << 20};
    assert_int_equal(tz_ctx_new(&opt, &ctx), TZ_OK);
    void *p = NULL, *q = NULL;
    ok(ctx, tz_alloc(ctx, &p, 700, 1024));
    fails(ctx, tz_alloc(ctx, &q, 700, 1024), TZ_NOMEM, "budget");
    assert_null(q);
    assert_int_equal(tz_ctx_memory(ctx), 1 << 20);
    assert_true(tz_ctx_memory_used(ctx) >= 700 * 1024);
    tz_free(ctx, p);
    assert_int_equal(tz_ctx_memory_used(ctx), 0);
    assert_true(tz_ctx_memory_peak(ctx) >= 700 * 1024);
    ok(ctx, tz_alloc(ctx, &q, 700, 1024));
    tz_free(ctx, q);
    end_ctx(ctx);
}

static int made, dropped;

static tz_status make_number(tz_ctx *ctx, const char *name, void **out)
{
    made++;
    if (strcmp(name, "bad") == 0)
        return tz_fail(ctx, TZ_INVALID, "bad: no such thing");
    return tz_alloc_zero(ctx, out, 1, sizeof(tz_ctx *));
}

static void drop_number(void *thing)
{
    dropped++;
    tz_free(*(tz_ctx **)thing, thing);
}

static tz_status keep_one(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    void **seen = arg, *thing = NULL;
    (void)worker;
    const tz_status s = tz_ctx_keep(ctx, "good", make_number, drop_number, &thing);
    if (s == TZ_OK) {
        *(tz_ctx **)thing = ctx;
        seen[i] = thing;
    }
    return s;
}

/* Made once whoever asks, tried again after a failure, dropped with the context. */
static void things_are_kept(void **state)
{
    (void)state;
    void *seen[64] = {0}, *other = NULL;
    tz_ctx *ctx = new_ctx(8);
    made = dropped = 0;
    ok(ctx, tz_parallel_for(ctx, 64, keep_one, seen));
    for (int i = 0; i < 64; i++)
        assert_ptr_equal(seen[i], seen[0]);
    assert_int_equal(made, 1);
    for (int i = 0; i < 2; i++) {
        fails(ctx, tz_ctx_keep(ctx, "bad", make_number, drop_number, &other), TZ_INVALID,
              "bad");
        assert_null(other);
    }
    assert_int_equal(made, 3);
    tz_ctx_drop_kept(ctx);
    assert_int_equal(dropped, 1);
    ok(ctx, keep_one(ctx, seen, 0, 0));
    assert_int_equal(made, 4);
    end_ctx(ctx);
    assert_int_equal(dropped, 2);
}

static void shipped_files_are_found(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    char *path = NULL;
    ok(ctx, tz_module_data(ctx, "edge-forest.yml.gz", &path));
    assert_int_equal(access(path, R_OK), 0);
    tz_free(ctx, path);
    fails(ctx, tz_module_data(ctx, "nothing.xyz", &path), TZ_IO, "nothing.xyz");
    end_ctx(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(first_message_stays),
        cmocka_unit_test(every_status_has_a_word),
        cmocka_unit_test(each_item_once),
        cmocka_unit_test(lowest_failure_wins),
        cmocka_unit_test(nested_loops_are_serial),
        cmocka_unit_test(cancel_stops_loops),
        cmocka_unit_test(progress_is_told),
        cmocka_unit_test(budget_holds),
        cmocka_unit_test(things_are_kept),
        cmocka_unit_test(shipped_files_are_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
