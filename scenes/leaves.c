/* SPDX-License-Identifier: Apache-2.0 */
/* Leaves in a heap: fallen ones that cover the ground two deep, a few on soil or paving,
 * a hedge, straw and needles. They are laid one after the other, each on what lies under
 * its midrib. Veins, spots and browned borders are inside texture. Things under 8 px
 * wide (stalks, needles, twigs) are lines along their middle. */
#include "scenes/leaf.h"

#include <string.h>

typedef struct pose {
    tz_leaf leaf;
    int species;
    double level, curl, arch, crumple;
    bool thin;
    bool twig;
    float colour[3];
    double browned, halves, holes;
} pose;

typedef struct heap {
    uint64_t seed;
    tz_leaf_species species[3];
    int kinds;
    int32_t n; /* leaves and twigs */
    pose *pose;
    int32_t *top; /* pose at a pixel + 1; 0 the ground */
    float *u, *v, *edge;
    double cover, aim, aim_spread, twigs, curl, crumple, thick;
    double spread, rough, vein, brown, holes;
    float family[3][3], brown_colour[3], vein_colour[3], ground[3];
} heap;

static void draw_colours(tz_rng *r, heap *k)
{
    static const float dead[][3] = {{0.30f, 0.20f, 0.13f},
                                    {0.42f, 0.33f, 0.26f},
                                    {0.20f, 0.11f, 0.06f},
                                    {0.52f, 0.45f, 0.39f},
                                    {0.12f, 0.075f, 0.05f}};
    static const float autumn[][3] = {{0.60f, 0.38f, 0.04f},
                                      {0.50f, 0.13f, 0.03f},
                                      {0.38f, 0.05f, 0.03f},
                                      {0.30f, 0.18f, 0.05f},
                                      {0.40f, 0.38f, 0.06f}};
    static const float green[][3] = {{0.07f, 0.14f, 0.03f},
                                     {0.14f, 0.22f, 0.05f},
                                     {0.04f, 0.08f, 0.03f},
                                     {0.24f, 0.28f, 0.08f},
                                     {0.10f, 0.15f, 0.10f}};
    static const float soil[][3] = {
        {0.05f, 0.035f, 0.025f}, {0.12f, 0.085f, 0.06f}, {0.03f, 0.03f, 0.02f}};
    double season = tz_rng_unit(r);
    for (int i = 0; i < 3; i++) {
        const float *base = season < 0.45  ? dead[tz_rng_below(r, 5)]
                            : season < 0.7 ? autumn[tz_rng_below(r, 5)]
                                           : green[tz_rng_below(r, 5)];
        tz_canvas_colour(r, base, 0.3, 0.2, k->family[i]);
    }
    tz_canvas_colour(r, dead[tz_rng_below(r, 5)], 0.4, 0.2, k->brown_colour);
    bool bright = tz_shape_chance(r, 0.6);
    for (int q = 0; q < 3; q++)
        k->vein_colour[q] = k->family[0][q] * (bright ? 1.8f : 0.45f);
    if (tz_shape_chance(r, 0.75))
        tz_canvas_colour(r, soil[tz_rng_below(r, 3)], 0.4, 0.2, k->ground);
    else
        tz_canvas_base_colour(r, k->ground);
}

static void draw_parameters(tz_canvas *c, heap *k)
{
    tz_rng *r = &c->rng;
    k->seed = tz_rng_u64(r);
    double length = tz_shape_log_range(r, 55, 380);
    k->kinds = 1 + tz_rng_below(r, 3);
    for (int i = 0; i < k->kinds; i++)
        tz_leaf_species_draw(r, length * exp(0.3 * tz_rng_normal(r) * (i > 0)),
                             &k->species[i]);
    double sort = tz_rng_unit(r);
    k->cover = sort < 0.6 ? tz_rng_range(r, 1.6, 3.2) : tz_shape_log_range(r, 0.08, 1.2);
    k->aim = tz_rng_range(r, 0, 2 * TZ_PI);
    k->aim_spread = tz_shape_chance(r, 0.25) ? tz_rng_range(r, 0.2, 0.8) : 7;
    k->twigs = tz_shape_chance(r, 0.5) ? tz_rng_range(r, 1, 14) : 0;
    k->curl = tz_rng_range(r, 0, 0.16);
    k->crumple = tz_rng_range(r, 0.005, 0.05);
    k->thick = tz_shape_log_range(r, 0.8, 5);
    k->spread = tz_rng_range(r, 0.08, 0.5);
    k->rough = tz_rng_range(r, 0.15, 0.8);
    k->vein = tz_rng_range(r, 0.1, 0.7);
    k->brown = tz_shape_chance(r, 0.5) ? tz_rng_range(r, 0.2, 0.9) : 0;
    k->holes = tz_shape_chance(r, 0.4) ? tz_rng_range(r, 0.1, 0.6) : 0;
    draw_colours(r, k);
}

