/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Writing a layout as SVG 1.1:
 *
 *   <svg viewBox=... tz:document="layout" tz:tile="1">
 *     <metadata id="tz-recipe">{...}</metadata>
 *     <defs>
 *       <image id="s0" tz:source="0" tz:sha256=... xlink:href="photo.jpg" width height/>
 *       <clipPath id="b0"><path d="M..Z"/></clipPath>          one a distinct border
 *     </defs>
 *     <g transform="matrix(...)" tz:source="0" tz:group="7">   one a placement, lowest
 * first <use xlink:href="#s0" clip-path="url(#b0)"/> <use tz:copy="1"
 * transform="translate(...)" .../>      where it wraps on a torus
 *     </g>
 *
 * The use has no transform of its own, so its clip path is in source pixels. A wrapped
 * copy must appear moved by (i w, j h) in the layout but stands inside the placement's
 * transform, so that it follows when the artist drags or deletes the group: it is moved
 * by L^-1 (i w, j h), L the linear part of the map. (A turn in the editor swings the
 * copies out of place until the layout is written anew; what is rendered does not look at
 * them.)
 *
 * Equal borders share a clip path, found by hash: most placements show one of a few
 * hundred pieces, which keeps the document some 100 bytes a placement. */
#include <string.h>

#include "synthesis/layout_internal.h"

/* ---- distinct borders ------------------------------------------------------------ */

typedef struct borders {
    int32_t *of;    /* of[i]: which distinct border placement i has, -1 = removed */
    int32_t *first; /* first[b]: a placement that has border b */
    int32_t n;
} borders;

static uint64_t hash_border(const tz_point *p, int32_t n)
{
    uint64_t h = (uint64_t)n * 0x9E3779B97F4A7C15u;
    for (int32_t i = 0; i < n; i++) {
        uint64_t v;
        memcpy(&v, &p[i], sizeof v);
        h = (h ^ v) * 0xD6E8FEB86659FD93u;
        h ^= h >> 32;
    }
    return h;
}

static bool same_border(const tz_layout *l, const tz_placement *p, const tz_placement *q)
{
    return p->points == q->points &&
           (p->border == q->border ||
            !memcmp(l->border.v + p->border, l->border.v + q->border,
                    (size_t)p->points * sizeof(tz_point)));
}

static tz_status find_borders(tz_ctx *ctx, const tz_layout *l, borders *b)
{
    int32_t *table = NULL;
    size_t room = 16;
    while (room < 2 * (size_t)l->place.n)
        room *= 2;
    tz_status st = tz_alloc(ctx, &b->of, (size_t)l->place.n, sizeof *b->of);
    if (!st)
        st = tz_alloc(ctx, &b->first, (size_t)l->place.n, sizeof *b->first);
    if (!st)
        st = tz_alloc(ctx, &table, room, sizeof *table);
    if (st)
        goto done;
    memset(table, 0xff, room * sizeof *table);
    for (int32_t i = 0; i < l->place.n; i++) {
        const tz_placement *p = &l->place.v[i];
        b->of[i] = -1;
        if (p->removed)
            continue;
        size_t slot = hash_border(l->border.v + p->border, p->points) & (room - 1);
        while (table[slot] >= 0 && !same_border(l, p, &l->place.v[b->first[table[slot]]]))
            slot = (slot + 1) & (room - 1);
        if (table[slot] < 0) {
            b->first[b->n] = i;
            table[slot] = b->n++;
        }
        b->of[i] = table[slot];
    }
done:
    tz_free(ctx, table);
    return st;
}

/* ---- numbers --------------------------------------------------------------------- */

/** Shortest decimal that reads back to the same float. Tries v = r / 10^d with growing d:
 * r and 10^d are exact doubles, so r / 10^d is what strtod makes of the text. */
