/* SPDX-License-Identifier: Apache-2.0 */
/* Ends of drawings that have none. Any two within the reach may be joined, also by a turn;
 * the cost is the way of the curve (Hermite, the handles longer the more it turns) over the
 * reach, and more where it turns. Pairs are taken from the cheapest on; then an end that is
 * left takes a partner whose other partner finds a third (augmenting paths of three). What
 * still is left is cut back a little, which makes room, and tried again; in the end, lines
 * that end go as a whole. */
#include <stdlib.h>
#include <string.h>

#include "curves/finish_internal.h"

enum {
    NEAREST = 12, /* partners that are tried for each end */
    STEPS = 12,   /* chords of a bridge */
    MOST = 20000, /* bridges in one round */
    MOST_FOUND = 512
};
#define TURNING 0.7 /* of the cost, that a turn by pi adds to it */
#define PENS    1.5 /* times the cost: lines of two pens */

typedef struct pair {
    double cost;
    int32_t a, b; /* loose ends, by number */
    tz_bezier curve;
} pair;

typedef struct way {
    tz_vec2 v[STEPS + 1], lo, hi;
} way;

typedef struct pairing {
    tz_net_edit *edit;
    tz_net *n;
    const tz_finish_limits *l;
    TZ_ARRAY(int32_t)
    loose; /* nodes */
    TZ_ARRAY(pair)
    pair;
    int32_t *taken; /* per loose end: its pair, or -1 */
    TZ_ARRAY(int32_t)
    done; /* pairs taken, also those given up */
    TZ_ARRAY(way)
    drawn; /* of these */
} pairing;

/* ---- candidates ------------------------------------------------------------------------ */

static double angle_between(tz_vec2 u, tz_vec2 v)
{
    return acos(fmin(fmax(tz_vec2_dot(u, v), -1), 1));
}

/* From p in direction u to q, where the line that ends there points to w. */
static tz_bezier connect(tz_vec2 p, tz_vec2 u, tz_vec2 q, tz_vec2 w, double *turn)
{
    const tz_vec2 v = tz_vec2_sub(q, p);
    const double d = tz_vec2_length(v);
    const tz_vec2 to = d > 0 ? tz_vec2_scale(v, 1 / d) : u;
    *turn = angle_between(u, to) + angle_between(to, tz_vec2_scale(w, -1));
    /* a half circle has handles of 2 / 3 of its diameter, a straight line of a third */
    const double h = d * (1 + fmin(*turn / TZ_PI, 1.5)) / 3;
    return (tz_bezier){
        {p, tz_vec2_add(p, tz_vec2_scale(u, h)), tz_vec2_add(q, tz_vec2_scale(w, h)), q}};
}

static tz_status add_pair(pairing *k, int32_t a, int32_t b, double reach)
{
    const tz_net *n = k->n;
    const int32_t na = k->loose.v[a], nb = k->loose.v[b];
    const tz_vec2 p = n->set.node.v[na], v = tz_net_vector(n, p, n->set.node.v[nb]);
    const int32_t pa = tz_net_end_at(n, na) >> 1, pb = tz_net_end_at(n, nb) >> 1;
    double turn;
    if (!(tz_vec2_length(v) <= reach))
        return TZ_OK;
    pair c = {.a = a, .b = b};
    c.curve = connect(p, tz_net_outwards(n, na), tz_vec2_add(p, v),
                      tz_net_outwards(n, nb), &turn);
    const double length = tz_bezier_length(&c.curve);
    if (turn > 1.3 * TZ_PI) /* it would have to come back by itself */
        return TZ_OK;
    if (n->edge_of[pa] == n->edge_of[pb] && n->edge.v[n->edge_of[pa]].length < 2 * length)
        return TZ_OK; /* hardly a loop */
    c.cost = length / reach * (1 + TURNING * turn / TZ_PI) *
             (n->pen[pa] == n->pen[pb] ? 1 : PENS);
    return tz_array_push(n->ctx, &k->pair, c);
}

