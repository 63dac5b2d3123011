/* SPDX-License-Identifier: Apache-2.0 */
/* Junctions. Where lines of some width meet, the ridge breaks up: a cross becomes two
 * forks, and lines bend aside over about their width. Junctions joined by less than that
 * become one; each line is cut back to where it runs straight, and the junction moves to
 * the place nearest to all their tangents:
 *
 *     min over x of  sum_i (n_i' (x - p_i))^2 + damping |x - x0|^2 */
#include "analysis/lines_graph.h"

#include <math.h>
#include <stdlib.h>

#define NEAR    1.1  /* of the width: junctions nearer than that are one */
#define CUT     1.0  /* of the width: cut back */
#define RING    8    /* widths: rings no longer than that are none */
#define DAMPING 0.05 /* keeps a junction of parallel lines in place */

/* ---- near junctions ------------------------------------------------------------------ */

static int32_t root_of(int32_t *up, int32_t i)
{
    while (up[i] != i) {
        up[i] = up[up[i]];
        i = up[i];
    }
    return i;
}

typedef struct short_chain {
    double length;
    int32_t chain;
} short_chain;

typedef struct merger {
    tz_line_ends ends;
    int32_t *up, *count;
    tz_vec2 *sum;
    double *far; /* of any of a junction's from its middle, at most */
    short_chain *order;
    int32_t n;
} merger;

static int by_length(const void *a, const void *b)
{
    const short_chain *p = a, *q = b;
    if (p->length != q->length)
        return p->length < q->length ? -1 : 1;
    return p->chain - q->chain;
}

/* Chains that are shorter than what meets at their ends is wide. */
static void find_short(tz_line_graph *g, merger *m)
{
    for (int32_t i = 0; i < g->chain.n; i++) {
        const tz_line_chain *c = &g->chain.v[i];
        double wide = 0;
        if (c->gone || c->node[0] < 0 || tz_line_degree(&m->ends, c->node[0]) < 3 ||
            tz_line_degree(&m->ends, c->node[1]) < 3)
            continue;
        for (int k = 0; k < 2; k++)
            for (int32_t e = m->ends.first[c->node[k]]; e < m->ends.first[c->node[k] + 1];
                 e++)
                if (m->ends.end[e] >> 1 != i)
                    wide = fmax(wide, g->chain.v[m->ends.end[e] >> 1].width);
        if (c->length <= fmax(2, NEAR * wide))
            m->order[m->n++] = (short_chain){c->length, i};
    }
    qsort(m->order, (size_t)m->n, sizeof *m->order, by_length);
}

/* Two junctions become one, unless that would reach too far. */
static void unite(tz_line_graph *g, merger *m, int32_t chain)
{
    tz_line_chain *c = &g->chain.v[chain];
    const int32_t a = root_of(m->up, c->node[0]), b = root_of(m->up, c->node[1]);
    const double reach = fmax(2, NEAR * c->width);
    if (a != b) {
        const tz_vec2 pa = tz_vec2_scale(m->sum[a], 1.0 / m->count[a]),
                      pb = tz_vec2_scale(m->sum[b], 1.0 / m->count[b]);
        const tz_vec2 sum = tz_vec2_add(m->sum[a], m->sum[b]);
        const tz_vec2 mid = tz_vec2_scale(sum, 1.0 / (m->count[a] + m->count[b]));
        const double far = fmax(m->far[a] + tz_vec2_length(tz_vec2_sub(mid, pa)),
                                m->far[b] + tz_vec2_length(tz_vec2_sub(mid, pb)));
        if (far > reach)
            return;
        m->up[a] = b;
        m->sum[b] = sum;
        m->count[b] += m->count[a];
        m->far[b] = far;
    }
    c->gone = true;
}

