/* SPDX-License-Identifier: Apache-2.0 */
/* Bridges into an edit: ends are cut back; where a bridge crosses a line the two change
 * sides, each half of the line goes on as that of the bridge which it turns to less, so that
 * nothing crosses and nothing ends. */
#include "curves/finish_pairs_internal.h"

/* Takes `way` from the edge's end at that node; the end is then `out`. */
static tz_status cut_back(tz_net_edit *e, int32_t node, double way, int32_t *out)
{
    const tz_net *n = e->net;
    const tz_net_edge *d = &n->edge.v[n->edge_of[tz_net_end_at(n, node) >> 1]];
    const tz_edge_place p = tz_edge_place_at(n, node, way);
    const bool front = d->from == node;
    *out = node;
    if (p.piece < 0)
        return TZ_OK;
    for (int32_t i = 0; i < p.before; i++)
        e->gone[n->step.v[d->step + (front ? i : d->steps - 1 - i)] >> 1] = true;
    tz_net_kept *k = &e->kept[p.piece];
    k->t[p.back] = p.t;
    const tz_status s = tz_net_edit_node(e, p.at, out);
    k->node[p.back] = *out;
    return s;
}

static tz_status add_bridge(tz_pairing *k, const tz_bezier *c, int32_t a, int32_t b,
                            int32_t end, double wa, double wb)
{
    const tz_net_bridge bridge = {
        .node = {a, b}, .curve = *c, .taper = {wa, wb}, .pen = k->n->pen[end >> 1]};
    return tz_array_push(k->n->ctx, &k->edit->bridge, bridge);
}

static tz_vec2 heading(const tz_bezier *c, double t)
{
    const tz_vec2 d = tz_bezier_slope(c, t);
    const double size = tz_vec2_length(d);
    return size > 0 ? tz_vec2_scale(d, 1 / size) : (tz_vec2){1, 0};
}

/* Both halves of the line are led on to those of the bridge that they turn to less. */
static tz_status switch_sides(tz_pairing *k, const tz_end_pair *c, int i,
                              tz_bridge_gap *g, double w)
{
    const tz_net *n = k->n;
    const int32_t piece = c->pass[i].piece;
    const tz_vec2 v = heading(&c->curve, c->pass[i].u),
                  d = heading(&g->line, c->pass[i].t);
    const bool along = tz_vec2_dot(v, d) > 0;
    tz_status s = TZ_OK;
    k->edit->used[piece] = true;
    for (int j = 0; j < 2 && s == TZ_OK; j++) {
        s = tz_net_edit_node(k->edit, g->at[j], &g->node[j]);
        if (s == TZ_OK)
            s = tz_array_push(
                n->ctx, &k->edit->cut,
                ((tz_curve_cut){piece, j ? g->node[j] : ~g->node[j], g->t[j]}));
        if (s == TZ_OK)
            s = tz_net_edit_node(k->edit, tz_bezier_at(&c->curve, g->u[j]), &g->own[j]);
    }
    for (int j = 0; j < 2 && s == TZ_OK; j++) { /* j: what comes, what goes */
        const int half = along ? 1 - j : j;
        double turn;
        const tz_vec2 from = tz_bezier_at(&c->curve, g->u[j]),
                      out = heading(&c->curve, g->u[j]),
                      in = heading(&g->line, g->t[half]);
        const tz_bezier b =
            tz_bridge_curve(from, j ? tz_vec2_scale(out, -1) : out, g->at[half],
                            half ? tz_vec2_scale(in, -1) : in, &turn);
        s = add_bridge(k, &b, g->own[j], g->node[half], 2 * piece, w, w);
    }
    return s;
}

tz_status tz_pairing_draw(tz_pairing *k, int32_t id)
{
    const tz_net *n = k->n;
    const tz_end_pair *c = &k->pair.v[id];
    const int32_t a = k->loose.v[c->a], b = k->loose.v[c->b];
    const int32_t ends[2] = {tz_net_end_at(n, a), tz_net_end_at(n, b)};
    const double wa = tz_net_width_at(n, a), wb = tz_net_width_at(n, b);
    tz_bridge_gap g[TZ_BRIDGE_PASSES];
    int32_t from, to;
    for (int i = 0; i < 2; i++) /* a line that has been switched is another */
        if (k->edit->used[ends[i] >> 1])
            return TZ_OK;
    if (!tz_bridge_gaps(k, c, g))
        return TZ_OK;
    tz_status s = cut_back(k->edit, a, c->cut[0], &from);
    if (s == TZ_OK)
        s = cut_back(k->edit, b, c->cut[1], &to);
    double u = 0;
    for (int i = 0; i <= c->passes && s == TZ_OK; i++) {
        const bool last = i == c->passes;
        if (!last)
            s = switch_sides(k, c, i, &g[i], (wa + wb) / 2);
        const tz_bezier part = tz_bezier_part(&c->curve, u, last ? 1 : g[i].u[0]);
        if (s == TZ_OK)
            s = add_bridge(k, &part, from, last ? to : g[i].own[0],
                           u < 0.5 ? ends[0] : ends[1], i ? (wa + wb) / 2 : wa,
                           last ? wb : (wa + wb) / 2);
        if (!last) {
            from = g[i].own[1];
            u = g[i].u[1];
        }
    }
    k->edit->closed++;
    return s;
}
