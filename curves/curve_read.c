/* SPDX-License-Identifier: Apache-2.0 */
/* Curves out of drawings: the walk of elements/ gives all shapes in units of the view;
 * stroked ones become paths, thin filled ones their centre lines, then all is joined. Our
 * own documents are read to the bit, see curve_read_own.c. */
#include "curves/curve_io.h"

#include <stdio.h>
#include <string.h>

#include "base/ctx_internal.h"
#include "curves/clip.h"
#include "curves/curve_join.h"
#include "curves/curve_own_internal.h"
#include "curves/curve_read_internal.h"
#include "elements/element_svg_photo.h"

typedef struct reading {
    tz_element_reader *r;
    const tz_curve_read_options *opt;
    tz_curve_set *set;
    int32_t filled; /* shapes that are no curves */
} reading;

/* ---- a shape as paths -------------------------------------------------------------- */

static bool equal(tz_vec2 p, tz_vec2 q) { return p.x == q.x && p.y == q.y; }

/* Whether a cubic is a straight line, drawn evenly or not. */
static bool is_line(const tz_bezier *c)
{
    const tz_vec2 d = tz_vec2_sub(c->p[3], c->p[0]);
    const double n = tz_vec2_dot(d, d);
    double last = 0;
    for (int i = 1; i < 3; i++) {
        const tz_vec2 e = tz_vec2_sub(c->p[i], c->p[0]);
        const double along = tz_vec2_dot(d, e);
        if (!(fabs(d.x * e.y - d.y * e.x) <= 1e-7 * n) || along < last || along > n)
            return false;
        last = along;
    }
    return n > 0;
}

/* State of the subpath being built: none has been begun while `at` is -1. */
typedef struct walk {
    tz_curve_set *set;
    int32_t pen;
    int32_t first, at; /* nodes */
    bool open;
} walk;

static tz_status step(walk *w, const tz_vec2 *v, bool cubic)
{
    tz_curve_set *set = w->set;
    const tz_vec2 from = set->node.v[w->at], to = v[cubic ? 2 : 0];
    int32_t node = -1;
    tz_status s = TZ_OK;
    if (equal(from, to) && (!cubic || (equal(v[0], from) && equal(v[1], from))))
        return TZ_OK; /* no length */
    if (!w->open)
        s = tz_curve_begin(set, w->pen);
    w->open = w->open || s == TZ_OK;
    if (s == TZ_OK)
        s = tz_curve_add_node(set, to, &node);
    if (s != TZ_OK)
        return s;
    const tz_bezier c = {{from, v[0], cubic ? v[1] : v[0], to}};
    s = !cubic || is_line(&c) ? tz_curve_line(set, w->at, node)
                              : tz_curve_cubic(set, w->at, node, v[0], v[1]);
    w->at = node;
    return s;
}

static void end_path(walk *w)
{
    if (!w->open)
        return;
    tz_curve_end(w->set, true);
    w->open = false;
}

/* Back to the first point, and that node itself: the path is closed. */
static tz_status close_path(walk *w)
{
    tz_curve_set *set = w->set;
    tz_status s = TZ_OK;
    if (!w->open)
        return TZ_OK;
    tz_curve_piece *last = &set->piece.v[set->piece.n - 1];
    if (equal(set->node.v[w->at], set->node.v[w->first]))
        last->to = w->first;
    else
        s = tz_curve_line(set, w->at, w->first);
    end_path(w);
    w->at = w->first;
    return s;
}

static tz_status add_shape(tz_element_reader *r, const tz_part *p, int32_t pen,
                           tz_curve_set *set)
{
    walk w = {.set = set, .pen = pen, .first = -1, .at = -1};
    const tz_vec2 *v = r->point.v + p->point;
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < p->verbs && s == TZ_OK; i++) {
        const uint8_t verb = r->verb.v[p->verb + i];
        if (verb == TZ_PATH_MOVE) {
            end_path(&w);
            s = tz_curve_add_node(set, v[0], &w.first);
            w.at = w.first;
        } else if (w.at < 0) {
            continue; /* nothing is drawn before the first move */
        } else if (verb == TZ_PATH_CLOSE) {
            s = close_path(&w);
        } else {
            s = step(&w, v, verb == TZ_PATH_CUBIC);
        }
        v += verb == TZ_PATH_CUBIC ? 3 : verb == TZ_PATH_CLOSE ? 0 : 1;
    }
    end_path(&w);
    return s;
}

