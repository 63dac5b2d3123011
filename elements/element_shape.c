/* SPDX-License-Identifier: Apache-2.0 */
/* Plane geometry of outlines. The medial axis: elements/element_axis.c. */
#include "elements/element_shape.h"

#include <assert.h>

#include "base/rng.h"

void tz_polys_clear(tz_polys *p) { p->point.n = p->part.n = p->closed.n = 0; }

void tz_polys_deinit(tz_ctx *ctx, tz_polys *p)
{
    tz_array_free(ctx, &p->point);
    tz_array_free(ctx, &p->part);
    tz_array_free(ctx, &p->closed);
}

const tz_vec2 *tz_polys_part(const tz_polys *p, int32_t k, int32_t *n)
{
    const int32_t end = k + 1 < p->part.n ? p->part.v[k + 1] : p->point.n;
    *n = end - p->part.v[k];
    return p->point.v + p->part.v[k];
}

/* ---- flattening ------------------------------------------------------------------ */

static tz_status begin_part(tz_ctx *ctx, tz_polys *p)
{
    tz_status s = tz_array_push(ctx, &p->part, p->point.n);
    return s == TZ_OK ? tz_array_push(ctx, &p->closed, false) : s;
}

/* Drops the last part if it is a mere point. */
static void end_part(tz_polys *p)
{
    if (p->part.n > 0 && p->point.n - p->part.v[p->part.n - 1] < 2) {
        p->point.n = p->part.v[--p->part.n];
        p->closed.n--;
    }
}

static double bend(tz_vec2 a, tz_vec2 b, tz_vec2 c)
{
    return hypot(a.x - 2 * b.x + c.x, a.y - 2 * b.y + c.y);
}

/* A cubic strays from n chords by at most 3/4 of its greatest bend over n^2. */
static tz_status add_cubic(tz_ctx *ctx, tz_polys *p, const tz_vec2 c[4], double tolerance)
{
    const double b = fmax(bend(c[0], c[1], c[2]), bend(c[1], c[2], c[3]));
    const double want = ceil(sqrt(0.75 * b / tolerance));
    const int n = want < 64 ? (want > 1 ? (int)want : 1) : 64;
    tz_status s = TZ_OK;
    for (int i = 1; i <= n && s == TZ_OK; i++) {
        const double t = (double)i / n, u = 1 - t;
        const double w[4] = {u * u * u, 3 * u * u * t, 3 * u * t * t, t * t * t};
        tz_vec2 q = {0, 0};
        for (int k = 0; k < 4; k++) {
            q.x += w[k] * c[k].x;
            q.y += w[k] * c[k].y;
        }
        s = tz_array_push(ctx, &p->point, q);
    }
    return s;
}

tz_status tz_polys_add_path(tz_ctx *ctx, tz_polys *p, const uint8_t *verb, int32_t verbs,
                            const tz_vec2 *point, tz_affine map, double tolerance)
{
    tz_vec2 at = {0, 0}, start = {0, 0}, c[4];
    bool open = false; /* a part has been begun and not closed */
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < verbs && s == TZ_OK; i++) {
        if (verb[i] == TZ_PATH_MOVE) {
            end_part(p);
            start = at = tz_affine_apply(map, *point++);
            open = false;
            continue;
        }
        if (verb[i] == TZ_PATH_CLOSE) {
            if (open)
                p->closed.v[p->closed.n - 1] = true;
            at = start;
            open = false;
            continue;
        }
        if (!open) {
            end_part(p);
            s = begin_part(ctx, p);
            if (s == TZ_OK)
                s = tz_array_push(ctx, &p->point, at);
            open = s == TZ_OK;
        }
        const int n = verb[i] == TZ_PATH_CUBIC ? 3 : 1;
        c[0] = at;
        for (int k = 1; k <= n; k++)
            c[k] = tz_affine_apply(map, *point++);
        at = c[n];
        if (s == TZ_OK)
            s = n == 3 ? add_cubic(ctx, p, c, tolerance)
                       : tz_array_push(ctx, &p->point, at);
    }
    end_part(p);
    return s;
}

/* ---- pens ------------------------------------------------------------------------ */

