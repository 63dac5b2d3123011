/* SPDX-License-Identifier: Apache-2.0 */
/* Draws the curve exemplars of data/exemplars: draw_lines FOLDER. Each is a plain SVG of
 * strokes: a street plan, a circuit board, contour lines, wood grain, cracked mud, vines. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/geom.h"
#include "base/rng.h"

enum { SIDE = 400, MOST = 4096 };

static double between(tz_rng *g, double lo, double hi)
{
    return lo + (hi - lo) * tz_rng_unit(g);
}

static FILE *begin(const char *folder, const char *name, const char *ground)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/%s.svg", folder, name);
    FILE *f = fopen(path, "w");
    if (!f) {
        fprintf(stderr, "draw_lines: %s: %s\n", path, strerror(errno));
        exit(1);
    }
    fprintf(f,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\">\n"
            "<!-- SPDX-License-Identifier: Apache-2.0 -->\n"
            "<rect width=\"%d\" height=\"%d\" fill=\"%s\"/>\n"
            "<g fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n",
            SIDE, SIDE, SIDE, SIDE, ground);
    return f;
}

static void end(FILE *f)
{
    fputs("</g>\n</svg>\n", f);
    if (fclose(f) != 0) {
        fprintf(stderr, "draw_lines: %s\n", strerror(errno));
        exit(1);
    }
}

static void open_path(FILE *f, const char *colour, double width)
{
    fprintf(f, "<path stroke=\"%s\" stroke-width=\"%g\" d=\"", colour, width);
}

/** A smooth path through points (Catmull-Rom). */
static void smooth(FILE *f, const tz_vec2 *p, int n, int closed)
{
    fprintf(f, "M%.1f %.1f", p[0].x, p[0].y);
    for (int i = 0; i + !closed < n; i++) {
        const tz_vec2 a = p[i        ? i - 1
                            : closed ? n - 1
                                     : 0],
                      b = p[i], c = p[(i + 1) % n],
                      d = i + 2 < n ? p[i + 2]
                          : closed  ? p[(i + 2) % n]
                                    : p[n - 1];
        fprintf(f, "C%.1f %.1f %.1f %.1f %.1f %.1f", b.x + (c.x - a.x) / 6,
                b.y + (c.y - a.y) / 6, c.x - (d.x - b.x) / 6, c.y - (d.y - b.y) / 6, c.x,
                c.y);
    }
    fputs(closed ? "Z\"/>\n" : "\"/>\n", f);
}

/* ---- lines of equal height ----------------------------------------------------------- */

enum { CELLS = 168 }; /* cells of 2.5 units, ten units beyond the view */

static tz_vec2 grid_at(double i, double j)
{
    return (tz_vec2){2.5 * i - 10, 2.5 * j - 10};
}

typedef double height_fn(tz_vec2 at);

/** Where the level cuts the edges of the grid; edge 2k runs right of point k, 2k + 1 down. */
typedef struct level_lines {
    tz_vec2 at[2 * (CELLS + 1) * (CELLS + 1)];
    int next[2 * (CELLS + 1) * (CELLS + 1)][2];
    char seen[2 * (CELLS + 1) * (CELLS + 1)];
} level_lines;

static void join(level_lines *l, int a, int b)
{
    l->next[a][l->next[a][0] >= 0] = b;
    l->next[b][l->next[b][0] >= 0] = a;
}

static void cut_cells(level_lines *l, const double *h, double level)
{
    enum { W = CELLS + 1 };
    memset(l->next, -1, sizeof l->next);
    memset(l->seen, 0, sizeof l->seen);
    for (int j = 0; j < W; j++)
        for (int i = 0; i < W; i++) {
            const int k = j * W + i;
            const double v = h[k] - level;
            if (i < CELLS)
                l->at[2 * k] = grid_at(i + v / (v - h[k + 1] + level), j);
            if (j < CELLS)
                l->at[2 * k + 1] = grid_at(i, j + v / (v - h[k + W] + level));
        }
    for (int j = 0; j < CELLS; j++)
        for (int i = 0; i < CELLS; i++) {
            const int k = j * W + i, corner[4] = {k, k + 1, k + W + 1, k + W},
                      edge[4] = {2 * k, 2 * (k + 1) + 1, 2 * (k + W), 2 * k + 1};
            int cut[4], n = 0;
            for (int e = 0; e < 4; e++)
                if ((h[corner[e]] < level) != (h[corner[(e + 1) % 4]] < level))
                    cut[n++] = edge[e];
            for (int e = 0; e + 1 < n; e += 2)
                join(l, cut[e], cut[e + 1]);
        }
}

