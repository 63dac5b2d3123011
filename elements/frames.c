/* SPDX-License-Identifier: Apache-2.0 */
/* Directions over a domain. Strokes say them at the cells they pass; elsewhere they are
 * the membrane through these, each component by itself:
 *
 *   min  sum over neighbouring cells |u - u'|^2  +  sum over known cells  K |u - known|^2
 *
 * then brought to length 1. Signs count: a stroke points where it goes. Where directions
 * meet that cancel each other, a singularity stays, as it must (a whirl has one). */
#include "elements/frames.h"

#include "base/lsq.h"
#include "elements/formula.h"
#include "elements/guide.h"

enum {
    SIDE = 512,       /* cells along the longer side where all is known */
    SIDE_SOLVED = 256 /* where it is solved for */
};
#define KNOWN 30.0 /* square root of K: 1e-3 of what a neighbour says is left */

void tz_frames_free(tz_frames *f)
{
    if (!f)
        return;
    tz_ctx *ctx = f->ctx;
    tz_free(ctx, f->x);
    tz_free(ctx, f->y);
    tz_free(ctx, f);
}

/* All vectors 0: not known. */
static tz_status make(tz_ctx *ctx, tz_raster raster, tz_frames **out)
{
    tz_frames *f = NULL;
    const size_t n = (size_t)raster.width * (size_t)raster.height;
    tz_status s = tz_alloc_zero(ctx, &f, 1, sizeof *f);
    if (s != TZ_OK)
        return s;
    f->raster = raster;
    f->ctx = ctx;
    s = tz_alloc_zero(ctx, &f->x, n, sizeof *f->x);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &f->y, n, sizeof *f->y);
    if (s != TZ_OK)
        tz_frames_free(f);
    else
        *out = f;
    return s;
}

/* ---- spreading ------------------------------------------------------------------- */

static bool known(const tz_frames *f, int32_t i) { return f->x[i] != 0 || f->y[i] != 0; }

static tz_status tie(tz_lsq *l, int32_t i, int32_t j)
{
    const int32_t index[2] = {i, j};
    const double c[2] = {1, -1}, none[2] = {0, 0};
    return i == j ? TZ_OK : tz_lsq_add(l, 2, index, c, none, 1);
}

static tz_status add_equations(tz_lsq *l, const tz_frames *f)
{
    const tz_raster *r = &f->raster;
    tz_status s = TZ_OK;
    for (int32_t j = 0; j < r->height; j++)
        for (int32_t i = 0; i < r->width && s == TZ_OK; i++) {
            const int32_t at = j * r->width + i;
            if (i + 1 < r->width || r->torus)
                s = tie(l, at, j * r->width + (i + 1) % r->width);
            if (s == TZ_OK && (j + 1 < r->height || r->torus))
                s = tie(l, at, (j + 1) % r->height * r->width + i);
            if (s == TZ_OK && known(f, at)) {
                const double one = 1, to[2] = {(double)f->x[at], (double)f->y[at]};
                s = tz_lsq_add(l, 1, &at, &one, to, KNOWN);
            }
        }
    return s;
}

static void set_unit(tz_frames *f, int32_t i, double x, double y)
{
    const double l = hypot(x, y);
    f->x[i] = l > 0 ? (float)(x / l) : 1;
    f->y[i] = l > 0 ? (float)(y / l) : 0;
}

static tz_status spread(tz_frames *f)
{
    const int32_t n = f->raster.width * f->raster.height;
    tz_lsq *l = NULL;
    double *u = NULL;
    tz_status s = tz_alloc(f->ctx, &u, (size_t)n * 2, sizeof *u);
    if (s == TZ_OK)
        s = tz_lsq_new(f->ctx, n, 2, &l);
    if (s == TZ_OK)
        s = add_equations(l, f);
    if (s == TZ_OK)
        s = tz_lsq_solve(l, u);
    for (int32_t i = 0; i < n && s == TZ_OK; i++)
        set_unit(f, i, u[i], u[n + i]);
    tz_lsq_free(l);
    tz_free(f->ctx, u);
    return s;
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

/* ---- strokes --------------------------------------------------------------------- */

/* Half a cell at a time, so that no cell on the way is missed. */
static void draw_segment(tz_frames *f, tz_vec2 p, tz_vec2 q)
{
    const tz_raster *r = &f->raster;
    const double cell = r->size.x / r->width;
    const tz_vec2 v = tz_vec2_sub(q, p);
    const double l = tz_vec2_length(v);
    const double steps = fmin(ceil(2 * l / cell), 4.0 * (r->width + r->height));
    if (!(l > 0))
        return;
    for (int32_t k = 0; k <= (int32_t)steps; k++) {
        const double t = k / fmax(steps, 1);
        const tz_vec3 at = {p.x + t * v.x, p.y + t * v.y, 0};
        if (!r->torus && (at.x < 0 || at.y < 0 || at.x >= r->size.x || at.y >= r->size.y))
            continue;
        const int64_t i = tz_raster_at(r, at);
        f->x[i] += (float)(v.x / l);
        f->y[i] += (float)(v.y / l);
    }
}

static tz_status draw_strokes(tz_frames *f, const tz_element_reader *r)
{
    tz_polys lines = {0};
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < r->part.n && s == TZ_OK; i++) {
        const tz_part *p = &r->part.v[i];
        s = tz_polys_add_path(f->ctx, &lines, r->verb.v + p->verb, p->verbs,
                              r->point.v + p->point, tz_affine_identity(),
                              0.1 * f->raster.size.x / f->raster.width);
    }
    for (int32_t k = 0; k < lines.part.n && s == TZ_OK; k++) {
        int32_t n;
        const tz_vec2 *v = tz_polys_part(&lines, k, &n);
        for (int32_t i = 0; i + !lines.closed.v[k] < n; i++)
            draw_segment(f, v[i], v[(i + 1) % n]);
    }
    tz_polys_deinit(f->ctx, &lines);
    return s;
}