/* One side of a line: each vertex moved along the mean normal of its edges. */
static tz_status add_side(tz_ctx *ctx, tz_polys *p, const tz_vec2 *v, int32_t n,
                          bool closed, double off, bool back, double cap)
{
    tz_status s = TZ_OK;
    if (closed)
        cap = 0;
    for (int32_t j = 0; j < n && s == TZ_OK; j++) {
        const int32_t i = back ? n - 1 - j : j;
        const int32_t a = i > 0 ? i - 1 : closed ? n - 1 : 0;
        const int32_t b = i + 1 < n ? i + 1 : closed ? 0 : n - 1;
        tz_vec2 e = tz_vec2_sub(v[i], v[a]), f = tz_vec2_sub(v[b], v[i]);
        const double le = tz_vec2_length(e), lf = tz_vec2_length(f);
        tz_vec2 t = {0, 0};
        if (le > 0)
            t = tz_vec2_scale(e, 1 / le);
        if (lf > 0)
            t = tz_vec2_add(t, tz_vec2_scale(f, 1 / lf));
        const double l = tz_vec2_length(t);
        if (!(l > 0))
            continue;
        /* a mitre reaches off / cos(half the turn); held below twice the pen */
        const double mitre = fmin(le > 0 && lf > 0 ? 2 / l : 1, 2) * off / l;
        const double end = (i == n - 1) - (i == 0), beyond = end * cap / l;
        s = tz_array_push(ctx, &p->point,
                          ((tz_vec2){v[i].x - t.y * mitre + t.x * beyond,
                                     v[i].y + t.x * mitre + t.y * beyond}));
    }
    return s;
}

tz_status tz_polys_add_stroke(tz_ctx *ctx, tz_polys *p, const tz_polys *line,
                              double width, bool capped)
{
    const double cap = capped ? width / 2 : 0;
    tz_status s = TZ_OK;
    assert(p != line);
    for (int32_t k = 0; k < line->part.n && s == TZ_OK; k++) {
        int32_t n;
        const tz_vec2 *v = tz_polys_part(line, k, &n);
        bool closed = line->closed.v[k];
        if (closed && v[0].x == v[n - 1].x && v[0].y == v[n - 1].y)
            n--;
        closed = closed && n > 2;
        s = begin_part(ctx, p);
        if (s == TZ_OK)
            s = add_side(ctx, p, v, n, closed, width / 2, false, cap);
        if (s == TZ_OK && closed) {
            p->closed.v[p->closed.n - 1] = true;
            end_part(p);
            s = begin_part(ctx, p);
        }
        if (s == TZ_OK)
            s = add_side(ctx, p, v, n, closed, -width / 2, true, cap);
        if (s == TZ_OK) {
            p->closed.v[p->closed.n - 1] = true;
            end_part(p);
        }
    }
    return s;
}

/* ---- smallest circle ------------------------------------------------------------- */

static bool holds(tz_vec2 c, double r, tz_vec2 p)
{
    return hypot(p.x - c.x, p.y - c.y) <= r * (1 + 1e-12) + 1e-300;
}

static double circle_of_2(tz_vec2 a, tz_vec2 b, tz_vec2 *c)
{
    *c = (tz_vec2){(a.x + b.x) / 2, (a.y + b.y) / 2};
    return fmax(hypot(a.x - c->x, a.y - c->y), hypot(b.x - c->x, b.y - c->y));
}

/* Through three points; of three on a line, about the two farthest. */
static double circle_of_3(tz_vec2 a, tz_vec2 b, tz_vec2 d, tz_vec2 *c)
{
    const tz_vec2 u = tz_vec2_sub(b, a), v = tz_vec2_sub(d, a);
    const double cross = u.x * v.y - u.y * v.x, uu = tz_vec2_dot(u, u),
                 vv = tz_vec2_dot(v, v);
    if (fabs(cross) <= 1e-14 * (uu + vv)) {
        tz_vec2 other;
        double r = circle_of_2(a, b, c), q = circle_of_2(a, d, &other);
        if (q > r)
            r = q, *c = other;
        if ((q = circle_of_2(b, d, &other)) > r)
            r = q, *c = other;
        return r;
    }
    *c = (tz_vec2){a.x + (v.y * uu - u.y * vv) / (2 * cross),
                   a.y + (u.x * vv - v.x * uu) / (2 * cross)};
    return fmax(hypot(a.x - c->x, a.y - c->y),
                fmax(hypot(b.x - c->x, b.y - c->y), hypot(d.x - c->x, d.y - c->y)));
}

