/* SPDX-License-Identifier: Apache-2.0 */
/* Layers of rock, seen from the side: borders that wave, rise and pinch out, joints that
 * break each layer into blocks, a fault now and then. From massive sandstone to slates
 * stacked like a dry wall:
 *
 *   layer k lies between y_k(x) and y_{k+1}(x), tabulated along the pattern's x;
 *   a block of it between two joints, sorted along x;
 *   a gap opens where the distance to the border is below a half width that wanders. */
#include "scenes/shapes.h"

enum { TABLE_STEP = 2 };

typedef struct strata {
    tz_shape_bend bend;
    tz_shape_cells stones; /* of layers of rubble */
    tz_shape_field swell, worn, split;
    uint64_t seed;
    int32_t layers, nodes; /* y: (layers + 1) rows of nodes */
    float *y;
    int32_t *first; /* first joint of each layer; layers + 1 */
    TZ_ARRAY(float)
    joint;
    double thick, rough, rough_size, pinch;
    double joint_gap;  /* mean way between two joints, in thicknesses; 0 = none */
    double slant;      /* of joints */
    double half, open; /* of gaps: half width at its most, and how often it is there */
    double round, ledge, laminate;
    double spread_layer, spread_block, contact;
    double rubble, face, face_size, cracks, joint_share, loud;
    bool fault, soil;
    double fault_x, fault_slope, fault_shift;
    float family[3][3], gap[3];
} strata;

static void draw_parameters(tz_canvas *c, strata *k)
{
    tz_rng *r = &c->rng;
    k->seed = tz_rng_u64(r);
    k->thick = tz_shape_log_range(r, 16, 150);
    k->rough = tz_shape_log_range(r, 0.5, 6) * sqrt(k->thick / 40);
    k->rough_size = tz_shape_log_range(r, 15, 90);
    k->pinch = tz_shape_chance(r, 0.6) ? tz_rng_range(r, 0.1, 1.1) : 0.05;
    k->joint_gap = tz_shape_chance(r, 0.8) ? tz_shape_log_range(r, 0.9, 7) : 0;
    k->slant = 0.25 * tz_rng_normal(r);
    k->half = tz_shape_chance(r, 0.4) ? tz_shape_log_range(r, 4, 22)
                                      : tz_shape_log_range(r, 0.8, 5);
    k->half = fmin(k->half, 0.35 * k->thick);
    k->open = tz_rng_range(r, -0.7, 0.5);
    k->round = tz_shape_log_range(r, 1.5, 0.3 * k->thick + 3);
    k->ledge = tz_shape_log_range(r, 0.5, 14);
    k->laminate = tz_shape_chance(r, 0.6) ? tz_rng_range(r, 0.1, 0.6) : 0;
    k->spread_layer = tz_shape_log_range(r, 0.08, 0.7);
    k->spread_block = tz_shape_log_range(r, 0.03, 0.4);
    k->contact = tz_rng_range(r, 0.35, 0.95);
    k->fault = tz_shape_chance(r, 0.2);
    k->fault_x = tz_rng_range(r, -0.3, 0.3) * c->width;
    k->fault_slope = 0.5 * tz_rng_normal(r);
    k->fault_shift =
        (tz_shape_chance(r, 0.5) ? 1 : -1) * k->thick * tz_rng_range(r, 0.3, 2);
    k->soil = tz_shape_chance(r, 0.3);
    k->rubble = tz_shape_chance(r, 0.4) ? tz_rng_range(r, 0.05, 0.5) : 0;
    k->face = tz_shape_log_range(r, 0.4, 7);
    k->face_size = tz_shape_log_range(r, 10, 50);
    k->cracks = tz_shape_chance(r, 0.5) ? tz_rng_range(r, 0.1, 0.5) : 3;
    k->loud = tz_rng_range(r, 0.15, 0.9);
    k->joint_share = tz_rng_range(r, 0.3, 1.1);
    tz_canvas_base_colour(r, k->family[0]);
    for (int i = 1; i < 3; i++)
        if (tz_shape_chance(r, 0.15))
            tz_canvas_base_colour(r, k->family[i]);
        else
            tz_canvas_colour(r, k->family[0], 0.5, 0.3, k->family[i]);
    static const float dark[3] = {0.03f, 0.027f, 0.024f},
                       moss[3] = {0.09f, 0.10f, 0.025f};
    if (k->soil && tz_shape_chance(r, 0.5))
        tz_canvas_base_colour(r, k->gap);
    else
        tz_canvas_colour(r, k->soil ? moss : dark, 0.5, 0.4, k->gap);
}

