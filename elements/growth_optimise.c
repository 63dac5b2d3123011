/* SPDX-License-Identifier: Apache-2.0 */
/* Optimisation: each spot's best unit says where its neighbours should be; positions that
 * satisfy all of them best in the least-squares sense are taken.
 *
 * @source [Dav19] Sec. 5.2, 5.3, Eq. (4). Each round moves what it has placed and the
 * seeds that it grew from; their neighbours pull, and move little. Deviates: the local
 * system is solved by a few Jacobi sweeps, not factorised. An own weight of half a
 * prediction makes it so diagonally dominant that after SWEEPS of them positions are
 * within 0.7 % of the spacing (root mean square; 4 % at most) of the exact solution, on
 * jittered, random and mosaic exemplars where moves are 3 to 5 %; they cost some hundred
 * operations a spot. The global system goes to CHOLMOD. Moves that would bring two
 * elements nearer than the exemplar's are halved, then dropped. */
#include <math.h>

#include "base/lsq.h"
#include "elements/growth_internal.h"

enum { SWEEPS = 4 };
static const float own_weight = 0.5F; /* as in the authors' code */
static const float old_weight = 12;   /* of what is not of this round */
/* Cost at which a match is trusted by half: where blocks of the exemplar meet badly,
 * what their seam predicts would spoil what has been copied well. */
static const float unsure = 0.1F;
static const float farthest = 0.2F; /* move in a round, spacings */
static const double least = 5e-3;   /* of that: less is not worth a move */

/* ---- predictions ----------------------------------------------------------------- */

typedef struct prediction {
    int32_t spot;
    float ex, ey; /* error of its offset, in the world */
    float weight;
} prediction;

/* Eq. (4): Gaussian of the errors' own distribution; a neighbour whose error is unlike
 * the others' has moved for reasons of its own. */
static void weigh(prediction *p, int32_t n, float spacing, float trust)
{
    float mx = 0, my = 0;
    const float floor2 = 0.0025F * spacing * spacing; /* keeps C regular */
    for (int32_t i = 0; i < n; i++)
        mx += p[i].ex / (float)n, my += p[i].ey / (float)n;
    float a = floor2, b = 0, c = floor2;
    for (int32_t i = 0; i < n; i++) {
        const float x = p[i].ex - mx, y = p[i].ey - my;
        a += x * x / (float)n, b += x * y / (float)n, c += y * y / (float)n;
    }
    const float det = a * c - b * b;
    for (int32_t i = 0; i < n; i++) {
        const float x = p[i].ex - mx, y = p[i].ey - my;
        const float q = (c * x * x - 2 * b * x * y + a * y * y) / det;
        p[i].weight = trust * expf(-0.5F * q);
    }
}

/* What a spot's match says about its neighbours. */
static int32_t predict(tz_growth *g, int32_t spot, tz_growth_view *view, prediction *p)
{
    tz_growth_spot *q = &g->spot.v[spot];
    int8_t pair[TZ_GROWTH_SEEN];
    uint64_t used;
    int32_t n = 0;
    const tz_growth_exemplar *ex = &g->ex[q->texture];
    tz_growth_look(g, q->x, q->y, ex->unit[q->match].view, spot, view);
    q->match = tz_growth_nearest(ex, q->match, view);
    const float cost =
        tz_growth_match(ex, q->match, view->v, view->n, INFINITY, &used, pair);
    const tz_growth_unit *u = &ex->unit[q->match];
    q->first = 0;
    for (int32_t i = 0; i < view->n; i++) {
        const tz_growth_seen *s = &view->v[i];
        q->first += tz_growth_far(u, s->x, s->y, s->r) <= u->wide;
        if (pair[i] < 0 || view->v[i].spot == spot)
            continue;
        const tz_growth_near *o = &ex->near.v[u->near + pair[i]];
        const tz_vec2 e = tz_growth_out(view, o->x - view->v[i].x, o->y - view->v[i].y);
        p[n++] = (prediction){view->v[i].spot, (float)e.x, (float)e.y, 0};
    }
    if (n)
        weigh(p, n, u->spacing * (float)view->scale, unsure / (unsure + cost));
    return n;
}

