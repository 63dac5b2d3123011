/* SPDX-License-Identifier: Apache-2.0 */
/* Holes: discs between the shapes that are wider than the exemplar's widest.
 *
 * Growth decides places by what units show, and where two fronts meet badly neither has
 * anything that fits: a hole is left. When all is grown the output is searched for them. In
 * each, at its widest place, what fits best is placed, however badly it matches; if there
 * is nothing, or the output is too dense already, the neighbours close in on it. */
#include <math.h>
#include <string.h>

#include "elements/element_statistics.h"
#include "elements/growth_internal.h"

enum { DRAWS = 48, CLIMBS = 10, PULLS = 3 };

/* Discs this much wider than the exemplar's widest are holes; they are looked for at a step
 * of this many spacings, and from places this much narrower. */
static const double wide = 1.02, step = 0.33, narrower = 0.12;
/* Error of density from which on nothing is added. */
static const float dense = 0.03F;
/* Farthest that a neighbour is pulled at once, spacings. */
static const double farthest = 0.15;

/* ---- of the exemplar ----------------------------------------------------------------- */

static void drop_others(tz_field *f, uint64_t kinds)
{
    int32_t n = 0;
    for (int32_t i = 0; i < f->n; i++)
        if (kinds == 0 || f->item[i].kind >= 64 || (kinds >> f->item[i].kind & 1)) {
            f->at[n] = f->at[i];
            f->item[n++] = f->item[i];
        }
    f->n = n;
}

tz_status tz_growth_find_hole(tz_ctx *ctx, tz_growth_exemplar *ex)
{
    const tz_vec3 size = ex->set->domain.size;
    const double scale = ex->texture.scale;
    const tz_vec2 from = {ex->origin.x / size.x, ex->origin.y / size.y},
                  to = {from.x + ex->size.x / scale / size.x,
                        from.y + ex->size.y / scale / size.y};
    tz_field f = {0};
    double hole = 0;
    tz_status s = tz_field_init(ctx, &f, ex->set, from, to);
    if (s == TZ_OK) {
        drop_others(&f, ex->texture.kinds);
        f.domain.torus = ex->torus;
        s = tz_field_hole(&f, &hole);
    }
    tz_field_deinit(&f);
    ex->hole = fmax(ex->hole, scale * hole);
    return s;
}

/* ---- of the output ------------------------------------------------------------------- */

/* A place, offset from the one that a view is of. */
typedef struct place {
    float x, y;
} place;

static bool is_disc(const tz_growth_exemplar *ex, const tz_growth_seen *o)
{
    return o->symbol < 0 || o->symbol >= ex->extents->n || ex->disc[o->symbol];
}

/* Distance from a place to the ends of a body's rays, if less than `most`. */
static float to_rays(const tz_growth_exemplar *ex, const tz_growth_seen *o, place p,
                     float most)
{
    enum { N = TZ_EXTENT_DIRECTIONS };
    const float *ray = ex->extents->v[o->symbol].r;
    const float turn_c = (float)cos(2 * TZ_PI / N), turn_s = (float)sin(2 * TZ_PI / N);
    const float ox = o->x - p.x, oy = o->y - p.y;
    float c = o->r * cosf(o->angle), s = o->r * sinf(o->angle), least = most * most;
    for (int32_t k = 0; k < N; k++) {
        const float x = ox + ray[k] * c, y = oy + ray[k] * s;
        const float next = turn_c * c - turn_s * s;
        least = fminf(least, x * x + y * y);
        s = turn_s * c + turn_c * s, c = next;
    }
    return sqrtf(least);
}

/* From a place to an element's outline along the line between them. */
static float gap_to(const tz_growth_exemplar *ex, const tz_growth_seen *o, place p)
{
    const tz_growth_body b = {o->r, o->angle, o->hard, o->symbol};
    const float x = p.x - o->x, y = p.y - o->y, d = sqrtf(x * x + y * y);
    return d - (is_disc(ex, o) ? o->r : tz_growth_extent(ex, &b, atan2f(y, x)));
}

