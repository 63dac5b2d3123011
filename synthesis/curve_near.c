/* SPDX-License-Identifier: Apache-2.0 */
/* Nearest pieces. Pieces are cut into short chords, which lie in a grid. For a block of
 * places about m with radius h, the distance D from m to its nearest chord is found ring by
 * ring; the nearest chord of any place of the block then lies within D + 2 h of m, since
 *
 *     |chord, m| <= |chord, place| + h <= |nearest of m, place| + h <= D + 2 h
 *
 * These few are tried at each place, and the best is refined on the cubic itself. What comes
 * out is exact, so that it does not depend on how places are put into blocks. */
#include "synthesis/curve_near_internal.h"

#include <string.h>

enum { BLOCK = 8, SPAN = 32, CELLS_MAX = 1 << 22, RINGS_MAX = 4096 };

/* ---- making ---------------------------------------------------------------------------- */

static tz_status add_chords(tz_ctx *ctx, tz_near *n, int32_t piece, double longest)
{
    const tz_bezier *c = &n->piece.v[piece].at;
    const int32_t flat = tz_bezier_steps(c, TZ_NEAR_FLAT);
    double length = 0;
    for (int k = 0; k < 3; k++)
        length += tz_vec2_length(tz_vec2_sub(c->p[k + 1], c->p[k]));
    const double cut = ceil(length / longest);
    const int32_t steps = cut > flat ? (int32_t)fmin(cut, 100000) : flat;
    tz_vec2 last = c->p[0];
    tz_status s = TZ_OK;
    for (int32_t k = 1; k <= steps && s == TZ_OK; k++) {
        const float t0 = (float)(k - 1) / (float)steps, t1 = (float)k / (float)steps;
        const tz_vec2 p = k < steps ? tz_bezier_at(c, (double)t1) : c->p[3];
        s = tz_array_push(ctx, &n->chord, ((tz_near_chord){last, p, piece, t0, t1}));
        last = p;
    }
    return s;
}

static tz_status add_pieces(tz_ctx *ctx, const tz_curve_set *set, tz_near *n)
{
    const double sx = n->canvas.sx, sy = n->canvas.sy;
    tz_status s = tz_array_reserve(ctx, &n->piece, set->piece.n);
    for (int32_t i = 0; i < set->path.n && s == TZ_OK; i++) {
        const tz_curve_path *p = &set->path.v[i];
        double before = 0;
        for (int32_t k = p->piece; k < p->piece + p->pieces && s == TZ_OK; k++) {
            const tz_curve_piece *c = &set->piece.v[k];
            tz_near_piece q = {.at = tz_curve_bezier(set, c),
                               .node = {c->from, c->to},
                               .path = i,
                               .before = before};
            for (int m = 0; m < 4; m++)
                q.at.p[m] = (tz_vec2){q.at.p[m].x * sx, q.at.p[m].y * sy};
            before += tz_bezier_length(&q.at);
            n->piece.v[n->piece.n++] = q;
            if (!(fabs(q.at.p[0].x) < 1e8 && fabs(q.at.p[0].y) < 1e8 &&
                  fabs(q.at.p[1].x) < 1e8 && fabs(q.at.p[1].y) < 1e8 &&
                  fabs(q.at.p[2].x) < 1e8 && fabs(q.at.p[2].y) < 1e8 &&
                  fabs(q.at.p[3].x) < 1e8 && fabs(q.at.p[3].y) < 1e8))
                s = tz_fail(ctx, TZ_INVALID,
                            "layout: path %d reaches out of all bounds; scale it down or "
                            "move it",
                            (int)i);
            else
                s = add_chords(ctx, n, n->piece.n - 1, SPAN);
        }
    }
    return s;
}

