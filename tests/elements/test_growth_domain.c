/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Region growing in domains that are more than a rectangle: regions, frames, zones;
 * palettes of several textures. */
#include "tests/base/check.h"

#include "tests/elements/growing.h"

static double nearest(const tz_element_set *s, int32_t i, int32_t kind)
{
    double least = INFINITY;
    for (int32_t j = 0; j < s->element.n; j++) {
        const tz_vec3 v =
            tz_domain_vector(&s->domain, s->element.v[i].at, s->element.v[j].at);
        if (j != i && (kind < 0 || s->element.v[j].kind == kind))
            least = fmin(least, hypot(v.x, v.y));
    }
    return least;
}

static int32_t count(const tz_element_set *s, int32_t kind)
{
    int32_t n = 0;
    for (int32_t i = 0; i < s->element.n; i++)
        n += s->element.v[i].kind == kind;
    return n;
}

static void grow(tz_ctx *ctx, const tz_element_set *palette,
                 const tz_growth_texture *texture, int32_t n, const tz_growth_params *p,
                 const tz_domain *d, tz_element_set *out)
{
    ok(ctx, tz_element_set_like(ctx, palette, d, out));
    ok(ctx, growing_run(ctx, palette, texture, n, p, 777, out));
    ok(ctx, tz_element_set_check(ctx, out, "output"));
}

static const tz_growth_texture all = {.scale = 1};

/* A ring: nothing in its hole, nothing outside, the density of the exemplar between. */
static tz_region *ring_region(tz_ctx *ctx, tz_vec3 size, bool torus)
{
    enum { N = 200 };
    float *mask = calloc((size_t)N * N, sizeof *mask);
    tz_region *r = NULL;
    for (int32_t k = 0; k < N * N; k++) {
        const double d = hypot(k % N + 0.5 - N / 2, (double)(k / N) + 0.5 - N / 2);
        mask[k] = d > 0.2 * N && d < 0.45 * N;
    }
    ok(ctx, tz_region_from_mask(ctx, mask, N, N, size, torus, &r));
    free(mask);
    return r;
}

static void test_region(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    for (int32_t k = 0; k < 4; k++) {
        tz_element_set ex, out;
        tz_growth_params p = growing_params();
        tz_domain d = {.size = {400, 400, 0}, .torus = k % 2};
        tz_region *r = ring_region(ctx, d.size, d.torus);
        d.region = r;
        p.inside = k / 2;
        ok(ctx, drawn_darts(ctx, 150, 8, 240, 2, false, &ex));
        grow(ctx, &ex, &all, 1, &p, &d, &out);
        for (int32_t i = 0; i < out.element.n; i++) {
            const tz_element *e = &out.element.v[i];
            assert_true(tz_domain_contains(&d, e->at));
            assert_true(tz_domain_depth(&d, e->at) >= p.inside * e->radius);
        }
        const double rim = p.inside > 0 ? 3.6 : 0;
        const double area = TZ_PI * ((180 - rim) * (180 - rim) - (80 + rim) * (80 + rim));
        growing_near(out.element.n, area * ex.element.n / 22500.0, 0.06);
        tz_element_set_deinit(&ex);
        tz_element_set_deinit(&out);
        tz_region_free(r);
    }
    end_ctx(ctx);
}

