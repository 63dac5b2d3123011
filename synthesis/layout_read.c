/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Reading a layout from SVG, also after an editor has been at it.
 *
 * The document is read for what it shows, not for how it was written: the tree is walked
 * in drawing order with the transform, the clip path, and the tz: notes of the placement
 * in force, <use> is followed, and wherever a photo would be drawn a placement is added.
 * So layers, groups in groups, ungrouped pieces, clones, copies with new ids, clip paths
 * moved to another element and photos added by hand need no cases of their own.
 *
 * With M the photo's pixels -> layout and C the clip path's space -> layout, the border
 * in source pixels is M^-1 C applied to the clip's polygon. In a document of ours M = C,
 * and the numbers are taken as they stand, bit for bit.
 *
 * Hostile input: recursion is bounded by MAX_DEPTH, work by MAX_STEPS (uses of uses of
 * uses multiply), a <use> inside its own target is a cycle and an error. */
#include <stdlib.h>
#include <string.h>

#include "synthesis/layout_internal.h"

#define MAX_DEPTH 300
#define MAX_STEPS 8000000

typedef struct use_frame {
    tz_svg_node target;
    const struct use_frame *up;
} use_frame;

/** What is in force at a node. */
typedef struct state {
    tz_affine map;      /* user units -> layout */
    tz_affine clip_map; /* of the innermost clip path */
    tz_svg_node clip;
    int32_t group;
    uint8_t medium, fixed, visible;
    int depth;
    const use_frame *uses;
} state;

static tz_status walk(tz_reader *r, tz_svg_node n, state s, bool referenced);

/* ---- attributes ------------------------------------------------------------------ */

/** Value of a presentation attribute, from `style` if it stands there.
 * @return length, with *value not terminated; 0 if absent */
static size_t presentation(tz_svg_node n, const char *name, const char **value)
{
    size_t k = strlen(name);
    const char *s = tz_svg_attr(n, "style");
    while (s && *s) {
        s += strspn(s, " \t\r\n;");
        size_t all = strcspn(s, ";");
        if (!strncmp(s, name, k)) {
            const char *v = s + k + strspn(s + k, " \t\r\n");
            if (*v == ':') {
                v++;
                v += strspn(v, " \t\r\n");
                size_t len = strcspn(v, ";!");
                while (len && strchr(" \t\r\n", v[len - 1]))
                    len--;
                *value = v;
                return len;
            }
        }
        s += all;
    }
    *value = tz_svg_attr(n, name);
    return *value ? strlen(*value) : 0;
}

static bool equals(const char *v, size_t n, const char *word)
{
    return n == strlen(word) && !memcmp(v, word, n);
}

/** map = transform attribute, then map. */
static tz_status concat(tz_reader *r, tz_svg_node n, tz_affine *map)
{
    const char *text = tz_svg_attr(n, "transform");
    tz_affine m;
    if (!text)
        return TZ_OK;
    tz_status st = tz_svg_transform(NULL, text, &m);
    if (st == TZ_NOMEM)
        return tz_fail(r->ctx, st, "%s: out of memory", r->name);
    if (st || !tz_affine_finite(m))
        return tz_fail(r->ctx, TZ_FORMAT, "%s:%d: transform=\"%.60s\" cannot be read",
                       r->name, tz_svg_line(n), text);
    if (tz_reader_same_map(*map, tz_affine_identity()))
        *map = m; /* keeps every bit, also of -0 */
    else
        *map = tz_affine_then(m, *map);
    if (!tz_affine_finite(*map))
        return tz_fail(r->ctx, TZ_FORMAT, "%s:%d: transform=\"%.60s\" overflows", r->name,
                       tz_svg_line(n), text);
    return TZ_OK;
}

static void translate(tz_affine *map, double x, double y)
{
    if (x != 0 || y != 0)
        *map = tz_affine_then((tz_affine){1, 0, 0, 1, x, y}, *map);
}

/* ---- leaves ---------------------------------------------------------------------- */

