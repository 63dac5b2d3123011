/* SPDX-License-Identifier: Apache-2.0 */
/* Threads over and under each other: cloth in plain, twill, basket and irregular weaves,
 * wicker of thin stakes and thick rods, plaits and knitting. In cloth, warp i runs along
 * y, weft j along x, and over(i, j) says which is above where they cross. A float, the
 * run of crossings that a thread passes above, is a piece; so is the gap where threads
 * lie 8 px apart or more. Plaits are columns of slanted strands. */
#include "scenes/shapes.h"

enum { MOST_RUN = 8, BANDS = 4 };

typedef struct weave {
    tz_shape_bend bend;
    uint64_t seed;
    bool plait;
    int kind, repeat, most_over; /* of cloth */
    double pitch[2], half[2];    /* warp, weft; half widths of threads, px */
    double wander, narrow, swell, fray;
    double thick, wave, fibre, fibre_size, twist, ply, dark;
    double slant; /* of plaits: rise of a strand from side to middle, in pitches */
    bool mirror, vee;
    int32_t first[2], count[2];
    float colour[2][BANDS][3], gap[3];
    double spread;
    int stripe[2];
} weave;

typedef struct weave_spot {
    int32_t thing; /* 0 = gap */
    float across, along, half, edge, to_end, height;
    int8_t set;  /* 0 warp, 1 weft */
    bool inside; /* false: in a gap too narrow to be a piece */
} weave_spot;

static void draw_colours(tz_rng *r, weave *k)
{
    static const float straw[][3] = {{0.45f, 0.32f, 0.16f},
                                     {0.30f, 0.18f, 0.09f},
                                     {0.55f, 0.45f, 0.30f},
                                     {0.20f, 0.13f, 0.08f}};
    bool natural = tz_shape_chance(r, 0.5);
    for (int set = 0; set < 2; set++)
        for (int i = 0; i < BANDS; i++)
            if (set + i == 0 || tz_shape_chance(r, natural ? 0 : 0.35)) {
                if (natural)
                    tz_canvas_colour(r, straw[tz_rng_below(r, 4)], 0.3, 0.2,
                                     k->colour[set][i]);
                else
                    tz_canvas_base_colour(r, k->colour[set][i]);
            } else {
                tz_canvas_colour(r, k->colour[0][0], natural ? 0.25 : 0.4, 0.2,
                                 k->colour[set][i]);
            }
    for (int i = 0; i < 3; i++)
        k->gap[i] = 0.12f * k->colour[0][0][i];
    k->spread = tz_shape_log_range(r, 0.02, 0.35);
    for (int set = 0; set < 2; set++)
        k->stripe[set] = tz_shape_chance(r, 0.5) ? 1 + tz_rng_below(r, 6) : 1000;
}

static void draw_parameters(tz_canvas *c, weave *k)
{
    tz_rng *r = &c->rng;
    k->seed = tz_rng_u64(r);
    k->plait = tz_shape_chance(r, 0.25);
    k->kind = tz_rng_below(r, 5);
    k->repeat = k->kind == 1 ? 3 + tz_rng_below(r, 3) : 2 + tz_rng_below(r, 2);
    k->most_over = 1 + tz_rng_below(r, k->repeat - 1);
    k->pitch[0] = tz_shape_log_range(r, 22, 130);
    k->pitch[1] =
        k->pitch[0] * (tz_shape_chance(r, 0.5) ? 1 : tz_shape_log_range(r, 0.4, 1.4));
    if (k->kind == 4) { /* wicker */
        k->pitch[0] = tz_shape_log_range(r, 60, 200);
        k->pitch[1] = k->pitch[0] * tz_rng_range(r, 0.2, 0.5);
    }
    double tight = tz_rng_range(r, 0.34, 0.52);
    for (int i = 0; i < 2; i++)
        k->half[i] = k->pitch[i] * fmin(0.52, tight + 0.06 * tz_rng_normal(r));
    if (k->kind == 4)
        k->half[0] *= tz_rng_range(r, 0.25, 0.7);
    double least = fmin(k->pitch[0], k->pitch[1]);
    k->wander = tz_shape_log_range(r, 0.01, 0.1) * least;
    k->narrow = tz_rng_range(r, 0, 0.4);
    k->swell = tz_rng_range(r, 0.02, 0.2);
    k->fray = tz_shape_log_range(r, 0.2, 2.5);
    k->thick = least * tz_shape_log_range(r, 0.06, 0.4);
    k->wave = least * tz_shape_log_range(r, 0.03, 0.3);
    k->fibre = tz_rng_range(r, 0.1, 0.7);
    k->fibre_size = tz_shape_log_range(r, 1.5, 5);
    k->twist = tz_shape_chance(r, 0.5) ? 0.5 * tz_rng_normal(r) : 0;
    k->ply = tz_shape_chance(r, 0.3) ? tz_rng_range(r, 0.1, 0.4) : 0;
    k->dark = tz_rng_range(r, 0.3, 0.95);
    /* strands lean less the thinner that would make them */
    double lean = fmax(k->pitch[1] / 18, 1.05);
    k->slant = fmin(tz_rng_range(r, 0.3, 1.6),
                    0.5 * sqrt(lean * lean - 1) * k->pitch[0] / k->pitch[1]);
    k->mirror = tz_shape_chance(r, 0.6), k->vee = tz_shape_chance(r, 0.4);
    draw_colours(r, k);
}

