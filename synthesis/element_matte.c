/* SPDX-License-Identifier: Apache-2.0 */
/* Mattes: how much of each pixel of a photo belongs to a thing, which colour the thing has
 * there, and how dark the ground beside it is.
 *
 * Near an outline a pixel shows I = a F + (1 - a) B. With F and B the means of what lies
 * well inside and well outside nearby, a is the place of I on the line between them,
 *   a = (I - B) . (F - B) / |F - B|^2,
 * which is trusted as far as inside and outside differ by more than they vary themselves:
 *   w = 1 / (1 + (3 s / |F - B|)^2),   s = their spread along the line,
 * and else the area under the outline counts. The thing's own colour is then
 *   F + a (I - a F - (1 - a) B):
 * the photo's own texture where the thing fills the pixel, the mean inside where little of
 * it is left, never the old neighbour's.
 * @source Chuang, Curless, Salesin, Szeliski: A Bayesian approach to digital matting, CVPR
 *   2001, with one colour a side, which is then in closed form; Smith, Blinn: Blue screen
 *   matting, SIGGRAPH 1996 */
#include <string.h>

#include "synthesis/element_render_internal.h"

enum {
    WINDOW = 6,
    SPAN = 2 * WINDOW + 1
}; /* px about a pixel in which inside and outside are looked at */

tz_f4 tz_photo_linear(const tz_image *photo, int32_t x, int32_t y, bool raw,
                      const tz_tables *t)
{
    const bool plain = raw || photo->encoding != TZ_ENCODING_SRGB;
    const int32_t colours = photo->channels - (photo->alpha >= 0);
    tz_f4 v = {0};
    x = x < 0 ? 0 : x < photo->width ? x : photo->width - 1;
    y = y < 0 ? 0 : y < photo->height ? y : photo->height - 1;
    const float *p = tz_image_at(photo, x, y);
    for (int32_t k = 0, c = 0; k < photo->channels && c < 3 && c < colours; k++)
        if (k != photo->alpha)
            v[c++] = plain ? p[k] : t ? tz_tables_decode(t, p[k]) : tz_srgb_decode(p[k]);
    return v;
}

static float opacity(const tz_image *photo, int32_t x, int32_t y)
{
    if (x < 0 || y < 0 || x >= photo->width || y >= photo->height)
        return 0;
    return photo->alpha >= 0 ? tz_image_at(photo, x, y)[photo->alpha] : 1;
}

static float dot3(tz_f4 a, tz_f4 b) { return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]; }

/* ---- outlines ------------------------------------------------------------------------ */

static int32_t part_end(const tz_element_symbol *y, int32_t k)
{
    return k + 1 < y->part.n ? y->part.v[k + 1] : y->outline.n;
}

/* Covers the outline in a block whose corner is at (x, y) of the photo. */
static void cover_outline(const tz_element_symbol *y, int32_t x0, int32_t y0, tz_cover *c)
{
    for (int32_t k = 0; k < y->part.n; k++) {
        const int32_t from = y->part.v[k], end = part_end(y, k);
        for (int32_t i = from; i < end; i++) {
            tz_vec2 p = tz_matte_point(y, y->outline.v[i]),
                    q = tz_matte_point(y, y->outline.v[i + 1 < end ? i + 1 : from]);
            p.x -= x0, p.y -= y0, q.x -= x0, q.y -= y0;
            tz_cover_edge(c, p, q);
        }
    }
}

static tz_rect outline_box(const tz_element_symbol *y, double margin,
                           const tz_image *photo)
{
    tz_bounds b = {INFINITY, INFINITY, -INFINITY, -INFINITY};
    for (int32_t i = 0; i < y->outline.n; i++) {
        const tz_vec2 p = tz_matte_point(y, y->outline.v[i]);
        b.x0 = fmin(b.x0, p.x), b.x1 = fmax(b.x1, p.x);
        b.y0 = fmin(b.y0, p.y), b.y1 = fmax(b.y1, p.y);
    }
    if (!(b.x0 < photo->width && b.y0 < photo->height && b.x1 > 0 && b.y1 > 0))
        return (tz_rect){0, 0, 0, 0};
    const double lo = -margin, x1 = photo->width + margin, y1 = photo->height + margin;
    const int32_t x = (int32_t)floor(fmax(b.x0 - margin, lo)),
                  t = (int32_t)floor(fmax(b.y0 - margin, lo));
    return (tz_rect){x, t, (int32_t)ceil(fmin(b.x1 + margin, x1)) - x,
                     (int32_t)ceil(fmin(b.y1 + margin, y1)) - t};
}

