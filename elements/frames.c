/* SPDX-License-Identifier: Apache-2.0 */
/* Directions, sizes and densities over a domain. Strokes and images say them in some
 * cells; elsewhere they are the membrane through these, each component by itself, sizes by
 * their logarithms:
 *
 *   min  sum over neighbouring cells |u - u'|^2  +  sum over cells that say  K |u - said|^2
 *
 * Directions are then brought to length 1. Signs count: a stroke points where it goes.
 * Where directions meet that cancel each other, a singularity stays, as it must (a whirl
 * has one).
 *
 * K holds what is said with the largest weight W. What is said with less, w, is to have
 * the share w / W of the say at its place. Between heavy strokes a quarter of the domain
 * away on either side, L cells, the membrane pulls with 2 / L, so that
 *
 *   K / (K + 2 / L) = w / W    gives    K = (2 / L) (w / W) / (1 - w / W) */
#include "elements/frames.h"

#include "base/lsq.h"
#include "elements/field.h"
#include "elements/formula.h"
#include "elements/guide.h"

enum {
    SIDE = 512,       /* cells along the longer side where all is known */
    SIDE_SOLVED = 256 /* where it is solved for */
};
#define FIRM 900.0 /* K of the heaviest: 1e-3 of what a neighbour says is left */

void tz_frames_free(tz_frames *f)
{
    if (!f)
        return;
    tz_ctx *ctx = f->ctx;
    tz_free(ctx, f->x);
    tz_free(ctx, f->y);
    tz_free(ctx, f->size);
    tz_free(ctx, f->apart);
    tz_free(ctx, f);
}

/* All frames as the exemplar's. */
static tz_status make(tz_ctx *ctx, tz_raster raster, tz_frames **out)
{
    tz_frames *f = NULL;
    const size_t n = (size_t)raster.width * (size_t)raster.height;
    tz_status s = tz_alloc_zero(ctx, &f, 1, sizeof *f);
    if (s != TZ_OK)
        return s;
    *f = (tz_frames){.raster = raster, .apart_least = 1, .apart_most = 1, .ctx = ctx};
    s = tz_alloc(ctx, &f->x, n, sizeof *f->x);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &f->y, n, sizeof *f->y);
    for (size_t i = 0; i < n && s == TZ_OK; i++)
        f->x[i] = 1;
    if (s != TZ_OK)
        tz_frames_free(f);
    else
        *out = f;
    return s;
}

static void set_unit(tz_frames *f, int32_t i, double x, double y)
{
    const double l = hypot(x, y);
    f->x[i] = l > 0 ? (float)(x / l) : 1;
    f->y[i] = l > 0 ? (float)(y / l) : 0;
}

/* ---- what a field says, cell by cell ------------------------------------------------- */

/* One of the field's sayings, on a raster that may be coarser. */
typedef struct saying {
    int what, parts; /* of the field's three; numbers a cell */
    tz_raster raster;
    double *v;      /* parts * cells, part after part; after carry() everywhere */
    double *weight; /* 0 = nothing is said */
    double heaviest;
    bool all;
} saying;

static void value_of(const tz_element_field_cell *c, int what, double v[2])
{
    v[1] = 0;
    if (what == 0) {
        v[0] = (double)c->x, v[1] = (double)c->y;
    } else if (what == 1) {
        v[0] =
            log(fmin(fmax((double)c->size, TZ_FRAMES_LEAST_SIZE), TZ_FRAMES_MOST_SIZE));
    } else {
        v[0] = (double)c->density;
    }
}

/* Sums become means; strokes that cancel each other say nothing. */
static void settle(saying *q, const double *weights)
{
    const int32_t n = q->raster.width * q->raster.height;
    double *const v = q->v, *const firm = q->weight;
    q->all = true;
    q->heaviest = 0;
    for (int32_t i = 0; i < n; i++) {
        if (weights[i] > 0)
            v[i] /= weights[i];
        if (weights[i] > 0 && q->parts > 1) {
            const double x = v[i], y = v[n + i] / weights[i], l = hypot(x, y);
            if (l < 1e-3)
                firm[i] = 0;
            v[i] = l < 1e-3 ? 0 : x / l, v[n + i] = l < 1e-3 ? 0 : y / l;
        }
        q->all = q->all && firm[i] > 0;
        q->heaviest = fmax(q->heaviest, firm[i]);
    }
}

