/* SPDX-License-Identifier: Apache-2.0 */
/* The field terms: Eq. (5) to (12), over the links of fill_links.c and fill_peers.c. */
#include "fields/fill_internal.h"

#include <string.h>

#define SMALL 1e-5 /* residual over diagonal; of a step that goes far it is far less */
enum { ROUNDS = 16, LM_STEPS = 2 };

/* ---- scalars: Eq. (12) -------------------------------------------------------------- */

/* Which scalar: its values, what is said, with which confidence. */
typedef struct scalar_run {
    tz_fill *f;
    double *v;
    const double *said, *target;
    double b2;
} scalar_run;

static int32_t samples_of(const tz_fill *f, int32_t node)
{
    const tz_fill_body *b = &f->body.v[f->owner[node]];
    return f->model.v[b->model].rigidity >= TZ_FILL_RIGID ? b->n : 1;
}

/* Weights of edges, diagonal and half gradient; sums: align, continuity, rigidity. */
static void weigh_scalar(void *arg, int32_t from, int32_t to, double sums[4])
{
    const scalar_run *t = arg;
    tz_fill *f = t->f;
    for (int32_t j = from; j < to; j++) {
        const int32_t i = f->live_node.v[j];
        const double v = t->v[i];
        double g = 0, diag = 1e-12;
        const int32_t n = samples_of(f, i);
        for (int32_t s = i; s < i + n; s++) {
            const double d = v - t->target[s];
            if (t->said[s] > 0) {
                g += t->said[s] * d, diag += t->said[s];
                sums[0] += t->said[s] * d * d;
            }
        }
        for (int32_t e = f->link_start[i]; e < f->link_start[i] + f->link_count[i]; e++) {
            const tz_fill_link *l = &f->link.v[e];
            const double w = t->b2 * l->wc + l->wr, d = v - t->v[l->to];
            /* an edge between two unknown nodes stands in both lists */
            const double half =
                f->body.v[f->owner[l->to]].awake && !f->body.v[f->owner[l->to]].fixed
                    ? 0.5
                    : 1;
            f->edge_to[e] = l->to;
            f->edge_w[e] = w;
            g += w * d;
            sums[1] += half * t->b2 * l->wc * d * d;
            sums[2] += half * l->wr * d * d;
        }
        f->diag[i] = diag;
        f->gradient[i] = -g;
    }
}

static void add_scalar(void *arg, int32_t from, int32_t to, double sums[4])
{
    const scalar_run *t = arg;
    tz_fill *f = t->f;
    (void)sums;
    for (int32_t j = from; j < to; j++) {
        const int32_t i = f->live_node.v[j];
        f->kept[i] = t->v[i];
        t->v[i] += f->step[i];
    }
}

/* A step that did not help. */
static void undo_scalar(void *arg, int32_t from, int32_t to, double sums[4])
{
    const scalar_run *t = arg;
    tz_fill *f = t->f;
    (void)sums;
    for (int32_t j = from; j < to; j++)
        t->v[f->live_node.v[j]] = f->kept[f->live_node.v[j]];
}

static void spread_scalar(void *arg, int32_t from, int32_t to, double sums[4])
{
    const scalar_run *t = arg;
    tz_fill *f = t->f;
    (void)sums;
    for (int32_t j = from; j < to; j++) {
        const int32_t i = f->live_sample.v[j];
        t->v[i] = t->v[f->node[i]];
    }
}

static void widen(void *arg, int32_t from, int32_t to, double sums[4])
{
    tz_fill *f = arg;
    (void)sums;
    for (int32_t j = from; j < to; j++)
        tz_fill_set_rho(f, f->live_sample.v[j], f->rho[f->live_sample.v[j]]);
}

