/* SPDX-License-Identifier: Apache-2.0 */
/* Coherence: which units are alike, and where their neighbours stand.
 *
 * [Dav19] Sec. 5.1 caches the k most similar units of each. Small exemplars are compared
 * all with all. In large ones a unit is described by how far 16 probes about it are from
 * the nearest neighbour; a k-d tree over these descriptions names the units that are
 * worth a full comparison, so that the whole costs O(n log n).
 *
 * Free-space points are where the coherent units have their first ring: all offsets,
 * clustered by density (DBSCAN of at least two points a cluster); centroids of clusters
 * and single points stay. */
#include <math.h>
#include <string.h>

#include "base/kdtree.h"
#include "elements/growth_internal.h"

enum { ALL = 512, PROBES = 16, WORTH = 48 };

/* Units whose surroundings the exemplar's border cuts are liked less: they know less. */
static const float cost_cut = 0.3F, dice = 0.03F;
static const float cost_other = 0.1F; /* another symbol */

/* ---- similar units --------------------------------------------------------------- */

typedef struct search {
    tz_growth_exemplar *ex;
    const tz_kdtree *tree; /* NULL = compare all */
    const float *probe;
    uint64_t seed;
    int32_t k;
} search;

static int32_t view_of(const tz_growth_exemplar *ex, int32_t k, tz_growth_seen *v)
{
    const tz_growth_unit *e = &ex->unit[k];
    for (int32_t j = 0; j < e->nears; j++) {
        const tz_growth_near *o = &ex->near.v[e->near + j];
        v[j] = (tz_growth_seen){.x = o->x,
                                .y = o->y,
                                .r = o->r,
                                .c2 = o->c2,
                                .s2 = o->s2,
                                .kind = o->kind,
                                .symbol = o->symbol,
                                .texture = ex->number,
                                .copy = o->unit};
    }
    return e->nears;
}

static float unlikeness(const tz_growth_exemplar *ex, int32_t a, const tz_growth_seen *va,
                        int32_t na, int32_t b)
{
    tz_growth_seen vb[TZ_GROWTH_NEAR];
    uint64_t used;
    const int32_t nb = view_of(ex, b, vb);
    const float size = (ex->unit[a].r - ex->unit[b].r) / (ex->unit[a].r + ex->unit[b].r);
    const float axes =
        hypotf(ex->unit[a].c2 - ex->unit[b].c2, ex->unit[a].s2 - ex->unit[b].s2);
    return tz_growth_match(ex, b, va, na, INFINITY, &used, NULL) +
           tz_growth_match(ex, a, vb, nb, INFINITY, &used, NULL) + size * size +
           0.25F * axes +
           (ex->symbols && ex->unit[a].symbol != ex->unit[b].symbol ? cost_other : 0) +
           (ex->unit[b].whole ? 0 : cost_cut);
}

static void keep(tz_growth_unit *e, float *cost, int32_t k, int32_t unit, float c)
{
    int32_t i = e->coherents < k ? e->coherents++ : k;
    for (; i > 0 && cost[i - 1] > c; i--)
        if (i < k)
            cost[i] = cost[i - 1], e->coherent[i] = e->coherent[i - 1];
    if (i < k)
        cost[i] = c, e->coherent[i] = unit;
}

static tz_status find_similar(tz_ctx *ctx, void *arg, int64_t at, int worker)
{
    (void)ctx, (void)worker;
    const search *q = arg;
    tz_growth_exemplar *ex = q->ex;
    tz_growth_unit *e = &ex->unit[at];
    tz_growth_seen v[TZ_GROWTH_NEAR];
    float cost[TZ_GROWTH_COHERENT], d2[WORTH];
    int32_t id[WORTH];
    const int32_t n = view_of(ex, (int32_t)at, v);
    const int32_t worth =
        q->tree ? tz_kdtree_nearest(q->tree, q->probe + at * PROBES, WORTH, id, d2)
                : ex->n;
    for (int32_t i = 0; i < worth; i++) {
        const int32_t b = q->tree ? id[i] : i;
        if (b == at || ex->unit[b].kind != e->kind)
            continue;
        /* among equals (a lattice) let chance decide, not the order of the file */
        tz_rng r = tz_rng_make(q->seed, tz_rng_stream('k', (uint64_t)at, (uint64_t)b));
        keep(e, cost, q->k, b,
             unlikeness(ex, (int32_t)at, v, n, b) + dice * (float)tz_rng_unit(&r));
    }
    return TZ_OK;
}

static float probed(const tz_growth_exemplar *ex, int32_t k, int32_t probe)
{
    const tz_growth_unit *e = &ex->unit[k];
    const float far = e->spacing * (probe < PROBES / 2 ? 1.0F : 1.8F);
    const double turn = 2 * TZ_PI * (probe + (probe < PROBES / 2 ? 0 : 0.5)) * 2 / PROBES;
    const float x = far * (float)cos(turn), y = far * (float)sin(turn);
    const int32_t j = tz_growth_at(ex, k, x, y);
    if (j < 0)
        return 0.5F;
    const tz_growth_near *o = &ex->near.v[e->near + j];
    return fminf(1, hypotf(o->x - x, o->y - y) / e->spacing) + (float)o->kind;
}

