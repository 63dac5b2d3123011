/* SPDX-License-Identifier: Apache-2.0 */
/* Runs to paths: a run goes on in the one that its end is paired with, if their pens are
 * the same. Nodes of the exemplar stay shared within a patch (a table finds them). */
#include <string.h>

#include "curves/quilt_internal.h"

typedef struct shared {
    int32_t patch, node;
    int32_t id; /* -1 = free */
} shared;

typedef struct emitting {
    tz_ctx *ctx;
    const quilt_source *s;
    const quilt_map *m;
    quilt_runs *r;
    quilt_warp warp;
    tz_curve_set *out;
    shared *table;
    uint64_t mask;
    bool *seen;    /* runs */
    int32_t *node; /* per cut: node of the lower of a pair, or -1 */
} emitting;

/* ---- nodes -------------------------------------------------------------------------- */

/* A new node, within the torus. */
static tz_status add_node(emitting *e, tz_vec2 p, int32_t *id)
{
    if (e->m->domain->torus)
        p = (tz_vec2){tz_domain_wrap_axis(p.x, e->m->domain->size.x),
                      tz_domain_wrap_axis(p.y, e->m->domain->size.y)};
    return tz_curve_add_node(e->out, p, id);
}

static tz_status node_of(emitting *e, int32_t patch, int32_t node, int32_t *id)
{
    const shared key = {patch, node, -1};
    uint64_t at = tz_rng_stream((uint64_t)patch, (uint64_t)node, 0) & e->mask;
    for (;; at = (at + 1) & e->mask) {
        shared *t = &e->table[at];
        if (t->id < 0)
            break;
        if (t->patch == patch && t->node == node) {
            *id = t->id;
            return TZ_OK;
        }
    }
    const quilt_patch *q = &e->m->patch.v[patch];
    const tz_vec2 x = quilt_place_at(q, e->s->set->node.v[node]),
                  anchor = quilt_place_at(q, e->s->anchor[node]);
    const tz_vec2 p =
        tz_vec2_add(x, tz_vec2_sub(quilt_warp_at(&e->warp, patch, anchor), anchor));
    const tz_status st = add_node(e, p, id);
    if (st == TZ_OK) {
        e->table[at] = key;
        e->table[at].id = *id;
    }
    return st;
}

/* One for both cuts of a pair. */
static tz_status node_of_cut(emitting *e, int32_t cut, int32_t *id)
{
    const int32_t mate = e->r->cut.v[cut].mate;
    const bool bridge = e->r->cut.v[cut].bridge;
    const int32_t key = mate >= 0 && mate < cut && !bridge ? mate : cut;
    tz_status st = TZ_OK;
    if (e->node[key] < 0)
        st = add_node(e, e->r->cut.v[cut].to, &e->node[key]);
    if (st == TZ_OK)
        *id = e->node[key];
    return st;
}

/* ---- pieces ------------------------------------------------------------------------- */

typedef struct bit {
    int32_t patch;
    tz_bezier b; /* in the domain, not warped */
    tz_bezier origin;
    tz_curve_taper taper;
    bool straight;
    bool rigid;
    int32_t from, to; /* nodes */
    bool back;
} bit;

/* Image of a cubic under the field: ends and end tangents are exact. */
static tz_bezier warped(const emitting *e, int32_t patch, const tz_bezier *b)
{
    tz_bezier w;
    const double h = 1e-4 * e->warp.radius;
    for (int k = 0; k < 2; k++) {
        const int end = k ? 3 : 0, ctl = k ? 2 : 1;
        const tz_vec2 p = b->p[end], d = tz_vec2_sub(b->p[ctl], p);
        const double n = tz_vec2_length(d);
        w.p[end] = quilt_warp_at(&e->warp, patch, p);
        w.p[ctl] = tz_vec2_add(w.p[end], d);
        if (n == 0)
            continue;
        const tz_vec2 step = tz_vec2_scale(d, h / n);
        const tz_vec2 q =
            tz_vec2_sub(quilt_warp_at(&e->warp, patch, tz_vec2_add(p, step)),
                        quilt_warp_at(&e->warp, patch, tz_vec2_sub(p, step)));
        w.p[ctl] = tz_vec2_add(w.p[end], tz_vec2_scale(q, n / (2 * h)));
    }
    return w;
}

