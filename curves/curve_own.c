/* SPDX-License-Identifier: Apache-2.0 */
/* Reading documents of ours to the bit. As soon as something is not as it was written (a
 * transform, a path without nodes, a node in two places) the document counts as changed
 * and is left to the reader of drawings. */
#include "curves/curve_own_internal.h"

#include <stdlib.h>
#include <string.h>

enum { DEEPEST = 256 };

typedef struct own {
    tz_element_reader *r;
    tz_curve_set *set;
    bool changed;
    size_t most; /* nodes that the text has room for */
    TZ_ARRAY(bool)
    known; /* nodes that have a place */
    tz_numbers number;
} own;

/* "rrggbbaa" */
static bool hex(const char *text, uint32_t *out)
{
    uint32_t v = 0;
    int n = 0;
    for (; text && text[n] && n < 8; n++) {
        const char c = text[n];
        const int d = c >= '0' && c <= '9'   ? c - '0'
                      : c >= 'a' && c <= 'f' ? c - 'a' + 10
                                             : -1;
        if (d < 0)
            return false;
        v = v << 4 | (uint32_t)d;
    }
    *out = v;
    return n == 8 && (text[8] == 0 || text[8] == ' ');
}

static tz_status read_pens(own *o, tz_svg_node list)
{
    tz_status s = TZ_OK;
    for (tz_svg_node n = tz_svg_child(list); n && s == TZ_OK; n = tz_svg_next(n)) {
        const char *text = tz_svg_attr(n, "tz:pen"), *end;
        tz_curve_pen pen = {0};
        if (!text || !tz_number_parse(text, &end, &pen.width) || *end != ' ' ||
            !hex(end + 1, &pen.color) || strlen(end) != 13 || end[10] < '0' ||
            end[10] > '2' || end[12] < '0' || end[12] > '2') {
            o->changed = true;
            return TZ_OK;
        }
        pen.cap = (uint32_t)(end[10] - '0');
        pen.join = (uint32_t)(end[12] - '0');
        s = tz_array_push(o->r->ctx, &o->set->pen, pen);
    }
    return s;
}

/* ---- paths ------------------------------------------------------------------------- */

static bool integer(double v, double most)
{
    return v >= 0 && v <= most && v == floor(v);
}

/* The node of that number at that place; a change if it is elsewhere already. */
static tz_status meet(own *o, int32_t k, tz_vec2 at, int32_t *node)
{
    tz_status s = TZ_OK;
    *node = 0;
    if (k >= o->number.n || !integer(o->number.v[k], (double)o->most)) {
        o->changed = true;
        return TZ_OK;
    }
    *node = (int32_t)o->number.v[k];
    while (o->known.n <= *node && s == TZ_OK) {
        s = tz_array_push(o->r->ctx, &o->known, false);
        if (s == TZ_OK)
            s = tz_array_push(o->r->ctx, &o->set->node, ((tz_vec2){0, 0}));
    }
    if (s != TZ_OK)
        return s;
    tz_vec2 *p = &o->set->node.v[*node];
    if (!o->known.v[*node])
        *p = at;
    else if (p->x != at.x || p->y != at.y)
        o->changed = true;
    o->known.v[*node] = true;
    return TZ_OK;
}

/* Pieces as they are run through in d; what is exact (NULL: the same) tells where they
 * are. */
