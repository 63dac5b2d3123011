/* SPDX-License-Identifier: Apache-2.0 */
/* Where paths touch and cross. Pieces are flattened to chords, chords lie in the cells of
 * a uniform grid, and only chords of one cell are held against each other. A crossing of
 * chords is refined on the cubics by Newton steps. A crossing belongs to the cell that it
 * lies in, so that none is found twice. */
#include "curves/curve_join_internal.h"

#include <stdlib.h>

enum { MAX_CROSSINGS = 8000000, MAX_CUTS = 4 * MAX_CROSSINGS, MAX_TOUCHING = 250 };
#define MAX_PAIRS  1e9
#define MAX_COPIES 1e4

typedef struct chord {
    tz_vec2 p, q;
    int32_t piece, number; /* of this chord within it */
    float t0, t1;
    tz_vec2 by; /* on a torus: this copy is moved so far */
} chord;

typedef struct cells {
    tz_vec2 origin;
    double cell;
    int32_t nx, ny;
    int32_t *first; /* nx * ny + 1 */
    int32_t *chord;
} cells;

typedef struct finder {
    tz_curve_work *w;
    TZ_ARRAY(chord)
    chord;
    cells grid;
    tz_grid node;  /* all nodes, those of crossings too; ids are nodes */
    int32_t first; /* node of a crossing */
} finder;

/* ---- chords ----------------------------------------------------------------------- */

/* A chord; on a torus all its copies that come near the rectangle. */
static tz_status add_chord(finder *f, chord c)
{
    const tz_domain *d = &f->w->set.domain;
    const double r = 2 * f->w->reach;
    if (!d->torus)
        return tz_array_push(f->w->ctx, &f->chord, c);
    const chord at = c;
    const double x0 = ceil((-r - fmax(c.p.x, c.q.x)) / d->size.x),
                 x1 = floor((d->size.x + r - fmin(c.p.x, c.q.x)) / d->size.x),
                 y0 = ceil((-r - fmax(c.p.y, c.q.y)) / d->size.y),
                 y1 = floor((d->size.y + r - fmin(c.p.y, c.q.y)) / d->size.y);
    tz_status s = TZ_OK;
    if (!((x1 - x0) * (y1 - y0) < MAX_COPIES))
        return tz_fail(f->w->ctx, TZ_LIMIT,
                       "piece %d runs around the torus over and over; shorten it",
                       c.piece);
    for (double y = y0; y <= y1; y++)
        for (double x = x0; x <= x1 && s == TZ_OK; x++) {
            c.by = (tz_vec2){x * d->size.x, y * d->size.y};
            c.p = tz_vec2_add(at.p, c.by);
            c.q = tz_vec2_add(at.q, c.by);
            s = tz_array_push(f->w->ctx, &f->chord, c);
        }
    return s;
}

static tz_status flatten(finder *f)
{
    const tz_curve_set *set = &f->w->set;
    const double tolerance = fmax(f->w->same, f->w->reach / 8);
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < set->piece.n && s == TZ_OK; i++) {
        const tz_bezier c = tz_curve_bezier(set, &set->piece.v[i]);
        const int32_t n =
            set->piece.v[i].straight ? 1 : 1 + tz_bezier_steps(&c, tolerance);
        tz_vec2 p = c.p[0];
        for (int32_t k = 1; k <= n && s == TZ_OK; k++) {
            const tz_vec2 q = k == n ? c.p[3] : tz_bezier_at(&c, (double)k / n);
            s = add_chord(f, (chord){.p = p,
                                     .q = q,
                                     .piece = i,
                                     .number = k,
                                     .t0 = (float)(k - 1) / (float)n,
                                     .t1 = (float)k / (float)n});
            p = q;
        }
    }
    return s;
}

/* ---- cells ------------------------------------------------------------------------ */

static int32_t clamp(double x, int32_t n)
{
    return !(x > 0) ? 0 : x >= n ? n - 1 : (int32_t)x;
}

typedef void (*cell_visit)(void *user, int32_t cell);