tz_status tz_matte_mark(tz_ctx *ctx, const tz_element_symbol *y, int32_t number,
                        tz_matte_photo *p)
{
    const int32_t width = p->photo->width, height = p->photo->height;
    const tz_rect box =
        tz_rect_intersect(outline_box(y, 1, p->photo), (tz_rect){0, 0, width, height});
    tz_cover c = {0};
    float *row = NULL;
    if (tz_rect_empty(box))
        return TZ_OK;
    tz_status s = tz_cover_init(ctx, &c, box.w, box.h);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &row, (size_t)box.w, sizeof *row);
    if (s == TZ_OK) {
        cover_outline(y, box.x, box.y, &c);
        for (int32_t j = c.top; j <= c.bottom; j++) {
            int32_t from, to;
            if (!tz_cover_take(&c, j, true, row, &from, &to))
                continue;
            int32_t *at = p->label + (int64_t)(box.y + j) * width + box.x;
            for (int32_t i = from; i < to; i++)
                if (row[i] >= 0.5F)
                    at[i] = number + 1;
                else if (row[i] > 0 && at[i] <= 0)
                    at[i] = -(number + 1);
        }
    }
    tz_free(ctx, row);
    tz_cover_deinit(ctx, &c);
    return s;
}

/* Distances to the outline as far as `reach`, and which way. */
static void find_distances(const tz_element_symbol *y, tz_matte *m)
{
    const tz_rect b = m->box;
    const int64_t n = (int64_t)b.w * b.h;
    for (int64_t i = 0; i < n; i++)
        m->distance[i] = m->reach * m->reach;
    for (int32_t k = 0; k < y->part.n; k++) {
        const int32_t from = y->part.v[k], end = part_end(y, k);
        for (int32_t i = from; i < end; i++) {
            tz_vec2 p = tz_matte_point(y, y->outline.v[i]),
                    q = tz_matte_point(y, y->outline.v[i + 1 < end ? i + 1 : from]);
            p.x -= b.x + 0.5, p.y -= b.y + 0.5, q.x -= b.x + 0.5, q.y -= b.y + 0.5;
            const tz_vec2 d = tz_vec2_sub(q, p);
            const double l = tz_vec2_dot(d, d), r = m->reach;
            const int32_t x0 = (int32_t)fmax(ceil(fmin(p.x, q.x) - r), 0),
                          x1 = (int32_t)fmin(floor(fmax(p.x, q.x) + r), b.w - 1),
                          y0 = (int32_t)fmax(ceil(fmin(p.y, q.y) - r), 0),
                          y1 = (int32_t)fmin(floor(fmax(p.y, q.y) + r), b.h - 1);
            for (int32_t v = y0; v <= y1; v++)
                for (int32_t u = x0; u <= x1; u++) {
                    const tz_vec2 o = {u - p.x, v - p.y};
                    double t = l > 0 ? tz_vec2_dot(o, d) / l : 0;
                    t = t < 0 ? 0 : t > 1 ? 1 : t;
                    const double ex = o.x - t * d.x, ey = o.y - t * d.y;
                    float *at = &m->distance[(int64_t)v * b.w + u];
                    const float e = (float)(ex * ex + ey * ey);
                    *at = e < *at ? e : *at;
                }
        }
    }
    for (int64_t i = 0; i < n; i++)
        m->distance[i] =
            m->alpha[i] >= 0.5F ? sqrtf(m->distance[i]) : -sqrtf(m->distance[i]);
}

/* ---- borders ------------------------------------------------------------------------- */

