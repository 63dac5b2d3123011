/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Things of photos: found, cut out, in order, and taken out. */
#include "tests/base/check.h"

#include <math.h>

#include "analysis/things.h"
#include "base/rng.h"

/* ---- pictures ------------------------------------------------------------------------ */

typedef struct disc {
    double x, y, r;
    float rgb[3];
} disc;

static const float ground[3] = {0.25F, 0.24F, 0.22F};

/* Discs on grainy ground, 4 x 4 points a pixel; later ones lie above earlier ones, and
 * each has a dark rim, as things have. */
static tz_image draw(tz_ctx *ctx, int32_t w, int32_t h, const disc *d, int32_t n)
{
    tz_image im;
    ok(ctx, tz_image_init(ctx, &im, w, h, 3));
    im.encoding = TZ_ENCODING_SRGB;
    for (int32_t y = 0; y < h; y++) {
        tz_rng g = tz_rng_make(5, (uint64_t)y);
        for (int32_t x = 0; x < w; x++) {
            float sum[3] = {0};
            const float grain = (float)(0.015 * tz_rng_normal(&g));
            for (int k = 0; k < 16; k++) {
                const double px = x + (k % 4 + 0.5) / 4, py = y + (k / 4 + 0.5) / 4;
                const float *rgb = ground;
                float shade = 1;
                for (int32_t i = 0; i < n; i++) {
                    const double far = hypot(px - d[i].x, py - d[i].y);
                    if (far > d[i].r)
                        continue;
                    rgb = d[i].rgb;
                    shade = far > d[i].r - 1.2 ? 0.6F : 1;
                }
                for (int c = 0; c < 3; c++)
                    sum[c] += rgb[c] * shade / 16;
            }
            for (int c = 0; c < 3; c++)
                tz_image_at(&im, x, y)[c] = sum[c] + grain;
        }
    }
    return im;
}

enum { ROWS = 5, DISCS = ROWS * ROWS, SIDE = 240 };

/* Apart from each other, of two colours, none at the border. */
static void scatter(disc *d)
{
    tz_rng g = tz_rng_make(2, 2);
    for (int32_t i = 0; i < DISCS; i++) {
        d[i] = (disc){.x = 24.5 + 48 * (i % ROWS) + tz_rng_range(&g, -4, 4),
                      .y = 24.5 + 48 * (i / ROWS) + tz_rng_range(&g, -4, 4),
                      .r = tz_rng_range(&g, 13, 18)};
        const float a[3] = {0.8F, 0.75F, 0.6F}, b[3] = {0.7F, 0.25F, 0.2F};
        memcpy(d[i].rgb, i % 2 ? a : b, sizeof a);
    }
}

static tz_things_params defaults(void)
{
    tz_things_params p;
    tz_params_default(&tz_things_param_table, &p);
    return p;
}

typedef struct result {
    tz_element_set set;
    tz_image plate;
    int32_t *label;
} result;

static result find(tz_ctx *ctx, const tz_image *photo, const tz_things_params *p)
{
    result r;
    ok(ctx, tz_alloc(ctx, &r.label, (size_t)photo->width * (size_t)photo->height,
                     sizeof *r.label));
    ok(ctx, tz_things_find(ctx, photo, p, &r.set, &r.plate, r.label));
    ok(ctx, tz_element_set_check(ctx, &r.set, "things"));
    return r;
}

static void drop(tz_ctx *ctx, result *r)
{
    tz_element_set_deinit(&r->set);
    tz_image_deinit(&r->plate);
    tz_free(ctx, r->label);
}

static const tz_element *nearest(const tz_element_set *s, double x, double y)
{
    const tz_element *best = NULL;
    for (int32_t i = 0; i < s->element.n; i++) {
        const tz_element *e = &s->element.v[i];
        if (!best ||
            hypot(e->at.x - x, e->at.y - y) < hypot(best->at.x - x, best->at.y - y))
            best = e;
    }
    return best;
}

static double area_of(const tz_element_symbol *y)
{
    double twice = 0;
    for (int32_t k = 0; k < y->part.n; k++) {
        const int32_t first = y->part.v[k],
                      end = k + 1 < y->part.n ? y->part.v[k + 1] : y->outline.n;
        for (int32_t i = first, j = end - 1; i < end; j = i++)
            twice += y->outline.v[j].x * y->outline.v[i].y -
                     y->outline.v[i].x * y->outline.v[j].y;
    }
    return 0.5 * twice;
}

/* ---- what is found ------------------------------------------------------------------- */

