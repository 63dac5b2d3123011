/* SPDX-License-Identifier: Apache-2.0 */
/* What lies beneath, the lines, and discrete elements above them, for any rectangle. */
#include "synthesis/curve_render.h"

#include <string.h>

#include "synthesis/curve_strip_internal.h"

static const tz_param rows[] = {
    {"curve-source", TZ_PARAM_ENUM, offsetof(tz_curve_render_params, source), 0, 2,
     "auto", "", "auto|strokes|photo",
     "What lines are drawn with: the photo that they were found in, or strokes of their "
     "pens; auto = the photo where there is one"},
    {"curve-strip", TZ_PARAM_DOUBLE, offsetof(tz_curve_render_params, strip), -1, 4096,
     "-1", "px", NULL,
     "How far to either side of a line its photo is carried along, photo px over half "
     "its "
     "width; -1 = up to half a cell"},
    {"curve-width", TZ_PARAM_DOUBLE, offsetof(tz_curve_render_params, width), 1e-3, 1e3,
     "1", "", NULL, "Factor of the widths of strokes"},
};

const tz_param_table tz_curve_render_param_table = {"render", "Rendering of curves", rows,
                                                    sizeof rows / sizeof rows[0],
                                                    sizeof(tz_curve_render_params)};

struct tz_curve_composer {
    const tz_curve_set *set;
    tz_curve_render_params params;
    tz_map_kind kind;
    tz_curve_canvas canvas;
    int32_t colours;
    tz_element_set under, above;  /* views on set->element: background, and elements */
    tz_element_composer *ground;  /* NULL = none */
    tz_element_renderer *beneath; /* the background's drawing; NULL = none */
    tz_element_renderer *things;  /* NULL = none */
    bool photo;                   /* lines are shown in their photo's pixels */
    tz_curve_lines lines;         /* of strokes */
    tz_strips strips;             /* of a photo */
    tz_image like;                /* 1 x 1 */
    tz_ctx *ctx;
};

/* ---- making ---------------------------------------------------------------------------- */

static tz_status check_canvas(tz_ctx *ctx, tz_curve_composer *c)
{
    const tz_vec3 size = c->set->domain.size;
    const double w = fmax(rint(size.x * c->params.scale), 1),
                 h = fmax(rint(size.y * c->params.scale), 1);
    if (!(c->params.scale > 0 && w <= TZ_IMAGE_MAX_SIDE && h <= TZ_IMAGE_MAX_SIDE))
        return tz_fail(
            ctx, TZ_INVALID,
            "render: %.6g x %.6g units at %.6g px a unit are over %d px; use a "
            "smaller scale",
            size.x, size.y, c->params.scale, TZ_IMAGE_MAX_SIDE);
    const bool torus = c->set->domain.torus;
    c->canvas =
        (tz_curve_canvas){(int32_t)w, (int32_t)h, torus ? w / size.x : c->params.scale,
                          torus ? h / size.y : c->params.scale, torus};
    return TZ_OK;
}

/* Renderers of what lies beneath and above the lines. */
static tz_status make_elements(tz_ctx *ctx, tz_curve_composer *c,
                               const tz_element_ground *ground,
                               const tz_element_pixels *photos)
{
    tz_element_render_params look;
    tz_params_default(&tz_element_render_param_table, &look);
    look.scale = c->params.scale;
    c->above = c->set->element;
    c->above.domain = c->set->domain;
    c->above.ctx = ctx;
    c->under = c->above;
    c->under.element.n = c->under.sample.n = 0;
    c->above.background = NULL;
    tz_status s = TZ_OK;
    if (ground && ground->layout) {
        c->under.background = NULL;
        s = tz_element_composer_new(ctx, ground, &c->under, photos, c->kind, &look,
                                    &c->ground);
    } else if (c->under.background && c->kind == TZ_MAP_COLOUR) {
        s = tz_element_renderer_new(ctx, &c->under, photos, c->kind, &look, &c->beneath);
    }
    if (s == TZ_OK && c->above.element.n > 0)
        s = tz_element_renderer_new(ctx, &c->above, photos, c->kind, &look, &c->things);
    return s;
}

