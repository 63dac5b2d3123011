/* SPDX-License-Identifier: Apache-2.0 */
/* Coverage by accumulation: an edge adds to each pixel that it crosses the change of the
 * winding number's mean there, so that the sum from the left is the mean itself:
 *
 *        edge going down, right of it inside
 *   0 | 0.3 | 0.7 | 0        differences
 *   0 | 0.3 | 1   | 1  ...   sums: area covered
 *
 * Exact for shapes whose edges do not cross inside a pixel; where they do, the mean winding
 * number is clamped (or folded, even-odd), as all rasterisers of this kind do. */
#include <string.h>

#include "synthesis/element_cover_internal.h"

tz_status tz_cover_init(tz_ctx *ctx, tz_cover *c, int32_t width, int32_t height)
{
    *c = (tz_cover){.width = width, .height = height, .top = height, .bottom = -1};
    tz_status s =
        tz_alloc_zero(ctx, &c->sum, (size_t)(width + 2) * (size_t)height, sizeof *c->sum);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &c->first, 2 * (size_t)height, sizeof *c->first);
    if (s != TZ_OK) {
        tz_cover_deinit(ctx, c);
        return s;
    }
    c->last = c->first + height;
    for (int32_t y = 0; y < height; y++)
        c->first[y] = width + 2, c->last[y] = -1;
    return TZ_OK;
}

void tz_cover_deinit(tz_ctx *ctx, tz_cover *c)
{
    tz_free(ctx, c->sum);
    tz_free(ctx, c->first);
    *c = (tz_cover){0};
}

void tz_cover_reset(tz_cover *c)
{
    c->top = c->height;
    c->bottom = -1;
}

/* The part of an edge in one row: from x = a to x = b, both in 0 .. width, of height d
 * (negative where it goes up). */
static inline void add_span(float *row, double a, double b, double d)
{
    const double x0 = a < b ? a : b, x1 = a < b ? b : a;
    const int32_t i = (int32_t)x0;
    int32_t j = (int32_t)x1;
    j += x1 > j;
    if (j <= i + 1) { /* within one pixel */
        const double mean = 0.5 * (x0 + x1) - i;
        row[i] += (float)(d * (1 - mean));
        row[i + 1] += (float)(d * mean);
        return;
    }
    const double s = 1 / (x1 - x0), f = 1 - (x0 - i), g = x1 - (j - 1);
    const double in = 0.5 * s * f * f, out = 0.5 * s * g * g;
    row[i] += (float)(d * in);
    if (j == i + 2) {
        row[i + 1] += (float)(d * (1 - in - out));
    } else {
        const double second = s * (f + 0.5);
        row[i + 1] += (float)(d * (second - in));
        for (int32_t k = i + 2; k < j - 1; k++)
            row[k] += (float)(d * s);
        row[j - 1] += (float)(d * (1 - second - (j - i - 3) * s - out));
    }
    row[j] += (float)(d * out);
}

/* An edge that lies in the block. */
static void add_inside(tz_cover *c, tz_vec2 p, tz_vec2 q)
{
    double sign = 1;
    if (p.y > q.y) {
        const tz_vec2 t = p;
        p = q;
        q = t;
        sign = -1;
    }
    const int32_t from = (int32_t)p.y, w = c->width;
    int32_t to = (int32_t)q.y;
    to = to < c->height ? to : c->height - 1;
    const double slope = (q.x - p.x) / (q.y - p.y), lo = p.x < q.x ? p.x : q.x,
                 hi = p.x < q.x ? q.x : p.x;
    double x = p.x, y = p.y;
    c->top = from < c->top ? from : c->top;
    c->bottom = to > c->bottom ? to : c->bottom;
    for (int32_t r = from; r <= to; r++) {
        const double end = q.y < r + 1 ? q.y : r + 1, d = end - y;
        if (!(d > 0))
            break;
        double next = end == q.y ? q.x : p.x + slope * (end - p.y);
        next = next < lo ? lo : next > hi ? hi : next;
        add_span(c->sum + (int64_t)r * (w + 2), x, next, sign * d);
        const int32_t left = (int32_t)(x < next ? x : next),
                      right = (int32_t)(x < next ? next : x) + 1;
        c->first[r] = left < c->first[r] ? left : c->first[r];
        c->last[r] = right > c->last[r] ? right : c->last[r];
        x = next;
        y = end;
    }
}

