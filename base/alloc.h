/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Checked allocation against the context's memory budget. Blocks are aligned to 64 bytes
 * and may be freed without the context that made them having to be the same thread. */
#ifndef TZ_BASE_ALLOC_H
#define TZ_BASE_ALLOC_H

#include "base/ctx.h"

/** n * size bytes, uninitialised; n * size is checked for overflow, 0 gives a valid
 * block.
 * @param[out] out  receives the block; NULL on error
 * @return TZ_OK; TZ_NOMEM with a message naming the size and the budget */
TZ_API tz_status tz_alloc(tz_ctx *ctx, void *out, size_t n, size_t size);
/** The same, zeroed. */
TZ_API tz_status tz_alloc_zero(tz_ctx *ctx, void *out, size_t n, size_t size);
/** Resizes the block at *inout (may be NULL); on error *inout is untouched and valid. */
TZ_API tz_status tz_realloc(tz_ctx *ctx, void *inout, size_t n, size_t size);
/** Frees; takes NULL. `ctx` must be the context that allocated, or NULL if that was NULL.
 */
TZ_API void tz_free(tz_ctx *ctx, void *p);
/** Copy of a string. */
TZ_API tz_status tz_strdup(tz_ctx *ctx, const char *s, char **out);

#endif