/** The clip path that url(#id) names, at node n. */
static tz_status find_clip(tz_reader *r, tz_svg_node n, const char *v, size_t k,
                           tz_svg_node *clip)
{
    char id[256];
    const char *hash = memchr(v, '#', k);
    size_t len = 0;
    if (k > 4 && !memcmp(v, "url(", 4) && hash) {
        hash++;
        while (hash + len < v + k && !strchr("\"')", hash[len]))
            len++;
    }
    if (!len || len >= sizeof id)
        return tz_fail(r->ctx, TZ_FORMAT,
                       "%s:%d: clip-path=\"%.*s\" does not name a clip path of this file",
                       r->name, tz_svg_line(n), (int)(k < 60 ? k : 60), v);
    memcpy(id, hash, len);
    id[len] = 0;
    *clip = tz_svg_by_id(r->doc, id);
    if (!*clip || !tz_svg_is(*clip, "clipPath"))
        return tz_fail(r->ctx, TZ_FORMAT, "%s:%d: there is no clip path \"%.60s\"",
                       r->name, tz_svg_line(n), id);
    return TZ_OK;
}

/** Adds a placement where a photo is drawn. */
static tz_status place(tz_reader *r, tz_svg_node n, const state *s)
{
    tz_read_photo photo;
    tz_affine map = s->map, inverse;
    tz_status st = tz_reader_photo(r, n, &photo);
    if (st)
        return st;
    if (!s->visible)
        return TZ_OK;
    if (!tz_reader_same_map(photo.box, tz_affine_identity()))
        map = tz_affine_then(photo.box, map);
    if (!tz_affine_invert(map, &inverse))
        return tz_fail(
            r->ctx, TZ_FORMAT,
            "%s:%d: a photo is drawn with a transform that cannot be inverted; "
            "delete the piece or give it a size",
            r->name, tz_svg_line(n));
    tz_placement p = {.map = map,
                      .source = photo.source,
                      .group = s->group,
                      .medium = s->medium,
                      .fixed = s->fixed};
    st = tz_reader_border(r, s->clip, s->clip_map, map, photo.source, tz_svg_line(n),
                          &p.border, &p.points);
    return st ? st : tz_array_push(r->ctx, &r->l.place, p);
}

/* ---- the walk -------------------------------------------------------------------- */

/** tz: notes of a placement's group. */
static tz_status read_notes(tz_reader *r, tz_svg_node n, state *s)
{
    static const char *const media[] = {"edge-group", "element", "curve"};
    const char *group = tz_svg_attr(n, "tz:group");
    if (!group)
        return TZ_OK;
    if (!tz_reader_integer(group, -1, INT32_MAX, &s->group))
        return tz_fail(r->ctx, TZ_FORMAT,
                       "%s:%d: tz:group=\"%.40s\" is not a group's number", r->name,
                       tz_svg_line(n), group);
    const char *medium = tz_svg_attr(n, "tz:medium");
    s->medium = TZ_MEDIUM_EDGE_GROUP;
    if (medium) {
        uint8_t k = 0;
        while (k < 3 && strcmp(medium, media[k]) != 0)
            k++;
        if (k == 3)
            return tz_fail(r->ctx, TZ_FORMAT,
                           "%s:%d: tz:medium=\"%.40s\" is none of edge-group, element, "
                           "curve",
                           r->name, tz_svg_line(n), medium);
        s->medium = k;
    }
    /* what an artist has moved since it was written counts as set by hand */
    const char *fixed = tz_svg_attr(n, "tz:fixed"), *at = tz_svg_attr(n, "tz:at");
    const bool moved =
        at && strtoul(at, NULL, 16) != (unsigned long)tz_layout_stamp(s->map);
    s->fixed = moved || (fixed && !strcmp(fixed, "1"));
    return TZ_OK;
}

static tz_status walk_children(tz_reader *r, tz_svg_node n, const state *s)
{
    tz_status st = TZ_OK;
    for (tz_svg_node c = tz_svg_child(n); c && !st; c = tz_svg_next(c))
        st = walk(r, c, *s, false);
    return st;
}

