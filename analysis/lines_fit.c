/* SPDX-License-Identifier: Apache-2.0 */
/* Curves out of chains. Pens: the longest chains first, each takes the pen that is nearest
 * in colour and width or, while there are few, becomes a new one; a pen is the mean of its
 * chains. At a junction the straightest pair of one pen runs on as one path. */
#include "analysis/lines_fit.h"

#include <math.h>
#include <stdlib.h>

#include "curves/curve_fit_internal.h"

#define PENS     6
#define NEAR_PEN 16.0 /* colours apart, of 100, an octave of width counting as much */
#define STRAIGHT 0.85 /* cosine of the bend at which lines run on */
#define LEAST    0.25 /* width of a line, px */

typedef struct look {
    double v[4]; /* red, green, blue 0 .. 100; log2 width */
} look;

typedef struct fitting {
    const tz_line_graph *g;
    tz_curve_set *to;
    double side, error;
    look *of;            /* chains */
    int32_t *pen, *next; /* of a chain; of an end: the end that it runs on into, or -1 */
    int32_t *node;       /* of to */
    uint8_t *seen;
    tz_line_ends ends;
    TZ_ARRAY(tz_vec2)
    way; /* points of the chain that is being fitted */
} fitting;

/* ---- pens ---------------------------------------------------------------------------- */

static look look_of(const tz_line_picture *im, const tz_line_graph *g,
                    const tz_line_chain *c)
{
    const ptrdiff_t all = (ptrdiff_t)im->width * im->height;
    look k = {{0}};
    double width = 0;
    for (int32_t i = 0; i < c->n; i++) {
        const tz_line_point *p = &g->point.v[c->first + i];
        const double x = floor(fmin(fmax(p->at.x, 0), im->width - 1)),
                     y = floor(fmin(fmax(p->at.y, 0), im->height - 1));
        const float *v = im->v + (ptrdiff_t)y * im->width + (ptrdiff_t)x;
        for (int b = 0; b < 3; b++)
            k.v[b] += v[im->channels == 3 ? b * all : 0];
        width += fmax(p->width, LEAST);
    }
    for (int b = 0; b < 3; b++)
        k.v[b] /= c->n;
    k.v[3] = log2(width / c->n);
    return k;
}

static double apart(const look *a, const look *b)
{
    double sum = 0;
    for (int k = 0; k < 3; k++)
        sum += (a->v[k] - b->v[k]) * (a->v[k] - b->v[k]) / 3;
    const double octaves = NEAR_PEN * (a->v[3] - b->v[3]);
    return sqrt(sum + octaves * octaves);
}

static int by_length(const void *a, const void *b)
{
    const double *p = a, *q = b; /* length, chain */
    if (p[0] != q[0])
        return p[0] > q[0] ? -1 : 1;
    return p[1] < q[1] ? -1 : p[1] > q[1];
}

static uint32_t colour_of(const look *k)
{
    uint32_t rgba = 0;
    for (int b = 0; b < 3; b++)
        rgba = rgba << 8 | (uint32_t)lrint(2.55 * fmin(fmax(k->v[b], 0), 100));
    return rgba << 8 | 0xff;
}

