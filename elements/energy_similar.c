/* SPDX-License-Identifier: Apache-2.0 */
/* The k-coherence sets: for each sample of the exemplar, which others of its label lie in
 * the most alike neighbourhoods.
 *
 * To pair every two would be quadratic in what is dear. Instead a neighbourhood is described
 * by what it sounds like: with neighbours at x_j of label l_j,
 *
 *      d_f = sum over j:  w(|x_j|) sign_f(l_j) exp(i k_f x_j)
 *
 * for waves k_f drawn as a Gaussian's spectrum. The distance of two descriptors is then
 * about that of the two densities, blurred and label by label (unlike labels have unlike
 * signs, so that they cancel), which for like neighbourhoods grows as the pairing's cost
 * does. Descriptors are compared with all of the label, SCAN at most, eight at once; only
 * the SHORTLIST nearest are paired.
 * @source Rahimi, Recht: Random features for large-scale kernel machines, NIPS 2007
 *   (descriptor); [Ma11] Sec. 3.2 (sets) */
#include <assert.h>
#include <string.h>

#include "elements/energy_internal.h"

enum {
    MOST = TZ_PAIRING_MOST,
    FEW = 48,       /* samples of a label that are all paired with each other */
    SCAN = 2048,    /* of larger labels, so many, evenly chosen, are looked at */
    SHORTLIST = 32, /* of these, so many are paired */
    WAVES = 16,
    LENGTH = 2 * WAVES,
    EARLY = 12, /* of these, where most candidates are already seen to be too far */
    LANES = 8,
    STREAM = 0x656e77
};
#define BLUR 0.6 /* of densities, in limits */

typedef float lanes __attribute__((vector_size(4 * LANES)));

typedef struct similar_job {
    tz_energy_exemplar *x;
    float wave[4][WAVES]; /* turns for a unit of x, y, a, b */
    float *descriptor;    /* LENGTH a sample */
    float *block;    /* the same of candidates: [block][feature][lane], label by label */
    int32_t *first;  /* of each label: its first block */
    int32_t *chosen; /* of each label: how many candidates; 0 = all are paired */
} similar_job;

/* ---- descriptors ----------------------------------------------------------------- */

/* Directions by the golden angle, lengths by the quantiles of the spectrum. */
static void make_waves(similar_job *job)
{
    const double unit = 1 / (2 * TZ_PI * BLUR * job->x->limit);
    for (int32_t f = 0; f < WAVES; f++) {
        tz_rng r = tz_rng_make(STREAM, (uint64_t)f);
        const double k = unit * sqrt(-2 * log(1 - (f + 0.5) / WAVES));
        const double turn = f * 2.399963229728653;
        const double other = unit * sqrt(-2 * log(1 - tz_rng_unit(&r)));
        const double around = 2 * TZ_PI * tz_rng_unit(&r);
        job->wave[0][f] = (float)(k * cos(turn)),
        job->wave[1][f] = (float)(k * sin(turn));
        job->wave[2][f] = (float)(other * cos(around));
        job->wave[3][f] = (float)(other * sin(around));
    }
}

/* Signs of a label, one bit a wave. */
static uint32_t signs_of(float label)
{
    uint32_t h = (uint32_t)(int32_t)label * 0x9e3779b1u;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    h = (h ^ h >> 12) * 0x297a2d39u;
    return h ^ h >> 15;
}

/* A sine but for 6 %, of turns: parabolas. */
static inline float sine(float turn)
{
    const float t = turn - (float)(int32_t)(turn + (turn < 0 ? -0.5f : 0.5f));
    return 8 * t * (1 - 2 * (t < 0 ? -t : t));
}

/* What is farther away than the radius counts less and less. */
static float weight_of(const tz_energy_exemplar *x, const tz_pairing_side *s, int32_t j)
{
    if (s->l[j] >= (float)x->labels) /* the element's own */
        return 1;
    const double r = sqrt((double)(s->x[j] * s->x[j] + s->y[j] * s->y[j]));
    const double t = (x->radius + 0.5 * x->limit - r) / x->limit;
    return (float)fmin(fmax(t, 0), 1);
}

