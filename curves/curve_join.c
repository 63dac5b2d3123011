/* SPDX-License-Identifier: Apache-2.0 */
/* Joining paths, in four steps:
 *
 *   merge   nodes at one place become one; ends of paths also over a small gap
 *   cut     pieces are cut where nodes lie on them and where they cross (curve_cross.c)
 *   thin    of pieces that run together between the same nodes one stays: the first
 *   chain   what is left runs on to paths, as far as it does so plainly (curve_chain.c)
 *
 * On a torus places are told apart by their nearest copies.
 *
 * Everything is in order of the pieces, so that equal input gives equal output. */
#include "curves/curve_join.h"

#include <stdlib.h>
#include <string.h>

#include "curves/curve_join_internal.h"

/* ---- sizes ------------------------------------------------------------------------ */

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double diagonal(const tz_curve_set *s)
{
    return hypot(s->domain.size.x, s->domain.size.y);
}

double tz_curve_reach(const tz_curve_set *s)
{
    double *width = NULL, reach = 0;
    const double most = 0.01 * diagonal(s);
    if (s->path.n == 0 ||
        tz_alloc(NULL, &width, (size_t)s->path.n, sizeof *width) != TZ_OK)
        return most / 10;
    for (int32_t i = 0; i < s->path.n; i++)
        width[i] = s->pen.v[s->path.v[i].pen].width;
    qsort(width, (size_t)s->path.n, sizeof *width, by_value);
    reach = width[s->path.n / 2] / 2;
    tz_free(NULL, width);
    return fmin(reach, most);
}

/* ---- merge ------------------------------------------------------------------------ */

static void mark_ends(tz_curve_work *w)
{
    const tz_curve_set *s = &w->set;
    memset(w->end, 0, (size_t)s->node.n * sizeof *w->end);
    for (int32_t i = 0; i < s->path.n; i++)
        if (!s->path.v[i].closed) {
            const tz_curve_path *p = &s->path.v[i];
            w->end[s->piece.v[p->piece].from] = true;
            w->end[s->piece.v[p->piece + p->pieces - 1].to] = true;
        }
}

/* Nodes near each other share one: the nearest of those that came before and stay. */
static tz_status find_same(tz_curve_work *w, double reach, bool ends_only, int32_t *to)
{
    enum { MOST = 64 };
    const tz_curve_set *s = &w->set;
    tz_vec2 lo = {INFINITY, INFINITY}, hi = {-INFINITY, -INFINITY};
    tz_grid grid = {0};
    int32_t near[MOST];
    TZ_ARRAY(int32_t)
    kept = {0};
    for (int32_t i = 0; i < s->node.n; i++) {
        const tz_vec2 p = s->node.v[i];
        lo = (tz_vec2){fmin(lo.x, p.x), fmin(lo.y, p.y)};
        hi = (tz_vec2){fmax(hi.x, p.x), fmax(hi.y, p.y)};
    }
    const bool torus = s->domain.torus;
    tz_vec2 size = {fmax(hi.x - lo.x, reach), fmax(hi.y - lo.y, reach)};
    if (torus)
        lo = (tz_vec2){0, 0}, size = (tz_vec2){s->domain.size.x, s->domain.size.y};
    const double cell = fmax(reach, sqrt(size.x * size.y / fmax(s->node.n, 1)));
    tz_status st = tz_grid_init(w->ctx, &grid, lo, size, cell, torus);
    for (int32_t i = 0; i < s->node.n && st == TZ_OK; i++) {
        double best = INFINITY;
        int32_t id;
        to[i] = i;
        if (ends_only && !w->end[i])
            continue;
        const int32_t n = tz_grid_query(&grid, s->node.v[i], reach, near, MOST);
        for (int32_t k = 0; k < (n < MOST ? n : MOST) && kept.v; k++) {
            const int32_t j = kept.v[near[k]];
            const double d = tz_curve_apart(s, s->node.v[i], s->node.v[j]);
            if (d < best) {
                best = d;
                to[i] = j;
            }
        }
        if (to[i] != i)
            continue;
        st = tz_array_push(w->ctx, &kept, i);
        if (st == TZ_OK)
            st = tz_grid_add(w->ctx, &grid, s->node.v[i], &id);
    }
    tz_grid_deinit(w->ctx, &grid);
    tz_array_free(w->ctx, &kept);
    return st;
}

