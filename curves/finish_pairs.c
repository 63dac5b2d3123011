/* SPDX-License-Identifier: Apache-2.0 */
/* Ends of drawings that have none, in pairs. Pairs are taken from the cheapest on; then an
 * end that is left takes a partner whose other partner finds a third (augmenting paths of
 * three). What then is left is walled in by other lines; a bridge may cross some of these. */
#include <stdlib.h>

#include "curves/finish_pairs_internal.h"

enum {
    MOST = 20000 /* bridges in one round */
};

/* ---- bridges among themselves ------------------------------------------------------------ */

static tz_bridge_way way_of(const tz_bezier *c)
{
    tz_bridge_way w = {.lo = {INFINITY, INFINITY}, .hi = {-INFINITY, -INFINITY}};
    for (int i = 0; i <= TZ_BRIDGE_STEPS; i++) {
        const tz_vec2 p = w.v[i] = tz_bezier_at(c, (double)i / TZ_BRIDGE_STEPS);
        w.lo = (tz_vec2){fmin(w.lo.x, p.x), fmin(w.lo.y, p.y)};
        w.hi = (tz_vec2){fmax(w.hi.x, p.x), fmax(w.hi.y, p.y)};
    }
    return w;
}

static bool ways_cross(const tz_domain *d, const tz_bridge_way *a, const tz_bridge_way *b)
{
    tz_vec2 by = {0, 0};
    if (d->torus)
        by = tz_vec2_sub(
            tz_curve_copy(d, b->v[TZ_BRIDGE_STEPS / 2], a->v[TZ_BRIDGE_STEPS / 2]),
            b->v[TZ_BRIDGE_STEPS / 2]);
    if (a->lo.x > b->hi.x + by.x || b->lo.x + by.x > a->hi.x ||
        a->lo.y > b->hi.y + by.y || b->lo.y + by.y > a->hi.y)
        return false;
    for (int i = 0; i < TZ_BRIDGE_STEPS; i++)
        for (int j = 0; j < TZ_BRIDGE_STEPS; j++)
            if (tz_chords_cross(a->v[i], a->v[i + 1], tz_vec2_add(b->v[j], by),
                                tz_vec2_add(b->v[j + 1], by)))
                return true;
    return false;
}

/* Whether it crosses one that is taken, but for those of that end (-1 = none). */
static bool in_the_way(const tz_pairing *k, const tz_bridge_way *w, int32_t but)
{
    for (int32_t i = 0; i < k->done.n; i++) {
        const int32_t id = k->done.v[i];
        const tz_end_pair *c = &k->pair.v[id];
        if (k->taken[c->a] == id && c->a != but && c->b != but &&
            ways_cross(&k->n->set.domain, w, &k->drawn.v[i]))
            return true;
    }
    return false;
}

/* ---- matching ---------------------------------------------------------------------------- */

static int by_cost(const void *a, const void *b)
{
    const tz_end_pair *p = a, *q = b;
    if (p->cost != q->cost)
        return p->cost < q->cost ? -1 : 1;
    if (p->a != q->a)
        return p->a < q->a ? -1 : 1;
    return (p->b > q->b) - (p->b < q->b);
}

static tz_status take(tz_pairing *k, int32_t id)
{
    const tz_end_pair *c = &k->pair.v[id];
    k->taken[c->a] = k->taken[c->b] = id;
    tz_status s = tz_array_push(k->n->ctx, &k->done, id);
    return s == TZ_OK ? tz_array_push(k->n->ctx, &k->drawn, way_of(&c->curve)) : s;
}

/* Each pair has been found from both its ends. */
static void drop_doubles(tz_pairing *k)
{
    int32_t n = 0;
    for (int32_t i = 0; i < k->pair.n; i++)
        if (n == 0 || k->pair.v[n - 1].a != k->pair.v[i].a ||
            k->pair.v[n - 1].b != k->pair.v[i].b)
            k->pair.v[n++] = k->pair.v[i];
    k->pair.n = n;
}

/* c joins a free end and a taken one, whose partner finds another free one. */
static tz_status augment(tz_pairing *k, int32_t id, const int32_t *first,
                         const int32_t *of)
{
    const tz_end_pair *c = &k->pair.v[id];
    const bool fa = k->taken[c->a] < 0, fb = k->taken[c->b] < 0;
    if (fa == fb)
        return TZ_OK;
    const int32_t held = fa ? c->b : c->a, old = k->taken[held];
    const tz_end_pair *o = &k->pair.v[old];
    const int32_t left = o->a == held ? o->b : o->a, mine = fa ? c->a : c->b;
    const tz_bridge_way w = way_of(&c->curve);
    if (in_the_way(k, &w, held))
        return TZ_OK;
    for (int32_t i = first[left]; i < first[left + 1]; i++) {
        const tz_end_pair *f = &k->pair.v[of[i]];
        const int32_t other = f->a == left ? f->b : f->a;
        const tz_bridge_way x = way_of(&f->curve);
        if (other == mine || k->taken[other] >= 0 || in_the_way(k, &x, held) ||
            ways_cross(&k->n->set.domain, &w, &x))
            continue;
        const tz_status s = take(k, id);
        return s == TZ_OK ? take(k, of[i]) : s;
    }
    return TZ_OK;
}

