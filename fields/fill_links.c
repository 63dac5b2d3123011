/* SPDX-License-Identifier: Apache-2.0 */
/* Links, and what the field says.
 *
 * Links of a sample are all its neighbours of other bodies in the weighted triangulation,
 * N_s of Eq. (8); [Hsu20] takes the three nearest of them, "for dimension reduction", of
 * all samples, but those of one body overlap and would be all three. Sizes and densities
 * go along them; directions, too, unless both things are rigid: then fill_peers.c has
 * links. Of a soft body the samples that its graph joins are linked as well, so that it
 * stays smooth at rigidity 0.
 *
 * Confidence, Eq. (7), is area over that of a unit of the domain; a pixel there, here
 * 1/CONFIDENT of a mean disc, so that nothing depends on units. */
#include "fields/fill_internal.h"

#define CONFIDENT 100.0
#define MIDDLE    4.0  /* times as much under a thing's middle */
#define PRIOR     1.0  /* confidence of directions between strokes */
#define CORE      0.35 /* strokes about a place agree by less: a whirl lies there */

typedef struct near_run {
    tz_fill *f;
    const tz_power_cells *cells;
} near_run;

/* Distance over the sum of radii: w_v^-1 of Eq. (2). */
static double key_of(const tz_fill *f, int32_t s, int32_t t)
{
    const tz_vec3 v = tz_fill_vector(f, f->at[s], f->at[t]);
    return sqrt(v.x * v.x + v.y * v.y + v.z * v.z) /
           (tz_fill_radius(f, s) + tz_fill_radius(f, t));
}

/* Eq. (8) lets neighbours that point apart ignore each other, so that whirls drift until
 * they find a seam, and the energy of a whirl hardly depends on where it lies: packing
 * moves it about. A word of what lies harmonically between the strokes keeps all things on
 * the way while the first iterations pack them, and to the end those about a whirl, where
 * strokes all around cancel each other. */
static void look_between(tz_fill *f, int32_t s, tz_vec3 at)
{
    tz_vec2 v;
    const double l = tz_fill_direction(f, at, &v);
    const double core = fmax(0, 1 - l * l / (CORE * CORE));
    f->prior[s] = PRIOR * fmax(f->guided, core);
    f->target[2 * (ptrdiff_t)s] = v.x, f->target[2 * (ptrdiff_t)s + 1] = v.y;
}

static double confidence(const tz_fill *f, double r)
{
    return CONFIDENT * r * r / (f->unit * f->unit);
}

/* Share of a disc beyond a straight border at that distance from its middle, over a half,
 * to a power by which discs that are only touched hardly count. */
static double beyond(double d)
{
    const double share = 2 / TZ_PI * (acos(d) - d * sqrt(fmax(0, 1 - d * d)));
    return share * share * share;
}

static void look_up(tz_fill *f, int32_t s)
{
    const tz_element_field *d = f->field;
    const double r = f->c[s] * f->radius[s];
    const double sure = confidence(f, r);
    f->confident[s] = f->said_c[s] = f->said_rho[s] = 0;
    f->prior[s] = 0;
    if (!f->any_direction && !f->any_size && !f->any_density)
        return;
    const bool any[3] = {f->any_direction, f->any_size, f->any_density};
    const tz_vec3 at = tz_domain_wrap(&f->domain, f->at[s]);
    const int64_t i = tz_raster_at(&d->raster, at);
    for (int what = 0; what < 3; what++) {
        const int32_t n = any[what] ? d->nearest[what][i] : -1;
        if (n < 0)
            continue;
        if (what == 0 && f->par.start == TZ_FILL_INSERT)
            look_between(f, s, at);
        const tz_element_field_cell *c = &d->cell[n];
        double share = 1;
        if (n != i) { /* under the disc, though not under its centre */
            const tz_raster *g = &d->raster;
            const tz_vec3 q = {(n % g->width + 0.5) * g->size.x / g->width,
                               (n / g->width + 0.5) * g->size.y / g->height, at.z};
            const tz_vec3 v = tz_fill_vector(f, at, q);
            const double off2 = v.x * v.x + v.y * v.y;
            if (off2 > r * r)
                continue;
            share = what == 0 ? beyond(sqrt(off2) / r) : 1;
        }
        const double w = sure * share * (double)c->weight[what];
        if (what == 0) {
            f->confident[s] = w, f->prior[s] = 0;
            f->target[2 * (ptrdiff_t)s] = (double)c->x;
            f->target[2 * (ptrdiff_t)s + 1] = (double)c->y;
        } else if (what == 1) {
            f->said_c[s] = w, f->target_c[s] = (double)c->size;
        } else {
            f->said_rho[s] = w, f->target_rho[s] = 1 - (double)c->density;
        }
    }
}

/* A rigid thing whose middle lies under a stroke points as it does there, and not as the
 * mean of what its discs see. */
