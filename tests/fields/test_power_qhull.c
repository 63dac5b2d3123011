/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Power diagrams against Qhull: the lower hull of sites lifted to x^2 + y^2 - w is the
 * weighted triangulation, its facets' slopes are the corners of cells. On a torus sites
 * stand with their eight copies, in a rectangle with their eight mirror images, which keep
 * cells inside. Skipped where Qhull is not installed (libqhull-dev). */
#include "tests/base/check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/rng.h"
#include "fields/power.h"

#ifdef TZ_QHULL
#include <libqhull_r/qhull_ra.h>

enum { MOST = 900, COPIES = 9, EDGES = 64 };

/* A reference cell: corners from the middle of the domain, neighbours with lengths. */
typedef struct cell {
    tz_vec2 corner[EDGES];
    int32_t near[EDGES];
    double length[EDGES];
    int32_t corners, edges;
    double area;
    tz_vec2 centre; /* in the world */
} cell;

static tz_vec2 copy_of(const tz_domain *d, tz_vec3 p, int k)
{
    const int i = k % 3 - 1, j = k / 3 - 1;
    if (d->torus)
        return (tz_vec2){p.x + i * d->size.x, p.y + j * d->size.y};
    return (tz_vec2){i == 0  ? p.x
                     : i < 0 ? -p.x
                             : 2 * d->size.x - p.x,
                     j == 0  ? p.y
                     : j < 0 ? -p.y
                             : 2 * d->size.y - p.y};
}

static int by_angle(const void *a, const void *b)
{
    const tz_vec2 *p = a, *q = b;
    const double u = atan2(p->y, p->x), v = atan2(q->y, q->x);
    return (u > v) - (u < v);
}

/* Area and centre of corners that lie about their mean. */
static void close_cell(cell *c)
{
    tz_vec2 m = {0, 0};
    for (int32_t k = 0; k < c->corners; k++)
        m.x += c->corner[k].x / c->corners, m.y += c->corner[k].y / c->corners;
    for (int32_t k = 0; k < c->corners; k++)
        c->corner[k].x -= m.x, c->corner[k].y -= m.y;
    qsort(c->corner, (size_t)c->corners, sizeof *c->corner, by_angle);
    for (int32_t k = 0; k < c->corners; k++) {
        const tz_vec2 a = c->corner[k], b = c->corner[(k + 1) % c->corners];
        const double t = 0.5 * (a.x * b.y - a.y * b.x);
        c->area += t;
        c->centre.x += t * (a.x + b.x) / 3, c->centre.y += t * (a.y + b.y) / 3;
    }
    if (c->area > 0)
        c->centre = (tz_vec2){m.x + c->centre.x / c->area, m.y + c->centre.y / c->area};
}

static bool is_lower(const facetT *f) { return f->normal[2] < -1e-12; }

static tz_vec2 corner_of(const facetT *f)
{
    return (tz_vec2){-f->normal[0] / (2 * f->normal[2]),
                     -f->normal[1] / (2 * f->normal[2])};
}

/* An edge between two facets belongs to the two sites that both have. */
static void add_edge(qhT *qh, const facetT *f, const facetT *g, int32_t n, cell *c)
{
    vertexT *vertex, **vertexp;
    int32_t both[3], k = 0;
    FOREACHvertex_(f->vertices) if (qh_setin(g->vertices, vertex) && k < 3) both[k++] =
        qh_pointid(qh, vertex->point);
    assert_int_equal(k, 2);
    const tz_vec2 a = corner_of(f), b = corner_of(g);
    for (int e = 0; e < 2; e++) {
        if (both[e] / n != COPIES / 2)
            continue;
        cell *of = &c[both[e] % n];
        int32_t i = 0;
        while (i < of->edges && of->near[i] != both[!e] % n)
            i++;
        assert_true(i < EDGES);
        if (i == of->edges)
            of->near[of->edges++] = both[!e] % n;
        of->length[i] += 0.5 * hypot(a.x - b.x, a.y - b.y); /* each is met twice */
    }
}

