/* SPDX-License-Identifier: Apache-2.0 */
/* Likeness: differences between layout and exemplar, each over the same difference
 * between the exemplar's own halves (left and right, top and bottom, averaged). To both a
 * small allowance is added, so that lattices, whose halves do not differ, divide by
 * something. */
#include "elements/element_compare.h"

#include "elements/element_density.h"
#include "elements/element_statistics.h"

enum { RINGS = 3, MEASURES = 4 + RINGS };
static const int32_t near_of_ring[RINGS] = {6, 18, 36};

/* Differences of two fields. */
typedef struct differences {
    double nearest, correlation, classes, orientation, distance[RINGS];
} differences;

/* What is too small to matter: lengths in spacings. */
static const differences allowance = {.nearest = 0.02,
                                      .correlation = 0.1,
                                      .classes = 0.02,
                                      .orientation = 0.05,
                                      .distance = {0.03, 0.03, 0.03}};

static double apart(const double *a, const double *b, int32_t n)
{
    double sum = 0;
    for (int32_t k = 0; k < n; k++)
        sum += fabs(a[k] - b[k]);
    return sum;
}

static double correlations_apart(const tz_statistics *p, const tz_statistics *q)
{
    double sum = 0, weights = 0;
    for (int32_t c = 0; c <= TZ_STATISTICS_CLASSES; c++) {
        const double w = fmin(p->weight[c], q->weight[c]);
        sum += w * apart(p->correlation[c], q->correlation[c], TZ_STATISTICS_BINS) /
               TZ_STATISTICS_BINS;
        weights += w;
    }
    return weights > 0 ? sum / weights : 0;
}

/* What everything is measured by, the halves too. */
typedef struct scale {
    double spacing;
    double reach; /* of pair correlations */
    int32_t near; /* most neighbours that a neighbourhood can be asked to have */
} scale;

/* How p differs from what it should be like, q. */
static tz_status compare(const tz_field *p, const tz_field *q, const scale *c,
                         differences *d)
{
    tz_statistics a, b;
    *d = (differences){0};
    if (p->n < 1 || q->n < 1) { /* an empty half differs wholly */
        *d = (differences){1, 1, 1, 1, {1, 1, 1}};
        return TZ_OK;
    }
    tz_status s = tz_statistics_of(p, c->spacing, c->reach, &a);
    if (s == TZ_OK)
        s = tz_statistics_of(q, c->spacing, c->reach, &b);
    if (s != TZ_OK)
        return s;
    d->nearest = apart(a.nearest, b.nearest, TZ_STATISTICS_QUANTILES) /
                 (TZ_STATISTICS_QUANTILES * c->spacing);
    d->correlation = correlations_apart(&a, &b);
    d->classes = apart(a.share, b.share, TZ_STATISTICS_CLASSES) / 2;
    d->orientation = apart(a.turn, b.turn, TZ_STATISTICS_TURNS) / 2;
    for (int k = 0; k < RINGS && s == TZ_OK; k++) {
        const int32_t near = near_of_ring[k] < c->near ? near_of_ring[k] : c->near;
        s = tz_field_distance(p, q, c->spacing, near, &d->distance[k]);
        d->distance[k] /= c->spacing;
    }
    return s;
}

static void add(differences *sum, const differences *d, double share)
{
    sum->nearest += share * d->nearest;
    sum->correlation += share * d->correlation;
    sum->classes += share * d->classes;
    sum->orientation += share * d->orientation;
    for (int k = 0; k < RINGS; k++)
        sum->distance[k] += share * d->distance[k];
}

static tz_status compare_halves(tz_ctx *ctx, const tz_element_set *s, const scale *c,
                                differences *out)
{
    static const tz_vec2 from[4] = {{0, 0}, {0.5, 0}, {0, 0}, {0, 0.5}};
    static const tz_vec2 to[4] = {{0.5, 1}, {1, 1}, {1, 0.5}, {1, 1}};
    tz_field half[4] = {{0}};
    tz_status st = TZ_OK;
    *out = (differences){0};
    for (int k = 0; k < 4 && st == TZ_OK; k++)
        st = tz_field_init(ctx, &half[k], s, from[k], to[k]);
    for (int k = 0; k < 4 && st == TZ_OK; k++) {
        differences d;
        st = compare(&half[k], &half[k ^ 1], c, &d);
        add(out, &d, 0.25);
    }
    for (int k = 0; k < 4; k++)
        tz_field_deinit(&half[k]);
    return st;
}

