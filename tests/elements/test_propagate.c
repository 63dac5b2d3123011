/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Editing by example: what is alike follows, what is not stays. */
#include "tests/base/check.h"

#include "elements/propagate.h"
#include "tests/elements/patterns.h"

/* A hexagonal lattice on 120 x 103.92 of which each third element, none beside another,
 * has a partner of class b: a dimer. */
static bool has_partner(int32_t i)
{
    const int32_t row = i / 12, q = i % 12 - (row - row % 2) / 2; /* along two axes */
    return (q - row + 36) % 3 == 0;
}

static void make(tz_ctx *ctx, tz_element_set *s, bool torus)
{
    const double row = 5 * sqrt(3.0);
    const tz_domain d = {.size = {120, 12 * row, 0}, .torus = torus};
    ok(ctx, pattern_begin(ctx, s, d, 3, 2));
    for (int32_t i = 0; i < 144; i++) {
        const double x = (i % 12 + (i / 12 % 2 ? 0.75 : 0.25)) * 10,
                     y = (i / 12 + 0.5) * row;
        ok(ctx, pattern_add(s, 0, x, y));
    }
    for (int32_t i = 0; i < 144; i++)
        if (has_partner(i))
            ok(ctx, pattern_add(s, 1, s->element.v[i].at.x + 3, s->element.v[i].at.y));
}

static void copy(tz_ctx *ctx, const tz_element_set *s, tz_element_set *out)
{
    ok(ctx, tz_element_set_like(ctx, s, NULL, out));
    for (int32_t i = 0; i < s->element.n; i++) {
        ok(ctx, tz_element_set_place(out, s, i, s->element.v[i].at, 0, 1));
        out->element.v[i].source = s->element.v[i].source;
    }
}

static void shift(tz_element_set *s, int32_t i, double x, double y)
{
    tz_element *e = &s->element.v[i];
    e->at.x += x, e->at.y += y;
    for (int32_t k = 0; k < e->samples; k++)
        s->sample.v[e->sample + k].at.x += x, s->sample.v[e->sample + k].at.y += y;
}

static void assert_same(const tz_element *a, const tz_element *b)
{
    assert_true(a->kind == b->kind && a->symbol == b->symbol && a->source == b->source);
    assert_true(a->samples == b->samples && a->depth == b->depth);
    assert_true(a->cut == b->cut && a->fixed == b->fixed);
    assert_memory_equal(&a->at, &b->at, sizeof a->at);
    assert_true(a->angle == b->angle && a->scale == b->scale && a->radius == b->radius);
}

static double off(const tz_element_set *a, int32_t i, const tz_element_set *b, int32_t j)
{
    const tz_vec3 v =
        tz_domain_vector(&a->domain, a->element.v[i].at, b->element.v[j].at);
    return hypot(v.x, v.y);
}

static void test_nothing_changes_nothing(void **state)
{
    (void)state;
    for (int torus = 0; torus < 2; torus++) {
        tz_ctx *ctx = new_ctx(2);
        tz_element_set s, out;
        tz_propagate_report r;
        make(ctx, &s, torus == 1);
        s.element.v[3].fixed = true;
        ok(ctx, tz_element_propagate(ctx, &s, &s, NULL, &out, &r));
        assert_true(r.examples == 0 && r.followed == 0);
        assert_int_equal(out.element.n, s.element.n);
        for (int32_t i = 0; i < s.element.n; i++)
            assert_same(&out.element.v[i], &s.element.v[i]);
        for (int32_t i = 0; i < s.sample.n; i++)
            assert_memory_equal(&out.sample.v[i].at, &s.sample.v[i].at, sizeof(tz_vec3));
        tz_element_set_deinit(&s);
        tz_element_set_deinit(&out);
        end_ctx(ctx);
    }
}

