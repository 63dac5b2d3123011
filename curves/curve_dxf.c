/* SPDX-License-Identifier: Apache-2.0 */
/* DXF as plotters and cutters read it: AutoCAD R12, ASCII, pairs of lines (a number that
 * says what follows, and that).
 *
 *   999 comments: unit, pens
 *   HEADER    version, extents
 *   TABLES    line type, a layer a pen
 *   ENTITIES  POLYLINE { VERTEX ... } SEQEND, in the order of the pen's way
 *
 * Numbers have four decimals of a mm and never an exponent or a comma. */
#include "curves/curve_dxf.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "curves/curve_travel_internal.h"

#define LARGEST_MM 1e7

typedef struct stroke {
    int32_t first, n; /* points, without a last one that repeats the first */
    bool closed;
} stroke;

typedef struct drawing {
    tz_ctx *ctx;
    const tz_curve_set *s;
    double unit, tolerance;
    TZ_ARRAY(tz_vec2)
    point; /* user units */
    TZ_ARRAY(stroke)
    stroke;
    TZ_ARRAY(tz_travel_stroke)
    travel;
    tz_vec2 least, most; /* user units */
} drawing;

/* ---- strokes --------------------------------------------------------------------------
 */

static tz_status put_point(drawing *d, tz_vec2 p)
{
    const int32_t n = d->point.n;
    if (n > d->stroke.v[d->stroke.n - 1].first && d->point.v[n - 1].x == p.x &&
        d->point.v[n - 1].y == p.y)
        return TZ_OK;
    d->least = (tz_vec2){fmin(d->least.x, p.x), fmin(d->least.y, p.y)};
    d->most = (tz_vec2){fmax(d->most.x, p.x), fmax(d->most.y, p.y)};
    return tz_array_push(d->ctx, &d->point, p);
}

static tz_status begin_stroke(drawing *d, bool closed)
{
    const stroke s = {.first = d->point.n, .closed = closed};
    return tz_array_push(d->ctx, &d->stroke, s);
}

static tz_status end_stroke(drawing *d, int32_t pen)
{
    stroke *s = &d->stroke.v[d->stroke.n - 1];
    const tz_vec2 *p = d->point.v + s->first;
    s->n = d->point.n - s->first;
    if (s->closed && s->n > 1 && p[0].x == p[s->n - 1].x && p[0].y == p[s->n - 1].y)
        s->n--;
    if (s->n < 2) { /* a point: nothing to draw */
        d->point.n = s->first;
        d->stroke.n--;
        return TZ_OK;
    }
    const tz_travel_stroke t = {p[0], s->closed ? p[0] : p[s->n - 1], pen};
    return tz_array_push(d->ctx, &d->travel, t);
}

static tz_status add_path(drawing *d, const tz_curve_path *path)
{
    const tz_curve_set *s = d->s;
    tz_vec2 shift = {0, 0}; /* of this piece, on a torus */
    tz_vec2 at = s->node.v[s->piece.v[path->piece].from];
    tz_status st = begin_stroke(d, path->closed);
    if (st == TZ_OK)
        st = put_point(d, at);
    for (int32_t i = path->piece; i < path->piece + path->pieces && st == TZ_OK; i++) {
        const tz_bezier c = tz_curve_bezier(s, &s->piece.v[i]);
        const int32_t n = s->piece.v[i].straight ? 1 : tz_bezier_steps(&c, d->tolerance);
        if (s->domain.torus)
            shift = tz_vec2_sub(at, c.p[0]);
        for (int32_t k = 1; k <= n && st == TZ_OK; k++) {
            const tz_vec2 p = k == n ? c.p[3] : tz_bezier_at(&c, (double)k / n);
            st = put_point(d, tz_vec2_add(p, shift));
        }
        at = tz_vec2_add(c.p[3], shift);
    }
    if (st == TZ_OK &&
        path->closed) { /* around a torus: it does not close in the plane */
        const tz_vec2 from = d->point.v[d->stroke.v[d->stroke.n - 1].first];
        d->stroke.v[d->stroke.n - 1].closed =
            hypot(at.x - from.x, at.y - from.y) <= d->tolerance;
    }
    return st == TZ_OK ? end_stroke(d, path->pen) : st;
}

