/* SPDX-License-Identifier: Apache-2.0 */
/* Rectangular assignment. Every row first takes its nearest column: that sum is a lower
 * bound, which dismisses most rivals at once, and the optimum itself if no two rows want
 * the same column. Rows that lost a column are then added one by one along shortest
 * augmenting paths. Each row also has an exit of its own at the cost of staying unpaired.
 * @source Jonker, Volgenant: A shortest augmenting path algorithm for dense and sparse
 *   linear assignment problems, Computing 38, 1987 */
#include "elements/pairing.h"

#include <assert.h>
#include <math.h>
#include <string.h>

/* One row of squared distances, and its least entry. Costs are not negative, so their
 * bits order as they do; the column rides in the lowest bits of the key, which makes the
 * whole loop one that compilers vectorise. */
static int32_t fill_row(const tz_pairing *w, const tz_pairing_side *p, int32_t i,
                        const tz_pairing_side *q, float *restrict row)
{
    const int32_t m = q->n;
    const float x = p->x[i], y = p->y[i], a = p->a[i], b = p->b[i], l = p->l[i];
    for (int32_t j = 0; j < m; j++) {
        const float dx = q->x[j] - x, dy = q->y[j] - y;
        row[j] = dx * dx + dy * dy;
    }
    if (w->attributes)
        for (int32_t j = 0; j < m; j++) {
            const float da = q->a[j] - a, db = q->b[j] - b;
            row[j] += da * da + db * db;
        }
    if (w->labels)
        for (int32_t j = 0; j < m; j++) {
            const float dl = q->l[j] - l;
            row[j] += dl * dl;
        }
    if (w->weight)
        for (int32_t j = 0; j < m; j++)
            row[j] *= w->weight[i];
    int32_t bits[TZ_PAIRING_MOST], least = INT32_MAX;
    memcpy(bits, row, (size_t)m * sizeof *bits);
    for (int32_t j = 0; j < m; j++) {
        const int32_t key = (bits[j] & ~63) | j;
        least = key < least ? key : least;
    }
    return m > 0 ? least & 63 : -1;
}

typedef struct duals {
    float u[TZ_PAIRING_MOST], v[TZ_PAIRING_MOST]; /* of rows and columns */
    int32_t row[TZ_PAIRING_MOST];                 /* that has a column, or -1 */
} duals;

static float limit_of(const tz_pairing *w, int32_t i)
{
    return w->weight ? w->limit * w->weight[i] : w->limit;
}

/* Adds row `start` along the shortest augmenting path (Dijkstra over columns with reduced
 * costs). It ends at a free column or where a row of the path had better stay alone. */
static void augment(tz_pairing *w, duals *d, int32_t start, int32_t m)
{
    float dist[TZ_PAIRING_MOST], end = INFINITY;
    int32_t from[TZ_PAIRING_MOST], order[TZ_PAIRING_MOST], seen = 0;
    bool done[TZ_PAIRING_MOST] = {false};
    int32_t i = start, last = -1, quitter = start;
    float so_far = 0;
    for (int32_t j = 0; j < m; j++)
        dist[j] = INFINITY, from[j] = -1;
    for (;;) {
        const float quit = so_far + (limit_of(w, i) - d->u[i]);
        if (quit < end)
            end = quit, quitter = i;
        int32_t best = -1;
        for (int32_t j = 0; j < m; j++) {
            if (done[j])
                continue;
            const float via = so_far + (w->cost[i][j] - d->u[i] - d->v[j]);
            if (via < dist[j])
                dist[j] = via, from[j] = i;
            if (best < 0 || dist[j] < dist[best])
                best = j;
        }
        if (best < 0 || dist[best] >= end)
            break;
        so_far = dist[best];
        done[best] = true;
        order[seen++] = best;
        if (d->row[best] < 0) {
            last = best, end = so_far, seen--;
            break;
        }
        i = d->row[best];
    }
    d->u[start] += end;
    for (int32_t k = 0; k < seen; k++) {
        const int32_t j = order[k];
        d->u[d->row[j]] += end - dist[j];
        d->v[j] -= end - dist[j];
    }
    if (last < 0 && quitter != start) { /* its column passes back along the path */
        last = w->to[quitter];
        w->to[quitter] = -1;
    } else if (last < 0) {
        w->to[start] = -1;
        return;
    }
    for (;;) {
        const int32_t r = from[last], had = w->to[r];
        w->to[r] = last;
        d->row[last] = r;
        if (r == start)
            return;
        last = had;
    }
}

float tz_pairing_best(tz_pairing *w, const tz_pairing_side *p, const tz_pairing_side *q,
                      float enough)
{
    duals d;
    int32_t lost[TZ_PAIRING_MOST], losers = 0;
    float bound = 0;
    assert(p->n <= TZ_PAIRING_MOST && q->n <= TZ_PAIRING_MOST);
    for (int32_t j = 0; j < q->n; j++)
        d.row[j] = -1, d.v[j] = 0;
    for (int32_t i = 0; i < p->n; i++) {
        const int32_t j = fill_row(w, p, i, q, w->cost[i]);
        const float limit = limit_of(w, i);
        assert(j < q->n);
        const bool pair = j >= 0 && w->cost[i][j] < limit;
        bound += d.u[i] = pair ? w->cost[i][j] : limit;
        if (bound >= enough)
            return INFINITY;
        w->to[i] = -1;
        if (pair && d.row[j] < 0)
            w->to[i] = j, d.row[j] = i;
        else if (pair)
            lost[losers++] = i;
    }
    if (losers == 0)
        return bound;
    for (int32_t k = 0; k < losers; k++)
        augment(w, &d, lost[k], q->n);
    float sum = 0;
    for (int32_t i = 0; i < p->n; i++)
        sum += w->to[i] >= 0 ? w->cost[i][w->to[i]] : limit_of(w, i);
    return sum < enough ? sum : INFINITY;
}
