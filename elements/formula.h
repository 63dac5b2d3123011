/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Formulas in x and y: parsed once, then evaluated anywhere, from any thread.
 *
 *   sum     = product { (+|-) product }
 *   product = sign { (*|/) sign }
 *   sign    = (+|-) sign | power
 *   power   = atom [ ^ sign ]            2^3^2 is 2^9, -2^2 is -4
 *   atom    = number | name | name ( sum {, sum} ) | ( sum )
 *
 * Names: x y w h pi; sin cos tan asin acos atan sqrt abs exp log floor of one value, atan2
 * min max mod of two; angles in radians; mod has the sign of its divisor. */
#ifndef TZ_ELEMENTS_FORMULA_H
#define TZ_ELEMENTS_FORMULA_H

#include "base/array.h"

typedef struct tz_formula_step {
    int32_t code;
    double value; /**< of a constant */
} tz_formula_step;

/** Steps of a stack machine. */
typedef struct tz_formula {
    TZ_ARRAY(tz_formula_step)
    step;
} tz_formula;

typedef struct tz_formula_place {
    double x, y, w, h;
} tz_formula_place;

/** @param[out] f  overwritten, not freed; zeroed on error
 * @return TZ_OK; TZ_INVALID (what is wrong, and at which character); TZ_LIMIT (over 4,096
 *   characters or 64 levels); TZ_NOMEM */
TZ_API tz_status tz_formula_parse(tz_ctx *ctx, const char *text, tz_formula *f);
TZ_API void tz_formula_deinit(tz_ctx *ctx, tz_formula *f);
/** NAN or infinite where the formula has no value. */
TZ_API double tz_formula_at(const tz_formula *f, tz_formula_place place);

#endif
