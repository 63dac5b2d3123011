/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Element fields: laws that hold for any problem. Energies fall in each step, threads do
 * not matter, brushes touch what lies about them, a cancelled fill is whole, and so is one
 * that ran out of memory. */
#include "tests/base/check.h"

#include <pthread.h>

#include "base/rng.h"
#include "fields/disc_cover.h"
#include "tests/fields/filling.h"

/* ---- energies ----------------------------------------------------------------------- */

typedef struct watch {
    int problem, calls;
} watch;

static bool falls(void *user, const tz_fill *fill, int32_t iteration,
                  const tz_fill_energy *e)
{
    watch *w = user;
    (void)fill;
    for (int k = 0; k < 4; k++)
        if (!(e->after[k] <= e->before[k] * (1 + 1e-9) + 1e-9))
            fail_msg("problem %d, iteration %d: step %d raises its energy from %.9g to "
                     "%.9g",
                     w->problem, iteration, k, e->before[k], e->after[k]);
    w->calls++;
    return true;
}

static double between(tz_rng *g, double a, double b)
{
    return a * pow(b / a, tz_rng_unit(g));
}

/* Strokes anywhere, of any say. */
static void add_strokes(bed *b, tz_rng *g)
{
    const int32_t n = tz_rng_below(g, 5);
    const double side = b->domain.size.x;
    tz_element_field_deinit(&b->field);
    ok(b->ctx,
       tz_element_field_init(b->ctx, b->domain.size, b->domain.torus, 96, &b->field));
    for (int32_t k = 0; k < n; k++) {
        tz_element_field_point p[4];
        const double size = tz_rng_below(g, 2) ? between(g, 0.5, 2) : 0;
        const double density = tz_rng_below(g, 2) ? tz_rng_unit(g) : -1;
        for (int i = 0; i < 4; i++)
            p[i] = (tz_element_field_point){
                {tz_rng_unit(g) * side, tz_rng_unit(g) * side}, size, density};
        const tz_element_field_stroke s = {.radius = between(g, 0.1, 0.2 * side),
                                           .weight = between(g, 1e-3, 1e3),
                                           .directed = tz_rng_below(g, 4) > 0,
                                           .closed = tz_rng_below(g, 2)};
        ok(b->ctx, tz_element_field_add(&b->field, s, 1 + tz_rng_below(g, 4), p));
    }
    ok(b->ctx, tz_element_field_settle(&b->field));
}

/* A ring, a letter, or nothing: by masks. */
static tz_region *any_region(tz_ctx *ctx, const tz_domain *d, int32_t which)
{
    enum { SIDE = 48 };
    float mask[SIDE * SIDE];
    tz_region *r = NULL;
    if (which == 0)
        return NULL;
    for (int i = 0; i < SIDE * SIDE; i++) {
        const double x = i % SIDE - SIDE / 2 + 0.5, y = i / SIDE - SIDE / 2 + 0.5;
        const double l = hypot(x, y);
        mask[i] = which == 1 ? l < 0.48 * SIDE && l > 0.16 * SIDE
                             : x < -0.1 * SIDE || y > 0.15 * SIDE;
    }
    ok(ctx, tz_region_from_mask(ctx, mask, SIDE, SIDE, d->size, d->torus, &r));
    return r;
}

