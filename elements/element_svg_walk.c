/* SPDX-License-Identifier: Apache-2.0 */
/* The walk through a drawing, in drawing order, with map and style in force. Shapes
 * become parts, groups become spans of parts, each <use> and each <g tz:element="1"> is a
 * thing at once. What a <use> shows is read once for each target and style and kept as a
 * template, so that a million uses cost a million maps, not a million shapes. */
#include <string.h>

#include "elements/element_svg_internal.h"

#define MAX_DEPTH  300
#define MAX_STEPS  20000000
#define MAX_COPIED 2000000 /* of them within <use>, which are drawn again and again */
#define MAX_THINGS 2000000

typedef struct frame {
    tz_svg_node target;
    const struct frame *up;
} frame;

typedef struct state {
    tz_affine map;
    tz_style style;
    bool owned;        /* within a thing: shapes are its parts */
    tz_svg_node up;    /* the innermost group */
    const char *group; /* tz:class of the innermost group or <use> that has one */
    int depth;
    const frame *uses;
} state;

typedef struct template
{
    tz_svg_node target;
    tz_style style;
    int32_t item, items;
    int32_t next; /* of the same hash, or -1 */
}
template;

static tz_status walk(tz_element_reader *r, tz_svg_node n, const state *up, bool named);

/* ---- templates -------------------------------------------------------------------- */

/* The table: templates in an array, then heads of chains by hash of the target. */
typedef struct table {
    TZ_ARRAY(template)
    t;
    int32_t head[4096];
} table;

static uint32_t hash(tz_svg_node n)
{
    return (uint32_t)(((uintptr_t)n >> 4) * 2654435761u >> 8) & 4095;
}

static bool same_style(const tz_style *a, const tz_style *b)
{
    return a->fill == b->fill && a->stroke == b->stroke && a->color == b->color &&
           a->fill_opacity == b->fill_opacity && a->stroke_opacity == b->stroke_opacity &&
           a->opacity == b->opacity && a->width == b->width && a->rule == b->rule &&
           a->cap == b->cap && a->join == b->join && a->visible == b->visible &&
           a->pattern == b->pattern;
}

void tz_element_walk_end(tz_element_reader *r)
{
    table *t = r->templates;
    if (t)
        tz_array_free(r->ctx, &t->t);
    tz_free(r->ctx, t);
    r->templates = NULL;
}

/** Items first..end-1 of a new thing: the parts that have come since `first`. */
static tz_status take_parts(tz_element_reader *r, int32_t first, int32_t *item)
{
    tz_status s = TZ_OK;
    *item = r->item.n;
    for (int32_t i = first; i < r->part.n && s == TZ_OK; i++)
        s = tz_array_push(r->ctx, &r->item, i);
    return s;
}

static tz_status find_template(tz_element_reader *r, tz_svg_node target, const state *s,
                               const template **out)
{
    tz_status st = TZ_OK;
    if (!r->templates) {
        st = tz_alloc(r->ctx, &r->templates, 1, sizeof(table));
        if (st != TZ_OK)
            return st;
        memset(r->templates, 255, sizeof(table)); /* heads -1 */
        memset(&((table *)r->templates)->t, 0, sizeof((table *)0)->t);
    }
    table *all = r->templates;
    for (int32_t i = all->head[hash(target)]; i >= 0; i = all->t.v[i].next)
        if (all->t.v[i].target == target && same_style(&all->t.v[i].style, &s->style)) {
            *out = &all->t.v[i];
            return TZ_OK;
        }
    template t = {.target = target, .style = s->style};
    const int32_t first = r->part.n;
    state inner = *s;
    inner.map = tz_affine_identity();
    inner.owned = true;
    st = walk(r, target, &inner, true);
    if (st == TZ_OK)
        st = take_parts(r, first, &t.item);
    t.items = r->item.n - t.item;
    t.next = all->head[hash(target)];
    if (st == TZ_OK)
        st = tz_array_push(r->ctx, &all->t, t);
    if (st == TZ_OK) {
        all->head[hash(target)] = all->t.n - 1;
        *out = &all->t.v[all->t.n - 1];
    }
    return st;
}

/* ---- maps ------------------------------------------------------------------------- */

static tz_status concat(tz_element_reader *r, tz_svg_node n, const char *attr,
                        tz_affine *map)
{
    const char *text = tz_svg_attr(n, attr);
    tz_affine m;
    if (!text)
        return TZ_OK;
    tz_status s = tz_svg_transform(NULL, text, &m);
    if (s == TZ_OK) {
        m = tz_affine_then(m, *map);
        s = tz_affine_finite(m) ? TZ_OK : TZ_INVALID;
    }
    if (s != TZ_OK)
        return tz_fail(r->ctx, TZ_FORMAT,
                       "%s:%d: %s=\"%.40s\" is no transform; correct it", r->name,
                       tz_svg_line(n), attr, text);
    *map = m;
    return TZ_OK;
}

