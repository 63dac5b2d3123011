/* SPDX-License-Identifier: Apache-2.0 */
/* Sparse least squares by CHOLMOD. Equations are kept as triplets of W A; solving forms
 * A' (CHOLMOD factorises A' A from it without forming the product) and reuses the
 * symbolic factor while the pattern of A stays what it was. */
#include "base/lsq.h"

#include <cholmod.h>
#include <math.h>
#include <string.h>

#include "base/array.h"

typedef struct entry {
    int32_t row, column;
    double value;
} entry;

struct tz_lsq {
    tz_ctx *ctx;
    int32_t unknowns, rhs, rows;
    TZ_ARRAY(entry)
    entry;
    TZ_ARRAY(double)
    b; /* rows * rhs, weighted */
    cholmod_common common;
    cholmod_factor *factor;
    uint64_t pattern; /* hash of the pattern that `factor` was analysed for */
};

static void quiet(int status, const char *file, int line, const char *message)
{
    (void)status;
    (void)file;
    (void)line;
    (void)message;
}

tz_status tz_lsq_new(tz_ctx *ctx, int32_t unknowns, int32_t rhs, tz_lsq **out)
{
    if (unknowns < 1 || rhs < 1)
        return tz_fail(ctx, TZ_INVALID, "least squares: %d unknowns, %d right-hand sides",
                       unknowns, rhs);
    tz_lsq *s;
    tz_status status = tz_alloc_zero(ctx, &s, 1, sizeof *s);
    if (status != TZ_OK)
        return status;
    s->ctx = ctx;
    s->unknowns = unknowns;
    s->rhs = rhs;
    cholmod_start(&s->common);
    s->common.print = 0;
    s->common.error_handler = quiet;
    s->common.try_catch = 1;
    /* One ordering and the simplicial method without BLAS kernels: the same bits whatever
     * BLAS is installed and however many threads it takes. */
    s->common.nmethods = 1;
    s->common.method[0].ordering = CHOLMOD_AMD;
    s->common.postorder = 1;
    s->common.supernodal = CHOLMOD_SIMPLICIAL;
    s->common.final_ll = 0;
    *out = s;
    return TZ_OK;
}

void tz_lsq_free(tz_lsq *s)
{
    if (!s)
        return;
    cholmod_free_factor(&s->factor, &s->common);
    cholmod_finish(&s->common);
    tz_array_free(s->ctx, &s->entry);
    tz_array_free(s->ctx, &s->b);
    tz_free(s->ctx, s);
}

void tz_lsq_clear(tz_lsq *s)
{
    s->entry.n = 0;
    s->b.n = 0;
    s->rows = 0;
}

tz_status tz_lsq_add(tz_lsq *s, int32_t n, const int32_t *index, const double *coeff,
                     const double *b, double weight)
{
    if (!isfinite(weight) || weight < 0)
        return tz_fail(s->ctx, TZ_INVALID, "least squares: weight %g", weight);
    for (int32_t i = 0; i < n; i++)
        if (index[i] < 0 || index[i] >= s->unknowns || !isfinite(coeff[i]))
            return tz_fail(s->ctx, TZ_INVALID,
                           "least squares: unknown %d of %d, factor %g", index[i],
                           s->unknowns, coeff[i]);
    for (int32_t k = 0; k < s->rhs; k++)
        if (!isfinite(b[k]))
            return tz_fail(s->ctx, TZ_INVALID, "least squares: right-hand side %g", b[k]);
    tz_status status = tz_array_reserve(s->ctx, &s->entry, (int64_t)s->entry.n + n);
    if (status == TZ_OK)
        status = tz_array_reserve(s->ctx, &s->b, (int64_t)s->b.n + s->rhs);
    if (status != TZ_OK)
        return status;
    for (int32_t i = 0; i < n; i++)
        s->entry.v[s->entry.n++] = (entry){s->rows, index[i], weight * coeff[i]};
    for (int32_t k = 0; k < s->rhs; k++)
        s->b.v[s->b.n++] = weight * b[k];
    s->rows++;
    return TZ_OK;
}

