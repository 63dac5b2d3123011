/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Arrangement: covers, repeats itself under a seed whatever the threads, wraps on a
 * torus, keeps what the artist fixed. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/arranged.h"

static tz_ctx *ctx;
static arranged_source stones, bricks;

static int set_up(void **state)
{
    (void)state;
    ctx = new_ctx(2);
    source_init(ctx, &stones, PICTURE_STONES, 240, 200, 1);
    source_init(ctx, &bricks, PICTURE_BRICKS, 260, 200, 1);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    source_deinit(&stones);
    source_deinit(&bricks);
    tz_ctx_free(ctx);
    return 0;
}

/* Bare specks between borders are smaller than a cell of the growing canvas and few. */
static void assert_covered(const tz_layout *l)
{
    double farthest;
    const int64_t n = bare_pixels(l, &farthest);
    const double all = (double)l->width * l->height;
    if (farthest > 6 || n > 0.005 * all + 4)
        fail_msg("%d of %.0f px are in no border, the farthest by %g px", (int)n, all,
                 farthest);
}

static void test_covers(void **state)
{
    (void)state;
    static const int32_t sizes[][2] = {{600, 500}, {333, 777}, {64, 1500}, {97, 61}};
    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++)
        for (int tile = 0; tile < 2; tile++) {
            const arranged_source *s = k & 1 ? &bricks : &stones;
            const tz_arrange_params p =
                arrange_params(sizes[k][0], sizes[k][1], 3 + k, tile);
            tz_layout l;
            arrange_one(ctx, s, NULL, &p, &l);
            assert_int_equal(l.width, sizes[k][0]);
            assert_int_equal(l.height, sizes[k][1]);
            assert_int_equal(l.tile, tile);
            assert_sound(&l, &s->exemplar, 1, 2);
            assert_covered(&l);
            /* and the compositor knows a piece for every pixel */
            tz_composer *c = NULL;
            int32_t *label = malloc(sizeof *label * (size_t)l.width * (size_t)l.height);
            assert_int_equal(
                tz_composer_new(ctx, &l, &s->photo, 1, TZ_MAP_COLOUR, NULL, &c), TZ_OK);
            assert_int_equal(
                tz_composer_labels(ctx, c, (tz_rect){0, 0, l.width, l.height}, label),
                TZ_OK);
            for (int32_t i = 0; i < l.width * l.height; i++)
                assert_in_range(label[i], 0, l.place.n - 1);
            free(label);
            tz_composer_free(c);
            tz_layout_deinit(&l);
        }
}

/* The same bytes at 1, 2 and 8 threads, and again; tall enough that the strips' memory is
 * used over and over. */
static void test_deterministic(void **state)
{
    (void)state;
    static const struct {
        int32_t w, h;
        bool tile;
        double piece;
    } cases[] = {{400, 380, false, 0},
                 {400, 380, true, 0},
                 {120, 2600, false, 32},
                 {1000, 200, false, 40},
                 {200, 300, true, 30}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        tz_arrange_params p = arrange_params(cases[k].w, cases[k].h, 7, cases[k].tile);
        p.piece = cases[k].piece;
        p.effort = 1;
        uint64_t first = 0;
        static const int threads[] = {1, 2, 8, 1};
        for (int t = 0; t < 4; t++) {
            tz_ctx *own = new_ctx(threads[t]);
            tz_layout l;
            arrange_one(own, &stones, NULL, &p, &l);
            const uint64_t h = layout_hash(&l);
            if (t == 0)
                first = h;
            else if (h != first)
                fail_msg("case %d: %d threads give another layout than one", (int)k,
                         threads[t]);
            tz_layout_deinit(&l);
            tz_ctx_free(own);
        }
    }
}

static void test_seeds(void **state)
{
    (void)state;
    uint64_t hash[6];
    static const uint64_t seeds[] = {0, 1, 2, 1ULL << 32, UINT64_MAX, 1};
    for (int k = 0; k < 6; k++) {
        tz_arrange_params p = arrange_params(300, 260, seeds[k], false);
        p.effort = 2;
        tz_layout l;
        arrange_one(ctx, &stones, NULL, &p, &l);
        hash[k] = layout_hash(&l);
        for (int j = 0; j < k; j++)
            assert_true((hash[j] == hash[k]) == (seeds[j] == seeds[k]));
        tz_layout_deinit(&l);
    }
}

