/* SPDX-License-Identifier: Apache-2.0 */
/* Documents of curve textures.
 *
 *   <svg tz:document="curves" tz:size="w h 0" tz:torus="0" tz:background="rrggbbaa">
 *     <metadata id="tz-recipe">JSON</metadata>
 *     <defs><g id="tz-pens"><g tz:pen="width rrggbbaa cap join"/> ...</g></defs>
 *     <rect fill=... tz:copy="1"/>                the background
 *     <g id="tz-curves" fill="none">
 *       <path d="M ... L ... C ..." stroke=... tz:pen="0" tz:nodes="0 1 2 ..."/>
 *
 * and, where tz:elements="1", discrete elements as elements/element_write.c writes them. */
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

static tz_status path_data(const tz_curve_set *s, const tz_curve_path *p, text *d,
                           text *nodes)
{
    const int32_t end = p->piece + p->pieces;
    char id[16];
    tz_status st =
        append_points(s->ctx, d, 'M', &s->node.v[s->piece.v[p->piece].from], 1);
    for (int32_t i = p->piece; i < end && st == TZ_OK; i++) {
        const tz_curve_piece *c = &s->piece.v[i];
        const tz_vec2 v[3] = {c->a, c->b, s->node.v[c->to]};
        st = append_points(s->ctx, d, c->straight ? 'L' : 'C', c->straight ? v + 2 : v,
                           c->straight ? 1 : 3);
        snprintf(id, sizeof id, "%" PRId32 " ", c->from);
        if (st == TZ_OK)
            st = append(s->ctx, nodes, id);
    }
    snprintf(id, sizeof id, "%" PRId32, s->piece.v[end - 1].to);
    if (st == TZ_OK)
        st = append(s->ctx, nodes, id);
    return st == TZ_OK && p->closed ? append(s->ctx, d, "Z") : st;
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

static tz_status put_path(tz_svg_writer *w, const tz_curve_set *s, const tz_curve_path *p)
{
    static const char *const cap[3] = {"butt", "round", "square"};
    static const char *const join[3] = {"miter", "round", "bevel"};
    const tz_curve_pen *pen = &s->pen.v[p->pen];
    text d = {0}, nodes = {0};
    const tz_status st = path_data(s, p, &d, &nodes);
    if (st == TZ_OK) {
        tz_svg_begin(w, "path");
        tz_svg_set(w, "d", d.v);
        tz_svg_setf(w, "stroke", "#%06" PRIx32, pen->color >> 8);
        if ((pen->color & 255) < 255)
            tz_svg_set_number(w, "stroke-opacity", (pen->color & 255) / 255.0);
        tz_svg_set_number(w, "stroke-width", pen->width);
        if (pen->cap)
            tz_svg_set(w, "stroke-linecap", cap[pen->cap]);
        if (pen->join)
            tz_svg_set(w, "stroke-linejoin", join[pen->join]);
        tz_svg_setf(w, "tz:pen", "%" PRId32, p->pen);
        tz_svg_set(w, "tz:nodes", nodes.v);
        tz_svg_end(w);
    }
    tz_array_free(s->ctx, &d);
    tz_array_free(s->ctx, &nodes);
    return st;
}

tz_status tz_curve_write_svg(tz_ctx *ctx, const char *path, const tz_curve_set *s)
{
    const double size[3] = {s->domain.size.x, s->domain.size.y, s->domain.size.z};
    const bool elements = s->element.element.n > 0;
    tz_svg_writer w;
    tz_status st = tz_curve_set_check(ctx, s, path);
    if (st == TZ_OK && elements)
        st = tz_element_put_check(ctx, path, &s->element);
    if (st == TZ_OK)
        st = tz_svg_writer_open(ctx, path, size[0], size[1], &w);
    if (st != TZ_OK)
        return st;
    tz_svg_set(&w, "tz:document", "curves");
    tz_svg_set_numbers(&w, "tz:size", size, 3);
    tz_svg_set(&w, "tz:torus", s->domain.torus ? "1" : "0");
    tz_svg_setf(&w, "tz:background", "%08" PRIx32, s->background);
    if (elements)
        tz_svg_set(&w, "tz:elements", "1");
    if (s->recipe) {
        tz_svg_begin(&w, "metadata");
        tz_svg_set(&w, "id", "tz-recipe");
        tz_svg_put_text(&w, s->recipe);
        tz_svg_end(&w);
    }
    put_pens(&w, s);
    if (s->background & 255)
        put_background(&w, s);
    tz_svg_begin(&w, "g");
    tz_svg_set(&w, "id", "tz-curves");
    tz_svg_set(&w, "fill", "none");
    for (int32_t i = 0; i < s->path.n && st == TZ_OK; i++)
        st = put_path(&w, s, &s->path.v[i]);
    tz_svg_end(&w);
    if (st == TZ_OK && elements)
        st = tz_element_put_set(ctx, path, &w, &s->element);
    if (st != TZ_OK) {
        tz_svg_writer_abort(&w);
        return st;
    }
    return tz_svg_writer_close(&w);
}
