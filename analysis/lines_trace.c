/* SPDX-License-Identifier: Apache-2.0 */
/* From thinned pixels to chains. Diagonal neighbours are linked only where there is no
 * way around the corner, so that a staircase is no junction. */
#include "analysis/lines_graph.h"

#include <math.h>

/* ---- chains -------------------------------------------------------------------------- */

typedef struct tracer {
    const tz_line_field *f;
    tz_line_graph *g;
    int32_t w, h;
    int32_t *node; /* of a pixel; -1 = none, -2 = seen */
} tracer;

static const int8_t step_x[8] = {0, 1, 1, 1, 0, -1, -1, -1};
static const int8_t step_y[8] = {-1, -1, 0, 1, 1, 1, 0, -1};

static bool is_on(const tracer *t, int32_t x, int32_t y)
{
    return x >= 0 && y >= 0 && x < t->w && y < t->h &&
           t->f->map.on[(ptrdiff_t)y * t->w + x];
}

static int links(const tracer *t, int32_t p, int32_t out[8])
{
    const int32_t x = p % t->w, y = p / t->w;
    bool on[8];
    int n = 0;
    for (int k = 0; k < 8; k++)
        on[k] = is_on(t, x + step_x[k], y + step_y[k]);
    for (int k = 0; k < 8; k++)
        if (on[k] && !((k & 1) && (on[k - 1] || on[(k + 1) & 7])))
            out[n++] = p + step_x[k] + step_y[k] * t->w;
    return n;
}

/* Where the line runs at a pixel. */
static tz_line_point point_at(const tracer *t, int32_t p)
{
    const tz_edge_map *m = &t->f->map;
    const ptrdiff_t all = (ptrdiff_t)t->w * t->h;
    const double angle = 0.5 * atan2((double)m->normal[p + all], (double)m->normal[p]);
    const double off = t->f->offset[p];
    return (tz_line_point){
        {p % t->w + 0.5 + off * cos(angle), p / t->w + 0.5 + off * sin(angle)},
        m->response[p],
        t->f->wide[p]};
}

void tz_line_chain_measure(const tz_line_graph *g, tz_line_chain *c)
{
    const tz_line_point *p = g->point.v + c->first;
    double strength = 0, width = 0, length = 0;
    for (int32_t i = 0; i < c->n; i++) {
        strength += p[i].strength;
        width += p[i].width;
        if (i > 0)
            length += tz_vec2_length(tz_vec2_sub(p[i].at, p[i - 1].at));
    }
    c->length = length;
    c->strength = strength / c->n;
    c->width = width / c->n;
}

static tz_status add_point(tracer *t, int32_t p, tz_line_chain *c)
{
    const tz_status s = tz_array_push(t->g->ctx, &t->g->point, point_at(t, p));
    c->n += s == TZ_OK;
    return s;
}

/* From a pixel through `next` until a node, or back to where it began. */
static tz_status follow(tracer *t, int32_t start, int32_t next)
{
    tz_line_chain c = {.node = {t->node[start], -1},
                       .first = t->g->point.n,
                       .light = t->f->light,
                       .edge = t->f->edge};
    int32_t before = start, at = next, to[8];
    tz_status s = add_point(t, start, &c);
    while (s == TZ_OK) {
        s = add_point(t, at, &c);
        if (t->node[at] >= 0 || at == start)
            break;
        t->node[at] = -2;
        const int n = links(t, at, to);
        int32_t on = -1;
        for (int k = 0; k < n && on < 0; k++)
            if (to[k] != before && (t->node[to[k]] != -2 || to[k] == start))
                on = to[k];
        if (on < 0)
            break;
        before = at;
        at = on;
    }
    if (s != TZ_OK)
        return s;
    if (t->node[at] >= 0)
        c.node[1] = t->node[at];
    else
        c.node[0] = -1;
    for (int k = 0; k < 2 && c.node[0] >= 0; k++)
        tz_line_chain_point(t->g, &c, k, 0)->at = t->g->node.v[c.node[k]];
    tz_line_chain_measure(t->g, &c);
    return tz_array_push(t->g->ctx, &t->g->chain, c);
}

tz_status tz_line_graph_trace(const tz_line_field *f, tz_line_graph *g)
{
    tracer t = {.f = f, .g = g, .w = f->map.width, .h = f->map.height};
    const int32_t n = t.w * t.h, first_chain = g->chain.n;
    int32_t to[8];
    g->width = t.w;
    g->height = t.h;
    tz_status s = tz_alloc(g->ctx, &t.node, (size_t)n, sizeof *t.node);
    for (int32_t p = 0; p < n && s == TZ_OK; p++) {
        t.node[p] = -1;
        if (!f->map.on[p] || links(&t, p, to) == 2)
            continue;
        t.node[p] = g->node.n;
        s = tz_array_push(g->ctx, &g->node, point_at(&t, p).at);
    }
    for (int32_t p = 0; p < n && s == TZ_OK; p++) {
        if (!f->map.on[p] || t.node[p] < 0)
            continue;
        const int k = links(&t, p, to);
        for (int i = 0; i < k && s == TZ_OK; i++)
            if (t.node[to[i]] == -1 || (t.node[to[i]] >= 0 && to[i] > p))
                s = follow(&t, p, to[i]);
    }
    for (int32_t p = 0; p < n && s == TZ_OK; p++) /* loops */
        if (f->map.on[p] && t.node[p] == -1 && links(&t, p, to) == 2)
            s = follow(&t, p, to[0]);
    for (int32_t i = first_chain; i < g->chain.n && s == TZ_OK; i++)
        g->chain.v[i].gone = g->chain.v[i].n < 2;
    tz_free(g->ctx, t.node);
    return s;
}

void tz_line_graph_deinit(tz_line_graph *g)
{
    tz_array_free(g->ctx, &g->node);
    tz_array_free(g->ctx, &g->chain);
    tz_array_free(g->ctx, &g->point);
    *g = (tz_line_graph){0};
}