static inline tz_vec2 at_x(tz_vec2 p, tz_vec2 q, double x)
{
    const double t = (x - p.x) / (q.x - p.x);
    return (tz_vec2){x, p.y + t * (q.y - p.y)};
}

static inline tz_vec2 at_y(tz_vec2 p, tz_vec2 q, double y)
{
    const double t = (y - p.y) / (q.y - p.y);
    return (tz_vec2){p.x + t * (q.x - p.x), y};
}

void tz_cover_edge(tz_cover *c, tz_vec2 p, tz_vec2 q)
{
    const double w = c->width, h = c->height;
    if (!(fabs(p.x) < 1e9 && fabs(p.y) < 1e9 && fabs(q.x) < 1e9 && fabs(q.y) < 1e9) ||
        p.y == q.y || (p.y <= 0 && q.y <= 0) || (p.y >= h && q.y >= h) ||
        (p.x >= w && q.x >= w))
        return;
    const tz_vec2 a = p, b = q;
    if (p.y < 0)
        p = at_y(a, b, 0);
    else if (p.y > h)
        p = at_y(a, b, h);
    if (q.y < 0)
        q = at_y(a, b, 0);
    else if (q.y > h)
        q = at_y(a, b, h);
    if (p.x >= 0 && q.x >= 0 && p.x <= w && q.x <= w) {
        if (p.y != q.y)
            add_inside(c, p, q);
        return;
    }
    /* in turn what lies left of the block (it counts along its left side), in it, and
     * right of it (it counts nowhere) */
    double cut[4] = {0, 0, 0, 0};
    tz_vec2 part[4];
    int n = 0;
    cut[0] = p.x < q.x ? 0 : w;
    cut[1] = p.x < q.x ? w : 0;
    part[n++] = p;
    for (int k = 0; k < 2; k++)
        if ((p.x < cut[k] && cut[k] < q.x) || (q.x < cut[k] && cut[k] < p.x)) {
            part[n] = at_x(p, q, cut[k]);
            const double lo = p.y < q.y ? p.y : q.y, hi = p.y < q.y ? q.y : p.y;
            part[n].y = part[n].y < lo ? lo : part[n].y > hi ? hi : part[n].y;
            n++;
        }
    part[n++] = q;
    for (int k = 0; k + 1 < n; k++) {
        tz_vec2 f = part[k], t = part[k + 1];
        if (f.y == t.y || 0.5 * (f.x + t.x) > w)
            continue;
        f.x = f.x < 0 ? 0 : f.x > w ? w : f.x;
        t.x = t.x < 0 ? 0 : t.x > w ? w : t.x;
        add_inside(c, f, t);
    }
}

void tz_cover_polygon(tz_cover *c, const tz_vec2 *p, int32_t n)
{
    for (int32_t i = 0; i < n; i++)
        tz_cover_edge(c, p[i], p[i + 1 < n ? i + 1 : 0]);
}

bool tz_cover_take(tz_cover *c, int32_t y, bool even_odd, float *out, int32_t *from,
                   int32_t *to)
{
    const float least = 1.0F / 16384; /* rounding of sums */
    const int32_t w = c->width;
    int32_t first = c->first[y], last = c->last[y];
    if (first > last)
        return false;
    float *row = c->sum + (int64_t)y * (w + 2), sum = 0;
    last = last > w - 1 ? w - 1 : last;
    for (int32_t x = first; x <= last; x++) {
        sum += row[x];
        float v = sum < 0 ? -sum : sum;
        if (even_odd) {
            v -= 2 * (float)(int32_t)(v * 0.5F);
            v = v > 1 ? 2 - v : v;
        } else {
            v = v > 1 ? 1 : v;
        }
        out[x] = v < least ? 0 : v;
    }
    const int32_t stop = last + 1;
    float rest = last >= 0 && first <= last ? out[last] : 0;
    /* edges right of the block were left out: what is inside stays so to its end */
    *from = first;
    *to = stop;
    if (rest > 0 && c->last[y] < w) {
        for (int32_t x = stop; x < w; x++)
            out[x] = rest;
        *to = w;
    }
    const int32_t end = c->last[y] + 1 < w + 2 ? c->last[y] + 1 : w + 2;
    memset(row + first, 0, (size_t)(end - first) * sizeof *row);
    c->first[y] = w + 2;
    c->last[y] = -1;
    return *from < *to;
}

