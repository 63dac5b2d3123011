/* SPDX-License-Identifier: Apache-2.0 */
/* What one field of elements is like: distances, classes, angles, overlaps. */
#include "elements/element_statistics.h"

#include <stdlib.h>
#include <string.h>

#include "elements/cells.h"

enum {
    QUANTILES = TZ_STATISTICS_QUANTILES,
    BINS = TZ_STATISTICS_BINS,
    TURNS = TZ_STATISTICS_TURNS,
    CLASSES = TZ_STATISTICS_CLASSES,
    MOST_CENTRES = 4096,
    MOST_NEAR = 128
};

/* ---- fields ---------------------------------------------------------------------- */

tz_status tz_field_init(tz_ctx *ctx, tz_field *f, const tz_element_set *s, tz_vec2 from,
                        tz_vec2 to)
{
    const tz_vec3 size = s->domain.size;
    const bool whole = from.x == 0 && from.y == 0 && to.x == 1 && to.y == 1;
    *f = (tz_field){.ctx = ctx};
    f->domain.size =
        (tz_vec3){(to.x - from.x) * size.x, (to.y - from.y) * size.y, size.z};
    f->domain.torus = whole && s->domain.torus;
    tz_status st = tz_alloc(ctx, &f->item, (size_t)s->element.n, sizeof *f->item);
    if (st == TZ_OK)
        st = tz_alloc(ctx, &f->at, (size_t)s->element.n, sizeof *f->at);
    for (int32_t i = 0; st == TZ_OK && i < s->element.n; i++) {
        const tz_element *e = &s->element.v[i];
        const tz_vec3 p = tz_domain_wrap(&s->domain, e->at);
        const tz_vec3 at = {p.x - from.x * size.x, p.y - from.y * size.y, p.z};
        if (!whole && !tz_domain_contains(&f->domain, at))
            continue;
        f->at[f->n] = at;
        f->item[f->n++] = (tz_field_item){.at = at,
                                          .angle = e->angle,
                                          .radius = e->radius,
                                          .kind = e->kind,
                                          .element = e,
                                          .oriented = s->kind.v[e->kind].oriented,
                                          .is_void = s->kind.v[e->kind].is_void};
    }
    if (st == TZ_OK)
        st = tz_extents_init(ctx, s, &f->extents);
    if (st != TZ_OK)
        tz_field_deinit(f);
    return st;
}

void tz_field_deinit(tz_field *f)
{
    tz_extents_deinit(&f->extents);
    tz_free(f->ctx, f->item);
    tz_free(f->ctx, f->at);
    *f = (tz_field){0};
}

/* ---- distances ------------------------------------------------------------------- */

static int by_value(const void *a, const void *b)
{
    const double p = *(const double *)a, q = *(const double *)b;
    return (p > q) - (p < q);
}

static int32_t class_of(const tz_field_item *v)
{
    return v->kind < CLASSES ? v->kind : CLASSES - 1;
}

/* Distance from the border of a plain domain; unbounded on a torus. */
static double depth_of(const tz_field *f, tz_vec3 p)
{
    const tz_vec3 s = f->domain.size;
    return f->domain.torus ? INFINITY : fmin(fmin(p.x, s.x - p.x), fmin(p.y, s.y - p.y));
}

/* Domain's area, over the share of it in which both ends of such a pair fit. */
static double pair_weight(const tz_field *f, tz_nearby v)
{
    const tz_vec3 s = f->domain.size;
    const double area = s.x * s.y;
    if (f->domain.torus)
        return area;
    return area * area / ((s.x - fabs((double)v.x)) * (s.y - fabs((double)v.y)));
}

/* Into two bins by where between their middles it lies. */
static void add_pair(double *bins, double distance, double reach, double weight)
{
    const double at = distance / reach * BINS - 0.5, low = floor(at);
    const int32_t b = (int32_t)low;
    if (b >= 0 && b < BINS)
        bins[b] += weight * (1 - (at - low));
    if (b + 1 >= 0 && b + 1 < BINS)
        bins[b + 1] += weight * (at - low);
}

/* From sums of pairs times area to ratios against chance. */
static void against_chance(double *bins, double reach, double centres, double others)
{
    for (int32_t b = 0; b < BINS; b++) {
        const double r = (b + 0.5) * reach / BINS, width = reach / BINS;
        const double expected = centres * others * 2 * TZ_PI * r * width;
        bins[b] = expected > 0 ? bins[b] / expected : 1;
    }
}

typedef struct tally {
    double *nearest; /* of centres away from the border */
    int32_t nearest_n;
    double centres[1 + CLASSES], others[1 + CLASSES];
} tally;