static tz_status draw_bend(tz_canvas *c, weave *k)
{
    tz_rng *r = &c->rng;
    tz_shape_bend_def d =
        tz_shape_bend_draw(r, tz_shape_chance(r, 0.4) ? 2 : 0.08, k->pitch[0]);
    tz_status s = tz_shape_bend_init(c, k->seed + 1, &d, &k->bend);
    const int32_t from[2] = {k->bend.box.x, k->bend.box.y};
    const int32_t side[2] = {k->bend.box.w, k->bend.box.h};
    for (int i = 0; i < 2; i++) {
        k->first[i] = (int32_t)floor(from[i] / k->pitch[i]) - MOST_RUN - 3;
        k->count[i] = (int32_t)(side[i] / k->pitch[i]) + 2 * MOST_RUN + 8;
    }
    return s;
}

static int32_t positive_mod(int32_t a, int32_t n) { return (a % n + n) % n; }
static int32_t half_down(int32_t a, int32_t n) { return (a - positive_mod(a, n)) / n; }

/* True where warp i passes above weft j. */
static bool over(const weave *k, int32_t i, int32_t j)
{
    switch (k->kind) {
    case 1: return positive_mod(i + j, k->repeat) < k->most_over;
    case 2: return (half_down(i, k->repeat) + half_down(j, k->repeat)) & 1;
    case 3:
        return (positive_mod(2 * i + j, 5) == 0) ^
               (tz_shape_unit(k->seed + 2, i, j) < 0.15);
    default: return (i + j) & 1;
    }
}

/* A float goes on while its thread stays above, up to a limit; n crossings back. */
static int32_t run_back(const weave *k, int32_t i, int32_t j, int set)
{
    int32_t n = 0;
    while (n < MOST_RUN &&
           over(k, set == 0 ? i : i - n - 1, set == 0 ? j - n - 1 : j) == (set == 0))
        n++;
    return n;
}

static int32_t run_on(const weave *k, int32_t i, int32_t j, int set)
{
    int32_t n = 0;
    while (n < MOST_RUN &&
           over(k, set == 0 ? i : i + n + 1, set == 0 ? j + n + 1 : j) == (set == 0))
        n++;
    return n;
}

static int32_t thing_at(const weave *k, int32_t i, int32_t j, int set)
{
    int32_t back = run_back(k, i, j, set);
    if (back == MOST_RUN)
        back = 0; /* an endless float: cut anywhere */
    if (set == 0)
        j -= back;
    else
        i -= back;
    return 1 + 2 * ((j - k->first[1]) * k->count[0] + i - k->first[0]) + set;
}

/* Thread of a set at (x, y), where the crossing (i, j) is: how far inside it lies. */
static weave_spot thread_at(const weave *k, int32_t i, int32_t j, double x, double y,
                            int set)
{
    weave_spot p = {.set = (int8_t)set};
    double own = set == 0 ? i : j, along = set == 0 ? y : x;
    double cell = k->pitch[1 - set], wave = 3 * cell;
    double n =
        (double)tz_canvas_noise(k->seed + 3 + (uint64_t)set, along / wave, 17.3 * own);
    double m =
        (double)tz_canvas_noise(k->seed + 5 + (uint64_t)set, along / wave, 11.7 * own);
    double at = (set == 0 ? i : j) + 0.5;
    p.across = (float)((set == 0 ? x : y) - at * k->pitch[set] - k->wander * n);
    p.along = (float)along;
    double half = k->half[set] * (1 + k->swell * m);
    bool above = over(k, i, j) == (set == 0);
    double in = along - (set == 0 ? j : i) * cell; /* 0..cell */
    double back = above ? in + cell * run_back(k, i, j, set) : 0;
    double on = above ? cell - in + cell * run_on(k, i, j, set) : 0;
    p.to_end = (float)(above ? fmin(back, on) : 0);
    double near_end = above ? 1 - tz_shape_ramp(0, 0.5 * cell, (double)p.to_end) : 1;
    half *= 1 - k->narrow * near_end;
    p.half = (float)half;
    p.edge = (float)(half - fabs((double)p.across));
    double rise = above ? sin(TZ_PI * fmin(0.5, (double)p.to_end / cell)) : -0.6;
    double a = fmin(1, fabs((double)p.across) / half);
    p.height = (float)(k->wave * rise + k->thick * sqrt(1 - a * a));
    return p;
}