static tz_status draw_bend(tz_canvas *c, strata *k)
{
    tz_rng *r = &c->rng;
    tz_shape_bend_def d =
        tz_shape_bend_draw(r, tz_shape_chance(r, 0.25) ? 0.9 : 0.08, k->thick);
    if (tz_shape_chance(r, 0.25)) { /* folds */
        d.warp_size = c->width * tz_rng_range(r, 0.3, 1.1);
        d.warp = d.warp_size * tz_rng_range(r, 0.1, 0.32);
        d.octaves = 3;
    }
    tz_status s = tz_shape_bend_init(c, k->seed + 1, &d, &k->bend);
    tz_rect box = k->bend.box;
    int32_t grow = (int32_t)fabs(k->fault_shift) + 40;
    box = (tz_rect){box.x - 40, box.y - grow, box.w + 80, box.h + 2 * grow};
    double pitch = fmax(14, k->thick * tz_rng_range(r, 0.25, 0.6));
    tz_shape_cells_def stones = {.pitch_x = 1.4 * pitch,
                                 .pitch_y = pitch,
                                 .jitter = 1,
                                 .join_x = 0.25,
                                 .join_y = 0.1,
                                 .join_most = 4};
    if (s == TZ_OK)
        s = tz_shape_cells_init(c, k->seed + 11, box, &stones, &k->stones);
    if (s == TZ_OK)
        s = tz_shape_field_init(c, k->seed + 6, 1.5 * k->thick, 3, &k->swell);
    if (s == TZ_OK)
        s = tz_shape_field_init(c, k->seed + 10, 70, 2, &k->worn);
    if (s == TZ_OK)
        s = tz_shape_field_init(c, k->seed + 12, 90, 2, &k->split);
    return s;
}

/* Thickness of a layer goes along x by noise and may fall to nothing. */
static tz_status build_layers(tz_canvas *c, strata *k)
{
    const tz_rect box = k->bend.box;
    k->nodes = box.w / TABLE_STEP + 2;
    k->layers = (int32_t)(3.5 * box.h / k->thick) + 8;
    tz_status s =
        tz_alloc(c->ctx, &k->y, (size_t)(k->layers + 1) * (size_t)k->nodes, sizeof *k->y);
    if (s != TZ_OK)
        return s;
    double margin = 2 * fabs(k->fault_shift) + 4 * k->rough;
    for (int32_t i = 0; i < k->nodes; i++)
        k->y[i] = (float)(box.y - margin);
    for (int32_t j = 0; j < k->layers; j++) {
        tz_rng r = tz_rng_make(k->seed, tz_rng_stream(1, (uint64_t)j, 0));
        double mean = k->thick * exp(0.55 * tz_rng_normal(&r)), wave = 5 * mean + 60;
        double fine = k->rough * exp(0.5 * tz_rng_normal(&r));
        for (int32_t i = 0; i < k->nodes; i++) {
            double x = box.x + i * TABLE_STEP;
            double t = mean * (1 + k->pinch * (double)tz_canvas_fbm(k->seed + 2, x / wave,
                                                                    7.3 * j, 2, 0.5));
            t += fine *
                 (double)tz_canvas_fbm(k->seed + 3, x / k->rough_size, 3.1 * j, 4, 0.65);
            k->y[(int64_t)(j + 1) * k->nodes + i] =
                k->y[(int64_t)j * k->nodes + i] + (float)fmax(t, 0);
        }
    }
    return TZ_OK;
}