/* Means over the cells of a raster, each with the largest weight that is said in it. */
static tz_status listen(const tz_element_field *f, saying *q)
{
    const tz_raster *from = &f->raster, *to = &q->raster;
    const size_t n = (size_t)to->width * (size_t)to->height;
    double *weights = NULL, *v = NULL, *firm = NULL;
    tz_status s = tz_alloc_zero(f->ctx, &v, n * (size_t)q->parts, sizeof *v);
    if (s == TZ_OK)
        s = tz_alloc_zero(f->ctx, &firm, n, sizeof *firm);
    if (s == TZ_OK)
        s = tz_alloc_zero(f->ctx, &weights, n, sizeof *weights);
    for (int32_t j = 0; j < from->height && s == TZ_OK; j++)
        for (int32_t i = 0; i < from->width; i++) {
            const tz_element_field_cell *c = &f->cell[(int64_t)j * from->width + i];
            const int64_t at = (int64_t)j * to->height / from->height * to->width +
                               (int64_t)i * to->width / from->width;
            const double w = (double)c->weight[q->what];
            double said[2];
            if (!(w > 0))
                continue;
            value_of(c, q->what, said);
            v[at] += w * said[0];
            if (q->parts > 1)
                v[(int64_t)n + at] += w * said[1];
            weights[at] += w;
            firm[at] = fmax(firm[at], w);
        }
    q->v = v, q->weight = firm; /* forget() frees them */
    if (s == TZ_OK)
        settle(q, weights);
    tz_free(f->ctx, weights);
    return s;
}

static void forget(tz_ctx *ctx, saying *q)
{
    tz_free(ctx, q->v);
    tz_free(ctx, q->weight);
}

/* ---- carrying it over the domain ----------------------------------------------------- */

static tz_status tie(tz_lsq *l, int32_t i, int32_t j)
{
    const int32_t index[2] = {i, j};
    const double c[2] = {1, -1}, none[2] = {0, 0};
    return i == j ? TZ_OK : tz_lsq_add(l, 2, index, c, none, 1);
}

/* Square root of K. */
static double hold(const saying *q, int32_t at)
{
    const double share = q->weight[at] / q->heaviest;
    const int32_t side =
        q->raster.width > q->raster.height ? q->raster.width : q->raster.height;
    return sqrt(share < 1 ? fmin(FIRM, 8.0 / side * share / (1 - share)) : FIRM);
}

static tz_status add_equations(tz_lsq *l, const saying *q)
{
    const tz_raster *r = &q->raster;
    const int32_t n = r->width * r->height;
    tz_status s = TZ_OK;
    for (int32_t j = 0; j < r->height; j++)
        for (int32_t i = 0; i < r->width && s == TZ_OK; i++) {
            const int32_t at = j * r->width + i;
            if (i + 1 < r->width || r->torus)
                s = tie(l, at, j * r->width + (i + 1) % r->width);
            if (s == TZ_OK && (j + 1 < r->height || r->torus))
                s = tie(l, at, (j + 1) % r->height * r->width + i);
            if (s == TZ_OK && q->weight[at] > 0) {
                const double one = 1, to[2] = {q->v[at], q->parts > 1 ? q->v[n + at] : 0};
                s = tz_lsq_add(l, 1, &at, &one, to, hold(q, at));
            }
        }
    return s;
}

