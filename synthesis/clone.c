/* SPDX-License-Identifier: Apache-2.0 */
/* One placement after another, in drawing order, onto a canvas that starts as the
 * uncorrected composite. seamlessClone takes no patch that leaves its canvas, so that the
 * canvas is the layout with a frame: wrapped on a torus, else its border repeated. */
#include "synthesis/clone.h"

#include <string.h>

#include "base/module.h"
#include "synthesis/clone_module.h"

enum { FRAME = 32 };

/* Range of values that 0..255 stand for. */
typedef struct range {
    float lo, hi;
} range;

static range value_range(const tz_composer *c)
{
    range r = {0, 1};
    if (c->encoding != TZ_ENCODING_DATA)
        return r;
    r = (range){c->source[0].lo[0], c->source[0].hi[0]};
    for (int32_t s = 0; s < c->sources; s++)
        for (int32_t k = 0; k < c->channels; k++) {
            r.lo = fminf(r.lo, c->source[s].lo[k]);
            r.hi = fmaxf(r.hi, c->source[s].hi[k]);
        }
    if (!(r.hi > r.lo))
        r.hi = r.lo + 1;
    return r;
}

/* Channel of ours that stands in the picture's k-th; alpha is not cloned. */
static int32_t channel_of(const tz_composer *c, int32_t k)
{
    const int32_t colours = c->channels - (c->alpha >= 0);
    return colours >= 3 ? k : 0;
}

static uint8_t to_byte(float v, range r)
{
    const float t = (v - r.lo) / (r.hi - r.lo) * 255.0F + 0.5F;
    return (uint8_t)(t < 0 ? 0 : t > 255 ? 255 : t);
}

static tz_status picture_of_source(tz_ctx *ctx, const tz_composer *c, int32_t k, range r,
                                   tz_clone_picture *p)
{
    const tz_source_plane *s = &c->source[k];
    tz_status st = tz_alloc(ctx, &p->px, (size_t)s->width * (size_t)s->height, 3);
    if (st != TZ_OK)
        return st;
    p->width = s->width, p->height = s->height;
    for (int32_t y = 0; y < s->height; y++) {
        const float *in = s->texel + (y + s->pad) * s->stride + (int64_t)s->pad * s->step;
        uint8_t *out = p->px + 3 * (int64_t)y * s->width;
        for (int64_t x = 0; x < s->width; x++)
            for (int32_t e = 0; e < 3; e++)
                out[3 * x + e] = to_byte(in[x * s->step + channel_of(c, e)], r);
    }
    return TZ_OK;
}

static int32_t wrap_or_clamp(int32_t i, int32_t n, bool wrap)
{
    if (wrap)
        return (int32_t)((((int64_t)i % n) + n) % n);
    return i < 0 ? 0 : i >= n ? n - 1 : i;
}

static tz_status canvas_of(tz_ctx *ctx, const tz_composer *c, const tz_image *all,
                           range r, tz_clone_picture *p)
{
    p->width = all->width + 2 * FRAME, p->height = all->height + 2 * FRAME;
    tz_status s = tz_alloc(ctx, &p->px, (size_t)p->width * (size_t)p->height, 3);
    for (int32_t y = 0; s == TZ_OK && y < p->height; y++) {
        uint8_t *out = p->px + 3 * (int64_t)y * p->width;
        const int32_t iy = wrap_or_clamp(y - FRAME, all->height, c->layout->tile);
        for (int32_t x = 0; x < p->width; x++) {
            const int32_t ix = wrap_or_clamp(x - FRAME, all->width, c->layout->tile);
            const float *in = tz_image_at(all, ix, iy);
            for (int32_t e = 0; e < 3; e++)
                *out++ = to_byte(in[channel_of(c, e)], r);
        }
    }
    return s;
}

/* Pastes every copy of placement `id` that meets the canvas. `border` has room for its
 * points. */
