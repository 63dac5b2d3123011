/* SPDX-License-Identifier: Apache-2.0 */
/* Curves as a net: edges between the nodes where other than two pieces meet. */
#include <stdlib.h>
#include <string.h>

#include "curves/finish_internal.h"

enum { MAX_POINTS = 64000000 };

static int32_t node_at(const tz_net *n, int32_t end)
{
    const tz_curve_piece *p = &n->set.piece.v[end >> 1];
    return end & 1 ? p->to : p->from;
}

/* ---- what meets ---------------------------------------------------------------------- */

static tz_status list_ends(tz_net *n)
{
    const int32_t nodes = n->set.node.n, ends = 2 * n->set.piece.n;
    tz_status s = tz_alloc_zero(n->ctx, &n->first, (size_t)nodes + 2, sizeof *n->first);
    if (s == TZ_OK)
        s = tz_alloc(n->ctx, &n->end, (size_t)ends, sizeof *n->end);
    if (s == TZ_OK)
        s = tz_alloc(n->ctx, &n->pen, (size_t)n->set.piece.n, sizeof *n->pen);
    if (s == TZ_OK)
        s = tz_alloc(n->ctx, &n->size, (size_t)n->set.piece.n, sizeof *n->size);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < n->set.piece.n; i++) {
        const tz_bezier b = tz_curve_bezier(&n->set, &n->set.piece.v[i]);
        n->size[i] = n->set.piece.v[i].straight
                         ? tz_vec2_length(tz_vec2_sub(b.p[3], b.p[0]))
                         : tz_bezier_length(&b);
    }
    for (int32_t i = 0; i < ends; i++)
        n->first[node_at(n, i) + 2]++;
    for (int32_t i = 2; i < nodes + 2; i++)
        n->first[i] += n->first[i - 1];
    for (int32_t i = 0; i < ends; i++)
        n->end[n->first[node_at(n, i) + 1]++] = i;
    for (int32_t i = 0; i < n->set.path.n; i++)
        for (int32_t k = 0; k < n->set.path.v[i].pieces; k++)
            n->pen[n->set.path.v[i].piece + k] = n->set.path.v[i].pen;
    return TZ_OK;
}

/* ---- edges --------------------------------------------------------------------------- */

/* The end by which the line goes on where it arrives by `end ^ 1`; -1 if it does not. */
static int32_t goes_on(const tz_net *n, int32_t end)
{
    const int32_t node = node_at(n, end ^ 1), at = n->first[node];
    if (tz_net_degree(n, node) != 2)
        return -1;
    const int32_t other = n->end[at] == (end ^ 1) ? n->end[at + 1] : n->end[at];
    return tz_net_fixed(n, other >> 1) == tz_net_fixed(n, end >> 1) ? other : -1;
}

/* The edge that begins by entering a piece at `begin`. */
static tz_status add_edge(tz_net *n, int32_t begin)
{
    tz_net_edge e = {.step = n->step.n, .from = node_at(n, begin)};
    tz_status s = TZ_OK;
    for (int32_t at = begin; at >= 0 && n->edge_of[at >> 1] < 0 && s == TZ_OK;
         at = goes_on(n, at)) {
        n->edge_of[at >> 1] = n->edge.n;
        e.length += n->size[at >> 1];
        e.steps++;
        e.to = node_at(n, at ^ 1);
        s = tz_array_push(n->ctx, &n->step, at);
    }
    return s == TZ_OK ? tz_array_push(n->ctx, &n->edge, e) : s;
}

static tz_status find_edges(tz_net *n)
{
    const int32_t pieces = n->set.piece.n;
    tz_status s = tz_alloc(n->ctx, &n->edge_of, (size_t)pieces, sizeof *n->edge_of);
    if (s != TZ_OK)
        return s;
    if (pieces > 0)
        memset(n->edge_of, 255, (size_t)pieces * sizeof *n->edge_of);
    for (int round = 0; round < 2; round++) /* loops last */
        for (int32_t end = 0; end < 2 * pieces && s == TZ_OK; end++)
            if (n->edge_of[end >> 1] < 0 && (round == 1 || goes_on(n, end ^ 1) < 0))
                s = add_edge(n, end);
    return s;
}

