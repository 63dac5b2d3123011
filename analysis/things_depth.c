/* SPDX-License-Identifier: Apache-2.0 */
/* Where two things meet, the border belongs to the upper one. Two signs of it:
 *
 *   T-junction   at both ends of the common border the outline of the upper one runs
 *                straight on, that of the lower one turns off into the border;
 *   bulge        the border bends towards the lower one: things are mostly convex.
 *
 *     vote(a above b) = s_a - s_b,  s = bulge / 0.15 - turn / (pi / 2)
 *
 * with the outward height of the border over its chord, and the mean turn at its ends.
 * Votes of all neighbours become heights h by least squares, h_a - h_b = vote (clamped to
 * +-1, weak ones to 0), so that contradictions in a ring are shared out; heights are
 * rounded to layers.
 *
 * Hidden parts: an ellipse is fitted to what is visible of a covered thing's own outline.
 * It is believed where it passes close by and is not much larger than what is seen. */
#include "analysis/things_depth.h"

#include <math.h>
#include <stdlib.h>

#include "elements/element_shape.h"

enum { SWEEPS = 60, REACH = 5, GROUND = -1, FRAME = -2, ROUND = 48 };

#define WEAK   0.35
#define LAYER  0.5
#define HIDDEN (1 / 3.0) /* largest share of a thing that is completed */

typedef struct vote {
    int32_t a, b; /* a < b */
    double up;    /* > 0: a lies above b */
} vote;

typedef struct work {
    tz_ctx *ctx;
    const int32_t *label;
    int32_t width, height;
    tz_things_found *found;
    int32_t count;
    TZ_ARRAY(vote)
    votes;
    double *height_of;
    int32_t *side; /* neighbour at each point of an outline */
    int32_t room;
    TZ_ARRAY(tz_vec2)
    seen; /* points of an outline that is the thing's own */
} work;

static int32_t outer_points(const tz_things_outline *o)
{
    return o->part.n > 1 ? o->part.v[1] : o->point.n;
}

static int32_t around(int32_t i, int32_t n) { return i < 0 ? i + n : i < n ? i : i - n; }

/* ---- neighbours ---------------------------------------------------------------------- */

/* What lies outside of point k: a thing within 4 px, the frame, or ground. */
static int32_t neighbour(const work *w, int32_t id, const tz_vec2 *v, int32_t n,
                         int32_t k)
{
    const tz_vec2 d = tz_vec2_sub(v[around(k + 2, n)], v[around(k - 2, n)]);
    const double l = fmax(tz_vec2_length(d), 1e-9);
    for (int32_t step = 1; step <= 4; step++) {
        const double x = v[k].x + step * d.y / l, y = v[k].y - step * d.x / l;
        if (!(x >= 0 && y >= 0 && x < w->width && y < w->height))
            return step <= 2 ? FRAME : GROUND;
        const int32_t other = w->label[(ptrdiff_t)y * w->width + (ptrdiff_t)x];
        if (other >= 0 && other != id)
            return other;
    }
    return GROUND;
}

static tz_status find_sides(work *w, int32_t id)
{
    const tz_things_outline *o = &w->found[id].outline;
    const int32_t n = outer_points(o);
    if (n > w->room) {
        const tz_status s = tz_realloc(w->ctx, &w->side, 2 * (size_t)n, sizeof *w->side);
        if (s != TZ_OK)
            return s;
        w->room = 2 * n;
    }
    for (int32_t k = 0; k < n; k++)
        w->side[k] = neighbour(w, id, o->point.v, n, k);
    for (int32_t k = 0; k < n; k++) /* single points follow those before them */
        if (w->side[k] != w->side[around(k - 1, n)] &&
            w->side[k] != w->side[around(k + 1, n)])
            w->side[k] = w->side[around(k - 1, n)];
    return TZ_OK;
}

/* ---- votes --------------------------------------------------------------------------- */

/* Turn of the outline at point k, > 0 where it is convex. */
static double turn_at(const tz_vec2 *v, int32_t n, int32_t k)
{
    const int32_t r = REACH < n / 4 ? REACH : n / 4;
    const tz_vec2 a = tz_vec2_sub(v[k], v[around(k - r, n)]),
                  b = tz_vec2_sub(v[around(k + r, n)], v[k]);
    return atan2(a.x * b.y - a.y * b.x, tz_vec2_dot(a, b));
}

