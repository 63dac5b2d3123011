/* SPDX-License-Identifier: Apache-2.0 */
/* Ports are ends of lines at the border: at it, or short of it by less than a line's width
 * and headed there (centre lines of filled outlines stop early). Opposite ones are paired
 * cheapest first; what that gives is held against chance: n ports along a side of length l
 * leave to one beyond a window of 2 tolerances a chance of about 2 n tolerance / l, and
 * directions a third of it. */
#include "curves/tile.h"

#include <stdlib.h>
#include <string.h>

#include "curves/clip.h"
#include "curves/curve_edit.h"
#include "curves/curve_join.h"

enum { LEFT, TOP, RIGHT, BOTTOM, SIDES };

typedef struct port {
    int32_t path, end, side;
    int32_t piece; /* and place on it where the line is cut */
    double t;
    tz_vec2 p;   /* that place */
    tz_vec2 out; /* unit, direction there */
    double at;   /* along the side, where it gets to */
    double width;
    uint32_t color;
    int32_t mate; /* port, or -1 */
} port;

typedef struct pair {
    double cost;
    int32_t a, b;
} pair;

typedef struct tiling {
    tz_ctx *ctx;
    tz_curve_set set; /* clipped */
    double reach[2];  /* tolerance along left and right, top and bottom */
    double inset;     /* lines are taken from so many slacks inside; 0 = as they end */
    int32_t *degree;
    TZ_ARRAY(port)
    port;
    TZ_ARRAY(pair)
    pair;
} tiling;

static tz_vec2 normal_of(int side)
{
    static const tz_vec2 n[SIDES] = {{-1, 0}, {0, -1}, {1, 0}, {0, 1}};
    return n[side];
}

/* How far inside of a side. */
static double depth(const tiling *t, int side, tz_vec2 p)
{
    const tz_vec3 size = t->set.domain.size;
    return side == LEFT    ? p.x
           : side == TOP   ? p.y
           : side == RIGHT ? size.x - p.x
                           : size.y - p.y;
}

static bool upright(int side) { return side == LEFT || side == RIGHT; }

static double width_of(const tz_curve_set *s, int32_t path, int32_t piece, int end)
{
    if (s->taper.n)
        return end ? s->taper.v[piece].to : s->taper.v[piece].from;
    return s->pen.v[s->path.v[path].pen].width;
}

/* How far short of the border a line of that width may end. */
static double slack(const tiling *t, double width)
{
    const tz_vec3 size = t->set.domain.size;
    const double side = fmin(size.x, size.y);
    return fmin(fmax(0.75 * width, 1e-4 * side), 0.012 * side);
}

/* ---- lines along the border ---------------------------------------------------------- */

static void put_on_side(tiling *t, int32_t node, int side)
{
    const tz_vec3 size = t->set.domain.size;
    tz_vec2 *p = &t->set.node.v[node];
    if (upright(side))
        p->x = side == LEFT ? 0 : size.x;
    else
        p->y = side == TOP ? 0 : size.y;
}

/* Half of a line along the border is drawn beside it: its pieces go onto it. */
static void lay_along(tiling *t)
{
    tz_curve_set *s = &t->set;
    for (int32_t i = 0; i < s->path.n; i++)
        for (int32_t k = s->path.v[i].piece; k < s->path.v[i].piece + s->path.v[i].pieces;
             k++) {
            tz_curve_piece *c = &s->piece.v[k];
            const tz_vec2 p = s->node.v[c->from], q = s->node.v[c->to];
            const double most = slack(t, width_of(s, i, k, 0)),
                         far = tz_vec2_length(tz_vec2_sub(q, p));
            for (int side = 0; side < SIDES && c->straight && far > 2 * most; side++)
                if (fabs(depth(t, side, p)) < most && fabs(depth(t, side, q)) < most) {
                    put_on_side(t, c->from, side);
                    put_on_side(t, c->to, side);
                }
        }
}

