/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Elements cut from photos, in documents and back. */
#include "tests/base/check.h"

#include <math.h>

#include "base/file.h"
#include "base/rng.h"
#include "elements/element_io.h"

/* ---- sets ---------------------------------------------------------------------------- */

/* Parts of 3 .. 8 points, of numbers with all their bits. */
static tz_status add_outline(tz_ctx *ctx, tz_element_symbol *y, uint64_t name)
{
    tz_rng g = tz_rng_make(7, name);
    tz_status s = TZ_OK;
    const int32_t parts = 1 + tz_rng_below(&g, 3);
    for (int32_t k = 0; k < parts && s == TZ_OK; k++) {
        const int32_t n = 3 + tz_rng_below(&g, 6);
        s = tz_array_push(ctx, &y->part, y->outline.n);
        for (int32_t i = 0; i < n && s == TZ_OK; i++)
            s = tz_array_push(ctx, &y->outline,
                              ((tz_vec2){tz_rng_normal(&g) * 20, tz_rng_normal(&g)}));
    }
    return s;
}

static tz_status add_symbol(tz_element_set *s, int32_t i)
{
    char id[32];
    tz_element_symbol y = {.radius = 20.0 / (3 + i),
                           .photo = i % 2,
                           .photo_scale = i % 3 ? 1 : 2.5 / 3,
                           .photo_at = {20.1 * (1 + i), 10.3 + i}};
    snprintf(id, sizeof id, "thing-%d", i + 1);
    tz_status st = tz_strdup(s->ctx, id, &y.id);
    if (st == TZ_OK)
        st = tz_strdup(s->ctx, "", &y.markup);
    if (st == TZ_OK)
        st = add_outline(s->ctx, &y, (uint64_t)i);
    if (st == TZ_OK)
        st = tz_array_push(s->ctx, &s->symbol, y);
    if (st != TZ_OK) {
        tz_free(s->ctx, y.id);
        tz_free(s->ctx, y.markup);
        tz_array_free(s->ctx, &y.outline);
        tz_array_free(s->ctx, &y.part);
    }
    return st;
}

static tz_status add_photo(tz_element_set *s, const char *dir, int32_t i)
{
    char name[96];
    tz_element_photo p = {.width = 96 + i, .height = 64};
    snprintf(name, sizeof name, "%s/photo %d & \xc3\xa9.png", dir, i);
    if (i == 0)
        memset(p.sha256, 'a', 64);
    tz_status st = tz_strdup(s->ctx, name, &p.path);
    if (st == TZ_OK && i == 0) {
        snprintf(name, sizeof name, "%s/plate.png", dir);
        st = tz_strdup(s->ctx, name, &p.plate);
    }
    if (st == TZ_OK)
        st = tz_array_push(s->ctx, &s->photo, p);
    if (st != TZ_OK) {
        tz_free(s->ctx, p.path);
        tz_free(s->ctx, p.plate);
    }
    return st;
}

static tz_status add_kind(tz_element_set *s, const char *name, bool is_void)
{
    tz_element_kind k = {.is_void = is_void, .oriented = !is_void};
    tz_status st = tz_strdup(s->ctx, name, &k.name);
    if (st == TZ_OK)
        st = tz_array_push(s->ctx, &s->kind, k);
    if (st != TZ_OK)
        tz_free(s->ctx, k.name);
    return st;
}

enum { SYMBOLS = 5, ELEMENTS = 12 };

