/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Element fields: what a filled domain must be, whatever is in it. */
#include "tests/base/check.h"

#include "tests/fields/filling.h"

static bool falls(void *user, const tz_fill *fill, int32_t iteration,
                  const tz_fill_energy *e)
{
    (void)fill, (void)iteration;
    for (int k = 0; k < 4; k++)
        if (!(e->after[k] <= e->before[k] * (1 + 1e-9) + 1e-9))
            fail_msg("step %d raises its energy from %g to %g", k, e->before[k],
                     e->after[k]);
    ++*(int *)user;
    return true;
}

static void energies_fall_in_each_step(void **state)
{
    (void)state;
    for (int soft = 0; soft < 2; soft++) {
        bed b;
        int calls = 0;
        bed_lay(&b, 2, 200, 1, 30);
        b.params.rigidity = soft ? 0 : 100;
        b.job.trace = falls, b.job.user = &calls;
        ok(b.ctx, tz_fill_run(b.ctx, &b.job, &b.layout, NULL));
        assert_true(calls >= 30);
        bed_clear(&b);
    }
}

static void things_are_kept_apart_and_cover_more(void **state)
{
    (void)state;
    bed b;
    tz_fill_report at_random, r;
    bed_lay(&b, 2, 250, 1, 0);
    b.params.start = TZ_FILL_RANDOM, b.params.repair = false;
    ok(b.ctx, tz_fill_run(b.ctx, &b.job, &b.layout, &at_random));
    tz_element_set_deinit(&b.layout);
    ok(b.ctx, tz_element_set_like(b.ctx, &b.palette, &b.domain, &b.layout));
    b.params = filling_params(60);
    ok(b.ctx, tz_fill_run(b.ctx, &b.job, &b.layout, &r));
    ok(b.ctx, tz_element_set_check(b.ctx, &b.layout, "layout"));
    assert_true(r.elements > 200);
    assert_true(r.overlap < 0.005);
    assert_true(r.covered > at_random.covered + 0.05);
    assert_true(r.align < 0.2);
    assert_true(r.turn < 0.3);
    for (int32_t i = 0; i < b.layout.element.n; i++)
        assert_true(tz_domain_contains(&b.domain, b.layout.element.v[i].at));
    bed_clear(&b);
}

static void threads_do_not_matter(void **state)
{
    (void)state;
    static const int threads[] = {1, 2, 8};
    tz_element *first = NULL;
    int32_t n = 0;
    for (int t = 0; t < 3; t++) {
        bed b;
        bed_lay(&b, threads[t], 700, 1, 4); /* over 2,048 nodes: blocks on all threads */
        ok(b.ctx, tz_fill_run(b.ctx, &b.job, &b.layout, NULL));
        if (t == 0) {
            n = b.layout.element.n;
            first = malloc((size_t)n * sizeof *first);
            assert_non_null(first);
            memcpy(first, b.layout.element.v, (size_t)n * sizeof *first);
        }
        assert_int_equal(n, b.layout.element.n);
        for (int32_t i = 0; i < n; i++) {
            assert_memory_equal(&first[i].at, &b.layout.element.v[i].at,
                                sizeof first->at);
            assert_true(first[i].angle == b.layout.element.v[i].angle);
            assert_true(first[i].scale == b.layout.element.v[i].scale);
        }
        bed_clear(&b);
    }
    assert_true(n > 2500);
    free(first);
}

/* The whole problem twice as large: the same layout, twice as large, to the last bit. */
static void scale_does_not_matter(void **state)
{
    (void)state;
    bed a, b;
    bed_lay(&a, 1, 160, 1, 25);
    bed_lay(&b, 1, 320, 2, 25);
    ok(a.ctx, tz_fill_run(a.ctx, &a.job, &a.layout, NULL));
    ok(b.ctx, tz_fill_run(b.ctx, &b.job, &b.layout, NULL));
    assert_int_equal(a.layout.element.n, b.layout.element.n);
    double off = 0;
    for (int32_t i = 0; i < a.layout.element.n; i++) {
        const tz_element *p = &a.layout.element.v[i], *q = &b.layout.element.v[i];
        off = fmax(off, hypot(2 * p->at.x - q->at.x, 2 * p->at.y - q->at.y));
    }
    assert_true(off < 1e-3);
    bed_clear(&a);
    bed_clear(&b);
}

