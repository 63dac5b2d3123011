/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Optimal assignment of few rows to few columns, in which a row may also stay alone at a
 * cost of its own: the augmented matrix [C_m | C_u] of the paper without its right half,
 * whose columns are all alike.
 * @source [Tu20] Eq. (9) to (11); Riesen, Bunke: Approximate graph edit distance
 *   computation by means of bipartite graph matching, 2009 */
#ifndef TZ_CURVES_ASSIGN_H
#define TZ_CURVES_ASSIGN_H

#include <stdbool.h>
#include <stdint.h>

#include "base/export.h"

enum { TZ_ASSIGN_MOST = 64 /**< rows, and columns */ };

/** A problem and its solution. Costs are >= 0; INFINITY: never. Fill rows, cols, cost and
 * exit; the rest is the solver's, and its state for a warm start. */
typedef struct tz_assign {
    int32_t rows, cols;
    float cost[TZ_ASSIGN_MOST][TZ_ASSIGN_MOST]; /**< [row][column] */
    float exit[TZ_ASSIGN_MOST];  /**< of staying alone; INFINITY: must not */
    int32_t to[TZ_ASSIGN_MOST];  /**< result: column of each row, or -1 */
    int32_t row[TZ_ASSIGN_MOST]; /**< row of each column, or -1 */
    float u[TZ_ASSIGN_MOST];     /**< dual of each row */
    float v[TZ_ASSIGN_MOST];     /**< dual of each column, <= 0, 0 where it is free */
} tz_assign;

/** The least cost, with a->to filled.
 * @param warm    begins with a->v of the problem solved last, which had as many columns:
 *   quick where the costs are nearly those. The result is as good as without.
 * @param enough  gives up as soon as the cost is known to reach this
 * @return the cost; INFINITY if it is `enough` or more, or if there is no assignment
 *   (then a->to is undefined)
 * @cost O(rows cols) where rows do not compete, else up to O(rows^2 cols) */
TZ_API float tz_assign_solve(tz_assign *a, bool warm, float enough);

/** A lower bound of that cost from the rows' least entries alone, given duals a->v <= 0.
 * */
TZ_API float tz_assign_bound(const tz_assign *a, bool warm);

#endif
