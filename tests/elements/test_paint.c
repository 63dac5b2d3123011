/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Palettes as text, and strokes that are painted from a drawing. */
#include "tests/base/check.h"

#include <math.h>

#include "elements/element_arrange.h"
#include "elements/paint.h"
#include "elements/palette.h"
#include "tests/support/elements.h"

/* ---- palettes ---------------------------------------------------------------------- */

static void palettes_are_read(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set set;
    tz_palette p = {0};
    ok(ctx, drawn_set(ctx, 100, 100, false, 3, &set));
    char text[256];
    for (int32_t k = 0; k < 3; k++) {
        tz_free(ctx, set.kind.v[k].name);
        ok(ctx, tz_strdup(ctx, (const char *[]){"leaf", "stone", "bud"}[k],
                          &set.kind.v[k].name));
    }
    snprintf(text, sizeof text, " frame=0,0,50,100  scale=0.5 zone=1;; kinds=%s,%s ;",
             set.kind.v[0].name, set.kind.v[2].name);
    ok(ctx, tz_palette_parse(ctx, text, &set, &p));
    assert_int_equal(p.n, 2);
    assert_true(p.v[0].to.x == 50 && p.v[0].to.y == 100 && p.v[0].scale == 0.5);
    assert_int_equal(p.v[0].zone, 2);
    assert_true(p.v[0].kinds == 0 && p.v[1].kinds == 5);
    assert_true(p.v[1].to.x == p.v[1].from.x);
    tz_array_free(ctx, &p);
    ok(ctx, tz_palette_parse(ctx, "", &set, &p));
    assert_int_equal(p.n, 0);
    tz_element_set_deinit(&set);
    end_ctx(ctx);
}

static void bad_palettes_are_named(void **state)
{
    (void)state;
    static const char *const bad[] = {
        "frame=0,0,1", "frame=5,5,1,9", "frame=a,b,c,d", "scale=-1", "scale=x",
        "scale=1e9",   "zone=0",        "zone=1.5",      "zone=999", "kinds=nobody",
        "kinds=",      "leaf",          "colour=red",    "=",        "scale=",
    };
    tz_ctx *ctx = new_ctx(1);
    tz_element_set set;
    ok(ctx, drawn_set(ctx, 100, 100, false, 2, &set));
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        tz_palette p = {0};
        fails(ctx, tz_palette_parse(ctx, bad[i], &set, &p), TZ_INVALID, "textures");
        tz_array_free(ctx, &p);
    }
    tz_element_set_deinit(&set);
    end_ctx(ctx);
}

/* ---- strokes ----------------------------------------------------------------------- */

static const char strokes[] =
    "<svg xmlns='http://www.w3.org/2000/svg' xmlns:tz='"
    "https://terrazzo.example/ns/1"
    "' viewBox='0 0 100 100' fill='none'>"
    "<path stroke='black' stroke-width='20' d='M10 50L90 50'/>"
    "<path stroke='#ff0000' stroke-width='10' d='M50 10L50 90'/>"
    "<path stroke='black' tz:class='relax' stroke-width='10' d='M20 20L30 20'/></svg>";

static void write_file(const char *path, const char *text)
{
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    fputs(text, f);
    fclose(f);
}

