/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Element fields and bad input: palettes, shapes and numbers that make no sense. Each ends
 * in time, with one clear line or a sound layout. */
#include "tests/base/check.h"

#include "tests/fields/filling.h"

/* ---- one odd problem ---------------------------------------------------------------- */

typedef struct odd {
    const char *name, *things; /* shapes on a page of 100 x 100 */
    double scale;              /* of the page; 0 = 1 */
    double width, height;      /* of the domain; 0 = 200 */
    bool torus;
    const char *shape; /* path of the region, on the domain's own page; NULL = none */
    int32_t count;
    tz_fill_entry entry; /* used if its share or size is not 0 */
    tz_status status;
    const char *says;
    int32_t least; /* elements of the result; -1 = may be anything */
} odd;

#define LEAF "<path d='M10,20 C15,15 24,15 30,20 C24,25 15,25 10,20Z'/>"
#define BEAD "<circle cx='60' cy='20' r='4'/>"

static tz_status read_things(tz_ctx *ctx, const odd *o, tz_element_set *palette)
{
    const double scale = o->scale > 0 ? o->scale : 1;
    const size_t room = strlen(o->things) + 300;
    char *text = malloc(room);
    assert_non_null(text);
    snprintf(text, room,
             "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 %.17g %.17g'><g "
             "transform='scale(%.17g)'>%s</g></svg>",
             100 * scale, 100 * scale, scale, o->things);
    const tz_status s =
        tz_element_parse_svg(ctx, "things.svg", text, strlen(text), NULL, palette);
    free(text);
    return s;
}

static tz_status read_shape(tz_ctx *ctx, const odd *o, tz_vec3 size, tz_region **region)
{
    char dir[64], path[128];
    if (!o->shape)
        return TZ_OK;
    begin_dir(dir);
    snprintf(path, sizeof path, "%s/shape.svg", dir);
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    fprintf(f,
            "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 %.17g "
            "%.17g'><path d='%s'/></svg>",
            size.x, size.y, o->shape);
    assert_int_equal(fclose(f), 0);
    const tz_status s = tz_region_read(ctx, path, size, o->torus, region);
    end_dir(dir);
    return s;
}

static void try(const odd *o, int32_t iterations)
{
    tz_ctx *ctx = new_ctx(2);
    tz_element_set palette = {0}, layout = {0};
    tz_region *region = NULL;
    tz_fill_report r = {0};
    tz_fill_params p = filling_params(iterations);
    tz_domain d = {
        .size = {o->width != 0 ? o->width : 200, o->height != 0 ? o->height : 200, 0},
        .torus = o->torus};
    const double since = filling_seconds();
    tz_status s = read_things(ctx, o, &palette);
    if (s == TZ_OK)
        s = read_shape(ctx, o, d.size, &region);
    d.region = region;
    const bool one = o->entry.share != 0 || o->entry.size[1] != 0;
    const tz_fill_job job = {.palette = &palette,
                             .entry = one ? &o->entry : NULL,
                             .entries = one,
                             .domain = d,
                             .params = &p,
                             .seed = 1,
                             .count = o->count};
    if (s == TZ_OK && isfinite(d.size.x) && d.size.x > 0)
        ok(ctx, tz_element_set_like(ctx, &palette, &d, &layout));
    if (s == TZ_OK)
        s = tz_fill_run(ctx, &job, &layout, &r);
    filling_in_time(o->name, since);
    if (o->status != TZ_OK) {
        if (s == TZ_OK)
            fail_msg("%s: %d elements", o->name, layout.element.n);
        fails(ctx, s, o->status, o->says);
        assert_int_equal(layout.element.n, 0);
    } else {
        if (s != TZ_OK)
            fail_msg("%s: %s", o->name, tz_ctx_message(ctx));
        filling_sound(ctx, &layout);
        filling_inside(&d, &layout);
        if (layout.element.n < o->least)
            fail_msg("%s: %d elements", o->name, layout.element.n);
        if (r.overlap > 0.01)
            fail_msg("%s: overlap %g", o->name, r.overlap);
    }
    tz_element_set_deinit(&palette);
    tz_element_set_deinit(&layout);
    tz_region_free(region);
    end_ctx(ctx);
}

#define TRY_ALL(list, iterations)                                 \
    for (size_t i_ = 0; i_ < sizeof(list) / sizeof *(list); i_++) \
    try(&(list)[i_], iterations)

/* ---- palettes ----------------------------------------------------------------------- */

