/* SPDX-License-Identifier: Apache-2.0 */
/* Power diagrams of sites that move a little between updates.
 *
 * Who is beside whom seldom changes, so most cells are made from their rings, which costs
 * a few operations an edge and looks at no other site. That is the true diagram if
 *
 *   - each cell is a convex polygon that its ring closes, inside the domain's rectangle;
 *   - rings agree: where b follows a in that of s, s follows b in that of a, and a follows
 *     s in that of b;
 *   - hidden sites, which have no ring, still have no cell:
 *
 * polygons that fit together edge by edge all around each corner tile the rectangle, and
 * the power to their sites, continuous and turning the right way over each edge, is the
 * least everywhere, as is a triangulation that is regular at each of its edges. The first
 * is looked at each time, the second when rings are written, the third by clipping.
 *
 * A cell that fails is clipped by all sites that reach it, which is exact, and so are
 * those that its new ring does not agree with, until all agree. Cells with corners of four
 * sites, which rounding tells apart differently from each side, are clipped each time, as
 * are those in corners of the rectangle, and those that meet a copy of themselves on a
 * torus. */
#include "fields/power.h"

#include <assert.h>
#include <string.h>

#include "fields/power_internal.h"

enum {
    SLAB = 1 << 16, /* cells whose rings wait to be written */
    CHUNK = 64,     /* of them that one task finds */
    FEW = 512,      /* cells that are not worth waking others for */
    /* What has been done about a cell, over the stamp of the update. */
    SEEN = 0,
    DIRTY = 1,
    DONE = 2
};

/* ---- making ------------------------------------------------------------------------- */

tz_status tz_power_new(tz_ctx *ctx, const tz_domain *domain, tz_power **out)
{
    tz_power *p = NULL;
    if (!(domain->size.x > 0) || !(domain->size.y > 0) || !isfinite(domain->size.x) ||
        !isfinite(domain->size.y))
        return tz_fail(ctx, TZ_INVALID, "power diagram: a domain of %g x %g has no area",
                       domain->size.x, domain->size.y);
    tz_status s = tz_alloc_zero(ctx, &p, 1, sizeof *p);
    if (s != TZ_OK)
        return s;
    p->ctx = ctx;
    p->domain = *domain;
    p->workers = tz_ctx_threads(ctx);
    s = tz_alloc_zero(ctx, &p->work, (size_t)p->workers, sizeof *p->work);
    if (s != TZ_OK)
        tz_power_free(p);
    else
        *out = p;
    return s;
}

void tz_power_free(tz_power *p)
{
    if (!p)
        return;
    tz_ctx *ctx = p->ctx;
    tz_power_grid_forget(p);
    for (int k = 0; p->work && k < p->workers; k++) {
        tz_array_free(ctx, &p->work[k].a);
        tz_array_free(ctx, &p->work[k].b);
    }
    for (int32_t k = 0; k < p->block_cap; k++)
        tz_array_free(ctx, &p->blocks[k].v);
    void *const all[] = {p->work,   p->blocks, p->area,  p->gap,  p->centre,
                         p->gap_at, p->start,  p->count, p->kind, p->mark,
                         p->next,   p->cell,   p->level, p->found};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        tz_free(ctx, all[i]);
    tz_array_free(ctx, &p->neighbour.v);
    tz_array_free(ctx, &p->dirty.v);
    tz_array_free(ctx, &p->hidden.v);
    tz_free(ctx, p);
}

tz_power_cells tz_power_get(const tz_power *p)
{
    return (tz_power_cells){p->n,      p->area,  p->centre,        p->gap,
                            p->gap_at, p->start, p->neighbour.v.v, p->count};
}

static void forget(tz_power *p)
{
    p->n = 0;
    p->neighbour.v.n = p->hidden.v.n = 0;
    p->used = 0;
    tz_power_grid_forget(p);
}