/* Control points follow the nodes that have been moved: from the set as it was. */
static void follow(const tz_vec2 *before, tz_curve_set *s)
{
    for (int32_t k = 0; k < s->piece.n; k++) {
        tz_curve_piece *c = &s->piece.v[k];
        const tz_vec2 p = s->node.v[c->from], q = s->node.v[c->to];
        c->a = tz_vec2_add(c->a, tz_vec2_sub(p, before[c->from]));
        c->b = tz_vec2_add(c->b, tz_vec2_sub(q, before[c->to]));
        if (c->straight) {
            const tz_bezier line = tz_bezier_line(p, q);
            c->a = line.p[1];
            c->b = line.p[2];
        }
    }
}

/* ---- ports --------------------------------------------------------------------------- */

/* From which place on a path is well inside, seen from its end: the centre line of an
 * outline turns aside where the outline is cut. False: it stays near the border. */
static bool inner(const tiling *t, const tz_curve_path *path, int end, int side,
                  double most, port *p)
{
    enum { STEPS = 16 };
    double way = 0;
    for (int32_t j = 0; j < path->pieces && way < 16 * most; j++) {
        const int32_t k = path->piece + (end ? path->pieces - 1 - j : j);
        const tz_bezier b = tz_curve_bezier(&t->set, &t->set.piece.v[k]);
        for (int i = 0; i <= STEPS; i++) {
            double in = (double)i / STEPS, out = (i - 1.0) / STEPS;
            if (depth(t, side, tz_bezier_at(&b, end ? 1 - in : in)) < most)
                continue;
            for (int n = 0; n < 30 && i > 0; n++) {
                const double mid = (in + out) / 2;
                if (depth(t, side, tz_bezier_at(&b, end ? 1 - mid : mid)) < most)
                    out = mid;
                else
                    in = mid;
            }
            p->piece = k;
            p->t = end ? 1 - in : in;
            return end ? p->t > 1e-6 : p->t < 1 - 1e-6;
        }
        way += tz_bezier_length(&b);
    }
    return false;
}

/* Where a line gets to that goes on straight from its inner place. */
static void aim(const tiling *t, int end, port *p)
{
    const tz_bezier b = tz_curve_bezier(&t->set, &t->set.piece.v[p->piece]);
    const tz_vec2 d = tz_bezier_slope(&b, fmin(1 - 1e-6, fmax(1e-6, p->t)));
    const double n = tz_vec2_length(d), k = (end ? 1 : -1) / fmax(n, 1e-300);
    p->p = tz_bezier_at(&b, p->t);
    p->out = (tz_vec2){d.x * k, d.y * k};
    const double off = fmax(0, depth(t, p->side, p->p)),
                 ahead = tz_vec2_dot(p->out, normal_of(p->side)),
                 way = fmin(8 * off, off / fmax(ahead, 1e-3));
    const tz_vec2 at = tz_vec2_add(p->p, tz_vec2_scale(p->out, way));
    p->at = upright(p->side) ? at.y : at.x;
}

static tz_status add_port(tiling *t, int32_t path, int end)
{
    const tz_curve_path *c = &t->set.path.v[path];
    const int32_t piece = end ? c->piece + c->pieces - 1 : c->piece;
    port p = {.path = path, .end = end, .piece = piece, .t = end, .side = -1, .mate = -1};
    p.width = width_of(&t->set, path, piece, end);
    p.color = t->set.pen.v[c->pen].color;
    const double most = slack(t, p.width);
    double best = 0;
    for (int i = 0; i < SIDES; i++) {
        port q = p;
        q.side = i;
        q.t = end;
        q.piece = piece;
        aim(t, end, &q);
        const double off = fabs(depth(t, i, q.p));
        if (off > most || (t->inset > 0 && !inner(t, c, end, i, t->inset * most, &q)))
            continue;
        aim(t, end, &q);
        const double score = tz_vec2_dot(q.out, normal_of(i)) - 0.05;
        if (score > best) {
            best = score;
            p = q;
        }
    }
    return p.side >= 0 ? tz_array_push(t->ctx, &t->port, p) : TZ_OK;
}

static tz_status find_ports(tiling *t)
{
    const tz_curve_set *s = &t->set;
    tz_status st = TZ_OK;
    memset(t->degree, 0, (size_t)s->node.n * sizeof *t->degree);
    for (int32_t k = 0; k < s->piece.n; k++) {
        t->degree[s->piece.v[k].from]++;
        t->degree[s->piece.v[k].to]++;
    }
    for (int32_t i = 0; i < s->path.n && st == TZ_OK; i++) {
        const tz_curve_path *p = &s->path.v[i];
        if (p->closed)
            continue;
        if (t->degree[s->piece.v[p->piece].from] == 1)
            st = add_port(t, i, 0);
        if (st == TZ_OK && t->degree[s->piece.v[p->piece + p->pieces - 1].to] == 1)
            st = add_port(t, i, 1);
    }
    return st;
}

