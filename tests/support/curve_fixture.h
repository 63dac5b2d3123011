/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A context for each test of curves, of which nothing may be left. */
#ifndef TZ_TESTS_SUPPORT_CURVE_FIXTURE_H
#define TZ_TESTS_SUPPORT_CURVE_FIXTURE_H

#include "tests/base/check.h"

static tz_ctx *ctx;

static int begin(void **state)
{
    (void)state;
    ctx = new_ctx(2);
    return 0;
}

static int end(void **state)
{
    (void)state;
    end_ctx(ctx);
    return 0;
}

#endif
