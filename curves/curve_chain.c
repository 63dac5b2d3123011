/* SPDX-License-Identifier: Apache-2.0 */
/* Pieces chained to paths: those of one path stay together; at a node of two ends of one
 * pen these run on into each other, elsewhere the two that do so straightest, within
 * pi / 9. */
#include <string.h>

#include "curves/curve_join_internal.h"

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
        tz_curve_carry carry = tz_curve_carried(c->s, end >> 1);
        if (end & 1) {
            p = tz_curve_reversed(c->s, &p);
            carry = tz_curve_carry_back(&carry);
        }
        done[end >> 1] = true;
        s = tz_curve_add_piece(to, &p, &carry);
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

tz_status tz_curve_chain(tz_ctx *ctx, const tz_curve_set *s, const bool *gone,
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

/* ---- pieces moved ------------------------------------------------------------------ */

void tz_curve_put(const tz_curve_set *s, const tz_bezier *c, const int32_t node[2],
                  tz_curve_piece *p)
{
    const tz_vec2 from = s->node.v[node[0]], to = s->node.v[node[1]],
                  by = tz_vec2_sub(from, c->p[0]);
    const tz_vec2 near = tz_curve_copy(&s->domain, from, c->p[0]),
                  over = tz_vec2_sub(from, near); /* to another copy of all */
    const tz_vec2 end = tz_vec2_add(tz_curve_copy(&s->domain, to, c->p[3]), over);
    p->from = node[0];
    p->to = node[1];
    p->a = tz_vec2_add(c->p[1], by);
    p->b = tz_vec2_add(c->p[2], tz_vec2_sub(end, c->p[3]));
    if (p->straight) {
        const tz_bezier rough = tz_bezier_line(from, end);
        const tz_bezier line =
            tz_bezier_line(from, tz_curve_copy(&s->domain, to, rough.p[2]));
        p->a = line.p[1], p->b = line.p[2];
    }
}

void tz_curve_move_piece(tz_curve_set *s, int32_t i, int32_t j)
{
    s->piece.v[j] = s->piece.v[i];
    if (s->taper.n > 0)
        s->taper.v[j] = s->taper.v[i];
    if (s->origin.n > 0)
        s->origin.v[j] = s->origin.v[i];
}
