/* SPDX-License-Identifier: Apache-2.0 */
/* Bark, the trunk along the pattern's y:
 *
 *   furrowed   long plates that bulge between furrows, grain along them   (oak, poplar)
 *   scaly      plates little longer than wide, flaking in steps           (pine, plane)
 *   smooth     one skin with lenticels and scars across                   (birch, cherry)
 *
 * Over any of them lie lichens with a border of their own, and a breath of moss that has
 * none. */
#include "scenes/shapes.h"

typedef struct bark {
    tz_shape_bend bend;
    tz_shape_cells cells;
    tz_shape_field broad, mossy;
    uint64_t seed;
    bool smooth;
    double wide, tall;               /* plate */
    double warp, rough, half, close; /* furrows: half width at most, share that is shut */
    double depth, bulge, grain, grain_size, flake, face, cross, rough_skin, spread;
    double cracks;
    double lichen, lichen_size, moss, dark;
    double mark_x, mark_y, mark_share; /* lenticels: cell of one, chance of one */
    double mark_size, mark_ratio;
    float base[3], furrow[3], lichen_colour[3], moss_colour[3];
} bark;

/* things: 0 furrow, 1 lichen, then plates; on smooth bark 2 is the skin, then marks */
enum { FURROW, LICHEN, PLATE };

static void draw_colours(tz_rng *r, bark *k)
{
    static const float wood[][3] = {{0.13f, 0.10f, 0.075f}, {0.24f, 0.21f, 0.18f},
                                    {0.30f, 0.29f, 0.27f},  {0.20f, 0.11f, 0.06f},
                                    {0.30f, 0.17f, 0.10f},  {0.10f, 0.09f, 0.05f}};
    static const float pale[][3] = {{0.58f, 0.56f, 0.52f},
                                    {0.30f, 0.28f, 0.25f},
                                    {0.22f, 0.10f, 0.07f},
                                    {0.33f, 0.33f, 0.24f}};
    static const float growth[][3] = {{0.40f, 0.42f, 0.10f},
                                      {0.45f, 0.47f, 0.42f},
                                      {0.55f, 0.36f, 0.06f},
                                      {0.28f, 0.35f, 0.24f},
                                      {0.12f, 0.17f, 0.03f}};
    static const float green[3] = {0.14f, 0.17f, 0.03f};
    tz_canvas_colour(r, k->smooth ? pale[tz_rng_below(r, 4)] : wood[tz_rng_below(r, 6)],
                     0.5, 0.3, k->base);
    k->dark = tz_rng_range(r, 0.1, 0.55);
    for (int i = 0; i < 3; i++)
        k->furrow[i] = k->base[i] * (float)k->dark;
    tz_canvas_colour(r, growth[tz_rng_below(r, 5)], 0.3, 0.3, k->lichen_colour);
    tz_canvas_colour(r, green, 0.4, 0.3, k->moss_colour);
    tz_shape_part(k->lichen_colour, k->base, 0.45);
}