/* The cells that a chord, `pad` thick, touches: row by row the stretch it has there. */
static void visit(const cells *g, tz_vec2 p, tz_vec2 q, double pad, cell_visit call,
                  void *user)
{
    if (p.y > q.y) {
        const tz_vec2 swap = p;
        p = q, q = swap;
    }
    const int32_t y0 = clamp((p.y - pad - g->origin.y) / g->cell, g->ny),
                  y1 = clamp((q.y + pad - g->origin.y) / g->cell, g->ny);
    const double slope = q.y > p.y ? (q.x - p.x) / (q.y - p.y) : 0;
    for (int32_t y = y0; y <= y1; y++) {
        const double top = fmax(p.y, g->origin.y + y * g->cell - pad),
                     bottom = fmin(q.y, g->origin.y + (y + 1) * g->cell + pad);
        double a = p.x, b = q.x;
        if (q.y > p.y && y0 < y1) {
            a = p.x + slope * (fmin(top, q.y) - p.y);
            b = p.x + slope * (fmax(bottom, p.y) - p.y);
        }
        const double more = pad + 1e-9 * g->cell;
        const int32_t x0 = clamp((fmin(a, b) - more - g->origin.x) / g->cell, g->nx),
                      x1 = clamp((fmax(a, b) + more - g->origin.x) / g->cell, g->nx);
        for (int32_t x = x0; x <= x1; x++)
            call(user, y * g->nx + x);
    }
}

typedef struct filler {
    cells *g;
    int32_t chord;
    int64_t total;
} filler;

static void count(void *user, int32_t cell)
{
    filler *f = user;
    f->g->first[cell + 1]++;
    f->total++;
}

static void fill(void *user, int32_t cell)
{
    filler *f = user;
    f->g->chord[f->g->first[cell]++] = f->chord;
}

static tz_status fill_cells(finder *f)
{
    cells *g = &f->grid;
    filler k = {.g = g};
    const size_t n = (size_t)g->nx * (size_t)g->ny;
    tz_status s = tz_alloc_zero(f->w->ctx, &g->first, n + 2, sizeof *g->first);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < f->chord.n; i++)
        visit(g, f->chord.v[i].p, f->chord.v[i].q, 0, count, &k);
    if (k.total > INT32_MAX / 2)
        return tz_fail(f->w->ctx, TZ_LIMIT,
                       "%d pieces of curve are too many for one drawing; split it",
                       f->w->set.piece.n);
    for (size_t i = 0; i < n; i++)
        g->first[i + 1] += g->first[i];
    s = tz_alloc(f->w->ctx, &g->chord, (size_t)k.total, sizeof *g->chord);
    if (s != TZ_OK)
        return s;
    for (k.chord = 0; k.chord < f->chord.n; k.chord++)
        visit(g, f->chord.v[k.chord].p, f->chord.v[k.chord].q, 0, fill, &k);
    for (size_t i = n; i > 0; i--) /* the filling has moved each to the next */
        g->first[i] = g->first[i - 1];
    g->first[0] = 0;
    return TZ_OK;
}

static tz_status make_cells(finder *f)
{
    cells *g = &f->grid;
    tz_vec2 lo = {INFINITY, INFINITY}, hi = {-INFINITY, -INFINITY};
    for (int32_t i = 0; i < f->chord.n; i++)
        for (int k = 0; k < 2; k++) {
            const tz_vec2 p = k ? f->chord.v[i].q : f->chord.v[i].p;
            lo = (tz_vec2){fmin(lo.x, p.x), fmin(lo.y, p.y)};
            hi = (tz_vec2){fmax(hi.x, p.x), fmax(hi.y, p.y)};
        }
    if (f->w->set.domain.torus) {
        const double r = 2 * f->w->reach;
        lo = (tz_vec2){-r, -r};
        hi = (tz_vec2){f->w->set.domain.size.x + r, f->w->set.domain.size.y + r};
    }
    const double w = hi.x - lo.x, h = hi.y - lo.y, most = fmax(w, h);
    /* about one chord a cell, and no more than 4096 cells a side */
    g->cell = fmax(sqrt(w * h / fmax(f->chord.n, 1)), most / 4096);
    g->cell = fmax(g->cell, 2 * f->w->same);
    g->origin = lo;
    g->nx = (int32_t)fmin(4096, floor(w / g->cell) + 1);
    g->ny = (int32_t)fmin(4096, floor(h / g->cell) + 1);
    return fill_cells(f);
}

/* ---- nodes on pieces -------------------------------------------------------------- */

static tz_status add_cut(finder *f, int32_t piece, double t, int32_t node)
{
    const tz_curve_piece *p = &f->w->set.piece.v[piece];
    if (p->from == node || p->to == node)
        return TZ_OK;
    if (f->w->cut.n >= MAX_CUTS)
        return tz_fail(
            f->w->ctx, TZ_LIMIT,
            "the curves touch and cross in over %d places; thin out the drawing",
            MAX_CUTS);
    return tz_array_push(f->w->ctx, &f->w->cut, ((tz_curve_cut){piece, node, t}));
}

