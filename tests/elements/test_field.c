/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Fields: what strokes and drawings of them say, and where. */
#include "tests/base/check.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "elements/field.h"

static const tz_vec3 size = {100, 100, 0};
static const tz_element_field_stroke pen = {.radius = 3, .weight = 1, .directed = true};

static const tz_element_field_cell *said(const tz_element_field *f, double x, double y)
{
    return tz_element_field_at(f, (tz_vec3){x, y, 0});
}

static void strokes_speak_under_their_width(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_field f;
    const tz_element_field_point v[2] = {{{20, 50}, 1, -1}, {{80, 50}, 3, -1}};
    ok(ctx, tz_element_field_init(ctx, size, false, 200, &f));
    ok(ctx, tz_element_field_add(&f, pen, 2, v));
    ok(ctx, tz_element_field_settle(&f));
    for (double y = 0.25; y < 100; y += 0.5) {
        const tz_element_field_cell *c = said(&f, 50, y);
        if (fabs(y - 50) > 3.6)
            assert_null(c);
        else if (fabs(y - 50) < 2.4) {
            assert_non_null(c);
            assert_true(fabs((double)c->x - 1) < 1e-3 && fabs((double)c->y) < 1e-3);
            assert_true(fabs((double)c->size - 2) < 0.1); /* linear along it */
            assert_true(c->density < 0);
        }
    }
    assert_true((double)said(&f, 25, 50)->size < (double)said(&f, 75, 50)->size);
    tz_element_field_deinit(&f);
    end_ctx(ctx);
}

static void the_later_stroke_has_its_say(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_field f;
    const tz_element_field_point across[2] = {{{10, 50}, 0, -1}, {{90, 50}, 0, -1}};
    const tz_element_field_point down[2] = {{{50, 10}, 0, -1}, {{50, 90}, 0, -1}};
    ok(ctx, tz_element_field_init(ctx, size, false, 128, &f));
    ok(ctx, tz_element_field_add(&f, pen, 2, across));
    ok(ctx, tz_element_field_add(&f, pen, 2, down));
    ok(ctx, tz_element_field_settle(&f));
    assert_true((double)said(&f, 50, 50)->y > 0.99);
    tz_element_field_erase(&f, (tz_vec2){50, 80}, 1);
    ok(ctx, tz_element_field_settle(&f));
    assert_true((double)said(&f, 50, 50)->x > 0.99);
    assert_null(said(&f, 50, 80));
    tz_element_field_deinit(&f);
    end_ctx(ctx);
}

/* Squared distance of cells, over the nearest copy. */
static double apart2(int32_t a, int32_t b, int32_t n, bool torus)
{
    double x = abs(a % n - b % n), y = abs(a / n - b / n);
    if (torus)
        x = fmin(x, n - x), y = fmin(y, n - y);
    return x * x + y * y;
}

static void nearest_is_nearest(void **state)
{
    (void)state;
    enum { N = 40 };
    for (int torus = 0; torus < 2; torus++) {
        tz_ctx *ctx = new_ctx(1);
        tz_element_field f;
        const tz_element_field_stroke thin = {.radius = 0, .weight = 1, .directed = true};
        const tz_element_field_point v[3] = {
            {{5, 90}, 2, -1}, {{30, 70}, 2, -1}, {{35, 20}, 2, -1}};
        ok(ctx, tz_element_field_init(ctx, size, torus, N, &f));
        ok(ctx, tz_element_field_add(&f, thin, 3, v));
        ok(ctx, tz_element_field_settle(&f));
        for (int32_t i = 0; i < N * N; i++) {
            double least = HUGE_VAL;
            for (int32_t k = 0; k < N * N; k++)
                if (f.cell[k].x != 0 || f.cell[k].y != 0)
                    least = fmin(least, apart2(i, k, N, torus));
            const int32_t q = f.nearest[0][i];
            assert_true(q >= 0 && (f.cell[q].x != 0 || f.cell[q].y != 0));
            assert_true(apart2(i, q, N, torus) <= least + 1e-9);
            assert_int_equal(f.nearest[2][i], -1); /* nothing says densities */
        }
        tz_element_field_deinit(&f);
        end_ctx(ctx);
    }
}

static void presets_are_placed_again(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_field a, b;
    const tz_element_field_point v[2] = {{{10, 10}, 0, -1}, {{20, 10}, 0, -1}};
    ok(ctx, tz_element_field_init(ctx, size, false, 100, &a));
    ok(ctx, tz_element_field_init(ctx, size, false, 100, &b));
    ok(ctx, tz_element_field_add(&a, pen, 2, v));
    /* a quarter turn about 0, 0, then to 60, 40 */
    ok(ctx, tz_element_field_place(&b, &a,
                                   tz_affine_place((tz_vec2){0, 0}, (tz_vec2){60, 40},
                                                   TZ_PI / 2, 1, false)));
    ok(ctx, tz_element_field_settle(&b));
    assert_int_equal(b.stroke.n, 1);
    const tz_element_field_cell *c = said(&b, 50, 55);
    assert_non_null(c);
    assert_true(fabs((double)c->y) > 0.99);
    fails(ctx, tz_element_field_place(&b, &a, (tz_affine){0}), TZ_INVALID, "");
    tz_element_field_deinit(&a);
    tz_element_field_deinit(&b);
    end_ctx(ctx);
}

