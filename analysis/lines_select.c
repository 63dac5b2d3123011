/* SPDX-License-Identifier: Apache-2.0 */
/* Which chains are lines. The strength along a line exceeds what chance ridges of the
 * picture's grain have, so a chain's proof is
 *
 *     sum over its points of  min(strength, 3 low) - low
 *
 * the log-likelihood of a line against chance up to a factor. The part of the graph with
 * the most proof is kept, with a price for each loose branch: branches are cut from their
 * loose ends inwards, the weakest first, and what is connected must carry its price as a
 * whole.
 *
 * `low` parts lines from chance ridges: of the logarithms of all ridges' strengths, Otsu's
 * threshold, raised up to twice where they do not fall apart in two (two: the share of
 * their variance that lies between the halves; 0.64 for a normal distribution). The forest
 * has been taught what borders are: its answers are not raised, and have an upper bound.
 * @source Otsu: A threshold selection method from gray-level histograms, 1979 */
#include "analysis/lines_graph.h"

#include <math.h>
#include <stdlib.h>

#define ROUNDS 6

#define BINS    256
#define WEAKEST 0.25 /* lines have this much of their mean strength at least */
#define GRAIN   0.04 /* share of px that are ridges where there is nothing but grain */
#define SURELY  25   /* answer of the forest that is a border anywhere, of 100 */

typedef struct leaf {
    double proof;
    int32_t chain;
} leaf;

double tz_line_part(const tz_line_field *r)
{
    const ptrdiff_t all = (ptrdiff_t)r->map.width * r->map.height;
    const double octave = BINS / 7.0; /* 1 .. 128 */
    double count[BINS] = {0}, n = 0, sum = 0, square = 0, below = 0, low_sum = 0,
           best = 0;
    int at = 0;
    for (ptrdiff_t i = 0; i < all; i++)
        if (r->map.on[i]) {
            const double k = octave * log2(fmax(1, r->map.response[i]));
            count[(int)fmin(k, BINS - 1)]++;
        }
    double ridges = 0;
    for (int k = 0; k < BINS; k++)
        ridges += count[k];
    if (!r->edge)
        count[0] += fmax(0, GRAIN * (double)all - ridges); /* of strength 1 or less */
    for (int k = 0; k < BINS; k++) {
        n += count[k];
        sum += k * count[k];
        square += (double)k * k * count[k];
    }
    for (int k = 0; k < BINS - 1; k++) {
        below += count[k];
        low_sum += k * count[k];
        if (below < 1 || n - below < 1)
            continue;
        const double apart = (sum - low_sum) / (n - below) - low_sum / below;
        const double between = below * (n - below) * apart * apart;
        if (between > best) {
            best = between;
            at = k;
        }
    }
    const double spread = n > 0 ? square / n - sum / n * (sum / n) : 0;
    const double two = spread > 0 ? best / (n * n) / spread : 1;
    const double unclear = r->edge ? 0 : fmin(fmax((0.80 - two) / 0.14, 0), 1);
    const double low = exp2((at + 1) / octave) * (1 + unclear);
    if (r->edge)
        return fmin(low, SURELY);
    double above = 0, mean = 0; /* of what is stronger */
    for (int k = (int)(octave * log2(low)); k < BINS; k++) {
        above += count[k];
        mean += count[k] * exp2(k / octave);
    }
    return above > 0 ? fmax(low, WEAKEST * mean / above) : low;
}

double tz_line_chain_proof(const tz_line_graph *g, const tz_line_chain *c, double low)
{
    const tz_line_point *p = g->point.v + c->first;
    double sum = 0;
    for (int32_t i = 0; i < c->n; i++)
        sum += (p[i].strength < 3 * low ? p[i].strength : 3 * low) - low;
    return sum;
}

static int by_proof(const void *a, const void *b)
{
    const leaf *p = a, *q = b;
    if (p->proof != q->proof)
        return p->proof < q->proof ? -1 : 1;
    return p->chain - q->chain;
}

/* Widest of the other chains at a node. */
static double width_at(const tz_line_graph *g, const tz_line_ends *e, int32_t node,
                       int32_t but)
{
    double most = 0;
    for (int32_t i = e->first[node]; i < e->first[node + 1]; i++)
        if (e->end[i] >> 1 != but && g->chain.v[e->end[i] >> 1].width > most)
            most = g->chain.v[e->end[i] >> 1].width;
    return most;
}

