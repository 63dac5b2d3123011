/* SPDX-License-Identifier: Apache-2.0 */
/* Cut-outs: a symbol's pixels, made once, sampled under each copy's map.
 *
 * Planes hold colour times alpha, and alpha: interpolating these is right at soft borders.
 * Colours are interpolated as sRGB, where a spline's swing past an edge shows as little on
 * its dark side as on its light one (as compose.c does), and blended in linear light. A
 * thing over its shadow over whatever lies beneath is, by associativity of "over", one
 * layer of
 *   colour a F,   alpha 1 - (1 - a)(1 - s).
 * A rim of weight g shows what the photo I = a F + (1 - a) B shows behind it: over what
 * lies beneath, the thing over its rim is
 *   colour a F + (1 - a) g B = (1 - g) a F + g I,   alpha 1 - (1 - a)(1 - g),
 * which needs no B, and is the photo itself where g = 1.
 * Copies moved by whole pixels take texels; others sample the cubic B-spline that runs
 * through them (compose_source.c). Smaller ones sample a plane that was halved as often as
 * leaves at most 2.2 of its px a pixel, twice an axis where there is more than one.
 * @source Porter, Duff: Compositing digital images, SIGGRAPH 1984; Williams: Pyramidal
 *   parametrics, SIGGRAPH 1983 */
#include <string.h>

#include "synthesis/element_render_internal.h"

#define TWICE 1.1 /* px of the plane a pixel from which on there are two samples */

/* ---- places -------------------------------------------------------------------------- */

tz_bounds tz_bounds_map(tz_bounds b, tz_affine m)
{
    tz_bounds out = {INFINITY, INFINITY, -INFINITY, -INFINITY};
    if (!(b.x0 <= b.x1))
        return out;
    for (int k = 0; k < 4; k++) {
        const tz_vec2 p =
            tz_affine_apply(m, (tz_vec2){k & 1 ? b.x1 : b.x0, k & 2 ? b.y1 : b.y0});
        out.x0 = fmin(out.x0, p.x), out.x1 = fmax(out.x1, p.x);
        out.y0 = fmin(out.y0, p.y), out.y1 = fmax(out.y1, p.y);
    }
    return out;
}

static const tz_image *shown(const tz_element_pixels *p)
{
    return p->map ? p->map : p->photo;
}

/* The box in the symbol's units. */
static void set_local(tz_cutout *c, const tz_element_symbol *y)
{
    const double kx = 1 / (c->mx * y->photo_scale), ky = 1 / (c->my * y->photo_scale);
    c->local.x0 = c->box.x * kx - y->photo_at.x / y->photo_scale;
    c->local.y0 = c->box.y * ky - y->photo_at.y / y->photo_scale;
    c->local.x1 = c->local.x0 + c->box.w * kx;
    c->local.y1 = c->local.y0 + c->box.h * ky;
}

void tz_cutout_place(tz_cutout *c, const tz_element_symbol *y, const tz_element_pixels *p,
                     const tz_element_render_params *params, double rim)
{
    const tz_image *map = shown(p);
    const double margin =
        fmax(fmax(params->matte + 4, rim + 3), p->plate ? params->shadow + 3 : 0);
    tz_bounds b = {INFINITY, INFINITY, -INFINITY, -INFINITY};
    for (int32_t i = 0; i < y->outline.n; i++) {
        const tz_vec2 q =
            tz_vec2_add(y->photo_at, tz_vec2_scale(y->outline.v[i], y->photo_scale));
        b.x0 = fmin(b.x0, q.x), b.x1 = fmax(b.x1, q.x);
        b.y0 = fmin(b.y0, q.y), b.y1 = fmax(b.y1, q.y);
    }
    *c = (tz_cutout){.gain = 1, .rim = rim, .empty = true};
    c->mx = (float)map->width / (float)p->photo->width;
    c->my = (float)map->height / (float)p->photo->height;
    if (!(b.x0 < p->photo->width && b.y0 < p->photo->height && b.x1 > 0 && b.y1 > 0))
        return;
    b.x0 = fmax(b.x0 - margin, -margin) * c->mx;
    b.y0 = fmax(b.y0 - margin, -margin) * c->my;
    b.x1 = fmin(b.x1 + margin, p->photo->width + margin) * c->mx;
    b.y1 = fmin(b.y1 + margin, p->photo->height + margin) * c->my;
    c->box.x = (int32_t)floor(b.x0);
    c->box.y = (int32_t)floor(b.y0);
    c->box.w = (int32_t)ceil(b.x1) - c->box.x;
    c->box.h = (int32_t)ceil(b.y1) - c->box.y;
    c->empty = false;
    set_local(c, y);
}