static tz_status walk_use(tz_reader *r, tz_svg_node n, state *s)
{
    const char *href = tz_svg_attr(n, "xlink:href");
    double x, y;
    tz_status st = tz_reader_length(r, n, "x", 0, &x);
    if (!st)
        st = tz_reader_length(r, n, "y", 0, &y);
    if (st)
        return st;
    translate(&s->map, x, y);
    if (!href || !*href)
        return TZ_OK; /* shows nothing */
    if (*href != '#')
        return tz_fail(r->ctx, TZ_FORMAT,
                       "%s:%d: <use> of another file (%.40s); bring it into this one",
                       r->name, tz_svg_line(n), href);
    tz_svg_node target = tz_svg_by_id(r->doc, href + 1);
    if (!target)
        return tz_fail(r->ctx, TZ_FORMAT, "%s:%d: there is no \"%.60s\" to <use>",
                       r->name, tz_svg_line(n), href + 1);
    for (const use_frame *f = s->uses; f; f = f->up)
        if (f->target == target)
            return tz_fail(r->ctx, TZ_FORMAT, "%s:%d: <use> of \"%.60s\" inside itself",
                           r->name, tz_svg_line(n), href + 1);
    use_frame frame = {target, s->uses};
    state inner = *s;
    inner.uses = &frame;
    return walk(r, target, inner, true);
}

static tz_status walk(tz_reader *r, tz_svg_node n, state s, bool referenced)
{
    if (++r->steps > MAX_STEPS)
        return tz_fail(r->ctx, TZ_LIMIT, "%s:%d: over %d drawn things", r->name,
                       tz_svg_line(n), MAX_STEPS);
    if (++s.depth > MAX_DEPTH)
        return tz_fail(r->ctx, TZ_LIMIT, "%s:%d: nested over %d levels deep", r->name,
                       tz_svg_line(n), MAX_DEPTH);
    if (!(r->steps & 4095) && tz_ctx_cancelled(r->ctx))
        return TZ_CANCELLED;
    bool use = tz_svg_is(n, "use"), image = !use && tz_svg_is(n, "image");
    bool group = !use && !image &&
                 (tz_svg_is(n, "g") || tz_svg_is(n, "a") || tz_svg_is(n, "svg") ||
                  tz_svg_is(n, "switch") || (referenced && tz_svg_is(n, "symbol")));
    if (!use && !image && !group) {
        r->shapes += tz_svg_is(n, "path") || tz_svg_is(n, "rect") ||
                     tz_svg_is(n, "text") || tz_svg_is(n, "circle") ||
                     tz_svg_is(n, "ellipse") || tz_svg_is(n, "polygon");
        return TZ_OK;
    }
    const char *v;
    size_t k;
    if (tz_svg_attr(n, "tz:copy"))
        return TZ_OK; /* a viewer's wrapped copy */
    k = presentation(n, "display", &v);
    if (equals(v, k, "none"))
        return TZ_OK;
    k = presentation(n, "visibility", &v);
    if (k && !equals(v, k, "inherit"))
        s.visible = equals(v, k, "visible");
    tz_status st = n == tz_svg_root(r->doc) ? TZ_OK : concat(r, n, &s.map);
    if (!st)
        st = read_notes(r, n, &s);
    if (st)
        return st;
    k = presentation(n, "clip-path", &v);
    if (k && !equals(v, k, "none")) {
        st = find_clip(r, n, v, k, &s.clip);
        s.clip_map = s.map;
        if (st)
            return st;
    }
    if (use)
        return walk_use(r, n, &s);
    if (image)
        return place(r, n, &s);
    return walk_children(r, n, &s);
}

/* ---- the document ---------------------------------------------------------------- */

/** Enters our own photos first, used or not, so that their numbers hold. */
static tz_status read_photos(tz_reader *r, tz_svg_node n, int depth)
{
    tz_status st = TZ_OK;
    tz_read_photo photo;
    if (tz_svg_is(n, "image") && tz_svg_attr(n, "tz:source"))
        st = tz_reader_photo(r, n, &photo);
    else if (depth < MAX_DEPTH)
        for (tz_svg_node c = tz_svg_child(n); c && !st; c = tz_svg_next(c))
            st = read_photos(r, c, depth + 1);
    return st;
}

