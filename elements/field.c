/* SPDX-License-Identifier: Apache-2.0 */
/* Fields as data: strokes, and the cells that they and images make. Drawings and images are
 * read in elements/field_read.c.
 *
 * The nearest cell that says something is found exactly, by two passes of lower envelopes
 * of parabolas (first along columns, then along rows).
 * @source Felzenszwalb, Huttenlocher, Distance transforms of sampled functions, 2012 */
#include "elements/field.h"

#include <float.h>
#include <string.h>

#include "elements/guide.h"

enum { SIDE = 512, MOST_SIDE = 4096, MOST_POINTS = 10000000, MOST_LOOKS = 400000000 };

tz_status tz_element_field_init(tz_ctx *ctx, tz_vec3 size, bool torus, int32_t side,
                                tz_element_field *f)
{
    *f = (tz_element_field){.ctx = ctx};
    if (side < 0 || side > MOST_SIDE)
        return tz_fail(ctx, TZ_INVALID, "a field may have 1 to %d cells a side, not %d",
                       MOST_SIDE, side);
    tz_status s = tz_guide_raster(ctx, size, torus, side ? side : SIDE, &f->raster);
    if (s == TZ_OK)
        s = tz_element_field_settle(f);
    if (s != TZ_OK)
        tz_element_field_deinit(f);
    return s;
}

void tz_element_field_deinit(tz_element_field *f)
{
    tz_array_free(f->ctx, &f->stroke);
    tz_array_free(f->ctx, &f->point);
    tz_free(f->ctx, f->image);
    tz_free(f->ctx, f->cell);
    for (int k = 0; k < 3; k++)
        tz_free(f->ctx, f->nearest[k]);
    *f = (tz_element_field){0};
}

/* ---- strokes ------------------------------------------------------------------------ */

static tz_status check(tz_ctx *ctx, const tz_element_field_stroke *s, int32_t n,
                       const tz_element_field_point *p)
{
    const double least = TZ_ELEMENT_FIELD_LEAST_SIZE, most = TZ_ELEMENT_FIELD_MOST_SIZE;
    if (n < 1)
        return tz_fail(ctx, TZ_INVALID, "a stroke has no point");
    if (!(s->radius >= 0) || !isfinite(s->radius) || !(s->weight > 0) ||
        !(s->weight <= TZ_ELEMENT_FIELD_MOST_WEIGHT))
        return tz_fail(ctx, TZ_INVALID,
                       "a stroke has radius %g and weight %g; the radius must be 0 or "
                       "more, the weight above 0 and at most %g",
                       s->radius, s->weight, TZ_ELEMENT_FIELD_MOST_WEIGHT);
    for (int32_t i = 0; i < n; i++) {
        if (!isfinite(p[i].at.x) || !isfinite(p[i].at.y))
            return tz_fail(ctx, TZ_INVALID, "point %d of a stroke is not a number", i);
        if (!(p[i].size == 0 || (p[i].size >= least && p[i].size <= most)) ||
            !(p[i].density <= 1))
            return tz_fail(ctx, TZ_INVALID,
                           "a stroke has size %g and density %g; the size must be "
                           "between %g and %g, the density between 0 and 1",
                           p[i].size, p[i].density, least, most);
    }
    return TZ_OK;
}

tz_status tz_element_field_add(tz_element_field *f, tz_element_field_stroke s, int32_t n,
                               const tz_element_field_point *point)
{
    tz_status st = check(f->ctx, &s, n, point);
    if (st == TZ_OK && (int64_t)f->point.n + n > MOST_POINTS)
        st = tz_fail(f->ctx, TZ_LIMIT, "a field has over %d points of strokes",
                     MOST_POINTS);
    if (st == TZ_OK)
        st = tz_array_reserve(f->ctx, &f->point, (int64_t)f->point.n + n);
    s.point = f->point.n, s.points = n;
    if (st == TZ_OK)
        st = tz_array_push(f->ctx, &f->stroke, s);
    for (int32_t i = 0; i < n && st == TZ_OK; i++)
        f->point.v[f->point.n++] = point[i];
    return st;
}

