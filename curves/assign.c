/* SPDX-License-Identifier: Apache-2.0 */
/* Shortest augmenting paths with duals u, v:
 *
 *     cost[i][j] >= u[i] + v[j],  exit[i] >= u[i],  v[j] <= 0,
 *
 * with equality where i has j, where i is alone, and v[j] = 0 where j is free. The sum of
 * all duals never exceeds the least cost, so that it tells early when the cost is too
 * much.
 *
 * 1. Each row bids for its least reduced entry; first come, first served.
 * 2. Rows that found their column taken are added along a shortest path each (Dijkstra
 *    over columns), which ends at a free column or at a row that had better be alone.
 * 3. After a warm start columns may be free whose dual is below 0, as the duals come from
 *    another problem. Each is raised along a shortest path the other way, over rows that
 *    would rather have it, until it has a row or its dual is 0.
 * @source Jonker, Volgenant: A shortest augmenting path algorithm for dense and sparse
 *   linear assignment problems, Computing 38, 1987. Deviates: no reduction transfer and
 *   no augmenting row reduction, which do not pay at such sizes; step 3 is added */
#include "curves/assign.h"

#include <assert.h>
#include <math.h>

/* ---- bids -------------------------------------------------------------------------- */

/* Least reduced entry of a row and its column; the exit is -1. */
static float least(const tz_assign *a, const float *v, int32_t i, int32_t *column)
{
    const float *c = a->cost[i];
    float best = a->exit[i];
    *column = -1;
    for (int32_t j = 0; j < a->cols; j++) {
        const float d = c[j] - v[j];
        if (d < best) {
            best = d;
            *column = j;
        }
    }
    return best;
}

float tz_assign_bound(const tz_assign *a, bool warm)
{
    static const float zero[TZ_ASSIGN_MOST];
    const float *v = warm ? a->v : zero;
    float sum = 0;
    int32_t j;
    for (int32_t i = 0; i < a->rows; i++)
        sum += least(a, v, i, &j);
    for (int32_t k = 0; k < a->cols; k++)
        sum += v[k];
    return sum;
}

/* ---- rows -------------------------------------------------------------------------- */

/* State of a search: distances of columns, the row before each, and the finished ones. */
typedef struct search {
    float d[TZ_ASSIGN_MOST];
    int32_t from[TZ_ASSIGN_MOST];
    bool done[TZ_ASSIGN_MOST];
    int32_t order[TZ_ASSIGN_MOST]; /* finished, by distance */
    int32_t n;
} search;

static void relax(const tz_assign *a, search *s, int32_t i, float base)
{
    const float *c = a->cost[i];
    for (int32_t j = 0; j < a->cols; j++) {
        const float d = base + (c[j] - a->u[i] - a->v[j]);
        if (!s->done[j] && d < s->d[j]) {
            s->d[j] = d;
            s->from[j] = i;
        }
    }
}

/* Nearest unfinished column, or -1. */
static int32_t nearest(const tz_assign *a, const search *s)
{
    int32_t best = -1;
    float d = INFINITY;
    for (int32_t j = 0; j < a->cols; j++)
        if (!s->done[j] && s->d[j] < d) {
            d = s->d[j];
            best = j;
        }
    return best;
}

/* Gives each row of the path that ends at a free column, or at row `alone`, the column it
 * was reached by. */
static void flip(tz_assign *a, const search *s, int32_t start, int32_t column)
{
    for (int32_t guard = 0; guard <= a->cols; guard++) {
        const int32_t i = s->from[column], before = a->to[i];
        a->to[i] = column;
        a->row[column] = i;
        if (i == start)
            return;
        column = before;
    }
    assert(!"a path without an end");
}

/* Adds row `start`. False if there is no place for it. */
static bool add_row(tz_assign *a, int32_t start)
{
    search s = {.n = 0};
    float stop = a->exit[start] - a->u[start]; /* least way to an end so far */
    int32_t alone = start, last = -1;
    for (int32_t j = 0; j < a->cols; j++)
        s.d[j] = INFINITY;
    relax(a, &s, start, 0);
    for (;;) {
        const int32_t j = nearest(a, &s);
        if (j < 0 || s.d[j] >= stop)
            break;
        s.done[j] = true;
        const int32_t i = a->row[j];
        if (i < 0) {
            stop = s.d[j];
            last = j;
            break;
        }
        s.order[s.n++] = j;
        if (s.d[j] + (a->exit[i] - a->u[i]) < stop) {
            stop = s.d[j] + (a->exit[i] - a->u[i]);
            alone = i;
        }
        relax(a, &s, i, s.d[j]);
    }
    if (!(stop < INFINITY))
        return false;
    a->u[start] += stop;
    for (int32_t k = 0; k < s.n; k++) {
        const int32_t j = s.order[k];
        if (s.d[j] >= stop)
            continue;
        a->u[a->row[j]] += stop - s.d[j];
        a->v[j] -= stop - s.d[j];
    }
    if (last < 0 && alone == start) {
        a->to[start] = -1;
        return true;
    }
    if (last < 0) { /* that row leaves its column */
        last = a->to[alone];
        a->to[alone] = -1;
    }
    flip(a, &s, start, last);
    return true;
}