/* ---- pairs --------------------------------------------------------------------------- */

static int by_cost(const void *a, const void *b)
{
    const pair *p = a, *q = b;
    if (p->cost != q->cost)
        return p->cost < q->cost ? -1 : 1;
    if (p->a != q->a)
        return p->a < q->a ? -1 : 1;
    return (p->b > q->b) - (p->b < q->b);
}

static double angle_to(tz_vec2 a, tz_vec2 b)
{
    return atan2(a.x * b.y - a.y * b.x, tz_vec2_dot(a, b));
}

/* From port to port a line runs straight on, or as an arc. */
static double pair_cost(const tiling *t, const port *a, const port *b, bool loosely)
{
    const tz_vec3 size = t->set.domain.size;
    const tz_vec2 n = normal_of(a->side),
                  q = {b->p.x + n.x * size.x, b->p.y + n.y * size.y};
    const tz_vec2 v = tz_vec2_sub(q, a->p), back = tz_vec2_scale(b->out, -1);
    const bool gap = tz_vec2_length(v) > t->reach[upright(a->side) ? 0 : 1];
    const double reach = fmax(t->reach[upright(a->side) ? 0 : 1],
                              0.75 * fmax(a->width, b->width)),
                 off = fabs(a->at - b->at) / reach,
                 wide = fabs(log(a->width / b->width)) / log(1.6),
                 all = fabs(angle_to(a->out, back)) / (25 * TZ_PI / 180),
                 first = gap ? angle_to(a->out, v) / (45 * TZ_PI / 180) : 0,
                 last = gap ? angle_to(v, back) / (45 * TZ_PI / 180) : 0;
    const bool arc =
        gap && fabs(first) < 1 && fabs(last) < 1 && fabs(first - last) < 0.7 && off < 2;
    const bool near = loosely && off < 3 &&
                      (!gap || (tz_vec2_dot(a->out, v) > 0 && tz_vec2_dot(back, v) > 0));
    if (!(wide < 1) || a->color != b->color || !((off < 1 && all < 1) || arc || near))
        return INFINITY;
    return fmin(3, off) + 0.4 * fmin(all, 3) + 0.3 * wide + fabs(first - last);
}

/* @param loosely  what strict pairs have left, if they are most */
static tz_status pair_ports(tiling *t, bool loosely)
{
    tz_status st = TZ_OK;
    t->pair.n = 0;
    for (int32_t i = 0; i < t->port.n; i++)
        for (int32_t j = 0; j < t->port.n && st == TZ_OK; j++) {
            const port *a = &t->port.v[i], *b = &t->port.v[j];
            if (a->side >= 2 || b->side != a->side + 2 || a->mate >= 0 || b->mate >= 0)
                continue;
            const double cost = pair_cost(t, a, b, loosely);
            if (cost < INFINITY)
                st = tz_array_push(t->ctx, &t->pair, ((pair){cost, i, j}));
        }
    if (t->pair.n > 1)
        qsort(t->pair.v, (size_t)t->pair.n, sizeof *t->pair.v, by_cost);
    for (int32_t i = 0; i < t->pair.n && st == TZ_OK; i++) {
        port *a = &t->port.v[t->pair.v[i].a], *b = &t->port.v[t->pair.v[i].b];
        if (a->mate >= 0 || b->mate >= 0)
            continue;
        a->mate = t->pair.v[i].b;
        b->mate = t->pair.v[i].a;
    }
    return st;
}

static void tiling_deinit(tiling *t)
{
    tz_curve_set_deinit(&t->set);
    tz_free(t->ctx, t->degree);
    tz_array_free(t->ctx, &t->port);
    tz_array_free(t->ctx, &t->pair);
}

