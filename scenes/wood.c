/* SPDX-License-Identifier: Apache-2.0 */
/* Wood: planks, parquet, stacked logs. A floor lays boards (which board, where on it, how
 * far to its border); every board then has a face of its own cut from its own tree:
 *
 *   rings   g = distance to the pith / ring width, bent by noise and pushed round knots;
 *           dark towards the end of each ring. Inside texture, however loud
 *   knots   ellipses with rings of their own; their outline is a boundary
 *   nails, flaking paint, drying cracks: boundaries too */
#include "scenes/shapes.h"

typedef enum floor_kind { PLANKS, HERRINGBONE, BASKET, LOGS } floor_kind;

/* things of board b: 1 + SLOTS * b + slot; 0 is the gap */
enum { BOARD, KNOT, NAIL, PAINT, SLOTS };

typedef struct wood {
    tz_shape_bend bend;
    tz_shape_cells cells; /* logs */
    tz_shape_field peel;
    uint64_t seed;
    floor_kind kind;
    double wide, length; /* of boards */
    int strips;          /* parquet: length in widths */
    double jitter, half, half_spread, bevel, step, cup;
    int32_t first_row, rows, first_col, cols;
    double ring, ring_dark, figure, fibre, pith, loud;
    double knots, knot_size, nails, paint, cracks, spread;
    float base[3], gap[3], paint_colour[3], metal[3];
} wood;

/* Where a pixel lies: on board b at u along, v across from its middle. */
typedef struct wood_spot {
    int32_t board;
    float u, v, length, wide, edge, half;
    float knot, knot_size; /* distance to the knot's middle over its size; px */
    float turn;            /* of the board's u against the pattern's x */
    uint8_t slot;
    bool log;
} wood_spot;

static void draw_colours(tz_rng *r, wood *k)
{
    static const float timber[][3] = {{0.45f, 0.28f, 0.13f},  {0.32f, 0.17f, 0.08f},
                                      {0.15f, 0.075f, 0.04f}, {0.55f, 0.42f, 0.25f},
                                      {0.27f, 0.26f, 0.24f},  {0.40f, 0.37f, 0.33f},
                                      {0.33f, 0.13f, 0.06f}};
    static const float iron[3] = {0.12f, 0.10f, 0.09f};
    tz_canvas_colour(r, timber[tz_rng_below(r, 7)], 0.4, 0.25, k->base);
    for (int i = 0; i < 3; i++)
        k->gap[i] = 0.1f * k->base[i] + 0.004f;
    tz_canvas_base_colour(r, k->paint_colour);
    tz_shape_part(k->paint_colour, k->base, 0.35);
    bool bright = k->base[0] + k->base[1] < 0.25f || tz_shape_chance(r, 0.2);
    tz_canvas_colour(r, iron, 0.2, 0.4, k->metal);
    for (int i = 0; i < 3; i++)
        k->metal[i] = bright ? 2.2f * k->base[i] + 0.08f : 0.3f * k->metal[i];
    k->spread = tz_shape_log_range(r, 0.02, 0.4);
}

static void draw_parameters(tz_canvas *c, wood *k)
{
    tz_rng *r = &c->rng;
    k->seed = tz_rng_u64(r);
    double kind = tz_rng_unit(r);
    k->kind = kind < 0.6    ? PLANKS
              : kind < 0.75 ? HERRINGBONE
              : kind < 0.87 ? BASKET
                            : LOGS;
    k->wide = tz_shape_log_range(r, 45, 260);
    k->length = k->wide * tz_shape_log_range(r, 2, 14);
    k->strips = 2 + tz_rng_below(r, 5);
    if (k->kind == HERRINGBONE || k->kind == BASKET)
        k->wide = tz_shape_log_range(r, 26, 110);
    k->jitter = tz_shape_chance(r, 0.4) ? tz_rng_range(r, 0, 0.5) : 0;
    k->half =
        tz_shape_chance(r, 0.25) ? tz_rng_range(r, 4, 12) : tz_shape_log_range(r, 0.4, 4);
    k->half = fmin(k->half, 0.12 * k->wide);
    k->half_spread = tz_rng_range(r, 0, 0.8);
    k->bevel = tz_shape_log_range(r, 0.7, 9);
    k->step = tz_shape_log_range(r, 0.2, 6);
    k->cup = 0.05 * tz_rng_normal(r);
    k->ring = tz_shape_log_range(r, 4, 28);
    k->ring_dark = tz_rng_range(r, 0.1, 0.75);
    k->figure = tz_shape_log_range(r, 3, 60);
    k->fibre = tz_rng_range(r, 0.08, 0.5);
    k->pith = tz_shape_log_range(r, 0.1, 2.5);
    k->loud = tz_rng_range(r, 0.05, 0.6);
    k->knots = tz_shape_chance(r, 0.5) ? tz_rng_range(r, 0.05, 0.7) : 0;
    k->knot_size = tz_shape_log_range(r, 6, 0.2 * k->wide + 7);
    k->nails = k->kind == PLANKS && tz_shape_chance(r, 0.3) ? tz_rng_range(r, 4, 9) : 0;
    k->paint =
        tz_shape_chance(r, 0.2) && k->kind == PLANKS ? tz_rng_range(r, -0.35, 0.35) : 9;
    k->cracks = tz_shape_chance(r, 0.35) ? tz_rng_range(r, 0.1, 0.5) : 2;
    draw_colours(r, k);
}