/* What lines show of the photo. */
static const tz_image *shown(const tz_element_pixels *photo)
{
    return photo->map ? photo->map : photo->photo;
}

/* Whether the photo is shown, and whether it fits. */
static tz_status settle_source(tz_ctx *ctx, tz_curve_composer *c,
                               const tz_element_pixels *photo)
{
    const bool there = photo && photo->photo;
    const tz_vec3 size = c->set->domain.size;
    /* without origins it must be the photo's own lines */
    const bool knows =
        there && (c->set->origin.n > 0 ||
                  (photo->photo->width == size.x && photo->photo->height == size.y));
    c->photo = c->params.source == 2 || (c->params.source == 0 && knows);
    if (!c->photo)
        return TZ_OK;
    if (!there)
        return tz_fail(ctx, TZ_INVALID,
                       "layout: its lines are to be shown in the pixels of their photo, "
                       "which was not given; give it, or draw strokes");
    const tz_image *im = photo->photo, *map = shown(photo);
    const double sx = (double)map->width / im->width,
                 sy = (double)map->height / im->height;
    if (fabs(sx - sy) * (im->width > im->height ? im->width : im->height) > 1.5)
        return tz_fail(ctx, TZ_INVALID,
                       "render: the map is %d x %d px, the photo %d x %d; resize it to "
                       "the same proportions",
                       map->width, map->height, im->width, im->height);
    if (c->set->element.photo.n > 0 && c->set->element.photo.v[0].width > 0 &&
        (c->set->element.photo.v[0].width != im->width ||
         c->set->element.photo.v[0].height != im->height))
        return tz_fail(ctx, TZ_INVALID,
                       "render: the photo is %d x %d px, but the lines were found in one "
                       "of %d x %d; use that",
                       im->width, im->height, c->set->element.photo.v[0].width,
                       c->set->element.photo.v[0].height);
    if (map->channels > 4)
        return tz_fail(ctx, TZ_INVALID,
                       "render: lines are shown from pictures of up to 4 channels, this "
                       "has %d; give its parts one by one",
                       (int)map->channels);
    if (c->kind == TZ_MAP_NORMAL && tz_photo_colours(map) != 3)
        return tz_fail(ctx, TZ_INVALID, "render: a map of normals needs three channels");
    return TZ_OK;
}

/* Channels of what is made. */
static tz_status make_like(tz_ctx *ctx, tz_curve_composer *c,
                           const tz_element_pixels *photo)
{
    const bool opaque = (c->set->background & 255) == 255 && c->kind == TZ_MAP_COLOUR;
    const int32_t colours = c->photo ? tz_photo_colours(shown(photo)) : 3;
    const bool alpha = c->photo || !opaque;
    tz_status s = c->ground ? tz_element_composer_image(ctx, c->ground, 1, 1, &c->like)
                            : tz_image_init(ctx, &c->like, 1, 1, colours + alpha);
    if (s != TZ_OK)
        return s;
    if (!c->ground) {
        c->like.alpha = alpha ? colours : -1;
        c->like.encoding = c->kind == TZ_MAP_COLOUR ? TZ_ENCODING_SRGB : TZ_ENCODING_DATA;
        c->like.depth = c->photo ? shown(photo)->depth : 8;
    } else if (c->photo && shown(photo)->channels != c->like.channels) {
        return tz_fail(ctx, TZ_INVALID,
                       "render: the photo of the lines has %d channels, that of the "
                       "ground %d; convert one",
                       (int)shown(photo)->channels, (int)c->like.channels);
    }
    c->colours = tz_photo_colours(&c->like);
    const int32_t things =
        c->things ? tz_element_renderer_colours(c->things) : c->colours;
    if (things != c->colours)
        return tz_fail(ctx, TZ_INVALID,
                       "render: the lines have %d colours, the elements above them %d; "
                       "convert one",
                       (int)c->colours, (int)things);
    return TZ_OK;
}