/** Draws the line through an edge of the grid, by every so many of its points, and marks
 * it as seen. */
static void follow(level_lines *l, FILE *f, int from, const char *colour, double width,
                   int step)
{
    static tz_vec2 p[MOST];
    int n = 0, steps = 0, at = from, was = -1, closed = l->next[from][1] >= 0;
    while (at >= 0 && !l->seen[at] && n < MOST) {
        const int next = l->next[at][l->next[at][0] == was && was >= 0];
        l->seen[at] = 1;
        if (steps++ % step == 0 || (!closed && next < 0))
            p[n++] = l->at[at];
        was = at;
        at = next;
    }
    if (n < 3)
        return;
    open_path(f, colour, width);
    smooth(f, p, n, closed);
}

static void level_set(FILE *f, height_fn *height, double level, const char *colour,
                      double width, int step)
{
    static level_lines l;
    static double h[(CELLS + 1) * (CELLS + 1)];
    for (int j = 0; j <= CELLS; j++)
        for (int i = 0; i <= CELLS; i++)
            h[j * (CELLS + 1) + i] = height(grid_at(i, j));
    cut_cells(&l, h, level);
    const int edges = 2 * (CELLS + 1) * (CELLS + 1);
    for (int e = 0; e < edges; e++) /* from the border first, then rings */
        if (!l.seen[e] && l.next[e][0] >= 0 && l.next[e][1] < 0)
            follow(&l, f, e, colour, width, step);
    for (int e = 0; e < edges; e++)
        if (!l.seen[e] && l.next[e][0] >= 0)
            follow(&l, f, e, colour, width, step);
}

/** Hills: waves that bend each other. */
static double hills(tz_vec2 p)
{
    const double x = p.x + 34 * sin(p.y / 61 + 1), y = p.y + 30 * sin(p.x / 53);
    return sin(x / 47) + sin(y / 41 + 0.6) + 0.7 * sin((x + y) / 36 + 2) +
           0.5 * sin((x - 1.4 * y) / 31);
}

static void contours(const char *folder)
{
    FILE *f = begin(folder, "contours", "#f5f0e1");
    for (int k = -9; k <= 9; k++)
        level_set(f, hills, 0.3 * k + 0.01, k % 4 ? "#b98b5a" : "#8a5a2e",
                  k % 4 ? 1.2 : 2.4, 6);
    end(f);
}

static const tz_vec2 knot[] = {{112, 118}, {296, 262}, {70, 330}};
static const double knot_radius[] = {30, 38, 20};

/** Height across the grain: lines that part about knots and close behind them. */
static double grain_height(tz_vec2 p)
{
    double h = p.y + 5 * sin(p.x / 58 + p.y / 90) + 3 * sin(p.x / 31 - p.y / 47);
    for (int k = 0; k < 3; k++) {
        const tz_vec2 c = knot[k];
        const double middle =
            c.y + 5 * sin(c.x / 58 + c.y / 90) + 3 * sin(c.x / 31 - c.y / 47) + 0.4;
        const double R = knot_radius[k], r = hypot((p.x - c.x) / 1.5, p.y - c.y) / R,
                     d = fmax(0, r - 0.9) / 0.75;
        h = middle + (h - middle) * (1 - exp(-d * d));
    }
    return h;
}

static double rings(tz_vec2 p)
{
    double best = 1e9;
    for (int k = 0; k < 3; k++) {
        const double R = knot_radius[k], a = atan2(p.y - knot[k].y, p.x - knot[k].x);
        best = fmin(best, hypot((p.x - knot[k].x) / 1.35, p.y - knot[k].y) / R *
                              (1 + 0.06 * sin(3 * a + k)));
    }
    return best;
}

static void grain(const char *folder)
{
    tz_rng g = tz_rng_make(5, 1);
    FILE *f = begin(folder, "grain", "#d9ae74");
    double y = -40;
    while (y < SIDE + 40) {
        y += between(&g, 7, 12);
        level_set(f, grain_height, y, "#8d5a2b", between(&g, 1.1, 2.2), 6);
    }
    for (int k = 1; k <= 3; k++)
        level_set(f, rings, 0.22 * k, "#6f4220", 1.8, 3);
    end(f);
}

/* ---- streets: blocks, cut in two and again ------------------------------------------- */

typedef struct block {
    tz_vec2 p[16];
    int n;
} block;

static double area(const block *b)
{
    double a = 0;
    for (int i = 0; i < b->n; i++) {
        const tz_vec2 p = b->p[i], q = b->p[(i + 1) % b->n];
        a += (p.x * q.y - q.x * p.y) / 2;
    }
    return fabs(a);
}