/* Room for n sites; those that come have no neighbours yet. */
static tz_status reserve(tz_power *p, int32_t n)
{
    tz_status s = TZ_OK;
    if (n > p->cap) {
        const size_t cap = (size_t)n + (size_t)n / 8 + 16;
#define GROW(array) \
    if (s == TZ_OK) \
        s = tz_realloc(p->ctx, &p->array, cap, sizeof *p->array);
        GROW(area)
        GROW(gap)
        GROW(centre)
        GROW(gap_at)
        GROW(start)
        GROW(count)
        GROW(kind)
        GROW(mark)
        GROW(next)
        GROW(cell)
        GROW(level)
#undef GROW
        if (s != TZ_OK)
            return s;
        p->cap = (int32_t)cap;
    }
    if (!p->found)
        s = tz_alloc(p->ctx, &p->found, SLAB, sizeof *p->found);
    if (s == TZ_OK && !p->blocks) {
        s = tz_alloc_zero(p->ctx, &p->blocks, SLAB / CHUNK, sizeof *p->blocks);
        p->block_cap = s == TZ_OK ? SLAB / CHUNK : 0;
    }
    if (s != TZ_OK)
        return s;
    for (int32_t i = p->n; i < n; i++) {
        p->start[i] = p->count[i] = p->mark[i] = 0;
        p->kind[i] = TZ_POWER_ODD;
        p->cell[i] = -1;
        p->area[i] = p->gap[i] = 0;
        p->centre[i] = p->gap_at[i] = (tz_vec2){0, 0};
    }
    p->n = n;
    return s;
}

/* ---- rings -------------------------------------------------------------------------- */

/* The ring of a polygon; beside one side it begins after it. */
static tz_status add_ring(tz_power *p, const tz_power_polygon *c, tz_power_list *to,
                          tz_power_found *found)
{
    const tz_power_corner *v = c->k->a.v;
    const int32_t n = c->k->a.n, first = to->v.n;
    int32_t sides = 0, side = -1;
    uint8_t kind = TZ_POWER_INNER;
    for (int32_t e = 0; e < n; e++)
        if (v[e].site < 0)
            sides++, side = e;
    if (sides > 0)
        kind = sides > 1 ? TZ_POWER_ODD : (uint8_t)(TZ_POWER_SIDE - 1 - v[side].site);
    const tz_status s = tz_array_reserve(p->ctx, &to->v, (int64_t)first + n);
    for (int32_t e = 1; e <= n && s == TZ_OK; e++) {
        const int32_t q = v[(side + e) % n].site, k = to->v.n - first;
        bool new = q != c->site &&q >= 0;
        for (int32_t j = first; j < to->v.n && new; j++)
            new = to->v.v[j] != q;
        if (new)
            to->v.v[to->v.n++] = q;
        else if (q >= 0)
            kind = TZ_POWER_ODD;
        else if (k > 0 && k <= 64)
            found->sides |= (uint64_t)1 << (k - 1);
    }
    found->count = to->v.n - first;
    p->kind[c->site] = found->count < 2 ? TZ_POWER_ODD : kind;
    return s;
}

static tz_status find_cell(tz_power *p, int32_t i, tz_power_scratch *k, tz_power_list *to,
                           tz_power_found *found)
{
    tz_power_polygon c = tz_power_polygon_of(p, i, k);
    tz_status s = TZ_OK;
    *found = (tz_power_found){0, 0};
    p->kind[i] = TZ_POWER_ODD;
    if (p->weight[i] >= 0)
        s = tz_power_clip(&c);
    if (s != TZ_OK)
        return s;
    tz_power_measure(p, &c);
    return c.k->a.n < 3 ? TZ_OK : add_ring(p, &c, to, found);
}

/* A chunk of the slab; rings of before are read, those found wait in the block. */
static tz_status find_chunk(tz_ctx *ctx, void *arg, int64_t b, int worker)
{
    tz_power *p = arg;
    tz_power_list *to = &p->blocks[b];
    const int32_t left = p->dirty.v.n - p->from, most = left < SLAB ? left : SLAB;
    const int32_t first = (int32_t)b * CHUNK,
                  end = first + CHUNK < most ? first + CHUNK : most;
    tz_status s = tz_array_reserve(ctx, &to->v, CHUNK * 7);
    to->v.n = 0;
    for (int32_t k = first; k < end && s == TZ_OK; k++)
        s = find_cell(p, p->dirty.v.v[p->from + k], &p->work[worker], to, &p->found[k]);
    return s;
}