/* Bricks turned by 30 degrees everywhere are the same wall, turned. */
static void test_frames(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set ex, out;
    const tz_growth_params p = growing_params();
    tz_domain d = {.size = {300, 300, 0}};
    tz_frames *f = NULL;
    ok(ctx, drawn_squares(ctx, 8, 1, false, &ex));
    ex.kind.v[0].oriented = true;
    ok(ctx, tz_frames_from_formula(ctx, "30", d.size, false, &f));
    d.frames = f;
    grow(ctx, &ex, &all, 1, &p, &d, &out);
    growing_near(out.element.n, 900, 0.05);
    int32_t along = 0, pairs = 0;
    for (int32_t i = 0; i < out.element.n; i++) {
        const tz_element *e = &out.element.v[i];
        assert_true(fabs(e->angle - TZ_PI / 6) < 1e-3);
        for (int32_t j = 0; j < i; j++) {
            const double x = out.element.v[j].at.x - e->at.x;
            const double y = out.element.v[j].at.y - e->at.y;
            const double turn = fmod(atan2(y, x) + 4 * TZ_PI, TZ_PI / 2);
            if (hypot(x, y) > 12)
                continue;
            pairs++;
            along += fabs(turn - TZ_PI / 6) < 0.02;
        }
    }
    assert_true(pairs > 1600 && along > 0.99 * pairs);
    tz_element_set_deinit(&out);
    tz_frames_free(f);
    /* frames that turn slowly: elements lie as the frame at their place does */
    ok(ctx, tz_frames_from_formula(ctx, "60*sin(2*pi*x/w)", d.size, false, &f));
    d.frames = f;
    grow(ctx, &ex, &all, 1, &p, &d, &out);
    growing_near(out.element.n, 900, 0.1);
    for (int32_t i = 0; i < out.element.n; i++) {
        const tz_element *e = &out.element.v[i];
        const double off = e->angle - tz_domain_frame(&d, e->at);
        assert_true(fabs(off - TZ_PI * floor(off / TZ_PI + 0.5)) < 1e-2);
        assert_true(nearest(&out, i, -1) > 7);
    }
    tz_element_set_deinit(&ex);
    tz_element_set_deinit(&out);
    tz_frames_free(f);
    end_ctx(ctx);
}

/* Left and right half are zones. */
static tz_zones halves(tz_vec3 size, uint8_t *zone, uint64_t *allow)
{
    for (int32_t k = 0; k < 32 * 32; k++)
        zone[k] = k % 32 >= 16;
    return (tz_zones){.raster = {.width = 32, .height = 32, .size = size},
                      .zone = zone,
                      .allow = allow,
                      .zones = 2};
}

static void test_zones(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set ex, out;
    uint8_t zone[32 * 32];
    uint64_t allow[2] = {1, 3};
    const tz_growth_params p = growing_params();
    tz_domain d = {.size = {400, 300, 0}};
    const tz_zones z = halves(d.size, zone, allow);
    d.zones = &z;
    ok(ctx, drawn_darts(ctx, 150, 8, 200, 2, false, &ex));
    grow(ctx, &ex, &all, 1, &p, &d, &out);
    int32_t left = 0;
    for (int32_t i = 0; i < out.element.n; i++) {
        const tz_element *e = &out.element.v[i];
        assert_true(e->at.x >= 200 || e->kind == 0);
        left += e->at.x < 200;
    }
    assert_true(left > 100 && count(&out, 1) > 100);
    const double density = ex.element.n / 22500.0;
    growing_near(out.element.n - left, density * 60000, 0.06);
    tz_element_set_deinit(&ex);
    tz_element_set_deinit(&out);
    end_ctx(ctx);
}

/* Two textures of unlike scale, one in each zone; the second also drawn twice as large. */
static void test_palette(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    for (int32_t k = 0; k < 2; k++) {
        tz_element_set palette, out;
        uint8_t zone[32 * 32];
        uint64_t allow[2] = {~(uint64_t)0, ~(uint64_t)0};
        tz_domain d = {.size = {400, 200, 0}};
        const tz_growth_params p = growing_params();
        const tz_zones z = halves(d.size, zone, allow);
        const tz_growth_texture two[2] = {
            {.to = {100, 100}, .zone = 1},
            {.from = {100, 0}, .to = {200, 100}, .zone = 2, .scale = 1 + k}};
        d.zones = &z;
        ok(ctx, growing_palette(ctx, &palette));
        grow(ctx, &palette, two, 2, &p, &d, &out);
        const int32_t fine = k ? 400 : 1600;
        growing_near(count(&out, 0), 400, 0.06);
        growing_near(count(&out, 1), fine, 0.06);
        for (int32_t i = 0; i < out.element.n; i++) {
            const tz_element *e = &out.element.v[i];
            assert_int_equal(e->at.x >= 200, e->kind);
            assert_true(e->scale == (e->kind ? 2.0 * (1 + k) : 4));
            /* those of the other texture keep their distance */
            assert_true(nearest(&out, i, 1 - e->kind) >= 0.75 * (4 + 2 * (1 + k)));
        }
        tz_element_set_deinit(&palette);
        tz_element_set_deinit(&out);
    }
    end_ctx(ctx);
}

