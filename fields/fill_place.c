/* SPDX-License-Identifier: Apache-2.0 */
/* Places: Eq. (1) to (4). The distribution step solves for the steps d of all nodes
 *
 *   sum a |d - g|^2 + 2 sum over conflicts |d' - d - h|^2 + 2 sum over borders |d - k|^2
 *
 * with g from a sample to the centre of its cell, h what two samples of different bodies
 * lack along the line between them, (w_v - 1) p', and k what a sample lacks to the border.
 *
 * Where it departs from [Hsu20]:
 *   - a, the area of the cell over the mean cell, is 1 there. With it the first sum is the
 *     slope of an energy, sum of the integrals of |x - p|^2 over the cells, that no common
 *     shift changes; without it bodies of unequal discs swim through the domain;
 *   - samples of a rigid body have one step together, so that pushes between bodies are
 *     equal and opposite however many discs they have, for the same reason;
 *   - toward the end the first sum weighs less and less (tz_fill.calm): evenness has been
 *     reached, and what is left is to keep things apart;
 *   - fixed samples are laid along the border there; here its nearest point is one, found
 *     anew each time, which is the same for samples laid infinitely dense.
 *
 * The graph step then minimises, body by body, sum |p - p*|^2 + w_g E_g from the places
 * p* just found. Its matrix depends on the graph alone: the inverse is kept by model. */
#include "fields/fill_internal.h"

#include <string.h>

enum { ROUNDS = 24 };
#define SMALL 2e-3 /* of the mean radius */
#define LOOSE 3.0  /* cell over disc: such cells hold empty room */

typedef struct place_run {
    tz_fill *f;
    const tz_power_cells *cells;
    const tz_vec3 *centre;
    double per_area; /* 1 / mean area of cells */
} place_run;

/* Of places: 2 or 3. */
static int axes(const tz_fill *f) { return f->dim == 3 ? 3 : 2; }

static bool is_live(const tz_fill *f, int32_t s)
{
    const tz_fill_body *b = &f->body.v[f->owner[s]];
    return b->awake && !b->fixed;
}

/* What a sample lacks to the border, from it inwards. */
static bool lacks_border(const tz_fill *f, int32_t s, double k[3])
{
    const tz_vec3 p = f->at[s], size = f->domain.size;
    const double r = f->c[s] * f->radius[s];
    const double at[3] = {p.x, p.y, p.z}, most[3] = {size.x, size.y, size.z};
    bool any = false;
    k[0] = k[1] = k[2] = 0;
    for (int i = 0; i < axes(f) && !f->domain.torus; i++) {
        if (2 * r >= most[i])
            k[i] = most[i] / 2 - at[i];
        else if (at[i] < r)
            k[i] = r - at[i];
        else if (at[i] > most[i] - r)
            k[i] = most[i] - r - at[i];
        any = any || k[i] != 0;
    }
    if (f->dim == 2 && f->domain.region) {
        const tz_region *g = f->domain.region;
        const tz_vec3 q = tz_domain_wrap(&f->domain, p);
        const double d = tz_region_distance(g, q);
        if (d < r) {
            const double e = 0.5 * g->raster.size.x / g->raster.width;
            double x = tz_region_distance(g, (tz_vec3){q.x + e, q.y, 0}) -
                       tz_region_distance(g, (tz_vec3){q.x - e, q.y, 0});
            double y = tz_region_distance(g, (tz_vec3){q.x, q.y + e, 0}) -
                       tz_region_distance(g, (tz_vec3){q.x, q.y - e, 0});
            const double l = hypot(x, y);
            if (l > 0) {
                k[0] += (r - d) * x / l, k[1] += (r - d) * y / l;
                any = true;
            }
        }
    }
    return any;
}

/* Conflicts of a node begin where its links did. */
static tz_status reserve_hits(tz_fill *f, const tz_power_cells *cells)
{
    int64_t n = 0;
    for (int32_t j = 0; j < f->live_sample.n; j++) {
        const int32_t s = f->live_sample.v[j];
        f->link_start[s] = (int32_t)n;
        n += cells->count[s];
    }
    if (n > INT32_MAX / 2)
        return tz_fail(f->ctx, TZ_LIMIT, "too many neighbours of samples");
    if (n <= f->edge_cap)
        return TZ_OK;
    const size_t cap = (size_t)n + (size_t)n / 8;
    tz_status s = tz_realloc(f->ctx, &f->edge_to, cap, sizeof *f->edge_to);
    if (s == TZ_OK)
        s = tz_realloc(f->ctx, &f->edge_w, cap * (size_t)f->columns, sizeof *f->edge_w);
    if (s == TZ_OK)
        f->edge_cap = (int32_t)cap;
    return s;
}

