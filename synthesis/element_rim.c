/* SPDX-License-Identifier: Apache-2.0 */
/* Rims: what a photo shows just outside a thing (the gap or the mortar about a stone), which
 * the cut-out carries along, so that things laid over each other do not melt together.
 *
 * A rim is as wide as half of the usual gap between the photo's things: rays run outward
 * from all outlines, as far as the next thing; that as far as two fifths of them go counts
 * (many pass by what is nearest). Thin things have thinner rims. Their weight falls
 * smoothly to 0 with the distance d from the outline,
 *   w = 1 - t^2 (3 - 2 t),   t = (d - r / 3) / (r - r / 3) in 0..1,
 * and only ground counts, and of it what looks like what lies between things: not lighter
 * and of no other hue than most of it (not to be found does not make a thing ground). Where
 * another thing touches, no more is taken than the dark line between both: what lies within
 * 2 px and is darker by a quarter and more than either thing is 3 px farther in.
 */
#include "synthesis/element_render_internal.h"

#define RIM_LEAST 1.5
#define RIM_MOST  8.0
#define RIM_THING 6    /* the thing's size over its widest rim */
#define RIM_LINE  2.0F /* px about the outline in which lines between things lie */
#define CLEAR     1.5  /* px from the outline at which the ground is ground alone */

/* ---- how wide ------------------------------------------------------------------------ */

enum {
    BINS = 2 * 17, /* half px; the last: no thing so near */
    TONES = 256,
    FEW = 50 /* looks that tell nothing yet */
};

/* What rays have met. */
typedef struct rays {
    int64_t gap[BINS];
    int64_t seen[3][TONES]; /* looks of what lies between two things */
} rays;

static int32_t label_at(const tz_matte_photo *p, double x, double y)
{
    if (!(x >= 0 && y >= 0 && x < p->photo->width && y < p->photo->height))
        return 0;
    const int32_t l = p->label[(int64_t)y * p->photo->width + (int64_t)x];
    return l > 0 ? l : 0;
}

/* Free way outward from an edge's middle, in half px; < 0 where it leaves the photo. */
static int32_t free_way(const tz_matte_photo *p, int32_t own, tz_vec2 at, tz_vec2 out)
{
    for (int32_t k = 1; k < BINS; k++) {
        const double x = at.x + 0.5 * k * out.x, y = at.y + 0.5 * k * out.y;
        if (!(x >= 0 && y >= 0 && x < p->photo->width && y < p->photo->height))
            return -1;
        const int32_t l = label_at(p, x, y);
        if (l > 0 && l != own)
            return k;
    }
    return BINS - 1;
}

/* How a colour looks: lightness, share of red, share of blue, 0 .. 1. */
static void look_of(tz_f4 f, float v[3])
{
    const float sum = f[0] + f[1] + f[2] + 1e-3F,
                l = sqrtf(0.3F * f[0] + 0.6F * f[1] + 0.1F * f[2]);
    v[0] = l < 1 ? l : 1;
    v[1] = f[0] / sum;
    v[2] = f[2] / sum;
}

static void note_look(const tz_matte_photo *p, double x, double y, rays *r)
{
    float v[3];
    look_of(tz_photo_linear(p->photo, (int32_t)x, (int32_t)y, false, p->tables), v);
    for (int k = 0; k < 3; k++)
        r->seen[k][(int)(v[k] * (TONES - 1))]++;
}

static void send_rays(const tz_element_symbol *y, int32_t own, const tz_matte_photo *p,
                      rays *r)
{
    for (int32_t k = 0; k < y->part.n; k++) {
        const int32_t from = y->part.v[k],
                      end = k + 1 < y->part.n ? y->part.v[k + 1] : y->outline.n;
        double way = 0; /* one ray a px or so */
        for (int32_t i = from; i < end; i++) {
            const tz_vec2 a = tz_matte_point(y, y->outline.v[i]),
                          b = tz_matte_point(y, y->outline.v[i + 1 < end ? i + 1 : from]);
            const tz_vec2 d = tz_vec2_sub(b, a);
            const double l = tz_vec2_length(d);
            way += l;
            if (!(way >= 1))
                continue;
            way = 0;
            tz_vec2 n = {d.y / l, -d.x / l};
            const tz_vec2 at = {0.5 * (a.x + b.x), 0.5 * (a.y + b.y)};
            const bool in = label_at(p, at.x + 1.2 * n.x, at.y + 1.2 * n.y) == own,
                       out = label_at(p, at.x - 1.2 * n.x, at.y - 1.2 * n.y) == own;
            if (in == out)
                continue;
            if (in)
                n = tz_vec2_scale(n, -1);
            const int32_t free = free_way(p, own, at, n);
            if (free >= 0)
                r->gap[free]++;
            if (free >= 2 && free < BINS - 1)
                note_look(p, at.x + 0.25 * free * n.x, at.y + 0.25 * free * n.y, r);
        }
    }
}

