/* SPDX-License-Identifier: Apache-2.0 */
/* What neighbourhoods say, sorted by whom they say it of. A centre speaks of itself, too:
 * it is what it is matched with. Centres come in rising order, so that those which two
 * samples have in common are found by running along both lists. */
#include "curves/synthesis_internal.h"

#define SURE 0.1 /* spacings */

static void count_votes(const tz_curve_solve *t, int32_t *first)
{
    const tz_match_hoods *h = &t->m.ho;
    for (int32_t c = 0; c < h->n; c++) {
        if (t->match.v[c] < 0)
            continue;
        first[c + 2]++;
        for (int32_t k = h->first[c]; k < h->first[c + 1]; k++)
            first[h->id[k] + 2]++;
    }
    for (int32_t i = 0; i < h->n; i++)
        first[i + 2] += first[i + 1];
}

/* Neighbourhoods that match well say more: 1 / (SURE^2 + q^2) with q their difference for
 * each sample that they hold, in spacings. */
static void weigh(const tz_curve_solve *t, float *weight)
{
    const tz_match_hoods *h = &t->m.ho;
    double sum = 0;
    for (int32_t c = 0; c < h->n; c++) {
        const double held = h->first[c + 1] - h->first[c] + 1;
        const double q = (double)t->cost[c] / (held * t->o.spacing);
        weight[c] = t->match.v[c] < 0 ? 0 : (float)(1 / (SURE * SURE + q * q));
        sum += (double)weight[c];
    }
    for (int32_t c = 0; c < h->n && sum > 0; c++)
        weight[c] *= (float)(h->n / sum);
}

tz_status tz_curve_solve_votes(tz_curve_solve *t)
{
    const tz_match_hoods *h = &t->m.ho;
    const size_t n = (size_t)h->n, most = n + (size_t)h->first[h->n];
    tz_curve_votes *v = &t->votes;
    tz_status s = tz_alloc_zero(t->ctx, &v->first, n + 2, sizeof *v->first);
    if (s == TZ_OK)
        s = tz_alloc(t->ctx, &v->centre, most, sizeof *v->centre);
    if (s == TZ_OK)
        s = tz_alloc(t->ctx, &v->seen, most, sizeof *v->seen);
    if (s == TZ_OK)
        s = tz_alloc(t->ctx, &v->weight, n, sizeof *v->weight);
    if (s != TZ_OK)
        return s;
    weigh(t, v->weight);
    count_votes(t, v->first);
    for (int32_t c = 0; c < h->n; c++) {
        if (t->match.v[c] < 0)
            continue;
        int32_t at = v->first[c + 1]++;
        v->centre[at] = c;
        v->seen[at] = t->match.v[c];
        for (int32_t k = h->first[c]; k < h->first[c + 1]; k++) {
            at = v->first[h->id[k] + 1]++;
            v->centre[at] = c;
            v->seen[at] = t->pair[k];
        }
    }
    return TZ_OK;
}