/* Mean and spread of what lies on one side near a pixel. */
typedef struct side {
    float weight;
    tz_f4 mean, square;
} side;

static void add_sample(side *s, float w, tz_f4 v)
{
    s->weight += w;
    s->mean += w * v;
    s->square += w * (v * v);
}

static bool settle(side *s)
{
    if (!(s->weight > 0.05F))
        return false;
    s->mean = s->mean / s->weight;
    s->square = s->square / s->weight - s->mean * s->mean;
    return true;
}

typedef struct border {
    const tz_matte *m;
    const tz_f4 *photo; /* linear, box */
    float matte;
    float bump[SPAN * SPAN]; /* weights of the window */
} border;

/* A smooth bump: no exp, the same on every machine. */
static void find_bump(border *b)
{
    for (int32_t v = -WINDOW; v <= WINDOW; v++)
        for (int32_t u = -WINDOW; u <= WINDOW; u++) {
            const float t = 1 - (float)(u * u + v * v) / (2 * WINDOW * WINDOW);
            b->bump[(v + WINDOW) * SPAN + u + WINDOW] = t > 0 ? t * t : 0;
        }
}

/* What lies at least `deep` px inside and outside within the window. */
static bool find_sides(const border *b, int32_t x, int32_t y, float deep, side *in,
                       side *out)
{
    const tz_matte *m = b->m;
    *in = *out = (side){0};
    const int32_t x0 = x > WINDOW ? x - WINDOW : 0, y0 = y > WINDOW ? y - WINDOW : 0;
    const int32_t x1 = x + WINDOW < m->box.w ? x + WINDOW : m->box.w - 1,
                  y1 = y + WINDOW < m->box.h ? y + WINDOW : m->box.h - 1;
    for (int32_t v = y0; v <= y1; v++)
        for (int32_t u = x0; u <= x1; u++) {
            const int64_t at = (int64_t)v * m->box.w + u;
            const float d = m->distance[at];
            const float w = b->bump[(v - y + WINDOW) * SPAN + u - x + WINDOW];
            if (fabsf(d) >= deep && b->photo[at][3] > 0 && w > 0)
                add_sample(d > 0 ? in : out, w, b->photo[at]);
        }
    const bool inner = settle(in), outer = settle(out);
    return inner && outer;
}

static float unit(float v) { return v < 0 ? 0 : v > 1 ? 1 : v; }

/* Alpha and pure colour of a pixel near the outline. */
static void refine(const border *b, int32_t x, int32_t y, float *alpha, float colour[3])
{
    const int64_t at = (int64_t)y * b->m->box.w + x;
    const tz_f4 i = b->photo[at];
    const float area = *alpha;
    side in, out;
    /* deep, where blur does not reach; of thin things what there is of their middle */
    bool found = find_sides(b, x, y, b->matte + 1, &in, &out);
    for (int k = 0; k < 2 && !found; k++)
        found = find_sides(b, x, y, k ? 0.5F * b->matte : b->matte, &in, &out);
    if (!found)
        return;
    const tz_f4 f = in.mean, g = out.mean, line = f - g;
    const float l = dot3(line, line), deep = fabsf(b->m->distance[at]);
    float a = area, behind = 0;
    if (l > 1e-9F) {
        const tz_f4 spread = in.square + out.square;
        /* along the line, counting channels apart */
        const float s2 = fmaxf(dot3(spread, line * line) / l, 0) + 1e-6F;
        const float w = 1 / (1 + 9 * s2 / l);
        float on = dot3(i - g, line) / l;
        on = on < 0 ? 0 : on > 1 ? 1 : on;
        /* by and by as far as the band goes */
        a = area + unit(b->matte - deep) * w * (on - area);
        /* what alpha does not tell of it, but the line does, comes from behind too */
        behind = unit(2 * (b->matte - deep)) * w * fminf(on - a, 0);
    }
    a = a < 1.0F / 512 ? 0 : a > 1 - 1.0F / 512 ? 1 : a;
    const tz_f4 pure = f + a * (i - a * f - (1 - a) * g - behind * line);
    for (int k = 0; k < 3; k++)
        colour[k] = pure[k] < 0 ? 0 : pure[k];
    *alpha = a;
}

