/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What the tests of base/ share. Include first. */
#ifndef TZ_TESTS_BASE_CHECK_H
#define TZ_TESTS_BASE_CHECK_H

#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/ctx.h"

static inline tz_ctx *new_ctx(int threads)
{
    tz_ctx *ctx = NULL;
    tz_ctx_options opt = {.threads = threads};
    assert_int_equal(tz_ctx_new(&opt, &ctx), TZ_OK);
    return ctx;
}

/* Nothing may stay allocated. */
static inline void end_ctx(tz_ctx *ctx)
{
    tz_ctx_drop_kept(ctx);
    assert_int_equal(tz_ctx_memory_used(ctx), 0);
    tz_ctx_free(ctx);
}

/* TZ_OK, or the message shown and the test failed. */
static inline void ok(tz_ctx *ctx, tz_status s)
{
    if (s != TZ_OK)
        fail_msg("%s: %s", tz_status_text(s), tz_ctx_message(ctx));
}

/* The status, with a message of one line that holds `part`; clears the context. */
static inline void fails(tz_ctx *ctx, tz_status s, tz_status expected, const char *part)
{
    if (s != expected)
        fail_msg("%s in place of %s: %s", tz_status_text(s), tz_status_text(expected),
                 tz_ctx_message(ctx));
    if (!strstr(tz_ctx_message(ctx), part))
        fail_msg("'%s' is not in '%s'", part, tz_ctx_message(ctx));
    assert_null(strchr(tz_ctx_message(ctx), '\n'));
    tz_ctx_clear(ctx);
}

/* Runs `body` with the 1st, 2nd, ... allocation failing until it succeeds: each failure
 * must be TZ_NOMEM and leave nothing behind. */
static inline void survive(tz_status (*body)(tz_ctx *ctx), int threads)
{
    for (int64_t n = 1;; n++) {
        tz_ctx *ctx = NULL;
        tz_ctx_options opt = {.threads = threads, .fail_alloc = n};
        assert_int_equal(tz_ctx_new(&opt, &ctx), TZ_OK);
        tz_status s = body(ctx);
        if (s != TZ_OK) {
            assert_int_equal(s, TZ_NOMEM);
            assert_true(tz_ctx_message(ctx)[0] != 0);
        }
        end_ctx(ctx);
        if (s == TZ_OK) {
            assert_true(n > 1);
            return;
        }
        assert_true(n < 100000);
    }
}

/* Folder for files, removed by end_dir. */
static inline void begin_dir(char dir[64])
{
    strcpy(dir, "/tmp/terrazzo-test-XXXXXX");
    assert_non_null(mkdtemp(dir));
}

static inline int dir_count(const char *dir)
{
    int n = 0;
    DIR *d = opendir(dir);
    for (struct dirent *e; d && (e = readdir(d)) != NULL;)
        n += strcmp(e->d_name, ".") != 0 && strcmp(e->d_name, "..") != 0;
    closedir(d);
    return n;
}

static inline void end_dir(const char *dir)
{
    char path[512];
    DIR *d = opendir(dir);
    for (struct dirent *e; d && (e = readdir(d)) != NULL;) {
        snprintf(path, sizeof path, "%s/%s", dir, e->d_name);
        if (e->d_name[0] != '.' || strlen(e->d_name) > 2)
            remove(path);
    }
    closedir(d);
    rmdir(dir);
}

#endif