static tz_status build(tz_canvas *c, wood *k)
{
    tz_rng *r = &c->rng;
    tz_shape_bend_def d = tz_shape_bend_draw(r, tz_shape_chance(r, 0.5) ? 2 : 0.05, 400);
    d.warp = tz_shape_chance(r, 0.5) ? 0 : tz_rng_range(r, 0.5, 6);
    tz_status s = tz_shape_bend_init(c, k->seed + 1, &d, &k->bend);
    tz_rect box = k->bend.box;
    k->first_row = (int32_t)floor(box.y / k->wide) - 3;
    k->rows = (int32_t)(box.h / k->wide) + 8;
    double across = k->kind == PLANKS ? k->length : k->wide;
    k->first_col = (int32_t)floor(box.x / across) - 8;
    k->cols = (int32_t)(box.w / across) + 20;
    tz_shape_cells_def def = {.pitch_x = 1.1 * k->wide,
                              .pitch_y = k->wide,
                              .jitter = tz_rng_range(r, 0.1, 0.8),
                              .hex = true};
    if (s == TZ_OK)
        s = tz_shape_cells_init(c, k->seed + 2, box, &def, &k->cells);
    if (s == TZ_OK)
        s = tz_shape_field_init(c, k->seed + 3, tz_shape_log_range(r, 60, 250), 2,
                                &k->peel);
    return s;
}

/* ---- floors ------------------------------------------------------------------------ */

static double row_border(const wood *k, int32_t j)
{
    return k->wide * (j + k->jitter * (tz_shape_unit(k->seed + 4, j, 0) - 0.5));
}

static void plank_at(const wood *k, double x, double y, wood_spot *p)
{
    int32_t j = (int32_t)floor(y / k->wide);
    if (y < row_border(k, j))
        j--;
    else if (y >= row_border(k, j + 1))
        j++;
    double top = row_border(k, j), low = row_border(k, j + 1);
    double at = x / k->length + tz_shape_unit(k->seed + 5, j, 0);
    int32_t i = (int32_t)floor(at);
    p->board = (j - k->first_row) * k->cols + i - k->first_col;
    p->length = (float)k->length, p->wide = (float)(low - top);
    p->u = (float)((at - i - 0.5) * k->length);
    p->v = (float)(y - 0.5 * (top + low));
}

static int32_t modulo(int32_t a, int32_t n) { return (a % n + n) % n; }

/* Squares (i, j) of a board's width: along a row the herringbone is n squares of a lying
 * board, then one square each of n standing ones. */
static void herringbone_at(const wood *k, double x, double y, wood_spot *p)
{
    int32_t i = (int32_t)floor(x / k->wide), j = (int32_t)floor(y / k->wide);
    int32_t n = k->strips, m = modulo(i - j, 2 * n);
    bool lying = m < n;
    int32_t bi = lying ? i - m : i, bj = lying ? j : j + m - 2 * n + 1;
    double cx = (lying ? bi + 0.5 * n : bi + 0.5) * k->wide;
    double cy = (lying ? bj + 0.5 : bj + 0.5 * n) * k->wide;
    p->board = (bj - k->first_row + n) * k->cols + bi - k->first_col + n;
    p->u = (float)(lying ? x - cx : y - cy);
    p->v = (float)(lying ? y - cy : x - cx);
    p->turn = lying ? 0 : 1;
    p->length = (float)(n * k->wide), p->wide = (float)k->wide;
}

