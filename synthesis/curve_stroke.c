/* SPDX-License-Identifier: Apache-2.0 */
/* Strokes of a tile. A path is one shape, whose parts do not darken each other: all of it
 * that reaches into the tile is covered first and painted once. Only the runs that reach
 * into the tile are looked at; each stretch of them is lengthened by a chord at either end,
 * so that its joins there are right and its blunt ends lie outside. */
#include <stdlib.h>
#include <string.h>

#include "synthesis/curve_render_internal.h"

tz_status tz_curve_stroke_work_init(tz_ctx *ctx, tz_curve_stroke_work *w)
{
    tz_status s = TZ_OK;
    if (w->layer.px)
        return s;
    if (!w->row)
        s = tz_alloc(ctx, &w->row, TZ_CURVE_TILE, sizeof *w->row);
    if (s == TZ_OK && !w->cover.sum)
        s = tz_cover_init(ctx, &w->cover, TZ_CURVE_TILE, TZ_CURVE_TILE);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &w->layer.px, (size_t)TZ_CURVE_TILE * TZ_CURVE_TILE,
                     sizeof *w->layer.px);
    return s;
}

void tz_curve_stroke_work_deinit(tz_ctx *ctx, tz_curve_stroke_work *w)
{
    tz_free(ctx, w->layer.px);
    tz_free(ctx, w->row);
    tz_cover_deinit(ctx, &w->cover);
    tz_array_free(ctx, &w->at);
    tz_array_free(ctx, &w->half);
    tz_array_free(ctx, &w->smooth);
    *w = (tz_curve_stroke_work){0};
}

/* Copies points from .. to of a path, moved, into the scratch; those of a closed path run on
 * behind its end. */
static tz_status gather(tz_ctx *ctx, const tz_curve_lines *l, const tz_curve_stroke *line,
                        int32_t from, int32_t to, tz_vec2 move, tz_curve_stroke_work *w)
{
    tz_status s = tz_array_reserve(ctx, &w->at, (int64_t)to - from + 1);
    if (s == TZ_OK)
        s = tz_array_reserve(ctx, &w->half, (int64_t)to - from + 1);
    if (s == TZ_OK)
        s = tz_array_reserve(ctx, &w->smooth, (int64_t)to - from + 1);
    w->at.n = w->half.n = w->smooth.n = 0;
    for (int32_t i = from; i <= to && s == TZ_OK; i++) {
        int32_t k = i, turns = 0;
        while (line->closed && k < 0)
            k += line->chords, turns--;
        while (line->closed && k >= line->chords)
            k -= line->chords, turns++;
        const int64_t at = line->point + k;
        const tz_vec2 p = tz_vec2_add(l->at.v[at], tz_vec2_scale(line->turn, turns));
        w->at.v[w->at.n++] = tz_vec2_add(p, move);
        w->half.v[w->half.n++] = l->half.v[at];
        w->smooth.v[w->smooth.n++] = l->smooth.v[at];
    }
    return s;
}

/* Shortens the chord at one end: where a path runs around a torus its own next turn may lie
 * there. */
static void shorten(tz_vec2 *end, tz_vec2 next)
{
    const tz_vec2 d = tz_vec2_sub(*end, next);
    const double l = tz_vec2_length(d);
    if (l > 0.01)
        *end = tz_vec2_add(next, tz_vec2_scale(d, 0.01 / l));
}

/* Chords from .. to - 1 of a path. */
static tz_status stretch(tz_ctx *ctx, const tz_curve_lines *l,
                         const tz_curve_stroke *line, int32_t from, int32_t to,
                         tz_vec2 move, tz_curve_stroke_work *w)
{
    tz_pen pen = line->pen;
    const bool whole = from == 0 && to == line->chords;
    const bool round = line->closed && whole && line->turn.x == 0 && line->turn.y == 0;
    tz_status s;
    if (round) {
        s = gather(ctx, l, line, 0, line->chords - 1, move, w);
        if (s == TZ_OK)
            tz_cover_taper(&w->cover, w->at.v, w->smooth.v, w->half.v, w->at.n, true,
                           &pen);
        return s;
    }
    const bool more = line->closed || from > 0,
               beyond = line->closed || to < line->chords;
    s = gather(ctx, l, line, from - more, to + beyond, move, w);
    if (s != TZ_OK)
        return s;
    if (line->closed && from == 0)
        shorten(&w->at.v[0], w->at.v[1]);
    if (line->closed && to == line->chords)
        shorten(&w->at.v[w->at.n - 1], w->at.v[w->at.n - 2]);
    if (more || beyond) { /* the added chords end bluntly; true ends have their caps */
        const int32_t n = w->at.n;
        const bool near_cap = pen.cap && !more, far_cap = pen.cap && !beyond;
        const int cap = pen.cap;
        pen.cap = 0;
        tz_cover_taper(&w->cover, w->at.v, w->smooth.v, w->half.v, n, false, &pen);
        pen.cap = cap;
        if (near_cap)
            tz_cover_cap(&w->cover, w->at.v, n, 1, (double)w->half.v[0], &pen);
        if (far_cap)
            tz_cover_cap(&w->cover, w->at.v + n - 1, n, -1, (double)w->half.v[n - 1],
                         &pen);
        return TZ_OK;
    }
    tz_cover_taper(&w->cover, w->at.v, w->smooth.v, w->half.v, w->at.n, false, &pen);
    return TZ_OK;
}