/* Moves by whole pixels, but for rounding. */
static bool snap(tz_affine *m, tz_rect box)
{
    const double far = fmax(box.w, box.h), e = rint(m->e), f = rint(m->f);
    if (fabs(m->a - 1) * far > 1e-3 || fabs(m->d - 1) * far > 1e-3 ||
        fabs(m->b) * far > 1e-3 || fabs(m->c) * far > 1e-3 || fabs(m->e - e) > 1e-3 ||
        fabs(m->f - f) > 1e-3)
        return false;
    *m = (tz_affine){1, 0, 0, 1, e, f};
    return true;
}

tz_cutout_view tz_cutout_look(const tz_cutout *c, const tz_element_symbol *y,
                              tz_affine map)
{
    /* symbol -> canvas after px of level 0 -> symbol */
    const double kx = 1 / (c->mx * y->photo_scale), ky = 1 / (c->my * y->photo_scale);
    const tz_affine local = {kx, 0, 0, ky, c->local.x0, c->local.y0};
    tz_cutout_view v = {.taps = 1};
    tz_affine m = tz_affine_then(local, map);
    v.exact = snap(&m, c->box);
    if (!tz_affine_invert(m, &v.inv)) { /* smaller than anything: never shows */
        v.inv = (tz_affine){0, 0, 0, 0, -1e6, -1e6};
        return v;
    }
    double step = sqrt(fabs(tz_affine_det(v.inv)));
    while (step > 2 * TWICE && v.level + 1 < TZ_CUTOUT_LEVELS) {
        step *= 0.5;
        v.level++;
    }
    v.taps = step > TWICE ? 2 : 1;
    const double half = ldexp(1, -v.level);
    v.inv = (tz_affine){v.inv.a * half, v.inv.b * half, v.inv.c * half,
                        v.inv.d * half, v.inv.e * half, v.inv.f * half};
    /* as compose.c turns them: inverse transpose, y up */
    const double det = tz_affine_det(map), s = sqrt(fabs(det)) / det;
    v.turn[0] = (float)(map.d * s), v.turn[1] = (float)(map.b * s);
    v.turn[2] = (float)(map.c * s), v.turn[3] = (float)(map.a * s);
    return v;
}

/* ---- making planes ------------------------------------------------------------------- */

/* Bilinear value of a matte's plane at photo px (x, y); `step` floats apart. */
static float at_matte(const tz_matte *m, const float *v, int32_t step, double x, double y)
{
    const double u = x - 0.5 - m->box.x, w = y - 0.5 - m->box.y;
    const int32_t i = (int32_t)floor(u), j = (int32_t)floor(w);
    float sum = 0;
    for (int k = 0; k < 4; k++) {
        int32_t a = i + (k & 1), b = j + (k >> 1);
        const double fx = k & 1 ? u - i : 1 - (u - i), fy = k >> 1 ? w - j : 1 - (w - j);
        a = a < 0 ? 0 : a < m->box.w ? a : m->box.w - 1;
        b = b < 0 ? 0 : b < m->box.h ? b : m->box.h - 1;
        sum += (float)(fx * fy) * v[((int64_t)b * m->box.w + a) * step];
    }
    return sum;
}

/* Mean of it over a pixel of the map. */
static float over_pixel(const tz_matte *m, const float *v, double x, double y, double sx,
                        double sy)
{
    const int nx = sx > 1.01 ? 4 : 1, ny = sy > 1.01 ? 4 : 1;
    float sum = 0;
    for (int j = 0; j < ny; j++)
        for (int i = 0; i < nx; i++)
            sum += at_matte(m, v, 1, x + sx * ((i + 0.5) / nx - 0.5),
                            y + sy * ((j + 0.5) / ny - 0.5));
    return sum / (float)(nx * ny);
}