/* Ends of a piece are other nodes now: its control points go along. */
static void reattach(tz_curve_set *s, tz_curve_piece *p, int32_t from, int32_t to)
{
    const tz_bezier c = tz_curve_bezier(s, p);
    tz_curve_put(s, &c, (int32_t[2]){from, to}, p);
}

/* Shrinks a piece to a node. */
static void collapse(const tz_curve_set *s, tz_curve_piece *p, int32_t node)
{
    p->from = p->to = node;
    p->a = p->b = s->node.v[node];
}

/* Whether a piece returns to its node without getting farther off than `least`. */
static bool vanishes(const tz_curve_set *s, const tz_curve_piece *p, double least)
{
    const tz_vec2 q = s->node.v[p->from];
    return p->from == p->to && tz_vec2_length(tz_vec2_sub(p->a, q)) <= least &&
           tz_vec2_length(tz_vec2_sub(p->b, q)) <= least;
}

/* Drops pieces that have shrunk to a point, and paths that have no others. */
static void drop_points(tz_curve_work *w)
{
    tz_curve_set *s = &w->set;
    int32_t pieces = 0, paths = 0;
    for (int32_t i = 0; i < s->path.n; i++) {
        tz_curve_path p = s->path.v[i];
        const int32_t first = pieces;
        for (int32_t k = p.piece; k < p.piece + p.pieces; k++)
            if (!vanishes(s, &s->piece.v[k], 2 * w->same))
                tz_curve_move_piece(s, k, pieces++);
        p.piece = first;
        p.pieces = pieces - first;
        if (p.pieces > 0)
            s->path.v[paths++] = p;
    }
    s->piece.n = pieces;
    s->taper.n = s->taper.n > 0 ? pieces : 0;
    s->origin.n = s->origin.n > 0 ? pieces : 0;
    s->path.n = paths;
}

static void measure(tz_curve_work *w)
{
    const tz_curve_set *s = &w->set;
    for (int32_t i = 0; i < s->path.n; i++) {
        double along = 0;
        for (int32_t k = 0; k < s->path.v[i].pieces; k++) {
            const int32_t at = s->path.v[i].piece + k;
            const tz_bezier b = tz_curve_bezier(s, &s->piece.v[at]);
            w->along[at] = along;
            w->path[at] = i;
            along += tz_bezier_length(&b);
        }
    }
}

static tz_status merge_nodes(tz_curve_work *w, double reach, bool ends_only)
{
    tz_curve_set *s = &w->set;
    int32_t *to = NULL;
    tz_status st = tz_alloc(w->ctx, &to, (size_t)s->node.n, sizeof *to);
    if (st == TZ_OK)
        st = find_same(w, reach, ends_only, to);
    for (int32_t i = 0; i < s->path.n && st == TZ_OK; i++) {
        const tz_curve_path *p = &s->path.v[i];
        const int32_t last = p->piece + p->pieces - 1;
        const tz_bezier b = tz_curve_bezier(s, &s->piece.v[last]);
        const int32_t from = s->piece.v[p->piece].from, end = s->piece.v[last].to;
        const double length = w->along[last] + tz_bezier_length(&b);
        if (ends_only && !p->closed && to[from] == to[end] && length < 4 * reach) {
            /* a dot stays; what bridges nothing but a gap that is closed goes */
            const bool alone = to[from] == from || to[from] == end;
            for (int32_t k = p->piece; k <= last && !alone; k++)
                collapse(s, &s->piece.v[k], to[from]);
            continue;
        }
        for (int32_t k = p->piece; k <= last; k++)
            reattach(s, &s->piece.v[k], to[s->piece.v[k].from], to[s->piece.v[k].to]);
        s->path.v[i].closed = s->piece.v[p->piece].from == s->piece.v[last].to;
    }
    tz_free(w->ctx, to);
    if (st != TZ_OK)
        return st;
    drop_points(w);
    mark_ends(w);
    measure(w);
    return TZ_OK;
}

/* ---- cut --------------------------------------------------------------------------- */

static int by_place(const void *a, const void *b)
{
    const tz_curve_cut *p = a, *q = b;
    if (p->piece != q->piece)
        return p->piece < q->piece ? -1 : 1;
    if (p->t != q->t)
        return p->t < q->t ? -1 : 1;
    return (p->node > q->node) - (p->node < q->node);
}