/** Size of the layout, and the map from the root's user units to it. */
static tz_status read_size(tz_reader *r, tz_svg_node root, tz_affine *map)
{
    double box[4] = {0};
    int32_t line = tz_svg_line(root), size[2];
    const char *text = tz_svg_attr(root, "viewBox");
    tz_numbers v = {0};
    bool good = false;
    if (text) {
        good = !tz_svg_numbers(NULL, text, &v) && v.n == 4;
        if (good)
            memcpy(box, v.v, sizeof box);
        tz_array_free(NULL, &v);
    } else {
        const char *w = tz_svg_attr(root, "width"), *h = tz_svg_attr(root, "height");
        good = w && h && tz_svg_number(w, &box[2]) && tz_svg_number(h, &box[3]);
    }
    if (!good)
        return tz_fail(
            r->ctx, TZ_FORMAT,
            "%s:%d: the layout has no size; give it viewBox=\"0 0 width height\"",
            r->name, line);
    for (int i = 0; i < 2; i++) {
        double side = rint(box[2 + i]);
        if (!(side >= 1))
            return tz_fail(r->ctx, TZ_FORMAT, "%s:%d: layout of %g x %g px has no area",
                           r->name, line, box[2], box[3]);
        if (side > TZ_IMAGE_MAX_SIDE)
            return tz_fail(
                r->ctx, TZ_LIMIT,
                "%s:%d: layout of %g x %g px: each side must be from 1 to %d px", r->name,
                line, box[2], box[3], TZ_IMAGE_MAX_SIDE);
        if (fabs(side - box[2 + i]) > 1e-3)
            tz_warn(r->ctx, "%s: layout side of %g px is taken as %g", r->name,
                    box[2 + i], side);
        size[i] = (int32_t)side;
    }
    *map = tz_affine_identity();
    translate(map, -box[0], -box[1]);
    const char *tile = tz_svg_attr(root, "tz:tile");
    return tz_layout_init(r->ctx, &r->l, size[0], size[1], tile && !strcmp(tile, "1"));
}

/** Our recipe: the <metadata> with our id, else one that holds JSON (editors rename ids).
 */
static tz_status read_recipe(tz_reader *r, tz_svg_node root)
{
    const char *found = NULL;
    for (tz_svg_node n = tz_svg_child(root); n; n = tz_svg_next(n)) {
        if (!tz_svg_is(n, "metadata"))
            continue;
        const char *id = tz_svg_attr(n, "id"), *text = tz_svg_text(r->doc, n);
        bool ours = id && !strcmp(id, "tz-recipe");
        if (ours || (!found && text[strspn(text, " \t\r\n")] == '{'))
            found = text;
        if (ours)
            break;
    }
    return found ? tz_strdup(r->ctx, found, &r->l.recipe) : TZ_OK;
}

/** Reads r->doc; on success moves the layout out. */
static tz_status read_document(tz_reader *r, tz_layout *l)
{
    tz_svg_node root = tz_svg_root(r->doc);
    state s = {.group = -1, .medium = TZ_MEDIUM_EDGE_GROUP, .fixed = 1, .visible = 1};
    const char *kind = tz_svg_attr(root, "tz:document");
    if (kind && strcmp(kind, "layout") != 0)
        return tz_fail(r->ctx, TZ_FORMAT,
                       "%s:%d: this is an %.40s, not a layout; arrange it first", r->name,
                       tz_svg_line(root), kind);
    tz_status st = read_size(r, root, &s.map);
    if (!st)
        st = read_recipe(r, root);
    if (!st)
        st = read_photos(r, root, 0);
    if (!st)
        st = walk(r, root, s, false);
    if (st)
        return st;
    if (r->shapes)
        tz_warn(r->ctx, "%s: %d drawn shapes show no photo and are left out", r->name,
                r->shapes);
    *l = r->l;
    r->l = (tz_layout){0};
    return TZ_OK;
}

/** Reads and frees the document. */
static tz_status read_and_free(tz_ctx *ctx, const char *name, tz_svg_doc *doc,
                               tz_layout *l)
{
    tz_reader r = {.ctx = ctx, .name = name, .doc = doc};
    tz_status st = read_document(&r, l);
    tz_layout_deinit(&r.l);
    tz_free(ctx, r.table);
    tz_array_free(ctx, &r.clip);
    tz_array_free(ctx, &r.photo);
    tz_array_free(ctx, &r.number);
    tz_array_free(ctx, &r.polygon);
    tz_svg_free(doc);
    return st;
}

tz_status tz_layout_read(tz_ctx *ctx, const char *path, tz_layout *l)
{
    tz_svg_doc *doc = NULL;
    tz_status st = tz_svg_read(ctx, path, &doc);
    return st ? st : read_and_free(ctx, path, doc, l);
}

tz_status tz_layout_parse(tz_ctx *ctx, const char *name, const char *text, size_t size,
                          tz_layout *l)
{
    tz_svg_doc *doc = NULL;
    tz_status st = tz_svg_parse(ctx, name, text, size, &doc);
    return st ? st : read_and_free(ctx, name, doc, l);
}