typedef struct near_end {
    double d;
    int32_t id;
} near_end;

static int by_distance(const void *a, const void *b)
{
    const near_end *p = a, *q = b;
    if (p->d != q->d)
        return p->d < q->d ? -1 : 1;
    return (p->id > q->id) - (p->id < q->id);
}

static tz_status find_pairs(pairing *k, double reach)
{
    const tz_net *n = k->n;
    const tz_domain *d = &n->set.domain;
    tz_grid g = {0};
    near_end *near = NULL;
    int32_t id[MOST_FOUND];
    tz_vec2 *at = NULL;
    tz_status s = tz_alloc(n->ctx, &at, (size_t)k->loose.n, sizeof *at);
    if (s == TZ_OK)
        s = tz_alloc(n->ctx, &near, MOST_FOUND, sizeof *near);
    for (int32_t i = 0; i < k->loose.n && s == TZ_OK; i++)
        at[i] = n->set.node.v[k->loose.v[i]];
    if (s == TZ_OK)
        s = tz_grid_init(n->ctx, &g, (tz_vec2){0, 0}, (tz_vec2){d->size.x, d->size.y},
                         fmax(reach / 2, hypot(d->size.x, d->size.y) / 2000), d->torus);
    for (int32_t i = 0; i < k->loose.n && s == TZ_OK; i++)
        s = tz_grid_add(n->ctx, &g, at[i], &id[0]);
    for (int32_t i = 0; i < k->loose.n && s == TZ_OK; i++) {
        int32_t found = MOST_FOUND + 1, m = 0;
        for (double r = reach; found > MOST_FOUND && r > 1e-3 * reach; r /= 2)
            found = tz_grid_query(&g, at[i], r, id, MOST_FOUND);
        found = found < MOST_FOUND ? found : MOST_FOUND;
        for (int32_t j = 0; j < found; j++)
            if (id[j] != i)
                near[m++] =
                    (near_end){tz_vec2_length(tz_net_vector(n, at[i], at[id[j]])), id[j]};
        if (m > 1)
            qsort(near, (size_t)m, sizeof *near, by_distance);
        for (int32_t j = 0; j < m && j < NEAREST && s == TZ_OK; j++)
            s = add_pair(k, i < near[j].id ? i : near[j].id,
                         i < near[j].id ? near[j].id : i, reach);
        if (s == TZ_OK && !(i & 1023) && tz_ctx_cancelled(n->ctx))
            s = TZ_CANCELLED;
    }
    tz_grid_deinit(n->ctx, &g);
    tz_free(n->ctx, near);
    tz_free(n->ctx, at);
    return s;
}

static int by_cost(const void *a, const void *b)
{
    const pair *p = a, *q = b;
    if (p->cost != q->cost)
        return p->cost < q->cost ? -1 : 1;
    if (p->a != q->a)
        return p->a < q->a ? -1 : 1;
    return (p->b > q->b) - (p->b < q->b);
}

/* ---- bridges among themselves ------------------------------------------------------------ */

static bool cross(tz_vec2 p, tz_vec2 q, tz_vec2 r, tz_vec2 s)
{
    const tz_vec2 d = tz_vec2_sub(q, p), e = tz_vec2_sub(s, r), f = tz_vec2_sub(r, p);
    const double det = d.x * e.y - d.y * e.x;
    if (det == 0)
        return false;
    const double u = (f.x * e.y - f.y * e.x) / det, v = (f.x * d.y - f.y * d.x) / det;
    return u >= 0 && u <= 1 && v >= 0 && v <= 1;
}

static way way_of(const tz_bezier *c)
{
    way w = {.lo = {INFINITY, INFINITY}, .hi = {-INFINITY, -INFINITY}};
    for (int i = 0; i <= STEPS; i++) {
        const tz_vec2 p = w.v[i] = tz_bezier_at(c, (double)i / STEPS);
        w.lo = (tz_vec2){fmin(w.lo.x, p.x), fmin(w.lo.y, p.y)};
        w.hi = (tz_vec2){fmax(w.hi.x, p.x), fmax(w.hi.y, p.y)};
    }
    return w;
}

