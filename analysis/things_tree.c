/* SPDX-License-Identifier: Apache-2.0 */
/* Agglomeration on the adjacency graph of superpixels. An arc keeps, along the common
 * border, its length, the sums of edge and lightness and a histogram of edge:
 *
 *     strength = B + 0.3 V + 0.3 C
 *     B  mean edge along the border
 *     V  how much darker or lighter than both sides the border is (a joint, a crack)
 *     C  distance of the mean colours          (V, C: in spreads of the leaves' colours)
 *
 *     cost = strength^1.5 size / (contact + 1/4),
 *     size = (harmonic mean of the areas)^(1/4)
 *     contact = length of the border / shorter perimeter
 *
 * so that crumbs join before halves of things do. The cheapest arc is taken first; a
 * binary heap holds a lower bound of each arc's cost, and what comes out is judged anew:
 * the cost of an arc changes whenever one of its regions grows, and only the arcs of the
 * smaller one are touched then (small to large: n log n in all). */
#include "analysis/things_tree.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/superpixel.h"
#include "analysis/things_hull.h"

typedef struct arc {
    int32_t a, b; /* representatives of its regions; a < 0: joined with another arc */
    int32_t length;
    int32_t bin[TZ_THINGS_BINS];
    float edge, light; /* sums */
} arc;

typedef struct region {
    TZ_ARRAY(int32_t)
    arcs;         /* ids; may hold dead ones */
    int32_t node; /* that it is now */
} region;

typedef struct entry {
    float cost;
    int32_t arc;
} entry;

typedef struct graph {
    tz_ctx *ctx;
    const tz_things_picture *in;
    tz_things_tree *t;
    int32_t *table; /* open addressing by pair of regions: arc id + 1 */
    uint64_t mask, used;
    TZ_ARRAY(arc)
    arc;
    region *region; /* a leaf */
    TZ_ARRAY(entry)
    heap;
    tz_hulls hulls;
} graph;

/* ---- arcs by pair -------------------------------------------------------------------- */

static uint64_t slot_of(const graph *g, int32_t a, int32_t b)
{
    const uint64_t pair =
        a < b ? (uint64_t)a << 32 | (uint32_t)b : (uint64_t)b << 32 | (uint32_t)a;
    return (pair * 0x9E3779B97F4A7C15u >> 20) & g->mask;
}

static bool joins(const arc *e, int32_t a, int32_t b)
{
    return (e->a == a && e->b == b) || (e->a == b && e->b == a);
}

/* Slot of the arc between a and b, or the free one where it would stand. */
static int32_t *find(const graph *g, int32_t a, int32_t b)
{
    uint64_t i = slot_of(g, a, b);
    while (g->table[i] && !joins(&g->arc.v[g->table[i] - 1], a, b))
        i = (i + 1) & g->mask;
    return &g->table[i];
}

/* Arcs that changed hands leave their old slots behind as tombs: an arc found there no
 * longer joins the pair that is asked for. The table is made anew when it is half full. */
static tz_status make_table(graph *g)
{
    int32_t *table = NULL;
    uint64_t live = 0, size = 4096;
    for (int32_t i = 0; i < g->arc.n; i++)
        live += g->arc.v[i].a >= 0;
    while (size < 4 * live)
        size *= 2;
    const tz_status s = tz_alloc_zero(g->ctx, &table, size, sizeof *table);
    if (s != TZ_OK)
        return s;
    tz_free(g->ctx, g->table);
    g->table = table;
    g->mask = size - 1;
    g->used = live;
    for (int32_t i = 0; i < g->arc.n; i++)
        if (g->arc.v[i].a >= 0)
            *find(g, g->arc.v[i].a, g->arc.v[i].b) = i + 1;
    return TZ_OK;
}

static tz_status enter(graph *g, int32_t *slot, int32_t id)
{
    *slot = id + 1;
    return 2 * ++g->used > g->mask ? make_table(g) : TZ_OK;
}

static int32_t bin_of(float edge)
{
    return edge < 0.1F ? 0 : edge < 0.25F ? 1 : edge < 0.5F ? 2 : 3;
}

static tz_status add_pair(graph *g, int32_t a, int32_t b, float edge, float light)
{
    int32_t *slot = find(g, a, b);
    if (!*slot) {
        const arc fresh = {.a = a < b ? a : b, .b = a < b ? b : a};
        tz_status s = tz_array_push(g->ctx, &g->arc, fresh);
        if (s != TZ_OK)
            return s;
        if ((s = enter(g, slot, g->arc.n - 1)) != TZ_OK)
            return s;
        slot = find(g, a, b);
    }
    assert(g->arc.v && *slot > 0);
    arc *e = &g->arc.v[*slot - 1];
    e->length++;
    e->edge += edge;
    e->light += light;
    e->bin[bin_of(edge)]++;
    return TZ_OK;
}

