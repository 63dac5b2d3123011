/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Elements out of the SVG of others. */
#include "tests/elements/svg_reading.h"

static void at(int32_t i, double x, double y, double radius)
{
    const tz_element *e = &set.element.v[i];
    if (fabs(e->at.x - x) > 1e-3 || fabs(e->at.y - y) > 1e-3 ||
        fabs(e->radius - radius) > 2e-3 * radius)
        fail_msg("element %d at %.9g, %.9g radius %.9g", i, e->at.x, e->at.y, e->radius);
}

/* ---- shapes -------------------------------------------------------------------------- */

static void shapes_have_circles(void **state)
{
    (void)state;
    READ("<circle cx='20' cy='30' r='5'/><ellipse cx='50' cy='50' rx='8' ry='2'/>"
         "<rect x='10' y='60' width='6' height='8'/>"
         "<rect x='30' y='60' width='6' height='6' rx='3'/>"
         "<polygon points='70,10 80,10 70,20'/>"
         "<polyline points='70,40 80,40 70,50' stroke='none'/>"
         "<path d='M80 80h10v10h-10z'/><line x1='10' y1='90' x2='20' y2='90' "
         "stroke='red' stroke-width='2'/>",
         8);
    at(0, 20, 30, 5);
    at(1, 50, 50, 8);
    at(2, 13, 64, 5);
    at(3, 33, 63, 3);
    at(4, 75, 15, sqrt(50));
    at(5, 75, 45, sqrt(50));
    at(6, 85, 85, sqrt(50));
    at(7, 15, 90, hypot(5, 1));
    for (int i = 0; i < 8; i++)
        assert_int_equal(set.element.v[i].depth, i);
    assert_true(set.domain.size.x == 100 && !set.domain.torus && !set.background);
}

static void nothing_that_does_not_show(void **state)
{
    (void)state;
    READ("<circle cx='20' cy='30' r='5'/><circle cx='20' cy='30' r='0'/>"
         "<rect x='1' y='1' width='0' height='5'/><path d='M5 5'/><path d='M5 5z'/>"
         "<path d='M5 5L9 9'/><path/><polygon/><polygon points='1,1'/>"
         "<circle cx='9' cy='9' r='4' fill='none'/>"
         "<circle cx='9' cy='9' r='4' style='display:none'/>"
         "<g display='none'><circle cx='9' cy='9' r='4'/></g>"
         "<circle cx='9' cy='9' r='4' visibility='hidden'/>"
         "<circle cx='9' cy='9' r='4' opacity='0'/>"
         "<defs><circle cx='9' cy='9' r='4'/></defs>"
         "<clipPath><circle cx='9' cy='9' r='4'/></clipPath>"
         "<mask><circle cx='9' cy='9' r='4'/></mask>"
         "<symbol id='u'><circle cx='9' cy='9' r='4'/></symbol>"
         "<use xlink:href='#u' transform='scale(0)'/><use/>",
         1);
}

static void maps_nest(void **state)
{
    (void)state;
    READ("<g transform='translate(10 20)'><g transform='scale(2)'>"
         "<rect x='1' y='1' width='6' height='8'/></g></g>"
         "<svg x='50' y='50' width='40' height='40' viewBox='0 0 10 10'>"
         "<circle cx='5' cy='5' r='1'/></svg>",
         2);
    at(0, 18, 30, 10);
    at(1, 70, 70, 4);
}

static void units_and_views(void **state)
{
    (void)state;
    const char *two =
        "<svg xmlns='http://www.w3.org/2000/svg' width='2in' height='144pt'>"
        "<circle cx='1in' cy='72pt' r='25.4mm'/>"
        "<circle cx='6pc' cy='2.54cm' r='5%'/></svg>";
    read_as(two, NULL, 2);
    near(set.domain.size.x, 192, 1e-9);
    near(set.domain.size.y, 192, 1e-9);
    at(0, 96, 96, 96);
    at(1, 96, 96, 9.6);
    read_as("<svg viewBox='-50 100 200 300'><circle cx='0' cy='200' r='5'/></svg>", NULL,
            1);
    at(0, 50, 100, 5);
    assert_true(set.domain.size.y == 300);
}

