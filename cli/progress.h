/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Progress bar and warnings on standard error. */
#ifndef TZ_CLI_PROGRESS_H
#define TZ_CLI_PROGRESS_H

#include <pthread.h>

#include "base/ctx.h"

typedef struct tz_bar {
    pthread_mutex_t lock;
    bool on;    /**< standard error is a terminal and --quiet is not given */
    bool shown; /**< the line holds a bar that must be erased */
} tz_bar;

void tz_bar_init(tz_bar *b, bool quiet);
/** Call-backs for tz_ctx_options; user is the bar. */
void tz_bar_progress(void *user, const tz_progress *p);
void tz_bar_warning(void *user, const char *message);
/** Erases the bar. */
void tz_bar_clear(tz_bar *b);

#endif