static void draw_parameters(tz_canvas *c, bark *k)
{
    tz_rng *r = &c->rng;
    k->seed = tz_rng_u64(r);
    double kind = tz_rng_unit(r);
    k->smooth = kind > 0.87;
    bool scaly = kind > 0.5 && !k->smooth;
    k->wide = scaly ? tz_shape_log_range(r, 36, 170) : tz_shape_log_range(r, 22, 110);
    k->tall = k->wide *
              (scaly ? tz_shape_log_range(r, 0.9, 2.4) : tz_shape_log_range(r, 2.5, 8));
    k->warp = k->wide * tz_rng_range(r, 0.15, 0.55);
    k->rough = tz_rng_range(r, 1, 3.5);
    k->half =
        k->wide * (scaly ? tz_rng_range(r, 0.03, 0.12) : tz_rng_range(r, 0.05, 0.3));
    k->close = tz_rng_range(r, scaly ? 0.1 : -0.2, 0.7);
    k->depth = tz_shape_log_range(r, 2, 0.25 * k->wide + 3);
    k->bulge = k->wide * tz_rng_range(r, 0.02, 0.22);
    k->grain = tz_rng_range(r, 0.15, 0.8);
    k->grain_size = tz_shape_log_range(r, 2.5, 9);
    k->face = tz_shape_log_range(r, 0.4, 0.1 * k->wide + 1);
    k->cross = tz_shape_chance(r, 0.4) ? tz_rng_range(r, 0.2, 1) : 0;
    k->rough_skin = tz_rng_range(r, 0.2, 0.8);
    k->spread = tz_rng_range(r, 0.03, 0.3);
    k->cracks = tz_shape_chance(r, 0.35) ? tz_rng_range(r, 0.1, 0.5) : 3;
    k->flake = scaly || tz_shape_chance(r, 0.2) ? tz_rng_range(r, 0.2, 1) : 0;
    k->lichen = tz_shape_chance(r, 0.45) ? tz_rng_range(r, 0.25, 0.6) : 2;
    k->lichen_size = tz_shape_log_range(r, 40, 160);
    k->moss = tz_shape_chance(r, 0.5) ? tz_rng_range(r, 0.2, 0.8) : 0;
    k->mark_x = tz_shape_log_range(r, 60, 240);
    k->mark_ratio = tz_shape_log_range(r, 0.12, 0.5);
    k->mark_size = tz_rng_range(r, 0.12, 0.45);
    k->mark_y = k->mark_x * k->mark_ratio * tz_rng_range(r, 0.5, 2) + 12;
    k->mark_share = tz_rng_range(r, 0.2, 0.9);
    draw_colours(r, k);
}

/* Sideways noise whose patterns are longer than wide, so that plates snake along the
 * trunk: its coarse octaves, taken once at the nodes of the bent plane. */
static void warp_nodes(bark *k)
{
    double w = 1.6 * k->wide;
    for (int32_t i = 0; i < k->bend.cols * k->bend.rows; i++) {
        float *q = k->bend.node + 2 * (int64_t)i;
        double x = (double)q[0], y = (double)q[1];
        double side = (double)tz_canvas_fbm(k->seed + 5, x / w, y / (2.2 * w), 2, 0.6);
        double up = (double)tz_canvas_noise(k->seed + 7, x / (0.5 * w), y / w);
        q[0] += (float)(0.8 * k->warp * side);
        q[1] += (float)(0.35 * k->warp * up);
    }
}

static tz_status build(tz_canvas *c, bark *k)
{
    tz_rng *r = &c->rng;
    tz_shape_bend_def bend =
        tz_shape_bend_draw(r, tz_shape_chance(r, 0.15) ? 1.2 : 0.1, k->wide);
    tz_shape_cells_def def = {.pitch_x = k->wide,
                              .pitch_y = k->tall,
                              .jitter = 0.95,
                              .hex = true,
                              .join_x = tz_rng_range(r, 0, 0.25),
                              .join_y = tz_rng_range(r, 0.1, 0.5),
                              .join_most = 4};
    tz_status s = tz_shape_bend_init(c, k->seed + 1, &bend, &k->bend);
    tz_rect box = k->bend.box;
    int32_t grow = (int32_t)(2 * k->warp) + 20;
    box = (tz_rect){box.x - grow, box.y - 3 * grow, box.w + 2 * grow, box.h + 6 * grow};
    if (s == TZ_OK && !k->smooth)
        warp_nodes(k);
    if (s == TZ_OK)
        s = tz_shape_cells_init(c, k->seed + 2, box, &def, &k->cells);
    if (s == TZ_OK)
        s = tz_shape_field_init(c, k->seed + 3, k->wide + 30, 3, &k->broad);
    if (s == TZ_OK)
        s = tz_shape_field_init(c, k->seed + 4, 0.4 * c->width, 4, &k->mossy);
    return s;
}

/* The fine octaves, which fray the borders of plates. */
static tz_vec2 warp_at(const bark *k, tz_vec2 q)
{
    double w = 0.4 * k->wide, f = 7;
    double side = (double)tz_canvas_fbm(k->seed + 20, q.x / w, q.y / (1.8 * w), 2, 0.6);
    double fine = (double)tz_canvas_fbm(k->seed + 6, q.x / f, q.y / (2 * f), 2, 0.7);
    return (tz_vec2){q.x + 0.35 * k->warp * side + k->rough * fine,
                     q.y + 0.15 * k->warp * side + k->rough * fine};
}

