/* SPDX-License-Identifier: Apache-2.0 */
/* Search step: who are a sample's neighbours, which exemplar neighbourhood is most like
 * theirs, and who pairs with whom in it. All samples at once: each reads the matches and
 * votes of the round before, so that the result does not depend on threads.
 *
 * Candidates (k-coherence): the match it has; the exemplar samples as which its
 * neighbours' matches see it (votes); samples alike to those; a few at random, which let
 * it leave a poor match that all its neighbours share.
 * @source [Ma11] Sec. 3.2 and 4.2; Tong et al.: Synthesis of bidirectional texture
 *   functions on arbitrary surfaces, SIGGRAPH 2002 */
#include <string.h>

#include "base/rng.h"
#include "elements/energy_internal.h"

enum {
    NEAR = TZ_ENERGY_NEAR,
    MOST = TZ_PAIRING_MOST,
    BLOCK = 32,       /* samples of one item of the parallel loop */
    RANDOM_FIRST = 8, /* random candidates, first and later rounds */
    RANDOM = 1,
    STREAM = 0x656e73 /* names the draws of this file */
};

typedef struct scratch {
    tz_pairing pairing;
    tz_pairing_side side;
    tz_nearby found[NEAR];
    int32_t order[NEAR]; /* place in the list of neighbours of each column of the side */
    float weight[NEAR];  /* of each column */
    int32_t best_to[NEAR];
    int32_t *stamp; /* of each exemplar sample: last search that tried it */
    int32_t now;
} scratch;

typedef struct search_job {
    tz_energy_state *t;
    int32_t *match; /* new ones */
    int32_t round;
} search_job;

/* What one sample's search knows so far. */
typedef struct quest {
    tz_energy_state *t;
    scratch *w;
    int32_t o, best;
    double cost; /* of the best, with the term of Eq. (6) */
    tz_vec2 q;   /* attributes of the centre */
    double frame, cosine, sine;
    double scale, size; /* of distances, and of things, against the exemplar's */
    bool plain;         /* the frame is the exemplar's */
    bool border;        /* Eq. (6) matters here */
} quest;

double tz_energy_frame(const tz_energy_state *t, tz_vec3 at)
{
    return t->hook && t->hook->frame ? t->hook->frame(t->hook->user, at)
                                     : tz_domain_frame(&t->set->domain, at);
}

double tz_energy_inside(const tz_energy_state *t, tz_vec3 at)
{
    const tz_domain *d = &t->set->domain;
    if (t->hook && t->hook->inside)
        return t->hook->inside(t->hook->user, at);
    if (!d->torus && !(at.x >= 0 && at.y >= 0 && at.x < d->size.x && at.y < d->size.y))
        return 0;
    if (!d->region)
        return 1;
    const double depth = tz_region_distance(d->region, at) / (0.5 * t->x->spacing);
    return fmin(fmax(1 + depth, 0), 1);
}

/* ---- neighbours ------------------------------------------------------------------ */

/* Where frames thin out, elements move apart but their own samples do not: of the way from
 * sample a to b only what lies between centres is longer. The rest of it: */
static tz_vec2 way_within(const tz_element *of_a, tz_vec3 a, const tz_element *of_b,
                          tz_vec3 b)
{
    return (tz_vec2){b.x - of_b->at.x - (a.x - of_a->at.x),
                     b.y - of_b->at.y - (a.y - of_a->at.y)};
}

static tz_vec2 within_output(const quest *k, int32_t id)
{
    const tz_energy_state *t = k->t;
    const tz_element *e = t->set->element.v;
    return way_within(&e[t->owner[k->o]], t->at[k->o], &e[t->owner[id]], t->at[id]);
}

static tz_vec2 within_exemplar(const tz_energy_exemplar *x, int32_t a, int32_t b)
{
    const tz_element *e = x->set->element.v;
    const tz_sample *p = x->set->sample.v;
    return way_within(&e[x->owner[a]], p[a].at, &e[x->owner[b]], p[b].at);
}

static void add_neighbour(quest *k, const tz_nearby *v, bool own)
{
    tz_energy_state *t = k->t;
    tz_pairing_side *s = &k->w->side;
    const int32_t id = v->id, label = t->label[id], j = s->n++;
    s->x[j] = v->x, s->y[j] = v->y;
    s->a[j] = (float)t->attribute[id].x, s->b[j] = (float)t->attribute[id].y;
    if (!k->plain) { /* o^-1 of Eq. (7) */
        const double cosine = k->cosine / k->scale, sine = k->sine / k->scale;
        double x = (double)v->x, y = (double)v->y;
        if (k->scale != k->size) {
            const tz_vec2 u = within_output(k, id);
            const double more = k->scale / k->size - 1;
            x += more * u.x, y += more * u.y;
        }
        s->x[j] = (float)(cosine * x + sine * y);
        s->y[j] = (float)(cosine * y - sine * x);
        if (t->x->attributes) {
            const tz_element *e = &t->set->element.v[t->owner[id]];
            const tz_vec2 q = tz_energy_attribute(t->x, e, k->frame);
            s->a[j] = (float)(q.x / k->size), s->b[j] = (float)(q.y / k->size);
        }
    }
    s->l[j] = label < 0 ? -1 : (float)(label + (own ? t->x->labels : 0));
    t->near[(ptrdiff_t)k->o * NEAR + j] = id;
}