/** The part of a block left of a line; the points where the line cuts it. */
static block half_of(const block *b, tz_vec2 at, tz_vec2 normal, tz_vec2 *cut, int *cuts)
{
    block out = {.n = 0};
    *cuts = 0;
    for (int i = 0; i < b->n && out.n < 14; i++) {
        const tz_vec2 p = b->p[i], q = b->p[(i + 1) % b->n];
        const double u = (p.x - at.x) * normal.x + (p.y - at.y) * normal.y,
                     v = (q.x - at.x) * normal.x + (q.y - at.y) * normal.y;
        if (u >= 0)
            out.p[out.n++] = p;
        if ((u >= 0) != (v >= 0)) {
            const tz_vec2 c = {p.x + (q.x - p.x) * u / (u - v),
                               p.y + (q.y - p.y) * u / (u - v)};
            out.p[out.n++] = c;
            if (*cuts < 2)
                cut[(*cuts)++] = c;
        }
    }
    return out;
}

static void build(FILE *f, tz_rng *g, block b, int depth)
{
    static const char *const colour[] = {"#d3812f", "#5d6b7a", "#9aa4ad"};
    static const double width[] = {6, 3.4, 2};
    const int rank = depth < 3 ? 0 : depth < 5 ? 1 : 2;
    const double size = area(&b);
    if (size < between(g, 900, 1700) || depth > 12)
        return;
    int longest = 0;
    double most = 0;
    for (int i = 0; i < b.n; i++) {
        const double d =
            hypot(b.p[(i + 1) % b.n].x - b.p[i].x, b.p[(i + 1) % b.n].y - b.p[i].y);
        if (d > most) {
            most = d;
            longest = i;
        }
    }
    const tz_vec2 p = b.p[longest], q = b.p[(longest + 1) % b.n];
    const double t = between(g, 0.4, 0.6), lean = between(g, -0.12, 0.12),
                 x = (q.x - p.x) / most, y = (q.y - p.y) / most;
    const tz_vec2 at = {p.x + (q.x - p.x) * t, p.y + (q.y - p.y) * t},
                  along = {x * cos(lean) - y * sin(lean), x * sin(lean) + y * cos(lean)},
                  back = {-along.x, -along.y};
    tz_vec2 cut[2];
    int cuts;
    const block left = half_of(&b, at, along, cut, &cuts),
                right = half_of(&b, at, back, cut, &cuts);
    if (cuts < 2)
        return;
    open_path(f, colour[rank], width[rank]);
    fprintf(f, "M%.1f %.1fL%.1f %.1f\"/>\n", cut[0].x, cut[0].y, cut[1].x, cut[1].y);
    build(f, g, left, depth + 1);
    build(f, g, right, depth + 1);
}

static void streets(const char *folder)
{
    tz_rng g = tz_rng_make(6, 1);
    FILE *f = begin(folder, "streets", "#f3eee3");
    block city = {.n = 4};
    for (int k = 0; k < 4; k++) {
        const double a = TZ_PI / 4 + k * TZ_PI / 2 + 0.2;
        city.p[k] = (tz_vec2){SIDE / 2 + 360 * cos(a), SIDE / 2 + 360 * sin(a)};
    }
    build(f, &g, city, 0);
    end(f);
}

/* ---- circuit: routes on a grid that do not cross ------------------------------------- */

