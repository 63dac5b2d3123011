/* SPDX-License-Identifier: Apache-2.0 */
/* One power cell, as a polygon in coordinates from its site p.
 *
 * By clipping: it starts as the domain's rectangle (on a torus as the rectangle about its
 * site) and is cut by
 *
 *   2 x . d <= |d|^2 + w - v        d = q - p of a site q of weight v
 *
 * first by the neighbours it had, then by all sites that can still cut it: with R the
 * distance of its farthest corner, q must be nearer than R + sqrt(R^2 - w + v). What is
 * found is exact; the neighbours of before only make R small at once.
 *
 * From its ring: corners are where the lines of neighbours that follow each other meet.
 * If each edge runs the right way and they go about once, this is the cell that these
 * neighbours alone would leave; power.c says when it is the true one. */
#include "fields/power_internal.h"

enum { FIRST = 96 };

tz_power_polygon tz_power_polygon_of(const tz_power *p, int32_t i, tz_power_scratch *k)
{
    const tz_vec3 q = tz_domain_wrap(&p->domain, p->at[i]);
    k->a.n = 0;
    return (tz_power_polygon){
        .p = p, .k = k, .at = {q.x, q.y}, .w = p->weight[i], .site = i};
}

/* ---- clipping ----------------------------------------------------------------------- */

static void measure_reach(tz_power_polygon *c)
{
    double far = 0;
    for (int32_t i = 0; i < c->k->a.n; i++) {
        const tz_power_corner *v = &c->k->a.v[i];
        const double d = v->x * v->x + v->y * v->y;
        far = d > far ? d : far;
    }
    c->far2 = far;
    c->reach = sqrt(far);
}

/* Cuts by the site q at d; sites at one place: the heavier, then the first, has it all. */
static tz_status cut(tz_power_polygon *c, double dx, double dy, double w, int32_t q)
{
    tz_power_scratch *k = c->k;
    const double d2 = dx * dx + dy * dy, limit = d2 + c->w - w;
    if (d2 == 0) {
        if (w > c->w || (w == c->w && q < c->site))
            k->a.n = 0, c->gone = true;
        return TZ_OK;
    }
    if (limit > 0 && limit * limit >= 4 * c->far2 * d2)
        return TZ_OK;
    const int32_t n = k->a.n;
    const double slack = 1e-12 * (d2 + c->far2);
    const tz_power_corner *a = k->a.v;
    int32_t first = -1;
    for (int32_t i = 0; i < n; i++)
        if (2 * (a[i].x * dx + a[i].y * dy) > limit + slack) {
            first = i;
            break;
        }
    if (first < 0)
        return TZ_OK;
    tz_status s = tz_array_reserve(c->p->ctx, &k->b, (int64_t)n + 2);
    if (s != TZ_OK)
        return s;
    tz_power_corner *b = k->b.v;
    int32_t m = 0;
    double h = 2 * (a[0].x * dx + a[0].y * dy) - limit;
    const double h0 = h;
    for (int32_t i = 0; i < n; i++) {
        const int32_t j = i + 1 < n ? i + 1 : 0;
        const double g = j ? 2 * (a[j].x * dx + a[j].y * dy) - limit : h0;
        if (h <= 0)
            b[m++] = a[i];
        if ((h <= 0) != (g <= 0)) {
            const double t = h / (h - g);
            b[m++] =
                (tz_power_corner){a[i].x + t * (a[j].x - a[i].x),
                                  a[i].y + t * (a[j].y - a[i].y), h <= 0 ? q : a[i].site};
        }
        h = g;
    }
    k->b.n = m;
    const tz_power_scratch swap = *k;
    memcpy(&k->a, &swap.b, sizeof k->a);
    memcpy(&k->b, &swap.a, sizeof k->b);
    if (m < 3)
        k->a.n = 0, c->gone = true;
    measure_reach(c);
    return TZ_OK;
}

static tz_status begin(tz_power_polygon *c)
{
    const tz_vec3 s = c->p->domain.size;
    const bool torus = c->p->domain.torus;
    const tz_status st = tz_array_reserve(c->p->ctx, &c->k->a, FIRST);
    if (st != TZ_OK)
        return st;
    const double x0 = torus ? -s.x / 2 : -c->at.x, x1 = x0 + s.x;
    const double y0 = torus ? -s.y / 2 : -c->at.y, y1 = y0 + s.y;
    const int32_t own = c->site;
    tz_power_corner *v = c->k->a.v;
    v[0] = (tz_power_corner){x0, y0, torus ? own : -1};
    v[1] = (tz_power_corner){x1, y0, torus ? own : -2};
    v[2] = (tz_power_corner){x1, y1, torus ? own : -3};
    v[3] = (tz_power_corner){x0, y1, torus ? own : -4};
    c->k->a.n = 4;
    c->gone = false;
    measure_reach(c);
    return TZ_OK;
}

