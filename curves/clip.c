/* SPDX-License-Identifier: Apache-2.0 */
/* A piece is cut wherever it meets a line of the rectangle (between the turns of its
 * coordinates, where each rises or falls all the way, by halving) and where the distance to
 * the region's border changes its sign between steps; what lies between two cuts is kept or
 * not as its middle is. */
#include "curves/clip.h"

#include <stdlib.h>
#include <string.h>

#include "curves/curve_join_internal.h"

enum { MOST = 1024, HALVINGS = 50 };
#define TINY 1e-12 /* of t: between two cuts that are one */

typedef struct clipper {
    tz_ctx *ctx;
    const tz_curve_set *from;
    const tz_curve_window *window;
    tz_curve_set to;
    double step; /* user units */
    TZ_ARRAY(int32_t)
    node; /* per node of `from`: the same of `to`, or -1 */
    TZ_ARRAY(double)
    t; /* of the steps on a piece */
} clipper;

/* > 0: is kept. */
static double depth(const clipper *k, tz_vec2 p)
{
    const tz_curve_window *w = k->window;
    double d = INFINITY;
    const tz_vec3 in = tz_domain_wrap(&k->from->domain, (tz_vec3){p.x, p.y, 0});
    if (w->size.x > 0)
        d = fmin(fmin(in.x - w->at.x, w->at.x + w->size.x - in.x),
                 fmin(in.y - w->at.y, w->at.y + w->size.y - in.y));
    if (w->region)
        d = fmin(d, tz_region_distance(w->region, in));
    return w->outside ? -d : d;
}

