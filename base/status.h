/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Status codes: what every function that can fail returns. */
#ifndef TZ_BASE_STATUS_H
#define TZ_BASE_STATUS_H

#include "base/export.h"

/* name, one-word text for logs */
#define TZ_STATUS_LIST(X)                                                              \
    X(TZ_OK, "ok")                                                                     \
    X(TZ_INVALID, "invalid")         /* an argument or an input is out of its range */ \
    X(TZ_NOMEM, "out-of-memory")     /* allocation failed or memory budget spent */    \
    X(TZ_IO, "io-error")             /* the operating system refused */                \
    X(TZ_FORMAT, "bad-format")       /* a file is not what it claims to be */          \
    X(TZ_LIMIT, "limit-exceeded")    /* a file or request is larger than we accept */  \
    X(TZ_UNSUPPORTED, "unsupported") /* understood, but not built or not possible */   \
    X(TZ_CANCELLED, "cancelled")     /* tz_ctx_cancel was called */

typedef enum tz_status {
#define TZ_STATUS_ENUM(name, text) name,
    TZ_STATUS_LIST(TZ_STATUS_ENUM)
#undef TZ_STATUS_ENUM
        TZ_STATUS_COUNT
} tz_status;

/** Short lower-case word for a status, never NULL. */
TZ_API const char *tz_status_text(tz_status s);

#endif