static double to_segment(tz_vec2 p, tz_vec2 a, tz_vec2 b, double *t)
{
    const tz_vec2 d = tz_vec2_sub(b, a), v = tz_vec2_sub(p, a);
    const double l = tz_vec2_dot(d, d);
    *t = l > 0 ? fmin(fmax(tz_vec2_dot(v, d) / l, 0), 1) : 0;
    return hypot(v.x - *t * d.x, v.y - *t * d.y);
}

static bool meets(const tz_element_field *f, const tz_element_field_stroke *s, tz_vec2 at,
                  double radius)
{
    const tz_element_field_point *p = f->point.v + s->point;
    double t;
    for (int32_t i = 0; i < s->points; i++)
        if (to_segment(at, p[i].at,
                       p[i + 1 < s->points ? i + 1
                         : s->closed       ? 0
                                           : i]
                           .at,
                       &t) <= radius + s->radius)
            return true;
    return false;
}

void tz_element_field_erase(tz_element_field *f, tz_vec2 at, double radius)
{
    int32_t strokes = 0, points = 0;
    for (int32_t k = 0; k < f->stroke.n; k++) {
        tz_element_field_stroke s = f->stroke.v[k];
        if (meets(f, &s, at, radius))
            continue;
        memmove(f->point.v + points, f->point.v + s.point,
                (size_t)s.points * sizeof *f->point.v);
        s.point = points, points += s.points;
        f->stroke.v[strokes++] = s;
    }
    f->stroke.n = strokes, f->point.n = points;
}

tz_status tz_element_field_place(tz_element_field *f, const tz_element_field *preset,
                                 tz_affine map)
{
    const double scale = sqrt(fabs(tz_affine_det(map)));
    const int32_t strokes = f->stroke.n, points = f->point.n;
    tz_status s = TZ_OK;
    if (!tz_affine_finite(map) || !(scale > 0))
        return tz_fail(f->ctx, TZ_INVALID, "strokes are placed by a map of no area");
    const int32_t n = preset->stroke.n; /* it may be f itself */
    for (int32_t k = 0; k < n && s == TZ_OK; k++) {
        tz_element_field_stroke t = preset->stroke.v[k];
        const int32_t from = t.point;
        t.radius *= scale;
        t.point = f->point.n;
        if ((int64_t)f->point.n + t.points > MOST_POINTS)
            s = tz_fail(f->ctx, TZ_LIMIT, "a field has over %d points of strokes",
                        MOST_POINTS);
        else
            s = tz_array_reserve(f->ctx, &f->point, (int64_t)f->point.n + t.points);
        for (int32_t i = 0; i < t.points && s == TZ_OK; i++) {
            tz_element_field_point p = preset->point.v[from + i];
            p.at = tz_affine_apply(map, p.at);
            f->point.v[f->point.n++] = p;
        }
        if (s == TZ_OK)
            s = tz_array_push(f->ctx, &f->stroke, t);
    }
    if (s != TZ_OK)
        f->stroke.n = strokes, f->point.n = points;
    return s;
}

/* ---- cells -------------------------------------------------------------------------- */

/* A piece of a stroke: its ends, and which way the stroke points there. */
typedef struct piece {
    tz_element_field_point a, b;
    tz_vec2 from, to;
} piece;

static void say(tz_element_field_cell *c, const tz_element_field_stroke *s,
                const piece *q, double t)
{
    const tz_element_field_point *a = &q->a, *b = &q->b;
    const tz_vec2 d = {q->from.x + t * (q->to.x - q->from.x),
                       q->from.y + t * (q->to.y - q->from.y)};
    const double l = tz_vec2_length(d);
    const float w = fmaxf((float)s->weight, FLT_MIN);
    if (s->directed && l > 0)
        c->x = (float)(d.x / l), c->y = (float)(d.y / l), c->weight[0] = w;
    if (a->size > 0 && b->size > 0)
        c->size = (float)(a->size + t * (b->size - a->size)), c->weight[1] = w;
    if (a->density >= 0 && b->density >= 0)
        c->density = (float)(a->density + t * (b->density - a->density)),
        c->weight[2] = w;
}

