/* SPDX-License-Identifier: Apache-2.0 */
/* Compositing, tile by tile: labels, source pixels under the label's map, seam correction.
 * Each stage depends on layout coordinates alone (compose_label.c, compose_source.c,
 * compose_blend.c), so tiles can be cut anyhow. */
#include <string.h>

#include "synthesis/clone.h"
#include "synthesis/compose_internal.h"

static const tz_param rows[] = {
    {"crop", TZ_PARAM_RECT, offsetof(tz_compose_params, crop), -1e6, 1e6, "0,0,0,0", "px",
     NULL, "Render only this part of the layout: x,y,w,h; w = 0 renders all"},
    {"clone", TZ_PARAM_ENUM, offsetof(tz_compose_params, clone), 0, 2, "screened", "",
     "screened|none|opencv",
     "How steps at seams are removed: one screened Poisson solve, not at all, or "
     "OpenCV's "
     "seamlessClone one piece after another (slow; for comparison)"},
    {"decay", TZ_PARAM_DOUBLE, offsetof(tz_compose_params, decay), 1, 4096, "96", "px",
     NULL, "Distance over which a seam's colour correction fades"},
};

const tz_param_table tz_compose_param_table = {
    "render", "Compositing of a layout into pixels", rows, sizeof rows / sizeof rows[0],
    sizeof(tz_compose_params)};

enum { TILE = 512 };

/* Coordinates must fit integers, and the copies that meet on a torus must be countable. */
static tz_status check_extent(tz_ctx *ctx, const tz_layout *l, int32_t id,
                              const tz_piece *p)
{
    const double most = 1e15, copies = 4e6;
    if (!(p->x0 > -most && p->y0 > -most && p->x1 < most && p->y1 < most))
        return tz_fail(
            ctx, TZ_INVALID,
            "layout: placement %d reaches out of all bounds; scale it down or move it",
            (int)id);
    const double turns =
        ((p->x1 - p->x0) / l->width + 1) * ((p->y1 - p->y0) / l->height + 1);
    if (l->tile && turns > copies)
        return tz_fail(
            ctx, TZ_INVALID,
            "layout: placement %d is %.0f times as large as the tile that it wraps "
            "around; scale it down",
            (int)id, turns);
    return TZ_OK;
}

static tz_status prepare_pieces(tz_ctx *ctx, tz_composer *c)
{
    const tz_layout *l = c->layout;
    tz_status s = tz_alloc_zero(ctx, &c->piece, (size_t)l->place.n, sizeof *c->piece);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &c->edge, 2 * (size_t)l->border.n, sizeof *c->edge);
    if (s != TZ_OK)
        return s;
    for (int32_t k = 0; k < l->place.n; k++) {
        const tz_placement *pl = &l->place.v[k];
        tz_piece *p = &c->piece[k];
        if (pl->removed)
            continue;
        if (!tz_affine_finite(pl->map) || !tz_affine_invert(pl->map, &p->inv))
            return tz_fail(ctx, TZ_INVALID,
                           "layout: placement %d has a map without inverse", (int)k);
        p->source = pl->source;
        const tz_affine i = p->inv;
        p->exact = i.a == 1 && i.b == 0 && i.c == 0 && i.d == 1 && i.e == floor(i.e) &&
                   i.f == floor(i.f);
        p->x0 = p->y0 = INFINITY, p->x1 = p->y1 = -INFINITY;
        for (int32_t q = pl->border; q < pl->border + pl->points; q++) {
            const tz_vec2 v =
                tz_affine_apply(pl->map, (tz_vec2){l->border.v[q].x, l->border.v[q].y});
            c->edge[2 * (size_t)q] = v.x, c->edge[2 * (size_t)q + 1] = v.y;
            p->x0 = v.x < p->x0 ? v.x : p->x0, p->x1 = v.x > p->x1 ? v.x : p->x1;
            p->y0 = v.y < p->y0 ? v.y : p->y0, p->y1 = v.y > p->y1 ? v.y : p->y1;
        }
        tz_status st = check_extent(ctx, l, k, p);
        if (st != TZ_OK)
            return st;
        if (c->kind == TZ_MAP_NORMAL && c->channels >= 3) {
            /* Normals turn with the surface: by the inverse transpose of the linear part, of
             * which the scale is left out (a larger copy of a stone is as steep as the
             * stone). Their y points up the picture while ours points down: conjugate with
             * diag(1, -1). */
            const tz_affine m = pl->map;
            const double scale = sqrt(fabs(tz_affine_det(m))) / tz_affine_det(m);
            p->turned = m.b != 0 || m.c != 0 || m.a != m.d || m.a < 0;
            p->n00 = (float)(m.d * scale), p->n01 = (float)(m.b * scale);
            p->n10 = (float)(m.c * scale), p->n11 = (float)(m.a * scale);
        }
    }
    return TZ_OK;
}