static void energies_fall_whatever_is_filled(void **state)
{
    (void)state;
    static const double rigidity[] = {0, 0.01, 1, 10, 50, 99, 99.999, 100, 1e6};
    for (int problem = 0; problem < 48; problem++) {
        bed b;
        tz_rng g = tz_rng_make(77, (uint64_t)problem);
        watch w = {problem, 0};
        bed_lay(&b, 1 + problem % 2, 110, 1, 12);
        b.domain.torus = b.job.domain.torus = problem % 3 == 0;
        tz_region *region = any_region(b.ctx, &b.domain, problem % 5 % 3);
        b.domain.region = b.job.domain.region = region;
        add_strokes(&b, &g);
        b.params.alpha = problem % 7 == 0 ? 0 : between(&g, 1e-3, 1e3);
        b.params.beta = problem % 6 == 0 ? 0 : between(&g, 1e-3, 1e3);
        b.params.discs = 1 + tz_rng_below(&g, TZ_COVER_DISCS);
        b.params.fill = between(&g, 0.2, 1.4);
        b.params.start = tz_rng_below(&g, 2);
        b.params.repair = false;
        tz_fill_entry e[3];
        for (int k = 0; k < 3; k++) {
            const double lo = between(&g, 0.4, 1);
            e[k] = (tz_fill_entry){k,
                                   0.2 + tz_rng_unit(&g),
                                   rigidity[(problem + k) % 9],
                                   {lo, lo * between(&g, 1, 2)},
                                   6 * tz_rng_unit(&g),
                                   tz_rng_unit(&g)};
        }
        b.job.entry = e, b.job.entries = 3;
        b.job.seed = (uint64_t)problem;
        b.job.trace = falls, b.job.user = &w;
        tz_element_set_deinit(&b.layout);
        ok(b.ctx, tz_element_set_like(b.ctx, &b.palette, &b.domain, &b.layout));
        ok(b.ctx, tz_fill_run(b.ctx, &b.job, &b.layout, NULL));
        filling_sound(b.ctx, &b.layout);
        assert_true(w.calls >= 12);
        tz_region_free(region);
        bed_clear(&b);
    }
}

/* ---- threads ------------------------------------------------------------------------ */

/* Everything there is: insertion, teleports, iterations, repair, brushes. */
static void threads_do_not_matter_to_repair_and_brushes(void **state)
{
    (void)state;
    static const int threads[] = {1, 2, 8};
    tz_element *first = NULL;
    tz_sample *samples = NULL;
    int32_t n = 0, m = 0;
    for (int t = 0; t < 3; t++) {
        bed b;
        tz_fill *f;
        bed_lay(&b, threads[t], 420, 1, 8);
        const tz_fill_entry e[3] = {{0, 1, 100, {0.6, 1.4}, 0, 0.2},
                                    {1, 1, 100, {0.5, 2}, 0, 0},
                                    {2, 1, 5, {1, 1}, 0, 0}};
        const tz_vec2 stroke[3] = {{60, 60}, {200, 90}, {300, 300}};
        b.job.entry = e, b.job.entries = 3;
        ok(b.ctx, tz_fill_begin(b.ctx, &b.job, &b.layout, &f));
        ok(b.ctx, tz_fill_settle(f, 6));
        ok(b.ctx, tz_fill_replace(f, 3, stroke, 30, -1, 0.8));
        ok(b.ctx, tz_fill_settle(f, 6));
        ok(b.ctx, tz_fill_erase(f, 1, &stroke[2], 25));
        ok(b.ctx, tz_fill_add(f, 1, &stroke[2], 25, 2, 1.2));
        ok(b.ctx, tz_fill_settle(f, 6));
        tz_fill_wake_all(f);
        ok(b.ctx, tz_fill_settle(f, 3));
        ok(b.ctx, tz_fill_write(f, &b.layout));
        filling_sound(b.ctx, &b.layout);
        if (t == 0) {
            n = b.layout.element.n, m = b.layout.sample.n;
            first = malloc((size_t)n * sizeof *first);
            samples = malloc((size_t)m * sizeof *samples);
            assert_true(first && samples);
            memcpy(first, b.layout.element.v, (size_t)n * sizeof *first);
            memcpy(samples, b.layout.sample.v, (size_t)m * sizeof *samples);
        }
        assert_int_equal(n, b.layout.element.n);
        assert_int_equal(m, b.layout.sample.n);
        for (int32_t i = 0; i < n; i++) {
            const tz_element *p = &first[i], *q = &b.layout.element.v[i];
            assert_memory_equal(&p->at, &q->at, sizeof p->at);
            assert_true(p->angle == q->angle && p->scale == q->scale);
            assert_int_equal(p->source, q->source);
        }
        for (int32_t i = 0; i < m; i++)
            assert_memory_equal(&samples[i].at, &b.layout.sample.v[i].at,
                                sizeof samples->at);
        tz_fill_end(f);
        bed_clear(&b);
    }
    assert_true(n > 800);
    free(first);
    free(samples);
}