static bool ways_cross(const tz_domain *d, const way *a, const way *b)
{
    tz_vec2 by = {0, 0};
    if (d->torus)
        by = tz_vec2_sub(tz_curve_copy(d, b->v[STEPS / 2], a->v[STEPS / 2]),
                         b->v[STEPS / 2]);
    if (a->lo.x > b->hi.x + by.x || b->lo.x + by.x > a->hi.x ||
        a->lo.y > b->hi.y + by.y || b->lo.y + by.y > a->hi.y)
        return false;
    for (int i = 0; i < STEPS; i++)
        for (int j = 0; j < STEPS; j++)
            if (cross(a->v[i], a->v[i + 1], tz_vec2_add(b->v[j], by),
                      tz_vec2_add(b->v[j + 1], by)))
                return true;
    return false;
}

/* Whether it crosses one that is taken, but for those of that end (-1 = none). */
static bool in_the_way(const pairing *k, const way *w, int32_t but)
{
    for (int32_t i = 0; i < k->done.n; i++) {
        const int32_t id = k->done.v[i];
        const pair *c = &k->pair.v[id];
        if (k->taken[c->a] == id && c->a != but && c->b != but &&
            ways_cross(&k->n->set.domain, w, &k->drawn.v[i]))
            return true;
    }
    return false;
}

/* ---- matching ---------------------------------------------------------------------------- */

static bool leaves(const pairing *k, const tz_bezier *c)
{
    for (int i = 1; i < STEPS; i++) {
        const tz_vec2 p = tz_bezier_at(c, (double)i / STEPS);
        if (tz_domain_depth(&k->n->set.domain, (tz_vec3){p.x, p.y, 0}) < 0)
            return true;
    }
    return false;
}

static tz_status take(pairing *k, int32_t id)
{
    const pair *c = &k->pair.v[id];
    k->taken[c->a] = k->taken[c->b] = id;
    tz_status s = tz_array_push(k->n->ctx, &k->done, id);
    return s == TZ_OK ? tz_array_push(k->n->ctx, &k->drawn, way_of(&c->curve)) : s;
}

/* Pairs that would cross a line are none. */
static void drop_blocked(pairing *k)
{
    int32_t n = 0;
    for (int32_t i = 0; i < k->pair.n; i++) {
        const pair *c = &k->pair.v[i];
        const bool twice =
            n > 0 && k->pair.v[n - 1].a == c->a && k->pair.v[n - 1].b == c->b;
        if (!twice && !leaves(k, &c->curve) &&
            !tz_net_blocked(k->n, &c->curve, tz_net_end_at(k->n, k->loose.v[c->a]) >> 1,
                            tz_net_end_at(k->n, k->loose.v[c->b]) >> 1))
            k->pair.v[n++] = *c;
    }
    k->pair.n = n;
}

/* c joins a free end and a taken one, whose partner finds another free one. */
static tz_status augment(pairing *k, int32_t id, const int32_t *first, const int32_t *of)
{
    const pair *c = &k->pair.v[id];
    const bool fa = k->taken[c->a] < 0, fb = k->taken[c->b] < 0;
    if (fa == fb)
        return TZ_OK;
    const int32_t held = fa ? c->b : c->a, old = k->taken[held];
    const pair *o = &k->pair.v[old];
    const int32_t left = o->a == held ? o->b : o->a, mine = fa ? c->a : c->b;
    const way w = way_of(&c->curve);
    if (in_the_way(k, &w, held))
        return TZ_OK;
    for (int32_t i = first[left]; i < first[left + 1]; i++) {
        const pair *f = &k->pair.v[of[i]];
        const int32_t other = f->a == left ? f->b : f->a;
        const way x = way_of(&f->curve);
        if (other == mine || k->taken[other] >= 0 || in_the_way(k, &x, held) ||
            ways_cross(&k->n->set.domain, &w, &x))
            continue;
        const tz_status s = take(k, id);
        return s == TZ_OK ? take(k, of[i]) : s;
    }
    return TZ_OK;
}

