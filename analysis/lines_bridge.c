/* SPDX-License-Identifier: Apache-2.0 */
/* Gaps. An end looks ahead, as far as gaps may be, for the point of a line that it most
 * likely runs on to:
 *
 *     cost = gap / widest * (1 + 2 (1 - cos a)) * (1 + 2 (1 - cos b)) * (1.2 - 0.4 evidence)
 *
 * a is the turn at the end, b that at the other end if there is one (else 0, and a fixed
 * price for a new junction), evidence the mean strength on the way against that of lines,
 * at most 1. Under 1, the gap is closed, the cheapest first; each end once. The turns are
 * those that tensor voting (Medioni, Lee, Tang 2000) punishes, without its field. */
#include "analysis/lines_graph.h"

#include <math.h>
#include <stdlib.h>

#include "base/grid.h"

#define LOOK     512 /* points that an end looks at, at most */
#define JUNCTION 1.3 /* price of a new junction */

typedef struct tip {
    tz_vec2 at, ahead;
    int32_t node, end; /* 2 chain + end */
    bool used;
} tip;

typedef struct gap {
    double cost;
    int32_t tip, other; /* other: tip, or -1 */
    int32_t chain, point;
} gap;

typedef struct split {
    int32_t chain, point, node;
} split;

typedef struct bridging {
    tz_line_graph *g;
    const tz_line_field *f;
    const tz_line_tidy *t;
    tz_line_ends ends;
    tz_grid grid;
    int32_t *tip_of; /* of a node, -1 */
    TZ_ARRAY(tip)
    tip;
    TZ_ARRAY(gap)
    gap;
    TZ_ARRAY(split)
    split;
    TZ_ARRAY(int32_t)
    owner; /* of the grid's points: chain, point */
} bridging;

/* ---- ends ---------------------------------------------------------------------------- */

static tz_vec2 direction(const tz_line_graph *g, int32_t end)
{
    const tz_line_chain *c = &g->chain.v[end >> 1];
    const tz_vec2 at = tz_line_chain_point(g, c, end & 1, 0)->at;
    const double far = fmax(6, 1.5 * c->width);
    int32_t i = 1;
    while (i < c->n - 1 && tz_vec2_length(tz_vec2_sub(
                               tz_line_chain_point(g, c, end & 1, i)->at, at)) < far)
        i++;
    const tz_vec2 d = tz_vec2_sub(at, tz_line_chain_point(g, c, end & 1, i)->at);
    const double n = tz_vec2_length(d);
    return n > 0 ? tz_vec2_scale(d, 1 / n) : (tz_vec2){0, 0};
}

static tz_status find_tips(bridging *b)
{
    const tz_line_graph *g = b->g;
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < g->node.n && s == TZ_OK; i++) {
        b->tip_of[i] = -1;
        if (tz_line_degree(&b->ends, i) != 1)
            continue;
        const int32_t end = b->ends.end[b->ends.first[i]];
        b->tip_of[i] = b->tip.n;
        s = tz_array_push(g->ctx, &b->tip,
                          ((tip){g->node.v[i], direction(g, end), i, end, false}));
    }
    return s;
}

static tz_status fill_grid(bridging *b)
{
    const tz_line_graph *g = b->g;
    tz_status s = tz_grid_init(g->ctx, &b->grid, (tz_vec2){0, 0},
                               (tz_vec2){g->width, g->height}, fmax(b->t->gap, 2), false);
    for (int32_t i = 0; i < g->chain.n && s == TZ_OK; i++)
        for (int32_t k = 0; k < g->chain.v[i].n && s == TZ_OK; k++) {
            if (g->chain.v[i].gone)
                break;
            int32_t id; /* in the order of `owner` */
            s = tz_grid_add(g->ctx, &b->grid, g->point.v[g->chain.v[i].first + k].at,
                            &id);
            if (s == TZ_OK)
                s = tz_array_push(g->ctx, &b->owner, i);
            if (s == TZ_OK)
                s = tz_array_push(g->ctx, &b->owner, k);
        }
    return s;
}

/* ---- gaps ---------------------------------------------------------------------------- */

static float strength_at(const tz_line_field *f, tz_vec2 p)
{
    const double x = floor(p.x), y = floor(p.y);
    if (!(x >= 0 && y >= 0 && x < f->map.width && y < f->map.height))
        return 0;
    return f->map.response[(ptrdiff_t)y * f->map.width + (ptrdiff_t)x];
}

static double evidence(const bridging *b, tz_vec2 p, tz_vec2 q)
{
    const int32_t n = 1 + (int32_t)tz_vec2_length(tz_vec2_sub(q, p));
    double sum = 0;
    for (int32_t i = 0; i < n; i++) {
        const double t = (i + 0.5) / n;
        sum += strength_at(b->f, (tz_vec2){p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)});
    }
    return fmin(1, sum / n / b->t->low);
}