/* Radius of the disc about a place that touches no outline of a view's elements; less than
 * `enough` is not measured in full. */
static float room_in(const tz_growth *g, const tz_growth_view *view, place p,
                     float enough, float most)
{
    const tz_growth_exemplar *ex = &g->ex[0];
    for (int32_t i = 0; i < view->n && most >= enough; i++) {
        const tz_growth_seen *o = &view->v[i];
        const float x = o->x - p.x, y = o->y - p.y, reach = most + o->r;
        if (x * x + y * y < reach * reach)
            most = fminf(most, gap_to(ex, o, p));
    }
    for (int32_t i = 0; i < view->n && most >= enough; i++) {
        const tz_growth_seen *o = &view->v[i];
        const float x = o->x - p.x, y = o->y - p.y, reach = most + o->r;
        if (!is_disc(ex, o) && x * x + y * y < reach * reach)
            most = to_rays(ex, o, p, most);
    }
    return most;
}

/* Elements whose outlines lie within a distance; voids are none. */
static void look(const tz_growth *g, double x, double y, double radius,
                 tz_growth_view *view)
{
    int32_t n = 0;
    tz_growth_look(g, x, y, radius, -1, view);
    for (int32_t i = 0; i < view->n; i++)
        if (g->spot.v[view->v[i].spot].out >= 0)
            view->v[n++] = view->v[i];
    view->n = n;
}

/* In units of the local frame. */
static float depth_at(const tz_growth *g, double x, double y)
{
    const tz_domain *d = &g->out->domain;
    const tz_vec3 at = tz_domain_wrap(d, (tz_vec3){x, y, 0});
    return (float)fmin(1e30, tz_domain_depth(d, at) / tz_domain_apart(d, at));
}

/* From a place to the widest one near it. */
static float climb(const tz_growth *g, double *x, double *y, double spacing, double most)
{
    tz_growth_view view;
    place at = {0, 0};
    float length = 0.2F * (float)spacing;
    look(g, *x, *y, most + 0.8 * spacing, &view);
    float room = room_in(g, &view, at, 0, fminf((float)most, depth_at(g, *x, *y)));
    for (int32_t k = 0; k < CLIMBS && hypotf(at.x, at.y) < 0.6F * (float)spacing; k++) {
        place best = at;
        const float before = room;
        for (int32_t i = 0; i < 6; i++) {
            const float turn = (float)i * (float)(TZ_PI / 3);
            const place p = {at.x + length * cosf(turn), at.y + length * sinf(turn)};
            const tz_vec2 v = tz_growth_out(&view, p.x, p.y);
            const float r = room_in(g, &view, p, room,
                                    fminf((float)most, depth_at(g, *x + v.x, *y + v.y)));
            if (r > room)
                room = r, best = p;
        }
        if (room == before)
            length *= 0.5F;
        at = best;
    }
    const tz_vec2 v = tz_growth_out(&view, at.x, at.y);
    *x += v.x, *y += v.y;
    return room;
}

/* ---- filling them -------------------------------------------------------------------- */

/* The unit that fits best at the place of a view, -1 = none. */
static int32_t best_unit(const tz_growth *g, int32_t texture, tz_vec3 at,
                         const tz_growth_view *solid, const tz_growth_view *view)
{
    const tz_growth_exemplar *ex = &g->ex[texture];
    tz_rng r = tz_rng_make(g->params.seed, tz_rng_stream('h', (uint64_t)g->closed, 0));
    const int32_t from = tz_rng_below(&r, ex->elements);
    const int32_t draws = ex->elements < DRAWS ? ex->elements : DRAWS;
    int32_t best = -1;
    float least = INFINITY;
    for (int32_t k = 0; k < draws; k++) {
        const int32_t unit =
            (int32_t)((from + (int64_t)k * ex->elements / draws) % ex->elements);
        const tz_growth_unit *u = &ex->unit[unit];
        uint64_t used;
        if (!u->copied || !tz_growth_may_stand(g, texture, u, at.x, at.y) ||
            !tz_growth_fits(ex, u, 0, 0, solid))
            continue;
        const float cost = (0.1F + tz_growth_cost(ex, unit, view, INFINITY, &used)) *
                           powf(1 + tz_growth_surplus(g, texture, u->class), 4);
        if (cost < least)
            least = cost, best = unit;
    }
    return best;
}

