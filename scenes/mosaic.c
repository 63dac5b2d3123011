/* SPDX-License-Identifier: Apache-2.0 */
/* Flat pieces in a matrix: square, six-sided and three-sided tiles, shards (opus
 * palladianum), dark stones in courses, and chips of terrazzo. Each layout says at a
 * point of the bent plane which piece is there and how far its border is:
 *
 *   joint    edge < half; a piece of its own where it is 8 px wide or more
 *   chips    convex polygons from large to small, dropped where nothing lies yet */
#include "scenes/shapes.h"

#include <assert.h>

typedef enum layout { SQUARES, SIXES, TRIANGLES, SHARDS, COURSES, CHIPS, LAYOUTS } layout;

#define TRIANGLE 0.8660254 /* height of an equilateral triangle */

enum { FAMILIES = 4, CHIP_SIDES = 9 };

typedef struct mosaic {
    tz_shape_bend bend;
    tz_shape_cells cells; /* sixes, shards, courses */
    uint64_t seed;
    layout kind;
    double wide, tall, stagger, turn, shrink, rough, course;
    int32_t first_col, first_row, cols, rows;
    double half, half_spread; /* of joints */
    double bevel, tilt, lift, sink, spread;
    float family[FAMILIES][3], grout[3];
    bool chequered;
    double loud, bump, motley; /* bump: polished or not */
} mosaic;

typedef struct mosaic_spot {
    int32_t thing; /* from 1 */
    float edge, half, dx, dy;
} mosaic_spot;

static void draw_colours(tz_rng *r, mosaic *k)
{
    tz_canvas_base_colour(r, k->family[0]);
    bool motley = tz_shape_chance(r, 0.35);
    for (int i = 1; i < FAMILIES; i++)
        if (motley)
            tz_canvas_base_colour(r, k->family[i]);
        else
            tz_canvas_colour(r, k->family[0], 0.3, 0.3, k->family[i]);
    k->spread = tz_shape_log_range(r, 0.02, 0.5);
    k->chequered = tz_shape_chance(r, 0.25);
    static const float cement[3] = {0.40f, 0.38f, 0.35f},
                       dark[3] = {0.05f, 0.045f, 0.04f};
    double choice = tz_rng_unit(r);
    if (choice < 0.25)
        tz_canvas_base_colour(r, k->grout);
    else
        tz_canvas_colour(r, choice < 0.65 ? cement : dark, 0.5, 0.2, k->grout);
    double apart = k->kind == CHIPS ? 0.35 : tz_shape_log_range(r, 0.08, 0.6);
    for (int i = 0; i < FAMILIES; i++)
        tz_shape_part(k->family[i], k->grout, apart);
}

static void draw_parameters(tz_canvas *c, mosaic *k)
{
    tz_rng *r = &c->rng;
    k->seed = tz_rng_u64(r);
    k->kind = (layout)tz_rng_below(r, LAYOUTS);
    k->wide = tz_shape_log_range(r, 26, 220);
    k->tall = k->wide * (tz_shape_chance(r, 0.6) ? 1 : tz_rng_range(r, 0.5, 2));
    if (k->kind == TRIANGLES)
        k->tall = TRIANGLE * k->wide;
    k->stagger = tz_shape_chance(r, 0.3) ? tz_rng_unit(r) : 0;
    k->turn = tz_shape_chance(r, 0.6) ? tz_rng_range(r, 0, 0.1) : 0;
    k->shrink = tz_shape_chance(r, 0.6) ? tz_rng_range(r, 0, 0.12) : 0;
    k->rough = tz_shape_log_range(r, 0.2, 3) * (k->kind == COURSES ? 2 : 1);
    k->half =
        tz_shape_chance(r, 0.3) ? tz_rng_range(r, 4, 14) : tz_shape_log_range(r, 0.6, 4);
    k->half = fmin(k->half, 0.11 * fmin(k->wide, k->tall) + 0.5);
    k->half_spread = tz_shape_chance(r, 0.5) ? tz_rng_range(r, 0, 0.7) : 0;
    k->bevel = tz_shape_log_range(r, 0.6, k->kind == COURSES ? 0.3 * k->wide : 7);
    k->tilt = tz_shape_log_range(r, 0.004, 0.08);
    k->lift = tz_shape_log_range(r, 0.1, 4);
    k->sink = tz_shape_log_range(r, 0.2, 6);
    k->course = k->kind == COURSES ? k->wide * tz_rng_range(r, 2, 4) : 1e9;
    k->loud = tz_rng_range(r, 0.05, 0.9);
    k->bump = tz_shape_chance(r, 0.5) ? 0.2 : 1;
    k->motley = tz_rng_unit(r);
    draw_colours(r, k);
}