static size_t put_float(float v, char *text)
{
    static const double ten[] = {1, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10};
    double a = fabs((double)v);
    if (a < 1e5 && (a == 0 || a > 1e-4)) {
        for (int d = 0; d < 11; d++) {
            double r = floor(a * ten[d] + 0.5);
            if ((float)(r / ten[d]) != (float)a)
                continue;
            char digits[24];
            uint64_t whole = (uint64_t)r;
            int n = 0, used = 0;
            for (; whole || n <= d; whole /= 10)
                digits[n++] = (char)('0' + whole % 10);
            if (signbit(v))
                text[used++] = '-';
            if (d && n == d + 1 && digits[d] == '0')
                n--; /* .5 rather than 0.5 */
            while (n > d)
                text[used++] = digits[--n];
            if (d)
                text[used++] = '.';
            while (n)
                text[used++] = digits[--n];
            return (size_t)used;
        }
    }
    tz_number_format(v, text); /* very large or small: rare */
    return strlen(text);
}

/* ---- parts of the document ------------------------------------------------------- */

static const char *const medium_names[] = {"edge-group", "element", "curve"};

static tz_status put_sources(tz_ctx *ctx, const char *path, const tz_layout *l,
                             tz_svg_writer *w)
{
    for (int32_t i = 0; i < l->source.n; i++) {
        const tz_layout_source *s = &l->source.v[i];
        char *href = NULL;
        tz_status st = tz_href_make(ctx, path, s->path, &href);
        if (st)
            return st;
        tz_svg_begin(w, "image");
        tz_svg_setf(w, "id", "s%d", i);
        tz_svg_setf(w, "width", "%d", s->width);
        tz_svg_setf(w, "height", "%d", s->height);
        tz_svg_set(w, "preserveAspectRatio", "none");
        tz_svg_set(w, "xlink:href", href);
        tz_svg_setf(w, "tz:source", "%d", i);
        tz_svg_setf(w, "tz:size", "%d %d", s->width, s->height);
        if (*s->sha256)
            tz_svg_set(w, "tz:sha256", s->sha256);
        tz_svg_end(w);
        tz_free(ctx, href);
    }
    return TZ_OK;
}

static tz_status put_borders(tz_ctx *ctx, const tz_layout *l, const borders *b,
                             tz_svg_writer *w)
{
    TZ_ARRAY(char)
    text = {0};
    tz_status st = TZ_OK;
    for (int32_t i = 0; i < b->n && !st; i++) {
        const tz_placement *p = &l->place.v[b->first[i]];
        const tz_point *v = l->border.v + p->border;
        st = tz_array_reserve(ctx, &text, (int64_t)p->points * 40 + 8);
        if (st)
            break;
        size_t n = 0;
        for (int32_t k = 0; k < p->points; k++) {
            text.v[n++] = k ? ' ' : 'M';
            n += put_float(v[k].x, text.v + n);
            text.v[n++] = ' ';
            n += put_float(v[k].y, text.v + n);
        }
        text.v[n++] = 'Z';
        text.v[n] = 0;
        tz_svg_begin(w, "clipPath");
        tz_svg_setf(w, "id", "b%d", i);
        tz_svg_begin(w, "path");
        tz_svg_set(w, "d", text.v);
        tz_svg_end(w);
        tz_svg_end(w);
    }
    tz_array_free(ctx, &text);
    return st;
}

static void put_use(const tz_placement *p, int32_t border, tz_svg_writer *w)
{
    tz_svg_setf(w, "xlink:href", "#s%d", p->source);
    tz_svg_setf(w, "clip-path", "url(#b%d)", border);
}

