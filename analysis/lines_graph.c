/* SPDX-License-Identifier: Apache-2.0 */
/* Which chains meet where, and chains that run on made one. */
#include "analysis/lines_graph.h"

tz_status tz_line_ends_init(const tz_line_graph *g, tz_line_ends *e)
{
    const size_t nodes = (size_t)g->node.n;
    *e = (tz_line_ends){0};
    tz_status s = tz_alloc_zero(g->ctx, &e->first, nodes + 2, sizeof *e->first);
    if (s == TZ_OK)
        s = tz_alloc(g->ctx, &e->end, 2 * (size_t)g->chain.n, sizeof *e->end);
    if (s != TZ_OK) {
        tz_line_ends_deinit(g, e);
        return s;
    }
    for (int32_t i = 0; i < g->chain.n; i++)
        for (int k = 0; k < 2; k++)
            if (!g->chain.v[i].gone && g->chain.v[i].node[k] >= 0)
                e->first[g->chain.v[i].node[k] + 2]++;
    for (size_t k = 2; k < nodes + 2; k++)
        e->first[k] += e->first[k - 1];
    for (int32_t i = 0; i < g->chain.n; i++)
        for (int k = 0; k < 2; k++)
            if (!g->chain.v[i].gone && g->chain.v[i].node[k] >= 0)
                e->end[e->first[g->chain.v[i].node[k] + 1]++] = 2 * i + k;
    return TZ_OK;
}

void tz_line_ends_deinit(const tz_line_graph *g, tz_line_ends *e)
{
    tz_free(g->ctx, e->first);
    tz_free(g->ctx, e->end);
    *e = (tz_line_ends){0};
}

/* ---- rejoining ----------------------------------------------------------------------- */

typedef struct rejoin {
    const tz_line_graph *from;
    tz_line_graph to;
    tz_line_ends ends;
    uint8_t *seen; /* chains of `from` */
} rejoin;

/* The end that chain end `end` runs on into, -1 where a path ends. */
static int32_t runs_on(const rejoin *r, int32_t end)
{
    const tz_line_chain *c = &r->from->chain.v[end >> 1];
    const int32_t node = c->node[end & 1];
    if (node < 0 || tz_line_degree(&r->ends, node) != 2)
        return -1;
    const int32_t *e = r->ends.end + r->ends.first[node];
    const int32_t other = e[0] == end ? e[1] : e[0];
    const tz_line_chain *d = &r->from->chain.v[other >> 1];
    return d->light == c->light && d->edge == c->edge ? other : -1;
}

/* Appends the points of a chain, entered at `end`. */
static tz_status append(rejoin *r, int32_t end, tz_line_chain *c)
{
    const tz_line_chain *old = &r->from->chain.v[end >> 1];
    tz_status s = TZ_OK;
    for (int32_t i = c->n > 0; i < old->n && s == TZ_OK; i++) {
        const tz_line_point p = *tz_line_chain_point(r->from, old, end & 1, i);
        const tz_line_point *last = c->n ? &r->to.point.v[r->to.point.n - 1] : NULL;
        if (last && last->at.x == p.at.x && last->at.y == p.at.y)
            continue;
        s = tz_array_push(r->to.ctx, &r->to.point, p);
        c->n += s == TZ_OK;
    }
    return s;
}