static const char *markup(int32_t i)
{
    return set.symbol.v[set.element.v[i].symbol].markup;
}

static void has(int32_t i, const char *part)
{
    if (!strstr(markup(i), part))
        fail_msg("'%s' is not in %s", part, markup(i));
}

static void styles_cascade(void **state)
{
    (void)state;
    READ("<style>/* a */ .c1, rect { fill: #123456 } #one{fill:rgb(255,0,128)}"
         " circle { fill: red; stroke: blue; stroke-width: 2px } g > circle {fill:lime}"
         " @media print { }</style>"
         "<circle cx='20' cy='20' r='4' fill='green'/>"
         "<circle cx='40' cy='20' r='4' class='x c1' stroke='none'/>"
         "<circle cx='60' cy='20' r='4' id='one'/>"
         "<circle cx='80' cy='20' r='4' id='two' class='c1' "
         "style='fill : #FfA; stroke:none'/>"
         "<rect x='10' y='50' width='5' height='5'/>"
         "<g fill='navy' fill-opacity='.5'><path d='M40 50h5v5z'/></g>"
         "<g color='teal'><path d='M60 50h5v6z' fill='currentColor' opacity='.5'/></g>",
         7);
    has(0, "fill=\"#ff0000\"");
    has(0, "stroke=\"#0000ff\" stroke-width=\"2\"");
    has(1, "#123456");
    has(1, "stroke=\"#0000ff\""); /* rules go before presentation attributes */
    has(2, "#ff0080");
    has(3, "#ffffaa");
    assert_null(strstr(markup(3), "stroke"));
    has(4, "#123456");
    has(5, "#000080");
    has(5, "fill-opacity=\"0.502\"");
    has(6, "#008080");
}

static void gradients_become_their_mean(void **state)
{
    (void)state;
    READ("<linearGradient id='a'><stop stop-color='#000'/><stop style='stop-color:#fff'/>"
         "</linearGradient><linearGradient id='b' xlink:href='#a'/>"
         "<circle cx='20' cy='20' r='4' fill='url(#b)'/>"
         "<circle cx='20' cy='20' r='4' fill='url(#no) #abc'/>",
         2);
    has(0, "#808080");
    has(1, "#aabbcc");
}

/* ---- what is one element ------------------------------------------------------------- */

static void subpaths_part_and_nest(void **state)
{
    (void)state;
    READ("<path fill-rule='evenodd' d='M10 10h20v20h-20z M15 15h5v5h-5z "
         "M50 10h20v20h-20z m40 60h5v5h-5z'/>",
         3);
    at(0, 20, 20, sqrt(200));
    assert_int_equal(set.symbol.v[set.element.v[0].symbol].part.n, 2);
    has(0, "evenodd");
    at(2, 92.5, 72.5, sqrt(12.5));
    READ("<path fill='none' stroke='red' d='M10 10L20 20M10 20L20 10M50 50L60 60'/>", 2);
}

static void touching_parts_of_a_group_are_one(void **state)
{
    (void)state;
    /* a face, and a stick on a leaf */
    READ("<g><circle cx='20' cy='20' r='9'/><circle cx='17' cy='17' r='1' fill='red'/>"
         "<circle cx='23' cy='17' r='1' fill='red'/></g>"
         "<g><rect x='60' y='60' width='2' height='10'/>"
         "<rect x='56' y='50' width='10' height='10' fill='green'/></g>",
         2);
    at(0, 20, 20, 9);
    assert_int_equal(set.symbol.v[0].part.n, 3);
    READ("<g><circle cx='20' cy='20' r='4'/><circle cx='35' cy='20' r='4'/>"
         "<circle cx='20' cy='35' r='4'/></g>",
         3);
    /* a layer joins nothing; outside groups nothing is joined */
    READ("<g><circle cx='10' cy='10' r='9'/><circle cx='20' cy='20' r='9'/>"
         "<circle cx='90' cy='90' r='9'/></g><circle cx='60' cy='10' r='9'/>"
         "<circle cx='62' cy='10' r='9'/>",
         5);
    /* corner to corner is no touch */
    READ("<g><path d='M10 10l5-5 5 5-5 5z'/><path d='M20 10l5-5 5 5-5 5z'/></g>", 2);
}

