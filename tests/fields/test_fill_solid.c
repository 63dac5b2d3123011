/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Element fields in space: sixty things of three balls in a box go through scale,
 * orientation, distribution and graph steps, with solid power cells. */
#include "tests/base/check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/rng.h"
#include "fields/fill_internal.h"
#include "tests/fields/filling.h"

enum { BODIES = 60, BALLS = 3, N = BODIES * BALLS, MOST = 96, ITERATIONS = 20 };
#define SIDE 10.0

typedef struct matrix {
    double v[3][3];
} matrix;

static const matrix plain = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

static matrix turn_about(int axis, double angle)
{
    matrix m = plain;
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    m.v[a][a] = m.v[b][b] = cos(angle);
    m.v[b][a] = sin(angle), m.v[a][b] = -sin(angle);
    return m;
}

static matrix product(const matrix *p, const matrix *q)
{
    matrix m = {{{0}}};
    for (int i = 0; i < 27; i++)
        m.v[i / 9][i / 3 % 3] += p->v[i / 9][i % 3] * q->v[i % 3][i / 3 % 3];
    return m;
}

static tz_vec3 apply(const matrix *m, tz_vec3 p)
{
    return (tz_vec3){m->v[0][0] * p.x + m->v[0][1] * p.y + m->v[0][2] * p.z,
                     m->v[1][0] * p.x + m->v[1][1] * p.y + m->v[1][2] * p.z,
                     m->v[2][0] * p.x + m->v[2][1] * p.y + m->v[2][2] * p.z};
}

/* About the middle of the box. */
static tz_vec3 turned(const matrix *m, tz_vec3 p)
{
    const double h = SIDE / 2;
    const tz_vec3 q = apply(m, (tz_vec3){p.x - h, p.y - h, p.z - h});
    return (tz_vec3){q.x + h, q.y + h, q.z + h};
}

/* Column by column, as samples keep it. */
static void put(double o[9], const matrix *m)
{
    for (int k = 0; k < 9; k++)
        o[k] = m->v[k % 3][k / 3];
}

typedef struct box {
    tz_ctx *ctx;
    tz_fill f;
    double area[N];
    tz_vec2 flat[N];
    tz_vec3 centre[N];
    int32_t start[N], count[N], near[N * MOST];
    tz_power_cells cells;
    double confident[N], said_c[N], said_rho[N];
} box;

static void cells_of(box *b)
{
    static int32_t near[N * MOST];
    double w[N];
    tz_fill *f = &b->f;
    int32_t n = 0;
    for (int i = 0; i < N; i++)
        w[i] = pow(tz_fill_radius(f, i), 2);
    ok(b->ctx, tz_power_solid(b->ctx, f->domain.size, N, f->at, w, b->area, b->centre,
                              near, MOST));
    for (int i = 0; i < N; i++) {
        b->start[i] = n;
        for (int k = 0; k < MOST && near[i * MOST + k] >= 0; k++)
            b->near[n++] = near[i * MOST + k];
        b->count[i] = n - b->start[i];
    }
    b->cells = (tz_power_cells){.n = N,
                                .area = b->area,
                                .centre = b->flat,
                                .start = b->start,
                                .neighbour = b->near,
                                .count = b->count};
}

/* A row of three balls, the middle one larger. */
static tz_fill_model row_of_balls(double rigidity)
{
    tz_fill_model m = {.n = BALLS, .rigidity = rigidity, .spread = {1, 0}};
    const double g = 2 * TZ_FILL_GRAPH,
                 a[3][3] = {{1 + g, -g, 0}, {-g, 1 + 2 * g, -g}, {0, -g, 1 + g}};
    const double det = a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) -
                       a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]);
    for (int k = 0; k < BALLS; k++) {
        m.rest[k] = (tz_vec3){0.9 * (k - 1), 0, 0};
        m.radius[k] = k == 1 ? 0.6 : 0.5;
        m.start[k + 1] = m.start[k] + (k == 1 ? 2 : 1);
    }
    m.near[0] = 1, m.near[1] = 0, m.near[2] = 2, m.near[3] = 1;
    for (int i = 0; i < 9; i++) {
        const int r = i / 3, c = i % 3, p = (c + 1) % 3, q = (c + 2) % 3;
        const int s = (r + 1) % 3, t = (r + 2) % 3;
        m.inverse[i] = (a[p][s] * a[q][t] - a[p][t] * a[q][s]) / det;
    }
    return m;
}

/* Body k of the box, all of it turned by `by` about its middle. Every fourth body is told
 * a direction, every sixth a size, every fifth a density. */