static tz_status build_joints(tz_canvas *c, strata *k)
{
    tz_status s = tz_alloc(c->ctx, &k->first, (size_t)k->layers + 1, sizeof *k->first);
    double from = k->bend.box.x - 4 * k->thick, to = k->bend.box.x + k->bend.box.w;
    for (int32_t j = 0; j < k->layers && s == TZ_OK; j++) {
        tz_rng r = tz_rng_make(k->seed, tz_rng_stream(2, (uint64_t)j, 0));
        k->first[j] = k->joint.n;
        double own = k->joint_gap * k->thick * exp(0.4 * tz_rng_normal(&r));
        if (k->joint_gap == 0 || tz_shape_chance(&r, 0.12))
            own = 1e6;
        for (double x = from + own * tz_rng_unit(&r); x < to && s == TZ_OK;) {
            s = tz_array_push(c->ctx, &k->joint, (float)x);
            x += fmax(24, own * exp(0.6 * tz_rng_normal(&r)));
        }
    }
    if (s == TZ_OK)
        k->first[k->layers] = k->joint.n;
    return s;
}

/* Border j at node i + t, and how steep it is there. */
static double border(const strata *k, int32_t j, int32_t i, double t, double *slope)
{
    const float *y = k->y + (int64_t)j * k->nodes + i;
    *slope = (double)(y[1] - y[0]) / TABLE_STEP;
    return (double)y[0] + t * (double)(y[1] - y[0]);
}

/* The layer at y. Where one is thinner than 7 px it would be a line: its neighbours
 * share it, and meet in its middle. */
static int32_t layer_at(const strata *k, int32_t i, double t, double y)
{
    double slope;
    int32_t lo = 0, hi = k->layers;
    while (hi - lo > 1) {
        int32_t mid = (lo + hi) / 2;
        if (border(k, mid, i, t, &slope) <= y)
            lo = mid;
        else
            hi = mid;
    }
    double top = border(k, lo, i, t, &slope), low = border(k, lo + 1, i, t, &slope);
    int way = 2 * y < top + low ? -1 : 1;
    while (low - top < 7 && lo + way >= 0 && lo + way < k->layers) {
        lo += way;
        top = border(k, lo, i, t, &slope), low = border(k, lo + 1, i, t, &slope);
    }
    return lo;
}

typedef struct spot {
    int32_t layer, block, thing;
    double x, y, top, low, joint, edge; /* px to the border above, below, beside, any */
    double half;                        /* of the gap */
} spot;