static tz_status check_photos(tz_ctx *ctx, const tz_layout *l, const tz_image *photos,
                              int32_t n)
{
    if (n != l->source.n)
        return tz_fail(ctx, TZ_INVALID,
                       "render: the layout has %d sources but %d were given",
                       (int)l->source.n, (int)n);
    for (int32_t k = 0; k < n; k++) {
        const tz_image *p = &photos[k];
        const tz_layout_source *s = &l->source.v[k];
        if (p->channels != photos[0].channels)
            return tz_fail(
                ctx, TZ_INVALID,
                "%s: has %d channels where the first source has %d; convert one",
                s->path ? s->path : "source", (int)p->channels, (int)photos[0].channels);
        /* another resolution is fine, another shape is not */
        const double sx = (double)p->width / s->width, sy = (double)p->height / s->height;
        if (fabs(sx - sy) * (s->width > s->height ? s->width : s->height) > 1.5)
            return tz_fail(ctx, TZ_INVALID,
                           "%s: is %d x %d but the layout was made for %d x %d; "
                           "resize it to the same proportions",
                           s->path ? s->path : "source", (int)p->width, (int)p->height,
                           (int)s->width, (int)s->height);
    }
    return TZ_OK;
}

tz_status tz_composer_new(tz_ctx *ctx, const tz_layout *l, const tz_image *photos,
                          int32_t n, tz_map_kind kind, const tz_compose_params *params,
                          tz_composer **out)
{
    tz_composer *c = NULL;
    tz_status s = check_photos(ctx, l, photos, n);
    if (s == TZ_OK && n < 1)
        s = tz_fail(ctx, TZ_INVALID, "render: the layout names no source picture");
    if (s != TZ_OK)
        return s;
    s = tz_alloc_zero(ctx, &c, 1, sizeof *c);
    if (s != TZ_OK)
        return s;
    c->ctx = ctx;
    c->layout = l;
    if (params)
        c->params = *params;
    else
        tz_params_default(&tz_compose_param_table, &c->params);
    c->kind = kind;
    c->channels = photos[0].channels;
    c->alpha = photos[0].alpha;
    c->encoding = kind == TZ_MAP_COLOUR && photos[0].encoding != TZ_ENCODING_DATA
                      ? TZ_ENCODING_SRGB
                      : TZ_ENCODING_DATA;
    c->sources = n;
    s = prepare_pieces(ctx, c);
    bool spline = false;
    for (int32_t k = 0; s == TZ_OK && k < l->place.n; k++)
        spline |= !l->place.v[k].removed && !c->piece[k].exact;
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &c->source, (size_t)n, sizeof *c->source);
    for (int32_t k = 0; k < n && s == TZ_OK; k++) {
        const tz_layout_source *src = &l->source.v[k];
        const bool scaled =
            photos[k].width != src->width || photos[k].height != src->height;
        s = tz_source_plane_init(ctx, &c->source[k], &photos[k], src->width, src->height,
                                 c->encoding == TZ_ENCODING_DATA, spline || scaled);
    }
    if (s == TZ_OK) {
        c->lanes = c->source[0].lanes;
        c->step = c->source[0].step;
        s = tz_piece_index_init(ctx, c, &c->index);
    }
    if (s == TZ_OK)
        *out = c;
    else
        tz_composer_free(c);
    return s;
}

