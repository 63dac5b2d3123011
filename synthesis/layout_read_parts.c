/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Reading a layout: photos and borders. Each <image> and each clip path is read at its
 * first use and found by its node afterwards; placements with one clip path share border
 * points. */
#include <assert.h>
#include <string.h>

#include "synthesis/layout_internal.h"

#define MAX_BORDER  200000000
#define MAX_SOURCES 4096
#define MAX_IMAGES  65536

/* ---- nodes already read ---------------------------------------------------------- */

/** Slot of a node, free if it is not there. */
static tz_read_slot *find_slot(tz_read_slot *table, size_t room, tz_svg_node node)
{
    size_t i = (size_t)(((uintptr_t)node >> 4) * 0x9E3779B97F4A7C15u >> 20) & (room - 1);
    while (table[i].node && table[i].node != node)
        i = (i + 1) & (room - 1);
    return &table[i];
}

/** Slot of a node in a table with room for one more. */
static tz_status get_slot(tz_reader *r, tz_svg_node node, tz_read_slot **out)
{
    if (2 * (r->used + 1) > r->room) {
        size_t room = r->room ? 2 * r->room : 1024;
        tz_read_slot *table = NULL;
        tz_status st = tz_alloc_zero(r->ctx, &table, room, sizeof *table);
        if (st)
            return st;
        for (size_t i = 0; i < r->room; i++)
            if (r->table[i].node)
                *find_slot(table, room, r->table[i].node) = r->table[i];
        tz_free(r->ctx, r->table);
        r->table = table;
        r->room = room;
    }
    *out = find_slot(r->table, r->room, node);
    return TZ_OK;
}

/* ---- attributes ------------------------------------------------------------------ */

bool tz_reader_integer(const char *text, int32_t lo, int32_t hi, int32_t *out)
{
    double v;
    if (!tz_svg_number(text, &v) || v != floor(v) || v < lo || v > hi)
        return false;
    *out = (int32_t)v;
    return true;
}

tz_status tz_reader_length(tz_reader *r, tz_svg_node n, const char *name,
                           double otherwise, double *out)
{
    const char *text = tz_svg_attr(n, name);
    *out = otherwise;
    if (!text || tz_svg_number(text, out))
        return TZ_OK;
    return tz_fail(r->ctx, TZ_FORMAT, "%s:%d: %s=\"%.40s\" is not a length in px",
                   r->name, tz_svg_line(n), name, text);
}

/* ---- borders --------------------------------------------------------------------- */

/** Appends the reader's polygon, seen through m (NULL = as it is), to the border pool. */
static tz_status put_border(tz_reader *r, const tz_affine *m, int32_t line,
                            int32_t *border)
{
    tz_layout *l = &r->l;
    if ((int64_t)l->border.n + r->polygon.n > MAX_BORDER)
        return tz_fail(r->ctx, TZ_LIMIT, "%s:%d: over %d border points", r->name, line,
                       MAX_BORDER);
    tz_status st =
        tz_array_reserve(r->ctx, &l->border, (int64_t)l->border.n + r->polygon.n);
    if (st)
        return st;
    for (int32_t i = 0; i < r->polygon.n; i++) {
        tz_vec2 q = m ? tz_affine_apply(*m, r->polygon.v[i]) : r->polygon.v[i];
        if (!(fabs(q.x) <= 1e9 && fabs(q.y) <= 1e9))
            return tz_fail(r->ctx, TZ_FORMAT,
                           "%s:%d: border point at (%g, %g) lies beyond all pictures",
                           r->name, line, q.x, q.y);
        l->border.v[l->border.n + i] = (tz_point){(float)q.x, (float)q.y};
    }
    *border = l->border.n;
    l->border.n += r->polygon.n;
    return TZ_OK;
}

tz_status tz_reader_border(tz_reader *r, tz_svg_node clip, tz_affine clip_map,
                           tz_affine map, int32_t source, int32_t line, int32_t *border,
                           int32_t *points)
{
    tz_status st;
    if (!clip) {
        const tz_layout_source *p = &r->l.source.v[source];
        tz_vec2 corner[] = {{0, 0}, {p->width, 0}, {p->width, p->height}, {0, p->height}};
        st = tz_array_reserve(r->ctx, &r->polygon, 4);
        if (st)
            return st;
        memcpy(r->polygon.v, corner, sizeof corner);
        *points = r->polygon.n = 4;
        return put_border(r, NULL, line, border);
    }
    if (!tz_reader_same_map(map, clip_map)) {
        tz_affine inverse = map;
        bool can = tz_affine_invert(map, &inverse);
        assert(can);
        (void)can;
        tz_affine m = tz_affine_then(clip_map, inverse);
        st = tz_layout_clip_read(r->ctx, r->name, r->doc, clip, &r->polygon);
        *points = r->polygon.n;
        return st ? st : put_border(r, &m, line, border);
    }
    tz_read_slot *slot;
    st = get_slot(r, clip, &slot);
    if (!st && !slot->node) {
        tz_read_clip c = {0};
        st = tz_layout_clip_read(r->ctx, r->name, r->doc, clip, &r->polygon);
        if (!st)
            st = put_border(r, NULL, tz_svg_line(clip), &c.border);
        c.points = r->polygon.n;
        if (!st)
            st = tz_array_push(r->ctx, &r->clip, c);
        if (st)
            return st;
        *slot = (tz_read_slot){clip, r->clip.n - 1};
        r->used++;
    }
    if (st)
        return st;
    *border = r->clip.v[slot->index].border;
    *points = r->clip.v[slot->index].points;
    return TZ_OK;
}