/* Appends a curve that runs from node to node, or to copies of them. */
static tz_status append(emitting *e, int32_t from, int32_t to, const tz_bezier *c,
                        bool straight, const tz_curve_carry *carry)
{
    const tz_vec2 p = e->out->node.v[from], by = tz_vec2_sub(p, c->p[0]);
    tz_curve_piece piece = {from, to, tz_vec2_add(c->p[1], by), tz_vec2_add(c->p[2], by),
                            straight};
    if (straight) {
        const tz_bezier line = tz_bezier_line(
            p, tz_curve_copy(&e->out->domain, e->out->node.v[to], piece.b));
        piece.a = line.p[1], piece.b = line.p[2];
    }
    return tz_curve_add_piece(e->out, &piece, carry);
}

static tz_status put(emitting *e, const bit *x)
{
    const tz_domain *d = &e->out->domain;
    const tz_vec2 p = tz_curve_copy(d, e->out->node.v[x->from], x->b.p[0]),
                  q = tz_curve_copy(d, e->out->node.v[x->to], x->b.p[3]);
    const tz_curve_carry carry = {.origin = x->origin,
                                  .taper = x->taper,
                                  .has_origin = true,
                                  .has_taper = e->s->set->taper.n > 0};
    tz_bezier w = x->b;
    if (x->straight) {
        if (x->from == x->to)
            return TZ_OK; /* nothing to see */
        w = tz_bezier_line(p, q);
    } else if (!x->rigid && quilt_warp_near(&e->warp, x->patch, tz_bezier_at(&x->b, 0.5),
                                            tz_bezier_length(&x->b))) {
        w = warped(e, x->patch, &x->b);
    }
    w = (tz_bezier){{p, tz_vec2_add(p, tz_vec2_sub(w.p[1], w.p[0])),
                     tz_vec2_add(q, tz_vec2_sub(w.p[2], w.p[3])), q}};
    if (!x->back)
        return append(e, x->from, x->to, &w, x->straight, &carry);
    const tz_bezier r = {{w.p[3], w.p[2], w.p[1], w.p[0]}};
    const tz_curve_carry c = tz_curve_carry_back(&carry);
    return append(e, x->to, x->from, &r, x->straight, &c);
}

static tz_bezier mapped(const quilt_patch *p, const tz_bezier *b)
{
    return (tz_bezier){{quilt_place_at(p, b->p[0]), quilt_place_at(p, b->p[1]),
                        quilt_place_at(p, b->p[2]), quilt_place_at(p, b->p[3])}};
}

/* Where in the exemplar a part of a piece is from. */
static tz_bezier origin_of(const quilt_source *s, int32_t piece, const tz_bezier *part,
                           double t0, double t1)
{
    if (!s->origin)
        return *part;
    const tz_bezier b =
        tz_curve_bezier(s->original, &s->original->piece.v[s->origin[piece]]);
    return tz_bezier_part(&b, t0, t1);
}

/* A part: one bit, or several where it is bent. */
static tz_status put_part(emitting *e, const quilt_run *run, const quilt_part *part,
                          int32_t from, int32_t to, bool back)
{
    enum { MOST = 64 };
    const quilt_source *s = e->s;
    const quilt_patch *p = &e->m->patch.v[run->patch];
    const tz_bezier whole = tz_curve_bezier(s->set, &s->set->piece.v[part->piece]),
                    cut = tz_bezier_part(&whole, part->t0, part->t1), b = mapped(p, &cut);
    const bool straight = s->set->piece.v[part->piece].straight;
    const double length = tz_bezier_length(&b);
    int32_t n = 1;
    tz_status st = TZ_OK;
    /* a whole loop is moved, what is cut is bent */
    const bool rigid = s->rigid[run->path] && run->closed;
    if (!straight && !rigid &&
        quilt_warp_near(&e->warp, run->patch, tz_bezier_at(&b, 0.5), length))
        n = (int32_t)fmin(MOST, fmax(1, ceil(length / (e->warp.radius / 3))));
    for (int32_t j = 0; j < n && st == TZ_OK; j++) {
        const int32_t k = back ? n - 1 - j : j;
        const double t0 = part->t0 + (part->t1 - part->t0) * k / n,
                     t1 = part->t0 + (part->t1 - part->t0) * (k + 1) / n;
        const tz_bezier o = tz_bezier_part(&whole, t0, t1);
        bit x = {.patch = run->patch,
                 .b = mapped(p, &o),
                 .origin = origin_of(s, part->piece, &o, t0, t1),
                 .straight = straight,
                 .rigid = rigid,
                 .from = from,
                 .to = to,
                 .back = back};
        if (s->set->taper.n)
            x.taper =
                (tz_curve_taper){quilt_width_at(s, part->piece, t0) *
                                     quilt_warp_width(&e->warp, run->patch, x.b.p[0]),
                                 quilt_width_at(s, part->piece, t1) *
                                     quilt_warp_width(&e->warp, run->patch, x.b.p[3])};
        if (k < n - 1 && !back) {
            st = add_node(e, quilt_warp_at(&e->warp, run->patch, x.b.p[3]), &x.to);
            from = x.to;
        } else if (k > 0 && back) {
            st = add_node(e, quilt_warp_at(&e->warp, run->patch, x.b.p[0]), &x.from);
            to = x.from;
        }
        if (st == TZ_OK)
            st = put(e, &x);
    }
    return st;
}

