/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Brushes: what is grown, erased and relaxed by hand, and where it is not. */
#include "tests/base/check.h"

#include "elements/brush.h"
#include "tests/elements/growing.h"
#include "tests/support/elements.h"

typedef struct hand {
    tz_ctx *ctx;
    tz_element_set ex, out;
    tz_growth *g;
} hand;

static void open_hand(hand *h, double side, bool torus)
{
    const tz_domain d = {.size = {side, side, 0}, .torus = torus};
    const tz_growth_texture all = {.scale = 1};
    const tz_growth_params p = growing_params();
    h->ctx = new_ctx(1);
    h->g = NULL;
    ok(h->ctx, drawn_darts(h->ctx, 150, 8, 300, 2, false, &h->ex));
    ok(h->ctx, tz_element_set_like(h->ctx, &h->ex, &d, &h->out));
    ok(h->ctx, tz_brush_begin(h->ctx, &h->ex, &all, 1, &p, &h->out, &h->g));
}

static void close_hand(hand *h)
{
    tz_growth_end(h->g);
    tz_element_set_deinit(&h->ex);
    tz_element_set_deinit(&h->out);
    end_ctx(h->ctx);
}

static void finish(hand *h)
{
    bool more = true;
    for (int32_t k = 0; more; k++) {
        ok(h->ctx, tz_growth_step(h->g, 50, &more));
        ok(h->ctx, tz_element_set_check(h->ctx, &h->out, "output"));
        assert_true(k < 100000);
    }
}

/* Distance from a place to a path. */
static double off_path(const tz_vec2 *path, int32_t n, tz_vec3 p)
{
    double least = INFINITY;
    for (int32_t k = 0; k < n; k++)
        least = fmin(least, hypot(p.x - path[k].x, p.y - path[k].y));
    return least;
}

static void test_paint(void **state)
{
    (void)state;
    hand h;
    tz_vec2 path[30];
    int32_t n = 0, before = 0;
    bool more;
    open_hand(&h, 500, false);
    ok(h.ctx, tz_growth_step(h.g, 100, &more));
    assert_int_equal(h.out.element.n, 0); /* nothing is open yet */
    for (int32_t k = 0; k < 30; k++) {
        path[n++] = (tz_vec2){60 + 13 * k, 250 + 120 * sin(0.25 * k)};
        ok(h.ctx, tz_brush_paint(h.g, path[k], 30, 0));
        ok(h.ctx, tz_growth_step(h.g, 40, &more));
        assert_true(h.out.element.n >= before);
        before = h.out.element.n;
    }
    finish(&h);
    for (int32_t i = 0; i < h.out.element.n; i++)
        assert_true(off_path(path, n, h.out.element.v[i].at) < 30 + 3);
    tz_growth_report r;
    tz_growth_tell(h.g, &r);
    growing_near(r.placed, r.expected, 0.12);
    assert_true(r.covered > 0.99);
    assert_int_equal(r.placed, h.out.element.n);
    close_hand(&h);
}

/* Erased room stays empty until it is painted or filled. */
static void test_erase(void **state)
{
    (void)state;
    for (int32_t torus = 0; torus < 2; torus++) {
        hand h;
        int32_t removed = 0, again = 0;
        double area;
        tz_growth_report full, r;
        open_hand(&h, 300, torus);
        ok(h.ctx, tz_brush_paint(h.g, (tz_vec2){150, 150}, 250, 0));
        finish(&h);
        tz_growth_tell(h.g, &full);
        const tz_vec2 at = {torus ? 290 : 150, 150};
        ok(h.ctx, tz_brush_erase(h.g, at, 40, &removed));
        assert_true(removed > 20);
        assert_int_equal(h.out.element.n, full.placed - removed);
        finish(&h);
        assert_int_equal(h.out.element.n, full.placed - removed);
        for (int32_t i = 0; i < h.out.element.n; i++) {
            const tz_vec3 v = tz_domain_vector(&h.out.domain, (tz_vec3){at.x, at.y, 0},
                                               h.out.element.v[i].at);
            assert_true(hypot(v.x, v.y) > 40 - 3);
        }
        ok(h.ctx, tz_brush_erase(h.g, at, 30, &again));
        assert_int_equal(again, 0);
        ok(h.ctx, tz_brush_fill(h.g, at, 0, &area));
        assert_true(area > 0.5 * TZ_PI * 40 * 40 && area < 1.5 * TZ_PI * 40 * 40);
        finish(&h);
        tz_growth_tell(h.g, &r);
        growing_near(r.placed, full.placed, 0.03);
        ok(h.ctx, tz_element_set_check(h.ctx, &h.out, "output"));
        close_hand(&h);
    }
}

