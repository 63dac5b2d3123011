/* SPDX-License-Identifier: Apache-2.0 */
/* Ridges, thinning, chains and their features on shapes whose features are known. */
#include "tests/analysis/draw.h"

#include "analysis/edges.h"
#include "analysis/tensor.h"

static void set_map(tz_edge_map *m, const char *const *rows)
{
    for (int32_t y = 0; y < m->height; y++)
        for (int32_t x = 0; x < m->width; x++) {
            const int64_t p = (int64_t)y * m->width + x;
            m->on[p] = rows[y][x] == '#';
            m->response[p] = m->on[p] ? 1 : 0;
            m->normal[p] = 1;
            m->normal[p + (int64_t)m->width * m->height] = 0;
        }
}

static void link_map(tz_ctx *ctx, const char *const *rows, int32_t w, int32_t h,
                     double min_length, tz_ebpt *e, tz_edge_map *m)
{
    *e = (tz_ebpt){.width = w, .height = h, .ctx = ctx};
    ok(ctx, tz_edge_map_init(ctx, m, w, h));
    set_map(m, rows);
    ok(ctx, tz_chain_link(m, min_length, e));
}

/* Pixels of all chains. */
static void paint(const tz_ebpt *e, uint8_t *on)
{
    memset(on, 0, (size_t)e->width * e->height);
    for (int32_t i = 0; i < e->edge.n; i++) {
        const tz_edge *d = &e->edge.v[i];
        int32_t x = d->x, y = d->y;
        for (int32_t k = 0;; k++) {
            on[y * e->width + x] = 1;
            if (k == d->length)
                break;
            x += tz_chain_dx[e->code.v[d->code + k]];
            y += tz_chain_dy[e->code.v[d->code + k]];
        }
    }
}

static void branchings_split(void **state)
{
    (void)state;
    static const char *const rows[9] = {"...........", "....#......", "....#......",
                                        "....#......", ".#########.", ".......#...",
                                        "........#..", ".........#.", "..........."};
    tz_ctx *ctx = new_ctx(1);
    tz_edge_map m;
    tz_ebpt e;
    uint8_t on[99];
    link_map(ctx, rows, 11, 9, 1, &e, &m);
    /* left, up, between the two branchings, right, down right */
    assert_int_equal(e.edge.n, 5);
    paint(&e, on);
    assert_memory_equal(on, m.on, sizeof on);
    tz_ebpt_deinit(&e);
    tz_edge_map_deinit(&m);
    /* twigs of up to 3 px go, and the line is one chain again */
    link_map(ctx, rows, 11, 9, 4.5, &e, &m);
    assert_int_equal(e.edge.n, 1);
    assert_true(e.edge.v[0].length >= 5);
    tz_ebpt_deinit(&e);
    tz_edge_map_deinit(&m);
    end_ctx(ctx);
}

static void loops_close(void **state)
{
    (void)state;
    static const char *const rows[7] = {".......", "..###..", ".#...#.", ".#...#.",
                                        ".#...#.", "..###..", "......."};
    tz_ctx *ctx = new_ctx(1);
    tz_edge_map m;
    tz_ebpt e;
    link_map(ctx, rows, 7, 7, 1, &e, &m);
    assert_int_equal(e.edge.n, 1);
    tz_chain_measure(&m, 1, &e, 0);
    const tz_edge *d = &e.edge.v[0];
    assert_int_equal(d->length, 12);
    assert_true(d->end[0].x == d->end[1].x && d->end[0].y == d->end[1].y);
    assert_float_equal(d->extent, 8 + 4 * sqrt(2), 1e-9);
    assert_float_equal(d->centre.x, 3.5, 1e-9);
    assert_float_equal(d->centre.y, 3.5, 1e-9);
    tz_ebpt_deinit(&e);
    tz_edge_map_deinit(&m);
    end_ctx(ctx);
}

