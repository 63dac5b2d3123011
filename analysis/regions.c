/* SPDX-License-Identifier: Apache-2.0 */
/* Agglomeration on the region adjacency graph. Arc (a, b) keeps the sum of responses along
 * the common border and its length; its cost is
 *
 *     cost = (B + w C) * size,     B = mean response of the border / full border,
 *     C = distance of the mean colours (relative to the picture's own spread),
 *     size = sqrt(harmonic mean of the areas / area of a thing)
 *
 * so that crumbs join before halves of things do, and things not at all. The cheapest arc
 * is merged first (binary heap; stale entries are recognised by their stamp); ties go by
 * the smaller ids. */
#include "analysis/regions.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"

#define COLOUR 0.25

typedef struct arc {
    int32_t to;
    int32_t length;  /* pixel pairs on the border */
    double sum;      /* of responses there */
    int32_t stamp;   /* of the heap entry that is current */
} arc;

typedef struct node {
    TZ_ARRAY(arc) arcs;
    double colour[3]; /* sums */
    int64_t area;
    int64_t perimeter;
    int32_t x0, y0, x1, y1;
    int32_t parent;   /* itself while it lives */
} node;

typedef struct entry {
    double cost;
    int32_t a, b, stamp; /* a < b */
} entry;

typedef struct graph {
    tz_ctx *ctx;
    const tz_region_options *opt;
    int32_t channels, n, alive, stamp;
    double spread; /* of the superpixels' colours */
    node *nodes;
    TZ_ARRAY(entry) heap;
} graph;

/* ---- building -------------------------------------------------------------------- */

typedef struct border {
    uint64_t pair; /* a << 32 | b, a < b */
    int32_t length;
    double sum;
} border;

typedef struct border_table {
    border *slot;
    uint64_t mask;
    int64_t used;
} border_table;

static border *find_slot(const border_table *t, uint64_t pair)
{
    uint64_t i = pair * 0x9E3779B97F4A7C15u >> 20 & t->mask;
    while (t->slot[i].length && t->slot[i].pair != pair) i = (i + 1) & t->mask;
    return &t->slot[i];
}

static tz_status grow_table(tz_ctx *ctx, border_table *t)
{
    border_table bigger = {.mask = t->slot ? 2 * t->mask + 1 : 4095, .used = t->used};
    tz_status s = tz_alloc_zero(ctx, &bigger.slot, (size_t)bigger.mask + 1, sizeof(border));
    if (s != TZ_OK) return s;
    for (uint64_t i = 0; t->slot && i <= t->mask; i++)
        if (t->slot[i].length) *find_slot(&bigger, t->slot[i].pair) = t->slot[i];
    tz_free(ctx, t->slot);
    *t = bigger;
    return TZ_OK;
}

static tz_status add_border(tz_ctx *ctx, border_table *t, int32_t a, int32_t b, float r)
{
    if (2 * t->used >= (int64_t)t->mask) {
        tz_status s = grow_table(ctx, t);
        if (s != TZ_OK) return s;
    }
    const uint64_t pair = a < b ? (uint64_t)a << 32 | (uint32_t)b : (uint64_t)b << 32 | (uint32_t)a;
    border *e = find_slot(t, pair);
    if (!e->length) {
        e->pair = pair;
        t->used++;
    }
    e->length++;
    e->sum += r;
    return TZ_OK;
}

static int by_pair(const void *p, const void *q)
{
    const uint64_t a = ((const border *)p)->pair, b = ((const border *)q)->pair;
    return a < b ? -1 : a > b;
}

static tz_status collect_borders(tz_ctx *ctx, const float *response, const int32_t *label,
                                 int32_t w, int32_t h, border_table *t)
{
    tz_status s = grow_table(ctx, t);
    for (int32_t y = 0; y < h && s == TZ_OK; y++) {
        const int32_t *l = label + (int64_t)y * w;
        const float *r = response + (int64_t)y * w;
        for (int32_t x = 0; x < w; x++) {
            if (x + 1 < w && l[x] != l[x + 1]) {
                s = add_border(ctx, t, l[x], l[x + 1], fmaxf(r[x], r[x + 1]));
                if (s != TZ_OK) break;
            }
            if (y + 1 < h && l[x] != l[x + w]) {
                s = add_border(ctx, t, l[x], l[x + w], fmaxf(r[x], r[x + w]));
                if (s != TZ_OK) break;
            }
        }
    }
    return s;
}