/* Which index lies at i of a ring, and how far it is shifted. */
static int32_t around(int32_t i, int32_t n, double size, double *shift)
{
    const int32_t turns = i >= 0 ? i / n : -((n - 1 - i) / n);
    *shift = turns * size;
    return i - turns * n;
}

/* All sites of a row of cells. */
static tz_status cut_row(tz_power_polygon *c, const tz_power_level *v, int32_t x0,
                         int32_t x1, int32_t j)
{
    const tz_power *p = c->p;
    const tz_domain *d = &p->domain;
    tz_status s = TZ_OK;
    double sy = 0;
    if (d->torus)
        j = around(j, v->ny, d->size.y, &sy);
    for (int32_t i = x0; i <= x1 && s == TZ_OK && !c->gone; i++) {
        double sx = 0;
        const int32_t x = d->torus ? around(i, v->nx, d->size.x, &sx) : i;
        for (int32_t q = v->head[j * v->nx + x]; q >= 0 && s == TZ_OK; q = p->next[q]) {
            if (q == c->site)
                continue;
            const tz_vec3 at = tz_domain_wrap(d, p->at[q]);
            const double dx = at.x + sx - c->at.x, dy = at.y + sy - c->at.y;
            const double w = p->weight[q];
            const double d2 = dx * dx + dy * dy, limit = d2 + c->w - w;
            if (limit <= 0 || limit * limit < 4 * c->far2 * d2)
                s = cut(c, dx, dy, w, q);
        }
    }
    return s;
}

/* How far from the site one of weight `most` can still cut. Of a site's copies on a torus
 * only those within a period and a half of the cell's rectangle do. */
static double search_reach(const tz_power_polygon *c, double most)
{
    const tz_vec3 size = c->p->domain.size;
    const double r = c->reach + sqrt(fmax(0, c->far2 - c->w + most));
    return c->p->domain.torus ? fmin(r, 2 * fmax(size.x, size.y)) : r;
}

/* Rows from the site outwards, until they are beyond reach, which shrinks meanwhile. */
static tz_status cut_level(tz_power_polygon *c, const tz_power_level *v)
{
    const bool torus = c->p->domain.torus;
    const double y = c->at.y / v->cell_y;
    const int32_t j0 = torus ? (int32_t)floor(y) : tz_power_clamp(y, v->ny);
    tz_status s = TZ_OK;
    for (int32_t step = 0; s == TZ_OK && !c->gone; step++) {
        bool any = false;
        for (int side = step == 0; side < 2 && s == TZ_OK && !c->gone; side++) {
            const int32_t j = side ? j0 + step : j0 - step;
            const double r = search_reach(c, v->most) * (1 + 1e-9);
            const double off = step == 0 ? 0
                               : side    ? j * v->cell_y - c->at.y
                                         : c->at.y - (j + 1) * v->cell_y;
            if (off > r || (!torus && (j < 0 || j >= v->ny)))
                continue;
            any = true;
            const double lo = (c->at.x - r) / v->cell_x, hi = (c->at.x + r) / v->cell_x;
            const int32_t x0 = torus ? (int32_t)floor(lo) : tz_power_clamp(lo, v->nx);
            const int32_t x1 = torus ? (int32_t)floor(hi) : tz_power_clamp(hi, v->nx);
            s = cut_row(c, v, x0, x1, j);
        }
        if (!any)
            break;
    }
    return s;
}

static tz_status cut_known(tz_power_polygon *c)
{
    const tz_power *p = c->p;
    const int32_t *near = p->neighbour.v.v + p->start[c->site];
    tz_status s = TZ_OK;
    for (int32_t k = 0; k < p->count[c->site] && s == TZ_OK; k++) {
        const int32_t q = near[k];
        if (q >= p->n || p->weight[q] < 0 || q == c->site)
            continue;
        const tz_vec3 v = tz_domain_vector(&p->domain, (tz_vec3){c->at.x, c->at.y, 0},
                                           (tz_vec3){p->at[q].x, p->at[q].y, 0});
        s = cut(c, v.x, v.y, p->weight[q], q);
    }
    return s;
}

/* Nearest cells first where nothing is known, else a first row would cut by far sites. */
static tz_status cut_near(tz_power_polygon *c)
{
    const tz_power *p = c->p;
    const bool torus = p->domain.torus;
    tz_status s = TZ_OK;
    for (int l = 0; l < TZ_POWER_LEVELS && s == TZ_OK && !c->gone; l++) {
        const tz_power_level *v = &p->lv[l];
        if (v->n == 0)
            continue;
        const int32_t i = tz_power_clamp(c->at.x / v->cell_x, v->nx),
                      j = tz_power_clamp(c->at.y / v->cell_y, v->ny);
        for (int32_t y = j - 1; y <= j + 1 && s == TZ_OK; y++)
            if (torus || (y >= 0 && y < v->ny))
                s = cut_row(c, v, torus || i > 0 ? i - 1 : 0,
                            torus || i + 1 < v->nx ? i + 1 : i, y);
    }
    return s;
}