/* The path that begins with this end. */
static tz_status walk(rejoin *r, int32_t end)
{
    const tz_line_chain *start = &r->from->chain.v[end >> 1];
    tz_line_chain c = *start;
    tz_status s = TZ_OK;
    c.first = r->to.point.n;
    c.n = 0;
    c.node[0] = start->node[end & 1];
    for (int32_t at = end; at >= 0 && !r->seen[at >> 1] && s == TZ_OK;) {
        r->seen[at >> 1] = 1;
        s = append(r, at, &c);
        c.node[1] = r->from->chain.v[at >> 1].node[!(at & 1)];
        at = runs_on(r, at ^ 1);
    }
    if (s != TZ_OK)
        return s;
    if (c.node[0] >= 0 && c.node[0] == c.node[1] &&
        tz_line_degree(&r->ends, c.node[0]) == 2)
        c.node[0] = c.node[1] = -1; /* closed upon itself */
    if (c.n < 2 && (c.node[0] < 0 || c.node[0] == c.node[1]))
        return TZ_OK; /* a point */
    if (c.n < 2) {    /* joins two nodes in one place */
        s = tz_array_push(r->to.ctx, &r->to.point, r->to.point.v[c.first]);
        c.n = 2;
        if (s != TZ_OK)
            return s;
    }
    tz_line_chain_measure(&r->to, &c);
    return tz_array_push(r->to.ctx, &r->to.chain, c);
}

/* Nodes that chains end in, numbered anew. */
static tz_status keep_nodes(rejoin *r)
{
    int32_t *fresh = NULL;
    tz_status s = tz_alloc(r->to.ctx, &fresh, (size_t)r->from->node.n, sizeof *fresh);
    for (int32_t i = 0; i < r->from->node.n && s == TZ_OK; i++)
        fresh[i] = -1;
    for (int32_t i = 0; i < r->to.chain.n && s == TZ_OK; i++)
        for (int k = 0; k < 2 && s == TZ_OK; k++) {
            int32_t *n = &r->to.chain.v[i].node[k];
            if (*n < 0)
                continue;
            if (fresh[*n] < 0) {
                fresh[*n] = r->to.node.n;
                s = tz_array_push(r->to.ctx, &r->to.node, r->from->node.v[*n]);
            }
            *n = fresh[*n];
        }
    tz_free(r->to.ctx, fresh);
    return s;
}

tz_status tz_line_graph_rejoin(tz_line_graph *g)
{
    rejoin r = {.from = g, .to = {.width = g->width, .height = g->height, .ctx = g->ctx}};
    tz_status s = tz_line_ends_init(g, &r.ends);
    if (s == TZ_OK)
        s = tz_alloc_zero(g->ctx, &r.seen, (size_t)g->chain.n, 1);
    if (s == TZ_OK)
        s = tz_array_reserve(g->ctx, &r.to.point, g->point.n);
    for (int pass = 0; pass < 2 && s == TZ_OK; pass++) /* loops are left to the second */
        for (int32_t i = 0; i < g->chain.n && s == TZ_OK; i++)
            for (int32_t k = 0; k < 2 && s == TZ_OK; k++)
                if (!g->chain.v[i].gone && !r.seen[i] &&
                    (pass || runs_on(&r, 2 * i + k) < 0))
                    s = walk(&r, 2 * i + k);
    if (s == TZ_OK)
        s = keep_nodes(&r);
    tz_line_ends_deinit(g, &r.ends);
    tz_free(g->ctx, r.seen);
    if (s == TZ_OK) {
        tz_line_graph_deinit(g);
        *g = r.to;
    } else {
        tz_line_graph_deinit(&r.to);
    }
    return s;
}

tz_status tz_line_graph_append(tz_line_graph *to, const tz_line_graph *from)
{
    const int32_t node = to->node.n, point = to->point.n;
    tz_status s = TZ_OK;
    to->width = from->width;
    to->height = from->height;
    for (int32_t i = 0; i < from->node.n && s == TZ_OK; i++)
        s = tz_array_push(to->ctx, &to->node, from->node.v[i]);
    for (int32_t i = 0; i < from->point.n && s == TZ_OK; i++)
        s = tz_array_push(to->ctx, &to->point, from->point.v[i]);
    for (int32_t i = 0; i < from->chain.n && s == TZ_OK; i++) {
        tz_line_chain c = from->chain.v[i];
        c.first += point;
        for (int k = 0; k < 2; k++)
            c.node[k] += c.node[k] >= 0 ? node : 0;
        s = tz_array_push(to->ctx, &to->chain, c);
    }
    return s;
}
