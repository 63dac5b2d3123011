/* SPDX-License-Identifier: Apache-2.0 */
/* Groups made ready for placing.
 *
 * A group is placed with a star-shaped border about its region's centre: per ray the
 * farthest pixel of the region (its hull over concave parts), at least the wanted piece's
 * radius, and a margin beyond it in which the seam may look for the best way.
 *
 *            . - - - .        limit: the seam stays inside
 *         .    ____    .      hull of the region, radius[ray]
 *        .   /      \   .
 *        .  |   +    |  .     + centre
 *         .  \______/  .
 *            ' - - - '
 */
#include <string.h>

#include "synthesis/arrange_internal.h"

static void cast_rays(const tz_ebpt *e, int32_t group, tz_star *s)
{
    float far2[TZ_RAYS];
    const tz_edge_group *g = &e->group.v[group];
    for (int k = 0; k < TZ_RAYS; k++)
        far2[k] = 0;
    for (int k = 0; k < TZ_RAYS; k++) {
        const double a = 2 * TZ_PI * k / TZ_RAYS, cx = cos(a), cy = sin(a);
        const double longest = g->box.w + g->box.h;
        for (double r = 0; r < longest; r += 1) {
            const int32_t x = (int32_t)(s->centre.x + r * cx),
                          y = (int32_t)(s->centre.y + r * cy);
            if (x < g->box.x || y < g->box.y || x >= g->box.x + g->box.w ||
                y >= g->box.y + g->box.h)
                break;
            if (e->label[(int64_t)y * e->width + x] == group)
                far2[k] = (float)r;
        }
    }
    /* mean of three rays: no spikes */
    for (int k = 0; k < TZ_RAYS; k++)
        s->radius[k] =
            (far2[(k + TZ_RAYS - 1) % TZ_RAYS] + 2 * far2[k] + far2[(k + 1) % TZ_RAYS]) /
            4;
}

/* Distance from p along direction a to the photo's border, kept half a pixel inside. */
static double border_distance(const tz_ebpt *e, tz_vec2 p, double a)
{
    const double cx = cos(a), cy = sin(a);
    double d = INFINITY;
    if (cx > 1e-9)
        d = fmin(d, (e->width - 0.5 - p.x) / cx);
    if (cx < -1e-9)
        d = fmin(d, (0.5 - p.x) / cx);
    if (cy > 1e-9)
        d = fmin(d, (e->height - 0.5 - p.y) / cy);
    if (cy < -1e-9)
        d = fmin(d, (0.5 - p.y) / cy);
    return d > 0 ? d : 0;
}

enum { TINY = 16 };

static bool tiny(const tz_ebpt *e) { return e->width < TINY || e->height < TINY; }

/* @param granular  cut to the group's own region, not to a wanted size */
static void make_star(const tz_exemplar *ex, int32_t exemplar, int32_t group,
                      double piece, bool granular, tz_star *s)
{
    const tz_ebpt *e = ex->ebpt;
    const tz_edge_group *g = &e->group.v[group];
    memset(s, 0, sizeof *s);
    s->exemplar = exemplar, s->group = group;
    s->centre = g->region_centre;
    s->size = (float)g->size;
    cast_rays(e, group, s);
    const double floor_radius =
        granular ? fmin(fmax(0.8 * g->size, 8), 0.5 * piece) : 0.5 * piece;
    const double ceiling = granular ? fmin(1.3 * g->size + 8, 1.1 * piece) : 1.1 * piece;
    double sum = 0;
    for (int k = 0; k < TZ_RAYS; k++) {
        const double a = 2 * TZ_PI * k / TZ_RAYS;
        double r = s->radius[k];
        r = r < floor_radius ? floor_radius : r > ceiling ? ceiling : r;
        double limit = r * 1.2 + 4;
        /* photos smaller than any piece go on beyond their borders, mirrored */
        const double border = tiny(e) ? piece : border_distance(e, s->centre, a);
        if (limit > border)
            limit = border;
        if (r > limit)
            r = limit;
        s->radius[k] = (float)r, s->limit[k] = (float)limit;
        sum += r;
    }
    s->mean_radius = (float)(sum / TZ_RAYS);
}