static void strokes_are_read(void **state)
{
    (void)state;
    char path[] = "/tmp/terrazzo-paint-XXXXXX.svg";
    const int fd = mkstemps(path, 4);
    assert_true(fd >= 0);
    close(fd);
    tz_ctx *ctx = new_ctx(1);
    tz_paint p;
    write_file(path, strokes);
    ok(ctx, tz_paint_read(ctx, path, (tz_vec3){400, 400, 0}, 0, 1, &p));
    assert_int_equal(p.stroke.n, 3);
    assert_int_equal(p.stroke.v[0].tool, TZ_PAINT_GROW);
    assert_int_equal(p.stroke.v[1].tool, TZ_PAINT_ERASE);
    assert_int_equal(p.stroke.v[2].tool, TZ_PAINT_RELAX);
    assert_true(fabs(p.stroke.v[0].radius - 40) < 1e-9); /* half of 20, four times */
    const tz_vec2 first = p.point.v[p.stroke.v[0].point];
    const tz_vec2 last = p.point.v[p.stroke.v[0].point + p.stroke.v[0].points - 1];
    assert_true(fabs(first.x - 40) < 1e-9 && fabs(last.x - 360) < 1e-9);
    for (int32_t i = 1; i < p.stroke.v[0].points; i++)
        assert_true(p.point.v[i].x - p.point.v[i - 1].x <= 20 + 1e-9);
    tz_paint_deinit(&p);
    ok(ctx, tz_paint_read(ctx, path, (tz_vec3){400, 400, 0}, 7, 1, &p));
    assert_true(p.stroke.v[1].radius == 7);
    tz_paint_deinit(&p);
    fails(ctx, tz_paint_read(ctx, path, (tz_vec3){1e6, 1e6, 0}, 0.1, 1, &p), TZ_LIMIT,
          "brush");
    write_file(path, "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 9'/>");
    fails(ctx, tz_paint_read(ctx, path, (tz_vec3){400, 400, 0}, 0, 1, &p), TZ_INVALID,
          path);
    unlink(path);
    end_ctx(ctx);
}

/* Elements within `radius` of a stroke along y = 50 percent, and farther ones. */
static void count(const tz_element_set *s, double radius, int32_t *in, int32_t *out)
{
    *in = *out = 0;
    for (int32_t i = 0; i < s->element.n; i++)
        ++*(fabs(s->element.v[i].at.y - 200) <= radius ? in : out);
}

static void strokes_grow_and_erase(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set from, s;
    tz_element_arrange_params params;
    tz_element_arrange_report report;
    const tz_domain d = {.size = {400, 400, 0}};
    tz_vec2 along[41], across[41];
    tz_paint p = {.ctx = ctx};
    int32_t in, out;
    tz_params_default(&tz_element_arrange_param_table, &params);
    for (int i = 0; i <= 40; i++) {
        along[i] = (tz_vec2){10.0 * i, 200};
        across[i] = (tz_vec2){200, 10.0 * i};
    }
    for (int i = 0; i <= 40; i++)
        ok(ctx, tz_array_push(ctx, &p.point, along[i]));
    for (int i = 0; i <= 40; i++)
        ok(ctx, tz_array_push(ctx, &p.point, across[i]));
    ok(ctx, tz_array_push(ctx, &p.stroke, ((tz_paint_stroke){TZ_PAINT_GROW, 0, 41, 40})));
    ok(ctx, drawn_hexagons(ctx, 9, 9, 0.3, false, &from));
    ok(ctx, tz_element_set_like(ctx, &from, &d, &s));
    const tz_element_arrange_job job = {
        .exemplar = &from, .name = "hexagons", .params = &params, .seed = 3, .paint = &p};
    ok(ctx, tz_element_arrange(ctx, &job, &s, &report));
    count(&s, 46, &in, &out);
    /* one in 86.6 square units: 80 x 400 hold 369 */
    assert_true(in > 300 && in < 450);
    assert_int_equal(out, 0);
    p.stroke.v[0] = (tz_paint_stroke){TZ_PAINT_ERASE, 41, 41, 30};
    ok(ctx, tz_element_arrange(ctx, &job, &s, &report));
    int32_t left = 0;
    for (int32_t i = 0; i < s.element.n; i++)
        left += fabs(s.element.v[i].at.x - 200) < 29;
    assert_int_equal(left, 0);
    assert_true(s.element.n > in / 2 && s.element.n < in);
    /* strokes beyond the domain do nothing */
    for (int32_t i = 0; i < p.point.n; i++)
        p.point.v[i].x += 5000;
    const int32_t n = s.element.n;
    p.stroke.v[0] = (tz_paint_stroke){TZ_PAINT_GROW, 0, 41, 40};
    ok(ctx, tz_element_arrange(ctx, &job, &s, &report));
    assert_int_equal(s.element.n, n);
    tz_paint_deinit(&p);
    tz_element_set_deinit(&from);
    tz_element_set_deinit(&s);
    end_ctx(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(palettes_are_read),
        cmocka_unit_test(bad_palettes_are_named),
        cmocka_unit_test(strokes_are_read),
        cmocka_unit_test(strokes_grow_and_erase),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
