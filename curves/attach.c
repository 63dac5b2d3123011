/* SPDX-License-Identifier: Apache-2.0 */
/* Lines are looked up by points along them; the nearest is refined on its cubic. An element
 * that sits at the free end of a line looks for ends, all others for lines. */
#include "curves/attach.h"

#include <string.h>

#include "base/grid.h"
#include "curves/sample_graph.h"

typedef struct line_point {
    int32_t piece;
    double t;
    bool loose[2]; /* its piece begins, or ends, at a free end */
} line_point;

typedef struct lines {
    const tz_curve_set *set;
    double spacing, width; /* of points; the widest pen */
    TZ_ARRAY(line_point)
    point;
    tz_grid grid;
} lines;

/* A place on a line: the tangent is of length 1, at an end it points outwards. */
typedef struct place {
    tz_vec2 at, tangent;
    double distance, width;
    bool end, found;
} place;

/* ---- lines --------------------------------------------------------------------------- */

static tz_status add_piece(tz_ctx *ctx, lines *l, int32_t piece, bool first, bool last)
{
    const tz_bezier b = tz_curve_bezier(l->set, &l->set->piece.v[piece]);
    const double n = fmin(ceil(tz_bezier_length(&b) / l->spacing), 4096);
    const int32_t steps = n < 1 ? 1 : (int32_t)n;
    int32_t id;
    tz_status s = TZ_OK;
    for (int32_t k = 0; k <= steps && s == TZ_OK; k++) {
        const double t = (double)k / steps;
        const tz_vec2 p = tz_bezier_at(&b, t);
        const tz_vec3 in = tz_domain_wrap(&l->set->domain, (tz_vec3){p.x, p.y, 0});
        s = tz_array_push(ctx, &l->point, ((line_point){piece, t, {first, last}}));
        if (s == TZ_OK)
            s = tz_grid_add(ctx, &l->grid, (tz_vec2){in.x, in.y}, &id);
    }
    return s;
}

static tz_status lines_init(tz_ctx *ctx, const tz_curve_set *s, double spacing, lines *l)
{
    const tz_domain *d = &s->domain;
    int32_t *degree = NULL;
    *l = (lines){.set = s, .spacing = spacing};
    for (int32_t i = 0; i < s->pen.n; i++)
        l->width = fmax(l->width, s->pen.v[i].width);
    tz_status st = tz_alloc_zero(ctx, &degree, (size_t)s->node.n, sizeof *degree);
    if (st == TZ_OK)
        st =
            tz_grid_init(ctx, &l->grid, (tz_vec2){0, 0}, (tz_vec2){d->size.x, d->size.y},
                         fmax(2 * spacing, hypot(d->size.x, d->size.y) / 4000), d->torus);
    for (int32_t i = 0; i < s->piece.n && st == TZ_OK; i++) {
        degree[s->piece.v[i].from]++;
        degree[s->piece.v[i].to]++;
    }
    for (int32_t i = 0; i < s->piece.n && st == TZ_OK; i++)
        st = add_piece(ctx, l, i, degree[s->piece.v[i].from] == 1,
                       degree[s->piece.v[i].to] == 1);
    tz_free(ctx, degree);
    return st;
}

static void lines_deinit(tz_ctx *ctx, lines *l)
{
    tz_array_free(ctx, &l->point);
    tz_grid_deinit(ctx, &l->grid);
}

/* Newton from t towards the nearest place of a cubic. */
static double nearest_t(const tz_bezier *b, tz_vec2 p, double t)
{
    for (int k = 0; k < 6; k++) {
        const tz_vec2 e = tz_vec2_sub(tz_bezier_at(b, t), p), d = tz_bezier_slope(b, t);
        const double n = tz_vec2_dot(d, d);
        if (!(n > 0))
            break;
        t = fmin(fmax(t - tz_vec2_dot(e, d) / n, 0), 1);
    }
    return t;
}

static tz_vec2 unit(tz_vec2 v)
{
    const double n = tz_vec2_length(v);
    return n > 0 ? tz_vec2_scale(v, 1 / n) : (tz_vec2){1, 0};
}

static bool is_end(const line_point *p, double t)
{
    return (p->loose[0] && t < 1e-6) || (p->loose[1] && t > 1 - 1e-6);
}

/* The place of a line nearest to p within reach; only ends if `ends`. */
static place nearest_place(const lines *l, tz_vec2 p, double reach, bool ends)
{
    enum { MOST = 2048 };
    const tz_curve_set *s = l->set;
    int32_t id[MOST];
    place best = {.distance = reach};
    const tz_vec3 in = tz_domain_wrap(&s->domain, (tz_vec3){p.x, p.y, 0});
    const int32_t n =
        tz_grid_query(&l->grid, (tz_vec2){in.x, in.y}, reach + l->spacing, id, MOST);
    for (int32_t i = 0; i < n && i < MOST; i++) {
        const line_point *q = &l->point.v[id[i]];
        if (ends && !is_end(q, q->t))
            continue;
        const tz_bezier b = tz_curve_bezier(s, &s->piece.v[q->piece]);
        const tz_vec2 rough = tz_bezier_at(&b, q->t),
                      by = tz_vec2_sub(tz_curve_copy(&s->domain, rough, p), rough),
                      here = tz_vec2_sub(p, by);
        const double t = ends ? q->t : nearest_t(&b, here, q->t);
        const tz_vec2 at = tz_bezier_at(&b, t);
        const double d = tz_vec2_length(tz_vec2_sub(at, here));
        if (!(d < best.distance))
            continue;
        const bool at_end = is_end(q, t);
        tz_vec2 u = tz_bezier_slope(&b, fmin(fmax(t, 1e-6), 1 - 1e-6));
        if (at_end && t < 0.5)
            u = tz_vec2_scale(u, -1);
        best = (place){.at = tz_vec2_add(at, by),
                       .tangent = unit(u),
                       .distance = d,
                       .end = at_end,
                       .found = true};
    }
    return best;
}