static void marked_groups_are_one(void **state)
{
    (void)state;
    READ("<g tz:element='1' tz:class='pair' transform='translate(5 0)'>"
         "<circle cx='20' cy='20' r='2'/><circle cx='40' cy='20' r='2'/></g>",
         1);
    at(0, 35, 20, 12);
    assert_string_equal(set.kind.v[set.element.v[0].kind].name, "pair");
}

static void units_side_by_side(void **state)
{
    (void)state;
    READ("<g><rect x='5' y='5' width='4' height='4'/>"
         "<rect x='10' y='5' width='4' height='4'/></g>"
         "<g><rect x='45' y='5' width='4' height='4'/>"
         "<rect x='50' y='5' width='4' height='4'/></g>"
         "<g><rect x='5' y='55' width='4' height='4'/>"
         "<rect x='10' y='55' width='4' height='4'/></g>",
         3);
}

static void backgrounds_are_none(void **state)
{
    (void)state;
    READ("<rect width='100%' height='100%' fill='#eee'/><circle cx='9' cy='9' r='2'/>"
         "<path d='M5 5h3' stroke='red' stroke-width='1e6'/>",
         1);
    assert_non_null(strstr(set.background, "#eeeeee"));
    assert_non_null(strstr(set.background, "#ff0000"));
}

/* ---- symbols ------------------------------------------------------------------------- */

static void uses_keep_their_frame(void **state)
{
    (void)state;
    READ("<symbol id='leaf'><path d='M0 0L10 0L10 4L0 4Z'/></symbol>"
         "<use xlink:href='#leaf' x='20' y='30'/>"
         "<use href='#leaf' transform='translate(50 50) rotate(90) scale(2)'/>"
         "<use xlink:href='#leaf' transform='translate(50 50) scale(-1 1)'/>"
         "<use xlink:href='#leaf' fill='red' x='70' y='70'/>",
         4);
    const tz_element *e = set.element.v;
    at(0, 25, 32, hypot(5, 2));
    at(1, 46, 60, 2 * hypot(5, 2));
    at(2, 45, 52, hypot(5, 2));
    assert_true(e[0].angle == 0 && e[0].scale == 1);
    near(e[1].angle, TZ_PI / 2, 1e-12);
    near(e[1].scale, 2, 1e-12);
    assert_int_equal(e[0].symbol, e[1].symbol);
    assert_true(e[2].symbol != e[0].symbol && e[3].symbol != e[0].symbol);
    assert_string_equal(set.symbol.v[0].id, "leaf");
    for (int i = 0; i < 4; i++)
        assert_string_equal(set.kind.v[e[i].kind].name, "leaf");
    READ("<circle id='c' cx='5' cy='5' r='3' tz:class='dot'/>"
         "<use xlink:href='#c' x='20' tz:class='other'/>"
         "<symbol id='v' viewBox='0 0 10 10'><circle cx='5' cy='5' r='5'/></symbol>"
         "<use xlink:href='#v' x='50' y='50' width='20' height='20'/>",
         3);
    at(1, 25, 5, 3);
    at(2, 60, 60, 10);
    assert_string_equal(set.kind.v[set.element.v[1].kind].name, "other");
}

