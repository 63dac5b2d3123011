/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Layouts in memory and hand placement. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/rng.h"
#include "synthesis/layout.h"

static const tz_point square[] = {{0, 0}, {10, 0}, {10, 10}, {0, 10}};

static tz_affine move(double x, double y) { return (tz_affine){1, 0, 0, 1, x, y}; }

static void make(tz_ctx *ctx, tz_layout *l, bool tile)
{
    assert_int_equal(tz_layout_init(ctx, l, 100, 80, tile), TZ_OK);
    assert_int_equal(tz_layout_add_source(l, "photo.jpg", NULL, 64, 48, NULL), TZ_OK);
}

static void assert_rect(tz_rect r, int x, int y, int w, int h)
{
    assert_int_equal(r.x, x);
    assert_int_equal(r.y, y);
    assert_int_equal(r.w, w);
    assert_int_equal(r.h, h);
}

static void test_add(void **state)
{
    (void)state;
    tz_layout l;
    int32_t id = -1;
    tz_ctx *ctx = NULL;
    assert_int_equal(tz_ctx_new(NULL, &ctx), TZ_OK);
    assert_int_equal(tz_layout_init(ctx, &l, 0, 5, false), TZ_INVALID);
    assert_int_equal(tz_layout_init(ctx, &l, 5, TZ_IMAGE_MAX_SIDE + 1, false),
                     TZ_INVALID);
    make(ctx, &l, false);
    assert_int_equal(tz_layout_add_source(&l, "", NULL, 1, 1, NULL), TZ_INVALID);
    assert_int_equal(tz_layout_add_source(&l, "a", "xyz", 1, 1, NULL), TZ_INVALID);
    assert_int_equal(tz_layout_add_source(&l, "a", NULL, 0, 1, NULL), TZ_INVALID);
    assert_int_equal(l.source.n, 1);
    assert_int_equal(tz_layout_add(&l, 1, 0, move(0, 0), square, 4, &id), TZ_INVALID);
    assert_int_equal(tz_layout_add(&l, -1, 0, move(0, 0), square, 4, &id), TZ_INVALID);
    assert_int_equal(tz_layout_add(&l, 0, 0, move(0, 0), square, 2, &id), TZ_INVALID);
    assert_int_equal(tz_layout_add(&l, 0, 0, move(NAN, 0), square, 4, &id), TZ_INVALID);
    assert_int_equal(tz_layout_add(&l, 0, 0, (tz_affine){0}, square, 4, &id), TZ_INVALID);
    tz_point bad[] = {{0, 0}, {INFINITY, 0}, {1, 1}};
    assert_int_equal(tz_layout_add(&l, 0, 0, move(0, 0), bad, 3, &id), TZ_INVALID);
    assert_int_equal(id, -1);
    assert_int_equal(l.place.n, 0);
    assert_int_equal(l.border.n, 0);
    assert_int_equal(tz_layout_add(&l, 0, 7, move(20, 30), square, 4, &id), TZ_OK);
    assert_int_equal(id, 0);
    assert_rect(tz_layout_box(&l, 0), 20, 30, 10, 10);
    /* border taken from the layout's own pool, which moves while it grows */
    for (int i = 1; i < 2000; i++)
        assert_int_equal(tz_layout_add(&l, 0, i, move(i * 0.01, 0), l.border.v, 4, &id),
                         TZ_OK);
    assert_int_equal(memcmp(l.border.v + l.border.n - 4, square, sizeof square), 0);
    tz_layout_deinit(&l);
    tz_layout_deinit(&l);
    tz_ctx_free(ctx);
}

static void test_box_rounds_outwards(void **state)
{
    (void)state;
    tz_layout l;
    make(NULL, &l, false);
    tz_layout_add(&l, 0, 0, move(0.25, -0.25), square, 4, NULL);
    assert_rect(tz_layout_box(&l, 0), 0, -1, 11, 11);
    tz_affine huge = {1e30, 0, 0, 1e30, 1e30, -1e30};
    assert_int_equal(tz_layout_add(&l, 0, 0, huge, square, 4, NULL), TZ_OK);
    tz_rect r = tz_layout_box(&l, 1);
    assert_true(r.w >= 0 && r.h >= 0); /* clamped, and no overflow */
    tz_layout_deinit(&l);
}