static void look_up_middle(tz_fill *f, const tz_fill_body *b)
{
    if (!f->any_direction)
        return;
    const tz_vec3 at = tz_fill_middle(f, b);
    const tz_element_field_cell *c = tz_element_field_at(f->field, at);
    double sure = 0;
    if (!c || !(c->weight[0] > 0))
        return;
    for (int32_t s = b->first; s < b->first + b->n; s++) {
        sure += confidence(f, f->c[s] * f->radius[s]);
        f->confident[s] = f->prior[s] = 0;
    }
    f->confident[b->first] = MIDDLE * fmax(sure, CONFIDENT) * (double)c->weight[0];
    f->target[2 * (ptrdiff_t)b->first] = (double)c->x;
    f->target[2 * (ptrdiff_t)b->first + 1] = (double)c->y;
}

static bool is_tied(const tz_fill *f, const tz_fill_body *b)
{
    return f->model.v[b->model].rigidity >= TZ_FILL_RIGID;
}

static bool has_peers(const tz_fill *f, const tz_fill_body *b)
{
    return is_tied(f, b) && !f->model.v[b->model].round;
}

/* Whether links of samples are asked for at all. */
static bool needs_samples(const tz_fill *f)
{
    return f->dim != 2 || f->any_soft || f->any_size || f->any_density;
}

/* Whether directions go along links of samples between two things: in space between all,
 * in the plane unless both are rigid and have peers. Round ones pass directions on where
 * soft things need that. */
static bool turns(const tz_fill *f, const tz_fill_body *a, const tz_fill_body *b)
{
    return f->dim != 2 || (f->any_soft && !(has_peers(f, a) && has_peers(f, b)));
}

static void link_samples(void *arg, int32_t from, int32_t to, double sums[4])
{
    const near_run *t = arg;
    tz_fill *f = t->f;
    (void)sums;
    for (int32_t j = from; j < to; j++) {
        const int32_t node = f->live_node.v[j];
        const tz_fill_body *b = &f->body.v[f->owner[node]];
        const tz_fill_model *m = &f->model.v[b->model];
        const bool tied = is_tied(f, b);
        int32_t n = f->link_start[node];
        for (int32_t s = node; s < node + (tied ? b->n : 1); s++) {
            const int32_t *near = t->cells->neighbour + t->cells->start[s];
            if (f->dim == 2)
                look_up(f, s);
            else
                f->prior[s] = 0;
            for (int32_t k = 0; k < t->cells->count[s] && needs_samples(f); k++) {
                const int32_t q = near[k];
                if (f->owner[q] == f->owner[s])
                    continue;
                const double key = key_of(f, s, q), w = 2 / (1 + key * key);
                f->link.v[n++] = (tz_fill_link){
                    f->node[q], w, 0, turns(f, b, &f->body.v[f->owner[q]]) ? w : 0};
            }
        }
        if (f->dim == 2 && tied)
            look_up_middle(f, b);
        const int32_t own = node - b->first;
        for (int32_t k = m->start[own]; k < m->start[own + 1] && !tied; k++) {
            const int32_t q = b->first + m->near[k];
            const double key = key_of(f, node, q), w = 2 / (1 + key * key);
            f->link.v[n++] = (tz_fill_link){q, w, 2 * m->rigidity, w};
        }
        f->link_count[node] = n - f->link_start[node];
    }
}

static tz_status reserve_links(tz_fill *f, const tz_power_cells *cells)
{
    int64_t n = 0;
    for (int32_t j = 0; j < f->live_sample.n; j++) {
        const int32_t s = f->live_sample.v[j];
        const tz_fill_body *b = &f->body.v[f->owner[s]];
        const tz_fill_model *m = &f->model.v[b->model];
        f->link_start[s] = (int32_t)n;
        n += needs_samples(f) ? cells->count[s] : 0;
        if (!is_tied(f, b))
            n += m->start[s - b->first + 1] - m->start[s - b->first];
        else if (s == b->first && f->dim == 2)
            n += f->named[f->owner[s]];
        if (n > INT32_MAX / 4)
            return tz_fail(f->ctx, TZ_LIMIT, "too many neighbours of samples");
    }
    tz_status s = tz_array_reserve(f->ctx, &f->link, n);
    if (s == TZ_OK && n > f->edge_cap) {
        const size_t cap = (size_t)n + (size_t)n / 4;
        s = tz_realloc(f->ctx, &f->edge_to, cap, sizeof *f->edge_to);
        if (s == TZ_OK)
            s = tz_realloc(f->ctx, &f->edge_w, cap * (size_t)f->columns,
                           sizeof *f->edge_w);
        if (s == TZ_OK)
            f->edge_cap = (int32_t)cap;
    }
    return s;
}

tz_status tz_fill_neighbours(tz_fill *f, const tz_power_cells *cells)
{
    near_run t = {f, cells};
    tz_status s = tz_fill_peers(f);
    if (s == TZ_OK && f->dim == 2)
        tz_fill_count_peers(f);
    if (s == TZ_OK)
        s = reserve_links(f, cells);
    if (s == TZ_OK)
        s = tz_fill_blocks(f->ctx, f->live_node.n, link_samples, &t, NULL);
    if (s == TZ_OK && f->dim == 2)
        tz_fill_link_peers(f);
    return s;
}