static void palettes_without_things(void **state)
{
    (void)state;
    static const odd none[] = {
        {.name = "empty", .things = ""},
        {.name = "nothing painted",
         .things = "<path fill='none' d='M0 0H20V20Z'/><path opacity='0' d='M40 "
                   "40h9v9z'/>"},
        {.name = "clear paint", .things = "<path fill-opacity='0' d='M10 10h9v9z'/>"},
        {.name = "hidden", .things = "<path display='none' d='M10 10h9v9z'/>"},
        {.name = "no area", .things = "<path d='M10 10H90Z'/>"},
    };
    for (size_t i = 0; i < sizeof none / sizeof *none; i++) {
        odd o = none[i];
        o.status = TZ_INVALID, o.says = "no elements";
        try(&o, 10);
    }
}

static void things_of_odd_shapes(void **state)
{
    (void)state;
    static const odd shapes[] = {
        {.name = "hair", .things = "<path d='M10 10H40V10.001H10Z'/>", .least = 50},
        {.name = "thinner",
         .things = "<path d='M10 10H40V10.0000001H10Z'/>",
         .least = 50},
        {.name = "crossing",
         .things = "<path d='M10 10L40 40L10 40L40 10Z'/>",
         .least = 30},
        {.name = "one point many times",
         .things = "<path d='M10 10L20 10L20 10L20 10L20 20L10 20L10 10Z'/>",
         .least = 100},
        {.name = "two parts far apart",
         .things = "<path d='M10 10h4v4h-4zM50 50h4v4h-4z'/>",
         .least = 3},
    };
    TRY_ALL(shapes, 10);
    const size_t room = 80000;
    char *text = malloc(room);
    assert_non_null(text);
    int n = snprintf(text, room, "<path fill-rule='evenodd' d='M2 2H98V98H2Z");
    for (int i = 0; i < 1000; i++)
        n += snprintf(text + n, room - (size_t)n, "M%g %gh.8v.8h-.8z", 4 + i % 32 * 2.8,
                      4 + i / 32 * 2.8);
    snprintf(text + n, room - (size_t)n, "'/>");
    try(&(odd){.name = "a thousand holes",
               .things = text,
               .width = 600,
               .height = 600,
               .least = 20},
        10);
    n = 0;
    for (int i = 0; i < 300; i++)
        n += snprintf(text + n, room - (size_t)n, "<circle cx='%d' cy='%d' r='2'/>",
                      3 + i % 19 * 5, 3 + i / 19 * 5);
    try(&(odd){.name = "many things", .things = text, .least = 500}, 10);
    free(text);
}

static void things_larger_than_the_domain(void **state)
{
    (void)state;
    static const odd large[] = {
        {.name = "a disc, alone",
         .things = "<circle cx='50' cy='50' r='49'/>",
         .width = 60,
         .height = 60,
         .status = TZ_INVALID,
         .says = "larger than the domain"},
        {.name = "a disc, among others",
         .things = "<circle cx='50' cy='45' r='44'/><circle cx='4' cy='94' r='3'/>",
         .width = 60,
         .height = 60,
         .least = 60},
        {.name = "a bar, alone",
         .things = "<path d='M5 50H95V52H5Z'/>",
         .width = 60,
         .height = 60,
         .status = TZ_INVALID,
         .says = "larger than the domain"},
        {.name = "a bar, among others",
         .things = "<path d='M5 50H95V52H5Z'/><circle cx='40' cy='94' r='3'/>",
         .width = 60,
         .height = 60,
         .least = 60},
        {.name = "a bar, tiled",
         .things = "<path d='M5 50H95V52H5Z'/>",
         .width = 60,
         .height = 60,
         .torus = true,
         .status = TZ_INVALID,
         .says = "larger than"},
        {.name = "a square, tiled",
         .things = "<path d='M5 5H95V95H5Z'/>",
         .width = 60,
         .height = 60,
         .torus = true,
         .status = TZ_INVALID,
         .says = "larger than"},
        {.name = "one fills half of a tile",
         .things = "<circle cx='40' cy='40' r='25'/>",
         .width = 60,
         .height = 60,
         .torus = true,
         .least = 1},
        {.name = "larger by its size",
         .things = LEAF,
         .entry = {0, 1, 100, {1e9, 1e9}, 0, 0},
         .status = TZ_INVALID,
         .says = "larger than the domain"},
        {.name = "sizes up to beyond it",
         .things = LEAF,
         .entry = {0, 1, 100, {0.5, 50}, 0, 0},
         .least = 3},
    };
    TRY_ALL(large, 10);
}

/* ---- domains ------------------------------------------------------------------------ */