/* On a torus a layout that is shifted, or turned by a quarter with its field and palette,
 * takes the same steps. */
static void place_and_turn_do_not_matter(void **state)
{
    (void)state;
    double x[400][3];
    int32_t n = 0;
    for (int k = 0; k < 3; k++) {
        tz_ctx *ctx = new_ctx(1);
        tz_element_set palette, layout;
        tz_element_field field;
        tz_fill *f;
        const double side = 120;
        const tz_domain d = {.size = {side, side, 0}, .torus = true};
        tz_fill_params p = filling_params(10);
        tz_element_field_point line[2] = {{{20, 60}, 0, -1}, {{100, 60}, 0, -1}};
        if (k == 1)
            line[0].at = (tz_vec2){20 + 30, 60 + 45}, line[1].at = (tz_vec2){130, 105};
        if (k == 2)
            line[0].at = (tz_vec2){60, 20}, line[1].at = (tz_vec2){60, 100};
        ok(ctx, filling_palette(ctx, 1, &palette));
        ok(ctx, tz_element_field_init(ctx, d.size, true, 240, &field));
        ok(ctx, tz_element_field_add(
                    &field,
                    (tz_element_field_stroke){.radius = 3, .weight = 1, .directed = true},
                    2, line));
        ok(ctx, tz_element_field_settle(&field));
        ok(ctx, tz_element_set_like(ctx, &palette, &d, &layout));
        for (int32_t i = 0; i < 90; i++) {
            const double u = fmod(i * 0.618033988749895, 1) * side,
                         v = fmod(i * 0.754877666246693, 1) * side;
            tz_vec3 at = {u, v, 0};
            if (k == 1)
                at.x += 30, at.y += 45;
            if (k == 2)
                at = (tz_vec3){side - v, u, 0};
            ok(ctx, tz_element_set_place(&layout, &palette, i % 3, at,
                                         0.02 * i + (k == 2 ? TZ_PI / 2 : 0), 1));
        }
        const tz_fill_job job = {.palette = &palette,
                                 .domain = d,
                                 .field = &field,
                                 .params = &p,
                                 .seed = 3,
                                 .count = -1};
        ok(ctx, tz_fill_begin(ctx, &job, &layout, &f));
        ok(ctx, tz_fill_iterate(f, 6, NULL));
        ok(ctx, tz_fill_write(f, &layout));
        n = layout.element.n;
        assert_int_equal(n, 90);
        for (int32_t i = 0; i < n; i++) {
            tz_vec3 at = layout.element.v[i].at;
            double angle = layout.element.v[i].angle;
            if (k == 1)
                at.x -= 30, at.y -= 45;
            if (k == 2)
                at = (tz_vec3){at.y, side - at.x, 0}, angle -= TZ_PI / 2;
            if (k == 0)
                x[i][0] = at.x, x[i][1] = at.y, x[i][2] = angle;
            /* bodies are written in the order of their places */
            double off = HUGE_VAL, turn = 0;
            for (int32_t e = 0; e < n; e++) {
                const tz_vec3 v =
                    tz_domain_vector(&d, at, (tz_vec3){x[e][0], x[e][1], 0});
                if (hypot(v.x, v.y) < off)
                    off = hypot(v.x, v.y), turn = remainder(angle - x[e][2], 2 * TZ_PI);
            }
            /* places are parted by chance, a thousandth of a radius, before they settle;
             * that grows threefold or so with each iteration */
            assert_true(off < 0.2);
            assert_true(fabs(turn) < 0.05);
        }
        tz_fill_end(f);
        tz_element_set_deinit(&palette);
        tz_element_set_deinit(&layout);
        tz_element_field_deinit(&field);
        end_ctx(ctx);
    }
}

