/* SPDX-License-Identifier: Apache-2.0 */
/* Likeness: each difference between layout and exemplar over the same difference between
 * parts of the exemplar that do not overlap. These are its halves, and pairs of quarters
 * (one of each half, moved along it at random), whose differences count sqrt(1/2), as
 * those of samples of half the size do. The quarters are for lattices: aligned halves are
 * equal there, windows elsewhere show by how much a window may differ that is cut
 * anywhere. What no eye sees, and one node more or less, is an error of its own:
 *
 *   ratio = difference / sqrt(own difference^2 + allowance^2)
 *
 * A layout smaller than a half varies more than it: the own difference is then the larger,
 * by the root of (1 / areas of the two) against that of two halves. */
#include "curves/curve_compare.h"

#include <string.h>

#include "base/rng.h"
#include "curves/curve_statistics.h"

enum { MEASURES = 8, HALVES = 4, QUARTERS = 8, WINDOWS = HALVES + 2 * QUARTERS };
enum { DEGREES, ENDS, EDGES, TURNING, ORIENTATION, DENSITY, CELLS, PATCHES };

/* What is too small to matter. */
static const double allowance[MEASURES] = {
    [DEGREES] = 0.05,     [ENDS] = 0.005,   [EDGES] = 0.02, [TURNING] = 0.01,
    [ORIENTATION] = 0.05, [DENSITY] = 0.02, [CELLS] = 0.03, [PATCHES] = 0.01};

typedef struct differences {
    double of[MEASURES]; /* NAN = does not apply */
} differences;

/* A window of a field with all that it is compared by. */
typedef struct view {
    const tz_linework_field *f;
    const tz_linework_raster *r;
    tz_linework_window w;
    tz_linework_statistics s;
    double cells[TZ_LINEWORK_AREAS];
} view;

struct tz_curve_standard {
    tz_ctx *ctx;
    const tz_curve_set *set;
    tz_linework_field field;
    tz_linework_raster raster;
    view whole;
    tz_vec2 widest; /* of cells */
    double nodes;   /* per length, that differences of nodes are over */
    differences own;
    double repeats;
};

static void look(const tz_curve_standard *k, const tz_linework_field *f,
                 const tz_linework_raster *r, tz_linework_window w, view *v)
{
    *v = (view){.f = f, .r = r, .w = w};
    tz_linework_statistics_of(f, w, &v->s);
    tz_linework_cells_of(f, r, w, k->widest, v->cells);
}

/* ---- differences -------------------------------------------------------------------- */

static double apart(const double *a, const double *b, int32_t n)
{
    double sum = 0;
    for (int32_t k = 0; k < n; k++)
        sum += fabs(a[k] - b[k]);
    return sum;
}

static double sum_of(const double *a, int32_t n)
{
    double sum = 0;
    for (int32_t k = 0; k < n; k++)
        sum += a[k];
    return sum;
}

/* Mean difference of cumulated shares. */
static double cumulated_apart(const double *a, const double *b, int32_t n)
{
    double sum = 0, up = 0;
    for (int32_t k = 0; k < n; k++) {
        up += a[k] - b[k];
        sum += fabs(up);
    }
    return sum / n;
}

static double rate(const tz_linework_statistics *s, double count)
{
    return s->length > 0 ? count / s->length : 0;
}

static double edges_apart(const tz_linework_statistics *a,
                          const tz_linework_statistics *b)
{
    double sum = 0, n = 0, least = 1;
    for (int k = 1; k <= TZ_LINEWORK_WAYS; k++) {
        if (isnan(a->survival[k]) || isnan(b->survival[k]))
            continue;
        sum += fabs(a->survival[k] - b->survival[k]);
        least = fmin(least, fmin(a->survival[k], b->survival[k]));
        n++;
    }
    return n > 0 && least < 1 ? sum / n : NAN;
}

/* Where lines are long enough to turn within the way in one of the two only, the places at
 * which they are count as if they turned half as far as can be. A way that few lines are
 * long enough for says little. */