static void test_at(void **state)
{
    (void)state;
    for (int tile = 0; tile < 2; tile++) {
        tz_layout l;
        make(NULL, &l, tile);
        tz_layout_add(&l, 0, 0, move(20, 30), square, 4, NULL);
        tz_layout_add(&l, 0, 1, move(25, 35), square, 4, NULL);
        tz_layout_add(&l, 0, 2, move(95, 75), square, 4, NULL);
        assert_int_equal(tz_layout_at(&l, (tz_vec2){21, 31}), 0);
        assert_int_equal(tz_layout_at(&l, (tz_vec2){27, 37}), 1);
        assert_int_equal(tz_layout_at(&l, (tz_vec2){50, 50}), -1);
        assert_int_equal(tz_layout_at(&l, (tz_vec2){99, 79}), 2);
        assert_int_equal(tz_layout_at(&l, (tz_vec2){1, 1}), tile ? 2 : -1);
        assert_int_equal(tz_layout_at(&l, (tz_vec2){121, 111}), tile ? 0 : -1);
        assert_int_equal(tz_layout_at(&l, (tz_vec2){-79, -49}), tile ? 0 : -1);
        assert_int_equal(tz_layout_at(&l, (tz_vec2){NAN, 0}), -1);
        l.place.v[1].removed = 1;
        assert_int_equal(tz_layout_at(&l, (tz_vec2){27, 37}), 0);
        tz_layout_deinit(&l);
    }
}

static void test_compact(void **state)
{
    (void)state;
    tz_layout l;
    make(NULL, &l, false);
    for (int i = 0; i < 100; i++) {
        tz_point b[] = {{0, 0}, {(float)i, 1}, {3, 3}};
        tz_layout_add(&l, 0, i, move(i, 0), b, 3, NULL);
    }
    for (int i = 0; i < 100; i++)
        l.place.v[i].removed = i % 3 == 0;
    assert_int_equal(tz_layout_compact(&l), TZ_OK);
    assert_int_equal(l.place.n, 66);
    assert_int_equal(l.border.n, 198);
    for (int i = 0; i < l.place.n; i++) {
        const tz_placement *p = &l.place.v[i];
        assert_int_equal(p->group % 3 != 0, 1);
        assert_true(l.border.v[p->border + 1].x == (float)p->group);
        assert_true(p->map.e == p->group);
    }
    tz_layout_deinit(&l);
}

/* ---- editing --------------------------------------------------------------------- */

static void test_dirty(void **state)
{
    (void)state;
    tz_layout l;
    tz_layout_edit *e;
    tz_rect d;
    int32_t id;
    tz_ctx *ctx = NULL;
    assert_int_equal(tz_ctx_new(NULL, &ctx), TZ_OK);
    make(ctx, &l, false);
    assert_int_equal(tz_layout_edit_new(&l, &e), TZ_OK);
    assert_int_equal(tz_layout_edit_undo(e, &d), TZ_INVALID);
    assert_int_equal(tz_layout_edit_redo(e, &d), TZ_INVALID);
    assert_int_equal(tz_layout_edit_place(e, 0, 3, move(20, 30), square, 4, &id, &d),
                     TZ_OK);
    assert_rect(d, 20, 30, 10, 10);
    assert_int_equal(l.place.v[id].fixed, 1);
    assert_int_equal(tz_layout_edit_move(e, id, (tz_vec2){5, -2}, &d), TZ_OK);
    assert_rect(d, 20, 28, 15, 12);
    assert_int_equal(tz_layout_edit_rotate(e, id, TZ_PI / 2, &d), TZ_OK);
    tz_rect b =
        tz_layout_box(&l, id); /* about its centre: rounding apart, the same box */
    assert_true(b.x >= 24 && b.x + b.w <= 36 && b.y >= 27 && b.y + b.h <= 39);
    assert_int_equal(tz_layout_edit_scale(e, id, 2, &d), TZ_OK);
    assert_true(d.x <= 20 && d.y <= 23 && d.x + d.w >= 40 && d.y + d.h >= 43);
    assert_int_equal(tz_layout_edit_scale(e, id, 0, &d), TZ_INVALID);
    assert_int_equal(tz_layout_edit_scale(e, id, NAN, &d), TZ_INVALID);
    assert_int_equal(tz_layout_edit_move(e, id, (tz_vec2){INFINITY, 0}, &d), TZ_INVALID);
    assert_int_equal(tz_layout_edit_map(e, id, move(-500, -500), &d), TZ_OK);
    assert_true(d.x <= 20 && d.x + d.w >= 40); /* where it was; it went outside */
    assert_int_equal(tz_layout_edit_move(e, id, (tz_vec2){1, 1}, &d), TZ_OK);
    assert_true(tz_rect_empty(d));
    assert_int_equal(tz_layout_edit_remove(e, id, &d), TZ_OK);
    assert_true(tz_rect_empty(d));
    assert_int_equal(tz_layout_edit_remove(e, id, &d), TZ_INVALID);
    assert_int_equal(tz_layout_edit_move(e, 99, (tz_vec2){1, 1}, &d), TZ_INVALID);
    assert_int_equal(tz_layout_edit_place(e, 5, 3, move(0, 0), square, 4, &id, &d),
                     TZ_INVALID);
    for (int i = 0; i < 7; i++)
        assert_int_equal(tz_layout_edit_undo(e, &d), TZ_OK);
    assert_int_equal(tz_layout_edit_undo(e, &d), TZ_INVALID);
    assert_rect(d, 20, 30, 10, 10);
    assert_int_equal(l.place.v[id].removed, 1);
    assert_int_equal(tz_layout_edit_redo(e, &d), TZ_OK);
    assert_rect(d, 20, 30, 10, 10);
    tz_layout_edit_free(e);
    tz_layout_edit_free(NULL);
    tz_layout_deinit(&l);
    tz_ctx_free(ctx);
}