static tz_status make(tz_ctx *ctx, const char *dir, bool torus, tz_element_set *s)
{
    *s = (tz_element_set){.ctx = ctx, .domain = {.size = {96, 64, 0}, .torus = torus}};
    tz_rng g = tz_rng_make(3, 1);
    tz_status st = add_kind(s, "stone", false);
    if (st == TZ_OK)
        st = add_kind(s, "nothing", true);
    for (int32_t i = 0; i < 2 && st == TZ_OK; i++)
        st = add_photo(s, dir, i);
    for (int32_t i = 0; i < SYMBOLS && st == TZ_OK; i++)
        st = add_symbol(s, i);
    for (int32_t i = 0; i < ELEMENTS && st == TZ_OK; i++) {
        tz_element e = {.kind = i == 3,
                        .symbol = i % SYMBOLS,
                        .source = i - 1,
                        .sample = i,
                        .samples = 1,
                        .at = {tz_rng_unit(&g) * 96, tz_rng_unit(&g) * 64, 0},
                        .angle = tz_rng_unit(&g),
                        .scale = 0.5 + tz_rng_unit(&g),
                        .radius = 4,
                        .depth = tz_rng_below(&g, 5),
                        .cut = i == 2};
        st = tz_array_push(ctx, &s->sample, ((tz_sample){e.at, 0, 1}));
        if (st == TZ_OK)
            st = tz_array_push(ctx, &s->element, e);
    }
    if (st != TZ_OK)
        tz_element_set_deinit(s);
    return st;
}

static void same_photos(const tz_element_set *a, const tz_element_set *b)
{
    assert_int_equal(a->photo.n, b->photo.n);
    for (int32_t i = 0; i < a->photo.n; i++) {
        const tz_element_photo *p = &a->photo.v[i], *q = &b->photo.v[i];
        assert_string_equal(p->path, q->path);
        assert_string_equal(p->sha256, q->sha256);
        assert_true(p->width == q->width && p->height == q->height);
        assert_int_equal(!p->plate, !q->plate);
        if (p->plate)
            assert_string_equal(p->plate, q->plate);
    }
}

static void same_symbols(const tz_element_set *a, const tz_element_set *b)
{
    assert_int_equal(a->symbol.n, b->symbol.n);
    for (int32_t i = 0; i < a->symbol.n; i++) {
        const tz_element_symbol *p = &a->symbol.v[i], *q = &b->symbol.v[i];
        assert_string_equal(p->id, q->id);
        assert_string_equal(p->markup, q->markup);
        assert_true(p->radius == q->radius && p->photo == q->photo);
        assert_memory_equal(&p->photo_scale, &q->photo_scale, sizeof p->photo_scale);
        assert_memory_equal(&p->photo_at, &q->photo_at, sizeof p->photo_at);
        assert_int_equal(p->outline.n, q->outline.n);
        assert_int_equal(p->part.n, q->part.n);
        assert_memory_equal(p->outline.v, q->outline.v,
                            (size_t)p->outline.n * sizeof *p->outline.v);
        assert_memory_equal(p->part.v, q->part.v, (size_t)p->part.n * sizeof *p->part.v);
    }
}

static void same(const tz_element_set *a, const tz_element_set *b)
{
    same_photos(a, b);
    same_symbols(a, b);
    assert_int_equal(a->element.n, b->element.n);
    for (int32_t i = 0; i < a->element.n; i++) {
        const tz_element *p = &a->element.v[i], *q = &b->element.v[i];
        assert_memory_equal(&p->at, &q->at, sizeof p->at);
        assert_memory_equal(&p->angle, &q->angle, 3 * sizeof(double));
        assert_true(p->kind == q->kind && p->symbol == q->symbol &&
                    p->source == q->source && p->depth == q->depth && p->cut == q->cut &&
                    p->fixed == q->fixed);
    }
}

/* ---- there and back ------------------------------------------------------------------ */

static void bit_for_bit(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    char dir[64], path[96], again[96];
    begin_dir(dir);
    snprintf(path, sizeof path, "%s/a.svg", dir);
    snprintf(again, sizeof again, "%s/b.svg", dir);
    for (int torus = 0; torus < 2; torus++) {
        tz_element_set s, b;
        char *one, *two;
        size_t size_one, size_two;
        ok(ctx, make(ctx, dir, torus, &s));
        ok(ctx, tz_element_write_svg(ctx, path, &s));
        ok(ctx, tz_element_read_svg(ctx, path, NULL, &b));
        same(&s, &b);
        ok(ctx, tz_element_write_svg(ctx, again, &b));
        ok(ctx, tz_file_read(ctx, path, 1 << 20, &one, &size_one));
        ok(ctx, tz_file_read(ctx, again, 1 << 20, &two, &size_two));
        assert_true(size_one == size_two && memcmp(one, two, size_one) == 0);
        tz_free(ctx, one);
        tz_free(ctx, two);
        tz_element_set_deinit(&s);
        tz_element_set_deinit(&b);
    }
    end_dir(dir);
    end_ctx(ctx);
}

