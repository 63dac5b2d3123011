/* SPDX-License-Identifier: Apache-2.0 */
/* Paths of a set as polylines on the canvas, within 1/50 px, and lists of their runs by
 * squares of the canvas in drawing order. On a torus a path is drawn through from its first
 * node on, and its runs are entered wherever a copy of them shows. */
#include <string.h>

#include "synthesis/curve_render_internal.h"

#define FLAT 0.02

enum { ITEMS_MAX = 200000000, TURNS_MAX = 10000 };

/* ---- flattening ------------------------------------------------------------------------ */

static tz_status push_point(tz_ctx *ctx, tz_curve_lines *l, tz_vec2 at, double half,
                            bool smooth)
{
    tz_status s = tz_array_push(ctx, &l->at, at);
    if (s == TZ_OK)
        s = tz_array_push(ctx, &l->half, (float)half);
    if (s == TZ_OK)
        s = tz_array_push(ctx, &l->smooth, smooth);
    return s;
}

/* A cubic on the canvas, from its second point on. */
static tz_status push_cubic(tz_ctx *ctx, tz_curve_lines *l, const tz_bezier *c,
                            bool straight, tz_curve_taper half)
{
    const int32_t n = straight ? 1 : tz_bezier_steps(c, FLAT);
    const bool changes = half.from != half.to;
    double whole = 0, along = 0;
    tz_vec2 last = c->p[0];
    tz_status s = TZ_OK;
    for (int32_t k = 1; k <= n && changes; k++) {
        const tz_vec2 p = tz_bezier_at(c, (double)k / n);
        whole += tz_vec2_length(tz_vec2_sub(p, last));
        last = p;
    }
    last = c->p[0];
    for (int32_t k = 1; k <= n && s == TZ_OK; k++) {
        const tz_vec2 p = k < n ? tz_bezier_at(c, (double)k / n) : c->p[3];
        along += tz_vec2_length(tz_vec2_sub(p, last));
        const double t = !changes || k == n || !(whole > 0) ? 1 : along / whole;
        s = push_point(ctx, l, p, half.from + t * (half.to - half.from), k < n);
        last = p;
    }
    return s;
}

static tz_curve_pen pen_of(const tz_curve_set *set, const tz_curve_path *p)
{
    return set->pen.v[p->pen];
}

static tz_f4 colour_of(uint32_t rgba)
{
    const float a = (float)(rgba & 255) / 255;
    tz_f4 v = {0};
    for (int k = 0; k < 3; k++)
        v[k] = tz_srgb_decode((float)((rgba >> (24 - 8 * k)) & 255) / 255) * a;
    v[3] = a;
    return v;
}

static tz_status add_path(tz_ctx *ctx, const tz_curve_set *set,
                          const tz_curve_canvas *canvas, double width, int32_t path,
                          tz_curve_lines *l)
{
    const tz_curve_path *p = &set->path.v[path];
    const tz_curve_pen pen = pen_of(set, p);
    const double scale = 0.5 * width * sqrt(canvas->sx * canvas->sy);
    static const int cap[3] = {0, 1, 2}, join[3] = {0, 1, 2};
    tz_curve_stroke line = {.point = l->at.n, .closed = p->closed};
    line.pen = (tz_pen){2 * scale * pen.width, cap[pen.cap % 3], join[pen.join % 3], 4};
    line.colour = colour_of(pen.color);
    tz_vec2 move = {0, 0}; /* copies of the pieces are put one behind another */
    tz_status s = TZ_OK;
    for (int32_t i = p->piece; i < p->piece + p->pieces && s == TZ_OK; i++) {
        const tz_curve_piece *c = &set->piece.v[i];
        tz_bezier b = tz_curve_bezier(set, c);
        const tz_vec2 next = tz_vec2_sub(b.p[3], set->node.v[c->to]);
        tz_curve_taper half = {scale * pen.width, scale * pen.width};
        if (set->taper.n)
            half = (tz_curve_taper){scale * set->taper.v[i].from,
                                    scale * set->taper.v[i].to};
        for (int k = 0; k < 4; k++)
            b.p[k] = (tz_vec2){(b.p[k].x + move.x) * canvas->sx,
                               (b.p[k].y + move.y) * canvas->sy};
        if (i == p->piece)
            s = push_point(ctx, l, b.p[0], half.from, false);
        if (s == TZ_OK)
            s = push_cubic(ctx, l, &b, c->straight, half);
        move = tz_vec2_add(move, next);
    }
    if (s != TZ_OK)
        return s;
    if (l->at.n - line.point - 1 > INT32_MAX / 2)
        return tz_fail(ctx, TZ_LIMIT, "render: path %d has too many points; split it",
                       (int)path);
    line.chords = (int32_t)(l->at.n - line.point - 1);
    line.turn = tz_vec2_sub(l->at.v[l->at.n - 1], l->at.v[line.point]);
    return tz_array_push(ctx, &l->line, line);
}

