/* SPDX-License-Identifier: Apache-2.0 */
/* The middle line of a long or bent shape, on a small raster:
 *
 *   1. the shape, its holes filled, becomes a mask of at most SIDE cells a side;
 *   2. the two cells farthest apart by ways inside it are the line's ends;
 *   3. the line is the cheapest way between them, where a cell costs the more the nearer
 *      it lies to the border, so the way keeps to the middle.
 *
 * A strip of length l and width w has the way L, L^2 = l^2 + w^2, and the area A = l w, so
 * x = l / w solves x + 1 / x = L^2 / A; that holds for bent strips too. Where the line's
 * own strip covers little of the area the shape branches (a cross, a star) and has no
 * middle line. */
#include <string.h>

#include "elements/element_shape.h"

enum { SIDE = 64, ROOM = SIDE + 4 };

typedef struct raster {
    tz_vec2 origin;
    double cell;
    int32_t w, h;
    uint8_t mask[ROOM * ROOM];
    int32_t depth[ROOM * ROOM]; /* to the border, 3 a cell (chamfer) */
    int32_t cost[ROOM * ROOM];
    int32_t from[ROOM * ROOM];
    int32_t queue[ROOM * ROOM];
    bool queued[ROOM * ROOM];
} raster;

static tz_vec2 centre_of(const raster *r, int32_t at)
{
    return (tz_vec2){r->origin.x + (at % r->w + 0.5) * r->cell,
                     r->origin.y + (at / r->w + 0.5) * r->cell};
}

/* Cells whose centre a polygon holds, and those that its border runs through: a shape
 * thinner than a cell still hangs together. Bit 1: centre inside. */
static void fill(raster *r, const tz_vec2 *v, int32_t n)
{
    for (int32_t y = 0; y < r->h; y++)
        for (int32_t x = 0; x < r->w; x++)
            if (tz_polygon_contains(v, n, centre_of(r, y * r->w + x)))
                r->mask[y * r->w + x] = 3;
    for (int32_t i = 0; i < n; i++) {
        const tz_vec2 a = v[i], b = v[(i + 1) % n];
        const int steps = (int)(hypot(b.x - a.x, b.y - a.y) / r->cell * 2) + 1;
        for (int k = 0; k <= steps; k++) {
            const double t = (double)k / steps;
            const int32_t x = (int32_t)((a.x + t * (b.x - a.x) - r->origin.x) / r->cell);
            const int32_t y = (int32_t)((a.y + t * (b.y - a.y) - r->origin.y) / r->cell);
            if (x >= 0 && y >= 0 && x < r->w && y < r->h)
                r->mask[y * r->w + x] |= 1;
        }
    }
}

/* Distance to the border by two passes of the 3-4 chamfer mask. The outermost ring of
 * cells is empty. */
static void measure_depth(raster *r)
{
    const int32_t w = r->w, n = w * r->h;
    for (int32_t i = 0; i < n; i++)
        r->depth[i] = r->mask[i] ? 1 << 20 : 0;
    for (int32_t i = w + 1; i < n - w - 1; i++)
        if (r->mask[i]) {
            const int32_t near[4] = {r->depth[i - 1] + 3, r->depth[i - w] + 3,
                                     r->depth[i - w - 1] + 4, r->depth[i - w + 1] + 4};
            for (int k = 0; k < 4; k++)
                r->depth[i] = near[k] < r->depth[i] ? near[k] : r->depth[i];
        }
    for (int32_t i = n - w - 2; i > w; i--)
        if (r->mask[i]) {
            const int32_t near[4] = {r->depth[i + 1] + 3, r->depth[i + w] + 3,
                                     r->depth[i + w + 1] + 4, r->depth[i + w - 1] + 4};
            for (int k = 0; k < 4; k++)
                r->depth[i] = near[k] < r->depth[i] ? near[k] : r->depth[i];
        }
}

/* Cheapest ways from `start` to all cells of the mask; `deepest` > 0 makes cells near the
 * border dear. Returns the farthest cell; *reached counts cells. */
