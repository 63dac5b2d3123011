/* SPDX-License-Identifier: Apache-2.0 */
/* Areas and centres of cells. With a region a cell that its border may run through is
 * split into triangles down to about a cell of the region's raster, and these are cut
 * where the signed distance, linear over each, is 0. */
#include "fields/power_internal.h"

typedef struct moment {
    double area, x, y;
} moment;

static void add_triangle(moment *m, tz_vec2 a, tz_vec2 b, tz_vec2 c)
{
    const double t = 0.5 * ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
    m->area += t;
    m->x += t * (a.x + b.x + c.x) / 3;
    m->y += t * (a.y + b.y + c.y) / 3;
}

static tz_vec2 mix(tz_vec2 a, tz_vec2 b, double t)
{
    return (tz_vec2){a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
}

/* The part of a triangle where the distances, linear over it, are above 0. */
static void add_inside(moment *m, const tz_vec2 v[3], const double d[3])
{
    tz_vec2 in[4];
    int n = 0;
    for (int k = 0; k < 3; k++) {
        const int j = (k + 1) % 3;
        if (d[k] > 0)
            in[n++] = v[k];
        if ((d[k] > 0) != (d[j] > 0))
            in[n++] = mix(v[k], v[j], d[k] / (d[k] - d[j]));
    }
    for (int k = 2; k < n; k++)
        add_triangle(m, in[0], in[k - 1], in[k]);
}

static double depth_at(const tz_power_polygon *c, tz_vec2 v)
{
    return tz_region_distance(
        c->p->domain.region,
        tz_domain_wrap(&c->p->domain, (tz_vec3){c->at.x + v.x, c->at.y + v.y, 0}));
}

static void add_split(const tz_power_polygon *c, moment *m, const tz_vec2 v[3],
                      const double d[3], int left)
{
    double longest = 0, least = d[0], most = d[0];
    for (int k = 0; k < 3; k++) {
        const int j = (k + 1) % 3;
        longest = fmax(longest, hypot(v[j].x - v[k].x, v[j].y - v[k].y));
        least = fmin(least, d[k]), most = fmax(most, d[k]);
    }
    if (least >= longest) { /* distances change by no more than the way */
        add_triangle(m, v[0], v[1], v[2]);
        return;
    }
    if (most <= -longest)
        return;
    const tz_raster *r = &c->p->domain.region->raster;
    if (left == 0 || longest <= 2 * r->size.x / r->width) {
        add_inside(m, v, d);
        return;
    }
    const tz_vec2 h[3] = {mix(v[0], v[1], 0.5), mix(v[1], v[2], 0.5),
                          mix(v[2], v[0], 0.5)};
    const double e[3] = {depth_at(c, h[0]), depth_at(c, h[1]), depth_at(c, h[2])};
    add_split(c, m, (tz_vec2[]){v[0], h[0], h[2]}, (double[]){d[0], e[0], e[2]},
              left - 1);
    add_split(c, m, (tz_vec2[]){h[0], v[1], h[1]}, (double[]){e[0], d[1], e[1]},
              left - 1);
    add_split(c, m, (tz_vec2[]){h[2], h[1], v[2]}, (double[]){e[2], e[1], d[2]},
              left - 1);
    add_split(c, m, (tz_vec2[]){h[0], h[1], h[2]}, (double[]){e[0], e[1], e[2]},
              left - 1);
}

/* Moments of the whole polygon, in triangles from the site. */
static moment moments_of(const tz_power_corner *v, int32_t n)
{
    moment m = {0, 0, 0};
    const tz_power_corner *a = &v[n - 1];
    for (int32_t k = 0; k < n; a = &v[k++]) {
        const double t = 0.5 * (a->x * v[k].y - a->y * v[k].x);
        m.area += t;
        m.x += t * (a->x + v[k].x);
        m.y += t * (a->y + v[k].y);
    }
    m.x /= 3, m.y /= 3;
    return m;
}

static moment moments(const tz_power_polygon *c)
{
    const tz_power_corner *v = c->k->a.v;
    const int32_t n = c->k->a.n;
    moment m = {0, 0, 0};
    if (!c->p->domain.region || depth_at(c, (tz_vec2){0, 0}) >= c->reach)
        return moments_of(v, n);
    for (int32_t k = 2; k < n; k++) {
        const tz_vec2 t[3] = {
            {v[0].x, v[0].y}, {v[k - 1].x, v[k - 1].y}, {v[k].x, v[k].y}};
        const double d[3] = {depth_at(c, t[0]), depth_at(c, t[1]), depth_at(c, t[2])};
        add_split(c, &m, t, d, 5);
    }
    return m;
}

/* Corners on the domain's border lie at the end of what is empty, not in its middle. */
static void measure_gap(const tz_power_polygon *c, double *gap, tz_vec2 *at)
{
    const tz_power_corner *v = c->k->a.v;
    const int32_t n = c->k->a.n;
    *gap = 0;
    *at = (tz_vec2){0, 0};
    for (int32_t k = 0; k < n; k++) {
        const double g = v[k].x * v[k].x + v[k].y * v[k].y - c->w;
        if (g > *gap && v[k].site >= 0 && v[k ? k - 1 : n - 1].site >= 0 &&
            (!c->p->domain.region || depth_at(c, (tz_vec2){v[k].x, v[k].y}) >= 0))
            *gap = g, *at = (tz_vec2){v[k].x, v[k].y};
    }
}

void tz_power_measure(tz_power *p, const tz_power_polygon *c)
{
    const int32_t i = c->site;
    moment m = {0, 0, 0};
    p->gap[i] = 0;
    p->gap_at[i] = (tz_vec2){0, 0};
    if (c->k->a.n >= 3) {
        m = moments(c);
        measure_gap(c, &p->gap[i], &p->gap_at[i]);
    }
    p->area[i] = m.area > 0 ? m.area : 0;
    p->centre[i] = m.area > 0 ? (tz_vec2){m.x / m.area, m.y / m.area} : (tz_vec2){0, 0};
}
