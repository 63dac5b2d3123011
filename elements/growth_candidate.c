/* SPDX-License-Identifier: Apache-2.0 */
/* Seeds, and what is copied around them.
 *
 * A seed about which something is open looks at its surroundings and at the units that are
 * coherent with its match. The unit that fits best decides the seed's first ring: those of
 * its neighbours that are not paired and lie where nothing was decided are copied ([Dav19]
 * Sec. 5.1, pairs_r); where it has none the room stays empty. A unit that fits much worse
 * than the best one is not asked (ratio test). Three things differ from the paper:
 *   - only the first ring is copied: what lies farther out is copied when more is known;
 *   - among the units that pass the test those win whose elements are of classes the
 *     output has too few of; the paper's choice starves some (its Fig. 18);
 *   - what is decided stays so, see growth_cover.c, unless the output becomes too sparse:
 *     then a place will do that is welcome: those around it must lack neighbours. Where it
 *     becomes too dense, places must be welcome everywhere. */
#include "elements/growth_internal.h"

enum { VISITS = 6, PUSHES = 6 }; /* of a seed; of a place */

/* Costs below `noise` are as good as none; below `well` balance does not interfere. */
static const float noise = 0.01F, well = 0.1F;
/* A seed about which less than this share of its ring is open is done: at first, and when
 * it has been visited. */
static const float crumbs = 0.02F, pieces = 0.1F;
/* Errors of density from which on it is mended, and which none may add to. */
static const float sparse = -0.01F, dense = 0.01F, crowded = 0.04F;
/* Neighbours that a place must lack for each share that density or class is over. */
static const float density_gain = 8, mending = 30;
/* Share of a distance that a place may lack, and spacings that it is pushed at most. */
static const float slack = 0.6F, push = 0.35F;
/* Cost of a verbatim copy: a step beyond its length, and at most. */
static const float weary = 0.1F, weary_most = 0.4F;

typedef struct choice {
    int32_t unit, n;
    int8_t near[TZ_GROWTH_NEAR];
    float cost;
    uint64_t decided; /* which of them lie where something was decided before */
    bool strict;
} choice;

/* ---- spots ----------------------------------------------------------------------- */

void tz_growth_link(tz_growth *g, int32_t i)
{
    tz_growth_spot *q = &g->spot.v[i];
    const double x = floor(q->x / g->cell_x), y = floor(q->y / g->cell_y);
    const int32_t cx = x < 0 ? 0 : x >= g->nx ? g->nx - 1 : (int32_t)x;
    const int32_t cy = y < 0 ? 0 : y >= g->ny ? g->ny - 1 : (int32_t)y;
    q->cell = cy * g->nx + cx;
    q->next = g->head[q->cell];
    g->head[q->cell] = i;
}

void tz_growth_unlink(tz_growth *g, int32_t i)
{
    int32_t *link = &g->head[g->spot.v[i].cell];
    while (*link != i)
        link = &g->spot.v[*link].next;
    *link = g->spot.v[i].next;
}

void tz_growth_enqueue(tz_growth *g, int32_t i)
{
    tz_growth_spot *q = &g->spot.v[i];
    if (q->queued || q->match < 0)
        return;
    q->queued = true;
    q->waiting = false;
    g->queue[(g->queue_head + g->queue_n++) % g->queue_cap] = i;
}

/* As tz_growth_fits, with that share of the distances. */
static bool fits_nearly(const tz_growth_exemplar *ex, const tz_growth_unit *u, float dx,
                        float dy, const tz_growth_view *view, float share)
{
    const tz_growth_body body = tz_growth_body_of(u);
    for (int32_t i = 0; i < view->n; i++) {
        const tz_growth_seen *o = &view->v[i];
        const float x = o->x - dx, y = o->y - dy, d2 = x * x + y * y;
        const float bound = share * tz_growth_bound(ex, &body, o);
        if (d2 >= bound * bound)
            continue;
        const float apart = share * tz_growth_apart(ex, &body, x, y, o);
        if (d2 < apart * apart)
            return false;
    }
    return true;
}