/* Whether the point is on the way that the tip has come. */
static bool behind(const bridging *b, const tip *t, int32_t chain, int32_t point)
{
    const tz_line_chain *c = &b->g->chain.v[chain];
    if (t->end >> 1 != chain)
        return false;
    const int32_t back = t->end & 1 ? c->n - 1 - point : point;
    return back < 4 * b->t->gap;
}

static gap judge(const bridging *b, int32_t from, int32_t id)
{
    const tip *t = &b->tip.v[from];
    gap out = {INFINITY, from, -1, b->owner.v[2 * id], b->owner.v[2 * id + 1]};
    const tz_line_chain *c = &b->g->chain.v[out.chain];
    const tz_vec2 to = b->grid.point.v[id], way = tz_vec2_sub(to, t->at);
    const double far = tz_vec2_length(way);
    if (far > b->t->gap || behind(b, t, out.chain, out.point))
        return out;
    const double turn = far > 0 ? tz_vec2_dot(way, t->ahead) / far : 1;
    double cost = far / b->t->gap * (1 + 2 * (1 - turn)), price = JUNCTION;
    if (turn < 0.25)
        return out;
    for (int k = 0; k < 2 && c->node[0] >= 0; k++) {
        const int32_t other = b->tip_of[c->node[k]];
        if (out.point != (k ? c->n - 1 : 0) || other < 0 || other == from)
            continue;
        const double bend = far > 0 ? -tz_vec2_dot(way, b->tip.v[other].ahead) / far : 1;
        if (bend < 0.25)
            continue;
        out.other = other;
        price = 1 + 2 * (1 - bend);
    }
    cost *= price;
    if (cost < 1.25)
        out.cost = cost * (1.2 - 0.4 * evidence(b, t->at, to));
    return out;
}

static int by_cost(const void *a, const void *b)
{
    const gap *p = a, *q = b;
    if (p->cost != q->cost)
        return p->cost < q->cost ? -1 : 1;
    return p->tip - q->tip;
}

static tz_status find_gaps(bridging *b)
{
    int32_t near[LOOK];
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < b->tip.n && s == TZ_OK; i++) {
        int32_t n = tz_grid_query(&b->grid, b->tip.v[i].at, b->t->gap, near, LOOK);
        gap best = {.cost = INFINITY};
        n = n < LOOK ? n : LOOK;
        for (int32_t k = 0; k < n; k++) {
            const gap here = judge(b, i, near[k]);
            if (here.cost < best.cost)
                best = here;
        }
        if (best.cost < 1)
            s = tz_array_push(b->g->ctx, &b->gap, best);
    }
    if (s == TZ_OK && b->gap.n > 0)
        qsort(b->gap.v, (size_t)b->gap.n, sizeof *b->gap.v, by_cost);
    return s;
}

/* ---- closing ------------------------------------------------------------------------- */

/* A straight chain from a tip to a node. */
static tz_status add_chain(bridging *b, const tip *t, int32_t node, float width)
{
    tz_line_graph *g = b->g;
    const tz_line_chain *old = &g->chain.v[t->end >> 1];
    const tz_vec2 to = g->node.v[node];
    const float own = tz_line_chain_point(g, old, t->end & 1, 0)->width;
    const int32_t n = 2 + (int32_t)tz_vec2_length(tz_vec2_sub(to, t->at));
    tz_line_chain c = {.node = {t->node, node},
                       .first = g->point.n,
                       .n = n,
                       .light = old->light,
                       .edge = old->edge};
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < n && s == TZ_OK; i++) {
        const double k = (double)i / (n - 1);
        const tz_vec2 at = {t->at.x + k * (to.x - t->at.x),
                            t->at.y + k * (to.y - t->at.y)};
        s = tz_array_push(
            g->ctx, &g->point,
            ((tz_line_point){at, strength_at(b->f, at), own + (float)k * (width - own)}));
    }
    if (s != TZ_OK)
        return s;
    tz_line_chain_measure(g, &c);
    return tz_array_push(g->ctx, &g->chain, c);
}

static tz_status close_gaps(bridging *b)
{
    tz_line_graph *g = b->g;
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < b->gap.n && s == TZ_OK; i++) {
        const gap *p = &b->gap.v[i];
        tip *t = &b->tip.v[p->tip];
        if (t->used || (p->other >= 0 && b->tip.v[p->other].used))
            continue;
        const tz_line_chain *c = &g->chain.v[p->chain];
        const tz_line_point *to = &g->point.v[c->first + p->point];
        const float width = to->width;
        int32_t node = -1;
        if (p->other >= 0) {
            node = b->tip.v[p->other].node;
            b->tip.v[p->other].used = true;
        } else if (c->node[0] >= 0 && (p->point == 0 || p->point == c->n - 1)) {
            node = c->node[p->point > 0];
        } else {
            node = g->node.n;
            s = tz_array_push(g->ctx, &g->node, to->at);
            if (s == TZ_OK)
                s = tz_array_push(g->ctx, &b->split, ((split){p->chain, p->point, node}));
        }
        t->used = true;
        if (s == TZ_OK)
            s = add_chain(b, t, node, width);
    }
    return s;
}