static tz_status paste(tz_ctx *ctx, const tz_composer *c, const tz_clone_api *api,
                       int32_t id, tz_clone_patch *patch, double *border,
                       const tz_clone_picture *canvas)
{
    const tz_piece *p = &c->piece[id];
    const tz_placement *pl = &c->layout->place.v[id];
    const tz_source_plane *s = &c->source[p->source];
    const double w = c->layout->width, h = c->layout->height;
    const bool tile = c->layout->tile;
    const int kx0 = tile ? (int)ceil((-FRAME - p->x1) / w) : 0;
    const int ky0 = tile ? (int)ceil((-FRAME - p->y1) / h) : 0;
    const int kx1 = tile ? (int)floor((w + FRAME - p->x0) / w) : 0;
    const int ky1 = tile ? (int)floor((h + FRAME - p->y0) / h) : 0;
    char why[300] = "";
    for (int ky = ky0; ky <= ky1; ky++)
        for (int kx = kx0; kx <= kx1; kx++) {
            const double mx = FRAME + kx * w, my = FRAME + ky * h;
            for (int32_t q = 0; q < pl->points; q++) {
                border[2 * q] = c->edge[2 * (size_t)(pl->border + q)] + mx;
                border[2 * q + 1] = c->edge[2 * (size_t)(pl->border + q) + 1] + my;
            }
            const tz_affine m = pl->map;
            const double map[6] = {m.a / s->sx, m.b / s->sx, m.c / s->sy,
                                   m.d / s->sy, m.e + mx,    m.f + my};
            memcpy(patch->map, map, sizeof map);
            patch->border = border;
            patch->points = pl->points;
            const int rc = api->paste(patch, canvas, why, sizeof why);
            if (rc != 0)
                return tz_fail(ctx, rc == 2 ? TZ_NOMEM : TZ_INVALID,
                               "render: OpenCV cannot clone placement %d: %s", (int)id,
                               why);
        }
    return TZ_OK;
}

static void cut_out(const tz_composer *c, const tz_image *all,
                    const tz_clone_picture *canvas, range v, tz_rect r, tz_image *out)
{
    const float scale = (v.hi - v.lo) / 255.0F;
    const bool grey = c->channels - (c->alpha >= 0) < 3;
    for (int32_t y = 0; y < r.h; y++)
        for (int32_t x = 0; x < r.w; x++) {
            const uint8_t *in =
                canvas->px +
                3 * ((int64_t)(r.y + y + FRAME) * canvas->width + (r.x + x + FRAME));
            const float *plain = tz_image_at(all, r.x + x, r.y + y);
            float *o = tz_image_at(out, x, y);
            for (int32_t k = 0; k < c->channels; k++)
                o[k] = k == c->alpha ? plain[k] : v.lo + scale * (float)in[grey ? 0 : k];
        }
}

tz_status tz_clone_render(tz_ctx *ctx, const tz_composer *c, tz_rect r, tz_image *out)
{
    const tz_layout *l = c->layout;
    tz_composer plain = *c;
    tz_image all = {0};
    tz_clone_picture *photo = NULL, canvas = {0};
    double *border = NULL;
    const tz_clone_api *api;
    const int32_t colours = c->channels - (c->alpha >= 0);
    const tz_rect whole = {0, 0, l->width, l->height};
    const tz_rect in = tz_rect_intersect(r, whole);
    if (tz_rect_empty(r) || in.w != r.w || in.h != r.h)
        return tz_fail(ctx, TZ_INVALID,
                       "crop %d,%d,%d,%d does not lie inside the layout of %d x %d px",
                       (int)r.x, (int)r.y, (int)r.w, (int)r.h, (int)l->width,
                       (int)l->height);
    if (c->kind == TZ_MAP_NORMAL || (colours != 1 && colours != 3))
        return tz_fail(
            ctx, TZ_INVALID,
            "render: clone opencv takes grey and RGB pictures only; use screened");
    tz_status s = tz_module_symbol(ctx, "clone", TZ_CLONE_SYMBOL, &api);
    if (s != TZ_OK)
        return s;
    plain.params.clone = TZ_CLONE_NONE;
    s = tz_image_init(ctx, &all, l->width, l->height, c->channels);
    if (s == TZ_OK)
        s = tz_composer_render(ctx, &plain, whole, &all);
    const range v = value_range(c);
    if (s == TZ_OK)
        s = canvas_of(ctx, c, &all, v, &canvas);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &photo, (size_t)c->sources, sizeof *photo);
    for (int32_t k = 0; s == TZ_OK && k < c->sources; k++)
        s = picture_of_source(ctx, c, k, v, &photo[k]);
    int32_t most = 1;
    for (int32_t k = 0; k < l->place.n; k++)
        most = l->place.v[k].points > most ? l->place.v[k].points : most;
    if (s == TZ_OK)
        s = tz_alloc(ctx, &border, 2 * (size_t)most, sizeof *border);
    for (int32_t k = 0; s == TZ_OK && k < l->place.n; k++) {
        if (l->place.v[k].removed)
            continue;
        tz_clone_patch patch = {.photo = photo[c->piece[k].source]};
        s = tz_ctx_cancelled(ctx) ? TZ_CANCELLED
                                  : paste(ctx, c, api, k, &patch, border, &canvas);
        tz_progress_add(ctx, 0); /* its pixels are counted; shows that time goes on */
    }
    if (s == TZ_OK)
        cut_out(c, &all, &canvas, v, r, out);
    for (int32_t k = 0; photo && k < c->sources; k++)
        tz_free(ctx, photo[k].px);
    tz_free(ctx, photo);
    tz_free(ctx, border);
    tz_free(ctx, canvas.px);
    tz_image_deinit(&all);
    return s;
}