static tz_status describe(tz_ctx *ctx, void *arg, int64_t k, int worker)
{
    (void)ctx, (void)worker;
    similar_job *job = arg;
    const tz_energy_exemplar *x = job->x;
    const tz_pairing_side *s = &x->side[k];
    float *d = &job->descriptor[(ptrdiff_t)k * LENGTH];
    const float *kx = job->wave[0], *ky = job->wave[1];
    const float *ka = job->wave[2], *kb = job->wave[3];
    memset(d, 0, LENGTH * sizeof *d);
    if (job->chosen[x->label[k]] == 0)
        return TZ_OK;
    for (int32_t j = 0; j < s->n; j++) {
        const float weight = weight_of(x, s, j);
        const float a = x->attributes ? s->a[j] : 0, b = x->attributes ? s->b[j] : 0;
        const uint32_t signs = signs_of(s->l[j]);
        for (int32_t f = 0; f < WAVES; f++) {
            const float w = signs >> f & 1 ? weight : -weight;
            const float turn = kx[f] * s->x[j] + ky[f] * s->y[j] + ka[f] * a + kb[f] * b;
            d[f] += w * sine(turn);
            d[WAVES + f] += w * sine(turn + 0.25f);
        }
    }
    return TZ_OK;
}

/* Which sample of a label is its c-th candidate, as a place in by_label. */
static int32_t candidate(const similar_job *job, int32_t label, int32_t c)
{
    const int32_t begin = job->x->label_first[label];
    const int32_t n = job->x->label_first[label + 1] - begin;
    return begin + (int32_t)((int64_t)c * n / job->chosen[label]);
}

static void lay_out(similar_job *job)
{
    const tz_energy_exemplar *x = job->x;
    for (int32_t l = 0; l < x->labels; l++)
        for (int32_t c = 0; c < job->chosen[l]; c++) {
            const int32_t k = x->by_label[candidate(job, l, c)];
            const float *d = &job->descriptor[(ptrdiff_t)k * LENGTH];
            float *to =
                &job->block[(ptrdiff_t)(job->first[l] + c / LANES) * LENGTH * LANES];
            for (int32_t f = 0; f < LENGTH; f++)
                to[f * LANES + c % LANES] = d[f];
        }
}

/* ---- the nearest ----------------------------------------------------------------- */

/* Insertion into a list of the least; what is not less than the last stays out. */
static void keep_least(int32_t *id, float *cost, int32_t k, int32_t other, float c)
{
    int32_t i = k - 1;
    assert(k > 0);
    if (!(c < cost[i]))
        return;
    for (; i > 0 && c < cost[i - 1]; i--)
        id[i] = id[i - 1], cost[i] = cost[i - 1];
    id[i] = other, cost[i] = c;
}

static inline void add_up(lanes *sum, const float *block, const float *d, int32_t begin,
                          int32_t end)
{
    for (int32_t f = begin; f < end; f++) {
        lanes v;
        memcpy(&v, block + (ptrdiff_t)f * LANES, sizeof v);
        v -= d[f];
        *sum += v * v;
    }
}

static inline bool none_below(const lanes *sum, float most)
{
    int32_t below = 0;
    for (int32_t i = 0; i < LANES; i++)
        below |= (*sum)[i] < most;
    return below == 0;
}

/* Candidates of nearest descriptor, nearest first. */
static int32_t shorten(const similar_job *job, int32_t k, int32_t *list)
{
    const int32_t label = job->x->label[k], n = job->chosen[label];
    const float *d = &job->descriptor[(ptrdiff_t)k * LENGTH];
    float cost[SHORTLIST];
    for (int32_t i = 0; i < SHORTLIST; i++)
        cost[i] = INFINITY, list[i] = -1;
    for (int32_t c = 0; c < n; c += LANES) {
        const float *block =
            &job->block[(ptrdiff_t)(job->first[label] + c / LANES) * LENGTH * LANES];
        lanes sum = {0};
        add_up(&sum, block, d, 0, EARLY);
        if (none_below(&sum, cost[SHORTLIST - 1]))
            continue;
        add_up(&sum, block, d, EARLY, LENGTH);
        for (int32_t i = 0; i < LANES && c + i < n; i++)
            if (sum[i] < cost[SHORTLIST - 1])
                keep_least(list, cost, SHORTLIST, c + i, sum[i]);
    }
    int32_t found = 0;
    while (found < SHORTLIST && list[found] >= 0)
        found++;
    return found;
}