/* Beside empty room that a brush has left, or painted into, cells reach across all of it:
 * what lies there stays, or strokes would run out over the domain. */
static double most_area(const tz_fill *f, int32_t s)
{
    const double r = tz_fill_radius(f, s);
    return f->local && f->dim == 2 ? LOOSE * TZ_PI * r * r : HUGE_VAL;
}

static tz_vec3 to_centre(const place_run *t, int32_t s)
{
    if (!(t->cells->area[s] > 0) || t->cells->area[s] > most_area(t->f, s))
        return (tz_vec3){0, 0, 0};
    return t->centre ? t->centre[s]
                     : (tz_vec3){t->cells->centre[s].x, t->cells->centre[s].y, 0};
}

static int32_t end_of(const tz_fill *f, int32_t node)
{
    const tz_fill_body *b = &f->body.v[f->owner[node]];
    return node + (f->model.v[b->model].rigidity >= TZ_FILL_RIGID ? b->n : 1);
}

/* (w_v - 1) p' of two samples that are too near; false if they are not. */
static bool lacks_room(const tz_fill *f, int32_t s, int32_t q, double h[3], double *lack)
{
    const tz_vec3 v = tz_fill_vector(f, f->at[s], f->at[q]);
    const double d2 = v.x * v.x + v.y * v.y + v.z * v.z;
    const double sum = tz_fill_radius(f, s) + tz_fill_radius(f, q);
    if (d2 >= sum * sum)
        return false;
    const double d = sqrt(d2), by = d > 1e-9 * sum ? sum / d - 1 : 0;
    h[0] = by * v.x, h[1] = by * v.y, h[2] = by * v.z;
    *lack = sum - d;
    return true;
}

/* Adds a sample's terms to its node's row. */
static void add_sample(const place_run *t, int32_t s, double *g, double *diag,
                       double sums[4])
{
    tz_fill *f = t->f;
    const tz_vec3 c = to_centre(t, s);
    const double a = f->calm * fmin(t->cells->area[s], most_area(f, s)) * t->per_area;
    double k[3] = {0};
    g[0] += a * c.x, g[1] += a * c.y, g[2] += a * c.z;
    *diag += a;
    sums[0] += a * (c.x * c.x + c.y * c.y + c.z * c.z);
    f->pressure[s] = 0;
    if (lacks_border(f, s, k)) {
        double lack = 0;
        *diag += 2;
        for (int i = 0; i < axes(f); i++) {
            g[i] += 2 * k[i];
            lack += k[i] * k[i];
        }
        sums[2] += 2 * lack;
        f->pressure[s] += sqrt(lack) / (f->c[s] * f->radius[s]);
    }
}

/* One more conflict of a node with another; of several samples they are one edge. */
static int32_t add_hit(tz_fill *f, int32_t from, int32_t to, int32_t node)
{
    for (int32_t e = from; e < to; e++)
        if (f->edge_to[e] == node) {
            f->edge_w[e] += 2;
            return to;
        }
    f->edge_to[to] = node, f->edge_w[to] = 2;
    return to + 1;
}

