/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Sets of elements: copies, placing, checks. */
#include "tests/base/check.h"

#include <math.h>

#include "elements/element.h"

static void push(tz_element_set *s, double x, double y, int32_t samples)
{
    const tz_element e = {.source = -1,
                          .sample = s->sample.n,
                          .samples = samples,
                          .at = {x, y, 0},
                          .scale = 1,
                          .radius = 2,
                          .cut = true,
                          .fixed = true};
    for (int32_t i = 0; i < samples; i++)
        ok(s->ctx, tz_array_push(s->ctx, &s->sample,
                                 ((tz_sample){{x + i, y, 0}, i, 1.0 / samples})));
    ok(s->ctx, tz_array_push(s->ctx, &s->element, e));
}

static tz_status make(tz_ctx *ctx, tz_element_set *s, bool torus)
{
    *s = (tz_element_set){.domain = {.size = {100, 50, 0}, .torus = torus}, .ctx = ctx};
    tz_element_kind k = {.oriented = true};
    tz_element_symbol y = {.radius = 2};
    tz_status st = tz_strdup(ctx, "leaf", &k.name);
    if (st == TZ_OK && (st = tz_array_push(ctx, &s->kind, k)) != TZ_OK)
        tz_free(ctx, k.name);
    if (st == TZ_OK)
        st = tz_array_push(ctx, &s->symbol, y);
    if (st == TZ_OK)
        st = tz_strdup(ctx, "s", &s->symbol.v[0].id);
    if (st == TZ_OK)
        st = tz_strdup(ctx, "", &s->symbol.v[0].markup);
    if (st == TZ_OK)
        st = tz_strdup(ctx, "<rect/>", &s->background);
    for (int i = 0; i < 3 && st == TZ_OK; i++)
        st = tz_array_push(ctx, &s->symbol.v[0].outline, ((tz_vec2){i, i * i}));
    if (st == TZ_OK)
        st = tz_array_push(ctx, &s->symbol.v[0].part, 0);
    return st;
}

static void like_copies_all_but_elements(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set a, b;
    const tz_domain wide = {.size = {300, 200, 0}, .torus = true};
    ok(ctx, make(ctx, &a, false));
    push(&a, 10, 10, 1);
    ok(ctx, tz_element_set_like(ctx, &a, &wide, &b));
    assert_int_equal(b.element.n, 0);
    assert_int_equal(b.kind.n, 1);
    assert_string_equal(b.kind.v[0].name, "leaf");
    assert_true(b.kind.v[0].oriented);
    assert_string_equal(b.symbol.v[0].id, "s");
    assert_int_equal(b.symbol.v[0].outline.n, 3);
    assert_true(b.symbol.v[0].outline.v[2].y == 4);
    assert_string_equal(b.background, "<g transform=\"scale(3 4)\"><rect/></g>");
    assert_true(b.domain.torus && b.domain.size.x == 300);
    tz_element_set_deinit(&b);
    ok(ctx, tz_element_set_like(ctx, &a, NULL, &b));
    assert_true(!b.domain.torus && b.domain.size.x == 100);
    tz_element_set_deinit(&a);
    tz_element_set_deinit(&b);
    tz_element_set_deinit(&b); /* takes zeroed */
    end_ctx(ctx);
}

