/* SPDX-License-Identifier: Apache-2.0 */
/* Scenes with known truth: every kind keeps the contract of its header at every size. */
#include "tests/base/check.h"

#include "base/rng.h"
#include "scenes/scene.h"
#include "scenes/stage.h"

static tz_scene render(tz_ctx *ctx, tz_scene_kind kind, tz_scene_camera camera, int32_t w,
                       int32_t h, uint64_t seed)
{
    tz_scene s;
    ok(ctx, tz_scene_render(ctx, kind, camera, w, h, seed, &s));
    return s;
}

/* ---- contract ---------------------------------------------------------------------- */

static void check_photo(const tz_scene *s, int32_t w, int32_t h)
{
    assert_true(s->photo.width == w && s->photo.height == h && s->photo.channels == 3);
    assert_int_equal(s->photo.encoding, TZ_ENCODING_SRGB);
    for (int32_t y = 0; y < h; y++)
        for (int32_t i = 0; i < 3 * w; i++) {
            const float v = s->photo.px[y * s->photo.stride + i];
            assert_true(v >= 0 && v <= 1 && v == roundf(v * 255) / 255);
        }
}

static void check_pieces(const tz_scene *s, int32_t w, int32_t h)
{
    tz_scene_piece *seen = calloc((size_t)s->pieces, sizeof *seen);
    assert_true(s->pieces > 0);
    for (int32_t y = 0; y < h; y++)
        for (int32_t x = 0; x < w; x++) {
            const int32_t id = s->segment[y * w + x];
            assert_in_range(id, 0, s->pieces - 1);
            tz_scene_piece *p = &seen[id];
            if (p->area++ == 0) { /* w and h: last column and row for now */
                p->box = (tz_rect){x, y, x, y};
                continue;
            }
            p->box.x = x < p->box.x ? x : p->box.x;
            p->box.w = x > p->box.w ? x : p->box.w;
            p->box.h = y > p->box.h ? y : p->box.h;
        }
    for (int32_t i = 0; i < s->pieces; i++) {
        const tz_scene_piece *a = &s->piece[i], *b = &seen[i];
        assert_true(a->area > 0 && a->area == b->area && a->whole >= a->area);
        assert_true(a->box.x == b->box.x && a->box.y == b->box.y);
        assert_int_equal(a->box.x + a->box.w - 1, b->box.w);
        assert_int_equal(a->box.y + a->box.h - 1, b->box.h);
    }
    free(seen);
}

static bool boundary_near(const tz_scene *s, double x, double y, double reach)
{
    const int32_t w = s->photo.width, h = s->photo.height;
    for (int32_t v = (int32_t)(y - reach - 1); v <= y + reach; v++)
        for (int32_t u = (int32_t)(x - reach - 1); u <= x + reach; u++)
            if (u >= 0 && v >= 0 && u < w && v < h && s->boundary[v * w + u] &&
                hypot(u + 0.5 - x, v + 0.5 - y) <= reach)
                return true;
    return false;
}

/* Curves are one pixel wide, and a change of segment has one: on the pixel left of or
 * above it, or in the middle of a joint narrower than 4 px. Only tips may fall short. */
static void check_boundary(const tz_scene *s, int32_t w, int32_t h)
{
    int32_t changes = 0, off = 0;
    for (int32_t y = 0; y < h; y++)
        for (int32_t x = 0; x < w; x++) {
            const int32_t p = y * w + x;
            const bool right = x + 1 < w && s->segment[p + 1] != s->segment[p];
            const bool below = y + 1 < h && s->segment[p + w] != s->segment[p];
            assert_in_range(s->boundary[p], 0, 1);
            if (x + 1 < w && y + 1 < h)
                assert_false(s->boundary[p] && s->boundary[p + 1] && s->boundary[p + w] &&
                             s->boundary[p + w + 1]);
            changes += right + below;
            off += right && !boundary_near(s, x + 1, y + 0.5, 2.1);
            off += below && !boundary_near(s, x + 0.5, y + 1, 2.1);
        }
    assert_true(off <= 2 + changes / 20);
}

