/* SPDX-License-Identifier: Apache-2.0 */
/* Rectangular assignment, label by label: unlike ones never pair, so the matrix of costs
 * falls into blocks. In each every row first takes its nearest column: that sum is a lower
 * bound, which dismisses most rivals at once, and the optimum itself if no two rows want
 * the same column. Rows that lost a column are then added one by one along shortest
 * augmenting paths, each of which raises the bound by its length. Each row also has an
 * exit of its own at the cost of staying unpaired.
 *
 * The same code is compiled twice, for eight lanes and for what every processor has; the
 * bytes are the same.
 * @source Jonker, Volgenant: A shortest augmenting path algorithm for dense and sparse
 *   linear assignment problems, Computing 38, 1987 */
#include "elements/pairing.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum { MOST = TZ_PAIRING_MOST, ROOM = TZ_PAIRING_ROOM, LANES = 8 };
static_assert(MOST <= 64, "columns ride in the six lowest bits of a key");

#if defined(__x86_64__)
#define WIDE __attribute__((target("avx2")))
#define CORE static inline __attribute__((always_inline))
#else
#define CORE static inline
#endif

typedef float lanes __attribute__((vector_size(4 * LANES)));
typedef int32_t keys __attribute__((vector_size(4 * LANES)));

/* ---- order ----------------------------------------------------------------------- */

static void permute(float *v, const int32_t *order, int32_t n)
{
    float was[MOST];
    memcpy(was, v, (size_t)n * sizeof *v);
    for (int32_t j = 0; j < n; j++)
        v[j] = was[order[j]];
}

void tz_pairing_sort(tz_pairing_side *s, int32_t *order)
{
    int32_t own[MOST], *from = order ? order : own;
    bool sorted = true;
    assert(s->n >= 0 && s->n <= MOST);
    for (int32_t j = 0; j < s->n; j++) {
        int32_t i = j;
        for (; i > 0 && s->l[from[i - 1]] > s->l[j]; i--)
            from[i] = from[i - 1];
        sorted = sorted && i == j;
        from[i] = j;
    }
    if (!sorted) {
        permute(s->x, from, s->n);
        permute(s->y, from, s->n);
        permute(s->a, from, s->n);
        permute(s->b, from, s->n);
        permute(s->l, from, s->n);
    }
    s->runs = 0;
    for (int32_t j = 0; j < s->n; j++)
        if (j == 0 || s->l[j] != s->l[j - 1])
            s->first[s->runs++] = (uint8_t)j;
    s->first[s->runs] = (uint8_t)s->n;
    for (int32_t j = s->n; j < s->n + LANES; j++) /* lanes read beyond the end */
        s->x[j] = s->y[j] = s->a[j] = s->b[j] = s->l[j] = 0;
}

/* ---- one row --------------------------------------------------------------------- */

static const int32_t lane[LANES] = {0, 1, 2, 3, 4, 5, 6, 7};

/* Squared distances from one of p to columns begin..end-1 of q, and which is least. Costs
 * are not negative, so their bits order as they do; the column rides in the lowest bits of
 * the key. Lanes beyond the end get a key that loses. */
CORE int32_t fill_row(const tz_pairing *w, const tz_pairing_side *p, int32_t i,
                      const tz_pairing_side *q, int32_t begin, int32_t end, float *row)
{
    const float x = p->x[i], y = p->y[i], a = p->a[i], b = p->b[i];
    keys least, number;
    memcpy(&number, lane, sizeof number);
    number += begin;
    least = (number & 0) + INT32_MAX;
    for (int32_t j = begin; j < end; j += LANES) {
        lanes dx, dy, cost;
        keys key;
        memcpy(&dx, q->x + j, sizeof dx);
        memcpy(&dy, q->y + j, sizeof dy);
        dx -= x, dy -= y;
        cost = dx * dx + dy * dy;
        if (w->attributes) {
            memcpy(&dx, q->a + j, sizeof dx);
            memcpy(&dy, q->b + j, sizeof dy);
            dx -= a, dy -= b;
            cost += dx * dx + dy * dy;
        }
        memcpy(&key, &cost, sizeof key);
        key = ((key & ~63) | number) | ((number >= end) & INT32_MAX);
        const keys less = key < least;
        least = (key & less) | (least & ~less);
        number += LANES;
        if (w->weight)
            cost *= w->weight[i];
        memcpy(row + j, &cost, sizeof cost);
    }
    int32_t found = INT32_MAX;
    for (int32_t k = 0; k < LANES; k++)
        found = least[k] < found ? least[k] : found;
    return found & 63;
}

