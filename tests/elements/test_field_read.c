/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Fields out of files: drawings as editors write them, words, images. */
#include "tests/base/check.h"

#include <math.h>

#include "elements/field.h"
#include "tests/elements/guides.h"

static const tz_vec3 size = {100, 100, 0};

#define HEAD                                      \
    "<svg xmlns='http://www.w3.org/2000/svg' "    \
    "xmlns:xlink='http://www.w3.org/1999/xlink' " \
    "xmlns:tz='https://terrazzo.example/ns/1' "   \
    "xmlns:inkscape='http://www.inkscape.org/namespaces/inkscape' "

static const char *drawing(const char *inside)
{
    static char text[16384];
    snprintf(text, sizeof text, HEAD "viewBox='0 0 100 100'>%s</svg>", inside);
    return guide_text("strokes.svg", text);
}

static const tz_element_field_cell *said(const tz_element_field *f, double x, double y)
{
    return tz_element_field_at(f, (tz_vec3){x, y, 0});
}

/* Something points that way there. */
static void points(const tz_element_field *f, double x, double y, double degrees)
{
    const tz_element_field_cell *c = said(f, x, y);
    if (!c || !(c->weight[0] > 0))
        fail_msg("nothing is said at %g, %g", x, y);
    const double off =
        remainder(atan2((double)c->y, (double)c->x) - degrees * TZ_PI / 180, 2 * TZ_PI);
    if (fabs(off) > 0.1)
        fail_msg("at %g, %g it is off by %g", x, y, off);
}

/* As Inkscape writes it: millimetres, layers with transforms, styles in attributes and in
 * CSS, clones, labels, hidden layers, a white page. */
static void editors_drawings_are_read(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_field f;
    const char *text = HEAD
        "width='200mm' height='200mm' viewBox='-50 -50 200 200' version='1.1'>"
        "<style>.pen{fill:none;stroke:#f00;stroke-width:4px}</style>"
        "<defs><path id='clone' style='fill:none;stroke:#000;stroke-width:2' d='M0 "
        "0H30'/>"
        "<marker id='m'><path d='M0 0V9' stroke='red'/></marker></defs>"
        "<rect x='-50' y='-50' width='200' height='200' style='fill:#fff'/>"
        "<g inkscape:groupmode='layer' inkscape:label='size=9' "
        "transform='translate(-50,-50) "
        "scale(2)'>"
        "<path class='pen' d='m 5,5 h 20' inkscape:label='size=2'/>"
        "<g transform='rotate(90 80 20)'><line class='pen' x1='70' y1='20' x2='90' "
        "y2='20'/>"
        "</g>"
        "<polyline class='pen' points='10,90 30,90 30,70'/>"
        "<use xlink:href='#clone' x='50' y='50' tz:class='density=0.25'/>"
        "<circle class='pen' cx='50' cy='75' r='8' tz:class='weight=3'/>"
        "<ellipse class='pen' cx='80' cy='75' rx='12' ry='6'/>"
        "<rect class='pen' x='45' y='10' width='12' height='20' tz:class='direction=no "
        "size=3'/>"
        "<path d='M5 40H40' style='stroke:#00f;stroke-width:0;fill:none'/>"
        "<path d='M5 44H40' style='stroke:#00f;fill:none;opacity:0'/></g>"
        "<g style='display:none'><path class='pen' d='M-50 60H150'/></g>"
        "<g visibility='hidden'><path class='pen' d='M-50 0H150'/></g></svg>";
    ok(ctx, tz_element_field_read(ctx, guide_text("a.svg", text), size, false, &f));
    points(&f, 15, 5, 0);
    assert_true(fabs((double)said(&f, 15, 5)->size - 2) < 1e-5); /* by its label */
    points(&f, 80, 20, 90);
    points(&f, 20, 90, 0);
    points(&f, 30, 80, -90);
    points(&f, 65, 50, 0);
    assert_true(fabs((double)said(&f, 65, 50)->density - 0.25) < 1e-6);
    points(&f, 58, 75, 90); /* circles run clockwise, from the right */
    points(&f, 50, 83, 180);
    assert_true(said(&f, 58, 75)->weight[0] == 3);
    points(&f, 80, 69, 0);
    assert_true(said(&f, 57, 20)->weight[0] == 0);
    assert_true(fabs((double)said(&f, 57, 20)->size - 3) < 1e-5);
    /* pens of width 0 are not seen; nor what is clear, hidden, a marker, the page */
    assert_null(said(&f, 20, 40));
    assert_null(said(&f, 20, 44));
    assert_null(said(&f, 20, 55));
    assert_null(said(&f, 20, 25));
    assert_null(said(&f, 0.2, 60));
    tz_element_field_deinit(&f);
    end_ctx(ctx);
}