static double mean_area(const tz_leaf_species *s)
{
    double shape = s->kind == TZ_LEAF_STAR ? 0.35 : 1.3 * s->width;
    return fmax(shape * s->length * s->length, 700);
}

static void draw_twig(tz_rng *r, double length, tz_leaf_species *s)
{
    *s = (tz_leaf_species){.kind = TZ_LEAF_BLADE, .rough = 0.25, .squash = 0.99};
    s->length = length * tz_rng_range(r, 0.6, 3);
    s->width = tz_shape_log_range(r, 2, 11) / s->length;
    s->bend = tz_rng_range(r, 0, 0.35);
}

static void draw_pose(tz_canvas *c, const heap *k, int32_t i, pose *p)
{
    tz_rng r = tz_rng_make(k->seed, tz_rng_stream(1, (uint64_t)i, 0));
    static const float bark[3] = {0.16f, 0.11f, 0.08f};
    double margin = 0.4 * k->species[0].length;
    tz_vec2 at = {tz_rng_range(&r, -margin, c->width + margin),
                  tz_rng_range(&r, -margin, c->height + margin)};
    double angle = k->aim + k->aim_spread * (tz_rng_unit(&r) - 0.5);
    p->species = tz_rng_below(&r, k->kinds);
    p->twig = tz_shape_chance(&r, k->twigs / (k->n + 1.0));
    tz_leaf_species s = k->species[p->species];
    if (p->twig)
        draw_twig(&r, k->species[0].length, &s);
    tz_leaf_draw(&r, &s, at, p->twig ? 7 * tz_rng_unit(&r) : angle, &p->leaf);
    p->thin = s.kind == TZ_LEAF_BLADE && 2 * s.width * p->leaf.length < 8.5;
    p->curl = k->curl * tz_rng_normal(&r);
    p->arch = 0.5 * k->curl * p->leaf.length * tz_rng_normal(&r);
    p->crumple = k->crumple * p->leaf.length * exp(0.5 * tz_rng_normal(&r));
    tz_canvas_colour(&r, p->twig ? bark : k->family[tz_rng_below(&r, 3)], k->spread,
                     0.6 * k->spread, p->colour);
    p->browned = tz_shape_chance(&r, 0.7) ? k->brown * tz_rng_unit(&r) : 0;
    p->halves = 0.14 * tz_rng_normal(&r);
    p->holes = tz_shape_chance(&r, k->holes) ? tz_rng_range(&r, 0.45, 0.75) : 2;
}

/* Height of what the midrib lies on: near the highest of some places along it. */
static double support(const tz_canvas *c, const tz_leaf *leaf)
{
    double most = 0, sum = 0;
    int n = 0;
    for (int i = 0; i < 9; i++) {
        double u = leaf->length * (0.1 + 0.1 * i);
        double v = leaf->bend * u * u * leaf->squash;
        int32_t x = (int32_t)(leaf->at.x + leaf->co * u - leaf->si * v);
        int32_t y = (int32_t)(leaf->at.y + leaf->si * u + leaf->co * v);
        if (x < 0 || y < 0 || x >= c->width || y >= c->height)
            continue;
        double h = (double)c->relief[(int64_t)y * c->width + x];
        most = fmax(most, h), sum += h, n++;
    }
    return n ? 0.5 * most + 0.5 * sum / n : 0;
}