/* ---- pens --------------------------------------------------------------------------- */

static void triangle(tz_cover *c, tz_vec2 a, tz_vec2 b, tz_vec2 d)
{
    tz_cover_edge(c, a, b);
    tz_cover_edge(c, b, d);
    tz_cover_edge(c, d, a);
}

/* Fan about p from p + r (cos, sin)(from) over an angle, counted as quads are: from the
 * side of +normal to that of -normal is a half turn. */
static void fan(tz_cover *c, tz_vec2 p, double r, double from, double turn)
{
    const double step = r > 0.05 ? 2 * acos(1 - 0.02 / r) : TZ_PI / 2;
    int32_t n = (int32_t)ceil(fabs(turn) / (step > 0.01 ? step : 0.01));
    n = n < 1 ? 1 : n;
    tz_vec2 last = {p.x + r * cos(from), p.y + r * sin(from)};
    for (int32_t k = 1; k <= n; k++) {
        const double a = from + turn * k / n;
        const tz_vec2 q = {p.x + r * cos(a), p.y + r * sin(a)};
        if (turn > 0)
            triangle(c, p, last, q);
        else
            triangle(c, p, q, last);
        last = q;
    }
}

/* A piece of the line between two cuts across it: a, d are its ends on one side. */
static void piece(tz_cover *c, tz_vec2 p, tz_vec2 q, tz_vec2 n, tz_vec2 m)
{
    const tz_vec2 a = tz_vec2_sub(p, n), b = tz_vec2_sub(q, m), d = tz_vec2_add(q, m),
                  e = tz_vec2_add(p, n);
    tz_cover_edge(c, a, b);
    tz_cover_edge(c, b, d);
    tz_cover_edge(c, d, e);
    tz_cover_edge(c, e, a);
}

/* All pieces wind the same way, so that the sum of them, clamped, is their union. */
static void segment(tz_cover *c, tz_vec2 p, tz_vec2 q, tz_vec2 n)
{
    piece(c, p, q, n, n);
}

/* The cut across the line at p, where a curve turns from direction d into e: both pieces
 * end there without lapping over each other. False where they are too short for that. */
static bool bisect(tz_vec2 d, tz_vec2 e, double shorter, double r, tz_vec2 *cut)
{
    const double dot = tz_vec2_dot(d, e), cosine = sqrt(fmax(0.5 * (1 + dot), 0));
    if (dot < 0.5 || r * sqrt(1 - fmin(cosine * cosine, 1)) > 0.5 * shorter * cosine)
        return false;
    const tz_vec2 mid = {-(d.y + e.y), d.x + e.x};
    *cut = tz_vec2_scale(mid, r / cosine / tz_vec2_length(mid));
    return true;
}

/* Fills the outer side where direction d turns into e at p; r is half the width there. */
static void join(tz_cover *c, tz_vec2 p, tz_vec2 d, tz_vec2 e, double r, int kind,
                 const tz_pen *pen)
{
    const double cross = d.x * e.y - d.y * e.x, dot = tz_vec2_dot(d, e);
    if (fabs(cross) < 1e-9 && dot > 0)
        return;
    /* outer side: left of the way (y down: at angle - pi / 2) where it turns clockwise */
    const double side = cross >= 0 ? -1 : 1;
    const tz_vec2 n = {-d.y * r * side, d.x * r * side},
                  m = {-e.y * r * side, e.x * r * side};
    if (kind == 1) {
        fan(c, p, r, atan2(n.y, n.x), atan2(cross, dot));
        return;
    }
    const tz_vec2 a = tz_vec2_add(p, n), b = tz_vec2_add(p, m);
    const bool turn = cross >= 0;
    triangle(c, p, turn ? a : b, turn ? b : a);
    const double half = sqrt(fmax(0.5 * (1 + dot), 0)); /* cosine of half the turn */
    if (kind == 0 && half * pen->miter >= 1) {
        const tz_vec2 mid = tz_vec2_add(n, m);
        const double l = tz_vec2_dot(mid, mid);
        const tz_vec2 tip = tz_vec2_add(p, tz_vec2_scale(mid, 2 * r * r / l));
        triangle(c, a, turn ? tip : b, turn ? b : tip);
    }
}

