/* SPDX-License-Identifier: Apache-2.0 */
/* Verbatim repeats. A run is described by where its path is after 1/5 .. 5/5 of the run's
 * length; runs that begin at close places of all paths, either way, stand in a tree. Each
 * run that is asked about is held against the nearest in the tree that are no part of
 * itself, moved along their path to where they fit best, and measured point by point. */
#include <string.h>

#include "base/kdtree.h"
#include "curves/curve_statistics.h"

#define STEP      (1.0 / 24) /* of the run: between beginnings in the tree */
#define SAME      0.004      /* of the run: what is apart more is not the same */
#define STRAIGHT  0.03       /* of the run: what bends less is straight */
#define ELSEWHERE 0.25       /* of the run: what is moved less is itself */
enum {
    PARTS = 5,
    DIM = 2 * PARTS,
    NEAR = 24,
    POINTS = 20,
    MOST_ASKED = 3000,
    MOST_RUNS = 400000
};

typedef struct run {
    int32_t path;
    float along; /* where it begins */
    bool back;
} run;

typedef struct finder {
    tz_ctx *ctx;
    double run;
    TZ_ARRAY(tz_vec2)
    point; /* of all paths */
    TZ_ARRAY(double)
    along; /* of points, from their path's beginning */
    TZ_ARRAY(int32_t)
    first; /* of paths, and the end of the last */
    TZ_ARRAY(run)
    runs;
    TZ_ARRAY(float)
    shape;
    TZ_ARRAY(run)
    asked;
    TZ_ARRAY(double)
    weight; /* length that the asked one stands for */
    uint8_t *found;
    tz_kdtree tree;
} finder;

static double length_of(const finder *k, int32_t path)
{
    return k->along.v[k->first.v[path + 1] - 1];
}

static tz_vec2 place(const finder *k, int32_t path, double along)
{
    int32_t lo = k->first.v[path], hi = k->first.v[path + 1] - 1;
    along = fmin(fmax(along, 0), k->along.v[hi]);
    while (hi - lo > 1) {
        const int32_t mid = lo + (hi - lo) / 2;
        *(k->along.v[mid] <= along ? &lo : &hi) = mid;
    }
    const double t = (along - k->along.v[lo]) / (k->along.v[hi] - k->along.v[lo]);
    const tz_vec2 p = k->point.v[lo], q = k->point.v[hi];
    return (tz_vec2){p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)};
}

/* Place of a run after a share of its length. */
static tz_vec2 at(const finder *k, const run *r, double share)
{
    return place(k, r->path, (double)r->along + (r->back ? -share : share) * k->run);
}

static tz_status add_paths(finder *k, const tz_curve_set *s)
{
    tz_status st = TZ_OK;
    for (int32_t i = 0; i < s->path.n && st == TZ_OK; i++) {
        const tz_curve_path *p = &s->path.v[i];
        const int32_t first = k->point.n;
        double along = 0;
        tz_vec2 last = {0, 0}, moved = {0, 0};
        for (int32_t j = p->piece; j < p->piece + p->pieces && st == TZ_OK; j++) {
            const tz_bezier c = tz_curve_bezier(s, &s->piece.v[j]);
            const int32_t n = 1 + tz_bezier_steps(&c, 0.1 * SAME * k->run);
            if (j > p->piece) /* on a torus pieces begin anew inside of it */
                moved = tz_vec2_sub(last, c.p[0]);
            for (int32_t m = j > p->piece; m <= n && st == TZ_OK; m++) {
                const tz_vec2 q = tz_vec2_add(tz_bezier_at(&c, (double)m / n), moved);
                const double step =
                    k->point.n > first ? tz_vec2_length(tz_vec2_sub(q, last)) : 0;
                last = q;
                if (k->point.n > first && !(step > 0))
                    continue;
                along += step;
                st = tz_array_push(k->ctx, &k->point, q);
                if (st == TZ_OK)
                    st = tz_array_push(k->ctx, &k->along, along);
            }
        }
        if (k->point.n < first + 2) {
            k->point.n = k->along.n = first;
            continue;
        }
        if (st == TZ_OK)
            st = tz_array_push(k->ctx, &k->first, first);
    }
    return st == TZ_OK ? tz_array_push(k->ctx, &k->first, k->point.n) : st;
}

static bool is_straight(const finder *k, const run *r)
{
    const tz_vec2 p = at(k, r, 0), d = tz_vec2_sub(at(k, r, 1), p);
    const double length = tz_vec2_length(d);
    if (length < 0.5 * k->run)
        return false;
    for (int i = 1; i < POINTS; i++) {
        const tz_vec2 v = tz_vec2_sub(at(k, r, (double)i / POINTS), p);
        if (fabs(d.x * v.y - d.y * v.x) > STRAIGHT * k->run * length)
            return false;
    }
    return true;
}

static void describe(const finder *k, const run *r, float shape[DIM])
{
    const tz_vec2 p = at(k, r, 0);
    for (int i = 0; i < PARTS; i++) {
        const tz_vec2 v = tz_vec2_sub(at(k, r, (i + 1.0) / PARTS), p);
        shape[2 * i] = (float)v.x;
        shape[2 * i + 1] = (float)v.y;
    }
}