tz_status tz_curve_composer_new(tz_ctx *ctx, const tz_element_ground *ground,
                                const tz_curve_set *set, const tz_element_pixels *photo,
                                tz_map_kind kind, const tz_curve_render_params *params,
                                tz_curve_composer **out)
{
    tz_curve_composer *c = NULL;
    tz_element_pixels *photos = NULL;
    tz_status s = tz_curve_set_check(ctx, set, "layout");
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &c, 1, sizeof *c);
    if (s != TZ_OK)
        return s;
    c->ctx = ctx;
    c->set = set;
    c->kind = kind;
    tz_params_default(&tz_curve_render_param_table, &c->params);
    if (params)
        c->params = *params;
    if (c->params.scale == 0)
        c->params.scale = 1;
    s = check_canvas(ctx, c);
    if (s == TZ_OK && set->element.photo.n > 0)
        s = tz_alloc_zero(ctx, &photos, (size_t)set->element.photo.n, sizeof *photos);
    if (s == TZ_OK && photos && photo)
        photos[0] = *photo;
    if (s == TZ_OK)
        s = settle_source(ctx, c, photo);
    if (s == TZ_OK)
        s = make_elements(ctx, c, ground, photos);
    if (s == TZ_OK)
        s = make_like(ctx, c, photo);
    if (s == TZ_OK && c->photo)
        s = tz_strips_init(ctx, set, &c->canvas, photo->photo, shown(photo),
                           c->ground ? tz_element_composer_ground(c->ground) : NULL, kind,
                           c->params.strip, &c->strips);
    if (s == TZ_OK && !c->photo && kind == TZ_MAP_COLOUR)
        s = tz_curve_lines_init(ctx, set, &c->canvas, c->params.width, &c->lines);
    for (int32_t i = 0; i < c->lines.line.n && c->colours == 1; i++) { /* over grey */
        tz_f4 *v = &c->lines.line.v[i].colour;
        (*v)[0] = 0.2126F * (*v)[0] + 0.7152F * (*v)[1] + 0.0722F * (*v)[2];
    }
    tz_free(ctx, photos);
    if (s == TZ_OK)
        *out = c;
    else
        tz_curve_composer_free(c);
    return s;
}

void tz_curve_composer_free(tz_curve_composer *c)
{
    if (!c)
        return;
    tz_element_composer_free(c->ground);
    tz_element_renderer_free(c->beneath);
    tz_element_renderer_free(c->things);
    tz_curve_lines_deinit(c->ctx, &c->lines);
    tz_strips_deinit(c->ctx, &c->strips);
    tz_image_deinit(&c->like);
    tz_free(c->ctx, c);
}

void tz_curve_composer_size(const tz_curve_composer *c, int32_t *width, int32_t *height)
{
    *width = c->canvas.width;
    *height = c->canvas.height;
}

tz_status tz_curve_composer_image(tz_ctx *ctx, const tz_curve_composer *c, int32_t width,
                                  int32_t height, tz_image *im)
{
    const tz_status s = tz_image_init(ctx, im, width, height, c->like.channels);
    if (s == TZ_OK) {
        im->alpha = c->like.alpha;
        im->encoding = c->like.encoding;
        im->depth = c->like.depth;
    }
    return s;
}

/* ---- rendering ------------------------------------------------------------------------- */

static void fill(const tz_curve_composer *c, tz_image *out)
{
    const uint32_t rgba = c->kind == TZ_MAP_COLOUR ? c->set->background : 0;
    float v[4];
    for (int k = 0; k < 4; k++)
        v[k] = (float)((rgba >> (24 - 8 * k)) & 255) / 255;
    for (int k = 0; k < 3; k++)
        if (v[3] <= 0)
            v[k] = 0;
        else if (out->encoding == TZ_ENCODING_LINEAR)
            v[k] = tz_srgb_decode(v[k]);
    for (int32_t y = 0; y < out->height; y++) {
        float *at = tz_image_at(out, 0, y);
        for (int32_t x = 0; x < out->width; x++, at += out->channels)
            memcpy(at, v, (size_t)out->channels * sizeof *at);
    }
}

typedef struct job {
    const tz_curve_composer *c;
    tz_rect rect;
    tz_image *out;
    int32_t x0, y0, nx; /* tiles */
    tz_curve_stroke_work *work;
} job;

