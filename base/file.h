/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Files: whole-file reading, output that appears under its name only when complete, and
 * SHA-256 of contents for recipes. */
#ifndef TZ_BASE_FILE_H
#define TZ_BASE_FILE_H

#include <stdio.h>

#include "base/alloc.h"

/** Reads a regular file ("-" = standard input) whole; a zero byte follows the last.
 * @return TZ_OK; TZ_IO (missing, directory, ...); TZ_LIMIT (over max); TZ_NOMEM */
TZ_API tz_status tz_file_read(tz_ctx *ctx, const char *path, size_t max, char **out,
                              size_t *size);

/** Output file: temporary name in the target's folder, renamed by commit. "-" = standard
 * output, directly. Temporary files are removed on SIGINT/SIGTERM too if the program
 * calls tz_file_cleanup from its handler. */
typedef struct tz_file_out {
    FILE *f;
    char *path, *temp; /* temp NULL for standard output */
    tz_ctx *ctx;
    int slot;
    char *text; /**< of output in memory, from the C library's heap */
    size_t size;
} tz_file_out;

TZ_API tz_status tz_file_out_open(tz_ctx *ctx, const char *path, tz_file_out *out);
/** Output into memory: `out` must stay where it is until tz_file_out_text.
 * @param name  stands for it in messages */
TZ_API tz_status tz_file_out_open_text(tz_ctx *ctx, const char *name, tz_file_out *out);
/** Ends output into memory. @param[out] text  caller frees with tz_free */
TZ_API tz_status tz_file_out_text(tz_file_out *out, char **text);
/** Flushes, checks every write error, renames. On failure removes the temporary file. */
TZ_API tz_status tz_file_out_commit(tz_file_out *out);
TZ_API void tz_file_out_abort(tz_file_out *out); /**< takes zeroed */
/** Unlinks all temporary files that are open; async-signal-safe. */
TZ_API void tz_file_cleanup(void);

/** SHA-256 as 64 lower-case hex digits and a zero. */
TZ_API void tz_sha256(const void *data, size_t size, char hex[65]);
TZ_API tz_status tz_file_sha256(tz_ctx *ctx, const char *path, char hex[65]);

#endif