/* To be clipped, unless it is or has been. */
static tz_status touch(tz_power *p, int32_t i)
{
    if (p->mark[i] >= p->stamp + DIRTY)
        return TZ_OK;
    p->mark[i] = p->stamp + DIRTY;
    return tz_array_push(p->ctx, &p->dirty.v, i);
}

/* Neighbours that are not in the new ring are found anew: they may be hidden now. */
static tz_status touch_lost(tz_power *p, int32_t i, int32_t n, const int32_t *ring)
{
    tz_status s = TZ_OK;
    for (int32_t k = p->start[i]; k < p->start[i] + p->count[i] && s == TZ_OK; k++) {
        const int32_t q = p->neighbour.v.v[k];
        bool lost = p->mark[q] < p->stamp + DIRTY;
        for (int32_t e = 0; e < n && lost; e++)
            lost = ring[e] != q;
        if (lost)
            s = touch(p, q);
    }
    return s;
}

/* Lists that were replaced by longer ones leave room unused; closes it up. */
static tz_status compact(tz_power *p)
{
    tz_power_list to = {{0}};
    if (p->neighbour.v.n <= p->used + p->used / 2 + 4096)
        return TZ_OK;
    const tz_status s = tz_array_reserve(p->ctx, &to.v, p->used + p->used / 8);
    for (int32_t i = 0; i < p->n && s == TZ_OK; i++) {
        if (p->count[i] > 0)
            memcpy(to.v.v + to.v.n, p->neighbour.v.v + p->start[i],
                   (size_t)p->count[i] * sizeof(int32_t));
        p->start[i] = to.v.n;
        to.v.n += p->count[i];
    }
    if (s == TZ_OK) {
        tz_array_free(p->ctx, &p->neighbour.v);
        p->neighbour = to;
    }
    return s;
}

static tz_status write_ring(tz_power *p, int32_t i, int32_t n, const int32_t *ring)
{
    tz_power_list *to = &p->neighbour;
    tz_status s = touch_lost(p, i, n, ring);
    if (n > p->count[i]) {
        if (s == TZ_OK)
            s = tz_array_reserve(p->ctx, &to->v, (int64_t)to->v.n + n);
        p->start[i] = to->v.n;
    }
    if (s != TZ_OK)
        return s;
    if (n > 0)
        memcpy(to->v.v + p->start[i], ring, (size_t)n * sizeof *ring);
    if (n > p->count[i])
        to->v.n += n;
    p->mark[i] = p->stamp + DONE;
    p->used += n - p->count[i];
    p->count[i] = n;
    return n == 0 && p->weight[i] >= 0 ? tz_array_push(p->ctx, &p->hidden.v, i) : s;
}

/* Whether b follows a in the ring of s. */
static bool follows(const tz_power *p, int32_t s, int32_t a, int32_t b)
{
    const int32_t n = p->count[s], *ring = p->neighbour.v.v + p->start[s];
    for (int32_t k = 0; k < n; k++)
        if (ring[k] == a)
            return ring[k + 1 < n ? k + 1 : 0] == b;
    return false;
}

/* Whether q's ring has i at its side: as its first, or its last. Where odd rings have their
 * sides is not known: they are found anew. */
static bool ends_with(const tz_power *p, int32_t q, int32_t i, bool last)
{
    const int32_t n = p->count[q];
    if (p->kind[q] == TZ_POWER_ODD)
        return p->mark[q] >= p->stamp + DIRTY;
    return p->kind[q] != TZ_POWER_INNER && n > 0 &&
           p->neighbour.v.v[p->start[q] + (last ? n - 1 : 0)] == i;
}

/* Neighbours that do not agree with a ring just written are found anew, too; where both
 * are new, rounding is at work, and they stay odd. */