static void domains_of_odd_sizes(void **state)
{
    (void)state;
    static const odd sizes[] = {
        {.name = "none",
         .things = LEAF,
         .width = -3,
         .status = TZ_INVALID,
         .says = "no area"},
        {.name = "a millionth",
         .things = LEAF,
         .scale = 1e-8,
         .width = 1e-6,
         .height = 1e-6,
         .least = 40},
        {.name = "things of 1e-9",
         .things = LEAF,
         .scale = 1e-9,
         .width = 2e-7,
         .height = 2e-7,
         .least = 100},
        {.name = "1e9, few things",
         .things = LEAF,
         .width = 1e9,
         .height = 1e9,
         .count = 200,
         .least = 200},
        {.name = "1e9, many",
         .things = LEAF,
         .width = 1e9,
         .height = 1e9,
         .status = TZ_LIMIT,
         .says = "too many"},
        {.name = "things of 1e-9, many",
         .things = LEAF,
         .scale = 1e-9,
         .status = TZ_LIMIT,
         .says = "too many"},
        {.name = "a ribbon", .things = BEAD, .width = 20000, .height = 10, .least = 1000},
        {.name = "a ribbon upright",
         .things = BEAD,
         .width = 10,
         .height = 20000,
         .least = 1000},
        {.name = "a ribbon, tiled",
         .things = BEAD,
         .width = 20000,
         .height = 10,
         .torus = true,
         .least = 1000},
        {.name = "a thread",
         .things = BEAD,
         .width = 1e9,
         .height = 10,
         .count = 100,
         .least = 100},
    };
    TRY_ALL(sizes, 3);
    odd o = {.name = "not a number",
             .things = LEAF,
             .width = NAN,
             .status = TZ_INVALID,
             .says = "no area"};
    try(&o, 3);
    o.width = INFINITY;
    try(&o, 3);
}

static void shapes_of_all_sorts(void **state)
{
    (void)state;
    static const odd shapes[] = {
        {.name = "pieces smaller than any thing",
         .things = LEAF,
         .shape = "M10 10h2v2h-2zM50 50h2v2h-2zM90 90h2v2h-2z",
         .status = TZ_INVALID,
         .says = "larger than the domain"},
        {.name = "pieces, some of them too small",
         .things = LEAF,
         .shape = "M10 10h60v60h-60zM150 150h2v2h-2zM90 90h40v40h-40z",
         .least = 20},
        {.name = "crossing itself",
         .things = LEAF,
         .shape = "M10 10L190 190H10L190 10Z",
         .least = 60},
        {.name = "a hair",
         .things = LEAF,
         .shape = "M10 10H190V10.01H10Z",
         .status = TZ_INVALID,
         .says = "nothing in it is inside"},
        {.name = "out of view",
         .things = LEAF,
         .shape = "M-10 -10H-20V-20Z",
         .status = TZ_INVALID,
         .says = "nothing in it is inside"},
        {.name = "all of it",
         .things = LEAF,
         .shape = "M-9 -9H300V300H-9Z",
         .least = 200},
        {.name = "over the border of a tile",
         .things = LEAF,
         .torus = true,
         .shape = "M-10 -10H90V90H-10Z",
         .least = 30},
    };
    TRY_ALL(shapes, 10);
}

/* ---- numbers ------------------------------------------------------------------------ */

static const double wrong[] = {0, -1, 1e-300, 1e300, INFINITY, -INFINITY, NAN};
enum { WRONG = sizeof wrong / sizeof *wrong };

/* Runs; the result is sound or one line says what is wrong. */
static void one_of_both(bed *b, const char *name, double value)
{
    const double since = filling_seconds();
    const tz_status s = tz_fill_run(b->ctx, &b->job, &b->layout, NULL);
    filling_in_time(name, since);
    if (s == TZ_OK) {
        filling_sound(b->ctx, &b->layout);
        tz_element_set_deinit(&b->layout);
        ok(b->ctx, tz_element_set_like(b->ctx, &b->palette, &b->domain, &b->layout));
    } else {
        if (s != TZ_INVALID && s != TZ_LIMIT)
            fail_msg("%s = %g: %s", name, value, tz_ctx_message(b->ctx));
        fails(b->ctx, s, s, " ");
        assert_int_equal(b->layout.element.n, 0);
    }
    if (!isfinite(value) && !(value > 0))
        assert_int_not_equal(s, TZ_OK); /* nothing takes what is not a number */
}

