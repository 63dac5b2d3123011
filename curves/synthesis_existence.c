/* SPDX-License-Identifier: Apache-2.0 */
/* Existence: which samples go and which come.
 *
 * A sample stays if at least half of the neighbourhoods that hold it have a partner for
 * it. What neighbourhoods of the exemplar hold and the output's lack are candidates;
 * those within half a spacing of each other are one, and it comes if more than half of
 * the neighbourhoods that reach its place name it.
 *
 * Samples of an element go and come together.
 * @source [Tu20] Eq. (15), App. A, Algorithm 1. Deviates: neighbourhoods say nothing of
 *   places beyond the exemplar's border; a candidate nearer than 0.4 spacings to a sample
 *   that stays is none, as that sample will move there; of samples nearer than that to
 *   each other the one that fewer see goes */
#include <stdlib.h>
#include <string.h>

#include "base/grid.h"
#include "curves/synthesis_internal.h"

#define SAME     0.5  /* of the samples' distance: candidates of one cluster */
#define CROWDED  0.4  /* of the samples' distance: samples too near */
#define FAR_AWAY 0.5  /* of the spacing: beyond the border */
#define DRIFT    0.05 /* of the spacing: a cluster's centre before it is filed anew */

typedef struct cluster {
    tz_vec2 at; /* mean */
    tz_vec2 filed;
    int32_t n;
    int32_t q;
    int32_t item; /* in the grid */
    int32_t like; /* exemplar's sample of the first candidate */
} cluster;

typedef struct existence {
    tz_curve_solve *t;
    TZ_ARRAY(cluster)
    cluster;
    TZ_ARRAY(int32_t)
    owner;        /* cluster of each item of the grid */
    tz_grid grid; /* clusters */
    tz_grid kept; /* samples that stay, where they go to */
} existence;

static tz_status make_grid(const tz_curve_solve *t, tz_grid *grid, double cell)
{
    const tz_domain *d = t->job->domain;
    const double m = d->torus ? 0 : t->margin;
    const tz_vec2 from = {-m, -m}, size = {d->size.x + 2 * m, d->size.y + 2 * m};
    return tz_grid_init(t->ctx, grid, from, size, cell, d->torus);
}

static tz_vec2 target(const tz_curve_solve *t, int32_t s)
{
    return tz_vec2_add(t->o.sample.v[s].at, t->move[s]);
}

/* ---- what goes --------------------------------------------------------------------- */

static double confidence(const tz_curve_solve *t, int32_t s)
{
    double yes = 0, all = 0;
    for (int32_t k = t->votes.first[s]; k < t->votes.first[s + 1]; k++) {
        const double w = (double)t->votes.weight[t->votes.centre[k]];
        yes += t->votes.seen[k] >= 0 ? w : 0;
        all += t->votes.seen[k] != TZ_SEEN_UNKNOWN ? w : 0;
    }
    return all > 0 ? yes / all : t->match.v[s] >= 0;
}

/* Elements as wholes: the mean of their samples. */
static tz_status share_elements(tz_curve_solve *t)
{
    double *sum = NULL;
    const size_t n = (size_t)t->body.n;
    tz_status s = tz_alloc_zero(t->ctx, &sum, 2 * n, sizeof *sum);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < t->o.sample.n; i++) {
        const tz_curve_sample *p = &t->o.sample.v[i];
        if (p->element >= 0) {
            sum[2 * p->element] += p->existence;
            sum[2 * p->element + 1] += 1;
        }
    }
    for (int32_t i = 0; i < t->o.sample.n; i++) {
        tz_curve_sample *p = &t->o.sample.v[i];
        if (p->element >= 0)
            p->existence = sum[2 * p->element] / sum[2 * p->element + 1];
    }
    tz_free(t->ctx, sum);
    return TZ_OK;
}

static tz_status find_drops(tz_curve_solve *t)
{
    const double far = -FAR_AWAY * t->o.spacing;
    for (int32_t i = 0; i < t->o.sample.n; i++)
        t->o.sample.v[i].existence = confidence(t, i);
    tz_status s = share_elements(t);
    for (int32_t i = 0; i < t->o.sample.n && s == TZ_OK; i++) {
        tz_curve_sample *p = &t->o.sample.v[i];
        const bool weak = t->p.existence && p->existence < 0.5;
        const bool away = p->element < 0 && tz_curve_solve_depth(t, target(t, i)) < far;
        if (p->fixed)
            p->existence = 1;
        t->drop[i] = !p->fixed && (weak || away);
    }
    return s;
}