static double turning_apart(const tz_linework_statistics *a,
                            const tz_linework_statistics *b)
{
    double sum = 0, all = 0;
    for (int k = 0; k < TZ_LINEWORK_LAGS; k++) {
        const double both = fmin(a->told[k], b->told[k]),
                     most = fmax(a->told[k], b->told[k]);
        sum += 0.5 * (most - both);
        if (both > 0)
            sum +=
                both * cumulated_apart(a->turning[k], b->turning[k], TZ_LINEWORK_ANGLES);
        all += most;
    }
    return all > 0 ? sum / all : NAN;
}

static double cells_apart(const view *a, const view *b)
{
    double sum = 0;
    if (a->cells[TZ_LINEWORK_AREAS - 1] < 0.02 && b->cells[TZ_LINEWORK_AREAS - 1] < 0.02)
        return NAN;
    for (int k = 0; k < TZ_LINEWORK_AREAS; k++)
        sum += fabs(a->cells[k] - b->cells[k]);
    /* of the eight doublings that cells of one pattern are spread over, at most */
    return fmin(1, sum / 16);
}

/* All but patches. */
static differences compare_views(const tz_curve_standard *k, const view *a, const view *b)
{
    const tz_linework_statistics *p = &a->s, *q = &b->s;
    differences d;
    double nodes = 0;
    for (int i = 0; i < TZ_CURVE_DEGREES; i++)
        nodes += fabs(rate(p, p->nodes[i]) - rate(q, q->nodes[i]));
    d.of[DEGREES] = nodes / k->nodes;
    d.of[ENDS] = fabs(rate(p, p->nodes[0]) - rate(q, q->nodes[0])) / k->nodes;
    d.of[EDGES] = edges_apart(p, q);
    d.of[TURNING] = turning_apart(p, q);
    d.of[ORIENTATION] = apart(p->orientation, q->orientation, TZ_LINEWORK_TURNS) / 2;
    d.of[DENSITY] = p->area > 0 && q->area > 0
                        ? fabs(p->length / p->area - q->length / q->area) *
                              k->whole.s.area / k->whole.s.length
                        : 1;
    d.of[CELLS] = cells_apart(a, b);
    d.of[PATCHES] = NAN;
    return d;
}

/* ---- the exemplar's own ------------------------------------------------------------- */

typedef struct mean {
    double sum[MEASURES], n[MEASURES];
} mean;

static void add(mean *m, const differences *d, double factor)
{
    for (int k = 0; k < MEASURES; k++) {
        if (isnan(d->of[k]))
            continue;
        m->sum[k] += factor * d->of[k];
        m->n[k]++;
    }
}

/* Halves: left, right, top, bottom; then pairs of quarters. */
static void list_windows(const tz_linework_field *f, tz_linework_window w[WINDOWS])
{
    const double x = f->domain.size.x, y = f->domain.size.y;
    tz_rng rng = tz_rng_make(2, 1);
    w[0] = (tz_linework_window){{0, 0}, {x / 2, y}};
    w[1] = (tz_linework_window){{x / 2, 0}, {x, y}};
    w[2] = (tz_linework_window){{0, 0}, {x, y / 2}};
    w[3] = (tz_linework_window){{0, y / 2}, {x, y}};
    for (int k = 0; k < QUARTERS; k++)
        for (int i = 0; i < 2; i++) {
            const double at = tz_rng_unit(&rng) / 2, side = i ? 0.5 : 0;
            const tz_vec2 lo = {x * (k & 1 ? at : side), y * (k & 1 ? side : at)};
            w[HALVES + 2 * k + i] =
                (tz_linework_window){lo, {lo.x + x / 2, lo.y + y / 2}};
        }
}