static int32_t sort_ids(tz_nearby *v, int32_t n)
{
    for (int32_t i = 1; i < n; i++) {
        const tz_nearby p = v[i];
        int32_t j = i;
        for (; j > 0 && v[j - 1].id > p.id; j--)
            v[j] = v[j - 1];
        v[j] = p;
    }
    return n;
}

/* The element's own samples, whatever their distance, and the nearest others; by rising
 * number, as the assignment wants them. */
static void gather(quest *k)
{
    tz_energy_state *t = k->t;
    const tz_element *e = &t->set->element.v[t->owner[k->o]];
    const tz_vec3 at = t->at[k->o];
    tz_nearby list[NEAR], *found = k->w->found;
    int32_t n = 0;
    for (int32_t m = e->sample; m < e->sample + e->samples && n < NEAR / 2; m++)
        if (t->place[m] != k->o) {
            const int32_t id = t->place[m];
            const tz_vec3 v = tz_domain_vector(&t->set->domain, at, t->at[id]);
            list[n++] = (tz_nearby){.x = (float)v.x, .y = (float)v.y, .id = id};
        }
    const int32_t near =
        tz_cells_near(&t->cells, t->at, at, k->scale * t->x->radius, k->o, found, NEAR);
    for (int32_t m = 0; m < near && n < NEAR; m++)
        if (t->owner[found[m].id] != t->owner[k->o])
            list[n++] = found[m];
    sort_ids(list, n);
    k->w->side.n = 0;
    for (int32_t j = 0; j < n; j++)
        add_neighbour(k, &list[j], t->owner[list[j].id] == t->owner[k->o]);
    t->count[k->o] = n;
    tz_pairing_sort(&k->w->side, k->w->order);
    for (int32_t j = 0; t->weighted && j < n; j++)
        k->w->weight[j] = t->weight[list[k->w->order[j]].id];
}

/* ---- candidates ------------------------------------------------------------------ */

/* Eq. (6): neighbours of e that would come to lie outside, or in a zone that is not for
 * them, as areas of the square of one element. */
static double outside(const quest *k, int32_t e)
{
    const tz_energy_state *t = k->t;
    const tz_pairing_side *s = &t->x->side[e];
    const tz_vec3 at = t->at[k->o];
    const double cosine = k->scale * k->cosine, sine = k->scale * k->sine;
    double sum = 0;
    for (int32_t j = 0; j < s->n; j++) {
        if (!tz_energy_within(t->x, e, j))
            continue;
        const double x = (double)s->x[j], y = (double)s->y[j];
        const tz_vec3 p = {at.x + cosine * x - sine * y, at.y + sine * x + cosine * y,
                           at.z};
        const int32_t id = t->x->member[(ptrdiff_t)e * MOST + j];
        const int32_t kind = t->x->set->element.v[t->x->owner[id]].kind;
        const double in =
            tz_domain_allows(&t->set->domain, p, kind) ? tz_energy_inside(t, p) : 0;
        sum += (1 - in) * (1 - in);
    }
    return t->border * sum * t->x->spacing * t->x->spacing;
}

static bool at_border(const tz_energy_state *t, tz_vec3 p, double scale)
{
    const double r = scale * t->x->radius;
    const tz_vec3 size = t->set->domain.size;
    if (!(t->border > 0))
        return false;
    if ((t->hook && t->hook->inside) || t->set->domain.zones)
        return true;
    if (t->set->domain.region && tz_region_distance(t->set->domain.region, p) < r)
        return true;
    return !t->set->domain.torus &&
           !(p.x > r && p.y > r && p.x < size.x - r && p.y < size.y - r);
}

static void try_candidate(quest *k, int32_t e)
{
    const tz_energy_exemplar *x = k->t->x;
    scratch *w = k->w;
    if (e < 0 || w->stamp[e] == w->now || x->label[e] != k->t->label[k->o])
        return;
    w->stamp[e] = w->now;
    const double da = k->q.x - (double)x->a[e], db = k->q.y - (double)x->b[e];
    const double own = da * da + db * db;
    const double extra = k->border ? outside(k, e) : 0;
    if (!(own + extra < k->cost))
        return;
    const float c = tz_pairing_best(&w->pairing, &w->side, &x->side[e],
                                    (float)(k->cost - own - extra));
    if (!isfinite(c) || !(own + extra + (double)c < k->cost))
        return;
    k->best = e;
    k->cost = own + (double)c + extra;
    memcpy(w->best_to, w->pairing.to, (size_t)w->side.n * sizeof *w->best_to);
}