/* Sign of points first .. first + length - 1, which lie on one neighbour. */
static double sign_of(const work *w, const tz_vec2 *v, int32_t n, int32_t first,
                      int32_t length)
{
    const int32_t last = around(first + length - 1, n);
    const tz_vec2 a = v[first], b = v[last], m = v[around(first + length / 2, n)];
    const tz_vec2 chord = tz_vec2_sub(b, a), to = tz_vec2_sub(m, a);
    const double l = fmax(tz_vec2_length(chord), 1);
    /* the inside is at the right hand: outward is to the left */
    const double bulge = (to.x * chord.y - to.y * chord.x) / (l * l);
    double turn = 0;
    int32_t ends = 0;
    if (w->side[around(first - 1, n)] != FRAME)
        turn += turn_at(v, n, first), ends++;
    if (w->side[around(last + 1, n)] != FRAME)
        turn += turn_at(v, n, last), ends++;
    return fmax(-1, fmin(1, bulge / 0.15)) - (ends ? turn / ends / (0.5 * TZ_PI) : 0);
}

static tz_status vote_of(work *w, int32_t id)
{
    const tz_things_outline *o = &w->found[id].outline;
    const int32_t n = outer_points(o);
    int32_t start = 0;
    tz_status s = find_sides(w, id);
    while (start < n && w->side[start] == w->side[around(start - 1, n)])
        start++;
    for (int32_t i = 0, length; i < n && s == TZ_OK; i += length) {
        const int32_t first = around(start + i, n), other = w->side[first];
        for (length = 1; i + length < n && w->side[around(first + length, n)] == other;)
            length++;
        if (other < 0 || length < REACH || start == n)
            continue;
        const double up = sign_of(w, o->point.v, n, first, length);
        const vote one = id < other ? (vote){id, other, up} : (vote){other, id, -up};
        s = tz_array_push(w->ctx, &w->votes, one);
    }
    return s;
}

static int by_pair(const void *p, const void *q)
{
    const vote *a = p, *b = q;
    if (a->a != b->a)
        return a->a < b->a ? -1 : 1;
    if (a->b != b->b)
        return a->b < b->b ? -1 : 1;
    return (a->up > b->up) - (a->up < b->up);
}

static void join_votes(work *w)
{
    int32_t n = 0;
    if (w->votes.n > 0)
        qsort(w->votes.v, (size_t)w->votes.n, sizeof *w->votes.v, by_pair);
    for (int32_t i = 0; i < w->votes.n; i++) {
        const vote e = w->votes.v[i];
        if (n > 0 && w->votes.v[n - 1].a == e.a && w->votes.v[n - 1].b == e.b)
            w->votes.v[n - 1].up += e.up;
        else
            w->votes.v[n++] = e;
    }
    w->votes.n = n;
    for (int32_t i = 0; i < n; i++) {
        double *up = &w->votes.v[i].up;
        *up = fabs(*up) < WEAK ? 0 : fmax(-1, fmin(1, *up));
    }
}

/* ---- heights ------------------------------------------------------------------------- */

/* Each height becomes what its neighbours want; Jacobi with half a step, in one order. */
static tz_status solve(work *w)
{
    double *sum = NULL;
    int32_t *count = NULL;
    tz_status s = tz_alloc_zero(w->ctx, &sum, (size_t)w->count + 1, sizeof *sum);
    if (s == TZ_OK)
        s = tz_alloc_zero(w->ctx, &count, (size_t)w->count + 1, sizeof *count);
    for (int32_t k = 0; k < SWEEPS && s == TZ_OK; k++) {
        for (int32_t i = 0; i < w->count; i++)
            sum[i] = count[i] = 0;
        for (int32_t i = 0; i < w->votes.n; i++) {
            const vote *e = &w->votes.v[i];
            sum[e->a] += w->height_of[e->b] + e->up;
            sum[e->b] += w->height_of[e->a] - e->up;
            count[e->a]++;
            count[e->b]++;
        }
        for (int32_t i = 0; i < w->count; i++)
            if (count[i])
                w->height_of[i] = 0.5 * (w->height_of[i] + sum[i] / count[i]);
    }
    tz_free(w->ctx, sum);
    tz_free(w->ctx, count);
    return s;
}