static void equal_shapes_share_a_symbol(void **state)
{
    (void)state;
    /* the second is the first turned by 90 degrees, twice as large; the third mirrored */
    READ("<path d='M10 10L16 10L10 13Z'/><path d='M50 50L50 62L44 50Z'/>"
         "<path d='M70 10L64 10L70 13Z'/><circle cx='80' cy='80' r='4'/>"
         "<circle cx='20' cy='80' r='8'/>",
         5);
    const tz_element *e = set.element.v;
    assert_int_equal(e[0].symbol, e[1].symbol);
    assert_true(e[2].symbol != e[0].symbol);
    assert_int_equal(e[3].symbol, e[4].symbol);
    near(e[1].scale / e[0].scale, 2, 1e-9);
    const double turn = e[1].angle - e[0].angle;
    near(turn - floor(turn / (2 * TZ_PI)) * 2 * TZ_PI, TZ_PI / 2, 1e-9);
    near(e[1].radius, 2 * e[0].radius, 1e-9);
    at(4, 20, 80, 8);
    /* pens that do not scale along part them */
    READ("<circle cx='20' cy='20' r='4' stroke='red'/>"
         "<circle cx='60' cy='60' r='8' stroke='red'/>"
         "<circle cx='60' cy='20' r='8' stroke='red' stroke-width='2'/>",
         3);
    e = set.element.v;
    assert_true(e[0].symbol == e[2].symbol && e[0].symbol != e[1].symbol);
    at(0, 20, 20, 4.5);
}

/* ---- border -------------------------------------------------------------------------- */

static void the_border_cuts(void **state)
{
    (void)state;
    READ("<circle cx='2' cy='50' r='5'/><circle cx='50' cy='50' r='5'/>"
         "<path d='M100 10L90 15L100 20Z' fill='red'/>",
         3);
    assert_true(set.element.v[0].cut && !set.element.v[1].cut && set.element.v[2].cut);
    /* tiles that end on the border are whole: they have their like inside */
    READ("<rect x='0' y='0' width='10' height='5'/>"
         "<rect x='20' y='20' width='10' height='5'/>",
         2);
    assert_false(set.element.v[0].cut);
}

static void tiles_wrap(void **state)
{
    (void)state;
    const tz_element_read_options wrap = {.wrap = true}, find = {.wrap_auto = true};
    /* twins, in a corner even four */
    const char *twins =
        HEAD "<circle cx='-1' cy='50' r='5'/><circle cx='99' cy='50' r='5'/>"
             "<circle cx='0' cy='0' r='5'/><circle cx='100' cy='0' r='5'/>"
             "<circle cx='0' cy='100' r='5'/>"
             "<circle cx='100' cy='100' r='5'/>"
             "<circle cx='50' cy='50' r='5'/>" TAIL;
    for (int k = 0; k < 2; k++) {
        read_as(twins, k ? &find : &wrap, 3);
        assert_true(set.domain.torus);
        at(0, 99, 50, 5);
        at(1, 0, 0, 5);
        for (int i = 0; i < 3; i++)
            assert_false(set.element.v[i].cut);
    }
    read_as(twins, NULL, 7);
    assert_false(set.domain.torus);
    /* pieces */
    const char *pieces =
        HEAD "<path d='M0 40L0 60L10 50Z'/><path d='M100 40L100 60L90 50Z'/>"
             "<path d='M40 0L60 0L50 10Z' fill='red'/>"
             "<path d='M40 100L60 100L50 90Z' fill='red'/>" TAIL;
    for (int k = 0; k < 2; k++) {
        read_as(pieces, k ? &find : &wrap, 2);
        assert_true(set.domain.torus && !set.element.v[0].cut && !set.element.v[1].cut);
        at(0, 0, 50, 10);
        at(1, 50, 0, 10);
        assert_int_equal(set.symbol.v[0].part.n, 2);
    }
    /* pieces of other colours, and drawings that are no tiles, do not join */
    read_as(HEAD "<path d='M0 40L0 60L10 50Z'/>"
                 "<path d='M100 40L100 60L90 50Z' fill='red'/>" TAIL,
            &find, 2);
    assert_true(!set.domain.torus && set.element.v[0].cut);
}

