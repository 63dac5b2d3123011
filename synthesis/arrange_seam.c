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
    LEAST = 10,     /* innermost ring at LEAST / 24 of the limit */
    VOID_COST = 90, /* a ring of void left beyond the seam */
    CORE_COST = 3,  /* a ring of the group's own region cut away */
    BEND_COST = 4,  /* a ring of difference from ray to ray */
    BEND = 2
};

static float ring_radius(const tz_star *star, int ray, float ring)
{
    const float f = (float)LEAST / 24;
    return star->limit[ray] * (f + (1 - f) * ring / (TZ_RINGS - 1));
}

/* Path of least cost round a band of `rays` columns and `rings` rows (cost[ray * rings +
 * ring]); path[ray] receives the ring. */
static void closed_path(const int32_t *cost, int rays, int rings, int32_t bend_cost,
                        uint8_t *path)
{
    enum { MOST = TZ_RINGS, PAD = BEND, WALL = 1 << 28 };
    int32_t sums[2][MOST + 2 * PAD];
    int32_t from[2 * TZ_BORDER][MOST];
    for (int side = 0; side < 2; side++)
        for (int k = 0; k < MOST + 2 * PAD; k++)
            sums[side][k] = WALL;
    for (int k = 0; k < rings; k++)
        sums[0][PAD + k] = cost[k], from[0][k] = 0;
    for (int col = 1; col < 2 * rays; col++) {
        const int32_t *in = sums[(col - 1) & 1] + PAD, *c = cost + (col % rays) * rings;
        int32_t *out = sums[col & 1] + PAD, *step = from[col];
        for (int k = 0; k < rings; k++) { /* no branch: vectorised */
            int32_t best = in[k], s = 0;
            for (int d = -BEND; d <= BEND; d++) {
                const int32_t t = in[k + d] + bend_cost * (d < 0 ? -d : d);
                s = t < best ? d : s;
                best = t < best ? t : best;
            }
            out[k] = best + c[k];
            step[k] = s;
        }
    }
    const int32_t *last = sums[(2 * rays - 1) & 1] + PAD;
    int ring = 0;
    for (int k = 1; k < rings; k++)
        if (last[k] < last[ring])
            ring = k;
    for (int col = 2 * rays - 1; col >= rays; col--) {
        path[col % rays] = (uint8_t)ring;
        ring += from[col][ring];
    }
}

/* Mismatch of two features along a seam; steps hide in busy places. */
static int32_t mismatch(tz_feature old, tz_feature new)
{
    const int32_t busy = old.v[TZ_FEATURE_BUSY] < new.v[TZ_FEATURE_BUSY]
                             ? old.v[TZ_FEATURE_BUSY]
                             : new.v[TZ_FEATURE_BUSY];
    return tz_feature_distance(old, new) * 256 / (192 + busy / 2);
}

double tz_seam_find(const tz_canvas *canvas, const tz_feature_map *f, const tz_star *star,
                    tz_affine map, int step, float radius[TZ_RAYS])
{
    const int rays = TZ_RAYS / step, rings = TZ_RINGS / step;
    int32_t cost[TZ_RAYS * TZ_RINGS], miss[TZ_RAYS * TZ_RINGS];
    const tz_turn turn = tz_turn_of(map);
    const tz_vec2 middle = tz_affine_apply(map, star->centre);
    bool any = false;
    for (int k = 0; k < rays; k++) {
        const int ray = k * step;
        const tz_vec2 dir = tz_ray(ray, TZ_RAYS);
        const tz_vec2 out = {map.a * dir.x + map.c * dir.y,
                             map.b * dir.x + map.d * dir.y};
        const float core = CORE_COST * (TZ_RINGS / star->limit[ray]);
        int32_t bare = 0;
        for (int n = rings - 1; n >= 0; n--) {
            const double r = ring_radius(star, ray, (float)(n * step));
            const int64_t at = tz_canvas_at(canvas, tz_cell(middle.x + r * out.x),
                                            tz_cell(middle.y + r * out.y));
            int32_t m = -1;
            if (at >= 0 && canvas->label[at] >= 0) {
                const tz_feature new = tz_feature_near(f, star->centre.x + r * dir.x,
                                                       star->centre.y + r * dir.y);
                m = mismatch(canvas->feature[at], tz_feature_turn(new, &turn));
                any = true;
            }
            miss[k * rings + n] = m;
            int32_t c = (m < 0 ? 0 : m) + VOID_COST * step * bare;
            if (r < star->radius[ray])
                c += (int32_t)((star->radius[ray] - (float)r) * core);
            cost[k * rings + n] = c;
            if (m < 0 && at >= 0)
                bare++;
        }
    }
    if (!any) {
        for (int ray = 0; ray < TZ_RAYS; ray++)
            radius[ray] = star->limit[ray];
        return 0;
    }
    uint8_t path[TZ_RAYS];
    closed_path(cost, rays, rings, BEND_COST * step, path);
    int64_t total = 0;
    int32_t met = 0;
    for (int k = 0; k < rays; k++) {
        const int32_t m = miss[k * rings + path[k]];
        if (m >= 0)
            total += m, met++;
        for (int i = 0; i < step; i++) {
            const float t = (float)i / (float)step;
            const float next = path[(k + 1) % rays],
                        ring = path[k] + t * (next - path[k]);
            radius[k * step + i] = ring_radius(star, k * step + i, ring * (float)step);
        }
    }
    return met ? (double)total / met : 0;
}