/* The pen's width goes along with all transforms and with the view. */
static void widths_are_scaled(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    for (int k = 0; k < 3; k++) {
        static const char *const as[] = {
            "<path d='M10 50H90' fill='none' stroke='red' stroke-width='10'/>",
            "<g transform='scale(.1)'><path d='M100 500H900' fill='none' stroke='red' "
            "stroke-width='100'/></g>",
            "<svg x='0' y='0' width='100' height='100' viewBox='0 0 50 50'><path d='M5 "
            "25H45' fill='none' stroke='red' stroke-width='5'/></svg>"};
        tz_element_field f;
        ok(ctx, tz_element_field_read(ctx, drawing(as[k]), size, false, &f));
        assert_non_null(said(&f, 50, 54.5));
        assert_null(said(&f, 50, 56));
        tz_element_field_deinit(&f);
    }
    end_ctx(ctx);
}

/* Groups say what their strokes do not say themselves. */
static void words_of_groups(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_field f;
    ok(ctx, tz_element_field_read(
                ctx,
                drawing("<g tz:class='size=2 weight=5'>"
                        "<path d='M10 20H90' stroke='red' stroke-width='4'/>"
                        "<path d='M10 50H90' stroke='red' stroke-width='4' "
                        "tz:class='size=0.5'/>"
                        "<g tz:class='density=0.5'><path d='M10 80H90' stroke='red' "
                        "stroke-width='4' tz:class='direction=yes'/></g></g>"),
                size, false, &f));
    assert_true(said(&f, 50, 20)->size == 2 && said(&f, 50, 20)->weight[1] == 5);
    assert_true(said(&f, 50, 50)->size == 0.5F && said(&f, 50, 50)->weight[1] == 5);
    assert_true(said(&f, 50, 80)->density == 0.5F && said(&f, 50, 80)->weight[1] == 0);
    tz_element_field_deinit(&f);
    end_ctx(ctx);
}

/* Numbers out of range are told with the file, the line and the path; nothing is clamped. */
static void words_out_of_range(void **state)
{
    (void)state;
    static const char *const word[] = {"density=1.5",     "density=-0.1", "density=0,2",
                                       "size=-1",         "size=1e9",     "weight=0",
                                       "weight=1e9",      "density=",     "density=0.5,",
                                       "direction=maybe", "size=1;2"};
    tz_ctx *ctx = new_ctx(1);
    for (size_t k = 0; k < sizeof word / sizeof *word; k++) {
        char text[512], want[128];
        tz_element_field f;
        snprintf(text, sizeof text,
                 "\n<path id='path83' d='M10 50H90' stroke='red' tz:class='%s'/>",
                 word[k]);
        snprintf(want, sizeof want, "strokes.svg:2: path \"path83\" says \"%s\"",
                 word[k]);
        fails(ctx, tz_element_field_read(ctx, drawing(text), size, false, &f), TZ_INVALID,
              want);
        assert_null(f.cell);
        snprintf(text, sizeof text,
                 "<path d='M10 50H90' stroke='red' inkscape:label='%s'/>", word[k]);
        fails(ctx, tz_element_field_read(ctx, drawing(text), size, false, &f), TZ_INVALID,
              "a stroke says");
    }
    /* what is none of ours is a label like any other */
    tz_element_field f;
    ok(ctx, tz_element_field_read(
                ctx, drawing("<path d='M10 50H90' stroke='red' inkscape:label='a=b c'/>"),
                size, false, &f));
    tz_element_field_deinit(&f);
    end_ctx(ctx);
}

/* A stroke that says sizes alone leaves directions beneath it as heavy as they were. */
static void later_strokes_overrule_what_they_say(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_field f;
    ok(ctx, tz_element_field_read(
                ctx,
                drawing("<path d='M10 50H90' stroke='red' stroke-width='8' "
                        "tz:class='weight=5 size=2'/>"
                        "<path d='M30 10V90' stroke='red' stroke-width='8' "
                        "tz:class='direction=no density=0.5'/>"
                        "<path d='M70 90V10' stroke='red' stroke-width='8'/>"),
                size, false, &f));
    const tz_element_field_cell *c = said(&f, 30, 50);
    assert_true(c->x > 0.99F && c->weight[0] == 5 && c->size == 2 && c->weight[1] == 5);
    assert_true(c->density == 0.5F && c->weight[2] == 1);
    c = said(&f, 70, 50);
    assert_true(c->y < -0.99F && c->weight[0] == 1 && c->size == 2 && c->weight[1] == 5);
    tz_element_field_deinit(&f);
    end_ctx(ctx);
}

static void nothing_in_view(void **state)
{
    (void)state;
    static const char *const none[] = {"",
                                       "<path d='M200 50h50' stroke='red'/>",
                                       "<path d='M50 50h0' stroke='red'/>",
                                       "<rect width='100' height='100'/>",
                                       "<text>size=2</text>",
                                       "<path d='M10 10H90' stroke='none' fill='none'/>"};
    tz_ctx *ctx = new_ctx(1);
    for (size_t k = 0; k < sizeof none / sizeof *none; k++) {
        tz_element_field f;
        fails(ctx, tz_element_field_read(ctx, drawing(none[k]), size, false, &f),
              TZ_INVALID, "strokes.svg: there are no strokes in view");
    }
    end_ctx(ctx);
}