/* Node at the begin (0) or end (1) of part k of a run. */
static tz_status end_of(emitting *e, const quilt_run *run, int32_t k, int end,
                        int32_t *id)
{
    const quilt_part *p = &e->r->part.v[run->part + k];
    if (end ? p->t1 < 1 || (k == run->parts - 1 && run->cut[1] >= 0)
            : p->t0 > 0 || (k == 0 && run->cut[0] >= 0))
        return node_of_cut(e, run->cut[end], id);
    const tz_curve_piece *c = &e->s->set->piece.v[p->piece];
    return node_of(e, run->patch, end ? c->to : c->from, id);
}

static tz_status put_run(emitting *e, int32_t run, bool back)
{
    const quilt_run *r = &e->r->run.v[run];
    tz_status st = TZ_OK;
    e->seen[run] = true;
    for (int32_t j = 0; j < r->parts && st == TZ_OK; j++) {
        const int32_t k = back ? r->parts - 1 - j : j;
        int32_t from = 0, to = 0;
        st = end_of(e, r, k, 0, &from);
        if (st == TZ_OK)
            st = end_of(e, r, k, 1, &to);
        if (st == TZ_OK)
            st = put_part(e, r, &e->r->part.v[r->part + k], from, to, back);
    }
    return st;
}

/* The line between two cuts that are joined over a gap: of no origin. */
static tz_status put_bridge(emitting *e, int32_t from, int32_t to)
{
    const quilt_cut *a = &e->r->cut.v[from], *b = &e->r->cut.v[to];
    const tz_bezier c = quilt_bridge(e->m->domain, a, b);
    const tz_curve_carry carry = {.origin = tz_curve_no_origin(),
                                  .taper = {a->width, b->width},
                                  .has_origin = true,
                                  .has_taper = e->s->set->taper.n > 0};
    int32_t p, q;
    tz_status st = node_of_cut(e, from, &p);
    if (st == TZ_OK)
        st = node_of_cut(e, to, &q);
    return st == TZ_OK ? append(e, p, q, &c, false, &carry) : st;
}

/* ---- chains ------------------------------------------------------------------------- */

/* The cut at which the line goes on, past end `side` of a run; -1 = nowhere. */
static int32_t onward(const emitting *e, int32_t run, int side)
{
    const int32_t cut = e->r->run.v[run].cut[side];
    if (cut < 0)
        return -1;
    const quilt_cut *c = &e->r->cut.v[cut];
    if (c->mate < 0 || e->r->cut.v[c->mate].run < 0 ||
        e->r->cut.v[c->mate].pen != c->pen || e->r->run.v[e->r->cut.v[c->mate].run].gone)
        return -1;
    return c->mate;
}

static tz_status put_chain(emitting *e, int32_t run)
{
    int side = 0; /* entered there */
    int32_t first = run, at;
    /* back to where it begins, or once around */
    for (int32_t k = 0; k < e->r->run.n && (at = onward(e, first, side)) >= 0; k++) {
        const int32_t next = e->r->cut.v[at].run;
        if (next == run && e->r->cut.v[at].side == 1)
            break;
        first = next;
        side = 1 - e->r->cut.v[at].side;
    }
    tz_status st = tz_curve_begin(e->out, e->s->set->path.v[e->r->run.v[run].path].pen);
    int32_t on = first;
    bool closed = false;
    while (st == TZ_OK) {
        st = put_run(e, on, side == 1);
        closed = e->r->run.v[on].closed;
        at = onward(e, on, 1 - side);
        if (at < 0)
            break;
        const quilt_cut *c = &e->r->cut.v[at];
        if (c->bridge)
            st = put_bridge(e, c->mate, at);
        on = c->run;
        side = c->side;
        if (e->seen[on]) {
            closed = on == first;
            break;
        }
    }
    if (st == TZ_OK)
        tz_curve_end(e->out, closed);
    return st;
}