/* ---- photos ---------------------------------------------------------------------- */

/** Index of the source that an <image> shows; adds it if it is new. */
static tz_status find_source(tz_reader *r, tz_svg_node n, double w, double h,
                             int32_t *out)
{
    const char *text = tz_svg_attr(n, "tz:source"), *href = tz_svg_attr(n, "xlink:href");
    int32_t number = -1, size[2] = {0, 0}, line = tz_svg_line(n);
    char *path = NULL;
    if (!href)
        return tz_fail(r->ctx, TZ_FORMAT, "%s:%d: image without xlink:href", r->name,
                       line);
    if (text && !tz_reader_integer(text, 0, INT32_MAX, &number))
        return tz_fail(r->ctx, TZ_FORMAT, "%s:%d: tz:source=\"%.40s\" is not a number",
                       r->name, line, text);
    tz_status st = tz_href_open(r->ctx, r->name, line, href, &path);
    if (st)
        return st;
    for (int32_t i = 0; i < r->l.source.n; i++)
        if (!strcmp(r->l.source.v[i].path, path) &&
            (number < 0 || r->number.v[i] < 0 || r->number.v[i] == number)) {
            *out = i;
            goto done;
        }
    if (r->l.source.n >= MAX_SOURCES) {
        st = tz_fail(r->ctx, TZ_LIMIT, "%s:%d: over %d photos", r->name, line,
                     MAX_SOURCES);
        goto done;
    }
    /* the file's own size; for a photo added in an editor the box has to serve, which is
     * in proportion to it */
    text = tz_svg_attr(n, "tz:size");
    if (text) {
        tz_numbers v = {0};
        if (!tz_svg_numbers(NULL, text, &v) && v.n == 2)
            for (int k = 0; k < 2; k++)
                if (v.v[k] >= 1 && v.v[k] <= TZ_IMAGE_MAX_SIDE)
                    size[k] = (int32_t)v.v[k];
        tz_array_free(NULL, &v);
    } else {
        if (w > 0 && w <= TZ_IMAGE_MAX_SIDE)
            size[0] = w < 1 ? 1 : (int32_t)(w + 0.5);
        if (h > 0 && h <= TZ_IMAGE_MAX_SIDE)
            size[1] = h < 1 ? 1 : (int32_t)(h + 0.5);
    }
    if (!size[0] || !size[1]) {
        st = tz_fail(r->ctx, TZ_FORMAT,
                     "%s:%d: image needs width and height from 1 to %d px", r->name, line,
                     TZ_IMAGE_MAX_SIDE);
        goto done;
    }
    text = tz_svg_attr(n, "tz:sha256");
    if (text && (strlen(text) != 64 || strspn(text, "0123456789abcdef") != 64)) {
        st = tz_fail(r->ctx, TZ_FORMAT,
                     "%s:%d: tz:sha256 must be 64 lower-case hex digits", r->name, line);
        goto done;
    }
    st = tz_array_push(r->ctx, &r->number, number);
    if (!st)
        st = tz_layout_add_source(&r->l, path, text, size[0], size[1], out);
done:
    tz_free(r->ctx, path);
    return st;
}

tz_status tz_reader_photo(tz_reader *r, tz_svg_node n, tz_read_photo *out)
{
    tz_read_slot *slot;
    tz_status st = get_slot(r, n, &slot);
    if (st)
        return st;
    if (slot->node) {
        *out = r->photo.v[slot->index];
        return TZ_OK;
    }
    if (r->photo.n >= MAX_IMAGES)
        return tz_fail(r->ctx, TZ_LIMIT, "%s:%d: over %d images; use one often instead",
                       r->name, tz_svg_line(n), MAX_IMAGES);
    tz_read_photo e = {.box = {1, 0, 0, 1, 0, 0}};
    double x, y, w, h;
    st = tz_reader_length(r, n, "x", 0, &x);
    if (!st)
        st = tz_reader_length(r, n, "y", 0, &y);
    if (!st)
        st = tz_reader_length(r, n, "width", 0, &w);
    if (!st)
        st = tz_reader_length(r, n, "height", 0, &h);
    if (!st)
        st = find_source(r, n, w, h, &e.source);
    if (st)
        return st;
    const tz_layout_source *s = &r->l.source.v[e.source];
    double sx = w / s->width, sy = h / s->height;
    const char *fit = tz_svg_attr(n, "preserveAspectRatio");
    if (!fit || !strstr(fit, "none")) { /* fitted into the box and centred */
        double k = sx < sy ? sx : sy;
        x += (w - k * s->width) / 2;
        y += (h - k * s->height) / 2;
        sx = sy = k;
    }
    e.box = (tz_affine){sx, 0, 0, sy, x, y};
    st = tz_array_push(r->ctx, &r->photo, e);
    if (st)
        return st;
    *slot = (tz_read_slot){n, r->photo.n - 1};
    r->used++;
    *out = e;
    return TZ_OK;
}