void tz_composer_free(tz_composer *c)
{
    if (!c)
        return;
    tz_ctx *ctx = c->ctx;
    for (int32_t k = 0; c->source && k < c->sources; k++)
        tz_source_plane_deinit(ctx, &c->source[k]);
    tz_free(ctx, c->source);
    tz_free(ctx, c->piece);
    tz_free(ctx, c->edge);
    tz_free(ctx, c->index.first);
    tz_free(ctx, c->index.id);
    tz_free(ctx, c);
}

/* ---- one tile --------------------------------------------------------------------- */

/* Cell of the fine grid whose corners belong to several placements, as one of them sees it. */
typedef struct corner {
    int32_t j, id;
} corner;

enum { COLUMNS = TILE / TZ_FINE + 32, KEPT = 2 };

typedef struct work {
    tz_correction grid[2];
    tz_label_scratch scratch;
    int32_t *label; /* TILE * TILE */
    float *row;     /* TILE texels */
    float *between; /* correction nodes of a row, interpolated down */
    corner *corner; /* COLUMNS * KEPT: latest mixed cells of each column */
    float *kept;    /* their corners' corrections, 4 texels each */
} work;

typedef struct job {
    const tz_composer *c;
    tz_rect r;
    tz_image *out;
    int32_t *label;
    work *work;
    int32_t block; /* side, px: TILE or a few of them */
    int32_t bx;    /* blocks in a row */
} job;

static tz_status work_init(tz_ctx *ctx, const tz_composer *c, work *w)
{
    tz_status s = TZ_OK;
    if (!w->label)
        s = tz_alloc(ctx, &w->label, (size_t)TILE * TILE, sizeof *w->label);
    if (s == TZ_OK && !w->row)
        s = tz_alloc(ctx, &w->row, (size_t)TILE * (size_t)c->step, sizeof *w->row);
    if (s == TZ_OK && !w->between)
        s = tz_alloc(ctx, &w->between, (size_t)COLUMNS * (size_t)c->step,
                     sizeof *w->between);
    if (s == TZ_OK && !w->corner)
        s = tz_alloc(ctx, &w->corner, COLUMNS * KEPT, sizeof *w->corner);
    if (s == TZ_OK && !w->kept)
        s = tz_alloc(ctx, &w->kept, (size_t)COLUMNS * KEPT * 4 * (size_t)c->step,
                     sizeof *w->kept);
    return s;
}

static void work_deinit(tz_ctx *ctx, work *w)
{
    tz_correction_deinit(ctx, &w->grid[0]);
    tz_correction_deinit(ctx, &w->grid[1]);
    tz_label_scratch_deinit(ctx, &w->scratch);
    tz_free(ctx, w->label);
    tz_free(ctx, w->row);
    tz_free(ctx, w->between);
    tz_free(ctx, w->corner);
    tz_free(ctx, w->kept);
}

/* Corrections at the four corners of cell (i, j) as placement `id` sees them; the rows of a
 * cell follow each other, so that two placements a column are kept. */
static const float *cell_corners(const tz_composer *c, const tz_correction *g, work *w,
                                 int32_t i, int32_t j, int32_t id)
{
    const size_t size = 4 * (size_t)c->step;
    corner *k = w->corner + (size_t)i * KEPT;
    float *v = w->kept + (size_t)i * KEPT * size;
    for (int m = 0; m < KEPT; m++)
        if (k[m].j == j && k[m].id == id)
            return v + m * size;
    const int m =
        k[0].j == j && k[1].j != j; /* the slot of an older row, else the first */
    k[m] = (corner){j, id};
    v += m * size;
    for (int n = 0; n < 4; n++)
        tz_correction_node(c, g, i + (n & 1), j + (n >> 1), id,
                           v + (size_t)n * (size_t)c->step);
    return v;
}