static tz_status open_tiling(tz_ctx *ctx, const tz_curve_set *set, double inset,
                             tiling *t)
{
    const tz_curve_window window = {.size = {set->domain.size.x, set->domain.size.y}};
    tz_vec2 *before = NULL;
    *t = (tiling){.ctx = ctx, .inset = inset};
    tz_status st = tz_curve_clip(ctx, set, &window, &t->set);
    if (st != TZ_OK)
        return st;
    t->reach[0] = set->domain.size.y / 200;
    t->reach[1] = set->domain.size.x / 200;
    st = tz_alloc(ctx, &before, (size_t)t->set.node.n, sizeof *before);
    if (st == TZ_OK)
        st = tz_alloc_zero(ctx, &t->degree, (size_t)t->set.node.n, sizeof *t->degree);
    if (st == TZ_OK && t->set.node.n > 0) {
        memcpy(before, t->set.node.v, (size_t)t->set.node.n * sizeof *before);
        lay_along(t);
        follow(before, &t->set);
    }
    if (st == TZ_OK)
        st = find_ports(t);
    if (st == TZ_OK)
        st = pair_ports(t, false);
    tz_free(ctx, before);
    if (st != TZ_OK)
        tiling_deinit(t);
    return st;
}

/* ---- whether it is ------------------------------------------------------------------- */

/* Half of the ports may meet no port: their lines may run along the border, or end at ones
 * that do. What is left in the end is counted when all is sewn. */
static bool may_tile(const tiling *t, double *share)
{
    const tz_vec3 size = t->set.domain.size;
    double n[SIDES] = {0}, paired[SIDES] = {0}, chance = 0;
    for (int32_t i = 0; i < t->port.n; i++) {
        n[t->port.v[i].side]++;
        paired[t->port.v[i].side] += t->port.v[i].mate >= 0;
    }
    *share = 1;
    for (int k = 0; k < 2; k++) {
        const double most = fmax(n[k], n[k + 2]), l = k == LEFT ? size.y : size.x;
        if (most > 0)
            *share = fmin(*share, paired[k] / most);
        chance += paired[k] * log(fmin(1, 2 * most * t->reach[k] / l) / 3);
    }
    return *share >= 0.5 && chance < log(1e-4);
}

/* Ends as they are, or if that pairs more, lines from farther inside. */
static tz_status tiling_init(tz_ctx *ctx, const tz_curve_set *set, tiling *t, bool *is)
{
    tiling other;
    double share, more;
    tz_status st = open_tiling(ctx, set, 0, t);
    if (st != TZ_OK)
        return st;
    *is = may_tile(t, &share);
    if (share == 1)
        return TZ_OK;
    st = open_tiling(ctx, set, 1, &other);
    if (st != TZ_OK) {
        tiling_deinit(t);
        return st;
    }
    const bool better = may_tile(&other, &more);
    if (more > share) {
        tiling_deinit(t);
        *t = other;
        *is = better;
    } else {
        tiling_deinit(&other);
    }
    if (*is)
        st = pair_ports(t, true);
    if (st != TZ_OK)
        tiling_deinit(t);
    return st;
}

/* ---- sewing -------------------------------------------------------------------------- */

typedef struct sewing {
    const tiling *t;
    tz_curve_set *to;
    int32_t *node;  /* per node of the tiling */
    int32_t *piece; /* [2 path + end]: port, or -1 */
    int32_t *at;    /* per port: its node */
} sewing;

static tz_status node_of(sewing *w, int32_t from, int32_t *id)
{
    tz_status st = TZ_OK;
    if (w->node[from] < 0)
        st = tz_curve_add_node(w->to, w->t->set.node.v[from], &w->node[from]);
    *id = w->node[from];
    return st;
}

