/* SPDX-License-Identifier: Apache-2.0 */
/* Ground first, then the things over it, for any rectangle and any map. */
#include <string.h>

#include "synthesis/element_compose.h"
#include "synthesis/element_render_internal.h"

struct tz_element_composer {
    tz_composer *ground; /* NULL = none */
    tz_layout layout;    /* of the ground in the canvas' size; only `place` is its own */
    tz_element_renderer *things;
    bool bare; /* nothing shows over the ground */
    int32_t width, height;
    tz_image like; /* 1 x 1: what is rendered */
    tz_ctx *ctx;
};

/* The layout with its maps scaled to the canvas. */
static tz_status fit_layout(tz_ctx *ctx, const tz_layout *l, tz_element_composer *c)
{
    const double sx = (double)c->width / l->width, sy = (double)c->height / l->height;
    const int32_t side = l->width > l->height ? l->width : l->height;
    tz_placement *place = NULL;
    if (!(fabs(sx - sy) * side <= 1.5 * fmax(sx, 1)))
        return tz_fail(ctx, TZ_INVALID,
                       "render: the ground is arranged for %d x %d px, the elements for "
                       "%d x %d; arrange it in their proportions",
                       (int)l->width, (int)l->height, (int)c->width, (int)c->height);
    const tz_status s = tz_alloc(ctx, &place, (size_t)l->place.n, sizeof *place);
    if (s != TZ_OK)
        return s;
    for (int32_t k = 0; k < l->place.n; k++) {
        place[k] = l->place.v[k];
        place[k].map = tz_affine_then(place[k].map, (tz_affine){sx, 0, 0, sy, 0, 0});
    }
    c->layout = *l; /* sources and borders are the caller's */
    c->layout.width = c->width;
    c->layout.height = c->height;
    c->layout.place.v = place;
    return TZ_OK;
}

static tz_status make_ground(tz_ctx *ctx, const tz_element_ground *g, tz_map_kind kind,
                             tz_element_composer *c)
{
    tz_status s = fit_layout(ctx, g->layout, c);
    if (s == TZ_OK)
        s = tz_composer_new(ctx, &c->layout, g->photos, g->n, kind, g->params,
                            &c->ground);
    if (s != TZ_OK)
        return s;
    const tz_image *first = &g->photos[0];
    const int32_t colours = tz_photo_colours(first),
                  want = tz_element_renderer_colours(c->things);
    c->bare = c->things->index.showing.n == 0;
    if ((colours != want && !c->bare) || (first->alpha >= 0 && first->alpha != colours))
        return tz_fail(ctx, TZ_INVALID,
                       "render: the ground has %d colours, the elements have %d; convert "
                       "one",
                       (int)colours, (int)want);
    s = tz_image_init(ctx, &c->like, 1, 1, first->channels);
    if (s != TZ_OK)
        return s;
    c->like.alpha = first->alpha;
    c->like.encoding = kind == TZ_MAP_COLOUR && first->encoding != TZ_ENCODING_DATA
                           ? TZ_ENCODING_SRGB
                           : TZ_ENCODING_DATA;
    c->like.depth = first->depth;
    return TZ_OK;
}

tz_status tz_element_composer_new(tz_ctx *ctx, const tz_element_ground *ground,
                                  const tz_element_set *set,
                                  const tz_element_pixels *photos, tz_map_kind kind,
                                  const tz_element_render_params *params,
                                  tz_element_composer **out)
{
    tz_element_composer *c = NULL;
    tz_status s = tz_alloc_zero(ctx, &c, 1, sizeof *c);
    if (s != TZ_OK)
        return s;
    c->ctx = ctx;
    s = tz_element_renderer_new(ctx, set, photos, kind, params, &c->things);
    if (s == TZ_OK) {
        tz_element_renderer_size(c->things, &c->width, &c->height);
        s = ground && ground->layout ? make_ground(ctx, ground, kind, c)
                                     : tz_element_renderer_like(ctx, c->things, &c->like);
    }
    if (s == TZ_OK)
        *out = c;
    else
        tz_element_composer_free(c);
    return s;
}

void tz_element_composer_free(tz_element_composer *c)
{
    if (!c)
        return;
    tz_composer_free(c->ground);
    tz_free(c->ctx, c->layout.place.v);
    tz_element_renderer_free(c->things);
    tz_image_deinit(&c->like);
    tz_free(c->ctx, c);
}

void tz_element_composer_size(const tz_element_composer *c, int32_t *width,
                              int32_t *height)
{
    *width = c->width;
    *height = c->height;
}

const tz_element_renderer *tz_element_composer_renderer(const tz_element_composer *c)
{
    return c->things;
}

const tz_composer *tz_element_composer_ground(const tz_element_composer *c)
{
    return c->ground;
}

tz_status tz_element_composer_image(tz_ctx *ctx, const tz_element_composer *c,
                                    int32_t width, int32_t height, tz_image *im)
{
    const tz_status s = tz_image_init(ctx, im, width, height, c->like.channels);
    if (s == TZ_OK) {
        im->alpha = c->like.alpha;
        im->encoding = c->like.encoding;
        im->depth = c->like.depth;
    }
    return s;
}

tz_status tz_element_composer_render(tz_ctx *ctx, const tz_element_composer *c,
                                     tz_rect rect, tz_image *out)
{
    if (out->width != rect.w || out->height != rect.h ||
        out->channels != c->like.channels)
        return tz_fail(ctx, TZ_INVALID,
                       "render: output image has another size than the crop");
    if (c->ground) {
        const tz_status s = tz_composer_render(ctx, c->ground, rect, out);
        if (s != TZ_OK || c->bare)
            return s;
    } else {
        for (int32_t y = 0; y < rect.h; y++)
            memset(tz_image_at(out, 0, y), 0,
                   (size_t)rect.w * (size_t)out->channels * sizeof *out->px);
        out->encoding = c->like.encoding;
    }
    return tz_element_renderer_render(ctx, c->things, rect, out);
}

tz_status tz_element_composer_stream(tz_ctx *ctx, const tz_element_composer *c,
                                     tz_rect rect, tz_image_sink *sink)
{
    tz_image strip = {0};
    if (tz_rect_empty(rect))
        return tz_fail(ctx, TZ_INVALID, "render: the crop is empty");
    const int32_t high = tz_element_strip(ctx, rect, c->like.channels);
    tz_status s = tz_element_composer_image(ctx, c, rect.w, high, &strip);
    for (int32_t y = 0; y < rect.h && s == TZ_OK; y += high) {
        const int32_t h = rect.h - y < high ? rect.h - y : high;
        tz_image part = tz_image_view(&strip, (tz_rect){0, 0, rect.w, h});
        s = tz_element_composer_render(ctx, c, (tz_rect){rect.x, rect.y + y, rect.w, h},
                                       &part);
        if (s == TZ_OK)
            s = tz_image_sink_rows(sink, &part);
    }
    tz_image_deinit(&strip);
    return s;
}