static void test_dirty_on_torus(void **state)
{
    (void)state;
    tz_layout l;
    tz_layout_edit *e;
    tz_rect d;
    int32_t id;
    make(NULL, &l, true);
    assert_int_equal(tz_layout_edit_new(&l, &e), TZ_OK);
    assert_int_equal(tz_layout_edit_place(e, 0, 3, move(20, 30), square, 4, &id, &d),
                     TZ_OK);
    assert_rect(d, 20, 30, 10, 10);
    assert_int_equal(tz_layout_edit_map(e, id, move(95, 30), &d), TZ_OK);
    assert_rect(d, 0, 0, 100, 80);
    assert_int_equal(tz_layout_edit_undo(e, &d), TZ_OK);
    assert_rect(d, 0, 0, 100, 80);
    tz_layout_edit_free(e);
    tz_layout_deinit(&l);
}

/** A picture of the layout: which placement shows at each pixel. */
static int32_t *draw(const tz_layout *l)
{
    int32_t *px = malloc(sizeof *px * (size_t)(l->width * l->height));
    for (int y = 0; y < l->height; y++)
        for (int x = 0; x < l->width; x++)
            px[y * l->width + x] = tz_layout_at(l, (tz_vec2){x + 0.5, y + 0.5});
    return px;
}

/** Random edits, undos and redos. After each, nothing has changed outside of the dirty
 * rectangle; in the end the layout equals one to which the edits still standing were
 * applied by a second journal. */