/* Appends the part t0 .. t1 of a piece between two nodes. */
static tz_status add_part(tz_curve_work *w, tz_curve_set *to, int32_t piece,
                          const double t[2], const int32_t node[2])
{
    const tz_curve_piece *p = &w->set.piece.v[piece];
    const tz_bezier whole = tz_curve_bezier(&w->set, p),
                    part = tz_bezier_part(&whole, t[0], t[1]);
    tz_curve_piece c = {.straight = p->straight};
    tz_curve_put(to, &part, node, &c);
    if (vanishes(to, &c, 2 * w->reach))
        return TZ_OK;
    tz_curve_carry carry = tz_curve_carried(&w->set, piece);
    if (t[0] > 0 || t[1] < 1)
        carry = tz_curve_carry_part(&carry, &whole, t[0], t[1]);
    return tz_curve_add_piece(to, &c, &carry);
}

/* The pieces of w->set, cut: `to` takes its nodes over. */
static tz_status cut_pieces(tz_curve_work *w, tz_curve_set *to)
{
    const tz_curve_set *s = &w->set;
    int32_t at = 0; /* of the cuts */
    tz_status st = TZ_OK;
    if (w->cut.n > 1)
        qsort(w->cut.v, (size_t)w->cut.n, sizeof *w->cut.v, by_place);
    for (int32_t i = 0; i < s->path.n && st == TZ_OK; i++) {
        const tz_curve_path *p = &s->path.v[i];
        st = tz_array_push(
            w->ctx, &to->path,
            ((tz_curve_path){.piece = to->piece.n, .pen = p->pen, .closed = p->closed}));
        for (int32_t k = p->piece; k < p->piece + p->pieces && st == TZ_OK; k++) {
            double t[2] = {0, 0};
            int32_t node[2] = {s->piece.v[k].from, 0};
            for (; at < w->cut.n && w->cut.v[at].piece == k && st == TZ_OK; at++) {
                t[1] = w->cut.v[at].t, node[1] = w->cut.v[at].node;
                st = add_part(w, to, k, t, node);
                t[0] = t[1], node[0] = node[1];
            }
            t[1] = 1, node[1] = s->piece.v[k].to;
            if (st == TZ_OK)
                st = add_part(w, to, k, t, node);
        }
        if (st == TZ_OK && to->path.v[to->path.n - 1].pieces == 0)
            to->path.n--;
    }
    return st;
}

/* ---- thin -------------------------------------------------------------------------- */

typedef struct ended {
    int32_t low, high, piece;
} ended;

static int by_ends(const void *a, const void *b)
{
    const ended *p = a, *q = b;
    if (p->low != q->low)
        return p->low < q->low ? -1 : 1;
    if (p->high != q->high)
        return p->high < q->high ? -1 : 1;
    return (p->piece > q->piece) - (p->piece < q->piece);
}

/* Whether pieces of the same ends run together. */
static bool coincide(const tz_curve_set *s, int32_t i, int32_t j, double same)
{
    const tz_bezier a = tz_curve_bezier(s, &s->piece.v[i]),
                    b = tz_curve_bezier(s, &s->piece.v[j]);
    bool ahead = s->piece.v[i].from == s->piece.v[j].from, back = !ahead;
    if (s->piece.v[i].from == s->piece.v[i].to)
        ahead = back = true;
    for (int k = 1; k < 4; k++) {
        const tz_vec2 p = tz_bezier_at(&a, k / 4.0), q = tz_bezier_at(&b, k / 4.0),
                      r = tz_bezier_at(&b, 1 - k / 4.0);
        ahead = ahead && tz_curve_apart(s, p, q) <= same;
        back = back && tz_curve_apart(s, p, r) <= same;
    }
    return ahead || back;
}

static tz_status find_twice(tz_curve_work *w, const tz_curve_set *s, bool *gone)
{
    enum { MOST = 64 }; /* rivals looked at */
    ended *e = NULL;
    const double same = fmax(w->reach / 2, w->same);
    tz_status st = tz_alloc(w->ctx, &e, (size_t)s->piece.n, sizeof *e);
    if (st != TZ_OK)
        return st;
    for (int32_t i = 0; i < s->piece.n; i++) {
        const tz_curve_piece *p = &s->piece.v[i];
        e[i] = (ended){p->from < p->to ? p->from : p->to,
                       p->from < p->to ? p->to : p->from, i};
    }
    if (s->piece.n > 1)
        qsort(e, (size_t)s->piece.n, sizeof *e, by_ends);
    int32_t first = 0,
            stay = 0; /* those of the same ends that stay, moved up to e[first] */
    for (int32_t i = 0; i < s->piece.n; i++) {
        const ended at = e[i];
        if (at.low != e[first].low || at.high != e[first].high)
            first = i, stay = 0;
        for (int32_t j = stay - 1; j >= 0 && stay - j <= MOST && !gone[at.piece]; j--)
            gone[at.piece] = coincide(s, at.piece, e[first + j].piece, same);
        if (!gone[at.piece])
            e[first + stay++] = at;
    }
    tz_free(w->ctx, e);
    return TZ_OK;
}