static void basket_at(const wood *k, double x, double y, wood_spot *p)
{
    double block = k->strips * k->wide;
    int32_t bi = (int32_t)floor(x / block), bj = (int32_t)floor(y / block);
    bool lying = (bi + bj) & 1;
    int32_t i = (int32_t)floor(x / k->wide), j = (int32_t)floor(y / k->wide);
    p->u = (float)(lying ? x - (bi + 0.5) * block : y - (bj + 0.5) * block);
    p->v = (float)(lying ? y - (j + 0.5) * k->wide : x - (i + 0.5) * k->wide);
    if (lying)
        i = bi * k->strips;
    else
        j = bj * k->strips;
    p->board = (j - k->first_row + k->strips) * k->cols + i - k->first_col + k->strips;
    p->turn = lying ? 0 : 1;
    p->length = (float)block, p->wide = (float)k->wide;
}

/* A log fills most of the circle that fits into its cell about its point. */
static void log_at(const wood *k, double x, double y, wood_spot *p)
{
    tz_shape_cell hit = tz_shape_cells_at(&k->cells, x, y);
    const float *q = k->cells.point + 2 * hit.cell;
    double u = x - k->cells.x - (double)q[0] * k->cells.def.pitch_x;
    double v = y - k->cells.y - (double)q[1] * k->cells.def.pitch_y;
    double size = k->wide * (0.42 + 0.2 * tz_shape_unit(k->seed + 6, hit.cell, 0));
    double rho = sqrt(u * u + v * v), a = atan2(v, u) / TZ_PI;
    double n = (double)tz_canvas_fbm(k->seed + 7, 2 * fabs(a), 9.1 * hit.cell, 2, 0.5);
    p->board = hit.cell, p->log = true;
    p->u = (float)u, p->v = (float)v;
    p->wide = p->length = (float)(2 * size);
    p->edge = (float)fmin(size * (1 + 0.08 * n) - rho, hit.edge);
}

static void locate(const wood *k, int32_t x, int32_t y, wood_spot *p)
{
    tz_vec2 q = tz_shape_bend_at(&k->bend, x + 0.5, y + 0.5);
    *p = (wood_spot){.knot = 9};
    switch (k->kind) {
    case PLANKS: plank_at(k, q.x, q.y, p); break;
    case HERRINGBONE: herringbone_at(k, q.x, q.y, p); break;
    case BASKET: basket_at(k, q.x, q.y, p); break;
    default: log_at(k, q.x, q.y, p); return;
    }
    double wear = (double)tz_canvas_fbm(k->seed + 8, q.x / 50, q.y / 50, 3, 0.6);
    p->edge = (float)(fmin(0.5 * (double)p->length - fabs((double)p->u),
                           0.5 * (double)p->wide - fabs((double)p->v)));
    p->half = (float)(k->half * (1 + k->half_spread * wear) *
                      (0.6 + 0.8 * tz_shape_unit(k->seed + 9, p->board, 0)));
}

static int32_t board_count(const wood *k)
{
    int32_t margin = 2 * k->strips + 2;
    return k->kind == LOGS ? k->cells.cols * k->cells.rows
                           : k->cols * (k->rows + margin) + margin;
}

/* ---- faces ------------------------------------------------------------------------- */

/* One knot at most in each stretch of a board, well inside it. */
static void find_knot(const wood *k, wood_spot *p)
{
    double reach = 6 * k->wide;
    int32_t part = (int32_t)floor((double)p->u / reach + 100);
    int64_t name = (int64_t)p->board * 512 + part;
    if (tz_shape_unit(k->seed + 10, name, 0) > k->knots)
        return;
    double size = k->knot_size * (0.6 + tz_shape_unit(k->seed + 10, name, 1));
    size = fmin(size, 0.35 * (double)p->wide);
    double u = (double)p->u -
               (part - 100 + 0.2 + 0.6 * tz_shape_unit(k->seed + 10, name, 2)) * reach;
    double free = 0.5 * (double)p->wide - size - k->half;
    double v = (double)p->v - free * (2 * tz_shape_unit(k->seed + 10, name, 3) - 1);
    double long_ = 1 + 0.8 * tz_shape_unit(k->seed + 10, name, 4);
    double n = (double)tz_canvas_noise(k->seed + 11, u / size, v / size);
    p->knot = (float)(sqrt(u * u / (long_ * long_) + v * v) / size + 0.15 * n);
    p->knot_size = (float)size;
}

