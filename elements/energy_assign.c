/* SPDX-License-Identifier: Apache-2.0 */
/* Assignment step: all positions at once as the least squares of all votes,
 *
 *   min  sum over centres o, neighbours p:  w |u(p) - u(o) - pull(o, p)|^2
 *      + sum over samples o:                anchor |u(o)|^2
 *
 * with w the product of both weights, STIFF times as much within an element, u the
 * displacement of a sample and pull the predicted offset less the present one,
 * so that a torus needs no special case. The anchor ([Dav19]: an element's own position
 * counts with weight 0.5) makes the system definite and well conditioned whatever its
 * size, so conjugate gradients from u = 0 take some dozen passes and every pass lowers
 * the sum: cheaper than factorising a matrix whose pattern changes each round.
 * @source [Ma11] Eq. (3), (4), (5) */
#include <string.h>

#include "elements/energy_internal.h"

enum { NEAR = TZ_ENERGY_NEAR, BLOCK = 4096, MOST_PASSES = 200 };
#define TOLERANCE 1e-8
/* Samples of one element hold together more than elements do: what may bend has no kinks
 * where its neighbours disagree. */
#define STIFF     8.0

/* Normal equations: (diagonal - weights) u = right, row by row. */
typedef struct fit {
    tz_energy_state *t;
    int32_t n;
    int32_t *count; /* neighbours of each row; row o begins at start[o] */
    int32_t *start;
    int32_t *column;
    float *value;
    double *inverse; /* of the diagonal; 0 = stays where it is */
    double *diagonal;
    tz_vec2 *u, *r, *d, *q;
    double *part; /* partial sums of blocks */
    double alpha, beta;
} fit;

static void fit_deinit(tz_ctx *ctx, fit *f)
{
    tz_free(ctx, f->count);
    tz_free(ctx, f->start);
    tz_free(ctx, f->column);
    tz_free(ctx, f->value);
    tz_free(ctx, f->inverse);
    tz_free(ctx, f->diagonal);
    tz_free(ctx, f->r);
    tz_free(ctx, f->d);
    tz_free(ctx, f->q);
    tz_free(ctx, f->part);
}

static int32_t blocks_of(const fit *f) { return (f->n + BLOCK - 1) / BLOCK; }

static tz_status fit_reserve(tz_ctx *ctx, fit *f)
{
    const tz_energy_state *t = f->t;
    const size_t n = (size_t)f->n;
    size_t edges = 0;
    for (int32_t o = 0; o < f->n; o++)
        edges += (size_t)t->count[o];
    edges += (size_t)t->edge.n;
    tz_status s = tz_alloc(ctx, &f->count, n, sizeof *f->count);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &f->start, n, sizeof *f->start);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &f->column, edges, sizeof *f->column);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &f->value, edges, sizeof *f->value);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &f->inverse, n, sizeof *f->inverse);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &f->diagonal, n, sizeof *f->diagonal);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &f->r, n, sizeof *f->r);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &f->d, n, sizeof *f->d);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &f->q, n, sizeof *f->q);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &f->part, (size_t)blocks_of(f), sizeof *f->part);
    for (int32_t o = 0, at = 0; s == TZ_OK && o < f->n; o++) {
        f->start[o] = at;
        at += t->count[o] + t->vote_first[o + 1] - t->vote_first[o];
    }
    return s;
}

/* ---- the matrix ------------------------------------------------------------------ */

static void add_entry(fit *f, int32_t row, int32_t column, double w)
{
    const int32_t at = f->start[row] + f->count[row]++;
    f->column[at] = column;
    f->value[at] = (float)w;
}