/* FNV-1a over the rows and columns. */
static uint64_t hash_pattern(const tz_lsq *s)
{
    uint64_t h = 0xcbf29ce484222325u;
    for (int32_t i = 0; i < s->entry.n; i++) {
        h = (h ^ (uint32_t)s->entry.v[i].row) * 0x100000001b3u;
        h = (h ^ (uint32_t)s->entry.v[i].column) * 0x100000001b3u;
    }
    return (h ^ (uint32_t)s->rows) * 0x100000001b3u;
}

/* A' as a sparse matrix, unknowns x rows. */
static cholmod_sparse *transposed(tz_lsq *s)
{
    cholmod_triplet *t =
        cholmod_allocate_triplet((size_t)s->unknowns, (size_t)s->rows, (size_t)s->entry.n,
                                 0, CHOLMOD_REAL, &s->common);
    if (!t)
        return NULL;
    int *row = t->i, *column = t->j;
    double *value = t->x;
    for (int32_t i = 0; i < s->entry.n; i++) {
        row[i] = s->entry.v[i].column;
        column[i] = s->entry.v[i].row;
        value[i] = s->entry.v[i].value;
    }
    t->nnz = (size_t)s->entry.n;
    cholmod_sparse *a = cholmod_triplet_to_sparse(t, t->nnz, &s->common);
    cholmod_free_triplet(&t, &s->common);
    return a;
}

/* A' b, dense, unknowns x rhs. */
static cholmod_dense *right_side(tz_lsq *s)
{
    cholmod_dense *d =
        cholmod_zeros((size_t)s->unknowns, (size_t)s->rhs, CHOLMOD_REAL, &s->common);
    if (!d)
        return NULL;
    double *x = d->x;
    for (int32_t i = 0; i < s->entry.n; i++) {
        const entry *e = &s->entry.v[i];
        for (int32_t k = 0; k < s->rhs; k++)
            x[(ptrdiff_t)k * s->unknowns + e->column] +=
                e->value * s->b.v[(ptrdiff_t)e->row * s->rhs + k];
    }
    return d;
}

static tz_status singular(tz_lsq *s)
{
    return tz_fail(s->ctx, TZ_INVALID,
                   "least squares: %d equations do not determine all %d unknowns",
                   s->rows, s->unknowns);
}

tz_status tz_lsq_solve(tz_lsq *s, double *x)
{
    tz_status status = TZ_OK;
    cholmod_sparse *a = NULL;
    cholmod_dense *b = NULL, *solution = NULL;
    if (s->rows == 0)
        return singular(s);
    uint64_t pattern = hash_pattern(s);
    a = transposed(s);
    b = a ? right_side(s) : NULL;
    if (!b)
        goto memory;
    if (!s->factor || s->pattern != pattern) {
        cholmod_free_factor(&s->factor, &s->common);
        s->factor = cholmod_analyze(a, &s->common);
        s->pattern = pattern;
    }
    if (!s->factor || !cholmod_factorize(a, s->factor, &s->common))
        goto memory;
    /* LDL' goes through with tiny pivots where LL' would stop: look at the spread */
    if (s->factor->minor < s->factor->n || cholmod_rcond(s->factor, &s->common) < 1e-15) {
        status = singular(s);
        goto done;
    }
    solution = cholmod_solve(CHOLMOD_A, s->factor, b, &s->common);
    if (!solution)
        goto memory;
    memcpy(x, solution->x, (size_t)s->unknowns * (size_t)s->rhs * sizeof *x);
    goto done;
memory:
    status = tz_fail(s->ctx, TZ_NOMEM, "out of memory: least squares of %d equations",
                     s->rows);
done:
    cholmod_free_dense(&solution, &s->common);
    cholmod_free_dense(&b, &s->common);
    cholmod_free_sparse(&a, &s->common);
    return status;
}