/* ---- leaves -------------------------------------------------------------------------- */

static void add_pixel(const tz_things_picture *in, tz_things_node *v, int32_t x,
                      int32_t y)
{
    const size_t plane = (size_t)in->width * (size_t)in->height;
    const size_t p = (size_t)y * (size_t)in->width + (size_t)x;
    const double cx = x + 0.5, cy = y + 0.5;
    v->area++;
    for (int32_t c = 0; c < in->channels; c++) {
        const double q = in->lab[(size_t)c * plane + p];
        v->colour[c] += q;
        v->colour2 += q * q;
    }
    v->inner += in->edge[p];
    v->x += cx, v->y += cy;
    v->xx += cx * cx, v->xy += cx * cy, v->yy += cy * cy;
    v->frame += (x == 0) + (y == 0) + (x + 1 == in->width) + (y + 1 == in->height);
    v->x0 = x < v->x0 ? x : v->x0;
    v->y0 = y < v->y0 ? y : v->y0;
    v->x1 = x >= v->x1 ? x + 1 : v->x1;
    v->y1 = y >= v->y1 ? y + 1 : v->y1;
}

static tz_status measure_leaves(graph *g)
{
    const tz_things_picture *in = g->in;
    const int32_t w = in->width, h = in->height, *leaf = g->t->leaf;
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < g->t->leaves; i++)
        g->t->node[i] =
            (tz_things_node){.child = {-1, -1}, .parent = -1, .x0 = w, .y0 = h};
    for (int32_t y = 0; y < h; y++)
        for (int32_t x = 0; x < w; x++)
            add_pixel(in, &g->t->node[leaf[(size_t)y * (size_t)w + (size_t)x]], x, y);
    for (int32_t y = 0; y < h; y++)
        for (int32_t x = 0; x < w; x++)
            for (int32_t k = 0; k < 2; k++) {
                const size_t p = (size_t)y * (size_t)w + (size_t)x;
                if (k == 0 ? x + 1 == w : y + 1 == h)
                    continue;
                const size_t q = p + (k == 0 ? 1 : (size_t)w);
                if (leaf[p] == leaf[q])
                    continue;
                s = add_pair(g, leaf[p], leaf[q], fmaxf(in->edge[p], in->edge[q]),
                             0.5F * (in->lab[p] + in->lab[q]));
                if (s != TZ_OK)
                    return s;
            }
    return s;
}

static void share_outline(tz_things_node *v, const arc *e)
{
    v->perimeter += e->length;
    v->edge += e->edge;
    v->light += e->light;
    for (int32_t k = 0; k < TZ_THINGS_BINS; k++)
        v->bin[k] += e->bin[k];
}

/* Root mean square distance of neighbours' mean colours from their common mean: what a
 * difference of colour is worth in this picture. */
static double colour_spread(const tz_things_tree *t)
{
    double sum[3] = {0}, square = 0, area = 0;
    for (int32_t i = 0; i < t->leaves; i++) {
        const tz_things_node *v = &t->node[i];
        for (int32_t c = 0; c < 3; c++) {
            sum[c] += v->colour[c];
            square += v->colour[c] * v->colour[c] / v->area;
        }
        area += v->area;
    }
    for (int32_t c = 0; c < 3; c++)
        square -= sum[c] * sum[c] / area;
    return fmax(sqrt(fmax(square, 0) / area), 1);
}

/* ---- costs --------------------------------------------------------------------------- */

static double strength(const graph *g, const arc *e)
{
    const tz_things_node *a = &g->t->node[g->region[e->a].node];
    const tz_things_node *b = &g->t->node[g->region[e->b].node];
    const double light = e->light / e->length, la = a->colour[0] / a->area,
                 lb = b->colour[0] / b->area;
    double square = 0;
    for (int32_t c = 0; c < 3; c++) {
        const double d = a->colour[c] / a->area - b->colour[c] / b->area;
        square += d * d;
    }
    const double valley = fmax(fmin(la, lb) - light, light - fmax(la, lb));
    return e->edge / e->length + 0.3 * fmin(fmax(valley, 0) / g->t->spread, 1.5) +
           0.3 * fmin(sqrt(square) / g->t->spread, 1.5);
}

static float cost_of(const graph *g, const arc *e)
{
    const tz_things_node *a = &g->t->node[g->region[e->a].node];
    const tz_things_node *b = &g->t->node[g->region[e->b].node];
    const double s = strength(g, e), size = 2 * a->area * b->area / (a->area + b->area);
    const double contact = e->length / fmin(a->perimeter, b->perimeter);
    return (float)(s * sqrt(s) * sqrt(sqrt(size)) / (contact + 0.25));
}