/* ---- columns ----------------------------------------------------------------------- */

/* Raises the dual of free column `start` to 0, or finds a row for it. */
static void raise_column(tz_assign *a, int32_t start)
{
    float d[TZ_ASSIGN_MOST]; /* of rows */
    int32_t by[TZ_ASSIGN_MOST] = {0}, order[TZ_ASSIGN_MOST], n = 0;
    bool done[TZ_ASSIGN_MOST] = {false};
    float stop = -a->v[start], base = 0;
    int32_t end = -1, column = start; /* row that ends it by going; column just reached */
    bool alone = false;
    float reached[TZ_ASSIGN_MOST]; /* distance of the column that a row owns */
    for (int32_t i = 0; i < a->rows; i++)
        d[i] = INFINITY;
    for (;;) {
        int32_t i = -1;
        for (int32_t k = 0; k < a->rows; k++) {
            const float e = base + (a->cost[k][column] - a->u[k] - a->v[column]);
            if (!done[k] && e < d[k]) {
                d[k] = e;
                by[k] = column;
            }
            if (!done[k] && (i < 0 || d[k] < d[i]))
                i = k;
        }
        if (i < 0 || !(d[i] < stop))
            break;
        done[i] = true;
        order[n++] = i;
        reached[i] = d[i];
        if (a->to[i] < 0) { /* it was alone: its exit is given up */
            stop = d[i];
            end = i;
            alone = true;
            break;
        }
        column = a->to[i];
        base = d[i];
        if (base - a->v[column] < stop) {
            stop = base - a->v[column];
            end = i;
        }
    }
    a->v[start] += stop;
    for (int32_t k = 0; k < n; k++) {
        const int32_t i = order[k];
        if (reached[i] >= stop)
            continue;
        a->u[i] -= stop - reached[i];
        if (a->to[i] >= 0)
            a->v[a->to[i]] += stop - reached[i];
    }
    if (end < 0) {
        a->v[start] = 0;
        return;
    }
    if (!alone) {
        a->v[a->to[end]] = 0;
        a->row[a->to[end]] = -1;
    }
    for (int32_t i = end, guard = 0; guard <= a->rows; guard++) {
        const int32_t j = by[i], owner = a->row[j];
        a->to[i] = j;
        a->row[j] = i;
        if (j == start)
            return;
        i = owner;
    }
}

/* ---- all --------------------------------------------------------------------------- */

static float dual(const tz_assign *a)
{
    float sum = 0;
    for (int32_t i = 0; i < a->rows; i++)
        sum += a->u[i];
    for (int32_t j = 0; j < a->cols; j++)
        sum += a->v[j];
    return sum;
}

static float total(const tz_assign *a)
{
    double sum = 0;
    for (int32_t i = 0; i < a->rows; i++)
        sum += (double)(a->to[i] < 0 ? a->exit[i] : a->cost[i][a->to[i]]);
    return (float)sum;
}

float tz_assign_solve(tz_assign *a, bool warm, float enough)
{
    int32_t left[TZ_ASSIGN_MOST], n = 0, j;
    assert(a->rows <= TZ_ASSIGN_MOST && a->cols <= TZ_ASSIGN_MOST);
    /* rounding must not make a bound of what is just below `enough` */
    const float limit = enough * 1.0001f;
    for (j = 0; j < a->cols; j++) {
        a->row[j] = -1;
        a->v[j] = warm && a->v[j] < 0 ? a->v[j] : 0;
    }
    for (int32_t i = 0; i < a->rows; i++) {
        a->u[i] = least(a, a->v, i, &j);
        if (!(a->u[i] < INFINITY))
            return INFINITY;
        a->to[i] = j;
        if (j >= 0 && a->row[j] >= 0)
            left[n++] = i;
        else if (j >= 0)
            a->row[j] = i;
    }
    for (int32_t k = 0; k < n; k++)
        a->to[left[k]] = -1;
    if (dual(a) >= limit)
        return INFINITY;
    for (int32_t k = 0; k < n; k++)
        if (!add_row(a, left[k]) || dual(a) >= limit)
            return INFINITY;
    for (j = 0; j < a->cols && warm; j++)
        if (a->row[j] < 0 && a->v[j] < 0)
            raise_column(a, j);
    const float cost = total(a);
    return cost < enough ? cost : INFINITY;
}