/** The copies that a viewer needs on a torus, at most 5 x 5. */
static void put_copies(const tz_layout *l, int32_t id, int32_t border, tz_svg_writer *w)
{
    const tz_placement *p = &l->place.v[id];
    tz_rect box = tz_layout_box(l, id);
    tz_affine linear = p->map, inverse;
    linear.e = linear.f = 0;
    if (!tz_affine_invert(linear, &inverse))
        return;
    for (int32_t j = -2; j <= 2; j++)
        for (int32_t i = -2; i <= 2; i++) {
            double dx = (double)i * l->width, dy = (double)j * l->height;
            if ((!i && !j) || box.x + dx >= l->width || box.y + dy >= l->height ||
                box.x + dx + box.w <= 0 || box.y + dy + box.h <= 0)
                continue;
            tz_vec2 t = tz_affine_apply(inverse, (tz_vec2){dx, dy});
            tz_svg_begin(w, "use");
            tz_svg_set(w, "tz:copy", "1");
            tz_svg_set_affine(
                w, "transform",
                (tz_affine){1, 0, 0, 1, rint(t.x * 1e6) / 1e6, rint(t.y * 1e6) / 1e6});
            put_use(p, border, w);
            tz_svg_end(w);
        }
}

static void put_placement(const tz_layout *l, int32_t id, int32_t border,
                          tz_svg_writer *w)
{
    const tz_placement *p = &l->place.v[id];
    tz_svg_begin(w, "g");
    tz_svg_set_affine(w, "transform", p->map);
    tz_svg_setf(w, "tz:at", "%x", (unsigned)tz_layout_stamp(p->map));
    tz_svg_setf(w, "tz:source", "%d", p->source);
    tz_svg_setf(w, "tz:group", "%d", p->group);
    if (p->medium != TZ_MEDIUM_EDGE_GROUP)
        tz_svg_set(w, "tz:medium", medium_names[p->medium]);
    if (p->fixed)
        tz_svg_set(w, "tz:fixed", "1");
    tz_svg_begin(w, "use");
    put_use(p, border, w);
    tz_svg_end(w);
    if (l->tile)
        put_copies(l, id, border, w);
    tz_svg_end(w);
}

/** What stands in the root. @param path  of the document, for references to photos */
static tz_status put_layout(tz_ctx *ctx, const char *path, const tz_layout *l,
                            const borders *b, tz_svg_writer *w)
{
    tz_svg_set(w, "tz:document", "layout");
    if (l->tile)
        tz_svg_set(w, "tz:tile", "1");
    if (l->recipe) {
        tz_svg_begin(w, "metadata");
        tz_svg_set(w, "id", "tz-recipe");
        tz_svg_put_text(w, l->recipe);
        tz_svg_end(w);
    }
    tz_svg_begin(w, "defs");
    tz_status st = put_sources(ctx, path, l, w);
    if (!st)
        st = put_borders(ctx, l, b, w);
    if (st)
        return st;
    tz_svg_end(w);
    for (int32_t i = 0; i < l->place.n; i++) {
        if (b->of[i] >= 0)
            put_placement(l, i, b->of[i], w);
        if (!(i & 4095) && tz_ctx_cancelled(ctx))
            return TZ_CANCELLED;
        if (w->status)
            break;
    }
    return w->status;
}

/** @param[out] text  NULL = to the file `path` */
static tz_status write_layout(tz_ctx *ctx, const char *path, const tz_layout *l,
                              char **text)
{
    tz_svg_writer w = {0};
    borders b = {0};
    tz_status st = find_borders(ctx, l, &b);
    if (!st) {
        st = text ? tz_svg_writer_open_text(ctx, path, l->width, l->height, &w)
                  : tz_svg_writer_open(ctx, path, l->width, l->height, &w);
        if (!st) {
            st = put_layout(ctx, path, l, &b, &w);
            if (st)
                tz_svg_writer_abort(&w);
            else
                st = text ? tz_svg_writer_close_text(&w, text) : tz_svg_writer_close(&w);
        }
    }
    tz_free(ctx, b.of);
    tz_free(ctx, b.first);
    return st;
}

tz_status tz_layout_write(tz_ctx *ctx, const char *path, const tz_layout *l)
{
    return write_layout(ctx, path, l, NULL);
}

tz_status tz_layout_text(tz_ctx *ctx, const char *path, const tz_layout *l, char **text)
{
    return write_layout(ctx, path, l, text);
}
