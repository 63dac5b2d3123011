/* SPDX-License-Identifier: Apache-2.0 */
/* Drawings. Paths and circles of flat colours, which is what documents read from other
 * programs become (elements/element_markup.c), are covered exactly and blended in linear
 * light here; each symbol is read once. All other markup (gradients, groups, styles,
 * text, ...) is drawn by librsvg under each element's own map, clipped to the tile, and
 * then blended in linear light as a whole. */
#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "base/module.h"
#include "elements/element_color.h"
#include "synthesis/element_render_internal.h"

/* of a flattened curve from the curve, px */
#define FLAT 0.02

/* ---- reading ------------------------------------------------------------------------- */

/* Sets *out to a flat paint. False for others. */
static bool read_paint(tz_svg_node n, const char *name, const char *opacity, bool missing,
                       tz_f4 *out)
{
    const char *text = tz_svg_attr(n, name), *share = tz_svg_attr(n, opacity);
    uint32_t color = missing ? 0x000000ff : 0;
    double a = 1;
    *out = (tz_f4){0};
    if (text && strcmp(text, "none") == 0)
        return true;
    if (text && !tz_color_parse(text, strlen(text), &color))
        return false;
    if (share && !tz_svg_number(share, &a))
        return false;
    a = (a < 0 ? 0 : a > 1 ? 1 : a) * (color & 255) / 255.0;
    for (int k = 0; k < 3; k++)
        (*out)[k] =
            tz_srgb_decode((float)((color >> (24 - 8 * k)) & 255) / 255) * (float)a;
    (*out)[3] = (float)a;
    return true;
}

static int choice(const char *text, const char *const names[3])
{
    for (int k = 0; text && k < 3; k++)
        if (strcmp(text, names[k]) == 0)
            return k;
    return text ? -1 : 0;
}

static bool number_or(tz_svg_node n, const char *name, double missing, double *out)
{
    const char *text = tz_svg_attr(n, name);
    *out = missing;
    return !text || tz_svg_number(text, out);
}

/* Whether anything but flat paint of this one shape is asked for. */
static bool is_plain(tz_svg_node n)
{
    static const char *const others[] = {
        "style",          "class",        "transform",
        "opacity",        "filter",       "mask",
        "clip-path",      "display",      "visibility",
        "marker",         "marker-start", "marker-mid",
        "marker-end",     "paint-order",  "stroke-dasharray",
        "vector-effect",  "pathLength",   "requiredFeatures",
        "systemLanguage", "color"};
    for (size_t k = 0; k < sizeof others / sizeof *others; k++)
        if (tz_svg_attr(n, others[k]))
            return false;
    return !tz_svg_child(n) && (tz_svg_is(n, "path") || tz_svg_is(n, "circle"));
}

/* *plain becomes false where librsvg must draw it. */
static tz_status read_part(tz_ctx *ctx, tz_svg_node n, tz_flat_part *p, bool *plain)
{
    static const char *const cap[] = {"butt", "round", "square"};
    static const char *const join[] = {"miter", "round", "bevel"};
    const char *rule = tz_svg_attr(n, "fill-rule");
    *p = (tz_flat_part){0};
    p->even_odd = rule && strcmp(rule, "evenodd") == 0;
    p->pen.cap = choice(tz_svg_attr(n, "stroke-linecap"), cap);
    p->pen.join = choice(tz_svg_attr(n, "stroke-linejoin"), join);
    *plain = is_plain(n) && read_paint(n, "fill", "fill-opacity", true, &p->fill) &&
             read_paint(n, "stroke", "stroke-opacity", false, &p->stroke) &&
             number_or(n, "stroke-width", 1, &p->pen.width) && p->pen.width >= 0 &&
             number_or(n, "stroke-miterlimit", 4, &p->pen.miter) && p->pen.cap >= 0 &&
             p->pen.join >= 0;
    if (!*plain)
        return TZ_OK;
    if (tz_svg_is(n, "circle")) {
        *plain = number_or(n, "cx", 0, &p->centre.x) &&
                 number_or(n, "cy", 0, &p->centre.y) &&
                 number_or(n, "r", 0, &p->radius) && p->radius >= 0;
        return TZ_OK;
    }
    const char *d = tz_svg_attr(n, "d");
    const tz_status s = tz_svg_path_parse(NULL, d ? d : "", &p->path);
    if (s != TZ_OK) { /* librsvg shows it up to its fault */
        tz_svg_path_deinit(NULL, &p->path);
        *plain = false;
        return s == TZ_NOMEM ? tz_fail(ctx, s, "out of memory") : TZ_OK;
    }
    tz_svg_path_deinit(NULL, &p->path);
    return tz_svg_path_parse(ctx, d ? d : "", &p->path);
}