/* Place of q along the chord, 0 .. 1, and its squared distance. */
static double project(const chord *c, tz_vec2 q, double *distance)
{
    const tz_vec2 d = tz_vec2_sub(c->q, c->p), e = tz_vec2_sub(q, c->p);
    const double n = tz_vec2_dot(d, d);
    const double u = n > 0 ? fmin(1, fmax(0, tz_vec2_dot(d, e) / n)) : 0;
    const tz_vec2 r = tz_vec2_sub(e, tz_vec2_scale(d, u));
    *distance = tz_vec2_dot(r, r);
    return u;
}

/* Nearest places of one node on the pieces about it. */
typedef struct touching {
    finder *f;
    int32_t node;
    double reach;
    tz_status status;
    TZ_ARRAY(tz_curve_cut)
    near;
    TZ_ARRAY(double)
    distance;
} touching;

static void touch_cell(void *user, int32_t cell)
{
    touching *k = user;
    const finder *f = k->f;
    const tz_vec2 q = f->w->set.node.v[k->node];
    for (int32_t i = f->grid.first[cell];
         i < f->grid.first[cell + 1] && k->status == TZ_OK; i++) {
        const chord *c = &f->chord.v[f->grid.chord[i]];
        const tz_curve_piece *p = &f->w->set.piece.v[c->piece];
        double d;
        if (p->from == k->node || p->to == k->node)
            continue;
        const double u = project(c, q, &d);
        if (!(d <= k->reach * k->reach))
            continue;
        const tz_curve_cut cut = {c->piece, k->node,
                                  (double)c->t0 + u * (double)(c->t1 - c->t0)};
        int32_t at = 0;
        while (at < k->near.n && k->near.v[at].piece != c->piece)
            at++;
        if (at >= MAX_TOUCHING) {
            k->status = tz_fail(f->w->ctx, TZ_LIMIT,
                                "over %d curves touch in one spot; thin out the drawing",
                                MAX_TOUCHING);
        } else if (at == k->near.n) {
            k->status = tz_array_push(f->w->ctx, &k->near, cut);
            if (k->status == TZ_OK)
                k->status = tz_array_push(f->w->ctx, &k->distance, d);
        } else if (d < k->distance.v[at]) {
            k->near.v[at] = cut;
            k->distance.v[at] = d;
        }
    }
}

static double nearness(const finder *f, tz_vec2 p, int32_t node)
{
    return tz_curve_apart(&f->w->set, p, f->w->set.node.v[node]);
}

/* Whether the cut is a place where the piece is not cut in vain: off its own ends, and
 * not just where the path comes from. */
static bool worth(const finder *f, const tz_curve_cut *c, double along_end,
                  int32_t path_end)
{
    const tz_curve_work *w = f->w;
    const tz_curve_piece *p = &w->set.piece.v[c->piece];
    const tz_bezier b = tz_curve_bezier(&w->set, p);
    const tz_vec2 at = tz_bezier_at(&b, c->t);
    if (nearness(f, at, p->from) <= w->same || nearness(f, at, p->to) <= w->same)
        return false;
    if (w->path[c->piece] != path_end)
        return true;
    const tz_bezier head = tz_bezier_part(&b, 0, c->t);
    const double along = w->along[c->piece] + tz_bezier_length(&head);
    return fabs(along - along_end) > 4 * w->reach;
}

enum { NO_END = -1, UNUSED = -2 }; /* in place of the path that ends in a node */

/* T-junctions: nodes, and with more reach ends of paths, that lie on a piece. */
static tz_status find_touching(finder *f, const double *along_end,
                               const int32_t *path_end)
{
    tz_curve_work *w = f->w;
    touching k = {.f = f};
    for (k.node = 0; k.node < f->first && k.status == TZ_OK; k.node++) {
        const tz_vec2 p = w->set.node.v[k.node];
        if (path_end[k.node] == UNUSED)
            continue;
        k.reach = w->end[k.node] ? w->reach : w->same;
        k.near.n = k.distance.n = 0;
        visit(&f->grid, p, p, k.reach, touch_cell, &k);
        for (int32_t i = 0; i < k.near.n && k.status == TZ_OK; i++)
            if (worth(f, &k.near.v[i], along_end[k.node], path_end[k.node]))
                k.status = add_cut(f, k.near.v[i].piece, k.near.v[i].t, k.node);
        if (k.status == TZ_OK && !(k.node & 4095) && tz_ctx_cancelled(w->ctx))
            k.status = TZ_CANCELLED;
    }
    tz_array_free(w->ctx, &k.near);
    tz_array_free(w->ctx, &k.distance);
    return k.status;
}

/* ---- crossings -------------------------------------------------------------------- */