static bool on_nail(const wood *k, const wood_spot *p)
{
    double x = 0.5 * (double)p->length - fabs((double)p->u) - 2.5 * k->nails;
    double y = 0.28 * (double)p->wide - fabs((double)p->v);
    double shift = 3 * (tz_shape_unit(k->seed + 12, p->board, p->u > 0) - 0.5);
    x += shift, y -= shift;
    return x * x + y * y < k->nails * k->nails && (double)p->wide > 6 * k->nails;
}

static void find_slot(const wood *k, int32_t x, int32_t y, wood_spot *p)
{
    if (p->log)
        return;
    find_knot(k, p);
    if ((double)p->knot < 1)
        p->slot = KNOT;
    if (k->nails > 0 && on_nail(k, p))
        p->slot = NAIL;
    if (k->paint < 2) {
        double fine = 0.35 * (double)tz_canvas_fbm(k->seed + 13, (double)p->u / 30,
                                                   (double)p->v / 8, 3, 0.6);
        if (tz_shape_field_at(&k->peel, x, y) + fine > k->paint)
            p->slot = PAINT;
    }
}

/* Number of rings from the pith. */
static double rings_at(const wood *k, const wood_spot *p, uint64_t own)
{
    double u = (double)p->u, v = (double)p->v;
    double drift = (double)tz_canvas_fbm(own, u / 260, v / 90, 3, 0.5);
    if (p->log)
        return (sqrt(u * u + v * v) + 0.5 * k->figure * drift) / k->ring;
    double pith = k->wide * k->pith * (2 * tz_shape_unit(own, 1, 0) - 1);
    double depth = 6 + 0.8 * k->wide * tz_shape_unit(own, 2, 0) +
                   0.06 * u * (tz_shape_unit(own, 3, 0) - 0.5);
    double g = sqrt((v - pith) * (v - pith) + depth * depth) + k->figure * drift;
    double d = (double)p->knot;
    if (d < 5)
        g += 1.6 * (double)p->knot_size * exp(-0.6 * d * d) * (v > pith ? 1 : -1);
    return g / k->ring;
}

static void paint_face(tz_canvas *c, const wood *k, const wood_spot *p, int64_t i)
{
    uint64_t own = k->seed + 100 + (uint64_t)p->board;
    double u = (double)p->u, v = (double)p->v;
    double g = p->slot == KNOT ? 3.2 * (double)p->knot : rings_at(k, p, own);
    double late = g - floor(g);
    double line = late * late * late * (1 - tz_shape_ramp(0.93, 1, late));
    double own_ring = (double)tz_canvas_noise(own + 7, floor(g) * 0.73, 0.5);
    double fibre = p->log ? (double)tz_canvas_noise(own, u / 3, v / 3)
                          : (double)tz_canvas_fbm(own + 1, u / 45, v / 2.2, 2, 0.7);
    double tone =
        (1 - k->ring_dark * line * (1 + 0.6 * own_ring)) * (1 + k->fibre * fibre);
    if (p->log) {
        double a = atan2(v, u), far = sqrt(u * u + v * v) / (0.5 * (double)p->wide);
        double split =
            (double)tz_canvas_noise(own + 2, 3 * a, 0.3 * far) + 0.35 * far - 0.15;
        tone *= 1 - 0.6 * tz_shape_ramp(0.75, 0.85, split);
        tone *= 1 - 0.55 * (1 - tz_shape_ramp(0.05, 0.09, (double)p->edge / k->wide));
    }
    if (p->slot == KNOT)
        tone *= 0.4 + 0.25 * fabs((double)p->knot - 0.3);
    else if ((double)p->knot < 3)
        tone *= 1 - 0.35 * exp(-3 * ((double)p->knot - 1));
    tz_shape_dim(c, i, tone);
    c->relief[i] += (float)(0.8 * k->fibre * fibre - 0.5 * k->ring_dark * line);
}