static weave_spot cloth_at(const weave *k, double x, double y)
{
    int32_t i = (int32_t)floor(x / k->pitch[0]), j = (int32_t)floor(y / k->pitch[1]);
    weave_spot p[2];
    for (int set = 0; set < 2; set++)
        p[set] = thread_at(k, i, j, x, y, set);
    int top = over(k, i, j) ? 0 : 1, low = 1 - top;
    p[top].inside = p[top].edge > 0;
    p[low].inside = p[low].edge > 0;
    p[top].thing = thing_at(k, i, j, top);
    if (p[top].inside)
        return p[top];
    /* beside the upper thread the lower one comes up; it belongs to the next float */
    int side = p[top].across > 0 ? 1 : -1;
    int32_t ni = low == 1 ? i + side : i, nj = low == 0 ? j + side : j;
    bool floats = over(k, ni, nj) == (low == 0);
    p[low].thing = floats ? thing_at(k, ni, nj, low) : 0;
    if (p[low].inside && floats)
        return p[low];
    weave_spot gap = p[p[top].edge > p[low].edge || !floats ? top : low];
    if (p[low].inside) /* it lies deep under both its neighbours */
        gap = p[low], gap.thing = p[top].thing;
    gap.inside = p[low].inside;
    if (k->pitch[top] - 2 * k->half[top] >= 8)
        gap.thing = 0;
    return gap;
}

/* Strand n of column i lies between two curves that rise from the sides to the middle
 * (vee), or from one side to the other. */
static weave_spot plait_at(const weave *k, double x, double y)
{
    int32_t i = (int32_t)floor(x / k->pitch[0]);
    double u = x / k->pitch[0] - i - 0.5; /* -0.5..0.5 */
    double rise = k->vee ? 2 * fabs(u) : 1 - 2 * u * (k->mirror && (i & 1) ? -1 : 1);
    double bow = 0.12 * sin(2 * TZ_PI * u) * (k->vee ? 0 : 1);
    double shift = tz_shape_unit(k->seed + 6, i, 0);
    double n = (double)tz_canvas_noise(k->seed + 7, 0.7 * i, y / (3 * k->pitch[1]));
    double phase = y / k->pitch[1] + k->slant * (rise + bow) + shift + k->swell * n;
    int32_t j = (int32_t)floor(phase);
    double f = phase - j;
    double steep = 2 * k->slant * k->pitch[1] / k->pitch[0];
    double px = k->pitch[1] / sqrt(1 + steep * steep); /* of one strand, across it */
    weave_spot p = {.set = (int8_t)(i & 1), .inside = true};
    p.half = (float)(0.5 * px);
    p.across = (float)((f - 0.5) * px);
    p.along = (float)(y * 0.3 + x);
    double side = (0.5 - fabs(u)) * k->pitch[0];
    p.edge = (float)fmin(side, 0.5 * px - fabs((double)p.across));
    if (k->vee) {
        p.edge = (float)fmin((double)p.edge, fabs(u) * k->pitch[0]);
        j = 2 * j + (u > 0);
    }
    p.to_end = (float)side;
    int32_t rows = 2 * (k->count[1] + (int32_t)(4 * k->slant) + 8);
    int32_t row = positive_mod(j, rows);
    p.thing = 1 + (i - k->first[0]) * rows + row;
    double a = 2 * f - 1, b = fmin(1, 2 * side / k->pitch[0]);
    p.height = (float)(k->thick * sqrt(1 - a * a) + k->wave * sqrt(b * (2 - b)));
    return p;
}

static int32_t thing_count(const weave *k)
{
    int32_t plait = (k->count[0] + 1) * 2 * (k->count[1] + (int32_t)(4 * k->slant) + 8);
    return 2 + (k->plait ? plait : 2 * k->count[0] * (k->count[1] + 1));
}