/* ---- shapes ------------------------------------------------------------------------ */

static bool is_background(const tz_element_reader *r, const tz_part *p)
{
    const double e = 1e-3 * fmin(r->view.x, r->view.y);
    return (p->look.fill & 255) && !(p->look.stroke & 255) && p->verbs <= 6 &&
           p->box.x0 <= e && p->box.y0 <= e && p->box.x1 >= r->view.x - e &&
           p->box.y1 >= r->view.y - e;
}

static bool in_view(const tz_element_reader *r, const tz_part *p)
{
    const double w = p->look.width / 2;
    return p->box.x1 + w > 0 && p->box.y1 + w > 0 && p->box.x0 - w < r->view.x &&
           p->box.y0 - w < r->view.y;
}

static tz_status read_filled(reading *k, tz_part *p)
{
    tz_curve_set *set = k->set;
    const double side = fmin(k->r->view.x, k->r->view.y);
    bool taken = false;
    int32_t pen;
    if (k->opt->outlines) {
        tz_status s = tz_curve_add_pen(
            set, (tz_curve_pen){.width = 0.002 * side, .color = p->look.fill}, &pen);
        return s == TZ_OK ? add_shape(k->r, p, pen, set) : s;
    }
    const tz_status s = tz_curve_centre_lines(k->r, p, 0.05 * side, set, &taken);
    k->filled += s == TZ_OK && !taken;
    p->owned = taken;
    return s;
}

/* What is read as a curve, or does not show, is owned then. */
static tz_status read_part(reading *k, tz_part *p)
{
    tz_curve_set *set = k->set;
    int32_t pen;
    p->owned = true;
    if (!in_view(k->r, p))
        return TZ_OK;
    if (set->path.n == 0 && is_background(k->r, p)) {
        set->background = p->look.fill;
        return TZ_OK;
    }
    if (!(p->look.stroke & 255) || !(p->look.width > 0))
        return read_filled(k, p);
    const tz_status s = tz_curve_add_pen(set,
                                         (tz_curve_pen){.width = p->look.width,
                                                        .color = p->look.stroke,
                                                        .cap = p->look.cap,
                                                        .join = p->look.join},
                                         &pen);
    return s == TZ_OK ? add_shape(k->r, p, pen, set) : s;
}

/* Nodes that no piece has come to use. */
static tz_status drop_nodes(tz_curve_set *s)
{
    int32_t *to = NULL, n = 0;
    tz_status st = tz_alloc(s->ctx, &to, (size_t)s->node.n, sizeof *to);
    if (st != TZ_OK)
        return st;
    memset(to, 255, (size_t)s->node.n * sizeof *to);
    for (int32_t i = 0; i < s->piece.n; i++)
        to[s->piece.v[i].from] = to[s->piece.v[i].to] = 0;
    for (int32_t i = 0; i < s->node.n; i++)
        if (to[i] == 0) {
            s->node.v[n] = s->node.v[i];
            to[i] = n++;
        }
    s->node.n = n;
    for (int32_t i = 0; i < s->piece.n; i++) {
        s->piece.v[i].from = to[s->piece.v[i].from];
        s->piece.v[i].to = to[s->piece.v[i].to];
    }
    tz_free(s->ctx, to);
    return TZ_OK;
}

/* Length of a unit on paper, mm, where the document's width says one; else 0. */
static double paper_unit(const tz_element_reader *r)
{
    static const char *const units[] = {"mm", "cm", "in", "pt", "pc", "Q"};
    const char *text = tz_svg_attr(tz_svg_root(r->doc), "width"), *end;
    double number, px;
    if (!text || !tz_number_parse(text + strspn(text, " \t\n"), &end, &number) ||
        !tz_style_length(text, 0, &px))
        return 0;
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (strncmp(end, units[i], strlen(units[i])) == 0 && px > 0)
            return px * 25.4 / 96 / r->view.x;
    return 0;
}

