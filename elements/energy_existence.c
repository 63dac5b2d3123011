/* SPDX-License-Identifier: Apache-2.0 */
/* Existence: least squares move elements but cannot make or end any. Between two
 * iterations
 *
 *   - an element that few of the neighbourhoods about it have a partner for, or that
 *     crowds another closer than things of the exemplar lie, goes;
 *   - where matched neighbourhoods expect something that is not there,
 *
 *          o   o            each o's match has a neighbour at x that none of o's own
 *            x     o        neighbours is paired with: if many agree, an element of the
 *          o   o            kind that most of them expect is put there
 *
 * Thresholds lean towards the exemplar's density, and what would lead more than SLACK
 * away from it is not done. [Ma11] has no such step; [Dav19] Sec. 4 and [Tu20] Sec. 4.3
 * let existence be voted for in a like way. */
#include <stdlib.h>
#include <string.h>

#include "elements/element_density.h"
#include "elements/energy_internal.h"

enum { MOST = TZ_PAIRING_MOST, NEAR = TZ_ENERGY_NEAR, STREAM = 0x656e78 };
#define SLACK 0.03

/* Somebody expects an element. */
typedef struct wish {
    tz_vec3 at;
    int32_t source; /* element of the exemplar */
    int32_t votes;
} wish;

typedef struct census {
    tz_energy_state *t;
    int32_t round;
    double expected; /* elements */
    double crowd;    /* nearer than this is too near */
    float *support;  /* of each element: share of those who see it that have a partner */
    uint8_t *drop;
    int32_t dropped;
    TZ_ARRAY(wish)
    wish; /* most wanted first */
    TZ_ARRAY(int32_t)
    pick;           /* wishes that come true */
    int32_t strong; /* wishes that should, if others made room */
    double mean;    /* neighbours within the radius */
    tz_vec3 *at;    /* of elements */
    tz_cells cells;
} census;

/* ---- sets without some elements -------------------------------------------------- */

tz_status tz_energy_drop(tz_element_set *s, const uint8_t *drop, int32_t *carry)
{
    TZ_ARRAY(tz_sample)
    kept = {0};
    int32_t *moved = NULL, elements = 0;
    tz_status st = tz_array_reserve(s->ctx, &kept, s->sample.n);
    if (st == TZ_OK && carry)
        st = tz_alloc(s->ctx, &moved, (size_t)s->sample.n, sizeof *moved);
    if (st != TZ_OK) {
        tz_array_free(s->ctx, &kept);
        return st;
    }
    for (int32_t i = 0; i < s->element.n; i++) {
        tz_element e = s->element.v[i];
        if (drop[i])
            continue;
        const int32_t first = kept.n;
        for (int32_t k = e.sample; k < e.sample + e.samples; k++) {
            if (carry)
                moved[kept.n] = carry[k];
            kept.v[kept.n++] = s->sample.v[k];
        }
        e.sample = first;
        s->element.v[elements++] = e;
    }
    if (carry)
        memcpy(carry, moved, (size_t)kept.n * sizeof *carry);
    s->element.n = elements;
    tz_free(s->ctx, moved);
    tz_free(s->ctx, s->sample.v);
    s->sample.v = kept.v, s->sample.n = kept.n, s->sample.cap = kept.cap;
    return TZ_OK;
}

/* ---- what the exemplar is like --------------------------------------------------- */

static int by_value(const void *a, const void *b)
{
    const double p = *(const double *)a, q = *(const double *)b;
    return (p > q) - (p < q);
}

/* Three quarters of the distance that all but a twentieth of the elements keep from
 * their nearest. */
