/* SPDX-License-Identifier: Apache-2.0 */
/* Ends that are too many. What could be done about each is listed with its cost, the way
 * that is bridged over the reach, more where it bends; or the length of a stub over that
 * of the exemplar's short branches:
 *
 *   join    two ends that point at each other          -2 ends
 *   hit     an end and the line straight ahead of it   -1 (where lines do meet so)
 *   border  an end that points at the border near by   -1
 *   stub    a branch that goes                         -1
 *
 * and the cheapest is done until there are no more ends than the exemplar has. */
#include <stdlib.h>

#include "curves/finish_internal.h"

#define OTHER   1.5  /* times the cost: lines of two pens */
#define AHEAD   0.5  /* cosine of the angle with the end's direction, at least */
#define STEEP   0.3  /* sine of the angle that a line ahead is met at, at least */
#define TOUCH   0.08 /* of delta: nearer than this, direction does not matter */
#define CHANCE  1    /* standard deviations */
#define AT_NODE 0.12 /* of delta: a line that is hit so near to its node is hit there */

typedef enum way { JOIN, HIT, BORDER, STUB } way;

typedef struct choice {
    double cost;
    way way;
    int32_t node, other; /* ends; of a stub, its edge */
    tz_net_point hit;    /* where: piece, t, at */
} choice;

typedef TZ_ARRAY(choice)
choices;

static int by_cost(const void *a, const void *b)
{
    const choice *p = a, *q = b;
    if (p->cost != q->cost)
        return p->cost < q->cost ? -1 : 1;
    if (p->way != q->way)
        return p->way < q->way ? -1 : 1;
    if (p->node != q->node)
        return p->node < q->node ? -1 : 1;
    return (p->other > q->other) - (p->other < q->other);
}

static double cross(tz_vec2 u, tz_vec2 v) { return u.x * v.y - u.y * v.x; }

static double bent(double cosine) { return 1 + 2 * (1 - cosine); }

/* ---- bridges ------------------------------------------------------------------------- */

/* From p in direction u to q, arriving in direction v; v = 0, 0: as it comes. On a torus
 * q is near p. */
static tz_bezier bridge(tz_vec2 p, tz_vec2 u, tz_vec2 q, tz_vec2 v)
{
    const tz_vec2 d = tz_vec2_sub(q, p);
    const double n = tz_vec2_length(d) / 3;
    const tz_vec2 a = tz_vec2_add(p, tz_vec2_scale(u, n));
    if (v.x != 0 || v.y != 0)
        return (tz_bezier){{p, a, tz_vec2_sub(q, tz_vec2_scale(v, n)), q}};
    /* a parabola: its middle point on the end's line */
    const tz_vec2 m = tz_vec2_add(p, tz_vec2_scale(u, 1.5 * n));
    return (tz_bezier){
        {p, a, tz_vec2_add(m, tz_vec2_scale(tz_vec2_sub(q, m), 1.0 / 3)), q}};
}

static bool crosses(tz_vec2 p, tz_vec2 q, tz_vec2 r, tz_vec2 s)
{
    const tz_vec2 d = tz_vec2_sub(q, p), e = tz_vec2_sub(s, r), f = tz_vec2_sub(r, p);
    const double det = cross(d, e);
    if (det == 0)
        return false;
    const double u = cross(f, e) / det, v = cross(f, d) / det;
    return u >= 0 && u <= 1 && v >= 0 && v <= 1;
}

/* Whether the chord p q crosses a line, but for piece `but`. */
static bool chord_blocked(const tz_net *n, tz_vec2 p, tz_vec2 q, int32_t but)
{
    enum { MOST = 512 };
    int32_t id[MOST];
    const tz_vec2 mid = tz_vec2_scale(tz_vec2_add(p, q), 0.5);
    const double r = tz_vec2_length(tz_vec2_sub(q, p)) / 2 + n->spacing;
    const tz_vec3 in = tz_domain_wrap(&n->set.domain, (tz_vec3){mid.x, mid.y, 0});
    const int32_t found = tz_grid_query(&n->grid, (tz_vec2){in.x, in.y}, r, id, MOST);
    for (int32_t i = 0; i < found && i < MOST; i++) {
        const int32_t k = id[i], piece = n->point.v[k].piece;
        if (piece == but || k + 1 >= n->at[piece + 1])
            continue;
        const tz_vec2 from = tz_curve_copy(&n->set.domain, n->point.v[k].at, mid),
                      to = tz_vec2_add(
                          from, tz_vec2_sub(n->point.v[k + 1].at, n->point.v[k].at));
        if (crosses(p, q, from, to))
            return true;
    }
    return found > MOST;
}