static void by_qhull(const tz_domain *d, int32_t n, const tz_vec3 *at, const double *w,
                     cell *c)
{
    static coordT point[3 * COPIES * MOST];
    qhT hull, *qh = &hull;
    facetT *facet, *neighbor, **neighborp;
    vertexT *vertex, **vertexp;
    int left, total;
    char options[] = "qhull Qt Pp";
    const tz_vec2 m = {d->size.x / 2, d->size.y / 2};
    for (int k = 0; k < COPIES; k++)
        for (int32_t i = 0; i < n; i++) {
            const tz_vec2 p = copy_of(d, at[i], k);
            coordT *q = &point[3 * (k * n + i)];
            q[0] = p.x - m.x, q[1] = p.y - m.y;
            q[2] = q[0] * q[0] + q[1] * q[1] - w[i];
        }
    memset(c, 0, (size_t)n * sizeof *c);
    qh_zero(qh, stderr);
    assert_int_equal(qh_new_qhull(qh, 3, COPIES * n, point, False, options, NULL, stderr),
                     0);
    FORALLfacets
    {
        if (!is_lower(facet))
            continue;
        const tz_vec2 v = corner_of(facet);
        FOREACHvertex_(facet->vertices)
        {
            const int32_t i = qh_pointid(qh, vertex->point);
            if (i / n != COPIES / 2)
                continue;
            cell *to = &c[i % n];
            assert_true(to->corners < EDGES);
            to->corner[to->corners++] = (tz_vec2){v.x + m.x, v.y + m.y};
        }
        FOREACHneighbor_(facet) if (is_lower(neighbor))
            add_edge(qh, facet, neighbor, n, c);
    }
    qh_freeqhull(qh, True);
    qh_memfreeshort(qh, &left, &total);
    for (int32_t i = 0; i < n; i++)
        close_cell(&c[i]);
}

/* Of sites at one place and of one weight the first has it all; Qhull may choose. */
static int32_t first_of(int32_t i, const tz_vec3 *at, const double *w)
{
    for (int32_t k = 0; k < i; k++)
        if (at[k].x == at[i].x && at[k].y == at[i].y && w[k] == w[i])
            return k;
    return i;
}

/* Areas, centres and neighbours are those of the reference. */
static void compare(const tz_domain *d, tz_power *p, int32_t n, const tz_vec3 *at,
                    const double *w)
{
    static cell ref[MOST];
    const tz_power_cells c = tz_power_get(p);
    const double side = sqrt(d->size.x * d->size.y / n), most = 1e-6 * side;
    by_qhull(d, n, at, w, ref);
    for (int32_t i = 0; i < n; i++) { /* Qhull's choice is the first's */
        const int32_t k = first_of(i, at, w);
        if (k < i && ref[i].area > 0)
            ref[k] = ref[i], memset(&ref[i], 0, sizeof ref[i]);
    }
    for (int32_t i = 0; i < n; i++) {
        cell *r = &ref[i];
        for (int32_t e = 0; e < r->edges; e++)
            r->near[e] = first_of(r->near[e], at, w);
        assert_true(fabs(c.area[i] - r->area) < most * side);
        if (r->area > 1e-3 * side * side) {
            const tz_vec3 o = tz_domain_wrap(d, at[i]);
            assert_true(fabs(o.x + c.centre[i].x - r->centre.x) < most);
            assert_true(fabs(o.y + c.centre[i].y - r->centre.y) < most);
        }
        for (int32_t e = 0; e < r->edges; e++) {
            bool ours = r->near[e] == i; /* its own image */
            for (int32_t k = 0; k < c.count[i] && !ours; k++)
                ours = c.neighbour[c.start[i] + k] == r->near[e];
            assert_true(ours || r->length[e] < most);
        }
        tz_power_corner v[EDGES];
        const int32_t corners = tz_power_cell(p, i, v, EDGES);
        assert_true(corners <= EDGES);
        for (int32_t k = 0; k < corners; k++) {
            const tz_power_corner *b = &v[(k + 1) % corners];
            bool theirs = v[k].site < 0 || v[k].site == i;
            for (int32_t e = 0; e < r->edges && !theirs; e++)
                theirs = r->near[e] == v[k].site;
            assert_true(theirs || hypot(b->x - v[k].x, b->y - v[k].y) < most);
        }
    }
}

typedef enum layout { RANDOM, GRID, HEXAGONS, CLUSTERS, COINCIDENT, LAYOUTS } layout;

static double random_weight(tz_rng *g, double side, double spread)
{
    const double r = spread * side * tz_rng_unit(g);
    return r * r;
}