static tz_status agree(tz_power *p, int32_t i, uint64_t sides)
{
    const int32_t n = p->count[i], *ring = p->neighbour.v.v + p->start[i];
    tz_status s = TZ_OK;
    for (int32_t k = 0; k < n && s == TZ_OK; k++) {
        const int32_t a = ring[k], b = ring[k + 1 < n ? k + 1 : 0];
        const bool side = k < 64 && (sides >> k & 1);
        for (int end = 0; end < 2 && s == TZ_OK; end++) {
            const int32_t q = end ? b : a;
            if (side  ? ends_with(p, q, i, end)
                : end ? follows(p, b, i, a)
                      : follows(p, a, b, i))
                continue;
            if (p->mark[q] != p->stamp + DONE)
                s = touch(p, q);
            else
                p->kind[i] = p->kind[q] = TZ_POWER_ODD;
        }
    }
    return s;
}

/* Finds all dirty cells, and those that do not agree with them. */
static tz_status settle(tz_power *p)
{
    tz_status s = TZ_OK;
    for (p->from = 0; p->from < p->dirty.v.n && s == TZ_OK;) {
        const int32_t left = p->dirty.v.n - p->from, n = left < SLAB ? left : SLAB;
        const int32_t chunks = (n + CHUNK - 1) / CHUNK;
        if (n <= FEW)
            for (int32_t b = 0; b < chunks && s == TZ_OK; b++)
                s = find_chunk(p->ctx, p, b, 0);
        else
            s = tz_parallel_for(p->ctx, chunks, find_chunk, p);
        for (int32_t b = 0, k = 0; b < chunks && s == TZ_OK; b++) {
            const int32_t *ring = p->blocks[b].v.v;
            for (int32_t e = 0; e < CHUNK && k < n && s == TZ_OK; e++, k++) {
                s = write_ring(p, p->dirty.v.v[p->from + k], p->found[k].count, ring);
                ring += p->found[k].count;
            }
        }
        for (int32_t k = 0; k < n && s == TZ_OK; k++)
            s = agree(p, p->dirty.v.v[p->from + k], p->found[k].sides);
        p->from += n;
    }
    return s == TZ_OK ? compact(p) : s;
}

/* ---- updates ------------------------------------------------------------------------ */

/* A cell from its ring; false if it has to be clipped. */
static tz_status refresh(tz_power *p, int32_t i, tz_power_scratch *k, bool *valid)
{
    if (p->weight[i] < 0 && p->count[i] == 0) { /* it has none */
        p->area[i] = p->gap[i] = 0;
        *valid = true;
        return TZ_OK;
    }
    tz_power_polygon c = tz_power_polygon_of(p, i, k);
    const tz_status s =
        p->weight[i] < 0 ? (*valid = false, TZ_OK) : tz_power_from_ring(&c, valid);
    if (s == TZ_OK && *valid)
        tz_power_measure(p, &c);
    return s;
}

static tz_status refresh_block(tz_ctx *ctx, void *arg, int64_t b, int worker)
{
    tz_power *p = arg;
    const int32_t from = (int32_t)b * TZ_POWER_BLOCK,
                  to = from + TZ_POWER_BLOCK < p->n ? from + TZ_POWER_BLOCK : p->n;
    tz_status s = TZ_OK;
    (void)ctx;
    for (int32_t i = from; i < to && s == TZ_OK; i++) {
        bool valid;
        s = refresh(p, i, &p->work[worker], &valid);
        if (!valid)
            p->mark[i] = p->stamp + DIRTY;
    }
    return s;
}

/* Begins a new update: marks of those before are less than its stamp. */
static tz_status begin(tz_power *p, int32_t n, const tz_vec3 *at, const double *weight)
{
    const tz_status s = reserve(p, n);
    p->at = at, p->weight = weight;
    p->dirty.v.n = 0;
    if (s == TZ_OK && (p->stamp += DONE + 1) > INT32_MAX - 2 * DONE) {
        memset(p->mark, 0, (size_t)n * sizeof *p->mark);
        p->stamp = DONE + 1;
    }
    return s;
}

