/* SPDX-License-Identifier: Apache-2.0 */
/* Parameter tables: every type there and back, bad values, the three prints. */
#include "tests/base/check.h"

#include "base/geom.h"
#include "base/param.h"

typedef struct settings {
    bool on;
    int32_t count, mode, size[2];
    uint64_t seed, memory;
    double scale, range[2];
    char name[TZ_PARAM_STRING_SIZE];
    tz_rect crop;
} settings;

#define AT(m) offsetof(settings, m)
static const tz_param rows[] = {
    {"on", TZ_PARAM_BOOL, AT(on), 0, 1, "true", "", NULL, "Whether."},
    {"count", TZ_PARAM_INT, AT(count), -5, 100, "7", "px", NULL, "How \"many\"."},
    {"mode", TZ_PARAM_ENUM, AT(mode), 0, 2, "fast", "", "slow|fast|faster", "Which."},
    {"size", TZ_PARAM_SIZE, AT(size), 1, 1000000, "1024x512", "px", NULL, "How large."},
    {"seed", TZ_PARAM_UINT64, AT(seed), 0, 18446744073709551615.0, "1", "", NULL,
     "Seed."},
    {"memory", TZ_PARAM_BYTES, AT(memory), 0, 1e15, "1G", "", NULL, "Budget."},
    {"scale", TZ_PARAM_DOUBLE, AT(scale), 0, 10, "0.1", "", NULL, "Factor."},
    {"range", TZ_PARAM_RANGE, AT(range), -180, 180, "-5,5", "deg", NULL, "From, to."},
    {"name", TZ_PARAM_STRING, AT(name), 0, 0, "", "", NULL, ".Starts with a dot \\."},
    {"crop", TZ_PARAM_RECT, AT(crop), -100, 100, "0,0,0,0", "px", NULL, "Part."},
};
static const tz_param_table table = {"test", "A table.", rows, 10, sizeof(settings)};

static void defaults(void **state)
{
    (void)state;
    settings s;
    tz_params_default(&table, &s);
    assert_true(s.on && s.count == 7 && s.mode == 1 && s.size[0] == 1024 &&
                s.size[1] == 512);
    assert_true(s.seed == 1 && s.memory == 1u << 30 && s.scale == 0.1);
    assert_true(s.range[0] == -5 && s.range[1] == 5 && s.name[0] == 0 && s.crop.w == 0);
    assert_null(tz_params_find(&table, "nothing"));
    assert_ptr_equal(tz_params_find(&table, "mode"), &rows[2]);
}

static void good_values(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    static const char *const sets[][3] = {
        /* name, text, as printed (NULL = the same) */
        {"on", "off", "false"},
        {"on", "YES", "true"},
        {"on", "0", "false"},
        {"count", "-5", NULL},
        {"count", "+100", "100"},
        {"mode", "faster", NULL},
        {"mode", "slow", NULL},
        {"size", "1X1000000", "1x1000000"},
        {"seed", "18446744073709551615", NULL},
        {"seed", "9007199254740993", NULL},
        {"memory", "512M", NULL},
        {"memory", "64KiB", "64K"},
        {"memory", "1000", NULL},
        {"memory", "2t", "2T"},
        {"scale", "0.30000000000000004", NULL},
        {"scale", "1e-3", "0.001"},
        {"scale", ".5", "0.5"},
        {"range", "7", "7,7"},
        {"range", "-180,0.1", NULL},
        {"name", "", NULL},
        {"name", "gr\xc3\xa4ser ,x=1", NULL},
        {"crop", "-1,2,3,100", NULL},
    };
    settings s, again;
    tz_params_default(&table, &s);
    for (size_t i = 0; i < sizeof sets / sizeof *sets; i++) {
        char text[TZ_PARAM_STRING_SIZE];
        ok(ctx, tz_params_set(ctx, &table, &s, sets[i][0], sets[i][1]));
        tz_params_get(tz_params_find(&table, sets[i][0]), &s, text, sizeof text);
        assert_string_equal(text, sets[i][2] ? sets[i][2] : sets[i][1]);
        again = s;
        ok(ctx, tz_params_set(ctx, &table, &again, sets[i][0], text));
        assert_memory_equal(&s, &again, sizeof s);
    }
    end_ctx(ctx);
}

static void bad_values(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    static const char *const bad[][3] = {
        {"on", "maybe", "true or false"},
        {"on", "", "true or false"},
        {"count", "101", "-5 to 100 px"},
        {"count", "-6", "out of range"},
        {"count", "99999999999999999999", "out of range"},
        {"count", "7.5", "whole number"},
        {"count", " 7", "whole number"},
        {"count", "7 ", "whole number"},
        {"mode", "fas", "slow|fast|faster"},
        {"mode", "slow|fast", "one of"},
        {"mode", "", "one of"},
        {"size", "1024", "1024x512"},
        {"size", "0x5", "out of range"},
        {"size", "2147483648x1", "out of range"},
        {"size", "-1x1", "out of range"},
        {"size", "5x5x5", "a size"},
        {"seed", "-1", "out of range"},
        {"seed", "18446744073709551616", "out of range"},
        {"memory", "1Q", "512M"},
        {"memory", "99999999999T", "out of range"},
        {"scale", "nan", "a number"},
        {"scale", "inf", "a number"},
        {"scale", "1e999", "out of range"},
        {"scale", "1,5", "a number"},
        {"scale", "0x1p3", "a number"},
        {"range", "5,-5", "lower first"},
        {"range", "1,2,3", "a number"},
        {"range", "0,181", "out of range"},
        {"crop", "1,2,3", "rectangle"},
        {"colour", "red", "no parameter"},
    };
    settings s, before;
    tz_params_default(&table, &s);
    before = s;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        fails(ctx, tz_params_set(ctx, &table, &s, bad[i][0], bad[i][1]), TZ_INVALID,
              bad[i][2]);
        assert_memory_equal(&s, &before, sizeof s);
    }
    char longer[TZ_PARAM_STRING_SIZE + 1];
    memset(longer, 'x', sizeof longer);
    longer[TZ_PARAM_STRING_SIZE] = 0;
    fails(ctx, tz_params_set(ctx, &table, &s, "name", longer), TZ_INVALID, "1023");
    end_ctx(ctx);
}

static char *printed(void (*print)(const tz_param_table *, FILE *))
{
    char *text = NULL;
    size_t n;
    FILE *f = open_memstream(&text, &n);
    print(&table, f);
    fclose(f);
    return text;
}

static void prints(void **state)
{
    (void)state;
    char *text = printed(tz_params_print_text);
    assert_non_null(strstr(text, "--range LO,HI"));
    assert_non_null(strstr(text, "-180 to 180 deg; default -5,5"));
    free(text);
    text = printed(tz_params_print_schema);
    assert_non_null(strstr(text, "\"How \\\"many\\\".\""));
    assert_non_null(strstr(text, "\"enum\": [\"slow\", \"fast\", \"faster\"]"));
    assert_non_null(strstr(text, "\"default\": true"));
    free(text);
    text = printed(tz_params_print_man);
    assert_non_null(strstr(text, ".TP\n\\fB\\-\\-range\\fR \\fILO,HI\\fR\n"));
    assert_non_null(strstr(text, "\n\\&.Starts with a dot \\e."));
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(defaults),
        cmocka_unit_test(good_values),
        cmocka_unit_test(bad_values),
        cmocka_unit_test(prints),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
