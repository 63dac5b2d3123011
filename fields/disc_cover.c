/* SPDX-License-Identifier: Apache-2.0 */
/* Signed distances on a grid of SIDE points (inside by scan lines, distances exact to the
 * nearest edge, which is handed on from point to point), then discs by the greedy rule of
 * set cover: of all discs that lie inside and touch the border, the one that covers most
 * of what is not covered yet. A disc counts as covering a rim of LARGER about it, or thin
 * corners would cost a disc each; of nearly equal gains the largest disc is taken, which
 * lies on the medial axis. At the end each disc moves to the best place within its own
 * part of the shape, which spaces the discs of a long shape evenly.
 * Discs whose parts of the shape (by least power) touch are joined; what is still apart is
 * joined by its shortest ways.
 *
 * The shape is the silhouette: the union of all polygons. By even and odd a vein, an eye
 * or a second coat of paint would be a hole, and distances be those to the vein. So edges
 * are cut to pieces, and those with the silhouette on both sides are left out. */
#include "fields/disc_cover.h"

#include <string.h>

enum {
    SIDE = 56,
    MARGIN = 4,
    ROOM = SIDE + 2 * MARGIN + 2,
    CELLS = ROOM * ROOM,
    FINE = 4, /* cells of the silhouette's mask along one of the grid */
    MASK = FINE * ROOM
};
#define LARGER 0.22

double tz_shape_distance_at(const tz_shape_distance *d, tz_vec2 at, tz_vec2 *slope)
{
    const double x = (at.x - d->origin.x) / d->cell, y = (at.y - d->origin.y) / d->cell;
    const double cx = fmin(fmax(x, 0), d->width - 1.001),
                 cy = fmin(fmax(y, 0), d->height - 1.001);
    const int32_t i = (int32_t)cx, j = (int32_t)cy;
    const double s = cx - i, t = cy - j;
    const float *p = d->v + (ptrdiff_t)j * d->width + i, *q = p + d->width;
    const double a = (double)p[0], b = (double)p[1], c = (double)q[0], e = (double)q[1];
    const double off = hypot(x - cx, y - cy) * d->cell;
    if (slope) {
        tz_vec2 g = {((b - a) * (1 - t) + (e - c) * t) / d->cell,
                     ((c - a) * (1 - s) + (e - b) * s) / d->cell};
        if (off > 0) {
            g.x -= (x - cx) * d->cell / off;
            g.y -= (y - cy) * d->cell / off;
        }
        *slope = g;
    }
    return (a * (1 - s) + b * s) * (1 - t) + (c * (1 - s) + e * s) * t - off;
}

/* ---- distances ---------------------------------------------------------------------- */

typedef struct edge {
    tz_vec2 a, b;
} edge;

typedef struct work {
    tz_shape_distance *d;
    edge *edge; /* of all polygons, each closed */
    int32_t edges;
    int32_t *part; /* first edge of each */
    int32_t parts;
    TZ_ARRAY(edge)
    rim;                 /* pieces of the silhouette's border */
    int32_t near[CELLS]; /* nearest piece known, -1 = none */
    bool mask[MASK * MASK], odd[MASK * MASK];
    bool in[CELLS];       /* inside */
    bool miss[CELLS];     /* not covered yet */
    int32_t sum[CELLS];   /* of miss in a row, up to and with a point */
    int16_t owner[CELLS]; /* disc of least power */
} work;

static double to_edge2(const edge *e, tz_vec2 p)
{
    const tz_vec2 d = tz_vec2_sub(e->b, e->a), v = tz_vec2_sub(p, e->a);
    const double l = tz_vec2_dot(d, d);
    const double t = l > 0 ? fmin(fmax(tz_vec2_dot(v, d) / l, 0), 1) : 0;
    const double x = v.x - t * d.x, y = v.y - t * d.y;
    return x * x + y * y;
}

static tz_vec2 place(const tz_shape_distance *d, int32_t at)
{
    return (tz_vec2){d->origin.x + at % d->width * d->cell,
                     d->origin.y + at / d->width * d->cell};
}

static void offer(work *w, int32_t at, int32_t e)
{
    float *v = &w->d->v[at];
    if (e < 0 || e == w->near[at])
        return;
    const double d2 = to_edge2(&w->rim.v[e], place(w->d, at));
    if (d2 < (double)*v)
        *v = (float)d2, w->near[at] = e;
}

