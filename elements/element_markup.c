/* SPDX-License-Identifier: Apache-2.0 */
/* Parts as SVG text: what stands in a symbol. Numbers are rounded to about a hundred
 * thousandth of the shape's radius. */
#include <string.h>

#include "elements/element_color.h"
#include "elements/element_svg_internal.h"

typedef struct text {
    tz_ctx *ctx;
    TZ_ARRAY(char)
    v;
    double per_unit; /* digits kept: round to 1 / per_unit */
    tz_status status;
} text;

static void put(text *t, const char *s)
{
    const size_t n = strlen(s);
    if (t->status == TZ_OK)
        t->status = tz_array_reserve(t->ctx, &t->v, (int64_t)t->v.n + (int64_t)n + 1);
    if (t->status != TZ_OK)
        return;
    memcpy(t->v.v + t->v.n, s, n + 1);
    t->v.n += (int32_t)n;
}

static void put_number(text *t, double v)
{
    char s[32];
    v = rint(v * t->per_unit) / t->per_unit;
    tz_number_format(v == 0 ? 0 : v, s);
    put(t, s);
}

static void put_attr(text *t, const char *name, const char *value)
{
    put(t, " ");
    put(t, name);
    put(t, "=\"");
    put(t, value);
    put(t, "\"");
}

static void put_attr_number(text *t, const char *name, double v)
{
    put(t, " ");
    put(t, name);
    put(t, "=\"");
    put_number(t, v);
    put(t, "\"");
}

static void put_alpha(text *t, const char *name, uint32_t color)
{
    char s[32];
    if ((color & 255) == 255)
        return;
    tz_number_format(rint((color & 255) / 0.255) / 1000, s);
    put_attr(t, name, s);
}

static void put_look(text *t, const tz_look *k, double scale)
{
    static const char *const cap[] = {"butt", "round", "square"};
    static const char *const join[] = {"miter", "round", "bevel"};
    char color[8];
    if (k->fill & 255) {
        tz_color_format(k->fill, color);
        put_attr(t, "fill", color);
        put_alpha(t, "fill-opacity", k->fill);
        if (k->rule)
            put_attr(t, "fill-rule", "evenodd");
    } else {
        put_attr(t, "fill", "none");
    }
    if (!(k->stroke & 255))
        return;
    tz_color_format(k->stroke, color);
    put_attr(t, "stroke", color);
    put_alpha(t, "stroke-opacity", k->stroke);
    put_attr_number(t, "stroke-width", k->width * scale);
    if (k->cap)
        put_attr(t, "stroke-linecap", cap[k->cap]);
    if (k->join)
        put_attr(t, "stroke-linejoin", join[k->join]);
}

static void put_path(text *t, const tz_element_reader *r, const tz_part *p, tz_affine map)
{
    const tz_vec2 *v = r->point.v + p->point;
    put(t, "<path d=\"");
    for (int32_t i = 0; i < p->verbs; i++) {
        static const char letter[4][2] = {"M", "L", "C", "Z"};
        const uint8_t verb = r->verb.v[p->verb + i];
        const int n = verb == TZ_PATH_CUBIC ? 3 : verb == TZ_PATH_CLOSE ? 0 : 1;
        put(t, letter[verb]);
        for (int k = 0; k < n; k++, v++) {
            const tz_vec2 q = tz_affine_apply(map, *v);
            put(t, k ? " " : "");
            put_number(t, q.x);
            put(t, " ");
            put_number(t, q.y);
        }
    }
    put(t, "\"");
}

/* A circle stays one under turns, shifts and equal scales. */
bool tz_part_circle(const tz_element_reader *r, const tz_part *p, tz_affine map,
                    tz_vec2 *centre, double *radius)
{
    const tz_vec2 *v = r->point.v + p->point;
    if (!p->round || p->points != 13)
        return false;
    const tz_vec2 a = tz_affine_apply(map, v[0]), b = tz_affine_apply(map, v[3]),
                  c = tz_affine_apply(map, v[6]);
    *centre = (tz_vec2){(a.x + c.x) / 2, (a.y + c.y) / 2};
    const tz_vec2 x = tz_vec2_sub(a, *centre), y = tz_vec2_sub(b, *centre);
    const double l = *radius = tz_vec2_length(x);
    return fabs(tz_vec2_length(y) - l) <= 1e-6 * l &&
           fabs(tz_vec2_dot(x, y)) <= 1e-6 * l * l;
}

static bool put_circle(text *t, const tz_element_reader *r, const tz_part *p,
                       tz_affine map)
{
    tz_vec2 o;
    double radius;
    if (!tz_part_circle(r, p, map, &o, &radius))
        return false;
    put(t, "<circle");
    if (rint(o.x * t->per_unit) != 0)
        put_attr_number(t, "cx", o.x);
    if (rint(o.y * t->per_unit) != 0)
        put_attr_number(t, "cy", o.y);
    put_attr_number(t, "r", radius);
    return true;
}

tz_status tz_element_markup(tz_element_reader *r, const int32_t *item, int32_t items,
                            tz_affine map, double radius, char **out)
{
    text t = {.ctx = r->ctx, .per_unit = 1};
    const double scale = sqrt(fabs(tz_affine_det(map)));
    while (t.per_unit < 1e15 && t.per_unit * radius < 3e4)
        t.per_unit *= 10;
    put(&t, "");
    for (int32_t i = 0; i < items; i++) {
        const tz_part *p = &r->part.v[item[i]];
        if (!put_circle(&t, r, p, map))
            put_path(&t, r, p, map);
        put_look(&t, &p->look, scale);
        put(&t, "/>");
    }
    if (t.status != TZ_OK) {
        tz_array_free(r->ctx, &t.v);
        return t.status;
    }
    *out = t.v.v;
    return TZ_OK;
}
