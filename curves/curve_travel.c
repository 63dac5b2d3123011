/* SPDX-License-Identifier: Apache-2.0 */
/* The way of a pen. Pen by pen: the nearest end that is left comes next (a k-d tree over
 * all ends, from which drawn ones are taken out), then the tour is improved:
 *
 *   2-opt   ..a)[i .. j](b..  ->  ..a)[j .. i reversed](b..  where that is shorter
 *   Or-opt  one stroke, either way round, to another place
 *
 * both between places at most a window apart, until nothing is gained. */
#include "curves/curve_travel_internal.h"

#include <string.h>

#include "curves/curve_dxf.h"

enum { PASSES = 12, LEAST_WINDOW = 32, MOST_WINDOW = 1024 };
#define WINDOW_WORK 4e6 /* steps of a pass over all strokes */

/* ---- ends that are left ---------------------------------------------------------------
 */

/** One end of a stroke. The tree is implicit: the middle of a range is its root. */
typedef struct spot {
    tz_vec2 at;
    int32_t stroke;
    bool end;
} spot;

typedef struct tree {
    spot *spot;
    int32_t *left; /* ends left in the range whose root this is */
    int32_t n;
} tree;

static double along(const spot *s, int axis) { return axis ? s->at.y : s->at.x; }

/** Whether a comes before b: by an axis, ties by number, so that the order is one. */
static bool before(const spot *a, const spot *b, int axis)
{
    const double x = along(a, axis), y = along(b, axis);
    if (x != y)
        return x < y;
    return a->stroke != b->stroke ? a->stroke < b->stroke : a->end < b->end;
}

static void swap(spot *a, spot *b)
{
    const spot t = *a;
    *a = *b;
    *b = t;
}

/** Brings the item that belongs at k there, smaller ones before it (Hoare's select). */
static void select_nth(spot *v, int32_t lo, int32_t hi, int32_t k, int axis)
{
    while (hi - lo > 1) {
        const int32_t mid = lo + (hi - lo) / 2;
        if (before(&v[mid], &v[lo], axis))
            swap(&v[mid], &v[lo]);
        if (before(&v[hi - 1], &v[lo], axis))
            swap(&v[hi - 1], &v[lo]);
        if (before(&v[hi - 1], &v[mid], axis))
            swap(&v[hi - 1], &v[mid]);
        const spot pivot = v[mid];
        int32_t i = lo, j = hi - 1;
        while (i <= j) {
            while (before(&v[i], &pivot, axis))
                i++;
            while (before(&pivot, &v[j], axis))
                j--;
            if (i <= j)
                swap(&v[i++], &v[j--]);
        }
        if (k <= j)
            hi = j + 1;
        else if (k >= i)
            lo = i;
        else
            return;
    }
}

static void build(tree *t, int32_t lo, int32_t hi, int axis)
{
    if (lo >= hi)
        return;
    const int32_t mid = lo + (hi - lo) / 2;
    select_nth(t->spot, lo, hi, mid, axis);
    t->left[mid] = hi - lo;
    build(t, lo, mid, !axis);
    build(t, mid + 1, hi, !axis);
}

/** Counts an end out, which is still there. */
static void take_out(tree *t, int32_t at)
{
    int32_t lo = 0, hi = t->n;
    for (;;) {
        const int32_t mid = lo + (hi - lo) / 2;
        t->left[mid]--;
        if (mid == at)
            return;
        if (at < mid)
            hi = mid;
        else
            lo = mid + 1;
    }
}

typedef struct query {
    const tree *t;
    const uint8_t *gone;
    tz_vec2 at;
    double best; /* squared */
    int32_t found;
} query;