/* Least bin up to which a share of all counts lies. */
static int32_t quantile(const int64_t *count, int32_t bins, double share)
{
    int64_t all = 0, sum = 0;
    int32_t k = 0;
    for (int32_t i = 0; i < bins; i++)
        all += count[i];
    while (k < bins - 1 && (double)(sum += count[k]) < share * (double)all)
        k++;
    return k;
}

tz_status tz_rim_look(tz_ctx *ctx, const tz_element_set *set, int32_t photo,
                      tz_matte_photo *p)
{
    rays *r = NULL;
    const tz_status s = tz_alloc_zero(ctx, &r, 1, sizeof *r);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < set->symbol.n; i++)
        if (tz_symbol_cut(&set->symbol.v[i]) && set->symbol.v[i].photo == photo)
            send_rays(&set->symbol.v[i], i + 1, p, r);
    int64_t seen = 0;
    for (int32_t k = 0; k < TONES; k++)
        seen += r->seen[0][k];
    for (int k = 0; k < 3; k++) {
        /* lightness has no lower end: gaps may be as dark as they like */
        p->gap_lo[k] = seen < FEW || k == 0
                           ? -INFINITY
                           : (float)quantile(r->seen[k], TONES, 0.1) / TONES;
        p->gap_hi[k] =
            seen < FEW ? INFINITY
                       : (float)(quantile(r->seen[k], TONES, k ? 0.9 : 0.8) + 1) / TONES;
    }
    p->sized = p->rim < 0;
    if (p->sized)
        p->rim = fmin(fmax(0.25 * quantile(r->gap, BINS, 0.4), RIM_LEAST), RIM_MOST);
    tz_free(ctx, r);
    return TZ_OK;
}

double tz_rim_width(const tz_element_symbol *y, const tz_matte_photo *p)
{
    double area = 0;
    for (int32_t k = 0; k < y->part.n; k++) {
        const int32_t from = y->part.v[k],
                      end = k + 1 < y->part.n ? y->part.v[k + 1] : y->outline.n;
        for (int32_t i = from; i < end; i++) {
            const tz_vec2 a = y->outline.v[i],
                          b = y->outline.v[i + 1 < end ? i + 1 : from];
            area += 0.5 * (a.x * b.y - a.y * b.x);
        }
    }
    const double most = sqrt(fabs(area)) * y->photo_scale / RIM_THING;
    return p->sized ? fmin(p->rim, fmax(most, RIM_LEAST)) : p->rim;
}

/* ---- weights ------------------------------------------------------------------------- */

/* 1 up to a third of the width, 0 from its end on. */
static float fall(float d, float width)
{
    const float t = (d - width / 3) / (width - width / 3);
    return t <= 0 ? 1 : t >= 1 ? 0 : 1 - t * t * (3 - 2 * t);
}

/* How far a colour is one of what lies between things. */
static float likeness(const tz_matte_photo *p, tz_f4 f)
{
    static const float slack[3] = {0.06F, 0.012F, 0.012F};
    float v[3], w = 1;
    look_of(f, v);
    for (int k = 0; k < 3; k++) {
        const float off = fmaxf(v[k] - p->gap_hi[k], p->gap_lo[k] - v[k]);
        if (!(off > 0))
            continue;
        const float range = p->gap_hi[k] - p->gap_lo[k];
        const float t = off / (slack[k] + (k > 0 ? 0.5F * range : 0));
        w *= t >= 1 ? 0 : 1 - t * t * (3 - 2 * t);
    }
    return w;
}

/* 0 .. 1: how clear of other things pixel (x, y) of the photo lies: 1 from 2.5 px on. */
static float clearance(const tz_matte_photo *p, int32_t own, int32_t x, int32_t y)
{
    int32_t least = 7; /* square of the distance to the nearest pixel of one */
    for (int32_t v = y - 2; v <= y + 2; v++)
        for (int32_t u = x - 2; u <= x + 2; u++) {
            if (u < 0 || v < 0 || u >= p->photo->width || v >= p->photo->height)
                continue;
            const int32_t l = p->label[(int64_t)v * p->photo->width + u];
            const int32_t r2 = (u - x) * (u - x) + (v - y) * (v - y);
            if (l > 0 && l != own && r2 < least)
                least = r2;
        }
    if (least >= 7)
        return 1;
    const float t = (sqrtf((float)least) - 1) / 1.5F;
    return t <= 0 ? 0 : t >= 1 ? 1 : t * t * (3 - 2 * t);
}