static tz_status build(graph *g, const float *response, const float *lab,
                       const int32_t *label, int32_t w, int32_t h)
{
    border_table t = {0};
    const size_t plane = (size_t)w * h;
    tz_status s;

    if ((s = tz_alloc_zero(g->ctx, &g->nodes, (size_t)g->n, sizeof(node))) != TZ_OK) goto done;
    for (int32_t i = 0; i < g->n; i++) {
        g->nodes[i].parent = i;
        g->nodes[i].x0 = w, g->nodes[i].y0 = h;
    }
    for (int32_t y = 0; y < h; y++) {
        for (int32_t x = 0; x < w; x++) {
            const size_t p = (size_t)y * w + x;
            node *v = &g->nodes[label[p]];
            v->area++;
            for (int32_t c = 0; c < g->channels; c++) v->colour[c] += lab[c * plane + p];
            if (x < v->x0) v->x0 = x;
            if (y < v->y0) v->y0 = y;
            if (x >= v->x1) v->x1 = x + 1;
            if (y >= v->y1) v->y1 = y + 1;
        }
    }
    if ((s = collect_borders(g->ctx, response, label, w, h, &t)) != TZ_OK) goto done;
    int64_t n = 0;
    for (uint64_t i = 0; i <= t.mask; i++)
        if (t.slot[i].length) t.slot[n++] = t.slot[i];
    qsort(t.slot, (size_t)n, sizeof *t.slot, by_pair);
    for (int64_t i = 0; i < n; i++) {
        const int32_t a = (int32_t)(t.slot[i].pair >> 32), b = (int32_t)t.slot[i].pair;
        arc to_b = {.to = b, .length = t.slot[i].length, .sum = t.slot[i].sum}, to_a = to_b;
        to_a.to = a;
        g->nodes[a].perimeter += to_b.length;
        g->nodes[b].perimeter += to_b.length;
        if ((s = tz_array_push(g->ctx, &g->nodes[a].arcs, to_b)) != TZ_OK) goto done;
        if ((s = tz_array_push(g->ctx, &g->nodes[b].arcs, to_a)) != TZ_OK) goto done;
    }
done:
    tz_free(g->ctx, t.slot);
    return s;
}

/* ---- heap ------------------------------------------------------------------------ */

static bool before(const entry *p, const entry *q)
{
    if (p->cost != q->cost) return p->cost < q->cost;
    if (p->a != q->a) return p->a < q->a;
    return p->b < q->b;
}

static tz_status heap_push(graph *g, entry e)
{
    tz_status s = tz_array_push(g->ctx, &g->heap, e);
    if (s != TZ_OK) return s;
    int32_t i = g->heap.n - 1;
    for (; i > 0 && before(&e, &g->heap.v[(i - 1) / 2]); i = (i - 1) / 2)
        g->heap.v[i] = g->heap.v[(i - 1) / 2];
    g->heap.v[i] = e;
    return TZ_OK;
}

static entry heap_pop(graph *g)
{
    const entry top = g->heap.v[0], e = g->heap.v[--g->heap.n];
    int32_t i = 0;
    for (;;) {
        int32_t c = 2 * i + 1;
        if (c >= g->heap.n) break;
        if (c + 1 < g->heap.n && before(&g->heap.v[c + 1], &g->heap.v[c])) c++;
        if (!before(&g->heap.v[c], &e)) break;
        g->heap.v[i] = g->heap.v[c];
        i = c;
    }
    if (g->heap.n > 0) g->heap.v[i] = e;
    return top;
}

/* ---- merging --------------------------------------------------------------------- */

static arc *find_arc(node *v, int32_t to)
{
    for (int32_t i = 0; i < v->arcs.n; i++)
        if (v->arcs.v[i].to == to) return &v->arcs.v[i];
    return NULL;
}

