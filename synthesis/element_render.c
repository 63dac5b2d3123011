/* SPDX-License-Identifier: Apache-2.0 */
/* Rendering tile by tile. A tile's elements are laid one above the other on an empty layer,
 * in linear light; the layer is laid over the backdrop in the end ("over" is associative),
 * so that the backdrop is converted only where something shows. */
#include <string.h>

#include "synthesis/element_render_internal.h"

enum { TILE = TZ_ELEMENT_TILE };

void tz_element_renderer_size(const tz_element_renderer *r, int32_t *width,
                              int32_t *height)
{
    *width = r->width;
    *height = r->height;
}

int32_t tz_element_renderer_colours(const tz_element_renderer *r) { return r->colours; }

/* ---- one tile ------------------------------------------------------------------------ */

typedef struct job {
    const tz_element_renderer *r;
    tz_rect rect;
    tz_image *out;
    int32_t what;       /* tz_element_map, or -1: colour */
    int32_t x0, y0, nx; /* tiles */
    tz_layer_work *work;
} job;

static tz_status work_init(tz_ctx *ctx, const job *b, tz_layer_work *w)
{
    const size_t n = (size_t)TILE * TILE;
    tz_status s = TZ_OK;
    if (w->layer.px)
        return s;
    w->tables = b->r->tables;
    s = tz_alloc(ctx, &w->row, 4 * (size_t)TILE, sizeof *w->row);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &w->sum, TILE, sizeof *w->sum);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &w->block, n, sizeof *w->block);
    if (s == TZ_OK && b->what >= 0)
        s = tz_alloc_zero(ctx, &w->mask, n, sizeof *w->mask);
    if (s == TZ_OK && b->what >= 0)
        s = tz_alloc(ctx, &w->label, n, sizeof *w->label);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &w->document,
                          (size_t)b->r->set->symbol.n + (size_t)b->r->bent.n + 1,
                          sizeof *w->document);
    if (s == TZ_OK)
        s = tz_cover_init(ctx, &w->cover, TILE, TILE);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &w->layer.px, n, sizeof *w->layer.px);
    return s;
}

static void work_deinit(tz_ctx *ctx, const tz_element_renderer *r, tz_layer_work *w)
{
    for (int32_t i = 0; w->document && i <= r->set->symbol.n + r->bent.n; i++)
        if (w->document[i])
            w->api->close(w->document[i]);
    tz_free(ctx, w->row);
    tz_free(ctx, w->sum);
    tz_free(ctx, w->block);
    tz_free(ctx, w->mask);
    tz_free(ctx, w->label);
    tz_free(ctx, w->document);
    tz_cover_deinit(ctx, &w->cover);
    tz_free(ctx, w->layer.px);
    tz_array_free(ctx, &w->point);
    tz_array_free(ctx, &w->smooth);
}

static bool meets(const tz_showing *p, tz_rect t)
{
    return p->box.x0 < t.x + t.w && p->box.y0 < t.y + t.h && p->box.x1 > t.x &&
           p->box.y1 > t.y;
}

static tz_status draw_showing(tz_ctx *ctx, const tz_element_renderer *r,
                              const tz_showing *p, tz_layer *layer, tz_layer_work *w)
{
    const int32_t k =
        p->element < 0 ? r->set->symbol.n : r->set->element.v[p->element].symbol;
    const tz_element_symbol *y = p->element < 0 ? NULL : &r->set->symbol.v[k];
    const tz_bent *bent = tz_bent_find(r, p->element);
    if (bent && tz_symbol_cut(y)) {
        tz_bent_draw_cutout(r, bent, p, layer, w);
        return TZ_OK;
    }
    if (bent) {
        const tz_affine about = {r->sx, 0, 0, r->sy, p->map.e, p->map.f};
        const int32_t number = r->set->symbol.n + 1 + (int32_t)(bent - r->bent.v);
        return tz_drawing_draw(ctx, &bent->drawing, number, about, layer, w);
    }
    if (y && tz_symbol_cut(y)) {
        tz_cutout_draw(&r->cutout[k], y, p->map, r->kind, layer, w);
        return TZ_OK;
    }
    return tz_drawing_draw(ctx, &r->drawing[k], k, p->map, layer, w);
}

/* Names the pixels that the element just drawn into the mask covers; clears the mask. */
static void take_labels(const tz_layer *layer, const tz_showing *p, int32_t number,
                        int32_t *label)
{
    const tz_rect t = layer->rect;
    const int32_t x0 = (int32_t)fmax(floor(p->box.x0) - t.x - 1, 0),
                  y0 = (int32_t)fmax(floor(p->box.y0) - t.y - 1, 0);
    const int32_t x1 = (int32_t)fmin(ceil(p->box.x1) - t.x + 1, t.w),
                  y1 = (int32_t)fmin(ceil(p->box.y1) - t.y + 1, t.h);
    for (int32_t y = y0; y < y1; y++) {
        const int64_t at = (int64_t)y * TILE;
        for (int32_t x = x0; x < x1; x++)
            if (layer->mask[at + x] >= 0.5F)
                label[at + x] = number;
        if (x1 > x0)
            memset(layer->mask + at + x0, 0, (size_t)(x1 - x0) * sizeof *layer->mask);
    }
}