/* Rows of nodes: diagonal, conflicts, right side. Sums: distribution, conflict, border. */
static void find_hits(void *arg, int32_t from, int32_t to, double sums[4])
{
    const place_run *t = arg;
    tz_fill *f = t->f;
    for (int32_t j = from; j < to; j++) {
        const int32_t node = f->live_node.v[j], end = end_of(f, node);
        double g[3] = {0, 0, 0}, diag = 1e-3; /* with no cell it stays */
        int32_t n = f->link_start[node];
        for (int32_t s = node; s < end; s++) {
            add_sample(t, s, g, &diag, sums);
            const int32_t *near = t->cells->neighbour + t->cells->start[s];
            for (int32_t i = 0; i < t->cells->count[s]; i++) {
                const int32_t q = near[i];
                double h[3] = {0}, lack;
                if (f->owner[q] == f->owner[s] || !lacks_room(f, s, q, h, &lack))
                    continue;
                n = add_hit(f, f->link_start[node], n, f->node[q]);
                f->pressure[s] += lack / tz_fill_radius(f, s);
                g[0] -= 2 * h[0], g[1] -= 2 * h[1], g[2] -= 2 * h[2];
                sums[1] +=
                    (is_live(f, q) ? 1 : 2) * (h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
            }
        }
        f->link_count[node] = n - f->link_start[node];
        f->diag[node] = diag;
        for (int a = 0; a < axes(f); a++)
            f->gradient[(ptrdiff_t)node * f->dim + a] = g[a];
    }
}

/* The same energies after the step, of the places before it. */
static void measure_after(void *arg, int32_t from, int32_t to, double sums[4])
{
    const place_run *t = arg;
    const tz_fill *f = t->f;
    const int m = axes(f);
    for (int32_t j = from; j < to; j++) {
        const int32_t s = f->live_sample.v[j];
        const double *d = f->step + (ptrdiff_t)f->node[s] * m;
        const tz_vec3 c = to_centre(t, s);
        const double g[3] = {c.x, c.y, c.z},
                     a = f->calm * fmin(t->cells->area[s], most_area(f, s)) * t->per_area;
        double k[3] = {0}, h[3] = {0}, lack;
        const bool border = lacks_border(f, s, k);
        for (int i = 0; i < m; i++) {
            sums[0] += a * (d[i] - g[i]) * (d[i] - g[i]);
            sums[2] += border ? 2 * (d[i] - k[i]) * (d[i] - k[i]) : 0;
        }
        const int32_t *near = t->cells->neighbour + t->cells->start[s];
        for (int32_t e = 0; e < t->cells->count[s]; e++) {
            const int32_t q = near[e];
            if (f->owner[q] == f->owner[s] || !lacks_room(f, s, q, h, &lack))
                continue;
            const bool live = is_live(f, q);
            for (int i = 0; i < m; i++) {
                const double o = live ? f->step[(ptrdiff_t)f->node[q] * m + i] : 0;
                sums[1] += (live ? 1 : 2) * (o - d[i] - h[i]) * (o - d[i] - h[i]);
            }
        }
    }
}

/* What the graph step would add to a soft body's step as a whole, so that it is the mean
 * weighed by area, as for rigid ones, and not by number of discs. */
static tz_vec3 drift(const place_run *t, const tz_fill_body *b)
{
    const tz_fill *f = t->f;
    double plain[3] = {0, 0, 0}, weighed[3] = {0, 0, 0}, area = 0;
    for (int32_t s = b->first; s < b->first + b->n; s++) {
        const double a = t->cells->area[s];
        for (int i = 0; i < axes(f); i++) {
            const double d = f->step[(ptrdiff_t)s * f->dim + i];
            plain[i] += d / b->n, weighed[i] += a * d;
        }
        area += a;
    }
    if (!(area > 0))
        return (tz_vec3){0, 0, 0};
    return (tz_vec3){weighed[0] / area - plain[0], weighed[1] / area - plain[1],
                     weighed[2] / area - plain[2]};
}

static void add_step(void *arg, int32_t from, int32_t to, double sums[4])
{
    const place_run *t = arg;
    tz_fill *f = t->f;
    (void)sums;
    for (int32_t j = from; j < to; j++) {
        const tz_fill_body *b = &f->body.v[f->live.v[j]];
        const bool soft = b->n > 1 && f->model.v[b->model].rigidity < TZ_FILL_RIGID;
        const tz_vec3 v = soft ? drift(t, b) : (tz_vec3){0, 0, 0};
        for (int32_t s = b->first; s < b->first + b->n; s++) {
            const double *d = f->step + (ptrdiff_t)f->node[s] * f->dim;
            f->at[s].x += d[0] + v.x, f->at[s].y += d[1] + v.y;
            if (f->dim == 3)
                f->at[s].z += d[2] + v.z;
        }
    }
}

tz_status tz_fill_distribution_step(tz_fill *f, const tz_power_cells *cells,
                                    const tz_vec3 *centre, double before_after[2],
                                    double terms[3])
{
    const double all = f->dim == 3
                           ? f->domain.size.x * f->domain.size.y * f->domain.size.z
                           : tz_domain_area(&f->domain);
    place_run t = {f, cells, centre, f->n / all};
    double sums[4] = {0};
    tz_status s = reserve_hits(f, cells);
    if (s == TZ_OK)
        s = tz_fill_blocks(f->ctx, f->live_node.n, find_hits, &t, sums);
    const double per = 1 / (f->unit * f->unit);
    before_after[0] = (sums[0] + sums[1] + sums[2]) * per;
    const tz_fill_system y = tz_fill_system_of(f, f->dim, 1);
    if (s == TZ_OK)
        s = tz_fill_solve(&y, f->gradient, SMALL * f->unit, ROUNDS, f->step);
    if (s == TZ_OK && terms)
        s = tz_fill_blocks(f->ctx, f->live_sample.n, measure_after, &t, sums);
    before_after[1] = (sums[0] + sums[1] + sums[2]) * per;
    for (int k = 0; k < 3 && terms; k++)
        terms[k] = sums[k] * per;
    if (s == TZ_OK)
        s = tz_fill_blocks(f->ctx, f->live.n, add_step, &t, NULL);
    return s;
}

/* ---- graphs ------------------------------------------------------------------------- */

/* c o of Eq. (3): columns, of which the plane has two numbers. */
static void frame_of(const tz_fill *f, const tz_fill_body *b, int32_t s, double m[9])
{
    const double c = tz_fill_scale(f, s);
    const double *u = f->o + (ptrdiff_t)f->node[s] * f->m;
    if (f->dim == 3) {
        for (int k = 0; k < 9; k++)
            m[k] = c * b->size * u[k];
        return;
    }
    const tz_vec2 t = tz_fill_turn(f, s);
    m[0] = c * (t.x * b->x - t.y * b->y), m[1] = c * (t.y * b->x + t.x * b->y);
}

/* c o (q' - s') of Eq. (3), from disc a to disc o of a body. */
static inline tz_vec3 wanted(const tz_fill *f, const double m[9], tz_vec3 a, tz_vec3 o)
{
    const tz_vec3 d = {o.x - a.x, o.y - a.y, o.z - a.z};
    if (f->dim == 3)
        return (tz_vec3){m[0] * d.x + m[3] * d.y + m[6] * d.z,
                         m[1] * d.x + m[4] * d.y + m[7] * d.z,
                         m[2] * d.x + m[5] * d.y + m[8] * d.z};
    return (tz_vec3){m[0] * d.x - m[1] * d.y, m[1] * d.x + m[0] * d.y, 0};
}

typedef struct frames {
    double m[TZ_COVER_DISCS][9];
} frames;

static double graph_energy(const tz_fill *f, const tz_fill_body *b,
                           const tz_fill_model *m, const frames *o)
{
    double sum = 0;
    for (int a = 0; a < b->n; a++)
        for (int32_t k = m->start[a]; k < m->start[a + 1]; k++) {
            const tz_vec3 w = wanted(f, o->m[a], m->rest[a], m->rest[m->near[k]]);
            const tz_vec3 p = f->at[b->first + a], q = f->at[b->first + m->near[k]];
            const double x = q.x - p.x - w.x, y = q.y - p.y - w.y, z = q.z - p.z - w.z;
            sum += x * x + y * y + z * z;
        }
    return sum;
}

static void restore(tz_fill *f, const tz_fill_body *b, const tz_fill_model *m,
                    double sums[4])
{
    tz_vec3 right[TZ_COVER_DISCS];
    frames o;
    o.m[0][0] = 0; /* for the compiler: b->n >= 1 */
    for (int a = 0; a < b->n; a++)
        frame_of(f, b, b->first + a, o.m[a]);
    sums[0] += TZ_FILL_GRAPH * graph_energy(f, b, m, &o);
    for (int a = 0; a < b->n; a++) {
        right[a] = f->at[b->first + a];
        for (int32_t k = m->start[a]; k < m->start[a + 1]; k++) {
            const int q = m->near[k];
            const tz_vec3 w = wanted(f, o.m[a], m->rest[a], m->rest[q]),
                          v = wanted(f, o.m[q], m->rest[q], m->rest[a]);
            right[a].x += TZ_FILL_GRAPH * (v.x - w.x);
            right[a].y += TZ_FILL_GRAPH * (v.y - w.y);
            right[a].z += TZ_FILL_GRAPH * (v.z - w.z);
        }
    }
    for (int a = 0; a < b->n; a++) {
        tz_vec3 p = {0, 0, 0}, *at = &f->at[b->first + a];
        for (int k = 0; k < b->n; k++) {
            const double w = m->inverse[a * m->n + k];
            p.x += w * right[k].x, p.y += w * right[k].y, p.z += w * right[k].z;
        }
        sums[1] += (p.x - at->x) * (p.x - at->x) + (p.y - at->y) * (p.y - at->y) +
                   (p.z - at->z) * (p.z - at->z);
        *at = p;
    }
    const double left = graph_energy(f, b, m, &o);
    sums[1] += TZ_FILL_GRAPH * left;
    sums[2] += left;
}

static void restore_bodies(void *arg, int32_t from, int32_t to, double sums[4])
{
    tz_fill *f = arg;
    for (int32_t j = from; j < to; j++) {
        const tz_fill_body *b = &f->body.v[f->live.v[j]];
        const tz_fill_model *m = &f->model.v[b->model];
        if (b->n > 1)
            restore(f, b, m, sums);
        if (!f->domain.torus)
            continue;
        const tz_vec3 p = f->at[b->first], q = tz_domain_wrap(&f->domain, p);
        for (int32_t s = b->first; s < b->first + b->n && (p.x != q.x || p.y != q.y); s++)
            f->at[s].x += q.x - p.x, f->at[s].y += q.y - p.y;
    }
}

tz_status tz_fill_graph_step(tz_fill *f, double before_after[2], double *energy)
{
    double sums[4];
    const double per = 1 / (f->unit * f->unit);
    const tz_status s = tz_fill_blocks(f->ctx, f->live.n, restore_bodies, f, sums);
    before_after[0] = sums[0] * per, before_after[1] = sums[1] * per;
    *energy = sums[2] * per;
    return s;
}
