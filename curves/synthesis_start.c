/* SPDX-License-Identifier: Apache-2.0 */
/* Where a level begins: noise, curves that are given, or what the level before has drawn,
 * sampled anew.
 *
 * A sample's first match is found from where its curve came from: curves with origins
 * tell the place of the exemplar themselves; a sample drawn by the last level lies beside
 * one of that level as the exemplar's sample lies beside its match. What is left is drawn
 * at random by the search, as published.
 * @source [Tu20] Sec. 4.3.2, 4.3.5, Fig. 14. Deviates: first matches are handed down, so
 *   that a level does not have to find again what the last one knew */
#include <string.h>

#include "base/grid.h"
#include "curves/reconstruct.h"
#include "curves/synthesis_internal.h"

#define MOST_NOISE 4e6 /* samples */

/* ---- parts that all starts share ---------------------------------------------------- */

tz_status tz_curve_solve_add(tz_curve_solve *t, const tz_curve_sample *p, int32_t match)
{
    const tz_status s = tz_array_push(t->ctx, &t->o.sample, *p);
    return s == TZ_OK ? tz_array_push(t->ctx, &t->match, match) : s;
}

/* Samples, edges and orientations of `from` behind those of the output. */
static tz_status append(tz_curve_solve *t, const tz_sample_graph *from, bool fixed)
{
    tz_sample_graph *g = &t->o;
    const int32_t base = g->sample.n, bodies = t->body.n;
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < from->sample.n && s == TZ_OK; i++) {
        const tz_curve_sample *p = &from->sample.v[i];
        tz_curve_sample q = *p;
        q.fixed = fixed;
        q.turn = g->turn.n;
        q.element = p->element < 0 ? -1 : bodies + p->element;
        for (int32_t k = 0; k < p->turns && s == TZ_OK; k++)
            s = tz_array_push(t->ctx, &g->turn, from->turn.v[p->turn + k]);
        if (s == TZ_OK)
            s = tz_curve_solve_add(t, &q, -1);
    }
    for (int32_t i = 0; i < from->edge.n && s == TZ_OK; i++) {
        tz_curve_edge e = from->edge.v[i];
        e.from += base;
        e.to += base;
        e.shape = e.shapes = 0;
        e.like = -1;
        e.back = false;
        s = tz_array_push(t->ctx, &g->edge, e);
    }
    return s;
}

static bool has_lines(const tz_curve_set *s)
{
    return s && (s->path.n > 0 || s->element.element.n > 0);
}

/* Curves sampled at this level, behind the output. */
static tz_status append_curves(tz_curve_solve *t, const tz_curve_set *set, bool fixed)
{
    tz_sample_graph g = {0};
    if (!has_lines(set))
        return TZ_OK;
    tz_status s = tz_sample_graph_make(t->ctx, set, t->x->g.spacing, t->x->g.radius, &g);
    if (s == TZ_OK)
        s = append(t, &g, fixed);
    for (int32_t i = 0; i < set->element.element.n && s == TZ_OK; i++) {
        const int32_t from = set->element.element.v[i].source;
        const bool known = from >= 0 && from < t->job->exemplar->element.element.n;
        s = tz_array_push(t->ctx, &t->body, fixed || !known ? -1 : from);
    }
    tz_sample_graph_deinit(&g);
    return s;
}

/* ---- matches from origins ----------------------------------------------------------- */

typedef struct traces {
    TZ_ARRAY(tz_vec2)
    to; /* place of the exemplar, of each point of the grid */
    tz_grid grid;
} traces;