static void locate(const strata *k, double x, double y, spot *p)
{
    int side = 0;
    double fault = 1e9;
    if (k->fault) {
        fault = x - k->fault_x - k->fault_slope * y +
                6 * (double)tz_canvas_fbm(k->seed + 4, x / 40, y / 40, 3, 0.6);
        fault /= sqrt(1 + k->fault_slope * k->fault_slope);
        side = fault > 0;
        y += side ? k->fault_shift : 0;
    }
    double fx = (x - k->bend.box.x) / TABLE_STEP;
    int32_t i = fx < 0 ? 0 : fx > k->nodes - 2 ? k->nodes - 2 : (int32_t)fx;
    double t = fx - i, slope, slope2;
    int32_t lo = layer_at(k, i, t, y);
    double top = border(k, lo, i, t, &slope), low = border(k, lo + 1, i, t, &slope2);
    p->top = fabs(y - top) / sqrt(1 + slope * slope);
    p->low = fabs(low - y) / sqrt(1 + slope2 * slope2);
    double jx = x + k->slant * (y - top) +
                5 * (double)tz_canvas_fbm(k->seed + 5, x / 25, y / 25, 2, 0.6);
    int32_t a = k->first[lo] - 1, b = k->first[lo + 1]; /* joint a <= jx < joint b */
    double left = 1e9, right = 1e9;
    while (b - a > 1) {
        int32_t mid = (a + b) / 2;
        if ((double)k->joint.v[mid] <= jx)
            a = mid;
        else
            b = mid;
    }
    if (a >= k->first[lo])
        left = jx - (double)k->joint.v[a];
    if (b < k->first[lo + 1])
        right = (double)k->joint.v[b] - jx;
    p->layer = lo;
    p->block = a + 1 + lo; /* layers have one block more than joints */
    p->thing = 1 + 2 * p->block + side;
    p->x = x, p->y = y;
    p->joint = fmin(left, right);
    if (tz_shape_unit(k->seed + 13, lo, 0) < k->rubble) {
        tz_shape_cell hit =
            tz_shape_cells_at(&k->stones, x + 0.4 * (jx - x), y + 0.4 * (jx - x));
        p->thing = 1 + 2 * (k->joint.n + k->layers + 1) + hit.root;
        p->joint = hit.edge;
    }
    p->edge = fmin(fmin(p->top, p->low), fmin(p->joint, fabs(fault)));
}

/* Half width of the gap here: between a hair and the most, in stretches; joints across
 * are narrower than what lies between layers. */
static double gap_half(const strata *k, const spot *p, int32_t x, int32_t y)
{
    double n = tz_shape_field_at(&k->swell, x, y);
    double most = k->half * (p->joint <= p->edge ? k->joint_share : 1);
    return 0.6 + most * tz_shape_ramp(-0.6, 0.7, n + k->open);
}

/* Drawn when a thing is first met; blocks of a layer are much alike. */
static const tz_canvas_skin *skin_of(const strata *k, tz_shape_things *t, int32_t id,
                                     int32_t layer)
{
    tz_shape_thing *v = &t->v[id];
    if (v->skin.seed != 0)
        return &v->skin;
    tz_rng r = tz_rng_make(k->seed, tz_rng_stream(4, (uint64_t)layer, 0));
    float bed[3], colour[3];
    tz_canvas_colour(&r, k->family[tz_rng_below(&r, 3)], k->spread_layer,
                     0.6 * k->spread_layer, bed);
    double loud = k->loud * tz_rng_range(&r, 0.5, 1.3);
    tz_rng own = tz_rng_make(k->seed, tz_rng_stream(5, (uint64_t)id, 0));
    if (id == 0) {
        tz_canvas_skin_draw(&own, k->gap, 20, k->soil ? 0.9 : 0.4, &v->skin);
        return &v->skin;
    }
    tz_canvas_colour(&own, bed, k->spread_block, 0.7 * k->spread_block, colour);
    tz_canvas_skin_draw(&own, colour, k->thick, loud, &v->skin);
    return &v->skin;
}

/* Layers and blocks stand out by different heights; their borders are rounded, the lower
 * one less: rain wears the upper. */
static double height_of(const strata *k, const spot *p)
{
    double out = k->ledge * (tz_shape_unit(k->seed + 7, p->layer, 0) * 1.4 +
                             0.6 * tz_shape_unit(k->seed + 8, p->thing, 0));
    double e = fmin(p->edge / k->round, 1), top = fmin(p->top / (2 * k->round), 1);
    return out + 0.5 * k->round * (sqrt(e * (2 - e)) + 0.5 * sqrt(top * (2 - top)));
}