/* One atom that has a partner moves: all of these, and no others; also on the seam. */
static void test_move(void **state)
{
    (void)state;
    for (int torus = 0; torus < 2; torus++) {
        tz_ctx *ctx = new_ctx(2);
        tz_element_set s, after, out;
        tz_propagate_report r;
        const tz_propagate_params p = {.turned = false};
        int32_t moved = 0;
        make(ctx, &s, torus == 1);
        copy(ctx, &s, &after);
        const int32_t one = 5 * 12 + 4;
        assert_true(has_partner(one));
        shift(&after, one, 1, -2);
        ok(ctx, tz_element_propagate(ctx, &s, &after, &p, &out, &r));
        assert_int_equal(r.examples, 1);
        for (int32_t i = 0; i < s.element.n; i++) {
            const tz_element *e = &s.element.v[i];
            const tz_vec3 v = tz_domain_vector(&s.domain, e->at, out.element.v[i].at);
            const bool wants = i < 144 && has_partner(i);
            const bool near_border = tz_domain_depth(&s.domain, e->at) < 25;
            if (!wants || torus || !near_border) {
                assert_float_equal(v.x, wants ? 1 : 0, 1e-9);
                assert_float_equal(v.y, wants ? -2 : 0, 1e-9);
            }
            moved += v.x != 0;
            const tz_vec3 q = out.sample.v[out.element.v[i].sample].at;
            assert_float_equal(q.x, out.element.v[i].at.x, 1e-9);
        }
        assert_int_equal(moved, r.followed + 1);
        tz_element_set_deinit(&s);
        tz_element_set_deinit(&after);
        tz_element_set_deinit(&out);
        end_ctx(ctx);
    }
}

/* The partner of one is removed, another symbol, larger, turned; each by itself. */
static void test_kinds_of_change(void **state)
{
    (void)state;
    for (int what = 0; what < 4; what++) {
        tz_ctx *ctx = new_ctx(2);
        tz_element_set s, after, out;
        tz_propagate_report r;
        make(ctx, &s, true);
        s.kind.v[1].oriented = what == 3;
        copy(ctx, &s, &after);
        const int32_t one = 160;
        tz_element *e = &after.element.v[one];
        assert_int_equal(e->kind, 1);
        if (what == 0) { /* its sample stays, unused: the last element takes its place */
            *e = after.element.v[--after.element.n];
        } else if (what == 1) {
            e->kind = 2, e->symbol = 2;
        } else if (what == 2) {
            e->scale = 1.5, e->radius *= 1.5;
        } else {
            e->angle = 0.4;
        }
        ok(ctx, tz_element_propagate(ctx, &s, &after, NULL, &out, &r));
        assert_int_equal(r.examples, 1);
        assert_int_equal(r.followed, 47);
        assert_int_equal(out.element.n, what == 0 ? 144 : 192);
        for (int32_t i = 0; i < out.element.n; i++) {
            const tz_element *o = &out.element.v[i];
            if (i < 144) { /* lattice: as it was */
                assert_true(o->kind == 0 && o->scale == 1 && off(&out, i, &s, i) == 0);
                continue;
            }
            assert_float_equal(off(&out, i, &s, i), 0, 1e-9);
            assert_int_equal(o->kind, what == 1 ? 2 : 1);
            assert_float_equal(o->scale, what == 2 ? 1.5 : 1, 1e-9);
            assert_float_equal(o->radius, what == 2 ? 3 : 2, 1e-9);
            assert_float_equal(o->angle, what == 3 ? 0.4 : 0, 1e-6);
        }
        ok(ctx, tz_element_set_check(ctx, &out, "out"));
        tz_element_set_deinit(&s);
        tz_element_set_deinit(&after);
        tz_element_set_deinit(&out);
        end_ctx(ctx);
    }
}

/* Something added beside an atom without partner comes to all of these. */
static void test_added(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_element_set s, after, out;
    tz_propagate_report r;
    const tz_propagate_params p = {.turned = false};
    make(ctx, &s, true);
    copy(ctx, &s, &after);
    const int32_t home = 5 * 12 + 6;
    assert_false(has_partner(home));
    const tz_vec3 at = s.element.v[home].at;
    ok(ctx, pattern_add(&after, 2, at.x, at.y + 2.5));
    ok(ctx, tz_element_propagate(ctx, &s, &after, &p, &out, &r));
    int32_t added = 0;
    for (int32_t i = 0; i < out.element.n; i++) {
        if (out.element.v[i].kind != 2)
            continue;
        added++;
        double least = INFINITY;
        int32_t nearest = -1;
        for (int32_t k = 0; k < 144; k++)
            if (off(&out, i, &s, k) < least)
                least = off(&out, i, &s, k), nearest = k;
        assert_false(has_partner(nearest));
        assert_float_equal(least, 2.5, 1e-9);
    }
    /* those left and right of a dimer have it on other sides: two kinds of 48 */
    assert_true(added == 48 || added == 96);
    assert_int_equal(r.followed, added - 1);
    tz_element_set_deinit(&s);
    tz_element_set_deinit(&after);
    tz_element_set_deinit(&out);
    end_ctx(ctx);
}

