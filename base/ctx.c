/* SPDX-License-Identifier: Apache-2.0 */
/* The context: options, memory book-keeping, first error's message, progress, and the
 * thread pool behind tz_parallel_for.
 *
 * Loops hand out items through one atomic counter. A worker looks at the `stop` flag
 * before it takes an item and never after: so when item i fails, all items below i have
 * been taken and will finish, and the lowest failed index does not depend on timing. Each
 * worker keeps its own first failure and message; the lowest wins after the loop. */
#include "base/ctx.h"

#include <assert.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/ctx_internal.h"

enum { MESSAGE_SIZE = 1024, MAX_THREADS = 1024 };
#define PROGRESS_PERIOD 0.05

/* A worker's share of the running loop; worker 0 is the thread that called. */
typedef struct worker {
    tz_ctx *ctx;
    pthread_t thread;
    int index;
    int64_t failed; /* lowest failed item, INT64_MAX = none */
    tz_status status;
    char message[MESSAGE_SIZE]; /* of the item that runs or has failed */
} worker;

/* A thing that tz_ctx_keep made. */
typedef struct kept {
    struct kept *next;
    void *thing;
    void (*drop)(void *thing);
    char name[];
} kept;

struct tz_ctx {
    tz_ctx_options opt;
    int threads;

    atomic_size_t used, peak;
    atomic_int_fast64_t allocations;

    atomic_bool cancel;

    pthread_mutex_t message_lock;
    char message[MESSAGE_SIZE];

    pthread_mutex_t progress_lock; /* serialises the call-backs */
    tz_progress progress;
    double began, reported;
    atomic_int_fast64_t done;

    pthread_mutex_t kept_lock;
    struct kept *kept; /* list, newest first */

    /* pool: started by the first loop */
    pthread_mutex_t pool_lock;
    pthread_cond_t wake, idle;
    worker *workers; /* threads of them */
    int started;     /* pool threads running, apart from the caller */
    int busy;        /* pool threads still in the current loop */
    uint64_t round;  /* loop number, tells sleeping threads that work came */
    bool quit;
    atomic_bool in_loop;

    /* current loop */
    tz_task task;
    void *arg;
    int64_t n;
    atomic_int_fast64_t next;
    atomic_bool stop;
};

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- life ----------------------------------------------------------------------- */

tz_status tz_ctx_new(const tz_ctx_options *opt, tz_ctx **out)
{
    tz_ctx *ctx = calloc(1, sizeof *ctx);
    if (!ctx)
        return TZ_NOMEM;
    if (opt)
        ctx->opt = *opt;
    long cpus = ctx->opt.threads > 0 ? ctx->opt.threads : sysconf(_SC_NPROCESSORS_ONLN);
    ctx->threads = cpus < 1 ? 1 : cpus > MAX_THREADS ? MAX_THREADS : (int)cpus;
    ctx->workers = calloc((size_t)ctx->threads, sizeof *ctx->workers);
    if (!ctx->workers) {
        free(ctx);
        return TZ_NOMEM;
    }
    for (int i = 0; i < ctx->threads; i++)
        ctx->workers[i] = (worker){.ctx = ctx, .index = i};
    pthread_mutex_init(&ctx->message_lock, NULL);
    pthread_mutex_init(&ctx->kept_lock, NULL);
    pthread_mutex_init(&ctx->progress_lock, NULL);
    pthread_mutex_init(&ctx->pool_lock, NULL);
    pthread_cond_init(&ctx->wake, NULL);
    pthread_cond_init(&ctx->idle, NULL);
    *out = ctx;
    return TZ_OK;
}

void tz_ctx_free(tz_ctx *ctx)
{
    if (!ctx)
        return;
    pthread_mutex_lock(&ctx->pool_lock);
    ctx->quit = true;
    pthread_cond_broadcast(&ctx->wake);
    pthread_mutex_unlock(&ctx->pool_lock);
    for (int i = 1; i <= ctx->started; i++)
        pthread_join(ctx->workers[i].thread, NULL);
    tz_ctx_drop_kept(ctx);
    pthread_mutex_destroy(&ctx->kept_lock);
    pthread_cond_destroy(&ctx->idle);
    pthread_cond_destroy(&ctx->wake);
    pthread_mutex_destroy(&ctx->pool_lock);
    pthread_mutex_destroy(&ctx->progress_lock);
    pthread_mutex_destroy(&ctx->message_lock);
    free(ctx->workers);
    free(ctx);
}