/* A document of ours that has been changed stays the torus that it was. */
static bool was_torus(const tz_element_reader *r)
{
    const tz_svg_node root = tz_svg_root(r->doc);
    const char *kind = tz_svg_attr(root, "tz:document"),
               *torus = tz_svg_attr(root, "tz:torus");
    return kind && torus && strcmp(torus, "1") == 0;
}

static tz_status read_shapes(reading *k)
{
    tz_element_reader *r = k->r;
    tz_affine map;
    tz_status s = tz_element_view(r, &map);
    if (s == TZ_OK)
        s = tz_style_load(r);
    if (s == TZ_OK)
        s = tz_element_walk_shapes(r, map);
    if (s != TZ_OK)
        return s;
    k->set->domain = (tz_domain){.size = {r->view.x, r->view.y, 0}};
    k->set->unit_mm = paper_unit(r);
    for (int32_t i = 0; i < r->part.n && s == TZ_OK; i++)
        s = read_part(k, &r->part.v[i]);
    if (s == TZ_OK)
        s = drop_nodes(k->set);
    if (s == TZ_OK) {
        k->set->domain.torus = was_torus(r);
        tz_curve_wrap(k->set);
    }
    if (s == TZ_OK && k->filled > 0 && k->opt->elements)
        s = tz_element_from_parts(r);
    else if (s == TZ_OK && k->filled > 0)
        tz_warn(r->ctx, "%s: %d filled shapes are no curves and are left out", r->name,
                k->filled);
    if (s == TZ_OK && r->ignored > 0)
        tz_warn(r->ctx, "%s: %d texts and pictures are no curves and are left out",
                r->name, r->ignored);
    return s;
}

/* Whether any path runs over the view by more than `margin`. */
static bool runs_far(const tz_curve_set *s, double margin)
{
    const tz_vec3 size = s->domain.size;
    for (int32_t i = 0; i < s->piece.n; i++) {
        const tz_bezier b = tz_curve_bezier(s, &s->piece.v[i]);
        for (int k = 0; k < 4; k++)
            if (!(b.p[k].x >= -margin && b.p[k].y >= -margin &&
                  b.p[k].x <= size.x + margin && b.p[k].y <= size.y + margin))
                return true;
    }
    return false;
}

/* What lies far outside of the view is cut off: nothing of it shows, and lines a million
 * views long would set the scale of all that follows. */
static tz_status cut_far(tz_curve_set *s)
{
    const tz_vec3 size = s->domain.size;
    const double margin = fmax(size.x, size.y);
    const tz_curve_window kept = {.at = {-margin, -margin},
                                  .size = {size.x + 2 * margin, size.y + 2 * margin}};
    tz_curve_set whole = *s;
    if (s->domain.torus || !runs_far(s, margin))
        return TZ_OK;
    const tz_status st = tz_curve_clip(whole.ctx, &whole, &kept, s);
    s->ctx = whole.ctx;
    tz_curve_set_deinit(&whole);
    return st;
}

static tz_status no_curves(const tz_element_reader *r)
{
    return tz_fail(
        r->ctx, TZ_INVALID,
        "%s: there are no curves in it; draw lines that are stroked, or shapes "
        "that are long and thin",
        r->name);
}

/* The elements that the reader has found are the set's. */
static void take_elements(tz_element_reader *r, tz_curve_set *set)
{
    if (r->set.element.n == 0)
        return;
    tz_element_set_deinit(&set->element); /* what joining has made of none */
    set->element = r->set;
    set->element.domain = set->domain;
    memset(&r->set, 0, sizeof r->set);
    r->set.ctx = r->ctx;
}

/* What joining says, which knows of no file. */
static tz_status name_file(tz_element_reader *r, tz_status s)
{
    char why[200];
    snprintf(why, sizeof why, "%s", tz_ctx_message(r->ctx));
    tz_ctx_forget_message(r->ctx);
    return tz_fail(r->ctx, s, "%s: %s", r->name, why);
}

