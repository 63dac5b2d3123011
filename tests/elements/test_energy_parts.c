/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Parts of the energy solver against slower ways: pairing, cells, least squares, the
 * border's term. */
#include "tests/base/check.h"

#include <math.h>

#include "base/lsq.h"
#include "elements/energy_internal.h"
#include "tests/elements/patterns.h"

static tz_energy_params defaults(void)
{
    tz_energy_params p;
    tz_params_default(&tz_energy_param_table, &p);
    return p;
}

/* ---- pairing --------------------------------------------------------------------- */

/* Least cost of all pairings by trying them: rows i.., columns not in `used`. */
static double brute(const tz_pairing *w, const tz_pairing_side *p,
                    const tz_pairing_side *q, int32_t i, unsigned used)
{
    if (i == p->n)
        return 0;
    const double weight = w->weight ? (double)w->weight[i] : 1;
    double best = weight * (double)w->limit + brute(w, p, q, i + 1, used);
    for (int32_t j = 0; j < q->n; j++) {
        if (used >> j & 1)
            continue;
        const double dx = (double)(p->x[i] - q->x[j]), dy = (double)(p->y[i] - q->y[j]);
        const double da = (double)(p->a[i] - q->a[j]), db = (double)(p->b[i] - q->b[j]);
        if (p->l[i] != q->l[j])
            continue;
        const double c = weight * (dx * dx + dy * dy + da * da + db * db);
        best = fmin(best, c + brute(w, p, q, i + 1, used | 1u << j));
    }
    return best;
}

static void random_side(tz_rng *r, tz_pairing_side *s, int32_t n, double spread,
                        int32_t labels)
{
    s->n = n;
    for (int32_t i = 0; i < n; i++) {
        s->x[i] = (float)tz_rng_range(r, -spread, spread);
        s->y[i] = (float)tz_rng_range(r, -spread, spread);
        s->a[i] = (float)tz_rng_range(r, 0, 0.3);
        s->b[i] = (float)tz_rng_range(r, 0, 0.3);
        s->l[i] = (float)tz_rng_below(r, labels);
    }
    tz_pairing_sort(s, NULL);
}

static void test_pairing_is_best(void **state)
{
    (void)state;
    static tz_pairing w;
    static tz_pairing_side p, q;
    tz_rng r = tz_rng_make(4, 0);
    for (int round = 0; round < 3000; round++) {
        float weight[8];
        for (int i = 0; i < 8; i++)
            weight[i] = (float)tz_rng_range(&r, 0.5, 2);
        w = (tz_pairing){.attributes = true, .limit = 1};
        w.weight = round % 3 ? NULL : weight;
        const int32_t labels = 1 + round / 2 % 3;
        random_side(&r, &p, tz_rng_below(&r, 6), round % 2 ? 0.3 : 2, labels);
        random_side(&r, &q, tz_rng_below(&r, 10), round % 2 ? 0.3 : 2, labels);
        const double best = brute(&w, &p, &q, 0, 0);
        const float found = tz_pairing_best(&w, &p, &q, INFINITY);
        assert_float_equal(found, best, 2e-5 * (1 + best));
        bool used[TZ_PAIRING_MOST] = {false};
        for (int32_t i = 0; i < p.n; i++)
            if (w.to[i] >= 0) {
                assert_true(w.to[i] < q.n && !used[w.to[i]]);
                assert_true(p.l[i] == q.l[w.to[i]]);
                used[w.to[i]] = true;
            }
        if (best > 0.01) {
            assert_true(isinf(tz_pairing_best(&w, &p, &q, (float)best * 0.99f)));
            assert_false(isinf(tz_pairing_best(&w, &p, &q, (float)best * 1.01f)));
        }
    }
}

/* ---- neighbours ------------------------------------------------------------------ */