static tz_status compare_parts(tz_curve_standard *k)
{
    tz_linework_window w[WINDOWS];
    mean m = {{0}, {0}};
    differences none;
    tz_status s = TZ_OK;
    for (int i = 0; i < MEASURES; i++)
        none.of[i] = NAN;
    list_windows(&k->field, w);
    for (int i = 0; i < WINDOWS && s == TZ_OK; i += 2) {
        view a, b;
        look(k, &k->field, &k->raster, w[i], &a);
        look(k, &k->field, &k->raster, w[i + 1], &b);
        const differences d = compare_views(k, &a, &b);
        add(&m, &d, i < HALVES ? 1 : sqrt(0.5));
        if (i < HALVES) {
            differences p = none;
            s = tz_linework_patches(&k->field, &k->raster, w[i], &k->field, &k->raster,
                                    w[i + 1], &p.of[PATCHES]);
            add(&m, &p, 1);
        }
    }
    for (int i = 0; i < MEASURES; i++)
        k->own.of[i] = m.n[i] > 0 ? m.sum[i] / m.n[i] : 0;
    return s;
}

void tz_curve_standard_free(tz_curve_standard *k)
{
    if (!k)
        return;
    tz_linework_field_deinit(&k->field);
    tz_linework_raster_deinit(&k->raster);
    tz_free(k->ctx, k);
}

static double repeated_run(const tz_curve_set *s)
{
    return 0.25 * fmin(s->domain.size.x, s->domain.size.y);
}

static tz_status fill_standard(tz_curve_standard *k)
{
    tz_linework_scale scale;
    tz_status s = tz_linework_scale_of(k->ctx, k->set, &scale);
    if (s == TZ_OK)
        s = tz_linework_field_init(k->ctx, k->set, &scale, &k->field);
    if (s != TZ_OK)
        return s;
    s = tz_linework_raster_init(&k->field, &k->raster);
    if (s != TZ_OK)
        return s;
    const tz_vec3 size = k->field.domain.size;
    k->widest = (tz_vec2){size.x / 2, size.y / 2};
    look(k, &k->field, &k->raster, tz_linework_whole(&k->field), &k->whole);
    if (!(k->whole.s.length > 0))
        return tz_fail(k->ctx, TZ_INVALID,
                       "likeness: no line of the exemplar lies in its domain");
    k->nodes = fmax(rate(&k->whole.s, sum_of(k->whole.s.nodes, TZ_CURVE_DEGREES)),
                    1 / (20 * scale.unit));
    s = compare_parts(k);
    return s == TZ_OK
               ? tz_linework_repeats(k->ctx, k->set, repeated_run(k->set), &k->repeats)
               : s;
}

tz_status tz_curve_standard_new(tz_ctx *ctx, const tz_curve_set *exemplar,
                                tz_curve_standard **out)
{
    *out = NULL;
    tz_curve_standard *k = NULL;
    tz_status s = tz_curve_set_check(ctx, exemplar, "exemplar");
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &k, 1, sizeof *k);
    if (s != TZ_OK)
        return s;
    k->ctx = ctx;
    k->set = exemplar;
    s = fill_standard(k);
    if (s != TZ_OK)
        tz_curve_standard_free(k);
    else
        *out = k;
    return s;
}

/* ---- ratios ------------------------------------------------------------------------- */

/* By how much the own difference is to be larger for a small layout. */
static double growth(const tz_curve_standard *k, const view *v)
{
    const double share = v->s.area / k->whole.s.area;
    return share > 0 ? fmin(10, fmax(1, sqrt((1 + 1 / share) / 4))) : 1;
}

static double ratio(double found, double own, double small)
{
    if (isnan(found))
        return NAN;
    return fmin(TZ_CURVE_WORST, found / hypot(own, small));
}

/* One node more or less in a half or in the layout, as a difference of the measure. */
static double one_node(const tz_curve_standard *k, const view *v)
{
    return 1 / (k->nodes * fmin(k->whole.s.length / 2, v->s.length));
}

static bool has_nodes(const view *a, const view *b, int n)
{
    return sum_of(a->s.nodes, n) > 0 || sum_of(b->s.nodes, n) > 0;
}