/* Incremental, in random order: a point outside the circle so far lies on the border of
 * the next (Welzl's argument, without recursion). */
static double circle_of(const tz_vec2 *q, int32_t n, tz_vec2 *c)
{
    double r = 0;
    *c = q[0];
    for (int32_t i = 1; i < n; i++) {
        if (holds(*c, r, q[i]))
            continue;
        *c = q[i];
        r = 0;
        for (int32_t j = 0; j < i; j++) {
            if (holds(*c, r, q[j]))
                continue;
            r = circle_of_2(q[i], q[j], c);
            for (int32_t k = 0; k < j; k++)
                if (!holds(*c, r, q[k]))
                    r = circle_of_3(q[i], q[j], q[k], c);
        }
    }
    return r;
}

/* Farthest point from *c, and out there. Nearly right is made right: never too small. */
static double reach(const tz_vec2 *p, int32_t n, tz_vec2 c)
{
    double r = 0;
    for (int32_t i = 0; i < n; i++)
        r = fmax(r, hypot(p[i].x - c.x, p[i].y - c.y));
    return r;
}

double tz_smallest_circle(tz_ctx *ctx, const tz_vec2 *p, int32_t n, tz_vec2 *centre)
{
    tz_vec2 *q = NULL;
    assert(n > 0);
    if (tz_alloc(ctx, &q, (size_t)n, sizeof *q) != TZ_OK)
        return -1;
    tz_rng rng = tz_rng_make(1, 0);
    for (int32_t i = 0; i < n; i++) {
        const int32_t j = tz_rng_below(&rng, i + 1);
        q[i] = q[j];
        q[j] = p[i];
    }
    circle_of(q, n, centre);
    tz_free(ctx, q);
    return reach(p, n, *centre);
}

/* ---- moments --------------------------------------------------------------------- */

/* Integrals of 1, x, y, x^2, xy, y^2 over a polygon, about o (Green's theorem). */
static void integrate(const tz_vec2 *v, int32_t n, tz_vec2 o, double m[6],
                      double *perimeter)
{
    double k[6] = {0};
    for (int32_t i = 0; i < n; i++) {
        const tz_vec2 a = tz_vec2_sub(v[i], o), b = tz_vec2_sub(v[(i + 1) % n], o);
        const double w = a.x * b.y - b.x * a.y;
        k[0] += w / 2;
        k[1] += w * (a.x + b.x) / 6;
        k[2] += w * (a.y + b.y) / 6;
        k[3] += w * (a.x * a.x + a.x * b.x + b.x * b.x) / 12;
        k[4] += w * (2 * a.x * a.y + a.x * b.y + b.x * a.y + 2 * b.x * b.y) / 24;
        k[5] += w * (a.y * a.y + a.y * b.y + b.y * b.y) / 12;
        *perimeter += hypot(b.x - a.x, b.y - a.y);
    }
    for (int i = 0; i < 6; i++)
        m[i] += k[0] < 0 ? -k[i] : k[i];
}

/* Which end of the axis is heavier: sign of the third moment of the outline along it. */
static double skew(const tz_polys *p, tz_vec2 c, double angle)
{
    const tz_vec2 u = {cos(angle), sin(angle)};
    double cubes = 0, size = 0;
    for (int32_t k = 0; k < p->part.n; k++) {
        int32_t n;
        const tz_vec2 *v = tz_polys_part(p, k, &n);
        for (int32_t i = 0; i < n; i++) {
            const tz_vec2 a = v[i], b = v[(i + 1) % n];
            const double l = hypot(b.x - a.x, b.y - a.y);
            const double t =
                tz_vec2_dot(u, tz_vec2_sub(tz_vec2_scale(tz_vec2_add(a, b), 0.5), c));
            cubes += l * t * t * t;
            size += l * fabs(t * t * t);
        }
    }
    return size > 0 ? cubes / size : 0;
}