enum { PITCH = 8, WIRES = SIDE / PITCH };
static const int way[8][2] = {{1, 0},  {1, 1},   {0, 1},  {-1, 1},
                              {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};

typedef struct board {
    char used[WIRES][WIRES];  /* points of the grid */
    char slant[WIRES][WIRES]; /* cells that a slanted wire crosses */
} board;

/** May a wire go on from a point that way? */
static int can_go(const board *b, int i, int j, int w)
{
    const int x = i + way[w][0], y = j + way[w][1];
    if (x < 0 || y < 0 || x >= WIRES || y >= WIRES || b->used[y][x])
        return 0;
    return !(w & 1) || !b->slant[y < j ? y : j][x < i ? x : i];
}

static int route(board *b, tz_rng *g, tz_vec2 *p)
{
    int i = (int)(WIRES * tz_rng_unit(g)), j = (int)(WIRES * tz_rng_unit(g)),
        w = 2 * (int)(4 * tz_rng_unit(g)), n = 0, run = 0;
    const int most = 8 + (int)(30 * tz_rng_unit(g));
    board undo = *b;
    if (b->used[j][i])
        return 0;
    b->used[j][i] = 1;
    p[n++] = (tz_vec2){PITCH * (i + 0.5), PITCH * (j + 0.5)};
    for (int step = 0; step < most; step++) {
        const int turn = run > 2 + (w & 1 ? 0 : 4) || !can_go(b, i, j, w);
        if (turn) { /* by an eighth, back to the straight ways when slanted */
            const int side = tz_rng_unit(g) < 0.5 ? 1 : 7;
            const int v = (w + side) % 8, u = (w + 8 - side) % 8;
            if (can_go(b, i, j, v))
                w = v;
            else if (can_go(b, i, j, u))
                w = u;
            else
                break;
            run = 0;
        }
        if (w & 1)
            b->slant[way[w][1] < 0 ? j - 1 : j][way[w][0] < 0 ? i - 1 : i] = 1;
        i += way[w][0];
        j += way[w][1];
        b->used[j][i] = 1;
        run++;
        p[n++] = (tz_vec2){PITCH * (i + 0.5), PITCH * (j + 0.5)};
    }
    if (n < 7) {
        *b = undo;
        return 0;
    }
    return n;
}

static void pad(FILE *f, tz_vec2 p)
{
    if (p.x < 4 || p.y < 4 || p.x > SIDE - 4 || p.y > SIDE - 4)
        return;
    open_path(f, "#f0d58a", 1.6);
    fprintf(f, "M%.1f %.1fa2.6 2.6 0 1 1 -5.2 0a2.6 2.6 0 1 1 5.2 0Z\"/>\n", p.x + 2.6,
            p.y);
}

static void circuit(const char *folder)
{
    static board b;
    tz_rng g = tz_rng_make(7, 1);
    FILE *f = begin(folder, "circuit", "#11472f");
    for (int k = 0; k < 4000; k++) {
        tz_vec2 p[64];
        const int n = route(&b, &g, p);
        if (n == 0)
            continue;
        const tz_vec2 first = p[0], last = p[n - 1]; /* wires begin at the pads' rims */
        const double u = hypot(p[1].x - p[0].x, p[1].y - p[0].y),
                     v = hypot(p[n - 2].x - last.x, p[n - 2].y - last.y);
        p[0].x += 2.6 * (p[1].x - first.x) / u;
        p[0].y += 2.6 * (p[1].y - first.y) / u;
        p[n - 1].x += 2.6 * (p[n - 2].x - last.x) / v;
        p[n - 1].y += 2.6 * (p[n - 2].y - last.y) / v;
        open_path(f, "#d8b75e", 2);
        for (int i = 0; i < n; i++)
            if (i == 0 || i == n - 1 || fabs(p[i + 1].x + p[i - 1].x - 2 * p[i].x) > 3 ||
                fabs(p[i + 1].y + p[i - 1].y - 2 * p[i].y) > 3)
                fprintf(f, "%c%.1f %.1f", i ? 'L' : 'M', p[i].x, p[i].y);
        fputs("\"/>\n", f);
        pad(f, first);
        pad(f, last);
    }
    end(f);
}

/* ---- mud: borders of Voronoi cells --------------------------------------------------- */

/** The cell of a point among others: half planes cut off a square. */
static block cell_of(const tz_vec2 *p, int n, int self)
{
    block b = {.p = {{-80, -80}, {480, -80}, {480, 480}, {-80, 480}}, .n = 4};
    for (int k = 0; k < n; k++) {
        const tz_vec2 away = {p[self].x - p[k].x, p[self].y - p[k].y},
                      middle = {(p[self].x + p[k].x) / 2, (p[self].y + p[k].y) / 2};
        tz_vec2 cut[2];
        int cuts;
        if (k != self)
            b = half_of(&b, middle, away, cut, &cuts);
    }
    return b;
}

/** A crack: halved again and again, each time a little off. */
static void crack(FILE *f, tz_rng *g, tz_vec2 from, tz_vec2 to, double width)
{
    enum { PARTS = 8 };
    tz_vec2 p[PARTS + 1] = {from};
    p[PARTS] = to;
    for (int step = PARTS; step > 1; step /= 2)
        for (int i = 0; i < PARTS; i += step) {
            const tz_vec2 a = p[i], b = p[i + step];
            const double off = between(g, -0.1, 0.1);
            p[i + step / 2] = (tz_vec2){(a.x + b.x) / 2 - off * (b.y - a.y),
                                        (a.y + b.y) / 2 + off * (b.x - a.x)};
        }
    open_path(f, "#4a3220", width);
    smooth(f, p, PARTS + 1, 0);
}

static void mud(const char *folder)
{
    enum { CLODS = 150 };
    tz_rng g = tz_rng_make(8, 1);
    tz_vec2 p[CLODS];
    for (int k = 0; k < CLODS; k++)
        p[k] = (tz_vec2){between(&g, -60, SIDE + 60), between(&g, -60, SIDE + 60)};
    for (int round = 0; round < 2; round++) { /* evened out */
        tz_vec2 q[CLODS];
        for (int k = 0; k < CLODS; k++) {
            const block b = cell_of(p, CLODS, k);
            q[k] = (tz_vec2){0, 0};
            for (int i = 0; i < b.n; i++) {
                q[k].x += b.p[i].x / b.n;
                q[k].y += b.p[i].y / b.n;
            }
        }
        memcpy(p, q, sizeof p);
    }
    FILE *f = begin(folder, "mud", "#b79a78");
    for (int k = 0; k < CLODS; k++) {
        const block b = cell_of(p, CLODS, k);
        for (int i = 0; i < b.n; i++) {
            const tz_vec2 u = b.p[i], v = b.p[(i + 1) % b.n];
            /* each border once, from the cell on its left */
            if (u.x > v.x || fmax(u.y, v.y) < -4 || fmin(u.y, v.y) > SIDE + 4 ||
                v.x < -4 || u.x > SIDE + 4)
                continue;
            crack(f, &g, u, v, tz_rng_unit(&g) < 0.35 ? 4 : 2.2);
        }
    }
    end(f);
}

/* ---- vines: waving stems, leaves and tendrils in turn -------------------------------- */

static void leaf(FILE *f, tz_vec2 at, double angle, double size)
{
    const double c = cos(angle), s = sin(angle);
    static const double side[] = {0, 0, 0.3, 0.42, 0.75, 0.36, 1, 0};
    open_path(f, "#3d6b3a", 1.8);
    for (int half = 0; half < 2; half++)
        for (int k = 0; k < 4; k++) {
            const int i = half ? 3 - k : k;
            const double x = side[2 * i] * size,
                         y = (half ? -1 : 1) * side[2 * i + 1] * size;
            if (half == 1 && k == 0)
                continue;
            fprintf(f, "%s%.1f %.1f",
                    half + k == 0 ? "M"
                    : k == 1      ? "C"
                                  : " ",
                    at.x + c * x - s * y, at.y + s * x + c * y);
        }
    fputs("\"/>\n", f);
    open_path(f, "#3d6b3a", 1.1);
    fprintf(f, "M%.1f %.1fL%.1f %.1f\"/>\n", at.x, at.y, at.x + 0.72 * size * c,
            at.y + 0.72 * size * s);
}

static void tendril(FILE *f, tz_vec2 at, double angle, double turn)
{
    tz_vec2 p[24] = {at};
    double a = angle;
    for (int k = 1; k < 24; k++) {
        a += turn * (0.05 + 0.022 * k);
        p[k] = (tz_vec2){p[k - 1].x + (2.6 - 0.05 * k) * cos(a),
                         p[k - 1].y + (2.6 - 0.05 * k) * sin(a)};
    }
    open_path(f, "#8a6a3a", 1.3);
    smooth(f, p, 24, 0);
}

static void vine(const char *folder)
{
    tz_rng g = tz_rng_make(9, 1);
    FILE *f = begin(folder, "vine", "#f6f2e2");
    for (int stem = 0; stem < 6; stem++) {
        tz_vec2 p[48];
        const double x = SIDE * (stem + 0.5) / 6, phase = between(&g, 0, 6);
        for (int k = 0; k < 48; k++) {
            const double y = 9.5 * k - 20;
            p[k] = (tz_vec2){x + 13 * sin(y / 27 + phase) + 4 * sin(y / 61 + stem), y};
        }
        open_path(f, "#5c4a2c", 3);
        smooth(f, p, 48, 0);
        for (int k = 1; k < 46; k += 2) {
            const double along = atan2(p[k + 1].y - p[k - 1].y, p[k + 1].x - p[k - 1].x),
                         side = k / 2 % 2 ? 1 : -1;
            if (k / 2 % 5 == 4)
                tendril(f, p[k], along + side * 0.9, side * between(&g, 0.7, 1));
            else
                leaf(f, p[k], along + side * between(&g, 0.7, 1.2), between(&g, 21, 27));
        }
    }
    end(f);
}

int main(int argc, char **argv)
{
    if (argc != 2) {
        fputs("usage: draw_lines FOLDER\n", stderr);
        return 2;
    }
    streets(argv[1]);
    circuit(argv[1]);
    contours(argv[1]);
    grain(argv[1]);
    mud(argv[1]);
    vine(argv[1]);
    return 0;
}