static double cross(tz_vec2 u, tz_vec2 v) { return u.x * v.y - u.y * v.x; }

/* ---- seats --------------------------------------------------------------------------- */

static double finest(const tz_curve_set *s)
{
    const tz_sample_levels l = tz_sample_levels_default(s);
    return l.spacing[l.levels - 1];
}

tz_status tz_curve_seats(tz_ctx *ctx, const tz_curve_set *s, tz_curve_seat **seat)
{
    lines l = {0};
    tz_curve_seat *out = NULL;
    tz_status st = lines_init(ctx, s, finest(s) / 8, &l);
    if (st == TZ_OK)
        st = tz_alloc_zero(ctx, &out, (size_t)s->element.element.n, sizeof *out);
    for (int32_t i = 0; i < s->element.element.n && st == TZ_OK; i++) {
        const tz_element *e = &s->element.element.v[i];
        const tz_vec2 at = {e->at.x, e->at.y};
        const place p = nearest_place(&l, at, e->radius + l.width / 2, false);
        const tz_vec2 v = tz_vec2_sub(at, p.at);
        if (p.found)
            out[i] = (tz_curve_seat){.sits = true,
                                     .at_end = p.end,
                                     .along = tz_vec2_dot(p.tangent, v),
                                     .across = cross(p.tangent, v),
                                     .angle = atan2(p.tangent.y, p.tangent.x)};
    }
    lines_deinit(ctx, &l);
    if (st == TZ_OK)
        *seat = out;
    else
        tz_free(ctx, out);
    return st;
}

/* ---- putting them ---------------------------------------------------------------------- */

static void turn_element(tz_element_set *set, tz_element *e, tz_vec2 to, double by)
{
    const tz_vec2 from = {e->at.x, e->at.y};
    const double c = cos(by), s = sin(by);
    const tz_vec3 in = tz_domain_wrap(&set->domain, (tz_vec3){to.x, to.y, e->at.z});
    for (int32_t k = e->sample; k < e->sample + e->samples; k++) {
        tz_vec3 *p = &set->sample.v[k].at;
        const double x = p->x - from.x, y = p->y - from.y;
        p->x = in.x + c * x - s * y;
        p->y = in.y + s * x + c * y;
    }
    e->at.x = in.x;
    e->at.y = in.y;
    e->angle += by;
}

/* The element to the nearest line, as its source sits; false if there is none. */
static bool seat_element(const lines *l, const tz_element_set *exemplar,
                         const tz_curve_seat *seat, double reach, tz_element_set *set,
                         tz_element *e)
{
    const tz_element *source = &exemplar->element.v[e->source];
    const double turned = e->angle - source->angle, scale = e->scale / source->scale;
    const double a = seat->angle + turned; /* of the line, if it had gone along */
    const tz_vec2 u = {cos(a), sin(a)};
    const tz_vec2 seat_at = {e->at.x - scale * (seat->along * u.x - seat->across * u.y),
                             e->at.y - scale * (seat->along * u.y + seat->across * u.x)};
    place p = {0};
    if (seat->at_end)
        p = nearest_place(l, seat_at, reach, true);
    if (!p.found)
        p = nearest_place(l, seat_at, reach, false);
    if (!p.found)
        return false;
    /* a line has no direction: the one nearer to what it was; an end has */
    if (!(seat->at_end && p.end) && tz_vec2_dot(p.tangent, u) < 0)
        p.tangent = tz_vec2_scale(p.tangent, -1);
    const tz_vec2 t = p.tangent;
    const tz_vec2 to = {p.at.x + scale * (seat->along * t.x - seat->across * t.y),
                        p.at.y + scale * (seat->along * t.y + seat->across * t.x)};
    turn_element(set, e, to, atan2(cross(u, t), tz_vec2_dot(u, t)));
    return true;
}

tz_status tz_curve_attach(tz_ctx *ctx, const tz_curve_set *exemplar, double reach,
                          tz_curve_set *set, int32_t *moved)
{
    lines l = {0};
    tz_curve_seat *seat = NULL;
    const double delta = finest(exemplar);
    int32_t count = 0;
    if (moved)
        *moved = 0;
    if (!(reach >= 0) || !isfinite(reach))
        return tz_fail(ctx, TZ_INVALID, "a reach of %g cannot be; give a length", reach);
    for (int32_t i = 0; i < set->element.element.n; i++)
        if (set->element.element.v[i].source < -1 ||
            set->element.element.v[i].source >= exemplar->element.element.n)
            return tz_fail(ctx, TZ_INVALID,
                           "element %d copies element %d, which the exemplar has not", i,
                           set->element.element.v[i].source);
    if (set->element.element.n == 0 || set->path.n == 0 || exemplar->path.n == 0)
        return TZ_OK;
    tz_status s = tz_curve_seats(ctx, exemplar, &seat);
    if (s == TZ_OK)
        s = lines_init(ctx, set, delta / 8, &l);
    for (int32_t i = 0; i < set->element.element.n && s == TZ_OK; i++) {
        tz_element *e = &set->element.element.v[i];
        if (e->source >= 0 && !e->fixed && seat[e->source].sits)
            count += seat_element(&l, &exemplar->element, &seat[e->source],
                                  reach > 0 ? reach : delta / 2, &set->element, e);
    }
    if (s == TZ_OK && moved)
        *moved = count;
    lines_deinit(ctx, &l);
    tz_free(ctx, seat);
    return s;
}
