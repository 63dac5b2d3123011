/* SPDX-License-Identifier: Apache-2.0 */
/* A torus as a plain drawing, from which patches are taken across its border: one period
 * and as much more as a patch is wide, in a margin of what things reach beyond that. Each
 * place of the torus is the middle of exactly one patch then. */
#include <string.h>

#include "curves/quilt_internal.h"

typedef struct shared {
    int32_t node, x, y; /* copy of a node */
    int32_t id;         /* -1 = free */
} shared;

typedef struct unrolling {
    tz_ctx *ctx;
    const tz_curve_set *from;
    tz_curve_set *to;
    tz_vec2 size;
    TZ_ARRAY(int32_t)
    origin;
    TZ_ARRAY(shared)
    table;
    int32_t used;
} unrolling;

static shared *find(unrolling *u, int32_t node, int32_t x, int32_t y)
{
    const uint64_t mask = (uint64_t)u->table.n - 1;
    uint64_t at =
        tz_rng_stream((uint64_t)node, (uint64_t)(uint32_t)x, (uint64_t)(uint32_t)y) &
        mask;
    for (;; at = (at + 1) & mask) {
        shared *t = &u->table.v[at];
        if (t->id < 0 || (t->node == node && t->x == x && t->y == y))
            return t;
    }
}

static tz_status grow(unrolling *u)
{
    const int32_t n = u->table.n ? 2 * u->table.n : 1024;
    unrolling old = *u;
    tz_status st = TZ_OK;
    memset(&u->table, 0, sizeof u->table);
    for (int32_t i = 0; i < n && st == TZ_OK; i++)
        st = tz_array_push(u->ctx, &u->table, ((shared){.id = -1}));
    for (int32_t i = 0; i < old.table.n && st == TZ_OK; i++) {
        const shared *t = &old.table.v[i];
        if (t->id >= 0)
            *find(u, t->node, t->x, t->y) = *t;
    }
    tz_array_free(u->ctx, &old.table);
    return st;
}

/* The copy of a node that lies at p. */
static tz_status node_of(unrolling *u, int32_t node, tz_vec2 p, int32_t *id)
{
    const tz_vec3 d = u->from->domain.size;
    const tz_vec2 at = u->from->node.v[node];
    const int32_t x = (int32_t)round((p.x - at.x) / d.x),
                  y = (int32_t)round((p.y - at.y) / d.y);
    tz_status st = TZ_OK;
    if (2 * u->used >= u->table.n)
        st = grow(u);
    if (st != TZ_OK)
        return st;
    shared *t = find(u, node, x, y);
    if (t->id < 0) {
        int32_t fresh;
        st = tz_curve_add_node(u->to, (tz_vec2){at.x + x * d.x, at.y + y * d.y}, &fresh);
        if (st != TZ_OK)
            return st;
        *t = (shared){node, x, y, fresh};
        u->used++;
    }
    *id = t->id;
    return TZ_OK;
}

static bool reaches(const unrolling *u, const tz_bezier *b)
{
    tz_vec2 lo = b->p[0], hi = b->p[0];
    for (int k = 1; k < 4; k++) {
        lo = (tz_vec2){fmin(lo.x, b->p[k].x), fmin(lo.y, b->p[k].y)};
        hi = (tz_vec2){fmax(hi.x, b->p[k].x), fmax(hi.y, b->p[k].y)};
    }
    return hi.x >= 0 && hi.y >= 0 && lo.x <= u->size.x && lo.y <= u->size.y;
}

static tz_status put_piece(unrolling *u, int32_t piece, const tz_bezier *b)
{
    const tz_curve_piece *from = &u->from->piece.v[piece];
    tz_curve_carry carry = tz_curve_carried(u->from, piece);
    tz_curve_piece p = {.a = b->p[1], .b = b->p[2], .straight = from->straight};
    carry.has_origin = false;
    tz_status st = node_of(u, from->from, b->p[0], &p.from);
    if (st == TZ_OK)
        st = node_of(u, from->to, b->p[3], &p.to);
    if (st == TZ_OK && p.straight) {
        const tz_bezier l = tz_bezier_line(u->to->node.v[p.from], u->to->node.v[p.to]);
        p.a = l.p[1];
        p.b = l.p[2];
    }
    if (st == TZ_OK)
        st = tz_curve_add_piece(u->to, &p, &carry);
    return st == TZ_OK ? tz_array_push(u->ctx, &u->origin, piece) : st;
}

/* One copy of a path: those of its pieces that reach the drawing. */
static tz_status put_copy(unrolling *u, const tz_curve_path *p, tz_vec2 by)
{
    bool open = false, whole = true;
    tz_status st = TZ_OK;
    for (int32_t k = p->piece; k < p->piece + p->pieces && st == TZ_OK; k++) {
        const tz_bezier b = tz_curve_through(u->from, &u->from->piece.v[k], &by);
        if (!reaches(u, &b)) {
            if (open)
                tz_curve_end(u->to, false);
            open = whole = false;
            continue;
        }
        if (!open)
            st = tz_curve_begin(u->to, p->pen);
        open = st == TZ_OK;
        if (st == TZ_OK)
            st = put_piece(u, k, &b);
    }
    if (open)
        tz_curve_end(u->to, whole && p->closed);
    return st;
}

static tz_status put_path(unrolling *u, const tz_curve_path *p)
{
    enum { MOST = 64 }; /* copies either way: paths may run around often */
    const tz_vec3 d = u->from->domain.size;
    tz_vec2 lo = {INFINITY, INFINITY}, hi = {-INFINITY, -INFINITY}, by = {0, 0};
    tz_status st = TZ_OK;
    for (int32_t k = p->piece; k < p->piece + p->pieces; k++) {
        const tz_bezier b = tz_curve_through(u->from, &u->from->piece.v[k], &by);
        for (int i = 0; i < 4; i++) {
            lo = (tz_vec2){fmin(lo.x, b.p[i].x), fmin(lo.y, b.p[i].y)};
            hi = (tz_vec2){fmax(hi.x, b.p[i].x), fmax(hi.y, b.p[i].y)};
        }
    }
    const int32_t x0 = (int32_t)fmax(-MOST, ceil(-hi.x / d.x)),
                  x1 = (int32_t)fmin(MOST, floor((u->size.x - lo.x) / d.x)),
                  y0 = (int32_t)fmax(-MOST, ceil(-hi.y / d.y)),
                  y1 = (int32_t)fmin(MOST, floor((u->size.y - lo.y) / d.y));
    for (int32_t y = y0; y <= y1; y++)
        for (int32_t x = x0; x <= x1 && st == TZ_OK; x++)
            st = put_copy(u, p, (tz_vec2){x * d.x, y * d.y});
    return st;
}

tz_status quilt_unroll(tz_ctx *ctx, const tz_curve_set *from, tz_vec2 size,
                       tz_curve_set *to, int32_t **origin)
{
    const tz_domain plain = {.size = {size.x, size.y, 0}};
    unrolling u = {.ctx = ctx, .from = from, .to = to, .size = size};
    tz_status st = tz_curve_set_like(ctx, from, &plain, to);
    for (int32_t i = 0; i < from->path.n && st == TZ_OK; i++)
        st = put_path(&u, &from->path.v[i]);
    tz_array_free(ctx, &u.table);
    if (st != TZ_OK) {
        tz_array_free(ctx, &u.origin);
        tz_curve_set_deinit(to);
        memset(to, 0, sizeof *to);
        return st;
    }
    *origin = u.origin.v;
    return TZ_OK;
}