static tz_status find_crowd(census *c)
{
    const tz_element_set *from = c->t->x->set;
    const int32_t n = from->element.n;
    tz_cells cells = {0};
    tz_vec3 *at = NULL;
    double *d = NULL;
    tz_status s = tz_alloc(c->t->ctx, &at, (size_t)n, sizeof *at);
    if (s == TZ_OK)
        s = tz_alloc(c->t->ctx, &d, (size_t)n, sizeof *d);
    for (int32_t i = 0; i < n && s == TZ_OK; i++)
        at[i] = from->element.v[i].at;
    if (s == TZ_OK)
        s = tz_cells_fill(c->t->ctx, &cells, &from->domain, at, n, c->t->x->spacing);
    for (int32_t i = 0; i < n && s == TZ_OK; i++) {
        tz_nearby one;
        const int32_t found =
            tz_cells_near(&cells, at, at[i], c->t->x->spacing, i, &one, 1);
        d[i] = found ? sqrt((double)one.dist2) : c->t->x->spacing;
    }
    if (s == TZ_OK) {
        qsort(d, (size_t)n, sizeof *d, by_value);
        c->crowd = 0.75 * d[n / 20];
    }
    tz_cells_free(c->t->ctx, &cells);
    tz_free(c->t->ctx, at);
    tz_free(c->t->ctx, d);
    return s;
}

/* ---- too many -------------------------------------------------------------------- */

/* Of those who see an element, how many have a partner for it less than half a spacing
 * from where it is. */
static tz_status find_support(census *c)
{
    const tz_energy_state *t = c->t;
    const int32_t n = t->set->element.n;
    const double half = 0.5 * t->x->spacing;
    int32_t *seen = NULL;
    int64_t all = 0;
    tz_status s = tz_alloc_zero(t->ctx, &seen, (size_t)n, sizeof *seen);
    if (s == TZ_OK)
        s = tz_alloc_zero(t->ctx, &c->support, (size_t)n, sizeof *c->support);
    for (int32_t o = 0; o < t->n && s == TZ_OK; o++)
        for (int32_t j = 0; j < t->count[o] && t->match[o] >= 0; j++) {
            const ptrdiff_t at = (ptrdiff_t)o * NEAR + j;
            const int32_t e = t->owner[t->near[at]];
            const tz_energy_pull p = t->pull[at];
            if (e == t->owner[o])
                continue;
            seen[e]++, all++;
            const double reach = half * tz_domain_apart(&t->set->domain, t->at[o]);
            const float good = (float)(reach * reach);
            c->support[e] += t->pair[at] >= 0 && p.x * p.x + p.y * p.y < good ? 1 : 0;
        }
    for (int32_t i = 0; i < n && s == TZ_OK; i++)
        c->support[i] = seen[i] ? c->support[i] / (float)seen[i] : 1;
    c->mean = (double)all / (t->n > 0 ? t->n : 1);
    tz_free(t->ctx, seen);
    return s;
}

typedef struct ranked {
    float rank;
    int32_t id;
} ranked;

static int by_rank(const void *a, const void *b)
{
    const ranked *p = a, *q = b;
    if (p->rank != q->rank)
        return p->rank < q->rank ? -1 : 1;
    return (p->id > q->id) - (p->id < q->id);
}

/* Does something that stays crowd element i, or has something near it gone already? */
static void look_about(const census *c, int32_t i, bool *crowded, bool *touched)
{
    enum { LOOK = 16 };
    tz_nearby found[LOOK];
    const double scale = tz_domain_apart(&c->t->set->domain, c->at[i]);
    const double reach = scale * c->t->x->spacing, crowd = scale * c->crowd;
    const int32_t n = tz_cells_near(&c->cells, c->at, c->at[i], reach, i, found, LOOK);
    *crowded = *touched = false;
    for (int32_t k = 0; k < n; k++) {
        const bool gone = c->drop[found[k].id] != 0;
        *touched = *touched || gone;
        *crowded = *crowded || (!gone && (double)found[k].dist2 < crowd * crowd);
    }
}