/* ---- moves ----------------------------------------------------------------------- */

static bool collides(const tz_growth *g, int32_t spot, double dx, double dy,
                     const tz_growth_view *view)
{
    const tz_growth_spot *q = &g->spot.v[spot];
    const tz_growth_exemplar *ex = &g->ex[q->texture];
    const float turned = atan2f(view->s, view->c);
    const tz_growth_body body = {q->r / (float)view->scale, q->angle - turned, q->hard,
                                 q->symbol};
    for (int32_t i = 0; i < view->n; i++) {
        const tz_growth_seen *o = &view->v[i];
        const float bound = tz_growth_bound(ex, &body, o);
        const float x = o->x - (float)dx, y = o->y - (float)dy;
        const float d2 = x * x + y * y;
        /* what collides already may at least part */
        if (d2 >= bound * bound || d2 >= o->x * o->x + o->y * o->y)
            continue;
        const float apart = tz_growth_apart(ex, &body, x, y, o);
        if (d2 < apart * apart)
            return true;
    }
    return false;
}

/* Turns an element and its samples about it. */
static void turn(tz_growth *g, tz_growth_spot *q, double angle)
{
    tz_element *e = &g->out->element.v[q->out];
    const double c = cos(angle), s = sin(angle);
    for (int32_t k = e->sample; k < e->sample + e->samples; k++) {
        tz_vec3 *p = &g->out->sample.v[k].at;
        const double x = p->x - e->at.x, y = p->y - e->at.y;
        p->x = e->at.x + c * x - s * y, p->y = e->at.y + s * x + c * y;
    }
    e->angle += angle;
    q->angle += (float)angle;
    const double c2 = cos(2 * angle), s2 = sin(2 * angle), a = q->c2, b = q->s2;
    q->c2 = (float)(c2 * a - s2 * b), q->s2 = (float)(s2 * a + c2 * b);
}

/* The same with their size. */
static void scale(tz_growth *g, const tz_growth_spot *q, double by)
{
    tz_element *e = &g->out->element.v[q->out];
    for (int32_t k = e->sample; k < e->sample + e->samples; k++) {
        tz_vec3 *p = &g->out->sample.v[k].at;
        p->x = e->at.x + by * (p->x - e->at.x), p->y = e->at.y + by * (p->y - e->at.y);
    }
    e->scale *= by, e->radius *= by;
}

static void shift(tz_growth *g, int32_t spot, double dx, double dy)
{
    tz_growth_spot *q = &g->spot.v[spot];
    const tz_domain *d = &g->out->domain;
    const tz_vec3 from = {q->x, q->y, 0};
    const tz_vec3 to = tz_domain_wrap(d, (tz_vec3){q->x + dx, q->y + dy, 0});
    tz_growth_unlink(g, spot);
    if (q->out >= 0) {
        tz_element *e = &g->out->element.v[q->out];
        for (int32_t k = e->sample; k < e->sample + e->samples; k++) {
            g->out->sample.v[k].at.x += to.x - e->at.x;
            g->out->sample.v[k].at.y += to.y - e->at.y;
        }
        e->at.x = to.x, e->at.y = to.y;
        if (d->frames)
            turn(g, q, tz_domain_frame(d, to) - tz_domain_frame(d, from));
        if (d->frames && d->frames->size)
            scale(g, q, tz_domain_scale(d, to) / tz_domain_scale(d, from));
    }
    if (d->frames && d->frames->apart)
        q->r *= (float)(tz_domain_apart(d, to) / tz_domain_apart(d, from));
    q->x = to.x, q->y = to.y;
    tz_growth_link(g, spot);
}

