/* SPDX-License-Identifier: Apache-2.0 */
/* Joining paths, in four steps:
 *
 *   merge   nodes at one place become one; ends of paths also over a small gap
 *   cut     pieces are cut where nodes lie on them and where they cross (curve_cross.c)
 *   thin    of pieces that run together between the same nodes one stays: the first
 *   chain   what is left runs on to paths, as far as it does so plainly
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
    const tz_vec2 size = {fmax(hi.x - lo.x, reach), fmax(hi.y - lo.y, reach)};
    const double cell = fmax(reach, sqrt(size.x * size.y / fmax(s->node.n, 1)));
    tz_status st = tz_grid_init(w->ctx, &grid, lo, size, cell, false);
    for (int32_t i = 0; i < s->node.n && st == TZ_OK; i++) {
        double best = INFINITY;
        int32_t id;
        to[i] = i;
        if (ends_only && !w->end[i])
            continue;
        const int32_t n = tz_grid_query(&grid, s->node.v[i], reach, near, MOST);
        for (int32_t k = 0; k < (n < MOST ? n : MOST) && kept.v; k++) {
            const int32_t j = kept.v[near[k]];
            const double d = tz_vec2_length(tz_vec2_sub(s->node.v[i], s->node.v[j]));
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
    const tz_vec2 d = tz_vec2_sub(s->node.v[from], s->node.v[p->from]),
                  e = tz_vec2_sub(s->node.v[to], s->node.v[p->to]);
    p->from = from;
    p->to = to;
    p->a = tz_vec2_add(p->a, d);
    p->b = tz_vec2_add(p->b, e);
    if (p->straight) {
        const tz_bezier c = tz_bezier_line(s->node.v[from], s->node.v[to]);
        p->a = c.p[1], p->b = c.p[2];
    }
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
                s->piece.v[pieces++] = s->piece.v[k];
        p.piece = first;
        p.pieces = pieces - first;
        if (p.pieces > 0)
            s->path.v[paths++] = p;
    }
    s->piece.n = pieces;
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
static tz_status add_part(tz_curve_work *w, tz_curve_set *to, const tz_curve_piece *p,
                          const double t[2], const int32_t node[2])
{
    const tz_bezier whole = tz_curve_bezier(&w->set, p),
                    part = tz_bezier_part(&whole, t[0], t[1]);
    tz_curve_piece c = {node[0], node[1], part.p[1], part.p[2], p->straight};
    const tz_vec2 d = tz_vec2_sub(to->node.v[node[0]], part.p[0]),
                  e = tz_vec2_sub(to->node.v[node[1]], part.p[3]);
    c.a = tz_vec2_add(c.a, d);
    c.b = tz_vec2_add(c.b, e);
    if (c.straight) {
        const tz_bezier line = tz_bezier_line(to->node.v[node[0]], to->node.v[node[1]]);
        c.a = line.p[1], c.b = line.p[2];
    }
    if (vanishes(to, &c, 2 * w->reach))
        return TZ_OK;
    to->path.v[to->path.n - 1].pieces++;
    return tz_array_push(w->ctx, &to->piece, c);
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
                st = add_part(w, to, &s->piece.v[k], t, node);
                t[0] = t[1], node[0] = node[1];
            }
            t[1] = 1, node[1] = s->piece.v[k].to;
            if (st == TZ_OK)
                st = add_part(w, to, &s->piece.v[k], t, node);
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
        ahead = ahead && tz_vec2_length(tz_vec2_sub(p, q)) <= same;
        back = back && tz_vec2_length(tz_vec2_sub(p, r)) <= same;
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
    for (int32_t i = 1; i < s->piece.n; i++)
        for (int32_t j = i - 1; j >= 0 && i - j <= MOST && e[j].low == e[i].low &&
                                e[j].high == e[i].high && !gone[e[i].piece];
             j--)
            gone[e[i].piece] =
                !gone[e[j].piece] && coincide(s, e[i].piece, e[j].piece, same);
    tz_free(w->ctx, e);
    return TZ_OK;
}

/* ---- chain ------------------------------------------------------------------------- */

/* Ends of pieces: 2 i is where piece i begins, 2 i + 1 where it ends. */
typedef struct chains {
    tz_ctx *ctx;
    const tz_curve_set *s;
    const bool *gone;
    int32_t *pen;  /* per piece */
    int32_t *next; /* per end: the end of another piece that it runs on to, or -1 */
    int32_t *first, *end; /* ends at each node */
} chains;

static int32_t node_of(const tz_curve_set *s, int32_t end)
{
    return end & 1 ? s->piece.v[end >> 1].to : s->piece.v[end >> 1].from;
}

