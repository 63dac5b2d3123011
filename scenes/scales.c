/* SPDX-License-Identifier: Apache-2.0 */
/* Things in rows, each row over the next: scales of fish and snakes, tiles, shingles,
 * slates, cones. Row j hangs from y = j * pitch and is longer than the pitch; of all that
 * contain a point the one that hangs highest is seen. An outline is half a superellipse
 * on a strip,
 *
 *   (|x| / half)^q + s^p = 1,   s from 0 at the shoulder to 1 at the free end,
 *
 * round for p = q = 2, pointed for 1, square for much. Taken at each pixel in the bent
 * plane, so that rows may run in circles and wander. */
#include "scenes/shapes.h"

typedef struct scales {
    tz_shape_bend bend;
    uint64_t seed;
    double wide, pitch, length, shoulder; /* shoulder: share of the length */
    double p, q, jitter, jitter_end, rough, rough_size;
    bool stagger, random_stagger;
    double thick, dome, bevel, joint, dark, rings, ribs, grain, fade;
    int32_t first_row, first_col, cols, rows, above; /* above: rows that may cover one */
    float family[3][3], gap[3];
    double spread, family_share, loud;
    struct scale_own *own; /* rows * cols */
} scales;

/** What is drawn once a scale. */
typedef struct scale_own {
    float left, length, skew, order; /* left border, px */
} scale_own;

typedef struct scale_spot {
    int32_t thing; /* 0 = what lies under all */
    double x, t, half, edge;
} scale_spot;

static void draw_colours(tz_rng *r, scales *k)
{
    tz_canvas_base_colour(r, k->family[0]);
    for (int i = 1; i < 3; i++)
        if (tz_shape_chance(r, 0.25))
            tz_canvas_base_colour(r, k->family[i]);
        else
            tz_canvas_colour(r, k->family[0], 0.5, 0.4, k->family[i]);
    for (int i = 0; i < 3; i++)
        k->gap[i] = 0.15f * k->family[0][i];
    k->spread = tz_shape_log_range(r, 0.02, 0.5);
    k->family_share = tz_shape_chance(r, 0.5) ? 0 : tz_rng_unit(r);
}

static void draw_parameters(tz_canvas *c, scales *k)
{
    tz_rng *r = &c->rng;
    k->seed = tz_rng_u64(r);
    k->wide = tz_shape_log_range(r, 28, 190);
    k->pitch = k->wide * tz_shape_log_range(r, 0.4, 1.5);
    k->length = k->pitch * tz_rng_range(r, 1.3, 2.3);
    k->shoulder = tz_rng_range(r, 0.1, 0.75);
    double kind = tz_rng_unit(r);
    if (kind < 0.4) {
        k->p = tz_rng_range(r, 1.6, 2.6), k->q = tz_rng_range(r, 1.6, 2.6);
    } else if (kind < 0.6) {
        k->p = tz_rng_range(r, 0.9, 1.5), k->q = tz_rng_range(r, 0.9, 1.4);
    } else {
        k->p = tz_rng_range(r, 8, 30), k->q = 8;
        k->shoulder = 0.85;
    }
    bool square = kind >= 0.6;
    k->jitter = square && tz_shape_chance(r, 0.6) ? tz_rng_range(r, 0.2, 0.75)
                                                  : tz_rng_range(r, 0, 0.2);
    k->jitter_end = tz_shape_log_range(r, 0.005, 0.25);
    k->rough = tz_shape_log_range(r, 0.2, 3.5);
    k->rough_size = tz_shape_log_range(r, 6, 40);
    k->stagger = !square || tz_shape_chance(r, 0.9);
    k->random_stagger = square && tz_shape_chance(r, 0.5);
    k->thick = tz_shape_log_range(r, 1.5, 14);
    k->dome = tz_shape_chance(r, 0.5) ? k->wide * tz_shape_log_range(r, 0.01, 0.25) : 0;
    k->bevel = tz_shape_log_range(r, 0.8, 8);
    k->joint = tz_shape_log_range(r, 0.3, 3);
    k->dark = tz_rng_range(r, 0.2, 0.95);
    k->rings = tz_shape_chance(r, 0.25) ? tz_rng_range(r, 0.05, 0.35) : 0;
    k->ribs = tz_shape_chance(r, 0.25) ? tz_rng_range(r, 0.05, 0.4) : 0;
    k->grain = tz_shape_chance(r, 0.4) ? tz_rng_range(r, 0.1, 0.6) : 0;
    k->fade = tz_rng_range(r, -0.35, 0.45);
    k->loud = tz_rng_range(r, 0.1, 0.9);
    draw_colours(r, k);
}

