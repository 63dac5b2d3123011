/* SPDX-License-Identifier: Apache-2.0 */
/* Seeds, and what is copied around them.
 *
 * A seed that has free room in its first ring looks at its surroundings and at the units
 * that are coherent with its match, best fit first. The unpaired neighbours of the first
 * unit that has any with room in the output are copied ([Dav19] Sec. 5.1, pairs_r). A
 * unit that fits much worse than the best one is not asked (ratio test). Three things
 * differ from the paper:
 *   - only the first ring is copied: what lies farther out is copied when more is known;
 *   - among the units that pass the test those win whose elements are of classes the
 *     output has too few of; the paper's choice starves some (its Fig. 18);
 *   - a place must be welcome: those around it may not get more first neighbours than
 *     their units have. The paper fills every gap that is wide enough, which makes
 *     irregular textures denser than their exemplar by a third and more. */
#include "elements/growth_internal.h"

enum { VISITS = 8 }; /* of a seed at most */

/* Costs below `noise` are as good as none; below `well` balance does not interfere. */
static const float noise = 0.01F, well = 0.1F;
/* Control of density: neighbours that a place must lack for each that others have too
 * many; the error's bounds; what a seed's figure counts for after the next. */
static const float density_gain = 2, density_most = 0.6F, density_least = -0.15F;
/* Cost of a verbatim copy: a step beyond its length, and at most. */
static const float weary = 0.1F, weary_most = 0.4F;
static const float density_memory = 0.9999F;