static void clear_parts(tz_ctx *ctx, tz_drawing *d)
{
    for (int32_t i = 0; i < d->part.n; i++)
        tz_svg_path_deinit(ctx, &d->part.v[i].path);
    tz_array_free(ctx, &d->part);
}

static tz_status read_parts(tz_ctx *ctx, tz_drawing *d, tz_svg_node root, bool *plain)
{
    tz_status s = TZ_OK;
    *plain = true;
    for (tz_svg_node c = tz_svg_child(root); c && *plain && s == TZ_OK;
         c = tz_svg_next(c)) {
        tz_flat_part p;
        s = read_part(ctx, c, &p, plain);
        if (s == TZ_OK && *plain) {
            s = tz_array_push(ctx, &d->part, p);
            if (s != TZ_OK)
                tz_svg_path_deinit(ctx, &p.path);
        }
    }
    if (s != TZ_OK || !*plain)
        clear_parts(ctx, d);
    return s;
}

/* Bounds of what parts paint. */
static tz_bounds bounds_of(const tz_drawing *d)
{
    tz_bounds b = {INFINITY, INFINITY, -INFINITY, -INFINITY};
    for (int32_t i = 0; i < d->part.n; i++) {
        const tz_flat_part *p = &d->part.v[i];
        const double corner = p->pen.join == 0 ? fmax(p->pen.miter, 1.5) : 1.5;
        const double pen = p->stroke[3] > 0 ? 0.5 * p->pen.width * corner : 0;
        const double r = p->radius + pen;
        for (int32_t k = 0; k < p->path.point.n; k++) {
            const tz_vec2 q = p->path.point.v[k];
            b.x0 = fmin(b.x0, q.x - pen), b.x1 = fmax(b.x1, q.x + pen);
            b.y0 = fmin(b.y0, q.y - pen), b.y1 = fmax(b.y1, q.y + pen);
        }
        if (p->radius > 0) {
            b.x0 = fmin(b.x0, p->centre.x - r), b.x1 = fmax(b.x1, p->centre.x + r);
            b.y0 = fmin(b.y0, p->centre.y - r), b.y1 = fmax(b.y1, p->centre.y + r);
        }
    }
    return b;
}

static const char head[] =
    "<svg xmlns=\"" TZ_SVG_NS "\" xmlns:xlink=\"" TZ_XLINK_NS "\" xmlns:tz=\"" TZ_NS
    "\" xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" "
    "xmlns:sodipodi=\"http://sodipodi.sourceforge.net/DTD/sodipodi-0.dtd\"";

static tz_status wrap(tz_ctx *ctx, const char *markup, char **out)
{
    const size_t room = sizeof head + strlen(markup) + 64;
    tz_status s = tz_alloc(ctx, out, room, 1);
    if (s == TZ_OK)
        snprintf(*out, room, "%s><g id=\"" TZ_VECTOR_GROUP "\">%s</g></svg>", head,
                 markup);
    return s;
}

static tz_status fault(tz_ctx *ctx, const tz_drawing *d, int code, const char *why)
{
    if (code == 2)
        return tz_fail(ctx, TZ_NOMEM, "%s: librsvg has no memory left to draw it",
                       d->name);
    return tz_fail(ctx, TZ_FORMAT, "%s: librsvg cannot draw it: %s", d->name, why);
}

/* Opens the document once to see that it can be, and how far it reaches. */
static tz_status measure(tz_ctx *ctx, tz_drawing *d, const char *markup, double radius)
{
    const tz_vector_api *api;
    void *doc = NULL;
    char why[256] = "";
    double b[4];
    tz_status s = tz_module_symbol(ctx, "vector", TZ_VECTOR_SYMBOL, (void *)&api);
    if (s == TZ_OK)
        s = wrap(ctx, markup, &d->document);
    if (s != TZ_OK)
        return s;
    int code = api->open(d->document, strlen(d->document), &doc, why, sizeof why);
    if (code == 0)
        code = api->extents(doc, radius, b, why, sizeof why);
    api->close(doc);
    if (code != 0)
        return fault(ctx, d, code, why);
    d->box = (tz_bounds){b[0], b[1], b[2], b[3]};
    d->filtered = strstr(markup, "filter") != NULL;
    if (d->filtered && b[0] <= b[2]) { /* paints beyond its shapes */
        const double more = fmax(b[2] - b[0], b[3] - b[1]);
        d->box = (tz_bounds){b[0] - more, b[1] - more, b[2] + more, b[3] + more};
    }
    return TZ_OK;
}