static void write_text(const char *path, const char *text)
{
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    assert_true(fputs(text, f) >= 0);
    assert_int_equal(fclose(f), 0);
}

static void drawings_are_read(void **state)
{
    (void)state;
    static const struct {
        const char *class, *message; /* NULL = it is good */
    } word[] = {{"size=1,3 density=0.5 weight=2", NULL},
                {"leafy", NULL},
                {"direction=no size=2", NULL},
                {"size=0", "size=0"},
                {"size=1,,2", "size=1,,2"},
                {"weight=-1", "weight=-1"},
                {"size=nan", "size=nan"},
                {"colour=3", "colour=3"},
                {"direction=maybe", "direction=maybe"}};
    char dir[64], path[128], text[512];
    begin_dir(dir);
    snprintf(path, sizeof path, "%s/strokes.svg", dir);
    for (size_t k = 0; k < sizeof word / sizeof *word; k++) {
        tz_ctx *ctx = new_ctx(1);
        tz_element_field f;
        snprintf(text, sizeof text,
                 "<svg xmlns=\"http://www.w3.org/2000/svg\" "
                 "xmlns:tz=\"https://terrazzo.example/ns/1\" viewBox=\"0 0 50 50\">"
                 "<path d=\"M5,25 L45,25\" fill=\"none\" stroke=\"#000\" "
                 "stroke-width=\"4\" tz:class=\"%s\"/></svg>",
                 word[k].class);
        write_text(path, text);
        if (word[k].message) {
            fails(ctx, tz_element_field_read(ctx, path, size, false, &f), TZ_INVALID,
                  word[k].message);
            end_ctx(ctx);
            continue;
        }
        ok(ctx, tz_element_field_read(ctx, path, size, false, &f));
        const tz_element_field_cell *c = said(&f, 50, 50); /* stretched over 100 */
        assert_non_null(c);
        assert_true(fabs((double)c->x) > 0.99 || strstr(word[k].class, "direction"));
        if (k == 0) {
            assert_true(fabs((double)c->size - 2) < 0.1);
            assert_true(fabs((double)c->density - 0.5) < 1e-6);
            assert_true(fabs((double)c->weight[0] - 2) < 1e-6);
        }
        tz_element_field_deinit(&f);
        end_ctx(ctx);
    }
    end_dir(dir);
}

static void odd_strokes(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_field f;
    tz_element_field_stroke s = pen;
    const tz_element_field_point dot[3] = {
        {{40, 40}, 0, -1}, {{40, 40}, 0, -1}, {{40, 40}, 0, -1}};
    const tz_element_field_point bad[1] = {{{NAN, 0}, 0, -1}};
    const tz_element_field_point far[2] = {{{-1e6, -1e6}, 0, -1}, {{1e6, 1e6}, 0, -1}};
    fails(ctx, tz_element_field_init(ctx, (tz_vec3){0, 1, 0}, false, 8, &f), TZ_INVALID,
          "");
    ok(ctx, tz_element_field_init(ctx, size, false, 64, &f));
    fails(ctx, tz_element_field_add(&f, pen, 0, dot), TZ_INVALID, "");
    fails(ctx, tz_element_field_add(&f, pen, 1, bad), TZ_INVALID, "");
    s.weight = -1;
    fails(ctx, tz_element_field_add(&f, s, 1, dot), TZ_INVALID, "");
    s.weight = 1, s.radius = -1;
    fails(ctx, tz_element_field_add(&f, s, 1, dot), TZ_INVALID, "");
    ok(ctx, tz_element_field_settle(&f)); /* says nothing */
    assert_null(said(&f, 40, 40));
    ok(ctx, tz_element_field_add(&f, pen, 3, dot)); /* of no length */
    ok(ctx, tz_element_field_add(&f, pen, 2, far)); /* through the domain */
    ok(ctx, tz_element_field_settle(&f));
    assert_true(fabs((double)said(&f, 70, 70)->x - sqrt(0.5)) < 0.01);
    tz_element_field_deinit(&f);
    end_ctx(ctx);
}

static tz_status make(tz_ctx *ctx)
{
    tz_element_field f;
    const tz_element_field_point v[2] = {{{10, 10}, 1, 1}, {{20, 10}, 2, 0}};
    tz_status s = tz_element_field_init(ctx, size, true, 24, &f);
    if (s == TZ_OK)
        s = tz_element_field_add(&f, pen, 2, v);
    if (s == TZ_OK)
        s = tz_element_field_settle(&f);
    tz_element_field_deinit(&f);
    return s;
}

static void survives_want_of_memory(void **state)
{
    (void)state;
    survive(make, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(strokes_speak_under_their_width),
        cmocka_unit_test(the_later_stroke_has_its_say),
        cmocka_unit_test(nearest_is_nearest),
        cmocka_unit_test(presets_are_placed_again),
        cmocka_unit_test(drawings_are_read),
        cmocka_unit_test(odd_strokes),
        cmocka_unit_test(survives_want_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
