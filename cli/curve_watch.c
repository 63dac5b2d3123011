/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/curve_watch.h"

#include <inttypes.h>
#include <stdio.h>

#include "base/svg.h"

void tz_curve_watch_see(void *watch, const tz_curve_energy *e, const tz_sample_graph *g)
{
    tz_curve_watch *w = watch;
    tz_status s = tz_array_push(w->ctx, &w->energy, *e);
    w->domain = g->domain;
    if (s == TZ_OK && e->level >= 0 && e->level < TZ_SAMPLE_LEVELS) {
        w->level[e->level].mark.n = 0;
        w->level[e->level].spacing = g->spacing;
        w->level[e->level].samples = g->sample.n;
        for (int32_t i = 0; i < g->edge.n && s == TZ_OK; i++) {
            const tz_vec2 p = g->sample.v[g->edge.v[i].from].at;
            const tz_watch_mark m = {
                p, tz_curve_copy(&g->domain, g->sample.v[g->edge.v[i].to].at, p)};
            s = tz_array_push(w->ctx, &w->level[e->level].mark, m);
        }
        for (int32_t i = 0; i < g->sample.n && s == TZ_OK; i++) {
            const tz_watch_mark m = {g->sample.v[i].at, g->sample.v[i].at};
            s = tz_array_push(w->ctx, &w->level[e->level].mark, m);
        }
    }
    w->status = w->status == TZ_OK ? s : w->status;
}

tz_status tz_curve_watch_table(const tz_curve_watch *w, const char *path)
{
    tz_file_out out = {0};
    if (w->status != TZ_OK)
        return w->status;
    const tz_status s = tz_file_out_open(w->ctx, path, &out);
    if (s != TZ_OK)
        return s;
    fprintf(out.f, "level,iteration,samples,edges,match,domain,mean\n");
    for (int32_t i = 0; i < w->energy.n; i++) {
        const tz_curve_energy *e = &w->energy.v[i];
        const double v[3] = {e->match, e->domain, e->mean};
        fprintf(out.f, "%" PRId32 ",%" PRId32 ",%" PRId32 ",%" PRId32, e->level,
                e->iteration, e->samples, e->edges);
        for (int k = 0; k < 3; k++) {
            char number[32];
            tz_number_format(v[k], number);
            fprintf(out.f, ",%s", number);
        }
        fputc('\n', out.f);
    }
    return tz_file_out_commit(&out);
}

tz_status tz_curve_watch_picture(const tz_curve_watch *w, const char *path)
{
    const double width = w->domain.size.x, height = w->domain.size.y, gap = 0.05 * width;
    int32_t levels = 0;
    tz_svg_writer o;
    if (w->status != TZ_OK)
        return w->status;
    for (int i = 0; i < TZ_SAMPLE_LEVELS; i++)
        levels += w->level[i].samples > 0;
    tz_status s = tz_svg_writer_open(
        w->ctx, path, levels ? levels * (width + gap) - gap : 1, levels ? height : 1, &o);
    if (s != TZ_OK)
        return s;
    for (int i = 0, k = 0; i < TZ_SAMPLE_LEVELS; i++) {
        const double d = w->level[i].spacing;
        if (w->level[i].samples == 0)
            continue;
        tz_svg_begin(&o, "g");
        tz_svg_setf(&o, "transform", "translate(%g 0)", k++ * (width + gap));
        tz_svg_set(&o, "stroke", "#8899aa");
        tz_svg_set_number(&o, "stroke-width", d / 16);
        tz_svg_set(&o, "fill", "#c03020");
        for (int32_t j = 0; j < w->level[i].mark.n; j++) {
            const tz_watch_mark *m = &w->level[i].mark.v[j];
            const bool dot = m->from.x == m->to.x && m->from.y == m->to.y;
            tz_svg_begin(&o, dot ? "circle" : "line");
            tz_svg_set_number(&o, dot ? "cx" : "x1", m->from.x);
            tz_svg_set_number(&o, dot ? "cy" : "y1", m->from.y);
            if (dot) {
                tz_svg_set_number(&o, "r", d / 8);
                tz_svg_set(&o, "stroke", "none");
            } else {
                tz_svg_set_number(&o, "x2", m->to.x);
                tz_svg_set_number(&o, "y2", m->to.y);
            }
            tz_svg_end(&o);
        }
        tz_svg_end(&o);
    }
    return tz_svg_writer_close(&o);
}

void tz_curve_watch_deinit(tz_curve_watch *w)
{
    tz_array_free(w->ctx, &w->energy);
    for (int i = 0; i < TZ_SAMPLE_LEVELS; i++)
        tz_array_free(w->ctx, &w->level[i].mark);
}