tz_status tz_power_clip(tz_power_polygon *c)
{
    const tz_power *p = c->p;
    tz_status s = begin(c);
    if (s == TZ_OK)
        s = p->count[c->site] > 2 ? cut_known(c) : cut_near(c);
    for (int l = 0; l < TZ_POWER_LEVELS && s == TZ_OK && !c->gone; l++)
        if (p->lv[l].n > 0)
            s = cut_level(c, &p->lv[l]);
    return s;
}

/* ---- from its ring ------------------------------------------------------------------ */

/* Places x with 2 x . d <= limit. */
typedef struct half {
    double x, y, limit;
    int32_t site;
} half;

static bool half_of(const tz_power_polygon *c, int32_t q, half *h)
{
    const tz_power *p = c->p;
    if (q >= p->n || p->weight[q] < 0)
        return false;
    const tz_vec3 v = tz_domain_vector(&p->domain, (tz_vec3){c->at.x, c->at.y, 0},
                                       (tz_vec3){p->at[q].x, p->at[q].y, 0});
    *h = (half){v.x, v.y, v.x * v.x + v.y * v.y + c->w - p->weight[q], q};
    return true;
}

static half half_of_side(const tz_power_polygon *c, int side)
{
    const tz_vec3 size = c->p->domain.size;
    switch (side) {
    case 0: return (half){0, -1, 2 * c->at.y, -1};
    case 1: return (half){1, 0, 2 * (size.x - c->at.x), -2};
    case 2: return (half){0, 1, 2 * (size.y - c->at.y), -3};
    default: return (half){-1, 0, 2 * c->at.x, -4};
    }
}

/* Where the lines of two halves that follow each other meet. */
static bool corner_of(const half *a, const half *b, tz_power_corner *v)
{
    const double det = a->x * b->y - a->y * b->x;
    if (!(det > 0))
        return false;
    const double by = 0.5 / det;
    *v = (tz_power_corner){(a->limit * b->y - b->limit * a->y) * by,
                           (b->limit * a->x - a->limit * b->x) * by, b->site};
    return true;
}

static bool runs_on(const half *h, const tz_power_corner *a, const tz_power_corner *b)
{
    return (b->y - a->y) * h->x - (b->x - a->x) * h->y >
           1e-11 * (h->x * h->x + h->y * h->y);
}

/* Corner of a box that no corner may lie beyond. */
static void bounds(const tz_power_polygon *c, double lo[2], double hi[2])
{
    const tz_vec3 s = c->p->domain.size;
    const double e = 1e-9;
    if (c->p->domain.torus) {
        lo[0] = -0.5 * s.x, lo[1] = -0.5 * s.y, hi[0] = 0.5 * s.x, hi[1] = 0.5 * s.y;
    } else {
        lo[0] = -c->at.x - e * s.x, hi[0] = s.x * (1 + e) - c->at.x;
        lo[1] = -c->at.y - e * s.y, hi[1] = s.y * (1 + e) - c->at.y;
    }
}

tz_status tz_power_from_ring(tz_power_polygon *c, bool *valid)
{
    const tz_power *p = c->p;
    const int32_t n = p->count[c->site], kind = p->kind[c->site];
    const int32_t edges = n + (kind != TZ_POWER_INNER),
                  *ring = p->neighbour.v.v + p->start[c->site];
    half first, last, next;
    int32_t ups = 0;
    double lo[2], hi[2], far = 0;
    *valid = false;
    if (kind == TZ_POWER_ODD || edges < 3 || n < 2 || !half_of(c, ring[0], &first))
        return TZ_OK;
    const tz_status s = tz_array_reserve(p->ctx, &c->k->a, edges);
    if (s != TZ_OK)
        return s;
    bounds(c, lo, hi);
    tz_power_corner *a = c->k->a.v;
    last = first;
    for (int32_t j = 1; j <= edges; j++) {
        if (j == edges)
            next = first;
        else if (j == n)
            next = half_of_side(c, kind - TZ_POWER_SIDE);
        else if (!half_of(c, ring[j], &next))
            return TZ_OK;
        tz_power_corner *v = &a[j < edges ? j : 0];
        if (!corner_of(&last, &next, v) || (j > 1 && !runs_on(&last, &a[j - 1], v)) ||
            v->x < lo[0] || v->x > hi[0] || v->y < lo[1] || v->y > hi[1])
            return TZ_OK;
        const double d = v->x * v->x + v->y * v->y;
        far = d > far ? d : far;
        ups += last.y < 0 && next.y >= 0;
        last = next;
    }
    c->k->a.n = edges;
    c->far2 = far, c->reach = sqrt(far);
    *valid = ups == 1 && runs_on(&first, &a[0], &a[1]);
    return TZ_OK;
}