bool tz_net_blocked(const tz_net *n, const tz_bezier *c, int32_t a, int32_t b)
{
    enum { STEPS = 8 };
    tz_vec2 p = c->p[0];
    for (int k = 1; k <= STEPS; k++) {
        const tz_vec2 q = tz_bezier_at(c, (double)k / STEPS);
        if (chord_blocked(n, p, q, k == 1 ? a : k == STEPS ? b : -1))
            return true;
        p = q;
    }
    return false;
}

/* Where straight lines from two ends meet ahead of both; false if they do not. q is near
 * p. */
static bool corner(tz_vec2 p, tz_vec2 u, tz_vec2 q, tz_vec2 w, double reach, tz_vec2 *at)
{
    const double det = cross(u, w);
    const tz_vec2 d = tz_vec2_sub(q, p);
    if (fabs(det) < 0.1)
        return false;
    const double s = cross(d, w) / det, t = cross(d, u) / det;
    if (!(s > 0 && t > 0 && s < reach && t < reach))
        return false;
    *at = tz_vec2_add(p, tz_vec2_scale(u, s));
    return true;
}

/* ---- choices ------------------------------------------------------------------------- */

/* Whether a way over the net leads from an end to a point that is near, so that to join
 * them would only make a small loop. */
static bool own_line(const tz_net *n, int32_t node, const tz_net_point *q, double d)
{
    const int32_t edge = n->edge_of[tz_net_end_at(n, node) >> 1];
    const tz_net_edge *e = &n->edge.v[edge];
    if (n->edge_of[q->piece] != edge)
        return false;
    const double along = e->from == node ? q->along : e->length - q->along;
    return along < 3 * d + 3 * n->spacing;
}

static tz_status add_joins(const tz_net *n, int32_t node, const tz_finish_limits *l,
                           const tz_net_point *q, choices *out)
{
    const int32_t piece = q->piece;
    const tz_curve_piece *p = &n->set.piece.v[piece];
    const int32_t other = q->t <= 0 ? p->from : p->to;
    const bool given = tz_net_fixed(n, piece) && tz_net_degree(n, other) == 1;
    if ((q->t > 0 && q->t < 1) ||
        !(given || (other > node && tz_net_dangles(n, other, l->margin))))
        return TZ_OK;
    const tz_vec2 v = tz_net_vector(n, n->set.node.v[node], n->set.node.v[other]),
                  u = tz_net_outwards(n, node), w = tz_net_outwards(n, other);
    const double d = tz_vec2_length(v);
    if (own_line(n, node, q, d) ||
        tz_vec2_dot(u, w) > (l->straight ? 0.3 : -AHEAD / 2)) /* would turn back */
        return TZ_OK;
    double a = d > 0 ? tz_vec2_dot(u, v) / d : 1, b = d > 0 ? -tz_vec2_dot(w, v) / d : 1;
    double way = d;
    tz_vec2 at;
    if (d <= TOUCH * l->delta && tz_vec2_dot(u, w) < 0.2 && a > 0 && b > 0)
        a = b = 1;
    else if (l->straight) {
        const tz_vec2 from = n->set.node.v[node], to = tz_vec2_add(from, v);
        const bool meet = corner(from, u, to, w, l->reach, &at),
                   along = fmin(a, b) > 0.98 ||
                           (a > 0 && b > 0 && fabs(cross(u, v)) < TOUCH * l->delta &&
                            fabs(cross(w, v)) < TOUCH * l->delta);
        if (!meet && !along)
            return TZ_OK;
        if (meet && !along)
            way = tz_vec2_length(tz_vec2_sub(at, from)) +
                  tz_vec2_length(tz_vec2_sub(at, to));
        a = b = along ? 1 : 0.8;
    } else if (a < AHEAD || b < AHEAD || a + b < 2 * AHEAD + 0.3)
        return TZ_OK;
    else if (acos(fmin(a, 1)) + acos(fmin(b, 1)) > 2 * l->bend * d + 0.2)
        return TZ_OK; /* no line turns so fast */
    const double pens = n->pen[tz_net_end_at(n, node) >> 1] == n->pen[piece] ? 1 : OTHER;
    return tz_array_push(n->ctx, out,
                         ((choice){.cost = pens * way / l->reach * bent(a) * bent(b),
                                   .way = JOIN,
                                   .node = node,
                                   .other = other,
                                   .hit = *q}));
}