/* ---- heap ---------------------------------------------------------------------------- */

static bool before(entry p, entry q)
{
    return p.cost < q.cost || (p.cost == q.cost && p.arc < q.arc);
}

static tz_status push(graph *g, entry e)
{
    const tz_status s = tz_array_push(g->ctx, &g->heap, e);
    if (s != TZ_OK)
        return s;
    int32_t i = g->heap.n - 1;
    for (; i > 0 && before(e, g->heap.v[(i - 1) / 2]); i = (i - 1) / 2)
        g->heap.v[i] = g->heap.v[(i - 1) / 2];
    g->heap.v[i] = e;
    return TZ_OK;
}

static void sink(graph *g, int32_t i)
{
    const entry e = g->heap.v[i];
    for (;;) {
        int32_t c = 2 * i + 1;
        if (c >= g->heap.n)
            break;
        if (c + 1 < g->heap.n && before(g->heap.v[c + 1], g->heap.v[c]))
            c++;
        if (!before(g->heap.v[c], e))
            break;
        g->heap.v[i] = g->heap.v[c];
        i = c;
    }
    g->heap.v[i] = e;
}

static void drop_top(graph *g)
{
    g->heap.v[0] = g->heap.v[--g->heap.n];
    if (g->heap.n > 0)
        sink(g, 0);
}

/* ---- joining ------------------------------------------------------------------------- */

static void add_sums(tz_things_node *v, const tz_things_node *a, const tz_things_node *b)
{
    v->area = a->area + b->area;
    for (int32_t c = 0; c < 3; c++)
        v->colour[c] = a->colour[c] + b->colour[c];
    v->colour2 = a->colour2 + b->colour2;
    v->inner = a->inner + b->inner;
    v->x = a->x + b->x, v->y = a->y + b->y;
    v->xx = a->xx + b->xx, v->xy = a->xy + b->xy, v->yy = a->yy + b->yy;
    v->frame = a->frame + b->frame;
    v->x0 = a->x0 < b->x0 ? a->x0 : b->x0, v->y0 = a->y0 < b->y0 ? a->y0 : b->y0;
    v->x1 = a->x1 > b->x1 ? a->x1 : b->x1, v->y1 = a->y1 > b->y1 ? a->y1 : b->y1;
}

/* The outline of a union: both outlines less twice what lies between them. */
static void join_outlines(tz_things_node *v, const tz_things_node *a,
                          const tz_things_node *b, const arc *e)
{
    v->perimeter = a->perimeter + b->perimeter - 2.0 * e->length;
    v->edge = a->edge + b->edge - 2.0 * e->edge;
    v->light = a->light + b->light - 2.0 * e->light;
    for (int32_t k = 0; k < TZ_THINGS_BINS; k++)
        v->bin[k] = a->bin[k] + b->bin[k] - 2 * e->bin[k];
}

/* Hands the arcs of region `from` to region `to`; arcs to a common neighbour become one.
 * All arcs that are touched are judged again. */
static tz_status hand_over(graph *g, int32_t from, int32_t to)
{
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < g->region[from].arcs.n && s == TZ_OK; i++) {
        int32_t id = g->region[from].arcs.v[i];
        arc *e = &g->arc.v[id];
        if (e->a < 0 || joins(e, from, to))
            continue;
        const int32_t other = e->a == from ? e->b : e->a;
        int32_t *slot = find(g, to, other);
        if (*slot) {
            arc *kept = &g->arc.v[*slot - 1];
            kept->length += e->length;
            kept->edge += e->edge;
            kept->light += e->light;
            for (int32_t k = 0; k < TZ_THINGS_BINS; k++)
                kept->bin[k] += e->bin[k];
            e->a = e->b = -1;
            id = *slot - 1;
        } else {
            e->a = to < other ? to : other;
            e->b = to < other ? other : to;
            s = enter(g, slot, id);
            if (s == TZ_OK)
                s = tz_array_push(g->ctx, &g->region[to].arcs, id);
        }
        if (s == TZ_OK)
            s = push(g, (entry){cost_of(g, &g->arc.v[id]), id});
    }
    tz_array_free(g->ctx, &g->region[from].arcs);
    return s;
}