/* Newton on p(t) = q(u); false if it runs away. */
static bool refine(const tz_bezier *p, const tz_bezier *q, double *t, double *u)
{
    double x = *t, y = *u;
    for (int i = 0; i < 6; i++) {
        const tz_vec2 e = tz_vec2_sub(tz_bezier_at(p, x), tz_bezier_at(q, y));
        const tz_vec2 a = tz_bezier_slope(p, x), b = tz_bezier_slope(q, y);
        const double det = b.x * a.y - a.x * b.y;
        if (!(fabs(det) > 1e-12 * tz_vec2_length(a) * tz_vec2_length(b)))
            return false;
        x += (b.y * e.x - b.x * e.y) / det;
        y += (a.y * e.x - a.x * e.y) / det;
        if (!(fabs(x - *t) < 0.25 && fabs(y - *u) < 0.25))
            return false;
    }
    if (x < 0 || x > 1 || y < 0 || y > 1)
        return false;
    *t = x, *u = y;
    return true;
}

/* Where chords cross inside of both, by the signs of areas. */
static bool cross(const chord *a, const chord *b, double *u, double *v)
{
    const tz_vec2 d = tz_vec2_sub(a->q, a->p), e = tz_vec2_sub(b->q, b->p),
                  r = tz_vec2_sub(b->p, a->p);
    const double det = d.x * e.y - d.y * e.x;
    if (!(fabs(det) > 1e-12 * tz_vec2_length(d) * tz_vec2_length(e)))
        return false;
    *u = (r.x * e.y - r.y * e.x) / det;
    *v = (r.x * d.y - r.y * d.x) / det;
    return *u >= 0 && *u <= 1 && *v >= 0 && *v <= 1;
}

/* The node for a crossing: one that is there, or a new one. */
static tz_status crossing_node(finder *f, tz_vec2 at, int32_t *out)
{
    enum { MOST = 64 };
    tz_curve_work *w = f->w;
    int32_t near[MOST], id;
    int32_t n = tz_grid_query(&f->node, at, w->reach, near, MOST);
    double best = INFINITY;
    *out = -1;
    for (int32_t i = 0; i < (n < MOST ? n : MOST); i++) {
        const double d = nearness(f, at, near[i]);
        const bool inner = near[i] < f->first && !w->end[near[i]];
        if (d < best && (!inner || d <= w->same)) {
            best = d;
            *out = near[i];
        }
    }
    if (*out >= 0)
        return TZ_OK;
    if (w->set.node.n - f->first >= MAX_CROSSINGS)
        return tz_fail(w->ctx, TZ_LIMIT, "over %d crossings of curves; split the drawing",
                       MAX_CROSSINGS);
    const tz_vec3 in = tz_domain_wrap(&w->set.domain, (tz_vec3){at.x, at.y, 0});
    tz_status s = tz_curve_add_node(&w->set, (tz_vec2){in.x, in.y}, out);
    return s == TZ_OK ? tz_grid_add(w->ctx, &f->node, at, &id) : s;
}

static bool neighbours(const finder *f, int32_t i, int32_t j)
{
    const chord *a = &f->chord.v[i], *b = &f->chord.v[j];
    return a->piece == b->piece && abs(a->number - b->number) <= 1 &&
           a->by.x == b->by.x && a->by.y == b->by.y;
}

/* On a torus a crossing counts where it lies in the rectangle. */
static bool in_rectangle(const finder *f, double x, double y)
{
    const tz_domain *d = &f->w->set.domain;
    return !d->torus || (x >= 0 && y >= 0 && x < d->size.x && y < d->size.y);
}

static tz_bezier moved(const tz_curve_set *set, const chord *c)
{
    tz_bezier b = tz_curve_bezier(set, &set->piece.v[c->piece]);
    for (int k = 0; k < 4; k++)
        b.p[k] = tz_vec2_add(b.p[k], c->by);
    return b;
}

static tz_status cross_pair(finder *f, int32_t i, int32_t j, int32_t cell)
{
    const chord *a = &f->chord.v[i], *b = &f->chord.v[j];
    const tz_curve_set *set = &f->w->set;
    const cells *g = &f->grid;
    double u, v;
    int32_t node = -1;
    if (neighbours(f, i, j) || !cross(a, b, &u, &v))
        return TZ_OK;
    const double x = a->p.x + u * (a->q.x - a->p.x), y = a->p.y + u * (a->q.y - a->p.y);
    if (clamp((y - g->origin.y) / g->cell, g->ny) * g->nx +
                clamp((x - g->origin.x) / g->cell, g->nx) !=
            cell ||
        !in_rectangle(f, x, y))
        return TZ_OK;
    double t = (double)a->t0 + u * (double)(a->t1 - a->t0);
    double r = (double)b->t0 + v * (double)(b->t1 - b->t0);
    const tz_bezier p = moved(set, a), q = moved(set, b);
    if (!set->piece.v[a->piece].straight || !set->piece.v[b->piece].straight)
        refine(&p, &q, &t, &r); /* else the chords' own */
    tz_status s = crossing_node(f, tz_bezier_at(&p, t), &node);
    if (s == TZ_OK)
        s = add_cut(f, a->piece, t, node);
    return s == TZ_OK ? add_cut(f, b->piece, r, node) : s;
}