/* What the exemplar shows around a group: neighbouring groups, and edges that leave. */
static void surroundings(const tz_ebpt *e, int32_t group, tz_star *s)
{
    const tz_vec2 c = s->centre;
    s->neighbours = 0;
    if (e->neighbour_first.n > group + 1)
        for (int32_t k = e->neighbour_first.v[group];
             k < e->neighbour_first.v[group + 1] && s->neighbours < 16; k++) {
            const tz_edge_group *h = &e->group.v[e->neighbour.v[k]];
            s->neighbour[s->neighbours++] =
                (tz_neighbour){{h->region_centre.x - c.x, h->region_centre.y - c.y, 0},
                               h->edges > 1 ? h->angle : NAN,
                               h->size,
                               0};
        }
    const tz_edge_group *g = &e->group.v[group];
    for (int32_t k = g->edge; k < g->edge + g->edges; k++) {
        const tz_edge *d = &e->edge.v[e->group_edge.v[k]];
        for (int end = 0; end < 2 && s->neighbours < TZ_NEIGHBOURS_MAX; end++) {
            const double dx = d->end[end].x - c.x, dy = d->end[end].y - c.y;
            if (dx * dx + dy * dy < 0.5 * g->size * g->size)
                continue; /* ends inside */
            const double a = fmod(d->end_angle[end] + 2 * TZ_PI, TZ_PI);
            s->neighbour[s->neighbours++] =
                (tz_neighbour){{dx, dy, 0}, a, 0.3 * g->size, 1};
        }
    }
}

/* The full comparison is made with the SHORTLIST stars nearest in size only. */
static void find_similar(tz_stars *s, int32_t self, double scale)
{
    enum { SHORTLIST = 48 };
    tz_star *a = &s->star.v[self];
    const tz_neighbour_weights w = {0.5, 1.0, 0.5, 1.5 * scale};
    double best[TZ_SIMILAR], gap[SHORTLIST];
    int32_t list[SHORTLIST], n = 0;
    for (int32_t j = s->first[a->exemplar]; j < s->first[a->exemplar + 1]; j++) {
        const double d = fabs((double)s->star.v[j].size - a->size);
        if (j == self || (n == SHORTLIST && d >= gap[n - 1]))
            continue;
        int32_t at = n < SHORTLIST ? n++ : n - 1;
        while (at > 0 && gap[at - 1] > d)
            gap[at] = gap[at - 1], list[at] = list[at - 1], at--;
        gap[at] = d, list[at] = j;
    }
    for (int k = 0; k < TZ_SIMILAR; k++)
        a->similar[k] = -1, best[k] = INFINITY;
    for (int32_t i = 0; i < n; i++) {
        const tz_star *b = &s->star.v[list[i]];
        const double cost =
            gap[i] * gap[i] + tz_neighbourhood_cost(a->neighbour, a->neighbours,
                                                    b->neighbour, b->neighbours, &w);
        int at = TZ_SIMILAR;
        while (at > 0 && cost < best[at - 1])
            at--;
        if (at == TZ_SIMILAR)
            continue;
        for (int k = TZ_SIMILAR - 1; k > at; k--)
            best[k] = best[k - 1], a->similar[k] = a->similar[k - 1];
        best[at] = cost, a->similar[at] = list[i];
    }
}

typedef struct similar_job {
    tz_stars *s;
    const tz_exemplar *ex;
} similar_job;

static tz_status similar_task(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    (void)ctx, (void)worker;
    similar_job *job = arg;
    find_similar(job->s, (int32_t)i, job->ex[job->s->star.v[i].exemplar].ebpt->scale);
    return TZ_OK;
}

static double fitting_piece(const tz_ebpt *e, double piece)
{
    const double shorter = e->width < e->height ? e->width : e->height;
    return tiny(e) ? fmin(piece, TINY) : fmin(piece, 0.7 * shorter);
}

static void widen(tz_stars *s, const tz_star *star)
{
    for (int k = 0; k < TZ_RAYS; k++)
        s->reach = fmax(s->reach, star->limit[k]);
}