tz_status tz_ctx_keep(tz_ctx *ctx, const char *name,
                      tz_status (*make)(tz_ctx *ctx, const char *name, void **out),
                      void (*drop)(void *thing), void **out)
{
    const size_t size = strlen(name) + 1;
    tz_status s = TZ_OK;
    void *thing = NULL;
    pthread_mutex_lock(&ctx->kept_lock);
    kept *k = ctx->kept;
    while (k && strcmp(k->name, name) != 0)
        k = k->next;
    if (!k && (s = make(ctx, name, &thing)) == TZ_OK) {
        k = malloc(sizeof *k + size);
        if (k) {
            *k = (kept){.next = ctx->kept, .thing = thing, .drop = drop};
            memcpy(k->name, name, size);
            ctx->kept = k;
        } else {
            drop(thing);
            s = tz_fail(ctx, TZ_NOMEM, "out of memory");
        }
    }
    if (k)
        *out = k->thing;
    pthread_mutex_unlock(&ctx->kept_lock);
    return s;
}

void tz_ctx_drop_kept(tz_ctx *ctx)
{
    for (kept *k = ctx->kept, *next; k; k = next) {
        next = k->next;
        k->drop(k->thing);
        free(k);
    }
    ctx->kept = NULL;
}

int tz_ctx_threads(const tz_ctx *ctx) { return ctx ? ctx->threads : 1; }

/* ---- memory --------------------------------------------------------------------- */

size_t tz_ctx_memory(const tz_ctx *ctx) { return ctx ? ctx->opt.memory : 0; }
size_t tz_ctx_memory_used(const tz_ctx *ctx) { return ctx ? atomic_load(&ctx->used) : 0; }
size_t tz_ctx_memory_peak(const tz_ctx *ctx) { return ctx ? atomic_load(&ctx->peak) : 0; }

tz_status tz_ctx_take_memory(tz_ctx *ctx, size_t bytes)
{
    if (!ctx)
        return TZ_OK;
    int64_t count = atomic_fetch_add(&ctx->allocations, 1) + 1;
    if (count == ctx->opt.fail_alloc)
        return tz_fail(ctx, TZ_NOMEM, "out of memory: %zu bytes were asked for", bytes);
    size_t used = atomic_fetch_add(&ctx->used, bytes) + bytes;
    if (ctx->opt.memory && used > ctx->opt.memory) {
        atomic_fetch_sub(&ctx->used, bytes);
        return tz_fail(
            ctx, TZ_NOMEM,
            "out of memory: %.1f MiB were asked for with %.1f MiB in use of a "
            "budget of %.1f MiB; allow more memory or ask for a smaller output",
            (double)bytes / 1048576.0, (double)(used - bytes) / 1048576.0,
            (double)ctx->opt.memory / 1048576.0);
    }
    size_t peak = atomic_load(&ctx->peak);
    while (used > peak && !atomic_compare_exchange_weak(&ctx->peak, &peak, used))
        ;
    return TZ_OK;
}

void tz_ctx_give_memory(tz_ctx *ctx, size_t bytes)
{
    if (ctx)
        atomic_fetch_sub(&ctx->used, bytes);
}

/* ---- cancel, messages ----------------------------------------------------------- */

void tz_ctx_cancel(tz_ctx *ctx)
{
    if (ctx)
        atomic_store(&ctx->cancel, true);
}

bool tz_ctx_cancelled(const tz_ctx *ctx) { return ctx && atomic_load(&ctx->cancel); }

/* The worker that the calling thread is, or NULL outside loops. */
static worker *self(tz_ctx *ctx)
{
    if (!atomic_load(&ctx->in_loop))
        return NULL;
    pthread_t me = pthread_self();
    for (int i = 0; i <= ctx->started; i++)
        if (pthread_equal(ctx->workers[i].thread, me))
            return &ctx->workers[i];
    return NULL;
}