static tz_status add_pieces(own *o, const tz_svg_path *d, const tz_svg_path *exact)
{
    const tz_vec2 *v = exact ? exact->point.v : d->point.v;
    int32_t at = -1, node, k = 0;
    bool closed = false;
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < d->verb.n && s == TZ_OK && !o->changed; i++) {
        const uint8_t verb = d->verb.v[i];
        if (verb == TZ_PATH_CLOSE || (verb == TZ_PATH_MOVE) != (i == 0)) {
            closed = i > 0 && i == d->verb.n - 1 && verb == TZ_PATH_CLOSE;
            o->changed = !closed;
            break;
        }
        if (exact && (i >= exact->verb.n ||
                      exact->verb.v[i] != (i == 0 ? TZ_PATH_MOVE : TZ_PATH_CUBIC))) {
            o->changed = true;
            break;
        }
        const bool cubic = exact ? i > 0 : verb == TZ_PATH_CUBIC;
        s = meet(o, k++, v[cubic ? 2 : 0], &node);
        if (s == TZ_OK && i > 0 && !o->changed) {
            s = cubic ? tz_curve_cubic(o->set, at, node, v[0], v[1])
                      : tz_curve_line(o->set, at, node);
            if (s == TZ_OK)
                o->set->piece.v[o->set->piece.n - 1].straight = verb == TZ_PATH_LINE;
        }
        at = node;
        v += cubic ? 3 : 1;
    }
    o->changed = o->changed || k != o->number.n || k < 2;
    if (s == TZ_OK)
        tz_curve_end(o->set, closed);
    return s;
}

/* Whether d shows the path that has just been read: run through, to the bit. */
static bool shows(const own *o, const tz_svg_path *d)
{
    const tz_curve_set *set = o->set;
    const tz_curve_path *p = &set->path.v[set->path.n - 1];
    const tz_vec2 *v = d->point.v + 1;
    tz_vec2 by = {0, 0};
    for (int32_t i = 0; i < p->pieces; i++) {
        const tz_curve_piece *c = &set->piece.v[p->piece + i];
        const tz_bezier b = tz_curve_through(set, c, &by);
        const int n = c->straight ? 1 : 3;
        if (memcmp(v, b.p + 4 - n, (size_t)n * sizeof *v) != 0)
            return false;
        v += n;
    }
    return true;
}

/* Widths: two numbers a piece. */
static tz_status read_widths(own *o, const char *text, int32_t pieces)
{
    tz_status s = TZ_OK;
    if (!text)
        return TZ_OK;
    o->number.n = 0;
    s = tz_svg_numbers(NULL, text, &o->number);
    o->changed = o->changed || s == TZ_INVALID || o->number.n != 2 * (int64_t)pieces;
    for (int32_t i = 0; i < pieces && s == TZ_OK && !o->changed; i++)
        s = tz_array_push(o->r->ctx, &o->set->taper,
                          ((tz_curve_taper){o->number.v[2 * i], o->number.v[2 * i + 1]}));
    return s == TZ_INVALID ? TZ_OK : s;
}

/* Origins: eight numbers a piece, or "none". */
static tz_status read_origins(own *o, const char *text, int32_t pieces)
{
    tz_status s = TZ_OK;
    for (int32_t i = 0; text && i < pieces && s == TZ_OK && !o->changed; i++) {
        tz_bezier b = tz_curve_no_origin();
        text += strspn(text, " ");
        const bool none = strncmp(text, "none", 4) == 0;
        text += none ? 4 : 0;
        for (int k = 0; k < 8 && !none && !o->changed; k++) {
            double *v = k & 1 ? &b.p[k / 2].y : &b.p[k / 2].x;
            o->changed = !tz_number_parse(text + strspn(text, " "), &text, v);
        }
        s = tz_array_push(o->r->ctx, &o->set->origin, b);
    }
    o->changed = o->changed || (text && text[strspn(text, " ")] != 0);
    return s;
}

/* The pen that the path's own style says. */
static tz_status find_pen(own *o, tz_svg_node n, const tz_style *style, int32_t *pen)
{
    const tz_look look = tz_style_look(style);
    const char *text = tz_svg_attr(n, "tz:pen");
    double v;
    if (!tz_svg_number(text, &v) || !integer(v, o->set->pen.n - 1)) {
        o->changed = true;
        return TZ_OK;
    }
    *pen = (int32_t)v;
    const tz_curve_pen *p = &o->set->pen.v[*pen];
    /* a line that does not show has no look */
    if ((p->color & 255) &&
        (p->width != look.width || p->color != look.stroke || p->cap != look.cap ||
         p->join != look.join || (look.fill & 255) || !style->visible))
        o->changed = true;
    return TZ_OK;
}