static void shift(tz_affine *map, double x, double y)
{
    *map = tz_affine_then((tz_affine){1, 0, 0, 1, x, y}, *map);
}

/** viewBox of a nested <svg> or a <symbol> shown `size` large: plain scaling. */
static tz_status fit(tz_element_reader *r, tz_svg_node n, const double size[2],
                     tz_affine *map)
{
    const char *text = tz_svg_attr(n, "viewBox");
    tz_numbers v = {0};
    if (!text)
        return TZ_OK;
    const bool good =
        tz_svg_numbers(NULL, text, &v) == TZ_OK && v.n == 4 && v.v[2] > 0 && v.v[3] > 0;
    double b[4] = {0, 0, 1, 1};
    if (good)
        memcpy(b, v.v, sizeof b);
    tz_array_free(NULL, &v);
    if (!good)
        return tz_fail(r->ctx, TZ_FORMAT, "%s:%d: viewBox=\"%.40s\" has no area", r->name,
                       tz_svg_line(n), text);
    const double sx = (size[0] >= 0 ? size[0] : r->view.x) / b[2],
                 sy = (size[1] >= 0 ? size[1] : r->view.y) / b[3];
    *map = tz_affine_then((tz_affine){sx, 0, 0, sy, -b[0] * sx, -b[1] * sy}, *map);
    return TZ_OK;
}

/* ---- nodes ------------------------------------------------------------------------ */

static const char *class_of(tz_svg_node n, const char *otherwise)
{
    const char *name = tz_svg_attr(n, "tz:class");
    return name && *name ? name : otherwise;
}

static tz_status add_thing(tz_element_reader *r, tz_thing t)
{
    if (t.items == 0)
        return TZ_OK;
    if (r->thing.n >= MAX_THINGS)
        return tz_fail(r->ctx, TZ_LIMIT, "%s:%d: over %d elements; split the drawing",
                       r->name, t.line, MAX_THINGS);
    return tz_array_push(r->ctx, &r->thing, t);
}

static tz_status find_target(tz_element_reader *r, tz_svg_node n, const state *s,
                             tz_svg_node *out)
{
    const char *href = tz_svg_attr(n, "xlink:href");
    *out = NULL;
    if (!href || !*href)
        return TZ_OK; /* shows nothing */
    if (*href != '#')
        return tz_fail(r->ctx, TZ_FORMAT,
                       "%s:%d: <use> of another file (%.40s); bring it into this one",
                       r->name, tz_svg_line(n), href);
    *out = tz_svg_by_id(r->doc, href + 1);
    if (!*out)
        return tz_fail(r->ctx, TZ_FORMAT,
                       "%s:%d: there is no \"%.60s\" to <use>; correct xlink:href",
                       r->name, tz_svg_line(n), href + 1);
    for (const frame *f = s->uses; f; f = f->up)
        if (f->target == *out)
            return tz_fail(r->ctx, TZ_FORMAT,
                           "%s:%d: <use> of \"%.60s\" inside itself; delete it", r->name,
                           tz_svg_line(n), href + 1);
    return TZ_OK;
}

/* What the <use> n points at, drawn where the use is. */
static tz_status walk_target(tz_element_reader *r, tz_svg_node n, tz_svg_node target,
                             state *s)
{
    if (s->owned)
        return walk(r, target, s, true);
    const template *t;
    const int32_t order = r->steps;
    const tz_status st = find_template(r, target, s, &t);
    if (st != TZ_OK)
        return st;
    const double det = tz_affine_det(s->map);
    if (!(fabs(det) > 1e-18))
        return TZ_OK; /* squeezed to nothing */
    const char *id = tz_svg_is(target, "symbol") ? tz_svg_attr(target, "id") : NULL;
    return add_thing(r, (tz_thing){.item = t->item,
                                   .items = t->items,
                                   .map = s->map,
                                   .use = true,
                                   .target = target,
                                   .name = class_of(n, class_of(target, id)),
                                   .node = n,
                                   .up = target,
                                   .order = order,
                                   .line = tz_svg_line(n)});
}