/* The least supported first; neighbours of what has gone wait for the next round. */
static tz_status choose_drops(census *c)
{
    const tz_energy_state *t = c->t;
    const int32_t n = t->set->element.n;
    const double least = n > c->expected ? 0.6 : 0.35;
    /* far too many: half of them may go if some who see them have no partner */
    const double quota = 0.5 * (n + c->strong - (1 + SLACK) * c->expected);
    const double doubtful = 0.85;
    ranked *order = NULL;
    tz_status s = tz_alloc(t->ctx, &order, (size_t)n, sizeof *order);
    if (s == TZ_OK)
        s = tz_alloc_zero(t->ctx, &c->drop, (size_t)n, 1);
    for (int32_t i = 0; i < n && s == TZ_OK; i++)
        order[i] = (ranked){c->support[i], i};
    if (s == TZ_OK)
        qsort(order, (size_t)n, sizeof *order, by_rank);
    for (int32_t k = 0; k < n && s == TZ_OK; k++) {
        const int32_t i = order[k].id;
        bool crowded, touched;
        if (n - c->dropped - 1 + c->strong < (1 - SLACK) * c->expected)
            break;
        if (t->set->element.v[i].fixed)
            continue;
        look_about(c, i, &crowded, &touched);
        const bool surplus = c->dropped < quota && (double)c->support[i] < doubtful;
        if (!touched && (crowded || surplus || (double)c->support[i] < least)) {
            c->drop[i] = 1;
            c->dropped++;
        }
    }
    tz_free(t->ctx, order);
    return s;
}

/* ---- too few --------------------------------------------------------------------- */

static bool is_used(const tz_energy_state *t, int32_t o, int32_t member)
{
    for (int32_t j = 0; j < t->count[o]; j++)
        if (t->pair[(ptrdiff_t)o * NEAR + j] == member)
            return true;
    return false;
}

/* What sample o's match has and o has not. An element of several samples is expected by
 * its first alone. */
static tz_status add_wishes(census *c, int32_t o)
{
    const tz_energy_state *t = c->t;
    const tz_energy_exemplar *x = t->x;
    const int32_t m = t->match[o];
    if (m < 0)
        return TZ_OK;
    const tz_pairing_side *side = &x->side[m];
    const double frame = tz_energy_frame(t, t->at[o]);
    const double scale = tz_domain_apart(&t->set->domain, t->at[o]);
    const double rest = 1 - tz_domain_scale(&t->set->domain, t->at[o]) / scale;
    const double co = scale * cos(frame), si = scale * sin(frame);
    tz_status s = TZ_OK;
    for (int32_t j = 0; j < side->n && s == TZ_OK; j++) {
        if (!tz_energy_within(x, m, j))
            continue;
        const int32_t id = x->member[(ptrdiff_t)m * MOST + j], source = x->owner[id];
        const tz_element *e = &x->set->element.v[source];
        if (source == x->owner[m] || id != e->sample || is_used(t, o, id))
            continue;
        const tz_vec3 p = x->set->sample.v[id].at;
        double dx = (double)side->x[j] + e->at.x - p.x;
        double dy = (double)side->y[j] + e->at.y - p.y;
        if (rest != 0) { /* from the own centre, which is nearer than scaled */
            const tz_vec3 q = x->set->sample.v[m].at;
            const tz_element *own = &x->set->element.v[x->owner[m]];
            dx += rest * (q.x - own->at.x), dy += rest * (q.y - own->at.y);
        }
        const tz_vec3 at = tz_domain_wrap(
            &t->set->domain, (tz_vec3){t->at[o].x + co * dx - si * dy,
                                       t->at[o].y + si * dx + co * dy, e->at.z});
        if (tz_energy_inside(t, at) >= 1 && tz_domain_contains(&t->set->domain, at) &&
            tz_domain_allows(&t->set->domain, at, e->kind))
            s = tz_array_push(t->ctx, &c->wish, ((wish){at, source, 0}));
    }
    return s;
}

static int by_votes(const void *a, const void *b)
{
    const wish *p = a, *q = b;
    if (p->votes != q->votes)
        return p->votes > q->votes ? -1 : 1;
    if (p->at.x != q->at.x)
        return p->at.x < q->at.x ? -1 : 1;
    if (p->at.y != q->at.y)
        return p->at.y < q->at.y ? -1 : 1;
    return (p->source > q->source) - (p->source < q->source);
}