bool tz_growth_fits(const tz_growth_exemplar *ex, const tz_growth_unit *u, float dx,
                    float dy, const tz_growth_view *view)
{
    return fits_nearly(ex, u, dx, dy, view, 1);
}

bool tz_growth_fits_elements(const tz_growth_exemplar *ex, const tz_growth_unit *u,
                             const tz_growth_view *view)
{
    tz_growth_view v = {.n = 0};
    for (int32_t i = 0; i < view->n; i++)
        if (view->v[i].kind != ex->set->kind.n)
            v.v[v.n++] = view->v[i];
    return fits_nearly(ex, u, 0, 0, &v, 1);
}

/* What a neighbour that lacks some may set against the surplus of others: at the front
 * all lack many, and would pay for a crowd behind it. */
static const float credit = -0.5F;

float tz_growth_surplus(const tz_growth *g, int32_t texture, int32_t class)
{
    const float due = g->ex[texture].frequency[class] * (float)(g->counted[texture] + 1);
    const int32_t n = g->count[texture * TZ_GROWTH_CLASSES + class];
    return ((float)n + 2) / (due + 2) - 1;
}

/* Whether those around a place have fewer neighbours than their units, on average. */
static bool is_welcome(const tz_growth *g, const tz_growth_exemplar *ex,
                       const tz_growth_unit *u, float error, const tz_growth_view *view)
{
    float surplus = 0;
    int32_t first = 0;
    for (int32_t i = 0; i < view->n; i++) {
        const tz_growth_seen *o = &view->v[i];
        const tz_growth_spot *q = &g->spot.v[o->spot];
        first += tz_growth_far(u, o->x, o->y, o->r) <= u->wide;
        if (q->match >= 0 && q->texture == ex->number) {
            const tz_growth_unit *e = &ex->unit[q->match];
            if (tz_growth_far(e, o->x, o->y, u->r) <= e->wide)
                surplus += fmaxf(credit, (float)(q->first + 1 - e->ring_due) + error);
        }
    }
    return surplus <= 0.01F && first <= u->ring_due + (error < 0);
}

/* The new one is a neighbour of those around it. Those that found no fit try again. */
static void count_first(tz_growth *g, int32_t spot, const tz_growth_view *view)
{
    tz_growth_spot *n = &g->spot.v[spot];
    const tz_growth_exemplar *ex = &g->ex[n->texture];
    const tz_growth_unit *u = &ex->unit[n->match];
    for (int32_t i = 0; i < view->n; i++) {
        const tz_growth_seen *o = &view->v[i];
        tz_growth_spot *q = &g->spot.v[o->spot];
        n->first += tz_growth_far(u, o->x, o->y, o->r) <= u->wide;
        if (q->match >= 0 && q->texture == n->texture) {
            const tz_growth_unit *e = &ex->unit[q->match];
            const float r = n->r / (float)view->scale;
            const bool in = tz_growth_far(e, o->x, o->y, r) <= e->wide;
            q->first += in;
            if (in && q->waiting && q->visits < VISITS)
                tz_growth_enqueue(g, o->spot);
        }
    }
}

tz_status tz_growth_place(tz_growth *g, int32_t texture, int32_t unit, int32_t shown,
                          double x, double y, const tz_growth_view *view)
{
    const tz_growth_exemplar *ex = &g->ex[texture];
    tz_growth_unit *u = &ex->unit[shown];
    const bool real = u->source >= 0;
    const double z = real ? ex->set->element.v[u->source].at.z : 0;
    const tz_vec3 at = tz_domain_wrap(&g->out->domain, (tz_vec3){x, y, z});
    const double turn = tz_domain_frame(&g->out->domain, at);
    const double size = tz_domain_scale(&g->out->domain, at);
    const float c = (float)cos(2 * turn), s2 = (float)sin(2 * turn);
    tz_status s = tz_growth_reserve(g, 1);
    if (s == TZ_OK && real)
        s = tz_element_set_place(g->out, ex->set, u->source, at, turn,
                                 ex->texture.scale * size);
    if (s != TZ_OK)
        return s;
    if (real && ex->torus) /* what a period's frame cuts is drawn whole */
        g->out->element.v[g->out->element.n - 1].cut = false;
    const int32_t i = g->spot.n++;
    g->spot.v[i] =
        (tz_growth_spot){.x = at.x,
                         .y = at.y,
                         .r = u->r * (float)tz_domain_apart(&g->out->domain, at),
                         .c2 = c * u->c2 - s2 * u->s2,
                         .s2 = s2 * u->c2 + c * u->s2,
                         .angle = u->angle + (float)turn,
                         .kind = u->kind,
                         .symbol = u->symbol,
                         .hard = u->hard,
                         .texture = texture,
                         .copy = shown,
                         .match = unit,
                         .out = real ? g->out->element.n - 1 : -1,
                         .node = -1};
    tz_growth_link(g, i);
    tz_growth_enqueue(g, i);
    g->round[g->rounds++] = i;
    count_first(g, i, view);
    g->count[texture * TZ_GROWTH_CLASSES + u->class]++;
    g->counted[texture]++;
    u->uses++;
    g->cover.count[texture] += real;
    g->placed += real;
    return TZ_OK;
}