/* All cells have to be clipped. */
static tz_status settle_all(tz_power *p)
{
    tz_status s = tz_array_reserve(p->ctx, &p->dirty.v, p->n);
    p->dirty.v.n = p->hidden.v.n = 0;
    for (int32_t i = 0; i < p->n && s == TZ_OK; i++) {
        p->mark[i] = p->stamp + DIRTY;
        p->dirty.v.v[p->dirty.v.n++] = i;
    }
    return s == TZ_OK ? settle(p) : s;
}

/* Tilings that lie over each other would pass all that is looked at locally. */
static bool tiles(const tz_power *p)
{
    const double all = p->domain.size.x * p->domain.size.y;
    double sum = 0;
    bool any = false;
    for (int32_t i = 0; i < p->n; i++)
        sum += p->area[i], any = any || p->weight[i] >= 0;
    return p->domain.region || !any || fabs(sum - all) < 1e-6 * all;
}

tz_status tz_power_update(tz_power *p, int32_t n, const tz_vec3 *at, const double *weight)
{
    assert(n >= 0);
    if (n < p->n)
        forget(p);
    tz_status s = begin(p, n, at, weight);
    if (s == TZ_OK)
        s = tz_power_grid_update(p, n, NULL);
    if (s == TZ_OK)
        s = tz_parallel_for(p->ctx, (n + TZ_POWER_BLOCK - 1) / TZ_POWER_BLOCK,
                            refresh_block, p);
    p->hidden.v.n = 0;
    for (int32_t i = 0; i < n && s == TZ_OK; i++)
        if (p->mark[i] == p->stamp + DIRTY)
            s = tz_array_push(p->ctx, &p->dirty.v, i);
    if (s == TZ_OK)
        s = settle(p);
    if (s == TZ_OK && !tiles(p))
        s = settle_all(p);
    if (s != TZ_OK)
        forget(p);
    return s;
}

/* A cell whose site or neighbours have changed. */
static tz_status look_at(tz_power *p, int32_t i)
{
    bool valid;
    if (p->mark[i] >= p->stamp + SEEN)
        return TZ_OK;
    p->mark[i] = p->stamp + SEEN;
    const tz_status s = refresh(p, i, &p->work[0], &valid);
    return s == TZ_OK && !valid ? touch(p, i) : s;
}

/* What was hidden may come forth. */
static tz_status touch_hidden(tz_power *p)
{
    tz_status s = TZ_OK;
    for (int32_t k = 0; k < p->hidden.v.n && s == TZ_OK; k++) {
        const int32_t i = p->hidden.v.v[k];
        if (p->count[i] == 0 && p->weight[i] >= 0)
            s = touch(p, i);
    }
    p->hidden.v.n = 0;
    return s;
}

tz_status tz_power_change(tz_power *p, int32_t n, const tz_vec3 *at, const double *weight,
                          int32_t changed, const int32_t *which)
{
    if (p->n == 0 || n < p->n)
        return tz_power_update(p, n, at, weight);
    tz_status s = begin(p, n, at, weight);
    if (s == TZ_OK)
        s = tz_power_grid_update(p, changed, which);
    for (int32_t k = 0; k < changed && s == TZ_OK; k++) {
        const int32_t i = which[k];
        s = look_at(p, i);
        for (int32_t e = 0; e < p->count[i] && s == TZ_OK; e++)
            s = look_at(p, p->neighbour.v.v[p->start[i] + e]);
    }
    if (s == TZ_OK)
        s = touch_hidden(p);
    if (s == TZ_OK)
        s = settle(p);
    if (s != TZ_OK)
        forget(p);
    return s;
}

int32_t tz_power_cell(tz_power *p, int32_t i, tz_power_corner *out, int32_t most)
{
    tz_power_scratch *k = &p->work[0];
    if (i < 0 || i >= p->n || p->weight[i] < 0)
        return 0;
    tz_power_polygon c = tz_power_polygon_of(p, i, k);
    if (tz_power_clip(&c) != TZ_OK || c.gone)
        return 0;
    for (int32_t j = 0; j < k->a.n && j < most; j++) {
        out[j] = k->a.v[j];
        out[j].site = out[j].site < 0 ? -1 : out[j].site;
    }
    return k->a.n;
}