/* A selection of a palette's kinds. */
static void test_selection(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set ex, out;
    tz_growth *g = NULL;
    const tz_growth_params p = growing_params();
    const tz_domain d = {.size = {300, 300, 0}};
    ok(ctx, drawn_darts(ctx, 200, 8, 400, 3, false, &ex));
    const tz_growth_texture some = {.kinds = 5};
    grow(ctx, &ex, &some, 1, &p, &d, &out);
    assert_int_equal(count(&out, 1), 0);
    const double area = 90000.0 / 40000;
    growing_near(out.element.n, area * (count(&ex, 0) + count(&ex, 2)), 0.06);
    growing_near(count(&out, 2), area * count(&ex, 2), 0.1);
    const tz_growth_texture none = {.from = {-50, -50}, .to = {-1, -1}};
    fails(ctx, tz_growth_begin_palette(ctx, &ex, &none, 1, &p, &out, &g), TZ_INVALID,
          "selects no elements");
    const tz_growth_texture flat = {.scale = -1};
    fails(ctx, tz_growth_begin_palette(ctx, &ex, &flat, 1, &p, &out, &g), TZ_INVALID,
          "scale of -1");
    const tz_growth_texture far = {.zone = 1};
    fails(ctx, tz_growth_begin_palette(ctx, &ex, &far, 1, &p, &out, &g), TZ_INVALID,
          "zone 0");
    fails(ctx, tz_growth_begin_palette(ctx, &ex, &flat, 0, &p, &out, &g), TZ_INVALID,
          "0 textures");
    assert_null(g);
    tz_element_set_deinit(&ex);
    tz_element_set_deinit(&out);
    end_ctx(ctx);
}

static void test_radii(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set palette, out;
    tz_growth *g = NULL;
    tz_growth_params p = growing_params();
    const tz_domain d = {.size = {200, 100, 0}};
    const tz_growth_texture first = {.to = {100, 100}};
    double reach[3];
    ok(ctx, growing_palette(ctx, &palette));
    ok(ctx, tz_element_set_like(ctx, &palette, &d, &out));
    for (int32_t rings = 1; rings <= 3; rings++) {
        tz_growth_radius r[2];
        p.rings = rings;
        ok(ctx, tz_growth_begin_palette(ctx, &palette, &first, 1, &p, &out, &g));
        tz_growth_radii(g, 0, r);
        tz_growth_end(g);
        assert_true(r[0].bounding == 4 && r[1].bounding == 0 && r[1].neighbourhood == 0);
        reach[rings - 1] = r[0].neighbourhood;
        /* rings of a lattice of 10 apart */
        assert_true(r[0].neighbourhood > 10 * rings && r[0].neighbourhood < 16 * rings);
    }
    assert_true(reach[0] < reach[1] && reach[1] < reach[2]);
    /* given ones are taken, in units of the palette */
    const tz_growth_radius mine[2] = {{5, 31}, {0, 0}};
    tz_growth_radius r[2];
    const tz_growth_texture given = {.to = {100, 100}, .scale = 2, .radius = mine};
    p.rings = 2;
    ok(ctx, tz_growth_begin_palette(ctx, &palette, &given, 1, &p, &out, &g));
    tz_growth_radii(g, 0, r);
    tz_growth_end(g);
    assert_true(fabs(r[0].bounding - 5) < 1e-6);
    assert_true(fabs(r[0].neighbourhood - 31) < 1);
    tz_element_set_deinit(&palette);
    tz_element_set_deinit(&out);
    end_ctx(ctx);
}