/* A path, cut at the ports of its ends that have partners. */
static tz_status put_path(sewing *w, int32_t path)
{
    const tz_curve_set *s = &w->t->set;
    const tz_curve_path *p = &s->path.v[path];
    const int32_t a = w->piece[2 * (ptrdiff_t)path],
                  b = w->piece[2 * (ptrdiff_t)path + 1];
    const port *v = w->t->port.v;
    const int32_t first = a >= 0 ? v[a].piece : p->piece,
                  last = b >= 0 ? v[b].piece : p->piece + p->pieces - 1;
    if (first > last || (first == last && a >= 0 && b >= 0 && !(v[a].t < v[b].t)))
        return TZ_OK;
    tz_status st = tz_curve_begin(w->to, p->pen);
    for (int32_t k = first; k <= last && st == TZ_OK; k++) {
        const tz_bezier whole = tz_curve_bezier(s, &s->piece.v[k]);
        const double t0 = k == first && a >= 0 ? v[a].t : 0,
                     t1 = k == last && b >= 0 ? v[b].t : 1;
        const tz_bezier c = tz_bezier_part(&whole, t0, t1);
        const tz_curve_carry carried = tz_curve_carried(s, k),
                             carry = tz_curve_carry_part(&carried, &whole, t0, t1);
        tz_curve_piece q = {.a = c.p[1], .b = c.p[2], .straight = s->piece.v[k].straight};
        if (k == first && a >= 0) {
            st = tz_curve_add_node(w->to, c.p[0], &w->at[a]);
            q.from = w->at[a];
        } else {
            st = node_of(w, s->piece.v[k].from, &q.from);
        }
        if (st == TZ_OK && k == last && b >= 0) {
            st = tz_curve_add_node(w->to, c.p[3], &w->at[b]);
            q.to = w->at[b];
        } else if (st == TZ_OK) {
            st = node_of(w, s->piece.v[k].to, &q.to);
        }
        if (q.straight && st == TZ_OK) {
            const tz_bezier l =
                tz_bezier_line(w->to->node.v[q.from], w->to->node.v[q.to]);
            q.a = l.p[1];
            q.b = l.p[2];
        }
        if (st == TZ_OK)
            st = tz_curve_add_piece(w->to, &q, &carry);
    }
    if (st == TZ_OK)
        tz_curve_end(w->to, p->closed);
    return st;
}

/* The line over the border between two ports: smooth at both. */
static tz_status put_seam(sewing *w, int32_t from)
{
    const port *a = &w->t->port.v[from], *b = &w->t->port.v[a->mate];
    const tz_vec3 size = w->to->domain.size;
    const tz_vec2 n = normal_of(a->side), p = a->p,
                  q = {b->p.x + n.x * size.x, b->p.y + n.y * size.y};
    const double k = tz_vec2_length(tz_vec2_sub(q, p)) / 3;
    const tz_curve_set *s = &w->t->set;
    const tz_curve_carry carry = {.origin = tz_curve_no_origin(),
                                  .taper = {a->width, b->width},
                                  .has_origin = s->origin.n > 0,
                                  .has_taper = s->taper.n > 0};
    const tz_curve_piece c = {.from = w->at[from],
                              .to = w->at[a->mate],
                              .a = tz_vec2_add(p, tz_vec2_scale(a->out, k)),
                              .b = tz_vec2_add(q, tz_vec2_scale(b->out, k))};
    if (c.from < 0 || c.to < 0)
        return TZ_OK;
    tz_status st = tz_curve_begin(w->to, s->path.v[a->path].pen);
    if (st == TZ_OK)
        st = tz_curve_add_piece(w->to, &c, &carry);
    if (st == TZ_OK)
        tz_curve_end(w->to, false);
    return st;
}

/* The tiling as a torus, with seams: not joined yet. */
static tz_status sew(const tiling *t, tz_curve_set *to)
{
    sewing w = {.t = t, .to = to};
    tz_domain torus = t->set.domain;
    torus.torus = true;
    tz_status st = tz_curve_set_like(t->ctx, &t->set, &torus, to);
    if (st == TZ_OK)
        st = tz_alloc(t->ctx, &w.node, (size_t)t->set.node.n + 1, sizeof *w.node);
    if (st == TZ_OK)
        st = tz_alloc(t->ctx, &w.piece, 2 * (size_t)t->set.path.n + 1, sizeof *w.piece);
    if (st == TZ_OK)
        st = tz_alloc(t->ctx, &w.at, (size_t)t->port.n + 1, sizeof *w.at);
    if (st == TZ_OK) {
        memset(w.node, -1, (size_t)t->set.node.n * sizeof *w.node);
        memset(w.piece, -1, 2 * (size_t)t->set.path.n * sizeof *w.piece);
        memset(w.at, -1, (size_t)t->port.n * sizeof *w.at);
        for (int32_t i = 0; i < t->port.n; i++)
            if (t->port.v[i].mate >= 0)
                w.piece[2 * (ptrdiff_t)t->port.v[i].path + t->port.v[i].end] = i;
    }
    for (int32_t i = 0; i < t->set.path.n && st == TZ_OK; i++)
        st = put_path(&w, i);
    for (int32_t i = 0; i < t->port.n && st == TZ_OK; i++)
        if (t->port.v[i].mate > i)
            st = put_seam(&w, i);
    tz_free(t->ctx, w.node);
    tz_free(t->ctx, w.piece);
    tz_free(t->ctx, w.at);
    return st;
}

