/* SPDX-License-Identifier: Apache-2.0 */
/* Bricks, setts, cobbles, ashlar: rectangles in bonds on a plane that is warped, turned,
 * seen in perspective or bent to fans.
 *
 *   canvas pixel -> warp -> turn, perspective, fan -> (u, v) in brick heights
 *                -> bond: which rectangle -> worn outline: brick or joint
 *
 * Rows have their own heights and cuts; herringbone and basket weave are found by
 * arithmetic on the lattice of half bricks. */
#include "scenes/masonry.h"

enum bond { ROWS, HERRINGBONE, BASKET };
enum { ROW_MOST = 4000, CUT_MOST = 4000, LATTICE = 1 << 14 };

typedef struct rectangle {
    double x0, y0, x1, y1;
    int64_t key; /* names the brick */
} rectangle;

typedef struct plan {
    enum bond bond;
    double long_side, offset; /* of a brick, in heights; shift of every other row */
    double vary_high, vary_long, flemish;
    bool stacked;                             /* some bricks of a row are two low ones */
    double turn, far_x, far_y, fan, fan_wide; /* far: perspective per px */
    double warp, warp_size;
    double inset, inset_vary, twist, corner; /* in heights */
    double ragged, ragged_size;
    tz_masonry masonry;
} plan;

typedef struct rows {
    double top[ROW_MOST + 1];
    int32_t n;
    double cut[CUT_MOST + 1]; /* of the row asked for last */
    int32_t cuts, row;
    double left;
} rows;

static void draw_bond(tz_rng *r, plan *m)
{
    const double u = tz_rng_unit(r);
    m->bond = u < 0.12 ? HERRINGBONE : u < 0.18 ? BASKET : ROWS;
    const bool sett = tz_scene_chance(r, 0.35), ashlar = tz_scene_chance(r, 0.3);
    m->long_side = m->bond != ROWS ? 2
                   : sett          ? tz_rng_range(r, 0.9, 1.5)
                                   : tz_scene_spread(r, 1.6, 4.5);
    const double shift[4] = {0.5, 0.5, 0, 1.0 / 3};
    m->offset = shift[tz_rng_below(r, 4)];
    m->flemish = !sett && tz_scene_chance(r, 0.15) ? 0.5 : 1;
    if (ashlar || sett) {
        m->vary_high = tz_rng_range(r, 0, ashlar ? 0.5 : 0.12);
        m->vary_long = tz_rng_range(r, 0.1, ashlar ? 0.6 : 0.3);
        m->stacked = ashlar && tz_scene_chance(r, 0.6);
    }
    if (sett && tz_scene_chance(r, 0.35)) {
        m->fan = tz_rng_range(r, 0.3, 0.9);
        m->fan_wide = tz_rng_range(r, 7, 14);
    }
    m->ragged = (ashlar || sett ? 0.16 : 0.05) * tz_rng_unit(r);
    m->ragged_size = tz_scene_spread(r, 0.15, 0.8);
    m->twist = (ashlar || sett ? 0.06 : 0.015) * tz_rng_unit(r);
    m->corner = tz_rng_unit(r) * (ashlar || sett ? 0.3 : 0.08);
    m->inset_vary = tz_rng_unit(r) * (ashlar || sett ? 0.06 : 0.02);
    m->warp = tz_rng_unit(r) * (ashlar || sett ? 0.15 : 0.04);
    m->warp_size = tz_scene_spread(r, 0.6, 6);
}