static tz_status walk_use(tz_element_reader *r, tz_svg_node n, state *s)
{
    double x, y, size[2];
    tz_svg_node target;
    tz_status st = find_target(r, n, s, &target);
    if (st == TZ_OK)
        st = tz_element_length(r, n, "x", r->view.x, 0, &x);
    if (st == TZ_OK)
        st = tz_element_length(r, n, "y", r->view.y, 0, &y);
    if (st == TZ_OK)
        st = tz_element_length(r, n, "width", r->view.x, -1, &size[0]);
    if (st == TZ_OK)
        st = tz_element_length(r, n, "height", r->view.y, -1, &size[1]);
    if (st != TZ_OK || !target)
        return st;
    shift(&s->map, x, y);
    if (tz_svg_is(target, "symbol"))
        st = fit(r, target, size, &s->map);
    if (st != TZ_OK)
        return st;
    const frame f = {target, s->uses}, *before = s->uses;
    s->uses = &f;
    st = walk_target(r, n, target, s);
    s->uses = before;
    return st;
}

static tz_status walk_children(tz_element_reader *r, tz_svg_node n, const state *s)
{
    tz_status st = TZ_OK;
    for (tz_svg_node c = tz_svg_child(n); c && st == TZ_OK; c = tz_svg_next(c))
        st = walk(r, c, s, false);
    return st;
}

/** A group that is marked as one element. */
static tz_status walk_marked(tz_element_reader *r, tz_svg_node n, state *s)
{
    tz_thing t = {.map = tz_affine_identity(),
                  .name = class_of(n, NULL),
                  .node = n,
                  .order = r->steps,
                  .line = tz_svg_line(n)};
    const int32_t first = r->part.n;
    s->owned = true;
    tz_status st = walk_children(r, n, s);
    if (st == TZ_OK)
        st = take_parts(r, first, &t.item);
    t.items = r->item.n - t.item;
    return st == TZ_OK ? add_thing(r, t) : st;
}

static tz_status walk_group(tz_element_reader *r, tz_svg_node n, state *s)
{
    const char *mark = tz_svg_attr(n, "tz:element");
    const int32_t span = r->span.n;
    if (!s->owned && mark && strcmp(mark, "1") == 0)
        return walk_marked(r, n, s);
    if (s->owned || !tz_svg_is(n, "g"))
        return walk_children(r, n, s);
    tz_status st = tz_array_push(r->ctx, &r->span, (tz_span){.first = r->part.n});
    if (st == TZ_OK)
        st = walk_children(r, n, s);
    if (st == TZ_OK) {
        r->span.v[span].end = r->part.n;
        r->span.v[span].next = r->span.n;
    }
    return st;
}

static tz_status walk_nested(tz_element_reader *r, tz_svg_node n, state *s)
{
    double x, y, size[2];
    tz_status st = tz_element_length(r, n, "x", r->view.x, 0, &x);
    if (st == TZ_OK)
        st = tz_element_length(r, n, "y", r->view.y, 0, &y);
    if (st == TZ_OK)
        st = tz_element_length(r, n, "width", r->view.x, -1, &size[0]);
    if (st == TZ_OK)
        st = tz_element_length(r, n, "height", r->view.y, -1, &size[1]);
    if (st != TZ_OK)
        return st;
    shift(&s->map, x, y);
    st = fit(r, n, size, &s->map);
    return st == TZ_OK ? walk_children(r, n, s) : st;
}

/* ---- what lies behind everything ---------------------------------------------------- */

static tz_status keep_background(tz_element_reader *r, int32_t part)
{
    char *text = NULL;
    tz_status s = tz_element_markup(r, &part, 1, tz_affine_identity(),
                                    fmax(r->view.x, r->view.y), &text);
    const size_t n = s == TZ_OK ? strlen(text) : 0;
    if (s == TZ_OK)
        s = tz_array_reserve(r->ctx, &r->background, (int64_t)r->background.n + n + 1);
    if (s == TZ_OK) {
        memcpy(r->background.v + r->background.n, text, n + 1);
        r->background.n += (int32_t)n;
    }
    tz_free(r->ctx, text);
    return s;
}

/** Whether the part covers all of the view. */
static tz_status covers(tz_element_reader *r, const tz_part *p, bool *out)
{
    const double e = 1e-3 * fmin(r->view.x, r->view.y), w = r->view.x, h = r->view.y;
    const tz_vec2 corner[4] = {{e, e}, {w - e, e}, {e, h - e}, {w - e, h - e}};
    *out = false;
    if (p->look.width >= 2 * hypot(w, h)) {
        *out = true; /* a pen as wide as the picture */
        return TZ_OK;
    }
    if (!(p->look.fill & 255) || p->box.x0 > e || p->box.y0 > e || p->box.x1 < w - e ||
        p->box.y1 < h - e)
        return TZ_OK;
    tz_polys polys = {0};
    tz_status s = tz_part_polys(r, p, tz_affine_identity(), e, &polys);
    *out = polys.part.n == 1; /* with holes it is a thing */
    for (int i = 0; i < 4 && s == TZ_OK; i++)
        *out = *out && tz_polys_contain(&polys, corner[i]);
    tz_polys_deinit(r->ctx, &polys);
    return s;
}

