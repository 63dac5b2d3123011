/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Drawing with predictions: completing, cloning, taking and leaving. */
#include "tests/base/check.h"

#include <math.h>

#include "curves/curve_io.h"
#include "curves/predict.h"

enum { W = 240, H = 200 };

static tz_ctx *ctx;
static tz_curve_set drawing;
static tz_region *hole, *left;
static tz_curve_prediction p;

/* Where a hole of radius 40 is left at 120, 100. */
static bool inside(double x, double y) { return hypot(x - 120, y - 100) < 40; }

static void append_run(char *text, size_t size, double x0, double y0, double dx,
                       double dy, int n)
{
    bool pen = false;
    for (int k = 0; k <= n; k++) {
        const double x = x0 + k * dx, y = y0 + k * dy;
        const size_t at = strlen(text);
        if (inside(x, y)) {
            if (pen)
                snprintf(text + at, size - at, "'/>");
            pen = false;
            continue;
        }
        snprintf(text + at, size - at, pen ? "L%g %g" : "<path d='M%g %g", x, y);
        pen = true;
    }
    if (pen)
        strcat(text, "'/>");
}

static tz_status draw(tz_ctx *c, tz_curve_set *s)
{
    static char text[200000];
    strcpy(text, "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 240 200'><g "
                 "fill='none' stroke='#234' stroke-width='1'>");
    for (int y = 10; y < H; y += 20)
        append_run(text, sizeof text, 0, y, 4, 0, W / 4);
    for (int x = 15; x < W; x += 30)
        append_run(text, sizeof text, x, 0, 0, 4, H / 4);
    strcat(text, "</g></svg>");
    return tz_curve_parse_svg(c, "net.svg", text, strlen(text), NULL, s);
}

static tz_status region(tz_ctx *c, bool (*in)(double, double), tz_region **out)
{
    static float mask[W * H];
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++)
            mask[y * W + x] = in(x + 0.5, y + 0.5);
    return tz_region_from_mask(c, mask, W, H, (tz_vec3){W, H, 0}, false, out);
}

static bool in_left(double x, double y) { return x < 75 && y > 5; }
static bool nowhere_drawn(double x, double y) { return inside(x, y); }
static bool everywhere(double x, double y)
{
    (void)x;
    (void)y;
    return true;
}

static int begin(void **state)
{
    (void)state;
    ctx = new_ctx(2);
    ok(ctx, draw(ctx, &drawing));
    ok(ctx, region(ctx, inside, &hole));
    ok(ctx, region(ctx, in_left, &left));
    return 0;
}

static int end(void **state)
{
    (void)state;
    tz_curve_prediction_deinit(&p);
    tz_region_free(hole);
    tz_region_free(left);
    tz_curve_set_deinit(&drawing);
    memset(&drawing, 0, sizeof drawing);
    end_ctx(ctx);
    return 0;
}

static double length_in(const tz_curve_set *s, bool within)
{
    double sum = 0;
    for (int32_t i = 0; i < s->piece.n; i++) {
        const tz_bezier c = tz_curve_bezier(s, &s->piece.v[i]);
        const double n = tz_bezier_length(&c);
        for (int k = 0; k < 16; k++) {
            const tz_vec2 at = tz_bezier_at(&c, (k + 0.5) / 16);
            sum += inside(at.x, at.y) == within ? n / 16 : 0;
        }
    }
    return sum;
}

static int32_t loose_ends(const tz_curve_set *s)
{
    int32_t *uses = calloc((size_t)s->node.n, sizeof *uses), n = 0;
    for (int32_t i = 0; i < s->piece.n; i++) {
        uses[s->piece.v[i].from]++;
        uses[s->piece.v[i].to]++;
    }
    for (int32_t i = 0; i < s->node.n; i++)
        n += uses[i] == 1 && hypot(s->node.v[i].x - 120, s->node.v[i].y - 100) < 60;
    free(uses);
    return n;
}

static void predict(const tz_region *from)
{
    const tz_curve_predict_job job = {
        .drawing = &drawing, .from = from, .to = hole, .seed = 1};
    tz_curve_prediction_deinit(&p);
    ok(ctx, tz_curve_predict(ctx, &job, &p));
    ok(ctx, tz_curve_set_check(ctx, &p.set, "prediction"));
    assert_int_equal(p.path.n, p.set.path.n);
    assert_int_equal(p.element.n, p.set.element.element.n);
    for (int32_t i = 0; i < p.path.n; i++)
        assert_int_equal(p.path.v[i], TZ_CURVE_OPEN);
}

/* The hole is filled as densely as the drawing, nothing is drawn far outside of it, and
 * most loose ends are gone. */
static void test_complete(void **state)
{
    (void)state;
    const double dense = length_in(&drawing, false) / (W * H - TZ_PI * 1600);
    const int32_t before = loose_ends(&drawing), paths = drawing.path.n;
    predict(NULL);
    const double in = length_in(&p.set, true), out = length_in(&p.set, false);
    if (fabs(in / (TZ_PI * 1600 * dense) - 1) > 0.3)
        fail_msg("%g of the length that is wanted", in / (TZ_PI * 1600 * dense));
    assert_true(out < 0.25 * in);
    assert_true(tz_curve_predict_mark(&p, NULL, TZ_CURVE_TAKEN) == p.set.path.n);
    ok(ctx, tz_curve_predict_accept(ctx, &p, &drawing));
    ok(ctx, tz_curve_set_check(ctx, &drawing, "drawing"));
    assert_int_equal(p.set.path.n, 0);
    assert_true(drawing.path.n > paths);
    if (loose_ends(&drawing) > before / 4)
        fail_msg("%d of %d loose ends stay", loose_ends(&drawing), before);
    assert_int_equal(drawing.origin.n, 0); /* a drawing without a photo has none */
}

