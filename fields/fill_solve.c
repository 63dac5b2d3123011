/* SPDX-License-Identifier: Apache-2.0 */
/* Conjugate gradients with a (block) diagonal preconditioner. Systems of element fields
 * are well conditioned where things touch, and each iteration begins where the last one
 * ended, so that a few rounds are enough; factorising anew would cost more than all of
 * them, as the neighbours, and so the pattern, change each time. */
#include "fields/fill_internal.h"

#include <string.h>

/* ---- blocks ------------------------------------------------------------------------- */

typedef struct blocks {
    tz_fill_work work;
    void *arg;
    int32_t n, size;
    double (*sum)[4];
} blocks;

static tz_status run_block(tz_ctx *ctx, void *arg, int64_t b, int worker)
{
    (void)ctx, (void)worker;
    const blocks *t = arg;
    const int32_t from = (int32_t)b * t->size, to = from + t->size;
    t->work(t->arg, from, to < t->n ? to : t->n, t->sum[b]);
    return TZ_OK;
}

static tz_status run_blocks(tz_ctx *ctx, blocks t, bool serial, double sums[4])
{
    enum { FEW = 64 };
    double few[FEW][4], none[4];
    const int32_t count = (t.n + t.size - 1) / t.size;
    double(*many)[4] = NULL;
    tz_status s = TZ_OK;
    if (!sums)
        sums = none;
    if (count > FEW)
        s = tz_alloc_zero(ctx, &many, (size_t)count, sizeof *many);
    else
        memset(few, 0, (size_t)count * sizeof *few);
    t.sum = many ? many : few;
    if (s == TZ_OK && !serial)
        s = tz_parallel_for(ctx, count, run_block, &t);
    for (int32_t b = 0; b < count && serial && s == TZ_OK; b++)
        s = run_block(ctx, &t, b, 0);
    for (int k = 0; k < 4; k++)
        sums[k] = 0;
    for (int32_t b = 0; b < count && s == TZ_OK; b++)
        for (int k = 0; k < 4; k++)
            sums[k] += t.sum[b][k];
    tz_free(ctx, many);
    return s;
}

tz_status tz_fill_blocks(tz_ctx *ctx, int32_t n, tz_fill_work work, void *arg,
                         double sums[4])
{
    return run_blocks(ctx, (blocks){work, arg, n, TZ_FILL_BLOCK, NULL},
                      n <= TZ_FILL_SERIAL, sums);
}

tz_status tz_fill_heavy(tz_ctx *ctx, int32_t n, tz_fill_work work, void *arg,
                        double sums[4])
{
    return run_blocks(ctx, (blocks){work, arg, n, TZ_FILL_HEAVY, NULL},
                      n <= 8 * TZ_FILL_HEAVY, sums);
}

/* ---- rounds ------------------------------------------------------------------------- */

typedef struct run {
    const tz_fill_system *s;
    double *x, *r, *z, *p, *q; /* r begins as the right side */
    double alpha, beta;
} run;

static double whole_diag(const tz_fill_system *s, int32_t i, int k)
{
    double d = s->diag[i];
    const int per = s->m / s->columns;
    for (int32_t e = s->start[i]; e < s->start[i] + s->count[i]; e++)
        d += s->w[(ptrdiff_t)e * s->columns + k / per];
    if (s->u)
        d += s->rank[i] * s->u[(ptrdiff_t)i * s->m + k] * s->u[(ptrdiff_t)i * s->m + k];
    if (s->block)
        d += s->block[((ptrdiff_t)i * s->m + k) * s->m + k];
    return d;
}

/* z holds 1 / diagonal until a round needs room of its own: here it stays. */
static void first(void *arg, int32_t from, int32_t to, double sums[4])
{
    run *t = arg;
    const tz_fill_system *s = t->s;
    const int m = s->m;
    for (int32_t j = from; j < to; j++) {
        const int32_t i = s->node[j];
        double base = s->diag[i];
        if (s->columns == 1)
            for (int32_t e = s->start[i]; e < s->start[i] + s->count[i]; e++)
                base += s->w[e];
        for (int k = 0; k < m; k++) {
            const ptrdiff_t v = (ptrdiff_t)i * m + k;
            double d = base;
            if (s->columns > 1 || s->block)
                d = whole_diag(s, i, k);
            else if (s->u)
                d += s->rank[i] * s->u[v] * s->u[v];
            d = d > 0 ? 1 / d : 0;
            t->x[v] = 0;
            t->z[v] = d;
            t->p[v] = d * t->r[v];
            sums[0] += t->r[v] * t->p[v];
            sums[1] += d > 0 ? 1 / d : 0;
        }
    }
}

static inline void edges_1(const run *t, int32_t i)
{
    const tz_fill_system *s = t->s;
    const double p = t->p[i];
    double q = s->diag[i] * p;
    for (int32_t e = s->start[i]; e < s->start[i] + s->count[i]; e++)
        q += s->w[e] * (p - t->p[s->to[e]]);
    t->q[i] = q;
}