/* Points about an edge learn of it. */
static void seed(work *w, int32_t e)
{
    const tz_shape_distance *d = w->d;
    const tz_vec2 a = w->rim.v[e].a, b = w->rim.v[e].b;
    const int32_t steps = 1 + (int32_t)(hypot(b.x - a.x, b.y - a.y) / d->cell * 2);
    for (int32_t k = 0; k <= steps; k++) {
        const double t = (double)k / steps;
        const int32_t x = (int32_t)((a.x + t * (b.x - a.x) - d->origin.x) / d->cell);
        const int32_t y = (int32_t)((a.y + t * (b.y - a.y) - d->origin.y) / d->cell);
        for (int32_t c = 0; c < 4; c++)
            offer(w, (y + c / 2) * d->width + x + c % 2, e);
    }
}

/* Two passes each way over rows; each point asks its neighbours. */
static void sweep(work *w)
{
    const int32_t n = w->d->width, rows = w->d->height;
    for (int pass = 0; pass < 4; pass++)
        for (int32_t k = 0; k < n * rows; k++) {
            const int32_t at = pass % 2 ? n * rows - 1 - k : k;
            const int32_t x = at % n, y = at / n;
            for (int32_t j = y > 0 ? y - 1 : 0; j <= y + 1 && j < rows; j++)
                for (int32_t i = x > 0 ? x - 1 : 0; i <= x + 1 && i < n; i++)
                    offer(w, at, w->near[j * n + i]);
        }
}

/* One polygon by crossings of each row of the mask. */
static void add_polygon(work *w, int32_t from, int32_t to)
{
    const tz_shape_distance *d = w->d;
    const double cell = d->cell / FINE;
    int32_t lo = MASK, hi = -1;
    for (int32_t e = from; e < to; e++) {
        const edge *g = &w->edge[e];
        const double y0 = (fmin(g->a.y, g->b.y) - d->origin.y) / cell,
                     y1 = (fmax(g->a.y, g->b.y) - d->origin.y) / cell;
        for (int32_t j = (int32_t)fmax(y0, 0); j <= y1 && j < MASK; j++) {
            const double y = d->origin.y + j * cell;
            if ((g->a.y > y) == (g->b.y > y))
                continue;
            const double x =
                g->a.x + (y - g->a.y) / (g->b.y - g->a.y) * (g->b.x - g->a.x);
            const double c = ceil((x - d->origin.x) / cell);
            if (c < MASK)
                w->odd[j * MASK + (int32_t)fmax(c, 0)] ^= 1;
            lo = j < lo ? j : lo, hi = j > hi ? j : hi;
        }
    }
    for (int32_t j = lo; j <= hi; j++) {
        bool in = false;
        for (int32_t i = j * MASK; i < (j + 1) * MASK; i++) {
            in ^= w->odd[i];
            w->odd[i] = false;
            w->mask[i] |= in;
        }
    }
}

static bool in_mask(const work *w, tz_vec2 p)
{
    const double cell = w->d->cell / FINE;
    const int32_t i = (int32_t)((p.x - w->d->origin.x) / cell + 0.5),
                  j = (int32_t)((p.y - w->d->origin.y) / cell + 0.5);
    return i >= 0 && i < MASK && j >= 0 && j < MASK && w->mask[j * MASK + i];
}

/* Pieces of an edge that have the silhouette on one side at most. */
static tz_status add_pieces(tz_ctx *ctx, work *w, const edge *g)
{
    const tz_vec2 v = tz_vec2_sub(g->b, g->a);
    const double l = tz_vec2_length(v), cell = w->d->cell;
    const int32_t n = 1 + (int32_t)(l / cell);
    const double off = l > 0 ? 1.6 * cell / FINE / l : 0;
    tz_status s = TZ_OK;
    for (int32_t k = 0; k < n && s == TZ_OK; k++) {
        const edge e = {tz_vec2_add(g->a, tz_vec2_scale(v, (double)k / n)),
                        tz_vec2_add(g->a, tz_vec2_scale(v, (k + 1.0) / n))};
        const tz_vec2 m = tz_vec2_scale(tz_vec2_add(e.a, e.b), 0.5);
        if (!in_mask(w, (tz_vec2){m.x - off * v.y, m.y + off * v.x}) ||
            !in_mask(w, (tz_vec2){m.x + off * v.y, m.y - off * v.x}))
            s = tz_array_push(ctx, &w->rim, e);
    }
    return s;
}

static tz_status find_silhouette(tz_ctx *ctx, work *w)
{
    const tz_shape_distance *d = w->d;
    tz_status s = TZ_OK;
    for (int32_t k = 0; k < w->parts; k++)
        add_polygon(w, w->part[k], k + 1 < w->parts ? w->part[k + 1] : w->edges);
    for (int32_t i = 0; i < d->width * d->height; i++)
        w->in[i] = w->mask[i / d->width * FINE * MASK + i % d->width * FINE];
    for (int32_t e = 0; e < w->edges && s == TZ_OK; e++)
        s = add_pieces(ctx, w, &w->edge[e]);
    return s;
}