static tz_status stroke_task(tz_ctx *ctx, void *arg, int64_t index, int worker)
{
    const job *b = arg;
    const tz_curve_composer *c = b->c;
    tz_curve_stroke_work *w = &b->work[worker];
    const tz_rect all = {0, 0, c->canvas.width, c->canvas.height};
    const tz_rect whole = {(b->x0 + (int32_t)(index % b->nx)) * TZ_CURVE_TILE,
                           (b->y0 + (int32_t)(index / b->nx)) * TZ_CURVE_TILE,
                           TZ_CURVE_TILE, TZ_CURVE_TILE};
    const tz_rect tile = tz_rect_intersect(whole, all),
                  part = tz_rect_intersect(tile, b->rect);
    bool any = false;
    tz_status s =
        tz_ctx_cancelled(ctx) ? TZ_CANCELLED : tz_curve_stroke_work_init(ctx, w);
    if (s == TZ_OK)
        s = tz_curve_stroke_tile(ctx, &c->lines, &c->canvas, tile, w, &any);
    if (s == TZ_OK && any)
        tz_layer_lay(&w->layer, part, c->colours, c->kind, b->rect, b->out);
    if (s == TZ_OK)
        tz_progress_add(ctx, (int64_t)part.w * part.h);
    return s;
}

static tz_status strokes(tz_ctx *ctx, const tz_curve_composer *c, tz_rect rect,
                         tz_image *out)
{
    job b = {c, rect, out, rect.x / TZ_CURVE_TILE, rect.y / TZ_CURVE_TILE, 0, NULL};
    b.nx = (rect.x + rect.w - 1) / TZ_CURVE_TILE - b.x0 + 1;
    const int64_t tiles =
        (int64_t)b.nx * ((rect.y + rect.h - 1) / TZ_CURVE_TILE - b.y0 + 1);
    const int workers = tz_ctx_threads(ctx);
    tz_status s = tz_alloc_zero(ctx, &b.work, (size_t)workers, sizeof *b.work);
    if (s != TZ_OK)
        return s;
    s = tz_parallel_for(ctx, tiles, stroke_task, &b);
    for (int k = 0; k < workers; k++)
        tz_curve_stroke_work_deinit(ctx, &b.work[k]);
    tz_free(ctx, b.work);
    return s;
}

/* ---- photo ----------------------------------------------------------------------------- */

typedef struct strip_job {
    const tz_curve_composer *c;
    tz_rect rect;
    tz_image *out;
    int32_t block, bx; /* side of a block, px; blocks in a row */
    tz_strip_work *work;
} strip_job;

/* Tiles that share one coarse grid. */
static tz_status strip_task(tz_ctx *ctx, void *arg, int64_t index, int worker)
{
    const strip_job *b = arg;
    tz_strip_work *w = &b->work[worker];
    const int32_t x0 = b->rect.x + (int32_t)(index % b->bx) * b->block,
                  y0 = b->rect.y + (int32_t)(index / b->bx) * b->block;
    const tz_rect block =
        tz_rect_intersect(b->rect, (tz_rect){x0, y0, b->block, b->block});
    tz_status s = tz_strip_coarse(ctx, &b->c->strips, block, w);
    for (int32_t y = 0; y < block.h && s == TZ_OK; y += TZ_CURVE_TILE)
        for (int32_t x = 0; x < block.w && s == TZ_OK; x += TZ_CURVE_TILE) {
            const tz_rect tile = tz_rect_intersect(
                block, (tz_rect){x0 + x, y0 + y, TZ_CURVE_TILE, TZ_CURVE_TILE});
            s = tz_ctx_cancelled(ctx)
                    ? TZ_CANCELLED
                    : tz_strip_tile(ctx, &b->c->strips, tile, b->rect, b->out, w);
            tz_progress_add(ctx, (int64_t)tile.w * tile.h);
        }
    return s;
}