static void straight_chains(void **state)
{
    (void)state;
    static const char *const rows[6] = {"........", ".#......", "..#.....",
                                        "...#....", "....#...", "........"};
    tz_ctx *ctx = new_ctx(1);
    tz_edge_map m;
    tz_ebpt e;
    link_map(ctx, rows, 8, 6, 1, &e, &m);
    assert_int_equal(e.edge.n, 1);
    tz_chain_measure(&m, 1, &e, 0);
    const tz_edge *d = &e.edge.v[0];
    assert_float_equal(d->extent, 3 * sqrt(2), 1e-9);
    assert_float_equal(d->angle, TZ_PI / 4, 1e-9); /* down to the right, y down */
    assert_float_equal(d->centre.x, 3, 1e-9);
    assert_float_equal(d->centre.y, 3, 1e-9);
    assert_float_equal(d->end_angle[0], -0.75 * TZ_PI, 1e-9);
    assert_float_equal(d->end_angle[1], 0.25 * TZ_PI, 1e-9);
    assert_float_equal(d->strength, 1, 1e-9);
    tz_ebpt_deinit(&e);
    tz_edge_map_deinit(&m);
    end_ctx(ctx);
}

/* Thinning keeps the number of 8-connected pieces and holes, and leaves curves: with
 * mixed adjacency no pixel can go any more. */
static int32_t euler(const uint8_t *on, int32_t w, int32_t h)
{
    /* pieces (8) minus holes (4) by quads: (Q1 - Q3 - 2 QD) / 4 */
    int32_t q1 = 0, q3 = 0, qd = 0;
    for (int32_t y = -1; y < h; y++) {
        for (int32_t x = -1; x < w; x++) {
            int32_t b[4];
            for (int32_t k = 0; k < 4; k++) {
                const int32_t u = x + (k & 1), v = y + (k >> 1);
                b[k] = u >= 0 && v >= 0 && u < w && v < h && on[v * w + u];
            }
            const int32_t n = b[0] + b[1] + b[2] + b[3];
            q1 += n == 1, q3 += n == 3;
            qd += n == 2 && b[0] == b[3];
        }
    }
    return (q1 - q3 - 2 * qd) / 4;
}

static void thinning_keeps_topology(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    for (uint64_t seed = 0; seed < 40; seed++) {
        tz_edge_map m;
        ok(ctx, tz_edge_map_init(ctx, &m, 61, 47));
        tz_rng r = tz_rng_make(seed, 3);
        const double share = 0.2 + 0.015 * (double)seed;
        for (int32_t i = 0; i < 61 * 47; i++) {
            m.on[i] = tz_rng_unit(&r) < share;
            m.response[i] = (float)tz_rng_unit(&r);
        }
        const int32_t before = euler(m.on, 61, 47);
        ok(ctx, tz_edge_map_thin(&m));
        assert_int_equal(euler(m.on, 61, 47), before);
        uint8_t once[61 * 47];
        memcpy(once, m.on, sizeof once);
        ok(ctx, tz_edge_map_thin(&m));
        assert_memory_equal(once, m.on, sizeof once);
        tz_edge_map_deinit(&m);
    }
    end_ctx(ctx);
}

/* Chains of random maps cover every linked pixel. */
static void chains_cover_the_map(void **state)
{
    (void)state;
    enum { W = 53, H = 41 };
    tz_ctx *ctx = new_ctx(1);
    for (uint64_t seed = 0; seed < 40; seed++) {
        tz_edge_map m;
        tz_ebpt e = {.width = W, .height = H, .ctx = ctx};
        uint8_t on[W * H];
        ok(ctx, tz_edge_map_init(ctx, &m, W, H));
        tz_rng r = tz_rng_make(seed, 5);
        for (int32_t i = 0; i < W * H; i++)
            m.on[i] = tz_rng_unit(&r) < 0.3;
        ok(ctx, tz_edge_map_thin(&m));
        ok(ctx, tz_chain_link(&m, 0.5, &e)); /* no twig is that short */
        paint(&e, on);
        for (int32_t i = 0; i < W * H; i++) {
            const int32_t x = i % W, y = i / W;
            bool alone = true;
            for (int32_t k = 0; k < 8; k++) {
                const int32_t u = x + tz_chain_dx[k], v = y + tz_chain_dy[k];
                alone = alone && !(u >= 0 && v >= 0 && u < W && v < H && m.on[v * W + u]);
            }
            assert_int_equal(on[i], m.on[i] && !alone);
        }
        tz_ebpt_deinit(&e);
        tz_edge_map_deinit(&m);
    }
    end_ctx(ctx);
}