/* First round, when nobody has voted yet: as what does a neighbour's match see me? */
static int32_t seen_by(const quest *k, int32_t j)
{
    const tz_energy_exemplar *x = k->t->x;
    const int32_t id_of = k->t->near[(ptrdiff_t)k->o * NEAR + k->w->order[j]];
    const int32_t match = k->t->match[id_of];
    if (match < 0)
        return -1;
    const tz_pairing_side *s = &x->side[match];
    float least = INFINITY;
    int32_t found = -1;
    for (int32_t m = 0; m < s->n; m++) {
        const int32_t id = x->member[(ptrdiff_t)match * MOST + m];
        const float dx = s->x[m] + k->w->side.x[j], dy = s->y[m] + k->w->side.y[j];
        const float d = dx * dx + dy * dy;
        if (x->label[id] == k->t->label[k->o] && d < least)
            least = d, found = id;
    }
    return found;
}

static void try_all(quest *k, int32_t round)
{
    tz_energy_state *t = k->t;
    const tz_energy_exemplar *x = t->x;
    const int32_t label = t->label[k->o], begin = x->label_first[label];
    const int32_t n = x->label_first[label + 1] - begin;
    try_candidate(k, t->match[k->o]);
    for (int32_t v = t->vote_first[k->o]; v < t->vote_first[k->o + 1]; v++)
        try_candidate(k, t->vote.v[v]);
    for (int32_t j = 0; round == 0 && j < k->w->side.n; j++)
        try_candidate(k, seen_by(k, j));
    const int32_t head = k->best;
    for (int32_t j = 0; head >= 0 && j < x->coherent; j++)
        try_candidate(k, x->similar[(ptrdiff_t)head * x->coherent + j]);
    tz_rng r = tz_rng_make(
        t->seed, tz_rng_stream(STREAM, (uint64_t)t->sample[k->o], (uint64_t)round));
    for (int32_t j = round ? RANDOM : RANDOM_FIRST; j > 0; j--)
        try_candidate(k, x->by_label[begin + tz_rng_below(&r, n)]);
}

/* ---- results --------------------------------------------------------------------- */

static void keep_pairs(const quest *k)
{
    tz_energy_state *t = k->t;
    const tz_energy_exemplar *x = t->x;
    for (int32_t j = 0; j < t->count[k->o]; j++) {
        const ptrdiff_t at = (ptrdiff_t)k->o * NEAR + k->w->order[j];
        const int32_t m = k->best < 0 ? -1 : k->w->best_to[j];
        t->pair[at] = -1;
        t->pull[at] = (tz_energy_pull){0, 0};
        if (m < 0)
            continue;
        const tz_pairing_side *s = &x->side[k->best], *mine = &k->w->side;
        const double cosine = k->scale * k->cosine, sine = k->scale * k->sine;
        const int32_t partner = x->member[(ptrdiff_t)k->best * MOST + m];
        double dx = (double)(s->x[m] - mine->x[j]);
        double dy = (double)(s->y[m] - mine->y[j]);
        tz_vec2 more = {0, 0};
        if (k->scale != k->size) {
            const tz_vec2 e = within_exemplar(x, k->best, partner);
            const double by = 1 - k->size / k->scale;
            dx -= by * e.x, dy -= by * e.y;
            more = tz_vec2_scale(within_output(k, t->near[at]), k->scale / k->size - 1);
        }
        t->pair[at] = partner;
        t->pull[at] = (tz_energy_pull){(float)(cosine * dx - sine * dy + more.x),
                                       (float)(sine * dx + cosine * dy + more.y)};
    }
}

static void search_one(tz_energy_state *t, scratch *w, search_job *job, int32_t o)
{
    quest k = {.t = t, .w = w, .o = o, .best = -1, .cost = INFINITY};
    const tz_element *e = &t->set->element.v[t->owner[o]];
    k.frame = tz_energy_frame(t, t->at[o]);
    k.cosine = k.frame != 0 ? cos(k.frame) : 1;
    k.sine = k.frame != 0 ? sin(k.frame) : 0;
    k.scale = tz_domain_apart(&t->set->domain, t->at[o]);
    k.size = tz_domain_scale(&t->set->domain, t->at[o]);
    k.plain = k.frame == 0 && k.scale == 1 && k.size == 1;
    k.q = k.plain ? t->attribute[o]
                  : tz_vec2_scale(tz_energy_attribute(t->x, e, k.frame), 1 / k.size);
    k.border = at_border(t, t->at[o], k.scale);
    gather(&k);
    if (w->now == INT32_MAX) {
        memset(w->stamp, 0, (size_t)t->x->n * sizeof *w->stamp);
        w->now = 0;
    }
    w->now++;
    if (t->label[o] >= 0)
        try_all(&k, job->round);
    job->match[o] = k.best;
    t->cost[o] = k.best < 0 ? 0 : k.cost * (double)t->weight[o];
    keep_pairs(&k);
}

