/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Ramps, and the lengths of vectors. */
#include "tests/base/check.h"

#include <math.h>
#include <string.h>

#include "base/image_io.h"
#include "fields/ramp.h"
#include "fields/vectors.h"
#include "tests/fields/filling.h"

static void ramps_are_read(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_ramp r;
    uint8_t c[3], d[3];
    ok(ctx, tz_ramp_parse(ctx, "#000, #fff,#00ff00", &r));
    assert_int_equal(r.n, 3);
    tz_ramp_at(&r, 0.25, c);
    assert_true(abs(c[0] - 128) <= 1 && c[0] == c[1] && c[1] == c[2]);
    tz_ramp_at(&r, 7, c);
    assert_true(c[0] == 0 && c[1] == 255 && c[2] == 0);
    tz_ramp_at(&r, -1, c);
    assert_true(c[0] == 0 && c[1] == 0);
    ok(ctx, tz_ramp_parse(ctx, "hue", &r));
    tz_ramp_at(&r, 0.0001, c), tz_ramp_at(&r, 0.9999, d); /* it is closed */
    for (int k = 0; k < 3; k++)
        assert_true(abs(c[k] - d[k]) <= 1);
    /* neither viridis nor magma gets darker on the way */
    static const char *const names[] = {"viridis", "magma", "grey"};
    for (int i = 0; i < 3; i++) {
        double last = -1;
        ok(ctx, tz_ramp_parse(ctx, names[i], &r));
        for (int k = 0; k <= 64; k++) {
            tz_ramp_at(&r, k / 64.0, c);
            const double light = 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
            assert_true(light >= last - 1);
            last = light;
        }
    }
    static const char *const bad[] = {"", "viridian", "#12", "#fff,,#000", "red;blue"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        fails(ctx, tz_ramp_parse(ctx, bad[i], &r), TZ_INVALID, "ramp");
    end_ctx(ctx);
}

/* A layout of a palette's own elements. */
static tz_status layout_of(tz_ctx *ctx, tz_element_set *palette, tz_element_set *layout)
{
    tz_status s = filling_palette(ctx, 1, palette);
    if (s != TZ_OK)
        return s;
    s = tz_element_set_like(ctx, palette, NULL, layout);
    for (int32_t i = 0; i < 30 && s == TZ_OK; i++)
        s = tz_element_set_place(layout, palette, i % palette->element.n,
                                 (tz_vec3){4.0 * i, 20, 0}, 0.1 * i, 1);
    return s;
}

static void elements_are_coloured(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set palette, layout = {0};
    tz_ramp r;
    double value[30];
    ok(ctx, layout_of(ctx, &palette, &layout));
    ok(ctx, tz_ramp_parse(ctx, "#ff0000,#0000ff", &r));
    for (int i = 0; i < 30; i++)
        value[i] = i == 7 ? NAN : i / 29.0;
    ok(ctx, tz_ramp_paint(&r, &layout, value));
    assert_true(layout.symbol.n > palette.symbol.n + 10);
    assert_true(layout.symbol.n <= palette.symbol.n * (1 + TZ_RAMP_STEPS));
    assert_int_equal(layout.element.v[7].symbol,
                     palette.element.v[7 % palette.element.n].symbol);
    assert_non_null(
        strstr(layout.symbol.v[layout.element.v[0].symbol].markup, "#ff0000"));
    assert_non_null(
        strstr(layout.symbol.v[layout.element.v[29].symbol].markup, "#0000ff"));
    assert_non_null(strstr(layout.symbol.v[layout.element.v[0].symbol].id,
                           layout.symbol.v[palette.element.v[0].symbol].id));
    ok(ctx, tz_element_set_check(ctx, &layout, "layout"));
    assert_true(tz_ramp_strip(&layout, &palette));
    for (int32_t i = 0; i < 30; i++)
        assert_int_equal(layout.element.v[i].symbol,
                         palette.element.v[i % palette.element.n].symbol);
    /* one of another palette is told apart */
    tz_free(ctx, layout.symbol.v[0].id);
    ok(ctx, tz_strdup(ctx, "other", &layout.symbol.v[0].id));
    assert_false(tz_ramp_strip(&layout, &palette));
    tz_element_set_deinit(&layout);
    tz_element_set_deinit(&palette);
    end_ctx(ctx);
}

/* Vectors that grow to the right, through 0, in a file of floats and one of bytes. */
static tz_status write_vectors(tz_ctx *ctx, const char *path, bool is_float, bool grey)
{
    tz_image im;
    tz_status s = tz_image_init(ctx, &im, 64, 16, grey ? 1 : 3);
    for (int32_t y = 0; y < 16 && s == TZ_OK; y++)
        for (int32_t x = 0; x < 64; x++) {
            float *p = tz_image_at(&im, x, y);
            const float v = ((float)x - 31.5f) / 31.5f;
            p[0] = is_float ? 8 * v : 0.5f + 0.5f * v;
            for (int c = 1; c < im.channels; c++)
                p[c] = is_float ? 0 : 0.5f;
        }
    im.encoding = TZ_ENCODING_DATA;
    if (s == TZ_OK)
        s = tz_image_write(ctx, path, &im, NULL);
    tz_image_deinit(&im);
    return s;
}

static void lengths_are_read(void **state)
{
    (void)state;
    char dir[64], path[96];
    tz_ctx *ctx = new_ctx(1);
    begin_dir(dir);
    for (int k = 0; k < 2; k++) {
        tz_vectors v;
        tz_element_field f;
        const tz_vec3 size = {640, 160, 0};
        snprintf(path, sizeof path, "%s/v.%s", dir, k ? "png" : "exr");
        ok(ctx, write_vectors(ctx, path, k == 0, false));
        ok(ctx, tz_vectors_read(ctx, path, size, false, &v));
        if (k == 0)
            assert_true(fabs(v.greatest - 8) < 0.1);
        for (int x = 10; x < 640; x += 30) {
            const double l = tz_vectors_at(&v, (tz_vec3){x, 80, 0});
            assert_true(fabs(l - fabs(x - 320.0) / 315) < 0.04);
        }
        ok(ctx, tz_element_field_init(ctx, size, false, 64, &f));
        ok(ctx, tz_element_field_read_image(&f, path, TZ_ELEMENT_FIELD_DIRECTION));
        ok(ctx, tz_vectors_say_sizes(&v, 0.5, 2, &f));
        ok(ctx, tz_element_field_settle(&f));
        for (int x = 50; x < 640; x += 60) {
            const tz_element_field_cell *c = tz_element_field_at(&f, (tz_vec3){x, 80, 0});
            assert_non_null(c);
            assert_true((double)c->x * (x - 320) > 0 && fabs((double)c->y) < 0.05);
            assert_true(fabs((double)c->size - (0.5 + 1.5 * fabs(x - 320.0) / 315)) <
                        0.1);
        }
        fails(ctx, tz_vectors_say_sizes(&v, 2, 1, &f), TZ_INVALID, "sizes");
        tz_element_field_deinit(&f);
        tz_vectors_deinit(&v);
    }
    tz_vectors v;
    snprintf(path, sizeof path, "%s/grey.png", dir);
    ok(ctx, write_vectors(ctx, path, false, true));
    fails(ctx, tz_vectors_read(ctx, path, (tz_vec3){64, 16, 0}, false, &v), TZ_INVALID,
          "angles");
    assert_null(v.length);
    fails(ctx, tz_vectors_read(ctx, "/nowhere.exr", (tz_vec3){64, 16, 0}, false, &v),
          TZ_IO, "nowhere");
    end_dir(dir);
    end_ctx(ctx);
}

static tz_status paint_once(tz_ctx *c)
{
    tz_element_set palette, layout = {0};
    tz_ramp r;
    double value[30] = {0};
    tz_status s = layout_of(c, &palette, &layout);
    for (int i = 0; i < 30; i++)
        value[i] = i / 29.0;
    if (s == TZ_OK)
        s = tz_ramp_parse(c, "viridis", &r);
    if (s == TZ_OK)
        s = tz_ramp_paint(&r, &layout, value);
    tz_element_set_deinit(&layout);
    tz_element_set_deinit(&palette);
    return s;
}

static void survives_want_of_memory(void **state)
{
    (void)state;
    survive(paint_once, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ramps_are_read),
        cmocka_unit_test(elements_are_coloured),
        cmocka_unit_test(lengths_are_read),
        cmocka_unit_test(survives_want_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