/* What the map shows well inside the thing, beside photo px (x, y). */
static tz_f4 from_inside(const tz_cutout *c, const tz_matte *m, const tz_image *map,
                         double x, double y, bool raw)
{
    const float *d = m->distance;
    const double gx = at_matte(m, d, 1, x + 1, y) - at_matte(m, d, 1, x - 1, y),
                 gy = at_matte(m, d, 1, x, y + 1) - at_matte(m, d, 1, x, y - 1);
    const double l = hypot(gx, gy), here = at_matte(m, d, 1, x, y);
    const double way = l > 1e-6 ? fmax(2.5 - here, 0) / l : 0;
    x += gx * way;
    y += gy * way;
    return tz_photo_linear(map, (int32_t)floor(x * c->mx), (int32_t)floor(y * c->my), raw,
                           c->tables);
}

/* Evens the light of a colour. What a camera has clipped stays white: it would turn grey. */
static tz_f4 evened(tz_f4 f, float gain, const tz_image *map)
{
    const float most = fmaxf(fmaxf(f[0], f[1]), f[2]);
    if (gain < 1 && map->encoding == TZ_ENCODING_SRGB && most > 0.7F) {
        const float t = fminf((most - 0.7F) / 0.3F, 1);
        gain += (1 - gain) * t * t;
    }
    return f * gain;
}

/* A thing over its rim: f (colour times alpha, and alpha) over what the map shows at
 * (mx, my), by share g. */
static tz_f4 over_rim(const tz_cutout *c, tz_f4 f, float g, const tz_image *map,
                      tz_map_kind kind, int32_t mx, int32_t my)
{
    const bool raw = kind != TZ_MAP_COLOUR;
    tz_f4 i = tz_photo_linear(map, mx, my, raw, c->tables);
    if (!raw)
        i = evened(i, c->gain, map);
    const float a = f[3];
    for (int k = 0; k < 3; k++)
        f[k] += g * (i[k] - (kind == TZ_MAP_NORMAL ? 0.5F : 0) - f[k]);
    f[3] = a + g * (1 - a);
    return f;
}

/* One texel of level 0: linear, premultiplied; *shade receives the shadow, *solid alpha
 * without rim. */
static tz_f4 texel_of(const tz_cutout *c, const tz_element_pixels *p, const tz_matte *m,
                      tz_map_kind kind, int32_t u, int32_t v, float *shade,
                      uint8_t *solid)
{
    const tz_image *map = shown(p);
    const bool raw = kind != TZ_MAP_COLOUR, own = !p->map && !raw;
    const int32_t mx = c->box.x + u, my = c->box.y + v;
    const double sx = 1 / c->mx, sy = 1 / c->my;
    const double x = (mx + 0.5) * sx, y = (my + 0.5) * sy;
    tz_f4 f;
    float a;
    *shade = 0;
    if (mx < 0 || my < 0 || mx >= map->width || my >= map->height) {
        a = 0, f = (tz_f4){0};
    } else if (own) { /* within the matte, which reaches farther */
        const int64_t at = (int64_t)(my - m->box.y) * m->box.w + (mx - m->box.x);
        const float *k = m->colour + 3 * at;
        a = m->alpha[at];
        f = evened((tz_f4){k[0], k[1], k[2], 0}, c->gain, map);
    } else {
        a = over_pixel(m, m->alpha, x, y, sx, sy);
        f = tz_photo_linear(map, mx, my, raw, c->tables);
        if (a < 1)
            f += (1 - a * a) * (from_inside(c, m, map, x, y, raw) - f);
        f = raw ? f : evened(f, c->gain, map);
    }
    if (m->shade && !raw)
        *shade = over_pixel(m, m->shade, x, y, sx, sy);
    if (kind == TZ_MAP_NORMAL)
        for (int k = 0; k < 3; k++)
            f[k] -= 0.5F;
    f = f * a;
    f[3] = a;
    *solid = (uint8_t)(a * 255 + 0.5F);
    const bool within = mx >= 0 && my >= 0 && mx < map->width && my < map->height;
    const float g = m->rim && within ? over_pixel(m, m->rim, x, y, sx, sy) : 0;
    return g > 0 ? over_rim(c, f, g, map, kind, mx, my) : f;
}

/* Half the size, each px the mean of four; what lies beyond is empty. */
static tz_status halve(tz_ctx *ctx, tz_image *im)
{
    tz_image out = {0};
    const int32_t n = im->channels;
    const tz_status s =
        tz_image_init(ctx, &out, (im->width + 1) / 2, (im->height + 1) / 2, n);
    for (int32_t y = 0; s == TZ_OK && y < out.height; y++)
        for (int32_t x = 0; x < out.width; x++)
            for (int k = 0; k < 4; k++) {
                const int32_t u = 2 * x + (k & 1), v = 2 * y + (k >> 1);
                for (int32_t c = 0; c < n && u < im->width && v < im->height; c++)
                    tz_image_at(&out, x, y)[c] += 0.25F * tz_image_at(im, u, v)[c];
            }
    if (s == TZ_OK) {
        tz_image_deinit(im);
        *im = out;
    }
    return s;
}

