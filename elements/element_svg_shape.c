/* SPDX-License-Identifier: Apache-2.0 */
/* Shapes of SVG as paths in the view's units: each becomes a part. */
#include <string.h>

#include "elements/element_svg_internal.h"

/* A quarter circle as a cubic: handles this far along the radius. */
#define KAPPA 0.5522847498307936

typedef struct pen {
    tz_element_reader *r;
    tz_affine map;
    tz_status status;
} pen;

tz_status tz_element_length(tz_element_reader *r, tz_svg_node n, const char *name,
                            double whole, double missing, double *out)
{
    const char *text = tz_svg_attr(n, name);
    *out = missing;
    if (!text || !text[strspn(text, " \t\r\n")] || strcmp(text, "auto") == 0)
        return TZ_OK;
    if (!tz_style_length(text, whole, out))
        return tz_fail(r->ctx, TZ_FORMAT,
                       "%s:%d: %s=\"%.40s\" is not a length; correct it", r->name,
                       tz_svg_line(n), name, text);
    return TZ_OK;
}

static void put(pen *p, tz_path_verb verb, int n, const tz_vec2 *v)
{
    if (p->status == TZ_OK)
        p->status = tz_array_push(p->r->ctx, &p->r->verb, (uint8_t)verb);
    for (int i = 0; i < n && p->status == TZ_OK; i++)
        p->status = tz_array_push(p->r->ctx, &p->r->point, tz_affine_apply(p->map, v[i]));
}

static void move(pen *p, double x, double y)
{
    put(p, TZ_PATH_MOVE, 1, &(tz_vec2){x, y});
}

static void line(pen *p, double x, double y)
{
    put(p, TZ_PATH_LINE, 1, &(tz_vec2){x, y});
}

/* From (x + a.x, y + a.y) to (x + b.x, y + b.y), a quarter about (x, y). */
static void quarter(pen *p, double x, double y, tz_vec2 a, tz_vec2 b)
{
    const tz_vec2 v[3] = {{x + a.x + KAPPA * b.x, y + a.y + KAPPA * b.y},
                          {x + b.x + KAPPA * a.x, y + b.y + KAPPA * a.y},
                          {x + b.x, y + b.y}};
    put(p, TZ_PATH_CUBIC, 3, v);
}

static void ellipse(pen *p, double x, double y, double a, double b)
{
    move(p, x + a, y);
    quarter(p, x, y, (tz_vec2){a, 0}, (tz_vec2){0, b});
    quarter(p, x, y, (tz_vec2){0, b}, (tz_vec2){-a, 0});
    quarter(p, x, y, (tz_vec2){-a, 0}, (tz_vec2){0, -b});
    quarter(p, x, y, (tz_vec2){0, -b}, (tz_vec2){a, 0});
    put(p, TZ_PATH_CLOSE, 0, NULL);
}

static void rectangle(pen *p, const double v[6])
{
    const double x = v[0], y = v[1], w = v[2], h = v[3];
    double a = v[4] >= 0 ? v[4] : v[5] >= 0 ? v[5] : 0, b = v[5] >= 0 ? v[5] : a;
    a = fmin(a, w / 2);
    b = fmin(b, h / 2);
    const bool round = a > 0 && b > 0;
    if (!round)
        a = b = 0;
    move(p, x + a, y);
    line(p, x + w - a, y);
    if (round)
        quarter(p, x + w - a, y + b, (tz_vec2){0, -b}, (tz_vec2){a, 0});
    line(p, x + w, y + h - b);
    if (round)
        quarter(p, x + w - a, y + h - b, (tz_vec2){a, 0}, (tz_vec2){0, b});
    line(p, x + a, y + h);
    if (round)
        quarter(p, x + a, y + h - b, (tz_vec2){0, b}, (tz_vec2){-a, 0});
    line(p, x, y + b);
    if (round)
        quarter(p, x + a, y + b, (tz_vec2){-a, 0}, (tz_vec2){0, -b});
    put(p, TZ_PATH_CLOSE, 0, NULL);
}

/* ---- one a kind of shape ---------------------------------------------------------- */

