/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Clip paths as polygons. Terrazzo writes a border as one closed path of straight lines
 * and gets it back bit for bit; what an artist draws may be any basic shape, curved, and
 * in several parts, of which the largest is taken. */
#include <string.h>

#include "synthesis/layout_internal.h"

#define MAX_POINTS 1000000

static double number(tz_svg_node n, const char *name, double otherwise)
{
    const char *text = tz_svg_attr(n, name);
    double v;
    return text && tz_svg_number(text, &v) ? v : otherwise;
}

static tz_status push(tz_ctx *ctx, tz_polygon *p, double x, double y)
{
    tz_vec2 v = {x, y};
    if (p->n >= MAX_POINTS)
        return TZ_LIMIT; /* the message comes where the line is known */
    return tz_array_push(ctx, p, v);
}

static tz_status ellipse(tz_ctx *ctx, tz_svg_node n, double rx, double ry, tz_polygon *p)
{
    double cx = number(n, "cx", 0), cy = number(n, "cy", 0);
    tz_status st = TZ_OK;
    for (int i = 0; i < 96 && !st; i++)
        st = push(ctx, p, cx + rx * cos(2 * TZ_PI * i / 96),
                  cy + ry * sin(2 * TZ_PI * i / 96));
    return st;
}

static tz_status rectangle(tz_ctx *ctx, tz_svg_node n, tz_polygon *p)
{
    double x = number(n, "x", 0), y = number(n, "y", 0);
    double w = number(n, "width", 0), h = number(n, "height", 0);
    tz_status st = push(ctx, p, x, y);
    if (!st)
        st = push(ctx, p, x + w, y);
    if (!st)
        st = push(ctx, p, x + w, y + h);
    if (!st)
        st = push(ctx, p, x, y + h);
    return st;
}

static tz_status point_list(tz_ctx *ctx, tz_svg_node n, tz_polygon *p)
{
    tz_numbers v = {0};
    const char *text = tz_svg_attr(n, "points");
    tz_status st = text ? tz_svg_numbers(NULL, text, &v) : TZ_OK;
    for (int32_t i = 0; i + 1 < v.n && !st; i += 2)
        st = push(ctx, p, v.v[i], v.v[i + 1]);
    tz_array_free(NULL, &v);
    return st;
}

/** Cubic as chords of some 2 px. */
static tz_status cubic(tz_ctx *ctx, tz_vec2 a, const tz_vec2 c[3], tz_polygon *p)
{
    double length = tz_vec2_length(tz_vec2_sub(c[0], a)) +
                    tz_vec2_length(tz_vec2_sub(c[1], c[0])) +
                    tz_vec2_length(tz_vec2_sub(c[2], c[1]));
    int n = length < 4 ? 2 : length > 128 ? 64 : (int)(length / 2);
    tz_status st = TZ_OK;
    for (int i = 1; i < n && !st; i++) {
        double t = (double)i / n, s = 1 - t;
        double k0 = s * s * s, k1 = 3 * s * s * t, k2 = 3 * s * t * t, k3 = t * t * t;
        st = push(ctx, p, k0 * a.x + k1 * c[0].x + k2 * c[1].x + k3 * c[2].x,
                  k0 * a.y + k1 * c[0].y + k2 * c[1].y + k3 * c[2].y);
    }
    return st ? st : push(ctx, p, c[2].x, c[2].y);
}

static double area(const tz_vec2 *v, int32_t n)
{
    double sum = 0;
    for (int32_t i = 0, j = n - 1; i < n; j = i++)
        sum += v[j].x * v[i].y - v[i].x * v[j].y;
    return fabs(sum) / 2;
}

/** Keeps the larger of a finished subpath and the best so far; empties `sub`. */
static void finish(tz_polygon *sub, tz_polygon *best)
{
    if (sub->n >= 3 && (!best->n || area(sub->v, sub->n) > area(best->v, best->n))) {
        tz_polygon swap = *best;
        *best = *sub;
        *sub = swap;
    }
    sub->n = 0;
}