/* Adds p + fx (q - p) to texels at fx = in_cell / 2 F, (in_cell + 2) / 2 F, ... */
static inline void add_ramp(float *t, const float *p, const float *q, int32_t in_cell,
                            int32_t count, int32_t step)
{
    if (step == 4) {
        tz_f4 a, b, v;
        memcpy(&a, p, sizeof a);
        memcpy(&b, q, sizeof b);
        b -= a;
        for (int32_t m = 0; m < count; m++, in_cell += 2, t += 4) {
            memcpy(&v, t, sizeof v);
            v += a + ((float)in_cell * (1.0F / (2 * TZ_FINE))) * b;
            memcpy(t, &v, sizeof v);
        }
        return;
    }
    for (int32_t m = 0; m < count; m++, in_cell += 2, t += step) {
        const float fx = (float)in_cell * (1.0F / (2 * TZ_FINE));
        for (int32_t e = 0; e < step; e++)
            t[e] += p[e] + fx * (q[e] - p[e]);
    }
}

/* Adds the correction to n texels of one placement in row y, from x on. */
static void correct_span(const tz_composer *c, const tz_correction *g, work *w,
                         int32_t id, int64_t x, int64_t y, int32_t n, float *texel)
{
    const int32_t step = c->step, nx = g->nx;
    const int64_t ry = 2 * (y - g->y0) + 1 - TZ_FINE;
    const int32_t j = (int32_t)(ry / (2 * TZ_FINE));
    const float fy = (float)(ry - (int64_t)j * 2 * TZ_FINE) / (2 * TZ_FINE);
    const int64_t start = 2 * (x - g->x0) + 1 - TZ_FINE;
    int32_t i = (int32_t)(start / (2 * TZ_FINE));
    int32_t in_cell = (int32_t)(start - (int64_t)i * 2 * TZ_FINE); /* odd, 1 .. 2 F - 1 */
    for (int32_t k = 0; k < n; i++, in_cell = 1) {
        int32_t count = (2 * TZ_FINE - in_cell + 1) / 2;
        if (count > n - k)
            count = n - k;
        const int32_t *label = g->label + (int64_t)j * nx + i;
        float *t = texel + (int64_t)k * step;
        if (label[0] == id && label[1] == id && label[nx] == id && label[nx + 1] == id) {
            const float *p =
                w->between + (int64_t)i * step; /* already interpolated down */
            add_ramp(t, p, p + step, in_cell, count, step);
        } else {
            const float *v = cell_corners(c, g, w, i, j, id);
            float left[TZ_IMAGE_MAX_CHANNELS + 4], right[TZ_IMAGE_MAX_CHANNELS + 4];
            for (int32_t e = 0; e < step; e++) {
                left[e] = v[e] + fy * (v[2 * step + e] - v[e]);
                right[e] = v[step + e] + fy * (v[3 * step + e] - v[step + e]);
            }
            add_ramp(t, left, right, in_cell, count, step);
        }
        k += count;
    }
}

static void turn_normals(const tz_piece *p, float *texel, int32_t n, int32_t step)
{
    for (int32_t i = 0; i < n; i++, texel += step) {
        const float nx = texel[0] - 0.5F, ny = texel[1] - 0.5F;
        texel[0] = p->n00 * nx + p->n01 * ny + 0.5F;
        texel[1] = p->n10 * nx + p->n11 * ny + 0.5F;
    }
}

