/* SPDX-License-Identifier: Apache-2.0 */
/* Edits of nets, and those which need no choice: crumbs go, of lines that run side by side
 * nearer than any in the exemplar one goes, junctions nearer to each other than any there
 * become one. */
#include <stdlib.h>
#include <string.h>

#include "curves/finish_internal.h"

/* ---- edits --------------------------------------------------------------------------- */

tz_status tz_net_edit_init(tz_net *n, tz_net_edit *e)
{
    const size_t pieces = (size_t)n->set.piece.n, nodes = (size_t)n->set.node.n;
    *e = (tz_net_edit){.net = n};
    tz_status s = tz_alloc_zero(n->ctx, &e->gone, pieces, sizeof *e->gone);
    if (s == TZ_OK)
        s = tz_alloc_zero(n->ctx, &e->used, pieces, sizeof *e->used);
    if (s == TZ_OK)
        s = tz_alloc(n->ctx, &e->merged, nodes, sizeof *e->merged);
    for (int32_t i = 0; i < n->set.node.n && s == TZ_OK; i++)
        e->merged[i] = i;
    return s;
}

void tz_net_edit_deinit(tz_net_edit *e)
{
    tz_ctx *ctx = e->net->ctx;
    tz_free(ctx, e->gone);
    tz_free(ctx, e->used);
    tz_free(ctx, e->kept);
    tz_free(ctx, e->merged);
    tz_array_free(ctx, &e->cut);
    tz_array_free(ctx, &e->node);
    tz_array_free(ctx, &e->bridge);
}

static int by_place(const void *a, const void *b)
{
    const tz_curve_cut *p = a, *q = b;
    if (p->piece != q->piece)
        return p->piece < q->piece ? -1 : 1;
    return (p->t > q->t) - (p->t < q->t);
}

static tz_status add_part(const tz_net_edit *e, tz_curve_set *to, int32_t piece,
                          const double t[2], const int32_t node[2])
{
    const tz_curve_set *set = &e->net->set;
    const tz_curve_piece *p = &set->piece.v[piece];
    const bool whole = t[0] <= 0 && t[1] >= 1;
    if (whole && node[0] == p->from && node[1] == p->to) {
        const tz_curve_carry carry = tz_curve_carried(set, piece);
        return tz_curve_add_piece(to, p, &carry); /* to the bit */
    }
    const tz_bezier all = tz_curve_bezier(set, p),
                    part = tz_bezier_part(&all, t[0], t[1]);
    const tz_curve_carry old = tz_curve_carried(set, piece),
                         carry = tz_curve_carry_part(&old, &all, t[0], t[1]);
    tz_curve_piece c = {.straight = p->straight};
    tz_curve_put(to, &part, node, &c);
    return tz_curve_add_piece(to, &c, &carry);
}

/* Ends the path and begins another. */
static tz_status break_path(tz_curve_set *to, int32_t pen)
{
    tz_curve_end(to, false);
    return tz_curve_begin(to, pen);
}

static tz_status add_piece(const tz_net_edit *e, tz_curve_set *to, int32_t piece,
                           int32_t *at, bool *whole)
{
    const tz_curve_piece *p = &e->net->set.piece.v[piece];
    const int32_t pen = e->net->pen[piece];
    double t[2] = {0, 0};
    int32_t node[2] = {e->merged[p->from], 0};
    bool left_out = false;
    tz_status s = TZ_OK;
    if (e->kept && (e->kept[piece].t[0] > 0 || e->kept[piece].t[1] < 1)) {
        const tz_net_kept *k = &e->kept[piece];
        for (int i = 0; i < 2; i++)
            node[i] = k->node[i] >= 0 ? k->node[i] : e->merged[i ? p->to : p->from];
        *whole = false;
        if (k->t[0] > 0)
            s = break_path(to, pen);
        if (s == TZ_OK)
            s = add_part(e, to, piece, k->t, node);
        return s == TZ_OK && k->t[1] < 1 ? break_path(to, pen) : s;
    }
    for (; *at < e->cut.n && e->cut.v[*at].piece == piece && s == TZ_OK; (*at)++) {
        const int32_t id = e->cut.v[*at].node;
        t[1] = e->cut.v[*at].t;
        node[1] = id < 0 ? ~id : id;
        s = left_out ? break_path(to, pen) : add_part(e, to, piece, t, node);
        left_out = id < 0;
        *whole = *whole && !left_out;
        t[0] = t[1];
        node[0] = node[1];
    }
    t[1] = 1;
    node[1] = e->merged[p->to];
    return s == TZ_OK ? add_part(e, to, piece, t, node) : s;
}