static int32_t ways(raster *r, int32_t start, int32_t deepest, int32_t *reached)
{
    const int32_t w = r->w, all = ROOM * ROOM;
    const int32_t step[8] = {-1, 1, -w, w, -w - 1, -w + 1, w - 1, w + 1};
    int32_t head = 0, count = 1, far = start;
    for (int32_t i = 0; i < w * r->h; i++) {
        r->cost[i] = INT32_MAX;
        r->queued[i] = false;
    }
    r->cost[start] = 0;
    r->from[start] = -1;
    r->queue[0] = start;
    while (count > 0) {
        const int32_t at = r->queue[head];
        head = (head + 1) % all;
        count--;
        r->queued[at] = false;
        for (int k = 0; k < 8; k++) {
            const int32_t to = at + step[k];
            if (!r->mask[to])
                continue;
            int32_t price = k < 4 ? 70 : 99; /* 1 : sqrt 2 */
            if (deepest > 0)
                price += price * 8 * (deepest - r->depth[to]) / deepest;
            if (r->cost[at] + price >= r->cost[to])
                continue;
            r->cost[to] = r->cost[at] + price;
            r->from[to] = at;
            if (!r->queued[to]) {
                r->queued[to] = true;
                r->queue[(head + count++) % all] = to;
            }
        }
    }
    *reached = 0;
    for (int32_t i = 0; i < w * r->h; i++)
        if (r->cost[i] < INT32_MAX) {
            ++*reached;
            if (r->cost[i] > r->cost[far])
                far = i;
        }
    return far;
}

static bool draw(raster *r, const tz_polys *p)
{
    tz_box b = tz_box_empty();
    for (int32_t i = 0; i < p->point.n; i++)
        tz_box_add(&b, p->point.v[i]);
    r->cell = fmax(b.x1 - b.x0, b.y1 - b.y0) / SIDE;
    if (!(r->cell > 0) || !isfinite(r->cell))
        return false;
    r->origin = (tz_vec2){b.x0 - 1.5 * r->cell, b.y0 - 1.5 * r->cell};
    r->w = (int32_t)((b.x1 - b.x0) / r->cell) + 4;
    r->h = (int32_t)((b.y1 - b.y0) / r->cell) + 4;
    memset(r->mask, 0, sizeof r->mask);
    for (int32_t k = 0; k < p->part.n; k++) {
        int32_t n;
        const tz_vec2 *v = tz_polys_part(p, k, &n);
        fill(r, v, n);
    }
    for (int32_t y = 0; y < r->h; y++)
        for (int32_t x = 0; x < r->w; x++)
            if (x == 0 || y == 0 || x == r->w - 1 || y == r->h - 1)
                r->mask[y * r->w + x] = 0;
    return true;
}

/* Uphill in depth, no farther than `limit`: a way between corners starts at a corner. */
static tz_vec2 climb(const raster *r, tz_vec2 p, double limit)
{
    const int32_t w = r->w;
    const int32_t step[8] = {-1, 1, -w, w, -w - 1, -w + 1, w - 1, w + 1};
    const tz_vec2 start = p;
    int32_t at = (int32_t)((p.y - r->origin.y) / r->cell) * w +
                 (int32_t)((p.x - r->origin.x) / r->cell);
    for (bool moved = true; moved;) {
        int32_t best = at;
        for (int k = 0; k < 8; k++) {
            const tz_vec2 q = centre_of(r, at + step[k]);
            if (r->depth[at + step[k]] > r->depth[best] &&
                hypot(q.x - start.x, q.y - start.y) <= limit)
                best = at + step[k];
        }
        moved = best != at;
        at = best;
        if (moved)
            p = centre_of(r, at);
    }
    return p;
}

/* Points spaced evenly along the way that ends at `end`, half a width from both ends. */
static void space_out(const raster *r, int32_t end, double length, double width,
                      int32_t n, tz_vec2 *out)
{
    const double from = fmin(width / 2, length / (2 * n)),
                 gap = (length - 2 * from) / (n - 1);
    double walked = 0;
    int32_t k = 0;
    tz_vec2 p = centre_of(r, end);
    for (int32_t at = end; at >= 0 && k < n; at = r->from[at]) {
        const tz_vec2 q = centre_of(r, at);
        const double l = hypot(q.x - p.x, q.y - p.y);
        while (k < n && l > 0 && from + k * gap <= walked + l) {
            const double t = (from + k * gap - walked) / l;
            out[k++] = (tz_vec2){p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)};
        }
        walked += l;
        p = q;
    }
    while (k < n)
        out[k++] = p;
    for (k = 0; k < n; k++)
        out[k] = climb(r, out[k], fmin(0.75 * width, gap / 2));
}