/* ---- brushes ------------------------------------------------------------------------ */

/* Elements of one layout that lie in another as they are. */
static int32_t same_places(const tz_element_set *a, const tz_element_set *b)
{
    int32_t n = 0;
    for (int32_t i = 0; i < a->element.n; i++) {
        const tz_element *p = &a->element.v[i];
        for (int32_t k = 0; k < b->element.n; k++) {
            const tz_element *q = &b->element.v[k];
            if (p->at.x == q->at.x && p->at.y == q->at.y && p->angle == q->angle &&
                p->scale == q->scale) {
                n++;
                break;
            }
        }
    }
    return n;
}

static double to_line(const tz_domain *d, tz_vec3 p, tz_vec2 a, tz_vec2 b)
{
    double least = HUGE_VAL;
    for (int k = 0; k <= 256; k++) {
        const tz_vec3 q = {a.x + (b.x - a.x) * k / 256, a.y + (b.y - a.y) * k / 256, 0};
        const tz_vec3 v = tz_domain_vector(d, q, p);
        least = fmin(least, hypot(v.x, v.y));
    }
    return least;
}

/* In the plane and over the border of a tile, where a stroke is longer than half of it. */
static void brushes_touch_their_surroundings_only(void **state)
{
    (void)state;
    const double reach = 40, radius = 18; /* of the largest thing, and what gives way */
    const tz_vec2 strokes[3][2] = {
        {{60, 60}, {90, 70}}, {{20, 150}, {280, 150}}, {{250, 40}, {340, 40}}};
    for (int k = 0; k < 6; k++) {
        bed b;
        tz_fill *f;
        tz_element_set old;
        const bool torus = k >= 3;
        const tz_vec2 *v = strokes[k % 3];
        if (!torus && k % 3 == 2)
            continue; /* out of the plane */
        bed_lay(&b, 1, 300, 1, 0);
        tz_element_field_deinit(&b.field);
        b.job.field = NULL;
        b.domain.torus = b.job.domain.torus = torus;
        tz_element_set_deinit(&b.layout);
        ok(b.ctx, tz_element_set_like(b.ctx, &b.palette, &b.domain, &b.layout));
        ok(b.ctx, tz_element_set_like(b.ctx, &b.palette, &b.domain, &old));
        ok(b.ctx, tz_fill_begin(b.ctx, &b.job, &b.layout, &f));
        ok(b.ctx, tz_fill_settle(f, 15));
        ok(b.ctx, tz_fill_write(f, &old));
        ok(b.ctx, tz_fill_erase(f, 2, v, radius));
        ok(b.ctx, tz_fill_write(f, &b.layout));
        /* what is left lies as it lay, and nothing under the brush is left */
        assert_int_equal(same_places(&b.layout, &old), b.layout.element.n);
        for (int32_t i = 0; i < b.layout.element.n; i++)
            assert_true(to_line(&b.domain, b.layout.element.v[i].at, v[0], v[1]) >
                        radius - 8); /* by middles of discs */
        for (int32_t i = 0; i < old.element.n; i++)
            if (to_line(&b.domain, old.element.v[i].at, v[0], v[1]) > radius + 8) {
                bool there = false;
                for (int32_t e = 0; e < b.layout.element.n && !there; e++)
                    there = b.layout.element.v[e].at.x == old.element.v[i].at.x &&
                            b.layout.element.v[e].at.y == old.element.v[i].at.y;
                assert_true(there);
            }
        const int32_t left = b.layout.element.n;
        ok(b.ctx, tz_fill_add(f, 2, v, radius, -1, 1));
        ok(b.ctx, tz_fill_settle(f, 8));
        ok(b.ctx, tz_fill_write(f, &b.layout));
        filling_sound(b.ctx, &b.layout);
        assert_true(b.layout.element.n > left);
        int32_t far = 0, moved = 0;
        for (int32_t i = 0; i < old.element.n; i++) {
            const tz_element *p = &old.element.v[i];
            if (to_line(&b.domain, p->at, v[0], v[1]) < radius + 2 * reach)
                continue;
            bool there = false;
            for (int32_t e = 0; e < b.layout.element.n && !there; e++)
                there = b.layout.element.v[e].at.x == p->at.x &&
                        b.layout.element.v[e].at.y == p->at.y;
            far++, moved += !there;
        }
        assert_true(far > 20);
        assert_int_equal(moved, 0);
        tz_fill_end(f);
        tz_element_set_deinit(&old);
        bed_clear(&b);
    }
}

