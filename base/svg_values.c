/* SPDX-License-Identifier: Apache-2.0 */
/* Attribute values of SVG: numbers, transforms. Path data: base/svg_path.c. */
#include <string.h>

#include "base/svg.h"
#include "base/svg_internal.h"

const char *tz_svg_skip_blank(const char *p) { return p + strspn(p, " \t\r\n\f"); }

const char *tz_svg_skip_comma(const char *p)
{
    p = tz_svg_skip_blank(p);
    return *p == ',' ? tz_svg_skip_blank(p + 1) : p;
}

tz_status tz_svg_numbers(tz_ctx *ctx, const char *text, tz_numbers *out)
{
    const char *p = tz_svg_skip_blank(text);
    int32_t before = out->n;
    tz_status s = TZ_OK;
    while (*p && s == TZ_OK) {
        double v;
        const char *end = p;
        if (!tz_number_parse(p, &end, &v))
            s = tz_fail(ctx, TZ_INVALID, "'%.20s' is not a number", p);
        else
            s = tz_array_push(ctx, out, v);
        p = tz_svg_skip_comma(end);
        if (!*p && end[strcspn(end, ",")] && s == TZ_OK)
            s = tz_fail(ctx, TZ_INVALID, "a number is missing after the last comma");
    }
    if (s != TZ_OK)
        out->n = before;
    return s;
}

bool tz_svg_number(const char *text, double *out)
{
    if (!text)
        return false;
    double v;
    const char *end;
    if (!tz_number_parse(tz_svg_skip_blank(text), &end, &v))
        return false;
    if (strncmp(end, "px", 2) == 0)
        end += 2;
    if (*tz_svg_skip_blank(end))
        return false;
    *out = v;
    return true;
}

/* One function of a transform list, such as rotate(30 5 5). */
static bool make_transform(const char *name, size_t length, const double *v, int n,
                           tz_affine *m)
{
    static const char *const names[] = {"matrix", "translate", "scale",
                                        "rotate", "skewX",     "skewY"};
    int kind = 0;
    while (kind < 6 &&
           (strlen(names[kind]) != length || strncmp(names[kind], name, length) != 0))
        kind++;
    *m = tz_affine_identity();
    switch (kind) {
    case 0:
        if (n != 6)
            return false;
        *m = (tz_affine){v[0], v[1], v[2], v[3], v[4], v[5]};
        return true;
    case 1:
        m->e = v[0];
        m->f = n == 2 ? v[1] : 0;
        return n == 1 || n == 2;
    case 2:
        m->a = v[0];
        m->d = n == 2 ? v[1] : v[0];
        return n == 1 || n == 2;
    case 3: {
        tz_vec2 centre = n == 3 ? (tz_vec2){v[1], v[2]} : (tz_vec2){0, 0};
        *m = tz_affine_place(centre, centre, v[0] * TZ_PI / 180, 1, false);
        return n == 1 || n == 3;
    }
    case 4: m->c = tan(v[0] * TZ_PI / 180); return n == 1;
    case 5: m->b = tan(v[0] * TZ_PI / 180); return n == 1;
    default: return false;
    }
}

tz_status tz_svg_transform(tz_ctx *ctx, const char *text, tz_affine *out)
{
    tz_affine all = tz_affine_identity();
    const char *p = text ? tz_svg_skip_blank(text) : "";
    bool first = true;
    while (*p) {
        const char *name = p;
        size_t length = strspn(p, "abcdefghijklmnopqrstuvwxyzXY");
        double v[6] = {0};
        int n = 0;
        tz_affine m;
        p = tz_svg_skip_blank(p + length);
        if (*p != '(')
            goto bad;
        p = tz_svg_skip_blank(p + 1);
        while (*p && *p != ')') {
            if (n == 6 || !tz_number_parse(p, &p, &v[n]))
                goto bad;
            n++;
            p = tz_svg_skip_comma(p);
        }
        if (*p != ')' || n == 0 || !make_transform(name, length, v, n, &m))
            goto bad;
        /* the rightmost acts first; one alone is kept to the bit */
        all = first ? m : tz_affine_then(m, all);
        first = false;
        p = tz_svg_skip_comma(p + 1);
    }
    if (!tz_affine_finite(all))
        goto bad;
    *out = all;
    return TZ_OK;
bad:
    return tz_fail(ctx, TZ_INVALID, "transform '%.60s' is wrong at character %d", text,
                   (int)(p - text));
}