/* Direction in which a piece leaves its end. */
static tz_vec2 leaving(const tz_curve_set *s, int32_t end)
{
    const tz_bezier c = tz_curve_bezier(s, &s->piece.v[end >> 1]);
    for (int k = 1; k < 4; k++) {
        const tz_vec2 d =
            end & 1 ? tz_vec2_sub(c.p[3 - k], c.p[3]) : tz_vec2_sub(c.p[k], c.p[0]);
        const double n = tz_vec2_length(d);
        if (n > 0)
            return tz_vec2_scale(d, 1 / n);
    }
    return (tz_vec2){1, 0};
}

static tz_status list_ends(chains *c)
{
    const int32_t n = c->s->node.n, ends = 2 * c->s->piece.n;
    tz_status s = tz_alloc_zero(c->ctx, &c->first, (size_t)n + 2, sizeof *c->first);
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &c->end, (size_t)ends, sizeof *c->end);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < ends; i++)
        if (!c->gone[i >> 1])
            c->first[node_of(c->s, i) + 2]++;
    for (int32_t i = 2; i < n + 2; i++)
        c->first[i] += c->first[i - 1];
    for (int32_t i = 0; i < ends; i++)
        if (!c->gone[i >> 1])
            c->end[c->first[node_of(c->s, i) + 1]++] = i;
    return TZ_OK;
}

static void link_ends(chains *c, int32_t i, int32_t j)
{
    c->next[i] = j;
    c->next[j] = i;
}

/* Paths that were there run on as they did, where both pieces stay. */
static void keep_paths(chains *c)
{
    for (int32_t i = 0; i < c->s->path.n; i++) {
        const tz_curve_path *p = &c->s->path.v[i];
        for (int32_t k = p->piece; k < p->piece + p->pieces; k++) {
            const bool last = k == p->piece + p->pieces - 1;
            const int32_t j = last ? p->piece : k + 1;
            if ((last && !p->closed) || c->gone[k] || c->gone[j] ||
                c->s->piece.v[k].to != c->s->piece.v[j].from)
                continue;
            link_ends(c, 2 * k + 1, 2 * j);
        }
    }
}

/* The two free ends at a node that run on straightest, within pi / 9; or, if there are
 * but two ends, those. False if there are none. */
static bool best_pair(const chains *c, int32_t node, int32_t out[2])
{
    enum { MOST = 64 };
    const int32_t first = c->first[node], n = c->first[node + 1] - first;
    double best = -cos(TZ_PI / 9);
    int32_t free_ends[MOST], m = 0;
    bool found = false;
    for (int32_t i = first; i < first + n && m < MOST; i++)
        if (c->next[c->end[i]] < 0)
            free_ends[m++] = c->end[i];
    if (n == 2 && m == 2 && c->pen[free_ends[0] >> 1] == c->pen[free_ends[1] >> 1]) {
        out[0] = free_ends[0], out[1] = free_ends[1];
        return true;
    }
    for (int32_t i = 0; i < m; i++)
        for (int32_t j = i + 1; j < m; j++) {
            if (c->pen[free_ends[i] >> 1] != c->pen[free_ends[j] >> 1])
                continue;
            const double dot =
                tz_vec2_dot(leaving(c->s, free_ends[i]), leaving(c->s, free_ends[j]));
            if (dot < best) {
                best = dot;
                out[0] = free_ends[i], out[1] = free_ends[j];
                found = true;
            }
        }
    return found;
}

/* Appends the chain that begins at an end, going inwards. */
static tz_status add_chain(chains *c, int32_t begin, bool *done, tz_curve_set *to)
{
    tz_status s =
        tz_array_push(c->ctx, &to->path,
                      ((tz_curve_path){.piece = to->piece.n, .pen = c->pen[begin >> 1]}));
    for (int32_t end = begin; end >= 0 && !done[end >> 1] && s == TZ_OK;
         end = c->next[end ^ 1]) {
        tz_curve_piece p = c->s->piece.v[end >> 1];
        if (end & 1) {
            const tz_curve_piece q = p;
            p = (tz_curve_piece){q.to, q.from, q.b, q.a, q.straight};
            if (p.straight) {
                const tz_bezier b =
                    tz_bezier_line(c->s->node.v[p.from], c->s->node.v[p.to]);
                p.a = b.p[1], p.b = b.p[2];
            }
        }
        done[end >> 1] = true;
        s = tz_array_push(c->ctx, &to->piece, p);
        to->path.v[to->path.n - 1].pieces++;
    }
    return s;
}

static tz_status make_chains(chains *c, bool *done, tz_curve_set *to)
{
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < c->s->piece.n && s == TZ_OK; i++) {
        if (c->gone[i] || done[i])
            continue;
        int32_t begin = 2 * i; /* back to where the chain begins, or all the way around */
        while (c->next[begin] >= 0 && c->next[begin] >> 1 != i)
            begin = c->next[begin] ^ 1;
        const bool around = c->next[begin] >= 0;
        s = add_chain(c, around ? 2 * i : begin, done, to);
        if (s == TZ_OK)
            tz_curve_end(to, around);
    }
    return s;
}