static tz_status measure(tz_ctx *ctx, work *w, tz_vec2 lo, tz_vec2 hi)
{
    tz_shape_distance *d = w->d;
    const double longer = fmax(hi.x - lo.x, hi.y - lo.y);
    d->cell = longer / SIDE;
    d->width = (int32_t)ceil((hi.x - lo.x) / d->cell) + 2 * MARGIN + 1;
    d->height = (int32_t)ceil((hi.y - lo.y) / d->cell) + 2 * MARGIN + 1;
    d->width = d->width < ROOM ? d->width : ROOM;
    d->height = d->height < ROOM ? d->height : ROOM;
    d->origin = (tz_vec2){lo.x - MARGIN * d->cell, lo.y - MARGIN * d->cell};
    const int32_t n = d->width * d->height;
    tz_status s = tz_alloc(ctx, &d->v, (size_t)n, sizeof *d->v);
    if (s == TZ_OK)
        s = find_silhouette(ctx, w);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < n; i++)
        d->v[i] = 1e30f, w->near[i] = -1;
    for (int32_t e = 0; e < w->rim.n; e++)
        seed(w, e);
    sweep(w);
    for (int32_t i = 0; i < n; i++)
        d->v[i] = (w->in[i] ? 1 : -1) * sqrtf(d->v[i]);
    return TZ_OK;
}

/* ---- discs -------------------------------------------------------------------------- */

/* Sums along rows of what is missed, of all or of one disc's part. */
static void sum_rows(work *w, int only)
{
    const tz_shape_distance *d = w->d;
    int32_t sum = 0;
    for (int32_t i = 0; i < d->width * d->height; i++) {
        sum = i % d->width ? sum : 0;
        w->sum[i] = sum += w->miss[i] && (only < 0 || w->owner[i] == only);
    }
}

/* How much is missed under the disc at a point of the grid, its rim included. */
static int32_t gain_of(const work *w, int32_t at, double radius)
{
    const tz_shape_distance *d = w->d;
    const double r = radius * (1 + LARGER) / d->cell;
    const int32_t x = at % d->width, y = at / d->width, k = (int32_t)r;
    int32_t sum = 0;
    for (int32_t j = y - k < 0 ? 0 : y - k; j <= y + k && j < d->height; j++) {
        const int32_t h = (int32_t)sqrt(r * r - (double)(j - y) * (j - y));
        const int32_t to = x + h < d->width ? x + h : d->width - 1, from = x - h;
        const int32_t *row = w->sum + (ptrdiff_t)j * d->width;
        sum += row[to] - (from > 0 ? row[from - 1] : 0);
    }
    return sum;
}

static void take(work *w, int32_t at, double radius)
{
    const tz_shape_distance *d = w->d;
    const double r = radius * (1 + LARGER);
    const tz_vec2 c = place(d, at);
    for (int32_t i = 0; i < d->width * d->height; i++) {
        const tz_vec2 p = place(d, i);
        if (w->in[i] && hypot(p.x - c.x, p.y - c.y) <= r)
            w->miss[i] = false;
    }
}

/* The disc of greatest gain; of gains within 2 % the largest disc. */
static int32_t best_disc(work *w, int only, double *gain)
{
    const tz_shape_distance *d = w->d;
    int32_t best = -1;
    double radius = 0;
    *gain = 0;
    sum_rows(w, only);
    for (int32_t i = 0; i < d->width * d->height; i++) {
        const double r = (double)d->v[i];
        const double most =
            TZ_PI * r * r * (1 + LARGER) * (1 + LARGER) / (d->cell * d->cell);
        if (!w->in[i] || 1.2 * most + 4 < *gain || (only >= 0 && w->owner[i] != only))
            continue;
        const double g = gain_of(w, i, r);
        if (g > 1.02 * *gain || (g > 0.98 * *gain && r > radius))
            best = i, *gain = fmax(g, *gain), radius = r;
    }
    return best;
}

static void add_disc(tz_disc_cover *c, tz_vec2 at, double radius)
{
    c->disc[c->n++] = (tz_disc){at, fmax(radius, 0.25 * c->distance.cell)};
}