static tz_status merge_near(tz_line_graph *g)
{
    merger m = {0};
    const size_t nodes = (size_t)g->node.n;
    tz_status s = tz_line_ends_init(g, &m.ends);
    if (s == TZ_OK)
        s = tz_alloc(g->ctx, &m.up, nodes, sizeof *m.up);
    if (s == TZ_OK)
        s = tz_alloc(g->ctx, &m.count, nodes, sizeof *m.count);
    if (s == TZ_OK)
        s = tz_alloc(g->ctx, &m.sum, nodes, sizeof *m.sum);
    if (s == TZ_OK)
        s = tz_alloc_zero(g->ctx, &m.far, nodes, sizeof *m.far);
    if (s == TZ_OK)
        s = tz_alloc(g->ctx, &m.order, (size_t)g->chain.n, sizeof *m.order);
    if (s != TZ_OK)
        goto done;
    for (int32_t i = 0; i < g->node.n; i++) {
        m.up[i] = i;
        m.sum[i] = g->node.v[i];
        m.count[i] = 1;
    }
    find_short(g, &m);
    for (int32_t i = 0; i < m.n; i++)
        unite(g, &m, m.order[i].chain);
    for (int32_t i = 0; i < g->node.n; i++)
        if (m.up[i] == i)
            g->node.v[i] = tz_vec2_scale(m.sum[i], 1.0 / m.count[i]);
    for (int32_t i = 0; i < g->chain.n; i++) {
        tz_line_chain *c = &g->chain.v[i];
        for (int k = 0; k < 2 && !c->gone && c->node[0] >= 0; k++) {
            c->node[k] = root_of(m.up, c->node[k]);
            tz_line_chain_point(g, c, k, 0)->at = g->node.v[c->node[k]];
        }
    }
done:
    tz_line_ends_deinit(g, &m.ends);
    tz_free(g->ctx, m.up);
    tz_free(g->ctx, m.count);
    tz_free(g->ctx, m.sum);
    tz_free(g->ctx, m.far);
    tz_free(g->ctx, m.order);
    return s;
}

/* ---- straight up to the junction ----------------------------------------------------- */

/* Where a chain is cut off at an end, and its direction there. */
typedef struct stub {
    int32_t end, skip;
    tz_vec2 at, along;
} stub;

static bool cut_end(const tz_line_graph *g, int32_t end, double reach, stub *out)
{
    const tz_line_chain *c = &g->chain.v[end >> 1];
    const tz_vec2 tip = tz_line_chain_point(g, c, end & 1, 0)->at;
    int32_t i = 1, k;
    if (c->length < 2.2 * reach || c->n < 4)
        return false;
    while (i < c->n - 2 && tz_vec2_length(tz_vec2_sub(
                               tz_line_chain_point(g, c, end & 1, i)->at, tip)) < reach)
        i++;
    out->end = end;
    out->skip = i;
    out->at = tz_line_chain_point(g, c, end & 1, i)->at;
    for (k = i + 1; k < c->n - 1; k++)
        if (tz_vec2_length(tz_vec2_sub(tz_line_chain_point(g, c, end & 1, k)->at,
                                       out->at)) > fmax(3, reach))
            break;
    const tz_vec2 d = tz_vec2_sub(tz_line_chain_point(g, c, end & 1, k)->at, out->at);
    const double n = tz_vec2_length(d);
    if (!(n > 0))
        return false;
    out->along = tz_vec2_scale(d, 1 / n);
    return true;
}

static tz_vec2 meet(const stub *b, int32_t n, tz_vec2 x0, double reach)
{
    double a11 = DAMPING, a12 = 0, a22 = DAMPING, r1 = 0, r2 = 0; /* about x0 */
    for (int32_t i = 0; i < n; i++) {
        const double nx = -b[i].along.y, ny = b[i].along.x;
        const double d = nx * (b[i].at.x - x0.x) + ny * (b[i].at.y - x0.y);
        a11 += nx * nx;
        a12 += nx * ny;
        a22 += ny * ny;
        r1 += nx * d;
        r2 += ny * d;
    }
    const double det = a11 * a22 - a12 * a12;
    tz_vec2 move = {(r1 * a22 - r2 * a12) / det, (r2 * a11 - r1 * a12) / det};
    const double far = tz_vec2_length(move);
    if (far > reach)
        move = tz_vec2_scale(move, reach / far);
    return tz_vec2_add(x0, move);
}

/* The points that are cut off go onto the straight way to the junction. */
static void straighten(tz_line_graph *g, const stub *b, tz_vec2 node)
{
    const tz_line_chain *c = &g->chain.v[b->end >> 1];
    for (int32_t i = 0; i < b->skip; i++) {
        const double t = (double)i / b->skip;
        tz_line_chain_point(g, c, b->end & 1, i)->at =
            (tz_vec2){node.x + t * (b->at.x - node.x), node.y + t * (b->at.y - node.y)};
    }
}