static tz_status add_element(drawing *d, const tz_element *e)
{
    const tz_element_symbol *y = &d->s->element.symbol.v[e->symbol];
    const tz_affine m = tz_affine_place((tz_vec2){0, 0}, (tz_vec2){e->at.x, e->at.y},
                                        e->angle, e->scale, false);
    tz_status st = TZ_OK;
    for (int32_t k = 0; k < y->part.n && st == TZ_OK; k++) {
        const int32_t end = k + 1 < y->part.n ? y->part.v[k + 1] : y->outline.n;
        st = begin_stroke(d, true);
        for (int32_t i = y->part.v[k]; i < end && st == TZ_OK; i++)
            st = put_point(d, tz_affine_apply(m, y->outline.v[i]));
        if (st == TZ_OK)
            st = end_stroke(d, d->s->pen.n);
    }
    return st;
}

static tz_status flatten(drawing *d)
{
    const tz_element_set *e = &d->s->element;
    tz_status st = TZ_OK;
    for (int32_t i = 0; i < d->s->path.n && st == TZ_OK; i++) {
        st = add_path(d, &d->s->path.v[i]);
        if (st == TZ_OK && (i & 1023) == 0 && tz_ctx_cancelled(d->ctx))
            st = TZ_CANCELLED;
    }
    for (int32_t i = 0; i < e->element.n && st == TZ_OK; i++)
        if (!e->kind.v[e->element.v[i].kind].is_void)
            st = add_element(d, &e->element.v[i]);
    return st;
}

/* ---- colours --------------------------------------------------------------------------
 */

/** AutoCAD's colour 1 .. 255: nine named ones, 24 hues in five lightnesses pure and half
 * mixed with white, and greys. */
static void index_color(int i, double rgb[3])
{
    static const uint32_t named[10] = {0x000000, 0xff0000, 0xffff00, 0x00ff00, 0x00ffff,
                                       0x0000ff, 0xff00ff, 0xffffff, 0x808080, 0xc0c0c0};
    static const uint32_t grey[6] = {51, 80, 105, 130, 190, 255};
    static const double light[5] = {255, 165, 127, 76, 38};
    if (i < 10) {
        for (int c = 0; c < 3; c++)
            rgb[c] = named[i] >> (16 - 8 * c) & 255;
    } else if (i >= 250) {
        rgb[0] = rgb[1] = rgb[2] = grey[i - 250];
    } else {
        const double hue = (i / 10 - 1) * 0.25, value = light[i % 10 / 2];
        const double down = i & 1 ? 0.5 : 0;
        for (int c = 0; c < 3; c++) { /* the hue's channels: trapezia, 2 apart */
            double h = fmod(hue - 2 * c + 9, 6) - 3;
            h = fmin(1, fmax(0, 2 - fabs(h)));
            rgb[c] = value * (down + (1 - down) * h);
        }
    }
}

/** Nearest colour; black and white are one, number 7, which shows on either ground. */
static int nearest_color(uint32_t rgba)
{
    double want[3], best = INFINITY;
    int found = 7;
    for (int c = 0; c < 3; c++)
        want[c] = rgba >> (24 - 8 * c) & 255;
    if (want[0] + want[1] + want[2] < 60)
        return 7;
    for (int i = 1; i < 256; i++) {
        double rgb[3], d = 0;
        index_color(i, rgb);
        for (int c = 0; c < 3; c++)
            d += (rgb[c] - want[c]) * (rgb[c] - want[c]);
        if (d < best) {
            best = d;
            found = i;
        }
    }
    return found;
}

/* ---- text -----------------------------------------------------------------------------
 */

static void put_text(FILE *f, int code, const char *text)
{
    fprintf(f, "%3d\n%s\n", code, text);
}

static void put_count(FILE *f, int code, int n) { fprintf(f, "%3d\n%6d\n", code, n); }

/** With a point in any locale. */
static void put_number(FILE *f, int code, double mm)
{
    const int64_t v = (int64_t)llrint(fabs(mm) * 1e4);
    fprintf(f, "%3d\n%s%" PRId64 ".%04d\n", code, mm < 0 && v ? "-" : "", v / 10000,
            (int)(v % 10000));
}