static void patterns_are_tiles(void **state)
{
    (void)state;
    const tz_element_read_options find = {.wrap_auto = true};
    read_as(HEAD "<pattern id='p' width='20' height='10' patternUnits='userSpaceOnUse'>"
                 "<circle cx='0' cy='5' r='2'/><circle cx='20' cy='5' r='2'/>"
                 "<rect x='9' y='4' width='2' height='2' fill='red'/></pattern>"
                 "<rect width='100' height='100' fill='url(#p)'/>" TAIL,
            &find, 2);
    assert_true(set.domain.torus && set.domain.size.x == 20 && set.domain.size.y == 10);
    /* a drawing that repeats */
    char text[8000] = HEAD;
    for (int i = 0; i < 36; i++)
        sprintf(text + strlen(text),
                "<path d='M%d %dh3v2z'/><circle cx='%d' cy='%d' r='1'/>",
                (i % 2) * 50 + i % 3 * 11 + 5, i / 18 * 50 + i / 3 % 3 * 13 + 5,
                (i % 2) * 50 + i % 3 * 11 + 9, i / 18 * 50 + i / 3 % 3 * 13 + 9);
    strcat(text, TAIL);
    read_as(text, &find, 72);
    assert_true(set.domain.torus);
}

/* ---- classes and samples --------------------------------------------------------------- */

static void classes_by_look(void **state)
{
    (void)state;
    const char *text = HEAD "<circle cx='10' cy='10' r='4' fill='red'/>"
                            "<circle cx='30' cy='10' r='5' fill='#f00800'/>"
                            "<circle cx='50' cy='10' r='4' fill='blue'/>"
                            "<rect x='10' y='50' width='30' height='3' fill='red'/>" TAIL;
    read_as(text, NULL, 4);
    const tz_element *e = set.element.v;
    assert_int_equal(set.kind.n, 3);
    assert_int_equal(e[0].kind, e[1].kind);
    assert_true(e[2].kind != e[0].kind && e[3].kind != e[0].kind);
    assert_true(!set.kind.v[e[0].kind].oriented && set.kind.v[e[3].kind].oriented);
    read_as(text, &(tz_element_read_options){.classes = 2}, 4);
    assert_int_equal(set.kind.n, 2);
    read_as(text, &(tz_element_read_options){.classes = 1}, 4);
    assert_int_equal(set.kind.n, 1);
}

static void long_things_have_samples(void **state)
{
    (void)state;
    READ("<rect x='10' y='10' width='40' height='4' fill='red'/>"
         "<circle cx='70' cy='70' r='9'/><rect x='80' y='10' width='8' height='8'/>"
         "<path d='M10 60A15 15 0 0 1 40 60L36 60A11 11 0 0 0 14 60Z' fill='blue'/>"
         "<path d='M60 20h8v-8h2v8h8v2h-8v8h-2v-8h-8z' fill='lime'/>"
         "<path d='M10 90L50 90' stroke='red' fill='none'/>",
         6);
    const tz_element *e = set.element.v;
    assert_true(e[0].samples >= 4);
    double weight = 0, x = 0;
    for (int i = 0; i < e[0].samples; i++) {
        const tz_sample *p = &set.sample.v[e[0].sample + i];
        near(p->at.y, 12, 0.7);
        assert_true(p->at.x > 10 && p->at.x < 50);
        assert_int_equal(p->id, i);
        weight += p->weight;
        x += p->at.x / e[0].samples;
    }
    near(weight, 1, 1e-12);
    near(x, 30, 1);
    assert_int_equal(e[1].samples, 1);
    assert_int_equal(e[2].samples, 1);
    assert_memory_equal(&set.sample.v[e[1].sample].at, &e[1].at, sizeof e[1].at);
    assert_true(e[3].samples >= 4); /* bent: along the arc of radius 13 about 25, 60 */
    for (int i = 0; i < e[3].samples; i++) {
        const tz_vec3 p = set.sample.v[e[3].sample + i].at;
        near(hypot(p.x - 25, p.y - 60), 13, 1.2);
    }
    assert_int_equal(e[4].samples, 1); /* a cross has no middle line */
    assert_true(e[5].samples > 3);
}

/* ---- what cannot be read ----------------------------------------------------------------- */