/* Which stroke spoke last in a cell, and from how far. */
typedef struct claim {
    float distance;
    int32_t stroke;
} claim;

/* Cells under a piece of a stroke. Of a stroke's own pieces the nearest one speaks; a later
 * stroke overrules. Returns how many cells were looked at. */
static int64_t draw_piece(tz_element_field *f, claim *claims, int32_t stroke,
                          const piece *q)
{
    const tz_raster *r = &f->raster;
    const tz_element_field_stroke *s = &f->stroke.v[stroke];
    const tz_element_field_point *a = &q->a, *b = &q->b;
    const double cx = r->size.x / r->width, cy = r->size.y / r->height;
    const double reach = fmax(s->radius, 0.75 * fmax(cx, cy));
    const double x[2] = {fmin(a->at.x, b->at.x) - reach, fmax(a->at.x, b->at.x) + reach};
    const double y[2] = {fmin(a->at.y, b->at.y) - reach, fmax(a->at.y, b->at.y) + reach};
    const double few = r->torus ? 1 : 0; /* periods beyond the domain that count */
    const int32_t x0 = (int32_t)fmin(fmax(floor(x[0] / cx), -few * r->width), 1 << 16);
    const int32_t x1 = (int32_t)fmax(fmin(x[1] / cx, (few + 1) * r->width - 1), -1e6);
    const int32_t y0 = (int32_t)fmin(fmax(floor(y[0] / cy), -few * r->height), 1 << 16);
    const int32_t y1 = (int32_t)fmax(fmin(y[1] / cy, (few + 1) * r->height - 1), -1e6);
    for (int32_t j = y0; j <= y1; j++)
        for (int32_t i = x0; i <= x1; i++) {
            double t;
            const tz_vec2 at = {(i + 0.5) * cx, (j + 0.5) * cy};
            const double d = to_segment(at, a->at, b->at, &t);
            const int64_t k =
                (int64_t)tz_raster_index(j, r->height, r->torus) * r->width +
                tz_raster_index(i, r->width, r->torus);
            if (d > reach || (claims[k].stroke == stroke && claims[k].distance <= d))
                continue;
            claims[k] = (claim){(float)d, stroke};
            say(&f->cell[k], s, q, t);
        }
    return 16 + (x1 < x0 || y1 < y0 ? 0 : (int64_t)(x1 - x0 + 1) * (y1 - y0 + 1));
}

/* A long piece in parts, or its box would hold far more cells than it passes. */
static int64_t draw_parts(tz_element_field *f, claim *claims, int32_t stroke,
                          const piece *q)
{
    const tz_raster *r = &f->raster;
    const tz_element_field_point *a = &q->a, *b = &q->b;
    const double cell = fmax(r->size.x / r->width, r->size.y / r->height);
    const double l = hypot(b->at.x - a->at.x, b->at.y - a->at.y);
    const double step = 4 * fmax(f->stroke.v[stroke].radius, 2 * cell);
    const int32_t parts = (int32_t)fmin(fmax(ceil(l / step), 1), 8192);
    int64_t looked = 0;
    for (int32_t k = 0; k < parts; k++) {
        piece part;
        for (int e = 0; e < 2; e++) {
            const double t = (double)(k + e) / parts;
            tz_element_field_point *end = e ? &part.b : &part.a;
            end->at = tz_vec2_add(a->at, tz_vec2_scale(tz_vec2_sub(b->at, a->at), t));
            end->size =
                a->size > 0 && b->size > 0 ? a->size + t * (b->size - a->size) : 0;
            end->density = a->density >= 0 && b->density >= 0
                               ? a->density + t * (b->density - a->density)
                               : -1;
            *(e ? &part.to : &part.from) =
                tz_vec2_add(q->from, tz_vec2_scale(tz_vec2_sub(q->to, q->from), t));
        }
        looked += draw_piece(f, claims, stroke, &part);
    }
    return looked;
}