/* Ends near the border of the picture run on to it. */
static tz_status reach_border(bridging *b)
{
    tz_line_graph *g = b->g;
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < b->tip.n && s == TZ_OK; i++) {
        const tip *t = &b->tip.v[i];
        const double reach = fmax(8, 3 * g->chain.v[t->end >> 1].width);
        const double room[4] = {t->at.x, g->width - t->at.x, t->at.y,
                                g->height - t->at.y},
                     pace[4] = {-t->ahead.x, t->ahead.x, -t->ahead.y, t->ahead.y};
        double far = INFINITY;
        for (int k = 0; k < 4; k++)
            if (room[k] <= reach && pace[k] > 0.3)
                far = fmin(far, fmax(room[k], 0) / pace[k]);
        if (t->used || !(far < 2 * reach))
            continue;
        const tz_vec2 to = {fmin(fmax(t->at.x + far * t->ahead.x, 0), g->width),
                            fmin(fmax(t->at.y + far * t->ahead.y, 0), g->height)};
        const float width =
            tz_line_chain_point(g, &g->chain.v[t->end >> 1], t->end & 1, 0)->width;
        s = tz_array_push(g->ctx, &g->node, to);
        if (s == TZ_OK)
            s = add_chain(b, t, g->node.n - 1, width);
    }
    return s;
}

static int by_place(const void *a, const void *b)
{
    const split *p = a, *q = b;
    if (p->chain != q->chain)
        return p->chain - q->chain;
    if (p->point != q->point)
        return p->point - q->point;
    return p->node - q->node;
}

/* Chains are cut where new ones join them; the parts share the points. */
static tz_status cut_chains(bridging *b)
{
    tz_line_graph *g = b->g;
    tz_status s = TZ_OK;
    if (b->split.n > 0)
        qsort(b->split.v, (size_t)b->split.n, sizeof *b->split.v, by_place);
    for (int32_t i = b->split.n - 1; i >= 0 && s == TZ_OK; i--) { /* from the back */
        const split *p = &b->split.v[i];
        if (g->chain.v[p->chain].node[0] < 0) { /* a loop gets a node where it begins */
            const tz_vec2 at = g->point.v[g->chain.v[p->chain].first].at;
            s = tz_array_push(g->ctx, &g->node, at);
            if (s != TZ_OK)
                break;
            g->chain.v[p->chain].node[0] = g->chain.v[p->chain].node[1] = g->node.n - 1;
        }
        tz_line_chain *c = &g->chain.v[p->chain], rest;
        if (p->point == 0 || p->point >= c->n - 1) {
            /* at an end: a chain of no length joins the nodes */
            tz_line_chain joint = *c;
            const tz_line_point at = g->point.v[c->first + p->point];
            joint.node[0] = c->node[p->point > 0];
            joint.node[1] = p->node;
            joint.first = g->point.n;
            joint.n = 2;
            s = tz_array_push(g->ctx, &g->point, at);
            if (s == TZ_OK)
                s = tz_array_push(g->ctx, &g->point, at);
            if (s == TZ_OK)
                s = tz_array_push(g->ctx, &g->chain, joint);
            continue;
        }
        rest = *c;
        rest.first += p->point;
        rest.n -= p->point;
        rest.node[0] = p->node;
        c->n = p->point + 1;
        c->node[1] = p->node;
        tz_line_chain_measure(g, c);
        tz_line_chain_measure(g, &rest);
        s = tz_array_push(g->ctx, &g->chain, rest);
    }
    return s;
}

tz_status tz_line_graph_bridge(tz_line_graph *g, const tz_line_field *f,
                               const tz_line_tidy *t)
{
    bridging b = {.g = g, .f = f, .t = t};
    tz_status s = tz_line_ends_init(g, &b.ends);
    if (s == TZ_OK)
        s = tz_alloc(g->ctx, &b.tip_of, (size_t)g->node.n, sizeof *b.tip_of);
    if (s == TZ_OK)
        s = find_tips(&b);
    if (s == TZ_OK && t->gap > 0)
        s = fill_grid(&b);
    if (s == TZ_OK && t->gap > 0)
        s = find_gaps(&b);
    if (s == TZ_OK)
        s = close_gaps(&b);
    if (s == TZ_OK)
        s = reach_border(&b);
    if (s == TZ_OK)
        s = cut_chains(&b);
    if (s == TZ_OK)
        s = tz_line_graph_rejoin(g);
    tz_line_ends_deinit(g, &b.ends);
    tz_grid_deinit(g->ctx, &b.grid);
    tz_free(g->ctx, b.tip_of);
    tz_array_free(g->ctx, &b.tip);
    tz_array_free(g->ctx, &b.gap);
    tz_array_free(g->ctx, &b.split);
    tz_array_free(g->ctx, &b.owner);
    return s;
}