/* Three flowers, each a ring of unlike petals turned another way, far apart: what is done
 * to one's middle is done to the others' in their own frames. */
static void test_turned(void **state)
{
    (void)state;
    static const double turn[3] = {0, 1.1, -2.2};
    tz_ctx *ctx = new_ctx(2);
    tz_element_set s, after, out;
    ok(ctx, pattern_begin(ctx, &s, (tz_domain){.size = {300, 100, 0}}, 3, 2));
    for (int f = 0; f < 3; f++) {
        ok(ctx, pattern_add(&s, 0, 50 + 100 * f, 50));
        for (int k = 0; k < 7; k++) {
            const double a = turn[f] + k * TZ_PI / 3.5, l = k == 0 ? 14 : 10;
            ok(ctx, pattern_add(&s, k < 3 ? 1 : 2, 50 + 100 * f + l * cos(a),
                                50 + l * sin(a)));
        }
    }
    copy(ctx, &s, &after);
    shift(&after, 0, 4, 0);
    tz_propagate_params p;
    tz_params_default(&tz_propagate_param_table, &p);
    p.radius = 20;
    ok(ctx, tz_element_propagate(ctx, &s, &after, &p, &out, NULL));
    for (int f = 0; f < 3; f++) {
        const tz_vec3 at = out.element.v[8 * f].at;
        assert_float_equal(at.x, 50 + 100 * f + 4 * cos(turn[f]), 1e-4);
        assert_float_equal(at.y, 50 + 4 * sin(turn[f]), 1e-4);
    }
    tz_element_set_deinit(&out);
    p.turned = false;
    ok(ctx, tz_element_propagate(ctx, &s, &after, &p, &out, NULL));
    assert_true(out.element.v[8].at.x == 150 && out.element.v[16].at.x == 250);
    tz_element_set_deinit(&s);
    tz_element_set_deinit(&after);
    tz_element_set_deinit(&out);
    end_ctx(ctx);
}

/* Two examples that are equally alike: the others go half way between them. Fixed ones
 * stay. Order in the document does not matter. */
static void test_two_examples(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    tz_element_set s, after, out;
    ok(ctx, pattern_make(ctx, &s, PATTERN_SQUARE,
                         (tz_domain){.size = {100, 100, 0}, .torus = true}, 1));
    s.element.v[40].fixed = true;
    copy(ctx, &s, &after);
    after.element.v[40].fixed = true;
    shift(&after, 11, 2, 0);
    shift(&after, 66, 4, 2);
    for (int32_t i = 0; i < 50; i++) { /* written the other way round */
        const tz_element e = after.element.v[i];
        after.element.v[i] = after.element.v[99 - i];
        after.element.v[99 - i] = e;
    }
    tz_propagate_report r;
    ok(ctx, tz_element_propagate(ctx, &s, &after, NULL, &out, &r));
    assert_true(r.examples == 2 && r.followed == 97);
    for (int32_t i = 0; i < 100; i++) {
        const int32_t j = 99 - i;
        if (i == 11 || i == 66 || i == 40)
            continue;
        const tz_vec3 v =
            tz_domain_vector(&s.domain, s.element.v[i].at, out.element.v[j].at);
        assert_float_equal(v.x, 3, 1e-6);
        assert_float_equal(v.y, 1, 1e-6);
    }
    assert_true(off(&s, 40, &out, 59) == 0 && out.element.v[59].fixed);
    tz_element_set_deinit(&s);
    tz_element_set_deinit(&after);
    tz_element_set_deinit(&out);
    end_ctx(ctx);
}

/* With places that scatter a little the limit still tells dimers from lattice. */
static void test_noise(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 5; seed++) {
        tz_ctx *ctx = new_ctx(2);
        tz_element_set s, after, out;
        tz_propagate_report r;
        make(ctx, &s, true);
        for (int32_t i = 0; i < s.element.n; i++) {
            tz_rng g = tz_rng_make(seed, (uint64_t)i);
            shift(&s, i, tz_rng_range(&g, -0.5, 0.5), tz_rng_range(&g, -0.5, 0.5));
        }
        copy(ctx, &s, &after);
        shift(&after, 5 * 12 + 4, 1, -2);
        ok(ctx, tz_element_propagate(ctx, &s, &after, NULL, &out, &r));
        int32_t right = 0, wrong = 0;
        for (int32_t i = 0; i < 144; i++) {
            const bool moved = off(&s, i, &out, i) > 1e-9;
            right += moved && has_partner(i);
            wrong += moved && !has_partner(i);
        }
        assert_true(right >= 44);
        assert_int_equal(wrong, 0);
        tz_element_set_deinit(&s);
        tz_element_set_deinit(&after);
        tz_element_set_deinit(&out);
        end_ctx(ctx);
    }
}