/* Paths below the working folder stay relative to it, wherever the document lies. */
static void paths_from_here(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set s, b;
    char dir[64], path[96], here[4096];
    assert_non_null(getcwd(here, sizeof here));
    begin_dir(dir);
    ok(ctx, make(ctx, "photos", false, &s));
    snprintf(path, sizeof path, "%s/a.svg", dir);
    ok(ctx, tz_element_write_svg(ctx, path, &s));
    ok(ctx, tz_element_read_svg(ctx, path, NULL, &b));
    assert_string_equal(b.photo.v[0].path, s.photo.v[0].path);
    assert_string_equal(b.photo.v[0].plate, "photos/plate.png");
    tz_element_set_deinit(&b);
    assert_int_equal(chdir(dir), 0);
    ok(ctx, tz_element_read_svg(ctx, "a.svg", NULL, &b));
    assert_int_equal(chdir(here), 0);
    assert_true(b.photo.v[0].path[0] == '/'); /* no longer below */
    assert_non_null(strstr(b.photo.v[0].path, "photos/photo 0 & \xc3\xa9.png"));
    tz_element_set_deinit(&s);
    tz_element_set_deinit(&b);
    end_dir(dir);
    end_ctx(ctx);
}

/* ---- editors ------------------------------------------------------------------------- */

typedef struct edit {
    const char *from, *to;
    int32_t elements;  /* expected */
    const char *fault; /* expected, or NULL */
} edit;

static char *text_of(tz_ctx *ctx, const char *path, const edit *e)
{
    char *text, *changed;
    size_t size;
    ok(ctx, tz_file_read(ctx, path, 1 << 20, &text, &size));
    char *p = strstr(text, e->from);
    if (!p)
        fail_msg("%s is not in the document", e->from);
    ok(ctx, tz_alloc(ctx, &changed, size + strlen(e->to) + 1, 1));
    sprintf(changed, "%.*s%s%s", (int)(p - text), text, e->to, p + strlen(e->from));
    tz_free(ctx, text);
    return changed;
}

static void edited(tz_ctx *ctx, const char *path, const edit *e, tz_element_set *b)
{
    char *text = text_of(ctx, path, e);
    const tz_status st = tz_element_parse_svg(ctx, path, text, strlen(text), NULL, b);
    if (e->fault) {
        fails(ctx, st, TZ_FORMAT, e->fault);
    } else {
        ok(ctx, st);
        assert_int_equal(b->element.n, e->elements);
    }
    tz_free(ctx, text);
}

static void editors(void **state)
{
    (void)state;
    static const edit some[] = {
        {"<use xlink:href=\"#thing-1\"",
         "<use style=\"display:none\" xlink:href=\"#thing-1\"", ELEMENTS - 1, NULL},
        {"<use xlink:href=\"#thing-2\"",
         "<use visibility='hidden' xlink:href=\"#thing-2\"", ELEMENTS - 1, NULL},
        {"<use xlink:href=\"#thing-2\"",
         "<g style='display : none'><use xlink:href='#thing-1' x='3'/></g>"
         "<use xlink:href=\"#thing-2\"",
         ELEMENTS, NULL},
        {"<use xlink:href=\"#thing-2\"",
         "<use xlink:href='#thing-1' x='3'/><use xlink:href=\"#thing-2\"", ELEMENTS + 1,
         NULL},
        {"tz:photo=\"0\"", "tz:photo=\"9\"", 0, "is missing"},
        {"tz:photo=\"1\"", "tz:photo=\"0\"", 0, "same number"},
        {"tz:photo=\"1\"", "tz:photo=\"1.5\"", 0, "cannot be"},
        {"tz:photo=\"1\"", "tz:photo=\"1e9\"", 0, "cannot be"},
        {"tz:pixels=\"96 64\"", "tz:pixels=\"96 0\"", 0, "size"},
        {"tz:pixels=\"96 64\"", "", 0, "tz:pixels"},
        {"photo%200", "%00", 0, "%00"},
        {"id=\"thing-1-outline\"", "", 0, "outline"},
        {"tz:photo=\"0 0.8333333333333334", "tz:photo=\"0 -1", 0, "cannot be"},
        {"tz:photo=\"0 0.8333333333333334", "tz:photo=\"0", 0, "4 numbers"},
        {" d=\"M", " d=\"Mx", 0, "path"},
        {" d=\"M", " d=\"M1e200 1e200L", 0, "outline"},
    };
    tz_ctx *ctx = new_ctx(1);
    tz_element_set s, b;
    char dir[64], path[96];
    begin_dir(dir);
    snprintf(path, sizeof path, "%s/a.svg", dir);
    ok(ctx, make(ctx, dir, false, &s));
    ok(ctx, tz_element_write_svg(ctx, path, &s));
    for (size_t i = 0; i < sizeof some / sizeof *some; i++) {
        edited(ctx, path, &some[i], &b);
        tz_element_set_deinit(&b);
    }
    tz_element_set_deinit(&s);
    end_dir(dir);
    end_ctx(ctx);
}

