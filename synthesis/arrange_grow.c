/* SPDX-License-Identifier: Apache-2.0 */
/* Growth over the canvas.
 *
 * Strips are cut into tiles; a tile may be grown as soon as the tile up and to the right of
 * it is, so that several threads follow each other down the layout and yet every choice
 * sees the same surroundings: the layout does not depend on the count of threads. */
#include <sched.h>
#include <string.h>

#include "synthesis/arrange_internal.h"

/* ---- fixed placements ------------------------------------------------------------------ */

/* Star that stands for a placement set by hand: its group's, or one made for it. */
static tz_status star_for(tz_ctx *ctx, tz_grower *g, const tz_layout *l,
                          const tz_placement *p, int32_t *id)
{
    const tz_ebpt *e = g->ex[p->source].ebpt;
    *id = p->group >= 0 && p->group < e->group.n ? g->stars.of_group[p->source][p->group]
                                                 : -1;
    if (*id >= 0)
        return TZ_OK;
    tz_star s = {.exemplar = p->source, .group = 0};
    for (int k = 0; k < TZ_SIMILAR; k++)
        s.similar[k] = -1;
    for (int32_t k = p->border; k < p->border + p->points; k++) {
        s.centre.x += l->border.v[k].x / p->points;
        s.centre.y += l->border.v[k].y / p->points;
    }
    *id = g->stars.star.n;
    return tz_array_push(ctx, &g->stars.star, s);
}

tz_status tz_grower_draw_fixed(tz_ctx *ctx, tz_grower *g, const tz_layout *l)
{
    const int32_t last = g->strips * g->tiles;
    tz_grown_list *list = &g->tile[last];
    double *border = NULL;
    tz_status s = TZ_OK;
    g->canvas.fixed = last << TZ_KEY_BITS;
    for (int32_t k = 0; k < l->place.n && s == TZ_OK; k++) {
        const tz_placement *p = &l->place.v[k];
        if (!p->fixed || p->removed)
            continue;
        if (list->n >= 1 << TZ_KEY_BITS)
            return tz_fail(ctx, TZ_LIMIT, "layout: more than %d fixed placements",
                           1 << TZ_KEY_BITS);
        tz_grown q = {.map = p->map};
        if (!tz_affine_invert(p->map, &q.inv))
            return tz_fail(ctx, TZ_INVALID,
                           "layout: placement %d has a map without inverse", (int)k);
        s = star_for(ctx, g, l, p, &q.star);
        if (s == TZ_OK)
            s = tz_array_push(ctx, list, q);
        if (s == TZ_OK)
            s = tz_alloc(ctx, &border, 3 * (size_t)p->points, sizeof *border);
        if (s != TZ_OK)
            break;
        tz_vec2 mid = {0, 0};
        for (int32_t i = 0; i < p->points; i++) {
            const tz_point b = l->border.v[p->border + i];
            const tz_vec2 v = tz_affine_apply(p->map, (tz_vec2){b.x, b.y});
            border[2 * i] = v.x, border[2 * i + 1] = v.y;
            mid.x += v.x / p->points, mid.y += v.y / p->points;
        }
        list->v[list->n - 1].centre = mid;
        tz_canvas_draw(&g->canvas, &g->map[p->source], q.map, q.inv, border, p->points,
                       border + 2 * (size_t)p->points,
                       (last << TZ_KEY_BITS) | (list->n - 1));
        tz_free(ctx, border);
        border = NULL;
    }
    return s;
}

/* ---- strips and tiles --------------------------------------------------------------- */

static tz_status grow_tile(tz_ctx *ctx, tz_grower *g, int32_t strip, int32_t tile)
{
    const int32_t index = strip * g->tiles + tile;
    tz_grown_list *list = &g->tile[index];
    tz_canvas *c = &g->canvas;
    const int32_t i0 = tile * g->span, j0 = strip * g->strip;
    const int32_t i1 = i0 + g->span < c->nx ? i0 + g->span : c->nx;
    const int32_t j1 = j0 + g->strip < c->ny ? j0 + g->strip : c->ny;
    for (int32_t j = j0; j < j1; j++)
        for (int32_t i = i0; i < i1; i++) {
            if (c->label[tz_canvas_at(c, i, j)] >= 0)
                continue;
            if (list->n >= 1 << TZ_KEY_BITS)
                return tz_fail(ctx, TZ_LIMIT,
                               "arrange: pieces are too small; raise --piece");
            tz_rng rng = tz_rng_make(
                g->p.seed, tz_rng_stream(1, (uint64_t)index, (uint64_t)list->n));
            const tz_vec2 v = {(i + 0.5) * TZ_CELL, (j + 0.5) * TZ_CELL};
            const tz_grown q = tz_place_choose(g, v, &rng);
            const tz_star *s = &g->stars.star.v[q.star];
            tz_status st = tz_array_push(ctx, list, q);
            if (st != TZ_OK)
                return st;
            const int32_t key = (index << TZ_KEY_BITS) | (list->n - 1);
            double border[2 * TZ_BORDER], scratch[TZ_BORDER];
            tz_grown_border(s, &q, border);
            tz_canvas_draw(c, &g->map[s->exemplar], q.map, q.inv, border, TZ_BORDER,
                           scratch, key);
            const int64_t at = tz_canvas_at(c, i, j);
            if (c->label[at] < 0) { /* a cell that the border just misses */
                c->label[at] = key;
                c->feature[at] =
                    tz_feature_at(&g->map[s->exemplar], s->centre.x, s->centre.y);
            }
        }
    return TZ_OK;
}

static tz_status grow_strip(tz_ctx *ctx, void *arg, int64_t strip, int worker)
{
    (void)worker;
    tz_grower *g = arg;
    tz_canvas *c = &g->canvas;
    const int32_t reach = 2 * g->strip + (int32_t)(3 * g->stars.reach / TZ_CELL);
    /* rows that come into reach and still hold what lies a ring above */
    if (c->ring < c->ny)
        for (int32_t j = (int32_t)strip * g->strip + reach;
             j < ((int32_t)strip + 1) * g->strip + reach; j++)
            if (j >= c->ring)
                memset(c->label + (int64_t)(j % c->ring) * c->nx, 0xff,
                       (size_t)c->nx * sizeof *c->label);
    tz_status s = TZ_OK;
    for (int32_t t = 0; t < g->tiles && s == TZ_OK; t++) {
        /* on a torus the tiles of a strip meet round the back: strip after strip */
        const int32_t need = g->p.tile || t + 2 > g->tiles ? g->tiles : t + 2;
        while (strip > 0 && atomic_load(&g->progress[strip - 1]) < need) {
            if (atomic_load(&g->stop) || tz_ctx_cancelled(ctx))
                return TZ_CANCELLED;
            sched_yield();
        }
        s = grow_tile(ctx, g, (int32_t)strip, t);
        if (s == TZ_OK && tz_ctx_cancelled(ctx))
            s = TZ_CANCELLED;
        atomic_store(&g->progress[strip], t + 1);
        tz_progress_add(ctx, (int64_t)g->span * g->strip * TZ_CELL * TZ_CELL);
    }
    if (s != TZ_OK)
        atomic_store(&g->stop, true);
    return s;
}

tz_status tz_grower_run(tz_ctx *ctx, tz_grower *g)
{
    tz_progress_begin(ctx, "arrange", "px", (int64_t)g->p.size[0] * g->p.size[1]);
    const tz_status s = tz_parallel_for(ctx, g->strips, grow_strip, g);
    tz_progress_end(ctx);
    return s;
}