static inline void edges_2(const run *t, int32_t i)
{
    const tz_fill_system *s = t->s;
    const double *p = t->p + 2 * (ptrdiff_t)i;
    double x = s->diag[i] * p[0], y = s->diag[i] * p[1];
    for (int32_t e = s->start[i]; e < s->start[i] + s->count[i]; e++) {
        const double *o = t->p + 2 * (ptrdiff_t)s->to[e], w = s->w[e];
        x += w * (p[0] - o[0]), y += w * (p[1] - o[1]);
    }
    if (s->u) {
        const double *u = s->u + 2 * (ptrdiff_t)i;
        const double d = s->rank[i] * (u[0] * p[0] + u[1] * p[1]);
        x += d * u[0], y += d * u[1];
    }
    t->q[2 * (ptrdiff_t)i] = x, t->q[2 * (ptrdiff_t)i + 1] = y;
}

static void edges_any(const run *t, int32_t i)
{
    const tz_fill_system *s = t->s;
    const int m = s->m, per = m / s->columns;
    const double *p = t->p + (ptrdiff_t)i * m;
    double *q = t->q + (ptrdiff_t)i * m;
    for (int k = 0; k < m; k++)
        q[k] = s->diag[i] * p[k];
    for (int32_t e = s->start[i]; e < s->start[i] + s->count[i]; e++) {
        const double *o = t->p + (ptrdiff_t)s->to[e] * m;
        for (int k = 0; k < m; k++)
            q[k] += s->w[(ptrdiff_t)e * s->columns + k / per] * (p[k] - o[k]);
    }
    const double *b = s->block ? s->block + (ptrdiff_t)i * m * m : NULL;
    for (int k = 0; k < m && b; k++)
        for (int l = 0; l < m; l++)
            q[k] += b[k * m + l] * p[l];
}

static void multiply(void *arg, int32_t from, int32_t to, double sums[4])
{
    run *t = arg;
    const int m = t->s->m;
    for (int32_t j = from; j < to; j++) {
        const int32_t i = t->s->node[j];
        if (m == 1)
            edges_1(t, i);
        else if (m == 2)
            edges_2(t, i);
        else
            edges_any(t, i);
        for (int k = 0; k < m; k++)
            sums[0] += t->p[(ptrdiff_t)i * m + k] * t->q[(ptrdiff_t)i * m + k];
    }
}

static void advance(void *arg, int32_t from, int32_t to, double sums[4])
{
    run *t = arg;
    const int m = t->s->m;
    for (int32_t j = from; j < to; j++)
        for (int k = 0; k < m; k++) {
            const ptrdiff_t v = (ptrdiff_t)t->s->node[j] * m + k;
            t->x[v] += t->alpha * t->p[v];
            t->r[v] -= t->alpha * t->q[v];
            sums[0] += t->r[v] * t->r[v] * t->z[v];
        }
}

static void turn(void *arg, int32_t from, int32_t to, double sums[4])
{
    run *t = arg;
    const int m = t->s->m;
    (void)sums;
    for (int32_t j = from; j < to; j++)
        for (int k = 0; k < m; k++) {
            const ptrdiff_t v = (ptrdiff_t)t->s->node[j] * m + k;
            t->p[v] = t->z[v] * t->r[v] + t->beta * t->p[v];
        }
}

static void clear(void *arg, int32_t from, int32_t to, double sums[4])
{
    run *t = arg;
    const int m = t->s->m;
    (void)sums;
    for (int32_t j = from; j < to; j++)
        for (int k = 0; k < m; k++)
            t->p[(ptrdiff_t)t->s->node[j] * m + k] = 0;
}

tz_status tz_fill_solve(const tz_fill_system *s, double *b, double small, int32_t rounds,
                        double *x)
{
    const ptrdiff_t room = (ptrdiff_t)s->size * s->m;
    run t = {s, x, b, s->work, s->work + room, s->work + 2 * room, 0, 0};
    double sums[4];
    tz_status st = tz_fill_blocks(s->ctx, s->nodes, first, &t, sums);
    double rz = sums[0];
    const double enough = fmax(small * small * sums[1], 1e-6 * rz);
    for (int32_t k = 0; k < rounds && st == TZ_OK && rz > enough; k++) {
        st = tz_fill_blocks(s->ctx, s->nodes, multiply, &t, sums);
        if (st != TZ_OK || !(sums[0] > 0))
            break;
        t.alpha = rz / sums[0];
        st = tz_fill_blocks(s->ctx, s->nodes, advance, &t, sums);
        t.beta = sums[0] / rz;
        rz = sums[0];
        if (st == TZ_OK)
            st = tz_fill_blocks(s->ctx, s->nodes, turn, &t, NULL);
    }
    if (st == TZ_OK)
        st = tz_fill_blocks(s->ctx, s->nodes, clear, &t, NULL);
    else
        memset(t.p, 0, (size_t)room * sizeof *t.p);
    return st;
}