/* The exemplar is analyzed anew: nothing hangs on addresses. */
static void test_repeats_from_the_photo(void **state)
{
    (void)state;
    const tz_arrange_params p = arrange_params(300, 260, 5, false);
    uint64_t hash[2];
    for (int k = 0; k < 2; k++) {
        arranged_source s;
        tz_layout l;
        source_init(ctx, &s, PICTURE_STONES, 200, 190, 4);
        arrange_one(ctx, &s, NULL, &p, &l);
        hash[k] = layout_hash(&l);
        tz_layout_deinit(&l);
        source_deinit(&s);
    }
    assert_true(hash[0] == hash[1]);
}

/* On a torus the picture goes on across its borders as it does inside. */
static void test_torus(void **state)
{
    (void)state;
    static const int32_t sizes[][2] = {{512, 400}, {402, 398}};
    for (int k = 0; k < 2; k++) {
        const int32_t w = sizes[k][0], h = sizes[k][1];
        const tz_arrange_params p = arrange_params(w, h, 2, true);
        tz_layout l;
        arrange_one(ctx, &stones, NULL, &p, &l);
        int crossing = 0;
        for (int32_t i = 0; i < l.place.n; i++) {
            const tz_rect b = tz_layout_box(&l, i);
            crossing += b.x < 0 || b.y < 0 || b.x + b.w > w || b.y + b.h > h;
        }
        assert_true(crossing > 3);
        tz_image out = render_colour(ctx, &l, &stones.photo, (tz_rect){0});
        double inside = 0, across = 0, down = 0, down_across = 0;
        for (int32_t y = 0; y < h; y++) {
            for (int32_t x = 1; x < w; x++)
                inside +=
                    fabs(tz_image_at(&out, x, y)[1] - tz_image_at(&out, x - 1, y)[1]);
            across += fabs(tz_image_at(&out, 0, y)[1] - tz_image_at(&out, w - 1, y)[1]);
        }
        for (int32_t x = 0; x < w; x++) {
            for (int32_t y = 1; y < h; y++)
                down += fabs(tz_image_at(&out, x, y)[1] - tz_image_at(&out, x, y - 1)[1]);
            down_across +=
                fabs(tz_image_at(&out, x, 0)[1] - tz_image_at(&out, x, h - 1)[1]);
        }
        inside /= w - 1, down /= h - 1;
        if (across > 1.6 * inside || down_across > 1.6 * down)
            fail_msg(
                "%d x %d: steps across the wrap are %.2f and %.2f times those inside", w,
                h, across / inside, down_across / down);
        tz_image_deinit(&out);
        tz_layout_deinit(&l);
    }
}

/* Pieces of all sorts are used, none far more than its share. */
static void test_variety(void **state)
{
    (void)state;
    tz_arrange_params p = arrange_params(1000, 900, 2, false);
    p.effort = 1;
    tz_layout l;
    arrange_one(ctx, &stones, NULL, &p, &l);
    const int32_t n = stones.ebpt.group.n;
    int32_t *count = calloc((size_t)n, sizeof *count), used = 0, most = 0;
    for (int32_t k = 0; k < l.place.n; k++)
        count[l.place.v[k].group]++;
    for (int32_t g = 0; g < n; g++) {
        used += count[g] > 0;
        most = count[g] > most ? count[g] : most;
    }
    assert_true(used >= 8 && used >= n / 4);
    assert_true(most <= 0.25 * l.place.n + 2);
    free(count);
    tz_layout_deinit(&l);
}

static void test_scale_and_rotation_ranges(void **state)
{
    (void)state;
    static const struct {
        double scale[2], rotation[2];
    } ranges[] = {{{1, 1}, {0, 0}}, {{0.7, 1.4}, {-20, 35}}, {{1.2, 1.3}, {90, 90}}};
    for (int k = 0; k < 3; k++)
        for (int mirror = 1; mirror <= 2; mirror++) {
            tz_arrange_params p = arrange_params(500, 400, 4, false);
            p.rotate_auto = false;
            memcpy(p.scale, ranges[k].scale, sizeof p.scale);
            memcpy(p.rotation, ranges[k].rotation, sizeof p.rotation);
            p.mirror = mirror;
            p.effort = 2;
            tz_layout l;
            int mirrored = 0;
            arrange_one(ctx, &stones, NULL, &p, &l);
            for (int32_t i = 0; i < l.place.n; i++) {
                double angle, scale;
                bool flip;
                map_parts(l.place.v[i].map, &angle, &scale, &flip);
                angle *= 180 / TZ_PI;
                mirrored += flip;
                if (!(scale >= p.scale[0] - 1e-9 && scale <= p.scale[1] + 1e-9))
                    fail_msg("placement %d is scaled by %g", i, scale);
                if (!(angle >= p.rotation[0] - 1e-6 && angle <= p.rotation[1] + 1e-6))
                    fail_msg("placement %d is turned by %g degrees", i, angle);
            }
            assert_true(mirror == 1 ? mirrored == 0 : mirrored > 0);
            tz_layout_deinit(&l);
        }
}

