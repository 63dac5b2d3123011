/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Arrangement under rules: which groups, how large, how turned, of which photo, where. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/arranged.h"

static tz_ctx *ctx;
static arranged_source stones, bricks;
enum { W = 720, H = 560 };

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

/* The rule everywhere; may be changed through rule.v[0]. */
static void everywhere(tz_rules *r) { assert_int_equal(tz_rules_default(ctx, r), TZ_OK); }

/* Adds a rule for the right half. */
static tz_rule *right_half(tz_rules *r)
{
    tz_rule q = tz_rule_default();
    static const tz_vec2 shape[] = {{0.5, 0}, {1, 0}, {1, 1}, {0.5, 1}};
    for (int k = 0; k < 4; k++)
        assert_int_equal(tz_array_push(ctx, &q.shape, shape[k]), TZ_OK);
    assert_int_equal(tz_array_push(ctx, &r->rule, q), TZ_OK);
    return &r->rule.v[r->rule.n - 1];
}

static tz_arrange_params params(void)
{
    tz_arrange_params p = arrange_params(W, H, 6, false);
    p.effort = 2;
    return p;
}

static void arrange_both(const tz_rules *r, tz_layout *l)
{
    const tz_exemplar ex[2] = {stones.exemplar, bricks.exemplar};
    const tz_arrange_params p = params();
    memset(l, 0, sizeof *l);
    assert_int_equal(tz_arrange(ctx, ex, 2, r, &p, l), TZ_OK);
    assert_sound(l, ex, 2, 2);
}

/* ---- which groups ------------------------------------------------------------------ */

static void test_whitelist(void **state)
{
    (void)state;
    tz_rules r;
    tz_layout l;
    everywhere(&r);
    /* groups that do not touch the photo's border, so that they can be placed */
    int32_t list[4], n = 0;
    for (int32_t g = 0; g < stones.ebpt.group.n && n < 4; g++)
        if (!stones.ebpt.group.v[g].cut && stones.ebpt.group.v[g].size > 8)
            list[n++] = g;
    assert_true(n > 0);
    for (int32_t k = 0; k < n; k++)
        assert_int_equal(tz_array_push(ctx, &r.rule.v[0].groups, list[k]), TZ_OK);
    const tz_arrange_params p = params();
    arrange_one(ctx, &stones, &r, &p, &l);
    for (int32_t k = 0; k < l.place.n; k++) {
        bool listed = false;
        for (int32_t i = 0; i < n; i++)
            listed |= l.place.v[k].group == list[i];
        if (!listed)
            fail_msg("group %d is placed, which is not listed", l.place.v[k].group);
    }
    tz_layout_deinit(&l);
    tz_rules_deinit(&r);
}

static void test_size_limits(void **state)
{
    (void)state;
    /* limits between which a good part of the groups lies */
    double sum = 0;
    const int32_t n = stones.ebpt.group.n;
    for (int32_t g = 0; g < n; g++)
        sum += stones.ebpt.group.v[g].size / n;
    for (int large = 0; large < 2; large++) {
        tz_rules r;
        tz_layout l;
        everywhere(&r);
        r.rule.v[0].size[0] = large ? sum : 0;
        r.rule.v[0].size[1] = large ? INFINITY : sum;
        const tz_arrange_params p = params();
        arrange_one(ctx, &stones, &r, &p, &l);
        for (int32_t k = 0; k < l.place.n; k++) {
            const double size = stones.ebpt.group.v[l.place.v[k].group].size;
            if (!(large ? size >= sum : size <= sum))
                fail_msg("a group of size %g is placed, the limit is %g", size, sum);
        }
        tz_layout_deinit(&l);
        tz_rules_deinit(&r);
    }
}

static bool in_bins(const tz_ebpt *e, int32_t group, uint32_t lengths, uint32_t angles)
{
    const tz_edge_group *g = &e->group.v[group];
    if ((lengths >> g->length_bin & 1) && (angles >> g->angle_bin & 1))
        return true;
    for (int32_t k = g->edge; k < g->edge + g->edges; k++) {
        const tz_edge *d = &e->edge.v[e->group_edge.v[k]];
        if ((lengths >> d->length_bin & 1) && (angles >> d->angle_bin & 1))
            return true;
    }
    return false;
}