static bool weaker(const tz_curve_solve *t, int32_t a, int32_t b)
{
    const tz_curve_sample *p = &t->o.sample.v[a], *q = &t->o.sample.v[b];
    if (p->fixed != q->fixed)
        return q->fixed;
    if (p->existence != q->existence)
        return p->existence < q->existence;
    if (t->cost[a] != t->cost[b])
        return t->cost[a] > t->cost[b];
    return a > b;
}

/* Of samples of curves that lie on each other one goes. */
static tz_status thin(tz_curve_solve *t)
{
    enum { MOST = 64 };
    const double near = CROWDED * t->x->apart;
    int32_t found[MOST], id;
    tz_grid grid = {0};
    tz_status s = make_grid(t, &grid, t->o.spacing);
    for (int32_t i = 0; i < t->o.sample.n && s == TZ_OK; i++)
        s = tz_grid_add(t->ctx, &grid, target(t, i), &id);
    for (int32_t i = 0; i < t->o.sample.n && s == TZ_OK; i++) {
        if (t->drop[i] || t->o.sample.v[i].q != TZ_SAMPLE_CURVE)
            continue;
        const int32_t n = tz_grid_query(&grid, target(t, i), near, found, MOST);
        for (int32_t k = 0; k < (n < MOST ? n : MOST) && !t->drop[i]; k++) {
            const int32_t j = found[k];
            if (j == i || t->drop[j] || t->o.sample.v[j].q != TZ_SAMPLE_CURVE ||
                (t->o.sample.v[i].fixed && t->o.sample.v[j].fixed))
                continue;
            t->drop[weaker(t, i, j) ? i : j] = true;
        }
    }
    tz_grid_deinit(t->ctx, &grid);
    return s;
}

/* ---- what comes -------------------------------------------------------------------- */

/* The cluster of that q nearest to a place, or -1. */
static int32_t nearest_cluster(const existence *e, tz_vec2 at, int32_t q, double radius)
{
    enum { MOST = 64 };
    int32_t found[MOST], best = -1;
    double least = radius;
    const int32_t n = tz_grid_query(&e->grid, at, radius * (1 + 2 * DRIFT), found, MOST);
    for (int32_t k = 0; k < (n < MOST ? n : MOST); k++) {
        const int32_t c = e->owner.v[found[k]];
        const double d =
            tz_vec2_length(tz_curve_vector(e->t->job->domain, at, e->cluster.v[c].at));
        if (e->cluster.v[c].q == q && d < least) {
            least = d;
            best = c;
        }
    }
    return best;
}

static tz_status file_cluster(existence *e, int32_t c)
{
    cluster *k = &e->cluster.v[c];
    k->filed = k->at;
    const tz_status s = tz_grid_add(e->t->ctx, &e->grid,
                                    tz_curve_wrapped(e->t->job->domain, k->at), &k->item);
    return s == TZ_OK ? tz_array_push(e->t->ctx, &e->owner, c) : s;
}

static tz_status add_candidate(existence *e, tz_vec2 at, int32_t like)
{
    tz_curve_solve *t = e->t;
    const int32_t q = t->x->g.sample.v[like].q;
    const double radius = SAME * t->x->apart;
    const int32_t c = nearest_cluster(e, at, q, radius);
    if (c < 0) {
        const cluster k = {.at = at, .n = 1, .q = q, .like = like};
        const tz_status s = tz_array_push(t->ctx, &e->cluster, k);
        return s == TZ_OK ? file_cluster(e, e->cluster.n - 1) : s;
    }
    cluster *k = &e->cluster.v[c];
    const tz_vec2 way = tz_curve_vector(t->job->domain, k->at, at);
    k->n++;
    k->at = tz_vec2_add(k->at, tz_vec2_scale(way, 1.0 / k->n));
    if (tz_vec2_length(tz_vec2_sub(k->at, k->filed)) < DRIFT * radius)
        return TZ_OK;
    tz_grid_remove(&e->grid, k->item);
    return file_cluster(e, c);
}