/* A <use> that was dragged keeps its symbol, and all outlines stay as they were. */
static void dragging(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set s, b;
    char dir[64], path[96], from[64];
    int32_t lowest = 0;
    begin_dir(dir);
    snprintf(path, sizeof path, "%s/a.svg", dir);
    ok(ctx, make(ctx, dir, false, &s));
    ok(ctx, tz_element_write_svg(ctx, path, &s));
    for (int32_t i = 1; i < ELEMENTS; i++)
        if (s.element.v[i].depth < s.element.v[lowest].depth)
            lowest = i;
    snprintf(from, sizeof from, "<use xlink:href=\"#%s\"",
             s.symbol.v[s.element.v[lowest].symbol].id);
    char to[96];
    snprintf(to, sizeof to, "<use x=\"10\" xlink:href=\"#%s\"",
             s.symbol.v[s.element.v[lowest].symbol].id);
    edited(ctx, path, &(edit){from, to, ELEMENTS, NULL}, &b);
    const tz_element *p = &s.element.v[lowest], *q = &b.element.v[lowest];
    const double far = hypot(q->at.x - p->at.x, q->at.y - p->at.y);
    assert_true(fabs(far - 10 * p->scale) < 1e-9 && q->fixed && p->symbol == q->symbol);
    same_symbols(&s, &b);
    same_photos(&s, &b);
    tz_element_set_deinit(&s);
    tz_element_set_deinit(&b);
    end_dir(dir);
    end_ctx(ctx);
}

static void a_photo_wants_a_name(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set s;
    char dir[64], path[96];
    begin_dir(dir);
    snprintf(path, sizeof path, "%s/a.svg", dir);
    ok(ctx, make(ctx, dir, false, &s));
    s.photo.v[0].path[0] = 0;
    fails(ctx, tz_element_write_svg(ctx, path, &s), TZ_INVALID, "no file name");
    assert_int_equal(dir_count(dir), 0);
    tz_element_set_deinit(&s);
    end_dir(dir);
    end_ctx(ctx);
}

static tz_status there_and_back(tz_ctx *ctx)
{
    tz_element_set a = {0}, b = {0};
    char dir[64], path[96];
    begin_dir(dir);
    snprintf(path, sizeof path, "%s/a.svg", dir);
    tz_status s = make(ctx, dir, true, &a);
    if (s == TZ_OK)
        s = tz_element_write_svg(ctx, path, &a);
    if (s == TZ_OK)
        s = tz_element_read_svg(ctx, path, NULL, &b);
    tz_element_set_deinit(&a);
    tz_element_set_deinit(&b);
    end_dir(dir);
    return s;
}

static void survives_want_of_memory(void **state)
{
    (void)state;
    survive(there_and_back, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bit_for_bit),
        cmocka_unit_test(paths_from_here),
        cmocka_unit_test(editors),
        cmocka_unit_test(dragging),
        cmocka_unit_test(a_photo_wants_a_name),
        cmocka_unit_test(survives_want_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
