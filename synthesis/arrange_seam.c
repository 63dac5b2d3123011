/* SPDX-License-Identifier: Apache-2.0 */
/* Seams: the closed border of a star that crosses what is already there where both agree.
 *
 * Rays x rings are unrolled to a band; a path of one ring a ray, at most two rings apart
 * from ray to ray, is found by dynamic programming over two turns, of which the second is
 * kept, so that it closes. Rings in the void cost nothing but leave void behind them.
 * @source [Kim21] Sec. 7 names graph cuts as future work; Davis: Mosaics of scenes with
 *   moving objects, CVPR 1998 (minimum-cost borders) */
#include <string.h>

#include "synthesis/arrange_internal.h"

enum {
    LEAST = 10,      /* innermost ring at LEAST / 24 of the limit */
    VOID_COST = 90,  /* a ring of void left beyond the seam */
    CORE_COST = 6,   /* a ring of the group's own region cut away */
    BEND_COST = 10,  /* a ring of difference from ray to ray */
    BEND = 2
};

static float ring_radius(const tz_star *star, int ray, int ring)
{
    const float f = (float)LEAST / 24;
    return star->limit[ray] * (f + (1 - f) * (float)ring / (TZ_RINGS - 1));
}

double tz_seam_find(const tz_canvas *canvas, const tz_feature_map *f, const tz_star *star,
                    tz_affine map, float radius[TZ_RAYS])
{
    int32_t cost[TZ_RAYS][TZ_RINGS], miss[TZ_RAYS][TZ_RINGS];
    bool any = false;
    for (int ray = 0; ray < TZ_RAYS; ray++) {
        const double a = 2 * TZ_PI * ray / TZ_RAYS;
        const double cx = cos(a), cy = sin(a);
        int32_t bare = 0;
        for (int ring = TZ_RINGS - 1; ring >= 0; ring--) {
            const double r = ring_radius(star, ray, ring);
            const tz_vec2 p = {star->centre.x + r * cx, star->centre.y + r * cy};
            const tz_vec2 q = tz_affine_apply(map, p);
            const int64_t at = tz_canvas_at(canvas, (int32_t)floor(q.x / TZ_CELL),
                                            (int32_t)floor(q.y / TZ_CELL));
            int32_t m = -1;
            if (at >= 0 && canvas->label[at] >= 0) {
                const tz_feature *old = &canvas->feature[at], *new = tz_feature_at(f, p.x, p.y);
                m = tz_feature_distance(old, new);
                /* steps hide in busy places */
                const int32_t busy = old->v[TZ_FEATURE_BUSY] < new->v[TZ_FEATURE_BUSY]
                                         ? old->v[TZ_FEATURE_BUSY]
                                         : new->v[TZ_FEATURE_BUSY];
                m = m * 256 / (192 + busy / 2);
                any = true;
            }
            miss[ray][ring] = m;
            int32_t c = m < 0 ? 0 : m;
            c += VOID_COST * bare;
            if (r < star->radius[ray])
                c += CORE_COST * (int32_t)((star->radius[ray] - r) * TZ_RINGS / star->limit[ray]);
            cost[ray][ring] = c;
            if (m < 0 && at >= 0)
                bare++;
        }
    }
    if (!any) {
        for (int ray = 0; ray < TZ_RAYS; ray++)
            radius[ray] = star->limit[ray];
        return 0;
    }
    int32_t sum[2][TZ_RINGS];
    int8_t from[2 * TZ_RAYS][TZ_RINGS];
    memcpy(sum[0], cost[0], sizeof sum[0]);
    memset(from[0], 0, sizeof from[0]);
    for (int col = 1; col < 2 * TZ_RAYS; col++) {
        const int32_t *in = sum[(col - 1) & 1];
        int32_t *out = sum[col & 1];
        for (int k = 0; k < TZ_RINGS; k++) {
            int32_t best = in[k];
            int8_t step = 0;
            for (int8_t d = -BEND; d <= BEND; d++) {
                if (k + d < 0 || k + d >= TZ_RINGS)
                    continue;
                const int32_t c = in[k + d] + BEND_COST * (d < 0 ? -d : d);
                if (c < best)
                    best = c, step = d;
            }
            out[k] = best + cost[col % TZ_RAYS][k];
            from[col][k] = step;
        }
    }
    const int32_t *last = sum[(2 * TZ_RAYS - 1) & 1];
    int ring = 0;
    for (int k = 1; k < TZ_RINGS; k++)
        if (last[k] < last[ring])
            ring = k;
    int64_t total = 0;
    int32_t met = 0;
    for (int col = 2 * TZ_RAYS - 1; col >= TZ_RAYS; col--) {
        const int ray = col % TZ_RAYS;
        radius[ray] = ring_radius(star, ray, ring);
        if (miss[ray][ring] >= 0)
            total += miss[ray][ring], met++;
        ring += from[col][ring];
    }
    return met ? (double)total / met : 0;
}

/* Scan-converts the border onto cell centres. */
int32_t tz_canvas_draw(tz_canvas *canvas, const tz_feature_map *f, const tz_star *star,
                       const tz_grown *g, int32_t key)
{
    double x[TZ_RAYS], y[TZ_RAYS], y0 = INFINITY, y1 = -INFINITY;
    int32_t fresh = 0;
    for (int ray = 0; ray < TZ_RAYS; ray++) {
        const double a = 2 * TZ_PI * ray / TZ_RAYS;
        const tz_vec2 q = tz_affine_apply(
            g->map, (tz_vec2){star->centre.x + g->radius[ray] * cos(a),
                              star->centre.y + g->radius[ray] * sin(a)});
        x[ray] = q.x / TZ_CELL, y[ray] = q.y / TZ_CELL;
        y0 = fmin(y0, y[ray]), y1 = fmax(y1, y[ray]);
    }
    for (int32_t j = (int32_t)floor(y0); j <= (int32_t)y1; j++) {
        double cross[TZ_RAYS];
        int n = 0;
        const double cy = j + 0.5;
        for (int k = 0; k < TZ_RAYS; k++) {
            const int k2 = (k + 1) % TZ_RAYS;
            if ((y[k] <= cy) == (y[k2] <= cy))
                continue;
            const double c = x[k] + (cy - y[k]) * (x[k2] - x[k]) / (y[k2] - y[k]);
            int at = n++;
            while (at > 0 && cross[at - 1] > c)
                cross[at] = cross[at - 1], at--;
            cross[at] = c;
        }
        for (int k = 0; k + 1 < n; k += 2)
            for (int32_t i = (int32_t)ceil(cross[k] - 0.5); i + 0.5 < cross[k + 1]; i++) {
                const int64_t at = tz_canvas_at(canvas, i, j);
                if (at < 0)
                    continue;
                const tz_vec2 p = tz_affine_apply(
                    g->inv, (tz_vec2){(i + 0.5) * TZ_CELL, (j + 0.5) * TZ_CELL});
                fresh += canvas->label[at] < 0;
                canvas->label[at] = key;
                canvas->feature[at] = *tz_feature_at(f, p.x, p.y);
            }
    }
    return fresh;
}