/* All elements of a tile, onto the layer or into labels (showing, -1 = none). */
static tz_status draw_tile(tz_ctx *ctx, const job *b, tz_rect tile, tz_layer_work *w,
                           bool *any)
{
    const tz_element_renderer *r = b->r;
    const tz_showing_index *ix = &r->index;
    const int64_t cell = (int64_t)(tile.y / ix->cell) * ix->nx + tile.x / ix->cell;
    tz_layer *layer = &w->layer;
    tz_status s = TZ_OK;
    *any = false;
    layer->rect = tile;
    layer->mask = b->what >= 0 ? w->mask : NULL;
    w->cover.width = tile.w;
    w->cover.height = tile.h;
    tz_cover_reset(&w->cover);
    for (int64_t i = ix->first[cell]; i < ix->first[cell + 1] && s == TZ_OK; i++) {
        const tz_showing *p = &ix->showing.v[ix->item[i]];
        if (!meets(p, tile) || (layer->mask && p->element < 0))
            continue;
        if (!*any) {
            memset(layer->px, 0, (size_t)TILE * (size_t)tile.h * sizeof *layer->px);
            for (int32_t k = 0; layer->mask && k < TILE * tile.h; k++)
                w->label[k] = -1;
        }
        *any = true;
        s = draw_showing(ctx, r, p, layer, w);
        if (s == TZ_OK && layer->mask)
            take_labels(layer, p, ix->item[i], w->label);
        if (s == TZ_OK && (i & 255) == 255 && tz_ctx_cancelled(ctx))
            s = TZ_CANCELLED;
    }
    return s;
}

/* ---- over the backdrop --------------------------------------------------------------- */

/* The last colour that was encoded: drawings are flat. */
typedef struct memo {
    float from[3], to[3];
} memo;

static void encode(float *v, int32_t n, memo *m)
{
    if (v[0] != m->from[0] || v[1] != m->from[1] || v[2] != m->from[2]) {
        for (int32_t k = 0; k < 3; k++) {
            m->from[k] = v[k];
            m->to[k] = k < n ? tz_srgb_encode(v[k]) : 0;
        }
    }
    memcpy(v, m->to, (size_t)n * sizeof *v);
}

/* A layer's pixel over one of the picture. */
static void lay(int32_t n, bool normal, tz_f4 v, bool srgb, bool alpha, float *at,
                memo *m)
{
    const float a = v[3] > 1 - 1e-6F ? 1 : v[3];
    const float below = alpha ? at[n] * (1 - a) : 1 - a, all = alpha ? a + below : 1;
    float c[4];
    memcpy(c, &v, sizeof c);
    for (int32_t k = 0; k < n && below > 0; k++)
        c[k] += (srgb ? tz_srgb_decode(at[k]) : at[k]) * below;
    if (all != 1 && all > 0)
        for (int32_t k = 0; k < n; k++)
            c[k] /= all;
    if (normal && below > 0) {
        const float x = 2 * c[0] - 1, y = 2 * c[1] - 1, z = 2 * c[2] - 1;
        const float l = sqrtf((x * x + y * y) + z * z);
        if (l > 1e-6F)
            c[0] = 0.5F + 0.5F * x / l, c[1] = 0.5F + 0.5F * y / l,
            c[2] = 0.5F + 0.5F * z / l;
    }
    if (srgb)
        encode(c, n, m);
    memcpy(at, c, (size_t)n * sizeof *at);
    if (alpha)
        at[n] = all > 1 ? 1 : all;
}

void tz_layer_lay(const tz_layer *layer, tz_rect part, int32_t colours, tz_map_kind kind,
                  tz_rect rect, tz_image *out)
{
    const bool srgb = kind == TZ_MAP_COLOUR && out->encoding == TZ_ENCODING_SRGB;
    const bool alpha = out->channels > colours;
    memo m = {{0}, {0}};
    for (int32_t y = part.y; y < part.y + part.h; y++) {
        const tz_f4 *v = layer->px + (int64_t)(y - layer->rect.y) * TILE - layer->rect.x;
        float *at = tz_image_at(out, part.x - rect.x, y - rect.y);
        for (int32_t x = part.x; x < part.x + part.w; x++, at += out->channels)
            if (v[x][3] > 0)
                lay(colours, kind == TZ_MAP_NORMAL, v[x], srgb, alpha, at, &m);
    }
}