/* Ends that are left beside the border. */
static tz_status count_left(const tiling *t, const tz_curve_set *s, double *left)
{
    int32_t *degree = NULL;
    double wide = 0;
    const tz_vec3 size = s->domain.size;
    const tz_status st =
        tz_alloc_zero(t->ctx, &degree, (size_t)s->node.n + 1, sizeof *degree);
    *left = 0;
    if (st != TZ_OK)
        return st;
    for (int32_t i = 0; i < t->port.n; i++)
        wide = fmax(wide, slack(t, t->port.v[i].width));
    for (int32_t i = 0; i < s->piece.n; i++) {
        degree[s->piece.v[i].from]++;
        degree[s->piece.v[i].to]++;
    }
    for (int32_t i = 0; i < s->node.n; i++) {
        const tz_vec2 p = s->node.v[i];
        *left += degree[i] == 1 &&
                 fmin(fmin(p.x, size.x - p.x), fmin(p.y, size.y - p.y)) <= 1.01 * wide;
    }
    tz_free(t->ctx, degree);
    return TZ_OK;
}

static tz_status join_tiling(const tiling *t, tz_curve_set *out)
{
    tz_curve_set sewn = {0};
    tz_status st = sew(t, &sewn);
    if (st == TZ_OK) {
        tz_curve_wrap(&sewn);
        st = tz_curve_join(t->ctx, &sewn, NULL, out);
    }
    tz_curve_set_deinit(&sewn);
    return st;
}

tz_status tz_curve_tile_find(tz_ctx *ctx, const tz_curve_set *set, bool *is)
{
    tiling t;
    bool may;
    double left = 0;
    if (set->domain.torus || set->domain.region || set->element.photo.n > 0) {
        *is = set->domain.torus;
        return TZ_OK;
    }
    tz_status st = tiling_init(ctx, set, &t, &may);
    if (st != TZ_OK)
        return st;
    if (may) {
        tz_curve_set out = {0};
        st = join_tiling(&t, &out);
        if (st == TZ_OK)
            st = count_left(&t, &out, &left);
        tz_curve_set_deinit(&out);
    }
    if (st == TZ_OK)
        *is = may && left <= 0.15 * t.port.n;
    tiling_deinit(&t);
    return st;
}

tz_status tz_curve_tile_join(tz_ctx *ctx, const tz_curve_set *set, tz_curve_set *out)
{
    tiling t;
    bool may;
    uint8_t *none = NULL;
    tz_curve_set elements = {0};
    *out = (tz_curve_set){0};
    if (set->domain.region)
        return tz_fail(ctx, TZ_INVALID, "tile: a drawing with a region is none");
    if (set->domain.torus)
        return tz_curve_choose(ctx, set, NULL, NULL, NULL, (tz_vec2){0, 0}, out);
    tz_status st = tiling_init(ctx, set, &t, &may);
    if (st != TZ_OK)
        return st;
    st = tz_alloc_zero(ctx, &none, (size_t)t.set.path.n + 1, 1);
    if (st == TZ_OK)
        st = join_tiling(&t, out);
    if (st == TZ_OK)
        st = tz_curve_choose(ctx, &t.set, none, NULL, &out->domain, (tz_vec2){0, 0},
                             &elements);
    if (st == TZ_OK)
        st = tz_curve_append(ctx, out, &elements);
    tz_curve_set_deinit(&elements);
    tz_free(ctx, none);
    tiling_deinit(&t);
    if (st != TZ_OK) {
        tz_curve_set_deinit(out);
        *out = (tz_curve_set){0};
    }
    return st;
}