static tz_status draw_bend(tz_canvas *c, scales *k)
{
    tz_rng *r = &c->rng;
    double spread = tz_shape_chance(r, 0.3) ? 3 : 0.08;
    tz_shape_bend_def d = tz_shape_bend_draw(r, spread, k->wide);
    if (tz_shape_chance(r, 0.2))
        d.radius = (c->width + c->height) * tz_rng_range(r, 0.75, 1.5);
    tz_status s = tz_shape_bend_init(c, k->seed + 1, &d, &k->bend);
    tz_rect box = k->bend.box;
    k->above = (int32_t)(k->length * (1 + k->jitter_end) / k->pitch) + 2;
    k->first_row = (int32_t)floor(box.y / k->pitch) - k->above - 1;
    k->first_col = (int32_t)floor(box.x / k->wide) - 4;
    k->rows = (int32_t)(box.h / k->pitch) + 2 * k->above + 5;
    k->cols = (int32_t)(box.w / k->wide) + 10;
    return s;
}

/* Left border of scale i of row j. */
static double border_at(const scales *k, int32_t i, int32_t j)
{
    double shift = k->random_stagger ? tz_shape_unit(k->seed + 2, j, 0)
                   : k->stagger      ? 0.5 * (j & 1)
                                     : 0;
    return k->wide * (i + shift + k->jitter * (tz_shape_unit(k->seed + 3, i, j) - 0.5));
}

static tz_status build_own(tz_canvas *c, scales *k)
{
    tz_status s =
        tz_alloc(c->ctx, &k->own, (size_t)k->rows * (size_t)k->cols, sizeof *k->own);
    for (int32_t i = 0; i < k->rows * k->cols && s == TZ_OK; i++) {
        int32_t row = k->first_row + i / k->cols, col = k->first_col + i % k->cols;
        double longer = k->jitter_end * (tz_shape_unit(k->seed + 4, i, 0) - 0.5);
        k->own[i] = (scale_own){.left = (float)border_at(k, col, row),
                                .length = (float)(k->length * (1 + longer)),
                                .skew = (float)(0.4 * k->jitter_end *
                                                (tz_shape_unit(k->seed + 4, i, 1) - 0.5)),
                                .order = (float)tz_shape_unit(k->seed + 7, i, 0)};
    }
    return s;
}

/* Value of the outline's equation less 1, negative inside, and its length of slope. */
static double outline(const scales *k, double x, double s, double half, double span,
                      double *slope)
{
    double ax = fmin(x / half, 1.5), as = fmin(fmax(s, 0), 1.5);
    double fx = pow(ax, k->q - 1), fs = as > 0 ? pow(as, k->p - 1) : 0;
    double gx = k->q * fx / half, gs = k->p * fs / span;
    *slope = sqrt(gx * gx + gs * gs) + 1e-9;
    return fx * ax + fs * as - 1;
}

static bool scale_at(const scales *k, int32_t i, int32_t j, double x, double y,
                     scale_spot *p)
{
    int32_t thing = 1 + (j - k->first_row) * k->cols + i - k->first_col;
    const scale_own *own = &k->own[thing - 1];
    double a = (double)own[0].left, b = (double)own[1].left, length = (double)own->length;
    p->thing = thing;
    p->half = 0.5 * (b - a) * 1.01 + 0.4;
    p->x = x - 0.5 * (a + b);
    p->t = (y - j * k->pitch + p->x * (double)own->skew) / length;
    if (p->t < 0 || p->t > 1 || fabs(p->x) > p->half)
        return false;
    double span = (1 - k->shoulder) * length, slope;
    double f = outline(k, fabs(p->x), (p->t - k->shoulder) / (1 - k->shoulder), p->half,
                       span, &slope);
    p->edge = fmin(-f / slope, p->half - fabs(p->x));
    return f < 0;
}