static tz_status choose_pens(fitting *f, const tz_line_picture *im)
{
    const tz_line_graph *g = f->g;
    look lead[PENS], sum[PENS] = {{{0}}};
    double length[PENS] = {0};
    int32_t id[PENS], n = 0;
    double(*order)[2] = NULL;
    tz_status s = tz_alloc(g->ctx, &order, (size_t)g->chain.n, sizeof *order);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < g->chain.n; i++) {
        f->of[i] = look_of(im, g, &g->chain.v[i]);
        order[i][0] = g->chain.v[i].length;
        order[i][1] = i;
    }
    qsort(order, (size_t)g->chain.n, sizeof *order, by_length);
    for (int32_t i = 0; i < g->chain.n; i++) {
        const int32_t c = (int32_t)order[i][1];
        int32_t best = 0;
        for (int32_t k = 1; k < n; k++)
            if (apart(&f->of[c], &lead[k]) < apart(&f->of[c], &lead[best]))
                best = k;
        if (n == 0 || (n < PENS && apart(&f->of[c], &lead[best]) > NEAR_PEN)) {
            best = n++;
            lead[best] = f->of[c];
        }
        f->pen[c] = best;
        for (int b = 0; b < 4; b++)
            sum[best].v[b] += order[i][0] * f->of[c].v[b];
        length[best] += order[i][0];
    }
    for (int32_t k = 0; k < n && s == TZ_OK; k++) {
        for (int b = 0; b < 4 && length[k] > 0; b++)
            lead[k].v[b] = sum[k].v[b] / length[k];
        const double width = f->side * exp2(lead[k].v[3]);
        s = tz_curve_add_pen(f->to,
                             (tz_curve_pen){.width = rint(fmax(width, LEAST) * 100) / 100,
                                            .color = colour_of(&lead[k]),
                                            .cap = 1,
                                            .join = 1},
                             &id[k]);
    }
    for (int32_t i = 0; i < g->chain.n && s == TZ_OK; i++)
        f->pen[i] = id[f->pen[i]];
    tz_free(g->ctx, order);
    return s;
}

/* ---- paths --------------------------------------------------------------------------- */

/* Unit direction in which a chain leaves its end, over a few px. */
static tz_vec2 leaves(const tz_line_graph *g, int32_t end)
{
    const tz_line_chain *c = &g->chain.v[end >> 1];
    const tz_vec2 from = tz_line_chain_point(g, c, end & 1, 0)->at;
    const double far = fmax(4, 1.5 * c->width);
    int32_t i = 1;
    while (i < c->n - 1 && tz_vec2_length(tz_vec2_sub(
                               tz_line_chain_point(g, c, end & 1, i)->at, from)) < far)
        i++;
    const tz_vec2 d = tz_vec2_sub(tz_line_chain_point(g, c, end & 1, i)->at, from);
    const double n = tz_vec2_length(d);
    return n > 0 ? tz_vec2_scale(d, 1 / n) : (tz_vec2){1, 0};
}

/* Straightest pairs of ends at a node, the best first. */
static void pair_up(fitting *f, int32_t node)
{
    const int32_t *e = f->ends.end + f->ends.first[node],
                  n = tz_line_degree(&f->ends, node);
    for (int32_t round = 0; round < n / 2; round++) {
        int32_t a = -1, b = -1;
        double best = -STRAIGHT;
        for (int32_t i = 0; i < n; i++)
            for (int32_t k = i + 1; k < n; k++) {
                if (f->next[e[i]] >= 0 || f->next[e[k]] >= 0 ||
                    f->pen[e[i] >> 1] != f->pen[e[k] >> 1])
                    continue;
                const double cosine = tz_vec2_dot(leaves(f->g, e[i]), leaves(f->g, e[k]));
                if (cosine < best) {
                    best = cosine;
                    a = e[i];
                    b = e[k];
                }
            }
        if (a < 0)
            return;
        f->next[a] = b;
        f->next[b] = a;
    }
}

static tz_status node_at(fitting *f, int32_t node, tz_vec2 at, int32_t *id)
{
    if (node >= 0 && f->node[node] >= 0) {
        *id = f->node[node];
        return TZ_OK;
    }
    const tz_status s = tz_curve_add_node(f->to, at, id);
    if (s == TZ_OK && node >= 0)
        f->node[node] = *id;
    return s;
}

/* Widths of the pieces from `first` on, whose nodes are points of the chain. */
static tz_status add_tapers(fitting *f, int32_t end, int32_t first)
{
    const tz_line_chain *c = &f->g->chain.v[end >> 1];
    int32_t i = 0;
    tz_status s = TZ_OK;
    for (int32_t k = first; k < f->to->piece.n && s == TZ_OK; k++) {
        const tz_vec2 to = f->to->node.v[f->to->piece.v[k].to];
        tz_curve_taper t;
        t.from = tz_line_chain_point(f->g, c, end & 1, i)->width;
        for (i++; i < c->n - 1; i++)
            if (f->way.v[i].x == to.x && f->way.v[i].y == to.y)
                break;
        if (i > c->n - 1)
            i = c->n - 1;
        t.to = tz_line_chain_point(f->g, c, end & 1, i)->width;
        t.from = fmax(LEAST, t.from) * f->side;
        t.to = fmax(LEAST, t.to) * f->side;
        s = tz_array_push(f->to->ctx, &f->to->taper, t);
    }
    return s;
}