static void scenes_keep_their_contract(void **state)
{
    static const int32_t size[][2] = {
        {16, 16}, {16, 16}, {120, 90}, {17, 300}, {1024, 64}};
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    for (tz_scene_kind kind = 0; kind < TZ_SCENE_COUNT; kind++)
        for (int32_t k = 0; k < 5; k++) {
            const int32_t w = size[k][0], h = size[k][1];
            tz_scene s = render(ctx, kind, k & 1 ? TZ_SCENE_CLEAN : TZ_SCENE_WILD, w, h,
                                (uint64_t)k);
            assert_int_equal(s.kind, kind);
            check_photo(&s, w, h);
            check_pieces(&s, w, h);
            check_boundary(&s, w, h);
            tz_scene_deinit(&s);
        }
    end_ctx(ctx);
}

/* Most kinds are nothing but pieces: some boundary in nearly every picture. */
static void scenes_show_something(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    for (tz_scene_kind kind = 0; kind < TZ_SCENE_COUNT; kind++) {
        int32_t bounded = 0;
        assert_true(strlen(tz_scene_kind_name(kind)) > 0);
        for (uint64_t seed = 0; seed < 4; seed++) {
            tz_scene s = render(ctx, kind, TZ_SCENE_WILD, 64, 64, 40 + seed);
            int32_t n = 0;
            double sum = 0, squares = 0;
            for (int32_t p = 0; p < 64 * 64; p++) {
                n += s.boundary[p];
                sum += s.photo.px[3 * p + 1];
                squares += (double)s.photo.px[3 * p + 1] * s.photo.px[3 * p + 1];
            }
            bounded += n > 20 && n < 2000;
            assert_true(squares / 4096 - sum * sum / 4096 / 4096 >
                        1e-5); /* not one tone */
            tz_scene_deinit(&s);
        }
        assert_true(bounded >= (kind == TZ_SCENE_GROUND ? 0 : 2));
    }
    end_ctx(ctx);
}

/* ---- the same bytes ---------------------------------------------------------------- */

enum { SIDE = 64, JOBS = 2 * TZ_SCENE_COUNT };

static tz_status one_of_many(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    uint64_t *sum = (uint64_t *)arg + i;
    tz_scene s;
    (void)worker;
    const tz_status status =
        tz_scene_render(ctx, (tz_scene_kind)(i / 2),
                        i & 1 ? TZ_SCENE_CLEAN : TZ_SCENE_WILD, SIDE, SIDE, 5, &s);
    if (status != TZ_OK)
        return status;
    *sum = 0;
    for (int32_t p = 0; p < SIDE * SIDE; p++) {
        const float *v = s.photo.px + 3 * p;
        const uint64_t colour = (uint64_t)(v[0] * 255 + 0.5f) << 16 |
                                (uint64_t)(v[1] * 255 + 0.5f) << 8 |
                                (uint64_t)(v[2] * 255 + 0.5f);
        *sum = tz_rng_stream(*sum, colour, (uint64_t)s.segment[p] << 1 | s.boundary[p]);
    }
    tz_scene_deinit(&s);
    return TZ_OK;
}

static void seed_gives_the_same_bytes(void **state)
{
    static const int threads[4] = {1, 1, 2, 8};
    static uint64_t sum[4][JOBS];
    (void)state;
    for (int k = 0; k < 4; k++) {
        tz_ctx *ctx = new_ctx(threads[k]);
        ok(ctx, tz_parallel_for(ctx, JOBS, one_of_many, sum[k]));
        end_ctx(ctx);
        assert_memory_equal(sum[k], sum[0], sizeof sum[0]);
    }
    for (int i = 1; i < JOBS; i++)
        assert_true(sum[0][i] != sum[0][i - 1]);
}

static void seeds_differ(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_scene a = render(ctx, TZ_SCENE_STONES, TZ_SCENE_CLEAN, 64, 64, 1);
    tz_scene b = render(ctx, TZ_SCENE_STONES, TZ_SCENE_CLEAN, 64, 64, 2);
    assert_memory_not_equal(a.boundary, b.boundary, 64 * 64);
    tz_scene_deinit(&a);
    tz_scene_deinit(&b);
    end_ctx(ctx);
}

/* ---- failures ---------------------------------------------------------------------- */

