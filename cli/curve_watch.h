/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Watching the optimiser of curves: its energy as a table, its samples as a picture. */
#ifndef TZ_CLI_CURVE_WATCH_H
#define TZ_CLI_CURVE_WATCH_H

#include "base/geom.h"
#include "curves/synthesis.h"

/** An edge between two samples, or, with one point twice, a sample. */
typedef struct tz_watch_mark {
    tz_vec2 from, to;
} tz_watch_mark;

typedef struct tz_curve_watch {
    tz_ctx *ctx;
    tz_status status; /**< TZ_NOMEM where it could not keep what it saw */
    tz_domain domain;
    TZ_ARRAY(tz_curve_energy)
    energy;
    struct {
        TZ_ARRAY(tz_watch_mark)
        mark;
        double spacing;
        int32_t samples;
    } level[TZ_SAMPLE_LEVELS]; /**< as they were after its last iteration */
} tz_curve_watch;

/** As trace of a job, with a tz_curve_watch as user. */
void tz_curve_watch_see(void *watch, const tz_curve_energy *e, const tz_sample_graph *g);
/** A line an iteration: level, iteration, samples, edges, match, domain, mean. */
tz_status tz_curve_watch_table(const tz_curve_watch *w, const char *path);
/** Levels side by side, samples as dots and edges as lines. */
tz_status tz_curve_watch_picture(const tz_curve_watch *w, const char *path);
void tz_curve_watch_deinit(tz_curve_watch *w);

#endif