/** Appends the path's largest subpath. */
static tz_status path_shape(tz_ctx *ctx, const char *d, tz_polygon *p)
{
    tz_svg_path path = {0};
    tz_polygon sub = {0}, best = {0};
    tz_vec2 at = {0, 0}, start = {0, 0};
    tz_status st = tz_svg_path_parse(NULL, d, &path); /* no message: ours has the line */
    int32_t k = 0;
    for (int32_t i = 0; i < path.verb.n && !st; i++) {
        const tz_vec2 *c = path.point.v + k;
        switch (path.verb.v[i]) {
        case TZ_PATH_MOVE:
            finish(&sub, &best);
            start = c[0];
            k++;
            break;
        case TZ_PATH_CLOSE:
            finish(&sub, &best);
            at = start;
            continue;
        case TZ_PATH_LINE: k++; break;
        default: k += 3;
        }
        if (path.verb.v[i] != TZ_PATH_MOVE && !sub.n) /* goes on after a close */
            st = push(ctx, &sub, start.x, start.y);
        if (!st && path.verb.v[i] == TZ_PATH_CUBIC)
            st = cubic(ctx, at, c, &sub);
        else if (!st)
            st = push(ctx, &sub, c->x, c->y);
        at = path.point.v[k - 1];
    }
    finish(&sub, &best);
    for (int32_t i = 0; i < best.n && !st; i++)
        st = push(ctx, p, best.v[i].x, best.v[i].y);
    tz_array_free(ctx, &sub);
    tz_array_free(ctx, &best);
    tz_svg_path_deinit(NULL, &path);
    return st;
}

/** One shape in its parent's space; not a shape: nothing is appended. */
static tz_status shape(tz_ctx *ctx, const tz_svg_doc *doc, tz_svg_node n, int depth,
                       tz_polygon *p)
{
    tz_status st = TZ_OK;
    int32_t first = p->n;
    tz_affine m;
    double dx = 0, dy = 0;
    if (tz_svg_is(n, "path")) {
        const char *d = tz_svg_attr(n, "d");
        st = d ? path_shape(ctx, d, p) : TZ_OK;
    } else if (tz_svg_is(n, "rect")) {
        st = rectangle(ctx, n, p);
    } else if (tz_svg_is(n, "polygon") || tz_svg_is(n, "polyline")) {
        st = point_list(ctx, n, p);
    } else if (tz_svg_is(n, "circle")) {
        double r = number(n, "r", 0);
        st = ellipse(ctx, n, r, r, p);
    } else if (tz_svg_is(n, "ellipse")) {
        st = ellipse(ctx, n, number(n, "rx", 0), number(n, "ry", 0), p);
    } else if (tz_svg_is(n, "use") && depth < 4) {
        const char *href = tz_svg_attr(n, "xlink:href");
        tz_svg_node target = href && *href == '#' ? tz_svg_by_id(doc, href + 1) : NULL;
        st = target ? shape(ctx, doc, target, depth + 1, p) : TZ_OK;
        dx = number(n, "x", 0);
        dy = number(n, "y", 0);
    }
    const char *transform = tz_svg_attr(n, "transform");
    if (st || (!transform && dx == 0 && dy == 0))
        return st;
    st = tz_svg_transform(NULL, transform, &m);
    for (int32_t i = first; i < p->n && !st; i++)
        p->v[i] = tz_affine_apply(m, (tz_vec2){p->v[i].x + dx, p->v[i].y + dy});
    return st;
}

tz_status tz_layout_clip_read(tz_ctx *ctx, const char *name, const tz_svg_doc *doc,
                              tz_svg_node clip, tz_polygon *p)
{
    const char *units = tz_svg_attr(clip, "clipPathUnits");
    const char *id = tz_svg_attr(clip, "id");
    int32_t line = tz_svg_line(clip);
    tz_status st = TZ_OK;
    p->n = 0;
    if (units && !strcmp(units, "objectBoundingBox"))
        return tz_fail(ctx, TZ_FORMAT,
                       "%s:%d: clip path %.60s is measured in bounding boxes; use "
                       "clipPathUnits=\"userSpaceOnUse\"",
                       name, line, id ? id : "");
    for (tz_svg_node c = tz_svg_child(clip); c && p->n < 3 && !st; c = tz_svg_next(c)) {
        p->n = 0;
        st = shape(ctx, doc, c, 0, p);
    }
    const char *transform = tz_svg_attr(clip, "transform");
    if (!st && transform) {
        tz_affine m;
        st = tz_svg_transform(NULL, transform, &m);
        for (int32_t i = 0; i < p->n && !st; i++)
            p->v[i] = tz_affine_apply(m, p->v[i]);
    }
    if (st == TZ_INVALID)
        st = TZ_FORMAT;
    if (st == TZ_FORMAT || (!st && p->n < 3))
        return tz_fail(ctx, TZ_FORMAT,
                       "%s:%d: clip path %.60s is not a closed shape of 3 or more finite "
                       "points",
                       name, line, id ? id : "");
    if (st == TZ_LIMIT)
        return tz_fail(ctx, TZ_LIMIT, "%s:%d: clip path %.60s has over %d points", name,
                       line, id ? id : "", MAX_POINTS);
    if (st)
        return tz_fail(ctx, st, "%s:%d: out of memory for clip path %.60s", name, line,
                       id ? id : "");
    return st;
}