/* ---- all ----------------------------------------------------------------------------- */

static tz_status find_area(tz_ctx *ctx, const tz_element_symbol *y, tz_matte *m)
{
    const tz_rect b = m->box;
    tz_cover c;
    tz_status s = tz_cover_init(ctx, &c, b.w, b.h);
    if (s != TZ_OK)
        return s;
    cover_outline(y, b.x, b.y, &c);
    for (int32_t j = 0; j < b.h; j++) {
        int32_t from, to;
        float *row = m->alpha + (int64_t)j * b.w;
        if (tz_cover_take(&c, j, true, row, &from, &to))
            for (int32_t i = 0; i < b.w; i++) /* what it has not written */
                row[i] = i < from || i >= to ? 0 : row[i];
    }
    tz_cover_deinit(ctx, &c);
    return TZ_OK;
}

tz_status tz_matte_init(tz_ctx *ctx, const tz_element_symbol *y, int32_t number,
                        const tz_matte_photo *p, const tz_element_render_params *params,
                        double rim, tz_matte *m)
{
    const bool shadow = p->shadows && p->label;
    const float band = (float)params->shadow, matte = (float)params->matte,
                wide = p->label ? (float)rim : 0;
    tz_f4 *photo = NULL;
    *m = (tz_matte){.reach = fmaxf(fmaxf(matte + 4, wide + 2), shadow ? band + 7 : 0)};
    m->box = outline_box(
        y, fmaxf(fmaxf(matte + WINDOW + 1, wide + 4), shadow ? band + 8 : 0), p->photo);
    if (tz_rect_empty(m->box)) {
        m->box = (tz_rect){0, 0, 0, 0};
        return TZ_OK;
    }
    const size_t n = (size_t)m->box.w * (size_t)m->box.h;
    tz_status s = tz_alloc_zero(ctx, &m->alpha, n, sizeof *m->alpha);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &m->distance, n, sizeof *m->distance);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &m->colour, 3 * n, sizeof *m->colour);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &photo, n, sizeof *photo);
    if (s == TZ_OK)
        s = find_area(ctx, y, m);
    if (s != TZ_OK)
        goto done;
    find_distances(y, m);
    for (int32_t v = 0; v < m->box.h; v++)
        for (int32_t u = 0; u < m->box.w; u++) {
            const int64_t at = (int64_t)v * m->box.w + u;
            const int32_t px = m->box.x + u, py = m->box.y + v;
            photo[at] = tz_photo_linear(p->photo, px, py, false, p->tables);
            photo[at][3] = opacity(p->photo, px, py);
            for (int k = 0; k < 3; k++)
                m->colour[3 * at + k] = photo[at][k];
        }
    border b = {m, photo, matte, {0}};
    find_bump(&b);
    for (int32_t v = 0; v < m->box.h && matte > 0; v++)
        for (int32_t u = 0; u < m->box.w; u++) {
            const int64_t at = (int64_t)v * m->box.w + u;
            if (fabsf(m->distance[at]) <= matte && photo[at][3] > 0)
                refine(&b, u, v, &m->alpha[at], &m->colour[3 * at]);
        }
    if (shadow)
        s = tz_matte_shade(ctx, p, photo, band, m);
    if (s == TZ_OK && wide > 0)
        s = tz_matte_rim(ctx, p, number + 1, photo, wide, m);
    for (size_t i = 0; i < n; i++) {
        m->alpha[i] *= photo[i][3];
        if (m->rim)
            m->rim[i] *= photo[i][3];
    }
done:
    tz_free(ctx, photo);
    if (s != TZ_OK)
        tz_matte_deinit(ctx, m);
    return s;
}

void tz_matte_deinit(tz_ctx *ctx, tz_matte *m)
{
    tz_free(ctx, m->alpha);
    tz_free(ctx, m->distance);
    tz_free(ctx, m->shade);
    tz_free(ctx, m->rim);
    tz_free(ctx, m->colour);
    *m = (tz_matte){0};
}