static tz_vec2 unit_between(tz_vec2 a, tz_vec2 b, double *length)
{
    const tz_vec2 d = tz_vec2_sub(b, a);
    *length = tz_vec2_length(d);
    return *length > 0 ? tz_vec2_scale(d, 1 / *length) : (tz_vec2){0, 0};
}

/* Which way a stroke points at the end of one of its pieces where another goes on: pieces
 * stand for a curve, whose tangent turns through their common end, if an arc that turns as
 * much would leave neither by a cell. Else there is a corner, and the piece keeps its own. */
static tz_vec2 tangent_at(const tz_element_field *f, tz_vec2 own, double l, tz_vec2 next,
                          double m)
{
    const double cell = f->raster.size.x / f->raster.width;
    const double turn =
        fabs(atan2(own.x * next.y - own.y * next.x, tz_vec2_dot(own, next)));
    if (!(l > 0) || !(m > 0) || turn > 1 || turn * fmax(l, m) > 8 * cell)
        return own;
    /* the arc through both: its turn falls to them by their lengths */
    tz_vec2 t = tz_vec2_add(tz_vec2_scale(own, m), tz_vec2_scale(next, l));
    return tz_vec2_scale(t, 1 / tz_vec2_length(t));
}

/* Piece i of a stroke, with directions at its ends. */
static piece piece_of(const tz_element_field *f, const tz_element_field_stroke *s,
                      int32_t i)
{
    const tz_element_field_point *p = f->point.v + s->point;
    const int32_t n = s->points;
    piece q = {.a = p[i], .b = p[(i + 1) % n]};
    double l, m;
    const tz_vec2 own = unit_between(q.a.at, q.b.at, &l);
    q.from = q.to = own;
    if (i > 0 || s->closed) {
        const tz_vec2 last = unit_between(p[(i + n - 1) % n].at, q.a.at, &m);
        q.from = tangent_at(f, own, l, last, m);
    }
    if (i + 2 < n || s->closed) {
        const tz_vec2 next = unit_between(q.b.at, p[(i + 2) % n].at, &m);
        q.to = tangent_at(f, own, l, next, m);
    }
    return q;
}

static tz_status draw_strokes(tz_element_field *f)
{
    const size_t n = (size_t)f->raster.width * (size_t)f->raster.height;
    claim *claims = NULL;
    if (f->stroke.n == 0)
        return TZ_OK;
    tz_status s = tz_alloc(f->ctx, &claims, n, sizeof *claims);
    for (size_t i = 0; i < n && s == TZ_OK; i++)
        claims[i] = (claim){0, -1};
    int64_t looked = 0;
    for (int32_t k = 0; k < f->stroke.n && s == TZ_OK; k++) {
        const tz_element_field_stroke *t = &f->stroke.v[k];
        const int32_t pieces = t->points == 1 ? 1 : t->points - !t->closed;
        for (int32_t i = 0; i < pieces && looked <= MOST_LOOKS; i++) {
            const piece q = piece_of(f, t, i);
            looked += draw_parts(f, claims, k, &q);
        }
        if (looked > MOST_LOOKS)
            s = tz_fail(f->ctx, TZ_LIMIT,
                        "strokes cover the field too many times over; draw fewer, or "
                        "thinner ones");
        else if (tz_ctx_cancelled(f->ctx))
            s = TZ_CANCELLED;
    }
    tz_free(f->ctx, claims);
    return s;
}

/* ---- the nearest that says something ------------------------------------------------ */

/* Lower envelope of parabolas h[q] + (x - q)^2 over one line; from[q] is handed on. */
typedef struct envelope {
    int32_t *v;
    double *z;
} envelope;