typedef struct spot {
    tz_vec2 q; /* warped */
    double edge, half;
    int32_t plate;
} spot;

static spot locate(const bark *k, int32_t x, int32_t y)
{
    tz_vec2 q = tz_shape_bend_at(&k->bend, x + 0.5, y + 0.5), w = warp_at(k, q);
    tz_shape_cell hit = tz_shape_cells_at(&k->cells, w.x, w.y);
    int32_t lo = hit.root < hit.other ? hit.root : hit.other;
    int32_t hi = hit.root < hit.other ? hit.other : hit.root;
    double pair = tz_shape_unit(k->seed + 8, lo, hi);
    double wide = tz_shape_ramp(
        -0.9, 0.9, tz_shape_field_at(&k->broad, x, y) + 1.6 * pair - 0.8 - k->close);
    return (spot){w, hit.edge, 0.7 + k->half * wide, hit.root};
}

static bool lichen_here(const bark *k, int32_t x, int32_t y)
{
    if (k->lichen > 1)
        return false;
    return (double)tz_canvas_fbm(k->seed + 9, x / k->lichen_size, y / k->lichen_size, 4,
                                 0.6) > k->lichen;
}

static void paint_plate(tz_canvas *c, const bark *k, const spot *p, int64_t i)
{
    double e = fmin(p->edge / (0.35 * k->wide), 1);
    double bulge = k->bulge * sqrt(e * (2 - e));
    double out = 0.4 * k->depth * tz_shape_unit(k->seed + 10, p->plate, 0);
    double g = (double)tz_canvas_fbm(k->seed + 11, p->q.x / k->grain_size,
                                     p->q.y / (6 * k->grain_size), 3, 0.7);
    double wf = 0.4 * k->wide;
    double face =
        (double)tz_canvas_fbm(k->seed + 18, p->q.x / wf, p->q.y / (1.6 * wf), 3, 0.6);
    double cross = 0, crack = 0, step = 0;
    if (k->cross > 0 || k->flake > 0)
        cross = (double)tz_canvas_fbm(k->seed + 12, p->q.x / 30, p->q.y / 6, 2, 0.6);
    if (k->cross > 0)
        crack = k->cross * (1 - tz_shape_ramp(0.02, 0.09, fabs(cross + 0.25)));
    if (k->flake > 0) { /* terraces: old bark has come off in sheets */
        double t = (p->edge + 10 * cross) / (0.12 * k->wide);
        step = floor(t) + tz_shape_ramp(0.6, 1, t - floor(t));
        step = k->flake * fmin(step, 4);
    }
    c->relief[i] += (float)(k->depth + out + bulge + 0.3 * k->depth * k->grain * g -
                            1.5 * k->grain * crack + 0.8 * step + k->face * face);
    tz_shape_dim(c, i,
                 (1 + k->grain * g) * (1 - 0.3 * k->grain * crack) * (1 + 0.2 * face) *
                     (1 + 0.06 * step * (tz_shape_unit(k->seed, p->plate, 3) - 0.3)));
    if (k->cracks < 1 && p->edge > 5) {
        int32_t x = (int32_t)(i % c->width), y = (int32_t)(i / c->width);
        double open = 1.6 * (tz_shape_field_at(&k->broad, x, y) - k->cracks);
        tz_vec2 wave = {0.6 * k->wide, 1.1 * k->wide + 10};
        tz_shape_crack(c, i, k->seed + 19, p->q, wave, fmin(open, 1), k->furrow);
    }
    tz_shape_joint(c, i, p->edge, p->half, k->furrow, 0.9);
    if (p->edge < 5 * (2 + p->half))
        tz_shape_dim(c, i, 1 - 0.4 * (1 - k->dark) * exp(-p->edge / (2 + p->half)));
}