/* Both lists rise, so edges there and back merge into one entry. */
static void fill_row(fit *f, int32_t o)
{
    const tz_energy_state *t = f->t;
    int32_t i = t->vote_first[o], j = 0;
    const int32_t in = t->vote_first[o + 1], out = t->count[o];
    const double mine = (double)t->weight[o];
    double sum = 0;
    tz_vec2 right = {0, 0};
    f->count[o] = 0;
    while (i < in || j < out) {
        const int32_t at = o * NEAR + j;
        if (j < out && t->pair[at] < 0) {
            j++;
            continue;
        }
        const int32_t from = i < in ? t->edge.v[i] / NEAR : INT32_MAX;
        const int32_t to = j < out ? t->near[at] : INT32_MAX;
        const int32_t other = from < to ? from : to;
        const double w = mine * (double)t->weight[other] *
                         (t->owner[o] == t->owner[other] ? STIFF : 1);
        double both = 0;
        if (from == other) {
            const tz_energy_pull p = t->pull[t->edge.v[i++]];
            right.x += w * (double)p.x, right.y += w * (double)p.y;
            both += w;
        }
        if (to == other) {
            const tz_energy_pull p = t->pull[at];
            right.x -= w * (double)p.x, right.y -= w * (double)p.y;
            both += w;
            j++;
        }
        sum += both;
        add_entry(f, o, other, both);
    }
    f->r[o] = right;
    f->diagonal[o] = sum;
}

tz_vec2 tz_energy_back(const tz_domain *d, tz_vec3 at)
{
    tz_vec2 back = {0, 0};
    if (!d->torus) {
        back.x = fmin(fmax(at.x, 0), d->size.x) - at.x;
        back.y = fmin(fmax(at.y, 0), d->size.y) - at.y;
    }
    if (!d->region || back.x != 0 || back.y != 0)
        return back;
    const double depth = tz_region_distance(d->region, at);
    if (depth >= 0)
        return back;
    const double h = d->size.x / d->region->raster.width; /* against the gradient */
    const tz_vec3 a = {at.x - h, at.y, 0}, b = {at.x + h, at.y, 0};
    const tz_vec3 u = {at.x, at.y - h, 0}, v = {at.x, at.y + h, 0};
    const double x = tz_region_distance(d->region, b) - tz_region_distance(d->region, a);
    const double y = tz_region_distance(d->region, v) - tz_region_distance(d->region, u);
    const double l = hypot(x, y);
    return l > 0 ? (tz_vec2){-depth * x / l, -depth * y / l} : back;
}

/* Own position; and samples that have left the domain are called back as strongly as
 * all their neighbours together speak. */
static void anchor(fit *f, int32_t o)
{
    const tz_energy_state *t = f->t;
    const tz_vec2 back = tz_energy_back(&t->set->domain, t->at[o]);
    const double home = TZ_ENERGY_ANCHOR * (double)t->weight[o];
    if (back.x != 0 || back.y != 0) {
        const double w = f->diagonal[o] + home;
        f->r[o].x += w * back.x, f->r[o].y += w * back.y;
        f->diagonal[o] += w;
    }
    f->diagonal[o] += home;
    f->inverse[o] = 1 / f->diagonal[o];
    if (t->set->element.v[t->owner[o]].fixed) {
        f->inverse[o] = 0;
        f->r[o] = (tz_vec2){0, 0};
    }
}

/* ---- conjugate gradients --------------------------------------------------------- */

static int32_t begin_of(int64_t block) { return (int32_t)block * BLOCK; }

static int32_t end_of(const fit *f, int64_t block)
{
    const int32_t end = ((int32_t)block + 1) * BLOCK;
    return end < f->n ? end : f->n;
}

static tz_status build_block(tz_ctx *ctx, void *arg, int64_t block, int worker)
{
    (void)ctx, (void)worker;
    fit *f = arg;
    for (int32_t o = begin_of(block); o < end_of(f, block); o++) {
        fill_row(f, o);
        anchor(f, o);
    }
    return TZ_OK;
}

/* d = r / diagonal + beta d */
static tz_status direct_block(tz_ctx *ctx, void *arg, int64_t block, int worker)
{
    (void)ctx, (void)worker;
    fit *f = arg;
    for (int32_t o = begin_of(block); o < end_of(f, block); o++) {
        f->d[o].x = f->r[o].x * f->inverse[o] + f->beta * f->d[o].x;
        f->d[o].y = f->r[o].y * f->inverse[o] + f->beta * f->d[o].y;
    }
    return TZ_OK;
}

