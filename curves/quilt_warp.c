/* SPDX-License-Identifier: Apache-2.0 */
/* Each paired cut asks for a small rigid motion of the lines about it: its end onto the
 * meeting point, its tangent onto the common one. Motions are blended,
 *
 *   D(x) = sum_k w_k(x) (M_k(x) - x) / (1 + sum_k w_k(x)),  w = (1 - d / R)^2 / (d / R)^2,
 *
 * which is exact at the cuts (w is infinite there), flat about them, and nought beyond R.
 * It moves places, not lines, so that what is joined stays joined.
 * @source Shepard: A two-dimensional interpolation function for irregularly-spaced data,
 *   1968; Franke, Little: weights of finite radius. Deviates: values are motions, and
 *   standing still counts as one of weight 1 */
#include <string.h>

#include "curves/quilt_internal.h"

enum { MOST = 64 };

static bool moves(const quilt_cut *c)
{
    return c->mate >= 0 &&
           (c->to.x != c->at.x || c->to.y != c->at.y || c->turn != 0 || c->widen != 0);
}

tz_vec2 quilt_warp_at(const quilt_warp *w, int32_t patch, tz_vec2 x)
{
    int32_t near[MOST];
    const int32_t n = tz_grid_query(&w->grid, x, w->radius, near, MOST);
    double sum = 1;
    tz_vec2 d = {0, 0};
    for (int32_t i = 0; i < (n < MOST ? n : MOST); i++) {
        const quilt_cut *c = &w->r->cut.v[near[i]];
        if (c->patch != patch || c->run < 0 || c->mate < 0)
            continue;
        const tz_vec2 v = tz_vec2_sub(x, c->at);
        const double k = tz_vec2_length(v) / w->radius;
        if (k >= 1)
            continue;
        if (k < 1e-9)
            return c->to;
        const double cs = cos(c->turn) - 1, sn = sin(c->turn),
                     wt = (1 - k) * (1 - k) / (k * k);
        sum += wt;
        d.x += wt * (c->to.x - c->at.x + cs * v.x - sn * v.y);
        d.y += wt * (c->to.y - c->at.y + sn * v.x + cs * v.y);
    }
    return (tz_vec2){x.x + d.x / sum, x.y + d.y / sum};
}

double quilt_warp_width(const quilt_warp *w, int32_t patch, tz_vec2 x)
{
    int32_t near[MOST];
    const int32_t n = tz_grid_query(&w->grid, x, w->radius, near, MOST);
    double sum = 1, d = 0;
    for (int32_t i = 0; i < (n < MOST ? n : MOST); i++) {
        const quilt_cut *c = &w->r->cut.v[near[i]];
        const double k = tz_vec2_length(tz_vec2_sub(x, c->at)) / w->radius;
        if (c->patch != patch || c->run < 0 || c->mate < 0 || k >= 1)
            continue;
        if (k < 1e-9)
            return exp(c->widen);
        const double wt = (1 - k) * (1 - k) / (k * k);
        sum += wt;
        d += wt * c->widen;
    }
    return exp(d / sum);
}

bool quilt_warp_near(const quilt_warp *w, int32_t patch, tz_vec2 x, double reach)
{
    int32_t near[MOST];
    const int32_t n = tz_grid_query(&w->grid, x, w->radius + reach, near, MOST);
    for (int32_t i = 0; i < (n < MOST ? n : MOST); i++)
        if (w->r->cut.v[near[i]].patch == patch && moves(&w->r->cut.v[near[i]]))
            return true;
    return n > MOST;
}

/* ---- straight lines ----------------------------------------------------------------- */

/* Where the other end of a straight line that is cut comes to lie. False: not straight. */
static bool far_end(const quilt_source *s, const quilt_map *m, const quilt_runs *r,
                    const quilt_cut *c, tz_vec2 *at)
{
    if (c->run < 0)
        return false;
    const quilt_run *run = &r->run.v[c->run];
    if (run->parts == 0)
        return false;
    const quilt_part *p = &r->part.v[c->side ? run->part + run->parts - 1 : run->part];
    const tz_curve_piece *piece = &s->set->piece.v[p->piece];
    const double t = c->side ? p->t0 : p->t1;
    if (!piece->straight)
        return false;
    if (run->parts == 1 && run->cut[1 - c->side] >= 0) {
        *at = r->cut.v[run->cut[1 - c->side]].to;
        return true;
    }
    const tz_bezier b = tz_curve_bezier(s->set, piece);
    *at = quilt_place_at(&m->patch.v[run->patch], tz_bezier_at(&b, t));
    return true;
}

/* Two straight lines that all but run on in one do so. */
static void straighten(const quilt_source *s, const quilt_map *m, quilt_runs *r)
{
    for (int sweep = 0; sweep < 4; sweep++)
        for (int32_t i = 0; i < r->cut.n; i++) {
            quilt_cut *a = &r->cut.v[i];
            tz_vec2 p, q;
            if (a->mate < i || a->fixed || r->cut.v[a->mate].fixed)
                continue;
            quilt_cut *b = &r->cut.v[a->mate];
            if (!far_end(s, m, r, a, &p) || !far_end(s, m, r, b, &q))
                continue;
            a->turn = b->turn = 0;
            /* in a's coordinates */
            const tz_vec2 shift = tz_vec2_sub(a->to, b->to);
            q = tz_vec2_add(q, shift);
            const tz_vec2 d = tz_vec2_sub(q, p), v = tz_vec2_sub(a->to, p);
            const double n = tz_vec2_dot(d, d), t = n > 0 ? tz_vec2_dot(v, d) / n : -1;
            const tz_vec2 foot = tz_vec2_add(p, tz_vec2_scale(d, t));
            const double off = tz_vec2_length(tz_vec2_sub(foot, a->to)),
                         least = fmin(t, 1 - t) * sqrt(n);
            if (t <= 0 || t >= 1 || off > 0.07 * least)
                continue;
            a->to = foot;
            b->to = tz_vec2_sub(foot, shift);
        }
}

/* ---- */

tz_status quilt_warp_init(tz_ctx *ctx, const quilt_source *s, const quilt_map *m,
                          quilt_runs *r, quilt_warp *w)
{
    const tz_vec3 size = m->domain->size;
    int32_t id;
    *w = (quilt_warp){.ctx = ctx, .r = r, .radius = fmax(8 * m->cx, 3 * s->spacing)};
    straighten(s, m, r);
    const double cell = fmin(w->radius, fmin(size.x, size.y));
    tz_status st = tz_grid_init(ctx, &w->grid, (tz_vec2){0, 0}, (tz_vec2){size.x, size.y},
                                cell, m->domain->torus);
    for (int32_t i = 0; i < r->cut.n && st == TZ_OK; i++)
        st = tz_grid_add(ctx, &w->grid, r->cut.v[i].at, &id);
    return st;
}

void quilt_warp_deinit(quilt_warp *w) { tz_grid_deinit(w->ctx, &w->grid); }
