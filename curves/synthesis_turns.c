/* SPDX-License-Identifier: Apache-2.0 */
/* Orientations: how many a sample has is the rounded mean of what it is taken for; which
 * ones, the mean of those that are matched with each. Where there are too few the median
 * of what found no partner is added (and, seldom, others at random); where there are too
 * many the one goes whose votes vary most.
 * @source [Tu20] Sec. 4.3.4, Fig. 9, Eq. (6). Deviates: means and the median are those of
 *   directions (vectors), so that they do not depend on where 0 lies */
#include <string.h>

#include "curves/synthesis_internal.h"

enum { MOST = 16 /* orientations of a sample */, MOST_LEFT = 256 };

/* Sums of the votes of each orientation of a sample, and those without a partner. */
typedef struct poll {
    double x[MOST], y[MOST];
    double votes[MOST];
    double left[MOST_LEFT];
    int32_t lefts;
} poll;

static int32_t at_most(int32_t n, int32_t most) { return n < most ? n : most; }

static void count_vote(poll *p, const double *turn, int32_t n, const double *vote,
                       int32_t m, double frame, double weight)
{
    double b[MOST];
    int32_t to[MOST];
    bool used[MOST] = {false};
    m = at_most(m, MOST);
    for (int32_t k = 0; k < m; k++)
        b[k] = tz_curve_angle(vote[k] + frame);
    if (n > 0 && m > 0)
        tz_match_turns(turn, n, b, m, to);
    for (int32_t k = 0; k < n && m > 0; k++)
        if (to[k] >= 0) {
            p->x[k] += weight * cos(b[to[k]]);
            p->y[k] += weight * sin(b[to[k]]);
            p->votes[k] += weight;
            used[to[k]] = true;
        }
    for (int32_t k = 0; k < m; k++)
        if (!used[k] && p->lefts < MOST_LEFT)
            p->left[p->lefts++] = b[k];
}

/* The direction of least sum of angles to all others. */
static int32_t median(const poll *p)
{
    double least = INFINITY;
    int32_t best = 0;
    for (int32_t i = 0; i < p->lefts; i++) {
        double sum = 0;
        for (int32_t j = 0; j < p->lefts; j++)
            sum += tz_curve_angle_between(p->left[i], p->left[j]);
        if (sum < least) {
            least = sum;
            best = i;
        }
    }
    return best;
}

/* 1 - the length of the mean vector: the circular variance. */
static double variance(const poll *p, int32_t k)
{
    return p->votes[k] > 0 ? 1 - hypot(p->x[k], p->y[k]) / p->votes[k] : 2;
}

/* New orientations of a sample. @return how many */
static int32_t elect(const tz_curve_solve *t, int32_t s, double *turn, tz_rng *r)
{
    const tz_curve_sample *me = &t->o.sample.v[s];
    const tz_curve_votes *v = &t->votes;
    const tz_sample_graph *g = &t->x->g;
    const double frame = tz_curve_solve_frame(t, me->at);
    int32_t n = at_most(me->turns, MOST);
    double seen = 0, sum = 0;
    poll p;
    memset(&p, 0, sizeof p);
    for (int32_t k = v->first[s]; k < v->first[s + 1]; k++) {
        if (v->seen[k] < 0 || t->x->cut[v->seen[k]])
            continue;
        const tz_curve_sample *q = &g->sample.v[v->seen[k]];
        const double w = (double)v->weight[v->centre[k]];
        count_vote(&p, t->o.turn.v + me->turn, n, g->turn.v + q->turn, q->turns, frame,
                   w);
        sum += w * q->turns;
        seen += w;
    }
    for (int32_t k = 0; k < n; k++)
        turn[k] = p.votes[k] > 0 ? tz_curve_angle(atan2(p.y[k], p.x[k]))
                                 : t->o.turn.v[me->turn + k];
    if (!(seen > 0))
        return n;
    const int32_t want = at_most((int32_t)floor(sum / seen + 0.5), MOST);
    for (bool first = true; n < want && p.lefts > 0; first = false) {
        const int32_t k = first ? median(&p) : tz_rng_below(r, p.lefts);
        turn[n++] = p.left[k];
        p.left[k] = p.left[--p.lefts];
    }
    while (n > want) {
        int32_t worst = 0;
        for (int32_t k = 1; k < n; k++)
            worst = variance(&p, k) > variance(&p, worst) ? k : worst;
        for (int32_t k = worst; k + 1 < n; k++) {
            turn[k] = turn[k + 1];
            p.x[k] = p.x[k + 1], p.y[k] = p.y[k + 1], p.votes[k] = p.votes[k + 1];
        }
        n--;
    }
    return n;
}