/* ---- runs ------------------------------------------------------------------------------ */

static tz_bounds run_box(const tz_curve_lines *l, const tz_curve_stroke *line,
                         int32_t first, int32_t chords)
{
    tz_bounds b = {INFINITY, INFINITY, -INFINITY, -INFINITY};
    const double corner = line->pen.join == 0 ? fmax(line->pen.miter, 1.5) : 1.5;
    for (int32_t k = first; k <= first + chords; k++) {
        const tz_vec2 p = l->at.v[line->point + k];
        const bool sharp = !l->smooth.v[line->point + k];
        const double r =
            (double)l->half.v[line->point + k] * (sharp ? corner : 1.5) + 0.5;
        b.x0 = fmin(b.x0, p.x - r), b.x1 = fmax(b.x1, p.x + r);
        b.y0 = fmin(b.y0, p.y - r), b.y1 = fmax(b.y1, p.y + r);
    }
    return b;
}

/* Runs end where they have TZ_CURVE_RUN chords, or reach over half a tile. */
static tz_status cut_runs(tz_ctx *ctx, tz_curve_lines *l, int32_t path)
{
    const tz_curve_stroke *line = &l->line.v[path];
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < line->chords && s == TZ_OK;) {
        int32_t n = 0;
        double length = 0;
        while (i + n < line->chords && n < TZ_CURVE_RUN &&
               (n == 0 || length < TZ_CURVE_TILE / 2)) {
            const tz_vec2 *p = &l->at.v[line->point + i + n];
            length += tz_vec2_length(tz_vec2_sub(p[1], p[0]));
            n++;
        }
        const tz_curve_run run = {path, i, n, run_box(l, line, i, n)};
        s = tz_array_push(ctx, &l->run, run);
        i += n;
    }
    return s;
}

/* ---- squares --------------------------------------------------------------------------- */

typedef struct placing {
    const tz_curve_canvas *canvas;
    tz_curve_lines *l;
    int64_t *count; /* per square */
    bool fill;
    int64_t total;
} placing;

/* A diagonal chord's box holds many squares that it does not touch. */
static bool touches(const placing *p, const tz_curve_run *run, tz_vec2 move, int32_t x,
                    int32_t y)
{
    const tz_curve_lines *l = p->l;
    const tz_curve_stroke *line = &l->line.v[run->path];
    const double side = (double)l->cell * TZ_CURVE_TILE;
    const tz_vec2 mid = {(x + 0.5) * side - move.x, (y + 0.5) * side - move.y};
    if (run->box.x1 - run->box.x0 < 2 * side && run->box.y1 - run->box.y0 < 2 * side)
        return true;
    for (int32_t k = run->first; k < run->first + run->chords; k++) {
        const tz_vec2 *q = &l->at.v[line->point + k];
        const tz_vec2 d = tz_vec2_sub(q[1], q[0]), o = tz_vec2_sub(mid, q[0]);
        const double n = tz_vec2_dot(d, d);
        double t = n > 0 ? tz_vec2_dot(o, d) / n : 0;
        t = t < 0 ? 0 : t > 1 ? 1 : t;
        const double half = fmax((double)l->half.v[line->point + k],
                                 (double)l->half.v[line->point + k + 1]);
        const double reach = 0.7072 * side + half * fmax(line->pen.miter, 1.5) + 1;
        if (tz_vec2_length(tz_vec2_sub(o, tz_vec2_scale(d, t))) <= reach)
            return true;
    }
    return false;
}

static void place_copy(placing *p, int32_t run, tz_vec2 move, int32_t kx, int32_t ky)
{
    tz_curve_lines *l = p->l;
    const tz_bounds *b = &l->run.v[run].box;
    const double side = (double)l->cell * TZ_CURVE_TILE;
    const int32_t x0 = (int32_t)fmax(floor((b->x0 + move.x) / side), 0),
                  y0 = (int32_t)fmax(floor((b->y0 + move.y) / side), 0),
                  x1 = (int32_t)fmin(floor((b->x1 + move.x) / side), l->nx - 1),
                  y1 = (int32_t)fmin(floor((b->y1 + move.y) / side), l->ny - 1);
    for (int32_t y = y0; y <= y1; y++)
        for (int32_t x = x0; x <= x1; x++) {
            if (!touches(p, &l->run.v[run], move, x, y))
                continue;
            int64_t *at = &p->count[(int64_t)y * l->nx + x];
            if (p->fill)
                l->item[*at] = (tz_curve_item){run, (int16_t)kx, (int16_t)ky};
            (*at)++;
            p->total++;
        }
}