static void test_cells(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    for (int torus = 0; torus < 2; torus++) {
        const tz_domain d = {.size = {90, 41, 0}, .torus = torus == 1};
        tz_cells c = {0};
        tz_vec3 p[300];
        tz_nearby out[20];
        tz_rng r = tz_rng_make(5, (uint64_t)torus);
        for (int i = 0; i < 300; i++) /* some beyond the domain, some twice */
            p[i] = i % 10 == 9
                       ? p[i - 1]
                       : (tz_vec3){tz_rng_range(&r, -5, 95), tz_rng_range(&r, -5, 45), 0};
        ok(ctx, tz_cells_fill(ctx, &c, &d, p, 300, 14));
        for (int i = 0; i < 300; i++) {
            const int32_t n = tz_cells_near(&c, p, p[i], 14, i, out, 20);
            int32_t within = 0;
            for (int k = 0; k < 300; k++) {
                const tz_vec3 v = tz_domain_vector(&d, p[i], p[k]);
                const double d2 = v.x * v.x + v.y * v.y;
                if (k == i || d2 > 14 * 14)
                    continue;
                within++;
                bool listed = false;
                for (int32_t m = 0; m < n; m++)
                    listed = listed || out[m].id == k;
                assert_true(listed || d2 >= (double)out[n - 1].dist2 * (1 - 1e-6));
            }
            assert_int_equal(n, within < 20 ? within : 20);
        }
        tz_cells_free(ctx, &c);
    }
    end_ctx(ctx);
}

/* ---- likeness -------------------------------------------------------------------- */

static float unlike(const tz_energy_exemplar *x, int32_t k, int32_t other)
{
    static tz_pairing w;
    tz_pairing_side wanted = {.n = 0};
    const tz_pairing_side *s = &x->side[k];
    for (int32_t j = 0; j < s->n; j++)
        if (tz_energy_within(x, k, j)) {
            wanted.x[wanted.n] = s->x[j], wanted.y[wanted.n] = s->y[j];
            wanted.a[wanted.n] = s->a[j], wanted.b[wanted.n] = s->b[j];
            wanted.l[wanted.n++] = s->l[j];
        }
    tz_pairing_sort(&wanted, NULL);
    w.attributes = x->attributes, w.limit = (float)(x->limit * x->limit), w.weight = NULL;
    return tz_pairing_best(&w, &wanted, &x->side[other], INFINITY);
}

/* The alike ones, found through descriptors, against all of the label. */
static void test_similar_are_alike(void **state)
{
    (void)state;
    static const pattern all[] = {PATTERN_JITTER, PATTERN_MIXED};
    const tz_domain d = {.size = {240, 240, 0}, .torus = false};
    for (int q = 0; q < 2; q++) {
        const tz_energy_params p = defaults();
        tz_ctx *ctx = new_ctx(2);
        tz_element_set from;
        tz_energy_exemplar x;
        double found = 0, best = 0, any = 0;
        ok(ctx, pattern_make(ctx, &from, all[q], d, 3));
        ok(ctx, tz_energy_exemplar_init(ctx, &x, &from, &p));
        for (int32_t k = 0; k < x.n; k += 7) {
            const int32_t *l = &x.label_first[x.label[k]];
            const int32_t *similar = &x.similar[k * x.coherent];
            float least = INFINITY, last = 0;
            double sum = 0;
            for (int32_t i = l[0]; i < l[1]; i++)
                if (x.by_label[i] != k) {
                    const float c = unlike(&x, k, x.by_label[i]);
                    least = fminf(least, c), sum += (double)c;
                }
            for (int32_t j = 0; j < x.coherent; j++) {
                assert_true(similar[j] >= 0 && similar[j] != k);
                assert_int_equal(x.label[similar[j]], x.label[k]);
                for (int32_t i = 0; i < j; i++)
                    assert_int_not_equal(similar[i], similar[j]);
                const float c = unlike(&x, k, similar[j]);
                assert_true(c >= last && c >= least * 0.9999f); /* nearest first */
                last = c;
            }
            found += (double)unlike(&x, k, similar[0]);
            best += (double)least, any += sum / (l[1] - l[0] - 1);
        }
        assert_true(found - best < 0.15 * (any - best));
        tz_energy_exemplar_deinit(&x);
        tz_element_set_deinit(&from);
        end_ctx(ctx);
    }
}

static void test_similar_at_any_threads(void **state)
{
    (void)state;
    static const int threads[] = {1, 2, 8};
    int32_t *first = NULL;
    for (int q = 0; q < 3; q++) {
        const tz_energy_params p = defaults();
        tz_ctx *ctx = new_ctx(threads[q]);
        tz_element_set from;
        tz_energy_exemplar x;
        ok(ctx, pattern_make(ctx, &from, PATTERN_MIXED,
                             (tz_domain){.size = {240, 240, 0}, .torus = true}, 3));
        ok(ctx, tz_energy_exemplar_init(ctx, &x, &from, &p));
        const size_t size = (size_t)x.n * (size_t)x.coherent * sizeof *first;
        if (!first)
            first = memcpy(malloc(size), x.similar, size);
        assert_memory_equal(first, x.similar, size);
        tz_energy_exemplar_deinit(&x);
        tz_element_set_deinit(&from);
        end_ctx(ctx);
    }
    free(first);
}