static double colour_distance(const graph *g, const node *a, const node *b)
{
    double sum = 0;
    for (int32_t c = 0; c < g->channels; c++) {
        const double d = a->colour[c] / (double)a->area - b->colour[c] / (double)b->area;
        sum += d * d;
    }
    return sqrt(sum);
}

static double arc_cost(const graph *g, int32_t i, int32_t j, const arc *e)
{
    const node *a = &g->nodes[i], *b = &g->nodes[j];
    const double border = g->opt->full > 0 ? e->sum / e->length / g->opt->full : 0;
    const double colour = g->spread > 0 ? colour_distance(g, a, b) / g->spread : 0;
    const double thing = 0.7 * g->opt->scale * g->opt->scale;
    const double areas = 2.0 * (double)a->area * (double)b->area / (double)(a->area + b->area);
    const double least = (double)(a->perimeter < b->perimeter ? a->perimeter : b->perimeter);
    const double contact = (double)e->length / least;
    return (border + COLOUR * colour) * pow(areas / thing, 0.5) / (0.25 + contact);
}

static bool too_long(const graph *g, const node *a, const node *b)
{
    const int32_t x0 = a->x0 < b->x0 ? a->x0 : b->x0, y0 = a->y0 < b->y0 ? a->y0 : b->y0;
    const int32_t x1 = a->x1 > b->x1 ? a->x1 : b->x1, y1 = a->y1 > b->y1 ? a->y1 : b->y1;
    return x1 - x0 > g->opt->longest || y1 - y0 > g->opt->longest;
}

/* Puts the arc between i and j into the heap, as it is now. */
static tz_status queue(graph *g, int32_t i, int32_t j)
{
    arc *p = find_arc(&g->nodes[i], j), *q = find_arc(&g->nodes[j], i);
    p->stamp = q->stamp = ++g->stamp;
    const int32_t a = i < j ? i : j, b = i < j ? j : i;
    return heap_push(g, (entry){arc_cost(g, a, b, p), a, b, g->stamp});
}

/* b goes into a; the arcs of a are queued anew. */
static tz_status unite(graph *g, int32_t a, int32_t b)
{
    node *p = &g->nodes[a], *q = &g->nodes[b];
    tz_status s = TZ_OK;

    const int32_t shared = find_arc(p, b)->length;
    for (int32_t i = 0; i < q->arcs.n; i++) {
        const arc e = q->arcs.v[i];
        node *t = &g->nodes[e.to];
        arc *back = find_arc(t, b);
        if (e.to == a) {
            *back = t->arcs.v[--t->arcs.n];
            continue;
        }
        arc *own = find_arc(p, e.to);
        if (own) {
            own->length += e.length;
            own->sum += e.sum;
            *back = t->arcs.v[--t->arcs.n];
            arc *there = find_arc(t, a);
            there->length = own->length;
            there->sum = own->sum;
        } else {
            if ((s = tz_array_push(g->ctx, &p->arcs, e)) != TZ_OK) return s;
            back->to = a;
        }
    }
    tz_array_free(g->ctx, &q->arcs);
    for (int32_t c = 0; c < 3; c++) p->colour[c] += q->colour[c];
    p->area += q->area;
    p->perimeter += q->perimeter - 2 * shared;
    if (q->x0 < p->x0) p->x0 = q->x0;
    if (q->y0 < p->y0) p->y0 = q->y0;
    if (q->x1 > p->x1) p->x1 = q->x1;
    if (q->y1 > p->y1) p->y1 = q->y1;
    q->parent = a;
    g->alive--;
    for (int32_t i = 0; i < p->arcs.n && s == TZ_OK; i++) s = queue(g, a, p->arcs.v[i].to);
    return s;
}