static void draw_plan(tz_rng *r, const tz_canvas *c, plan *m)
{
    const double side = c->width < c->height ? c->width : c->height;
    tz_masonry *k = &m->masonry;
    draw_bond(r, m);
    k->seed = tz_rng_u64(r);
    const double most = tz_scene_clamp(side * 0.5 / sqrt(m->long_side), 24, 280);
    k->size = tz_scene_spread(r, 22, most);
    k->gap = k->size > 30 && tz_scene_chance(r, 0.65);
    k->joint =
        k->gap ? 8 + k->size * tz_scene_spread(r, 0.02, 0.25) : tz_scene_spread(r, 1, 7);
    k->joint_vary = tz_rng_range(r, 0, 0.6);
    m->inset = k->gap ? k->joint / 2 / k->size : 0;
    m->turn =
        tz_scene_chance(r, 0.6) ? 0.05 * tz_rng_normal(r) : tz_rng_range(r, 0, 2 * TZ_PI);
    if (tz_scene_chance(r, 0.35)) {
        m->far_x = tz_rng_range(r, -0.4, 0.4) / c->width;
        m->far_y = tz_rng_range(r, -0.6, 0.6) / c->height;
    }
    tz_masonry_draw(r, k);
    k->shoulder = fmin(k->shoulder, k->size * 0.4);
}

/* ---- bonds ------------------------------------------------------------------------- */

static void lay_rows(const plan *m, double from, double to, rows *w)
{
    tz_rng r = tz_rng_make(m->masonry.seed, 3);
    double y = from - 1;
    w->n = 0;
    w->row = -1;
    while (y < to + 1 && w->n < ROW_MOST) {
        w->top[w->n++] = y;
        y += 1 + m->vary_high * tz_rng_range(&r, -1, 1);
    }
    w->top[w->n] = y;
}

static void cut_row(const plan *m, double to, rows *w, int32_t row)
{
    tz_rng r = tz_rng_make(m->masonry.seed, tz_rng_stream(4, (uint64_t)row, 0));
    const double own = tz_scene_clamp(m->vary_long * 4, 0, 1) * tz_rng_unit(&r);
    double x = w->left - (1 + own + m->offset * (row & 1)) * m->long_side;
    w->row = row;
    w->cuts = 0;
    for (int32_t k = 0; x < to && w->cuts < CUT_MOST; k++) {
        const double share = (k + row) & 1 ? m->flemish : 1;
        w->cut[w->cuts++] = x;
        x += m->long_side * share * (1 + m->vary_long * tz_rng_range(&r, -1, 1));
    }
    w->cut[w->cuts] = x;
}

/* Largest k with v[k] <= x among n items. */
static int32_t find(const double *v, int32_t n, double x)
{
    int32_t lo = 0, hi = n;
    while (hi - lo > 1) {
        const int32_t mid = (lo + hi) / 2;
        if (v[mid] <= x)
            lo = mid;
        else
            hi = mid;
    }
    return lo;
}

static rectangle in_rows(const plan *m, rows *w, double to, double x, double y)
{
    const int32_t row = find(w->top, w->n, y);
    if (row != w->row)
        cut_row(m, to, w, row);
    const int32_t k = find(w->cut, w->cuts, x);
    rectangle q = {w->cut[k], w->top[row], w->cut[k + 1], w->top[row + 1], 0};
    const uint64_t own = tz_rng_stream(m->masonry.seed, (uint64_t)row, (uint64_t)k);
    int32_t half = 0;
    if (m->stacked && own % 7 == 0) { /* two low ones */
        const double cut =
            q.y0 + (q.y1 - q.y0) * (0.35 + 0.3 * (double)(own >> 50) / 16384);
        half = y > cut;
        *(half ? &q.y0 : &q.y1) = cut;
    }
    q.key = ((int64_t)row * LATTICE + k) * 2 + half;
    return q;
}

/* Half bricks (i, j); t = (i - j) mod 4: 0, 1 lie side by side, 3 stands on 2. */
static rectangle in_herringbone(double x, double y)
{
    int64_t i = (int64_t)floor(x), j = (int64_t)floor(y);
    const int64_t t = (i - j) & 3;
    const bool lying = t < 2;
    i -= t == 1;
    j -= t == 2;
    return (rectangle){(double)i, (double)j, (double)i + (lying ? 2 : 1),
                       (double)j + (lying ? 1 : 2), i * LATTICE + j};
}