static tz_status trace_piece(const tz_curve_solve *t, const tz_curve_set *set, int32_t i,
                             traces *k)
{
    const tz_bezier c = tz_curve_bezier(set, &set->piece.v[i]), *o = &set->origin.v[i];
    const double n = fmin(ceil(tz_bezier_length(&c) / (0.1 * t->x->g.spacing)), 1000);
    tz_status s = TZ_OK;
    int32_t id;
    if (!isfinite(o->p[0].x))
        return s;
    for (int32_t j = 0; j <= (int32_t)n && s == TZ_OK; j++) {
        const double at = n > 0 ? j / n : 0;
        s = tz_array_push(t->ctx, &k->to, tz_bezier_at(o, at));
        if (s == TZ_OK)
            s = tz_grid_add(t->ctx, &k->grid,
                            tz_curve_wrapped(t->job->domain, tz_bezier_at(&c, at)), &id);
    }
    return s;
}

static void match_traces(tz_curve_solve *t, const traces *k)
{
    enum { MOST = 64 };
    int32_t found[MOST];
    for (int32_t i = 0; i < t->o.sample.n; i++) {
        const tz_vec2 at = t->o.sample.v[i].at;
        double best = INFINITY;
        if (t->o.sample.v[i].q != TZ_SAMPLE_CURVE || t->match.v[i] >= 0)
            continue;
        const int32_t n =
            tz_grid_query(&k->grid, at, 0.15 * t->x->g.spacing, found, MOST);
        for (int32_t j = 0; j < (n < MOST ? n : MOST); j++) {
            const double d = tz_vec2_length(
                tz_curve_vector(t->job->domain, at, k->grid.point.v[found[j]]));
            if (d < best) {
                best = d;
                t->match.v[i] =
                    tz_curve_model_nearest(t->x, k->to.v[found[j]], TZ_SAMPLE_CURVE);
            }
        }
    }
}

static tz_status match_origins(tz_curve_solve *t, const tz_curve_set *set)
{
    const tz_domain *d = t->job->domain;
    const double m = d->torus ? 0 : t->margin;
    traces k;
    memset(&k, 0, sizeof k);
    if (!set || set->origin.n != set->piece.n || set->piece.n == 0)
        return TZ_OK;
    tz_status s = tz_grid_init(t->ctx, &k.grid, (tz_vec2){-m, -m},
                               (tz_vec2){d->size.x + 2 * m, d->size.y + 2 * m},
                               0.25 * t->x->g.spacing, d->torus);
    for (int32_t i = 0; i < set->piece.n && s == TZ_OK; i++)
        s = trace_piece(t, set, i, &k);
    if (s == TZ_OK)
        match_traces(t, &k);
    tz_grid_deinit(t->ctx, &k.grid);
    tz_array_free(t->ctx, &k.to);
    return s;
}

/* ---- noise -------------------------------------------------------------------------- */

static tz_status scatter(tz_curve_solve *t)
{
    const tz_domain *d = t->job->domain, *e = &t->job->exemplar->domain;
    const double m = d->torus ? 0 : t->margin;
    const double wide = d->size.x + 2 * m, high = d->size.y + 2 * m;
    const double n = t->x->g.sample.n / (e->size.x * e->size.y) * wide * high;
    tz_rng r = tz_rng_make(t->job->seed, tz_rng_stream(0x4015e, 0, 0));
    tz_status s = TZ_OK;
    if (n > MOST_NOISE)
        return tz_fail(t->ctx, TZ_LIMIT,
                       "%g samples are too many; make the domain smaller", n);
    for (int32_t i = 0; i < (int32_t)(n + 0.5) && s == TZ_OK; i++) {
        const tz_vec2 at = {tz_rng_range(&r, -m, -m + wide),
                            tz_rng_range(&r, -m, -m + high)};
        const int32_t like = tz_rng_below(&r, t->x->g.sample.n);
        const int32_t q = t->x->g.sample.v[like].q;
        if (tz_curve_solve_depth(t, at) < 0)
            continue;
        if (q !=
            TZ_SAMPLE_CURVE) /* a whole one as often as one of its samples is drawn */
            s = tz_curve_solve_place(t, like, at);
        else
            s = tz_curve_solve_add(
                t, &(tz_curve_sample){.at = at, .q = q, .element = -1, .existence = 1},
                -1);
    }
    return s;
}

