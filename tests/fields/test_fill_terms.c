/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The terms of element fields: derivatives against differences, in the plane and in space;
 * their minima; and a box of bodies whose energies fall. */
#include "tests/base/check.h"

#include "base/rng.h"
#include "fields/fill_internal.h"
#include "tests/fields/filling.h"

enum { BODIES = 24, DISCS = 3, N = BODIES * DISCS, MOST = 64 };

/* A fill made by hand, of chains of three discs, in the plane or in space. */
typedef struct chains {
    tz_ctx *ctx;
    tz_fill f;
    double area[N];
    tz_vec2 flat[N];
    tz_vec3 centre[N];
    int32_t start[N], count[N], near[N * MOST];
    tz_power_cells cells;
} chains;

static void cells_of(chains *c)
{
    tz_fill *f = &c->f;
    static int32_t near[N * MOST];
    double w[N];
    for (int i = 0; i < N; i++)
        w[i] = pow(tz_fill_radius(f, i), 2);
    tz_vec3 size = f->domain.size;
    if (f->dim == 2) {
        size.z = 1;
        for (int i = 0; i < N; i++)
            f->at[i].z = 0.5;
    }
    ok(c->ctx, tz_power_solid(c->ctx, size, N, f->at, w, c->area, c->centre, near, MOST));
    int32_t n = 0;
    for (int i = 0; i < N; i++) {
        c->start[i] = n;
        for (int k = 0; k < MOST && near[i * MOST + k] >= 0; k++)
            c->near[n++] = near[i * MOST + k];
        c->count[i] = n - c->start[i];
        c->centre[i].z *= f->dim == 3;
        f->at[i].z *= f->dim == 3;
    }
    c->cells = (tz_power_cells){.n = N,
                                .area = c->area,
                                .centre = c->flat,
                                .start = c->start,
                                .neighbour = c->near,
                                .count = c->count};
}

static void make(chains *c, int dim, double rigidity)
{
    static tz_fill_model model;
    tz_fill *f = &c->f;
    memset(c, 0, sizeof *c);
    c->ctx = new_ctx(1);
    memset(&model, 0, sizeof model);
    model.n = DISCS, model.rigidity = rigidity;
    for (int k = 0; k < DISCS; k++) {
        model.rest[k] = (tz_vec3){k - 1, 0, 0}, model.radius[k] = 0.6;
        model.start[k + 1] = model.start[k] + (k == 1 ? 2 : 1);
    }
    model.near[0] = 1, model.near[1] = 0, model.near[2] = 2, model.near[3] = 1;
    const double g = 2 * TZ_FILL_GRAPH,
                 a[3][3] = {{1 + g, -g, 0}, {-g, 1 + 2 * g, -g}, {0, -g, 1 + g}};
    const double det = a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) -
                       a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const int p = (j + 1) % 3, q = (j + 2) % 3, r = (i + 1) % 3, s = (i + 2) % 3;
            model.inverse[3 * i + j] = (a[p][r] * a[q][s] - a[p][s] * a[q][r]) / det;
        }
    f->ctx = c->ctx;
    f->dim = dim, f->columns = dim == 3 ? 3 : 1, f->m = dim == 3 ? 9 : 2;
    f->domain.size = dim == 3 ? (tz_vec3){7, 7, 7} : (tz_vec3){16, 16, 0};
    f->par = filling_params(0);
    f->unit = 0.6;
    f->stale = true;
    f->any_pointed = true, f->any_soft = rigidity < TZ_FILL_RIGID;
    ok(c->ctx, tz_fill_reserve(f, N));
    ok(c->ctx, tz_array_push(c->ctx, &f->model, model));
    for (int b = 0; b < BODIES; b++) {
        tz_rng r = tz_rng_make(4, (uint64_t)b);
        tz_fill_body body = {.first = b * DISCS,
                             .n = DISCS,
                             .size = 1,
                             .x = 1,
                             .source = -1,
                             .awake = true};
        ok(c->ctx, tz_array_push(c->ctx, &f->body, body));
        const tz_vec3 s = f->domain.size;
        const tz_vec3 at = {tz_rng_unit(&r) * s.x, tz_rng_unit(&r) * s.y,
                            tz_rng_unit(&r) * s.z};
        const double turn = 0.6 * tz_rng_normal(&r);
        for (int k = 0; k < DISCS; k++) {
            const int i = b * DISCS + k;
            f->at[i] =
                (tz_vec3){at.x + (k - 1) * cos(turn), at.y + (k - 1) * sin(turn), at.z};
            f->radius[i] = 0.6, f->c[i] = f->wide[i] = 1, f->rho[i] = 0;
            f->owner[i] = b;
            f->node[i] = rigidity >= TZ_FILL_RIGID ? b * DISCS : i;
            double *o = f->o + (ptrdiff_t)i * f->m;
            memset(o, 0, (size_t)f->m * sizeof *o);
            const double t = turn + 0.2 * tz_rng_normal(&r);
            o[0] = cos(t), o[1] = sin(t);
            if (dim == 3)
                o[3] = -sin(t), o[4] = cos(t), o[8] = 1;
            for (int e = 0; e < f->m; e++) /* not quite rotations */
                o[e] += 0.05 * tz_rng_normal(&r);
            f->confident[i] = k == 0 && b % 4 == 0 ? 20 : 0;
            f->said_c[i] = f->said_rho[i] = 0;
            double *u = f->target + (ptrdiff_t)i * f->m;
            memset(u, 0, (size_t)f->m * sizeof *u);
            u[0] = 1;
            if (dim == 3)
                u[4] = u[8] = 1;
        }
    }
    f->n = N;
    ok(c->ctx, tz_fill_lists(f));
    cells_of(c);
    double *confident = malloc(N * sizeof *confident);
    assert_non_null(confident);
    memcpy(confident, f->confident, N * sizeof *confident);
    ok(c->ctx, tz_fill_neighbours(f, &c->cells)); /* forgets what is said: no field */
    memcpy(f->confident, confident, N * sizeof *confident);
    free(confident);
}