/* ---- cancelling --------------------------------------------------------------------- */

typedef struct stopper {
    tz_ctx *ctx;
    int32_t calls, at;
} stopper;

static bool stop(void *user, const tz_fill *fill, int32_t iteration,
                 const tz_fill_energy *e)
{
    stopper *s = user;
    (void)fill, (void)iteration, (void)e;
    if (++s->calls == s->at)
        tz_ctx_cancel(s->ctx);
    return true;
}

/* At each iteration, those of the start among them: the layout is as it was. */
static void cancel_leaves_the_layout_alone(void **state)
{
    (void)state;
    bool done = false;
    for (int32_t at = 1; !done; at++) {
        bed b;
        bed_lay(&b, 2, 110, 1, 6);
        stopper s = {b.ctx, 0, at};
        ok(b.ctx,
           tz_element_set_place(&b.layout, &b.palette, 1, (tz_vec3){50, 50, 0}, 0.5, 1));
        const tz_element one = b.layout.element.v[0];
        b.job.trace = stop, b.job.user = &s;
        const tz_status st = tz_fill_run(b.ctx, &b.job, &b.layout, NULL);
        done = s.calls < at;
        if (done) {
            ok(b.ctx, st);
            assert_true(at > 8);
        } else {
            assert_int_equal(st, TZ_CANCELLED);
            assert_int_equal(b.layout.element.n, 1);
            assert_memory_equal(&one, &b.layout.element.v[0], sizeof one);
            tz_ctx_clear(b.ctx);
        }
        bed_clear(&b);
    }
}

typedef struct late {
    tz_ctx *ctx;
    useconds_t after;
} late;

static void *cancel_late(void *arg)
{
    const late *l = arg;
    usleep(l->after);
    tz_ctx_cancel(l->ctx);
    return NULL;
}

/* From another thread at any moment of iterations, repair and brushes: the fill is whole,
 * can be written, and goes on to the same quality. */