static void put_place(const drawing *d, FILE *f, int code, tz_vec2 p)
{
    put_number(f, code, p.x * d->unit);
    put_number(f, code + 10, (d->s->domain.size.y - p.y) * d->unit);
}

static void layer_name(const drawing *d, int32_t pen, char name[24])
{
    if (pen < d->s->pen.n)
        snprintf(name, 24, "PEN_%" PRId32, pen + 1);
    else
        strcpy(name, "ELEMENTS");
}

static void put_comments(const drawing *d, FILE *f)
{
    char text[160];
    put_text(f, 999, "unit: mm");
    for (int32_t i = 0; i < d->s->pen.n; i++) {
        const tz_curve_pen *p = &d->s->pen.v[i];
        const int64_t um = (int64_t)llrint(p->width * d->unit * 1e3);
        snprintf(text, sizeof text,
                 "PEN_%" PRId32 ": #%06" PRIx32 ", %" PRId64 ".%03d mm wide", i + 1,
                 p->color >> 8, um / 1000, (int)(um % 1000));
        put_text(f, 999, text);
    }
}

static void put_header(const drawing *d, FILE *f)
{
    static const char *const name[4] = {"$EXTMIN", "$EXTMAX", "$LIMMIN", "$LIMMAX"};
    const double h = d->s->domain.size.y;
    const tz_vec2 corner[4] = {{d->least.x, d->most.y},
                               {d->most.x, d->least.y},
                               {0, h},
                               {d->s->domain.size.x, 0}};
    put_text(f, 0, "SECTION");
    put_text(f, 2, "HEADER");
    put_text(f, 9, "$ACADVER");
    put_text(f, 1, "AC1009");
    for (int i = 0; i < 4; i++) {
        put_text(f, 9, name[i]);
        put_place(d, f, 10, corner[i]);
        if (i < 2)
            put_number(f, 30, 0);
    }
    put_text(f, 0, "ENDSEC");
}

static void put_tables(const drawing *d, FILE *f)
{
    const int32_t layers = d->s->pen.n + (d->s->element.element.n > 0);
    char name[24];
    put_text(f, 0, "SECTION");
    put_text(f, 2, "TABLES");
    put_text(f, 0, "TABLE");
    put_text(f, 2, "LTYPE");
    put_count(f, 70, 1);
    put_text(f, 0, "LTYPE");
    put_text(f, 2, "CONTINUOUS");
    put_count(f, 70, 0);
    put_text(f, 3, "Solid line");
    put_count(f, 72, 65);
    put_count(f, 73, 0);
    put_number(f, 40, 0);
    put_text(f, 0, "ENDTAB");
    put_text(f, 0, "TABLE");
    put_text(f, 2, "LAYER");
    put_count(f, 70, layers);
    for (int32_t i = 0; i < layers; i++) {
        layer_name(d, i, name);
        put_text(f, 0, "LAYER");
        put_text(f, 2, name);
        put_count(f, 70, 0);
        put_count(f, 62, i < d->s->pen.n ? nearest_color(d->s->pen.v[i].color) : 7);
        put_text(f, 6, "CONTINUOUS");
    }
    put_text(f, 0, "ENDTAB");
    put_text(f, 0, "ENDSEC");
}

static void put_stroke(const drawing *d, FILE *f, int32_t i, bool reversed)
{
    const stroke *s = &d->stroke.v[i];
    char layer[24];
    layer_name(d, d->travel.v[i].pen, layer);
    put_text(f, 0, "POLYLINE");
    put_text(f, 8, layer);
    put_count(f, 66, 1); /* vertices follow */
    put_number(f, 10, 0);
    put_number(f, 20, 0);
    put_number(f, 30, 0);
    put_count(f, 70, s->closed);
    for (int32_t k = 0; k < s->n; k++) {
        put_text(f, 0, "VERTEX");
        put_text(f, 8, layer);
        put_place(d, f, 10, d->point.v[s->first + (reversed ? s->n - 1 - k : k)]);
        put_number(f, 30, 0);
    }
    put_text(f, 0, "SEQEND");
    put_text(f, 8, layer);
}