static tz_status find_crossings(finder *f)
{
    const cells *g = &f->grid;
    const int32_t n = g->nx * g->ny;
    double pairs = 0;
    tz_status s = TZ_OK;
    for (int32_t c = 0; c < n; c++) {
        const double k = g->first[c + 1] - g->first[c];
        pairs += k * (k - 1) / 2;
    }
    if (pairs > MAX_PAIRS)
        return tz_fail(
            f->w->ctx, TZ_LIMIT,
            "%d pieces of curve lie on top of each other; thin out the drawing",
            f->w->set.piece.n);
    for (int32_t c = 0; c < n && s == TZ_OK; c++) {
        for (int32_t i = g->first[c]; i < g->first[c + 1] && s == TZ_OK; i++)
            for (int32_t j = i + 1; j < g->first[c + 1] && s == TZ_OK; j++)
                s = cross_pair(f, g->chord[i], g->chord[j], c);
        if (s == TZ_OK && !(c & 255) && tz_ctx_cancelled(f->w->ctx))
            s = TZ_CANCELLED;
    }
    return s;
}

/* ---- all --------------------------------------------------------------------------- */

/* Where along which path each end of a path lies; nodes that were merged into others are
 * none any more. */
static void place_ends(const tz_curve_work *w, double *along, int32_t *path)
{
    const tz_curve_set *set = &w->set;
    for (int32_t i = 0; i < set->node.n; i++)
        path[i] = UNUSED;
    for (int32_t i = 0; i < set->piece.n; i++)
        path[set->piece.v[i].from] = path[set->piece.v[i].to] = NO_END;
    for (int32_t i = 0; i < set->path.n; i++) {
        const tz_curve_path *p = &set->path.v[i];
        const int32_t last = p->piece + p->pieces - 1;
        const tz_bezier b = tz_curve_bezier(set, &set->piece.v[last]);
        const int32_t from = set->piece.v[p->piece].from, to = set->piece.v[last].to;
        path[from] = path[to] = i;
        along[from] = 0;
        along[to] = w->along[last] + tz_bezier_length(&b);
    }
}

tz_status tz_curve_find_cuts(tz_curve_work *w)
{
    finder f = {.w = w, .first = w->set.node.n};
    double *along = NULL;
    int32_t *path = NULL, id;
    w->cut.n = 0;
    if (w->set.piece.n == 0)
        return TZ_OK;
    tz_status s = tz_alloc_zero(w->ctx, &along, (size_t)f.first, sizeof *along);
    if (s == TZ_OK)
        s = tz_alloc(w->ctx, &path, (size_t)f.first, sizeof *path);
    if (s == TZ_OK)
        s = flatten(&f);
    if (s == TZ_OK)
        s = make_cells(&f);
    if (s == TZ_OK)
        place_ends(w, along, path);
    if (s == TZ_OK)
        s = find_touching(&f, along, path);
    if (s == TZ_OK && w->crossings) {
        const tz_vec2 size = {fmax(f.grid.nx * f.grid.cell, f.grid.cell),
                              fmax(f.grid.ny * f.grid.cell, f.grid.cell)};
        const tz_domain *d = &w->set.domain;
        s = tz_grid_init(w->ctx, &f.node, d->torus ? (tz_vec2){0, 0} : f.grid.origin,
                         d->torus ? (tz_vec2){d->size.x, d->size.y} : size,
                         fmax(f.grid.cell, w->reach), d->torus);
        for (int32_t i = 0; i < f.first && s == TZ_OK; i++)
            s = tz_grid_add(w->ctx, &f.node, w->set.node.v[i], &id);
        if (s == TZ_OK)
            s = find_crossings(&f);
        tz_grid_deinit(w->ctx, &f.node);
    }
    tz_array_free(w->ctx, &f.chord);
    tz_free(w->ctx, f.grid.first);
    tz_free(w->ctx, f.grid.chord);
    tz_free(w->ctx, along);
    tz_free(w->ctx, path);
    return s;
}