static void cancelled_fills_are_whole(void **state)
{
    (void)state;
    for (int k = 0; k < 12; k++) {
        bed b;
        tz_fill *f;
        tz_fill_report r;
        pthread_t thread;
        bed_lay(&b, 2, 260, 1, 0);
        ok(b.ctx, tz_fill_begin(b.ctx, &b.job, &b.layout, &f));
        ok(b.ctx, tz_fill_iterate(f, 5, NULL));
        late l = {b.ctx, (useconds_t)(k * 4000)};
        assert_int_equal(pthread_create(&thread, NULL, cancel_late, &l), 0);
        const tz_vec2 at = {100, 100};
        tz_status s = TZ_OK;
        for (int round = 0; round < 1000 && s == TZ_OK; round++) {
            s = k % 2 ? tz_fill_repair(f) : tz_fill_replace(f, 1, &at, 30, -1, 1);
            if (s == TZ_OK)
                s = tz_fill_settle(f, 3);
        }
        assert_int_equal(pthread_join(thread, NULL), 0);
        assert_int_equal(s, TZ_CANCELLED);
        tz_ctx_clear(b.ctx);
        ok(b.ctx, tz_fill_write(f, &b.layout));
        filling_sound(b.ctx, &b.layout);
        assert_true(b.layout.element.n > 200);
        tz_fill_wake_all(f);
        ok(b.ctx, tz_fill_settle(f, 10));
        ok(b.ctx, tz_fill_write(f, &b.layout));
        filling_sound(b.ctx, &b.layout);
        ok(b.ctx, tz_fill_measure(b.ctx, &b.layout, &b.palette, &b.field, 512, &r));
        assert_true(r.overlap < 0.01);
        assert_true(r.covered > 0.5);
        tz_fill_end(f);
        bed_clear(&b);
    }
}

/* ---- memory ------------------------------------------------------------------------- */

typedef tz_status (*act)(tz_fill *f);

static tz_status iterate(tz_fill *f) { return tz_fill_iterate(f, 1, NULL); }
static tz_status settle(tz_fill *f) { return tz_fill_settle(f, 1); }
static tz_status replace(tz_fill *f)
{
    const tz_vec2 at = {20, 20};
    return tz_fill_replace(f, 1, &at, 8, -1, 1);
}
static tz_status erase(tz_fill *f)
{
    const tz_vec2 at = {8, 8};
    return tz_fill_erase(f, 1, &at, 6);
}

/* What fails for want of memory can be asked for again, and all is as if it had not. */
static void want_of_memory_leaves_fills_whole(void **state)
{
    (void)state;
    static const act acts[] = {iterate, tz_fill_repair, replace, settle, erase, settle};
    for (int64_t n = 1, left = 1; left > 0; n += 3) {
        tz_ctx *ctx = NULL;
        const tz_ctx_options opt = {.threads = 1, .fail_alloc = n};
        tz_element_set palette, layout;
        tz_fill_params p = filling_params(2);
        tz_fill *f = NULL;
        p.rigidity = 50;
        const tz_domain d = {.size = {42, 42, 0}};
        const tz_fill_job job = {
            .palette = &palette, .domain = d, .params = &p, .seed = 2};
        assert_int_equal(tz_ctx_new(&opt, &ctx), TZ_OK);
        int failed = 0;
#define AGAIN(call)                            \
    do {                                       \
        tz_status s_ = call;                   \
        if (s_ == TZ_NOMEM) {                  \
            failed++;                          \
            assert_true(*tz_ctx_message(ctx)); \
            tz_ctx_clear(ctx);                 \
            s_ = call;                         \
        }                                      \
        ok(ctx, s_);                           \
    } while (0)
        AGAIN(filling_palette(ctx, 1, &palette));
        AGAIN(tz_element_set_like(ctx, &palette, &d, &layout));
        AGAIN(tz_fill_begin(ctx, &job, &layout, &f));
        for (size_t k = 0; k < sizeof acts / sizeof *acts; k++)
            AGAIN(acts[k](f));
        AGAIN(tz_fill_write(f, &layout));
        filling_sound(ctx, &layout);
        filling_inside(&d, &layout);
        assert_true(layout.element.n > 2);
        tz_fill_end(f);
        tz_element_set_deinit(&palette);
        tz_element_set_deinit(&layout);
        end_ctx(ctx);
        left = failed;
        assert_true(n < 100000);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(energies_fall_whatever_is_filled),
        cmocka_unit_test(threads_do_not_matter_to_repair_and_brushes),
        cmocka_unit_test(brushes_touch_their_surroundings_only),
        cmocka_unit_test(cancel_leaves_the_layout_alone),
        cmocka_unit_test(cancelled_fills_are_whole),
        cmocka_unit_test(want_of_memory_leaves_fills_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
