/* SPDX-License-Identifier: Apache-2.0 */
/* Sample graphs as such, wherever they come from: links from edges, checks, freeing. */
#include "curves/sample_graph.h"

tz_status tz_sample_graph_link(tz_sample_graph *g)
{
    for (int32_t i = 0; i < g->edge.n; i++) {
        const tz_curve_edge *e = &g->edge.v[i];
        if (e->from < 0 || e->to < 0 || e->from >= g->sample.n || e->to >= g->sample.n)
            return tz_fail(g->ctx, TZ_INVALID,
                           "edge %d of the graph joins a sample that does not exist", i);
    }
    const tz_status s = tz_array_reserve(g->ctx, &g->link, 2 * (int64_t)g->edge.n);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < g->sample.n; i++)
        g->sample.v[i].links = 0;
    for (int32_t i = 0; i < g->edge.n; i++) {
        g->sample.v[g->edge.v[i].from].links++;
        g->sample.v[g->edge.v[i].to].links++;
    }
    int32_t at = 0;
    for (int32_t i = 0; i < g->sample.n; i++) {
        g->sample.v[i].link = at;
        at += g->sample.v[i].links;
        g->sample.v[i].links = 0;
    }
    for (int32_t i = 0; i < g->edge.n; i++)
        for (int k = 0; k < 2; k++) {
            const tz_curve_edge *e = &g->edge.v[i];
            tz_curve_sample *p = &g->sample.v[k ? e->to : e->from];
            g->link.v[p->link + p->links++] =
                (tz_curve_link){.to = k ? e->from : e->to, .edge = i};
        }
    g->link.n = at;
    return TZ_OK;
}

tz_status tz_sample_graph_check(tz_ctx *ctx, const tz_sample_graph *g, const char *name)
{
    const char *fault = NULL;
    int32_t at = 0;
    for (int32_t i = 0; i < g->sample.n && !fault; i++) {
        const tz_curve_sample *p = &g->sample.v[i];
        at = i;
        if (!isfinite(p->at.x) || !isfinite(p->at.y))
            fault = "is not finite";
        else if (!(p->existence >= 0 && p->existence <= 1))
            fault = "has an existence outside 0 .. 1";
        else if (p->links < 0 || p->link < 0 || p->link > g->link.n - p->links ||
                 p->turns < 0 || p->turn < 0 || p->turn > g->turn.n - p->turns)
            fault = "has links or turns that do not exist";
        for (int32_t k = 0; !fault && k < p->turns; k++)
            if (!(g->turn.v[p->turn + k] >= 0 && g->turn.v[p->turn + k] < 2 * TZ_PI))
                fault = "has an orientation outside 0 .. 2 pi";
        for (int32_t k = 0; !fault && k < p->links; k++) {
            const tz_curve_link *l = &g->link.v[p->link + k];
            if (l->edge < 0 || l->edge >= g->edge.n || l->to < 0 ||
                l->to >= g->sample.n || l->to == i ||
                g->edge.v[l->edge].from + g->edge.v[l->edge].to != l->to + i)
                fault = "has a link that is none of its edges";
        }
    }
    if (fault)
        return tz_fail(ctx, TZ_INVALID, "%s: sample %d %s", name, at, fault);
    return TZ_OK;
}

void tz_sample_graph_deinit(tz_sample_graph *g)
{
    tz_array_free(g->ctx, &g->sample);
    tz_array_free(g->ctx, &g->edge);
    tz_array_free(g->ctx, &g->link);
    tz_array_free(g->ctx, &g->turn);
    tz_array_free(g->ctx, &g->shape);
    tz_array_free(g->ctx, &g->taper);
}