/* Part of a sprite that is not empty, with room for splines to swing; w = 0: none. */
static tz_rect full_part(const tz_image *im, const tz_image *shade)
{
    enum { ROOM = 3 };
    int32_t x0 = im->width, y0 = im->height, x1 = -1, y1 = -1;
    for (int32_t y = 0; y < im->height; y++)
        for (int32_t x = 0; x < im->width; x++)
            if (tz_image_at(im, x, y)[3] > 0 || *tz_image_at(shade, x, y) > 0) {
                x0 = x < x0 ? x : x0, x1 = x > x1 ? x : x1;
                y0 = y < y0 ? y : y0, y1 = y > y1 ? y : y1;
            }
    if (x1 < 0)
        return (tz_rect){0, 0, 0, 0};
    return tz_rect_intersect(
        (tz_rect){x0 - ROOM, y0 - ROOM, x1 - x0 + 1 + 2 * ROOM, y1 - y0 + 1 + 2 * ROOM},
        (tz_rect){0, 0, im->width, im->height});
}

/* Narrows a cut-out to a part of its box. */
static void trim(tz_cutout *c, const tz_element_symbol *y, tz_rect part)
{
    for (int32_t v = 0; v < part.h; v++)
        memmove(c->solid + (int64_t)v * part.w,
                c->solid + (int64_t)(part.y + v) * c->box.w + part.x, (size_t)part.w);
    c->box = (tz_rect){c->box.x + part.x, c->box.y + part.y, part.w, part.h};
    set_local(c, y);
}

/* As planes hold it: sRGB times alpha; notes the range of colours. */
static tz_status encode(tz_ctx *ctx, tz_cutout *c, const tz_image *in, tz_image *out)
{
    tz_status s = tz_image_init(ctx, out, in->width, in->height, 4);
    for (int32_t y = 0; y < in->height && s == TZ_OK; y++)
        for (int32_t x = 0; x < in->width; x++) {
            tz_f4 v = tz_load4(tz_image_at(in, x, y));
            for (int k = 0; k < 3 && v[3] > 0; k++) {
                float f = v[k] / v[3];
                f = c->encoded ? tz_tables_encode(c->tables, f) : f;
                c->lo[k] = f < c->lo[k] ? f : c->lo[k];
                c->hi[k] = f > c->hi[k] ? f : c->hi[k];
                v[k] = f * v[3];
            }
            memcpy(tz_image_at(out, x, y), &v, sizeof v);
        }
    out->encoding = TZ_ENCODING_DATA;
    return s;
}

static tz_status fill_planes(tz_ctx *ctx, tz_cutout *c, tz_image *im, tz_image *shade)
{
    tz_status s = TZ_OK;
    c->lo = (tz_f4){INFINITY, INFINITY, INFINITY, 0};
    c->hi = -c->lo;
    for (int32_t k = 0; k < TZ_CUTOUT_LEVELS && s == TZ_OK && c->levels >> k; k++) {
        if (c->levels >> k & 1) {
            tz_image ready = {0};
            s = encode(ctx, c, im, &ready);
            if (s == TZ_OK)
                s = tz_source_plane_init(ctx, &c->plane[k], &ready, ready.width,
                                         ready.height, true, c->spline);
            if (s == TZ_OK && c->shaded)
                s = tz_source_plane_init(ctx, &c->shade[k], shade, ready.width,
                                         ready.height, true, c->spline);
            tz_image_deinit(&ready);
        }
        if (s == TZ_OK && c->levels >> (k + 1)) {
            s = halve(ctx, im);
            if (s == TZ_OK && c->shaded)
                s = halve(ctx, shade);
        }
    }
    return s;
}