static int32_t root_of(int32_t *up, int32_t i)
{
    while (up[i] != i)
        i = up[i] = up[up[i]];
    return i;
}

/* Numbers what hangs together, in order of the edges. */
static tz_status find_parts(tz_net *n)
{
    int32_t *up = NULL;
    tz_status s = tz_alloc(n->ctx, &up, (size_t)n->set.node.n, sizeof *up);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < n->set.node.n; i++)
        up[i] = i;
    for (int32_t i = 0; i < n->edge.n; i++) {
        const int32_t a = root_of(up, n->edge.v[i].from),
                      b = root_of(up, n->edge.v[i].to);
        up[a > b ? a : b] = a < b ? a : b;
    }
    for (int32_t i = 0; i < n->edge.n; i++)
        n->edge.v[i].part = root_of(up, n->edge.v[i].from);
    n->parts = n->set.node.n;
    tz_free(n->ctx, up);
    return TZ_OK;
}

/* ---- points -------------------------------------------------------------------------- */

static tz_status add_points(tz_net *n, int32_t end, double *along)
{
    const int32_t piece = end >> 1;
    const tz_bezier b = tz_curve_bezier(&n->set, &n->set.piece.v[piece]);
    const double length = n->size[piece];
    const int32_t steps = (int32_t)fmin(ceil(length / n->spacing), 4096);
    const int32_t count = steps < 1 ? 1 : steps;
    const bool back = end & 1;
    double way = back ? *along + length : *along;
    tz_vec2 last = b.p[0];
    tz_status s = TZ_OK;
    for (int32_t k = 0; k <= count && s == TZ_OK; k++) {
        const double t = (double)k / count;
        const tz_vec2 p = tz_bezier_at(&b, t);
        tz_vec2 d = tz_bezier_slope(&b, fmin(fmax(t, 1e-3), 1 - 1e-3));
        const double size = tz_vec2_length(d),
                     step = tz_vec2_length(tz_vec2_sub(p, last));
        way += back ? -step : step;
        last = p;
        d = size > 0 ? tz_vec2_scale(d, 1 / size) : (tz_vec2){1, 0};
        s = tz_array_push(n->ctx, &n->point,
                          ((tz_net_point){p, d, piece, t, fmax(way, 0)}));
    }
    *along += length;
    return s;
}

/* Length of a piece's chords whose middles lie off the border. */
static double inner_length(const tz_net *n, int32_t piece, double margin)
{
    double sum = 0;
    for (int32_t i = n->at[piece]; i + 1 < n->at[piece + 1]; i++) {
        const tz_vec2 p = n->point.v[i].at, q = n->point.v[i + 1].at;
        const tz_vec3 mid = {(p.x + q.x) / 2, (p.y + q.y) / 2, 0};
        if (tz_domain_depth(&n->set.domain, mid) > margin)
            sum += tz_vec2_length(tz_vec2_sub(p, q));
    }
    return sum;
}