/* Elements keep their samples and sources when others are removed. */
static void test_whole(void **state)
{
    (void)state;
    hand h;
    open_hand(&h, 300, false);
    ok(h.ctx, tz_brush_paint(h.g, (tz_vec2){150, 150}, 120, 0));
    finish(&h);
    for (int32_t k = 0; k < 6; k++) {
        const tz_vec2 at = {80 + 30 * k, 100 + 20 * k};
        ok(h.ctx, tz_brush_erase(h.g, at, 12, NULL));
        ok(h.ctx, tz_brush_paint(h.g, at, 15, 0));
        finish(&h);
    }
    assert_int_equal(h.out.sample.n, h.out.element.n);
    for (int32_t i = 0; i < h.out.element.n; i++) {
        const tz_element *e = &h.out.element.v[i];
        const tz_element *from = &h.ex.element.v[e->source];
        assert_int_equal(e->kind, from->kind);
        assert_true(e->radius == from->radius);
        assert_true(h.out.sample.v[e->sample].at.x == e->at.x);
        assert_true(h.out.sample.v[e->sample].at.y == e->at.y);
    }
    close_hand(&h);
}

static void test_relax(void **state)
{
    (void)state;
    hand h;
    const tz_vec2 at = {150, 150};
    open_hand(&h, 300, false);
    ok(h.ctx, tz_brush_paint(h.g, at, 250, 0));
    finish(&h);
    tz_vec3 *was = calloc((size_t)h.out.element.n, sizeof *was);
    int32_t moved = 0;
    for (int32_t i = 0; i < h.out.element.n; i++)
        was[i] = h.out.element.v[i].at;
    for (int32_t k = 0; k < 5; k++)
        ok(h.ctx, tz_brush_relax(h.g, at, 40));
    for (int32_t i = 0; i < h.out.element.n; i++) {
        const tz_vec3 p = h.out.element.v[i].at;
        const bool same = p.x == was[i].x && p.y == was[i].y;
        /* neighbours of what is relaxed may yield a little */
        assert_true(same || hypot(was[i].x - at.x, was[i].y - at.y) < 40 + 40);
        moved += !same;
    }
    assert_true(moved > 10);
    free(was);
    close_hand(&h);
}

static void test_fixed_and_stop(void **state)
{
    (void)state;
    hand h;
    bool more;
    int32_t removed;
    open_hand(&h, 400, false);
    ok(h.ctx, tz_brush_paint(h.g, (tz_vec2){200, 200}, 150, 0));
    ok(h.ctx, tz_growth_step(h.g, 60, &more));
    assert_true(more);
    const int32_t n = h.out.element.n;
    tz_brush_stop(h.g);
    ok(h.ctx, tz_growth_step(h.g, 1000, &more));
    assert_false(more);
    assert_int_equal(h.out.element.n, n);
    tz_growth_end(h.g);
    h.g = NULL;
    for (int32_t i = 0; i < n; i++)
        h.out.element.v[i].fixed = true;
    const tz_growth_texture all = {.scale = 1};
    const tz_growth_params p = growing_params();
    ok(h.ctx, tz_brush_begin(h.ctx, &h.ex, &all, 1, &p, &h.out, &h.g));
    ok(h.ctx, tz_brush_erase(h.g, (tz_vec2){200, 200}, 300, &removed));
    assert_int_equal(removed, 0);
    assert_int_equal(h.out.element.n, n);
    close_hand(&h);
}