static tz_status augment_all(pairing *k)
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

static tz_status draw(pairing *k, int32_t id)
{
    const tz_net *n = k->n;
    const pair *c = &k->pair.v[id];
    const int32_t a = k->loose.v[c->a], b = k->loose.v[c->b];
    const tz_net_bridge bridge = {.node = {a, b},
                                  .curve = c->curve,
                                  .taper = {tz_net_width_at(n, a), tz_net_width_at(n, b)},
                                  .pen = n->pen[tz_net_end_at(n, a) >> 1]};
    k->edit->closed++;
    return tz_array_push(n->ctx, &k->edit->bridge, bridge);
}

tz_status tz_finish_pairs(tz_net_edit *e, const tz_finish_limits *l, double reach,
                          double most)
{
    tz_net *n = e->net;
    pairing k = {.edit = e, .n = n, .l = l};
    double over = tz_net_ends(n, l->margin) - most;
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < n->set.node.n && s == TZ_OK && over > 0; i++)
        if (tz_net_dangles(n, i, l->margin) && !e->gone[tz_net_end_at(n, i) >> 1] &&
            e->merged[i] == i)
            s = tz_array_push(n->ctx, &k.loose, i);
    if (s == TZ_OK && k.loose.n > 1)
        s = find_pairs(&k, reach);
    if (s == TZ_OK)
        s = tz_alloc(n->ctx, &k.taken, (size_t)k.loose.n, sizeof *k.taken);
    for (int32_t i = 0; i < k.loose.n && s == TZ_OK; i++)
        k.taken[i] = -1;
    if (s == TZ_OK && k.pair.n > 1)
        qsort(k.pair.v, (size_t)k.pair.n, sizeof *k.pair.v, by_cost);
    if (s == TZ_OK)
        drop_blocked(&k);
    for (int32_t i = 0; i < k.pair.n && s == TZ_OK && over > 0 && k.done.n < MOST; i++) {
        const pair *c = &k.pair.v[i];
        if (k.taken[c->a] >= 0 || k.taken[c->b] >= 0)
            continue;
        const way w = way_of(&c->curve);
        if (in_the_way(&k, &w, -1))
            continue;
        s = take(&k, i);
        over -= 2;
    }
    if (s == TZ_OK && over > 0 && k.done.n < MOST)
        s = augment_all(&k);
    for (int32_t i = 0; i < k.loose.n && s == TZ_OK; i++)
        if (k.taken[i] >= 0 && k.pair.v[k.taken[i]].a == i)
            s = draw(&k, k.taken[i]);
    tz_array_free(n->ctx, &k.loose);
    tz_array_free(n->ctx, &k.pair);
    tz_array_free(n->ctx, &k.done);
    tz_array_free(n->ctx, &k.drawn);
    tz_free(n->ctx, k.taken);
    return s;
}

/* ---- cutting back ------------------------------------------------------------------------ */

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

/* Where a piece has run that far from one of its ends. */
static double parameter_at(const tz_bezier *b, double way, bool back)
{
    double lo = 0, hi = 1;
    for (int i = 0; i < 30; i++) {
        const double mid = (lo + hi) / 2;
        const tz_bezier part = tz_bezier_part(b, back ? 1 - mid : 0, back ? 1 : mid);
        *(tz_bezier_length(&part) < way ? &lo : &hi) = mid;
    }
    return back ? 1 - hi : hi;
}