static tz_status carry(tz_ctx *ctx, saying *q)
{
    const int32_t n = q->raster.width * q->raster.height;
    tz_lsq *l = NULL;
    double *u = NULL;
    tz_status s = tz_alloc(ctx, &u, (size_t)n * (size_t)q->parts, sizeof *u);
    if (s == TZ_OK)
        s = tz_lsq_new(ctx, n, q->parts, &l);
    if (s == TZ_OK)
        s = add_equations(l, q);
    if (s == TZ_OK)
        s = tz_lsq_solve(l, u);
    tz_lsq_free(l);
    if (s == TZ_OK) {
        tz_free(ctx, q->v);
        q->v = u;
    } else {
        tz_free(ctx, u);
    }
    return s;
}

/* The raster that is solved on. */
static tz_raster coarser(tz_raster r)
{
    const int32_t side = r.width > r.height ? r.width : r.height;
    const int32_t k = (side + SIDE_SOLVED - 1) / SIDE_SOLVED;
    r.width = (r.width + k - 1) / k, r.height = (r.height + k - 1) / k;
    return r;
}

/* What is said, everywhere; q->heaviest is 0 where nothing is. */
static tz_status complete(const tz_element_field *f, saying *q)
{
    q->raster = f->raster;
    tz_status s = listen(f, q);
    if (s != TZ_OK || q->all || !(q->heaviest > 0))
        return s;
    forget(f->ctx, q);
    *q = (saying){.what = q->what, .parts = q->parts, .raster = coarser(f->raster)};
    s = listen(f, q);
    return s == TZ_OK && q->heaviest > 0 ? carry(f->ctx, q) : s;
}

/* ---- formulas -------------------------------------------------------------------- */

tz_status tz_frames_from_formula(tz_ctx *ctx, const char *formula, tz_vec3 size,
                                 bool torus, tz_frames **out)
{
    tz_raster r = {0};
    tz_formula formula_of = {0};
    tz_frames *f = NULL;
    *out = NULL;
    tz_status s = tz_guide_raster(ctx, size, torus, SIDE, &r);
    if (s == TZ_OK)
        s = tz_formula_parse(ctx, formula, &formula_of);
    if (s == TZ_OK)
        s = make(ctx, r, &f);
    if (s == TZ_OK)
        f->turned = true;
    for (int32_t i = 0; s == TZ_OK && i < r.width * r.height; i++) {
        const double x = (i % r.width + 0.5) / r.width * size.x;
        const double y = (i / r.width + 0.5) / r.height * size.y;
        const double angle =
            tz_formula_at(&formula_of, (tz_formula_place){x, y, size.x, size.y});
        if (!isfinite(angle))
            s = tz_fail(
                ctx, TZ_INVALID,
                "formula \"%.60s\" has no value at x = %g, y = %g; write one that "
                "has an angle everywhere",
                formula, x, y);
        set_unit(f, i, cos(angle * TZ_PI / 180), sin(angle * TZ_PI / 180));
    }
    tz_formula_deinit(ctx, &formula_of);
    if (s != TZ_OK)
        tz_frames_free(f);
    else
        *out = f;
    return s;
}

/* ---- fields -------------------------------------------------------------------------- */

static tz_status check_sizes(const tz_element_field *f)
{
    for (int32_t i = 0; i < f->point.n; i++) {
        const double size = f->point.v[i].size;
        if (size != 0 && !(size >= TZ_FRAMES_LEAST_SIZE && size <= TZ_FRAMES_MOST_SIZE))
            return tz_fail(f->ctx, TZ_INVALID,
                           "a stroke says size %g; arrangements follow sizes from %g to "
                           "%g",
                           size, TZ_FRAMES_LEAST_SIZE, TZ_FRAMES_MOST_SIZE);
    }
    return TZ_OK;
}

/* Value of a saying of one part at the middle of cell i of a raster. */
static double said_at(const saying *q, const tz_raster *r, int32_t i)
{
    const tz_raster *g = &q->raster;
    const double x = (i % r->width + 0.5) / r->width * g->width - 0.5,
                 y = ((double)(i / r->width) + 0.5) / r->height * g->height - 0.5;
    const int32_t c = (int32_t)floor(x), k = (int32_t)floor(y);
    double v[2];
    for (int b = 0; b < 2; b++) {
        const double *row =
            q->v + (int64_t)tz_raster_index(k + b, g->height, g->torus) * g->width;
        const double t = x - c;
        v[b] = (1 - t) * row[tz_raster_index(c, g->width, g->torus)] +
               t * row[tz_raster_index(c + 1, g->width, g->torus)];
    }
    return v[0] + (y - k) * (v[1] - v[0]);
}