static void greedy(work *w, tz_disc_cover *c, int32_t most, double share)
{
    const tz_shape_distance *d = w->d;
    double all = 0, left;
    for (int32_t i = 0; i < d->width * d->height; i++)
        all += w->miss[i] = w->in[i];
    left = all;
    while (c->n < most && left > (1 - share) * all) {
        double gain;
        const int32_t i = best_disc(w, -1, &gain);
        if (i < 0 || gain < 0.02 * all)
            break;
        left -= gain;
        add_disc(c, place(d, i), (double)d->v[i]);
        take(w, i, (double)d->v[i]);
    }
}

static void find_owners(work *w, const tz_disc_cover *c)
{
    const tz_shape_distance *d = w->d;
    for (int32_t i = 0; i < d->width * d->height; i++) {
        const tz_vec2 p = place(d, i);
        double least = HUGE_VAL;
        w->owner[i] = -1;
        for (int k = 0; k < c->n && w->in[i]; k++) {
            const double x = p.x - c->disc[k].at.x, y = p.y - c->disc[k].at.y;
            const double power = x * x + y * y - c->disc[k].radius * c->disc[k].radius;
            if (power < least)
                least = power, w->owner[i] = (int16_t)k;
        }
    }
}

/* Each disc in turn covers as much of its own part as it can. */
static void refine(work *w, tz_disc_cover *c)
{
    const tz_shape_distance *d = w->d;
    for (int round = 0; round < 4; round++) {
        find_owners(w, c);
        for (int32_t i = 0; i < d->width * d->height; i++)
            w->miss[i] = w->in[i];
        for (int k = 0; k < c->n; k++) {
            double gain;
            const int32_t i = best_disc(w, k, &gain);
            if (i < 0)
                continue;
            c->disc[k].at = place(d, i);
            c->disc[k].radius = fmax((double)d->v[i], 0.25 * d->cell);
        }
    }
    find_owners(w, c);
}

static void sort_discs(tz_disc_cover *c)
{
    for (int i = 1; i < c->n; i++)
        for (int j = i; j > 0 && c->disc[j].radius > c->disc[j - 1].radius; j--) {
            const tz_disc t = c->disc[j];
            c->disc[j] = c->disc[j - 1], c->disc[j - 1] = t;
        }
}

/* ---- graph -------------------------------------------------------------------------- */

static void join(tz_disc_cover *c, int a, int b)
{
    if (c->edges < 4 * TZ_COVER_DISCS) {
        c->edge[c->edges][0] = a < b ? a : b;
        c->edge[c->edges++][1] = a < b ? b : a;
    }
}

static int root_of(const int *up, int i)
{
    while (up[i] != i)
        i = up[i];
    return i;
}

/* Shortest ways first between what is apart; n is small. */
static void connect(tz_disc_cover *c, int *up)
{
    for (int left = c->n; left > 1; left--) {
        int a = -1, b = -1;
        double least = HUGE_VAL;
        for (int i = 0; i < c->n; i++)
            for (int j = i + 1; j < c->n; j++) {
                const tz_vec2 v = tz_vec2_sub(c->disc[j].at, c->disc[i].at);
                const double gap =
                    tz_vec2_length(v) - c->disc[i].radius - c->disc[j].radius;
                if (root_of(up, i) != root_of(up, j) && gap < least)
                    least = gap, a = i, b = j;
            }
        if (a < 0)
            return;
        join(c, a, b);
        up[root_of(up, a)] = root_of(up, b);
    }
}

static void make_graph(const work *w, tz_disc_cover *c)
{
    const tz_shape_distance *d = w->d;
    int touch[TZ_COVER_DISCS][TZ_COVER_DISCS] = {{0}}, up[TZ_COVER_DISCS];
    for (int32_t i = 0; i + d->width + 1 < d->width * d->height; i++) {
        const int a = w->owner[i];
        for (int k = 0; k < 2; k++) {
            const int b = w->owner[k ? i + d->width : i + 1];
            if (a >= 0 && b >= 0 && a != b)
                touch[a < b ? a : b][a < b ? b : a]++;
        }
    }
    for (int i = 0; i < c->n; i++)
        up[i] = i;
    for (int i = 0; i < c->n; i++)
        for (int j = i + 1; j < c->n; j++)
            if (touch[i][j] >= 2) {
                join(c, i, j);
                up[root_of(up, i)] = root_of(up, j);
            }
    connect(c, up);
}

static void measure_cover(const work *w, tz_disc_cover *c)
{
    const tz_shape_distance *d = w->d;
    double in = 0, both = 0, discs = 0, area = 0;
    for (int32_t i = 0; i < d->width * d->height; i++) {
        const tz_vec2 p = place(d, i);
        bool under = false;
        for (int k = 0; k < c->n && !under; k++)
            under =
                hypot(p.x - c->disc[k].at.x, p.y - c->disc[k].at.y) <= c->disc[k].radius;
        area += fmin(fmax((double)d->v[i] / d->cell + 0.5, 0), 1);
        in += w->in[i], discs += under, both += under && w->in[i];
    }
    c->area = area * d->cell * d->cell; /* border cells in part */
    c->covered = in > 0 ? both / in : 0;
    c->beyond = discs > 0 ? 1 - both / discs : 0;
}

