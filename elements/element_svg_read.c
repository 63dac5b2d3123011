/* SPDX-License-Identifier: Apache-2.0 */
/* Reading elements out of any SVG: the steps, in order. Each has a file of its own; what
 * flows between them is drawn in elements/element_svg_internal.h. */
#include <stdlib.h>
#include <string.h>

#include "elements/element_svg_internal.h"

/* ---- the view ---------------------------------------------------------------------- */

static tz_status no_size(tz_element_reader *r, tz_svg_node root)
{
    return tz_fail(r->ctx, TZ_FORMAT,
                   "%s:%d: the drawing has no size; give <svg> a viewBox=\"0 0 width "
                   "height\"",
                   r->name, tz_svg_line(root));
}

tz_status tz_element_view(tz_element_reader *r, tz_affine *map)
{
    tz_svg_node root = tz_svg_root(r->doc);
    const char *text = tz_svg_attr(root, "viewBox");
    double box[4] = {0};
    bool good = false;
    if (text) {
        tz_numbers v = {0};
        good = tz_svg_numbers(NULL, text, &v) == TZ_OK && v.n == 4;
        if (good)
            memcpy(box, v.v, sizeof box);
        tz_array_free(NULL, &v);
    } else {
        good = tz_style_length(tz_svg_attr(root, "width"), -1, &box[2]) &&
               tz_style_length(tz_svg_attr(root, "height"), -1, &box[3]);
    }
    if (!good || !(box[2] > 0 && box[3] > 0))
        return no_size(r, root);
    if (!(box[2] < 1e9 && box[3] < 1e9 && fmin(box[2], box[3]) > 1e-9))
        return tz_fail(r->ctx, TZ_FORMAT,
                       "%s:%d: a view of %g x %g cannot be used; scale the drawing",
                       r->name, tz_svg_line(root), box[2], box[3]);
    r->view = (tz_vec2){box[2], box[3]};
    *map = (tz_affine){1, 0, 0, 1, -box[0], -box[1]};
    return TZ_OK;
}

/* ---- patterns ---------------------------------------------------------------------- */

/** A pattern that is painted over the whole view: the drawing is one tile of it. */
static tz_status read_pattern(tz_element_reader *r)
{
    tz_affine m = tz_affine_identity();
    double v[4];
    static const char *const name[4] = {"x", "y", "width", "height"};
    tz_svg_node p = r->pattern;
    const char *units = tz_svg_attr(p, "patternUnits"),
               *text = tz_svg_attr(p, "patternTransform");
    const bool user = units && strcmp(units, "userSpaceOnUse") == 0;
    tz_status s = tz_svg_transform(NULL, text, &m);
    if (s != TZ_OK || !(m.a > 0) || !(m.d > 0) || m.b != 0 || m.c != 0)
        return tz_fail(r->ctx, TZ_UNSUPPORTED,
                       "%s:%d: the pattern is turned or skewed; draw its tile straight",
                       r->name, tz_svg_line(p));
    for (int i = 0; i < 4 && s == TZ_OK; i++) {
        const double whole = i % 2 ? r->view.y : r->view.x;
        s = tz_element_length(r, p, name[i], user ? whole : 1, 0, &v[i]);
        if (!user) /* a share of the shape, which is the view */
            v[i] *= whole;
    }
    if (s != TZ_OK)
        return s;
    if (!(v[2] > 0 && v[3] > 0))
        return tz_fail(r->ctx, TZ_FORMAT,
                       "%s:%d: the pattern has no size; give it width and height",
                       r->name, tz_svg_line(p));
    r->view = (tz_vec2){v[2] * m.a, v[3] * m.d};
    r->tile = true;
    m.e = -v[0] * m.a;
    m.f = -v[1] * m.d;
    const int32_t part = r->part.n, span = r->span.n;
    s = tz_element_walk(r, p, m);
    return s == TZ_OK ? tz_element_group(r, part, span) : s;
}

/* ---- the steps --------------------------------------------------------------------- */