static void placing_turns_samples_along(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set a, b;
    ok(ctx, make(ctx, &a, true));
    push(&a, 10, 10, 1);
    push(&a, 20, 10, 3);
    ok(ctx, tz_element_set_like(ctx, &a, NULL, &b));
    ok(ctx, tz_element_set_place(&b, &a, 1, (tz_vec3){110, -5, 0}, TZ_PI / 2, 2));
    const tz_element *e = &b.element.v[0];
    assert_int_equal(e->source, 1);
    assert_int_equal(e->samples, 3);
    assert_true(e->at.x == 10 && e->at.y == 45); /* wrapped */
    assert_true(e->radius == 4 && e->scale == 2 && !e->fixed && e->cut);
    assert_float_equal(e->angle, TZ_PI / 2, 1e-15);
    for (int i = 0; i < 3; i++) { /* along +x becomes along +y, not wrapped */
        assert_float_equal(b.sample.v[i].at.x, 10, 1e-12);
        assert_float_equal(b.sample.v[i].at.y, 45 + 2 * i, 1e-12);
        assert_int_equal(b.sample.v[i].id, i);
    }
    ok(ctx, tz_element_set_check(ctx, &b, "b"));
    /* into itself, while its arrays move */
    for (int i = 0; i < 100; i++)
        ok(ctx, tz_element_set_place(&a, &a, 1, (tz_vec3){i, 1, 0}, 0, 1));
    assert_int_equal(a.sample.n, 304);
    assert_true(a.sample.v[303].at.x == 99 + 2 && a.sample.v[303].at.y == 1);
    ok(ctx, tz_element_set_check(ctx, &a, "a"));
    tz_element_set_deinit(&a);
    tz_element_set_deinit(&b);
    end_ctx(ctx);
}

static void faults_are_named(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set s;
    ok(ctx, make(ctx, &s, false));
    push(&s, 10, 10, 2);
    push(&s, 10, 20, 1);
    ok(ctx, tz_element_set_check(ctx, &s, "x.svg"));
#define FAULT(change, undo, part)                                             \
    do {                                                                      \
        change;                                                               \
        fails(ctx, tz_element_set_check(ctx, &s, "x.svg"), TZ_INVALID, part); \
        undo;                                                                 \
        ok(ctx, tz_element_set_check(ctx, &s, "x.svg"));                      \
    } while (0)
    tz_element *e = &s.element.v[1];
    FAULT(e->kind = 1, e->kind = 0, "x.svg: element 1 cannot be used: its class");
    FAULT(e->symbol = -1, e->symbol = 0, "symbol");
    FAULT(e->source = -2, e->source = -1, "source");
    FAULT(e->samples = 0, e->samples = 1, "samples");
    FAULT(e->samples = 2, e->samples = 1, "samples");
    FAULT(e->sample = INT32_MAX, e->sample = 2, "samples");
    FAULT(e->at.x = NAN, e->at.x = 10, "position");
    FAULT(e->angle = INFINITY, e->angle = 0, "angle");
    FAULT(e->scale = 0, e->scale = 1, "scale");
    FAULT(e->radius = -1, e->radius = 1, "radius");
    FAULT(s.sample.v[2].at.y = NAN, s.sample.v[2].at.y = 20, "sample's position");
    FAULT(s.sample.v[2].weight = 0, s.sample.v[2].weight = 1, "weight");
    FAULT(s.domain.size.x = 0, s.domain.size.x = 100, "no area");
    FAULT(s.symbol.v[0].radius = 0, s.symbol.v[0].radius = 2, "symbol 0");
    FAULT(s.symbol.v[0].outline.v[0].x = NAN, s.symbol.v[0].outline.v[0].x = 0,
          "symbol 0");
    FAULT(s.symbol.v[0].part.v[0] = 9, s.symbol.v[0].part.v[0] = 0, "symbol 0");
    tz_element_set_deinit(&s);
    end_ctx(ctx);
}

static tz_status copy_and_place(tz_ctx *ctx)
{
    tz_element_set a, b = {0};
    tz_status s = make(ctx, &a, true);
    if (s == TZ_OK)
        s = tz_array_push(ctx, &a.sample, ((tz_sample){{1, 1, 0}, 0, 1}));
    if (s == TZ_OK)
        s = tz_array_push(ctx, &a.element,
                          ((tz_element){.samples = 1, .scale = 1, .radius = 1}));
    if (s == TZ_OK)
        s = tz_element_set_like(ctx, &a, NULL, &b);
    if (s == TZ_OK)
        s = tz_element_set_place(&b, &a, 0, (tz_vec3){1, 2, 0}, 0, 1);
    tz_element_set_deinit(&a);
    tz_element_set_deinit(&b);
    return s;
}

static void survives_want_of_memory(void **state)
{
    (void)state;
    survive(copy_and_place, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(like_copies_all_but_elements),
        cmocka_unit_test(placing_turns_samples_along),
        cmocka_unit_test(faults_are_named),
        cmocka_unit_test(survives_want_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