static tz_status strips(tz_ctx *ctx, const tz_curve_composer *c, tz_rect rect,
                        tz_image *out)
{
    const int32_t tile = TZ_CURVE_TILE;
    const int workers = tz_ctx_threads(ctx);
    strip_job b = {c, rect, out, tile, (rect.w + tile - 1) / tile, NULL};
    int64_t blocks = (int64_t)b.bx * ((rect.h + tile - 1) / tile);
    while (b.block < 4 * tile && blocks / 4 >= 2 * (int64_t)workers) {
        b.block *= 2;
        b.bx = (rect.w + b.block - 1) / b.block;
        blocks = (int64_t)b.bx * ((rect.h + b.block - 1) / b.block);
    }
    tz_status s = tz_alloc_zero(ctx, &b.work, (size_t)workers, sizeof *b.work);
    if (s != TZ_OK)
        return s;
    s = tz_parallel_for(ctx, blocks, strip_task, &b);
    for (int k = 0; k < workers; k++)
        tz_strip_work_deinit(ctx, &b.work[k]);
    tz_free(ctx, b.work);
    return s;
}

static tz_status check_rect(tz_ctx *ctx, const tz_curve_composer *c, tz_rect rect)
{
    const tz_rect all = {0, 0, c->canvas.width, c->canvas.height},
                  in = tz_rect_intersect(rect, all);
    if (tz_rect_empty(rect) || in.w != rect.w || in.h != rect.h)
        return tz_fail(ctx, TZ_INVALID,
                       "crop %d,%d,%d,%d does not lie inside the canvas of %d x %d px",
                       (int)rect.x, (int)rect.y, (int)rect.w, (int)rect.h, (int)all.w,
                       (int)all.h);
    return TZ_OK;
}

tz_status tz_curve_composer_render(tz_ctx *ctx, const tz_curve_composer *c, tz_rect rect,
                                   tz_image *out)
{
    tz_status s = check_rect(ctx, c, rect);
    if (s != TZ_OK)
        return s;
    if (out->width != rect.w || out->height != rect.h ||
        out->channels != c->like.channels || out->alpha != c->like.alpha)
        return tz_fail(ctx, TZ_INVALID,
                       "render: output image has another size than the crop");
    out->encoding = c->like.encoding;
    if (c->photo)
        s = strips(ctx, c, rect, out);
    else if (c->ground)
        s = tz_element_composer_render(ctx, c->ground, rect, out);
    else
        fill(c, out);
    if (s == TZ_OK && c->beneath && !c->photo)
        s = tz_element_renderer_render(ctx, c->beneath, rect, out);
    if (s == TZ_OK && c->lines.line.n)
        s = strokes(ctx, c, rect, out);
    if (s == TZ_OK && c->things)
        s = tz_element_renderer_render(ctx, c->things, rect, out);
    return s;
}

tz_status tz_curve_composer_map(tz_ctx *ctx, const tz_curve_composer *c, tz_rect rect,
                                int32_t *id, float *distance, float *along)
{
    tz_near near = {0};
    tz_status s = check_rect(ctx, c, rect);
    if (s == TZ_OK)
        s = tz_near_init(ctx, c->set, &c->canvas, 1e5, &near);
    if (s == TZ_OK)
        s = tz_near_map(ctx, &near, rect, id, distance, along);
    tz_near_deinit(ctx, &near);
    return s;
}

tz_status tz_curve_composer_stream(tz_ctx *ctx, const tz_curve_composer *c, tz_rect rect,
                                   tz_image_sink *sink)
{
    tz_image strip = {0};
    tz_status s = check_rect(ctx, c, rect);
    if (s != TZ_OK)
        return s;
    const int32_t high = tz_element_strip(ctx, rect, c->like.channels);
    s = tz_curve_composer_image(ctx, c, rect.w, high, &strip);
    for (int32_t y = 0; y < rect.h && s == TZ_OK; y += high) {
        const int32_t h = rect.h - y < high ? rect.h - y : high;
        tz_image part = tz_image_view(&strip, (tz_rect){0, 0, rect.w, h});
        s = tz_curve_composer_render(ctx, c, (tz_rect){rect.x, rect.y + y, rect.w, h},
                                     &part);
        if (s == TZ_OK)
            s = tz_image_sink_rows(sink, &part);
    }
    tz_image_deinit(&strip);
    return s;
}