/* The neighbourhood within the radius alone. */
static void take_inner(const tz_energy_exemplar *x, int32_t k, tz_pairing_side *out)
{
    const tz_pairing_side *s = &x->side[k];
    out->n = 0;
    for (int32_t j = 0; j < s->n; j++) {
        const int32_t to = out->n;
        if (!tz_energy_within(x, k, j))
            continue;
        out->x[to] = s->x[j], out->y[to] = s->y[j];
        out->a[to] = s->a[j], out->b[to] = s->b[j];
        out->l[to] = s->l[j];
        out->n++;
    }
    tz_pairing_sort(out, NULL);
}

static tz_status find_similar(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    (void)ctx, (void)worker;
    const similar_job *job = arg;
    tz_energy_exemplar *x = job->x;
    const int32_t k = (int32_t)i, label = x->label[k], most = x->coherent;
    const int32_t begin = x->label_first[label];
    const bool all = job->chosen[label] == 0;
    int32_t list[SHORTLIST];
    float cost[64];
    int32_t *similar = &x->similar[(ptrdiff_t)k * most];
    tz_pairing w;
    tz_pairing_side wanted;
    w.attributes = x->attributes;
    w.limit = (float)(x->limit * x->limit);
    w.weight = NULL;
    take_inner(x, k, &wanted);
    for (int32_t j = 0; j < most; j++)
        similar[j] = -1, cost[j] = INFINITY;
    const int32_t n = all ? x->label_first[label + 1] - begin : shorten(job, k, list);
    for (int32_t j = 0; j < n; j++) {
        const int32_t other =
            x->by_label[all ? begin + j : candidate(job, label, list[j])];
        if (other != k)
            keep_least(similar, cost, most, other,
                       tz_pairing_best(&w, &wanted, &x->side[other], cost[most - 1]));
    }
    return TZ_OK;
}

static tz_status reserve(similar_job *job)
{
    const tz_energy_exemplar *x = job->x;
    size_t blocks = 0;
    tz_status s = tz_alloc(x->ctx, &job->first, (size_t)x->labels, sizeof *job->first);
    if (s == TZ_OK)
        s = tz_alloc(x->ctx, &job->chosen, (size_t)x->labels, sizeof *job->chosen);
    for (int32_t l = 0; s == TZ_OK && l < x->labels; l++) {
        const int32_t n = x->label_first[l + 1] - x->label_first[l];
        job->chosen[l] = n <= FEW ? 0 : n < SCAN ? n : SCAN;
        job->first[l] = (int32_t)blocks;
        blocks += (size_t)(job->chosen[l] + LANES - 1) / LANES;
    }
    if (s == TZ_OK)
        s = tz_alloc(x->ctx, &job->descriptor, (size_t)x->n * LENGTH,
                     sizeof *job->descriptor);
    if (s == TZ_OK)
        s = tz_alloc_zero(x->ctx, &job->block, blocks * LENGTH * LANES,
                          sizeof *job->block);
    return s;
}

tz_status tz_energy_find_similar(tz_energy_exemplar *x)
{
    similar_job job = {.x = x};
    make_waves(&job);
    tz_status s = reserve(&job);
    if (s == TZ_OK)
        s = tz_parallel_for(x->ctx, x->n, describe, &job);
    if (s == TZ_OK) {
        lay_out(&job);
        s = tz_parallel_for(x->ctx, x->n, find_similar, &job);
    }
    tz_free(x->ctx, job.block);
    tz_free(x->ctx, job.descriptor);
    tz_free(x->ctx, job.chosen);
    tz_free(x->ctx, job.first);
    return s;
}