static tz_status walk_shape(tz_element_reader *r, tz_svg_node n, const state *s)
{
    const int32_t before = r->part.n;
    if (!s->style.visible)
        return TZ_OK;
    tz_status st = tz_part_add(r, n, &s->style, s->map, s->owned);
    if (r->part.n > before)
        r->part.v[before].group = s->group, r->part.v[before].up = s->up;
    if (st != TZ_OK || r->part.n == before || s->owned)
        return st;
    bool behind;
    st = covers(r, &r->part.v[before], &behind);
    if (st != TZ_OK || !behind)
        return st;
    if (s->style.pattern && !r->pattern)
        r->pattern = s->style.pattern;
    else
        st = keep_background(r, before);
    r->verb.n = r->part.v[before].verb;
    r->point.n = r->part.v[before].point;
    r->part.n = before;
    return st;
}

/* ---- the walk --------------------------------------------------------------------- */

static bool is_shape(tz_svg_node n)
{
    return tz_svg_is(n, "path") || tz_svg_is(n, "circle") || tz_svg_is(n, "rect") ||
           tz_svg_is(n, "ellipse") || tz_svg_is(n, "polygon") ||
           tz_svg_is(n, "polyline") || tz_svg_is(n, "line");
}

static tz_status check_limits(tz_element_reader *r, tz_svg_node n, const state *s)
{
    if (s->uses && ++r->copied > MAX_COPIED)
        return tz_fail(r->ctx, TZ_LIMIT,
                       "%s:%d: <use> copies over %d things; draw fewer copies, or split "
                       "the drawing",
                       r->name, tz_svg_line(n), MAX_COPIED);
    if (++r->steps > MAX_STEPS)
        return tz_fail(r->ctx, TZ_LIMIT, "%s:%d: over %d drawn things; split the drawing",
                       r->name, tz_svg_line(n), MAX_STEPS);
    if (s->depth > MAX_DEPTH)
        return tz_fail(r->ctx, TZ_LIMIT, "%s:%d: nested over %d levels deep; ungroup",
                       r->name, tz_svg_line(n), MAX_DEPTH);
    return !(r->steps & 4095) && tz_ctx_cancelled(r->ctx) ? TZ_CANCELLED : TZ_OK;
}

static tz_status walk(tz_element_reader *r, tz_svg_node n, const state *up, bool named)
{
    const bool shape = is_shape(n), use = !shape && tz_svg_is(n, "use");
    const bool nested = !shape && !use && tz_svg_is(n, "svg");
    const bool group = !shape && !use && !nested &&
                       (tz_svg_is(n, "g") || tz_svg_is(n, "a") ||
                        tz_svg_is(n, "switch") || (named && tz_svg_is(n, "symbol")));
    state s = *up;
    s.depth++;
    tz_status st = check_limits(r, n, &s);
    if (st != TZ_OK || tz_svg_attr(n, "tz:copy"))
        return st;
    if (!shape && !use && !nested && !group) {
        r->ignored += tz_svg_is(n, "text") || tz_svg_is(n, "image") ||
                      tz_svg_is(n, "foreignObject");
        return TZ_OK;
    }
    st = tz_style_at(r, n, &up->style, &s.style);
    if (st == TZ_OK && s.style.shown)
        st = concat(r, n, "transform", &s.map);
    if (st != TZ_OK || !s.style.shown)
        return st;
    if (shape)
        return walk_shape(r, n, &s);
    s.group = class_of(n, s.group);
    if (group && tz_svg_is(n, "g"))
        s.up = n;
    if (use)
        return walk_use(r, n, &s);
    return nested ? walk_nested(r, n, &s) : walk_group(r, n, &s);
}

static tz_status walk_content(tz_element_reader *r, tz_svg_node content, tz_affine map,
                              bool owned)
{
    state s = {.map = map, .style = tz_style_initial(), .owned = owned};
    tz_svg_node n = content ? content : tz_svg_root(r->doc);
    tz_style root;
    tz_status st = tz_style_at(r, n, &s.style, &root);
    if (st != TZ_OK)
        return st;
    s.style = root;
    s.style.pattern = NULL;
    return walk_children(r, n, &s);
}

tz_status tz_element_walk(tz_element_reader *r, tz_svg_node content, tz_affine map)
{
    return walk_content(r, content, map, false);
}

tz_status tz_element_walk_shapes(tz_element_reader *r, tz_affine map)
{
    return walk_content(r, NULL, map, true);
}