static tz_status numbers(tz_element_reader *r, tz_svg_node n, int count,
                         const char *const *name, const double *whole,
                         const double *missing, double *out)
{
    tz_status s = TZ_OK;
    for (int i = 0; i < count && s == TZ_OK; i++)
        s = tz_element_length(r, n, name[i], whole[i], missing[i], &out[i]);
    return s;
}

static tz_status draw_round(pen *p, tz_svg_node n, bool circle)
{
    static const char *const name[2][4] = {{"cx", "cy", "rx", "ry"},
                                           {"cx", "cy", "r", "r"}};
    const tz_vec2 view = p->r->view;
    const double d = hypot(view.x, view.y) / sqrt(2);
    const double whole[4] = {view.x, view.y, circle ? d : view.x, circle ? d : view.y};
    const double missing[4] = {0, 0, 0, 0};
    double v[4];
    tz_status s = numbers(p->r, n, 4, name[circle], whole, missing, v);
    if (s != TZ_OK)
        return s;
    if (v[2] < 0 || v[3] < 0)
        return tz_fail(p->r->ctx, TZ_FORMAT, "%s:%d: a radius is below 0; correct it",
                       p->r->name, tz_svg_line(n));
    if (v[2] > 0 && v[3] > 0)
        ellipse(p, v[0], v[1], v[2], v[3]);
    return TZ_OK;
}

static tz_status draw_rect(pen *p, tz_svg_node n)
{
    static const char *const name[6] = {"x", "y", "width", "height", "rx", "ry"};
    const tz_vec2 w = p->r->view;
    const double whole[6] = {w.x, w.y, w.x, w.y, w.x, w.y};
    const double missing[6] = {0, 0, 0, 0, -1, -1};
    double v[6];
    tz_status s = numbers(p->r, n, 6, name, whole, missing, v);
    if (s != TZ_OK)
        return s;
    if (v[2] < 0 || v[3] < 0)
        return tz_fail(p->r->ctx, TZ_FORMAT,
                       "%s:%d: a width or height is below 0; correct it", p->r->name,
                       tz_svg_line(n));
    if (v[2] > 0 && v[3] > 0)
        rectangle(p, v);
    return TZ_OK;
}

static tz_status draw_line(pen *p, tz_svg_node n)
{
    static const char *const name[4] = {"x1", "y1", "x2", "y2"};
    const tz_vec2 w = p->r->view;
    const double whole[4] = {w.x, w.y, w.x, w.y}, missing[4] = {0, 0, 0, 0};
    double v[4];
    tz_status s = numbers(p->r, n, 4, name, whole, missing, v);
    if (s != TZ_OK)
        return s;
    move(p, v[0], v[1]);
    line(p, v[2], v[3]);
    return TZ_OK;
}

static tz_status draw_polygon(pen *p, tz_svg_node n, bool closed)
{
    const char *text = tz_svg_attr(n, "points");
    tz_numbers v = {0};
    if (!text)
        return TZ_OK;
    tz_status s = tz_svg_numbers(NULL, text, &v);
    if (s == TZ_NOMEM)
        s = tz_fail(p->r->ctx, s, "%s: out of memory", p->r->name);
    else if (s != TZ_OK)
        s = tz_fail(p->r->ctx, TZ_FORMAT,
                    "%s:%d: points=\"%.40s\" holds something that is no number; correct "
                    "it",
                    p->r->name, tz_svg_line(n), text);
    for (int32_t i = 0; i + 1 < v.n; i += 2) /* an odd number at the end: not drawn */
        (i ? line : move)(p, v.v[i], v.v[i + 1]);
    if (closed && v.n >= 2)
        put(p, TZ_PATH_CLOSE, 0, NULL);
    tz_array_free(NULL, &v);
    return s;
}