static tz_status place_run(tz_ctx *ctx, placing *p, int32_t run)
{
    const tz_bounds b = p->l->run.v[run].box;
    const double w = p->canvas->width, h = p->canvas->height;
    const bool torus = p->canvas->torus;
    const double i0 = torus ? ceil(-b.x1 / w) : 0, i1 = torus ? floor((w - b.x0) / w) : 0,
                 j0 = torus ? ceil(-b.y1 / h) : 0, j1 = torus ? floor((h - b.y0) / h) : 0;
    if (!(i1 - i0 < TURNS_MAX && j1 - j0 < TURNS_MAX &&
          (i1 - i0 + 1) * (j1 - j0 + 1) <= TURNS_MAX && fabs(i0) < 32000 &&
          fabs(i1) < 32000 && fabs(j0) < 32000 && fabs(j1) < 32000))
        return tz_fail(ctx, TZ_INVALID,
                       "layout: path %d is many times as large as the tile that it wraps "
                       "around; scale it down",
                       (int)p->l->run.v[run].path);
    for (double j = j0; j <= j1; j++)
        for (double i = i0; i <= i1; i++) {
            const tz_vec2 move = {i * w, j * h};
            if (b.x1 + move.x > 0 && b.y1 + move.y > 0 && b.x0 + move.x < w &&
                b.y0 + move.y < h)
                place_copy(p, run, move, (int32_t)i, (int32_t)j);
        }
    return p->total > ITEMS_MAX
               ? tz_fail(ctx, TZ_LIMIT,
                         "layout: its lines cross more than %d tiles; render a smaller "
                         "canvas or thinner lines",
                         (int)ITEMS_MAX)
               : TZ_OK;
}

static tz_status sort_runs(tz_ctx *ctx, const tz_curve_canvas *canvas, tz_curve_lines *l)
{
    l->cell = 1;
    while (((int64_t)canvas->width / (l->cell * TZ_CURVE_TILE) + 1) *
               ((int64_t)canvas->height / (l->cell * TZ_CURVE_TILE) + 1) >
           1 << 20)
        l->cell *= 2;
    const int32_t side = l->cell * TZ_CURVE_TILE;
    l->nx = (canvas->width + side - 1) / side;
    l->ny = (canvas->height + side - 1) / side;
    const int64_t cells = (int64_t)l->nx * l->ny;
    placing p = {canvas, l, NULL, false, 0};
    tz_status s = tz_alloc_zero(ctx, &l->first, (size_t)cells + 2, sizeof *l->first);
    for (int pass = 0; pass < 2 && s == TZ_OK; pass++) {
        p.count = l->first + 2 - pass;
        p.fill = pass == 1;
        p.total = 0;
        for (int32_t i = 0; i < l->run.n && s == TZ_OK; i++)
            s = place_run(ctx, &p, i);
        if (pass || s != TZ_OK)
            break;
        for (int64_t k = 2; k < cells + 2; k++)
            l->first[k] += l->first[k - 1];
        s = tz_alloc(ctx, &l->item, (size_t)l->first[cells + 1], sizeof *l->item);
    }
    return s;
}

static bool in_bounds(const tz_curve_lines *l)
{
    for (int32_t i = 0; i < l->at.n; i++)
        if (!(fabs(l->at.v[i].x) < 1e9 && fabs(l->at.v[i].y) < 1e9 &&
              l->half.v[i] < 1e8F))
            return false;
    return true;
}

tz_status tz_curve_lines_init(tz_ctx *ctx, const tz_curve_set *set,
                              const tz_curve_canvas *canvas, double width,
                              tz_curve_lines *l)
{
    tz_status s = TZ_OK;
    *l = (tz_curve_lines){0};
    for (int32_t i = 0; i < set->path.n && s == TZ_OK; i++)
        s = add_path(ctx, set, canvas, width, i, l);
    if (s == TZ_OK && !in_bounds(l))
        s = tz_fail(ctx, TZ_INVALID,
                    "layout: a line reaches out of all bounds; scale it down or move it");
    for (int32_t i = 0; i < l->line.n && s == TZ_OK; i++)
        s = cut_runs(ctx, l, i);
    if (s == TZ_OK)
        s = sort_runs(ctx, canvas, l);
    if (s != TZ_OK)
        tz_curve_lines_deinit(ctx, l);
    return s;
}

void tz_curve_lines_deinit(tz_ctx *ctx, tz_curve_lines *l)
{
    tz_array_free(ctx, &l->at);
    tz_array_free(ctx, &l->half);
    tz_array_free(ctx, &l->smooth);
    tz_array_free(ctx, &l->line);
    tz_array_free(ctx, &l->run);
    tz_free(ctx, l->first);
    tz_free(ctx, l->item);
    *l = (tz_curve_lines){0};
}