/* The items first .. end - 1 are of one path: their stretches, and paint. */
static tz_status stroke_path(tz_ctx *ctx, const tz_curve_lines *l,
                             const tz_curve_canvas *canvas, const tz_curve_item *item,
                             int64_t n, tz_rect tile, tz_curve_stroke_work *w)
{
    const tz_curve_stroke *line = &l->line.v[l->run.v[item[0].run].path];
    tz_status s = TZ_OK;
    for (int64_t i = 0; i < n && s == TZ_OK;) {
        const tz_curve_run *run = &l->run.v[item[i].run];
        const int32_t from = run->first;
        int32_t to = run->first + run->chords;
        int64_t j = i + 1;
        while (j < n && item[j].run == item[j - 1].run + 1 && item[j].kx == item[i].kx &&
               item[j].ky == item[i].ky)
            to += l->run.v[item[j++].run].chords;
        const tz_vec2 move = {(double)item[i].kx * canvas->width - tile.x,
                              (double)item[i].ky * canvas->height - tile.y};
        s = stretch(ctx, l, line, from, to, move, w);
        i = j;
    }
    if (s == TZ_OK)
        tz_layer_paint(&w->layer, &w->cover, w->row, line->colour, false);
    return s;
}

/* Items of the tile's square that reach into the tile, sorted by path, copy and run. */
static bool reaches(const tz_curve_lines *l, const tz_curve_canvas *canvas,
                    const tz_curve_item *it, tz_rect tile)
{
    const tz_bounds *b = &l->run.v[it->run].box;
    const double x = (double)it->kx * canvas->width, y = (double)it->ky * canvas->height;
    return b->x1 + x > tile.x && b->y1 + y > tile.y && b->x0 + x < tile.x + tile.w &&
           b->y0 + y < tile.y + tile.h;
}

static int by_copy(const void *a, const void *b)
{
    const tz_curve_item *p = a, *q = b;
    if (p->ky != q->ky)
        return p->ky < q->ky ? -1 : 1;
    if (p->kx != q->kx)
        return p->kx < q->kx ? -1 : 1;
    return (p->run > q->run) - (p->run < q->run);
}

tz_status tz_curve_stroke_tile(tz_ctx *ctx, const tz_curve_lines *l,
                               const tz_curve_canvas *canvas, tz_rect tile,
                               tz_curve_stroke_work *w, bool *any)
{
    const int32_t side = l->cell * TZ_CURVE_TILE;
    const int64_t cell = (int64_t)(tile.y / side) * l->nx + tile.x / side;
    TZ_ARRAY(tz_curve_item)
    few = {0};
    tz_status s = TZ_OK;
    *any = false;
    w->layer.rect = tile;
    w->layer.mask = NULL;
    w->cover.width = tile.w;
    w->cover.height = tile.h;
    tz_cover_reset(&w->cover);
    for (int64_t i = l->first[cell]; i < l->first[cell + 1] && s == TZ_OK;) {
        const int32_t path = l->run.v[l->item[i].run].path;
        bool sorted = true;
        few.n = 0;
        for (; i < l->first[cell + 1] && l->run.v[l->item[i].run].path == path; i++)
            if (s == TZ_OK && reaches(l, canvas, &l->item[i], tile))
                s = tz_array_push(ctx, &few, l->item[i]);
        for (int32_t k = 1; k < few.n; k++)
            sorted = sorted && by_copy(&few.v[k - 1], &few.v[k]) < 0;
        if (!sorted)
            qsort(few.v, (size_t)few.n, sizeof *few.v, by_copy);
        if (few.n && !*any)
            memset(w->layer.px, 0,
                   (size_t)TZ_CURVE_TILE * (size_t)tile.h * sizeof *w->layer.px);
        *any = *any || few.n;
        if (few.n && s == TZ_OK)
            s = stroke_path(ctx, l, canvas, few.v, few.n, tile, w);
        if (s == TZ_OK && (path & 255) == 255 && tz_ctx_cancelled(ctx))
            s = TZ_CANCELLED;
    }
    tz_array_free(ctx, &few);
    return s;
}