/* Counts the pixel for every scale that it lies on, seen or not. */
static scale_spot locate(const scales *k, tz_shape_things *t, tz_vec2 v)
{
    double w = k->rough_size;
    double x =
        v.x + k->rough * (double)tz_canvas_fbm(k->seed + 5, v.x / w, v.y / w, 2, 0.6);
    double y =
        v.y + k->rough * (double)tz_canvas_fbm(k->seed + 6, v.x / w, v.y / w, 2, 0.6);
    int32_t row = (int32_t)floor(y / k->pitch);
    scale_spot top = {0};
    for (int32_t j = row - k->above; j <= row; j++) {
        if (j < k->first_row || j - k->first_row >= k->rows)
            continue;
        double left = (double)k->own[(int64_t)(j - k->first_row) * k->cols].left;
        int32_t i = (int32_t)floor((x - left) / k->wide) + k->first_col - 1;
        scale_spot best = {0}, p;
        double highest = -1;
        for (int32_t m = i; m <= i + 2; m++)
            if (m >= k->first_col && m - k->first_col + 1 < k->cols &&
                scale_at(k, m, j, x, y, &p)) {
                double order = (double)k->own[p.thing - 1].order;
                t->v[p.thing].whole++;
                if (order > highest)
                    highest = order, best = p;
            }
        if (top.thing == 0)
            top = best;
    }
    return top;
}

static void paint(tz_canvas *c, const scales *k, const tz_canvas_skin *skin,
                  const scale_spot *p, tz_vec2 q, int64_t i)
{
    c->relief[i] = 0;
    tz_canvas_skin_at(c, skin, (int32_t)(i % c->width), (int32_t)(i / c->width));
    if (p->thing == 0)
        return;
    double e = fmin(p->edge / k->bevel, 1), across = p->x / p->half;
    double lift = 0.4 * k->thick * tz_shape_unit(k->seed + 8, p->thing, 0);
    c->relief[i] +=
        (float)(k->thick * 1.6 * p->t + lift + k->dome * (1 - across * across) +
                0.4 * k->bevel * sqrt(e * (2 - e)));
    double tone = 1 + k->fade * (p->t - 0.6);
    if (k->rings > 0)
        tone *= 1 + k->rings * sin(p->edge * 2 * TZ_PI / fmax(5, 0.07 * k->wide));
    if (k->ribs > 0)
        tone *= 1 + k->ribs * sin(across * 9 / (0.4 + p->t));
    if (k->grain > 0)
        tone *= 1 + k->grain * (double)tz_canvas_fbm(k->seed + (uint64_t)p->thing,
                                                     p->x / 3.5, q.y / 40, 3, 0.7);
    tz_shape_dim(c, i, tone);
    tz_shape_joint(c, i, p->edge, k->joint, k->gap, k->dark);
    tz_shape_dim(c, i, 1 - 0.3 * k->dark * exp(-p->edge / 4));
}

/* Drawn when a scale is first met. */
static const tz_canvas_skin *skin_of(const scales *k, tz_shape_things *t, int32_t i)
{
    tz_shape_thing *v = &t->v[i];
    if (v->skin.seed != 0)
        return &v->skin;
    tz_rng r = tz_rng_make(k->seed, tz_rng_stream(2, (uint64_t)i, 0));
    float colour[3];
    int family = tz_shape_chance(&r, k->family_share) ? 1 + tz_rng_below(&r, 2) : 0;
    tz_canvas_colour(&r, i ? k->family[family] : k->gap, k->spread, k->spread, colour);
    tz_canvas_skin_draw(&r, colour, k->wide, k->loud, &v->skin);
    v->depth = i ? t->n - i : 0;
    v->element = i != 0;
    return &v->skin;
}

tz_status tz_scene_SCALES(tz_canvas *c)
{
    scales k = {0};
    tz_shape_things t = {0};
    draw_parameters(c, &k);
    tz_status s = draw_bend(c, &k);
    if (s == TZ_OK)
        s = build_own(c, &k);
    if (s == TZ_OK)
        s = tz_shape_things_init(c, 1 + k.cols * k.rows, &t);
    for (int64_t i = 0, n = (int64_t)c->width * c->height; i < n && s == TZ_OK; i++) {
        tz_vec2 q = tz_shape_bend_at(&k.bend, (double)(i % c->width) + 0.5,
                                     (double)(i / c->width) + 0.5);
        scale_spot p = locate(&k, &t, q);
        c->segment[i] = p.thing;
        paint(c, &k, skin_of(&k, &t, p.thing), &p, q, i);
    }
    if (s == TZ_OK) {
        tz_shape_things_count(c, &t);
        s = tz_shape_things_commit(c, &t);
    }
    tz_shape_things_deinit(c, &t);
    tz_free(c->ctx, k.own);
    tz_shape_bend_deinit(c, &k.bend);
    return s;
}