tz_status tz_fail(tz_ctx *ctx, tz_status s, const char *fmt, ...)
{
    if (!ctx)
        return s;
    va_list args;
    va_start(args, fmt);
    worker *w = self(ctx);
    if (w) {
        if (!w->message[0])
            vsnprintf(w->message, sizeof w->message, fmt, args);
    } else {
        pthread_mutex_lock(&ctx->message_lock);
        if (!ctx->message[0])
            vsnprintf(ctx->message, sizeof ctx->message, fmt, args);
        pthread_mutex_unlock(&ctx->message_lock);
    }
    va_end(args);
    return s;
}

const char *tz_ctx_message(const tz_ctx *ctx) { return ctx ? ctx->message : ""; }

void tz_ctx_forget_message(tz_ctx *ctx)
{
    if (!ctx)
        return;
    worker *w = self(ctx);
    if (w)
        w->message[0] = 0;
    else
        ctx->message[0] = 0;
}

void tz_ctx_clear(tz_ctx *ctx)
{
    if (!ctx)
        return;
    ctx->message[0] = 0;
    atomic_store(&ctx->cancel, false);
}

void tz_warn(tz_ctx *ctx, const char *fmt, ...)
{
    if (!ctx || !ctx->opt.on_warning)
        return;
    char text[MESSAGE_SIZE];
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    pthread_mutex_lock(&ctx->progress_lock);
    ctx->opt.on_warning(ctx->opt.user, text);
    pthread_mutex_unlock(&ctx->progress_lock);
}

/* ---- progress ------------------------------------------------------------------- */

/* Calls back; the progress lock is held. */
static void report(tz_ctx *ctx, double t)
{
    tz_progress *p = &ctx->progress;
    p->done = atomic_load(&ctx->done);
    p->elapsed = t - ctx->began;
    p->rate = p->elapsed > 0 && p->done > 0 ? (double)p->done / p->elapsed : 0;
    p->left =
        p->rate > 0 && p->total >= p->done ? (double)(p->total - p->done) / p->rate : -1;
    ctx->reported = t;
    ctx->opt.on_progress(ctx->opt.user, p);
}

void tz_progress_begin(tz_ctx *ctx, const char *stage, const char *unit, int64_t total)
{
    if (!ctx)
        return;
    pthread_mutex_lock(&ctx->progress_lock);
    ctx->progress =
        (tz_progress){.stage = stage, .unit = unit, .total = total, .left = -1};
    ctx->began = now();
    atomic_store(&ctx->done, 0);
    if (ctx->opt.on_progress)
        report(ctx, ctx->began);
    pthread_mutex_unlock(&ctx->progress_lock);
}

void tz_progress_add(tz_ctx *ctx, int64_t units)
{
    if (!ctx)
        return;
    atomic_fetch_add(&ctx->done, units);
    if (!ctx->opt.on_progress || pthread_mutex_trylock(&ctx->progress_lock) != 0)
        return; /* another worker is reporting, that will do */
    double t = now();
    if (ctx->progress.stage && t - ctx->reported >= PROGRESS_PERIOD)
        report(ctx, t);
    pthread_mutex_unlock(&ctx->progress_lock);
}

void tz_progress_end(tz_ctx *ctx)
{
    if (!ctx)
        return;
    pthread_mutex_lock(&ctx->progress_lock);
    if (ctx->opt.on_progress && ctx->progress.stage)
        report(ctx, now());
    ctx->progress.stage = NULL;
    pthread_mutex_unlock(&ctx->progress_lock);
}

/* ---- parallel loops ------------------------------------------------------------- */

static void run_items(tz_ctx *ctx, worker *w)
{
    while (!atomic_load(&ctx->stop) && !tz_ctx_cancelled(ctx)) {
        int64_t i = atomic_fetch_add(&ctx->next, 1);
        if (i >= ctx->n)
            break;
        w->message[0] = 0;
        tz_status s = ctx->task(ctx, ctx->arg, i, w->index);
        if (s != TZ_OK) {
            w->failed = i;
            w->status = s;
            atomic_store(&ctx->stop, true);
            break;
        }
    }
}

