/* SPDX-License-Identifier: Apache-2.0 */
/* Crossings become crossings again. To finish curves, every crossing is made a node, which
 * cuts both lines there; a drawing of a thousand long segments so gets hundreds of thousands
 * of pieces. Afterwards a node that was not there before, where no line ends and each one
 * that runs through it is cut out of one cubic, is taken out: two cubics are the parts 0 .. t
 * and t .. 1 of a third (de Casteljau, backwards) whose handles are theirs over t and 1 - t,
 * if its parts are theirs again. */
#include "curves/finish_internal.h"

typedef struct releasing {
    tz_curve_set *s;
    double same;
    bool *held; /* per node: it stays */
} releasing;

/* A piece, or some that have been put together. */
typedef struct run {
    int32_t from, to;
    tz_bezier c;
    tz_curve_carry carry;
    bool straight;
} run;

static run run_of(const tz_curve_set *s, int32_t piece)
{
    const tz_curve_piece *p = &s->piece.v[piece];
    return (run){p->from, p->to, tz_curve_bezier(s, p), tz_curve_carried(s, piece),
                 p->straight};
}

static bool alike(const tz_bezier *a, const tz_bezier *b, double same)
{
    for (int k = 0; k < 4; k++)
        if (!(tz_vec2_length(tz_vec2_sub(a->p[k], b->p[k])) <= same))
            return false;
    return true;
}

/* The cubic that a and b are of, cut at t. */
static bool whole_of(const tz_bezier *a, const tz_bezier *b, double t, double same,
                     tz_bezier *out)
{
    const tz_vec2 u = tz_vec2_sub(a->p[1], a->p[0]), v = tz_vec2_sub(b->p[2], b->p[3]);
    *out = (tz_bezier){{a->p[0], tz_vec2_add(a->p[0], tz_vec2_scale(u, 1 / t)),
                        tz_vec2_add(b->p[3], tz_vec2_scale(v, 1 / (1 - t))), b->p[3]}};
    const tz_bezier head = tz_bezier_part(out, 0, t), tail = tz_bezier_part(out, t, 1);
    return alike(&head, a, same) && alike(&tail, b, same);
}

/* What both carry is that of one. */
static bool carry_of(const run *a, const run *b, double t, double same, run *out)
{
    const tz_curve_carry *p = &a->carry, *q = &b->carry;
    const bool bare = isnan(p->origin.p[0].x);
    out->carry = *p;
    out->carry.taper.to = q->taper.to;
    if (p->has_origin &&
        (bare != (bool)isnan(q->origin.p[0].x) ||
         (!bare && !whole_of(&p->origin, &q->origin, t, same, &out->carry.origin))))
        return false;
    if (!p->has_taper)
        return true;
    const tz_curve_carry head = tz_curve_carry_part(&out->carry, &out->c, 0, t);
    return fabs(head.taper.to - p->taper.to) <= same &&
           fabs(p->taper.to - q->taper.from) <= same;
}

/* b behind a, as one; false if they are not. */
static bool put_together(const releasing *r, const run *a, const run *b, run *out)
{
    const tz_domain *d = &r->s->domain;
    const tz_vec2 by = tz_vec2_sub(a->c.p[3], b->c.p[0]); /* copies of a torus */
    tz_bezier next = b->c;
    for (int k = 0; k < 4; k++)
        next.p[k] = tz_vec2_add(next.p[k], by);
    const int at = a->straight ? 0 : 2, to = a->straight ? 3 : 1;
    const double before = tz_vec2_length(tz_vec2_sub(a->c.p[3], a->c.p[at])),
                 behind = tz_vec2_length(tz_vec2_sub(next.p[to], next.p[0])),
                 t = before / (before + behind);
    *out = (run){.from = a->from, .to = b->to, .straight = a->straight};
    if (a->straight != b->straight || !(t > 0 && t < 1) ||
        !whole_of(&a->c, &next, t, r->same, &out->c))
        return false;
    if (out->straight)
        out->c = tz_bezier_line(out->c.p[0], out->c.p[3]);
    /* its end is to be found again: on a torus it is the copy nearest to its handle */
    const tz_vec2 end = tz_curve_copy(d, r->s->node.v[out->to], out->c.p[2]);
    return tz_vec2_length(tz_vec2_sub(end, out->c.p[3])) <= r->same &&
           carry_of(a, b, t, r->same, out);
}