static void test_bins(void **state)
{
    (void)state;
    int tested = 0;
    for (int bin = 0; bin < 6; bin++) {
        const uint32_t lengths = bin < 3 ? 1U << bin : ~0U,
                       angles = bin < 3 ? ~0U : 1U << (bin - 3);
        int32_t usable = 0;
        for (int32_t g = 0; g < bricks.ebpt.group.n; g++)
            usable +=
                in_bins(&bricks.ebpt, g, lengths, angles) && !bricks.ebpt.group.v[g].cut;
        if (usable < 3)
            continue;
        tz_rules r;
        tz_layout l;
        everywhere(&r);
        r.rule.v[0].length_bins = lengths;
        r.rule.v[0].angle_bins = angles;
        const tz_arrange_params p = params();
        arrange_one(ctx, &bricks, &r, &p, &l);
        for (int32_t k = 0; k < l.place.n; k++)
            if (!in_bins(&bricks.ebpt, l.place.v[k].group, lengths, angles))
                fail_msg("bins %x, %x: group %d is placed", lengths, angles,
                         l.place.v[k].group);
        tested++;
        tz_layout_deinit(&l);
        tz_rules_deinit(&r);
    }
    assert_true(tested > 0);
}

/* A rule that no group fulfils still covers. */
static void test_impossible_rule(void **state)
{
    (void)state;
    tz_rules r;
    tz_layout l;
    everywhere(&r);
    r.rule.v[0].size[0] = 1e6;
    const tz_arrange_params p = arrange_params(200, 200, 1, false);
    arrange_one(ctx, &stones, &r, &p, &l);
    double farthest;
    assert_true(bare_pixels(&l, &farthest) < 400);
    tz_layout_deinit(&l);
    tz_rules_deinit(&r);
}

/* ---- how turned, how large --------------------------------------------------------- */

/* Difference of two angles, 0 .. pi; mirrored pieces may stand on their heads. */
static double off(double a, double b, bool mirror)
{
    const double turn = mirror ? TZ_PI : 2 * TZ_PI;
    const double d = a - b;
    return fabs(d - turn * floor(d / turn + 0.5));
}

static void test_fixed_angle(void **state)
{
    (void)state;
    static const double angles[] = {0, 0.6, TZ_PI / 2, -2.5};
    for (int k = 0; k < 4; k++) {
        tz_rules r;
        tz_layout l;
        everywhere(&r);
        r.rule.v[0].rotation[0] = r.rule.v[0].rotation[1] = angles[k];
        const tz_arrange_params p = params();
        arrange_one(ctx, &stones, &r, &p, &l);
        for (int32_t i = 0; i < l.place.n; i++) {
            double angle, scale;
            bool mirror;
            map_parts(l.place.v[i].map, &angle, &scale, &mirror);
            if (off(angle, angles[k], mirror) > 1e-6)
                fail_msg("placement %d is turned by %g where %g is asked for", i, angle,
                         angles[k]);
        }
        tz_layout_deinit(&l);
        tz_rules_deinit(&r);
    }
}

static void test_rotation_and_scale_range(void **state)
{
    (void)state;
    tz_rules r;
    tz_layout l;
    everywhere(&r);
    r.rule.v[0].rotation[0] = -0.3, r.rule.v[0].rotation[1] = 0.5;
    r.rule.v[0].scale[0] = 0.8, r.rule.v[0].scale[1] = 0.9;
    tz_arrange_params p = params();
    p.mirror = 1;
    arrange_one(ctx, &stones, &r, &p, &l);
    double low = INFINITY, high = -INFINITY;
    for (int32_t i = 0; i < l.place.n; i++) {
        double angle, scale;
        bool mirror;
        map_parts(l.place.v[i].map, &angle, &scale, &mirror);
        if (!(angle >= -0.3 - 1e-9 && angle <= 0.5 + 1e-9 && !mirror))
            fail_msg("placement %d is turned by %g", i, angle);
        if (!(scale >= 0.8 - 1e-9 && scale <= 0.9 + 1e-9))
            fail_msg("placement %d is scaled by %g", i, scale);
        low = fmin(low, angle), high = fmax(high, angle);
    }
    assert_true(high - low > 0.3); /* the range is made use of */
    tz_layout_deinit(&l);
    tz_rules_deinit(&r);
}

/* Two regions with an angle each: away from their border nothing of the other comes
 * in. */
