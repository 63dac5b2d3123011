/* SPDX-License-Identifier: Apache-2.0 */
/* Agglomeration on the region adjacency graph. Arc (a, b) keeps, along the common border,
 * its length and the sums of response and lightness:
 *
 *     strength = 0.8 (B + V) + 0.3 C
 *     B  mean response / full border, each pixel counted as a full border at most: the
 * ends of a border lie in the strong borders that it runs into V  how much darker or
 * lighter than both sides the border is (a joint, a crack) C  distance of the mean
 * colours       (V, C: in spreads of the picture's own colours)
 *
 *     cost = strength^1.5 size / (contact + 1/4),
 *     size = (harmonic mean of the areas / area of a thing)^(1/4)
 *     contact = length of the border / shorter perimeter
 *
 * so that crumbs join before halves of things do, along long borders before along short
 * ones. The cheapest arc is merged first (binary heap; stale entries are recognised by
 * their regions' versions); ties go by the smaller ids. When as many regions are left as
 * the scale of the structure asks for, only borders that are hardly there are still
 * removed.
 *
 * Then joints are dissolved (joints.c): each stone gets its half of the mortar. */
#include "analysis/regions.h"

#include <math.h>
#include <stdlib.h>

#include "analysis/joints.h"
#include "base/array.h"

#define WEAK   0.8 /* times merge: a border that is hardly there */
#define STRONG 2.4 /* times merge: a border that is never removed */

typedef struct arc {
    int32_t to;
    int32_t length; /* pixel pairs on the border */
    double sum;     /* of responses there */
    double light;   /* of lightness there */
} arc;

typedef struct node {
    TZ_ARRAY(arc)
    arcs;
    double colour[3]; /* sums */
    int64_t area;
    int64_t perimeter;
    int32_t x0, y0, x1, y1;
    int32_t parent;  /* itself while it lives */
    int32_t version; /* number of unions so far */
} node;

typedef struct entry {
    double cost, strength;
    int32_t a, b; /* a < b */
    int32_t version_a, version_b;
} entry;

typedef struct graph {
    tz_ctx *ctx;
    const tz_region_options *opt;
    int32_t channels, n, alive;
    double limit;  /* arcs stronger than this are never queued */
    double spread; /* of the superpixels' colours */
    node *nodes;
    TZ_ARRAY(entry)
    heap;
} graph;

/* ---- building -------------------------------------------------------------------- */

typedef struct border {
    uint64_t pair; /* a << 32 | b, a < b */
    int32_t length;
    double sum, light;
} border;

typedef struct border_table {
    border *slot;
    uint64_t mask;
    int64_t used;
} border_table;

static border *find_slot(const border_table *t, uint64_t pair)
{
    uint64_t i = pair * 0x9E3779B97F4A7C15u >> 20 & t->mask;
    while (t->slot[i].length && t->slot[i].pair != pair)
        i = (i + 1) & t->mask;
    return &t->slot[i];
}

static tz_status grow_table(tz_ctx *ctx, border_table *t)
{
    border_table bigger = {.mask = t->slot ? 2 * t->mask + 1 : 4095, .used = t->used};
    tz_status s =
        tz_alloc_zero(ctx, &bigger.slot, (size_t)bigger.mask + 1, sizeof(border));
    if (s != TZ_OK)
        return s;
    for (uint64_t i = 0; t->slot && i <= t->mask; i++)
        if (t->slot[i].length)
            *find_slot(&bigger, t->slot[i].pair) = t->slot[i];
    tz_free(ctx, t->slot);
    *t = bigger;
    return TZ_OK;
}

static tz_status add_border(tz_ctx *ctx, border_table *t, int32_t a, int32_t b, float r,
                            float light)
{
    if (2 * t->used >= (int64_t)t->mask) {
        tz_status s = grow_table(ctx, t);
        if (s != TZ_OK)
            return s;
    }
    const uint64_t pair =
        a < b ? (uint64_t)a << 32 | (uint32_t)b : (uint64_t)b << 32 | (uint32_t)a;
    border *e = find_slot(t, pair);
    if (!e->length) {
        e->pair = pair;
        t->used++;
    }
    e->length++;
    e->sum += r;
    e->light += light;
    return TZ_OK;
}

static int by_pair(const void *p, const void *q)
{
    const uint64_t a = ((const border *)p)->pair, b = ((const border *)q)->pair;
    return a < b ? -1 : a > b;
}