static void discs_are_found(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    disc d[DISCS];
    scatter(d);
    tz_image photo = draw(ctx, SIDE, SIDE, d, DISCS);
    const tz_things_params p = defaults();
    result r = find(ctx, &photo, &p);
    int32_t whole = 0; /* ground that the border closes off may pass for a cut thing */
    for (int32_t i = 0; i < r.set.element.n; i++)
        whole += !r.set.element.v[i].cut;
    assert_int_equal(whole, DISCS);
    assert_in_range(r.set.element.n, DISCS, DISCS + 3);
    assert_int_equal(r.set.symbol.n, r.set.element.n);
    assert_in_range(r.set.kind.n, 2, 3);
    assert_true(r.set.domain.size.x == SIDE && !r.set.domain.torus);
    for (int32_t i = 0; i < DISCS; i++) {
        const tz_element *e = nearest(&r.set, d[i].x, d[i].y);
        const tz_element_symbol *y = &r.set.symbol.v[e->symbol];
        if (hypot(e->at.x - d[i].x, e->at.y - d[i].y) > 0.8 ||
            fabs(e->radius - d[i].r) > 1.3)
            fail_msg("disc %d at %.2f, %.2f of %.2f is at %.2f, %.2f of %.2f", i, d[i].x,
                     d[i].y, d[i].r, e->at.x, e->at.y, e->radius);
        assert_true(fabs(area_of(y) / (TZ_PI * d[i].r * d[i].r) - 1) < 0.12);
        assert_true(!e->cut && e->samples == 1 && e->angle == 0 && e->scale == 1);
        assert_true(y->photo == 0 && y->photo_scale == 1 && !*y->markup);
        assert_true(y->photo_at.x == e->at.x && y->photo_at.y == e->at.y);
        assert_int_equal(e->kind, nearest(&r.set, d[i % 2].x, d[i % 2].y)->kind);
    }
    drop(ctx, &r);
    tz_image_deinit(&photo);
    end_ctx(ctx);
}

/* Labels are the pixels whose centres the outlines hold: outlines do not overlap. */
static void labels_are_outlines(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    disc d[DISCS];
    scatter(d);
    for (int32_t i = 0; i < DISCS; i++)
        d[i].r *= 1.6; /* they touch, overlap, and some are cut */
    tz_image photo = draw(ctx, SIDE, SIDE, d, DISCS);
    const tz_things_params p = defaults();
    result r = find(ctx, &photo, &p);
    double outlines = 0;
    int64_t labelled = 0;
    int32_t cut = 0;
    assert_true(r.set.element.n > DISCS / 2);
    for (int32_t i = 0; i < r.set.element.n; i++) {
        outlines += area_of(&r.set.symbol.v[r.set.element.v[i].symbol]);
        cut += r.set.element.v[i].cut;
        assert_true(i == 0 || r.set.element.v[i].depth >= r.set.element.v[i - 1].depth);
    }
    for (int32_t k = 0; k < SIDE * SIDE; k++) {
        assert_in_range(r.label[k] + 1, 0, r.set.element.n);
        labelled += r.label[k] >= 0;
    }
    assert_true(cut > 0);
    assert_true(fabs(outlines - (double)labelled) < 0.01 * (double)labelled);
    drop(ctx, &r);
    tz_image_deinit(&photo);
    end_ctx(ctx);
}

static void the_upper_one_lies_above(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    const disc d[] = {
        {60, 60, 26, {0.7F, 0.3F, 0.2F}},  {98, 66, 24, {0.8F, 0.8F, 0.6F}},
        {60, 150, 25, {0.8F, 0.8F, 0.6F}}, {97, 158, 25, {0.7F, 0.3F, 0.2F}},
        {150, 50, 18, {0.3F, 0.5F, 0.3F}}, {160, 120, 22, {0.3F, 0.4F, 0.6F}}};
    tz_image photo = draw(ctx, 200, 200, d, 6);
    const tz_things_params p = defaults();
    result r = find(ctx, &photo, &p);
    for (int32_t i = 0; i < 4; i += 2) {
        const tz_element *low = nearest(&r.set, d[i].x, d[i].y),
                         *high = nearest(&r.set, d[i + 1].x, d[i + 1].y);
        assert_true(low != high && low->depth < high->depth);
        /* the covered one is whole: its circle is the disc's */
        assert_true(fabs(low->radius - d[i].r) < 2);
        assert_true(hypot(low->at.x - d[i].x, low->at.y - d[i].y) < 2);
    }
    drop(ctx, &r);
    tz_image_deinit(&photo);
    end_ctx(ctx);
}

/* ---- the plate ----------------------------------------------------------------------- */