static void rate_all(const tz_curve_standard *k, const view *v, differences d,
                     tz_curve_likeness *out)
{
    double *const to[MEASURES] = {[DEGREES] = &out->degrees,
                                  [ENDS] = &out->ends,
                                  [EDGES] = &out->edges,
                                  [TURNING] = &out->turning,
                                  [ORIENTATION] = &out->orientation,
                                  [DENSITY] = &out->density,
                                  [CELLS] = &out->cells,
                                  [PATCHES] = &out->patches};
    double sum = 0, n = 0;
    if (!has_nodes(&k->whole, v, TZ_CURVE_DEGREES))
        d.of[DEGREES] = NAN;
    if (!has_nodes(&k->whole, v, 1))
        d.of[ENDS] = NAN;
    for (int i = 0; i < MEASURES; i++) {
        const double node = i == DEGREES || i == ENDS ? one_node(k, v) : 0,
                     small = hypot(allowance[i], node);
        *to[i] = ratio(d.of[i], growth(k, v) * k->own.of[i], small);
        sum += isnan(*to[i]) ? 0 : *to[i];
        n += !isnan(*to[i]);
    }
    out->mean = n > 0 ? sum / n : 0;
}

static void fill_rates(const tz_linework_statistics *s, int i, tz_curve_likeness *out)
{
    const double all = sum_of(s->nodes, TZ_CURVE_DEGREES);
    out->length[i] = s->area > 0 ? s->length / s->area : 0;
    out->dangling[i] = rate(s, s->nodes[0]);
    for (int k = 0; k < TZ_CURVE_DEGREES; k++)
        out->degree[i][k] = all > 0 ? s->nodes[k] / all : 0;
}

tz_status tz_curve_standard_compare(const tz_curve_standard *k,
                                    const tz_curve_set *layout, tz_curve_likeness *out)
{
    tz_linework_field f = {0};
    tz_linework_raster r = {0};
    tz_curve_likeness l;
    tz_ctx *ctx = k->ctx;
    view v;
    memset(&l, 0, sizeof l);
    l.repeats_own = k->repeats;
    tz_status s = tz_curve_set_check(ctx, layout, "layout");
    if (s == TZ_OK)
        s = tz_linework_field_init(ctx, layout, &k->field.scale, &f);
    if (s == TZ_OK)
        s = tz_linework_raster_init(&f, &r);
    if (s != TZ_OK)
        goto done;
    look(k, &f, &r, tz_linework_whole(&f), &v);
    if (!(v.s.length > 0)) {
        s = tz_fail(ctx, TZ_INVALID, "likeness: the layout has no lines in its domain");
        goto done;
    }
    differences d = compare_views(k, &v, &k->whole);
    s = tz_linework_patches(&f, &r, v.w, &k->field, &k->raster, k->whole.w,
                            &d.of[PATCHES]);
    if (s == TZ_OK)
        s = tz_linework_repeats(ctx, layout, repeated_run(k->set), &l.repeats);
    if (s != TZ_OK)
        goto done;
    rate_all(k, &v, d, &l);
    fill_rates(&k->whole.s, 0, &l);
    fill_rates(&v.s, 1, &l);
    l.degree_off = apart(l.degree[0], l.degree[1], TZ_CURVE_DEGREES) / 2;
    *out = l;
done:
    tz_linework_field_deinit(&f);
    tz_linework_raster_deinit(&r);
    return s;
}

tz_status tz_curve_compare(tz_ctx *ctx, const tz_curve_set *exemplar,
                           const tz_curve_set *layout, tz_curve_likeness *out)
{
    tz_curve_standard *k = NULL;
    tz_status s = tz_curve_standard_new(ctx, exemplar, &k);
    if (s == TZ_OK)
        s = tz_curve_standard_compare(k, layout, out);
    tz_curve_standard_free(k);
    return s;
}