static int up(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Where a cubic's coordinate p[0..3] turns. */
static tz_status add_turns(clipper *k, const double p[4])
{
    const double a = 3 * (p[3] - 3 * p[2] + 3 * p[1] - p[0]),
                 b = 6 * (p[2] - 2 * p[1] + p[0]), c = 3 * (p[1] - p[0]),
                 det = b * b - 4 * a * c;
    tz_status s = TZ_OK;
    if (det < 0)
        return TZ_OK;
    const double q = -0.5 * (b + copysign(sqrt(det), b));
    const double root[2] = {a != 0 ? q / a : NAN, q != 0 ? c / q : NAN};
    for (int i = 0; i < 2 && s == TZ_OK; i++)
        if (root[i] > 0 && root[i] < 1)
            s = tz_array_push(k->ctx, &k->t, root[i]);
    return s;
}

static double coordinate(const tz_bezier *b, int axis, double t)
{
    const tz_vec2 p = tz_bezier_at(b, t);
    return axis ? p.y : p.x;
}

/* Where a coordinate takes a value, between turns t[0 .. n - 1]. */
static tz_status add_crossings(clipper *k, const tz_bezier *b, int axis, double value,
                               const double *t, int32_t n)
{
    tz_status s = TZ_OK;
    for (int32_t i = 0; i + 1 < n && s == TZ_OK; i++) {
        double lo = t[i], hi = t[i + 1];
        const bool rises = coordinate(b, axis, lo) < value;
        if ((coordinate(b, axis, hi) < value) == rises)
            continue;
        for (int j = 0; j < HALVINGS; j++) {
            const double mid = (lo + hi) / 2;
            *((coordinate(b, axis, mid) < value) == rises ? &lo : &hi) = mid;
        }
        s = tz_array_push(k->ctx, &k->t, hi);
    }
    return s;
}

/* Cuts at the lines of the rectangle, on a torus at all copies of them. */
static tz_status cut_at_lines(clipper *k, const tz_bezier *b, int axis)
{
    enum { COPIES = 64 };
    const tz_domain *d = &k->from->domain;
    const tz_curve_window *w = k->window;
    const double at = axis ? w->at.y : w->at.x, size = axis ? w->size.y : w->size.x,
                 round = axis ? d->size.y : d->size.x;
    double p[4], lo = INFINITY, hi = -INFINITY, turn[4] = {0, 1, 1, 1};
    for (int i = 0; i < 4; i++) {
        p[i] = axis ? b->p[i].y : b->p[i].x;
        lo = fmin(lo, p[i]);
        hi = fmax(hi, p[i]);
    }
    const int32_t before = k->t.n;
    tz_status s = add_turns(k, p);
    const int32_t turns = k->t.n - before;
    if (turns == 2)
        turn[1] = fmin(k->t.v[before], k->t.v[before + 1]),
        turn[2] = fmax(k->t.v[before], k->t.v[before + 1]);
    else if (turns == 1)
        turn[1] = k->t.v[before];
    k->t.n = before;
    for (int side = 0; side < 2 && s == TZ_OK; side++) {
        const double line = at + side * size;
        const double m0 = d->torus ? fmax(floor((lo - line) / round), -COPIES) : 0,
                     m1 = d->torus ? fmin(ceil((hi - line) / round), COPIES) : 0;
        for (double m = m0; m <= m1 && s == TZ_OK; m++)
            s = add_crossings(k, b, axis, line + m * round, turn, 4);
    }
    /* the seam of a torus counts as a line: the window may reach over it in part */
    const double s0 = d->torus ? fmax(floor(lo / round), -COPIES) : 1,
                 s1 = d->torus ? fmin(ceil(hi / round), COPIES) : 0;
    for (double m = s0; m <= s1 && s == TZ_OK; m++)
        s = add_crossings(k, b, axis, m * round, turn, 4);
    return s;
}

static double region_depth(const clipper *k, tz_vec2 p)
{
    return tz_region_distance(k->window->region,
                              tz_domain_wrap(&k->from->domain, (tz_vec3){p.x, p.y, 0}));
}

static tz_status cut_at_region(clipper *k, const tz_bezier *b)
{
    const double n = ceil(tz_bezier_length(b) / k->step);
    const int32_t steps = n < 1 ? 1 : n > MOST ? MOST : (int32_t)n;
    double last = region_depth(k, b->p[0]);
    tz_status s = TZ_OK;
    for (int32_t i = 1; i <= steps && s == TZ_OK; i++) {
        double lo = (double)(i - 1) / steps, hi = (double)i / steps;
        const double here = region_depth(k, tz_bezier_at(b, hi));
        if ((last > 0) != (here > 0)) {
            for (int j = 0; j < HALVINGS; j++) {
                const double mid = (lo + hi) / 2;
                *((region_depth(k, tz_bezier_at(b, mid)) > 0) == (last > 0) ? &lo : &hi) =
                    mid;
            }
            s = tz_array_push(k->ctx, &k->t, hi);
        }
        last = here;
    }
    return s;
}

static tz_status make_cuts(clipper *k, const tz_bezier *b)
{
    k->t.n = 0;
    tz_status s = tz_array_push(k->ctx, &k->t, 0.0);
    if (s == TZ_OK)
        s = tz_array_push(k->ctx, &k->t, 1.0);
    for (int axis = 0; axis < 2 && s == TZ_OK && k->window->size.x > 0; axis++)
        s = cut_at_lines(k, b, axis);
    if (s == TZ_OK && k->window->region)
        s = cut_at_region(k, b);
    if (s == TZ_OK)
        qsort(k->t.v, (size_t)k->t.n, sizeof *k->t.v, up);
    return s;
}

/* Node of `to` at an end of a piece, or a new one at a cut. */
static tz_status node_at(clipper *k, int32_t old, tz_vec2 at, int32_t *node)
{
    if (old >= 0 && k->node.v[old] >= 0) {
        *node = k->node.v[old];
        return TZ_OK;
    }
    const tz_vec3 in = tz_domain_wrap(&k->from->domain, (tz_vec3){at.x, at.y, 0});
    const tz_status s = tz_curve_add_node(
        &k->to, old >= 0 ? k->from->node.v[old] : (tz_vec2){in.x, in.y}, node);
    if (s == TZ_OK && old >= 0)
        k->node.v[old] = *node;
    return s;
}

/* Appends the part t0 .. t1; `open` tells whether a path is being built. */
static tz_status keep(clipper *k, int32_t piece, int32_t pen, const double t[2],
                      bool *open)
{
    const tz_curve_piece *p = &k->from->piece.v[piece];
    const tz_bezier all = tz_curve_bezier(k->from, p),
                    part = tz_bezier_part(&all, t[0], t[1]);
    int32_t node[2];
    tz_status s = TZ_OK;
    if (*open && t[0] > 0) {
        tz_curve_end(&k->to, false);
        *open = false;
    }
    if (!*open)
        s = tz_curve_begin(&k->to, pen);
    *open = true;
    if (s == TZ_OK)
        s = node_at(k, t[0] <= 0 ? p->from : -1, part.p[0], &node[0]);
    if (s == TZ_OK)
        s = node_at(k, t[1] >= 1 ? p->to : -1, part.p[3], &node[1]);
    if (s != TZ_OK)
        return s;
    tz_curve_carry carry = tz_curve_carried(k->from, piece);
    tz_curve_piece c = *p;
    c.from = node[0];
    c.to = node[1];
    if (t[0] > 0 || t[1] < 1) {
        carry = tz_curve_carry_part(&carry, &all, t[0], t[1]);
        tz_curve_put(&k->to, &part, node, &c);
    }
    s = tz_curve_add_piece(&k->to, &c, &carry);
    if (t[1] < 1) {
        tz_curve_end(&k->to, false);
        *open = false;
    }
    return s;
}

static tz_status clip_piece(clipper *k, int32_t piece, int32_t pen, bool *open)
{
    const tz_bezier b = tz_curve_bezier(k->from, &k->from->piece.v[piece]);
    /* what runs along the border is inside */
    const double least =
        k->window->outside ? 0 : -TINY * (k->window->size.x + k->window->size.y);
    tz_status s = make_cuts(k, &b);
    double begin = -1; /* of the part that is being kept */
    for (int32_t i = 0; i + 1 < k->t.n && s == TZ_OK; i++) {
        const double t = k->t.v[i], next = k->t.v[i + 1];
        if (next - t < TINY)
            continue;
        const bool in = depth(k, tz_bezier_at(&b, (t + next) / 2)) > least;
        if (in && begin < 0)
            begin = t < TINY ? 0 : t;
        if (!in && begin >= 0) {
            s = keep(k, piece, pen, (double[2]){begin, t}, open);
            begin = -1;
        }
    }
    if (s == TZ_OK && begin >= 0)
        return keep(k, piece, pen, (double[2]){begin, 1}, open);
    if (s == TZ_OK && *open) {
        tz_curve_end(&k->to, false);
        *open = false;
    }
    return s;
}

static tz_status clip_path(clipper *k, const tz_curve_path *p)
{
    const int32_t pieces = k->to.piece.n, paths = k->to.path.n;
    bool open = false;
    tz_status s = TZ_OK;
    for (int32_t i = p->piece; i < p->piece + p->pieces && s == TZ_OK; i++)
        s = clip_piece(k, i, p->pen, &open);
    if (s == TZ_OK && open)
        tz_curve_end(&k->to, p->closed && k->to.piece.n - pieces == p->pieces &&
                                 k->to.path.n - paths == 1);
    return s;
}

/* Elements whose centres are inside, as they are. */
static tz_status clip_elements(clipper *k)
{
    const tz_element_set *e = &k->from->element;
    tz_element_set *to = &k->to.element;
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < e->element.n && s == TZ_OK; i++) {
        tz_element c = e->element.v[i];
        if (!(depth(k, (tz_vec2){c.at.x, c.at.y}) > 0))
            continue;
        const int32_t first = c.sample;
        c.sample = to->sample.n;
        for (int32_t j = 0; j < c.samples && s == TZ_OK; j++)
            s = tz_array_push(k->ctx, &to->sample, e->sample.v[first + j]);
        if (s == TZ_OK)
            s = tz_array_push(k->ctx, &to->element, c);
    }
    return s;
}