static double ratio(double found, double own, double small)
{
    return (found + small) / (own + small);
}

static void rate(const differences *d, const differences *own, double spacing,
                 bool oriented, tz_element_likeness *out)
{
    const differences *e = &allowance;
    out->nearest = ratio(d->nearest, own->nearest, e->nearest);
    out->correlation = ratio(d->correlation, own->correlation, e->correlation);
    out->classes = ratio(d->classes, own->classes, e->classes);
    out->orientation =
        oriented ? ratio(d->orientation, own->orientation, e->orientation) : 1;
    out->mean = out->nearest + out->correlation + out->classes + out->orientation;
    for (int k = 0; k < RINGS; k++) {
        out->neighbourhood[k] = ratio(d->distance[k], own->distance[k], e->distance[k]);
        out->distance[k] = d->distance[k] * spacing;
        out->mean += out->neighbourhood[k];
    }
    out->mean /= MEASURES;
}

static bool any_oriented(const tz_field *f)
{
    for (int32_t i = 0; i < f->n; i++)
        if (f->item[i].oriented)
            return true;
    return false;
}

static tz_status check(tz_ctx *ctx, const tz_element_set *exemplar,
                       const tz_element_set *layout)
{
    tz_status s = tz_element_set_check(ctx, exemplar, "exemplar");
    if (s == TZ_OK)
        s = tz_element_set_check(ctx, layout, "layout");
    if (s != TZ_OK)
        return s;
    if (exemplar->element.n < 2 || layout->element.n < 2)
        return tz_fail(ctx, TZ_INVALID,
                       "likeness: %d elements in the exemplar and %d in the layout are "
                       "too few to have statistics; two are the least",
                       exemplar->element.n, layout->element.n);
    return TZ_OK;
}

tz_status tz_element_compare(tz_ctx *ctx, const tz_element_set *exemplar,
                             const tz_element_set *layout, tz_element_likeness *out)
{
    tz_status s = check(ctx, exemplar, layout);
    if (s != TZ_OK)
        return s;
    const tz_vec3 a = exemplar->domain.size, b = layout->domain.size;
    const double spacing = sqrt(a.x * a.y / exemplar->element.n);
    const int32_t quarter = exemplar->element.n / 4;
    const scale c = {.spacing = spacing,
                     /* as far apart as all domains, and the halves, can hold */
                     .reach = fmin(4 * spacing, 0.45 * fmin(fmin(0.5 * a.x, 0.5 * a.y),
                                                            fmin(b.x, b.y))),
                     /* half of what a half holds: larger ones would be mostly cut */
                     .near = quarter > 1 ? quarter : 1};
    const tz_vec2 zero = {0, 0}, one = {1, 1};
    tz_field e = {0}, l = {0};
    differences found, own;
    tz_element_likeness v = {0};
    s = tz_field_init(ctx, &e, exemplar, zero, one);
    if (s == TZ_OK)
        s = tz_field_init(ctx, &l, layout, zero, one);
    if (s == TZ_OK)
        s = compare_halves(ctx, exemplar, &c, &own);
    if (s == TZ_OK)
        s = compare(&l, &e, &c, &found);
    if (s == TZ_OK)
        s = tz_field_overlaps(&e, &v.overlaps[0]);
    if (s == TZ_OK)
        s = tz_field_overlaps(&l, &v.overlaps[1]);
    if (s == TZ_OK)
        s = tz_field_hole(&e, &v.hole[0]);
    if (s == TZ_OK)
        s = tz_field_hole(&l, &v.hole[1]);
    if (s == TZ_OK) {
        rate(&found, &own, spacing, any_oriented(&e) || any_oriented(&l), &v);
        const double density = tz_element_density(exemplar, false);
        v.density = density > 0 ? tz_element_density(layout, false) / density : 1;
        *out = v;
    }
    tz_field_deinit(&e);
    tz_field_deinit(&l);
    return s;
}