/* Normals go back to unit length; all else keeps the source's range. */
static void finish(const tz_composer *c, int32_t source, float *texel, int32_t n)
{
    const int32_t step = c->step;
    const tz_source_plane *s = &c->source[source];
    const bool normals = c->kind == TZ_MAP_NORMAL && c->channels >= 3;
    float *t = texel;
    for (int32_t i = 0; normals && i < n; i++, t += step) {
        const float x = 2 * t[0] - 1, y = 2 * t[1] - 1, z = 2 * t[2] - 1;
        const float length = sqrtf((x * x + y * y) + z * z);
        if (length > 1e-6F) {
            t[0] = 0.5F + 0.5F * x / length;
            t[1] = 0.5F + 0.5F * y / length;
            t[2] = 0.5F + 0.5F * z / length;
        }
    }
    if (step == 4 && !normals) {
        for (int32_t i = 0; i < n; i++, texel += 4)
            for (int32_t k = 0; k < 4; k++) {
                const float v = texel[k] < s->lo[k] ? s->lo[k] : texel[k];
                texel[k] = v > s->hi[k] ? s->hi[k] : v;
            }
        return;
    }
    for (int32_t i = 0; i < n; i++, texel += step)
        for (int32_t k = normals ? 3 : 0; k < c->channels; k++)
            texel[k] = texel[k] < s->lo[k]   ? s->lo[k]
                       : texel[k] > s->hi[k] ? s->hi[k]
                                             : texel[k];
}

static void interpolate_down(const tz_composer *c, const tz_correction *g, int64_t y,
                             float *out)
{
    const int64_t ry = 2 * (y - g->y0) + 1 - TZ_FINE;
    const int64_t j = ry / (2 * TZ_FINE);
    const float fy = (float)(ry - j * 2 * TZ_FINE) / (2 * TZ_FINE);
    const int64_t n = (int64_t)g->nx * c->step;
    const float *p = g->c + j * n, *q = p + n;
    for (int64_t k = 0; k < n; k++)
        out[k] = p[k] + fy * (q[k] - p[k]);
}

/* Clamped texels of a three-channel picture, straight to where they go. */
static void put_rgb(const tz_source_plane *s, const float *texel, int32_t n, float *out)
{
    typedef int32_t mask __attribute__((vector_size(16)));
    const tz_f4 lo = tz_load4(s->lo), hi = tz_load4(s->hi);
    for (int32_t i = 0; i < n; i++, texel += 4, out += 3) {
        tz_f4 v = tz_load4(texel);
        mask beyond = v < lo;
        v = (tz_f4)(((mask)lo & beyond) | ((mask)v & ~beyond));
        beyond = v > hi;
        v = (tz_f4)(((mask)hi & beyond) | ((mask)v & ~beyond));
        memcpy(out, &v, 2 * sizeof *out);
        out[2] = v[2];
    }
}

/* Source pixels of n texels of one placement in layout row ly, from lx on. */
static void source_span(const tz_composer *c, int32_t id, int64_t lx, int64_t ly,
                        int32_t n, float *texel)
{
    const tz_piece *p = &c->piece[id];
    const tz_source_plane *s = &c->source[p->source];
    if (!c->layout->tile) {
        tz_source_row(s, p->inv, p->exact, lx, ly, n, texel);
        return;
    }
    /* spans of one copy on a torus: the shift changes half a turn off its centre */
    while (n > 0) {
        int32_t to = n;
        const tz_vec2 shift = tz_piece_shift(c, id, (double)lx + 0.5, (double)ly + 0.5);
        const double mid = 0.5 * (p->x0 + p->x1);
        const double limit = ceil(shift.x + mid + 0.5 * c->layout->width - 0.5);
        if (limit > (double)lx && limit < (double)(lx + n))
            to = (int32_t)(limit - (double)lx);
        tz_source_row(s, p->inv, p->exact, lx - (int64_t)shift.x, ly - (int64_t)shift.y,
                      to, texel);
        lx += to, n -= to, texel += (int64_t)to * c->step;
    }
}

