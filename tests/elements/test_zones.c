/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Zones: tables, drawings and pictures with soft borders. */
#include "tests/base/check.h"

#include "elements/domain.h"
#include "tests/elements/guides.h"

static const tz_vec3 size = {200, 200, 0};
static const char *const kinds[] = {"leaf", "stone", "big flower"};

static bool allows(const tz_zones *z, double x, double y, int32_t kind)
{
    return tz_zones_allow(z, (tz_vec3){x, y, 0}, kind);
}

static void test_drawing(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_zones *z;
    /* later shapes lie above; the blue one is not named; a wide line is a shape too */
    const char *path =
        guide_svg("<rect width='100' height='50' fill='red'/>"
                  "<rect x='40' width='20' height='100' fill='#00ff00'/>"
                  "<circle cx='50' cy='50' r='5' fill='blue'/>"
                  "<path d='M0 90H30' stroke='#ff0000' stroke-width='10'/>");
    ok(ctx, tz_zones_read(ctx, path, " #ff0000 = leaf , big flower ;lime=stone; black=;",
                          kinds, 3, size, false, &z));
    assert_int_equal(z->zones, 4);
    assert_true(allows(z, 20, 20, 0) && !allows(z, 20, 20, 1) && allows(z, 20, 20, 2));
    assert_true(!allows(z, 100, 180, 0) && allows(z, 100, 180, 1));
    assert_true(allows(z, 100, 100, 0) && allows(z, 100, 100, 1));
    assert_true(allows(z, 20, 140, 0) && allows(z, 20, 140, 1));
    assert_true(allows(z, 20, 180, 0) && !allows(z, 20, 180, 1));
    assert_true(allows(z, 20, 20, 64) && allows(z, 20, 20, -1));
    assert_true(!allows(z, 79, 60, 1) && allows(z, 81, 60, 1));   /* borders in place */
    assert_true(allows(z, -50, 20, 0) && !allows(z, -50, 20, 1)); /* nearest beyond */
    const tz_domain d = {.size = size, .zones = z};
    assert_false(tz_domain_allows(&d, (tz_vec3){20, 20, 0}, 1));
    tz_zones_free(z);
    tz_zones_free(NULL);
    ok(ctx, tz_zones_read(ctx, path, "", kinds, 3, size, false, &z)); /* nothing named */
    assert_true(z->zones == 1 && allows(z, 20, 20, 0) && allows(z, 20, 20, 1));
    tz_zones_free(z);
    end_ctx(ctx);
}

/* Red beside blue, with a soft border that is nearly black or purple on the way, and
 * a little noise. */
static float soft(int32_t x, int32_t y, int32_t c)
{
    const float noise = (float)((x * 7 + y * 13 + c * 5) % 11 - 5) / 255;
    const float t = x < 49 ? 0 : x > 50 ? 1 : (float)(x - 48) / 3;
    const float v = c == 0 ? 1 - t : c == 2 ? t : 0;
    return fminf(fmaxf(v + noise, 0), 1);
}

static void test_picture(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_zones *z;
    ok(ctx, tz_zones_read(ctx, guide_image(ctx, 100, 80, 3, soft),
                          "#ff0000=leaf;#0000ff=stone", kinds, 3, size, false, &z));
    for (double x = 1; x < 200; x += 1)
        for (double y = 1; y < 200; y += 7) {
            if (x < 98)
                assert_true(allows(z, x, y, 0) && !allows(z, x, y, 1));
            else if (x > 102)
                assert_true(!allows(z, x, y, 0) && allows(z, x, y, 1));
            else /* one or the other */
                assert_true(allows(z, x, y, 0) != allows(z, x, y, 1));
        }
    tz_zones_free(z);
    end_ctx(ctx);
}

static void test_bad_input(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_zones *z = (void *)&ctx;
    const char *path = guide_svg("<rect width='50' height='50' fill='red'/>");
    fails(ctx, tz_zones_read(ctx, path, "red=rose", kinds, 3, size, false, &z),
          TZ_INVALID, "\"rose\"");
    assert_null(z);
    fails(ctx, tz_zones_read(ctx, path, "reddish=leaf", kinds, 3, size, false, &z),
          TZ_INVALID, "reddish");
    fails(ctx, tz_zones_read(ctx, path, "red", kinds, 3, size, false, &z), TZ_INVALID,
          "red");
    fails(ctx, tz_zones_read(ctx, path, "=leaf", kinds, 3, size, false, &z), TZ_INVALID,
          "colour");
    fails(ctx, tz_zones_read(ctx, "/none.png", "red=leaf", kinds, 3, size, false, &z),
          TZ_IO, "none.png");
    fails(ctx,
          tz_zones_read(ctx, guide_text("a.svg", "x"), "red=leaf", kinds, 3, size, false,
                        &z),
          TZ_FORMAT, "a.svg");
    char text[8192] = "";
    for (int i = 0; i < 256; i++)
        snprintf(text + strlen(text), 32, "#0000%02x=leaf;", i);
    fails(ctx, tz_zones_read(ctx, path, text, kinds, 3, size, false, &z), TZ_LIMIT,
          "255");
    *strrchr(text, '#') = 0; /* one less is good */
    ok(ctx, tz_zones_read(ctx, guide_svg("<rect width='50' height='50' fill='#0000fe'/>"),
                          text, kinds, 3, size, false, &z));
    assert_true(z->zones == 256 && !allows(z, 20, 20, 1) && allows(z, 150, 150, 1));
    tz_zones_free(z);
    end_ctx(ctx);
}

static tz_status read_one(tz_ctx *ctx)
{
    tz_zones *z = NULL;
    const tz_status s = tz_zones_read(ctx, guide_path, "red=leaf", kinds, 3,
                                      (tz_vec3){200, 3, 0}, false, &z);
    assert_true((s == TZ_OK) == (z != NULL));
    tz_zones_free(z);
    return s;
}

static void test_memory_runs_out(void **state)
{
    (void)state;
    guide_svg("<rect width='50' height='50' fill='red'/>");
    survive(read_one, 1);
    tz_ctx *ctx = new_ctx(1);
    guide_image(ctx, 20, 10, 3, soft);
    end_ctx(ctx);
    survive(read_one, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_drawing),
        cmocka_unit_test(test_picture),
        cmocka_unit_test(test_bad_input),
        cmocka_unit_test(test_memory_runs_out),
    };
    return cmocka_run_group_tests(tests, guide_begin, guide_end);
}