static tz_status list_ends(tz_ctx *ctx, const tz_curve_set *set, tz_near *n)
{
    tz_status s = tz_alloc_zero(ctx, &n->ends, (size_t)set->node.n + 2, sizeof *n->ends);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &n->end, 2 * (size_t)set->piece.n, sizeof *n->end);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < set->piece.n; i++)
        for (int k = 0; k < 2; k++)
            n->ends[n->piece.v[i].node[k] + 2]++;
    for (int32_t i = 2; i < set->node.n + 2; i++)
        n->ends[i] += n->ends[i - 1];
    for (int32_t i = 0; i < set->piece.n; i++)
        for (int k = 0; k < 2; k++)
            n->end[n->ends[n->piece.v[i].node[k] + 1]++] = 2 * i + k;
    return TZ_OK;
}

/* The canvas, and on a plain one as much round about it as there are chords in reach. */
static void choose_grid(tz_near *n)
{
    double x0 = 0, y0 = 0, x1 = n->canvas.width, y1 = n->canvas.height;
    for (int32_t i = 0; i < n->chord.n && !n->canvas.torus; i++) {
        const tz_vec2 p = n->chord.v[i].p;
        x0 = fmin(x0, p.x), x1 = fmax(x1, p.x);
        y0 = fmin(y0, p.y), y1 = fmax(y1, p.y);
    }
    x0 = fmax(x0, -n->reach), x1 = fmin(x1, n->canvas.width + n->reach);
    y0 = fmax(y0, -n->reach), y1 = fmin(y1, n->canvas.height + n->reach);
    const double w = x1 - x0, h = y1 - y0;
    double cell = sqrt(2 * w * h / (n->chord.n + 1.0));
    cell = fmin(fmax(cell, 16), 256);
    while (ceil(w / cell) * ceil(h / cell) > CELLS_MAX)
        cell *= 1.5;
    const bool torus = n->canvas.torus;
    n->x0 = x0;
    n->y0 = y0;
    n->nx = (int32_t)fmax(1, torus ? floor(w / cell) : ceil(w / cell));
    n->ny = (int32_t)fmax(1, torus ? floor(h / cell) : ceil(h / cell));
    n->cx = w / n->nx;
    n->cy = h / n->ny;
}

static int32_t wrap(int64_t i, int32_t n)
{
    const int64_t k = i % n;
    return (int32_t)(k < 0 ? k + n : k);
}

/* Cells that a chord's box meets; on a torus not wrapped. Empty: it is out of reach. */
static bool cells_of(const tz_near *n, const tz_near_chord *c, int64_t box[4])
{
    const double x0 = fmin(c->p.x, c->q.x), x1 = fmax(c->p.x, c->q.x),
                 y0 = fmin(c->p.y, c->q.y), y1 = fmax(c->p.y, c->q.y);
    box[0] = (int64_t)floor((x0 - n->x0) / n->cx);
    box[1] = (int64_t)floor((y0 - n->y0) / n->cy);
    box[2] = (int64_t)floor((x1 - n->x0) / n->cx);
    box[3] = (int64_t)floor((y1 - n->y0) / n->cy);
    if (n->canvas.torus) {
        box[2] = box[2] - box[0] < n->nx ? box[2] : box[0] + n->nx - 1;
        box[3] = box[3] - box[1] < n->ny ? box[3] : box[1] + n->ny - 1;
        return true;
    }
    if (box[2] < 0 || box[3] < 0 || box[0] >= n->nx || box[1] >= n->ny)
        return false;
    box[0] = box[0] < 0 ? 0 : box[0];
    box[1] = box[1] < 0 ? 0 : box[1];
    box[2] = box[2] < n->nx ? box[2] : n->nx - 1;
    box[3] = box[3] < n->ny ? box[3] : n->ny - 1;
    return true;
}

