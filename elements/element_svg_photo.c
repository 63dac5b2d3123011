/* SPDX-License-Identifier: Apache-2.0 */
/* Photos of documents that elements/element_write.c has written, also after an editor
 * has been at them. The outline is the path of the symbol's clip; its points are taken as
 * they stand, and curves that an artist has made of them are flattened. */
#include "elements/element_svg_photo.h"

#include <string.h>

#include "base/href.h"

static tz_status bad(tz_element_reader *r, tz_svg_node n, const char *what)
{
    return tz_fail(r->ctx, TZ_FORMAT, "%s:%d: %s; undo what changed it", r->name,
                   tz_svg_line(n), what);
}

static bool whole(double v, double lo, double hi)
{
    return v >= lo && v <= hi && v == rint(v);
}

/** `count` numbers of an attribute. */
static tz_status numbers(tz_element_reader *r, tz_svg_node n, const char *attr,
                         int32_t count, double *out)
{
    tz_numbers v = {0};
    const char *text = tz_svg_attr(n, attr);
    tz_status s = text ? tz_svg_numbers(r->ctx, text, &v) : TZ_INVALID;
    if (s == TZ_OK && v.n == count)
        memcpy(out, v.v, (size_t)count * sizeof *out);
    else if (s != TZ_NOMEM)
        s = tz_fail(r->ctx, TZ_FORMAT,
                    "%s:%d: %s does not hold %d numbers; undo what "
                    "changed it",
                    r->name, tz_svg_line(n), attr, count);
    tz_array_free(r->ctx, &v);
    return s;
}

/* ---- images -------------------------------------------------------------------------- */

/** Photo `i` of the set, made if it is not there. */
static tz_status photo_at(tz_element_reader *r, int32_t i, tz_element_photo **out)
{
    tz_status s = TZ_OK;
    while (r->set.photo.n <= i && s == TZ_OK)
        s = tz_array_push(r->ctx, &r->set.photo, (tz_element_photo){0});
    *out = s == TZ_OK ? &r->set.photo.v[i] : NULL;
    return s;
}

tz_status tz_element_read_image(tz_element_reader *r, tz_svg_node n)
{
    const bool plate = tz_svg_attr(n, "tz:plate") != NULL;
    const char *href = tz_svg_attr(n, "xlink:href"), *sha = tz_svg_attr(n, "tz:sha256");
    double number = 0, size[2] = {0};
    tz_element_photo *p;
    char *path = NULL;
    if (!plate && !tz_svg_attr(n, "tz:photo"))
        return TZ_OK;
    tz_status s = numbers(r, n, plate ? "tz:plate" : "tz:photo", 1, &number);
    if (s == TZ_OK && !whole(number, 0, 4095))
        return bad(r, n, "the photo has a number that cannot be");
    if (s == TZ_OK && !href)
        return bad(r, n, "the photo has no xlink:href");
    if (s == TZ_OK && !plate)
        s = numbers(r, n, "tz:pixels", 2, size);
    if (s == TZ_OK && !plate && !(whole(size[0], 1, 1e6) && whole(size[1], 1, 1e6)))
        return bad(r, n, "the photo has a size that cannot be");
    if (s == TZ_OK)
        s = photo_at(r, (int32_t)number, &p);
    if (s == TZ_OK && (plate ? p->plate : p->path))
        return bad(r, n, "two photos have the same number");
    if (s == TZ_OK)
        s = tz_href_open_here(r->ctx, r->name, tz_svg_line(n), href, &path);
    if (s != TZ_OK)
        return s;
    if (plate) {
        p->plate = path;
        return TZ_OK;
    }
    p->path = path;
    p->width = (int32_t)size[0];
    p->height = (int32_t)size[1];
    if (sha && strlen(sha) == 64 && strspn(sha, "0123456789abcdef") == 64)
        memcpy(p->sha256, sha, 65);
    return TZ_OK;
}

tz_status tz_element_join_photos(tz_element_reader *r)
{
    tz_element_set *s = &r->set;
    for (int32_t i = 0; i < s->photo.n; i++)
        if (!s->photo.v[i].path)
            return tz_fail(r->ctx, TZ_FORMAT,
                           "%s: photo %d is missing; put back the <image> with "
                           "tz:photo=\"%d\"",
                           r->name, i, i);
    for (int32_t i = 0; i < s->symbol.n; i++)
        if (s->symbol.v[i].photo_scale > 0 && s->symbol.v[i].photo >= s->photo.n)
            return tz_fail(r->ctx, TZ_FORMAT,
                           "%s: photo %d of symbol \"%.60s\" is missing; put back the "
                           "<image> with tz:photo=\"%d\"",
                           r->name, s->symbol.v[i].photo, s->symbol.v[i].id,
                           s->symbol.v[i].photo);
    return TZ_OK;
}

/* ---- symbols ------------------------------------------------------------------------- */

bool tz_element_is_cut(tz_svg_node symbol)
{
    return tz_svg_attr(symbol, "tz:photo") != NULL;
}