CORE float limit_of(const tz_pairing *w, int32_t i)
{
    return w->weight ? w->limit * w->weight[i] : w->limit;
}

/* ---- augmenting paths ------------------------------------------------------------ */

typedef struct duals {
    float u[MOST], v[ROOM]; /* of rows and columns */
    int32_t row[ROOM];      /* that has a column, or -1 */
} duals;

/* Columns of a block as Dijkstra sees them. */
typedef struct front {
    float dist[ROOM];
    int32_t from[ROOM];
    int32_t closed[ROOM]; /* INT32_MAX: done, or beyond the block */
} front;

/* Row i of the path offers its columns at `so_far` more than their reduced costs; the
 * nearest that is still open, or a column beyond the block. No reduced cost is negative
 * but by rounding, so distances do not fall. */
CORE int32_t relax(front *f, const float *row, const float *v, int32_t i, float base,
                   float so_far, int32_t begin, int32_t end)
{
    keys least, number;
    memcpy(&number, lane, sizeof number);
    number += begin;
    least = (number & 0) + INT32_MAX;
    for (int32_t j = begin; j < end; j += LANES) {
        lanes via, price, dist;
        keys from, closed, key;
        memcpy(&via, row + j, sizeof via);
        memcpy(&price, v + j, sizeof price);
        memcpy(&dist, f->dist + j, sizeof dist);
        memcpy(&from, f->from + j, sizeof from);
        memcpy(&closed, f->closed + j, sizeof closed);
        via = via - price + base;
        const lanes floor = via * 0 + so_far;
        keys up = via > floor, bits, other;
        memcpy(&bits, &via, sizeof bits);
        memcpy(&other, &floor, sizeof other);
        bits = (bits & up) | (other & ~up);
        memcpy(&via, &bits, sizeof via);
        const keys better = (via < dist) & ~closed;
        memcpy(&other, &dist, sizeof other);
        bits = (bits & better) | (other & ~better);
        from = (from & ~better) | (((better & 0) + i) & better);
        memcpy(f->dist + j, &bits, sizeof bits);
        memcpy(f->from + j, &from, sizeof from);
        key = ((bits & ~63) | number) | closed;
        const keys less = key < least;
        least = (key & less) | (least & ~less);
        number += LANES;
    }
    int32_t found = INT32_MAX;
    for (int32_t k = 0; k < LANES; k++)
        found = least[k] < found ? least[k] : found;
    return found == INT32_MAX ? -1 : found & 63;
}

/* Adds row `start` along the shortest augmenting path (Dijkstra over columns with reduced
 * costs). It ends at a free column or where a row of the path had better stay alone.
 * Returns its length. */
CORE float augment(tz_pairing *w, duals *d, int32_t start, int32_t begin, int32_t end)
{
    front f;
    int32_t order[MOST], seen = 0, i = start, last = -1, quitter = start;
    float so_far = 0, length = INFINITY;
    for (int32_t j = begin; j < end + LANES - 1; j++) {
        f.dist[j] = INFINITY, f.from[j] = -1;
        f.closed[j] = j < end ? 0 : INT32_MAX;
    }
    for (;;) {
        const float quit = so_far + (limit_of(w, i) - d->u[i]);
        if (quit < length)
            length = quit, quitter = i;
        const int32_t best =
            relax(&f, w->cost[i], d->v, i, so_far - d->u[i], so_far, begin, end);
        if (best < 0 || f.dist[best] >= length)
            break;
        so_far = f.dist[best];
        f.closed[best] = INT32_MAX;
        if (d->row[best] < 0) {
            last = best, length = so_far;
            break;
        }
        order[seen++] = best;
        i = d->row[best];
    }
    d->u[start] += length;
    for (int32_t k = 0; k < seen; k++) {
        const int32_t j = order[k];
        d->u[d->row[j]] += length - f.dist[j];
        d->v[j] -= length - f.dist[j];
    }
    if (last < 0 && quitter != start) { /* its column passes back along the path */
        last = w->to[quitter];
        w->to[quitter] = -1;
    } else if (last < 0) {
        w->to[start] = -1;
        return length;
    }
    for (;;) {
        const int32_t r = f.from[last], had = w->to[r];
        w->to[r] = last;
        d->row[last] = r;
        if (r == start)
            return length;
        last = had;
    }
}