/* Whether domain and zones let a spot be at a place; what grows there does not matter. */
static bool may_go(const tz_growth *g, const tz_growth_spot *q, double x, double y)
{
    const tz_domain *d = &g->out->domain;
    const tz_vec3 p = tz_domain_wrap(d, (tz_vec3){x, y, 0});
    return tz_domain_contains(d, p) && tz_growth_may_go(g, q->texture, p.x, p.y) &&
           (q->out < 0 || tz_domain_allows(d, p, q->kind)) &&
           (g->params.inside <= 0 || q->out < 0 ||
            tz_domain_depth(d, p) >= g->params.inside * g->out->element.v[q->out].radius);
}

void tz_growth_move(tz_growth *g, int32_t spot, double dx, double dy)
{
    const tz_growth_spot *q = &g->spot.v[spot];
    const tz_growth_unit *u = &g->ex[q->texture].unit[q->match];
    const double unit = tz_domain_apart(&g->out->domain, (tz_vec3){q->x, q->y, 0});
    const double most = farthest * u->spacing * unit, d = hypot(dx, dy);
    tz_growth_view view;
    if (q->fixed || !(d > least * most))
        return;
    if (d > most)
        dx *= most / d, dy *= most / d;
    tz_growth_look(g, q->x, q->y, u->clear + most / unit, spot, &view);
    for (int32_t halved = 0; halved < 2; halved++, dx *= 0.5, dy *= 0.5) {
        const tz_vec2 v = tz_growth_in(&view, dx, dy);
        if (may_go(g, q, q->x + dx, q->y + dy) && !collides(g, spot, v.x, v.y, &view)) {
            shift(g, spot, dx, dy);
            return;
        }
    }
}

/* ---- local ----------------------------------------------------------------------- */

static int32_t node_of(tz_growth *g, int32_t spot, float self)
{
    tz_growth_spot *q = &g->spot.v[spot];
    if (q->node < 0 && g->nodes < TZ_GROWTH_NODES) {
        q->node = g->nodes++;
        g->node[q->node] = (tz_growth_node){.spot = spot, .self = q->fixed ? 1e6F : self};
    }
    return q->node;
}

/* Edges hold errors: how much farther apart the two should be. */
static void add_edge(tz_growth *g, int32_t from, int32_t to, float ex, float ey, float w)
{
    if (from >= 0 && to >= 0 && g->edges < TZ_GROWTH_EDGES)
        g->edge[g->edges++] = (tz_growth_edge){from, to, ex, ey, w};
}

static void add_out(tz_growth *g, int32_t from, int32_t to, tz_vec2 e, float w)
{
    add_edge(g, from, to, (float)e.x, (float)e.y, w);
}

/* What an older neighbour's match says about this spot. */
static void add_answer(tz_growth *g, int32_t spot, const tz_growth_view *view,
                       const tz_growth_seen *o)
{
    const tz_growth_spot *p = &g->spot.v[o->spot];
    if (p->match < 0 || p->node < 0 || p->texture != g->spot.v[spot].texture)
        return;
    const tz_growth_exemplar *ex = &g->ex[p->texture];
    tz_growth_view its = {.c = 1, .scale = 1};
    if (g->out->domain.frames) {
        const tz_vec3 place = {p->x, p->y, 0};
        const double a = tz_domain_frame(&g->out->domain, place);
        its.scale = tz_domain_apart(&g->out->domain, place);
        its.c = (float)cos(a), its.s = (float)sin(a);
    }
    const tz_vec2 at = tz_growth_out(view, o->x, o->y);
    const tz_vec2 back = tz_growth_in(&its, -at.x, -at.y);
    const int32_t j = tz_growth_at(ex, p->match, (float)back.x, (float)back.y);
    if (j < 0)
        return;
    const tz_growth_unit *u = &ex->unit[p->match];
    const tz_growth_near *near = &ex->near.v[u->near + j];
    const float x = near->x - (float)back.x, y = near->y - (float)back.y;
    const float limit = 0.25F * u->spacing * u->spacing, d = x * x + y * y;
    if (near->kind == g->spot.v[spot].kind && d < limit)
        add_out(g, p->node, g->spot.v[spot].node, tz_growth_out(&its, x, y),
                1 - d / limit);
}