static void render_row(const job *b, work *w, tz_rect tile, int32_t y)
{
    const tz_composer *c = b->c;
    const bool correct = c->params.clone == TZ_CLONE_SCREENED;
    const bool rgb = c->channels == 3 && c->kind != TZ_MAP_NORMAL;
    const int32_t step = c->step, channels = c->channels;
    const int64_t ly = (int64_t)tile.y + y;
    const int32_t *label = w->label + (int64_t)y * tile.w;
    float *out = tz_image_at(b->out, tile.x - b->r.x, tile.y - b->r.y + y);
    if (correct)
        interpolate_down(c, &w->grid[1], ly, w->between);
    for (int32_t x = 0, e; x < tile.w; x = e) {
        const int32_t id = label[x];
        for (e = x + 1; e < tile.w && label[e] == id;)
            e++;
        const int32_t n = e - x;
        float *texel = w->row + (int64_t)x * step;
        if (id < 0) {
            memset(texel, 0, (size_t)n * (size_t)step * sizeof *texel);
            if (rgb)
                memset(out + 3 * (int64_t)x, 0, 3 * (size_t)n * sizeof *out);
            continue;
        }
        const tz_piece *p = &c->piece[id];
        source_span(c, id, tile.x + x, ly, n, texel);
        if (p->turned)
            turn_normals(p, texel, n, step);
        if (correct)
            correct_span(c, &w->grid[1], w, id, tile.x + x, ly, n, texel);
        if (rgb)
            put_rgb(&c->source[p->source], texel, n, out + 3 * (int64_t)x);
        else
            finish(c, p->source, texel, n);
    }
    if (rgb)
        return;
    if (step == channels)
        memcpy(out, w->row, (size_t)tile.w * (size_t)step * sizeof *out);
    else
        for (int32_t x = 0; x < tile.w; x++)
            for (int32_t k = 0; k < channels; k++)
                out[(int64_t)x * channels + k] = w->row[(int64_t)x * step + k];
}

static tz_status render_tile(tz_ctx *ctx, job *b, work *w, tz_rect tile)
{
    const tz_composer *c = b->c;
    tz_status s =
        tz_label_grid(ctx, c, tile.x, tile.y, 1, tile.w, tile.h, w->label, &w->scratch);
    if (s != TZ_OK)
        return s;
    if (b->label) {
        for (int32_t y = 0; y < tile.h; y++)
            memcpy(b->label + (int64_t)(tile.y - b->r.y + y) * b->r.w + (tile.x - b->r.x),
                   w->label + (int64_t)y * tile.w, (size_t)tile.w * sizeof *b->label);
        return TZ_OK;
    }
    memset(w->corner, 0xff, COLUMNS * KEPT * sizeof *w->corner);
    if (c->params.clone == TZ_CLONE_SCREENED)
        s = tz_correction_fine(ctx, c, tile, &w->grid[0], &w->grid[1], &w->scratch);
    if (s != TZ_OK)
        return s;
    for (int32_t y = 0; y < tile.h; y++)
        render_row(b, w, tile, y);
    tz_progress_add(ctx, (int64_t)tile.w * tile.h);
    return TZ_OK;
}

/* A block of tiles, which share one coarse grid. */
static tz_status render_block(tz_ctx *ctx, void *arg, int64_t index, int worker)
{
    job *b = arg;
    const tz_composer *c = b->c;
    work *w = &b->work[worker];
    tz_status s = work_init(ctx, c, w);
    const int32_t x0 = b->r.x + (int32_t)(index % b->bx) * b->block;
    const int32_t y0 = b->r.y + (int32_t)(index / b->bx) * b->block;
    const tz_rect block = tz_rect_intersect(b->r, (tz_rect){x0, y0, b->block, b->block});
    if (s == TZ_OK && !b->label && c->params.clone == TZ_CLONE_SCREENED)
        s = tz_correction_coarse(ctx, c, block, &w->grid[0], &w->scratch);
    for (int32_t y = 0; y < block.h && s == TZ_OK; y += TILE)
        for (int32_t x = 0; x < block.w && s == TZ_OK; x += TILE) {
            const tz_rect tile = {x0 + x, y0 + y, TILE, TILE};
            s = tz_ctx_cancelled(ctx)
                    ? TZ_CANCELLED
                    : render_tile(ctx, b, w, tz_rect_intersect(block, tile));
        }
    return s;
}