/* Relief and tone of the broken face of a block, and what is thin in it. */
static void paint_face(tz_canvas *c, const strata *k, const spot *p, int64_t i)
{
    int32_t x = (int32_t)(i % c->width), y = (int32_t)(i / c->width);
    double f = 1 / k->face_size;
    double face = (double)tz_canvas_fbm(k->seed + 14 + (uint64_t)p->thing, p->x * 0.7 * f,
                                        p->y * 1.3 * f, 4, 0.55);
    c->relief[i] += (float)(k->face * face);
    double tone = 1 + 0.05 * k->face * face;
    if (k->laminate > 0) {
        double n = (double)tz_canvas_fbm(k->seed + 9 + (uint64_t)p->layer, p->x / 90,
                                         p->y / (3 + 0.08 * k->thick), 3, 0.7);
        tone *= 1 + k->laminate * n;
        c->relief[i] += (float)(0.15 * k->round * k->laminate * n);
    }
    tz_shape_dim(c, i, tone);
    if (k->cracks < 1 && p->edge > 5) {
        double open = 1.6 * (tz_shape_field_at(&k->split, x, y) - k->cracks);
        tz_vec2 q = {p->x, p->y}, wave = {0.7 * k->thick + 20, 0.9 * k->thick + 30};
        tz_shape_crack(c, i, k->seed + 15, q, wave, fmin(open, 1), k->gap);
    }
}

static void paint(tz_canvas *c, const strata *k, tz_shape_things *t, const spot *p,
                  int64_t i)
{
    int32_t x = (int32_t)(i % c->width), y = (int32_t)(i / c->width), id = c->segment[i];
    c->relief[i] = (float)(id == 0 ? -fmin(p->half, 8) : height_of(k, p));
    tz_canvas_skin_at(c, skin_of(k, t, id, p->layer), x, y);
    if (id == 0) {
        if (!k->soil)
            tz_shape_dim(c, i, 0.5 + 0.25 * p->edge / p->half);
        return;
    }
    paint_face(c, k, p, i);
    double share =
        k->contact * tz_shape_ramp(-1.1, 0.2, tz_shape_field_at(&k->worn, x, y));
    tz_shape_joint(c, i, p->edge, p->half, k->gap, share);
    if (p->edge < 5 * (2 + p->half))
        tz_shape_dim(c, i, 1 - 0.35 * share * exp(-p->edge / (2 + p->half)));
}

static tz_status paint_all(tz_canvas *c, strata *k)
{
    tz_shape_things t = {0};
    int32_t blocks = k->joint.n + k->layers + 1;
    tz_status s =
        tz_shape_things_init(c, 1 + 2 * blocks + k->stones.cols * k->stones.rows, &t);
    if (s != TZ_OK)
        return s;
    t.v[0].element = false, t.v[0].depth = 0;
    for (int64_t i = 0, n = (int64_t)c->width * c->height; i < n; i++) {
        int32_t x = (int32_t)(i % c->width), y = (int32_t)(i / c->width);
        tz_vec2 q = tz_shape_bend_at(&k->bend, x + 0.5, y + 0.5);
        spot p;
        locate(k, q.x, q.y, &p);
        p.half = gap_half(k, &p, x, y);
        c->segment[i] = p.half >= 4 && p.edge < p.half ? 0 : p.thing;
        paint(c, k, &t, &p, i);
    }
    tz_shape_things_count(c, &t);
    s = tz_shape_things_commit(c, &t);
    tz_shape_things_deinit(c, &t);
    return s;
}

tz_status tz_scene_STRATA(tz_canvas *c)
{
    strata k = {0};
    draw_parameters(c, &k);
    tz_status s = draw_bend(c, &k);
    if (s == TZ_OK)
        s = build_layers(c, &k);
    if (s == TZ_OK)
        s = build_joints(c, &k);
    if (s == TZ_OK)
        s = paint_all(c, &k);
    tz_array_free(c->ctx, &k.joint);
    tz_free(c->ctx, k.first);
    tz_free(c->ctx, k.y);
    tz_shape_field_deinit(c, &k.split);
    tz_shape_field_deinit(c, &k.worn);
    tz_shape_field_deinit(c, &k.swell);
    tz_shape_cells_deinit(c, &k.stones);
    tz_shape_bend_deinit(c, &k.bend);
    return s;
}