/* ---- from pictures ---------------------------------------------------------------- */

static double turn(double a, double b)
{
    const double d = fmod(fabs(a - b), TZ_PI);
    return d < TZ_PI / 2 ? d : TZ_PI - d;
}

static const tz_edge *longest(const tz_ebpt *e)
{
    const tz_edge *best = &e->edge.v[0];
    assert_true(e->edge.n > 0);
    for (int32_t i = 1; i < e->edge.n; i++)
        best = e->edge.v[i].extent > best->extent ? &e->edge.v[i] : best;
    return best;
}

/* A dark crack and a step at any angle: one edge, in the middle, with that angle. */
static void lines_at_angles(void **state)
{
    (void)state;
    tz_ebpt_params p = default_params();
    p.edges = TZ_EDGES_GRADIENT; /* whose geometry is exact */
    tz_ctx *ctx = new_ctx(1);
    for (int32_t kind = 0; kind < 2; kind++) {
        for (int32_t deg = 0; deg < 180; deg += 15) {
            tz_image im = new_picture(ctx, 160, 160, 3);
            const double a = deg * TZ_PI / 180, nx = -sin(a), ny = cos(a);
            for (int32_t y = 0; y < 160; y++) {
                for (int32_t x = 0; x < 160; x++) {
                    const double d = (x + 0.5 - 80) * nx + (y + 0.5 - 80) * ny;
                    const double along = (x + 0.5 - 80) * ny - (y + 0.5 - 80) * nx;
                    double v = kind ? fmax(-0.5, fmin(0.5, d)) * 0.5 + 0.5
                                    : fmin(1, 0.2 + fmax(0, fabs(d) - 1) * 0.8);
                    if (kind == 0 && fabs(along) > 50)
                        v = 1;
                    set_pixel(&im, x, y, (float)v);
                }
            }
            tz_ebpt e;
            ok(ctx, tz_ebpt_analyze(ctx, &im, &p, &e));
            const tz_edge *d = longest(&e);
            assert_true(turn(d->angle, a) < 0.04);
            assert_true(fabs(d->centre.x - 80) < 2.5 && fabs(d->centre.y - 80) < 2.5);
            if (kind == 0) { /* 100 px; a chain code is up to 8 % longer than the line */
                assert_int_equal(e.edge.n, 1);
                assert_true(d->extent > 95 && d->extent < 116);
                assert_true(d->width > 2 && d->width < 14);
            }
            tz_ebpt_deinit(&e);
            tz_image_deinit(&im);
        }
    }
    end_ctx(ctx);
}

static void circle(void **state)
{
    (void)state;
    const tz_ebpt_params p = default_params();
    tz_ctx *ctx = new_ctx(1);
    tz_image im = new_picture(ctx, 200, 200, 1);
    for (int32_t y = 0; y < 200; y++)
        for (int32_t x = 0; x < 200; x++) {
            const double d = hypot(x + 0.5 - 104, y + 0.5 - 97) - 60;
            set_pixel(&im, x, y, (float)fmax(0.2, fmin(0.8, 0.5 + 0.6 * d)));
        }
    tz_ebpt e;
    ok(ctx, tz_ebpt_analyze(ctx, &im, &p, &e));
    assert_int_equal(e.edge.n, 1);
    const tz_edge *d = &e.edge.v[0];
    assert_true(fabs(d->centre.x - 104) < 0.7 && fabs(d->centre.y - 97) < 0.7);
    assert_true(d->extent > 2 * TZ_PI * 60 * 0.99 && d->extent < 2 * TZ_PI * 60 * 1.09);
    assert_true(d->end[0].x == d->end[1].x && d->end[0].y == d->end[1].y);
    tz_ebpt_deinit(&e);
    tz_image_deinit(&im);
    end_ctx(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(branchings_split),
        cmocka_unit_test(loops_close),
        cmocka_unit_test(straight_chains),
        cmocka_unit_test(thinning_keeps_topology),
        cmocka_unit_test(chains_cover_the_map),
        cmocka_unit_test(lines_at_angles),
        cmocka_unit_test(circle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