static tz_status read_path(own *o, tz_svg_node n, const tz_style *style)
{
    const char *nodes = tz_svg_attr(n, "tz:nodes"), *d = tz_svg_attr(n, "d"),
               *exact = tz_svg_attr(n, "tz:exact"), *closed = tz_svg_attr(n, "tz:closed");
    tz_svg_path path = {0}, raw = {0};
    int32_t pen = 0;
    if (!nodes || !d) {
        o->changed = true;
        return TZ_OK;
    }
    o->number.n = 0;
    tz_status s = find_pen(o, n, style, &pen);
    if (s != TZ_OK || o->changed)
        return s;
    s = tz_svg_numbers(NULL, nodes, &o->number);
    if (s == TZ_OK)
        s = tz_svg_path_parse(NULL, d, &path);
    if (s == TZ_OK && exact)
        s = tz_svg_path_parse(NULL, exact, &raw);
    if (s == TZ_OK)
        s = tz_curve_begin(o->set, pen);
    if (s == TZ_OK)
        s = add_pieces(o, &path, exact ? &raw : NULL);
    if (s == TZ_OK && !o->changed) {
        tz_curve_path *p = &o->set->path.v[o->set->path.n - 1];
        const int32_t pieces = p->pieces;
        if (closed &&
            o->set->piece.v[p->piece].from == o->set->piece.v[o->set->piece.n - 1].to)
            p->closed = true;
        o->changed = exact && !shows(o, &path);
        s = read_widths(o, tz_svg_attr(n, "tz:width"), pieces);
        if (s == TZ_OK)
            s = read_origins(o, tz_svg_attr(n, "tz:from"), pieces);
    }
    tz_svg_path_deinit(NULL, &path);
    tz_svg_path_deinit(NULL, &raw);
    if (s == TZ_FORMAT || s == TZ_INVALID)
        return tz_fail(o->r->ctx, TZ_FORMAT, "%s:%d: the path cannot be read; correct it",
                       o->r->name, tz_svg_line(n));
    return s == TZ_OK ? s : tz_fail(o->r->ctx, s, "%s: out of memory", o->r->name);
}

static tz_status read_nodes(own *o, tz_svg_node n, const tz_style *up, int depth)
{
    tz_status s = TZ_OK;
    for (tz_svg_node c = tz_svg_child(n); c && s == TZ_OK && !o->changed;
         c = tz_svg_next(c)) {
        tz_style style;
        const bool group = tz_svg_is(c, "g"), path = tz_svg_is(c, "path");
        if (tz_svg_attr(c, "tz:copy") || tz_svg_is(c, "defs") || tz_svg_is(c, "use") ||
            tz_svg_is(c, "metadata") || tz_svg_is(c, "title"))
            continue;
        if (tz_svg_attr(c, "transform") || (!group && !path) || depth > DEEPEST) {
            o->changed = true;
            return TZ_OK;
        }
        s = tz_style_at(o->r, c, up, &style);
        if (s != TZ_OK || !style.shown) {
            o->changed = true;
            return s;
        }
        s = path ? read_path(o, c, &style) : read_nodes(o, c, &style, depth + 1);
    }
    return s;
}

/* How many numbers all tz:nodes can hold. */
static size_t room(tz_svg_node n, int depth)
{
    const char *nodes = tz_svg_attr(n, "tz:nodes");
    size_t sum = nodes ? strlen(nodes) / 2 + 1 : 0;
    for (tz_svg_node c = tz_svg_child(n); c && depth < DEEPEST; c = tz_svg_next(c))
        sum += room(c, depth + 1);
    return sum;
}

/* ---- the document ------------------------------------------------------------------ */

