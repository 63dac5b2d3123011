/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Formulas: values, precedence, faults, and any text at all. */
#include "tests/base/check.h"

#include <math.h>

#include "base/rng.h"
#include "elements/formula.h"

static double value(tz_ctx *ctx, const char *text)
{
    tz_formula f;
    ok(ctx, tz_formula_parse(ctx, text, &f));
    const double v = tz_formula_at(&f, (tz_formula_place){3, 5, 100, 60});
    tz_formula_deinit(ctx, &f);
    return v;
}

static void test_values(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    const double x = 3, y = 5, w = 100, h = 60, pi = acos(-1);
    static const char *const text[] = {"1+2*3-4/8",
                                       "-2^2",
                                       "2^3^2",
                                       "2^-1",
                                       "--3",
                                       "(1+2)*(3-4)",
                                       "x*w+y/h",
                                       "atan2(y-h/2, x-w/2)*180/pi",
                                       "sin(x)^2+cos(x)^2",
                                       "mod(-7,3)",
                                       "min(x,y)-max(x,y)",
                                       " 1e2 + .5 ",
                                       "sqrt(abs(-16))",
                                       "floor(-1.5)",
                                       "exp(log(7))",
                                       "tan(asin(0.5))+acos(1)+atan(1)",
                                       "8/4/2",
                                       "8-4-2",
                                       "+x"};
    const double want[] = {1 + 2 * 3 - 4 / 8.0,
                           -4,
                           512,
                           0.5,
                           3,
                           -3,
                           x * w + y / h,
                           atan2(y - h / 2, x - w / 2) * 180 / pi,
                           1,
                           2,
                           -2,
                           100.5,
                           4,
                           -2,
                           7,
                           tan(asin(0.5)) + atan(1),
                           1,
                           2,
                           3};
    for (size_t i = 0; i < sizeof text / sizeof text[0]; i++)
        assert_float_equal(value(ctx, text[i]), want[i], 1e-12);
    assert_true(isnan(value(ctx, "sqrt(-1)")));
    assert_true(isinf(value(ctx, "1/0")));
    end_ctx(ctx);
}

static void test_faults(void **state)
{
    (void)state;
    static const struct {
        const char *text, *part;
    } bad[] = {
        {"", "character 1"},      {"1+", "character 3"},   {"2*(3", "a ) is missing"},
        {"sin x", "a ( is"},      {"atan2(1)", "comma"},   {"foo(1)", "not known"},
        {"1 2", "character 3"},   {"x y", "character 3"},  {"1)", "character 2"},
        {"min(1,2,3)", "a ) is"}, {"\xff", "character 1"}, {"1e999", "character 1"}};
    tz_ctx *ctx = new_ctx(1);
    tz_formula f;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        fails(ctx, tz_formula_parse(ctx, bad[i].text, &f), TZ_INVALID, bad[i].part);
        assert_true(f.step.v == NULL && f.step.n == 0);
    }
    char deep[6000];
    memset(deep, '(', sizeof deep);
    deep[200] = 0;
    fails(ctx, tz_formula_parse(ctx, deep, &f), TZ_LIMIT, "levels");
    memset(deep, '-', 200);
    fails(ctx, tz_formula_parse(ctx, deep, &f), TZ_LIMIT, "levels");
    memset(deep, '1', sizeof deep);
    deep[5000] = 0;
    fails(ctx, tz_formula_parse(ctx, deep, &f), TZ_LIMIT, "characters");
    end_ctx(ctx);
}

/* The deepest stack that the grammar can ask for. */
static void test_deep_stack(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    char text[4096] = "";
    int levels = 0;
    for (; levels < 31; levels++) /* a sign and a power each: two levels */
        strcat(text, "1+2*1^max(1,");
    strcat(text, "5");
    for (int k = 0; k < levels; k++)
        strcat(text, ")");
    assert_true(isfinite(value(ctx, text)));
    end_ctx(ctx);
}

/* Words of the language in any order: parsed or refused in one line, never worse. */
static void test_any_text(void **state)
{
    (void)state;
    static const char *const words[] = {
        "x", "y", "w", "h",   "pi",    "1",    ".5",  "2e3", "+", "-",    "*", "/", "^",
        "(", ")", ",", "sin", "atan2", "min(", "mod", " ",   "q", "\x80", "e", "."};
    tz_ctx *ctx = new_ctx(1);
    int good = 0;
    for (int round = 0; round < 60000; round++) {
        tz_rng r = tz_rng_make(11, (uint64_t)round);
        char text[512] = "";
        tz_formula f;
        for (int k = 1 + tz_rng_below(&r, 1 + round % 40); k > 0; k--)
            strcat(text, words[tz_rng_below(&r, sizeof words / sizeof words[0])]);
        const tz_status s = tz_formula_parse(ctx, text, &f);
        if (s == TZ_OK) {
            good++;
            (void)tz_formula_at(&f, (tz_formula_place){1, 2, 3, 4});
        } else {
            assert_true(s == TZ_INVALID || s == TZ_LIMIT);
            assert_true(tz_ctx_message(ctx)[0] && !strchr(tz_ctx_message(ctx), '\n'));
            tz_ctx_clear(ctx);
        }
        tz_formula_deinit(ctx, &f);
    }
    assert_true(good > 1000);
    end_ctx(ctx);
}

static tz_status parse_one(tz_ctx *ctx)
{
    tz_formula f;
    const tz_status s = tz_formula_parse(ctx, "atan2(y - h/2, x - w/2) * 180 / pi", &f);
    tz_formula_deinit(ctx, &f);
    return s;
}

static void test_memory_runs_out(void **state)
{
    (void)state;
    survive(parse_one, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_values),          cmocka_unit_test(test_faults),
        cmocka_unit_test(test_deep_stack),      cmocka_unit_test(test_any_text),
        cmocka_unit_test(test_memory_runs_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