static tz_status scalar_step(tz_fill *f, double *v, const double *said,
                             const double *target, double before_after[2])
{
    scalar_run t = {f, v, said, target, f->par.beta * f->par.beta};
    double sums[4];
    tz_status s = tz_fill_blocks(f->ctx, f->live_node.n, weigh_scalar, &t, sums);
    before_after[0] = before_after[1] = sums[0] + sums[1] + sums[2];
    if (s != TZ_OK || !(before_after[0] > 1e-12 * f->live_node.n))
        return s;
    const tz_fill_system y = tz_fill_system_of(f, 1, 1);
    s = tz_fill_solve(&y, f->gradient, SMALL, ROUNDS, f->step);
    if (s == TZ_OK)
        s = tz_fill_blocks(f->ctx, f->live_node.n, add_scalar, &t, NULL);
    if (s == TZ_OK)
        s = tz_fill_blocks(f->ctx, f->live_node.n, weigh_scalar, &t, sums);
    before_after[1] = sums[0] + sums[1] + sums[2];
    if (s == TZ_OK && !(before_after[1] <= before_after[0] * (1 + 1e-9))) {
        s = tz_fill_blocks(f->ctx, f->live_node.n, undo_scalar, &t, NULL);
        before_after[1] = before_after[0];
    }
    if (s == TZ_OK)
        s = tz_fill_blocks(f->ctx, f->live_sample.n, spread_scalar, &t, NULL);
    return s;
}

tz_status tz_fill_scale_step(tz_fill *f, double before_after[2])
{
    tz_status s = TZ_OK;
    before_after[0] = before_after[1] = 0;
    if (f->any_size)
        s = scalar_step(f, f->c, f->said_c, f->target_c, before_after);
    if (s == TZ_OK && f->any_density) {
        double more[2];
        s = scalar_step(f, f->rho, f->said_rho, f->target_rho, more);
        before_after[0] += more[0], before_after[1] += more[1];
        if (s == TZ_OK)
            s = tz_fill_blocks(f->ctx, f->live_sample.n, widen, f, NULL);
    }
    return s;
}

/* ---- orientations: Eq. (11) --------------------------------------------------------- */

typedef struct turn_run {
    tz_fill *f;
    bool gradient, weights;
    double lambda;
} turn_run;

/* Half of Eq. (10) in the plane, all of it in space, and its half gradient; the block of
 * Gauss-Newton. */
static double rotation_term(const tz_fill *f, const double *u, double n, double *g,
                            double *block, double *rank)
{
    if (f->dim == 2) {
        const double d = u[0] * u[0] + u[1] * u[1] - 1;
        for (int k = 0; k < 2 && g; k++)
            g[k] += 2 * n * d * u[k];
        *rank = 4 * n;
        return n * d * d;
    }
    double sum = 0;
    if (block)
        memset(block, 0, 81 * sizeof *block);
    for (int a = 0; a < 3; a++)
        for (int b = a; b < 3; b++) {
            const double *p = u + 3 * (ptrdiff_t)a, *q = u + 3 * (ptrdiff_t)b;
            const double r = p[0] * q[0] + p[1] * q[1] + p[2] * q[2] - (a == b);
            double row[9] = {0};
            for (int k = 0; k < 3; k++) {
                row[3 * a + k] += q[k];
                row[3 * b + k] += p[k];
            }
            sum += n * r * r;
            for (int k = 0; k < 9 && g; k++)
                g[k] += n * r * row[k];
            for (int k = 0; k < 81 && block; k++)
                block[k] += n * row[k / 9] * row[k % 9];
        }
    return sum;
}

/* Sums: align, continuity, rigidity, rotation. Directions that weights w_o compare are
 * those at the beginning of the step: edge_w keeps them. */