static void add_predictions(tz_growth *g, int32_t spot, int32_t young)
{
    tz_growth_view view;
    prediction p[TZ_GROWTH_SEEN];
    const int32_t n = predict(g, spot, &view, p);
    for (int32_t i = 0; i < n; i++)
        add_edge(g, g->spot.v[spot].node, node_of(g, p[i].spot, old_weight), p[i].ex,
                 p[i].ey, p[i].weight);
    for (int32_t i = 0; i < view.n; i++)
        if (g->spot.v[view.v[i].spot].node >= young)
            add_answer(g, spot, &view, &view.v[i]);
}

static void sweep(tz_growth *g)
{
    for (int32_t i = 0; i < g->nodes; i++)
        g->node[i].sx = g->node[i].sy = g->node[i].sum = 0;
    for (int32_t k = 0; k < g->edges; k++) {
        const tz_growth_edge *e = &g->edge[k];
        tz_growth_node *a = &g->node[e->from], *b = &g->node[e->to];
        a->sx += e->weight * (b->x - e->x), a->sy += e->weight * (b->y - e->y);
        b->sx += e->weight * (a->x + e->x), b->sy += e->weight * (a->y + e->y);
        a->sum += e->weight, b->sum += e->weight;
    }
    for (int32_t i = 0; i < g->nodes; i++) {
        tz_growth_node *n = &g->node[i];
        const float sum = n->sum + n->self;
        n->x = n->sx / sum, n->y = n->sy / sum;
    }
}

void tz_growth_relax(tz_growth *g)
{
    g->nodes = g->edges = 0;
    for (int32_t k = 0; k < g->rounds; k++)
        if (g->spot.v[g->round[k]].match >= 0)
            node_of(g, g->round[k], own_weight);
    const int32_t young = g->nodes;
    for (int32_t i = 0; i < young; i++)
        add_predictions(g, g->node[i].spot, young);
    for (int32_t k = 0; k < SWEEPS; k++)
        sweep(g);
    for (int32_t i = 0; i < g->nodes; i++)
        tz_growth_move(g, g->node[i].spot, g->node[i].x, g->node[i].y);
    for (int32_t i = 0; i < g->nodes; i++)
        g->spot.v[g->node[i].spot].node = -1;
}

/* ---- global ---------------------------------------------------------------------- */

/* One equation a prediction: shift of `to` - shift of `from` = error. */
static tz_status add_equations(tz_growth *g, tz_lsq *lsq, int32_t spot)
{
    tz_growth_view view;
    prediction p[TZ_GROWTH_SEEN];
    const double zero[2] = {0, 0}, one = 1, difference[2] = {-1, 1};
    const double own = g->spot.v[spot].fixed ? 1e3 : sqrt((double)own_weight);
    tz_status s = tz_lsq_add(lsq, 1, &spot, &one, zero, own);
    const int32_t n = g->spot.v[spot].match < 0 ? 0 : predict(g, spot, &view, p);
    for (int32_t i = 0; i < n && s == TZ_OK; i++) {
        const int32_t index[2] = {spot, p[i].spot};
        const double error[2] = {p[i].ex, p[i].ey};
        s = tz_lsq_add(lsq, 2, index, difference, error, sqrt((double)p[i].weight));
    }
    return s;
}

tz_status tz_growth_solve(tz_growth *g)
{
    const int32_t n = g->spot.n;
    tz_lsq *lsq = NULL;
    double *x = NULL;
    g->solved = n;
    if (n == 0)
        return TZ_OK;
    tz_status s = tz_lsq_new(g->ctx, n, 2, &lsq);
    if (s == TZ_OK)
        s = tz_alloc(g->ctx, &x, (size_t)n, 2 * sizeof *x);
    for (int32_t i = 0; i < n && s == TZ_OK; i++)
        s = add_equations(g, lsq, i);
    if (s == TZ_OK)
        s = tz_lsq_solve(lsq, x);
    for (int32_t i = 0; i < n && s == TZ_OK; i++)
        if (g->spot.v[i].match >= 0)
            tz_growth_move(g, i, x[i], x[n + i]);
    tz_lsq_free(lsq);
    tz_free(g->ctx, x);
    return s;
}