static void the_plate_is_ground(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    disc d[DISCS];
    scatter(d);
    tz_image photo = draw(ctx, SIDE, SIDE, d, DISCS);
    const tz_things_params p = defaults();
    result r = find(ctx, &photo, &p);
    int32_t kept = 0;
    assert_true(r.plate.width == SIDE && r.plate.height == SIDE &&
                r.plate.encoding == photo.encoding);
    for (int32_t k = 0; k < SIDE * SIDE; k++) {
        const float *q = r.plate.px + 3 * k, *o = photo.px + 3 * k;
        for (int c = 0; c < 3; c++)
            if (fabsf(q[c] - ground[c]) > 0.09F) /* grain: 5 deviations, and a rest */
                fail_msg("pixel %d, %d of the plate is %.3f %.3f %.3f", k % SIDE,
                         k / SIDE, q[0], q[1], q[2]);
        kept += memcmp(q, o, 3 * sizeof *q) == 0;
    }
    assert_true(kept > SIDE * SIDE / 3); /* what was ground is as it was */
    drop(ctx, &r);
    tz_image_deinit(&photo);
    end_ctx(ctx);
}

/* ---- parameters ---------------------------------------------------------------------- */

static void parameters_count(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    disc d[DISCS];
    scatter(d);
    for (int32_t i = 0; i < DISCS; i += 2)
        d[i].r = 8; /* small and large */
    tz_image photo = draw(ctx, SIDE, SIDE, d, DISCS);
    tz_things_params p = defaults();
    p.size_range[0] = 21;
    result r = find(ctx, &photo, &p);
    assert_int_equal(r.set.element.n, DISCS / 2);
    drop(ctx, &r);
    p.size_range[0] = 0;
    p.size_range[1] = 21;
    r = find(ctx, &photo, &p);
    assert_in_range(r.set.element.n, DISCS / 2, DISCS / 2 + 3);
    for (int32_t i = 0; i < r.set.element.n; i++)
        assert_true(r.set.element.v[i].radius < 13);
    drop(ctx, &r);
    p = defaults();
    p.classes = 1;
    r = find(ctx, &photo, &p);
    assert_int_equal(r.set.kind.n, 1);
    drop(ctx, &r);
    p = defaults();
    p.detail = TZ_THINGS_DOUBLE;
    r = find(ctx, &photo, &p);
    assert_in_range(r.set.element.n, DISCS - 2, DISCS + 2);
    drop(ctx, &r);
    p.size_range[0] = 9, p.size_range[1] = 5;
    fails(ctx, tz_things_find(ctx, &photo, &p, &r.set, NULL, NULL), TZ_INVALID,
          "size-range");
    tz_image_deinit(&photo);
    end_ctx(ctx);
}

static void odd_photos(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    const tz_things_params p = defaults();
    static const int32_t size[][2] = {{1, 1}, {1, 40},  {40, 1},
                                      {3, 2}, {33, 17}, {64, 64}};
    for (size_t i = 0; i < sizeof size / sizeof *size; i++)
        for (int32_t channels = 1; channels <= 4; channels++) {
            tz_image im;
            ok(ctx, tz_image_init(ctx, &im, size[i][0], size[i][1], channels));
            im.encoding = channels % 2 ? TZ_ENCODING_LINEAR : TZ_ENCODING_SRGB;
            for (int64_t k = 0; k < (int64_t)im.width * im.height * channels; k++)
                im.px[k] = i == 4 ? NAN : 0.5F;
            result r = find(ctx, &im, &p);
            assert_int_equal(r.plate.channels, channels < 3 ? 1 : 3);
            for (int64_t k = 0; k < (int64_t)im.width * im.height * r.plate.channels; k++)
                assert_true(isfinite(r.plate.px[k]));
            drop(ctx, &r);
            im.encoding = TZ_ENCODING_DATA;
            fails(ctx, tz_things_find(ctx, &im, &p, &r.set, &r.plate, NULL), TZ_INVALID,
                  "colour");
            assert_true(r.set.element.n == 0 && !r.plate.px);
            tz_image_deinit(&im);
        }
    end_ctx(ctx);
}

static void photos_get_names(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set s = {.ctx = ctx};
    fails(ctx, tz_things_name_photo(&s, "a.png", NULL, NULL), TZ_INVALID, "photo");
    const disc d = {20, 20, 12, {0.8F, 0.8F, 0.7F}};
    tz_image photo = draw(ctx, 40, 40, &d, 1);
    const tz_things_params p = defaults();
    ok(ctx, tz_things_find(ctx, &photo, &p, &s, NULL, NULL));
    char sha[65];
    memset(sha, 'b', 64);
    sha[64] = 0;
    ok(ctx, tz_things_name_photo(&s, "a.png", sha, "b.png"));
    ok(ctx, tz_things_name_photo(&s, "c.png", sha, "d.png"));
    assert_string_equal(s.photo.v[0].path, "c.png");
    assert_string_equal(s.photo.v[0].plate, "d.png");
    assert_string_equal(s.photo.v[0].sha256, sha);
    assert_true(s.photo.v[0].width == 40 && s.photo.v[0].height == 40);
    tz_image_deinit(&photo);
    tz_element_set_deinit(&s);
    end_ctx(ctx);
}