static void test_similar_without_memory(void **state)
{
    (void)state;
    const tz_energy_params p = defaults();
    tz_status s = TZ_NOMEM;
    for (int64_t n = 1; s != TZ_OK; n++) {
        const tz_ctx_options opt = {.threads = 1, .fail_alloc = n};
        tz_ctx *plain = new_ctx(1), *ctx;
        tz_element_set from;
        tz_energy_exemplar x;
        assert_true(n < 100);
        ok(plain, pattern_make(plain, &from, PATTERN_MIXED,
                               (tz_domain){.size = {90, 90, 0}, .torus = false}, 3));
        assert_int_equal(tz_ctx_new(&opt, &ctx), TZ_OK);
        s = tz_energy_exemplar_init(ctx, &x, &from, &p);
        assert_true(s == TZ_OK || s == TZ_NOMEM);
        tz_energy_exemplar_deinit(&x);
        assert_int_equal(tz_ctx_memory_used(ctx), 0);
        tz_ctx_free(ctx);
        tz_element_set_deinit(&from);
        end_ctx(plain);
    }
}

/* ---- assignment ------------------------------------------------------------------ */

typedef struct bench {
    tz_ctx *ctx;
    tz_element_set from, out;
    tz_energy_exemplar x;
    tz_energy_state t;
} bench;

static void begin(bench *b, pattern pattern, tz_domain domain)
{
    tz_energy_params p = defaults();
    double e;
    b->ctx = new_ctx(1);
    b->out = (tz_element_set){.domain = domain};
    ok(b->ctx, pattern_make(b->ctx, &b->from, pattern,
                            (tz_domain){.size = {80, 80, 0}, .torus = false}, 3));
    p.iterations = 0;
    ok(b->ctx, tz_energy_solve(b->ctx, &b->from, &p, &b->out, NULL, NULL));
    ok(b->ctx, tz_energy_exemplar_init(b->ctx, &b->x, &b->from, &p));
    ok(b->ctx, tz_energy_state_init(b->ctx, &b->t, &b->x, &b->out, &p));
    ok(b->ctx, tz_energy_search(&b->t, 0, &e));
}

static void end(bench *b)
{
    tz_energy_state_deinit(&b->t);
    tz_energy_exemplar_deinit(&b->x);
    tz_element_set_deinit(&b->from);
    tz_element_set_deinit(&b->out);
    end_ctx(b->ctx);
}

/* The same equations through CHOLMOD. */
static void test_fit_is_least_squares(void **state)
{
    (void)state;
    for (int torus = 0; torus < 2; torus++) {
        bench b;
        begin(&b, PATTERN_MIXED, (tz_domain){.size = {150, 130, 0}, .torus = torus == 1});
        const int32_t n = b.t.n;
        for (int32_t i = 0; i < b.out.element.n; i += 7)
            b.out.element.v[i].fixed = true;
        tz_vec2 *u = calloc((size_t)n, sizeof *u);
        double *x = calloc((size_t)n * 2, sizeof *x);
        tz_lsq *l;
        ok(b.ctx, tz_energy_fit(&b.t, 1e-20, u));
        ok(b.ctx, tz_lsq_new(b.ctx, n, 2, &l));
        for (int32_t o = 0; o < n; o++) {
            const double none[2] = {0, 0}, one = 1;
            const bool fixed = b.out.element.v[b.t.owner[o]].fixed;
            const tz_vec3 p = b.t.at[o];
            assert_true(torus || (p.x >= 0 && p.y >= 0 && p.x <= 150 && p.y <= 130));
            ok(b.ctx, tz_lsq_add(l, 1, &o, &one, none, sqrt(fixed ? 1e9 : 0.5)));
            for (int32_t j = 0; j < b.t.count[o]; j++) {
                const int32_t at = o * TZ_ENERGY_NEAR + j, index[2] = {b.t.near[at], o};
                const double c[2] = {1, -1};
                const double r[2] = {(double)b.t.pull[at].x, (double)b.t.pull[at].y};
                if (b.t.pair[at] >= 0)
                    ok(b.ctx, tz_lsq_add(l, 2, index, c, r, 1));
            }
        }
        ok(b.ctx, tz_lsq_solve(l, x));
        for (int32_t o = 0; o < n; o++) {
            assert_float_equal(x[o], u[o].x, 1e-5);
            assert_float_equal(x[n + o], u[o].y, 1e-5);
            if (b.out.element.v[b.t.owner[o]].fixed)
                assert_true(u[o].x == 0 && u[o].y == 0);
        }
        tz_lsq_free(l);
        free(u);
        free(x);
        end(&b);
    }
}