/* All texels of level 0. */
static void fill_texels(tz_cutout *c, const tz_element_pixels *p, const tz_matte *m,
                        tz_map_kind kind, tz_image *im, tz_image *shade)
{
    for (int32_t v = 0; v < c->box.h; v++)
        for (int32_t u = 0; u < c->box.w; u++) {
            float *dark = tz_image_at(shade, u, v);
            const tz_f4 t =
                texel_of(c, p, m, kind, u, v, dark, &c->solid[(int64_t)v * c->box.w + u]);
            memcpy(tz_image_at(im, u, v), &t, sizeof t);
            c->shaded = c->shaded || *dark > 0;
        }
}

tz_status tz_cutout_fill(tz_ctx *ctx, tz_cutout *c, const tz_element_symbol *y,
                         const tz_element_pixels *p, const tz_matte *m, tz_map_kind kind)
{
    tz_image im = {0}, shade = {0};
    if (c->empty || tz_rect_empty(m->box)) {
        c->empty = true;
        return TZ_OK;
    }
    c->encoded = kind == TZ_MAP_COLOUR;
    tz_status s = tz_alloc(ctx, &c->solid, (size_t)c->box.w * (size_t)c->box.h, 1);
    if (s == TZ_OK)
        s = tz_image_init(ctx, &im, c->box.w, c->box.h, 4);
    if (s == TZ_OK)
        s = tz_image_init(ctx, &shade, c->box.w, c->box.h, 1);
    if (s == TZ_OK) {
        fill_texels(c, p, m, kind, &im, &shade);
        const tz_rect part = full_part(&im, &shade);
        c->empty = tz_rect_empty(part);
        if (!c->empty) {
            tz_image view = tz_image_view(&im, part), dark = tz_image_view(&shade, part);
            view.encoding = dark.encoding = TZ_ENCODING_DATA;
            trim(c, y, part);
            s = fill_planes(ctx, c, &view, &dark);
            tz_image_deinit(&view);
            tz_image_deinit(&dark);
        }
    }
    tz_image_deinit(&im);
    tz_image_deinit(&shade);
    return s;
}

void tz_cutout_deinit(tz_ctx *ctx, tz_cutout *c)
{
    for (int k = 0; k < TZ_CUTOUT_LEVELS; k++) {
        tz_source_plane_deinit(ctx, &c->plane[k]);
        tz_source_plane_deinit(ctx, &c->shade[k]);
    }
    tz_free(ctx, c->solid);
    *c = (tz_cutout){0};
}

/* ---- drawing ------------------------------------------------------------------------- */

/* Narrows from..to to columns x whose a (x + 0.5) + b lies in lo..hi. */
static void narrow(double a, double b, double lo, double hi, double *from, double *to)
{
    if (fabs(a) < 1e-12) {
        if (b < lo || b > hi)
            *to = *from;
        return;
    }
    double p = (lo - b) / a, q = (hi - b) / a;
    if (p > q) {
        const double t = p;
        p = q, q = t;
    }
    *from = fmax(*from, ceil(p - 0.5));
    *to = fmin(*to, floor(q - 0.5) + 1);
}

/* Columns of canvas row y, within the layer, whose samples lie in w x h px of a plane. */
static bool columns(const tz_affine *inv, const tz_rect *r, int64_t y, double w, double h,
                    int32_t *from, int32_t *to)
{
    const double cy = (double)y + 0.5;
    double x0 = r->x, x1 = r->x + r->w;
    narrow(inv->a, inv->c * cy + inv->e, 0, w, &x0, &x1);
    narrow(inv->b, inv->d * cy + inv->f, 0, h, &x0, &x1);
    if (!(x0 < x1))
        return false;
    *from = (int32_t)x0;
    *to = (int32_t)x1;
    return true;
}

/* Samples of n pixels of row y from x on into w->sum. */
static void sample_row(const tz_source_plane *s, const tz_cutout_view *v, int32_t x,
                       int64_t y, int32_t n, tz_layer_work *w)
{
    if (v->taps == 1) {
        tz_source_row(s, v->inv, v->exact, x, y, n, (float *)w->sum);
        return;
    }
    const tz_affine i = v->inv;
    for (int k = 0; k < 4; k++) {
        const double dx = k & 1 ? 0.25 : -0.25, dy = k >> 1 ? 0.25 : -0.25;
        const tz_affine m = {
            i.a, i.b, i.c, i.d, i.e + i.a * dx + i.c * dy, i.f + i.b * dx + i.d * dy};
        tz_source_row(s, m, false, x, y, n, k ? w->row : (float *)w->sum);
        for (int32_t q = 0; k && q < n; q++)
            w->sum[q] += tz_load4(w->row + 4 * (int64_t)q);
    }
    for (int32_t q = 0; q < n; q++)
        w->sum[q] *= 0.25F;
}