/* ---- pictures of the arrangement ----------------------------------------------------- */

int32_t tz_element_map_channels(tz_element_map what)
{
    return what == TZ_ELEMENT_MAP_UV ? 3 : 1;
}

static void put_uv(const tz_element_renderer *r, const tz_showing *p,
                   const tz_element_symbol *y, int32_t px, int32_t py, float *at)
{
    const tz_bent *bent = tz_bent_find(r, p->element);
    tz_affine inv;
    if (!tz_affine_invert(p->map, &inv))
        return;
    tz_vec2 q = tz_affine_apply(inv, (tz_vec2){px + 0.5, py + 0.5});
    if (bent)
        q = tz_bent_source(r, bent, p->map, px + 0.5, py + 0.5);
    if (tz_symbol_cut(y)) {
        const tz_element_photo *f = &r->set->photo.v[y->photo];
        q.x = (y->photo_at.x + q.x * y->photo_scale) / (f->width > 0 ? f->width : 1);
        q.y = (y->photo_at.y + q.y * y->photo_scale) / (f->height > 0 ? f->height : 1);
    } else {
        q.x = 0.5 + 0.5 * q.x / y->radius;
        q.y = 0.5 + 0.5 * q.y / y->radius;
    }
    at[0] = (float)fmin(fmax(q.x, 0), 1);
    at[1] = (float)fmin(fmax(q.y, 0), 1);
    at[2] = 1;
}

static void put_label(const job *b, const tz_showing *p, int32_t x, int32_t y, float *at)
{
    const tz_element_renderer *r = b->r;
    const tz_element *e = &r->set->element.v[p->element];
    if (b->what == TZ_ELEMENT_MAP_ID) {
        *at = (float)(p->element + 1);
    } else if (b->what == TZ_ELEMENT_MAP_CLASS) {
        *at = (float)(e->kind + 1);
    } else if (b->what == TZ_ELEMENT_MAP_ANGLE) {
        const tz_bent *bent = tz_bent_find(r, p->element);
        const double angle =
            bent ? tz_bent_angle(r, bent, p->map, x + 0.5, y + 0.5) : e->angle;
        const double t = angle / (2 * TZ_PI), f = t - floor(t);
        *at = r->set->kind.v[e->kind].oriented ? (float)f : 0;
        *at = *at >= 1 ? 0 : *at;
    } else {
        put_uv(r, p, &r->set->symbol.v[e->symbol], x, y, at);
    }
}

static void label_tile(const job *b, tz_rect part, const tz_layer *layer,
                       const int32_t *label)
{
    const int32_t channels = b->out->channels;
    for (int32_t y = part.y; y < part.y + part.h; y++) {
        const int32_t *l = label ? label + (int64_t)(y - layer->rect.y) * TILE : NULL;
        float *at = tz_image_at(b->out, part.x - b->rect.x, y - b->rect.y);
        for (int32_t x = part.x; x < part.x + part.w; x++, at += channels) {
            const int32_t k = l ? l[x - layer->rect.x] : -1;
            for (int32_t c = 0; c < channels; c++)
                at[c] = 0;
            if (k >= 0)
                put_label(b, &b->r->index.showing.v[k], x, y, at);
        }
    }
}

/* ---- all tiles ----------------------------------------------------------------------- */

static tz_status render_tile(tz_ctx *ctx, void *arg, int64_t index, int worker)
{
    const job *b = arg;
    tz_layer_work *w = &b->work[worker];
    const tz_rect all = {0, 0, b->r->width, b->r->height};
    const tz_rect whole = {(b->x0 + (int32_t)(index % b->nx)) * TILE,
                           (b->y0 + (int32_t)(index / b->nx)) * TILE, TILE, TILE};
    const tz_rect tile = tz_rect_intersect(whole, all);
    const tz_rect part = tz_rect_intersect(tile, b->rect);
    bool any = false;
    tz_status s = work_init(ctx, b, w);
    if (s == TZ_OK)
        s = tz_ctx_cancelled(ctx) ? TZ_CANCELLED : draw_tile(ctx, b, tile, w, &any);
    if (s != TZ_OK)
        return s;
    if (b->what >= 0)
        label_tile(b, part, &w->layer, any ? w->label : NULL);
    else if (any)
        tz_layer_lay(&w->layer, part, b->r->colours, b->r->kind, b->rect, b->out);
    tz_progress_add(ctx, (int64_t)part.w * part.h);
    return TZ_OK;
}

