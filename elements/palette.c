/* SPDX-License-Identifier: Apache-2.0 */
#include "elements/palette.h"

#include <stdlib.h>
#include <string.h>

#include "base/svg.h"

enum { MOST_TEXTURES = 64 };

/** A stretch of the text. */
typedef struct span {
    const char *v;
    int n;
} span;

static tz_status bad(tz_ctx *ctx, span w, const char *why)
{
    return tz_fail(ctx, TZ_INVALID, "textures: \"%.*s\" %s", w.n, w.v, why);
}

static bool is(span name, const char *text)
{
    return (int)strlen(text) == name.n && memcmp(name.v, text, (size_t)name.n) == 0;
}

static tz_status read_numbers(tz_ctx *ctx, span w, span value, int32_t count, double *out)
{
    char text[256];
    tz_numbers list = {0};
    if (value.n >= (int)sizeof text)
        return bad(ctx, w, "is too long");
    memcpy(text, value.v, (size_t)value.n);
    text[value.n] = 0;
    tz_status s = tz_svg_numbers(ctx, text, &list);
    if (s != TZ_NOMEM && (s != TZ_OK || list.n != count)) {
        tz_ctx_clear(ctx);
        s = bad(ctx, w, count == 1 ? "wants one number" : "wants four numbers");
    }
    for (int32_t i = 0; s == TZ_OK && i < count; i++)
        out[i] = list.v[i];
    tz_array_free(ctx, &list);
    return s;
}

static tz_status read_kinds(tz_ctx *ctx, span w, span value, const tz_element_set *set,
                            uint64_t *bits)
{
    for (const char *p = value.v, *end = value.v + value.n; p < end;) {
        const char *comma = memchr(p, ',', (size_t)(end - p));
        const span name = {p, (int)((comma ? comma : end) - p)};
        int32_t k = 0;
        while (k < set->kind.n && !is(name, set->kind.v[k].name))
            k++;
        if (k == set->kind.n)
            return tz_fail(
                ctx, TZ_INVALID,
                "textures: there is no class \"%.*s\"; the exemplar's first is "
                "\"%s\"",
                name.n, name.v, set->kind.n > 0 ? set->kind.v[0].name : "");
        if (k >= 64)
            return bad(ctx, w,
                       "names a class beyond the first 64, which are always taken");
        *bits |= UINT64_C(1) << k;
        p = comma ? comma + 1 : end;
    }
    return *bits ? TZ_OK : bad(ctx, w, "names no class");
}

static tz_status read_word(tz_ctx *ctx, span w, const tz_element_set *set,
                           tz_growth_texture *t)
{
    const char *eq = memchr(w.v, '=', (size_t)w.n);
    double v[4] = {0};
    if (!eq)
        return bad(ctx, w, "is not one of frame=, scale=, zone= and kinds=");
    const span name = {w.v, (int)(eq - w.v)};
    const span value = {eq + 1, w.n - name.n - 1};
    tz_status s = TZ_OK;
    if (is(name, "frame")) {
        s = read_numbers(ctx, w, value, 4, v);
        if (s == TZ_OK && !(v[2] > v[0] && v[3] > v[1]))
            s = bad(ctx, w, "has no area; give x0,y0,x1,y1");
        if (s == TZ_OK) {
            t->from = (tz_vec2){v[0], v[1]};
            t->to = (tz_vec2){v[2], v[3]};
        }
    } else if (is(name, "scale")) {
        s = read_numbers(ctx, w, value, 1, v);
        if (s == TZ_OK && !(v[0] >= 0.001 && v[0] <= 1000))
            s = bad(ctx, w, "is not between 0.001 and 1000");
        t->scale = s == TZ_OK ? v[0] : 0;
    } else if (is(name, "zone")) {
        s = read_numbers(ctx, w, value, 1, v);
        if (s == TZ_OK && !(v[0] >= 1 && v[0] <= 255 && v[0] == floor(v[0])))
            s = bad(ctx, w, "is not a whole number from 1 to 255");
        t->zone = s == TZ_OK ? 1 + (int32_t)v[0] : 0; /* zone 0: colours not named */
    } else if (is(name, "kinds")) {
        s = read_kinds(ctx, w, value, set, &t->kinds);
    } else {
        s = bad(ctx, w, "is not one of frame=, scale=, zone= and kinds=");
    }
    return s;
}

static tz_status read_texture(tz_ctx *ctx, const char *text, size_t n,
                              const tz_element_set *set, tz_growth_texture *t)
{
    static const char blanks[] = " \t\r\n";
    tz_status s = TZ_OK;
    for (const char *p = text, *end = text + n; s == TZ_OK && p < end;) {
        p += strspn(p, blanks);
        size_t k = strcspn(p, " \t\r\n;");
        if (p >= end || k == 0)
            break;
        s = read_word(ctx, (span){p, (int)k}, set, t);
        p += k;
    }
    return s;
}

tz_status tz_palette_parse(tz_ctx *ctx, const char *text, const tz_element_set *set,
                           tz_palette *p)
{
    tz_status s = TZ_OK;
    for (const char *at = text; s == TZ_OK && *at;) {
        const size_t n = strcspn(at, ";");
        tz_growth_texture t = {0};
        if (p->n >= MOST_TEXTURES)
            return tz_fail(ctx, TZ_LIMIT, "textures: over %d; name fewer", MOST_TEXTURES);
        if (strspn(at, " \t\r\n") < n) {
            s = read_texture(ctx, at, n, set, &t);
            if (s == TZ_OK)
                s = tz_array_push(ctx, p, t);
        }
        at += n + (at[n] == ';');
    }
    return s;
}