static void test_clone(void **state)
{
    (void)state;
    const double dense = length_in(&drawing, false) / (W * H - TZ_PI * 1600);
    predict(left);
    const double in = length_in(&p.set, true);
    if (fabs(in / (TZ_PI * 1600 * dense) - 1) > 0.4)
        fail_msg("%g of the length that is wanted", in / (TZ_PI * 1600 * dense));
}

/* What is taken goes into the drawing, what is left goes away, what is open stays. */
static void test_choices(void **state)
{
    (void)state;
    predict(NULL);
    const int32_t n = p.set.path.n, paths = drawing.path.n;
    assert_true(n >= 3);
    const tz_curve_path *first = &p.set.path.v[0];
    const tz_vec2 at = p.set.node.v[p.set.piece.v[first->piece].from];
    const int32_t hit = tz_curve_predict_mark_at(&p, at, 1, TZ_CURVE_TAKEN);
    assert_in_range(hit, 0, n - 1);
    assert_int_equal(tz_curve_predict_mark_at(&p, (tz_vec2){1, 1}, 1, TZ_CURVE_TAKEN),
                     -1);
    p.path.v[(hit + 1) % n] = TZ_CURVE_LEFT;
    ok(ctx, tz_curve_predict_accept(ctx, &p, &drawing));
    assert_int_equal(drawing.path.n, paths + 1);
    assert_int_equal(p.set.path.n, n - 2);
    assert_int_equal(p.path.n, n - 2);
    ok(ctx, tz_curve_set_check(ctx, &p.set, "rest"));
    /* by region: all of it lies in the hole, or next to it */
    assert_true(tz_curve_predict_mark(&p, hole, TZ_CURVE_LEFT) > (n - 2) / 2);
}

static void test_again(void **state)
{
    (void)state;
    const tz_curve_predict_job job = {.drawing = &drawing, .to = hole, .seed = 1};
    predict(NULL);
    p.path.v[0] = TZ_CURVE_TAKEN;
    const int32_t paths = drawing.path.n;
    const tz_bezier kept = tz_curve_bezier(&p.set, &p.set.piece.v[0]);
    ok(ctx, tz_curve_predict_again(ctx, &job, &p));
    ok(ctx, tz_curve_set_check(ctx, &p.set, "again"));
    assert_int_equal(p.round, 1);
    assert_int_equal(p.path.n, p.set.path.n);
    assert_int_equal(p.path.v[0], TZ_CURVE_TAKEN);
    const tz_bezier now = tz_curve_bezier(&p.set, &p.set.piece.v[0]);
    assert_true(hypot(kept.p[0].x - now.p[0].x, kept.p[0].y - now.p[0].y) < 1e-9);
    for (int32_t i = 1; i < p.path.n; i++)
        assert_int_equal(p.path.v[i], TZ_CURVE_OPEN);
    assert_int_equal(drawing.path.n, paths); /* not changed by it */
}

static void test_bad(void **state)
{
    (void)state;
    tz_region *all, *other, *blank;
    ok(ctx, region(ctx, everywhere, &all));
    ok(ctx, region(ctx, nowhere_drawn, &blank));
    static float one[4] = {1, 1, 1, 1};
    ok(ctx, tz_region_from_mask(ctx, one, 2, 2, (tz_vec3){10, 10, 0}, false, &other));
    tz_curve_predict_job job = {.drawing = &drawing, .to = all};
    fails(ctx, tz_curve_predict(ctx, &job, &p), TZ_INVALID, "nothing is drawn outside");
    assert_null(p.set.path.v);
    job.to = other;
    fails(ctx, tz_curve_predict(ctx, &job, &p), TZ_INVALID, "does not span");
    job.to = hole;
    job.from = blank; /* the hole itself */
    fails(ctx, tz_curve_predict(ctx, &job, &p), TZ_INVALID, "nothing is drawn");
    job.from = NULL;
    tz_ctx_cancel(ctx);
    assert_int_equal(tz_curve_predict(ctx, &job, &p), TZ_CANCELLED);
    tz_ctx_clear(ctx);
    tz_region_free(all);
    tz_region_free(other);
    tz_region_free(blank);
}

static void test_memory(void **state)
{
    (void)state;
    int64_t n = 1;
    for (int k = 0; k < 30; k++, n += 1 + n / 2) {
        tz_ctx *c = NULL;
        tz_curve_set d = {0};
        tz_region *to = NULL;
        tz_curve_prediction q = {0};
        const tz_ctx_options opt = {.threads = 1, .fail_alloc = n};
        assert_int_equal(tz_ctx_new(&opt, &c), TZ_OK);
        tz_status s = draw(c, &d);
        if (s == TZ_OK)
            s = region(c, inside, &to);
        const tz_curve_predict_job job = {.drawing = &d, .to = to};
        if (s == TZ_OK)
            s = tz_curve_predict(c, &job, &q);
        if (s == TZ_OK) {
            tz_curve_predict_mark(&q, NULL, TZ_CURVE_TAKEN);
            const int32_t paths = d.path.n;
            s = tz_curve_predict_accept(c, &q, &d);
            assert_true((s == TZ_OK) == (d.path.n > paths));
        }
        assert_true(s == TZ_OK || s == TZ_NOMEM);
        tz_curve_prediction_deinit(&q);
        tz_region_free(to);
        tz_curve_set_deinit(&d);
        end_ctx(c);
        if (s == TZ_OK)
            return;
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_complete, begin, end),
        cmocka_unit_test_setup_teardown(test_clone, begin, end),
        cmocka_unit_test_setup_teardown(test_choices, begin, end),
        cmocka_unit_test_setup_teardown(test_again, begin, end),
        cmocka_unit_test_setup_teardown(test_bad, begin, end),
        cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