/* ---- seeds ----------------------------------------------------------------------- */

/* Appends neighbour j if nothing is paired with it and it has room. */
static void list_one(const tz_growth *g, const tz_growth_spot *q,
                     const tz_growth_view *view, int32_t j, choice *c)
{
    const tz_growth_exemplar *ex = &g->ex[q->texture];
    const tz_growth_near *o = &ex->near.v[ex->unit[c->unit].near + j];
    const int32_t unit = ex->unit[o->unit].stand_in;
    if (unit < 0)
        return;
    const tz_growth_unit *e = &ex->unit[unit];
    const tz_vec2 v = tz_growth_out(view, o->x, o->y);
    const tz_vec3 p =
        tz_domain_wrap(&g->out->domain, (tz_vec3){q->x + v.x, q->y + v.y, 0});
    if (tz_growth_may_stand(g, q->texture, e, p.x, p.y) &&
        (!tz_growth_is_decided(g, p.x, p.y) || tz_growth_error(g, q->texture) < sparse) &&
        fits_nearly(ex, e, o->x, o->y, view,
                    tz_growth_error(g, q->texture) < 0 ? slack : 1))
        c->near[c->n++] = (int8_t)j;
}

/* What the unit has and the output has not, in its first ring; of things larger than it
 * in the whole neighbourhood, and these first: later they would not find room. */
static void list_new(const tz_growth *g, const tz_growth_spot *q, uint64_t used,
                     const tz_growth_view *view, choice *c)
{
    const tz_growth_exemplar *ex = &g->ex[q->texture];
    const tz_growth_unit *u = &ex->unit[c->unit];
    const tz_growth_near *near = ex->near.v + u->near;
    c->n = 0;
    for (int32_t j = 0; j < u->nears && u->larger; j++)
        if (!(used >> j & 1) && tz_growth_is_larger(&near[j], u))
            list_one(g, q, view, j, c);
    for (int32_t j = 0; j < u->ring; j++)
        if (!(used >> j & 1) && !tz_growth_is_larger(&near[j], u))
            list_one(g, q, view, j, c);
}

static const tz_growth_unit *stand_in(const tz_growth_exemplar *ex,
                                      const tz_growth_near *o)
{
    return &ex->unit[ex->unit[o->unit].stand_in];
}

/* What the output has of the rarest class that a choice would add, over what is due. */
static float rarity(const tz_growth *g, int32_t texture, const choice *c)
{
    const tz_growth_exemplar *ex = &g->ex[texture];
    const tz_growth_near *near = ex->near.v + ex->unit[c->unit].near;
    float least = 0;
    for (int32_t k = 0; k < c->n; k++) {
        const float over =
            tz_growth_surplus(g, texture, stand_in(ex, &near[c->near[k]])->class);
        least = k == 0 ? over : fminf(least, over);
    }
    return least + 1;
}

/* An exemplar that wraps could be copied without end, tile by tile: its own continuation
 * fits best. After a third of its width that begins to cost, until another place of the
 * exemplar, if any fits as well as it costs, takes over. */