/* Two textures of one palette: what is painted with one is of that one. */
static void test_textures(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set palette, out;
    tz_growth *g = NULL;
    bool more = true;
    const tz_domain d = {.size = {400, 200, 0}};
    const tz_growth_texture two[2] = {{.from = {0, 0}, .to = {100, 100}},
                                      {.from = {100, 0}, .to = {200, 100}}};
    const tz_growth_params p = growing_params();
    ok(ctx, growing_palette(ctx, &palette));
    ok(ctx, tz_element_set_like(ctx, &palette, &d, &out));
    ok(ctx, tz_brush_begin(ctx, &palette, two, 2, &p, &out, &g));
    ok(ctx, tz_brush_paint(g, (tz_vec2){110, 100}, 60, 0));
    ok(ctx, tz_brush_paint(g, (tz_vec2){290, 100}, 60, 1));
    while (more)
        ok(ctx, tz_growth_step(g, 100, &more));
    int32_t n[2] = {0, 0};
    for (int32_t i = 0; i < out.element.n; i++) {
        const tz_element *e = &out.element.v[i];
        assert_int_equal(e->at.x < 200 ? 0 : 1, e->kind);
        n[e->kind]++;
    }
    growing_near(n[0], TZ_PI * 3600 / 100, 0.15);
    growing_near(n[1], TZ_PI * 3600 / 25, 0.15);
    fails(ctx, tz_brush_paint(g, (tz_vec2){1, 1}, 10, 2), TZ_INVALID, "texture 2 of 2");
    fails(ctx, tz_brush_paint(g, (tz_vec2){1, 1}, 0, 1), TZ_INVALID, "above 0");
    fails(ctx, tz_brush_erase(g, (tz_vec2){NAN, 1}, 2, NULL), TZ_INVALID, "above 0");
    fails(ctx, tz_brush_relax(g, (tz_vec2){1, 1}, -2), TZ_INVALID, "above 0");
    fails(ctx, tz_brush_fill(g, (tz_vec2){1, INFINITY}, 0, NULL), TZ_INVALID, "brush");
    tz_growth_end(g);
    tz_element_set_deinit(&palette);
    tz_element_set_deinit(&out);
    end_ctx(ctx);
}

static tz_status draw_by_hand(tz_ctx *ctx, tz_element_set *ex, tz_element_set *out)
{
    tz_growth *g = NULL;
    bool more = true;
    const tz_growth_texture all = {.scale = 1};
    const tz_growth_params p = growing_params();
    tz_status s = tz_brush_begin(ctx, ex, &all, 1, &p, out, &g);
    for (int32_t k = 0; k < 4 && s == TZ_OK; k++)
        s = tz_brush_paint(g, (tz_vec2){30 + 10 * k, 40}, 22, 0);
    if (s == TZ_OK)
        s = tz_growth_step(g, 8, &more);
    if (s == TZ_OK)
        s = tz_brush_erase(g, (tz_vec2){40, 40}, 9, NULL);
    if (s == TZ_OK)
        s = tz_brush_fill(g, (tz_vec2){40, 40}, 0, NULL);
    while (s == TZ_OK && more)
        s = tz_growth_step(g, 30, &more);
    if (s == TZ_OK)
        s = tz_brush_relax(g, (tz_vec2){40, 40}, 20);
    tz_growth_end(g);
    return s;
}

static tz_status small(tz_ctx *ctx)
{
    tz_element_set ex, out;
    const tz_domain d = {.size = {90, 80, 0}};
    tz_status s = drawn_squares(ctx, 6, 2, false, &ex);
    if (s != TZ_OK)
        return s;
    s = tz_element_set_like(ctx, &ex, &d, &out);
    if (s == TZ_OK) {
        s = draw_by_hand(ctx, &ex, &out);
        if (s == TZ_OK)
            s = tz_element_set_check(ctx, &out, "output");
        tz_element_set_deinit(&out);
    }
    tz_element_set_deinit(&ex);
    return s;
}

static void test_out_of_memory(void **state)
{
    (void)state;
    survive(small, 1);
}

static void test_same_bytes(void **state)
{
    (void)state;
    uint64_t first = 0;
    static const int threads[] = {1, 2, 8};
    for (int k = 0; k < 3; k++) {
        tz_ctx *ctx = new_ctx(threads[k]);
        tz_element_set ex, out;
        const tz_domain d = {.size = {90, 80, 0}};
        ok(ctx, drawn_darts(ctx, 80, 8, 300, 2, false, &ex));
        ok(ctx, tz_element_set_like(ctx, &ex, &d, &out));
        ok(ctx, draw_by_hand(ctx, &ex, &out));
        const uint64_t h = growing_digest(&out);
        assert_true(out.element.n > 10);
        assert_true(k == 0 || h == first);
        first = h;
        tz_element_set_deinit(&ex);
        tz_element_set_deinit(&out);
        end_ctx(ctx);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_paint),          cmocka_unit_test(test_erase),
        cmocka_unit_test(test_whole),          cmocka_unit_test(test_relax),
        cmocka_unit_test(test_fixed_and_stop), cmocka_unit_test(test_textures),
        cmocka_unit_test(test_out_of_memory),  cmocka_unit_test(test_same_bytes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
