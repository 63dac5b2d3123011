/* SPDX-License-Identifier: Apache-2.0 */
/* Cubics through many points. Corners are found first; between two corners one cubic is
 * tried, its handles by least squares, its parameters improved by Newton steps; where it
 * does not come near enough the points are split where it is worst.
 * @source Schneider: An algorithm for automatically fitting digitized curves, Graphics
 *   Gems, 1990 */
#include "curves/curve_fit_internal.h"

#include <string.h>

#define DEEPEST 40

typedef struct fitter {
    tz_curve_set *to;
    const tz_vec2 *p;
    double *t;
    double tolerance;
} fitter;

static tz_vec2 unit(tz_vec2 v)
{
    const double n = tz_vec2_length(v);
    return n > 0 ? tz_vec2_scale(v, 1 / n) : (tz_vec2){1, 0};
}

/* Direction in which points leave i, over a few of them. */
static tz_vec2 leave(const fitter *f, int32_t i, int32_t end)
{
    const int32_t step = end > i ? 1 : -1;
    int32_t k = i;
    while (k != end && tz_vec2_length(tz_vec2_sub(f->p[k], f->p[i])) < 6 * f->tolerance)
        k += step;
    return unit(tz_vec2_sub(f->p[k], f->p[i]));
}

static void by_chords(fitter *f, int32_t a, int32_t b)
{
    f->t[a] = 0;
    for (int32_t i = a + 1; i <= b; i++)
        f->t[i] = f->t[i - 1] + tz_vec2_length(tz_vec2_sub(f->p[i], f->p[i - 1]));
    for (int32_t i = a + 1; i <= b; i++)
        f->t[i] = f->t[b] > 0 ? f->t[i] / f->t[b] : 0;
}

/* Least squares of the two handle lengths. */
static tz_bezier solve(const fitter *f, int32_t a, int32_t b, tz_vec2 u, tz_vec2 v)
{
    const tz_vec2 p = f->p[a], q = f->p[b];
    const double chord = tz_vec2_length(tz_vec2_sub(q, p));
    double c00 = 0, c01 = 0, c11 = 0, x0 = 0, x1 = 0;
    for (int32_t i = a; i <= b; i++) {
        const double t = f->t[i], s = 1 - t;
        const double b0 = s * s * s, b1 = 3 * s * s * t, b2 = 3 * s * t * t,
                     b3 = t * t * t;
        const tz_vec2 d = tz_vec2_scale(u, b1), e = tz_vec2_scale(v, b2);
        const tz_vec2 r = {f->p[i].x - (b0 + b1) * p.x - (b2 + b3) * q.x,
                           f->p[i].y - (b0 + b1) * p.y - (b2 + b3) * q.y};
        c00 += tz_vec2_dot(d, d);
        c01 += tz_vec2_dot(d, e);
        c11 += tz_vec2_dot(e, e);
        x0 += tz_vec2_dot(d, r);
        x1 += tz_vec2_dot(e, r);
    }
    const double det = c00 * c11 - c01 * c01;
    double k = det > 1e-12 * c00 * c11 ? (x0 * c11 - x1 * c01) / det : 0;
    double m = det > 1e-12 * c00 * c11 ? (x1 * c00 - x0 * c01) / det : 0;
    if (!(k > 0.01 * chord && k < 3 * chord) || !(m > 0.01 * chord && m < 3 * chord))
        k = m = chord / 3;
    return (tz_bezier){
        {p, {p.x + k * u.x, p.y + k * u.y}, {q.x + m * v.x, q.y + m * v.y}, q}};
}

static double worst(const fitter *f, int32_t a, int32_t b, const tz_bezier *c,
                    int32_t *at)
{
    double most = 0;
    *at = (a + b) / 2;
    for (int32_t i = a + 1; i < b; i++) {
        const double d = tz_vec2_length(tz_vec2_sub(tz_bezier_at(c, f->t[i]), f->p[i]));
        if (d > most) {
            most = d;
            *at = i;
        }
    }
    return most;
}

static void improve(fitter *f, int32_t a, int32_t b, const tz_bezier *c)
{
    for (int32_t i = a + 1; i < b; i++) {
        const double t = f->t[i], s = 1 - t;
        const tz_vec2 e = tz_vec2_sub(tz_bezier_at(c, t), f->p[i]);
        const tz_vec2 d = tz_bezier_slope(c, t);
        const tz_vec2 g = {6 * (s * (c->p[2].x - 2 * c->p[1].x + c->p[0].x) +
                                t * (c->p[3].x - 2 * c->p[2].x + c->p[1].x)),
                           6 * (s * (c->p[2].y - 2 * c->p[1].y + c->p[0].y) +
                                t * (c->p[3].y - 2 * c->p[2].y + c->p[1].y))};
        const double slope = tz_vec2_dot(d, d) + tz_vec2_dot(e, g);
        if (slope > 0)
            f->t[i] = fmin(1, fmax(0, t - tz_vec2_dot(e, d) / slope));
    }
}

