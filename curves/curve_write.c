/* SPDX-License-Identifier: Apache-2.0 */
/* Documents of curve textures.
 *
 *   <svg tz:document="curves" tz:size="w h 0" tz:torus="0" tz:background="rrggbbaa"
 *        tz:unit="mm a unit">
 *     <metadata id="tz-recipe">JSON</metadata>
 *     <defs><g id="tz-pens"><g tz:pen="width rrggbbaa cap join"/> ...</g></defs>
 *     <rect fill=... tz:copy="1"/>                the background
 *     <g id="tz-curves" fill="none">
 *       <path d="M ... L ... C ..." stroke=... tz:pen="0" tz:nodes="0 1 2 ..."
 *             tz:width="from to ..." tz:from="x y x y x y x y none ..."/>
 *
 * and, where tz:elements="1", discrete elements, photo and ground as
 * elements/element_write.c writes them.
 *
 * On a torus d runs through beyond the border; where it does, tz:exact holds each piece
 * from its node in the rectangle, all as cubics: what is straight is straight in d. A <use>
 * marked tz:copy shows such a path at the other sides, too. */
#include "curves/curve_io.h"

#include <inttypes.h>
#include <string.h>

#include "base/svg.h"
#include "elements/element_write_internal.h"

typedef TZ_ARRAY(char)
text;

static tz_status append(tz_ctx *ctx, text *t, const char *add)
{
    const size_t n = strlen(add);
    const tz_status s = tz_array_reserve(ctx, t, (int64_t)t->n + (int64_t)n + 1);
    if (s == TZ_OK) {
        memcpy(t->v + t->n, add, n + 1);
        t->n += (int32_t)n;
    }
    return s;
}

static tz_status append_points(tz_ctx *ctx, text *t, char verb, const tz_vec2 *p, int n)
{
    char out[200], number[32];
    int at = 0;
    out[at++] = verb;
    for (int i = 0; i < 2 * n; i++) {
        tz_number_format(i & 1 ? p[i / 2].y : p[i / 2].x, number);
        at += sprintf(out + at, "%s%s", i ? " " : "", number);
    }
    return append(ctx, t, out);
}

/* Data of a path: run through, or each piece from its own node. */
static tz_status path_data(const tz_curve_set *s, const tz_curve_path *p, bool exact,
                           text *d)
{
    const int32_t end = p->piece + p->pieces;
    tz_vec2 by = {0, 0};
    tz_status st =
        append_points(s->ctx, d, 'M', &s->node.v[s->piece.v[p->piece].from], 1);
    for (int32_t i = p->piece; i < end && st == TZ_OK; i++) {
        const tz_curve_piece *c = &s->piece.v[i];
        const tz_bezier b = exact ? (tz_bezier){{{0, 0}, c->a, c->b, s->node.v[c->to]}}
                                  : tz_curve_through(s, c, &by);
        const bool line = c->straight && !exact;
        st = append_points(s->ctx, d, line ? 'L' : 'C', b.p + (line ? 3 : 1),
                           line ? 1 : 3);
    }
    const bool back = by.x == 0 && by.y == 0; /* else it runs around the torus */
    return st == TZ_OK && p->closed && back ? append(s->ctx, d, "Z") : st;
}

static tz_status path_nodes(const tz_curve_set *s, const tz_curve_path *p, text *nodes)
{
    const int32_t end = p->piece + p->pieces;
    char id[16];
    tz_status st = TZ_OK;
    for (int32_t i = p->piece; i < end && st == TZ_OK; i++) {
        snprintf(id, sizeof id, "%" PRId32 " ", s->piece.v[i].from);
        st = append(s->ctx, nodes, id);
    }
    snprintf(id, sizeof id, "%" PRId32, s->piece.v[end - 1].to);
    return st == TZ_OK ? append(s->ctx, nodes, id) : st;
}

static tz_status append_numbers(tz_ctx *ctx, text *t, const double *v, int n)
{
    char out[300], number[32];
    int at = 0;
    for (int i = 0; i < n; i++) {
        tz_number_format(v[i], number);
        at += sprintf(out + at, "%s%s", i || t->n ? " " : "", number);
    }
    return append(ctx, t, out);
}