/* Nodes in order of first use, none left over. */
static tz_status compact(tz_curve_set *s)
{
    int32_t *to = NULL, n = 0;
    tz_vec2 *node = NULL;
    tz_status st = tz_alloc(s->ctx, &to, (size_t)s->node.n, sizeof *to);
    if (st == TZ_OK)
        st = tz_alloc(s->ctx, &node, (size_t)s->node.n, sizeof *node);
    if (st == TZ_OK) {
        memset(to, 255, (size_t)s->node.n * sizeof *to);
        for (int32_t i = 0; i < 2 * s->piece.n; i++) {
            int32_t *id = i & 1 ? &s->piece.v[i >> 1].to : &s->piece.v[i >> 1].from;
            if (to[*id] < 0) {
                node[n] = s->node.v[*id];
                to[*id] = n++;
            }
            *id = to[*id];
        }
        if (n > 0)
            memcpy(s->node.v, node, (size_t)n * sizeof *node);
        s->node.n = n;
    }
    tz_free(s->ctx, to);
    tz_free(s->ctx, node);
    return st;
}

/* The pieces of `s` that are not gone as paths of `to`, which has its nodes. */
static tz_status chain(tz_ctx *ctx, const tz_curve_set *s, const bool *gone,
                       bool keep_ends, tz_curve_set *to)
{
    chains c = {.ctx = ctx, .s = s, .gone = gone};
    bool *done = NULL;
    int32_t pair[2];
    const size_t n = (size_t)s->piece.n;
    tz_status st = tz_alloc(ctx, &c.pen, n, sizeof *c.pen);
    if (st == TZ_OK)
        st = tz_alloc(ctx, &c.next, 2 * n, sizeof *c.next);
    if (st == TZ_OK)
        st = tz_alloc_zero(ctx, &done, n, sizeof *done);
    if (st == TZ_OK)
        st = list_ends(&c);
    if (st == TZ_OK) {
        memset(c.next, 255, 2 * n * sizeof *c.next);
        for (int32_t i = 0; i < s->path.n; i++)
            for (int32_t k = 0; k < s->path.v[i].pieces; k++)
                c.pen[s->path.v[i].piece + k] = s->path.v[i].pen;
        keep_paths(&c);
        for (int32_t i = 0; i < s->node.n && !keep_ends; i++)
            while (best_pair(&c, i, pair))
                link_ends(&c, pair[0], pair[1]);
        st = make_chains(&c, done, to);
    }
    tz_free(ctx, c.pen);
    tz_free(ctx, c.next);
    tz_free(ctx, c.first);
    tz_free(ctx, c.end);
    tz_free(ctx, done);
    return st == TZ_OK ? compact(to) : st;
}

/* ---- all --------------------------------------------------------------------------- */

static tz_status copy_paths(tz_ctx *ctx, const tz_curve_set *from, tz_curve_set *to)
{
    tz_status s = tz_array_reserve(ctx, &to->node, from->node.n);
    if (s == TZ_OK)
        s = tz_array_reserve(ctx, &to->piece, from->piece.n);
    if (s == TZ_OK)
        s = tz_array_reserve(ctx, &to->path, from->path.n);
    if (s != TZ_OK || from->path.n == 0)
        return s;
    memcpy(to->node.v, from->node.v, (size_t)from->node.n * sizeof *to->node.v);
    memcpy(to->piece.v, from->piece.v, (size_t)from->piece.n * sizeof *to->piece.v);
    memcpy(to->path.v, from->path.v, (size_t)from->path.n * sizeof *to->path.v);
    to->node.n = from->node.n;
    to->piece.n = from->piece.n;
    to->path.n = from->path.n;
    return TZ_OK;
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
    if (s == TZ_OK && w.set.path.n > 0)
        s = merge_and_cut(&w, &cut);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &gone, (size_t)cut.piece.n, sizeof *gone);
    if (s == TZ_OK && !p->only_chain)
        s = find_twice(&w, &cut, gone);
    for (int32_t i = 0; i < cut.node.n && s == TZ_OK; i++)
        s = tz_array_push(ctx, &out.node, cut.node.v[i]);
    if (s == TZ_OK)
        s = chain(ctx, &cut, gone, p->keep_ends, &out);
    tz_free(ctx, gone);
    tz_curve_set_deinit(&w.set);
    tz_curve_set_deinit(&cut);
    if (s == TZ_OK)
        *to = out;
    else
        tz_curve_set_deinit(&out);
    return s;
}