static tz_status find_points(tz_net *n, double margin)
{
    const tz_domain *d = &n->set.domain;
    int32_t id;
    tz_status s = tz_alloc(n->ctx, &n->at, (size_t)n->set.piece.n + 1, sizeof *n->at);
    double *begin = NULL;
    int32_t *by = NULL;
    if (s == TZ_OK)
        s = tz_alloc(n->ctx, &begin, (size_t)n->set.piece.n, sizeof *begin);
    if (s == TZ_OK)
        s = tz_alloc(n->ctx, &by, (size_t)n->set.piece.n, sizeof *by);
    for (int32_t i = 0; i < n->edge.n && s == TZ_OK; i++) {
        double along = 0;
        for (int32_t k = 0; k < n->edge.v[i].steps; k++) {
            const int32_t end = n->step.v[n->edge.v[i].step + k];
            begin[end >> 1] = along;
            by[end >> 1] = end;
            along += n->size[end >> 1];
        }
    }
    for (int32_t i = 0; i < n->set.piece.n && s == TZ_OK; i++) {
        n->at[i] = n->point.n;
        s = n->point.n > MAX_POINTS
                ? tz_fail(n->ctx, TZ_LIMIT, "the curves are too long to be finished")
                : add_points(n, by[i], &begin[i]);
    }
    tz_free(n->ctx, begin);
    tz_free(n->ctx, by);
    if (s != TZ_OK)
        return s;
    n->at[n->set.piece.n] = n->point.n;
    for (int32_t i = 0; i < n->set.piece.n; i++)
        n->length += tz_net_fixed(n, i) ? 0 : inner_length(n, i, margin);
    s = tz_grid_init(n->ctx, &n->grid, (tz_vec2){0, 0}, (tz_vec2){d->size.x, d->size.y},
                     fmax(2 * n->spacing, hypot(d->size.x, d->size.y) / 4000), d->torus);
    for (int32_t i = 0; i < n->point.n && s == TZ_OK; i++) {
        const tz_vec2 p = n->point.v[i].at;
        const tz_vec3 in = tz_domain_wrap(d, (tz_vec3){p.x, p.y, 0});
        s = tz_grid_add(n->ctx, &n->grid, (tz_vec2){in.x, in.y}, &id);
    }
    return s;
}

tz_status tz_net_init(tz_ctx *ctx, tz_curve_set *joined, int32_t fixed, double spacing,
                      double margin, tz_net *n)
{
    *n = (tz_net){.ctx = ctx, .set = *joined, .fixed = fixed, .spacing = spacing};
    memset(joined, 0, sizeof *joined);
    joined->ctx = ctx;
    tz_status s = list_ends(n);
    if (s == TZ_OK)
        s = find_edges(n);
    if (s == TZ_OK)
        s = find_parts(n);
    return s == TZ_OK ? find_points(n, margin) : s;
}

void tz_net_deinit(tz_net *n)
{
    tz_curve_set_deinit(&n->set);
    tz_free(n->ctx, n->first);
    tz_free(n->ctx, n->end);
    tz_free(n->ctx, n->pen);
    tz_free(n->ctx, n->size);
    tz_free(n->ctx, n->edge_of);
    tz_free(n->ctx, n->at);
    tz_array_free(n->ctx, &n->step);
    tz_array_free(n->ctx, &n->edge);
    tz_array_free(n->ctx, &n->point);
    tz_grid_deinit(n->ctx, &n->grid);
}

/* ---- ends ---------------------------------------------------------------------------- */

bool tz_net_dangles(const tz_net *n, int32_t node, double margin)
{
    const tz_vec2 p = n->set.node.v[node];
    return tz_net_degree(n, node) == 1 && !tz_net_fixed(n, n->end[n->first[node]] >> 1) &&
           tz_domain_depth(&n->set.domain, (tz_vec3){p.x, p.y, 0}) > margin;
}

int32_t tz_net_ends(const tz_net *n, double margin)
{
    int32_t count = 0;
    for (int32_t i = 0; i < n->set.node.n; i++)
        count += tz_net_dangles(n, i, margin);
    return count;
}

tz_vec2 tz_net_outwards(const tz_net *n, int32_t node)
{
    const int32_t end = n->end[n->first[node]];
    tz_bezier b = tz_curve_bezier(&n->set, &n->set.piece.v[end >> 1]);
    if (!(end & 1))
        b = (tz_bezier){{b.p[3], b.p[2], b.p[1], b.p[0]}};
    for (int k = 2; k >= 0; k--) {
        const tz_vec2 d = tz_vec2_sub(b.p[3], b.p[k]);
        const double size = tz_vec2_length(d);
        if (size > 0)
            return tz_vec2_scale(d, 1 / size);
    }
    return (tz_vec2){1, 0};
}