static void nearest(query *q, int32_t lo, int32_t hi, int axis)
{
    if (lo >= hi)
        return;
    const int32_t mid = lo + (hi - lo) / 2;
    const spot *s = &q->t->spot[mid];
    if (q->t->left[mid] == 0)
        return;
    if (!q->gone[mid]) {
        const double dx = s->at.x - q->at.x, dy = s->at.y - q->at.y,
                     d = dx * dx + dy * dy;
        if (d < q->best ||
            (d == q->best && q->found >= 0 && s->stroke < q->t->spot[q->found].stroke)) {
            q->best = d;
            q->found = mid;
        }
    }
    const double away = (axis ? q->at.y : q->at.x) - along(s, axis);
    if (away < 0) {
        nearest(q, lo, mid, !axis);
        if (away * away <= q->best)
            nearest(q, mid + 1, hi, !axis);
    } else {
        nearest(q, mid + 1, hi, !axis);
        if (away * away <= q->best)
            nearest(q, lo, mid, !axis);
    }
}

/* ---- one pen --------------------------------------------------------------------------
 */

typedef struct tour {
    tz_ctx *ctx;
    const tz_travel_stroke *stroke;
    int32_t *order; /* of this pen */
    bool *reversed;
    int32_t n;
    tz_vec2 begin; /* where the pen before has ended */
} tour;

static tz_vec2 start_of(const tour *t, int32_t k)
{
    const tz_travel_stroke *s = &t->stroke[t->order[k]];
    return t->reversed[k] ? s->to : s->from;
}

static tz_vec2 end_of(const tour *t, int32_t k)
{
    const tz_travel_stroke *s = &t->stroke[t->order[k]];
    return k < 0 ? t->begin : t->reversed[k] ? s->from : s->to;
}

static double apart(tz_vec2 p, tz_vec2 q) { return tz_vec2_length(tz_vec2_sub(p, q)); }

/** The way from the end of stroke k to a place; none behind the last stroke. */
static double way_to(const tour *t, tz_vec2 from, int32_t k)
{
    return k < t->n ? apart(from, start_of(t, k)) : 0;
}

static double length_of(const tour *t)
{
    double sum = 0;
    for (int32_t k = 0; k < t->n; k++)
        sum += apart(end_of(t, k - 1), start_of(t, k));
    return sum;
}

/** As they are drawn where that is not worse. */
static void take_greedy(tour *t, const int32_t *was, const int32_t *next,
                        const bool *reversed)
{
    const double drawn = length_of(t);
    for (int32_t k = 0; k < t->n; k++) {
        t->order[k] = was[next[k]];
        t->reversed[k] = reversed[k];
    }
    if (length_of(t) <= drawn)
        return;
    memcpy(t->order, was, (size_t)t->n * sizeof *was);
    memset(t->reversed, 0, (size_t)t->n * sizeof *t->reversed);
}