/* ---- all --------------------------------------------------------------------------- */

#define COPY(ctx, from, to, array)                                                      \
    (tz_array_reserve(ctx, &(to)->array, (from)->array.n) != TZ_OK ? TZ_NOMEM           \
     : (from)->array.n == 0                                        ? TZ_OK              \
                            : (memcpy((to)->array.v, (from)->array.v,                   \
                                      (size_t)(from)->array.n * sizeof *(to)->array.v), \
                               (to)->array.n = (from)->array.n, TZ_OK))

static tz_status copy_paths(tz_ctx *ctx, const tz_curve_set *from, tz_curve_set *to)
{
    tz_status s = COPY(ctx, from, to, node);
    if (s == TZ_OK)
        s = COPY(ctx, from, to, piece);
    if (s == TZ_OK)
        s = COPY(ctx, from, to, path);
    if (s == TZ_OK)
        s = COPY(ctx, from, to, taper);
    return s == TZ_OK ? COPY(ctx, from, to, origin) : s;
}

/* Steps one and two: w->set to `cut`, whose nodes are then those of w->set. */
static tz_status merge_and_cut(tz_curve_work *w, tz_curve_set *cut)
{
    tz_curve_set *s = &w->set;
    tz_status st = tz_alloc_zero(w->ctx, &w->end, (size_t)s->node.n, sizeof *w->end);
    if (st == TZ_OK)
        st = tz_alloc(w->ctx, &w->along, (size_t)s->piece.n, sizeof *w->along);
    if (st == TZ_OK)
        st = tz_alloc(w->ctx, &w->path, (size_t)s->piece.n, sizeof *w->path);
    if (st == TZ_OK)
        st = merge_nodes(w, w->same, false);
    if (st == TZ_OK)
        st = merge_nodes(w, w->reach, true);
    if (st == TZ_OK)
        st = tz_curve_find_cuts(w);
    for (int32_t i = 0; i < s->node.n && st == TZ_OK; i++)
        st = tz_array_push(w->ctx, &cut->node, s->node.v[i]);
    if (st == TZ_OK)
        st = cut_pieces(w, cut);
    tz_free(w->ctx, w->end);
    tz_free(w->ctx, w->along);
    tz_free(w->ctx, w->path);
    tz_array_free(w->ctx, &w->cut);
    return st;
}

tz_status tz_curve_join(tz_ctx *ctx, const tz_curve_set *from,
                        const tz_curve_join_params *p, tz_curve_set *to)
{
    const tz_curve_join_params plain = {0};
    p = p ? p : &plain;
    const double same = p->same > 0 ? p->same : 1e-6 * diagonal(from);
    const double reach = p->reach > 0 ? p->reach : tz_curve_reach(from);
    tz_curve_work w = {
        .ctx = ctx, .reach = fmax(reach, same), .same = same, .crossings = p->crossings};
    tz_curve_set cut = {.ctx = ctx}, out = {.ctx = ctx};
    bool *gone = NULL;
    memset(to, 0, sizeof *to);
    tz_status s = tz_curve_set_like(ctx, from, NULL, &w.set);
    if (s == TZ_OK)
        s = tz_curve_set_like(ctx, from, NULL, &out);
    if (s == TZ_OK)
        s = copy_paths(ctx, from, p->only_chain ? &cut : &w.set);
    cut.domain = from->domain;
    if (s == TZ_OK && w.set.path.n > 0)
        s = merge_and_cut(&w, &cut);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &gone, (size_t)cut.piece.n, sizeof *gone);
    if (s == TZ_OK && !p->only_chain)
        s = find_twice(&w, &cut, gone);
    for (int32_t i = 0; i < cut.node.n && s == TZ_OK; i++)
        s = tz_array_push(ctx, &out.node, cut.node.v[i]);
    if (s == TZ_OK)
        s = tz_curve_chain(ctx, &cut, gone, p->keep_ends, &out);
    tz_free(ctx, gone);
    tz_curve_set_deinit(&w.set);
    tz_curve_set_deinit(&cut);
    if (s == TZ_OK)
        *to = out;
    else
        tz_curve_set_deinit(&out);
    return s;
}
