/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Growing arrays of any type: TZ_ARRAY(tz_vec2) points = {0}; Items are v[0..n-1]. */
#ifndef TZ_BASE_ARRAY_H
#define TZ_BASE_ARRAY_H

#include "base/alloc.h"

#define TZ_ARRAY(T)     \
    struct {            \
        T *v;           \
        int32_t n, cap; \
    }

/** Makes room for `count` items in all. Expression of type tz_status. */
#define tz_array_reserve(ctx, a, count) \
    tz_array_grow((ctx), (void *)&(a)->v, &(a)->cap, (count), sizeof *(a)->v)
/** Appends one item. Expression of type tz_status; on error the array is unchanged. */
#define tz_array_push(ctx, a, item)                             \
    (tz_array_reserve((ctx), (a), (int64_t)(a)->n + 1) == TZ_OK \
         ? ((a)->v[(a)->n++] = (item), TZ_OK)                   \
         : TZ_NOMEM)
#define tz_array_free(ctx, a) \
    (tz_free((ctx), (a)->v), (a)->v = NULL, (a)->n = (a)->cap = 0)

/** Grows *v (by half at least) to hold `count` items; TZ_LIMIT beyond INT32_MAX. */
TZ_API tz_status tz_array_grow(tz_ctx *ctx, void *v, int32_t *cap, int64_t count,
                               size_t size);

#endif