/* Two photos share one layout, and both are used. */
static void test_two_exemplars(void **state)
{
    (void)state;
    const tz_exemplar ex[2] = {stones.exemplar, bricks.exemplar};
    for (int tile = 0; tile < 2; tile++) {
        const tz_arrange_params p = arrange_params(600, 500, 4, tile);
        tz_layout l = {0};
        assert_int_equal(tz_arrange(ctx, ex, 2, NULL, &p, &l), TZ_OK);
        assert_sound(&l, ex, 2, 2);
        assert_covered(&l);
        int32_t count[2] = {0, 0};
        for (int32_t k = 0; k < l.place.n; k++)
            count[l.place.v[k].source]++;
        assert_true(count[0] > 0 && count[1] > 0);
        tz_layout_deinit(&l);
    }
}

/* What the artist fixed stays as it is, and the rest is grown around it. */
static void test_fixed_stay(void **state)
{
    (void)state;
    for (int tile = 0; tile < 2; tile++) {
        const tz_arrange_params p = arrange_params(500, 420, 9, tile);
        tz_layout l;
        arrange_one(ctx, &stones, NULL, &p, &l);
        tz_layout_edit *e = NULL;
        tz_rect dirty;
        tz_placement kept[3];
        assert_int_equal(tz_layout_edit_new(&l, &e), TZ_OK);
        for (int k = 0; k < 3; k++) {
            const int32_t id = (2 * k + 1) * l.place.n / 6;
            assert_int_equal(tz_layout_edit_rotate(e, id, 0.7 + k, &dirty), TZ_OK);
            assert_int_equal(tz_layout_edit_scale(e, id, 1.25, &dirty), TZ_OK);
            kept[k] = l.place.v[id];
        }
        tz_layout_edit_free(e);
        tz_arrange_params other = p;
        other.seed = 10;
        const tz_status s = tz_arrange(ctx, &stones.exemplar, 1, NULL, &other, &l);
        if (s != TZ_OK)
            fail_msg("arrange again: %s", tz_ctx_message(ctx));
        assert_covered(&l);
        int32_t fixed = 0;
        for (int32_t i = 0; i < l.place.n; i++)
            fixed += l.place.v[i].fixed;
        assert_int_equal(fixed, 3);
        for (int k = 0; k < 3; k++) {
            int found = 0;
            for (int32_t i = 0; i < l.place.n; i++)
                found += l.place.v[i].fixed && l.place.v[i].group == kept[k].group &&
                         memcmp(&l.place.v[i].map, &kept[k].map, sizeof kept[k].map) == 0;
            assert_int_equal(found, 1);
        }
        tz_layout_deinit(&l);
    }
}

/* An existing layout of another size, or that another photo was used for, is refused. */
static void test_fixed_of_another_layout(void **state)
{
    (void)state;
    for (int k = 0; k < 3; k++) {
        tz_layout l;
        scene_init(ctx, &l, k == 0 ? 301 : 300, 200, k == 1, 240, k == 2 ? 199 : 200);
        const int32_t id = scene_box(&l, 0, move_by(0, 0), 20, 20, 60, 60);
        l.place.v[id].fixed = 1;
        const uint64_t before = layout_hash(&l);
        const tz_arrange_params p = arrange_params(300, 200, 1, false);
        assert_int_equal(tz_arrange(ctx, &stones.exemplar, 1, NULL, &p, &l), TZ_INVALID);
        assert_true(tz_ctx_message(ctx)[0] != 0);
        tz_ctx_clear(ctx);
        assert_true(layout_hash(&l) == before); /* untouched */
        tz_layout_deinit(&l);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_covers),
        cmocka_unit_test(test_deterministic),
        cmocka_unit_test(test_seeds),
        cmocka_unit_test(test_repeats_from_the_photo),
        cmocka_unit_test(test_torus),
        cmocka_unit_test(test_variety),
        cmocka_unit_test(test_scale_and_rotation_ranges),
        cmocka_unit_test(test_two_exemplars),
        cmocka_unit_test(test_fixed_stay),
        cmocka_unit_test(test_fixed_of_another_layout),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