static inline void weigh_turns(const turn_run *t, int32_t from, int32_t to,
                               double sums[4], const int m, const int cols)
{
    tz_fill *f = t->f;
    const int per = m / cols;
    const double a2 = f->par.alpha * f->par.alpha;
    for (int32_t j = from; j < to; j++) {
        const int32_t i = f->live_node.v[j], n = samples_of(f, i);
        const double *u = f->o + (ptrdiff_t)i * m;
        double g[9] = {0}, diag = 1e-12;
        for (int32_t s = i; s < i + n; s++) {
            const double w = f->confident[s] + f->prior[s],
                         *to_u = f->target + (ptrdiff_t)s * m;
            for (int k = 0; k < m && w > 0; k++) {
                g[k] += w * (u[k] - to_u[k]);
                sums[0] += w * (u[k] - to_u[k]) * (u[k] - to_u[k]);
            }
            diag += w;
        }
        for (int32_t e = f->link_start[i]; e < f->link_start[i] + f->link_count[i]; e++) {
            const tz_fill_link *l = &f->link.v[e];
            const double *v = f->o + (ptrdiff_t)l->to * m;
            const tz_fill_body *other = &f->body.v[f->owner[l->to]];
            const double half = other->awake && !other->fixed ? 0.5 : 1;
            f->edge_to[e] = l->to;
            for (int c = 0; c < cols; c++) {
                double *w = &f->edge_w[(ptrdiff_t)e * cols + c], dot = 1, d2 = 0;
                for (int k = c * per; k < (c + 1) * per; k++) {
                    dot += u[k] * v[k];
                    d2 += (u[k] - v[k]) * (u[k] - v[k]);
                }
                if (t->weights)
                    *w = a2 * l->wt * (dot > 0 ? dot : 0) + l->wr;
                for (int k = c * per; k < (c + 1) * per; k++)
                    g[k] += *w * (u[k] - v[k]);
                sums[1] += half * (*w - l->wr) * d2;
                sums[2] += half * l->wr * d2;
            }
        }
        double rank = 0, *block = f->dim == 3 ? f->block + (ptrdiff_t)i * 81 : NULL;
        sums[3] += rotation_term(f, u, n, g, block, &rank);
        f->rank[i] = rank;
        f->diag[i] = diag;
        for (int k = 0; k < m && t->gradient; k++)
            f->gradient[(ptrdiff_t)i * m + k] = -g[k];
    }
}

static void weigh_turn(void *arg, int32_t from, int32_t to, double sums[4])
{
    const turn_run *t = arg;
    if (t->f->m == 2) /* for the compiler: loops of known length */
        weigh_turns(t, from, to, sums, 2, 1);
    else
        weigh_turns(t, from, to, sums, t->f->m, t->f->columns);
}

tz_status tz_fill_turn_energy(tz_fill *f, double sums[4], bool gradient)
{
    turn_run t = {f, gradient, true, 0};
    return tz_fill_blocks(f->ctx, f->live_node.n, weigh_turn, &t, sums);
}

/* Marquardt's damping: lambda of each row's diagonal. */
static void damp(void *arg, int32_t from, int32_t to, double sums[4])
{
    const turn_run *t = arg;
    tz_fill *f = t->f;
    (void)sums;
    for (int32_t j = from; j < to; j++) {
        const int32_t i = f->live_node.v[j];
        double d = f->diag[i] + f->rank[i];
        for (int32_t e = f->link_start[i]; e < f->link_start[i] + f->link_count[i]; e++)
            d += f->edge_w[(ptrdiff_t)e * f->columns];
        f->diag[i] += t->lambda * d;
    }
}

static void add_turn(void *arg, int32_t from, int32_t to, double sums[4])
{
    const turn_run *t = arg;
    tz_fill *f = t->f;
    (void)sums;
    for (int32_t j = from; j < to; j++)
        for (int k = 0; k < f->m; k++) {
            const ptrdiff_t v = (ptrdiff_t)f->live_node.v[j] * f->m + k;
            f->kept[v] = f->o[v];
            f->o[v] += f->step[v];
        }
}