tz_status tz_curve_clip(tz_ctx *ctx, const tz_curve_set *from,
                        const tz_curve_window *window, tz_curve_set *to)
{
    const tz_vec3 size = from->domain.size;
    const tz_vec2 s2 = window->size;
    clipper k = {.ctx = ctx, .from = from, .window = window, .to = {.ctx = ctx}};
    const tz_curve_join_params join = {.only_chain = true};
    memset(to, 0, sizeof *to);
    if (!(s2.x >= 0 && s2.y >= 0 && isfinite(s2.x) && isfinite(s2.y) &&
          isfinite(window->at.x) && isfinite(window->at.y)) ||
        (s2.x > 0) != (s2.y > 0))
        return tz_fail(ctx, TZ_INVALID,
                       "a window of %g x %g keeps nothing; give one with an area", s2.x,
                       s2.y);
    k.step = window->region ? fmin(size.x, size.y) / 64 : hypot(size.x, size.y);
    tz_status s = tz_curve_set_like(ctx, from, NULL, &k.to);
    for (int32_t i = 0; i < from->node.n && s == TZ_OK; i++)
        s = tz_array_push(ctx, &k.node, -1);
    for (int32_t i = 0; i < from->path.n && s == TZ_OK; i++) {
        s = clip_path(&k, &from->path.v[i]);
        if (s == TZ_OK && !(i & 1023) && tz_ctx_cancelled(ctx))
            s = TZ_CANCELLED;
    }
    tz_curve_set raw = k.to;
    if (s == TZ_OK) { /* a closed path that was cut is one from cut to cut */
        s = tz_curve_join(ctx, &raw, &join, to);
        k.to = *to;
        if (s == TZ_OK)
            s = clip_elements(&k);
        *to = k.to;
    }
    if (s == TZ_OK && from->recipe)
        s = tz_strdup(ctx, from->recipe, &to->recipe);
    tz_curve_set_deinit(&raw);
    tz_array_free(ctx, &k.node);
    tz_array_free(ctx, &k.t);
    if (s != TZ_OK) {
        to->ctx = ctx;
        tz_curve_set_deinit(to);
        memset(to, 0, sizeof *to);
    }
    return s;
}