static tz_status run(tz_ctx *ctx, const tz_element_renderer *r, tz_rect rect,
                     int32_t what, tz_image *out)
{
    const tz_rect all = {0, 0, r->width, r->height}, in = tz_rect_intersect(rect, all);
    if (tz_rect_empty(rect) || in.w != rect.w || in.h != rect.h)
        return tz_fail(ctx, TZ_INVALID,
                       "crop %d,%d,%d,%d does not lie inside the canvas of %d x %d px",
                       (int)rect.x, (int)rect.y, (int)rect.w, (int)rect.h, (int)r->width,
                       (int)r->height);
    if (out->width != rect.w || out->height != rect.h)
        return tz_fail(ctx, TZ_INVALID,
                       "render: output image has another size than the crop");
    const int workers = tz_ctx_threads(ctx);
    job b = {r, rect, out, what, rect.x / TILE, rect.y / TILE, 0, NULL};
    b.nx = (rect.x + rect.w - 1) / TILE - b.x0 + 1;
    const int64_t tiles = (int64_t)b.nx * ((rect.y + rect.h - 1) / TILE - b.y0 + 1);
    tz_status s = tz_alloc_zero(ctx, &b.work, (size_t)workers, sizeof *b.work);
    if (s != TZ_OK)
        return s;
    s = tz_parallel_for(ctx, tiles, render_tile, &b);
    for (int k = 0; k < workers; k++)
        work_deinit(ctx, r, &b.work[k]);
    tz_free(ctx, b.work);
    return s;
}

tz_status tz_element_renderer_render(tz_ctx *ctx, const tz_element_renderer *r,
                                     tz_rect rect, tz_image *pixels)
{
    const bool alpha = pixels->channels == r->colours + 1 && pixels->alpha == r->colours;
    if (!alpha && (pixels->channels != r->colours || pixels->alpha >= 0))
        return tz_fail(
            ctx, TZ_INVALID,
            "render: the backdrop has %d channels; the elements' %d colours, or "
            "these and alpha, are needed",
            (int)pixels->channels, (int)r->colours);
    return run(ctx, r, rect, -1, pixels);
}

tz_status tz_element_renderer_map(tz_ctx *ctx, const tz_element_renderer *r,
                                  tz_element_map what, tz_rect rect, tz_image *out)
{
    if (r->kind != TZ_MAP_COLOUR || out->channels != tz_element_map_channels(what))
        return tz_fail(ctx, TZ_INVALID,
                       "render: this map needs a renderer of colour and %d channels",
                       (int)tz_element_map_channels(what));
    out->encoding = TZ_ENCODING_DATA;
    return run(ctx, r, rect, (int32_t)what, out);
}

/* ---- strips -------------------------------------------------------------------------- */

tz_status tz_element_renderer_like(tz_ctx *ctx, const tz_element_renderer *r,
                                   tz_image *like)
{
    const tz_status s = tz_image_init(ctx, like, 1, 1, r->colours + 1);
    if (s != TZ_OK)
        return s;
    like->alpha = r->colours;
    like->encoding = r->encode ? TZ_ENCODING_SRGB : TZ_ENCODING_DATA;
    like->depth = r->depth;
    return TZ_OK;
}

int32_t tz_element_strip(tz_ctx *ctx, tz_rect rect, int32_t channels)
{
    /* strips as high as the free budget allows for twice (image and the sink's copies) */
    int32_t high = 8 * TILE;
    const size_t budget = tz_ctx_memory(ctx), used = tz_ctx_memory_used(ctx);
    const size_t row = (size_t)rect.w * (size_t)channels * sizeof(float);
    while (budget && high > 64 &&
           (size_t)high * row > (budget > used ? budget - used : 0) / 4)
        high /= 2;
    return high < rect.h ? high : rect.h;
}

tz_status tz_element_renderer_stream(tz_ctx *ctx, const tz_element_renderer *r,
                                     tz_rect rect, tz_image_sink *sink)
{
    tz_image strip = {0};
    const int32_t high = tz_element_strip(ctx, rect, r->colours + 1);
    if (tz_rect_empty(rect))
        return tz_fail(ctx, TZ_INVALID, "render: the crop is empty");
    tz_status s = tz_image_init(ctx, &strip, rect.w, high, r->colours + 1);
    strip.encoding = r->encode ? TZ_ENCODING_SRGB : TZ_ENCODING_DATA;
    for (int32_t y = 0; y < rect.h && s == TZ_OK; y += high) {
        const int32_t h = rect.h - y < high ? rect.h - y : high;
        tz_image part = tz_image_view(&strip, (tz_rect){0, 0, rect.w, h});
        memset(part.px, 0, (size_t)h * (size_t)part.stride * sizeof *part.px);
        s = tz_element_renderer_render(ctx, r, (tz_rect){rect.x, rect.y + y, rect.w, h},
                                       &part);
        if (s == TZ_OK)
            s = tz_image_sink_rows(sink, &part);
    }
    tz_image_deinit(&strip);
    return s;
}