tz_status tz_drawing_init(tz_ctx *ctx, tz_drawing *d, const char *name,
                          const char *markup, double radius)
{
    tz_svg_doc *doc = NULL;
    char *text = NULL;
    bool plain = true;
    *d = (tz_drawing){.name = name};
    tz_status s = TZ_OK;
    if (*markup) {
        s = wrap(ctx, markup, &text);
        if (s == TZ_OK)
            s = tz_svg_parse(ctx, name, text, strlen(text), &doc);
        if (s == TZ_OK)
            s = read_parts(ctx, d, tz_svg_child(tz_svg_root(doc)), &plain);
        if (s == TZ_OK && !plain)
            s = measure(ctx, d, markup, radius);
    } else { /* as documents show it */
        tz_flat_part p = {.radius = radius};
        p.fill[0] = p.fill[1] = p.fill[2] = tz_srgb_decode(128.0F / 255);
        p.fill[3] = 1;
        s = tz_array_push(ctx, &d->part, p);
    }
    if (s == TZ_OK && plain)
        d->box = bounds_of(d);
    tz_svg_free(doc);
    tz_free(ctx, text);
    if (s != TZ_OK)
        tz_drawing_deinit(ctx, d);
    return s;
}

void tz_drawing_widen(tz_drawing *d, double scale)
{
    for (int32_t i = 0; i < d->part.n; i++)
        d->part.v[i].pen.width *= scale;
    if (!d->document)
        d->box = bounds_of(d);
}

void tz_drawing_deinit(tz_ctx *ctx, tz_drawing *d)
{
    clear_parts(ctx, d);
    tz_free(ctx, d->document);
    *d = (tz_drawing){0};
}

/* ---- drawing ------------------------------------------------------------------------- */

void tz_layer_paint(tz_layer *layer, tz_cover *c, float *row, tz_f4 colour, bool even_odd)
{
    const int32_t bottom = c->bottom < layer->rect.h ? c->bottom : layer->rect.h - 1;
    for (int32_t y = c->top; y <= bottom; y++) {
        int32_t from, to;
        if (!tz_cover_take(c, y, even_odd, row, &from, &to))
            continue;
        const int64_t at = (int64_t)y * TZ_ELEMENT_TILE;
        if (layer->mask) {
            float *m = layer->mask + at;
            for (int32_t x = from; x < to; x++)
                m[x] = m[x] + row[x] * (1 - m[x]);
            continue;
        }
        tz_f4 *px = layer->px + at;
        for (int32_t x = from; x < to; x++)
            if (row[x] > 0)
                tz_layer_over(&px[x], colour * row[x]);
    }
    tz_cover_reset(c);
}

static tz_status push(tz_ctx *ctx, tz_layer_work *w, tz_vec2 p, bool smooth)
{
    tz_status s = tz_array_push(ctx, &w->point, p);
    if (s == TZ_OK)
        s = tz_array_push(ctx, &w->smooth, smooth);
    return s;
}

/* Steps that keep a chord within FLAT of a cubic (Wang's bound). */
static int32_t cubic_steps(const tz_vec2 p[4])
{
    double most = 0;
    for (int k = 0; k < 2; k++) {
        const tz_vec2 d = {p[k].x - 2 * p[k + 1].x + p[k + 2].x,
                           p[k].y - 2 * p[k + 1].y + p[k + 2].y};
        most = fmax(most, tz_vec2_length(d));
    }
    const double n = ceil(sqrt(0.75 * most / FLAT));
    return n < 1 ? 1 : n < 2000 ? (int32_t)n : 2000;
}

static tz_status push_cubic(tz_ctx *ctx, tz_layer_work *w, const tz_vec2 p[4])
{
    const int32_t n = cubic_steps(p);
    tz_status s = TZ_OK;
    for (int32_t k = 1; k <= n && s == TZ_OK; k++) {
        const double t = (double)k / n, u = 1 - t;
        const double a = u * u * u, b = 3 * u * u * t, c = 3 * u * t * t, d = t * t * t;
        s = push(ctx, w,
                 (tz_vec2){a * p[0].x + b * p[1].x + c * p[2].x + d * p[3].x,
                           a * p[0].y + b * p[1].y + c * p[2].y + d * p[3].y},
                 k < n);
    }
    return s;
}