static void sweep_line(const tz_raster *r, int32_t n, double side, const double *h,
                       const int32_t *from, envelope *e, double *out, int32_t *to)
{
    const int32_t lo = r->torus ? -n : 0, hi = r->torus ? 2 * n : n;
    int32_t top = -1;
    for (int32_t q = lo; q < hi; q++) {
        const double g = h[(q + n) % n];
        double z = -HUGE_VAL;
        if (g == HUGE_VAL)
            continue;
        for (; top >= 0; top--) {
            const double p = e->v[top], k = h[(e->v[top] + n) % n];
            z = ((g - k) / (side * side) + (double)q * q - p * p) / (2 * (q - p));
            if (z > e->z[top])
                break;
            z = -HUGE_VAL;
        }
        e->v[++top] = q, e->z[top] = z;
    }
    for (int32_t q = 0, k = 0; q < n; q++) {
        while (k < top && e->z[k + 1] < q)
            k++;
        const double d = top >= 0 ? (q - e->v[k]) * side : 0;
        out[q] = top >= 0 ? h[(e->v[k] + n) % n] + d * d : HUGE_VAL;
        to[q] = top >= 0 ? from[(e->v[k] + n) % n] : -1;
    }
}

static tz_status find_nearest(tz_element_field *f, int what)
{
    const tz_raster *r = &f->raster;
    const int32_t w = r->width, h = r->height, longer = w > h ? w : h;
    const size_t n = (size_t)w * (size_t)h;
    double *d2 = NULL, *line = NULL;
    int32_t *from = NULL;
    envelope e = {0};
    tz_status s = tz_realloc(f->ctx, &f->nearest[what], n, sizeof(int32_t));
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &d2, n, sizeof *d2);
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &line, 2 * (size_t)longer, sizeof *line);
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &from, 2 * (size_t)longer, sizeof *from);
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &e.v, 3 * (size_t)longer, sizeof *e.v);
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &e.z, 3 * (size_t)longer, sizeof *e.z);
    bool any = false;
    for (size_t i = 0; i < n && s == TZ_OK; i++) {
        const bool known = f->cell[i].weight[what] > 0;
        d2[i] = known ? 0 : HUGE_VAL;
        f->nearest[what][i] = known ? (int32_t)i : -1;
        any = any || known;
    }
    for (int pass = 0; pass < 2 && s == TZ_OK && any; pass++) {
        const int32_t lines = pass ? h : w, m = pass ? w : h, step = pass ? 1 : w;
        const double side = pass ? r->size.x / w : r->size.y / h;
        for (int32_t k = 0; k < lines; k++) {
            const int32_t base = pass ? k * w : k;
            for (int32_t q = 0; q < m; q++) {
                line[q] = d2[base + q * step];
                from[q] = f->nearest[what][base + q * step];
            }
            sweep_line(r, m, side, line, from, &e, line + longer, from + longer);
            for (int32_t q = 0; q < m; q++) {
                d2[base + q * step] = line[longer + q];
                f->nearest[what][base + q * step] = from[longer + q];
            }
        }
    }
    tz_free(f->ctx, d2), tz_free(f->ctx, line), tz_free(f->ctx, from);
    tz_free(f->ctx, e.v), tz_free(f->ctx, e.z);
    return s;
}

tz_status tz_element_field_settle(tz_element_field *f)
{
    const size_t n = (size_t)f->raster.width * (size_t)f->raster.height;
    tz_status s = f->cell ? TZ_OK : tz_alloc(f->ctx, &f->cell, n, sizeof *f->cell);
    for (size_t i = 0; i < n && s == TZ_OK; i++)
        f->cell[i] = f->image ? f->image[i] : (tz_element_field_cell){.density = -1};
    if (s == TZ_OK)
        s = draw_strokes(f);
    for (int what = 0; what < 3 && s == TZ_OK; what++)
        s = find_nearest(f, what);
    return s;
}