static void put_body(box *b, int k, double rigidity, const matrix *by)
{
    static const matrix *const none = &plain;
    tz_fill *f = &b->f;
    const tz_fill_model *m = &f->model.v[0];
    tz_rng g = tz_rng_make(9, (uint64_t)k);
    const tz_vec3 at = {SIDE * tz_rng_unit(&g), SIDE * tz_rng_unit(&g),
                        SIDE * tz_rng_unit(&g)};
    matrix o = *none, said = turn_about(2, 0.7);
    for (int a = 0; a < 3; a++) {
        const matrix t = turn_about(a, 0.5 * tz_rng_normal(&g));
        o = product(&t, &o);
    }
    o = product(by, &o), said = product(by, &said);
    for (int i = 0; i < BALLS; i++) {
        const int s = k * BALLS + i;
        const tz_vec3 centre = turned(by, at), arm = apply(&o, m->rest[i]);
        f->at[s] = (tz_vec3){centre.x + arm.x, centre.y + arm.y, centre.z + arm.z};
        f->radius[s] = m->radius[i];
        f->c[s] = 1;
        f->owner[s] = k;
        f->node[s] = rigidity >= TZ_FILL_RIGID ? k * BALLS : s;
        f->prior[s] = f->pressure[s] = 0;
        tz_fill_set_rho(f, s, 0);
        put(f->o + 9 * s, &o);
        put(f->target + 9 * s, &said);
        b->confident[s] = k % 4 == 0 && i == 1 ? 20 : 0;
        b->said_c[s] = k % 6 == 1 ? 10 : 0, f->target_c[s] = k % 12 == 1 ? 0.8 : 1.2;
        b->said_rho[s] = k % 5 == 2 ? 10 : 0, f->target_rho[s] = 0.3;
    }
}

static void make(box *b, double rigidity, const matrix *by)
{
    tz_fill *f = &b->f;
    memset(b, 0, sizeof *b);
    b->ctx = new_ctx(1);
    f->ctx = b->ctx;
    f->dim = 3, f->columns = 3, f->m = 9;
    f->domain.size = (tz_vec3){SIDE, SIDE, SIDE};
    f->par = filling_params(0);
    f->unit = 0.53;
    f->calm = 1;
    f->stale = true;
    f->any_size = f->any_density = f->any_direction = true;
    ok(b->ctx, tz_fill_reserve(f, N));
    ok(b->ctx, tz_array_push(b->ctx, &f->model, row_of_balls(rigidity)));
    for (int k = 0; k < BODIES; k++) {
        const tz_fill_body body = {.first = k * BALLS,
                                   .n = BALLS,
                                   .size = 1,
                                   .x = 1,
                                   .source = -1,
                                   .awake = true};
        ok(b->ctx, tz_array_push(b->ctx, &f->body, body));
        put_body(b, k, rigidity, by);
    }
    f->n = N;
    ok(b->ctx, tz_fill_lists(f));
}

static void clear(box *b)
{
    tz_fill *owned = NULL; /* tz_fill_end frees the struct as memory of the context */
    ok(b->ctx, tz_alloc(b->ctx, &owned, 1, sizeof *owned));
    *owned = b->f;
    tz_fill_end(owned);
    end_ctx(b->ctx);
}

typedef struct course {
    double before[4], after[4]; /* of scale, orientation, distribution, graph step */
} course;

static course iterate(box *b)
{
    tz_fill *f = &b->f;
    course c;
    double pair[2], terms[3], graph;
    cells_of(b);
    ok(b->ctx, tz_fill_neighbours(f, &b->cells));
    memcpy(f->confident, b->confident, sizeof b->confident); /* there are no strokes */
    memcpy(f->said_c, b->said_c, sizeof b->said_c);
    memcpy(f->said_rho, b->said_rho, sizeof b->said_rho);
    for (int k = 0; k < 4; k++) {
        ok(b->ctx, k == 0   ? tz_fill_scale_step(f, pair)
                   : k == 1 ? tz_fill_turn_step(f, pair)
                   : k == 2
                       ? tz_fill_distribution_step(f, &b->cells, b->centre, pair, terms)
                       : tz_fill_graph_step(f, pair, &graph));
        assert_true(isfinite(pair[0]) && isfinite(pair[1]));
        c.before[k] = pair[0], c.after[k] = pair[1];
    }
    return c;
}

/* How deep balls of different bodies lie in each other, and beyond the walls. */
static double overlap(const tz_fill *f)
{
    double sum = 0;
    for (int i = 0; i < N; i++) {
        const tz_vec3 p = f->at[i];
        const double x[3] = {p.x, p.y, p.z}, r = f->c[i] * f->radius[i];
        for (int a = 0; a < 3; a++)
            sum += fmax(0, r - x[a]) + fmax(0, x[a] + r - SIDE);
        for (int j = i + 1; j < N; j++) {
            const tz_vec3 q = f->at[j];
            const double d = sqrt((p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y) +
                                  (p.z - q.z) * (p.z - q.z));
            if (f->owner[i] != f->owner[j])
                sum += fmax(0, tz_fill_radius(f, i) + tz_fill_radius(f, j) - d);
        }
    }
    return sum;
}

static const double rigidities[] = {0, 1, 30, 100};