static tz_status sort_chords(tz_ctx *ctx, tz_near *n)
{
    const int64_t cells = (int64_t)n->nx * n->ny;
    tz_status s = tz_alloc_zero(ctx, &n->first, (size_t)cells + 2, sizeof *n->first);
    for (int pass = 0; pass < 2 && s == TZ_OK; pass++) {
        int64_t *count = n->first + 2 - pass;
        for (int32_t i = 0; i < n->chord.n; i++) {
            int64_t box[4];
            if (!cells_of(n, &n->chord.v[i], box))
                continue;
            for (int64_t y = box[1]; y <= box[3]; y++)
                for (int64_t x = box[0]; x <= box[2]; x++) {
                    int64_t *at =
                        &count[(int64_t)wrap(y, n->ny) * n->nx + wrap(x, n->nx)];
                    if (pass)
                        n->item[*at] = i;
                    (*at)++;
                }
        }
        if (pass)
            break;
        for (int64_t k = 2; k < cells + 2; k++)
            n->first[k] += n->first[k - 1];
        s = tz_alloc(ctx, &n->item, (size_t)n->first[cells + 1], sizeof *n->item);
    }
    return s;
}

tz_status tz_near_init(tz_ctx *ctx, const tz_curve_set *set,
                       const tz_curve_canvas *canvas, double reach, tz_near *n)
{
    *n = (tz_near){.canvas = *canvas, .reach = fmin(fmax(reach, 1), 1e5)};
    tz_status s = add_pieces(ctx, set, n);
    if (s == TZ_OK)
        s = list_ends(ctx, set, n);
    if (s == TZ_OK) {
        choose_grid(n);
        s = sort_chords(ctx, n);
    }
    if (s != TZ_OK)
        tz_near_deinit(ctx, n);
    return s;
}

void tz_near_deinit(tz_ctx *ctx, tz_near *n)
{
    tz_array_free(ctx, &n->piece);
    tz_array_free(ctx, &n->chord);
    tz_free(ctx, n->ends);
    tz_free(ctx, n->end);
    tz_free(ctx, n->first);
    tz_free(ctx, n->item);
    *n = (tz_near){0};
}

void tz_near_scratch_deinit(tz_ctx *ctx, tz_near_scratch *s)
{
    tz_array_free(ctx, &s->few);
}

/* ---- asking ---------------------------------------------------------------------------- */

/* Square of the distance from o (relative to p) to the chord of direction d. */
static inline double chord_distance(tz_vec2 o, tz_vec2 d, double *share)
{
    const double n = d.x * d.x + d.y * d.y, dot = o.x * d.x + o.y * d.y;
    const double t = !(dot > 0) ? 0 : dot >= n ? 1 : dot / n;
    const double x = o.x - t * d.x, y = o.y - t * d.y;
    *share = t;
    return x * x + y * y;
}

/* By how much the copy of a chord that lies near m is moved. */
static tz_vec2 copy_near(const tz_near *n, const tz_near_chord *c, tz_vec2 m)
{
    tz_vec2 move = {0, 0};
    if (n->canvas.torus) {
        const tz_vec2 mid = tz_vec2_scale(tz_vec2_add(c->p, c->q), 0.5);
        move.x = floor((m.x - mid.x) / n->canvas.width + 0.5) * n->canvas.width;
        move.y = floor((m.y - mid.y) / n->canvas.height + 0.5) * n->canvas.height;
    }
    return move;
}

static double distance_to(const tz_near *n, int32_t chord, tz_vec2 m)
{
    const tz_near_chord *c = &n->chord.v[chord];
    const tz_vec2 move = copy_near(n, c, m);
    double share;
    return sqrt(chord_distance(tz_vec2_sub(tz_vec2_sub(m, move), c->p),
                               tz_vec2_sub(c->q, c->p), &share));
}

/* Calls on all cells of ring k about cell (x, y): best distance, and chords within `most`
 * (if few). On a torus no cell is met twice. */