/* Squares of two bricks, lying and standing in turn. */
static rectangle in_basket(double x, double y)
{
    int64_t i = (int64_t)floor(x), j = (int64_t)floor(y);
    const bool lying = ((i >> 1) + (j >> 1)) & 1;
    *(lying ? &i : &j) &= ~(int64_t)1;
    return (rectangle){(double)i, (double)j, (double)i + (lying ? 2 : 1),
                       (double)j + (lying ? 1 : 2), i * LATTICE + j};
}

/* ---- one pixel --------------------------------------------------------------------- */

static tz_vec2 on_plane(const tz_canvas *c, const plan *m, double px, double py)
{
    const double size = m->masonry.size, x = px - c->width / 2.0,
                 y = py - c->height / 2.0;
    const double far = 1 / (1 + m->far_x * x + m->far_y * y);
    const double cx = cos(m->turn), cy = sin(m->turn);
    tz_vec2 q = {(x * cx + y * cy) * far / size, (y * cx - x * cy) * far / size};
    const double wave = m->warp_size;
    if (m->warp > 0) {
        const double u = q.x / wave, v = q.y / wave;
        q.x += m->warp * tz_canvas_fbm(m->masonry.seed + 21, u, v, 2, 0.5);
        q.y += m->warp * tz_canvas_fbm(m->masonry.seed + 22, u, v, 2, 0.5);
    }
    if (m->fan > 0) { /* arcs side by side: rows dip towards the seams of the fans */
        const double t = q.x / m->fan_wide, s = t - floor(t) - 0.5;
        q.y += m->fan * m->fan_wide * (s * s - 0.08);
    }
    return q;
}

/* Distance into the worn rectangle, in heights; negative in the joint. */
static double worn(const plan *m, const rectangle *q, tz_vec2 p)
{
    const uint64_t own = tz_rng_stream(m->masonry.seed, (uint64_t)q->key, 11);
    const double a = ((double)(own & 1023) / 512 - 1) * m->twist;
    const double grow = ((double)(own >> 10 & 1023) / 512 - 1) * m->inset_vary;
    const double slip = ((double)(own >> 20 & 1023) / 512 - 1) * m->inset_vary;
    const double dx = p.x - (q->x0 + q->x1) / 2 + slip, dy = p.y - (q->y0 + q->y1) / 2;
    const double x = fabs(dx + a * dy) - (q->x1 - q->x0) / 2 + m->inset + grow;
    const double y = fabs(dy - a * dx) - (q->y1 - q->y0) / 2 + m->inset + grow;
    const double r = m->corner, ex = x + r, ey = y + r;
    double d = fmin(fmax(ex, ey), 0) - r;
    if (ex > 0 && ey > 0)
        d = sqrt(ex * ex + ey * ey) - r;
    else if (ex > 0 || ey > 0)
        d = fmax(ex, ey) - r;
    if (m->ragged > 0 && d > -2 * m->ragged)
        d += m->ragged *
             tz_canvas_fbm(own, p.x / m->ragged_size, p.y / m->ragged_size, 3, 0.6);
    return -d;
}

/* ---- all of them ------------------------------------------------------------------- */

/* Bricks in order of appearance: an open-addressing table from key to number. */
typedef struct census {
    int64_t *key;
    int32_t *number, size;
} census;

static tz_status census_number(tz_canvas *c, census *t, tz_masonry_map *w, int64_t key,
                               int32_t *number)
{
    uint64_t slot = tz_rng_stream((uint64_t)key, 5, 0) & (uint64_t)(t->size - 1);
    while (t->number[slot] >= 0 && t->key[slot] != key)
        slot = (slot + 1) & (uint64_t)(t->size - 1);
    if (t->number[slot] < 0) {
        if (w->n >= t->size / 2)
            return tz_fail(c->ctx, TZ_LIMIT, "too many bricks");
        t->key[slot] = key;
        t->number[slot] = w->n++;
    }
    *number = t->number[slot];
    return TZ_OK;
}