static tz_status straighten_all(tz_line_graph *g)
{
    enum { MOST = 8 };
    tz_line_ends ends;
    tz_status s = tz_line_ends_init(g, &ends);
    for (int32_t i = 0; i < g->node.n && s == TZ_OK; i++) {
        const int32_t n = tz_line_degree(&ends, i);
        const int32_t *e = ends.end + ends.first[i];
        stub b[MOST];
        int32_t stubs = 0;
        double wide = 0;
        if (n < 3 || n > MOST)
            continue;
        for (int32_t k = 0; k < n; k++)
            wide = fmax(wide, g->chain.v[e[k] >> 1].width);
        const double reach = fmax(2.5, CUT * wide);
        for (int32_t k = 0; k < n; k++)
            stubs += cut_end(g, e[k], reach, &b[stubs]);
        if (stubs > 1)
            g->node.v[i] = meet(b, stubs, g->node.v[i], 0.5 * reach);
        for (int32_t k = 0; k < stubs; k++)
            straighten(g, &b[k], g->node.v[i]);
        for (int32_t k = 0; k < n; k++)
            tz_line_chain_point(g, &g->chain.v[e[k] >> 1], e[k] & 1, 0)->at =
                g->node.v[i];
    }
    tz_line_ends_deinit(g, &ends);
    return s;
}

/* Rings about nothing: loops, and second ways, no longer than a few widths. */
static tz_status drop_rings(tz_line_graph *g)
{
    tz_line_ends ends;
    tz_status s = tz_line_ends_init(g, &ends);
    for (int32_t i = 0; i < g->chain.n && s == TZ_OK; i++) {
        tz_line_chain *c = &g->chain.v[i];
        if (c->node[0] == c->node[1])
            c->gone |= c->length < RING * c->width;
        if (c->gone || c->node[0] < 0 || c->node[0] == c->node[1])
            continue;
        for (int32_t e = ends.first[c->node[0]]; e < ends.first[c->node[0] + 1]; e++) {
            const int32_t k = ends.end[e] >> 1;
            tz_line_chain *d = &g->chain.v[k];
            if (k <= i || d->gone || d->node[!(ends.end[e] & 1)] != c->node[1] ||
                c->length + d->length > RING * fmax(c->width, d->width))
                continue;
            if (c->strength >= d->strength)
                d->gone = true;
            else
                c->gone = true;
        }
    }
    tz_line_ends_deinit(g, &ends);
    return s;
}

tz_status tz_line_graph_mend(tz_line_graph *g)
{
    tz_status s = drop_rings(g);
    if (s == TZ_OK)
        s = tz_line_graph_rejoin(g);
    if (s == TZ_OK)
        s = merge_near(g);
    if (s == TZ_OK)
        s = tz_line_graph_rejoin(g);
    if (s == TZ_OK)
        s = straighten_all(g);
    for (int32_t i = 0; i < g->chain.n && s == TZ_OK; i++)
        tz_line_chain_measure(g, &g->chain.v[i]);
    return s;
}

/* ---- smoothing ----------------------------------------------------------------------- */

tz_status tz_line_graph_smooth(tz_line_graph *g, double sigma)
{
    TZ_ARRAY(tz_line_point)
    old = {0};
    const int32_t reach = (int32_t)ceil(3 * sigma), reach_wide = 3 * reach;
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < g->chain.n && s == TZ_OK; i++) {
        tz_line_chain *c = &g->chain.v[i];
        tz_line_point *p = g->point.v + c->first;
        const bool loop = c->node[0] < 0;
        const int32_t round = c->n - 1; /* the last point of a loop is its first */
        s = tz_array_reserve(g->ctx, &old, c->n);
        for (int32_t k = 0; k < c->n && s == TZ_OK; k++)
            old.v[k] = p[k];
        for (int32_t k = 0; k < c->n && s == TZ_OK; k++) {
            /* as far as there are points on both sides, so that ends stay */
            int32_t most = loop ? round / 2 : k < c->n - 1 - k ? k : c->n - 1 - k;
            double sum = 0, width = 0, weights = 0, all = 0;
            tz_vec2 at = {0, 0};
            for (int32_t d = -reach_wide; d <= reach_wide; d++) {
                int32_t q = k + d;
                if (loop && round > 0)
                    q = ((q % round) + round) % round;
                if (q < 0 || q >= c->n)
                    continue;
                const double far = d / (3 * sigma), weight = exp(-0.5 * far * far);
                width += weight * old.v[q].width;
                weights += weight;
                if (d < -most || d > most || d < -reach || d > reach)
                    continue;
                const double near = exp(-0.5 * d * d / (sigma * sigma));
                at = tz_vec2_add(at, tz_vec2_scale(old.v[q].at, near));
                sum += near;
                all += 1;
            }
            p[k].width = (float)(width / weights);
            if (all > 1)
                p[k].at = tz_vec2_scale(at, 1 / sum);
        }
        if (s == TZ_OK && loop)
            p[c->n - 1] = p[0];
        if (s == TZ_OK)
            tz_line_chain_measure(g, c);
    }
    tz_array_free(g->ctx, &old);
    return s;
}