/* Sums become units; true if something is known. */
static bool make_units(tz_frames *f, bool *all)
{
    const int32_t n = f->raster.width * f->raster.height;
    int32_t count = 0;
    for (int32_t i = 0; i < n; i++) {
        if (hypot((double)f->x[i], (double)f->y[i]) < 1e-3)
            f->x[i] = f->y[i] = 0; /* strokes that cancel each other say nothing */
        if (!known(f, i))
            continue;
        count++;
        set_unit(f, i, (double)f->x[i], (double)f->y[i]);
    }
    *all = count == n;
    return count > 0;
}

static tz_status read_strokes(tz_ctx *ctx, const char *path, tz_raster raster,
                              tz_frames **out)
{
    tz_element_reader r;
    tz_status s = tz_guide_read_svg(ctx, path, raster.size, &r);
    bool all;
    if (s == TZ_OK)
        s = make(ctx, raster, out);
    if (s == TZ_OK)
        s = draw_strokes(*out, &r);
    if (s == TZ_OK && !make_units(*out, &all))
        s = tz_fail(
            ctx, TZ_INVALID,
            "%s: there are no strokes in view; draw some that directions follow%s", path,
            tz_guide_hint(&r));
    if (s == TZ_OK)
        s = spread(*out);
    tz_element_reader_deinit(&r);
    return s;
}

/* ---- pictures -------------------------------------------------------------------- */

/* What one pixel says; 0, 0 = nothing. */
static tz_vec2 vector_of(const tz_image *im, const float *p)
{
    const double blind = 0.02; /* nearer to 0 than an 8-bit picture can say */
    if (im->alpha >= 0 && p[im->alpha] < 0.5f)
        return (tz_vec2){0, 0};
    if (im->channels - (im->alpha >= 0) < 2) {
        const double angle = 2 * TZ_PI * (double)p[0];
        return (tz_vec2){cos(angle), sin(angle)};
    }
    const tz_vec2 v = {(double)p[0] - 0.5, (double)p[1] - 0.5};
    return tz_vec2_length(v) < blind ? (tz_vec2){0, 0} : v;
}

/* Means of what pixels say over each cell: angles cannot be averaged as numbers. */
static void add_pixels(tz_frames *f, const tz_image *im)
{
    const tz_raster *r = &f->raster;
    for (int32_t y = 0; y < im->height; y++)
        for (int32_t x = 0; x < im->width; x++) {
            const tz_vec2 v = vector_of(im, tz_image_at(im, x, y));
            const int32_t i = (int32_t)((int64_t)x * r->width / im->width);
            const int32_t j = (int32_t)((int64_t)y * r->height / im->height);
            f->x[(int64_t)j * r->width + i] += (float)v.x;
            f->y[(int64_t)j * r->width + i] += (float)v.y;
        }
}

static tz_status read_picture(tz_ctx *ctx, const char *path, tz_raster raster,
                              tz_frames **out)
{
    tz_image im;
    bool all = false;
    tz_status s = tz_guide_read_image(ctx, path, 16384, true, &im);
    for (int32_t side = SIDE; s == TZ_OK && !all; side = SIDE_SOLVED) {
        tz_raster r = raster;
        r.width = im.width < side ? im.width : side;
        r.height = im.height < side ? im.height : side;
        tz_frames_free(*out);
        *out = NULL;
        s = make(ctx, r, out);
        if (s == TZ_OK)
            add_pixels(*out, &im);
        if (s == TZ_OK && !make_units(*out, &all))
            s = tz_fail(ctx, TZ_INVALID,
                        "%s: it says no direction; red and green are to be x and y, 0.5 "
                        "is 0",
                        path);
        if (side == SIDE_SOLVED)
            break;
    }
    if (s == TZ_OK && !all)
        s = spread(*out);
    tz_image_deinit(&im);
    return s;
}

tz_status tz_frames_read(tz_ctx *ctx, const char *path, tz_vec3 size, bool torus,
                         tz_frames **out)
{
    tz_raster r = {0};
    tz_frames *f = NULL;
    *out = NULL;
    tz_status s = tz_guide_raster(ctx, size, torus, SIDE_SOLVED, &r);
    if (s == TZ_OK)
        s = tz_guide_is_svg(path) ? read_strokes(ctx, path, r, &f)
                                  : read_picture(ctx, path, r, &f);
    if (s != TZ_OK)
        tz_frames_free(f);
    else
        *out = f;
    return s;
}