static tz_status read_root(own *o)
{
    tz_svg_node root = tz_svg_root(o->r->doc);
    const char *size = tz_svg_attr(root, "tz:size"),
               *torus = tz_svg_attr(root, "tz:torus");
    const tz_svg_node recipe = tz_svg_by_id(o->r->doc, "tz-recipe");
    const tz_status s = size ? tz_svg_numbers(NULL, size, &o->number) : TZ_INVALID;
    if (s == TZ_NOMEM)
        return tz_fail(o->r->ctx, s, "%s: out of memory", o->r->name);
    if (s != TZ_OK || o->number.n != 3 || !(o->number.v[0] > 0) ||
        !(o->number.v[1] > 0)) {
        o->changed = true;
        return TZ_OK;
    }
    o->set->domain = (tz_domain){.size = {o->number.v[0], o->number.v[1], o->number.v[2]},
                                 .torus = torus && strcmp(torus, "1") == 0};
    const char *unit = tz_svg_attr(root, "tz:unit");
    o->changed =
        !hex(tz_svg_attr(root, "tz:background"), &o->set->background) ||
        (unit && (!tz_svg_number(unit, &o->set->unit_mm) || !(o->set->unit_mm > 0)));
    if (!o->changed && recipe)
        return tz_strdup(o->r->ctx, tz_svg_text(o->r->doc, recipe), &o->set->recipe);
    return TZ_OK;
}

/* The discrete elements among the curves, if there are to be some. */
static tz_status read_elements(tz_element_reader *r, const char *text, tz_curve_set *set)
{
    const char *some = tz_svg_attr(tz_svg_root(r->doc), "tz:elements");
    if (!some || strcmp(some, "1") != 0)
        return TZ_OK;
    tz_array_free(r->ctx, &r->rule); /* the style is loaded again */
    tz_free(r->ctx, r->css);
    r->css = NULL;
    r->may_lack = true;
    const tz_status s = tz_element_read_own(r, text);
    if (s != TZ_OK)
        return s;
    set->element = r->set;
    memset(&r->set, 0, sizeof r->set);
    r->set.ctx = r->ctx;
    tz_free(r->ctx, set->element.recipe); /* it is the curves' */
    set->element.recipe = NULL;
    return TZ_OK;
}

tz_status tz_curve_read_own(tz_element_reader *r, const char *text, tz_curve_set *out,
                            bool *own_document)
{
    const tz_svg_node root = tz_svg_root(r->doc), pens = tz_svg_by_id(r->doc, "tz-pens");
    tz_curve_set set = {.ctx = r->ctx, .element = {.ctx = r->ctx}};
    own o = {.r = r, .set = &set, .most = room(root, 0)};
    const tz_style initial = tz_style_initial();
    tz_style style;
    tz_status s = tz_style_load(r);
    if (s == TZ_OK)
        s = read_root(&o);
    if (s == TZ_OK && pens && !o.changed)
        s = read_pens(&o, pens);
    if (s == TZ_OK)
        s = tz_style_at(r, root, &initial, &style);
    if (s == TZ_OK && !o.changed)
        s = read_nodes(&o, root, &style, 0);
    for (int32_t i = 0; i < o.known.n && s == TZ_OK; i++)
        o.changed = o.changed || !o.known.v[i];
    o.changed = o.changed || (set.taper.n > 0 && set.taper.n != set.piece.n) ||
                (set.origin.n > 0 && set.origin.n != set.piece.n);
    tz_array_free(r->ctx, &o.known);
    tz_array_free(NULL, &o.number);
    *own_document = s == TZ_OK && !o.changed;
    if (*own_document) {
        s = read_elements(r, text, &set);
        if (s == TZ_OK)
            *out = set;
        else
            tz_curve_set_deinit(&set);
        return s;
    }
    tz_curve_set_deinit(&set);
    tz_array_free(r->ctx, &r->rule); /* the style is loaded again */
    tz_free(r->ctx, r->css);
    r->css = NULL;
    return s;
}