static void test_random_walk(void **state)
{
    (void)state;
    enum { STEPS = 300 };
    for (int run = 0; run < 6; run++) {
        tz_layout l, m;
        tz_layout_edit *e, *f;
        tz_rect d;
        struct {
            int kind;
            int32_t id;
            tz_affine map;
        } log[STEPS];
        int now = 0, top = 0;
        tz_rng rng = tz_rng_make(7, (uint64_t)run);
        make(NULL, &l, run & 1);
        make(NULL, &m, run & 1);
        assert_int_equal(tz_layout_edit_new(&l, &e), TZ_OK);
        assert_int_equal(tz_layout_edit_new(&m, &f), TZ_OK);
        int32_t *before = draw(&l);
        for (int step = 0; step < STEPS; step++) {
            int kind = tz_rng_below(&rng, 9);
            int32_t id = l.place.n ? tz_rng_below(&rng, l.place.n) : -1;
            tz_status st;
            d = (tz_rect){0};
            if (kind < 2) {
                st = tz_layout_edit_undo(e, &d);
                assert_int_equal(st, now ? TZ_OK : TZ_INVALID);
                now -= now > 0;
            } else if (kind == 2) {
                assert_int_equal(tz_layout_edit_can_redo(e), now < top);
                st = tz_layout_edit_redo(e, &d);
                assert_int_equal(st, now < top ? TZ_OK : TZ_INVALID);
                now += now < top;
            } else {
                tz_affine map = tz_affine_place(
                    (tz_vec2){5, 5},
                    (tz_vec2){tz_rng_range(&rng, -10, 110), tz_rng_range(&rng, -10, 90)},
                    tz_rng_range(&rng, 0, 6), tz_rng_range(&rng, 0.5, 2), false);
                if (kind < 6)
                    st = tz_layout_edit_place(e, 0, step, map, square, 4, &id, &d);
                else if (kind == 6)
                    st = tz_layout_edit_remove(e, id, &d);
                else
                    st = tz_layout_edit_map(e, id, map, &d);
                if (!st) {
                    log[now].kind = kind;
                    log[now].id = id;
                    log[now++].map = map;
                    top = now;
                } else {
                    d = (tz_rect){0};
                }
            }
            int32_t *after = draw(&l);
            for (int y = 0; y < l.height; y++)
                for (int x = 0; x < l.width; x++)
                    if (x < d.x || y < d.y || x >= d.x + d.w || y >= d.y + d.h)
                        assert_int_equal(before[y * l.width + x], after[y * l.width + x]);
            free(before);
            before = after;
        }
        int32_t *id_of = calloc((size_t)l.place.n + 1, sizeof *id_of);
        for (int i = 0; i < now; i++) {
            int32_t id = log[i].id;
            if (log[i].kind < 6) {
                assert_int_equal(tz_layout_edit_place(f, 0, l.place.v[id].group,
                                                      log[i].map, square, 4, &id_of[id],
                                                      &d),
                                 TZ_OK);
            } else if (log[i].kind == 6) {
                assert_int_equal(tz_layout_edit_remove(f, id_of[id], &d), TZ_OK);
            } else {
                assert_int_equal(tz_layout_edit_map(f, id_of[id], log[i].map, &d), TZ_OK);
            }
        }
        assert_int_equal(tz_layout_compact(&l), TZ_OK);
        assert_int_equal(tz_layout_compact(&m), TZ_OK);
        assert_int_equal(l.place.n, m.place.n);
        for (int i = 0; i < l.place.n; i++) {
            const tz_placement *p = &l.place.v[i], *q = &m.place.v[i];
            assert_memory_equal(&p->map, &q->map, sizeof p->map);
            assert_int_equal(p->group, q->group);
            assert_int_equal(p->fixed, q->fixed);
        }
        free(before);
        free(id_of);
        tz_layout_edit_free(e);
        tz_layout_edit_free(f);
        tz_layout_deinit(&l);
        tz_layout_deinit(&m);
    }
}

/** Each allocation fails in turn; what could not be done has changed nothing. */
static void test_allocation_failures(void **state)
{
    (void)state;
    for (int64_t fail = 1;; fail++) {
        tz_ctx *ctx = NULL;
        tz_ctx_options opt = {.threads = 1, .fail_alloc = fail};
        tz_layout l = {0};
        tz_layout_edit *e = NULL;
        tz_rect d;
        if (tz_ctx_new(&opt, &ctx))
            continue;
        tz_status st = tz_layout_init(ctx, &l, 100, 80, false);
        if (!st)
            st = tz_layout_add_source(&l, "photo.jpg", NULL, 64, 48, NULL);
        if (!st)
            st = tz_layout_edit_new(&l, &e);
        for (int i = 0; i < 40 && !st; i++) {
            int32_t n = l.place.n, points = l.border.n;
            st = tz_layout_edit_place(e, 0, i, move(i, i), square, 4, NULL, &d);
            if (st) {
                assert_int_equal(l.place.n, n);
                assert_int_equal(l.border.n, points);
            }
            if (!st)
                st = tz_layout_edit_move(e, i, (tz_vec2){1, 1}, &d);
            if (!st && i % 2)
                st = tz_layout_edit_remove(e, i, &d);
        }
        tz_layout_edit_free(e);
        int32_t n = l.place.n;
        if (!st) {
            st = tz_layout_compact(&l);
            assert_int_equal(l.place.n, st ? n : n / 2);
        }
        tz_layout_deinit(&l);
        assert_int_equal(tz_ctx_memory_used(ctx), 0);
        tz_ctx_free(ctx);
        if (!st)
            break;
        assert_int_equal(st, TZ_NOMEM);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_add),         cmocka_unit_test(test_box_rounds_outwards),
        cmocka_unit_test(test_at),          cmocka_unit_test(test_compact),
        cmocka_unit_test(test_dirty),       cmocka_unit_test(test_dirty_on_torus),
        cmocka_unit_test(test_random_walk), cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