/* ---- running side by side -------------------------------------------------------------- */

/* Whether a point of another edge lies beside that point, not just where both come from. */
static bool beside(const tz_net *n, const tz_net_point *p, const tz_net_point *q,
                   double d)
{
    const tz_net_edge *e = &n->edge.v[n->edge_of[p->piece]],
                      *f = &n->edge.v[n->edge_of[q->piece]];
    if (fabs(tz_vec2_dot(p->tangent, q->tangent)) < 0.94)
        return false;
    const tz_vec2 v = tz_net_vector(n, p->at, q->at);
    if (fabs(tz_vec2_dot(v, p->tangent)) > 0.5 * d + 0.6 * n->spacing)
        return false; /* ahead, not beside */
    if (e == f)
        return fabs(p->along - q->along) > 6 * d + 4 * n->spacing &&
               e->length - fabs(p->along - q->along) > 6 * d + 4 * n->spacing;
    const double tail = e->length - p->along;
    const bool shares_from = e->from == f->from || e->from == f->to,
               shares_to = e->to == f->from || e->to == f->to;
    return (!shares_from || p->along > 3 * d + n->spacing || e->length < 8 * d) &&
           (!shares_to || tail > 3 * d + n->spacing || e->length < 8 * d);
}

static int up(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

int32_t tz_net_most_points(const tz_net *n)
{
    int32_t most = 0;
    for (int32_t i = 0; i < n->edge.n; i++) {
        int32_t count = 0;
        for (int32_t k = 0; k < n->edge.v[i].steps; k++) {
            const int32_t piece = n->step.v[n->edge.v[i].step + k] >> 1;
            count += n->at[piece + 1] - n->at[piece];
        }
        most = count > most ? count : most;
    }
    return most;
}

double tz_net_twin(const tz_net *n, int32_t edge, double under, const bool *gone,
                   double *scratch)
{
    enum { MOST = 512 };
    const tz_net_edge *e = &n->edge.v[edge];
    const double reach = under + 0.6 * n->spacing;
    int32_t id[MOST], count = 0, all = 0, off = 0;
    for (int32_t k = 0; k < e->steps; k++) {
        const int32_t piece = n->step.v[e->step + k] >> 1;
        all += n->at[piece + 1] - n->at[piece];
    }
    for (int32_t k = 0; k < e->steps; k++) {
        const int32_t piece = n->step.v[e->step + k] >> 1;
        for (int32_t i = n->at[piece]; i < n->at[piece + 1]; i++) {
            const tz_net_point *p = &n->point.v[i];
            const tz_vec3 in =
                tz_domain_wrap(&n->set.domain, (tz_vec3){p->at.x, p->at.y, 0});
            const int32_t found =
                tz_grid_query(&n->grid, (tz_vec2){in.x, in.y}, reach, id, MOST);
            double best = INFINITY;
            for (int32_t j = 0; j < found && j < MOST; j++) {
                const tz_net_point *q = &n->point.v[id[j]];
                const tz_vec2 v = tz_net_vector(n, p->at, q->at);
                /* off the other's tangent: the points lie apart along it */
                const double d = fabs(v.x * q->tangent.y - v.y * q->tangent.x);
                if (d < best && !(gone && gone[q->piece]) && beside(n, p, q, d))
                    best = d;
            }
            scratch[count++] = best;
            off += !(best < under);
            if (off > all - 1 - (int32_t)(0.8 * (all - 1)))
                return INFINITY;
        }
    }
    if (count == 0)
        return INFINITY;
    qsort(scratch, (size_t)count, sizeof *scratch, up);
    return scratch[(int32_t)(0.8 * (count - 1))];
}
