/* SPDX-License-Identifier: Apache-2.0 */
/* The two regions of a prediction, as masks over the drawing:
 *
 *   source    inside `from`, or outside `to` and not far from what is drawn there, so that
 *             paper that nobody has drawn on yet is no pattern
 *   complete  outside `to`, and about what is drawn inside of it
 *
 * "Near" is told by the drawing: its area over the length of its lines is the distance
 * from line to line, if they were parallel. */
#include <string.h>

#include "curves/predict_internal.h"

enum { SIDE = 512 }; /* cells along the drawing's longer side */
#define FAR  3.0     /* distances from line to line: beyond is blank paper */
#define ROOM 0.45    /* of it: kept clear about strokes inside `to` */

typedef struct mask {
    tz_ctx *ctx;
    tz_vec3 size;
    bool torus;
    int32_t width, height;
    float *v;
} mask;

static tz_vec3 centre(const mask *m, int32_t x, int32_t y)
{
    return (tz_vec3){(x + 0.5) / m->width * m->size.x, (y + 0.5) / m->height * m->size.y,
                     0};
}

static tz_status mask_init(tz_ctx *ctx, const tz_domain *d, mask *m)
{
    const double longer = fmax(d->size.x, d->size.y);
    *m = (mask){.ctx = ctx, .size = d->size, .torus = d->torus};
    m->width = (int32_t)fmax(1, ceil(SIDE * d->size.x / longer));
    m->height = (int32_t)fmax(1, ceil(SIDE * d->size.y / longer));
    return tz_alloc_zero(ctx, &m->v, (size_t)m->width * (size_t)m->height, sizeof *m->v);
}

/** Share of a cell inside a region, by the distance of its middle. */
static float share(const mask *m, const tz_region *r, tz_vec3 at)
{
    const double cell = m->size.x / m->width,
                 inside = 0.5 + tz_region_distance(r, at) / cell;
    return (float)fmin(1, fmax(0, inside));
}

/** Raises a disc to 1. */
static void stamp(mask *m, tz_vec2 at, double radius)
{
    const double cx = m->size.x / m->width, cy = m->size.y / m->height;
    const int32_t x0 = (int32_t)fmax(-SIDE, floor((at.x - radius) / cx)),
                  x1 = (int32_t)fmin(2 * SIDE, floor((at.x + radius) / cx)),
                  y0 = (int32_t)fmax(-SIDE, floor((at.y - radius) / cy)),
                  y1 = (int32_t)fmin(2 * SIDE, floor((at.y + radius) / cy));
    for (int32_t y = y0; y <= y1; y++)
        for (int32_t x = x0; x <= x1; x++) {
            const tz_vec3 c = centre(m, x, y);
            int32_t u = x, v = y;
            if (hypot(c.x - at.x, c.y - at.y) > radius)
                continue;
            if (m->torus) {
                u = tz_raster_index(x, m->width, true);
                v = tz_raster_index(y, m->height, true);
            }
            if (u >= 0 && v >= 0 && u < m->width && v < m->height)
                m->v[(int64_t)v * m->width + u] = 1;
        }
}

/** Length of what is drawn outside (or inside) `to`; with a mask, stamps it too. */
static double walk(const tz_curve_set *s, const tz_region *to, bool inside, mask *m,
                   double radius)
{
    const double step = fmax(s->domain.size.x, s->domain.size.y) / SIDE;
    double sum = 0;
    for (int32_t i = 0; i < s->piece.n; i++) {
        const tz_bezier c = tz_curve_bezier(s, &s->piece.v[i]);
        const double length = tz_bezier_length(&c);
        const int32_t n = (int32_t)fmin(4096, ceil(length / step)) + 1;
        for (int32_t k = 0; k < n; k++) {
            const tz_vec2 p = tz_bezier_at(&c, (k + 0.5) / n);
            const tz_vec3 at = tz_domain_wrap(&s->domain, (tz_vec3){p.x, p.y, 0});
            if ((tz_region_distance(to, at) > 0) != inside)
                continue;
            sum += length / n;
            if (m)
                stamp(m, (tz_vec2){at.x, at.y}, radius);
        }
    }
    return sum;
}