static tz_status read_drawing(tz_element_reader *r, const tz_curve_read_options *opt,
                              tz_curve_set *out)
{
    tz_curve_set set = {.ctx = r->ctx, .element = {.ctx = r->ctx}};
    reading k = {.r = r, .opt = opt, .set = &set};
    const tz_curve_join_params join = {.reach = opt->reach, .crossings = opt->crossings};
    tz_status s = read_shapes(&k);
    if (s == TZ_OK)
        s = cut_far(&set);
    if (s == TZ_OK && set.path.n == 0)
        s = no_curves(r);
    if (s == TZ_OK && opt->as_drawn) {
        *out = set;
        take_elements(r, out);
        return TZ_OK;
    }
    if (s == TZ_OK) {
        s = tz_curve_join(r->ctx, &set, &join, out);
        if (s == TZ_LIMIT)
            s = name_file(r, s);
    }
    tz_curve_set_deinit(&set);
    if (s == TZ_OK)
        take_elements(r, out);
    if (s == TZ_OK && out->path.n == 0)
        s = no_curves(r);
    return s;
}

/* Photos of a document of ours that has been changed. */
static tz_status read_photos(tz_element_reader *r, tz_svg_node n, int depth)
{
    enum { DEEPEST = 256 };
    tz_status s = TZ_OK;
    for (tz_svg_node c = tz_svg_child(n); c && s == TZ_OK; c = tz_svg_next(c))
        if (tz_svg_is(c, "image"))
            s = tz_element_read_image(r, c);
        else if (depth < DEEPEST && (tz_svg_is(c, "defs") || tz_svg_is(c, "g")))
            s = read_photos(r, c, depth + 1);
    return s;
}

static tz_status keep_photos(tz_element_reader *r, tz_curve_set *set)
{
    tz_status s = read_photos(r, tz_svg_root(r->doc), 0);
    if (s == TZ_OK)
        s = tz_element_join_photos(r);
    for (int32_t i = 0; i < r->set.photo.n && s == TZ_OK; i++) {
        s = tz_array_push(r->ctx, &set->element.photo, r->set.photo.v[i]);
        if (s == TZ_OK)
            memset(&r->set.photo.v[i], 0, sizeof r->set.photo.v[i]); /* moved */
    }
    set->element.domain = set->domain;
    return s;
}

/* ---- documents --------------------------------------------------------------------- */

static tz_status read_document(tz_element_reader *r, const char *text,
                               const tz_curve_read_options *opt, tz_curve_set *out)
{
    const tz_svg_node root = tz_svg_root(r->doc);
    const char *kind = tz_svg_attr(root, "tz:document");
    bool own = false;
    if (kind && strcmp(kind, "curves") != 0)
        return tz_fail(r->ctx, TZ_FORMAT,
                       "%s:%d: this document holds %.40s, not curves; give a drawing",
                       r->name, tz_svg_line(root), kind);
    if (kind) {
        const tz_status s = tz_curve_read_own(r, text, out, &own);
        if (s != TZ_OK || own)
            return s;
    }
    const tz_status s = read_drawing(r, opt, out);
    return s == TZ_OK && kind ? keep_photos(r, out) : s;
}

tz_status tz_curve_parse_svg(tz_ctx *ctx, const char *name, const char *text, size_t size,
                             const tz_curve_read_options *options, tz_curve_set *s)
{
    const tz_curve_read_options plain = {0};
    tz_element_reader r = {.ctx = ctx, .name = name, .set = {.ctx = ctx}};
    tz_curve_set out = {.ctx = ctx, .element = {.ctx = ctx}};
    memset(s, 0, sizeof *s);
    tz_status st = tz_svg_parse(ctx, name, text, size, &r.doc);
    if (st == TZ_OK)
        st = read_document(&r, text, options ? options : &plain, &out);
    if (st == TZ_OK)
        st = tz_curve_set_check(ctx, &out, name);
    if (st == TZ_OK)
        *s = out;
    else
        tz_curve_set_deinit(&out);
    tz_element_reader_deinit(&r);
    return st;
}

tz_status tz_curve_read_svg(tz_ctx *ctx, const char *path,
                            const tz_curve_read_options *options, tz_curve_set *s)
{
    char *text = NULL;
    size_t size;
    memset(s, 0, sizeof *s);
    tz_status st = tz_file_read(ctx, path, (size_t)1 << 30, &text, &size);
    if (st != TZ_OK)
        return st;
    st = tz_curve_parse_svg(ctx, strcmp(path, "-") == 0 ? "standard input" : path, text,
                            size, options, s);
    tz_free(ctx, text);
    return st;
}