static void paint_furrow(tz_canvas *c, const bark *k, const spot *p, int64_t i)
{
    double in = 1 - p->edge / p->half; /* 1 in its middle */
    double g = (double)tz_canvas_fbm(k->seed + 13, p->q.x / 5, p->q.y / 22, 2, 0.7);
    c->relief[i] += (float)(k->depth * (0.35 - 0.6 * in + 0.3 * g));
    tz_shape_dim(c, i, (1.15 - 0.5 * in) * (1 + 0.5 * g));
}

static void paint_growth(tz_canvas *c, const bark *k, int64_t i, bool lichen)
{
    int32_t x = (int32_t)(i % c->width), y = (int32_t)(i / c->width);
    if (k->moss > 0)
        tz_shape_tint(c, i, k->moss_colour,
                      k->moss *
                          tz_shape_ramp(-0.1, 0.9, tz_shape_field_at(&k->mossy, x, y)));
    if (lichen)
        c->relief[i] += 1.2f;
}

/* Drawn when a thing is first met. */
static const tz_canvas_skin *skin_of(const bark *k, tz_shape_things *t, int32_t id)
{
    tz_shape_thing *v = &t->v[id];
    if (v->skin.seed != 0)
        return &v->skin;
    tz_rng r = tz_rng_make(k->seed, tz_rng_stream(1, (uint64_t)id, 0));
    float colour[3];
    double spread = id < PLATE ? 0.1 : k->spread;
    tz_canvas_colour(&r,
                     id == FURROW   ? k->furrow
                     : id == LICHEN ? k->lichen_colour
                                    : k->base,
                     spread, spread, colour);
    tz_canvas_skin_draw(&r, colour, id == LICHEN ? 20 : k->wide, k->rough_skin, &v->skin);
    return &v->skin;
}

static tz_status paint_plates(tz_canvas *c, bark *k)
{
    tz_shape_things t = {0};
    tz_status s = tz_shape_things_init(c, PLATE + k->cells.cols * k->cells.rows, &t);
    if (s != TZ_OK)
        return s;
    t.v[FURROW].element = t.v[LICHEN].element = false;
    t.v[FURROW].depth = 0, t.v[LICHEN].depth = 2;
    for (int64_t i = 0, n = (int64_t)c->width * c->height; i < n; i++) {
        int32_t x = (int32_t)(i % c->width), y = (int32_t)(i / c->width);
        spot p = locate(k, x, y);
        bool gap = p.half >= 4 && p.edge < p.half;
        int32_t id = gap ? FURROW : lichen_here(k, x, y) ? LICHEN : PLATE + p.plate;
        c->segment[i] = id;
        c->relief[i] = 0;
        tz_canvas_skin_at(c, skin_of(k, &t, id), x, y);
        if (id == FURROW)
            paint_furrow(c, k, &p, i);
        else
            paint_plate(c, k, &p, i);
        paint_growth(c, k, i, id == LICHEN);
    }
    tz_shape_things_count(c, &t);
    s = tz_shape_things_commit(c, &t);
    tz_shape_things_deinit(c, &t);
    return s;
}

/* ---- smooth bark ----------------------------------------------------------------------
 *
 * A lenticel is a lens across the trunk, |v| < b (1 - (u / a)^2), one at most in each
 * cell of a lattice; lower than 8 px it is a line. */

typedef struct mark {
    int32_t cell; /* -1 none */
    double edge, u, b;
} mark;

static mark mark_at(const bark *k, tz_vec2 q, int32_t cols, tz_rect box)
{
    mark m = {.cell = -1};
    double f = (double)tz_canvas_fbm(k->seed + 14, q.x / 12, q.y / 9, 2, 0.6);
    int32_t i = (int32_t)((q.x - box.x) / k->mark_x),
            j = (int32_t)((q.y - box.y) / k->mark_y);
    int32_t cell = j * cols + i;
    if (tz_shape_unit(k->seed + 15, cell, 0) > k->mark_share)
        return m;
    double size = k->mark_size * (0.3 + 0.8 * tz_shape_unit(k->seed + 15, cell, 1));
    double a = k->mark_x * size;
    double b = fmin(a * k->mark_ratio * (0.5 + tz_shape_unit(k->seed + 15, cell, 2)),
                    0.35 * k->mark_y);
    double free_x = 0.5 - size, free_y = 0.5 - b / k->mark_y;
    double cx = 0.5 + free_x * (2 * tz_shape_unit(k->seed + 15, cell, 3) - 1);
    double cy = 0.5 + free_y * (2 * tz_shape_unit(k->seed + 15, cell, 4) - 1);
    double u = (q.x - box.x - (i + cx) * k->mark_x) / a;
    double v = q.y - box.y - (j + cy) * k->mark_y;
    m.b = fmin(b, 20);
    m.u = v / m.b;
    m.edge = m.b * (1 - u * u) + 0.3 * m.b * f - fabs(v);
    if (u * u < 1 && m.edge > 0)
        m.cell = cell;
    return m;
}