typedef struct turning {
    const tz_curve_solve *t;
    double *turn;   /* MOST a sample */
    int32_t *turns; /* per sample */
} turning;

static tz_status turn_block(tz_ctx *ctx, void *arg, int64_t block, int worker)
{
    turning *k = arg;
    const tz_curve_solve *t = k->t;
    const int32_t n = t->o.sample.n;
    (void)ctx, (void)worker;
    for (int32_t s = (int32_t)block * 256; s < n && s < ((int32_t)block + 1) * 256; s++) {
        const uint64_t round = (uint64_t)t->level * 1024 + (uint64_t)t->iteration;
        tz_rng r = tz_rng_make(t->job->seed, tz_rng_stream(0x7042e, round, (uint64_t)s));
        const tz_curve_sample *p = &t->o.sample.v[s];
        if (!p->fixed) {
            k->turns[s] = elect(t, s, k->turn + (size_t)s * MOST, &r);
            continue;
        }
        k->turns[s] = at_most(p->turns, MOST);
        for (int32_t i = 0; i < k->turns[s]; i++)
            k->turn[(size_t)s * MOST + (size_t)i] = t->o.turn.v[p->turn + i];
    }
    return TZ_OK;
}

/* next holds the samples that stay, in order, then those added. */
tz_status tz_curve_solve_turns(tz_curve_solve *t, tz_sample_graph *next)
{
    turning k = {.t = t};
    const int32_t n = t->o.sample.n;
    int32_t at = 0;
    tz_status s = tz_alloc(t->ctx, &k.turn, (size_t)n * MOST, sizeof *k.turn);
    if (s == TZ_OK)
        s = tz_alloc(t->ctx, &k.turns, (size_t)n, sizeof *k.turns);
    if (s == TZ_OK)
        s = tz_parallel_for(t->ctx, (n + 255) / 256, turn_block, &k);
    for (int32_t i = 0; i < n && s == TZ_OK; i++) {
        if (t->drop[i])
            continue;
        next->sample.v[at].turn = next->turn.n;
        next->sample.v[at++].turns = k.turns[i];
        for (int32_t j = 0; j < k.turns[i] && s == TZ_OK; j++)
            s = tz_array_push(t->ctx, &next->turn, k.turn[(size_t)i * MOST + (size_t)j]);
    }
    for (; at < next->sample.n && s == TZ_OK; at++) { /* as the exemplar's sample */
        tz_curve_sample *p = &next->sample.v[at];
        const int32_t like = p->turn;
        const double frame = tz_curve_solve_frame(t, p->at);
        p->turn = next->turn.n;
        p->turns = 0;
        if (like < 0)
            continue;
        const tz_curve_sample *q = &t->x->g.sample.v[like];
        for (int32_t j = 0; j < q->turns && s == TZ_OK; j++, p->turns++)
            s = tz_array_push(t->ctx, &next->turn,
                              tz_curve_angle(t->x->g.turn.v[q->turn + j] + frame));
    }
    tz_free(t->ctx, k.turn);
    tz_free(t->ctx, k.turns);
    return s;
}