static tz_status visit_cell(tz_ctx *ctx, const tz_near *n, int64_t x, int64_t y,
                            tz_vec2 m, double most, double *best, tz_near_scratch *w)
{
    if (!n->canvas.torus && (x < 0 || y < 0 || x >= n->nx || y >= n->ny))
        return TZ_OK;
    const int64_t cell = (int64_t)wrap(y, n->ny) * n->nx + wrap(x, n->nx);
    tz_status s = TZ_OK;
    for (int64_t i = n->first[cell]; i < n->first[cell + 1] && s == TZ_OK; i++) {
        const tz_near_few f = {n->item[i]};
        const double d = distance_to(n, f.chord, m);
        *best = fmin(*best, d);
        if (d > most)
            continue;
        bool known = false;
        for (int32_t k = w->few.n - 1; k >= 0 && k >= w->few.n - 64 && !known; k--)
            known = w->few.v[k].chord == f.chord;
        if (!known)
            s = tz_array_push(ctx, &w->few, f);
    }
    return s;
}

static tz_status visit_ring(tz_ctx *ctx, const tz_near *n, int64_t x, int64_t y,
                            int32_t k, tz_vec2 m, double most, double *best,
                            tz_near_scratch *w)
{
    const bool torus = n->canvas.torus;
    /* offsets that name each cell of a torus once: -(n - 1) / 2 .. n / 2 */
    const int64_t i0 = torus && -k < -(n->nx - 1) / 2 ? -(n->nx - 1) / 2 : -k,
                  i1 = torus && k > n->nx / 2 ? n->nx / 2 : k;
    const int64_t j0 = torus && -k < -(n->ny - 1) / 2 ? -(n->ny - 1) / 2 : -k,
                  j1 = torus && k > n->ny / 2 ? n->ny / 2 : k;
    tz_status s = TZ_OK;
    for (int64_t j = j0; j <= j1 && s == TZ_OK; j++) {
        const bool edge = j == -k || j == k;
        for (int64_t i = i0; i <= i1 && s == TZ_OK; i++) {
            if (!edge && i != -k && i != k) {
                if (i1 < k) /* the ring's right side is not there */
                    break;
                i = k > i ? k : i;
            }
            s = visit_cell(ctx, n, x + i, y + j, m, most, best, w);
        }
    }
    return s;
}

/* Fills w->few with all chords that are nearest to some place within h of m. */
static tz_status find_few(tz_ctx *ctx, const tz_near *n, tz_vec2 m, double h,
                          tz_near_scratch *w)
{
    const int64_t x = (int64_t)floor((m.x - n->x0) / n->cx),
                  y = (int64_t)floor((m.y - n->y0) / n->cy);
    const double cell = fmin(n->cx, n->cy), far = n->reach + h;
    /* rings that can meet the grid: all of it lies within so many cells */
    const int64_t across = x < 0        ? n->nx - x
                           : x >= n->nx ? x + 1
                                        : n->nx,
                  down = y < 0        ? n->ny - y
                         : y >= n->ny ? y + 1
                                      : n->ny;
    const double sides = (double)(across > down ? across : down),
                 top = fmin(ceil(far / cell) + 1, fmin(sides, RINGS_MAX));
    double best = INFINITY;
    tz_status s = TZ_OK;
    int32_t k = 0;
    w->few.n = 0;
    /* ring k + 1 lies at least k cells off */
    for (; k <= top && s == TZ_OK && (k - 1) * cell <= fmin(best, far); k++)
        s = visit_ring(ctx, n, x, y, k, m, -1, &best, w);
    const double most = fmin(best + 2 * h, far) * (1 + 1e-12);
    if (!(best <= far))
        return s;
    for (k = 0; k <= top && s == TZ_OK && (k - 1) * cell <= most; k++)
        s = visit_ring(ctx, n, x, y, k, m, most, &best, w);
    return s;
}