static tz_status join(graph *g, int32_t id)
{
    arc e = g->arc.v[id];
    const double level = strength(g, &e);
    int32_t to = e.a, from = e.b;
    tz_things_tree *t = g->t;
    if (g->region[from].arcs.n > g->region[to].arcs.n)
        to = e.b, from = e.a;
    tz_things_node *a = &t->node[g->region[to].node], *b = &t->node[g->region[from].node];
    tz_things_node *v = &t->node[t->n];
    *v = (tz_things_node){.child = {g->region[to].node, g->region[from].node},
                          .parent = -1,
                          .level = level};
    a->parent = b->parent = t->n;
    add_sums(v, a, b);
    join_outlines(v, a, b, &e);
    v->strongest = fmax(level, fmax(a->strongest, b->strongest));
    const tz_status s = tz_hulls_join(g->ctx, &g->hulls, v->child[0], v->child[1], t->n,
                                      v->area, &v->hull);
    if (s != TZ_OK)
        return s;
    g->region[to].node = t->n++;
    g->arc.v[id].a = g->arc.v[id].b = -1;
    return hand_over(g, from, to);
}

static tz_status join_all(graph *g)
{
    tz_status s = TZ_OK;
    while (g->heap.n > 0 && s == TZ_OK) {
        const entry top = g->heap.v[0];
        arc *e = &g->arc.v[top.arc];
        if (e->a < 0) {
            drop_top(g);
            continue;
        }
        const float now = cost_of(g, e);
        if (now > top.cost * 1.0001F) {
            g->heap.v[0].cost = now;
            sink(g, 0);
            continue;
        }
        drop_top(g);
        s = join(g, top.arc);
        if (s == TZ_OK && (g->t->n & 1023) == 0) {
            if (tz_ctx_cancelled(g->ctx))
                s = TZ_CANCELLED;
        }
    }
    return s;
}

/* ---- driver -------------------------------------------------------------------------- */

static tz_status open_graph(graph *g, double largest)
{
    tz_things_tree *t = g->t;
    tz_status s = make_table(g);
    if (s == TZ_OK)
        s = measure_leaves(g);
    if (s == TZ_OK)
        s = tz_alloc_zero(g->ctx, &g->region, (size_t)t->leaves, sizeof *g->region);
    if (s == TZ_OK)
        s = tz_hulls_init(g->ctx, &g->hulls, t->leaf, g->in->width, g->in->height,
                          t->leaves, largest);
    for (int32_t i = 0; i < t->leaves && s == TZ_OK; i++) {
        g->region[i].node = i;
        t->node[i].hull = tz_hulls_area(&g->hulls, i);
    }
    for (int32_t i = 0; i < g->arc.n && s == TZ_OK; i++) {
        arc *e = &g->arc.v[i];
        share_outline(&t->node[e->a], e);
        share_outline(&t->node[e->b], e);
        s = tz_array_push(g->ctx, &g->region[e->a].arcs, i);
        if (s == TZ_OK)
            s = tz_array_push(g->ctx, &g->region[e->b].arcs, i);
    }
    t->spread = s == TZ_OK ? colour_spread(t) : 1;
    for (int32_t i = 0; i < g->arc.n && s == TZ_OK; i++)
        s = push(g, (entry){cost_of(g, &g->arc.v[i]), i});
    return s;
}

static void close_graph(graph *g)
{
    for (int32_t i = 0; g->region && i < g->t->leaves; i++)
        tz_array_free(g->ctx, &g->region[i].arcs);
    tz_free(g->ctx, g->region);
    tz_free(g->ctx, g->table);
    tz_array_free(g->ctx, &g->arc);
    tz_array_free(g->ctx, &g->heap);
    tz_hulls_deinit(g->ctx, &g->hulls);
}

tz_status tz_things_tree_grow(tz_ctx *ctx, const tz_things_picture *in, double step,
                              double largest, tz_things_tree *t)
{
    const size_t n = (size_t)in->width * (size_t)in->height;
    graph g = {.ctx = ctx, .in = in, .t = t};
    *t = (tz_things_tree){.ctx = ctx};
    tz_status s = tz_alloc(ctx, &t->leaf, n, sizeof *t->leaf);
    if (s == TZ_OK)
        s = tz_superpixels(ctx, in->edge, in->width, in->height, 1, step, t->leaf,
                           &t->leaves);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &t->node, 2 * (size_t)t->leaves, sizeof *t->node);
    if (s == TZ_OK) {
        t->n = t->leaves;
        s = open_graph(&g, largest);
    }
    if (s == TZ_OK)
        s = join_all(&g);
    close_graph(&g);
    if (s != TZ_OK)
        tz_things_tree_deinit(t);
    return s;
}

void tz_things_tree_deinit(tz_things_tree *t)
{
    tz_free(t->ctx, t->node);
    tz_free(t->ctx, t->leaf);
    *t = (tz_things_tree){0};
}