/** The first path of the clip that a symbol's content names, or NULL. */
static tz_svg_node clip_of(tz_element_reader *r, tz_svg_node symbol)
{
    for (tz_svg_node c = tz_svg_child(symbol); c; c = tz_svg_next(c)) {
        const char *name = tz_svg_attr(c, "clip-path");
        char id[512];
        if (!name || strncmp(name, "url(#", 5) != 0)
            continue;
        const size_t n = strcspn(name + 5, ")");
        if (n >= sizeof id)
            continue;
        memcpy(id, name + 5, n);
        id[n] = 0;
        tz_svg_node clip = tz_svg_by_id(r->doc, id);
        for (tz_svg_node p = clip ? tz_svg_child(clip) : NULL; p; p = tz_svg_next(p))
            if (tz_svg_is(p, "path"))
                return p;
    }
    return NULL;
}

/** Points as they stand; curves flattened. */
static tz_status take_path(tz_element_reader *r, const tz_svg_path *path, tz_affine map,
                           tz_element_symbol *y)
{
    tz_polys p = {0};
    bool straight =
        map.a == 1 && map.b == 0 && map.c == 0 && map.d == 1 && map.e == 0 && map.f == 0;
    double far = 0;
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < path->verb.n; i++)
        straight = straight && path->verb.v[i] != TZ_PATH_CUBIC;
    for (int32_t i = 0; i < path->point.n; i++)
        far = fmax(far, tz_vec2_length(tz_affine_apply(map, path->point.v[i])));
    if (!straight) {
        s = tz_polys_add_path(r->ctx, &p, path->verb.v, path->verb.n, path->point.v, map,
                              far / 200);
        y->outline.v = p.point.v, y->outline.n = p.point.n, y->outline.cap = p.point.cap;
        y->part.v = p.part.v, y->part.n = p.part.n, y->part.cap = p.part.cap;
        tz_array_free(r->ctx, &p.closed);
        return s;
    }
    for (int32_t i = 0, at = 0; i < path->verb.n && s == TZ_OK; i++) {
        if (path->verb.v[i] == TZ_PATH_CLOSE)
            continue;
        if (path->verb.v[i] == TZ_PATH_MOVE)
            s = tz_array_push(r->ctx, &y->part, y->outline.n);
        if (s == TZ_OK)
            s = tz_array_push(r->ctx, &y->outline, path->point.v[at++]);
    }
    return s;
}

/** What lies outside of floating point's good range cannot be an outline. */
static bool sane(const tz_element_symbol *y)
{
    for (int32_t i = 0; i < y->outline.n; i++)
        if (!(tz_vec2_length(y->outline.v[i]) < 1e9))
            return false;
    return true;
}

tz_status tz_element_read_cut(tz_element_reader *r, tz_svg_node symbol,
                              tz_element_symbol *y)
{
    double from[4] = {0};
    tz_svg_path path = {0};
    tz_affine map;
    tz_svg_node node = clip_of(r, symbol);
    const char *d = node ? tz_svg_attr(node, "d") : NULL;
    tz_status s = numbers(r, symbol, "tz:photo", 4, from);
    if (s != TZ_OK)
        return s;
    if (!whole(from[0], 0, 4095) || !(from[1] > 0))
        return bad(r, symbol, "tz:photo holds a number that cannot be");
    if (!d)
        return bad(r, symbol, "the outline of the symbol is missing");
    y->photo = (int32_t)from[0];
    y->photo_scale = from[1];
    y->photo_at = (tz_vec2){from[2], from[3]};
    if (tz_svg_transform(NULL, tz_svg_attr(node, "transform"), &map) != TZ_OK)
        return bad(r, node, "its transform cannot be read");
    s = tz_svg_path_parse(r->ctx, d, &path);
    if (s == TZ_OK)
        s = take_path(r, &path, map, y);
    tz_svg_path_deinit(r->ctx, &path);
    if (s == TZ_OK && (y->outline.n == 0 || !sane(y)))
        return bad(r, node, "the outline cannot be used");
    if (s == TZ_OK && !(y->radius > 0))
        for (int32_t i = 0; i < y->outline.n; i++)
            y->radius = fmax(y->radius, tz_vec2_length(y->outline.v[i]));
    return s;
}

/* ---- what is hidden ------------------------------------------------------------------ */

tz_status tz_element_is_hidden(tz_element_reader *r, tz_svg_node n, bool *hidden)
{
    static const char *const says[] = {"style", "class", "display", "visibility",
                                       "opacity"};
    const tz_style plain = tz_style_initial();
    tz_style style;
    bool asked = r->rule.n > 0;
    *hidden = false;
    for (size_t i = 0; i < sizeof says / sizeof *says && !asked; i++)
        asked = tz_svg_attr(n, says[i]) != NULL;
    if (!asked)
        return TZ_OK;
    const tz_status s = tz_style_at(r, n, &plain, &style);
    if (s == TZ_OK)
        *hidden = !style.shown || !style.visible || !(style.opacity > 0);
    return s;
}