/* Drying cracks along the grain: level sets of drawn-out noise, open in places. */
static void crack(tz_canvas *c, const wood *k, const wood_spot *p, int64_t i)
{
    if (k->cracks > 1 || p->log || p->slot != BOARD)
        return;
    uint64_t own = k->seed + 200 + (uint64_t)p->board;
    double u = (double)p->u / 420, v = (double)p->v / 26;
    double where =
        (double)tz_canvas_noise(own + 1, (double)p->u / 130, (double)p->v / 40);
    if (where < k->cracks || (double)p->edge < 6)
        return;
    double open = tz_shape_ramp(k->cracks, k->cracks + 0.3, where);
    double n = (double)tz_canvas_noise(own, u, v);
    double n2 = (double)tz_canvas_noise(own, u, ((double)p->v + 1) / 26);
    double steep = fmax(fabs(n2 - n), 0.01), d = fabs(n) / steep, half = 0.4 + 1.6 * open;
    tz_shape_joint(c, i, d, half, k->gap, 0.9 * open);
    c->relief[i] -= (float)(2 * open * (d < half));
    if (n * n2 <= 0 && open > 0.35)
        c->line[i] = 1;
}

static void paint(tz_canvas *c, const wood *k, const tz_canvas_skin *skin,
                  const wood_spot *p, int64_t i)
{
    int32_t id = c->segment[i];
    c->relief[i] = 0;
    if (id != 0) {
        double e = fmin((double)p->edge / k->bevel, 1), v = (double)p->v;
        c->relief[i] = (float)(6 + k->step * tz_shape_unit(k->seed + 14, p->board, 0) +
                               0.5 * k->bevel * sqrt(fmax(0, e * (2 - e))) +
                               k->cup * v * v / (0.5 * k->wide));
    }
    tz_canvas_skin_at(c, skin, (int32_t)(i % c->width), (int32_t)(i / c->width));
    if (id == 0)
        return;
    if (p->slot == NAIL || p->slot == PAINT)
        c->relief[i] += p->slot == NAIL ? -0.8f : 0.9f;
    else
        paint_face(c, k, p, i);
    crack(c, k, p, i);
    tz_shape_joint(c, i, (double)p->edge, (double)p->half, k->gap, 0.95);
}

/* Drawn when a thing is first met. */
static const tz_canvas_skin *skin_of(const wood *k, tz_shape_things *t, int32_t i)
{
    tz_shape_thing *v = &t->v[i];
    if (v->skin.seed != 0)
        return &v->skin;
    int slot = i ? (i - 1) % SLOTS : -1;
    tz_rng r = tz_rng_make(k->seed, tz_rng_stream(1, (uint64_t)(i ? (i - 1) / SLOTS : 0),
                                                  (uint64_t)(slot == PAINT)));
    const float *base = i == 0          ? k->gap
                        : slot == NAIL  ? k->metal
                        : slot == PAINT ? k->paint_colour
                                        : k->base;
    float colour[3];
    double spread = slot == PAINT ? 0.03 : k->spread; /* one pot of paint for all */
    tz_canvas_colour(&r, base, spread, 0.7 * spread, colour);
    tz_canvas_skin_draw(&r, colour, slot == BOARD ? k->wide : 12, k->loud, &v->skin);
    v->skin.bump *= 0.4f;
    v->element = i > 0 && slot != PAINT;
    v->depth = i == 0 ? 0 : slot == BOARD ? 1 : 2;
    return &v->skin;
}

static tz_status paint_all(tz_canvas *c, wood *k)
{
    tz_shape_things t = {0};
    tz_status s = tz_shape_things_init(c, 1 + SLOTS * board_count(k), &t);
    for (int64_t i = 0, n = (int64_t)c->width * c->height; i < n && s == TZ_OK; i++) {
        int32_t x = (int32_t)(i % c->width), y = (int32_t)(i / c->width);
        wood_spot p;
        locate(k, x, y, &p);
        find_slot(k, x, y, &p);
        bool gap = p.log ? p.edge < 0 : p.half >= 4 && p.edge < p.half;
        c->segment[i] = gap ? 0 : 1 + SLOTS * p.board + p.slot;
        paint(c, k, skin_of(k, &t, c->segment[i]), &p, i);
    }
    if (s == TZ_OK) {
        tz_shape_things_count(c, &t);
        s = tz_shape_things_commit(c, &t);
    }
    tz_shape_things_deinit(c, &t);
    return s;
}

tz_status tz_scene_WOOD(tz_canvas *c)
{
    wood k = {0};
    draw_parameters(c, &k);
    tz_status s = build(c, &k);
    if (s == TZ_OK)
        s = paint_all(c, &k);
    tz_shape_field_deinit(c, &k.peel);
    tz_shape_cells_deinit(c, &k.cells);
    tz_shape_bend_deinit(c, &k.bend);
    return s;
}