tz_status tz_growth_find_coherent(tz_ctx *ctx, tz_growth_exemplar *ex,
                                  const tz_growth_params *p)
{
    const int32_t k = p->coherent < TZ_GROWTH_COHERENT ? p->coherent : TZ_GROWTH_COHERENT;
    tz_kdtree tree = {0};
    float *probe = NULL;
    tz_status s = TZ_OK;
    if (ex->n > ALL) {
        s = tz_alloc(ctx, &probe, (size_t)ex->n, PROBES * sizeof *probe);
        for (int32_t i = 0; i < ex->n && s == TZ_OK; i++)
            for (int32_t j = 0; j < PROBES; j++)
                probe[i * PROBES + j] = probed(ex, i, j) + 4 * (float)ex->unit[i].kind;
        if (s == TZ_OK)
            s = tz_kdtree_init(ctx, &tree, probe, ex->n, PROBES);
    }
    if (s == TZ_OK) {
        search q = {ex, tree.point ? &tree : NULL, probe, p->seed, k};
        s = tz_parallel_for(ctx, ex->n, find_similar, &q);
    }
    if (tree.point)
        tz_kdtree_deinit(&tree);
    tz_free(ctx, probe);
    return s;
}

/* ---- free space ------------------------------------------------------------------ */

enum { POINTS = (TZ_GROWTH_COHERENT + 1) * 24 };

static int32_t list_points(const tz_growth_exemplar *ex, int32_t k, tz_vec2 *p)
{
    const tz_growth_unit *e = &ex->unit[k];
    int32_t n = 0;
    for (int32_t i = -1; i < e->coherents; i++) {
        const tz_growth_unit *c = &ex->unit[i < 0 ? k : e->coherent[i]];
        for (int32_t j = 0; j < c->ring && j < 24 && n < POINTS; j++)
            p[n++] = (tz_vec2){ex->near.v[c->near + j].x, ex->near.v[c->near + j].y};
    }
    return n;
}

/* Numbers the cluster that point `from` is in: whatever a chain of short steps reaches.
 * With two points a cluster every point of a chain is a core point. */
static void spread(const tz_vec2 *p, int32_t n, int32_t from, double step,
                   int32_t *cluster)
{
    int32_t stack[POINTS], top = 0;
    stack[top++] = from;
    cluster[from] = from;
    while (top > 0) {
        const int32_t i = stack[--top];
        for (int32_t j = 0; j < n; j++) {
            const tz_vec2 d = tz_vec2_sub(p[j], p[i]);
            if (cluster[j] < 0 && tz_vec2_dot(d, d) <= step * step) {
                cluster[j] = from;
                stack[top++] = j;
            }
        }
    }
}

static bool is_near(tz_vec2 p, tz_vec2 q, double d)
{
    const tz_vec2 v = tz_vec2_sub(p, q);
    return tz_vec2_dot(v, v) <= d * d;
}

static void add_free(tz_growth_unit *e, tz_vec2 p, double apart)
{
    for (int32_t i = 0; i < e->frees; i++)
        if (is_near(e->free[i], p, apart))
            return;
    if (e->frees < TZ_GROWTH_FREE)
        e->free[e->frees++] = p;
}

/* Irregular neighbourhoods chain up to rings, whose centroid would be the unit itself:
 * of such a cluster points at a distance from each other stay. */
static void add_cluster(tz_growth_unit *e, const tz_vec2 *p, const int32_t *cluster,
                        int32_t n, int32_t id)
{
    tz_vec2 sum = {0, 0};
    int32_t members = 0;
    bool compact = true;
    for (int32_t j = id; j < n; j++)
        if (cluster[j] == id)
            sum = tz_vec2_add(sum, p[j]), members++;
    sum = tz_vec2_scale(sum, 1.0 / members);
    for (int32_t j = id; j < n && compact; j++)
        compact = cluster[j] != id || is_near(p[j], sum, 0.3 * e->spacing);
    if (compact)
        add_free(e, sum, 0);
    for (int32_t j = id; j < n && !compact; j++)
        if (cluster[j] == id)
            add_free(e, p[j], 0.4 * e->spacing);
}

static void find_free(tz_growth_exemplar *ex, int32_t k)
{
    tz_growth_unit *e = &ex->unit[k];
    tz_vec2 p[POINTS];
    int32_t cluster[POINTS];
    const int32_t n = list_points(ex, k, p);
    memset(cluster, 0xff, sizeof cluster);
    for (int32_t i = 0; i < n; i++)
        if (cluster[i] < 0) {
            spread(p, n, i, 0.2 * e->spacing, cluster);
            add_cluster(e, p, cluster, n, i);
        }
}

void tz_growth_find_free(tz_growth_exemplar *ex)
{
    for (int32_t k = 0; k < ex->n; k++)
        find_free(ex, k);
}