static void undo_turn(void *arg, int32_t from, int32_t to, double sums[4])
{
    const turn_run *t = arg;
    tz_fill *f = t->f;
    (void)sums;
    for (int32_t j = from; j < to; j++)
        for (int k = 0; k < f->m; k++) {
            const ptrdiff_t v = (ptrdiff_t)f->live_node.v[j] * f->m + k;
            f->o[v] = f->kept[v];
        }
}

static void spread_turn(void *arg, int32_t from, int32_t to, double sums[4])
{
    const turn_run *t = arg;
    tz_fill *f = t->f;
    (void)sums;
    for (int32_t j = from; j < to; j++) {
        const int32_t s = f->live_sample.v[j], i = f->node[s];
        if (i != s)
            memcpy(f->o + (ptrdiff_t)s * f->m, f->o + (ptrdiff_t)i * f->m,
                   (size_t)f->m * sizeof *f->o);
    }
}

static double total(const double sums[4])
{
    return sums[0] + sums[1] + sums[2] + sums[3];
}

tz_status tz_fill_turn_step(tz_fill *f, double before_after[2])
{
    turn_run t = {f, true, true, f->lambda > 0 ? f->lambda : 1e-3};
    double sums[4];
    tz_status s = tz_fill_blocks(f->ctx, f->live_node.n, weigh_turn, &t, sums);
    double energy = total(sums);
    before_after[0] = energy;
    t.weights = false;
    tz_fill_system y = tz_fill_system_of(f, f->m, f->columns);
    y.u = f->dim == 2 ? f->kept : NULL;
    y.rank = f->rank;
    y.block = f->dim == 3 ? f->block : NULL;
    for (int k = 0; k < LM_STEPS && s == TZ_OK && energy > 1e-9 * f->live_node.n; k++) {
        for (int32_t j = 0; j < f->live_node.n; j++)
            memcpy(f->kept + (ptrdiff_t)f->live_node.v[j] * f->m,
                   f->o + (ptrdiff_t)f->live_node.v[j] * f->m,
                   (size_t)f->m * sizeof *f->o);
        s = tz_fill_blocks(f->ctx, f->live_node.n, damp, &t, NULL);
        if (s == TZ_OK)
            s = tz_fill_solve(&y, f->gradient, SMALL, ROUNDS, f->step);
        if (s == TZ_OK)
            s = tz_fill_blocks(f->ctx, f->live_node.n, add_turn, &t, NULL);
        if (s == TZ_OK)
            s = tz_fill_blocks(f->ctx, f->live_node.n, weigh_turn, &t, sums);
        if (s != TZ_OK)
            break;
        const double after = total(sums);
        if (after <= energy) {
            const bool enough = after > 0.999 * energy;
            energy = after;
            t.lambda = fmax(t.lambda / 3, 1e-6);
            if (enough)
                break;
        } else {
            s = tz_fill_blocks(f->ctx, f->live_node.n, undo_turn, &t, NULL);
            t.lambda = fmin(t.lambda * 5, 1e3);
            if (s == TZ_OK)
                s = tz_fill_blocks(f->ctx, f->live_node.n, weigh_turn, &t, sums);
        }
    }
    f->lambda = t.lambda;
    before_after[1] = energy;
    if (s == TZ_OK && f->dim == 2)
        tz_fill_turn_rounds(f);
    if (s == TZ_OK)
        s = tz_fill_blocks(f->ctx, f->live_sample.n, spread_turn, &t, NULL);
    return s;
}

tz_status tz_fill_turn_again(tz_fill *f)
{
    enum { STEPS = 6 };
    double pair[2], graph;
    tz_status s = tz_fill_diagram(f);
    if (s != TZ_OK || f->live.n == 0)
        return s;
    const tz_power_cells cells = tz_power_get(f->power);
    s = tz_fill_neighbours(f, &cells);
    for (int k = 0; k < STEPS && s == TZ_OK; k++)
        s = tz_fill_turn_step(f, pair);
    return s == TZ_OK ? tz_fill_graph_step(f, pair, &graph) : s;
}