static tz_status collect_borders(const graph *g, const tz_region_picture *in,
                                 const int32_t *label, border_table *t)
{
    const int32_t w = in->width, step[2] = {1, w};
    const float full = (float)g->opt->full;
    tz_status s = grow_table(g->ctx, t);
    for (int32_t y = 0; y < in->height && s == TZ_OK; y++) {
        for (int32_t x = 0; x < w && s == TZ_OK; x++) {
            const int64_t p = (int64_t)y * w + x;
            for (int32_t k = 0; k < 2 && s == TZ_OK; k++) {
                if (k == 0 ? x + 1 == w : y + 1 == in->height)
                    continue;
                const int64_t q = p + step[k];
                if (label[p] == label[q])
                    continue;
                const float r = fmaxf(in->response[p], in->response[q]);
                s = add_border(g->ctx, t, label[p], label[q], r < full ? r : full,
                               0.5f * (in->lab[p] + in->lab[q]));
            }
        }
    }
    return s;
}

static tz_status build(graph *g, const tz_region_picture *in, const int32_t *label)
{
    const int32_t w = in->width, h = in->height;
    const size_t plane = (size_t)w * h;
    border_table t = {0};
    tz_status s;

    if ((s = tz_alloc_zero(g->ctx, &g->nodes, (size_t)g->n, sizeof(node))) != TZ_OK)
        goto done;
    for (int32_t i = 0; i < g->n; i++) {
        g->nodes[i].parent = i;
        g->nodes[i].x0 = w, g->nodes[i].y0 = h;
    }
    for (int32_t y = 0; y < h; y++) {
        for (int32_t x = 0; x < w; x++) {
            const size_t p = (size_t)y * w + x;
            node *v = &g->nodes[label[p]];
            v->area++;
            for (int32_t c = 0; c < in->channels; c++)
                v->colour[c] += in->lab[c * plane + p];
            if (x < v->x0)
                v->x0 = x;
            if (y < v->y0)
                v->y0 = y;
            if (x >= v->x1)
                v->x1 = x + 1;
            if (y >= v->y1)
                v->y1 = y + 1;
        }
    }
    if ((s = collect_borders(g, in, label, &t)) != TZ_OK)
        goto done;
    int64_t n = 0;
    for (uint64_t i = 0; i <= t.mask; i++)
        if (t.slot[i].length)
            t.slot[n++] = t.slot[i];
    qsort(t.slot, (size_t)n, sizeof *t.slot, by_pair);
    for (int64_t i = 0; i < n; i++) {
        const int32_t a = (int32_t)(t.slot[i].pair >> 32), b = (int32_t)t.slot[i].pair;
        arc to_b = {b, t.slot[i].length, t.slot[i].sum, t.slot[i].light}, to_a = to_b;
        to_a.to = a;
        g->nodes[a].perimeter += to_b.length;
        g->nodes[b].perimeter += to_b.length;
        if ((s = tz_array_push(g->ctx, &g->nodes[a].arcs, to_b)) != TZ_OK)
            goto done;
        if ((s = tz_array_push(g->ctx, &g->nodes[b].arcs, to_a)) != TZ_OK)
            goto done;
    }
done:
    tz_free(g->ctx, t.slot);
    return s;
}

/* ---- heap ------------------------------------------------------------------------ */

static bool before(const entry *p, const entry *q)
{
    if (p->cost != q->cost)
        return p->cost < q->cost;
    if (p->a != q->a)
        return p->a < q->a;
    return p->b < q->b;
}

static tz_status heap_push(graph *g, entry e)
{
    tz_status s = tz_array_push(g->ctx, &g->heap, e);
    if (s != TZ_OK)
        return s;
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
        if (c >= g->heap.n)
            break;
        if (c + 1 < g->heap.n && before(&g->heap.v[c + 1], &g->heap.v[c]))
            c++;
        if (!before(&g->heap.v[c], &e))
            break;
        g->heap.v[i] = g->heap.v[c];
        i = c;
    }
    if (g->heap.n > 0)
        g->heap.v[i] = e;
    return top;
}

/* ---- merging --------------------------------------------------------------------- */

