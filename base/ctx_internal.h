/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What the modules of base/ know of a context beyond base/ctx.h. Not installed. */
#ifndef TZ_BASE_CTX_INTERNAL_H
#define TZ_BASE_CTX_INTERNAL_H

#include "base/ctx.h"

/** Books `bytes` against the budget; counts as one allocation for `fail_alloc`.
 * @return TZ_OK; TZ_NOMEM with a message */
tz_status tz_ctx_take_memory(tz_ctx *ctx, size_t bytes);
void tz_ctx_give_memory(tz_ctx *ctx, size_t bytes);

/** Drops the recorded message, for callers that recover from a failure by another way.
 * Call only where no message stood before the attempt. */
void tz_ctx_forget_message(tz_ctx *ctx);

#endif