static tz_status run(tz_ctx *ctx, const tz_composer *c, tz_rect r, tz_image *out,
                     int32_t *label)
{
    const tz_rect all = {0, 0, c->layout->width, c->layout->height};
    const tz_rect in = tz_rect_intersect(r, all);
    if (tz_rect_empty(r) || in.w != r.w || in.h != r.h)
        return tz_fail(ctx, TZ_INVALID,
                       "crop %d,%d,%d,%d does not lie inside the layout of %d x %d px",
                       (int)r.x, (int)r.y, (int)r.w, (int)r.h, (int)all.w, (int)all.h);
    const int workers = tz_ctx_threads(ctx);
    job b = {c, r, out, label, NULL, TILE, (r.w + TILE - 1) / TILE};
    int64_t blocks = (int64_t)b.bx * ((r.h + TILE - 1) / TILE);
    /* a coarse grid's margin is as wide as a tile: larger blocks have less of it, as long
     * as there are enough of them for all workers */
    while (b.block < 4 * TILE && blocks / 4 >= 2 * (int64_t)workers) {
        b.block *= 2;
        b.bx = (r.w + b.block - 1) / b.block;
        blocks = (int64_t)b.bx * ((r.h + b.block - 1) / b.block);
    }
    tz_status s = tz_alloc_zero(ctx, &b.work, (size_t)workers, sizeof *b.work);
    if (s != TZ_OK)
        return s;
    s = tz_parallel_for(ctx, blocks, render_block, &b);
    for (int k = 0; k < workers; k++)
        work_deinit(ctx, &b.work[k]);
    tz_free(ctx, b.work);
    return s;
}

tz_status tz_composer_render(tz_ctx *ctx, const tz_composer *c, tz_rect r, tz_image *out)
{
    if (out->width != r.w || out->height != r.h || out->channels != c->channels)
        return tz_fail(ctx, TZ_INVALID,
                       "render: output image has another size than the crop");
    out->encoding = c->encoding;
    if (c->params.clone == TZ_CLONE_OPENCV)
        return tz_clone_render(ctx, c, r, out);
    return run(ctx, c, r, out, NULL);
}

tz_status tz_composer_labels(tz_ctx *ctx, const tz_composer *c, tz_rect r, int32_t *label)
{
    return run(ctx, c, r, NULL, label);
}

tz_status tz_composer_stream(tz_ctx *ctx, const tz_composer *c, tz_rect r,
                             tz_image_sink *sink)
{
    /* strips as high as the free budget allows for twice (image and the sink's copies) */
    int32_t rows = 4 * TILE;
    const size_t budget = tz_ctx_memory(ctx);
    if (budget) {
        const size_t used = tz_ctx_memory_used(ctx);
        const size_t free_bytes = budget > used ? budget - used : 0;
        const size_t row = (size_t)r.w * (size_t)c->channels * sizeof(float);
        while (rows > 64 && (size_t)rows * row > free_bytes / 4)
            rows /= 2;
    }
    if (rows > r.h || c->params.clone == TZ_CLONE_OPENCV)
        rows = r.h; /* that one renders the whole layout for each strip */
    tz_image strip = {0};
    tz_status s = tz_image_init(ctx, &strip, r.w, rows, c->channels);
    if (s == TZ_OK) {
        strip.alpha = c->alpha;
        for (int32_t y = 0; y < r.h && s == TZ_OK; y += rows) {
            const int32_t h = r.h - y < rows ? r.h - y : rows;
            tz_image part = tz_image_view(&strip, (tz_rect){0, 0, r.w, h});
            s = tz_composer_render(ctx, c, (tz_rect){r.x, r.y + y, r.w, h}, &part);
            if (s == TZ_OK)
                s = tz_image_sink_rows(sink, &part);
        }
    }
    tz_image_deinit(&strip);
    return s;
}