/* What the match of a centre has and the centre lacks. */
static tz_status find_candidates(existence *e, int32_t centre)
{
    const tz_curve_solve *t = e->t;
    const tz_match_hoods *ho = &t->m.ho, *hi = &t->m.hi;
    const int32_t si = t->match.v[centre];
    const double r = t->x->g.radius;
    const double frame = tz_curve_solve_frame(t, t->o.sample.v[centre].at);
    bool taken[TZ_MATCH_MOST] = {false};
    tz_status s = TZ_OK;
    if (si < 0)
        return s;
    const int32_t a = hi->first[si], n = hi->first[si + 1] - a;
    for (int32_t k = ho->first[centre]; k < ho->first[centre + 1]; k++)
        for (int32_t j = 0; j < n && t->pair[k] >= 0; j++)
            if (hi->id[a + j] == t->pair[k])
                taken[j] = true;
    for (int32_t j = 0; j < n && s == TZ_OK; j++) {
        const tz_vec2 v = {(double)hi->x[a + j], (double)hi->y[a + j]};
        const int32_t like = hi->id[a + j];
        if (taken[j] || t->x->cut[like] || tz_vec2_length(v) > r)
            continue;
        s = add_candidate(e, tz_vec2_add(target(t, centre), tz_curve_rotate(v, frame)),
                          like);
    }
    return s;
}

static bool is_free(const existence *e, tz_vec2 at, int32_t q)
{
    enum { MOST = 32 };
    int32_t found[MOST];
    const tz_curve_solve *t = e->t;
    const int32_t n = tz_grid_query(&e->kept, at, CROWDED * t->x->apart, found, MOST);
    for (int32_t k = 0; k < (n < MOST ? n : MOST); k++)
        if (!t->drop[found[k]] && t->o.sample.v[found[k]].q == q)
            return false;
    return true;
}

/* How many neighbourhoods reach a place. */
static int32_t count_reach(const existence *e, tz_vec2 at)
{
    int32_t any;
    return tz_grid_query(&e->kept, at, e->t->x->g.radius, &any, 1);
}

static tz_status take_clusters(existence *e)
{
    tz_curve_solve *t = e->t;
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < e->cluster.n && s == TZ_OK; i++) {
        const cluster *c = &e->cluster.v[i];
        const tz_vec2 at = tz_curve_wrapped(t->job->domain, c->at);
        const int32_t reach = count_reach(e, at);
        const double exists = reach > 0 ? (double)c->n / reach : 0;
        if (!(exists > 0.5) || tz_curve_solve_depth(t, at) < 0 || !is_free(e, at, c->q))
            continue;
        s = tz_array_push(t->ctx, &t->extra,
                          ((tz_curve_sample){.at = at,
                                             .q = c->q,
                                             .turn = c->like,
                                             .element = -1,
                                             .existence = fmin(exists, 1)}));
    }
    return s;
}

static tz_status find_extras(tz_curve_solve *t)
{
    existence e = {.t = t};
    int32_t id;
    tz_status s = make_grid(t, &e.grid, SAME * t->x->apart);
    if (s == TZ_OK)
        s = make_grid(t, &e.kept, t->o.spacing);
    for (int32_t i = 0; i < t->o.sample.n && s == TZ_OK; i++)
        s = tz_grid_add(t->ctx, &e.kept, tz_curve_wrapped(t->job->domain, target(t, i)),
                        &id);
    for (int32_t i = 0; i < t->o.sample.n && s == TZ_OK; i++)
        s = find_candidates(&e, i);
    if (s == TZ_OK)
        s = take_clusters(&e);
    tz_grid_deinit(t->ctx, &e.grid);
    tz_grid_deinit(t->ctx, &e.kept);
    tz_array_free(t->ctx, &e.cluster);
    tz_array_free(t->ctx, &e.owner);
    return s;
}

tz_status tz_curve_solve_existence(tz_curve_solve *t)
{
    tz_status s = tz_alloc_zero(t->ctx, &t->drop, (size_t)t->o.sample.n, sizeof *t->drop);
    if (s == TZ_OK)
        s = find_drops(t);
    if (s == TZ_OK && t->p.existence)
        s = thin(t);
    if (s == TZ_OK && t->p.existence && !t->last)
        s = find_extras(t);
    return s;
}