/* Ends a subpath: covers its inside, or its line. */
static void finish(tz_layer_work *w, bool closed, const tz_pen *pen)
{
    if (pen)
        tz_cover_stroke(&w->cover, w->point.v, w->smooth.v, w->point.n, closed, pen);
    else
        tz_cover_polygon(&w->cover, w->point.v, w->point.n);
    w->point.n = w->smooth.n = 0;
}

/* Covers a path under a map. pen NULL = its inside. */
static tz_status cover_path(tz_ctx *ctx, tz_layer_work *w, const tz_svg_path *path,
                            tz_affine map, const tz_pen *pen)
{
    const tz_vec2 *v = path->point.v;
    tz_vec2 at = {0, 0}, start = {0, 0};
    tz_status s = TZ_OK;
    w->point.n = w->smooth.n = 0;
    for (int32_t i = 0; i < path->verb.n && s == TZ_OK; i++) {
        const uint8_t verb = path->verb.v[i];
        if (verb == TZ_PATH_MOVE) {
            if (w->point.n > 0)
                finish(w, false, pen);
            at = start = tz_affine_apply(map, *v++);
            continue;
        }
        if (w->point.n == 0)
            s = push(ctx, w, at, false);
        if (s != TZ_OK)
            break;
        if (verb == TZ_PATH_CLOSE) {
            finish(w, true, pen);
            at = start;
        } else if (verb == TZ_PATH_LINE) {
            at = tz_affine_apply(map, *v++);
            s = push(ctx, w, at, false);
        } else {
            const tz_vec2 p[4] = {at, tz_affine_apply(map, v[0]),
                                  tz_affine_apply(map, v[1]), tz_affine_apply(map, v[2])};
            s = push_cubic(ctx, w, p);
            at = p[3];
            v += 3;
        }
    }
    if (s == TZ_OK && w->point.n > 0)
        finish(w, false, pen);
    return s;
}

static tz_status cover_circle(tz_ctx *ctx, tz_layer_work *w, const tz_flat_part *p,
                              tz_affine map, double scale, const tz_pen *pen)
{
    const double r = p->radius * scale;
    const double step = r > FLAT ? 2 * acos(1 - FLAT / r) : 1;
    const int32_t n = (int32_t)fmin(ceil(2 * TZ_PI / step) + 4, 20000);
    /* of the same area as the circle */
    const double grow = p->radius * sqrt(2 * TZ_PI / n / sin(2 * TZ_PI / n));
    tz_status s = TZ_OK;
    w->point.n = w->smooth.n = 0;
    for (int32_t i = 0; i < n && s == TZ_OK; i++) {
        const double a = 2 * TZ_PI * i / n;
        const tz_vec2 q = {p->centre.x + grow * cos(a), p->centre.y + grow * sin(a)};
        s = push(ctx, w, tz_affine_apply(map, q), true);
    }
    if (s == TZ_OK)
        finish(w, true, pen);
    return s;
}

static tz_status draw_flat(tz_ctx *ctx, const tz_drawing *d, tz_affine map,
                           tz_layer *layer, tz_layer_work *w)
{
    const double scale = sqrt(fabs(tz_affine_det(map)));
    tz_status s = TZ_OK;
    map.e -= layer->rect.x;
    map.f -= layer->rect.y;
    for (int32_t i = 0; i < d->part.n && s == TZ_OK; i++) {
        const tz_flat_part *p = &d->part.v[i];
        tz_pen pen = p->pen;
        pen.width *= scale;
        for (int pass = 0; pass < 2 && s == TZ_OK; pass++) {
            const tz_f4 colour = pass ? p->stroke : p->fill;
            const tz_pen *with = pass ? &pen : NULL;
            if (!(colour[3] > 0) || (pass && !(pen.width > 0)))
                continue;
            s = p->radius > 0 ? cover_circle(ctx, w, p, map, scale, with)
                              : cover_path(ctx, w, &p->path, map, with);
            tz_layer_paint(layer, &w->cover, w->row, colour, !pass && p->even_odd);
        }
    }
    return s;
}

/* ---- by librsvg ---------------------------------------------------------------------- */