static void lay(layout what, const tz_domain *d, int32_t n, double spread, tz_vec3 *at,
                double *w)
{
    const int32_t row = (int32_t)sqrt(n);
    const double side = sqrt(d->size.x * d->size.y / n);
    for (int32_t i = 0; i < n; i++) {
        tz_rng g = tz_rng_make(21, (uint64_t)i);
        const double x = tz_rng_unit(&g), y = tz_rng_unit(&g), r = tz_rng_unit(&g);
        double u = x, v = y;
        w[i] = random_weight(&g, side, spread);
        if (what == GRID || what == HEXAGONS) {
            const int32_t j = i / row % row;
            u = (i % row + 0.25 + (what == HEXAGONS) * 0.5 * (j % 2)) / row;
            v = (j + 0.5) / row;
            w[i] = what == GRID && i % 3 == 0 ? 0 : 0.04 * side * side;
        } else if (what == CLUSTERS) { /* five, each 1/50 of the domain wide */
            u = 0.1 + 0.2 * (i % 5) + 0.02 * r * cos(6.28 * y);
            v = 0.3 + 0.1 * (i % 5) + 0.02 * r * sin(6.28 * y);
            w[i] *= 0.01;
        } else if (what == COINCIDENT && i % 4 == 3) {
            at[i] = at[i - 1], w[i] = w[i - 1];
            continue;
        }
        at[i] = (tz_vec3){u * d->size.x, v * d->size.y, 0};
    }
}

static int32_t count_of(layout what)
{
    return what == GRID || what == HEXAGONS ? 784 : 800;
}

static void cells_are_qhulls(void **state)
{
    static tz_vec3 at[MOST];
    static double w[MOST];
    (void)state;
    for (int torus = 0; torus < 2; torus++)
        for (layout what = 0; what < LAYOUTS; what++)
            for (int wide = 0; wide < 2; wide++) {
                tz_ctx *ctx = new_ctx(2);
                tz_power *p;
                const tz_domain d = {.size = {120, 90, 0}, .torus = torus == 1};
                const int32_t n = count_of(what);
                lay(what, &d, n, wide ? 1.5 : 0.5, at, w);
                ok(ctx, tz_power_new(ctx, &d, &p));
                ok(ctx, tz_power_update(p, n, at, w));
                compare(&d, p, n, at, w);
                ok(ctx, tz_power_update(p, n, at, w)); /* from rings */
                compare(&d, p, n, at, w);
                tz_power_free(p);
                end_ctx(ctx);
            }
}

/* Sites that drift, then some that jump, as in an optimisation. */
static void moving_cells_are_qhulls(void **state)
{
    static tz_vec3 at[MOST];
    static double w[MOST];
    (void)state;
    for (int k = 0; k < 2 * LAYOUTS; k++) {
        tz_ctx *ctx = new_ctx(2);
        tz_power *p;
        const tz_domain d = {.size = {120, 90, 0}, .torus = k % 2 == 1};
        const layout what = (layout)(k / 2);
        const int32_t n = count_of(what);
        const double side = sqrt(d.size.x * d.size.y / n);
        int32_t which[MOST];
        lay(what, &d, n, 0.7, at, w);
        ok(ctx, tz_power_new(ctx, &d, &p));
        ok(ctx, tz_power_update(p, n, at, w));
        for (int round = 1; round <= 24; round++) {
            const bool local = round % 4 == 0;
            int32_t changed = 0;
            for (int32_t i = 0; i < n; i += local ? 17 : 1) {
                tz_rng g = tz_rng_make((uint64_t)round, (uint64_t)i);
                const double step = local ? 8 * side : 0.15 * side;
                double *x = &at[i].x, *y = &at[i].y;
                *x += step * (2 * tz_rng_unit(&g) - 1);
                *y += step * (2 * tz_rng_unit(&g) - 1);
                *x = d.torus ? *x : fmin(fmax(*x, 0.01), d.size.x - 0.01);
                *y = d.torus ? *y : fmin(fmax(*y, 0.01), d.size.y - 0.01);
                w[i] *= 0.9 + 0.2 * tz_rng_unit(&g);
                which[changed++] = i;
            }
            ok(ctx, local ? tz_power_change(p, n, at, w, changed, which)
                          : tz_power_update(p, n, at, w));
            if (round % 3 != 0 && round % 4 != 0)
                continue;
            for (int32_t i = 0; i < n; i++) /* Qhull's copies are of wrapped sites */
                at[i] = tz_domain_wrap(&d, at[i]);
            compare(&d, p, n, at, w);
        }
        tz_power_free(p);
        end_ctx(ctx);
    }
}
#else
static void cells_are_qhulls(void **state)
{
    (void)state;
    skip();
}
static void moving_cells_are_qhulls(void **state)
{
    (void)state;
    skip();
}
#endif

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cells_are_qhulls),
        cmocka_unit_test(moving_cells_are_qhulls),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