/* @param q  sizes and densities, complete */
static tz_status set_sizes(tz_frames *f, const saying q[2])
{
    const int32_t n = f->raster.width * f->raster.height;
    float *size = NULL, *apart = NULL;
    const bool sized = q[0].heaviest > 0, thinned = q[1].heaviest > 0;
    if (!sized && !thinned)
        return TZ_OK;
    tz_status s = sized ? tz_alloc(f->ctx, &size, (size_t)n, sizeof *size) : TZ_OK;
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &apart, (size_t)n, sizeof *apart);
    if (s != TZ_OK) {
        tz_free(f->ctx, size);
        return s;
    }
    f->apart_least = HUGE_VAL, f->apart_most = 0;
    for (int32_t i = 0; i < n; i++) {
        const double c = sized ? exp(said_at(&q[0], &f->raster, i)) : 1;
        const double d = thinned ? said_at(&q[1], &f->raster, i) : 1;
        const double a = c / sqrt(fmin(fmax(d, TZ_FRAMES_LEAST_DENSITY), 1));
        if (sized)
            size[i] = (float)c;
        apart[i] = (float)a;
        f->apart_least = fmin(f->apart_least, a);
        f->apart_most = fmax(f->apart_most, a);
    }
    tz_free(f->ctx, f->size);
    tz_free(f->ctx, f->apart);
    f->size = size, f->apart = apart;
    f->thinned = thinned;
    return TZ_OK;
}

tz_status tz_frames_add_sizes(tz_frames *f, const tz_element_field *field)
{
    saying q[2] = {{.what = 1, .parts = 1}, {.what = 2, .parts = 1}};
    tz_status s = check_sizes(field);
    for (int k = 0; k < 2 && s == TZ_OK; k++)
        s = complete(field, &q[k]);
    if (s == TZ_OK)
        s = set_sizes(f, q);
    for (int k = 0; k < 2; k++)
        forget(field->ctx, &q[k]);
    return s;
}

void tz_frames_drop_sizes(tz_frames *f)
{
    tz_free(f->ctx, f->size);
    tz_free(f->ctx, f->apart);
    f->size = f->apart = NULL;
    f->apart_least = f->apart_most = 1;
    f->thinned = false;
}

tz_status tz_frames_from_field(const tz_element_field *field, tz_frames **out)
{
    saying q = {.what = 0, .parts = 2};
    tz_frames *f = NULL;
    *out = NULL;
    tz_status s = complete(field, &q);
    if (s == TZ_OK)
        s = make(field->ctx, q.raster, &f);
    const int32_t n = q.raster.width * q.raster.height;
    if (s == TZ_OK && q.heaviest > 0) {
        f->turned = true;
        for (int32_t i = 0; i < n; i++)
            set_unit(f, i, q.v[i], q.v[n + i]);
    }
    if (s == TZ_OK)
        s = tz_frames_add_sizes(f, field);
    if (s == TZ_OK && !f->turned && !f->apart)
        s = tz_fail(
            field->ctx, TZ_INVALID,
            "strokes and images say nothing in view; draw strokes that directions "
            "follow, or that say sizes or densities");
    forget(field->ctx, &q);
    if (s != TZ_OK)
        tz_frames_free(f);
    else
        *out = f;
    return s;
}

tz_status tz_frames_read(tz_ctx *ctx, const char *path, tz_vec3 size, bool torus,
                         tz_frames **out)
{
    tz_element_field field;
    *out = NULL;
    tz_status s = tz_element_field_read(ctx, path, size, torus, &field);
    if (s == TZ_OK)
        s = tz_frames_from_field(&field, out);
    tz_element_field_deinit(&field);
    return s;
}