static void soft_things_bend(void **state)
{
    (void)state;
    bed b;
    bed_lay(&b, 2, 220, 1, 40);
    const tz_fill_entry entry = {2, 1, 0, {1, 1}, 0, 0};
    b.job.entry = &entry, b.job.entries = 1;
    ok(b.ctx, tz_fill_run(b.ctx, &b.job, &b.layout, NULL));
    ok(b.ctx, tz_element_set_check(b.ctx, &b.layout, "layout"));
    double bent = 0;
    for (int32_t i = 0; i < b.layout.element.n; i++) {
        const tz_element *e = &b.layout.element.v[i];
        const tz_sample *s = &b.layout.sample.v[e->sample];
        assert_true(e->samples > 2);
        double way = 0;
        for (int32_t k = 1; k < e->samples; k++)
            way += hypot(s[k].at.x - s[k - 1].at.x, s[k].at.y - s[k - 1].at.y);
        bent = fmax(bent, way / hypot(s[e->samples - 1].at.x - s[0].at.x,
                                      s[e->samples - 1].at.y - s[0].at.y));
    }
    assert_true(bent > 1.003);
    bed_clear(&b);
}

static void sizes_follow_strokes(void **state)
{
    (void)state;
    bed b;
    bed_lay(&b, 2, 300, 1, 30);
    const tz_element_field_point left[2] = {{{30, 20}, 0.6, -1}, {{30, 280}, 0.6, -1}};
    const tz_element_field_point right[2] = {{{270, 20}, 1.5, -1}, {{270, 280}, 1.5, -1}};
    const tz_element_field_stroke stroke = {.radius = 8, .weight = 1};
    ok(b.ctx, tz_element_field_add(&b.field, stroke, 2, left));
    ok(b.ctx, tz_element_field_add(&b.field, stroke, 2, right));
    ok(b.ctx, tz_element_field_settle(&b.field));
    ok(b.ctx, tz_fill_run(b.ctx, &b.job, &b.layout, NULL));
    double sum[3] = {0}, n[3] = {0};
    for (int32_t i = 0; i < b.layout.element.n; i++) {
        const tz_element *e = &b.layout.element.v[i];
        const int k = (int)fmin(2, e->at.x / 100);
        sum[k] += e->scale / b.palette.element.v[e->source].scale, n[k]++;
    }
    assert_true(sum[0] / n[0] < sum[1] / n[1] - 0.1);
    assert_true(sum[1] / n[1] < sum[2] / n[2] - 0.1);
    bed_clear(&b);
}

static void brushes_change_what_they_touch(void **state)
{
    (void)state;
    bed b;
    tz_fill *f;
    bed_lay(&b, 2, 400, 1, 0);
    ok(b.ctx, tz_fill_begin(b.ctx, &b.job, &b.layout, &f));
    ok(b.ctx, tz_fill_settle(f, 25));
    ok(b.ctx, tz_fill_write(f, &b.layout));
    const int32_t n = b.layout.element.n;
    tz_element *old = malloc((size_t)n * sizeof *old);
    assert_non_null(old);
    memcpy(old, b.layout.element.v, (size_t)n * sizeof *old);
    const tz_vec2 stroke[2] = {{100, 100}, {130, 100}};
    ok(b.ctx, tz_fill_erase(f, 2, stroke, 25));
    ok(b.ctx, tz_fill_write(f, &b.layout));
    assert_true(b.layout.element.n < n);
    for (int32_t i = 0; i < b.layout.element.n; i++) {
        const tz_vec3 p = b.layout.element.v[i].at;
        assert_true(hypot(p.x - fmin(fmax(p.x, 100), 130), p.y - 100) > 20);
    }
    ok(b.ctx, tz_fill_add(f, 2, stroke, 25, 1, 1)); /* discs */
    ok(b.ctx, tz_fill_settle(f, 12));
    ok(b.ctx, tz_fill_write(f, &b.layout));
    int32_t far = 0, moved = 0, discs = 0;
    for (int32_t i = 0; i < b.layout.element.n; i++) {
        const tz_element *e = &b.layout.element.v[i];
        discs += e->source == 1 && hypot(e->at.x - 115, e->at.y - 100) < 25;
        if (hypot(e->at.x - 115, e->at.y - 100) < 150)
            continue;
        bool same = false;
        for (int32_t k = 0; k < n && !same; k++)
            same = old[k].at.x == e->at.x && old[k].at.y == e->at.y;
        far++, moved += !same;
    }
    assert_true(far > 100);
    assert_int_equal(moved, 0);
    assert_true(discs > 8);
    ok(b.ctx, tz_fill_replace(f, 2, stroke, 25, 0, 1));
    tz_fill_wake_all(f);
    ok(b.ctx, tz_fill_settle(f, 3));
    tz_fill_report r;
    ok(b.ctx, tz_fill_write(f, &b.layout));
    ok(b.ctx, tz_fill_measure(b.ctx, &b.layout, &b.palette, &b.field, 512, &r));
    assert_true(r.overlap < 0.01);
    fails(b.ctx, tz_fill_add(f, 2, stroke, 0, 0, 1), TZ_INVALID, "radius");
    fails(b.ctx, tz_fill_add(f, 2, stroke, 5, 9, 1), TZ_INVALID, "entry 9");
    free(old);
    tz_fill_end(f);
    bed_clear(&b);
}