/* ---- all labels ------------------------------------------------------------------ */

/* Rows and columns of one label. */
typedef struct block {
    int32_t row, rows, column, columns;
    float spare; /* limits of the rows that must stay unpaired, in the bound so far */
} block;

/* Blocks of all labels of p. Returns the cost of what must stay unpaired. */
CORE float find_blocks(const tz_pairing *w, const tz_pairing_side *p,
                       const tz_pairing_side *q, block *out)
{
    float sum = 0;
    for (int32_t k = 0, c = 0; k < p->runs; k++) {
        const int32_t row = p->first[k];
        while (c < q->runs && q->l[q->first[c]] < p->l[row])
            c++;
        const bool both = c < q->runs && q->l[q->first[c]] == p->l[row];
        block *b = &out[k];
        *b = (block){.row = row, .rows = p->first[k + 1] - row};
        if (both)
            b->column = q->first[c], b->columns = q->first[c + 1] - q->first[c];
        if (!w->weight && b->rows > b->columns)
            sum += b->spare = w->limit * (float)(b->rows - b->columns);
    }
    return sum;
}

CORE float best(tz_pairing *w, const tz_pairing_side *p, const tz_pairing_side *q,
                float enough)
{
    duals d;
    block all[MOST];
    int32_t lost[MOST], losers = 0;
    float bound = find_blocks(w, p, q, all);
    for (int32_t k = 0; k < p->runs; k++) {
        block *b = &all[k];
        const int32_t end = b->column + b->columns;
        const float spare = bound - b->spare;
        float sum = 0;
        if (bound >= enough)
            return INFINITY;
        for (int32_t j = b->column; j < end; j++)
            d.row[j] = -1;
        for (int32_t i = b->row; i < b->row + b->rows; i++) {
            const float limit = limit_of(w, i);
            const int32_t j =
                b->columns ? fill_row(w, p, i, q, b->column, end, w->cost[i]) : 0;
            const bool pair = b->columns && w->cost[i][j] < limit;
            sum += d.u[i] = pair ? w->cost[i][j] : limit;
            if (spare + sum >= enough)
                return INFINITY;
            w->to[i] = -1;
            if (pair && d.row[j] < 0)
                w->to[i] = j, d.row[j] = i;
            else if (pair)
                lost[losers++] = i;
        }
        b->spare = fmaxf(b->spare - sum, 0);
        bound = spare + sum + b->spare;
    }
    if (losers == 0)
        return bound < enough ? bound : INFINITY;
    memset(d.v, 0, sizeof d.v);
    for (int32_t n = 0, k = 0; n < losers; n++) {
        while (lost[n] >= all[k].row + all[k].rows)
            k++;
        block *b = &all[k];
        bound += augment(w, &d, lost[n], b->column, b->column + b->columns) - b->spare;
        b->spare = 0;
        if (bound * (1 - 1e-6f) >= enough) /* rounded */
            return INFINITY;
    }
    float sum = 0;
    for (int32_t i = 0; i < p->n; i++)
        sum += w->to[i] >= 0 ? w->cost[i][w->to[i]] : limit_of(w, i);
    return sum < enough ? sum : INFINITY;
}

#if defined(__x86_64__)
WIDE static float best_wide(tz_pairing *w, const tz_pairing_side *p,
                            const tz_pairing_side *q, float enough)
{
    return best(w, p, q, enough);
}
#endif

float tz_pairing_best(tz_pairing *w, const tz_pairing_side *p, const tz_pairing_side *q,
                      float enough)
{
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2"))
        return best_wide(w, p, q, enough);
#endif
    return best(w, p, q, enough);
}