static tz_status write_text(const drawing *d, const char *path, const int32_t *order,
                            const bool *reversed)
{
    tz_file_out out = {0};
    const tz_status st = tz_file_out_open(d->ctx, path, &out);
    if (st != TZ_OK)
        return st;
    put_comments(d, out.f);
    put_header(d, out.f);
    put_tables(d, out.f);
    put_text(out.f, 0, "SECTION");
    put_text(out.f, 2, "ENTITIES");
    for (int32_t i = 0; i < d->stroke.n; i++) {
        if (tz_ctx_cancelled(d->ctx)) {
            tz_file_out_abort(&out);
            return TZ_CANCELLED;
        }
        put_stroke(d, out.f, order[i], reversed[i]);
    }
    put_text(out.f, 0, "ENDSEC");
    put_text(out.f, 0, "EOF");
    return tz_file_out_commit(&out);
}

/* ---- all of it ------------------------------------------------------------------------
 */

static tz_status check(tz_ctx *ctx, const char *path, const tz_curve_set *s, double unit,
                       double tolerance)
{
    if (!(unit > 0) || !isfinite(unit))
        return tz_fail(ctx, TZ_INVALID, "%s: a unit of %g mm; it must be above 0", path,
                       unit);
    if (!(tolerance >= 0) || !isfinite(tolerance))
        return tz_fail(ctx, TZ_INVALID,
                       "%s: a tolerance of %g; it must be 0 (automatic) or above", path,
                       tolerance);
    if (!(fmax(s->domain.size.x, s->domain.size.y) * unit <= LARGEST_MM))
        return tz_fail(ctx, TZ_INVALID,
                       "%s: the drawing would be %g m long; give it a smaller unit", path,
                       fmax(s->domain.size.x, s->domain.size.y) * unit / 1000);
    return tz_curve_set_check(ctx, s, path);
}

/** Lines may leave the domain, but not for the moon. */
static tz_status check_extent(const drawing *d, const char *path)
{
    const double far = fmax(fmax(-d->least.x, -d->least.y), fmax(d->most.x, d->most.y));
    if (far * d->unit <= LARGEST_MM)
        return TZ_OK;
    return tz_fail(d->ctx, TZ_INVALID,
                   "%s: lines run %g m beyond the drawing; cut them at its border", path,
                   far * d->unit / 1000);
}

tz_status tz_curve_write_dxf(tz_ctx *ctx, const char *path, const tz_curve_set *s,
                             double unit, double tolerance, double way[2])
{
    drawing d = {.ctx = ctx, .s = s, .unit = unit, .tolerance = tolerance};
    int32_t *order = NULL;
    bool *reversed = NULL;
    double ways[2];
    tz_status st = check(ctx, path, s, unit, tolerance);
    if (st != TZ_OK)
        return st;
    d.least = (tz_vec2){0, 0};
    d.most = (tz_vec2){s->domain.size.x, s->domain.size.y};
    if (!(tolerance > 0)) {
        double thin = INFINITY;
        for (int32_t i = 0; i < s->pen.n; i++)
            thin = fmin(thin, s->pen.v[i].width);
        d.tolerance = isfinite(thin) ? thin / 20 : 1e-3 * hypot(d.most.x, d.most.y);
    }
    st = flatten(&d);
    if (st == TZ_OK)
        st = check_extent(&d, path);
    if (st == TZ_OK)
        st = tz_alloc(ctx, &order, (size_t)d.stroke.n, sizeof *order);
    if (st == TZ_OK)
        st = tz_alloc(ctx, &reversed, (size_t)d.stroke.n, sizeof *reversed);
    if (st == TZ_OK)
        st = tz_travel_order(ctx, d.travel.v, d.stroke.n, order, reversed, ways);
    if (st == TZ_OK)
        st = write_text(&d, path, order, reversed);
    if (st == TZ_OK && way)
        memcpy(way, ways, sizeof ways);
    tz_free(ctx, order);
    tz_free(ctx, reversed);
    tz_array_free(ctx, &d.point);
    tz_array_free(ctx, &d.stroke);
    tz_array_free(ctx, &d.travel);
    return st;
}