static void set_depths(work *w)
{
    double lowest = INFINITY;
    for (int32_t i = 0; i < w->count; i++)
        lowest = fmin(lowest, w->height_of[i]);
    for (int32_t i = 0; i < w->count; i++)
        w->found[i].depth = (int32_t)((w->height_of[i] - lowest) / LAYER + 0.5);
}

/* ---- hidden parts -------------------------------------------------------------------- */

static double vote_between(const work *w, int32_t a, int32_t b)
{
    const vote key = {a < b ? a : b, a < b ? b : a, 0};
    int32_t lo = 0, hi = w->votes.n;
    while (lo < hi) {
        const int32_t mid = lo + (hi - lo) / 2;
        const vote *e = &w->votes.v[mid];
        if (e->a < key.a || (e->a == key.a && e->b < key.b))
            lo = mid + 1;
        else
            hi = mid;
    }
    if (lo == w->votes.n || w->votes.v[lo].a != key.a || w->votes.v[lo].b != key.b)
        return 0;
    return a < b ? w->votes.v[lo].up : -w->votes.v[lo].up;
}

/* Solves m x = y of 5 equations in place; false if they are not independent. */
static bool solve_five(double m[5][6])
{
    for (int i = 0; i < 5; i++) {
        int best = i;
        for (int k = i + 1; k < 5; k++)
            if (fabs(m[k][i]) > fabs(m[best][i]))
                best = k;
        if (fabs(m[best][i]) < 1e-9)
            return false;
        for (int j = 0; j < 6; j++) {
            const double t = m[i][j];
            m[i][j] = m[best][j];
            m[best][j] = t;
        }
        for (int k = 0; k < 5; k++)
            for (int j = 5; k != i && j >= i; j--)
                m[k][j] -= m[k][i] / m[i][i] * m[i][j];
    }
    for (int i = 0; i < 5; i++)
        m[i][5] /= m[i][i];
    return true;
}

typedef struct ellipse {
    tz_vec2 centre, long_axis, short_axis;
} ellipse;

/* The conic A x^2 + B x y + (1 - A) y^2 + D x + E y + F = 0 of least squares, about
 * `middle` in units of `unit`; false if it is no ellipse. */
static bool fit_ellipse(const tz_vec2 *v, int32_t n, tz_vec2 middle, double unit,
                        ellipse *out)
{
    double m[5][6] = {{0}};
    for (int32_t i = 0; i < n; i++) {
        const double x = (v[i].x - middle.x) / unit, y = (v[i].y - middle.y) / unit;
        const double row[6] = {x * x - y * y, x * y, x, y, 1, -y * y};
        for (int a = 0; a < 5; a++)
            for (int b = 0; b < 6; b++)
                m[a][b] += row[a] * row[b] / n;
    }
    if (!solve_five(m))
        return false;
    const double a = m[0][5], b = m[1][5], c = 1 - a, d = m[2][5], e = m[3][5],
                 f = m[4][5], det = 4 * a * c - b * b;
    if (!(det > 1e-3))
        return false;
    const double x = (b * e - 2 * c * d) / det, y = (b * d - 2 * a * e) / det;
    const double level = -(f + 0.5 * (d * x + e * y));
    const double mean = 0.5 * (a + c), half = hypot(0.5 * (a - c), 0.5 * b);
    if (!(level > 0) || !(mean - half > 0))
        return false;
    const double angle = 0.5 * atan2(-b, c - a); /* of the smaller eigenvalue */
    const double p = unit * sqrt(level / (mean - half)),
                 q = unit * sqrt(level / (mean + half));
    out->centre = (tz_vec2){middle.x + x * unit, middle.y + y * unit};
    out->long_axis = (tz_vec2){p * cos(angle), p * sin(angle)};
    out->short_axis = (tz_vec2){-q * sin(angle), q * cos(angle)};
    return true;
}