static void what_is_fixed_stays(void **state)
{
    (void)state;
    bed b;
    bed_lay(&b, 2, 200, 1, 30);
    ok(b.ctx,
       tz_element_set_place(&b.layout, &b.palette, 0, (tz_vec3){100, 100, 0}, 1, 2));
    b.layout.element.v[0].fixed = true;
    ok(b.ctx, tz_fill_run(b.ctx, &b.job, &b.layout, NULL));
    int found = 0;
    for (int32_t i = 0; i < b.layout.element.n; i++) {
        const tz_element *e = &b.layout.element.v[i];
        if (!e->fixed)
            continue;
        found++;
        assert_true(hypot(e->at.x - 100, e->at.y - 100) < 1e-9);
        assert_true(fabs(e->scale / b.palette.element.v[0].scale - 2) < 1e-9);
    }
    assert_int_equal(found, 1);
    bed_clear(&b);
}

/* Sizes that a field changes by 1 to 3: as full as anywhere, nothing lies on another. */
static void changing_sizes_are_packed_evenly(void **state)
{
    (void)state;
    bed b;
    tz_fill_report r;
    const tz_element_field_stroke pen = {.radius = 6, .weight = 1, .directed = true};
    const tz_element_field_point v[2] = {{{30, 30}, 0.7, -1}, {{270, 270}, 2.1, -1}};
    bed_lay(&b, 2, 300, 1, 60);
    tz_element_field_deinit(&b.field);
    ok(b.ctx, tz_element_field_init(b.ctx, b.domain.size, false, 256, &b.field));
    ok(b.ctx, tz_element_field_add(&b.field, pen, 2, v));
    ok(b.ctx, tz_element_field_settle(&b.field));
    ok(b.ctx, tz_fill_run(b.ctx, &b.job, &b.layout, &r));
    assert_true(r.overlap < 0.005);
    assert_true(r.covered > 0.6);
    /* they keep their size, and few must leave */
    assert_true(r.shrunk < 0.05 * r.elements);
    assert_true(r.dropped < 0.1 * r.elements);
    double covered[2] = {0, 0}; /* by area, in the corners of small and of large ones */
    for (int32_t i = 0; i < b.layout.element.n; i++) {
        const tz_element *e = &b.layout.element.v[i];
        const double s = e->scale / b.palette.element.v[e->source].scale,
                     a[3] = {122, 50, 128};
        if (e->at.x < 150 && e->at.y < 150)
            covered[0] += s * s * a[e->source] / (150 * 150);
        if (e->at.x > 150 && e->at.y > 150)
            covered[1] += s * s * a[e->source] / (150 * 150);
    }
    assert_true(fabs(covered[0] - covered[1]) < 0.12);
    bed_clear(&b);
}