/* ---- stubs -------------------------------------------------------------------------- */

static double part_length(const emitting *e, const quilt_part *p)
{
    const tz_bezier b = tz_curve_bezier(e->s->set, &e->s->set->piece.v[p->piece]),
                    c = tz_bezier_part(&b, p->t0, p->t1);
    return tz_bezier_length(&c);
}

static bool loose(const emitting *e, const quilt_run *r, int side)
{
    const int32_t c = r->cut[side];
    return c >= 0 && e->r->cut.v[c].mate < 0 && e->r->cut.v[c].other != QUILT_OUTSIDE;
}

/* A line that is cut and meets nothing goes back to its last junction if that is near. */
static void retract(emitting *e, quilt_run *r, int side, double most)
{
    double length = 0;
    for (int32_t j = 0; j < r->parts; j++) {
        const int32_t k = side ? r->parts - 1 - j : j;
        const quilt_part *p = &e->r->part.v[r->part + k];
        const tz_curve_piece *c = &e->s->set->piece.v[p->piece];
        const bool whole = side ? p->t0 == 0 : p->t1 == 1;
        length += part_length(e, p);
        if (length > most)
            return;
        if (!whole || e->s->degree[side ? c->from : c->to] < 3)
            continue;
        r->parts -= j + 1;
        if (!side)
            r->part += j + 1;
        r->cut[side] = -1;
        r->gone = r->parts == 0;
        return;
    }
    /* all of it is short: a crumb, unless it goes on at the other end */
    const bool other = r->cut[1 - side] >= 0 && e->r->cut.v[r->cut[1 - side]].mate >= 0;
    r->gone = r->gone || !other;
}

static void drop_stubs(emitting *e)
{
    const double most = 0.6 * e->s->spacing;
    for (int32_t i = 0; i < e->r->run.n; i++) {
        quilt_run *r = &e->r->run.v[i];
        for (int side = 0; side < 2 && !r->gone; side++)
            if (loose(e, r, side))
                retract(e, r, side, most);
    }
}

/* ---- discrete elements --------------------------------------------------------------- */

typedef struct placing {
    tz_grid grid; /* of what is there */
    double most;  /* largest radius */
    TZ_ARRAY(int32_t)
    patch; /* whose each of them is */
} placing;

/* Whether an element comes as near to others only as those of one patch do. */
static bool has_room(const emitting *e, const placing *q, int32_t patch, tz_vec2 at,
                     double radius)
{
    enum { MOST = 64 };
    int32_t near[MOST];
    const int32_t n = tz_grid_query(&q->grid, at, 2 * q->most, near, MOST);
    bool room = true;
    for (int32_t j = 0; j < (n < MOST ? n : MOST) && room && q->patch.v; j++) {
        const tz_element *y = &e->out->element.element.v[near[j]];
        const tz_vec3 v = tz_domain_vector(e->m->domain, y->at, (tz_vec3){at.x, at.y, 0});
        room = q->patch.v[near[j]] == patch ||
               hypot(v.x, v.y) >= 0.85 * (radius + y->radius);
    }
    return room;
}

/* Element i where a patch has it, if that is the patch's own place. On an exemplar that is
 * a torus: each of its copies. */
static tz_status put_element(emitting *e, placing *q, int32_t patch, int32_t i)
{
    const quilt_source *s = e->s;
    const quilt_patch *p = &e->m->patch.v[patch];
    const tz_element_set *from = &s->original->element;
    const tz_element *x = &from->element.v[i];
    const tz_vec3 size = s->original->domain.size;
    const int copies = s->original->domain.torus ? 3 : 1;
    tz_status st = TZ_OK;
    for (int c = 0; c < copies * copies && st == TZ_OK; c++) {
        int32_t id;
        const tz_vec2 in = {x->at.x + c % copies * size.x,
                            x->at.y + (double)(c / copies) * size.y},
                      at = quilt_place_at(p, in);
        if (quilt_label(e->m, at) != patch || !has_room(e, q, patch, at, x->radius))
            continue;
        if (copies > 1 && (fabs(in.x - p->from.x) > p->half.x + s->coarse ||
                           fabs(in.y - p->from.y) > p->half.y + s->coarse))
            continue; /* around a torus the same cell may be seen twice */
        st = tz_element_set_place(&e->out->element, from, i,
                                  (tz_vec3){at.x, at.y, x->at.z}, p->angle, 1);
        if (st == TZ_OK)
            st = tz_grid_add(e->ctx, &q->grid, at, &id);
        if (st == TZ_OK)
            st = tz_array_push(e->ctx, &q->patch, patch);
    }
    return st;
}