/* Spread of the superpixels' mean colours, rms. */
static double colour_spread(const graph *g)
{
    double sum[3] = {0}, square = 0, n = 0, mean = 0;
    for (int32_t i = 0; i < g->n; i++) {
        for (int32_t c = 0; c < g->channels; c++) {
            const double v = g->nodes[i].colour[c] / (double)g->nodes[i].area;
            sum[c] += v;
            square += v * v;
        }
        n++;
    }
    for (int32_t c = 0; c < g->channels; c++) mean += (sum[c] / n) * (sum[c] / n);
    return sqrt(fmax(0, square / n - mean));
}

static tz_status merge_cheapest(graph *g)
{
    const int32_t wanted = g->opt->wanted > 0 ? g->opt->wanted : 1;
    const double limit = g->opt->wanted > 0 ? INFINITY : g->opt->merge;
    tz_status s = TZ_OK;
    while (g->heap.n > 0 && g->alive > wanted) {
        const entry e = heap_pop(g);
        if (g->nodes[e.a].parent != e.a || g->nodes[e.b].parent != e.b) continue;
        const arc *p = find_arc(&g->nodes[e.a], e.b);
        if (!p || p->stamp != e.stamp) continue;
        if (e.cost > limit) break;
        if (too_long(g, &g->nodes[e.a], &g->nodes[e.b])) continue;
        if ((s = unite(g, e.a, e.b)) != TZ_OK) break;
        if ((g->alive & 255) == 0 && tz_ctx_cancelled(g->ctx)) return TZ_CANCELLED;
    }
    return s;
}

/* Crumbs join the neighbour that costs least. */
static tz_status merge_crumbs(graph *g)
{
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < g->n; i++) {
        node *v = &g->nodes[i];
        while (v->parent == i && v->area < g->opt->least && v->arcs.n > 0) {
            double best = INFINITY;
            int32_t to = -1;
            for (int32_t k = 0; k < v->arcs.n; k++) {
                const double cost = arc_cost(g, i, v->arcs.v[k].to, &v->arcs.v[k]);
                if (cost < best || (cost == best && v->arcs.v[k].to < to))
                    best = cost, to = v->arcs.v[k].to;
            }
            g->heap.n = 0; /* costs are read off directly here */
            if ((s = unite(g, to, i)) != TZ_OK) return s;
        }
    }
    return s;
}

static int32_t root(graph *g, int32_t i)
{
    while (g->nodes[i].parent != i) i = g->nodes[i].parent;
    return i;
}

tz_status tz_regions_merge(tz_ctx *ctx, const float *response, const float *lab,
                           int32_t channels, int32_t width, int32_t height,
                           const tz_region_options *opt, int32_t *label, int32_t *count)
{
    graph g = {.ctx = ctx, .opt = opt, .channels = channels, .n = *count, .alive = *count};
    int32_t *fresh = NULL, next = 0;
    tz_status s;

    if ((s = tz_alloc(ctx, &fresh, (size_t)g.n, sizeof *fresh)) != TZ_OK) goto done;
    if ((s = build(&g, response, lab, label, width, height)) != TZ_OK) goto done;
    g.spread = colour_spread(&g);
    for (int32_t i = 0; i < g.n; i++)
        for (int32_t k = 0; k < g.nodes[i].arcs.n; k++)
            if (g.nodes[i].arcs.v[k].to > i &&
                (s = queue(&g, i, g.nodes[i].arcs.v[k].to)) != TZ_OK)
                goto done;
    if (opt->merge > 0 && (s = merge_cheapest(&g)) != TZ_OK) goto done;
    if ((s = merge_crumbs(&g)) != TZ_OK) goto done;
    for (int32_t i = 0; i < g.n; i++) fresh[i] = -1;
    const int64_t n = (int64_t)width * height;
    for (int64_t p = 0, last = -1; p < n; p++) {
        (void)last;
        const int32_t r = root(&g, label[p]);
        if (fresh[r] < 0) fresh[r] = next++;
        label[p] = fresh[r];
    }
    *count = next;
done:
    for (int32_t i = 0; g.nodes && i < g.n; i++) tz_array_free(ctx, &g.nodes[i].arcs);
    tz_free(ctx, g.nodes);
    tz_array_free(ctx, &g.heap);
    tz_free(ctx, fresh);
    return s;
}