static tz_status build(tz_canvas *c, mosaic *k)
{
    tz_rng *r = &c->rng;
    tz_shape_bend_def d =
        tz_shape_bend_draw(r, tz_shape_chance(r, 0.5) ? 3 : 0.03, k->wide);
    d.warp *= tz_rng_unit(r) * 0.5;
    tz_status s = tz_shape_bend_init(c, k->seed + 1, &d, &k->bend);
    tz_rect box = k->bend.box;
    k->first_col = (int32_t)floor(box.x / k->wide) - 3;
    k->first_row = (int32_t)floor(box.y / k->tall) - 3;
    k->cols = (int32_t)(box.w / k->wide) + 8;
    k->rows = (int32_t)(box.h / k->tall) + 8;
    bool regular = k->kind == SIXES;
    tz_shape_cells_def def = {.pitch_x = k->wide,
                              .pitch_y = regular ? 0.866 * k->wide : k->wide,
                              .jitter = regular ? k->turn : tz_rng_range(r, 0.7, 1),
                              .hex = true,
                              .join_x = regular ? 0 : tz_rng_range(r, 0, 0.2),
                              .join_y = regular ? 0 : tz_rng_range(r, 0, 0.2),
                              .join_most = 3};
    if (s == TZ_OK)
        s = tz_shape_cells_init(c, k->seed + 2, box, &def, &k->cells);
    return s;
}

/* ---- layouts ----------------------------------------------------------------------- */

static mosaic_spot square_at(const mosaic *k, double x, double y)
{
    int32_t j = (int32_t)floor(y / k->tall);
    double shift = k->stagger * j;
    int32_t i = (int32_t)floor(x / k->wide - shift + floor(shift));
    double u = x - k->wide * (i + 0.5 + shift - floor(shift)),
           v = y - k->tall * (j + 0.5);
    int32_t at = (j - k->first_row) * k->cols + i - k->first_col;
    double a = k->turn * (tz_shape_unit(k->seed + 3, at, 0) - 0.5);
    double less = k->shrink * tz_shape_unit(k->seed + 3, at, 1);
    double ur = u + a * v, vr = v - a * u; /* small angles */
    double edge = fmin(0.5 * k->wide * (1 - less) - fabs(ur),
                       0.5 * k->tall * (1 - less) - fabs(vr));
    /* outside of a tile that is turned or small, yet in its cell, is joint as well */
    return (mosaic_spot){
        .thing = 1 + at, .edge = (float)fmax(edge, 0), .dx = (float)u, .dy = (float)v};
}

/* Oblique axes: a cell is two triangles, below and above its diagonal. */
static mosaic_spot triangle_at(const mosaic *k, double x, double y)
{
    double height = TRIANGLE * k->wide, v = y / height, u = x / k->wide - 0.5 * v;
    int32_t j = (int32_t)floor(v), i = (int32_t)floor(u);
    double fu = u - i, fv = v - j;
    bool upper = fu + fv > 1;
    double edge =
        upper ? fmin(fmin(1 - fu, 1 - fv), fu + fv - 1) : fmin(fmin(fu, fv), 1 - fu - fv);
    int32_t col = i - k->first_col, row = j - k->first_row;
    int32_t wide = 2 * k->cols + 2 * k->rows;
    col += k->rows;
    return (mosaic_spot){.thing = 1 + (row * wide + col) * 2 + upper,
                         .edge = (float)(edge * height),
                         .dx = (float)((fu - 0.5) * k->wide),
                         .dy = (float)((fv - 0.5) * k->wide)};
}

static mosaic_spot shard_at(const mosaic *k, double x, double y)
{
    tz_shape_cell hit = tz_shape_cells_at(&k->cells, x, y);
    mosaic_spot p = {.thing = 1 + hit.root, .edge = (float)hit.edge};
    const float *q = k->cells.point + 2 * hit.root;
    p.dx = (float)(x - k->cells.x - (double)q[0] * k->cells.def.pitch_x);
    p.dy = (float)(y - k->cells.y - (double)q[1] * k->cells.def.pitch_y);
    if (k->course < 1e8) {
        double row = (y - k->bend.box.y) / k->course;
        double to = fmin(row - floor(row), 1 - row + floor(row)) * k->course;
        /* no cell reaches into more than three courses */
        p.thing =
            1 + hit.root + ((int32_t)floor(row) & 3) * k->cells.cols * k->cells.rows;
        p.edge = (float)fmin((double)p.edge, to);
    }
    return p;
}