/* Eq. (4) after moving, the matching kept: pulls shrink by what the ends have moved. */
static void move_pulls(tz_energy_state *t, const tz_vec2 *u)
{
    for (int32_t o = 0; o < t->n; o++)
        for (int32_t j = 0; j < t->count[o]; j++) {
            const int32_t at = o * TZ_ENERGY_NEAR + j, to = t->near[at];
            t->pull[at].x -= (float)(u[to].x - u[o].x);
            t->pull[at].y -= (float)(u[to].y - u[o].y);
        }
}

static void test_assignment_lowers_energy(void **state)
{
    (void)state;
    static const pattern all[] = {PATTERN_SQUARE, PATTERN_HEX,    PATTERN_CHESS,
                                  PATTERN_JITTER, PATTERN_RANDOM, PATTERN_MIXED};
    for (size_t k = 0; k < sizeof all / sizeof all[0]; k++)
        for (int loose = 0; loose < 2; loose++) { /* however early the solver stops */
            bench b;
            begin(&b, all[k], (tz_domain){.size = {150, 130, 0}, .torus = true});
            tz_vec2 *u = calloc((size_t)b.t.n, sizeof *u);
            const double before = tz_energy_of_positions(&b.t);
            ok(b.ctx, tz_energy_fit(&b.t, loose ? 0.3 : 1e-12, u));
            move_pulls(&b.t, u);
            const double after = tz_energy_of_positions(&b.t);
            assert_true(after < before);
            ok(b.ctx, tz_energy_fit(&b.t, 1e-12, u));
            move_pulls(&b.t, u);
            assert_true(tz_energy_of_positions(&b.t) <= after * (1 + 1e-6));
            free(u);
            end(&b);
        }
}

/* ---- borders ---------------------------------------------------------------------- */

static double left_half(void *user, tz_vec3 at)
{
    (void)user;
    return at.x < 75;
}

/* How many neighbours the matches would put where nothing should be. */
static int32_t count_outside(const tz_energy_state *t)
{
    int32_t n = 0;
    for (int32_t o = 0; o < t->n; o++)
        for (int32_t j = 0; t->match[o] >= 0 && j < t->x->side[t->match[o]].n; j++) {
            const tz_pairing_side *s = &t->x->side[t->match[o]];
            if (!tz_energy_within(t->x, t->match[o], j))
                continue;
            const tz_vec3 p = {t->at[o].x + (double)s->x[j], t->at[o].y + (double)s->y[j],
                               0};
            n += t->hook ? !(p.x < 75) : !tz_domain_contains(&t->set->domain, p);
        }
    return n;
}

/* Eq. (6): the exemplar's border is favoured at the output's, and at that of a shape. */
static void test_border(void **state)
{
    (void)state;
    const tz_energy_hook hook = {.inside = left_half};
    for (int shape = 0; shape < 2; shape++) {
        bench b;
        double e[2];
        begin(&b, PATTERN_JITTER, (tz_domain){.size = {150, 130, 0}, .torus = false});
        b.t.hook = shape ? &hook : NULL;
        b.t.border = 0;
        ok(b.ctx, tz_energy_search(&b.t, 0, &e[0]));
        const int32_t before = count_outside(&b.t);
        b.t.border = 1;
        ok(b.ctx, tz_energy_search(&b.t, 0, &e[1]));
        assert_true(count_outside(&b.t) < 0.8 * before);
        assert_true(e[1] > e[0]); /* at the price of likeness */
        end(&b);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pairing_is_best),
        cmocka_unit_test(test_cells),
        cmocka_unit_test(test_similar_are_alike),
        cmocka_unit_test(test_similar_at_any_threads),
        cmocka_unit_test(test_similar_without_memory),
        cmocka_unit_test(test_fit_is_least_squares),
        cmocka_unit_test(test_assignment_lowers_energy),
        cmocka_unit_test(test_border),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
