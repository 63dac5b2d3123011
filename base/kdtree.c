/* SPDX-License-Identifier: Apache-2.0 */
/* An implicit balanced k-d tree: the median of a range is its node, halves on either side
 * are its children, so the tree is the order of the points and nothing else.
 *
 *   [ lower half | median | upper half ]      split dimension: depth modulo dim */
#include "base/kdtree.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { LEAF = 8 };

static void swap_points(tz_kdtree *t, int32_t i, int32_t j)
{
    float *p = t->point + (ptrdiff_t)i * t->dim, *q = t->point + (ptrdiff_t)j * t->dim;
    for (int32_t d = 0; d < t->dim; d++) {
        float x = p[d];
        p[d] = q[d];
        q[d] = x;
    }
    int32_t id = t->id[i];
    t->id[i] = t->id[j];
    t->id[j] = id;
}

/* Order along a dimension; ties by index make it total, and the tree unique. */
static bool before(const tz_kdtree *t, int32_t i, float v, int32_t id, int32_t d)
{
    float x = t->point[(ptrdiff_t)i * t->dim + d];
    return x < v || (x == v && t->id[i] < id);
}

/* Hoare's selection: afterwards item k of [lo, hi) has its place in sorted order. */
static void select_median(tz_kdtree *t, int32_t lo, int32_t hi, int32_t k, int32_t d)
{
    hi--;
    while (lo < hi) {
        int32_t mid = lo + (hi - lo) / 2;
        float v = t->point[(ptrdiff_t)mid * t->dim + d];
        int32_t id = t->id[mid], i = lo, j = hi;
        swap_points(t, mid, hi);
        for (j = lo; j < hi; j++)
            if (before(t, j, v, id, d))
                swap_points(t, i++, j);
        swap_points(t, i, hi);
        if (i == k)
            return;
        if (i < k)
            lo = i + 1;
        else
            hi = i - 1;
    }
}

static void build(tz_kdtree *t, int32_t lo, int32_t hi, int32_t d)
{
    while (hi - lo > LEAF) {
        int32_t mid = lo + (hi - lo) / 2;
        select_median(t, lo, hi, mid, d);
        d = d + 1 == t->dim ? 0 : d + 1;
        build(t, lo, mid, d);
        lo = mid + 1;
    }
}

tz_status tz_kdtree_init(tz_ctx *ctx, tz_kdtree *t, const float *p, int32_t n,
                         int32_t dim)
{
    memset(t, 0, sizeof *t);
    if (n < 0 || dim < 1 || dim > 16)
        return tz_fail(ctx, TZ_INVALID, "k-d tree of %d points in %d dimensions", n, dim);
    for (int64_t i = 0; i < (int64_t)n * dim; i++)
        if (!isfinite(p[i]))
            return tz_fail(ctx, TZ_INVALID, "k-d tree: point %lld is not finite",
                           (long long)(i / dim));
    tz_kdtree tree = {.n = n, .dim = dim, .ctx = ctx};
    tz_status s = tz_alloc(ctx, &tree.point, (size_t)n * (size_t)dim, sizeof *p);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &tree.id, (size_t)n, sizeof *tree.id);
    if (s != TZ_OK) {
        tz_kdtree_deinit(&tree);
        return s;
    }
    if (n > 0)
        memcpy(tree.point, p, (size_t)n * (size_t)dim * sizeof *p);
    for (int32_t i = 0; i < n; i++)
        tree.id[i] = i;
    build(&tree, 0, n, 0);
    *t = tree;
    return TZ_OK;
}

void tz_kdtree_deinit(tz_kdtree *t)
{
    tz_free(t->ctx, t->point);
    tz_free(t->ctx, t->id);
    memset(t, 0, sizeof *t);
}

/* The found so far, nearest first. */
typedef struct search {
    const tz_kdtree *t;
    const float *q;
    int32_t k, found;
    int32_t *id;
    float *dist2;
} search;

static void offer(search *s, int32_t i)
{
    const float *p = s->t->point + (ptrdiff_t)i * s->t->dim;
    float d2 = 0;
    for (int32_t d = 0; d < s->t->dim; d++)
        d2 += (p[d] - s->q[d]) * (p[d] - s->q[d]);
    int32_t id = s->t->id[i], at = s->found;
    if (at == s->k) {
        at--;
        if (d2 > s->dist2[at] || (d2 == s->dist2[at] && id > s->id[at]))
            return;
    } else {
        s->found++;
    }
    for (; at > 0 &&
           (d2 < s->dist2[at - 1] || (d2 == s->dist2[at - 1] && id < s->id[at - 1]));
         at--) {
        s->dist2[at] = s->dist2[at - 1];
        s->id[at] = s->id[at - 1];
    }
    s->dist2[at] = d2;
    s->id[at] = id;
}

static void visit(search *s, int32_t lo, int32_t hi, int32_t d)
{
    if (hi - lo <= LEAF) {
        for (int32_t i = lo; i < hi; i++)
            offer(s, i);
        return;
    }
    int32_t mid = lo + (hi - lo) / 2, next = d + 1 == s->t->dim ? 0 : d + 1;
    float delta = s->q[d] - s->t->point[(ptrdiff_t)mid * s->t->dim + d];
    if (delta < 0)
        visit(s, lo, mid, next);
    else
        visit(s, mid + 1, hi, next);
    offer(s, mid);
    /* equal distance may still win by its lower index; the sums of offer() round up and
     * down, never below one of their terms */
    if (s->found < s->k || delta * delta <= s->dist2[s->k - 1]) {
        if (delta < 0)
            visit(s, mid + 1, hi, next);
        else
            visit(s, lo, mid, next);
    }
}

int32_t tz_kdtree_nearest(const tz_kdtree *t, const float *q, int32_t k, int32_t *id,
                          float *dist2)
{
    search s = {t, q, k, 0, id, dist2};
    if (k > 0)
        visit(&s, 0, t->n, 0);
    return s.found;
}