/* Cost of the way straight ahead to the chord behind that point. */
static double look_ahead(const tz_net *n, int32_t node, int32_t k, double reach,
                         tz_net_point *hit)
{
    const tz_net_point *q = &n->point.v[k];
    const tz_vec2 p = n->set.node.v[node], u = tz_net_outwards(n, node),
                  v = tz_net_vector(n, p, q->at);
    *hit = *q;
    if (k + 1 < n->at[q->piece + 1]) {
        const tz_net_point *r = &n->point.v[k + 1];
        const tz_vec2 e = tz_vec2_sub(r->at, q->at);
        const double det = cross(u, e), size = tz_vec2_length(e);
        const double s = cross(v, e) / det, w = cross(v, u) / det;
        if (fabs(det) > STEEP * size && s > 0 && s <= reach && w >= 0 && w <= 1) {
            hit->t = q->t + w * (r->t - q->t);
            hit->along = q->along + w * (r->along - q->along);
            return own_line(n, node, hit, s) ? INFINITY : s / reach;
        }
    }
    return INFINITY;
}

static tz_status add_border(const tz_net *n, int32_t node, const tz_finish_limits *l,
                            choices *out)
{
    const tz_domain *d = &n->set.domain;
    const tz_vec2 p = n->set.node.v[node], u = tz_net_outwards(n, node);
    const double reach = l->reach;
    double lo = 0, hi = reach;
    const tz_vec2 far = tz_vec2_add(p, tz_vec2_scale(u, reach));
    if (!(tz_domain_depth(d, (tz_vec3){far.x, far.y, 0}) < 0))
        return TZ_OK;
    for (int k = 0; k < 40; k++) {
        const double mid = (lo + hi) / 2;
        const tz_vec2 q = tz_vec2_add(p, tz_vec2_scale(u, mid));
        *(tz_domain_depth(d, (tz_vec3){q.x, q.y, 0}) < 0 ? &hi : &lo) = mid;
    }
    return tz_array_push(
        n->ctx, out,
        ((choice){.cost = hi / reach,
                  .way = BORDER,
                  .node = node,
                  .other = -1,
                  .hit = {.at = tz_vec2_add(p, tz_vec2_scale(u, hi)), .piece = -1}}));
}

static tz_status look_about(const tz_net *n, int32_t node, const tz_finish_limits *l,
                            choices *out)
{
    enum { MOST = 1024 };
    int32_t id[MOST];
    const double reach = l->reach;
    const int32_t found = tz_grid_query(&n->grid, n->set.node.v[node], reach, id, MOST);
    choice best = {.cost = INFINITY, .way = HIT, .node = node, .other = -1};
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < found && i < MOST && s == TZ_OK; i++) {
        const tz_net_point *q = &n->point.v[id[i]];
        tz_net_point hit;
        if (q->piece == tz_net_end_at(n, node) >> 1 &&
            n->edge.v[n->edge_of[q->piece]].steps < 2 && q->along < 3 * n->spacing)
            continue;
        s = add_joins(n, node, l, q, out);
        const double cost =
            l->degrees > 2 ? look_ahead(n, node, id[i], reach, &hit) : INFINITY;
        if (cost < best.cost) {
            best.cost = cost;
            best.hit = hit;
            best.other = id[i];
        }
    }
    if (s == TZ_OK && best.cost < INFINITY)
        s = tz_array_push(n->ctx, out, best);
    return s == TZ_OK ? add_border(n, node, l, out) : s;
}

/* A free branch; `least` alone is a reason. */
static tz_status add_stub(const tz_net *n, int32_t node, const tz_finish_limits *l,
                          choices *out)
{
    const int32_t edge = n->edge_of[tz_net_end_at(n, node) >> 1];
    const tz_net_edge *e = &n->edge.v[edge];
    const int32_t far = e->from == node ? e->to : e->from;
    if (tz_net_degree(n, far) < 3 || !(e->length < l->branch || e->length < l->least))
        return TZ_OK;
    return tz_array_push(
        n->ctx, out,
        ((choice){.cost = e->length < l->least ? -1 : e->length / l->branch,
                  .way = STUB,
                  .node = node,
                  .other = edge}));
}

/* ---- doing it ------------------------------------------------------------------------ */