/* Widths and origins of a path's pieces. */
static tz_status path_carry(const tz_curve_set *s, const tz_curve_path *p, text *width,
                            text *from)
{
    tz_status st = TZ_OK;
    for (int32_t i = p->piece; i < p->piece + p->pieces && st == TZ_OK; i++) {
        if (s->taper.n > 0)
            st = append_numbers(s->ctx, width,
                                (double[2]){s->taper.v[i].from, s->taper.v[i].to}, 2);
        if (st != TZ_OK || s->origin.n == 0)
            continue;
        const tz_vec2 *o = s->origin.v[i].p;
        if (isnan(o[0].x))
            st = append(s->ctx, from, from->n ? " none" : "none");
        else
            st = append_numbers(s->ctx, from,
                                (double[8]){o[0].x, o[0].y, o[1].x, o[1].y, o[2].x,
                                            o[2].y, o[3].x, o[3].y},
                                8);
    }
    return st;
}

static void put_pens(tz_svg_writer *w, const tz_curve_set *s)
{
    char width[32];
    tz_svg_begin(w, "defs");
    tz_svg_begin(w, "g");
    tz_svg_set(w, "id", "tz-pens");
    for (int32_t i = 0; i < s->pen.n; i++) {
        const tz_curve_pen *p = &s->pen.v[i];
        tz_svg_begin(w, "g");
        tz_number_format(p->width, width);
        tz_svg_setf(w, "tz:pen", "%s %08" PRIx32 " %" PRIu32 " %" PRIu32, width, p->color,
                    p->cap, p->join);
        tz_svg_end(w);
    }
    tz_svg_end(w);
    tz_svg_end(w);
}

static void put_background(tz_svg_writer *w, const tz_curve_set *s)
{
    tz_svg_begin(w, "rect");
    tz_svg_set_number(w, "width", s->domain.size.x);
    tz_svg_set_number(w, "height", s->domain.size.y);
    tz_svg_setf(w, "fill", "#%06" PRIx32, s->background >> 8);
    if ((s->background & 255) < 255)
        tz_svg_set_number(w, "fill-opacity", (s->background & 255) / 255.0);
    tz_svg_set(w, "tz:copy", "1");
    tz_svg_end(w);
}

/* Whether a path leaves the rectangle of its torus. */
static bool runs_over(const tz_curve_set *s, const tz_curve_path *p)
{
    for (int32_t i = p->piece; i < p->piece + p->pieces && s->domain.torus; i++) {
        const tz_vec2 end = tz_curve_piece_end(s, &s->piece.v[i]),
                      to = s->node.v[s->piece.v[i].to];
        if (end.x != to.x || end.y != to.y)
            return true;
    }
    return false;
}

/* Shifted copies of a path on a torus, where they show. */
static void put_copies(tz_svg_writer *w, const tz_curve_set *s, int32_t path)
{
    enum { MOST = 16 };
    const tz_curve_path *p = &s->path.v[path];
    const double r = s->pen.v[p->pen].width;
    const tz_vec3 size = s->domain.size;
    tz_vec2 by = {0, 0}, lo = {INFINITY, INFINITY}, hi = {-INFINITY, -INFINITY};
    for (int32_t i = p->piece; i < p->piece + p->pieces; i++) {
        const tz_bezier b = tz_curve_through(s, &s->piece.v[i], &by);
        for (int k = 0; k < 4; k++) {
            lo = (tz_vec2){fmin(lo.x, b.p[k].x - r), fmin(lo.y, b.p[k].y - r)};
            hi = (tz_vec2){fmax(hi.x, b.p[k].x + r), fmax(hi.y, b.p[k].y + r)};
        }
    }
    const double x0 = fmax(-MOST, ceil(-hi.x / size.x)),
                 x1 = fmin(MOST, floor((size.x - lo.x) / size.x)),
                 y0 = fmax(-MOST, ceil(-hi.y / size.y)),
                 y1 = fmin(MOST, floor((size.y - lo.y) / size.y));
    for (double y = y0; y <= y1; y++)
        for (double x = x0; x <= x1; x++) {
            if (x == 0 && y == 0)
                continue;
            tz_svg_begin(w, "use");
            tz_svg_setf(w, "xlink:href", "#tz-path-%" PRId32, path);
            tz_svg_set_number(w, "x", x * size.x);
            tz_svg_set_number(w, "y", y * size.y);
            tz_svg_set(w, "tz:copy", "1");
            tz_svg_end(w);
        }
}

static void put_pen(tz_svg_writer *w, const tz_curve_pen *pen)
{
    static const char *const cap[3] = {"butt", "round", "square"};
    static const char *const join[3] = {"miter", "round", "bevel"};
    tz_svg_setf(w, "stroke", "#%06" PRIx32, pen->color >> 8);
    if ((pen->color & 255) < 255)
        tz_svg_set_number(w, "stroke-opacity", (pen->color & 255) / 255.0);
    tz_svg_set_number(w, "stroke-width", pen->width);
    if (pen->cap)
        tz_svg_set(w, "stroke-linecap", cap[pen->cap]);
    if (pen->join)
        tz_svg_set(w, "stroke-linejoin", join[pen->join]);
}