/* What stands about a place moves towards it as far as it may. */
static void pull_in(tz_growth *g, int32_t texture, double x, double y, double hole)
{
    const double spacing = g->ex[texture].spacing;
    const place at = {0, 0};
    tz_growth_view view;
    for (int32_t round = 0; round < PULLS; round++) {
        look(g, x, y, 2 * hole + 0.5 * spacing, &view);
        const double room =
            (double)room_in(g, &view, at, 0, (float)(2 * hole + 0.5 * spacing));
        if (room <= hole)
            return;
        for (int32_t i = 0; i < view.n; i++) {
            const tz_growth_seen *o = &view.v[i];
            const double gap = (double)gap_to(&g->ex[0], o, at);
            const double by = fmin(farthest * spacing, gap - 0.9 * hole) /
                              fmax((double)hypotf(o->x, o->y), 1e-9);
            if (by <= 0 || gap > room + 0.5 * spacing)
                continue;
            const tz_vec2 v = tz_growth_out(&view, o->x, o->y);
            tz_growth_move(g, o->spot, -by * v.x, -by * v.y);
        }
    }
}

/* @param[out] placed  whether something was */
static tz_status fill(tz_growth *g, int32_t texture, double x, double y, double hole,
                      bool *placed)
{
    const tz_growth_exemplar *ex = &g->ex[texture];
    const tz_vec3 at = tz_domain_wrap(&g->out->domain, (tz_vec3){x, y, 0});
    tz_growth_view view, solid;
    int32_t best = -1;
    tz_growth_look(g, at.x, at.y, fmax(g->wide, ex->spacing), -1, &view);
    look(g, at.x, at.y, fmax(g->wide, ex->spacing), &solid);
    if (tz_growth_error(g, texture) < dense)
        best = best_unit(g, texture, at, &solid, &view);
    *placed = best >= 0;
    if (best < 0) {
        pull_in(g, texture, at.x, at.y, hole);
        return TZ_OK;
    }
    const int32_t shown = tz_growth_show(g, texture, best, at.x, at.y, &solid);
    return tz_growth_place(g, texture, best, shown, at.x, at.y, &view);
}

tz_status tz_growth_close_holes(tz_growth *g, bool *started)
{
    const tz_vec2 size = tz_vec2_sub(g->box_hi, g->box_lo);
    const double apart = step * g->spacing * g->least;
    const int32_t nx = (int32_t)fmin(16384, fmax(1, ceil(size.x / apart)));
    const int32_t ny = (int32_t)fmin(16384, fmax(1, ceil(size.y / apart)));
    tz_growth_view view;
    tz_status s = TZ_OK;
    *started = false;
    while (s == TZ_OK && !*started && g->closed < nx * ny) {
        const int32_t i = g->closed++;
        double x = g->box_lo.x + (i % nx + 0.5) * size.x / nx;
        double y = g->box_lo.y + ((double)(i / nx) + 0.5) * size.y / ny;
        const int32_t t = tz_growth_texture_at(g, x, y);
        if (t < 0)
            continue;
        const double spacing = g->ex[t].spacing, hole = wide * g->ex[t].hole;
        const double least = hole - narrower * spacing;
        if ((double)depth_at(g, x, y) < least)
            continue;
        look(g, x, y, least, &view);
        if ((double)room_in(g, &view, (place){0, 0}, (float)least, (float)hole) < least)
            continue;
        if ((double)climb(g, &x, &y, spacing, 2 * hole) >= hole &&
            tz_growth_texture_at(g, x, y) == t)
            s = fill(g, t, x, y, hole, started);
    }
    return s;
}