/* All runs that a path has room for, both ways. */
static tz_status add_runs(finder *k, int32_t path, double step)
{
    const double room = length_of(k, path) - k->run;
    const double n = floor(room / step);
    tz_status s = TZ_OK;
    for (double i = 0; i <= n + 1 && s == TZ_OK; i++)
        for (int back = 0; back < 2 && s == TZ_OK; back++) {
            const run r = {path, (float)(fmin(i * step, room) + (back ? k->run : 0)),
                           back};
            float shape[DIM];
            if (is_straight(k, &r))
                continue;
            describe(k, &r, shape);
            s = tz_array_push(k->ctx, &k->runs, r);
            for (int d = 0; d < DIM && s == TZ_OK; d++)
                s = tz_array_push(k->ctx, &k->shape, shape[d]);
        }
    return s;
}

static tz_status add_asked(finder *k, int32_t path, double step)
{
    const double length = length_of(k, path), room = length - k->run;
    const double n = fmax(1, floor(length / step));
    tz_status s = TZ_OK;
    for (double i = 0; i < n && s == TZ_OK; i++) {
        const run r = {path, (float)((i + 0.5) / n * room), false};
        if (is_straight(k, &r))
            continue;
        s = tz_array_push(k->ctx, &k->asked, r);
        if (s == TZ_OK)
            s = tz_array_push(k->ctx, &k->weight, length / n);
    }
    return s;
}

/* Whether `o`, begun `shift` of the run's length later, is `r` moved. */
static bool is_same(const finder *k, const run *r, const run *o, double shift)
{
    const tz_vec2 p = at(k, r, 0), q = at(k, o, shift);
    const double most = SAME * k->run;
    for (int i = 1; i <= POINTS; i++) {
        const double t = (double)i / POINTS;
        const tz_vec2 u = tz_vec2_sub(at(k, r, t), p),
                      v = tz_vec2_sub(at(k, o, t + shift), q);
        if (tz_vec2_length(tz_vec2_sub(u, v)) > most)
            return false;
    }
    return true;
}

static bool is_elsewhere(const finder *k, const run *r, const run *o)
{
    const double least = ELSEWHERE * k->run;
    return tz_vec2_length(tz_vec2_sub(at(k, r, 0), at(k, o, 0))) > least &&
           (r->path != o->path || fabs((double)(r->along - o->along)) > least);
}

static tz_status ask(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    finder *k = arg;
    const run *r = &k->asked.v[i];
    int32_t id[NEAR];
    float shape[DIM], dist[NEAR];
    (void)ctx, (void)worker;
    describe(k, r, shape);
    const int32_t n = tz_kdtree_nearest(&k->tree, shape, NEAR, id, dist);
    for (int32_t j = 0; j < n && !k->found[i]; j++) {
        const run *o = &k->runs.v[id[j]];
        if (!is_elsewhere(k, r, o))
            continue;
        for (int m = -6; m <= 6 && !k->found[i]; m++)
            k->found[i] = is_same(k, r, o, m * STEP / 12);
    }
    return TZ_OK;
}

static tz_status fill(finder *k, double total)
{
    const double step = fmax(STEP * k->run, 2 * total / MOST_RUNS),
                 apart = fmax(k->run / 4, total / MOST_ASKED);
    tz_status s = TZ_OK;
    for (int32_t i = 0; i + 1 < k->first.n && s == TZ_OK; i++) {
        if (length_of(k, i) < k->run)
            continue;
        s = add_runs(k, i, step);
        if (s == TZ_OK)
            s = add_asked(k, i, apart);
    }
    return s;
}

tz_status tz_linework_repeats(tz_ctx *ctx, const tz_curve_set *s, double run,
                              double *share)
{
    finder k = {.ctx = ctx, .run = run};
    double total = 0, found = 0;
    *share = 0;
    tz_status st = add_paths(&k, s);
    for (int32_t i = 0; st == TZ_OK && i + 1 < k.first.n; i++)
        total += length_of(&k, i);
    if (st == TZ_OK && total > 0)
        st = fill(&k, total);
    if (st != TZ_OK || k.runs.n == 0 || k.asked.n == 0)
        goto done;
    st = tz_alloc_zero(ctx, &k.found, (size_t)k.asked.n, 1);
    if (st == TZ_OK)
        st = tz_kdtree_init(ctx, &k.tree, k.shape.v, k.runs.n, DIM);
    if (st == TZ_OK)
        st = tz_parallel_for(ctx, k.asked.n, ask, &k);
    for (int32_t i = 0; st == TZ_OK && i < k.asked.n; i++)
        found += k.found[i] ? k.weight.v[i] : 0;
    if (st == TZ_OK)
        *share = fmin(1, found / total);
done:
    tz_kdtree_deinit(&k.tree);
    tz_free(ctx, k.found);
    tz_array_free(ctx, &k.point);
    tz_array_free(ctx, &k.along);
    tz_array_free(ctx, &k.first);
    tz_array_free(ctx, &k.runs);
    tz_array_free(ctx, &k.shape);
    tz_array_free(ctx, &k.asked);
    tz_array_free(ctx, &k.weight);
    return st;
}
