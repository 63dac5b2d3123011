/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What tests of element documents share: a context and a set for each case, and reading
 * of drawings that stand in the test. */
#ifndef TZ_TESTS_ELEMENTS_SVG_READING_H
#define TZ_TESTS_ELEMENTS_SVG_READING_H

#include "tests/base/check.h"

#include <math.h>

#include "elements/element_io.h"

#define HEAD                                        \
    "<svg xmlns=\"http://www.w3.org/2000/svg\" "    \
    "xmlns:xlink=\"http://www.w3.org/1999/xlink\" " \
    "xmlns:tz=\"https://terrazzo.example/ns/1\" viewBox=\"0 0 100 100\">"
#define TAIL "</svg>"

static tz_ctx *ctx;
static tz_element_set set;

static int begin(void **state)
{
    (void)state;
    ctx = new_ctx(1);
    return 0;
}

static int end(void **state)
{
    (void)state;
    tz_element_set_deinit(&set);
    end_ctx(ctx);
    return 0;
}

static tz_status parse(const char *text, const tz_element_read_options *o)
{
    tz_element_set_deinit(&set);
    return tz_element_parse_svg(ctx, "t.svg", text, strlen(text), o, &set);
}

static void read_as(const char *text, const tz_element_read_options *o, int32_t elements)
{
    ok(ctx, parse(text, o));
    if (set.element.n != elements)
        fail_msg("%d elements in place of %d in %s", set.element.n, elements, text);
}

#define READ(body, elements) read_as(HEAD body TAIL, NULL, elements)

/* In double precision, unlike cmocka's own. */
static void near(double a, double b, double tolerance)
{
    if (!(fabs(a - b) <= tolerance))
        fail_msg("%.17g is not %.17g", a, b);
}

#endif