static void test_angle_by_region(void **state)
{
    (void)state;
    tz_rules r;
    tz_layout l;
    everywhere(&r);
    r.rule.v[0].rotation[0] = r.rule.v[0].rotation[1] = 0;
    tz_rule *q = right_half(&r);
    q->rotation[0] = q->rotation[1] = 1.2;
    q->scale[0] = q->scale[1] = 1.3;
    tz_arrange_params p = params();
    p.mirror = 1;
    p.coherence = 1; /* what runs on must not bring its angle along */
    arrange_one(ctx, &stones, &r, &p, &l);
    int count[2] = {0, 0};
    for (int32_t i = 0; i < l.place.n; i++) {
        double angle, scale;
        bool mirror;
        const double x = middle_of(&l, i).x;
        map_parts(l.place.v[i].map, &angle, &scale, &mirror);
        if (fabs(x - W / 2.0) < 100)
            continue; /* chosen for a point of either side */
        const bool right = x > W / 2.0;
        count[right]++;
        if (off(angle, right ? 1.2 : 0, false) > 1e-6 ||
            (right && fabs(scale - 1.3) > 1e-6))
            fail_msg("placement %d at x = %g is turned by %g, scaled by %g", i, x, angle,
                     scale);
    }
    assert_true(count[0] > 2 && count[1] > 2);
    tz_layout_deinit(&l);
    tz_rules_deinit(&r);
}

/* A field: grey 0 .. 1 = 0 .. 2 pi from left to right; pieces follow it where they
 * lie. */
static void test_rotation_field(void **state)
{
    (void)state;
    for (int vector = 0; vector < 2; vector++) {
        tz_rules r;
        tz_layout l;
        everywhere(&r);
        tz_image field = blank(ctx, 64, 8, vector ? 3 : 1);
        for (int32_t y = 0; y < 8; y++)
            for (int32_t x = 0; x < 64; x++) {
                const double a = TZ_PI * (x + 0.5) / 64; /* half a turn over the width */
                float *v = tz_image_at(&field, x, y);
                if (vector)
                    v[0] = (float)(0.5 + 0.5 * cos(a)),
                    v[1] = (float)(0.5 + 0.5 * sin(a));
                else
                    v[0] = (float)(a / 2 / TZ_PI);
            }
        assert_int_equal(tz_array_push(ctx, &r.mask, field), TZ_OK);
        r.rule.v[0].field = 0;
        r.rule.v[0].rotation[0] = r.rule.v[0].rotation[1] = 0;
        tz_arrange_params p = params();
        p.mirror = 1;
        arrange_one(ctx, &stones, &r, &p, &l);
        double worst = 0;
        for (int32_t i = 0; i < l.place.n; i++) {
            double angle, scale;
            bool mirror;
            map_parts(l.place.v[i].map, &angle, &scale, &mirror);
            const double want = TZ_PI * middle_of(&l, i).x / W;
            if (middle_of(&l, i).x > 20 && middle_of(&l, i).x < W - 20)
                worst = fmax(worst, off(angle, want, false));
        }
        /* the field is read at the piece's centre, near its middle; it is moved a little
         * afterwards until it fits: 60 px are 0.26 rad here */
        if (worst > 0.3)
            fail_msg("a piece is off the field by %g rad", worst);
        tz_layout_deinit(&l);
        tz_rules_deinit(&r);
    }
}

/* ---- which photo where ------------------------------------------------------------- */

static void test_source_by_region(void **state)
{
    (void)state;
    for (int feather = 0; feather < 2; feather++) {
        tz_rules r;
        tz_layout l;
        everywhere(&r);
        r.rule.v[0].source = 0;
        tz_rule *q = right_half(&r);
        q->source = 1;
        q->feather = feather ? 120 : 0;
        arrange_both(&r, &l);
        int32_t count[2] = {0, 0};
        for (int32_t i = 0; i < l.place.n; i++) {
            const double x = middle_of(&l, i).x - W / 2.0;
            count[l.place.v[i].source]++;
            if (fabs(x) < 80 + (feather ? 60 : 0))
                continue;
            if (l.place.v[i].source != (x > 0))
                fail_msg("a piece of photo %d lies %g px across the border",
                         l.place.v[i].source, x);
        }
        assert_true(count[0] > 3 && count[1] > 3);
        tz_layout_deinit(&l);
        tz_rules_deinit(&r);
    }
}