/* q = A d, and d . q; rows of fixed samples are no equations */
static tz_status multiply_block(tz_ctx *ctx, void *arg, int64_t block, int worker)
{
    (void)ctx, (void)worker;
    fit *f = arg;
    double sum = 0;
    for (int32_t o = begin_of(block); o < end_of(f, block); o++) {
        const int32_t *column = &f->column[f->start[o]];
        const float *value = &f->value[f->start[o]];
        tz_vec2 v = {f->diagonal[o] * f->d[o].x, f->diagonal[o] * f->d[o].y};
        for (int32_t k = 0; k < f->count[o]; k++) {
            const tz_vec2 p = f->d[column[k]];
            v.x -= (double)value[k] * p.x;
            v.y -= (double)value[k] * p.y;
        }
        if (f->inverse[o] == 0)
            v = (tz_vec2){0, 0};
        f->q[o] = v;
        sum += v.x * f->d[o].x + v.y * f->d[o].y;
    }
    f->part[block] = sum;
    return TZ_OK;
}

/* u += alpha d, r -= alpha q, and r . r / diagonal */
static tz_status step_block(tz_ctx *ctx, void *arg, int64_t block, int worker)
{
    (void)ctx, (void)worker;
    fit *f = arg;
    double sum = 0;
    for (int32_t o = begin_of(block); o < end_of(f, block); o++) {
        f->u[o].x += f->alpha * f->d[o].x;
        f->u[o].y += f->alpha * f->d[o].y;
        f->r[o].x -= f->alpha * f->q[o].x;
        f->r[o].y -= f->alpha * f->q[o].y;
        sum += (f->r[o].x * f->r[o].x + f->r[o].y * f->r[o].y) * f->inverse[o];
    }
    f->part[block] = sum;
    return TZ_OK;
}

static tz_status run(fit *f, tz_task task, double *sum)
{
    tz_status s = tz_parallel_for(f->t->ctx, blocks_of(f), task, f);
    for (int32_t k = 0; sum && s == TZ_OK && k < blocks_of(f); k++)
        *sum = k ? *sum + f->part[k] : f->part[k];
    return s;
}

tz_status tz_energy_fit(tz_energy_state *t, double tolerance, tz_vec2 *move)
{
    fit f = {.t = t, .n = t->n, .u = move};
    double rest = 0, first, curve = 0, next = 0;
    memset(move, 0, (size_t)t->n * sizeof *move);
    tz_status s = fit_reserve(t->ctx, &f);
    if (s == TZ_OK)
        s = run(&f, build_block, NULL);
    if (s == TZ_OK)
        s = run(&f, step_block, &rest); /* alpha = 0: only the sum */
    first = rest;
    for (int pass = 0; s == TZ_OK && pass < MOST_PASSES && rest > tolerance * first;
         pass++) {
        s = run(&f, direct_block, NULL);
        if (s == TZ_OK)
            s = run(&f, multiply_block, &curve);
        if (s != TZ_OK || !(curve > 0))
            break;
        f.alpha = rest / curve;
        s = run(&f, step_block, &next);
        f.beta = next / rest;
        rest = next;
    }
    fit_deinit(t->ctx, &f);
    return s;
}

double tz_energy_of_positions(const tz_energy_state *t)
{
    double sum = 0;
    for (int32_t o = 0; o < t->n; o++)
        for (int32_t j = 0; j < t->count[o]; j++) {
            const ptrdiff_t at = (ptrdiff_t)o * NEAR + j;
            const double x = (double)t->pull[at].x, y = (double)t->pull[at].y;
            if (t->pair[at] >= 0)
                sum += (double)t->weight[o] * (double)t->weight[t->near[at]] *
                       (x * x + y * y);
        }
    return sum;
}

/* ---- the step --------------------------------------------------------------------- */

tz_status tz_energy_assign(tz_energy_state *t)
{
    tz_vec2 *move;
    tz_status s = tz_alloc(t->ctx, &move, (size_t)t->n, sizeof *move);
    if (s != TZ_OK)
        return s;
    s = tz_energy_fit(t, TOLERANCE, move);
    for (int32_t i = 0; s == TZ_OK && i < t->set->element.n; i++) {
        tz_element *e = &t->set->element.v[i];
        if (e->fixed)
            continue;
        tz_energy_move(t, e, move);
        if (t->x->attributes && e->samples == 1)
            tz_energy_elect(t, e);
    }
    tz_free(t->ctx, move);
    return s;
}
