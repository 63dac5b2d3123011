/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * After an edit the dirty rectangle, grown by the compositor's reach and rendered again,
 * makes the picture that a rendering of everything makes. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/rng.h"
#include "tests/support/pictures.h"
#include "tests/support/scenes.h"

static tz_rect whole_of(const tz_layout *l)
{
    return (tz_rect){0, 0, l->width, l->height};
}

static void copy_into(tz_image *to, const tz_image *part, tz_rect r)
{
    for (int32_t y = 0; y < r.h; y++)
        memcpy(tz_image_at(to, r.x, r.y + y), tz_image_at(part, 0, y),
               (size_t)r.w * (size_t)to->channels * sizeof(float));
}

/* Renders the dirty rectangle grown by the reach into `shown`; on a torus what leaves the
 * layout comes in at the other side. */
static void refresh(tz_ctx *ctx, const tz_layout *l, const tz_image *photo, tz_rect dirty,
                    tz_image *shown)
{
    if (tz_rect_empty(dirty))
        return;
    const int32_t reach = tz_composer_reach();
    tz_rect r = {dirty.x - reach, dirty.y - reach, dirty.w + 2 * reach,
                 dirty.h + 2 * reach};
    for (int j = -1; j <= 1; j++)
        for (int i = -1; i <= 1; i++) {
            if (!l->tile && (i || j))
                continue;
            tz_rect q = {r.x + i * l->width, r.y + j * l->height, r.w, r.h};
            q = tz_rect_intersect(q, whole_of(l));
            if (tz_rect_empty(q))
                continue;
            tz_image part = render_colour(ctx, l, photo, q);
            copy_into(shown, &part, q);
            tz_image_deinit(&part);
        }
}

static void random_edit(tz_layout_edit *e, const tz_layout *l, tz_rng *r, tz_rect *dirty)
{
    const int32_t id = 1 + tz_rng_below(r, l->place.n - 1); /* the floor stays */
    tz_status s = TZ_OK;
    *dirty = (tz_rect){0};
    if (l->place.v[id].removed)
        return;
    switch (tz_rng_below(r, 7)) {
    case 0:
        s = tz_layout_edit_move(
            e, id, (tz_vec2){tz_rng_range(r, -60, 60), tz_rng_range(r, -60, 60)}, dirty);
        break;
    case 1: s = tz_layout_edit_rotate(e, id, tz_rng_range(r, -3, 3), dirty); break;
    case 2: s = tz_layout_edit_scale(e, id, tz_rng_range(r, 0.5, 1.6), dirty); break;
    case 3: s = tz_layout_edit_remove(e, id, dirty); break;
    case 4:
        s = tz_layout_edit_map(
            e, id,
            turned((tz_vec2){60, 50},
                   (tz_vec2){tz_rng_below(r, l->width), tz_rng_below(r, l->height)}, 30,
                   1, true),
            dirty);
        break;
    case 5: {
        const tz_point b[] = {{20, 20}, {90, 30}, {60, 90}};
        s = tz_layout_edit_place(
            e, 0, -1, move_by(tz_rng_below(r, l->width), tz_rng_below(r, l->height)), b,
            3, NULL, dirty);
        break;
    }
    default:
        if (tz_layout_edit_can_undo(e))
            s = tz_layout_edit_undo(e, dirty);
        break;
    }
    assert_int_equal(s, TZ_OK);
}

static void check_edits(bool tile, int32_t w, int32_t h, int rounds)
{
    tz_ctx *ctx = new_ctx(2);
    tz_image photo = picture(ctx, PICTURE_STONES, 130, 110, 3, 1);
    tz_layout l;
    scene_init(ctx, &l, w, h, tile, 130, 110);
    scene_random(&l, 50, 11);
    tz_layout_edit *e = NULL;
    assert_int_equal(tz_layout_edit_new(&l, &e), TZ_OK);
    tz_image first = render_colour(ctx, &l, &photo, (tz_rect){0}), shown;
    assert_int_equal(tz_image_copy(ctx, &first, &shown), TZ_OK);
    tz_rng r = tz_rng_make(7, tile);
    int64_t changed = 0;
    for (int k = 0; k < rounds; k++) {
        tz_rect dirty;
        random_edit(e, &l, &r, &dirty);
        refresh(ctx, &l, &photo, dirty, &shown);
        tz_image again = render_colour(ctx, &l, &photo, (tz_rect){0});
        const int64_t wrong = pixels_that_differ(&shown, &again);
        if (wrong)
            fail_msg("edit %d: %d px differ, dirty %d,%d,%d,%d", k, (int)wrong, dirty.x,
                     dirty.y, dirty.w, dirty.h);
        changed += pixels_that_differ(&again, &first) != 0;
        tz_image_deinit(&again);
    }
    assert_true(changed > rounds / 2);
    /* all undone: the first picture */
    tz_rect dirty;
    while (tz_layout_edit_can_undo(e)) {
        assert_int_equal(tz_layout_edit_undo(e, &dirty), TZ_OK);
        refresh(ctx, &l, &photo, dirty, &shown);
    }
    assert_int_equal(pixels_that_differ(&shown, &first), 0);
    tz_image_deinit(&first);
    tz_image_deinit(&shown);
    tz_layout_edit_free(e);
    tz_image_deinit(&photo);
    tz_layout_deinit(&l);
    tz_ctx_free(ctx);
}

static void test_edits(void **state)
{
    (void)state;
    check_edits(false, 1100, 700, 10);
}

static void test_edits_on_a_torus(void **state)
{
    (void)state;
    check_edits(true, 1056, 640, 8);
    check_edits(true, 1101, 607, 8);
}

/* A brush stroke must not redraw the world. */
static void test_reach_is_bounded(void **state)
{
    (void)state;
    assert_in_range(tz_composer_reach(), 1, 1024);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_edits),
        cmocka_unit_test(test_edits_on_a_torus),
        cmocka_unit_test(test_reach_is_bounded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