static arc *find_arc(node *v, int32_t to)
{
    for (int32_t i = 0; i < v->arcs.n; i++)
        if (v->arcs.v[i].to == to)
            return &v->arcs.v[i];
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

static double strength(const graph *g, const node *a, const node *b, const arc *e)
{
    const double full = g->opt->full, spread = g->spread;
    const double border = full > 0 ? e->sum / e->length / full : 0;
    if (spread <= 0)
        return 0.8 * border;
    const double la = a->colour[0] / (double)a->area, lb = b->colour[0] / (double)b->area;
    const double light = e->light / e->length;
    const double line = fmax(0, fmax(fmin(la, lb) - light, light - fmax(la, lb)));
    return 0.8 * (border + line / spread) + 0.3 * colour_distance(g, a, b) / spread;
}

static double arc_cost(const graph *g, const node *a, const node *b, const arc *e,
                       double s)
{
    const double thing = 0.75 * g->opt->scale * g->opt->scale;
    const double areas =
        2.0 * (double)a->area * (double)b->area / (double)(a->area + b->area);
    const double least =
        (double)(a->perimeter < b->perimeter ? a->perimeter : b->perimeter);
    return s * sqrt(s) * sqrt(sqrt(areas / thing)) / (0.25 + e->length / least);
}

static bool too_long(const graph *g, const node *a, const node *b)
{
    const int32_t x0 = a->x0 < b->x0 ? a->x0 : b->x0, y0 = a->y0 < b->y0 ? a->y0 : b->y0;
    const int32_t x1 = a->x1 > b->x1 ? a->x1 : b->x1, y1 = a->y1 > b->y1 ? a->y1 : b->y1;
    return x1 - x0 > g->opt->longest || y1 - y0 > g->opt->longest;
}

/* Puts an arc of i into the heap, as it is now. */
static tz_status queue(graph *g, int32_t i, const arc *e)
{
    const int32_t a = i < e->to ? i : e->to, b = i < e->to ? e->to : i;
    const node *p = &g->nodes[a], *q = &g->nodes[b];
    const double s = strength(g, p, q, e);
    if (s > g->limit || too_long(g, p, q))
        return TZ_OK; /* unions only make it longer */
    const double cost = arc_cost(g, p, q, e, s);
    return heap_push(g, (entry){cost, s, a, b, p->version, q->version});
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
            own->light += e.light;
            *back = t->arcs.v[--t->arcs.n];
            arc *there = find_arc(t, a);
            there->length = own->length;
            there->sum = own->sum;
            there->light = own->light;
        } else {
            if ((s = tz_array_push(g->ctx, &p->arcs, e)) != TZ_OK)
                return s;
            back->to = a;
        }
    }
    tz_array_free(g->ctx, &q->arcs);
    for (int32_t c = 0; c < 3; c++)
        p->colour[c] += q->colour[c];
    p->area += q->area;
    p->perimeter += q->perimeter - 2 * shared;
    if (q->x0 < p->x0)
        p->x0 = q->x0;
    if (q->y0 < p->y0)
        p->y0 = q->y0;
    if (q->x1 > p->x1)
        p->x1 = q->x1;
    if (q->y1 > p->y1)
        p->y1 = q->y1;
    q->parent = a;
    p->version++;
    g->alive--;
    for (int32_t i = 0; i < p->arcs.n && s == TZ_OK; i++)
        s = queue(g, a, &p->arcs.v[i]);
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
    for (int32_t c = 0; c < g->channels; c++)
        mean += (sum[c] / n) * (sum[c] / n);
    return sqrt(fmax(0, square / n - mean));
}

/* Down to `wanted` regions, and if `further`, on over borders that are hardly there. */
static tz_status merge_cheapest(graph *g, int64_t wanted, bool further)
{
    tz_status s = TZ_OK;
    while (g->heap.n > 0 && (further || g->alive > wanted)) {
        const entry e = heap_pop(g);
        const node *a = &g->nodes[e.a], *b = &g->nodes[e.b];
        if (a->parent != e.a || b->parent != e.b)
            continue;
        if (a->version != e.version_a || b->version != e.version_b)
            continue;
        if (g->alive <= wanted && e.strength > WEAK * g->opt->merge)
            continue;
        if ((s = unite(g, e.a, e.b)) != TZ_OK)
            break;
        if ((g->alive & 255) == 0 && tz_ctx_cancelled(g->ctx))
            return TZ_CANCELLED;
    }
    return s;
}