tz_moments tz_polys_moments(const tz_polys *p)
{
    tz_moments r = {.aspect = 1};
    double m[6] = {0};
    if (p->point.n == 0)
        return r;
    const tz_vec2 o = p->point.v[0];
    for (int32_t k = 0; k < p->part.n; k++) {
        int32_t n;
        const tz_vec2 *v = tz_polys_part(p, k, &n);
        integrate(v, n, o, m, &r.perimeter);
    }
    r.area = m[0];
    if (!(m[0] > 1e-12 * r.perimeter * r.perimeter)) {
        r.centre = o;
        return r;
    }
    const double x = m[1] / m[0], y = m[2] / m[0];
    const double xx = m[3] / m[0] - x * x, xy = m[4] / m[0] - x * y,
                 yy = m[5] / m[0] - y * y;
    const double mean = (xx + yy) / 2, d = hypot((xx - yy) / 2, xy);
    r.centre = (tz_vec2){o.x + x, o.y + y};
    r.aspect = mean - d > 1e-12 * mean ? sqrt((mean + d) / (mean - d)) : 1e6;
    r.angle = d > 1e-9 * mean ? atan2(2 * xy, xx - yy) / 2 : 0;
    if (skew(p, r.centre, r.angle) < -0.01)
        r.angle += r.angle > 0 ? -TZ_PI : TZ_PI;
    return r;
}

/* ---- containment and touching ----------------------------------------------------- */

bool tz_polygon_contains(const tz_vec2 *p, int32_t n, tz_vec2 q)
{
    bool in = false;
    for (int32_t i = 0, j = n - 1; i < n; j = i++)
        if ((p[i].y > q.y) != (p[j].y > q.y) &&
            q.x < (p[j].x - p[i].x) * (q.y - p[i].y) / (p[j].y - p[i].y) + p[i].x)
            in = !in;
    return in;
}

bool tz_polys_contain(const tz_polys *p, tz_vec2 q)
{
    bool in = false;
    for (int32_t k = 0; k < p->part.n; k++) {
        int32_t n;
        const tz_vec2 *v = tz_polys_part(p, k, &n);
        in ^= tz_polygon_contains(v, n, q);
    }
    return in;
}

static double side_of(tz_vec2 a, tz_vec2 b, tz_vec2 p)
{
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

static bool edges_cross(tz_vec2 a, tz_vec2 b, tz_vec2 c, tz_vec2 d)
{
    return side_of(a, b, c) * side_of(a, b, d) < 0 &&
           side_of(c, d, a) * side_of(c, d, b) < 0;
}

static double distance_to_edge(tz_vec2 a, tz_vec2 b, tz_vec2 p)
{
    const tz_vec2 e = tz_vec2_sub(b, a), v = tz_vec2_sub(p, a);
    const double l = tz_vec2_dot(e, e);
    const double t = l > 0 ? fmin(fmax(tz_vec2_dot(e, v) / l, 0), 1) : 0;
    return hypot(v.x - t * e.x, v.y - t * e.y);
}

/* Contacts of the vertices of polygon a with the edges of b; a crossing counts as many. */
static int contacts(const tz_vec2 *a, int32_t n, const tz_polys *b, double tolerance)
{
    int count = 0;
    for (int32_t i = 0; i < n && count < 3; i++) {
        bool near = false;
        for (int32_t k = 0; k < b->part.n && count < 3; k++) {
            int32_t m;
            const tz_vec2 *v = tz_polys_part(b, k, &m);
            for (int32_t j = 0; j < m && count < 3; j++) {
                const tz_vec2 c = v[j], d = v[(j + 1) % m];
                if (edges_cross(a[i], a[(i + 1) % n], c, d))
                    count = 3;
                near = near || distance_to_edge(c, d, a[i]) <= tolerance;
            }
        }
        count += near;
    }
    return count;
}

/* A mere corner on a corner is two contacts, one each way: neighbours in a lattice. */
bool tz_polys_touch(const tz_polys *a, const tz_polys *b, double tolerance)
{
    int count = 0;
    if (a->point.n == 0 || b->point.n == 0)
        return false;
    if (tz_polys_contain(a, b->point.v[0]) || tz_polys_contain(b, a->point.v[0]))
        return true;
    for (int32_t k = 0; k < a->part.n && count < 3; k++) {
        int32_t n;
        const tz_vec2 *v = tz_polys_part(a, k, &n);
        count += contacts(v, n, b, tolerance);
    }
    for (int32_t k = 0; k < b->part.n && count < 3; k++) {
        int32_t n;
        const tz_vec2 *v = tz_polys_part(b, k, &n);
        count += contacts(v, n, a, tolerance);
    }
    return count >= 3;
}