/* The stars once more, cut to the piece of one rule and level. */
static tz_status add_block(tz_ctx *ctx, const tz_exemplar *ex, double piece,
                           bool granular, tz_stars *s)
{
    tz_status st = TZ_OK;
    for (int32_t k = 0; k < s->count && st == TZ_OK; k++) {
        tz_star star = s->star.v[k], cut;
        const double wanted = fitting_piece(ex[star.exemplar].ebpt, piece);
        make_star(&ex[star.exemplar], star.exemplar, star.group, wanted, granular, &cut);
        memcpy(star.radius, cut.radius, sizeof star.radius);
        memcpy(star.limit, cut.limit, sizeof star.limit);
        star.mean_radius = cut.mean_radius;
        widen(s, &star);
        st = tz_array_push(ctx, &s->star, star);
    }
    return st;
}

/* A block for each rule and level that wants other sizes than the exemplars'. */
static tz_status add_blocks(tz_ctx *ctx, const tz_exemplar *ex, const tz_rules *rules,
                            double piece, tz_stars *s)
{
    const int32_t n = rules->rule.n * s->levels;
    tz_status st = tz_alloc_zero(ctx, &s->block, (size_t)n, sizeof *s->block);
    for (int32_t i = 0; i < n && st == TZ_OK; i++) {
        const tz_rule *rule = &rules->rule.v[i / s->levels];
        const bool granular = rule->structure == TZ_STRUCTURE_GRANULAR;
        const double density = rule->density * pow(2, -(i % s->levels));
        if (!granular && density == 1)
            continue;
        s->block[i] = s->star.n;
        st = add_block(ctx, ex, piece / sqrt(density), granular, s);
    }
    return st;
}

tz_status tz_stars_init(tz_ctx *ctx, const tz_exemplar *ex, int32_t n,
                        const tz_rules *rules, double piece, int32_t levels, tz_stars *s)
{
    memset(s, 0, sizeof *s);
    s->levels = levels;
    tz_status st = tz_alloc_zero(ctx, &s->first, (size_t)n + 1, sizeof *s->first);
    for (int32_t e = 0; e < n && st == TZ_OK; e++) {
        const tz_ebpt *b = ex[e].ebpt;
        s->first[e] = s->star.n;
        st = tz_alloc(ctx, &s->of_group[e], (size_t)b->group.n + 1, sizeof(int32_t));
        for (int32_t g = 0; g < b->group.n && st == TZ_OK; g++) {
            tz_star star;
            const double fit = fitting_piece(b, piece);
            make_star(&ex[e], e, g, fit, false, &star);
            /* slivers at the photo's border cannot cover anything */
            float least = INFINITY;
            for (int k = 0; k < TZ_RAYS; k++)
                least = fminf(least, star.radius[k]);
            if (least < 0.2F * (float)fit && b->group.n > 4 &&
                !(g + 1 == b->group.n && s->star.n == s->first[e])) {
                s->of_group[e][g] = -1;
                continue;
            }
            surroundings(b, g, &star);
            s->of_group[e][g] = s->star.n;
            widen(s, &star);
            st = tz_array_push(ctx, &s->star, star);
        }
    }
    if (st == TZ_OK) {
        s->first[n] = s->count = s->star.n;
        similar_job job = {s, ex};
        st = tz_parallel_for(ctx, s->count, similar_task, &job);
    }
    if (st == TZ_OK)
        st = add_blocks(ctx, ex, rules, piece, s);
    if (st != TZ_OK)
        tz_stars_deinit(ctx, s, n);
    return st;
}

void tz_stars_deinit(tz_ctx *ctx, tz_stars *s, int32_t n)
{
    tz_array_free(ctx, &s->star);
    for (int32_t e = 0; e < n; e++)
        tz_free(ctx, s->of_group[e]);
    tz_free(ctx, s->first);
    tz_free(ctx, s->block);
    memset(s, 0, sizeof *s);
}

/* ---- freedom ---------------------------------------------------------------------- */