static tz_status put_elements(emitting *e)
{
    const tz_element_set *from = &e->s->original->element;
    const tz_vec3 size = e->m->domain->size;
    placing q = {.most = 0};
    for (int32_t i = 0; i < from->element.n; i++)
        q.most = fmax(q.most, from->element.v[i].radius);
    if (from->element.n == 0 || !(q.most > 0))
        return TZ_OK;
    tz_status st =
        tz_grid_init(e->ctx, &q.grid, (tz_vec2){0, 0}, (tz_vec2){size.x, size.y},
                     fmin(2 * q.most, fmin(size.x, size.y)), e->m->domain->torus);
    for (int32_t k = 0; k < e->m->patch.n && st == TZ_OK; k++)
        for (int32_t i = 0; i < from->element.n && st == TZ_OK; i++)
            if (e->m->patch.v[k].half.x > 0 && tz_element_may_copy(&from->element.v[i]))
                st = put_element(e, &q, k, i);
    tz_grid_deinit(e->ctx, &q.grid);
    tz_array_free(e->ctx, &q.patch);
    return st;
}

/* ---- all of it ---------------------------------------------------------------------- */

/* Nodes that no piece ends at go away. */
static tz_status drop_nodes(emitting *e)
{
    tz_curve_set *o = e->out;
    int32_t *to = NULL, n = 0;
    const tz_status st = tz_alloc_zero(e->ctx, &to, (size_t)o->node.n, sizeof *to);
    if (st != TZ_OK)
        return st;
    for (int32_t i = 0; i < o->piece.n; i++)
        to[o->piece.v[i].from] = to[o->piece.v[i].to] = 1;
    for (int32_t i = 0; i < o->node.n; i++) {
        if (!to[i])
            continue;
        o->node.v[n] = o->node.v[i];
        to[i] = n++;
    }
    o->node.n = n;
    for (int32_t i = 0; i < o->piece.n; i++) {
        o->piece.v[i].from = to[o->piece.v[i].from];
        o->piece.v[i].to = to[o->piece.v[i].to];
    }
    tz_free(e->ctx, to);
    return TZ_OK;
}

static tz_status begin(emitting *e)
{
    uint64_t size = 64;
    while (size < 2 * ((uint64_t)e->r->part.n * 2 + 16))
        size *= 2;
    e->mask = size - 1;
    tz_status st = quilt_warp_init(e->ctx, e->s, e->m, e->r, &e->warp);
    if (st == TZ_OK)
        st = tz_alloc(e->ctx, &e->table, (size_t)size, sizeof *e->table);
    if (st == TZ_OK)
        st = tz_alloc_zero(e->ctx, &e->seen, (size_t)e->r->run.n, sizeof *e->seen);
    if (st == TZ_OK)
        st = tz_alloc(e->ctx, &e->node, (size_t)e->r->cut.n, sizeof *e->node);
    for (uint64_t i = 0; i < size && st == TZ_OK; i++)
        e->table[i].id = -1;
    for (int32_t i = 0; i < e->r->cut.n && st == TZ_OK; i++)
        e->node[i] = -1;
    return st;
}

tz_status quilt_emit(tz_ctx *ctx, const quilt_source *s, const quilt_map *m,
                     quilt_runs *r, uint64_t seed, tz_curve_set *out)
{
    emitting e = {.ctx = ctx, .s = s, .m = m, .r = r, .out = out};
    (void)seed;
    tz_status st = tz_curve_set_like(ctx, s->original, m->domain, out);
    if (st == TZ_OK)
        st = begin(&e);
    if (st == TZ_OK)
        drop_stubs(&e);
    for (int32_t i = 0; i < r->run.n && st == TZ_OK; i++)
        if (!e.seen[i] && !r->run.v[i].gone && r->run.v[i].parts > 0)
            st = put_chain(&e, i);
    if (st == TZ_OK)
        st = put_elements(&e);
    if (st == TZ_OK)
        st = drop_nodes(&e);
    quilt_warp_deinit(&e.warp);
    tz_free(ctx, e.table);
    tz_free(ctx, e.seen);
    tz_free(ctx, e.node);
    if (st != TZ_OK) {
        tz_curve_set_deinit(out);
        memset(out, 0, sizeof *out);
    }
    return st;
}