static bool in_hole(const heap *k, const pose *p, const tz_leaf_spot *spot, int32_t i)
{
    if (p->holes > 1 || spot->stalk)
        return false;
    double f = 6 / p->leaf.length;
    return (double)tz_canvas_fbm(k->seed + 3 + (uint64_t)i, spot->u * f, spot->v * f, 3,
                                 0.5) > p->holes;
}

static void lay(tz_canvas *c, heap *k, int32_t i, tz_shape_thing *thing)
{
    pose *p = &k->pose[i];
    const tz_leaf *leaf = &p->leaf;
    p->level = support(c, leaf) + k->thick;
    int32_t y0 = (int32_t)fmax(0, leaf->at.y - leaf->reach);
    int32_t y1 = (int32_t)fmin(c->height, leaf->at.y + leaf->reach);
    double arch = p->arch / leaf->length / leaf->length;
    for (int32_t y = y0; y < y1; y++) {
        double x0 = fmax(0, leaf->at.x - leaf->reach);
        double x1 = fmin(c->width, leaf->at.x + leaf->reach);
        tz_leaf_span(leaf, y + 0.5, &x0, &x1);
        for (int32_t x = (int32_t)x0; x < (int32_t)x1; x++) {
            tz_leaf_spot spot;
            if (!tz_leaf_at(leaf, x + 0.5, y + 0.5, &spot) || in_hole(k, p, &spot, i))
                continue;
            int64_t at = (int64_t)y * c->width + x;
            bool thin = p->thin || spot.stalk;
            k->top[at] = i + 1;
            k->u[at] = (float)spot.u, k->v[at] = (float)spot.v;
            k->edge[at] = (float)spot.edge;
            c->line[at] = thin && fabs(spot.v) <= 0.6;
            if (!thin)
                c->segment[at] = i + 1, thing->whole++;
            double lift = p->curl * spot.v * spot.v / (0.3 * leaf->length);
            if (p->twig)
                lift = sqrt(spot.edge * (2 * fabs(spot.v) + spot.edge));
            c->relief[at] =
                (float)(p->level + lift + arch * 4 * spot.u * (leaf->length - spot.u));
        }
    }
}

/* Share of the vein colour: midrib, and side veins that leave it at half a right angle;
 * of a star, one rib a lobe. */
static double vein_share(const heap *k, const pose *p, double u, double v)
{
    const tz_leaf_species *s = &k->species[p->species];
    double wide = 0.6 + 0.007 * p->leaf.length, t = u / p->leaf.length;
    if (p->twig || s->kind == TZ_LEAF_BLADE || s->veins == 0)
        return 0;
    double rib = 1 - tz_shape_ramp(0.5, 1.4, fabs(v) / (wide * (1.3 - t)));
    double side = 0;
    if (s->kind == TZ_LEAF_STAR) {
        for (int j = 0; j < s->lobes; j++) {
            double a = (j - 0.5 * (s->lobes - 1)) * 0.42 * 7.5 / s->lobes;
            if (u * cos(a) + v * sin(a) > 0)
                rib = fmax(rib, 1 - tz_shape_ramp(0.5, 1.6,
                                                  fabs(v * cos(a) - u * sin(a)) / wide));
        }
    } else {
        double phase = s->veins * (t - 0.8 * fabs(v) / p->leaf.length) + (v > 0) * 0.4;
        double d = fabs(phase - floor(phase) - 0.5) * p->leaf.length / s->veins * 0.75;
        side = 0.6 * (1 - tz_shape_ramp(0.4, 1.5, d / (0.6 * wide + 0.4)));
    }
    return fmax(rib, side);
}