/* The chain, entered at `end`, as pieces of the open path. */
static tz_status add_chain(fitting *f, int32_t end)
{
    const tz_line_chain *c = &f->g->chain.v[end >> 1];
    const int32_t first = f->to->piece.n;
    int32_t node[2] = {-1, -1};
    tz_status s = TZ_OK;
    f->way.n = 0;
    for (int32_t i = 0; i < c->n && s == TZ_OK; i++)
        s = tz_array_push(
            f->to->ctx, &f->way,
            tz_vec2_scale(tz_line_chain_point(f->g, c, end & 1, i)->at, f->side));
    for (int k = 0; k < 2 && s == TZ_OK; k++) {
        if (k == 1 && c->node[0] < 0)
            node[1] = node[0]; /* a loop */
        else
            s = node_at(f, c->node[(end & 1) ^ k], f->way.v[k ? c->n - 1 : 0], &node[k]);
    }
    if (s == TZ_OK) {
        const double window = f->side * fmax(4, 1.5 * c->width);
        s = tz_curve_fit(f->to, f->way.v, c->n, f->error, window, node);
    }
    return s == TZ_OK ? add_tapers(f, end, first) : s;
}

static tz_status add_path(fitting *f, int32_t start)
{
    int32_t first = start, at = start ^ 1;
    /* back to where it begins, or once around */
    while (f->next[first] >= 0 && (f->next[first] ^ 1) != start)
        first = f->next[first] ^ 1;
    tz_status s = tz_curve_begin(f->to, f->pen[first >> 1]);
    for (at = first; s == TZ_OK && at >= 0 && !f->seen[at >> 1]; at = f->next[at ^ 1]) {
        f->seen[at >> 1] = 1;
        s = add_chain(f, at);
    }
    if (s == TZ_OK)
        tz_curve_end(f->to, f->g->chain.v[first >> 1].node[0] < 0 || at == first);
    return s;
}

tz_status tz_line_fit(const tz_line_graph *g, const tz_line_picture *picture, double side,
                      double error, tz_curve_set *to)
{
    fitting f = {.g = g, .to = to, .side = side, .error = error};
    const size_t chains = (size_t)g->chain.n;
    tz_status s = tz_line_ends_init(g, &f.ends);
    if (s == TZ_OK)
        s = tz_alloc(g->ctx, &f.of, chains, sizeof *f.of);
    if (s == TZ_OK)
        s = tz_alloc(g->ctx, &f.pen, chains, sizeof *f.pen);
    if (s == TZ_OK)
        s = tz_alloc(g->ctx, &f.next, 2 * chains, sizeof *f.next);
    if (s == TZ_OK)
        s = tz_alloc(g->ctx, &f.node, (size_t)g->node.n, sizeof *f.node);
    if (s == TZ_OK)
        s = tz_alloc_zero(g->ctx, &f.seen, chains, 1);
    if (s == TZ_OK)
        s = choose_pens(&f, picture);
    if (s != TZ_OK)
        goto done;
    for (size_t i = 0; i < 2 * chains; i++)
        f.next[i] = -1;
    for (int32_t i = 0; i < g->node.n; i++) {
        f.node[i] = -1;
        pair_up(&f, i);
    }
    for (int32_t i = 0; i < g->chain.n && s == TZ_OK; i++)
        if (!f.seen[i])
            s = add_path(&f, 2 * i);
done:
    tz_line_ends_deinit(g, &f.ends);
    tz_free(g->ctx, f.of);
    tz_free(g->ctx, f.pen);
    tz_free(g->ctx, f.next);
    tz_free(g->ctx, f.node);
    tz_free(g->ctx, f.seen);
    tz_array_free(to->ctx, &f.way);
    return s;
}