static void clear(chains *c)
{
    /* tz_fill_end frees the struct itself as memory of the context */
    tz_fill *owned = NULL;
    ok(c->ctx, tz_alloc(c->ctx, &owned, 1, sizeof *owned));
    *owned = c->f;
    tz_fill_end(owned);
    end_ctx(c->ctx);
}

static double turn_energy(tz_fill *f)
{
    double sums[4];
    ok(f->ctx, tz_fill_turn_energy(f, sums, false));
    return sums[0] + sums[1] + sums[2] + sums[3];
}

/* Continuity weighs by directions at the beginning of a step, so the whole energy is no
 * test of its gradient: align, rigidity and rotation are (alpha = 0); continuity is
 * checked where all weights w_o are alike, at equal directions, by its vanishing. */
static void gradients_are_those_of_energies(void **state)
{
    (void)state;
    for (int k = 0; k < 4; k++) {
        chains c;
        make(&c, k < 2 ? 2 : 3, k % 2 ? 100 : 30);
        tz_fill *f = &c.f;
        f->par.alpha = 0;
        double sums[4];
        ok(c.ctx, tz_fill_turn_energy(f, sums, true));
        double *g = malloc((size_t)(N * f->m) * sizeof *g);
        assert_non_null(g);
        memcpy(g, f->gradient, (size_t)(N * f->m) * sizeof *g);
        for (int i = 0; i < N; i += 5) {
            if (f->node[i] != i)
                continue;
            for (int e = 0; e < f->m; e++) {
                double *v = &f->o[(ptrdiff_t)i * f->m + e];
                const double h = 1e-5, old = *v;
                *v = old + h;
                const double up = turn_energy(f);
                *v = old - h;
                const double down = turn_energy(f);
                *v = old;
                /* gradient holds minus half of the slope */
                assert_true(fabs((up - down) / (4 * h) + g[i * f->m + e]) <
                            1e-5 * (1 + fabs(g[i * f->m + e])));
            }
        }
        free(g);
        clear(&c);
    }
}

static void turns_settle_to_rotations(void **state)
{
    (void)state;
    for (int k = 0; k < 4; k++) {
        chains c;
        double pair[2] = {0, 0}, first = 0;
        make(&c, k < 2 ? 2 : 3, k % 2 ? 100 : 1);
        tz_fill *f = &c.f;
        for (int t = 0; t < 40; t++) {
            ok(c.ctx, tz_fill_turn_step(f, pair));
            assert_true(pair[1] <= pair[0] * (1 + 1e-12));
            first = t == 0 ? pair[0] : first;
        }
        assert_true(pair[1] < 0.1 * first);
        for (int i = 0; i < N; i++) { /* all is said to point along x */
            const double *o = f->o + (ptrdiff_t)i * f->m;
            assert_true(fabs(hypot(o[0], o[1]) - 1) < 0.05);
            assert_true(o[0] > 0.95);
            if (f->dim == 3)
                assert_true(fabs(o[8] - 1) < 0.05 && fabs(o[3]) < 0.2);
        }
        clear(&c);
    }
}

/* Whole iterations in a box: energies fall in each step, bodies come apart. */
static void boxes_fill(void **state)
{
    (void)state;
    for (int dim = 2; dim <= 3; dim++) {
        chains c;
        make(&c, dim, 100);
        tz_fill *f = &c.f;
        double first = 0, conflict = 0;
        for (int t = 0; t < 25; t++) {
            double pair[2], terms[3], graph;
            cells_of(&c);
            ok(c.ctx, tz_fill_neighbours(f, &c.cells));
            ok(c.ctx, tz_fill_scale_step(f, pair));
            ok(c.ctx, tz_fill_turn_step(f, pair));
            assert_true(pair[1] <= pair[0] * (1 + 1e-12));
            ok(c.ctx, tz_fill_distribution_step(f, &c.cells, c.centre, pair, terms));
            assert_true(pair[1] <= pair[0] * (1 + 1e-9));
            first = t == 0 ? pair[0] : first;
            conflict = pair[0];
            ok(c.ctx, tz_fill_graph_step(f, pair, &graph));
            assert_true(pair[1] <= pair[0] * (1 + 1e-9) + 1e-9);
        }
        assert_true(conflict < 0.35 * first);
        for (int b = 0; b < BODIES; b++)
            for (int k = 1; k < DISCS; k++) {
                const tz_vec3 p = f->at[b * DISCS + k - 1], q = f->at[b * DISCS + k];
                const double l =
                    sqrt((q.x - p.x) * (q.x - p.x) + (q.y - p.y) * (q.y - p.y) +
                         (q.z - p.z) * (q.z - p.z));
                assert_true(fabs(l - 1) < 0.1);
            }
        clear(&c);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gradients_are_those_of_energies),
        cmocka_unit_test(turns_settle_to_rotations),
        cmocka_unit_test(boxes_fill),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