/* ---- whole -------------------------------------------------------------------------- */

void tz_disc_cover_deinit(tz_disc_cover *c)
{
    tz_free(c->ctx, c->distance.v);
    *c = (tz_disc_cover){0};
}

static tz_status check(tz_ctx *ctx, const tz_vec2 *point, int32_t points, double radius)
{
    if (!(radius > 0) || !isfinite(radius))
        return tz_fail(ctx, TZ_INVALID, "a shape of radius %g has no discs", radius);
    for (int32_t i = 0; i < points; i++)
        if (!isfinite(point[i].x) || !isfinite(point[i].y) ||
            hypot(point[i].x, point[i].y) > 1e6 * radius)
            return tz_fail(ctx, TZ_INVALID, "point %d of an outline is out of range", i);
    return TZ_OK;
}

/* Edges of all polygons; a disc of 48 where there is none. */
static tz_status collect(tz_ctx *ctx, work *w, const tz_vec2 *point, int32_t points,
                         const int32_t *part, int32_t parts, double radius)
{
    enum { ROUND = 48 };
    const bool round = points < 3 || parts < 1;
    tz_status s =
        tz_alloc(ctx, &w->edge, (size_t)(round ? ROUND : points), sizeof *w->edge);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &w->part, (size_t)(round ? 1 : parts), sizeof *w->part);
    if (s != TZ_OK)
        return s;
    w->parts = round ? 1 : parts;
    for (int k = 0; k < ROUND && round; k++) {
        const double a = 2 * TZ_PI * k / ROUND, b = 2 * TZ_PI * (k + 1) / ROUND;
        w->edge[w->edges++] = (edge){{radius * cos(a), radius * sin(a)},
                                     {radius * cos(b), radius * sin(b)}};
    }
    for (int32_t k = 0; k < parts && !round; k++) {
        const int32_t from = part[k], to = k + 1 < parts ? part[k + 1] : points;
        w->part[k] = w->edges;
        for (int32_t i = from; i < to; i++)
            w->edge[w->edges++] = (edge){point[i], point[i + 1 < to ? i + 1 : from]};
    }
    return TZ_OK;
}

tz_status tz_disc_cover_init(tz_ctx *ctx, const tz_vec2 *point, int32_t points,
                             const int32_t *part, int32_t parts, double radius,
                             int32_t most, double share, tz_disc_cover *c)
{
    work *w = NULL;
    *c = (tz_disc_cover){.ctx = ctx};
    tz_status s = check(ctx, point, points, radius);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &w, 1, sizeof *w);
    if (s != TZ_OK)
        return s;
    w->d = &c->distance;
    s = collect(ctx, w, point, points, part, parts, radius);
    tz_vec2 lo = {HUGE_VAL, HUGE_VAL}, hi = {-HUGE_VAL, -HUGE_VAL};
    for (int32_t e = 0; e < w->edges; e++) {
        const tz_vec2 p = w->edge[e].a;
        lo = (tz_vec2){fmin(lo.x, p.x), fmin(lo.y, p.y)};
        hi = (tz_vec2){fmax(hi.x, p.x), fmax(hi.y, p.y)};
    }
    if (s == TZ_OK && !(fmax(hi.x - lo.x, hi.y - lo.y) > 1e-9 * radius))
        lo = (tz_vec2){lo.x - radius, lo.y - radius},
        hi = (tz_vec2){hi.x + radius, hi.y + radius};
    if (s == TZ_OK)
        s = measure(ctx, w, lo, hi);
    if (s == TZ_OK) {
        most = most < 1 ? 1 : most > TZ_COVER_DISCS ? TZ_COVER_DISCS : most;
        greedy(w, c, most, share);
        if (c->n == 0) /* thinner than the grid can tell */
            add_disc(c, (tz_vec2){(lo.x + hi.x) / 2, (lo.y + hi.y) / 2}, 0.02 * radius);
        refine(w, c);
        sort_discs(c);
        find_owners(w, c);
        make_graph(w, c);
        measure_cover(w, c);
    }
    tz_free(ctx, w->edge);
    tz_free(ctx, w->part);
    tz_array_free(ctx, &w->rim);
    tz_free(ctx, w);
    if (s != TZ_OK)
        tz_disc_cover_deinit(c);
    return s;
}
