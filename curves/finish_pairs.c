/* SPDX-License-Identifier: Apache-2.0 */
/* Ends of drawings that have none. Any two within the reach may be joined, also by a turn,
 * before which one of two that end side by side is cut back to the other; the cost is the way of the curve (Hermite, the handles longer the more it turns) over the
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
#define CUT     0.5 /* times what is cut off */
#define PENS    1.5 /* times the cost: lines of two pens */

typedef struct pair {
    double cost;
    int32_t a, b;  /* loose ends, by number */
    double cut[2]; /* lengths that their lines lose first */
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

/* An edge's tail that does not count. */
typedef struct tail {
    int32_t edge, node;
    double way;
} tail;

static tail tail_of(const tz_net *n, int32_t node, double way)
{
    return (tail){n->edge_of[tz_net_end_at(n, node) >> 1], node, way};
}

static bool in_tail(const tz_net *n, const tail *t, const tz_net_point *p)
{
    const tz_net_edge *e = &n->edge.v[t->edge];
    return n->edge_of[p->piece] == t->edge &&
           ((e->from == t->node && p->along <= t->way) ||
            (e->to == t->node && e->length - p->along <= t->way));
}

static bool cross(tz_vec2 p, tz_vec2 q, tz_vec2 r, tz_vec2 s)
{
    const tz_vec2 d = tz_vec2_sub(q, p), e = tz_vec2_sub(s, r), f = tz_vec2_sub(r, p);
    const double det = d.x * e.y - d.y * e.x;
    if (det == 0)
        return false;
    const double u = (f.x * e.y - f.y * e.x) / det, v = (f.x * d.y - f.y * d.x) / det;
    return u >= 0 && u <= 1 && v >= 0 && v <= 1;
}

/* Whether a chord crosses a line, but for two tails. */
static bool chord_blocked(const tz_net *n, tz_vec2 p, tz_vec2 q, const tail but[2])
{
    int32_t id[MOST_FOUND];
    const tz_vec2 mid = tz_vec2_scale(tz_vec2_add(p, q), 0.5);
    const double r = tz_vec2_length(tz_vec2_sub(q, p)) / 2 + n->spacing;
    const tz_vec3 in = tz_domain_wrap(&n->set.domain, (tz_vec3){mid.x, mid.y, 0});
    const int32_t found =
        tz_grid_query(&n->grid, (tz_vec2){in.x, in.y}, r, id, MOST_FOUND);
    for (int32_t i = 0; i < found && i < MOST_FOUND; i++) {
        const tz_net_point *v = &n->point.v[id[i]];
        if (id[i] + 1 >= n->at[v->piece + 1] ||
            ((in_tail(n, &but[0], v) || in_tail(n, &but[0], v + 1))) ||
            in_tail(n, &but[1], v) || in_tail(n, &but[1], v + 1))
            continue;
        const tz_vec2 from = tz_curve_copy(&n->set.domain, v->at, mid),
                      to = tz_vec2_add(from, tz_vec2_sub(v[1].at, v->at));
        if (cross(p, q, from, to))
            return true;
    }
    return found > MOST_FOUND;
}

static bool clear_way(const tz_net *n, const tz_bezier *c, const tail but[2])
{
    tz_vec2 p = c->p[0];
    for (int k = 1; k <= STEPS; k++) {
        const tz_vec2 q = tz_bezier_at(c, (double)k / STEPS);
        if (tz_domain_depth(&n->set.domain, (tz_vec3){q.x, q.y, 0}) < 0 ||
            chord_blocked(n, p, q, but))
            return false;
        p = q;
    }
    return true;
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

/* A place on an edge, before its end at that node by `way`. */
typedef struct place {
    int32_t before; /* pieces that lie behind it as a whole */
    int32_t piece;
    bool back; /* the tail is at the piece's end */
    double t;
    tz_vec2 at, out; /* out: towards the end */
} place;

static place place_at(const tz_net *n, int32_t node, double way)
{
    const tz_net_edge *d = &n->edge.v[n->edge_of[tz_net_end_at(n, node) >> 1]];
    const bool front = d->from == node;
    place p = {.piece = -1, .at = n->set.node.v[node], .out = tz_net_outwards(n, node)};
    for (int32_t i = 0; i < d->steps && way > 0; i++) {
        const int32_t end = n->step.v[d->step + (front ? i : d->steps - 1 - i)];
        const tz_bezier b = tz_curve_bezier(&n->set, &n->set.piece.v[end >> 1]);
        const double length = tz_bezier_length(&b);
        if (length <= way) {
            way -= length;
            p.before++;
            continue;
        }
        p.piece = end >> 1;
        p.back = (end & 1) == front;
        p.t = parameter_at(&b, way, p.back);
        const tz_vec2 u = tz_bezier_slope(&b, p.t);
        const double size = tz_vec2_length(u);
        p.at = tz_bezier_at(&b, p.t);
        if (size > 0)
            p.out = tz_vec2_scale(u, (p.back ? 1 : -1) / size);
        break;
    }
    return p;
}

/* The pair, when its lines have been cut back so far; false if nothing comes of it. */
static bool try_pair(const pairing *k, const double cut[2], double reach, pair *c)
{
    const tz_net *n = k->n;
    const int32_t na = k->loose.v[c->a], nb = k->loose.v[c->b];
    const tail but[2] = {tail_of(n, na, cut[0] + 1.01 * n->spacing),
                         tail_of(n, nb, cut[1] + 1.01 * n->spacing)};
    const tz_net_edge *ea = &n->edge.v[but[0].edge], *eb = &n->edge.v[but[1].edge];
    const bool own = but[0].edge == but[1].edge;
    if (ea->length < (own ? cut[0] + cut[1] : cut[0]) + k->l->crumb ||
        eb->length < cut[1] + k->l->crumb)
        return false;
    const place p = place_at(n, na, cut[0]), q = place_at(n, nb, cut[1]);
    double turn;
    c->curve =
        connect(p.at, p.out, tz_curve_copy(&n->set.domain, q.at, p.at), q.out, &turn);
    const double length = tz_bezier_length(&c->curve);
    if (turn > 1.3 * TZ_PI || (own && ea->length < 2 * length) ||
        !clear_way(n, &c->curve, but))
        return false; /* it would come back by itself; be hardly a loop; cross something */
    c->cut[0] = cut[0];
    c->cut[1] = cut[1];
    c->cost =
        (length * (1 + TURNING * turn / TZ_PI) + CUT * (cut[0] + cut[1])) / reach *
        (n->pen[tz_net_end_at(n, na) >> 1] == n->pen[tz_net_end_at(n, nb) >> 1] ? 1
                                                                                : PENS);
    return true;
}

static tz_status add_pair(pairing *k, int32_t a, int32_t b, double reach)
{
    const tz_net *n = k->n;
    const int32_t na = k->loose.v[a], nb = k->loose.v[b];
    const tz_vec2 v = tz_net_vector(n, n->set.node.v[na], n->set.node.v[nb]),
                  u = tz_net_outwards(n, na), w = tz_net_outwards(n, nb);
    const double d = tz_vec2_length(v);
    pair c = {.a = a, .b = b};
    /* as they end; brought level; and a little farther back */
    const double ahead = 0.5 * (tz_vec2_dot(v, u) - tz_vec2_dot(v, w) * -1),
                 level[2] = {fmax(-ahead, 0), fmax(ahead, 0)};
    const double side = sqrt(fmax(d * d - ahead * ahead, 0)), room = 0.5 * side;
    const double cuts[4][2] = {{0, 0},
                               {level[0], level[1]},
                               {level[0] + room, level[1] + room},
                               {level[0] + 2 * room, level[1] + 2 * room}};
    const int tries = tz_vec2_dot(u, w) > 0.3 ? 4 : 1;
    if (!(d <= reach))
        return TZ_OK;
    for (int i = 0; i < tries; i++)
        if (try_pair(k, cuts[i], reach, &c))
            return tz_array_push(n->ctx, &k->pair, c);
    return TZ_OK;
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

static tz_status take(pairing *k, int32_t id)
{
    const pair *c = &k->pair.v[id];
    k->taken[c->a] = k->taken[c->b] = id;
    tz_status s = tz_array_push(k->n->ctx, &k->done, id);
    return s == TZ_OK ? tz_array_push(k->n->ctx, &k->drawn, way_of(&c->curve)) : s;
}

/* Each pair has been found from both its ends. */
static void drop_doubles(pairing *k)
{
    int32_t n = 0;
    for (int32_t i = 0; i < k->pair.n; i++)
        if (n == 0 || k->pair.v[n - 1].a != k->pair.v[i].a ||
            k->pair.v[n - 1].b != k->pair.v[i].b)
            k->pair.v[n++] = k->pair.v[i];
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

/* Takes `way` from the edge's end at that node; the end is then `out`. */
static tz_status cut_back(tz_net_edit *e, int32_t node, double way, int32_t *out)
{
    const tz_net *n = e->net;
    const tz_net_edge *d = &n->edge.v[n->edge_of[tz_net_end_at(n, node) >> 1]];
    const place p = place_at(n, node, way);
    const bool front = d->from == node;
    *out = node;
    if (p.piece < 0)
        return TZ_OK;
    for (int32_t i = 0; i < p.before; i++)
        e->gone[n->step.v[d->step + (front ? i : d->steps - 1 - i)] >> 1] = true;
    tz_net_kept *k = &e->kept[p.piece];
    k->t[p.back] = p.t;
    const tz_status s = tz_net_edit_node(e, p.at, out);
    k->node[p.back] = *out;
    return s;
}

static tz_status draw(pairing *k, int32_t id)
{
    const tz_net *n = k->n;
    const pair *c = &k->pair.v[id];
    const int32_t a = k->loose.v[c->a], b = k->loose.v[c->b];
    tz_net_bridge bridge = {.curve = c->curve,
                            .taper = {tz_net_width_at(n, a), tz_net_width_at(n, b)},
                            .pen = n->pen[tz_net_end_at(n, a) >> 1]};
    tz_status s = cut_back(k->edit, a, c->cut[0], &bridge.node[0]);
    if (s == TZ_OK)
        s = cut_back(k->edit, b, c->cut[1], &bridge.node[1]);
    k->edit->closed++;
    return s == TZ_OK ? tz_array_push(n->ctx, &k->edit->bridge, bridge) : s;
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
    if (s == TZ_OK)
        s = need_kept(e);
    if (s == TZ_OK && k.loose.n > 1)
        s = find_pairs(&k, reach);
    if (s == TZ_OK)
        s = tz_alloc(n->ctx, &k.taken, (size_t)k.loose.n, sizeof *k.taken);
    for (int32_t i = 0; i < k.loose.n && s == TZ_OK; i++)
        k.taken[i] = -1;
    if (s == TZ_OK && k.pair.n > 1)
        qsort(k.pair.v, (size_t)k.pair.n, sizeof *k.pair.v, by_cost);
    if (s == TZ_OK)
        drop_doubles(&k);
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

/* ---- cutting back ------------------------------------------------------------ */

tz_status tz_finish_retract(tz_net_edit *e, const tz_finish_limits *l, double way,
                            double most)
{
    const tz_net *n = e->net;
    int32_t end;
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
        s = cut_back(e, i, way, &end);
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