static void test_bad_input(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set s, after, out;
    tz_propagate_params p = {.alike = NAN};
    make(ctx, &s, true);
    copy(ctx, &s, &after);
    after.domain.size.x = 90;
    fails(ctx, tz_element_propagate(ctx, &s, &after, NULL, &out, NULL), TZ_INVALID,
          "domains differ");
    after.domain.size.x = 120;
    fails(ctx, tz_element_propagate(ctx, &s, &after, &p, &out, NULL), TZ_INVALID,
          "alike");
    after.element.v[7].kind = 99;
    fails(ctx, tz_element_propagate(ctx, &s, &after, NULL, &out, NULL), TZ_INVALID,
          "after");
    assert_true(out.element.v == NULL && out.ctx == NULL);
    after.element.v[7].kind = 0;
    /* all gone; and all from nothing */
    const int32_t n = after.element.n;
    after.element.n = 0;
    ok(ctx, tz_element_propagate(ctx, &s, &after, NULL, &out, NULL));
    assert_int_equal(out.element.n, 0);
    tz_element_set_deinit(&out);
    ok(ctx, tz_element_propagate(ctx, &after, &s, NULL, &out, NULL));
    assert_int_equal(out.element.n, n);
    tz_element_set_deinit(&out);
    tz_element_set_deinit(&s);
    tz_element_set_deinit(&after);
    end_ctx(ctx);
}

static tz_status body(tz_ctx *ctx)
{
    tz_element_set s, after, out = {0};
    tz_status st = pattern_make(ctx, &s, PATTERN_CHESS,
                                (tz_domain){.size = {60, 60, 0}, .torus = true}, 1);
    if (st != TZ_OK)
        return st;
    st = pattern_make(ctx, &after, PATTERN_CHESS, s.domain, 1);
    if (st == TZ_OK) {
        shift(&after, 9, 1, 1);
        st = tz_element_propagate(ctx, &s, &after, NULL, &out, NULL);
        assert_true(st == TZ_OK || out.element.v == NULL);
    }
    if (st == TZ_OK)
        tz_element_set_deinit(&out);
    tz_element_set_deinit(&s);
    tz_element_set_deinit(&after);
    return st;
}

static void test_memory_runs_out(void **state)
{
    (void)state;
    survive(body, 1);
}

static void test_threads_do_not_matter(void **state)
{
    (void)state;
    static const int threads[] = {1, 2, 8};
    tz_element *first = NULL;
    for (int k = 0; k < 3; k++) {
        tz_ctx *ctx = new_ctx(threads[k]);
        tz_element_set s, after, out;
        ok(ctx, pattern_make(ctx, &s, PATTERN_MIXED,
                             (tz_domain){.size = {300, 300, 0}, .torus = true}, 4));
        copy(ctx, &s, &after);
        shift(&after, 100, 2, 1);
        shift(&after, 555, -2, 1);
        ok(ctx, tz_element_propagate(ctx, &s, &after, NULL, &out, NULL));
        const size_t size = (size_t)out.element.n * sizeof *first;
        if (!first)
            first = memcpy(malloc(size), out.element.v, size);
        for (int32_t i = 0; i < out.element.n; i++)
            assert_same(&first[i], &out.element.v[i]);
        tz_element_set_deinit(&s);
        tz_element_set_deinit(&after);
        tz_element_set_deinit(&out);
        end_ctx(ctx);
    }
    free(first);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_nothing_changes_nothing),
        cmocka_unit_test(test_move),
        cmocka_unit_test(test_kinds_of_change),
        cmocka_unit_test(test_added),
        cmocka_unit_test(test_turned),
        cmocka_unit_test(test_two_examples),
        cmocka_unit_test(test_noise),
        cmocka_unit_test(test_bad_input),
        cmocka_unit_test(test_memory_runs_out),
        cmocka_unit_test(test_threads_do_not_matter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