/* ---- the same always ----------------------------------------------------------------- */

static void threads_do_not_matter(void **state)
{
    (void)state;
    static const int threads[] = {1, 2, 8};
    disc d[DISCS];
    scatter(d);
    for (int32_t i = 0; i < DISCS; i++)
        d[i].r *= 1.5;
    result first = {0};
    tz_ctx *one = NULL;
    for (int k = 0; k < 3; k++) {
        tz_ctx *ctx = new_ctx(threads[k]);
        tz_image photo = draw(ctx, SIDE, SIDE, d, DISCS);
        const tz_things_params p = defaults();
        result r = find(ctx, &photo, &p);
        tz_image_deinit(&photo);
        if (k == 0) {
            first = r;
            one = ctx;
            continue;
        }
        assert_int_equal(first.set.element.n, r.set.element.n);
        assert_memory_equal(first.label, r.label, SIDE * SIDE * sizeof *r.label);
        assert_memory_equal(first.plate.px, r.plate.px, SIDE * SIDE * 3 * sizeof(float));
        for (int32_t i = 0; i < r.set.element.n; i++) {
            const tz_element_symbol *a = &first.set.symbol.v[i], *b = &r.set.symbol.v[i];
            assert_int_equal(a->outline.n, b->outline.n);
            assert_memory_equal(a->outline.v, b->outline.v,
                                (size_t)a->outline.n * sizeof *a->outline.v);
            assert_memory_equal(&first.set.element.v[i].at, &r.set.element.v[i].at,
                                sizeof(tz_vec3));
            assert_int_equal(first.set.element.v[i].kind, r.set.element.v[i].kind);
            assert_int_equal(first.set.element.v[i].depth, r.set.element.v[i].depth);
        }
        drop(ctx, &r);
        end_ctx(ctx);
    }
    drop(one, &first);
    end_ctx(one);
}

static void cancelled(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    disc d[DISCS];
    scatter(d);
    tz_image photo = draw(ctx, SIDE, SIDE, d, DISCS), plate;
    const tz_things_params p = defaults();
    tz_element_set s;
    tz_ctx_cancel(ctx);
    assert_int_equal(tz_things_find(ctx, &photo, &p, &s, &plate, NULL), TZ_CANCELLED);
    assert_true(s.element.n == 0 && !plate.px);
    tz_ctx_clear(ctx);
    tz_image_deinit(&photo);
    end_ctx(ctx);
}

/* Every allocation of the first ones, then ever fewer of the many: reading the model is
 * what takes the time. */
static void survives_want_of_memory(void **state)
{
    (void)state;
    const disc d[] = {{20, 20, 12, {0.8F, 0.8F, 0.7F}},
                      {44, 30, 10, {0.7F, 0.3F, 0.2F}},
                      {30, 52, 9, {0.8F, 0.8F, 0.7F}},
                      {60, 60, 12, {0.7F, 0.3F, 0.2F}}};
    const tz_things_params p = defaults();
    bool done = false;
    for (int64_t n = 1; !done; n += 1 + n / 24) {
        const tz_ctx_options o = {.threads = 1, .fail_alloc = n};
        tz_ctx *ctx = NULL, *mine = new_ctx(1);
        tz_element_set s;
        tz_image photo = draw(mine, 72, 72, d, 4), plate;
        assert_int_equal(tz_ctx_new(&o, &ctx), TZ_OK);
        const tz_status st = tz_things_find(ctx, &photo, &p, &s, &plate, NULL);
        if (st != TZ_OK) {
            assert_int_equal(st, TZ_NOMEM);
            assert_true(tz_ctx_message(ctx)[0] != 0);
            assert_true(s.element.n == 0 && !plate.px);
        }
        done = st == TZ_OK;
        tz_element_set_deinit(&s);
        tz_image_deinit(&plate);
        end_ctx(ctx);
        tz_image_deinit(&photo);
        end_ctx(mine);
        assert_true(n < 1000000);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(discs_are_found),
        cmocka_unit_test(labels_are_outlines),
        cmocka_unit_test(the_upper_one_lies_above),
        cmocka_unit_test(the_plate_is_ground),
        cmocka_unit_test(parameters_count),
        cmocka_unit_test(odd_photos),
        cmocka_unit_test(photos_get_names),
        cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(cancelled),
        cmocka_unit_test(survives_want_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