static void count_pairs(const tz_field *f, const tz_cells *cells, double spacing,
                        double reach, tally *t, tz_statistics *out)
{
    const int32_t step = 1 + (f->n - 1) / MOST_CENTRES;
    tz_nearby near[MOST_NEAR];
    for (int32_t i = 0; i < f->n; i++)
        t->others[0]++, t->others[1 + class_of(&f->item[i])]++;
    for (int32_t i = 0; i < f->n; i += step) {
        const int32_t c = class_of(&f->item[i]);
        const int32_t n =
            tz_cells_near(cells, f->at, f->at[i], reach, i, near, MOST_NEAR);
        t->centres[0]++, t->centres[1 + c]++;
        for (int32_t k = 0; k < n; k++) {
            const double d = sqrt((double)near[k].dist2), w = pair_weight(f, near[k]);
            add_pair(out->correlation[0], d, reach, w);
            if (class_of(&f->item[near[k].id]) == c)
                add_pair(out->correlation[1 + c], d, reach, w);
        }
        if (depth_of(f, f->at[i]) >= spacing)
            t->nearest[t->nearest_n++] = n > 0 ? sqrt((double)near[0].dist2) : reach;
    }
}

static void quantiles(tally *t, double *out)
{
    qsort(t->nearest, (size_t)t->nearest_n, sizeof *t->nearest, by_value);
    for (int32_t k = 0; k < QUANTILES && t->nearest_n > 0; k++) {
        const double at = (k + 0.5) / QUANTILES * t->nearest_n - 0.5;
        const double low = fmin(fmax(at, 0), t->nearest_n - 1);
        const int32_t i = (int32_t)low, j = i + 1 < t->nearest_n ? i + 1 : i;
        out[k] = t->nearest[i] + (low - i) * (t->nearest[j] - t->nearest[i]);
    }
}

static void count_turns(const tz_field *f, double *turn)
{
    double n = 0;
    for (int32_t i = 0; i < f->n; i++) {
        if (!f->item[i].oriented)
            continue;
        const double t = f->item[i].angle / (2 * TZ_PI);
        const double at = (t - floor(t)) * TURNS, low = floor(at);
        turn[(int32_t)low % TURNS] += 1 - (at - low);
        turn[((int32_t)low + 1) % TURNS] += at - low;
        n++;
    }
    for (int32_t k = 0; k < TURNS && n > 0; k++)
        turn[k] /= n;
}

tz_status tz_statistics_of(const tz_field *f, double spacing, double reach,
                           tz_statistics *out)
{
    tz_cells cells = {0};
    tally t = {0};
    *out = (tz_statistics){0};
    tz_status s = tz_cells_fill(f->ctx, &cells, &f->domain, f->at, f->n, reach);
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &t.nearest, (size_t)f->n, sizeof *t.nearest);
    if (s == TZ_OK) {
        count_pairs(f, &cells, spacing, reach, &t, out);
        if (t.nearest_n == 0) /* all is border */
            t.nearest[t.nearest_n++] = spacing;
        quantiles(&t, out->nearest);
        count_turns(f, out->turn);
        for (int32_t c = 0; c <= CLASSES; c++) {
            against_chance(out->correlation[c], reach, t.centres[c], t.others[c]);
            out->weight[c] = t.others[c] >= 8 ? t.others[c] / f->n : 0;
        }
        for (int32_t c = 0; c < CLASSES; c++)
            out->share[c] = t.others[1 + c] / fmax(1, f->n);
    }
    tz_free(f->ctx, t.nearest);
    tz_cells_free(f->ctx, &cells);
    return s;
}

/* ---- overlaps -------------------------------------------------------------------- */

tz_status tz_field_overlaps(const tz_field *f, double *share)
{
    const double near_enough = 0.8; /* [Dav19] */
    tz_nearby near[MOST_NEAR];
    tz_cells cells = {0};
    uint8_t *hit = NULL;
    double widest = 0;
    int32_t hits = 0, solid = 0;
    for (int32_t i = 0; i < f->n; i++)
        widest = fmax(widest, f->item[i].radius);
    tz_status s = tz_cells_fill(f->ctx, &cells, &f->domain, f->at, f->n,
                                2 * near_enough * fmax(widest, 1e-300));
    if (s == TZ_OK)
        s = tz_alloc_zero(f->ctx, &hit, (size_t)f->n, 1);
    for (int32_t i = 0; s == TZ_OK && i < f->n; i++) {
        /* the larger of two looks for the smaller */
        const double r = f->item[i].radius;
        if (f->item[i].is_void)
            continue;
        solid++;
        const int32_t n = tz_cells_near(&cells, f->at, f->at[i], 2 * near_enough * r, i,
                                        near, MOST_NEAR);
        for (int32_t k = 0; k < n; k++) {
            const tz_field_item *o = &f->item[near[k].id];
            const double limit =
                near_enough * tz_extent_touch(&f->extents, f->item[i].element, o->element,
                                              (double)near[k].x, (double)near[k].y);
            if (!o->is_void && o->radius <= r && (double)near[k].dist2 < limit * limit)
                hit[i] = hit[near[k].id] = 1;
        }
    }
    for (int32_t i = 0; s == TZ_OK && i < f->n; i++)
        hits += hit[i];
    *share = solid > 0 ? (double)hits / solid : 0;
    tz_free(f->ctx, hit);
    tz_cells_free(f->ctx, &cells);
    return s;
}