static tz_status draw_path(pen *p, tz_svg_node n)
{
    const char *d = tz_svg_attr(n, "d");
    tz_svg_path path = {0};
    int32_t at = 0;
    if (!d)
        return TZ_OK;
    tz_status s = tz_svg_path_parse(NULL, d, &path);
    if (s == TZ_FORMAT || s == TZ_INVALID)
        s = tz_fail(p->r->ctx, TZ_FORMAT,
                    "%s:%d: the path data d=\"%.40s\" cannot be read; correct it",
                    p->r->name, tz_svg_line(n), d);
    else if (s != TZ_OK)
        s = tz_fail(p->r->ctx, s, "%s: out of memory", p->r->name);
    for (int32_t i = 0; i < path.verb.n && s == TZ_OK; i++) {
        const tz_path_verb verb = path.verb.v[i];
        const int k = verb == TZ_PATH_CUBIC ? 3 : verb == TZ_PATH_CLOSE ? 0 : 1;
        put(p, verb, k, path.point.v + at);
        at += k;
        s = p->status;
    }
    tz_svg_path_deinit(NULL, &path);
    return s;
}

/* ---- parts ----------------------------------------------------------------------- */

/* Whether a part shows: it has an extent, and area or a pen. */
static bool shows(const tz_part *p)
{
    const double w = p->box.x1 - p->box.x0, h = p->box.y1 - p->box.y0;
    if (!(p->look.fill & 255) && !(p->look.stroke & 255))
        return false;
    return p->look.stroke & 255 ? w > 0 || h > 0 : w > 0 && h > 0;
}

/* Whether all points lie on a line: there is nothing to fill. */
static bool is_straight(const tz_vec2 *v, int32_t n)
{
    tz_vec2 d = {0, 0};
    for (int32_t i = 1; i < n; i++) {
        const tz_vec2 e = tz_vec2_sub(v[i], v[0]);
        if (tz_vec2_dot(e, e) > tz_vec2_dot(d, d))
            d = e;
    }
    for (int32_t i = 1; i < n; i++) {
        const tz_vec2 e = tz_vec2_sub(v[i], v[0]);
        if (fabs(d.x * e.y - d.y * e.x) > 1e-9 * tz_vec2_dot(d, d))
            return false;
    }
    return true;
}

tz_status tz_part_add(tz_element_reader *r, tz_svg_node n, const tz_style *style,
                      tz_affine map, bool owned)
{
    pen p = {r, map, TZ_OK};
    tz_part part = {.verb = r->verb.n,
                    .point = r->point.n,
                    .look = tz_style_look(style),
                    .box = tz_box_empty(),
                    .owned = owned,
                    .line = tz_svg_line(n),
                    .order = r->steps,
                    .name = tz_svg_attr(n, "tz:class"),
                    .id = tz_svg_attr(n, "id"),
                    .label = tz_svg_attr(n, "inkscape:label"),
                    .node = n};
    tz_status s = TZ_OK;
    if (tz_svg_is(n, "path"))
        s = draw_path(&p, n);
    else if (tz_svg_is(n, "circle") || tz_svg_is(n, "ellipse"))
        s = draw_round(&p, n, part.round = tz_svg_is(n, "circle"));
    else if (tz_svg_is(n, "rect"))
        s = draw_rect(&p, n);
    else if (tz_svg_is(n, "line"))
        s = draw_line(&p, n);
    else
        s = draw_polygon(&p, n, tz_svg_is(n, "polygon"));
    if (s == TZ_OK)
        s = p.status;
    part.verbs = r->verb.n - part.verb;
    part.points = r->point.n - part.point;
    for (int32_t i = part.point; i < r->point.n; i++)
        tz_box_add(&part.box, r->point.v[i]);
    if (part.points > 0 && is_straight(r->point.v + part.point, part.points))
        part.look.fill = part.look.rule = 0;
    const double scale = sqrt(fabs(tz_affine_det(map)));
    part.look.width *= scale;
    if (s == TZ_OK && part.points > 0 &&
        !(fabs(part.box.x0) < 1e12 && fabs(part.box.y0) < 1e12 && part.box.x1 < 1e12 &&
          part.box.y1 < 1e12 && part.look.width < 1e12))
        s = tz_fail(r->ctx, TZ_FORMAT,
                    "%s:%d: the shape reaches beyond any drawing; correct its numbers",
                    r->name, part.line);
    if (s == TZ_OK && part.points > 0 && shows(&part))
        return tz_array_push(r->ctx, &r->part, part);
    r->verb.n = part.verb;
    r->point.n = part.point;
    return s;
}