static tz_f4 linear_of(uint32_t v, const float *decoded)
{
    const uint32_t a = v >> 24;
    const float alpha = (float)a / 255;
    tz_f4 out = {0, 0, 0, alpha};
    for (int k = 0; k < 3; k++) {
        uint32_t c = ((v >> (16 - 8 * k)) & 255) * 255 + a / 2;
        c /= a;
        out[k] = decoded[c > 255 ? 255 : c] * alpha;
    }
    return out;
}

static tz_status open_document(tz_ctx *ctx, const tz_drawing *d, int32_t number,
                               tz_layer_work *w)
{
    char why[256] = "";
    if (w->document[number])
        return TZ_OK;
    if (!w->api) {
        const tz_status s =
            tz_module_symbol(ctx, "vector", TZ_VECTOR_SYMBOL, (void *)&w->api);
        if (s != TZ_OK)
            return s;
        for (int k = 0; k < 256; k++)
            w->decoded[k] = tz_srgb_decode((float)k / 255);
    }
    const int code = w->api->open(d->document, strlen(d->document), &w->document[number],
                                  why, sizeof why);
    return code == 0 ? TZ_OK : fault(ctx, d, code, why);
}

/* Draws the document into block r (of a tile's own pixels) of w->block, or of memory of its
 * own where that is too small. */
static tz_status draw_block(tz_ctx *ctx, const tz_drawing *d, int32_t number,
                            tz_affine map, tz_rect r, tz_layer_work *w, uint32_t **own)
{
    const size_t n = (size_t)r.w * (size_t)r.h;
    char why[256] = "";
    tz_status s = TZ_OK;
    uint32_t *px = w->block;
    if (n > (size_t)TZ_ELEMENT_TILE * TZ_ELEMENT_TILE) {
        s = tz_alloc(ctx, own, n, sizeof *px);
        px = *own;
    }
    if (s != TZ_OK)
        return s;
    memset(px, 0, n * sizeof *px);
    const tz_vector_block block = {px, r.w, r.h};
    const double m[6] = {map.a, map.b, map.c, map.d, map.e - r.x, map.f - r.y};
    const int code = w->api->draw(w->document[number], m, &block, why, sizeof why);
    return code == 0 ? TZ_OK : fault(ctx, d, code, why);
}

/* Filters look at pixels round about: such drawings are made whole, or as far as MARGIN px
 * beyond the tile. */
enum { MARGIN = 1024 };

static tz_status draw_document(tz_ctx *ctx, const tz_drawing *d, int32_t number,
                               tz_affine map, tz_layer *layer, tz_layer_work *w)
{
    const tz_bounds b = tz_bounds_map(d->box, map);
    const tz_rect t = layer->rect;
    const double more = d->filtered ? MARGIN : 0;
    uint32_t *own = NULL;
    tz_status s = open_document(ctx, d, number, w);
    if (s != TZ_OK || !(b.x0 <= b.x1))
        return s;
    const int32_t x0 = (int32_t)fmax(floor(b.x0) - 1, t.x - more),
                  y0 = (int32_t)fmax(floor(b.y0) - 1, t.y - more);
    const int32_t x1 = (int32_t)fmin(ceil(b.x1) + 1, t.x + t.w + more),
                  y1 = (int32_t)fmin(ceil(b.y1) + 1, t.y + t.h + more);
    const tz_rect block = {x0, y0, x1 - x0, y1 - y0}, part = tz_rect_intersect(block, t);
    if (tz_rect_empty(block) || tz_rect_empty(part))
        return TZ_OK;
    s = draw_block(ctx, d, number, map, block, w, &own);
    for (int32_t y = part.y; y < part.y + part.h && s == TZ_OK; y++) {
        const uint32_t *p =
            (own ? own : w->block) + (int64_t)(y - y0) * block.w + (part.x - x0);
        const int64_t at = (int64_t)(y - t.y) * TZ_ELEMENT_TILE + (part.x - t.x);
        for (int32_t x = 0; x < part.w; x++) {
            if (p[x] >> 24 == 0)
                continue;
            if (layer->mask)
                layer->mask[at + x] = (float)(p[x] >> 24) / 255;
            else
                tz_layer_over(&layer->px[at + x], linear_of(p[x], w->decoded));
        }
    }
    tz_free(ctx, own);
    return s;
}

tz_status tz_drawing_draw(tz_ctx *ctx, const tz_drawing *d, int32_t number, tz_affine map,
                          tz_layer *layer, tz_layer_work *w)
{
    if (d->document)
        return draw_document(ctx, d, number, map, layer, w);
    return draw_flat(ctx, d, map, layer, w);
}