static double off_line(const fitter *f, int32_t a, int32_t b)
{
    const tz_vec2 d = unit(tz_vec2_sub(f->p[b], f->p[a]));
    double most = 0;
    for (int32_t i = a + 1; i < b; i++) {
        const tz_vec2 e = tz_vec2_sub(f->p[i], f->p[a]);
        most = fmax(most, fabs(d.x * e.y - d.y * e.x));
    }
    return most;
}

/* Points a .. b as pieces from node `from` to node `to`. */
static tz_status fit(fitter *f, int32_t a, int32_t b, tz_vec2 u, tz_vec2 v,
                     const int32_t node[2], int depth)
{
    int32_t at = 0, mid[3];
    if (b - a < 2 || off_line(f, a, b) < f->tolerance / 2)
        return tz_curve_line(f->to, node[0], node[1]);
    by_chords(f, a, b);
    tz_bezier c = solve(f, a, b, u, v);
    double error = worst(f, a, b, &c, &at);
    for (int k = 0; k < 4 && error > f->tolerance && error < 16 * f->tolerance; k++) {
        improve(f, a, b, &c);
        c = solve(f, a, b, u, v);
        error = worst(f, a, b, &c, &at);
    }
    if (error <= f->tolerance || depth >= DEEPEST)
        return tz_curve_cubic(f->to, node[0], node[1], c.p[1], c.p[2]);
    const tz_vec2 d = unit(tz_vec2_sub(leave(f, at, b), leave(f, at, a)));
    mid[0] = node[0], mid[2] = node[1];
    tz_status s = tz_curve_add_node(f->to, f->p[at], &mid[1]);
    if (s == TZ_OK)
        s = fit(f, a, at, u, tz_vec2_scale(d, -1), mid, depth + 1);
    return s == TZ_OK ? fit(f, at, b, d, v, mid + 1, depth + 1) : s;
}

/* Turn of the points at i over `window` on either side, radians. */
static double turn_at(const tz_vec2 *p, int32_t n, int32_t i, double window)
{
    int32_t a = i, b = i;
    while (a > 0 && tz_vec2_length(tz_vec2_sub(p[a], p[i])) < window)
        a--;
    while (b < n - 1 && tz_vec2_length(tz_vec2_sub(p[b], p[i])) < window)
        b++;
    const tz_vec2 u = tz_vec2_sub(p[i], p[a]), v = tz_vec2_sub(p[b], p[i]);
    if (a == 0 || b == n - 1) /* too near to an end to tell */
        return 0;
    return fabs(atan2(u.x * v.y - u.y * v.x, tz_vec2_dot(u, v)));
}

/* The next corner after `from`, n - 1 if there is none. */
static int32_t next_corner(const tz_vec2 *p, int32_t n, int32_t from, double window)
{
    for (int32_t i = from + 1; i < n - 1; i++) {
        if (turn_at(p, n, i, window) < TZ_PI / 6)
            continue;
        int32_t best = i; /* the sharpest of those close by */
        for (int32_t k = i + 1;
             k < n - 1 && tz_vec2_length(tz_vec2_sub(p[k], p[i])) < window; k++)
            if (turn_at(p, n, k, window) > turn_at(p, n, best, window))
                best = k;
        if (tz_vec2_length(tz_vec2_sub(p[best], p[from])) > window / 2)
            return best;
    }
    return n - 1;
}

tz_status tz_curve_fit(tz_curve_set *to, const tz_vec2 *p, int32_t n, double tolerance,
                       double window, const int32_t node[2])
{
    fitter f = {.to = to, .p = p, .tolerance = tolerance};
    int32_t at = 0, ends[2] = {node[0], node[1]};
    tz_status s = tz_alloc(to->ctx, &f.t, (size_t)n, sizeof *f.t);
    while (s == TZ_OK && at < n - 1) {
        const int32_t next = next_corner(p, n, at, window);
        ends[1] = node[1];
        if (next < n - 1)
            s = tz_curve_add_node(to, p[next], &ends[1]);
        if (s == TZ_OK)
            s = fit(&f, at, next, leave(&f, at, next), leave(&f, next, at), ends, 0);
        at = next;
        ends[0] = ends[1];
    }
    tz_free(to->ctx, f.t);
    return s;
}