/* Nearest place of a cubic about t, by Newton's method on (c - p) . c' = 0. */
static double refine(const tz_bezier *c, tz_vec2 p, double t, double t0, double t1)
{
    const double lo = fmax(2 * t0 - t1, 0), hi = fmin(2 * t1 - t0, 1);
    for (int k = 0; k < 2; k++) {
        const double u = 1 - t;
        const tz_vec2 o = tz_vec2_sub(tz_bezier_at(c, t), p), d = tz_bezier_slope(c, t);
        const tz_vec2 dd = {6 * (u * (c->p[2].x - 2 * c->p[1].x + c->p[0].x) +
                                 t * (c->p[3].x - 2 * c->p[2].x + c->p[1].x)),
                            6 * (u * (c->p[2].y - 2 * c->p[1].y + c->p[0].y) +
                                 t * (c->p[3].y - 2 * c->p[2].y + c->p[1].y))};
        const double f = tz_vec2_dot(o, d), g = tz_vec2_dot(d, d) + tz_vec2_dot(o, dd);
        if (!(g > 0.1 * tz_vec2_dot(d, d)) || !(tz_vec2_dot(d, d) > 0))
            break;
        t = fmin(fmax(t - f / g, lo), hi);
    }
    return t;
}

static tz_near_place place_of(const tz_near *n, const tz_near_few *few, int32_t count,
                              tz_vec2 p)
{
    tz_near_place out = {.piece = -1};
    double best = INFINITY, share = 0;
    tz_vec2 move = {0, 0};
    int32_t which = -1;
    for (int32_t i = 0; i < count; i++) {
        const tz_near_chord *c = &n->chord.v[few[i].chord];
        double t;
        const tz_vec2 at = copy_near(n, c, p);
        const double d =
            chord_distance((tz_vec2){p.x - at.x - c->p.x, p.y - at.y - c->p.y},
                           tz_vec2_sub(c->q, c->p), &t);
        if (d < best || (d == best && few[i].chord < few[which].chord))
            best = d, which = i, share = t, move = at;
    }
    if (which < 0 || !(best <= n->reach * n->reach))
        return out;
    const tz_near_chord *c = &n->chord.v[few[which].chord];
    const tz_bezier *b = &n->piece.v[c->piece].at;
    const tz_vec2 q = tz_vec2_sub(p, move);
    out.piece = c->piece;
    out.t = refine(b, q, (double)c->t0 + share * (double)(c->t1 - c->t0), (double)c->t0,
                   (double)c->t1);
    out.offset = tz_vec2_sub(q, tz_bezier_at(b, out.t));
    out.d = tz_vec2_length(out.offset);
    return out;
}

tz_status tz_near_grid(tz_ctx *ctx, const tz_near *n, int64_t x0, int64_t y0,
                       int32_t spacing, int32_t nx, int32_t ny, tz_near_place *out,
                       tz_near_scratch *w)
{
    const int32_t side = spacing * BLOCK <= SPAN ? BLOCK
                         : spacing < SPAN        ? SPAN / spacing
                                                 : 1;
    const double W = n->canvas.width, H = n->canvas.height;
    tz_status s = TZ_OK;
    for (int32_t j = 0; j < ny && s == TZ_OK; j += side)
        for (int32_t i = 0; i < nx && s == TZ_OK; i += side) {
            const int32_t ni = nx - i < side ? nx - i : side,
                          nj = ny - j < side ? ny - j : side;
            /* brought into the canvas: what lies round about is then the same everywhere */
            double bx = (double)x0 + (double)i * spacing,
                   by = (double)y0 + (double)j * spacing;
            if (n->canvas.torus) {
                bx -= floor(bx / W) * W;
                by -= floor(by / H) * H;
            }
            const double half = 0.5 * spacing;
            const tz_vec2 m = {bx + half * ni, by + half * nj};
            s = find_few(ctx, n, m, half * hypot(ni - 1, nj - 1) + 1e-6, w);
            for (int32_t y = 0; y < nj && s == TZ_OK; y++)
                for (int32_t x = 0; x < ni; x++)
                    out[(int64_t)(j + y) * nx + i + x] = place_of(
                        n, w->few.v, w->few.n,
                        (tz_vec2){bx + (x + 0.5) * spacing, by + (y + 0.5) * spacing});
        }
    return s;
}