static tz_status greedy(tour *t)
{
    tree r = {.n = 2 * t->n};
    uint8_t *gone = NULL;
    int32_t *place = NULL, *was = NULL, *next = NULL; /* of ends; as drawn; found */
    bool *reversed = NULL;
    tz_vec2 at = t->begin;
    tz_status s = tz_alloc(t->ctx, &r.spot, (size_t)r.n, sizeof *r.spot);
    if (s == TZ_OK)
        s = tz_alloc(t->ctx, &r.left, (size_t)r.n, sizeof *r.left);
    if (s == TZ_OK)
        s = tz_alloc_zero(t->ctx, &gone, (size_t)r.n, 1);
    if (s == TZ_OK)
        s = tz_alloc(t->ctx, &place, (size_t)r.n, sizeof *place);
    if (s == TZ_OK)
        s = tz_alloc(t->ctx, &was, (size_t)t->n, sizeof *was);
    if (s == TZ_OK)
        s = tz_alloc(t->ctx, &next, (size_t)t->n, sizeof *next);
    if (s == TZ_OK)
        s = tz_alloc(t->ctx, &reversed, (size_t)t->n, sizeof *reversed);
    if (s != TZ_OK)
        goto done;
    for (int32_t k = 0; k < t->n; k++) {
        const tz_travel_stroke *p = &t->stroke[t->order[k]];
        was[k] = t->order[k];
        r.spot[2 * k] = (spot){p->from, k, false};
        r.spot[2 * k + 1] = (spot){p->to, k, true};
    }
    build(&r, 0, r.n, 0);
    for (int32_t i = 0; i < r.n; i++)
        place[2 * r.spot[i].stroke + r.spot[i].end] = i;
    for (int32_t k = 0; k < t->n; k++) {
        query q = {&r, gone, at, INFINITY, -1};
        nearest(&q, 0, r.n, 0);
        const int32_t stroke = r.spot[q.found].stroke;
        const bool end = r.spot[q.found].end;
        for (int e = 0; e < 2; e++) {
            take_out(&r, place[2 * stroke + e]);
            gone[place[2 * stroke + e]] = 1;
        }
        next[k] = stroke;
        reversed[k] = end;
        at = r.spot[place[2 * stroke + !end]].at;
    }
    take_greedy(t, was, next, reversed);
done:
    tz_free(t->ctx, reversed);
    tz_free(t->ctx, next);
    tz_free(t->ctx, was);
    tz_free(t->ctx, place);
    tz_free(t->ctx, gone);
    tz_free(t->ctx, r.left);
    tz_free(t->ctx, r.spot);
    return s;
}

static void turn(tour *t, int32_t i, int32_t j)
{
    for (; i < j; i++, j--) {
        const int32_t o = t->order[i];
        const bool r = t->reversed[i];
        t->order[i] = t->order[j];
        t->reversed[i] = !t->reversed[j];
        t->order[j] = o;
        t->reversed[j] = !r;
    }
    if (i == j)
        t->reversed[i] = !t->reversed[i];
}

/** The best stretch that begins at i and is better run through from its end. */
static bool turn_best(tour *t, int32_t i, int32_t window, double least)
{
    const tz_vec2 a = end_of(t, i - 1), b = start_of(t, i);
    const double ab = apart(a, b);
    double most = least;
    int32_t best = -1;
    for (int32_t j = i; j < t->n && j < i + window; j++) {
        const tz_vec2 c = end_of(t, j);
        const double gain = ab + way_to(t, c, j + 1) - apart(a, c) - way_to(t, b, j + 1);
        if (gain > most) {
            most = gain;
            best = j;
        }
    }
    if (best < 0)
        return false;
    turn(t, i, best);
    return true;
}

/** Moves stroke i (either way round) between strokes k and k + 1 where that is best. */
static bool move_best(tour *t, int32_t i, int32_t window, double least)
{
    const tz_vec2 before = end_of(t, i - 1), p = start_of(t, i), q = end_of(t, i);
    const double taken =
        apart(before, p) + way_to(t, q, i + 1) - way_to(t, before, i + 1);
    const int32_t lo = i - window < -1 ? -1 : i - window,
                  hi = i + window > t->n - 1 ? t->n - 1 : i + window;
    double most = least;
    int32_t best = -2;
    bool around = false;
    for (int32_t k = lo; k <= hi; k++) {
        if (k == i || k == i - 1)
            continue;
        const tz_vec2 c = end_of(t, k);
        const double gap = way_to(t, c, k + 1);
        for (int r = 0; r < 2; r++) {
            const double gain =
                taken + gap - apart(c, r ? q : p) - way_to(t, r ? p : q, k + 1);
            if (gain > most) {
                most = gain;
                best = k;
                around = r;
            }
        }
    }
    if (best < -1)
        return false;
    const int32_t o = t->order[i], to = best < i ? best + 1 : best;
    const bool r = t->reversed[i] != around;
    const int32_t step = to < i ? -1 : 1;
    for (int32_t k = i; k != to; k += step) {
        t->order[k] = t->order[k + step];
        t->reversed[k] = t->reversed[k + step];
    }
    t->order[to] = o;
    t->reversed[to] = r;
    return true;
}