static tz_status start_given(tz_curve_solve *t, const tz_curve_set *start)
{
    tz_status s = TZ_OK;
    if (start->piece.n == 0 || start->origin.n != start->piece.n) {
        s = append_curves(t, start, false);
    } else {
        tz_curve_set things = *start; /* without its curves */
        things.path.n = things.piece.n = things.node.n = 0;
        things.taper.n = things.origin.n = 0;
        s = tz_curve_solve_trace(t, start);
        if (s == TZ_OK)
            s = append_curves(t, &things, false);
    }
    return s == TZ_OK ? match_origins(t, start) : s;
}

tz_status tz_curve_solve_start(tz_curve_solve *t)
{
    t->o = (tz_sample_graph){.ctx = t->ctx,
                             .domain = *t->job->domain,
                             .spacing = t->x->g.spacing,
                             .radius = t->x->g.radius};
    tz_status s = append_curves(t, t->job->given, true);
    if (s == TZ_OK && t->p.start == TZ_CURVE_GIVEN)
        s = start_given(t, t->job->start);
    if (s == TZ_OK && t->p.start == TZ_CURVE_NOISE)
        s = scatter(t);
    if (s == TZ_OK && t->p.start == TZ_CURVE_PATCHES)
        s = tz_curve_solve_patches(t);
    return s == TZ_OK ? tz_sample_graph_link(&t->o) : s;
}

/* ---- the next level ----------------------------------------------------------------- */

/* What the last level left: its samples of curves with their matches. */
typedef struct coarse {
    const tz_curve_model *x;
    TZ_ARRAY(tz_vec2)
    to; /* place of the exemplar, of each point of the grid */
    tz_grid grid;
} coarse;

static tz_status remember(tz_curve_solve *t, coarse *k)
{
    const tz_domain *d = t->job->domain;
    const double m = d->torus ? 0 : t->margin;
    int32_t id;
    tz_status s = tz_grid_init(t->ctx, &k->grid, (tz_vec2){-m, -m},
                               (tz_vec2){d->size.x + 2 * m, d->size.y + 2 * m},
                               t->o.spacing, d->torus);
    for (int32_t i = 0; i < t->o.sample.n && s == TZ_OK; i++) {
        if (t->o.sample.v[i].q != TZ_SAMPLE_CURVE || t->match.v[i] < 0)
            continue;
        s = tz_array_push(t->ctx, &k->to, k->x->g.sample.v[t->match.v[i]].at);
        if (s == TZ_OK)
            s = tz_grid_add(t->ctx, &k->grid, t->o.sample.v[i].at, &id);
    }
    return s;
}

static void hand_down(tz_curve_solve *t, const coarse *k)
{
    enum { MOST = 64 };
    int32_t found[MOST];
    for (int32_t i = 0; i < t->o.sample.n; i++) {
        const tz_vec2 at = t->o.sample.v[i].at;
        double best = INFINITY;
        if (t->o.sample.v[i].q != TZ_SAMPLE_CURVE)
            continue;
        const int32_t n = tz_grid_query(&k->grid, at, k->x->g.spacing, found, MOST);
        for (int32_t j = 0; j < (n < MOST ? n : MOST); j++) {
            const tz_vec2 v =
                tz_curve_vector(t->job->domain, k->grid.point.v[found[j]], at);
            if (tz_vec2_length(v) >= best)
                continue;
            best = tz_vec2_length(v);
            const tz_vec2 w = tz_curve_rotate(v, -tz_curve_solve_frame(t, at));
            t->match.v[i] = tz_curve_model_nearest(
                t->x, tz_vec2_add(k->to.v[found[j]], w), TZ_SAMPLE_CURVE);
        }
    }
}

/* The graph without what is fixed or belongs to elements: that is sampled anew, or stays.
 */