enum { BINS = 72 }; /* 5 degrees of gradient direction, signed: light counts */

static void direction_histogram(const tz_image *im, tz_rect r, double h[BINS])
{
    double sum = 0;
    for (int k = 0; k < BINS; k++)
        h[k] = 0;
    const int32_t d = 2;
    for (int32_t y = r.y + d; y < r.y + r.h - d; y += 2)
        for (int32_t x = r.x + d; x < r.x + r.w - d; x += 2) {
            double v[4] = {0}; /* right, left, down, up over 3 x 3 */
            const int g = im->channels >= 3 ? 1 : 0;
            for (int a = -1; a <= 1; a++) {
                v[0] += tz_image_at(im, x + d, y + a)[g];
                v[1] += tz_image_at(im, x - d, y + a)[g];
                v[2] += tz_image_at(im, x + a, y + d)[g];
                v[3] += tz_image_at(im, x + a, y - d)[g];
            }
            const double gx = v[0] - v[1], gy = v[2] - v[3];
            const double m = sqrt(gx * gx + gy * gy);
            if (m <= 0)
                continue;
            double b = (atan2(gy, gx) / (2 * TZ_PI) + 1) * BINS;
            const int k = (int)b;
            const double f = b - k;
            h[k % BINS] += m * (1 - f);
            h[(k + 1) % BINS] += m * f;
            sum += m;
        }
    for (int k = 0; k < BINS; k++)
        h[k] = sum > 0 ? h[k] / sum : 1.0 / BINS;
}

/* Histogram of the picture turned by `bins` (fraction allowed), or mirrored (x: angle a
 * becomes pi - a, y: a becomes -a). */
static double turned_distance(const double h[BINS], double bins, int mirror)
{
    double d = 0;
    for (int k = 0; k < BINS; k++) {
        double at = k - bins;
        if (mirror == 1)
            at = BINS / 2.0 - k;
        if (mirror == 2)
            at = -k;
        at = fmod(at + 4 * BINS, BINS);
        const int i = (int)at;
        const double f = at - i;
        d += fabs(h[k] - ((1 - f) * h[i % BINS] + f * h[(i + 1) % BINS]));
    }
    return d;
}

/* A turn is allowed as long as it changes the histogram of gradient directions less than
 * one half of the exemplar differs from the other. */
tz_status tz_freedom_measure(tz_ctx *ctx, const tz_exemplar *ex, tz_freedom *f)
{
    (void)ctx;
    const tz_image *im = ex->photo;
    const int32_t w = im->width, h = im->height;
    const tz_rect half[4] = {{0, 0, w / 2, h},
                             {w / 2, 0, w - w / 2, h},
                             {0, 0, w, h / 2},
                             {0, h / 2, w, h - h / 2}};
    double all[BINS], part[4][BINS];
    direction_histogram(im, (tz_rect){0, 0, w, h}, all);
    for (int k = 0; k < 4; k++)
        direction_histogram(im, half[k], part[k]);
    double natural = 0;
    for (int k = 0; k < 4; k += 2) {
        double d = 0;
        for (int b = 0; b < BINS; b++)
            d += fabs(part[k][b] - part[k + 1][b]);
        natural = fmax(natural, d);
    }
    /* Halves that differ very much (perspective, one large bend) say little about turns that
     * may be drawn at random, but that a piece may turn to follow its neighbours. */
    const double least = fmax(natural, 0.03), calm = fmin(least, 0.08);
    double deg = 0, bend = 0;
    while (deg < 180 && turned_distance(all, (deg + 0.5) / 5, 0) <= calm)
        deg += 0.5;
    while (bend < 20 && turned_distance(all, (bend + 0.5) / 5, 0) <= least)
        bend += 0.5;
    f->rotation = fmin(fmax(deg, 1), 180) * TZ_PI / 180;
    f->bend = fmax(bend * TZ_PI / 180 - f->rotation, 0);
    f->mirror_x = turned_distance(all, 0, 1) <= 1.5 * natural;
    f->mirror_y = turned_distance(all, 0, 2) <= 1.5 * natural;
    return TZ_OK;
}