static tz_status improve(tour *t)
{
    const double wanted = WINDOW_WORK / fmax(1, t->n), least = 1e-9 * length_of(t);
    const int32_t window = (int32_t)fmin(MOST_WINDOW, fmax(LEAST_WINDOW, wanted));
    for (int pass = 0; pass < PASSES; pass++) {
        bool better = false;
        for (int32_t i = 0; i < t->n; i++) {
            better = turn_best(t, i, window, least) || better;
            better = move_best(t, i, window, least) || better;
            if ((i & 255) == 0 && tz_ctx_cancelled(t->ctx))
                return TZ_CANCELLED;
        }
        if (!better)
            break;
    }
    return TZ_OK;
}

/* ---- all pens -------------------------------------------------------------------------
 */

/** order[] = strokes by pen, else as they come; first[pen] .. first[pen + 1] - 1. */
static tz_status sort_by_pen(tz_ctx *ctx, const tz_travel_stroke *stroke, int32_t n,
                             int32_t pens, int32_t *order, int32_t **first)
{
    int32_t *at = NULL;
    const tz_status s = tz_alloc_zero(ctx, &at, (size_t)pens + 2, sizeof *at);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < n; i++)
        at[stroke[i].pen + 2]++;
    for (int32_t p = 0; p < pens; p++)
        at[p + 2] += at[p + 1];
    for (int32_t i = 0; i < n; i++)
        order[at[stroke[i].pen + 1]++] = i;
    *first = at;
    return TZ_OK;
}

tz_status tz_travel_order(tz_ctx *ctx, const tz_travel_stroke *stroke, int32_t n,
                          int32_t *order, bool *reversed, double way[2])
{
    tour t = {.ctx = ctx, .stroke = stroke};
    tz_vec2 at = {0, 0};
    int32_t pens = 0, *first = NULL;
    way[0] = way[1] = 0;
    for (int32_t i = 0; i < n; i++) {
        way[0] += apart(at, stroke[i].from);
        at = stroke[i].to;
        reversed[i] = false;
        pens = stroke[i].pen >= pens ? stroke[i].pen + 1 : pens;
    }
    tz_status s = sort_by_pen(ctx, stroke, n, pens, order, &first);
    for (int32_t p = 0; p < pens && s == TZ_OK; p++) {
        t.order = order + first[p];
        t.reversed = reversed + first[p];
        t.n = first[p + 1] - first[p];
        if (t.n == 0)
            continue;
        s = greedy(&t);
        if (s == TZ_OK)
            s = improve(&t);
        way[1] += s == TZ_OK ? length_of(&t) : 0;
        t.begin = end_of(&t, t.n - 1);
    }
    tz_free(ctx, first);
    return s;
}

tz_status tz_curve_travel(tz_ctx *ctx, const tz_curve_set *s, int32_t *order,
                          bool *reversed, double way[2])
{
    tz_travel_stroke *stroke = NULL;
    tz_status st = tz_alloc(ctx, &stroke, (size_t)s->path.n, sizeof *stroke);
    if (st != TZ_OK)
        return st;
    for (int32_t i = 0; i < s->path.n; i++) {
        const tz_curve_path *p = &s->path.v[i];
        tz_vec2 from = s->node.v[s->piece.v[p->piece].from], to = from;
        for (int32_t k = p->piece; k < p->piece + p->pieces; k++) {
            const tz_bezier c = tz_curve_bezier(s, &s->piece.v[k]);
            to = tz_vec2_add(to, tz_vec2_sub(c.p[3], c.p[0]));
        }
        stroke[i] = (tz_travel_stroke){from, to, p->pen};
    }
    st = tz_travel_order(ctx, stroke, s->path.n, order, reversed, way);
    tz_free(ctx, stroke);
    return st;
}