static tz_status augment_all(tz_pairing *k)
{
    int32_t *first = NULL, *of = NULL;
    tz_status s = tz_alloc_zero(k->n->ctx, &first, (size_t)k->loose.n + 2, sizeof *first);
    if (s == TZ_OK)
        s = tz_alloc(k->n->ctx, &of, 2 * (size_t)k->pair.n, sizeof *of);
    if (s == TZ_OK) {
        for (int32_t i = 0; i < k->pair.n; i++)
            first[k->pair.v[i].a + 2]++, first[k->pair.v[i].b + 2]++;
        for (int32_t i = 2; i < k->loose.n + 2; i++)
            first[i] += first[i - 1];
        for (int32_t i = 0; i < k->pair.n; i++) {
            of[first[k->pair.v[i].a + 1]++] = i;
            of[first[k->pair.v[i].b + 1]++] = i;
        }
    }
    for (int32_t i = 0; i < k->pair.n && s == TZ_OK; i++)
        s = augment(k, i, first, of);
    tz_free(k->n->ctx, first);
    tz_free(k->n->ctx, of);
    return s;
}

static tz_status need_kept(tz_net_edit *e)
{
    if (e->kept)
        return TZ_OK;
    const tz_status s =
        tz_alloc(e->net->ctx, &e->kept, (size_t)e->net->set.piece.n, sizeof *e->kept);
    for (int32_t i = 0; i < e->net->set.piece.n && s == TZ_OK; i++)
        e->kept[i] = (tz_net_kept){{0, 1}, {-1, -1}};
    return s;
}

tz_status tz_finish_pairs(tz_net_edit *e, const tz_finish_limits *l, double reach,
                          int32_t through, double most)
{
    tz_net *n = e->net;
    tz_pairing k = {.edit = e,
                    .n = n,
                    .l = l,
                    .through = through < TZ_BRIDGE_PASSES ? through : TZ_BRIDGE_PASSES};
    double over = tz_net_ends(n, l->margin) - most;
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < n->set.node.n && s == TZ_OK && over > 0; i++)
        if (tz_net_dangles(n, i, l->margin) && !e->gone[tz_net_end_at(n, i) >> 1] &&
            e->merged[i] == i)
            s = tz_array_push(n->ctx, &k.loose, i);
    if (s == TZ_OK)
        s = need_kept(e);
    if (s == TZ_OK && k.loose.n > 1)
        s = tz_pairing_find(&k, reach);
    if (s == TZ_OK)
        s = tz_alloc(n->ctx, &k.taken, (size_t)k.loose.n, sizeof *k.taken);
    for (int32_t i = 0; i < k.loose.n && s == TZ_OK; i++)
        k.taken[i] = -1;
    if (s == TZ_OK && k.pair.n > 1)
        qsort(k.pair.v, (size_t)k.pair.n, sizeof *k.pair.v, by_cost);
    if (s == TZ_OK)
        drop_doubles(&k);
    for (int32_t i = 0; i < k.pair.n && s == TZ_OK && over > 0 && k.done.n < MOST; i++) {
        const tz_end_pair *c = &k.pair.v[i];
        if (k.taken[c->a] >= 0 || k.taken[c->b] >= 0)
            continue;
        const tz_bridge_way w = way_of(&c->curve);
        if (in_the_way(&k, &w, -1))
            continue;
        s = take(&k, i);
        over -= 2;
    }
    if (s == TZ_OK && over > 0 && k.done.n < MOST)
        s = augment_all(&k);
    for (int32_t i = 0; i < k.loose.n && s == TZ_OK; i++)
        if (k.taken[i] >= 0 && k.pair.v[k.taken[i]].a == i)
            s = tz_pairing_draw(&k, k.taken[i]);
    tz_array_free(n->ctx, &k.loose);
    tz_array_free(n->ctx, &k.pair);
    tz_array_free(n->ctx, &k.done);
    tz_array_free(n->ctx, &k.drawn);
    tz_free(n->ctx, k.taken);
    return s;
}