/* Cuts loose branches; *cut is how many. */
static tz_status cut_leaves(tz_line_graph *g, const tz_line_tidy *t, int32_t *cut)
{
    tz_line_ends ends;
    int32_t *degree = NULL, leaves = 0;
    leaf *l = NULL;
    *cut = 0;
    tz_status s = tz_line_ends_init(g, &ends);
    if (s == TZ_OK)
        s = tz_alloc(g->ctx, &degree, (size_t)g->node.n, sizeof *degree);
    if (s == TZ_OK)
        s = tz_alloc(g->ctx, &l, (size_t)g->chain.n, sizeof *l);
    if (s != TZ_OK)
        goto done;
    for (int32_t i = 0; i < g->node.n; i++)
        degree[i] = tz_line_degree(&ends, i);
    for (int32_t i = 0; i < g->chain.n; i++) {
        const tz_line_chain *c = &g->chain.v[i];
        if (!c->gone && c->node[0] >= 0 &&
            (degree[c->node[0]] == 1) != (degree[c->node[1]] == 1))
            l[leaves++] = (leaf){tz_line_chain_proof(g, c, t->low), i};
    }
    qsort(l, (size_t)leaves, sizeof *l, by_proof);
    for (int32_t k = 0; k < leaves; k++) {
        tz_line_chain *c = &g->chain.v[l[k].chain];
        const int32_t root = degree[c->node[0]] == 1 ? c->node[1] : c->node[0];
        if (degree[root] < 3 || (l[k].proof >= 0.5 * t->proof && c->length >= t->length &&
                                 c->length >= width_at(g, &ends, root, l[k].chain)))
            continue;
        c->gone = true;
        degree[root]--;
        (*cut)++;
    }
done:
    tz_line_ends_deinit(g, &ends);
    tz_free(g->ctx, degree);
    tz_free(g->ctx, l);
    return s;
}

/* Inner chains that speak against a line. */
static void cut_weak(tz_line_graph *g, const tz_line_tidy *t)
{
    for (int32_t i = 0; i < g->chain.n; i++) {
        tz_line_chain *c = &g->chain.v[i];
        if (!c->gone && c->strength < 0.75 * t->low && c->length > 2 * c->width)
            c->gone = true;
    }
}

static int32_t root_of(int32_t *up, int32_t i)
{
    while (up[i] != i) {
        up[i] = up[up[i]];
        i = up[i];
    }
    return i;
}

/* What hangs together must be a line as a whole. */
static tz_status cut_components(tz_line_graph *g, const tz_line_tidy *t)
{
    int32_t *up = NULL;
    double *proof = NULL, *length = NULL;
    const size_t n = (size_t)g->node.n + 1;
    tz_status s = tz_alloc(g->ctx, &up, n, sizeof *up);
    if (s == TZ_OK)
        s = tz_alloc_zero(g->ctx, &proof, n, sizeof *proof);
    if (s == TZ_OK)
        s = tz_alloc_zero(g->ctx, &length, n, sizeof *length);
    if (s != TZ_OK)
        goto done;
    for (int32_t i = 0; i < g->node.n; i++)
        up[i] = i;
    for (int32_t i = 0; i < g->chain.n; i++) {
        const tz_line_chain *c = &g->chain.v[i];
        if (!c->gone && c->node[0] >= 0)
            up[root_of(up, c->node[0])] = root_of(up, c->node[1]);
    }
    for (int pass = 0; pass < 2; pass++)
        for (int32_t i = 0; i < g->chain.n; i++) {
            tz_line_chain *c = &g->chain.v[i];
            if (c->gone)
                continue;
            const double own = tz_line_chain_proof(g, c, t->low);
            const int32_t k = c->node[0] >= 0 ? root_of(up, c->node[0]) : -1;
            if (!pass && k >= 0) {
                proof[k] += own;
                length[k] += c->length;
            } else if (pass) {
                c->gone = (k < 0 ? own : proof[k]) < t->proof ||
                          (k < 0 ? c->length : length[k]) < 2 * t->length;
            }
        }
done:
    tz_free(g->ctx, up);
    tz_free(g->ctx, proof);
    tz_free(g->ctx, length);
    return s;
}

tz_status tz_line_graph_select(tz_line_graph *g, const tz_line_tidy *t)
{
    int32_t cut = 1;
    tz_status s = TZ_OK;
    for (int round = 0; round < ROUNDS && cut > 0 && s == TZ_OK; round++) {
        if (round > 0)
            cut_weak(g, t);
        s = cut_leaves(g, t, &cut);
        if (s == TZ_OK)
            s = tz_line_graph_rejoin(g);
        cut += round == 0; /* weak chains have not been cut yet */
    }
    if (s == TZ_OK)
        s = cut_components(g, t);
    return s == TZ_OK ? tz_line_graph_rejoin(g) : s;
}
