/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Sparse linear least squares min |A x - b|^2 by CHOLMOD on the normal equations; the
 * symbolic analysis is kept while the pattern holds. */
#ifndef TZ_BASE_LSQ_H
#define TZ_BASE_LSQ_H

#include "base/ctx.h"

typedef struct tz_lsq tz_lsq;

/** @param unknowns  columns of A  @param rhs  right-hand sides solved at once (e.g. 2) */
TZ_API tz_status tz_lsq_new(tz_ctx *ctx, int32_t unknowns, int32_t rhs, tz_lsq **out);
TZ_API void tz_lsq_free(tz_lsq *s);
/** Forgets the equations, keeps the symbolic factor for reuse. */
TZ_API void tz_lsq_clear(tz_lsq *s);
/** Adds one equation w (sum_i coeff[i] x[index[i]] - b) = 0; b holds `rhs` numbers. */
TZ_API tz_status tz_lsq_add(tz_lsq *s, int32_t n, const int32_t *index,
                            const double *coeff, const double *b, double weight);
/** Solves; x is unknowns * rhs, column (right-hand side) after column.
 * @return TZ_OK; TZ_INVALID if the system is singular; TZ_NOMEM */
TZ_API tz_status tz_lsq_solve(tz_lsq *s, double *x);

#endif