static void parameters_out_of_range(void **state)
{
    (void)state;
    bed b;
    bed_lay(&b, 1, 90, 1, 2);
    for (int32_t k = 0; k < tz_fill_param_table.n; k++) {
        const tz_param *row = &tz_fill_param_table.row[k];
        char *at = (char *)&b.params + row->offset;
        for (int i = 0; i < WRONG; i++) {
            b.params = filling_params(2);
            if (row->type == TZ_PARAM_DOUBLE)
                memcpy(at, &wrong[i], sizeof(double));
            else
                break;
            one_of_both(&b, row->name, wrong[i]);
        }
        const int32_t most[] = {-1, INT32_MIN, INT32_MAX};
        for (int i = 0; i < 3 && row->type == TZ_PARAM_INT; i++) {
            b.params = filling_params(2);
            memcpy(at, &most[i], sizeof(int32_t));
            fails(b.ctx, tz_fill_run(b.ctx, &b.job, &b.layout, NULL), TZ_INVALID,
                  row->name);
        }
    }
    b.params = filling_params(0); /* no iterations, one disc: little, but sound */
    b.params.discs = 1;
    ok(b.ctx, tz_fill_run(b.ctx, &b.job, &b.layout, NULL));
    filling_sound(b.ctx, &b.layout);
    bed_clear(&b);
}

static void entries_out_of_range(void **state)
{
    (void)state;
    bed b;
    bed_lay(&b, 1, 90, 1, 2);
    for (int what = 0; what < 6; what++)
        for (int i = 0; i < WRONG; i++) {
            tz_fill_entry e[2] = {{0, 1, 100, {1, 1}, 0, 0}, {1, 1, 0, {1, 1}, 0, 0}};
            double *const field[] = {&e[0].share,   &e[0].rigidity, &e[0].size[0],
                                     &e[0].size[1], &e[0].turn,     &e[0].jitter};
            *field[what] = wrong[i];
            b.job.entry = e, b.job.entries = 2;
            one_of_both(&b, "an entry", wrong[i]);
        }
    tz_fill_entry e[2] = {{0, 0, 100, {1, 1}, 0, 0}, {1, 0, 0, {1, 1}, 0, 0}};
    b.job.entry = e, b.job.entries = 2;
    fails(b.ctx, tz_fill_run(b.ctx, &b.job, &b.layout, NULL), TZ_INVALID, "share");
    b.job.entries = 0;
    fails(b.ctx, tz_fill_run(b.ctx, &b.job, &b.layout, NULL), TZ_INVALID, "share");
    b.job.entries = 1, e[0].share = 1, e[0].element = -1;
    fails(b.ctx, tz_fill_run(b.ctx, &b.job, &b.layout, NULL), TZ_INVALID, "element -1");
    bed_clear(&b);
}

static void counts(void **state)
{
    (void)state;
    for (int32_t n = -1; n <= 9; n++) {
        if (n == 0)
            continue;
        bed b;
        bed_lay(&b, 1, 200, 1, 5);
        b.job.count = n;
        ok(b.ctx, tz_fill_run(b.ctx, &b.job, &b.layout, NULL));
        filling_sound(b.ctx, &b.layout);
        assert_int_equal(b.layout.element.n, n < 0 ? 0 : n);
        bed_clear(&b);
    }
    bed b;
    bed_lay(&b, 1, 200, 1, 5);
    b.job.count = 2000001;
    fails(b.ctx, tz_fill_run(b.ctx, &b.job, &b.layout, NULL), TZ_LIMIT, "2000001");
    b.job.count = INT32_MAX;
    fails(b.ctx, tz_fill_run(b.ctx, &b.job, &b.layout, NULL), TZ_LIMIT, "2147483647");
    b.job.count = 20000;
    fails(b.ctx, tz_fill_run(b.ctx, &b.job, &b.layout, NULL), TZ_INVALID, "take fewer");
    assert_int_equal(b.layout.element.n, 0);
    bed_clear(&b);
}

/* Twice as many as there is room for: what cannot be parted goes. */
static void crowds_are_thinned_out(void **state)
{
    (void)state;
    bed b;
    tz_fill_report r;
    bed_lay(&b, 2, 200, 1, 10);
    b.job.count = 700;
    ok(b.ctx, tz_fill_run(b.ctx, &b.job, &b.layout, &r));
    filling_sound(b.ctx, &b.layout);
    assert_true(r.overlap < 0.01);
    assert_true(r.covered > 0.5);
    bed_clear(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(palettes_without_things),
        cmocka_unit_test(things_of_odd_shapes),
        cmocka_unit_test(things_larger_than_the_domain),
        cmocka_unit_test(domains_of_odd_sizes),
        cmocka_unit_test(shapes_of_all_sorts),
        cmocka_unit_test(parameters_out_of_range),
        cmocka_unit_test(entries_out_of_range),
        cmocka_unit_test(counts),
        cmocka_unit_test(crowds_are_thinned_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