static void energies_fall_in_each_step(void **state)
{
    (void)state;
    static box b;
    for (size_t r = 0; r < sizeof rigidities / sizeof *rigidities; r++) {
        course first = {{0}, {0}}, last = first;
        make(&b, rigidities[r], &plain);
        const double before = overlap(&b.f);
        for (int t = 0; t < ITERATIONS; t++) {
            last = iterate(&b);
            for (int k = 0; k < 4; k++)
                assert_true(last.after[k] <= last.before[k] * (1 + 1e-9) + 1e-9);
            first = t == 0 ? last : first;
        }
        /* what is said is reached, and balls are apart */
        assert_true(last.after[0] < 0.5 * first.before[0]);
        assert_true(last.after[1] < 0.5 * first.before[1]);
        assert_true(last.after[2] < 0.3 * first.before[2]);
        assert_true(overlap(&b.f) < 0.15 * before);
        clear(&b);
    }
}

/* Things keep their shape, rigid ones all of it; matrices are rotations; sizes and
 * densities are as said where they are said. */
static void fields_are_followed(void **state)
{
    (void)state;
    static box b;
    for (int soft = 0; soft < 2; soft++) {
        make(&b, soft ? 1 : 100, &plain);
        tz_fill *f = &b.f;
        for (int t = 0; t < ITERATIONS; t++)
            iterate(&b);
        for (int s = 0; s < N; s++) {
            const double *o = f->o + 9 * s, *u = f->target + 9 * s;
            double far = 0;
            for (int p = 0; p < 3; p++)
                for (int q = p; q < 3; q++) {
                    const double *x = o + 3 * p, *y = o + 3 * q;
                    const double dot = x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
                    assert_true(fabs(dot - (p == q)) < 0.12);
                }
            for (int e = 0; e < 9; e++)
                far += (o[e] - u[e]) * (o[e] - u[e]);
            if (b.confident[s] > 0)
                assert_true(far < 0.15);
            if (b.said_c[s] > 0)
                assert_true(fabs(f->c[s] - f->target_c[s]) < 0.12);
            if (b.said_rho[s] > 0)
                assert_true(fabs(f->rho[s] - f->target_rho[s]) < 0.12);
            if (s % BALLS == 0)
                continue;
            const tz_vec3 p = f->at[s - 1], q = f->at[s];
            const double l = sqrt((p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y) +
                                  (p.z - q.z) * (p.z - q.z));
            assert_true(fabs(l / f->c[s] - 0.9) < (soft ? 0.12 : 0.05));
            for (int e = 0; e < 9 && !soft; e++)
                assert_true(o[e] == f->o[9 * (s - 1) + e]);
        }
        clear(&b);
    }
}

/* All of the box turned about its middle by a turn that maps it to itself: the same comes
 * out turned. Rounding grows with every iteration, as in any heap of things that push. */
static void turned_boxes_settle_alike(void **state)
{
    (void)state;
    static box a, b;
    const matrix quarter = turn_about(2, 2 * atan(1)), other = turn_about(0, 2 * atan(1));
    const matrix third = product(&quarter, &other); /* about a diagonal */
    const matrix *const turns[] = {&quarter, &other, &third};
    for (int k = 0; k < 6; k++) {
        const double rigidity = k < 3 ? 100 : 1;
        const matrix *by = turns[k % 3];
        make(&a, rigidity, &plain);
        make(&b, rigidity, by);
        for (int t = 0; t < 5; t++) {
            const course p = iterate(&a), q = iterate(&b);
            for (int e = 0; e < 4; e++)
                assert_true(fabs(p.after[e] - q.after[e]) <= 1e-6 * (1 + p.after[e]));
        }
        for (int s = 0; s < N; s++) {
            const tz_vec3 p = turned(by, a.f.at[s]), q = b.f.at[s];
            assert_true(fabs(p.x - q.x) + fabs(p.y - q.y) + fabs(p.z - q.z) < 1e-5);
            assert_true(fabs(a.f.c[s] - b.f.c[s]) < 1e-6);
            assert_true(fabs(a.f.rho[s] - b.f.rho[s]) < 1e-6);
            for (int c = 0; c < 3; c++) {
                const double *o = a.f.o + 9 * s + 3 * c, *u = b.f.o + 9 * s + 3 * c;
                const tz_vec3 v = apply(by, (tz_vec3){o[0], o[1], o[2]});
                assert_true(fabs(v.x - u[0]) + fabs(v.y - u[1]) + fabs(v.z - u[2]) <
                            1e-5);
            }
        }
        clear(&a), clear(&b);
    }
}

/* Volumes of cells fill the box, and each body's steps leave it inside. */
static void cells_fill_the_box(void **state)
{
    (void)state;
    static box b;
    make(&b, 100, &plain);
    for (int t = 0; t < ITERATIONS; t++) {
        double sum = 0;
        iterate(&b);
        for (int i = 0; i < N; i++)
            sum += b.area[i];
        assert_true(fabs(sum - SIDE * SIDE * SIDE) < 1e-6 * sum);
    }
    for (int i = 0; i < N; i++) {
        const tz_vec3 p = b.f.at[i];
        assert_true(fmin(fmin(p.x, p.y), p.z) > 0 && fmax(fmax(p.x, p.y), p.z) < SIDE);
    }
    clear(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(energies_fall_in_each_step),
        cmocka_unit_test(fields_are_followed),
        cmocka_unit_test(turned_boxes_settle_alike),
        cmocka_unit_test(cells_fill_the_box),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