double tz_net_width_at(const tz_net *n, int32_t node)
{
    const int32_t end = tz_net_end_at(n, node);
    if (n->set.taper.n == 0)
        return n->set.pen.v[n->pen[end >> 1]].width;
    const tz_curve_taper *t = &n->set.taper.v[end >> 1];
    return end & 1 ? t->to : t->from;
}

static tz_status add_bridge(tz_net_edit *e, const choice *c, tz_vec2 to, tz_vec2 v,
                            int32_t node, double width)
{
    const tz_net *n = e->net;
    const tz_vec2 p = n->set.node.v[c->node];
    const tz_net_bridge b = {.node = {c->node, node},
                             .curve = bridge(p, tz_net_outwards(n, c->node), to, v),
                             .taper = {tz_net_width_at(n, c->node), width},
                             .pen = n->pen[tz_net_end_at(n, c->node) >> 1]};
    e->closed++;
    return tz_array_push(n->ctx, &e->bridge, b);
}

/* The piece that is hit is cut, or met at its node. */
static tz_status hit_line(tz_net_edit *e, const choice *c, const tz_finish_limits *l,
                          bool *done)
{
    tz_net *n = e->net;
    const tz_curve_piece *p = &n->set.piece.v[c->hit.piece];
    const tz_bezier b = tz_curve_bezier(&n->set, p);
    const tz_vec2 from = n->set.node.v[c->node];
    tz_vec2 at = tz_bezier_at(&b, c->hit.t);
    int32_t node = -1;
    tz_status s = TZ_OK;
    *done = false;
    if (tz_vec2_length(tz_vec2_sub(at, b.p[0])) < AT_NODE * l->delta)
        node = p->from, at = b.p[0];
    else if (tz_vec2_length(tz_vec2_sub(at, b.p[3])) < AT_NODE * l->delta)
        node = p->to, at = b.p[3];
    if (e->gone[c->hit.piece] || (node < 0 && e->used[c->hit.piece]) || node == c->node)
        return TZ_OK;
    at = tz_curve_copy(&n->set.domain, at, from);
    const tz_bezier way = bridge(from, tz_net_outwards(n, c->node), at, (tz_vec2){0, 0});
    if (tz_net_blocked(n, &way, tz_net_end_at(n, c->node) >> 1, c->hit.piece))
        return TZ_OK;
    if (node < 0) {
        e->used[c->hit.piece] = true;
        s = tz_net_edit_node(e, at, &node);
        if (s == TZ_OK)
            s = tz_array_push(n->ctx, &e->cut,
                              ((tz_curve_cut){c->hit.piece, node, c->hit.t}));
    }
    *done = s == TZ_OK;
    return s == TZ_OK
               ? add_bridge(e, c, at, (tz_vec2){0, 0}, node, tz_net_width_at(n, c->node))
               : s;
}

/* Two straight lines that meet. */
static tz_status join_corner(tz_net_edit *e, const choice *c, tz_vec2 at, bool *done)
{
    const tz_net *n = e->net;
    const tz_vec2 from = n->set.node.v[c->node],
                  to = tz_curve_copy(&n->set.domain, n->set.node.v[c->other], from);
    const tz_bezier a = tz_bezier_line(from, at), b = tz_bezier_line(to, at);
    const int32_t p = tz_net_end_at(n, c->node) >> 1, q = tz_net_end_at(n, c->other) >> 1;
    int32_t node;
    *done = !tz_net_blocked(n, &a, p, q) && !tz_net_blocked(n, &b, p, q);
    if (!*done)
        return TZ_OK;
    tz_status s = tz_net_edit_node(e, at, &node);
    const double w = (tz_net_width_at(n, c->node) + tz_net_width_at(n, c->other)) / 2;
    choice other = *c;
    other.node = c->other;
    if (s == TZ_OK)
        s = add_bridge(e, c, at, (tz_vec2){0, 0}, node, w);
    if (s == TZ_OK)
        s = add_bridge(e, &other,
                       tz_curve_copy(&n->set.domain, at, n->set.node.v[c->other]),
                       (tz_vec2){0, 0}, node, w);
    e->closed--;
    return s;
}