static void *pool_main(void *arg)
{
    worker *w = arg;
    tz_ctx *ctx = w->ctx;
    uint64_t seen = 0;
    pthread_mutex_lock(&ctx->pool_lock);
    for (;;) {
        while (!ctx->quit && ctx->round == seen)
            pthread_cond_wait(&ctx->wake, &ctx->pool_lock);
        if (ctx->quit)
            break;
        seen = ctx->round;
        pthread_mutex_unlock(&ctx->pool_lock);
        run_items(ctx, w);
        pthread_mutex_lock(&ctx->pool_lock);
        if (--ctx->busy == 0)
            pthread_cond_signal(&ctx->idle);
    }
    pthread_mutex_unlock(&ctx->pool_lock);
    return NULL;
}

/* Starts the pool; where the system refuses a thread, fewer must do. */
static void start_pool(tz_ctx *ctx)
{
    sigset_t all, old;
    sigfillset(&all); /* signals go to the program's own threads */
    pthread_sigmask(SIG_SETMASK, &all, &old);
    for (int i = ctx->started + 1; i < ctx->threads; i++) {
        if (pthread_create(&ctx->workers[i].thread, NULL, pool_main, &ctx->workers[i]) !=
            0)
            break;
        ctx->started = i;
    }
    pthread_sigmask(SIG_SETMASK, &old, NULL);
}

static tz_status run_serial(tz_ctx *ctx, int64_t n, tz_task task, void *arg, int index)
{
    for (int64_t i = 0; i < n; i++) {
        if (tz_ctx_cancelled(ctx))
            return tz_fail(ctx, TZ_CANCELLED, "cancelled");
        tz_status s = task(ctx, arg, i, index);
        if (s != TZ_OK)
            return s;
    }
    return TZ_OK;
}

tz_status tz_parallel_for(tz_ctx *ctx, int64_t n, tz_task task, void *arg)
{
    if (!ctx)
        return run_serial(ctx, n, task, arg, 0);
    if (atomic_load(&ctx->in_loop)) {
        worker *w = self(ctx);
        assert(w && "a context serves one operation at a time");
        return run_serial(ctx, n, task, arg, w ? w->index : 0);
    }
    if (n <= 1 || ctx->threads == 1)
        return run_serial(ctx, n, task, arg, 0);

    pthread_mutex_lock(&ctx->pool_lock);
    if (ctx->started == 0)
        start_pool(ctx);
    ctx->task = task;
    ctx->arg = arg;
    ctx->n = n;
    atomic_store(&ctx->next, 0);
    atomic_store(&ctx->stop, false);
    for (int i = 0; i <= ctx->started; i++) {
        ctx->workers[i].failed = INT64_MAX;
        ctx->workers[i].message[0] = 0;
    }
    ctx->workers[0].thread = pthread_self();
    atomic_store(&ctx->in_loop, true);
    ctx->busy = ctx->started;
    ctx->round++;
    pthread_cond_broadcast(&ctx->wake);
    pthread_mutex_unlock(&ctx->pool_lock);

    run_items(ctx, &ctx->workers[0]);

    pthread_mutex_lock(&ctx->pool_lock);
    while (ctx->busy > 0)
        pthread_cond_wait(&ctx->idle, &ctx->pool_lock);
    atomic_store(&ctx->in_loop, false);
    pthread_mutex_unlock(&ctx->pool_lock);

    const worker *first = &ctx->workers[0];
    for (int i = 1; i <= ctx->started; i++)
        if (ctx->workers[i].failed < first->failed)
            first = &ctx->workers[i];
    if (first->failed != INT64_MAX)
        return first->message[0] ? tz_fail(ctx, first->status, "%s", first->message)
                                 : first->status;
    if (atomic_load(&ctx->next) < n)
        return tz_fail(ctx, TZ_CANCELLED, "cancelled");
    return TZ_OK;
}