static int by_order(const void *a, const void *b)
{
    const tz_thing *p = a, *q = b;
    if (p->order != q->order)
        return p->order < q->order ? -1 : 1;
    return p->item < q->item ? -1 : p->item > q->item;
}

/** Renumbers symbols so that only those in use stay, in order of their first element. */
static tz_status drop_symbols(tz_element_reader *r)
{
    tz_element_set *set = &r->set;
    tz_element_symbol *kept = NULL;
    int32_t *to = NULL, n = 0;
    tz_status s = tz_alloc(r->ctx, &to, (size_t)set->symbol.n, sizeof *to);
    if (s == TZ_OK)
        s = tz_alloc(r->ctx, &kept, (size_t)set->symbol.n, sizeof *kept);
    if (s == TZ_OK) {
        memset(to, 255, (size_t)set->symbol.n * sizeof *to);
        for (int32_t i = 0; i < set->element.n; i++) {
            int32_t *y = &set->element.v[i].symbol;
            if (to[*y] < 0) {
                kept[n] = set->symbol.v[*y];
                to[*y] = n++;
            }
            *y = to[*y];
        }
        for (int32_t i = 0; i < set->symbol.n; i++)
            if (to[i] < 0) {
                tz_free(r->ctx, set->symbol.v[i].id);
                tz_free(r->ctx, set->symbol.v[i].markup);
                tz_free(r->ctx, set->symbol.v[i].words);
                tz_array_free(r->ctx, &set->symbol.v[i].outline);
                tz_array_free(r->ctx, &set->symbol.v[i].part);
            }
        memcpy(set->symbol.v, kept, (size_t)n * sizeof *kept);
        set->symbol.n = n;
    }
    tz_free(r->ctx, to);
    tz_free(r->ctx, kept);
    return s;
}

static int by_depth(const void *a, const void *b)
{
    const int32_t p = *(const int32_t *)a, q = *(const int32_t *)b;
    return (p > q) - (p < q);
}

/** Depths 0, 1, 2, ... in drawing order. */
static tz_status rank_depths(tz_element_reader *r)
{
    tz_element_set *set = &r->set;
    int32_t *all = NULL;
    const int32_t n = set->element.n;
    tz_status s = tz_alloc(r->ctx, &all, (size_t)n, sizeof *all);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < n; i++)
        all[i] = set->element.v[i].depth;
    qsort(all, (size_t)n, sizeof *all, by_depth);
    int32_t kinds = 0;
    for (int32_t i = 0; i < n; i++)
        if (i == 0 || all[i] != all[kinds - 1])
            all[kinds++] = all[i];
    for (int32_t i = 0; i < n; i++) {
        const int32_t *at =
            bsearch(&set->element.v[i].depth, all, (size_t)kinds, sizeof *all, by_depth);
        set->element.v[i].depth = (int32_t)(at - all);
    }
    tz_free(r->ctx, all);
    return TZ_OK;
}

static tz_status read_drawing(tz_element_reader *r)
{
    tz_affine map = {1, 0, 0, 1, 0, 0};
    tz_status s = tz_element_view(r, &map);
    if (s == TZ_OK)
        s = tz_style_load(r);
    if (s == TZ_OK)
        s = tz_element_walk(r, NULL, map);
    if (s == TZ_OK)
        s = tz_element_group(r, 0, 0);
    if (s == TZ_OK && r->thing.n == 0 && r->pattern)
        s = read_pattern(r);
    if (s == TZ_OK && r->thing.n > 2000000)
        return tz_fail(r->ctx, TZ_LIMIT, "%s: over 2 million elements; split the drawing",
                       r->name);
    r->set.domain = (tz_domain){.size = {r->view.x, r->view.y, 0}, .torus = false};
    if (s == TZ_OK && r->thing.n > 0) {
        qsort(r->thing.v, (size_t)r->thing.n, sizeof *r->thing.v, by_order);
        s = tz_element_symbols(r, 0);
    }
    if (s == TZ_OK && r->set.element.n == 0)
        return tz_fail(r->ctx, TZ_INVALID,
                       "%s: there are no elements in it; draw shapes that are filled or "
                       "stroked and smaller than the view",
                       r->name);
    if (s == TZ_OK)
        s = tz_element_wrap(r);
    if (s == TZ_OK)
        s = drop_symbols(r);
    if (s == TZ_OK)
        s = rank_depths(r);
    if (s == TZ_OK)
        s = tz_element_classes(r);
    if (s == TZ_OK && r->background.n > 0)
        s = tz_strdup(r->ctx, r->background.v, &r->set.background);
    if (s == TZ_OK && r->ignored)
        tz_warn(r->ctx, "%s: %d texts and pictures are no shapes and are left out",
                r->name, r->ignored);
    return s;
}