/* A sample as it is blended: within what alpha and range allow (splines overshoot), linear,
 * normals turned; `shade` is the shadow there. */
static inline tz_f4 settle(tz_f4 v, float shade, const tz_cutout *c, tz_map_kind kind,
                           const float *turn, const tz_tables *tables)
{
    const float least = 1.0F / 2048;
    const float a = v[3] < least ? 0 : v[3] > 1 ? 1 : v[3];
    shade = shade < 0 ? 0 : shade > 1 ? 1 : shade;
    tz_f4 out = {0, 0, 0, 1 - (1 - a) * (1 - shade)};
    if (a <= 0)
        return out;
    v = v / v[3];
    if (kind == TZ_MAP_NORMAL) {
        const float nx = turn[0] * v[0] + turn[1] * v[1],
                    ny = turn[2] * v[0] + turn[3] * v[1], nz = v[2];
        const float l = sqrtf((nx * nx + ny * ny) + nz * nz);
        const float k = l > 1e-6F ? 0.5F * a / l : 0;
        return (tz_f4){0.5F * a + k * nx, 0.5F * a + k * ny, 0.5F * a + k * nz, out[3]};
    }
    for (int k = 0; k < 3; k++) {
        const float f = v[k] < c->lo[k] ? c->lo[k] : v[k] > c->hi[k] ? c->hi[k] : v[k];
        out[k] = a * (c->encoded ? tz_tables_decode(tables, f) : f);
    }
    return out;
}

/* Alpha without rim and shadow: the nearest texel of level 0. */
static void mask_run(const tz_cutout *c, const tz_cutout_view *v, tz_rect part,
                     tz_layer *layer)
{
    const tz_rect r = layer->rect;
    const double up = ldexp(1, v->level);
    const tz_affine i = {v->inv.a * up, v->inv.b * up, v->inv.c * up,
                         v->inv.d * up, v->inv.e * up, v->inv.f * up};
    for (int32_t y = part.y; y < part.y + part.h; y++) {
        int32_t from, to;
        if (!columns(&i, &part, y, c->box.w, c->box.h, &from, &to))
            continue;
        float *m = layer->mask + (int64_t)(y - r.y) * TZ_ELEMENT_TILE - r.x;
        for (int32_t x = from; x < to; x++) {
            const tz_vec2 p = tz_affine_apply(i, (tz_vec2){x + 0.5, y + 0.5});
            const int32_t u = (int32_t)p.x, w = (int32_t)p.y;
            if (p.x >= 0 && p.y >= 0 && u < c->box.w && w < c->box.h)
                m[x] = (float)c->solid[(int64_t)w * c->box.w + u] / 255;
        }
    }
}

void tz_cutout_run(const tz_cutout *c, const tz_cutout_view *v, tz_map_kind kind,
                   tz_rect part, tz_layer *layer, tz_layer_work *w)
{
    const tz_rect r = layer->rect;
    const tz_source_plane *s = &c->plane[v->level];
    if (layer->mask) {
        mask_run(c, v, part, layer);
        return;
    }
    for (int32_t y = part.y; y < part.y + part.h; y++) {
        int32_t from, to;
        if (!columns(&v->inv, &part, y, s->width, s->height, &from, &to))
            continue;
        sample_row(s, v, from, y, to - from, w);
        if (c->shaded)
            tz_source_row(&c->shade[v->level], v->inv, v->exact, from, y, to - from,
                          w->row);
        tz_f4 *px = layer->px + (int64_t)(y - r.y) * TZ_ELEMENT_TILE - r.x;
        for (int32_t x = from; x < to; x++) {
            const float dark = c->shaded ? w->row[x - from] : 0;
            const tz_f4 t = settle(w->sum[x - from], dark, c, kind, v->turn, w->tables);
            if (t[3] > 0)
                tz_layer_over(&px[x], t);
        }
    }
}

void tz_cutout_draw(const tz_cutout *c, const tz_element_symbol *y, tz_affine map,
                    tz_map_kind kind, tz_layer *layer, tz_layer_work *w)
{
    if (c->empty)
        return;
    const tz_cutout_view v = tz_cutout_look(c, y, map);
    tz_cutout_run(c, &v, kind, layer->rect, layer, w);
}