/* Crumbs join the neighbour that costs least. */
static tz_status merge_crumbs(graph *g, double least)
{
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < g->n; i++) {
        node *v = &g->nodes[i];
        if (v->parent != i || (double)v->area >= least || v->arcs.n == 0)
            continue;
        double best = INFINITY;
        int32_t to = -1;
        for (int32_t k = 0; k < v->arcs.n; k++) {
            const arc *e = &v->arcs.v[k];
            const node *u = &g->nodes[e->to];
            const double cost = arc_cost(g, v, u, e, strength(g, v, u, e));
            if (to < 0 || cost < best || (cost == best && e->to < to))
                best = cost, to = e->to;
        }
        if ((s = unite(g, to, i)) != TZ_OK)
            return s;
        if (g->nodes[to].area < least && to < i)
            i = to - 1; /* still a crumb */
    }
    return s;
}

/* ---- driver ---------------------------------------------------------------------- */

static tz_status open_graph(graph *g, const tz_region_picture *in, const int32_t *label)
{
    tz_status s = build(g, in, label);
    if (s != TZ_OK)
        return s;
    g->spread = colour_spread(g);
    for (int32_t i = 0; i < g->n; i++) {
        for (int32_t k = 0; k < g->nodes[i].arcs.n; k++) {
            const arc *e = &g->nodes[i].arcs.v[k];
            if (e->to > i && (s = queue(g, i, e)) != TZ_OK)
                return s;
        }
    }
    return TZ_OK;
}

static int32_t root(const graph *g, int32_t i)
{
    while (g->nodes[i].parent != i)
        i = g->nodes[i].parent;
    return i;
}

/* Labels of the merged regions, numbered in raster order of their first pixels. */
static tz_status relabel(const graph *g, int64_t n, int32_t *label, int32_t *count)
{
    int32_t *fresh = NULL, *to = NULL;
    tz_status s;
    if ((s = tz_alloc(g->ctx, &fresh, (size_t)g->n, sizeof *fresh)) != TZ_OK)
        goto done;
    if ((s = tz_alloc(g->ctx, &to, (size_t)g->n, sizeof *to)) != TZ_OK)
        goto done;
    for (int32_t i = 0; i < g->n; i++)
        fresh[i] = -1, to[i] = root(g, i);
    *count = 0;
    for (int64_t p = 0; p < n; p++) {
        int32_t *f = &fresh[to[label[p]]];
        if (*f < 0)
            *f = (*count)++;
        label[p] = *f;
    }
done:
    tz_free(g->ctx, fresh);
    tz_free(g->ctx, to);
    return s;
}

static void close_graph(graph *g)
{
    for (int32_t i = 0; g->nodes && i < g->n; i++)
        tz_array_free(g->ctx, &g->nodes[i].arcs);
    tz_free(g->ctx, g->nodes);
    tz_array_free(g->ctx, &g->heap);
    g->nodes = NULL;
    g->spread = 0;
}

tz_status tz_regions_merge(tz_ctx *ctx, const tz_region_picture *in,
                           const tz_region_options *opt, int32_t *label, int32_t *count)
{
    const int64_t n = (int64_t)in->width * in->height;
    const bool told = opt->wanted > 0;
    const double natural = (double)n / (0.6 * opt->scale * opt->scale);
    const int64_t wanted = told ? opt->wanted : (int64_t)natural + 1;
    graph g = {.ctx = ctx, .opt = opt, .channels = in->channels};
    tz_status s;

    g.limit = told ? INFINITY : STRONG * opt->merge;
    g.n = g.alive = *count;
    if ((s = open_graph(&g, in, label)) != TZ_OK)
        goto done;
    if (opt->merge > 0) { /* joints will take their share */
        s = merge_cheapest(&g, told ? wanted + wanted / 4 : wanted, !told);
        if (s != TZ_OK)
            goto done;
    }
    if ((s = relabel(&g, n, label, count)) != TZ_OK)
        goto done;
    close_graph(&g);
    if (opt->merge > 0) {
        s = tz_joints_dissolve(ctx, in->width, in->height, 0.3 * opt->scale, label,
                               count);
        if (s != TZ_OK)
            goto done;
    }
    g.n = g.alive = *count;
    g.limit = told ? INFINITY : -1; /* the heap serves told numbers only */
    if ((s = open_graph(&g, in, label)) != TZ_OK)
        goto done;
    const double crumb = opt->merge > 0 ? 0.08 * opt->scale * opt->scale : 0;
    if ((s = merge_crumbs(&g, fmax(crumb, opt->least))) != TZ_OK)
        goto done;
    if (told && opt->merge > 0 && (s = merge_cheapest(&g, wanted, false)) != TZ_OK)
        goto done;
    s = relabel(&g, n, label, count);
done:
    close_graph(&g);
    return s;
}