static float weariness(const tz_growth_exemplar *ex, const tz_growth_spot *q)
{
    const float most = 0.33F * sqrtf((float)ex->n);
    return ex->torus ? fminf(weary_most, weary * fmaxf(0, (float)q->run - most)) : 0;
}

/* The best unit; false if none passes the test. */
static bool choose(const tz_growth *g, const tz_growth_spot *q,
                   const tz_growth_view *view, tz_growth_visiting how, choice *best)
{
    const tz_growth_exemplar *ex = &g->ex[q->texture];
    const tz_growth_unit *m = &ex->unit[q->match];
    int32_t unit[TZ_GROWTH_COHERENT + 1], n = 0;
    float cost[TZ_GROWTH_COHERENT + 1], least = INFINITY, score = INFINITY;
    uint64_t used[TZ_GROWTH_COHERENT + 1];
    const bool loose = how != TZ_GROWTH_STRICT;
    const bool again = q->visits > 1 && !loose; /* who knows no more is not asked again */
    if (!again || m->known)
        unit[n++] = q->match;
    for (int32_t k = 0; k < m->coherents && how != TZ_GROWTH_MEND; k++)
        if (!again || ex->unit[m->coherent[k]].known)
            unit[n++] = m->coherent[k];
    for (int32_t k = 0; k < n; k++) {
        cost[k] = noise + tz_growth_cost(ex, unit[k], view,
                                         least * (float)g->params.ratio, &used[k]);
        if (unit[k] == q->match)
            cost[k] += weariness(ex, q);
        least = fminf(least, cost[k]);
    }
    for (int32_t k = 0; k < n; k++) {
        choice c = {.unit = unit[k], .cost = cost[k]};
        if (!loose && cost[k] > least * (float)g->params.ratio)
            continue;
        list_new(g, q, used[k], view, &c);
        const float value =
            cost[k] * powf(rarity(g, q->texture, &c), 8 * (float)g->params.balance);
        if (value < score)
            score = value, *best = c;
    }
    return score < INFINITY;
}

/* Whether a neighbour may be copied to a place, by density and class. */
static bool is_wanted(const tz_growth *g, const tz_growth_exemplar *ex,
                      const tz_growth_unit *u, float cost, bool decided,
                      const tz_growth_view *view)
{
    const float error = tz_growth_error(g, ex->number);
    const float class =
        cost < well ? 0
                    : fminf(1, 4 * (float)g->params.balance *
                                   fmaxf(0, tz_growth_surplus(g, ex->number, u->class)));
    if (u->source < 0) /* a void takes no room from others */
        return !decided;
    if (decided)
        return error < sparse &&
               is_welcome(g, ex, u, class + mending * (error - sparse), view);
    if (cost >= well && error > crowded)
        return false;
    if (class > 0 || (cost >= well && error > dense))
        return is_welcome(g, ex, u, class + density_gain * fmaxf(0, error), view);
    return true;
}

/* Where the output is too sparse, a place that is taken in part will do: away from those
 * that take it, if there is room not far off. */
static bool push_out(const tz_growth *g, const tz_growth_exemplar *ex,
                     const tz_growth_unit *u, double *x, double *y, tz_growth_view *there)
{
    const tz_growth_body body = tz_growth_body_of(u);
    const float most = push * u->spacing;
    float dx = 0, dy = 0;
    if (tz_growth_error(g, ex->number) >= 0 || u->source < 0)
        return false;
    for (int32_t k = 0; k < PUSHES; k++) {
        float px = 0, py = 0;
        for (int32_t i = 0; i < there->n; i++) {
            const tz_growth_seen *o = &there->v[i];
            const float ox = dx - o->x, oy = dy - o->y, d = sqrtf(ox * ox + oy * oy);
            if (d >= 1.01F * tz_growth_bound(ex, &body, o))
                continue;
            const float lack = 1.01F * tz_growth_apart(ex, &body, -ox, -oy, o) - d;
            if (lack > 0 && d > 0)
                px += ox / d * lack, py += oy / d * lack;
        }
        dx += px, dy += py;
        if (dx * dx + dy * dy > most * most)
            return false;
        if (tz_growth_fits(ex, u, dx, dy, there)) {
            const tz_vec2 v = tz_growth_out(there, dx, dy);
            *x += v.x, *y += v.y;
            tz_growth_look(g, *x, *y, g->wide, -1, there);
            const tz_vec3 p = tz_domain_wrap(&g->out->domain, (tz_vec3){*x, *y, 0});
            return tz_growth_may_stand(g, ex->number, u, p.x, p.y) &&
                   tz_growth_fits(ex, u, 0, 0, there);
        }
    }
    return false;
}