static tz_status lay(tz_canvas *c, const plan *m, rows *w, census *t, tz_masonry_map *out)
{
    double from_y = 1e30, to_y = -1e30, from_x = 1e30, to_x = -1e30;
    for (int32_t k = 0; k < 9; k++) { /* corners and the middles of sides */
        const tz_vec2 q =
            on_plane(c, m, (k % 3) * 0.5 * c->width, (k / 3) * 0.5 * c->height);
        from_y = fmin(from_y, q.y), to_y = fmax(to_y, q.y);
        from_x = fmin(from_x, q.x), to_x = fmax(to_x, q.x);
    }
    const double slack = 2 + m->fan * m->fan_wide * 0.4;
    w->left = from_x - 2;
    lay_rows(m, from_y - slack, to_y + slack, w);
    tz_status s = TZ_OK;
    for (int32_t y = 0; s == TZ_OK && y < c->height; y++)
        for (int32_t x = 0; s == TZ_OK && x < c->width; x++) {
            const tz_vec2 p = on_plane(c, m, x + 0.5, y + 0.5);
            const rectangle q = m->bond == HERRINGBONE ? in_herringbone(p.x, p.y)
                                : m->bond == BASKET    ? in_basket(p.x, p.y)
                                                    : in_rows(m, w, to_x + 4, p.x, p.y);
            int32_t id = 0;
            s = census_number(c, t, out, q.key, &id);
            out->id[(int64_t)y * c->width + x] =
                !m->masonry.gap || worn(m, &q, p) > 0 ? id : ~id;
        }
    return s;
}

/* Middle of what is seen of each brick. */
static tz_status find_middles(tz_canvas *c, tz_masonry_map *w)
{
    int32_t *seen = NULL;
    tz_status s = tz_alloc_zero(c->ctx, &w->middle, (size_t)w->n, sizeof *w->middle);
    if (s == TZ_OK)
        s = tz_alloc_zero(c->ctx, &seen, (size_t)w->n, sizeof *seen);
    for (int32_t y = 0; s == TZ_OK && y < c->height; y++)
        for (int32_t x = 0; x < c->width; x++) {
            const int32_t id = w->id[(int64_t)y * c->width + x], i = id < 0 ? ~id : id;
            w->middle[i].x += x;
            w->middle[i].y += y;
            seen[i]++;
        }
    for (int32_t i = 0; s == TZ_OK && i < w->n; i++)
        w->middle[i] = tz_vec2_scale(w->middle[i], 1.0 / seen[i]);
    tz_free(c->ctx, seen);
    return s;
}

tz_status tz_scene_BRICKS(tz_canvas *c)
{
    plan m = {0};
    rows *w = NULL;
    census t = {.size = 1 << 20};
    tz_masonry_map map = {0};
    const int64_t n = (int64_t)c->width * c->height;
    draw_plan(&c->rng, c, &m);
    while (t.size > 4096 && t.size / 4 > n / 64) /* bricks are never that small */
        t.size /= 2;
    tz_status s = tz_masonry_map_init(c, &map);
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &w, 1, sizeof *w);
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &t.key, (size_t)t.size, sizeof *t.key);
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &t.number, (size_t)t.size, sizeof *t.number);
    for (int32_t i = 0; s == TZ_OK && i < t.size; i++)
        t.number[i] = -1;
    if (s == TZ_OK)
        s = lay(c, &m, w, &t, &map);
    if (s == TZ_OK)
        s = find_middles(c, &map);
    if (s == TZ_OK)
        s = tz_masonry_paint(c, &c->rng, &m.masonry, &map);
    tz_masonry_map_deinit(c, &map);
    tz_free(c->ctx, w);
    tz_free(c->ctx, t.key);
    tz_free(c->ctx, t.number);
    return s;
}