/* Each wish moves to the middle of those near it, and knows how many they are. */
static tz_status count_votes(census *c)
{
    enum { LOOK = 64 };
    const tz_energy_state *t = c->t;
    const int32_t n = c->wish.n;
    const double reach = 0.35 * t->x->spacing;
    const tz_frames *f = t->set->domain.frames;
    const double most = f && f->apart ? f->apart_most : 1;
    tz_cells cells = {0};
    tz_vec3 *at = NULL;
    tz_nearby found[LOOK];
    tz_status s = tz_alloc(t->ctx, &at, (size_t)n, sizeof *at);
    for (int32_t i = 0; i < n && s == TZ_OK; i++)
        at[i] = c->wish.v[i].at;
    if (s == TZ_OK)
        s = tz_cells_fill(t->ctx, &cells, &t->set->domain, at, n, most * reach);
    for (int32_t i = 0; i < n && s == TZ_OK; i++) {
        const double near = reach * tz_domain_apart(&t->set->domain, at[i]);
        const int32_t k = tz_cells_near(&cells, at, at[i], near, -1, found, LOOK);
        tz_vec3 p = at[i];
        for (int32_t j = 0; j < k; j++)
            p.x += (double)found[j].x / k, p.y += (double)found[j].y / k;
        c->wish.v[i].at = tz_domain_wrap(&t->set->domain, p);
        c->wish.v[i].votes = k;
    }
    if (s == TZ_OK && n > 1)
        qsort(c->wish.v, (size_t)n, sizeof *c->wish.v, by_votes);
    tz_cells_free(t->ctx, &cells);
    tz_free(t->ctx, at);
    return s;
}

/* Nothing that stays lies too near, and nothing that comes. */
static bool is_free(const census *c, tz_vec3 at)
{
    enum { LOOK = 16 };
    tz_nearby found[LOOK];
    const double scale = tz_domain_apart(&c->t->set->domain, at);
    const double spacing = scale * c->t->x->spacing;
    const double reach = fmax(scale * c->crowd, 0.35 * spacing);
    const int32_t n = tz_cells_near(&c->cells, c->at, at, reach, -1, found, LOOK);
    for (int32_t k = 0; k < n; k++)
        if (!c->drop || !c->drop[found[k].id])
            return false;
    for (int32_t k = 0; k < c->pick.n; k++) {
        const tz_vec3 p = c->wish.v[c->pick.v[k]].at;
        const tz_vec3 v = tz_domain_vector(&c->t->set->domain, at, p);
        if (hypot(v.x, v.y) < fmax(reach, 0.7 * spacing))
            return false;
    }
    return true;
}

static tz_status find_wishes(census *c)
{
    tz_status s = TZ_OK;
    for (int32_t o = 0; o < c->t->n && s == TZ_OK; o++)
        s = add_wishes(c, o);
    return s == TZ_OK ? count_votes(c) : s;
}

/* Those with enough votes for whom there is room, up to a number of elements. */
static tz_status pick_wishes(census *c, double need, double most)
{
    const int32_t before = c->t->set->element.n - c->dropped;
    tz_status s = TZ_OK;
    c->pick.n = 0;
    for (int32_t k = 0; k < c->wish.n && s == TZ_OK; k++) {
        if (c->wish.v[k].votes < need || before + c->pick.n + 1 > most)
            break;
        if (is_free(c, c->wish.v[k].at))
            s = tz_array_push(c->t->ctx, &c->pick, k);
    }
    return s;
}

/* What nearly all about a place miss. */
static tz_status count_strong(census *c)
{
    const tz_status s = pick_wishes(c, fmax(3, 0.6 * c->mean), HUGE_VAL);
    c->strong = c->pick.n;
    return s;
}