static int32_t thing_count(const mosaic *k)
{
    switch (k->kind) {
    case SQUARES: return 2 + k->cols * k->rows;
    case TRIANGLES: return 2 + 4 * (k->cols + k->rows) * (2 * k->rows + 8);
    case COURSES: return 2 + 4 * k->cells.cols * k->cells.rows;
    default: return 2 + k->cells.cols * k->cells.rows;
    }
}

static mosaic_spot locate(const mosaic *k, int32_t x, int32_t y)
{
    tz_vec2 q = tz_shape_bend_at(&k->bend, x + 0.5, y + 0.5);
    double f = 1 / (4 + 4 * k->rough);
    q.x += k->rough * (double)tz_canvas_fbm(k->seed + 4, x * f, y * f, 3, 0.6);
    q.y += k->rough * (double)tz_canvas_fbm(k->seed + 5, x * f, y * f, 3, 0.6);
    mosaic_spot p = k->kind == SQUARES     ? square_at(k, q.x, q.y)
                    : k->kind == TRIANGLES ? triangle_at(k, q.x, q.y)
                                           : shard_at(k, q.x, q.y);
    double swell =
        k->half_spread > 0
            ? (double)tz_canvas_noise(k->seed + 6, q.x / k->wide, q.y / k->wide)
            : 0;
    p.half = (float)(k->half * (1 + k->half_spread * swell));
    return p;
}

/* ---- chips ------------------------------------------------------------------------- */

typedef struct chip {
    tz_vec2 at;
    int sides;
    double nx[CHIP_SIDES], ny[CHIP_SIDES], far[CHIP_SIDES], reach;
} chip;

static double chip_edge(const chip *p, double x, double y)
{
    double edge = 1e9;
    for (int i = 0; i < p->sides; i++)
        edge =
            fmin(edge, p->far[i] - p->nx[i] * (x - p->at.x) - p->ny[i] * (y - p->at.y));
    return edge;
}

static void draw_chip(tz_rng *r, const tz_canvas *c, double size, chip *p)
{
    p->at = (tz_vec2){tz_rng_range(r, 0, c->width), tz_rng_range(r, 0, c->height)};
    p->sides = 4 + tz_rng_below(r, CHIP_SIDES - 3);
    double turn = tz_rng_range(r, 0, 7), squeeze = tz_rng_range(r, 0.5, 1);
    double lean = tz_rng_range(r, 0, 7);
    p->reach = 1.6 * size;
    for (int i = 0; i < p->sides; i++) {
        double a = turn + 2 * TZ_PI * (i + 0.7 * (tz_rng_unit(r) - 0.5)) / p->sides;
        double thin = 1 - (1 - squeeze) * cos(a - lean) * cos(a - lean);
        p->nx[i] = cos(a), p->ny[i] = sin(a);
        p->far[i] = 0.5 * size * thin * tz_rng_range(r, 0.65, 1.15);
    }
}

/* True if nothing lies within `gap` of the chip; paints it then. */
static bool drop_chip(tz_canvas *c, const mosaic *k, const chip *p, int32_t thing,
                      mosaic_spot *spots)
{
    double gap = 2 * k->half + 1;
    int32_t x0 = (int32_t)fmax(0, p->at.x - p->reach),
            y0 = (int32_t)fmax(0, p->at.y - p->reach);
    int32_t x1 = (int32_t)fmin(c->width, p->at.x + p->reach);
    int32_t y1 = (int32_t)fmin(c->height, p->at.y + p->reach);
    for (int32_t y = y0; y < y1; y += 2)
        for (int32_t x = x0; x < x1; x += 2)
            if (spots[(int64_t)y * c->width + x].thing && chip_edge(p, x, y) > -gap)
                return false;
    double f = 1 / (4 + 4 * k->rough);
    for (int32_t y = y0; y < y1; y++)
        for (int32_t x = x0; x < x1; x++) {
            double w =
                k->rough * (double)tz_canvas_fbm(k->seed + 4, x * f, y * f, 3, 0.6);
            double edge = chip_edge(p, x + 0.5 + w, y + 0.5 - w);
            if (edge > 0)
                spots[(int64_t)y * c->width + x] =
                    (mosaic_spot){.thing = thing, .edge = (float)edge};
        }
    return true;
}