static void bad_sizes_are_refused(void **state)
{
    static const int32_t size[][2] = {{15, 64}, {64, 15},   {0, 0},
                                      {-5, 64}, {4097, 64}, {64, 5000}};
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    for (int32_t k = 0; k < 6; k++) {
        tz_scene s;
        fails(ctx,
              tz_scene_render(ctx, TZ_SCENE_STONES, TZ_SCENE_WILD, size[k][0], size[k][1],
                              1, &s),
              TZ_INVALID, "16 to 4096");
        assert_true(!s.segment && !s.boundary && !s.piece && s.pieces == 0);
        tz_scene_deinit(&s);
    }
    end_ctx(ctx);
}

static void cancelled_scenes_stop(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    for (tz_scene_kind kind = 0; kind < TZ_SCENE_COUNT; kind++) {
        tz_scene s;
        tz_ctx_cancel(ctx);
        assert_int_equal(tz_scene_render(ctx, kind, TZ_SCENE_WILD, 64, 64, 1, &s),
                         TZ_CANCELLED);
        assert_null(s.segment);
        tz_ctx_clear(ctx);
    }
    end_ctx(ctx);
}

static tz_scene_kind failing;

static tz_status render_small(tz_ctx *ctx)
{
    tz_scene s;
    const tz_status status = tz_scene_render(ctx, failing, TZ_SCENE_WILD, 16, 16, 3, &s);
    if (status != TZ_OK)
        assert_true(!s.segment && !s.photo.px);
    tz_scene_deinit(&s);
    return status;
}

static void scenes_survive_lack_of_memory(void **state)
{
    (void)state;
    for (failing = 0; failing < TZ_SCENE_COUNT; failing++)
        survive(render_small, 1);
}

/* ---- thinning ---------------------------------------------------------------------- */

static int32_t parts(const uint8_t *m, int32_t w, int32_t h)
{
    uint8_t *left = malloc((size_t)(w * h));
    int32_t *queue = malloc((size_t)(w * h) * sizeof *queue), n = 0;
    memcpy(left, m, (size_t)(w * h));
    for (int32_t p = 0; p < w * h; p++) {
        int32_t end = 0;
        if (!left[p])
            continue;
        n++;
        left[p] = 0;
        queue[end++] = p;
        for (int32_t i = 0; i < end; i++)
            for (int32_t k = 0; k < 9; k++) {
                const int32_t x = queue[i] % w + k % 3 - 1, y = queue[i] / w + k / 3 - 1;
                if (x < 0 || y < 0 || x >= w || y >= h || !left[y * w + x])
                    continue;
                left[y * w + x] = 0;
                queue[end++] = y * w + x;
            }
    }
    free(left);
    free(queue);
    return n;
}

/* Blots stay as many as they were, lose no ring, and become thin. */
static void thinning_keeps_parts(void **state)
{
    enum { W = 60, H = 50 };
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    for (uint64_t seed = 0; seed < 20; seed++) {
        uint8_t mask[W * H] = {0};
        tz_rng r = tz_rng_make(seed, 0);
        for (int32_t k = 0; k < 9; k++) { /* rings of any width */
            const double x = tz_rng_range(&r, 0, W), y = tz_rng_range(&r, 0, H);
            const double at = tz_rng_range(&r, 4, 20), wide = tz_rng_range(&r, 0.8, 4);
            for (int32_t p = 0; p < W * H; p++)
                if (fabs(hypot(p % W - x, p / W - y) - at) < wide)
                    mask[p] = 1;
        }
        const int32_t before = parts(mask, W, H);
        ok(ctx, tz_scene_thin(ctx, mask, W, H));
        assert_int_equal(parts(mask, W, H), before);
        for (int32_t p = 0; p < W * (H - 1) - 1; p++)
            if (p % W + 1 < W)
                assert_false(mask[p] && mask[p + 1] && mask[p + W] && mask[p + W + 1]);
    }
    end_ctx(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scenes_keep_their_contract),
        cmocka_unit_test(scenes_show_something),
        cmocka_unit_test(seed_gives_the_same_bytes),
        cmocka_unit_test(seeds_differ),
        cmocka_unit_test(bad_sizes_are_refused),
        cmocka_unit_test(cancelled_scenes_stop),
        cmocka_unit_test(scenes_survive_lack_of_memory),
        cmocka_unit_test(thinning_keeps_parts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