static tz_status only_free(tz_curve_solve *t, tz_sample_graph *out)
{
    *out = (tz_sample_graph){.ctx = t->ctx,
                             .domain = t->o.domain,
                             .spacing = t->o.spacing,
                             .radius = t->o.radius};
    int32_t *to = NULL;
    tz_status s = tz_alloc(t->ctx, &to, (size_t)t->o.sample.n, sizeof *to);
    for (int32_t i = 0; i < t->o.sample.n && s == TZ_OK; i++) {
        const tz_curve_sample *p = &t->o.sample.v[i];
        to[i] = -1;
        if (p->element >= 0 || p->links == 0)
            continue;
        to[i] = out->sample.n;
        tz_curve_sample q = *p;
        q.turn = out->turn.n;
        for (int32_t k = 0; k < p->turns && s == TZ_OK; k++)
            s = tz_array_push(t->ctx, &out->turn, t->o.turn.v[p->turn + k]);
        if (s == TZ_OK)
            s = tz_array_push(t->ctx, &out->sample, q);
    }
    for (int32_t i = 0; i < t->o.edge.n && s == TZ_OK; i++) {
        tz_curve_edge e = t->o.edge.v[i];
        if (to[e.from] < 0 || to[e.to] < 0 ||
            (t->o.sample.v[e.from].fixed && t->o.sample.v[e.to].fixed))
            continue;
        e.from = to[e.from];
        e.to = to[e.to];
        s = tz_array_push(t->ctx, &out->edge, e);
    }
    if (s == TZ_OK)
        s = tz_sample_graph_link(out);
    tz_free(t->ctx, to);
    return s;
}

/* Samples of elements that are not fixed go over as they are. */
static tz_status carry_elements(tz_curve_solve *t, const tz_sample_graph *old,
                                const int32_t *body, int32_t bodies)
{
    const int32_t shift = t->body.n;
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < bodies && s == TZ_OK; i++)
        s = tz_array_push(t->ctx, &t->body, body[i]);
    for (int32_t i = 0; i < old->sample.n && s == TZ_OK; i++) {
        tz_curve_sample p = old->sample.v[i];
        if (p.element < 0 || p.fixed)
            continue;
        p.element += shift;
        s = tz_curve_solve_add(t, &p, -1);
    }
    return s;
}

tz_status tz_curve_solve_refine(tz_curve_solve *t, const tz_curve_model *before)
{
    coarse k = {.x = before};
    tz_sample_graph old = t->o, lines = {0};
    tz_curve_set drawn = {0};
    int32_t *body = t->body.v;
    const int32_t bodies = t->body.n;
    tz_status s = remember(t, &k);
    if (s == TZ_OK)
        s = only_free(t, &lines);
    if (s == TZ_OK && lines.edge.n > 0)
        s = tz_curve_reconstruct_detail(t->ctx, &lines, &before->g, t->job->exemplar,
                                        &drawn);
    if (s == TZ_OK) {
        t->o = (tz_sample_graph){.ctx = t->ctx,
                                 .domain = *t->job->domain,
                                 .spacing = t->x->g.spacing,
                                 .radius = t->x->g.radius};
        memset(&t->body, 0, sizeof t->body);
        t->match.n = 0;
        s = append_curves(t, t->job->given, true);
        if (s == TZ_OK && drawn.path.n > 0)
            s = append_curves(t, &drawn, false);
        if (s == TZ_OK)
            s = carry_elements(t, &old, body, bodies);
        if (s == TZ_OK)
            s = tz_sample_graph_link(&t->o);
        if (s == TZ_OK)
            hand_down(t, &k);
        tz_sample_graph_deinit(&old);
        tz_free(t->ctx, body);
    }
    tz_sample_graph_deinit(&lines);
    tz_curve_set_deinit(&drawn);
    tz_grid_deinit(t->ctx, &k.grid);
    tz_array_free(t->ctx, &k.to);
    return s;
}
