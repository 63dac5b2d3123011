/* SPDX-License-Identifier: Apache-2.0 */
/* Shadows that things stand in: how much darker the ground beside a thing is in the photo
 * than in the plate, where the thing is not. Both are smoothed before the ratio is taken
 * (the mean of clamped ratios would darken what is only noisy), wider farther away, where
 * shadows are soft. Plate and ground are never the same grain by grain: a difference d
 * counts as
 *   d^3 / (d^2 + s^2),   s = 1.5 times its usual size in the outer third of the band
 * (the median's), which is d where it is large against s and nearly nothing where not.
 * Beyond 2/5 of the band it fades out. */
#include "synthesis/element_render_internal.h"

#define LEAST 0.15F /* of the light that the deepest shadow leaves */

static float luminance(tz_f4 v, int32_t colours)
{
    return colours < 3 ? v[0] : 0.2126F * v[0] + 0.7152F * v[1] + 0.0722F * v[2];
}

enum { WIDEST = 6, SPAN = 2 * WIDEST + 1 };

/* What is seen of the ground. */
typedef struct ground {
    float bump[WIDEST + 1][SPAN * SPAN]; /* weights of means, by radius */
    float *photo, *plate;                /* luminance; plate < 0 = not seen */
} ground;

static bool ground_seen(const tz_matte *m, const tz_matte_photo *p, int32_t x, int32_t y)
{
    const int32_t u = m->box.x + x, v = m->box.y + y, w = p->photo->width;
    if (m->alpha[(int64_t)y * m->box.w + x] > 0.02F || u < 0 || v < 0 || u >= w ||
        v >= p->photo->height)
        return false;
    for (int32_t j = v - 1; j <= v + 1; j++) /* others have soft borders too */
        for (int32_t i = u - 1; i <= u + 1; i++)
            if (i >= 0 && j >= 0 && i < w && j < p->photo->height &&
                p->label[(int64_t)j * w + i] &&
                m->distance[(int64_t)y * m->box.w + x] < -2.5F)
                return false;
    return !p->label[(int64_t)v * w + u];
}

static void find_bumps(ground *g)
{
    for (int32_t r = 1; r <= WIDEST; r++)
        for (int32_t v = -r; v <= r; v++)
            for (int32_t u = -r; u <= r; u++) {
                const float t = 1 - (float)(u * u + v * v) / (float)(r * r + r + 1);
                g->bump[r][(v + WIDEST) * SPAN + u + WIDEST] = t > 0 ? t * t * t : 0;
            }
}

/* Share of light that the ground near (x, y) lacks, from means about `r` px wide; below 0
 * where it is lighter than the plate. */
static float lacking(const tz_matte *m, const ground *g, int32_t x, int32_t y, int32_t r)
{
    float photo = 0, plate = 0;
    const int32_t x0 = x > r ? x - r : 0, x1 = x + r < m->box.w ? x + r : m->box.w - 1,
                  y0 = y > r ? y - r : 0, y1 = y + r < m->box.h ? y + r : m->box.h - 1;
    for (int32_t v = y0; v <= y1; v++) {
        const float *w = g->bump[r] + (v - y + WIDEST) * SPAN + WIDEST;
        const int64_t row = (int64_t)v * m->box.w;
        for (int32_t u = x0; u <= x1; u++) {
            if (g->plate[row + u] < 0)
                continue;
            photo += w[u - x] * g->photo[row + u];
            plate += w[u - x] * g->plate[row + u];
        }
    }
    if (!(plate > 1e-6F))
        return 0;
    const float dark = 1 - (photo + 1e-4F) / (plate + 1e-4F);
    return dark < -1 ? -1 : dark > 1 - LEAST ? 1 - LEAST : dark;
}

/* How large differences are where hardly any shadow is. */
static float grain_of(const tz_matte *m, float band)
{
    enum { BINS = 200 };
    int64_t count[BINS + 1] = {0}, all = 0, sum = 0;
    for (int64_t i = 0; i < (int64_t)m->box.w * m->box.h; i++) {
        const float d = m->shade[i] < 0 ? -m->shade[i] : m->shade[i];
        if (m->distance[i] < -0.7F * band && d > 0) {
            count[(int)(d * BINS)]++;
            all++;
        }
    }
    int k = 0;
    while (k < BINS && 2 * (sum += count[k]) < all)
        k++;
    const float usual = ((float)k + 0.5F) / BINS;
    return all ? 1.5F * (usual < 0.02F ? 0.02F : usual) : 0.06F;
}

tz_status tz_matte_shade(tz_ctx *ctx, const tz_matte_photo *p, const tz_f4 *photo,
                         float band, tz_matte *m)
{
    const int64_t n = (int64_t)m->box.w * m->box.h;
    const int32_t colours = tz_photo_colours(p->photo);
    ground g = {0};
    tz_status s = tz_alloc_zero(ctx, &m->shade, (size_t)n, sizeof *m->shade);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &g.photo, 2 * (size_t)n, sizeof *g.photo);
    if (s != TZ_OK)
        return s;
    g.plate = g.photo + n;
    find_bumps(&g);
    for (int32_t y = 0; y < m->box.h; y++)
        for (int32_t x = 0; x < m->box.w; x++) {
            const int64_t at = (int64_t)y * m->box.w + x;
            g.plate[at] = -1;
            if (m->distance[at] < -(band + 6) || !ground_seen(m, p, x, y))
                continue;
            g.photo[at] = luminance(photo[at], colours);
            g.plate[at] = luminance(
                tz_photo_linear(p->plate, m->box.x + x, m->box.y + y, false, p->tables),
                colours);
        }
    for (int32_t y = 0; y < m->box.h; y++)
        for (int32_t x = 0; x < m->box.w; x++) {
            const int64_t at = (int64_t)y * m->box.w + x;
            const float d = -m->distance[at];
            if (d < band && m->alpha[at] < 1)
                m->shade[at] = lacking(m, &g, x, y,
                                       d < 3        ? 3
                                       : d < WIDEST ? (int32_t)d
                                                    : WIDEST);
        }
    const float grain = grain_of(m, band);
    for (int64_t i = 0; i < n; i++) {
        const float d = m->shade[i], t = -m->distance[i] / band;
        const float u = t < 0.4F ? 0 : (t - 0.4F) / 0.6F;
        const float fade = (1 - u) * (1 - u) * (1 + 2 * u);
        m->shade[i] = d > 0 ? fade * d * d * d / (d * d + grain * grain) : 0;
    }
    tz_free(ctx, g.photo);
    return TZ_OK;
}