static void paint_skin(tz_canvas *c, const bark *k, tz_vec2 q, const mark *m, int64_t i)
{
    double wrinkle = (double)tz_canvas_fbm(k->seed + 16, q.x / 60, q.y / 5, 3, 0.6);
    double scar = (double)tz_canvas_fbm(k->seed + 17, q.x / 12, q.y / 50, 3, 0.6);
    c->relief[i] += (float)(4 + 1.4 * k->grain * wrinkle);
    tz_shape_dim(c, i,
                 1 + 0.35 * k->grain * wrinkle + 0.25 * k->grain * fmax(scar - 0.3, 0));
    if (m->cell >= 0) {
        double share = tz_shape_ramp(0, 1.5, m->edge);
        tz_shape_tint(c, i, k->furrow, (0.65 + 0.3 * k->grain) * share);
        c->relief[i] += (float)(share * m->b * (0.3 * (1 - fabs(m->u)) - 0.15));
    }
}

static tz_status paint_smooth(tz_canvas *c, bark *k)
{
    tz_rect box = k->bend.box;
    int32_t cols = (int32_t)(box.w / k->mark_x) + 2;
    int32_t rows = (int32_t)(box.h / k->mark_y) + 2;
    tz_shape_things t = {0};
    tz_status s = tz_shape_things_init(c, PLATE + 1 + cols * rows, &t);
    if (s != TZ_OK)
        return s;
    tz_canvas_skin_draw(&c->rng, k->base, 150, tz_rng_range(&c->rng, 0.15, 0.6),
                        &t.v[PLATE].skin);
    tz_canvas_skin_draw(&c->rng, k->lichen_colour, 20, 0.5, &t.v[LICHEN].skin);
    t.v[PLATE].element = t.v[LICHEN].element = false;
    t.v[PLATE].depth = 0;
    for (int64_t i = 0, n = (int64_t)c->width * c->height; i < n; i++) {
        int32_t x = (int32_t)(i % c->width), y = (int32_t)(i / c->width);
        tz_vec2 q = tz_shape_bend_at(&k->bend, x + 0.5, y + 0.5);
        mark m = mark_at(k, q, cols, box);
        bool lichen = lichen_here(k, x, y);
        c->segment[i] = lichen                      ? LICHEN
                        : m.cell >= 0 && m.b >= 4.5 ? PLATE + 1 + m.cell
                                                    : PLATE;
        c->line[i] =
            !lichen && m.cell >= 0 && m.b < 4.5 && m.b > 2 && fabs(m.u * m.b) <= 0.5;
        c->relief[i] = 0;
        tz_canvas_skin_at(c, &t.v[lichen ? LICHEN : PLATE].skin, x, y);
        if (lichen)
            m.cell = -1;
        paint_skin(c, k, q, &m, i);
        paint_growth(c, k, i, lichen);
    }
    tz_shape_things_count(c, &t);
    s = tz_shape_things_commit(c, &t);
    tz_shape_things_deinit(c, &t);
    return s;
}

tz_status tz_scene_BARK(tz_canvas *c)
{
    bark k = {0};
    draw_parameters(c, &k);
    tz_status s = build(c, &k);
    if (s == TZ_OK)
        s = k.smooth ? paint_smooth(c, &k) : paint_plates(c, &k);
    tz_shape_field_deinit(c, &k.mossy);
    tz_shape_field_deinit(c, &k.broad);
    tz_shape_cells_deinit(c, &k.cells);
    tz_shape_bend_deinit(c, &k.bend);
    return s;
}