/* What stays of the paths. */
static tz_status add_paths(tz_net_edit *e, tz_curve_set *to)
{
    const tz_curve_set *set = &e->net->set;
    int32_t at = 0;
    tz_status s = TZ_OK;
    if (e->cut.n > 1)
        qsort(e->cut.v, (size_t)e->cut.n, sizeof *e->cut.v, by_place);
    for (int32_t i = 0; i < set->path.n && s == TZ_OK; i++) {
        const tz_curve_path *p = &set->path.v[i];
        bool all = true;
        s = tz_curve_begin(to, p->pen);
        for (int32_t k = p->piece; k < p->piece + p->pieces && s == TZ_OK; k++) {
            if (!e->gone[k]) {
                s = add_piece(e, to, k, &at, &all);
                continue;
            }
            while (at < e->cut.n && e->cut.v[at].piece == k)
                at++;
            all = false;
            tz_curve_end(to, false);
            s = tz_curve_begin(to, p->pen);
        }
        if (s == TZ_OK)
            tz_curve_end(to, p->closed && all);
    }
    return s;
}

static tz_status add_bridges(tz_net_edit *e, tz_curve_set *to)
{
    const tz_curve_set *set = &e->net->set;
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < e->bridge.n && s == TZ_OK; i++) {
        const tz_net_bridge *b = &e->bridge.v[i];
        const tz_curve_carry carry = {.taper = b->taper,
                                      .origin = tz_curve_no_origin(),
                                      .has_taper = set->taper.n > 0,
                                      .has_origin = set->origin.n > 0};
        tz_curve_piece p = {0};
        tz_curve_put(to, &b->curve, b->node, &p);
        s = tz_curve_begin(to, b->pen);
        if (s == TZ_OK)
            s = tz_curve_add_piece(to, &p, &carry);
        if (s == TZ_OK)
            tz_curve_end(to, false);
    }
    return s;
}

tz_status tz_net_edit_node(tz_net_edit *e, tz_vec2 at, int32_t *node)
{
    *node = e->net->set.node.n + e->node.n;
    return tz_array_push(e->net->ctx, &e->node, at);
}

tz_status tz_net_edit_apply(tz_net_edit *e, tz_curve_set *out)
{
    const tz_curve_set *set = &e->net->set;
    tz_ctx *ctx = e->net->ctx;
    tz_curve_set raw = {.ctx = ctx, .domain = set->domain};
    bool *none = NULL;
    memset(out, 0, sizeof *out);
    tz_status s = tz_curve_set_like(ctx, set, NULL, out);
    for (int32_t i = 0; i < set->node.n && s == TZ_OK; i++)
        s = tz_array_push(ctx, &raw.node, set->node.v[i]);
    for (int32_t i = 0; i < e->node.n && s == TZ_OK; i++) {
        const tz_vec2 p = e->node.v[i];
        const tz_vec3 in = tz_domain_wrap(&set->domain, (tz_vec3){p.x, p.y, 0});
        s = tz_array_push(ctx, &raw.node, ((tz_vec2){in.x, in.y}));
    }
    if (s == TZ_OK)
        s = add_paths(e, &raw);
    if (s == TZ_OK)
        s = add_bridges(e, &raw);
    for (int32_t i = 0; i < raw.node.n && s == TZ_OK; i++)
        s = tz_array_push(ctx, &out->node, raw.node.v[i]);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &none, (size_t)raw.piece.n, sizeof *none);
    if (s == TZ_OK)
        s = tz_curve_chain(ctx, &raw, none, false, out);
    tz_free(ctx, none);
    tz_curve_set_deinit(&raw);
    if (s != TZ_OK) {
        tz_curve_set_deinit(out);
        memset(out, 0, sizeof *out);
    }
    return s;
}

/* ---- cleaning ------------------------------------------------------------------------ */

static void drop_edge(tz_net_edit *e, int32_t edge)
{
    const tz_net_edge *d = &e->net->edge.v[edge];
    for (int32_t k = 0; k < d->steps; k++)
        e->gone[e->net->step.v[d->step + k] >> 1] = true;
    e->removed++;
}

static bool edge_fixed(const tz_net *n, int32_t edge)
{
    return tz_net_fixed(n, n->step.v[n->edge.v[edge].step] >> 1);
}