tz_status tz_element_from_parts(tz_element_reader *r)
{
    r->set.domain = (tz_domain){.size = {r->view.x, r->view.y, 0}};
    tz_status s = tz_element_group(r, 0, 0);
    if (s == TZ_OK && r->thing.n > 2000000)
        return tz_fail(r->ctx, TZ_LIMIT, "%s: over 2 million elements; split the drawing",
                       r->name);
    if (s == TZ_OK && r->thing.n > 0) {
        qsort(r->thing.v, (size_t)r->thing.n, sizeof *r->thing.v, by_order);
        s = tz_element_symbols(r, 0);
    }
    if (s != TZ_OK || r->set.element.n == 0)
        return s;
    s = drop_symbols(r);
    if (s == TZ_OK)
        s = rank_depths(r);
    return s == TZ_OK ? tz_element_classes(r) : s;
}

static tz_status read_document(tz_element_reader *r, const char *text)
{
    const char *kind = tz_svg_attr(tz_svg_root(r->doc), "tz:document");
    if (kind && strcmp(kind, "elements") == 0)
        return tz_element_read_own(r, text);
    if (kind)
        return tz_fail(r->ctx, TZ_FORMAT,
                       "%s:%d: this is an %.40s of a photo, it has no elements; give a "
                       "drawing",
                       r->name, tz_svg_line(tz_svg_root(r->doc)), kind);
    return read_drawing(r);
}

void tz_element_reader_deinit(tz_element_reader *r)
{
    tz_ctx *ctx = r->ctx;
    tz_element_walk_end(r);
    tz_free(ctx, r->css);
    tz_array_free(ctx, &r->rule);
    tz_array_free(ctx, &r->verb);
    tz_array_free(ctx, &r->point);
    tz_array_free(ctx, &r->part);
    tz_array_free(ctx, &r->span);
    tz_array_free(ctx, &r->item);
    tz_array_free(ctx, &r->thing);
    tz_array_free(ctx, &r->background);
    tz_svg_free(r->doc);
    tz_element_set_deinit(&r->set);
}

tz_status tz_element_parse_svg(tz_ctx *ctx, const char *name, const char *text,
                               size_t size, const tz_element_read_options *options,
                               tz_element_set *s)
{
    tz_element_reader r = {.ctx = ctx,
                           .name = name,
                           .opt = options ? *options : (tz_element_read_options){0},
                           .set = {.ctx = ctx}};
    memset(s, 0, sizeof *s);
    tz_status st = tz_svg_parse(ctx, name, text, size, &r.doc);
    if (st == TZ_OK)
        st = read_document(&r, text);
    if (st == TZ_OK)
        st = tz_element_set_check(ctx, &r.set, name);
    if (st == TZ_OK) {
        *s = r.set;
        memset(&r.set, 0, sizeof r.set);
    }
    tz_element_reader_deinit(&r);
    return st;
}

tz_status tz_element_read_svg(tz_ctx *ctx, const char *path,
                              const tz_element_read_options *options, tz_element_set *s)
{
    char *text = NULL;
    size_t size;
    memset(s, 0, sizeof *s);
    tz_status st = tz_file_read(ctx, path, (size_t)1 << 30, &text, &size);
    if (st != TZ_OK)
        return st;
    st = tz_element_parse_svg(ctx, strcmp(path, "-") == 0 ? "standard input" : path, text,
                              size, options, s);
    tz_free(ctx, text);
    return st;
}