/* Sizes fall from the largest to an eighth, as sieved stone has them. */
static int32_t drop_chips(tz_canvas *c, mosaic *k, mosaic_spot *spots, int32_t most)
{
    tz_rng r = tz_rng_make(k->seed, 7);
    double largest = 0.9 * k->wide, least = fmax(largest / 8, 9);
    double area = (double)c->width * c->height, cover = tz_rng_range(&r, 0.3, 1.6);
    double power = tz_rng_range(&r, 0.8, 2.5);
    int32_t tries = (int32_t)fmin(most, 2 * cover * area / (largest * least));
    int32_t n = 0;
    for (int32_t i = 0; i < tries; i++) {
        chip p;
        double t = (i + 0.5) / tries;
        draw_chip(&r, c, largest * pow(least / largest, pow(t, 1 / power)), &p);
        if (drop_chip(c, k, &p, 1 + n, spots))
            n++;
    }
    return n;
}

/* ---- paint ------------------------------------------------------------------------- */

/* Drawn when a piece is first met. */
static const tz_canvas_skin *skin_of(const mosaic *k, tz_shape_things *t, int32_t i)
{
    tz_shape_thing *v = &t->v[i];
    if (v->skin.seed != 0)
        return &v->skin;
    tz_rng r = tz_rng_make(k->seed, tz_rng_stream(2, (uint64_t)i, 0));
    int family = k->chequered                     ? i & 1
                 : tz_shape_chance(&r, k->motley) ? tz_rng_below(&r, FAMILIES)
                                                  : 0;
    float colour[3];
    tz_canvas_colour(&r, i ? k->family[family] : k->grout, i ? k->spread : 0,
                     i ? k->spread : 0, colour);
    tz_canvas_skin_draw(&r, colour, i ? k->wide : 12, i ? k->loud : 0.5, &v->skin);
    v->skin.bump *= (float)k->bump;
    v->element = i > 0, v->depth = i > 0;
    return &v->skin;
}

static void paint(tz_canvas *c, const mosaic *k, const tz_canvas_skin *skin,
                  const mosaic_spot *p, int64_t i)
{
    bool joint = c->segment[i] == 0;
    c->relief[i] = 0;
    if (!joint) {
        double e = fmin((double)p->edge / k->bevel, 1);
        double sx = tz_shape_unit(k->seed + 8, p->thing, 0) - 0.5;
        double sy = tz_shape_unit(k->seed + 8, p->thing, 1) - 0.5;
        double lift = k->lift * tz_shape_unit(k->seed + 8, p->thing, 2);
        c->relief[i] =
            (float)(k->sink + lift + k->tilt * ((double)p->dx * sx + (double)p->dy * sy) +
                    0.5 * k->bevel * sqrt(e * (2 - e)));
    }
    tz_canvas_skin_at(c, skin, (int32_t)(i % c->width), (int32_t)(i / c->width));
    if (!joint && k->kind != CHIPS)
        tz_shape_joint(c, i, (double)p->edge, (double)p->half, k->grout, 0.95);
}

tz_status tz_scene_MOSAIC(tz_canvas *c)
{
    mosaic k = {0};
    tz_shape_things t = {0};
    mosaic_spot *chips = NULL;
    int64_t n = (int64_t)c->width * c->height;
    draw_parameters(c, &k);
    tz_status s = build(c, &k);
    int32_t things = thing_count(&k);
    if (s == TZ_OK && k.kind == CHIPS) {
        s = tz_alloc_zero(c->ctx, &chips, (size_t)n, sizeof *chips);
        if (s == TZ_OK)
            things = 1 + drop_chips(c, &k, chips, (int32_t)(n / 60));
    }
    if (s == TZ_OK)
        s = tz_shape_things_init(c, things, &t);
    for (int64_t i = 0; i < n && s == TZ_OK; i++) {
        mosaic_spot p =
            chips ? chips[i]
                  : locate(&k, (int32_t)(i % c->width), (int32_t)(i / c->width));
        /* a joint, or beyond a tile that is turned or small; narrow ones become lines */
        const bool joint = (p.half >= 4 && p.edge < p.half) || p.edge <= 0;
        c->segment[i] = joint && (k.kind == SQUARES || p.half >= 4) ? 0 : p.thing;
        assert(c->segment[i] >= 0 && c->segment[i] < things);
        paint(c, &k, skin_of(&k, &t, c->segment[i]), &p, i);
    }
    if (s == TZ_OK) {
        tz_shape_things_count(c, &t);
        s = tz_shape_things_commit(c, &t);
    }
    tz_shape_things_deinit(c, &t);
    tz_free(c->ctx, chips);
    tz_shape_cells_deinit(c, &k.cells);
    tz_shape_bend_deinit(c, &k.bend);
    return s;
}