void tz_seam_refine(const void *user, tz_shown shown, const tz_feature_map *f,
                    const tz_star *star, tz_affine map, const float radius[TZ_RAYS],
                    float border[TZ_BORDER])
{
    enum { BAND = 13, PER = TZ_BORDER / TZ_RAYS };
    int32_t cost[TZ_BORDER * BAND];
    bool void_at[TZ_BORDER * BAND];
    float centre[TZ_BORDER];
    uint8_t path[TZ_BORDER];
    const tz_turn turn = tz_turn_of(map);
    for (int ray = 0; ray < TZ_BORDER; ray++) {
        const int i = ray / PER, j = (i + 1) % TZ_RAYS;
        const float t = (float)(ray % PER) / PER;
        const float limit = fminf(star->limit[i], star->limit[j]);
        centre[ray] = radius[i] + t * (radius[j] - radius[i]);
        centre[ray] = fminf(centre[ray], limit - BAND / 2);
        const tz_vec2 dir = tz_ray(ray, TZ_BORDER);
        int32_t bare = 0;
        for (int ring = BAND - 1; ring >= 0; ring--) {
            const double r = fmax(centre[ray] + ring - BAND / 2, 1);
            const tz_vec2 p = {star->centre.x + r * dir.x, star->centre.y + r * dir.y};
            const tz_vec2 q = tz_affine_apply(map, p);
            tz_feature old;
            const bool filled = shown(user, q.x, q.y, &old);
            cost[ray * BAND + ring] = VOID_COST / 4 * bare;
            void_at[ray * BAND + ring] = !filled;
            if (filled)
                cost[ray * BAND + ring] +=
                    mismatch(old, tz_feature_turn(tz_feature_at(f, p.x, p.y), &turn));
            bare += !filled;
        }
    }
    closed_path(cost, TZ_BORDER, BAND, BEND_COST, path);
    /* into the void a little more than cells tell, so that no specks stay between pieces */
    for (int ray = 0; ray < TZ_BORDER; ray++)
        border[ray] = fmaxf(centre[ray] + path[ray] - BAND / 2, 1) +
                      (void_at[ray * BAND + path[ray]] ? 1.5F : 0);
}

void tz_grown_border(const tz_star *star, const tz_grown *g, double *border)
{
    for (int ray = 0; ray < TZ_BORDER; ray++) {
        const tz_vec2 dir = tz_ray(ray, TZ_BORDER);
        const tz_vec2 q =
            tz_affine_apply(g->map, (tz_vec2){star->centre.x + g->border[ray] * dir.x,
                                              star->centre.y + g->border[ray] * dir.y});
        border[2 * ray] = q.x, border[2 * ray + 1] = q.y;
    }
}

/* Scan-converts the border onto cell centres. */
void tz_canvas_draw(tz_canvas *canvas, const tz_feature_map *f, tz_affine map,
                    tz_affine inv, const double *border, int32_t n, double *cross,
                    int32_t key)
{
    double y0 = INFINITY, y1 = -INFINITY;
    const tz_turn turn = tz_turn_of(map);
    for (int32_t k = 0; k < n; k++)
        y0 = fmin(y0, border[2 * k + 1]), y1 = fmax(y1, border[2 * k + 1]);
    /* on a plain canvas only the rows that exist; a torus takes one turn at most */
    int64_t j0 = (int64_t)floor(y0 / TZ_CELL), j1 = (int64_t)floor(y1 / TZ_CELL);
    if (!canvas->torus)
        j0 = j0 < 0 ? 0 : j0, j1 = j1 >= canvas->ny ? canvas->ny - 1 : j1;
    else if (j1 - j0 >= canvas->ny)
        j1 = j0 + canvas->ny - 1;
    for (int64_t j = j0; j <= j1; j++) {
        int32_t count = 0;
        const double cy = ((double)j + 0.5) * TZ_CELL;
        for (int32_t k = 0; k < n; k++) {
            const double *p = border + 2 * k, *q = border + 2 * ((k + 1) % n);
            if ((p[1] <= cy) == (q[1] <= cy))
                continue;
            const double c = p[0] + (cy - p[1]) * (q[0] - p[0]) / (q[1] - p[1]);
            int32_t at = count++;
            while (at > 0 && cross[at - 1] > c)
                cross[at] = cross[at - 1], at--;
            cross[at] = c;
        }
        for (int32_t k = 0; k + 1 < count; k += 2) {
            double x0 = ceil(cross[k] / TZ_CELL - 0.5),
                   x1 = ceil(cross[k + 1] / TZ_CELL - 0.5);
            if (!canvas->torus)
                x0 = fmax(x0, 0), x1 = fmin(x1, canvas->nx);
            else
                x1 = fmin(x1, x0 + canvas->nx);
            for (int64_t i = (int64_t)x0; i < (int64_t)x1; i++) {
                const int64_t at = tz_canvas_at(canvas, (int32_t)i, (int32_t)j);
                if (at < 0 || canvas->label[at] >= canvas->fixed)
                    continue;
                const tz_vec2 p =
                    tz_affine_apply(inv, (tz_vec2){((double)i + 0.5) * TZ_CELL,
                                                   ((double)j + 0.5) * TZ_CELL});
                canvas->label[at] = key;
                canvas->feature[at] = tz_feature_turn(tz_feature_at(f, p.x, p.y), &turn);
            }
        }
    }
}