/* Takes `way` from the edge's end at that node. */
static tz_status cut_back(tz_net_edit *e, int32_t node, double way)
{
    const tz_net *n = e->net;
    const tz_net_edge *d = &n->edge.v[n->edge_of[tz_net_end_at(n, node) >> 1]];
    const bool front = d->from == node;
    for (int32_t i = 0; i < d->steps; i++) {
        const int32_t end = n->step.v[d->step + (front ? i : d->steps - 1 - i)],
                      piece = end >> 1;
        const tz_bezier b = tz_curve_bezier(&n->set, &n->set.piece.v[piece]);
        const double length = tz_bezier_length(&b);
        const bool back = (end & 1) == front; /* the tail is at the piece's end */
        if (length <= way) {
            e->gone[piece] = true;
            way -= length;
            continue;
        }
        const double t = parameter_at(&b, way, back);
        tz_net_kept *k = &e->kept[piece];
        k->t[back] = t;
        return tz_net_edit_node(e, tz_bezier_at(&b, t), &k->node[back]);
    }
    return TZ_OK;
}

tz_status tz_finish_retract(tz_net_edit *e, const tz_finish_limits *l, double way,
                            double most)
{
    const tz_net *n = e->net;
    tz_status s = need_kept(e);
    if (tz_net_ends(n, l->margin) <= most)
        return s;
    for (int32_t i = 0; i < n->set.node.n && s == TZ_OK; i++) {
        if (!tz_net_dangles(n, i, l->margin))
            continue;
        const tz_net_edge *d = &n->edge.v[n->edge_of[tz_net_end_at(n, i) >> 1]];
        const bool both =
            tz_net_dangles(n, d->from, l->margin) && tz_net_dangles(n, d->to, l->margin);
        if (d->length < (both ? 2 : 1) * way + l->crumb + way)
            continue;
        s = cut_back(e, i, way);
        e->removed++;
    }
    return s;
}

/* ---- going as a whole --------------------------------------------------------------------- */

typedef struct ranked {
    double length;
    int32_t edge, ends;
} ranked;

static int by_length(const void *a, const void *b)
{
    const ranked *p = a, *q = b;
    if (p->length / p->ends != q->length / q->ends)
        return p->length / p->ends < q->length / q->ends ? -1 : 1;
    return (p->edge > q->edge) - (p->edge < q->edge);
}

tz_status tz_finish_drop(tz_net_edit *e, const tz_finish_limits *l, double share,
                         double most)
{
    const tz_net *n = e->net;
    TZ_ARRAY(ranked)
    list = {0};
    bool *busy = NULL;
    double over = tz_net_ends(n, l->margin) - most, left = share * n->length;
    tz_status s = tz_alloc_zero(n->ctx, &busy, (size_t)n->set.node.n, sizeof *busy);
    for (int32_t i = 0; i < n->edge.n && s == TZ_OK && over > 0; i++) {
        const tz_net_edge *d = &n->edge.v[i];
        const int ends = (int)tz_net_dangles(n, d->from, l->margin) +
                         (int)tz_net_dangles(n, d->to, l->margin);
        if (ends > 0)
            s = tz_array_push(n->ctx, &list, ((ranked){d->length, i, ends}));
    }
    if (s == TZ_OK && list.n > 1)
        qsort(list.v, (size_t)list.n, sizeof *list.v, by_length);
    for (int32_t i = 0; i < list.n && s == TZ_OK && over > 0; i++) {
        const tz_net_edge *d = &n->edge.v[list.v[i].edge];
        /* a junction loses one line a round: two might leave an end */
        if (d->length > left || (busy[d->from] && tz_net_degree(n, d->from) > 1) ||
            (busy[d->to] && tz_net_degree(n, d->to) > 1))
            continue;
        busy[d->from] = busy[d->to] = true;
        for (int32_t k = 0; k < d->steps; k++)
            e->gone[n->step.v[d->step + k] >> 1] = true;
        e->removed++;
        left -= d->length;
        over -= list.v[i].ends;
    }
    tz_array_free(n->ctx, &list);
    tz_free(n->ctx, busy);
    return s;
}