/* Copies what has been chosen. */
static tz_status copy(tz_growth *g, int32_t seed, const choice *c,
                      const tz_growth_view *view, int32_t *grown)
{
    const tz_growth_spot q = g->spot.v[seed];
    const tz_growth_exemplar *ex = &g->ex[q.texture];
    const tz_growth_near *near = &ex->near.v[ex->unit[c->unit].near];
    for (int32_t k = 0; k < c->n; k++) {
        const tz_growth_near *e = &near[c->near[k]];
        const int32_t unit = ex->unit[e->unit].stand_in;
        const tz_vec2 v = tz_growth_out(view, e->x, e->y);
        tz_growth_view there;
        if (g->params.most > 0 && g->placed >= g->params.most)
            break;
        double x = q.x + v.x, y = q.y + v.y;
        tz_growth_look(g, x, y, g->wide, -1, &there);
        const int32_t shown = tz_growth_show(g, q.texture, unit, x, y, &there);
        const tz_growth_unit *u = &ex->unit[shown];
        if (c->strict && tz_growth_is_twin(g, q.texture, shown))
            continue;
        if ((!tz_growth_fits(ex, u, 0, 0, &there) &&
             (c->cost < well || !push_out(g, ex, u, &x, &y, &there))) ||
            !is_wanted(g, ex, u, c->cost, c->decided >> k & 1, &there))
            continue;
        const tz_status s = tz_growth_place(g, q.texture, unit, shown, x, y, &there);
        if (s != TZ_OK)
            return s;
        g->spot.v[g->spot.n - 1].run = (int16_t)(q.run < 30000 ? q.run + 1 : q.run);
        ++*grown;
    }
    return TZ_OK;
}

/* Which of the chosen stand where something was decided before. */
static uint64_t list_decided(const tz_growth *g, const tz_growth_spot *q, const choice *c,
                             const tz_growth_view *view)
{
    const tz_growth_exemplar *ex = &g->ex[q->texture];
    const tz_growth_near *near = &ex->near.v[ex->unit[c->unit].near];
    uint64_t decided = 0;
    for (int32_t k = 0; k < c->n; k++) {
        const tz_vec2 v = tz_growth_out(view, near[c->near[k]].x, near[c->near[k]].y);
        if (tz_growth_is_decided(g, q->x + v.x, q->y + v.y))
            decided |= (uint64_t)1 << k;
    }
    return decided;
}

tz_status tz_growth_visit(tz_growth *g, int32_t seed, tz_growth_visiting how,
                          int32_t *grown)
{
    tz_growth_view view;
    tz_growth_spot *q = &g->spot.v[seed];
    choice c = {0};
    *grown = 0;
    q->visits++;
    if (how != TZ_GROWTH_MEND &&
        tz_growth_undecided(g, q) <= (q->visits > 1 ? pieces : crumbs))
        return TZ_OK;
    tz_growth_look(g, q->x, q->y, g->ex[q->texture].unit[q->match].sight, seed, &view);
    if (!choose(g, q, &view, how, &c)) {
        q->waiting = true;
        return TZ_OK;
    }
    c.decided = list_decided(g, q, &c, &view);
    c.strict = how == TZ_GROWTH_STRICT;
    q->run = c.unit == q->match ? q->run : 0;
    q->match = c.unit;
    tz_growth_decide(g, q, c.unit);
    const tz_status s = copy(g, seed, &c, &view, grown);
    q = &g->spot.v[seed];
    if (s == TZ_OK && how != TZ_GROWTH_MEND && !g->ex[q->texture].unit[c.unit].known &&
        q->visits < VISITS)
        tz_growth_enqueue(g, seed); /* another unit may know the rest */
    return s;
}