/* 10^6 strokes: each cell has what the last one over it says. */
static void a_million_strokes(void **state)
{
    (void)state;
    enum { N = 1000000 };
    tz_ctx *ctx = new_ctx(1);
    tz_element_field f;
    const tz_element_field_stroke pen = {.radius = 0.5, .weight = 1, .directed = true};
    ok(ctx, tz_element_field_init(ctx, size, false, 100, &f));
    for (int32_t i = 0; i < N; i++) {
        const double x = i % 1000 * 0.1, y = (double)(i / 1000) * 0.1;
        const tz_element_field_point v[2] = {{{x, y}, 0, -1}, {{x + 0.5, y}, 0, -1}};
        ok(ctx, tz_element_field_add(&f, pen, 2, v));
    }
    const tz_element_field_point last[2] = {{{50, 90}, 0, -1}, {{50, 10}, 0, -1}};
    ok(ctx, tz_element_field_add(&f, pen, 2, last));
    ok(ctx, tz_element_field_settle(&f));
    points(&f, 20.5, 50.5, 0);
    points(&f, 50.2, 50.5, -90);
    tz_element_field_deinit(&f);
    end_ctx(ctx);
}

/* ---- images ------------------------------------------------------------------------- */

static float ramp(int32_t x, int32_t y, int32_t c)
{
    (void)y, (void)c;
    return (float)x / 255;
}

static float black(int32_t x, int32_t y, int32_t c)
{
    (void)x, (void)y, (void)c;
    return 0;
}

/* Half of each image says something; the other is clear. */
static float half_clear(int32_t x, int32_t y, int32_t c)
{
    (void)y;
    return c == 3 ? (x < 32 ? 1.0F : 0.0F) : c == 1 ? 1.0F : 0.5F;
}

static void images_lie_beneath_strokes(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_field f;
    ok(ctx, tz_element_field_init(ctx, size, false, 64, &f));
    ok(ctx, tz_element_field_read_image(&f, guide_image(ctx, 64, 8, 4, half_clear),
                                        TZ_ELEMENT_FIELD_DIRECTION));
    ok(ctx, tz_element_field_read_image(&f, guide_image(ctx, 256, 1, 1, ramp),
                                        TZ_ELEMENT_FIELD_SIZE));
    ok(ctx, tz_element_field_read_image(&f, guide_image(ctx, 256, 700, 1, ramp),
                                        TZ_ELEMENT_FIELD_DENSITY));
    ok(ctx, tz_element_field_read_strokes(
                &f, drawing("<path d='M90 20H10' stroke='red' stroke-width='6'/>")));
    ok(ctx, tz_element_field_settle(&f));
    points(&f, 25, 60, 90); /* green points down */
    assert_true(said(&f, 75, 60)->weight[0] == 0);
    points(&f, 25, 20, 180);
    for (double x = 3; x < 100; x += 7) { /* means of pixels, not some of them */
        const double v = x / 100 * 256 / 255;
        assert_true(fabs((double)said(&f, x, 60)->size - 2 * v) < 0.04);
        assert_true(fabs((double)said(&f, x, 60)->density - v) < 0.02);
    }
    fails(ctx,
          tz_element_field_read_image(&f, guide_image(ctx, 9, 9, 1, black),
                                      TZ_ELEMENT_FIELD_SIZE),
          TZ_INVALID, "guide.png: it says no size");
    tz_element_field_deinit(&f);
    end_ctx(ctx);
}

static tz_status read_all(tz_ctx *ctx)
{
    tz_element_field f;
    const tz_status s = tz_element_field_read(ctx, guide_path, size, true, &f);
    assert_true((s == TZ_OK) == (f.cell != NULL));
    tz_element_field_deinit(&f);
    return s;
}

static void survives_want_of_memory(void **state)
{
    (void)state;
    drawing("<g tz:class='weight=2'><path d='M0 0L60 90' stroke='red' tz:class='size=1,2 "
            "density=0.5,1,0'/></g>");
    survive(read_all, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(editors_drawings_are_read),
        cmocka_unit_test(widths_are_scaled),
        cmocka_unit_test(words_of_groups),
        cmocka_unit_test(words_out_of_range),
        cmocka_unit_test(later_strokes_overrule_what_they_say),
        cmocka_unit_test(nothing_in_view),
        cmocka_unit_test(a_million_strokes),
        cmocka_unit_test(images_lie_beneath_strokes),
        cmocka_unit_test(survives_want_of_memory),
    };
    return cmocka_run_group_tests(tests, guide_begin, guide_end);
}