/* Root mean square of how far points lie from the ellipse, in shares of its radius. */
static double misfit(const ellipse *e, const tz_vec2 *v, int32_t n)
{
    const double p = tz_vec2_dot(e->long_axis, e->long_axis),
                 q = tz_vec2_dot(e->short_axis, e->short_axis);
    double sum = 0;
    for (int32_t i = 0; i < n; i++) {
        const tz_vec2 d = tz_vec2_sub(v[i], e->centre);
        const double r =
            hypot(tz_vec2_dot(d, e->long_axis) / p, tz_vec2_dot(d, e->short_axis) / q);
        sum += (r - 1) * (r - 1);
    }
    return sqrt(sum / n);
}

/* Appends the completed outline's points to w->seen, which holds what is the thing's own
 * of its outline; nothing where no ellipse is believed, or it is too much larger.
 * @param[in,out] hidden  share of the thing, where an ellipse fits */
static tz_status complete(work *w, const tz_moments *m, double *hidden)
{
    ellipse e;
    const int32_t n = w->seen.n;
    tz_status s = TZ_OK;
    if (n < 12 || !fit_ellipse(w->seen.v, n, m->centre, sqrt(m->area / TZ_PI), &e))
        return TZ_OK;
    const double area =
        TZ_PI * tz_vec2_length(e.long_axis) * tz_vec2_length(e.short_axis);
    if (area < m->area || misfit(&e, w->seen.v, n) > 0.1)
        return TZ_OK;
    *hidden = 1 - m->area / area;
    if (*hidden > HIDDEN)
        return TZ_OK;
    for (int32_t k = 0; k < ROUND && s == TZ_OK; k++) {
        const double t = 2 * TZ_PI * k / ROUND;
        s = tz_array_push(
            w->ctx, &w->seen,
            tz_vec2_add(e.centre, tz_vec2_add(tz_vec2_scale(e.long_axis, cos(t)),
                                              tz_vec2_scale(e.short_axis, sin(t)))));
    }
    return s;
}

static tz_status set_circle(work *w, int32_t id)
{
    tz_things_found *f = &w->found[id];
    const int32_t n = outer_points(&f->outline);
    const tz_polys polys = {{f->outline.point.v, n, 0}, {(int32_t[]){0}, 1, 0}, {0}};
    int32_t hidden = 0;
    tz_status s = find_sides(w, id);
    w->seen.n = 0;
    for (int32_t k = 0; k < n && s == TZ_OK; k++) {
        const int32_t other = w->side[k];
        if (other >= 0 && vote_between(w, id, other) < 0)
            hidden++;
        else if (other != FRAME)
            s = tz_array_push(w->ctx, &w->seen, f->outline.point.v[k]);
    }
    /* without an ellipse: a chord that cuts off as much of the circle */
    f->hidden = n > 0 ? pow((double)hidden / n, 2) : 0;
    if (s == TZ_OK && hidden * 20 > n && hidden * 3 < 2 * n) {
        const tz_moments m = tz_polys_moments(&polys);
        s = complete(w, &m, &f->hidden);
    }
    for (int32_t k = 0; k < n && s == TZ_OK; k++)
        s = tz_array_push(w->ctx, &w->seen, f->outline.point.v[k]);
    if (s == TZ_OK)
        f->radius = fmax(tz_smallest_circle(w->ctx, w->seen.v, w->seen.n, &f->at), 0.5);
    return s;
}

tz_status tz_things_order(tz_ctx *ctx, const int32_t *label, int32_t width,
                          int32_t height, tz_things_found *found, int32_t count)
{
    work w = {.ctx = ctx,
              .label = label,
              .width = width,
              .height = height,
              .found = found,
              .count = count};
    tz_status s =
        tz_alloc_zero(ctx, &w.height_of, (size_t)count + 1, sizeof *w.height_of);
    for (int32_t i = 0; i < count && s == TZ_OK; i++)
        s = vote_of(&w, i);
    if (s == TZ_OK) {
        join_votes(&w);
        s = solve(&w);
    }
    if (s == TZ_OK)
        set_depths(&w);
    for (int32_t i = 0; i < count && s == TZ_OK; i++)
        s = set_circle(&w, i);
    tz_free(ctx, w.height_of);
    tz_free(ctx, w.side);
    tz_array_free(ctx, &w.votes);
    tz_array_free(ctx, &w.seen);
    return s;
}