static void bad_input_is_named(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        tz_status status;
        const char *part;
    } bad[] = {
        {"", TZ_FORMAT, "t.svg: the file is empty"},
        {"<svg", TZ_FORMAT, "t.svg:1:"},
        {"<html/>", TZ_FORMAT, "not svg"},
        {"<svg/>", TZ_FORMAT, "no size"},
        {"<svg width='100%' height='100%'/>", TZ_FORMAT, "no size"},
        {"<svg viewBox='0 0 0 5'/>", TZ_FORMAT, "no size"},
        {"<svg viewBox='0 0 nan 5'/>", TZ_FORMAT, "no size"},
        {"<svg viewBox='0 0 1e20 5'/>", TZ_FORMAT, "scale the drawing"},
        {HEAD TAIL, TZ_INVALID, "no elements"},
        {HEAD "<rect width='100' height='100'/>" TAIL, TZ_INVALID, "no elements"},
        {HEAD "\n<circle r='nan'/>" TAIL, TZ_FORMAT, "t.svg:2: r=\"nan\""},
        {HEAD "\n<circle r='-1'/>" TAIL, TZ_FORMAT, "t.svg:2: a radius"},
        {HEAD "<rect width='-1' height='2'/>" TAIL, TZ_FORMAT, "below 0"},
        {HEAD "<rect width='5 apples' height='2'/>" TAIL, TZ_FORMAT, "apples"},
        {HEAD "<circle r='1e300'/>" TAIL, TZ_FORMAT, "beyond any drawing"},
        {HEAD "<path d='M0 0L1'/>" TAIL, TZ_FORMAT, "path data"},
        {HEAD "<polygon points='0,0 1,x 5,5'/>" TAIL, TZ_FORMAT, "points="},
        {HEAD "<g transform='scale(x)'/>" TAIL, TZ_FORMAT, "transform="},
        {HEAD "<g transform='scale(1e300)'><g transform='scale(1e300)'/></g>" TAIL,
         TZ_FORMAT, "transform="},
        {HEAD "<path stroke-width='thick' d='M0 0h1'/>" TAIL, TZ_FORMAT, "stroke-width"},
        {HEAD "<path style='opacity:many' d='M0 0h1'/>" TAIL, TZ_FORMAT, "style"},
        {HEAD "<use href='#no'/>" TAIL, TZ_FORMAT, "there is no \"no\""},
        {HEAD "<use href='b.svg#no'/>" TAIL, TZ_FORMAT, "another file"},
        {HEAD "<g id='a'><use href='#a'/></g>" TAIL, TZ_FORMAT, "inside itself"},
        {HEAD "<pattern id='p'/><rect width='100' height='100' fill='url(#p)'/>" TAIL,
         TZ_FORMAT, "pattern has no size"},
        {"<svg viewBox='0 0 9 9' xmlns:tz='https://terrazzo.example/ns/1' "
         "tz:document='exemplar'/>",
         TZ_FORMAT, "exemplar of a photo"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        fails(ctx, parse(bad[i].text, NULL), bad[i].status, bad[i].part);
        assert_null(set.element.v);
    }
    fails(ctx, tz_element_read_svg(ctx, "/nowhere/x.svg", NULL, &set), TZ_IO, "x.svg");
}

static void all_at_one_place(void **state)
{
    (void)state;
    const tz_element_read_options find = {.wrap_auto = true};
    char *text = calloc(1, 200000);
    strcpy(text, HEAD);
    for (int i = 0, n = (int)strlen(text); i < 3000; i++)
        n += sprintf(text + n, "<circle cx='50' cy='50' r='3'/>");
    strcat(text, TAIL);
    read_as(text, &find, 3000);
    assert_int_equal(set.symbol.n, 1);
    free(text);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, begin, end)
    const struct CMUnitTest tests[] = {
        TEST(shapes_have_circles),
        TEST(nothing_that_does_not_show),
        TEST(maps_nest),
        TEST(units_and_views),
        TEST(styles_cascade),
        TEST(gradients_become_their_mean),
        TEST(subpaths_part_and_nest),
        TEST(touching_parts_of_a_group_are_one),
        TEST(marked_groups_are_one),
        TEST(units_side_by_side),
        TEST(backgrounds_are_none),
        TEST(uses_keep_their_frame),
        TEST(equal_shapes_share_a_symbol),
        TEST(the_border_cuts),
        TEST(tiles_wrap),
        TEST(patterns_are_tiles),
        TEST(classes_by_look),
        TEST(long_things_have_samples),
        TEST(bad_input_is_named),
        TEST(all_at_one_place),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