/* Nodes that lie where there were any before. */
static tz_status hold_old(releasing *r, const tz_curve_set *before, double reach)
{
    const tz_domain *d = &r->s->domain;
    const double cell = fmax(
        reach, sqrt(d->size.x * d->size.y / (before->node.n > 0 ? before->node.n : 1)));
    tz_grid g = {0};
    int32_t id;
    tz_status st = tz_grid_init(r->s->ctx, &g, (tz_vec2){0, 0},
                                (tz_vec2){d->size.x, d->size.y}, cell, d->torus);
    for (int32_t i = 0; i < before->node.n && st == TZ_OK; i++)
        st = tz_grid_add(r->s->ctx, &g, before->node.v[i], &id);
    for (int32_t i = 0; i < r->s->node.n && st == TZ_OK; i++)
        r->held[i] = tz_grid_query(&g, r->s->node.v[i], reach, &id, 1) > 0;
    tz_grid_deinit(r->s->ctx, &g);
    return st;
}

/* Nodes at which a path ends, or does not run straight through. */
static void hold_ends(releasing *r)
{
    const tz_curve_set *s = r->s;
    run whole;
    for (int32_t i = 0; i < s->path.n; i++) {
        const tz_curve_path *p = &s->path.v[i];
        const int32_t end = p->piece + p->pieces;
        r->held[s->piece.v[p->piece].from] = r->held[s->piece.v[end - 1].to] = true;
        for (int32_t k = p->piece; k + 1 < end; k++) {
            const int32_t node = s->piece.v[k].to;
            if (r->held[node])
                continue;
            const run a = run_of(s, k), b = run_of(s, k + 1);
            r->held[node] = !put_together(r, &a, &b, &whole);
        }
    }
}

static void store(tz_curve_set *s, const run *x, int32_t at)
{
    s->piece.v[at] = (tz_curve_piece){x->from, x->to, x->c.p[1], x->c.p[2], x->straight};
    if (x->carry.has_taper)
        s->taper.v[at] = x->carry.taper;
    if (x->carry.has_origin)
        s->origin.v[at] = x->carry.origin;
}

/* Pieces through nodes that are not held become one, in place. */
static void merge(releasing *r)
{
    tz_curve_set *s = r->s;
    int32_t n = 0;
    for (int32_t i = 0; i < s->path.n; i++) {
        tz_curve_path *p = &s->path.v[i];
        const int32_t first = p->piece, end = first + p->pieces;
        run now = run_of(s, first), whole;
        p->piece = n;
        for (int32_t k = first + 1; k < end; k++) {
            const run next = run_of(s, k);
            const bool open = !r->held[now.to] && put_together(r, &now, &next, &whole);
            if (!open)
                store(s, &now, n++);
            now = open ? whole : next;
        }
        store(s, &now, n++);
        p->pieces = n - p->piece;
    }
    s->piece.n = n;
    s->taper.n = s->taper.n > 0 ? n : 0;
    s->origin.n = s->origin.n > 0 ? n : 0;
}

/* Nodes that no piece has any more go. */
static tz_status drop_nodes(tz_curve_set *s)
{
    int32_t *id = NULL, n = 0;
    const tz_status st = tz_alloc_zero(s->ctx, &id, (size_t)s->node.n, sizeof *id);
    if (st != TZ_OK)
        return st;
    for (int32_t i = 0; i < s->piece.n; i++)
        id[s->piece.v[i].from] = id[s->piece.v[i].to] = 1;
    for (int32_t i = 0; i < s->node.n; i++)
        if (id[i]) {
            s->node.v[n] = s->node.v[i];
            id[i] = n++;
        }
    s->node.n = n;
    for (int32_t i = 0; i < s->piece.n; i++) {
        s->piece.v[i].from = id[s->piece.v[i].from];
        s->piece.v[i].to = id[s->piece.v[i].to];
    }
    tz_free(s->ctx, id);
    return TZ_OK;
}

tz_status tz_finish_release(const tz_curve_set *before, double reach, double same,
                            tz_curve_set *s)
{
    releasing r = {.s = s, .same = same};
    tz_status st = tz_alloc_zero(s->ctx, &r.held, (size_t)s->node.n + 1, sizeof *r.held);
    if (st == TZ_OK)
        st = hold_old(&r, before, reach);
    if (st == TZ_OK) {
        hold_ends(&r);
        merge(&r);
        st = drop_nodes(s);
    }
    tz_free(s->ctx, r.held);
    return st;
}