/* What a path says of itself. */
typedef struct path_texts {
    text d, exact, nodes, width, from;
} path_texts;

static tz_status path_text(const tz_curve_set *s, const tz_curve_path *p, path_texts *t)
{
    tz_status st = path_data(s, p, false, &t->d);
    if (st == TZ_OK && runs_over(s, p))
        st = path_data(s, p, true, &t->exact);
    if (st == TZ_OK)
        st = path_nodes(s, p, &t->nodes);
    return st == TZ_OK ? path_carry(s, p, &t->width, &t->from) : st;
}

static void set_text(tz_svg_writer *w, const char *name, const text *t)
{
    if (t->n > 0)
        tz_svg_set(w, name, t->v);
}

static tz_status put_path(tz_svg_writer *w, const tz_curve_set *s, int32_t path)
{
    const tz_curve_path *p = &s->path.v[path];
    path_texts t = {0};
    const tz_status st = path_text(s, p, &t);
    if (st == TZ_OK) {
        tz_svg_begin(w, "path");
        if (s->domain.torus)
            tz_svg_setf(w, "id", "tz-path-%" PRId32, path);
        set_text(w, "d", &t.d);
        put_pen(w, &s->pen.v[p->pen]);
        tz_svg_setf(w, "tz:pen", "%" PRId32, p->pen);
        set_text(w, "tz:nodes", &t.nodes);
        set_text(w, "tz:exact", &t.exact);
        set_text(w, "tz:width", &t.width);
        set_text(w, "tz:from", &t.from);
        if (p->closed && t.exact.n > 0)
            tz_svg_set(w, "tz:closed", "1");
        tz_svg_end(w);
        if (s->domain.torus)
            put_copies(w, s, path);
    }
    tz_array_free(s->ctx, &t.d);
    tz_array_free(s->ctx, &t.exact);
    tz_array_free(s->ctx, &t.nodes);
    tz_array_free(s->ctx, &t.width);
    tz_array_free(s->ctx, &t.from);
    return st;
}

/* Whether there is anything to be written of the elements' set. */
static bool has_elements(const tz_element_set *e)
{
    return e->element.n > 0 || e->kind.n > 0 || e->symbol.n > 0 || e->photo.n > 0 ||
           e->background;
}

static void put_root(tz_svg_writer *w, const tz_curve_set *s)
{
    const double size[3] = {s->domain.size.x, s->domain.size.y, s->domain.size.z};
    tz_svg_set(w, "tz:document", "curves");
    tz_svg_set_numbers(w, "tz:size", size, 3);
    tz_svg_set(w, "tz:torus", s->domain.torus ? "1" : "0");
    tz_svg_setf(w, "tz:background", "%08" PRIx32, s->background);
    if (s->unit_mm > 0)
        tz_svg_set_number(w, "tz:unit", s->unit_mm);
    if (has_elements(&s->element))
        tz_svg_set(w, "tz:elements", "1");
    if (s->recipe) {
        tz_svg_begin(w, "metadata");
        tz_svg_set(w, "id", "tz-recipe");
        tz_svg_put_text(w, s->recipe);
        tz_svg_end(w);
    }
}

tz_status tz_curve_write_svg(tz_ctx *ctx, const char *path, const tz_curve_set *s)
{
    const bool elements = has_elements(&s->element);
    tz_svg_writer w;
    tz_status st = tz_curve_set_check(ctx, s, path);
    if (st == TZ_OK && elements)
        st = tz_element_put_check(ctx, path, &s->element);
    if (st == TZ_OK)
        st = tz_svg_writer_open_mm(ctx, path, s->domain.size.x, s->domain.size.y,
                                   s->unit_mm, &w);
    if (st != TZ_OK)
        return st;
    put_root(&w, s);
    put_pens(&w, s);
    if (s->background & 255)
        put_background(&w, s);
    if (elements)
        st = tz_element_put_ground(ctx, path, &w, &s->element);
    tz_svg_begin(&w, "g");
    tz_svg_set(&w, "id", "tz-curves");
    tz_svg_set(&w, "fill", "none");
    for (int32_t i = 0; i < s->path.n && st == TZ_OK; i++)
        st = put_path(&w, s, i);
    tz_svg_end(&w);
    if (st == TZ_OK && elements)
        st = tz_element_put_elements(&w, &s->element);
    if (st != TZ_OK) {
        tz_svg_writer_abort(&w);
        return st;
    }
    return tz_svg_writer_close(&w);
}