static tz_status join_ends(tz_net_edit *e, const choice *c, const tz_finish_limits *l,
                           bool *done)
{
    const tz_net *n = e->net;
    const tz_vec2 from = n->set.node.v[c->node],
                  at = tz_curve_copy(&n->set.domain, n->set.node.v[c->other], from),
                  v = tz_vec2_scale(tz_net_outwards(n, c->other), -1);
    tz_vec2 meet;
    const tz_vec2 u = tz_net_outwards(n, c->node), d = tz_vec2_sub(at, from);
    if (l->straight && tz_vec2_length(d) > TOUCH * l->delta &&
        tz_vec2_dot(u, d) < 0.98 * tz_vec2_length(d) &&
        corner(from, u, at, tz_vec2_scale(v, -1), l->reach, &meet))
        return join_corner(e, c, meet, done);
    const tz_bezier way = bridge(from, tz_net_outwards(n, c->node), at, v);
    *done = !tz_net_blocked(n, &way, tz_net_end_at(n, c->node) >> 1,
                            tz_net_end_at(n, c->other) >> 1);
    return *done ? add_bridge(e, c, at, v, c->other, tz_net_width_at(n, c->other))
                 : TZ_OK;
}

static tz_status reach_border(tz_net_edit *e, const choice *c, bool *done)
{
    const tz_net *n = e->net;
    int32_t node;
    const tz_bezier way = bridge(n->set.node.v[c->node], tz_net_outwards(n, c->node),
                                 c->hit.at, (tz_vec2){0, 0});
    *done = !tz_net_blocked(n, &way, tz_net_end_at(n, c->node) >> 1, -1);
    if (!*done)
        return TZ_OK;
    const tz_status s = tz_net_edit_node(e, c->hit.at, &node);
    return s == TZ_OK ? add_bridge(e, c, c->hit.at, (tz_vec2){0, 0}, node,
                                   tz_net_width_at(n, c->node))
                      : s;
}

/* A stub whose other end would be left a bad one stays: one at a junction a round. */
static void drop_stub(tz_net_edit *e, const choice *c, bool *busy, bool *done)
{
    const tz_net *n = e->net;
    const tz_net_edge *d = &n->edge.v[c->other];
    const int32_t far = d->from == c->node ? d->to : d->from;
    *done = !busy[far];
    for (int32_t k = 0; k < d->steps; k++)
        *done = *done && !e->used[n->step.v[d->step + k] >> 1];
    if (!*done)
        return;
    busy[far] = true;
    for (int32_t k = 0; k < d->steps; k++)
        e->gone[n->step.v[d->step + k] >> 1] = true;
    e->removed++;
}

static tz_status do_choice(tz_net_edit *e, const choice *c, const tz_finish_limits *l,
                           bool *busy, double *over)
{
    bool done = false;
    tz_status s = TZ_OK;
    const int32_t edge = e->net->edge_of[tz_net_end_at(e->net, c->node) >> 1];
    if (busy[c->node] || (c->way == JOIN && busy[c->other]) ||
        e->gone[e->net->step.v[e->net->edge.v[edge].step] >> 1] ||
        e->merged[c->node] != c->node)
        return TZ_OK;
    if (c->way == JOIN && e->gone[tz_net_end_at(e->net, c->other) >> 1])
        return TZ_OK;
    switch (c->way) {
    case JOIN: s = join_ends(e, c, l, &done); break;
    case HIT: s = hit_line(e, c, l, &done); break;
    case BORDER: s = reach_border(e, c, &done); break;
    case STUB: drop_stub(e, c, busy, &done); break;
    }
    if (!done || s != TZ_OK)
        return s;
    busy[c->node] = true;
    if (c->way == JOIN)
        busy[c->other] = true;
    if (c->cost >= 0 || *over > 0)
        *over -= c->way == JOIN && !tz_net_fixed(e->net, c->hit.piece) ? 2 : 1;
    return TZ_OK;
}

/* ---- how many --------------------------------------------------------------------------- */

/* Gaps that cost no more than `cost` may be closed as far as there are more of them than the
 * exemplar has in such a length; of a few more no one can tell whether they are chance. */
typedef struct allowance {
    double *cost,
        *most; /* of the net's ends, in order, and how many may go up to there */
    int32_t n;
} allowance;