static void cap(tz_cover *c, tz_vec2 p, tz_vec2 d, double r, const tz_pen *pen)
{
    const tz_vec2 n = {-d.y * r, d.x * r};
    if (pen->cap == 1)
        fan(c, p, r, atan2(-n.y, -n.x), TZ_PI);
    else if (pen->cap == 2)
        segment(c, p, tz_vec2_add(p, tz_vec2_scale(d, r)), n);
}

/* Direction of the first step of some length after i; false if there is none. */
static bool direction(const tz_vec2 *p, int32_t n, bool closed, int32_t i, int32_t *to,
                      tz_vec2 *d)
{
    for (int32_t k = 1; k <= n; k++) {
        int32_t j = i + k;
        if (j >= n) {
            if (!closed)
                return false;
            j -= n;
        }
        const tz_vec2 v = tz_vec2_sub(p[j], p[i]);
        const double l = tz_vec2_length(v);
        if (l > 1e-9) {
            *to = j;
            *d = tz_vec2_scale(v, 1 / l);
            return true;
        }
    }
    return false;
}

void tz_cover_stroke(tz_cover *c, const tz_vec2 *p, const bool *smooth, int32_t n,
                     bool closed, const tz_pen *pen)
{
    tz_cover_taper(c, p, smooth, NULL, n, closed, pen);
}

void tz_cover_taper(tz_cover *c, const tz_vec2 *p, const bool *smooth, const float *half,
                    int32_t n, bool closed, const tz_pen *pen)
{
    const double same = 0.5 * pen->width;
    tz_vec2 d, e, start;
    int32_t i = 0, j;
    while (closed && n > 1 && tz_vec2_length(tz_vec2_sub(p[n - 1], p[0])) <= 1e-9)
        n--; /* closes by itself */
    if (n < 1 || !(half ? half[0] > 0 : same > 0))
        return;
    if (!direction(p, n, closed, 0, &j, &d)) { /* a point: shown by its caps */
        if (pen->cap) {
            cap(c, p[0], (tz_vec2){1, 0}, half ? half[0] : same, pen);
            cap(c, p[0], (tz_vec2){-1, 0}, half ? half[0] : same, pen);
        }
        return;
    }
    start = d;
    const double first = half ? half[0] : same;
    if (!closed)
        cap(c, p[0], tz_vec2_scale(d, -1), first, pen);
    tz_vec2 from = {-d.y * first, d.x * first};
    for (int32_t steps = 0; steps <= n; steps++) {
        const double r = half ? half[j] : same;
        const tz_vec2 square = {-d.y * r, d.x * r};
        const bool around = j <= i; /* closed: back at the start */
        const bool curve = smooth && smooth[j];
        tz_vec2 cut;
        int32_t k;
        if (around || !direction(p, n, closed, j, &k, &e)) {
            piece(c, p[i], p[j], from, square);
            if (closed)
                join(c, p[j], d, start, r, curve ? 1 : pen->join, pen);
            else
                cap(c, p[j], d, r, pen);
            return;
        }
        const double l = tz_vec2_length(tz_vec2_sub(p[j], p[i])),
                     m = tz_vec2_length(tz_vec2_sub(p[k], p[j]));
        if (curve && bisect(d, e, fmin(l, m), r, &cut)) {
            piece(c, p[i], p[j], from, cut);
            from = cut;
        } else {
            piece(c, p[i], p[j], from, square);
            join(c, p[j], d, e, r, curve ? 1 : pen->join, pen);
            from = (tz_vec2){-e.y * r, e.x * r};
        }
        i = j;
        j = k;
        d = e;
    }
}

void tz_cover_cap(tz_cover *c, const tz_vec2 *p, int32_t n, int step, double half,
                  const tz_pen *pen)
{
    for (int32_t k = 1; k < n; k++) {
        const tz_vec2 d = tz_vec2_sub(*p, p[k * step]);
        const double l = tz_vec2_length(d);
        if (l > 1e-9) {
            cap(c, *p, tz_vec2_scale(d, 1 / l), half, pen);
            return;
        }
    }
}