static double length_of(const raster *r, int32_t end)
{
    double length = r->cell;
    for (int32_t at = end; r->from[at] >= 0; at = r->from[at]) {
        const tz_vec2 p = centre_of(r, at), q = centre_of(r, r->from[at]);
        length += hypot(q.x - p.x, q.y - p.y);
    }
    return length;
}

/* Share of the shape that lies in the discs about the way, each as large as the depth. */
static double share_covered(const raster *r, int32_t end)
{
    int32_t all = 0, covered = 0;
    for (int32_t i = 0; i < r->w * r->h; i++) {
        bool in = false;
        if (!r->mask[i])
            continue;
        for (int32_t at = end; at >= 0 && !in; at = r->from[at]) {
            const double x = i % r->w - at % r->w, y = i / r->w - at / r->w;
            in = hypot(x, y) <= r->depth[at] / 3.0 + 0.7;
        }
        all++;
        covered += in;
    }
    return (double)covered / all;
}

static int32_t find(raster *r, const tz_polys *p, int32_t most, tz_vec2 *out)
{
    int32_t cells = 0, inside = 0, any = -1, reached;
    if (!draw(r, p))
        return 1;
    for (int32_t i = 0; i < r->w * r->h; i++) {
        cells += r->mask[i] != 0;
        inside += (r->mask[i] & 2) != 0;
        any = r->mask[i] ? i : any;
    }
    if (any < 0)
        return 1;
    const int32_t a = ways(r, any, 0, &reached), b = ways(r, a, 0, &reached);
    if (reached < 0.7 * cells)
        return 1; /* in pieces */
    const double straight = r->cost[b] / 70.0 * r->cell + r->cell;
    const double area =
        inside > 8 ? inside * r->cell * r->cell : tz_polys_moments(p).area;
    const double ratio = straight * straight / fmax(area, straight * straight * 1e-6);
    const double x = ratio > 2 ? (ratio + sqrt(ratio * ratio - 4)) / 2 : 1;
    if (x <= 2.2)
        return 1;
    measure_depth(r);
    int32_t deepest = 1;
    for (int32_t i = 0; i < r->w * r->h; i++)
        deepest = r->depth[i] > deepest ? r->depth[i] : deepest;
    ways(r, a, deepest, &reached);
    if (share_covered(r, b) < 0.75)
        return 1; /* branches */
    const double length = length_of(r, b);
    int32_t n = 1 + (int32_t)(x / 1.5 + 0.5);
    n = n > most ? most : n;
    space_out(r, b, length, area / length, n, out);
    return n;
}

tz_status tz_polys_axis(tz_ctx *ctx, const tz_polys *p, int32_t most, tz_vec2 *out,
                        int32_t *n)
{
    const tz_moments m = tz_polys_moments(p);
    raster *r = NULL;
    *n = 1;
    out[0] = m.centre;
    /* compact: neither long nor bent */
    if (most < 2 || p->point.n < 2 ||
        (m.aspect < 1.7 && 4 * TZ_PI * m.area > 0.6 * m.perimeter * m.perimeter))
        return TZ_OK;
    tz_status s = tz_alloc(ctx, &r, 1, sizeof *r);
    if (s != TZ_OK)
        return s;
    *n = find(r, p, most, out);
    tz_free(ctx, r);
    if (*n == 1)
        out[0] = m.centre;
    const tz_vec2 first = out[0], last = out[*n - 1];
    if (first.x > last.x || (first.x == last.x && first.y > last.y))
        for (int32_t i = 0, j = *n - 1; i < j; i++, j--) {
            const tz_vec2 t = out[i];
            out[i] = out[j];
            out[j] = t;
        }
    return TZ_OK;
}