/* Mean luminance of 3 x 3 px about a place of the box; < 0 outside the photo. */
static float light_at(const tz_matte *m, const tz_f4 *photo, double x, double y)
{
    const int32_t i = (int32_t)floor(x + 0.5), j = (int32_t)floor(y + 0.5);
    float sum = 0, n = 0;
    for (int32_t v = j - 1; v <= j + 1; v++)
        for (int32_t u = i - 1; u <= i + 1; u++) {
            if (u < 0 || v < 0 || u >= m->box.w || v >= m->box.h)
                continue;
            const tz_f4 f = photo[(int64_t)v * m->box.w + u];
            if (f[3] > 0)
                sum += 0.3F * f[0] + 0.6F * f[1] + 0.1F * f[2], n++;
        }
    return n > 0 ? sum / n : -1;
}

/* Which way distances grow at a pixel of the box: into the thing; length 1 or 0. */
static tz_vec2 inward(const tz_matte *m, int32_t x, int32_t y)
{
    const float *d = m->distance;
    const int32_t w = m->box.w, x0 = x > 0 ? x - 1 : x, x1 = x + 1 < w ? x + 1 : x,
                  y0 = y > 0 ? y - 1 : y, y1 = y + 1 < m->box.h ? y + 1 : y;
    const double gx = d[(int64_t)y * w + x1] - d[(int64_t)y * w + x0],
                 gy = d[(int64_t)y1 * w + x] - d[(int64_t)y0 * w + x];
    const double l = sqrt(gx * gx + gy * gy);
    return l > 1e-6 ? (tz_vec2){gx / l, gy / l} : (tz_vec2){0, 0};
}

/* How much of a dark line between this thing and another pixel (x, y) of the box is. */
static float line_at(const tz_matte *m, const tz_f4 *photo, int32_t x, int32_t y)
{
    const int64_t at = (int64_t)y * m->box.w + x;
    const tz_vec2 g = inward(m, x, y);
    const double in = 3 - (double)m->distance[at];
    const float a = light_at(m, photo, x + in * g.x, y + in * g.y),
                b = light_at(m, photo, x - 3 * g.x, y - 3 * g.y);
    const tz_f4 f = photo[at];
    const float least = fminf(a, b), own = 0.3F * f[0] + 0.6F * f[1] + 0.1F * f[2];
    if (!(least > 1e-5F))
        return 0;
    const float t = (0.75F * least - own) / (0.4F * least);
    return t < 0 ? 0 : t > 1 ? 1 : t;
}

/* How far the ground at a pixel of the box is gap: near the thing, whose colour mixes in,
 * the ground a little farther out counts. */
static float gap_at(const tz_matte_photo *p, const tz_matte *m, const tz_f4 *photo,
                    int32_t x, int32_t y)
{
    const double more = CLEAR + (double)m->distance[(int64_t)y * m->box.w + x];
    if (more > 0) {
        const tz_vec2 g = inward(m, x, y);
        const int32_t u = (int32_t)rint(x - more * g.x),
                      v = (int32_t)rint(y - more * g.y);
        if (u >= 0 && v >= 0 && u < m->box.w && v < m->box.h)
            x = u, y = v;
    }
    return likeness(p, photo[(int64_t)y * m->box.w + x]);
}

tz_status tz_matte_rim(tz_ctx *ctx, const tz_matte_photo *p, int32_t own,
                       const tz_f4 *photo, float width, tz_matte *m)
{
    const tz_rect b = m->box;
    tz_status s = tz_alloc_zero(ctx, &m->rim, (size_t)b.w * (size_t)b.h, sizeof *m->rim);
    for (int32_t y = 0; s == TZ_OK && y < b.h; y++)
        for (int32_t x = 0; x < b.w; x++) {
            const int64_t at = (int64_t)y * b.w + x;
            const float d = -m->distance[at];
            if (d >= fmaxf(width, RIM_LINE) || m->alpha[at] >= 1 || photo[at][3] <= 0)
                continue;
            const float clear = clearance(p, own, b.x + x, b.y + y);
            float w = clear * fall(d, width);
            if (w > 0)
                w *= gap_at(p, m, photo, x, y);
            if (clear < 1 && d < RIM_LINE)
                w += (1 - clear) * fall(d, RIM_LINE) * line_at(m, photo, x, y);
            m->rim[at] = w;
        }
    return s;
}
