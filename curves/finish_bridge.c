/* SPDX-License-Identifier: Apache-2.0 */
/* One bridge: a curve of Hermite between two ends, its handles longer the more it turns; where
 * it leaves an end that has been cut back; and the gaps where it crosses other lines. */
#include "curves/finish_pairs_internal.h"

#define APART 0.15 /* of delta: so far from where they would cross lines change sides */

static double angle_between(tz_vec2 u, tz_vec2 v)
{
    return acos(fmin(fmax(tz_vec2_dot(u, v), -1), 1));
}

tz_bezier tz_bridge_curve(tz_vec2 p, tz_vec2 u, tz_vec2 q, tz_vec2 w, double *turn)
{
    const tz_vec2 v = tz_vec2_sub(q, p);
    const double d = tz_vec2_length(v);
    const tz_vec2 to = d > 0 ? tz_vec2_scale(v, 1 / d) : u;
    *turn = angle_between(u, to) + angle_between(to, tz_vec2_scale(w, -1));
    /* a half circle has handles of 2 / 3 of its diameter, a straight line of a third */
    const double h = d * (1 + fmin(*turn / TZ_PI, 1.5)) / 3;
    return (tz_bezier){
        {p, tz_vec2_add(p, tz_vec2_scale(u, h)), tz_vec2_add(q, tz_vec2_scale(w, h)), q}};
}

bool tz_chords_cross(tz_vec2 p, tz_vec2 q, tz_vec2 r, tz_vec2 s)
{
    const tz_vec2 d = tz_vec2_sub(q, p), e = tz_vec2_sub(s, r), f = tz_vec2_sub(r, p);
    const double det = d.x * e.y - d.y * e.x;
    if (det == 0)
        return false;
    const double u = (f.x * e.y - f.y * e.x) / det, v = (f.x * d.y - f.y * d.x) / det;
    return u >= 0 && u <= 1 && v >= 0 && v <= 1;
}

/* Where a piece has run that far from one of its ends. */
static double parameter_at(const tz_bezier *b, double way, bool back)
{
    double lo = 0, hi = 1;
    for (int i = 0; i < 30; i++) {
        const double mid = (lo + hi) / 2;
        const tz_bezier part = tz_bezier_part(b, back ? 1 - mid : 0, back ? 1 : mid);
        *(tz_bezier_length(&part) < way ? &lo : &hi) = mid;
    }
    return back ? 1 - hi : hi;
}

tz_edge_place tz_edge_place_at(const tz_net *n, int32_t node, double way)
{
    const tz_net_edge *d = &n->edge.v[n->edge_of[tz_net_end_at(n, node) >> 1]];
    const bool front = d->from == node;
    tz_edge_place p = {
        .piece = -1, .at = n->set.node.v[node], .out = tz_net_outwards(n, node)};
    for (int32_t i = 0; i < d->steps && way > 0; i++) {
        const int32_t end = n->step.v[d->step + (front ? i : d->steps - 1 - i)];
        const tz_bezier b = tz_curve_bezier(&n->set, &n->set.piece.v[end >> 1]);
        const double length = tz_bezier_length(&b);
        if (length <= way) {
            way -= length;
            p.before++;
            continue;
        }
        p.piece = end >> 1;
        p.back = (end & 1) == front;
        p.t = parameter_at(&b, way, p.back);
        const tz_vec2 u = tz_bezier_slope(&b, p.t);
        const double size = tz_vec2_length(u);
        p.at = tz_bezier_at(&b, p.t);
        if (size > 0)
            p.out = tz_vec2_scale(u, (p.back ? 1 : -1) / size);
        break;
    }
    return p;
}

bool tz_bridge_gaps(const tz_pairing *k, const tz_end_pair *c,
                    tz_bridge_gap g[TZ_BRIDGE_PASSES])
{
    const tz_net *n = k->n;
    const double length = tz_bezier_length(&c->curve);
    double room = APART * k->l->delta;
    for (int i = 0; i <= c->passes; i++)
        room = fmin(room, 0.3 * length *
                              ((i < c->passes ? c->pass[i].u : 1) -
                               (i > 0 ? c->pass[i - 1].u : 0)));
    for (int i = 0; i < c->passes; i++) {
        const int32_t piece = c->pass[i].piece;
        g[i].line = tz_curve_bezier(&n->set, &n->set.piece.v[piece]);
        const double size = tz_bezier_length(&g[i].line), t = c->pass[i].t;
        for (int j = 0; j < i; j++)
            if (c->pass[j].piece == piece)
                return false;
        if (k->edit->used[piece] || k->edit->gone[piece] ||
            k->edit->kept[piece].t[0] > 0 || k->edit->kept[piece].t[1] < 1)
            return false;
        room = fmin(room, 0.7 * size * fmin(t, 1 - t));
    }
    for (int i = 0; i < c->passes; i++) {
        const double size = tz_bezier_length(&g[i].line);
        const tz_vec2 x = tz_bezier_at(&c->curve, c->pass[i].u);
        for (int j = 0; j < 2; j++) {
            g[i].t[j] = c->pass[i].t + (j ? 1 : -1) * room / size;
            g[i].u[j] = c->pass[i].u + (j ? 1 : -1) * room / length;
            g[i].at[j] =
                tz_curve_copy(&n->set.domain, tz_bezier_at(&g[i].line, g[i].t[j]), x);
        }
    }
    return room > 0.02 * k->l->delta;
}