static void odd_input(void **state)
{
    (void)state;
    bed b;
    tz_fill *f;
    tz_element_set none = {0};
    tz_fill_entry e = {0, 1, 100, {1, 1}, 0, 0};
    bed_lay(&b, 1, 100, 1, 5);
    tz_fill_job j = b.job;
    j.palette = &none;
    fails(b.ctx, tz_fill_begin(b.ctx, &j, &b.layout, &f), TZ_INVALID, "palette");
    j = b.job, j.domain.size.x = 0;
    fails(b.ctx, tz_fill_begin(b.ctx, &j, &b.layout, &f), TZ_INVALID, "no area");
    j = b.job, j.domain.size = (tz_vec3){3, 3, 0};
    fails(b.ctx, tz_fill_begin(b.ctx, &j, &b.layout, &f), TZ_INVALID, "larger than");
    j = b.job, j.entry = &e, j.entries = 1, e.rigidity = -1;
    fails(b.ctx, tz_fill_begin(b.ctx, &j, &b.layout, &f), TZ_INVALID, "rigidity");
    e.rigidity = 0, e.element = 99;
    fails(b.ctx, tz_fill_begin(b.ctx, &j, &b.layout, &f), TZ_INVALID, "element 99");
    e.element = 0, e.size[0] = 2;
    fails(b.ctx, tz_fill_begin(b.ctx, &j, &b.layout, &f), TZ_INVALID, "sizes");
    j = b.job, j.domain.size = (tz_vec3){1e7, 1e7, 0};
    fails(b.ctx, tz_fill_begin(b.ctx, &j, &b.layout, &f), TZ_LIMIT, "elements");
    const tz_element_field_point far[2] = {{{-500, -500}, 0, -1}, {{-400, -500}, 0, -1}};
    const tz_element_field_point nowhere[1] = {{{50, 50}, 0, -1}};
    const tz_element_field_point thick[1] = {{{50, 50}, 0, 7}};
    const tz_element_field_stroke s = {.radius = 1, .weight = 1, .directed = true};
    ok(b.ctx, tz_element_field_add(&b.field, s, 2, far));
    ok(b.ctx, tz_element_field_add(&b.field, s, 1, nowhere));
    fails(b.ctx, tz_element_field_add(&b.field, s, 1, thick), TZ_INVALID, "density");
    ok(b.ctx, tz_element_field_settle(&b.field));
    for (int k = 0; k < 60; k++) /* all at one place */
        ok(b.ctx,
           tz_element_set_place(&b.layout, &b.palette, 1, (tz_vec3){50, 50, 0}, 0, 1));
    b.params.iterations = 60;
    tz_fill_report r;
    ok(b.ctx, tz_fill_run(b.ctx, &b.job, &b.layout, &r));
    assert_true(r.overlap < 0.01);
    bed_clear(&b);
}

/* Small, for it runs once for each of its allocations; test_fill_laws.c has the rest. */
static tz_status fill(tz_ctx *ctx)
{
    tz_element_set palette = {0}, layout = {0};
    tz_element_field field = {0};
    tz_fill_params p = filling_params(2);
    tz_fill *f = NULL;
    p.rigidity = 50;
    const tz_domain d = {.size = {42, 42, 0}};
    const tz_element_field_stroke pen = {.radius = 3, .weight = 1, .directed = true};
    const tz_element_field_point v[2] = {{{5, 20}, 1, 1}, {{35, 25}, 1.2, 0.8}};
    const tz_fill_job job = {.palette = &palette,
                             .domain = d,
                             .field = &field,
                             .params = &p,
                             .seed = 2,
                             .count = 2};
    tz_fill_report r;
    tz_status s = filling_palette(ctx, 1, &palette);
    if (s == TZ_OK)
        s = tz_element_field_init(ctx, d.size, false, 16, &field);
    if (s == TZ_OK)
        s = tz_element_field_add(&field, pen, 2, v);
    if (s == TZ_OK)
        s = tz_element_field_settle(&field);
    if (s == TZ_OK)
        s = tz_element_set_like(ctx, &palette, &d, &layout);
    if (s == TZ_OK)
        s = tz_fill_begin(ctx, &job, &layout, &f);
    if (s == TZ_OK)
        s = tz_fill_write(f, &layout);
    if (s == TZ_OK)
        s = tz_fill_measure(ctx, &layout, &palette, &field, 32, &r);
    tz_fill_end(f);
    tz_element_set_deinit(&palette);
    tz_element_set_deinit(&layout);
    tz_element_field_deinit(&field);
    return s;
}

static void survives_want_of_memory(void **state)
{
    (void)state;
    survive(fill, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(energies_fall_in_each_step),
        cmocka_unit_test(things_are_kept_apart_and_cover_more),
        cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(scale_does_not_matter),
        cmocka_unit_test(place_and_turn_do_not_matter),
        cmocka_unit_test(soft_things_bend),
        cmocka_unit_test(sizes_follow_strokes),
        cmocka_unit_test(brushes_change_what_they_touch),
        cmocka_unit_test(what_is_fixed_stays),
        cmocka_unit_test(changing_sizes_are_packed_evenly),
        cmocka_unit_test(odd_input),
        cmocka_unit_test(survives_want_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
