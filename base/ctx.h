/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Context of a long operation: threads, memory budget, cancel, progress, warnings and the
 * first error's message. One context serves one operation at a time; cancel may be called
 * from any thread or from a signal handler. */
#ifndef TZ_BASE_CTX_H
#define TZ_BASE_CTX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/export.h"
#include "base/status.h"

typedef struct tz_ctx tz_ctx;

/** State of the running stage, as handed to the progress call-back. */
typedef struct tz_progress {
    const char *stage; /**< what runs, e.g. "render" */
    const char *unit;  /**< what is counted, e.g. "px" */
    int64_t done, total;
    double elapsed; /**< s since the stage began */
    double rate;    /**< units per s, 0 while unknown */
    double left;    /**< estimated s left, < 0 while unknown */
} tz_progress;

typedef struct tz_ctx_options {
    int threads;   /**< worker threads; 0 = all processors */
    size_t memory; /**< budget of tz_alloc in bytes; 0 = no limit */
    int64_t
        fail_alloc; /**< test hook: the n-th allocation (1 = first) fails; 0 = never */
    void (*on_progress)(void *user, const tz_progress *p); /**< NULL = silent; at most
        every 50 ms, never from two threads at once */
    void (*on_warning)(void *user, const char *message);   /**< NULL = dropped */
    void *user;
} tz_ctx_options;

/** @param[in] opt NULL for all defaults  @return TZ_OK, TZ_NOMEM; *out untouched on error
 */
TZ_API tz_status tz_ctx_new(const tz_ctx_options *opt, tz_ctx **out);
TZ_API void tz_ctx_free(tz_ctx *ctx); /**< takes NULL */

/** Number of workers that tz_parallel_for uses, at least 1. */
TZ_API int tz_ctx_threads(const tz_ctx *ctx);
/** Budget in bytes, 0 = none; and bytes in use and the peak of them. */
TZ_API size_t tz_ctx_memory(const tz_ctx *ctx);
TZ_API size_t tz_ctx_memory_used(const tz_ctx *ctx);
TZ_API size_t tz_ctx_memory_peak(const tz_ctx *ctx);

/** Async-signal-safe. Long operations return TZ_CANCELLED soon after. */
TZ_API void tz_ctx_cancel(tz_ctx *ctx);
TZ_API bool tz_ctx_cancelled(const tz_ctx *ctx);

/** A thing that is costly to make and serves every operation of the context (a model):
 * made when first asked for, kept until tz_ctx_free. May be called from any worker.
 * @param name  of the thing, copied; handed to `make`, which fails or sets *out
 * @param drop  frees it  @param[out] out  the thing; untouched on error
 * @return TZ_OK; TZ_NOMEM; what `make` returns (it is tried again next time) */
TZ_API tz_status tz_ctx_keep(tz_ctx *ctx, const char *name,
                             tz_status (*make)(tz_ctx *ctx, const char *name, void **out),
                             void (*drop)(void *thing), void **out);

/** Frees all that tz_ctx_keep holds; nothing may be using it. */
TZ_API void tz_ctx_drop_kept(tz_ctx *ctx);

/** Records the message unless an earlier error already did; returns `s`, so that callers
 * write `return tz_fail(ctx, TZ_INVALID, "%s: ...", path);`. ctx NULL is allowed.
 * Messages name the file, the place and the remedy, in one line without a full stop. */
TZ_API tz_status tz_fail(tz_ctx *ctx, tz_status s, const char *fmt, ...) TZ_PRINTF(3, 4);
/** First error's message, "" if none. Valid until tz_ctx_clear or tz_ctx_free. */
TZ_API const char *tz_ctx_message(const tz_ctx *ctx);
/** Forgets message and cancel flag, so that the context can serve another operation. */
TZ_API void tz_ctx_clear(tz_ctx *ctx);
/** Reports a remark that does not stop the work. ctx NULL is allowed. */
TZ_API void tz_warn(tz_ctx *ctx, const char *fmt, ...) TZ_PRINTF(2, 3);

/** Stage of progress; stages do not nest. `stage` and `unit` must outlive the stage. */
TZ_API void tz_progress_begin(tz_ctx *ctx, const char *stage, const char *unit,
                              int64_t total);
TZ_API void tz_progress_add(tz_ctx *ctx, int64_t units); /**< from any worker */
TZ_API void tz_progress_end(tz_ctx *ctx);

/** Body of a parallel loop.
 * @param i       index of the item, each of 0..n-1 exactly once
 * @param worker  0..tz_ctx_threads-1: index of scratch memory, never a source of results
 */
typedef tz_status (*tz_task)(tz_ctx *ctx, void *arg, int64_t i, int worker);

/** Runs `task` for i = 0..n-1 on the context's thread pool; the caller works too. Items
 * are handed out in rising order. If items fail, the status of the lowest failed index is
 * returned and its message kept, at any thread count; no new items start after a failure
 * or cancel. Nested calls run serially in the calling worker.
 * @return TZ_OK, TZ_CANCELLED, or what a task returned */
TZ_API tz_status tz_parallel_for(tz_ctx *ctx, int64_t n, tz_task task, void *arg);

#endif
