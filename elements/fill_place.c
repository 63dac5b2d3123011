/* SPDX-License-Identifier: Apache-2.0 */
/* Places: Eq. (1) to (4). The distribution step solves for the steps d of all samples
 *
 *   sum |d - g|^2 + 2 sum over conflicts |d' - d - h|^2 + 2 sum over borders |d - k|^2
 *
 * with g from a sample to the centre of its cell, h what two samples of different bodies
 * lack along the line between them, (w_v - 1) p', and k what a sample lacks to the border.
 * [Hsu20] lays fixed samples along the border; here its nearest point is one, found anew
 * each time, which is the same for samples laid infinitely dense.
 *
 * The graph step then minimises, body by body, sum |p - p*|^2 + w_g E_g from the places
 * p* just found. Its matrix depends on the graph alone: the inverse is kept by model. */
#include "elements/fill_internal.h"

#include <string.h>

enum { ROUNDS = 24 };
#define SMALL 2e-3 /* of the mean radius */

typedef struct place_run {
    tz_fill *f;
    const tz_power_cells *cells;
    const tz_vec3 *centre;
} place_run;

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
    for (int i = 0; i < f->dim && !f->domain.torus; i++) {
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

static tz_status reserve_hits(tz_fill *f, const tz_power_cells *cells)
{
    int64_t n = 0;
    for (int32_t j = 0; j < f->live_sample.n; j++) {
        const int32_t s = f->live_sample.v[j];
        f->hit_start[s] = (int32_t)n;
        n += cells->count[s];
    }
    if (n > INT32_MAX / 2)
        return tz_fail(f->ctx, TZ_LIMIT, "too many neighbours of samples");
    if (n <= f->hit_cap)
        return TZ_OK;
    const size_t cap = (size_t)n + (size_t)n / 4;
    tz_status s = tz_realloc(f->ctx, &f->hit_to, cap, sizeof *f->hit_to);
    if (s == TZ_OK)
        s = tz_realloc(f->ctx, &f->hit_w, cap, sizeof *f->hit_w);
    if (s == TZ_OK)
        f->hit_cap = (int32_t)cap;
    return s;
}

/* Steps to the centres, conflicts, right side. Sums: distribution, conflict, border. */
static void find_hits(void *arg, int32_t from, int32_t to, double sums[4])
{
    const place_run *t = arg;
    tz_fill *f = t->f;
    const int m = f->dim;
    for (int32_t j = from; j < to; j++) {
        const int32_t s = f->live_sample.v[j];
        double g[3] = {0, 0, 0}, k[3], diag = 0;
        f->pressure[s] = 0;
        if (t->cells->area[s] > 0) {
            if (t->centre)
                g[0] = t->centre[s].x, g[1] = t->centre[s].y, g[2] = t->centre[s].z;
            else
                g[0] = t->cells->centre[s].x, g[1] = t->cells->centre[s].y;
        }
        diag += 1; /* a sample without a cell stays where it is */
        for (int i = 0; i < m; i++)
            sums[0] += g[i] * g[i];
        if (lacks_border(f, s, k)) {
            diag += 2;
            double lack = 0;
            for (int i = 0; i < m; i++) {
                g[i] += 2 * k[i];
                sums[2] += 2 * k[i] * k[i];
                lack += k[i] * k[i];
            }
            f->pressure[s] += sqrt(lack) / (f->c[s] * f->radius[s]);
        }
        int32_t n = f->hit_start[s];
        const int32_t *near = t->cells->neighbour + t->cells->start[s];
        for (int32_t i = 0; i < t->cells->count[s]; i++) {
            const int32_t q = near[i];
            if (f->owner[q] == f->owner[s])
                continue;
            const tz_vec3 v = tz_fill_vector(f, f->at[s], f->at[q]);
            const double d2 = v.x * v.x + v.y * v.y + v.z * v.z;
            const double sum = tz_fill_radius(f, s) + tz_fill_radius(f, q);
            if (d2 >= sum * sum)
                continue;
            const double d = sqrt(d2), by = d > 1e-9 * sum ? sum / d - 1 : 0;
            const double h[3] = {by * v.x, by * v.y, by * v.z};
            f->hit_to[n] = q, f->hit_w[n++] = 2;
            f->pressure[s] += (sum - d) / tz_fill_radius(f, s);
            for (int a = 0; a < m; a++) {
                g[a] -= 2 * h[a];
                sums[1] += (is_live(f, q) ? 1 : 2) * h[a] * h[a];
            }
        }
        f->hit_count[s] = n - f->hit_start[s];
        f->diag[s] = diag;
        for (int a = 0; a < m; a++)
            f->gradient[(ptrdiff_t)s * m + a] = g[a];
    }
}

/* The same energies after the step. */
static void measure_after(void *arg, int32_t from, int32_t to, double sums[4])
{
    const place_run *t = arg;
    const tz_fill *f = t->f;
    const int m = f->dim;
    for (int32_t j = from; j < to; j++) {
        const int32_t s = f->live_sample.v[j];
        const double *d = f->step + (ptrdiff_t)s * m;
        double g[3] = {0, 0, 0}, k[3];
        if (t->cells->area[s] > 0) {
            if (t->centre)
                g[0] = t->centre[s].x, g[1] = t->centre[s].y, g[2] = t->centre[s].z;
            else
                g[0] = t->cells->centre[s].x, g[1] = t->cells->centre[s].y;
        }
        const bool border = lacks_border(f, s, k);
        for (int a = 0; a < m; a++) {
            sums[0] += (d[a] - g[a]) * (d[a] - g[a]);
            sums[2] += border ? 2 * (d[a] - k[a]) * (d[a] - k[a]) : 0;
        }
        for (int32_t e = f->hit_start[s]; e < f->hit_start[s] + f->hit_count[s]; e++) {
            const int32_t q = f->hit_to[e];
            const tz_vec3 v = tz_fill_vector(f, f->at[s], f->at[q]);
            const double l = sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
            const double sum = tz_fill_radius(f, s) + tz_fill_radius(f, q);
            const double by = l > 1e-9 * sum ? sum / l - 1 : 0;
            const double h[3] = {by * v.x, by * v.y, by * v.z};
            const bool live = is_live(f, q);
            for (int a = 0; a < m; a++) {
                const double o = live ? f->step[(ptrdiff_t)q * m + a] : 0;
                sums[1] += (live ? 1 : 2) * (o - d[a] - h[a]) * (o - d[a] - h[a]);
            }
        }
    }
}

static void add_step(void *arg, int32_t from, int32_t to, double sums[4])
{
    const place_run *t = arg;
    tz_fill *f = t->f;
    (void)sums;
    for (int32_t j = from; j < to; j++) {
        const int32_t s = f->live_sample.v[j];
        const double *d = f->step + (ptrdiff_t)s * f->dim;
        f->at[s].x += d[0], f->at[s].y += d[1];
        if (f->dim == 3)
            f->at[s].z += d[2];
    }
}

tz_status tz_fill_distribution_step(tz_fill *f, const tz_power_cells *cells,
                                    const tz_vec3 *centre, double before_after[2],
                                    double terms[3])
{
    place_run t = {f, cells, centre};
    double sums[4] = {0};
    tz_status s = reserve_hits(f, cells);
    if (s == TZ_OK)
        s = tz_fill_blocks(f->ctx, f->live_sample.n, find_hits, &t, sums);
    const double per = 1 / (f->unit * f->unit);
    before_after[0] = (sums[0] + sums[1] + sums[2]) * per;
    const tz_fill_system y = {.ctx = f->ctx,
                              .nodes = f->live_sample.n,
                              .node = f->live_sample.v,
                              .m = f->dim,
                              .columns = 1,
                              .start = f->hit_start,
                              .count = f->hit_count,
                              .to = f->hit_to,
                              .w = f->hit_w,
                              .diag = f->diag,
                              .work = f->work,
                              .size = f->n};
    if (s == TZ_OK)
        s = tz_fill_solve(&y, f->gradient, SMALL * f->unit, ROUNDS, f->step);
    if (s == TZ_OK && terms)
        s = tz_fill_blocks(f->ctx, f->live_sample.n, measure_after, &t, sums);
    before_after[1] = (sums[0] + sums[1] + sums[2]) * per;
    for (int k = 0; k < 3 && terms; k++)
        terms[k] = sums[k] * per;
    if (s == TZ_OK)
        s = tz_fill_blocks(f->ctx, f->live_sample.n, add_step, &t, NULL);
    return s;
}

/* ---- graphs ------------------------------------------------------------------------- */

/* c o (q' - s') of Eq. (3), from disc a to disc b of a body. */
static tz_vec3 wanted(const tz_fill *f, const tz_fill_body *b, const tz_fill_model *m,
                      int a, int o)
{
    const int32_t s = b->first + a;
    const tz_vec3 d = {m->rest[o].x - m->rest[a].x, m->rest[o].y - m->rest[a].y,
                       m->rest[o].z - m->rest[a].z};
    const double c = tz_fill_scale(f, s);
    const double *u = f->o + (ptrdiff_t)f->node[s] * f->m;
    if (f->dim == 3) {
        const double k = c * b->size;
        return (tz_vec3){k * (u[0] * d.x + u[3] * d.y + u[6] * d.z),
                         k * (u[1] * d.x + u[4] * d.y + u[7] * d.z),
                         k * (u[2] * d.x + u[5] * d.y + u[8] * d.z)};
    }
    const tz_vec2 t = tz_fill_turn(f, s);
    const double x = b->x * d.x - b->y * d.y, y = b->y * d.x + b->x * d.y;
    return (tz_vec3){c * (t.x * x - t.y * y), c * (t.y * x + t.x * y), 0};
}

static double graph_energy(const tz_fill *f, const tz_fill_body *b,
                           const tz_fill_model *m)
{
    double sum = 0;
    for (int a = 0; a < b->n; a++)
        for (int32_t k = m->start[a]; k < m->start[a + 1]; k++) {
            const tz_vec3 w = wanted(f, b, m, a, m->near[k]);
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
    sums[0] += TZ_FILL_GRAPH * graph_energy(f, b, m);
    for (int a = 0; a < b->n; a++) {
        right[a] = f->at[b->first + a];
        for (int32_t k = m->start[a]; k < m->start[a + 1]; k++) {
            const int o = m->near[k];
            const tz_vec3 w = wanted(f, b, m, a, o), v = wanted(f, b, m, o, a);
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
    const double left = graph_energy(f, b, m);
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