/** Distance from line to line: area of the box of what is drawn outside, over length. */
static double spacing_of(const tz_curve_set *s, const tz_region *to, double length)
{
    tz_vec2 lo = {INFINITY, INFINITY}, hi = {-INFINITY, -INFINITY};
    for (int32_t i = 0; i < s->node.n; i++) {
        const tz_vec2 p = s->node.v[i];
        if (tz_region_distance(to, (tz_vec3){p.x, p.y, 0}) > 0)
            continue;
        lo = (tz_vec2){fmin(lo.x, p.x), fmin(lo.y, p.y)};
        hi = (tz_vec2){fmax(hi.x, p.x), fmax(hi.y, p.y)};
    }
    const double w = fmin(hi.x, s->domain.size.x) - fmax(lo.x, 0),
                 h = fmin(hi.y, s->domain.size.y) - fmax(lo.y, 0);
    double area = 0;
    for (int32_t j = 0; j < 32; j++) /* less what `to` takes of the box */
        for (int32_t i = 0; i < 32; i++) {
            const tz_vec3 at = {fmax(lo.x, 0) + (i + 0.5) / 32 * w,
                                fmax(lo.y, 0) + (j + 0.5) / 32 * h, 0};
            area += tz_region_distance(to, at) <= 0;
        }
    area *= fmax(w, 0) * fmax(h, 0) / 1024;
    return fmax(area / length, fmax(s->domain.size.x, s->domain.size.y) / SIDE);
}

static tz_status no_source(tz_ctx *ctx, const tz_curve_predict_job *job)
{
    return tz_fail(ctx, TZ_INVALID,
                   job->from
                       ? "nothing is drawn in the region to clone from (outside the "
                         "one to fill); draw there, or name another region"
                       : "nothing is drawn outside the region to complete; draw "
                         "around it, or make the region smaller");
}

static tz_status make_source(tz_ctx *ctx, const tz_curve_predict_job *job, mask *m,
                             double spacing, tz_region **out)
{
    const tz_curve_set *s = job->drawing;
    int64_t cells = 0;
    if (!job->from)
        walk(s, job->to, false, m,
             fmin(FAR * spacing, 0.25 * fmax(m->size.x, m->size.y)));
    for (int32_t y = 0; y < m->height; y++)
        for (int32_t x = 0; x < m->width; x++) {
            const tz_vec3 at = centre(m, x, y);
            float *v = &m->v[(int64_t)y * m->width + x];
            const float from = job->from ? share(m, job->from, at) : *v;
            *v = fminf(from, 1 - share(m, job->to, at));
            cells += *v > 0.5f;
        }
    if (cells == 0)
        return no_source(ctx, job);
    return tz_region_from_mask(ctx, m->v, m->width, m->height, m->size, m->torus, out);
}

static tz_status make_complete(tz_ctx *ctx, const tz_curve_predict_job *job, mask *m,
                               double spacing, tz_region **out)
{
    int64_t open = 0, closed = 0;
    memset(m->v, 0, (size_t)m->width * (size_t)m->height * sizeof *m->v);
    walk(job->drawing, job->to, true, m, ROOM * spacing);
    for (int32_t y = 0; y < m->height; y++)
        for (int32_t x = 0; x < m->width; x++) {
            float *v = &m->v[(int64_t)y * m->width + x];
            *v = fmaxf(*v, 1 - share(m, job->to, centre(m, x, y)));
            open += *v < 0.5f;
            closed += *v > 0.5f;
        }
    if (open == 0)
        return tz_fail(ctx, TZ_INVALID,
                       "there is no room in the region: it lies outside the drawing, or "
                       "strokes fill it already");
    if (closed == 0)
        return tz_fail(ctx, TZ_INVALID,
                       "the region covers the whole drawing, which leaves nothing to go "
                       "by; make it smaller");
    return tz_region_from_mask(ctx, m->v, m->width, m->height, m->size, m->torus, out);
}

tz_status tz_predict_regions(tz_ctx *ctx, const tz_curve_predict_job *job,
                             tz_region **source, tz_region **complete, double *spacing)
{
    mask m;
    tz_region *from = NULL, *done = NULL;
    *source = *complete = NULL;
    tz_status s = mask_init(ctx, &job->drawing->domain, &m);
    if (s != TZ_OK)
        return s;
    const double length = walk(job->drawing, job->to, false, NULL, 0);
    if (!(length > 0)) {
        s = no_source(ctx, job);
        goto done;
    }
    *spacing = spacing_of(job->drawing, job->to, length);
    s = make_source(ctx, job, &m, *spacing, &from);
    if (s == TZ_OK)
        s = make_complete(ctx, job, &m, *spacing, &done);
    if (s == TZ_OK) {
        *source = from;
        *complete = done;
        from = done = NULL;
    }
done:
    tz_region_free(from);
    tz_region_free(done);
    tz_free(ctx, m.v);
    return s;
}