typedef struct choice {
    int32_t unit, n;
    int8_t near[TZ_GROWTH_NEAR];
    float cost;
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

bool tz_growth_fits(const tz_growth *g, const tz_growth_unit *u, float dx, float dy,
                    const tz_growth_view *view)
{
    for (int32_t i = 0; i < view->n; i++) {
        const tz_growth_seen *o = &view->v[i];
        const float x = o->x - dx, y = o->y - dy;
        const float apart = tz_growth_apart(&g->ex, u->hard, u->r, o->hard, o->r);
        if (x * x + y * y < apart * apart)
            return false;
    }
    return true;
}

/* What a neighbour that lacks some may set against the surplus of others: at the front
 * all lack many, and would pay for a crowd behind it. */
static const float credit = -0.5F;

/* By how many neighbours a spot the output is denser than the exemplar. Units of dense
 * places are matched more often than they should be, for want of a better fit. */
static float density_error(const tz_growth *g)
{
    const float error = g->inner_first / fmaxf(1, g->inner) - g->ex.ring_mean;
    return g->inner < 32 ? 0 : fminf(density_most, fmaxf(density_least, error));
}

/* The same for a class of which there is too much; not where the unit fits well. */
static float class_error(const tz_growth *g, int32_t class, float cost)
{
    const float due = g->ex.frequency[class] * (float)(g->counted + 1);
    const float over = ((float)g->count[class] + 2) / (due + 2) - 1;
    return cost < well ? 0 : fminf(1, 4 * (float)g->params.balance * fmaxf(0, over));
}

/* Whether those around a place have fewer neighbours than their units, on average. */
static bool is_welcome(const tz_growth *g, const tz_growth_unit *u, float cost,
                       const tz_growth_view *view)
{
    const float error = density_gain * density_error(g) + class_error(g, u->class, cost);
    float surplus = 0;
    int32_t first = 0;
    for (int32_t i = 0; i < view->n; i++) {
        const tz_growth_seen *o = &view->v[i];
        const tz_growth_spot *q = &g->spot.v[o->spot];
        first += tz_growth_far(u, o->x, o->y, o->r) <= u->wide;
        if (q->match >= 0) {
            const tz_growth_unit *e = &g->ex.unit[q->match];
            if (tz_growth_far(e, o->x, o->y, u->r) <= e->wide)
                surplus += fmaxf(credit, (float)(q->first + 1 - e->ring_due) + error);
        }
    }
    return surplus <= 0.01F && first <= u->ring_due;
}

/* The new one is a neighbour of those around it. Those that found no room, or no fit, try
 * again. */
static void count_first(tz_growth *g, int32_t spot, const tz_growth_view *view)
{
    tz_growth_spot *p = &g->spot.v[spot];
    const tz_growth_unit *u = &g->ex.unit[p->match];
    for (int32_t i = 0; i < view->n; i++) {
        const tz_growth_seen *o = &view->v[i];
        tz_growth_spot *q = &g->spot.v[o->spot];
        p->first += tz_growth_far(u, o->x, o->y, o->r) <= u->wide;
        if (q->match >= 0) {
            const tz_growth_unit *e = &g->ex.unit[q->match];
            const bool first = tz_growth_far(e, o->x, o->y, p->r) <= e->wide;
            q->first += first;
            if (first && q->waiting && q->visits < VISITS)
                tz_growth_enqueue(g, o->spot);
        }
    }
}

tz_status tz_growth_place(tz_growth *g, int32_t unit, double x, double y,
                          const tz_growth_view *view)
{
    const tz_growth_unit *u = &g->ex.unit[unit];
    const bool real = unit < g->ex.elements;
    const tz_vec3 z = real ? g->ex.set->element.v[unit].at : (tz_vec3){0, 0, 0};
    const tz_vec3 at = tz_domain_wrap(&g->out->domain, (tz_vec3){x, y, z.z});
    tz_status s = tz_growth_reserve(g, 1);
    if (s == TZ_OK && real)
        s = tz_element_set_place(g->out, g->ex.set, unit, at, 0, 1);
    if (s != TZ_OK)
        return s;
    const int32_t i = g->spot.n++;
    g->spot.v[i] = (tz_growth_spot){.x = at.x,
                                    .y = at.y,
                                    .r = u->r,
                                    .c2 = u->c2,
                                    .s2 = u->s2,
                                    .kind = u->kind,
                                    .hard = u->hard,
                                    .match = unit,
                                    .out = real ? g->out->element.n - 1 : -1,
                                    .node = -1};
    tz_growth_link(g, i);
    tz_growth_enqueue(g, i);
    g->round[g->rounds++] = i;
    count_first(g, i, view);
    g->count[u->class]++;
    g->counted++;
    g->placed += real;
    return TZ_OK;
}

/* ---- seeds ----------------------------------------------------------------------- */

static bool has_room(const tz_growth *g, const tz_growth_spot *q,
                     const tz_growth_view *view)
{
    const tz_growth_unit *u = &g->ex.unit[q->match];
    for (int32_t k = 0; k < u->frees; k++) {
        const float fx = (float)u->free[k].x, fy = (float)u->free[k].y;
        const tz_vec3 p = {q->x + fx, q->y + fy, 0};
        const float wide = 0.4F * u->spacing;
        bool taken = !tz_domain_contains(&g->out->domain, p);
        for (int32_t i = 0; i < view->n && !taken; i++) {
            const float x = view->v[i].x - fx, y = view->v[i].y - fy;
            taken = x * x + y * y < wide * wide;
        }
        if (!taken)
            return true;
    }
    return false;
}

/* How many more neighbours a copy of the unit may get: where elements stand that the unit
 * does not have, fewer of its own are copied, which keeps the density. */
static int32_t missing(const tz_growth_unit *u, const tz_growth_view *view)
{
    int32_t n = 0, first = 0;
    for (int32_t i = 0; i < view->n; i++) {
        const tz_growth_seen *o = &view->v[i];
        const float d = tz_growth_far(u, o->x, o->y, o->r);
        n += d <= u->reach;
        first += d <= u->wide;
    }
    return u->due - n < u->ring_due - first ? u->due - n : u->ring_due - first;
}

/* Appends neighbour j if nothing is paired with it and it has room. */
static void list_one(const tz_growth *g, const tz_growth_spot *q,
                     const tz_growth_view *view, int32_t j, choice *c)
{
    const tz_growth_near *o = &g->ex.near.v[g->ex.unit[c->unit].near + j];
    const tz_growth_unit *e = &g->ex.unit[o->unit];
    const tz_vec3 p = {q->x + o->x, q->y + o->y, 0};
    if (e->copied && tz_domain_contains(&g->out->domain, p) &&
        tz_growth_fits(g, e, o->x, o->y, view))
        c->near[c->n++] = (int8_t)j;
}

/* What the unit has and the output has not, in its first ring; of things larger than it
 * in the whole neighbourhood, and these first: later they would not find room. */
static int32_t list_new(const tz_growth *g, const tz_growth_spot *q, uint64_t used,
                        const tz_growth_view *view, choice *c)
{
    const tz_growth_unit *u = &g->ex.unit[c->unit];
    const tz_growth_near *near = g->ex.near.v + u->near;
    const int32_t most = missing(u, view);
    c->n = 0;
    if (most <= 0)
        return 0;
    for (int32_t j = 0; j < u->nears && u->larger; j++)
        if (!(used >> j & 1) && tz_growth_is_larger(&near[j], u))
            list_one(g, q, view, j, c);
    for (int32_t j = 0; j < u->ring && c->n < most; j++)
        if (!(used >> j & 1) && !tz_growth_is_larger(&near[j], u))
            list_one(g, q, view, j, c);
    return c->n;
}

/* What the output has of the rarest class that a choice would add, over what is due. */
static float rarity(const tz_growth *g, const choice *c)
{
    const tz_growth_near *near = g->ex.near.v + g->ex.unit[c->unit].near;
    float least = INFINITY;
    for (int32_t k = 0; k < c->n; k++) {
        const int32_t class = g->ex.unit[near[c->near[k]].unit].class;
        const float due = g->ex.frequency[class] * (float)(g->counted + 1);
        least = fminf(least, ((float)g->count[class] + 2) / (due + 2));
    }
    return least;
}

/* An exemplar that wraps could be copied without end, tile by tile: its own continuation
 * fits best. After a third of its width that begins to cost, until another place of the
 * exemplar, if any fits as well as it costs, takes over. */
static float weariness(const tz_growth *g, const tz_growth_spot *q)
{
    const float most = 0.33F * sqrtf((float)g->ex.n);
    return g->ex.torus ? fminf(weary_most, weary * fmaxf(0, (float)q->run - most)) : 0;
}

/* The best unit that has something to add; false if none passes the test. */
static bool choose(const tz_growth *g, const tz_growth_spot *q,
                   const tz_growth_view *view, bool loose, choice *best)
{
    const tz_growth_unit *m = &g->ex.unit[q->match];
    int32_t unit[TZ_GROWTH_COHERENT + 1], n = 0;
    float cost[TZ_GROWTH_COHERENT + 1], least = INFINITY;
    uint64_t used[TZ_GROWTH_COHERENT + 1];
    unit[n++] = q->match;
    for (int32_t k = 0; k < m->coherents; k++)
        unit[n++] = m->coherent[k];
    for (int32_t k = 0; k < n; k++) {
        cost[k] = noise + tz_growth_cost(&g->ex, unit[k], view, &used[k]);
        if (k == 0)
            cost[k] += weariness(g, q);
        least = fminf(least, cost[k]);
    }
    float score = INFINITY;
    for (int32_t k = 0; k < n; k++) {
        choice c = {.unit = unit[k], .cost = cost[k]};
        if (!list_new(g, q, used[k], view, &c))
            continue;
        const float value = cost[k] * powf(rarity(g, &c), 8 * (float)g->params.balance);
        if (!loose && value > least * (float)g->params.ratio)
            continue;
        if (value < score)
            score = value, *best = c;
    }
    return score < INFINITY;
}

/* The seed has all it will get, for now. */
static void note_inner(tz_growth *g, const tz_growth_spot *q)
{
    g->inner = density_memory * g->inner + 1;
    g->inner_first = density_memory * g->inner_first + q->first;
}

tz_status tz_growth_visit(tz_growth *g, int32_t seed, bool loose, int32_t *grown)
{
    tz_growth_view view;
    tz_growth_spot *q = &g->spot.v[seed];
    const tz_growth_unit *u = &g->ex.unit[q->match];
    choice c = {0};
    *grown = 0;
    q->visits++;
    tz_growth_look(g, q->x, q->y, u->sight, seed, &view);
    if (!has_room(g, q, &view)) {
        note_inner(g, q);
        return TZ_OK;
    }
    if (!choose(g, q, &view, loose, &c)) {
        q->waiting = true;
        note_inner(g, q);
        return TZ_OK;
    }
    const tz_growth_near *near = g->ex.near.v + g->ex.unit[c.unit].near;
    const double x = q->x, y = q->y;
    q->run = c.unit == q->match ? q->run : 0;
    q->match = c.unit;
    const int16_t run = q->run;
    for (int32_t k = 0; k < c.n; k++) {
        const tz_growth_near *e = &near[c.near[k]];
        const tz_growth_unit *eu = &g->ex.unit[e->unit];
        tz_growth_view there;
        if (g->params.most > 0 && g->placed >= g->params.most)
            break;
        tz_growth_look(g, x + e->x, y + e->y, g->ex.wide, -1, &there);
        if (!tz_growth_fits(g, eu, 0, 0, &there) || !is_welcome(g, eu, c.cost, &there))
            continue;
        const tz_status s = tz_growth_place(g, e->unit, x + e->x, y + e->y, &there);
        if (s != TZ_OK)
            return s;
        g->spot.v[g->spot.n - 1].run = (int16_t)(run < 30000 ? run + 1 : run);
        ++*grown;
    }
    q = &g->spot.v[seed];
    if (!*grown)
        q->waiting = true, note_inner(g, q);
    else if (q->visits < VISITS)
        tz_growth_enqueue(g, seed); /* there may be room for another unit's neighbours */
    return TZ_OK;
}