static tz_status search_block(tz_ctx *ctx, void *arg, int64_t block, int worker)
{
    (void)ctx;
    search_job *job = arg;
    tz_energy_state *t = job->t;
    scratch *w = (scratch *)t->worker + worker;
    const int32_t begin = (int32_t)block * BLOCK;
    const int32_t end = begin + BLOCK < t->n ? begin + BLOCK : t->n;
    for (int32_t o = begin; o < end; o++)
        search_one(t, w, job, o);
    return TZ_OK;
}

static tz_status make_scratch(tz_energy_state *t, scratch **out)
{
    const int workers = tz_ctx_threads(t->ctx);
    const float limit = (float)(t->x->limit * t->x->limit);
    tz_status s = tz_alloc_zero(t->ctx, out, (size_t)workers, sizeof **out);
    for (int i = 0; i < workers && s == TZ_OK; i++) {
        scratch *w = &(*out)[i];
        w->pairing.attributes = t->x->attributes;
        w->pairing.limit = limit;
        w->pairing.weight = t->weighted ? w->weight : NULL;
        s = tz_alloc_zero(t->ctx, &w->stamp, (size_t)t->x->n, sizeof *w->stamp);
    }
    return s;
}

static void note_attributes(tz_energy_state *t)
{
    for (int32_t i = 0; i < t->set->element.n; i++) {
        const tz_element *e = &t->set->element.v[i];
        const tz_vec2 q = tz_energy_attribute(t->x, e, 0);
        for (int32_t k = e->sample; k < e->sample + e->samples; k++)
            t->attribute[t->place[k]] = q;
    }
}

tz_status tz_energy_search(tz_energy_state *t, int32_t round, double *energy)
{
    tz_ctx *ctx = t->ctx;
    scratch *w = NULL;
    const tz_frames *f = t->set->domain.frames;
    search_job job = {.t = t, .round = round};
    tz_status s = tz_cells_fill(ctx, &t->cells, &t->set->domain, t->at, t->n,
                                t->x->radius * (f && f->apart ? f->apart_most : 1));
    if (s == TZ_OK)
        s = tz_alloc(ctx, &job.match, (size_t)t->n, sizeof *job.match);
    if (s == TZ_OK)
        s = make_scratch(t, &w);
    t->worker = w;
    note_attributes(t);
    if (s == TZ_OK)
        s = tz_parallel_for(ctx, (t->n + BLOCK - 1) / BLOCK, search_block, &job);
    if (s == TZ_OK) {
        int32_t *old = t->match;
        t->match = job.match, job.match = old;
        *energy = 0;
        for (int32_t o = 0; o < t->n; o++)
            *energy += t->cost[o];
    }
    for (int i = 0; w && i < tz_ctx_threads(ctx); i++)
        tz_free(ctx, w[i].stamp);
    tz_free(ctx, w);
    tz_free(ctx, job.match);
    t->worker = NULL;
    return s == TZ_OK ? tz_energy_votes(t) : s;
}

tz_status tz_energy_votes(tz_energy_state *t)
{
    int32_t *first = t->vote_first, edges = 0;
    memset(first, 0, ((size_t)t->n + 2) * sizeof *first);
    for (int32_t o = 0; o < t->n; o++)
        for (int32_t j = 0; j < t->count[o]; j++)
            if (t->pair[(ptrdiff_t)o * NEAR + j] >= 0)
                first[t->near[(ptrdiff_t)o * NEAR + j] + 2]++, edges++;
    tz_status s = tz_array_reserve(t->ctx, &t->vote, edges);
    if (s == TZ_OK)
        s = tz_array_reserve(t->ctx, &t->edge, edges);
    if (s != TZ_OK) {
        memset(first, 0, ((size_t)t->n + 2) * sizeof *first);
        return s;
    }
    for (int32_t o = 0; o <= t->n; o++)
        first[o + 1] += first[o];
    for (int32_t o = 0; o < t->n; o++)
        for (int32_t j = 0; j < t->count[o]; j++) {
            const int32_t at = o * NEAR + j;
            if (t->pair[at] < 0)
                continue;
            const int32_t v = first[t->near[at] + 1]++;
            t->vote.v[v] = t->pair[at];
            t->edge.v[v] = at;
        }
    t->vote.n = t->edge.n = edges;
    return TZ_OK;
}