static int up(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void allowance_deinit(tz_ctx *ctx, allowance *a)
{
    tz_free(ctx, a->cost);
    tz_free(ctx, a->most);
}

/* From the least cost at each end of the list. */
static tz_status allowance_init(const tz_net *n, const tz_finish_limits *l,
                                const choices *list, allowance *a)
{
    double *least = NULL;
    *a = (allowance){0};
    if (!l->gap)
        return TZ_OK;
    tz_status s = tz_alloc(n->ctx, &least, (size_t)n->set.node.n, sizeof *least);
    for (int32_t i = 0; i < n->set.node.n && s == TZ_OK; i++)
        least[i] = INFINITY;
    for (int32_t i = 0; i < list->n && s == TZ_OK; i++) {
        const choice *c = &list->v[i];
        least[c->node] = fmin(least[c->node], c->cost);
        if (c->way == JOIN)
            least[c->other] = fmin(least[c->other], c->cost);
    }
    if (s == TZ_OK)
        s = tz_alloc(n->ctx, &a->cost, (size_t)n->set.node.n, sizeof *a->cost);
    if (s == TZ_OK)
        s = tz_alloc(n->ctx, &a->most, (size_t)n->set.node.n, sizeof *a->most);
    for (int32_t i = 0; i < n->set.node.n && s == TZ_OK; i++)
        if (least[i] < INFINITY)
            a->cost[a->n++] = least[i];
    tz_free(n->ctx, least);
    if (s != TZ_OK) {
        allowance_deinit(n->ctx, a);
        *a = (allowance){0};
        return s;
    }
    if (a->n > 1)
        qsort(a->cost, (size_t)a->n, sizeof *a->cost, up);
    const double times = n->length / l->length;
    double most = 0;
    for (int32_t i = 0, k = 0; i < a->n; i++) {
        while (k < l->gaps && l->gap[k] <= a->cost[i])
            k++;
        most = fmax(most, i + 1 - times * k - CHANCE * sqrt(times * times * k));
        a->most[i] = most;
    }
    return TZ_OK;
}

static double allowed(const allowance *a, double cost)
{
    int32_t lo = 0, hi = a->n; /* how many cost no more */
    while (lo < hi) {
        const int32_t mid = lo + (hi - lo) / 2;
        if (a->cost[mid] <= cost)
            lo = mid + 1;
        else
            hi = mid;
    }
    return lo > 0 ? a->most[lo - 1] : 0;
}

tz_status tz_finish_ends(tz_net_edit *e, const tz_finish_limits *l, double most)
{
    const tz_net *n = e->net;
    choices list = {0};
    allowance may = {0};
    bool *busy = NULL;
    const double before = tz_net_ends(n, l->margin);
    double over = before - most;
    tz_status s = tz_alloc_zero(n->ctx, &busy, (size_t)n->set.node.n, sizeof *busy);
    for (int32_t i = 0; i < n->set.node.n && s == TZ_OK; i++) {
        if (!tz_net_dangles(n, i, l->margin) || e->gone[tz_net_end_at(n, i) >> 1])
            continue;
        s = add_stub(n, i, l, &list);
        if (s == TZ_OK && over > 0)
            s = look_about(n, i, l, &list);
        if (s == TZ_OK && !(i & 4095) && tz_ctx_cancelled(n->ctx))
            s = TZ_CANCELLED;
    }
    if (s == TZ_OK && list.n > 1)
        qsort(list.v, (size_t)list.n, sizeof *list.v, by_cost);
    if (s == TZ_OK)
        s = allowance_init(n, l, &list, &may);
    double closed = 0;
    for (int32_t i = 0; i < list.n && s == TZ_OK; i++) {
        const choice *c = &list.v[i];
        const double left = over;
        if (c->cost >= 0 && (over <= 0 || (l->gap && closed >= allowed(&may, c->cost))))
            continue;
        s = do_choice(e, c, l, busy, &over);
        closed += left - over;
    }
    tz_array_free(n->ctx, &list);
    allowance_deinit(n->ctx, &may);
    tz_free(n->ctx, busy);
    return s;
}

tz_status tz_finish_end_costs(const tz_net *n, const tz_finish_limits *l,
                              tz_finish_costs *cost)
{
    choices list = {0};
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < n->set.node.n && s == TZ_OK; i++) {
        double best = INFINITY;
        if (!tz_net_dangles(n, i, l->margin))
            continue;
        list.n = 0;
        s = look_about(n, i, l, &list);
        if (s == TZ_OK)
            s = add_stub(n, i, l, &list);
        for (int32_t k = 0; k < list.n; k++)
            best = fmin(best, list.v[k].cost);
        if (s == TZ_OK)
            s = tz_array_push(n->ctx, cost, best);
    }
    tz_array_free(n->ctx, &list);
    return s;
}
