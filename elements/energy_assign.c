/* SPDX-License-Identifier: Apache-2.0 */
/* Assignment step: all positions at once as the least squares of all votes,
 *
 *   min  sum over centres o, neighbours p:  w |u(p) - u(o) - pull(o, p)|^2
 *      + sum over samples o:                anchor |u(o)|^2
 *
 * with u the displacement of a sample and pull the predicted offset less the present one,
 * so that a torus needs no special case. The anchor ([Dav19]: an element's own position
 * counts with weight 0.5) makes the system definite and well conditioned whatever its
 * size, so conjugate gradients from u = 0 take some dozen passes and every pass lowers
 * the sum: cheaper than factorising a matrix whose pattern changes each round.
 * @source [Ma11] Eq. (3), (4), (5) */
#include <string.h>

#include "elements/energy_internal.h"

enum { NEAR = TZ_ENERGY_NEAR, BLOCK = 4096, MOST_PASSES = 200 };
#define TOLERANCE 1e-8

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
        const double w = mine * (double)t->weight[other];
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

/* Own position; and samples that have left a plain domain are called back as strongly as
 * all their neighbours together speak. */
static void anchor(fit *f, int32_t o)
{
    const tz_energy_state *t = f->t;
    const tz_vec3 p = t->at[o], size = t->set->domain.size;
    const tz_vec2 back = {fmin(fmax(p.x, 0), size.x) - p.x,
                          fmin(fmax(p.y, 0), size.y) - p.y};
    const double home = TZ_ENERGY_ANCHOR * (double)t->weight[o];
    if (!t->set->domain.torus && (back.x != 0 || back.y != 0)) {
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

/* ---- elements -------------------------------------------------------------------- */

/* Rigid motion that brings the old samples nearest to the new ones: the weighted centre
 * moves along, the angle is that of the sum of products as complex numbers. */
static void move_element(tz_energy_state *t, tz_element *e, const tz_vec2 *move)
{
    tz_sample *p = &t->set->sample.v[e->sample];
    tz_vec2 old = {0, 0}, shift = {0, 0};
    double total = 0, cosine = 0, sine = 0;
    for (int32_t k = 0; k < e->samples; k++) {
        const tz_vec2 u = move[t->place[e->sample + k]];
        old.x += p[k].weight * p[k].at.x, old.y += p[k].weight * p[k].at.y;
        shift.x += p[k].weight * u.x, shift.y += p[k].weight * u.y;
        total += p[k].weight;
    }
    old = tz_vec2_scale(old, 1 / total), shift = tz_vec2_scale(shift, 1 / total);
    for (int32_t k = 0; k < e->samples; k++) {
        const tz_vec2 u = move[t->place[e->sample + k]];
        const double x = p[k].at.x - old.x, y = p[k].at.y - old.y;
        const double nx = x + u.x - shift.x, ny = y + u.y - shift.y;
        cosine += p[k].weight * (x * nx + y * ny);
        sine += p[k].weight * (x * ny - y * nx);
        p[k].at.x += u.x, p[k].at.y += u.y;
    }
    const double turn = e->samples > 1 ? atan2(sine, cosine) : 0;
    const double x = e->at.x - old.x, y = e->at.y - old.y;
    e->angle += turn;
    const tz_vec3 to = {old.x + shift.x + cos(turn) * x - sin(turn) * y,
                        old.y + shift.y + sin(turn) * x + cos(turn) * y, e->at.z};
    e->at = tz_domain_wrap(&t->set->domain, to);
    for (int32_t k = 0; k < e->samples; k++) { /* samples stay beside their element */
        p[k].at.x += e->at.x - to.x, p[k].at.y += e->at.y - to.y;
        t->at[t->place[e->sample + k]] = p[k].at;
    }
}

static double far_from(const tz_energy_exemplar *x, int32_t e, tz_vec2 mean)
{
    const double da = (double)x->a[e] - mean.x, db = (double)x->b[e] - mean.y;
    return da * da + db * db;
}

/* The vote of least summed squared distance to all votes is the one nearest to their
 * mean. Parts of things that the exemplar's border has cut do not stand for election; an
 * element as good as the winner stays what it is. */
static void elect(tz_energy_state *t, tz_element *e)
{
    const tz_energy_exemplar *x = t->x;
    const int32_t o = t->place[e->sample];
    const int32_t begin = t->vote_first[o], end = t->vote_first[o + 1];
    if (t->match[o] < 0)
        return;
    tz_vec2 mean = {(double)x->a[t->match[o]], (double)x->b[t->match[o]]};
    for (int32_t v = begin; v < end; v++)
        mean.x += (double)x->a[t->vote.v[v]], mean.y += (double)x->b[t->vote.v[v]];
    mean = tz_vec2_scale(mean, 1.0 / (end - begin + 1));
    const double frame = tz_energy_frame(t, e->at);
    const tz_vec2 q = tz_energy_attribute(x, e, frame);
    const double now = (q.x - mean.x) * (q.x - mean.x) + (q.y - mean.y) * (q.y - mean.y);
    double least = INFINITY;
    int32_t winner = -1;
    for (int32_t v = begin - 1; v < end; v++) {
        const int32_t vote = v < begin ? t->match[o] : t->vote.v[v];
        const double d = far_from(x, vote, mean);
        if (d < least && !x->set->element.v[x->owner[vote]].cut)
            least = d, winner = vote;
    }
    if (winner < 0 || fabs(now - least) <= 1e-9 * x->spacing * x->spacing)
        return;
    const tz_element *from = &x->set->element.v[x->owner[winner]];
    e->source = x->owner[winner];
    e->symbol = from->symbol;
    e->angle = from->angle + frame;
    e->scale = from->scale;
    e->radius = from->radius;
}

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
        move_element(t, e, move);
        if (t->x->attributes && e->samples == 1)
            elect(t, e);
    }
    tz_free(t->ctx, move);
    return s;
}
