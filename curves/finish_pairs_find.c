/* SPDX-License-Identifier: Apache-2.0 */
/* Pairs of ends that may be joined. Any two within the reach may, also by a turn, before
 * which one of two that end side by side is cut back to the other; the cost is the way of the
 * curve over the reach, and more where it turns. A bridge stays in the domain, does not come
 * back by itself, and crosses no more lines than it may. */
#include <stdlib.h>
#include <string.h>

#include "curves/finish_pairs_internal.h"

enum {
    NEAREST = 12, /* partners that are tried for each end */
    MOST_FOUND = 512
};
#define TURNING   0.7 /* of the cost, that a turn by pi adds to it */
#define MOST_TURN (1.6 * TZ_PI)
#define STEEP     0.2 /* sine of the angle with a line that is crossed, at least */
#define CUT       0.5 /* times what is cut off */
#define PENS      1.5 /* times the cost: lines of two pens */

/* ---- what a bridge crosses ------------------------------------------------------------- */

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

/* The lines that a chord crosses, but for two tails, into c; false if they are too many or
 * met too flatly. The chord is that of the curve from u on, du long. */
static bool pass_chord(const tz_net *n, tz_vec2 p, tz_vec2 q, const tail but[2], double u,
                       double du, int32_t through, tz_end_pair *c)
{
    int32_t id[MOST_FOUND];
    const tz_vec2 mid = tz_vec2_scale(tz_vec2_add(p, q), 0.5), d = tz_vec2_sub(q, p);
    const double r = tz_vec2_length(d) / 2 + n->spacing;
    const tz_vec3 in = tz_domain_wrap(&n->set.domain, (tz_vec3){mid.x, mid.y, 0});
    const int32_t found =
        tz_grid_query(&n->grid, (tz_vec2){in.x, in.y}, r, id, MOST_FOUND);
    for (int32_t i = 0; i < found && i < MOST_FOUND; i++) {
        const tz_net_point *v = &n->point.v[id[i]];
        if (id[i] + 1 >= n->at[v->piece + 1] || in_tail(n, &but[0], v) ||
            in_tail(n, &but[0], v + 1) || in_tail(n, &but[1], v) ||
            in_tail(n, &but[1], v + 1))
            continue;
        const tz_vec2 from = tz_curve_copy(&n->set.domain, v->at, mid),
                      e = tz_vec2_sub(v[1].at, v->at), to = tz_vec2_add(from, e);
        if (!tz_chords_cross(p, q, from, to))
            continue;
        const double det = d.x * e.y - d.y * e.x;
        const tz_vec2 f = tz_vec2_sub(from, p);
        if (c->passes >= through || tz_net_fixed(n, v->piece) ||
            fabs(det) < STEEP * tz_vec2_length(d) * tz_vec2_length(e))
            return false;
        c->pass[c->passes].piece = v->piece;
        c->pass[c->passes].t = v->t + (f.x * d.y - f.y * d.x) / det * (v[1].t - v->t);
        c->pass[c->passes++].u = u + (f.x * e.y - f.y * e.x) / det * du;
    }
    return found <= MOST_FOUND;
}

static void sort_passes(tz_end_pair *c)
{
    for (int i = 1; i < c->passes; i++)
        for (int j = i; j > 0 && c->pass[j].u < c->pass[j - 1].u; j--) {
            const double t = c->pass[j].t, u = c->pass[j].u;
            const int32_t piece = c->pass[j].piece;
            c->pass[j] = c->pass[j - 1];
            c->pass[j - 1].t = t, c->pass[j - 1].u = u, c->pass[j - 1].piece = piece;
        }
}

/* Whether the curve stays inside and crosses no more lines than it may. */
static bool clear_way(const tz_pairing *k, tz_end_pair *c, const tail but[2])
{
    const tz_net *n = k->n;
    tz_vec2 p = c->curve.p[0];
    c->passes = 0;
    for (int i = 1; i <= TZ_BRIDGE_STEPS; i++) {
        const tz_vec2 q = tz_bezier_at(&c->curve, (double)i / TZ_BRIDGE_STEPS);
        if (tz_domain_depth(&n->set.domain, (tz_vec3){q.x, q.y, 0}) < 0 ||
            !pass_chord(n, p, q, but, (i - 1.0) / TZ_BRIDGE_STEPS, 1.0 / TZ_BRIDGE_STEPS,
                        k->through, c))
            return false;
        p = q;
    }
    sort_passes(c);
    return true;
}

/* ---- candidates ------------------------------------------------------------------------ */

/* The pair, when its lines have been cut back so far; false if nothing comes of it. */
static bool try_pair(const tz_pairing *k, const double cut[2], double reach,
                     tz_end_pair *c)
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
    const tz_edge_place p = tz_edge_place_at(n, na, cut[0]),
                        q = tz_edge_place_at(n, nb, cut[1]);
    double turn;
    tz_bridge_gap g[TZ_BRIDGE_PASSES];
    c->curve = tz_bridge_curve(p.at, p.out, tz_curve_copy(&n->set.domain, q.at, p.at),
                               q.out, &turn);
    const double length = tz_bezier_length(&c->curve);
    if (turn > MOST_TURN || (own && ea->length < 2 * length) || !clear_way(k, c, but) ||
        !tz_bridge_gaps(k, c, g))
        return false; /* it would come back by itself; be hardly a loop; cross something */
    c->cut[0] = cut[0];
    c->cut[1] = cut[1];
    c->cost =
        (length * (1 + TURNING * turn / TZ_PI) + CUT * (cut[0] + cut[1])) / reach *
        (n->pen[tz_net_end_at(n, na) >> 1] == n->pen[tz_net_end_at(n, nb) >> 1] ? 1
                                                                                : PENS);
    return true;
}

static tz_status add_pair(tz_pairing *k, int32_t a, int32_t b, double reach)
{
    const tz_net *n = k->n;
    const int32_t na = k->loose.v[a], nb = k->loose.v[b];
    const tz_vec2 v = tz_net_vector(n, n->set.node.v[na], n->set.node.v[nb]),
                  u = tz_net_outwards(n, na), w = tz_net_outwards(n, nb);
    const double d = tz_vec2_length(v);
    tz_end_pair c = {.a = a, .b = b};
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

tz_status tz_pairing_find(tz_pairing *k, double reach)
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