static tz_status choose_wishes(census *c)
{
    const int32_t before = c->t->set->element.n - c->dropped;
    const double share = before < (1 - SLACK) * c->expected ? 0.2
                         : before < c->expected             ? 0.3
                                                            : 0.75;
    return pick_wishes(c, fmax(3, share * c->mean), (1 + SLACK) * c->expected);
}

/* ---- the step -------------------------------------------------------------------- */

static tz_status place_wish(census *c, wish w)
{
    tz_energy_state *t = c->t;
    tz_rng r = tz_rng_make(
        t->seed, tz_rng_stream(STREAM, (uint64_t)t->set->element.n, (uint64_t)c->round));
    const int32_t k = tz_energy_choose(t->x->set, &t->set->domain, w.source, w.at, &r);
    return k < 0 ? TZ_OK
                 : tz_element_set_place(t->set, t->x->set, k, w.at,
                                        tz_energy_frame(t, w.at),
                                        tz_domain_scale(&t->set->domain, w.at));
}

/* The state of the changed set; who had a match keeps it. */
static tz_status renew(census *c)
{
    tz_energy_state *t = c->t;
    const tz_energy_params p = {.seed = t->seed, .border = t->border, .shape = t->shape};
    const tz_energy_hook *hook = t->hook;
    const tz_energy_exemplar *x = t->x;
    tz_element_set *set = t->set;
    tz_ctx *ctx = t->ctx;
    int32_t *match = NULL, known = 0;
    tz_status s = tz_alloc(t->ctx, &match, (size_t)t->n, sizeof *match);
    for (int32_t o = 0; o < t->n && s == TZ_OK; o++)
        match[t->sample[o]] = t->match[o];
    if (s == TZ_OK)
        s = tz_energy_drop(set, c->drop, match);
    if (s == TZ_OK)
        known = set->sample.n;
    for (int32_t k = 0; k < c->pick.n && s == TZ_OK; k++)
        s = place_wish(c, c->wish.v[c->pick.v[k]]);
    if (s == TZ_OK) {
        tz_energy_state_deinit(t);
        s = tz_energy_state_init(ctx, t, x, set, &p);
        t->ctx = ctx;
        t->hook = hook;
        for (int32_t k = 0; s == TZ_OK && k < known; k++)
            t->match[t->place[k]] = match[k];
    }
    tz_free(ctx, match);
    return s;
}

tz_status tz_energy_existence(tz_energy_state *t, int32_t round, bool *changed)
{
    const int32_t n = t->set->element.n;
    census c = {.t = t,
                .round = round,
                .expected = tz_element_density(t->x->set, true) *
                            tz_domain_area(&t->set->domain)};
    const tz_frames *f = t->set->domain.frames;
    if (t->set->domain.zones ||
        (f && f->apart)) /* densities of their own: stay near them */
        c.expected = n;
    tz_ctx *ctx = t->ctx;
    *changed = false;
    tz_status s = find_crowd(&c);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &c.at, (size_t)n, sizeof *c.at);
    for (int32_t i = 0; i < n && s == TZ_OK; i++)
        c.at[i] = t->set->element.v[i].at;
    if (s == TZ_OK)
        s = tz_cells_fill(ctx, &c.cells, &t->set->domain, c.at, n,
                          t->x->spacing * (f && f->apart ? f->apart_most : 1));
    if (s == TZ_OK)
        s = find_support(&c);
    if (s == TZ_OK)
        s = find_wishes(&c);
    if (s == TZ_OK)
        s = count_strong(&c);
    if (s == TZ_OK)
        s = choose_drops(&c);
    if (s == TZ_OK)
        s = choose_wishes(&c);
    if (s == TZ_OK && (c.dropped > 0 || c.pick.n > 0)) {
        *changed = true;
        s = renew(&c);
    }
    tz_free(ctx, c.support);
    tz_free(ctx, c.drop);
    tz_array_free(ctx, &c.wish);
    tz_array_free(ctx, &c.pick);
    tz_free(ctx, c.at);
    tz_cells_free(ctx, &c.cells);
    return s;
}