static weave_spot locate(const weave *k, int32_t x, int32_t y)
{
    tz_vec2 q = tz_shape_bend_at(&k->bend, x + 0.5, y + 0.5);
    double fx = k->fray * (double)tz_canvas_fbm(k->seed + 8, x / 5.0, y / 5.0, 2, 0.7);
    double fy = k->fray * (double)tz_canvas_fbm(k->seed + 9, x / 5.0, y / 5.0, 2, 0.7);
    return k->plait ? plait_at(k, q.x + fx, q.y + fy) : cloth_at(k, q.x + fx, q.y + fy);
}

static void paint(tz_canvas *c, const weave *k, const tz_canvas_skin *skin,
                  const weave_spot *p, int64_t i)
{
    c->relief[i] = p->thing ? p->height : (float)(-0.7 * k->thick - k->wave);
    tz_canvas_skin_at(c, skin, (int32_t)(i % c->width), (int32_t)(i / c->width));
    if (p->thing == 0)
        return;
    double u = ((double)p->across + k->twist * (double)p->along) / k->fibre_size;
    double n = (double)tz_canvas_fbm(k->seed + 10, u,
                                     (double)p->along / (14 * k->fibre_size), 3, 0.7);
    c->relief[i] += (float)(0.5 * k->fibre * n);
    double tone = 1 + k->fibre * n;
    if (k->ply > 0) {
        double turn =
            ((double)p->along + 1.2 * (double)p->across) / (0.7 * (double)p->half + 3);
        tone *= 1 + k->ply * sin(2 * TZ_PI * turn);
    }
    tone *=
        1 - 0.5 * k->dark * exp(-fmax(0, (double)p->edge) / (0.2 * (double)p->half + 1));
    if (!k->plait)
        tone *= 1 - 0.45 * k->dark *
                        exp(-(double)p->to_end / (0.12 * k->pitch[1 - p->set] + 1));
    tz_shape_dim(c, i, tone);
    if (!p->inside)
        tz_shape_tint(c, i, k->gap, 0.95);
    else
        tz_shape_joint(c, i, (double)p->edge, 0.4, k->gap, k->dark);
}

static void draw_skins(const weave *k, const weave_spot *p, int64_t n, tz_shape_things *t)
{
    tz_rng own = tz_rng_make(k->seed, 1);
    double rough = tz_rng_range(&own, 0.05, 0.6);
    tz_canvas_skin_draw(&own, k->gap, 10, 0.4, &t->v[0].skin);
    t->v[0].element = false, t->v[0].depth = 0;
    for (int64_t i = 0; i < n; i++) {
        tz_shape_thing *v = &t->v[p[i].thing];
        if (p[i].thing == 0 || v->skin.seed != 0)
            continue;
        tz_rng r = tz_rng_make(k->seed, tz_rng_stream(2, (uint64_t)p[i].thing, 0));
        double at = (double)(p[i].set == 0 ? (p[i].thing - 1) / 2 % k->count[0]
                                           : (p[i].thing - 1) / 2 / k->count[0]);
        int band = (int)(at / k->stripe[p[i].set]) % BANDS;
        float colour[3];
        tz_canvas_colour(&r, k->colour[p[i].set][band], k->spread, k->spread, colour);
        tz_canvas_skin_draw(&r, colour, k->pitch[p[i].set], rough, &v->skin);
        v->skin.streak = 0;
        v->skin.seed |= 1;
    }
}

tz_status tz_scene_WEAVE(tz_canvas *c)
{
    weave k = {0};
    tz_shape_things t = {0};
    weave_spot *p = NULL;
    int64_t n = (int64_t)c->width * c->height;
    draw_parameters(c, &k);
    tz_status s = draw_bend(c, &k);
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &p, (size_t)n, sizeof *p);
    if (s == TZ_OK)
        s = tz_shape_things_init(c, thing_count(&k), &t);
    if (s != TZ_OK)
        goto done;
    for (int64_t i = 0; i < n; i++) {
        p[i] = locate(&k, (int32_t)(i % c->width), (int32_t)(i / c->width));
        c->segment[i] = p[i].thing;
    }
    tz_shape_things_count(c, &t);
    draw_skins(&k, p, n, &t);
    for (int64_t i = 0; i < n; i++)
        paint(c, &k, &t.v[p[i].thing].skin, &p[i], i);
    s = tz_shape_things_commit(c, &t);
done:
    tz_shape_things_deinit(c, &t);
    tz_free(c->ctx, p);
    tz_shape_bend_deinit(c, &k.bend);
    return s;
}