/* What is told of a growth: it covers all, and holds what was expected. */
static void test_report(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set ex, out;
    tz_growth *g = NULL;
    tz_growth_report r;
    bool more = true;
    double covered = 0;
    const tz_growth_params p = growing_params();
    const tz_domain d = {.size = {320, 240, 0}, .torus = true};
    ok(ctx, drawn_darts(ctx, 150, 8, 200, 1, false, &ex));
    ok(ctx, tz_element_set_like(ctx, &ex, &d, &out));
    ok(ctx, tz_growth_begin(ctx, &ex, &p, &out, &g));
    tz_growth_tell(g, &r);
    growing_near(r.area, 320 * 240, 1e-6);
    assert_true(r.covered == 0 && r.placed == 0);
    growing_near(r.expected, ex.element.n * 320 * 240 / 22500.0, 0.02);
    while (more) {
        ok(ctx, tz_growth_step(g, 20, &more));
        tz_growth_tell(g, &r);
        assert_true(r.covered >= covered && r.covered <= 1);
        assert_int_equal(r.placed, out.element.n);
        covered = r.covered;
    }
    assert_true(covered == 1);
    growing_near(r.placed, r.expected, 0.05);
    tz_growth_end(g);
    tz_element_set_deinit(&ex);
    tz_element_set_deinit(&out);
    end_ctx(ctx);
}

/* Elements of one size and kind, bent one way in one half and the other way in the other:
 * only their samples tell. */
static void test_samples(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set ex, out;
    const tz_growth_params p = growing_params();
    const tz_domain d = {.size = {300, 300, 0}};
    ok(ctx, drawn_set(ctx, 120, 120, false, 1, &ex));
    for (int32_t k = 0; k < 144; k++) {
        const double x = 5 + 10 * (k % 12), y = 5 + (double)(k / 12) * 10;
        const double bend = (k / 12) % 2 ? 3 : -3; /* rows by turns */
        ok(ctx, drawn_add(&ex, x, y, 4, 0, 0));
        const tz_sample ends[2] = {{{x - 3, y + bend, 0}, 1, 1},
                                   {{x + 3, y + bend, 0}, 2, 1}};
        ok(ctx, tz_array_push(ctx, &ex.sample, ends[0]));
        ok(ctx, tz_array_push(ctx, &ex.sample, ends[1]));
        ex.element.v[k].samples = 3;
    }
    grow(ctx, &ex, &all, 1, &p, &d, &out);
    int32_t right = 0, pairs = 0;
    for (int32_t i = 0; i < out.element.n; i++)
        for (int32_t j = 0; j < i; j++) {
            const tz_element *a = &out.element.v[i], *b = &out.element.v[j];
            const double x = fabs(a->at.x - b->at.x), y = fabs(a->at.y - b->at.y);
            const bool up = a->source / 12 % 2, also = b->source / 12 % 2;
            if (hypot(x, y) > 12)
                continue;
            pairs++;
            right += (up == also) == (x > y); /* alike beside, unlike above */
        }
    growing_near(out.element.n, 900, 0.05);
    assert_true(pairs > 1500 && right > 0.95 * pairs);
    for (int32_t i = 0; i < out.element.n; i++) {
        const tz_element *e = &out.element.v[i], *from = &ex.element.v[e->source];
        for (int32_t k = 0; k < 3; k++) {
            const tz_vec3 a = out.sample.v[e->sample + k].at;
            const tz_vec3 b = ex.sample.v[from->sample + k].at;
            assert_true(fabs(a.x - e->at.x - (b.x - from->at.x)) < 1e-6);
            assert_true(fabs(a.y - e->at.y - (b.y - from->at.y)) < 1e-6);
        }
    }
    tz_element_set_deinit(&ex);
    tz_element_set_deinit(&out);
    end_ctx(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_region),    cmocka_unit_test(test_frames),
        cmocka_unit_test(test_zones),     cmocka_unit_test(test_palette),
        cmocka_unit_test(test_selection), cmocka_unit_test(test_radii),
        cmocka_unit_test(test_report),    cmocka_unit_test(test_samples),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