static void test_source_by_mask(void **state)
{
    (void)state;
    tz_rules r;
    tz_layout l;
    everywhere(&r);
    r.rule.v[0].source = 0;
    tz_image mask = blank(ctx, 2, 2, 1); /* the lower left quarter */
    *tz_image_at(&mask, 0, 1) = 1;
    assert_int_equal(tz_array_push(ctx, &r.mask, mask), TZ_OK);
    tz_rule q = tz_rule_default();
    q.mask = 0, q.source = 1;
    assert_int_equal(tz_array_push(ctx, &r.rule, q), TZ_OK);
    arrange_both(&r, &l);
    int32_t inside = 0;
    for (int32_t i = 0; i < l.place.n; i++) {
        const tz_vec2 m = middle_of(&l, i);
        const bool second = l.place.v[i].source == 1;
        if (m.x < W / 4.0 && m.y > 3 * H / 4.0)
            assert_true(second), inside++;
        if (m.x > 0.8 * W || m.y < 0.2 * H)
            assert_false(second);
    }
    assert_true(inside > 0);
    tz_layout_deinit(&l);
    tz_rules_deinit(&r);
}

/* ---- structure --------------------------------------------------------------------- */

static void test_structures_cover(void **state)
{
    (void)state;
    static const int32_t structures[] = {TZ_STRUCTURE_EXEMPLAR, TZ_STRUCTURE_RANDOM,
                                         TZ_STRUCTURE_GRANULAR};
    uint64_t hash[3];
    for (int k = 0; k < 3; k++) {
        tz_rules r;
        tz_layout l;
        everywhere(&r);
        r.rule.v[0].structure = structures[k];
        tz_arrange_params p = params();
        p.size[0] = 400, p.size[1] = 300;
        arrange_one(ctx, &stones, &r, &p, &l);
        assert_sound(&l, &stones.exemplar, 1, 2);
        double farthest;
        const int64_t bare = bare_pixels(&l, &farthest);
        /* specks of a pixel or two along the borders, and grains have more of these */
        const double most = structures[k] == TZ_STRUCTURE_GRANULAR ? 0.03 : 0.005;
        if (farthest > 6 || bare > most * 400 * 300)
            fail_msg("structure %d: %d of %d px are in no border, the farthest by %g px",
                     k, (int)bare, 400 * 300, farthest);
        hash[k] = layout_hash(&l);
        tz_layout_deinit(&l);
        tz_rules_deinit(&r);
    }
    assert_true(hash[0] != hash[1] && hash[1] != hash[2] && hash[0] != hash[2]);
}

/* Twice the density: more pieces, and smaller. */
static void test_density(void **state)
{
    (void)state;
    int32_t count[2];
    for (int k = 0; k < 2; k++) {
        tz_rules r;
        tz_layout l;
        everywhere(&r);
        r.rule.v[0].density = k ? 3 : 1;
        const tz_arrange_params p = params();
        arrange_one(ctx, &stones, &r, &p, &l);
        count[k] = l.place.n;
        tz_layout_deinit(&l);
        tz_rules_deinit(&r);
    }
    if (!(count[1] > 1.5 * count[0]))
        fail_msg("%d pieces at density 3, %d at density 1", count[1], count[0]);
}

/* Each preset's rule file is read and arranged with. */
static void test_presets(void **state)
{
    (void)state;
    static const char *const names[] = {"angle-by-region",
                                        "as-exemplar",
                                        "fine-gravel",
                                        "fixed-angle",
                                        "long-edges",
                                        "random-and-granular",
                                        "swirl",
                                        "two-sources",
                                        "wind",
                                        "patches-of-second-source"};
    const tz_exemplar ex[2] = {stones.exemplar, bricks.exemplar};
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
        char path[256];
        snprintf(path, sizeof path, TZ_SOURCE_DIR "/data/presets/%s.json", names[k]);
        tz_rules r = {0};
        const tz_status s = tz_rules_read(ctx, path, &r);
        if (s != TZ_OK)
            fail_msg("%s", tz_ctx_message(ctx));
        tz_arrange_params p = arrange_params(300, 240, 1, false);
        p.effort = 1;
        tz_layout l = {0};
        if (tz_arrange(ctx, ex, 2, &r, &p, &l) != TZ_OK)
            fail_msg("%s: %s", names[k], tz_ctx_message(ctx));
        assert_sound(&l, ex, 2, 2);
        tz_layout_deinit(&l);
        tz_rules_deinit(&r);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_whitelist),
        cmocka_unit_test(test_size_limits),
        cmocka_unit_test(test_bins),
        cmocka_unit_test(test_impossible_rule),
        cmocka_unit_test(test_fixed_angle),
        cmocka_unit_test(test_rotation_and_scale_range),
        cmocka_unit_test(test_angle_by_region),
        cmocka_unit_test(test_rotation_field),
        cmocka_unit_test(test_source_by_region),
        cmocka_unit_test(test_source_by_mask),
        cmocka_unit_test(test_structures_cover),
        cmocka_unit_test(test_density),
        cmocka_unit_test(test_presets),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