static void paint_leaf(tz_canvas *c, const heap *k, tz_canvas_skin *skin, int64_t i)
{
    const pose *p = &k->pose[k->top[i] - 1];
    uint64_t own = k->seed + (uint64_t)k->top[i];
    double u = (double)k->u[i], v = (double)k->v[i], f = 4 / p->leaf.length;
    tz_canvas_skin_at(c, skin, (int32_t)(i % c->width), (int32_t)(i / c->width));
    if (p->twig) {
        tz_shape_dim(c, i, 1 + 0.4 * (double)tz_canvas_fbm(own, u / 20, v / 2, 2, 0.6));
        return;
    }
    double n = (double)tz_canvas_fbm(own, u * f, v * f, 3, 0.55);
    double rib = vein_share(k, p, u, v);
    c->relief[i] += (float)(p->crumple * 2 * n - 0.5 * rib);
    tz_shape_tint(c, i, k->vein_colour, k->vein * rib);
    tz_shape_dim(c, i, (1 + p->halves * tz_shape_ramp(-1, 1, v)) * (1 + 0.25 * n));
    double border = (double)k->edge[i] / (0.06 * p->leaf.length) + 1.5 * n;
    tz_shape_tint(c, i, k->brown_colour,
                  p->browned * (1 - tz_shape_ramp(-0.2, 1.5, border)));
}

/* Soil with crumbs too small to be pieces. */
static void paint_ground(tz_canvas *c, const heap *k, const tz_canvas_skin *skin,
                         int64_t i)
{
    int32_t x = (int32_t)(i % c->width), y = (int32_t)(i / c->width);
    tz_canvas_skin_at(c, skin, x, y);
    double n = (double)tz_canvas_fbm(k->seed + 2, x / 9.0, y / 9.0, 3, 0.75);
    c->relief[i] += (float)(2.5 * n);
    tz_shape_dim(c, i, 1 + 0.6 * n);
    double crumb = (double)tz_canvas_noise(k->seed + 4, x / 5.0, y / 7.0);
    tz_shape_tint(c, i, k->brown_colour, 0.7 * tz_shape_ramp(0.5, 0.62, crumb));
}

static tz_status paint_heap(tz_canvas *c, heap *k, tz_shape_things *t)
{
    int64_t n = (int64_t)c->width * c->height;
    t->v[0].element = false, t->v[0].depth = 0;
    tz_canvas_skin_draw(&c->rng, k->ground, 40, 0.9, &t->v[0].skin);
    for (int32_t i = 0; i < k->n; i++) {
        draw_pose(c, k, i, &k->pose[i]);
        lay(c, k, i, &t->v[i + 1]);
        t->v[i + 1].depth = i + 1;
        tz_rng r = tz_rng_make(k->seed, tz_rng_stream(2, (uint64_t)i, 0));
        tz_canvas_skin_draw(&r, k->pose[i].colour, 0.5 * k->pose[i].leaf.length, k->rough,
                            &t->v[i + 1].skin);
    }
    tz_shape_things_count(c, t);
    for (int64_t i = 0; i < n; i++)
        if (k->top[i] == 0)
            paint_ground(c, k, &t->v[0].skin, i);
        else
            paint_leaf(c, k, &t->v[k->top[i]].skin, i);
    return tz_shape_things_commit(c, t);
}

tz_status tz_scene_LEAVES(tz_canvas *c)
{
    heap k = {0};
    tz_shape_things t = {0};
    size_t n = (size_t)c->width * (size_t)c->height;
    float *planes = NULL;
    draw_parameters(c, &k);
    double area = 0;
    for (int i = 0; i < k.kinds; i++)
        area += mean_area(&k.species[i]) / k.kinds;
    double margin = 0.8 * k.species[0].length;
    double room = (c->width + margin) * (c->height + margin);
    k.n = 1 + (int32_t)fmin(k.cover * room / area, fmin(20000, 500 + room / 700));
    tz_status s = tz_alloc_zero(c->ctx, &k.pose, (size_t)k.n, sizeof *k.pose);
    if (s == TZ_OK)
        s = tz_alloc_zero(c->ctx, &k.top, n, sizeof *k.top);
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &planes, 3 * n, sizeof *planes);
    if (s == TZ_OK)
        s = tz_shape_things_init(c, k.n + 1, &t);
    if (s == TZ_OK) {
        k.u = planes, k.v = planes + n, k.edge = planes + 2 * n;
        memset(c->segment, 0, n * sizeof *c->segment);
        memset(c->relief, 0, n * sizeof *c->relief);
        s = paint_heap(c, &k, &t);
    }
    tz_shape_things_deinit(c, &t);
    tz_free(c->ctx, planes);
    tz_free(c->ctx, k.top);
    tz_free(c->ctx, k.pose);
    return s;
}