/* Length of each part; INFINITY for those which reach the border or hold what is fixed. */
tz_status tz_finish_parts(const tz_net *n, double margin, double **length)
{
    tz_status s = tz_alloc_zero(n->ctx, length, (size_t)n->parts, sizeof **length);
    for (int32_t i = 0; i < n->edge.n && s == TZ_OK; i++) {
        const tz_net_edge *e = &n->edge.v[i];
        (*length)[e->part] += edge_fixed(n, i) ? INFINITY : e->length;
        for (int32_t k = 0; k < e->steps; k++) {
            const int32_t piece = n->step.v[e->step + k] >> 1;
            for (int32_t j = n->at[piece]; j < n->at[piece + 1]; j++) {
                const tz_vec2 p = n->point.v[j].at;
                if (tz_domain_depth(&n->set.domain, (tz_vec3){p.x, p.y, 0}) <= margin)
                    (*length)[e->part] = INFINITY;
            }
        }
    }
    return s;
}

static tz_status drop_crumbs(tz_net_edit *e, const tz_finish_limits *l)
{
    const tz_net *n = e->net;
    double *length = NULL;
    tz_status s = tz_finish_parts(n, l->margin, &length);
    for (int32_t i = 0; i < n->edge.n && s == TZ_OK; i++)
        if (length[n->edge.v[i].part] < l->crumb)
            drop_edge(e, i);
    tz_free(n->ctx, length);
    return s;
}

typedef struct ranked {
    double length;
    int32_t edge;
} ranked;

static int by_length(const void *a, const void *b)
{
    const ranked *p = a, *q = b;
    if (p->length != q->length)
        return p->length < q->length ? -1 : 1;
    return (p->edge > q->edge) - (p->edge < q->edge);
}

static tz_status drop_twins(tz_net_edit *e, const tz_finish_limits *l)
{
    const tz_net *n = e->net;
    ranked *order = NULL;
    double *scratch = NULL;
    tz_status s = tz_alloc(n->ctx, &order, (size_t)n->edge.n, sizeof *order);
    if (s == TZ_OK)
        s = tz_alloc(n->ctx, &scratch, (size_t)tz_net_most_points(n), sizeof *scratch);
    for (int32_t i = 0; i < n->edge.n && s == TZ_OK; i++)
        order[i] = (ranked){n->edge.v[i].length, i};
    if (s == TZ_OK && n->edge.n > 1)
        qsort(order, (size_t)n->edge.n, sizeof *order, by_length);
    for (int32_t i = 0; i < n->edge.n && s == TZ_OK && l->twin > 0; i++) {
        const int32_t edge = order[i].edge;
        const int32_t piece = n->step.v[n->edge.v[edge].step] >> 1;
        if (e->gone[piece] || edge_fixed(n, edge))
            continue;
        if (tz_net_twin(n, edge, l->twin, e->gone, scratch) < l->twin)
            drop_edge(e, edge);
        if (!(i & 1023) && tz_ctx_cancelled(n->ctx))
            s = TZ_CANCELLED;
    }
    tz_free(n->ctx, order);
    tz_free(n->ctx, scratch);
    return s;
}

/* Ends of pieces at a node that are still there. */
static int32_t staying(const tz_net_edit *e, int32_t node)
{
    int32_t count = 0;
    for (int32_t i = e->net->first[node]; i < e->net->first[node + 1]; i++)
        count += !e->gone[e->net->end[i] >> 1];
    return count;
}

static void merge_junctions(tz_net_edit *e, const tz_finish_limits *l, bool *busy)
{
    const tz_net *n = e->net;
    for (int32_t i = 0; i < n->edge.n; i++) {
        const tz_net_edge *d = &n->edge.v[i];
        int32_t a = d->from, b = d->to;
        if (!(d->length < l->junction) || a == b || busy[a] || busy[b] ||
            e->gone[n->step.v[d->step] >> 1] || edge_fixed(n, i))
            continue;
        const int32_t na = staying(e, a), nb = staying(e, b);
        if (na < 3 || nb < 3 || na + nb - 2 > l->degrees)
            continue;
        if (na > nb) {
            const int32_t swap = a;
            a = b, b = swap;
        }
        e->merged[a] = b;
        busy[a] = busy[b] = true;
        drop_edge(e, i);
    }
}

tz_status tz_finish_clean(tz_net_edit *e, const tz_finish_limits *l)
{
    const tz_net *n = e->net;
    bool *busy = NULL;
    tz_status s = drop_crumbs(e, l);
    if (s == TZ_OK)
        s = drop_twins(e, l);
    if (s == TZ_OK)
        s = tz_alloc_zero(n->ctx, &busy, (size_t)n->set.node.n, sizeof *busy);
    for (int32_t i = 0; i < n->edge.n && s == TZ_OK; i++)
        if (edge_fixed(n, i)) /* what is fixed does not move */
            busy[n->edge.v[i].from] = busy[n->edge.v[i].to] = true;
    if (s == TZ_OK)
        merge_junctions(e, l, busy);
    tz_free(n->ctx, busy);
    return s;
}
